//! APT-CL: the cutter location files that CAM systems write before a machine is chosen.
//!
//! Read are `GOTO/x,y,z[,i,j,k]` and `FROM/` (the tip, and the unit vector from the tip to the
//! spindle; without one, the last given stays, `0,0,1` at first), `RAPID` (for the next `GOTO`),
//! `MULTAX/OFF` (the axis is `0,0,1` again), `UNITS`, one `LOADTL`, `CUTTER`, and `FINI` or NX's
//! `END-OF-PATH`, which must end the program, so that a file cut short is never taken for a whole one.
//! `$$` opens a comment, a trailing `$` continues the statement, `;` separates two, and case does not
//! matter.
//!
//! Words that can neither move the tool nor change what positions mean are listed in
//! [`Program::ignored`](super::Program::ignored); every other word is refused (`words` has the list).

use super::words::{is_prose, pass_over, refuse_motions};
use super::{Fault, Located, Stop, Tape, axis_pose, lines, number, shown};
use crate::Unit;
use std::collections::BTreeMap;
use std::mem;

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
    let whole = (reader.finished || reader.path_ended) && cut.is_none();
    if whole || reader.tape.stops.is_empty() && cut.is_none() {
        Ok(reader.tape)
    } else {
        Err((cut.unwrap_or(end), Fault::Unfinished))
    }
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
    /// Whether there was a `GOTO`.
    went: bool,
    /// What was said of the tool, by its word: the line, and the arguments.
    tools: BTreeMap<String, (usize, Vec<String>)>,
    path_ended: bool,
    finished: bool,
}

impl Reader {
    /// Takes one statement; a position that `is_last` in the file and cannot be read was cut.
    fn statement(&mut self, line: usize, text: &str, is_last: bool) -> Result<(), Fault> {
        let (head, rest) = text.split_once('/').unwrap_or((text, ""));
        let word = head.split_whitespace().collect::<Vec<_>>().join(" ").to_ascii_uppercase();
        let rest = rest.trim();
        let ended = self.finished || self.path_ended && word != "FINI";
        if ended && !is_prose(text) {
            return Err(Fault::AfterEnd {
                end: if self.finished { "FINI" } else { "END-OF-PATH" },
            });
        }
        let cut = |fault| if is_last { Fault::Unfinished } else { fault };
        match word.as_str() {
            "GOTO" => {
                let rapid = mem::take(&mut self.rapid);
                self.went = true;
                self.position(line, "GOTO", rest, rapid).map_err(cut)?;
            }
            "FROM" => self.position(line, "FROM", rest, true).map_err(cut)?,
            "RAPID" if rest.is_empty() => self.rapid = true,
            "MULTAX" => self.multax(rest)?,
            "UNITS" => self.units(line, rest)?,
            "LOADTL" | "TOOLNO" | "CUTTER" | "TLDATA" | "TOOL PATH" => {
                refuse_motions(&word, rest)?;
                self.tool(line, &word, rest)?;
            }
            // So NX ends the path of an operation; `FINI` may follow.
            "FINI" | "END-OF-PATH" if !rest.is_empty() => return Err(Fault::Swallowed { word }),
            "FINI" => self.finished = true,
            "END-OF-PATH" => self.path_ended = true,
            other => self.other(line, text, other, rest)?,
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

    /// A statement of which tool is at the positions: one of a program, before them.
    fn tool(&mut self, line: usize, word: &str, rest: &str) -> Result<(), Fault> {
        let upper = rest.to_ascii_uppercase();
        let mut arguments: Vec<String> = upper.split(',').map(|part| part.trim().into()).collect();
        if word == "TOOL PATH" {
            // Its name is none of the tool's.
            let tool = arguments.iter().position(|part| part == "TOOL");
            arguments.drain(..tool.unwrap_or(0));
        }
        match self.tools.get(word) {
            Some((first, known)) if *known != arguments || word == "LOADTL" => {
                return Err(Fault::SecondTool { first: *first });
            }
            None if self.went => return Err(Fault::LateTool { word: word.to_owned() }),
            _ => {}
        }
        match (word, &arguments[..]) {
            ("CUTTER", all) => self.cutter(line, all)?,
            // Diameter, corner, height, and the angles of side and end, as NX writes a mill.
            ("TLDATA", [kind, diameter, corner, more @ ..]) if kind == "MILL" => {
                let values = [diameter, corner].map(String::as_str).map(number);
                let [diameter, corner] = [values[0].clone()?, values[1].clone()?];
                let angle = |at: usize| more.get(at).map_or(Ok(0.0), |angle| number(angle));
                let (side, end) = (angle(1)?, angle(2)?);
                let place = [0.5 * diameter - corner, corner];
                let all = vec![diameter, corner, place[0], place[1], end, side];
                self.tape.cutters.push((line, all));
            }
            _ => {}
        }
        if word != "CUTTER" {
            self.tape.ignored.push((line, word.to_owned()));
        }
        self.tools.insert(word.to_owned(), (line, arguments));
        Ok(())
    }

    /// The cutter that positions are of.
    fn cutter(&mut self, line: usize, arguments: &[String]) -> Result<(), Fault> {
        let values =
            arguments.iter().map(|part| number(part)).collect::<Result<Vec<f64>, Fault>>()?;
        self.tape.cutters.push((line, values));
        Ok(())
    }

    /// A word that is none of those read: passed over, or refused.
    fn other(&mut self, line: usize, text: &str, word: &str, rest: &str) -> Result<(), Fault> {
        match pass_over(word, rest) {
            Ok(word) => {
                self.tape.ignored.push((line, word));
                Ok(())
            }
            Err(Fault::UnknownWord { .. })
                if word.split([' ', ')']).any(|part| ["GOTO", "FROM", "UNITS"].contains(&part)) =>
            {
                Err(Fault::Malformed { statement: shown(text) })
            }
            Err(fault) => Err(fault),
        }
    }
}

/// What [`shown`] gives, without its quotes; nothing for nothing.
fn bare(text: &str) -> String {
    if text.is_empty() { String::new() } else { shown(text).trim_matches('`').to_owned() }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{flank, refusal, shared};
    use crate::Unit;
    use crate::program::Program;
    use nalgebra::{Point3, Vector3};
    use std::path::Path;

    fn program(text: &str) -> Program {
        Program::parse(text, "part.cl").expect("it is a program")
    }

    #[test]
    fn reads_a_flank_pass_from_a_file() {
        let folder = tempfile::tempdir().expect("a folder");
        let (text, stops) = flank();
        let path = folder.path().join("flank.apt");
        std::fs::write(&path, &text).expect("a file");
        let program = Program::read(path).expect("it is a program");
        assert_eq!(program.unit, Some(Unit::Millimetre));
        let ignored: Vec<&str> = program.ignored.iter().map(|(_, word)| word.as_str()).collect();
        assert_eq!(ignored, ["PARTNO", "LOADTL", "SPINDL", "FEDRAT"]);
        assert!(program.check_unit(Unit::Millimetre).is_ok());
        assert!(program.check_unit(Unit::Inch).is_err());
        assert_eq!(program.stops.len(), stops.len());
        let lines: Vec<&str> = text.lines().collect();
        for (stop, ([x, y, z, i, j, k], rapid)) in program.stops.iter().zip(stops) {
            assert_eq!((stop.rapid, stop.pose.tip()), (rapid, Point3::new(x, y, z)));
            assert!((stop.pose.axis() - Vector3::new(i, j, k)).norm() < 2e-5);
            assert!(lines[stop.line - 1].starts_with(&format!("GOTO/{x:.5},")));
        }
        if let Some(path) = shared("impeller_flank.apt") {
            the_impeller(&path);
        }
    }

    fn the_impeller(path: &Path) {
        let program = Program::read(path).expect("it is a program");
        assert_eq!(program.unit, Some(Unit::Millimetre));
        let ignored: Vec<&str> = program.ignored.iter().map(|(_, word)| word.as_str()).collect();
        assert_eq!(ignored, ["PARTNO", "LOADTL", "SPINDL", "FEDRAT"]);
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
    fn lists_what_it_passes_over() {
        let text = "TOOL PATH/A,TOOL,B\nMSYS/0.,0,0,1,0,0,0,1,0\nTLDATA/DRILL,2\nPPRINT hi; GOTOX/1\n\
                    CYCLE/OFF\ncutcom / off\nMODE/ABSOL\nLOADTL/3\nFEDRAT/ 250.,MMPM\nGOTO/1,2,3\n\
                    COOLNT/OFF\nEND-OF-PATH\nFINI\n";
        let expected = [
            (1, "TOOL PATH"),
            (2, "MSYS"),
            (3, "TLDATA"),
            (4, "PPRINT"),
            (5, "CYCLE"),
            (6, "CUTCOM"),
            (7, "MODE"),
            (8, "LOADTL"),
            (9, "FEDRAT"),
            (11, "COOLNT"),
        ];
        assert_eq!(program(text).ignored, expected.map(|(line, word)| (line, word.to_owned())));
    }

    /// Words that move the tool, that change what positions mean, and words that nobody knows.
    #[test]
    fn what_could_be_a_motion_is_refused() {
        let words = "GOTOX/1,2,3|GOOT/1,2,3|GO TO/1,2,3|GOABS/1,2,3|LINEAR/1,2,3|MOVE/1,2,3|MOVETO/1,2,3|\
                     ARC/1,2,3|CIRC/1,2,3|ARCDAT/1,2,3|DRILL/1,2,3|GODLT/1,2,3|ORIGIN/0,0,35|CUTCOM/LEFT|\
                     MODE/INCR|THICK/-5|HEAD/2|LOADTL/2|CUTTER/50|INSERT G0 Z-5|LETTER/HI|RAPID/ON|OPSKIP/ON|\
                     TRACUT/M1|C1 = CIRCLE/0,0,1|M1 = MACRO/|AUXFUN/98|PREFUN/91|X|GOTO|TLDATA/MILL,50.,0.";
        for word in words.split('|') {
            let text =
                format!("UNITS/MM\nLOADTL/1\nCUTTER/2,1\nGOTO/1,2,3\n{word}\nGOTO/4,5,6\nFINI\n");
            let said = refusal(&text);
            assert!(said.starts_with("part.cl:5: "), "{word}: {said}");
        }
        for word in [
            "FEDRAT/100 GOTO/0,0,-5",
            "FEDRAT/RAPID",
            "STOP/GOTO/0,0,-5",
            "ISN/5 GODLTA/0,0,-5",
            "TITLES/x$\nGOTO/0,0,-5",
            "FEDRAT/100 GOHOME",
            "FEDRAT/ 5,CYCLE,DRILL,0,0,-5",
            "FEDRAT/ 5 GO TO 0,0,-5",
            "FEDRAT/GOTO(1)",
            "CUT/TLLFT,GOFWD",
            "OPSTOP/GOHOME",
            "TOOLNO/1,GOTO,0,0,-5",
            "FINI/GOTO/0,0,-5",
            "END-OF-PATH/GOTO/0,0,-5",
            "TLAXIS/0,0,1",
            "tldata/mill,50,0,30,0,0",
            "TLDATA/MILL ,50,0",
            "TLDATA/MILL,2,1,30,20,45",
            "TLDATA/BALL,50,25",
            "CUTTER/2,1,0,1,45,30",
            "TOOLNO/2",
            "TOOL PATH/B,TOOL,D50",
            "LOADTL/1",
        ] {
            let text = format!(
                "TOOL PATH/A,TOOL,D2\nTLDATA/MILL,2,1\nTOOLNO/1\nLOADTL/1\nCUTTER/2\nGOTO/1,2,3\n{word}\nFINI\n"
            );
            assert!(refusal(&text).starts_with("part.cl:7: "), "{word}: {}", refusal(&text));
        }
        for word in [
            "LOADTL/1 GOTO/0,0,-5",
            "LOADTL/1 $\nGOTO/0,0,-5",
            "TLDATA/DRILL,2 GOTO/0,0,-5",
            "TLDATA/MILL,2,1,75,0,0,GOTO/0,0,-5",
            "TOOLNO/1,GOTO/0,0,-5",
            "TOOL PATH/A,GODLTA/0,0,-5",
            "TOOL PATH/A GOTO/0,0,-5,TOOL,B",
        ] {
            let said = refusal(format!("FROM/0,0,50\n{word}\nGOTO/0,0,1\nFINI\n"));
            assert!(
                said.starts_with("part.cl:2: ") && said.contains("another statement"),
                "{said}"
            );
        }
        assert_eq!(
            refusal("FROM/0,0,9\nGOTO/1,2,3\nLOADTL/2\nGOTO/4,5,6\nFINI"),
            "part.cl:3: LOADTL comes after positions, which are of another tool: give one program per tool"
        );
        for hidden in ["\u{c}", "\u{b}", "\u{85}", "\u{2028}", "\u{2029}", "\u{1b}"] {
            let said = refusal(format!("GOTO/1,2,3\nFEDRAT/100 {hidden}GOTO/0,0,-5\nFINI"));
            assert!(said.contains("part.cl:2: the character `\\u{"), "{said}");
        }
    }

    #[test]
    fn the_end_of_a_path_of_nx_ends_a_program() {
        let whole = "TOOL PATH/A,TOOL,B\nGOTO/1,2,3\nGOTO/4,5,6\nEND-OF-PATH";
        assert_eq!(program(whole).stops.len(), 2);
        assert_eq!(program(&format!("{whole}\nFINI\n")).stops.len(), 2);
        assert_eq!(
            refusal(format!("{whole}\nTOOL PATH/C,TOOL,D\nGOTO/1,2,3\nEND-OF-PATH\n")),
            "part.cl:5: a statement follows END-OF-PATH: give one program per file"
        );
    }

    #[test]
    fn the_cutter_is_compared_with_the_tool() {
        crate::tool! {
            tool Ball "6 mm" {
                units mm;
                profile {
                    start (0, 0);
                    arc to (3, 3) center (0, 3) as ball cutting;
                    line to (3, 20), (0, 20) as shank;
                }
                niceness cutting: 1;
            }
        }
        use crate::Tool as _;
        let check = |cutter: &str, unit: Unit| {
            let text = format!("{cutter}\nGOTO/1,2,3\nGOTO/4,5,6\nFINI");
            program(&text).check_cutter(Ball.card(), unit).map_err(|error| error.to_string())
        };
        let mm = Unit::Millimetre;
        for same in [
            "CUTTER/6",
            "CUTTER/6.0,3.0",
            "CUTTER/6.,3.,0.,3.,0.,0.,30.",
            "CUTTER/6.001,3",
            "TLDATA/MILL,6.0000,3.0000,30.0000,0.0000,0.0000",
            "UNITS/INCHES\nCUTTER/.23622,.11811",
            "PPRINT none",
        ] {
            assert_eq!(check(same, mm), Ok(None), "{same}");
        }
        assert_eq!(check("CUTTER/.23622,.11811", Unit::Inch), Ok(None));
        for other in ["CUTTER/50", "CUTTER/6,0", "CUTTER/6,3,0,3,0,5", "UNITS/INCHES\nCUTTER/6,3"] {
            assert!(check(other, mm).is_err(), "{other}");
        }
        assert_eq!(
            check("CUTTER/50,1", mm),
            Err("part.cl:1: CUTTER/50,1 is not `Ball`, which is CUTTER/6,3 in mm: give the tool that the \
                 program was made for, or remove the statement to try another"
                .to_owned())
        );
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
        let frame = "changes what positions mean: post the program as GOTO points in the part's coordinates";
        let unknown = "is not understood and could move the tool: post the program as GOTO points, or \
                       remove the statement if it moves nothing";
        let unfinished =
            "the program stops here without FINI: post it again, or add FINI if this is the end";
        let numbers = "numbers: write GOTO/x,y,z or GOTO/x,y,z,i,j,k";
        let malformed = "is not understood: write GOTO/x,y,z,i,j,k, with nothing before it";
        let infinite = "is not a finite number: correct it or remove the position";
        for (body, message) in [
            ("GODLTA/0,0,1\nFINI", format!("2: GODLTA {moves}")),
            ("TLLFT, gofwd / L1,PAST,L2\nFINI", format!("2: TLLFT {moves}")),
            ("GOTOX/1,2,3\nFINI", format!("2: `GOTOX` {unknown}")),
            ("C1 = LINE/P1,P2\nFINI", format!("2: `C1 = LINE` {unknown}")),
            (
                "LOADTL/1\nGOTO/1,2,3\nLOADTL/2\nFINI",
                "4: another tool than that of line 2: give one program per tool".to_owned(),
            ),
            (
                "INSERT G0 Z-5\nFINI",
                "2: INSERT writes to the control what may be a motion: post the program without it"
                    .to_owned(),
            ),
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
            ("GOTO/1,2,3\nFIN", format!("3: `FIN` {unknown}")),
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
