//! The surface of a tool as triangles with normals: revolved from its profile, or found on a grid if it has none.

use nalgebra::Vector3;
use std::f64::consts::TAU;
use touchoff::tool::{ProfileSegment, Symmetry, ToolInfo};
use touchoff::{Interval, Tool};

/// Flat sides about the axis, and greatest angle of a chord of an arc.
const SIDES: usize = 64;
const MAX_CHORD: f64 = 0.1;

/// Triangles to draw: 9 values per triangle in each list, and its surface.
#[derive(Debug, Default)]
pub(crate) struct Triangles {
    pub(crate) positions: Vec<f32>,
    pub(crate) normals: Vec<f32>,
    pub(crate) surfaces: Vec<u32>,
}

impl Triangles {
    fn push(&mut self, corners: [[f64; 3]; 3], normals: [[f64; 3]; 3], surface: u32) {
        self.positions.extend(corners.into_iter().flatten().map(|value| value as f32));
        self.normals.extend(normals.into_iter().flatten().map(|value| value as f32));
        self.surfaces.push(surface);
    }
}

/// A point of the profile with its outward normal, both as `[d, z]`.
#[derive(Clone, Copy)]
struct ProfilePoint {
    at: [f64; 2],
    normal: [f64; 2],
}

impl ProfilePoint {
    /// Returns the point and the normal at a side of the solid of revolution; lengths are multiplied by `scale`.
    fn turned(self, side: usize, scale: f64) -> [[f64; 3]; 2] {
        let (sin, cos) = (TAU * side as f64 / SIDES as f64).sin_cos();
        [(self.at, scale), (self.normal, 1.0)]
            .map(|([d, z], by)| [by * d * cos, by * d * sin, by * z])
    }
}

/// Returns the surface of a tool; lengths are multiplied by `scale`.
pub(crate) fn triangles(tool: &dyn Tool, scale: f64) -> Triangles {
    match tool.info().outline.is_empty() {
        true => march(tool, scale),
        false => revolve(tool.info(), scale),
    }
}

/// Revolves a tool's profile; lengths are multiplied by `scale`.
fn revolve(info: &ToolInfo, scale: f64) -> Triangles {
    let mut triangles = Triangles::default();
    for segment in info.outline.iter() {
        let points = points(segment);
        for (lower, upper) in points.iter().zip(&points[1..]) {
            for side in 0..SIDES {
                let quad = [(lower, side), (lower, side + 1), (upper, side + 1), (upper, side)];
                let [a, b, c, d] = quad.map(|(point, side)| point.turned(side, scale));
                let surface = segment.surface.0 as u32;
                // A quadrilateral that ends on the axis is one triangle.
                if lower.at[0] > 0.0 {
                    triangles.push([a[0], b[0], c[0]], [a[1], b[1], c[1]], surface);
                }
                if upper.at[0] > 0.0 {
                    triangles.push([a[0], c[0], d[0]], [a[1], c[1], d[1]], surface);
                }
            }
        }
    }
    triangles
}

/// Returns points of a segment with the normals there, from its start to its end.
fn points(segment: &ProfileSegment) -> Vec<ProfilePoint> {
    let geometry = segment.geometry();
    let chords = (geometry.turn().abs() / MAX_CHORD).ceil().max(1.0);
    // Exactly the ends, so that no gap opens toward the next segment, and none on the axis.
    let places = geometry.places(chords as usize);
    places.map(|place| ProfilePoint { at: place.point, normal: place.outward() }).collect()
}

/// Cells of the grid along the longest side, and halvings of an edge that crosses the surface.
const CELLS: f64 = 56.0;
const HALVINGS: usize = 10;

/// The tetrahedra of a cube around its diagonal from corner 0 to 7; bit k of a corner is its step along axis k.
const TETRAHEDRA: [[usize; 4]; 6] =
    [[0, 1, 3, 7], [0, 3, 2, 7], [0, 2, 6, 7], [0, 6, 4, 7], [0, 4, 5, 7], [0, 5, 1, 7]];

/// Returns the surface of a tool without a profile, all as surface 0, by marching tetrahedra on a grid; lengths are multiplied
/// by `scale`.
fn march(tool: &dyn Tool, scale: f64) -> Triangles {
    let grid = Grid::around(tool);
    let [x_cells, y_cells, z_cells] = grid.counts.map(|count| count - 1);
    let mut triangles = Triangles::default();
    for z in 0..z_cells {
        for y in 0..y_cells {
            for x in 0..x_cells {
                let corners: [[usize; 3]; 8] =
                    std::array::from_fn(|k| [x + (k & 1), y + (k >> 1 & 1), z + (k >> 2)]);
                let inside = corners.map(|corner| grid.is_inside(corner));
                // Most cubes are wholly inside or outside.
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
    for k in 1..polygon.len() - 1 {
        let [a, mut b, mut c] = [polygon[0], polygon[k], polygon[k + 1]];
        let mut normal = difference(b, a).cross(&difference(c, a));
        if normal.dot(&difference(a, inner)) < 0.0 {
            (b, c) = (c, b);
            normal = -normal;
        }
        let Some(normal) = normal.try_normalize(0.0) else { continue };
        let scaled = [a, b, c].map(|point| point.map(|value| value * scale));
        triangles.push(scaled, [normal.into(); 3], 0);
    }
}

fn difference(to: [f64; 3], from: [f64; 3]) -> Vector3<f64> {
    Vector3::from([0, 1, 2].map(|k| to[k] - from[k]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchoff::tool::Interpreted;
    use touchoff_dsl::source::Source;

    const BALL: &str = "tool Ball { units mm; profile { start (0, 0); arc to (3, 3) center (0, 3) as ball cutting; \
                        line to (3, 10), (0, 10) as shank; } niceness cutting: 1; }";

    /// The volume by the divergence theorem is that of half a ball and a cylinder, less what chords cut off.
    #[test]
    fn a_revolved_profile_encloses_the_tool() {
        let tool = Interpreted::parse(&Source::new("ball.tool", BALL)).expect("a tool");
        let triangles = revolve(tool.info(), 1.0);
        let mut volume = 0.0;
        for corners in triangles.positions.chunks(9) {
            let [a, b, c] = [0, 3, 6].map(|k| Vector3::from_fn(|i, _| f64::from(corners[k + i])));
            volume += a.dot(&b.cross(&c)) / 6.0;
        }
        let exact = std::f64::consts::PI * (2.0 / 3.0 * 27.0 + 9.0 * 7.0);
        assert!(volume < exact && volume > 0.995 * exact, "{volume} of {exact}");
    }
}
