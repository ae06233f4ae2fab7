//! Voronoi cells of points on a surface: the area of each point's cell, and the covering radius.

use super::pieces::Surface;
use super::voronoi::{ClipBuffers, VoronoiSites, area};
use crate::mesh::CompensatedSum;
use crate::parallel;
use nalgebra::Point3;

/// σ² of the `voronoi` module, in squared spacings.
const TURNED: f64 = 2.25;
/// Pieces per parallel task.
const TOGETHER: usize = 256;
/// Initial limits on the number of points tested against the cells of a piece: the upper limit, and the
/// lower limit for surfaces with many pieces.
const MOST_CROWD: usize = 1 << 14;
const LEAST_CROWD: usize = 1 << 10;
/// Total for all pieces, unless the lower limit per piece requires more.
const MOST_CROWDS: usize = 1 << 26;
/// Bound on the distance between a corner and its computed position, relative to the part's size and to
/// the radius: 9000u, with unit roundoff u.
///
/// A corner of a piece errs by u of the part's size where it is computed, and by 5u of the cut edge for
/// each cut that made the piece. Each cut halves the longer of two extents, so these edges add up to
/// less than six times the triangle's longest edge: 120u of the part's size in all. A cell's corner errs
/// by 5u of its distance for each line that cut it (see `voronoi`), which allows up to 1700 lines. The
/// distance itself errs by 4u.
const ROUNDED: f64 = 1e-12;
/// Fractions of a piece's area that its cells must fill, for the covering radius of the piece in the
/// first pass and in the refined pass. Cells fill a piece except for rounding (see `voronoi`). If they
/// do not, something else went wrong or the area itself is mere rounding, so the cells are not used.
const FILLED: f64 = 1.0 - 1e-6;
const WHOLE: f64 = 1.0 - 1e-9;

/// A surface point far from all points of the cloud.
#[derive(Clone, Copy)]
pub(super) struct Hole {
    pub(super) place: Point3<f64>,
    pub(super) triangle: u32,
    pub(super) distance: f64,
}

/// The area of each point's cell, and the covering radius.
pub(super) struct Cells {
    pub(super) areas: Vec<f64>,
    pub(super) radius: f64,
}

/// The result of dividing several pieces among the points.
struct Divided {
    /// Areas of the cells in the pieces that were divided completely, by point.
    shares: Vec<(u32, f64)>,
    /// An upper bound on the distance between each piece and its nearest points; infinite if unknown.
    reaches: Vec<f64>,
    /// The pieces that were not divided completely, with the cell areas found.
    crowded: Vec<(usize, Vec<(u32, f64)>)>,
}

fn add(areas: &mut [CompensatedSum], shares: Vec<(u32, f64)>) {
    shares.into_iter().for_each(|(site, share)| areas[site as usize].add(share));
}

impl Surface {
    /// Divides the surface among the points. If more points have a share of a piece than the work limit
    /// allows, the piece is shared among those examined. Its distance from all points is then bounded by
    /// that of its farthest corner from one of them.
    pub(super) fn cells(&self, sites: &VoronoiSites<'_>) -> Cells {
        let mut areas = vec![CompensatedSum::default(); sites.points.len()];
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
        // Divide the incomplete pieces once more with all the work allowed; there are usually few of
        // them.
        let most = self.work(sites) / crowded.len().max(1);
        if most > self.crowd() {
            let some: Vec<usize> = crowded.drain(..).map(|(piece, _)| piece).collect();
            note(&some, most, &mut crowded);
        }
        crowded.into_iter().for_each(|(_, shares)| add(&mut areas, shares));
        let areas = areas.into_iter().map(CompensatedSum::value).collect();
        Cells { areas, radius: self.radius(sites, &farthest) }
    }

    /// Returns the number of points that may be tested against cells in addition to the usual ones.
    fn work(&self, sites: &VoronoiSites<'_>) -> usize {
        let any = if self.coarse() { 1 << 22 } else { 1 << 26 };
        256 * (sites.points.len() + self.pieces.len()) + any
    }

    /// Returns the initial limit on the number of points tested against the cells of a piece. The usual
    /// number is some hundred, or some thousand where pieces are long.
    fn crowd(&self) -> usize {
        if self.coarse() {
            return 2 * LEAST_CROWD;
        }
        (MOST_CROWDS / self.pieces.len().max(1)).clamp(LEAST_CROWD, MOST_CROWD)
    }

    /// Divides the pieces `some`, testing at most about `most` points against the cells of each.
    fn shares(&self, sites: &VoronoiSites<'_>, some: &[usize], most: usize) -> Vec<Divided> {
        let turned = TURNED * self.spacing * self.spacing;
        parallel::ranges(some.len(), TOGETHER, |range| {
            let mut room = ClipBuffers::default();
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
                // Distribute the area that rounding left over or out.
                let sum: f64 = shares[from..].iter().map(|(_, share)| share).sum();
                let all = f64::from(piece.copies) * piece.area;
                if sum > 0.0 {
                    shares[from..].iter_mut().for_each(|(_, share)| *share *= all / sum);
                } else {
                    shares.push((room.met[0], all));
                }
                // Cells that do not fill the piece give no bound for the rest.
                let fills = whole && sum >= FILLED * piece.area;
                reaches.push(if fills { reach.sqrt() } else { f64::INFINITY });
                if !whole {
                    crowded.push((some[index], shares.split_off(from)));
                }
            }
            Divided { shares, reaches, crowded }
        })
    }

    /// Returns the covering radius, given an upper bound on the distance of each piece.
    fn radius(&self, sites: &VoronoiSites<'_>, farthest: &[f64]) -> f64 {
        let mut order: Vec<usize> = (0..self.pieces.len()).collect();
        order.sort_unstable_by(|a, b| farthest[*b].total_cmp(&farthest[*a]));
        let mut radius = 0f64;
        let mut room = ClipBuffers::default();
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
                // The nearest point is at most as far from any surface point as this one is.
                let one = sites.points[room.met[0] as usize];
                most = self.corners(piece).iter().map(|c| (c - one).norm()).fold(0.0, f64::max);
            }
            radius = radius.max(most);
        }
        radius * (1.0 + ROUNDED) + self.rounded()
    }

    /// Returns a bound on the distance between a surface point and its computed position.
    pub(super) fn rounded(&self) -> f64 {
        self.size * ROUNDED
    }

    /// Returns the upper bound on the distance of each piece before there are any points: infinity.
    pub(super) fn farthest(&self) -> Vec<f64> {
        vec![f64::INFINITY; self.pieces.len()]
    }

    /// Returns the corners of cells where the surface is farther than `distance` from all points; each
    /// hole appears more than once. `farthest` holds the distance of each piece from an earlier, smaller
    /// set of points and is updated where it exceeds `distance`. `work` is the number of points that may
    /// still be tested against cells, and is decreased.
    pub(super) fn holes(
        &self,
        sites: &VoronoiSites<'_>,
        distance: f64,
        farthest: &mut [f64],
        work: &mut usize,
    ) -> Vec<Hole> {
        let may: Vec<usize> = (0..farthest.len()).filter(|i| farthest[*i] > distance).collect();
        let found = parallel::ranges(may.len(), TOGETHER, |range| {
            let mut room = ClipBuffers::default();
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
