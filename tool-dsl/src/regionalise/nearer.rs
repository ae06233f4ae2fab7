//! Conditions for one of two features to be nearer, without square roots as far as possible.

use super::curve::Test;
use super::section::{Feature, Section};
use crate::expr::polynomial::Polynomial;
use crate::expr::{Coord, Graph, Id};
use crate::geometry::outline::{self, ExactCircle, ExactPoint, minus};
use crate::number::Number;
use touchoff_plane::Circle;

/// The sine below which two lines are compared by their distances: where they meet is too far away to be divided at.
const NEARLY_PARALLEL_SINE: f64 = 1e-3;

/// The distance, in sizes, within which lines and circles touch. Depth errs by no more if they are taken to do so.
const TOUCHING: f64 = 1e-13;

/// The kind of a feature, in a comparison of distances.
enum Kind<'o> {
    Line(usize),
    Point(&'o ExactPoint),
    Arc(&'o ExactCircle),
    /// An arc too flat to be compared by squares.
    Flat,
}

impl Section<'_> {
    fn kind(&self, feature: usize) -> Kind<'_> {
        match self.features[feature] {
            Feature::Corner(previous) => Kind::Point(self.corner(previous)),
            Feature::Piece(piece) => match &self.outline[piece].circle {
                None => Kind::Line(piece),
                Some(circle) if self.is_flat(circle) => Kind::Flat,
                Some(circle) => Kind::Arc(circle),
            },
        }
    }

    /// Returns the condition for one feature to be no farther than another, for points inside.
    ///
    /// Squares are compared instead of roots, in coordinates about the corner or centre, so that nothing large cancels.
    /// Below, `A = |p - c|²` for the first corner or centre, `B` is the same for the other, `l` the distance to a line,
    /// and `r` a radius.
    pub(super) fn nearer(&self, graph: &mut Graph, this: usize, other: usize) -> Option<Test> {
        if let Some(nearer) = self.always_nearer(this, other) {
            return Some(Test::Const(nearer == this));
        }
        Some(match (self.kind(this), self.kind(other)) {
            (Kind::Line(a), Kind::Line(b)) => Test::AtMost(self.bisector(graph, a, b)?),
            (Kind::Point(p), Kind::Point(q)) => {
                let (a, b) =
                    (outline::squared_distance(graph, p), outline::squared_distance(graph, q));
                let difference = graph.sub(a, b);
                Test::AtMost(expanded(graph, difference))
            }
            // A corner is nearer than a line where `A ≤ l²`.
            (Kind::Point(q), Kind::Line(line)) => Test::AtMost(self.parabola(graph, q, line)?),
            (Kind::Line(line), Kind::Point(q)) => {
                let parabola = self.parabola(graph, q, line)?;
                Test::AtMost(graph.neg(parabola))
            }
            // A concave arc is nearer than a line where `A ≤ (l + r)²`, a convex one where `l ≥ r` or `(r - l)² ≤ A`.
            (Kind::Arc(arc), Kind::Line(line)) => {
                let corner = self.joint(this, other);
                self.compare_arc_and_line(graph, arc, line, corner, true)?
            }
            (Kind::Line(line), Kind::Arc(arc)) => {
                let corner = self.joint(this, other);
                self.compare_arc_and_line(graph, arc, line, corner, false)?
            }
            // An arc is nearer than a corner where `L = r² + A - B ≤ 0` or `L² ≤ 4 r² A`.
            (Kind::Arc(arc), Kind::Point(q)) if self.is_accurate_by_squares(arc, q) => {
                compare_arc_and_point(graph, arc, q, true)?
            }
            (Kind::Point(q), Kind::Arc(arc)) if self.is_accurate_by_squares(arc, q) => {
                compare_arc_and_point(graph, arc, q, false)?
            }
            (Kind::Arc(arc), Kind::Point(q)) => compare_nearby_arc(graph, arc, q, true)?,
            (Kind::Point(q), Kind::Arc(arc)) => compare_nearby_arc(graph, arc, q, false)?,
            (Kind::Arc(a), Kind::Arc(b)) if self.are_accurate_by_squares(a, b) => {
                compare_arcs(graph, a, b)?
            }
            _ => {
                let (a, b) = (self.depth(graph, this)?, self.depth(graph, other)?);
                Test::AtMost(graph.sub(a, b))
            }
        })
    }

    /// Returns which of two features is nearer everywhere, if their lines or circles touch so that one is: the border is a line on
    /// which both are equally near, and the difference of squares would be a square, the sign of which is rounding.
    fn always_nearer(&self, a: usize, b: usize) -> Option<usize> {
        // A corner is a concave arc without a radius.
        let circle = |feature: usize| match self.kind(feature) {
            Kind::Line(_) | Kind::Flat => None,
            Kind::Point(p) => Some(Circle::concave(outline::doubles(p), 0.0)),
            Kind::Arc(arc) => Some(Circle {
                centre: outline::doubles(&arc.centre),
                radius: arc.radius.to_f64(),
                convex: arc.convex,
            }),
        };
        let is_rounding = |difference: f64| difference.abs() <= TOUCHING * self.size;
        if self.joint(a, b).is_some() {
            return None;
        }
        match (circle(a), circle(b)) {
            (Some(one), Some(other)) => {
                let between = outline::norm(minus(one.centre, other.centre));
                let difference = one.radius - other.radius;
                // A circle touches the other from inside, or two from outside.
                let (touching, is_first) = match (one.convex, other.convex) {
                    (true, true) => (difference.abs(), difference < 0.0),
                    (false, false) => (difference.abs(), difference > 0.0),
                    _ => (one.radius + other.radius, one.convex),
                };
                let touch = is_rounding(between - touching) && !is_rounding(between);
                touch.then_some(if is_first { a } else { b })
            }
            (Some(Circle { centre, radius, convex }), None)
            | (None, Some(Circle { centre, radius, convex })) => {
                let (round, line) = if circle(a).is_some() { (a, b) } else { (b, a) };
                if !matches!(self.kind(line), Kind::Line(_)) {
                    return None;
                }
                let height = self.depth_at(line, centre);
                let touch = is_rounding(height - if convex { radius } else { -radius });
                touch.then_some(if convex { round } else { line })
            }
            (None, None) => None,
        }
    }

    /// Returns the difference of two lines' distances. If neither line is oblique, its terms are exact. Otherwise it is
    /// computed from the intersection of the lines, since its constant would be the sum of two offsets.
    fn bisector(&self, graph: &mut Graph, a: usize, b: usize) -> Option<Id> {
        let [first, second] = [a, b].map(|piece| &self.outline[piece]);
        let ([ad, az], [bd, bz]) = (first.direction()?, second.direction()?);
        let is_axis_parallel =
            [&ad, &az, &bd, &bz].into_iter().filter(|part| part.is_zero()).count() == 2;
        let sine = &(&ad * &bz) - &(&az * &bd);
        // Neighbours meet at their joint, however little they turn there.
        let joint = match (a.abs_diff(b) == 1, a < b) {
            (true, true) => Some(first.to.clone()),
            (true, false) => Some(second.to.clone()),
            _ => None,
        };
        let is_nearly_parallel = joint.is_none() && sine.to_f64().abs() < NEARLY_PARALLEL_SINE;
        if is_axis_parallel || is_nearly_parallel {
            let (a, b) = (first.depth(graph)?, second.depth(graph)?);
            let difference = graph.sub(a, b);
            return Some(if is_axis_parallel { expanded(graph, difference) } else { difference });
        }
        let crossing = || {
            let offset = [0, 1].map(|k| &second.from[k] - &first.from[k]);
            let along = (&(&offset[0] * &bz) - &(&offset[1] * &bd)).checked_div(&sine)?;
            let along = [&ad, &az].map(|direction| direction * &along);
            Some([0, 1].map(|k| &first.from[k] + &along[k]))
        };
        let intersection = match joint {
            Some(joint) => joint,
            None => crossing()?,
        };
        // Normals are the directions turned left.
        Some(outline::anchored(graph, [&bz - &az, &ad - &bd], &intersection))
    }

    /// Returns `|p - q|² - l²`. For a line parallel to an axis of coordinates, one square cancels.
    fn parabola(&self, graph: &mut Graph, q: &ExactPoint, line: usize) -> Option<Id> {
        let segment = &self.outline[line];
        let [tx, tz] = segment.direction()?;
        let normal = [-&tz, tx];
        let offset = [0, 1].map(|k| &q[k] - &segment.from[k]);
        let height = &(&normal[0] * &offset[0]) + &(&normal[1] * &offset[1]);
        let offsets = [Coord::D, Coord::Z].map(|coord| graph.coord(coord));
        let offsets = [0, 1].map(|k| {
            let coordinate = graph.number(q[k].clone());
            graph.sub(offsets[k], coordinate)
        });
        for k in 0..2 {
            if normal[1 - k].is_zero() {
                // l = here ± u, so u² + v² - l² = v² - here · (here ± 2 u).
                let square = graph.mul(offsets[1 - k], offsets[1 - k]);
                let slope = graph.number(&(&height * &normal[k]) * &Number::int(2));
                let (rise, constant) =
                    (graph.mul(slope, offsets[k]), graph.number(&height * &height));
                let line = graph.add(rise, constant);
                return Some(graph.sub(square, line));
            }
        }
        let (squared_distance, depth) =
            (outline::squared_distance(graph, q), segment.depth(graph)?);
        let square = graph.mul(depth, depth);
        Some(graph.sub(squared_distance, square))
    }

    /// Returns the common corner of two features' segments, if they are adjacent.
    fn joint(&self, a: usize, b: usize) -> Option<&ExactPoint> {
        let (Feature::Piece(a), Feature::Piece(b)) = (self.features[a], self.features[b]) else {
            return None;
        };
        (a.abs_diff(b) == 1).then(|| &self.outline[a.min(b)].to)
    }

    fn compare_arc_and_line(
        &self,
        graph: &mut Graph,
        arc: &ExactCircle,
        line: usize,
        joint: Option<&ExactPoint>,
        nearer: bool,
    ) -> Option<Test> {
        let depth = self.outline[line].depth(graph)?;
        let radius = graph.number(arc.radius.clone());
        let squared_distance = outline::squared_distance(graph, &arc.centre);
        // The radius minus the signed distance to the line for a convex arc; their sum for a concave one.
        let offset_distance =
            if arc.convex { graph.sub(radius, depth) } else { graph.add(depth, radius) };
        let square = graph.mul(offset_distance, offset_distance);
        let mut difference = graph.sub(squared_distance, square);
        // Near the common corner both squares are nearly equal, and their difference would be rounding.
        if let Some(joint) = joint {
            difference =
                difference_from_common_corner(graph, arc, self.outline[line].direction()?, joint);
        }
        let opposite = graph.neg(difference);
        let (less, more) = if nearer { (difference, opposite) } else { (opposite, difference) };
        if !arc.convex {
            return Some(Test::AtMost(less));
        }
        let edge = if nearer { offset_distance } else { graph.neg(offset_distance) };
        // Squares compare `r - l` with the root only where it is not negative; elsewhere `l > r`, and the arc is
        // nearer.
        let tests = vec![Test::AtMost(edge), Test::AtMost(more)];
        Some(if nearer { Test::Any(tests) } else { Test::All(tests) })
    }

    /// Returns whether an arc and a corner can be compared by squares accurately enough. The error of `L - 2 r √A` is a
    /// rounding error of `r²`; the error of the distances is that divided by their sum.
    fn is_accurate_by_squares(&self, arc: &ExactCircle, q: &ExactPoint) -> bool {
        let radius = arc.radius.to_f64();
        let offset = minus(outline::doubles(q), outline::doubles(&arc.centre));
        let gap = (outline::norm(offset) - radius).abs();
        radius * radius <= 0.25 * self.size * gap
    }

    /// Returns the same for two arcs. If their convexity differs, the smaller radius is a lower bound of the sum of the
    /// distances.
    fn are_accurate_by_squares(&self, a: &ExactCircle, b: &ExactCircle) -> bool {
        let [a_radius, b_radius] = [a, b].map(|arc| arc.radius.to_f64());
        let sum = a_radius + b_radius;
        a.convex == b.convex || sum * sum <= 0.25 * self.size * a_radius.min(b_radius)
    }
}

/// Compares an arc with a corner by `(r - √A)² ≤ B`, with the root that the arc's depth needs anyway. With `nearer`,
/// the condition is for the arc to be nearer, otherwise for the corner.
fn compare_nearby_arc(
    graph: &mut Graph,
    arc: &ExactCircle,
    q: &ExactPoint,
    nearer: bool,
) -> Option<Test> {
    let distance = outline::distance(graph, &arc.centre)?;
    let radius = graph.number(arc.radius.clone());
    let depth = if arc.convex { graph.sub(radius, distance) } else { graph.sub(distance, radius) };
    let square = graph.mul(depth, depth);
    let corner = outline::squared_distance(graph, q);
    Some(Test::AtMost(ordered(graph, square, corner, nearer)))
}

/// Returns `A - (r ∓ l)²` of a convex or concave arc and a line along `t` that begins or ends at the arc's end `q`.
fn difference_from_common_corner(
    graph: &mut Graph,
    arc: &ExactCircle,
    [td, tz]: [Number; 2],
    q: &ExactPoint,
) -> Id {
    // With `w = p - q` and the line's normal `n` it is `(t · w)² + 2 (q - c ± r n) · w`. Near the corner its rounding
    // error is negligible, whatever the radius.
    let radius = if arc.convex { arc.radius.clone() } else { -&arc.radius };
    // The normal is the direction turned left.
    let normal = [-&tz, td.clone()];
    let rise = [0, 1].map(|k| &(&q[k] - &arc.centre[k]) + &(&radius * &normal[k]));
    let rise = outline::anchored(graph, rise.map(|part| &part * &Number::int(2)), q);
    let along = outline::anchored(graph, [td, tz], q);
    let square = graph.mul(along, along);
    graph.add(square, rise)
}

/// Returns the difference as an expanded polynomial, so that squares which cancel are not subtracted at every point.
fn expanded(graph: &mut Graph, difference: Id) -> Id {
    match Polynomial::from_expression(graph, difference) {
        Some(polynomial) => polynomial.to_expression(graph),
        None => difference,
    }
}

/// Returns `a - b`, or `b - a` if not `forward`.
fn ordered(graph: &mut Graph, a: Id, b: Id, forward: bool) -> Id {
    if forward { graph.sub(a, b) } else { graph.sub(b, a) }
}

/// Returns the condition `edge ≤ 0` or `a ≤ b`; if not `positive`, `edge ≥ 0` and `a ≥ b`.
fn any_or_all(graph: &mut Graph, edge: Id, a: Id, b: Id, positive: bool) -> Test {
    let curve = ordered(graph, a, b, positive);
    let edge = if positive { edge } else { graph.neg(edge) };
    let tests = vec![Test::AtMost(edge), Test::AtMost(curve)];
    if positive { Test::Any(tests) } else { Test::All(tests) }
}

/// Returns `|p - a|² - |p - b|² + extra` as a linear expression.
fn linear_difference(
    graph: &mut Graph,
    a: &ExactPoint,
    b: &ExactPoint,
    extra: &Number,
) -> Option<Id> {
    let two = Number::int(2);
    let direction = [0, 1].map(|k| &two * &(&b[k] - &a[k]));
    let squared_length = &(&direction[0] * &direction[0]) + &(&direction[1] * &direction[1]);
    let rise = outline::linear(graph, direction, a)?;
    let constant = graph.number(extra - &(&squared_length / &Number::int(4)));
    Some(graph.add(rise, constant))
}

fn compare_arc_and_point(
    graph: &mut Graph,
    arc: &ExactCircle,
    q: &ExactPoint,
    nearer: bool,
) -> Option<Test> {
    let square = &arc.radius * &arc.radius;
    let linear_difference = linear_difference(graph, &arc.centre, q, &square)?;
    let (left, right) = comparison_of_squares(graph, linear_difference, &arc.radius, &arc.centre);
    Some(any_or_all(graph, linear_difference, left, right, nearer))
}

/// Returns the two sides of `lead² ≤ 4 t² |p - c|²`.
fn comparison_of_squares(
    graph: &mut Graph,
    linear_difference: Id,
    t: &Number,
    centre: &ExactPoint,
) -> (Id, Id) {
    let left = graph.mul(linear_difference, linear_difference);
    let factor = graph.number(&(t * t) * &Number::int(4));
    let squared_distance = outline::squared_distance(graph, centre);
    (left, graph.mul(factor, squared_distance))
}

/// Returns the condition for one arc to be no farther than another.
fn compare_arcs(graph: &mut Graph, this: &ExactCircle, other: &ExactCircle) -> Option<Test> {
    if this.convex != other.convex {
        let (first, second) = if this.convex { (this, other) } else { (other, this) };
        let sum = &first.radius + &second.radius;
        let linear_difference =
            linear_difference(graph, &first.centre, &second.centre, &(&sum * &sum))?;
        let (left, right) = comparison_of_squares(graph, linear_difference, &sum, &first.centre);
        // With `T = r₁ + r₂` and `L = T² + A - B`, the convex one is nearer where `L ≤ 0` or `L² ≤ 4 T² A`.
        return Some(any_or_all(graph, linear_difference, left, right, this.convex));
    }
    let swapped = this.radius > other.radius;
    let (first, second) = if swapped { (other, this) } else { (this, other) };
    let difference = &second.radius - &first.radius;
    let square = &difference * &difference;
    let linear_difference = linear_difference(graph, &second.centre, &first.centre, &-&square)?;
    // With `D = r₂ - r₁ ≥ 0` and `M = B - A - D²`, the second of two convex arcs is nearer where `M ≥ 0` and
    // `M² ≥ 4 D² A`, the second of two concave ones where `M ≤ 0` or `M² ≤ 4 D² A`.
    let positive = swapped != this.convex;
    // With equal radii the bisector is a line.
    if difference.is_zero() {
        return Some(Test::AtMost(if positive {
            linear_difference
        } else {
            graph.neg(linear_difference)
        }));
    }
    let (left, right) = comparison_of_squares(graph, linear_difference, &difference, &first.centre);
    Some(any_or_all(graph, linear_difference, left, right, positive))
}
