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
        let expected = match name {
            "3-axis" => 0,
            "4-axis" => 1,
            _ => 2,
        };
        assert_eq!(rotary, expected, "{name}");
    }
    assert_eq!(machines.len(), 15);
    let error = Machine::named("lathe").expect_err("no machine");
    assert!(
        matches!(&error, MachineError::UnknownName { known, .. } if known.contains("`A-C trunnion`"))
    );
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
    assert_eq!((name.to_str(), place.tip().z, place.axis().z), (Some("shop/head.tool"), 5.0, 1.0));
    let beside =
        [Opponent::Part, Opponent::Body("the table".into()), Opponent::Body("the bed".into())];
    assert_eq!(head.against, beside);
    let BodyShape::Cylinder { place, radius, .. } = table.shape else { panic!("{table:?}") };
    assert_eq!((table.link, radius, place.axis().y), (Link::Axis(Letter::A), 100.0, 1.0));
    let BodyShape::Mesh { file, .. } = &bed.shape else { panic!("{bed:?}") };
    assert_eq!((bed.link, file.display().to_string()), (Link::Base, "shop/bed.stl".to_owned()));
    assert!(matches!(post.shape, BodyShape::Box(_)) && post.against == [Opponent::Tool]);
}

/// Asserts that a file is refused at a line, with 0 for none, by a code and behind it a word of the sentence, which has one line.
#[track_caller]
fn assert_refused(text: &str, line: usize, pattern: &str) {
    let error = Machine::parse(text, "mill.toml").expect_err(pattern);
    let found = match &error {
        MachineError::Line { line, .. } => *line,
        _ => 0,
    };
    let (code, word) = pattern.split_once(' ').unwrap_or((pattern, ""));
    let said = error.to_string();
    assert_eq!((found, error.code()), (line, code), "{said}");
    assert!(said.contains(word) && !said.contains('\n'), "{pattern}: {said}");
}

/// Each fault of a body is refused with the line of its name.
#[test]
fn faults_of_bodies_are_refused_with_their_line() {
    let text = format!("{SOUND}{BODIES}");
    let first = 1 + text.lines().position(|line| line.contains("the head")).expect("a line");
    let line = |name: &str| {
        1 + text.lines().position(|line| line == format!("name = {name:?}")).expect("a line")
    };
    assert_eq!(first, line("the head"));
    let long = format!("name = {:?}", "p".repeat(101));
    #[rustfmt::skip]
    let faults = [
        ("name = \"the head\"", "name = \"part\"", "the head", "K0301"),
        ("name = \"the post\"", &*long, "the post", "K0301"),
        ("name = \"the bed\"", "name = \"the table\"", "the bed", "K0302"),
        ("moves_with = \"X\"", "moves_with = \"B\"", "the post", "K0303"),
        ("box = [[0, 0, 0], [1, 2, 3]]", "", "the post", "K0304"),
        ("box = [[0", "tool = \"Ball\"\nbox = [[0", "the post", "K0304"),
        ("box = [[0", "axis = [0, 0, 1]\nbox = [[0", "the post", "K0305 axis"),
        ("mesh = ", "axis = [0, 0, 1]\nmesh = ", "the bed", "K0305 axis"),
        ("[1, 2, 3]]", "[1, -2, 3]]", "the post", "K0306 box"),
        ("radius = 100", "radius = 0", "the table", "K0306 cylinder"),
        ("axis = [0, 3, 0]", "axis = [0, 0, 0]", "the table", "K0306 axis"),
        ("margin = 2", "margin = -2", "the head", "K0306 margin"),
        ("margin = 2", "margin = nan", "the head", "K0306 margin"),
        ("position = [1, 2, -300]", "position = [1, inf, -300]", "the table", "K0306 position"),
        ("\"the bed\"]", "\"the bad\"]", "the head", "K0307 the bad"),
        ("[\"part\", \"the table\"", "[\"part\"", "the table", "K0308"),
        ("[\"part\"", "[\"tool\"", "the head", "K0309 the tool"),
        ("moves_with = \"spindle\"", "moves_with = \"A\"", "the head", "K0309 the part"),
        ("moves_with = \"A\"", "moves_with = \"Z\"", "the head", "K0309 the table"),
        ("against = [\"tool\"]\n[[", "against = [\"part\"]\n[[", "the bed", "K0310 the part"),
        ("mesh = \"bed.stl\"", "tool = \"bed.tool\"", "the head", "K0311 the bed"),
    ];
    for (sound, faulty, name, pattern) in faults {
        assert!(text.contains(sound), "{sound}");
        assert_refused(&text.replacen(sound, faulty, 1), line(name), pattern);
    }
    // A key that no body has is refused as those of axes are.
    let unknown = text.replace("margin = 2", "margins = 2");
    let line = 1 + unknown.lines().position(|line| line.contains("margins")).expect("a line");
    assert_refused(&unknown, line, "K0101 `margins`");
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

/// Each fault is refused with its line.
#[test]
fn faults_are_refused_with_their_line() {
    let third = "[[axis]]\nletter = \"B\"\nkind = \"rotary\"\ncarries = \"tool\"\ndirection = [0, 1, 0]\npoint = [0, 0, 0]\n";
    let fourth = third.replace("\"B\"", "\"C\"").replace("[0, 1, 0]", "[0, 0, 1]");
    let parallel = third.replace("[0, 1, 0]", "[-1, 0, 0.0009]");
    let carried =
        "[[axis]]\nletter = \"Y\"\nkind = \"linear\"\ncarries = \"table\"\n[[axis]]\nletter";
    #[rustfmt::skip]
    let faults = [
        ("name = \"mill\"\n", "", 1, "K0101 `name`"),
        ("\"mill\"", "\" \"", 1, "K0102"),
        ("\"mill\"", "\"a\\u001b[31m\"", 1, "K0102"),
        ("\"mill\"", "\"mill", 1, "K0101"),
        ("home = 0", "hom = 0", 13, "K0101 `hom`"),
        ("home = 0", "home = \"0\"", 13, "K0101"),
        ("letter = \"A\"", "letter = \"Q\"", 7, "K0101 `Q`"),
        ("carries = \"table\"\ndirection", "direction", 6, "K0101 `carries`"),
        ("[1, 0, 0]", "[1, 0]", 10, "K0101"),
        ("letter = \"Y\"", "letter = \"X\"", 15, "K0104 line 3"),
        ("kind = \"rotary\"", "kind = \"linear\"", 8, "K0105 A"),
        ("letter = \"Y\"", "letter = \"B\"", 16, "K0105 B"),
        ("\"tool\"\n", "\"tool\"\ndirection = [0, 0, -1]\n", 18, "K0106 Y"),
        ("\"tool\"\n", "\"tool\"\npoint = [0, 0, 0]\n", 18, "K0107 Y"),
        ("direction = [1, 0, 0]\n", "", 7, "K0108 `direction`"),
        ("point = [0, 0, -100.5]\n", "", 7, "K0108 `point`"),
        ("[1, 0, 0]", "[0, 0.0, -0.0]", 10, "K0109 A"),
        ("[1, 0, 0]", "[nan, 0, 0]", 10, "K0110 `direction` of axis A is NaN"),
        ("-100.5", "-inf", 11, "K0110 `point` of axis A is -inf"),
        ("-100.5", "1e7", 11, "K0110 `point` of axis A is 10000000"),
        ("[-90, 90]", "[90, -90]", 12, "K0112 A"),
        ("[-90, 90]", "[-90, 2e6]", 12, "K0110 `limits` of axis A is 2000000"),
        ("home = 0", "home = 91", 13, "K0113 A has its home at 91"),
        ("home = 0", "home = nan", 13, "K0110 `home` of axis A is NaN"),
        ("[[axis]]\nletter = \"Y\"\nkind = \"linear\"\ncarries = \"tool\"\n[[axis]]\nletter", carried, 15, "K0114 Y is carried by rotary axis A"),
        ("[[axis]]\nletter = \"Y\"", &format!("{third}{fourth}[[axis]]\nletter = \"Y\""), 21, "K0115 C"),
        ("[[axis]]\nletter = \"Y\"", &format!("{parallel}[[axis]]\nletter = \"Y\""), 15, "K0116 A and B"),
        ("letter = \"Y\"\nkind = \"linear\"\ncarries = \"tool\"\n[[axis]]\n", "", 0, "K0202 Y"),
    ];
    for (sound, faulty, line, pattern) in faults {
        assert!(SOUND.contains(sound), "{sound}");
        assert_refused(&SOUND.replacen(sound, faulty, 1), line, pattern);
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
