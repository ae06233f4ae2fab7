//! Restricted Voronoi diagram: the division of a piece of the surface among points.
//!
//! A triangle is divided by `|x − p|² + σ² |n − m|²`, with p a point, m its normal, x a point of the
//! triangle and n the triangle's normal. The nearest point owns x; a point with another normal owns it
//! only if it is much nearer. Cells therefore end at edges, and the two sides of a thin sheet stay
//! separate, but a face without points of its own goes to nearby points. In the triangle's plane this is
//! a power diagram: cells are convex. Each cell is the piece cut by straight lines, one per neighbour,
//! until no farther point can reach it. The diagram is traversed from one cell to all cells whose lines
//! touch it. With σ = 0 the corners of cells are the local maxima of the distance from all points (Lévy
//! and Bonneel 2013 describe both uses of such diagrams).
//!
//! **Rounding** does not decide ownership: a line cuts only what lies beyond it by more than the error
//! bound. A computed cell therefore contains the exact one, and the neighbours of the exact cell touch it.
//! If all corners of a cell are within the error bound of the line between two points (coincident or
//! mirrored points), the point with the lower index owns the whole cell.
//!
//! Let `u` be the unit roundoff, `t` the vector from a cell's point to another point, `v` a corner
//! relative to the cell's point, and `b` and `m` the terms of the normals. `reach` is at least `2 |v|`.
//! The signed distance of `v` beyond the line, `v·t - (t² + b - m)/2`, has the following errors:
//!
//! | source | error |
//! |---|--:|
//! | `v` and `t`, differences of given points | 1 u reach t |
//! | their product, less the half | 2 u reach t + 1 u (t² + b + m) |
//! | `t²`: 5u, `b` and `m`: 7u, their sum: 2u; half of that | 4.5 u (t² + b + m) |
//! | a corner where a line cuts an edge of at most `2 |v|`: a difference, a product, a sum | 2.5 u reach t |
//! | the same for each earlier cut of the cell, since new corners depend on old ones | 2.5 u reach t each |
//!
//! The sum is less than `(8 + 2 cuts) ε (reach t + t² + b + m)`.

use super::lists::Lists;
use super::pieces::{Surface, SurfacePiece};
use super::point_grid::{self, NeighbourBvh};
use crate::parallel;
use nalgebra::{Point3, Vector3};
use std::collections::HashSet;

/// Radius, in spacings, that contains most of the points that cut a cell.
const NEIGHBOUR_RADIUS: f64 = 2.5;
/// Maximum number of these points that are kept. Where a part's extent agrees with its area, there are
/// some twenty.
const MAX_NEIGHBOURS: usize = 128;
/// Fixed cost of a cell, in units of one point tested against a cell.
const CELL_COST: usize = 16;
/// Cost of finding and sorting one of the nearest points, in the same unit.
const NEIGHBOUR_COST: usize = 4;
/// Maximum number of points met that are searched linearly.
const MAX_LINEAR_SEARCH: usize = 64;
/// Points per parallel task.
const POINTS_PER_TASK: usize = 1 << 10;
/// Returns the error bound of a corner's signed distance from a line, relative to the sum of the
/// magnitudes of its terms, after `cuts` cuts of the cell (see above). It is constant up to twelve cuts,
/// which most cells do not exceed.
fn rounding(cuts: u32) -> f64 {
    f64::EPSILON * f64::from(8 + 2 * cuts.max(12))
}

/// Points on a surface, with their spatial index.
pub(super) struct VoronoiSites<'a> {
    pub(super) points: &'a [Point3<f64>],
    normals: &'a [Vector3<f64>],
    tree: NeighbourBvh,
    /// The points within `neighbour_radius` of each, the nearest first, at most [`MAX_NEIGHBOURS`].
    neighbours: Lists,
    neighbour_radius: f64,
}

/// A corner of a cell relative to its point, and the point whose line the next edge lies on.
pub(super) type Corner = (Vector3<f64>, u32);
/// Marks an edge of the piece, which belongs to no point.
pub(super) const EDGE: u32 = u32::MAX;

/// Reusable buffers for dividing a piece.
#[derive(Default)]
pub(super) struct ClipBuffers {
    found: Vec<(f64, u32)>,
    farther: Vec<u32>,
    cell: Vec<Corner>,
    cut: Vec<Corner>,
    /// Points whose lines have touched the cell, with the vectors and offsets of the lines and the terms
    /// of their error bounds.
    touched: Vec<(u32, Vector3<f64>, f64, f64)>,
    /// Points whose cells are or will be computed; the first owns the piece's centre.
    pub(super) visited: Vec<u32>,
    /// The same points as a set, if there are many.
    visited_set: HashSet<u32>,
    /// The number of points tested against cells, plus the other costs of the cells.
    pub(super) tests: usize,
}

impl<'a> VoronoiSites<'a> {
    pub(super) fn new(
        surface: &Surface,
        points: &'a [Point3<f64>],
        normals: &'a [Vector3<f64>],
    ) -> VoronoiSites<'a> {
        let tree = NeighbourBvh::new(points);
        // Where the area does not predict the distances between points, the nearest ones are taken.
        let neighbour_radius =
            if surface.is_coarse() { f64::INFINITY } else { NEIGHBOUR_RADIUS * surface.spacing };
        let lists = parallel::ranges(points.len(), POINTS_PER_TASK, |range| {
            let (mut found, mut neighbours) = (vec![], Lists::default());
            for site in range {
                tree.nearest_within(
                    points[site].into(),
                    neighbour_radius,
                    MAX_NEIGHBOURS,
                    &mut found,
                );
                found.iter().for_each(|(_, other)| neighbours.push(*other));
                neighbours.end();
            }
            neighbours
        });
        let neighbours = Lists::joined(lists);
        VoronoiSites { points, normals, tree, neighbours, neighbour_radius }
    }
}

impl Surface {
    /// Calls `on_cell` for each point that has a cell in a piece, with the cell's corners relative to the
    /// point. `normal_weight` is σ². Returns whether the division is complete: it ends after about `max_tests` tests
    /// of points against cells.
    pub(super) fn divide(
        &self,
        piece: &SurfacePiece,
        sites: &VoronoiSites<'_>,
        normal_weight: f64,
        max_tests: usize,
        buffers: &mut ClipBuffers,
        mut on_cell: impl FnMut(u32, &[Corner]),
    ) -> bool {
        let ClipBuffers { found, farther, cell, cut, touched, visited, visited_set, tests } =
            buffers;
        let power_weight = |site: u32| {
            normal_weight * (sites.normals[site as usize] - piece.normal).norm_squared()
        };
        visited.clear();
        *tests = 0;
        if !visited_set.is_empty() {
            visited_set.clear();
        }
        visited.push(self.site_at_centre(piece, sites, power_weight));
        let mut next = 0;
        while let Some(&site) = visited.get(next) {
            if next > 0 && *tests >= max_tests {
                return false;
            }
            next += 1;
            *tests += CELL_COST;
            let (site_point, own_weight) = (sites.points[site as usize], power_weight(site));
            cell.clear();
            cell.extend(self.corners(piece).iter().map(|corner| (corner - site_point, EDGE)));
            touched.clear();
            let mut cuts = 0;
            let mut reach = reach_of(cell, own_weight);
            let neighbours = sites.neighbours.of(site);
            let mut list = neighbours;
            // The number of nearest points that may have been examined.
            let mut max_neighbours = MAX_NEIGHBOURS;
            let mut last =
                neighbours.last().copied().filter(|_| neighbours.len() == max_neighbours);
            let mut searched_radius = sites.neighbour_radius;
            'cut: loop {
                for &other in list.iter().filter(|other| **other != site) {
                    *tests += 1;
                    let to_other = sites.points[other as usize] - site_point;
                    let squared = to_other.norm_squared();
                    if squared > reach * reach {
                        break 'cut;
                    }
                    let other_weight = power_weight(other);
                    let half = (squared + other_weight - own_weight) / 2.0;
                    let terms = reach * squared.sqrt() + squared + other_weight + own_weight;
                    let slack = rounding(cuts) * terms;
                    let [min_value, max_value] = signed_distances(cell, &to_other, half);
                    if max_value < -slack {
                        continue;
                    }
                    touched.push((other, to_other, half, terms));
                    if max_value <= slack {
                        if min_value >= -slack && other < site {
                            cell.clear();
                            add_visited(visited, visited_set, other);
                            break 'cut;
                        }
                    } else if clip(cell, cut, to_other, half + slack, other) {
                        if cell.is_empty() {
                            break 'cut;
                        }
                        cuts += 1;
                        reach = reach_of(cell, own_weight);
                    }
                }
                if reach <= searched_radius && last.is_none() {
                    break;
                }
                let remaining = max_tests.saturating_sub(*tests);
                if remaining <= max_neighbours {
                    return false;
                }
                let from = |other: u32| {
                    point_grid::squared_distance(
                        sites.points[other as usize].into(),
                        site_point.into(),
                    )
                };
                let last_key = last.map(|last| (from(last), last));
                let is_new = |one: &&(f64, u32)| match last_key {
                    None => one.0 > searched_radius * searched_radius,
                    Some(last) => point_grid::nearer(&last, one).is_lt(),
                };
                max_neighbours = (8 * max_neighbours).min(remaining);
                sites.tree.nearest_within(site_point.into(), reach, max_neighbours, found);
                *tests += NEIGHBOUR_COST * found.len();
                farther.clear();
                farther.extend(found.iter().filter(is_new).map(|(_, other)| *other));
                list = farther;
                last =
                    found.last().map(|(_, last)| *last).filter(|_| found.len() == max_neighbours);
                searched_radius = reach;
            }
            if !cell.is_empty() {
                on_cell(site, cell);
                let error = rounding(cuts);
                let touching = touched.iter().filter(|(_, to_other, half, terms)| {
                    signed_distances(cell, to_other, *half)[1] >= -error * terms
                });
                touching.for_each(|(other, ..)| add_visited(visited, visited_set, *other));
            }
        }
        true
    }

    /// Returns the point whose cell contains a piece's centre.
    fn site_at_centre(
        &self,
        piece: &SurfacePiece,
        sites: &VoronoiSites<'_>,
        power_weight: impl Fn(u32) -> f64,
    ) -> u32 {
        let corners = self.corners(piece);
        let sum: Vector3<f64> = corners.iter().map(|corner| corner - corners[0]).sum();
        let middle = corners[0] + sum / corners.len() as f64;
        sites.tree.min_sum(middle.into(), power_weight)
    }
}

/// Adds a point whose cell must be computed, unless it is already known.
fn add_visited(visited: &mut Vec<u32>, visited_set: &mut HashSet<u32>, other: u32) {
    let is_new = if visited.len() <= MAX_LINEAR_SEARCH {
        !visited.iter().rev().any(|one| *one == other)
    } else {
        if visited_set.is_empty() {
            visited_set.extend(visited.iter().copied());
        }
        visited_set.insert(other)
    };
    if is_new {
        visited.push(other);
    }
}

/// Returns an upper bound on the distance from a cell's point to other points that cut the cell. Each
/// length errs by 3u below its root and two more, and a corner by 2.5u per line that cut the cell; 1e-12
/// is 9000u.
fn reach_of(cell: &[Corner], own_weight: f64) -> f64 {
    let max_squared = cell.iter().map(|(v, _)| v.norm_squared()).fold(0.0, f64::max);
    (max_squared.sqrt() + (max_squared + own_weight).sqrt()) * (1.0 + 1e-12)
}

/// Returns the smallest and the largest value of `v · toward - half` over the corners of a cell.
fn signed_distances(cell: &[Corner], to_other: &Vector3<f64>, half: f64) -> [f64; 2] {
    cell.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[min_value, max_value], (v, _)| {
        let distance = v.dot(to_other) - half;
        [min_value.min(distance), max_value.max(distance)]
    })
}

/// Cuts away the part of a cell beyond `v · toward = half`. Returns whether there was any.
pub(super) fn clip(
    cell: &mut Vec<Corner>,
    cut: &mut Vec<Corner>,
    to_other: Vector3<f64>,
    half: f64,
    other: u32,
) -> bool {
    let signed_distance = |(v, _): &Corner| v.dot(&to_other) - half;
    if cell.iter().all(|corner| signed_distance(corner) <= 0.0) {
        return false;
    }
    cut.clear();
    for (index, corner) in cell.iter().enumerate() {
        let next = &cell[(index + 1) % cell.len()];
        let (distance, next_distance) = (signed_distance(corner), signed_distance(next));
        let crossing = || corner.0 + (next.0 - corner.0) * (distance / (distance - next_distance));
        if distance <= 0.0 {
            cut.push(*corner);
            if next_distance > 0.0 {
                cut.push((crossing(), other));
            }
        } else if next_distance <= 0.0 {
            cut.push((crossing(), corner.1));
        }
    }
    std::mem::swap(cell, cut);
    true
}

/// Returns the area of a cell.
pub(super) fn area(cell: &[Corner], normal: &Vector3<f64>) -> f64 {
    let Some((first, rest)) = cell.split_first() else { return 0.0 };
    let fan = rest.windows(2).map(|pair| (pair[0].0 - first.0).cross(&(pair[1].0 - first.0)));
    (fan.map(|cross| cross.dot(normal)).sum::<f64>() / 2.0).max(0.0)
}
