//! The surface of a tool without a profile, as triangles: marching tetrahedra on a grid.

use crate::outline::Triangles;
use touchoff::tool::Symmetry;
use touchoff::{Interval, Tool};

/// Cells of the grid along the longest side, and halvings of an edge that crosses the surface.
const CELLS: f64 = 56.0;
const HALVINGS: usize = 10;

/// The tetrahedra of a cube around its diagonal from corner 0 to 7; bit k of a corner is its step along axis k.
const TETRAHEDRA: [[usize; 4]; 6] =
    [[0, 1, 3, 7], [0, 3, 2, 7], [0, 2, 6, 7], [0, 6, 4, 7], [0, 4, 5, 7], [0, 5, 1, 7]];

/// Returns the surface of a tool, all as surface 0; lengths are multiplied by `scale`.
pub(crate) fn surface(tool: &dyn Tool, scale: f64) -> Triangles {
    let grid = Grid::around(tool);
    let [x_cells, y_cells, z_cells] = grid.counts.map(|count| count - 1);
    let mut triangles = Triangles::default();
    for z in 0..z_cells {
        for y in 0..y_cells {
            for x in 0..x_cells {
                let corners: [[usize; 3]; 8] =
                    std::array::from_fn(|k| [x + (k & 1), y + (k >> 1 & 1), z + (k >> 2)]);
                let inside = corners.map(|corner| grid.is_inside(corner));
                if inside.iter().all(|is| *is == inside[0]) {
                    continue;
                }
                for tetrahedron in TETRAHEDRA {
                    let (inner, outer): (Vec<usize>, Vec<usize>) =
                        tetrahedron.into_iter().partition(|k| inside[*k]);
                    if inner.is_empty() || outer.is_empty() {
                        continue;
                    }
                    let polygon: Vec<[f64; 3]> = cut_edges(&inner, &outer)
                        .into_iter()
                        .map(|edge| grid.boundary(edge.map(|k| grid.point(corners[k]))))
                        .collect();
                    add(&mut triangles, &polygon, grid.point(corners[inner[0]]), scale);
                }
            }
        }
    }
    triangles
}

/// A cubic grid of points around a tool, in the tool's frame and unit.
struct Grid<'a> {
    tool: &'a dyn Tool,
    start: [f64; 3],
    step: f64,
    /// Numbers of points along the axes.
    counts: [usize; 3],
    /// A flag per point, along x first, that is set if the tool contains it.
    inside: Vec<bool>,
}

impl<'a> Grid<'a> {
    /// Creates the grid around a tool with a margin of one cell on every side, so that the surface is closed.
    fn around(tool: &'a dyn Tool) -> Grid<'a> {
        let info = tool.info();
        let [x, y] = match info.symmetry {
            Symmetry::Revolved => [Interval::new(-info.radius(), info.radius()); 2],
            Symmetry::Solid { extent } => extent,
        };
        let sides = [x, y, info.reach()];
        let step = sides.iter().map(|side| side.high - side.low).fold(0.0, f64::max) / CELLS;
        // A point more than there are cells, and one for each margin.
        let counts = sides.map(|side| ((side.high - side.low) / step).ceil() as usize + 3);
        let start = sides.map(|side| side.low - step);
        let mut grid = Grid { tool, start, step, counts, inside: Vec::new() };
        let points = (0..counts.iter().product::<usize>())
            .map(|k| [k % counts[0], k / counts[0] % counts[1], k / (counts[0] * counts[1])]);
        grid.inside = points.map(|cell| is_inside(tool, grid.point(cell))).collect();
        grid
    }

    fn point(&self, cell: [usize; 3]) -> [f64; 3] {
        [0, 1, 2].map(|k| self.start[k] + self.step * cell[k] as f64)
    }

    fn is_inside(&self, [x, y, z]: [usize; 3]) -> bool {
        self.inside[x + self.counts[0] * (y + self.counts[1] * z)]
    }

    /// Returns a point inside on the edge from an inner to an outer point, near where the edge leaves the tool.
    fn boundary(&self, [mut inner, mut outer]: [[f64; 3]; 2]) -> [f64; 3] {
        for _ in 0..HALVINGS {
            let middle = [0, 1, 2].map(|k| 0.5 * (inner[k] + outer[k]));
            if is_inside(self.tool, middle) { inner = middle } else { outer = middle }
        }
        inner
    }
}

fn is_inside(tool: &dyn Tool, point: [f64; 3]) -> bool {
    tool.clearance(point) == 0.0
}

/// Returns the edges from the inner to the outer corners of a tetrahedron, in their order around the polygon in which the
/// surface cuts them. Two edges that follow each other share a corner: both are in a face of the tetrahedron, as is the side
/// of the polygon between them.
fn cut_edges(inner: &[usize], outer: &[usize]) -> Vec<[usize; 2]> {
    if let ([a, b], [c, d]) = (inner, outer) {
        return vec![[*a, *c], [*a, *d], [*b, *d], [*b, *c]];
    }
    inner.iter().flat_map(|from| outer.iter().map(move |to| [*from, *to])).collect()
}

/// Adds a convex polygon, turned so that its normal points away from an inner point.
fn add(triangles: &mut Triangles, polygon: &[[f64; 3]], inner: [f64; 3], scale: f64) {
    let vector =
        |from: [f64; 3], to: [f64; 3]| nalgebra::Vector3::from([0, 1, 2].map(|k| to[k] - from[k]));
    for k in 1..polygon.len() - 1 {
        let [a, mut b, mut c] = [polygon[0], polygon[k], polygon[k + 1]];
        let mut normal = vector(a, b).cross(&vector(a, c));
        if normal.dot(&vector(inner, a)) < 0.0 {
            (b, c) = (c, b);
            normal = -normal;
        }
        let Some(normal) = normal.try_normalize(0.0) else { continue };
        let scaled = [a, b, c].map(|point| point.map(|value| value * scale));
        triangles.push(scaled, [normal.into(); 3], 0);
    }
}
