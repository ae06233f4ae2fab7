//! Tools that the comments of a program describe, against those of the job: a ball of 2 mm.

use crate::in_the_way::named;
use crate::scene::{CLEAN, HAAS, HEIDENHAIN, LINUXCNC, NONE, Scene};

fn commented(comment: &str) -> Scene {
    let text = format!(
        "{comment}\nG21 G90 G17 G54 G94 S9000 M3 F100.\nT1 M6\nS9000 M3\nG43 H1\nG0 X-2. Y0. Z5.\nG1 Z0.\nX2.\nG0 Z20.\nM30\n"
    );
    Scene::of(&text).placed()
}

#[test]
fn another_tool_than_that_of_a_comment_is_named() {
    for (comment, line) in [
        ("(T1  D=2. CR=0. - ZMIN=-1. - FLAT END MILL)", Some(1)),
        ("(T1  D=3. CR=1.5 - ZMIN=-1. - BALL END MILL)", Some(1)),
        ("(T1  D=2. CR=0.5 - ZMIN=-1. - BULL NOSE END MILL)", Some(1)),
        (";@MKR|TOOL|number=1|type=Flat End|diameter=2|cornerradius=0", Some(1)),
        (
            "(T2  D=9. CR=0. - ZMIN=-1. - DRILL)\n( TOOL - 1 DIA. OFF. - 1 LEN. - 1 DIA. - 2.5 )",
            Some(2),
        ),
        ("(T1  D=2. CR=1. - ZMIN=-1. - BALL END MILL)", None),
        ("(T1  D=2. CR=1. TAPER=118DEG - ZMIN=-1. - DRILL)", None),
        (";@MKR|TOOL|number=1|type=Ball End|diameter=2|cornerradius=1", None),
        // A tool that the program does not use.
        ("(T2  D=9. CR=0. - ZMIN=-1. - DRILL)", None),
        ("(D=9. OF THE HOLE)", None),
    ] {
        let checked = commented(comment).check(LINUXCNC);
        match line {
            Some(line) => checked.assert(NONE, &[&*format!("V0608 {line} another T1")], comment),
            None => {
                checked.assert(CLEAN, &[], comment);
                assert!(!checked.has("V0608"), "{comment}: {:#?}", checked.rows);
            }
        }
    }
    let accepted = commented("(T1 D=3. CR=0. - FLAT END MILL)").with("anyway = true");
    accepted.gives(HAAS, CLEAN, &["V0608 1 diameter 2.0000 mm, with an end of radius 1.0000 mm"]);
}

/// Lengths in a comment are in the unit of the program.
#[test]
fn a_comment_has_the_unit_of_its_program() {
    let text = "(T1 D=0.0787 CR=0.0394 - BALL END MILL)\nG20 G90 G17 G54 G94 S9000 M3 F10.\nT1 M6\nS900 M3\nG43 H1\nG0 X-.08 Y0. Z.2\n\
                G1 Z0.\nX.08\nG0 Z1.\nM30\n";
    let inch = Scene::of(text).placed().check(HAAS);
    inch.assert(CLEAN, &[], text);
    assert!(!inch.has("V0608"), "{:#?}", inch.rows);
    Scene::of(&text.replace("D=0.0787", "D=2.")).placed().gives(
        HAAS,
        NONE,
        &["V0608 1 another T1"],
    );
    let klartext = "BEGIN PGM A MM\n1 ; T1 D=2 CR=0 - ZMIN=-1 - flat end mill\nTOOL CALL 1 Z S1000\nL X-2 Y+0 R0 FMAX M3\n\
                    L Z+3 R0 FMAX\nL Z+0 R0 F100\nL X+2\nM30\nEND PGM A MM\n";
    named("a.h", klartext).placed().gives(HEIDENHAIN, NONE, &["V0608 2 another T1"]);
    let ball = klartext.replace("CR=0 - ZMIN=-1 - flat", "CR=1 - ZMIN=-1 - ball");
    assert!(!named("a.h", &ball).placed().check(HEIDENHAIN).has("V0608"));
}
