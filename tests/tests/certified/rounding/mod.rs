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

mod cases;
mod cutters;
mod truth;

use crate::pair::{IN_CONTACT, QUERIED, REACHED, WIDER};
use crate::prelude::*;
use cases::{Case, FAMILIES};
use cutters::Cutter;
use rayon::prelude::*;
use touchoff_tests::oracle::big::Big;
use touchoff_tests::oracle::vector::{distance, norm, sub, vector_product};
use truth::{Point, Scene, TrianglePoint};

/// Number of cases of all families together, unless `CASES` is set.
const CASES: usize = 33_000;
const SEED: u64 = 7;

/// Names of further counts: an upper bound below a depth in 256 bits, or an interval that is negative or not finite; a witness
/// off its triangle, or not as deep as the lower bound. A text has the tool, the triangles, the pose and the answer.
const UPPER: &str = "violations of upper bounds";
const LOWER: &str = "violations of lower bounds";

struct RoundingCheck {
    cutters: Vec<Cutter>,
    /// The fraction of the rounding and tolerance added at each end that is removed before the answer is validated. It
    /// is 0 except in tests that the validation rejects a bound that is too tight.
    tightening: f64,
}

impl RoundingCheck {
    fn new(tightening: f64) -> RoundingCheck {
        let cutter = |number| cutters::cutter(number).expect("a tool that compiles");
        RoundingCheck { cutters: (0..cutters::COUNT).map(cutter).collect(), tightening }
    }

    /// Queries the cases of a family, given by its index, that have numbers below `count`.
    fn run(&self, family: usize, count: usize) -> Tally {
        let numbers = (family..count).into_par_iter().step_by(FAMILIES);
        numbers.map(|number| self.run_case(number)).sum()
    }

    fn run_case(&self, number: usize) -> Tally {
        let mut rng = Rng::new(SEED ^ (number as u64).wrapping_mul(0xa076_1d64_78bd_642f));
        let cutter = &self.cutters[rng.index(self.cutters.len())];
        let case = cases::case(number % FAMILIES, cutter, &mut rng);
        let mut tally = Tally::default();
        let vertices = case.triangles.iter().flatten().map(|corner| Point3::from(*corner));
        let ids = (0..case.triangles.len() as u32).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]);
        // A mesh needs a positive area; a sliver may have none.
        let Ok(mesh) = Mesh::new(vertices, ids, Unit::Millimetre) else {
            return tally;
        };
        let bvh = TriangleBvh::new(&mesh);
        let mut certifier = Certifier::new(&bvh, &cutter.tool).expect("a tool with a profile");
        let penetration = certifier.deepest(&case.pose, case.tolerance);
        let scene = Scene::new(cutter, &case.pose, &case.triangles);
        let validation = Validation {
            number,
            case: &case,
            scene: &scene,
            interval: penetration.depth,
            tightening: self.tightening,
        };
        validation.run(penetration.witness, &mut rng, &mut tally);
        tally
    }
}

struct Validation<'a> {
    number: usize,
    case: &'a Case,
    scene: &'a Scene<'a>,
    interval: Interval,
    tightening: f64,
}

impl Validation<'_> {
    fn run(&self, witness: Option<Witness>, rng: &mut Rng, tally: &mut Tally) {
        let Widening { rounding, skew } = self.promised_widening();
        let widening = rounding + skew;
        let tolerance = self.case.tolerance.max(4.0 * rounding);
        let Interval { mut low, mut high } = self.interval;
        if self.tightening > 0.0 && low > 0.0 {
            low += self.tightening * (rounding + widening);
            high -= self.tightening * (tolerance + widening);
        }
        let size = self.scene.cutter.extent[0].max(self.scene.cutter.extent[1]);
        let unaided_depth = self.scene.exact_depth(&self.scene.deepest(rng));
        let is_near = &unaided_depth + &Big::exactly(1e-9 * size + widening) >= Big::exactly(low);
        let nearest = witness.map(|witness| self.nearest_to(&witness));
        let true_depth = self.best_depth(unaided_depth, nearest.as_ref(), rng);
        tally.add(QUERIED, 1);
        tally.see(IN_CONTACT, true_depth > Big::zero());
        tally.see(REACHED, is_near);
        let describe = || {
            let Validation { number, case, scene, .. } = self;
            format!(
                "case {number}: {} {case:?}: [{low:?}, {high:?}], {:?} in 256 bits, witness {witness:?}",
                scene.cutter.name,
                true_depth.to_f64()
            )
        };
        let excess = high - low - tolerance - rounding - 2.0 * widening;
        tally.never(WIDER, excess > 0.01 * widening, describe);
        let is_above = !(0.0 <= low && high.is_finite()) || true_depth > Big::exactly(high);
        tally.never(UPPER, is_above, describe);
        let Some(NearestPoint { point_on_triangle, distance, rounding_distance }) = nearest else {
            return tally.never(LOWER, low > 0.0, || format!("no witness: {}", describe()));
        };
        let depth = self.scene.exact_depth(&point_on_triangle);
        if distance > rounding_distance + widening {
            let text = format!("the witness is {distance:e} off its triangle: {}", describe());
            tally.find(LOWER, text);
        } else if low > 0.0
            && Big::exactly(low) > &depth + &Big::exactly(distance + rounding_distance)
        {
            let text = format!("the witness is {:e} deep: {}", depth.to_f64(), describe());
            tally.find(LOWER, text);
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
        let climbed = self.scene.climb(point_on_triangle, step, 60, rng).point;
        for point_on_triangle in [*point_on_triangle, climbed] {
            let depth = self.scene.exact_depth(&point_on_triangle);
            if depth > true_depth {
                true_depth = depth;
            }
        }
        true_depth
    }

    /// Returns the promised widening, from the sizes of tool and part and from the triangles.
    fn promised_widening(&self) -> Widening {
        let corners = || self.case.triangles.iter().flatten();
        let extent = [0, 1, 2].map(|axis| {
            let coordinates = || corners().map(|corner| corner[axis]);
            coordinates().fold(f64::NEG_INFINITY, f64::max)
                - coordinates().fold(f64::INFINITY, f64::min)
        });
        let part_size = extent.into_iter().fold(0.0, f64::max);
        let skew = self.scene.triangles.iter().map(skew).fold(0.0, f64::max);
        Widening { rounding: 64.0 * f64::EPSILON * (self.scene.cutter.reach + part_size), skew }
    }

    /// Returns the point of the witness's triangle that is approximately nearest to the witness.
    fn nearest_to(&self, witness: &Witness) -> NearestPoint {
        let (tip, rotation) = (self.case.pose.tip(), self.case.pose.rotation());
        let tool_point: Point = (rotation.transpose() * (witness.point - tip)).into();
        let point_on_triangle = self.scene.nearest(witness.triangle.index(), tool_point);
        let point = self.scene.point(&point_on_triangle);
        let max_coordinate =
            tool_point.iter().fold(0.0f64, |max, coordinate| max.max(coordinate.abs()));
        NearestPoint {
            point_on_triangle,
            distance: distance(&tool_point, &point),
            rounding_distance: 8.0 * f64::EPSILON * (tip.coords.amax() + max_coordinate),
        }
    }
}

/// The most that the certifier may add to an interval at either end.
struct Widening {
    /// 64 ε of the tool's reach plus the part's size.
    rounding: f64,
    /// The largest over the triangles of `12 ε r s/h`, or of the triangle's height `h` if that is less.
    skew: f64,
}

struct NearestPoint {
    point_on_triangle: TrianglePoint,
    distance: f64,
    /// The distance by which rounding in the world frame may have moved the witness.
    rounding_distance: f64,
}

/// Returns the promised error bound of the line of greatest depth in a triangle: `12 ε r s/h`, at most `h`. `r` is the
/// distance of the farthest corner from the tip, `s` the shortest edge and `h` the height over the longest edge.
fn skew(corners: &[Point; 3]) -> f64 {
    let [a, b, c] = corners;
    let edges = [sub(b, a), sub(c, b), sub(a, c)];
    let longest = edges.iter().map(norm).fold(0.0, f64::max);
    let shortest = edges.iter().map(norm).fold(f64::INFINITY, f64::min);
    let area = norm(&vector_product(&edges[0], &edges[1]));
    let height = if longest > 0.0 { area / longest } else { 0.0 };
    let max_distance = corners.iter().map(norm).fold(0.0, f64::max);
    // Rounded corners determine the height to within this.
    let rounding = 8.0 * f64::EPSILON * max_distance;
    let least = (height - rounding).max(0.0);
    (12.0 * f64::EPSILON * max_distance * (shortest / least)).min(height + rounding)
}

#[test]
fn depths_in_256_bits_are_within_the_intervals() {
    let count = case_count("CASES", CASES);
    let check = RoundingCheck::new(0.0);
    let families: Vec<Tally> = (0..FAMILIES).map(|family| check.run(family, count)).collect();
    let total: Tally = families.iter().cloned().sum();
    eprintln!("256 bits: {total}");
    total.assert_none(UPPER);
    total.assert_none(LOWER);
    total.assert_none(WIDER);
    for (family, tally) in families.iter().enumerate() {
        let cases = tally.count(QUERIED);
        // A sliver without an area is no mesh.
        assert!(30 * cases > 29 * (count / FAMILIES) as u64, "family {family}: {tally}");
        assert!(3 * tally.count(IN_CONTACT) > cases, "family {family}: {tally}");
        // A search that seldom comes near the lower bound would not contradict an upper bound either.
        assert!(2 * tally.count(REACHED) > cases, "family {family}: {tally}");
    }
}

/// If the bounds lack what is added for rounding, the validation reports violations in each family.
#[test]
fn bounds_without_widening_are_reported_as_violations() {
    let check = RoundingCheck::new(1.0);
    for family in 0..FAMILIES {
        let tally = check.run(family, 2_200);
        assert!(20 * tally.count(UPPER) > tally.count(QUERIED), "family {family}: {tally}");
    }
}
