//! Macros of Fanuc and of LinuxCNC, against programs whose motions are computed here.

use crate::common::{assert_fault, is_fault};
use std::collections::BTreeMap;
use touchoff_verify::MachineProgram;
use touchoff_verify::gcode::{Choice, ControlRules, ControlSetup, NoteKind, Rule, Step, read};
use touchoff_verify::machine::Machine;

/// A control at the origin that executes the macros of one dialect.
fn setup(dialect: Choice) -> ControlSetup {
    let rules = ControlRules::default()
        .with(Rule::Dialect, dialect)
        .with(Rule::WholeNumbers, Choice::Units);
    ControlSetup {
        start: [Some(0.0); 6],
        work_offsets: [Some([0.0; 6]); 9],
        rules,
        ..ControlSetup::default()
    }
}

fn steps(program: &str, dialect: Choice) -> Vec<Step> {
    read(program, &setup(dialect)).unwrap_or_else(|error| panic!("{program}\n{error}")).0
}

/// Returns X and Y of the ends.
fn ends(program: &str, dialect: Choice) -> Vec<[f64; 2]> {
    let ends = steps(program, dialect).into_iter().map(|step| [step.end[0], step.end[1]]);
    ends.map(|end| end.map(|value| value.expect("a coordinate"))).collect()
}

#[track_caller]
fn assert_ends(program: &str, dialect: Choice, expected: &[[f64; 2]]) {
    let found = ends(program, dialect);
    assert_eq!(found.len(), expected.len(), "{program}\n{found:?}");
    for (found, expected) in found.iter().zip(expected) {
        assert!((0..2).all(|k| (found[k] - expected[k]).abs() < 1e-12), "{found:?} {expected:?}");
    }
}

/// The holes of a bolt circle, one by one.
fn circle(count: u32, radius: f64, [x, y]: [f64; 2], start: f64) -> Vec<[f64; 2]> {
    (0..count)
        .map(|k| {
            let angle = (start + 360.0 * f64::from(k) / f64::from(count)).to_radians();
            [x + radius * angle.cos(), y + radius * angle.sin()]
        })
        .collect()
}

/// The readings of a program share one budget of work, and a program that uses it up is refused as a whole.
#[test]
fn loops_of_all_readings_share_a_budget() {
    let read = |passes: usize, values: usize| {
        let text = format!(
            "G21 G17 G90 G40 G80 G94\nG54 S1000 M3\nG0 X[#500] Y0 Z50\n#1=0\nWHILE [#1 LT {passes}] DO1\n#1=#1+1\nEND1\nM30\n"
        );
        let setup = ControlSetup {
            rules: ControlRules::named("fanuc").expect("a control"),
            variables: BTreeMap::from([(
                "#500".to_owned(),
                (0..values).map(|k| k as f64).collect(),
            )]),
            max_repeated: 12_000,
            ..ControlSetup::default()
        };
        let machine = Machine::named("3-axis").expect("a machine");
        MachineProgram::readings("a.nc", text, machine, &setup)
            .map(|readings| readings.len())
            .map_err(|error| error.code())
    };
    // Each pass executes three blocks again.
    assert_eq!(read(3_900, 1), Ok(1));
    assert_eq!(read(4_100, 1), Err("P0144"));
    assert_eq!(read(950, 4), Ok(4));
    assert_eq!(read(1_050, 4), Err("P0144"));
    assert_eq!(read(1_050, 3), Ok(3));
    let endless = "G54 S1000 M3\nG0 X0 Y0 Z50\nN10 G1 X1 F100\nGOTO 10\nM30\n".to_owned();
    let setup = ControlSetup { max_repeated: 10_000, ..setup(Choice::Iso) };
    let machine = Machine::named("3-axis").expect("a machine");
    let error = MachineProgram::new("a.nc", endless, machine, setup).expect_err("no end");
    assert_eq!(error.code(), "P0144");
}

/// A long block takes as much of the budget as its text does, in every language.
#[test]
fn long_blocks_of_loops_share_the_budget() {
    let long = "A".repeat(640);
    for (language, text) in [
        (Choice::Iso, "G54 G0 X0.\n#1=0\nN1 (LONG)\n#1=#1+1\nIF [#1 LT 1000] GOTO 1\nM30\n"),
        (
            Choice::Heidenhain,
            "BEGIN PGM A MM\nL X+0 FMAX\nQ1 = 0\nLBL 1\n; LONG\nQ1 = Q1 + 1\nFN 12: IF +Q1 LT +1000 GOTO LBL 1\nM30\nEND PGM A MM\n",
        ),
        (
            Choice::Sinumerik,
            "G54 G0 X0\nR1=0\nBEGINS: ; LONG\nR1=R1+1\nIF R1<1000 GOTOB BEGINS\nM30\n",
        ),
    ] {
        let setup = ControlSetup { max_repeated: 8_000, ..setup(language) };
        let code = |text: &str| read(text, &setup).err().map(|error| error.code());
        assert_eq!(code(&text.replace("LONG", "SHORT")), None, "{text}");
        assert_eq!(code(&text.replace("LONG", &long)), Some("P0144"), "{text}");
    }
}

/// The conditions of branches that are not taken are as much work as blocks.
#[test]
fn branches_that_are_not_taken_share_the_budget() {
    let branches = "o1 elseif [0]\n".repeat(200);
    let text =
        format!("g21 g90 g0\no9 repeat [60]\no1 if [0]\n{branches}o1 endif\no9 endrepeat\nm30\n");
    let setup = ControlSetup { max_repeated: 10_000, ..setup(Choice::Rs274Ngc) };
    assert_eq!(read(&text, &setup).err().map(|error| error.code()), Some("P0144"));
}

/// The blocks of the main program that are executed once are limited by its text alone, after a loop too.
#[test]
fn a_long_program_takes_nothing_of_the_budget() {
    let blocks: String = (0..900).map(|k| format!("X+{} Y+{}\n", k % 7, k % 5)).collect();
    let klartext: String = blocks.lines().map(|block| format!("L {block} FMAX\n")).collect();
    for (language, text) in [
        (Choice::Iso, format!("G54 G0 X0\n#1=0\nN1 #1=#1+1\nIF [#1 LT 10] GOTO 1\n{blocks}M30\n")),
        (
            Choice::Heidenhain,
            format!(
                "BEGIN PGM A MM\nLBL 1\nL X+0 FMAX\nCALL LBL 1 REP 9\n{klartext}M30\nEND PGM A MM\n"
            ),
        ),
        (
            Choice::Sinumerik,
            format!(
                "G54 G0 X0\nR1=0\nAGAIN:\nR1=R1+1\nIF R1<10 GOTOB AGAIN\n{}M30\n",
                blocks.replace('+', "")
            ),
        ),
    ] {
        let setup = ControlSetup { max_repeated: 100, ..setup(language) };
        let steps = read(&text, &setup).unwrap_or_else(|error| panic!("{error}")).0;
        assert!(steps.len() >= 900, "{language:?}: {}", steps.len());
    }
}

#[test]
fn a_bolt_circle_is_the_same_in_every_form() {
    let expected = circle(7, 40.0, [10.0, -5.0], 15.0);
    let fanuc = "G21 G90 G0\nG65 P9100 X10. Y-5. R40. A15. K7.\nM30\n\
        O9100 (X #24, Y #25, R #18, A #1, K #6)\n#30=0\nWHILE [#30 LT #6] DO1\n\
        #31=#1+#30*360.0*[1/#6]\nX[#24+#18*COS[#31]] Y[#25+#18*SIN[#31]]\n#30=#30+1\nEND1\nM99\n";
    assert_ends(fanuc, Choice::Iso, &expected);
    let with_goto = "G21 G90 G0\n#100=0\nN10 IF [#100 GE 7] GOTO 20\n#101=[15+#100*360/7]\n\
        X[10.+40.*COS[#101]] Y[-5.+40.*SIN[#101]]\n#100=#100+1\nGOTO 10\nN20 M30\n";
    assert_ends(with_goto, Choice::Iso, &expected);
    let linuxcnc = "g21 g90 g0\no<circle> sub\n#<k>=0\no1 while [#<k> lt #5]\n\
        #<a>=[#4 + #<k> * 360 / #5]\nx[#1+#3*cos[#<a>]] y[#2+#3*sin[#<a>]]\n#<k>=[#<k>+1]\no1 endwhile\n\
        o<circle> endsub\no<circle> call [10] [-5] [40] [15] [7]\nm30\n";
    assert_ends(linuxcnc, Choice::Rs274Ngc, &expected);
    let repeat = "g21 g90 g0\n#1=15\no1 repeat [7]\nx[10+40*cos[#1]] y[-5+40*sin[#1]]\n#1=[#1+360/7]\n\
        o1 endrepeat\nm30\n";
    let found = ends(repeat, Choice::Rs274Ngc);
    assert!(
        found
            .iter()
            .zip(&expected)
            .all(|(found, expected)| { (0..2).all(|k| (found[k] - expected[k]).abs() < 1e-9) })
    );
    // Blanks after a value are no part of it, whatever the control.
    let blanks = "G21 G90 G0\n#1=2 \n#2=[#1+1] \nX#1 Y#2 \nM30\n";
    let unstated = ControlSetup { start: [Some(0.0); 6], ..ControlSetup::default() };
    assert_eq!(read(blanks, &unstated).expect("values").0[0].end[..2], [Some(2.0), Some(3.0)]);
    // A program with statements of one control is that control's, also if none is stated.
    let setup = ControlSetup { start: [Some(0.0); 6], ..ControlSetup::default() };
    assert_eq!(read(with_goto, &setup).expect("a macro").0.len(), 7);
}

#[test]
fn modal_macros_are_called_after_each_motion() {
    let program = "G21 G90 G0\nX1.\nG66 P9200 A0.5\nX2.\nS100\nX3. Y1.\nG67\nX4.\nM30\n\
        O9200\nG91 Y#1\nG90\nM99\n";
    let expected = [[1.0, 0.0], [2.0, 0.0], [2.0, 0.5], [3.0, 1.0], [3.0, 1.5], [4.0, 1.5]];
    assert_ends(program, Choice::Iso, &expected);
    // A subprogram and a full circle, too.
    let calls = "G21 G90 G0 F100\nG66 P9200 A0.5\nM98 P9300\nG2 I9.\nX4.\nM30\n\
        O9200\nG91 G0 Y#1\nG90\nM99\nO9300\nG0 X2.\nM99\n";
    let expected = [[2.0, 0.0], [2.0, 0.5], [2.0, 0.5], [2.0, 1.0], [4.0, 1.0], [4.0, 1.5]];
    assert_ends(calls, Choice::Iso, &expected);
    // G66 of a subprogram holds after it.
    let inner =
        "G21 G90 G0\nM98 P9300\nX4.\nM30\nO9200\nG91 Y#1\nG90\nM99\nO9300\nG66 P9200 A0.5\nM99\n";
    assert_ends(inner, Choice::Iso, &[[4.0, 0.0], [4.0, 0.5]]);
    for word in ["G28 X0.", "G91 G30 X0.", "G53 G0 X0."] {
        let program = calls.replace("X4.", word);
        let error = read(&program, &setup(Choice::Iso)).expect_err(word);
        assert_fault(&program, &error, 5, "P0120 G66 is in force");
    }
    // Its variables go on from one call to the next.
    let counts =
        "G21 G90 G0\nG66 P9200 A1.\nX1.\nX2.\nG67\nM30\nO9200\nG91 Y#1\nG90\n#1=#1+10.\nM99\n";
    let expected = [[1.0, 0.0], [1.0, 1.0], [2.0, 1.0], [2.0, 12.0]];
    assert_ends(counts, Choice::Iso, &expected);
    // Another call would nest, as each control does in its own way.
    for (within, at) in [("X4.", 5), ("#1=0", 9)] {
        for call in ["G66 P9300", "G65 P9300"] {
            let program = calls.replace("#1\n", "#1\n#1=0\n").replace(within, call);
            let error = read(&program, &setup(Choice::Iso)).expect_err(call);
            assert_fault(&program, &error, at, "P0120 G66 is in force");
        }
    }
    let left = inner.replace("M98 P9300", "G65 P9300");
    let error = read(&left, &setup(Choice::Iso)).expect_err("a macro that leaves G66");
    assert_fault(&left, &error, 11, "P0120 G66 of the macro is in force");
}

/// In the value of a word ROUND of Fanuc leaves the least increment, on LinuxCNC whole numbers.
#[test]
fn round_in_a_word_rounds_to_its_increment() {
    let program = "G21 G90 G0\n#1=25.4\nX[ROUND[#1]] Y[ROUND[1.00333]+ROUND[1.00333]]\n#2=ROUND[#1]\nX#2 Y0.\nM30\n";
    assert_ends(program, Choice::Iso, &[[25.4, 2.006], [25.0, 0.0]]);
    assert_ends(program, Choice::Rs274Ngc, &[[25.0, 2.0], [25.0, 0.0]]);
    let unstated = ControlSetup { start: [Some(0.0); 6], ..ControlSetup::default() };
    let error = read(program, &unstated).expect_err("two values");
    assert_fault(program, &error, 3, "P0205 ROUND");
    let argument = "G21 G90 G0\nG65 P9200 A[ROUND[1.5]]\nM30\nO9200\nX#1\nM99\n";
    let error = read(argument, &setup(Choice::Iso)).expect_err("an argument");
    assert_fault(argument, &error, 2, "P0203 ROUND in an argument");
}

#[test]
fn subprograms_are_called_in_every_form() {
    let sub = "O2001\nG91 X1.\nG90\nM99\n";
    for call in ["M98 P2001 L3", "M98 P32001", "M98 P0032001", "M98 P2001\nM98 P2001 L2"] {
        let program = format!("G21 G90 G0 X0\n{call}\nM30\n{sub}");
        let expected = [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [3.0, 0.0]];
        assert_ends(&program, Choice::Iso, &expected);
    }
    // Blocks of the program itself, and a return to a block of the caller.
    let local = "G21 G90 G0\nM97 P100 L2\nY5.\nM30\nN100 G91 X1.\nG90\nM99\n";
    assert_ends(local, Choice::Iso, &[[1.0, 0.0], [2.0, 0.0], [2.0, 5.0]]);
    let target = "G21 G90 G0\nM98 P7\nX9.\nN50 X1.\nM30\nO7\nY2.\nM99 P50\n";
    assert_ends(target, Choice::Iso, &[[0.0, 2.0], [1.0, 2.0]]);
    let colon = "%\n:100\nG21 G90 G0 X1.\nM98 P7\nM30\n:7\nY2.\nM99\n%\n";
    assert_ends(colon, Choice::Iso, &[[1.0, 0.0], [1.0, 2.0]]);
    let endless = read("G21 G90 G0 X1.\nM99\n", &setup(Choice::Iso)).expect("a program");
    assert!(endless.1.iter().any(|note| note.kind == NoteKind::Endless));
}

/// Arguments of both types, by the table of the manual.
#[test]
fn arguments_are_those_of_the_manual() {
    let value = |arguments: &str, number: u32| {
        let program = format!("G21 G90 G0\nG65 P1 {arguments}\nM30\nO1\nX#{number} Y0\nM99\n");
        ends(&program, Choice::Iso)[0][0]
    };
    for (index, letter) in "ABCDEF".chars().enumerate() {
        let number = [1, 2, 3, 7, 8, 9][index];
        assert_eq!(value(&format!("{letter}5."), number), 5.0, "{letter}");
    }
    for (letter, number) in [('H', 11), ('M', 13), ('Q', 17), ('R', 18), ('S', 19), ('T', 20)] {
        assert_eq!(value(&format!("{letter}5."), number), 5.0, "{letter}");
    }
    for (letter, number) in [('U', 21), ('V', 22), ('W', 23), ('X', 24), ('Y', 25), ('Z', 26)] {
        assert_eq!(value(&format!("{letter}5."), number), 5.0, "{letter}");
    }
    for k in 1..=10 {
        let all: String = (1..=10).map(|k| format!("I{k}.1J{k}.2K{k}.3 ")).collect();
        for (offset, tenth) in [(0, 0.1), (1, 0.2), (2, 0.3)] {
            let found = value(&all, 4 + 3 * (k - 1) + offset);
            assert!((found - (f64::from(k) + tenth)).abs() < 1e-12);
        }
    }
    // K before I is K1 and I2; of D and I2, both #7, the later counts.
    assert_eq!(value("K3. I5.", 6), 3.0);
    assert_eq!(value("K3. I5.", 7), 5.0);
    assert_eq!(value("I1. I2. D9.", 7), 9.0);
    // An argument that is not given is vacant: its word is as if it were not written, and it is not equal to 0.
    let vacant = "G21 G90 G0 X3.\nG65 P1 A1.\nM30\nO1\nX#2 Y#1\nIF [#2 EQ #0] GOTO 5\nX9.\n\
        N5 IF [#2 EQ 0] GOTO 6\nX[#2+4.]\nN6 M99\n";
    assert_ends(vacant, Choice::Iso, &[[3.0, 0.0], [3.0, 1.0], [4.0, 1.0]]);
    // The caller's variables are its own.
    let own = "G21 G90 G0\n#1=2.\nG65 P1 A5.\nX#1\nM30\nO1\n#1=7.\nY#1\nM99\n";
    assert_ends(own, Choice::Iso, &[[0.0, 7.0], [2.0, 7.0]]);
}

#[test]
fn expressions_have_the_value_of_their_control() {
    let value = |expression: &str, dialect| {
        ends(&format!("G21 G90 G0 X[{expression}]\nM30"), dialect)[0][0]
    };
    for (expression, fanuc, linuxcnc) in [
        ("FIX[-2.5]", Some(-2.0), Some(-3.0)),
        ("FUP[-2.5]", Some(-3.0), Some(-2.0)),
        ("FUP[2.1]", Some(3.0), Some(3.0)),
        ("ROUND[2.5]", Some(2.5), Some(3.0)),
        ("ROUND[-2.5]", Some(-2.5), Some(-3.0)),
        ("[0-7] MOD 3", Some(-1.0), Some(2.0)),
        ("7 MOD 3", Some(1.0), Some(1.0)),
        ("6 AND 3", Some(2.0), Some(1.0)),
        ("6 OR 3", Some(7.0), Some(1.0)),
        ("6 XOR 3", Some(5.0), Some(0.0)),
        ("2 ** 3", None, Some(8.0)),
        ("POW[2,3]", Some(8.0), None),
        ("ATAN[1]/[1]", Some(45.0), Some(45.0)),
        ("ATAN[0-1]/[1]", None, Some(-45.0)),
        ("ATAN[1]", Some(45.0), None),
        ("ACOS[0.5]", Some(60.0), Some(60.0)),
        ("ASIN[0.5]", None, Some(30.0)),
        ("LN[EXP[2]]", Some(2.0), Some(2.0)),
        ("TAN[45]", Some(1.0), Some(1.0)),
        ("COS[90]", Some(0.0), Some(0.0)),
        ("1 + 2 * 3 EQ 7", Some(1.0), Some(1.0)),
        // Precedence: AND is a product on Fanuc, and the last on LinuxCNC.
        ("4 + 2 AND 2", Some(6.0), Some(1.0)),
        ("5 - 3 - 1", Some(1.0), Some(1.0)),
        // Equal on LinuxCNC, or not, by its release.
        ("1 EQ 1.00005", Some(0.0), None),
        ("1.00005 GE 1", Some(1.0), Some(1.0)),
        ("SQRT[16] / 2", Some(2.0), Some(2.0)),
    ] {
        for (dialect, expected) in [(Choice::Iso, fanuc), (Choice::Rs274Ngc, linuxcnc)] {
            match expected {
                Some(expected) => {
                    let found = value(expression, dialect);
                    assert!((found - expected).abs() < 1e-12, "{expression} is {found}");
                }
                None => {
                    let program = format!("G21 G90 G0 X[{expression}]\nM30");
                    read(&program, &setup(dialect)).expect_err(expression);
                }
            }
        }
    }
}

#[test]
fn decisions_of_linuxcnc_take_one_branch() {
    for (value, expected) in [(6, 1.0), (1, 2.0), (3, 3.0)] {
        let program = format!(
            "g21 g90 g0\n#31={value}\no102 if [#31 gt 5]\nx1\no102 elseif [#31 lt 2]\nx2\no102 else\nx3\no102 endif\n\
             y1\nm30\n"
        );
        assert_ends(&program, Choice::Rs274Ngc, &[[expected, 0.0], [expected, 1.0]]);
    }
    // break, continue and nesting: the sum of the odd numbers below 8.
    let program = "g21 g90 g0\n#31=0\n#32=0\no1 while [1]\n#31=[#31+1]\no2 if [#31 ge 8]\no1 break\no2 endif\n\
        o3 if [#31 mod 2 eq 0]\no1 continue\no3 endif\n#32=[#32+#31]\nx#31 y#32\no1 endwhile\nm30\n";
    let mut expected = vec![];
    let mut sum = 0.0;
    for odd in [1.0, 3.0, 5.0, 7.0] {
        sum += odd;
        expected.push([odd, sum]);
    }
    assert_ends(program, Choice::Rs274Ngc, &expected);
    let counted = "g21 g90 g0\n#31=8\no4 do\n#31=[#31-3]\nx#31\no4 while [#31 gt 0]\nm30\n";
    assert_ends(counted, Choice::Rs274Ngc, &[[5.0, 0.0], [2.0, 0.0], [-1.0, 0.0]]);
    // Recursion, and a value that is returned.
    let factorial = "g21 g90 g0\no<f> sub\no1 if [#1 le 1]\no<f> return [1]\no1 endif\no<f> call [#1-1]\n\
        o<f> endsub [#1*#<_value>]\no<f> call [5]\nx#<_value>\nm30\n";
    assert_ends(factorial, Choice::Rs274Ngc, &[[120.0, 0.0]]);
}

#[test]
fn variables_of_the_control_are_those_of_its_state() {
    let fanuc = "G21 G90 G55 G0 X3. Y4.\n#1=#5001+#4003\nX#1\nG91 X#4006\nM30";
    assert_ends(fanuc, Choice::Iso, &[[3.0, 4.0], [93.0, 4.0], [114.0, 4.0]]);
    let linuxcnc = "g21 g90 g55 g0 x3 y4\n#1=[#5420+#5220+#<_y>+#<_metric>]\nx#1\nm30";
    assert_ends(linuxcnc, Choice::Rs274Ngc, &[[3.0, 4.0], [10.0, 4.0]]);
    for (program, dialect, code, name) in [
        ("G21 G0 X#5061", Choice::Iso, "P0211", "#5061"),
        ("G21 G0 X#3001", Choice::Iso, "P0211", "#3001"),
        ("g21 g0 x#5070", Choice::Rs274Ngc, "P0211", "#5070"),
        ("g21 g0 x#<_task>", Choice::Rs274Ngc, "P0211", "#<_task>"),
        ("G21 G0 X#500", Choice::Iso, "P0210", "#500"),
        ("g21 g0 x#<_depth>", Choice::Rs274Ngc, "P0210", "#<_depth>"),
    ] {
        let error = read(program, &setup(dialect)).expect_err(name);
        assert_fault(program, &error, 1, &format!("{code} {name}"));
        // A job can declare it.
        let mut declared = setup(dialect);
        declared.variables.insert(name.to_owned(), vec![7.0]);
        let (steps, _) = read(&format!("{program}\nM30"), &declared).expect(name);
        assert_eq!(steps[0].end[0], Some(7.0));
    }
}

/// The origins that G10 sets, of further work offsets by their number and of one at the present position.
#[test]
fn g10_sets_origins() {
    for offset in ["G54.1 P3", "G154 P3", "G112"] {
        let program =
            format!("G21 G90 G0 X5.\nG10 L20 P3 X100. Y0. Z0. A0. B0. C0.\n{offset}\nX5.\nM30");
        let found = steps(&program, Choice::Iso);
        assert_eq!(found[1].state.origin[0], Some(100.0), "{offset}");
        assert_eq!(found[1].state.to_machine(found[1].end)[0], Some(105.0));
    }
    let here = "g21 g90 g54 g0 x5 y2\ng10 l20 p1 x0 y10\ng0 x1 y1\ng10 l20 p0 x7\nx0\nm30";
    let found = steps(here, Choice::Rs274Ngc);
    let places: Vec<_> =
        found.iter().map(|step| step.state.to_machine(step.end)[..2].to_vec()).collect();
    let expected = [[5.0, 2.0], [6.0, -7.0], [-1.0, -7.0]].map(|place| place.map(Some).to_vec());
    assert_eq!(places, expected);
}

/// Fanuc's table of operations writes a quotient as `#i=#j/#k`. A `/` at the beginning of a block is that of an optional block.
#[test]
fn quotients_need_no_brackets_on_fanuc() {
    let macro_of = |angle: &str, y: &str| {
        format!(
            "G21 G90 G0\n#1=8\n#3=1\nWHILE [#3 LE #1] DO1\n{angle}\nX[10.*COS[#4]]\n{y}\n#3=#3+1\nEND1\nM30\n"
        )
    };
    let bare = macro_of("#4=#3*360/#1", "/Y7.");
    assert_ends(&bare, Choice::Iso, &ends(&macro_of("#4=[[#3*360]/#1]", "/Y7."), Choice::Iso));
    assert_ends("G21 G90 G0\n#1=8.\n#4=-#1/2-6/3/2\nX#4\nM30\n", Choice::Iso, &[[-5.0, 0.0]]);
    // LinuxCNC refuses it, so that a program with it is Fanuc's where no control is stated.
    let setup = ControlSetup { start: [Some(0.0); 6], ..ControlSetup::default() };
    let stated = read("G21 G90 G0\n#1=8.\n#4=3*#1/4\nX#4\nM30\n", &setup).expect("a quotient");
    assert_eq!(stated.0[0].end[0], Some(6.0));
    let linuxcnc = self::setup(Choice::Rs274Ngc);
    let error = read("g21 g90 g0\n#4=6/2\nx#4\nm30\n", &linuxcnc).expect_err("no quotient");
    assert_fault("", &error, 2, "P0203 `/`");
}

/// A loop of 10^6 blocks.
#[test]
fn long_loops_are_executed_to_their_end() {
    let program =
        "G21 G90 G0\n#1=0\nWHILE [#1 LT 200000] DO1\n#1=#1+1\nG1 X#1 F100.\nY[#1*2]\nEND1\nM30\n";
    let found = steps(program, Choice::Iso);
    assert_eq!(found.len(), 400_000);
    assert_eq!(found.last().map(|step| step.end[1]), Some(Some(400_000.0)));
}

/// A jump finds its line in a time that does not grow with the loops, programs and equal numbers of the text.
#[test]
fn jumps_pass_any_number_of_loops_and_programs() {
    let loops = "WHILE [1 EQ 0] DO1\nEND1\n".repeat(100_000);
    let others: String = (10..100_010).map(|number| format!("O{number}\nN1 M99\n")).collect();
    let program = format!(
        "O1\nG21 G90 G0\n{loops}#1=0\nN1 #1=#1+1\nIF [#1 LT 300000] GOTO 1\nX#1\nM30\n{others}"
    );
    assert_ends(&program, Choice::Iso, &[[300_000.0, 0.0]]);
    // From inside of a loop outwards, within one, and past another in it.
    let nested = "G21 G90 G0\n#1=0\nWHILE [#1 LT 2] DO1\nWHILE [1 EQ 1] DO2\n#1=#1+1\nGOTO 10\nEND2\nN10 X#1\nEND1\n\
        WHILE [1 EQ 1] DO1\nGOTO 20\nEND1\nN20 Y#1\nM30\n";
    assert_ends(nested, Choice::Iso, &[[1.0, 0.0], [2.0, 0.0], [2.0, 2.0]]);
}

#[test]
fn ignored_words_are_noted_with_their_reason() {
    let mut setup = setup(Choice::Iso);
    for word in ["G999", "M777", "DIST"] {
        setup.rules = setup.rules.ignoring(word, "it opens the door").expect("a word");
    }
    let program = "G21 G90 G0 X1.\nG999 P3 E0.01\nM777\nDIST(1,2)\nX2. M777\nM30";
    let (steps, notes) = read(program, &setup).expect("a program");
    assert_eq!(steps.len(), 2);
    let ignored: Vec<(usize, usize)> = notes
        .iter()
        .filter(|note| note.to_string().contains("it opens the door"))
        .map(|note| (note.line, note.count))
        .collect();
    assert_eq!(ignored, [(2, 1), (3, 2), (4, 1)], "{notes:?}");
    for (word, reason) in [
        ("G43", "a reason"),
        ("M98", "a reason"),
        ("G31", "a reason"),
        ("G999", " "),
        ("X1", "a reason"),
        ("IF", "a"),
    ] {
        setup.rules.clone().ignoring(word, reason).expect_err(word);
    }
    let file = ControlRules::named("linuxcnc")
        .expect("a control")
        .ignoring("g999", "it \"clamps\"")
        .expect("a word");
    assert_eq!(ControlRules::parse(&file.to_toml(), "mine.toml"), Ok(file));
    let program = "G21 G0\nG999 X1.\nM30";
    let error = read(program, &setup).expect_err("axis words");
    assert_fault(program, &error, 2, "P0120 axis words while its block has an ignored word");
}

/// Lines to a printer move nothing, whatever variables they print.
#[test]
fn printing_is_passed_over() {
    let program =
        "G21 G90 G54 G0 X0 Y0\nPOPEN\nDPRNT[X#500[44]*Y#[#1+1][53]]\nBPRNT[A];B\nPCLOS\nX1.\nM30\n";
    assert_eq!(steps(program, Choice::Iso).len(), 2);
    let lines = [
        ("DPRNT X5", "P0119 DPRNT"),
        ("DPRNT[A] X5.", "P0101"),
        ("POPEN X5.", "P0101"),
        ("X5. PCLOS", "P0120 PCLOS"),
    ];
    for (line, message) in lines {
        let program = format!("G21 G90 G54 G0 X0 Y0\n{line}\nM30\n");
        let error = read(&program, &setup(Choice::Iso)).expect_err(line);
        assert_fault(&program, &error, 2, message);
    }
    let error = read(program, &setup(Choice::Rs274Ngc)).expect_err("a word of Fanuc");
    assert_fault(program, &error, 2, "P0107 `POPEN`");
}

/// What LinuxCNC's interpreter does with O-words where its manual says otherwise, or nothing: what is followed, and what is refused.
#[test]
fn o_words_of_linuxcnc_do_what_its_interpreter_does() {
    let called = |main: &str, subs: &str| format!("g21 g90 g0\n{main}\nm2\n{subs}\n");
    // Arguments that are left out are 0, and each repeat of a call has its own names.
    let left_out = "g21 g90 g0\no1 sub\nx#1 y#2\no1 endsub\n#2=20\no1 call [80]\nm2\n";
    assert_ends(left_out, Choice::Rs274Ngc, &[[80.0, 0.0]]);
    let repeated = called(
        "m98 p7 l2",
        "o7\no1 if [exists[#<a>]]\nx9\no1 else\n#<a>=1\ny[#5421+1]\no1 endif\nm99",
    );
    assert_ends(&repeated, Choice::Rs274Ngc, &[[0.0, 1.0], [0.0, 2.0]]);
    // A call leaves the value with which one before has returned.
    let returned =
        "g21 g90 g0\no1 sub\no1 endsub [20]\no2 sub\nx#<_value>\no2 endsub\no1 call\no2 call\nm2\n";
    assert_ends(returned, Choice::Rs274Ngc, &[[20.0, 0.0]]);
    for (program, code, word) in [
        ("o1 while [1]\no1 break\no1 endwhile\no2 do\nx1\no2 while [0]", "P0120", "break"),
        ("o1 do\no1 continue\no1 while [0]", "P0120", "continue"),
        ("o1 do\nx1\no1 while [0]\no1 do\nx2\no1 while [0]", "P0128", "O1"),
        ("o1 do\nx1\no1 while [0]\no1 while [0]\no1 endwhile", "P0128", "O1"),
        ("o1 while [1]\no2 repeat [3]\no1 break\no2 endrepeat\no1 endwhile", "P0120", "break"),
        ("o1 if [0]\nx1\n/o1 else\nx2\no1 endif", "P0128", "O1"),
        ("o1 if [exists[#<_done>]]\no1 endif", "P0210", "#<_done>"),
        ("o1 if [exists[#<done>]]\no1 endif", "P0210", "#<done>"),
        ("g20\nx#5221", "P0211", "#5221"),
        ("x#5021", "P0211", "#5021"),
        ("x#5083", "P0211", "#5083"),
        ("g92 x1\ng92.2\nx#5211", "P0211", "#5211"),
        ("o1 sub\no1 endsub\nx#<_value>", "P0210", "#<_value>"),
    ] {
        let text = format!("g21 g90 g0\n{program}\nm2\n");
        let error = read(&text, &setup(Choice::Rs274Ngc)).expect_err(program);
        assert!(is_fault(&error, &format!("{code} {word}")), "{program}: {error}");
    }
    let left = called("m98 p7", "o7\no1 repeat [3]\nm99\no1 endrepeat");
    let error = read(&left, &setup(Choice::Rs274Ngc)).expect_err("a repeat that is left");
    assert!(is_fault(&error, "P0120 M99"), "{error}");
    // Open decisions of any number take no longer than their text.
    let open: String = (0..100_000).map(|k| format!("o{k} if [1]\n")).collect();
    let error = read(&format!("g21\n{open}m2\n"), &setup(Choice::Rs274Ngc)).expect_err("open");
    assert!(is_fault(&error, "P0128 more than 1,000"), "{error}");
}

/// Positions that controls report otherwise than the program states them are not known.
#[test]
fn positions_that_a_control_reports_otherwise_are_not_known() {
    for (program, dialect, word) in [
        ("g21 g90 g17 f9 g41.1 d2 g1 x9 y9\nx20\nx#<_x>", Choice::Rs274Ngc, "#<_x>"),
        ("G21 G90 G17 F9. G68 X0. Y0. R30.\nG1 X9. Y9.\nX#5001", Choice::Iso, "#5001"),
        ("G21 G90 G17 G51.1 X0.\nG0 X9. Y9.\nX#5001", Choice::Iso, "#5001"),
    ] {
        let error = read(program, &setup(dialect)).expect_err(program);
        assert!(is_fault(&error, &format!("P0211 {word}")), "{program}: {error}");
    }
    // A height under a length offset that a return may have ended.
    let lengths = BTreeMap::from([(1, 50.0)]);
    let setup = ControlSetup { lengths, home: [Some(0.0); 6], ..setup(Choice::Iso) };
    let text = "G21 G90 G0 G43 H1 Z9.\nG91 G28 Z0.\nG90 X#5003";
    let error = read(text, &setup).expect_err("a height");
    assert!(is_fault(&error, "P0211 #5003"), "{error}");
}

/// Sines and angles have other last digits on each control: what these decide is refused.
#[test]
fn ties_of_sines_are_refused() {
    for text in [
        "x[fix[sin[30]*10]]",
        "x[fix[cos[90]]]",
        "x[fup[sin[360]]]",
        "x[sin[180] mod 10]",
        "x[sin[180] and 1]",
        "o1 if [cos[60] lt 0.5]\no1 endif",
        "o1 if [tan[45] gt 1]\no1 endif",
        "o1 if [acos[0.5] gt 60]\no1 endif",
        "o1 if [sin[180]]\no1 endif",
    ] {
        let program = format!("g21 g90 g0\n{text}\nm2\n");
        let error = read(&program, &setup(Choice::Rs274Ngc)).expect_err(text);
        assert!(is_fault(&error, "P0206"), "{text}: {error}");
    }
    let iso = "G21 G90 G0\nIF [COS[60.] LT 0.5] GOTO 9\nX1.\nN9 X2.\nM30\n";
    let error = read(iso, &setup(Choice::Iso)).expect_err(iso);
    assert!(is_fault(&error, "P0206 LT"), "{error}");
    // Sums are the same ones there, and so are numbers that are equal within the tolerance.
    let tenths = "g21 g90 g0\n#1=0\no1 while [#1 lt 1]\n#1=[#1+0.1]\no1 endwhile\nx[#1] y[cos[0] eq 1]\nm2\n";
    let tenths = tenths.replace("y[cos[0] eq 1]", "y0");
    let last = ends(&tenths, Choice::Rs274Ngc);
    assert!((last[0][0] - 1.1).abs() < 1e-9, "{last:?}");
}

/// Behind a semicolon that ends a block, what is next is not decided by the line.
#[test]
fn blocks_behind_a_decision_in_one_line_are_refused() {
    let rules = ControlRules::named("haas").expect("a control");
    let setup = ControlSetup { rules, ..setup(Choice::Iso) };
    for text in [
        "GOTO 10 ; X3.\nN10 X8.",
        "IF [1 EQ 1] GOTO 10 ; X3.\nN10 X8.",
        "#1=5\nWHILE [#1 LT 3] DO1 ; X3.\nEND1",
        "G65 P9001 ; X3.",
        "G66 P9001\nX1. ; X3.\nG67",
    ] {
        let program = format!("G21 G90 G0\n{text}\nX9.\nM30\nO9001\nX7.\nM99\n");
        let error = read(&program, &setup).expect_err(text);
        assert!(is_fault(&error, "P0120 `;`"), "{text}: {error}");
    }
    for text in ["GOTO 10\nX3. ; N10 X8.\nN10 X4.", "GOTO 10\n(HERE) N10 X8.\nN10 X4."] {
        let error = read(&format!("G21 G90 G0\n{text}\nM30\n"), &setup).expect_err(text);
        assert!(is_fault(&error, "P0130"), "{text}: {error}");
    }
}

/// A number between two origins is no variable that the control knows.
#[test]
fn variables_beyond_the_work_offsets_are_not_known() {
    for number in [10_321, 10_325, 10_340, 15_445] {
        let program = format!("G21 G90\nG0 X#{number}\nM30\n");
        let error = read(&program, &setup(Choice::Iso)).expect_err(&program);
        assert!(is_fault(&error, "P0211"), "{error}");
    }
}
