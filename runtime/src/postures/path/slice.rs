//! The lines in which planes cut a mesh, in order.

use crate::mesh::Mesh;
use crate::postures::touching::Spot;
use nalgebra::{Point3, Vector3};
use std::collections::HashMap;

/// A part of a line that lies in one triangle.
#[derive(Clone, Copy, Debug)]
struct Piece {
    triangle: u32,
    ends: [Point3<f64>; 2],
}

/// A place of a line, and the triangle it lies in.
#[derive(Clone, Debug)]
pub(super) struct Place {
    pub(super) point: Point3<f64>,
    pub(super) triangle: u32,
    /// The sides that the line crossed since the place before, in order: on each its last triangle, and its next.
    pub(super) crossed: Vec<Spot>,
}

/// The lines in which parallel planes cut a mesh, plane by plane, as places about a step apart: at most that
/// far, and no nearer than half of it, but for the first of a line. Closed lines end where they begin.
pub(super) fn slices(
    mesh: &Mesh,
    normal: &Vector3<f64>,
    [stepover, step]: [f64; 2],
) -> Vec<Vec<Vec<Place>>> {
    let [low, high] = range(mesh, normal);
    let count = ((high - low) / stepover).round().max(1.0);
    let plane = |k: usize| low + (high - low) * (k as f64 + 0.5) / count;
    let mut planes: Vec<Vec<Piece>> = vec![Vec::new(); count as usize];
    for id in 0..mesh.triangles().len() as u32 {
        let corners = mesh.triangle(id);
        let heights = heights(mesh, normal, id);
        let place = |height: f64| (height - low) / (high - low) * count - 0.5;
        let least = heights.into_iter().fold(f64::INFINITY, f64::min);
        let most = heights.into_iter().fold(f64::NEG_INFINITY, f64::max);
        let first = place(least).floor().max(0.0) as usize;
        let last = place(most).ceil().max(0.0) as usize;
        for k in first..=last.min(planes.len() - 1) {
            if let Some(ends) = crossed(corners, heights, plane(k)) {
                planes[k].push(Piece { triangle: id, ends });
            }
        }
    }
    planes
        .iter()
        .map(|pieces| chains(pieces).iter().map(|line| along(mesh, line, step)).collect())
        .collect()
}

/// About how long all lines are together, each piece of area as long as it is steep to the planes and as they
/// are near to each other.
pub(super) fn length_of_lines(mesh: &Mesh, normal: &Vector3<f64>, stepover: f64) -> f64 {
    let [low, high] = range(mesh, normal);
    let steep = (0..mesh.triangles().len() as u32)
        .filter_map(|id| Some(mesh.area(id) * mesh.normal(id)?.cross(normal).norm()));
    steep.sum::<f64>() / stepover.min(high - low)
}

fn heights(mesh: &Mesh, normal: &Vector3<f64>, id: u32) -> [f64; 3] {
    mesh.triangle(id).map(|corner| corner.coords.dot(normal))
}

/// How low and how high a mesh is along a normal.
fn range(mesh: &Mesh, normal: &Vector3<f64>) -> [f64; 2] {
    let all = (0..mesh.triangles().len() as u32).flat_map(|id| heights(mesh, normal, id));
    all.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], height| {
        [low.min(height), high.max(height)]
    })
}

/// Where a plane crosses a triangle's sides: two of them or none, since a corner is on one side or the
/// other. Both triangles of a side have the same place.
fn crossed(corners: [Point3<f64>; 3], heights: [f64; 3], plane: f64) -> Option<[Point3<f64>; 2]> {
    let above = heights.map(|height| height >= plane);
    let mut places = (0..3).filter_map(|k| {
        let next = (k + 1) % 3;
        let (low, high) = if above[k] { (next, k) } else { (k, next) };
        (above[k] != above[next]).then(|| {
            let part = (plane - heights[low]) / (heights[high] - heights[low]);
            corners[low] + (corners[high] - corners[low]) * part
        })
    });
    Some([places.next()?, places.next()?])
}

/// Pieces as lines: those whose ends are the same place follow each other.
fn chains(pieces: &[Piece]) -> Vec<Vec<Piece>> {
    let key = |place: Point3<f64>| [place.x, place.y, place.z].map(|part| (part + 0.0).to_bits());
    let mut ends: HashMap<[u64; 3], Vec<usize>> = HashMap::new();
    for (index, piece) in pieces.iter().enumerate() {
        for end in piece.ends {
            ends.entry(key(end)).or_default().push(index);
        }
    }
    let mut used = vec![false; pieces.len()];
    let mut lines = Vec::new();
    // Open lines begin at an end that is nobody else's; what is left is closed.
    let open = |piece: &Piece| piece.ends.iter().position(|end| ends[&key(*end)].len() == 1);
    let starts = (0..pieces.len()).filter_map(|index| open(&pieces[index]).map(|end| (index, end)));
    for (start, end) in starts.chain((0..pieces.len()).map(|index| (index, 0))) {
        let mut line = Vec::new();
        let (mut at, mut from) = (start, pieces[start].ends[end]);
        while !used[at] {
            used[at] = true;
            let Piece { triangle, ends: [first, last] } = pieces[at];
            let to = if key(first) == key(from) { last } else { first };
            line.push(Piece { triangle, ends: [from, to] });
            from = to;
            match ends[&key(to)].iter().find(|other| !used[**other]) {
                Some(next) => at = *next,
                None => break,
            }
        }
        if !line.is_empty() {
            lines.push(line);
        }
    }
    lines
}

/// Places along a line: the middles of equal parts of its pieces, as far as they are not too near to the
/// last.
fn along(mesh: &Mesh, line: &[Piece], step: f64) -> Vec<Place> {
    let mut places: Vec<Place> = Vec::new();
    let mut since = f64::INFINITY;
    let mut crossed = Vec::new();
    for (index, Piece { triangle, ends: [from, to] }) in line.iter().enumerate() {
        if let Some(before) = index.checked_sub(1)
            && !places.is_empty()
        {
            let normals = [line[before].triangle, *triangle].map(|side| mesh.normal(side));
            let spot = |normal| Spot { point: *from, normal };
            crossed.extend(normals.into_iter().flatten().map(spot));
        }
        let way = to - from;
        let parts = (way.norm() / step).ceil().max(1.0);
        let part = way.norm() / parts;
        for k in 0..parts as usize {
            // Half a part to its middle, half a part on.
            since += 0.5 * part;
            if since >= 0.5 * step {
                let point = from + way * ((k as f64 + 0.5) / parts);
                let crossed = std::mem::take(&mut crossed);
                places.push(Place { point, triangle: *triangle, crossed });
                since = 0.0;
            }
            since += 0.5 * part;
        }
    }
    places
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::shapes;
    use crate::unit::Unit;
    use std::f64::consts::TAU;

    #[test]
    fn a_sphere_is_cut_in_circles() {
        let sphere = shapes::sphere(10.0, 5, Unit::Millimetre).expect("a sphere");
        let slices = slices(&sphere, &Vector3::z(), [1.0, 0.5]);
        assert_eq!(slices.len(), 20);
        for (k, lines) in slices.iter().enumerate() {
            let height = -9.5 + k as f64;
            assert_eq!(lines.len(), 1, "at {height}");
            let radius = (100.0 - height * height).sqrt();
            let line = &lines[0];
            let way: f64 = line.windows(2).map(|pair| (pair[1].point - pair[0].point).norm()).sum();
            assert!((way - TAU * radius).abs() < 0.6 + 0.01 * TAU * radius, "{way} at {height}");
            for pair in line.windows(2) {
                let far = (pair[1].point - pair[0].point).norm();
                assert!(far < 1.01, "{far} at {height}");
            }
            for place in line {
                assert!((place.point.z - height).abs() < 1e-9);
                assert!((place.point.coords.norm() - 10.0).abs() < 0.05);
            }
        }
    }

    #[test]
    fn a_face_in_the_plane_is_on_one_side_of_it() {
        let (low, high) = (Point3::new(0.0, 0.0, 0.0), Point3::new(4.0, 4.0, 2.0));
        let block = shapes::cuboid(low, high, Unit::Millimetre).expect("a block");
        let slices = slices(&block, &Vector3::x(), [4.0, 1.0]);
        assert_eq!((slices.len(), slices[0].len()), (1, 1));
        let way: f64 =
            slices[0][0].windows(2).map(|pair| (pair[1].point - pair[0].point).norm()).sum();
        assert!((10.0..12.0).contains(&way), "{way}");
    }
}
