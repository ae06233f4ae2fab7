//! Programs in Heidenhain Klartext: their steps against values that the tests know beforehand, the same part in ISO words, words
//! that are refused, and damaged programs.

use super::klartext_cycles::levels;
use super::mutants::{Mutants, Seed, read_mutants};
use super::survey::assert_planted_are_found;
use crate::common::{assert_fault, is_fault};
use rand_core::{Rng, SeedableRng};
use rand_pcg::Pcg64Mcg;
use std::collections::BTreeMap;
use std::f64::consts::{FRAC_PI_2, PI};
use touchoff_verify::gcode::{
    Choice, ControlRules, ControlSetup, Plane, Position, Rotation, Rule, Spindle, Step, StepPath,
    Tcp, read,
};

/// A control whose axes are at 0, and stay there at a tool change.
pub(crate) fn at_zero() -> ControlSetup {
    ControlSetup {
        start: [Some(0.0); 6],
        work_offsets: [Some([0.0; 6]); 9],
        lengths: BTreeMap::from([(5, 80.0)]),
        rules: ControlRules::default().with(Rule::ToolChange, Choice::Stays),
        // Endless loops are refused sooner.
        max_repeated: 1_000_000,
        ..ControlSetup::default()
    }
}

pub(crate) fn program(body: &str) -> String {
    format!("0 BEGIN PGM PART MM\n{body}\nEND PGM PART MM\n")
}

pub(crate) fn steps(body: &str) -> Vec<Step> {
    let text = program(body);
    read(&text, &at_zero()).unwrap_or_else(|error| panic!("{text}{error}")).0
}

fn ends(body: &str) -> Vec<Position> {
    steps(body).iter().map(|step| step.end).collect()
}

#[track_caller]
fn assert_near(position: Position, expected: [f64; 3]) {
    for axis in 0..3 {
        let value =
            position[axis].unwrap_or_else(|| panic!("{position:?} is unknown, not {expected:?}"));
        assert!((value - expected[axis]).abs() < 1e-9, "{position:?} is not {expected:?}");
    }
}

#[test]
fn lines_are_absolute_by_increments_and_polar() {
    let found = ends(
        "1 L X+10 Y-5,5 R0 FMAX M3 ; comment\n2 L IX+5 Z+2 F500\n/3 L Y1.25\n* - heading\n4 CC X+10 Y+10\n\
         5 LP PR+20 PA+30\n6 LP IPA+60 IPR-10\n7 CC\n8 LP PR+4 PA-90\nL C+30\nL IC+370 X+0",
    );
    let half = 3f64.sqrt() / 2.0;
    let expected = [
        [10.0, -5.5, 0.0],
        [15.0, -5.5, 2.0],
        [15.0, 1.25, 2.0],
        [10.0 + 20.0 * half, 20.0, 2.0],
        [10.0, 20.0, 2.0],
        [10.0, 16.0, 2.0],
        [10.0, 16.0, 2.0],
        [0.0, 16.0, 2.0],
    ];
    assert_eq!(found.len(), expected.len());
    for (end, expected) in found.iter().zip(expected) {
        assert_near(*end, expected);
    }
    assert_eq!(found[7][5], Some(400.0));
    let steps = steps("L X+1 FMAX\nL Y+1 F200\nL Z+1 FMAX\nL Z+0");
    assert_eq!(steps.iter().map(|step| step.rapid).collect::<Vec<_>>(), [true, false, true, false]);
    assert_eq!(steps.iter().map(|step| step.line).collect::<Vec<_>>(), [2, 3, 4, 5]);
    // The unit of the head.
    let inch =
        "BEGIN PGM A INCH\nL X+1 Y+0 FMAX\nCC X+2 Y+0\nCP IPA-180 DR- F10\nM2\nEND PGM A INCH\n";
    let (found, _) = read(inch, &at_zero()).expect("steps");
    assert_near(found[1].end, [76.2, 0.0, 0.0]);
}

/// Arcs of random centre, radius, start and sweep in all planes, written as C, as CP with either angle, and as CR.
#[test]
fn arcs_are_the_ones_that_were_written() {
    let mut random = Pcg64Mcg::seed_from_u64(3);
    let mut uniform = || (random.next_u64() >> 11) as f64 / 2f64.powi(53);
    let mut worst = [0.0f64; 3];
    for index in 0..6000 {
        let (plane, letters) = [
            (Plane::Xy, ["X", "Y", "Z"]),
            (Plane::Yz, ["Y", "Z", "X"]),
            (Plane::Zx, ["Z", "X", "Y"]),
        ][index % 3];
        let centre = [0, 1].map(|_| 200.0 * uniform() - 100.0);
        let radius = 1.0 + 50.0 * uniform();
        let begin = 360.0 * uniform();
        let form = index / 3 % 4;
        // Only CP states more than a turn, and near half a turn R leaves the centre open to rounding.
        let turns = if form == 1 { 3.0 } else { 0.95 };
        let mut sweep = 5.0 + (360.0 * turns - 10.0) * uniform();
        if form == 3 && (sweep - 180.0).abs() < 12.0 {
            sweep = 90.0;
        }
        let clockwise = index % 2 == 0;
        let signed = if clockwise { -sweep } else { sweep };
        let at = |degrees: f64| {
            let angle = degrees.to_radians();
            [centre[0] + radius * angle.cos(), centre[1] + radius * angle.sin()]
        };
        let (start, end) = (at(begin), at(begin + signed));
        let rise = if form == 3 { 0.0 } else { 10.0 * uniform() };
        let sign = if clockwise { '-' } else { '+' };
        let [u, v, w] = letters;
        let up = if form == 3 { String::new() } else { format!("{w}{rise:.12}") };
        let arc = match form {
            0 => format!("C {u}{:.12} {v}{:.12} {up}", end[0], end[1]),
            1 => format!("CP IPA{signed:+.12} {up}"),
            2 => format!("CP PA{:.12} {up}", begin + signed),
            _ => {
                let radius = if sweep > 180.0 { -radius } else { radius };
                format!("CR {u}{:.12} {v}{:.12} R{radius:+.12}", end[0], end[1])
            }
        };
        let body = format!(
            "L {u}{:.12} {v}{:.12} {w}0 FMAX\nCC {u}{:.12} {v}{:.12}\n{arc} DR{sign} F100",
            start[0], start[1], centre[0], centre[1]
        );
        let steps = steps(&body);
        let StepPath::Arc { plane: found, centre: found_centre, sweep: found_sweep } =
            steps[1].path
        else {
            panic!("{body}\n{:?}", steps[1])
        };
        assert_eq!(found, plane, "{body}");
        worst[0] = worst[0].max((found_centre[0] - centre[0]).hypot(found_centre[1] - centre[1]));
        worst[1] = worst[1].max((found_sweep - signed.to_radians()).abs());
        let [first, second] = plane.axes();
        for (axis, wanted) in [(first, end[0]), (second, end[1]), (plane.normal(), rise)] {
            worst[2] = worst[2].max((steps[1].end[axis].expect("a coordinate") - wanted).abs());
        }
    }
    println!("centre within {:.1e} mm, sweep {:.1e}, end {:.1e} mm", worst[0], worst[1], worst[2]);
    assert!(worst[0] < 1e-8 && worst[1] < 1e-9 && worst[2] < 1e-9, "{worst:?}");
}

#[test]
fn tangent_arcs_and_corners_meet_their_lines() {
    let found = steps(
        "L X+0 Y+0 FMAX\nL X+10 F100\nCT X+20 Y+10\nCT X+10 Y+20\nCC X+10 Y+10\nCTP PR+10 PA+180",
    );
    let arcs: Vec<_> = found.iter().map(|step| step.path).collect();
    let quarter = |centre| StepPath::Arc { plane: Plane::Xy, centre, sweep: FRAC_PI_2 };
    assert_eq!(arcs[2], quarter([10.0, 10.0]));
    assert_eq!(arcs[3], quarter([10.0, 10.0]));
    assert_near(found[4].end, [0.0, 10.0, 0.0]);
    assert!(
        matches!(arcs[4], StepPath::Arc { sweep, .. } if (sweep - FRAC_PI_2).abs() < 1e-12),
        "{arcs:?}"
    );
    let corner = |word: &str| {
        steps(&format!("L X+0 Y+0 FMAX\nL X+10 F100\n{word}\nL IY+10\n{word}\nL X-10 IY+0\nL X-20"))
    };
    let round = corner("RND R2 F50");
    let expected = [
        ([8.0, 0.0], None),
        ([10.0, 2.0], Some(([8.0, 2.0], FRAC_PI_2))),
        ([10.0, 8.0], None),
        ([8.0, 10.0], Some(([8.0, 8.0], FRAC_PI_2))),
        ([-10.0, 10.0], None),
        ([-20.0, 10.0], None),
    ];
    assert_eq!(round.len(), 1 + expected.len());
    for (step, (end, arc)) in round[1..].iter().zip(expected) {
        assert_near(step.end, [end[0], end[1], 0.0]);
        match (step.path, arc) {
            (StepPath::Line, None) => {}
            (StepPath::Arc { plane: Plane::Xy, centre, sweep }, Some((wanted, angle))) => {
                assert!((centre[0] - wanted[0]).hypot(centre[1] - wanted[1]) < 1e-12);
                assert!((sweep - angle).abs() < 1e-12);
            }
            other => panic!("{other:?}"),
        }
    }
    let chamfered = corner("CHF 2");
    let points: Vec<_> = chamfered[1..].iter().map(|step| [step.end[0], step.end[1]]).collect();
    let expected =
        [[8.0, 0.0], [10.0, 2.0], [10.0, 8.0], [8.0, 10.0], [-10.0, 10.0], [-20.0, 10.0]];
    assert_eq!(points, expected.map(|point| point.map(Some)));
    // A corner of 60 degrees: the arc touches both lines.
    let sharp =
        steps("L X+0 Y+0 FMAX\nCC X+0 Y+0\nL X+20 F100\nRND R3\nL X+10 Y+17.320508075688775");
    let StepPath::Arc { centre, sweep, .. } = sharp[2].path else { panic!("{:?}", sharp[2]) };
    let start = sharp[1].end[0].expect("X");
    assert!((centre[0] - start).abs() < 1e-12 && (centre[1] - 3.0).abs() < 1e-12);
    assert!((sweep - 2.0 * PI / 3.0).abs() < 1e-12);
    assert!((20.0 - start - 3.0 * (PI / 3.0).tan()).abs() < 1e-12);
}

#[test]
fn the_same_part_in_iso_words_has_the_same_steps() {
    let klartext = program(
        "TOOL CALL 5 Z S3000 F400\nM3\nL X+0 Y+0 R0 FMAX\nL Z-2 F200\nL X+10 Y+5\nCC X+20 Y+5\nC X+20 Y-5 DR-\n\
         CR X+30 Y-5 R+5 DR+\nCC X+25 Y-5\nC X+30 Y-5 Z-3 DR+\nL Z+50 FMAX\nL X+1.5 Y+2\nM5\nM30",
    );
    let iso = "%PART G71 *\nN10 T5 G17 G90 S3000 F400*\nN20 M3*\nN30 G0 X0 Y0*\nN40 G1 Z-2 F200*\nN50 X10 Y5*\n\
        N60 G2 X20 Y-5 I20 J5*\nN70 G3 X30 Y-5 R5*\nN80 G3 X30 Y-5 Z-3 I25 J-5*\nN90 G0 Z50*\nN100 G1 X1.5 Y2*\nN110 M5*\n\
        N120 M30*\n";
    let rules = ControlRules::named("heidenhain").expect("a control");
    let rules = rules.with(Rule::ToolChange, Choice::Stays);
    let setup = ControlSetup { rules, ..at_zero() };
    let [klartext, iso] = [klartext.as_str(), iso].map(|text| {
        let mut steps = read(text, &setup).unwrap_or_else(|error| panic!("{text}{error}")).0;
        // Feeds of Klartext are not known.
        steps.iter_mut().for_each(|step| step.line = 0);
        steps
    });
    assert_eq!(klartext.len(), 8);
    assert_eq!(klartext, iso);
}

#[test]
fn labels_call_repeat_and_jump() {
    let at = |body: &str| ends(body).iter().map(|end| end[0].expect("X")).collect::<Vec<_>>();
    // A subprogram that is called twice, also by its name.
    assert_eq!(
        at(
            "CALL LBL 7\nCALL LBL \"hole 1\"\nCALL LBL 7\nM30\nLBL 7\nL IX+1 FMAX\nLBL 0\nLBL \"hole 1\"\nL X+50 FMAX\nCALL LBL 7\nLBL 0"
        ),
        [1.0, 50.0, 51.0, 52.0]
    );
    // A section is executed once and as often as REP says, nested ones each time anew.
    assert_eq!(at("LBL 1\nL IX+1 FMAX\nCALL LBL 1 REP 3/3"), [1.0, 2.0, 3.0, 4.0]);
    assert_eq!(
        at("LBL 1\nLBL 2\nL IX+1 FMAX\nCALL LBL 2 REP 2\nL IX+100 FMAX\nCALL LBL 1 REP1"),
        [1.0, 2.0, 3.0, 103.0, 104.0, 105.0, 106.0, 206.0]
    );
    // The limit of a loop is a parameter. LBL 0 of a subprogram that is run into does nothing.
    assert_eq!(
        at(
            "Q1 = 0\nLBL 3\nL X+Q1 FMAX\nFN 1: Q1 = +Q1 + +2\nFN 12: IF +Q1 LT +5 GOTO LBL 3\nLBL 4\nL X+9 FMAX\nLBL 0\nL X+8 FMAX"
        ),
        [0.0, 2.0, 4.0, 9.0, 8.0]
    );
    // A section that a jump has left begins anew.
    assert_eq!(
        at(
            "Q1 = 0\nLBL 1\nQ1 = Q1 + 1\nL X+Q1 FMAX\nIF +Q1 EQU +2 GOTO LBL 5\nCALL LBL 1 REP 2\nM30\nLBL 5\nCALL LBL 6\nM30\nLBL 6\nL X+0 FMAX\nLBL 0"
        ),
        [1.0, 2.0, 0.0]
    );
}

/// A control wraps a comment that is too long for a line; a parameter of a cycle after such a sign is none.
#[test]
fn wrapped_comments_go_on() {
    let wrapped = "; the axis Z on the~\n Head\nQ1 = 3 ; half of the key~\n width)~\n and more\nL X+Q1 FMAX ;there~\n Y+4";
    assert_near(ends(wrapped)[0], [3.0, 4.0, 0.0]);
    // Words of a block in lower case are no prose.
    assert!(steps("L X+5 ;there~\n fmax")[0].rapid);
    let hole = "TOOL CALL 5 Z S1\nL X+1 FMAX\nCYCL DEF 240 C ~\n Q200=+2 ;clearance~\n Q201=-3 ;depth ~\n Q343=+0~\n Q203=+0 ~\n Q204=+9\nCYCL CALL";
    assert_eq!(levels(hole), [(true, 2.0), (false, -3.0), (true, 9.0)]);
}

#[test]
fn formulas_have_their_values() {
    for (formula, value) in [
        ("5 * 3 + 2 * 10", 35.0),
        ("SQ 10 - 3^3", 73.0),
        ("(1 + 2) * -4", -12.0),
        ("12 * ( 5 - 3 ) / 8", 3.0),
        ("SIN 30 + COS60", 1.0),
        ("TAN 45 * 10", 10.0),
        ("ATAN 1 + ASIN 0.5 + ACOS 0.5", 135.0),
        ("SQRT 2 * SQRT 2", 2.0),
        ("ABS -7,5 + INT 3.9 + FRAC 2.25", 10.75),
        ("SGN -3 + NEG 4 + LN EXP 2", -3.0),
        ("7 % 4 + PI", 3.0 + PI),
        ("+Q20 + QL1 - QR2", 16.0),
        ("SINQ20 * 2", 2.0 * 21f64.to_radians().sin()),
    ] {
        let body = format!("Q20 = 21\nQL1 = 5\nQR2 = 10\nQ1 = {formula}\nL X+Q1 FMAX");
        let found = ends(&body)[0][0].expect("X");
        assert!((found - value).abs() < 1e-12, "{formula} is {found}, not {value}");
    }
    for (function, value) in [
        ("FN 0: Q1 = -3.5", -3.5),
        ("FN 1: Q1 = +3 + -5", -2.0),
        ("FN 2: Q1 = +3 - -5", 8.0),
        ("FN 3: Q1 = +3 * +5", 15.0),
        ("FN 4: Q1 = +3 DIV +5", 0.6),
        ("FN 5: Q1 = SQRT 16", 4.0),
        ("FN 6: Q1 = SIN -90", -1.0),
        ("FN 7: Q1 = COS +180", -1.0),
        ("FN 8: Q1 = +3 LEN +4", 5.0),
        ("FN 13: Q1 = +1 ANG -1", 135.0),
    ] {
        let found = ends(&format!("{function}\nL X+Q1 FMAX"))[0][0].expect("X");
        assert!((found - value).abs() < 1e-12, "{function} is {found}, not {value}");
    }
}

/// Returns the rotation by degrees about an axis, as rows.
fn turn(axis: usize, degrees: f64) -> [[f64; 3]; 3] {
    let (s, c) = degrees.to_radians().sin_cos();
    match axis {
        0 => [[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]],
        1 => [[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]],
        _ => [[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]],
    }
}

fn applied(rotation: [[f64; 3]; 3], point: [f64; 3]) -> [f64; 3] {
    rotation.map(|row| row.iter().zip(point).map(|(entry, value)| entry * value).sum())
}

#[test]
fn coordinates_are_shifted_mirrored_rotated_and_tilted() {
    let last = |body: &str| {
        let steps = steps(body);
        let step = steps.last().expect("a step");
        step.state.to_workpiece(step.end)
    };
    let shift =
        "CYCL DEF 7.0 DATUM SHIFT\nCYCL DEF 7.1 X+10\nCYCL DEF 7.2 Y-20\nCYCL DEF 7.3 IZ+5\n";
    assert_near(last(&format!("{shift}L X+1 Y+2 Z+3 FMAX")), [11.0, -18.0, 8.0]);
    assert_near(
        last(&format!("{shift}CYCL DEF 8.0 MIRROR\nCYCL DEF 8.1 X\nL X+1 Y+2 Z+3 FMAX")),
        [9.0, -18.0, 8.0],
    );
    let reset = "CYCL DEF 8.0 MIRROR\nCYCL DEF 8.1\nTRANS DATUM RESET\n";
    assert_near(last(&format!("{shift}{reset}L X+1 Y+2 Z+3 FMAX")), [1.0, 2.0, 3.0]);
    // A mirrored arc turns the other way.
    let mirrored = steps(
        "CYCL DEF 8.1 X\nL X+10 Y+0 FMAX\nCC X+0 Y+0\nC X+0 Y+10 DR+ F100\nCP IPA+90 DR+\nL IX+1",
    );
    let sweeps: Vec<_> = mirrored[1..3]
        .iter()
        .map(|step| match step.path {
            StepPath::Arc { centre, sweep, .. } => (centre, sweep),
            path => panic!("{path:?}"),
        })
        .collect();
    assert!(
        sweeps
            .iter()
            .all(|(centre, sweep)| *centre == [0.0; 2] && (sweep + FRAC_PI_2).abs() < 1e-12)
    );
    assert_near(mirrored[3].end, [9.0, 0.0, 0.0]);
    let rotation = "CYCL DEF 10.0 ROTATION\nCYCL DEF 10.1 ROT+30\n";
    let [x, y, z] = applied(turn(2, 30.0), [1.0, 2.0, 3.0]);
    assert_near(
        last(&format!("{shift}{rotation}L X+1 Y+2 Z+3 FMAX")),
        [x + 10.0, y - 20.0, z + 5.0],
    );
    // The angles of a plane are about fixed axes, in the order A, B, C; those of Euler about moving ones.
    let tilted = |plane: &str, more: &str| {
        last(&format!(
            "TOOL CALL 5 Z S1\n{shift}PLANE {plane} TURN MB10 FMAX\n{more}L X+1 Y+2 FMAX\nL Z+3 FMAX"
        ))
    };
    let shifted = |[x, y, z]: [f64; 3]| [x + 10.0, y - 20.0, z + 5.0];
    let spatial = [(0, 20.0), (1, -35.0), (2, 50.0)];
    let expected =
        spatial.into_iter().fold([1.0, 2.0, 3.0], |p, (axis, a)| applied(turn(axis, a), p));
    assert_near(tilted("SPATIAL SPA+20 SPB-35 SPC+50 COORD ROT", ""), shifted(expected));
    let euler = [(2, 20.0), (0, -35.0), (2, 50.0)];
    let expected =
        euler.into_iter().rev().fold([1.0, 2.0, 3.0], |p, (axis, a)| applied(turn(axis, a), p));
    assert_near(tilted("EULER EULPR+20 EULNU-35 EULROT+50", ""), shifted(expected));
    // z along (0, -1, 1), x along x.
    let expected = applied(turn(0, 45.0), [1.0, 2.0, 3.0]);
    assert_near(tilted("VECTOR BX+2 BY+0 BZ+0 NX+0 NY-0.5 NZ+0.5", ""), shifted(expected));
    let more = "CYCL DEF 10.0 ROTATION\nCYCL DEF 10.1 ROT+90\n";
    let expected = applied(turn(0, 45.0), applied(turn(2, 90.0), [1.0, 2.0, 3.0]));
    assert_near(tilted("SPATIAL SPA+45 SPB+0 SPC+0", more), shifted(expected));
    // An allowance on the length raises the tip, along z of a plane, until the next tool.
    let raised = "TOOL CALL 5 Z S1 DL+0.5\nCYCL DEF 7.1 X+10\n";
    assert_near(last(&format!("{raised}L X+1 Y+2 Z+3 FMAX")), [11.0, 2.0, 3.5]);
    assert_near(last(&format!("{raised}TOOL CALL 5 Z S1\nL X+1 Y+2 Z+3 FMAX")), [11.0, 2.0, 3.0]);
    let [x, y, z] = applied(turn(0, 45.0), [1.0, 2.0, 3.5]);
    assert_near(
        last(&format!("{raised}PLANE SPATIAL SPA+45 SPB+0 SPC+0 TURN\nL X+1 Y+2 FMAX\nL Z+3 FMAX")),
        [x + 10.0, y, z],
    );
    // A plane without angles asks for no turn.
    let flat = last("TOOL CALL 5 Z S1\nPLANE SPATIAL SPA+0 SPB+0 SPC+0 STAY\nL X+1 Y+2 Z+3 FMAX");
    assert_near(flat, [1.0, 2.0, 3.0]);
    // A plane that turns the axes by its angles, one more turn, and the way back.
    let plane = "TOOL CALL 5 Z S1\nPLANE SPATIAL SPA+30 SPB+0 SPC+0 STAY\nPLANE RELATIV SPB+40 STAY\n\
        L A+Q120 B+Q121 C+Q122 R0 FMAX\nL X+1 Y+2 FMAX\n";
    let found = steps(&format!("{plane}PLANE RESET TURN FMAX\nL X+1 Y+2 Z+3 FMAX"));
    assert_eq!(found[0].path, StepPath::Align);
    let Rotation::Tilted { frame, aligned: true } = found[1].state.rotation else {
        panic!("{:?}", found[1].state)
    };
    let normal = applied(turn(0, 30.0), applied(turn(1, 40.0), [0.0, 0.0, 1.0]));
    for (found, expected) in frame.rotation.column(2).iter().zip(normal) {
        assert!((found - expected).abs() < 1e-12);
    }
    assert_eq!(found[2].end[3..], [Some(0.0); 3]);
    assert_eq!(found[3].state.rotation, Rotation::Off);
}

#[test]
fn m_words_hold_where_the_manual_says() {
    let found = steps(
        "TOOL CALL 5 Z S1000\nL X+5 Y+6 Z+7 FMAX M3\nL Z-1 F100 M5\nL X+0 F100 M13\nL Z+0 FMAX M91\nL X+1 Y+2 F50 M91\n\
         L M140 MB30\nL M140 MB MAX F500\nM126\nL C+10 FMAX\nM127\nL C+20 FMAX\nL M128 F1000\nL A+5 FMAX\nM129\nL A+0 FMAX",
    );
    assert_eq!(found[1].spindle, Spindle::Clockwise);
    assert_eq!(found[2].spindle, Spindle::Clockwise);
    // The gauge point is at the machine's Z0, the tip 80 mm below.
    assert_eq!(found[3].end[2], Some(-80.0));
    assert!(found[3].rapid && found[3].is_homeward && !found[4].rapid);
    assert_near(found[4].end, [1.0, 2.0, -80.0]);
    assert_near(found[5].end, [1.0, 2.0, -50.0]);
    assert!(found[5].rapid && !found[5].is_homeward);
    assert_eq!((found[6].end[2], found[6].commanded[2], found[6].is_homeward), (None, true, true));
    let limited = ControlSetup { top: Some(200.0), ..at_zero() };
    let (topped, _) = read(&program("TOOL CALL 5 Z S1\nL M140 MB MAX"), &limited).expect("steps");
    // The tip is 80 mm below the gauge point.
    assert_eq!((topped[0].end[2], topped[0].is_homeward), (Some(120.0), true));
    assert!(found[7].state.shorter_way && !found[8].state.shorter_way);
    assert_eq!((found[9].state.tcp, found[10].state.tcp), (Tcp::Rotary, Tcp::Off));
    let tcpm = "TOOL CALL 5 Z S1\nFUNCTION TCPM F TCP AXIS POS PATHCTRL AXIS REFPNT TIP-TIP\nL A+5 FMAX\nFUNCTION RESET TCPM\nL A+0 FMAX";
    let found = steps(tcpm);
    assert_eq!((found[0].state.tcp, found[1].state.tcp), (Tcp::Rotary, Tcp::Off));
    // The length that the program states.
    let own = steps("TOOL DEF 9 L+50 R+3\nTOOL CALL 9 Z S1\nL Z+0 FMAX M91");
    assert_eq!(own[0].end[2], Some(-50.0));
    let preset = "CYCL DEF 247 DATUM SETTING ~\n Q339=+3 ;NUMBER\nL X+1 FMAX\nCYCL DEF 247 DATUM ~\n Q339=+3\nL X+2 FMAX";
    assert_eq!(ends(preset).len(), 2);
}

/// Presets with stated work offsets have the positions of G54 and G55 in ISO words, and end shifts.
#[test]
fn presets_are_work_offsets_that_are_stated() {
    let mut setup = at_zero();
    setup.presets = BTreeMap::from([(3, 1), (7, 2)]);
    setup.work_offsets[1] = Some([100.0, 50.0, -10.0, 0.0, 0.0, 0.0]);
    let select = |number: u32| format!("CYCL DEF 247 DATUM ~\n Q339=+{number}\n");
    let at = |body: &str| {
        let text = program(body);
        let steps = read(&text, &setup).unwrap_or_else(|error| panic!("{text}{error}")).0;
        let last = steps.last().expect("a step").clone();
        let origin = last.state.origin;
        [0, 1, 2].map(|axis| last.end[axis].expect("known") + origin[axis].expect("known"))
    };
    let line = "L X+1 Y+2 Z+3 FMAX";
    assert_eq!(at(&format!("{}{line}", select(3))), [1.0, 2.0, 3.0]);
    assert_eq!(at(&format!("{}{line}", select(7))), [101.0, 52.0, -7.0]);
    let both = format!("{}CYCL DEF 7.1 X+9\n{line}\n{}{line}", select(3), select(7));
    assert_eq!(at(&both), [101.0, 52.0, -7.0]);
    assert_eq!(at(&format!("{both}\n{}L X+0 Y+0 Z+0 FMAX", select(3))), [0.0; 3]);
    let error = read(&program(&format!("{}{line}", select(4))), &setup).expect_err("preset 4");
    assert!(is_fault(&error, "P0115 a preset whose work offset is not stated"), "{error}");
}

/// A contour with lines, arcs and a rounded corner has the path of the tool's centre of the same contour in ISO words.
#[test]
fn a_compensated_contour_has_the_path_of_iso_words() {
    let klartext = "TOOL DEF 5 L+80 R+4\nTOOL CALL 5 Z S3000 F500 DR+0.5\nM3\nL X-20 Y-20 FMAX\nL Z-5 R0 F500\nL X+0 Y+0 RL\nL Y+40\n\
        RND R10\nL X+40\nCC X+40 Y+20\nC X+40 Y+0 DR-\nL X+0 Y+0\nL X-20 Y-20 R0\nL Z+50 FMAX";
    let iso = "%PART G71 *\nG90 S3000\nT5\nM3\nG0 X-20. Y-20.\nG1 Z-5. F500.\nG41 X0. Y0.\nY30.\nG2 X10. Y40. I10. J40.\nG1 X40.\n\
        G2 X40. Y0. I40. J20.\nG1 X0. Y0.\nG40 X-20. Y-20.\nG0 Z50.\nM30\n";
    let found = steps(klartext);
    let rules = ControlRules::named("heidenhain").expect("a control");
    let setup = ControlSetup {
        radius_offsets: BTreeMap::from([(5, 4.5)]),
        rules: rules.with(Rule::ToolChange, Choice::Stays),
        ..at_zero()
    };
    let wanted = read(&iso.replace("I10. J40.", "I10. J30."), &setup).expect("a program").0;
    let path = |steps: &[Step]| -> Vec<(bool, [f64; 3], bool)> {
        let moving = steps.iter().filter(|step| step.commanded.contains(&true));
        let path = moving.map(|step| {
            let end =
                [0, 1, 2].map(|axis| 1e-9 * (1e9 * step.end[axis].expect("a number")).round());
            (step.rapid, end, matches!(step.path, StepPath::Arc { .. }))
        });
        path.collect()
    };
    assert_eq!(path(&found), path(&wanted));
    // The tool is beside the left edge by its radius and DR.
    assert!(found.iter().any(|step| step.end[0] == Some(-4.5) && step.end[1] == Some(30.0)));
    let text = program(&klartext.replace("L X-20 Y-20 R0\n", ""));
    let error = read(&text, &at_zero()).expect_err("the end of the program");
    assert!(is_fault(&error, "P0120 cutter compensation is in force"), "{error}");
    for word in [
        "TOOL CALL 5 Z S1",
        "CYCL DEF 7.1 X+1",
        "PLANE RESET STAY",
        "L Z+0 FMAX M91",
        "L M140 MB MAX",
        "M128",
    ] {
        let text =
            program(&klartext.replace("L Y+40\nRND R10", &format!("L Y+40\n{word}\nL Y+41")));
        let error = read(&text, &at_zero()).expect_err(word);
        assert!(is_fault(&error, "P0120 cutter compensation is in force"), "{word}: {error}");
        assert_eq!(error.line, 9, "{word}: {error}");
    }
}

#[test]
fn what_is_not_read_is_named_with_its_line() {
    for (body, line, message) in [
        ("L X+1 RL F100", 2, "P0119 a tool in the spindle"),
        ("TOOL CALL 5 Z S1\nL X+1 RR F100", 3, "P0401 radius offset 5"),
        ("L X+1 R+ F100", 2, "P0115 R+ is cutter compensation of a motion along one axis"),
        ("CYCL DEF 8.0 M\nCYCL DEF 8.1 X\nL X+1 RL F100", 4, "P0120 RL"),
        ("L X+1 F100\nCC X+0 Y+0\nC X+1 Y+0 DR+ RL", 4, "P0120 RL"),
        ("L X+1", 2, "P0122 L"),
        ("CC X+0 Y+0\nC X+0 Y+1 DR+", 3, "P0122 C"),
        ("FOO BAR", 2, "P0114 `FOO BAR`"),
        ("L X+Q5 FMAX", 2, "P0210 Q5"),
        ("L X+Q108 FMAX", 2, "P0211 Q108"),
        ("Q150 = 1", 2, "P0211 Q150"),
        ("L X+1 FMAX\nL A+Q120 FMAX", 3, "P0119 Q120"),
        ("Q1 = Q2", 2, "P0210 Q2"),
        ("Q1 = 1 / 0", 2, "P0216 `/`"),
        ("Q1 = -2 ^ 2", 2, "P0115 ^ is a power beside a sign"),
        ("Q1 = (2", 2, "P0110 `)`"),
        ("Q1 = FOO 2", 2, "P0203 `FOO`"),
        ("Q2000 = 1", 2, "P0110 write Q0 to Q1999"),
        ("QS1 = \"a\"", 2, "P0115 QS1"),
        ("C X+1 Y+1 DR+ F100", 2, "P0119 C"),
        ("CC X+0 Y+0\nC X+1 Y+1 F100", 3, "P0119 C"),
        ("CC X+5 Y+0\nCP IPA+90 DR- F100", 3, "P0120 IPA90"),
        ("CC X+0 Y+0\nCP IPA+90 DR+ F100", 3, "P0306"),
        ("CR X+10 Y+0 R+1 DR+ F100", 2, "P0307"),
        ("CT X+1 Y+1 F100", 2, "P0119 CT"),
        ("RND R2", 2, "P0119 RND"),
        ("L X+1 F100\nRND R5\nL Y+1", 4, "P0120 RND"),
        ("L X+1 F100\nRND R0.2\nL X+0", 4, "P0120 RND"),
        ("L X+1 F100\nRND R9\nCR X+2 Y+1 R5 DR+", 4, "P0120 RND"),
        ("L X+9 F100\nRND R1\nL Z+5", 4, "P0115 RND"),
        ("L X+9 F100\nRND R1\nL Y+5 FMAX", 4, "P0115 RND"),
        ("L X+9 FMAX\nRND R1\nL Y+5 F100", 2, "P0115 RND"),
        ("L X+9 F100\nRND R1\nTOOL CALL 1 Z S1", 4, "P0119 RND"),
        ("L X+9 F100\nRND R1\nL M140 MB5", 4, "P0119 RND"),
        ("L X+9 F100\nRND R1", 4, "P0119 RND"),
        (
            "TOOL DEF 5 L+80 R+4\nTOOL CALL 5 Z S1\nL X-9 Y-9 R0 F100\nL X+0 Y+0 RL\nL Y+40\nRND R5\nL X+40 R0",
            8,
            "P0120 RND",
        ),
        ("TOOL DEF 5 L+80 R+4\nTOOL CALL 5 Z S1\nL X+9 R0 F100\nRND R1\nL Y+40 RR", 6, "P0120 RND"),
        (
            "TOOL CALL 5 Z S1\nL Z+50 FMAX\nCYCL DEF 200 D ~\n Q200=+2 ~\n Q201=-3 ~\n Q202=+3 ~\n Q203=+0 ~\n Q204=+9\nL X+9 F100\nCYCL CALL POS X+1 Y+1 Z+0 F100\nRND R1\nL Y+9 F100",
            11,
            "P0119 RND",
        ),
        ("L X+10 F100\n/RND R1\nL Y+5", 2, "P0115 / is a corner in an optional block"),
        ("L X+10 F100\nCHF 1\nL X+5 Y+5", 4, "P0115 CHF"),
        ("L X+9 F100\nCHF 1\nCR X+8 Y+1 R+1 DR+", 4, "P0115 CHF"),
        ("L X+1 FMAX M777", 2, "P0114 M777"),
        ("L X+1 U+2 FMAX", 2, "P0113"),
        ("L X+1 X+2 FMAX", 2, "P0116 X"),
        ("L X+1 FMAX M3 M4", 2, "P0117 M3"),
        ("L X+1 R5 FMAX", 2, "P0115 R"),
        ("L X+1 DR+ FMAX", 2, "P0115 DR"),
        ("L PR+1 PA+2 FMAX", 2, "P0115 PR"),
        ("CC X+0 Y+0\nC X+1 PA+2 DR+ F1", 3, "P0115 PA"),
        ("CC X+0 Y+0 R5", 2, "P0110 CC"),
        ("L X+1 KOO FMAX", 2, "P0110 `KOO FMAX`"),
        ("TOOL CALL \"MILL\" Z S1", 2, "P0115 TOOL"),
        ("TOOL CALL 5 X S1", 2, "P0115 TOOL"),
        ("TOOL CALL 5 Z S1 DL+0.2\nM128", 3, "P0120 M128"),
        ("TOOL CALL 5 Z S1\nM128\nTOOL CALL S2 DL-1", 4, "P0120 DL"),
        ("CALL LBL 9", 2, "P0111 LBL 9"),
        ("CALL LBL \"a\"", 2, "P0111 LBL `a`"),
        ("LBL 1\nLBL 1", 3, "P0127 line 2"),
        ("LBL 1\nL IX+1 FMAX\nLBL 0\nCALL LBL 1 REP 2", 5, "P0120 LBL"),
        ("CALL LBL 1 REP 2\nLBL 1", 2, "P0120 REP"),
        ("LBL 1\nCALL LBL 1\nLBL 0", 3, "P0139"),
        ("LBL 1\nFN 9: IF +1 EQU +1 GOTO LBL 1", 3, "P0144"),
        ("FN 9: IF +1 EQU +1.0000000000001 GOTO LBL 1", 2, "P0120 differ by rounding alone"),
        ("CYCL CALL", 2, "P0119 a call of a cycle needs a drilling cycle"),
        ("CYCL DEF 200 DRILL ~\n Q200=2", 2, "P0119 CYCL"),
        ("CYCL DEF 777 X", 2, "P0115 CYCL"),
        ("CYCL DEF 7.1 #5", 2, "P0115 a row of a datum table"),
        ("CYCL DEF 8.1 X\nCYCL DEF 10.1 ROT+5", 3, "P0120 CYCL"),
        ("CYCL DEF 10.1 ROT+5\nL X+1 FMAX", 3, "P0120 it is the first after a rotation"),
        ("CYCL DEF 10.1 ROT+5\nCYCL DEF 7.1 X+5", 3, "P0120 a datum shift while axes are rotated"),
        (
            "PLANE SPATIAL SPA+5 SPB+0 SPC+0 TURN\nPLANE SPATIAL SPA+6 SPB+0 SPC+0 STAY\nL X+1 Y+1 FMAX",
            4,
            "P0120 the tool does not stand along z",
        ),
        (
            "PLANE SPATIAL SPA+5 SPB+0 SPC+0 STAY\nL X+1 A+5 FMAX",
            3,
            "P0120 a rotary axis while a plane is tilted",
        ),
        (
            "PLANE SPATIAL SPA+5 SPB+0 SPC+0 TURN\nL A+5 FMAX",
            3,
            "P0120 a rotary axis while a plane is tilted",
        ),
        ("PLANE SPATIAL SPA+5 SPB+0 SPC+0", 2, "P0119 PLANE"),
        ("PLANE SPATIAL SPA+5 SPB+0 SPC+0 TURN STAY", 2, "P0117 TURN"),
        ("TOOL CALL 5 Z S1\nPLANE SPATIAL SPA+5 SPB+0 SPC+0 MOVE DIST-1", 3, "P0119 DIST"),
        ("TOOL CALL 5 Z S1 DL+1\nPLANE SPATIAL SPA+5 SPB+0 SPC+0 MOVE", 3, "P0120 MOVE"),
        ("PLANE SPATIAL SPA+5 SPB+0 SPC+0 MOVE", 2, "P0119 MOVE"),
        ("PLANE SPATIAL SPA+5 TURN", 2, "P0119 the angles SPA, SPB and SPC"),
        ("PLANE VECTOR BX+1 BY+0 BZ+0 NX+1 NY+0 NZ+0 STAY", 2, "P0110 two vectors at right angles"),
        (
            "CYCL DEF 7.1 X+1\nPLANE SPATIAL SPA+5 SPB+0 SPC+0 TURN\nCYCL DEF 7.1 X+2\nL X+1 Y+1 FMAX",
            5,
            "P0120 the datum shift has changed in a tilted plane",
        ),
        (
            "CYCL DEF 247 ~\n Q339=1\nL X+1 FMAX\nCYCL DEF 247 ~\n Q339=2",
            5,
            "P0115 Q339=2 is another preset",
        ),
        ("L X+1 FMAX\nCYCL DEF 247 ~\n Q339=2", 3, "P0120 positions of the preset before it"),
        ("M128", 2, "P0119 M128"),
        ("FUNCTION TCPM F TCP AXIS SPAT PATHCTRL AXIS", 2, "P0115 AXIS"),
        ("FUNCTION TCPM F TCP AXIS POS PATHCTRL VECTOR", 2, "P0115 PATHCTRL"),
        ("FUNCTION PARAXCOMP", 2, "P0115 FUNCTION"),
        (
            "CYCL DEF 19.0 P\nCYCL DEF 19.1 A-30 C+40\nCYCL DEF 19.0 P\nCYCL DEF 19.1 A-60",
            5,
            "P0119 CYCL DEF 19",
        ),
        ("X+10 R0 F100", 2, "P0114 X"),
        ("ERROR = L X+1", 2, "P0114 `ERROR = L X+1`"),
        ("L X+99999999999 FMAX", 2, "P0216 a number"),
        ("G1 X10", 2, "P0114 G"),
        ("L X+1 FMAX M140 MB MAX", 2, "P0120 M140"),
        ("CYCL DEF 247 ~\n Q339=PREDEF", 2, "P0115 PREDEF"),
        ("CC X-1 Y+0\nLP PR+5 PA+90 FMAX M140 MB5", 3, "P0120 M140"),
        ("CC X-1 Y+0\nCP PA+90 DR+ FMAX M140 MB5", 3, "P0120 M140"),
        ("Q1 = 0\nQ2 = SGN Q1", 3, "P0120 SGN"),
        ("TOOL CALL 5 Z S1\nTOOL DEF 5 L+60", 3, "P0120 TOOL DEF 5"),
        ("TOOL DEF 5 R+5\nTOOL CALL 5 Z S1\nTOOL DEF 5 L+80 R+20", 4, "P0120 TOOL DEF 5"),
        (
            "TOOL DEF 6 L+80\nTOOL CALL 6 Z S1\nTOOL CALL 5 Z S1\nTOOL DEF 6 L+60",
            5,
            "P0115 TOOL DEF 6",
        ),
        ("FUNCTION MODE MILL \"HEAD_90\"", 2, "P0115 FUNCTION MODE"),
    ] {
        let text = program(body);
        let error = read(&text, &at_zero()).expect_err(body);
        assert_fault(&text, &error, line, message);
    }
    // Statements that change nothing are read.
    steps(
        "FUNCTION MODE MILL\nTOOL DEF 6 L+80 R+3\nTOOL CALL 6 Z S1\nTOOL DEF 6 L+80 R+3\nTOOL DEF 5\nTOOL CALL 5 Z S1\n\
         TOOL DEF 6 L+80 R+2\nQ1 = SGN 2\nL X+1 FMAX",
    );
    // An increment from a position that only the machine knows, and one that stands alone.
    let unknown = ControlSetup { start: [None; 6], ..at_zero() };
    let error = read(&program("L X+1 IY+2 FMAX"), &unknown).expect_err("an increment");
    assert!(is_fault(&error, "P0120 IY"), "{error}");
    let (found, _) = read(&program("L IY+2 FMAX\nL X+1 FMAX"), &unknown).expect("increments");
    assert_eq!((found[0].end[1], found[0].commanded[1]), (None, true));
    assert_eq!((found[1].end[0], found[1].absolute), (Some(1.0), true));
    // Another control, and a program without its end.
    let haas = ControlSetup { rules: ControlRules::named("haas").expect("a control"), ..at_zero() };
    let error = read(&program("L X+1 FMAX"), &haas).expect_err("another control");
    assert!(is_fault(&error, "P0109 `heidenhain`"), "{error}");
    let error = read("; a\nBEGIN PGM A MM\nL X+1 FMAX", &at_zero()).expect_err("no end");
    assert_eq!(error.line, 3);
}

#[test]
fn notes_name_what_is_passed_over_and_what_is_left() {
    let notes = |body: &str| {
        let (_, notes) = read(&program(body), &at_zero()).unwrap_or_else(|error| panic!("{error}"));
        notes.iter().map(ToString::to_string).collect::<Vec<_>>()
    };
    let has = |notes: &[String], note: &str| {
        assert!(notes.iter().any(|found| found.contains(note)), "{note} is not in {notes:?}");
    };
    let passed = notes(
        "BLK FORM 0.1 Z  X-5  Y+0 Z-20\nTOOL CALL 5 Z S900 DR2+0.1\nL X+1 FMAX M8\nCYCL DEF 32.0 TOLERANCE\nCYCL DEF 32.1\n\
         FN 16: F-PRINT A/B\nL M103 F20\nPLANE SPATIAL SPA+0 SPB+0 SPC+0 COORD ROT STAY\nPLANE RESET STAY\nSTOP",
    );
    for word in
        ["BLK FORM 0.1 Z X-5 Y+0 Z-20", "DR2", "M8", "CYCL DEF 32", "FN 16", "M103", "COORD ROT"]
    {
        has(&passed, &format!("{word} is passed over"));
    }
    has(&passed, "line 11: motions by hand during the stop");
    // A shift in force at the end, and one that has ended.
    let shift = "L X+1 FMAX\nCYCL DEF 7.0 DATUM\nCYCL DEF 7.1 X+5\nL X+2 FMAX";
    has(&notes(shift), "the program ends with a datum shift in force");
    let ended = notes(&format!("{shift}\nTRANS DATUM RESET"));
    assert!(!ended.iter().any(|note| note.contains("ends with")), "{ended:?}");
    has(&notes("CYCL DEF 8.1 X\nL X+1 FMAX"), "ends with CYCL DEF 8");
    let text = format!("{}L X+1 FMAX\n", program("L X+1 FMAX"));
    let (_, after) = read(&text, &at_zero()).expect("steps");
    has(&after.iter().map(ToString::to_string).collect::<Vec<_>>(), "the text after the end");
    let text = program("L X+1 FMAX") + &program("L X+2 FMAX");
    let (steps, after) = read(&text, &at_zero()).expect("steps");
    assert_eq!(steps.len(), 1);
    has(&after.iter().map(ToString::to_string).collect::<Vec<_>>(), "another program begins here");
}

/// Every word that the documentation calls refused is refused by its name.
#[test]
fn words_that_the_documentation_refuses_are_refused() {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/controls.md");
    let page = std::fs::read_to_string(path).expect("the page");
    let (_, section) = page.split_once("## Heidenhain Klartext").expect("the section");
    let mut tables = section.split("|---|---|---|\n").skip(1).map(|table| {
        let rows = table.lines().take_while(|line| line.starts_with('|'));
        let cells = rows.map(|row| row.split('|').map(str::trim).collect::<Vec<_>>());
        cells
            .filter(|cells| cells[3].starts_with("refused"))
            // First number of a range.
            .map(|cells| cells[1].split(" to ").next().unwrap_or_default())
            .collect::<Vec<_>>()
    });
    let [statements, m_words, functions, planes, cycles] =
        [(); 5].map(|()| tables.next().expect("a table"));
    let forms = ["PROJECTED", "POINTS", "AXIAL"];
    let plane = |word: &str| match forms.contains(&word) {
        true => format!("PLANE {word} STAY"),
        false => format!("PLANE SPATIAL SPA+0 SPB+0 SPC+0 {word} STAY"),
    };
    let lines = statements
        .iter()
        .map(|word| (*word, format!("{word} 5")))
        .chain(m_words.iter().map(|word| (*word, format!("L X+1 FMAX {word}"))))
        .chain(functions.iter().map(|word| (*word, format!("{word}: Q1 = 5"))))
        .chain(planes.iter().map(|word| (*word, plane(word))))
        .chain(cycles.iter().map(|word| (*word, format!("{word} NAME ~\n Q200=+1"))));
    let mut count = 0;
    for (word, line) in lines {
        let error = read(&program(&line), &at_zero()).expect_err(&line);
        assert!(error.to_string().contains(word), "{line}: {error}");
        assert_eq!(error.line, 2, "{line}: {error}");
        count += 1;
    }
    println!("{count} words are refused by their names");
    assert!(count > 100);
}

/// A repeated section, and as many lines as ISO words have: each ends where the arithmetic says.
#[test]
fn a_hundred_thousand_blocks_are_read() {
    let body = "Q1 = 0\nLBL 1\nQ1 = Q1 + 0.001\nL X+Q1 IY+1 F500\nCALL LBL 1 REP 49999";
    let repeated = steps(body);
    assert_eq!(repeated.len(), 50_000);
    assert_near(repeated[49_999].end, [50.0, 50_000.0, 0.0]);
    let lines = |begin: &str| -> String {
        (0..100_000).map(|k| format!("{begin} X{k}.125 Y-{k}.5 Z{}\n", k % 7)).collect()
    };
    let plain = steps(&format!("L X0 F1000\n{}", lines("L")));
    let iso = crate::common::steps(
        &format!("G21 G90 G54\nG1 X0. F1000.\n{}M30\n", lines("")),
        &at_zero(),
    );
    assert_eq!((plain.len(), iso.len()), (100_001, 100_001));
    for (one, other) in plain.iter().zip(&iso) {
        assert_eq!(one.end, other.end);
    }
}

/// A jump is known to pass labels alone in a time that does not grow with them: then its condition, which is not known here, does not
/// matter.
#[test]
fn jumps_pass_any_number_of_labels() {
    let labels: String = (0..50_000).map(|k| format!("LBL \"a{k}\"\n")).collect();
    let jump = "FN 9: IF +Q9 EQU +1 GOTO LBL 2\n";
    let many = format!(
        "Q1 = 0\nLBL 1\nQ1 = Q1 + 1\nFN 12: IF +Q1 LT +100000 GOTO LBL 1\n{labels}L X+Q1 FMAX\n{jump}; a comment\nLBL 3\n* - a heading\n\
         LBL 2\nL X+2 FMAX"
    );
    let found = ends(&many);
    assert_eq!((found[0][0], found[1][0], found.len()), (Some(100_000.0), Some(2.0), 2));
    for text in [
        format!("{jump}/LBL 3\nLBL 2\nL X+2 FMAX"),
        format!("{jump}L X+1 FMAX\nLBL 2\nL X+2 FMAX"),
        format!("LBL 2\n{jump}L X+2 FMAX"),
        format!("CALL LBL 4\nM30\nLBL 4\n{jump}LBL 0\nLBL 2\nL X+2 FMAX\nLBL 0"),
    ] {
        let error = read(&program(&text), &at_zero()).expect_err(&text);
        assert!(error.to_string().contains("Q9"), "{text}: {error}");
    }
}

const MILLING: &str = "0 BEGIN PGM MILL MM\n1 BLK FORM 0.1 Z X+0 Y+0 Z-20\n2 BLK FORM 0.2 X+100 Y+100 Z+0\n; a comment\n* - heading\n\
    3 TOOL DEF 4 L+30 R+4\n4 TOOL CALL 5 Z S3000 F200 DL+0 DR+0\n5 L M140 MB MAX\n6 L X-10.5 Y+20 R0 FMAX M3\n7 L Z+2 FMAX M8\n\
    8 L Z-5 F AUTO\n9 CC X+10 Y+20\n10 CP IPA-180 DR- F500\n11 C X-10.5 Y+20 DR+\n12 L X+40\n13 RND R5\n14 L IY+30\n15 CHF 2\n\
    16 L X+0\n17 CR X+10 Y+60 R+10 DR+\n18 CT X+30 Y+80\n19 CC X+0 Z-5\n20 LP PR+20 PA+30\n21 CP IPA+720 IY-4 DR+\n/22 L Z+50 FMAX M1\n\
    23 L Z+0 R0 FMAX M91\n24 CYCL DEF 7.0 DATUM\n25 CYCL DEF 7.1 X+5\n26 CYCL DEF 7.2 IY+5\n27 CYCL DEF 8.0 M\n28 CYCL DEF 8.1 Y\n\
    29 L X+1 Y+2 F300\n30 CYCL DEF 8.1\n31 CYCL DEF 10.0 R\n32 CYCL DEF 10.1 ROT+30\n33 L X+0 Y+0\n34 M5\n35 M30\n36 END PGM MILL MM\n";

const HOLES: &str = "BEGIN PGM HOLES INCH\nFN 0: Q1 = +0\nQ2 = 2 * SIN(Q1 + 30) + SQRT 4\nTOOL CALL 5 Z S900\nM3\n\
    CYCL DEF 200 DRILLING ~\n  Q200=+2 ;SET-UP CLEARANCE ~\n  Q201=-15 ;DEPTH ~\n  Q206=+250 ~\n  Q202=+5 ~\n  Q203=+0 ~\n  Q204=+50\n\
    LBL 1\nL X+Q1 Y+Q2 R0 FMAX M99\nFN 1: Q1 = +Q1 + +10\nCALL LBL 1 REP 3\nFN 9: IF +Q1 EQU +5 GOTO LBL 9\nCALL LBL \"row\"\nLBL 9\n\
    L Z+100 FMAX M2\nLBL \"row\"\nCYCL DEF 203 DRILL ~\n Q200=1 ~\n Q201=-9 ~\n Q206=AUTO ~\n Q202=4 ~\n Q203=0 ~\n Q204=5 ~\n Q212=1 ~\n Q205=2\n\
    CYCL CALL POS X+1 Y+2 Z+0 FMAX\nCYCL DEF 207 TAP ~\n Q200=2 ~\n Q201=-9 ~\n Q239=1 ~\n Q203=0 ~\n Q204=5\nL X+3 FMAX M89\nL X+4 F100 M99\nLBL 0\n\
    END PGM HOLES INCH\n";

const PLANES: &str = "1 BEGIN PGM TILT MM\nCYCL DEF 247 DATUM ~\n Q339=+1\nTOOL CALL 5 Z S900\nM126\nL A+0 C+0 FMAX\n\
    PLANE SPATIAL SPA+30 SPB+0 SPC+45 TURN MB MAX FMAX COORD ROT\nL X+1 Y+2 FMAX\nL Z+3 F100\nCYCL DEF 10.1 ROT+5\nL X+0 Y+0\n\
    CYCL DEF 10.1 ROT+0\nPLANE RESET TURN F1000\nPLANE EULER EULPR+5 EULNU+6 EULROT+7 STAY\nL A+Q120 B+Q121 C+Q122 FMAX\nPLANE RESET STAY\n\
    CYCL DEF 19.0 P\nCYCL DEF 19.1 A+10 B+0 C+0\nCYCL DEF 19.1\nL X+0 Y+0 Z+50 A+0 B+0 C+0 FMAX\nL M128 F500\nL X+1 Y+1 Z+40 A+10 C-20 F800\n\
    L IA+1 IC+2\nM129\nFUNCTION TCPM F TCP AXIS POS PATHCTRL AXIS\nL X+2 A+3\nFUNCTION RESET TCPM\nTRANS DATUM AXIS X+1\nSTOP M9\nEND PGM TILT MM\n";

const PIECES: [&str; 47] = [
    "L X+1 FMAX\n",
    "LBL 1\n",
    "LBL 0\n",
    "CALL LBL 1\n",
    "CALL LBL 1 REP 2\n",
    "CALL LBL 9",
    "CC X+1 Y+2\n",
    "CC\n",
    "CP IPA+90 DR+\n",
    "CT X+9 Y+9\n",
    "RND R1\n",
    "CHF 1\n",
    "CYCL DEF 7.1 X+3\n",
    "CYCL DEF 8.1 X\n",
    "CYCL DEF 10.1 ROT+9\n",
    "CYCL DEF 19.1 A+5\n",
    "CYCL CALL\n",
    "PLANE RESET TURN\n",
    "PLANE RESET MOVE DIST5\n",
    "PLANE SPATIAL SPA+1 SPB+2 SPC+3 MOVE\n",
    "CYCL DEF 208 BORE ~\n Q200=+1 ~\n Q201=-5 ~\n Q334=+1 ~\n Q203=+0 ~\n Q204=+9 ~\n Q335=+9\n",
    "PLANE SPATIAL SPA+1 SPB+2 SPC+3 TURN\n",
    "L A+Q120 B+Q121 C+Q122 FMAX\n",
    "TRANS DATUM RESET\n",
    "TOOL CALL 5\n",
    "M128\n",
    "M129\n",
    "M91",
    "M99",
    "M89",
    "M140 MB5",
    "M30\n",
    "END PGM\n",
    "Q1 = ",
    "Q200=",
    "~\n",
    ";",
    "*",
    "/",
    "(",
    ")",
    "^",
    "\"",
    "99999",
    "0.0001",
    "\n",
    "\u{e9}",
];

#[test]
fn mutants_end_with_steps_or_with_a_line() {
    let seeds = [MILLING, HOLES, PLANES];
    let unknown = ControlSetup { lengths: BTreeMap::from([(5, 80.0)]), ..ControlSetup::default() };
    let setups = [at_zero(), unknown];
    for seed in seeds {
        for setup in &setups {
            let steps = read(seed, setup).unwrap_or_else(|error| panic!("{seed}{error}")).0;
            assert!(steps.len() >= 10, "{} steps\n{seed}", steps.len());
        }
    }
    let seeds = seeds.map(|text| Seed { text, setups: &setups });
    assert_planted_are_found(&seeds, ["L M777", "TCH PROBE 0", "L X+Q1999"]);
    read_mutants(&Mutants {
        name: "klartext",
        seeds: &seeds,
        pieces: &PIECES,
        default_count: 6_000,
    });
}
