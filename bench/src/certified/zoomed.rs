//! Certified depths compared with the largest of millions of samples that zoom in on the deepest points.
//!
//! The first half of the samples are centroids of triangles and of their repeated halves. The next piece is always the
//! one that may have the greatest depth, since depth is Lipschitz. The other samples are drawn around the deepest of
//! these. Their neighbourhoods shrink from round to round until they are as small as rounding. The greatest depth must
//! not exceed the upper bound, and should reach the lower bound, which the search does not know.

use super::depth_oracle::DepthOracle;
use super::{Worst, enclosed, poses};
use nalgebra::{Point3, Vector3};
use std::cmp::Ordering;
use std::collections::BinaryHeap;
use std::fmt::Write;
use touchoff::certify::{Certifier, TriangleBvh};
use touchoff::{Interval, Mesh, Pose, Tool, TriangleId};
use touchoff_tests::oracle::rng::Rng;

/// A point of the tool's frame.
type Point = [f64; 3];

/// Number of points that are zoomed in on, at first and at last.
const POINT_COUNTS: [usize; 2] = [48, 6];
/// Ratio of the sizes of successive neighbourhoods.
const SHRINK_FACTOR: f64 = 0.4;
/// A part, a tool and its oracle.
pub struct Zoomed<'a> {
    /// The part's name in messages.
    pub part: &'a str,
    /// The part.
    pub mesh: &'a Mesh,
    /// The part's triangles in a bounding volume hierarchy.
    pub bvh: &'a TriangleBvh,
    /// The tool.
    pub tool: &'a dyn Tool,
    /// The oracle of the tool.
    pub depth_oracle: &'a DepthOracle,
}

/// The results for a tool and a part. Lengths are shares of the tool's size.
#[derive(Clone, Debug, Default)]
pub struct Row {
    /// The tool's name.
    pub tool: String,
    /// The part's name.
    pub part: String,
    /// Number of poses queried.
    pub poses: usize,
    /// Number of poses at which a sample is inside the tool.
    pub touching: usize,
    /// Number of samples.
    pub samples: u64,
    /// Excess of a sample's depth over the upper bound. More than rounding is a violation.
    pub upper_excess: Worst,
    /// Excess of the lower bound over the samples' greatest depth.
    pub sample_deficit: Worst,
    /// Number of poses at which the samples come near enough to the lower bound.
    pub reached: usize,
    /// The width of the widest interval.
    pub max_width: Worst,
    /// Number of intervals wider than tolerance and rounding together.
    pub too_wide: usize,
    /// Poses at which a sample exceeds the upper bound.
    pub violations: Vec<String>,
}

/// A sample: its depth, its triangle, and two of its barycentric weights.
#[derive(Clone, Copy, Debug)]
struct Sample {
    depth: f64,
    triangle: usize,
    weights: [f64; 2],
}

/// A piece of a triangle whose centroid was evaluated. No point of it is deeper than the bound.
struct Piece {
    bound: f64,
    triangle: usize,
    /// Two barycentric weights of each corner.
    corners: [[f64; 2]; 3],
}

impl Ord for Piece {
    fn cmp(&self, other: &Piece) -> Ordering {
        self.bound.total_cmp(&other.bound)
    }
}

impl PartialOrd for Piece {
    fn partial_cmp(&self, other: &Piece) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Piece {
    fn eq(&self, other: &Piece) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Piece {}

impl Zoomed<'_> {
    /// Compares random poses, with `samples` samples at each pose where a triangle is near.
    ///
    /// # Panics
    /// If the certifier rejects the tool.
    pub fn measure(&self, poses: usize, samples: u64, seed: u64) -> Row {
        let mut rng = Rng::new(seed);
        let info = self.tool.info();
        let length = info.unit.factor_to(self.mesh.unit());
        let [radius, height] = self.depth_oracle.oracle().extent();
        let size = radius.max(height) * length;
        let [tolerance, margin] = self.depth_oracle.tolerance(size);
        let [low, high] = self.mesh.bounds();
        let part = (high - low).norm() + low.coords.amax().max(high.coords.amax());
        let rounding = 64.0 * f64::EPSILON * (size + part);
        let mut certifier = Certifier::new(self.bvh, self.tool).expect("a tool that is proved");
        let (tool, part) = (info.name.to_string(), self.part.to_owned());
        let mut row = Row { tool, part, poses, ..Row::default() };
        for _ in 0..poses {
            let pose = self.pose(length, &mut rng);
            let Interval { low, high } = certifier.deepest(&pose, tolerance).depth;
            let (deepest, evaluations) = self.deepest(&pose, samples, &mut rng);
            let max_depth = (deepest * length).max(0.0);
            row.samples += evaluations;
            row.touching += usize::from(max_depth > 0.0);
            row.reached += usize::from(max_depth >= low - margin);
            let case = format!(
                "{} in {}: [{low:e}, {high:e}], {max_depth:e} at {pose:?}",
                row.tool, row.part
            );
            row.upper_excess.update((max_depth - high) / size, || case.clone());
            row.sample_deficit.update((low - max_depth) / size, || case.clone());
            row.max_width.update((high - low) / size, || case.clone());
            row.too_wide += usize::from(high - low > 1.01 * tolerance + 8.0 * rounding);
            if max_depth > high + rounding {
                row.violations.push(case);
            }
        }
        row
    }

    /// Returns a pose at which the tool is likely to touch the part.
    fn pose(&self, length: f64, rng: &mut Rng) -> Pose {
        if let DepthOracle::Profile(nearest, _) = self.depth_oracle {
            return poses::pose(self.mesh, nearest, length, rng);
        }
        // A random point inside the tool's extent is placed at a random point of the part.
        let [a, b, c] = self
            .mesh
            .triangle(TriangleId((rng.bits() as usize % self.mesh.triangles().len()) as u32));
        let (v, w) = (rng.between(0.0, 0.5), rng.between(0.0, 0.5));
        let target = a + v * (b - a) + w * (c - a);
        let [radius, height] = self.depth_oracle.oracle().extent();
        let (d, direction) = (rng.between(0.0, radius), rng.direction());
        let inside =
            Vector3::new(d * direction[0], d * direction[1], rng.between(0.0, height)) * length;
        let quaternion = loop {
            let quaternion = [0; 4].map(|_| rng.between(-1.0, 1.0));
            let norm = quaternion.iter().map(|component| component * component).sum::<f64>().sqrt();
            if (0.1..=1.0).contains(&norm) {
                break quaternion.map(|component| component / norm);
            }
        };
        let rotated = Pose::from_quaternion(Point3::origin(), quaternion).expect("a quaternion");
        rotated
            .translated(target.coords - rotated.rotation() * inside)
            .expect("a place near the part")
    }

    /// Returns the greatest depth of the samples, in the tool's unit, and their number. Without a triangle nearby the
    /// depth is negative infinity and the number 0.
    fn deepest(&self, pose: &Pose, samples: u64, rng: &mut Rng) -> (f64, u64) {
        let triangles = self.nearby_triangles(pose);
        if triangles.is_empty() {
            return (f64::NEG_INFINITY, 0);
        }
        let mut evaluations = 0;
        let (mut best, mut reach) = self.bisect(&triangles, samples / 2, &mut evaluations);
        let [radius, height] = self.depth_oracle.oracle().extent();
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
        (best[0].depth, evaluations)
    }

    /// Bisects triangles. Returns the deepest centroids, and the size of the neighbourhoods to start with.
    fn bisect(
        &self,
        triangles: &[[Point; 3]],
        count: u64,
        evaluations: &mut u64,
    ) -> (Vec<Sample>, f64) {
        let mut best: Vec<Sample> = Vec::new();
        let mut pieces = BinaryHeap::new();
        for triangle in 0..triangles.len() {
            let corners = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
            for weights in corners {
                let depth = self.depth_oracle.depth(point(&triangles[triangle], weights));
                insert_sorted(&mut best, Sample { depth, triangle, weights });
            }
            pieces.push(self.piece(triangles, triangle, corners, &mut best).0);
            *evaluations += 4;
        }
        let mut reach = f64::INFINITY;
        while let Some(piece) = pieces.pop()
            && *evaluations < count
            && piece.bound > best[0].depth
        {
            for piece_half in bisect_longest_edge(&triangles[piece.triangle], piece.corners) {
                let (piece_half, radius) =
                    self.piece(triangles, piece.triangle, piece_half, &mut best);
                reach = radius;
                if piece_half.bound > best[0].depth {
                    pieces.push(piece_half);
                }
            }
            *evaluations += 2;
        }
        let extent = self.depth_oracle.oracle().extent();
        (best, (4.0 * reach).min(extent[0].max(extent[1])))
    }

    /// Evaluates a piece's centroid, and returns the piece and its radius about the centroid.
    fn piece(
        &self,
        triangles: &[[Point; 3]],
        triangle: usize,
        corners: [[f64; 2]; 3],
        best: &mut Vec<Sample>,
    ) -> (Piece, f64) {
        let weights = [0, 1].map(|k| (corners[0][k] + corners[1][k] + corners[2][k]) / 3.0);
        let centroid = point(&triangles[triangle], weights);
        let depth = self.depth_oracle.depth(centroid);
        insert_sorted(best, Sample { depth, triangle, weights });
        let radii = corners.map(|corner| distance(centroid, point(&triangles[triangle], corner)));
        let reach = radii[0].max(radii[1]).max(radii[2]);
        let lipschitz = self.depth_oracle.lipschitz_bound();
        // Outside, the depth is minus the distance, which is 1-Lipschitz; it can be steeper only inside.
        let bound =
            if depth < 0.0 { lipschitz * (depth + reach) } else { depth + lipschitz * reach };
        (Piece { bound, triangle, corners }, reach)
    }

    /// Returns the triangles whose boxes overlap the tool's box, in the tool's frame and unit.
    fn nearby_triangles(&self, pose: &Pose) -> Vec<[Point; 3]> {
        let length = self.tool.info().unit.factor_to(self.mesh.unit());
        let [radius, height] = self.depth_oracle.oracle().extent();
        let to_tool = pose.rotation().transpose();
        let to_tool_frame =
            |p: Point3<f64>| -> Point { (to_tool * (p - pose.tip()) / length).into() };
        let overlaps = |corners: &[Point; 3]| {
            let tool_box = [[-radius, radius], [-radius, radius], [0.0, height]];
            (0..3).all(|axis| {
                let coordinates = corners.map(|corner| corner[axis]);
                let low = coordinates[0].min(coordinates[1]).min(coordinates[2]);
                let high = coordinates[0].max(coordinates[1]).max(coordinates[2]);
                low <= tool_box[axis][1] && high >= tool_box[axis][0]
            })
        };
        let ids = 0..self.mesh.triangles().len() as u32;
        ids.map(|id| self.mesh.triangle(TriangleId(id)).map(to_tool_frame))
            .filter(overlaps)
            .collect()
    }

    /// Draws a sample in the neighbourhood of another, and replaces that one if the new sample is deeper.
    fn sample_nearby(&self, corners: &[Point; 3], reach: f64, best: &mut Sample, rng: &mut Rng) {
        let [a, b, c] = corners;
        let step = |to: &Point| {
            let edge = [0, 1, 2].map(|k| to[k] - a[k]);
            let length = edge.iter().map(|component| component * component).sum::<f64>().sqrt();
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
        let depth = self.depth_oracle.depth(point(corners, weights));
        if depth > best.depth {
            *best = Sample { depth, weights, ..*best };
        }
    }
}

/// Inserts a sample into the sorted list of the deepest.
fn insert_sorted(best: &mut Vec<Sample>, sample: Sample) {
    if best.len() < POINT_COUNTS[0] || sample.depth > best[POINT_COUNTS[0] - 1].depth {
        let index = best.partition_point(|other| other.depth >= sample.depth);
        best.insert(index, sample);
        best.truncate(POINT_COUNTS[0]);
    }
}

/// Bisects a piece at its longest edge.
fn bisect_longest_edge(triangle: &[Point; 3], corners: [[f64; 2]; 3]) -> [[[f64; 2]; 3]; 2] {
    let points = corners.map(|corner| point(triangle, corner));
    let lengths = [0, 1, 2].map(|k| distance(points[k], points[(k + 1) % 3]));
    let k = (0..3).max_by(|a, b| lengths[*a].total_cmp(&lengths[*b])).unwrap_or(0);
    let [a, b, c] = [0, 1, 2].map(|step| corners[(k + step) % 3]);
    let middle = [0, 1].map(|axis| 0.5 * (a[axis] + b[axis]));
    [[a, middle, c], [middle, b, c]]
}

fn distance(a: Point, b: Point) -> f64 {
    let difference = [0, 1, 2].map(|k| b[k] - a[k]);
    difference.iter().map(|component| component * component).sum::<f64>().sqrt()
}

/// Returns the point of a triangle with two barycentric weights.
fn point([a, b, c]: &[Point; 3], [v, w]: [f64; 2]) -> Point {
    [0, 1, 2].map(|k| a[k] + v * (b[k] - a[k]) + w * (c[k] - a[k]))
}

/// Returns the rows and those of tools inside blocks as Markdown tables, with a list of violations.
///
/// # Errors
/// Never in practice: writing to a string cannot fail.
pub fn table(rows: &[Row], blocks: &[enclosed::Row]) -> Result<String, std::fmt::Error> {
    let mut page =
        "| tool | part | poses | in contact | worst over | worst behind | reached | widest | wider | violations |\n\
                    |---|---|--:|--:|--:|--:|--:|--:|--:|--:|\n"
            .to_owned();
    for row in rows {
        let [upper_excess, sample_deficit, max_width] =
            [&row.upper_excess, &row.sample_deficit, &row.max_width].map(|worst| worst.value);
        writeln!(
            page,
            "| {} | {} | {} | {} | {upper_excess:.1e} | {sample_deficit:.1e} | {} | {max_width:.1e} | {} | {} |",
            row.tool,
            row.part,
            row.poses,
            row.touching,
            row.reached,
            row.too_wide,
            row.violations.len()
        )?;
    }
    let sum = |value: fn(&Row) -> u64| rows.iter().map(value).sum::<u64>();
    let poses = sum(|row| row.poses as u64);
    let reached = sum(|row| row.reached as u64);
    writeln!(
        page,
        "\n{poses} poses, {} of them in contact, {} samples; at {reached}, {:.1} %, they reach the lower bound; {} intervals are wider.\n",
        sum(|row| row.touching as u64),
        sum(|row| row.samples),
        100.0 * reached as f64 / poses.max(1) as f64,
        sum(|row| row.too_wide as u64)
    )?;
    page += "### Inside the material\n\nBlocks of which one face is 1e-7 to 0.1 of the tool's size beyond its extent, or cuts it by as much; of fields 0.01 to 0.1.\n\n\
             | tool | inside | verdict inside | cut | verdict touching | violations |\n|---|--:|--:|--:|--:|--:|\n";
    for enclosed::Row { tool, inside, cut, violations } in blocks {
        let [[a, b], [c, d]] = [inside, cut];
        writeln!(page, "| {tool} | {a} | {b} | {c} | {d} | {} |", violations.len())?;
    }
    page += "\n## Violated\n\n";
    let violated = rows.iter().flat_map(|row| &row.violations);
    let violated: Vec<&String> =
        violated.chain(blocks.iter().flat_map(|row| &row.violations)).collect();
    if violated.is_empty() {
        page += "Nothing.\n";
    }
    for violation in violated {
        writeln!(page, "- {violation}")?;
    }
    Ok(page)
}
