//! The certificate: the conclusions from all boxes.

use super::{OpenProof, RegionFacts, Survey, TOLERANCE, sum_rounded_up, unless_rounding};
use crate::diagnostic::Statement;
use crate::domain::Domain;
use crate::expr::interval::{Cell, Interval};
use crate::prove::Certificate;
use crate::prove::jordan::Profile;
use crate::prove::range::Ranges;
use crate::prove::witness::TEST_OFFSET_FRACTION;

impl Survey<'_> {
    /// Returns the certificate that follows from all boxes.
    pub(super) fn certificate(mut self) -> Certificate {
        let shares = self.witness.shares();
        let (min_slope, missed_distance) = self.min_slope();
        let slack = [
            self.jump_bound(),
            2.0 * self.overshoot,
            sum_rounded_up(0.0, min_slope.max(0.0) * missed_distance),
        ];
        let slack = slack.into_iter().fold(0.0, sum_rounded_up);
        let slack = sum_rounded_up(slack, self.distance_to_profile(slack));
        let mut ranges = Ranges {
            cover: &mut self.cover,
            slopes: &mut self.slopes,
            whole: self.tool.extent.cell(),
        };
        if self.check_overlaps {
            for (index, region) in self.tool.model.regions.iter().enumerate() {
                if let Some(facts) = &mut self.regions[index] {
                    facts.niceness = ranges.niceness(index, region, facts.niceness);
                }
            }
        }
        let mut regions = Vec::new();
        for (region, direction) in self.directions.into_iter().enumerate() {
            let facts = self.regions[region].take().unwrap_or(RegionFacts::NONE);
            let is_distance = self.border_prover.is_distance(region);
            let exact_length = Interval::new(1.0, 1.0);
            regions.push(RegionFacts {
                share: shares[region],
                is_distance,
                gradient_length: if is_distance { exact_length } else { facts.gradient_length },
                direction_error: direction.angle_to_descent,
                oblique_witness: self.certain_facts[region].oblique,
                rising_witness: self.certain_facts[region].rises,
                singular_cells: direction.singular,
                turns_on_axis: direction.on_axis,
                ..facts
            });
        }
        Certificate {
            min_slope,
            slack,
            regions,
            borders: self.borders.into_values().collect(),
            undecided: self.undecided,
            tolerance: TOLERANCE * self.size,
            examined_boxes: self.boxes,
        }
    }

    /// Returns an upper bound of the amount that depth may gain by jumps along a straight path, and by
    /// differing from an exact distance.
    ///
    /// Let all depths differ by less than `deviation` from distances to lines, circles or points. On a path of
    /// length `t`, each of these distances minus `t` does not grow, inside or outside its own region. When
    /// the path returns to a region, it has therefore not gained since it left. Only the jumps that remain
    /// after such loops are removed count: one per pair of regions. Other depths may be steep outside their
    /// regions, so every jump counts. A straight path crosses a conic twice.
    ///
    /// A straight path in space around the axis is a branch of a hyperbola in the half plane, on which `z` is linear
    /// and `d` convex. It passes a box at most twice, since `d` is below an upper end on one interval and above a
    /// lower end on two. It crosses a conic at most four times.
    fn jump_bound(&self) -> f64 {
        let steps = self.smooth_border_jumps.values().copied().fold(0.0, sum_rounded_up);
        let Some(feet) = &self.feet else {
            let passes = match self.tool.model.domain {
                Domain::HalfPlane => 2.0,
                Domain::Space => 1.0,
            };
            return passes * sum_rounded_up(self.jumps, 2.0 * steps);
        };
        let deviation = unless_rounding(feet.max_difference, self.size);
        let pairs = (self.largest_jumps.len() + self.smooth_border_jumps.len()) as f64;
        self.largest_jumps.values().copied().fold(
            sum_rounded_up(steps, sum_rounded_up(deviation, 2.0 * pairs * deviation)),
            sum_rounded_up,
        )
    }

    /// Returns an upper bound of the distance from the solid's surface to its profile, given the slack of
    /// depth.
    fn distance_to_profile(&mut self, slack: f64) -> f64 {
        let Some(section) = &self.tool.model.section else { return 0.0 };
        let (deviation, ends) = self.witness.points_off_profile(&section.outline);
        let open_proofs = deviation.into_iter().map(|point| OpenProof {
            cell: Cell::point(point),
            statement: Statement::EndsOnProfile,
        });
        self.undecided.extend(open_proofs);
        // Nothing follows if a proof is open, or if depth is not the distance to the profile.
        if self.feet.is_none() || !self.undecided.is_empty() {
            return 0.0;
        }
        let max_distance = Profile::new(&section.outline)
            .max_distance(slack, TEST_OFFSET_FRACTION * self.size)
            .filter(|_| ends);
        max_distance.unwrap_or_else(|| {
            self.undecided.push(OpenProof {
                cell: self.tool.extent.cell(),
                statement: Statement::EndsOnProfile,
            });
            0.0
        })
    }
}
