//! The deepest place of triangles in a tool, sought in doubles and weighed in 256 bits.
//!
//! A place is a convex combination of a triangle's corners, so it is on the triangle exactly. Its depth in 256 bits
//! is a lower bound of the greatest depth, however the place was found.

use super::cutters::Cutter;
use touchoff::Pose;
use touchoff_tests::oracle::big::Big;
use touchoff_tests::oracle::draw::Draw;
use touchoff_tests::oracle::reference::At;

/// A point or vector in space.
pub type Point = [f64; 3];

/// Starts that the search climbs from, the steps of each, and those that the best of them is given more.
const STARTS: usize = 3;
const STEPS: usize = 60;
const MORE: usize = 120;

/// A tool at a pose beside triangles.
pub struct Scene<'a> {
    /// The tool.
    pub cutter: &'a Cutter,
    /// The corners of each triangle, in the tool's frame and in doubles.
    pub triangles: Vec<[Point; 3]>,
    /// The same in 256 bits.
    exact: Vec<[[Big; 3]; 3]>,
}

/// A place on a triangle: what each corner weighs.
#[derive(Clone, Copy, Debug)]
pub struct Place {
    /// The triangle.
    pub triangle: usize,
    /// Numbers that are not below 0, and not all 0.
    pub weights: Point,
}

/// The inverse of a matrix, by its columns' cross products.
fn inverse(columns: &[[Big; 3]; 3]) -> [[Big; 3]; 3] {
    let [x, y, z] = columns;
    let rows = [cross(y, z), cross(z, x), cross(x, y)];
    let determinant = dot(&rows[0], x);
    rows.map(|row| row.map(|part| &part / &determinant))
}

fn dot(a: &[Big; 3], b: &[Big; 3]) -> Big {
    &(&(&a[0] * &b[0]) + &(&a[1] * &b[1])) + &(&a[2] * &b[2])
}

fn cross(a: &[Big; 3], b: &[Big; 3]) -> [Big; 3] {
    let part = |i: usize, j: usize| &(&a[i] * &b[j]) - &(&a[j] * &b[i]);
    [part(1, 2), part(2, 0), part(0, 1)]
}

fn minus(a: Point, b: Point) -> Point {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn product(a: Point, b: Point) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// The weighted mean of a triangle's corners.
fn mean([a, b, c]: &[Point; 3], [u, v, w]: Point) -> Point {
    [0, 1, 2].map(|k| (u * a[k] + v * b[k] + w * c[k]) / (u + v + w))
}

/// The weights of the point of a triangle that is about the nearest to another: the best of the foot on its plane, if
/// that is inside, and of the feet on its edges, since a sliver's plane is hardly known.
fn nearest(p: Point, corners: &[Point; 3]) -> Point {
    let [a, b, c] = *corners;
    let off = |weights: &Point| {
        let way = minus(p, mean(corners, *weights));
        product(way, way)
    };
    let edges = [[0, 1], [1, 2], [2, 0]].map(|[from, to]| {
        let way = minus(corners[to], corners[from]);
        let part = product(minus(p, corners[from]), way) / product(way, way);
        // Written so that an edge without length is its first end.
        let part = if part > 0.0 { part.min(1.0) } else { 0.0 };
        let mut weights = [0.0; 3];
        weights[from] = 1.0 - part;
        weights[to] = part;
        weights
    });
    let (e, f) = (minus(b, a), minus(c, a));
    let (ee, ef, ff) = (product(e, e), product(e, f), product(f, f));
    let area = ee * ff - ef * ef;
    // What is left is solved for again: of a sliver the first weights are known to few digits.
    let [mut v, mut w] = [0.0; 2];
    for _ in 0..3 {
        let left = minus(p, mean(corners, [1.0 - v - w, v, w]));
        let (of_e, of_f) = (product(e, left), product(f, left));
        v += (ff * of_e - ef * of_f) / area;
        w += (ee * of_f - ef * of_e) / area;
    }
    let inside = (v >= 0.0 && w >= 0.0 && v + w <= 1.0).then_some([1.0 - v - w, v, w]);
    let all = edges.into_iter().chain(inside);
    all.min_by(|a, b| off(a).total_cmp(&off(b))).unwrap_or([1.0, 0.0, 0.0])
}

impl<'a> Scene<'a> {
    /// Triangles of the world seen from a pose, which maps the tool's frame to the world: `p = R q + tip`.
    pub fn new(cutter: &'a Cutter, pose: &Pose, triangles: &[[Point; 3]]) -> Scene<'a> {
        let rotation = pose.rotation();
        let columns = [0, 1, 2].map(|k| [0, 1, 2].map(|i| Big::exactly(rotation[(i, k)])));
        let (rows, tip) = (inverse(&columns), pose.tip().coords);
        let place = |corner: Point| {
            let off = [0, 1, 2].map(|k| &Big::exactly(corner[k]) - &Big::exactly(tip[k]));
            [0, 1, 2].map(|k| dot(&rows[k], &off))
        };
        let exact: Vec<_> = triangles.iter().map(|corners| corners.map(place)).collect();
        let double = |corners: &[[Big; 3]; 3]| {
            let [a, b, c] = corners;
            [a, b, c].map(|[x, y, z]| [x.to_f64(), y.to_f64(), z.to_f64()])
        };
        Scene { cutter, triangles: exact.iter().map(double).collect(), exact }
    }

    /// A place in the tool's frame, in doubles.
    pub fn point(&self, place: &Place) -> Point {
        mean(&self.triangles[place.triangle], place.weights)
    }

    /// The depth of a place, in doubles.
    pub fn depth(&self, place: &Place) -> f64 {
        let [x, y, z] = self.point(place);
        self.cutter.outline.depth([x.hypot(y), z])
    }

    /// The depth of a place, in 256 bits.
    pub fn exact_depth(&self, place: &Place) -> Big {
        let corners = &self.exact[place.triangle];
        let weights = place.weights.map(Big::exactly);
        let sum = &(&weights[0] + &weights[1]) + &weights[2];
        let at = [0, 1, 2].map(|axis| {
            let column = [0, 1, 2].map(|k| corners[k][axis].clone());
            &dot(&weights, &column) / &sum
        });
        self.cutter.reference.depth(&At::of(at))
    }

    /// The place of a triangle that is about the nearest to a point of the tool's frame.
    pub fn nearest(&self, triangle: usize, p: Point) -> Place {
        Place { triangle, weights: nearest(p, &self.triangles[triangle]) }
    }

    /// The deepest place that a search finds by itself.
    pub fn deepest(&self, draw: &mut Draw) -> Place {
        let mut starts = Vec::new();
        for triangle in 0..self.triangles.len() {
            self.starts(triangle, draw, &mut starts);
        }
        let mut starts: Vec<_> =
            starts.into_iter().map(|place| (self.depth(&place), place)).collect();
        starts.sort_by(|a, b| b.0.total_cmp(&a.0));
        starts.truncate(STARTS);
        let climbed = starts.iter().map(|(_, place)| self.climb(place, 0.3, STEPS, draw));
        let best = climbed.max_by(|a, b| a.0.total_cmp(&b.0)).expect("a triangle has starts");
        self.climb(&best.1, best.2, MORE, draw).1
    }

    /// Corners, places of edges, places inside, and the feet of points of the tool.
    fn starts(&self, triangle: usize, draw: &mut Draw, starts: &mut Vec<Place>) {
        let mut push = |weights: Point| starts.push(Place { triangle, weights });
        for k in 0..3 {
            let mut corner = [0.0; 3];
            corner[k] = 1.0;
            push(corner);
            for _ in 0..3 {
                let part = draw.between(0.0, 1.0);
                let mut edge = [0.0; 3];
                edge[k] = part;
                edge[(k + 1) % 3] = 1.0 - part;
                push(edge);
            }
        }
        for _ in 0..6 {
            push([0; 3].map(|_| draw.between(0.0, 1.0)));
        }
        let corners = &self.triangles[triangle];
        let height = self.cutter.extent[1];
        for _ in 0..4 {
            push(nearest([0.0, 0.0, draw.between(0.0, height)], corners));
        }
        for segment in &self.cutter.outline.segments {
            let [d, z] = segment.centre.unwrap_or(segment.to);
            let (sin, cos) = draw.between(0.0, std::f64::consts::TAU).sin_cos();
            push(nearest([d * cos, d * sin, z], corners));
        }
    }

    /// The deepest place reached from another by random steps, with its depth and the last step: the step grows when
    /// one leads deeper, and shrinks when none does.
    pub fn climb(
        &self,
        from: &Place,
        step: f64,
        steps: usize,
        draw: &mut Draw,
    ) -> (f64, Place, f64) {
        let (mut best, mut at, mut step) = (self.depth(from), *from, step);
        let mut last = [0.0; 3];
        for k in 0..steps {
            if step < 1e-17 {
                break;
            }
            // Along a ridge few directions lead up: the last one that did may do so again.
            let turn = if k % 3 == 0 && last != [0.0; 3] {
                last
            } else {
                let [u, v] = [draw.between(-1.0, 1.0), draw.between(-1.0, 1.0)];
                [u, v, -u - v]
            };
            let moved = [0, 1, 2].map(|k| (at.weights[k] + step * turn[k]).max(0.0));
            let sum = moved[0] + moved[1] + moved[2];
            let next = Place { weights: moved.map(|part| part / sum), ..at };
            let depth = self.depth(&next);
            if depth > best {
                (best, at, last) = (depth, next, turn);
                step = (step * 1.8).min(0.5);
            } else {
                step *= 0.7;
            }
        }
        (best, at, step)
    }
}
