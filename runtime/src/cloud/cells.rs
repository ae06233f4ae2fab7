//! What dividing a surface among the points on it tells: the area of each point's cell, and how far
//! from all points the surface gets.

use super::diagram::{Room, Sites, area};
use super::pieces::Surface;
use crate::cores;
use crate::mesh::Sum;
use nalgebra::Point3;

/// σ² in squared spacings.
const TURNED: f64 = 2.25;
/// Pieces that one core takes at a time.
const TOGETHER: usize = 256;
/// The most points that are held against the cells of a piece at first, and the least where there are many pieces.
const MOST_CROWD: usize = 1 << 14;
const LEAST_CROWD: usize = 1 << 10;
/// Those of all pieces, if that leaves enough for each.
const MOST_CROWDS: usize = 1 << 26;
/// How far a corner can be from where it is computed, of the part's size and of the radius: 9000u, with unit roundoff u.
///
/// A corner of a piece errs by u of the part's size where it is put together, and by 5u of the cut edge for each of the cuts
/// that made the piece. Each cut halves the longer of two extents, so that these edges add up to less than six times the
/// triangle's: 120u of the part's size in all. A cell's corner errs by 5u of its distance for each line that cut it (see
/// `diagram`), which holds up to 1700 lines, and the distance itself by 4u.
const ROUNDED: f64 = 1e-12;
/// Cells are shown to fill a piece, but for rounding (see `diagram`). Where they do not by these parts of its area, something
/// else went wrong, or its area is rounding itself, and nothing is taken from them: of weights, and of the covering radius.
const FILLED: f64 = 1.0 - 1e-6;
const WHOLE: f64 = 1.0 - 1e-9;

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

/// What points have of some pieces.
struct Divided {
    /// Of pieces that were divided among all points that have a part.
    shares: Vec<(u32, f64)>,
    /// How far each piece gets from all points at most.
    reaches: Vec<f64>,
    /// The other pieces, and those shares that were found.
    crowded: Vec<(usize, Vec<(u32, f64)>)>,
}

fn add(areas: &mut [Sum], shares: Vec<(u32, f64)>) {
    shares.into_iter().for_each(|(site, share)| areas[site as usize].add(share));
}

impl Surface {
    /// Divides the surface. A piece that more points have a part of than can be looked at is shared among those that
    /// were, and gets no farther from all points than its farthest corner from one of them.
    pub(super) fn cells(&self, sites: &Sites<'_>) -> Cells {
        let mut areas = vec![Sum::default(); sites.points.len()];
        let mut farthest = vec![0.0; self.pieces.len()];
        let mut crowded = vec![];
        let mut note = |some: &[usize], most: usize, crowded: &mut Vec<_>| {
            let mut order = some.iter();
            for divided in self.shares(sites, some, most) {
                add(&mut areas, divided.shares);
                let reaches = divided.reaches.into_iter().zip(&mut order);
                reaches.for_each(|(reach, piece)| farthest[*piece] = reach);
                crowded.extend(divided.crowded);
            }
        };
        let all: Vec<usize> = (0..self.pieces.len()).collect();
        note(&all, self.crowd(), &mut crowded);
        // Once more, with as much work as there may be: mostly there are few of them.
        let most = self.work(sites) / crowded.len().max(1);
        if most > self.crowd() {
            let some: Vec<usize> = crowded.drain(..).map(|(piece, _)| piece).collect();
            note(&some, most, &mut crowded);
        }
        crowded.into_iter().for_each(|(_, shares)| add(&mut areas, shares));
        let areas = areas.into_iter().map(Sum::value).collect();
        Cells { areas, radius: self.radius(sites, &farthest) }
    }

    /// Returns how many points may be held against cells beyond what is usual.
    fn work(&self, sites: &Sites<'_>) -> usize {
        let any = if self.coarse() { 1 << 22 } else { 1 << 26 };
        256 * (sites.points.len() + self.pieces.len()) + any
    }

    /// Returns how many points are held against the cells of a piece at first: usual are some hundred, and some thousand
    /// where pieces are long.
    fn crowd(&self) -> usize {
        if self.coarse() {
            return 2 * LEAST_CROWD;
        }
        (MOST_CROWDS / self.pieces.len().max(1)).clamp(LEAST_CROWD, MOST_CROWD)
    }

    /// Divides some pieces, holding `most` points against the cells of each.
    fn shares(&self, sites: &Sites<'_>, some: &[usize], most: usize) -> Vec<Divided> {
        let turned = TURNED * self.spacing * self.spacing;
        cores::ranges(some.len(), TOGETHER, |range| {
            let mut room = Room::default();
            let (mut shares, mut crowded) = (vec![], vec![]);
            let mut reaches = Vec::with_capacity(range.len());
            for index in range {
                let piece = &self.pieces[some[index]];
                let from = shares.len();
                let mut reach = 0f64;
                let whole = self.divide(piece, sites, turned, most, &mut room, |site, cell| {
                    shares.push((site, area(cell, &piece.normal)));
                    reach = cell.iter().map(|(v, _)| v.norm_squared()).fold(reach, f64::max);
                });
                // What rounding left over or out.
                let sum: f64 = shares[from..].iter().map(|(_, share)| share).sum();
                let all = f64::from(piece.copies) * piece.area;
                if sum > 0.0 {
                    shares[from..].iter_mut().for_each(|(_, share)| *share *= all / sum);
                } else {
                    shares.push((room.met[0], all));
                }
                // Cells that do not fill the piece tell nothing of what they leave.
                let fills = whole && sum >= FILLED * piece.area;
                reaches.push(if fills { reach.sqrt() } else { f64::INFINITY });
                if !whole {
                    crowded.push((some[index], shares.split_off(from)));
                }
            }
            Divided { shares, reaches, crowded }
        })
    }

    /// How far the surface gets from all points, of pieces that get no farther than given.
    fn radius(&self, sites: &Sites<'_>, farthest: &[f64]) -> f64 {
        let mut order: Vec<usize> = (0..self.pieces.len()).collect();
        order.sort_unstable_by(|a, b| farthest[*b].total_cmp(&farthest[*a]));
        let mut radius = 0f64;
        let mut room = Room::default();
        let mut work = self.work(sites);
        for index in order {
            if farthest[index] <= radius {
                break;
            }
            let piece = &self.pieces[index];
            let (mut filled, mut most) = (0.0, 0f64);
            let whole = self.divide(piece, sites, 0.0, work, &mut room, |_, cell| {
                filled += area(cell, &piece.normal);
                most = cell.iter().map(|(v, _)| v.norm()).fold(most, f64::max);
            });
            work = work.saturating_sub(room.held);
            if !whole || filled < WHOLE * piece.area {
                // No place is farther from all points than from one.
                let one = sites.points[room.met[0] as usize];
                most = self.corners(piece).iter().map(|c| (c - one).norm()).fold(0.0, f64::max);
            }
            radius = radius.max(most);
        }
        radius * (1.0 + ROUNDED) + self.rounded()
    }

    /// How far a place can be from where it is computed.
    pub(super) fn rounded(&self) -> f64 {
        self.size * ROUNDED
    }

    /// How far each piece gets from all points, before there is any.
    pub(super) fn farthest(&self) -> Vec<f64> {
        vec![f64::INFINITY; self.pieces.len()]
    }

    /// Where the surface is farther from all points than a distance, but nowhere near as far: each
    /// more than once. `farthest` is how far each piece got from fewer points, and is brought up to
    /// date where it may be that far. `work` is how many more
    /// points may be held against cells.
    pub(super) fn holes(
        &self,
        sites: &Sites<'_>,
        distance: f64,
        farthest: &mut [f64],
        work: &mut usize,
    ) -> Vec<Hole> {
        let may: Vec<usize> = (0..farthest.len()).filter(|i| farthest[*i] > distance).collect();
        let found = cores::ranges(may.len(), TOGETHER, |range| {
            let mut room = Room::default();
            let (mut holes, mut farthest, mut held) = (vec![], vec![], 0);
            for index in range {
                let piece = &self.pieces[may[index]];
                let mut most = 0f64;
                self.divide(piece, sites, 0.0, self.crowd(), &mut room, |site, cell| {
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
                held += room.held;
            }
            (holes, farthest, held)
        });
        let mut at = may.into_iter();
        let mut holes = vec![];
        for (some, distances, held) in found {
            holes.extend(some);
            *work = work.saturating_sub(held);
            for (distance, piece) in distances.into_iter().zip(&mut at) {
                farthest[piece] = distance;
            }
        }
        holes
    }
}
