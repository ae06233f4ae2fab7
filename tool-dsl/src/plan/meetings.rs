//! Points where curves of a tree meet. There rounding decides on which side of each a point is, so that it may come to a leaf that
//! no other point near it has.

use super::Tree;
use super::cells::{Cells, INDIFFERENCE};
use crate::expr::interval::{Cell, Encloser, Interval};
use crate::expr::{Graph, Id};
use crate::formula::CurveIndex;
use crate::geometry::function::CurveFunction;
use crate::geometry::outline::{self, Point, dot, minus, norm};
use crate::geometry::polygon::{hull, range};
use crate::number::Number;
use crate::regionalise::pieces::Piece;
use std::collections::HashSet;
use std::rc::Rc;

/// The distance from the section's middle up to which meetings are looked for, in sizes.
const REACH: f64 = 8.0;
/// The diagonal of the boxes in which meetings are computed, in sizes.
const BOX_FRACTION: f64 = 1e-3;
/// The distance from the middle of a box up to which a meeting is the box's, in diagonals.
const NEAR_BOX: f64 = 2.0;
/// The side of the squares, in tolerances, of whose meetings one stands for all.
const SAME_MEETING: f64 = 0.03125;
/// The number of steps of Newton's method. Where curves touch, each halves the distance.
const MAX_STEPS: usize = 60;

/// A point to which a tree may give a wrong depth.
pub(super) struct WrongPoint {
    pub(super) piece: Rc<Piece>,
    /// The greatest loss at a leaf that it may reach.
    pub(super) loss: f64,
    /// The greatest error of depth there.
    pub(super) error: f64,
}

impl Cells<'_> {
    /// Returns the points where curves of a tree meet and rounding may lead to a leaf that is wrong.
    pub(super) fn wrong_meetings(&self, tree: &Tree) -> Vec<WrongPoint> {
        // Encloses what the tests of the tree compute at a point and the doubles about it.
        let mut encloser =
            Encloser::new(&self.model.graph, self.model.curves.iter().map(|curve| curve.value));
        let mut wrong: Vec<WrongPoint> = Vec::new();
        for p in self.meetings(tree) {
            let is_known =
                |known: &WrongPoint| norm(minus(known.piece.vertices[0], p)) <= self.tolerance;
            if wrong.iter().any(is_known) {
                continue;
            }
            let Some(piece) = self.geometry.point(p) else { continue };
            // Within what the point's pieces take for both sides of a curve; for it and all meetings that it stands for.
            let half = (0.5 + SAME_MEETING) * self.tolerance;
            let [d, z] = p.map(|x| Interval::new(x - half, x + half));
            encloser.set(Cell::half_plane(Interval::new(d.low.max(0.0), d.high), z));
            let (mut loss, mut error) = (0.0f64, 0.0f64);
            let mut sides = |curve: CurveIndex| match self.model.curves.get(curve) {
                Some(curve) => {
                    let values = encloser.get(curve.value);
                    [values.low <= 0.0, values.high >= 0.0]
                }
                None => self.shapes[curve].sides_over(&piece.vertices, self.tolerance),
            };
            tree.visit_leaves(&mut sides, &mut |owner| {
                loss = loss.max(self.loss(&piece, owner));
                error = error.max(self.depth_error(&piece, owner));
            });
            if loss > INDIFFERENCE * self.size {
                wrong.push(WrongPoint { piece: Rc::new(piece), loss, error });
            }
        }
        wrong
    }

    /// Returns the points where curves of a tree meet, and where one may meet itself, one of those in a square that is smaller than
    /// rounding. Boxes are halved until they are small; one that
    /// fewer than two curves cross, or with one owner, has no meeting that matters.
    fn meetings(&self, tree: &Tree) -> Vec<Point> {
        let (middle, reach) = (self.middle(), REACH * self.size);
        let mut points = Vec::new();
        let around = [[0.0, middle[1] - reach], [middle[0] + reach, middle[1] + reach]];
        // What is beside a curve stays there.
        let mut pending = vec![(around, vec![None; self.shapes.len()])];
        while let Some(([low, high], mut known)) = pending.pop() {
            let polygon = vec![low, [high[0], low[1]], high, [low[0], high[1]]];
            let mut owners = Vec::new();
            let mut sides = |curve: CurveIndex| {
                let sides = || self.shapes[curve].sides_over(&polygon, self.tolerance);
                *known[curve].get_or_insert_with(sides)
            };
            tree.visit_leaves(&mut sides, &mut |owner| owners.push(owner));
            if owners.iter().all(|owner| *owner == owners[0]) {
                continue;
            }
            let crossing: Vec<CurveIndex> =
                (0..known.len()).filter(|curve| known[*curve] == Some([true; 2])).collect();
            let stationary = |curve: &CurveIndex| self.shapes[*curve].stationary_point(&polygon);
            points.extend(crossing.iter().filter_map(stationary));
            if crossing.len() < 2 {
                continue;
            }
            let (diagonal, centre) =
                (minus(high, low), [0, 1].map(|k| f64::midpoint(low[k], high[k])));
            if norm(diagonal) > BOX_FRACTION * self.size {
                let axis = usize::from(diagonal[1] > diagonal[0]);
                let (mut end, mut start) = (high, low);
                (end[axis], start[axis]) = (centre[axis], centre[axis]);
                for curve in crossing {
                    known[curve] = None;
                }
                pending.extend([([low, end], known.clone()), ([start, high], known)]);
                continue;
            }
            for (k, one) in crossing.iter().enumerate() {
                let others =
                    crossing[..k].iter().filter_map(|other| self.meeting([*one, *other], centre));
                points.extend(
                    others.filter(|p| norm(minus(*p, centre)) <= NEAR_BOX * norm(diagonal)),
                );
            }
        }
        let side = SAME_MEETING * self.tolerance;
        let square = |p: &Point| p.map(|x| (x / side).round().to_bits());
        let mut squares = HashSet::new();
        points.retain(|p| squares.insert(square(p)));
        points
    }

    /// Returns a point where two curves meet, by Newton's method from a point near it.
    fn meeting(&self, curves: [CurveIndex; 2], mut p: Point) -> Option<Point> {
        // From anywhere the first step leads to where two lines meet, and the second mends its rounding.
        let are_lines = curves.into_iter().all(|curve| self.shapes[curve].is_line());
        for _ in 0..if are_lines { 2 } else { MAX_STEPS } {
            let [(one, [a, b]), (other, [c, d])] =
                curves.map(|curve| self.shapes[curve].value_and_gradient(p));
            let determinant = a * d - b * c;
            let step = [(one * d - other * b) / determinant, (other * a - one * c) / determinant];
            if !norm(step).is_finite() {
                break;
            }
            p = minus(p, step);
            if norm(step) <= f64::EPSILON * self.tolerance {
                break;
            }
        }
        // Rounding may lead beyond the axis.
        if p[0] < 0.0 && p[0] >= -self.tolerance {
            p[0] = 0.0;
        }
        let is_on = |curve: CurveIndex| {
            self.shapes[curve].sides_over(&vec![p], self.tolerance) == [true; 2]
        };
        (p[0] >= 0.0 && curves.into_iter().all(is_on)).then_some(p)
    }
}

impl Tree {
    /// Calls `leaf` for the owner of each leaf that may be reached, where `sides` says of a curve whether a point may be below it, and
    /// above.
    fn visit_leaves(
        &self,
        sides: &mut impl FnMut(CurveIndex) -> [bool; 2],
        leaf: &mut impl FnMut(Option<usize>),
    ) {
        match self {
            Tree::Leaf(owner) => leaf(*owner),
            Tree::Split { curve, below, above, .. } => {
                let [is_below, is_above] = sides(*curve);
                if is_below {
                    below.visit_leaves(sides, leaf);
                }
                if is_above {
                    above.visit_leaves(sides, leaf);
                }
            }
        }
    }
}

/// A straight line that a plan adds to the curves.
#[derive(PartialEq)]
pub(super) struct Line {
    normal: Point,
    from: Point,
}

/// A strip along a direction between a piece and others.
struct Gap {
    normal: Point,
    width: f64,
    /// The place along the normal where it meets the others.
    end: f64,
    /// The sign of the way from there to the piece.
    inward: f64,
}

impl Line {
    /// Returns a line in the widest gap between a piece and those of other owners, parallel to an axis or to a side of either's hull;
    /// `None` if they overlap, or there is none. It is near the others, since these have all points of their owners.
    pub(super) fn between(piece: &Piece, pieces: &[Rc<Piece>], tolerance: f64) -> Option<Line> {
        let at = piece.vertices[0];
        let others = pieces.iter().filter(|other| other.owner != piece.owner);
        let others: Vec<Point> = others.flat_map(|other| other.vertices.iter().copied()).collect();
        let around = hull(others.clone());
        let sides = [&around, &piece.vertices].into_iter().flat_map(|polygon| {
            (0..polygon.len()).map(|k| {
                let along = minus(polygon[(k + 1) % polygon.len()], polygon[k]);
                [-along[1], along[0]].map(|part| part / norm(along))
            })
        });
        let normals = [[1.0, 0.0], [0.0, 1.0]].into_iter().chain(sides);
        let gaps = normals.filter(|normal| normal[0].is_finite()).map(|normal| {
            let [own, other] = [&piece.vertices, &others]
                .map(|points| range(points.iter().map(|q| dot(normal, minus(*q, at)))));
            let (beyond, before) = (other[0] - own[1], own[0] - other[1]);
            if beyond > before {
                Gap { normal, width: beyond, end: other[0], inward: -1.0 }
            } else {
                Gap { normal, width: before, end: other[1], inward: 1.0 }
            }
        });
        let gap = gaps
            .filter(|gap| gap.width.is_finite())
            .max_by(|one, other| one.width.total_cmp(&other.width))?;
        // Neighbours have an edge in common.
        if gap.width < -tolerance || (piece.is_point() && gap.width <= 0.0) {
            return None;
        }
        let offset = gap.end + gap.inward * (gap.width / 2.0).min(tolerance);
        let from = [0, 1].map(|k| at[k] + offset * gap.normal[k]);
        Some(Line { normal: gap.normal, from })
    }

    pub(super) fn shape<'g>(&self) -> CurveFunction<'g> {
        CurveFunction::Line { middle: self.from, constant: 0.0, slope: self.normal }
    }

    /// Returns the signed distance from the line.
    pub(super) fn expression(&self, graph: &mut Graph) -> Id {
        let [normal, from] = [self.normal, self.from].map(|values| {
            values.map(|value| Number::from_f64(value).unwrap_or_else(|| Number::int(0)))
        });
        outline::anchored(graph, normal, &from)
    }
}
