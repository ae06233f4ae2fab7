//! The next run of a program, against the same blocks executed twice in one program.

use crate::klartext::{at_zero, program};
use rand_core::{Rng, SeedableRng};
use rand_pcg::Pcg64Mcg;
use std::collections::BTreeMap;
use touchoff_verify::gcode::{ControlRules, ControlSetup, NoteKind, Step, read};

/// Blocks that change what later ones mean, and motions.
const BLOCKS: [&str; 36] = [
    "G20",
    "G21",
    "G17",
    "G18",
    "G90",
    "G91",
    "G90.1",
    "G91.1",
    "G98",
    "G99",
    "G54",
    "G55",
    "G92 X3.",
    "G92.1",
    "G10 L2 P1 X7. Z1.",
    "G10 L2 P2 R30.",
    "G43 H1",
    "G43 H2",
    "G43",
    "G49",
    "M428",
    "M429",
    "T1 M6",
    "T2 M6",
    "G0 X4. Y1. Z9.",
    "G0 Z6.",
    "G0 X2.",
    "G1 Y3. F100.",
    "G2 X4. Y1. I1. J-1. F100.",
    "G81 X1. Y2. Z-1. R3. F100.",
    "G80",
    "G53 G0 Z0.",
    "G28 Z8.",
    "G52 Y2.",
    "G41.1 D1. G1 X30. Y20. Z1. F100.\nX40.\nG40 X50. Y50.",
    "G42.1 D1. G0 X3. Y9. Z8.\nG3 X5. Y7. R30. F100.\nG40",
];

/// Returns a control whose axes begin at the reference position, or where only the machine knows.
fn setup(at_home: bool) -> ControlSetup {
    let start = [-10.0, -20.0, -30.0].map(|coordinate| Some(coordinate).filter(|_| at_home));
    ControlSetup {
        start: [start[0], start[1], start[2], Some(0.0), Some(0.0), Some(0.0)],
        work_offsets: std::array::from_fn(|offset| {
            Some([10.0 + offset as f64, 20.0, 30.0, 0.0, 0.0, 0.0])
        }),
        lengths: BTreeMap::from([(1, 50.0), (2, 80.0)]),
        home: Some([0.0; 6]),
        rules: ControlRules::named("linuxcnc").expect("a control"),
        ..ControlSetup::default()
    }
}

/// Returns the words that a program leaves for its next run, and the line that they change.
fn left_modes(program: &str, setup: &ControlSetup) -> Option<(usize, String)> {
    let (_, notes) = read(program, setup).unwrap_or_else(|error| panic!("{program}: {error}"));
    notes.into_iter().find_map(|note| match note.kind {
        NoteKind::LeftModes { words } => Some((note.line, words)),
        _ => None,
    })
}

/// The same of a program of LinuxCNC, as a sentence.
fn left(program: &str, at_home: bool) -> Option<String> {
    left_modes(program, &setup(at_home)).map(|(line, words)| format!("{line}: {words}"))
}

/// Returns whether the machine moves otherwise, as far as the motion is known.
fn differs(step: &Step, next: &Step) -> bool {
    let tip_or_machine = |step: &Step| match step.state.turns_with_workpiece() {
        true => step.state.to_workpiece(step.end),
        false => step.state.to_machine(step.end),
    };
    let [end, next_end] = [tip_or_machine(step), tip_or_machine(next)];
    let is_other = |(end, next): (Option<f64>, Option<f64>)| match (end, next) {
        (Some(end), Some(next)) => (end - next).abs() > 1e-5,
        _ => false,
    };
    (step.rapid, step.state.tcp) != (next.rapid, next.state.tcp)
        || end.into_iter().zip(next_end).any(is_other)
}

/// All modes stay after `%`, so that the next run is the second half of a program that has the blocks twice.
#[test]
fn the_next_run_is_that_of_the_blocks_written_twice() {
    let mut random = Pcg64Mcg::seed_from_u64(11);
    let (mut read_twice, mut same, mut other, mut noted_alone) = (0, 0, 0, 0);
    let runs = match std::env::var("RUNS") {
        Ok(text) => text.parse().expect("RUNS is a whole number"),
        Err(_) => 5_000,
    };
    while read_twice < runs {
        let count = 3 + random.next_u32() % 8;
        let blocks: Vec<&str> =
            (0..count).map(|_| BLOCKS[random.next_u32() as usize % BLOCKS.len()]).collect();
        let blocks = format!("{}\nG80\nG28\n", blocks.join("\n"));
        let once = format!("%\n{blocks}%\n");
        let Ok((first, _)) = read(&once, &setup(true)) else { continue };
        read_twice += 1;
        let twice = read(&format!("%\n{blocks}{blocks}%\n"), &setup(true));
        let is_other = match &twice {
            Ok((both, _)) => {
                both.len() != 2 * first.len()
                    || first
                        .iter()
                        .zip(&both[first.len()..])
                        .any(|(step, next)| differs(step, next))
            }
            Err(_) => true,
        };
        match (is_other, left(&once, true)) {
            (true, None) if twice.is_ok() => panic!("the next run is another:\n{once}"),
            (true, _) => other += 1,
            (false, None) => same += 1,
            (false, Some(_)) => noted_alone += 1,
        }
    }
    println!(
        "{same} programs do the same in the next run, {other} do not, {noted_alone} are noted alone"
    );
    assert!(same > runs / 20 && other > runs / 20);
}

/// The words are named, at the line of the first block that they change.
#[test]
fn what_is_left_is_named() {
    let motion = "G0 X4. Y1. Z9.";
    for (blocks, expected) in [
        (format!("{motion}\nG20\nM30"), Some("1: G20")),
        (format!("G21\n{motion}\nG20\nM30"), None),
        // LinuxCNC sets these at M30.
        (format!("{motion}\nG91 G18 G55\nM30"), None),
        (format!("%\n{motion}\nG91\nG55\n%"), Some("2: G91, G55")),
        (format!("{motion}\nG92 X0.\nM2"), Some("1: G92")),
        (format!("G43 H1 {motion}\nG10 L2 P1 Z1.\nM30"), Some("1: G10")),
        (format!("{motion}\nT1 M6\nG43 H1\nM30"), Some("1: G43 H1")),
        // Z is stated after the length.
        ("G0 X1. Y1.\nT1 M6\nG43 H1 Z9.\nM30".to_owned(), None),
        ("G28 X0.\nG53 G0 Z0.\nT1 M6\nG43 H1 Z9.\nG91 G28 Z0.\nM30".to_owned(), None),
        (format!("{motion}\nG81 X1. Z-1. R3. F9.\nG98 G81 X2. Z-1. R3.\nG80\nM30"), Some("2: G98")),
        (format!("{motion}\nG2 I1. F9.\nG90.1\nG2 I5. J1.\nM30"), Some("2: G90.1")),
        (format!("{motion}\nG43 H1\nM428\nM30"), Some("1: G43 H1, M428")),
    ] {
        assert_eq!(left(&blocks, false).as_deref(), expected, "{blocks}");
    }
}

/// DL ends with the next TOOL CALL, and so in the next run, if that calls a tool before it moves.
#[test]
fn an_allowance_on_the_length_is_left_for_motions_before_the_first_tool() {
    let left = |body: &str| left_modes(&program(body), &at_zero());
    let end = "L Z+20 R0 FMAX M3\nL X+1 F100\nL Y+2\nL Z+50 FMAX\nM30";
    let first = "TOOL CALL 5 Z S1000\nL Z+10 R0 FMAX M3\nL X+4 F100\nTOOL CALL 5 Z S2000 DL+0.5\n";
    assert_eq!(left(&format!("{first}{end}")), None);
    assert_eq!(left(&format!("TOOL CALL 5 Z S1000 DL-0.5\n{end}")), None);
    // The tool is called after the first motion.
    let before = format!("L Z+100 FMAX\n{first}{end}");
    assert_eq!(left(&before), Some((2, "DL of TOOL CALL".to_owned())));
    // A shift is left also where DL is not.
    let shifted = format!("{first}CYCL DEF 7.0\nCYCL DEF 7.1 X+3\n{end}");
    let (line, found) = left(&shifted).expect("a shift");
    assert_eq!(line, 4);
    assert!(found.contains("CYCL DEF 7"), "{found}");
    assert_eq!(left(&shifted.replace("M30", "CYCL DEF 7.0\nCYCL DEF 7.1 X+0\nM30")), None);
}
