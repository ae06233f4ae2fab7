//! Strokes: the lines and arcs of a drawing.

use std::f64::consts::PI;
use touchoff_plane::{Point, angle_between, cross, dot, minus, norm, turned};

/// The greatest angle of an arc that is made one stroke: less than half a circle, by more than rounding.
pub(super) const MAX_TURN: f64 = 0.9 * PI;

/// A line, or an arc of less than half a circle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Stroke {
    pub(super) from: Point,
    pub(super) to: Point,
    pub(super) circle: Option<(Point, f64)>,
}

impl Stroke {
    pub(super) fn line(from: Point, to: Point) -> Stroke {
        Stroke { from, to, circle: None }
    }

    /// Returns the mirror image in the axis.
    pub(super) fn mirrored(self) -> Stroke {
        let mirror = |[x, y]: Point| [-x, y];
        let circle = self.circle.map(|(centre, radius)| (mirror(centre), radius));
        Stroke { from: mirror(self.from), to: mirror(self.to), circle }
    }

    /// Returns whether an arc turns left, with the second coordinate pointing up.
    pub(super) fn left(&self) -> bool {
        self.turn() > 0.0
    }

    /// Returns the angle that an arc turns by, 0 for a line.
    pub(super) fn turn(&self) -> f64 {
        self.circle.map_or(0.0, |(centre, _)| {
            angle_between(minus(self.from, centre), minus(self.to, centre))
        })
    }

    /// Returns the point at a fraction of the length.
    pub(super) fn at(&self, share: f64) -> Point {
        let Some((centre, _)) = self.circle else {
            return [0, 1].map(|k| self.from[k] + share * (self.to[k] - self.from[k]));
        };
        let [x, y] = turned(minus(self.from, centre), share * self.turn());
        [centre[0] + x, centre[1] + y]
    }

    /// Returns the length.
    pub(super) fn length(&self) -> f64 {
        match self.circle {
            None => norm(minus(self.to, self.from)),
            Some((_, radius)) => radius * self.turn().abs(),
        }
    }

    /// Returns points along the stroke except the last, such that the chords deviate by at most `flat`.
    pub(super) fn points(&self, flat: f64) -> Vec<Point> {
        let Some((_, radius)) = self.circle else { return vec![self.from] };
        let max_angle = 2.0 * (1.0 - flat / radius).clamp(0.0, 1.0).acos();
        let count = (self.turn().abs() / max_angle).ceil().clamp(1.0, 64.0) as usize;
        (0..count).map(|k| self.at(k as f64 / count as f64)).collect()
    }

    /// Returns the lowest and highest coordinate along an axis of the plane.
    fn extent(&self, axis: usize) -> [f64; 2] {
        let [a, b] = [self.from[axis], self.to[axis]];
        let mut extent = [a.min(b), a.max(b)];
        if let Some((centre, radius)) = self.circle {
            let turn = self.turn();
            for (end, sign) in [-1.0, 1.0].into_iter().enumerate() {
                let mut outermost = [0.0; 2];
                outermost[axis] = sign;
                let [before, after] = [self.from, self.to].map(|p| minus(p, centre));
                let is_passed =
                    cross(before, outermost) * turn >= 0.0 && cross(outermost, after) * turn >= 0.0;
                if is_passed {
                    extent[end] = centre[axis] + sign * radius;
                }
            }
        }
        extent
    }

    /// Returns the lowest and highest second coordinate.
    pub(super) fn span(&self) -> [f64; 2] {
        self.extent(1)
    }

    /// Returns the lowest and highest first coordinate.
    pub(super) fn breadth(&self) -> [f64; 2] {
        self.extent(0)
    }

    /// Returns the largest first coordinate.
    pub(super) fn widest(&self) -> f64 {
        self.breadth()[1]
    }
}

/// Returns the circle through three points, unless they are almost collinear.
pub(super) fn circle([a, b, c]: [Point; 3]) -> Option<(Point, f64)> {
    let (u, v) = (minus(b, a), minus(c, a));
    let double_cross = 2.0 * cross(u, v);
    let (uu, vv) = (dot(u, u), dot(v, v));
    let q = [(v[1] * uu - u[1] * vv) / double_cross, (u[0] * vv - v[0] * uu) / double_cross];
    let radius = norm(q);
    // Nearly collinear points fit a circle of any radius.
    let flat = radius > 1e4 * norm(v).max(norm(u));
    (radius.is_finite() && !flat).then_some(([a[0] + q[0], a[1] + q[1]], radius))
}
