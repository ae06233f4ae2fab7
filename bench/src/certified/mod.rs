//! Certified penetrations compared with brute force, pose by pose.
//!
//! The certified quantity is the depth of triangles in a tool. Brute force ([`brute`]) knows the tool from its
//! restatement, samples triangles and climbs from the deepest samples. Its result must not exceed the upper bound. The
//! lower bound is proved by the witness, whose depth is evaluated by the same oracle.

pub mod allowances;
pub mod approach;
pub mod brute;
pub mod depth_oracle;
pub mod enclosed;
pub mod motions;
pub mod poses;
pub mod sweeps;
pub mod zoomed;

use brute::{BruteForce, ToolFrame};
use nalgebra::Point3;
use std::fmt::Write;
use touchoff::certify::{Certifier, PoseVerdict, TriangleBvh, Witness};
use touchoff::{Interval, Mesh, Pose, SurfaceId, Tool};
use touchoff_tests::oracle::Nearest;
use touchoff_tests::oracle::rng::Rng;

/// The tolerances used, in the part's unit.
pub const TOLERANCES: [f64; 4] = [0.0, 1e-9, 1e-6, 1e-3];

/// The largest value of one kind, and the case to reproduce it.
#[derive(Clone, Debug, Default)]
pub struct Worst {
    /// The value, in the part's unit.
    pub value: f64,
    /// Tool, part and pose, to the last bit.
    pub case: String,
}

impl Worst {
    fn update(&mut self, value: f64, case: impl FnOnce() -> String) {
        if value.is_nan() || value > self.value {
            *self = Worst { value, case: case() };
        }
    }
}

/// The results for a tool and a part.
#[derive(Clone, Debug)]
pub struct Row {
    /// The tool's name.
    pub tool: String,
    /// The part's name.
    pub part: String,
    /// Number of poses queried.
    pub poses: usize,
    /// Number of poses at which brute force finds a point inside the tool.
    pub touching: usize,
    /// Number of points that brute force evaluated with the oracle.
    pub samples: u64,
    /// Excess of brute force over the upper bound. More than rounding is a violation.
    pub upper_excess: Worst,
    /// Excess of the lower bound over the witness's depth. More than rounding is a violation.
    pub witness_deficit: Worst,
    /// Excess of the lower bound over the result of brute force without the witness: a measure of its strength.
    pub sample_deficit: Worst,
    /// Number of poses at which that excess is at most 1e-6.
    pub reached: usize,
    /// Excess of an interval's width over the tolerance.
    pub excess_width: Worst,
    /// Number of intervals wider than tolerance and rounding together.
    pub too_wide: usize,
    /// Number of verdicts of [`Certifier::check_pose`] that are undecided.
    pub undecided: usize,
    /// All violations.
    pub violations: Vec<String>,
}

/// A part and a tool to compare.
pub struct Pair<'a> {
    /// The part's name in messages.
    pub part: &'a str,
    /// The part.
    pub mesh: &'a Mesh,
    /// The part's triangles in a bounding volume hierarchy.
    pub bvh: &'a TriangleBvh,
    /// The tool.
    pub tool: &'a dyn Tool,
    /// The oracle of the tool.
    pub oracle: &'a Nearest,
}

impl Pair<'_> {
    /// Compares `count` random poses.
    ///
    /// # Panics
    /// If the certifier rejects the tool.
    pub fn measure(&self, count: usize, seed: u64) -> Row {
        let mut rng = Rng::new(seed);
        let info = self.tool.info();
        let length = info.unit.factor_to(self.mesh.unit());
        let brute = BruteForce::new(self.mesh, self.oracle, length);
        let mut certifier = Certifier::new(self.bvh, self.tool).expect("a tool with a profile");
        let mut row = Row {
            tool: info.name.to_string(),
            part: self.part.to_owned(),
            poses: count,
            touching: 0,
            samples: 0,
            upper_excess: Worst::default(),
            witness_deficit: Worst::default(),
            sample_deficit: Worst::default(),
            reached: 0,
            excess_width: Worst::default(),
            too_wide: 0,
            undecided: 0,
            violations: Vec::new(),
        };
        for k in 0..count {
            let pose = poses::pose(self.mesh, self.oracle, length, &mut rng);
            let tolerance = TOLERANCES[k % TOLERANCES.len()];
            let mut validation = Validation {
                pair: self,
                brute: &brute,
                frame: brute.tool_frame(&pose),
                // Error bound of the oracle and of the coordinates of a sample.
                rounding: 64.0 * f64::EPSILON * brute.size,
                pose,
                tolerance,
                row: &mut row,
            };
            validation.validate(&mut certifier, &mut rng);
        }
        row
    }
}

/// A pose under validation.
struct Validation<'a> {
    pair: &'a Pair<'a>,
    brute: &'a BruteForce<'a>,
    frame: ToolFrame,
    rounding: f64,
    pose: Pose,
    tolerance: f64,
    row: &'a mut Row,
}

impl Validation<'_> {
    fn validate(&mut self, certifier: &mut Certifier<'_>, rng: &mut Rng) {
        let penetration = certifier.deepest(&self.pose, self.tolerance);
        let Interval { low, high } = penetration.depth;
        let sampled_depth = self.brute.deepest(&self.frame, rng, &mut self.row.samples);
        let case = format!(
            "{} in {} at tip {:?} axis {:?}, tolerance {:e}: {:?}, brute force {sampled_depth:?}",
            self.row.tool,
            self.row.part,
            self.pose.tip().coords.as_slice(),
            self.pose.axis().as_slice(),
            self.tolerance,
            penetration
        );
        self.row.touching += usize::from(sampled_depth > 0.0);
        self.row.sample_deficit.update(low - sampled_depth.max(0.0), || case.clone());
        self.row.reached += usize::from(low - sampled_depth.max(0.0) <= 1e-6);
        let mut max_depth = sampled_depth;
        match penetration.witness {
            Some(witness) => {
                let depth = self.witness_depth(&witness, &case);
                self.row.witness_deficit.update(low - depth, || case.clone());
                if low - depth > self.rounding {
                    self.add_violation("the witness is not as deep as the lower bound", &case);
                }
                max_depth = max_depth.max(self.climb_from(&witness, rng));
            }
            None if low > 0.0 => self.add_violation("a lower bound without a witness", &case),
            None => (),
        }
        self.row.upper_excess.update(max_depth - high, || case.clone());
        if max_depth > high + self.rounding {
            self.add_violation(
                &format!("a sample is {max_depth:e} deep, above the upper bound"),
                &case,
            );
        }
        // Written without `low > high`, which is false for NaN.
        if !(0.0 <= low && low <= high && high.is_finite()) {
            self.add_violation("no interval", &case);
        }
        let excess_width = high - low - self.tolerance;
        self.row.excess_width.update(excess_width, || case.clone());
        // The rounding error counts twice at either end and four times in the tolerance.
        self.row.too_wide += usize::from(excess_width > 8.0 * self.rounding);
        let verdict = certifier.check_pose(&self.pose);
        self.validate_verdict(verdict, max_depth, low, &format!("{case}, {verdict:?}"));
    }

    fn validate_verdict(&mut self, verdict: PoseVerdict, max_depth: f64, low: f64, case: &str) {
        match verdict {
            PoseVerdict::Clear | PoseVerdict::SurfaceOnly | PoseVerdict::Inside(_) => {
                if max_depth > self.rounding || low > 0.0 {
                    self.add_violation("said not to touch", case);
                }
            }
            PoseVerdict::Touching(witness) => {
                if self.witness_depth(&witness, case) < -self.rounding {
                    self.add_violation("the witness of a touch is outside", case);
                }
            }
            PoseVerdict::Undecided(high) => {
                self.row.undecided += 1;
                if max_depth > high + self.rounding {
                    self.add_violation("deeper than what is undecided", case);
                }
            }
        }
    }

    /// Returns the depth of a witness, and checks that it lies on its triangle.
    fn witness_depth(&mut self, witness: &Witness, case: &str) -> f64 {
        let triangle = self.brute.triangle(&self.frame, witness.triangle.index());
        let point = self.brute.point_in_tool_frame(&self.pose, witness.point);
        let triangle_distance =
            brute::distance(point, brute::nearest(point, &triangle)) * self.brute.length;
        if triangle_distance > self.rounding {
            self.add_violation(
                &format!("the witness is {triangle_distance:e} from its triangle"),
                case,
            );
        }
        if witness.surface >= SurfaceId(self.pair.tool.info().surfaces.len()) {
            self.add_violation("the witness is at no surface", case);
        }
        self.brute.depth(point) * self.brute.length
    }

    /// Returns the greatest depth that a climb from a witness reaches.
    fn climb_from(&mut self, witness: &Witness, rng: &mut Rng) -> f64 {
        let start = self.brute.point_in_tool_frame(&self.pose, Point3::from(witness.point.coords));
        let triangle = witness.triangle.index();
        self.brute.climb(&self.frame, triangle, start, rng, &mut self.row.samples)
    }

    fn add_violation(&mut self, message: &str, case: &str) {
        self.row.violations.push(format!("{message}: {case}"));
    }
}

/// Returns the rows as a Markdown table, with a list of violations.
///
/// # Errors
/// Never in practice: writing to a string cannot fail.
pub fn table(rows: &[Row]) -> Result<String, std::fmt::Error> {
    let mut page = "| tool | part | poses | in contact | worst over | worst under | brute behind | reached | over the tolerance | wider \
                    | undecided | violations |\n|---|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|\n"
        .to_owned();
    for row in rows {
        let [upper_excess, witness_deficit, sample_deficit, excess_width] =
            [&row.upper_excess, &row.witness_deficit, &row.sample_deficit, &row.excess_width]
                .map(|worst| worst.value);
        writeln!(
            page,
            "| {} | {} | {} | {} | {upper_excess:.1e} | {witness_deficit:.1e} | {sample_deficit:.1e} | {} | {excess_width:.1e} | {} | {} | {} |",
            row.tool,
            row.part,
            row.poses,
            row.touching,
            row.reached,
            row.too_wide,
            row.undecided,
            row.violations.len()
        )?;
    }
    let sum = |value: fn(&Row) -> u64| rows.iter().map(value).sum::<u64>();
    writeln!(
        page,
        "\n{} poses, {} of them in contact, {} samples of brute force.\n\n## Violated\n",
        sum(|row| row.poses as u64),
        sum(|row| row.touching as u64),
        sum(|row| row.samples)
    )?;
    let mut violated = rows.iter().flat_map(|row| &row.violations).peekable();
    if violated.peek().is_none() {
        page += "Nothing.\n";
    }
    for violation in violated {
        writeln!(page, "- {violation}")?;
    }
    Ok(page)
}
