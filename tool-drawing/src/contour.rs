//! The dimensions of the tool's surface: faces with their diameters and radii, and the heights of their ends.

use super::borders::{Border, Side};
use super::stroke::Stroke;
use super::view::is_outline;
use tool_dsl::model::{Model, Unit};
use tool_dsl::vector::{Point, cross, dot, minus, norm};

/// Lengths that differ by less than this fraction of the tool's size are considered equal.
const LENGTH_TOLERANCE_FRACTION: f64 = 1e-7;

/// The dimension of a face.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Measure {
    /// A cylinder, by its radius.
    Cylinder(f64),
    /// An arc, by its centre and radius.
    Arc(Point, f64),
    /// A cone, by its angle to the axis in degrees.
    Cone(f64),
    /// No dimension.
    Other,
}

/// All parts of a surface on one cylinder or one arc; or a single other stroke of it.
#[derive(Clone, Debug)]
pub(super) struct Face {
    pub(super) surface: usize,
    pub(super) measure: Measure,
    /// The total length.
    pub(super) length: f64,
    /// The longest stroke.
    pub(super) longest: Stroke,
}

impl Face {
    /// Returns the dimension as text.
    pub(super) fn figure(&self, unit: Unit) -> Option<String> {
        match self.measure {
            Measure::Cylinder(radius) => Some(format!("⌀{}", tidy(2.0 * radius, unit))),
            Measure::Arc(_, radius) => Some(format!("R{}", tidy(radius, unit))),
            Measure::Cone(angle) => Some(format!("{}° a side", trimmed(&format!("{angle:.2}")))),
            Measure::Other => None,
        }
    }

    /// Returns whether the dimension is always noted. That of a cone is not, since it is often only a broken edge.
    pub(super) fn is_telling(&self) -> bool {
        matches!(self.measure, Measure::Cylinder(_) | Measure::Arc(..))
    }
}

/// Formats a length, with as many decimals as usual in a workshop.
pub(super) fn tidy(value: f64, unit: Unit) -> String {
    let decimals = match unit {
        Unit::Millimetre => 3,
        Unit::Inch => 4,
        Unit::Metre => 6,
    };
    match trimmed(&format!("{value:.decimals$}")) {
        // A length too small for that gets as many digits as it needs.
        text if text == "0" && value.abs() > 1e-12 => tool_dsl::diagnostic::format_number(value),
        text => text,
    }
}

/// Removes trailing zeros of a decimal number.
fn trimmed(text: &str) -> String {
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".to_owned() } else { text.to_owned() }
}

/// Returns the faces of the surface.
pub(super) fn faces(model: &Model, borders: &[Border], size: f64) -> Vec<Face> {
    let mut faces: Vec<Face> = Vec::new();
    for border in borders.iter().filter(|border| is_outline(border)) {
        let Side::Region(region) = border.sides[0] else { continue };
        let surface = model.regions[region].surface;
        for stroke in &border.strokes {
            let measure = measure(stroke, border.exact, size);
            let length = stroke.length();
            let known = faces
                .iter_mut()
                .find(|face| face.surface == surface && are_equal(face.measure, measure, size));
            match known {
                Some(face) => {
                    face.length += length;
                    if length > face.longest.length() * (1.0 + LENGTH_TOLERANCE_FRACTION) {
                        face.longest = *stroke;
                    }
                }
                None => faces.push(Face { surface, measure, length, longest: *stroke }),
            }
        }
    }
    faces
}

fn measure(stroke: &Stroke, exact: bool, size: f64) -> Measure {
    match stroke.circle {
        Some((centre, radius)) if exact => Measure::Arc(centre, radius),
        None if (stroke.from[0] - stroke.to[0]).abs() < LENGTH_TOLERANCE_FRACTION * size => {
            Measure::Cylinder(stroke.from[0] / 2.0 + stroke.to[0] / 2.0)
        }
        None if (stroke.from[1] - stroke.to[1]).abs() > LENGTH_TOLERANCE_FRACTION * size => {
            let [d, z] = [0, 1].map(|k| (stroke.to[k] - stroke.from[k]).abs());
            Measure::Cone(d.atan2(z).to_degrees())
        }
        _ => Measure::Other,
    }
}

fn are_equal(a: Measure, b: Measure, size: f64) -> bool {
    let near = |a: f64, b: f64| (a - b).abs() < LENGTH_TOLERANCE_FRACTION * size;
    match (a, b) {
        (Measure::Cylinder(a), Measure::Cylinder(b)) => near(a, b),
        (Measure::Arc(p, r), Measure::Arc(q, s)) => {
            near(r, s) && near(p[0], q[0]) && near(p[1], q[1])
        }
        _ => false,
    }
}

/// Returns the heights at which the surface has a corner, a tangent joint of two faces, or an end, from bottom to top.
/// Each is given with its outermost point. Except for the lowest, only points that are `described` count.
pub(super) fn heights(
    model: &Model,
    borders: &[Border],
    size: f64,
    described: impl Fn(Point) -> bool,
) -> Vec<Point> {
    let outline: Vec<&Border> = borders.iter().filter(|border| is_outline(border)).collect();
    let surface = |border: &Border| match border.sides[0] {
        Side::Region(region) => model.regions[region].surface,
        _ => 0,
    };
    let mut steps: Vec<Point> = Vec::new();
    for border in &outline {
        let Some(first) = border.strokes.first() else { continue };
        let goes_on = outline.iter().any(|before| {
            before.ends[1] == border.ends[0]
                && surface(before) == surface(border)
                && before.strokes.last().is_some_and(|last| one(last, first, size))
        });
        if !goes_on {
            steps.push(first.from);
        }
        if !outline.iter().any(|after| after.ends[0] == border.ends[1]) {
            steps.extend(border.strokes.last().map(|last| last.to));
        }
    }
    // An arc may reach beyond its ends.
    let strokes = || outline.iter().flat_map(|border| &border.strokes);
    for (k, of) in [(0, f64::min as fn(f64, f64) -> f64), (1, f64::max)] {
        let ends = strokes().map(|stroke| (stroke.span()[k], stroke.from[0].max(stroke.to[0])));
        if let Some((z, d)) = ends.reduce(|a, b| if of(a.0, b.0) == a.0 { a } else { b }) {
            steps.push([d.min(strokes().map(|s| s.from[0]).fold(0.0, f64::max)), z]);
        }
    }
    steps.sort_by(|a, b| a[1].total_cmp(&b[1]));
    let mut levels: Vec<Point> = Vec::new();
    for step in steps {
        if !levels.is_empty() && !described(step) {
            continue;
        }
        match levels.last_mut() {
            Some(level) if step[1] - level[1] < LENGTH_TOLERANCE_FRACTION * size => {
                level[0] = level[0].max(step[0]);
            }
            _ => levels.push(step),
        }
    }
    levels
}

/// Returns whether two strokes continue each other on one line or lie on one circle.
fn one(a: &Stroke, b: &Stroke, size: f64) -> bool {
    match (a.circle, b.circle) {
        (None, None) => {
            let (u, v) = (minus(a.to, a.from), minus(b.to, b.from));
            let lengths = norm(u) * norm(v);
            cross(u, v).abs() < 1e-6 * lengths && dot(u, v) > 0.0
        }
        (Some((p, r)), Some((q, s))) => {
            norm(minus(p, q)) + (r - s).abs() < LENGTH_TOLERANCE_FRACTION * size
        }
        _ => false,
    }
}
