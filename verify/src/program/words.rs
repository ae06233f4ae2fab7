//! Words of APT-CL: those that a reader may pass over, and those that it has to refuse.
//!
//! A word is passed over only if it can neither move the tool nor change the meaning of positions, with any
//! arguments or with the ones given. All other words are refused: an unknown word could be a motion.

use super::{ProgramFault, number};

/// Words whose line is prose to its end: neither `$` nor `;` has a meaning in it.
const PROSE_WORDS: [&str; 3] = ["PARTNO", "PPRINT", "REMARK"];

/// Words that write text to the control verbatim, to the end of the line. The text may contain any motion.
const VERBATIM_WORDS: [&str; 2] = ["INSERT", "LETTER"];

/// Words that can neither move the tool nor change the meaning of positions: names and messages, tolerances
/// that were used in computing the positions, speeds and feeds, coolant, stops and waits, the block numbers and
/// the file of the post-processor, planes that only other words use, displays.
#[rustfmt::skip]
const IGNORED_WORDS: [&str; 35] = [
    "PARTNO", "PPRINT", "REMARK", "TITLES", "MACHIN", "ISN", "SEQNO", "LEADER", "TMARK", "CLPRNT",
    "INTOL", "OUTTOL", "TOLER", "LINTOL", "MCHTOL", "CUT",
    "FEDRAT", "FEDTO", "SPINDL", "COOLNT", "OPSTOP", "STOP", "DELAY", "DWELL", "END", "REWIND",
    "CLEARP", "CLRSRF", "SELCTL", "PAINT", "DISPLY", "PLOT", "NOPLOT", "NOPOST", "VERIFY",

];

/// Words that move the tool, or decide whether and how often it moves.
#[rustfmt::skip]
const MOTION_WORDS: [&str; 49] = [
    "GODLTA", "GO", "GOFWD", "GOBACK", "GOLFT", "GORGT", "GOUP", "GODOWN", "GOHOME", "GOCLER",
    "GOABS", "INDIRP", "INDIRV", "LINEAR", "MOVE", "MOVETO", "ARC", "CIRC", "ARCDAT", "DRILL",
    "TLON", "TLLFT", "TLRGT", "CIRCLE", "MOVARC", "HELIX", "NURBS", "SPLINE", "THREAD", "TAP",
    "BORE", "REAM", "CYCLE", "POCKET", "SCURV", "RETRCT", "RETURN", "PROBE", "CALL", "MACRO",
    "TERMAC", "LOOPST", "LOOPND", "JUMPTO", "RUN", "COPY", "DNTCUT", "OPSKIP", "DELETE",
];

/// Words that change the meaning of positions: their frame, the point of the tool that they refer to, absolute
/// or incremental mode, or the tool and the spindle in use.
#[rustfmt::skip]
const FRAME_WORDS: [&str; 21] = [
    "MSYS", "CSYS", "TRACUT", "TRANS", "ORIGIN", "ROTABL", "ROTHED", "ROTATE", "TLAXIS", "TILT",
    "PLANE", "SCALE", "MIRROR", "CUTCOM", "OFSTNO", "FIXOFF", "THICK", "OFFSET", "MODE", "HEAD",
    "TURRET",
];

/// Words of motions that are read. No argument may be one of them, or a motion that begins with `GO`.
const POSITION_WORDS: [&str; 3] = ["GOTO", "FROM", "RAPID"];

/// Returns whether a line is prose to its end.
pub(super) fn is_prose(line: &str) -> bool {
    PROSE_WORDS
        .iter()
        .chain(&VERBATIM_WORDS)
        .any(|prose| line.get(..prose.len()).is_some_and(|word| word.eq_ignore_ascii_case(prose)))
}

/// Decides whether a statement may be passed over, and returns its word. `word` is in capitals, with one space
/// between its parts.
///
/// # Errors
/// If the word moves the tool, changes the meaning of positions, or is not known to do neither; if its
/// arguments contain another statement.
pub(super) fn skip_statement(word: &str, arguments: &str) -> Result<String, ProgramFault> {
    // Prose need not have a `/`.
    if let Some(prose) = PROSE_WORDS.iter().find(|prose| word.starts_with(**prose)) {
        return Ok((*prose).to_owned());
    }
    if let Some(verbatim) = VERBATIM_WORDS.iter().find(|verbatim| word.starts_with(**verbatim)) {
        return Err(ProgramFault::Verbatim { word: (*verbatim).to_owned() });
    }
    if IGNORED_WORDS.contains(&word) || is_inert_with(word, arguments) {
        refuse_motions(word, arguments)?;
        let moves = |part: &str| MOTION_WORDS.contains(&part) || FRAME_WORDS.contains(&part);
        return match parts(&arguments.to_ascii_uppercase()).any(moves) {
            true => Err(ProgramFault::Swallowed { word: word.to_owned() }),
            false => Ok(word.to_owned()),
        };
    }
    if is_g_code(word) {
        return Err(ProgramFault::GCode { block: super::shown(word) });
    }
    // `TLLFT,GOFWD/...` and `L1) GOTO/...` are motions as well.
    let known = |list: &[&str]| {
        word.split([' ', ')', ',', '=']).find(|part| list.contains(part)).map(str::to_owned)
    };
    if let Some(word) = known(&FRAME_WORDS) {
        return Err(ProgramFault::Frame { word });
    }
    match known(&MOTION_WORDS) {
        Some(word) => Err(ProgramFault::Moves { word }),
        None => Err(ProgramFault::UnknownWord { word: super::shown(word) }),
    }
}

/// Returns the words and numbers among arguments.
fn parts(arguments: &str) -> impl Iterator<Item = &str> {
    arguments.split([' ', ',', '\t', '(', ')', '=']).filter(|part| !part.is_empty())
}

/// Refuses a motion among the arguments of a word. It stands there if the end of a line was lost.
///
/// # Errors
/// If there is a motion.
pub(super) fn refuse_motions(word: &str, arguments: &str) -> Result<(), ProgramFault> {
    let upper = arguments.to_ascii_uppercase();
    let moves = |part: &str| {
        POSITION_WORDS.contains(&part) || part.starts_with("GO") && MOTION_WORDS.contains(&part)
    };
    match upper.contains('/') || parts(&upper).any(moves) {
        true => Err(ProgramFault::Swallowed { word: word.to_owned() }),
        false => Ok(()),
    }
}

/// Returns whether a statement is a block of G-code: letters, each with a number.
fn is_g_code(statement: &str) -> bool {
    let is_address = |word: &str| {
        let number = word.strip_prefix(|c: char| c.is_ascii_alphabetic());
        number.is_some_and(|number| number.parse::<f64>().is_ok())
    };
    statement.split(' ').all(is_address)
}

/// Returns whether a word that could have an effect has none with these arguments.
fn is_inert_with(word: &str, arguments: &str) -> bool {
    let is = |word: &str| arguments.eq_ignore_ascii_case(word);
    let numbers = || arguments.split(',').map(number).collect::<Result<Vec<f64>, ProgramFault>>();
    match word {
        "CYCLE" | "CUTCOM" | "OPSKIP" => is("OFF"),
        "TRACUT" | "COPY" => is("NOMORE"),
        "MODE" => is("ABSOL"),
        "ORIGIN" | "TRANS" | "THICK" => {
            numbers().is_ok_and(|values| values.iter().all(|v| *v == 0.0))
        }
        // The part's own coordinates: origin, x axis, y axis.
        "MSYS" => {
            numbers().is_ok_and(|values| values == [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0])
        }
        _ => false,
    }
}
