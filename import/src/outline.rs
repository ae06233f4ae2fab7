//! The half section of a cutter or a holder, as the segments of a `.tool` file's profile.

use super::term::Term;
use std::collections::BTreeSet;
use std::fmt::Write as _;

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
    pub(super) name: &'static str,
    pub(super) cutting: bool,
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
            let _ = writeln!(text, "    param {name} = {}{unit};", super::term::decimal(*value));
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
            let same =
                |segment: &&Segment| segment.arc.is_none() && segment.surface == first.surface;
            let count = rest.iter().take_while(same).count();
            let points: Vec<String> =
                rest[..count].iter().map(|s| format!("({}, {})", s.to.d, s.to.z)).collect();
            let _ = writeln!(text, "        line to {} as {name}{mark};", points.join(", "));
            rest = &rest[count..];
        }
        text.push_str("    }\n");
    }
}
