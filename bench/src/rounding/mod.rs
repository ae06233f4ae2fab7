//! Certified depths of single triangles compared with a 256-bit reference, in cases where rounding errors are largest.
//!
//! The doubles of a mesh and a pose are taken as exact numbers. The pose is taken as the exact map `p = R q + tip` from
//! the tool's frame, so a point `p` of the part is `R⁻¹ (p - tip)` in that frame. A search in doubles proposes points.
//! The 256-bit depth of the best of them is a lower bound of the true depth ([`truth`]). An upper bound below it is
//! certainly violated.
//!
//! The lower bound is the depth of the witness, so two findings violate it. One is a witness that is farther from its
//! triangle than rounding explains. The other is a point of the triangle next to the witness whose depth is below the
//! lower bound by more than the distance between the two: depth is 1-Lipschitz.

pub mod cases;
pub mod cutters;
pub mod truth;

use cases::{Case, Family};
use cutters::Cutter;
use nalgebra::Point3;
use std::fmt::Write;
use touchoff::certify::{Certifier, TriangleBvh, Witness};
use touchoff::{Mesh, Unit};
use touchoff_tests::oracle::big::Big;
use touchoff_tests::oracle::rng::Rng;
use truth::{Point, Scene, TrianglePoint};

/// Number of violations listed per family.
const MAX_LISTED: usize = 4;

/// The largest of several values, and the case that has it.
#[derive(Clone, Copy, Debug, Default)]
pub struct Worst {
    /// The value.
    pub value: f64,
    /// The case number.
    pub case: u64,
}

impl Worst {
    fn update(&mut self, other: Worst) {
        if other.value.is_nan() || other.value > self.value {
            *self = other;
        }
    }
}

/// The statistics of a family's cases.
#[derive(Clone, Debug)]
pub struct Row {
    /// The family.
    pub family: Family,
    /// Number of cases queried.
    pub cases: u64,
    /// Cases in which a point of the triangles is inside the tool.
    pub touching: u64,
    /// Cases in which the search without the witness comes within 1e-9 of the tool's size of the lower bound.
    pub found_unaided: u64,
    /// Cases in which a depth in 256 bits reaches the lower bound, so that the bound is certainly true.
    pub lower_certain: u64,
    /// Intervals wider than the tolerance plus the promised widening at both ends.
    pub too_wide: u64,
    /// The largest excess of an interval's width over that, in widenings.
    pub max_excess_width: Worst,
    /// The largest excess of the true depth over the computed depth, as a fraction of what the upper bound adds.
    pub above: Worst,
    /// The largest excess of the computed depth over the true depth, as a fraction of what the lower bound subtracts.
    pub below: Worst,
    /// Upper bounds below a depth in 256 bits, and intervals that are negative or not finite.
    pub upper_violations: u64,
    /// Witnesses that are off their triangle.
    pub off_triangle: u64,
    /// Witnesses that are not as deep as the lower bound.
    pub too_shallow: u64,
    /// Descriptions of the first of these three kinds of violations.
    pub descriptions: Vec<String>,
}

impl Row {
    /// Returns a row without cases.
    pub fn new(family: Family) -> Row {
        Row {
            family,
            cases: 0,
            touching: 0,
            found_unaided: 0,
            lower_certain: 0,
            too_wide: 0,
            max_excess_width: Worst::default(),
            above: Worst::default(),
            below: Worst::default(),
            upper_violations: 0,
            off_triangle: 0,
            too_shallow: 0,
            descriptions: Vec::new(),
        }
    }

    /// Adds the cases of another row.
    pub fn add(&mut self, other: Row) {
        self.cases += other.cases;
        self.touching += other.touching;
        self.found_unaided += other.found_unaided;
        self.lower_certain += other.lower_certain;
        self.too_wide += other.too_wide;
        self.max_excess_width.update(other.max_excess_width);
        self.above.update(other.above);
        self.below.update(other.below);
        self.upper_violations += other.upper_violations;
        self.off_triangle += other.off_triangle;
        self.too_shallow += other.too_shallow;
        self.descriptions.extend(other.descriptions);
        self.descriptions.truncate(MAX_LISTED);
    }

    /// Returns the number of wrong answers.
    pub fn violations(&self) -> u64 {
        self.upper_violations + self.off_triangle + self.too_shallow
    }

    fn list_violation(&mut self, description: String) {
        if self.descriptions.len() < MAX_LISTED {
            self.descriptions.push(description);
        }
    }
}

/// The tools, and the seed of the random cases.
pub struct RoundingCheck {
    cutters: Vec<Cutter>,
    seed: u64,
    /// The fraction of the rounding and tolerance added at each end that is removed before the answer is validated. It
    /// is 0 except in tests that the validation rejects a bound that is too tight.
    pub tightening: f64,
}

impl RoundingCheck {
    /// Compiles all tools.
    ///
    /// # Panics
    /// If the compiler rejects one.
    pub fn new(seed: u64) -> RoundingCheck {
        let cutter = |number| cutters::cutter(number).expect("a tool that compiles");
        RoundingCheck { cutters: (0..cutters::COUNT).map(cutter).collect(), seed, tightening: 0.0 }
    }

    /// Queries the case with this number and adds the result to the row of its family.
    ///
    /// # Panics
    /// If the certifier rejects the tool.
    pub fn run_case(&self, number: u64, rows: &mut [Row]) {
        let mut rng = Rng::new(self.seed ^ number.wrapping_mul(0xa076_1d64_78bd_642f));
        let family_index = number as usize % Family::ALL.len();
        let cutter = &self.cutters[rng.bits() as usize % self.cutters.len()];
        let case = cases::case(Family::ALL[family_index], cutter, &mut rng);
        let vertices = case.triangles.iter().flatten().map(|corner| Point3::from(*corner));
        let ids = (0..case.triangles.len() as u32).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]);
        // A mesh needs a positive area; a sliver may have none.
        let Ok(mesh) = Mesh::new(vertices.collect(), ids.collect(), Unit::Millimetre) else {
            return;
        };
        let bvh = TriangleBvh::new(&mesh);
        let mut certifier = Certifier::new(&bvh, &cutter.tool).expect("a tool with a profile");
        let penetration = certifier.deepest(&case.pose, case.tolerance);
        let scene = Scene::new(cutter, &case.pose, &case.triangles);
        let validation = Validation {
            case: &case,
            scene: &scene,
            interval: [penetration.depth.low, penetration.depth.high],
            tightening: self.tightening,
        };
        validation.run(penetration.witness, &mut rng, &mut rows[family_index], number);
    }

    /// Returns a readable description of the case with this number.
    pub fn describe(&self, number: u64) -> String {
        let mut rng = Rng::new(self.seed ^ number.wrapping_mul(0xa076_1d64_78bd_642f));
        let family = Family::ALL[number as usize % Family::ALL.len()];
        let cutter = &self.cutters[rng.bits() as usize % self.cutters.len()];
        format!("{} {:?}", cutter.name, cases::case(family, cutter, &mut rng))
    }
}

/// An answer to validate.
struct Validation<'a> {
    case: &'a Case,
    scene: &'a Scene<'a>,
    interval: [f64; 2],
    tightening: f64,
}

impl Validation<'_> {
    fn run(&self, witness: Option<Witness>, rng: &mut Rng, row: &mut Row, number: u64) {
        let [rounding, skew] = self.promised_widening();
        let widening = rounding + skew;
        let tolerance = self.case.tolerance.max(4.0 * rounding);
        let [mut low, mut high] = self.interval;
        if self.tightening > 0.0 && low > 0.0 {
            low += self.tightening * (rounding + widening);
            high -= self.tightening * (tolerance + widening);
        }
        let size = self.scene.cutter.extent[0].max(self.scene.cutter.extent[1]);
        let unaided_depth = self.scene.exact_depth(&self.scene.deepest(rng));
        let is_near = &unaided_depth + &Big::exactly(1e-9 * size + widening) >= Big::exactly(low);
        let nearest = witness.map(|witness| self.nearest_to(&witness));
        let true_depth = self.best_depth(unaided_depth, nearest.as_ref(), rng);
        row.cases += 1;
        row.touching += u64::from(true_depth > Big::zero());
        row.found_unaided += u64::from(is_near);
        row.lower_certain += u64::from(Big::exactly(low) <= true_depth);
        let excess_width = high - low - tolerance - rounding - 2.0 * widening;
        row.too_wide += u64::from(excess_width > 0.01 * widening);
        let worst_of = |value: f64| Worst { value, case: number };
        row.max_excess_width.update(worst_of(excess_width / widening));
        let describe =
            || format!("case {number}: [{low:e}, {high:e}], {} in 256 bits", true_depth.to_f64());
        if !(0.0 <= low && high.is_finite()) || true_depth > Big::exactly(high) {
            row.upper_violations += 1;
            row.list_violation(format!("{}: above it", describe()));
        }
        let Some(NearestPoint { point_on_triangle, distance, rounding_distance }) = nearest else {
            if low > 0.0 {
                row.too_shallow += 1;
                row.list_violation(format!("{}: no witness", describe()));
            }
            return;
        };
        let depth = self.scene.exact_depth(&point_on_triangle);
        if distance > rounding_distance + widening {
            row.off_triangle += 1;
            row.list_violation(format!(
                "{}: the witness is {distance:e} off its triangle",
                describe()
            ));
        } else if low > 0.0
            && Big::exactly(low) > &depth + &Big::exactly(distance + rounding_distance)
        {
            row.too_shallow += 1;
            row.list_violation(format!("{}: the witness is {:e} deep", describe(), depth.to_f64()));
        }
        if low > 0.0 {
            // The certifier subtracts two roundings and the skew from the depth that it computed. It adds one rounding,
            // the skew and the tolerance.
            let skewed = (0.5 * (high - low - tolerance - 3.0 * rounding)).clamp(0.0, skew);
            let [subtracted, added] = [2.0, 1.0].map(|factor| factor * rounding + skewed);
            let error = (&true_depth - &Big::exactly(low + subtracted)).to_f64();
            row.above.update(worst_of((error - tolerance) / added));
            row.below.update(worst_of((-error - rounding_distance) / subtracted));
        }
    }

    /// Returns the largest 256-bit depth of the search result, of the point next to the witness and of a climb from
    /// there, or 0 if none is inside.
    fn best_depth(&self, unaided_depth: Big, nearest: Option<&NearestPoint>, rng: &mut Rng) -> Big {
        let mut true_depth = if unaided_depth.is_negative() { Big::zero() } else { unaided_depth };
        let Some(NearestPoint { point_on_triangle, distance, rounding_distance }) = nearest else {
            return true_depth;
        };
        let step = 1e-3_f64
            .min(1e3 * (distance + rounding_distance) / self.scene.cutter.extent[0] + 1e-12);
        let climbed = self.scene.climb(point_on_triangle, step, 60, rng).1;
        for point_on_triangle in [*point_on_triangle, climbed] {
            let depth = self.scene.exact_depth(&point_on_triangle);
            if depth > true_depth {
                true_depth = depth;
            }
        }
        true_depth
    }

    /// Returns the promised rounding and the promised skew. The rounding is 64 ε of the tool's reach plus the part's
    /// size. The skew is the largest over the triangles of `12 ε r s/h`, or of the triangle's height `h` if that is
    /// less.
    fn promised_widening(&self) -> [f64; 2] {
        let corners = || self.case.triangles.iter().flatten();
        let extent = [0, 1, 2].map(|axis| {
            let coordinates = || corners().map(|corner| corner[axis]);
            coordinates().fold(f64::NEG_INFINITY, f64::max)
                - coordinates().fold(f64::INFINITY, f64::min)
        });
        let part_size = extent.into_iter().fold(0.0, f64::max);
        let skew = self.scene.triangles.iter().map(skew).fold(0.0, f64::max);
        [64.0 * f64::EPSILON * (self.scene.cutter.reach + part_size), skew]
    }

    /// Returns the point of the witness's triangle that is approximately nearest to the witness.
    fn nearest_to(&self, witness: &Witness) -> NearestPoint {
        let (tip, rotation) = (self.case.pose.tip(), self.case.pose.rotation());
        let tool_point: Point = (rotation.transpose() * (witness.point - tip)).into();
        let point_on_triangle = self.scene.nearest(witness.triangle.index(), tool_point);
        let point = self.scene.point(&point_on_triangle);
        let distance = (0..3).map(|k| (tool_point[k] - point[k]).powi(2)).sum::<f64>().sqrt();
        let max_coordinate =
            tool_point.iter().fold(0.0f64, |max, coordinate| max.max(coordinate.abs()));
        NearestPoint {
            point_on_triangle,
            distance,
            rounding_distance: 8.0 * f64::EPSILON * (tip.coords.amax() + max_coordinate),
        }
    }
}

/// A point of a triangle next to a witness.
struct NearestPoint {
    point_on_triangle: TrianglePoint,
    /// The distance between the two.
    distance: f64,
    /// The distance by which rounding in the world frame may have moved the witness.
    rounding_distance: f64,
}

/// Returns the promised error bound of the line of greatest depth in a triangle: `12 ε r s/h`, at most `h`. `r` is the
/// distance of the farthest corner from the tip, `s` the shortest edge and `h` the height over the longest edge.
fn skew(corners: &[Point; 3]) -> f64 {
    let edge = |a: Point, b: Point| [0, 1, 2].map(|k| b[k] - a[k]);
    let norm = |v: Point| v.iter().map(|component| component * component).sum::<f64>().sqrt();
    let [a, b, c] = *corners;
    let edges = [edge(a, b), edge(b, c), edge(c, a)];
    let longest = edges.iter().copied().map(norm).fold(0.0, f64::max);
    let shortest = edges.iter().copied().map(norm).fold(f64::INFINITY, f64::min);
    let ([x, y, z], [u, v, w]) = (edges[0], edges[1]);
    let area = norm([y * w - z * v, z * u - x * w, x * v - y * u]);
    let height = if longest > 0.0 { area / longest } else { 0.0 };
    let max_distance = corners.iter().copied().map(norm).fold(0.0, f64::max);
    // Differences of corners that were rounded once determine the height to within a few units of rounding.
    let height = height + 8.0 * f64::EPSILON * longest;
    (12.0 * f64::EPSILON * max_distance * (shortest / height)).min(height)
}

/// Returns the rows as Markdown tables, with a list of violations.
///
/// # Errors
/// Never in practice: writing to a string cannot fail.
pub fn table(rows: &[Row]) -> Result<String, std::fmt::Error> {
    let mut page = "| family | cases | in contact | found alone | low certain | above | below | wider | widest | exceeded | off | shallow |\n\
                    |---|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|\n"
        .to_owned();
    for row in rows {
        let share = |count: u64| 100.0 * count as f64 / row.cases.max(1) as f64;
        writeln!(
            page,
            "| {:?} | {} | {} | {:.3} % | {:.3} % | {:.3} | {:.3} | {} | {:.1e} | {} | {} | {} |",
            row.family,
            row.cases,
            row.touching,
            share(row.found_unaided),
            share(row.lower_certain),
            row.above.value,
            row.below.value,
            row.too_wide,
            row.max_excess_width.value,
            row.upper_violations,
            row.off_triangle,
            row.too_shallow
        )?;
    }
    let sum = |value: fn(&Row) -> u64| rows.iter().map(value).sum::<u64>();
    writeln!(
        page,
        "\n{} cases, {} of them in contact, {} wider, {} violations.\n\n## Violated\n",
        sum(|row| row.cases),
        sum(|row| row.touching),
        sum(|row| row.too_wide),
        sum(Row::violations)
    )?;
    if rows.iter().all(|row| row.violations() == 0) {
        page += "Nothing.\n";
    }
    for text in rows.iter().flat_map(|row| &row.descriptions) {
        writeln!(page, "- {text}")?;
    }
    page += "\n## Cases with the largest figures\n\n| family | above | below | widest |\n|---|--:|--:|--:|\n";
    for Row { family, above, below, max_excess_width, .. } in rows {
        writeln!(
            page,
            "| {family:?} | {} | {} | {} |",
            above.case, below.case, max_excess_width.case
        )?;
    }
    Ok(page)
}
