//! A proof that feet lie on the profile. The foot of a point is the nearest point of the line, circle or
//! corner of its region.
//!
//! Depth, being the distance to the foot, is then at least the distance to the surface, whatever the borders
//! of regions are.

use super::cover::{Claim, Cover};
use super::root::{Forms, RootForm};
use crate::expr::Coord;
use crate::expr::interval::Cell;
use crate::expr::polynomial::{ClearSide, EnclosedPolynomial, Polynomial};
use crate::formula::{CurveIndex, one_side};
use crate::geometry::outline::{ExactPoint, Segment, unit_between};
use crate::number::Number;
use crate::plan::PlannedTool;
use crate::regionalise::Feature;
use std::cell::OnceCell;

/// The largest difference, relative to the tool's size, between a depth and the distance to its segment for
/// the two to count as equal. The difference is added to the certificate's slack, so the proof does not
/// depend on this number.
const DISTANCE_TOLERANCE_FRACTION: f64 = 1e-13;

/// An end of a region's segment, as linear functions with a gradient of length 1.
struct End {
    /// The signed distance from the normal at the end, not negative where feet are on the segment.
    inside: Polynomial,
    /// The same with enclosed coefficients.
    enclosed: EnclosedPolynomial,
    /// For an arc: the signed distance toward the end's side of the centre, and the ratio of diameter to
    /// chord.
    side: Option<(EnclosedPolynomial, f64)>,
}

impl End {
    fn new(inside: Polynomial, side: Option<(EnclosedPolynomial, f64)>) -> End {
        End { enclosed: inside.enclosed(), inside, side }
    }
}

type Ends = Vec<End>;

/// Lower bounds of an end's function above (0) and below (1) a curve. A cell is empty until it is asked for.
type Bounds = [OnceCell<Option<EnclosedPolynomial>>; 2];

/// The segments of a profile.
pub(super) struct ProfileFeet {
    /// The ends of each region's segment; a corner has none.
    ends: Vec<Ends>,
    /// The curves that are polynomials.
    curves: Vec<Option<Polynomial>>,
    /// The largest difference of depths from these distances.
    pub(super) max_difference: f64,
    /// For each region's ends, the bounds of their functions beside each curve, once one of them is needed.
    bounds: Vec<Vec<Vec<Bounds>>>,
}

impl ProfileFeet {
    /// Returns the segments of a profile, if each region's depth is the distance from the line, circle or
    /// corner of its own segment.
    pub(super) fn of(tool: &PlannedTool, forms: &mut Forms<'_>, size: f64) -> Option<ProfileFeet> {
        let model = &tool.model;
        let section = model.section.as_ref().filter(|_| model.is_exact())?;
        let (features, whole) = (section.inner.features(), tool.extent.cell());
        let mut max_difference = 0.0f64;
        let ends = model.regions.iter().enumerate().map(|(index, region)| {
            // With regions from `over`, several may belong to one part of the profile.
            let part = section.over.as_ref().map_or(index, |over| over.regions[index].part);
            let (distance, ends) = match *features.get(part)? {
                Feature::Piece(piece) => {
                    let segment = section.outline.get(piece)?;
                    (distance(segment)?, ends(segment)?)
                }
                Feature::Corner(None) => (from_point(&section.outline.first()?.from), Ends::new()),
                Feature::Corner(Some(piece)) => {
                    (from_point(&section.outline.get(piece)?.to), Ends::new())
                }
            };
            let difference = forms.of(region.depth)?.difference_bound(&distance, &whole)?;
            max_difference = max_difference.max(difference);
            (difference <= DISTANCE_TOLERANCE_FRACTION * size).then_some(ends)
        });
        let ends: Vec<Ends> = ends.collect::<Option<_>>()?;
        let curves = model.curves.iter().map(|curve| forms.polynomial(curve.value)).collect();
        let bounds = ends.iter().map(|ends| vec![Vec::new(); ends.len()]).collect();
        Some(ProfileFeet { ends, curves, max_difference, bounds })
    }

    /// Returns an upper bound of the distance of feet past the ends of their owner's segment, for a claim's
    /// points in a box.
    pub(super) fn overshoot(&mut self, claim: &Claim, cover: &mut Cover<'_>, cell: Cell) -> f64 {
        let Some(owner) = claim.owner else { return 0.0 };
        let mut max_overshoot = 0.0f64;
        for end in 0..self.ends[owner].len() {
            let mut overshoot = -self.ends[owner][end].enclosed.over(&cell).low;
            for (curve, _) in &claim.signs {
                // The box alone proves it, as for most boxes inside a region.
                if overshoot <= 0.0 {
                    break;
                }
                let Some(below) = one_side(cover.sign_at_claim(claim, *curve)) else { continue };
                if let Some(min_distance) = self.min_distance(owner, end, *curve, below, cell) {
                    overshoot = overshoot.min(-min_distance);
                }
            }
            // A point that is beyond the normal at an end by `o` is as near to that end as to the line or circle, up to
            // `2 o`. Behind the centre of an arc, at a distance `ρ` from it, the bound is `2 ρ`; if the arc turns by `T`,
            // such a point is beyond the normal at one end by at least `ρ sin (T/2)`, and `sin (T/2)` is half the chord
            // divided by the radius.
            let side = self.ends[owner][end].side.as_ref();
            let far_side = side.filter(|(side, _)| side.over(&cell).low < 0.0);
            max_overshoot =
                max_overshoot.max(overshoot * far_side.map_or(1.0, |(_, scale)| *scale));
        }
        max_overshoot
    }

    /// Returns a lower bound of the distance from an end's normal in a box, on one side of a curve: a nearby
    /// line, or a conic that does not cross the normal.
    fn min_distance(
        &mut self,
        owner: usize,
        end: usize,
        curve: CurveIndex,
        below: bool,
        cell: Cell,
    ) -> Option<f64> {
        let (curves, ends) = (&self.curves, &self.ends);
        let known = &mut self.bounds[owner][end];
        known.resize(curves.len(), Bounds::default());
        let bound = known[curve][usize::from(below)].get_or_init(|| {
            let curve = curves[curve].as_ref()?;
            let end = &ends[owner][end].inside;
            if !curve.is_linear() {
                // Where the end's function is negative, the conic has the opposite sign throughout.
                let opposite = ClearSide { is_below: true, is_positive: below };
                let is_clear = curve.clear_side_of(end)? == opposite;
                return is_clear.then(|| Polynomial::zero().enclosed());
            }
            let sign = Number::int(if below { 1 } else { -1 });
            // With this sign the line is at most 0 on its side, so the end's function is at least the sum of the
            // two. That is nearly constant if the line is the normal up to rounding.
            Some(curve.with_unit_slope()?.scaled(&sign).plus(end).enclosed())
        });
        bound.as_ref().map(|min_distance| min_distance.over(&cell).low)
    }
}

/// Returns the linear function that grows along a unit vector and is 0 at a point.
fn linear_function([d, z]: &[Number; 2], from: &ExactPoint) -> Polynomial {
    let [of_d, of_z] = [Coord::D, Coord::Z].map(Polynomial::coordinate);
    let rest = Polynomial::from_constant(&-&(&(d * &from[0]) + &(z * &from[1])));
    of_d.scaled(d).plus(&of_z.scaled(z)).plus(&rest)
}

fn from_point(point: &ExactPoint) -> RootForm {
    RootForm::new(Polynomial::zero(), Number::int(1), Polynomial::squared_distance(point))
}

/// Returns the distance from a segment's line or circle, positive inside.
fn distance(segment: &Segment) -> Option<RootForm> {
    let Some(circle) = &segment.circle else {
        let [d, z] = segment.direction()?;
        return Some(RootForm::from_polynomial(&linear_function(&[-&z, d], &segment.from)));
    };
    let sign = if circle.convex { 1 } else { -1 };
    let rest = Polynomial::from_constant(&(&Number::int(sign) * &circle.radius));
    Some(RootForm::new(rest, Number::int(-sign), Polynomial::squared_distance(&circle.centre)))
}

/// Returns the functions that are not negative between the normals at a segment's ends.
fn ends(segment: &Segment) -> Option<Ends> {
    let Some(circle) = &segment.circle else {
        let forward = segment.direction()?;
        let backward = forward.each_ref().map(|part| -part);
        return Some(vec![
            End::new(linear_function(&forward, &segment.from), None),
            End::new(linear_function(&backward, &segment.to), None),
        ]);
    };
    // To the left of the ray to one end and to the right of that to the other, or vice versa. Arcs span at
    // most 180°.
    let sign = Number::int(if circle.convex { 1 } else { -1 });
    let scale = diameter_by_chord([&segment.from, &segment.to], &circle.radius)?;
    let end_at = |end: &ExactPoint, sign: &Number| {
        let [d, z] = unit_between(&circle.centre, end)?;
        let side = linear_function(&[d.clone(), z.clone()], &circle.centre).enclosed();
        let inside = linear_function(&[&-&z * sign, &d * sign], &circle.centre);
        Some(End::new(inside, Some((side, scale))))
    };
    Some(vec![end_at(&segment.from, &sign)?, end_at(&segment.to, &-&sign)?])
}

/// Returns the ratio of an arc's diameter to its chord, rounded up.
fn diameter_by_chord([from, to]: [&ExactPoint; 2], radius: &Number) -> Option<f64> {
    // With 256 bits, since the coordinates of a short arc's ends have their leading digits in common.
    let [d, z] = [0, 1].map(|k| &to[k] - &from[k]);
    let chord = (&(&d * &d) + &(&z * &z)).sqrt()?;
    // The nearest double may be smaller.
    Some((&Number::int(2) * radius).checked_div(&chord)?.to_f64().next_up())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// In doubles the chord would be wrong by a fifth.
    #[test]
    fn short_arcs_far_from_the_origin_keep_their_chord() {
        let point =
            |d: &str, z: &str| [d, z].map(|text| Number::parse_decimal(text).expect("a number"));
        let [from, to] = [point("1000.1", "0"), point("1000.1000000000006", "0.0000000000008")];
        let scale = diameter_by_chord([&from, &to], &Number::int(5)).expect("two ends");
        assert!((1e13..=1e13 * (1.0 + 1e-15)).contains(&scale), "{scale:e}");
    }
}
