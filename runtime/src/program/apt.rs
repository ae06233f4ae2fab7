//! APT-CL: the cutter location files that CAM systems write before a machine is chosen.
//!
//! Read are `GOTO/x,y,z[,i,j,k]` and `FROM/` (the tip, and the unit vector from the tip to the
//! spindle; without one, the last given stays, `0,0,1` at first), `RAPID` (for the next `GOTO`),
//! `MULTAX/OFF` (the axis is `0,0,1` again), `UNITS`, and `FINI`, which must end the program, so
//! that a file cut short is never taken for a whole one. `$$` opens a comment, a trailing `$`
//! continues the statement, `;` separates two, and case does not matter.
//!
//! A word that moves the tool or its coordinates in another way is refused; any other word is
//! reported in [`Program::ignored`](super::Program::ignored).

use super::{Fault, Located, Stop, Tape, axis_pose, lines, number, shown};
use crate::Unit;
use std::mem;

/// Words that say nothing of where the tool is.
#[rustfmt::skip]
const SILENT: [&str; 10] = [
    "PARTNO", "PPRINT", "REMARK", "CUTTER", "LOADTL", "SPINDL", "FEDRAT", "COOLNT", "TOOL PATH",
    "END-OF-PATH",
];

/// Words whose line is prose to its end: neither `$` nor `;` means anything in it.
const PROSE: [&str; 5] = ["PARTNO", "PPRINT", "REMARK", "INSERT", "LETTER"];

/// Words that move the tool, or decide whether and how often it moves.
#[rustfmt::skip]
const MOVES: [&str; 32] = [
    "GODLTA", "GO", "GOFWD", "GOBACK", "GOLFT", "GORGT", "GOUP", "GODOWN", "GOHOME", "GOCLER",
    "TLON", "TLLFT", "TLRGT", "TLAXIS", "CIRCLE", "MOVARC", "HELIX", "NURBS", "SPLINE", "THREAD",
    "CYCLE", "POCKET", "SCURV", "RETRCT", "CALL", "MACRO", "TERMAC", "LOOPST", "JUMPTO", "RUN",
    "COPY", "DNTCUT",
];

/// Words that move what positions are measured in, or the part under the tool.
const FRAMES: [&str; 6] = ["MSYS", "TRACUT", "TRANS", "ROTABL", "ROTHED", "ROTATE"];

/// The positions of an APT-CL program.
pub(super) fn read(text: &str) -> Result<Tape, Located> {
    let (statements, cut) = statements(text);
    let mut reader = Reader::default();
    let mut end = 0;
    for (index, (line, statement)) in statements.iter().enumerate() {
        let is_last = cut.is_none() && index + 1 == statements.len();
        reader.statement(*line, statement, is_last).map_err(|fault| (*line, fault))?;
        end = *line;
    }
    let whole = reader.finished && cut.is_none();
    if whole || reader.tape.stops.is_empty() && cut.is_none() {
        Ok(reader.tape)
    } else {
        Err((cut.unwrap_or(end), Fault::Unfinished))
    }
}

/// Whether a line is prose to its end.
pub(super) fn is_prose(line: &str) -> bool {
    line.get(..6).is_some_and(|word| PROSE.iter().any(|prose| word.eq_ignore_ascii_case(prose)))
}

/// The statements, each with the line it begins on; and that of a last one whose continuation
/// the file does not hold.
fn statements(text: &str) -> (Vec<(usize, String)>, Option<usize>) {
    let mut statements = Vec::new();
    let mut open: Option<(usize, String)> = None;
    for (line, raw) in lines(text) {
        if open.is_none() && is_prose(raw) {
            statements.push((line, raw.to_owned()));
            continue;
        }
        let code = raw.split_once("$$").map_or(raw, |(code, _)| code.trim_end());
        if code.is_empty() {
            continue;
        }
        let (start, mut whole) = open.take().unwrap_or((line, String::new()));
        if let Some(part) = code.strip_suffix('$') {
            whole.push_str(part);
            whole.push(' ');
            open = Some((start, whole));
        } else {
            whole.push_str(code);
            let parts = whole.split(';').map(str::trim).filter(|part| !part.is_empty());
            statements.extend(parts.map(|part| (start, part.to_owned())));
        }
    }
    (statements, open.map(|(start, _)| start))
}

/// What the statements so far have set.
#[derive(Default)]
struct Reader {
    tape: Tape,
    axis: Option<[f64; 3]>,
    rapid: bool,
    finished: bool,
}

impl Reader {
    /// Takes one statement; a position that `is_last` in the file and cannot be read was cut.
    fn statement(&mut self, line: usize, text: &str, is_last: bool) -> Result<(), Fault> {
        if self.finished && !is_prose(text) {
            return Err(Fault::AfterEnd);
        }
        let (head, rest) = text.split_once('/').unwrap_or((text, ""));
        let word = head.split_whitespace().collect::<Vec<_>>().join(" ").to_ascii_uppercase();
        let rest = rest.trim();
        let cut = |fault| if is_last { Fault::Unfinished } else { fault };
        match word.as_str() {
            "GOTO" => {
                let rapid = mem::take(&mut self.rapid);
                self.position(line, "GOTO", rest, rapid).map_err(cut)?;
            }
            "FROM" => self.position(line, "FROM", rest, true).map_err(cut)?,
            "RAPID" => self.rapid = true,
            "MULTAX" => self.multax(rest)?,
            "UNITS" => self.units(line, rest)?,
            "FINI" => self.finished = true,
            "CYCLE" if rest.eq_ignore_ascii_case("OFF") => {}
            "MSYS" if is_identity(rest) => {}
            other => self.other(line, text, other)?,
        }
        Ok(())
    }

    fn position(
        &mut self,
        line: usize,
        word: &'static str,
        rest: &str,
        rapid: bool,
    ) -> Result<(), Fault> {
        if rest.is_empty() {
            return Err(Fault::Count { word, found: 0 });
        }
        let values = rest.split(',').map(number).collect::<Result<Vec<f64>, Fault>>()?;
        let (tip, axis) = match values[..] {
            [x, y, z] => ([x, y, z], self.axis.unwrap_or([0.0, 0.0, 1.0])),
            [x, y, z, i, j, k] => ([x, y, z], [i, j, k]),
            _ => {
                return Err(Fault::Count { word, found: values.len() });
            }
        };
        let pose = axis_pose(tip, axis)?;
        self.axis = Some(axis);
        self.tape.stops.push(Stop { line, pose, rapid });
        Ok(())
    }

    fn multax(&mut self, argument: &str) -> Result<(), Fault> {
        match argument.to_ascii_uppercase().as_str() {
            "" | "ON" => {}
            "OFF" => self.axis = None,
            _ => {
                return Err(Fault::Multax { argument: bare(argument) });
            }
        }
        Ok(())
    }

    fn units(&mut self, line: usize, word: &str) -> Result<(), Fault> {
        let to = match word.to_ascii_uppercase().as_str() {
            "MM" | "MMS" => Unit::Millimetre,
            "IN" | "INCH" | "INCHES" => Unit::Inch,
            _ => return Err(Fault::UnknownUnit { unit: bare(word) }),
        };
        match self.tape.unit {
            Some((from, _)) if from != to => Err(Fault::UnitChanges { from, to }),
            Some(_) => Ok(()),
            None if !self.tape.stops.is_empty() => Err(Fault::UnitLate),
            None => {
                self.tape.unit = Some((to, line));
                Ok(())
            }
        }
    }

    /// A word that is none of those read: harmless, refused, or reported.
    fn other(&mut self, line: usize, text: &str, word: &str) -> Result<(), Fault> {
        if is_prose(text) {
            let prose = word.get(..6).unwrap_or(word);
            if !SILENT.contains(&prose) {
                self.tape.ignored.push((line, prose.to_owned()));
            }
            return Ok(());
        }
        if SILENT.contains(&word) {
            return Ok(());
        }
        // A definition of geometry, `C1 = CIRCLE/...`, moves nothing; `TLLFT,GOFWD/...` does, and
        // so does what follows a label or a number, `L1) GOTO/...`.
        let is_definition = word.contains('=');
        let mut words = word.split([' ', ')', ',']);
        let first = words.next().unwrap_or(word);
        let major = words.next_back().filter(|_| text.contains('/')).unwrap_or(first);
        if is_definition {
            self.tape.ignored.push((line, bare(word)));
        } else if FRAMES.contains(&major) {
            return Err(Fault::Frame { word: major.to_owned() });
        } else if MOVES.contains(&major) {
            return Err(Fault::Moves { word: major.to_owned() });
        } else if first == "GOTO" || ["GOTO", "FROM", "UNITS"].contains(&major) {
            return Err(Fault::Malformed { statement: shown(text) });
        } else {
            self.tape.ignored.push((line, bare(word)));
        }
        Ok(())
    }
}

/// Whether `MSYS` names the part's own coordinates: its origin, x axis and y axis.
fn is_identity(rest: &str) -> bool {
    const IDENTITY: [f64; 9] = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    let values = rest.split(',').map(number).collect::<Result<Vec<f64>, Fault>>();
    values.is_ok_and(|values| values == IDENTITY)
}

/// What [`shown`] gives, without its quotes; nothing for nothing.
fn bare(text: &str) -> String {
    if text.is_empty() { String::new() } else { shown(text).trim_matches('`').to_owned() }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{refusal, shared};
    use crate::Unit;
    use crate::program::Program;
    use nalgebra::{Point3, Vector3};

    fn program(text: &str) -> Program {
        Program::parse(text, "part.cl").expect("it is a program")
    }

    #[test]
    fn reads_the_impeller() {
        let Some(path) = shared("impeller_flank.apt") else {
            return;
        };
        let program = Program::read(path).expect("it is a program");
        assert_eq!(program.unit, Some(Unit::Millimetre));
        assert_eq!(program.ignored, []);
        let cutting = program.stops.iter().filter(|stop| !stop.rapid).count();
        assert_eq!((cutting, program.stops.len()), (1274, 1302));
        let first = program.stops[0];
        assert!(first.rapid);
        assert_eq!(first.line, 9);
        assert_eq!(first.pose.tip(), Point3::new(34.73109, 4.67398, 21.56186));
        let axis = Vector3::new(0.9912089, 0.1320835, -0.0076686);
        assert!((first.pose.axis() - axis).norm() < 1e-7);
        assert!(program.check_unit(Unit::Millimetre).is_ok());
    }

    #[test]
    fn keeps_the_last_axis() {
        let text = "GOTO/1,2,3\nGOTO/4,5,6,1,0,0\nGOTO/7,8,9\nMULTAX\nGOTO/1,1,1\nMULTAX/OFF\n\
                    GOTO/2,2,2\nFINI\n";
        let axes: Vec<_> = program(text).stops.iter().map(|stop| stop.pose.axis()).collect();
        let [x, z] = [Vector3::x(), Vector3::z()];
        assert_eq!(axes, [z, x, x, x, z]);
    }

    #[test]
    fn rapid_holds_for_one_goto() {
        let text = "FROM/0,0,9\nRAPID\nGOTO/1,2,3\ngoto / 4 , 5 , 6\nRAPID;GOTO/7,8,9\nFINI";
        let stops: Vec<_> =
            program(text).stops.iter().map(|stop| (stop.line, stop.rapid)).collect();
        assert_eq!(stops, [(1, true), (3, true), (4, false), (5, true)]);
    }

    #[test]
    fn reads_comments_and_continuations() {
        let text = "$$ from the CAM\r\nPARTNO/A $ IS NO CONTINUATION $\r\nunits/inches $$ said\r\n\
                    GOTO/1.5, $\r\n  $$ between\r\n 2.5,-.5$\r\n,0,1,0\r\nFINI\r\nREMARK bye\r\n";
        let program = program(text);
        assert_eq!(program.unit, Some(Unit::Inch));
        assert_eq!(program.stops.len(), 1);
        assert_eq!(program.stops[0].line, 4);
        assert_eq!(program.stops[0].pose.tip(), Point3::new(1.5, 2.5, -0.5));
        assert_eq!(program.stops[0].pose.axis(), Vector3::y());
    }

    #[test]
    fn reports_what_it_ignores() {
        let text = "TOOL PATH/A,TOOL,B\nMSYS/0.,0,0,1,0,0,0,1,0\nTLDATA/MILL,2\nPPRINT hi\n\
                    CYCLE/OFF\nINSERT M8\nC1 = CIRCLE/0,0,1\nGOTO/1,2,3\nEND-OF-PATH\nFINI\n";
        let said: Vec<_> = program(text).ignored;
        let expected = [(3, "TLDATA"), (6, "INSERT"), (7, "C1 = CIRCLE")];
        assert_eq!(said, expected.map(|(line, word)| (line, word.to_owned())));
    }

    #[test]
    fn holds_the_program_to_the_part() {
        let program = program("\nUNITS/MMS\nGOTO/1,2,3\nFINI\n");
        assert_eq!(
            program.check_unit(Unit::Inch).expect_err("they differ").to_string(),
            "part.cl:2: UNITS says mm, but the part is in inch: load the part in mm, or post the \
             program in inch"
        );
    }

    #[test]
    fn every_refusal_names_its_line_and_remedy() {
        let moves = "moves the tool in a way that is not read: post the program as GOTO points";
        let frame = "moves the coordinates: post the program as GOTO points in the part's own";
        let unfinished =
            "the program stops here without FINI: post it again, or add FINI if this is the end";
        let numbers = "numbers: write GOTO/x,y,z or GOTO/x,y,z,i,j,k";
        let malformed = "is not understood: write GOTO/x,y,z,i,j,k, with nothing before it";
        let infinite = "is not a finite number: correct it or remove the position";
        for (body, message) in [
            ("GODLTA/0,0,1\nFINI", format!("2: GODLTA {moves}")),
            ("TLLFT, gofwd / L1,PAST,L2\nFINI", format!("2: GOFWD {moves}")),
            ("L1) CYCLE/DRILL,5\nFINI", format!("2: CYCLE {moves}")),
            ("MSYS/0,0,5,1,0,0,0,1,0\nFINI", format!("2: MSYS {frame}")),
            ("0010 GOTO/1,2,3\nFINI", format!("2: `0010 GOTO/1,2,3` {malformed}")),
            ("GOTO 1,2,3\nFINI", format!("2: `GOTO 1,2,3` {malformed}")),
            ("GOTO/1,2\nFINI", format!("2: GOTO has 2 {numbers}")),
            ("GOTO\nFINI", format!("2: GOTO has 0 {numbers}")),
            ("GOTO/1,2,1e999\nFINI", format!("2: `1e999` {infinite}")),
            ("GOTO/1,NaN,3\nFINI", format!("2: `NaN` {infinite}")),
            (
                "GOTO/P1\nFINI",
                "2: `P1` is not a number: write a plain number with a decimal point".to_owned(),
            ),
            (
                "GOTO/1,2,3,0,0,0\nFINI",
                "2: the axis i,j,k is zero and points nowhere: give the unit vector from the tip \
                 to the spindle"
                    .to_owned(),
            ),
            (
                "GOTO/1,2,3,0,3,4\nFINI",
                "2: the axis has norm 5: give a unit vector (within 0.001 of 1)".to_owned(),
            ),
            (
                "MULTAX/3\nFINI",
                "2: MULTAX/3 is not understood: write MULTAX/ON or MULTAX/OFF".to_owned(),
            ),
            (
                "UNITS/CM\nFINI",
                "2: UNITS/CM is not supported: post the program in MM or INCHES".to_owned(),
            ),
            (
                "UNITS/INCH\nFINI",
                "2: UNITS changes from mm to inch: post the whole program in one unit".to_owned(),
            ),
            ("GOTO/1,2,3\n\n", format!("2: {unfinished}")),
            ("GOTO/1,2,3\nGOTO/4,5", format!("3: {unfinished}")),
            ("GOTO/1,2,3\nGOTO/4,5,6,0,0.7", format!("3: {unfinished}")),
            ("GOTO/1,2,3,$\n0,0,1$", format!("2: {unfinished}")),
            ("GOTO/1,2,3\nFIN", format!("3: {unfinished}")),
            (
                "GOTO/1,2,3\nFINI\n\nPPRINT BYE\nGOTO/1,2,3",
                "6: a statement follows FINI: give one program per file".to_owned(),
            ),
        ] {
            let text = format!("UNITS/MM\n{body}");
            assert_eq!(refusal(&text), format!("part.cl:{message}"), "{text:?}");
        }
        assert_eq!(
            refusal("GOTO/1,2,3\nUNITS/MM\nFINI"),
            "part.cl:2: UNITS comes after the first position: state it before"
        );
    }

    /// No file cut short is taken for a whole one.
    #[test]
    fn no_beginning_is_a_program() {
        let whole = "PARTNO/A\nUNITS/MM\nRAPID\nGOTO/1,2,3,0,0,1\nGOTO/4,5,6,$\n0,1,0\nFINI";
        assert_eq!(program(whole).stops.len(), 2);
        for end in 0..whole.len() {
            assert!(Program::parse(&whole[..end], "part.cl").is_err(), "{:?}", &whole[..end]);
        }
    }
}
