//! The shape of a tool, for pictures.

use crate::picture::render::{Facet, Paint};
use nalgebra::{Point3, Vector3};
use touchoff::tool::{Circle, ProfileSegment, ToolInfo};
use touchoff::{Pose, Unit};

/// Number of chords of an arc, and of sides of the solid of revolution.
const CHORDS: usize = 10;
const SIDES: usize = 48;

/// Colours of surfaces that cut, and of others.
pub(super) const CUTTING: [u8; 3] = [214, 134, 30];
pub(super) const NOT_CUTTING: [u8; 3] = [100, 118, 150];

/// The profile of a tool, from its lower end upward, in the unit of the part.
pub(super) struct ToolShape {
    /// Lines of the profile: both ends as distance from the axis and height, and whether they cut.
    pub(super) lines: Vec<([f64; 2], [f64; 2], bool)>,
    /// Set if the tool has a profile. Otherwise the lines are of cylinders that contain it.
    pub(super) is_exact: bool,
}

impl ToolShape {
    pub(super) fn new(info: &ToolInfo, unit: Unit) -> ToolShape {
        let factor = info.unit.factor_to(unit);
        let scaled = |point: [f64; 2]| point.map(|part| part * factor);
        let mut lines = Vec::new();
        for segment in info.outline.iter() {
            let cutting = info.surface(segment.surface).cutting;
            let points = points(segment);
            lines.extend(points.windows(2).map(|ends| (scaled(ends[0]), scaled(ends[1]), cutting)));
        }
        if lines.is_empty() {
            for slab in info.envelope.iter() {
                let [low, high] = [slab.low, slab.high].map(|z| scaled([slab.radius, z]));
                lines.push((scaled([0.0, slab.low]), low, false));
                lines.push((low, high, false));
                lines.push((high, scaled([0.0, slab.high]), false));
            }
        }
        ToolShape { lines, is_exact: info.is_exact() }
    }

    /// Returns the radius of the surfaces that cut, or of the whole tool if none does.
    pub(super) fn radius(&self) -> f64 {
        let widest = |cutting: bool| {
            let lines = self.lines.iter().filter(move |line| line.2 || !cutting);
            lines.fold(0.0, |widest: f64, (from, to, _)| widest.max(from[0]).max(to[0]))
        };
        if widest(true) > 0.0 { widest(true) } else { widest(false) }
    }

    /// Returns the facets of the tool at a pose.
    pub(super) fn facets(&self, pose: &Pose) -> impl Iterator<Item = Facet> + '_ {
        let (tip, axis) = (pose.tip(), pose.axis());
        let aside = if axis.x.abs() < 0.6 { Vector3::x() } else { Vector3::y() };
        let right = axis.cross(&aside).normalize();
        let front = axis.cross(&right);
        let at = move |[d, z]: [f64; 2], side: usize| -> Point3<f64> {
            let (sine, cosine) = (side as f64 * std::f64::consts::TAU / SIDES as f64).sin_cos();
            tip + axis * z + (right * cosine + front * sine) * d
        };
        self.lines.iter().flat_map(move |(from, to, cutting)| {
            let paint = Paint::Glass(if *cutting { CUTTING } else { NOT_CUTTING });
            (0..SIDES).flat_map(move |side| {
                let [a, b] = [side, side + 1].map(|side| at(*from, side));
                let [d, c] = [side, side + 1].map(|side| at(*to, side));
                [[a, b, c], [a, c, d]].map(|corners| Facet { corners, paint })
            })
        })
    }
}

/// Returns points of a segment, with chords in place of an arc.
fn points(segment: &ProfileSegment) -> Vec<[f64; 2]> {
    let Some(Circle { centre, radius, convex }) = segment.circle else {
        return vec![segment.from, segment.to];
    };
    let angle = |[d, z]: [f64; 2]| (z - centre[1]).atan2(d - centre[0]);
    let (from, mut to) = (angle(segment.from), angle(segment.to));
    // Convex arcs run counter-clockwise.
    let turn = std::f64::consts::TAU;
    if convex && to < from {
        to += turn;
    } else if !convex && to > from {
        to -= turn;
    }
    let inner = (1..CHORDS).map(|k| {
        let (sine, cosine) = (from + (to - from) * k as f64 / CHORDS as f64).sin_cos();
        [centre[0] + radius * cosine, centre[1] + radius * sine]
    });
    std::iter::once(segment.from).chain(inner).chain([segment.to]).collect()
}
