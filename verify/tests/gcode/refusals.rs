//! Programs that have to be refused, with the line, and programs that have to be read.

use crate::common::{assert_fault, execute, folder, is_fault, text};
use touchoff_verify::gcode::{
    Choice, ControlRules, ControlSetup, GcodeError, NoteKind, Position, Rule, Step, StepPath, Tcp,
    read,
};

fn at_zero() -> ControlSetup {
    ControlSetup {
        start: [Some(0.0); 6],
        work_offsets: [Some([0.0; 6]); 9],
        // Endless loops are refused sooner.
        max_repeated: 100_000,
        ..ControlSetup::default()
    }
}

fn run(program: &str) -> Result<Vec<Step>, GcodeError> {
    execute(program, &at_zero())
}

/// Executes a program as LinuxCNC does.
fn run_on_linuxcnc(program: &str) -> Result<Vec<Step>, GcodeError> {
    let rules = ControlRules::named("linuxcnc").expect("a control");
    execute(program, &ControlSetup { rules, ..at_zero() })
}

fn refusal(name: &str, program: &str) -> GcodeError {
    match run(program) {
        Ok(steps) => panic!("{name} is read, with {} motions", steps.len()),
        Err(error) => error,
    }
}

#[test]
fn bad_programs_of_linuxcnc_are_refused_at_their_line() {
    let Some(folder) = folder() else { return };
    let bad = [
        ("a-in-canned-cycle", 3, "P0120 A"),
        ("a-in-canned-cycle2", 2, "P0120 A"),
        ("bad-arc.big.imperial.center-format", 6, "P0305"),
        ("bad-arc.big.metric.center-format", 6, "P0305"),
        ("bad-arc.medium.imperial.center-format", 6, "P0305"),
        ("bad-arc.medium.metric.center-format", 6, "P0305"),
        ("bad-arc.small.imperial.center-format", 6, "P0305"),
        ("bad-arc.small.metric.center-format", 6, "P0305"),
        ("ccomp-arcexit", 7, "P0406 G40"),
        ("ccomp-gouging", 6, "P0409 line 5"),
        ("exists-1", 2, "P0203 EXISTS"),
        ("exists-2", 2, "P0203 EXISTS"),
        ("exists-3", 3, "P0203 EXISTS"),
        ("exists-4", 2, "P0203 EXISTS"),
        ("exists-5", 2, "P0203 EXISTS"),
        ("exists-6", 2, "P0203 EXISTS"),
        ("exists-7", 2, "P0203 EXISTS"),
        ("g64-m19-r-ambiguous", 2, "P0120 R"),
        ("g64-r-on-g61", 2, "P0118 R"),
        ("nested", 6, "P0128 it stands in another subprogram"),
        ("no-feed-rate", 2, "P0122 G1"),
        ("no-ijr", 2, "P0301"),
        ("probe-no-axes", 2, "P0115 G38.2"),
    ];
    for (name, line, message) in bad {
        let program = text(&folder.join(format!("interp/bad/{name}.ngc")));
        // G41.1 is a word of LinuxCNC alone.
        let error = match name.starts_with("ccomp") {
            true => run_on_linuxcnc(&program).expect_err(name),
            false => refusal(name, &program),
        };
        assert_fault(name, &error, line, message);
    }
    let files = std::fs::read_dir(folder.join("interp/bad")).expect("a folder");
    let programs = files.filter(|file| {
        file.as_ref().expect("a file").path().extension().is_some_and(|ending| ending == "ngc")
    });
    assert_eq!(programs.count(), bad.len());
}

/// The names of the files state whether LinuxCNC reads them.
#[test]
fn subprograms_of_both_dialects() {
    let Some(folder) = folder() else { return };
    let cases = [
        ("O...-called-with-O..._call", Err((4, "P0135 `sub`"))),
        ("O...-ended-with-O..._endsub", Err((8, "P0135 `sub`"))),
        ("O...-sub-called-with-M98", Err((4, "P0135 `sub`"))),
        ("O...-sub-ended-with-M99", Err((6, "P0128 it has no endsub"))),
        ("test-illegal-end-main-with-eof", Err((15, "P0138"))),
        ("test-illegal-no-m30-before-osub", Err((10, "P0137 O2"))),
        ("test-illegal-sub-after-percent", Err((7, "P0126 O2"))),
        ("test-legal-end-main-with-m02", Ok(2)),
        ("test-legal-end-main-with-m2", Ok(2)),
        ("test-legal-end-main-with-m30", Ok(2)),
        ("test-legal-end-main-with-percent", Ok(2)),
        ("test-named", Ok(0)),
        ("test-numbered", Ok(0)),
        ("test-fanuc", Ok(10)),
        ("test-rs274ngc", Ok(4)),
        ("test", Ok(0)),
    ];
    for (name, expected) in cases {
        let program = text(&folder.join(format!("interp/m98m99/{name}.ngc")));
        match (run(&program), expected) {
            (Ok(steps), Ok(count)) => assert_eq!(steps.len(), count, "{name}"),
            (Err(error), Err((line, message))) => {
                assert_fault(name, &error, line, message);
            }
            (result, _) => panic!("{name}: {result:?}"),
        }
    }
    // Both subprograms of the last one are executed: they print, and motions take the place of the messages.
    let program = text(&folder.join("interp/m98m99/test.ngc"));
    let moving =
        program.replace("(print,In sub 100)", "G0 X100").replace("(print,In sub 200)", "G0 X200");
    let ends: Vec<_> = run(&moving).expect("a program").iter().map(|step| step.end[0]).collect();
    assert_eq!(ends, [Some(100.0), Some(200.0)]);
}

/// Each pair of motions in `rotation/test.ngc` goes to 0,0,0 and 1,2,3 of the machine, whatever the offsets.
#[test]
fn machine_coordinates_do_not_depend_on_offsets() {
    let Some(folder) = folder() else { return };
    let program = text(&folder.join("interp/rotation/test.ngc"));
    let steps = run_on_linuxcnc(&program).expect("a program");
    assert_eq!(steps.len(), 2 * 7 * 2);
    for (index, step) in steps.iter().enumerate() {
        let unit = if index < 14 { 25.4 } else { 1.0 };
        let expected = if index % 2 == 0 { [0.0; 3] } else { [unit, 2.0 * unit, 3.0 * unit] };
        let machine = step.state.to_machine(step.end);
        for axis in 0..3 {
            let value = machine[axis].expect("a known coordinate");
            assert!((value - expected[axis]).abs() < 1e-12, "{index}: {machine:?}");
        }
    }
}

/// Reads the last number after a letter on each line of a program without parameters, and follows G90 positions. Such
/// a program has blocks of one motion each.
fn followed(program: &str, letters: [char; 6], scale: f64) -> Vec<[Option<f64>; 6]> {
    let mut position = [None; 6];
    let mut found = Vec::new();
    for line in program.lines() {
        let code = line.split(['(', ';']).next().expect("a line").to_ascii_uppercase();
        let code = code.replace("[#<XSCALE>*", "").replace("[#<YSCALE>*", "");
        let code = code.replace("[#<ZSCALE>*", "").replace(']', "");
        let mut moved = false;
        for (axis, letter) in letters.into_iter().enumerate() {
            let Some((_, rest)) = code.split_once(letter) else { continue };
            let end = rest.find(|c: char| !"+-.0123456789".contains(c)).unwrap_or(rest.len());
            if let Ok(value) = rest[..end].parse::<f64>() {
                position[axis] = Some(if axis < 3 { scale * value } else { value });
                moved = true;
            }
        }
        if moved {
            found.push(position);
        }
    }
    found
}

#[test]
fn long_programs_are_read_to_their_end() {
    let Some(folder) = folder() else { return };
    let axes = ['X', 'Y', 'Z', 'A', 'B', 'C'];
    for (file, scale) in
        [("three_axis_chips.ngc", 1.0), ("arcspiral.ngc", 25.4), ("five_axis/boat-xyzac.ngc", 1.0)]
    {
        let program = text(&folder.join(file));
        let rules = ControlRules::named("linuxcnc").expect("a control");
        let setup = ControlSetup { rules, ..ControlSetup::default() };
        let (steps, notes) = read(&program, &setup).expect("a program");
        // A block of parameters has no motion, and its letters are in brackets.
        let body: String = program
            .lines()
            .filter(|line| !line.starts_with("#<"))
            .map(|line| format!("{line}\n"))
            .collect();
        let expected = followed(&body, axes, scale);
        assert_eq!(steps.len(), expected.len(), "{file}");
        let mut known: Position = [None; 6];
        let mut differences = 0;
        for (step, wanted) in steps.iter().zip(&expected) {
            for axis in 0..6 {
                known[axis] = wanted[axis];
                if step.end[axis] != known[axis] {
                    differences += 1;
                }
            }
        }
        assert_eq!(differences, 0, "{file}");
        let arcs = steps.iter().filter(|step| matches!(step.path, StepPath::Arc { .. })).count();
        let rapids = steps.iter().filter(|step| step.rapid).count();
        println!("{file}: {} motions, {arcs} arcs, {rapids} in rapid traverse", steps.len());
        for note in notes {
            println!("    {note}");
        }
    }
    let boat = text(&folder.join("five_axis/boat-xyzac.ngc"));
    let steps = run_on_linuxcnc(&boat).expect("a program");
    let first = steps.iter().find(|step| step.line == 13).expect("a motion");
    assert_eq!((first.state.tool, first.state.tcp), (Some(1), Tcp::Rotary));
    assert_eq!(first.end, [-49.65, -23.015, 5.0, 0.0, 0.0, 0.0].map(Some));
    for (file, expected) in [
        ("xyzac_switchkins_test_1", Ok(18)),
        ("xyzac_switchkins_test_2", Ok(33)),
        ("xyzac_switchkins_test_3", Ok(4)),
        ("xyzac_switchkins", Err("P0126 O<xyzac_switchkins_sub>")),
        ("xyzbc_switchkins", Err("P0126 O<xyzbc_switchkins_sub>")),
    ] {
        match (run_on_linuxcnc(&text(&folder.join(format!("five_axis/{file}.ngc")))), expected) {
            (Ok(steps), Ok(count)) => assert_eq!(steps.len(), count, "{file}"),
            (Err(error), Err(message)) => {
                assert!(is_fault(&error, message), "{file}: {error}");
            }
            (result, _) => panic!("{file}: {result:?}"),
        }
    }
}

#[test]
fn words_that_are_not_read_are_named() {
    for (program, line, message) in [
        ("G21\nG41 D1 X1", 2, "P0401 radius offset 1"),
        ("G1 F1 X[ASIN[0.5]]", 1, "P0207 `ASIN`"),
        ("G1 F1 X[FIX[-0.5]]", 1, "P0205"),
        ("X#5220", 1, "P0211 #5220"),
        ("X#<_x>", 1, "P0211 #<_x>"),
        ("G0 X#1", 1, "P0210 #1"),
        ("G0 X[1/0]", 1, "P0216 `/`"),
        ("G0 X[1+[2]", 1, "P0208 `]`"),
        ("o1 if [1]", 1, "P0128 O1 if"),
        ("o1 while [1]", 1, "P0128 O1 while"),
        ("o1 endif", 1, "P0128 O1 endif"),
        ("IF [#1 EQ 0] GOTO 10", 1, "P0210 #1"),
        ("WHILE[1GT0]DO1", 1, "P0131"),
        ("GOTO 10", 1, "P0129 N10"),
        ("GOTO 10\nN10\nN10", 1, "P0130 N10"),
        ("GOTO 10\nDO1\nN10\nEND1", 1, "P0120 into a loop"),
        ("GOTO 10\nDO1\nDO2\nEND2\nN10\nEND1", 1, "P0120 into a loop"),
        ("DO1\nDO2\nGOTO 10\nEND2\nDO2\nN10\nEND2\nEND1", 3, "P0120 into a loop"),
        ("GOTOF END", 1, "P0111 `END`"),
        ("N1 GOTO 1", 1, "P0144 100000 blocks"),
        ("IF [1 EQ 1] G0 X1", 1, "P0119 IF"),
        ("WHILE [1 EQ 1] DO 4", 1, "P0110 `DO4`"),
        ("WHILE[1EQ1]DO1\nEND1", 1, "P0144 100000 blocks"),
        ("END5", 1, "P0110 `END5`"),
        ("#1=#5061", 1, "P0211 #5061"),
        ("#1=#5041", 1, "P0211 #5041"),
        ("#1=#3007", 1, "P0211 #3007"),
        ("#1=0.1\nIF [[#1*3] EQ 0.3] GOTO 2\nN2", 2, "P0206 depends on the digits"),
        ("G65 P9 A1\nM30\nO9\nM99", 1, "P0120 A"),
        ("G65 P9 N1.\nM30\nO9\nM99", 1, "P0132 G65"),
        ("G65 A1.\nM30", 1, "P0119 G65"),
        ("G65 P8\nM30", 1, "P0126 O8"),
        ("IF [1 EQ 1] THEN #3000=5", 1, "P0134"),
        ("o1 call [2]\nM30", 1, "P0126 O1"),
        ("5 L X+10 Y+20 R0 FMAX", 1, "P0108 Heidenhain Klartext"),
        ("G21\n0 BEGIN PGM X MM", 2, "P0108 `BEGIN`"),
        ("5 X1", 1, "P0101 `5`"),
        ("L X+10 Y+20 R0 FMAX", 1, "P0108 Heidenhain Klartext"),
        ("CYCL DEF 200", 1, "P0108 Heidenhain Klartext"),
        ("TOOL CALL 5 Z S1000", 1, "P0108 Heidenhain Klartext"),
        ("PLANE SPATIAL", 1, "P0108 Heidenhain Klartext"),
        ("M128", 1, "P0115 tool centre point control of Heidenhain"),
        ("G0 X1 0", 1, "P0101 `0`"),
        ("G0 X1 U2", 1, "P0113"),
        ("G777", 1, "P0114 G777"),
        ("G1.25", 1, "P0106 G1.25"),
        ("M77", 1, "P0114 M77"),
        ("G0 X1 Q2", 1, "P0118 Q"),
        ("G0 X1 X2", 1, "P0116 X"),
        ("G0 G1 X1 F1", 1, "P0117 G0"),
        ("G54 G55", 1, "P0117 G54"),
        ("X1", 1, "P0121"),
        ("G0 X1\nG80\nX2", 3, "P0121"),
        ("G0 X10000000000", 1, "P0216 not a number within"),
        ("G0 X1.2.3", 1, "P0201 `1.2.3`"),
        ("G0 X-", 1, "P0202"),
        ("(open\nG0 X1", 1, "P0103 `)`"),
        ("G0 X1\u{e9}", 1, "P0101 `é`"),
        ("G2 X1 F1 R0.1", 1, "P0307"),
        ("G2 X0 F1 R1", 1, "P0308"),
        ("G2 X1 F1 R1 I1", 1, "P0302"),
        ("G2 X1 F1 K1", 1, "P0303"),
        ("G2 X1 F1 K0", 1, "P0301"),
        ("G8", 1, "P0115 a mode of a lathe"),
        ("G90.1 G2 X1 F1 I1", 1, "P0304"),
        ("G2 X1 F1 I0", 1, "P0306"),
        ("G81 X1 Z-1 F1", 1, "P0119 the retract plane R"),
        ("G81 X1 R1 F1", 1, "P0119 the depth"),
        ("G81 X1 R1 Z2 F1", 1, "P0123"),
        ("G83 X1 R1 Z-2 F1", 1, "P0119 depth of peck Q"),
        ("G83 X1 R1 Z-2 Q0.00001 F1", 1, "P0124 100000 motions"),
        ("G87 X1 R1 Z-2", 1, "P0115 boring cycle"),
        ("G98 G81 R1 F1", 1, "P0119 G81"),
        ("G53 X1\nG91 G53 X1", 2, "P0120 G53"),
        ("G43 Z1", 1, "P0119 H"),
        ("G43.4 H1\nG53 Z0", 2, "P0120 tool centre point control is on"),
        ("G43.4 H1\nTRAORI", 2, "P0120 G43.4"),
        ("M428", 1, "P0115 five-axis configurations alone"),
        ("G0 X1\nG28", 2, "P0119 G28"),
        ("G92.3", 1, "P0115 a shift that another program may have left"),
        ("G43 H0", 1, "P0120 G49"),
        ("G68 X0 Y0 R90\nG0 X5", 2, "P0120 G68"),
        ("G68 X0 Y0 R90\nG0 X5 Y0\nG69\nG91 X1", 4, "P0120 G68"),
        ("G68 X0 Y0 R90\nG53 G0 Z0", 2, "P0120 G53"),
        ("G68 X0 Y0 R90\nG28 X0 Y0", 2, "P0120 G28"),
        ("G91 G92 X1", 1, "P0120 G92"),
        ("G91 G0 X0.0004", 1, "P0120 no multiple of the least increment"),
        ("G52 X1\nG91 G0 X1", 2, "P0120 X"),
        ("G0 X1\nG20 X1", 2, "P0120 G20"),
        ("M3 M8 S1", 1, "P0120 M3"),
        ("T1 M6 G43 H1", 1, "P0120 G43"),
        ("T1 M6 G28 Z0", 1, "P0120 G28"),
        ("G54 G4 P2", 1, "P0120 P"),
        ("G2 I1 J0 P2 F1", 1, "P0115 a number of turns on LinuxCNC alone"),
        ("M3 S1\nG2 X2 I1 J0 F1\nG2 I-1 M5", 3, "P0120 M5"),
        ("S0 M3\nG1 X1 F1 S5", 2, "P0120 S"),
        ("S1\nG84 X1 Z-1 R1 F1", 2, "P0120 the spindle does not turn into the thread"),
        (
            "S1\nM29\nG84 X1 Z-1 R1 F1\nG80\nG84 X1 Z-1 R1",
            5,
            "P0120 the spindle does not turn into the thread",
        ),
        (
            "S1 M3\nG84 X1 Z-1 R1 F1\nG74 X2 Z-1 R1",
            3,
            "P0120 the spindle does not turn into the thread",
        ),
        ("S1 M29 M8", 1, "P0120 M29"),
        ("G91 G0 C0.0004", 1, "P0120 no multiple of the least increment"),
        (
            "S1 M3\nG0 Z5\nG43 H1 G81 X1 Z-1 R1 F1",
            3,
            "P0120 changes the length offset, before or after",
        ),
        ("T1 M6\nTRAORI\nG0 X1", 3, "P0119 TRAORI"),
        ("#1=6\nG0 X#1/2", 2, "P0204 `/`"),
        ("M98 P7 #1=2\nM30\nO7\nM99", 1, "P0120 M98"),
        ("#1=7\nM98 P#1 L2\nM30\nO7\nM99", 2, "P0120 M98"),
        ("#<a>=1\nM98 P7\nM30\nO7\nG0 X#<a>\nM99", 5, "P0210 #<a>"),
        ("G43.5 H1\nG1 F1 X1 I0 J0 K0", 2, "P0125"),
        ("G43.5 H1\nG1 F1 X1 A5", 2, "P0120 write the tool vector"),
        ("T1 M6\nTRAORI\nD2", 3, "P0106 D1"),
        ("TRAORI", 1, "P0119 a tool in the spindle"),
        ("G53.1", 1, "P0119 a tilted plane"),
        ("G68.2 X0 Y0 Z0 I0 J0", 1, "P0119 Euler angles"),
        ("G68.2 P1 X0 Y0 Z0 I0 J0 K0", 1, "P0106"),
        ("G68.2 X0 Y0 Z0 I0 J30 K0\nG0 A10\nG0 X1", 3, "P0120 G53.1"),
        ("G68.2 X0 Y0 Z0 I0 J30 K0\nG53.1\nA10", 3, "P0121"),
        ("G68.2 X0 Y0 Z0 I0 J30 K0\nG53.1\nG0 A10", 3, "P0120 G69"),
        ("G68 X0 Y0 R30\nG55", 2, "P0120 G55"),
        ("G68 X0 Y0 R30\nG18", 2, "P0120 another plane"),
        ("G52 X1\nG92 X0", 2, "P0120 G52"),
        ("G92 X1\nG52 X0", 2, "P0120 G92"),
        ("G10 L20 P1 X0", 1, "P0115 L20"),
        ("G10 L10 P1 R50", 1, "P0115 L10"),
        ("G10 L2 P0 X1", 1, "P0115 P0"),
        ("G154 P3", 1, "P0115 G154"),
        ("G13 I10 D1", 1, "P0115 G13"),
        ("G150 P7", 1, "P0115 G150"),
        ("G53.6", 1, "P0115 G53.6"),
        ("G54.4 P1", 1, "P0115 G54.4"),
        ("G254", 1, "P0115 G254"),
        ("M98 P7", 1, "P0126 O7"),
        ("G10 L2 P1 X0 Y0 Z0 R30", 1, "P0115 a rotation of the work offset on LinuxCNC alone"),
        ("G0 X1\nG92.1 Y0", 2, "P0118 Y"),
        ("G0 X1\nG53.1", 2, "P0119 a tilted plane"),
        ("G0 X1\nG68 X0 Y0 Z5 R30", 2, "P0118 Z"),
        ("G0 X1\nG4 X0 P500", 2, "P0118 X"),
        ("G0 X1\nG4 P1 Z5", 2, "P0118 Z"),
        ("G0 X1\nG4 Z5", 2, "P0118 Z"),
        ("G4 S3", 1, "P0120 S"),
        ("G1 X1 F1 M3 S1", 1, "P0120 M3"),
        ("M3 S1\nG1 X1 F1 M5", 2, "P0120 M5"),
        ("G18 G81 X1 Y-1 R1 F1", 1, "P0120 G81"),
        ("M98 P7\nM30\nO7\nG0 X1 M99", 4, "P0120 M99"),
        ("G0 X1\nO7\nM99", 2, "P0137 O7"),
        ("M98 P7\nM30\nO7\nM98 P7\nM99", 4, "P0139"),
        ("O7\nM30\nO7\nM99", 3, "P0127 line 1"),
        ("G0 X1\n", 1, "P0138"),
        ("G28 X1 G1 F1\nG92 G0 X1", 2, "P0117 G92"),
        ("M6", 1, "P0119 the number of a tool"),
        ("#1=5\nO[#1] sub\nG0 X1\nO5 endsub", 2, "P0128 depends on a parameter"),
        ("(a) O5 sub\nG0 X1\n(b) O5 endsub\nG0 X1", 4, "P0138"),
        ("O5 sub\nG0 X1", 1, "P0128 it has no endsub"),
        ("O5 sub\nO6 endsub\nO5 endsub", 2, "P0128 another subprogram is open"),
        ("O5 endsub", 1, "P0136 O5 endsub"),
        ("M98 P7 L99999999\nM30\nO7\nM99", 4, "P0144 100000 blocks"),
        ("G93 G1 X1 F1\nX2", 2, "P0122 G93"),
        ("G5 X1 Y1 I1 J1 P1 Q1", 1, "P0115 G5"),
        ("G4 X1 Y2", 1, "P0118 Y"),
        ("G0 G4 X1", 1, "P0118 X"),
    ] {
        let error = refusal(program, program);
        assert_fault(program, &error, line, message);
    }
}

/// Words of a program that the dialect of its control decides.
#[test]
fn words_of_one_dialect() {
    let turned = "G10 L2 P1 X0 Y0 Z0 R30\nG0 X1\nG28 X0\nM30";
    let error = run_on_linuxcnc(turned).expect_err("a return");
    assert_fault(turned, &error, 3, "P0120 G28");
    let cycle = run_on_linuxcnc("G18 G81 X1 Z1 Y-1 R1 F1\nM30").expect("a cycle along Y");
    assert_eq!(cycle.last().and_then(|step| step.end[1]), Some(1.0));
    let execute = |control: &str, program: &str| {
        let rules = ControlRules::named(control).expect("a control");
        read(program, &ControlSetup { rules, ..at_zero() }).map(|(steps, _)| steps.len())
    };
    let kept = read("G10 L2 P2 X0\nM30", &ControlSetup::default()).expect_err("a rotation");
    assert!(is_fault(&kept, "P0119 LinuxCNC keeps a rotation"), "{kept}");
    let unit = execute("haas", "G70\nM30").expect_err("a bolt circle");
    assert!(is_fault(&unit, "P0115 a unit in programs of Sinumerik"), "{unit}");
    let circle = execute("haas", "G70 I5. J15. L12\nM30").expect_err("a bolt circle");
    assert!(is_fault(&circle, "P0115 G70"), "{circle}");
    for (division, reason) in
        [("#100=4.\nX#100/2", "P0204 `/`"), ("#100=4.\n#1=#100/0", "P0216 `/`")]
    {
        let error = execute("fanuc", division).expect_err("a division");
        assert!(is_fault(&error, reason), "{error}");
    }
    assert_eq!(execute("siemens", "G70\nM30"), Ok(0));
    assert_eq!(execute("fanuc", "M98 P7\nM30\nO7\nG0 X1. M99"), Ok(1));
    for (program, reason) in [
        ("G55\nG10 L2 P2 X4. Y0. Z0. R0\nG0 X1.\nM30", "P0119 G54"),
        ("G54\nG52 X1. Y2.\nG52 X3.\nM30", "P0120 it leaves axes out"),
    ] {
        let error = execute("siemens", &program.replace(" R0", "")).expect_err(reason);
        assert!(is_fault(&error, reason), "{error}");
        assert!(run_on_linuxcnc(program).is_ok(), "{program}");
    }
    for assigned in ["#1=1.\n#1=2. G0 X#1\nM30", "#1=1.\n#1=2. #2=#1\nG0 X#2\nM30"] {
        let error = execute("haas", assigned).expect_err("an order of assignments");
        assert_fault(assigned, &error, 2, "P0120 an assignment while its block");
        let steps = run_on_linuxcnc(assigned).expect("values before the block");
        assert_eq!(steps[0].end[0], Some(1.0));
    }
}

#[test]
fn notes_name_what_is_left_to_the_control() {
    let program = "G64 P0.1 M8 S100\n/G0 X1\nT1 M6\nG0 C270\nM0\nM8\nM30\n%\nmore\n";
    let (_, notes) = read(&format!("%\n{program}"), &at_zero()).expect("a program");
    let kinds: Vec<_> =
        notes.iter().map(|note| (note.line, note.count, note.kind.clone())).collect();
    let passed = |word: &str| NoteKind::PassedOver { word: word.to_owned() };
    for expected in [
        (2, 1, passed("G64")),
        (3, 1, NoteKind::RoundedCorners),
        (2, 2, passed("M8")),
        (2, 1, passed("S")),
        (3, 1, NoteKind::ExecutedOptionalBlock),
        (4, 1, NoteKind::ToolChange),
        (6, 1, NoteKind::Stop),
        (10, 1, NoteKind::TextAfterEnd),
        (3, 1, NoteKind::AssumedMode { word: "G90" }),
    ] {
        assert!(kinds.contains(&expected), "{expected:?} is not in {kinds:?}");
    }
    assert_eq!(kinds.len(), 9, "{kinds:?}");
    // Text after M30 that is no subprogram, and Fanuc's path modes, on and off.
    let program = "G61\nG0 X0\nG5.1 Q0\nG0 X1\nG61\nM30\n(end)\n\nG0 X1\n";
    let (_, notes) = read(program, &at_zero()).expect("a program");
    let shown: Vec<String> = notes.iter().map(ToString::to_string).collect();
    for expected in [
        "line 1: G61 is passed",
        "line 3: G5.1 is passed",
        "line 4: the control may round corners",
        "line 9: the text after",
    ] {
        assert!(
            shown.iter().any(|note| note.starts_with(expected)),
            "{expected} is not in {shown:?}"
        );
    }
    let (_, notes) = read("M30\n(end)\nN5 O7\nG0 X1\nM99\n", &at_zero()).expect("a program");
    assert_eq!(notes, []);
    let setup = ControlSetup {
        rules: ControlRules::default().with(Rule::OptionalBlocks, Choice::LeftOut),
        ..at_zero()
    };
    let (steps, notes) = read("/2 G0 X1\nG0 X2\nM30", &setup).expect("a program");
    assert_eq!(steps.len(), 1);
    assert!(notes.iter().any(|note| note.kind == NoteKind::OmittedOptionalBlock));
}
