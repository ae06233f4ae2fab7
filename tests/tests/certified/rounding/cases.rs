//! Random triangles, poses and tolerances for which rounding errors are largest.

use super::cutters::Cutter;
use super::truth::Point;
use crate::prelude::*;
use touchoff_tests::oracle::vector::{self, add, sub, unit, vector_product};

type MeridianPoint = vector::Point<f64>;

/// Returns the triangles of a case, which are about as large as a number, in the tool's frame.
type Triangles = fn(&Sketch<'_>, f64, &mut Rng) -> Vec<[Point; 3]>;

/// The families of cases, in the order in which case numbers cycle through them: a triangle
/// - through a point of the tool, with any orientation;
/// - of a height of 1e-13 to 1e-2 of its length;
/// - with collinear or equal corners, beside a sound triangle;
/// - with a corner, an edge or its face at a point whose nearest point is a joint of the profile;
/// - the same at the centre of an arc, or on the axis;
/// - normal to the axis, at the height of a joint or a centre of the profile, or at any height;
/// - in a plane that is tangent to the profile, or off by 1e-17 to 1e-6 of the tool's radius;
/// - whose size is 1e-6 to 1e6 of the tool's radius;
///
/// and several triangles around a point whose nearest point is a joint of the profile.
const PLAIN: [Triangles; 9] = [
    |sketch, size, rng| vec![sketch.triangle_in_any_orientation(size, rng)],
    |sketch, _, rng| {
        let height = [1e-8, 1e-12, rng.power(-13.0, -2.0)][rng.index(3)];
        vec![sketch.sliver(height, rng)]
    },
    |sketch, size, rng| {
        vec![sketch.degenerate(rng), sketch.triangle_in_any_orientation(0.1 * size, rng)]
    },
    |sketch, size, rng| vec![sketch.joint(size, rng)],
    |sketch, _, rng| vec![sketch.centre(rng)],
    |sketch, _, rng| vec![sketch.level(rng)],
    |sketch, _, rng| vec![sketch.tangent(rng)],
    |sketch, _, rng| {
        let size = sketch.radius * rng.power(-6.0, 6.0);
        match rng.bits() % 2 {
            0 => vec![sketch.triangle_in_any_orientation(size, rng)],
            _ => vec![sketch.joint(size, rng)],
        }
    },
    |sketch, _, rng| sketch.fan(rng),
];

/// The number of families. Two more are any of these with the tip 1 to 1e12 tool sizes away from the origin, and with a
/// rotation composed of many rotations.
pub(crate) const FAMILIES: usize = PLAIN.len() + 2;
const FAR: usize = PLAIN.len();
const DRIFT: usize = FAR + 1;

#[derive(Clone, Debug)]
pub(crate) struct Case {
    /// The triangles, in the world frame.
    pub(crate) triangles: Vec<[Point; 3]>,
    pub(crate) pose: Pose,
    /// The tolerance, in the unit of the triangles.
    pub(crate) tolerance: f64,
}

/// Returns a random triangle of about this size and with this normal. `point` is a corner, on an edge or inside.
fn triangle_at(point: Point, normal: Point, size: f64, rng: &mut Rng) -> [Point; 3] {
    let first = rng.across(normal);
    let second = vector_product(&normal, &first);
    let (width, height) = (size * rng.between(0.2, 1.0), size * rng.between(0.2, 1.0));
    let shift = size * rng.between(-0.5, 1.0);
    let fraction = rng.between(0.0, 1.0);
    let weights = match rng.bits() % 3 {
        0 => [1.0, 0.0, 0.0],
        1 => [1.0 - fraction, fraction, 0.0],
        _ => [0.4, 0.6 * fraction, 0.6 - 0.6 * fraction],
    };
    let corners = [[0.0, 0.0], [width, 0.0], [shift, height]];
    let base = [0, 1].map(|k| weights.iter().zip(&corners).map(|(w, p)| w * p[k]).sum::<f64>());
    corners.map(|p| add(&add(&point, &first, &(p[0] - base[0])), &second, &(p[1] - base[1])))
}

/// A tool for which cases are generated, and its largest radius.
struct Sketch<'a> {
    cutter: &'a Cutter,
    radius: f64,
}

impl Sketch<'_> {
    /// Rotates a point `[d, z]` and a vector with radial and axial components about the axis by one random angle.
    fn revolve(point: MeridianPoint, vector: MeridianPoint, rng: &mut Rng) -> (Point, Point) {
        let [cos, sin] = match rng.bits() % 4 {
            0 => [1.0, 0.0],
            1 => [0.0, 1.0],
            _ => rng.azimuth(),
        };
        let to_space = |[d, z]: MeridianPoint| [d * cos, d * sin, z];
        (to_space(point), to_space(vector))
    }

    /// Returns a point inside the tool or slightly outside, mostly near the tip.
    fn random_point(&self, rng: &mut Rng) -> Point {
        let height = self.cutter.extent[1];
        let max_height = if rng.once_in(2) { height } else { height.min(self.radius) };
        let point = [rng.between(0.0, self.radius), rng.between(-0.02, 1.0) * max_height];
        Self::revolve(point, [1.0, 0.0], rng).0
    }

    fn triangle_in_any_orientation(&self, size: f64, rng: &mut Rng) -> [Point; 3] {
        triangle_at(self.random_point(rng), rng.direction(), size, rng)
    }

    /// Returns a random size of the order of the tool's radius.
    fn size(&self, rng: &mut Rng) -> f64 {
        self.radius * rng.power(-1.5, 1.5)
    }

    fn sliver(&self, height: f64, rng: &mut Rng) -> [Point; 3] {
        let (point, direction) = (self.random_point(rng), rng.direction());
        let (length, fraction) = (self.size(rng), rng.between(-0.5, 1.5));
        let start = add(&point, &direction, &(-length * rng.between(0.0, 1.0)));
        let below = add(&start, &direction, &(fraction * length));
        let third = add(&below, &rng.across(direction), &(height * length));
        [start, add(&start, &direction, &length), third]
    }

    fn degenerate(&self, rng: &mut Rng) -> [Point; 3] {
        let [a, b, c] = self.sliver(0.0, rng);
        match rng.bits() % 4 {
            0 => [a, b, a],
            1 => [b, b, b],
            _ => [a, b, c],
        }
    }

    /// Returns a point under a joint of the profile and the outward direction there, between the two normals.
    fn under_joint(&self, rng: &mut Rng) -> (Point, Point) {
        let profile = &self.cutter.profile;
        let k = 1 + rng.index(profile.segments().len() - 1);
        let joint = profile.vertex(k);
        let [a, b] = [k - 1, k].map(|k| profile.segments()[k].outward(joint));
        let share = [0.0, 1.0, 0.5, rng.between(0.0, 1.0)][rng.index(4)];
        let direction = unit(&add(&a, &sub(&b, &a), &share));
        let depth = self.radius * [0.0, rng.power(-12.0, 0.0)][rng.index(2)];
        let [d, z] = add(joint, &direction, &-depth);
        Self::revolve([d.max(0.0), z], direction, rng)
    }

    fn joint(&self, size: f64, rng: &mut Rng) -> [Point; 3] {
        let (point, outward_direction) = self.under_joint(rng);
        let normal = if rng.once_in(2) { outward_direction } else { rng.direction() };
        triangle_at(point, normal, size, rng)
    }

    fn centre(&self, rng: &mut Rng) -> [Point; 3] {
        let centres = self.cutter.profile.segments().iter().filter_map(|segment| segment.centre());
        let axis = [0.0, rng.between(0.0, self.cutter.extent[1])];
        let points: Vec<MeridianPoint> =
            centres.filter(|point| point[0] >= 0.0).copied().chain([axis]).collect();
        let (point, direction) = Self::revolve(rng.pick(&points), rng.azimuth(), rng);
        let normal = if rng.once_in(2) { direction } else { rng.direction() };
        triangle_at(point, normal, self.size(rng), rng)
    }

    fn level(&self, rng: &mut Rng) -> [Point; 3] {
        let mut point = self.random_point(rng);
        let segments = self.cutter.profile.segments();
        let segment = &segments[rng.index(segments.len())];
        let centre = segment.centre().unwrap_or(&segment.to);
        point[2] = rng.pick(&[point[2], segment.from[1], segment.to[1], centre[1]]);
        let mut triangle = triangle_at(point, [0.0, 0.0, 1.0], self.size(rng), rng);
        triangle.iter_mut().for_each(|corner| corner[2] = point[2]);
        triangle
    }

    fn tangent(&self, rng: &mut Rng) -> [Point; 3] {
        let segments = self.cutter.profile.segments();
        let segment = &segments[rng.index(segments.len())];
        let surface_point = segment.at(rng.between(0.0, 1.0));
        let normal = segment.outward(&surface_point);
        let offset = match rng.bits() % 3 {
            0 => 0.0,
            1 => rng.power(-17.0, -6.0),
            _ => -rng.power(-17.0, -6.0),
        };
        let [d, z] = add(&surface_point, &normal, &(offset * self.radius));
        let (point, normal) = Self::revolve([d.max(0.0), z], normal, rng);
        triangle_at(point, normal, self.size(rng), rng)
    }

    fn fan(&self, rng: &mut Rng) -> Vec<[Point; 3]> {
        let (apex, direction) = self.under_joint(rng);
        let count = 2 + rng.index(4);
        let size = self.size(rng);
        let rim = |rng: &mut Rng| {
            let reach = size * rng.between(0.1, 1.0);
            let base = add(&apex, &rng.across(direction), &reach);
            add(&base, &direction, &(size * rng.between(-0.5, 0.1)))
        };
        let first = rim(rng);
        let mut last = first;
        let mut triangles = Vec::new();
        for k in 0..count {
            let next = if k + 1 == count { first } else { rim(rng) };
            triangles.push([apex, last, next]);
            last = next;
        }
        triangles
    }

    fn triangles(&self, family: usize, rng: &mut Rng) -> Vec<[Point; 3]> {
        let size = self.size(rng);
        match PLAIN.get(family) {
            Some(triangles) => triangles(self, size, rng),
            None => self.triangles(rng.index(PLAIN.len()), rng),
        }
    }
}

/// Returns a random pose: the identity, an axis along a coordinate axis, or any rotation. The tip is within a few tool
/// sizes of the origin, or farther if it is [`FAR`].
fn pose(family: usize, size: f64, rng: &mut Rng) -> Pose {
    let distance = if family == FAR { rng.power(0.0, 12.0) } else { 3.0 };
    let tip = Point3::from(rng.direction()) * (size * distance);
    match rng.bits() % 6 {
        0 if family != FAR => Pose::default(),
        0 | 1 => {
            let mut axis = Vector3::zeros();
            axis[rng.index(3)] = rng.pick(&[1.0, -1.0]);
            Pose::from_axis(tip, axis).expect("an axis")
        }
        2 => {
            // The norm deviates from 1 by almost as much as a pose accepts.
            let quaternion =
                rng.quaternion().map(|component| component * rng.between(0.9991, 1.0009));
            Pose::from_quaternion(tip, quaternion).expect("a quaternion")
        }
        _ => {
            let axis = Vector3::from(rng.direction()) * rng.between(0.9991, 1.0009);
            Pose::from_axis(tip, axis).expect("an axis")
        }
    }
}

/// Returns a pose after many rotations about the origin, some of which are undone immediately.
fn drift(pose: Pose, rng: &mut Rng) -> Pose {
    let mut pose = pose;
    for _ in 0..12 {
        let axis = Vector3::from(rng.direction());
        let step = Pose::from_axis(Point3::origin(), axis).expect("an axis");
        pose = pose.then(&step);
        if rng.once_in(2) {
            pose = pose.relative_to(&step);
        }
    }
    pose
}

pub(crate) fn case(family: usize, cutter: &Cutter, rng: &mut Rng) -> Case {
    let [radius, height] = cutter.extent;
    let triangles = Sketch { cutter, radius }.triangles(family, rng);
    let mut pose = pose(family, radius + height, rng);
    if family == DRIFT {
        pose = drift(pose, rng);
    }
    let to_world = |p: Point| -> Point { (pose.tip() + pose.rotation() * Vector3::from(p)).into() };
    let tolerance = rng.pick(&[0.0, 1e-9]) * radius.max(height);
    Case {
        triangles: triangles.iter().map(|corners| corners.map(to_world)).collect(),
        pose,
        tolerance,
    }
}
