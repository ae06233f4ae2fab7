//! The section of a tool with a profile as convex pieces, which a plan separates, and how far the depths of a tree are from the
//! distance.

use super::Tree;
use super::meetings::WrongPoint;
use super::samples::Sample;
use crate::diagnostic::{CheckKind, Diagnostic};
use crate::formula::{CurveIndex, NEGATIVE, POSITIVE};
use crate::geometry::function::CurveFunction;
use crate::geometry::outline::{self, Point};
use crate::geometry::polygon::{Polygon, centroid, width};
use crate::model::{Model, Profile};
use crate::regionalise;
use crate::regionalise::overlay::{ConditionedPart, PieceDivider};
use crate::regionalise::pieces::{Piece, SampledPiece};
use crate::resolve::partitioned_anew;
use std::rc::Rc;

/// The distances of points far outside from the outline, in sizes: 8, 8², …, 8¹⁵.
fn far_distances(size: f64) -> impl Iterator<Item = f64> {
    (1..16).map(move |k| size * 8f64.powi(k))
}

/// The offsets of points in strips from the strips' middle line, in sizes.
const STRIP_OFFSETS: [f64; 4] = [-0.01, -1e-5, 1e-5, 0.01];

/// Returns points of the half plane far from the point of the axis at the height `middle`, all around.
fn ring_points(middle: f64, size: f64) -> Vec<Point> {
    let mut points = Vec::new();
    for distance in far_distances(size) {
        for k in 0..=128 {
            let (sin, cos) = ((f64::from(k) / 128.0 - 0.5) * std::f64::consts::PI).sin_cos();
            points.push([distance * cos, middle + distance * sin]);
        }
    }
    points
}

/// Returns points far from the end of a segment, in a thin strip along a unit vector and its opposite.
fn strip_points(end: Point, direction: Point, size: f64) -> Vec<Point> {
    let mut points = Vec::new();
    for distance in far_distances(size).flat_map(|distance| [distance, -distance]) {
        for offset in STRIP_OFFSETS {
            let across = [-direction[1] * offset * size, direction[0] * offset * size];
            points.push([0, 1].map(|k| end[k] + distance * direction[k] + across[k]));
        }
    }
    points
}

/// The greatest deviation of depth from the distance, in sizes. It is part of the stated error.
pub(super) const MAX_DEVIATION_FRACTION: f64 = 1e-8;

/// The difference of distances, in sizes, that a tree need not decide: rounding.
pub(super) const INDIFFERENCE: f64 = 1e-13;

/// Returns the greatest difference of a tree's depths from the distance, from the partition of the outline alone: nothing that
/// the model's other passes found is relied on. `None` without a profile, or if the difference is more than a plan may have.
pub(crate) fn proved_deviation(model: &Model, tree: &Tree) -> Option<f64> {
    let model = partitioned_anew(model)?;
    let profile = model.profile.as_ref()?;
    let (shapes, size) = profile.functions(&model.graph, &model.curves);
    let pieces = profile.pieces(&shapes);
    let cells = Cells::new(&model, profile, shapes, size, pieces);
    cells.deviation(tree, &cells.wrong_meetings(tree)).ok()
}

/// The cells of a profile's features, and the outside, as pieces.
pub(super) struct Cells<'m> {
    pub(super) model: &'m Model,
    profile: &'m Profile,
    pub(super) geometry: regionalise::Section<'m>,
    /// The tool's curves, and lines that its plan adds.
    pub(super) shapes: Vec<CurveFunction<'m>>,
    pub(super) size: f64,
    /// The distance from a curve within which a point may be on either side of it.
    pub(super) tolerance: f64,
    /// The pieces of the section.
    pub(super) pieces: Vec<Rc<Piece>>,
}

/// The pieces on the two sides of a curve.
pub(super) struct Halves {
    pub(super) below: Vec<Rc<Piece>>,
    pub(super) above: Vec<Rc<Piece>>,
}

impl<'m> Cells<'m> {
    pub(super) fn new(
        model: &'m Model,
        profile: &'m Profile,
        shapes: Vec<CurveFunction<'m>>,
        size: f64,
        pieces: Vec<Rc<Piece>>,
    ) -> Cells<'m> {
        let geometry = profile.inner.section();
        // Rounding of a large arc is that of its radius.
        let tolerance = (16.0 * f64::EPSILON * size).max(geometry.tolerance());
        Cells { model, profile, geometry, shapes, size, tolerance, pieces }
    }

    /// Returns pieces whose owners are regions or the outside, and sample points of these.
    pub(super) fn of_regions(&self, sampled: &[SampledPiece]) -> (Vec<Rc<Piece>>, Vec<Sample>) {
        let Some(over) = &self.profile.over else {
            let samples = sampled.iter().flat_map(|SampledPiece { piece, points }| {
                points.iter().map(|point| Sample::new(*point, piece.owner))
            });
            return (self.pieces.clone(), samples.collect());
        };
        let divider = PieceDivider::new(&over.division, &self.shapes, self.size);
        let (mut pieces, mut samples) = (Vec::new(), Vec::new());
        for SampledPiece { piece, points } in sampled {
            let points = points.iter().copied();
            let Some(part) = piece.owner else {
                samples.extend(points.map(|point| Sample::new(point, None)));
                pieces.push(Rc::clone(piece));
                continue;
            };
            let region = |condition| {
                let own = ConditionedPart { part, condition };
                over.regions.iter().position(|region| *region == own)
            };
            samples.extend(points.filter_map(|point| {
                Some(Sample::new(point, Some(region(divider.first_at(point.0)?)?)))
            }));
            for (divided, first) in divider.divided((**piece).clone(), self.geometry.tolerance()) {
                // A piece that no region claims, as far as samples show, has the depth of its part all the same.
                let fallback = || over.regions.iter().position(|region| region.part == part);
                let owner = first.and_then(region).or_else(fallback);
                pieces.push(Rc::new(Piece { owner, ..divided }));
            }
        }
        (pieces, samples)
    }

    /// Returns the greatest error of depth at the vertices of a piece if its points are given to an owner. At a point the owner's own
    /// distance counts too, since its line may end elsewhere and yet have the right depth.
    pub(super) fn loss(&self, piece: &Piece, owner: Option<usize>) -> f64 {
        let feature = owner.map(|region| self.profile.feature_of(region));
        let loss = self.depth_error(piece, owner);
        match (piece.is_point(), piece.feature, feature) {
            (true, Some(own), Some(other)) => {
                let [own, other] =
                    [own, other].map(|of| self.geometry.distance_of(of, piece.vertices[0]));
                loss.max(other - own)
            }
            _ => loss,
        }
    }

    /// Returns the greatest error of depth at the vertices of a piece if its points are given to an owner.
    pub(super) fn depth_error(&self, piece: &Piece, owner: Option<usize>) -> f64 {
        let feature = owner.map(|region| self.profile.feature_of(region));
        let Some(own) = piece.feature.filter(|_| piece.is_point()) else {
            return self.geometry.loss_at_vertices([piece.feature, feature], &piece.vertices);
        };
        // At the end of a feature its line or circle may be nearer.
        let distance = self.geometry.distance_of(own, piece.vertices[0]);
        let depth = feature.map_or(0.0, |of| self.geometry.depth_at(of, piece.vertices[0]));
        (depth - distance).abs()
    }

    /// Returns the middle of the outline's box.
    pub(super) fn middle(&self) -> Point {
        let [low, high] = outline::bounding_box(&self.profile.outline);
        [0, 1].map(|k| f64::midpoint(low[k], high[k]))
    }

    /// Returns a piece of a part as one of a region: of the given one if that belongs to the part, otherwise of the part's first.
    pub(super) fn as_of_region(&self, piece: &Piece, region: Option<usize>) -> Rc<Piece> {
        let is_of_part = |region: &usize| Some(self.profile.feature_of(*region)) == piece.feature;
        let owner =
            region.filter(is_of_part).or_else(|| (0..self.model.regions.len()).find(is_of_part));
        Rc::new(Piece { owner, ..piece.clone() })
    }

    /// Returns whether all points of a polygon are on the same side of a curve.
    pub(super) fn is_beside(&self, curve: CurveIndex, polygon: &Polygon) -> bool {
        self.shapes[curve].is_beside(polygon, self.tolerance)
    }

    /// Returns the parts of pieces on the two sides of a curve.
    pub(super) fn halves(&self, curve: CurveIndex, pieces: &[Rc<Piece>]) -> Halves {
        let mut halves = Halves { below: Vec::new(), above: Vec::new() };
        for piece in pieces {
            match piece.signs_of(curve, &self.shapes[curve], self.tolerance) {
                NEGATIVE => halves.below.push(Rc::clone(piece)),
                POSITIVE => halves.above.push(Rc::clone(piece)),
                // Rounding decides on which side of a curve a point on it is.
                _ if piece.is_point() => {
                    halves.below.push(Rc::clone(piece));
                    halves.above.push(Rc::clone(piece));
                }
                _ => {
                    let [below, above] = piece.halves(curve, &self.shapes, self.tolerance);
                    halves.below.extend(below.map(Rc::new));
                    halves.above.extend(above.map(Rc::new));
                }
            }
        }
        halves
    }

    /// Returns an upper bound of the difference of the depth that a tree gives from the distance: on the pieces, and at the
    /// points where its curves meet.
    ///
    /// # Errors
    ///
    /// If it is more than a plan may have.
    pub(super) fn deviation(&self, tree: &Tree, wrong: &[WrongPoint]) -> Result<f64, Diagnostic> {
        let points = wrong.iter().map(|wrong| (wrong.error, wrong.piece.vertices[0]));
        let greatest = points
            .fold(self.deviation_of(tree, &self.pieces), |a, b| if a.0 >= b.0 { a } else { b });
        match greatest {
            (deviation, _) if deviation <= MAX_DEVIATION_FRACTION * self.size => Ok(deviation),
            (_, at) => Err(inseparable_owners(self.model, at)),
        }
    }

    /// Returns an upper bound of the difference of the depth that a tree gives from the distance, and a point near which it is
    /// about that. Every point is in a piece of the nearest feature, so it is enough to ask at the leaves which pieces have
    /// another.
    fn deviation_of(&self, tree: &Tree, pieces: &[Rc<Piece>]) -> (f64, Point) {
        match tree {
            Tree::Split { curve, below, above, .. } => {
                let halves = self.halves(*curve, pieces);
                let sides = [
                    self.deviation_of(below, &halves.below),
                    self.deviation_of(above, &halves.above),
                ];
                let [low, high] = sides;
                if low.0 > high.0 { low } else { high }
            }
            Tree::Leaf(owner) => {
                let feature = owner.map(|region| self.profile.feature_of(region));
                let losses = pieces
                    .iter()
                    .map(|piece| (self.greatest_loss(piece, feature), centroid(&piece.vertices)));
                losses.fold((0.0, [0.0; 2]), |a, b| if a.0 >= b.0 { a } else { b })
            }
        }
    }

    /// Returns an upper bound of the error of depth if the points that a piece owns are given to a feature, or to the outside.
    fn greatest_loss(&self, piece: &Piece, feature: Option<usize>) -> f64 {
        let may_own = |part: &Polygon| {
            let part = Piece { vertices: part.clone(), ..piece.clone() };
            part.may_own_a_point(&self.shapes, self.tolerance)
        };
        let allowed = MAX_DEVIATION_FRACTION * self.size;
        let owners = [piece.feature, feature];
        self.geometry.greatest_loss(owners, &piece.vertices, allowed, may_own)
    }

    /// Returns pieces without what their features own no points of, since others are nearer there.
    pub(super) fn owned_parts(&self, pieces: &[Rc<Piece>]) -> Vec<Rc<Piece>> {
        let owned = |piece: &Rc<Piece>| match piece.feature.filter(|_| !piece.is_point()) {
            None => Some(Rc::clone(piece)),
            Some(feature) => {
                let vertices = self.geometry.possibly_owned(feature, &piece.vertices)?;
                let piece = Piece { vertices, ..(**piece).clone() };
                (width(&piece.vertices) > self.tolerance).then(|| Rc::new(piece))
            }
        };
        pieces.iter().filter_map(owned).collect()
    }

    /// Returns whether the points of a piece may not be given to an owner: since depth would err by more than a plan may, or at a point
    /// by more than rounding.
    pub(super) fn is_wrong(&self, piece: &Piece, owner: Option<usize>) -> bool {
        let loss = self.loss(piece, owner);
        if piece.is_point() {
            return loss > INDIFFERENCE * self.size;
        }
        let feature = owner.map(|region| self.profile.feature_of(region));
        let allowed = MAX_DEVIATION_FRACTION * self.size;
        loss > allowed && self.greatest_loss(piece, feature) > allowed
    }

    /// Returns whether a tree has an owner far outside, where there is no piece. The test uses points all around, and points in
    /// thin strips along the lines and normals of the outline.
    pub(super) fn has_owner_far_outside(&self, tree: &Tree) -> bool {
        let [low, high] = outline::bounding_box(&self.profile.outline).map(|end| end[1]);
        let mut points = ring_points(low / 2.0 + high / 2.0, self.size);
        for segment in &self.profile.outline {
            let along = segment.geometry.along;
            for end in segment.geometry.ends {
                points.extend(strip_points(end, along, self.size));
                points.extend(strip_points(end, [-along[1], along[0]], self.size));
            }
        }
        let mut in_half_plane = points.into_iter().filter(|p| p[0] >= 0.0);
        in_half_plane.any(|p| tree.owner_at(&|curve| self.shapes[curve].value(p)).is_some())
    }
}

fn inseparable_owners(model: &Model, [d, z]: Point) -> Diagnostic {
    let outline = model.profile.iter().flat_map(|profile| &profile.outline);
    let outline: Vec<_> = outline.cloned().collect();
    let span = outline::nearest_span(&outline, [d, z]).unwrap_or(model.name_span);
    let z = model.frame.to_file(z);
    Diagnostic::new(span, CheckKind::Inseparable { d, z })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every direction of the half plane has a point at eight sizes.
    #[test]
    fn points_far_away_are_all_around() {
        let points = ring_points(2.0, 3.0);
        for degrees in -90..=90 {
            let (sine, cosine) = f64::from(degrees).to_radians().sin_cos();
            let is_near = |[d, z]: &Point| {
                let length = d.hypot(z - 2.0);
                let turned = (d * cosine + (z - 2.0) * sine) / length;
                // Neighbours are 1.41 degrees apart.
                (length - 24.0).abs() < 1e-9 && turned > 0.0125f64.cos()
            };
            assert!(points.iter().any(is_near), "{degrees}");
        }
    }
}
