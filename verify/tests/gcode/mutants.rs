//! Damaged programs: the interpreter ends with steps or with an error that names a line, whatever it reads.

use super::survey::assert_planted_are_found;
use crate::frozen::Frozen;
use rand_core::{Rng, SeedableRng};
use rand_pcg::Pcg64Mcg;
use std::collections::BTreeMap;
use std::f64::consts::TAU;
use std::fmt::Write as _;
use touchoff_verify::gcode::{
    Choice, ControlRules, ControlSetup, ControlState, GcodeError, Interpreter, Rule, Step,
    StepPath, SubprogramFile,
};

const THREE_AXES: &str = "%\nO1000 (PLATE)\nN10 G17 G21 G40 G49 G80 G90 G94 G98\nN20 G91 G28 Z0.\nN30 T1 M6\n\
    N40 G54 G90 G0 X10. Y10. S3000 M3\nN50 G43 H1 Z50. M8\nN60 G99 G81 R2. Z-12.5 F150.\nN70 X20.\nN80 G98 Y20.\n\
    N90 G80\nN100 G83 X5. Y5. R2. Z-20. Q4. F80.\nN110 G80 G0 Z50.\nN120 X0. Y0.\nN130 G1 Z-2. F200.\n\
    N140 G2 X10. Y10. R10.\nN150 G3 X0. Y20. I-10. J0.\nN160 G3 I5. Z-3. P2\n/N170 M1\nN180 M98 P2000 L3\n\
    N190 G18 G2 X5. Z2. R25. F100.\nN200 G17 G0 Z50. M9\nN210 G53 Z0.\nN220 M30\nO2000\nG91 G1 X1.5 F100.\n\
    G52 X1.\nM98 P3000 L2\nG90\nM99\nO3000\nG91 Y0.25\nG90\nM99\n%\n";

const FIVE_AXES: &str = "G21 G90 G17 G94\nT5 M6\nG54\nG0 X0. Y0. Z100. A0. B0. C0.\nG43.4 H5 Z50.\n\
    G1 X1.5 Y-2.25 Z10. A-15.5 C30. F1200.\nX2.5 Y-2.5 Z9.75 A-16.25 C33.125\nG2 X5. Y0. I1.25 J1.25 A-17.\n\
    X6. Y1. R4. C40.\nG49\nG43.5 H5\nG1 X1. Y1. Z20. I0. J0.5 K0.866 F500.\nX2. I0.1 J0.5 K0.86\nG49\nG91 G28 Z0.\n\
    G90\nM30\n";

const TILTED: &str = "G20 G90\nG55\nT2 M6\n#1 = 2.5\n#<depth> = [0.125 * #1 - 1.]\nG68.2 X1. Y2. Z-0.5 I30. J45. K-90.\n\
    G53.1\nG0 G43 H2 X0 Y0 Z2.\nG81 X[#1/2] Y.5 Z#<depth> R.1 F10.\nX1.5\nG80\nG69\nG68 X0 Y0 R30.\nG1 X1. Y0. F20.\nG69\n\
    G0 X1 Y0\nG92 X0\nG1 X-.5 Y0\nG92.1\nG10 L2 P2 X1. Y1.\nG0 X0 Y0\nM2\n";

const SINUMERIK: &str = "; FLANK\nG17 G21 G40 G90 G94\nT7 D1 M6\nG54\nG0 X0 Y0 Z100 A0 C0\nTRAORI\nG54\n\
    G1 X10.125 Y5.5 Z2 A10.5 C-20.25 F1000\nX11 Y6 Z1.5 A11 C-21\nG3 X12. Y7. I0.5 J0.5\nTRAFOOF\nG54\nG0 Z100\nM30\n";

const LINUXCNC: &str = "o<hole> sub\n#3=[#31+1]\nG91 G81 X1 Z-2 R-1 L2 F100\nG80 G90\no<hole> endsub\n#31=2\nG21 G64 P0.01\n\
    G0 X0 Y0 Z5\no<hole> call\nM428\nG1 C90 F500\nG1 A20 X#31\nM429\nG0 Z[SQRT[25]*2]\nG30 Z6\nG19 G2 Y1 Z11 J.5 K.5\nM2\n";

const COMPENSATED: &str = "G17 G21 G40 G80 G90\nT1 M6\nG54\nG0 X-20. Y0. Z5.\nG1 G41 D1 X0. F100.\nY10.\nG2 X10. Y20. R10.\n\
    G1 X20.\nZ-1.\nG3 X30. Y30. I0. J10.\nG1 X40.\nG2 X40. Y20. J-5.\nG1 X35.\nY-10.\nX0.\nY0.\nG40 X-20.\nG42 D2\nG1 X0. Y5.\n\
    G2 I20.\nG1 Y20.\nG40\nG0 X0. Y0.\nZ50.\nM30\n";

const MACROS: &str = "O100\nG21 G90 G54\nT1 M6\nG0 X0. Y0. Z50.\n#100=5.\n#1=[#100*2-SQRT[16.]]\nIF [#1 GT 3] GOTO 20\nX99.\n\
    N20 IF [#1 EQ 6.] THEN #101=ABS[-2.5]\nG65 P9010 X#1 Y2. I1. J2. I3. L2\nG66 P9020 A1.5\nX1. Y1.\nX2.\nG67\nM97 P500 L2\n\
    M98 P9030\nX88.\nN700 #110=#5001+#4003\nX[#110 MOD 7] Y[ATAN[1.]/[2.]]\nM30\nN500 G91 X1. Y#101\nG90\nM99\nO9010\n\
    G0 X#24 Y[#25+#7]\nIF [#2 EQ #0] GOTO 5\nX#2\nN5 M99\nO9020\nG1 Z[#1-2.] F100.\nG0 Z5.\nM99\nO9030\nY[ROUND[2.4]]\nM99 P700\n";

const OWORDS: &str = "o<arc> sub\n#<r>=[#1/2]\no1 if [#2 gt 5]\no<arc> return [7]\no1 elseif [#2 eq 2]\ng0 x#<r> y#2\no1 else\n\
    g0 x[#<r> + 1]\no1 endif\no2 repeat [3]\n#31=[#31 + 0.5]\ng1 x#31 y[cos[60 * #31]] f100\no2 endrepeat\no<arc> endsub [#31]\n\
    g21 g90 g54 g61\n#31=1\n#<_depth>=2.5\ng0 x0 y0 z5\no<arc> call [4] [2]\no<arc> call [6] [9]\n\
    g1 z[0 - #<_depth> ** 2 / 4] f50\nx[#<_value> + exists[#<_depth>]]\ny[#5420 mod 3 + #<_z>]\ng0 z[fix[7.5]]\nm2\n";

const SEEDS: [(&str, Choice); 9] = [
    (MACROS, Choice::Iso),
    (OWORDS, Choice::Rs274Ngc),
    (COMPENSATED, Choice::Rs274Ngc),
    (COMPENSATED, Choice::Iso),
    (THREE_AXES, Choice::Rs274Ngc),
    (FIVE_AXES, Choice::Iso),
    (TILTED, Choice::Iso),
    (SINUMERIK, Choice::Sinumerik),
    (LINUXCNC, Choice::Rs274Ngc),
];

/// Pieces that mutations insert.
const PIECES: [&str; 83] = [
    "GOTO 20",
    "IF [",
    "THEN #1=",
    "G65 P9010 A1.",
    "G66 P9020",
    "M97 P500",
    "M99 P20",
    "N20 ",
    "#0",
    "#5001",
    "#<_x>",
    " EQ ",
    " MOD ",
    "ATAN[",
    "o1 else",
    "o1 endif",
    "o2 endrepeat",
    "o<arc> return [1]",
    "G40",
    "G41 D1",
    "G42 D2",
    "G41.1 D.5",
    "G41",
    "D2",
    "G0",
    "G1",
    "G2",
    "G3",
    "G28",
    "G30",
    "G53",
    "G80",
    "G81",
    "G83",
    "G91",
    "G90",
    "G20",
    "G92",
    "G52",
    "G68.2",
    "G69",
    "G43.4",
    "G43.5",
    "G49",
    "G10 L2 P1",
    "G54.1 P9",
    "M98 P1000",
    "M98 P2000 L9999",
    "M98 P9001 L2",
    "G16",
    "G15",
    "G51.1 X1.",
    "G50.1 X0",
    ",R2.",
    ",C1.",
    "M98 <SUB>",
    "M198 P9001",
    "G65 P9001 X1. K2.",
    "o<sub> call [3]",
    "M99",
    "M30",
    "M428",
    "O2000",
    "o<hole> call",
    "o<hole> sub",
    "o1 if [1]",
    "#1=",
    "#<depth>",
    "[",
    "]",
    "(",
    ")",
    ";",
    "%",
    "/",
    "-",
    ".",
    "99999999",
    "0.000001",
    "X",
    "R",
    "\n",
    "\u{e9}",
];

/// A file of subprograms that mutants can call.
const SUBPROGRAM: &str =
    "O9001\nG91 X1.\nG90\nM98 P1000\nM99\no<sub> sub\ng91 x1\ng90\no<hole> call\no<sub> endsub\n";

fn setups(dialect: Choice) -> [ControlSetup; 2] {
    let known = ControlSetup {
        start: [Some(0.0); 6],
        work_offsets: [Some([1.0, 2.0, 3.0, 0.0, 0.0, 0.0]); 9],
        lengths: BTreeMap::from([(1, 80.0), (2, 90.0), (5, 120.0), (7, 60.0)]),
        home: [0.0, 0.0, 400.0, 0.0, 0.0, 0.0].map(Some),
        radius_offsets: BTreeMap::from([(1, 2.0), (2, 3.5)]),
        subprograms: vec![SubprogramFile { name: "sub.ngc".to_owned(), text: SUBPROGRAM.into() }],
        max_repeated: 10_000,
        ..ControlSetup::default()
    };
    let rules = ControlRules::named("haas").expect("a control");
    let rules =
        rules.with(Rule::OptionalBlocks, Choice::LeftOut).with(Rule::Rotary, Choice::Shortest);
    let rules = rules.with(Rule::WholeNumbers, Choice::Units).with(Rule::Unit, Choice::Millimetre);
    let rules = rules.with(Rule::Dialect, dialect).with(Rule::PresetEnd, Choice::EndsPreset);
    let unknown = ControlRules::default().with(Rule::Dialect, dialect);
    let radius_offsets = known.radius_offsets.clone();
    let unknown = ControlSetup {
        rules: unknown,
        radius_offsets,
        max_repeated: 10_000,
        ..ControlSetup::default()
    };
    [ControlSetup { rules, ..known }, unknown]
}

#[test]
fn seeds_are_read() {
    for (seed, dialect) in SEEDS {
        for setup in setups(dialect) {
            let steps =
                Interpreter::new(seed, &setup).expect("a program").collect::<Result<Vec<_>, _>>();
            let count = steps.expect("steps").len();
            assert!(count >= 5, "{count}\n{seed}");
        }
    }
}

/// Returns a text with one to three damages, by pieces that are inserted among others.
fn mutate(seed: &str, pieces: &[&str], random: &mut impl FnMut(usize) -> usize) -> String {
    let mut text: Vec<char> = seed.chars().collect();
    for _ in 0..1 + random(3) {
        let at = random(text.len());
        match random(8) {
            0 => drop(text.remove(at)),
            1 => text.insert(at, char::from(b' ' + random(95) as u8)),
            2 => text[at] = char::from(b'0' + random(10) as u8),
            3 => text[at] = char::from(b'A' + random(26) as u8),
            4 => drop(text.drain(at..(at + 1 + random(30)).min(text.len()))),
            5 => {
                let piece: Vec<char> = text[at..(at + 1 + random(60)).min(text.len())].to_vec();
                let to = random(text.len());
                text.splice(to..to, piece);
            }
            6 => text.truncate(at),
            _ => drop(text.splice(at..at, pieces[random(pieces.len())].chars())),
        }
        if text.is_empty() {
            text.push('X');
        }
    }
    text.into_iter().collect()
}

/// An undamaged program, and the controls that read it in turn.
pub(crate) struct Seed<'a> {
    pub(crate) text: &'a str,
    pub(crate) setups: &'a [ControlSetup],
}

/// Damaged programs of a language.
pub(crate) struct Mutants<'a> {
    /// The file of their frozen outcomes.
    pub(crate) name: &'static str,
    pub(crate) seeds: &'a [Seed<'a>],
    /// What is inserted among others.
    pub(crate) pieces: &'a [&'a str],
    /// Their number without `MUTANTS`.
    pub(crate) default_count: u64,
}

/// Reads `MUTANTS` damaged programs, each with one of its seed's controls. Asserts that each ends with finite steps or with one of its
/// lines, and that they are the frozen ones.
pub(crate) fn read_mutants(mutants: &Mutants) {
    let Mutants { name, seeds, pieces, default_count } = *mutants;
    let count: u64 = match std::env::var("MUTANTS") {
        Ok(text) => text.parse().expect("MUTANTS is a whole number"),
        Err(_) => default_count,
    };
    let mut random = Pcg64Mcg::seed_from_u64(11);
    let mut frozen = Frozen::new(name, 100);
    let mut random =
        |limit: usize| ((u128::from(random.next_u64()) * limit as u128) >> 64) as usize;
    let (mut whole, mut steps, mut others) = (0u64, 0u64, 0u64);
    for index in 0..count {
        let seed = &seeds[random(seeds.len())];
        let text = mutate(seed.text, pieces, &mut random);
        let lines = text.split(['\n', '\r']).count();
        let mut outcome = String::new();
        match Interpreter::new(&text, &seed.setups[index as usize % seed.setups.len()]) {
            Err(error) => {
                write_error(&mut outcome, &error);
                assert!((1..=lines).contains(&error.line), "{error}\n{text}");
            }
            Ok(mut interpreter) => {
                let mut error = None;
                for step in interpreter.by_ref() {
                    match step {
                        Ok(step) => {
                            steps += 1;
                            write_step(&mut outcome, &step);
                            assert_is_finite(&step, &text);
                            assert!((1..=lines).contains(&step.line), "{step:?}\n{text}");
                        }
                        Err(fault) => {
                            write_error(&mut outcome, &fault);
                            error = Some(fault);
                        }
                    }
                }
                assert!(interpreter.next().is_none(), "steps after the end\n{text}");
                match error {
                    None => {
                        for note in interpreter.notes() {
                            let _ = writeln!(outcome, "{note}");
                        }
                        whole += 1;
                    }
                    Some(error) => {
                        assert!((1..=lines).contains(&error.line), "{error}\n{text}");
                        for step in interpreter.survey() {
                            match step {
                                Ok(step) => assert_is_finite(&step, &text),
                                Err(error) => {
                                    others += 1;
                                    assert!((1..=lines).contains(&error.line), "{error}\n{text}");
                                }
                            }
                        }
                    }
                }
            }
        }
        frozen.add(&text, &outcome);
    }
    frozen.assert();
    println!(
        "{count} mutants: {whole} read to the end, {steps} steps, {others} errors behind the first"
    );
    assert!(whole > 0 && whole < count);
}

/// Writes what a motion is to the check.
fn write_step(out: &mut String, step: &Step) {
    let Step { start, end, commanded, path, tool_vector, alignment, spindle, state, .. } = step;
    let flags = [step.rapid, step.absolute, step.is_homeward, step.is_return];
    let block = (step.line, step.within.map(|within| (within.file, within.line)));
    let _ = writeln!(out, "{block:?} {flags:?} {start:.6?} {end:.6?} {commanded:?} {path:.6?}");
    let _ = writeln!(out, "{tool_vector:.6?} {:?} {alignment:?} {spindle:?}", step.shortest);
    let ControlState { tool, length, work_offset, origin, shift, tcp, rotation, .. } = &**state;
    let _ = writeln!(out, "{tool:?} {length:.6?} {work_offset:?} {origin:.6?} {shift:.6?} {tcp:?}");
    let turn = state.origin_rotation;
    let _ = writeln!(out, "{rotation:.6?} {turn:.6} {:?} {}", state.orientation, state.shorter_way);
}

fn write_error(out: &mut String, error: &GcodeError) {
    let _ = writeln!(out, "{} {error}", error.code());
}

fn assert_is_finite(step: &Step, text: &str) {
    let mut numbers = step.start.iter().chain(&step.end).flatten();
    assert!(numbers.all(|value| value.is_finite()), "{step:?}\n{text}");
    if let StepPath::Arc { centre, sweep, .. } = step.path {
        let is_finite = centre[0].is_finite() && centre[1].is_finite();
        assert!(is_finite && sweep.is_finite(), "{step:?}\n{text}");
        assert!(sweep.abs() < 1e9 * TAU, "{step:?}\n{text}");
    }
}

#[test]
fn mutants_end_with_steps_or_with_a_line() {
    let setups = SEEDS.map(|(_, dialect)| setups(dialect));
    let seeds: Vec<Seed> =
        SEEDS.iter().zip(&setups).map(|(&(text, _), setups)| Seed { text, setups }).collect();
    assert_planted_are_found(&seeds, ["M777", "G778", "G10.9"]);
    read_mutants(&Mutants { name: "iso", seeds: &seeds, pieces: &PIECES, default_count: 5_000 });
}
