//! The expected input, in terms that a user would write.

use crate::syntax::Rule;
use pest::error::{Error, ErrorVariant};

/// Returns descriptions of the rules and tokens that would have matched.
pub(super) fn expected(error: &Error<Rule>) -> Vec<String> {
    let attempts = error.parse_attempts();
    let token_at = attempts.as_ref().map_or(0, |attempts| attempts.max_position);
    let rules: &[Rule] = match &error.variant {
        ErrorVariant::ParsingError { positives, .. } if token_at <= super::rule_at(error) => {
            positives
        }
        _ => &[],
    };
    let tokens = attempts.as_ref().map_or(Vec::new(), |attempts| attempts.expected_tokens());
    let tokens: Vec<String> = tokens.iter().map(ToString::to_string).collect();
    let mut words: Vec<String> = rules.iter().filter_map(|r| rule(*r)).map(str::to_owned).collect();
    let ruled = !words.is_empty();
    words.extend(tokens.iter().filter_map(|t| token(t, ruled)));
    words.sort_unstable();
    words.dedup();
    words
}

/// Describes a token. Word tokens are described only if no rule is.
fn token(token: &str, ruled: bool) -> Option<String> {
    match token {
        "+" | "-" | "*" | "/" | "^" if !ruled => Some("an operator".to_owned()),
        ";" | "," | ":" | "=" | "{" | "}" | "(" | ")" => Some(format!("`{token}`")),
        "<=" | ">=" => Some("`<=` or `>=`".to_owned()),
        "as" => Some("`as NAME`".to_owned()),
        word if !ruled && super::word(word).len() == word.len() && word.len() > 1 => {
            Some(format!("`{word}`"))
        }
        _ => None,
    }
}

fn rule(rule: Rule) -> Option<&'static str> {
    Some(match rule {
        Rule::expr
        | Rule::product
        | Rule::signed
        | Rule::power
        | Rule::number
        | Rule::signed_atom => "an expression",
        Rule::call | Rule::variable | Rule::group => "an expression",
        Rule::name => "a name",
        Rule::text => "a text between `\"`",
        Rule::tuple => "a point in parentheses",
        Rule::plus | Rule::times | Rule::minus => "an operator",
        Rule::compare => "`<=` or `>=`",
        Rule::condition => "a condition",
        Rule::surface => "`as NAME`",
        Rule::where_ => "`where`",
        Rule::with | Rule::k_with => "`with`",
        Rule::at | Rule::k_at => "`at`",
        Rule::setting => "`PARAM = VALUE`",
        Rule::cutting | Rule::k_cutting => "`cutting`",
        Rule::allow | Rule::k_allow => "`allow`",
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
