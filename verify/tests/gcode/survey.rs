//! What stands in the way of a program beside the error that stops it.

use crate::common::{assert_fault, is_fault};
use crate::mutants::Seed;
use std::sync::Arc;
use touchoff_verify::gcode::{
    Choice, ControlRules, ControlSetup, GcodeError, Interpreter, Rule, SubprogramFile,
};

fn setup(control: &str) -> ControlSetup {
    let rules =
        ControlRules::named(control).expect("a control").with(Rule::WholeNumbers, Choice::Units);
    ControlSetup { start: [Some(0.0); 6], rules, ..ControlSetup::default() }
}

/// Returns the error that stops a program, then those that the survey finds.
fn errors(program: &str, setup: &ControlSetup) -> Vec<GcodeError> {
    let mut interpreter = Interpreter::new(program, setup).expect("a program");
    let stop = interpreter.by_ref().find_map(Result::err).expect("an error");
    let others = interpreter.survey().filter_map(Result::err);
    [stop].into_iter().chain(others).collect()
}

/// Compares the errors of a program with their lines, codes and words.
#[track_caller]
fn expect(control: &str, program: &str, expected: &[(usize, &str)]) {
    let found = errors(program, &setup(control));
    let text: Vec<String> = found.iter().map(ToString::to_string).collect();
    assert_eq!(found.len(), expected.len(), "{text:#?}");
    for (error, (line, pattern)) in found.iter().zip(expected) {
        assert_fault(program, error, *line, pattern);
    }
}

/// Words and values alike are found: those of a block together, with the rest of it executed.
#[test]
fn everything_that_stands_in_the_way_is_found() {
    let fanuc = "G21 G90 G0 X0 Y0 Z5\nM130 M131 G777 G1 F100 X1.\nG41 D7 X2.\nX3. Y5.\n#1=#500+#501\nX#502\nM98 P9\nG43 H1.5\nM30\n";
    expect(
        "fanuc",
        fanuc,
        &[
            (2, "P0114 M130"),
            (2, "P0114 M131"),
            (2, "P0114 G777"),
            (3, "P0401 radius offset 7"),
            (5, "P0210 #500"),
            (6, "P0210 #502"),
            (7, "P0126 O9"),
            (8, "P0106 H1.5"),
        ],
    );
    let linuxcnc =
        "G21 G90 G0 X0 Y0\nM130\no1 if [#500 GT 1]\nG1 X1 F100 M131\no1 endif\nG0 X[foo[1]]\nM2\n";
    expect(
        "linuxcnc",
        linuxcnc,
        &[(2, "P0114 M130"), (3, "P0210 #500"), (4, "P0114 M131"), (6, "P0203 `FOO`")],
    );
    let sinumerik = "G54 G90 G0 X0 Y0\nR1=R7\nG41 D3 X5\nWAITM(1)\nX=R8\nGOTOF NOWHERE\nX7 OEMWORD\nMYCYCLE(1,2)\nM30\n";
    expect(
        "siemens",
        sinumerik,
        &[
            (2, "P0210 R7"),
            (4, "P0115 WAITM"),
            (5, "P0210 R8"),
            (6, "P0111 `NOWHERE`"),
            (7, "P0115 `OEMWORD`"),
            (8, "P0115 `MYCYCLE`"),
        ],
    );
    let klartext = "0 BEGIN PGM A MM\n1 TOOL CALL 1 Z S1000\n2 L X+0 Y+0 FMAX M130\n3 L X+5 F200 M222 M223\n4 CYCL DEF 399\n5 TCH PROBE 0\n6 L X+Q5\n7 CALL LBL 9\n8 L X+7 M118\n9 M30\n10 END PGM A MM\n";
    expect(
        "heidenhain",
        klartext,
        &[
            (3, "P0115 M130"),
            (4, "P0114 M222"),
            (4, "P0114 M223"),
            (5, "P0115 CYCL"),
            (6, "P0115 TCH"),
            (7, "P0210 Q5"),
            (8, "P0111 LBL 9"),
            (9, "P0115 M118"),
        ],
    );
}

/// An error that a block which was not executed can have caused is none of the program.
#[test]
fn what_follows_from_another_error_is_not_found() {
    // Neither the motion mode, nor the feed, the start of the arc, the variable or the offset are known.
    let fanuc =
        "G21 G90 G0 X0 Y0\nG1 F100 X1. ?\nX2.\n#5=TAN[FOO]\nX#5\nG2 X9. Y9. I1.\nG1 X1.\nM30\n";
    expect("fanuc", fanuc, &[(2, "P0101 `?`"), (4, "P0203 `FOO`")]);
    let heidenhain = "0 BEGIN PGM A MM\n1 TOOL CALL 1 Z S1000\n2 L X+0 Y+0 R0 FMAX\n3 Q4 = FOO\n4 L X+Q4\n5 L X+1 NIX\n6 RND R2\n7 L Y+8 F100\n8 M30\n9 END PGM A MM\n";
    expect("heidenhain", heidenhain, &[(4, "P0203 `FOO`"), (6, "P0110 `NIX`")]);
    let sinumerik = "G54 G90 G0 X0 Y0\nDEF FRAME NEST\nNEST=CTRANS(X,1)\nX5\nM30\n";
    expect("siemens", sinumerik, &[(2, "P0115 `FRAME NEST`"), (3, "P0203 `CTRANS`")]);
}

/// A word of the machine's builder is passed over in every language, with its reason.
#[test]
fn ignored_words_do_not_stand_in_the_way() {
    let programs = [
        ("haas", "G21 G90 G54 G0 X0 Y0\nX1. M222\nM30\n"),
        ("siemens", "G54 G90 G0 X0 Y0\nX1 M222\nM30\n"),
        (
            "heidenhain",
            "0 BEGIN PGM A MM\n1 L X+0 Y+0 FMAX\n2 L X+1 FMAX M222\n3 M30\n4 END PGM A MM\n",
        ),
    ];
    for (control, program) in programs {
        let mut setup = setup(control);
        setup.rules = setup.rules.ignoring("M222", "opens the camera").expect("it can be ignored");
        let mut interpreter = Interpreter::new(program, &setup).expect("a program");
        let steps: Result<Vec<_>, _> = interpreter.by_ref().collect();
        assert_eq!(steps.expect(control).last().expect("a step").end[0], Some(1.0));
        let notes: Vec<String> = interpreter.notes().iter().map(ToString::to_string).collect();
        assert!(
            notes.iter().any(|note| note.contains("M222 is ignored as stated: opens the camera")),
            "{notes:?}"
        );
        assert_eq!(interpreter.survey().count(), 0, "{control}");
    }
}

/// What a block would have changed is not known after it was left out, and what ends a program in it is obeyed.
#[test]
fn what_was_left_out_causes_no_errors() {
    let head = "G21 G90 G17 G40 G54\nT1 M6\nS800 M3\nG0 X0 Y0 Z10.\n";
    let fanuc = |text: &str, expected: &[(usize, &str)]| {
        let text = format!("{head}{text}\nM30\n");
        expect("fanuc", &text, expected);
    };
    // Values that come from it.
    fanuc("IF[#500EQ1]THEN#105=2.\nX#105", &[(5, "P0210 #500")]);
    fanuc("N10#106=#501\nX#106\nG54.1 P#106\nGOTO#106", &[(5, "P0210 #501")]);
    fanuc("#0109=#500\n# 112=#500\nX[10./#109]\nX#112", &[(5, "P0210 #500"), (6, "P0210 #500")]);
    fanuc("#[100+10]=#500\nX#110", &[(5, "P0210 #500")]);
    fanuc("G65 P2000 A#500\nX#101", &[(5, "P0210 #500")]);
    // A variable that was only read there is found.
    fanuc("#5=#501+#502\nX#502", &[(5, "P0210 #501"), (6, "P0210 #502")]);
    // The modes of a block that was left out.
    fanuc("G83 X0 Y0 Z-5. R2. F100.\nX10.\nX20.\nG80", &[(5, "P0119 G83")]);
    fanuc("G81 X5. Z-1. R2. F100. ?\nX10.\nG80", &[(5, "P0101")]);
    fanuc("T2 M6 ?\nG43\nG41 X5.", &[(5, "P0101")]);
    fanuc("G1 X5. F100. ,R2.\nY5. ?\nG0 Z50.", &[(6, "P0101")]);
    // The end of a program or a subprogram.
    let program = format!("{head}M130\nM5 M30 ?\nO2\nX[10./#3]\nM98 P777\nM99\n");
    expect("fanuc", &program, &[(5, "P0114 M130"), (6, "P0101")]);
    let program =
        format!("{head}M98 P2000\nM131\nM30\nO2000\nG0 X1.\nM99 ?\nO3000\nX[10./#1]\nM99\n");
    expect("fanuc", &program, &[(10, "P0101"), (6, "P0114 M131")]);
    // A subprogram that repeats a block with a word that is not read.
    let program = format!("{head}M98 P2000 L3\nX#100\nM131\nM30\nO2000\n#100=1\nX5. M99 M132\n");
    expect("fanuc", &program, &[(11, "P0114 M132"), (7, "P0114 M131")]);
    let program = format!("{head}#6=0\nM130\nN10 #6=#6+1 M131\nIF[#6LT3]GOTO10\nM132\nM30\n");
    expect("fanuc", &program, &[(6, "P0114 M130"), (7, "P0114 M131"), (9, "P0114 M132")]);
    let siemens = "G17 G90 G54 G40\nT1 M6\nS800 M3\nG0 X0 Y0 Z10\n";
    let siemens = |text: &str, expected: &[(usize, &str)]| {
        expect("siemens", &format!("{siemens}{text}\nM30\n"), expected);
    };
    siemens("R01=R50\nX=R1\nR[2]=R51\nX=R2", &[(5, "P0210 R50"), (7, "P0210 R51")]);
    siemens("DEF REAL BB\nBB=R50\nR8=10/BB\nX=R8", &[(6, "P0210 R50")]);
    siemens("R1=R5+R6\nX=R6", &[(5, "P0210 R5"), (6, "P0210 R6")]);
    siemens("WHEN TRUE DO M5\nX=ZZ", &[(5, "P0115 WHEN"), (6, "P0115 `ZZ`")]);
    siemens("R1=1\nX#5\nX=R1\nOEM1\nX5", &[(6, "P0104"), (8, "P0115 `OEM1`")]);
    let klartext = "BEGIN PGM A MM\nTOOL CALL 1 Z S1000\nL X+0 Y+0 Z+50 R0 FMAX M3\n";
    let klartext = |text: &str, expected: &[(usize, &str)]| {
        expect("heidenhain", &format!("{klartext}{text}\nM30\nEND PGM A MM\n"), expected);
    };
    klartext("Q01 = Q50\nL X+Q1", &[(4, "P0210 Q50")]);
    klartext("Q1 = Q5 + Q6\nL X+Q6", &[(4, "P0210 Q5"), (5, "P0210 Q6")]);
    klartext("TOOL CALL 2 Z NIX\nL X+5 RL F100\nL X+9\nL R0 X+20", &[(4, "P0110 `NIX`")]);
    klartext(
        "CALL LBL 1\nM222\nM30\nLBL 1\nL X+1 NIX\nLBL 0 NIX\nL X+Q9",
        &[(8, "P0110 `NIX`"), (9, "P0110 `NIX`"), (5, "P0114 M222")],
    );
}

/// Behind a word of the machine's builder, everything is found.
#[test]
fn errors_behind_an_m_word_are_all_found() {
    for (block, message) in [
        ("END1", "P0131"),
        ("X5. R3.", "P0118 R"),
        ("M98 P777", "P0126 O777"),
        ("G2 X4.", "P0301"),
        ("G43 H1. G41", "P0119 G41"),
        ("G64 P3 G2 X1. R5.", "P0120 P"),
    ] {
        let program = format!("G21 G90 G17 G54 F100. G1 X0 Y0\nM130\n{block}\nM30\n");
        let found = errors(&program, &setup("fanuc"));
        assert_eq!(found.len(), 2, "{found:#?}");
        assert_fault(&program, &found[1], 3, message);
    }
}

/// A loop that does not end, or only late, is left, and the program is executed behind it.
#[test]
fn endless_loops_are_left() {
    let head = "G21 G90 G17 G54 G0 X0 Y0\n";
    let fanuc = [
        "#1=0\nWHILE[#1LT3]DO1\nX1.\n#1=#1+#500\nEND1",
        "#1=0\nN10 X1.\n#1=#1+#500\nIF[#1LT3]GOTO10",
    ];
    for text in fanuc {
        let program = format!("{head}{text}\nM130\nM30\n");
        let found = errors(&program, &setup("fanuc"));
        assert!(is_fault(found.last().expect("errors"), "P0114 M130"), "{found:#?}\n{program}");
    }
    let siemens =
        "G90 G17 G54 G0 X0 Y0\nR1=0\nAGAIN: X1\nR1=R1+R50\nIF R1<3 GOTOB AGAIN\nM131\nM30\n";
    expect("siemens", siemens, &[(4, "P0210 R50"), (6, "P0114 M131")]);
    let siemens = "G90 G17 G54 G0 X0 Y0\nM130\nFOR R1=1 TO 90000\nX1\nX2\nENDFOR\nM131\nM30\n";
    expect("siemens", siemens, &[(2, "P0114 M130"), (7, "P0114 M131")]);
    let klartext = "BEGIN PGM A MM\nL X+0 Y+0 FMAX\nQ1 = 0\nLBL 1\nQ1 = Q1 + Q50\nFN 12: IF +Q1 LT +3 GOTO LBL 1\nM222\nM30\nEND PGM A MM\n";
    expect("heidenhain", klartext, &[(5, "P0210 Q50"), (7, "P0114 M222")]);
}

/// Letters that other words of the block use stay theirs beside an ignored word.
#[test]
fn an_ignored_word_takes_no_letter_of_another_word() {
    let blocks = [
        "G83 X5. Z-1. R2. Q1. F100.",
        "G1 F100. X1.\nG2 X4. R2.",
        "G43 H2 Z10.",
        "G4 P100",
        "M98 P7",
    ];
    for block in blocks {
        for control in ["haas", "fanuc", "linuxcnc"] {
            let plain = format!("G21 G90 G17 G54 T1 M6\nG0 X0 Y0 Z0\n{block}\nM30\nO7\nX1.\nM99\n");
            let with = plain.replace(block, &format!("{block} M130"));
            let mut setup = setup(control);
            setup.lengths = [(1, 50.0), (2, 70.0)].into();
            setup.rules = setup.rules.ignoring("M130", "a camera").expect("it can be ignored");
            let steps = |text: &str| {
                Interpreter::new(text, &setup).expect("a program").collect::<Result<Vec<_>, _>>()
            };
            let (Ok(plain), with) = (steps(&plain), steps(&with)) else { continue };
            // M98 has a block of its own on LinuxCNC.
            if block != "M98 P7" || control != "linuxcnc" {
                assert_eq!(with.expect("the same"), plain, "{block}");
            }
        }
    }
    let native = "G54 G90 G0 X0 Y0\nR1=1\nX1 M130 P5\nM30\n";
    let mut setup = setup("siemens");
    setup.rules = setup.rules.ignoring("M130", "a camera").expect("it can be ignored");
    for step in Interpreter::new(native, &setup).expect("a program") {
        step.expect("P is its own");
    }
}

/// A loop whose condition is not known is executed once.
#[test]
fn loops_without_a_known_end_are_left() {
    let body = "X1.\nM130\nX0\n";
    let fanuc = format!("G21 G90 G0 X0 Y0\nWHILE[#500LT3]DO1\n{body}END1\nM131\nM30\n");
    expect("fanuc", &fanuc, &[(2, "P0210 #500"), (4, "P0114 M130"), (7, "P0114 M131")]);
    for head in ["while [#500 LT 3]", "repeat [#500]"] {
        let end = head.split(' ').next().expect("a word");
        let linuxcnc = format!("G21 G90 G0 X0 Y0\no1 {head}\n{body}o1 end{end}\nM131\nM30\n");
        expect("linuxcnc", &linuxcnc, &[(2, "P0210 #500"), (4, "P0114 M130"), (7, "P0114 M131")]);
    }
    for (head, end) in [("WHILE R5<3", "ENDWHILE"), ("FOR R1=1 TO R5", "ENDFOR")] {
        let sinumerik = format!("G54 G90 G0 X0 Y0\n{head}\nX1.\nWAITM(1)\nX0\n{end}\nM131\nM30\n");
        expect("siemens", &sinumerik, &[(2, "P0210 R5"), (4, "P0115 WAITM"), (7, "P0114 M131")]);
    }
    // The body of one whose end is known has its words once.
    let known =
        format!("G21 G90 G0 X0 Y0\n#1=0\nWHILE[#1LT3]DO1\n#1=#1+1\n{body}END1\nM131\nM30\n");
    expect("fanuc", &known, &[(6, "P0114 M130"), (9, "P0114 M131")]);
}

/// Blocks of a called file are executed where it is called, those of another one are not.
#[test]
fn words_of_a_called_file_are_found_with_those_of_the_program() {
    let files = [("7.nc", "X1.\nG778\nM99\n"), ("9.nc", "G779\nM99\n")];
    let file = |(name, text): (&str, &str)| SubprogramFile {
        name: name.to_owned(),
        text: Arc::from(text),
    };
    let setup = ControlSetup { subprograms: files.map(file).to_vec(), ..setup("fanuc") };
    let program = "G21 G90 G0 X0 Y0\nM98 P7\nG777\nM30\n";
    let found = errors(program, &setup);
    assert_fault(program, &found[0], 2, "P0114 7.nc, line 2: G778");
    assert_fault(program, &found[1], 3, "P0114 G777");
    assert_eq!(found.len(), 2);
}

/// Returns a text with further lines, each before that of a number from 0 on.
fn with_lines(text: &str, lines: &[(usize, &str)]) -> String {
    let mut found = String::new();
    for (number, line) in text.lines().enumerate() {
        for (_, planted) in lines.iter().filter(|(before, _)| *before == number) {
            found += planted;
            found.push('\n');
        }
        found += line;
        found.push('\n');
    }
    found
}

/// Plants lines that are not read into programs: a survey finds those that are executed, and nothing else.
pub(crate) fn assert_planted_are_found(seeds: &[Seed], planted: [&str; 3]) {
    let mut count = 0;
    for Seed { text, setups } in seeds {
        let setup = &setups[0];
        let stops = |text: &str| {
            Interpreter::new(text, setup).ok().is_some_and(|mut found| found.any(|s| s.is_err()))
        };
        let lines = text.lines().count();
        let is_executed: Vec<[bool; 3]> = (0..lines)
            .map(|line| planted.map(|planted| stops(&with_lines(text, &[(line, planted)]))))
            .collect();
        // The head of the program stays before them.
        for first in 4..lines {
            for second in first + 1..lines {
                let third = 4 + (second + first * 7) % (lines - 4);
                let places = [first, second, third];
                // In Klartext, blocks have several lines, and corners stand between two motions.
                let is_within = |place: usize| {
                    let [before, after] =
                        [place - 1, place].map(|line| text.lines().nth(line).unwrap_or(""));
                    before.ends_with('~') || after.contains("RND") || after.contains("CHF")
                };
                if places.into_iter().any(is_within) {
                    continue;
                }
                let plants: Vec<(usize, &str)> = places.into_iter().zip(planted).collect();
                let broken = with_lines(text, &plants);
                if Interpreter::new(&broken, setup).is_err() || !stops(&broken) {
                    continue;
                }
                let found = errors(&broken, setup);
                let mut expected: Vec<(usize, &str)> = (0..3)
                    .filter(|index| is_executed[places[*index]][*index])
                    .map(|index| {
                        let (place, planted) = plants[index];
                        let before = |(other, (at, _)): &(usize, &(usize, &str))| {
                            *at < place || *at == place && *other < index
                        };
                        (place + 1 + plants.iter().enumerate().filter(before).count(), planted)
                    })
                    .collect();
                expected.sort_unstable();
                let mut lines: Vec<usize> = found.iter().map(|error| error.line).collect();
                lines.sort_unstable();
                let expected: Vec<usize> = expected.iter().map(|(line, _)| *line).collect();
                let sentences: Vec<String> = found.iter().map(ToString::to_string).collect();
                assert_eq!(lines, expected, "{sentences:#?}\n{broken}");
                count += 1;
            }
        }
    }
    println!("{count} programs with planted lines");
    assert!(count > 100);
}
