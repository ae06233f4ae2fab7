//! The blank that programs of Heidenhain state.

use crate::common::assert_fault;
use crate::klartext::at_zero;
use touchoff_verify::gcode::{
    Blank, BlankDoubt, ControlRules, ControlSetup, Interpreter, Step, SubprogramFile, read,
};

fn plain(corners: [[f64; 3]; 2]) -> Blank {
    Blank { corners, doubt: None }
}

fn inches_of(corners: [[f64; 3]; 2]) -> [[f64; 3]; 2] {
    corners.map(|corner| corner.map(|value| 25.4 * value))
}

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
    assert_eq!(interpreter.blank(), Some(plain(box_)));
    let inches = iso.replace("G71", "G70");
    let mut interpreter = Interpreter::new(&inches, &setup).expect("a program");
    assert!(interpreter.by_ref().all(|step| step.is_ok()));
    assert_eq!(interpreter.blank(), Some(plain(inches_of(box_))));
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
    assert_eq!(of(corners, "MM"), Some(plain(expected)));
    assert_eq!(of(corners, "INCH"), Some(plain(inches_of(expected))));
    for other in [
        "BLK FORM CYLINDER Z R50 L10",
        "BLK FORM 0.1 Z X-1 Y+0.5 Z-1",
        "BLK FORM 0.1 Z X-1 Y+0.5 Z-1\nBLK FORM 0.2 IX+2 IY+3 IZ+1",
        "BLK FORM 0.1 Z X+3 Y+0.5 Z-1\nBLK FORM 0.2 X+2 Y+3 Z+1",
    ] {
        assert_eq!(of(other, "MM"), None, "{other}");
    }
}

/// One blank is clamped: that of the main program, where its coordinates are those of the part.
#[test]
fn a_doubtful_blank_is_told() {
    let form = |top: &str| format!("BLK FORM 0.1 Z X-9 Y-9 Z-9\nBLK FORM 0.2 X+9 Y+9 Z{top}\n");
    let doubt = |lines: &str, called: &str| {
        let text = format!("BEGIN PGM A MM\n{lines}L X+1 Y+1 FMAX\nEND PGM A MM\n");
        let called = format!("BEGIN PGM B MM\n{called}L X+2 FMAX\nEND PGM B MM\n");
        let file = SubprogramFile { name: "B.H".into(), text: called.into() };
        let setup = ControlSetup { subprograms: vec![file], ..at_zero() };
        let mut interpreter = Interpreter::new(&text, &setup).expect("a program");
        let steps: Result<Vec<Step>, _> = interpreter.by_ref().collect();
        assert_eq!(steps.err(), None, "{text}");
        let Blank { corners, doubt } = interpreter.blank().expect("a box");
        assert_eq!(corners[1][2], 1.0, "{text}");
        doubt.map(|(block, doubt)| (block.line, doubt))
    };
    let (low, high) = (form("+1"), form("+5"));
    let shift = "CYCL DEF 7.0 DATUM SHIFT\nCYCL DEF 7.1 Z+10\n";
    for (lines, called, expected) in [
        (low.clone(), "", None),
        (format!("{low}{low}"), "", None),
        (format!("{low}CALL PGM B\n"), &*low, None),
        (format!("{low}{high}"), "", Some((5, BlankDoubt::Second))),
        (format!("{low}BLK FORM CYLINDER Z R50 L10\n"), "", Some((4, BlankDoubt::Second))),
        (format!("{low}CALL PGM B\n"), &*high, Some((4, BlankDoubt::Second))),
        ("CALL PGM B\n".into(), &*low, Some((2, BlankDoubt::Called))),
        (format!("{low}{shift}CALL PGM B\n"), &*low, Some((6, BlankDoubt::Moved))),
        (format!("{shift}{low}"), "", Some((4, BlankDoubt::Moved))),
        (
            format!("CYCL DEF 10.0 ROTATION\nCYCL DEF 10.1 ROT+90\n{low}"),
            "",
            Some((4, BlankDoubt::Moved)),
        ),
        (
            format!("CYCL DEF 8.0 MIRROR IMAGE\nCYCL DEF 8.1 X\n{low}"),
            "",
            Some((4, BlankDoubt::Moved)),
        ),
    ] {
        assert_eq!(doubt(&lines, called), expected, "{lines}");
    }
}
