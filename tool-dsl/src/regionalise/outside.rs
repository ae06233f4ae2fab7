//! The outside of a profile as convex pieces: trapezoids between the heights of the outline's ends, and what is above and
//! below.

use super::Partition;
use super::pieces::{Piece, Separations};
use super::section::{Feature, Section};
use crate::formula::{CurveIndex, Signs};
use crate::geometry::outline::{Point, Segment, bounding_box, dot, minus, norm};
use crate::geometry::polygon::{Polygon, clipped, divided};
use touchoff_plane::Circle;

/// The outer limit of the pieces, in sizes of the outline.
const OUTER_DISTANCE_IN_SIZES: f64 = 64.0;

impl Partition {
    /// Returns pieces that cover the outside up to a limit.
    pub(crate) fn outer_pieces(&self, separations: &Separations) -> Vec<Piece> {
        let section = self.section();
        let [[_, low], [radius, high]] = bounding_box(&self.outline);
        let far = OUTER_DISTANCE_IN_SIZES * section.size;
        let [near_radius, far_radius] = [section.size, far].map(|distance| radius + distance);
        let mut pieces = Vec::new();
        // Values of curves are known less well far away, so that what is near has pieces of its own.
        for [from, to] in [
            [low - far, low - section.size],
            [low - section.size, low],
            [high, high + section.size],
            [high + section.size, high + far],
        ] {
            for [left, right] in [[0.0, near_radius], [near_radius, far_radius]] {
                let vertices = vec![[left, from], [right, from], [right, to], [left, to]];
                pieces.push(Piece::outside(vertices, Vec::new()));
            }
        }
        for pair in section.heights().windows(2) {
            let slab = Slab { section: &section, separations, heights: [pair[0], pair[1]] };
            let crossings = slab.crossings();
            // Beside the axis is the inside if the number of crossings is odd.
            let borders = [None].into_iter().chain(crossings.iter().map(Some)).chain([None]);
            let borders: Vec<Option<&Crossing>> = borders.collect();
            let first = crossings.len() % 2;
            for pair in borders.windows(2).skip(first).step_by(2) {
                let limits = match pair[1] {
                    Some(_) => vec![[0.0; 2]],
                    None => vec![[0.0, near_radius], [near_radius, far_radius]],
                };
                for [left, right] in limits {
                    // Beyond the first limit, nothing of the outline is near.
                    let left_border = if left == 0.0 { pair[0] } else { None };
                    pieces.extend(slab.pieces_between([left_border, pair[1]], [left, right]));
                }
            }
        }
        pieces
    }
}

impl Section<'_> {
    /// Returns the heights between which every segment is monotonous, in order.
    fn heights(&self) -> Vec<f64> {
        let [[_, low], [_, high]] = bounding_box(self.outline);
        let mut heights: Vec<f64> = self
            .outline
            .iter()
            .flat_map(|segment| segment.geometry.ends)
            .map(|end| end[1])
            .collect();
        for segment in self.outline {
            let Some(Circle { centre, radius, .. }) = segment.geometry.circle else { continue };
            let of_circle = [centre[1] - radius, centre[1], centre[1] + radius];
            heights.extend(of_circle.into_iter().filter(|z| *z > low && *z < high));
        }
        heights.extend([low, high]);
        heights.sort_by(f64::total_cmp);
        heights.dedup_by(|a, b| *a - *b <= 2.0 * f64::EPSILON * self.size);
        heights
    }

    /// Returns whether a point is inside the outline, by the crossings of a line away from the axis.
    pub(super) fn is_inside(&self, [d, z]: Point) -> bool {
        let radii = self.outline.iter().flat_map(|segment| radii_at(segment, z));
        radii.filter(|radius| *radius > d).count() % 2 == 1
    }
}

/// Returns the radii at which a segment passes a height that is none of its ends.
fn radii_at(segment: &Segment, z: f64) -> Vec<f64> {
    let [a, b] = segment.geometry.ends;
    match segment.geometry.circle {
        None if (a[1] < z) != (b[1] < z) => {
            vec![a[0] + (b[0] - a[0]) * ((z - a[1]) / (b[1] - a[1]))]
        }
        None => Vec::new(),
        Some(Circle { centre, radius, .. }) => {
            let half = (radius * radius - (z - centre[1]).powi(2)).max(0.0).sqrt();
            let radii = [centre[0] - half, centre[0] + half].into_iter();
            let is_on_arc =
                |d: &f64| segment.geometry.sector([*d, z]).iter().all(|side| *side >= 0.0);
            if half == 0.0 { Vec::new() } else { radii.filter(is_on_arc).collect() }
        }
    }
}

/// The section between two heights.
struct Slab<'s> {
    section: &'s Section<'s>,
    separations: &'s Separations,
    heights: [f64; 2],
}

/// A segment that passes a slab, on one half of its circle if it is an arc.
struct Crossing {
    segment: usize,
    /// The radius at the middle of the slab.
    at: f64,
    /// 1 for the half of a circle away from the axis, -1 for the other.
    half: f64,
}

impl Crossing {
    /// Returns the radius at a height of the slab.
    fn radius(&self, segment: &Segment, z: f64) -> f64 {
        let round = segment.geometry.circle;
        let is_on_half = |end: &Point| {
            end[1] == z
                && round.is_none_or(|Circle { centre, .. }| (end[0] - centre[0]) * self.half >= 0.0)
        };
        let ends = segment.geometry.ends;
        if let Some(end) = ends.into_iter().find(is_on_half) {
            return end[0];
        }
        match round {
            None => {
                let [a, b] = ends;
                a[0] + (b[0] - a[0]) * ((z - a[1]) / (b[1] - a[1]))
            }
            Some(Circle { centre, radius, .. }) => {
                let square = radius * radius - (z - centre[1]).powi(2);
                centre[0] + self.half * square.max(0.0).sqrt()
            }
        }
    }
}

impl Slab<'_> {
    /// Returns the segments across the slab, from the axis outward.
    fn crossings(&self) -> Vec<Crossing> {
        let middle = f64::midpoint(self.heights[0], self.heights[1]);
        let mut crossings = Vec::new();
        for (segment, geometry) in self.section.outline.iter().enumerate() {
            crossings.extend(radii_at(geometry, middle).into_iter().map(|at| {
                let half = geometry
                    .geometry
                    .circle
                    .map_or(0.0, |Circle { centre, .. }| (at - centre[0]).signum());
                Crossing { segment, at, half }
            }));
        }
        crossings.sort_by(|a, b| a.at.total_cmp(&b.at));
        crossings
    }

    /// Returns pieces of the outside between two borders; without one, the limit stands for it.
    fn pieces_between(&self, borders: [Option<&Crossing>; 2], limits: [f64; 2]) -> Vec<Piece> {
        let side = |border: Option<&Crossing>, outward: f64, limit: f64| match border {
            Some(border) => self.chord(border, outward),
            None => self.heights.map(|z| [limit, z]),
        };
        let left = side(borders[0], 1.0, limits[0]);
        let right = side(borders[1], -1.0, limits[1]);
        let whole = clipped(&vec![left[0], right[0], right[1], left[1]], &|p| p[0]);
        let mut parts: Vec<(Polygon, Vec<(CurveIndex, Signs)>)> =
            whole.into_iter().map(|whole| (whole, Vec::new())).collect();
        for (border, outward) in borders.into_iter().zip([1.0, -1.0]) {
            let Some(border) = border else { continue };
            match self.section.outline[border.segment].geometry.circle {
                None => {}
                // Outside the circle, beyond the chord.
                Some(Circle { convex: true, .. }) => {
                    let known = self.outer_side(border);
                    parts.iter_mut().for_each(|(_, signs)| signs.extend(known));
                }
                // Inside the circle up to its centre, and beyond.
                Some(Circle { centre, convex: false, .. }) => {
                    let known = self.outer_side(border);
                    let halves = parts.into_iter().flat_map(|(polygon, signs)| {
                        let before = polygon.iter().map(|p| outward * (centre[0] - p[0]));
                        let [beyond, near] = divided(&polygon, &before.collect::<Vec<f64>>());
                        let near_signs = signs.iter().copied().chain(known).collect();
                        [beyond.map(|half| (half, signs)), near.map(|half| (half, near_signs))]
                    });
                    parts = halves.flatten().collect();
                }
            }
        }
        parts.into_iter().map(|(vertices, signs)| Piece::outside(vertices, signs)).collect()
    }

    /// Returns a line through a slab that has all of the outside beside a segment on one side: its chord, or for a concave arc
    /// the parallel tangent. `outward` is the sign of the direction from the segment to the outside.
    fn chord(&self, border: &Crossing, outward: f64) -> [Point; 2] {
        let segment = &self.section.outline[border.segment];
        let chord = self.heights.map(|z| [border.radius(segment, z), z]);
        let Some(Circle { centre, radius, convex: false }) = segment.geometry.circle else {
            return chord;
        };
        let middle = [0, 1].map(|k| chord[0][k] + chord[1][k] - 2.0 * centre[k]);
        let out = middle.map(|part| part / norm(middle));
        // The chord moves out by its distance from the arc.
        let shift = (radius - dot(out, minus(chord[0], centre))) / out[0].abs();
        chord.map(|[d, z]| [d - outward * shift, z])
    }

    /// Returns the side of an arc's circle on which the outside is.
    fn outer_side(&self, border: &Crossing) -> Option<(CurveIndex, Signs)> {
        let feature = Feature::Piece(border.segment);
        let feature = self.section.features.iter().position(|other| *other == feature)?;
        self.separations.outer_side(feature)
    }
}
