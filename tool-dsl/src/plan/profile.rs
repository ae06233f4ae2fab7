//! The tree of a tool with a profile. Splits divide the pieces of its regions and the outside until one owner is left. Points on
//! a splitting curve go to one side, or to a tree of their own if both sides need them. A point where several curves meet is on both
//! sides of each, since rounding decides: leaves that are wrong about such points are divided. Where no curve separates pieces, a
//! straight line does. At last every piece is followed to the leaves that it reaches, which bounds how far depth is from the
//! distance.

use super::cells::{Cells, Halves, INDIFFERENCE, MAX_DEVIATION_FRACTION};
use super::meetings::{Line, WrongPoint};
use super::samples::{ONE_SIDED_GAIN, SampleSubset, Samples};
use super::{BITS_PER_ADDITION, MAX_TESTS, Tree, costs};
use crate::diagnostic::Diagnostic;
use crate::formula::{CurveIndex, NEGATIVE, POSITIVE, Signs};
use crate::geometry::outline::{Point, dot, minus, norm};
use crate::geometry::polygon::{hull, width};
use crate::model::{Model, Profile};
use crate::regionalise::pieces::{Piece, SampledPiece};
use std::cmp::Ordering;
use std::collections::BinaryHeap;
use std::rc::Rc;

/// The number of curves that may be passed over because their zeros belong to both sides.
const MAX_SKIPPED_CURVES: usize = 6;

/// The relative cost of a test that the tree also makes elsewhere: code for lanes computes it once.
const REPEATED_TEST_COST_FACTOR: f64 = 0.3;

/// The cost of a line that the plan adds, in additions.
const LINE_COST: f64 = 3.0;

/// The greatest number of tests that are tried for trees of points on a curve.
const MAX_MERGED_TESTS: usize = 10 * MAX_TESTS;

/// The number of times that a tree is mended where its curves meet, and where none separates pieces.
const MAX_MENDS: usize = 6;

/// The plan of a profile.
pub(super) struct ProfilePlan {
    pub(super) tree: Tree,
    /// The greatest difference of the tree's depths from the distance.
    pub(super) deviation: f64,
    pub(super) has_owner_far_outside: bool,
    /// The lines that it tests after the model's curves.
    pub(super) lines: Vec<Line>,
}

/// Plans a profile.
pub(super) fn plan(
    model: &Model,
    profile: &Profile,
    sampled: &[SampledPiece],
) -> Result<ProfilePlan, Diagnostic> {
    let (shapes, size) = profile.functions(&model.graph, &model.curves);
    let pieces = sampled.iter().map(|sampled| Rc::clone(&sampled.piece)).collect();
    let cells = Cells::new(model, profile, shapes, size, pieces);
    let (mut pieces, samples) = cells.of_regions(sampled);
    let mut planner = Planner {
        costs: costs(model),
        samples: Samples::new(&samples, &cells.shapes),
        used: vec![false; model.curves.len()],
        tests: 0,
        merged_tests: 0,
        missing: Vec::new(),
        cells,
    };
    let candidates = planner.candidates(false);
    let mut tree = planner.tree(&pieces, &planner.samples.all(), candidates)?;
    pieces.clone_from(&planner.cells.pieces);
    // A part's regions may leave out points of it, whose region does not matter but whose depth does.
    if profile.over.is_some() {
        tree = planner.mended(tree, &pieces)?;
    }
    // Smaller errors are part of the deviation.
    let is_mended = |wrong: &WrongPoint| wrong.loss > MAX_DEVIATION_FRACTION * size;
    let (mut lines, mut attempts) = (Vec::new(), 0);
    let deviation = loop {
        let wrong = planner.cells.wrong_meetings(&tree);
        let deviation = planner.cells.deviation(&tree, &wrong);
        let is_right = deviation.is_ok() && !wrong.iter().any(is_mended);
        if is_right || attempts == MAX_MENDS {
            break deviation?;
        }
        attempts += 1;
        pieces.extend(wrong.into_iter().filter(is_mended).map(|wrong| wrong.piece));
        planner.missing.clear();
        tree = planner.mended(tree, &pieces)?;
        for line in std::mem::take(&mut planner.missing) {
            planner.add(&line);
            lines.push(line);
        }
    };
    let has_owner_far_outside = planner.cells.has_owner_far_outside(&tree);
    Ok(ProfilePlan { tree, deviation, has_owner_far_outside, lines })
}

/// The search for a tree of few tests.
struct Planner<'m> {
    cells: Cells<'m>,
    /// The cost of each curve, in additions.
    costs: Vec<f64>,
    samples: Samples,
    /// The curves that the tree tests already.
    used: Vec<bool>,
    tests: usize,
    /// The number of tests in trees of points on a curve, before they are simplified.
    merged_tests: usize,
    /// Lines that would separate the pieces of a leaf, where no curve does.
    missing: Vec<Line>,
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

/// A curve to split by, its division of the pieces, and the side to which its own points go.
struct Choice {
    curve: CurveIndex,
    halves: Halves,
    zeros: Zeros,
}

impl Planner<'_> {
    fn candidates(&self, is_one_sided: bool) -> Vec<Candidate> {
        (0..self.costs.len()).map(|curve| Candidate { curve, is_one_sided }).collect()
    }

    /// Adds a line to the curves.
    fn add(&mut self, line: &Line) {
        self.cells.shapes.push(line.shape());
        self.costs.push(LINE_COST);
        self.used.push(false);
    }

    /// Divides the leaves of a tree to which pieces of other features come.
    fn mended(&mut self, tree: Tree, pieces: &[Rc<Piece>]) -> Result<Tree, Diagnostic> {
        match tree {
            Tree::Leaf(owner) => {
                let indifference = INDIFFERENCE * self.cells.size;
                if pieces.iter().all(|piece| self.cells.loss(piece, owner) <= indifference) {
                    return Ok(tree);
                }
                let pieces = pieces.iter().map(|piece| self.cells.as_of_region(piece, owner));
                let pieces: Vec<Rc<Piece>> = pieces.collect();
                // Without samples, all are on one side.
                self.tree(&pieces, &SampleSubset::default(), self.candidates(true))
            }
            Tree::Split { curve, strict, below, above } => {
                let halves = self.cells.halves(curve, pieces);
                let below = self.mended(*below, &halves.below)?;
                let above = self.mended(*above, &halves.above)?;
                Ok(Tree::split(curve, strict, below, above))
            }
        }
    }

    /// Returns a tree of few tests.
    fn tree(
        &mut self,
        pieces: &[Rc<Piece>],
        samples: &SampleSubset,
        mut candidates: Vec<Candidate>,
    ) -> Result<Tree, Diagnostic> {
        // Narrow pieces are separated only where their owner matters.
        let indifference = INDIFFERENCE * self.cells.size;
        let is_wide = |piece: &&Rc<Piece>| width(&piece.vertices) > indifference;
        let mut relevant: Vec<Rc<Piece>> = pieces.iter().filter(is_wide).map(Rc::clone).collect();
        if owner_count(&relevant) <= 1 {
            let owner = match relevant.first() {
                Some(piece) => piece.owner,
                None => self.least_wrong_owner(pieces),
            };
            if pieces.iter().all(|piece| self.cells.loss(piece, owner) <= indifference) {
                return Ok(Tree::Leaf(owner));
            }
            relevant = pieces.to_vec();
        }
        let (choice, divides_nothing) = self.choose(&relevant, samples, &mut candidates);
        let Some(Choice { curve, halves, zeros }) = choice else {
            // Pieces that no curve separates are equally near, or have no points there, or are found by the deviation of the finished tree.
            let owned = self.cells.owned_parts(pieces);
            let pieces = if owned.is_empty() { pieces } else { &owned };
            let owner = self.least_wrong_owner(pieces);
            for piece in pieces.iter().filter(|piece| self.cells.is_wrong(piece, owner)) {
                let line = Line::between(piece, pieces, self.cells.tolerance);
                let line = line.filter(|line| !self.missing.contains(line));
                self.missing.extend(line);
            }
            return Ok(Tree::Leaf(owner));
        };
        // What divides no wide piece may divide a narrow one.
        let are_all = relevant.len() == pieces.len();
        candidates
            .retain(|other| other.curve != curve && !(are_all && divides_nothing[other.curve]));
        self.used[curve] = true;
        self.tests += 1;
        if self.tests > MAX_TESTS {
            return Err(super::too_large(self.cells.model));
        }
        let [low, high] = self.samples.divided(samples, curve);
        let halves = if are_all { halves } else { self.cells.halves(curve, pieces) };
        let below = self.tree(&halves.below, &low, candidates.clone())?;
        let above = self.tree(&halves.above, &high, candidates)?;
        Ok(match zeros {
            // The points on the curve belong to the solid on either side.
            Zeros::Both => {
                let on_curve = self.first_of(&below, &above)?;
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

    /// Returns the curve to split by, and for each curve whether it is known to divide no piece: the one that gives most
    /// information about the owners relative to its cost, or of those about which samples tell nothing the one that
    /// separates most pieces.
    fn choose(
        &mut self,
        pieces: &[Rc<Piece>],
        samples: &SampleSubset,
        candidates: &mut [Candidate],
    ) -> (Option<Choice>, Vec<bool>) {
        let uncertain = self.samples.entropy(samples);
        let mut ranked = BinaryHeap::with_capacity(candidates.len());
        for Candidate { curve, is_one_sided } in candidates {
            let cost_factor = if self.used[*curve] { REPEATED_TEST_COST_FACTOR } else { 1.0 };
            let gain =
                if *is_one_sided { None } else { self.samples.gain(samples, uncertain, *curve) };
            *is_one_sided = gain.is_none();
            let cost = BITS_PER_ADDITION * cost_factor * self.costs[*curve];
            let gain = gain.unwrap_or(ONE_SIDED_GAIN) - cost;
            let (listed, is_one_sided) = (self.listed_rank(*curve), *is_one_sided);
            ranked.push(Ranked { listed, gain, curve: *curve, is_one_sided });
        }
        let mut divides_nothing = vec![false; self.cells.shapes.len()];
        let choice = self.best_separating(pieces, ranked, &mut divides_nothing);
        (choice, divides_nothing)
    }

    /// Returns the best curve that separates owners, and marks those that are found to divide no piece.
    fn best_separating(
        &self,
        pieces: &[Rc<Piece>],
        mut ranked: BinaryHeap<Ranked>,
        divides_nothing: &mut [bool],
    ) -> Option<Choice> {
        let count = owner_count(pieces);
        let around = hull(pieces.iter().flat_map(|piece| piece.vertices.iter().copied()).collect());
        let (mut fallback, mut with_double_zeros, mut skipped_count) = (None, None, 0);
        let mut best_one_sided: Option<([usize; 3], Choice)> = None;
        // Where samples tell something, one of the first few is mostly chosen, so they are not sorted.
        while let Some(Ranked { curve, listed, is_one_sided, .. }) = ranked.pop() {
            let is_by_pieces = is_one_sided && listed == usize::MAX;
            if !is_by_pieces && best_one_sided.is_some() {
                break;
            }
            if self.cells.is_beside(curve, &around) {
                divides_nothing[curve] = true;
                continue;
            }
            let halves = self.cells.halves(curve, pieces);
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
        let listed = self.cells.model.first_curves.iter().position(|first| *first == curve);
        listed.unwrap_or(usize::MAX)
    }

    /// Returns the owner, of those of some pieces, by which depth is least wrong in the others.
    fn least_wrong_owner(&self, pieces: &[Rc<Piece>]) -> Option<usize> {
        // A point counts only where there is nothing else.
        let areas: Vec<_> =
            pieces.iter().filter(|piece| !piece.is_point()).map(Rc::clone).collect();
        let pieces = if areas.is_empty() { pieces } else { &areas };
        let mut owners: Vec<_> = pieces.iter().map(|piece| piece.owner).collect();
        owners.sort_unstable();
        owners.dedup();
        let loss = |owner: &Option<usize>| {
            pieces.iter().map(|piece| self.cells.loss(piece, *owner)).fold(0.0, f64::max)
        };
        let least = owners.into_iter().min_by(|a, b| loss(a).total_cmp(&loss(b)));
        least.flatten()
    }
}

/// Returns the number of different owners of some pieces.
fn owner_count(pieces: &[Rc<Piece>]) -> usize {
    let mut owners: Vec<_> = pieces.iter().map(|piece| piece.owner).collect();
    owners.sort_unstable();
    owners.dedup();
    owners.len()
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
        if !self.cells.shapes[curve].is_line() {
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

    /// Returns a tree whose leaves are the first listed of the owners in two trees.
    fn first_of(&mut self, a: &Tree, b: &Tree) -> Result<Tree, Diagnostic> {
        Ok(match (a, b) {
            (Tree::Leaf(own), Tree::Leaf(other)) => {
                Tree::Leaf(if rank(*other) < rank(*own) { *other } else { *own })
            }
            (Tree::Leaf(_), Tree::Split { curve, strict, below, above }) => {
                self.count_merged()?;
                let (below, above) = (self.first_of(a, below)?, self.first_of(a, above)?);
                Tree::split(*curve, *strict, below, above)
            }
            (Tree::Split { curve, strict, below, above }, _) => {
                self.count_merged()?;
                let [low, high] = [true, false].map(|holds| b.simplified(*curve, *strict, holds));
                let (below, above) = (self.first_of(below, &low)?, self.first_of(above, &high)?);
                Tree::split(*curve, *strict, below, above)
            }
        })
    }

    /// Counts one more test of a tree of points on a curve.
    fn count_merged(&mut self) -> Result<(), Diagnostic> {
        self.merged_tests += 1;
        if self.merged_tests > MAX_MERGED_TESTS {
            return Err(super::too_large(self.cells.model));
        }
        Ok(())
    }

    /// Returns the distance within which points of a border coincide.
    fn coincidence(&self) -> f64 {
        256.0 * f64::EPSILON * self.cells.size
    }

    /// Returns where pieces of the solid reach a line.
    fn touching(&self, curve: CurveIndex, pieces: &[Rc<Piece>]) -> Vec<Touching> {
        let shape = &self.cells.shapes[curve];
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
}
