//! Certified penetrations compared with brute force, pose by pose.
//!
//! The certified quantity is the depth of triangles in a tool. Brute force ([`crate::brute`]) knows the tool from its
//! restatement, samples triangles and climbs from the deepest samples, and from the witness. No depth that it finds may
//! exceed the upper bound. The lower bound is proved by the witness, whose depth is evaluated by the same oracle.

use crate::brute::{STEPS_PER_CLIMB, Sample, ToolFrame};
use crate::pair::{IN_CONTACT, Pair, Pairs, QUERIED, REACHED, UNDECIDED, VIOLATIONS, WIDER, parts};
use crate::prelude::*;
use crate::{oracle, overhang};
use touchoff::certify::Penetration;

/// Number of poses per part and tool, unless `POSES` is set.
const POSES: usize = 24;

/// The tolerances used, in the part's unit.
const TOLERANCES: [f64; 4] = [0.0, 1e-9, 1e-6, 1e-3];

impl Pair<'_> {
    /// Compares certified depths with brute force at random poses.
    fn compare_depths(&self, poses: usize) -> Tally {
        let mut rng = Rng::new(self.seed);
        let brute = BruteForce::new(&self.part.mesh, &self.oracle, self.length());
        let mut certifier =
            Certifier::new(&self.part.bvh, self.tool).expect("a tool with a profile");
        let mut tally = Tally::default();
        tally.add(QUERIED, poses as u64);
        for k in 0..poses {
            let pose = brute.random_pose(&mut rng);
            let tolerance = TOLERANCES[k % TOLERANCES.len()];
            let penetration = certifier.deepest(&pose, tolerance);
            let verdict = certifier.check_pose(&pose);
            let frame = brute.tool_frame(&pose);
            let sampled_depth = brute.deepest(&frame, &mut rng);
            let case = format!(
                "{self} at tip {:?} axis {:?}, tolerance {tolerance:e}: {penetration:?}, {verdict:?}, brute force {sampled_depth:?}",
                pose.tip().coords.as_slice(),
                pose.axis().as_slice(),
            );
            let mut validation = Validation {
                pair: self,
                brute: &brute,
                frame,
                // Error bound of the oracle and of the coordinates of a sample.
                rounding: 64.0 * f64::EPSILON * brute.size,
                pose,
                tolerance,
                tally: &mut tally,
                case,
            };
            let max_depth = validation.check_interval(&penetration, sampled_depth, &mut rng);
            validation.check_verdict(verdict, max_depth, penetration.depth.low);
        }
        tally.add("samples", brute.evaluations.get());
        tally
    }
}

struct Validation<'a> {
    pair: &'a Pair<'a>,
    brute: &'a BruteForce<'a>,
    frame: ToolFrame,
    rounding: f64,
    pose: Pose,
    tolerance: f64,
    tally: &'a mut Tally,
    case: String,
}

impl Validation<'_> {
    /// Checks an interval and its witness. Returns the greatest depth that is found.
    fn check_interval(&mut self, found: &Penetration, sampled_depth: f64, rng: &mut Rng) -> f64 {
        let Interval { low, high } = found.depth;
        self.tally.see(IN_CONTACT, sampled_depth > 0.0);
        // Brute force without the witness comes near the lower bound.
        self.tally.see(REACHED, low - sampled_depth.max(0.0) <= 1e-6);
        let mut max_depth = sampled_depth;
        match found.witness {
            Some(witness) => {
                let is_shallow = low - self.witness_depth(&witness) > self.rounding;
                self.never(is_shallow, "the witness is not as deep as the lower bound");
                let point = self.brute.to_tool_frame(&self.frame, witness.point);
                let start = Sample { triangle: witness.triangle.index(), point, value: low };
                let depth = |p| self.brute.depth(p);
                let climbed = self.brute.climb(&self.frame, start, STEPS_PER_CLIMB, depth, rng);
                max_depth = max_depth.max(climbed.value);
            }
            None => self.never(low > 0.0, "a lower bound without a witness"),
        }
        let text = format!("a sample is {max_depth:e} deep, above the upper bound");
        self.never(max_depth > high + self.rounding, &text);
        // Written without `low > high`, which is false for NaN.
        let is_interval = 0.0 <= low && low <= high && high.is_finite();
        self.never(!is_interval, "no interval");
        // The rounding error counts twice at either end and four times in the tolerance.
        self.tally.see(WIDER, high - low - self.tolerance > 8.0 * self.rounding);
        max_depth
    }

    fn check_verdict(&mut self, verdict: PoseVerdict, max_depth: f64, low: f64) {
        match verdict {
            PoseVerdict::Clear | PoseVerdict::SurfaceOnly | PoseVerdict::Inside(_) => {
                self.never(max_depth > self.rounding || low > 0.0, "said not to touch");
            }
            PoseVerdict::Touching(witness) => {
                let is_outside = self.witness_depth(&witness) < -self.rounding;
                self.never(is_outside, "the witness of a touch is outside");
            }
            PoseVerdict::Near(_) => self.never(true, "a margin that nobody asked for"),
            PoseVerdict::Undecided(high) => {
                self.tally.add(UNDECIDED, 1);
                let is_deeper = max_depth > high + self.rounding;
                self.never(is_deeper, "deeper than what is undecided");
            }
        }
    }

    /// Returns the depth of a witness, and checks that it lies on its triangle.
    fn witness_depth(&mut self, witness: &Witness) -> f64 {
        let (depth, off) = self.brute.witness(&self.pose, witness);
        let text = format!("the witness is {off:e} from its triangle");
        self.never(off > self.rounding, &text);
        let is_nowhere = witness.surface >= SurfaceId(self.pair.tool.info().surfaces.len());
        self.never(is_nowhere, "the witness is at no surface");
        depth
    }

    fn never(&mut self, occurred: bool, message: &str) {
        self.tally.never(VIOLATIONS, occurred, || format!("{message}: {}", self.case));
    }
}

fn check(tools: &[&str], poses: usize, seed: u64) {
    let parts = parts("POSES");
    let tallies = Pairs { parts: &parts, tools, seed }.compare(oracle, |pair| {
        let tally = pair.compare_depths(poses);
        assert!(3 * tally.count(IN_CONTACT) > poses as u64, "{pair}: {tally:?}");
        // The slivers of real parts widen intervals by their skew.
        assert!(tally.count(WIDER) == 0 || pair.part.is_real, "{pair}: {tally:?}");
        tally
    });
    let total: Tally = tallies.into_iter().sum();
    eprintln!("brute force: {total}");
    total.assert_none(VIOLATIONS);
    // Brute force that seldom comes near the lower bound would not contradict an upper bound either.
    assert!(2 * total.count(REACHED) > total.count(QUERIED), "{total}");
}

#[test]
fn brute_force_stays_within_the_intervals() {
    let tools = ["Fig73Exact", "BullNose", "TSlot", "BallEr16", "TaperedBall"];
    check(&tools, case_count("POSES", POSES), 2);
}

#[test]
fn brute_force_stays_within_the_intervals_of_overhanging_profiles() {
    let tools = [&["FaceMill", "BoringBar"], &overhang::ALL[..]].concat();
    check(&tools, case_count("POSES", POSES), 7);
}

#[test]
fn brute_force_stays_within_the_intervals_on_a_neck() {
    check(&["Lollipop"], case_count("POSES", 4 * POSES), 2);
}
