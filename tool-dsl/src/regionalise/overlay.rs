//! Divides the pieces of parts further: by conditions, or by the nearest segments of the rounded outline.

use super::pieces::Piece;
use super::rounded::{Rounded, RoundedSection};
use super::section::Section;
use crate::formula::{Formula, Signs};
use crate::geometry::function::CurveFunction;
use crate::geometry::outline::Point;
use crate::geometry::polygon::area;
use std::collections::BTreeMap;

/// A further division of the parts of a profile's inside.
#[derive(Clone, Debug)]
pub(crate) enum Division {
    /// By conditions in order of precedence: a point belongs to the first that holds.
    Conditions(Vec<Formula>),
    /// By the nearest segments of the outline with rounded corners, each of which counts as a condition.
    Rounded(Rounded),
}

impl Division {
    /// Returns a condition by its index; true for a rounded outline, whose segments are told apart by their distances.
    pub(crate) fn condition(&self, index: usize) -> Formula {
        match self {
            Division::Conditions(formulas) => formulas[index].clone(),
            Division::Rounded(_) => Formula::Const(true),
        }
    }

    /// Sets the two distances that each curve between segments of a rounded outline compares.
    pub(crate) fn set_distances(&self, shapes: &mut [CurveFunction<'_>]) {
        if let Division::Rounded(rounded) = self {
            rounded.partition.set_distances(&rounded.separations, shapes);
        }
    }

    /// Returns the number of conditions.
    pub(crate) fn count(&self) -> usize {
        match self {
            Division::Conditions(formulas) => formulas.len(),
            Division::Rounded(rounded) => rounded.partition.outline.len(),
        }
    }
}

/// A part where a condition holds, both as indices.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ConditionedPart {
    pub(crate) part: usize,
    pub(crate) condition: usize,
}

/// A division with the curves of the tool.
pub(crate) enum PieceDivider<'a, 'g> {
    Conditions(Conditions<'a, 'g>),
    Rounded(RoundedPieces<'a, 'g>),
}

/// Conditions in order of precedence, with their curves.
pub(crate) struct Conditions<'a, 'g> {
    formulas: &'a [Formula],
    shapes: &'a [CurveFunction<'g>],
    /// The size of the section.
    size: f64,
}

/// The pieces of a rounded outline, with the curves between them.
pub(crate) struct RoundedPieces<'a, 'g> {
    section: RoundedSection<'a>,
    pieces: Vec<Piece>,
    shapes: &'a [CurveFunction<'g>],
}

impl<'a, 'g> PieceDivider<'a, 'g> {
    /// Prepares a division; `size` is the size of the section.
    pub(crate) fn new(
        division: &'a Division,
        shapes: &'a [CurveFunction<'g>],
        size: f64,
    ) -> PieceDivider<'a, 'g> {
        match division {
            Division::Conditions(formulas) => {
                PieceDivider::Conditions(Conditions { formulas, shapes, size })
            }
            Division::Rounded(rounded) => PieceDivider::Rounded(RoundedPieces {
                section: RoundedSection::new(rounded),
                pieces: rounded.pieces(shapes),
                shapes,
            }),
        }
    }

    /// Divides a piece until one condition is known to be the first that holds. Returns each part of it with this condition;
    /// `None` where none holds.
    pub(crate) fn divided(&self, piece: Piece, tolerance: f64) -> Vec<(Piece, Option<usize>)> {
        match self {
            PieceDivider::Conditions(conditions) => conditions.divided(piece, tolerance),
            PieceDivider::Rounded(rounded) => {
                let common = rounded.pieces.iter().filter_map(|other| {
                    let common = piece.common(other, rounded.shapes, tolerance)?;
                    Some((common, other.owner))
                });
                common.collect()
            }
        }
    }

    /// Returns the first condition that holds at a point, if rounding does not decide about it.
    pub(crate) fn first_at(&self, p: Point) -> Option<usize> {
        match self {
            PieceDivider::Conditions(conditions) => first_holding(conditions.holding(p)),
            PieceDivider::Rounded(rounded) => rounded.section.certainly_nearest(p),
        }
    }
}

impl Conditions<'_, '_> {
    fn divided(&self, piece: Piece, tolerance: f64) -> Vec<(Piece, Option<usize>)> {
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

    /// Returns for each condition whether it holds at a point.
    fn holding(&self, p: Point) -> impl Iterator<Item = Option<bool>> {
        (0..self.formulas.len()).map(move |condition| self.holds(condition, p))
    }
}

/// Returns the first condition that holds, unless rounding decides about it.
fn first_holding(holding: impl IntoIterator<Item = Option<bool>>) -> Option<usize> {
    for (condition, holds) in holding.into_iter().enumerate() {
        if holds? {
            return Some(condition);
        }
    }
    None
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

impl Overlay {
    /// Intersects conditions with the pieces of parts. What pieces have in common counts if a sampled point of it does, and the
    /// largest one of a part without sampled points.
    pub(crate) fn new(
        section: &Section<'_>,
        pieces: Vec<Piece>,
        divider: &PieceDivider<'_, '_>,
    ) -> Overlay {
        let mut overlay = Overlay { parts: Vec::new(), uncovered: None, doubly_covered: None };
        let mut largest: BTreeMap<usize, (f64, ConditionedPart)> = BTreeMap::new();
        for whole in pieces {
            let Some(part) = whole.owner else { continue };
            for (piece, first) in divider.divided(whole, section.tolerance()) {
                let first = first.map(|condition| ConditionedPart { part, condition });
                let mut points: Vec<Point> =
                    section.sample_points(&piece).into_iter().map(|(p, _)| p).collect();
                // A part of the piece may be small.
                if first.is_none_or(|first| !overlay.parts.contains(&first)) {
                    points.extend(section.owned_points(&piece));
                }
                for p in points {
                    let condition = match divider {
                        PieceDivider::Conditions(conditions) => {
                            let holding: Vec<Option<bool>> = conditions.holding(p).collect();
                            overlay.look_for_gaps_and_overlaps(&holding, p);
                            first_holding(holding)
                        }
                        PieceDivider::Rounded(_) => divider.first_at(p),
                    };
                    overlay.add(condition.map(|condition| ConditionedPart { part, condition }));
                }
                let size = area(&piece.vertices);
                if let Some(first) = first
                    && largest.get(&part).is_none_or(|(known, _)| size > *known)
                {
                    largest.insert(part, (size, first));
                }
            }
        }
        for (part, (_, first)) in largest {
            if overlay.parts.iter().all(|known| known.part != part) {
                overlay.parts.push(first);
            }
        }
        overlay.parts.sort_by_key(|part| (part.condition, part.part));
        overlay
    }

    fn add(&mut self, part: Option<ConditionedPart>) {
        self.parts.extend(part.filter(|part| !self.parts.contains(part)));
    }

    /// Notes a point that satisfies no condition or several.
    fn look_for_gaps_and_overlaps(&mut self, holding: &[Option<bool>], p: Point) {
        if holding.iter().all(|holds| *holds == Some(false)) {
            self.uncovered = self.uncovered.or(Some(p));
        }
        let mut certain = (0..holding.len()).filter(|k| holding[*k] == Some(true));
        if let (Some(first), Some(second)) = (certain.next(), certain.next()) {
            self.doubly_covered = self.doubly_covered.or(Some((first, second, p)));
        }
    }
}
