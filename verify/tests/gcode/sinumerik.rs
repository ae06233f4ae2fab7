//! Native programs of Sinumerik: the same motions written in ISO words, closed forms, refusals, mutants, and a long loop.

use super::mutants::{Mutants, Seed, read_mutants};
use super::survey::assert_planted_are_found;
use crate::common;
use crate::common::assert_fault;
use std::collections::BTreeMap;
use touchoff_verify::gcode::{
    Choice, ControlRules, ControlSetup, GcodeError, Interpreter, LengthOffset, NoteKind, Position,
    Rotation, Rule, Spindle, Step, StepPath, SubprogramFile, Tcp, WorkOffset, read,
};

/// A control that stands at 0, with work offsets that differ.
fn setup() -> ControlSetup {
    let mut work_offsets = [Some([0.0; 6]); 9];
    for (number, offset) in work_offsets.iter_mut().enumerate().skip(1) {
        *offset = Some([100.0 * number as f64, 10.0, -5.0, 0.0, 0.0, 0.0]);
    }
    ControlSetup {
        start: [Some(0.0); 6],
        work_offsets,
        lengths: BTreeMap::from([(1, 80.0), (2, 50.0)]),
        tool_names: BTreeMap::from([("DRILL 8.5".to_owned(), 2)]),
        home: [1.0, 2.0, 400.0, 0.0, 0.0, 0.0].map(Some),
        // Endless loops are refused sooner.
        max_repeated: 1_000_000,
        ..ControlSetup::default()
    }
}

fn execute(program: &str) -> Result<Vec<Step>, GcodeError> {
    common::execute(program, &setup())
}

#[track_caller]
fn steps(program: &str) -> Vec<Step> {
    common::steps(program, &setup())
}

/// Executes a program of ISO words as LinuxCNC does.
#[track_caller]
fn iso(program: &str) -> Vec<Step> {
    let rules = ControlRules::default().with(Rule::Dialect, Choice::Rs274Ngc);
    let setup = ControlSetup { rules, ..setup() };
    read(program, &setup).unwrap_or_else(|error| panic!("{program}\n{error}")).0
}

/// All that makes a motion, in machine coordinates, rounded to 1e-9.
fn motion(step: &Step) -> String {
    let [start, end] = [step.start, step.end]
        .map(|position| step.state.to_machine(position).map(|value| value.map(rounded)));
    let path = match step.path {
        StepPath::Arc { plane, centre, sweep } => {
            format!("{plane:?} {:?} {}", centre.map(rounded), rounded(sweep))
        }
        path => format!("{path:?}"),
    };
    format!("{} {start:?} {end:?} {path} {:?}", step.rapid, step.spindle)
}

fn rounded(value: f64) -> f64 {
    // -0 is 0.
    (value * 1e9).round() / 1e9 + 0.0
}

#[track_caller]
fn assert_same(native: &str, other: &str) {
    let [native_steps, other_steps] = [steps(native), iso(other)];
    let [first, second] =
        [&native_steps, &other_steps].map(|steps| steps.iter().map(motion).collect::<Vec<_>>());
    assert_eq!(first, second, "{native}\n{other}");
    assert!(!first.is_empty(), "{native}");
}

#[test]
fn words_and_statements_are_the_motions_of_iso_words() {
    let pairs = [
        ("R1=5\nG0 X=10 Y=2*3 Z=R1", "G0 X10 Y6 Z5"),
        ("R1=1 R2=R1+1\nR[R2+1]=7\nG0 X=R3 Y=-R1", "G0 X7 Y-1"),
        ("G0 X1 Y1\nG1 X=AC(5) Y=IC(2) F100", "G0 X1 Y1\nG1 X5 Y3 F100"),
        ("G0 X1 Y1\nG91 G1 X=AC(5) Y2 Z=IC(-1) F100", "G0 X1 Y1\nG1 X5 Y3 Z-1 F100"),
        ("G17 G2 X10 Y10 CR=10 F100", "G17 G2 X10 Y10 R10 F100"),
        ("G17 G3 X10 Y10 CR=-10 F100", "G17 G3 X10 Y10 R-10 F100"),
        ("G3 X10 Y0 I=AC(5) J=AC(0) F100", "G3 X10 Y0 I5 J0 F100"),
        ("G0 X1 Y2\nG2 X1 Y2 I=AC(5) J=AC(2) F100", "G0 X1 Y2\nG2 X1 Y2 I4 J0 F100"),
        ("G2 X10 Y0 Z-5 I5 J0 TURN=2 F=50*2", "G2 X10 Y0 Z-5 I5 J0 P3 F100"),
        ("G18 G3 X10 Z10 CR=10 F100", "G18 G3 X10 Z10 R10 F100"),
        ("G700\nDEF REAL A_X=1, _B\n_B=2\nG0 X=A_X Y=_B", "G20\nG0 X1 Y2"),
        ("DEF INT KK\nFOR KK=1 TO 3\nG0 X=KK\nENDFOR", "G0 X1\nX2\nX3"),
        ("FOR R5=3 TO 1\nG0 X=R5\nENDFOR\nG0 Y1", "G0 Y1"),
        (
            "R1=0\nWHILE R1<3\nG1 X=R1 Z=-R1 F100\nR1=R1+1\nENDWHILE",
            "G1 X0 Z0 F100\nX1 Z-1\nX2 Z-2",
        ),
        ("R1=0\nREPEAT\nR1=R1+1\nG0 Y=R1\nUNTIL R1>=2", "G0 Y1\nY2"),
        ("R1=0\nLOOP\nR1=R1+1\nIF R1>2 GOTOF OUT\nG0 Y=R1\nENDLOOP\nOUT: G0 X9", "G0 Y1\nY2\nX9"),
        ("R1=0\nAGAIN:\nR1=R1+1\nG0 Y=R1\nIF (R1<2) AND NOT (R1==5) GOTOB AGAIN", "G0 Y1\nY2"),
        (
            "R1=1\nN10 G0 X=R1\nR1=R1+1\nIF R1<=2 GOTOB N10\nGOTO N90\nG0 X77\nN90 G0 Y1",
            "G0 X1\nX2\nY1",
        ),
        ("R1=2\nIF R1==1\nG0 X1\nELSE\nIF R1==2\nG0 X2\nELSE\nG0 X3\nENDIF\nENDIF", "G0 X2"),
        (
            "R1=2\nCASE(R1) OF 1 GOTOF A1_ 2 GOTOF B1_ DEFAULT GOTOF C1_\nA1_: G0 X1\nB1_: G0 X2\nC1_: G0 X3",
            "G0 X2\nX3",
        ),
        ("GOTOC NOWHERE\nG0 X1", "G0 X1"),
        ("R1=0\nBEGIN_: R1=R1+1\nG0 X=R1\nREPEAT BEGIN_ P=2\nG0 Y1", "G0 X1\nX2\nX3\nY1"),
        (
            "R1=0\nP_A: R1=R1+1\nP_B: G0 X=R1\nG0 Y1\nREPEAT P_A P_B P2\nG0 Y2",
            "G0 X1\nY1\nX2\nX3\nY2",
        ),
        ("R1=0\nP_A: R1=R1+1\nONE: G0 X=R1\nR1=9\nREPEATB ONE P=1", "G0 X1\nX9"),
        (
            "CALL BLOCK L_A TO L_END\nCALL BLOCK L_B TO L_END\nGOTOF L_OUT\nL_A:\nG0 X1\nL_END:\nL_B:\nG0 X2\nL_END:\nL_OUT:",
            "G0 X1\nX2",
        ),
        ("G0 C=DC(350)\nC=DC(10)", "G0 C350\nC10"),
        ("G0 X=SIN(30)*10 Y=COS(60)*10 Z=TAN(45)", "G0 X5 Y5 Z1"),
        ("G0 X=SQRT(16)+ABS(-1) Y=POT(3) Z=ATAN2(1,1)", "G0 X5 Y9 Z45"),
        ("G0 X=TRUNC(2.7) Y=ROUND(2.7) Z=7 DIV 2 + 7 MOD 2", "G0 X2 Y3 Z4"),
        ("DEF REAL LIST[3]\nLIST[1]=4 LIST[2]=LIST[1]+1\nG0 X=LIST[0] Y=LIST[2]", "G0 X0 Y5"),
        ("DEF BOOL ON=TRUE\nIF ON\nG0 X1\nENDIF\nIF NOT ON\nG0 X2\nENDIF", "G0 X1"),
        ("DEF STRING[20] NAME=\"A\"\nIF NAME==\"A\"\nG0 X1\nENDIF", "G0 X1"),
        (
            "G0 X1\nMSG(\"G0 X5; no comment\")\nG4 F2\nG4 S30\nSTOPRE\nSOFT G642 ADIS=0.1\nG0 X2",
            "G0 X1\nX2",
        ),
        (
            "WORKPIECE(,,,\"BOX\",64,0,50,-80,0,0,100,100)\nCYCLE832(0.01,_FINISH,1)\nCYCLE832(0.01,13)\nCYCLE832()\nFGROUP(X,Y) G0 X1",
            "G0 X1",
        ),
    ];
    for (native, other) in pairs {
        assert_same(&format!("{native}\nM30\n"), &format!("{other}\nM2\n"));
    }
}

#[test]
fn subprograms_are_executed_where_they_are_called() {
    let programs = [
        "%_N_MAIN_MPF\n;$PATH=/_N_WKS_DIR\nG0 X1\nHOLE P2\nL10\nCALL \"_N_HOLE_SPF\"\nM30\n\
         %_N_HOLE_SPF\nG0 Z1\nG0 Z2\nM17\n%_N_L10_SPF\nG0 Y1\nRET\n",
        "G0 X1\nHOLE P=2\nL10\nHOLE\nM30\nPROC HOLE SBLOF DISPLOF\nG0 Z1\nG0 Z2\nRET\nPROC L10\nG0 Y1\nM17\n",
    ];
    for program in programs {
        assert_same(program, "G0 X1\nZ1\nZ2\nZ1\nZ2\nY1\nZ1\nZ2\nM2\n");
    }
    // Values are copied, and variables belong to their program.
    let program = "DEF REAL D_=7\nAT(2,,D_)\nAT(3,1)\nG0 X=D_\nM30\nPROC AT(REAL A_,REAL B_,REAL C_)\n\
        DEF REAL D_\nG0 X=A_ Y=B_ Z=C_+D_\nRET\n";
    assert_same(program, "G0 X2 Y0 Z7\nX3 Y1 Z0\nX7\nM2\n");
    // The end of a main program of a file with subprograms before it.
    let first = "%_N_SUB_SPF\nG0 X5\nM17\n%_N_TOP_MPF\nSUB\nG0 X6\nM30\n";
    assert_same(first, "G0 X5\nX6\nM2\n");
}

fn rotate(point: [f64; 3], axis: usize, degrees: f64) -> [f64; 3] {
    let (sine, cosine) = degrees.to_radians().sin_cos();
    let (first, second) = ((axis + 1) % 3, (axis + 2) % 3);
    let mut turned = point;
    turned[first] = cosine * point[first] - sine * point[second];
    turned[second] = sine * point[first] + cosine * point[second];
    turned
}

fn moved(point: [f64; 3], by: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|k| point[k] + by[k])
}

#[track_caller]
fn assert_at(position: Position, expected: [f64; 3], program: &str) {
    for axis in 0..3 {
        let value = position[axis].unwrap_or_else(|| panic!("{position:?} is unknown\n{program}"));
        assert!(
            (value - expected[axis]).abs() < 1e-9,
            "{position:?} is not {expected:?}\n{program}"
        );
    }
}

/// Positions in frames against points that the test shifts and turns one by one, the last statement first.
#[test]
fn frames_shift_and_turn_positions() {
    let point = [3.0, -2.0, 1.5];
    let cases: [(&str, [f64; 3]); 9] = [
        ("TRANS X10 Y=5+1 Z-2", moved(point, [10.0, 6.0, -2.0])),
        ("TRANS X10\nATRANS X1 Z3", moved(point, [11.0, 0.0, 3.0])),
        ("TRANS X10\nTRANS Y5", moved(point, [0.0, 5.0, 0.0])),
        ("ROT RPL=30", rotate(point, 2, 30.0)),
        ("TRANS X10 Y20\nAROT Z=-50", moved(rotate(point, 2, -50.0), [10.0, 20.0, 0.0])),
        ("ROT Z90\nATRANS X10", rotate(moved(point, [10.0, 0.0, 0.0]), 2, 90.0)),
        ("TRANS X10\nROT RPL=30", rotate(point, 2, 30.0)),
        ("ROT RPL=30\nTRANS", point),
        ("TRANS X1\nAROT RPL=30\nROT", point),
    ];
    for (frame, expected) in cases {
        let program = format!("G54\n{frame}\nG0 X3 Y-2 Z1.5\nM30\n");
        let all = steps(&program);
        let step = all.last().expect("a motion");
        assert_at(step.state.to_machine(step.end), expected, &program);
    }
    // The machine stands still at a frame: the axes that are not programmed keep their place.
    let all = steps("G0 X1 Y2 Z3\nTRANS X10 Y10\nG0 X0\nM30\n");
    assert_at(all[1].state.to_machine(all[1].end), [10.0, 2.0, 3.0], "");
    // RPY angles under TRAORI: about Z, the new Y, the new X, so that a point is turned about X first.
    let program = "T1 M6\nTRAORI\nG54\nROT X20 Y30 Z40\nG0 X3 Y-2 Z1.5\nM30\n";
    let step = steps(program).pop().expect("a motion");
    let expected = rotate(rotate(rotate(point, 0, 20.0), 1, 30.0), 2, 40.0);
    assert_at(step.state.to_workpiece(step.end), expected, program);
}

/// Planes of CYCLE800 against points that the test turns about each axis, with the sequence of axes that each mode has.
#[test]
fn cycle800_tilts_the_plane_axis_by_axis() {
    let point = [3.0, -2.0, 1.5];
    for (mode, axes) in [
        (57, [0, 1, 2]),
        (39, [2, 0, 1]),
        (54, [1, 0, 2]),
        (27, [2, 1, 0]),
        (45, [0, 2, 1]),
        (30, [1, 2, 0]),
    ] {
        let program = format!(
            "T1 M6\nG54\nCYCLE800(0,\"TC1\",200000,{mode},10,20,30,11,-22,33,1,2,3,-1,,1)\nG0 X3 Y-2 Z1.5\nM30\n"
        );
        let all = steps(&program);
        let [align, last] = &all[all.len() - 2..] else { panic!("{program}") };
        assert_eq!(align.path, StepPath::Align);
        assert_eq!(align.end[3..], [None; 3]);
        let mut expected = moved(point, [1.0, 2.0, 3.0]);
        for (axis, angle) in axes.into_iter().zip([11.0, -22.0, 33.0]).rev() {
            expected = rotate(expected, axis, angle);
        }
        expected = moved(expected, [10.0, 20.0, 30.0]);
        assert!(matches!(last.state.rotation, Rotation::Tilted { aligned: true, .. }));
        assert_at(last.state.to_workpiece(last.end), expected, &program);
    }
    // An additional plane is in the coordinates of the one before, and a programmable frame in those of the plane.
    let program = "T1 M6\nG54\nCYCLE800(0,\"\",0,57,0,0,0,0,30,0,0,0,0,1,,1)\nCYCLE800(0,\"\",1,57,5,0,0,20,0,0,0,0,0,1,,1)\n\
        TRANS X7\nAROT Z10\nG0 X3 Y-2 Z1.5\nM30\n";
    let step = steps(program).pop().expect("a motion");
    let inner = moved(rotate(point, 2, 10.0), [7.0, 0.0, 0.0]);
    let expected = rotate(moved(rotate(inner, 0, 20.0), [5.0, 0.0, 0.0]), 1, 30.0);
    assert_at(step.state.to_workpiece(step.end), expected, program);
    // A plane that is ended leaves the axes as they are, and the state without one.
    for end in ["CYCLE800()", "CYCLE800(0,\"0\",200000,57,0,0,0,0,0,0,0,0,0,1,,1)"] {
        let program = format!(
            "T1 M6\nG54\nCYCLE800(0,\"\",0,57,0,0,0,0,30,0,0,0,0,1,,1)\n{end}\nG0 X3 Y-2 Z1.5\nM30\n"
        );
        let all = steps(&program);
        assert_eq!(all.iter().filter(|step| step.path == StepPath::Align).count(), 1);
        assert_eq!(all.last().map(|step| step.state.rotation), Some(Rotation::Off));
    }
    // Retracts: Z of the machine to its home, then X and Y, or along the tool.
    let all = steps("CYCLE800(2,\"\",0,57,0,0,0,0,30,0,0,0,0,0,,1)\nM30\n");
    let ends = all.iter().map(|step| step.state.to_machine(step.end));
    let ends: Vec<_> = ends.map(|end| [end[0], end[1], end[2]]).collect();
    assert_eq!(ends, [[Some(0.0), Some(0.0), Some(400.0)], [Some(1.0), Some(2.0), Some(400.0)]]);
    let all = steps("CYCLE800(5,\"\",0,57,0,0,0,0,30,0,0,0,0,0,25,1)\nM30\n");
    assert_eq!(all[0].end[2], Some(25.0));
    assert!(all[0].rapid && !all[0].is_homeward);
    let all = steps("CYCLE800(4,\"\",0,57,0,0,0,0,30,0,0,0,0,0,,1)\nM30\n");
    assert_eq!((all[0].end[0], all[0].end[2], all[0].commanded[2]), (Some(0.0), None, true));
}

/// The height of each motion, with `r` for rapid traverse.
fn heights(steps: &[Step]) -> Vec<String> {
    let height = |step: &Step| {
        let [x, y, z] = [0, 1, 2].map(|k| step.end[k].expect("a coordinate"));
        format!("{}{x},{y},{z}", if step.rapid { "r" } else { "" })
    };
    steps.iter().map(height).collect()
}

#[test]
fn drilling_cycles_move_to_their_levels() {
    let position = "G90 G0 X5 Y6 Z50 F100\n";
    let out_rapid = ["r5,6,50", "r5,6,3", "5,6,-10", "r5,6,20"];
    let out_feed = ["r5,6,50", "r5,6,3", "5,6,-10", "5,6,3", "r5,6,20"];
    let cases: [(&str, &[&str]); 13] = [
        ("CYCLE81(20,0,3,-10)", &out_rapid),
        ("CYCLE81(20,0,3,,10)", &out_rapid),
        ("CYCLE81(20,1,2,,11,0,0,1,11)", &out_rapid),
        ("CYCLE81(20,1,2,-10,,0,0,1,12)", &out_rapid),
        ("CYCLE82(20,0,3,-10,0,0.5)", &out_rapid),
        ("CYCLE83(20,0,3,-10,,-3,,2,0,0,1,0)", &out_rapid),
        ("CYCLE83(20,0,3,,10,,4,100,0,0.5,100,1,0,1.2,1.4,0,1.6,0,1,11211111)", &out_rapid),
        ("CYCLE86(20,0,3,-10,,0,3,0,0,0,0)", &out_rapid),
        ("CYCLE85(20,0,3,-10,,0,100,200)", &out_feed),
        ("CYCLE89(20,0,3,-10,,0)", &out_feed),
        ("CYCLE84(20,0,3,-10,,0,3,,1.5,0,500,500)", &out_feed),
        ("CYCLE840(20,0,3,-10,,0,0,5,1,,1.5)", &out_feed),
        // Increments in force do not matter.
        ("G91\nCYCLE81(20,0,3,-10)\nG90", &out_rapid),
    ];
    for (cycle, expected) in cases {
        let program = format!("{position}{cycle}\nM30\n");
        assert_eq!(heights(&steps(&program)), expected, "{program}");
    }
    // Tapping needs no feed of the program where it has a pitch, and turns the spindle itself.
    let tapped =
        steps("G0 X5 Y6 Z50\nCYCLE84(20,0,3,-10,,0,3,,1.5,0,500,500)\nS500\nG1 Z19 F100\nM30\n");
    assert_eq!(tapped[2].spindle, Spindle::RightTap);
    assert_eq!(tapped[5].spindle, Spindle::Clockwise);
    // The sign of a pitch is the hand of the thread, but that of CYCLE840 is the turn of the spindle.
    for (cycle, hand) in [
        ("CYCLE84(20,0,3,-10,,0,3,,-1.5,0,500,500)", Spindle::LeftTap),
        ("CYCLE84(20,0,3,-10,,0,3,-8,,0,500,500)", Spindle::LeftTap),
        ("CYCLE840(20,0,3,-10,,0,0,5,1,,1.5)", Spindle::LeftTap),
        ("M5\nCYCLE840(20,0,3,-10,,0,0,5,1,,1.5)", Spindle::Stopped),
    ] {
        let tapped = steps(&format!("S500 M4\nG0 X5 Y6 Z50\n{cycle}\nM30\n"));
        assert_eq!(tapped[2].spindle, hand, "{cycle}");
    }
    // Each motion calls a modal cycle, at its end.
    let modal = "G0 X1 Y1 Z50 F100\nMCALL CYCLE81(20,0,3,-10)\nX2\nM8\nY2\nMCALL\nX3\nM30\n";
    let expected = [
        "r1,1,50", "r2,1,50", "r2,1,3", "2,1,-10", "r2,1,20", "r2,2,20", "r2,2,3", "2,2,-10",
        "r2,2,20", "r3,2,20",
    ];
    assert_eq!(heights(&steps(modal)), expected);
    // So does a full circle by its centre.
    let circle = "G0 X1 Y1 Z50 F100\nMCALL CYCLE81(20,0,3,-10)\nG3 I9 J0\nMCALL\nG0 X3\nM30\n";
    assert_eq!(heights(&steps(circle))[3], "1,1,-10");
}

#[test]
fn tools_offsets_and_machine_coordinates() {
    // SUPA without a length is the spindle's gauge point.
    let program = "G90 G17 G710\nSUPA G0 Z=400 D0\nT=\"1\"\nM6\nG55 G0 X1 Y2 Z3 D1\nSUPA G0 Z300 D0\nT=\"drill 8.5\" D1 M6\nG505\n\
        G0 X1 Y2 Z3\nG500\nG0 X1 Y2 Z3\nM30\n";
    let all = steps(program);
    let machine: Vec<_> = all.iter().map(|step| step.state.to_machine(step.end)).collect();
    let at = |index: usize| [0, 1, 2].map(|k| machine[index][k]);
    assert_eq!(at(0), [Some(0.0), Some(0.0), Some(400.0)]);
    assert_eq!(at(1), [Some(101.0), Some(12.0), Some(78.0)]);
    assert_eq!(at(2), [Some(101.0), Some(12.0), Some(300.0)]);
    assert_eq!(all[1].state.length, LengthOffset::On { register: 1, length: Some(80.0) });
    assert_eq!(all[2].state.length, LengthOffset::Off);
    assert_eq!((all[3].state.work_offset, all[3].state.tool), (WorkOffset::Standard(5), Some(2)));
    assert_eq!(at(3), [Some(401.0), Some(12.0), Some(48.0)]);
    assert_eq!(all[4].state.work_offset, WorkOffset::Off);
    assert_eq!(at(4), [Some(1.0), Some(2.0), Some(53.0)]);
    let all = steps("G599\nG0 A1\nM30\n");
    assert_eq!(all[0].state.work_offset, WorkOffset::Additional(93));
}

#[test]
fn tool_vectors_under_traori_are_in_program_coordinates() {
    let program = "T1 M6\nG54\nG0 X0 Y0 Z50 A0 B0 C0\nTRAORI\nG54\nORIWKS ORIAXES\nG1 X1 A3=0 B3=3 C3=4 F100\nX2\n\
        AROT Z90\nX3 Y0 A3=0 B3=3 C3=4\nTRANS\nX1 Y1 A0 C0\nTRAFOOF\nG54\nM30\n";
    let all = steps(program);
    let vectors: Vec<_> = all.iter().map(|step| step.tool_vector).collect();
    let near = |found: Option<[f64; 3]>, expected: [f64; 3]| {
        let found = found.expect("a vector");
        assert!((0..3).all(|k| (found[k] - expected[k]).abs() < 1e-12), "{found:?}");
    };
    assert_eq!(vectors[0], None);
    near(vectors[1], [0.0, 0.6, 0.8]);
    near(vectors[2], [0.0, 0.6, 0.8]);
    near(vectors[3], [-0.6, 0.0, 0.8]);
    assert_eq!(vectors[4], None);
    assert_eq!((all[1].end[3], all[1].commanded[3]), (None, true));
    assert_eq!((all[1].state.tcp, all[1].state.orientation), (Tcp::Transformation, None));
    // The machine decides which of both counts, so that they have to agree.
    for (words, orientation) in [
        ("ORIAXES", None),
        ("ORIMKS ORIAXES", Some(Choice::ByAxes)),
        ("ORIWKS ORIPLANE", Some(Choice::GreatCircle)),
    ] {
        let all = steps(&program.replace("ORIWKS ORIAXES", words).replace("A3=0 B3=3 C3=4", "B1"));
        assert_eq!(all[1].state.orientation, orientation, "{words}");
    }
}

#[test]
fn other_programs_are_read_as_before() {
    // A statement of Sinumerik in a comment, or its name in another language, makes no native program.
    for program in ["G0 X1 (TRANS X=5)\nM30\n", "#1=5\nG0 X#1\nM30\n", "G0 X1 ; X=5\nM30\n"] {
        assert_eq!(steps(program).len(), 1, "{program}");
        let setup = setup();
        let interpreter = Interpreter::new(program, &setup).expect("a program");
        assert!(!interpreter.asked().contains_key(&Rule::Dialect));
    }
    let native = ControlRules::default().with(Rule::Dialect, Choice::Sinumerik);
    let plain = "G17 G71 G90 (A COMMENT)\nT1 D1 M6\nG54 G0 X1 Y2 Z3\nG1 X5 F100\nM30\n";
    let found = read(plain, &ControlSetup { rules: native.clone(), ..setup() }).expect("a program");
    assert_eq!(found.0.len(), 2);
    // The dialect of another control keeps its front end.
    let linuxcnc = ControlRules::default().with(Rule::Dialect, Choice::Rs274Ngc);
    let refused = read("G0 X=5\nM2\n", &ControlSetup { rules: linuxcnc, ..setup() });
    assert!(refused.is_err());
    // Words that are passed over are listed.
    let (_, notes) = read("MSG(\"A\")\nSOFT\nG642\nG0 X=1\nM30\n", &setup()).expect("a program");
    for word in ["MSG", "SOFT", "G642"] {
        let kind = NoteKind::PassedOver { word: word.to_owned() };
        assert!(notes.iter().any(|note| note.kind == kind), "{word} in {notes:?}");
    }
}

#[test]
fn what_is_outside_is_refused_by_name_with_its_line() {
    let cases = [
        ("R1=1\nG0 X=R2", 2, "P0210 R2"),
        (
            "G0 X=$AA_IW[X]",
            1,
            "P0115 $AA_IW is a variable of the control, whose value only the machine knows",
        ),
        ("R1=1\nQ_X=5", 2, "P0115 `Q_X`"),
        ("G0 X1=5", 1, "P0115 X1="),
        ("G0 C=ACP(5)", 1, "P0115 ACP"),
        ("G0 X=DC(5)", 1, "P0115 DC"),
        ("G2 X10 C=DC(5) CR=10 F100", 1, "P0120 DC"),
        ("R1=1\nMIRROR X0", 2, "P0115 MIRROR"),
        ("R1=1\nSCALE X2", 2, "P0115 SCALE"),
        ("R1=1\nPOCKET4(10,0,2)", 2, "P0115 POCKET4"),
        ("R1=1\nHOLES1(0,0,0,10,10,3)", 2, "P0115 HOLES1"),
        ("EXTCALL(\"A\")", 1, "P0115 `A`"),
        ("R1=1\nCIP X1 Y1 I1=2 J1=3", 2, "P0115 CIP"),
        ("G54 G1 X1 RND=2 F100\nG0 Y1", 2, "P0115 RND"),
        ("G54 G1 X9 RND=2 CHF=1 F100\nY1", 1, "P0120 CHF"),
        ("R1=1\nG41 X5", 2, "P0119 G41"),
        ("R1=1\nG43 H1", 2, "P0115 G43"),
        ("R1=1\nG58 X1", 2, "P0115 G58"),
        ("R1=1\nG77", 2, "P0114 G77"),
        ("R1=1\nM77", 2, "P0114 M77"),
        ("R1=1\nT=\"FACEMILL 63\"", 2, "P0115 a tool by a name that the job does not state"),
        ("R1=1\nUNKNOWN_SUB", 2, "P0115 `UNKNOWN_SUB`"),
        ("R1=1\nL77", 2, "P0115 `L77`"),
        ("CALL \"SUB\"\nR1=1", 1, "P0115 no subprogram of this file"),
        ("R1=1\nMCALL POCKET4(1)", 2, "P0115 a modal call of another program"),
        ("R1=1\nGOTOF NOWHERE", 2, "P0111 `NOWHERE`"),
        ("HERE:\nGOTOF HERE", 2, "P0111 `HERE`"),
        ("R1=1\nWHILE R1<5\nR1=2", 2, "P0141 WHILE"),
        ("R1=1\nENDIF", 2, "P0141 ENDIF"),
        ("R1=1\nIF R1>0 AND R1<5 GOTOF A_\nA_:", 2, "P0120 AND"),
        ("R1=0.1+0.2\nIF R1==0.3 GOTOF A_\nA_:", 2, "P0120 differ by rounding alone"),
        ("R1=1\nR1=R1/0", 2, "P0216 `/`"),
        ("R1=SQRT(-1)", 1, "P0216 `SQRT`"),
        ("R1=(1", 1, "P0217 `)`"),
        ("R1=\"A", 1, "P0218"),
        ("R1=\"A\"", 1, "P0219 a text stands where a number is needed"),
        ("R1=1 G0 X5", 1, "P0120 an assignment while its block has addresses"),
        ("R1=3\nFOR R2=1 TO R1\nR1=R1-1\nENDFOR", 2, "P0120 its last value changes"),
        ("R1=1\nLOOP\nENDLOOP", 3, "P0144 1000000 blocks"),
        ("R1=1\nG0 TRANS X5", 2, "P0115 no word that is read"),
        ("TRANS X5 F100", 1, "P0120 TRANS"),
        ("TRANS X5\nTRAORI", 2, "P0120 TRAORI"),
        ("T1 M6\nROT X30\nG0 X1 Y1 Z1", 3, "P0120 a length offset is in force in a tilted plane"),
        ("CYCLE800(1,\"\",0,192,0,0,0,10,0,0,0,0,0,1)", 1, "P0115 a plane by solid angles"),
        ("CYCLE800(1,\"\",10,57,0,0,0,10,0,0,0,0,0,1)", 1, "P0120 keeps its place"),
        ("CYCLE81(20,0,3)", 1, "P0119 CYCLE81"),
        ("G0 Z50\nCYCLE81(20,0,3,-10)", 2, "P0122 CYCLE81"),
        ("F100\nCYCLE81(20,0,3,-10,5)", 2, "P0120 its two depths differ"),
        ("F100\nCYCLE81(20,0,3,10)", 2, "P0123"),
        ("F100\nCYCLE86(20,0,3,-10,,0,3,1,0,0,0)", 2, "P0115 argument 8 of CYCLE86"),
        ("F100\nG18\nCYCLE81(20,0,3,-10)", 3, "P0120 G18"),
        ("R1=1\nG291", 2, "P0115 G291"),
        ("R1=1\nG0 A3=1", 2, "P0120 TRAORI"),
        ("T1 M6\nTRAORI\nG54\nORIMKS\nG0 X1 A3=1", 5, "P0120 ORIMKS"),
        ("T1 M6\nTRAORI\nG54\nG0 X1 A2=1", 4, "P0115 A2="),
        ("G0 A=IC(5)", 1, "P0120 AC"),
        ("G2 X10 Y0 I=AC(5) J0 F100", 1, "P0120 the other coordinate of its centre is no AC"),
        ("R1=1\n(A COMMENT)", 2, "P0101"),
        ("SELF\nM30\n%_N_SELF_SPF\nSELF\nM17", 4, "P0139"),
        ("G0 X=1\nPROC A_(VAR REAL B_)\nRET\n%_N_Z_MPF", 1, "P0115"),
        ("F100\nCYCLE81(20,0,3,-10,,0,0,1,12,5)", 2, "P0115 argument 10 of CYCLE81"),
        ("F100\nMCALL CYCLE81(20,0,3,-10)\nC90", 3, "P0120 a rotary axis"),
        ("T1 M6\nTRAORI\nG54\nF100\nG0 X1 A3=0 C3=1\nCYCLE832(0.1,112103)", 6, "P0115 CYCLE832"),
        ("R1=5\nCYCLE832(0.1,R1)", 2, "P0115 CYCLE832"),
        ("G1 X9 RND=2 F100\nCYCLE81(20,0,3,-10)\nY9", 2, "P0119 RND"),
        ("F100\nMCALL CYCLE81(20,0,3,-10)\nG1 X9 RND=2\nMCALL\nY9", 3, "P0119 RND"),
        ("G1 X9 CHR=2 F100\nCYCLE800(1)\nY9", 2, "P0119 CHR"),
        ("G1 X9 CHF=2 F100\nTRANS X5\nY9", 2, "P0119 CHF"),
        ("G0 X=1", 1, "P0138"),
    ];
    for (program, line, words) in cases {
        // The last two are not ended by M30.
        let text = match (words, program.contains("PROC A_")) {
            ("P0138", _) => format!("{program}\n"),
            (_, true) => format!("{}\nM30\n", program.replace("G0 X=1", "A_(1)")),
            _ => format!("{program}\nM30\n"),
        };
        let error = match execute(&text) {
            Ok(steps) => panic!("{text} is read, with {} motions", steps.len()),
            Err(error) => error,
        };
        assert_fault(&text, &error, line, words);
    }
}

const SEEDS: [&str; 3] = [
    "%_N_PLATE_MPF\n;$PATH=/_N_WKS_DIR\nN10 G17 G90 G710 G40 FNORM\nN20 DEF REAL DEPTH=-5, STEPS[3]\nN30 SUPA G0 Z=400 D0\n\
     N40 T=\"1\" M6\nN50 G54 D1 S3000 M3\nN60 G0 X=10 Y=R1A Z50\nR1=0\nWHILE (R1<3) AND (DEPTH<>0)\nSTEPS[R1]=R1*DEPTH\n\
     G1 X=R1*10 Z=STEPS[R1] F=200\nR1=R1+1\nENDWHILE\nFOR R2=1 TO 3\nIF R2==2\nG2 X=IC(10) Y=AC(5) CR=20\nELSE\nG0 Z10\nENDIF\n\
     ENDFOR\nHOLE(5,DEPTH)\nMCALL CYCLE83(20,0,3,DEPTH,,,2,1,0,0,1,1)\nX20 Y20\nX30\nMCALL\nAGAIN: X40\nR1=R1-1\n\
     IF R1>0 GOTOB AGAIN\nREPEAT AGAIN P=1\nCASE(R2) OF 1 GOTOF EINS 4 GOTOF ZWEI DEFAULT GOTOF EINS\nEINS: G0 Y1\nZWEI: G0 Y2\n\
     M30\n%_N_HOLE_SPF\nPROC HOLE(REAL X_, REAL Z_)\nG0 X=X_\nG1 Z=Z_ F100\nG0 Z10\nRET\n",
    "T1 D1 M6\nG54\nS1000 M3\nCYCLE800(1,\"TC1\",200000,57,10,0,0,0,30,0,0,0,0,-1,100,1)\nG0 X1 Y1 Z50\nG1 Z-1 F100\nTRANS X5\n\
     AROT RPL=30\nG1 X5 Y5\nTRANS\nG0 Z50\nCYCLE800(4,\"TC1\",200001,39,0,0,0,45,10,0,0,0,0,1,,1)\nX1 Y1 Z60\nCYCLE800()\nM30\n",
    "N1 T2 M6\nG54 G0 X0 Y0 Z100 A0 B0 C0 S900 M3\nTRAORI\nG54\nORIWKS ORIAXES G642 CYCLE832(0.01,1,1)\nG1 X1 Y2 Z3 A3=0.1 B3=0.2 C3=1 F500\n\
     X2 Y3 A3=0 B3=0 C3=1\nG3 X8 Y3 I=AC(5) J=AC(1.5)\nG1 X12 A5 C10\nTRAFOOF\nG54\nR1=ROUND(2.5)+ABS(-1)*(3-1)/2\nG0 Z=R1*10\n\
     LOOP\nR1=R1-1\nIF R1<0 GOTOF OUT\nENDLOOP\nOUT:\nL1 P2\nM30\nPROC L1\nG91 G0 X1\nG90\nM17\n",
];

/// Pieces that mutations insert.
const PIECES: [&str; 36] = [
    "G0",
    "G1",
    "G91",
    "TRANS X1",
    "ROT X30",
    "AROT RPL=10",
    "CYCLE800()",
    "MCALL CYCLE81(20,0,3,-5)",
    "MCALL",
    "R1=",
    "R[R1]=",
    "IF R1>2",
    "ENDIF",
    "ELSE",
    "WHILE TRUE",
    "ENDWHILE",
    "FOR R1=1 TO 9",
    "ENDFOR",
    "GOTOB",
    "GOTOF OUT",
    "REPEAT",
    "UNTIL",
    "M17",
    "M30",
    "L1 P9999",
    "HOLE",
    "PROC A",
    "(",
    ")",
    "\"",
    "=",
    ",",
    "999999999",
    "A3=1",
    "\n",
    "\u{e9}",
];

#[test]
fn mutants_end_with_steps_or_with_a_line() {
    let seeds = SEEDS.map(|seed| seed.replace("R1A", "2"));
    for seed in &seeds {
        assert!(steps(seed).len() > 5, "{seed}");
    }
    let setups = [ControlSetup { max_repeated: 10_000, ..setup() }];
    let seeds = seeds.each_ref().map(|text| Seed { text, setups: &setups });
    assert_planted_are_found(&seeds, ["M777", "WAITM(1)", "X=R99"]);
    read_mutants(&Mutants {
        name: "sinumerik",
        seeds: &seeds,
        pieces: &PIECES,
        default_count: 1_500,
    });
}

/// A survey comes out of calls that are too deep, with the variables of the main program alone.
#[test]
fn a_survey_leaves_calls_that_are_too_deep() {
    let text = "DEF REAL AA=1\nSUB1\nG1 X=AA F100\nM30\nPROC SUB1\nDEF REAL BB=2\nDEF REAL CC=BB\nM777\nSUB2\nX=DD\nX=CC\nM17\nPROC SUB2\n\
                DEF REAL DD=3\nSUB1\nX=CC\nX=DD\nSUB2\nM17\n";
    for ends in ["M17", "M30", "WAITM(1)"] {
        let text = text.replace("X=DD\nSUB2", &format!("X=DD\n{ends}\nSUB2"));
        let setup = setup();
        let mut interpreter = Interpreter::new(&text, &setup).expect("a program");
        assert!(interpreter.by_ref().any(|step| step.is_err()));
        // Without a panic, and not without end.
        assert!(interpreter.survey().count() < 1_000, "{text}");
    }
}

/// A loop has the steps of its text written out.
#[test]
fn a_loop_of_a_hundred_thousand_blocks_moves_as_text() {
    let looped = "R1=0\nWHILE R1<100000\nG1 X=R1*0.001 Y=-R1*0.001 F100\nR1=R1+1\nENDWHILE\nM30\n";
    let mut written = String::from("R1=0\n");
    for index in 0..100_000 {
        let value = f64::from(index) * 0.001;
        written.push_str(&format!("G1 X{value:.3} Y-{value:.3} F100\n"));
    }
    written.push_str("M30\n");
    let [looped, written] = [looped, written.as_str()].map(steps);
    assert_eq!((looped.len(), written.len()), (100_000, 100_000));
    for (one, other) in looped.iter().zip(&written) {
        let is_near = |axis: usize| {
            let ends = one.end[axis].zip(other.end[axis]);
            ends.is_some_and(|(one, other)| (one - other).abs() < 1e-9)
        };
        assert!((0..2).all(is_near), "{one:?} {other:?}");
    }
}

/// Programs of a file and variables are found by their names in a time that does not grow with their number. Names of a subprogram are its own.
#[test]
fn many_programs_and_variables_are_found_by_name() {
    let count = 100_000;
    let text = |line: &dyn Fn(usize) -> String| (0..count).map(line).collect::<String>();
    let program = [
        text(&|k| format!("DEF REAL LEVEL{k}={k}\n")),
        text(&|k| format!("level{k}=LEVEL{k}+1\n")),
        "G0 X=LEVEL0 Y=LEVEL99999\n".to_owned(),
        text(&|k| format!("HOLE{k}\n")),
        "G0 X=LEVEL1\nM30\n".to_owned(),
        text(&|k| format!("PROC HOLE{k}\nDEF REAL LEVEL1={k}\nG0 X=LEVEL1\nRET\n")),
    ];
    let found = execute(&program.concat()).unwrap_or_else(|error| panic!("{error}"));
    let ends: Vec<_> = found.iter().map(|step| step.end).collect();
    assert_eq!(ends.len(), count + 2);
    assert_eq!((ends[0][0], ends[0][1]), (Some(1.0), Some(100_000.0)));
    assert_eq!((ends[count][0], ends[count + 1][0]), (Some(99_999.0), Some(2.0)));
    let twice = "HOLE1\nM30\nPROC HOLE1\nRET\nPROC hole1\nRET\n";
    let error = execute(twice).expect_err("two programs of one name");
    assert_fault(twice, &error, 5, "P0127 hole1");
}

/// The corners of a square and of a triangle whose lines meet at 60 degrees, at points that are worked out by hand.
#[test]
fn corners_are_rounded_or_chamfered() {
    let found =
        steps("G54 G0 X0 Y0\nG1 X40 RND=5 F100\nY30 CHR=2\nR1=SQRT(8)\nX0 CHF=R1\nY10\nM30\n");
    let ends: Vec<[f64; 2]> =
        found.iter().map(|step| [0, 1].map(|axis| step.end[axis].expect("a coordinate"))).collect();
    let expected = [
        [0.0, 0.0],
        [35.0, 0.0],
        [40.0, 5.0],
        [40.0, 28.0],
        [38.0, 30.0],
        [2.0, 30.0],
        [0.0, 28.0],
        [0.0, 10.0],
    ];
    assert_eq!(ends.len(), expected.len(), "{ends:?}");
    for (end, expected) in ends.iter().zip(expected) {
        assert!((0..2).all(|k| (end[k] - expected[k]).abs() < 1e-12), "{ends:?}");
    }
    let StepPath::Arc { centre, sweep, .. } = found[2].path else { panic!("{:?}", found[2]) };
    assert!((centre[0] - 35.0).abs() < 1e-12 && (centre[1] - 5.0).abs() < 1e-12, "{centre:?}");
    assert!((sweep - std::f64::consts::FRAC_PI_2).abs() < 1e-12, "{sweep}");
    // A chamfer of 4 across the corner of an equilateral triangle takes 4 of both lines.
    let apex = 20.0 * 3.0f64.sqrt();
    let found = steps(&format!("G54 G0 X0 Y0\nG1 X40 CHF=4 F100\nX20 Y{apex:.12}\nM30\n"));
    let end = found[2].end;
    let expected = [40.0 - 4.0 * 0.5, 4.0 * 0.75f64.sqrt()];
    assert!((0..2).all(|k| (end[k].expect("a coordinate") - expected[k]).abs() < 1e-11), "{end:?}");
}

/// A line can have several conditions, of which the first that holds decides.
#[test]
fn conditions_of_one_line_are_tried_in_turn() {
    for (value, expected) in [("1", &[2.0, 3.0][..]), ("2", &[3.0]), ("3", &[1.0, 2.0, 3.0])] {
        let text = format!(
            "DEF REAL AA={value}\nG0 Y5\nIF AA==1 GOTOF A1 IF AA==2 GOTOF B1\nX1\nA1: X2\nB1: X3\nM30\n"
        );
        let found: Vec<f64> = steps(&text).iter().skip(1).filter_map(|step| step.end[0]).collect();
        assert_eq!(found, expected, "{text}");
    }
    let rest = "DEF REAL AA=3\nIF AA==1 GOTOF A1 FOOBAR %%%\nA1: X2\nM30\n";
    assert!(execute(rest).is_err());
}

/// What the machine or its builder decides, or a folder of the control, is not guessed.
#[test]
fn what_depends_on_the_machine_is_refused() {
    for (text, line, pattern) in [
        ("DEF REAL AA=1\nG0 X1\nGOTOS\nM30\n", 3, "P0115 GOTOS"),
        ("DEF REAL AA=ROUNDUP(-0.5)\nM30\n", 1, "P0120 ROUNDUP"),
        ("T1 D1\nG0 X5\nMCALL CYCLE81(10,0,2,-5)\nF200\nM30\n", 4, "P0120 F, S"),
        ("T1 D1\nG0 X5\nMCALL CYCLE81(10,0,2,-5)\nG1\nM30\n", 4, "P0120 F, S"),
    ] {
        let error = execute(text).expect_err(text);
        assert_fault(text, &error, line, pattern);
    }
}

/// A program of the user is found before a cycle of its name, and one that two files have is refused.
#[test]
fn programs_of_the_user_come_before_cycles() {
    let file = |name: &str, text: &str| SubprogramFile { name: name.to_owned(), text: text.into() };
    let own = file("CYCLE81.SPF", "PROC CYCLE81(REAL AA,REAL BB,REAL CC,REAL DD)\nX7\nM17\n");
    let text = "DEF REAL AA=1\nG0 X5\nCYCLE81(10,0,2,-5)\nM30\n";
    let setup = ControlSetup { subprograms: vec![own], ..setup() };
    let found = common::steps(text, &setup);
    assert_eq!(found.last().and_then(|step| step.end[0]), Some(7.0));
    let modal = text.replace("CYCLE81", "MCALL CYCLE81");
    assert!(common::execute(&modal, &setup).is_err());
    let both =
        vec![file("SUBX.SPF", "X1\nM17\nPROC SUBY\nX2\nM17\n"), file("SUBY.SPF", "X3\nM17\n")];
    let setup = ControlSetup { subprograms: both, ..setup };
    let text = "DEF REAL AA=1\nG0 X5\nSUBY\nM30\n";
    assert_fault(text, &common::execute(text, &setup).expect_err("two"), 3, "P0143 SUBY");
}

/// A name of a program or a label that is a variable's stands for its text.
#[test]
fn names_that_are_computed_are_refused() {
    for call in ["CALL SUBA", "CALL BLOCK SUBA TO FIN", "CALL BLOCK FIN TO SUBA", "GOTOF SUBA"] {
        let program = format!("DEF STRING[8] SUBA=\"SUBB\"\n{call}\nFIN: M30\n");
        let error = read(&program, &setup()).expect_err(call);
        assert_fault(&program, &error, 2, "P0115 computed");
    }
}

/// An increment of one axis is one as in G91.
#[test]
fn the_first_position_after_a_rotation_is_no_increment() {
    for text in ["ROT Z90\nG0 X=IC(-60) Y=IC(0)", "ROT Z90\nG91\nG0 X-60 Y0"] {
        let program = format!("G17 G90 G54 G71 G94\nG0 X0 Y0 Z9\n{text}\nM30\n");
        let error = read(&program, &setup()).expect_err(text);
        assert!(common::is_fault(&error, "P0120 after G68"), "{text}: {error}");
    }
}

/// A stated Sinumerik reads its own language unless a word of its ISO mode stands in the program: D is then the length of the tool.
#[test]
fn plain_programs_are_native_unless_in_iso_mode() {
    let stated = ControlRules::named("siemens").expect("a control");
    let setup = ControlSetup { rules: stated, ..setup() };
    let length = |words: &str| {
        let text = format!(
            "G17 G90 G54 G71 G94 G40\nT1\nM6\nD1\nS900 M3\nG0 X1\n{words}G1 Z2 F100\nM30\n"
        );
        let (steps, _) = read(&text, &setup).expect("a program");
        steps.last().expect("a step").state.length
    };
    let native = LengthOffset::On { register: 1, length: Some(80.0) };
    assert_eq!(length(""), native);
    assert_eq!(length("G60 G450\n"), native);
    for iso in ["(A COMMENT)\n", "G49\n", "G80\n"] {
        assert_ne!(length(iso), native, "{iso}");
    }
}

/// In a block of its own D is that of the tool in the spindle, whatever tool the changer prepares.
#[test]
fn d_after_a_preselected_tool_is_that_of_the_spindle() {
    let text = "G17 G90 G54 G71 G94\nT1 D1\nM6\nT2\nG0 X0 Y0\nG0 Z50\nSUPA G0 Z300 D0\nD1\nG0 Z20\nMSG(\"A\")\nM30\n";
    let last = steps(text).pop().expect("a step");
    assert_eq!(last.state.length, LengthOffset::On { register: 1, length: Some(80.0) });
    assert_eq!(last.state.tool, Some(1));
}
