//! What does not parse, said in the words of the language.

use super::Rule;
use crate::report::{Report, nearest};
use crate::source::Span;
use pest::error::{Error, ErrorVariant, InputLocation};

/// What a file is.
const FILES: [&str; 2] = ["tool", "solid"];
const ITEMS: [&str; 13] = [
    "units",
    "let",
    "param",
    "curve",
    "tip",
    "spindle",
    "profile",
    "mount",
    "regions",
    "region",
    "bsp",
    "magnitude",
    "niceness",
];
const PROPERTIES: [&str; 4] = ["depth", "magnitude", "direction", "niceness"];

/// A comparison that a closed region cannot have.
pub(super) fn comparison(span: Span, written: &str) -> Report {
    let remedy = match written {
        "<" => "write `<=`",
        ">" => "write `>=`",
        "=" | "==" => "write two conditions, `a <= b` and `a >= b`, if a single line is meant",
        _ => "write `<=` or `>=`",
    };
    Report::error(span, format!("`{written}` is no comparison here: a region is closed"))
        .help(format!("{remedy}; a border belongs to the region listed first"))
}

/// A syntax error of pest's, at a place in a text that begins at `offset` of the source.
pub(super) fn syntax(text: &str, offset: usize, error: &Error<Rule>) -> Report {
    let (at, rule_at, token_at) = place(text, error);
    let attempts = error.parse_attempts();
    let wants_end = attempts.is_some_and(|attempts| {
        token_at >= rule_at
            && attempts.expected_tokens().iter().any(|token| token.to_string() == ";")
    });
    let rest = &text[at..];
    let before = text[..at].trim_end();
    let width = rest.chars().next().map_or(0, char::len_utf8);
    let here = Span { start: offset + at, end: offset + at + width };
    if let Some(report) = spelling(text, rest, before, here) {
        return report;
    }
    if let Some(report) = item(text, rest, at, offset) {
        return report;
    }
    if let Some(report) = habit(rest, before, here) {
        return report;
    }
    if wants_end && ends_a_value(before) && (rest.starts_with('}') || starts_a_word(rest)) {
        let end = offset + before.len();
        let place = Span { start: end.saturating_sub(1), end };
        return Report::error(place, "`;` is missing after this").help("write `;` here");
    }
    let expected = match &error.variant {
        _ if token_at > rule_at => String::new(),
        ErrorVariant::ParsingError { positives, .. } => expected(positives),
        ErrorVariant::CustomError { message } => message.clone(),
    };
    let found = match rest.split_whitespace().next() {
        None => "the text ends here".to_owned(),
        Some(word) => format!("`{}` does not fit here", first_token(word)),
    };
    let report = Report::error(here, found);
    if wants_end {
        return report.help("expected `;`");
    }
    if expected.is_empty() { report } else { report.help(format!("expected {expected}")) }
}

/// A syntax error in what a tool's params are given.
pub(super) fn given(text: &str, error: &Error<Rule>) -> Report {
    let (at, ..) = place(text, error);
    let (rest, before) = (&text[at..], text[..at].trim_end());
    let here = Span { start: at, end: at + rest.chars().next().map_or(0, char::len_utf8) };
    let habit = || habit(rest, before, here).filter(|_| !rest.is_empty());
    spelling(text, rest, before, here).or_else(habit).unwrap_or_else(|| {
        let found = match rest.split_whitespace().next() {
            None => "the text ends here".to_owned(),
            Some(word) => format!("`{}` does not fit here", first_token(word)),
        };
        Report::error(here, found).help("write `PARAM = VALUE`, as in `D = 0.25inch, flute = 18`")
    })
}

/// Where a text stopped to fit: the place itself, and how far rules and tokens came.
fn place(text: &str, error: &Error<Rule>) -> (usize, usize, usize) {
    let rule_at = match error.location {
        InputLocation::Pos(at) | InputLocation::Span((at, _)) => at,
    };
    // Rules are tried where they begin; a token may have been missing further on.
    let token_at = error.parse_attempts().map_or(0, |attempts| attempts.max_position);
    let at = rule_at.max(token_at);
    (at + text[at..].len() - text[at..].trim_start().len(), rule_at, token_at)
}

/// Mistakes that a character gives away.
fn spelling(text: &str, rest: &str, before: &str, here: Span) -> Option<Report> {
    let next = rest.chars().next()?;
    let report = |message: String, help: &str| Some(Report::error(here, message).help(help));
    let digits = |s: &str| s.chars().take_while(char::is_ascii_digit).collect::<String>();
    match next {
        '.' if rest[1..].starts_with(|c: char| c.is_ascii_digit()) => {
            let fraction = digits(&rest[1..]);
            report(
                format!("`.{fraction}` needs a digit before the point"),
                &format!("write `0.{fraction}`"),
            )
        }
        '.' if before.ends_with(|c: char| c.is_ascii_digit()) => {
            report("a number ends in a point".into(), "write `5` or `5.0`, not `5.`")
        }
        '°' => report("`°` is not a unit".into(), "write `3deg`"),
        '²' | '³' => {
            let power = if next == '²' { 2 } else { 3 };
            report(format!("`{next}` is not a name"), &format!("write `d^{power}`"))
        }
        '⌀' | 'ø' | 'Ø' => report(
            format!("`{next}` is not a name"),
            "coordinates are radii: write half the diameter",
        ),
        '\'' => report("`'` is not part of the language".into(), "write text between `\"`"),
        '^' => report("`^` does not chain".into(), "write parentheses: `(a^b)^c`"),
        '"' if text.matches('"').count() % 2 == 1 => {
            report("this text does not end".into(), "close it with `\"` on the same line")
        }
        '"' => report(
            "text stands only behind the tool's name and `mount`".into(),
            "write it as in `tool Name \"what it is\" { … }` or `mount \"file.tool\" as NAME`",
        ),
        '_' => report("a name begins with a letter".into(), "drop the `_`"),
        _ if !next.is_ascii() => report(
            format!("`{next}` is not part of the language"),
            "names are ASCII letters, digits and `_`",
        ),
        _ => None,
    }
}

/// Habits from elsewhere: a unit apart from its number, `and`, a forgotten brace.
fn habit(rest: &str, before: &str, here: Span) -> Option<Report> {
    let next = word(rest);
    let place = Span { end: here.start + next.len().max(here.end - here.start), ..here };
    if ["mm", "inch", "m", "deg", "rad", "in"].contains(&next)
        && before.ends_with(|c: char| c.is_ascii_digit())
    {
        let digits = before.rfind(|c: char| !(c.is_ascii_digit() || c == '.')).map_or(0, |i| i + 1);
        let number = before.get(digits..).unwrap_or("6");
        return Some(
            Report::error(place, format!("a space before the unit `{next}`"))
                .help(format!("write `{number}{next}`")),
        );
    }
    if ["and", "or"].contains(&next) || rest.starts_with("&&") || rest.starts_with("||") {
        return Some(Report::error(place, "conditions are not joined by a word").help(
            "all hold that stand between commas: `a <= b, c <= d`; \"or\" is `min(a, b) <= 0`",
        ));
    }
    let digit = |c: Option<char>| c.is_some_and(|c| c.is_ascii_digit());
    if rest.starts_with(',') && digit(before.chars().last()) && digit(rest.chars().nth(1)) {
        return Some(
            Report::error(here, "a comma stands between things of a list")
                .help("a decimal comma? write a point, as in `0.5`"),
        );
    }
    if rest.starts_with(';') && before.is_empty() {
        return Some(Report::error(here, "a `;` too many").help("drop it: a region ends with `}`"));
    }
    if rest.starts_with("/*") {
        return Some(Report::error(here, "this comment does not end").help("close it with `*/`"));
    }
    if FILES.contains(&next) {
        return Some(
            Report::error(place, format!("a second {next}")).help("write one tool or solid a file"),
        );
    }
    if rest.trim().is_empty() && before.matches("/*").count() > before.matches("*/").count() {
        let start = here.start - before.len() + before.rfind("/*").unwrap_or(0);
        return Some(
            Report::error(Span { start, end: start + 2 }, "this comment does not end")
                .help("close it with `*/`"),
        );
    }
    if rest.trim().is_empty() && !before.is_empty() {
        return Some(Report::error(here, "the text ends here").help("is a `}` or `;` missing?"));
    }
    None
}

/// An item or property that begins with a word that none does.
fn item(text: &str, rest: &str, at: usize, offset: usize) -> Option<Report> {
    let whole = text.trim_start();
    let first = word(whole);
    if first.is_empty() {
        return None;
    }
    // A whole file comes with its header, an item without.
    let header = offset == 0 && at == text.len() - whole.len();
    if header && !FILES.contains(&first) {
        let span = Span { start: at, end: at + first.len() };
        let report = Report::error(span, format!("a file does not begin with `{first}`"));
        return Some(match nearest(first, FILES) {
            Some(meant) => report.help(format!("did you mean `{meant}`?")),
            None => report.help("write `tool Name { … }`, or `solid Name { … }` without an axis"),
        });
    }
    if !FILES.contains(&first) && !ITEMS.contains(&first) {
        let start = offset + text.len() - whole.len();
        let report = Report::error(
            Span { start, end: start + first.len() },
            format!("no item begins with `{first}`"),
        );
        return Some(match (first, nearest(first, ITEMS.into_iter().chain(FILES))) {
            ("depth", _) => report.help("`depth:` belongs inside a `region`"),
            (_, Some(meant)) => report.help(format!("did you mean `{meant}`?")),
            _ => report
                .help(format!("an item is one of {}", ITEMS.map(|i| format!("`{i}`")).join(", "))),
        });
    }
    let wrong = word(rest);
    if first == "region" && !wrong.is_empty() && text[..at].contains('{') {
        let after = rest[wrong.len()..].trim_start();
        if after.starts_with(':') && !PROPERTIES.contains(&wrong) {
            let start = offset + at;
            let report = Report::error(
                Span { start, end: start + wrong.len() },
                format!("a region has no `{wrong}`"),
            );
            return Some(match nearest(wrong, PROPERTIES) {
                Some(meant) => report.help(format!("did you mean `{meant}`?")),
                None => report.help("a region says `depth`, `magnitude`, `direction`, `niceness`"),
            });
        }
    }
    None
}

fn word(text: &str) -> &str {
    let end = text.find(|c: char| !(c.is_ascii_alphanumeric() || c == '_')).unwrap_or(text.len());
    if text.starts_with(|c: char| c.is_ascii_alphabetic()) { &text[..end] } else { "" }
}

fn first_token(text: &str) -> &str {
    match word(text) {
        "" => &text[..text.chars().next().map_or(0, char::len_utf8)],
        word => word,
    }
}

fn ends_a_value(before: &str) -> bool {
    before.ends_with(|c: char| c.is_ascii_alphanumeric() || c == ')' || c == '_')
}

fn starts_a_word(rest: &str) -> bool {
    ITEMS.into_iter().chain(PROPERTIES).any(|item| word(rest) == item)
}

/// The rules that would have fitted, as a person would write them.
fn expected(rules: &[Rule]) -> String {
    let mut words: Vec<&str> = rules.iter().filter_map(|rule| describe(*rule)).collect();
    words.sort_unstable();
    words.dedup();
    match words.as_slice() {
        [] => String::new(),
        [one] => (*one).to_owned(),
        [most @ .., last] => format!("{} or {last}", most.join(", ")),
    }
}

fn describe(rule: Rule) -> Option<&'static str> {
    Some(match rule {
        Rule::expr
        | Rule::product
        | Rule::signed
        | Rule::power
        | Rule::number
        | Rule::signed_atom => "an expression",
        Rule::call | Rule::variable | Rule::group => "an expression",
        Rule::name => "a name",
        Rule::text => "a text in `\"`",
        Rule::tuple => "a point in parentheses",
        Rule::plus | Rule::times | Rule::minus => "an operator",
        Rule::compare => "`<=` or `>=`",
        Rule::condition => "a condition",
        Rule::surface => "`as`",
        Rule::where_ => "`where`",
        Rule::with | Rule::k_with => "`with`",
        Rule::at | Rule::k_at => "`at`",
        Rule::setting => "`PARAM = VALUE`",
        Rule::cutting | Rule::k_cutting => "`cutting`",
        Rule::scalar | Rule::direction => "`depth:`, `magnitude:`, `direction:`, `niceness:`",
        Rule::sign => "`+` or `-`",
        Rule::k_z => "`z`",
        Rule::k_tool | Rule::tool => "`tool Name { … }`",
        Rule::k_solid | Rule::solid => "`solid Name { … }`",
        Rule::k_from => "`from`",
        Rule::which | Rule::path => "a surface's name",
        Rule::EOI => "the end",
        Rule::stray | Rule::tool_item | Rule::units => "an item",
        _ => return None,
    })
}
