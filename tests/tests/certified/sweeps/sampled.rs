//! Certified motions compared with samples of them.
//!
//! The proved statement is that no triangle comes deeper into a tool than the tolerance. The samples
//! ([`crate::approach`]) know the tool from its restatement, and the motion from a separate formula.

use crate::approach::{MotionSample, ReferenceMotion};
use crate::brute::{BruteForce, distance, nearest};
use crate::motions::MotionKind;
use crate::pair::{Pair, Pairs, is_full_run, parts};
use crate::{motion, oracle};
use nalgebra::Point3;
use touchoff::certify::{Certifier, MotionVerdict, Witness};
use touchoff::{Mesh, Motion, Pose, TriangleId};
use touchoff_tests::count::case_count;
use touchoff_tests::oracle::Oracle;
use touchoff_tests::oracle::rng::Rng;

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

/// Number of times sampled per motion.
const TIME_SAMPLES: u32 = 64;

/// Maximum number of motions drawn per motion that is proved clear.
const MAX_DRAWS_PER_PROVED: usize = 20;

/// The results of comparisons.
#[derive(Clone, Debug, Default)]
struct Results {
    /// Number of motions queried.
    motions: usize,
    /// Number of motions proved clear.
    proved: usize,
    /// Number of motions proved clear that come nearer than 0.001.
    near_misses: usize,
    /// Number of motions with a witness of contact.
    touching: usize,
    /// Undecided motions.
    undecided: Vec<String>,
    /// Number of depths that were evaluated.
    samples: u64,
    /// Wrong answers, with tool, part and motion.
    violations: Vec<String>,
}

impl Results {
    fn add(mut self, other: Results) -> Results {
        self.motions += other.motions;
        self.proved += other.proved;
        self.near_misses += other.near_misses;
        self.touching += other.touching;
        self.undecided.extend(other.undecided);
        self.samples += other.samples;
        self.violations.extend(other.violations);
        self
    }
}

impl Pair<'_> {
    /// Compares random motions with samples until `count` of them are proved clear.
    fn compare_motions(&self, count: usize) -> Results {
        let mut rng = Rng::new(self.seed);
        let brute = BruteForce::new(&self.part.mesh, &self.oracle, self.length());
        let mut certifier =
            Certifier::new(&self.part.bvh, self.tool).expect("a tool with a profile");
        let mut results = Results::default();
        while results.proved < count && results.motions < MAX_DRAWS_PER_PROVED * count {
            let kind = MotionKind::ALL[results.motions % MotionKind::ALL.len()];
            let tolerance = TOLERANCES[results.motions % TOLERANCES.len()];
            let reference = brute.random_motion(kind, &mut rng);
            let motion = motion(&reference.from, &reference.to);
            let verdict = certifier.check_motion(&motion, tolerance);
            let case = format!(
                "{self} ({kind:?}) from {} to {}, tolerance {tolerance:e}: {verdict:?}",
                format_pose(&reference.from),
                format_pose(&reference.to),
            );
            results.motions += 1;
            let mut validation = Validation {
                pair: self,
                brute: &brute,
                reference,
                motion,
                // Error bound of certified positions, and of the samples.
                rounding: 64.0 * f64::EPSILON * (brute.size + motion.displacement().norm()),
                tolerance,
                results: &mut results,
                case,
            };
            validation.run(verdict, &mut rng);
        }
        results.samples = brute.evaluations.get();
        results
    }
}

fn format_pose(pose: &Pose) -> String {
    format!("tip {:?} axis {:?}", pose.tip().coords.as_slice(), pose.axis().as_slice())
}

/// A motion under validation.
struct Validation<'a> {
    pair: &'a Pair<'a>,
    brute: &'a BruteForce<'a>,
    reference: ReferenceMotion,
    motion: Motion,
    rounding: f64,
    tolerance: f64,
    results: &'a mut Results,
    case: String,
}

impl Validation<'_> {
    fn run(&mut self, verdict: MotionVerdict, rng: &mut Rng) {
        for t in [0.0, 1.0, rng.between(0.0, 1.0)] {
            self.compare_pose(t);
        }
        match verdict {
            MotionVerdict::Clear | MotionVerdict::Inside(_) | MotionVerdict::SurfaceOnly => {
                self.results.proved += 1;
                let deepest =
                    self.brute.deepest_in_motion(&self.reference, TIME_SAMPLES, true, rng);
                self.check_proved(&deepest);
                self.check_side(verdict);
            }
            MotionVerdict::Touching(t, witness) => {
                self.results.touching += 1;
                self.compare_pose(t);
                self.check_witness(t, &witness);
            }
            MotionVerdict::Undecided(t) => self.check_undecided(t, rng),
        }
    }

    /// Validates an undecided motion: the part before time `t` must be clear.
    fn check_undecided(&mut self, t: f64, rng: &mut Rng) {
        let deepest = self.brute.deepest_in_motion(&self.reference, TIME_SAMPLES, true, rng);
        self.results.undecided.push(format!("{}, {deepest:?}", self.case));
        if !(0.0..=1.0).contains(&t) {
            self.add_violation("undecided at no time");
        } else if t > 0.0 {
            let clear_part =
                ReferenceMotion { from: self.reference.from, to: self.reference.pose(t) };
            let closest = self.brute.deepest_in_motion(&clear_part, TIME_SAMPLES, true, rng);
            self.check_proved(&closest);
        }
    }

    fn check_proved(&mut self, deepest: &MotionSample) {
        let allowed = self.tolerance.max(16.0 * self.rounding) + self.rounding;
        let excess = deepest.depth - allowed;
        self.results.near_misses += usize::from(deepest.depth > -1e-3);
        if excess > 0.0 {
            self.add_violation(&format!("it is proved, but {deepest:?}"));
        }
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
        if deviation > 0.0 || !(0.0..=1.0).contains(&t) {
            self.add_violation(&format!("the pose is off by {deviation:e} at {t:?}"));
        }
    }

    fn check_witness(&mut self, t: f64, witness: &Witness) {
        let (brute, pose) = (self.brute, self.motion.pose(t));
        let point = brute.point_in_tool_frame(&pose, witness.point);
        let depth = brute.depth(point) * brute.length;
        if depth < -self.rounding {
            self.add_violation(&format!("the witness is {depth:e} deep"));
        }
        let triangle = brute.triangle(&brute.tool_frame(&pose), witness.triangle.index());
        let triangle_distance = distance(point, nearest(point, &triangle)) * brute.length;
        if triangle_distance > self.rounding {
            self.add_violation(&format!("the witness is {triangle_distance:e} from its triangle"));
        }
        let surface = self.pair.tool.info().surface(witness.surface);
        let surface_distance =
            self.pair.oracle.distance_to_surface(&surface.name, point) * brute.length;
        if surface_distance > depth.abs() + self.rounding {
            self.add_violation(&format!(
                "its surface is {surface_distance:e} away, but it is {depth:e} deep"
            ));
        }
    }

    /// Checks a verdict of inside or outside by the part's winding number about a point of the tool.
    fn check_side(&mut self, verdict: MotionVerdict) {
        let [_, height] = self.pair.oracle.extent();
        let top = self.reference.from.tip()
            + self.reference.from.axis() * (0.9 * height * self.brute.length);
        let inside = winding_number(&self.pair.part.mesh, top).round() > 0.0;
        if matches!(
            (verdict, inside),
            (MotionVerdict::Clear, true) | (MotionVerdict::Inside(_), false)
        ) {
            self.add_violation("it is on the other side");
        }
    }

    fn add_violation(&mut self, message: &str) {
        self.results.violations.push(format!("{message}: {}", self.case));
    }
}

/// Returns the winding number of a surface about a point: the sum of its triangles' solid angles (Van Oosterom,
/// Strackee 1983) over 4π.
fn winding_number(mesh: &Mesh, point: Point3<f64>) -> f64 {
    let angle = |id: u32| {
        let [a, b, c] = mesh.triangle(TriangleId(id)).map(|corner| corner - point);
        let (x, y, z) = (a.norm(), b.norm(), c.norm());
        let denominator = x * y * z + a.dot(&b) * z + b.dot(&c) * x + c.dot(&a) * y;
        2.0 * a.dot(&b.cross(&c)).atan2(denominator)
    };
    let total: f64 = (0..mesh.triangles().len() as u32).map(angle).sum();
    total / (4.0 * std::f64::consts::PI)
}

#[test]
fn no_sample_of_a_clear_motion_is_inside() {
    let parts = parts("MOTIONS");
    let count = case_count("MOTIONS", 4);
    let tools: &[&str] = if is_full_run("MOTIONS") { &ALL_TOOLS } else { &ALL_TOOLS[..4] };
    let results = Pairs { parts: &parts, tools, seed: 11 }.compare(oracle, |pair| {
        let results = pair.compare_motions(count);
        assert!(results.proved == count && results.touching > 0, "{pair}: {results:#?}");
        results
    });
    let total = results.into_iter().fold(Results::default(), Results::add);
    eprintln!(
        "motions: {} queried, {} proved, {} of them near, {} in contact, {} undecided, {} samples, {} violations",
        total.motions,
        total.proved,
        total.near_misses,
        total.touching,
        total.undecided.len(),
        total.samples,
        total.violations.len()
    );
    assert!(total.violations.is_empty(), "{:#?}", total.violations);
    // Motions that stay far away would prove little.
    assert!(5 * total.near_misses > total.proved, "{} near", total.near_misses);
    assert!(100 * total.undecided.len() <= total.motions, "{:#?}", total.undecided);
}
