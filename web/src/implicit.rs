//! The surface of a tool without a profile, as triangles: marching tetrahedra on a grid.

use crate::outline::Triangles;
use touchoff::Tool;
use touchoff::tool::Symmetry;

/// Cells of the grid along the longest side, and halvings of an edge that crosses the surface.
const CELLS: f64 = 56.0;
const HALVINGS: usize = 10;

/// The tetrahedra of a cube around its diagonal from corner 0 to 7; bit k of a corner is its step along axis k.
const TETRAHEDRA: [[usize; 4]; 6] =
    [[0, 1, 3, 7], [0, 3, 2, 7], [0, 2, 6, 7], [0, 6, 4, 7], [0, 4, 5, 7], [0, 5, 1, 7]];

/// Returns the surface of a tool, all as surface 0; lengths are multiplied by `scale`.
pub(crate) fn surface(tool: &dyn Tool, scale: f64) -> Triangles {
    let info = tool.info();
    let reach = info.reach();
    let [x, y] = match info.symmetry {
        Symmetry::Revolved => [(-info.radius(), info.radius()); 2],
        Symmetry::Solid { extent } => extent.map(|side| (side.low, side.high)),
    };
    let sides = [x, y, (reach.low, reach.high)];
    let longest = sides.iter().map(|(low, high)| high - low).fold(0.0, f64::max);
    let step = longest / CELLS;
    // A margin of a cell, so that the surface is closed.
    let start = sides.map(|(low, _)| low - step);
    let counts = sides.map(|(low, high)| ((high - low) / step).ceil() as usize + 3);
    let is_inside = |point: [f64; 3]| tool.clearance(point) == 0.0;
    let at = |cell: [usize; 3]| [0, 1, 2].map(|k| start[k] + step * cell[k] as f64);
    let mut inside = Vec::with_capacity(counts.iter().product());
    for z in 0..counts[2] {
        for y in 0..counts[1] {
            inside.extend((0..counts[0]).map(|x| is_inside(at([x, y, z]))));
        }
    }
    let index = |[x, y, z]: [usize; 3]| x + counts[0] * (y + counts[1] * z);
    let mut triangles = Triangles::default();
    for z in 0..counts[2] - 1 {
        for y in 0..counts[1] - 1 {
            for x in 0..counts[0] - 1 {
                let corner = |k: usize| [x + (k & 1), y + (k >> 1 & 1), z + (k >> 2)];
                let is_in: [bool; 8] = std::array::from_fn(|k| inside[index(corner(k))]);
                if is_in.iter().all(|is| *is == is_in[0]) {
                    continue;
                }
                for tetrahedron in TETRAHEDRA {
                    let (ins, outs): (Vec<usize>, Vec<usize>) =
                        tetrahedron.iter().partition(|k| is_in[**k]);
                    let cross = |inner: usize, outer: usize| {
                        boundary(at(corner(inner)), at(corner(outer)), is_inside)
                    };
                    let polygon: Vec<[f64; 3]> = match (&ins[..], &outs[..]) {
                        ([a], [b, c, d]) => vec![cross(*a, *b), cross(*a, *c), cross(*a, *d)],
                        ([a, b, c], [d]) => vec![cross(*a, *d), cross(*b, *d), cross(*c, *d)],
                        ([a, b], [c, d]) => {
                            vec![cross(*a, *c), cross(*a, *d), cross(*b, *d), cross(*b, *c)]
                        }
                        _ => continue,
                    };
                    let inner = at(corner(ins[0]));
                    add(&mut triangles, &polygon, inner, scale);
                }
            }
        }
    }
    triangles
}

/// Returns the last point inside on the edge from an inner to an outer point, nearly.
fn boundary(
    mut inner: [f64; 3],
    mut outer: [f64; 3],
    is_inside: impl Fn([f64; 3]) -> bool,
) -> [f64; 3] {
    for _ in 0..HALVINGS {
        let middle = [0, 1, 2].map(|k| 0.5 * (inner[k] + outer[k]));
        if is_inside(middle) { inner = middle } else { outer = middle }
    }
    inner
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
