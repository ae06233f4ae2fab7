//! Names of imported tools and their files.

use std::collections::BTreeSet;

/// The longest name of an imported tool, in characters, without the number that tells equal names apart.
const MAX_NAME: usize = 48;

/// Gives each tool and file a name of its own.
#[derive(Debug, Default)]
pub(super) struct Names(BTreeSet<String>);

impl Names {
    /// Returns the words of a label as a file name without ending, such as `d6_ball_er16`, different from all
    /// names given so far.
    pub(super) fn file(&mut self, label: &str, otherwise: &str) -> String {
        let name = snake(label);
        let name = if name.is_empty() { snake(otherwise) } else { name };
        let name = if name.is_empty() { "tool".to_owned() } else { name };
        let mut unique = name.clone();
        let mut k = 2;
        while !self.0.insert(unique.clone()) {
            unique = format!("{name}_{k}");
            k += 1;
        }
        unique
    }
}

/// Returns the ASCII letters and digits of a label, in lower case and joined by `_`.
fn snake(label: &str) -> String {
    let mut name = String::new();
    let mut characters = label.chars().peekable();
    while let Some(character) = characters.next() {
        if name.len() >= MAX_NAME {
            break;
        }
        match character {
            c if c.is_ascii_alphanumeric() => name.push(c.to_ascii_lowercase()),
            // A decimal point, so that D2.5 and D25 differ.
            '.' | ','
                if name.ends_with(|c: char| c.is_ascii_digit())
                    && characters.peek().is_some_and(char::is_ascii_digit) =>
            {
                name.push('p');
            }
            _ if !name.is_empty() && !name.ends_with('_') => name.push('_'),
            _ => {}
        }
    }
    name.trim_end_matches('_').to_owned()
}

/// Returns the name of a tool's type, such as `D6BallEr16`, from the name of its file.
pub(super) fn type_name(file: &str) -> String {
    let mut name = String::new();
    for word in file.split('_').filter(|word| !word.is_empty()) {
        // Two numbers must not run together.
        if name.ends_with(|c: char| c.is_ascii_digit())
            && word.starts_with(|c: char| c.is_ascii_digit())
        {
            name.push('X');
        }
        let mut letters = word.chars();
        name.extend(letters.next().map(|c| c.to_ascii_uppercase()));
        name.extend(letters);
    }
    if name.starts_with(|c: char| c.is_ascii_digit()) { format!("T{name}") } else { name }
}

/// Returns a text as it may stand in quotes: without control characters, quotes and characters that reverse the
/// direction of writing.
pub(super) fn quotable(text: &str) -> String {
    let text: String = text
        .chars()
        .map(|c| match c {
            '"' => '\'',
            '\\' => '/',
            c if c.is_control() || is_bidirectional(c) => ' ',
            c => c,
        })
        .collect();
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

fn is_bidirectional(c: char) -> bool {
    matches!(c, '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}
