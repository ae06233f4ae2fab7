//! A signed-distance grid of the tool, asked at the part's points: the voxmap and point shell of
//! McNeely et al. (1999) the other way about, so that the part keeps its points.
//!
//! Points hang in a tree of spheres, each ruled out by one look at the grid's node nearest to its
//! centre; a point's magnitude is interpolated, its direction is the interpolation's slope. Nothing
//! but the grid knows the tool's shape: what the method is for. Two grids: `grid` in space, as
//! voxmaps are, and `grid-dz` in the half plane, which only a tool with an axis allows.

use super::grid::Grid;
use super::grid_dz::GridDz;
use super::points::{Bounds, Point, Tree};
use crate::race::contender::{Answer, Contender, Sums, View, Workpiece, dot};
use touchoff::{Cloud, Pose};

/// Points of a leaf, tried from 8 to 64 at 20,000 points.
const LEAF: usize = 8;

/// How much steeper than the distance the magnitude may be: √5.
pub const STEEPEST: f64 = 2.236_067_977_5;

/// A tool by the values of its field on a grid.
pub trait Field {
    /// No more than the distance from a point to the tool; at most 0 inside.
    fn clearance(&self, p: [f64; 3]) -> f64;

    /// Magnitude and direction; `None` outside.
    fn sense(&self, p: [f64; 3]) -> Option<(f64, [f64; 3])>;
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

/// A field, and the points under their spheres.
pub struct Shell<F> {
    name: &'static str,
    field: F,
    tree: Tree<Sphere>,
}

impl Shell<Grid> {
    /// With the grid in space.
    pub fn in_space(piece: &Workpiece) -> Self {
        Shell { name: "grid", field: Grid::known(), tree: spheres(&piece.cloud) }
    }
}

impl Shell<GridDz> {
    /// With the grid in the half plane.
    pub fn in_the_half_plane(piece: &Workpiece) -> Self {
        Shell { name: "grid-dz", field: GridDz::known(), tree: spheres(&piece.cloud) }
    }
}

fn spheres(cloud: &Cloud) -> Tree<Sphere> {
    Tree::new(cloud, LEAF, |bounds, points| Sphere::about(&bounds, points))
}

impl<F: Field> Contender for Shell<F> {
    fn name(&self) -> &'static str {
        self.name
    }

    fn query(&mut self, pose: &Pose) -> Answer {
        let view = View::of(pose);
        let field = &self.field;
        let mut sums = Sums::default();
        let (points, leaves) = self
            .tree
            .leaves(|sphere| field.clearance(view.turn(view.arm(sphere.centre))) <= sphere.radius);
        for point in leaves.flat_map(|leaf| &points[leaf]) {
            let arm = view.arm(point.at);
            let p = view.turn(arm);
            if let Some(felt) = field.sense(p) {
                sums.add([arm, p], (point.weight, point.normal), felt);
            }
        }
        sums.answer(&view)
    }
}
