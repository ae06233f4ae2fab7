//! Tools that the comments of a program describe.
//!
//! Post-processors write a comment for each tool at the head of a program, before its change, or in the block of the change:
//!
//! | written by | comment |
//! |---|---|
//! | Fusion 360, Inventor CAM, HSMWorks | `(T1  D=0.375 CR=0. - ZMIN=-0.08 - FLAT END MILL)`, or after `;`; `#1 D=6 - ZMIN=-1 - ball end mill` in Klartext |
//! | Mastercam | `(T1 \| 3/8 FLAT ENDMILL \| H1 \| TOOL DIA. - .375)`, `( TOOL - 1 DIA. OFF. - 1 LEN. - 1 DIA. - .375 )` |
//! | SolidCAM | `(TOOL -1- MILL DIA 10.0 R0. MM )` |
//! | Vectric | `(1 = End Mill {6 mm})`, `(T2 = V-Bit {90 deg 0.5 inches})` |
//! | FreeCAD, CamBam | `(T1=6mm_Endmill)`, `( T1 : 6.0 )` |
//! | Makera Studio | `;@MKR\|TOOL\|number=2\|type=Flat End\|diameter=3\|cornerradius=0`, in millimetres |

use super::shown;
use std::collections::{BTreeMap, HashSet};
use touchoff::Unit;

/// A tool that a comment describes. Lengths are in millimetres.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct StatedTool {
    /// The line of the comment, 1-based.
    pub line: usize,
    /// The number of the tool.
    pub number: u32,
    /// Its diameter.
    pub diameter: f64,
    /// The radius of its corners.
    pub corner: Option<f64>,
    /// The angle of its cone in degrees: to the axis for a [`StatedEnd::Cone`], of the whole point for another.
    pub taper: Option<f64>,
    /// The form of its end.
    pub end: StatedEnd,
    /// The escaped comment.
    pub comment: String,
}

/// The form of a tool's end, as a comment names it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum StatedEnd {
    /// A flat end mill.
    Flat,
    /// A ball end mill.
    Ball,
    /// A bull nose.
    BullNose,
    /// A chamfer mill, a V-bit or a tapered mill.
    Cone,
    /// Another type.
    Other,
    /// No type.
    Unnamed,
}

/// Length of the longest line that is read, in bytes: each comment of a line is tried with all behind it.
const MAX_LINE: usize = 500;

/// Returns the tools that the comments of a program describe, each description once. `unit` is that of the program, and `names` has the
/// numbers of tools that the program selects by their names.
pub(crate) fn stated_tools(
    text: &str,
    unit: Unit,
    names: &BTreeMap<String, u32>,
) -> Vec<StatedTool> {
    let mut found: Vec<StatedTool> = Vec::new();
    let mut known = HashSet::new();
    let lines = text.lines().enumerate().filter(|(_, line)| line.len() <= MAX_LINE);
    for (index, line) in lines {
        let (code, comments) = comments(line);
        let selected = selected(code, names);
        let mut tools = comments.into_iter().filter_map(|comment| {
            let tool = description(comment, selected, names)?;
            tool.stated(1 + index, comment, unit)
        });
        let Some(tool) = tools.next() else { continue };
        let StatedTool { number, diameter, corner, taper, end, .. } = tool;
        let lengths = [Some(diameter), corner, taper].map(|length| length.map(f64::to_bits));
        if known.insert((number, lengths, end)) {
            found.push(tool);
        }
    }
    found
}

/// Splits a line into its words and its comments: after a semicolon, each in parentheses to the last one, since names of tools can have
/// parentheses, and a heading of Klartext.
fn comments(line: &str) -> (&str, Vec<&str>) {
    let (before, after) = match line.split_once(';') {
        Some((before, after)) => (before, Some(after)),
        None => (line, None),
    };
    let last = before.rfind(')').unwrap_or(before.len());
    let opened = before[..last].match_indices('(');
    let mut found: Vec<&str> = opened.map(|(at, _)| &before[at + 1..last]).collect();
    let words = before.split('(').next().unwrap_or_default();
    if found.is_empty() {
        let heading = words.trim_start_matches(|c: char| c.is_ascii_digit() || c == ' ');
        found.extend(heading.strip_prefix('*'));
    }
    found.extend(after);
    (words, found)
}

/// Returns the tool that the words of a block select: `T1` or `TOOL CALL 1`.
fn selected(words: &str, names: &BTreeMap<String, u32>) -> Option<u32> {
    let words = words.to_ascii_uppercase();
    if let Some((_, rest)) = words.split_once("TOOL CALL") {
        let rest = rest.trim_start();
        return quoted(rest, names).or_else(|| digits(rest)).map(|(number, _)| number);
    }
    let mut found = words
        .match_indices('T')
        .filter(|(at, _)| !words[..*at].ends_with(|c: char| c.is_ascii_alphabetic() || c == '_'));
    found.find_map(|(at, _)| digits(&words[at + 1..])).map(|(number, _)| number)
}

/// Returns the number of the tool whose name a text begins with in quotes, and the rest.
fn quoted<'a>(text: &'a str, names: &BTreeMap<String, u32>) -> Option<(u32, &'a str)> {
    let (name, rest) = text.strip_prefix('"')?.split_once('"')?;
    let (_, number) = names.iter().find(|(known, _)| known.eq_ignore_ascii_case(name))?;
    Some((*number, rest))
}

/// Returns the whole number at the beginning of a text, and the rest.
fn digits(text: &str) -> Option<(u32, &str)> {
    let length = text.bytes().take_while(u8::is_ascii_digit).count();
    let (number, rest) = text.split_at(length);
    Some((number.parse().ok()?, rest))
}

/// A length of a comment: its value, and its unit if the comment has one beside it.
type Measure = (f64, Option<Unit>);

/// Statements of a comment.
struct Description {
    number: u32,
    diameter: Measure,
    corner: Option<Measure>,
    taper: Option<f64>,
    end: StatedEnd,
    /// The unit of lengths that have none, if it is not that of the program.
    unit: Option<Unit>,
}

impl Description {
    fn stated(&self, line: usize, comment: &str, unit: Unit) -> Option<StatedTool> {
        let scaled =
            |(value, own): Measure| value * own.or(self.unit).unwrap_or(unit).millimetres();
        let is_length = |length: &f64| (0.0..1e6).contains(length);
        let diameter =
            Some(scaled(self.diameter)).filter(|length| is_length(length) && *length > 0.0);
        Some(StatedTool {
            line,
            number: self.number,
            diameter: diameter?,
            corner: self.corner.map(scaled).filter(is_length),
            taper: self.taper.filter(|angle| (0.0..=180.0).contains(angle)),
            end: self.end,
            comment: shown(comment.trim()),
        })
    }
}

/// Reads a comment, if it states the diameter of a tool, and its number or stands in the block that `selected` it.
fn description(
    comment: &str,
    selected: Option<u32>,
    names: &BTreeMap<String, u32>,
) -> Option<Description> {
    let upper = comment.trim().to_ascii_uppercase();
    let text = upper.strip_prefix("MSG,").unwrap_or(&upper).trim_start_matches(['-', ' ']);
    if let Some(fields) = text.strip_prefix("@MKR|TOOL|") {
        return makera(fields);
    }
    let named = quoted(text.strip_prefix("T=").unwrap_or(text), names);
    let text = text.trim_start_matches('"');
    let numbered = named.or_else(|| tool_number(text)).or_else(|| numbered_name(text));
    let (number, rest) = numbered.or(selected.map(|number| (number, text)))?;
    // The size of an engraving bit is that of its tip.
    let braced = rest.split_once('{').and_then(|(_, inner)| inner.split('}').next());
    let braced = braced.filter(|inner| !inner.contains("TIP"));
    let rest = &*without_counts(&without_work(rest));
    let diameter = value(rest, &["D"])
        .or_else(|| diameter(rest))
        .or_else(|| braced.and_then(last_measure))
        .or_else(|| {
            let (found, after) = measure(rest.trim_start().strip_prefix(':')?)?;
            Some(found).filter(|_| !after.starts_with('-'))
        })
        .or_else(|| named_diameter(rest))?;
    let corner = ["CR", "CORNER RADIUS", "CORNER RAD.", "CORNER RAD"];
    let corner = value(rest, &corner).or_else(|| radius(rest));
    let taper = value(rest, &["TAPER"]).map(|(angle, _)| angle);
    // The type is the last field that is no value.
    let fields = rest.split(" - ").skip(1).filter(|field| !field.contains('='));
    let has_values = value(rest, &["D"]).is_some();
    let kind = if has_values { fields.last().unwrap_or_default() } else { rest };
    let mut end = end(kind);
    if end == StatedEnd::Unnamed && braced.is_some() && kind.contains("END MILL") {
        end = StatedEnd::Flat;
    }
    // The angle of a V-bit is that of the whole point.
    let whole = || {
        braced?.split_once("DEG").and_then(|(angle, _)| number_in(angle)).map(|angle| 0.5 * angle)
    };
    let taper = taper.or_else(|| whole().filter(|_| end == StatedEnd::Cone));
    let unit = match rest.split_whitespace().next_back() {
        Some("MM") => Some(Unit::Millimetre),
        Some("IN" | "INCH" | "INCHES") => Some(Unit::Inch),
        _ => None,
    };
    Some(Description { number, diameter, corner, taper, end, unit })
}

/// Returns what the fields of a comment say about the tool: none from the word on that begins to say what it makes, and nothing of one that
/// names features of the part, whose size can stand there: `DRILLS DIA 8 HOLES`.
fn without_work(text: &str) -> String {
    const WORK: [&str; 10] =
        ["FOR", "TO", "DRILLS", "MILLS", "CUTS", "BORES", "REAMS", "TAPS", "ROUGHS", "FINISHES"];
    const FEATURES: [&str; 6] = ["HOLE", "HOLES", "POCKET", "POCKETS", "BOSS", "BOSSES"];
    let position = |field: &str, word: &&str| {
        let mut found = field.match_indices(*word).map(|(at, _)| at);
        let is_ended =
            |at: usize| !field[at + word.len()..].starts_with(|c: char| c.is_ascii_alphanumeric());
        found.find(|at| begins_word(field, *at) && is_ended(*at))
    };
    let fields = text.split('|').map(|field| {
        let end = WORK.iter().filter_map(|word| position(field, word)).min();
        let field = &field[..end.unwrap_or(field.len())];
        if FEATURES.iter().any(|word| position(field, word).is_some()) { "" } else { field }
    });
    fields.collect::<Vec<_>>().join("|")
}

/// Reads the fields of Makera Studio.
fn makera(fields: &str) -> Option<Description> {
    let field = |key: &str| {
        let mut pairs = fields.split('|').filter_map(|field| field.split_once('='));
        pairs.find(|(known, _)| *known == key).map(|(_, value)| value.trim())
    };
    Some(Description {
        number: field("NUMBER")?.parse().ok()?,
        diameter: measure(field("DIAMETER")?)?.0,
        corner: field("CORNERRADIUS").and_then(measure).map(|(corner, _)| corner),
        taper: None,
        end: end(field("TYPE").unwrap_or_default()),
        unit: Some(Unit::Millimetre),
    })
}

/// Returns the number after `T`, `TOOL` or `#` at the beginning, and the rest.
fn tool_number(text: &str) -> Option<(u32, &str)> {
    let rest = match text.strip_prefix("TOOL") {
        Some(rest) => {
            let rest = rest.trim_start();
            let rest = rest.strip_prefix("NUMBER").or(rest.strip_prefix("NO.")).unwrap_or(rest);
            rest.trim_start_matches([' ', '-', '#', ':', '=', '.'])
        }
        None => text.strip_prefix(['T', '#'])?,
    };
    let is_word = |rest: &str| rest.starts_with(|c: char| c.is_ascii_alphanumeric() || c == '.');
    digits(rest).filter(|(_, rest)| !is_word(rest))
}

/// Returns the number before the name of a tool with its size in braces or parentheses: `1 = End Mill {6 mm}`.
fn numbered_name(text: &str) -> Option<(u32, &str)> {
    let (number, rest) = digits(text)?;
    let rest = rest.trim_start().strip_prefix('=')?;
    let (_, size) = rest.split_once(['{', '('])?;
    last_measure(size)?;
    Some((number, rest))
}

/// Returns the length after a key that begins a word, and `=`, `:` or `-`.
fn value(text: &str, keys: &[&str]) -> Option<Measure> {
    let after = |key: &&str| {
        let mut found = text.match_indices(*key).filter(|(at, _)| begins_word(text, *at));
        found.find_map(|(at, _)| {
            let rest = text[at + key.len()..].trim_start();
            measure(rest.strip_prefix(['=', ':', '-'])?).map(|found| found.0)
        })
    };
    keys.iter().find_map(after)
}

fn begins_word(text: &str, at: usize) -> bool {
    !text[..at].ends_with(|c: char| c.is_ascii_alphanumeric() || c == '_')
}

/// Returns the text without numbers that are no diameter: of flutes, of degrees, and lengths of the cutting part or of all.
fn without_counts(text: &str) -> String {
    const COUNTED: [&str; 12] =
        ["FLUTE", "FLUTES", "FLT", "FL", "F", "DEG", "DEGREE", "DEGREES", "°", "LOC", "OAL", "LG"];
    let is_counted = |word: &str| COUNTED.contains(&word.trim_matches(['-', '.', ',']));
    let mut kept: Vec<&str> = Vec::new();
    let mut words = text.split_whitespace().peekable();
    while let Some(word) = words.next() {
        // `3FL` and `90DEG` are one word.
        let number = word.trim_start_matches(|c: char| c.is_ascii_digit() || c == '.');
        if number.len() < word.len() && is_counted(number) {
            continue;
        }
        if is_counted(word) {
            // Its number stands before it, with a unit of its own or without one, unless that is the diameter; or after it.
            let has_unit = matches!(kept.last(), Some(&("MM" | "IN" | "INCH")));
            let at = kept.len().saturating_sub(1 + usize::from(has_unit));
            let is_number = kept.get(at).is_some_and(|last| number_in(last).is_some());
            let is_diameter = at > 0 && kept[at - 1].contains("DIA");
            if is_number && !is_diameter {
                kept.truncate(at);
            } else if words.peek().is_some_and(|next| number_in(next).is_some()) {
                words.next();
            }
            continue;
        }
        kept.push(word);
    }
    kept.join(" ")
}

/// Words beside a diameter that is not the cutter's: of other pieces of the tool, of what it makes and of its path, and of offsets.
#[rustfmt::skip]
const OTHERS: [&str; 21] = [
    "SHANK", "SHAFT", "HOLDER", "COLLET", "CHUCK", "ARBOR", "HUB", "FLANGE", "NECK", "BODY", "TIP", "PILOT", "THREAD", "STOCK",
    "BORE", "MIN", "RAMP", "RAMPING", "HELIX", "OFFSET", "OFF",
];

fn is_other(word: Option<&str>) -> bool {
    word.is_some_and(|word| OTHERS.contains(&word.trim_end_matches(['.', ':', '='])))
}

/// Returns the length of the last `DIA` or `DIAMETER` that is the cutter's: after it, or before it where none follows; or that of `D6.` with
/// its point.
fn diameter(text: &str) -> Option<Measure> {
    let named = text.match_indices("DIA").filter(|(at, _)| begins_word(text, *at));
    let named = named.filter_map(|(at, key)| {
        let (before, owner) = last_measure_of(&text[..at]);
        let rest = &text[at + key.len()..];
        let rest = rest.strip_prefix("METER").or(rest.strip_prefix('M')).unwrap_or(rest);
        let rest = rest.trim_start_matches('.').trim_start();
        let is_offset = rest.starts_with("OFF");
        let (is_joined, rest) = match rest.strip_prefix(['-', '=', ':']) {
            Some(rest) => (true, rest),
            None => (false, rest),
        };
        let (after, behind) = match measure(rest) {
            Some((found, behind)) => (Some(found), behind),
            None => (None, rest),
        };
        // `SHANK DIA 12` and `12 DIA SHANK`, but neither `SHANK 12 DIA 10` nor `DIA 10 SHANK 12`.
        if before.is_none() && is_other(owner) || ends_with_other(behind) {
            return None;
        }
        before.filter(|_| !is_joined && !is_offset && !is_other(owner)).or(after)
    });
    named.last().or_else(|| pointed(text, 'D'))
}

/// Returns whether a text begins with one of [`OTHERS`] that has no length of its own.
fn ends_with_other(text: &str) -> bool {
    let mut words = text.split_whitespace().skip_while(|word| *word == "OF");
    is_other(words.next())
        && !words.next().is_some_and(|next| next.starts_with("DIA") || number_in(next).is_some())
}

/// Returns the length that a text ends with, `10MM`, `.500` or `10 MM`, and the word before it.
fn last_measure_of(text: &str) -> (Option<Measure>, Option<&str>) {
    let mut words = text.split_whitespace().rev();
    let last = words.next();
    let unit = match last {
        Some("MM") => Some(Unit::Millimetre),
        Some("IN" | "INCH") => Some(Unit::Inch),
        _ => None,
    };
    let number = if unit.is_some() { words.next() } else { last };
    match number.and_then(measure).filter(|(_, rest)| rest.is_empty()) {
        Some(((value, own), _)) => (Some((value, own.or(unit))), words.next()),
        None => (None, last),
    }
}

/// Returns the length of a word of a letter and a number with a decimal point, as the numbers of offsets have none.
fn pointed(text: &str, letter: char) -> Option<Measure> {
    let mut found = text.match_indices(letter).filter(|(at, _)| begins_word(text, *at));
    found.find_map(|(at, _)| {
        let rest = &text[at + 1..];
        let length = rest.bytes().take_while(|byte| byte.is_ascii_digit() || *byte == b'.').count();
        measure(rest).filter(|_| rest[..length].contains('.')).map(|found| found.0)
    })
}

/// Returns the radius of a corner: `R0.5`, or `1. RAD`.
fn radius(text: &str) -> Option<Measure> {
    let mut words = text.split_whitespace().zip(text.split_whitespace().skip(1));
    let before = words.find(|(_, word)| word.starts_with("RAD"));
    before.and_then(|(word, _)| measure(word)).map(|found| found.0).or_else(|| pointed(text, 'R'))
}

/// Returns the length with which the name of a cutter begins: `6MM FLAT ENDMILL`, `3/8 DRILL`.
fn named_diameter(text: &str) -> Option<Measure> {
    const CUTTERS: [&str; 7] = ["MILL", "DRILL", "BALL", "BULL", "REAMER", "V-BIT", "COUNTERSINK"];
    let (found, rest) = measure(text.trim_start_matches([' ', '|', '-', '=', ':']))?;
    let is_ended = rest.starts_with([' ', '_', '"', '|']);
    let name = rest.split('|').next().unwrap_or_default();
    Some(found).filter(|_| is_ended && CUTTERS.iter().any(|cutter| name.contains(cutter)))
}

/// Returns the last length with a unit.
fn last_measure(text: &str) -> Option<Measure> {
    let starts = text.char_indices().filter(|(at, c)| {
        (c.is_ascii_digit() || *c == '.')
            && !text[..*at].ends_with(|c: char| c.is_ascii_digit() || "./,".contains(c))
    });
    let mut found = starts.filter_map(|(at, _)| measure(&text[at..])).map(|(found, _)| found);
    found.rfind(|(_, unit)| unit.is_some())
}

/// Returns the number at the beginning of a text.
fn number_in(text: &str) -> Option<f64> {
    measure(text).map(|((value, _), _)| value)
}

/// Reads a length at the beginning of a text, as `6`, `.375`, `6,5`, `1/4"` or `6 mm`, and returns the rest. A fraction is in inches.
fn measure(text: &str) -> Option<(Measure, &str)> {
    let text = text.trim_start();
    let is_digit = |byte: u8| byte.is_ascii_digit();
    let count = |text: &str| text.bytes().take_while(|byte| is_digit(*byte)).count();
    let whole = count(text);
    let mut length = whole;
    if text[whole..].starts_with(['.', ',']) {
        let decimals = count(&text[whole + 1..]);
        if decimals > 0 || whole > 0 && text[whole..].starts_with('.') {
            length += 1 + decimals;
        }
    }
    let mut value: f64 = text[..length].replace(',', ".").parse().ok()?;
    let mut rest = &text[length..];
    let mut unit = None;
    if let Some((below, behind)) = rest.strip_prefix('/').and_then(digits)
        && length == whole
        && below > 0
    {
        value /= f64::from(below);
        (unit, rest) = (Some(Unit::Inch), behind);
    }
    let word = rest.trim_start();
    for (name, named) in [
        ("MM", Unit::Millimetre),
        ("INCHES", Unit::Inch),
        ("INCH", Unit::Inch),
        ("IN", Unit::Inch),
        ("\"", Unit::Inch),
    ] {
        if let Some(behind) = word.strip_prefix(name)
            && !(name != "\"" && behind.starts_with(|c: char| c.is_ascii_alphanumeric()))
        {
            return Some(((value, Some(named)), behind));
        }
    }
    Some(((value, unit), rest))
}

/// Returns the form of an end by the name of a type.
fn end(kind: &str) -> StatedEnd {
    let has = |words: &[&str]| words.iter().any(|word| kind.contains(word));
    let is_mill = has(&["MILL", "END", "NOSE"]);
    if kind.trim().is_empty() {
        StatedEnd::Unnamed
    } else if has(&["CHAMFER", "V-BIT", "V BIT", "TAPERED MILL"]) {
        StatedEnd::Cone
    } else if has(&["TAPER"]) {
        StatedEnd::Other
    } else if has(&["BULL"]) {
        StatedEnd::BullNose
    } else if has(&["BALL"]) && is_mill {
        StatedEnd::Ball
    } else if has(&["FLAT"]) && is_mill {
        StatedEnd::Flat
    } else if has(&["END MILL", "ENDMILL"]) {
        StatedEnd::Unnamed
    } else {
        StatedEnd::Other
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stated(text: &str, unit: Unit) -> Vec<(usize, u32, f64, Option<f64>, StatedEnd)> {
        let names = BTreeMap::from([("Flat 6".to_owned(), 4)]);
        let tools = stated_tools(text, unit, &names).into_iter();
        tools.map(|tool| (tool.line, tool.number, tool.diameter, tool.corner, tool.end)).collect()
    }

    #[test]
    fn comments_of_post_processors_describe_tools() {
        use StatedEnd::{Ball, BullNose, Cone, Flat, Other, Unnamed};
        let mm = Unit::Millimetre;
        for (text, expected) in [
            ("(T3  D=10. CR=0. - ZMIN=-4. - FLAT END MILL)", (3, 10.0, Some(0.0), Flat)),
            ("(T12 D=6 CR=3 - ZMIN=-2.5 - ball end mill)", (12, 6.0, Some(3.0), Ball)),
            ("; T4 D=12 CR=1.5 - ZMIN=-1 - bull nose end mill", (4, 12.0, Some(1.5), BullNose)),
            ("3 * T5 D=5 CR=0 TAPER=118deg - ZMIN=-9 - drill", (5, 5.0, Some(0.0), Other)),
            ("7 ; T5 D=5 CR=0 - ZMIN=-9 - drill", (5, 5.0, Some(0.0), Other)),
            ("7 ;   #5 D=5 - ZMIN=-9 - flat end mill", (5, 5.0, None, Flat)),
            ("7 ; \"FLAT 6\" D=5 - ZMIN=-9 - flat end mill", (4, 5.0, None, Flat)),
            ("; T=\"FLAT 6\" D=5 CR=0 - ZMIN=-9 - flat end mill", (4, 5.0, Some(0.0), Flat)),
            ("MSG(\"T5 D=5 CR=0 - flat end mill\")", (5, 5.0, Some(0.0), Flat)),
            ("(MSG, T5 D=5 CR=0 - FLAT END MILL)", (5, 5.0, Some(0.0), Flat)),
            ("N10 (T1 D=.5 CR=0.)", (1, 0.5, Some(0.0), Unnamed)),
            ("(T1 D=6,5 CR=0,25 - BULL NOSE END MILL)", (1, 6.5, Some(0.25), BullNose)),
            ("(T1 D=1/2in CR=0 - FLAT END MILL)", (1, 12.7, Some(0.0), Flat)),
            ("(OP 1) (T1 D=6. CR=0. TAPER=45DEG - CHAMFER MILL)", (1, 6.0, Some(0.0), Cone)),
            ("T1 M6 (D=6. CR=0. - FLAT END MILL)", (1, 6.0, Some(0.0), Flat)),
            ("T02 M06 (END MILL DIA 8.0MM)", (2, 8.0, None, Unnamed)),
            ("TOOL CALL \"Flat 6\" Z S900 ; 6MM FLAT ENDMILL", (4, 6.0, None, Flat)),
            ("( TOOL - 2 DIA. OFF. - 2 LEN. - 2 DIA. - 8. )", (2, 8.0, None, Other)),
            ("(T1 | 1/2 FLAT ENDMILL | H1 | D1 | TOOL DIA. - 12.5)", (1, 12.5, None, Flat)),
            ("( T1 |6MM FLAT ENDMILL| H1 | D1 | DIAMETER - 6. )", (1, 6.0, None, Flat)),
            ("(T10|5/8 BALL ENDMILL|H16)", (10, 15.875, None, Ball)),
            ("(T1|6. BULL ENDMILL 1. RAD|H1)", (1, 6.0, Some(1.0), BullNose)),
            ("(T1 - 1/4 FLAT ENDMILL - H1 - D1 - D0.2500\")", (1, 6.35, None, Flat)),
            ("(TOOL -1- BULL NOSE MILL DIA 10.0 R0.5 MM )", (1, 10.0, Some(0.5), BullNose)),
            ("(1 = End Mill {6 mm})", (1, 6.0, None, Flat)),
            ("(5 = Ball Nose {0.2500 inch} UpDown)", (5, 6.35, None, Ball)),
            ("(T2 = V-Bit {90 deg 1/2\"})", (2, 12.7, None, Cone)),
            ("( T3 : 50.8 surfacing bit )", (3, 50.8, None, Other)),
            ("(T1=6mm_Endmill)", (1, 6.0, None, Unnamed)),
            ("(T1=6mm_Ball_End)", (1, 6.0, None, Ball)),
            // Neither flutes nor angles nor lengths are diameters.
            ("(T1 118 DEG DRILL 10MM DIA)", (1, 10.0, None, Other)),
            ("(T1 10MM DIA 4 FLUTE ENDMILL)", (1, 10.0, None, Unnamed)),
            ("(T1 - 4 FLUTE 10MM ENDMILL)", (1, 10.0, None, Unnamed)),
            ("(T1 10. DIA. 3FL EM)", (1, 10.0, None, Other)),
            ("(T1 .500 DIA 4 FLUTE ENDMILL 1.5 LOC)", (1, 0.5, None, Unnamed)),
            ("(T1 - ENDMILL 10MM DIA 25MM LOC 72 MM OAL)", (1, 10.0, None, Unnamed)),
            ("(T1 DIA 10. 4 FLUTE ENDMILL)", (1, 10.0, None, Unnamed)),
            ("(T1 ENDMILL DIA 10 FLUTES 4)", (1, 10.0, None, Unnamed)),
            ("(T1 ENDMILL DIA. 16. FL 30 OAL 72)", (1, 16.0, None, Unnamed)),
            ("(T1 DRILL DIA 10 MM DEG 118)", (1, 10.0, None, Other)),
            // Nor are those of other pieces of the tool, of its path and of offsets.
            ("(T1 10MM ENDMILL, SHANK DIA 12)", (1, 10.0, None, Unnamed)),
            ("(T1 10MM ENDMILL, HOLDER DIA. 40)", (1, 10.0, None, Unnamed)),
            ("(T1 10MM END MILL - BORE DIA 30)", (1, 10.0, None, Unnamed)),
            ("(T1 10MM ENDMILL - RAMP DIAMETER 20)", (1, 10.0, None, Unnamed)),
            ("(T1 10MM ENDMILL 12 MM DIA SHANK)", (1, 10.0, None, Unnamed)),
            ("(T1 DIAMETER OFFSET 21 DIAMETER 10)", (1, 10.0, None, Other)),
            ("(T1 ENDMILL SHANK 12 DIA 10)", (1, 10.0, None, Unnamed)),
            ("(T1 ENDMILL DIA 10 SHANK 12)", (1, 10.0, None, Unnamed)),
            ("(T1 ENDMILL 10 DIA, SHANK DIA 12)", (1, 10.0, None, Unnamed)),
            // The size of what the tool makes is another one.
            ("(T3 DRILL DIA 6.8 FOR M8 HOLES DIA 8)", (3, 6.8, None, Other)),
            ("(T1 | 6MM DRILL FOR HOLES | H1 | TOOL DIA. - 6.)", (1, 6.0, None, Other)),
            ("(T1 6MM ENDMILL FOR 8MM POCKET)", (1, 6.0, None, Unnamed)),
            (
                ";@MKR|TOOL|number=2|name=3mm|type=Flat End|diameter=3|cornerradius=0|angle=0",
                (2, 3.0, Some(0.0), Flat),
            ),
        ] {
            let (number, diameter, corner, end) = expected;
            assert_eq!(stated(text, mm), [(1, number, diameter, corner, end)], "{text}");
        }
        let inch = stated("%\nO1\n(T1 D=0.5 CR=0.0625 - BULL NOSE END MILL)", Unit::Inch);
        assert_eq!(inch, [(3, 1, 12.7, Some(1.5875), BullNose)]);
        // A unit beside the number counts, and Makera writes millimetres whatever the unit of the program.
        for ball in [
            "(T2 D=3mm CR=1.5mm - BALL END MILL)",
            ";@MKR|TOOL|number=2|type=Ball End|diameter=3|cornerradius=1.5",
        ] {
            assert_eq!(stated(ball, Unit::Inch), [(1, 2, 3.0, Some(1.5), Ball)]);
        }
        for (text, taper) in [
            ("(T1 D=6. CR=0. TAPER=45DEG - CHAMFER MILL)", Some(45.0)),
            ("(T1 D=6. CR=0. TAPER=118DEG - DRILL)", Some(118.0)),
            ("(1 = V-Bit {90 deg 12.7 mm})", Some(45.0)),
            ("(T1 D=6. CR=0. - DRILL)", None),
        ] {
            assert_eq!(stated_tools(text, mm, &BTreeMap::new())[0].taper, taper, "{text}");
        }
    }

    #[test]
    fn other_comments_describe_no_tool() {
        for text in [
            "(T1 NEXT)",
            "(TEST D=3)",
            "(T1.5 D=3)",
            "(TOOL LIST)",
            "G1 X5 (D=3 CR=0)",
            "T1 D1",
            "(T1 D=0. CR=0.)",
            "(1 = Profile 2)",
            "(1 = Engraving {30 deg 0.5 mm Tip})",
            "(T1 ENDMILL 10MM, MIN DIA 9.98)",
            "(T3|NO. 7 DRILL|H3|D3)",
            "(T1 1/4-20 TAP)",
            "(T1 DRILLS DIA 8 HOLES)",
            "T1 M6 (3 FLUTE ENDMILL)",
            "(T1 90 DEG SPOT DRILL)",
            "(T1 : 8-32 TAP)",
            "(T1 - 90 DEGREE CHAMFER MILL)",
            "(T1 DRILL, 4 HOLES DIA 8)",
            "(T1 CUTS D=20 POCKET)",
            "(T1 FOR DIA. 8.5)",
            "(T2 SPOT DRILL TO DIA 8)",
            "T1 M6 (POCKET DIA. 30)",
            "(T1: 8 HOLES)",
            "; \"OTHER\" D=5 - flat end mill",
        ] {
            assert_eq!(stated(text, Unit::Millimetre), [], "{text}");
        }
        assert_eq!(stated(&"(T1 D=A)".repeat(100_000), Unit::Millimetre), []);
        let twice =
            "(T1 D=6. CR=0. - DRILL)\nG0 X1\n(T1 D=6. CR=0. - DRILL)\n(T1 D=8. CR=0. - DRILL)";
        assert_eq!(stated(twice, Unit::Millimetre).len(), 2);
    }
}
