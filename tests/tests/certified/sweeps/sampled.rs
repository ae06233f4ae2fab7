//! Certified motions compared with samples of them.
//!
//! The proved statement is that no triangle comes deeper into a tool than the tolerance. The samples
//! ([`crate::approach`]) know the tool from its restatement, and the motion from a separate formula.

use crate::approach::{MotionSample, ReferenceMotion};
use crate::motions::MotionKind;
use crate::oracle;
use crate::pair::{IN_CONTACT, Pair, Pairs, QUERIED, UNDECIDED, VIOLATIONS, is_full_run, parts};
use crate::prelude::*;
use touchoff_tests::oracle::triangle::winding_number;

/// The tolerances used, in the part's unit.
const TOLERANCES: [f64; 3] = [0.0, 1e-6, 1e-3];

/// Library tools; those of a sample come first, and the last is in inches.
const ALL_TOOLS: [&str; 10] = [
    "BullNose",
    "TSlot",
    "Lollipop",
    "Barrel",
    "Fig73Exact",
    "BallEr16",
    "TaperedBall",
    "CornerRounding",
    "Dovetail",
    "HalfInchBallCat40",
];

const TIME_SAMPLES: u32 = 64;

/// Maximum number of motions drawn per motion that is proved clear.
const MAX_DRAWS_PER_PROVED: usize = 20;

/// Names of further counts: a motion proved clear, and one of these that comes nearer than 0.001.
const PROVED: &str = "proved";
const NEAR: &str = "of them near";

impl Pair<'_> {
    /// Compares random motions with samples until at least `count` of them are proved clear, and one touches.
    fn compare_motions(&self, count: usize) -> Tally {
        let mut rng = Rng::new(self.seed);
        let brute = BruteForce::new(&self.part.mesh, &self.oracle, self.length());
        let mut certifier =
            Certifier::new(&self.part.bvh, self.tool).expect("a tool with a profile");
        let mut tally = Tally::default();
        for k in 0..MAX_DRAWS_PER_PROVED * count {
            if tally.count(PROVED) >= count as u64 && tally.count(IN_CONTACT) > 0 {
                break;
            }
            let kind = MotionKind::ALL[k % MotionKind::ALL.len()];
            let tolerance = TOLERANCES[k % TOLERANCES.len()];
            let reference = brute.random_motion(kind, &mut rng);
            let motion = motion(&reference.from, &reference.to);
            let verdict = certifier.check_motion(&motion, tolerance);
            let case = format!(
                "{self} ({kind:?}) from {} to {}, tolerance {tolerance:e}: {verdict:?}",
                format_pose(&reference.from),
                format_pose(&reference.to),
            );
            tally.add(QUERIED, 1);
            let mut validation = Validation {
                pair: self,
                brute: &brute,
                reference,
                motion,
                // Error bound of certified positions, and of the samples.
                rounding: 64.0 * f64::EPSILON * (brute.size + motion.displacement().norm()),
                tolerance,
                tally: &mut tally,
                case,
            };
            validation.run(verdict, &mut rng);
        }
        tally.add("samples", brute.evaluations.get());
        tally
    }
}

fn format_pose(pose: &Pose) -> String {
    format!("tip {:?} axis {:?}", pose.tip().coords.as_slice(), pose.axis().as_slice())
}

struct Validation<'a> {
    pair: &'a Pair<'a>,
    brute: &'a BruteForce<'a>,
    reference: ReferenceMotion,
    motion: Motion,
    rounding: f64,
    tolerance: f64,
    tally: &'a mut Tally,
    case: String,
}

impl Validation<'_> {
    fn run(&mut self, verdict: MotionVerdict, rng: &mut Rng) {
        for t in [0.0, 1.0, rng.between(0.0, 1.0)] {
            self.compare_pose(t);
        }
        match verdict {
            MotionVerdict::Clear | MotionVerdict::Inside(_) | MotionVerdict::SurfaceOnly => {
                self.tally.add(PROVED, 1);
                let deepest =
                    self.brute.deepest_in_motion(&self.reference, TIME_SAMPLES, true, rng);
                self.check_proved(&deepest);
                self.check_side(verdict);
            }
            MotionVerdict::Near(..) => self.never(true, "a margin that nobody asked for"),
            MotionVerdict::Touching(t, witness) => {
                self.tally.add(IN_CONTACT, 1);
                self.compare_pose(t);
                self.check_witness(t, &witness);
            }
            MotionVerdict::Undecided(t) => self.check_undecided(t, rng),
        }
    }

    /// Validates an undecided motion: the part before time `t` must be clear.
    fn check_undecided(&mut self, t: f64, rng: &mut Rng) {
        let deepest = self.brute.deepest_in_motion(&self.reference, TIME_SAMPLES, true, rng);
        self.tally.find(UNDECIDED, format!("{}, {deepest:?}", self.case));
        self.never(!(0.0..=1.0).contains(&t), "undecided at no time");
        if t > 0.0 {
            let clear_part =
                ReferenceMotion { from: self.reference.from, to: self.reference.pose(t) };
            let closest = self.brute.deepest_in_motion(&clear_part, TIME_SAMPLES, true, rng);
            self.check_proved(&closest);
        }
    }

    fn check_proved(&mut self, deepest: &MotionSample) {
        let allowed = self.tolerance.max(16.0 * self.rounding) + self.rounding;
        let excess = deepest.depth - allowed;
        self.tally.see(NEAR, deepest.depth > -1e-3);
        self.never(excess > 0.0, &format!("it is proved, but {deepest:?}"));
    }

    /// Checks tip and axis of the motion at a time.
    fn compare_pose(&mut self, t: f64) {
        let (pose, reference_pose) = (self.motion.pose(t), self.reference.pose(t));
        let tip = (pose.tip() - reference_pose.tip()).norm() - self.rounding;
        // The formula for the axis divides by the sine.
        let sine = self.reference.angle().sin();
        let axis_tolerance = 16.0 * f64::EPSILON / if sine > 0.0 { sine.min(1.0) } else { 1.0 };
        let deviation =
            tip.max((pose.axis() - reference_pose.axis()).norm() - axis_tolerance.min(1e-13));
        let is_off = deviation > 0.0 || !(0.0..=1.0).contains(&t);
        self.never(is_off, &format!("the pose is off by {deviation:e} at {t:?}"));
    }

    fn check_witness(&mut self, t: f64, witness: &Witness) {
        let (brute, pose) = (self.brute, self.motion.pose(t));
        let (depth, off) = brute.witness(&pose, witness);
        self.never(depth < -self.rounding, &format!("the witness is {depth:e} deep"));
        self.never(off > self.rounding, &format!("the witness is {off:e} from its triangle"));
        let surface = self.pair.tool.info().surface(witness.surface);
        let point = brute.point_in_tool_frame(&pose, witness.point);
        let away = self.pair.oracle.distance_to_surface(&surface.name, point) * brute.length;
        let text = format!("its surface is {away:e} away, but it is {depth:e} deep");
        self.never(away > depth.abs() + self.rounding, &text);
    }

    /// Checks a verdict of inside or outside by the part's winding number about a point of the tool.
    fn check_side(&mut self, verdict: MotionVerdict) {
        let [_, height] = self.pair.oracle.extent();
        let top = self.reference.from.tip()
            + self.reference.from.axis() * (0.9 * height * self.brute.length);
        let mesh = &self.pair.part.mesh;
        let triangles = triangles(mesh).map(|corners| corners.map(Into::into));
        let inside = winding_number(triangles, top.into()).round() > 0.0;
        let is_wrong = match verdict {
            MotionVerdict::Clear => inside,
            MotionVerdict::Inside(_) => !inside,
            _ => false,
        };
        self.never(is_wrong, "it is on the other side");
    }

    fn never(&mut self, occurred: bool, message: &str) {
        self.tally.never(VIOLATIONS, occurred, || format!("{message}: {}", self.case));
    }
}

#[test]
fn no_sample_of_a_clear_motion_is_inside() {
    let parts = parts("MOTIONS");
    let count = case_count("MOTIONS", 4);
    let tools: &[&str] = if is_full_run("MOTIONS") { &ALL_TOOLS } else { &ALL_TOOLS[..4] };
    let tallies = Pairs { parts: &parts, tools, seed: 11 }.compare(oracle, |pair| {
        let tally = pair.compare_motions(count);
        let is_enough = tally.count(PROVED) >= count as u64 && tally.count(IN_CONTACT) > 0;
        assert!(is_enough, "{pair}: {tally:#?}");
        tally
    });
    let total: Tally = tallies.into_iter().sum();
    eprintln!("motions: {total}");
    total.assert_none(VIOLATIONS);
    // Motions that stay far away would prove little.
    assert!(5 * total.count(NEAR) > total.count(PROVED), "{total}");
    assert!(100 * total.count(UNDECIDED) <= total.count(QUERIED), "{total:#?}");
}
