//! A signed-distance grid of the tool, asked at the part's points: the voxmap and point shell of
//! McNeely et al. (1999) the other way about, so that the part keeps its points.
//!
//! The grid holds the tool's field at the corners of cubes of [`CELL`] mm over the tool's box and
//! [`AROUND`] mm about it, 3.2 million `f32`, 13 MB: the magnitude inside and by the surface, minus
//! the true distance elsewhere. A point's magnitude is interpolated between eight corners and its
//! direction is the interpolation's slope. Points hang in a tree of spheres, each ruled out by one
//! look at the corner nearest to its centre. Neither needs to know the tool's shape: what the method
//! is for. The price is the memory and an error of the order of the cell's square, and of the cell
//! where the tool has edges.

use crate::contender::{Answer, Contender, Sums, View, Workpiece, dot};
use crate::formula;
use crate::points::{Bounds, Point, Tree};
use touchoff::Pose;
use touchoff_tests::oracle::{Oracle, fig_7_3_exact};

/// The side of a cell, mm.
const CELL: f64 = 0.1;
/// How far the grid goes beyond the tool, mm.
const AROUND: f64 = 1.0;
/// The tool's box, by its lowest and highest corner.
const BOX: [[f64; 2]; 3] = [[-5.0, 5.0], [-5.0, 5.0], [0.0, formula::TIP]];
/// Points of a leaf: the fastest of 8, 16, 32 and 64.
const LEAF: usize = 16;

/// So near to the surface the field is the magnitude, which goes on outside, not the distance.
const BAND: f64 = 2.0 * CELL;
/// How much steeper than the distance the magnitude may be.
const STEEPEST: f64 = 2.236_067_977_5;

struct Grid {
    count: [usize; 3],
    /// x fastest.
    field: Vec<f32>,
}

impl Grid {
    fn new() -> Grid {
        let exact = fig_7_3_exact();
        let count =
            BOX.map(|[low, high]| ((high - low + 2.0 * AROUND) / CELL).round() as usize + 1);
        let at = |axis: usize, k: usize| BOX[axis][0] - AROUND + CELL * k as f64;
        let mut field = Vec::with_capacity(count[0] * count[1] * count[2]);
        for k in 0..count[2] {
            for j in 0..count[1] {
                for i in 0..count[0] {
                    let p = [at(0, i), at(1, j), at(2, k)];
                    let distance = exact.signed_distance(p);
                    let value = if distance > BAND { -distance } else { formula::magnitude(p) };
                    field.push(value as f32);
                }
            }
        }
        Grid { count, field }
    }

    /// A point in cells from the grid's corner.
    fn cells(p: [f64; 3]) -> [f64; 3] {
        [0, 1, 2].map(|axis| (p[axis] - BOX[axis][0] + AROUND) / CELL)
    }

    /// No more than the distance from a point to the tool; at most 0 inside.
    fn clearance(&self, p: [f64; 3]) -> f64 {
        let mut beyond = 0.0;
        let mut corner = [0; 3];
        for (axis, cells) in Self::cells(p).into_iter().enumerate() {
            let most = (self.count[axis] - 1) as f64;
            let held = cells.clamp(0.0, most);
            beyond += (cells - held) * (cells - held);
            corner[axis] = (held + 0.5) as usize;
        }
        let field = -f64::from(self.field[self.index(corner)]);
        let distance = if field > STEEPEST * BAND { field } else { field / STEEPEST };
        // The corner may be half a cell's diagonal away from the point, or from where the point's
        // nearest in the grid is; the tool lies behind that one.
        let distance = (distance - 0.866_1 * CELL).max(0.0);
        (distance * distance + beyond * CELL * CELL).sqrt()
    }

    fn index(&self, [i, j, k]: [usize; 3]) -> usize {
        (k * self.count[1] + j) * self.count[0] + i
    }

    /// Magnitude and direction by interpolation; `None` outside.
    fn sense(&self, p: [f64; 3]) -> Option<(f64, [f64; 3])> {
        let cells = Self::cells(p);
        let mut corner = [0; 3];
        let mut part = [0.0; 3];
        for axis in 0..3 {
            if cells[axis] < 0.0 || cells[axis] >= (self.count[axis] - 1) as f64 {
                return None;
            }
            corner[axis] = cells[axis] as usize;
            part[axis] = cells[axis] - corner[axis] as f64;
        }
        let [x, y, z] = part;
        let first = self.index(corner);
        let (row, plane) = (self.count[0], self.count[0] * self.count[1]);
        // Along x: values and slopes of four edges.
        let edge = |at: usize| {
            let (low, high) = (f64::from(self.field[at]), f64::from(self.field[at + 1]));
            (low + x * (high - low), high - low)
        };
        let (a, b) = (edge(first), edge(first + row));
        let (c, d) = (edge(first + plane), edge(first + plane + row));
        let (low, high) = (a.0 + y * (b.0 - a.0), c.0 + y * (d.0 - c.0));
        let value = low + z * (high - low);
        if value < 0.0 {
            return None;
        }
        let mix = |a: f64, b: f64, part: f64| a + part * (b - a);
        let away = [
            -mix(mix(a.1, b.1, y), mix(c.1, d.1, y), z),
            -mix(b.0 - a.0, d.0 - c.0, z),
            low - high,
        ];
        let length = dot(away, away).sqrt();
        let way = if length > 0.0 { away.map(|c| c / length) } else { [1.0, 0.0, 0.0] };
        Some((value, way))
    }
}

/// A sphere about a node's points.
struct Sphere {
    centre: [f64; 3],
    radius: f64,
}

impl Sphere {
    fn about(bounds: &Bounds, points: &[Point]) -> Sphere {
        let from = |point: &Point| [0, 1, 2].map(|axis| point.at[axis] - bounds.centre[axis]);
        let square = |v: [f64; 3]| dot(v, v);
        let farthest = points.iter().map(|point| square(from(point))).fold(0.0, f64::max);
        Sphere { centre: bounds.centre, radius: farthest.sqrt() * (1.0 + 1e-9) }
    }
}

pub(crate) struct VoxelGrid {
    grid: Grid,
    tree: Tree<Sphere>,
}

impl VoxelGrid {
    pub(crate) fn new(piece: &Workpiece) -> VoxelGrid {
        let tree = Tree::new(&piece.cloud, LEAF, |bounds, points| Sphere::about(&bounds, points));
        VoxelGrid { grid: Grid::new(), tree }
    }
}

impl Contender for VoxelGrid {
    fn name(&self) -> &'static str {
        "grid"
    }

    fn query(&mut self, pose: &Pose) -> Answer {
        let view = View::of(pose);
        let grid = &self.grid;
        let mut sums = Sums::default();
        let (points, leaves) = self
            .tree
            .leaves(|sphere| grid.clearance(view.turn(view.arm(sphere.centre))) <= sphere.radius);
        for point in leaves.flat_map(|leaf| &points[leaf]) {
            let arm = view.arm(point.at);
            let p = view.turn(arm);
            if let Some(felt) = grid.sense(p) {
                sums.add([arm, p], (point.weight, point.normal), felt);
            }
        }
        sums.answer(&view)
    }
}
