//! The syntax tree: what was written, each piece with its place.

use crate::domain::Domain;
use crate::number::Number;
use crate::source::Span;

/// A name and where it stands.
#[derive(Clone, Debug, PartialEq)]
pub struct Name {
    /// The word.
    pub word: String,
    /// Its place.
    pub span: Span,
}

/// A whole file: one tool, or one solid.
#[derive(Clone, Debug)]
pub struct Tool {
    /// Which of the two.
    pub domain: Domain,
    /// The type's name.
    pub name: Name,
    /// What it is, for people.
    pub title: Option<String>,
    /// The items in order.
    pub items: Vec<Item>,
    /// The first words of items that could not be read, and the names that they define: what they
    /// would have said is missing.
    pub broken: Vec<String>,
}

/// One item of a tool.
#[derive(Clone, Debug)]
pub enum Item {
    /// `units mm;`
    Units(Name),
    /// `let r = 3;`
    Let(Definition),
    /// `param r = 3;`
    Param(Definition),
    /// `curve c = d - r;`
    Curve(Definition),
    /// `tip z = 20;`
    Tip(Expr),
    /// `spindle -z;`
    Spindle {
        /// Whether the spindle lies toward smaller z.
        down: bool,
        /// The whole item.
        span: Span,
    },
    /// `profile { … }`
    Profile(Profile),
    /// `mount "er16.tool" as nut at z = 30;`
    Mount(Mount),
    /// `regions nearest;` or `regions smooth w;`
    Regions {
        /// The whole item.
        span: Span,
        /// The tangent length.
        smooth: Option<Expr>,
    },
    /// `region … { … }`
    Region(Region),
    /// `bsp { a, b }`
    Bsp(Vec<Name>),
    /// `magnitude shank: …;`
    Law(Law),
}

/// A named value.
#[derive(Clone, Debug)]
pub struct Definition {
    /// The name.
    pub name: Name,
    /// The value.
    pub value: Expr,
}

/// The outline of the solid's section, from the axis to the axis.
#[derive(Clone, Debug)]
pub struct Profile {
    /// Where it begins.
    pub start: Tuple,
    /// Its pieces in order.
    pub pieces: Vec<Piece>,
    /// The whole item.
    pub span: Span,
}

/// One segment of a profile.
#[derive(Clone, Debug)]
pub struct Piece {
    /// Where it ends.
    pub to: Tuple,
    /// How it gets there, if not straight.
    pub arc: Option<Arc>,
    /// The surface that it belongs to.
    pub surface: Name,
    /// `cutting`, if given.
    pub cutting: Option<Span>,
    /// The segment; of a list of points, its own point.
    pub span: Span,
}

/// `arc to P center C` or `arc to P radius R`, `concave` or not.
#[derive(Clone, Debug)]
pub struct Arc {
    /// The centre, or else the radius.
    pub round: Round,
    /// `concave`, if given.
    pub concave: Option<Span>,
}

/// What is said of an arc's circle.
#[derive(Clone, Debug)]
pub enum Round {
    /// Its centre.
    Center(Tuple),
    /// Its radius.
    Radius(Expr),
}

/// Another file's tool, as a part of this one.
#[derive(Clone, Debug)]
pub struct Mount {
    /// The file, as it is written.
    pub file: Name,
    /// What the part is called.
    pub name: Name,
    /// `cutting`, if given.
    pub cutting: Option<Span>,
    /// What its params are given.
    pub with: Vec<Definition>,
    /// Where its tip is, if not at the tool's.
    pub at: Option<Expr>,
    /// The whole item.
    pub span: Span,
}

/// A region written by hand.
#[derive(Clone, Debug)]
pub struct Region {
    /// Its name.
    pub name: Name,
    /// `as flute`, if given.
    pub surface: Option<Name>,
    /// `cutting`, if given.
    pub cutting: Option<Span>,
    /// The conditions, all of which hold.
    pub conditions: Vec<Condition>,
    /// `depth:`, `magnitude:`, `niceness:`.
    pub scalars: Vec<Scalar>,
    /// `direction:`.
    pub direction: Vec<Course>,
}

/// `a <= b <= c`
#[derive(Clone, Debug)]
pub struct Condition {
    /// The first expression.
    pub first: Expr,
    /// Each comparison and what follows it.
    pub rest: Vec<(Compare, Expr)>,
    /// The whole condition.
    pub span: Span,
}

/// A comparison that a closed region can have.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Compare {
    /// `<=`
    AtMost,
    /// `>=`
    AtLeast,
}

/// What is felt, as a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// How deep a point lies.
    Depth,
    /// How hard it is pushed.
    Magnitude,
    /// How good a contact there is.
    Niceness,
}

impl Quantity {
    /// The word for it in a file.
    pub fn word(self) -> &'static str {
        match self {
            Quantity::Depth => "depth",
            Quantity::Magnitude => "magnitude",
            Quantity::Niceness => "niceness",
        }
    }
}

/// `depth: 1 - d;`, `niceness: depth allow rising;`
#[derive(Clone, Debug)]
pub struct Scalar {
    /// Which.
    pub quantity: Quantity,
    /// Its value.
    pub value: Expr,
    /// `allow rising`, of a niceness.
    pub rising: bool,
    /// The whole property.
    pub span: Span,
}

/// `direction: (1, 0) allow oblique;`
#[derive(Clone, Debug)]
pub struct Course {
    /// Where it leads.
    pub direction: Direction,
    /// `allow oblique`.
    pub oblique: bool,
    /// The whole property.
    pub span: Span,
}

/// Where a direction leads.
#[derive(Clone, Debug)]
pub enum Direction {
    /// `(1, 0)`, made a unit vector.
    Along(Tuple),
    /// `away from P`
    AwayFrom(Tuple),
    /// `toward P`
    Toward(Tuple),
}

/// `(a, b)`
#[derive(Clone, Debug)]
pub struct Tuple {
    /// The components.
    pub parts: Vec<Expr>,
    /// With its parentheses.
    pub span: Span,
}

/// A law at the tool's level.
#[derive(Clone, Debug)]
pub struct Law {
    /// Magnitude or niceness.
    pub quantity: Quantity,
    /// The surfaces it is for, those of a part as `part.surface`; none means all.
    pub surfaces: Vec<Name>,
    /// Its value.
    pub value: Expr,
    /// `allow rising`, of a niceness.
    pub rising: bool,
    /// The whole law.
    pub span: Span,
}

/// An expression.
#[derive(Clone, Debug)]
pub struct Expr {
    /// What it is.
    pub kind: ExprKind,
    /// Where it stands.
    pub span: Span,
}

/// The kinds of expression.
#[derive(Clone, Debug)]
pub enum ExprKind {
    /// A number with its unit, if any.
    Number(Number, Option<Name>),
    /// A name.
    Name(String),
    /// A function.
    Call(Name, Vec<Expr>),
    /// A minus sign.
    Neg(Box<Expr>),
    /// Two operands.
    Binary(Binary, Box<Expr>, Box<Expr>),
}

/// The binary operations.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Binary {
    /// `+`
    Add,
    /// `-`
    Sub,
    /// `*`
    Mul,
    /// `/`
    Div,
    /// `^`
    Pow,
}
