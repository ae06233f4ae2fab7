//! G-code on machines where something is unknown, or means another position than it seems to.

use crate::block;
use crate::oracle::Mounted;
use nalgebra::{Point3, Vector3};
use touchoff::certify::TriangleBvh;
use touchoff::{Pose, Unit};
use touchoff_verify::gcode::{BlockLine, Choice, ControlRules, ControlSetup, Rule};
use touchoff_verify::machine::Machine;
use touchoff_verify::{
    FindingKind, MachineProgram, MachineProgramError, Move, ToolSelection, Verifier,
};

/// Returns a program on a machine of the library, with the origin of G54 if it is given.
fn program(
    machine: &str,
    origin: Option<[f64; 6]>,
    lengths: &[(u32, f64)],
    blocks: &str,
) -> Result<MachineProgram, MachineProgramError> {
    let machine = Machine::named(machine).expect("a machine of the library");
    let mut setup =
        ControlSetup { lengths: lengths.iter().copied().collect(), ..Default::default() };
    setup.work_offsets[0] = origin;
    let text = format!("G21 G90 G94 F100.\n{blocks}\nM30\n");
    whole(MachineProgram::new("part.nc", text, machine, setup))
}

/// Returns a program that is checked to its end, or the error that stops it.
fn whole(
    program: Result<MachineProgram, MachineProgramError>,
) -> Result<MachineProgram, MachineProgramError> {
    program.and_then(|program| program.check_complete().map(|()| program))
}

fn moves(program: &MachineProgram) -> Vec<Move> {
    let moves = program.moves(ToolSelection::All, None, Unit::Millimetre);
    moves.expect("the part").collect()
}

/// Returns the pose at the end of the last move.
fn last_pose(program: &MachineProgram) -> Pose {
    moves(program).last().expect("a move").path.pose(1.0)
}

#[test]
fn an_aligned_tool_is_tilted_wherever_it_stands() {
    let blocks =
        "G0 A0. C0.\nG43 H1\nG68.2 X0. Y0. Z0. I0. J30. K0.\nG53.1\nG0 X0. Y0. Z50.\nG1 Z-1.";
    let program = program("A-C trunnion", None, &[], blocks).expect("a program");
    let expected = Vector3::new(0.0, -0.5, 0.75f64.sqrt());
    let pose = last_pose(&program);
    assert!((pose.axis() - expected).norm() < 1e-12, "{pose:?}");
    assert!((pose.tip().coords - expected * -1.0).norm() < 1e-12, "{pose:?}");
    let unknown = &program.summary().unknown;
    assert!(!unknown.is_empty() && unknown.iter().all(|unknown| unknown.first_open.is_none()));
}

/// A plane of CYCLE800 aligns the tool as G53.1 does, and tool vectors under TRAORI turn it, by the axes or on a great circle, which
/// is not followed.
#[test]
fn native_programs_of_sinumerik_turn_the_tool() {
    let native = |blocks: &str| {
        let origin = Some([0.0, 0.0, -300.0, 0.0, 0.0, 0.0]);
        let machine = Machine::named("A-C trunnion").expect("a machine of the library");
        let rules = ControlRules::default().with(Rule::Rotary, Choice::Counts);
        let lengths = [(1, 80.0)].into();
        let mut setup = ControlSetup { lengths, rules, ..Default::default() };
        setup.work_offsets[0] = origin;
        let text =
            format!("G17 G90 G710 F=100\nT=\"1\" M6\nG54\nG0 X0 Y0 Z50 A0 C0\n{blocks}\nM30\n");
        MachineProgram::new("part.mpf", text, machine, setup).expect("a program")
    };
    // By the shorter way C turns through 0, else through 180 degrees.
    for (word, middle) in [("C=DC(10)", 10.0), ("C=10", -10.0)] {
        let turn = native(&format!("G0 X10 C350\nG1 {word}"));
        let all = moves(&turn);
        let tip = all.last().expect("a move").path.pose(0.5).tip();
        assert!((tip.x - middle).abs() < 1e-9, "{word}: {tip}");
    }
    let expected = Vector3::new(0.0, -0.5, 0.75f64.sqrt());
    let plane =
        native("CYCLE800(1,\"TC1\",200000,57,0,0,5,30,0,0,0,0,0,-1,,1)\nG0 X0 Y0\nZ50\nG1 Z-1");
    let pose = last_pose(&plane);
    assert!((pose.axis() - expected).norm() < 1e-12, "{pose:?}");
    let tip = expected * -1.0 + Vector3::new(0.0, 0.0, 5.0);
    assert!((pose.tip().coords - tip).norm() < 1e-12, "{pose:?}");
    for (word, is_followed) in [("ORIAXES", true), ("ORIVECT", false)] {
        let vectors =
            native(&format!("TRAORI\nG54\nORIWKS {word}\nG1 X1 Y2 Z3 A3=0 B3=-1 C3=SQRT(3)"));
        let pose = last_pose(&vectors);
        assert!((pose.axis() - expected).norm() < 1e-12, "{pose:?}");
        assert!((pose.tip() - Point3::new(1.0, 2.0, 3.0)).norm() < 1e-9, "{pose:?}");
        // The setup states that each axis turns in proportion, which ORIWKS and ORIVECT together contradict.
        let line =
            vectors.summary().unknown.iter().any(|unknown| unknown.first_open == Some(8.into()));
        assert_eq!(line, !is_followed, "{:?}", vectors.summary().unknown);
    }
}

#[test]
fn a_shift_at_an_unknown_position_leaves_positions_unknown() {
    let program = program("3-axis", None, &[], "G92 X50. Y0. Z5.\nG0 X50. Y0. Z5.\nG1 X32.");
    let program = program.expect("a program");
    let [unknown] = &program.summary().unknown[..] else { panic!("{:?}", program.summary()) };
    assert_eq!((unknown.count, unknown.first_open), (2, Some(3.into())));
}

#[test]
fn a_program_cannot_move_the_part() {
    let blocks = "G10 L2 P1 Z-5.\nG54 G0 X0. Y0. Z9.\nG1 X5.";
    for origin in [None, Some([0.0, 0.0, -450.0, 0.0, 0.0, 0.0])] {
        let refused = program("3-axis", origin, &[], blocks).expect_err("it moves the part");
        assert_eq!(refused.code(), "K0805", "{refused}");
    }
}

/// What the job leaves open ends what is checked, and the rest is listed: work offsets and axes with the words that are not read.
#[test]
fn all_that_stands_in_the_way_is_listed() {
    let blocks = "G54 G0 X0. Y0. Z50.\nX5.\nG55 X0.\nM130\nG56 Y1.\nG55 X2.\nG54 A5.\nG1 X3. M131\nG41 D4 X9.";
    let origin = Some([0.0, 0.0, -450.0, 0.0, 0.0, 0.0]);
    let text = format!("G21 G90 G94 F100.\n{blocks}\nM30\n");
    let mut setup = ControlSetup::default();
    setup.work_offsets[0] = origin;
    let machine = Machine::named("3-axis").expect("a machine of the library");
    let program = MachineProgram::new("part.nc", text, machine, setup).expect("a program");
    assert_eq!(moves(&program).iter().map(|step| step.line).collect::<Vec<_>>(), [2, 3]);
    let stop = program.summary().stop.as_ref().expect("a stop");
    let found = stop.obstacles.iter().map(|one| (one.block.line, one.count, &one.fault));
    let first = (stop.error.block.line, stop.count, &stop.error.fault);
    let all: Vec<_> = std::iter::once(first).chain(found).collect();
    let expected = [
        (4, 2, "K0807", "G55"),
        (5, 1, "P0114", "M130"),
        (6, 1, "K0807", "G56"),
        (8, 1, "K0602", "A is 5"),
        (9, 1, "P0114", "M131"),
        (10, 1, "P0401", "4"),
    ];
    assert_eq!(all.len(), expected.len(), "{all:#?}");
    for ((line, count, fault), (expected_line, expected_count, code, word)) in
        all.iter().zip(expected)
    {
        assert!((*line, *count) == (expected_line, expected_count), "{all:#?}");
        assert!(fault.code() == code && fault.to_string().contains(word), "{all:#?}");
    }
}

/// Beyond the hundred that are listed, lines with other obstacles are counted.
#[test]
fn obstacles_that_are_not_listed_are_counted() {
    let words: String = (0..150).map(|number| format!("M{}\n", 1000 + number)).collect();
    let text = format!("G21 G90 G94 F100.\nG54 G0 X0. Y0. Z50.\n{words}{words}M30\n");
    let machine = Machine::named("3-axis").expect("a machine of the library");
    let program = MachineProgram::new("part.nc", text, machine, ControlSetup::default());
    let program = program.expect("a program");
    let stop = program.summary().stop.as_ref().expect("a stop");
    assert_eq!((stop.count, stop.obstacles.len(), stop.unlisted), (2, 100, 98));
    let gaps = MachineProgram::gaps(std::slice::from_ref(&program));
    let said = gaps.iter().find(|gap| gap.code() == "V0311").expect("a gap");
    assert!(said.reason.starts_with("98 more lines"), "{said}");
}

/// With rates, each axis moves at its own: the slower ones go on alone.
#[test]
fn rapid_rates_bend_the_path() {
    let file = "name = \"fast x\"\naxis = [{ letter = \"X\", kind = \"linear\", carries = \"table\", rapid = 20000 }, \
                { letter = \"Y\", kind = \"linear\", carries = \"table\", rapid = 10000 }, { letter = \"Z\", kind = \
                \"linear\", carries = \"tool\", rapid = 5000 }]\n";
    let machine = Machine::parse(file, "fast.toml").expect("a machine");
    let text = "G21 G90 G0 X0. Y0. Z0.\nX20. Y20. Z0.\nX20. Y20. Z5.\nG1 X0. Y0. Z0. F100.\nM30\n";
    let program = MachineProgram::new("a.nc", text.to_owned(), machine, ControlSetup::default());
    let moves = moves(&program.expect("a program"));
    let ends: Vec<_> = moves.iter().map(|step| (step.line, step.path.pose(1.0).tip())).collect();
    let at = |x: f64, y: f64, z: f64| Point3::new(x, y, z);
    let expected = [
        (1, at(0.0, 0.0, 0.0)),
        // X arrives after 1/1000 min, when Y is halfway.
        (2, at(20.0, 10.0, 0.0)),
        (2, at(20.0, 20.0, 0.0)),
        (3, at(20.0, 20.0, 5.0)),
        (4, at(0.0, 0.0, 0.0)),
    ];
    assert_eq!(ends.len(), expected.len(), "{ends:?}");
    for ((line, tip), (expected_line, expected)) in ends.iter().zip(expected) {
        assert!(*line == expected_line && (tip - expected).norm() < 1e-12, "{ends:?}");
    }
    for (from, to, code) in
        [("rapid = 5000", "rapid = 0", "K0111"), (", rapid = 5000", "", "K0108")]
    {
        let error = Machine::parse(&file.replace(from, to), "fast.toml").expect_err("refused");
        assert_eq!(error.code(), code, "{error}");
        assert!(error.to_string().contains("axis Z"), "{error}");
    }
}

#[test]
fn what_turns_has_to_be_given() {
    let turn = "G0 X0. Y0. Z50. B0. C0.\nG1 B30.";
    let refused = program("B head + C table", None, &[], turn).expect_err("no length");
    assert_eq!(refused.code(), "K0803", "{refused}");
    assert!(
        program("B head + C table", None, &[], "G43.4 H1\nG0 X0. Y0. Z50. B0. C0.\nG1 B30.")
            .is_ok()
    );
    let turn = "G0 X0. Y0. Z50. A0. C0.\nG1 C30.";
    let refused = program("A-C trunnion", None, &[], turn).expect_err("no origin");
    assert_eq!(refused.code(), "K0804", "{refused}");
    // Under tool centre point control the start of a head's motion is unknown without a length.
    let blocks = "G0 X0. Y0. Z50. B0. C0.\nG43.4 H1\nG1 X9. Y0. Z50. B30.\nG1 X12.";
    let program = program("B head + C table", None, &[], blocks).expect("a program");
    let unknown = program.summary().unknown.iter().map(|unknown| unknown.count).sum::<usize>();
    assert_eq!(unknown, 2, "{:?}", program.summary());
}

/// The length of another tool moves the tip, and is found.
#[test]
fn another_length_moves_the_tip() {
    let blocks = "T1 M6\nG43 H2 G0 X0. Y0. Z50.\nG1 Z9.";
    let program = program("3-axis", None, &[(1, 80.0), (2, 70.0)], blocks).expect("a program");
    let block = BlockLine { line: 4, within: None };
    assert_eq!(program.summary().other_lengths, [(block, 2, 1)]);
    assert!((last_pose(&program).tip().z - (9.0 - 10.0)).abs() < 1e-12);
}

/// A position by itself, as after a retract to an unknown height, is queried and not bounded from the one before.
#[test]
fn the_approach_of_a_position_by_itself_is_queried() {
    let bvh = TriangleBvh::new(&block([-8.0, -8.0, -8.0], [8.0, 8.0, 0.0]));
    let blocks = "G0 X500. Y0. Z9.\nG1 X150.\nX500.\nG91 G28 Z0.\nG90 G0 X0. Y0. Z1.";
    let program = program("3-axis", None, &[], blocks).expect("a program");
    let verifier = Verifier::new(&bvh, &Mounted).expect("a profile");
    let report = verifier.check_moves(moves(&program), &|_| ()).expect("it can be checked");
    assert!((report.approach.distance - 1.0).abs() < 0.1, "{:?}", report.approach);
    assert!(!report.approach.is_far(), "{:?}", report.approach);
}

/// A resolution below rounding is taken as that, and the search ends.
#[test]
fn a_resolution_of_0_ends() {
    let bvh = TriangleBvh::new(&block([-8.0, -8.0, -8.0], [8.0, 8.0, 0.0]));
    let tilted =
        "G0 X0. Y0. Z9.\nG68.2 X0. Y0. Z0. I0. J3. K0.\nG0 X5. Y0. Z2.\nG1 Z-0.5\nG3 X-5. I-5.";
    for (machine, blocks) in [("3-axis", "G0 X-20. Y0. Z9.\nG1 Z-0.5\nX20."), ("3-axis", tilted)] {
        let program = program(machine, None, &[], blocks).expect("a program");
        let verifier = Verifier::new(&bvh, &Mounted).expect("a profile");
        let verifier = verifier.with_resolution(0.0).expect("a length");
        let report = verifier.check_moves(moves(&program), &|_| ()).expect("it can be checked");
        let is_deep = |kind: &FindingKind| matches!(kind, FindingKind::Deep { .. });
        assert!(report.findings.iter().any(|found| is_deep(&found.kind)), "{:?}", report.findings);
    }
}

/// In Klartext the sign of the master axis selects one of two positions of the axes, and M126 the way to a stated angle.
#[test]
fn rotary_axes_of_klartext_obey_their_words() {
    let machine = || Machine::named("A-C trunnion").expect("a machine of the library");
    let mut setup = ControlSetup { lengths: [(1, 80.0)].into(), ..Default::default() };
    setup.work_offsets[0] = Some([0.0, 0.0, -400.0, 0.0, 0.0, 0.0]);
    let readings = |body: &str| {
        let text = format!(
            "0 BEGIN PGM A MM\nTOOL CALL 1 Z S900\nL A+0 C+0 FMAX M3\nL X+0 Y+0 Z+100 FMAX\n{body}\nM30\nEND PGM A MM\n"
        );
        let programs = MachineProgram::readings("a.h", text.clone(), machine(), &setup);
        programs.unwrap_or_else(|error| panic!("{text}{error}"))
    };
    let (sine, cosine) = 20f64.to_radians().sin_cos();
    let mut tilts = Vec::new();
    for sign in ["+", "-"] {
        let body = format!(
            "PLANE SPATIAL SPA+20 SPB+0 SPC+0 STAY SEQ{sign} TABLE ROT\nL A+Q120 C+Q122 R0 FMAX\n\
             L X+0 Y+0 FMAX\nL Z+50 FMAX\nL Z+1 F100"
        );
        let programs = readings(&body);
        let [program] = &programs[..] else { panic!("{} readings", programs.len()) };
        // Every rule is that of the only control that reads the program.
        assert!(program.summary().open_rules.is_empty(), "{:?}", program.summary());
        let pose = last_pose(program);
        let expected = Vector3::new(0.0, -sine, cosine);
        assert!((pose.axis() - expected).norm() < 1e-9, "{pose:?}");
        assert!((pose.tip().coords - expected).norm() < 1e-9, "{pose:?}");
        // The body that A carries shows its angle.
        let tilt = (0..6).find_map(|link| {
            let moves = program.moves(ToolSelection::All, Some(link), Unit::Millimetre).ok()?;
            let axis = moves.last()?.path.pose(1.0).axis();
            (axis.y.abs() > 0.5 * sine).then_some(axis.y)
        });
        tilts.push(tilt.expect("a link that A turns"));
    }
    assert!((tilts[0] + tilts[1]).abs() < 1e-9, "{tilts:?}");
    // Angles that the program states are those of the plane, before it or after it, or an error.
    let stated = |before: &str, after: &str| {
        let text = format!(
            "0 BEGIN PGM A MM\nTOOL CALL 1 Z S900\nL A+0 C+0 FMAX M3\nL X+0 Y+0 Z+100 FMAX\n{before}\n\
             PLANE SPATIAL SPA+20 SPB+0 SPC+0 STAY\n{after}\nL X+0 Y+0 FMAX\nL Z+1 F100\nM30\nEND PGM A MM\n"
        );
        whole(MachineProgram::new("a.h", text, machine(), setup.clone()))
    };
    let expected = Vector3::new(0.0, -sine, cosine);
    let turns = ["L A+20 C+0 FMAX", "L A-20 C+0 FMAX"];
    let read = turns.map(|turn| [stated(turn, ""), stated("", turn)]);
    let is_read = read.each_ref().map(|ways| ways.each_ref().map(Result::is_ok));
    assert!(matches!(is_read, [[true, true], [false, false]] | [[false, false], [true, true]]));
    for result in read.iter().flatten() {
        match result {
            Ok(program) => {
                let pose = last_pose(program);
                assert!((pose.axis() - expected).norm() < 1e-9, "{pose:?}");
                assert!((pose.tip().coords - expected).norm() < 1e-9, "{pose:?}");
            }
            Err(error) => {
                assert_eq!(error.code(), "K0802", "{error}");
                assert!(error.to_string().contains("40.000 degrees"), "{error}");
            }
        }
    }
    // A turn about a point has the way of any other one: 270 degrees back, or 90 on by M126.
    let back = "L C+270 FMAX\nPLANE RESET MOVE FMAX\nL Z+1 F100";
    assert_eq!(readings(back).len(), 3);
    let turned = |body: &str| {
        let programs = readings(body);
        let moves = moves(&programs[0]);
        let [.., turn, _] = &moves[..] else { panic!("{} moves", moves.len()) };
        // The part turns against C.
        let x = |t: f64| turn.path.pose(t).rotation().column(0).into_owned();
        (x(0.5).x, x(0.5).y)
    };
    let (x, y) = turned(&format!("M126\n{back}"));
    let half = 0.5f64.sqrt();
    assert!((x - half).abs() < 1e-9 && (y.abs() - half).abs() < 1e-9, "{x} {y}");
    let turn = "L C+345 FMAX\nL C+15 FMAX\nL Z+1 F100";
    assert_eq!(readings(turn).len(), 3);
    assert_eq!(readings(&format!("M126\n{turn}")).len(), 1);
}

/// PLANE … MOVE of Klartext turns the tool about the point below its tip, which rests at the part: on a table, a head, and both.
/// Afterwards positions are those of the plane, as after TURN.
#[test]
fn a_plane_of_klartext_turns_about_a_point_that_rests() {
    for (name, angles) in
        [("A-C trunnion", "A+0 C+0"), ("A-C fork head", "A+0 C+0"), ("B head + C table", "B+0 C+0")]
    {
        let machine = Machine::named(name).expect("a machine of the library");
        let mut setup = ControlSetup { lengths: [(1, 80.0)].into(), ..Default::default() };
        setup.work_offsets[0] = Some([5.0, -7.0, -400.0, 0.0, 0.0, 0.0]);
        let moves_of = |body: &str| {
            let text = format!(
                "0 BEGIN PGM A MM\nTOOL CALL 1 Z S900\nL {angles} FMAX M3\nL X+10 Y+20 FMAX\nL Z+30 FMAX\n{body}\nM30\nEND PGM A MM\n"
            );
            let program = MachineProgram::new("a.h", text.clone(), machine.clone(), setup.clone());
            moves(&program.unwrap_or_else(|error| panic!("{name}: {text}{error}")))
        };
        let tilt = nalgebra::Rotation3::from_axis_angle(&Vector3::z_axis(), 0.5)
            * nalgebra::Rotation3::from_axis_angle(&Vector3::x_axis(), 0.35);
        let [x, y] = [0, 1].map(|k| tilt.matrix().column(k).into_owned());
        let normal = tilt * Vector3::z();
        let plane = format!(
            "PLANE VECTOR BX{:+.9} BY{:+.9} BZ{:+.9} NX{:+.9} NY{:+.9} NZ{:+.9}",
            x.x, x.y, x.z, normal.x, normal.y, normal.z
        );
        for (distance, word) in [(0.0, ""), (0.0, "DIST0"), (25.0, "DIST25"), (25.0, "ABST+25")] {
            let found = moves_of(&format!("{plane} SEQ- MOVE {word} F900"));
            let turn = found.last().expect("a move");
            assert!(turn.rapid);
            let rests = Point3::new(10.0, 20.0, 30.0 - distance);
            for k in 0..=20 {
                let pose = turn.path.pose(f64::from(k) / 20.0);
                let point = pose.tip() - distance * pose.axis();
                assert!((point - rests).norm() < 1e-9, "{name} {word} {k}: {point}");
            }
            assert!((turn.path.pose(0.0).axis() - Vector3::z()).norm() < 1e-12, "{name}");
            assert!((turn.path.pose(1.0).axis() - normal).norm() < 1e-8, "{name}");
            // A position in the plane, and the way back about the same point.
            let back = format!(
                "{plane} SEQ- MOVE {word} FMAX\nL X+1 Y+2 FMAX\nL Z+3 FMAX\nPLANE RESET MOVE {word} FMAX"
            );
            let found = moves_of(&back);
            let [.., at, reset] = &found[..] else { panic!("{} moves", found.len()) };
            let expected = x + 2.0 * y + 3.0 * normal;
            let at = at.path.pose(1.0);
            assert!((at.tip().coords - expected).norm() < 1e-7, "{name}: {at:?}");
            let rests = at.tip() - distance * at.axis();
            let end = reset.path.pose(1.0);
            assert!((end.tip() - distance * end.axis() - rests).norm() < 1e-7, "{name}: {end:?}");
            assert!((end.axis() - Vector3::z()).norm() < 1e-12, "{name}");
        }
    }
}

/// A machine without rotary axes reaches no tilted plane, whichever way it is asked to turn.
#[test]
fn a_plane_needs_axes_that_turn_to_it() {
    for word in ["TURN", "MOVE", "MOVE DIST10"] {
        let text = format!(
            "0 BEGIN PGM A MM\nTOOL CALL 1 Z S900\nL X+0 Y+0 FMAX M3\nL Z+100 FMAX\n\
             PLANE SPATIAL SPA+30 SPB+0 SPC+0 {word} FMAX\nL X+0 Y+0 FMAX\nL Z+1 F100\nM30\nEND PGM A MM\n"
        );
        let setup = ControlSetup { lengths: [(1, 80.0)].into(), ..Default::default() };
        let machine = Machine::named("3-axis").expect("a machine of the library");
        let program = MachineProgram::new("a.h", text, machine, setup);
        let is_refused = match &program {
            Err(_) => true,
            Ok(program) => program.check_complete().is_err(),
        };
        assert!(is_refused, "{word}: {:?}", program.map(|program| program.summary().clone()));
    }
}
