//! Certified motions compared with samples of them.
//!
//! The proved statement is that no triangle comes deeper into a tool than the tolerance. The samples
//! ([`super::approach`]) know the tool from its restatement, and the motion from a separate formula.

use super::approach::{MotionSample, ReferenceMotion};
use super::brute::{BruteForce, distance, nearest};
use super::{Pair, Worst, motions};
use nalgebra::Point3;
use std::fmt::Write;
use touchoff::certify::{Certifier, MotionVerdict, Witness};
use touchoff::{Mesh, Motion, TriangleId};
use touchoff_tests::oracle::Oracle;
use touchoff_tests::oracle::rng::Rng;

/// The tolerances used, in the part's unit.
const TOLERANCES: [f64; 3] = [0.0, 1e-6, 1e-3];

/// Number of times sampled per motion.
const TIME_SAMPLES: u32 = 64;

/// Maximum number of motions drawn per motion that is proved clear.
const MAX_DRAWS_PER_PROVED: usize = 20;

/// Maximum number of undecided motions listed.
const MAX_UNDECIDED_LISTED: usize = 24;

/// The results for a tool and a part.
#[derive(Clone, Debug)]
pub struct Row {
    /// The tool's name.
    pub tool: String,
    /// The part's name.
    pub part: String,
    /// Number of motions queried.
    pub motions: usize,
    /// Number of motions proved clear.
    pub proved: usize,
    /// Number of motions with a witness of contact.
    pub touching: usize,
    /// Undecided motions, with the data to reproduce them.
    pub undecided: Vec<String>,
    /// Number of motions proved clear that come nearer than 0.001.
    pub near_misses: usize,
    /// Excess of a sample's depth over tolerance and rounding. A positive value is a violation.
    pub depth_excess: Worst,
    /// Deviation of tip and axis from those of the other formula, beyond rounding. A positive value is a violation.
    pub pose_deviation: Worst,
    /// All violations.
    pub violations: Vec<String>,
}

impl Pair<'_> {
    /// Queries random motions until `count` of them are proved clear.
    ///
    /// # Panics
    /// If the certifier rejects the tool.
    pub fn sweeps(&self, count: usize, seed: u64) -> Row {
        let mut rng = Rng::new(seed);
        let info = self.tool.info();
        let brute = BruteForce::new(self.mesh, self.oracle, info.unit.factor_to(self.mesh.unit()));
        let mut certifier = Certifier::new(self.bvh, self.tool).expect("a tool with a profile");
        let mut row = Row {
            tool: info.name.to_string(),
            part: self.part.to_owned(),
            motions: 0,
            proved: 0,
            touching: 0,
            undecided: Vec::new(),
            near_misses: 0,
            depth_excess: Worst { value: f64::NEG_INFINITY, case: String::new() },
            pose_deviation: Worst::default(),
            violations: Vec::new(),
        };
        while row.proved < count && row.motions < MAX_DRAWS_PER_PROVED * count {
            let kind = motions::MOTION_KINDS[row.motions % motions::MOTION_KINDS.len()];
            let tolerance = TOLERANCES[row.motions % TOLERANCES.len()];
            let reference = motions::random_motion(&brute, kind, &mut rng);
            let motion =
                Motion::new(&reference.from, &reference.to).expect("axes that are not opposite");
            let verdict = certifier.check_motion(&motion, tolerance);
            let case = format!(
                "{} in {} ({kind}) from {} to {}, tolerance {tolerance:e}: {verdict:?}",
                row.tool,
                row.part,
                format_pose(&reference.from),
                format_pose(&reference.to),
            );
            row.motions += 1;
            let mut validation = Validation {
                pair: self,
                brute: &brute,
                reference,
                motion,
                // Error bound of certified positions, and of the samples.
                rounding: 64.0 * f64::EPSILON * (brute.size + motion.displacement().norm()),
                tolerance,
                row: &mut row,
                case,
            };
            validation.run(verdict, &mut rng);
        }
        row
    }
}

fn format_pose(pose: &touchoff::Pose) -> String {
    format!("tip {:?} axis {:?}", pose.tip().coords.as_slice(), pose.axis().as_slice())
}

struct Validation<'a> {
    pair: &'a Pair<'a>,
    brute: &'a BruteForce<'a>,
    reference: ReferenceMotion,
    motion: Motion,
    rounding: f64,
    tolerance: f64,
    row: &'a mut Row,
    case: String,
}

impl Validation<'_> {
    fn run(&mut self, verdict: MotionVerdict, rng: &mut Rng) {
        for t in [0.0, 1.0, rng.between(0.0, 1.0)] {
            self.compare_pose(t);
        }
        match verdict {
            MotionVerdict::Clear | MotionVerdict::Inside(_) | MotionVerdict::SurfaceOnly => {
                self.row.proved += 1;
                let deepest =
                    self.brute.deepest_in_motion(&self.reference, TIME_SAMPLES, true, rng);
                self.check_proved(&deepest);
                self.check_side(verdict);
            }
            MotionVerdict::Touching(t, witness) => {
                self.row.touching += 1;
                self.compare_pose(t);
                self.check_witness(t, &witness);
            }
            MotionVerdict::Undecided(t) => self.check_undecided(t, rng),
        }
    }

    /// Validates an undecided motion: the part before time `t` must be clear.
    fn check_undecided(&mut self, t: f64, rng: &mut Rng) {
        let deepest = self.brute.deepest_in_motion(&self.reference, TIME_SAMPLES, true, rng);
        self.row.undecided.push(format!("{}, {deepest:?}", self.case));
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
        self.row.near_misses += usize::from(deepest.depth > -1e-3);
        self.row.depth_excess.update(excess, || format!("{}, {deepest:?}", self.case));
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
        let describe = || format!("{}, at {t:?}", self.case);
        self.row.pose_deviation.update(deviation, describe);
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
        let inside = winding_number(self.pair.mesh, top).round() > 0.0;
        if matches!(
            (verdict, inside),
            (MotionVerdict::Clear, true) | (MotionVerdict::Inside(_), false)
        ) {
            self.add_violation("it is on the other side");
        }
    }

    fn add_violation(&mut self, message: &str) {
        self.row.violations.push(format!("{message}: {}", self.case));
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

/// Returns the rows as a Markdown table, with lists of undecided motions and of violations.
///
/// # Errors
/// Never in practice: writing to a string cannot fail.
pub fn table(rows: &[Row]) -> Result<String, std::fmt::Error> {
    let mut page = "| tool | part | motions | proved | of these near | touching | undecided | worst over | violations |\n\
                    |---|---|--:|--:|--:|--:|--:|--:|--:|\n"
        .to_owned();
    for row in rows {
        writeln!(
            page,
            "| {} | {} | {} | {} | {} | {} | {} | {:.1e} | {} |",
            row.tool,
            row.part,
            row.motions,
            row.proved,
            row.near_misses,
            row.touching,
            row.undecided.len(),
            row.depth_excess.value,
            row.violations.len()
        )?;
    }
    let sum = |value: fn(&Row) -> usize| rows.iter().map(value).sum::<usize>();
    writeln!(
        page,
        "\n{} motions, {} of them proved, {} touching, {} undecided.",
        sum(|row| row.motions),
        sum(|row| row.proved),
        sum(|row| row.touching),
        sum(|row| row.undecided.len())
    )?;
    list(
        &mut page,
        "Undecided",
        rows.iter().flat_map(|row| &row.undecided).take(MAX_UNDECIDED_LISTED),
    )?;
    list(&mut page, "Violated", rows.iter().flat_map(|row| &row.violations))?;
    Ok(page)
}

fn list<'a>(
    page: &mut String,
    title: &str,
    lines: impl Iterator<Item = &'a String>,
) -> std::fmt::Result {
    writeln!(page, "\n## {title}\n")?;
    let mut lines = lines.peekable();
    if lines.peek().is_none() {
        writeln!(page, "Nothing.")?;
    }
    for line in lines {
        writeln!(page, "- {line}")?;
    }
    Ok(())
}
