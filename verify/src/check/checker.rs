//! The check of motions one after another.

use super::moves::{JointTrajectory, Move, MovePath, RapidBox, displacement};
use super::{Finding, FindingKind, Verifier, VerifyError};
use std::collections::VecDeque;
use std::sync::Arc;
use touchoff::certify::{
    Certifier, MIN_SWEEP_ERRORS, MotionDepth, MotionVerdict, THROUGH_FRACTION, Trajectory,
};
use touchoff::tool::Symmetry;
use touchoff::{Interval, Motion, MotionError, Pose, SurfaceId};

/// Checks motions one after another.
pub(super) struct Checker<'a> {
    verifier: &'a Verifier<'a>,
    /// The certifiers for feed and for rapid traverse, in this order.
    modes: [Mode<'a>; 2],
    /// The greatest possible depth of each surface.
    max_depths: Arc<[f64]>,
    free_space: FreeSpace<'a>,
    /// For boxes of rapid traverse: certifiers whose surfaces keep a distance more than their margins.
    distant: Vec<Distant<'a>>,
}

/// A certifier whose surfaces keep a distance more than their margins in rapid traverse.
struct Distant<'a> {
    distance: f64,
    certifier: Certifier<'a>,
}

/// A certifier with the allowances of feed or of rapid traverse.
struct Mode<'a> {
    certifier: Certifier<'a>,
    limits: Vec<f64>,
    /// The largest margin of any surface.
    margin: f64,
}

/// A finding at a time of its motion, from 0 to 1.
struct TimedFinding {
    time: f64,
    kind: FindingKind,
}

/// Largest number of pieces of a box that are halved.
const MAX_PIECES: usize = 1 << 14;

impl<'a> Checker<'a> {
    pub(super) fn new(
        verifier: &'a Verifier<'a>,
        max_depths: Arc<[f64]>,
    ) -> Result<Checker<'a>, VerifyError> {
        let certifier = Certifier::new(verifier.bvh, verifier.tool)?.with_budget(verifier.budget);
        let free_space = FreeSpace {
            certifier,
            has_inside: verifier.bvh.has_inside(),
            reach: verifier.reach(),
            symmetry: verifier.tool.info().symmetry,
            ball: None,
            misses: 0,
            wait: 0,
        };
        Ok(Checker {
            verifier,
            modes: [Mode::new(verifier, false)?, Mode::new(verifier, true)?],
            max_depths,
            free_space,
            distant: Vec::new(),
        })
    }

    /// Forgets the motions before: equal motions after it have equal findings.
    pub(super) fn clear_caches(&mut self) {
        self.modes.iter_mut().for_each(|mode| mode.certifier.clear_caches());
        self.distant.iter_mut().for_each(|distant| distant.certifier.clear_caches());
        self.free_space.clear();
    }

    /// Returns the findings of a motion, `index` being its number in the program.
    pub(super) fn check(&mut self, index: usize, step: &Move) -> Vec<Finding> {
        let mut found = Vec::new();
        let finding = |time, pose, kind| Finding {
            location: index,
            line: step.line,
            within: step.within,
            from: step.from,
            rapid: step.rapid,
            time,
            pose,
            any_rates: false,
            kind,
        };
        match &step.path {
            MovePath::Straight(motion) => {
                if !self.is_free(step) {
                    found = self.contacts(step.rapid, motion, self.verifier.resolution);
                }
            }
            MovePath::Joints(path) => {
                if !self.is_free(step) {
                    let FreeSpace { reach, symmetry, .. } = self.free_space;
                    let trajectory = JointTrajectory::new(path, symmetry, reach);
                    found = self.contacts(step.rapid, &trajectory, self.verifier.resolution);
                    // An excess of depth up to so many errors of the path need not be found.
                    let missed = MIN_SWEEP_ERRORS * trajectory.error() * self.verifier.lipschitz();
                    if found.is_empty() && missed > self.verifier.resolution {
                        let undecided = self.undecided();
                        found = undecided.map(|kind| TimedFinding { time: 0.5, kind }).collect();
                    }
                }
            }
            MovePath::Box(path) => match Motion::with_spin(&path.pose(0.0), &path.pose(1.0)) {
                Ok(straight) => {
                    found = self.contacts(true, &straight, self.verifier.resolution);
                    // No pose of the box is farther from the straight line than from its middle.
                    let spread = path.radius() * self.verifier.lipschitz();
                    found.iter_mut().for_each(|found| widen(&mut found.kind, spread));
                    // A finding on the straight line is one at some rates already: the box is searched if there is none.
                    if found.is_empty() {
                        let found = self.rapid_box(path).into_iter().map(|(pose, kind)| Finding {
                            any_rates: true,
                            ..finding(0.5, pose, kind)
                        });
                        return found.collect();
                    }
                }
                Err(error) => found.push(TimedFinding::ambiguous(error)),
            },
            MovePath::Ambiguous(error, rest) => {
                found.push(TimedFinding::ambiguous(*error));
                let at_end = self.contacts(step.rapid, rest, self.verifier.resolution).into_iter();
                found.extend(at_end.map(|found| TimedFinding { time: 1.0, ..found }));
            }
        }
        let at = |TimedFinding { time, kind }| finding(time, step.path.pose(time), kind);
        found.into_iter().map(at).collect()
    }

    /// Returns the findings of rapid traverse through any poses of a box, each with its pose.
    ///
    /// The box is divided across all ways but its longest, until each piece is proved: around the pose in its middle the tool is in free
    /// space, or along the longest way, through the middle of the others, every surface keeps its margin and the distance from there to
    /// any pose of the piece; or its depth on that line exceeds what is allowed by no more than half of the resolution, and changes by no
    /// more than the other half up to any pose of the piece. It ends at a line with a finding. A box that would need more than
    /// [`MAX_PIECES`] is undecided.
    fn rapid_box(&mut self, path: &RapidBox) -> Vec<(Pose, FindingKind)> {
        let margin = self.modes[1].margin;
        let lipschitz = self.verifier.lipschitz();
        let half = 0.5 * self.verifier.resolution;
        // On the way from the middle, a point may become another surface's, of which less is allowed.
        let depths = self.modes[1].limits.iter().map(|limit| limit.max(0.0));
        let max_limit = depths.clone().fold(0.0, f64::max);
        let difference = max_limit - depths.fold(f64::INFINITY, f64::min);
        let mut open = VecDeque::from([path.clone()]);
        let mut count = 0;
        while let Some(piece) = open.pop_front() {
            let middle = piece.pose(0.5);
            // Every pose is within the radius of the middle; its coordinates are rounded.
            let size = middle.tip().coords.norm() + 2.0 * piece.radius();
            let rounding = 16.0 * f64::EPSILON * size;
            // A piece that is free needs no halving, so the query is worth its price here.
            self.free_space.wait = 0;
            if self.free_space.contains([middle, middle], piece.radius() + rounding, margin) {
                continue;
            }
            let [from, to] = piece.longest_line();
            let across = piece.radius_across() + rounding;
            let line = match Motion::with_spin(&from, &to) {
                Ok(line) => line,
                Err(error) => return vec![(middle, TimedFinding::ambiguous(error).kind)],
            };
            if self.keeps_away(&line, across) {
                continue;
            }
            let found = self.contacts(true, &line, half);
            if !found.is_empty() {
                // No pose of the box is farther from a line in it than its diagonal.
                let spread = 2.0 * path.radius() * lipschitz;
                let over_box = found.into_iter().map(|mut found| {
                    widen(&mut found.kind, spread);
                    (line.pose(found.time), found.kind)
                });
                return over_box.collect();
            }
            if piece.radius_across() == 0.0 || across * lipschitz + difference <= half {
                continue;
            }
            count += 1;
            if count > MAX_PIECES {
                return self.undecided().map(|kind| (middle, kind)).collect();
            }
            open.extend(piece.halves_across());
        }
        Vec::new()
    }

    /// Returns whether along a motion every surface is proved to keep its margin for rapid traverse and a distance more.
    fn keeps_away(&mut self, motion: &Motion, distance: f64) -> bool {
        // A motion is certainly nearer than a margin from this on. Certifiers are kept by the power of two up to which they serve.
        let least = self.modes[1].certifier.least_motion_tolerance();
        let exponent = (distance + least).log2().ceil();
        let kept = f64::exp2(exponent);
        if !kept.is_finite() || kept < f64::MIN_POSITIVE {
            return false;
        }
        let index = match self.distant.iter().position(|distant| distant.distance == kept) {
            Some(index) => index,
            None => {
                let limits = self.modes[1].limits.iter();
                let limits = limits.map(|limit| match *limit == f64::INFINITY {
                    true => f64::INFINITY,
                    false => limit.min(0.0) - kept,
                });
                let surfaces = self.verifier.tool.info().surfaces.iter().zip(limits);
                let certifier = Certifier::new(self.verifier.bvh, self.verifier.tool)
                    .expect("it was created for the modes before")
                    .with_budget(self.verifier.budget)
                    .with_allowances(surfaces.map(|(surface, limit)| (&*surface.name, limit)));
                let Ok(certifier) = certifier else { return false };
                self.distant.push(Distant { distance: kept, certifier });
                self.distant.len() - 1
            }
        };
        let verdict = self.distant[index].certifier.check_motion(motion, 0.0);
        matches!(verdict, MotionVerdict::Clear | MotionVerdict::SurfaceOnly)
    }

    /// Returns whether a motion is proved to stay in free space.
    fn is_free(&mut self, step: &Move) -> bool {
        let margin = self.modes[usize::from(step.rapid)].margin;
        let max_travel = step.path.max_travel(self.free_space.reach, self.free_space.symmetry);
        let poses = [0.0, 0.5].map(|at| step.path.pose(at));
        self.free_space.contains(poses, max_travel, margin)
    }

    /// Returns the findings of a motion near the part.
    fn contacts(
        &mut self,
        rapid: bool,
        motion: &dyn Trajectory,
        resolution: f64,
    ) -> Vec<TimedFinding> {
        self.modes[usize::from(rapid)].contacts(motion, &self.max_depths, resolution)
    }

    /// Returns the findings where nothing is known about any surface.
    fn undecided(&self) -> impl Iterator<Item = FindingKind> + use<> {
        let surfaces = (0..self.verifier.allowed.len()).map(SurfaceId);
        surfaces.map(|surface| FindingKind::Undecided { surface })
    }
}

impl TimedFinding {
    /// Returns the finding of a motion whose rotation is ambiguous, of which only the end is known.
    fn ambiguous(error: MotionError) -> TimedFinding {
        TimedFinding { time: 1.0, kind: FindingKind::Ambiguous(error) }
    }
}

/// Extends the bound of a finding to poses at which depths and distances differ by as much.
fn widen(kind: &mut FindingKind, spread: f64) {
    match kind {
        FindingKind::Deep { max_depth, .. } => *max_depth += spread,
        FindingKind::Near { min_distance, .. } => *min_distance = (*min_distance - spread).max(0.0),
        FindingKind::Inside { .. } | FindingKind::Undecided { .. } | FindingKind::Ambiguous(_) => {}
    }
}

impl<'a> Mode<'a> {
    fn new(verifier: &Verifier<'a>, rapid: bool) -> Result<Mode<'a>, VerifyError> {
        let limits = verifier.limits(rapid);
        let surfaces = verifier.tool.info().surfaces.iter().zip(&limits);
        let certifier =
            Certifier::new(verifier.bvh, verifier.tool)?
                .with_budget(verifier.budget)
                .with_allowances(surfaces.map(|(surface, limit)| (&*surface.name, *limit)))?;
        let margin = limits.iter().fold(0.0f64, |margin, limit| margin.max(-limit));
        Ok(Mode { certifier, limits, margin })
    }

    /// Returns the findings of a motion. `max_depths` has the greatest possible depth of each surface.
    fn contacts(
        &mut self,
        motion: &dyn Trajectory,
        max_depths: &[f64],
        resolution: f64,
    ) -> Vec<TimedFinding> {
        // One query for all surfaces proves most motions clear. Only the others are queried surface by surface.
        let swept = self.certifier.check_motion(motion, resolution);
        if matches!(swept, MotionVerdict::Clear | MotionVerdict::SurfaceOnly) {
            return Vec::new();
        }
        let mut found = Vec::new();
        let mut inside = Vec::new();
        for (index, allowed) in self.limits.iter().copied().enumerate() {
            if allowed == f64::INFINITY {
                continue;
            }
            let surface = SurfaceId(index);
            let depth = self.certifier.motion_depth(surface, motion, allowed, resolution);
            let (time, kind) = match depth.expect("a surface of the tool") {
                MotionDepth::Within => continue,
                MotionDepth::Deeper { at, depth: Interval { low, high }, max_depth, witness }
                    if low < 0.0 =>
                {
                    // Below 0 a depth is a distance: the nearest place is the deepest one.
                    let [from, to, min_distance] =
                        [-high, -low, -max_depth].map(|distance| distance.max(0.0));
                    let (margin, distance) = (-allowed, Interval::new(from, to));
                    (at, FindingKind::Near { surface, margin, distance, min_distance, witness })
                }
                MotionDepth::Deeper { at, depth, max_depth, witness } => {
                    let through = depth.low >= THROUGH_FRACTION * max_depths[index];
                    (at, FindingKind::Deep { surface, allowed, depth, max_depth, through, witness })
                }
                MotionDepth::Inside => {
                    inside.push(surface);
                    continue;
                }
                MotionDepth::Undecided(at) => (at, FindingKind::Undecided { surface }),
            };
            found.push(TimedFinding { time, kind });
        }
        if let (MotionVerdict::Inside(surface), []) = (swept, &inside[..]) {
            inside.push(surface);
        }
        // A tool that is buried as a whole is one finding, not one per surface.
        if !inside.is_empty() && self.certifier.is_buried(&motion.pose(0.0)) == Some(true) {
            found.push(TimedFinding { time: 0.0, kind: FindingKind::Inside { surface: None } });
        } else {
            found.extend(inside.into_iter().map(|surface| TimedFinding {
                time: 0.0,
                kind: FindingKind::Inside { surface: Some(surface) },
            }));
        }
        found
    }
}

/// A pose at which the whole tool is proved to be outside the material, and its distance from all triangles. A motion
/// that travels less from there touches nothing.
struct FreeSpace<'a> {
    certifier: Certifier<'a>,
    has_inside: bool,
    reach: f64,
    symmetry: Symmetry,
    ball: Option<(Pose, f64)>,
    /// Queries that have failed in a row, and motions to wait until the next one.
    misses: u32,
    wait: u32,
}

/// Largest number of motions after which the distance is queried again. Motions in contact would pay for queries in vain.
const MAX_WAIT: u32 = 15;

impl FreeSpace<'_> {
    /// Forgets the known free space.
    fn clear(&mut self) {
        self.certifier.clear_caches();
        (self.ball, self.misses, self.wait) = (None, 0, 0);
    }

    /// Returns whether a motion is proved to keep more than a margin from all triangles, outside the material. It has a
    /// pose at its start and in its middle, and no point of the tool travels farther than `max_travel`.
    fn contains(&mut self, [start, middle]: [Pose; 2], max_travel: f64, margin: f64) -> bool {
        if self.is_within(&start, max_travel + margin) {
            return true;
        }
        if self.wait > 0 {
            self.wait -= 1;
            return false;
        }
        let needed = max_travel + margin;
        // An ambiguous motion may travel any distance, of which no clearance is proved.
        let distance = if needed.is_finite() {
            self.certifier.clearance(&middle, 0.25 * needed).distance.low
        } else {
            0.0
        };
        // A tool that is far from all triangles may be buried in the material, but not within the free space of before.
        if distance > needed
            && (self.is_within(&middle, 0.0)
                || !self.has_inside
                || self.certifier.is_buried(&middle) == Some(false))
        {
            self.ball = Some((middle, distance));
            self.misses = 0;
        } else {
            self.misses += 1;
            // Motions in contact follow each other, so each miss in a row doubles the wait.
            self.wait = MAX_WAIT.min(1 << self.misses.min(4)) - 1;
        }
        self.is_within(&middle, needed)
    }

    /// Returns whether every point of the tool stays within the known free space at a pose and during any travel of
    /// this length from it.
    fn is_within(&self, pose: &Pose, travel: f64) -> bool {
        let Some((known, distance)) = &self.ball else { return false };
        let far = displacement(known, pose, self.reach, self.symmetry) + travel;
        // Covers the rounding of the displacement, whose terms are differences of coordinates.
        let size = pose.tip().coords.norm() + known.tip().coords.norm() + self.reach + far;
        far + 16.0 * f64::EPSILON * size < *distance
    }
}
