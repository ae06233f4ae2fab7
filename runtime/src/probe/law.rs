//! How contacts push.

use std::fmt;
use std::str::FromStr;

/// How a contact's magnitude becomes a force on the tool. `m` is the magnitude, `w` the weight,
/// `n` the part's outward normal, `u` the direction to the tool's nearest surface.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Law {
    /// `w m (n − u)` (Ho 1999, eq. 5.1, without the factor ½). Not conservative.
    #[default]
    Thesis,
    /// `w m ∇m`, the gradient of the energy `½ Σ w m²`: conservative.
    Gradient,
    /// As the thesis, without points whose normal faces away (`u · n > 0`), for thin sheets.
    Facing,
}

/// For how much a point counts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Weights {
    /// For its share of the surface: forces converge as the cloud gets denser.
    #[default]
    Area,
    /// For 1, as in the thesis: forces grow with the density.
    Unit,
}

/// A word that is none of those known.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("`{word}` is not one of {known}")]
pub struct UnknownWord {
    /// The word.
    pub word: String,
    /// What would have been understood.
    pub known: &'static str,
}

macro_rules! words {
    ($type:ident, $known:literal, $($variant:ident $word:literal),*) => {
        impl fmt::Display for $type {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str(match self { $($type::$variant => $word),* })
            }
        }

        impl FromStr for $type {
            type Err = UnknownWord;

            fn from_str(word: &str) -> Result<$type, UnknownWord> {
                match word {
                    $($word => Ok($type::$variant),)*
                    _ => Err(UnknownWord { word: word.to_owned(), known: $known }),
                }
            }
        }
    };
}

words!(Law, "thesis, gradient, facing", Thesis "thesis", Gradient "gradient", Facing "facing");
words!(Weights, "area, unit", Area "area", Unit "unit");
