//! Voronoi cells of points on a surface: the area of each point's cell, and the covering radius.

use super::pieces::Surface;
use super::voronoi::{ClipBuffers, VoronoiSites, area};
use crate::mesh::CompensatedSum;
use crate::parallel;
use nalgebra::Point3;

/// σ² of the `voronoi` module, in squared spacings.
const NORMAL_WEIGHT: f64 = 2.25;
/// Pieces per parallel task.
const PIECES_PER_TASK: usize = 256;
/// Initial limits on the number of points tested against the cells of a piece: the upper limit, and the
/// lower limit for surfaces with many pieces.
const MAX_TESTS_PER_PIECE: usize = 1 << 14;
const MIN_TESTS_PER_PIECE: usize = 1 << 10;
/// Total for all pieces, unless the lower limit per piece requires more.
const MAX_TESTS_TOTAL: usize = 1 << 26;
/// Bound on the distance between a corner and its computed position, relative to the part's size and to
/// the radius: 9000u, with unit roundoff u.
///
/// A corner of a piece errs by u of the part's size where it is computed, and by 5u of the cut edge for
/// each cut that made the piece. Each cut halves the longer of two extents, so these edges add up to
/// less than six times the triangle's longest edge: 120u of the part's size in all. A cell's corner errs
/// by 5u of its distance for each line that cut it (see `voronoi`), which allows up to 1700 lines. The
/// distance itself errs by 4u.
const POSITION_ERROR: f64 = 1e-12;
/// Fractions of a piece's area that its cells must fill, for the covering radius of the piece in the
/// first pass and in the refined pass. Cells fill a piece except for rounding (see `voronoi`). If they
/// do not, something else went wrong or the area itself is mere rounding, so the cells are not used.
const FILLED_FRACTION: f64 = 1.0 - 1e-6;
const REFINED_FILLED_FRACTION: f64 = 1.0 - 1e-9;

/// A surface point far from all points of the cloud.
#[derive(Clone, Copy)]
pub(super) struct Hole {
    pub(super) point: Point3<f64>,
    pub(super) triangle: u32,
    pub(super) distance: f64,
}

/// The area of each point's cell, and the covering radius.
pub(super) struct Cells {
    pub(super) areas: Vec<f64>,
    pub(super) radius: f64,
}

/// The result of dividing several pieces among the points.
struct DividedPieces {
    /// Areas of the cells in the pieces that were divided completely, by point.
    shares: Vec<(u32, f64)>,
    /// An upper bound on the distance between each piece and its nearest points; infinite if unknown.
    distances: Vec<f64>,
    /// The pieces that were not divided completely, with the cell areas found.
    incomplete: Vec<(usize, Vec<(u32, f64)>)>,
}

fn add_shares(areas: &mut [CompensatedSum], shares: Vec<(u32, f64)>) {
    shares.into_iter().for_each(|(site, share)| areas[site as usize].add(share));
}

impl Surface {
    /// Divides the surface among the points. If more points have a share of a piece than the work limit
    /// allows, the piece is shared among those examined. Its distance from all points is then bounded by
    /// that of its farthest corner from one of them.
    pub(super) fn cells(&self, sites: &VoronoiSites<'_>) -> Cells {
        let mut areas = vec![CompensatedSum::default(); sites.points.len()];
        let mut farthest = vec![0.0; self.pieces.len()];
        let mut incomplete = vec![];
        let mut divide_all = |indices: &[usize], max_tests: usize, incomplete: &mut Vec<_>| {
            let mut order = indices.iter();
            for divided in self.shares(sites, indices, max_tests) {
                add_shares(&mut areas, divided.shares);
                let distances = divided.distances.into_iter().zip(&mut order);
                distances.for_each(|(distance, piece)| farthest[*piece] = distance);
                incomplete.extend(divided.incomplete);
            }
        };
        let all_pieces: Vec<usize> = (0..self.pieces.len()).collect();
        divide_all(&all_pieces, self.initial_max_tests(), &mut incomplete);
        // Divide the incomplete pieces once more with all the work allowed; there are usually few of
        // them.
        let max_tests = self.max_extra_tests(sites) / incomplete.len().max(1);
        if max_tests > self.initial_max_tests() {
            let indices: Vec<usize> = incomplete.drain(..).map(|(piece, _)| piece).collect();
            divide_all(&indices, max_tests, &mut incomplete);
        }
        incomplete.into_iter().for_each(|(_, shares)| add_shares(&mut areas, shares));
        let areas = areas.into_iter().map(CompensatedSum::value).collect();
        Cells { areas, radius: self.radius(sites, &farthest) }
    }

    /// Returns the number of points that may be tested against cells in addition to the usual ones.
    fn max_extra_tests(&self, sites: &VoronoiSites<'_>) -> usize {
        let any = if self.is_coarse() { 1 << 22 } else { 1 << 26 };
        256 * (sites.points.len() + self.pieces.len()) + any
    }

    /// Returns the initial limit on the number of points tested against the cells of a piece. The usual
    /// number is some hundred, or some thousand where pieces are long.
    fn initial_max_tests(&self) -> usize {
        if self.is_coarse() {
            return 2 * MIN_TESTS_PER_PIECE;
        }
        (MAX_TESTS_TOTAL / self.pieces.len().max(1)).clamp(MIN_TESTS_PER_PIECE, MAX_TESTS_PER_PIECE)
    }

    /// Divides the pieces `indices`, testing at most about `max_tests` points against the cells of each.
    fn shares(
        &self,
        sites: &VoronoiSites<'_>,
        indices: &[usize],
        max_tests: usize,
    ) -> Vec<DividedPieces> {
        let normal_weight = NORMAL_WEIGHT * self.spacing * self.spacing;
        parallel::ranges(indices.len(), PIECES_PER_TASK, |range| {
            let mut buffers = ClipBuffers::default();
            let (mut shares, mut incomplete) = (vec![], vec![]);
            let mut distances = Vec::with_capacity(range.len());
            for index in range {
                let piece = &self.pieces[indices[index]];
                let from = shares.len();
                let mut max_squared = 0f64;
                let is_complete = self.divide(
                    piece,
                    sites,
                    normal_weight,
                    max_tests,
                    &mut buffers,
                    |site, cell| {
                        shares.push((site, area(cell, &piece.normal)));
                        max_squared =
                            cell.iter().map(|(v, _)| v.norm_squared()).fold(max_squared, f64::max);
                    },
                );
                // Distribute the area that rounding left over or out.
                let sum: f64 = shares[from..].iter().map(|(_, share)| share).sum();
                let total = f64::from(piece.copies) * piece.area;
                if sum > 0.0 {
                    shares[from..].iter_mut().for_each(|(_, share)| *share *= total / sum);
                } else {
                    shares.push((buffers.visited[0], total));
                }
                // Cells that do not fill the piece give no bound for the rest.
                let fills = is_complete && sum >= FILLED_FRACTION * piece.area;
                distances.push(if fills { max_squared.sqrt() } else { f64::INFINITY });
                if !is_complete {
                    incomplete.push((indices[index], shares.split_off(from)));
                }
            }
            DividedPieces { shares, distances, incomplete }
        })
    }

    /// Returns the covering radius, given an upper bound on the distance of each piece.
    fn radius(&self, sites: &VoronoiSites<'_>, farthest: &[f64]) -> f64 {
        let mut order: Vec<usize> = (0..self.pieces.len()).collect();
        order.sort_unstable_by(|a, b| farthest[*b].total_cmp(&farthest[*a]));
        let mut radius = 0f64;
        let mut buffers = ClipBuffers::default();
        let mut remaining_tests = self.max_extra_tests(sites);
        for index in order {
            if farthest[index] <= radius {
                break;
            }
            let piece = &self.pieces[index];
            let (mut filled, mut max_distance) = (0.0, 0f64);
            let is_complete =
                self.divide(piece, sites, 0.0, remaining_tests, &mut buffers, |_, cell| {
                    filled += area(cell, &piece.normal);
                    max_distance = cell.iter().map(|(v, _)| v.norm()).fold(max_distance, f64::max);
                });
            remaining_tests = remaining_tests.saturating_sub(buffers.tests);
            if !is_complete || filled < REFINED_FILLED_FRACTION * piece.area {
                // The nearest point is at most as far from any surface point as this one is.
                let site = sites.points[buffers.visited[0] as usize];
                max_distance =
                    self.corners(piece).iter().map(|c| (c - site).norm()).fold(0.0, f64::max);
            }
            radius = radius.max(max_distance);
        }
        radius * (1.0 + POSITION_ERROR) + self.position_error()
    }

    /// Returns a bound on the distance between a surface point and its computed position.
    pub(super) fn position_error(&self) -> f64 {
        self.size * POSITION_ERROR
    }

    /// Returns the upper bound on the distance of each piece before there are any points: infinity.
    pub(super) fn farthest(&self) -> Vec<f64> {
        vec![f64::INFINITY; self.pieces.len()]
    }

    /// Returns the corners of cells where the surface is farther than `distance` from all points; each
    /// hole appears more than once. `farthest` holds the distance of each piece from an earlier, smaller
    /// set of points and is updated where it exceeds `distance`. `remaining_tests` is the number of points that may
    /// still be tested against cells, and is decreased.
    pub(super) fn holes(
        &self,
        sites: &VoronoiSites<'_>,
        distance: f64,
        farthest: &mut [f64],
        remaining_tests: &mut usize,
    ) -> Vec<Hole> {
        let open: Vec<usize> = (0..farthest.len()).filter(|i| farthest[*i] > distance).collect();
        let found = parallel::ranges(open.len(), PIECES_PER_TASK, |range| {
            let mut buffers = ClipBuffers::default();
            let (mut holes, mut farthest, mut tests) = (vec![], vec![], 0);
            for index in range {
                let piece = &self.pieces[open[index]];
                let mut max_distance = 0f64;
                self.divide(
                    piece,
                    sites,
                    0.0,
                    self.initial_max_tests(),
                    &mut buffers,
                    |site, cell| {
                        for (corner, _) in cell {
                            let distance_to_point = corner.norm();
                            max_distance = max_distance.max(distance_to_point);
                            if distance_to_point > distance {
                                let point = sites.points[site as usize] + corner;
                                holes.push(Hole {
                                    point,
                                    triangle: piece.triangle,
                                    distance: distance_to_point,
                                });
                            }
                        }
                    },
                );
                farthest.push(max_distance);
                tests += buffers.tests;
            }
            (holes, farthest, tests)
        });
        let mut piece_indices = open.into_iter();
        let mut holes = vec![];
        for (new_holes, distances, tests) in found {
            holes.extend(new_holes);
            *remaining_tests = remaining_tests.saturating_sub(tests);
            for (distance, piece) in distances.into_iter().zip(&mut piece_indices) {
                farthest[piece] = distance;
            }
        }
        holes
    }
}
