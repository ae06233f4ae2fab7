//! Divides a partition further, by conditions.

use super::cells::Cell;
use crate::expr::Graph;
use crate::expr::polynomial::Polynomials;
use crate::formula::{ANY_SIGN, Curve, Formula, NEGATIVE, POSITIVE, Signs};
use crate::geometry::cut::{CurveFunction, Cut, Cutter, Edge, Piece};
use crate::geometry::outline::{Point, Segment, bounding_box, minus, norm};

/// Returns a cell as a polygon whose curved edges refer to their curves.
pub(crate) fn piece(
    cell: &Cell,
    owner: Option<usize>,
    shapes: &[CurveFunction<'_>],
    size: f64,
) -> Piece {
    let count = cell.vertices.len();
    let mut edges = vec![Edge::Straight; count];
    let mut curved_edges: Vec<usize> = Vec::new();
    for k in 0..=count {
        if k < count && !cell.straight[k] {
            curved_edges.push(k);
        } else if !curved_edges.is_empty() {
            let edge = shapes
                .iter()
                .position(|shape| {
                    curved_edges.iter().all(|k| {
                        [*k, (*k + 1) % count]
                            .iter()
                            .all(|v| shape.side(cell.vertices[*v], size) == 0)
                    })
                })
                .map_or(Edge::Chord, Edge::Along);
            curved_edges.drain(..).for_each(|k| edges[k] = edge);
        }
    }
    Piece { owner, origin: 0, vertices: cell.vertices.clone(), edges }
}

/// Cuts a polygon until each condition holds everywhere or nowhere in each part. Returns each part with the indices of
/// the conditions that hold in it.
pub(crate) fn divided(
    piece: Piece,
    conditions: &[Formula],
    shapes: &[CurveFunction<'_>],
    size: f64,
) -> Vec<(Piece, Vec<usize>)> {
    let mut parts = Vec::new();
    let nothing = Decided { signs: vec![ANY_SIGN; shapes.len()], conditions: 0 };
    divide(piece, nothing, conditions, shapes, size, &mut parts);
    parts
}

/// The facts known of a whole polygon.
#[derive(Clone)]
struct Decided {
    /// The signs of the curves on it.
    signs: Vec<Signs>,
    /// The number of conditions, from the first on, that the signs decide. Signs are only added, so decided conditions
    /// stay decided.
    conditions: usize,
}

fn divide(
    piece: Piece,
    mut decided: Decided,
    conditions: &[Formula],
    shapes: &[CurveFunction<'_>],
    size: f64,
    parts: &mut Vec<(Piece, Vec<usize>)>,
) {
    loop {
        let undecided = conditions[decided.conditions..].iter().enumerate();
        let mut undecided = undecided.filter_map(|(k, condition)| {
            Some((k, condition.first_undecided_curve(&decided.signs)?))
        });
        let Some((before, curve)) = undecided.next() else {
            let all = 0..conditions.len();
            // No condition is undecided any more in this piece.
            let holding = all.filter(|k| conditions[*k].decide(&decided.signs) == Some(true));
            parts.push((piece, holding.collect()));
            return;
        };
        decided.conditions += before;
        match piece.cut(Cutter { shapes, curve, size }) {
            Cut::Both(below, above) => {
                for (part, sign) in [(below, NEGATIVE), (above, POSITIVE)] {
                    decided.signs[curve] = sign;
                    if let Some(part) = part {
                        divide(part, decided.clone(), conditions, shapes, size, parts);
                    }
                }
                return;
            }
            // No area, so nothing to own.
            Cut::Nothing => return,
            Cut::Above => decided.signs[curve] = POSITIVE,
            Cut::Below => decided.signs[curve] = NEGATIVE,
        }
    }
}

/// A part where a condition holds, both as indices.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ConditionedPart {
    pub(crate) part: usize,
    pub(crate) condition: usize,
}

/// The parts and conditions that have points in common.
pub(crate) struct Overlay {
    /// Sorted by condition, then by part.
    pub(crate) parts: Vec<ConditionedPart>,
    /// A point at which no condition holds.
    pub(crate) uncovered: Option<Point>,
    /// Two conditions, and a point where both hold.
    pub(crate) doubly_covered: Option<(usize, usize, Point)>,
}

/// Returns whether a point satisfies a formula, whatever the signs of curves within rounding of it.
fn is_clearly_inside(formula: &Formula, p: Point, shapes: &[CurveFunction<'_>], size: f64) -> bool {
    [-1.0, 1.0].into_iter().all(|sign| {
        formula.holds(&mut |curve: usize| match shapes[curve].side(p, size) {
            0 => sign,
            _ => shapes[curve].value(p),
        })
    })
}

/// Intersects conditions with the cells of parts. The area between a curve and its chord counts only if a point of it
/// is clearly inside.
pub(crate) fn overlay(
    cells: &[Cell],
    parts: &[&Formula],
    conditions: &[Formula],
    shapes: &[CurveFunction<'_>],
    size: f64,
) -> Overlay {
    let mut result = Overlay { parts: Vec::new(), uncovered: None, doubly_covered: None };
    for cell in cells {
        let cell_piece = piece(cell, Some(cell.part), shapes, size);
        for (part, holding) in divided(cell_piece, conditions, shapes, size) {
            let middle = part.middle();
            if part.is_sliver() {
                let Some(first) = holding.first() else { continue };
                let formulas = [parts[cell.part], &conditions[*first]];
                let any_inside = part.chords().any(|p| {
                    formulas.into_iter().all(|formula| is_clearly_inside(formula, p, shapes, size))
                });
                if !any_inside {
                    continue;
                }
            }
            match holding.as_slice() {
                [] => result.uncovered = result.uncovered.or(Some(middle)),
                [first, rest @ ..] => {
                    if let (Some(second), None) = (rest.first(), result.doubly_covered) {
                        result.doubly_covered = Some((*first, *second, middle));
                    }
                    let part = ConditionedPart { part: cell.part, condition: *first };
                    if !result.parts.contains(&part) {
                        result.parts.push(part);
                    }
                }
            }
        }
    }
    result.parts.sort_by_key(|part| (part.condition, part.part));
    result
}

/// Returns curves as shapes about the centre of the outline's bounding box, and the diagonal of that box.
pub(crate) fn shapes<'g>(
    graph: &'g Graph,
    curves: &[Curve],
    outline: &[Segment],
) -> (Vec<CurveFunction<'g>>, f64) {
    let [low, high] = bounding_box(outline);
    let middle = [0, 1].map(|k| low[k] / 2.0 + high[k] / 2.0);
    let mut polynomials = Polynomials::default();
    let shapes =
        curves.iter().map(|curve| CurveFunction::new(graph, curve.value, middle, &mut polynomials));
    (shapes.collect(), norm(minus(high, low)))
}
