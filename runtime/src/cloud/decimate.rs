//! Blue noise by sample elimination: the most crowded point is removed repeatedly until the requested
//! number is left (Yuksel 2015, *Sample elimination for generating Poisson disk sample sets*).
//!
//! The crowding of a point is a sum over its neighbours, kept in integers, so that it does not depend on
//! the order of removal. Removing a point only makes others less crowded. Therefore a point more crowded
//! than all its neighbours is removed before any of them, whatever happens elsewhere, and all such
//! points can be removed at once. Points are also removed in order of falling crowding. The algorithm
//! works in rounds, on all cores, and removes more points than requested. It then sorts the removed
//! points by their crowding at removal and restores the last of them. The result is the same as with one
//! removal at a time.

use super::SAME_SIDE;
use super::lists::Lists;
use crate::parallel;
use nalgebra::{Point3, Vector3};
use std::ops::Range;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

/// Crowding by a coincident neighbour: 40 bits, with room for 2^24 of them.
const MOST: f32 = (1u64 << 40) as f32;
/// Cells along an axis before cell numbers repeat.
const CELLS: u64 = 1 << 20;
/// Largest mean number of points examined around each. On a surface whose extent agrees with its area
/// there are some fifty.
const MOST_ABOUT: u64 = 512;
/// Maximum number of halvings of the neighbourhood radius if there are more.
const HALVINGS: usize = 32;
/// Points per parallel task.
const TOGETHER: usize = 1 << 14;

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
    let mut largest = (area / (2.0 * 3f64.sqrt() * count as f64)).sqrt();
    let mut crowd = CrowdedPoints::new(points, normals, largest, count);
    for _ in 0..HALVINGS {
        if crowd.is_none() {
            largest /= 2.0;
            crowd = CrowdedPoints::new(points, normals, largest, count);
        }
    }
    let Some(mut crowd) = crowd else { return distinct(points, count) };
    let mut gone = crowd.leave();
    // The most crowded first; among equals the last.
    parallel::sort(&mut gone);
    let gone = gone.into_iter().rev().take(excess);
    let mut left = vec![true; points.len()];
    let mut still = points.len();
    for (_, place) in gone {
        left[crowd.index[place as usize] as usize] = false;
        still -= 1;
    }
    // Points without neighbours are equally crowded, so remove the last of them.
    let kept = left.iter_mut().rev().filter(|kept| **kept);
    kept.take(still - count).for_each(|kept| *kept = false);
    (0..).zip(left).filter(|(_, kept)| *kept).map(|(index, _)| index).collect()
}

/// Returns the ascending indices of `count` points to keep where many coincide, preferring one point per
/// position.
fn distinct(points: &[Point3<f64>], count: usize) -> Vec<u32> {
    let place = |index: &u32| <[f64; 3]>::from(points[*index as usize]).map(f64::to_bits);
    let mut order: Vec<u32> = (0..points.len() as u32).collect();
    order.sort_unstable_by_key(|index| (place(index), *index));
    let (mut left, mut repeated) = (vec![], vec![]);
    for same in order.chunk_by(|a, b| place(a) == place(b)) {
        left.push(same[0]);
        repeated.extend(&same[1..]);
    }
    left.sort_unstable();
    if left.len() > count {
        return (0..count).map(|k| left[k * left.len() / count]).collect();
    }
    repeated.sort_unstable();
    left.extend(&repeated[..count - left.len()]);
    left.sort_unstable();
    left
}

/// Points in the order of their grid cells, with their crowding.
struct CrowdedPoints {
    /// The original index of each point.
    index: Vec<u32>,
    /// Coordinates, in units of the largest distance at which points crowd each other.
    place: [Vec<f32>; 3],
    normal: Vec<[f32; 3]>,
    /// The crowding of each point plus one; 0 for removed points.
    crowded: Vec<AtomicU64>,
    neighbours: Lists,
    /// Lower bound on the distance in the crowding formula; shorter distances count as this one.
    least: f32,
}

impl CrowdedPoints {
    /// Computes the crowding of points whose neighbourhood radius is twice `largest`. Returns `None` if
    /// too many points are that near, as where many triangles nearly coincide.
    fn new(
        points: &[Point3<f64>],
        normals: &[Vector3<f64>],
        largest: f64,
        count: usize,
    ) -> Option<CrowdedPoints> {
        let share = count as f64 / points.len() as f64;
        let least = (0.65 * (1.0 - share * share.sqrt())) as f32;
        let (mut low, mut high) = (points[0], points[0]);
        for point in points {
            (low, high) = (low.inf(point), high.sup(point));
        }
        let unit = 2.0 * largest;
        // Cells with equal numbers are far apart, so their points are not neighbours.
        let key = |point: &Point3<f64>| {
            let [x, y, z] =
                [0, 1, 2].map(|axis| ((point[axis] - low[axis]) / unit) as u64 % CELLS + 1);
            x << 42 | y << 21 | z
        };
        let mut keyed: Vec<(u64, u32)> = parallel::ranges(points.len(), TOGETHER, |range| {
            let start = range.start as u32;
            points[range].iter().zip(start..).map(|(p, i)| (key(p), i)).collect::<Vec<_>>()
        })
        .concat();
        parallel::sort(&mut keyed);
        let (mut keys, mut starts, mut cell) = (vec![], vec![], Vec::with_capacity(keyed.len()));
        for (place, (key, _)) in (0u32..).zip(&keyed) {
            if keys.last() != Some(key) {
                keys.push(*key);
                starts.push(place);
            }
            cell.push(keys.len() as u32 - 1);
        }
        starts.push(keyed.len() as u32);
        let rows =
            parallel::ranges(keys.len(), TOGETHER, |range| rows(&keys, &starts, range)).concat();
        let about = |row: &[[u32; 2]; 9]| row.iter().map(|[a, b]| u64::from(b - a)).sum::<u64>();
        let sum: u64 = cell.iter().map(|cell| about(&rows[*cell as usize])).sum();
        if sum > MOST_ABOUT * points.len() as u64 {
            return None;
        }
        let of = |axis: usize| {
            let places = keyed.iter().map(|(_, i)| points[*i as usize][axis] - low[axis]);
            places.map(|from| (from / unit) as f32).collect()
        };
        let normal = keyed.iter().map(|(_, i)| {
            let normal = normals[*i as usize];
            [normal.x as f32, normal.y as f32, normal.z as f32]
        });
        let mut crowd = CrowdedPoints {
            place: [of(0), of(1), of(2)],
            normal: normal.collect(),
            crowded: Vec::with_capacity(keyed.len()),
            neighbours: Lists::default(),
            least,
            index: keyed.iter().map(|(_, index)| *index).collect(),
        };
        let met = parallel::ranges(points.len(), TOGETHER, |range| {
            let (mut neighbours, mut sums) = (Lists::default(), Vec::with_capacity(range.len()));
            for place in range {
                let mut crowded = 1;
                for [first, last] in &rows[cell[place] as usize] {
                    for other in *first..*last {
                        if let Some(share) = crowd.share(place as u32, other) {
                            neighbours.push(other);
                            crowded += share;
                        }
                    }
                }
                neighbours.end();
                sums.push(crowded);
            }
            (neighbours, sums)
        });
        let (neighbours, sums): (Vec<Lists>, Vec<Vec<u64>>) = met.into_iter().unzip();
        crowd.neighbours = Lists::joined(neighbours);
        crowd.crowded.extend(sums.into_iter().flatten().map(AtomicU64::new));
        Some(crowd)
    }

    /// Returns the crowding that two points cause each other, or `None` if they are not neighbours.
    #[inline(always)]
    fn share(&self, one: u32, other: u32) -> Option<u64> {
        let (i, j) = (one as usize, other as usize);
        let [dx, dy, dz] = self.place.each_ref().map(|list| list[j] - list[i]);
        let squared = dx * dx + dy * dy + dz * dz;
        if squared >= 1.0 || one == other {
            return None;
        }
        let ([a, b, c], [x, y, z]) = (self.normal[i], self.normal[j]);
        (a * x + b * y + c * z > SAME_SIDE as f32).then(|| {
            let near = 1.0 - squared.sqrt().max(self.least);
            let fourth = (near * near) * (near * near);
            (fourth * fourth * MOST) as u64
        })
    }

    /// Removes all points that have neighbours, those first that are more crowded than all their
    /// neighbours. Returns the crowding of each at its removal, with its index.
    fn leave(&mut self) -> Vec<(u64, u32)> {
        let now = |place: u32| (self.crowded[place as usize].load(Relaxed), place);
        let mut gone = Vec::with_capacity(self.index.len());
        // Points that wait, each with a neighbour that was more crowded when last examined.
        let mut waiting: Vec<[u32; 2]> =
            (0..self.index.len() as u32).map(|place| [place, place]).collect();
        while !waiting.is_empty() {
            let looked = parallel::ranges(waiting.len(), TOGETHER, |range| {
                let (mut going, mut staying) = (vec![], Vec::with_capacity(range.len()));
                for &[place, before] in &waiting[range] {
                    let mine = now(place);
                    if mine.0 <= 1 {
                        continue;
                    }
                    if now(before) > mine {
                        staying.push([place, before]);
                        continue;
                    }
                    // Wait for the least of the more crowded neighbours: it stays the longest.
                    let others = self.neighbours.of(place).iter().map(|other| now(*other));
                    let above = others.filter(|other| *other > mine).min();
                    match above {
                        None => going.push(mine),
                        Some((_, above)) => staying.push([place, above]),
                    }
                }
                (going, staying)
            });
            let from = gone.len();
            waiting.clear();
            for (going, staying) in looked {
                gone.extend(going);
                waiting.extend(staying);
            }
            let going: &[(u64, u32)] = &gone[from..];
            parallel::ranges(going.len(), TOGETHER, |range| {
                for (_, place) in &going[range] {
                    self.crowded[*place as usize].store(0, Relaxed);
                    for other in self.neighbours.of(*place) {
                        let crowded = &self.crowded[*other as usize];
                        // Points removed in the same round are not neighbours, so no other thread sets
                        // this value to 0 meanwhile.
                        if crowded.load(Relaxed) != 0 {
                            crowded.fetch_sub(self.share(*place, *other).unwrap_or(0), Relaxed);
                        }
                    }
                }
            });
        }
        gone
    }
}

/// Returns, for each of some cells, the point ranges of the 3×3×3 cells around it, as nine rows along z.
fn rows(keys: &[u64], starts: &[u32], cells: Range<usize>) -> Vec<[[u32; 2]; 9]> {
    let mut rows = vec![[[0; 2]; 9]; cells.len()];
    for row in 0..9usize {
        let (dx, dy) = ((row / 3) as u64, (row % 3) as u64);
        // Cell coordinates are at least 1 along every axis, so the subtraction does not borrow between
        // fields.
        let first = |key: u64| key + (dx << 42) + (dy << 21) - (1 << 42 | 1 << 21 | 1);
        let mut at = keys.partition_point(|key| *key < first(keys[cells.start]));
        for (cell, rows) in cells.clone().zip(&mut rows) {
            let first = first(keys[cell]);
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
