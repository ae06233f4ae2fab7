//! The section as convex pieces, each with the part or the outside that may own its points, and with what is known of
//! these points: the sides of curves on which they lie.

use super::Partition;
use super::cover::TIE_TOLERANCES;
use super::curve::Test;
use super::section::{Feature, Section};
use crate::expr::Graph;
use crate::formula::{CurveIndex, Formula, NEGATIVE, POSITIVE, Signs};
use crate::geometry::function::{CurveFunction, Distance};
use crate::geometry::outline::{Point, bounding_box, minus, norm};
use crate::geometry::polygon::{
    Polygon, are_boxes_apart, area, centroid, clipped, divided, do_touch, extent, halved,
    near_part, sides, width,
};
use std::collections::VecDeque;
use std::rc::Rc;

/// A convex polygon and the owner of some of its points: those on the known sides of curves. With one vertex it is a
/// point, which rounding may put on either side of a curve through it.
#[derive(Clone, Debug)]
pub(crate) struct Piece {
    /// The nearest feature to the owned points; `None` for the outside.
    pub(crate) feature: Option<usize>,
    /// The index of the feature, of the region, or of the segment of a rounded outline; `None` for the outside.
    pub(crate) owner: Option<usize>,
    pub(crate) vertices: Polygon,
    /// The sides of curves on which the owned points lie.
    pub(crate) signs: Vec<(CurveIndex, Signs)>,
    /// Conditions with alternatives that the owned points satisfy.
    pub(crate) alternatives: Vec<Formula>,
}

impl Piece {
    /// Returns a piece of a feature, or of the outside, all of whose points are owned.
    fn new(feature: Option<usize>, vertices: Polygon) -> Piece {
        let (signs, alternatives) = (Vec::new(), Vec::new());
        Piece { feature, owner: feature, vertices, signs, alternatives }
    }

    /// Returns a piece of the outside.
    pub(super) fn outside(vertices: Polygon, signs: Vec<(CurveIndex, Signs)>) -> Piece {
        Piece { signs, ..Piece::new(None, vertices) }
    }
}

/// A piece with points that belong to its owner, and their weights.
#[derive(Clone, Debug)]
pub(crate) struct SampledPiece {
    pub(crate) piece: Rc<Piece>,
    pub(crate) points: Vec<(Point, f64)>,
}

/// The tests that tell features apart, as formulas over curves.
#[derive(Clone, Debug)]
pub(crate) struct Separations {
    /// For each feature, the condition of its own side.
    pub(super) own: Vec<Formula>,
    /// The conditions between features whose cells touch.
    nearer: Vec<Nearness>,
}

impl Separations {
    /// Returns the side of a feature's line or circle on which the outside is.
    pub(super) fn outer_side(&self, feature: usize) -> Option<(CurveIndex, Signs)> {
        match &self.own[feature] {
            Formula::Atom { curve, below } => {
                Some((*curve, if *below { POSITIVE } else { NEGATIVE }))
            }
            _ => None,
        }
    }
}

/// The condition for a feature to be no farther than another.
#[derive(Clone, Debug)]
struct Nearness {
    feature: usize,
    other: usize,
    formula: Formula,
}

/// The distance, in sizes, within which the polygons of neighbours touch.
const TOUCHING_FRACTION: f64 = 1e-9;
/// The least number of features whose borders meet in one point. Fewer have few borders, all of which are asked.
const CROWD: usize = 40;
/// The difference of distances, in sizes, of features whose borders meet.
const CROWD_FRACTION: f64 = 1e-8;
/// The extent of a contact, in sizes, up to which a border is left out there.
const MAX_LEFT_OUT_FRACTION: f64 = 4e-9;
/// The difference of distances, in sizes, on the way across it.
const LEFT_OUT_FRACTION: f64 = 4e-12;
/// The distance from the outline's bounding box up to which the outside is sampled, in sizes.
const SAMPLED_FRACTION: f64 = 0.25;
/// The area that is sampled as one, relative to the square of the section's size.
const MAX_SAMPLED_FRACTION: f64 = 1e-3;
/// The number of times that a piece is halved because it is too large for what a rival's condition says.
const MAX_PIECE_HALVINGS: usize = 6;
/// The number of times that a piece is halved for points all over it.
const DENSE_HALVINGS: usize = 7;
/// The thickness of the layer near the surface that is weighted most, in sizes.
const SHELL_FRACTION: f64 = 0.05;

impl Partition {
    /// Returns the tests that separate the parts. `register` makes a formula of a test.
    pub(crate) fn separations(
        &self,
        graph: &mut Graph,
        register: &mut impl FnMut(&mut Graph, &Test) -> Formula,
    ) -> Separations {
        let section = self.section();
        let own = section.features.iter().map(|feature| {
            let own = feature.piece().and_then(|piece| section.inside(graph, piece));
            own.map_or(Formula::Const(true), |test| register(graph, &test))
        });
        let own: Vec<Formula> = own.collect();
        let mut nearer = Vec::new();
        for [a, b] in self.neighbours(&section) {
            // Tangent segments, and a corner and its segments, are told apart by the normals between them alone.
            if let Some((piece, end)) = section.smooth_joint(a, b) {
                if let Some(test) = section.before(graph, piece, end) {
                    register(graph, &test);
                }
                continue;
            }
            if let Some(test) = section.nearer(graph, a, b) {
                let formula = register(graph, &test);
                nearer.push(Nearness { feature: b, other: a, formula: formula.opposite() });
                nearer.push(Nearness { feature: a, other: b, formula });
            }
        }
        // Beyond the normal at its end the border of an arc says nothing.
        let is_arc =
            |piece: usize| self.outline.get(piece).is_some_and(|segment| segment.circle.is_some());
        for piece in 0..self.outline.len() {
            for (end, next) in [(0, piece.checked_sub(1)), (1, Some(piece + 1))] {
                let is_known = end == 0 && section.is_smooth_start(piece);
                if !is_known
                    && (is_arc(piece) || next.is_some_and(is_arc))
                    && let Some(test) = section.before(graph, piece, end)
                {
                    register(graph, &test);
                }
            }
        }
        Separations { own, nearer }
    }

    /// Sets the two distances that each curve between features compares.
    pub(crate) fn set_distances(
        &self,
        separations: &Separations,
        shapes: &mut [CurveFunction<'_>],
    ) {
        let section = self.section();
        let distance = |feature: usize| match section.features[feature] {
            Feature::Piece(piece) => Distance::of(&self.outline[piece]),
            Feature::Corner(previous) => {
                let centre = section.corner_at(previous);
                Distance::Circle { centre, radius: 0.0, sign: 1.0 }
            }
        };
        let mut set = |formula: &Formula, [less, more]: [Distance; 2]| {
            if let Formula::Atom { curve, below } = formula {
                let distances = if *below { [less, more] } else { [more, less] };
                shapes[*curve].set_distances(distances);
            }
        };
        for (feature, own) in separations.own.iter().enumerate() {
            set(own, [Distance::None, distance(feature)]);
        }
        for near in &separations.nearer {
            set(&near.formula, [distance(near.feature), distance(near.other)]);
        }
    }

    /// Returns pairs of features between whose cells a border matters, the first listed first: their polygons touch, and not
    /// only where the borders of many features meet.
    fn neighbours(&self, section: &Section<'_>) -> Vec<[usize; 2]> {
        let distance = TOUCHING_FRACTION * section.size;
        let mut neighbours = Vec::new();
        for (a, cover) in self.covers.iter().enumerate() {
            for (b, other) in self.covers[..a].iter().enumerate() {
                let pairs = cover.iter().flat_map(|p| other.iter().map(move |q| (p, q)));
                let touching: Vec<_> = pairs.filter(|(p, q)| do_touch(p, q, distance)).collect();
                if !touching.is_empty() && !section.meet_in_a_crowd([a, b], &touching) {
                    neighbours.push([b, a]);
                }
            }
        }
        neighbours
    }

    /// Returns pieces that cover the inside.
    pub(crate) fn inner_pieces(
        &self,
        separations: &Separations,
        shapes: &[CurveFunction<'_>],
    ) -> Vec<Piece> {
        let section = self.section();
        let tolerance = section.tolerance();
        let mut pieces = Vec::new();
        for (feature, cover) in self.covers.iter().enumerate() {
            let rivals: Vec<Rival<'_>> = separations
                .nearer
                .iter()
                .filter(|near| near.feature == feature)
                .map(|near| Rival { feature: near.other, nearer: &near.formula })
                .collect();
            let polygons = cover
                .iter()
                .flat_map(|polygon| decided(&section, polygon.clone(), &rivals, shapes));
            let mut pending: VecDeque<_> = polygons.map(|polygon| (polygon, 0)).collect();
            while let Some((polygon, halvings)) = pending.pop_front() {
                let mut piece = Piece::new(Some(feature), polygon);
                let mut is_possible = piece.know(&separations.own[feature], shapes, tolerance);
                let mut is_vague = false;
                for rival in &rivals {
                    match rival.competes(&section, &piece) {
                        Some(true) => {
                            is_possible &= piece.know(rival.nearer, shapes, tolerance)
                                && piece.know(&separations.own[rival.feature], shapes, tolerance);
                        }
                        Some(false) => {}
                        None => is_vague |= piece.decide(rival.nearer, shapes, tolerance).is_none(),
                    }
                }
                if is_possible && is_vague && halvings < MAX_PIECE_HALVINGS {
                    let halves = halved(&piece.vertices).into_iter().flatten();
                    pending.extend(halves.map(|half| (half, halvings + 1)));
                } else if is_possible {
                    pieces.push(piece);
                }
            }
        }
        pieces
    }
}

impl Section<'_> {
    /// Returns whether polygons of two features touch only where the borders of many meet in one point but for rounding, as those of a
    /// ball drawn as chords do in its centre: of points so near to a border, it does not matter which of the two has them, and all
    /// others are told apart by the borders with other neighbours. The difference of distances from two lines changes at most at
    /// one rate everywhere, and polygons err by the rounding of distances, divided by that rate.
    fn meet_in_a_crowd(&self, [a, b]: [usize; 2], touching: &[(&Polygon, &Polygon)]) -> bool {
        if self.features.len() < CROWD {
            return false;
        }
        let [Some(one), Some(other)] = [a, b].map(|feature| self.line_direction(feature)) else {
            return false;
        };
        let rate = norm(minus(one, other));
        let near_parts = |distance: f64| -> Polygon {
            let parts = touching.iter().filter_map(|(p, q)| near_part(p, q, distance));
            parts.flatten().collect()
        };
        let contact = near_parts(TIE_TOLERANCES * self.tolerance() / rate);
        if extent(&contact) > self.size * MAX_LEFT_OUT_FRACTION.min(LEFT_OUT_FRACTION / rate) {
            return false;
        }
        let loose = near_parts(TOUCHING_FRACTION * self.size);
        if loose.is_empty() {
            return false;
        }
        let at = centroid(&loose);
        let distances = (0..self.features.len()).map(|feature| self.distance_of(feature, at));
        let own = self.distance_of(a, at);
        let is_as_near = |distance: &f64| (distance - own).abs() <= CROWD_FRACTION * self.size;
        distances.filter(is_as_near).count() >= CROWD
    }

    /// Returns a point with the nearest feature as its owner, or the outside; `None` if rounding decides about that.
    pub(crate) fn point(&self, p: Point) -> Option<Piece> {
        let distances: Vec<f64> =
            (0..self.features.len()).map(|feature| self.distance_of(feature, p)).collect();
        let distance = distances.iter().copied().fold(f64::INFINITY, f64::min);
        // Where a corner is nearest, its segments end, whose lines and circles may be nearer.
        let excess = |feature: &usize| (self.depth_at(*feature, p) - distance).abs();
        let nearest = (0..distances.len())
            .filter(|feature| distances[*feature] <= distance + self.tolerance())
            .min_by(|one, other| excess(one).total_cmp(&excess(other)))?;
        if distance <= self.tolerance() {
            return Some(Piece::new(Some(nearest), vec![p]));
        }
        let step = 0.25 * distance.min(1e-6 * self.size);
        let [low, high] = [-step, step].map(|by| self.is_inside([p[0], p[1] + by]));
        (low == high).then(|| Piece::new(low.then_some(nearest), vec![p]))
    }

    /// Returns points of a piece that belong to its owner, with weights: their share of its area, and most near the surface.
    pub(crate) fn sample_points(&self, piece: &Piece) -> Vec<(Point, f64)> {
        // The outside is sampled up to a distance.
        let [low, high] = bounding_box(self.outline);
        let margin = SAMPLED_FRACTION * self.size;
        let near = clipped(&piece.vertices, &|p| high[0] + margin - p[0])
            .and_then(|polygon| clipped(&polygon, &|p| high[1] + margin - p[1]))
            .and_then(|polygon| clipped(&polygon, &|p| p[1] - low[1] + margin));
        let mut polygons: Vec<Polygon> = near.into_iter().collect();
        let max_area = MAX_SAMPLED_FRACTION * self.size * self.size;
        while polygons.iter().any(|polygon| area(polygon) > max_area) {
            polygons = polygons.iter().flat_map(halved).flatten().collect();
        }
        let layer = SHELL_FRACTION * self.size;
        let mut weighted = Vec::new();
        for polygon in polygons {
            let middle = centroid(&polygon);
            let toward = |p: &Point, t: f64| [0, 1].map(|k| middle[k] + t * (p[k] - middle[k]));
            let mut points = vec![middle];
            for t in [0.5, 0.9, 0.99] {
                points.extend(polygon.iter().map(|p| toward(p, t)));
            }
            let share = area(&polygon) / points.len() as f64;
            for p in points {
                let (nearest, distance) = self.nearest(p);
                if self.owns(piece, p, nearest) {
                    weighted.push((p, share * ((-distance / layer).exp() + SHELL_FRACTION)));
                }
            }
        }
        weighted
    }

    /// Returns points all over a piece that belong to its owner.
    pub(crate) fn owned_points(&self, piece: &Piece) -> Vec<Point> {
        let mut polygons = vec![piece.vertices.clone()];
        for _ in 0..DENSE_HALVINGS {
            polygons = polygons.iter().flat_map(halved).flatten().collect();
        }
        let is_owned = |p: &Point| self.owns(piece, *p, self.nearest(*p).0);
        polygons.iter().map(centroid).filter(is_owned).collect()
    }

    /// Returns whether a piece has a point with this nearest feature.
    fn owns(&self, piece: &Piece, p: Point, nearest: Option<usize>) -> bool {
        match piece.feature {
            Some(feature) => {
                nearest == Some(feature) && self.depth_at(feature, p) > self.tolerance()
            }
            None => !self.is_inside(p),
        }
    }
}

/// A feature that touches another's cell, and the condition for the other to be no farther.
struct Rival<'t> {
    feature: usize,
    nearer: &'t Formula,
}

impl Rival<'_> {
    /// Returns whether a polygon is on the owner's side of a border that is one straight line.
    fn is_beyond_line(
        &self,
        polygon: &Polygon,
        shapes: &[CurveFunction<'_>],
        tolerance: f64,
    ) -> bool {
        let Formula::Atom { curve, .. } = self.nearer else { return false };
        let mut sides = |curve: CurveIndex| shapes[curve].signs_over(polygon, tolerance);
        shapes[*curve].is_line() && self.nearer.decide_with(&mut sides) == Some(true)
    }

    /// Returns whether the condition holds for all points that a piece owns, since the rival itself is as near to them as its
    /// line or circle. None of them is behind the rival. `None` if that is not known of so large a piece.
    fn competes(&self, section: &Section<'_>, piece: &Piece) -> Option<bool> {
        if matches!(section.features[self.feature], Feature::Corner(_)) {
            return Some(true);
        }
        if !section.all_within(section.sector_sides(self.feature), &piece.vertices) {
            return Some(false);
        }
        let owner = piece.feature.unwrap_or(self.feature);
        section.is_behind_nearer(owner, self.feature, &piece.vertices).then_some(true)
    }
}

/// Divides a polygon by the normals at the ends of rivals, beyond which their conditions say nothing, and by the lines in
/// these conditions, so that each part knows the side of the curve.
fn decided(
    section: &Section<'_>,
    polygon: Polygon,
    rivals: &[Rival<'_>],
    shapes: &[CurveFunction<'_>],
) -> Vec<Polygon> {
    let tolerance = section.tolerance();
    let mut polygons = vec![polygon];
    for rival in rivals {
        let mut divide = |values: &dyn Fn(&Polygon) -> Vec<f64>| {
            let halves = polygons.iter().flat_map(|polygon| {
                if rival.is_beyond_line(polygon, shapes, tolerance) {
                    return [Some(polygon.clone()), None];
                }
                divided(polygon, &values(polygon))
            });
            polygons = halves.flatten().collect();
        };
        for side in section.sector_sides(rival.feature) {
            let at = |p: &Point| Some(side.at(*p)).filter(|x| x.abs() > tolerance).unwrap_or(0.0);
            divide(&|polygon| polygon.iter().map(at).collect());
        }
        let (Formula::All(parts) | Formula::Any(parts)) = rival.nearer else { continue };
        for part in parts {
            if let Formula::Atom { curve, .. } = part
                && shapes[*curve].is_line()
            {
                let values = |polygon: &Polygon| shapes[*curve].linear_values(polygon, tolerance);
                divide(&|polygon| values(polygon).unwrap_or_default());
            }
        }
    }
    polygons
}

impl Piece {
    /// Returns whether this is one point.
    pub(crate) fn is_point(&self) -> bool {
        self.vertices.len() == 1
    }

    /// Returns the sides of a curve on which the owned points may lie.
    pub(crate) fn signs_of(
        &self,
        curve: CurveIndex,
        shape: &CurveFunction<'_>,
        tolerance: f64,
    ) -> Signs {
        let known = self.signs.iter().find(|(known, _)| *known == curve);
        known.map_or_else(|| shape.signs_over(&self.vertices, tolerance), |(_, signs)| *signs)
    }

    /// Returns what may lie below a curve and above it, where the polygon is on both sides.
    pub(crate) fn halves(
        &self,
        curve: CurveIndex,
        shapes: &[CurveFunction<'_>],
        tolerance: f64,
    ) -> [Option<Piece>; 2] {
        let Some(values) = shapes[curve].linear_values(&self.vertices, tolerance) else {
            return [NEGATIVE, POSITIVE].map(|side| {
                let mut half = self.clone();
                half.signs.push((curve, side));
                half.is_possible(shapes, tolerance).then_some(half)
            });
        };
        divided(&self.vertices, &values).map(|half| {
            let half = Piece { vertices: half?, ..self.clone() };
            half.is_possible(shapes, tolerance).then_some(half)
        })
    }

    /// Returns the points of this piece that another owns too; `None` if there are none.
    pub(super) fn common(
        &self,
        other: &Piece,
        shapes: &[CurveFunction<'_>],
        tolerance: f64,
    ) -> Option<Piece> {
        if are_boxes_apart(&self.vertices, &other.vertices, 0.0) {
            return None;
        }
        let mut common = self.clone();
        for side in sides(&other.vertices, tolerance) {
            common.vertices = clipped(&common.vertices, &|p| side.inward(p))?;
        }
        for (curve, signs) in &other.signs {
            match common.signs.iter_mut().find(|(known, _)| known == curve) {
                Some((_, known)) => *known &= signs,
                None => common.signs.push((*curve, *signs)),
            }
        }
        common.alternatives.extend_from_slice(&other.alternatives);
        common.is_possible(shapes, tolerance).then_some(common)
    }

    /// Returns whether the polygon is wider than rounding and may have an owned point.
    fn is_possible(&self, shapes: &[CurveFunction<'_>], tolerance: f64) -> bool {
        width(&self.vertices) > tolerance && self.may_own_a_point(shapes, tolerance)
    }

    /// Returns whether the polygon reaches the known sides of curves, and leaves an alternative of each condition.
    pub(crate) fn may_own_a_point(&self, shapes: &[CurveFunction<'_>], tolerance: f64) -> bool {
        let reaches = |(curve, signs): &(CurveIndex, Signs)| {
            signs & shapes[*curve].signs_over(&self.vertices, tolerance) != 0
        };
        let may_hold = |formula: &Formula| self.decide(formula, shapes, tolerance) != Some(false);
        self.signs.iter().all(reaches) && self.alternatives.iter().all(may_hold)
    }

    /// Returns whether a condition holds for all owned points, or for none.
    fn decide(
        &self,
        formula: &Formula,
        shapes: &[CurveFunction<'_>],
        tolerance: f64,
    ) -> Option<bool> {
        formula.decide_with(&mut |curve| self.signs_of(curve, &shapes[curve], tolerance))
    }

    /// Adds a condition that all owned points satisfy, as far as it is the side of one curve that the polygon crosses.
    /// Returns whether the piece can own a point.
    fn know(&mut self, formula: &Formula, shapes: &[CurveFunction<'_>], tolerance: f64) -> bool {
        if let Some(holds) = self.decide(formula, shapes, tolerance) {
            return holds;
        }
        let (parts, any) = match formula {
            Formula::All(parts) => (&parts[..], false),
            Formula::Any(parts) => (&parts[..], true),
            other => (std::slice::from_ref(other), false),
        };
        let is_undecided = |part: &&Formula| self.decide(part, shapes, tolerance).is_none();
        let undecided: Vec<&Formula> = parts.iter().filter(is_undecided).collect();
        // One of several alternatives holds, and which is not known.
        if any && undecided.len() > 1 {
            self.alternatives.push(formula.clone());
            return true;
        }
        for atom in undecided {
            if let Formula::Atom { curve, below } = atom {
                self.signs.push((*curve, if *below { NEGATIVE } else { POSITIVE }));
            }
        }
        true
    }
}
