//! Subprograms in other files: the same motions as with the subprograms in the program's own file, the lines that steps and faults name,
//! and calls that are refused.

use crate::common;
use crate::common::{assert_fault, is_fault};
use touchoff_verify::gcode::{
    Choice, ControlRules, ControlSetup, GcodeError, Position, Rule, Step, SubprogramFile,
    SubprogramLine,
};

fn setup(control: &str, files: &[(&str, &str)]) -> ControlSetup {
    let rules =
        ControlRules::named(control).expect("a control").with(Rule::WholeNumbers, Choice::Units);
    ControlSetup {
        start: [Some(0.0); 6],
        work_offsets: [Some([0.0; 6]); 9],
        rules,
        subprograms: files
            .iter()
            .map(|(name, text)| SubprogramFile { name: (*name).to_owned(), text: (*text).into() })
            .collect(),
        ..ControlSetup::default()
    }
}

fn execute(control: &str, program: &str, files: &[(&str, &str)]) -> Result<Vec<Step>, GcodeError> {
    common::execute(program, &setup(control, files))
}

#[track_caller]
fn steps(control: &str, program: &str, files: &[(&str, &str)]) -> Vec<Step> {
    common::steps(program, &setup(control, files))
}

fn ends(steps: &[Step]) -> Vec<Position> {
    steps.iter().map(|step| step.end).collect()
}

/// Asserts that a program moves with its subprograms in files as with them in its own file.
#[track_caller]
fn assert_same(control: &str, program: &str, files: &[(&str, &str)]) {
    let whole: String = [program].into_iter().chain(files.iter().map(|(_, text)| *text)).collect();
    let (split, whole) = (steps(control, program, files), steps(control, &whole, &[]));
    assert!(split.iter().any(|step| step.within.is_some()), "no file was called");
    assert_eq!(ends(&split), ends(&whole));
    let lines = program.lines().count();
    assert!(split.iter().all(|step| (1..=lines).contains(&step.line)), "a line of another file");
}

#[test]
fn subprograms_of_fanuc_and_haas_in_files_move_as_in_the_program() {
    let program =
        "O1\nG21 G90 G0 X0 Y0\nM98 P9001 L2\nG65 P9002 X5. K3.\nM98 P20009003\nX1. Y1.\nM30\n";
    let files = [
        ("rows.nc", "O9001\nG91 X1.\nM98 P9003\nG90\nM99\nO9003\nG91 Y2.\nG90\nM99\n"),
        // Labels, loops and sequence numbers are those of the file.
        (
            "O9002.NC",
            "O9002\nG0 X#24\n#1=0\nWHILE [#1 LT #6] DO1\nG91 Y1.\nG90\n#1=#1+1\nEND1\n\
            IF [#1 EQ 3] GOTO 5\nX99.\nN5 X#1\nM99\n",
        ),
    ];
    for control in ["fanuc", "haas"] {
        assert_same(control, program, &files);
    }
}

#[test]
fn a_file_without_a_title_is_the_program_of_its_number_or_name() {
    let body = "G91 X1.\nG90\nM99\n";
    let titled = "O7\nG91 X1.\nG90\nM99\n";
    let expected =
        ends(&steps("haas", "G90 G0 X0 Y0\nM98 P7 L3\nM30\nO7\nG91 X1.\nG90\nM99\n", &[]));
    for (call, file, text) in [
        ("M98 P7 L3", "7.nc", body),
        ("M98 P7 L3", "O0007", body),
        ("M98 (step.nc) L3", "STEP.NC", body),
        ("M98 (USB/parts/step.nc) L3", "step.nc", titled),
        ("M98 <STEP> L3", "step.nc", titled),
        ("M198 P7 L3", "step.nc", titled),
    ] {
        let program = format!("G90 G0 X0 Y0\n{call}\nM30\n");
        assert_eq!(ends(&steps("haas", &program, &[(file, text)])), expected, "{call}");
    }
    // Beside P, text in parentheses is a comment. M198 calls no program of the same file.
    assert_eq!(
        ends(&steps("haas", "G90 G0 X0 Y0\nM98 (other.nc) P7 L3\nM30\n", &[("7.nc", body)])),
        expected
    );
    let own = "G90 G0 X0 Y0\nM198 P7\nM30\nO7\nX1.\nM99\n";
    assert!(is_fault(&execute("haas", own, &[]).expect_err("own file"), "P0126 O7"));
}

#[test]
fn m99_with_a_number_goes_on_in_the_file_of_the_caller() {
    let program = "G90 G0 X0 Y0\nM98 P7 L5\nX50.\nN9 Y3.\nM30\n";
    let file = ("7.nc", "X1.\nN9 X2.\nM99 P9\n");
    let found: Vec<_> =
        steps("fanuc", program, &[file]).iter().map(|step| [step.end[0], step.end[1]]).collect();
    let expected = [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [2.0, 3.0]].map(|end| end.map(Some));
    assert_eq!(found, expected);
}

#[test]
fn linuxcnc_finds_a_file_by_the_name_of_its_subprogram() {
    let program = "g21 g90 g0 x0 y0\no<row> call [3] [2]\no100 call\nx9\nm2\n";
    let files = [
        ("row.ngc", "o<row> sub\no1 repeat [#1]\ng91 x[#2]\ng90\no1 endrepeat\no<row> endsub\n"),
        ("100.ngc", "o100 sub\no<own> call\ny5\no100 endsub\no<own> sub\ny1\no<own> endsub\n"),
    ];
    let found: Vec<_> =
        steps("linuxcnc", program, &files).iter().map(|step| [step.end[0], step.end[1]]).collect();
    let expected =
        [[0.0, 0.0], [2.0, 0.0], [4.0, 0.0], [6.0, 0.0], [6.0, 1.0], [6.0, 5.0], [9.0, 5.0]];
    assert_eq!(found, expected.map(|end| end.map(Some)));
    // A file of another name is not found.
    let other = [("rows.ngc", files[0].1)];
    let error = execute("linuxcnc", program, &other).expect_err("another name");
    assert_fault(program, &error, 2, "P0126 O<row>");
}

#[test]
fn klartext_calls_a_program_with_its_own_labels_and_parameters() {
    let program = "BEGIN PGM A MM\nTOOL CALL 1 Z S1000\nL Z+50 R0 FMAX M3\nQ1=4\nQL2=7\nCALL PGM TNC:\\PARTS\\STEP.H\n\
        CALL PGM step\nL X+Q1 Y+QL2 FMAX\nLBL 1\nM2\nEND PGM A MM\n";
    let called = "BEGIN PGM STEP MM\nQL2=30\nCALL LBL 1 REP 1\nLBL 1\nQ1 = Q1 + 1\nL X+QL2 Y+Q1 FMAX\nEND PGM STEP MM\n";
    let called = called.replace("CALL LBL 1 REP 1\nLBL 1\n", "LBL 1\n");
    let found: Vec<_> = steps("heidenhain", program, &[("STEP.H", &called)])
        .iter()
        .filter(|step| step.end[0].is_some())
        .map(|step| [step.end[0], step.end[1]])
        .collect();
    let expected = [[30.0, 5.0], [30.0, 6.0], [6.0, 7.0]].map(|end| end.map(Some));
    assert_eq!(found[found.len() - 3..], expected);
    for (text, problem) in [
        (called.replace(" MM", " INCH"), "P0142 STEP.H, line 1:"),
        (called.replace("END", "M30\nEND"), "P0120 STEP.H, line 6: M30"),
        (called.replace("Q1 = Q1", "Q1 = Q3"), "P0210 STEP.H, line 4:"),
        (called.replace("LBL 1", "CALL PGM STEP"), "P0139"),
    ] {
        let error = execute("heidenhain", program, &[("STEP.H", &text)]).expect_err(problem);
        assert_fault(program, &error, 6, problem);
    }
}

#[test]
fn sinumerik_calls_files_by_their_names() {
    let program = "G54 G90 G0 X0 Y0\nFOR R1=1 TO 2\nROW(3,2)\nENDFOR\nSTEP P2\nEXTCALL(\"/DIR/STEP.SPF\")\nCALL \"STEP\"\nG0 X1 Y1\nM30\n";
    let files = [
        (
            "row.spf",
            "PROC ROW(INT COUNT, REAL BY)\nFOR R2=1 TO COUNT\nG91 X=BY\nG90\nENDFOR\nM17\n",
        ),
        ("STEP.SPF", "G91 Y1\nG90\nM17\n"),
    ];
    let found: Vec<_> = steps("siemens", program, &files)
        .iter()
        .map(|step| [step.end[0].unwrap_or(f64::NAN), step.end[1].unwrap_or(f64::NAN)])
        .collect();
    let mut expected = vec![[0.0, 0.0]];
    expected.extend((1..=6).map(|count| [2.0 * f64::from(count), 0.0]));
    expected.extend((1..=4).map(|count| [12.0, f64::from(count)]));
    expected.push([1.0, 1.0]);
    assert_eq!(found, expected);
}

#[test]
fn steps_and_faults_name_the_line_of_the_file() {
    let program = "G90 G0 X0 Y0\nM98 P7\nX5.\nM30\n";
    let file = ("7.nc", "\nX1.\nM98 P8\nM99\n");
    let inner = ("8.nc", "(deep)\nY1.\nM99\n");
    let found: Vec<_> = steps("fanuc", program, &[file, inner])
        .iter()
        .map(|step| (step.line, step.within))
        .collect();
    let within = |file, line| Some(SubprogramLine { file, line });
    assert_eq!(found, [(1, None), (2, within(1, 2)), (2, within(2, 2)), (3, None)]);
    let expect = |files: &[(&str, &str)], line: usize, pattern: &str| {
        let error = execute("fanuc", program, files).expect_err(pattern);
        assert_fault(program, &error, line, pattern);
    };
    expect(&[], 2, "P0126 O7");
    expect(&[file], 2, "P0126 7.nc, line 3: there is no O8");
    expect(&[file, ("8.nc", "G1 Y1.\nM99\n")], 2, "P0122 8.nc, line 1: G1");
    expect(&[("7.nc", "X1.\n")], 2, "P0138 7.nc, line 1:");
    expect(&[("7.nc", "X1.\rX2.\n")], 1, "P0102 7.nc, line 1:");
    expect(&[("7.nc", "M98 P7\nM99\n")], 2, "P0139 7.nc, line 1:");
    // A control finds one of two, and it is not known which.
    expect(&[file, inner, ("o8.txt", "O8\nM99\n")], 1, "P0143 O8 is in two files, 8.nc and o8.txt");
}

/// Files have no folders here: one answers for a name, so that calls of it name one folder.
#[test]
fn two_folders_of_one_name_are_refused() {
    let heidenhain = |folders: [&str; 2]| {
        let [first, second] = folders.map(|folder| format!("CALL PGM {folder}1.H\n"));
        let program = format!("BEGIN PGM A MM\n{first}{second}END PGM A MM\n");
        let called = "BEGIN PGM 1 MM\nL X+1 Y+2 Z+3 R0 FMAX\nEND PGM 1 MM\n";
        execute("heidenhain", &program, &[("1.H", called)])
    };
    let haas = |folders: [&str; 2]| {
        let [first, second] = folders.map(|folder| format!("M98 ({folder}SUB.NC)\n"));
        let program = format!("O1\nG90 G54\n{first}{second}M30\n");
        execute("haas", &program, &[("SUB.NC", "G0 X1. Y2. Z3.\nM99\n")])
    };
    let sinumerik = |folders: [&str; 2]| {
        let [first, second] = folders.map(|folder| format!("EXTCALL (\"{folder}SUB.SPF\")\n"));
        execute(
            "siemens",
            &format!("G90 G54\n{first}{second}M30\n"),
            &[("SUB.SPF", "G0 X1 Y2 Z3\nM17\n")],
        )
    };
    for execute in [&heidenhain as &dyn Fn([&str; 2]) -> _, &haas, &sinumerik] {
        for folders in [["A/", "A/"], ["A/", "a/"], ["", "A/"]] {
            assert_eq!(execute(folders).map(|steps: Vec<Step>| steps.len()), Ok(2), "{folders:?}");
        }
        let error = execute(["A/", "B/"]).expect_err("another folder");
        assert!(is_fault(&error, "P0120 in another folder"), "{error}");
    }
    assert_eq!(heidenhain(["TNC:\\A\\", "TNC:/A/"]).map(|steps| steps.len()), Ok(2));
}
