//! Random triangles, poses and tolerances for which rounding errors are largest.

use super::cutters::Cutter;
use super::truth::Point;
use nalgebra::{Point3, Vector3};
use std::f64::consts::TAU;
use touchoff::Pose;
use touchoff_tests::oracle::draw::Rng;
use touchoff_tests::oracle::outline::{Flat, Segment};

/// A family of test cases.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Family {
    /// A triangle through a point of the tool, with any orientation.
    Any,
    /// Slivers: heights of 1e-13 to 1e-2 of the length.
    Sliver,
    /// A triangle with collinear or equal corners, beside a sound triangle.
    Degenerate,
    /// A corner, an edge or a face at a point whose nearest point is a joint of the profile.
    Joint,
    /// The same at the centre of an arc, or on the axis.
    Centre,
    /// A triangle normal to the axis, at the height of a joint or a centre of the profile, or at any height.
    Level,
    /// A triangle in a plane that is tangent to the profile, or off by 1e-17 to 1e-6 of the tool's radius.
    Tangent,
    /// A triangle whose size is 1e-6 to 1e6 of the tool's radius.
    Size,
    /// Several triangles around a point whose nearest point is a joint of the profile.
    Fan,
    /// One of the former, with the tip 1 to 1e12 tool sizes away from the origin.
    Far,
    /// One of the former, with a rotation composed of many rotations.
    Drift,
}

impl Family {
    /// All families, in the order in which case numbers cycle through them.
    pub const ALL: [Family; 11] = [
        Family::Any,
        Family::Sliver,
        Family::Degenerate,
        Family::Joint,
        Family::Centre,
        Family::Level,
        Family::Tangent,
        Family::Size,
        Family::Fan,
        Family::Far,
        Family::Drift,
    ];
}

/// A query to the certifier.
#[derive(Clone, Debug)]
pub struct Case {
    /// The triangles, in the world frame.
    pub triangles: Vec<[Point; 3]>,
    /// The tool's pose.
    pub pose: Pose,
    /// The tolerance, in the unit of the triangles.
    pub tolerance: f64,
}

/// Returns a power of ten with a random exponent between two numbers.
fn magnitude(low: f64, high: f64, draw: &mut Rng) -> f64 {
    10f64.powf(draw.between(low, high))
}

fn one_of<T: Copy>(list: &[T], draw: &mut Rng) -> T {
    list[draw.bits() as usize % list.len()]
}

fn toward(at: Point, step: f64, way: Point) -> Point {
    [0, 1, 2].map(|k| at[k] + step * way[k])
}

/// Returns a random unit vector perpendicular to `way`.
fn beside(way: Point, draw: &mut Rng) -> Point {
    loop {
        let other = draw.direction();
        let along = way[0] * other[0] + way[1] * other[1] + way[2] * other[2];
        let across = toward(other, -along, way);
        let size = across.iter().map(|part| part * part).sum::<f64>().sqrt();
        if size > 0.1 {
            return across.map(|part| part / size);
        }
    }
}

/// Returns a random triangle of about this size and with this normal. The point `at` is a corner, on an edge or inside.
fn about(at: Point, normal: Point, size: f64, draw: &mut Rng) -> [Point; 3] {
    let first = beside(normal, draw);
    let second = [
        normal[1] * first[2] - normal[2] * first[1],
        normal[2] * first[0] - normal[0] * first[2],
        normal[0] * first[1] - normal[1] * first[0],
    ];
    let (across, up) = (size * draw.between(0.2, 1.0), size * draw.between(0.2, 1.0));
    let shift = size * draw.between(-0.5, 1.0);
    let part = draw.between(0.0, 1.0);
    let weights = match draw.bits() % 3 {
        0 => [1.0, 0.0, 0.0],
        1 => [1.0 - part, part, 0.0],
        _ => [0.4, 0.6 * part, 0.6 - 0.6 * part],
    };
    let flat = [[0.0, 0.0], [across, 0.0], [shift, up]];
    let base = [0, 1].map(|k| weights.iter().zip(&flat).map(|(w, p)| w * p[k]).sum::<f64>());
    flat.map(|p| toward(toward(at, p[0] - base[0], first), p[1] - base[1], second))
}

/// A tool for which cases are generated, and its largest radius.
struct Sketch<'a> {
    cutter: &'a Cutter,
    radius: f64,
}

impl Sketch<'_> {
    /// Rotates a point `[d, z]` and a vector with radial and axial components about the axis by one random angle.
    fn turned(at: Flat, way: Flat, draw: &mut Rng) -> (Point, Point) {
        let (sin, cos) = match draw.bits() % 4 {
            0 => (0.0, 1.0),
            1 => (1.0, 0.0),
            _ => draw.between(0.0, TAU).sin_cos(),
        };
        let lift = |[d, z]: Flat| [d * cos, d * sin, z];
        (lift(at), lift(way))
    }

    /// Returns a point inside the tool or slightly outside, mostly near the tip.
    fn place(&self, draw: &mut Rng) -> Point {
        let height = self.cutter.extent[1];
        let high = if draw.bits().is_multiple_of(2) { height } else { height.min(self.radius) };
        let at = [draw.between(0.0, self.radius), draw.between(-0.02, 1.0) * high];
        Self::turned(at, [1.0, 0.0], draw).0
    }

    fn any(&self, size: f64, draw: &mut Rng) -> [Point; 3] {
        about(self.place(draw), draw.direction(), size, draw)
    }

    /// Returns a random size of the order of the tool's radius.
    fn size(&self, draw: &mut Rng) -> f64 {
        self.radius * magnitude(-1.5, 1.5, draw)
    }

    fn sliver(&self, height: f64, draw: &mut Rng) -> [Point; 3] {
        let (at, along) = (self.place(draw), draw.direction());
        let (length, part) = (self.size(draw), draw.between(-0.5, 1.5));
        let from = toward(at, -length * draw.between(0.0, 1.0), along);
        let third =
            toward(toward(from, part * length, along), height * length, beside(along, draw));
        [from, toward(from, length, along), third]
    }

    fn degenerate(&self, draw: &mut Rng) -> [Point; 3] {
        let [a, b, c] = self.sliver(0.0, draw);
        match draw.bits() % 4 {
            0 => [a, b, a],
            1 => [b, b, b],
            _ => [a, b, c],
        }
    }

    /// Returns a point under a joint of the profile and the outward direction there, between the two normals.
    fn under_joint(&self, draw: &mut Rng) -> (Point, Point) {
        let segments = &self.cutter.outline.segments;
        let k = 1 + draw.bits() as usize % (segments.len() - 1);
        let ([a, b], part) = (
            [outward(&segments[k - 1], 1.0), outward(&segments[k], 0.0)],
            one_of(&[0.0, 1.0, 0.5, draw.between(0.0, 1.0)], draw),
        );
        let way = unit([a[0] + part * (b[0] - a[0]), a[1] + part * (b[1] - a[1])]);
        let deep = self.radius * one_of(&[0.0, magnitude(-12.0, 0.0, draw)], draw);
        let joint = segments[k].from;
        let at = [(joint[0] - deep * way[0]).max(0.0), joint[1] - deep * way[1]];
        Self::turned(at, way, draw)
    }

    fn joint(&self, size: f64, draw: &mut Rng) -> [Point; 3] {
        let (at, way) = self.under_joint(draw);
        let normal = if draw.bits().is_multiple_of(2) { way } else { draw.direction() };
        about(at, normal, size, draw)
    }

    fn centre(&self, draw: &mut Rng) -> [Point; 3] {
        let centres = self.cutter.outline.segments.iter().filter_map(|segment| segment.centre);
        let axis = [0.0, draw.between(0.0, self.cutter.extent[1])];
        let places: Vec<Flat> = centres.filter(|at| at[0] >= 0.0).chain([axis]).collect();
        let turn = draw.between(0.0, TAU).sin_cos();
        let (at, way) = Self::turned(one_of(&places, draw), [turn.0, turn.1], draw);
        let normal = if draw.bits().is_multiple_of(2) { way } else { draw.direction() };
        about(at, normal, self.size(draw), draw)
    }

    fn level(&self, draw: &mut Rng) -> [Point; 3] {
        let mut at = self.place(draw);
        let segment = one_of(&self.cutter.outline.segments, draw);
        let centre = segment.centre.unwrap_or(segment.to);
        at[2] = one_of(&[at[2], segment.from[1], segment.to[1], centre[1]], draw);
        let mut triangle = about(at, [0.0, 0.0, 1.0], self.size(draw), draw);
        triangle.iter_mut().for_each(|corner| corner[2] = at[2]);
        triangle
    }

    fn tangent(&self, draw: &mut Rng) -> [Point; 3] {
        let segment = one_of(&self.cutter.outline.segments, draw);
        let part = draw.between(0.0, 1.0);
        let way = outward(&segment, part);
        let off = match draw.bits() % 3 {
            0 => 0.0,
            1 => magnitude(-17.0, -6.0, draw),
            _ => -magnitude(-17.0, -6.0, draw),
        };
        let mut on = [0, 1].map(|k| segment.from[k] + part * (segment.to[k] - segment.from[k]));
        if let Some(centre) = segment.centre {
            let arm = [on[0] - centre[0], on[1] - centre[1]];
            let radius = (segment.from[0] - centre[0]).hypot(segment.from[1] - centre[1]);
            let reach = radius / arm[0].hypot(arm[1]);
            on = [centre[0] + reach * arm[0], centre[1] + reach * arm[1]];
        }
        let off = off * self.radius;
        let at = [(on[0] + off * way[0]).max(0.0), on[1] + off * way[1]];
        let (at, way) = Self::turned(at, way, draw);
        about(at, way, self.size(draw), draw)
    }

    fn fan(&self, draw: &mut Rng) -> Vec<[Point; 3]> {
        let (at, way) = self.under_joint(draw);
        let count = 2 + draw.bits() as usize % 4;
        let size = self.size(draw);
        let rim = |draw: &mut Rng| {
            let across = toward(at, size * draw.between(0.1, 1.0), beside(way, draw));
            toward(across, size * draw.between(-0.5, 0.1), way)
        };
        let first = rim(draw);
        let mut last = first;
        let mut triangles = Vec::new();
        for k in 0..count {
            let next = if k + 1 == count { first } else { rim(draw) };
            triangles.push([at, last, next]);
            last = next;
        }
        triangles
    }

    fn triangles(&self, family: Family, draw: &mut Rng) -> Vec<[Point; 3]> {
        let size = self.size(draw);
        match family {
            Family::Any => vec![self.any(size, draw)],
            Family::Sliver => {
                let height = one_of(&[1e-8, 1e-12, magnitude(-13.0, -2.0, draw)], draw);
                vec![self.sliver(height, draw)]
            }
            Family::Degenerate => vec![self.degenerate(draw), self.any(0.1 * size, draw)],
            Family::Joint => vec![self.joint(size, draw)],
            Family::Centre => vec![self.centre(draw)],
            Family::Level => vec![self.level(draw)],
            Family::Tangent => vec![self.tangent(draw)],
            Family::Size => {
                let size = self.radius * magnitude(-6.0, 6.0, draw);
                match draw.bits() % 2 {
                    0 => vec![self.any(size, draw)],
                    _ => vec![self.joint(size, draw)],
                }
            }
            Family::Fan => self.fan(draw),
            Family::Far | Family::Drift => {
                let plain = &Family::ALL[..9];
                self.triangles(one_of(plain, draw), draw)
            }
        }
    }
}

fn unit(v: Flat) -> Flat {
    let size = v[0].hypot(v[1]);
    if size > 0.0 { v.map(|part| part / size) } else { [0.0, 1.0] }
}

/// Returns the unit normal of a profile segment, out of the material, at parameter `part` in 0 to 1.
fn outward(segment: &Segment, part: f64) -> Flat {
    let ([a, b], [c, d]) = (segment.from, segment.to);
    let at = [a + part * (c - a), b + part * (d - b)];
    let Some(centre) = segment.centre else { return unit([d - b, a - c]) };
    let arm = unit([at[0] - centre[0], at[1] - centre[1]]);
    if segment.is_hollow() { arm.map(|part| -part) } else { arm }
}

/// Returns a random pose: the identity, an axis along a coordinate axis, or any rotation. The tip is within a few tool
/// sizes of the origin, or farther for [`Family::Far`].
fn pose(family: Family, size: f64, draw: &mut Rng) -> Pose {
    let far = if family == Family::Far { magnitude(0.0, 12.0, draw) } else { 3.0 };
    let tip = Point3::from(draw.direction()) * (size * far);
    match draw.bits() % 6 {
        0 if family != Family::Far => Pose::default(),
        0 | 1 => {
            let mut axis = Vector3::zeros();
            axis[draw.bits() as usize % 3] = one_of(&[1.0, -1.0], draw);
            made(tip, axis)
        }
        2 => {
            let turn = loop {
                let turn = [0; 4].map(|_| draw.between(-1.0, 1.0));
                let norm = turn.iter().map(|part| part * part).sum::<f64>().sqrt();
                if norm > 0.1 {
                    // The norm deviates from 1 by almost as much as a pose accepts.
                    break turn.map(|part| part / norm * draw.between(0.9991, 1.0009));
                }
            };
            Pose::from_quaternion(tip, turn).expect("a quaternion")
        }
        _ => made(tip, Vector3::from(draw.direction()) * draw.between(0.9991, 1.0009)),
    }
}

fn made(tip: Point3<f64>, axis: Vector3<f64>) -> Pose {
    Pose::from_axis(tip, axis).expect("an axis")
}

/// Returns a pose after many rotations about the origin, some of which are undone immediately.
fn drifted(pose: Pose, draw: &mut Rng) -> Pose {
    let mut pose = pose;
    for _ in 0..12 {
        let axis = Vector3::from(draw.direction());
        let step = Pose::from_axis(Point3::origin(), axis).expect("an axis");
        pose = pose.then(&step);
        if draw.bits().is_multiple_of(2) {
            pose = pose.relative_to(&step);
        }
    }
    pose
}

/// Returns a random case of a family for a tool.
pub fn case(family: Family, cutter: &Cutter, draw: &mut Rng) -> Case {
    let [radius, height] = cutter.extent;
    let drawn = Sketch { cutter, radius }.triangles(family, draw);
    let mut pose = pose(family, radius + height, draw);
    if family == Family::Drift {
        pose = drifted(pose, draw);
    }
    let world = |p: Point| -> Point { (pose.tip() + pose.rotation() * Vector3::from(p)).into() };
    let tolerance = one_of(&[0.0, 1e-9], draw) * radius.max(height);
    Case { triangles: drawn.iter().map(|corners| corners.map(world)).collect(), pose, tolerance }
}
