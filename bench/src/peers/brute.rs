//! Brute force over all points: in `f64` with branches, and in `f32` sixteen points at a time.
//!
//! The first method skips points outside the tool's outline by a single comparison. One branch per region, mispredicted
//! for points in no order, would take longer than everything else. The second evaluates the formula of minima and
//! maxima at all points, with the widest SIMD instructions of the machine. The sign of that formula decides, so points
//! within about 1e-6 of the surface may be classified wrongly.

use super::formula;
use super::points::{Point, points};
use crate::race::contender::{Answer, Contender, Sums, View};
use fearless_simd::{Level, Simd, SimdBase, SimdMask, dispatch, f32x16};
use touchoff::{Cloud, Pose};

/// All points in `f64`, with branches.
pub struct Scalar {
    /// The coordinates alone, since few points need more data.
    at: Vec<[f64; 3]>,
    points: Vec<Point>,
}

impl Scalar {
    /// Copies the points of a cloud.
    pub fn new(cloud: &Cloud) -> Scalar {
        let points = points(cloud);
        Scalar { at: points.iter().map(|point| point.at).collect(), points }
    }
}

impl Contender for Scalar {
    fn name(&self) -> &'static str {
        "brute-f64"
    }

    fn query(&mut self, pose: &Pose) -> Answer {
        let view = View::of(pose);
        let mut sums = Sums::default();
        for (at, point) in self.at.iter().zip(&self.points) {
            let arm = view.arm(*at);
            let p = view.turn(arm);
            if formula::beside(p) {
                continue;
            }
            if let Some(evaluation) = formula::sense(p) {
                sums.add([arm, p], (point.weight, point.normal), evaluation);
            }
        }
        sums.answer(&view)
    }
}

const WIDTH: usize = 16;

/// All points in `f32`, sixteen at a time.
pub struct Lanes {
    level: Level,
    /// One list of coordinates per axis, padded to full blocks with coordinates far away.
    at: [Vec<f32>; 3],
    points: Vec<Point>,
}

impl Lanes {
    /// Copies the points of a cloud.
    pub fn new(cloud: &Cloud) -> Lanes {
        let points = points(cloud);
        let room = points.len().next_multiple_of(WIDTH);
        let at = [0, 1, 2].map(|axis| {
            let mut list: Vec<f32> = points.iter().map(|point| point.at[axis] as f32).collect();
            list.resize(room, 1e6);
            list
        });
        Lanes { level: Level::new(), at, points }
    }

    /// Adds one inside point to the sums. Its coordinates are rounded to single precision; the sums are doubles.
    fn feel(&self, view: &View, at: usize, sums: &mut Sums) {
        let point = &self.points[at];
        let arm = view.arm([0, 1, 2].map(|axis| f64::from(self.at[axis][at])));
        let p = view.turn(arm).map(|c| f64::from(c as f32));
        // Within rounding of the surface the two formulas may disagree about the side.
        let evaluation = formula::sense(p).unwrap_or((0.0, [1.0, 0.0, 0.0]));
        sums.add([arm, p], (point.weight, point.normal), evaluation);
    }
}

#[inline(always)]
fn inside<S: Simd>(simd: S, lanes: &Lanes, view: &View, sums: &mut Sums) {
    let rows = view.single();
    let tip = view.tip.map(|c| c as f32);
    let zero = f32x16::splat(simd, 0.0);
    for block in 0..lanes.at[0].len() / WIDTH {
        let place = block * WIDTH..(block + 1) * WIDTH;
        let lists = [&lanes.at[0][place.clone()], &lanes.at[1][place.clone()], &lanes.at[2][place]];
        let depth = formula::magnitude_from(simd, lists, (rows, tip));
        let mut hits = depth.simd_ge(zero).to_bitmask();
        while hits != 0 {
            lanes.feel(view, block * WIDTH + hits.trailing_zeros() as usize, sums);
            hits &= hits - 1;
        }
    }
}

impl Contender for Lanes {
    fn name(&self) -> &'static str {
        "brute-f32"
    }

    fn query(&mut self, pose: &Pose) -> Answer {
        let view = View::of(pose);
        let mut sums = Sums::default();
        dispatch!(self.level, simd => inside(simd, self, &view, &mut sums));
        sums.answer(&view)
    }
}
