//! Values that are given to a tool's params.

use super::{mounts, said, source, tool};
use touchoff_dsl::source::Source;
use touchoff_dsl::{Compiled, compile_with_arguments};

const BALL: &str = include_str!("tools/ball.tool");

fn with(text: &str, given: &[&str]) -> Compiled {
    let given: Vec<Source> = given.iter().map(|text| Source::new("given", *text)).collect();
    compile_with_arguments(&source(text), &given)
}

fn radius(compiled: &Compiled) -> f64 {
    compiled.tool().unwrap_or_else(|| panic!("{}", said(compiled))).extent.radius
}

#[track_caller]
fn refused(text: &str, given: &[&str], words: &[&str]) {
    let compiled = with(text, given);
    let said = said(&compiled);
    assert!(compiled.tool().is_none(), "taken");
    for word in words {
        assert!(said.contains(word), "`{word}` is missing in:\n{said}");
    }
    assert_eq!(said.matches("error[").count(), 1, "{said}");
}

#[test]
fn arguments_replace_defaults() {
    let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-3, "{a}, not {b}");
    near(radius(&with(BALL, &[])), 3.0);
    near(radius(&with(BALL, &["D = 8, flute = 18,"])), 4.0);
    near(radius(&with(BALL, &["D=0.25inch", "flute = 2*9mm"])), 3.175);
    near(radius(&with(BALL, &[""])), 3.0);
}

#[test]
fn rejects_invalid_arguments() {
    refused(
        BALL,
        &["Dia = 8"],
        &["`BallCutter` has no param `Dia`", "it has `D`, `flute`", "given:1:1"],
    );
    refused(BALL, &["flut = 8"], &["did you mean `flute`?"]);
    refused(
        BALL,
        &["r = 4"],
        &["`BallCutter` has no param `r`", "defined by `let` here", "own.tool:6:9"],
    );
    refused(BALL, &["D = 8", "D = 9"], &["`D` is given twice", "first value"]);
    refused(
        BALL,
        &["D = 3deg"],
        &["`D` is a number, but the given value is an angle", "default value"],
    );
    refused(
        "tool T { units mm; param D = 6mm; profile { start (0, 0); line to (D, 0), (D, 5), (0, 5) as a; } }",
        &["D = 3mm^2"],
        &["`D` is a length, but the given value is an area"],
    );
    refused(
        BALL,
        &["D = flute"],
        &["unknown name `flute`", "use constants only: numbers with or without a unit"],
    );
    refused(BALL, &["D = d"], &["`d` varies from point to point"]);
    refused(BALL, &["D = 8 flute = 9"], &["unexpected `flute`", "PARAM = VALUE"]);
    refused(BALL, &["D ="], &["unexpected end of the text", "PARAM = VALUE"]);
    refused(BALL, &["D = .5"], &["`.5` needs a digit before the decimal point"]);
    refused(BALL, &["D = 1/0"], &["division by zero"]);
    refused(BALL, &["D = 2^16^2"], &["`^` cannot be chained"]);
}

#[test]
fn a_mount_gives_lengths_in_its_own_unit() {
    // 1 mm is given to a file in inches.
    let thin = tool(&mounts(
        "let thick = 2mm; mount \"inch_flat.tool\" as a with R = thick/2; mount \"er16.tool\" as b at z = 20;",
    ));
    let evaluation =
        touchoff_dsl::interpret::Interpreter::new(&thin).evaluate([0.75, 0.0, 10.0], 1.0);
    assert!((evaluation.expect("inside").depth - 0.25).abs() < 1e-15);
    // A bare number is in the unit of the file that gives it, where the default is a length.
    let evaluation = |given: &str| {
        let text = format!("mount \"inch_flat.tool\" as a with R = {given};");
        tool(&mounts(&text)).extent.radius
    };
    assert!((evaluation("1") - 1.0).abs() < 1e-3);
    // Where it is not, 1 would be 1 mm or 1 inch.
    let bare = mounts("mount \"body.tool\" as a with wide = 1;");
    refused(
        &bare,
        &[],
        &["the unit of `wide` is ambiguous: 1mm or 1inch", "write the unit", "`1mm/1mm`"],
    );
    // A ratio is a mere number.
    let ratio = mounts("mount \"inch_flat.tool\" as a with edge = 0.25mm/1mm;");
    let face =
        touchoff_dsl::interpret::Interpreter::new(&tool(&ratio)).evaluate([0.0, 0.0, 0.1], 1.0);
    assert_eq!(face.expect("inside").niceness, 0.25);
}

#[test]
fn params_of_mounted_files_are_linted() {
    let ball = |with: &str| mounts(&format!("mount \"ball.tool\" as a with {with};"));
    refused(&ball("Dia = 8"), &[], &["`BallCutter` has no param `Dia`", "own.tool:1:"]);
    refused(&ball("D = 8, D = 9"), &[], &["`D` is given twice"]);
    refused(&ball("D = 3deg"), &[], &["the given value is an angle", " ball.tool:3:15"]);
    refused(&ball("D = dia"), &[], &["unknown name `dia`"]);
}
