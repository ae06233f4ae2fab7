//! The greatest depth of a tool during a motion, by sampling many times and points.
//!
//! Each time is sampled as a pose. A triangle whose centre is shallower than the best sample by more than the
//! triangle's radius is skipped; the others are sampled. From the best samples a search climbs in time and position at
//! once.

use super::brute::{Brute, GROUP, Point, Seen, nearest};
use nalgebra::Point3;
use touchoff::{Pose, TriangleId};
use touchoff_tests::oracle::Oracle;
use touchoff_tests::oracle::draw::Rng;

/// Maximum number of triangles sampled per pose, and number of samples per triangle.
const TRIANGLES: usize = 40;
const SAMPLES: usize = 6;
/// Number of times that are refined, number of refinements of each, number of starts of the search, and number of its
/// steps.
const CLOSER: usize = 5;
const AGAIN: usize = 6;
const STARTS: usize = 6;
const STEPS: usize = 700;

/// A tool's motion, as it is specified.
#[derive(Clone, Copy, Debug)]
pub struct Way {
    /// The first pose.
    pub from: Pose,
    /// The last pose.
    pub to: Pose,
}

impl Way {
    /// Returns the pose at parameter `t` in 0 to 1, with the axis by Shoemake's formula.
    ///
    /// # Panics
    /// If the axes are antiparallel.
    pub fn pose(&self, t: f64) -> Pose {
        let (a, b) = (self.from.axis(), self.to.axis());
        let angle = self.angle();
        let axis = if angle > 0.0 {
            (((1.0 - t) * angle).sin() * a + (t * angle).sin() * b) / angle.sin()
        } else {
            a
        };
        let tip = (1.0 - t) * self.from.tip().coords + t * self.to.tip().coords;
        Pose::from_axis(Point3::from(tip), axis).expect("axes that are not opposite")
    }

    /// Returns the angle between the first and the last axis, rad.
    pub fn angle(&self) -> f64 {
        let (a, b) = (self.from.axis(), self.to.axis());
        2.0 * (b - a).norm().atan2((b + a).norm())
    }
}

/// A sample of a motion.
#[derive(Clone, Copy, Debug)]
pub struct Closest {
    /// The time, 0 to 1.
    pub t: f64,
    /// The index of the triangle.
    pub triangle: usize,
    /// The point, in the part's frame.
    pub point: Point,
    /// The depth in the part's unit; minus the distance if the point is outside.
    pub depth: f64,
}

fn point(of: Point3<f64>) -> Point {
    [of.x, of.y, of.z]
}

impl Brute<'_> {
    fn evaluation(&self, seen: &Seen, p: Point) -> f64 {
        self.depth(self.to_tool(seen, Point3::from(p))) * self.length
    }

    /// Returns the deepest sample at a time.
    pub fn at(&self, way: &Way, t: f64, draw: &mut Rng) -> Closest {
        let seen = self.seen(&way.pose(t));
        let [radius, height] = self.oracle.extent();
        let mut best = Closest { t, triangle: 0, point: [f64::NAN; 3], depth: f64::NEG_INFINITY };
        // Upper bound of the depth in a ball, from its distance to the tool's bounding cylinder.
        let at_most = |(middle, reach): &(Point3<f64>, f64)| {
            let p = self.to_tool(&seen, *middle);
            let out = (p[0].hypot(p[1]) - radius).max(0.0);
            let beyond = (p[2] - height).max(-p[2]).max(0.0);
            reach - (out * out + beyond * beyond).sqrt() * self.length
        };
        let bounds = self.groups.iter().map(at_most).enumerate();
        let mut groups: Vec<(usize, f64)> = bounds.collect();
        groups.sort_by(|a, b| b.1.total_cmp(&a.1));
        let mut near = Vec::new();
        for (group, bound) in groups {
            if bound < best.depth {
                break;
            }
            for id in GROUP * group..(GROUP * (group + 1)).min(self.balls.len()) {
                let (middle, reach) = &self.balls[id];
                if at_most(&self.balls[id]) < best.depth {
                    continue;
                }
                let depth = self.evaluation(&seen, point(*middle));
                near.push((depth + reach, id));
                if depth > best.depth {
                    best = Closest { t, triangle: id, point: point(*middle), depth };
                }
            }
        }
        near.sort_by(|a, b| b.0.total_cmp(&a.0));
        for (bound, id) in near.into_iter().take(TRIANGLES) {
            if bound < best.depth {
                break;
            }
            let corners = self.mesh.triangle(TriangleId(id as u32)).map(point);
            let (tip, turn) = (way.pose(t).tip(), *way.pose(t).rotation());
            let mut points = corners.to_vec();
            for _ in 0..SAMPLES {
                let mut across = || draw.between(-1.0, 1.0) * radius;
                let (x, y) = (across(), across());
                let z = draw.between(0.0, 1.0) * if draw.bits() & 1 == 0 { height } else { radius };
                let inside = tip + turn * nalgebra::Vector3::new(x, y, z) * self.length;
                points.push(nearest(point(inside), &corners));
            }
            for p in points {
                let depth = self.evaluation(&seen, p);
                if depth > best.depth {
                    best = Closest { t, triangle: id, point: p, depth };
                }
            }
        }
        best
    }

    /// Returns the deepest sample of a whole motion, at `times` random times and at both ends. If `closely`, also
    /// refines around the best of them.
    pub fn closest(&self, way: &Way, times: u32, closely: bool, draw: &mut Rng) -> Closest {
        let step = 1.0 / f64::from(times);
        let middle = |k| (f64::from(k) + draw.between(0.0, 1.0)) * step;
        let mut at: Vec<f64> = (0..times).map(middle).collect();
        at.extend([0.0, 1.0]);
        let mut found: Vec<Closest> = at.into_iter().map(|t| self.at(way, t, draw)).collect();
        let deepest = |found: &mut Vec<Closest>| found.sort_by(|a, b| b.depth.total_cmp(&a.depth));
        deepest(&mut found);
        for k in 0..if closely { CLOSER.min(found.len()) } else { 0 } {
            for _ in 0..AGAIN {
                let t = (found[k].t + draw.between(-step, step)).clamp(0.0, 1.0);
                found.push(self.at(way, t, draw));
            }
        }
        deepest(&mut found);
        let starts = found.iter().take(if closely { STARTS } else { 1 });
        let climbed = starts.map(|from| self.climb_on(way, *from, step, draw));
        climbed.fold(found[0], |best, other| if other.depth > best.depth { other } else { best })
    }

    /// Climbs in time and position from a sample, and returns the deepest sample reached.
    fn climb_on(&self, way: &Way, from: Closest, step: f64, draw: &mut Rng) -> Closest {
        let corners = self.mesh.triangle(TriangleId(from.triangle as u32)).map(point);
        let mut best = from;
        let (mut part, mut wide) =
            (step, self.balls[from.triangle].1.min(self.length * self.oracle.extent()[0]));
        let mut failed = 0;
        for k in 0..STEPS {
            if part < 1e-17 && wide < 1e-14 {
                break;
            }
            let go = if k % 3 == 0 { 0.0 } else { part * draw.between(-1.0, 1.0) };
            let t = (best.t + go).clamp(0.0, 1.0);
            let aside = if k % 3 == 1 { 0.0 } else { wide };
            let turn = draw.direction();
            let p = nearest([0, 1, 2].map(|axis| best.point[axis] + aside * turn[axis]), &corners);
            let depth = self.evaluation(&self.seen(&way.pose(t)), p);
            if depth > best.depth {
                best = Closest { t, point: p, depth, ..best };
                failed = 0;
                (part, wide) = ((1.3 * part).min(step), 1.3 * wide);
            } else {
                failed += 1;
                if failed % 5 == 0 {
                    (part, wide) = (0.6 * part, 0.6 * wide);
                }
            }
        }
        best
    }
}
