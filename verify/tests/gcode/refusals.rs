//! Programs that have to be refused, with the line, and programs that have to be read.

use crate::common::{execute, folder, text};
use touchoff_verify::gcode::{
    Choice, ControlRules, ControlSetup, GcodeError, NoteKind, Position, Rule, Step, StepPath, Tcp,
    read,
};

fn at_zero() -> ControlSetup {
    ControlSetup {
        start: [Some(0.0); 6],
        work_offsets: [Some([0.0; 6]); 9],
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
        ("a-in-canned-cycle", 3, "A while a canned cycle is in force"),
        ("a-in-canned-cycle2", 2, "A while a canned cycle is in force"),
        ("bad-arc.big.imperial.center-format", 6, "differ by more than"),
        ("bad-arc.big.metric.center-format", 6, "differ by more than"),
        ("bad-arc.medium.imperial.center-format", 6, "differ by more than"),
        ("bad-arc.medium.metric.center-format", 6, "differ by more than"),
        ("bad-arc.small.imperial.center-format", 6, "differ by more than"),
        ("bad-arc.small.metric.center-format", 6, "differ by more than"),
        ("ccomp-arcexit", 7, "the motion after G40 is an arc"),
        (
            "ccomp-gouging",
            6,
            "does not fit into the inside corner at the end of the motion of line 5",
        ),
        ("exists-1", 2, "EXISTS"),
        ("exists-2", 2, "EXISTS"),
        ("exists-3", 3, "EXISTS"),
        ("exists-4", 2, "EXISTS"),
        ("exists-5", 2, "EXISTS"),
        ("exists-6", 2, "EXISTS"),
        ("exists-7", 2, "EXISTS"),
        ("g64-m19-r-ambiguous", 2, "R beside G64 and M19"),
        ("g64-r-on-g61", 2, "R is used by no G or M word"),
        ("nested", 6, "it stands in another subprogram"),
        ("no-feed-rate", 2, "G1 needs a feed rate"),
        ("no-ijr", 2, "neither a centre nor a radius"),
        ("probe-no-axes", 2, "G38.2 is probing"),
    ];
    for (name, line, message) in bad {
        let program = text(&folder.join(format!("interp/bad/{name}.ngc")));
        // G41.1 is a word of LinuxCNC alone.
        let error = match name.starts_with("ccomp") {
            true => run_on_linuxcnc(&program).expect_err(name),
            false => refusal(name, &program),
        };
        assert_eq!(error.line, line, "{name}: {error}");
        assert!(error.to_string().contains(message), "{name}: {error}");
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
        ("O...-called-with-O..._call", Err((4, "a program without `sub`"))),
        ("O...-ended-with-O..._endsub", Err((8, "a program without `sub`"))),
        ("O...-sub-called-with-M98", Err((4, "a subprogram with `sub`"))),
        ("O...-sub-ended-with-M99", Err((6, "it has no endsub"))),
        ("test-illegal-end-main-with-eof", Err((15, "without M2, M30, END PGM or %"))),
        ("test-illegal-no-m30-before-osub", Err((10, "runs into O2"))),
        ("test-illegal-sub-after-percent", Err((7, "there is no O2 in this file"))),
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
                assert_eq!(error.line, line, "{name}: {error}");
                assert!(error.to_string().contains(message), "{name}: {error}");
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
        ("xyzac_switchkins", Err("there is no O<xyzac_switchkins_sub>")),
        ("xyzbc_switchkins", Err("there is no O<xyzbc_switchkins_sub>")),
    ] {
        match (run_on_linuxcnc(&text(&folder.join(format!("five_axis/{file}.ngc")))), expected) {
            (Ok(steps), Ok(count)) => assert_eq!(steps.len(), count, "{file}"),
            (Err(error), Err(message)) => {
                assert!(error.to_string().contains(message), "{file}: {error}");
            }
            (result, _) => panic!("{file}: {result:?}"),
        }
    }
}

#[test]
fn words_that_are_not_read_are_named() {
    for (program, line, message) in [
        ("G21\nG41 D1 X1", 2, "the radius offset 1 is not known"),
        ("G1 F1 X[ASIN[0.5]]", 1, "`ASIN` of this value"),
        ("G1 F1 X[FIX[-0.5]]", 1, "another value on Fanuc than on LinuxCNC"),
        ("X#5220", 1, "#5220 is a system variable"),
        ("X#<_x>", 1, "#<_x> is a system variable"),
        ("G0 X#1", 1, "#1 has no value here"),
        ("G0 X[1/0]", 1, "the result of `/`"),
        ("G0 X[1+[2]", 1, "no `]`"),
        ("o1 if [1]", 1, "O1 if: it has no end"),
        ("o1 while [1]", 1, "O1 while: it has no end"),
        ("o1 endif", 1, "O1 endif: it has no beginning"),
        ("IF [#1 EQ 0] GOTO 10", 1, "#1 has no value here"),
        ("WHILE[1GT0]DO1", 1, "no other end"),
        ("GOTO 10", 1, "there is no N10"),
        ("GOTO 10\nN10\nN10", 1, "N10 stands in lines 2 and 3"),
        ("GOTO 10\nDO1\nN10\nEND1", 1, "into a loop"),
        ("GOTOF END", 1, "there is no `END` in the direction"),
        ("N1 GOTO 1", 1, "more than 10000000 blocks"),
        ("IF [1 EQ 1] G0 X1", 1, "IF needs GOTO or THEN"),
        (
            "WHILE [1 EQ 1] DO 4",
            1,
            "`DO4` is not understood here: write DO and END with a number from 1 to 3",
        ),
        ("WHILE[1EQ1]DO1\nEND1", 1, "loops, jumps and subprograms take more than 10000000 blocks"),
        ("END5", 1, "`END5` is not understood here"),
        (
            "#1=#5061",
            1,
            "#5061 is a system variable (the position of a skip or a probe), whose value",
        ),
        ("#1=#5041", 1, "#5041 is a system variable (the present position), whose value"),
        ("#1=#3007", 1, "#3007 is a system variable (the mirror images in force), whose value"),
        ("#1=0.1\nIF [[#1*3] EQ 0.3] GOTO 2\nN2", 2, "depends on the digits"),
        ("G65 P9 A1\nM30\nO9\nM99", 1, "A of G65 while its number has no decimal point"),
        ("G65 P9 N1.\nM30\nO9\nM99", 1, "N is no argument of G65"),
        ("G65 A1.\nM30", 1, "G65 needs P"),
        ("G65 P8\nM30", 1, "there is no O8"),
        ("IF [1 EQ 1] THEN #3000=5", 1, "alarm 5"),
        ("o1 call [2]\nM30", 1, "there is no O1"),
        ("5 L X+10 Y+20 R0 FMAX", 1, "Heidenhain Klartext"),
        ("G21\n0 BEGIN PGM X MM", 2, "`BEGIN` is a word of Heidenhain Klartext: begin the program"),
        ("5 X1", 1, "the character `5`"),
        ("L X+10 Y+20 R0 FMAX", 1, "Heidenhain Klartext"),
        ("CYCL DEF 200", 1, "Heidenhain Klartext"),
        ("TOOL CALL 5 Z S1000", 1, "Heidenhain Klartext"),
        ("PLANE SPATIAL", 1, "Heidenhain Klartext"),
        ("M128", 1, "tool centre point control of Heidenhain"),
        ("G0 X1 0", 1, "the character `0`"),
        ("G0 X1 U2", 1, "the axis U"),
        ("G777", 1, "G777 is not understood"),
        ("G1.25", 1, "G1.25 is not understood"),
        ("M77", 1, "M77 is not understood"),
        ("G0 X1 Q2", 1, "Q is used by no"),
        ("G0 X1 X2", 1, "X stands twice"),
        ("G0 G1 X1 F1", 1, "G0 and G1 exclude each other"),
        ("G54 G55", 1, "G54 and G55 exclude"),
        ("X1", 1, "without a motion mode"),
        ("G0 X1\nG80\nX2", 3, "without a motion mode"),
        ("G0 X10000000000", 1, "not a number within"),
        ("G0 X1.2.3", 1, "`1.2.3` is not a number"),
        ("G0 X-", 1, "a value is missing at the end"),
        ("(open\nG0 X1", 1, "no `)`"),
        ("G0 X1\u{e9}", 1, "the character `é`"),
        ("G2 X1 F1 R0.1", 1, "less than half the distance"),
        ("G2 X0 F1 R1", 1, "ends where it starts"),
        ("G2 X1 F1 R1 I1", 1, "a centre and a radius"),
        ("G2 X1 F1 K1", 1, "K is not in the plane"),
        ("G2 X1 F1 K0", 1, "neither a centre nor a radius"),
        ("G8", 1, "a mode of a lathe"),
        ("G90.1 G2 X1 F1 I1", 1, "both coordinates"),
        ("G2 X1 F1 I0", 1, "the radius zero"),
        ("G81 X1 Z-1 F1", 1, "the retract plane R"),
        ("G81 X1 R1 F1", 1, "the depth"),
        ("G81 X1 R1 Z2 F1", 1, "below the depth"),
        ("G83 X1 R1 Z-2 F1", 1, "depth of peck Q"),
        ("G83 X1 R1 Z-2 Q0.00001 F1", 1, "more than 100000 motions"),
        ("G87 X1 R1 Z-2", 1, "boring cycle"),
        ("G98 G81 R1 F1", 1, "G81 needs X, Y or Z"),
        ("G53 X1\nG91 G53 X1", 2, "G53 while G91"),
        ("G43 Z1", 1, "H with the number"),
        ("G43.4 H1\nG53 Z0", 2, "tool centre point control is on"),
        ("G43.4 H1\nTRAORI", 2, "G43.4, G43.5 or G234 is in force"),
        ("M428", 1, "five-axis configurations alone"),
        ("G0 X1\nG28", 2, "G28 needs the axes that return"),
        ("G92.3", 1, "a shift that another program may have left"),
        ("G43 H0", 1, "write G49, or name the control"),
        ("G68 X0 Y0 R90\nG0 X5", 2, "the first after G68 or G69"),
        ("G68 X0 Y0 R90\nG0 X5 Y0\nG69\nG91 X1", 4, "the first after G68 or G69"),
        ("G68 X0 Y0 R90\nG53 G0 Z0", 2, "G53 while a plane is rotated"),
        ("G68 X0 Y0 R90\nG28 X0 Y0", 2, "G28 while a plane is rotated"),
        ("G91 G92 X1", 1, "G92 while G91 is in force"),
        ("G91 G0 X0.0004", 1, "no multiple of the least increment"),
        (
            "G52 X1\nG91 G0 X1",
            2,
            "X while G91 is in force and its work offset, shift or length has changed",
        ),
        ("G0 X1\nG20 X1", 2, "G20 while the program has lengths in another unit"),
        ("M3 M8 S1", 1, "M3 while its block has another M word"),
        ("T1 M6 G43 H1", 1, "G43 while its block has M6"),
        ("T1 M6 G28 Z0", 1, "G28 while its block has M6"),
        ("G54 G4 P2", 1, "P beside G54"),
        ("G2 I1 J0 P2 F1", 1, "a number of turns on LinuxCNC alone"),
        ("M3 S1\nG2 X2 I1 J0 F1\nG2 I-1 M5", 3, "M5 while a motion at feed rate is in its block"),
        ("S0 M3\nG1 X1 F1 S5", 2, "S while a motion at feed rate is in its block"),
        ("S1\nG84 X1 Z-1 R1 F1", 2, "the spindle does not turn into the thread"),
        (
            "S1\nM29\nG84 X1 Z-1 R1 F1\nG80\nG84 X1 Z-1 R1",
            5,
            "the spindle does not turn into the thread",
        ),
        ("S1 M3\nG84 X1 Z-1 R1 F1\nG74 X2 Z-1 R1", 3, "the spindle does not turn into the thread"),
        ("S1 M29 M8", 1, "M29 while its block has another M word"),
        ("G91 G0 C0.0004", 1, "no multiple of the least increment"),
        ("S1 M3\nG0 Z5\nG43 H1 G81 X1 Z-1 R1 F1", 3, "changes the length offset, before or after"),
        ("T1 M6\nTRAORI\nG0 X1", 3, "TRAORI and TRAFOOF deselect it"),
        ("#1=6/2", 1, "`/` outside of brackets"),
        ("M98 P7 #1=2\nM30\nO7\nM99", 1, "M98 while its block has other words"),
        ("#1=7\nM98 P#1 L2\nM30\nO7\nM99", 2, "M98 while its block has other words"),
        ("#<a>=1\nM98 P7\nM30\nO7\nG0 X#<a>\nM99", 5, "#<a> has no value here"),
        ("G43.5 H1\nG1 F1 X1 I0 J0 K0", 2, "points nowhere"),
        ("G43.5 H1\nG1 F1 X1 A5", 2, "write the tool vector"),
        ("T1 M6\nTRAORI\nD2", 3, "D1, the only"),
        ("TRAORI", 1, "a tool in the spindle"),
        ("G53.1", 1, "a tilted plane"),
        ("G68.2 X0 Y0 Z0 I0 J0", 1, "Euler angles"),
        ("G68.2 P1 X0 Y0 Z0 I0 J0 K0", 1, "P0, or no P"),
        ("G68.2 X0 Y0 Z0 I0 J30 K0\nG0 A10\nG0 X1", 3, "write G53.1"),
        ("G68.2 X0 Y0 Z0 I0 J30 K0\nG53.1\nA10", 3, "without a motion mode"),
        ("G68.2 X0 Y0 Z0 I0 J30 K0\nG53.1\nG0 A10", 3, "end the plane with G69"),
        ("G68 X0 Y0 R30\nG55", 2, "G55 while a plane is rotated"),
        ("G68 X0 Y0 R30\nG18", 2, "another plane"),
        ("G52 X1\nG92 X0", 2, "G52 is in force"),
        ("G92 X1\nG52 X0", 2, "G92 is in force"),
        ("G10 L20 P1 X0", 1, "L20 of G10 is the origin of a further work offset on Fanuc"),
        ("G10 L10 P1 R50", 1, "L10 of G10 is a length or a radius of a tool"),
        ("G10 L2 P0 X1", 1, "P0 of G10 is the external work offset"),
        ("G154 P3", 1, "G154 is a work offset of Haas"),
        ("G13 I10 D1", 1, "G13 is a circular pocket of Haas"),
        ("G150 P7", 1, "G150 is a pocket of Haas"),
        ("G53.6", 1, "G53.6 is an alignment that turns the axes about the tip"),
        ("G54.4 P1", 1, "G54.4 is a compensation of the part's place"),
        ("G254", 1, "G254 is a dynamic work offset"),
        ("M98 P7", 1, "there is no O7"),
        ("G10 L2 P1 X0 Y0 Z0 R30", 1, "a rotation of the work offset on LinuxCNC alone"),
        ("G0 X1\nG92.1 Y0", 2, "Y is used by no"),
        ("G0 X1\nG53.1", 2, "a tilted plane"),
        ("G0 X1\nG68 X0 Y0 Z5 R30", 2, "Z is used by no"),
        ("G0 X1\nG4 X0 P500", 2, "X is used by no"),
        ("G0 X1\nG4 P1 Z5", 2, "Z is used by no"),
        ("G0 X1\nG4 Z5", 2, "Z is used by no"),
        ("G4 S3", 1, "S while its block has G4"),
        ("G1 X1 F1 M3 S1", 1, "M3 while a motion at feed rate is in its block"),
        ("M3 S1\nG1 X1 F1 M5", 2, "M5 while a motion at feed rate is in its block"),
        ("G18 G81 X1 Y-1 R1 F1", 1, "G81 while G18 or G19 is in force"),
        ("M98 P7\nM30\nO7\nG0 X1 M99", 4, "M99 while its block has other words"),
        ("G0 X1\nO7\nM99", 2, "runs into O7"),
        ("M98 P7\nM30\nO7\nM98 P7\nM99", 4, "more than 9 deep"),
        ("O7\nM30\nO7\nM99", 3, "already defined in line 1"),
        ("G0 X1\n", 1, "without M2, M30, END PGM or %"),
        ("G28 X1 G1 F1\nG92 G0 X1", 2, "G92 and G0 exclude"),
        ("M6", 1, "the number of a tool"),
        ("#1=5\nO[#1] sub\nG0 X1\nO5 endsub", 2, "depends on a parameter"),
        ("(a) O5 sub\nG0 X1\n(b) O5 endsub\nG0 X1", 4, "without M2, M30, END PGM or %"),
        ("O5 sub\nG0 X1", 1, "it has no endsub"),
        ("O5 sub\nO6 endsub\nO5 endsub", 2, "another subprogram is open"),
        ("O5 endsub", 1, "O5 endsub ends no subprogram"),
        ("M98 P7 L99999999\nM30\nO7\nM99", 4, "more than 10000000 blocks and motions"),
        ("G93 G1 X1 F1\nX2", 2, "(G93)"),
        ("G5 X1 Y1 I1 J1 P1 Q1", 1, "G5 is a spline"),
        ("G4 X1 Y2", 1, "Y is used by no"),
        ("G0 G4 X1", 1, "X is used by no"),
    ] {
        let error = refusal(program, program);
        assert_eq!(error.line, line, "{program}: {error}");
        assert!(error.to_string().contains(message), "{program}\n{error}");
    }
}

/// Words of a program that the dialect of its control decides.
#[test]
fn words_of_one_dialect() {
    let turned = "G10 L2 P1 X0 Y0 Z0 R30\nG0 X1\nG28 X0\nM30";
    let error = run_on_linuxcnc(turned).expect_err("a return");
    assert!(error.to_string().contains("line 3: G28 while the work offset is rotated"), "{error}");
    let cycle = run_on_linuxcnc("G18 G81 X1 Z1 Y-1 R1 F1\nM30").expect("a cycle along Y");
    assert_eq!(cycle.last().and_then(|step| step.end[1]), Some(1.0));
    let execute = |control: &str, program: &str| {
        let rules = ControlRules::named(control).expect("a control");
        read(program, &ControlSetup { rules, ..at_zero() }).map(|(steps, _)| steps.len())
    };
    let kept = read("G10 L2 P2 X0\nM30", &ControlSetup::default()).expect_err("a rotation");
    assert!(kept.to_string().contains("LinuxCNC keeps a rotation"), "{kept}");
    let unit = execute("haas", "G70\nM30").expect_err("a bolt circle");
    assert!(unit.to_string().contains("a unit in programs of Sinumerik"), "{unit}");
    let circle = execute("haas", "G70 I5. J15. L12\nM30").expect_err("a bolt circle").to_string();
    assert!(circle.contains("G70 is a pattern of holes of Haas"), "{circle}");
    for (division, reason) in [
        ("#100=4.\n#1=#100/0", "`/` outside of brackets is the sign of an optional block on Fanuc"),
        ("#100=4.\n#1=[#100/0]", "the result of `/` is not a number"),
    ] {
        let error = execute("fanuc", division).expect_err("a division").to_string();
        assert!(error.contains(reason), "{error}");
    }
    assert_eq!(execute("siemens", "G70\nM30"), Ok(0));
    assert_eq!(execute("fanuc", "M98 P7\nM30\nO7\nG0 X1. M99"), Ok(1));
    for (program, reason) in [
        ("G55\nG10 L2 P2 X4. Y0. Z0. R0\nG0 X1.\nM30", "its work offset (G54) after G10"),
        ("G54\nG52 X1. Y2.\nG52 X3.\nM30", "it leaves axes out"),
    ] {
        let error = execute("siemens", &program.replace(" R0", "")).expect_err(reason);
        assert!(error.to_string().contains(reason), "{error}");
        assert!(run_on_linuxcnc(program).is_ok(), "{program}");
    }
    for assigned in ["#1=1.\n#1=2. G0 X#1\nM30", "#1=1.\n#1=2. #2=#1\nG0 X#2\nM30"] {
        let error = execute("haas", assigned).expect_err("an order of assignments");
        assert!(error.to_string().contains("line 2: an assignment while its block"), "{error}");
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
    ] {
        assert!(kinds.contains(&expected), "{expected:?} is not in {kinds:?}");
    }
    assert_eq!(kinds.len(), 8, "{kinds:?}");
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
