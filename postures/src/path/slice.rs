//! Slices of a mesh by parallel planes, as ordered lines.

use crate::piece::key;
use crate::placement::SurfacePoint;
use nalgebra::{Point3, Vector3};
use std::collections::HashMap;
use touchoff::{Mesh, TriangleId};

/// The segment of a line within one triangle.
#[derive(Clone, Copy, Debug)]
struct SliceSegment {
    triangle: TriangleId,
    ends: [Point3<f64>; 2],
}

/// A point of a line, and the triangle that contains it.
#[derive(Clone, Debug)]
pub(super) struct SlicePoint {
    pub(super) point: Point3<f64>,
    pub(super) triangle: TriangleId,
    /// Points on the edges that the line crossed since the previous point, in order; per edge with the normals
    /// of the triangle before it and of the one after it.
    pub(super) crossed: Vec<SurfacePoint>,
}

/// Parallel planes in the middles of equal layers of a mesh, so that none lies in a face at the mesh's end.
#[derive(Clone, Copy, Debug)]
pub(super) struct Planes {
    /// Unit normal.
    normal: Vector3<f64>,
    /// Lowest coordinate of the mesh along the normal.
    low: f64,
    /// Extent of the mesh along the normal.
    extent: f64,
    count: usize,
}

impl Planes {
    /// Creates the planes that are nearest to a distance apart.
    pub(super) fn new(mesh: &Mesh, normal: &Vector3<f64>, stepover: f64) -> Planes {
        let [low, high] = range(mesh, normal);
        // A mesh thinner than half a stepover is still cut once.
        let count = ((high - low) / stepover).round().max(1.0);
        Planes { normal: *normal, low, extent: high - low, count: count as usize }
    }

    /// Returns the coordinate of a plane along the normal.
    pub(super) fn height(&self, plane: usize) -> f64 {
        self.low + self.extent * (plane as f64 + 0.5) / self.count as f64
    }

    /// Returns the coordinate along the normal of a point.
    pub(super) fn height_of(&self, point: &Point3<f64>) -> f64 {
        point.coords.dot(&self.normal)
    }

    /// Returns the position of a coordinate among the planes: `k` at plane `k`.
    pub(super) fn position(&self, height: f64) -> f64 {
        (height - self.low) / self.extent * self.count as f64 - 0.5
    }
}

/// Returns the lines in which planes cut a mesh, per plane, as points at most a step apart. A line begins within half a
/// step of its end and ends within a step of it; closed lines end where they begin.
pub(super) fn slices(mesh: &Mesh, planes: &Planes, step: f64) -> Vec<Vec<Vec<SlicePoint>>> {
    let mut segments: Vec<Vec<SliceSegment>> = vec![Vec::new(); planes.count];
    for id in mesh.ids() {
        let corners = mesh.triangle(id);
        let heights = heights(mesh, &planes.normal, id);
        let lowest = heights.into_iter().fold(f64::INFINITY, f64::min);
        let highest = heights.into_iter().fold(f64::NEG_INFINITY, f64::max);
        // Rounded outward: a plane too many is crossed nowhere, and one too few would leave a gap in a line.
        let first = planes.position(lowest).floor().max(0.0) as usize;
        let last = planes.position(highest).ceil().max(0.0) as usize;
        for (k, plane) in segments.iter_mut().enumerate().take(last + 1).skip(first) {
            if let Some(ends) = crossed(corners, heights, planes.height(k)) {
                plane.push(SliceSegment { triangle: id, ends });
            }
        }
    }
    segments
        .iter()
        .map(|segments| {
            join_segments(segments).iter().map(|line| sample_line(mesh, line, step)).collect()
        })
        .collect()
}

/// Estimates the total length of all lines: the area of each triangle times the sine of its angle to the
/// planes, divided by the distance between planes.
pub(super) fn length_of_lines(mesh: &Mesh, normal: &Vector3<f64>, stepover: f64) -> f64 {
    let [low, high] = range(mesh, normal);
    let projected_areas =
        mesh.ids().filter_map(|id| Some(mesh.area(id) * mesh.normal(id)?.cross(normal).norm()));
    projected_areas.sum::<f64>() / stepover.min(high - low)
}

fn heights(mesh: &Mesh, normal: &Vector3<f64>, id: TriangleId) -> [f64; 3] {
    mesh.triangle(id).map(|corner| corner.coords.dot(normal))
}

/// Returns the lowest and the highest coordinate of a mesh along a normal.
fn range(mesh: &Mesh, normal: &Vector3<f64>) -> [f64; 2] {
    let all = mesh.ids().flat_map(|id| heights(mesh, normal, id));
    all.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], height| {
        [low.min(height), high.max(height)]
    })
}

/// Returns the two points at which a plane crosses a triangle's sides, or `None`. A corner on the plane counts
/// as above it. Both triangles of a side get the same point.
fn crossed(corners: [Point3<f64>; 3], heights: [f64; 3], plane: f64) -> Option<[Point3<f64>; 2]> {
    let above = heights.map(|height| height >= plane);
    let mut points = (0..3).filter_map(|k| {
        let next = (k + 1) % 3;
        // From the lower corner in both triangles of the side, so that they round alike.
        let (low, high) = if above[k] { (next, k) } else { (k, next) };
        (above[k] != above[next]).then(|| {
            let fraction = (plane - heights[low]) / (heights[high] - heights[low]);
            corners[low] + (corners[high] - corners[low]) * fraction
        })
    });
    Some([points.next()?, points.next()?])
}

/// Joins segments into lines: segments that have an end in common follow each other.
fn join_segments(segments: &[SliceSegment]) -> Vec<Vec<SliceSegment>> {
    let mut ends: HashMap<[u64; 3], Vec<usize>> = HashMap::new();
    for (index, segment) in segments.iter().enumerate() {
        for end in segment.ends {
            ends.entry(key(end)).or_default().push(index);
        }
    }
    let mut used = vec![false; segments.len()];
    let mut lines = Vec::new();
    // Open lines begin at an end that no other segment has; the remaining lines are closed.
    let starts = segments.iter().enumerate().filter_map(|(index, segment)| {
        let open = segment.ends.iter().position(|end| ends[&key(*end)].len() == 1)?;
        Some((index, open))
    });
    for (start, end) in starts.chain((0..segments.len()).map(|index| (index, 0))) {
        let mut line = Vec::new();
        let (mut at, mut from) = (start, segments[start].ends[end]);
        while !used[at] {
            used[at] = true;
            let SliceSegment { triangle, ends: [first, last] } = segments[at];
            let to = if key(first) == key(from) { last } else { first };
            line.push(SliceSegment { triangle, ends: [from, to] });
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

/// Returns points along a line, at most a step apart and otherwise as few as possible. They are midpoints of equal
/// divisions of its segments, which are no longer than a step, so a next point is always near enough.
fn sample_line(mesh: &Mesh, line: &[SliceSegment], step: f64) -> Vec<SlicePoint> {
    let mut points: Vec<SlicePoint> = Vec::new();
    // The midpoint before the current one, with its distance along the line from the last point.
    let mut skipped: Option<(SlicePoint, f64)> = None;
    let mut distance = 0.0;
    let mut crossed = Vec::new();
    for (index, SliceSegment { triangle, ends: [from, to] }) in line.iter().enumerate() {
        if let Some(before) = index.checked_sub(1) {
            let normals = [line[before].triangle, *triangle].map(|side| mesh.normal(side));
            let normals = normals.into_iter().flatten();
            crossed.extend(normals.map(|normal| SurfacePoint { point: *from, normal }));
        }
        let displacement = to - from;
        let parts = (displacement.norm() / step).ceil().max(1.0);
        let fraction = displacement.norm() / parts;
        for k in 0..parts as usize {
            // Each division adds half its length before its midpoint, and half after it.
            distance += 0.5 * fraction;
            let point = from + displacement * ((k as f64 + 0.5) / parts);
            let mut next =
                SlicePoint { point, triangle: *triangle, crossed: std::mem::take(&mut crossed) };
            match skipped.take() {
                // Only the midpoint before is within a step of the last point.
                Some((last, at)) if distance > step => {
                    points.push(last);
                    distance -= at;
                }
                Some((last, _)) => next.crossed.splice(0..0, last.crossed).for_each(drop),
                None => {}
            }
            if points.is_empty() {
                points.push(next);
                distance = 0.0;
            } else {
                skipped = Some((next, distance));
            }
            distance += 0.5 * fraction;
        }
    }
    // The rest of the line, if it is long enough to be worth a point.
    points.extend(skipped.filter(|(_, at)| *at >= 0.5 * step).map(|(last, _)| last));
    points
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;
    use touchoff::Unit;
    use touchoff::mesh::shapes;

    #[test]
    fn a_sphere_is_cut_in_circles() {
        let sphere = shapes::sphere(10.0, 5, Unit::Millimetre).expect("a sphere");
        let slices = slices(&sphere, &Planes::new(&sphere, &Vector3::z(), 1.0), 0.5);
        assert_eq!(slices.len(), 20);
        for (k, lines) in slices.iter().enumerate() {
            let height = -9.5 + k as f64;
            assert_eq!(lines.len(), 1, "at {height}");
            let radius = (100.0 - height * height).sqrt();
            let line = &lines[0];
            let displacement: f64 =
                line.windows(2).map(|pair| (pair[1].point - pair[0].point).norm()).sum();
            assert!(
                (displacement - TAU * radius).abs() < 0.6 + 0.01 * TAU * radius,
                "{displacement} at {height}"
            );
            for pair in line.windows(2) {
                let spacing = (pair[1].point - pair[0].point).norm();
                assert!(spacing <= 0.5 + 1e-9, "{spacing} at {height}");
            }
            for point in line {
                assert!((point.point.z - height).abs() < 1e-9);
                assert!((point.point.coords.norm() - 10.0).abs() < 0.05);
            }
        }
    }

    #[test]
    fn a_face_in_the_plane_is_on_one_side_of_it() {
        let (low, high) = (Point3::new(0.0, 0.0, 0.0), Point3::new(4.0, 4.0, 2.0));
        let block = shapes::cuboid(low, high, Unit::Millimetre).expect("a block");
        let slices = slices(&block, &Planes::new(&block, &Vector3::x(), 4.0), 1.0);
        assert_eq!((slices.len(), slices[0].len()), (1, 1));
        let displacement: f64 =
            slices[0][0].windows(2).map(|pair| (pair[1].point - pair[0].point).norm()).sum();
        assert!((10.0..12.0).contains(&displacement), "{displacement}");
    }
}
