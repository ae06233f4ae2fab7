//! Certified depths of surfaces, and verdicts with allowances, compared with samples.
//!
//! The oracle knows the distance of a point from each surface, so it knows which surface owns the point: the nearest one.
//! It samples triangles and climbs from the best samples, toward greater depth below one surface or toward a greater excess
//! over the allowances.

use crate::brute::Sample;
use crate::motions::MotionKind;
use crate::pair::{
    CLEAR, IN_CONTACT, NEAR, Pair, Pairs, QUERIED, TOUCHING, UNDECIDED, WIDER, generated_parts,
};
use crate::prelude::*;
use crate::{oracle, overhang};
use std::fmt::{Display, Formatter};
use touchoff_tests::oracle::Meridian;
use touchoff_tests::oracle::profile::Feature;
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

const POSES: usize = 8;
const MOTIONS: usize = 5;
const TIME_SAMPLES: u32 = 12;

/// Maximum number of triangles sampled per pose, and number of samples of each kind per triangle.
const MAX_TRIANGLES: usize = 300;
const SAMPLES_PER_TRIANGLE: usize = 6;
/// Number of samples from which the search climbs, and number of steps.
const CLIMBS: usize = 3;
const STEPS_PER_CLIMB: usize = 250;

/// A tool's surfaces with their allowances, and a part.
pub(crate) struct SurfaceAllowances<'a> {
    pub(crate) tool: &'a dyn Tool,
    pub(crate) bvh: &'a TriangleBvh,
    /// The part's triangles and the tool's oracle.
    pub(crate) brute: BruteForce<'a>,
    /// The allowances of the surfaces, in the part's unit. A negative one is a distance to keep.
    pub(crate) allowances: Vec<f64>,
    /// Error bound of a depth.
    pub(crate) rounding: f64,
    /// Where few triangles are near, each gets at most so many times as many samples.
    pub(crate) max_share: usize,
}

impl<'a> SurfaceAllowances<'a> {
    /// Allows no depth of any surface.
    pub(crate) fn new(
        tool: &'a dyn Tool,
        bvh: &'a TriangleBvh,
        brute: BruteForce<'a>,
    ) -> SurfaceAllowances<'a> {
        let allowances = vec![0.0; tool.info().surfaces.len()];
        let rounding = 64.0 * f64::EPSILON * brute.size;
        SurfaceAllowances { tool, bvh, brute, allowances, rounding, max_share: 8 }
    }

    /// Sets random allowances, at most as large as `size` unless they are infinite.
    pub(crate) fn set_random_allowances(&mut self, size: f64, rng: &mut Rng) {
        for allowed in &mut self.allowances {
            let depth = size * rng.power(-4.0, 0.0);
            *allowed = rng.pick(&[0.0, f64::INFINITY, -depth, depth]);
        }
    }

    pub(crate) fn certifier(&self) -> Certifier<'a> {
        let certifier = Certifier::new(self.bvh, self.tool).expect("a profile");
        allowing(certifier, self.tool, self.allowances.iter().copied())
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
        let name = &self.tool.info().surfaces[surface].name;
        let profile = self.brute.profile.expect("a profile");
        profile.distance_to_surface(name, p) * self.brute.length
    }

    /// Returns the depth of a point, in the part's unit, if the point is inside and the surface is the nearest by more
    /// than rounding, or meets another one at the corner that is the nearest. Returns negative infinity otherwise. At 2e-9
    /// from a tangent joint, two distances differ by only 1e-18. Without a profile, a surface owns the points of its regions.
    fn depth(&self, surface: usize, p: Point) -> f64 {
        let depth = self.brute.depth(p);
        let Some(profile) = self.brute.profile else {
            let region = self.brute.oracle.evaluate(p).map(|inside| inside.owner);
            let owner = region.map(|region| self.tool.info().regions[region].surface);
            return if owner == Some(SurfaceId(surface)) { depth } else { f64::NEG_INFINITY };
        };
        let own_distance = self.distance_to_surface(surface, p);
        let margin = 8.0 * f64::EPSILON * self.brute.size;
        let is_nearest = match profile.profile().nearest(&Meridian::of(p).dz).feature {
            Feature::Corner(_) => own_distance <= depth + margin,
            Feature::Segment(_) => {
                let mut others = (0..self.allowances.len()).filter(|other| *other != surface);
                others.all(|other| own_distance + margin <= self.distance_to_surface(other, p))
            }
        };
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
        let excesses = (0..self.allowances.len()).map(excess).filter(|over| !over.is_nan());
        excesses.fold(f64::NEG_INFINITY, f64::max)
    }

    /// Checks that a witness is below its surface by at least a depth or, if that is negative, no farther from it.
    fn assert_shown(&self, allowed: f64, witness: &Witness, pose: &Pose, text: &str) {
        let p = self.brute.point_in_tool_frame(pose, witness.point);
        let slack = 4.0 * self.rounding;
        let depth = self.brute.depth(p);
        if self.brute.profile.is_none() {
            assert!(depth >= allowed - slack, "{text}: {depth} deep");
            return;
        }
        let distance = self.distance_to_surface(witness.surface.0, p);
        let is_deep = distance <= depth + slack && depth >= allowed.max(0.0) - slack;
        assert!(is_deep || distance <= -allowed + slack, "{text}: {depth} deep, {distance} away");
    }

    /// Checks the certified depth of each surface at a pose.
    pub(crate) fn check_depths(
        &self,
        certifier: &mut Certifier<'_>,
        pose: &Pose,
        tolerance: f64,
        tally: &mut Tally,
        rng: &mut Rng,
    ) {
        let samples = self.samples(pose, rng);
        let mut max_depths = [0.0f64; 2];
        for surface in 0..self.allowances.len() {
            let penetration =
                certifier.deepest_on(SurfaceId(surface), pose, tolerance).expect("a surface");
            let text = format!("{self}, {surface} at {pose:?}, {tolerance}: {penetration:?}");
            let Interval { low, high } = penetration.depth;
            assert!(0.0 <= low && low <= high, "{text}");
            let best = self.max_sample(pose, &samples, |p| self.depth(surface, p), rng);
            let sampled = best.map_or(f64::NEG_INFINITY, |best| best.value);
            assert!(sampled <= high + self.rounding, "{text}, {best:?}");
            tally.add(QUERIED, 1);
            tally.see(IN_CONTACT, sampled > 0.0);
            tally.see(WIDER, high - low > 1.01 * tolerance + 1e-9);
            if let Some(witness) = penetration.witness {
                self.assert_shown(low, &witness, pose, &text);
                assert_eq!(witness.surface, SurfaceId(surface), "{text}");
            } else {
                assert_eq!(low, 0.0, "{text}");
            }
            max_depths = [max_depths[0].max(low), max_depths[1].max(high)];
        }
        let tool_depth = certifier.deepest(pose, tolerance).depth;
        let consistent = max_depths[0] <= tool_depth.high + self.rounding
            && tool_depth.low <= max_depths[1] + self.rounding;
        let text = format!("{max_depths:?} of each, {tool_depth:?} of all");
        assert!(consistent, "{self} at {pose:?}: {text}");
    }

    /// Checks the verdict at a pose.
    pub(crate) fn check_pose(&mut self, pose: &Pose, tally: &mut Tally, rng: &mut Rng) {
        let verdict = self.certifier().check_pose(pose);
        let text = format!("{self} at {pose:?}: {verdict:?}");
        let is_clear = matches!(verdict, PoseVerdict::Clear | PoseVerdict::SurfaceOnly);
        tally.add(QUERIED, 1);
        tally.see(CLEAR, is_clear);
        tally.see(NEAR, matches!(verdict, PoseVerdict::Near(_)));
        tally.see(TOUCHING, matches!(verdict, PoseVerdict::Touching(_)));
        tally.see(UNDECIDED, matches!(verdict, PoseVerdict::Undecided(_)));
        let is_inside = matches!(verdict, PoseVerdict::Inside(_));
        assert!(!is_inside || self.bvh.has_inside(), "{text}");
        let most = match verdict {
            PoseVerdict::Touching(witness) | PoseVerdict::Near(witness) => {
                let allowed = self.allowances[witness.surface.0];
                return self.assert_shown(allowed, &witness, pose, &text);
            }
            PoseVerdict::Undecided(high) => high,
            _ => 0.0,
        };
        if !is_clear {
            self.forget_margins();
        }
        let excess = self.max_excess_at(pose, rng);
        assert!(excess <= most + 4.0 * self.rounding, "{text}: {excess}");
    }

    /// Returns samples of the triangles near a pose, with the value NaN.
    fn samples(&self, pose: &Pose, rng: &mut Rng) -> Vec<Sample> {
        let (brute, frame) = (&self.brute, self.brute.tool_frame(pose));
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
        let count =
            SAMPLES_PER_TRIANGLE * (MAX_TRIANGLES / near.len().max(1)).clamp(1, self.max_share);
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
        write!(f, "{} with {:?}", self.tool.info().name, self.allowances)?;
        let vertices = self.brute.mesh.vertices();
        if vertices.len() < 7 { write!(f, " at {vertices:?}") } else { Ok(()) }
    }
}

/// Runs a check for all generated parts and some tools; the allowances are 0. Returns its counts.
fn for_all_parts(
    tools: &[&str],
    check: impl Fn(&mut SurfaceAllowances<'_>, &mut Tally, &mut Rng) + Sync,
) -> Tally {
    let parts = generated_parts();
    let pairs = Pairs { parts: &parts, tools, seed: 5 };
    let tallies = pairs.compare(oracle, |pair: &Pair<'_>| {
        let brute = BruteForce::new(&pair.part.mesh, &pair.oracle, pair.length());
        let mut owned = SurfaceAllowances::new(pair.tool, &pair.part.bvh, brute);
        let mut tally = Tally::default();
        check(&mut owned, &mut tally, &mut Rng::new(pair.seed));
        tally
    });
    tallies.into_iter().sum()
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
fn check_surface_depths(tools: &[&str], least: u64) {
    let tally = for_all_parts(tools, |owned, tally, rng| {
        let mut certifier = owned.certifier();
        for k in 0..POSES {
            let pose = owned.random_pose(rng);
            owned.check_depths(&mut certifier, &pose, [0.0, 1e-6, 1e-3][k % 3], tally, rng);
        }
    });
    eprintln!("depths of surfaces: {tally}");
    assert!(tally.count(IN_CONTACT) > least, "{tally}");
}

#[test]
fn pose_verdicts_respect_allowances() {
    let tally = for_all_parts(&TOOLS, |owned, tally, rng| {
        for _ in 0..POSES {
            owned.set_random_allowances(5.0, rng);
            let pose = owned.random_pose(rng);
            owned.check_pose(&pose, tally, rng);
        }
    });
    eprintln!("poses with allowances: {tally}");
    assert!(tally.count(CLEAR) > 20 && tally.count(TOUCHING) + tally.count(NEAR) > 20, "{tally}");
}

#[test]
fn motion_verdicts_respect_allowances() {
    let tally = for_all_parts(&TOOLS, |owned, tally, rng| {
        for k in 0..MOTIONS {
            owned.set_random_allowances(5.0, rng);
            let mut certifier = owned.certifier().with_budget(1 << 17);
            let kind = MotionKind::ALL[(5 * k) % MotionKind::ALL.len()];
            let path = owned.brute.random_motion(kind, rng);
            let motion = motion(&path.from, &path.to);
            let tolerance = [0.0, 1e-3][k % 2];
            let verdict = certifier.check_motion(&motion, tolerance);
            let text = format!("{owned} on {path:?}, {tolerance:e}: {verdict:?}");
            let is_clear = matches!(verdict, MotionVerdict::Clear | MotionVerdict::SurfaceOnly);
            tally.see(CLEAR, is_clear);
            tally.see(UNDECIDED, matches!(verdict, MotionVerdict::Undecided(_)));
            let end = match verdict {
                MotionVerdict::Touching(at, witness) | MotionVerdict::Near(at, witness) => {
                    tally.add(TOUCHING, 1);
                    let allowed = owned.allowances[witness.surface.0];
                    owned.assert_shown(allowed, &witness, &motion.pose(at), &text);
                    continue;
                }
                MotionVerdict::Undecided(at) => at,
                _ => 1.0,
            };
            if !is_clear {
                owned.forget_margins();
            }
            let rounding = owned.rounding + 64.0 * f64::EPSILON * motion.displacement().norm();
            for time in 0..TIME_SAMPLES {
                let t = end * f64::from(time) / f64::from(TIME_SAMPLES - 1);
                let excess = owned.max_excess_at(&path.pose(t), rng);
                let most = tolerance.max(16.0 * rounding) + 4.0 * rounding;
                assert!(excess <= most, "{text}: {excess} at {t}");
            }
        }
    });
    eprintln!("motions with allowances: {tally}");
    assert!(tally.count(CLEAR) > 10 && tally.count(TOUCHING) > 20, "{tally}");
}
