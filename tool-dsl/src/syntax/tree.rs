//! The syntax tree: the text as written, each node with its span.

use crate::domain::Domain;
use crate::number::Number;
use crate::source::Span;

/// A name and its span.
#[derive(Clone, Debug, PartialEq)]
pub struct Name {
    /// The text.
    pub text: String,
    /// Its span.
    pub span: Span,
}

/// A whole file: one tool, or one solid.
#[derive(Clone, Debug)]
pub struct Tool {
    /// The domain of the coordinates, which tells a tool from a solid.
    pub domain: Domain,
    /// The name of the generated type.
    pub name: Name,
    /// The description for people.
    pub title: Option<String>,
    /// The items, in order.
    pub items: Vec<Item>,
    /// The first words of items that could not be read, and the names that they define. Their definitions are missing
    /// from `items`.
    pub unparsed: Vec<String>,
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
        /// True if the spindle lies toward smaller z.
        down: bool,
        /// The span of the whole item.
        span: Span,
    },
    /// `profile { … }`
    Profile(Profile),
    /// `mount "er16.tool" as nut at z = 30;`
    Mount(Mount),
    /// `regions nearest;` or `regions smooth w;`
    Regions {
        /// The span of the whole item.
        span: Span,
        /// The tangent length of rounded corners, for `smooth`.
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
    /// The start point.
    pub start: Tuple,
    /// The segments, in order.
    pub segments: Vec<PathSegment>,
    /// The span of the item's keyword.
    pub span: Span,
}

/// One segment of a profile.
#[derive(Clone, Debug)]
pub struct PathSegment {
    /// The end point.
    pub end: Tuple,
    /// The arc, if the segment is not straight.
    pub arc: Option<Arc>,
    /// The surface to which it belongs.
    pub surface: Name,
    /// `cutting`, if given.
    pub cutting: Option<Span>,
    /// The span of the segment; in a list of points, the span of its own point.
    pub span: Span,
}

/// `arc to P center C` or `arc to P radius R`, `concave` or not.
#[derive(Clone, Debug)]
pub struct Arc {
    /// The centre, or else the radius.
    pub circle: ArcCircle,
    /// `concave`, if given.
    pub concave: Option<Span>,
}

/// The definition of an arc's circle.
#[derive(Clone, Debug)]
pub enum ArcCircle {
    /// Its centre.
    Center(Tuple),
    /// Its radius.
    Radius(Expr),
}

/// Another file's tool, mounted as a part of this one.
#[derive(Clone, Debug)]
pub struct Mount {
    /// The file, as written.
    pub file: Name,
    /// The name of the part.
    pub name: Name,
    /// `cutting`, if given.
    pub cutting: Option<Span>,
    /// The arguments of the mounted tool's parameters.
    pub arguments: Vec<Definition>,
    /// The z of its tip, if not at the tool's tip.
    pub position: Option<Expr>,
    /// The span of the whole item.
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
    /// The conditions, all of which have to hold.
    pub conditions: Vec<Condition>,
    /// `depth:`, `magnitude:`, `niceness:`.
    pub scalars: Vec<ScalarProperty>,
    /// `direction:`.
    pub direction: Vec<DirectionProperty>,
}

/// `a <= b <= c`
#[derive(Clone, Debug)]
pub struct Condition {
    /// The first expression.
    pub first: Expr,
    /// Each comparison, and the expression after it.
    pub rest: Vec<(Compare, Expr)>,
    /// The span of the whole condition.
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

/// A scalar output.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// The penetration depth.
    Depth,
    /// The magnitude of the contact.
    Magnitude,
    /// The quality of the contact.
    Niceness,
}

impl Quantity {
    /// Returns its keyword.
    pub fn keyword(self) -> &'static str {
        match self {
            Quantity::Depth => "depth",
            Quantity::Magnitude => "magnitude",
            Quantity::Niceness => "niceness",
        }
    }
}

/// `depth: 1 - d;`, `niceness: depth allow rising;`
#[derive(Clone, Debug)]
pub struct ScalarProperty {
    /// The quantity.
    pub quantity: Quantity,
    /// Its value.
    pub value: Expr,
    /// `allow rising`, of a niceness.
    pub allow_rising: bool,
    /// The span of the whole property.
    pub span: Span,
}

/// `direction: (1, 0) allow oblique;`
#[derive(Clone, Debug)]
pub struct DirectionProperty {
    /// The direction.
    pub direction: Direction,
    /// `allow oblique`.
    pub allow_oblique: bool,
    /// The span of the whole property.
    pub span: Span,
}

/// A direction.
#[derive(Clone, Debug)]
pub enum Direction {
    /// The vector `(1, 0)`, to be normalised.
    Vector(Tuple),
    /// `away from P`
    AwayFrom(Tuple),
    /// `toward P`
    Toward(Tuple),
}

/// `(a, b)`
#[derive(Clone, Debug)]
pub struct Tuple {
    /// The components.
    pub components: Vec<Expr>,
    /// Its span, including the parentheses.
    pub span: Span,
}

/// A law at the tool's level.
#[derive(Clone, Debug)]
pub struct Law {
    /// Magnitude or niceness.
    pub quantity: Quantity,
    /// The surfaces to which it applies, those of a part as `part.surface`; empty for all surfaces.
    pub surfaces: Vec<Name>,
    /// Its value.
    pub value: Expr,
    /// `allow rising`, of a niceness.
    pub allow_rising: bool,
    /// The span of the whole law.
    pub span: Span,
}

/// An expression.
#[derive(Clone, Debug)]
pub struct Expr {
    /// The kind of expression.
    pub kind: ExprKind,
    /// Its span.
    pub span: Span,
}

/// The kinds of expression.
#[derive(Clone, Debug)]
pub enum ExprKind {
    /// A number with its unit, if any.
    Number(Number, Option<Name>),
    /// A name.
    Name(String),
    /// A function call.
    Call(Name, Vec<Expr>),
    /// A negation.
    Neg(Box<Expr>),
    /// An operation on two operands.
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
