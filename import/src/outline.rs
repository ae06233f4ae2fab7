//! The half section of a cutter or a holder, as the segments of a `.tool` file's profile, and the expressions in which the file
//! states their coordinates.

use std::collections::BTreeSet;
use std::fmt::{self, Write as _};

/// A point of the half section.
#[derive(Clone, Debug)]
pub(super) struct Point {
    /// The distance from the axis.
    pub(super) d: Term,
    /// The height above the tip.
    pub(super) z: Term,
}

impl Point {
    /// Creates a point from its coordinates `[d, z]`.
    fn new([d, z]: [&Term; 2]) -> Point {
        Point { d: d.clone(), z: z.clone() }
    }
}

/// The surface of a segment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Surface {
    name: &'static str,
    cutting: bool,
}

pub(super) const fn cutting(name: &'static str) -> Surface {
    Surface { name, cutting: true }
}

pub(super) const fn plain(name: &'static str) -> Surface {
    Surface { name, cutting: false }
}

#[derive(Clone, Debug)]
struct Segment {
    to: Point,
    /// An arc, and whether it bulges into the material.
    arc: Option<(Circle, bool)>,
    surface: Surface,
}

#[derive(Clone, Debug)]
enum Circle {
    Centre(Point),
    Radius(Term),
}

/// A profile under construction, from the axis at the tip to the axis at the other end.
#[derive(Clone, Debug)]
pub(super) struct Outline {
    params: Vec<(&'static str, f64, bool)>,
    lets: Vec<(&'static str, Term)>,
    start: Point,
    segments: Vec<Segment>,
}

/// Coordinates nearer than this part of the larger one are equal, since libraries state some six digits: a neck of the
/// width of the flutes is no step.
pub(super) const SAME: f64 = 5e-6;

impl Outline {
    pub(super) fn new() -> Outline {
        let zero = Term::number(0.0);
        Outline {
            params: Vec::new(),
            lets: Vec::new(),
            start: Point::new([&zero, &zero]),
            segments: Vec::new(),
        }
    }

    /// Adds a param of the file, a length.
    pub(super) fn param(&mut self, name: &'static str, value: f64) -> Term {
        self.params.push((name, value, false));
        Term::name(name, value)
    }

    /// Returns the param of this name, or adds it, a length.
    pub(super) fn known_or_param(&mut self, name: &'static str, value: f64) -> Term {
        match self.params.iter().any(|(known, ..)| *known == name) {
            true => Term::name(name, value),
            false => self.param(name, value),
        }
    }

    /// Adds a param of the file, an angle in degrees.
    pub(super) fn angle(&mut self, name: &'static str, degrees: f64) -> Term {
        self.params.push((name, degrees, true));
        Term::name(name, degrees)
    }

    /// Names a value that several segments use.
    pub(super) fn define(&mut self, name: &'static str, term: Term) -> Term {
        let value = term.value();
        self.lets.push((name, term));
        Term::name(name, value)
    }

    /// Returns the last point.
    pub(super) fn end(&self) -> &Point {
        self.segments.last().map_or(&self.start, |segment| &segment.to)
    }

    /// Adds a straight segment, unless its ends are one point.
    pub(super) fn line(&mut self, d: &Term, z: &Term, surface: Surface) {
        self.push(Point::new([d, z]), None, surface);
    }

    /// Adds a convex arc to a point `[d, z]` about another, unless its ends are one point.
    pub(super) fn arc(&mut self, to: [&Term; 2], centre: [&Term; 2], surface: Surface) {
        self.arc_about(to, centre, false, surface);
    }

    /// Adds a concave arc to a point `[d, z]` about another, unless its ends are one point.
    pub(super) fn hollow(&mut self, to: [&Term; 2], centre: [&Term; 2], surface: Surface) {
        self.arc_about(to, centre, true, surface);
    }

    fn arc_about(&mut self, to: [&Term; 2], centre: [&Term; 2], concave: bool, surface: Surface) {
        let centre = Circle::Centre(Point::new(centre));
        self.push(Point::new(to), Some((centre, concave)), surface);
    }

    /// Adds an arc to a point `[d, z]`, of a radius and of at most half a turn, unless its ends are one point.
    pub(super) fn arc_of_radius(
        &mut self,
        to: [&Term; 2],
        radius: &Term,
        concave: bool,
        surface: Surface,
    ) {
        let arc = Some((Circle::Radius(radius.clone()), concave));
        self.push(Point::new(to), arc, surface);
    }

    fn push(&mut self, to: Point, arc: Option<(Circle, bool)>, surface: Surface) {
        let end = self.end().clone();
        let size = [&end.d, &end.z, &to.d, &to.z];
        let size = size.map(|term| term.value().abs()).into_iter().fold(0.0, f64::max);
        let same = |a: &Term, b: &Term| (a.value() - b.value()).abs() <= SAME * size;
        let (same_d, same_z) = (same(&end.d, &to.d), same(&end.z, &to.z));
        if same_d && same_z {
            return;
        }
        // A straight segment along the axis, or across it, is so exactly.
        let to = match arc {
            None if same_d => Point { d: end.d, ..to },
            None if same_z => Point { z: end.z, ..to },
            _ => to,
        };
        self.segments.push(Segment { to, arc, surface });
    }

    /// Returns the height at which the last cutting segment ends.
    pub(super) fn cutting_end(&self) -> f64 {
        let cutting = self.segments.iter().filter(|segment| segment.surface.cutting);
        cutting.map(|segment| segment.to.z.value()).fold(0.0, f64::max)
    }

    /// Returns the names of the params and values that the segments need.
    fn used_names(&self) -> BTreeSet<&'static str> {
        let mut texts: Vec<String> = Vec::new();
        for Segment { to, arc, .. } in &self.segments {
            texts.extend([to.d.to_string(), to.z.to_string()]);
            texts.extend(arc.iter().flat_map(|(circle, _)| match circle {
                Circle::Centre(Point { d, z }) => vec![d.to_string(), z.to_string()],
                Circle::Radius(radius) => vec![radius.to_string()],
            }));
        }
        let mut used = BTreeSet::new();
        let is_in = |name: &str, text: &str| {
            text.split(|c: char| !(c.is_ascii_alphanumeric() || c == '_')).any(|word| word == name)
        };
        // A value is defined after those that it needs.
        for (name, term) in self.lets.iter().rev() {
            if texts.iter().any(|text| is_in(name, text)) {
                used.insert(*name);
                texts.push(term.to_string());
            }
        }
        let params = self.params.iter().map(|(name, ..)| *name);
        used.extend(params.filter(|name| texts.iter().any(|text| is_in(name, text))));
        used
    }

    /// Writes params, values and profile, as the body of a `tool`.
    pub(super) fn write(&self, text: &mut String) {
        let used = self.used_names();
        for (name, value, is_angle) in self.params.iter().filter(|(name, ..)| used.contains(name)) {
            let unit = if *is_angle { "deg" } else { "" };
            let _ = writeln!(text, "    param {name} = {}{unit};", decimal(*value));
        }
        for (name, term) in self.lets.iter().filter(|(name, _)| used.contains(name)) {
            let _ = writeln!(text, "    let {name} = {term};");
        }
        let Point { d, z } = &self.start;
        let _ = write!(text, "\n    profile {{\n        start ({d}, {z});\n");
        let mut rest = self.segments.as_slice();
        while let Some(first) = rest.first() {
            let name = first.surface.name;
            let mark = if first.surface.cutting { " cutting" } else { "" };
            if let Some((circle, concave)) = &first.arc {
                let Point { d: to_d, z: to_z } = &first.to;
                let circle = match circle {
                    Circle::Centre(Point { d, z }) => format!("center ({d}, {z})"),
                    Circle::Radius(radius) => format!("radius {radius}"),
                };
                let concave = if *concave { " concave" } else { "" };
                let _ = writeln!(
                    text,
                    "        arc to ({to_d}, {to_z}) {circle}{concave} as {name}{mark};"
                );
                rest = &rest[1..];
                continue;
            }
            let count = rest
                .iter()
                .take_while(|segment| segment.arc.is_none() && segment.surface == first.surface)
                .count();
            let points: Vec<String> =
                rest[..count].iter().map(|s| format!("({}, {})", s.to.d, s.to.z)).collect();
            let _ = writeln!(text, "        line to {} as {name}{mark};", points.join(", "));
            rest = &rest[count..];
        }
        text.push_str("    }\n");
    }
}

/// A constant expression of a `.tool` file, and its value.
///
/// The text is what the imported file contains, so the file's geometry is computed by the compiler, with 256 bits. The
/// value is the same in doubles: it decides which segments have a length, and which dimensions contradict each other.
#[derive(Clone, Debug)]
pub(super) struct Term {
    text: String,
    value: f64,
    strength: Strength,
}

/// The precedence of the outermost operator of an expression.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
enum Strength {
    Sum,
    Product,
    Power,
    Atom,
}

impl Term {
    /// Returns a number.
    pub(super) fn number(value: f64) -> Term {
        // Its minus binds as that of a difference.
        let strength = if value < 0.0 { Strength::Sum } else { Strength::Atom };
        Term { text: decimal(value), value, strength }
    }

    /// Returns a name with its value.
    fn name(name: &str, value: f64) -> Term {
        Term { text: name.to_owned(), value, strength: Strength::Atom }
    }

    pub(super) fn value(&self) -> f64 {
        self.value
    }

    pub(super) fn plus(&self, other: &Term) -> Term {
        // A term that says nothing is not written.
        if other.is("0") {
            return self.clone();
        }
        if self.is("0") {
            return other.clone();
        }
        Term {
            text: format!("{self} + {}", other.within(Strength::Product)),
            value: self.value + other.value,
            strength: Strength::Sum,
        }
    }

    pub(super) fn minus(&self, other: &Term) -> Term {
        if other.is("0") {
            return self.clone();
        }
        let text = if self.is("0") {
            format!("-{}", other.within(Strength::Power))
        } else {
            format!("{self} - {}", other.within(Strength::Product))
        };
        Term { text, value: self.value - other.value, strength: Strength::Sum }
    }

    pub(super) fn times(&self, other: &Term) -> Term {
        if other.is("1") {
            return self.clone();
        }
        if self.is("1") {
            return other.clone();
        }
        Term {
            text: format!("{}*{}", self.within(Strength::Product), other.within(Strength::Power)),
            value: self.value * other.value,
            strength: Strength::Product,
        }
    }

    pub(super) fn over(&self, other: &Term) -> Term {
        Term {
            text: format!("{}/{}", self.within(Strength::Product), other.within(Strength::Power)),
            value: self.value / other.value,
            strength: Strength::Product,
        }
    }

    pub(super) fn half(&self) -> Term {
        self.over(&Term::number(2.0))
    }

    pub(super) fn squared(&self) -> Term {
        Term {
            text: format!("{}^2", self.within(Strength::Atom)),
            value: self.value * self.value,
            strength: Strength::Power,
        }
    }

    pub(super) fn sqrt(&self) -> Term {
        self.call("sqrt", self.value.sqrt())
    }

    /// Returns the sine of an angle in degrees.
    pub(super) fn sin(&self) -> Term {
        self.call("sin", self.value.to_radians().sin())
    }

    /// Returns the cosine of an angle in degrees.
    pub(super) fn cos(&self) -> Term {
        self.call("cos", self.value.to_radians().cos())
    }

    /// Returns the tangent of an angle in degrees.
    pub(super) fn tan(&self) -> Term {
        self.call("tan", self.value.to_radians().tan())
    }

    fn call(&self, function: &str, value: f64) -> Term {
        Term { text: format!("{function}({self})"), value, strength: Strength::Atom }
    }

    fn is(&self, text: &str) -> bool {
        self.text == text
    }

    /// Returns the text, in parentheses if its operator binds less tightly than `strength`.
    fn within(&self, strength: Strength) -> String {
        if self.strength < strength { format!("({self})") } else { self.text.clone() }
    }
}

impl fmt::Display for Term {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

/// Writes a number as the language has it: the shortest decimal that is the same double, without an exponent.
pub(super) fn decimal(value: f64) -> String {
    // -0 would be written as `-0`.
    format!("{}", if value == 0.0 { 0.0 } else { value })
}

/// Returns a sum of decimals without the rounding of doubles: 1e-9 is finer than any tool library states a length.
pub(super) fn rounded(value: f64) -> f64 {
    if value.abs() < 1e6 { (value * 1e9).round() / 1e9 } else { value }
}
