//! The division of a profile's inside by the nearest segments of its outline with rounded corners.

use super::Partition;
use super::curve::Test;
use super::pieces::{Piece, Separations};
use super::section::{Feature, Section};
use super::smooth::Origin;
use crate::expr::Graph;
use crate::formula::Formula;
use crate::geometry::function::CurveFunction;
use crate::geometry::outline::{Point, Segment, cross, minus};
use crate::geometry::polygon::{Polygon, contains, hull};
use touchoff_plane::Circle;

/// The outline with rounded corners, and its partition.
#[derive(Clone, Debug)]
pub(crate) struct Rounded {
    pub(crate) partition: Partition,
    pub(crate) separations: Separations,
    /// What protrudes beyond the arcs of convex corners.
    tips: Vec<Tip>,
}

/// The arc of a convex corner, by its index in the rounded outline, and a polygon about what is between the arc and the corner.
#[derive(Clone, Debug)]
struct Tip {
    segment: usize,
    polygon: Polygon,
}

impl Rounded {
    /// Divides the inside of an outline by its rounded outline, whose segments have these origins.
    pub(crate) fn new(
        outline: &[Segment],
        rounded: &[(Segment, Origin)],
        graph: &mut Graph,
        register: &mut impl FnMut(&mut Graph, &Test) -> Formula,
    ) -> Rounded {
        let tips = rounded.iter().enumerate().filter_map(|(segment, (arc, origin))| {
            let Origin::Fan(behind) = *origin else { return None };
            let is_convex = arc.geometry.circle.is_some_and(|Circle { convex, .. }| convex);
            is_convex.then(|| Tip { segment, polygon: tip(outline, behind, arc) })
        });
        let tips = tips.collect();
        let segments = rounded.iter().map(|(segment, _)| segment.clone());
        let partition = Partition::new(segments.collect());
        let separations = partition.separations(graph, register);
        Rounded { partition, separations, tips }
    }

    /// Divides the inside again, from the rounded outline alone.
    pub(crate) fn divide_anew(
        &mut self,
        graph: &mut Graph,
        register: &mut impl FnMut(&mut Graph, &Test) -> Formula,
    ) {
        self.partition = Partition::new(std::mem::take(&mut self.partition.outline));
        self.separations = self.partition.separations(graph, register);
    }

    /// Returns pieces that cover the inside of the outline, whose owners are the nearest segments of the rounded outline.
    pub(crate) fn pieces(&self, shapes: &[CurveFunction<'_>]) -> Vec<Piece> {
        let features = self.partition.section().features;
        let mut pieces = self.partition.inner_pieces(&self.separations, shapes);
        for piece in &mut pieces {
            piece.owner = piece.feature.and_then(|feature| features[feature].piece());
        }
        for tip in &self.tips {
            let arc = Feature::Piece(tip.segment);
            let Some(feature) = features.iter().position(|other| *other == arc) else { continue };
            let beyond = self.separations.outer_side(feature);
            pieces.push(Piece {
                feature: Some(feature),
                owner: Some(tip.segment),
                vertices: tip.polygon.clone(),
                signs: beyond.into_iter().collect(),
                alternatives: Vec::new(),
            });
        }
        pieces
    }
}

/// A rounded outline with the geometry of its segments.
#[derive(Clone, Debug)]
pub(crate) struct RoundedSection<'r> {
    rounded: &'r Rounded,
    section: Section<'r>,
}

impl<'r> RoundedSection<'r> {
    /// Returns the geometry of a rounded outline.
    pub(crate) fn new(rounded: &'r Rounded) -> RoundedSection<'r> {
        RoundedSection { rounded, section: rounded.partition.section() }
    }

    /// Returns the nearest segment to a point, and by how much the next one is farther, infinite if that is more than rounding.
    /// A point between an arc and the corner that it rounds belongs to the arc. Elsewhere, no segment is nearest from behind.
    pub(crate) fn nearest(&self, p: Point) -> (Option<usize>, f64) {
        let (outline, tolerance) = (self.section.outline, self.section.tolerance());
        for Tip { segment, polygon } in &self.rounded.tips {
            let beyond = -outline[*segment].geometry.signed_distance(p);
            if beyond > tolerance && contains(polygon, p) {
                return (Some(*segment), beyond);
            }
        }
        let (mut nearest, mut least, mut next) = (None, f64::INFINITY, f64::INFINITY);
        for (feature, index) in self.section.pieces() {
            if !self.section.is_box_within(feature, p, least + 2.0 * self.margin()) {
                continue;
            }
            let segment = &outline[index];
            let is_within = segment.geometry.sector(p).iter().all(|side| *side >= -tolerance);
            let distance = segment.geometry.signed_distance(p);
            if !is_within || distance < -tolerance {
                continue;
            }
            if distance < least {
                (nearest, least, next) = (Some(index), distance, least);
            } else {
                next = next.min(distance);
            }
        }
        (nearest, next - least)
    }

    /// Returns the nearest segment to a point, unless rounding decides which one that is.
    pub(super) fn certainly_nearest(&self, p: Point) -> Option<usize> {
        let (nearest, margin) = self.nearest(p);
        nearest.filter(|_| margin > self.margin())
    }

    /// Returns the difference of distances within which rounding decides which segment is nearest.
    fn margin(&self) -> f64 {
        4.0 * self.section.tolerance()
    }
}

/// Returns a convex polygon about the points between the arc that rounds a convex corner and the corner, which is behind a segment
/// of the outline or, for `None`, before the first one.
fn tip(outline: &[Segment], behind: Option<usize>, arc: &Segment) -> Polygon {
    let [from, to] = arc.geometry.ends;
    let corner = match behind {
        Some(piece) => outline[piece].geometry.ends[1],
        None => outline[0].geometry.ends[0],
    };
    let mut points = vec![from, corner, to];
    // An arc lies between its chord and its tangents, which meet in a point.
    let before = behind.map(|piece| (piece, true, from));
    let after = behind.map_or(0, |piece| piece + 1);
    let after = (after < outline.len()).then_some((after, false, to));
    for (piece, at_end, contact) in [before, after].into_iter().flatten() {
        let segment = &outline[piece];
        if segment.geometry.circle.is_none() {
            continue;
        }
        let inward = segment.geometry.inward(contact);
        let (at_contact, at_corner) =
            ([-inward[1], inward[0]], segment.geometry.tangent(usize::from(at_end)));
        let sine = cross(at_contact, at_corner);
        if sine != 0.0 {
            let t = cross(minus(corner, contact), at_corner) / sine;
            points.push([0, 1].map(|k| contact[k] + t * at_contact[k]));
        }
    }
    hull(points)
}
