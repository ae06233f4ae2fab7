//! Machines as files: those of the library, faults, and mutants.

use super::{Random, cases, library, texts};
use crate::machine::{BodyShape, Letter, Link, Machine, MachineError, Opponent, Side};

/// A sound file, one key per line.
const SOUND: &str = r#"name = "mill"
[[axis]]
letter = "X"
kind = "linear"
carries = "table"
[[axis]]
letter = "A"
kind = "rotary"
carries = "table"
direction = [1, 0, 0]
point = [0, 0, -100.5]
limits = [-90, 90]
home = 0
[[axis]]
letter = "Y"
kind = "linear"
carries = "tool"
[[axis]]
letter = "Z"
kind = "linear"
carries = "tool"
"#;

#[test]
fn machines_of_the_library_have_their_names() {
    let machines = library();
    for (machine, name) in machines.iter().zip(Machine::names()) {
        assert_eq!(machine.name(), name);
        assert!(machine.axes().iter().all(|axis| axis.home == Some(0.0)));
        let rotary = machine.axes().iter().filter(|axis| axis.letter.is_rotary()).count();
        assert_eq!(rotary, if name == "3-axis" { 0 } else { 2 });
    }
    assert_eq!(machines.len(), 14);
    let error = Machine::named("lathe").expect_err("no machine").to_string();
    assert!(error.starts_with(
        "`lathe` is no machine of the library: name one of `3-axis`, `A-C trunnion`,"
    ));
}

/// A machine with bodies has the axes of the one without them.
#[test]
fn bodies_are_added_to_machines_of_the_library() {
    let mut with_bodies = 0;
    for machine in library() {
        let plain = machine.name().trim_end_matches(" with bodies");
        assert_eq!(machine.bodies().is_empty(), plain == machine.name());
        assert_eq!(Machine::named(plain).expect("a machine").axes(), machine.axes());
        with_bodies += usize::from(plain != machine.name());
    }
    assert_eq!(with_bodies, 2);
}

/// Bodies of every shape.
const BODIES: &str = r#"
[[body]]
name = "the head"
moves_with = "spindle"
tool = "head.tool"
position = [0, 0, 5]
axis = [0, 0, 2]
margin = 2
against = ["part", "the table", "the bed"]
[[body]]
name = "the table"
moves_with = "A"
cylinder = { radius = 100, height = 30 }
position = [1, 2, -300]
axis = [0, 3, 0]
[[body]]
name = "the bed"
moves_with = "base"
mesh = "bed.stl"
against = ["tool"]
[[body]]
name = "the post"
moves_with = "X"
box = [[0, 0, 0], [1, 2, 3]]
against = ["tool"]
"#;

#[test]
fn a_file_gives_bodies_in_its_order() {
    let machine = Machine::parse(&format!("{SOUND}{BODIES}"), "shop/mill.toml").expect("a machine");
    let [head, table, bed, post] = machine.bodies() else { panic!("{:?}", machine.bodies()) };
    assert_eq!((&*head.name, head.link, head.margin), ("the head", Link::Axis(Letter::Z), 2.0));
    let BodyShape::Tool { name, place } = &head.shape else { panic!("{head:?}") };
    assert_eq!((&**name, place.tip().z, place.axis().z), ("shop/head.tool", 5.0, 1.0));
    let beside =
        [Opponent::Part, Opponent::Body("the table".into()), Opponent::Body("the bed".into())];
    assert_eq!(head.against, beside);
    let BodyShape::Cylinder { place, radius, .. } = table.shape else { panic!("{table:?}") };
    assert_eq!((table.link, radius, place.axis().y), (Link::Axis(Letter::A), 100.0, 1.0));
    let BodyShape::Mesh { file, .. } = &bed.shape else { panic!("{bed:?}") };
    assert_eq!((bed.link, file.display().to_string()), (Link::Base, "shop/bed.stl".to_owned()));
    assert!(matches!(post.shape, BodyShape::Box(_)) && post.against == [Opponent::Tool]);
}

/// Each fault of a body is refused with the line of its name and a remedy.
#[test]
fn faults_of_bodies_are_refused_with_their_line() {
    let text = format!("{SOUND}{BODIES}");
    let first = 1 + text.lines().position(|line| line.contains("the head")).expect("a line");
    let line = |name: &str| {
        1 + text.lines().position(|line| line == format!("name = {name:?}")).expect("a line")
    };
    assert_eq!(first, line("the head"));
    #[rustfmt::skip]
    let faults = [
        ("name = \"the head\"", "name = \"part\"", "the head", "give it another name"),
        ("name = \"the bed\"", "name = \"the table\"", "the bed", "another body has this name"),
        ("moves_with = \"X\"", "moves_with = \"B\"", "the post", "it moves with `B`: name an axis of the machine"),
        ("box = [[0, 0, 0], [1, 2, 3]]", "", "the post", "give it one shape"),
        ("box = [[0", "tool = \"Ball\"\nbox = [[0", "the post", "give it one shape"),
        ("box = [[0", "axis = [0, 0, 1]\nbox = [[0", "the post", "`axis` is none of its shape"),
        ("mesh = ", "axis = [0, 0, 1]\nmesh = ", "the bed", "turn the mesh in its file"),
        ("[1, 2, 3]]", "[1, -2, 3]]", "the post", "give its lowest corner, then its highest"),
        ("radius = 100", "radius = 0", "the table", "give a `radius` and a `height`"),
        ("axis = [0, 3, 0]", "axis = [0, 0, 0]", "the table", "give a vector"),
        ("margin = 2", "margin = -2", "the head", "give a length of 0 or more"),
        ("margin = 2", "margin = nan", "the head", "give a length of 0 or more"),
        ("position = [1, 2, -300]", "position = [1, inf, -300]", "the table", "give finite coordinates"),
        ("\"the bed\"]", "\"the bad\"]", "the head", "checked against `the bad`: name another body"),
        ("[\"part\", \"the table\"", "[\"part\"", "the table", "it is checked against nothing"),
        ("[\"part\"", "[\"tool\"", "the head", "it moves as one with the tool"),
        ("moves_with = \"spindle\"", "moves_with = \"A\"", "the head", "it moves as one with the part"),
        ("moves_with = \"A\"", "moves_with = \"Z\"", "the head", "it moves as one with the table"),
        ("against = [\"tool\"]\n[[", "against = [\"part\"]\n[[", "the bed", "its shape and that of the part are meshes"),
        ("mesh = \"bed.stl\"", "tool = \"bed.tool\"", "the head", "it and the bed are solids of revolution"),
    ];
    for (sound, faulty, name, message) in faults {
        assert!(text.contains(sound), "{sound}");
        let faulty = text.replacen(sound, faulty, 1);
        let error = Machine::parse(&faulty, "mill.toml").expect_err(message).to_string();
        assert!(
            error.starts_with(&format!("mill.toml:{}: body `", line(name))),
            "{message}\n{error}"
        );
        assert!(error.contains(message) && !error.contains('\n'), "{message}\n{error}");
    }
    // A key that no body has is refused as those of axes are.
    let unknown = text.replace("margin = 2", "margins = 2");
    let error = Machine::parse(&unknown, "mill.toml").expect_err("an unknown key").to_string();
    assert!(error.contains("unknown field `margins`"), "{error}");
}

#[test]
fn a_file_gives_the_axes_in_its_order() {
    let machine = Machine::parse(SOUND, "mill.toml").expect("a machine");
    let letters: Vec<_> = machine.axes().iter().map(|axis| axis.letter).collect();
    assert_eq!(letters, [Letter::X, Letter::A, Letter::Y, Letter::Z]);
    let axis = machine.axis(Letter::A).expect("an axis");
    assert_eq!((axis.side, axis.limits, axis.home), (Side::Table, Some([-90.0, 90.0]), Some(0.0)));
    assert_eq!((axis.point.z, axis.direction.x), (-100.5, 1.0));
    assert_eq!(machine.home(), [None, None, None, Some(0.0), None, None]);
    // Any length of the direction does.
    for vector in ["[7, 0, 0]", "[1e-9, 0.0, 0]", "[4e5, 0, 0]"] {
        let text = SOUND.replace("[1, 0, 0]", vector);
        let machine = Machine::parse(&text, "mill.toml").expect("a machine");
        assert_eq!(machine.axis(Letter::A).expect("an axis").direction.x, 1.0);
    }
}

/// Each fault is refused with its line and a remedy.
#[test]
fn faults_are_refused_with_their_line() {
    let third = "[[axis]]\nletter = \"B\"\nkind = \"rotary\"\ncarries = \"tool\"\ndirection = [0, 1, 0]\npoint = [0, 0, 0]\n";
    let fourth = third.replace("\"B\"", "\"C\"").replace("[0, 1, 0]", "[0, 0, 1]");
    let parallel = third.replace("[0, 1, 0]", "[-1, 0, 0.0009]");
    let carried =
        "[[axis]]\nletter = \"Y\"\nkind = \"linear\"\ncarries = \"table\"\n[[axis]]\nletter";
    #[rustfmt::skip]
    let faults = [
        ("name = \"mill\"\n", "", "1: missing field `name`"),
        ("\"mill\"", "\" \"", "1: the name is empty or has a control character"),
        ("\"mill\"", "\"a\\u001b[31m\"", "1: the name is empty or has a control character"),
        ("\"mill\"", "\"mill", "1: invalid basic string"),
        ("home = 0", "hom = 0", "13: unknown field `hom`, expected one of"),
        ("home = 0", "home = \"0\"", "13: invalid type: string \"0\", expected f64"),
        ("letter = \"A\"", "letter = \"Q\"", "7: unknown variant `Q`, expected one of `X`, `Y`, `Z`, `A`, `B`, `C`"),
        ("carries = \"table\"\ndirection", "direction", "6: missing field `carries`"),
        ("[1, 0, 0]", "[1, 0]", "10: invalid length 2, expected an array of length 3"),
        ("letter = \"Y\"", "letter = \"X\"", "15: axis X is given again, first in line 3: remove one of them"),
        ("kind = \"rotary\"", "kind = \"linear\"", "8: A is the letter of a rotary axis"),
        ("letter = \"Y\"", "letter = \"B\"", "16: B is the letter of a rotary axis"),
        ("\"tool\"\n", "\"tool\"\ndirection = [0, 0, -1]\n", "18: axis Y has another direction than machine coordinate Y"),
        ("\"tool\"\n", "\"tool\"\npoint = [0, 0, 0]\n", "18: axis Y is linear and has no point: remove `point`"),
        ("direction = [1, 0, 0]\n", "", "7: rotary axis A has no `direction`: add `direction = [1, 0, 0]`"),
        ("point = [0, 0, -100.5]\n", "", "7: rotary axis A has no `point`: add `point = [0, 0, 0]`"),
        ("[1, 0, 0]", "[0, 0.0, -0.0]", "10: the direction of axis A is zero"),
        ("[1, 0, 0]", "[nan, 0, 0]", "10: `direction` of axis A is NaN: give a number within ±1e6"),
        ("-100.5", "-inf", "11: `point` of axis A is -inf"),
        ("-100.5", "1e7", "11: `point` of axis A is 10000000"),
        ("[-90, 90]", "[90, -90]", "12: the limits of axis A are 90 and -90: give the lower one first"),
        ("[-90, 90]", "[-90, 2e6]", "12: `limits` of axis A is 2000000"),
        ("home = 0", "home = 91", "13: axis A has its home at 91, outside its limits: correct one of them"),
        ("home = 0", "home = nan", "13: `home` of axis A is NaN"),
        ("[[axis]]\nletter = \"Y\"\nkind = \"linear\"\ncarries = \"tool\"\n[[axis]]\nletter", carried, "15: axis Y is carried by rotary axis A"),
        ("[[axis]]\nletter = \"Y\"", &format!("{third}{fourth}[[axis]]\nletter = \"Y\""), "21: C is a third rotary axis"),
        ("[[axis]]\nletter = \"Y\"", &format!("{parallel}[[axis]]\nletter = \"Y\""), "15: axes A and B are parallel"),
        ("letter = \"Y\"\nkind = \"linear\"\ncarries = \"tool\"\n[[axis]]\n", "", " there is no axis Y: give an [[axis]] for each of X, Y and Z"),
    ];
    for (sound, faulty, message) in faults {
        assert!(SOUND.contains(sound), "{sound}");
        let text = SOUND.replacen(sound, faulty, 1);
        let error = Machine::parse(&text, "mill.toml").expect_err(message).to_string();
        assert!(error.starts_with(&format!("mill.toml:{message}")), "{message}\n{error}");
        assert!(!error.contains('\n'), "{error}");
    }
    // Without any axis, X is the first that is missing.
    let error = Machine::parse("name = \"a\"\naxis = []", "a").expect_err("no axes");
    assert_eq!(error, MachineError::MissingAxis { file: "a".into(), letter: Letter::X });
}

/// Mutants of files are read or refused with a line that exists; those that are read give poses.
#[test]
fn mutants_neither_panic_nor_pass_unchecked() {
    let mut random = Random::new(10);
    let seeds: Vec<_> = texts().into_iter().chain([SOUND]).collect();
    let pieces = [
        "-",
        "0",
        "9",
        "\"",
        "[",
        "]",
        "\n",
        "nan",
        "e9",
        "A",
        "Z",
        "tool",
        "table",
        "=",
        ",",
        " ",
        "ä",
        "\0",
        "[[axis]]\n",
    ];
    let (mut read, count) = (0, cases("MUTANTS", 10_000));
    for case in 0..count {
        let mut text: Vec<char> = seeds[case % seeds.len()].chars().collect();
        for _ in 0..1 + random.below(3) {
            let at = random.below(text.len());
            match random.below(3) {
                0 => drop(text.drain(at..(at + 1 + random.below(12)).min(text.len()))),
                1 => drop(text.splice(at..at, random.pick(&pieces).chars())),
                _ => drop(text.splice(at..=at, random.pick(&pieces).chars())),
            }
        }
        let text: String = text.into_iter().collect();
        match Machine::parse(&text, "mutant") {
            Ok(machine) => {
                let chain = machine.chain(&Default::default()).expect("a setup");
                let pose = chain.pose(&random.joints(&machine, 1e6)).expect("a pose");
                assert!(pose.tip().iter().all(|value| value.is_finite()), "{text}");
                read += 1;
            }
            Err(MachineError::Line { line, .. }) => {
                assert!(line >= 1 && line <= text.split('\n').count(), "{line}\n{text}");
            }
            Err(MachineError::MissingAxis { .. }) => {}
            Err(error) => panic!("{error}\n{text}"),
        }
    }
    println!("{count} mutants, {read} read");
    assert!(read > count / 20 && read < count);
}
