//! Bounds of the rate at which depth falls toward the surface, for regions by hand.

use super::super::cover::half_diagonal;
use super::super::slope::{SLOPE_MARGIN, SLOPE_TOLERANCE};
use super::{BoxSize, Survey};
use crate::domain::Domain;
use crate::expr::interval::{Cell, Interval, ZERO as NOTHING};
use std::f64::consts::TAU;

/// The lengths of descents tried from point boxes: relative to the tool's size, and, to reach the surface, in
/// half diagonals of the box.
const STEP_FRACTIONS: [f64; 4] = [1e-1, 1e-2, 1e-3, 1e-4];
const STEPS_IN_HALF_DIAGONALS: [f64; 6] = [4.0, 16.0, 64.0, 256.0, 1024.0, 4096.0];
/// The distance, relative to the tool's size, from zeros of depth to points that are proved to be outside.
const ZERO_OFFSET_FRACTION: f64 = 1e-11;
/// The largest number of times that a box is made smaller along an axis, to a third or more of its side.
const MAX_SHRINKS: u32 = 100;
/// The number of other directions tried.
const EXTRA_DIRECTIONS: u32 = 16;

/// The descents from a point box.
pub(super) struct Descent {
    /// The largest rate found: the least depth in the box minus the depth at the descent's end, divided by
    /// the distance of that end from the box's farthest point. Infinite if the box is next to the outside.
    steepest: f64,
    /// The shortest of the short descents that end where depth is less than anywhere in the box.
    step: Option<f64>,
}

/// The depth at a point.
struct PointDepth {
    /// An upper bound; 0 outside.
    high: f64,
    /// True if no region may own the point.
    is_outside: bool,
}

impl Survey<'_> {
    /// Returns a lower bound of the rate at which a region's depth falls in a box, which is the current one and
    /// has the given owners.
    pub(super) fn fall_rate(&mut self, owner: usize, owners: &[Option<usize>], cell: Cell) -> f64 {
        let depth = self.slopes.get(self.tool.model.regions[owner].depth);
        // A length is not smooth where it is 0. On the surface depth need not fall.
        let is_length = self.border_prover.as_ref().is_some_and(|prover| prover.is_length(owner));
        let is_smooth_length = is_length
            && (depth.value.low > 0.0
                || owners.contains(&None) && self.are_zero_on_surface_only(&[owner], cell));
        if is_smooth_length { depth.length.low } else { depth.fall() }
    }

    /// Returns whether the points of a box at which some regions' depths are all 0 are proved to be next to points outside
    /// the solid. Their distance from these is recorded.
    pub(super) fn are_zero_on_surface_only(&mut self, owners: &[usize], cell: Cell) -> bool {
        // In the half plane a length is 0 at points, which a few point boxes cover.
        if self.tool.model.domain != Domain::Space {
            return false;
        }
        // An edge along an axis has too many point boxes. But the box shrinks to the edge, and the shrunk box is outside
        // if it is moved a little.
        let zeros = self.shrunk_to_zeros(owners, cell);
        self.slopes.set(cell);
        let step = ZERO_OFFSET_FRACTION * self.size;
        // To all neighbours of the box: an edge along an axis is left by one of them.
        for direction in 0..27 {
            let offset = [direction % 3, direction / 3 % 3, direction / 9].map(|k: i32| k - 1);
            let moved = (0..3).fold(zeros, |moved, axis| {
                let by = step * f64::from(offset[axis]);
                moved.with_side(axis, moved.sides[axis].plus(Interval::new(by, by)))
            });
            if self.cover.claims(moved).iter().all(|claim| claim.owner.is_none()) {
                // No offset is longer than twice the step.
                self.surface_distance = self.surface_distance.max(2.0 * step);
                return true;
            }
        }
        false
    }

    /// Returns a part of a box that contains all its points at which some regions' depths are all 0.
    fn shrunk_to_zeros(&mut self, owners: &[usize], mut cell: Cell) -> Cell {
        let regions = &self.tool.model.regions;
        for axis in 0..3 {
            for _ in 0..MAX_SHRINKS {
                let side = cell.sides[axis];
                // Not the middle, where zeros often are.
                let split = side.low + 0.382 * (side.high - side.low);
                let lower = cell.with_side(axis, Interval::new(side.low, split));
                let upper = cell.with_side(axis, Interval::new(split, side.high));
                let may_be_zero = [lower, upper].map(|part| {
                    self.slopes.set(part);
                    let mut depths = owners.iter().map(|owner| regions[*owner].depth);
                    depths.all(|depth| {
                        let Interval { low, high } = self.slopes.get(depth).value;
                        low <= 0.0 && high >= 0.0
                    })
                });
                cell = match may_be_zero {
                    // Only one part may have zeros. With both, or none for want of accuracy, the box stays.
                    [true, false] => lower,
                    [false, true] => upper,
                    _ => break,
                };
            }
        }
        cell
    }

    /// Records the rate at which depth falls from the points of a box.
    pub(super) fn record_descent(
        &mut self,
        owners: &[Option<usize>],
        cell: Cell,
        box_size: BoxSize,
    ) {
        if self.border_prover.is_none() {
            return;
        }
        if box_size != BoxSize::Point {
            for owner in owners.iter().flatten() {
                let rate = self.fall_rate(*owner, owners, cell);
                self.min_slope = self.min_slope.min(rate);
            }
            self.record_descent_on_axis(cell);
        } else {
            // Also beside the outside: that it claims a part of the box does not prove that it has one.
            let descent = self.descent_from_point(owners, cell);
            self.descents.push(descent);
        }
    }

    /// Records the rate at which depth falls from points of a box on the axis. Where depth grows away from
    /// the axis it is not smooth there, and only its slope along the axis leads down.
    fn record_descent_on_axis(&mut self, cell: Cell) {
        if self.tool.model.domain != Domain::HalfPlane || cell.sides[0].low > 0.0 {
            return;
        }
        // On the axis, depth meets its mirror image.
        let axis = cell.with_side(0, NOTHING);
        self.slopes.set(axis);
        let claims = self.cover.claims(axis);
        let owners = claims.iter().filter_map(|claim| claim.owner);
        let slopes =
            owners.map(|owner| self.slopes.get(self.tool.model.regions[owner].depth).partials);
        let slopes: Vec<[Interval; 3]> = slopes.collect();
        // With their mirror images, slopes along the axis may have any mean of the regions'.
        if slopes.iter().any(|partials| partials[0].high > SLOPE_TOLERANCE) {
            let along = slopes.iter().map(|partials| partials[2]).reduce(Interval::hull);
            self.min_slope = self.min_slope.min(along.map_or(0.0, |along| along.abs().low));
        }
        self.slopes.set(cell);
    }

    /// Tries descents from a point box: straight down the owners' gradients, and if these do not suffice, in
    /// other directions.
    fn descent_from_point(&mut self, owners: &[Option<usize>], cell: Cell) -> Descent {
        let (regions, middle) = (&self.tool.model.regions, cell.middle());
        let depths = owners.iter().flatten().map(|owner| regions[*owner].depth);
        let low = depths.map(|id| self.slopes.get(id).value.low).fold(f64::INFINITY, f64::min);
        self.slopes.set(Cell::point(middle));
        let slopes: Vec<[f64; 3]> = owners
            .iter()
            .flatten()
            .map(|owner| {
                let slope = self.slopes.get(regions[*owner].depth);
                slope.partials.map(Interval::middle)
            })
            .collect();
        let half_diagonal_of_box = half_diagonal(&cell);
        let mut best = Descent { steepest: 0.0, step: None };
        let extra_directions = (0..EXTRA_DIRECTIONS).map(|k| {
            let angle = TAU * f64::from(k) / f64::from(EXTRA_DIRECTIONS);
            [angle.cos(), 0.0, angle.sin()]
        });
        for (k, gradient) in slopes.iter().copied().chain(extra_directions).enumerate() {
            // Other directions cost many evaluations, and this box no longer decides the slope.
            if k >= slopes.len() && (best.step.is_some() || best.steepest >= self.min_slope) {
                break;
            }
            let length = gradient.iter().map(|part| part * part).sum::<f64>().sqrt();
            let steps = STEPS_IN_HALF_DIAGONALS.map(|part| part * half_diagonal_of_box).into_iter();
            for step_length in steps.clone().chain(STEP_FRACTIONS.map(|part| part * self.size)) {
                let end_point = [0, 1, 2].map(|k| middle[k] - step_length * gradient[k] / length);
                // A gradient of 0 has no direction either: the end is not a number then.
                let Some(PointDepth { high, is_outside }) = self.depth_at(end_point) else {
                    continue;
                };
                // The rate must hold for every point of the box, the farthest from the end included.
                let farthest =
                    farthest(&cell, end_point).max(step_length + 2.0 * half_diagonal_of_box);
                let is_near = step_length
                    <= STEPS_IN_HALF_DIAGONALS[STEPS_IN_HALF_DIAGONALS.len() - 1]
                        * half_diagonal_of_box;
                // The end is outside: the surface is nearer than it.
                if is_outside && is_near {
                    self.surface_distance = self.surface_distance.max(farthest);
                    return Descent { steepest: f64::INFINITY, step: None };
                }
                let decrease = Interval::new(low, low).plus(Interval::new(-high, -high));
                let per_distance = Interval::new(farthest, farthest).reciprocal();
                best.steepest = best.steepest.max(decrease.times(per_distance).low);
                // Less deep than anywhere in the box, so no descent returns to it.
                if high < low && is_near && best.step.is_none_or(|step| farthest < step) {
                    best.step = Some(farthest);
                }
            }
        }
        best
    }

    /// Returns the largest possible depth at a point, over all regions that may own it. Returns `None` if the point is
    /// not in the domain.
    fn depth_at(&mut self, point: [f64; 3]) -> Option<PointDepth> {
        let off_axis = self.tool.model.domain == Domain::HalfPlane && point[0] < 0.0;
        if off_axis || !point.iter().all(|part| part.is_finite()) {
            return None;
        }
        let claims = self.cover.claims(Cell::point(point));
        self.slopes.set(Cell::point(point));
        let owners = claims.iter().filter_map(|claim| claim.owner);
        let depths = owners.map(|owner| self.tool.model.regions[owner].depth);
        let high = depths.map(|depth| self.slopes.get(depth).value.high).fold(0.0, f64::max);
        Some(PointDepth { high, is_outside: claims.iter().all(|claim| claim.owner.is_none()) })
    }

    /// Returns a lower bound of the rate at which depth falls toward the surface, and the distance by which
    /// the descent may miss the surface.
    pub(super) fn min_slope(&self) -> (f64, f64) {
        // A depth that steps along a border may be least on the lower side of the step, where the slopes of
        // both sides lead on.
        if self.smooth_border_jumps.values().any(|jump| *jump > 0.0) {
            return (0.0, 0.0);
        }
        // Depth falls along a descent, so each such box is met once: the length of the step out of it is
        // added to the distance missed.
        let (mut min_slope, mut steps) = (self.min_slope, 0.0);
        for descent in self.descents.iter().filter(|descent| descent.steepest < self.min_slope) {
            match descent.step {
                Some(step) => steps += step,
                None => min_slope = min_slope.min(descent.steepest),
            }
        }
        // The tolerance covers neglected slopes. If no box was inside, the rate is still infinite and proves
        // nothing.
        let min_slope = if min_slope.is_finite() { min_slope - SLOPE_MARGIN } else { 0.0 };
        (min_slope, self.surface_distance + steps)
    }
}

/// Returns an upper bound of the distance between a point and the points of a box.
fn farthest(cell: &Cell, from: [f64; 3]) -> f64 {
    let squares = [0, 1, 2]
        .map(|axis| cell.sides[axis].plus(Interval::new(-from[axis], -from[axis])).square());
    squares.into_iter().fold(NOTHING, Interval::plus).sqrt().high
}
