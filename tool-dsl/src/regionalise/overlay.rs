//! A partition divided once more, by conditions.

use super::cells::Cell;
use crate::expr::Graph;
use crate::expr::polynomial::Polynomials;
use crate::formula::Curve;
use crate::formula::{ANY, Formula, NEGATIVE, POSITIVE, Signs};
use crate::geometry::cut::{Cut, Cutter, Edge, Piece};
use crate::geometry::outline::{Point, Segment, minus, norm, reach};
use crate::geometry::shape::Shape;

/// A cell as a piece whose curved edges know their curve.
pub(crate) fn piece(cell: &Cell, owner: Option<usize>, shapes: &[Shape<'_>], size: f64) -> Piece {
    let count = cell.vertices.len();
    let mut edges = vec![Edge::Straight; count];
    let mut run: Vec<usize> = Vec::new();
    for k in 0..=count {
        if k < count && !cell.straight[k] {
            run.push(k);
        } else if !run.is_empty() {
            let on = |shape: &Shape<'_>| {
                run.iter().all(|k| {
                    [*k, (*k + 1) % count].iter().all(|v| shape.side(cell.vertices[*v], size) == 0)
                })
            };
            let edge = shapes.iter().position(on).map_or(Edge::Chord, Edge::Along);
            run.drain(..).for_each(|k| edges[k] = edge);
        }
    }
    Piece { owner, origin: 0, vertices: cell.vertices.clone(), edges }
}

/// A piece cut until each part has conditions that hold all over it, or not at all; with each part
/// those that hold.
pub(crate) fn divided(
    piece: Piece,
    conditions: &[Formula],
    shapes: &[Shape<'_>],
    size: f64,
) -> Vec<(Piece, Vec<usize>)> {
    let mut parts = Vec::new();
    divide(piece, (vec![ANY; shapes.len()], 0), conditions, shapes, size, &mut parts);
    parts
}

/// The signs of the curves all over a piece, and how many conditions they decide, from the first on. Signs only
/// become known, so what is decided stays so.
type Known = (Vec<Signs>, usize);

fn divide(
    piece: Piece,
    (mut signs, mut decided): Known,
    conditions: &[Formula],
    shapes: &[Shape<'_>],
    size: f64,
    parts: &mut Vec<(Piece, Vec<usize>)>,
) {
    loop {
        let open = conditions[decided..].iter().enumerate();
        let mut open = open.filter_map(|(k, condition)| Some((k, condition.first_open(&signs)?)));
        let Some((before, curve)) = open.next() else {
            let holds = |k: &usize| conditions[*k].decided(&signs) == Some(true);
            parts.push((piece, (0..conditions.len()).filter(holds).collect()));
            return;
        };
        decided += before;
        match piece.cut(Cutter { shapes, curve, size }) {
            Cut::Both(below, above) => {
                for (part, sign) in [(below, NEGATIVE), (above, POSITIVE)] {
                    signs[curve] = sign;
                    if let Some(part) = part {
                        divide(part, (signs.clone(), decided), conditions, shapes, size, parts);
                    }
                }
                return;
            }
            Cut::Nothing => return,
            Cut::Above => signs[curve] = POSITIVE,
            Cut::Below => signs[curve] = NEGATIVE,
        }
    }
}

/// Which parts of a partition and which conditions have points in common.
pub(crate) struct Overlay {
    /// Part and condition.
    pub(crate) pairs: Vec<(usize, usize)>,
    /// A point that no condition holds at.
    pub(crate) bare: Option<Point>,
    /// Two conditions and a point where both hold.
    pub(crate) double: Option<(usize, usize, Point)>,
}

/// Lays conditions over cells of parts. What may lie between a curve and its chord counts if a point of it is clearly inside.
pub(crate) fn overlay(
    cells: &[Cell],
    parts: &[&Formula],
    conditions: &[Formula],
    shapes: &[Shape<'_>],
    size: f64,
) -> Overlay {
    let mut found = Overlay { pairs: Vec::new(), bare: None, double: None };
    // On both sides of every curve that a point is as good as on.
    let inside = |formula: &Formula, p: Point| {
        let value = |curve: usize, sign: f64| match shapes[curve].side(p, size) {
            0 => sign,
            _ => shapes[curve].value(p),
        };
        [-1.0, 1.0].into_iter().all(|sign| formula.holds(&|curve| value(curve, sign)))
    };
    for cell in cells {
        let whole = piece(cell, Some(cell.part), shapes, size);
        for (part, holding) in divided(whole, conditions, shapes, size) {
            let middle = part.middle();
            if part.is_sliver() {
                let Some(first) = holding.first() else { continue };
                let both = [parts[cell.part], &conditions[*first]];
                let clear = |p: &Point| both.into_iter().all(|formula| inside(formula, *p));
                if !part.chords().any(|p| clear(&p)) {
                    continue;
                }
            }
            match holding.as_slice() {
                [] => found.bare = found.bare.or(Some(middle)),
                [first, rest @ ..] => {
                    if let (Some(second), None) = (rest.first(), found.double) {
                        found.double = Some((*first, *second, middle));
                    }
                    let pair = (cell.part, *first);
                    if !found.pairs.contains(&pair) {
                        found.pairs.push(pair);
                    }
                }
            }
        }
    }
    found.pairs.sort_by_key(|(part, condition)| (*condition, *part));
    found
}

/// Curves as shapes about the middle of an outline's box, and the box's diagonal.
pub(crate) fn shapes<'g>(
    graph: &'g Graph,
    curves: &[Curve],
    outline: &[Segment],
) -> (Vec<Shape<'g>>, f64) {
    let [low, high] = reach(outline);
    let middle = [0, 1].map(|k| low[k] / 2.0 + high[k] / 2.0);
    let mut polynomials = Polynomials::default();
    let shape = |curve: &Curve| Shape::new(graph, curve.value, middle, &mut polynomials);
    (curves.iter().map(shape).collect(), norm(minus(high, low)))
}
