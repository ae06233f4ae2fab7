//! How near a program comes to the part: a program that was meant for another place, or another unit,
//! gouges nothing.

use super::{Finding, Kind, Verifier, VerifyError};
use crate::certify::Certifier;
use crate::mesh;
use crate::motion::Motion;
use crate::pose::Pose;
use crate::program::Stop;
use crate::tool::Piece;
use nalgebra::Point3;

/// Where a program goes beside where the part is. Lengths are in the part's unit, places in its frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Approach {
    /// The lowest and the highest corner of the box about the part.
    pub part: [Point3<f64>; 2],
    /// The same about the tips of all positions.
    pub program: [Point3<f64>; 2],
    /// The tool comes at least this near to a triangle of the part; 0 if it touches.
    pub distance: f64,
    /// The line of the position where it does, or of the position that the motion ends at.
    pub line: usize,
    /// The diameter of what cuts, or of the tool if nothing does.
    pub diameter: f64,
    /// If no motion comes as near as the diameter: what all of the tool is proved to keep from all triangles, on
    /// every motion.
    pub keeps: Option<f64>,
}

impl Approach {
    /// Returns whether the tool stays farther from the part than its diameter on all motions, so that the
    /// program is hardly meant for this part at this place.
    pub fn is_far(&self) -> bool {
        self.keeps.is_some()
    }
}

/// Distances are told to this part of the tool's diameter, and what is kept to this part of the distance.
const FINE: f64 = 1.0 / 64.0;

/// How often a motion is halved at most. What is left open then counts as near.
const HALVINGS: u32 = 40;

impl Verifier<'_> {
    /// Computes how near the stops come to the part, given what was found of them.
    pub(super) fn approach(
        &self,
        stops: &[Stop],
        findings: &[Finding],
    ) -> Result<Approach, VerifyError> {
        let card = self.tool.card();
        let length = card.unit.to(self.facets.unit());
        let cutting = card.outline.iter().filter(|piece| card.surfaces[piece.surface].cutting);
        let widest = |piece: &Piece| {
            let bulge = piece.circle.filter(|circle| circle.convex);
            let bulge = bulge.map_or(0.0, |circle| circle.centre[0] + circle.radius);
            piece.from[0].max(piece.to[0]).max(bulge)
        };
        let radius = cutting.map(widest).fold(0.0, f64::max);
        let radius = if radius > 0.0 { radius } else { card.radius() };
        let diameter = 2.0 * radius * length;
        let mut search = Search {
            of: self,
            certifier: Certifier::new(self.facets, self.tool)?.budget(self.budget),
            reach: card.size() * length,
            fine: FINE * diameter,
            distance: f64::INFINITY,
            line: stops.first().map_or(0, |stop| stop.line),
        };
        let touching = findings
            .iter()
            .find(|found| matches!(found.kind, Kind::Deep { .. } | Kind::Inside { .. }));
        let mut keeps = None;
        if let Some(found) = touching {
            (search.distance, search.line) = (0.0, found.line);
        } else {
            let least = search.positions(stops);
            if search.distance > diameter {
                keeps = search.motions(stops, &least).filter(|kept| *kept > diameter);
            }
        }
        let Search { distance, line, .. } = search;
        let tips = stops.iter().map(|stop| stop.pose.tip());
        Ok(Approach {
            part: self.facets.bounds(),
            program: mesh::bounds(tips),
            distance,
            line,
            diameter,
            keeps,
        })
    }
}

/// The search for where the tool is nearest.
struct Search<'a> {
    of: &'a Verifier<'a>,
    certifier: Certifier<'a>,
    /// How far the tool reaches from its tip.
    reach: f64,
    fine: f64,
    /// The nearest so far, and its line.
    distance: f64,
    line: usize,
}

impl Search<'_> {
    /// Returns how far any point of the tool goes at most from one pose to another.
    fn travel(&self, from: &Pose, to: &Pose) -> f64 {
        match self.of.motion(from, to) {
            Ok(motion) => motion.way().norm() + motion.angle() * self.reach,
            Err(_) => f64::INFINITY,
        }
    }

    /// Asks at a pose: no triangle is nearer than what is returned.
    fn ask(&mut self, pose: &Pose, line: usize) -> f64 {
        let [mut low, mut high] = self.certifier.clearance(pose, self.fine).distance;
        if high == f64::INFINITY {
            // A field has no upper bound of the distance: a lower one of 0 is looked at more closely.
            if low == 0.0 {
                [low, _] = self.certifier.clearance(pose, FINE * FINE * self.fine).distance;
            }
            high = low;
        }
        if high < self.distance {
            (self.distance, self.line) = (high, line);
        }
        low
    }

    /// Asks at the positions, but where the one before shows that none is nearer; of each, what it keeps at
    /// least. Ends where one touches.
    fn positions(&mut self, stops: &[Stop]) -> Vec<f64> {
        let mut least = Vec::with_capacity(stops.len());
        let mut before: Option<(f64, &Pose)> = None;
        for stop in stops {
            let kept = before.map_or(0.0, |(low, pose)| {
                let travel = self.travel(pose, &stop.pose);
                low - travel - 4.0 * f64::EPSILON * (low + travel)
            });
            let kept = if kept > self.distance { kept } else { self.ask(&stop.pose, stop.line) };
            least.push(kept);
            if self.distance == 0.0 {
                break;
            }
            before = Some((kept, &stop.pose));
        }
        least
    }

    /// Returns what all motions keep, to a part of the nearest distance; `None` if that is not shown.
    fn motions(&mut self, stops: &[Stop], least: &[f64]) -> Option<f64> {
        let mut kept = f64::INFINITY;
        for (pair, ends) in stops.windows(2).zip(least.windows(2)) {
            // Where a motion is not one, only its ends are checked, which is a finding.
            if let Ok(motion) = self.of.motion(&pair[0].pose, &pair[1].pose) {
                let travel = motion.way().norm() + motion.angle() * self.reach;
                let span = Span { times: [0.0, 1.0], least: [ends[0], ends[1]], travel };
                kept = kept.min(self.span(&motion, span, (pair[1].line, HALVINGS))?);
            }
        }
        let ends = least.iter().copied().fold(f64::INFINITY, f64::min);
        Some(kept.min(ends))
    }

    /// Returns what a span of a motion keeps.
    fn span(&mut self, motion: &Motion, span: Span, (line, halvings): (usize, u32)) -> Option<f64> {
        let Span { times: [from, to], least: [first, last], travel } = span;
        // A point that is `s` of the way from one end is no nearer than either end's distance less the way.
        let rounding = 4.0 * f64::EPSILON * (first.abs() + last.abs() + travel);
        let kept = 0.5 * (first + last - travel) - rounding;
        if kept >= (1.0 - FINE) * self.distance {
            return Some(kept);
        }
        let halvings = halvings.checked_sub(1)?;
        let middle = f64::midpoint(from, to);
        let least = self.ask(&motion.pose(middle), line);
        let [before, after] = [
            Span { times: [from, middle], least: [first, least], travel: 0.5 * travel },
            Span { times: [middle, to], least: [least, last], travel: 0.5 * travel },
        ];
        let before = self.span(motion, before, (line, halvings))?;
        Some(before.min(self.span(motion, after, (line, halvings))?))
    }
}

/// A span of a motion, what the tool keeps from the part at its ends at least, and how far any point of it
/// goes.
#[derive(Clone, Copy)]
struct Span {
    times: [f64; 2],
    least: [f64; 2],
    travel: f64,
}
