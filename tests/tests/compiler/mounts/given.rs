//! Values that are given to a tool's params.

use super::{mounts, source, tool};
use touchoff_dsl::interpret::Interpreter;
use touchoff_dsl::source::Source;
use touchoff_dsl::{Compiled, compile_with_arguments};
use touchoff_tests::texts::{assert_each_refused, assert_refused, rendered, with_one_error};

const BALL: &str = include_str!("tools/ball.tool");

fn with(text: &str, given: &[&str]) -> Compiled {
    let given: Vec<Source> = given.iter().map(|text| Source::new("given", *text)).collect();
    compile_with_arguments(&source(text), &given)
}

fn radius(compiled: &Compiled) -> f64 {
    compiled.tool().unwrap_or_else(|| panic!("{}", rendered(compiled))).extent.radius
}

#[track_caller]
fn refused(text: &str, given: &[&str], words: &[&str]) {
    assert_refused(&with_one_error(with(text, given)), words);
}

#[test]
fn arguments_replace_defaults() {
    let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-3, "{a}, not {b}");
    near(radius(&with(BALL, &[])), 3.0);
    near(radius(&with(BALL, &["D = 8, flute = 18,"])), 4.0);
    near(radius(&with(BALL, &["D=0.25inch", "flute = 2*9mm"])), 3.175);
    near(radius(&with(BALL, &[""])), 3.0);
}

/// Arguments that are given to the ball, and the words of the error.
const INVALID: &str = "\
Dia = 8 => `BallCutter` has no param `Dia` | it has `D`, `flute` | given:1:1
flut = 8 => did you mean `flute`?
r = 4 => `BallCutter` has no param `r` | defined by `let` here | own.tool:6:9
D = 3deg => `D` is a number, but the given value is an angle | default value
D = flute => unknown name `flute` | use constants only: numbers with or without a unit
D = d => `d` varies from point to point
D = 8 flute = 9 => unexpected `flute` | PARAM = VALUE
D = => unexpected end of the text | PARAM = VALUE
D = .5 => `.5` needs a digit before the decimal point
D = 1/0 => division by zero
D = 2^16^2 => `^` cannot be chained";

#[test]
fn rejects_invalid_arguments() {
    assert_each_refused(INVALID, |given| with_one_error(with(BALL, &[given])));
    refused(BALL, &["D = 8", "D = 9"], &["`D` is given twice", "first value"]);
    refused(
        "tool T { units mm; param D = 6mm; profile { start (0, 0); line to (D, 0), (D, 5), (0, 5) as a; } }",
        &["D = 3mm^2"],
        &["`D` is a length, but the given value is an area"],
    );
}

#[test]
fn a_mount_gives_lengths_in_its_own_unit() {
    // 1 mm is given to a file in inches.
    let thin = tool(&mounts(
        "let thick = 2mm; mount \"inch_flat.tool\" as a with R = thick/2; mount \"er16.tool\" as b at z = 20;",
    ));
    let evaluation = Interpreter::new(&thin).evaluate([0.75, 0.0, 10.0], 1.0);
    assert!((evaluation.expect("inside").depth - 0.25).abs() < 1e-15);
    // A bare number is in the unit of the file that gives it, where the default is a length.
    let evaluation = |given: &str| {
        let text = format!("mount \"inch_flat.tool\" as a with R = {given};");
        tool(&mounts(&text)).extent.radius
    };
    assert!((evaluation("1") - 1.0).abs() < 1e-3);
    // Where it is not, 1 would be 1 mm or 1 inch.
    let bare = mounts("mount \"body.tool\" as a with wide = 1;");
    let words = ["the unit of `wide` is ambiguous: 1mm or 1inch", "write the unit", "`1mm/1mm`"];
    refused(&bare, &[], &words);
    // A ratio is a mere number.
    let ratio = mounts("mount \"inch_flat.tool\" as a with edge = 0.25mm/1mm;");
    let face = Interpreter::new(&tool(&ratio)).evaluate([0.0, 0.0, 0.1], 1.0);
    assert_eq!(face.expect("inside").niceness, 0.25);
}

#[test]
fn params_of_mounted_files_are_linted() {
    let cases = "\
Dia = 8 => `BallCutter` has no param `Dia` | own.tool:1:
D = 8, D = 9 => `D` is given twice
D = 3deg => the given value is an angle |  ball.tool:3:15
D = dia => unknown name `dia`";
    let ball = |given: &str| mounts(&format!("mount \"ball.tool\" as a with {given};"));
    assert_each_refused(cases, |given| with_one_error(with(&ball(given), &[])));
}
