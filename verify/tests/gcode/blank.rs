//! The blank that programs of Heidenhain state.

use crate::common::assert_fault;
use crate::klartext::at_zero;
use touchoff_verify::gcode::{ControlRules, ControlSetup, Interpreter, Step, read};

/// The lines of the blank in DIN/ISO programs move nothing, and are returns and probing on other controls.
#[test]
fn the_blank_of_din_iso_is_passed_over() {
    let iso = "%PART G71 *\nN10 G30 G17 X-50 Y-50 Z-20*\nN20 G31 G90 X+50 Y+50 Z+0*\nN30 T5 G17 S3000*\n\
        N40 G0 G40 G90 X1 Y2 M3*\nN50 G1 Z-2 F200*\nN60 M30*\n";
    let setup = at_zero();
    let mut interpreter = Interpreter::new(iso, &setup).expect("a program");
    let found: Vec<Step> = interpreter.by_ref().collect::<Result<_, _>>().expect("steps");
    assert_eq!(found.iter().map(|step| step.line).collect::<Vec<_>>(), [5, 6]);
    let box_ = [[-50.0, -50.0, -20.0], [50.0, 50.0, 0.0]];
    assert_eq!(interpreter.blank(), Some(box_));
    let inches = iso.replace("G71", "G70");
    let mut interpreter = Interpreter::new(&inches, &setup).expect("a program");
    assert!(interpreter.by_ref().all(|step| step.is_ok()));
    assert_eq!(interpreter.blank(), Some(box_.map(|corner| corner.map(|value| 25.4 * value))));
    // G91 makes the highest corner an increment.
    let text = iso.replace("G31 G90", "G31 G91");
    let error = read(&text, &setup).expect_err("an increment");
    assert_fault(&text, &error, 3, "P0115 G31");
    // The head is a title on other controls.
    let rules = ControlRules::named("fanuc").expect("a control");
    let error = read(iso, &ControlSetup { rules, ..at_zero() }).expect_err("another control");
    assert_fault(iso, &error, 3, "P0115 probing");
}

#[test]
fn the_blank_is_a_box_in_millimetres() {
    let blank = |text: &str| {
        let setup = at_zero();
        let mut interpreter = Interpreter::new(text, &setup).expect("a program");
        assert!(interpreter.by_ref().all(|step| step.is_ok()), "{text}");
        interpreter.blank()
    };
    let of = |lines: &str, unit: &str| {
        blank(&format!("BEGIN PGM A {unit}\nQ1=3\n{lines}\nL X+1 FMAX\nEND PGM A {unit}\n"))
    };
    let corners = "BLK FORM 0.1 Z X-1 Y+0.5 Z-Q1 ; lowest\n2 BLK FORM 0.2 X+2 Y+Q1 Z+0";
    let expected = [[-1.0, 0.5, -3.0], [2.0, 3.0, 0.0]];
    assert_eq!(of(corners, "MM"), Some(expected));
    let inch = expected.map(|corner| corner.map(|value| 25.4 * value));
    assert_eq!(of(corners, "INCH"), Some(inch));
    for other in [
        "BLK FORM CYLINDER Z R50 L10",
        "BLK FORM 0.1 Z X-1 Y+0.5 Z-1",
        "BLK FORM 0.1 Z X-1 Y+0.5 Z-1\nBLK FORM 0.2 IX+2 IY+3 IZ+1",
        "BLK FORM 0.1 Z X+3 Y+0.5 Z-1\nBLK FORM 0.2 X+2 Y+3 Z+1",
    ] {
        assert_eq!(of(other, "MM"), None, "{other}");
    }
}
