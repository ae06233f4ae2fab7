//! The nearest-feature partition of a profile: derives the regions of a tool from its outline.
//!
//! Features are the segments of the profile and its reflex corners. The axis is a mirror and not a feature, and a
//! tangent joint has no cell of its own. `section` has the features, `cover` convex polygons that provably cover their
//! cells, `curve` the expressions of borders, `nearer` those of borders between two features. `pieces` and `outside` are
//! what a plan separates. `slices` follows the cells along the profile, and this module combines borders to conditions.

pub(crate) mod check;
mod cover;
mod curve;
mod nearer;
pub(crate) mod normals;
mod outside;
pub(crate) mod overlay;
pub(crate) mod pieces;
mod section;
mod slices;
pub(crate) mod smooth;

use crate::expr::{Graph, Id};
use crate::geometry::outline::{Point, Segment, bounding_box, turn};
use crate::geometry::polygon::Polygon;
use curve::Border;
pub(crate) use curve::{Test, direction_to_surface};
pub(crate) use section::{Feature, Section};
use section::{FootPoint, Obstacle};
use slices::Slice;

/// The cell of a feature, in which its distance is the least: its condition and its distance.
#[derive(Clone, Debug)]
pub(crate) struct Derived {
    pub(crate) feature: Feature,
    pub(crate) inside: Test,
    pub(crate) depth: Id,
    /// False if rounding decides about the condition at a sampled point.
    pub(crate) is_right_at_samples: bool,
}

/// A profile that could not be divided, with the point at which this was noticed.
pub(crate) struct Undivided(pub(crate) Point);

/// The partition of the inside of an outline.
#[derive(Clone, Debug)]
pub(crate) struct Partition {
    outline: Vec<Segment>,
    /// For each feature, polygons that cover its cell.
    covers: Vec<Vec<Polygon>>,
}

impl Partition {
    /// Divides the inside of an outline.
    pub(crate) fn new(outline: Vec<Segment>) -> Partition {
        let section = Section::new(&outline);
        let [low, high] = bounding_box(&outline);
        let bounds = vec![[0.0, low[1]], [high[0], low[1]], high, [0.0, high[1]]];
        let features = 0..section.features.len();
        let covers = features.map(|feature| section.cover(feature, &bounds)).collect();
        Partition { outline, covers }
    }

    /// Returns the polygons that cover the cell of a feature.
    #[cfg(test)]
    fn cover_of(&self, feature: usize) -> &[Polygon] {
        &self.covers[feature]
    }

    /// Returns the features and their geometry.
    pub(crate) fn section(&self) -> Section<'_> {
        Section::new(&self.outline)
    }

    /// Returns the conditions and distances of the cells, feature by feature.
    ///
    /// # Errors
    ///
    /// If a constant has no value.
    pub(crate) fn parts(&self, graph: &mut Graph) -> Result<Vec<Derived>, Undivided> {
        let section = self.section();
        let slices = slices::slices(&section);
        let slices = slices.iter().enumerate();
        slices.map(|(feature, slices)| section.derive_region(graph, feature, slices)).collect()
    }

    /// Returns the condition of the interior side of a segment's line or circle.
    pub(crate) fn inside(&self, graph: &mut Graph, piece: usize) -> Option<Test> {
        Border::Inside { piece }.test(&self.section(), graph)
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
        let mut is_right_at_samples = self.wrong_point(&by_neighbour_ends, slices).is_none();
        let mut neighbours = by_neighbour_ends;
        if !is_right_at_samples {
            let own_normals = self.neighbours(feature, slices, true);
            if self.wrong_point(&own_normals, slices).is_none() {
                (neighbours, is_right_at_samples) = (own_normals, true);
            }
        }
        let mut bounds = self.ends(feature, &neighbours);
        bounds.extend(neighbours);
        let tests = bounds
            .iter()
            .map(|bound| bound.test(self, graph))
            .collect::<Option<Vec<Test>>>()
            .ok_or_else(undivided)?;
        let depth = self.depth(graph, feature).ok_or_else(undivided)?;
        Ok(Derived {
            feature: self.features[feature],
            inside: Test::All(tests),
            depth,
            is_right_at_samples,
        })
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
