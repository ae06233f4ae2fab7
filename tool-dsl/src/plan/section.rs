//! The plan of a tool with a profile. Its partition is known as polygons, and splits cut them until one owner
//! is left.

use super::corners::{Corner, corners};
use super::samples::{SampleSubset, Samples};
use super::zero_set::Zeros;
use super::{MAX_TESTS, Tree, costs};
use crate::diagnostic::{CheckKind, Diagnostic};
use crate::expr::Id;
use crate::formula::{CurveIndex, Formula};
use crate::geometry::cut::{Cut, Cutter, Piece};
use crate::geometry::outline::{self, Point, minus, norm};
use crate::geometry::shape::CurveFunction;
use crate::model::{Model, Over, Section};
use crate::regionalise::cells;
use crate::regionalise::{ROUNDING, overlay};
use std::cell::Cell;
use std::rc::Rc;

/// The number of chords per curved edge: at first, and on retries after coarser polygons gave a wrong tree.
const CHORDS_PER_EDGE: [u32; 3] = [8, 40, 200];

/// The number of curves that may be passed over because their zeros belong to both sides.
const MAX_SKIPPED_CURVES: usize = 6;

pub(super) type Owners = Tree<Option<usize>>;

/// The information, in bits, that must justify one addition.
pub(super) const BITS_PER_ADDITION: f64 = 0.01;
/// The relative cost of a test that the tree also makes elsewhere: code for lanes computes it once.
const REPEATED_TEST_COST_FACTOR: f64 = 0.3;
/// Returns the tree of owners, and that of the distances to the features that are nearest outside.
pub(super) fn trees(model: &Model, section: &Section) -> Result<(Owners, Tree<Id>), Diagnostic> {
    let mut result = try_trees(model, section, CHORDS_PER_EDGE[0]);
    for chords in &CHORDS_PER_EDGE[1..] {
        if result.is_err() {
            result = try_trees(model, section, *chords);
        }
    }
    result
}

/// Returns whether a tree has an owner far outside, where there was no piece. The test uses points all
/// around, and points in thin strips along the lines and normals of the outline.
pub(super) fn has_owner_far_outside(model: &Model, section: &Section, tree: &Owners) -> bool {
    let (shapes, size) = overlay::shapes(&model.graph, &model.curves, &section.outline);
    let [low, high] = outline::bounding_box(&section.outline).map(|end| end[1]);
    let middle = low / 2.0 + high / 2.0;
    let is_owned = |p: Point| {
        p[0] >= 0.0 && tree.leaf_at(&|curve| shapes[curve].value([p[0], p[1]])).is_some()
    };
    let distances = || (1..16).map(|k| size * 8f64.powi(k));
    let any_around = distances().any(|distance| {
        (0..=128).any(|k| {
            let (sin, cos) = ((f64::from(k) / 128.0 - 0.5) * std::f64::consts::PI).sin_cos();
            is_owned([distance * cos, middle + distance * sin])
        })
    });
    let any_in_strips = || {
        section.outline.iter().any(|segment| {
            let [from, to] = segment.ends();
            let direction = minus(to, from).map(|part| part / norm(minus(to, from)));
            [from, to].into_iter().any(|end| {
                [direction, [-direction[1], direction[0]]].into_iter().any(|direction| {
                    distances().chain(distances().map(|distance| -distance)).any(|distance| {
                        [-0.01, -1e-5, 1e-5, 0.01].into_iter().any(|offset| {
                            let across =
                                [-direction[1] * offset * size, direction[0] * offset * size];
                            is_owned([0, 1].map(|k| end[k] + distance * direction[k] + across[k]))
                        })
                    })
                })
            })
        })
    };
    any_around || any_in_strips()
}

fn try_trees(
    model: &Model,
    section: &Section,
    chords: u32,
) -> Result<(Owners, Tree<Id>), Diagnostic> {
    let (shapes, size) = overlay::shapes(&model.graph, &model.curves, &section.outline);
    let (inner, outer) = (section.inner.cells(chords), section.outer.cells(chords));
    let whole_piece = |cell: &cells::Cell, owner| overlay::piece(cell, owner, &shapes, size);

    let mut inner_input = PlanInput::default();
    for cell in &inner {
        match &section.over {
            None => inner_input
                .add(cell, [whole_piece(cell, Some(cell.part))], |_| Some(Some(cell.part))),
            Some(over) => {
                let pieces =
                    overlay::divided(whole_piece(cell, None), &over.conditions, &shapes, size);
                let owned = pieces.into_iter().filter_map(|(piece, holding)| {
                    let owner = over.region(cell.part, *holding.first()?)?;
                    Some(Piece { owner: Some(owner), ..piece })
                });
                inner_input.add(cell, owned, |p| over.owner(cell.part, p, &shapes, size).map(Some));
            }
        }
    }
    for cell in &outer {
        inner_input.add(cell, [whole_piece(cell, None)], |_| Some(None));
    }
    let inside = model.regions.iter().map(|region| &region.inside).collect();
    let owners = plan(model, &shapes, size, inner_input, inside)?;
    // A sliver between a curve and its chord may have been given to the wrong owner.
    let owner = |p: Point| *owners.leaf_at(&|curve| shapes[curve].value(p));
    let part = |region: usize| match &section.over {
        Some(over) => over.regions[region].0,
        None => region,
    };
    if let Some(p) = section.inner.wrongly_assigned_point(|p, _| owner(p).map(part)) {
        return Err(inseparable_owners(model, p));
    }

    let mut outside = PlanInput::default();
    for cell in &outer {
        outside.add(cell, [whole_piece(cell, Some(cell.part))], |_| Some(Some(cell.part)));
    }
    // Rounding may move a point of the surface just below it, so the same features continue there.
    for (piece, cell) in section.inner.shell(chords) {
        let Some(part) = section.outer.part_of(section.outer.segment_count() - 1 - piece) else {
            continue;
        };
        outside.add(&cell, [whole_piece(&cell, Some(part))], |_| None);
    }
    let neighbour_conditions = section.outside.iter().map(|part| &part.condition).collect();
    let outside = plan(model, &shapes, size, outside, neighbour_conditions)?;
    let part_at = |p: Point| *outside.leaf_at(&|curve| shapes[curve].value(p));
    let is_free = |p, distance| distance <= ROUNDING * size || owner(p).is_none();
    if let Some(p) = section
        .outer
        .wrongly_assigned_point(|p, distance| part_at(p).filter(|_| is_free(p, distance)))
    {
        return Err(inseparable_owners(model, p));
    }
    let clearance = |part: &Option<usize>| part.map(|part| section.outside[part].clearance);
    let outside = outside.map(&clearance);
    Ok((owners, outside.unwrap_or(Tree::Leaf(section.outside[0].clearance))))
}

/// The input of a plan: pieces to separate, weighted sample points, and points to check the tree with.
#[derive(Default)]
pub(super) struct PlanInput {
    pub(super) pieces: Vec<Rc<Piece>>,
    samples: Vec<(Point, f64, Option<usize>)>,
    witnesses: Vec<(Point, Option<usize>)>,
    pub(super) corners: Vec<Point>,
}

impl PlanInput {
    /// Adds the pieces of a cell, and its points where their owner is known.
    fn add(
        &mut self,
        cell: &cells::Cell,
        pieces: impl IntoIterator<Item = Piece>,
        owner: impl Fn(Point) -> Option<Option<usize>>,
    ) {
        for piece in pieces {
            let origin = self.pieces.len();
            self.pieces.push(Rc::new(Piece { origin, ..piece }));
        }
        self.corners.extend(&cell.corners);
        let samples = cell.samples.iter();
        self.samples.extend(samples.filter_map(|(p, weight)| Some((*p, *weight, owner(*p)?))));
        self.witnesses.extend(cell.witnesses.iter().filter_map(|p| Some((*p, owner(*p)?))));
    }
}

impl Over {
    /// Returns the region of a part in which the given condition is the first to hold.
    fn region(&self, part: usize, condition: usize) -> Option<usize> {
        self.regions.iter().position(|pair| *pair == (part, condition))
    }

    /// Returns the region of a point in a part, unless the point is on a border within tolerance.
    fn owner(
        &self,
        part: usize,
        p: Point,
        shapes: &[CurveFunction<'_>],
        size: f64,
    ) -> Option<usize> {
        let on_border = Cell::new(false);
        let holds = |sign: i8| {
            let value = |curve: CurveIndex| match shapes[curve].side(p, size) {
                0 => {
                    on_border.set(true);
                    f64::from(sign)
                }
                _ => shapes[curve].value(p),
            };
            self.conditions.iter().position(|condition| condition.holds(&value))
        };
        let low = holds(-1)?;
        // Away from every curve that was evaluated, the sign does not matter.
        let high = if on_border.get() { holds(1)? } else { low };
        if low == high { self.region(part, low) } else { None }
    }
}

/// Plans the splits that separate the pieces of a ground.
///
/// Curved edges are chords here, so a cut may leave a sliver that belongs to no owner. The owners'
/// conditions, `inside`, identify such slivers.
fn plan<'m>(
    model: &'m Model,
    shapes: &'m [CurveFunction<'m>],
    size: f64,
    input: PlanInput,
    inside: Vec<&'m Formula>,
) -> Result<Owners, Diagnostic> {
    let samples = Samples::new(&input.samples, shapes);
    let all = samples.all();
    let with_bounding_box = |piece: &Rc<Piece>| (Rc::clone(piece), piece.bounding_box());
    let whole_pieces: Vec<_> = input.pieces.iter().map(with_bounding_box).collect();
    let corners = corners(input.corners, &whole_pieces, (shapes, size));
    let all_corners = (0..corners.len()).collect();
    let mut planner = Planner {
        model,
        shapes,
        costs: costs(model),
        samples,
        corners,
        inside,
        used: vec![false; model.curves.len()],
        whole_pieces,
        sides: vec![Vec::new(); model.curves.len()],
        size,
        tests: 0,
    };
    let candidates = (0..model.curves.len()).collect();
    let tree = planner.tree(&input.pieces, (all, all_corners), candidates)?;
    for (p, owner) in input.witnesses {
        if *tree.leaf_at(&|curve| shapes[curve].value(p)) != owner {
            return Err(inseparable_owners(model, p));
        }
    }
    Ok(tree)
}

pub(super) struct Planner<'m> {
    model: &'m Model,
    pub(super) shapes: &'m [CurveFunction<'m>],
    pub(super) costs: Vec<f64>,
    samples: Samples,
    pub(super) corners: Vec<Corner>,
    inside: Vec<&'m Formula>,
    used: Vec<bool>,
    /// The pieces before any cut, each with its bounding box.
    whole_pieces: Vec<(Rc<Piece>, [Point; 2])>,
    /// For each curve that was tried, the side of each whole piece.
    sides: Vec<Vec<Option<Side>>>,
    pub(super) size: f64,
    tests: usize,
}

/// The side of a whole piece, and therefore of everything cut from it.
#[derive(Clone, Copy)]
enum Side {
    Below,
    Above,
    Torn,
}

/// The pieces on the two sides of a curve.
pub(super) struct Halves {
    pub(super) below: Vec<Rc<Piece>>,
    pub(super) above: Vec<Rc<Piece>>,
}

impl Planner<'_> {
    pub(super) fn tree(
        &mut self,
        pieces: &[Rc<Piece>],
        (samples, corners): (SampleSubset, Vec<usize>),
        mut candidates: Vec<CurveIndex>,
    ) -> Result<Owners, Diagnostic> {
        let first = pieces.first().and_then(|piece| piece.owner);
        if pieces.iter().all(|piece| piece.owner == first) {
            return Ok(self.leaf(first, pieces, &corners));
        }
        let Some((curve, halves, zeros)) = self.choose(pieces, &samples, &mut candidates) else {
            return Ok(self.leaf(self.largest_owner(pieces), pieces, &corners));
        };
        self.used[curve] = true;
        self.tests += 1;
        if self.tests > MAX_TESTS {
            return Err(super::too_large(self.model));
        }
        candidates.retain(|other| *other != curve);
        let [low, high] = self.samples.divided(&samples, curve);
        let on_curve = match zeros {
            Zeros::Both => Some(self.zero_set_tree(curve, &halves, &corners, &candidates)?),
            _ => None,
        };
        let [corners_below, corners_above] =
            [-1, 1].map(|side| self.corners_on(side, curve, &corners));
        let below = self.tree(&halves.below, (low, corners_below), candidates.clone())?;
        let above = self.tree(&halves.above, (high, corners_above), candidates)?;
        Ok(match on_curve {
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
        candidates: &mut Vec<CurveIndex>,
    ) -> Option<(CurveIndex, Halves, Zeros)> {
        let uncertain = self.samples.entropy(samples);
        let mut ranked: Vec<(f64, CurveIndex)> = candidates
            .iter()
            .map(|curve| {
                let cost_factor = if self.used[*curve] { REPEATED_TEST_COST_FACTOR } else { 1.0 };
                let gain = self.samples.gain(samples, uncertain, *curve);
                (gain - BITS_PER_ADDITION * cost_factor * self.costs[*curve], *curve)
            })
            .collect();
        let listed_rank =
            |curve: CurveIndex| self.model.first_curves.iter().position(|f| *f == curve);
        ranked.sort_by(|a, b| {
            let order = |curve| listed_rank(curve).unwrap_or(usize::MAX);
            order(a.1).cmp(&order(b.1)).then(b.0.total_cmp(&a.0))
        });
        let (mut fallback, mut with_double_zeros, mut skipped_count) = (None, None, 0);
        for (_, curve) in ranked {
            let halves = self.halves(curve, pieces);
            if halves.below.is_empty() || halves.above.is_empty() {
                candidates.retain(|other| *other != curve);
                continue;
            }
            // A curve that cuts through cells without separating owners is kept as a last resort.
            let owners = |pieces: &[Rc<Piece>]| {
                let mut owners: Vec<_> = pieces.iter().map(|piece| piece.owner).collect();
                owners.sort_unstable();
                owners.dedup();
                owners.len()
            };
            let owner_count = owners(pieces);
            if owners(&halves.below) == owner_count && owners(&halves.above) == owner_count {
                fallback = fallback.or(Some((curve, halves, Zeros::Below)));
                continue;
            }
            // A curve whose points belong to both sides needs a tree of its own for them.
            let zeros = self.zeros(curve, &halves);
            if zeros != Zeros::Both {
                return Some((curve, halves, zeros));
            }
            with_double_zeros.get_or_insert((curve, halves, zeros));
            skipped_count += 1;
            if skipped_count > MAX_SKIPPED_CURVES {
                break;
            }
        }
        let fallback = fallback.map(|(curve, halves, _)| {
            let zeros = self.zeros(curve, &halves);
            (curve, halves, zeros)
        });
        with_double_zeros.or(fallback)
    }

    /// Returns the owner of pieces that no curve separates. All but one owner's pieces are slivers between a
    /// curve and its chord.
    fn largest_owner(&self, pieces: &[Rc<Piece>]) -> Option<usize> {
        let true_pieces: Vec<&Rc<Piece>> = pieces.iter().filter(|piece| self.owns(piece)).collect();
        let candidates = if true_pieces.is_empty() { pieces.iter().collect() } else { true_pieces };
        let largest = candidates.into_iter().max_by(|a, b| a.area().total_cmp(&b.area()));
        largest.and_then(|piece| piece.owner)
    }

    /// Returns whether the centre of a piece satisfies its owner's condition.
    fn owns(&self, piece: &Piece) -> bool {
        let middle = piece.middle();
        let value = |curve: CurveIndex| self.shapes[curve].value(middle);
        match piece.owner {
            Some(owner) => self.inside[owner].holds(&value),
            None => !self.inside.iter().any(|inside| inside.holds(&value)),
        }
    }

    fn halves(&mut self, curve: CurveIndex, pieces: &[Rc<Piece>]) -> Halves {
        let cutter = Cutter { shapes: self.shapes, curve, size: self.size };
        let (whole_piece, shape) = (&self.whole_pieces, &self.shapes[curve]);
        let sides = &mut self.sides[curve];
        sides.resize(whole_piece.len(), None);
        let side = |origin: usize| {
            let (piece, [middle, half]) = &whole_piece[origin];
            match shape.side_of_box(*middle, *half) {
                -1 => return Side::Below,
                1 => return Side::Above,
                _ => {}
            }
            match piece.cut(cutter) {
                Cut::Below => Side::Below,
                Cut::Above => Side::Above,
                Cut::Nothing | Cut::Both(..) => Side::Torn,
            }
        };
        let mut halves = Halves { below: Vec::new(), above: Vec::new() };
        for piece in pieces {
            let cut = match *sides[piece.origin].get_or_insert_with(|| side(piece.origin)) {
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

fn inseparable_owners(model: &Model, [d, z]: Point) -> Diagnostic {
    let outline = model.section.iter().flat_map(|section| &section.outline);
    let outline: Vec<_> = outline.cloned().collect();
    let span = outline::nearest_span(&outline, [d, z]).unwrap_or(model.name_span);
    let z = model.frame.to_file(z);
    Diagnostic::new(span, CheckKind::Inseparable { d, z })
}
