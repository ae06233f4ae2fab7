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
const PUT: usize = 25;
/// Maximum number of points tested against cells in the search for such holes, per point and per piece;
/// several times the usual number.
const MOST_HELD: usize = 1 << 9;
/// Initial distance of a hole from all points, in spacings.
const FAR: f64 = 0.95;
/// Ratio of the hole distances of successive rounds.
const NEARER: f64 = 0.97;

pub(super) fn blue(
    mesh: &Mesh,
    facets: &AreaSampler,
    surface: &Surface,
    count: usize,
    seed: u64,
) -> Cloud {
    let drawn = facets.even(mesh, count * CANDIDATES, seed);
    let put = count.div_ceil(PUT).min(count - 1);
    let kept = decimate::decimate(&drawn.points, &drawn.normals, facets.spread, count - put);
    let mut cloud = Cloud::with_capacity(count, mesh.unit());
    let take = |cloud: &mut Cloud, index: usize| {
        cloud.push(drawn.points[index], drawn.normals[index], drawn.triangles[index], 0.0);
    };
    kept.iter().for_each(|index| take(&mut cloud, *index as usize));

    let mut far = FAR * surface.spacing;
    let mut farthest = surface.farthest();
    let mut work = MOST_HELD * (count + farthest.len());
    while cloud.len() < count {
        let sites = VoronoiSites::new(surface, &cloud.points, &cloud.normals);
        let mut holes = surface.holes(&sites, far, &mut farthest, &mut work);
        holes.sort_unstable_by(|a, b| {
            let place =
                |hole: &Hole| (hole.triangle, <[f64; 3]>::from(hole.place).map(f64::to_bits));
            b.distance.total_cmp(&a.distance).then_with(|| place(a).cmp(&place(b)))
        });
        let mut taken = InsertedPoints::new(far);
        for hole in holes {
            if cloud.len() < count && taken.put(&hole) {
                let normal = mesh.normal(TriangleId(hole.triangle)).unwrap_or_default();
                cloud.push(hole.place, normal, hole.triangle, 0.0);
            }
        }
        far = NEARER * farthest.iter().copied().fold(0.0, f64::max).min(far);
        if far <= surface.rounded() || work == 0 {
            // No part of the surface is away from all points, or the search for such a part takes too
            // long. Take more of the drawn points instead.
            let mut rest = (0..drawn.len()).filter(|i| kept.binary_search(&(*i as u32)).is_err());
            let step = (drawn.len() - kept.len()) / (count - cloud.len()).max(1);
            while let Some(index) = rest.next().filter(|_| cloud.len() < count) {
                take(&mut cloud, index);
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
    all: Vec<Point3<f64>>,
}

impl InsertedPoints {
    fn new(width: f64) -> InsertedPoints {
        InsertedPoints { width, cells: HashMap::new(), all: vec![] }
    }

    /// Inserts a point into a hole, unless an inserted point is nearer to it than all others are.
    /// Returns whether the point was inserted.
    fn put(&mut self, hole: &Hole) -> bool {
        let cell = [0, 1, 2].map(|axis| (hole.place[axis] / self.width).floor() as i64);
        let reach = (hole.distance / self.width).ceil();
        let near = |place: &Point3<f64>| (place - hole.place).norm() < 0.999 * hole.distance;
        let taken = if (2.0 * reach + 1.0).powi(3) > self.all.len() as f64 {
            self.all.iter().any(near)
        } else {
            let each = || -(reach as i64)..=reach as i64;
            let beside =
                each().flat_map(|x| each().flat_map(move |y| each().map(move |z| [x, y, z])));
            let key = |by: [i64; 3]| [0, 1, 2].map(|axis| cell[axis].wrapping_add(by[axis]));
            beside.filter_map(|by| self.cells.get(&key(by))).flatten().any(near)
        };
        if !taken {
            self.cells.entry(cell).or_default().push(hole.place);
            self.all.push(hole.place);
        }
        !taken
    }
}
