//! The cells of a profile's features, along their normals.
//!
//! A normal ends where another feature is as near: on a bisector of lines, a parabola of a line and a point or circle, an
//! ellipse or a hyperbola of two circles. A cell is the area between a feature and the ends of its normals.

use super::section::{Edge, Section, Split, simplified};
use super::stroke::{MAX_TURN, Stroke};
use touchoff_dsl::model::Model;
use touchoff_dsl::{Features, Normal, NormalEnd};
use touchoff_plane::{Point, cross, minus, norm};

/// The parameters of a feature's outermost normals are this and its difference from 1. At the very ends they are limits.
const END: f64 = 2e-5;
/// The number of intervals of a feature at whose ends its normals are measured first.
const FIRST_INTERVALS: u32 = 8;
/// The greatest number of halvings of such an interval.
const MAX_HALVINGS: u32 = 32;
/// The distance within which the joints of cells are found, relative to the largest distance of chords.
const JOINT_FRACTION: f64 = 1e-3;

/// Returns the section of a profile, whose chords deviate by at most `flat`.
pub(super) fn cells(model: &Model, features: &Features<'_>, flat: f64) -> Section {
    let mut section = Section::default();
    let mut material = Vec::new();
    for segment in model.outline() {
        let strokes = strokes(&segment);
        material.extend(strokes.iter().flat_map(|stroke| stroke.points(flat)));
        material.extend(strokes.last().map(|last| last.to));
        section.edges.push(Edge { surface: segment.surface, strokes, exact: true });
    }
    material.dedup();
    section.material.push(material);
    let corners: Vec<Point> = model.outline().map(|segment| segment.ends[0]).collect();
    for (index, segment) in features.segments().enumerate() {
        let cell = Cell { features, corners: &corners, index, flat };
        cell.add_to(segment, &mut section);
    }
    section
}

/// Returns a segment as strokes, of which each is less than half a circle.
fn strokes(segment: &touchoff_plane::Segment) -> Vec<Stroke> {
    let [from, to] = segment.ends;
    let whole = Stroke { from, to, circle: segment.circle.map(|arc| (arc.centre, arc.radius)) };
    if segment.turn().abs() < MAX_TURN {
        return vec![whole];
    }
    let middle = segment.place(0.5).point;
    vec![Stroke { to: middle, ..whole }, Stroke { from: middle, ..whole }]
}

/// The cell of one feature.
struct Cell<'p> {
    features: &'p Features<'p>,
    /// The starts of the profile's segments.
    corners: &'p [Point],
    index: usize,
    flat: f64,
}

impl Cell<'_> {
    /// Returns normals along the feature, whose ends are joined by chords of the cell's borders.
    fn normals(&self) -> Vec<Normal> {
        let mut parameters = vec![1.0 - END];
        parameters.extend((1..FIRST_INTERVALS).map(|k| f64::from(k) / f64::from(FIRST_INTERVALS)));
        // The normals through the ends of segments meet the smallest neighbours.
        for corner in self.corners {
            let parameter = self.features.parameter(self.index, *corner);
            parameters.extend(Some(parameter).filter(|t| *t > END && *t < 1.0 - END));
        }
        parameters.sort_by(f64::total_cmp);
        parameters.dedup();
        let mut before = END;
        let mut normals = vec![self.features.normal(self.index, END)];
        for parameter in parameters {
            let from = (before, normals[normals.len() - 1]);
            let to = (parameter, self.features.normal(self.index, parameter));
            self.refine(from, to, MAX_HALVINGS, &mut normals);
            before = parameter;
        }
        normals
    }

    /// Adds the normals after `from` up to `to`, each with its parameter. Where the neighbour changes, they are close.
    fn refine(
        &self,
        from: (f64, Normal),
        to: (f64, Normal),
        halvings: u32,
        normals: &mut Vec<Normal>,
    ) {
        let chord = minus(to.1.end, from.1.end);
        let (length, has_one_neighbour) = (norm(chord), from.1.at_end == to.1.at_end);
        let near = if has_one_neighbour { self.flat } else { JOINT_FRACTION * self.flat };
        if halvings > 0 && length > near {
            let parameter = f64::midpoint(from.0, to.0);
            let middle = (parameter, self.features.normal(self.index, parameter));
            let off = cross(chord, minus(middle.1.end, from.1.end)).abs() / length;
            if !has_one_neighbour || middle.1.at_end != to.1.at_end || off > self.flat / 2.0 {
                self.refine(from, middle, halvings - 1, normals);
                return self.refine(middle, to, halvings - 1, normals);
            }
        }
        normals.push(to.1);
    }

    /// Adds the cell of a segment, or of a reflex corner, to a section.
    fn add_to(&self, segment: Option<usize>, section: &mut Section) {
        let mut normals = self.normals();
        let last = normals.len() - 1;
        let mut area = vec![normals[0].foot];
        if let Some(segment) = segment {
            let strokes = &section.edges[segment].strokes;
            area = strokes.iter().flat_map(|stroke| stroke.points(self.flat)).collect();
            area.extend(strokes.last().map(|last| last.to));
        }
        // At a convex corner both cells end in the corner itself.
        let ends = [area[0], area[area.len() - 1]];
        for (normal, foot) in [0, last].into_iter().zip(ends) {
            if length(&normals[normal]) < self.flat {
                normals[normal].end = foot;
            }
        }
        // The normal between neighbours is drawn by the one before it.
        if self.index + 1 < self.features.segments().count() && length(&normals[last]) > self.flat {
            let regions = [self.index, self.index + 1];
            section.splits.push(Split { regions, line: vec![ends[1], normals[last].end] });
        }
        let mut borders: Vec<Point> = Vec::new();
        let mut rest = &normals[..];
        while let Some(Normal { at_end, .. }) = rest.first() {
            let count = rest.iter().take_while(|normal| normal.at_end == *at_end).count();
            let points: Vec<Point> = rest.iter().take(count + 1).map(|normal| normal.end).collect();
            let mut line = simplified(&points, self.flat / 2.0);
            borders.extend(&line);
            // Each border is drawn by the first of its two features.
            if let NormalEnd::Feature(other) = *at_end
                && other > self.index
            {
                // Dashes begin at the surface.
                if length(&rest[count - 1]) < length(&rest[0]) {
                    line.reverse();
                }
                section.splits.push(Split { regions: [self.index, other], line });
            }
            rest = &rest[count..];
        }
        area.extend(borders.into_iter().rev());
        area.dedup_by(|p, q| norm(minus(*p, *q)) < JOINT_FRACTION * self.flat);
        section.areas.push(vec![area]);
    }
}

fn length(normal: &Normal) -> f64 {
    norm(minus(normal.end, normal.foot))
}
