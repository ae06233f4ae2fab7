//! Enumerations that are written as keywords.

/// A word that is not one of the known keywords.
#[derive(Clone, PartialEq, Eq, thiserror::Error)]
#[error("`{word}` is not one of {known}")]
pub struct ParseEnumError {
    /// The word.
    pub word: String,
    /// The keywords that are known.
    pub known: &'static str,
}

crate::debug_as_sentence!(ParseEnumError);

/// Implements `Display` and `FromStr` for an enumeration, with a keyword per variant.
macro_rules! keyword_enum {
    ($type:ident, $known:literal, $($variant:ident $word:literal),*) => {
        impl std::fmt::Display for $type {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str(match self { $($type::$variant => $word),* })
            }
        }

        impl std::str::FromStr for $type {
            type Err = crate::keywords::ParseEnumError;

            fn from_str(word: &str) -> Result<$type, Self::Err> {
                match word {
                    $($word => Ok($type::$variant),)*
                    _ => Err(crate::keywords::ParseEnumError { word: word.to_owned(), known: $known }),
                }
            }
        }
    };
}

pub(crate) use keyword_enum;
