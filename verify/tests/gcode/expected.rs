//! Compares the interpreter with the canonical commands that LinuxCNC's interpreter gives for its own test programs.

use crate::common::{assert_fault, folder, is_fault, text};
use std::collections::BTreeMap;
use touchoff_verify::gcode::{
    ControlRules, ControlSetup, GcodeError, Interpreter, Plane, Step, StepPath, WorkOffset,
};

/// A motion of a file `expected`, lengths in millimetres.
#[derive(Clone, Debug, Default)]
struct Canonical {
    text: String,
    rapid: bool,
    end: [f64; 6],
    /// Centre in the order of the plane's axes, and turns with the sign of the direction.
    arc: Option<([f64; 2], i32)>,
    plane: usize,
    work_offset: usize,
    origin: [f64; 6],
    rotation: f64,
    shift: [f64; 6],
    /// Millimetres per unit, by which the rounding of the file is multiplied.
    unit: f64,
    /// Digits after the point.
    digits: i32,
}

/// Reads the numbers in the parentheses of a canonical command.
fn numbers(text: &str) -> Vec<f64> {
    let inside = text.split_once('(').map_or("", |(_, rest)| rest);
    inside.split([',', '(', ')', ' ']).filter_map(|word| word.parse().ok()).collect()
}

fn six(values: &[f64], unit: f64) -> [f64; 6] {
    std::array::from_fn(|k| if k < 3 { unit * values[k] } else { values[k] })
}

/// Reads the motions of a file `expected`. Messages that report a position count as motions to it.
fn canonical(text: &str) -> Vec<Canonical> {
    let mut now = Canonical { unit: 1.0, digits: 4, ..Canonical::default() };
    let mut found = Vec::new();
    for line in text.lines() {
        let Some((_, command)) = line.split_once("N..... ") else { continue };
        let name = command.split('(').next().expect("a command");
        let values = numbers(command);
        let mut emit =
            |motion: Canonical| found.push(Canonical { text: line.trim().into(), ..motion });
        match name {
            "USE_LENGTH_UNITS" => now.unit = if command.contains("INCHES") { 25.4 } else { 1.0 },
            "SELECT_PLANE" => {
                now.plane = ["_XY", "_XZ", "_YZ"]
                    .iter()
                    .position(|p| command.contains(p))
                    .expect("a plane");
            }
            "SET_G5X_OFFSET" => {
                now.work_offset = values[0] as usize;
                now.origin = six(&values[1..], now.unit);
            }
            "SET_G92_OFFSET" => now.shift = six(&values, now.unit),
            "SET_XY_ROTATION" => now.rotation = values[0],
            "STRAIGHT_TRAVERSE" | "STRAIGHT_FEED" => {
                now.end = six(&values, now.unit);
                emit(Canonical { rapid: name == "STRAIGHT_TRAVERSE", ..now.clone() });
            }
            "ARC_FEED" => {
                let [first, second, normal] = [[0, 1, 2], [2, 0, 1], [1, 2, 0]][now.plane];
                now.end = [0.0; 6];
                now.end[first] = now.unit * values[0];
                now.end[second] = now.unit * values[1];
                now.end[normal] = now.unit * values[5];
                now.end[3..].copy_from_slice(&values[6..9]);
                let arc = Some(([now.unit * values[2], now.unit * values[3]], values[4] as i32));
                emit(Canonical { rapid: false, arc, ..now.clone() });
            }
            "MESSAGE" if command.contains(" X") && command.contains(" Y") => {
                let place = |letter: char| {
                    let (_, rest) = command.split_once(letter).expect("a coordinate");
                    rest.split([' ', '"'])
                        .next()
                        .and_then(|word| word.parse::<f64>().ok())
                        .expect("a number")
                };
                now.end[..3]
                    .copy_from_slice(&['X', 'Y', 'Z'].map(|letter| now.unit * place(letter)));
                emit(Canonical { rapid: true, digits: 6, ..now.clone() });
            }
            "MESSAGE" if ["in inches,", "in mm,"].iter().any(|part| command.contains(part)) => {
                let (_, list) = command.rsplit_once(": ").expect("values");
                let values: Vec<f64> = list
                    .trim_end_matches("\")")
                    .split(' ')
                    .map(|word| word.parse().expect("a number"))
                    .collect();
                now.end = six(&values, now.unit);
                emit(Canonical { rapid: true, digits: 6, ..now.clone() });
            }
            _ => {}
        }
    }
    found
}

/// A control that stands at the origin and has all offsets at zero, as `rs274` has.
fn setup() -> ControlSetup {
    let zero = [0.0; 6];
    ControlSetup {
        start: zero.map(Some),
        work_offsets: [Some(zero); 9],
        lengths: BTreeMap::new(),
        home: zero.map(Some),
        second_home: Some(zero),
        rules: ControlRules::named("linuxcnc").expect("a control"),
        ..ControlSetup::default()
    }
}

fn steps(program: &str) -> (Vec<Step>, Option<GcodeError>) {
    steps_with(program, &setup())
}

fn steps_with(program: &str, setup: &ControlSetup) -> (Vec<Step>, Option<GcodeError>) {
    let interpreter = match Interpreter::new(program, setup) {
        Ok(interpreter) => interpreter,
        Err(error) => return (Vec::new(), Some(error)),
    };
    let mut steps = Vec::new();
    for step in interpreter {
        match step {
            Ok(step) => steps.push(step),
            Err(error) => return (steps, Some(error)),
        }
    }
    (steps, None)
}

/// `slack` is added to the tolerance of positions, in the unit of the program.
fn check_step(name: &str, step: &Step, wanted: &Canonical, slack: f64) {
    let fail = |what: &str| panic!("{name}: {what} of {} in\n{step:?}", wanted.text);
    let tolerance = |axis: usize| {
        (0.5 * 10f64.powi(-wanted.digits) + slack + 1e-9) * if axis < 3 { wanted.unit } else { 1.0 }
    };
    for axis in 0..6 {
        match step.end[axis] {
            Some(value) if (value - wanted.end[axis]).abs() <= tolerance(axis) => {}
            _ => fail("end"),
        }
        let near = |value: Option<f64>, other: f64| {
            value.is_some_and(|value| (value - other).abs() <= 0.5e-4 * wanted.unit + 1e-9)
        };
        if !near(step.state.origin[axis], wanted.origin[axis]) {
            fail("origin");
        }
        if !near(step.state.shift[axis], wanted.shift[axis]) {
            fail("shift");
        }
    }
    if step.rapid != wanted.rapid {
        fail("rapid");
    }
    if step.state.work_offset != WorkOffset::Standard(wanted.work_offset as u8) {
        fail("work offset");
    }
    if (step.state.origin_rotation - wanted.rotation).abs() > 1e-4 {
        fail("rotation");
    }
    match (step.path, wanted.arc) {
        (StepPath::Line, None) => {}
        (StepPath::Arc { plane, centre, sweep }, Some((wanted_centre, turns))) => {
            if plane != [Plane::Xy, Plane::Zx, Plane::Yz][wanted.plane] {
                fail("plane");
            }
            if (0..2).any(|k| (centre[k] - wanted_centre[k]).abs() > tolerance(0)) {
                fail("centre");
            }
            let turn = sweep.abs() / std::f64::consts::TAU;
            if sweep.signum() as i32 != turns.signum() || turn.ceil() as i32 != turns.abs() {
                fail("turns");
            }
        }
        _ => fail("path"),
    }
}

fn compare(name: &str, program: &str, expected: &[Canonical], slack: f64) -> usize {
    let (steps, error) = steps(program);
    if let Some(error) = error {
        panic!("{name}: {error}");
    }
    assert_eq!(steps.len(), expected.len(), "{name}: number of motions");
    for (step, wanted) in steps.iter().zip(expected) {
        check_step(name, step, wanted, slack);
    }
    steps.len()
}

/// Replaces the messages that print a position by a motion of no length.
fn with_probes(program: &str) -> String {
    let is_position = |line: &str| line.contains("#5420");
    program
        .lines()
        .map(|line| if is_position(line) { "g91 g0 a0\ng90\n".into() } else { format!("{line}\n") })
        .collect()
}

#[test]
fn motions_are_those_of_linuxcnc() {
    let Some(folder) = folder() else { return };
    let folder = folder.join("interp");
    let mut total = 0;
    // The results of g81 are those of the last of its programs. The arcs of inside-corners are rounded, and are spirals: where LinuxCNC
    // takes the radius of the end for that of the start, corners move by up to twice the last digit.
    for (program, expected, slack) in [
        ("g10/test.ngc", "g10/expected", 0.0),
        ("g81/g19-g99-g81.ngc", "g81/expected", 0.0),
        ("rotation/g53.ngc", "rotation/expected", 0.0),
        ("flowsnake/flowsnake.ngc", "flowsnake/expected", 0.0),
        ("crazy-paths/test.ngc", "crazy-paths/expected", 0.0),
        ("unit-conversion/test.ngc", "unit-conversion/expected", 0.0),
        ("m98m99/test.ngc", "m98m99/expected", 0.0),
        ("g52/g92_offsets.ngc", "g52/expected", 0.0),
        ("inside-corners/test.ngc", "inside-corners/expected", 2e-4),
    ] {
        let expected = canonical(&text(&folder.join(expected)));
        let count = compare(program, &with_probes(&text(&folder.join(program))), &expected, slack);
        println!("{program}: {count} motions");
        total += count;
    }
    let mut good = 0;
    for entry in std::fs::read_dir(folder.join("good")).expect("a folder") {
        let path = entry.expect("an entry").path();
        if path.extension().is_some_and(|ending| ending == "ngc") {
            let expected = text(&path.with_extension("ngc.expected"));
            total += compare(&path.display().to_string(), &text(&path), &canonical(&expected), 0.0);
            good += 1;
        }
    }
    assert_eq!(good, 6);
    println!("{total} motions in all");
    assert!(total > 70);
}

/// The programs whose result LinuxCNC has, but that use what is not read: line and message of the refusal. The
/// motions before it are compared.
#[test]
fn programs_that_are_not_read_are_refused_by_name() {
    let Some(folder) = folder() else { return };
    let folder = folder.join("interp");
    for (program, expected, line, message) in [
        ("cam-nisley/cam.ngc", "cam-nisley/expected", 74, "P0401"),
        ("sequence-number/test.ngc", "sequence-number/expected", 8, "P0126 O<rm400>"),
        ("g52/g52-g92-interaction.ngc", "g52/expected", 16, "P0115 G92.3"),
        ("rotation/g28.ngc", "rotation/expected", 7, "P0115 G28.1"),
    ] {
        let (steps, error) = steps(&text(&folder.join(program)));
        let error = error.unwrap_or_else(|| panic!("{program} is not refused"));
        assert_fault(program, &error, line, message);
        // G28.1 has no result of its own.
        if !program.contains("g28") {
            let expected = canonical(&text(&folder.join(expected)));
            for (step, wanted) in steps.iter().zip(&expected) {
                check_step(program, step, wanted, 0.0);
            }
            println!("{program}: {} motions before {error}", steps.len());
        }
    }
}

/// Returns the motions of the programs in `g81` and `g84`, as in the plane G17 and in inches: rapid, position. Written
/// from their comments and the definitions of the cycles.
fn holes(is_tapping: bool, returns_to_r: bool) -> Vec<(bool, [f64; 3])> {
    let mut found = vec![(true, [0.0, 0.0, 2.0])];
    // Drills a hole, from the level `from` to which the tool may have to be raised first.
    let hole =
        |found: &mut Vec<_>, from: f64, [x, y]: [f64; 2], [depth, retract, initial]: [f64; 3]| {
            found.push((true, [x, y, from]));
            if from > retract {
                found.push((true, [x, y, retract]));
            }
            found.push((false, [x, y, depth]));
            let clear = if returns_to_r { retract } else { initial.max(retract) };
            found.push((!is_tapping, [x, y, clear]));
            clear
        };
    hole(&mut found, 2.0, [1.0, 1.0], [-1.0, 1.0, 2.0]);
    found.push((true, [1.0, 1.0, 3.0]));
    hole(&mut found, 3.0, [1.0, 2.0], [0.5, 3.0, 2.0]);
    found.push((true, [1.0, 2.0, 5.0]));
    hole(&mut found, 5.0, [1.0, 3.0], [4.0, 5.0, 2.0]);
    for (start, [depth, retract]) in [(10.0, [-1.0, 1.0]), (20.0, [0.5, 3.0]), (30.0, [4.0, 5.0])] {
        found.push((true, [start, 0.0, 2.0]));
        let mut from = 2.0;
        if retract > from {
            from = retract;
            found.push((true, [start, 0.0, from]));
        }
        for k in [1.0, 2.0] {
            from = hole(&mut found, from, [start + k, k], [depth, retract, 2.0]);
        }
    }
    found
}

/// All programs of `g81` and `g84`. The planes permute the axes.
#[test]
fn cycles_in_three_planes_and_with_both_retracts() {
    let Some(folder) = folder() else { return };
    let mut count = 0;
    for (cycle, retract) in [("g81", "g98"), ("g81", "g99"), ("g84", "g98"), ("g84", "g99")] {
        // The axes of the hole's position and of its depth, as these programs write them.
        for (plane, axes) in [("g17", [0, 1, 2]), ("g18", [0, 2, 1]), ("g19", [1, 2, 0])] {
            let name = format!("{plane}-{retract}-{cycle}");
            // One program of G84 has a G81 among its cycles, by mistake.
            let program =
                text(&folder.join(format!("interp/{cycle}/{name}.ngc"))).replace("g81", cycle);
            let (steps, error) = steps(&program);
            // LinuxCNC taps along another axis there.
            if cycle == "g84" && plane != "g17" {
                assert!(error.is_some_and(|error| is_fault(&error, "P0120 G18")));
                continue;
            }
            assert_eq!(error, None, "{name}");
            let expected = holes(cycle == "g84", retract == "g99");
            assert_eq!(steps.len(), expected.len(), "{name}");
            for (step, (rapid, position)) in steps.iter().zip(expected) {
                assert_eq!(step.rapid, rapid, "{name}: {step:?}");
                for (axis, wanted) in axes.into_iter().zip(position) {
                    let value = step.end[axis].expect("a coordinate");
                    assert!((value - 25.4 * wanted).abs() < 1e-12, "{name}: {step:?}");
                }
                count += 1;
            }
        }
    }
    println!("{count} motions of cycles");
}

/// Folders of LinuxCNC's own tests whose programs are not read as its interpreter reads them, with the reason: the refusal, or what the
/// test is about.
const NOT_READ: &[(&str, &str)] = &[
    // The program stops with an error there, too, or its result is that of several runs.
    ("m98m99/03-error-M98-no-P-word", "M98 needs P"),
    ("m98m99/04-M98-but-no-sub", "there is no O1 in this file"),
    ("m98m99/06-error-mixed-sub-styles", "call it by M98 P"),
    ("m98m99/09-disable-fanuc-subs", "10 motions, not 32"),
    ("m98m99/11-main-program-oword", "the program stops here"),
    ("nested-sub-error", "there is no O<nested> in this file"),
    ("nested-sub-in-file-error", "there is no O<sequential> in this file"),
    // Its first O0002 is taken for another label than O2.
    ("m98m99/10-M98-P001", "O2 is already defined"),
    // It is repeated until a variable, which is not known before, has counted three runs.
    ("m98m99/12-M99-endless-main-program", "#100 has no value"),
    // The result is a list of positions.
    ("rotation/abs-pts", "27 motions, not 0"),
    // Python, remapped words, files of the machine, and subprograms in other files.
    ("iniparam", "#<_ini[vars]toolchange_x> has no value"),
    ("pymove", "there is no O<canonmove> in this file"),
    ("python-self", "py, is a comment whose Python"),
    ("sub-call-from-sub", "there is no O<caller> in this file"),
    ("value-returned", "py, is a comment whose Python"),
    // Words that are refused with their reasons.
    ("g10/g10-l1-l10", "of G10"),
    ("g10/g10-l11", "of G10"),
    ("g10/g10-l20-while-active", "G10 L20 while a shift is in force, or a work offset is rotated"),
    ("g33.1", "G33.1 is threading"),
    ("g52/g52-g92-interaction", "G92.3 is a shift that another program may have left"),
    ("g64-r-planner", "R is used by no G or M word"),
    ("g71-endless-loop", "G8 is no word of LinuxCNC"),
    ("g71-endless-loop2", "D is used by no G or M word"),
    ("g71-endless-loop_2", "G7 is diameter mode of a lathe"),
    ("g71-with-g70", "G71.1 is"),
    ("g72-facing", "G43 while its block has M6"),
    ("g72-missing-iteration", "G43 while its block has M6"),
    ("g76", "G76 is"),
    ("g84/g18/g98", "G84 while G18 or G19"),
    ("g84/g18/g99", "G84 while G18 or G19"),
    ("g84/g19/g98", "G84 while G18 or G19"),
    ("g84/g19/g99", "G84 while G18 or G19"),
    ("m19", "Q is used by no G or M word"),
    ("machine-coord-params", "G43.1 is another form of tool length offset"),
    ("oword-bug315-p2", "the label after O while it depends on a name"),
    ("rotation/g28", "G28.1 is storing a reference position"),
];

/// The tools of a table: lengths and radii in millimetres, of a machine in inches as that of `rs274`.
fn with_tools(mut setup: ControlSetup, table: &str) -> ControlSetup {
    for line in table.lines() {
        let mut number = None;
        for word in line.split(';').next().unwrap_or_default().split_whitespace() {
            let (letter, value) = word.split_at(1);
            match (letter, value.parse::<f64>(), number) {
                ("T", Ok(tool), _) => number = Some(tool as u32),
                ("Z", Ok(length), Some(tool)) => drop(setup.lengths.insert(tool, 25.4 * length)),
                ("D", Ok(diameter), Some(tool)) => {
                    setup.radius_offsets.insert(tool, 12.7 * diameter);
                }
                _ => {}
            }
        }
    }
    setup
}

/// Every test of `tests/interp` in a copy of LinuxCNC's repository, whose folder is in `LINUXCNC`, as one that has a program and the
/// canonical commands that `rs274` gives for it:
/// `LINUXCNC=../../linuxcnc cargo test -p touchoff-verify --test gcode every_test -- --nocapture`.
#[test]
fn every_test_of_linuxcnc() {
    let Some(root) = std::env::var_os("LINUXCNC") else {
        println!("LINUXCNC is not set: its tests are not run");
        return;
    };
    let root = std::path::Path::new(&root).join("tests/interp");
    let mut folders = vec![root.clone()];
    let (mut agree, mut listed, mut motions, mut wrong) = (0, 0, 0, Vec::new());
    while let Some(folder) = folders.pop() {
        let mut programs = Vec::new();
        for entry in std::fs::read_dir(&folder).expect("a folder") {
            let path = entry.expect("an entry").path();
            match path.extension() {
                _ if path.is_dir() => folders.push(path),
                Some(ending) if ending == "ngc" => programs.push(path),
                _ => {}
            }
        }
        let expected = folder.join("expected");
        let name = folder.strip_prefix(&root).expect("a folder of the tests").display().to_string();
        if !expected.is_file() || programs.is_empty() {
            continue;
        }
        let mut expected =
            canonical(&String::from_utf8_lossy(&std::fs::read(&expected).expect("a file")));
        expected.retain(|motion| !motion.text.contains("MESSAGE"));
        let mut setup = setup();
        if let Ok(table) = std::fs::read_to_string(folder.join("test.tbl")) {
            setup = with_tools(setup, &table);
        }
        programs.sort();
        let outcome = programs.iter().map(|program| {
            let program =
                String::from_utf8_lossy(&std::fs::read(program).expect("a file")).into_owned();
            agrees(&program, &setup, &expected)
        });
        // A folder has one program with a result, or several with one that all give.
        let outcomes: Vec<Result<usize, String>> = outcome.collect();
        let best = outcomes.iter().find(|outcome| outcome.is_ok()).unwrap_or(&outcomes[0]);
        let known = NOT_READ.iter().find(|(known, _)| *known == name);
        match (best, known) {
            (Ok(count), None) => {
                motions += count;
                agree += 1;
            }
            (Err(reason), Some((_, expected))) if reason.contains(expected) => listed += 1,
            (found, _) => wrong.push(format!("(\"{name}\", {found:?}),")),
        }
    }
    println!("{agree} tests agree in {motions} motions, {listed} are not read");
    wrong.sort();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Returns the number of motions of a program that are the expected ones, or the first difference.
fn agrees(program: &str, setup: &ControlSetup, expected: &[Canonical]) -> Result<usize, String> {
    let (steps, error) = steps_with(program, setup);
    if let Some(error) = error {
        return Err(error.to_string());
    }
    let (mut ours, mut theirs): (Vec<&Step>, Vec<&Canonical>) =
        (steps.iter().collect(), expected.iter().collect());
    // A motion of no length moves nothing, and is left out by one of both.
    if ours.len() != theirs.len() {
        ours.retain(|step| {
            let mut axes = step.commanded.iter().zip(step.start.iter().zip(&step.end));
            matches!(step.path, StepPath::Arc { .. })
                || axes.any(|(commanded, (start, end))| *commanded && start != end)
        });
        let place = |motion: &Canonical| (motion.end, motion.origin, motion.rotation, motion.shift);
        let mut before = place(&Canonical::default());
        theirs.retain(|motion| {
            let is_still = motion.arc.is_none() && place(motion) == before;
            before = place(motion);
            !is_still
        });
    }
    if ours.len() != theirs.len() {
        return Err(format!("{} motions, not {}", ours.len(), theirs.len()));
    }
    for (step, wanted) in ours.into_iter().zip(theirs) {
        let tolerance = 1e-3 * wanted.unit;
        let is_near = (0..6).all(|axis| {
            step.end[axis].is_some_and(|value| (value - wanted.end[axis]).abs() <= tolerance)
        });
        if !is_near || step.rapid != wanted.rapid {
            return Err(format!("another motion in line {}: {}", step.line, wanted.text));
        }
    }
    Ok(steps.len())
}
