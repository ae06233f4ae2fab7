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
        // The forms of other posts, in `comments_of_post_processors_describe_tools`.
        ("( T1 |2MM BALL ENDMILL| H1 | D1 | DIAMETER - 2. )", None),
        ("( T1 |2MM FLAT ENDMILL| H1 | D1 | DIAMETER - 2. )", Some(1)),
        ("(1 = Ball Nose {2 mm})", None),
        ("(1 = Ball Nose {1/8\"})", Some(1)),
        ("(T1  D=2. CR=0. TAPER=118DEG - ZMIN=-1. - DRILL)", Some(1)),
        ("(T1  D=2. CR=0. TAPER=45DEG - ZMIN=-1. - CHAMFER MILL)", Some(1)),
        ("(T1  D=2,0 CR=1,0 - BALL END MILL)", None),
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

/// A tool that many comments describe is named once.
#[test]
fn comments_about_one_tool_are_counted() {
    let describe = |number: usize| format!("(T1 D={}. CR=0. - FLAT END MILL)\n", number + 3);
    let many: String = (0..1000).map(describe).collect();
    let checked = commented(&many).check(LINUXCNC);
    checked.assert(NONE, &["V0608 1 another T1", "V0608 (and 999 more comments)"], "1000 comments");
    assert_eq!(checked.rows.iter().filter(|row| row.code == "V0608").count(), 1);
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

/// The end of a cutter and the angle of its cone are compared, and a drill may be drawn flat.
#[test]
fn ends_and_cones_are_compared() {
    let pointed = |half: f64| 3.0 / half.to_radians().tan();
    let cone = |height: f64| {
        format!(
            "tool Cone \"c\" {{ units mm; profile {{ start (0, 0); line to (3, {height}) as cone cutting; line to (3, 40) as shank; line \
             to (0, 40) as top; }} niceness cutting: 1; }}"
        )
    };
    let flat = "tool Flat \"f\" { units mm; profile { start (0, 0); line to (3, 0) as face cutting; line to (3, 40) as flute cutting; line \
                to (0, 40) as top; } niceness cutting: 1; }";
    let [chamfer, bit, drill] = [45.0, 30.0, 59.0].map(|half| cone(pointed(half)));
    let lollipop = "tool Ball \"l\" { units mm; profile { start (0, 0); arc to (2.4, 4.8) center (0, 3) as ball cutting; line to (2.4, 40) as neck; \
                    line to (0, 40) as top; } niceness cutting: 1; }";
    for (comment, tool, is_same) in [
        ("(T1 D=6. CR=3. - LOLLIPOP MILL)", lollipop, true),
        ("(T1 D=8. CR=4. - LOLLIPOP MILL)", lollipop, false),
        ("(T1 D=6. CR=0. TAPER=45DEG - CHAMFER MILL)", &*chamfer, true),
        ("(T1 D=6. CR=0. TAPER=45DEG - CHAMFER MILL)", &*bit, false),
        ("(T1 D=6. CR=0. TAPER=45DEG - CHAMFER MILL)", flat, false),
        ("(T1 D=6. CR=0. TAPER=45DEG)", &*chamfer, true),
        ("(T1 D=6. CR=0. TAPER=45DEG)", flat, false),
        ("(1 = V-Bit {60 deg 6 mm})", &*bit, true),
        ("(1 = V-Bit {90 deg 6 mm})", &*bit, false),
        ("(T1 D=6. CR=0. - FLAT END MILL)", &*chamfer, false),
        ("(T1 D=6. CR=0. - FLAT END MILL)", &*drill, false),
        ("(T1 D=6. CR=0. - FLAT END MILL)", flat, true),
        ("(T1 D=6. CR=0. TAPER=118DEG - DRILL)", &*drill, true),
        ("(T1 D=6. CR=0. TAPER=118DEG - DRILL)", flat, true),
        ("(T1 D=6. CR=0. TAPER=118DEG - DRILL)", &*bit, false),
    ] {
        let mut scene = commented(comment).with_file("own.tool", tool);
        scene.job = scene.job.replace("D2Ball", "own.tool");
        let checked = scene.check(LINUXCNC);
        assert_eq!(
            checked.has("V0608 1 another T1"),
            !is_same,
            "{comment}, {tool}: {:#?}",
            checked.rows
        );
    }
}
