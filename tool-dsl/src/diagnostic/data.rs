//! Data of diagnostics, each shown in one way.

use std::fmt;

/// A number, shown with six significant digits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Figure(pub f64);

impl fmt::Display for Figure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&figure(self.0))
    }
}

/// Returns a number for people: six significant digits.
pub fn figure(value: f64) -> String {
    let size = value.abs();
    if size == 0.0 || !(1e-4..1e15).contains(&size) {
        return if size == 0.0 { "0".to_owned() } else { format!("{value:.5e}") };
    }
    let decimals = (5 - size.log10().floor() as i32).max(0) as usize;
    let text = format!("{value:.decimals$}");
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        text
    }
}

/// Names, shown between backticks with commas; none of them as `none`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Names(pub Vec<String>);

impl Names {
    /// Collects names.
    pub fn new<'n>(names: impl IntoIterator<Item = &'n str>) -> Names {
        Names(names.into_iter().map(str::to_owned).collect())
    }
}

impl fmt::Display for Names {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.0.is_empty() {
            return f.write_str("none");
        }
        for (index, name) in self.0.iter().enumerate() {
            let comma = if index == 0 { "" } else { ", " };
            write!(f, "{comma}`{name}`")?;
        }
        Ok(())
    }
}

/// Definitions that need each other, each with the one it needs.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Links(pub Vec<[String; 2]>);

impl fmt::Display for Links {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, [name, needed]) in self.0.iter().enumerate() {
            let comma = if index == 0 { "" } else { ", " };
            write!(f, "{comma}`{name}` needs `{needed}`")?;
        }
        Ok(())
    }
}

/// Files, each of which mounts the next.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Chain(pub Vec<String>);

impl fmt::Display for Chain {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0.join(" mounts "))
    }
}

/// The tokens of the grammar that would have fitted.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Expected {
    /// Any of these.
    OneOf(Vec<String>),
    /// A param and its value.
    Setting,
    /// Not known.
    Unknown,
}

impl fmt::Display for Expected {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Expected::OneOf(words) => match words.as_slice() {
                [] => Ok(()),
                [one] => f.write_str(one),
                [most @ .., last] => write!(f, "{} or {last}", most.join(", ")),
            },
            Expected::Setting => f.write_str("`PARAM = VALUE`"),
            Expected::Unknown => Ok(()),
        }
    }
}

/// The part of a file that a value is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// The value of a `let`.
    Let,
    /// The value of a `param`.
    Param,
    /// The exponent of a power.
    Exponent,
    /// The place of the tip.
    Tip,
    /// The place of a mount.
    At,
    /// A part of a point.
    Point,
    /// A part of a direction.
    Direction,
    /// The tangent length of `regions smooth`.
    Smooth,
    /// The radius of an arc.
    Radius,
}

impl fmt::Display for Role {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Role::Let => "a `let`",
            Role::Param => "a `param`",
            Role::Exponent => "an exponent",
            Role::Tip => "`tip`",
            Role::At => "`at`",
            Role::Point => "a point",
            Role::Direction => "a direction",
            Role::Smooth => "`smooth`",
            Role::Radius => "`radius`",
        })
    }
}

/// The mistake in a name's first character.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NameStart {
    /// `_`.
    Underscore,
    /// A digit, of a tool's name.
    DigitOfTool,
    /// A digit, of another name.
    Digit,
}

/// The remedy for a name that nothing defines.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum NameRemedy {
    /// Another name is near.
    Meant(String),
    /// It is to be defined.
    Define,
    /// It stands in a value from outside the file, where no name is known.
    Constant,
    /// It is glued to a `-`.
    Dash,
}

/// The remedy for a param that a tool does not have.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ParamRemedy {
    /// Another param is near.
    Meant(String),
    /// A `let` has the name.
    Let,
    /// Its params are listed.
    List,
}

/// The remedy for a surface that a tool does not have.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum SurfaceRemedy {
    /// Another surface is near.
    Meant(String),
    /// The surfaces of the tool.
    List(Names),
    /// The surfaces of the mounted part that has the name.
    OfPart(Names),
    /// One of the profile's is to be named.
    OfProfile,
}

/// An operation that its operands' dimensions do not allow.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Operation {
    /// A sum.
    Add,
    /// A difference.
    Subtract,
    /// A product.
    Multiply,
    /// A quotient.
    Divide,
}

/// The expression that has no value at a point.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Subject {
    /// A quantity of a region.
    Quantity(&'static str, String),
    /// A curve with a name.
    Curve(String),
    /// A curve without one.
    Condition,
}

impl fmt::Display for Subject {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Subject::Quantity(quantity, region) => write!(f, "`{quantity}` of {region}"),
            Subject::Curve(name) => write!(f, "curve `{name}`"),
            Subject::Condition => f.write_str("a condition"),
        }
    }
}

/// A statement that was to be proved of a box. Its owner is a region, or the outside.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Statement {
    /// One owner alone has its points.
    Alone(Option<String>),
    /// The features that are nearest to its points belong to this owner.
    Nearest(Option<String>),
    /// Depth goes on from one owner to another.
    Continues(Option<String>, Option<String>),
    /// Depth is not negative in this owner.
    NotNegative(Option<String>),
    /// The regions that meet, which are so many.
    Crowd(usize),
    /// The solid ends on its profile.
    EndsOnProfile,
}

impl fmt::Display for Statement {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let shown = |owner: &Option<String>| match owner {
            Some(region) => format!("`{region}`"),
            None => "the outside".to_owned(),
        };
        match self {
            Statement::Alone(owner) => write!(f, "that {} alone has it", shown(owner)),
            Statement::Nearest(owner) => {
                write!(f, "that {} has what is nearest to its points", shown(owner))
            }
            Statement::Continues(from, to) => {
                write!(f, "that depth goes on from {} to {}", shown(from), shown(to))
            }
            Statement::NotNegative(owner) => {
                write!(f, "that depth is not negative in {}", shown(owner))
            }
            Statement::Crowd(count) => write!(f, "which of {count} regions meet"),
            Statement::EndsOnProfile => f.write_str("that the solid ends on the profile"),
        }
    }
}

/// Returns the word of `known` that is nearest to `word`, if it is near enough to be meant.
pub fn nearest<'a>(word: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    known
        .into_iter()
        .map(|candidate| (strsim::damerau_levenshtein(word, candidate), candidate))
        .filter(|(edits, candidate)| *edits <= candidate.len().max(word.len()).div_ceil(3))
        .min()
        .map(|(_, candidate)| candidate)
}
