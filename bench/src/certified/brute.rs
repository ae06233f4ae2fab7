//! The deepest point of triangles in a tool, by brute force.
//!
//! A signed distance is 1-Lipschitz, so a triangle whose centre is shallower than the best sample by more than the
//! triangle's radius is skipped. The others are sampled at their corners, at random points and at the feet of random
//! points of the tool. From the best samples a search climbs by decreasing random steps.

use nalgebra::{Point3, Vector3};
use touchoff::{Mesh, Pose, TriangleId};
use touchoff_tests::oracle::draw::Rng;
use touchoff_tests::oracle::{Meridian, Nearest, Oracle};

/// A point or vector in the tool's frame and unit.
pub type Point = [f64; 3];

/// Minimum and maximum number of samples of each kind per triangle. Fewer triangles nearby get more samples each.
const SAMPLES: [usize; 2] = [8, 150];
/// Number of samples of each kind over all triangles nearby, within the limits per triangle.
const TOGETHER: usize = 600;
/// Maximum number of triangles that are sampled.
const TRIANGLES: usize = 1000;
/// Number of samples from which the search climbs, maximum number of them per triangle, and number of steps.
const STARTS: usize = 6;
const EACH: usize = 3;
const STEPS: usize = 500;

/// A part's triangles and a tool.
pub struct Brute<'a> {
    pub(super) mesh: &'a Mesh,
    pub(super) oracle: &'a Nearest,
    /// The tool's unit of length, in the part's unit.
    pub length: f64,
    /// The sum of the tool's size, the part's size and the part's distance from the origin, in the part's unit.
    pub size: f64,
    /// Bounding ball of each triangle: centroid and radius.
    pub(super) balls: Vec<(Point3<f64>, f64)>,
    /// Bounding balls of groups of consecutive triangles.
    pub(super) groups: Vec<(Point3<f64>, f64)>,
}

/// Number of triangles per group.
pub(super) const GROUP: usize = 32;

/// A pose: its tip, and the tool's axes in the world frame.
pub struct Seen {
    tip: Point3<f64>,
    axes: [[f64; 3]; 3],
}

fn minus(a: Point, b: Point) -> Point {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn dot(a: Point, b: Point) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: Point, b: Point) -> Point {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn along(a: Point, t: f64, way: Point) -> Point {
    [a[0] + t * way[0], a[1] + t * way[1], a[2] + t * way[2]]
}

/// Returns the distance between two points.
pub fn distance(a: Point, b: Point) -> f64 {
    let way = minus(a, b);
    dot(way, way).sqrt()
}

/// Returns the point of a triangle nearest to `p`: the foot on its plane, or else a point on an edge.
pub fn nearest(p: Point, &[a, b, c]: &[Point; 3]) -> Point {
    // The two shortest edges determine the plane of a sliver best.
    let mut ways = [minus(b, a), minus(c, b), minus(a, c)];
    ways.sort_by(|e, f| dot(*e, *e).total_cmp(&dot(*f, *f)));
    let normal = cross(ways[0], ways[1]);
    let square = dot(normal, normal);
    if square > 0.0 {
        let foot = along(p, -dot(normal, minus(p, a)) / square, normal);
        let side = |from: Point, to: Point| dot(cross(minus(to, from), minus(foot, from)), normal);
        let sides = [side(a, b), side(b, c), side(c, a)];
        if sides.iter().all(|side| *side >= 0.0) || sides.iter().all(|side| *side <= 0.0) {
            return foot;
        }
    }
    let edges = [[a, b], [b, c], [c, a]].map(|[from, to]| {
        let way = minus(to, from);
        let at = dot(minus(p, from), way) / dot(way, way);
        along(from, if at > 0.0 { at.min(1.0) } else { 0.0 }, way)
    });
    edges.into_iter().min_by(|e, f| distance(p, *e).total_cmp(&distance(p, *f))).unwrap_or(a)
}

/// Returns a ball that contains several balls.
fn around(balls: &[(Point3<f64>, f64)]) -> (Point3<f64>, f64) {
    let all = balls.iter().map(|(middle, _)| middle.coords);
    let middle = Point3::from(all.sum::<Vector3<f64>>() / balls.len() as f64);
    let reach = balls.iter().map(|(other, reach)| (other - middle).norm() + reach);
    (middle, reach.fold(0.0, f64::max) * (1.0 + 1e-12))
}

impl<'a> Brute<'a> {
    /// Prepares the triangles of a mesh. `length` is the tool's unit of length in the mesh's unit.
    pub fn new(mesh: &'a Mesh, oracle: &'a Nearest, length: f64) -> Brute<'a> {
        let [low, high] = mesh.bounds();
        let [radius, height] = oracle.extent();
        let far = low.coords.amax().max(high.coords.amax());
        let ids = 0..mesh.triangles().len() as u32;
        let balls = ids.map(|id| {
            let corners = mesh.triangle(TriangleId(id));
            let middle =
                Point3::from((corners[0].coords + corners[1].coords + corners[2].coords) / 3.0);
            let reach = corners.map(|corner| (corner - middle).norm());
            (middle, reach[0].max(reach[1]).max(reach[2]))
        });
        let balls: Vec<_> = balls.collect();
        Brute {
            length,
            groups: balls.chunks(GROUP).map(around).collect(),
            size: (high - low).norm() + far + (radius + height) * length,
            balls,
            mesh,
            oracle,
        }
    }

    /// Converts a pose.
    pub fn seen(&self, pose: &Pose) -> Seen {
        let turn = pose.rotation();
        Seen {
            tip: pose.tip(),
            axes: [0, 1, 2].map(|k| [turn[(0, k)], turn[(1, k)], turn[(2, k)]]),
        }
    }

    pub(super) fn to_tool(&self, seen: &Seen, point: Point3<f64>) -> Point {
        let off = point - seen.tip;
        seen.axes.map(|axis| dot(axis, [off.x, off.y, off.z]) / self.length)
    }

    /// Returns a point of the world in the tool's frame and unit.
    pub fn inside(&self, pose: &Pose, point: Point3<f64>) -> Point {
        self.to_tool(&self.seen(pose), point)
    }

    /// Returns a triangle in the tool's frame and unit.
    pub fn triangle(&self, seen: &Seen, id: usize) -> [Point; 3] {
        self.mesh.triangle(TriangleId(id as u32)).map(|corner| self.to_tool(seen, corner))
    }

    /// Returns the depth of a point of the tool's frame, in the tool's unit; it is negative outside.
    pub fn depth(&self, p: Point) -> f64 {
        -self.oracle.profile().signed_distance(Meridian::of(p).dz)
    }

    /// Returns the greatest depth found, in the part's unit. It is negative if no sample is inside, and negative
    /// infinity if no triangle is near.
    pub fn deepest(&self, seen: &Seen, draw: &mut Rng, samples: &mut u64) -> f64 {
        let [radius, height] = self.oracle.extent();
        let mut near = Vec::new();
        for (id, (middle, reach)) in self.balls.iter().enumerate() {
            let p = self.to_tool(seen, *middle);
            let reach = reach / self.length * (1.0 + 1e-9);
            if p[2] + reach < 0.0 || p[2] - reach > height || p[0].hypot(p[1]) > radius + reach {
                continue;
            }
            near.push((self.depth(p) + reach, id));
        }
        *samples += near.len() as u64;
        near.sort_by(|a, b| b.0.total_cmp(&a.0));
        let count = (TOGETHER / near.len().max(1)).clamp(SAMPLES[0], SAMPLES[1]);
        let mut best = f64::NEG_INFINITY;
        let mut starts: Vec<(f64, usize, Point)> = Vec::new();
        for (bound, id) in near.into_iter().take(TRIANGLES) {
            if bound <= best {
                break;
            }
            let evaluation = self.sample(&self.triangle(seen, id), count, draw);
            *samples += evaluation.len() as u64;
            best = best.max(evaluation[0].0);
            starts
                .extend(evaluation.into_iter().take(EACH).map(|(depth, point)| (depth, id, point)));
        }
        starts.sort_by(|a, b| b.0.total_cmp(&a.0));
        let climbs = starts.into_iter().take(STARTS);
        let reached = climbs.map(|(_, id, point)| self.climb(seen, id, point, draw, samples));
        reached.fold(f64::NEG_INFINITY, f64::max)
    }

    /// Returns samples of a triangle, the deepest first.
    fn sample(&self, triangle: &[Point; 3], count: usize, draw: &mut Rng) -> Vec<(f64, Point)> {
        let [radius, height] = self.oracle.extent();
        let [a, b, c] = *triangle;
        let mut points = vec![a, b, c];
        for _ in 0..count {
            let (v, w) = (draw.between(0.0, 1.0), draw.between(0.0, 1.0));
            let (v, w) = if v + w > 1.0 { (1.0 - v, 1.0 - w) } else { (v, w) };
            points.push(along(along(a, v, minus(b, a)), w, minus(c, a)));
            // Half of the points are near the tip.
            let high =
                if draw.bits().is_multiple_of(2) { height } else { height.min(2.0 * radius) };
            let mut across = || draw.between(-0.5, 0.5) * radius;
            points.push(nearest([across(), across(), draw.between(0.0, high)], triangle));
        }
        let mut evaluation: Vec<_> = points.into_iter().map(|p| (self.depth(p), p)).collect();
        evaluation.sort_by(|a, b| b.0.total_cmp(&a.0));
        evaluation
    }

    /// Climbs from a point of a triangle and returns the greatest depth reached, in the part's unit.
    pub fn climb(
        &self,
        seen: &Seen,
        triangle: usize,
        from: Point,
        draw: &mut Rng,
        samples: &mut u64,
    ) -> f64 {
        let triangle = self.triangle(seen, triangle);
        let [a, b, c] = triangle;
        let mut at = nearest(from, &triangle);
        let mut best = self.depth(at);
        let mut last = [0.0; 3];
        let mut step =
            distance(a, b).max(distance(b, c)).max(distance(c, a)).min(self.oracle.extent()[0]);
        let mut failed = 0;
        for k in 0..STEPS {
            if step < 1e-11 {
                break;
            }
            *samples += 1;
            // Few directions lead up along a ridge, so the last successful direction is tried again.
            let way = if k % 4 == 0 && last != [0.0; 3] { last } else { draw.direction() };
            let next = nearest(along(at, step, way), &triangle);
            let depth = self.depth(next);
            if depth > best {
                let went = minus(next, at);
                let size = dot(went, went).sqrt();
                last = went.map(|part| part / size);
                (best, at, failed) = (depth, next, 0);
                step *= 1.5;
            } else {
                failed += 1;
                if failed % 4 == 0 {
                    step *= 0.6;
                }
            }
        }
        best * self.length
    }
}
