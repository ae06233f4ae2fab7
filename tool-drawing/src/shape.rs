//! A region on the sheet: its outline, point queries, and the position with most room.

use super::section::Polygon;
use super::view::View;
use touchoff_plane::{Point, cross, dot, minus, norm};

/// The number of squares that are divided in search of the point with most room.
const MAX_SQUARES: usize = 300;

/// An area of the sheet within polygons.
pub(super) struct Shape {
    pub(super) polygons: Vec<Polygon>,
    /// The sides of the polygons, and other lines that nothing may cross.
    lines: Vec<[Point; 2]>,
}

/// A bounding box on the sheet, as lowest and highest coordinates.
pub(super) type Frame = [Point; 2];

impl Shape {
    /// Returns an area of a section on the sheet.
    pub(super) fn new(polygons: &[Polygon], view: &View) -> Shape {
        let mut shape = Shape { polygons: Vec::new(), lines: Vec::new() };
        for polygon in polygons {
            let polygon: Polygon = polygon.iter().map(|p| view.to_sheet(*p)).collect();
            let mut before = polygon[polygon.len() - 1];
            for p in &polygon {
                shape.lines.push([before, *p]);
                before = *p;
            }
            shape.polygons.push(polygon);
        }
        shape
    }

    /// Adds lines that nothing may cross, all of them horizontal.
    pub(super) fn keep_off(&mut self, lines: impl IntoIterator<Item = [Point; 2]>) {
        self.lines.extend(lines);
    }

    /// Returns whether the shape is empty.
    pub(super) fn is_empty(&self) -> bool {
        self.polygons.is_empty()
    }

    /// Returns the bounding box.
    pub(super) fn frame(&self) -> Frame {
        let mut frame = [[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]];
        for p in self.polygons.iter().flatten() {
            for k in 0..2 {
                frame[0][k] = frame[0][k].min(p[k]);
                frame[1][k] = frame[1][k].max(p[k]);
            }
        }
        frame
    }

    /// Returns the area, in squared sheet units.
    pub(super) fn area(&self) -> f64 {
        let mut twice = 0.0;
        for polygon in &self.polygons {
            for k in 0..polygon.len() {
                twice += cross(polygon[k], polygon[(k + 1) % polygon.len()]);
            }
        }
        twice.abs() / 2.0
    }

    /// Returns the signed distance of a point from the outline, positive inside. Horizontal distances are multiplied by
    /// `across`.
    pub(super) fn clearance(&self, p: Point, across: f64) -> f64 {
        let scaled = |q: Point| [q[0] * across, q[1]];
        let mut nearest = f64::INFINITY;
        let mut inside = false;
        let at = scaled(p);
        for line in &self.lines {
            let [a, b] = line.map(scaled);
            if (a[1] > at[1]) != (b[1] > at[1]) {
                let crossing = a[0] + (at[1] - a[1]) / (b[1] - a[1]) * (b[0] - a[0]);
                inside ^= at[0] < crossing;
            }
            nearest = nearest.min(distance(at, a, b));
        }
        if inside { nearest } else { -nearest }
    }

    /// Returns the point farthest inside, to half a unit of the sheet, and its distance from the outline. Horizontal
    /// distances are multiplied by `across`. The method is Mapbox's pole of inaccessibility.
    pub(super) fn pole(&self, across: f64) -> (Point, f64) {
        let [low, high] = self.frame();
        let middle = [0, 1].map(|k| f64::midpoint(low[k], high[k]));
        // The distance from a square's centre to its corner, relative to half its side.
        let corner = (1.0 + across * across).sqrt();
        let mut best = (middle, self.clearance(middle, across));
        // Squares, each with an upper bound of the distance, its centre, and half its side.
        let half = (high[0] - low[0]).max(high[1] - low[1]) / 2.0;
        let mut squares: Vec<(f64, Point, f64)> = vec![(f64::INFINITY, middle, half)];
        for _ in 0..MAX_SQUARES {
            let most = (0..squares.len()).max_by(|a, b| squares[*a].0.total_cmp(&squares[*b].0));
            let Some(index) = most else { break };
            let (upper_bound, p, half) = squares.swap_remove(index);
            if upper_bound <= best.1 + 0.5 {
                break;
            }
            let h = half / 2.0;
            for offset in [[-h, -h], [h, -h], [-h, h], [h, h]] {
                let q = [p[0] + offset[0], p[1] + offset[1]];
                let clearance = self.clearance(q, across);
                // Of points with as much room, the middle is the first.
                if clearance > best.1 + 0.01 {
                    best = (q, clearance);
                }
                squares.push((clearance + h * corner, q, h));
            }
        }
        best
    }

    /// Returns whether a box lies entirely inside.
    pub(super) fn contains(&self, [low, high]: Frame) -> bool {
        let middle = [(low[0] + high[0]) / 2.0, (low[1] + high[1]) / 2.0];
        self.clearance(middle, 1.0) > 0.0
            && !self.lines.iter().any(|line| crosses(*line, [low, high]))
    }

    /// Returns the segments of hatch lines inside the shape. The lines have the equation `x + y = c`, with `c` in steps
    /// of `step`.
    pub(super) fn hatched(&self, step: f64) -> Vec<[Point; 2]> {
        let [low, high] = self.frame();
        let mut c = ((low[0] + low[1]) / step).ceil() * step;
        let mut hatches = Vec::new();
        while c < high[0] + high[1] {
            let mut crossings: Vec<f64> = Vec::new();
            for [a, b] in &self.lines {
                let (u, v) = (a[0] + a[1] - c, b[0] + b[1] - c);
                if (u > 0.0) != (v > 0.0) {
                    crossings.push(a[0] + u / (u - v) * (b[0] - a[0]));
                }
            }
            crossings.sort_by(f64::total_cmp);
            hatches.extend(crossings.chunks_exact(2).map(|x| [[x[0], c - x[0]], [x[1], c - x[1]]]));
            c += step;
        }
        hatches
    }
}

/// Returns the distance of a point from a line segment.
fn distance(p: Point, a: Point, b: Point) -> f64 {
    let (direction, q) = (minus(b, a), minus(p, a));
    let share = (dot(q, direction) / dot(direction, direction)).clamp(0.0, 1.0);
    let share = if share.is_nan() { 0.0 } else { share };
    norm([q[0] - share * direction[0], q[1] - share * direction[1]])
}

/// Returns whether a line segment meets a box (Liang and Barsky 1984).
fn crosses([a, b]: [Point; 2], [low, high]: Frame) -> bool {
    let direction = minus(b, a);
    let (mut enter, mut leave) = (0.0f64, 1.0f64);
    for k in 0..2 {
        if direction[k] == 0.0 {
            if a[k] < low[k] || a[k] > high[k] {
                return false;
            }
            continue;
        }
        let (u, v) = ((low[k] - a[k]) / direction[k], (high[k] - a[k]) / direction[k]);
        enter = enter.max(u.min(v));
        leave = leave.min(u.max(v));
    }
    enter <= leave
}
