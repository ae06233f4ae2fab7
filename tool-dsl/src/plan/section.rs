//! The plan of a tool with a profile. Its partition is known as polygons, and splits cut them until one owner
//! is left. Points on a splitting curve go to one side, or to a tree of their own if both sides need them. Leaves
//! return points that rounding may bring astray near a corner to one of its owners.

use super::samples::{ONE_SIDED_GAIN, Sample, SampleSubset, Samples};
use super::{BITS_PER_ADDITION, MAX_TESTS, Tree, costs};
use crate::diagnostic::{CheckKind, Diagnostic, Kind};
use crate::formula::CurveIndex;
use crate::geometry::cut::{
    COINCIDENCE_FRACTION, CurveFunction, Cut, Cutter, Edge, Piece, Position, is_along,
};
use crate::geometry::outline::{self, Point, minus, norm};
use crate::model::{Model, Over, Section};
use crate::regionalise::cells;
use crate::regionalise::overlay::{self, ConditionedPart};
use std::cell::Cell;
use std::cmp::Ordering;
use std::collections::BinaryHeap;
use std::rc::Rc;

/// The number of chords per curved edge: at first, and on retries after coarser polygons gave a wrong tree.
const CHORDS_PER_EDGE: [u32; 3] = [8, 40, 200];

/// The number of curves that may be passed over because their zeros belong to both sides.
const MAX_SKIPPED_CURVES: usize = 6;

/// The relative cost of a test that the tree also makes elsewhere: code for lanes computes it once.
const REPEATED_TEST_COST_FACTOR: f64 = 0.3;

/// Returns the tree of owners.
pub(super) fn tree(model: &Model, section: &Section) -> Result<Tree, Diagnostic> {
    let [few, more @ ..] = CHORDS_PER_EDGE;
    let mut result = tree_with_chords(model, section, few);
    // More chords cost time in every cut, and few tools need them. They separate features, but with no fewer tests.
    for chords in more {
        let is_inseparable = |failed: &Diagnostic| {
            matches!(failed.kind, Kind::CheckKind(CheckKind::Inseparable { .. }))
        };
        if !result.as_ref().is_err_and(is_inseparable) {
            break;
        }
        result = tree_with_chords(model, section, chords);
    }
    result
}

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
    let (shapes, size) = overlay::shapes(&model.graph, &model.curves, &section.outline);
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

/// Returns the tree of a section whose curved edges are chords, `chords` per edge.
fn tree_with_chords(model: &Model, section: &Section, chords: u32) -> Result<Tree, Diagnostic> {
    let (shapes, size) = overlay::shapes(&model.graph, &model.curves, &section.outline);
    let piece = |cell: &cells::Cell, owner| overlay::piece(cell, owner, &shapes, size);
    let mut input = PlanInput::default();
    for cell in section.inner.cells(chords) {
        let Some(over) = &section.over else {
            input.add_whole(&cell, piece(&cell, Some(cell.part)));
            continue;
        };
        let whole = piece(&cell, None);
        for (piece, holding) in overlay::divided(whole, &over.conditions, &shapes, size) {
            let first = holding.first().copied();
            let region = first.and_then(|condition| over.region(cell.part, condition));
            // Only slivers beside a curved edge can be without a region.
            if region.is_some() {
                input.add_piece(Piece { owner: region, ..piece });
            }
        }
        input.add_points(&cell, |p| over.owner_at(cell.part, p, &shapes, size));
    }
    for cell in section.outer.cells(chords) {
        input.add_whole(&cell, piece(&cell, None));
    }
    let tree = plan(model, &shapes, size, input)?;
    // A sliver between a curve and its chord may have been given to the wrong owner.
    let wrong = section.inner.wrongly_assigned_point(|p| {
        let region = tree.owner_at(&|curve| shapes[curve].value(p))?;
        Some(section.over.as_ref().map_or(region, |over| over.regions[region].part))
    });
    match wrong {
        Some(p) => Err(inseparable_owners(model, p)),
        None => Ok(tree),
    }
}

/// The owner of a point.
enum OwnerAt {
    /// A region, or `None` outside the solid.
    Known(Option<usize>),
    /// The point is on a border within tolerance, or in no region of its part.
    Undecided,
}

/// The input of a plan: pieces to separate, weighted sample points, and points to check the tree with.
#[derive(Default)]
struct PlanInput {
    pieces: Vec<Rc<Piece>>,
    samples: Vec<Sample>,
    witnesses: Vec<(Point, Option<usize>)>,
    corners: Vec<Point>,
}

impl PlanInput {
    /// Adds a cell with one owner, that of its piece.
    fn add_whole(&mut self, cell: &cells::Cell, piece: Piece) {
        let owner = piece.owner;
        self.add_piece(piece);
        self.add_points(cell, |_| OwnerAt::Known(owner));
    }

    fn add_piece(&mut self, piece: Piece) {
        let origin = self.pieces.len();
        self.pieces.push(Rc::new(Piece { origin, ..piece }));
    }

    /// Adds a cell's corners, and its points where their owner is known.
    fn add_points(&mut self, cell: &cells::Cell, owner_at: impl Fn(Point) -> OwnerAt) {
        self.corners.extend(&cell.corners);
        for &(point, weight) in &cell.samples {
            if let OwnerAt::Known(owner) = owner_at(point) {
                self.samples.push(Sample { point, weight, owner });
            }
        }
        for &point in &cell.witnesses {
            if let OwnerAt::Known(owner) = owner_at(point) {
                self.witnesses.push((point, owner));
            }
        }
    }
}

impl Over {
    /// Returns the region of a part in which the given condition is the first to hold.
    fn region(&self, part: usize, condition: usize) -> Option<usize> {
        self.regions.iter().position(|region| *region == ConditionedPart { part, condition })
    }

    /// Returns the region of a point in a part, unless the point is on a border within tolerance.
    fn owner_at(&self, part: usize, p: Point, shapes: &[CurveFunction<'_>], size: f64) -> OwnerAt {
        let on_border = Cell::new(false);
        let first_condition = |sign_on_border: f64| {
            self.conditions.iter().position(|condition| {
                condition.holds(&mut |curve: CurveIndex| match shapes[curve].side(p, size) {
                    0 => {
                        on_border.set(true);
                        sign_on_border
                    }
                    _ => shapes[curve].value(p),
                })
            })
        };
        let low = first_condition(-1.0);
        // Away from every curve that was evaluated, the sign does not matter.
        let high = if on_border.get() { first_condition(1.0) } else { low };
        // Whatever the sign on the border, the same condition is first, or the point is undecided.
        let decided = low.filter(|_| low == high);
        match decided.and_then(|condition| self.region(part, condition)) {
            Some(region) => OwnerAt::Known(Some(region)),
            None => OwnerAt::Undecided,
        }
    }
}

/// Plans the splits that separate the pieces of a ground.
///
/// Curved edges are chords here, so a cut may leave a sliver that belongs to no owner. The regions' conditions identify
/// such slivers.
fn plan<'m>(
    model: &'m Model,
    shapes: &'m [CurveFunction<'m>],
    size: f64,
    input: PlanInput,
) -> Result<Tree, Diagnostic> {
    let samples = Samples::new(&input.samples, shapes);
    let all = samples.all();
    let whole_pieces: Vec<WholePiece> = input.pieces.iter().map(WholePiece::new).collect();
    let corners = corners(input.corners, &whole_pieces, shapes, size);
    let all_corners: Vec<usize> = (0..corners.len()).collect();
    let mut planner = Planner {
        model,
        shapes,
        costs: costs(model),
        samples,
        corners,
        used: vec![false; model.curves.len()],
        whole_pieces,
        sides: vec![Vec::new(); model.curves.len()],
        size,
        tests: 0,
    };
    let candidates = (0..model.curves.len()).map(Candidate::new).collect();
    let tree = planner.tree(&input.pieces, &all, &all_corners, candidates)?;
    for (p, owner) in input.witnesses {
        if tree.owner_at(&|curve| shapes[curve].value(p)) != owner {
            return Err(inseparable_owners(model, p));
        }
    }
    Ok(tree)
}

struct Planner<'m> {
    model: &'m Model,
    shapes: &'m [CurveFunction<'m>],
    costs: Vec<f64>,
    samples: Samples,
    corners: Vec<Corner>,
    used: Vec<bool>,
    whole_pieces: Vec<WholePiece>,
    /// For each curve that was tried, the side of each whole piece.
    sides: Vec<Vec<Option<Side>>>,
    size: f64,
    tests: usize,
}

/// The side of a whole piece, and therefore of everything cut from it.
#[derive(Clone, Copy)]
enum Side {
    Below,
    Above,
    Torn,
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
    fn tree(
        &mut self,
        pieces: &[Rc<Piece>],
        samples: &SampleSubset,
        corners: &[usize],
        mut candidates: Vec<Candidate>,
    ) -> Result<Tree, Diagnostic> {
        let first = pieces.first().and_then(|piece| piece.owner);
        if pieces.iter().all(|piece| piece.owner == first) {
            return Ok(self.leaf(first, pieces, corners));
        }
        let Some(choice) = self.choose(pieces, samples, &mut candidates) else {
            // No curve separates these pieces: they differ by slivers along chords.
            return Ok(self.leaf(self.largest_owner(pieces), pieces, corners));
        };
        let Choice { curve, halves, zeros } = choice;
        self.used[curve] = true;
        self.tests += 1;
        if self.tests > MAX_TESTS {
            return Err(super::too_large(self.model));
        }
        candidates.retain(|other| other.curve != curve);
        let [low, high] = self.samples.divided(samples, curve);
        let on_curve = match zeros {
            Zeros::Both => Some(self.zero_set_tree(curve, &halves, corners, &candidates)?),
            _ => None,
        };
        let [corners_below, corners_above] =
            [-1, 1].map(|side| self.corners_on(side, curve, corners));
        let below = self.tree(&halves.below, &low, &corners_below, candidates.clone())?;
        let above = self.tree(&halves.above, &high, &corners_above, candidates)?;
        Ok(match on_curve {
            // A test with `<` sends the zeros above; otherwise a second test singles them out.
            Some(on_curve) if on_curve == above => Tree::split(curve, true, below, above),
            Some(on_curve) if on_curve != below => {
                let below = Tree::split(curve, true, below, on_curve);
                Tree::split(curve, false, below, above)
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
            ranked.push(Ranked { listed: self.listed_rank(*curve), gain, curve: *curve });
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
        // One of the first few is mostly chosen, so they are not sorted.
        while let Some(Ranked { curve, .. }) = ranked.pop() {
            let halves = self.halves(curve, pieces);
            if halves.below.is_empty() || halves.above.is_empty() {
                divides_nothing[curve] = true;
                continue;
            }
            // A curve that cuts through cells without separating owners is kept as a last resort.
            if owner_count(&halves.below) == count && owner_count(&halves.above) == count {
                fallback.get_or_insert((curve, halves));
                continue;
            }
            // A curve whose points belong to both sides needs a tree of its own for them.
            let zeros = self.zeros(curve, &halves);
            if zeros != Zeros::Both {
                return Some(Choice { curve, halves, zeros });
            }
            with_double_zeros.get_or_insert(Choice { curve, halves, zeros });
            skipped_count += 1;
            if skipped_count > MAX_SKIPPED_CURVES {
                break;
            }
        }
        with_double_zeros.or_else(|| {
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

    /// Returns the owner of pieces that no curve separates. All but one owner's pieces are slivers between a
    /// curve and its chord.
    fn largest_owner(&self, pieces: &[Rc<Piece>]) -> Option<usize> {
        let true_pieces: Vec<&Rc<Piece>> = pieces.iter().filter(|piece| self.owns(piece)).collect();
        // If no centre tells, all pieces are slivers.
        let candidates = if true_pieces.is_empty() { pieces.iter().collect() } else { true_pieces };
        let largest = candidates.into_iter().max_by(|a, b| a.area().total_cmp(&b.area()));
        largest.and_then(|piece| piece.owner)
    }

    /// Returns whether the centre of a piece satisfies its owner's condition.
    fn owns(&self, piece: &Piece) -> bool {
        let middle = piece.middle();
        let mut value = |curve: CurveIndex| self.shapes[curve].value(middle);
        let regions = &self.model.regions;
        match piece.owner {
            Some(owner) => regions[owner].inside.holds(&mut value),
            None => !regions.iter().any(|region| region.inside.holds(&mut value)),
        }
    }

    fn halves(&mut self, curve: CurveIndex, pieces: &[Rc<Piece>]) -> Halves {
        let cutter = Cutter { shapes: self.shapes, curve, size: self.size };
        let whole_pieces = &self.whole_pieces;
        let sides = &mut self.sides[curve];
        sides.resize(whole_pieces.len(), None);
        let mut halves = Halves { below: Vec::new(), above: Vec::new() };
        for piece in pieces {
            let origin = piece.origin;
            // A piece cut from another lies on the same side, so the side is found once.
            let side = sides[origin].get_or_insert_with(|| whole_pieces[origin].side(cutter));
            let cut = match *side {
                Side::Below => Cut::Below,
                Side::Above => Cut::Above,
                Side::Torn => piece.cut(cutter),
            };
            match cut {
                Cut::Below => halves.below.push(Rc::clone(piece)),
                Cut::Above => halves.above.push(Rc::clone(piece)),
                Cut::Nothing => {}
                Cut::Both(below, above) => {
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

/// A point where pieces meet, with the owners of these pieces.
struct Corner {
    at: Point,
    owners: Vec<Option<usize>>,
}

/// A piece before any cut, with the centre and half the sides of a box that contains it.
struct WholePiece {
    piece: Rc<Piece>,
    middle: Point,
    half: Point,
}

impl WholePiece {
    fn new(piece: &Rc<Piece>) -> WholePiece {
        let [middle, half] = piece.bounding_box();
        WholePiece { piece: Rc::clone(piece), middle, half }
    }

    fn side(&self, cutter: Cutter<'_, '_>) -> Side {
        // A bound over the box decides most pieces without a cut.
        match cutter.shapes[cutter.curve].side_of_box(self.middle, self.half) {
            -1 => return Side::Below,
            1 => return Side::Above,
            _ => {}
        }
        match self.piece.position_to(cutter) {
            Position::Below => Side::Below,
            Position::Above => Side::Above,
            // No side holds for everything that is cut from it.
            Position::Degenerate | Position::Across => Side::Torn,
        }
    }
}

/// Returns the points where whole pieces meet.
fn corners(
    mut points: Vec<Point>,
    whole: &[WholePiece],
    shapes: &[CurveFunction<'_>],
    size: f64,
) -> Vec<Corner> {
    let tolerance = COINCIDENCE_FRACTION * size;
    // Every cell gives the corners that it shares, and these differ by rounding.
    points.sort_by(|p, q| p[0].total_cmp(&q[0]).then(p[1].total_cmp(&q[1])));
    points.dedup_by(|p, q| are_near(*p, *q, tolerance));
    let mut corners = Vec::new();
    for at in points {
        let mut owners = Vec::new();
        for WholePiece { piece, middle, half } in whole {
            let [u, v] = minus(at, *middle);
            // The box rules out most pieces before their vertices and edges are compared.
            if u.abs() <= half[0] + tolerance
                && v.abs() <= half[1] + tolerance
                && !owners.contains(&piece.owner)
                && (piece.vertices.iter().any(|p| are_near(*p, at, tolerance))
                    || piece.has_on_edge(at, shapes, size))
            {
                owners.push(piece.owner);
            }
        }
        corners.push(Corner { at, owners });
    }
    corners
}

/// Returns whether two points differ by less than a tolerance in each coordinate.
fn are_near(p: Point, q: Point, tolerance: f64) -> bool {
    (p[0] - q[0]).abs() < tolerance && (p[1] - q[1]).abs() < tolerance
}

impl Planner<'_> {
    /// Returns the corners that rounding may place on a side of a curve.
    fn corners_on(&self, side: i8, curve: CurveIndex, corners: &[usize]) -> Vec<usize> {
        let is_on_side =
            |at: &usize| self.shapes[curve].side(self.corners[*at].at, self.size) != -side;
        corners.iter().copied().filter(is_on_side).collect()
    }

    /// Returns a leaf for an owner, with the corners split off at which only pieces of other owners meet.
    /// Rounding may bring a point near such a corner here, where its owner has no piece.
    fn leaf(&self, owner: Option<usize>, pieces: &[Rc<Piece>], corners: &[usize]) -> Tree {
        let foreign = corners.iter().find(|at| !self.corners[**at].owners.contains(&owner));
        let Some(corner) = foreign.map(|at| &self.corners[*at]) else {
            return Tree::Leaf(owner);
        };
        let Some(first) = corner.owners.first() else { return Tree::Leaf(owner) };
        // On the corner's own side of the splitting curve there is no piece to keep.
        if pieces.is_empty() {
            return Tree::Leaf(*first);
        }
        let mut curves: Vec<(CurveIndex, i8)> = (0..self.shapes.len())
            .map(|curve| (curve, self.shapes[curve].side(corner.at, self.size)))
            .filter(|(_, side)| *side != 0)
            .collect();
        // The cheapest curve that keeps the corner away from all pieces.
        curves.sort_by(|a, b| self.costs[a.0].total_cmp(&self.costs[b.0]));
        let separating = curves.into_iter().find(|(curve, side)| {
            let cutter = Cutter { shapes: self.shapes, curve: *curve, size: self.size };
            pieces.iter().all(|piece| match piece.position_to(cutter) {
                Position::Below => *side > 0,
                Position::Above => *side < 0,
                Position::Degenerate => true,
                Position::Across => false,
            })
        });
        let Some((curve, side)) = separating else { return Tree::Leaf(owner) };
        let [corners_here, corners_beyond] =
            [side, -side].map(|side| self.corners_on(side, curve, corners));
        let (corners_here, corners_beyond) =
            (self.leaf(*first, &[], &corners_here), self.leaf(owner, pieces, &corners_beyond));
        let (below, above) =
            if side < 0 { (corners_here, corners_beyond) } else { (corners_beyond, corners_here) };
        Tree::split(curve, side < 0, below, above)
    }
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
    /// surface. Where the solid is on both sides, it is the side of the owner listed first, if that is the
    /// same side along the whole curve; otherwise the side below.
    fn zeros(&self, curve: CurveIndex, halves: &Halves) -> Zeros {
        let [below, above] =
            [&halves.below, &halves.above].map(|half| self.border_points(curve, half));
        // For the sides below and above: a point that belongs to the solid on this side only; a point whose first
        // listed owner is on this side.
        let (mut is_required, mut is_preferred) = ([false; 2], [false; 2]);
        let mut points: Vec<Point> =
            below.points.iter().chain(&above.points).map(|(p, _)| *p).collect();
        points.sort_by(|p, q| p[0].total_cmp(&q[0]).then(p[1].total_cmp(&q[1])));
        // Vertices that pieces share agree except for their last bits.
        let tolerance = 1e-12 * self.size;
        points.dedup_by(|p, q| are_near(*p, *q, tolerance));
        for p in points {
            let [b, a] = [&below, &above]
                .map(|border_points| border_points.first_at(p, COINCIDENCE_FRACTION * self.size));
            let inside = [b, a].map(|rank| rank != usize::MAX);
            match (inside, b.cmp(&a)) {
                ([true, false], _) => is_required[0] = true,
                ([false, true], _) => is_required[1] = true,
                (_, Ordering::Less) => is_preferred[0] = true,
                (_, Ordering::Greater) => is_preferred[1] = true,
                _ => {}
            }
            if is_required == [true, true] {
                // Some points belong to the solid below only, and others to the solid above only.
                return Zeros::Both;
            }
        }
        match (is_required, is_preferred) {
            ([false, true], _) | ([false, false], [false, true]) => Zeros::Above,
            _ => Zeros::Below,
        }
    }

    /// Returns the points and edges of some pieces that lie on a curve.
    fn border_points(&self, curve: CurveIndex, pieces: &[Rc<Piece>]) -> BorderPoints {
        let shape = &self.shapes[curve];
        let (mut points, mut edges) = (Vec::new(), Vec::new());
        for piece in pieces {
            let rank = rank(piece.owner);
            let is_on_curve: Vec<bool> =
                piece.vertices.iter().map(|p| shape.side(*p, self.size) == 0).collect();
            for (k, p) in piece.vertices.iter().enumerate().filter(|(k, _)| is_on_curve[*k]) {
                points.push((*p, rank));
                let next = (k + 1) % is_on_curve.len();
                // The chord of a curved edge is on the curve only at its ends.
                if is_on_curve[next] && piece.edges[k] == Edge::Straight {
                    edges.push(([*p, piece.vertices[next]], rank));
                }
            }
        }
        BorderPoints::new(points, edges)
    }

    /// Returns the owners of the points on a curve: at each, the first listed of those on both sides.
    fn zero_set_tree(
        &mut self,
        curve: CurveIndex,
        halves: &Halves,
        corners: &[usize],
        open: &[Candidate],
    ) -> Result<Tree, Diagnostic> {
        let shape = &self.shapes[curve];
        // Only pieces that reach the curve can own its points.
        let touches =
            |piece: &&Rc<Piece>| piece.vertices.iter().any(|p| shape.side(*p, self.size) == 0);
        let [below, above] = [&halves.below, &halves.above]
            .map(|pieces| pieces.iter().filter(touches).cloned().collect::<Vec<_>>());
        let [corners_below, corners_above] =
            [-1, 1].map(|side| self.corners_on(side, curve, corners));
        // Samples lie beside curves, so they say nothing about points on this one.
        let none = SampleSubset::default();
        let below = self.tree(&below, &none, &corners_below, open.to_vec())?;
        let above = self.tree(&above, &none, &corners_above, open.to_vec())?;
        Ok(first(&below, &above))
    }
}

/// Points and straight edges on a curve, in order along an axis, with the rank of their owner: its index in the list of
/// regions, or `usize::MAX` for the outside.
struct BorderPoints {
    axis: usize,
    points: Vec<(Point, usize)>,
    /// The edges by their lower ends.
    edges: Vec<([Point; 2], usize)>,
    /// The greatest upper end of each edge and those before it.
    reaches: Vec<f64>,
}

impl BorderPoints {
    /// Orders points and edges along the axis on which the points are farther apart.
    fn new(mut points: Vec<(Point, usize)>, mut edges: Vec<([Point; 2], usize)>) -> BorderPoints {
        let spread = |axis: usize| {
            let ends = points.iter().map(|(p, _)| [p[axis], p[axis]]);
            ends.reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])])
                .map_or(0.0, |[low, high]| high - low)
        };
        let axis = usize::from(spread(1) > spread(0));
        let low = |[a, b]: &[Point; 2]| a[axis].min(b[axis]);
        points.sort_by(|(p, _), (q, _)| p[axis].total_cmp(&q[axis]));
        edges.sort_by(|(a, _), (b, _)| low(a).total_cmp(&low(b)));
        let mut reach = f64::NEG_INFINITY;
        let reaches = edges.iter().map(|([a, b], _)| {
            reach = reach.max(a[axis]).max(b[axis]);
            reach
        });
        BorderPoints { axis, reaches: reaches.collect(), points, edges }
    }

    /// Returns the rank of the first listed owner that touches a point.
    fn first_at(&self, p: Point, tolerance: f64) -> usize {
        let axis = self.axis;
        let [low, high] = [p[axis] - tolerance, p[axis] + tolerance];
        let begin = self.points.partition_point(|(q, _)| q[axis] < low);
        let points = self.points[begin..].iter().take_while(|(q, _)| q[axis] <= high);
        let points = points.filter(|(q, _)| are_near(p, *q, tolerance));
        // From the last edge that begins before the point, as long as one before it may reach the point.
        let end = self.edges.partition_point(|([a, b], _)| a[axis].min(b[axis]) <= high);
        let edges = self.edges[..end].iter().zip(&self.reaches).rev();
        let edges = edges.take_while(|(_, reach)| **reach >= low).map(|(edge, _)| edge);
        let edges = edges.filter(|(edge, _)| is_along(p, *edge, tolerance));
        let ranks = points.map(|(_, rank)| *rank).chain(edges.map(|(_, rank)| *rank));
        ranks.min().unwrap_or(usize::MAX)
    }
}

/// Returns an owner's index in the list of regions, or `usize::MAX` for the outside.
fn rank(owner: Option<usize>) -> usize {
    owner.unwrap_or(usize::MAX)
}

/// Returns a tree whose leaves are the first listed of the owners in two trees.
fn first(a: &Tree, b: &Tree) -> Tree {
    match (a, b) {
        (Tree::Leaf(own), Tree::Leaf(other)) => {
            Tree::Leaf(if rank(*other) < rank(*own) { *other } else { *own })
        }
        (Tree::Leaf(_), Tree::Split { curve, strict, below, above }) => {
            Tree::split(*curve, *strict, first(a, below), first(a, above))
        }
        (Tree::Split { curve, strict, below, above }, _) => {
            let [low, high] = [true, false].map(|holds| b.simplified(*curve, *strict, holds));
            Tree::split(*curve, *strict, first(below, &low), first(above, &high))
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
