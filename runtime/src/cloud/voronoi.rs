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
const BESIDE: f64 = 2.5;
/// Maximum number of these points that are kept. Where a part's extent agrees with its area, there are
/// some twenty.
const MOST_BESIDE: usize = 128;
/// Fixed cost of a cell, in units of one point tested against a cell.
const CELL: usize = 16;
/// Cost of finding and sorting one of the nearest points, in the same unit.
const FOUND: usize = 4;
/// Maximum number of points met that are searched linearly.
const FEW: usize = 64;
/// Points per parallel task.
const TOGETHER: usize = 1 << 10;
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
    near: NeighbourBvh,
    /// The points within `near_by` of each, the nearest first, at most [`MOST_BESIDE`].
    beside: Lists,
    near_by: f64,
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
    pub(super) met: Vec<u32>,
    /// The same points as a set, if there are many.
    known: HashSet<u32>,
    /// The number of points tested against cells, plus the other costs of the cells.
    pub(super) held: usize,
}

impl<'a> VoronoiSites<'a> {
    pub(super) fn new(
        surface: &Surface,
        points: &'a [Point3<f64>],
        normals: &'a [Vector3<f64>],
    ) -> VoronoiSites<'a> {
        let near = NeighbourBvh::new(points);
        // Where the area does not predict the distances between points, the nearest ones are taken.
        let near_by = if surface.coarse() { f64::INFINITY } else { BESIDE * surface.spacing };
        let lists = parallel::ranges(points.len(), TOGETHER, |range| {
            let (mut found, mut beside) = (vec![], Lists::default());
            for site in range {
                near.some_within(points[site].into(), near_by, MOST_BESIDE, &mut found);
                found.iter().for_each(|(_, other)| beside.push(*other));
                beside.end();
            }
            beside
        });
        let beside = Lists::joined(lists);
        VoronoiSites { points, normals, near, beside, near_by }
    }
}

impl Surface {
    /// Calls `with` for each point that has a cell in a piece, with the cell's corners relative to the
    /// point. `turned` is σ². Returns whether the division is complete: it ends after about `most` tests
    /// of points against cells.
    pub(super) fn divide(
        &self,
        piece: &SurfacePiece,
        sites: &VoronoiSites<'_>,
        turned: f64,
        most: usize,
        room: &mut ClipBuffers,
        mut with: impl FnMut(u32, &[Corner]),
    ) -> bool {
        let ClipBuffers { found, farther, cell, cut, touched, met, known, held } = room;
        let apart =
            |site: u32| turned * (sites.normals[site as usize] - piece.normal).norm_squared();
        met.clear();
        *held = 0;
        if !known.is_empty() {
            known.clear();
        }
        met.push(self.first(piece, sites, apart));
        let mut next = 0;
        while let Some(&site) = met.get(next) {
            if next > 0 && *held >= most {
                return false;
            }
            next += 1;
            *held += CELL;
            let (at, mine) = (sites.points[site as usize], apart(site));
            cell.clear();
            cell.extend(self.corners(piece).iter().map(|corner| (corner - at, EDGE)));
            touched.clear();
            let mut cuts = 0;
            let mut reach = reach_of(cell, mine);
            let beside = sites.beside.of(site);
            let mut list = beside;
            // The number of nearest points that may have been examined.
            let mut many = MOST_BESIDE;
            let mut last = beside.last().copied().filter(|_| beside.len() == many);
            let mut within = sites.near_by;
            'cut: loop {
                for &other in list.iter().filter(|other| **other != site) {
                    *held += 1;
                    let toward = sites.points[other as usize] - at;
                    let squared = toward.norm_squared();
                    if squared > reach * reach {
                        break 'cut;
                    }
                    let beyond = apart(other);
                    let half = (squared + beyond - mine) / 2.0;
                    let terms = reach * squared.sqrt() + squared + beyond + mine;
                    let slack = rounding(cuts) * terms;
                    let [least, most] = over(cell, &toward, half);
                    if most < -slack {
                        continue;
                    }
                    touched.push((other, toward, half, terms));
                    if most <= slack {
                        if least >= -slack && other < site {
                            cell.clear();
                            meet(met, known, other);
                            break 'cut;
                        }
                    } else if clip(cell, cut, toward, half + slack, other) {
                        if cell.is_empty() {
                            break 'cut;
                        }
                        cuts += 1;
                        reach = reach_of(cell, mine);
                    }
                }
                if reach <= within && last.is_none() {
                    break;
                }
                let left = most.saturating_sub(*held);
                if left <= many {
                    return false;
                }
                let from =
                    |other: u32| point_grid::away(sites.points[other as usize].into(), at.into());
                let known = last.map(|last| (from(last), last));
                let is_new = |one: &&(f64, u32)| match known {
                    None => one.0 > within * within,
                    Some(last) => point_grid::nearer(&last, one).is_lt(),
                };
                many = (8 * many).min(left);
                sites.near.some_within(at.into(), reach, many, found);
                *held += FOUND * found.len();
                farther.clear();
                farther.extend(found.iter().filter(is_new).map(|(_, other)| *other));
                list = farther;
                last = found.last().map(|(_, last)| *last).filter(|_| found.len() == many);
                within = reach;
            }
            if !cell.is_empty() {
                with(site, cell);
                let off = rounding(cuts);
                let still = touched.iter().filter(|(_, toward, half, terms)| {
                    over(cell, toward, *half)[1] >= -off * terms
                });
                still.for_each(|(other, ..)| meet(met, known, *other));
            }
        }
        true
    }

    /// Returns the point whose cell contains a piece's centre.
    fn first(
        &self,
        piece: &SurfacePiece,
        sites: &VoronoiSites<'_>,
        apart: impl Fn(u32) -> f64,
    ) -> u32 {
        let corners = self.corners(piece);
        let sum: Vector3<f64> = corners.iter().map(|corner| corner - corners[0]).sum();
        let middle = corners[0] + sum / corners.len() as f64;
        sites.near.least(middle.into(), apart)
    }
}

/// Adds a point whose cell must be computed, unless it is already known.
fn meet(met: &mut Vec<u32>, known: &mut HashSet<u32>, other: u32) {
    let is_new = if met.len() <= FEW {
        !met.iter().rev().any(|one| *one == other)
    } else {
        if known.is_empty() {
            known.extend(met.iter().copied());
        }
        known.insert(other)
    };
    if is_new {
        met.push(other);
    }
}

/// Returns an upper bound on the distance from a cell's point to other points that cut the cell. Each
/// length errs by 3u below its root and two more, and a corner by 2.5u per line that cut the cell; 1e-12
/// is 9000u.
fn reach_of(cell: &[Corner], mine: f64) -> f64 {
    let most = cell.iter().map(|(v, _)| v.norm_squared()).fold(0.0, f64::max);
    (most.sqrt() + (most + mine).sqrt()) * (1.0 + 1e-12)
}

/// Returns the smallest and the largest value of `v · toward - half` over the corners of a cell.
fn over(cell: &[Corner], toward: &Vector3<f64>, half: f64) -> [f64; 2] {
    cell.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[least, most], (v, _)| {
        let over = v.dot(toward) - half;
        [least.min(over), most.max(over)]
    })
}

/// Cuts away the part of a cell beyond `v · toward = half`. Returns whether there was any.
pub(super) fn clip(
    cell: &mut Vec<Corner>,
    cut: &mut Vec<Corner>,
    toward: Vector3<f64>,
    half: f64,
    other: u32,
) -> bool {
    let over = |(v, _): &Corner| v.dot(&toward) - half;
    if cell.iter().all(|corner| over(corner) <= 0.0) {
        return false;
    }
    cut.clear();
    for (place, corner) in cell.iter().enumerate() {
        let next = &cell[(place + 1) % cell.len()];
        let (here, there) = (over(corner), over(next));
        let between = || corner.0 + (next.0 - corner.0) * (here / (here - there));
        if here <= 0.0 {
            cut.push(*corner);
            if there > 0.0 {
                cut.push((between(), other));
            }
        } else if there <= 0.0 {
            cut.push((between(), corner.1));
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
