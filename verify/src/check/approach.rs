//! Closest approach of a program to the part. A program for another location or in another unit gouges nothing,
//! but stays far from the part.

use super::moves::{self, Move, MovePath, RapidBox};
use super::{Finding, FindingKind, Verifier, VerifyError};
use crate::gcode::WorkOffset;
use nalgebra::Point3;
use touchoff::certify::Certifier;
use touchoff::tool::Symmetry;
use touchoff::{Interval, Pose};

/// Location of a program relative to the part. Lengths are in the part's unit, points in its frame.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Approach {
    /// Lowest and highest corner of the part's bounding box.
    pub part: [Point3<f64>; 2],
    /// Lowest and highest corner of the bounding box of all tips at the ends of motions.
    pub program: [Point3<f64>; 2],
    /// Length that the tip travels in feed and in rapid traverse. Curved paths are measured along 16 chords.
    pub travel: [f64; 2],
    /// Lowest and highest corner of the bounding box of the tips at the ends of motions in feed, if there are a few of them, without those
    /// for other parts.
    pub feed: Option<[Point3<f64>; 2]>,
    /// Upper bound on the least distance between the tool and a triangle of the part; 0 if they are found to touch. It is
    /// that of the nearest end of a motion or finding: along a motion it may be less. Infinite for a tool without a profile
    /// that is not found to touch: its distances have no upper bound.
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
    /// Returns the factor by which all positions in feed would fit into the part's box much better than they do: a sign that the program or
    /// the part is in another unit.
    pub fn unit_factor(&self) -> Option<f64> {
        Approach::unit_factor_of(std::slice::from_ref(self))
    }

    /// Returns that factor for the tools of a program together, at one part.
    pub fn unit_factor_of<'a>(tools: impl IntoIterator<Item = &'a Approach>) -> Option<f64> {
        let found =
            tools.into_iter().filter_map(|tool| Some((tool.part, tool.feed?, tool.diameter)));
        let whole =
            found.reduce(|(part, [low, high], wide), (_, [other_low, other_high], other)| {
                (part, [low.inf(&other_low), high.sup(&other_high)], wide.max(other))
            });
        whole.and_then(|(part, feed, diameter)| unit_factor(part, feed, diameter))
    }

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

/// The search for the closest approach, over motions that are added in order.
pub(crate) struct ApproachSearch<'a> {
    verifier: &'a Verifier<'a>,
    certifier: Certifier<'a>,
    /// Upper bound on the distance of the tool's points from its tip, in the part's unit: their travel per radian.
    reach: f64,
    symmetry: Symmetry,
    diameter: f64,
    /// The least distance so far.
    distance: f64,
    /// False if that is only a lower bound, of a tool without a profile.
    is_measured: bool,
    /// The line of that distance.
    line: usize,
    /// A lower bound on the distance over all motions so far; `None` if one comes, or may come, as near as the diameter.
    clearance: Option<f64>,
    /// The box of all tips, and of those that are reached in feed.
    tips: [Option<[Point3<f64>; 2]>; 2],
    travel: [f64; 2],
    /// Number of motions in feed.
    feeds: usize,
    /// Work offsets at which other parts stand.
    pub(super) other_parts: Vec<WorkOffset>,
    /// The last pose, with a lower bound on its distance.
    last: Option<(f64, Pose)>,
}

impl<'a> ApproachSearch<'a> {
    pub(crate) fn new(verifier: &'a Verifier<'a>) -> Result<ApproachSearch<'a>, VerifyError> {
        let info = verifier.tool.info();
        let cutting = info.outline.iter().filter(|segment| info.surface(segment.surface).cutting);
        let widest = cutting.map(|segment| {
            // A convex arc may be wider than its ends.
            let bulge = segment.circle.filter(|circle| circle.convex);
            let bulge = bulge.map_or(0.0, |circle| circle.centre[0] + circle.radius);
            segment.from[0].max(segment.to[0]).max(bulge)
        });
        let radius = widest.fold(0.0, f64::max);
        let radius = if radius > 0.0 { radius } else { info.radius() };
        Ok(ApproachSearch {
            certifier: Certifier::new(verifier.bvh, verifier.tool)?.with_budget(verifier.budget),
            reach: verifier.reach(),
            symmetry: info.symmetry,
            diameter: 2.0 * radius * info.unit.factor_to(verifier.bvh.unit()),
            distance: f64::INFINITY,
            is_measured: false,
            line: 0,
            clearance: Some(f64::INFINITY),
            tips: [None; 2],
            travel: [0.0; 2],
            feeds: 0,
            other_parts: Vec::new(),
            last: None,
            verifier,
        })
    }

    /// Adds motions with their findings.
    pub(crate) fn add(&mut self, moves: &[Move], findings: &[Finding]) {
        for step in moves.iter().filter(|step| !step.alternative) {
            self.travel[usize::from(step.rapid)] += path_length(&step.path);
            self.feeds += usize::from(!step.rapid);
        }
        let is_elsewhere =
            |step: &Move| step.work_offset.is_some_and(|offset| self.other_parts.contains(&offset));
        for (feed_only, tips) in [false, true].into_iter().zip(&mut self.tips) {
            let ends =
                moves.iter().filter(|step| !(feed_only && (step.rapid || is_elsewhere(step))));
            let ends = ends.map(|step| step.path.pose(1.0).tip());
            for tip in ends {
                let [low, high] = tips.unwrap_or([tip; 2]);
                *tips = Some([low.inf(&tip), high.sup(&tip)]);
            }
        }
        if self.line == 0 {
            self.line = moves.first().map_or(0, |step| step.line);
        }
        for found in findings {
            match found.kind {
                FindingKind::Deep { .. } | FindingKind::Inside { .. } => {
                    self.come(0.0, found.line);
                    self.clearance = None;
                }
                FindingKind::Near { distance, .. } => self.come(distance.high, found.line),
                FindingKind::Undecided { .. } | FindingKind::Ambiguous(_) => {}
            }
        }
        for step in moves {
            // No motion comes nearer than one that touches.
            if self.distance == 0.0 {
                return;
            }
            self.add_move(step);
        }
    }

    /// Takes a distance at which the tool is, if none before is as small.
    fn come(&mut self, distance: f64, line: usize) {
        if distance < self.distance || (distance == self.distance && !self.is_measured) {
            (self.distance, self.is_measured, self.line) = (distance, true, line);
        }
    }

    fn add_move(&mut self, step: &Move) {
        let max_travel = step.path.max_travel(self.reach, self.symmetry);
        let end = step.path.pose(1.0);
        // A position by itself is not reached from the last one.
        let last = self.last.filter(|_| step.from.is_some());
        let bound =
            last.map_or(0.0, |(low, _)| low - max_travel - 4.0 * f64::EPSILON * (low + max_travel));
        // A motion that cannot come nearer than the nearest so far needs no query.
        let bound = if bound > self.distance { bound } else { self.query(&end, step.line) };
        if let Some(clearance) = self.clearance {
            let over_motion = match (&step.path, last) {
                // An ambiguous motion is a finding; only its end is checked.
                (MovePath::Ambiguous(..), _) => Some(bound),
                (MovePath::Box(path), _) => self.around(path, step.line, MAX_HALVINGS),
                (_, None) => Some(bound),
                (path, Some((first, _))) => {
                    let span = Span { times: [0.0, 1.0], lower_bounds: [first, bound], max_travel };
                    self.span(path, span, step.line, MAX_HALVINGS)
                }
            };
            let clearance = over_motion.map(|bound| bound.min(clearance));
            self.clearance = clearance.filter(|bound| *bound > self.diameter);
        }
        self.last = Some((bound, end));
    }

    /// Returns a lower bound on the distance over a box of poses, as [`ApproachSearch::span`] does.
    fn around(&mut self, path: &RapidBox, line: usize, halvings: u32) -> Option<f64> {
        let middle = path.pose(0.5);
        let low = self.query(&middle, line);
        let size = middle.tip().coords.norm() + path.radius() + low;
        let bound = low - path.radius() - 8.0 * f64::EPSILON * size;
        if bound >= (1.0 - TOLERANCE_FRACTION) * self.distance && bound > self.diameter {
            return Some(bound);
        }
        if self.distance <= self.diameter {
            return None;
        }
        let halvings = halvings.checked_sub(1)?;
        let [one, other] = path.halves();
        let one = self.around(&one, line, halvings)?;
        Some(one.min(self.around(&other, line, halvings)?))
    }

    /// Returns the closest approach of the motions that were added.
    pub(crate) fn finish(self) -> Approach {
        let part = self.verifier.bvh.bounds();
        let [all, feed] = self.tips;
        let feed = feed.filter(|_| self.feeds >= MIN_FEEDS);
        Approach {
            part,
            program: all.unwrap_or([Point3::origin(); 2]),
            travel: self.travel,
            feed,
            distance: if self.is_measured { self.distance } else { f64::INFINITY },
            line: self.line,
            diameter: self.diameter,
            proved_clearance: self.clearance.filter(|bound| bound.is_finite()),
        }
    }

    /// Queries the distance at a pose, and returns a lower bound on it.
    fn query(&mut self, pose: &Pose, line: usize) -> f64 {
        let tolerance = TOLERANCE_FRACTION * self.diameter;
        let Interval { mut low, high } = self.certifier.clearance(pose, tolerance).distance;
        if high < f64::INFINITY {
            self.come(high, line);
            return low;
        }
        // A tool without a profile has no upper bound on its distance. A lower bound of 0 is refined.
        if low == 0.0 {
            let finer = TOLERANCE_FRACTION * TOLERANCE_FRACTION * tolerance;
            Interval { low, .. } = self.certifier.clearance(pose, finer).distance;
        }
        if low < self.distance {
            (self.distance, self.is_measured, self.line) = (low, false, line);
        }
        low
    }

    /// Returns a lower bound on the distance over a span of a motion, above the tool's diameter and within a fraction
    /// of the least distance; `None` if that is not proved.
    fn span(&mut self, path: &MovePath, span: Span, line: usize, halvings: u32) -> Option<f64> {
        let Span { times: [from, to], lower_bounds: [first, last], max_travel } = span;
        // At any time the distance is at least that at either end, less the travel from there.
        let rounding = 4.0 * f64::EPSILON * (first.abs() + last.abs() + max_travel);
        let bound = 0.5 * (first + last - max_travel) - rounding;
        if bound >= (1.0 - TOLERANCE_FRACTION) * self.distance && bound > self.diameter {
            return Some(bound);
        }
        if self.distance <= self.diameter {
            return None;
        }
        let halvings = halvings.checked_sub(1)?;
        let middle = f64::midpoint(from, to);
        let lower_bound = self.query(&path.pose(middle), line);
        let travels = match path {
            MovePath::Joints(joints) => [[from, middle], [middle, to]]
                .map(|times| moves::span(joints, times, self.reach, self.symmetry).max_travel),
            MovePath::Straight(_) | MovePath::Box(_) | MovePath::Ambiguous(..) => {
                [0.5 * max_travel; 2]
            }
        };
        let before = Span {
            times: [from, middle],
            lower_bounds: [first, lower_bound],
            max_travel: travels[0],
        };
        let after =
            Span { times: [middle, to], lower_bounds: [lower_bound, last], max_travel: travels[1] };
        let before = self.span(path, before, line, halvings)?;
        Some(before.min(self.span(path, after, line, halvings)?))
    }
}

/// Number of chords that measure a curved path.
const CHORDS: u32 = 16;

/// Returns the length of the tip's path, along chords where it is curved.
fn path_length(path: &MovePath) -> f64 {
    match path {
        MovePath::Straight(motion) | MovePath::Ambiguous(_, motion) => motion.displacement().norm(),
        MovePath::Box(path) => 2.0 * path.radius(),
        MovePath::Joints(joints) => {
            let tips = (0..=CHORDS).map(|k| joints.pose(f64::from(k) / f64::from(CHORDS)).tip());
            let tips: Vec<Point3<f64>> = tips.collect();
            tips.windows(2).map(|ends| (ends[1] - ends[0]).norm()).sum()
        }
    }
}

/// Factors between units that are taken for each other: inch and millimetre, metre and millimetre.
const UNIT_FACTORS: [f64; 4] = [25.4, 1.0 / 25.4, 1000.0, 1e-3];

/// Fewer motions in feed than this say nothing about their unit.
const MIN_FEEDS: usize = 4;

/// A box that fits after a change of unit fills at least this fraction of the part's largest extent.
const FILLED_FRACTION: f64 = 0.25;

fn extent([low, high]: [Point3<f64>; 2]) -> f64 {
    (high - low).max()
}

/// Returns the factor of a unit by which a box of positions fits into the part's box widened by the tool's diameter, if
/// it does not fit without.
fn unit_factor(part: [Point3<f64>; 2], feed: [Point3<f64>; 2], diameter: f64) -> Option<f64> {
    let fits = |factor: f64| {
        let [low, high] = feed.map(|corner| corner * factor);
        let margin = diameter.max(0.1 * extent(part));
        (0..3).all(|k| low[k] >= part[0][k] - margin && high[k] <= part[1][k] + margin)
            && extent([low, high]) >= FILLED_FRACTION * extent(part)
    };
    let is_plain = fits(1.0) || {
        // A small or a large program of the right unit overlaps with the part's box in every coordinate.
        (0..3).all(|k| feed[0][k] <= part[1][k] + diameter && feed[1][k] >= part[0][k] - diameter)
            && extent(feed) <= extent(part) + 4.0 * diameter
            && extent(feed) >= 0.1 * extent(part)
    };
    UNIT_FACTORS.into_iter().find(|factor| !is_plain && fits(*factor))
}

/// A span of a motion, with lower bounds on the distance at its ends and an upper bound on the travel of any
/// point of the tool.
#[derive(Clone, Copy)]
struct Span {
    times: [f64; 2],
    lower_bounds: [f64; 2],
    pub(super) max_travel: f64,
}
