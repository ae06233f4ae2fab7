//! Blue-noise sampling: random points are thinned, then more are inserted where the surface is farthest from all.
//!
//! Points are thinned by sample elimination: the most crowded point is removed repeatedly until the requested number is
//! left (Yuksel 2015, *Sample elimination for generating Poisson disk sample sets*). The crowding of a point is a sum
//! over its neighbours, kept in integers, so that it does not depend on the order of removal. Removing a point only
//! makes others less crowded. Therefore a point more crowded than all its neighbours is removed before any of them,
//! whatever happens elsewhere, and all such points can be removed at once. Points are also removed in order of falling
//! crowding. The algorithm works in rounds, on all cores, and removes more points than requested. It then sorts the
//! removed points by their crowding at removal and restores the last of them. The result is the same as with one
//! removal at a time.

use crate::cloud::neighbours::Lists;
use crate::cloud::pieces::Surface;
use crate::cloud::sampling::AreaSampler;
use crate::cloud::voronoi::{Hole, VoronoiSites};
use crate::cloud::{Cloud, SAME_SIDE};
use crate::id::TriangleId;
use crate::mesh::{Mesh, position_bits};
use crate::parallel;
use nalgebra::{Point3, Vector3};
use std::collections::HashMap;
use std::ops::Range;
use std::sync::atomic::AtomicU64;
use std::sync::atomic::Ordering::Relaxed;

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
    let kept = decimate(
        &candidates.points,
        &candidates.normals,
        sampler.distinct_area,
        count - hole_count,
    );
    let mut cloud = Cloud::with_capacity(count, mesh.unit());
    kept.iter().for_each(|index| cloud.push_of(&candidates, *index as usize));

    let mut min_distance = INITIAL_HOLE_DISTANCE * surface.spacing;
    let mut farthest = surface.farthest();
    let mut remaining_tests = MAX_TESTS * (count + farthest.len());
    while cloud.len() < count {
        let sites = VoronoiSites::new(surface, &cloud.points, &cloud.normals);
        let mut holes = surface.holes(&sites, min_distance, &mut farthest, &mut remaining_tests);
        // The order of the pieces that found them must not matter, so equally far holes have an order of their own.
        holes.sort_unstable_by(|a, b| {
            let [key_a, key_b] =
                [a, b].map(|hole| (hole.triangle, <[f64; 3]>::from(hole.point).map(f64::to_bits)));
            b.distance.total_cmp(&a.distance).then_with(|| key_a.cmp(&key_b))
        });
        // A point in one hole may fill others: those found from nearby corners are passed over in this round.
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
            // Evenly from all over the list, which is in the order of the triangles.
            let step = (candidates.len() - kept.len()) / (count - cloud.len()).max(1);
            while let Some(index) = rest.next().filter(|_| cloud.len() < count) {
                cloud.push_of(&candidates, index);
                rest.by_ref().take(step.max(1) - 1).for_each(drop);
            }
        }
    }
    cloud
}

/// Points inserted into holes, in a hash grid whose cell width is the smallest hole's distance from other points.
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
        // Where the cells within reach outnumber the points, the points are examined one by one.
        let is_taken = if (2.0 * reach + 1.0).powi(3) > self.points.len() as f64 {
            self.points.iter().any(|point| hole.is_crowded_by(point))
        } else {
            let range = -(reach as i64)..=reach as i64;
            range.clone().any(|x| {
                range.clone().any(|y| {
                    range.clone().any(|z| {
                        let key = [0, 1, 2].map(|axis| cell[axis].wrapping_add([x, y, z][axis]));
                        let mut points = self.cells.get(&key).into_iter().flatten();
                        points.any(|point| hole.is_crowded_by(point))
                    })
                })
            })
        };
        if !is_taken {
            self.cells.entry(cell).or_default().push(hole.point);
            self.points.push(hole.point);
        }
        !is_taken
    }
}

/// Crowding by a coincident neighbour: 40 bits, with room for 2^24 of them.
const MAX_CROWDING: f32 = (1u64 << 40) as f32;
/// Cells along an axis before cell numbers repeat.
const CELLS_PER_AXIS: u64 = 1 << 20;
/// Largest mean number of points examined around each. On a surface whose extent agrees with its area
/// there are some fifty.
const MAX_MEAN_NEIGHBOURS: u64 = 512;
/// Maximum number of halvings of the neighbourhood radius if there are more.
const MAX_HALVINGS: i32 = 32;
/// Points per parallel task.
const POINTS_PER_TASK: usize = 1 << 14;

/// Returns the ascending indices of the `count` points to keep, on a surface of the given area.
pub(super) fn decimate(
    points: &[Point3<f64>],
    normals: &[Vector3<f64>],
    area: f64,
    count: usize,
) -> Vec<u32> {
    let excess = points.len().saturating_sub(count);
    if excess == 0 {
        return (0..points.len() as u32).collect();
    }
    // The radius of `count` discs that would cover that area in the densest packing.
    let radius = (area / (2.0 * 3f64.sqrt() * count as f64)).sqrt();
    let mut radii = (0..=MAX_HALVINGS).map(|halvings| radius * 0.5f64.powi(halvings));
    let crowded_points =
        radii.find_map(|radius| CrowdedPoints::new(points, normals, radius, count));
    let Some(mut crowded_points) = crowded_points else { return distinct(points, count) };
    let mut removed = crowded_points.remove_crowded();
    // The most crowded first; among equals the last.
    parallel::sort(&mut removed);
    let removed = removed.into_iter().rev().take(excess);
    let mut is_kept = vec![true; points.len()];
    let mut remaining = points.len();
    for (_, slot) in removed {
        is_kept[crowded_points.index[slot as usize] as usize] = false;
        remaining -= 1;
    }
    // Points without neighbours are equally crowded, so remove the last of them.
    let kept = is_kept.iter_mut().rev().filter(|kept| **kept);
    kept.take(remaining - count).for_each(|kept| *kept = false);
    (0..).zip(is_kept).filter(|(_, kept)| *kept).map(|(index, _)| index).collect()
}

/// Returns the ascending indices of `count` points to keep where many coincide, preferring one point per position.
fn distinct(points: &[Point3<f64>], count: usize) -> Vec<u32> {
    let mut keyed: Vec<([u64; 3], u32)> = points
        .iter()
        .zip(0u32..)
        .map(|(point, index)| (position_bits((*point).into()), index))
        .collect();
    keyed.sort_unstable();
    let (mut kept, mut repeated) = (vec![], vec![]);
    for coincident in keyed.chunk_by(|a, b| a.0 == b.0) {
        kept.push(coincident[0].1);
        repeated.extend(coincident[1..].iter().map(|(_, index)| *index));
    }
    kept.sort_unstable();
    if kept.len() > count {
        return (0..count).map(|k| kept[k * kept.len() / count]).collect();
    }
    repeated.sort_unstable();
    kept.extend(&repeated[..count - kept.len()]);
    kept.sort_unstable();
    kept
}

/// Points in the order of their grid cells, with their crowding.
struct CrowdedPoints {
    /// The original index of each point.
    index: Vec<u32>,
    /// Coordinates, in units of the largest distance at which points crowd each other.
    positions: [Vec<f32>; 3],
    normal: Vec<[f32; 3]>,
    /// The crowding of each point plus one; 0 for removed points.
    crowding: Vec<AtomicU64>,
    neighbours: Lists,
    /// Lower bound on the distance in the crowding formula; shorter distances count as this one.
    min_distance: f32,
}

impl CrowdedPoints {
    /// Computes the crowding of points whose neighbourhood radius is twice `radius`. Returns `None` if
    /// too many points are that near, as where many triangles nearly coincide.
    fn new(
        points: &[Point3<f64>],
        normals: &[Vector3<f64>],
        radius: f64,
        count: usize,
    ) -> Option<CrowdedPoints> {
        let share = count as f64 / points.len() as f64;
        let min_distance = (0.65 * (1.0 - share * share.sqrt())) as f32;
        let (mut low, mut high) = (points[0], points[0]);
        for point in points {
            (low, high) = (low.inf(point), high.sup(point));
        }
        let unit = 2.0 * radius;
        let mut keyed: Vec<(u64, u32)> = parallel::ranges(points.len(), POINTS_PER_TASK, |range| {
            let start = range.start as u32;
            points[range]
                .iter()
                .zip(start..)
                .map(|(point, index)| (cell_key((point - low) / unit), index))
                .collect::<Vec<_>>()
        })
        .concat();
        parallel::sort(&mut keyed);
        let (mut keys, mut starts, mut cell) = (vec![], vec![], Vec::with_capacity(keyed.len()));
        for (slot, (key, _)) in (0u32..).zip(&keyed) {
            if keys.last() != Some(key) {
                keys.push(*key);
                starts.push(slot);
            }
            cell.push(keys.len() as u32 - 1);
        }
        starts.push(keyed.len() as u32);
        let rows =
            parallel::ranges(keys.len(), POINTS_PER_TASK, |range| rows(&keys, &starts, range))
                .concat();
        let ranges = cell.iter().flat_map(|cell| &rows[*cell as usize]);
        let sum: u64 = ranges.map(|[first, end]| u64::from(end - first)).sum();
        if sum > MAX_MEAN_NEIGHBOURS * points.len() as u64 {
            return None;
        }
        let normal = keyed.iter().map(|(_, i)| {
            let normal = normals[*i as usize];
            [normal.x as f32, normal.y as f32, normal.z as f32]
        });
        let mut crowded_points = CrowdedPoints {
            positions: [0, 1, 2].map(|axis| {
                let places = keyed.iter().map(|(_, i)| points[*i as usize][axis] - low[axis]);
                places.map(|from| (from / unit) as f32).collect()
            }),
            normal: normal.collect(),
            crowding: Vec::with_capacity(keyed.len()),
            neighbours: Lists::default(),
            min_distance,
            index: keyed.iter().map(|(_, index)| *index).collect(),
        };
        let results = parallel::ranges(points.len(), POINTS_PER_TASK, |range| {
            let (mut neighbours, mut sums) = (Lists::default(), Vec::with_capacity(range.len()));
            for slot in range {
                let mut crowding = 1;
                for [first, last] in &rows[cell[slot] as usize] {
                    for other in *first..*last {
                        if let Some(mutual) = crowded_points.mutual_crowding(slot as u32, other) {
                            neighbours.push(other);
                            crowding += mutual;
                        }
                    }
                }
                neighbours.end();
                sums.push(crowding);
            }
            (neighbours, sums)
        });
        let (neighbours, sums): (Vec<Lists>, Vec<Vec<u64>>) = results.into_iter().unzip();
        crowded_points.neighbours = Lists::joined(neighbours);
        crowded_points.crowding.extend(sums.into_iter().flatten().map(AtomicU64::new));
        Some(crowded_points)
    }

    /// Returns the crowding that two points cause each other, or `None` if they are not neighbours.
    #[inline(always)]
    fn mutual_crowding(&self, one: u32, other: u32) -> Option<u64> {
        let (i, j) = (one as usize, other as usize);
        let [dx, dy, dz] = self.positions.each_ref().map(|list| list[j] - list[i]);
        let squared = dx * dx + dy * dy + dz * dz;
        if squared >= 1.0 || one == other {
            return None;
        }
        let ([a, b, c], [x, y, z]) = (self.normal[i], self.normal[j]);
        (a * x + b * y + c * z > SAME_SIDE as f32).then(|| {
            let near = 1.0 - squared.sqrt().max(self.min_distance);
            let fourth = (near * near) * (near * near);
            (fourth * fourth * MAX_CROWDING) as u64
        })
    }

    /// Returns the crowding of a point with its slot, which decides among equally crowded points.
    fn current(&self, slot: u32) -> (u64, u32) {
        (self.crowding[slot as usize].load(Relaxed), slot)
    }

    /// Removes all points that have neighbours, those first that are more crowded than all their
    /// neighbours. Returns the crowding of each at its removal, with its slot.
    fn remove_crowded(&mut self) -> Vec<(u64, u32)> {
        let mut removed = Vec::with_capacity(self.index.len());
        // Points that wait, each with a neighbour that was more crowded when last examined.
        let mut waiting: Vec<[u32; 2]> =
            (0..self.index.len() as u32).map(|slot| [slot, slot]).collect();
        while !waiting.is_empty() {
            let decisions = parallel::ranges(waiting.len(), POINTS_PER_TASK, |range| {
                let (mut removed_now, mut still_waiting) =
                    (vec![], Vec::with_capacity(range.len()));
                for &[slot, blocker] in &waiting[range] {
                    let own = self.current(slot);
                    // No neighbour is left, or the point itself is removed.
                    if own.0 <= 1 {
                        continue;
                    }
                    if self.current(blocker) > own {
                        still_waiting.push([slot, blocker]);
                        continue;
                    }
                    // Wait for the least of the more crowded neighbours: it stays the longest.
                    let others = self.neighbours.of(slot).iter().map(|other| self.current(*other));
                    let more_crowded = others.filter(|other| *other > own).min();
                    match more_crowded {
                        None => removed_now.push(own),
                        Some((_, more_crowded)) => still_waiting.push([slot, more_crowded]),
                    }
                }
                (removed_now, still_waiting)
            });
            let from = removed.len();
            waiting.clear();
            for (removed_now, still_waiting) in decisions {
                removed.extend(removed_now);
                waiting.extend(still_waiting);
            }
            let removed_now: &[(u64, u32)] = &removed[from..];
            parallel::ranges(removed_now.len(), POINTS_PER_TASK, |range| {
                for (_, slot) in &removed_now[range] {
                    self.crowding[*slot as usize].store(0, Relaxed);
                    for other in self.neighbours.of(*slot) {
                        let crowding = &self.crowding[*other as usize];
                        // Points removed in the same round are not neighbours, so no other thread sets
                        // this value to 0 meanwhile.
                        if crowding.load(Relaxed) != 0 {
                            let mutual = self.mutual_crowding(*slot, *other);
                            crowding.fetch_sub(mutual.unwrap_or(0), Relaxed);
                        }
                    }
                }
            });
        }
        removed
    }
}

/// Returns the number of the grid cell that contains a point, given in units of the cells' width: 21 bits per axis, each
/// at least 1. Cells with equal numbers are far apart, so their points are not neighbours.
fn cell_key(point: Vector3<f64>) -> u64 {
    let [x, y, z] = [0, 1, 2].map(|axis| point[axis] as u64 % CELLS_PER_AXIS + 1);
    x << 42 | y << 21 | z
}

/// Returns, for each of some cells, the point ranges of the 3×3×3 cells around it, as nine rows along z.
fn rows(keys: &[u64], starts: &[u32], cells: Range<usize>) -> Vec<[[u32; 2]; 9]> {
    let mut rows = vec![[[0; 2]; 9]; cells.len()];
    for row in 0..9usize {
        let (dx, dy) = ((row / 3) as u64, (row % 3) as u64);
        // Cell coordinates are at least 1 along every axis, so the subtraction does not borrow between fields.
        let offset = (dx << 42) + (dy << 21);
        let corner = 1 << 42 | 1 << 21 | 1;
        let mut at = keys.partition_point(|key| *key < keys[cells.start] + offset - corner);
        for (cell, rows) in cells.clone().zip(&mut rows) {
            let first = keys[cell] + offset - corner;
            while at < keys.len() && keys[at] < first {
                at += 1;
            }
            let mut end = at;
            while end < keys.len() && keys[end] <= first + 2 {
                end += 1;
            }
            rows[row] = [starts[at], starts[end]];
        }
    }
    rows
}
