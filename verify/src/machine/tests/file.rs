//! Machines as files: those of the library, faults, and mutants.

use super::{Random, cases, library, texts};
use crate::machine::{Letter, Machine, MachineError, Side};

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
    assert_eq!(machines.len(), 12);
    let error = Machine::named("lathe").expect_err("no machine").to_string();
    assert!(error.starts_with(
        "`lathe` is no machine of the library: name one of `3-axis`, `A-C trunnion`,"
    ));
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
