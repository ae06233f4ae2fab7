//! The partition as polygons, for the planner and for drawings.

use super::ROUNDING;
use super::section::{Feature, Obstacle, Section};
use super::slices::Slice;
use crate::geometry::outline::{Point, cross, minus, norm};
use std::mem::take;

/// A polygon of one owner, convex except for the bulges of its curved edges. Edge `k` runs from vertex `k` to the next.
#[derive(Clone, Debug)]
pub(crate) struct Cell {
    /// Index of the part that owns it.
    pub(crate) part: usize,
    pub(crate) vertices: Vec<Point>,
    /// For each edge, true if it is straight rather than a chord of a curve.
    pub(crate) straight: Vec<bool>,
    /// The points at which other cells meet it, as far as they are ends of its slice.
    pub(crate) corners: Vec<Point>,
    /// Points inside, each with the weight of its surroundings.
    pub(crate) samples: Vec<(Point, f64)>,
    /// Points next to every border.
    pub(crate) witnesses: Vec<Point>,
}

/// Depths of samples, as fractions of the slice's length along the normal.
const SAMPLE_DEPTH_FRACTIONS: [f64; 4] = [0.02, 0.12, 0.45, 0.85];
/// Positions of samples along a slice, as fractions of its width.
const SAMPLE_FRACTIONS: [f64; 3] = [0.1, 0.5, 0.9];
/// The thickness of the layer near the surface that is weighted most, in sizes.
const SHELL_FRACTION: f64 = 0.05;

impl Cell {
    /// Returns twice the area.
    fn area(&self) -> f64 {
        let Some(first) = self.vertices.first() else { return 0.0 };
        let fan = self.vertices.windows(2);
        fan.map(|pair| cross(minus(pair[0], *first), minus(pair[1], *first))).sum::<f64>().abs()
    }
}

/// Returns the cells of all slices that have an area. Neighbours share the points of their common border.
pub(super) fn cells(section: &Section<'_>, slices: &[Vec<Slice>], chords: u32) -> Vec<Cell> {
    let all: Vec<&Slice> = slices.iter().flatten().collect();
    let mut far_ends: Vec<Option<Vec<Point>>> = vec![None; all.len()];
    for index in 0..all.len() {
        if far_ends[index].is_some() {
            continue;
        }
        let far_end = far_end(section, all[index], chords);
        if let Some(opposite) = opposite(section, &all, index, &far_end) {
            far_ends[opposite] = Some(far_end.iter().rev().copied().collect());
        }
        far_ends[index] = Some(far_end);
    }
    let far_ends = far_ends.into_iter().flatten();
    let min_area = 1e-16 * section.size * section.size;
    all.iter()
        .zip(far_ends)
        .flat_map(|(slice, far_end)| quads(section, slice, &far_end, chords))
        .filter(|cell| cell.area() > min_area)
        .collect()
}

fn far_end(section: &Section<'_>, slice: &Slice, chords: u32) -> Vec<Point> {
    if slice.obstacle == Obstacle::Centre {
        return vec![slice.far_end_at(section, 0.5)];
    }
    slice.far_end(section, if is_straight(section, slice) { 1 } else { chords })
}

/// Returns whether the far end of a slice is a straight line.
fn is_straight(section: &Section<'_>, slice: &Slice) -> bool {
    let is_line = |feature: usize| match section.features[feature] {
        Feature::Piece(piece) => Some(section.outline[piece].circle.is_none()),
        Feature::Corner(_) => None,
    };
    match slice.obstacle {
        Obstacle::Axis => true,
        Obstacle::Far => is_line(slice.feature) == Some(true),
        Obstacle::Centre => false,
        Obstacle::Feature(other) => match (is_line(slice.feature), is_line(other)) {
            (Some(a), Some(b)) => a && b,
            (None, None) => true,
            _ => false,
        },
    }
}

/// Returns the slice on the other side of a far end.
fn opposite(
    section: &Section<'_>,
    slices: &[&Slice],
    index: usize,
    far_end: &[Point],
) -> Option<usize> {
    let slice = slices[index];
    let Obstacle::Feature(other) = slice.obstacle else { return None };
    let is_near = |a: Point, b: Point| norm(minus(a, b)) < 1e-7 * section.size;
    (index + 1..slices.len()).find(|k| {
        let opposite = slices[*k];
        opposite.feature == other
            && opposite.obstacle == Obstacle::Feature(slice.feature)
            && is_near(opposite.far_end_at(section, 0.0), far_end[far_end.len() - 1])
            && is_near(opposite.far_end_at(section, 1.0), far_end[0])
    })
}

/// Divides a slice along normals, so that no part of a curved edge is long.
fn quads(section: &Section<'_>, slice: &Slice, far_end: &[Point], chords: u32) -> Vec<Cell> {
    let curved = match section.features[slice.feature] {
        Feature::Piece(piece) => section.outline[piece].circle.is_some(),
        Feature::Corner(_) => false,
    };
    let straight_rim = is_straight(section, slice);
    let steps = if curved { chords as usize } else { far_end.len().max(2) - 1 };
    let feet: Vec<Point> = (0..=steps)
        .map(|k| {
            let t = slice.from + (slice.to - slice.from) * k as f64 / steps as f64;
            section.foot_point(slice.feature, t).foot
        })
        .collect();
    // A straight far end opposite a curved segment has only two points.
    let far_end: Vec<Point> = if far_end.len() == 2 && steps > 1 {
        slice.far_end(section, chords)
    } else {
        (0..=steps).map(|k| far_end[(k * (far_end.len() - 1)) / steps]).collect()
    };
    let (mut samples, mut witnesses) = (samples(section, slice), witnesses(section, slice));
    (0..steps)
        .map(|k| {
            let vertices = [feet[k], feet[k + 1], far_end[k + 1], far_end[k]];
            let straight = [!curved, true, straight_rim, true];
            let (vertices, straight) =
                without_short_edges(&vertices, &straight, 1e-14 * section.size);
            let (samples, witnesses) = (take(&mut samples), take(&mut witnesses));
            let mut corners = Vec::new();
            if k == 0 {
                corners.extend([feet[0], far_end[0]]);
            }
            if k + 1 == steps {
                corners.extend([feet[steps], far_end[steps]]);
            }
            Cell { part: slice.feature, vertices, straight, corners, samples, witnesses }
        })
        .collect()
}

/// Removes edges without length.
fn without_short_edges(
    vertices: &[Point],
    straight: &[bool],
    min_area: f64,
) -> (Vec<Point>, Vec<bool>) {
    let count = vertices.len();
    (0..count)
        .filter(|k| norm(minus(vertices[*k], vertices[(k + 1) % count])) > min_area)
        .map(|k| (vertices[k], straight[k]))
        .unzip()
}

fn samples(section: &Section<'_>, slice: &Slice) -> Vec<(Point, f64)> {
    let mut samples = Vec::new();
    let layer_thickness = SHELL_FRACTION * section.size;
    for part in SAMPLE_FRACTIONS {
        let foot_point = slice.foot_at(section, part);
        let radius = slice.radius(section, part).min(2.0 * section.size);
        let mut before = 0.0;
        for (k, share) in SAMPLE_DEPTH_FRACTIONS.iter().enumerate() {
            let after = SAMPLE_DEPTH_FRACTIONS.get(k + 1).map_or(1.0, |next| (share + next) / 2.0);
            let depth = share * radius;
            let [from, to] =
                [slice.from, slice.to].map(|t| section.foot_point(slice.feature, t).at(depth));
            let width = norm(minus(from, to));
            let area = width * (after - before) * radius / SAMPLE_FRACTIONS.len() as f64;
            let weight = area * ((-depth / layer_thickness).exp() + SHELL_FRACTION);
            samples.push((foot_point.at(depth), weight));
            before = after;
        }
    }
    samples
}

/// Returns points of a slice, most densely near its ends, to which no neighbour is as near within rounding.
fn witnesses(section: &Section<'_>, slice: &Slice) -> Vec<Point> {
    let mut rivals = section.adjacent_features(slice.feature);
    if let Obstacle::Feature(other) = slice.obstacle {
        rivals.push(other);
    }
    let is_clear = |p: &Point| {
        let own = section.depth_at(slice.feature, *p);
        let margin = ROUNDING * section.size.max(own);
        rivals.iter().all(|other| (section.depth_at(*other, *p) - own).abs() > margin)
    };
    let mut witnesses = Vec::new();
    for k in 0..24 {
        let part = (f64::from(k) + 0.5) / 24.0;
        let foot_point = slice.foot_at(section, part);
        let radius = slice.radius(section, part);
        witnesses.extend(
            [0.002, 0.15, 0.4, 0.7, 0.93, 0.998].map(|share| foot_point.at(share * radius)),
        );
    }
    witnesses.retain(is_clear);
    witnesses
}
