//! A surface divided among the points on it: the area of each point's cell, and how far from all
//! points the surface gets.
//!
//! A triangle is divided by `|x − p|² + σ² |n − m|²`, p a point and m its normal, x a place of the
//! triangle and n its normal: the nearest point has it, one with another normal only if it is
//! nearer by far. So cells end at edges, and the two sides of a thin sheet are kept apart, but what
//! has no point of its own falls to what is near. In the triangle's plane this is a power diagram:
//! cells are convex, and each is the triangle cut by straight lines, one for each neighbour, until
//! no farther point can reach it. A cell's neighbours are those whose lines are left, so the
//! diagram is walked from one cell to the next. With σ = 0 its vertices are the places that are
//! farthest from all points (Lévy and Bonneel 2013 have both uses of such diagrams).

use super::near::Near;
use crate::cores;
use crate::mesh::{Mesh, Sum, area_and_normal};
use nalgebra::{Point3, Vector3};
use std::ops::Range;

/// Triangles are cut until about as many points have a cell in each.
const MET: f64 = 64.0;
/// σ² in squared spacings.
const TURNED: f64 = 2.25;
/// How far from a point, in spacings, most of those are that cut its cell.
const BESIDE: f64 = 2.5;
/// Pieces that one core takes at a time.
const TOGETHER: usize = 256;
/// How far a vertex can be from where it is computed, of the part's size.
const ROUNDED: f64 = 1e-12;

/// Triangles in handy pieces.
pub(super) struct Surface {
    pieces: Vec<Piece>,
    corners: Vec<Point3<f64>>,
    /// The root of a point's share of the area.
    spacing: f64,
    size: f64,
}

/// A convex part of a triangle.
struct Piece {
    triangle: u32,
    corners: Range<usize>,
    normal: Vector3<f64>,
    area: f64,
}

/// Points on a surface, by where they are.
pub(super) struct Sites<'a> {
    points: &'a [Point3<f64>],
    normals: &'a [Vector3<f64>],
    near: Near,
    /// Those within `near_by` of each, the nearest first, and where each one's begin.
    beside: Vec<u32>,
    starts: Vec<usize>,
    near_by: f64,
}

/// A place far from all points.
#[derive(Clone, Copy)]
pub(super) struct Hole {
    pub(super) place: Point3<f64>,
    pub(super) triangle: u32,
    pub(super) distance: f64,
}

/// Of each point the area of its cell, and how far the surface gets from all points at most.
pub(super) struct Cells {
    pub(super) areas: Vec<f64>,
    pub(super) radius: f64,
}

/// A corner of a cell from its point, and which point's line goes on from there.
pub(super) type Corner = (Vector3<f64>, u32);
/// No point's: an edge of the piece.
pub(super) const EDGE: u32 = u32::MAX;

/// Room to divide a piece.
#[derive(Default)]
struct Room {
    found: Vec<(f64, u32)>,
    farther: Vec<u32>,
    cell: Vec<Corner>,
    cut: Vec<Corner>,
    /// Points whose cells are or will be looked at.
    met: Vec<u32>,
}

impl<'a> Sites<'a> {
    pub(super) fn new(
        surface: &Surface,
        points: &'a [Point3<f64>],
        normals: &'a [Vector3<f64>],
    ) -> Sites<'a> {
        let near = Near::new(points);
        let near_by = BESIDE * surface.spacing;
        let lists = cores::ranges(points.len(), TOGETHER, |range| {
            let (mut found, mut beside, mut counts) = (vec![], vec![], vec![]);
            for site in range {
                near.within(points[site].into(), near_by, &mut found);
                counts.push(found.len());
                beside.extend(found.iter().map(|(_, other)| *other));
            }
            (beside, counts)
        });
        let mut starts = Vec::with_capacity(points.len() + 1);
        let mut beside = Vec::with_capacity(lists.iter().map(|(list, _)| list.len()).sum());
        starts.push(0);
        for (list, counts) in lists {
            beside.extend(list);
            counts.iter().for_each(|count| starts.push(starts[starts.len() - 1] + count));
        }
        Sites { points, normals, near, beside, starts, near_by }
    }
}

impl Surface {
    /// Of a mesh that is to have so many points.
    pub(super) fn new(mesh: &Mesh, area: f64, count: usize) -> Surface {
        let spacing = (area / count as f64).sqrt();
        let [low, high] = mesh.bounds();
        let size = low.coords.amax().max(high.coords.amax());
        let mut surface = Surface { pieces: vec![], corners: vec![], spacing, size };
        for (triangle, corners) in (0..).zip(mesh.corners()) {
            if let Some((area, normal)) = area_and_normal(&corners) {
                let [a, b, c] = corners;
                let longest = [b - a, c - b, a - c]
                    .into_iter()
                    .max_by(|x, y| x.norm_squared().total_cmp(&y.norm_squared()));
                let along = longest.unwrap_or_default().normalize();
                let axes = [along, normal.cross(&along)];
                let whole = corners.map(|corner| (corner - a, EDGE)).to_vec();
                surface.add((triangle, a, normal), axes, whole, area);
            }
        }
        surface
    }

    /// Adds a part of a triangle, cut across where it is longer until few points have a cell in each.
    fn add(
        &mut self,
        (triangle, from, normal): (u32, Point3<f64>, Vector3<f64>),
        axes: [Vector3<f64>; 2],
        part: Vec<Corner>,
        area: f64,
    ) {
        let ends = axes.map(|axis| {
            let along = || part.iter().map(|(v, _)| v.dot(&axis));
            [along().fold(f64::INFINITY, f64::min), along().fold(f64::NEG_INFINITY, f64::max)]
        });
        let [long, wide] = ends.map(|[low, high]| high - low);
        if (long / self.spacing + 1.0) * (wide / self.spacing + 1.0) <= MET {
            let start = self.corners.len();
            self.corners.extend(part.iter().map(|(corner, _)| from + corner));
            let corners = start..self.corners.len();
            self.pieces.push(Piece { triangle, corners, normal, area });
            return;
        }
        let across = usize::from(wide > long);
        let ([low, high], axis) = (ends[across], axes[across]);
        let middle = low / 2.0 + high / 2.0;
        let (mut one, mut cut) = (part.clone(), vec![]);
        let mut other = part;
        clip(&mut one, &mut cut, axis, middle, EDGE);
        clip(&mut other, &mut cut, -axis, -middle, EDGE);
        let sizes = [&one, &other].map(|part| self::area(part, &normal));
        let share = area / (sizes[0] + sizes[1]);
        for (part, size) in [one, other].into_iter().zip(sizes) {
            if size > 0.0 {
                self.add((triangle, from, normal), axes, part, share * size);
            }
        }
    }

    /// Divides the surface.
    pub(super) fn cells(&self, sites: &Sites<'_>) -> Cells {
        let turned = TURNED * self.spacing * self.spacing;
        let shares = cores::ranges(self.pieces.len(), TOGETHER, |range| {
            let mut room = Room::default();
            let (mut shares, mut farthest) = (vec![], Vec::with_capacity(range.len()));
            for piece in &self.pieces[range] {
                let from = shares.len();
                let mut most = 0f64;
                self.divide(piece, sites, turned, &mut room, |site, cell| {
                    shares.push((site, area(cell, &piece.normal)));
                    most = cell.iter().map(|(v, _)| v.norm_squared()).fold(most, f64::max);
                });
                // What rounding left over or out.
                let sum: f64 = shares[from..].iter().map(|(_, share)| share).sum();
                if sum > 0.0 {
                    shares[from..].iter_mut().for_each(|(_, share)| *share *= piece.area / sum);
                } else {
                    shares.push((room.met[0], piece.area));
                }
                farthest.push(most.sqrt());
            }
            (shares, farthest)
        });
        let mut areas = vec![Sum::default(); sites.points.len()];
        let mut farthest = Vec::with_capacity(self.pieces.len());
        for (shares, distances) in shares {
            shares.into_iter().for_each(|(site, share)| areas[site as usize].add(share));
            farthest.extend(distances);
        }
        let areas = areas.into_iter().map(Sum::value).collect();
        Cells { areas, radius: self.radius(sites, &farthest) }
    }

    /// How far the surface gets from all points, of pieces that get no farther than given.
    fn radius(&self, sites: &Sites<'_>, farthest: &[f64]) -> f64 {
        let mut order: Vec<usize> = (0..self.pieces.len()).collect();
        order.sort_unstable_by(|a, b| farthest[*b].total_cmp(&farthest[*a]));
        let mut radius = 0f64;
        let mut room = Room::default();
        for piece in order {
            if farthest[piece] <= radius {
                break;
            }
            self.divide(&self.pieces[piece], sites, 0.0, &mut room, |_, cell| {
                radius = cell.iter().map(|(v, _)| v.norm()).fold(radius, f64::max);
            });
        }
        radius * (1.0 + ROUNDED) + self.size * ROUNDED
    }

    /// How far each piece gets from all points, before there is any.
    pub(super) fn farthest(&self) -> Vec<f64> {
        vec![f64::INFINITY; self.pieces.len()]
    }

    /// Where the surface is farther from all points than a distance, but nowhere near as far: each
    /// more than once. `farthest` is how far each piece got from fewer points, and is brought up to
    /// date where it may be that far.
    pub(super) fn holes(
        &self,
        sites: &Sites<'_>,
        distance: f64,
        farthest: &mut [f64],
    ) -> Vec<Hole> {
        let may: Vec<usize> = (0..farthest.len()).filter(|i| farthest[*i] > distance).collect();
        let found = cores::ranges(may.len(), TOGETHER, |range| {
            let mut room = Room::default();
            let (mut holes, mut farthest) = (vec![], vec![]);
            for index in range {
                let piece = &self.pieces[may[index]];
                let mut most = 0f64;
                self.divide(piece, sites, 0.0, &mut room, |site, cell| {
                    for (corner, _) in cell {
                        let away = corner.norm();
                        most = most.max(away);
                        if away > distance {
                            let place = sites.points[site as usize] + corner;
                            holes.push(Hole { place, triangle: piece.triangle, distance: away });
                        }
                    }
                });
                farthest.push(most);
            }
            (holes, farthest)
        });
        let mut at = may.into_iter();
        let mut holes = vec![];
        for (some, distances) in found {
            holes.extend(some);
            for (distance, piece) in distances.into_iter().zip(&mut at) {
                farthest[piece] = distance;
            }
        }
        holes
    }

    /// Calls with each point that has a cell in a piece, and that cell's corners from the point.
    fn divide(
        &self,
        piece: &Piece,
        sites: &Sites<'_>,
        turned: f64,
        room: &mut Room,
        mut with: impl FnMut(u32, &[Corner]),
    ) {
        let Room { found, farther, cell, cut, met } = room;
        let apart =
            |site: u32| turned * (sites.normals[site as usize] - piece.normal).norm_squared();
        met.clear();
        met.push(self.first(piece, sites, apart, found));
        let mut next = 0;
        while let Some(&site) = met.get(next) {
            next += 1;
            let (at, mine) = (sites.points[site as usize], apart(site));
            cell.clear();
            cell.extend(self.corners(piece).iter().map(|corner| (corner - at, EDGE)));
            let mut reach = reach_of(cell, mine);
            let mut list =
                &sites.beside[sites.starts[site as usize]..sites.starts[site as usize + 1]];
            let mut all = false;
            'cut: loop {
                for &other in list {
                    let toward = sites.points[other as usize] - at;
                    let squared = toward.norm_squared();
                    if squared > reach * reach {
                        break 'cut;
                    }
                    let half = (squared + apart(other) - mine) / 2.0;
                    if squared == 0.0 && half == 0.0 {
                        // Of two in the same place the first has all.
                        if other < site {
                            cell.clear();
                        }
                    } else if clip(cell, cut, toward, half, other) {
                        reach = reach_of(cell, mine);
                    }
                }
                if all || reach <= sites.near_by {
                    break;
                }
                all = true;
                sites.near.within(at.into(), reach, found);
                let near_by = sites.near_by * sites.near_by;
                farther.clear();
                farther.extend(found.iter().filter(|(d, _)| *d > near_by).map(|(_, other)| *other));
                list = farther;
            }
            if !cell.is_empty() {
                with(site, cell);
                for (_, other) in &*cell {
                    if *other != EDGE && !met.contains(other) {
                        met.push(*other);
                    }
                }
            }
        }
    }

    fn corners(&self, piece: &Piece) -> &[Point3<f64>] {
        &self.corners[piece.corners.clone()]
    }

    /// The point whose cell has a piece's middle.
    fn first(
        &self,
        piece: &Piece,
        sites: &Sites<'_>,
        apart: impl Fn(u32) -> f64,
        found: &mut Vec<(f64, u32)>,
    ) -> u32 {
        let corners = self.corners(piece);
        let sum: Vector3<f64> = corners.iter().map(|corner| corner - corners[0]).sum();
        let middle = corners[0] + sum / corners.len() as f64;
        let mut within = self.spacing;
        loop {
            sites.near.within(middle.into(), within, found);
            let nearest = found
                .iter()
                .map(|&(squared, site)| (squared + apart(site), site))
                .min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            if let Some((_, site)) = nearest.filter(|(least, _)| *least <= within * within) {
                return site;
            }
            within *= 2.0;
        }
    }
}

/// How far from a cell's point others can be that cut it.
fn reach_of(cell: &[Corner], mine: f64) -> f64 {
    let most = cell.iter().map(|(v, _)| v.norm_squared()).fold(0.0, f64::max);
    (most.sqrt() + (most + mine).sqrt()) * (1.0 + 1e-12)
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
