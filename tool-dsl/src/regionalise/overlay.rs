//! Divides the pieces of parts further, by conditions.

use super::pieces::Piece;
use super::section::Section;
use crate::formula::{Formula, Signs};
use crate::geometry::function::CurveFunction;
use crate::geometry::outline::Point;

/// A part where a condition holds, both as indices.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ConditionedPart {
    pub(crate) part: usize,
    pub(crate) condition: usize,
}

/// Conditions in order of precedence, with their curves.
pub(crate) struct Conditions<'a> {
    pub(crate) formulas: &'a [Formula],
    pub(crate) shapes: &'a [CurveFunction<'a>],
    /// The size of the section.
    pub(crate) size: f64,
}

impl Conditions<'_> {
    /// Divides a piece until one condition is known to be the first that holds. Returns each part of it with this condition;
    /// `None` where none holds.
    pub(crate) fn divided(&self, piece: Piece, tolerance: f64) -> Vec<(Piece, Option<usize>)> {
        let (mut pending, mut parts) = (vec![piece], Vec::new());
        while let Some(piece) = pending.pop() {
            let signs = |curve: usize| piece.signs_of(curve, &self.shapes[curve], tolerance);
            let decide = |formula: &Formula| formula.decide_with(&mut { signs });
            let first = self.formulas.iter().position(|formula| decide(formula) != Some(false));
            let Some(first) = first else {
                parts.push((piece, None));
                continue;
            };
            if decide(&self.formulas[first]) == Some(true) {
                parts.push((piece, Some(first)));
                continue;
            }
            let all: Vec<Signs> = (0..self.shapes.len()).map(signs).collect();
            let Some(curve) = self.formulas[first].first_undecided_curve(&all) else { continue };
            pending.extend(piece.halves(curve, self.shapes, tolerance).into_iter().flatten());
        }
        parts
    }

    /// Returns whether a point satisfies a condition, whatever the signs of curves within rounding of it; `None` if these
    /// decide.
    fn holds(&self, condition: usize, p: Point) -> Option<bool> {
        let with = |sign: f64| {
            self.formulas[condition].holds(&mut |curve: usize| match self.shapes[curve]
                .side(p, self.size)
            {
                0 => sign,
                _ => self.shapes[curve].value(p),
            })
        };
        let low = with(-1.0);
        (low == with(1.0)).then_some(low)
    }

    /// Returns the first condition that holds at a point, if rounding does not decide about it.
    pub(crate) fn first_at(&self, p: Point) -> Option<usize> {
        for condition in 0..self.formulas.len() {
            if self.holds(condition, p)? {
                return Some(condition);
            }
        }
        None
    }
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

/// Intersects conditions with the pieces of parts. What pieces have in common counts if a sampled point of it does.
pub(crate) fn overlay(
    section: &Section<'_>,
    pieces: Vec<Piece>,
    conditions: &Conditions<'_>,
) -> Overlay {
    let mut result = Overlay { parts: Vec::new(), uncovered: None, doubly_covered: None };
    for piece in pieces {
        let Some(part) = piece.owner else { continue };
        for (piece, first) in conditions.divided(piece, section.tolerance()) {
            let mut points: Vec<Point> =
                section.sample_points(&piece).into_iter().map(|(p, _)| p).collect();
            // A part of the piece may be small.
            let is_known = |condition| result.parts.contains(&ConditionedPart { part, condition });
            if first.is_none_or(|condition| !is_known(condition)) {
                points.extend(section.owned_points(&piece));
            }
            for p in points {
                let holding: Vec<Option<bool>> =
                    (0..conditions.formulas.len()).map(|k| conditions.holds(k, p)).collect();
                if holding.iter().all(|holds| *holds == Some(false)) {
                    result.uncovered = result.uncovered.or(Some(p));
                }
                let mut certain = (0..holding.len()).filter(|k| holding[*k] == Some(true));
                let Some(condition) = certain.next() else { continue };
                if let (Some(second), None) = (certain.next(), result.doubly_covered) {
                    result.doubly_covered = Some((condition, second, p));
                }
                // A condition before it that rounding decides may own the point.
                let part = ConditionedPart { part, condition };
                if holding[..condition].iter().all(Option::is_some) && !result.parts.contains(&part)
                {
                    result.parts.push(part);
                }
            }
        }
    }
    result.parts.sort_by_key(|part| (part.condition, part.part));
    result
}
