//! The nearest-feature partition of a profile: derives the regions of a tool from its outline.
//!
//! Features are the segments of the profile and its reflex corners. The axis is a mirror and not a feature, and a
//! tangent joint has no cell of its own. The outside is the inside of the profile traversed in the opposite direction.
//! `section` has the features, `slices` the exact partition, `curve` the expressions of borders, `nearer` those of
//! borders between two features, and `cells` the partition as polygons. This module combines borders to conditions.

pub(crate) mod cells;
pub(crate) mod check;
mod curve;
mod nearer;
pub(crate) mod normals;
pub(crate) mod overlay;
mod section;
mod slices;
pub(crate) mod smooth;

use crate::expr::{Graph, Id};
use crate::geometry::outline::{Point, Segment, turn};
use curve::Border;
pub(crate) use curve::{Test, direction_to_surface};
pub(crate) use section::Feature;
use section::{FootPoint, Obstacle, Section};
use slices::Slice;

/// The error of depths computed from a partition, relative to the partition's size.
pub(crate) const ROUNDING: f64 = 1e-10;

/// The cell of a feature, in which its distance is the least: its condition and its distance.
#[derive(Clone, Debug)]
pub(crate) struct Derived {
    pub(crate) feature: Feature,
    pub(crate) inside: Test,
    pub(crate) depth: Id,
}

/// A profile that could not be divided, with the point at which this was noticed.
pub(crate) struct Undivided(pub(crate) Point);

/// The exact partition of one side of an outline.
#[derive(Clone, Debug)]
pub(crate) struct Partition {
    outline: Vec<Segment>,
    outer: bool,
    slices: Vec<Vec<Slice>>,
}

impl Partition {
    /// Divides the left side of an outline. `outer` is true if that is the outside of the solid.
    pub(crate) fn new(outline: Vec<Segment>, outer: bool) -> Partition {
        let slices = slices::slices(&Section::new(&outline, outer));
        Partition { outline, outer, slices }
    }

    /// Returns the conditions and distances of the cells, feature by feature.
    ///
    /// # Errors
    ///
    /// If the derived conditions are wrong at a sampled point, or a constant has no value.
    pub(crate) fn parts(&self, graph: &mut Graph) -> Result<Vec<Derived>, Undivided> {
        let section = Section::new(&self.outline, self.outer);
        let slices = self.slices.iter().enumerate();
        slices.map(|(feature, slices)| section.derive_region(graph, feature, slices)).collect()
    }

    /// Returns the condition of the interior side of a segment's line or circle.
    pub(crate) fn inside(&self, graph: &mut Graph, piece: usize) -> Option<Test> {
        Border::Inside { piece }.test(&Section::new(&self.outline, self.outer), graph)
    }

    /// Returns the feature of each part, which is the one nearest to its points.
    pub(crate) fn features(&self) -> Vec<Feature> {
        Section::new(&self.outline, self.outer).features
    }

    /// Returns a point whose distance from the outline, computed by brute force, differs from its distance from the
    /// line, circle or corner of the part assigned to it by `part_at`.
    /// The points are taken along the normals of all cells, most densely near the ends.
    pub(crate) fn wrongly_assigned_point(
        &self,
        part_at: impl Fn(Point) -> Option<usize>,
    ) -> Option<Point> {
        let section = Section::new(&self.outline, self.outer);
        for slice in self.slices.iter().flatten() {
            let points = slice.sample_points(&section);
            let distances = section.distances_to_outline(&points, slice.feature);
            for (p, distance) in points.into_iter().zip(distances) {
                let slack = ROUNDING * section.size.max(distance);
                let is_right = part_at(p)
                    .is_some_and(|part| (section.depth_at(part, p) - distance).abs() <= slack);
                if !is_right {
                    return Some(p);
                }
            }
        }
        None
    }

    /// Returns polygons that cover the partition up to its outer limit, with `chords` chords per curved edge.
    pub(crate) fn cells(&self, chords: u32) -> Vec<cells::Cell> {
        cells::cells(&Section::new(&self.outline, self.outer), &self.slices, chords)
    }
}

/// A border that bounds a cell, except where one of the exceptions holds.
struct Bound {
    border: Border,
    unless: Vec<Border>,
}

impl Bound {
    fn always(border: Border) -> Bound {
        Bound { border, unless: Vec::new() }
    }

    fn holds_by(&self, section: &Section<'_>, p: Point, margin: f64) -> bool {
        self.border.holds_by(section, p, margin)
            || self.unless.iter().any(|border| border.holds(section, p))
    }

    fn test(&self, section: &Section<'_>, graph: &mut Graph) -> Option<Test> {
        let border = self.border.test(section, graph)?;
        if self.unless.is_empty() {
            return Some(border);
        }
        let mut alternatives = vec![border];
        for other in &self.unless {
            // Exceptions are strict: on an exception's own border the neighbour's foot is its end point, so the border
            // applies.
            alternatives.push(Test::Strictly(Box::new(other.test(section, graph)?)));
        }
        Some(Test::Any(alternatives))
    }
}

/// Positions along a slice at which borders are checked.
const SAMPLE_FRACTIONS: [f64; 17] = [
    0.002, 0.01, 0.04, 0.1, 0.17, 0.25, 0.33, 0.42, 0.5, 0.58, 0.67, 0.75, 0.83, 0.9, 0.96, 0.99,
    0.998,
];

impl Section<'_> {
    /// Returns the conditions of one feature's cell.
    ///
    /// Along a normal, the distance from the feature grows at rate 1, and any signed distance grows at most at rate 1,
    /// so a border that was crossed is not crossed back. Between the normals at its ends, a cell is therefore the set
    /// of points that no neighbour's border cuts off. A neighbour's line or circle extends beyond its segment; where
    /// the extension would cut into the cell, it is made an exception.
    fn derive_region(
        &self,
        graph: &mut Graph,
        feature: usize,
        slices: &[Slice],
    ) -> Result<Derived, Undivided> {
        let undivided = || Undivided(self.foot_point(feature, 0.5).at(1e-3 * self.size));
        let by_neighbour_ends = self.neighbours(feature, slices, false);
        let neighbours = match self.wrong_point(&by_neighbour_ends, slices) {
            None => by_neighbour_ends,
            Some(_) => {
                let own_normals = self.neighbours(feature, slices, true);
                if let Some(p) = self.wrong_point(&own_normals, slices) {
                    return Err(Undivided(p));
                }
                own_normals
            }
        };
        let mut bounds = self.ends(feature, &neighbours);
        bounds.extend(neighbours);
        let tests = bounds
            .iter()
            .map(|bound| bound.test(self, graph))
            .collect::<Option<Vec<Test>>>()
            .ok_or_else(undivided)?;
        let depth = self.depth(graph, feature).ok_or_else(undivided)?;
        Ok(Derived { feature: self.features[feature], inside: Test::All(tests), depth })
    }

    /// Returns the borders to neighbours, each once. Exceptions are the normals at the neighbour's ends or, with
    /// `own_normals`, the feature's own normals at the slices' ends.
    fn neighbours(&self, feature: usize, slices: &[Slice], own_normals: bool) -> Vec<Bound> {
        let mut bounds: Vec<Bound> = Vec::new();
        for slice in slices {
            let Obstacle::Feature(other) = slice.obstacle else { continue };
            let border = Border::Nearer { this: feature, other };
            if bounds.iter().any(|bound| bound.border == border) {
                continue;
            }
            let mut bound = Bound::always(border);
            let is_same_obstacle = |s: &&Slice| s.obstacle == slice.obstacle;
            let others = slices.iter().filter(|s| !is_same_obstacle(s));
            let wrongly_cut: Vec<Point> = others
                .flat_map(|s| s.points_on_normals(self, 12))
                .filter(|p| {
                    let own = self.depth_at(feature, *p);
                    own > self.depth_at(other, *p) + 1e-9 * self.size
                })
                .collect();
            if !wrongly_cut.is_empty() && own_normals {
                let same_obstacle: Vec<&Slice> = slices.iter().filter(is_same_obstacle).collect();
                if let (Some(first), Some(last)) = (same_obstacle.first(), same_obstacle.last()) {
                    if first.from > 0.0 {
                        bound.unless.push(Border::UpTo { feature, parameter: first.from });
                    }
                    if last.to < 1.0 {
                        bound.unless.push(Border::From { feature, parameter: last.to });
                    }
                }
            } else if !wrongly_cut.is_empty()
                && let Feature::Piece(piece) = self.features[other]
            {
                for end in [0, 1] {
                    let past = Border::Past { piece, end };
                    if wrongly_cut.iter().any(|p| past.holds(self, *p)) {
                        bound.unless.push(past);
                    }
                }
            }
            bounds.push(bound);
        }
        bounds
    }

    /// Returns whether a point is within all borders by a margin, given in units of the rounding there.
    fn is_within(&self, bounds: &[Bound], p: Point, margin: f64) -> bool {
        let margin = margin * self.rounding(p);
        bounds.iter().all(|bound| bound.holds_by(self, p, margin))
    }

    /// Returns a point that the borders to neighbours assign wrongly to the cell, or wrongly cut off, by more than rounding.
    fn wrong_point(&self, bounds: &[Bound], slices: &[Slice]) -> Option<Point> {
        for slice in slices.iter().filter(|slice| !slice.is_thin(self)) {
            for fraction in SAMPLE_FRACTIONS {
                let foot_point = slice.foot_at(self, fraction);
                let radius = slice.radius(self, fraction);
                let own =
                    [0.0, 0.2, 0.5, 0.8, 1.0 - 1e-6].map(|share| foot_point.at(share * radius));
                if let Some(p) = own.into_iter().find(|p| !self.is_within(bounds, *p, -1.0)) {
                    return Some(p);
                }
                if let Obstacle::Feature(_) = slice.obstacle {
                    let max_distance = self.focus(slice.feature);
                    let beyond = self.points_beyond(&foot_point, radius, max_distance, bounds);
                    if let Some(p) = beyond.into_iter().find(|p| self.is_within(bounds, *p, 1.0)) {
                        return Some(p);
                    }
                }
            }
        }
        None
    }

    /// Returns points on a normal beyond a cell's far end, at less than a maximum distance from the foot.
    fn points_beyond(
        &self,
        foot_point: &FootPoint,
        radius: f64,
        max_distance: f64,
        bounds: &[Bound],
    ) -> Vec<Point> {
        let mut distances =
            [1.0 + 1e-5, 1.05, 1.2, 1.5, 2.0, 3.0, 6.0].map(|times| times * radius).to_vec();
        // The points just before and behind the start of an exception.
        for border in bounds.iter().flat_map(|bound| &bound.unless) {
            let start = border.intersection_distance(self, foot_point);
            distances.extend([1e-9, 1e-4, -1e-9, -1e-4].map(|step| start + step * self.size));
        }
        distances.extend([0.5, 1.0, 3.0, 30.0].map(|sizes| sizes * self.size));
        distances.retain(|r| (radius..max_distance.min(100.0 * self.size)).contains(r));
        let points = distances.into_iter().map(|r| foot_point.at(r));
        points.filter(|p| p[0] >= 0.0).collect()
    }

    /// Returns the distance at which the normals of a feature meet, beyond which its distance shrinks again.
    fn focus(&self, feature: usize) -> f64 {
        match self.features[feature] {
            Feature::Piece(piece) => match self.outline[piece].round() {
                Some((_, radius, true)) => radius,
                _ => f64::INFINITY,
            },
            Feature::Corner(_) => f64::INFINITY,
        }
    }

    /// Returns the feature's own line or circle, and the normals at its ends where the neighbours do not imply them.
    fn ends(&self, feature: usize, neighbours: &[Bound]) -> Vec<Bound> {
        let mut bounds = Vec::new();
        match self.features[feature] {
            Feature::Piece(piece) => {
                bounds.push(Bound::always(Border::Inside { piece }));
                for end in [0, 1] {
                    if !self.imply_normal(neighbours, piece, end) {
                        bounds.push(Bound::always(Border::Before { piece, end }));
                    }
                }
            }
            Feature::Corner(previous) => {
                for (piece, end) in self.adjacent_segments(previous).into_iter().flatten() {
                    bounds.push(Bound::always(Border::Past { piece, end }));
                }
            }
        }
        bounds
    }

    /// Returns whether the borders to neighbours imply the normal at the start (0) or end (1) of a segment, as the
    /// bisector of two lines that meet in a convex corner does.
    fn imply_normal(&self, neighbours: &[Bound], piece: usize, end: usize) -> bool {
        let segment = &self.outline[piece];
        if segment.circle.is_some() {
            return false;
        }
        let next = if end == 1 { Some(piece + 1) } else { piece.checked_sub(1) };
        let Some(next) = next.filter(|next| *next < self.outline.len()) else {
            // At the axis, half of the mirrored corner suffices.
            let t = segment.tangent(end == 1);
            let outward = if end == 1 { t } else { [-t[0], -t[1]] };
            let mirrored_turn = turn(outward, [outward[0], -outward[1]]);
            return if end == 1 { mirrored_turn >= 0.0 } else { mirrored_turn <= 0.0 };
        };
        let [low, high] = [&self.outline[piece.min(next)], &self.outline[piece.max(next)]];
        turn(low.tangent(true), high.tangent(false)) > 0.0
            && self.outline[next].circle.is_none()
            && neighbours.iter().any(|bound| match bound.border {
                Border::Nearer { other, .. } => {
                    bound.unless.is_empty() && self.features[other] == Feature::Piece(next)
                }
                _ => false,
            })
    }
}
