//! O-words: the labels of programs and subprograms, and where these stand in a file.

use super::block::{begin, next, unexpected};
use super::expression::{Cursor, Parameters, value};
use super::{GcodeFault, text};
use std::collections::HashMap;
use std::fmt;

/// The label of a program or a subprogram.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(super) enum Label {
    Number(u32),
    /// A name in small letters without blanks, as names are compared.
    Name(String),
}

impl fmt::Display for Label {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Label::Number(number) => write!(f, "O{number}"),
            Label::Name(name) => write!(f, "O<{name}>"),
        }
    }
}

/// The word after a label.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Role {
    /// None: a program or subprogram of ISO 6983, which M30 or M99 ends.
    Title,
    /// `sub`: a subprogram of O-words, which `endsub` ends.
    Sub,
    EndSub,
    Call,
}

/// An O-word.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct OWord {
    pub(super) label: Label,
    pub(super) role: Role,
}

/// Reads an O-word. The label can be an expression.
pub(super) fn o_word(cursor: &mut Cursor, parameters: &Parameters) -> Result<OWord, GcodeFault> {
    cursor.advance();
    let label = match cursor.take(b'<') {
        true => {
            let name = cursor.take_until('>').ok_or(super::ExpressionFault::OpenName)?;
            let name: String = name.chars().filter(|c| !c.is_whitespace()).collect();
            Label::Name(name.to_lowercase())
        }
        false => match value(cursor, parameters)? {
            number if number.fract() == 0.0 && (0.0..=1e8).contains(&number) => {
                Label::Number(number as u32)
            }
            value => {
                let expected = "a whole number from 0";
                return Err(GcodeFault::NotAllowed { word: 'O', value, expected });
            }
        },
    };
    next(cursor)?;
    let word = cursor.take_while(|byte| byte.is_ascii_alphabetic());
    let role = match word.to_ascii_lowercase().as_str() {
        "" => Role::Title,
        "sub" => Role::Sub,
        "endsub" => Role::EndSub,
        "call" => Role::Call,
        _ => return Err(GcodeFault::ControlFlow { word: super::unquoted(word) }),
    };
    match next(cursor)? {
        None => Ok(OWord { label, role }),
        Some(b'[') if role != Role::Title => {
            let remedy = "assign parameters from #31 on before the call instead";
            let meaning = "a word with arguments";
            Err(GcodeFault::NotRead { word: word.to_ascii_lowercase(), meaning, remedy })
        }
        Some(_) => Err(unexpected(cursor)),
    }
}

/// A place in the text: the byte at which a line begins, and its number from 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Place {
    pub(super) offset: usize,
    pub(super) line: usize,
}

/// A subprogram.
#[derive(Clone, Copy, Debug)]
pub(super) struct Subprogram {
    /// [`Role::Title`] or [`Role::Sub`].
    pub(super) role: Role,
    /// The line after the label.
    pub(super) body: Place,
    /// The line after `endsub`.
    pub(super) after: Option<Place>,
}

/// The subprograms of a file.
#[derive(Clone, Debug, Default)]
pub(super) struct Subprograms {
    known: HashMap<Label, Subprogram>,
}

impl Subprograms {
    /// Finds the labels of a text. Lines that are not understood are left to the interpreter.
    ///
    /// # Errors
    /// A label that stands twice, a `sub` in another, a `sub` without `endsub`; each with its line.
    pub(super) fn find(text: &str) -> Result<Subprograms, (usize, GcodeFault)> {
        let mut found = Subprograms::default();
        let mut lines: HashMap<Label, usize> = HashMap::new();
        let mut open: Option<(Label, usize)> = None;
        let mut place = Place { offset: 0, line: 1 };
        while let Some((line, after)) = text::line(text, place) {
            let at = place.line;
            place = after;
            let (_, mut cursor) = begin(line);
            if !matches!(next(&mut cursor), Ok(Some(b'O' | b'o'))) {
                continue;
            }
            // A label that is an expression can only be called.
            let Ok(OWord { label, role }) = o_word(&mut cursor, &Parameters::default()) else {
                continue;
            };
            let nesting = |word, problem| {
                let label = label.to_string();
                Err((at, GcodeFault::Nesting { label, word, problem }))
            };
            match (role, &open) {
                (Role::Call, _) => {}
                (Role::Sub, Some(_)) => {
                    return nesting(
                        "sub",
                        "it stands in another subprogram: end that with endsub before",
                    );
                }
                (Role::Sub | Role::Title, _) => {
                    if let Some(first) = lines.insert(label.clone(), at) {
                        let label = label.to_string();
                        return Err((at, GcodeFault::SecondLabel { label, first }));
                    }
                    if role == Role::Sub {
                        open = Some((label.clone(), at));
                    }
                    found.known.insert(label, Subprogram { role, body: after, after: None });
                }
                (Role::EndSub, Some((opened, _))) if *opened == label => {
                    if let Some(known) = found.known.get_mut(&label) {
                        known.after = Some(after);
                    }
                    open = None;
                }
                (Role::EndSub, Some(_)) => {
                    return nesting("endsub", "another subprogram is open: end that before");
                }
                // The end of a subprogram that has a title is refused where it is executed.
                (Role::EndSub, None) => {}
            }
        }
        match open {
            Some((label, at)) => {
                let problem = "it has no endsub: add it";
                Err((at, GcodeFault::Nesting { label: label.to_string(), word: "sub", problem }))
            }
            None => Ok(found),
        }
    }

    /// Returns whether there is one.
    pub(super) fn is_known(&self) -> bool {
        !self.known.is_empty()
    }

    pub(super) fn get(&self, label: &Label) -> Option<&Subprogram> {
        self.known.get(label)
    }
}
