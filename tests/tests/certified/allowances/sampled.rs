//! Certified depths of surfaces, and verdicts with allowances, compared with samples.
//!
//! The oracle knows the distance of a point from each surface, so it knows which surface owns the point: the nearest one.
//! It samples triangles and climbs from the best samples, toward greater depth below one surface or toward a greater excess
//! over the allowances.

use super::names;
use crate::brute::Sample;
use crate::motions::MotionKind;
use crate::pair::{Part, generated_parts};
use crate::prelude::*;
use crate::{oracle, overhang};
use std::fmt::{Display, Formatter};
use touchoff_tests::oracle::triangle::Point;

const TOOLS: [&str; 10] = [
    "Fig73Exact",
    "BullNose",
    "TSlot",
    "BallEr16",
    "Lollipop",
    "Barrel",
    "FaceMill",
    "Dished",
    "Bell",
    "Skirt",
];

const POSES: usize = 7;
const MOTIONS: usize = 5;
const TIME_SAMPLES: u32 = 12;

/// Maximum number of triangles sampled per pose, and number of samples of each kind per triangle.
const MAX_TRIANGLES: usize = 300;
const SAMPLES_PER_TRIANGLE: usize = 6;
/// Number of samples from which the search climbs, and number of steps.
const CLIMBS: usize = 3;
const STEPS_PER_CLIMB: usize = 250;

/// A tool's surfaces with their allowances, and a part.
struct SurfaceAllowances<'a> {
    tool: &'a str,
    part: &'a Part,
    /// The part's triangles and the tool's oracle.
    brute: &'a BruteForce<'a>,
    /// The surfaces' names, in the tool's order.
    surface_names: Vec<String>,
    /// The allowances of the surfaces, in the part's unit. A negative one is a distance to keep.
    allowances: Vec<f64>,
}

impl<'a> SurfaceAllowances<'a> {
    /// Sets random allowances of the order of the depths that occur.
    fn set_random_allowances(&mut self, rng: &mut Rng) {
        for allowed in &mut self.allowances {
            let size = rng.power(-3.0, 0.7);
            *allowed = match rng.bits() % 5 {
                0 => 0.0,
                1 => f64::INFINITY,
                2 => -size,
                _ => size,
            };
        }
    }

    fn certifier(&self) -> Certifier<'a> {
        let certifier = Certifier::new(&self.part.bvh, tool(self.tool)).expect("a profile");
        let allowed = self.surface_names.iter().map(String::as_str).zip(self.allowances.clone());
        certifier.with_allowances(allowed).expect("surfaces")
    }

    /// Returns the error bound of a depth.
    fn rounding(&self) -> f64 {
        64.0 * f64::EPSILON * self.brute.size
    }

    /// Forgets the margins: nothing is said of them where a tool is inside the part, or undecided.
    fn forget_margins(&mut self) {
        self.allowances.iter_mut().for_each(|allowed| *allowed = allowed.max(0.0));
    }

    fn random_pose(&self, rng: &mut Rng) -> Pose {
        self.brute.random_motion(MotionKind::Still, rng).from
    }

    /// Returns the largest excess over an allowance that is found at a pose, or 0 if no point is near.
    fn max_excess_at(&self, pose: &Pose, rng: &mut Rng) -> f64 {
        let samples = self.samples(pose, rng);
        let best = self.max_sample(pose, &samples, |p| self.max_excess(p), rng);
        best.map_or(0.0, |best| best.value)
    }

    /// Returns the distance of a point from a surface, in the part's unit.
    fn distance_to_surface(&self, surface: usize, p: Point) -> f64 {
        self.brute.oracle.distance_to_surface(&self.surface_names[surface], p) * self.brute.length
    }

    /// Returns the depth of a point, in the part's unit, if the point is inside and the surface is the nearest by more
    /// than rounding. Returns negative infinity otherwise. At 2e-9 from a tangent joint, two distances differ by only
    /// 1e-18.
    fn depth(&self, surface: usize, p: Point) -> f64 {
        let depth = self.brute.depth(p);
        let own_distance =
            self.distance_to_surface(surface, p) + 8.0 * f64::EPSILON * self.brute.size;
        let mut others = (0..self.surface_names.len()).filter(|other| *other != surface);
        let is_nearest = others.all(|other| own_distance <= self.distance_to_surface(other, p));
        if depth >= 0.0 && is_nearest { depth } else { f64::NEG_INFINITY }
    }

    /// Returns the largest excess of a point's depth over an allowance, or of a distance to keep over the point's
    /// distance.
    fn max_excess(&self, p: Point) -> f64 {
        let excess = |surface: usize| {
            let allowed = self.allowances[surface];
            let excess_depth = self.depth(surface, p) - allowed.max(0.0);
            let lack = || -self.distance_to_surface(surface, p) - allowed;
            if allowed < 0.0 { excess_depth.max(lack()) } else { excess_depth }
        };
        let excesses = (0..self.surface_names.len()).map(excess).filter(|over| !over.is_nan());
        excesses.fold(f64::NEG_INFINITY, f64::max)
    }

    /// Checks that a witness is deeper than its surface's allowance, or nearer than the distance to keep.
    fn assert_violates_allowance(&self, witness: &Witness, pose: &Pose, text: &str) {
        let p = self.brute.point_in_tool_frame(pose, witness.point);
        let (slack, allowed) = (4.0 * self.rounding(), self.allowances[witness.surface.0]);
        let depth = self.brute.depth(p);
        let distance = self.distance_to_surface(witness.surface.0, p);
        let is_deeper = distance <= depth + slack && depth >= allowed.max(0.0) - slack;
        assert!(is_deeper || distance <= -allowed + slack, "{text}: {depth} deep, {distance} away");
    }

    /// Returns samples of the triangles near a pose, with the value NaN.
    fn samples(&self, pose: &Pose, rng: &mut Rng) -> Vec<Sample> {
        let (brute, frame) = (self.brute, self.brute.tool_frame(pose));
        let max_margin =
            self.allowances.iter().fold(0.0, |max_margin: f64, allowed| max_margin.max(-allowed));
        let near = |id: &usize| {
            let ball = &brute.bounding_balls[*id];
            let p = brute.to_tool_frame(&frame, ball.centre);
            brute.is_near(p, (ball.radius + max_margin) / brute.length)
        };
        let mut near: Vec<usize> = (0..brute.bounding_balls.len()).filter(near).collect();
        while near.len() > MAX_TRIANGLES {
            near.swap_remove(rng.index(near.len()));
        }
        let count = SAMPLES_PER_TRIANGLE * (MAX_TRIANGLES / near.len().max(1)).clamp(1, 8);
        let samples = |id| brute.sample(&frame, id, count, |_| f64::NAN, rng);
        near.into_iter().flat_map(samples).collect()
    }

    /// Returns the largest value over the samples and a search from the best of them.
    fn max_sample(
        &self,
        pose: &Pose,
        samples: &[Sample],
        value: impl Fn(Point) -> f64,
        rng: &mut Rng,
    ) -> Option<Sample> {
        let evaluated = |sample: &Sample| Sample { value: value(sample.point), ..*sample };
        let mut evaluated: Vec<Sample> = samples.iter().map(evaluated).collect();
        evaluated.retain(|sample| sample.value > f64::NEG_INFINITY);
        evaluated.sort_by(|a, b| b.value.total_cmp(&a.value));
        evaluated.truncate(CLIMBS);
        let frame = self.brute.tool_frame(pose);
        let climb = |from| self.brute.climb(&frame, from, STEPS_PER_CLIMB, &value, rng);
        evaluated.into_iter().map(climb).max_by(|a, b| a.value.total_cmp(&b.value))
    }
}

impl Display for SurfaceAllowances<'_> {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        let allowed: Vec<_> = self.surface_names.iter().zip(&self.allowances).collect();
        write!(f, "{} in {} with {allowed:?}", self.tool, self.part.name)
    }
}

/// Runs a check for all parts and tools; the allowances are 0.
fn for_all_parts_and_tools(
    tools: &[&str],
    mut check: impl FnMut(&mut SurfaceAllowances<'_>, &mut Rng),
) {
    let mut rng = Rng::new(5);
    for part in generated_parts() {
        for name in tools {
            let oracle = oracle(name);
            let length = tool(name).info().unit.factor_to(part.mesh.unit());
            let surface_names = names(tool(name));
            let mut owned = SurfaceAllowances {
                tool: name,
                part: &part,
                brute: &BruteForce::new(&part.mesh, &oracle, length),
                allowances: vec![0.0; surface_names.len()],
                surface_names,
            };
            check(&mut owned, &mut rng);
        }
    }
}

#[test]
fn samples_are_within_the_certified_depth_of_their_surface() {
    check_surface_depths(&["Fig73Exact", "TSlot", "BallEr16", "Lollipop"], 80);
}

#[test]
fn samples_are_within_the_certified_depth_of_corners() {
    check_surface_depths(&["BullNose", "Barrel", "CornerRounding"], 60);
}

#[test]
fn samples_are_within_the_certified_depth_of_overhanging_profiles() {
    check_surface_depths(&[&["FaceMill", "BoringBar"], &overhang::ALL[..]].concat(), 100);
}

/// Checks the certified depth of each surface against samples; fails unless there are samples of more than `least` surfaces
/// and poses.
fn check_surface_depths(tools: &[&str], least: usize) {
    let mut owners = 0;
    for_all_parts_and_tools(tools, |owned, rng| {
        let mut certifier = Certifier::new(&owned.part.bvh, tool(owned.tool)).expect("a profile");
        let rounding = owned.rounding();
        for k in 0..POSES {
            let (pose, tolerance) = (owned.random_pose(rng), [0.0, 1e-6, 1e-3][k % 3]);
            let samples = owned.samples(&pose, rng);
            let mut max_depths = [0.0f64; 2];
            for surface in 0..owned.surface_names.len() {
                let penetration =
                    certifier.deepest_on(SurfaceId(surface), &pose, tolerance).expect("a surface");
                let text = format!("{owned}, {surface} at {pose:?}, {tolerance}: {penetration:?}");
                let Interval { low, high } = penetration.depth;
                assert!(0.0 <= low && low <= high, "{text}");
                let best = owned.max_sample(&pose, &samples, |p| owned.depth(surface, p), rng);
                if let Some(best) = best {
                    assert!(best.value <= high + rounding, "{text}, {best:?}");
                    owners += 1;
                }
                if let Some(witness) = penetration.witness {
                    let p = owned.brute.point_in_tool_frame(&pose, witness.point);
                    let depth = owned.brute.depth(p);
                    assert!(depth >= low - rounding, "{text}: {depth}");
                    let distance = owned.distance_to_surface(surface, p);
                    assert!(distance <= depth.abs() + 4.0 * rounding, "{text}");
                    assert_eq!(witness.surface, SurfaceId(surface), "{text}");
                } else {
                    assert_eq!(low, 0.0, "{text}");
                }
                max_depths = [max_depths[0].max(low), max_depths[1].max(high)];
            }
            let tool_depth = certifier.deepest(&pose, tolerance).depth;
            let consistent = max_depths[0] <= tool_depth.high + rounding
                && tool_depth.low <= max_depths[1] + rounding;
            let text = format!("{max_depths:?} of each, {tool_depth:?} of all");
            assert!(consistent, "{owned} at {pose:?}: {text}");
        }
    });
    eprintln!("depths of surfaces: {owners} surfaces and poses with samples");
    assert!(owners > least, "{owners}");
}

#[test]
fn pose_verdicts_respect_allowances() {
    let (mut clear, mut touching, mut undecided) = (0, 0, 0);
    for_all_parts_and_tools(&TOOLS, |owned, rng| {
        for _ in 0..POSES {
            owned.set_random_allowances(rng);
            let pose = owned.random_pose(rng);
            let verdict = owned.certifier().check_pose(&pose);
            let text = format!("{owned} at {pose:?}: {verdict:?}");
            let max_excess = match verdict {
                PoseVerdict::Touching(witness) | PoseVerdict::Near(witness) => {
                    touching += 1;
                    owned.assert_violates_allowance(&witness, &pose, &text);
                    continue;
                }
                PoseVerdict::Undecided(high) => high,
                _ => 0.0,
            };
            let is_clear = matches!(verdict, PoseVerdict::Clear | PoseVerdict::SurfaceOnly);
            clear += usize::from(is_clear);
            undecided += usize::from(matches!(verdict, PoseVerdict::Undecided(_)));
            if !is_clear {
                owned.forget_margins();
            }
            let excess = owned.max_excess_at(&pose, rng);
            assert!(excess <= max_excess + 4.0 * owned.rounding(), "{text}: {excess}");
        }
    });
    eprintln!("poses with allowances: {clear} clear, {touching} in contact, {undecided} undecided");
    assert!(clear > 20 && touching > 20, "{clear} clear, {touching} in contact");
}

#[test]
fn motion_verdicts_respect_allowances() {
    let (mut clear, mut touching, mut undecided) = (0, 0, 0);
    for_all_parts_and_tools(&TOOLS, |owned, rng| {
        for k in 0..MOTIONS {
            owned.set_random_allowances(rng);
            let mut certifier = owned.certifier().with_budget(1 << 17);
            let kind = MotionKind::ALL[(5 * k) % MotionKind::ALL.len()];
            let path = owned.brute.random_motion(kind, rng);
            let motion = motion(&path.from, &path.to);
            let tolerance = [0.0, 1e-3][k % 2];
            let verdict = certifier.check_motion(&motion, tolerance);
            let text = format!("{owned} on {path:?}, {tolerance:e}: {verdict:?}");
            let end = match verdict {
                MotionVerdict::Touching(at, witness) | MotionVerdict::Near(at, witness) => {
                    touching += 1;
                    owned.assert_violates_allowance(&witness, &motion.pose(at), &text);
                    continue;
                }
                MotionVerdict::Undecided(at) => at,
                _ => 1.0,
            };
            let is_clear = matches!(verdict, MotionVerdict::Clear | MotionVerdict::SurfaceOnly);
            clear += usize::from(is_clear);
            undecided += usize::from(matches!(verdict, MotionVerdict::Undecided(_)));
            if !is_clear {
                owned.forget_margins();
            }
            let rounding = owned.rounding() + 64.0 * f64::EPSILON * motion.displacement().norm();
            for time in 0..TIME_SAMPLES {
                let t = end * f64::from(time) / f64::from(TIME_SAMPLES - 1);
                let excess = owned.max_excess_at(&path.pose(t), rng);
                let most = tolerance.max(16.0 * rounding) + 4.0 * rounding;
                assert!(excess <= most, "{text}: {excess} at {t}");
            }
        }
    });
    let text = format!("{clear} clear, {touching} in contact, {undecided} undecided");
    eprintln!("motions with allowances: {text}");
    assert!(clear > 10 && touching > 20, "{text}");
}
