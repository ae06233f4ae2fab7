//! The part and the fixtures as they are shown: long triangles are divided, so that a value does not colour a whole face.

use nalgebra::{Point3, Vector3};
use std::collections::HashMap;
use touchoff::{Mesh, Unit};

/// Number of pieces that the largest extent of a body is divided into, if it is divided.
const PIECES: f64 = 96.0;
/// Number of triangles above which the pieces are made larger.
const MAX_TRIANGLES: usize = 150_000;

/// A body as it is shown.
pub(super) struct Shown {
    pub(super) name: String,
    pub(super) unit: Unit,
    pub(super) vertices: Vec<Point3<f64>>,
    pub(super) triangles: Vec<[u32; 3]>,
    /// The triangle of the file that each triangle is a piece of.
    pub(super) sources: Vec<u32>,
    /// Set for a fixture, as opposed to the part and the stock.
    pub(super) is_fixture: bool,
    /// Set if the body has a frame of its own, in which the tool's poses at it are given.
    pub(super) has_own_frame: bool,
}

impl Shown {
    /// Divides the triangles of a mesh.
    pub(super) fn new(name: &str, mesh: &Mesh, [is_fixture, has_own_frame]: [bool; 2]) -> Shown {
        let mut longest = extent(mesh.vertices()) / PIECES;
        loop {
            let shown = Shown::divided((name, mesh, [is_fixture, has_own_frame]), longest);
            match shown {
                Some(shown) => return shown,
                None => longest *= 1.5,
            }
        }
    }

    /// Divides edges that are longer than `longest`; `None` if that makes too many triangles.
    fn divided(
        (name, mesh, [is_fixture, has_own_frame]): (&str, &Mesh, [bool; 2]),
        longest: f64,
    ) -> Option<Shown> {
        let mut shown = Shown {
            name: name.to_owned(),
            unit: mesh.unit(),
            vertices: mesh.vertices().to_vec(),
            triangles: Vec::new(),
            sources: Vec::new(),
            is_fixture,
            has_own_frame,
        };
        let limit = MAX_TRIANGLES.max(mesh.triangles().len());
        let mut middles: HashMap<[u32; 2], u32> = HashMap::new();
        let mut open = Vec::new();
        for (source, triangle) in (0..).zip(mesh.triangles()) {
            open.push(*triangle);
            while let Some([a, b, c]) = open.pop() {
                let length = |from: u32, to: u32| {
                    (shown.vertices[to as usize] - shown.vertices[from as usize]).norm()
                };
                // The longest edge is halved; of equal edges the one before in this list.
                let turns = [[a, b, c], [b, c, a], [c, a, b]];
                let [from, to, tip] = turns.into_iter().fold(turns[0], |best, turn| {
                    if length(turn[0], turn[1]) > length(best[0], best[1]) { turn } else { best }
                });
                if length(from, to) <= longest {
                    shown.triangles.push([a, b, c]);
                    shown.sources.push(source);
                    if shown.triangles.len() > limit {
                        return None;
                    }
                    continue;
                }
                let middle = *middles.entry([from.min(to), from.max(to)]).or_insert_with(|| {
                    let ends = [from, to].map(|end| shown.vertices[end as usize]);
                    shown.vertices.push(nalgebra::center(&ends[0], &ends[1]));
                    shown.vertices.len() as u32 - 1
                });
                open.extend([[from, middle, tip], [middle, to, tip]]);
            }
        }
        Some(shown)
    }

    /// Returns the corners of all triangles.
    pub(super) fn corners(&self) -> impl Iterator<Item = [Point3<f64>; 3]> + '_ {
        let corner = |vertex: u32| self.vertices[vertex as usize];
        self.triangles.iter().map(move |triangle| triangle.map(corner))
    }

    /// Returns the largest extent along an axis.
    pub(super) fn extent(&self) -> f64 {
        extent(&self.vertices)
    }
}

/// Returns the outward normal of a triangle, if it has an area.
pub(super) fn normal([a, b, c]: [Point3<f64>; 3]) -> Option<Vector3<f64>> {
    (b - a).cross(&(c - a)).try_normalize(0.0)
}

fn extent(vertices: &[Point3<f64>]) -> f64 {
    let first = vertices.first().copied().unwrap_or_default();
    let (low, high) = vertices
        .iter()
        .fold((first, first), |(low, high), vertex| (low.inf(vertex), high.sup(vertex)));
    (high - low).max()
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchoff::mesh::shapes;

    #[test]
    fn pieces_are_short_and_cover_the_mesh() {
        let (low, high) = (Point3::new(0.0, 0.0, 0.0), Point3::new(8.0, 3.0, 1.0));
        let cuboid = shapes::cuboid(low, high, Unit::Millimetre).expect("a cuboid");
        let shown = Shown::new("part", &cuboid, [false; 2]);
        let area = |[a, b, c]: [Point3<f64>; 3]| 0.5 * (b - a).cross(&(c - a)).norm();
        let mut areas = vec![0.0; cuboid.triangles().len()];
        for (corners, source) in shown.corners().zip(&shown.sources) {
            areas[*source as usize] += area(corners);
            for k in 0..3 {
                assert!((corners[k] - corners[(k + 1) % 3]).norm() <= 8.0 / PIECES);
            }
        }
        for (id, area) in cuboid.ids().zip(areas) {
            assert!((area - cuboid.area(id)).abs() < 1e-9, "{area}");
        }
        assert!(shown.triangles.len() <= MAX_TRIANGLES);
    }
}
