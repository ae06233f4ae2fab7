//! Tools that the comments of a program describe.
//!
//! Post-processors write a comment for each tool at the head of a program, or before its change:
//!
//! | written by | comment |
//! |---|---|
//! | Fusion 360, Inventor CAM, HSMWorks | `(T1  D=0.375 CR=0. - ZMIN=-0.08 - FLAT END MILL)`, or after `;` |
//! | Mastercam | `(T1 \| 3/8 FLAT ENDMILL \| H1 \| TOOL DIA. - .375)`, `( TOOL - 1 DIA. OFF. - 1 LEN. - 1 DIA. - .375 )` |
//! | Makera Studio | `;@MKR\|TOOL\|number=2\|type=Flat End\|diameter=3\|cornerradius=0`, in millimetres |

use super::shown;
use std::collections::HashSet;
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
    /// Another type.
    Other,
    /// No type.
    Unnamed,
}

/// Returns the tools that the comments of a program describe, each description once. `unit` is that of the program.
pub(crate) fn stated_tools(text: &str, unit: Unit) -> Vec<StatedTool> {
    let mut found: Vec<StatedTool> = Vec::new();
    let mut known = HashSet::new();
    for (index, line) in text.lines().enumerate() {
        for comment in comments(line) {
            let Some(tool) = stated_tool(1 + index, comment, unit) else { continue };
            let StatedTool { number, diameter, corner, end, .. } = tool;
            if known.insert((number, diameter.to_bits(), corner.map(f64::to_bits), end)) {
                found.push(tool);
            }
        }
    }
    found
}

/// Returns the comments of a line: in parentheses, after a semicolon, or as a heading of Klartext.
fn comments(line: &str) -> impl Iterator<Item = &str> {
    let (before, after) = match line.split_once(';') {
        Some((before, after)) => (before, Some(after)),
        None => (line, None),
    };
    // Names of tools can have parentheses.
    let inner = before.split_once('(').map(|(_, rest)| rest.rsplit_once(')').map_or(rest, |p| p.0));
    let heading = before.trim_start_matches(|c: char| c.is_ascii_digit() || c == ' ');
    let heading = heading.strip_prefix('*');
    [inner, heading.filter(|_| inner.is_none()), after].into_iter().flatten()
}

/// Reads a comment, if it states the number and the diameter of a tool.
fn stated_tool(line: usize, comment: &str, unit: Unit) -> Option<StatedTool> {
    let upper = comment.trim().to_ascii_uppercase();
    let text = upper.trim_start_matches(['-', ' ', '"']);
    let (number, diameter, corner, kind, scale) = match text.strip_prefix("@MKR|TOOL|") {
        Some(fields) => {
            let field = |key: &str| {
                let pairs = fields.split('|').filter_map(|field| field.split_once('='));
                pairs.into_iter().find(|(known, _)| *known == key).map(|(_, value)| value.trim())
            };
            let number = field("NUMBER")?.parse().ok()?;
            let corner = field("CORNERRADIUS").and_then(leading_number);
            let kind = field("TYPE").unwrap_or_default();
            (number, leading_number(field("DIAMETER")?)?, corner, kind.to_owned(), 1.0)
        }
        None => {
            let (number, rest) = tool_number(text)?;
            let diameter = value(rest, &["D="]).or_else(|| diameter(rest))?;
            let corner = value(rest, &["CR="]);
            // The type is the last field that is no value.
            let fields = rest.split(" - ").skip(1).filter(|field| !field.contains('='));
            let is_mastercam = value(rest, &["D="]).is_none();
            let kind = if is_mastercam { Some(rest) } else { fields.last() };
            (number, diameter, corner, kind.unwrap_or_default().to_owned(), unit.millimetres())
        }
    };
    let is_length = |length: &f64| (0.0..1e6).contains(length);
    if !is_length(&diameter) || diameter == 0.0 {
        return None;
    }
    Some(StatedTool {
        line,
        number,
        diameter: scale * diameter,
        corner: corner.filter(is_length).map(|corner| scale * corner),
        end: end(&kind),
        comment: shown(comment.trim()),
    })
}

/// Returns the number after `T` or `TOOL` at the beginning, and the rest.
fn tool_number(text: &str) -> Option<(u32, &str)> {
    let rest = match text.strip_prefix("TOOL") {
        Some(rest) => rest.trim_start_matches([' ', '-', '#', ':', '=', '.']),
        None => text.strip_prefix('T')?,
    };
    let digits = rest.bytes().take_while(u8::is_ascii_digit).count();
    let (number, rest) = rest.split_at(digits);
    let is_word = rest.starts_with(|c: char| c.is_ascii_alphanumeric() || c == '.');
    Some((number.parse().ok()?, rest)).filter(|_| !is_word)
}

/// Returns the number after a key that begins a word.
fn value(text: &str, keys: &[&str]) -> Option<f64> {
    keys.iter().find_map(|key| {
        let mut found = text.match_indices(key);
        let (at, _) = found.find(|(at, _)| {
            !text[..*at].ends_with(|c: char| c.is_ascii_alphanumeric() || c == '_')
        })?;
        leading_number(&text[at + key.len()..])
    })
}

/// Returns the number after the last `DIA.` that is not the one of an offset.
fn diameter(text: &str) -> Option<f64> {
    let numbers = text.match_indices("DIA.").filter_map(|(at, key)| {
        let rest = text[at + key.len()..].trim_start();
        leading_number(rest.strip_prefix(['-', '=', ':'])?)
    });
    numbers.last()
}

/// Returns the number at the beginning of a text.
fn leading_number(text: &str) -> Option<f64> {
    let text = text.trim_start();
    let length = text.bytes().take_while(|byte| byte.is_ascii_digit() || *byte == b'.').count();
    text[..length].parse().ok()
}

/// Returns the form of an end by the name of a type.
fn end(kind: &str) -> StatedEnd {
    let has = |words: &[&str]| words.iter().all(|word| kind.contains(word));
    if kind.trim().is_empty() {
        StatedEnd::Unnamed
    } else if has(&["BULL"]) {
        StatedEnd::BullNose
    } else if has(&["BALL", "MILL"]) || has(&["BALL", "END"]) {
        StatedEnd::Ball
    } else if has(&["FLAT", "MILL"]) || has(&["FLAT", "END"]) {
        StatedEnd::Flat
    } else {
        StatedEnd::Other
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stated(text: &str, unit: Unit) -> Vec<(usize, u32, f64, Option<f64>, StatedEnd)> {
        let tools = stated_tools(text, unit).into_iter();
        tools.map(|tool| (tool.line, tool.number, tool.diameter, tool.corner, tool.end)).collect()
    }

    #[test]
    fn comments_of_post_processors_describe_tools() {
        use StatedEnd::{Ball, BullNose, Flat, Other, Unnamed};
        let mm = Unit::Millimetre;
        for (text, expected) in [
            ("(T3  D=10. CR=0. - ZMIN=-4. - FLAT END MILL)", (3, 10.0, Some(0.0), Flat)),
            ("(T12 D=6 CR=3 - ZMIN=-2.5 - ball end mill)", (12, 6.0, Some(3.0), Ball)),
            ("; T4 D=12 CR=1.5 - ZMIN=-1 - bull nose end mill", (4, 12.0, Some(1.5), BullNose)),
            ("3 * T5 D=5 CR=0 TAPER=118deg - ZMIN=-9 - drill", (5, 5.0, Some(0.0), Other)),
            ("7 ; T5 D=5 CR=0 - ZMIN=-9 - drill", (5, 5.0, Some(0.0), Other)),
            ("N10 (T1 D=.5 CR=0.)", (1, 0.5, Some(0.0), Unnamed)),
            ("( TOOL - 2 DIA. OFF. - 2 LEN. - 2 DIA. - 8. )", (2, 8.0, None, Other)),
            ("(T1 | 1/2 FLAT ENDMILL | H1 | D1 | TOOL DIA. - 12.5)", (1, 12.5, None, Flat)),
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
        // Makera writes millimetres whatever the unit of the program.
        let makera = ";@MKR|TOOL|number=2|type=Ball End|diameter=3|cornerradius=1.5";
        assert_eq!(stated(makera, Unit::Inch), [(1, 2, 3.0, Some(1.5), Ball)]);
    }

    #[test]
    fn other_comments_describe_no_tool() {
        for text in [
            "(T1 = 6 MM END MILL)",
            "(TEST D=3)",
            "(T1.5 D=3)",
            "(TOOL LIST)",
            "G1 X5 (D=3 CR=0)",
            "T1 D1",
            "(T1 D=0. CR=0.)",
        ] {
            assert_eq!(stated(text, Unit::Millimetre), [], "{text}");
        }
        let twice =
            "(T1 D=6. CR=0. - DRILL)\nG0 X1\n(T1 D=6. CR=0. - DRILL)\n(T1 D=8. CR=0. - DRILL)";
        assert_eq!(stated(twice, Unit::Millimetre).len(), 2);
    }
}
