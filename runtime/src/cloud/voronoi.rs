//! Restricted Voronoi diagram: the division of the surface among points, piece by piece, the area of each point's cell,
//! and the covering radius.
//!
//! A triangle is divided by `|x − p|² + σ² |n − m|²`, with p a point, m its normal, x a point of the triangle and n the
//! triangle's normal. The nearest point owns x; a point with another normal owns it only if it is much nearer. Cells
//! therefore end at edges, and the two sides of a thin sheet stay separate, but a face without points of its own goes
//! to nearby points. In the triangle's plane this is a power diagram: cells are convex. Each cell is the piece cut by
//! straight lines, one per neighbour, until no farther point can reach it. The diagram is traversed from one cell to
//! all cells whose lines touch it. With σ = 0 the corners of cells are the local maxima of the distance from all points
//! (Lévy and Bonneel 2013 describe both uses of such diagrams).
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

use crate::cloud::neighbours::{Lists, Neighbour, NeighbourBvh, squared_distance};
use crate::cloud::pieces::{Corner, EDGE, Surface, SurfacePiece, area, clip};
use crate::mesh::CompensatedSum;
use crate::parallel;
use nalgebra::{Point3, Vector3};
use std::collections::HashSet;

/// The part by which the reach of a cell is enlarged for rounding.
const REACH_MARGIN: f64 = 1e-12;

/// Radius, in spacings, that contains most of the points that cut a cell.
const NEIGHBOUR_RADIUS: f64 = 2.5;
/// Maximum number of these points that are kept. Where a part's extent agrees with its area, there are some twenty.
const MAX_NEIGHBOURS: usize = 128;
/// Fixed cost of a cell, in units of one point tested against a cell.
const CELL_COST: usize = 16;
/// Cost of finding and sorting one of the nearest points, in the same unit.
const NEIGHBOUR_COST: usize = 4;
/// Maximum number of points met that are searched linearly.
const MAX_LINEAR_SEARCH: usize = 64;
/// Points per parallel task.
const POINTS_PER_TASK: usize = 1 << 10;
/// Returns the error bound of a corner's signed distance from a line, relative to the sum of the magnitudes of its
/// terms, after `cuts` cuts of the cell (see above). It is constant up to twelve cuts, which most cells do not exceed.
fn rounding(cuts: u32) -> f64 {
    f64::EPSILON * f64::from(8 + 2 * cuts.max(12))
}

/// Points on a surface, with their spatial index.
pub(super) struct VoronoiSites<'a> {
    points: &'a [Point3<f64>],
    normals: &'a [Vector3<f64>],
    tree: NeighbourBvh,
    /// The points within `neighbour_radius` of each, the nearest first, at most [`MAX_NEIGHBOURS`].
    neighbours: Lists,
    neighbour_radius: f64,
}

/// The line between a cell's point and another point: `v · to_other = half`.
struct TouchedLine {
    other: u32,
    to_other: Vector3<f64>,
    half: f64,
    /// The sum of the magnitudes that [`rounding`] is relative to.
    terms: f64,
}

/// Reusable buffers for dividing a piece.
#[derive(Default)]
struct ClipBuffers {
    found: Vec<Neighbour>,
    farther: Vec<u32>,
    cell: Vec<Corner>,
    cut: Vec<Corner>,
    /// The lines that have touched the cell.
    touched: Vec<TouchedLine>,
    /// Points whose cells are or will be computed; the first owns the piece's centre.
    visited: Vec<u32>,
    /// The same points as a set, if there are many.
    visited_set: HashSet<u32>,
    /// The number of points tested against cells, plus the other costs of the cells.
    tests: usize,
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
                found.iter().for_each(|other| neighbours.push(other.index));
                neighbours.end();
            }
            neighbours
        });
        let neighbours = Lists::joined(lists);
        VoronoiSites { points, normals, tree, neighbours, neighbour_radius }
    }

    /// Returns what the normal of a point adds to the squared distance from it: `σ² |n − m|²`.
    fn power_weight(&self, site: u32, piece: &SurfacePiece, normal_weight: f64) -> f64 {
        normal_weight * (self.normals[site as usize] - piece.normal).norm_squared()
    }
}

impl Surface {
    /// Calls `on_cell` for each point that has a cell in a piece, with the cell's corners relative to the
    /// point. `normal_weight` is σ². Returns whether the division is complete: it ends after about `max_tests` tests
    /// of points against cells.
    fn divide(
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
        visited.clear();
        *tests = 0;
        if !visited_set.is_empty() {
            visited_set.clear();
        }
        let corners = self.corners(piece);
        let sum: Vector3<f64> = corners.iter().map(|corner| corner - corners[0]).sum();
        let middle = corners[0] + sum / corners.len() as f64;
        // Some cell contains the centre; the others are found from cell to cell across the lines between them.
        visited.push(
            sites
                .tree
                .min_sum(middle.into(), |site| sites.power_weight(site, piece, normal_weight)),
        );
        let mut next = 0;
        while let Some(&site) = visited.get(next) {
            if next > 0 && *tests >= max_tests {
                return false;
            }
            next += 1;
            *tests += CELL_COST;
            let site_point = sites.points[site as usize];
            let own_weight = sites.power_weight(site, piece, normal_weight);
            cell.clear();
            cell.extend(
                corners.iter().map(|corner| Corner { at: corner - site_point, neighbour: EDGE }),
            );
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
                    // The list is in order of distance: no later point reaches the cell either.
                    if squared > reach * reach {
                        break 'cut;
                    }
                    let other_weight = sites.power_weight(other, piece, normal_weight);
                    let half = (squared + other_weight - own_weight) / 2.0;
                    let terms = reach * squared.sqrt() + squared + other_weight + own_weight;
                    let slack = rounding(cuts) * terms;
                    let [min_value, max_value] = signed_distances(cell, &to_other, half);
                    if max_value < -slack {
                        continue;
                    }
                    touched.push(TouchedLine { other, to_other, half, terms });
                    if max_value <= slack {
                        // Rounding cannot tell the two points apart anywhere in the cell.
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
                let last_examined = last.map(|index| {
                    let position = sites.points[index as usize].into();
                    let squared = squared_distance(position, site_point.into());
                    Neighbour { squared, index }
                });
                // Eight times as many each time, so that all searches before the last one cost little beside it.
                max_neighbours = (8 * max_neighbours).min(remaining);
                sites.tree.nearest_within(site_point.into(), reach, max_neighbours, found);
                *tests += NEIGHBOUR_COST * found.len();
                farther.clear();
                let not_examined = found.iter().filter(|one| match &last_examined {
                    None => one.squared > searched_radius * searched_radius,
                    Some(last) => last.nearer(one).is_lt(),
                });
                farther.extend(not_examined.map(|other| other.index));
                list = farther;
                last =
                    found.last().map(|last| last.index).filter(|_| found.len() == max_neighbours);
                searched_radius = reach;
            }
            if !cell.is_empty() {
                on_cell(site, cell);
                let error = rounding(cuts);
                // Later cuts may have parted the cell from a line that touched it before.
                for line in touched.iter() {
                    let [_, max_value] = signed_distances(cell, &line.to_other, line.half);
                    if max_value >= -error * line.terms {
                        add_visited(visited, visited_set, line.other);
                    }
                }
            }
        }
        true
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

/// Returns an upper bound on the distance from a cell's point to other points that cut the cell. Each length errs by 3u
/// below its root and two more, and a corner by 2.5u per line that cut the cell; [`REACH_MARGIN`] is 9000u.
fn reach_of(cell: &[Corner], own_weight: f64) -> f64 {
    let max_squared = cell.iter().map(|corner| corner.at.norm_squared()).fold(0.0, f64::max);
    (max_squared.sqrt() + (max_squared + own_weight).sqrt()) * (1.0 + REACH_MARGIN)
}

/// Returns the smallest and the largest value of `v · toward - half` over the corners of a cell.
fn signed_distances(cell: &[Corner], to_other: &Vector3<f64>, half: f64) -> [f64; 2] {
    cell.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[min_value, max_value], corner| {
        let distance = corner.beyond(to_other, half);
        [min_value.min(distance), max_value.max(distance)]
    })
}

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
/// A corner of a piece errs by u of the part's size where it is computed, and by 5u of the cut edge for each cut that
/// made the piece. Each cut halves the longer of two extents, so these edges add up to less than six times the
/// triangle's longest edge: 120u of the part's size in all. A cell's corner errs by 5u of its distance for each line
/// that cut it (see `voronoi`), which allows up to 1700 lines. The distance itself errs by 4u.
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

impl Hole {
    /// Returns whether a point is nearer than all others were when the hole was found.
    pub(super) fn is_crowded_by(&self, point: &Point3<f64>) -> bool {
        (point - self.point).norm() < 0.999 * self.distance
    }
}

/// The area of each point's cell, and the covering radius.
pub(super) struct Cells {
    pub(super) areas: Vec<f64>,
    pub(super) radius: f64,
}

/// The result of dividing several pieces among the points.
struct DividedPieces {
    /// Areas of the cells in the pieces that were divided completely, by point.
    shares: Vec<CellShare>,
    /// An upper bound on the distance between each piece and its nearest points; infinite if unknown.
    distances: Vec<f64>,
    /// The pieces that were not divided completely, with the cell areas found.
    incomplete: Vec<(usize, Vec<CellShare>)>,
}

/// The areas of cells, and the distance of each piece from all points, as pieces are divided.
struct CellSums {
    areas: Vec<CompensatedSum>,
    farthest: Vec<f64>,
    /// The pieces that were not divided completely, with the cell areas found.
    incomplete: Vec<(usize, Vec<CellShare>)>,
}

/// The area of a point's cell in some piece.
struct CellShare {
    site: u32,
    area: f64,
}

impl CellSums {
    fn add_shares(&mut self, shares: Vec<CellShare>) {
        shares.into_iter().for_each(|share| self.areas[share.site as usize].add(share.area));
    }

    /// Adds the results of the pieces `indices`.
    fn add(&mut self, indices: &[usize], results: Vec<DividedPieces>) {
        let mut order = indices.iter();
        for divided in results {
            self.add_shares(divided.shares);
            for (distance, piece) in divided.distances.into_iter().zip(&mut order) {
                self.farthest[*piece] = distance;
            }
            self.incomplete.extend(divided.incomplete);
        }
    }
}

impl Surface {
    /// Divides the surface among the points. If more points have a share of a piece than the work limit
    /// allows, the piece is shared among those examined. Its distance from all points is then bounded by
    /// that of its farthest corner from one of them.
    pub(super) fn cells(&self, sites: &VoronoiSites<'_>) -> Cells {
        let mut sums = CellSums {
            areas: vec![CompensatedSum::default(); sites.points.len()],
            farthest: vec![0.0; self.pieces.len()],
            incomplete: vec![],
        };
        let all_pieces: Vec<usize> = (0..self.pieces.len()).collect();
        sums.add(&all_pieces, self.shares(sites, &all_pieces, self.initial_max_tests()));
        // Divide the incomplete pieces once more with all the work allowed; there are usually few of them.
        let max_tests = self.max_extra_tests(sites) / sums.incomplete.len().max(1);
        if max_tests > self.initial_max_tests() {
            let indices: Vec<usize> = sums.incomplete.drain(..).map(|(piece, _)| piece).collect();
            sums.add(&indices, self.shares(sites, &indices, max_tests));
        }
        for (_, shares) in std::mem::take(&mut sums.incomplete) {
            sums.add_shares(shares);
        }
        let radius = self.radius(sites, &sums.farthest);
        Cells { areas: sums.areas.into_iter().map(CompensatedSum::value).collect(), radius }
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
        // σ² scales with the spacing: a point on another face has to be nearer by the same part of it at every density.
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
                        shares.push(CellShare { site, area: area(cell, &piece.normal) });
                        max_squared = cell
                            .iter()
                            .map(|corner| corner.at.norm_squared())
                            .fold(max_squared, f64::max);
                    },
                );
                // Distribute the area that rounding left over or out.
                let sum: f64 = shares[from..].iter().map(|share| share.area).sum();
                let total = f64::from(piece.copies) * piece.area;
                if sum > 0.0 {
                    shares[from..].iter_mut().for_each(|share| share.area *= total / sum);
                } else {
                    shares.push(CellShare { site: buffers.visited[0], area: total });
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
        // The farthest first: few pieces are refined before no bound exceeds the radius found.
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
                    max_distance =
                        cell.iter().map(|corner| corner.at.norm()).fold(max_distance, f64::max);
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
                        for Corner { at, .. } in cell {
                            let distance_to_point = at.norm();
                            max_distance = max_distance.max(distance_to_point);
                            if distance_to_point > distance {
                                let point = sites.points[site as usize] + at;
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
