//! Which point has which part of a piece of the surface.
//!
//! A triangle is divided by `|x − p|² + σ² |n − m|²`, p a point and m its normal, x a place of the
//! triangle and n its normal: the nearest point has it, one with another normal only if it is
//! nearer by far. So cells end at edges, and the two sides of a thin sheet are kept apart, but what
//! has no point of its own falls to what is near. In the triangle's plane this is a power diagram:
//! cells are convex, and each is the piece cut by straight lines, one for each neighbour, until
//! no farther point can reach it. The diagram is walked from one cell to all whose lines touch it. With
//! σ = 0 the corners of cells are the places that are farthest from all points (Lévy and Bonneel 2013
//! have both uses of such diagrams).
//!
//! **Rounding** decides nothing: a line cuts only what is beyond it by more than it can be off, so a
//! computed cell contains the true one, and the neighbours of that touch it. Of points whose lines no
//! corner is clearly off, twice the same point or its mirror image, the first has all.
//!
//! Let `u` be the unit roundoff, `t` the way from a cell's point to another, `v` a corner from there, `b` and `m` the terms of
//! the normals. `reach` is no less than `2 |v|`. How far `v` is beyond the line, `v·t - (t² + b - m)/2`, errs by
//!
//! | what | errs by |
//! |---|--:|
//! | `v` and `t`, differences of given points | 1 u reach t |
//! | their product, less the half | 2 u reach t + 1 u (t² + b + m) |
//! | `t²`: 5u, `b` and `m`: 7u, their sum: 2u; half of that | 4.5 u (t² + b + m) |
//! | a corner where a line cuts an edge of `2 |v|` at most: a difference, a product, a sum beside the edge | 2.5 u reach t |
//! | the same by each line that cut the cell before, as its corners are beside theirs | 2.5 u reach t each |
//!
//! which is less than `(8 + 2 cuts) ε (reach t + t² + b + m)`.

use super::lists::Lists;
use super::near::{self, Near};
use super::pieces::{Piece, Surface};
use crate::cores;
use nalgebra::{Point3, Vector3};
use std::collections::HashSet;

/// How far from a point, in spacings, most of those are that cut its cell.
const BESIDE: f64 = 2.5;
/// The most of these that are kept. Where a part is as large as its area says, there are some twenty.
const MOST_BESIDE: usize = 128;
/// What a cell costs besides the points that are held against it.
const CELL: usize = 16;
/// What one of the nearest points costs, found and sorted, beside one that is held against a cell.
const FOUND: usize = 4;
/// Up to here points that were met are looked through one by one.
const FEW: usize = 64;
/// Points that one core takes at a time.
const TOGETHER: usize = 1 << 10;
/// How far a corner can be computed to be beyond a line, of the terms that it is a sum of, where so many lines cut the cell:
/// see above. Up to twelve, as cells mostly have, it is the same.
fn rounding(cuts: u32) -> f64 {
    f64::EPSILON * f64::from(8 + 2 * cuts.max(12))
}

/// Points on a surface, by where they are.
pub(super) struct Sites<'a> {
    pub(super) points: &'a [Point3<f64>],
    normals: &'a [Vector3<f64>],
    near: Near,
    /// Those within `near_by` of each, the nearest first, [`MOST_BESIDE`] at most.
    beside: Lists,
    near_by: f64,
}

/// A corner of a cell from its point, and which point's line goes on from there.
pub(super) type Corner = (Vector3<f64>, u32);
/// No point's: an edge of the piece.
pub(super) const EDGE: u32 = u32::MAX;

/// Room to divide a piece.
#[derive(Default)]
pub(super) struct Room {
    found: Vec<(f64, u32)>,
    farther: Vec<u32>,
    cell: Vec<Corner>,
    cut: Vec<Corner>,
    /// Points whose lines have touched the cell, how far these were, and the terms of what they can be off.
    touched: Vec<(u32, Vector3<f64>, f64, f64)>,
    /// Points whose cells are or will be looked at: the first has the piece's middle.
    pub(super) met: Vec<u32>,
    /// The same, where they are many.
    known: HashSet<u32>,
    /// How many points were held against cells, and what else cells cost.
    pub(super) held: usize,
}

impl<'a> Sites<'a> {
    pub(super) fn new(
        surface: &Surface,
        points: &'a [Point3<f64>],
        normals: &'a [Vector3<f64>],
    ) -> Sites<'a> {
        let near = Near::new(points);
        // Where the area does not tell how close points are, the nearest ones are taken.
        let near_by = if surface.coarse() { f64::INFINITY } else { BESIDE * surface.spacing };
        let lists = cores::ranges(points.len(), TOGETHER, |range| {
            let (mut found, mut beside) = (vec![], Lists::default());
            for site in range {
                near.some_within(points[site].into(), near_by, MOST_BESIDE, &mut found);
                found.iter().for_each(|(_, other)| beside.push(*other));
                beside.end();
            }
            beside
        });
        let beside = Lists::joined(lists);
        Sites { points, normals, near, beside, near_by }
    }
}

impl Surface {
    /// Calls with each point that has a cell in a piece, and that cell's corners from the point.
    /// `turned` is σ². Returns whether that was all: it ends when about `most` points were held against cells.
    pub(super) fn divide(
        &self,
        piece: &Piece,
        sites: &Sites<'_>,
        turned: f64,
        most: usize,
        room: &mut Room,
        mut with: impl FnMut(u32, &[Corner]),
    ) -> bool {
        let Room { found, farther, cell, cut, touched, met, known, held } = room;
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
            // How many of the nearest points may have been looked at.
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
                let from = |other: u32| near::away(sites.points[other as usize].into(), at.into());
                let known = last.map(|last| (from(last), last));
                let is_new = |one: &&(f64, u32)| match known {
                    None => one.0 > within * within,
                    Some(last) => near::nearer(&last, one).is_lt(),
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

    /// The point whose cell has a piece's middle.
    fn first(&self, piece: &Piece, sites: &Sites<'_>, apart: impl Fn(u32) -> f64) -> u32 {
        let corners = self.corners(piece);
        let sum: Vector3<f64> = corners.iter().map(|corner| corner - corners[0]).sum();
        let middle = corners[0] + sum / corners.len() as f64;
        sites.near.least(middle.into(), apart)
    }
}

/// Notes a point whose cell is to be looked at.
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

/// How far from a cell's point others can be that cut it. Each length errs by 3u below its root and two more, and a
/// corner by 2.5u for each line that cut the cell; 1e-12 is 9000u.
fn reach_of(cell: &[Corner], mine: f64) -> f64 {
    let most = cell.iter().map(|(v, _)| v.norm_squared()).fold(0.0, f64::max);
    (most.sqrt() + (most + mine).sqrt()) * (1.0 + 1e-12)
}

/// How far the corners of a cell are beyond `v · toward = half`: the least and the most.
fn over(cell: &[Corner], toward: &Vector3<f64>, half: f64) -> [f64; 2] {
    cell.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[least, most], (v, _)| {
        let over = v.dot(toward) - half;
        [least.min(over), most.max(over)]
    })
}

/// Cuts away what is beyond `v · toward = half`; whether there was any.
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

/// The area of a cell.
pub(super) fn area(cell: &[Corner], normal: &Vector3<f64>) -> f64 {
    let Some((first, rest)) = cell.split_first() else { return 0.0 };
    let fan = rest.windows(2).map(|pair| (pair[0].0 - first.0).cross(&(pair[1].0 - first.0)));
    (fan.map(|cross| cross.dot(normal)).sum::<f64>() / 2.0).max(0.0)
}
