//! Choices that are written as words.

/// A word that is none of those known.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("`{word}` is not one of {known}")]
pub struct UnknownWord {
    /// The word.
    pub word: String,
    /// What would have been understood.
    pub known: &'static str,
}

/// A choice as the words it is written as.
macro_rules! words {
    ($type:ident, $known:literal, $($variant:ident $word:literal),*) => {
        impl std::fmt::Display for $type {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str(match self { $($type::$variant => $word),* })
            }
        }

        impl std::str::FromStr for $type {
            type Err = crate::words::UnknownWord;

            fn from_str(word: &str) -> Result<$type, Self::Err> {
                match word {
                    $($word => Ok($type::$variant),)*
                    _ => Err(crate::words::UnknownWord { word: word.to_owned(), known: $known }),
                }
            }
        }
    };
}

pub(crate) use words;
