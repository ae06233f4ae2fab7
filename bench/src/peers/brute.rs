//! Brute force over all points: in `f64` with branches, and in `f32` sixteen points at a time.
//!
//! The first method skips points outside the tool's outline by a single comparison. One branch per region, mispredicted
//! for points in no order, would take longer than everything else. The second evaluates the formula of minima and
//! maxima at all points, with the widest SIMD instructions of the machine. The sign of that formula decides, so points
//! within about 1e-6 of the surface may be classified wrongly.

use super::formula;
use super::points::{Point, points};
use crate::race::contender::{Answer, Contender, PoseTransform, Sums};
use fearless_simd::{Level, Simd, SimdBase, SimdMask, dispatch, f32x16};
use touchoff::{Cloud, Pose};

/// All points in `f64`, with branches.
pub struct Scalar {
    /// The coordinates alone, since few points need more data.
    positions: Vec<[f64; 3]>,
    points: Vec<Point>,
}

impl Scalar {
    /// Copies the points of a cloud.
    pub fn new(cloud: &Cloud) -> Scalar {
        let points = points(cloud);
        Scalar { positions: points.iter().map(|point| point.position).collect(), points }
    }
}

impl Contender for Scalar {
    fn name(&self) -> &'static str {
        "brute-f64"
    }

    fn query(&mut self, pose: &Pose) -> Answer {
        let transform = PoseTransform::of(pose);
        let mut sums = Sums::default();
        for (position, point) in self.positions.iter().zip(&self.points) {
            let offset = transform.offset_from_tip(*position);
            let p = transform.to_tool_frame(offset);
            if formula::is_outside_envelope(p) {
                continue;
            }
            if let Some(evaluation) = formula::evaluate(p) {
                sums.add([offset, p], (point.weight, point.normal), evaluation);
            }
        }
        sums.answer(&transform)
    }
}

const WIDTH: usize = 16;

/// All points in `f32`, sixteen at a time.
pub struct Lanes {
    level: Level,
    /// One list of coordinates per axis, padded to full blocks with coordinates far away.
    coordinates: [Vec<f32>; 3],
    points: Vec<Point>,
}

impl Lanes {
    /// Copies the points of a cloud.
    pub fn new(cloud: &Cloud) -> Lanes {
        let points = points(cloud);
        let padded_length = points.len().next_multiple_of(WIDTH);
        let coordinates = [0, 1, 2].map(|axis| {
            let mut padded: Vec<f32> =
                points.iter().map(|point| point.position[axis] as f32).collect();
            padded.resize(padded_length, 1e6);
            padded
        });
        Lanes { level: Level::new(), coordinates, points }
    }

    /// Adds one inside point to the sums. Its coordinates are rounded to single precision; the sums are doubles.
    fn add_point(&self, transform: &PoseTransform, index: usize, sums: &mut Sums) {
        let point = &self.points[index];
        let offset = transform
            .offset_from_tip([0, 1, 2].map(|axis| f64::from(self.coordinates[axis][index])));
        let p = transform.to_tool_frame(offset).map(|c| f64::from(c as f32));
        // Within rounding of the surface the two formulas may disagree about the side.
        let evaluation = formula::evaluate(p).unwrap_or((0.0, [1.0, 0.0, 0.0]));
        sums.add([offset, p], (point.weight, point.normal), evaluation);
    }
}

#[inline(always)]
fn add_points_inside<S: Simd>(simd: S, lanes: &Lanes, transform: &PoseTransform, sums: &mut Sums) {
    let rows = transform.rows_f32();
    let tip = transform.tip.map(|c| c as f32);
    let zero = f32x16::splat(simd, 0.0);
    for block in 0..lanes.coordinates[0].len() / WIDTH {
        let range = block * WIDTH..(block + 1) * WIDTH;
        let lists = [
            &lanes.coordinates[0][range.clone()],
            &lanes.coordinates[1][range.clone()],
            &lanes.coordinates[2][range],
        ];
        let depth = formula::magnitude_from(simd, lists, (rows, tip));
        let mut hits = depth.simd_ge(zero).to_bitmask();
        while hits != 0 {
            lanes.add_point(transform, block * WIDTH + hits.trailing_zeros() as usize, sums);
            hits &= hits - 1;
        }
    }
}

impl Contender for Lanes {
    fn name(&self) -> &'static str {
        "brute-f32"
    }

    fn query(&mut self, pose: &Pose) -> Answer {
        let transform = PoseTransform::of(pose);
        let mut sums = Sums::default();
        dispatch!(self.level, simd => add_points_inside(simd, self, &transform, &mut sums));
        sums.answer(&transform)
    }
}
