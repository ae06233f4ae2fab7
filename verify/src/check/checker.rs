//! The check of motions one after another.

use super::moves::{self, JointPath, Move, MovePath, RapidBox, Span};
use super::{Finding, FindingKind, Verifier, VerifyError};
use std::cmp::Ordering;
use std::collections::VecDeque;
use std::mem;
use touchoff::certify::{Certifier, MotionDepth, MotionVerdict};
use touchoff::tool::Symmetry;
use touchoff::{Interval, Motion, Pose, SurfaceId};

/// Checks motions one after another.
pub(super) struct Checker<'a> {
    verifier: &'a Verifier<'a>,
    /// The certifiers for feed and for rapid traverse, in this order.
    modes: [Mode<'a>; 2],
    free_space: FreeSpace<'a>,
}

/// A certifier with the allowances of feed or of rapid traverse.
struct Mode<'a> {
    certifier: Certifier<'a>,
    limits: Vec<f64>,
    /// The greatest possible depth of each surface.
    max_depths: &'a [f64],
    /// The largest margin of any surface.
    margin: f64,
}

/// Fraction of a surface's greatest possible depth from which on it counts as passing right through the part.
const THROUGH_FRACTION: f64 = 0.98;

/// Share of the resolution that the approximation of a joint motion may use.
const DEVIATION_SHARE: f64 = 0.25;

/// Largest number of halvings of a joint motion. A span that is still too inaccurate is undecided.
const MAX_HALVINGS: u32 = 24;

/// Largest number of pieces of a box that are halved.
const MAX_PIECES: usize = 1 << 14;

impl<'a> Checker<'a> {
    pub(super) fn new(
        verifier: &'a Verifier<'a>,
        max_depths: &'a [f64],
    ) -> Result<Checker<'a>, VerifyError> {
        let mode = |rapid| {
            let limits = verifier.limits(rapid);
            let mut certifier =
                Certifier::new(verifier.bvh, verifier.tool)?.with_budget(verifier.budget);
            for (surface, limit) in verifier.tool.info().surfaces.iter().zip(&limits) {
                certifier = certifier.with_allowance(&surface.name, *limit)?;
            }
            let margin = limits.iter().fold(0.0f64, |margin, limit| margin.max(-limit));
            Ok::<_, VerifyError>(Mode { certifier, limits, max_depths, margin })
        };
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
        Ok(Checker { verifier, modes: [mode(false)?, mode(true)?], free_space })
    }

    /// Returns the findings of a motion, `index` being its number in the program.
    pub(super) fn check(&mut self, index: usize, step: &Move) -> Vec<Finding> {
        let mut found = Vec::new();
        let finding = |time, pose, kind, any_rates| Finding {
            location: index,
            line: step.line,
            from: step.from,
            rapid: step.rapid,
            time,
            pose,
            any_rates,
            kind,
        };
        match &step.path {
            MovePath::Straight(motion) => {
                let margin = self.modes[usize::from(step.rapid)].margin;
                let max_travel =
                    step.path.max_travel(self.free_space.reach, self.free_space.symmetry);
                let poses = [0.0, 0.5].map(|at| motion.pose(at));
                if !self.free_space.contains(poses, max_travel, margin) {
                    found = self.motion(step.rapid, motion);
                }
            }
            MovePath::Joints(joints) => {
                // A resolution below the part of the deviation that halving does not reduce is taken as that.
                let floor =
                    joints.deviation_floor(self.free_space.reach) * self.verifier.lipschitz();
                let resolution = self.verifier.resolution.max(2.0 * floor / DEVIATION_SHARE);
                let task = (step.rapid, resolution);
                self.joints(task, joints, ([0.0, 1.0], MAX_HALVINGS), &mut found);
            }
            MovePath::Box(path) => match Motion::with_spin(&path.pose(0.0), &path.pose(1.0)) {
                Ok(straight) => {
                    found = self.motion(true, &straight);
                    // No pose of the box is farther from the straight line than from its middle.
                    let spread = path.radius() * self.verifier.lipschitz();
                    found.iter_mut().for_each(|(_, kind)| widen(kind, spread));
                    if found.is_empty() {
                        let found = self.rapid_box(path).into_iter();
                        return found.map(|(pose, kind)| finding(0.5, pose, kind, true)).collect();
                    }
                }
                Err(error) => found.push((1.0, FindingKind::Ambiguous(error))),
            },
            MovePath::Ambiguous(error, rest) => {
                found.push((1.0, FindingKind::Ambiguous(*error)));
                found
                    .extend(self.motion(step.rapid, rest).into_iter().map(|(_, kind)| (1.0, kind)));
            }
        }
        let on_path = |(time, kind)| finding(time, step.path.pose(time), kind, false);
        found.into_iter().map(on_path).collect()
    }

    /// Returns the findings of rapid traverse through any poses of a box, each with its pose.
    ///
    /// The box is halved until each piece is proved: around the pose in its middle the tool is in free space, or no deeper
    /// than allowed by more than a pose in the piece is away from the middle. It ends at a pose in the middle of a piece
    /// that is a finding by itself. A piece that would need more than [`MAX_PIECES`] is undecided.
    fn rapid_box(&mut self, path: &RapidBox) -> Vec<(Pose, FindingKind)> {
        let margin = self.modes[1].margin;
        let lipschitz = self.verifier.lipschitz();
        let mut open = VecDeque::from([path.clone()]);
        let mut count = 0;
        while let Some(piece) = open.pop_front() {
            let middle = piece.pose(0.5);
            // Every pose is within the radius of the middle; its coordinates are rounded.
            let size = middle.tip().coords.norm() + 2.0 * piece.radius();
            let radius = piece.radius() + 16.0 * f64::EPSILON * size;
            self.free_space.wait = 0;
            if self.free_space.contains([middle, middle], radius, margin) {
                continue;
            }
            let found = match Motion::with_spin(&middle, &middle) {
                Ok(rest) => self.motion(true, &rest),
                Err(error) => vec![(0.5, FindingKind::Ambiguous(error))],
            };
            if !found.is_empty() {
                // No pose of the box is farther from the middle of a piece than the box's diagonal.
                let spread = 2.0 * path.radius() * lipschitz;
                let over_box = |(_, mut kind): (f64, FindingKind)| {
                    widen(&mut kind, spread);
                    (middle, kind)
                };
                return found.into_iter().map(over_box).collect();
            }
            if radius * lipschitz <= self.verifier.resolution {
                continue;
            }
            count += 1;
            if count > MAX_PIECES {
                let undecided = |k| (middle, FindingKind::Undecided { surface: SurfaceId(k) });
                return (0..self.verifier.allowed.len()).map(undecided).collect();
            }
            open.extend(piece.halves());
        }
        Vec::new()
    }

    fn motion(&mut self, rapid: bool, motion: &Motion) -> Vec<(f64, FindingKind)> {
        self.modes[usize::from(rapid)].motion(motion, self.verifier.resolution, 0.0)
    }

    /// Adds the findings of a span of a joint motion, the deepest per kind and surface.
    ///
    /// The span is halved until nothing is near it, or until the motion between its ends deviates so little that the
    /// deviation can be counted within the resolution. The task is the mode and the resolution.
    fn joints(
        &mut self,
        task @ (rapid, resolution): (bool, f64),
        joints: &JointPath,
        ([from, to], halvings): ([f64; 2], u32),
        found: &mut Vec<(f64, FindingKind)>,
    ) {
        let FreeSpace { reach, symmetry, .. } = self.free_space;
        let Span { motion, deviation, max_travel } =
            moves::span(joints, [from, to], reach, symmetry);
        let middle = f64::midpoint(from, to);
        let margin = self.modes[usize::from(rapid)].margin;
        let poses = [from, middle].map(|at| joints.pose(at));
        if self.free_space.contains(poses, max_travel, margin) {
            return;
        }
        let slack = deviation * self.verifier.lipschitz();
        match motion {
            Ok(motion) if slack <= DEVIATION_SHARE * resolution => {
                let mode = &mut self.modes[usize::from(rapid)];
                for (time, kind) in mode.motion(&motion, resolution, slack) {
                    merge(found, (from + time * (to - from), kind));
                }
            }
            _ if halvings == 0 => {
                let undecided = |k| (from, FindingKind::Undecided { surface: SurfaceId(k) });
                (0..self.verifier.allowed.len()).for_each(|k| merge(found, undecided(k)));
            }
            _ => {
                self.joints(task, joints, ([from, middle], halvings - 1), found);
                self.joints(task, joints, ([middle, to], halvings - 1), found);
            }
        }
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

/// Adds a finding, or keeps the worse one of the same kind and surface, with a bound over both.
fn merge(found: &mut Vec<(f64, FindingKind)>, mut new: (f64, FindingKind)) {
    let same = |(_, kind): &&mut (f64, FindingKind)| {
        mem::discriminant(kind) == mem::discriminant(&new.1) && kind.surface() == new.1.surface()
    };
    let Some(known) = found.iter_mut().find(same) else {
        found.push(new);
        return;
    };
    if new.1.severity(&known.1) == Ordering::Greater {
        mem::swap(known, &mut new);
    }
    known.1.include_bound(&new.1);
}

impl Mode<'_> {
    /// Returns the findings of a motion, each with its time on the motion from 0 to 1. Depths differ from those of
    /// the true motion by at most `slack`.
    fn motion(&mut self, motion: &Motion, resolution: f64, slack: f64) -> Vec<(f64, FindingKind)> {
        let swept = self.certifier.check_motion(motion, resolution - slack);
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
            // A point deeper than this limit in the approximation is deeper than allowed in truth. Any other exceeds the
            // allowance by at most the resolution.
            let (limit, tolerance) = (allowed + slack, resolution - 2.0 * slack);
            let depth = self.certifier.motion_depth(surface, motion, limit, tolerance);
            match depth.expect("a surface of the tool") {
                MotionDepth::Within => (),
                MotionDepth::Deeper { at, depth: Interval { low, high }, max_depth, witness }
                    if low < 0.0 =>
                {
                    let [from, to, min_distance] =
                        [-high - slack, -low + slack, -max_depth - slack]
                            .map(|distance| distance.max(0.0));
                    let (margin, distance) = (-allowed, Interval::new(from, to));
                    found.push((
                        at,
                        FindingKind::Near { surface, margin, distance, min_distance, witness },
                    ));
                }
                MotionDepth::Deeper { at, depth, max_depth, witness } => {
                    let through = depth.high >= THROUGH_FRACTION * self.max_depths[index];
                    let depth = Interval::new((depth.low - slack).max(0.0), depth.high + slack);
                    let max_depth = max_depth + slack;
                    found.push((
                        at,
                        FindingKind::Deep { surface, allowed, depth, max_depth, through, witness },
                    ));
                }
                MotionDepth::Inside => inside.push(surface),
                MotionDepth::Undecided(at) => found.push((at, FindingKind::Undecided { surface })),
            }
        }
        if let (MotionVerdict::Inside(surface), []) = (swept, &inside[..]) {
            inside.push(surface);
        }
        if !inside.is_empty() && self.certifier.is_buried(&motion.pose(0.0)) == Some(true) {
            found.push((0.0, FindingKind::Inside { surface: None }));
        } else {
            let finding = |surface| (0.0, FindingKind::Inside { surface: Some(surface) });
            found.extend(inside.into_iter().map(finding));
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
        let distance = if needed.is_finite() {
            self.certifier.clearance(&middle, 0.25 * needed).distance.low
        } else {
            0.0
        };
        let is_outside = |this: &mut Self| {
            this.is_within(&middle, 0.0)
                || !this.has_inside
                || this.certifier.is_buried(&middle) == Some(false)
        };
        if distance > needed && is_outside(self) {
            self.ball = Some((middle, distance));
            self.misses = 0;
        } else {
            self.misses += 1;
            self.wait = MAX_WAIT.min(1 << self.misses.min(4)) - 1;
        }
        self.is_within(&middle, needed)
    }

    /// Returns whether every point of the tool stays within the known free space at a pose and during any travel of
    /// this length from it.
    fn is_within(&self, pose: &Pose, travel: f64) -> bool {
        let Some((known, distance)) = &self.ball else { return false };
        let far = moves::displacement(known, pose, self.reach, self.symmetry) + travel;
        // Covers the rounding of the displacement, whose terms are differences of coordinates.
        let size = pose.tip().coords.norm() + known.tip().coords.norm() + self.reach + far;
        far + 16.0 * f64::EPSILON * size < *distance
    }
}
