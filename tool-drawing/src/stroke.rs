//! Strokes: the lines and arcs of a drawing.

use std::f64::consts::PI;
use touchoff_dsl::vector::{Point, cross, dot, minus, norm};

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

    /// Returns the stroke in the opposite direction.
    pub(super) fn reversed(self) -> Stroke {
        Stroke { from: self.to, to: self.from, ..self }
    }

    /// Returns whether an arc turns left, with the second coordinate pointing up.
    pub(super) fn left(&self) -> bool {
        self.circle.is_some_and(|(centre, _)| {
            cross(minus(self.from, centre), minus(self.to, centre)) > 0.0
        })
    }

    /// Returns the angle that an arc turns by, 0 for a line.
    fn turn(&self) -> f64 {
        self.circle.map_or(0.0, |(centre, _)| {
            let (a, b) = (minus(self.from, centre), minus(self.to, centre));
            cross(a, b).atan2(dot(a, b))
        })
    }

    /// Returns the point at a fraction of the length.
    pub(super) fn at(&self, share: f64) -> Point {
        let Some((centre, _)) = self.circle else {
            return [0, 1].map(|k| self.from[k] + share * (self.to[k] - self.from[k]));
        };
        let (sin, cos) = (share * self.turn()).sin_cos();
        let a = minus(self.from, centre);
        [centre[0] + a[0] * cos - a[1] * sin, centre[1] + a[0] * sin + a[1] * cos]
    }

    /// Returns the length.
    pub(super) fn length(&self) -> f64 {
        self.circle
            .map_or(norm(minus(self.to, self.from)), |(_, radius)| radius * self.turn().abs())
    }

    /// Returns points along the stroke except the last, such that the chords deviate by at most `flat`.
    pub(super) fn points(&self, flat: f64) -> Vec<Point> {
        let Some((_, radius)) = self.circle else { return vec![self.from] };
        let max_angle = 2.0 * (1.0 - flat / radius).clamp(0.0, 1.0).acos();
        let count = (self.turn().abs() / max_angle).ceil().clamp(1.0, 64.0) as usize;
        (0..count).map(|k| self.at(k as f64 / count as f64)).collect()
    }

    /// Returns the lowest and highest second coordinate.
    pub(super) fn span(&self) -> [f64; 2] {
        let mut span = [self.from[1].min(self.to[1]), self.from[1].max(self.to[1])];
        if let Some((centre, radius)) = self.circle {
            for (k, end) in [(0, centre[1] - radius), (1, centre[1] + radius)] {
                let top = minus([centre[0], end], centre);
                let ends = [minus(self.from, centre), minus(self.to, centre)];
                let [a, b] = if self.left() { ends } else { [ends[1], ends[0]] };
                if cross(a, top) >= 0.0 && cross(top, b) >= 0.0 {
                    span[k] = end;
                }
            }
        }
        span
    }

    /// Returns the lowest and highest first coordinate.
    pub(super) fn breadth(&self) -> [f64; 2] {
        let turned = |[d, z]: Point| [-z, d];
        let circle = self.circle.map(|(centre, radius)| (turned(centre), radius));
        let turned = Stroke { from: turned(self.from), to: turned(self.to), circle };
        turned.span()
    }

    /// Returns the largest first coordinate.
    pub(super) fn widest(&self) -> f64 {
        self.breadth()[1]
    }
}

/// Returns the circle through three points, unless they are almost collinear.
fn circle([a, b, c]: [Point; 3]) -> Option<(Point, f64)> {
    let (u, v) = (minus(b, a), minus(c, a));
    let double_cross = 2.0 * cross(u, v);
    let (uu, vv) = (dot(u, u), dot(v, v));
    let q = [(v[1] * uu - u[1] * vv) / double_cross, (u[0] * vv - v[0] * uu) / double_cross];
    let radius = norm(q);
    // Nearly collinear points fit a circle of any radius.
    let flat = radius > 1e4 * norm(v).max(norm(u));
    (radius.is_finite() && !flat).then_some(([a[0] + q[0], a[1] + q[1]], radius))
}

/// Returns the strokes of a row of points that lie on an arc, or `None`. `foot` projects a point onto the true curve.
pub(super) fn round(
    row: &[Point],
    mut foot: impl FnMut(Point) -> Point,
    near: f64,
) -> Option<Vec<Stroke>> {
    let last = row.len() - 1;
    let closed = row[0] == row[last];
    // The last point of a closed circle equals the first, so it gives no information.
    let step = if closed { 0.2 } else { 0.25 };
    let feet = [0.0, 1.0, 2.0, 3.0, 4.0].map(|steps| {
        let position = (steps * step * last as f64).min(last as f64);
        let k = (position.floor() as usize).min(last - 1);
        foot(Stroke::line(row[k], row[k + 1]).at(position - k as f64))
    });
    let (centre, radius) = circle([feet[0], feet[2], feet[4]])?;
    if feet.iter().any(|p| (norm(minus(*p, centre)) - radius).abs() > 10.0 * near) {
        return None;
    }
    let arc = |from: Point, to: Point| Stroke { from, to, circle: Some((centre, radius)) };
    let swept: f64 = row.windows(2).map(|pair| arc(pair[0], pair[1]).turn()).sum();
    // A stroke is less than half a circle.
    let parts = ((swept.abs() / (0.9 * PI)).ceil() as usize).max(1);
    // Each arc needs a row of points of its own.
    if parts > last {
        return None;
    }
    let ends: Vec<usize> = (0..=parts).map(|k| k * last / parts).collect();
    Some(ends.windows(2).map(|pair| arc(row[pair[0]], row[pair[1]])).collect())
}

/// Fits lines and arcs to a row of points, no farther than `tolerance` from any of them.
pub(super) fn fitted(row: &[Point], tolerance: f64) -> Vec<Stroke> {
    let last = row.len() - 1;
    let line = Stroke::line(row[0], row[last]);
    let chord = minus(row[last], row[0]);
    let length = norm(chord);
    let is_off = |p: &Point| cross(chord, minus(*p, row[0])).abs() > tolerance * length;
    if last == 1 || (length > 0.0 && !row.iter().any(is_off)) {
        return vec![line];
    }
    if length > 0.0
        && let Some((centre, radius)) = circle([row[0], row[last / 2], row[last]])
    {
        let stroke = Stroke { circle: Some((centre, radius)), ..line };
        let middles = row.windows(2).map(|pair| Stroke::line(pair[0], pair[1]).at(0.5));
        let less_than_half = stroke.turn().abs() < 0.9 * PI
            && norm(minus(stroke.at(0.5), row[last / 2])) < 0.5 * length + tolerance;
        if less_than_half
            && !row
                .iter()
                .copied()
                .chain(middles)
                .any(|p| (norm(minus(p, centre)) - radius).abs() > tolerance)
        {
            return vec![stroke];
        }
    }
    let middle = last / 2;
    let mut strokes = fitted(&row[..=middle], tolerance);
    strokes.extend(fitted(&row[middle..], tolerance));
    strokes
}
