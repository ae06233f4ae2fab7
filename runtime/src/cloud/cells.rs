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
/// How far a corner can be from where it is computed, of the part's size.
const ROUNDED: f64 = 1e-12;

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

impl Surface {
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
                // Cells that do not fill the piece tell nothing of what they leave.
                let fills = sum >= (1.0 - 1e-6) * piece.area;
                farthest.push(if fills { most.sqrt() } else { f64::INFINITY });
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
        for index in order {
            if farthest[index] <= radius {
                break;
            }
            let piece = &self.pieces[index];
            let (mut filled, mut most) = (0.0, 0f64);
            self.divide(piece, sites, 0.0, &mut room, |_, cell| {
                filled += area(cell, &piece.normal);
                most = cell.iter().map(|(v, _)| v.norm()).fold(most, f64::max);
            });
            if filled < (1.0 - 1e-9) * piece.area {
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
}
