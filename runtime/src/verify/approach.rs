//! Closest approach of a program to the part. A program for another location or in another unit gouges nothing,
//! but stays far from the part.

use super::{Finding, FindingKind, Verifier, VerifyError};
use crate::certify::Certifier;
use crate::interval::Interval;
use crate::mesh;
use crate::motion::Motion;
use crate::pose::Pose;
use crate::program::CutterLocation;
use crate::tool::{ProfileSegment, ToolInfo};
use nalgebra::Point3;

/// Location of a program relative to the part. Lengths are in the part's unit, points in its frame.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Approach {
    /// Lowest and highest corner of the part's bounding box.
    pub part: [Point3<f64>; 2],
    /// Lowest and highest corner of the bounding box of all tips.
    pub program: [Point3<f64>; 2],
    /// Upper bound on the least distance between the tool and a triangle of the part; 0 if they touch.
    pub distance: f64,
    /// Line of the cutter location with that distance, or of the one at which the motion with it ends.
    pub line: usize,
    /// Diameter of the cutting surfaces, or of the tool if nothing cuts.
    pub diameter: f64,
    /// If no motion comes as near as the diameter: a proved lower bound on the distance between the whole tool
    /// and all triangles, over all motions.
    pub proved_clearance: Option<f64>,
}

impl Approach {
    /// Returns whether the tool stays farther from the part than its diameter on all motions. The program is
    /// then hardly meant for this part in this position.
    pub fn is_far(&self) -> bool {
        self.proved_clearance.is_some()
    }
}

/// Tolerance of distances as a fraction of the tool's diameter, and of the bound over all motions as a fraction
/// of the distance.
const TOLERANCE_FRACTION: f64 = 1.0 / 64.0;

/// Largest number of halvings of a motion. If they do not decide, the tool counts as near.
const MAX_HALVINGS: u32 = 40;

impl Verifier<'_> {
    /// Computes the closest approach of the cutter locations to the part, given their findings.
    pub(super) fn approach(
        &self,
        locations: &[CutterLocation],
        findings: &[Finding],
    ) -> Result<Approach, VerifyError> {
        let info = self.tool.info();
        let length = info.unit.factor_to(self.bvh.unit());
        let cutting = info.outline.iter().filter(|segment| info.surface(segment.surface).cutting);
        let widest = |segment: &ProfileSegment| {
            let bulge = segment.circle.filter(|circle| circle.convex);
            let bulge = bulge.map_or(0.0, |circle| circle.centre[0] + circle.radius);
            segment.from[0].max(segment.to[0]).max(bulge)
        };
        let radius = cutting.map(widest).fold(0.0, f64::max);
        let radius = if radius > 0.0 { radius } else { info.radius() };
        let diameter = 2.0 * radius * length;
        let mut search = ApproachSearch {
            verifier: self,
            certifier: Certifier::new(self.bvh, self.tool)?.with_budget(self.budget),
            tip_reach: max_distance_from_tip(info) * length,
            tolerance: TOLERANCE_FRACTION * diameter,
            distance: f64::INFINITY,
            line: locations.first().map_or(0, |location| location.line),
        };
        let touching = findings.iter().find(|found| {
            matches!(found.kind, FindingKind::Deep { .. } | FindingKind::Inside { .. })
        });
        let mut proved_clearance = None;
        if let Some(found) = touching {
            (search.distance, search.line) = (0.0, found.line);
        } else {
            let lower_bounds = search.location_bounds(locations);
            if search.distance > diameter {
                proved_clearance =
                    search.motion_bound(locations, &lower_bounds).filter(|bound| *bound > diameter);
            }
        }
        let ApproachSearch { distance, line, .. } = search;
        let tips = locations.iter().map(|location| location.pose.tip());
        Ok(Approach {
            part: self.bvh.bounds(),
            program: mesh::bounds(tips),
            distance,
            line,
            diameter,
            proved_clearance,
        })
    }
}

/// Returns an upper bound on the distance of the tool's points from its tip, in the tool's unit.
fn max_distance_from_tip(info: &ToolInfo) -> f64 {
    let Interval { low, high } = info.reach();
    low.abs().max(high.abs()).hypot(info.radius())
}

/// The search for the closest approach.
struct ApproachSearch<'a> {
    verifier: &'a Verifier<'a>,
    certifier: Certifier<'a>,
    /// Upper bound on the distance of the tool's points from its tip, in the part's unit: their travel per radian.
    tip_reach: f64,
    tolerance: f64,
    /// The least distance so far.
    distance: f64,
    /// The line of that distance.
    line: usize,
}

impl ApproachSearch<'_> {
    /// Returns an upper bound on the travel of any point of the tool from one pose to another.
    fn max_travel(&self, from: &Pose, to: &Pose) -> f64 {
        match self.verifier.motion(from, to) {
            Ok(motion) => motion.displacement().norm() + motion.angle() * self.tip_reach,
            Err(_) => f64::INFINITY,
        }
    }

    /// Queries the distance at a pose, and returns a lower bound on it.
    fn query(&mut self, pose: &Pose, line: usize) -> f64 {
        let Interval { mut low, mut high } =
            self.certifier.clearance(pose, self.tolerance).distance;
        if high == f64::INFINITY {
            // A tool without a profile (a field) gives no upper bound on the distance. A lower bound of 0 is
            // refined.
            if low == 0.0 {
                Interval { low, .. } = self
                    .certifier
                    .clearance(pose, TOLERANCE_FRACTION * TOLERANCE_FRACTION * self.tolerance)
                    .distance;
            }
            high = low;
        }
        if high < self.distance {
            (self.distance, self.line) = (high, line);
        }
        low
    }

    /// Queries the cutter locations, except where the one before proves that none is nearer, and returns a
    /// lower bound on each distance. Ends at the first contact.
    fn location_bounds(&mut self, locations: &[CutterLocation]) -> Vec<f64> {
        let mut lower_bounds = Vec::with_capacity(locations.len());
        let mut before: Option<(f64, &Pose)> = None;
        for location in locations {
            let bound = before.map_or(0.0, |(low, pose)| {
                let max_travel = self.max_travel(pose, &location.pose);
                low - max_travel - 4.0 * f64::EPSILON * (low + max_travel)
            });
            let bound = if bound > self.distance {
                bound
            } else {
                self.query(&location.pose, location.line)
            };
            lower_bounds.push(bound);
            if self.distance == 0.0 {
                break;
            }
            before = Some((bound, &location.pose));
        }
        lower_bounds
    }

    /// Returns a lower bound on the distance over all motions, within a fraction of the least distance; `None`
    /// if that is not proved.
    fn motion_bound(&mut self, locations: &[CutterLocation], lower_bounds: &[f64]) -> Option<f64> {
        let mut bound = f64::INFINITY;
        for (pair, ends) in locations.windows(2).zip(lower_bounds.windows(2)) {
            // An ambiguous motion is a finding; only its ends are checked.
            if let Ok(motion) = self.verifier.motion(&pair[0].pose, &pair[1].pose) {
                let max_travel = motion.displacement().norm() + motion.angle() * self.tip_reach;
                let span = Span { times: [0.0, 1.0], lower_bounds: [ends[0], ends[1]], max_travel };
                bound = bound.min(self.span(&motion, span, (pair[1].line, MAX_HALVINGS))?);
            }
        }
        let ends = lower_bounds.iter().copied().fold(f64::INFINITY, f64::min);
        Some(bound.min(ends))
    }

    /// Returns a lower bound on the distance over a span of a motion; `None` if that is not proved.
    fn span(&mut self, motion: &Motion, span: Span, (line, halvings): (usize, u32)) -> Option<f64> {
        let Span { times: [from, to], lower_bounds: [first, last], max_travel } = span;
        // At any time the distance is at least that at either end, less the travel from there.
        let rounding = 4.0 * f64::EPSILON * (first.abs() + last.abs() + max_travel);
        let bound = 0.5 * (first + last - max_travel) - rounding;
        if bound >= (1.0 - TOLERANCE_FRACTION) * self.distance {
            return Some(bound);
        }
        let halvings = halvings.checked_sub(1)?;
        let middle = f64::midpoint(from, to);
        let lower_bound = self.query(&motion.pose(middle), line);
        let [before, after] = [
            Span {
                times: [from, middle],
                lower_bounds: [first, lower_bound],
                max_travel: 0.5 * max_travel,
            },
            Span {
                times: [middle, to],
                lower_bounds: [lower_bound, last],
                max_travel: 0.5 * max_travel,
            },
        ];
        let before = self.span(motion, before, (line, halvings))?;
        Some(before.min(self.span(motion, after, (line, halvings))?))
    }
}

/// A span of a motion, with lower bounds on the distance at its ends and an upper bound on the travel of any
/// point of the tool.
#[derive(Clone, Copy)]
struct Span {
    times: [f64; 2],
    lower_bounds: [f64; 2],
    max_travel: f64,
}
