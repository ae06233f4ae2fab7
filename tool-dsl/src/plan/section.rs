//! The plan of a tool with a profile. Convex pieces cover what each part owns, and the outside. Splits divide them until one
//! owner is left. Points on a splitting curve go to one side, or to a tree of their own if both sides need them. At last
//! every piece is followed to the leaves that it reaches, which bounds how far depth is from the distance.

use super::samples::{ONE_SIDED_GAIN, Sample, SampleSubset, Samples};
use super::{BITS_PER_ADDITION, MAX_TESTS, Tree, costs};
use crate::diagnostic::{CheckKind, Diagnostic};
use crate::formula::{CurveIndex, NEGATIVE, POSITIVE, Signs};
use crate::geometry::function::CurveFunction;
use crate::geometry::outline::{self, Point, dot, minus, norm};
use crate::geometry::polygon::{Polygon, centroid, width};
use crate::model::{Model, Over, Section};
use crate::regionalise;
use crate::regionalise::overlay::{ConditionedPart, Conditions};
use crate::regionalise::pieces::Piece;
use crate::resolve::partitioned_anew;
use std::cmp::Ordering;
use std::collections::BinaryHeap;
use std::rc::Rc;

/// The number of curves that may be passed over because their zeros belong to both sides.
const MAX_SKIPPED_CURVES: usize = 6;

/// The relative cost of a test that the tree also makes elsewhere: code for lanes computes it once.
const REPEATED_TEST_COST_FACTOR: f64 = 0.3;

/// The distances of points far outside from the outline, in sizes: 8, 8², …, 8¹⁵.
fn far_distances(size: f64) -> impl Iterator<Item = f64> {
    (1..16).map(move |k| size * 8f64.powi(k))
}

/// The offsets of points in strips from the strips' middle line, in sizes.
const STRIP_OFFSETS: [f64; 4] = [-0.01, -1e-5, 1e-5, 0.01];

/// Returns points of the half plane far from the point of the axis at the height `middle`, all around.
fn ring_points(middle: f64, size: f64) -> Vec<Point> {
    let mut points = Vec::new();
    for distance in far_distances(size) {
        for k in 0..=128 {
            let (sin, cos) = ((f64::from(k) / 128.0 - 0.5) * std::f64::consts::PI).sin_cos();
            points.push([distance * cos, middle + distance * sin]);
        }
    }
    points
}

/// Returns points far from the end of a segment, in a thin strip along a unit vector and its opposite.
fn strip_points(end: Point, direction: Point, size: f64) -> Vec<Point> {
    let mut points = Vec::new();
    for distance in far_distances(size).flat_map(|distance| [distance, -distance]) {
        for offset in STRIP_OFFSETS {
            let across = [-direction[1] * offset * size, direction[0] * offset * size];
            points.push([0, 1].map(|k| end[k] + distance * direction[k] + across[k]));
        }
    }
    points
}

/// Returns whether a tree has an owner far outside, where there was no piece. The test uses points all
/// around, and points in thin strips along the lines and normals of the outline.
pub(super) fn has_owner_far_outside(model: &Model, section: &Section, tree: &Tree) -> bool {
    let (shapes, size) = section.inner.functions(&model.graph, &model.curves, &section.separations);
    let [low, high] = outline::bounding_box(&section.outline).map(|end| end[1]);
    let mut points = ring_points(low / 2.0 + high / 2.0, size);
    for segment in &section.outline {
        let [from, to] = segment.ends();
        let along = minus(to, from).map(|part| part / norm(minus(to, from)));
        for end in [from, to] {
            points.extend(strip_points(end, along, size));
            points.extend(strip_points(end, [-along[1], along[0]], size));
        }
    }
    let mut in_half_plane = points.into_iter().filter(|p| p[0] >= 0.0);
    in_half_plane.any(|p| tree.owner_at(&|curve| shapes[curve].value(p)).is_some())
}

/// The difference of distances, in sizes, that a tree need not decide: rounding.
const INDIFFERENCE: f64 = 1e-13;
/// The greatest deviation of depth from the distance, in sizes. It is part of the stated error.
const MAX_DEVIATION_FRACTION: f64 = 1e-8;

/// Returns the tree of owners, and the greatest difference of its depths from the distance.
pub(super) fn tree(model: &Model, section: &Section) -> Result<(Tree, f64), Diagnostic> {
    let (shapes, size) = section.inner.functions(&model.graph, &model.curves, &section.separations);
    let mut planner = Planner::new(model, section, &shapes, size);
    let (pieces, samples) = planner.pieces();
    planner.samples = Samples::new(&samples, &shapes);
    let candidates = (0..model.curves.len()).map(Candidate::new).collect();
    let tree = planner.tree(&pieces, &planner.samples.all(), candidates)?;
    match planner.deviation(&tree, &pieces) {
        (deviation, _) if deviation <= MAX_DEVIATION_FRACTION * size => Ok((tree, deviation)),
        (_, at) => Err(inseparable_owners(model, at)),
    }
}

/// Returns the greatest difference of a tree's depths from the distance, from the partition of the outline alone: nothing that
/// the model's other passes found is relied on. `None` without a profile, or if the difference is more than a plan may have.
pub(crate) fn proved_deviation(model: &Model, tree: &Tree) -> Option<f64> {
    let model = partitioned_anew(model)?;
    let section = model.section.as_ref()?;
    let (shapes, size) = section.inner.functions(&model.graph, &model.curves, &section.separations);
    let planner = Planner::new(&model, section, &shapes, size);
    let (pieces, _) = planner.pieces();
    Some(planner.deviation(tree, &pieces).0)
        .filter(|deviation| *deviation <= MAX_DEVIATION_FRACTION * size)
}

impl Over {
    /// Returns the region of a part in which the given condition is the first to hold.
    fn region(&self, part: usize, condition: usize) -> Option<usize> {
        self.regions.iter().position(|region| *region == ConditionedPart { part, condition })
    }
}

struct Planner<'m> {
    model: &'m Model,
    section: &'m Section,
    geometry: regionalise::Section<'m>,
    shapes: &'m [CurveFunction<'m>],
    costs: Vec<f64>,
    samples: Samples,
    used: Vec<bool>,
    size: f64,
    /// The distance from a curve within which a point may be on either side of it.
    tolerance: f64,
    /// The difference of distances that need not be decided.
    indifference: f64,
    tests: usize,
}

impl<'m> Planner<'m> {
    fn new(
        model: &'m Model,
        section: &'m Section,
        shapes: &'m [CurveFunction<'m>],
        size: f64,
    ) -> Planner<'m> {
        Planner {
            model,
            section,
            geometry: section.inner.section(),
            shapes,
            costs: costs(model),
            samples: Samples::new(&[], shapes),
            used: vec![false; model.curves.len()],
            size,
            tolerance: 16.0 * f64::EPSILON * size,
            indifference: INDIFFERENCE * size,
            tests: 0,
        }
    }

    /// Returns the pieces of the regions and the outside, and sample points of their owners.
    fn pieces(&self) -> (Vec<Rc<Piece>>, Vec<Sample>) {
        let Planner { section, geometry, shapes, .. } = self;
        let (mut pieces, mut samples) = (Vec::new(), Vec::new());
        for piece in section.inner.inner_pieces(&section.separations, shapes) {
            let points = geometry.sample_points(&piece);
            let Some(over) = &section.over else {
                samples.extend(points.into_iter().map(|point| Sample::new(point, piece.owner)));
                pieces.push(Rc::new(piece));
                continue;
            };
            let conditions = Conditions { formulas: &over.conditions, shapes, size: self.size };
            let region = |condition| over.region(piece.owner?, condition);
            samples.extend(points.into_iter().filter_map(|point| {
                let region = region(conditions.first_at(point.0)?)?;
                Some(Sample::new(point, Some(region)))
            }));
            for (divided, first) in conditions.divided(piece.clone(), geometry.tolerance()) {
                // A piece that no region claims, as far as samples show, has the depth of its part all the same.
                let fallback = || over.regions.iter().position(|r| Some(r.part) == piece.owner);
                let owner = first.and_then(region).or_else(fallback);
                pieces.push(Rc::new(Piece { owner, ..divided }));
            }
        }
        for piece in section.inner.outer_pieces(&section.separations) {
            let points = geometry.sample_points(&piece);
            samples.extend(points.into_iter().map(|point| Sample::new(point, None)));
            pieces.push(Rc::new(piece));
        }
        (pieces, samples)
    }
}

/// A curve that may separate the pieces that are left.
#[derive(Clone, Copy)]
struct Candidate {
    curve: CurveIndex,
    /// True if all samples are known to be on one side of it, as are then all samples of a part.
    is_one_sided: bool,
}

/// A candidate with its rank: greatest is the first in the list of `bsp`, then the one of greatest gain, then the first.
struct Ranked {
    listed: usize,
    gain: f64,
    curve: CurveIndex,
    /// True if all samples are known to be on one side of it.
    is_one_sided: bool,
}

impl Ord for Ranked {
    fn cmp(&self, other: &Ranked) -> Ordering {
        let listed = other.listed.cmp(&self.listed);
        listed.then(self.gain.total_cmp(&other.gain)).then(other.curve.cmp(&self.curve))
    }
}

impl PartialOrd for Ranked {
    fn partial_cmp(&self, other: &Ranked) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Ranked {
    fn eq(&self, other: &Ranked) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Ranked {}

impl Candidate {
    fn new(curve: CurveIndex) -> Candidate {
        Candidate { curve, is_one_sided: false }
    }
}

/// The pieces on the two sides of a curve.
struct Halves {
    below: Vec<Rc<Piece>>,
    above: Vec<Rc<Piece>>,
}

/// A curve to split by, its division of the pieces, and the side to which its own points go.
struct Choice {
    curve: CurveIndex,
    halves: Halves,
    zeros: Zeros,
}

impl Planner<'_> {
    /// Returns a tree of few tests.
    fn tree(
        &mut self,
        pieces: &[Rc<Piece>],
        samples: &SampleSubset,
        mut candidates: Vec<Candidate>,
    ) -> Result<Tree, Diagnostic> {
        // Narrow pieces are separated only where their owner matters.
        let is_wide = |piece: &&Rc<Piece>| width(&piece.vertices) > self.indifference;
        let mut relevant: Vec<Rc<Piece>> = pieces.iter().filter(is_wide).map(Rc::clone).collect();
        if owner_count(&relevant) <= 1 {
            let owner = match relevant.first() {
                Some(piece) => piece.owner,
                None => self.least_wrong_owner(pieces),
            };
            if pieces.iter().all(|piece| self.loss(piece, owner) <= self.indifference) {
                return Ok(Tree::Leaf(owner));
            }
            relevant = pieces.to_vec();
        }
        // What divides no wide piece may divide a narrow one.
        let choice = if relevant.len() < pieces.len() {
            self.choose(&relevant, samples, &mut candidates.clone())
        } else {
            self.choose(&relevant, samples, &mut candidates)
        };
        let Some(choice) = choice else {
            // Pieces that no curve separates are equally near, or are found by the deviation of the finished tree.
            return Ok(Tree::Leaf(self.least_wrong_owner(pieces)));
        };
        let Choice { curve, halves, zeros } = choice;
        self.used[curve] = true;
        self.tests += 1;
        if self.tests > MAX_TESTS {
            return Err(super::too_large(self.model));
        }
        candidates.retain(|other| other.curve != curve);
        let [low, high] = self.samples.divided(samples, curve);
        let halves =
            if relevant.len() < pieces.len() { self.halves(curve, pieces) } else { halves };
        let below = self.tree(&halves.below, &low, candidates.clone())?;
        let above = self.tree(&halves.above, &high, candidates)?;
        Ok(match zeros {
            // The points on the curve belong to the solid on either side.
            Zeros::Both => {
                let on_curve = first_of(&below, &above);
                if on_curve == above {
                    Tree::split(curve, true, below, above)
                } else if on_curve == below {
                    Tree::split(curve, false, below, above)
                } else {
                    let below = Tree::split(curve, true, below, on_curve);
                    Tree::split(curve, false, below, above)
                }
            }
            _ => Tree::split(curve, zeros == Zeros::Above, below, above),
        })
    }

    /// Returns the curve that gives most information about the owners relative to its cost, and its division
    /// of the pieces.
    fn choose(
        &mut self,
        pieces: &[Rc<Piece>],
        samples: &SampleSubset,
        candidates: &mut Vec<Candidate>,
    ) -> Option<Choice> {
        let uncertain = self.samples.entropy(samples);
        let mut ranked = Vec::with_capacity(candidates.len());
        for Candidate { curve, is_one_sided } in &mut *candidates {
            let cost_factor = if self.used[*curve] { REPEATED_TEST_COST_FACTOR } else { 1.0 };
            let gain =
                if *is_one_sided { None } else { self.samples.gain(samples, uncertain, *curve) };
            *is_one_sided = gain.is_none();
            let cost = BITS_PER_ADDITION * cost_factor * self.costs[*curve];
            let gain = gain.unwrap_or(ONE_SIDED_GAIN) - cost;
            let (listed, is_one_sided) = (self.listed_rank(*curve), *is_one_sided);
            ranked.push(Ranked { listed, gain, curve: *curve, is_one_sided });
        }
        let mut divides_nothing = vec![false; self.shapes.len()];
        let choice = self.first_separating(pieces, ranked.into(), &mut divides_nothing);
        // What divides nothing here divides nothing below.
        candidates.retain(|candidate| !divides_nothing[candidate.curve]);
        choice
    }

    /// Returns the best curve that separates owners, and marks those before it that divide no piece.
    fn first_separating(
        &mut self,
        pieces: &[Rc<Piece>],
        mut ranked: BinaryHeap<Ranked>,
        divides_nothing: &mut [bool],
    ) -> Option<Choice> {
        let count = owner_count(pieces);
        let (mut fallback, mut with_double_zeros, mut skipped_count) = (None, None, 0);
        let mut best_one_sided: Option<([usize; 3], Choice)> = None;
        // One of the first few is mostly chosen, so they are not sorted.
        while let Some(Ranked { curve, listed, is_one_sided, .. }) = ranked.pop() {
            let is_by_pieces = is_one_sided && listed == usize::MAX;
            if !is_by_pieces && best_one_sided.is_some() {
                break;
            }
            let halves = self.halves(curve, pieces);
            if halves.below.is_empty() || halves.above.is_empty() {
                divides_nothing[curve] = true;
                continue;
            }
            // A curve that cuts through cells without separating owners is kept as a last resort.
            let [below, above] = [&halves.below, &halves.above].map(|half| owner_count(half));
            if below.min(above) == count {
                fallback.get_or_insert((curve, halves));
                continue;
            }
            // A curve whose points belong to both sides needs a tree of its own for them.
            let zeros = self.zeros(curve, &halves);
            if zeros != Zeros::Both {
                let remaining =
                    [below.max(above), below + above, halves.below.len() + halves.above.len()];
                let choice = Choice { curve, halves, zeros };
                // Samples tell nothing about a curve that has all of them on one side, but pieces do.
                if !is_by_pieces || remaining[0] == 1 {
                    return Some(choice);
                }
                if best_one_sided.as_ref().is_none_or(|(least, _)| remaining < *least) {
                    best_one_sided = Some((remaining, choice));
                }
                continue;
            }
            with_double_zeros.get_or_insert(Choice { curve, halves, zeros });
            skipped_count += 1;
            if skipped_count > MAX_SKIPPED_CURVES {
                break;
            }
        }
        best_one_sided.map(|(_, choice)| choice).or(with_double_zeros).or_else(|| {
            let (curve, halves) = fallback?;
            let zeros = self.zeros(curve, &halves);
            Some(Choice { curve, halves, zeros })
        })
    }

    /// Returns the position of a curve in the list of `bsp`. Curves that are not listed come last.
    fn listed_rank(&self, curve: CurveIndex) -> usize {
        let listed = self.model.first_curves.iter().position(|first| *first == curve);
        listed.unwrap_or(usize::MAX)
    }

    /// Returns the owner, of those of some pieces, by which depth is least wrong in the others.
    fn least_wrong_owner(&self, pieces: &[Rc<Piece>]) -> Option<usize> {
        let mut owners: Vec<_> = pieces.iter().map(|piece| piece.owner).collect();
        owners.sort_unstable();
        owners.dedup();
        let loss = |owner: &Option<usize>| {
            pieces.iter().map(|piece| self.loss(piece, *owner)).fold(0.0, f64::max)
        };
        let least = owners.into_iter().min_by(|a, b| loss(a).total_cmp(&loss(b)));
        least.flatten()
    }

    /// Returns an upper bound of the difference of the depth that a tree gives from the distance, and a point near which it is
    /// about that. Every point is in a piece of the nearest feature, so it is enough to ask at the leaves which pieces have
    /// another.
    fn deviation(&self, tree: &Tree, pieces: &[Rc<Piece>]) -> (f64, Point) {
        match tree {
            Tree::Split { curve, below, above, .. } => {
                let halves = self.halves(*curve, pieces);
                let sides =
                    [self.deviation(below, &halves.below), self.deviation(above, &halves.above)];
                let [low, high] = sides;
                if low.0 > high.0 { low } else { high }
            }
            Tree::Leaf(owner) => {
                let feature = owner.map(|region| self.feature_of(region));
                let losses = pieces.iter().map(|piece| {
                    let may_own = |part: &Polygon| {
                        let part = Piece { vertices: part.clone(), ..(**piece).clone() };
                        part.may_own_a_point(self.shapes, self.tolerance)
                    };
                    let owners = [piece.feature, feature];
                    let allowed = MAX_DEVIATION_FRACTION * self.size;
                    let loss =
                        self.geometry.greatest_loss(owners, &piece.vertices, allowed, may_own);
                    (loss, centroid(&piece.vertices))
                });
                losses.fold((0.0, [0.0; 2]), |a, b| if a.0 >= b.0 { a } else { b })
            }
        }
    }

    /// Returns the feature from which a region has its depth.
    fn feature_of(&self, region: usize) -> usize {
        self.section.over.as_ref().map_or(region, |over| over.regions[region].part)
    }

    /// Returns the greatest error at the vertices of a piece if its points are given to an owner.
    fn loss(&self, piece: &Piece, owner: Option<usize>) -> f64 {
        let feature = owner.map(|region| self.feature_of(region));
        self.geometry.loss_at_vertices(piece.feature, feature, &piece.vertices)
    }

    fn halves(&self, curve: CurveIndex, pieces: &[Rc<Piece>]) -> Halves {
        let mut halves = Halves { below: Vec::new(), above: Vec::new() };
        for piece in pieces {
            match piece.signs_of(curve, &self.shapes[curve], self.tolerance) {
                NEGATIVE => halves.below.push(Rc::clone(piece)),
                POSITIVE => halves.above.push(Rc::clone(piece)),
                _ => {
                    let [below, above] = piece.halves(curve, self.shapes, self.tolerance);
                    halves.below.extend(below.map(Rc::new));
                    halves.above.extend(above.map(Rc::new));
                }
            }
        }
        halves
    }
}

/// Returns the number of different owners of some pieces.
fn owner_count(pieces: &[Rc<Piece>]) -> usize {
    let mut owners: Vec<_> = pieces.iter().map(|piece| piece.owner).collect();
    owners.sort_unstable();
    owners.dedup();
    owners.len()
}

fn inseparable_owners(model: &Model, [d, z]: Point) -> Diagnostic {
    let outline = model.section.iter().flat_map(|section| &section.outline);
    let outline: Vec<_> = outline.cloned().collect();
    let span = outline::nearest_span(&outline, [d, z]).unwrap_or(model.name_span);
    let z = model.frame.to_file(z);
    Diagnostic::new(span, CheckKind::Inseparable { d, z })
}

/// The side to which a curve's own points go.
#[derive(Clone, Copy, PartialEq)]
enum Zeros {
    Below,
    Above,
    Both,
}

impl Planner<'_> {
    /// Returns the side to which the points on a curve go: the side of the solid, so that it includes its
    /// surface. Where the solid is on both sides, it is the side of the owner listed first.
    fn zeros(&self, curve: CurveIndex, halves: &Halves) -> Zeros {
        let [below, above] =
            [&halves.below, &halves.above].map(|pieces| self.touching(curve, pieces));
        let (mut is_required, mut is_preferred) = ([false; 2], [false; 2]);
        for (side, (own, others)) in [(&below, &above), (&above, &below)].into_iter().enumerate() {
            for touching in own {
                for p in touching.ends {
                    let other = others.iter().filter(|other| other.contains(p, self.coincidence()));
                    match other.map(|other| other.owner).min() {
                        None => is_required[side] = true,
                        Some(other) if touching.owner < other => is_preferred[side] = true,
                        Some(_) => {}
                    }
                }
            }
        }
        // The outside knows on which side of an arc it is.
        if !self.shapes[curve].is_line() {
            let is_outside = |piece: &&Rc<Piece>, signs: Signs| {
                piece.owner.is_none() && piece.signs.contains(&(curve, signs))
            };
            let knows =
                |pieces: &[Rc<Piece>], signs| pieces.iter().any(|piece| is_outside(&piece, signs));
            is_required = [knows(&halves.above, POSITIVE), knows(&halves.below, NEGATIVE)];
        }
        match (is_required, is_preferred) {
            ([true, true], _) => Zeros::Both,
            ([false, true], _) | ([false, false], [false, true]) => Zeros::Above,
            _ => Zeros::Below,
        }
    }

    /// Returns the distance within which points of a border coincide.
    fn coincidence(&self) -> f64 {
        256.0 * f64::EPSILON * self.size
    }

    /// Returns where pieces of the solid reach a line.
    fn touching(&self, curve: CurveIndex, pieces: &[Rc<Piece>]) -> Vec<Touching> {
        let shape = &self.shapes[curve];
        let mut all = Vec::new();
        for piece in pieces {
            let Some(owner) = piece.owner else { continue };
            let near = self.coincidence() / 4.0;
            let Some(values) = shape.linear_values(&piece.vertices, near) else { continue };
            let on_line = values.iter().zip(&piece.vertices).filter(|(value, _)| **value == 0.0);
            let mut ends: Option<[Point; 2]> = None;
            for (_, p) in on_line {
                let [from, to] = ends.unwrap_or([*p; 2]);
                ends = Some(
                    match (norm(minus(*p, from)), norm(minus(*p, to)), norm(minus(from, to))) {
                        (a, b, c) if a >= b && a >= c => [from, *p],
                        (_, b, c) if b >= c => [to, *p],
                        _ => [from, to],
                    },
                );
            }
            all.extend(ends.map(|ends| Touching { ends, owner }));
        }
        all
    }
}

/// The part of a line that a piece reaches, by its ends.
struct Touching {
    ends: [Point; 2],
    owner: usize,
}

impl Touching {
    /// Returns whether a point of the line is between the ends.
    fn contains(&self, p: Point, tolerance: f64) -> bool {
        let [from, to] = self.ends;
        let along = minus(to, from);
        let (length, offset) = (norm(along), minus(p, from));
        if length <= tolerance {
            return norm(offset) <= 2.0 * tolerance;
        }
        let position = dot(along, offset) / length;
        position >= -tolerance && position <= length + tolerance
    }
}

/// Returns an owner's index in the list of regions, or `usize::MAX` for the outside.
fn rank(owner: Option<usize>) -> usize {
    owner.unwrap_or(usize::MAX)
}

/// Returns a tree whose leaves are the first listed of the owners in two trees.
fn first_of(a: &Tree, b: &Tree) -> Tree {
    match (a, b) {
        (Tree::Leaf(own), Tree::Leaf(other)) => {
            Tree::Leaf(if rank(*other) < rank(*own) { *other } else { *own })
        }
        (Tree::Leaf(_), Tree::Split { curve, strict, below, above }) => {
            Tree::split(*curve, *strict, first_of(a, below), first_of(a, above))
        }
        (Tree::Split { curve, strict, below, above }, _) => {
            let [low, high] = [true, false].map(|holds| b.simplified(*curve, *strict, holds));
            Tree::split(*curve, *strict, first_of(below, &low), first_of(above, &high))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_best_candidates_are_taken_in_the_order_of_a_stable_sort() {
        let candidate = |curve: usize| Ranked {
            listed: if curve.is_multiple_of(5) { curve % 3 } else { usize::MAX },
            gain: (curve * 7 % 11) as f64 - 4.0,
            curve,
            is_one_sided: false,
        };
        let mut sorted: Vec<Ranked> = (0..60).map(candidate).collect();
        sorted.sort_by(|a, b| a.listed.cmp(&b.listed).then(b.gain.total_cmp(&a.gain)));
        let mut ranked: BinaryHeap<Ranked> = (0..60).map(candidate).collect();
        for expected in sorted {
            assert_eq!(ranked.pop().expect("a candidate").curve, expected.curve);
        }
    }

    /// Every direction of the half plane has a point at eight sizes.
    #[test]
    fn points_far_away_are_all_around() {
        let points = ring_points(2.0, 3.0);
        for degrees in -90..=90 {
            let (sine, cosine) = f64::from(degrees).to_radians().sin_cos();
            let is_near = |[d, z]: &Point| {
                let length = d.hypot(z - 2.0);
                let turned = (d * cosine + (z - 2.0) * sine) / length;
                // Neighbours are 1.41 degrees apart.
                (length - 24.0).abs() < 1e-9 && turned > 0.0125f64.cos()
            };
            assert!(points.iter().any(is_near), "{degrees}");
        }
    }
}
