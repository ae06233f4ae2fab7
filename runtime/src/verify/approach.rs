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
const FINE: f64 = 1.0 / 64.0;

/// Largest number of halvings of a motion. If they do not decide, the tool counts as near.
const HALVINGS: u32 = 40;

impl Verifier<'_> {
    /// Computes the closest approach of the cutter locations to the part, given their findings.
    pub(super) fn approach(
        &self,
        stops: &[CutterLocation],
        findings: &[Finding],
    ) -> Result<Approach, VerifyError> {
        let info = self.tool.info();
        let length = info.unit.factor_to(self.bvh.unit());
        let cutting = info.outline.iter().filter(|piece| info.surface(piece.surface).cutting);
        let widest = |piece: &ProfileSegment| {
            let bulge = piece.circle.filter(|circle| circle.convex);
            let bulge = bulge.map_or(0.0, |circle| circle.centre[0] + circle.radius);
            piece.from[0].max(piece.to[0]).max(bulge)
        };
        let radius = cutting.map(widest).fold(0.0, f64::max);
        let radius = if radius > 0.0 { radius } else { info.radius() };
        let diameter = 2.0 * radius * length;
        let mut search = ApproachSearch {
            of: self,
            certifier: Certifier::new(self.bvh, self.tool)?.with_budget(self.budget),
            reach: max_distance_from_tip(info) * length,
            fine: FINE * diameter,
            distance: f64::INFINITY,
            line: stops.first().map_or(0, |stop| stop.line),
        };
        let touching = findings.iter().find(|found| {
            matches!(found.kind, FindingKind::Deep { .. } | FindingKind::Inside { .. })
        });
        let mut keeps = None;
        if let Some(found) = touching {
            (search.distance, search.line) = (0.0, found.line);
        } else {
            let least = search.location_bounds(stops);
            if search.distance > diameter {
                keeps = search.motions(stops, &least).filter(|kept| *kept > diameter);
            }
        }
        let ApproachSearch { distance, line, .. } = search;
        let tips = stops.iter().map(|stop| stop.pose.tip());
        Ok(Approach {
            part: self.bvh.bounds(),
            program: mesh::bounds(tips),
            distance,
            line,
            diameter,
            proved_clearance: keeps,
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
    of: &'a Verifier<'a>,
    certifier: Certifier<'a>,
    /// Upper bound on the distance of the tool's points from its tip, in the part's unit: their travel per radian.
    reach: f64,
    fine: f64,
    /// The least distance so far.
    distance: f64,
    /// The line of that distance.
    line: usize,
}

impl ApproachSearch<'_> {
    /// Returns an upper bound on the travel of any point of the tool from one pose to another.
    fn travel(&self, from: &Pose, to: &Pose) -> f64 {
        match self.of.motion(from, to) {
            Ok(motion) => motion.displacement().norm() + motion.angle() * self.reach,
            Err(_) => f64::INFINITY,
        }
    }

    /// Queries the distance at a pose, and returns a lower bound on it.
    fn query(&mut self, pose: &Pose, line: usize) -> f64 {
        let Interval { mut low, mut high } = self.certifier.clearance(pose, self.fine).distance;
        if high == f64::INFINITY {
            // A tool without a profile (a field) gives no upper bound on the distance. A lower bound of 0 is
            // refined.
            if low == 0.0 {
                Interval { low, .. } =
                    self.certifier.clearance(pose, FINE * FINE * self.fine).distance;
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
    fn location_bounds(&mut self, stops: &[CutterLocation]) -> Vec<f64> {
        let mut least = Vec::with_capacity(stops.len());
        let mut before: Option<(f64, &Pose)> = None;
        for stop in stops {
            let kept = before.map_or(0.0, |(low, pose)| {
                let travel = self.travel(pose, &stop.pose);
                low - travel - 4.0 * f64::EPSILON * (low + travel)
            });
            let kept = if kept > self.distance { kept } else { self.query(&stop.pose, stop.line) };
            least.push(kept);
            if self.distance == 0.0 {
                break;
            }
            before = Some((kept, &stop.pose));
        }
        least
    }

    /// Returns a lower bound on the distance over all motions, within a fraction of the least distance; `None`
    /// if that is not proved.
    fn motions(&mut self, stops: &[CutterLocation], least: &[f64]) -> Option<f64> {
        let mut kept = f64::INFINITY;
        for (pair, ends) in stops.windows(2).zip(least.windows(2)) {
            // An ambiguous motion is a finding; only its ends are checked.
            if let Ok(motion) = self.of.motion(&pair[0].pose, &pair[1].pose) {
                let travel = motion.displacement().norm() + motion.angle() * self.reach;
                let span = Span { times: [0.0, 1.0], least: [ends[0], ends[1]], travel };
                kept = kept.min(self.span(&motion, span, (pair[1].line, HALVINGS))?);
            }
        }
        let ends = least.iter().copied().fold(f64::INFINITY, f64::min);
        Some(kept.min(ends))
    }

    /// Returns a lower bound on the distance over a span of a motion; `None` if that is not proved.
    fn span(&mut self, motion: &Motion, span: Span, (line, halvings): (usize, u32)) -> Option<f64> {
        let Span { times: [from, to], least: [first, last], travel } = span;
        // At any time the distance is at least that at either end, less the travel from there.
        let rounding = 4.0 * f64::EPSILON * (first.abs() + last.abs() + travel);
        let kept = 0.5 * (first + last - travel) - rounding;
        if kept >= (1.0 - FINE) * self.distance {
            return Some(kept);
        }
        let halvings = halvings.checked_sub(1)?;
        let middle = f64::midpoint(from, to);
        let least = self.query(&motion.pose(middle), line);
        let [before, after] = [
            Span { times: [from, middle], least: [first, least], travel: 0.5 * travel },
            Span { times: [middle, to], least: [least, last], travel: 0.5 * travel },
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
    least: [f64; 2],
    travel: f64,
}
