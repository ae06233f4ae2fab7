//! The evaluation of a tool over a box.

use super::Enclosure;
#[cfg(feature = "interpreter")]
use super::bit;
use super::ternary::{Choice, Choices, Ternary};
use crate::interval::Interval;
use crate::tool::compiled::LaneEvaluation;
use crate::tool::{Evaluators, Outputs};

/// An enclosure of a tool's evaluation over a box of its frame.
#[derive(Clone, Copy, Debug)]
pub struct EvaluationEnclosure {
    /// True if points of the box may be inside.
    pub inside: bool,
    /// True if points of the box may be outside.
    pub outside: bool,
    /// The depth of the points inside.
    pub(super) depth: Enclosure,
    /// The regions that points of the box may belong to, one bit each; the 64th bit stands for all larger indices too.
    pub regions: u64,
}

impl EvaluationEnclosure {
    /// Evaluates a compiled tool over a box. `sides` is the extent of the box along x, y and z; for a tool with an axis
    /// the box lies in the half plane `y = 0`, `x ≥ 0`. Slopes are taken from `reference`, a point of the box.
    pub fn of<T: Evaluators>(sides: [Interval; 3], reference: [f64; 3]) -> EvaluationEnclosure {
        let present = Ternary { yes: true, no: false, gaps: [None; 2] };
        let outputs = Outputs { depth: true, region: true, ..Outputs::INSIDE };
        let one = Enclosure::constant(1.0);
        let LaneEvaluation { inside, depth, region, .. } =
            T::evaluate_lanes(Enclosure::of_box(sides, reference), one, present, outputs);
        EvaluationEnclosure {
            inside: inside.yes,
            outside: inside.no,
            depth,
            regions: region.regions,
        }
    }

    /// Returns an upper bound on the depth of all points of the box.
    pub fn max_depth(&self) -> f64 {
        self.depth.value.high
    }

    /// Returns an upper bound on the depth of all points in the convex hull of three corners. Infinite or NaN where a
    /// slope is not known.
    ///
    /// `displacements` has the displacement of each corner from the reference point, as an interval along each of x, y
    /// and z. The reference point has to lie in the box and in the hull.
    ///
    /// By the mean value theorem, a region's formula at a point is its value at the reference point plus slopes times
    /// the displacement. A choice `f` that holds where `g ≤ 0` is at most `f - λ g` there, for any `λ ≥ 0` (Lagrange).
    /// The minimum over `λ` of the maximum over the corners lies at 0 or where two corners have equal bounds. Where the
    /// argument of a square root may be negative its slope is unbounded, and so is the bound of some corner.
    pub fn max_depth_in_hull(&self, displacements: [[Interval; 3]; 3]) -> f64 {
        let Choices::Two(pair) = self.depth.choices else {
            let depths =
                displacements.map(|displacement| self.depth.linear.values(displacement).high);
            return depths[0].max(depths[1]).max(depths[2]);
        };
        let bounds = pair.map(|Choice { value, gap }| {
            let extremes = displacements.map(|displacement| {
                (value.values(displacement).high, gap.values(displacement).low)
            });
            // Avoids 0 · ∞, which is NaN.
            let bound_at = |multiplier: f64| {
                let product =
                    |gap: f64| if multiplier > 0.0 { (multiplier * gap).next_down() } else { 0.0 };
                let values = extremes.map(|(value, gap)| (value - product(gap)).next_up());
                values[0].max(values[1]).max(values[2])
            };
            let mut bound = bound_at(0.0);
            for (first, second) in [(0, 1), (1, 2), (2, 0)] {
                let multiplier = (extremes[first].0 - extremes[second].0)
                    / (extremes[first].1 - extremes[second].1);
                if multiplier > 0.0 && multiplier.is_finite() {
                    bound = bound.min(bound_at(multiplier));
                }
            }
            bound
        });
        bounds[0].max(bounds[1])
    }
}

#[cfg(feature = "interpreter")]
impl EvaluationEnclosure {
    /// Returns an enclosure of no points.
    pub(in crate::tool) fn empty() -> EvaluationEnclosure {
        EvaluationEnclosure { inside: false, outside: false, depth: Enclosure::EMPTY, regions: 0 }
    }

    /// Adds the points of a region with their depth, or points outside if `owner` is `None`. `test` is the undecided
    /// comparison with 0 that leads there, and whether the points are those below 0.
    pub(in crate::tool) fn include(
        &mut self,
        owner: Option<(usize, Enclosure)>,
        test: Option<(Enclosure, bool)>,
    ) {
        let Some((region, depth)) = owner else {
            self.outside = true;
            return;
        };
        let gap =
            test.map(|(value, below)| if below { value.linear } else { value.linear.negated() });
        let choices = self.depth.choices.and(depth.choices(gap));
        self.inside = true;
        self.regions |= bit(region);
        self.depth = Enclosure { choices, ..self.depth.hull(depth) };
    }
}
