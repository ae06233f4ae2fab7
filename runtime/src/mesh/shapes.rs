//! Generated meshes, as parts for examples, tests and benchmarks.
//!
//! Dimensions are in the given unit, and triangles are counter-clockwise seen from outside. Each
//! function returns [`MeshError::Shape`] if its dimensions are invalid.

use std::collections::HashMap;

use nalgebra::{Point3, Vector3};

use super::{Mesh, MeshError};
use crate::unit::Unit;

/// Maximum number of triangles of a generated shape: 2^25, some gigabytes of mesh and more than any part needs.
pub const MAX_TRIANGLES: u64 = 1 << 25;

/// Generates a tube about the z axis from z = 0 to `height`, closed and oriented outward; its inside is
/// a bore. It has `segments` flat sides, whose edges lie on the radii, and `layers` along the height,
/// hence `4 segments (layers + 1)` triangles.
///
/// `tube(3.0, 5.0, 13.116, 96, 23, Unit::Millimetre)` has the inner radius and the area of the thesis's tube.
///
/// # Errors
/// Fails unless `0 < inner < outer`, `height > 0`, `segments >= 3`, `layers >= 1` and there are at most
/// [`MAX_TRIANGLES`].
pub fn tube(
    inner: f64,
    outer: f64,
    height: f64,
    segments: u32,
    layers: u32,
    unit: Unit,
) -> Result<Mesh, MeshError> {
    let fits = 4 * u128::from(segments) * (u128::from(layers) + 1) <= MAX_TRIANGLES.into();
    if !(0.0 < inner && inner < outer && 0.0 < height && segments >= 3 && layers >= 1 && fits) {
        let rule = "it needs 0 < inner radius < outer radius, height > 0, 3 segments or more, \
                    1 layer or more, and at most 2^25 triangles";
        return Err(MeshError::Shape { shape: "tube", rule });
    }
    let mut vertices = Vec::new();
    for layer in 0..=layers {
        let z = height * (f64::from(layer) / f64::from(layers));
        for radius in [inner, outer] {
            for segment in 0..segments {
                let turn = f64::from(segment) / f64::from(segments);
                let (sin, cos) = (std::f64::consts::TAU * turn).sin_cos();
                vertices.push(Point3::new(radius * cos, radius * sin, z));
            }
        }
    }
    let inside = |layer: u32, segment: u32| 2 * segments * layer + segment % segments;
    let outside = |layer: u32, segment: u32| inside(layer, segment) + segments;
    let mut triangles = Vec::new();
    for s in 0..segments {
        for l in 0..layers {
            let wall = [outside(l, s), outside(l, s + 1), outside(l + 1, s + 1), outside(l + 1, s)];
            triangles.extend(split_quad(wall));
            let bore = [inside(l, s), inside(l + 1, s), inside(l + 1, s + 1), inside(l, s + 1)];
            triangles.extend(split_quad(bore));
        }
        let bottom = [inside(0, s), inside(0, s + 1), outside(0, s + 1), outside(0, s)];
        triangles.extend(split_quad(bottom));
        let [l, next] = [layers, s + 1];
        let top = [inside(l, s), outside(l, s), outside(l, next), inside(l, next)];
        triangles.extend(split_quad(top));
    }
    Mesh::new(vertices, triangles, unit)
}

/// Generates a box with the given lowest and highest corner, closed and oriented outward. It has 12
/// triangles, two per side, with the sides in the order -x, +x, -y, +y, -z, +z.
///
/// # Errors
/// Fails unless `min < max` in each coordinate.
pub fn cuboid(min: Point3<f64>, max: Point3<f64>, unit: Unit) -> Result<Mesh, MeshError> {
    if !(0..3).all(|axis| min[axis] < max[axis]) {
        let rule = "its lowest corner must be below its highest in x, in y and in z";
        return Err(MeshError::Shape { shape: "cuboid", rule });
    }
    let vertices = (0..8usize).map(|corner| {
        // Each bit of the number decides along one axis.
        Point3::from([0, 1, 2].map(
            |axis| {
                if corner >> axis & 1 == 0 { min[axis] } else { max[axis] }
            },
        ))
    });
    let sides =
        [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    Mesh::new(vertices, sides.into_iter().flat_map(split_quad), unit)
}

/// Generates an open square sheet in z = 0 about the origin, with edges of length `2 half_width` and
/// normals +z. It is divided into `divisions`² squares, hence `2 divisions²` triangles.
///
/// # Errors
/// Fails unless `half_width > 0`, `divisions >= 1` and there are at most [`MAX_TRIANGLES`].
pub fn plane(half_width: f64, divisions: u32, unit: Unit) -> Result<Mesh, MeshError> {
    let fits = 2 * u128::from(divisions).pow(2) <= MAX_TRIANGLES.into();
    if !(0.0 < half_width && divisions >= 1 && fits) {
        let rule = "it needs a half width > 0, 1 division or more, and at most 2^25 triangles";
        return Err(MeshError::Shape { shape: "plane", rule });
    }
    let n = f64::from(divisions);
    let coordinate = |i: u32| half_width * ((2.0 * f64::from(i) - n) / n);
    let rows = (0..=divisions).flat_map(|j| (0..=divisions).map(move |i| (i, j)));
    let vertices = rows.map(|(i, j)| Point3::new(coordinate(i), coordinate(j), 0.0));
    let vertex = |i: u32, j: u32| j * (divisions + 1) + i;
    let squares = (0..divisions).flat_map(|j| (0..divisions).map(move |i| (i, j)));
    let triangles = squares.flat_map(|(i, j)| {
        split_quad([vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)])
    });
    Mesh::new(vertices, triangles, unit)
}

/// Generates a sphere about the origin, closed and oriented outward. The triangles of an icosahedron are divided into
/// four `subdivisions` times, hence `20 · 4^subdivisions` triangles; all vertices lie on the sphere.
///
/// # Errors
/// Fails unless `radius > 0` and `subdivisions <= 10`.
pub fn sphere(radius: f64, subdivisions: u32, unit: Unit) -> Result<Mesh, MeshError> {
    if !(0.0 < radius && subdivisions <= 10) {
        let rule = "it needs a radius > 0 and at most 10 subdivisions";
        return Err(MeshError::Shape { shape: "sphere", rule });
    }
    // The icosahedron: even permutations of (0, ±1, ±golden ratio).
    let golden = (1.0 + 5f64.sqrt()) / 2.0;
    let mut directions: Vec<Vector3<f64>> = Vec::new();
    for [one, golden_part] in [[1.0, golden], [-1.0, golden], [1.0, -golden], [-1.0, -golden]] {
        directions.push(Vector3::new(0.0, one, golden_part).normalize());
        directions.push(Vector3::new(one, golden_part, 0.0).normalize());
        directions.push(Vector3::new(golden_part, 0.0, one).normalize());
    }
    let mut triangles = icosahedron(&directions);
    for _ in 0..subdivisions {
        let mut middles = HashMap::new();
        let mut finer = Vec::with_capacity(4 * triangles.len());
        for [a, b, c] in triangles {
            let [ab, bc, ca] = [[a, b], [b, c], [c, a]].map(|[from, to]: [u32; 2]| {
                // Both triangles at an edge get the same vertex in its middle.
                *middles.entry((from.min(to), from.max(to))).or_insert_with(|| {
                    let middle = directions[from as usize] + directions[to as usize];
                    directions.push(middle.normalize());
                    directions.len() as u32 - 1
                })
            });
            finer.extend([[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]);
        }
        triangles = finer;
    }
    let vertices = directions.iter().map(|direction| Point3::from(radius * direction));
    Mesh::new(vertices, triangles, unit)
}

/// Returns the faces of the icosahedron: the triples of adjacent corners, oriented outward.
fn icosahedron(corners: &[Vector3<f64>]) -> Vec<[u32; 3]> {
    // Adjacent corners subtend 63.4 degrees at the centre, others 116.6 degrees or more.
    let are_adjacent = |a: usize, b: usize| corners[a].dot(&corners[b]) > 0.0;
    let mut faces = Vec::new();
    for a in 0..corners.len() {
        for b in (a + 1..corners.len()).filter(|&b| are_adjacent(a, b)) {
            for c in (b + 1..corners.len()).filter(|&c| are_adjacent(a, c) && are_adjacent(b, c)) {
                let outward = corners[a].dot(&corners[b].cross(&corners[c])) > 0.0;
                let [b, c] = if outward { [b, c] } else { [c, b] };
                faces.push([a, b, c].map(|corner| corner as u32));
            }
        }
    }
    faces
}

/// Splits a four-sided face into two triangles.
fn split_quad([a, b, c, d]: [u32; 4]) -> [[u32; 3]; 2] {
    [[a, b, c], [a, c, d]]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::id::TriangleId;
    use std::f64::consts::PI;

    const UNIT: Unit = Unit::Millimetre;

    fn is_close(found: f64, expected: f64) -> bool {
        (found / expected - 1.0).abs() < 1e-13
    }

    #[test]
    fn tubes_are_prisms_of_the_given_dimensions() {
        for (inner, outer, height, segments, layers) in
            [(3.0, 5.0, 13.116, 96, 23), (1e-9, 2e-9, 1e-9, 3, 1), (1.0, 1e6, 0.1, 7, 2)]
        {
            let mesh = tube(inner, outer, height, segments, layers, UNIT).expect("a tube");
            let diagnostics = mesh.diagnostics();
            let n = f64::from(segments);
            let base = n / 2.0 * (2.0 * PI / n).sin() * (outer * outer - inner * inner);
            let perimeter = 2.0 * n * (PI / n).sin() * (outer + inner);
            assert!(is_close(diagnostics.area, 2.0 * base + perimeter * height), "{diagnostics}");
            assert!(is_close(diagnostics.volume, base * height), "{diagnostics}");
            assert!(diagnostics.is_solid() && diagnostics.findings().len() == 1, "{diagnostics}");
            assert_eq!(diagnostics.triangles as u32, 4 * segments * (layers + 1));
        }
    }

    #[test]
    fn other_shapes_have_the_given_dimensions() {
        let [low, high] = [Point3::new(-1.0, 0.0, 2.0), Point3::new(1.0, 3.0, 6.0)];
        let diagnostics = cuboid(low, high, UNIT).expect("a cuboid").diagnostics();
        assert!(
            diagnostics.is_solid() && (diagnostics.area, diagnostics.volume) == (52.0, 24.0),
            "{diagnostics}"
        );

        let sheet = plane(2.0, 4, UNIT).expect("a plane");
        let diagnostics = sheet.diagnostics();
        assert_eq!(
            (diagnostics.area, diagnostics.open_edges, diagnostics.triangles),
            (16.0, 16, 32)
        );
        assert!(diagnostics.is_oriented() && sheet.normal(TriangleId(31)) == Some(Vector3::z()));

        for subdivisions in 0..6u32 {
            let diagnostics = sphere(3.0, subdivisions, UNIT).expect("a sphere").diagnostics();
            assert!(
                diagnostics.is_solid() && diagnostics.triangles == 20 << (2 * subdivisions),
                "{diagnostics}"
            );
            let volume_deficit = 1.0 - diagnostics.volume / (36.0 * PI);
            assert!(
                volume_deficit > 0.0 && volume_deficit < 0.6 / f64::from(1 << (2 * subdivisions)),
                "{volume_deficit}"
            );
        }
    }

    #[test]
    fn rejects_invalid_dimensions() {
        let p = |x: f64| Point3::new(x, 0.0, x);
        for result in [
            tube(5.0, 3.0, 1.0, 8, 1, UNIT),
            tube(0.0, 3.0, 1.0, 8, 1, UNIT),
            tube(1.0, 3.0, f64::NAN, 8, 1, UNIT),
            tube(1.0, 3.0, 1.0, 2, 1, UNIT),
            tube(1.0, 3.0, 1.0, 8, 0, UNIT),
            tube(1.0, 3.0, 1.0, u32::MAX, u32::MAX, UNIT),
            cuboid(p(0.0), p(1.0), UNIT),
            plane(-1.0, 1, UNIT),
            plane(1.0, 0, UNIT),
            plane(1.0, u32::MAX, UNIT),
            sphere(0.0, 1, UNIT),
            sphere(1.0, 11, UNIT),
        ] {
            let error = result.expect_err("it should be refused");
            assert!(matches!(error, MeshError::Shape { .. }), "{error}");
        }
        assert!(matches!(sphere(1e70, 0, UNIT), Err(MeshError::Coordinate { .. })));
    }
}
