//! Mistakes of spelling: characters and habits from elsewhere.

use super::{BLANK, FILES, Stop, ends_a_value, in_name, word};
use crate::report::Report;

/// Characters that look like what is meant.
const MEANT: [(char, &str); 15] = [
    ('×', "*"),
    ('·', "*"),
    ('÷', "/"),
    ('−', "-"),
    ('–', "-"),
    ('—', "-"),
    ('≤', "<="),
    ('≥', ">="),
    ('π', "pi"),
    ('√', "sqrt(…)"),
    ('“', "\""),
    ('”', "\""),
    ('„', "\""),
    ('[', "("),
    (']', ")"),
];

/// Words behind which a name stands.
const NAMING: [&str; 7] = ["tool", "solid", "let", "param", "curve", "region", "as"];

/// Mistakes that a character gives away.
pub(super) fn character(stop: &Stop<'_>) -> Option<Report> {
    let (rest, before) = (stop.rest(), stop.before());
    let next = rest.chars().next()?;
    let here = stop.next(0);
    let report = |message: String, help: String| Some(Report::error(here, message).help(help));
    let digits = |s: &str| s.chars().take_while(char::is_ascii_digit).collect::<String>();
    let number = number_before(before);
    if let Some(digits) = number.strip_suffix('.') {
        let place = stop.span(before.len() - number.len(), before.len());
        let report = Report::error(place, "a number ends in a point");
        return Some(report.help(format!("write `{digits}` or `{digits}.0`")));
    }
    let glued = before.len() == stop.at;
    // The place of something with this character behind it.
    let whole = |begun: &str| {
        let end = stop.at + next.len_utf8();
        stop.span(if glued { stop.at - begun.len() } else { stop.at }, end)
    };
    match next {
        '.' if rest[1..].starts_with(|c: char| c.is_ascii_digit()) => {
            let fraction = digits(&rest[1..]);
            report(
                format!("`.{fraction}` needs a digit before the point"),
                format!("write `0.{fraction}`"),
            )
        }
        '°' if !number.is_empty() => {
            let report = Report::error(whole(number), format!("`{number}°` is no angle"));
            Some(report.help(format!("write `{number}deg`")))
        }
        '²' | '³' => {
            let power = if next == '²' { 2 } else { 3 };
            let base = stop.last_word();
            let report = Report::error(whole(base), format!("`{base}{next}` is not a name"));
            Some(report.help(format!("write `{base}^{power}`")))
        }
        '⌀' | 'ø' | 'Ø' => report(
            format!("`{next}` is not part of the language"),
            "coordinates are radii: write half the diameter, as in `6/2`".into(),
        ),
        '\'' => report("`'` is not part of the language".into(), "write text between `\"`".into()),
        '^' => report(
            "`^` does not chain".into(),
            "say with parentheses which comes first: `(a^b)^c` or `a^(b*c)`".into(),
        ),
        '"' if glued && !number.is_empty() => {
            report("`\"` is not a unit".into(), format!("write `{number}inch`"))
        }
        '"' if stop.text.matches('"').count() % 2 == 1 => unended(stop),
        '"' => report(
            "text stands only behind the tool's name and `mount`".into(),
            "write it as in `tool Name \"what it is\" { … }` or `mount \"file.tool\" as NAME`"
                .into(),
        ),
        '_' if glued && !number.is_empty() => report(
            "a number has no `_`".into(),
            "write its digits one behind the other, as in `1000`".into(),
        ),
        '_' => report("a name begins with a letter".into(), "drop the `_`".into()),
        _ => match MEANT.iter().find(|(wrong, _)| *wrong == next) {
            Some((_, meant)) => {
                report(format!("`{next}` is not part of the language"), format!("write `{meant}`"))
            }
            None => unseen(next).and_then(|(message, help)| report(message, help)),
        },
    }
}

/// A character that is none of the language's, by its number if it cannot be seen.
fn unseen(next: char) -> Option<(String, String)> {
    let code = format!("U+{:04X}", next as u32);
    let visible = !(next.is_control()
        || next.is_whitespace()
        || matches!(next, '\u{ad}' | '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}')
        || matches!(next, '\u{2060}'..='\u{206f}' | '\u{feff}' | '\u{fff9}'..='\u{fffd}'));
    match next {
        '\u{feff}' => Some((
            "the text begins with a byte order mark (U+FEFF)".into(),
            "save the file as UTF-8 without one".into(),
        )),
        _ if next.is_ascii() && !next.is_control() => None,
        _ if visible => Some((
            format!("`{next}` is not part of the language"),
            "names are ASCII letters, digits and `_`".into(),
        )),
        _ => Some((
            format!("the character {code} is not part of the language"),
            "delete it: it cannot be seen; blanks are spaces, tabs and new lines".into(),
        )),
    }
}

/// Habits from elsewhere: a unit apart from its number, `and`, a name with a dash.
pub(super) fn habit(stop: &Stop<'_>) -> Option<Report> {
    let (rest, before) = (stop.rest(), stop.before());
    let next = word(rest);
    let number = number_before(before);
    if ["mm", "inch", "m", "deg", "rad", "in"].contains(&next) && !number.is_empty() {
        let unit = if next == "in" { "inch" } else { next };
        return Some(
            Report::error(stop.next(next.len()), format!("a space before the unit `{next}`"))
                .help(format!("write `{number}{unit}`")),
        );
    }
    if ["and", "or"].contains(&next) || rest.starts_with("&&") || rest.starts_with("||") {
        let length = next.len().max(2);
        return Some(Report::error(stop.next(length), "conditions are joined by commas").help(
            "all hold that stand between commas: `a <= b, c <= d`; \"or\" is `min(a, b) <= 0`",
        ));
    }
    if let Some(report) = name(stop).or_else(|| operator(stop)) {
        return Some(report);
    }
    let digit = |c: Option<char>| c.is_some_and(|c| c.is_ascii_digit());
    if rest.starts_with(',') && digit(before.chars().last()) && digit(rest.chars().nth(1)) {
        let fraction: String = rest[1..].chars().take_while(char::is_ascii_digit).collect();
        return Some(
            Report::error(stop.next(1), "a comma stands between things of a list")
                .help(format!("a decimal comma? write a point: `{number}.{fraction}`")),
        );
    }
    if rest.starts_with(';') && before.is_empty() {
        return Some(
            Report::error(stop.next(1), "a `;` too many").help("drop it: a region ends with `}`"),
        );
    }
    if FILES.contains(&next) {
        return Some(
            Report::error(stop.next(next.len()), format!("a second {next}"))
                .help("write one tool or solid a file"),
        );
    }
    None
}

/// Text or a comment that does not end, and a file in which nothing is.
pub(super) fn unended(stop: &Stop<'_>) -> Option<Report> {
    let comment = |at: usize| {
        Report::error(stop.span(at, at + 2), "this comment does not end").help("close it with `*/`")
    };
    if stop.rest().starts_with("/*") {
        return Some(comment(stop.at));
    }
    let read = stop.text.trim_matches(BLANK);
    if stop.offset == 0 && stop.rest().is_empty() && word(read).is_empty() {
        return Some(no_tool(stop));
    }
    let mut start = 0;
    for line in stop.text.split_inclusive('\n') {
        let code = line.split("//").next().unwrap_or_default();
        if let (1, Some(at)) = (code.matches('"').count() % 2, code.rfind('"')) {
            let place = stop.span(start + at, start + at + 1);
            return Some(
                Report::error(place, "this text does not end")
                    .help("close it with `\"` on the same line"),
            );
        }
        start += line.len();
    }
    let before = stop.before();
    let open = before.matches("/*").count() > before.matches("*/").count();
    open.then(|| comment(before.rfind("/*").unwrap_or_default()))
}

/// A text that ends without a tool.
pub(super) fn no_tool(stop: &Stop<'_>) -> Report {
    Report::error(stop.next(0), "there is no tool in this text")
        .help("write `tool Name { units mm; … }`")
}

/// A name with a dash, or one that begins with a digit.
fn name(stop: &Stop<'_>) -> Option<Report> {
    let (rest, before) = (stop.rest(), stop.before());
    let of_tool = |naming: &str| FILES.contains(&naming);
    if rest.starts_with(|c: char| c.is_ascii_digit()) && NAMING.contains(&stop.last_word()) {
        let length = rest.find(|c| !in_name(c)).unwrap_or(rest.len());
        return Some(Report::error(stop.next(length), "a name begins with a letter").help(
            if of_tool(stop.last_word()) {
                "put a letter first, as in `D6Ball`"
            } else {
                "put a letter first"
            },
        ));
    }
    let begun = stop.last_word();
    let naming = before[..before.len() - begun.len()].trim_end_matches(BLANK);
    let naming = &naming[naming.trim_end_matches(in_name).len()..];
    if rest.starts_with('-') && NAMING.contains(&naming) {
        // Inline each token stands apart.
        let tail = rest[1..].trim_start_matches(BLANK);
        let tail = &tail[..tail.find(|c| !in_name(c) && c != '-').unwrap_or(tail.len())];
        let whole = format!("{begun}-{tail}");
        let end = stop.at + rest.find(tail).unwrap_or(0) + tail.len();
        let place = stop.span(before.len() - begun.len(), end);
        let meant = if of_tool(naming) { whole.replace('-', "") } else { whole.replace('-', "_") };
        return Some(
            Report::error(place, format!("`{whole}` is not a name: a name has no dash"))
                .help(format!("write `{meant}`")),
        );
    }
    None
}

/// Operators of other languages.
fn operator(stop: &Stop<'_>) -> Option<Report> {
    let (rest, before) = (stop.rest(), stop.before());
    let both = || stop.span(stop.at - 1, stop.at + 1);
    let glued = before.len() == stop.at;
    if rest.starts_with('*') && glued && before.ends_with('*') {
        return Some(Report::error(both(), "`**` is no operator").help("a power is written `a^b`"));
    }
    if rest.starts_with(['<', '>']) {
        let sign = &rest[..1];
        if glued && before.ends_with('=') {
            return Some(
                Report::error(both(), format!("`={sign}` is no comparison"))
                    .help(format!("write `{sign}=`")),
            );
        }
        if ends_a_value(before) {
            return Some(if stop.text.trim_start().starts_with("region") {
                Report::error(stop.next(1), "one comparison too many")
                    .help("a chain is `a <= b <= c`; more are conditions of their own: `c <= d`")
            } else {
                Report::error(stop.next(1), "a comparison stands behind `where` only")
                    .help("write it into a region: `region NAME where a <= b { … }`")
            });
        }
    }
    None
}

/// The number that a text ends with.
fn number_before(before: &str) -> &str {
    let digits = before.trim_end_matches(|c: char| c.is_ascii_digit() || c == '.');
    let number = &before[digits.len()..];
    let begins = number.starts_with(|c: char| c.is_ascii_digit());
    if begins && !digits.ends_with(in_name) { number } else { "" }
}
