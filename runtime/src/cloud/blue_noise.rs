//! Blue-noise sampling: random points are thinned, then more are inserted where the surface is farthest
//! from all.

use super::cells::Hole;
use super::pieces::Surface;
use super::sampling::AreaSampler;
use super::voronoi::VoronoiSites;
use super::{Cloud, decimate};
use crate::id::TriangleId;
use crate::mesh::Mesh;
use nalgebra::Point3;
use std::collections::HashMap;

/// Random candidates drawn per requested point.
const CANDIDATES: usize = 4;
/// One in this many of the final points is inserted where the surface is far from all others.
const POINTS_PER_HOLE: usize = 25;
/// Maximum number of points tested against cells in the search for such holes, per point and per piece;
/// several times the usual number.
const MAX_TESTS: usize = 1 << 9;
/// Initial distance of a hole from all points, in spacings.
const INITIAL_HOLE_DISTANCE: f64 = 0.95;
/// Ratio of the hole distances of successive rounds.
const HOLE_DISTANCE_RATIO: f64 = 0.97;

pub(super) fn sample_blue_noise(
    mesh: &Mesh,
    sampler: &AreaSampler,
    surface: &Surface,
    count: usize,
    seed: u64,
) -> Cloud {
    let candidates = sampler.stratified(mesh, count * CANDIDATES, seed);
    let hole_count = count.div_ceil(POINTS_PER_HOLE).min(count - 1);
    let kept = decimate::decimate(
        &candidates.points,
        &candidates.normals,
        sampler.distinct_area,
        count - hole_count,
    );
    let mut cloud = Cloud::with_capacity(count, mesh.unit());
    let push_candidate = |cloud: &mut Cloud, index: usize| {
        cloud.push(
            candidates.points[index],
            candidates.normals[index],
            candidates.triangles[index],
            0.0,
        );
    };
    kept.iter().for_each(|index| push_candidate(&mut cloud, *index as usize));

    let mut min_distance = INITIAL_HOLE_DISTANCE * surface.spacing;
    let mut farthest = surface.farthest();
    let mut remaining_tests = MAX_TESTS * (count + farthest.len());
    while cloud.len() < count {
        let sites = VoronoiSites::new(surface, &cloud.points, &cloud.normals);
        let mut holes = surface.holes(&sites, min_distance, &mut farthest, &mut remaining_tests);
        holes.sort_unstable_by(|a, b| {
            let sort_key =
                |hole: &Hole| (hole.triangle, <[f64; 3]>::from(hole.point).map(f64::to_bits));
            b.distance.total_cmp(&a.distance).then_with(|| sort_key(a).cmp(&sort_key(b)))
        });
        let mut inserted = InsertedPoints::new(min_distance);
        for hole in holes {
            if cloud.len() < count && inserted.insert(&hole) {
                let normal = mesh.normal(TriangleId(hole.triangle)).unwrap_or_default();
                cloud.push(hole.point, normal, TriangleId(hole.triangle), 0.0);
            }
        }
        min_distance =
            HOLE_DISTANCE_RATIO * farthest.iter().copied().fold(0.0, f64::max).min(min_distance);
        if min_distance <= surface.position_error() || remaining_tests == 0 {
            // No part of the surface is away from all points, or the search for such a part takes too
            // long. Take more of the drawn points instead.
            let mut rest =
                (0..candidates.len()).filter(|i| kept.binary_search(&(*i as u32)).is_err());
            let step = (candidates.len() - kept.len()) / (count - cloud.len()).max(1);
            while let Some(index) = rest.next().filter(|_| cloud.len() < count) {
                push_candidate(&mut cloud, index);
                rest.by_ref().take(step.max(1) - 1).for_each(drop);
            }
        }
    }
    cloud
}

/// Points inserted into holes, in a hash grid whose cell width is the smallest hole's distance from
/// other points.
struct InsertedPoints {
    width: f64,
    cells: HashMap<[i64; 3], Vec<Point3<f64>>>,
    points: Vec<Point3<f64>>,
}

impl InsertedPoints {
    fn new(width: f64) -> InsertedPoints {
        InsertedPoints { width, cells: HashMap::new(), points: vec![] }
    }

    /// Inserts a point into a hole, unless an inserted point is nearer to it than all others are.
    /// Returns whether the point was inserted.
    fn insert(&mut self, hole: &Hole) -> bool {
        let cell = [0, 1, 2].map(|axis| (hole.point[axis] / self.width).floor() as i64);
        let reach = (hole.distance / self.width).ceil();
        let is_near = |point: &Point3<f64>| (point - hole.point).norm() < 0.999 * hole.distance;
        let is_taken = if (2.0 * reach + 1.0).powi(3) > self.points.len() as f64 {
            self.points.iter().any(is_near)
        } else {
            let offsets = || -(reach as i64)..=reach as i64;
            let cells = offsets()
                .flat_map(|x| offsets().flat_map(move |y| offsets().map(move |z| [x, y, z])));
            let key =
                |offset: [i64; 3]| [0, 1, 2].map(|axis| cell[axis].wrapping_add(offset[axis]));
            cells.filter_map(|offset| self.cells.get(&key(offset))).flatten().any(is_near)
        };
        if !is_taken {
            self.cells.entry(cell).or_default().push(hole.point);
            self.points.push(hole.point);
        }
        !is_taken
    }
}
