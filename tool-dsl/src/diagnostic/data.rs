//! Data of diagnostics, each shown in one way.

use std::fmt;

/// The sizes of numbers that people read without an exponent.
const SIZES_WITHOUT_EXPONENT: std::ops::Range<f64> = 1e-4..1e15;

/// A number, shown with six significant digits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FormattedNumber(pub f64);

impl fmt::Display for FormattedNumber {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&format_number(self.0))
    }
}

/// Returns a number for people: six significant digits.
pub fn format_number(value: f64) -> String {
    let size = value.abs();
    if size == 0.0 || !SIZES_WITHOUT_EXPONENT.contains(&size) {
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

/// Definitions in a cycle, each with the one it needs.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CycleLinks(pub Vec<[String; 2]>);

impl fmt::Display for CycleLinks {
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
pub struct MountChain(pub Vec<String>);

impl fmt::Display for MountChain {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0.join(" mounts "))
    }
}

/// The tokens of the grammar that would have been accepted.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Expected {
    /// Any of these.
    OneOf(Vec<String>),
    /// This word, which is spelt nearly like the one that is there.
    Similar(String),
    /// A segment instead of a second `start`.
    OneStart,
    /// A param and its value.
    Argument,
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
            Expected::Similar(word) => f.write_str(word),
            Expected::Argument => f.write_str("`PARAM = VALUE`"),
            Expected::OneStart | Expected::Unknown => Ok(()),
        }
    }
}

/// The position in a file for which a value is computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// The value of a `let`.
    Let,
    /// The value of a `param`.
    Param,
    /// The exponent of a power.
    Exponent,
    /// The z of the tip.
    Tip,
    /// The position of a mount.
    At,
    /// A coordinate of a point.
    Point,
    /// A component of a direction.
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
    /// A digit at the start of a tool's name.
    DigitOfTool,
    /// A digit at the start of another name.
    Digit,
}

/// The remedy for an undefined name.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum NameRemedy {
    /// A similar name exists.
    Similar(String),
    /// The name must be defined.
    Define,
    /// The name is in an argument from outside the file, where no names are defined.
    Constant,
    /// The name is joined to a `-`.
    Dash,
}

/// The remedy for an unknown param.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ParamRemedy {
    /// A similar param exists.
    Similar(String),
    /// A `let` has the name.
    Let,
    /// The message lists the params.
    List,
}

/// The remedy for an unknown surface.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum SurfaceRemedy {
    /// A similar surface exists.
    Similar(String),
    /// The surfaces of the tool.
    List(Names),
    /// The surfaces of the mounted tool with this name.
    OfMount(Names),
    /// A surface of the profile must be named.
    OfProfile,
}

/// An operation that the dimensions of its operands do not allow.
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
    /// A curve without a name.
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

/// A statement that was to be proved for a box. An owner is a region, or `None` for the outside.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Statement {
    /// All points of the box belong to this owner.
    SingleOwner(Option<String>),
    /// Depth is continuous from one owner to another.
    ContinuousDepth(Option<String>, Option<String>),
    /// The steepness of depth is bounded in this region.
    BoundedSteepness(String),
    /// Depth is not negative in this owner.
    NonNegativeDepth(Option<String>),
    /// The regions that meet; this is their number.
    MeetingRegions(usize),
    /// Depth is the distance from the profile.
    DistanceFromProfile,
    /// The roots in all conditions exist.
    RealRoots,
}

impl fmt::Display for Statement {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Statement::SingleOwner(owner) => {
                write!(f, "whether all points belong to {}", shown(owner))
            }
            Statement::ContinuousDepth(from, to) => {
                write!(f, "whether depth is continuous from {} to {}", shown(from), shown(to))
            }
            Statement::BoundedSteepness(region) => {
                write!(f, "whether the steepness of depth is bounded in `{region}`")
            }
            Statement::NonNegativeDepth(owner) => {
                write!(f, "whether depth is at least 0 in {}", shown(owner))
            }
            Statement::MeetingRegions(count) => write!(f, "which of {count} regions meet"),
            Statement::DistanceFromProfile => {
                f.write_str("whether depth is the distance from the profile")
            }
            Statement::RealRoots => {
                f.write_str("whether each number under a root of a condition is at least 0")
            }
        }
    }
}

fn shown(owner: &Option<String>) -> String {
    match owner {
        Some(region) => format!("`{region}`"),
        None => "the outside".to_owned(),
    }
}

/// Returns the word of `known` that is nearest to `word`, if it is similar enough.
pub fn nearest<'a>(name: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    known
        .into_iter()
        .map(|candidate| (strsim::damerau_levenshtein(name, candidate), candidate))
        // A word of one letter is like no other.
        .filter(|(edits, candidate)| {
            let length = candidate.len().max(name.len());
            *edits < length && *edits <= length.div_ceil(3)
        })
        .min()
        .map(|(_, candidate)| candidate)
}
