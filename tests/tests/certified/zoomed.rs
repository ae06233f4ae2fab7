//! Certified depths compared with the largest of millions of samples that zoom in on the deepest points.
//!
//! The first half of the samples are centroids of triangles and of their repeated halves. The next piece is always the
//! one that may have the greatest depth, since depth is Lipschitz. The other samples are drawn around the deepest of
//! these. Their neighbourhoods shrink from round to round until they are as small as rounding. The greatest depth must
//! not exceed the upper bound, and should reach the lower bound, which the search does not know.

use crate::depth_oracle::{DepthOracle, FIELDS, PROFILES};
use crate::pair::{
    IN_CONTACT, Pair, Pairs, QUERIED, REACHED, VIOLATIONS, WIDER, is_full_run, parts,
};
use crate::prelude::*;
use crate::to_tool;
use std::collections::BTreeMap;
use touchoff_tests::oracle::triangle::{Point, bisected, point};
use touchoff_tests::oracle::vector::distance;

/// Number of points that are zoomed in on, at first and at last.
const POINT_COUNTS: [usize; 2] = [48, 6];
/// Ratio of the sizes of successive neighbourhoods.
const SHRINK_FACTOR: f64 = 0.4;

/// A sample: its depth, its triangle, and two of its barycentric weights.
#[derive(Clone, Copy, Debug)]
struct Sample {
    depth: f64,
    triangle: usize,
    weights: [f64; 2],
}

/// A piece of a triangle whose centroid was evaluated.
struct Piece {
    /// No point of the piece is deeper.
    bound: f64,
    radius: f64,
    triangle: usize,
    /// Two barycentric weights of each corner.
    corners: [[f64; 2]; 3],
}

/// Returns a number that is ordered as the double is.
fn ordered(value: f64) -> i64 {
    let bits = value.to_bits().cast_signed();
    if bits < 0 { bits ^ i64::MAX } else { bits }
}

struct Search {
    /// The deepest samples, in the order of their depth.
    best: Vec<Sample>,
    evaluations: u64,
}

impl Search {
    /// Keeps a sample if it is among the deepest.
    fn insert(&mut self, sample: Sample) {
        let best = &mut self.best;
        if best.len() < POINT_COUNTS[0] || sample.depth > best[POINT_COUNTS[0] - 1].depth {
            let index = best.partition_point(|other| other.depth >= sample.depth);
            best.insert(index, sample);
            best.truncate(POINT_COUNTS[0]);
        }
    }
}

impl Pair<'_, DepthOracle> {
    /// Compares certified depths at random poses, with `samples` samples at each pose where a triangle is near.
    fn compare_zoomed(&self, poses: usize, samples: u64) -> Tally {
        let mut rng = Rng::new(self.seed);
        let (mesh, length) = (&self.part.mesh, self.length());
        let [radius, height] = self.oracle.oracle.extent();
        let size = radius.max(height) * length;
        let (tolerance, margin) = (self.oracle.tolerance(size), self.oracle.reach_margin * size);
        let [low, high] = mesh.bounds();
        let part_size = (high - low).norm() + low.coords.amax().max(high.coords.amax());
        let rounding = 64.0 * f64::EPSILON * (size + part_size);
        let mut certifier =
            Certifier::new(&self.part.bvh, self.tool).expect("a tool that is proved");
        let profile = self.oracle.profile.as_ref();
        let brute = profile.map(|nearest| BruteForce::new(mesh, nearest, length));
        let mut tally = Tally::default();
        for _ in 0..poses {
            let pose = match &brute {
                Some(brute) => brute.random_pose(&mut rng),
                None => self.pose_of_field(&mut rng),
            };
            let Interval { low, high } = certifier.deepest(&pose, tolerance).depth;
            let max_depth = (self.deepest(&pose, samples, &mut rng) * length).max(0.0);
            tally.add(QUERIED, 1);
            tally.see(IN_CONTACT, max_depth > 0.0);
            tally.see(REACHED, max_depth >= low - margin);
            let case = format!("{self}: [{low:?}, {high:?}], {max_depth:?} at {pose:?}");
            tally.never(WIDER, high - low > 1.01 * tolerance + 8.0 * rounding, || case.clone());
            tally.never(VIOLATIONS, max_depth > high + rounding, || case.clone());
        }
        tally
    }

    /// Returns a pose, in any orientation, that puts a random point inside the tool's extent at one of the part.
    fn pose_of_field(&self, rng: &mut Rng) -> Pose {
        let (mesh, length) = (&self.part.mesh, self.length());
        let id = (rng.bits() as usize % mesh.triangles().len()) as u32;
        let [a, b, c] = mesh.triangle(TriangleId(id));
        let (v, w) = (rng.between(0.0, 0.5), rng.between(0.0, 0.5));
        let target = a + v * (b - a) + w * (c - a);
        let [radius, height] = self.oracle.oracle.extent();
        let (d, direction) = (rng.between(0.0, radius), rng.direction());
        let inside =
            Vector3::new(d * direction[0], d * direction[1], rng.between(0.0, height)) * length;
        let rotated =
            Pose::from_quaternion(Point3::origin(), rng.quaternion()).expect("a quaternion");
        rotated
            .translated(target.coords - rotated.rotation() * inside)
            .expect("a place near the part")
    }

    /// Returns the greatest depth of the samples, in the tool's unit, or negative infinity without a triangle nearby.
    fn deepest(&self, pose: &Pose, samples: u64, rng: &mut Rng) -> f64 {
        let triangles = self.nearby_triangles(pose);
        if triangles.is_empty() {
            return f64::NEG_INFINITY;
        }
        let mut search = Search { best: Vec::new(), evaluations: 0 };
        let mut reach = self.bisect(&triangles, samples / 2, &mut search);
        let Search { mut best, mut evaluations } = search;
        let [radius, height] = self.oracle.oracle.extent();
        let size = radius.max(height);
        let rounds = ((1e-15 * size / reach).ln() / SHRINK_FACTOR.ln()).ceil().max(1.0) as u64;
        for round in 0..rounds {
            let count =
                (samples.saturating_sub(evaluations) / (rounds - round)) / best.len() as u64;
            for sample in &mut best {
                for _ in 0..count {
                    self.sample_nearby(&triangles[sample.triangle], reach, sample, rng);
                }
            }
            evaluations += count * best.len() as u64;
            best.sort_by(|a, b| b.depth.total_cmp(&a.depth));
            best.truncate((best.len() * 3 / 4).max(POINT_COUNTS[1]));
            reach *= SHRINK_FACTOR;
        }
        best[0].depth
    }

    /// Bisects triangles by up to `count` samples. Returns the size of the neighbourhoods to start with.
    fn bisect(&self, triangles: &[[Point; 3]], count: u64, search: &mut Search) -> f64 {
        // The piece with the greatest bound is last.
        let mut pieces = BTreeMap::new();
        let key = |piece: &Piece, number: u64| (ordered(piece.bound), number);
        for (triangle, corners) in triangles.iter().enumerate() {
            let corner_weights = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
            for weights in corner_weights {
                let depth = self.oracle.depth(point(corners, weights));
                search.insert(Sample { depth, triangle, weights });
            }
            let piece = self.piece(triangles, triangle, corner_weights, search);
            search.evaluations += 4;
            pieces.insert(key(&piece, search.evaluations), piece);
        }
        let mut reach = f64::INFINITY;
        while let Some((_, piece)) = pieces.pop_last()
            && search.evaluations < count
            && piece.bound > search.best[0].depth
        {
            let at = |weights| point(&triangles[piece.triangle], weights);
            let length = |a, b| distance(&at(a), &at(b));
            let middle = |a: [f64; 2], b: [f64; 2]| [0, 1].map(|k| 0.5 * (a[k] + b[k]));
            for half in bisected(piece.corners, length, middle) {
                let half = self.piece(triangles, piece.triangle, half, search);
                reach = half.radius;
                search.evaluations += 1;
                if half.bound > search.best[0].depth {
                    pieces.insert(key(&half, search.evaluations), half);
                }
            }
        }
        let extent = self.oracle.oracle.extent();
        (4.0 * reach).min(extent[0].max(extent[1]))
    }

    /// Samples a piece's centroid, and returns the piece.
    fn piece(
        &self,
        triangles: &[[Point; 3]],
        triangle: usize,
        corners: [[f64; 2]; 3],
        search: &mut Search,
    ) -> Piece {
        let weights = [0, 1].map(|k| (corners[0][k] + corners[1][k] + corners[2][k]) / 3.0);
        let centroid = point(&triangles[triangle], weights);
        let depth = self.oracle.depth(centroid);
        search.insert(Sample { depth, triangle, weights });
        let radii = corners.map(|corner| distance(&centroid, &point(&triangles[triangle], corner)));
        let radius = radii[0].max(radii[1]).max(radii[2]);
        let lipschitz = self.oracle.lipschitz_bound;
        // Outside, the depth is minus the distance, which is 1-Lipschitz; it can be steeper only inside.
        let bound =
            if depth < 0.0 { lipschitz * (depth + radius) } else { depth + lipschitz * radius };
        Piece { bound, radius, triangle, corners }
    }

    /// Returns the triangles whose boxes overlap the tool's box, in the tool's frame and unit.
    fn nearby_triangles(&self, pose: &Pose) -> Vec<[Point; 3]> {
        let length = self.length();
        let [radius, height] = self.oracle.oracle.extent();
        let to_tool_frame = |p| to_tool(pose, length, p);
        let overlaps = |corners: &[Point; 3]| {
            let tool_box = [[-radius, radius], [-radius, radius], [0.0, height]];
            (0..3).all(|axis| {
                let coordinates = corners.map(|corner| corner[axis]);
                let low = coordinates[0].min(coordinates[1]).min(coordinates[2]);
                let high = coordinates[0].max(coordinates[1]).max(coordinates[2]);
                low <= tool_box[axis][1] && high >= tool_box[axis][0]
            })
        };
        let all = triangles(&self.part.mesh).map(|corners| corners.map(to_tool_frame));
        all.filter(overlaps).collect()
    }

    /// Draws a sample in the neighbourhood of another, and replaces that one if the new sample is deeper.
    fn sample_nearby(&self, corners: &[Point; 3], reach: f64, best: &mut Sample, rng: &mut Rng) {
        let [a, b, c] = corners;
        let step = |to: &Point| {
            let length = distance(to, a);
            if length > reach { reach / length } else { 1.0 }
        };
        let [v, w] = best.weights;
        let mut weights = [
            (v + step(b) * rng.between(-1.0, 1.0)).max(0.0),
            (w + step(c) * rng.between(-1.0, 1.0)).max(0.0),
        ];
        let sum = weights[0] + weights[1];
        if sum > 1.0 {
            weights = weights.map(|component| component / sum);
        }
        let depth = self.oracle.depth(point(corners, weights));
        if depth > best.depth {
            *best = Sample { depth, weights, ..*best };
        }
    }
}

#[test]
fn samples_that_zoom_in_are_within_the_interval() {
    let is_full = is_full_run("ZOOMED");
    let (poses, samples) = (case_count("ZOOMED", 4), if is_full { 1_000_000 } else { 40_000 });
    let mut parts = parts("ZOOMED");
    let mut tools = PROFILES.to_vec();
    if is_full {
        tools.extend(FIELDS);
    } else {
        // The thousands of slivers in the tube need more samples than a test can afford.
        parts.retain(|part| part.name != "tube");
        tools.extend(["Fig73", "UnitSphere", "Block"]);
    }
    let pairs = Pairs { parts: &parts, tools: &tools, seed: 3 };
    let tallies = pairs.compare(DepthOracle::of, |pair| pair.compare_zoomed(poses, samples));
    let total: Tally = tallies.into_iter().sum();
    eprintln!("samples that zoom in: {total}");
    total.assert_none(VIOLATIONS);
    total.assert_none(WIDER);
    assert!(10 * total.count(REACHED) > 9 * total.count(QUERIED), "{total}");
}
