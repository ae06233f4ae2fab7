//! A region on the sheet: its outline, point queries, and the position with most room.

use super::section::Polygon;
use super::view::View;
use touchoff_dsl::vector::{Point, cross, dot, minus, norm};

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
        let size = (high[0] - low[0]).min(high[1] - low[1]).max(1e-3);
        let half = (size / 2.0).max((high[0] - low[0]).max(high[1] - low[1]) / 40.0);
        // The distance from a cell's centre to its corner, relative to half its side.
        let corner = (1.0 + across * across).sqrt();
        let middle = [(low[0] + high[0]) / 2.0, (low[1] + high[1]) / 2.0];
        let mut best = (middle, self.clearance(middle, across));
        let mut queue: Vec<(f64, Point, f64)> = Vec::new();
        let [columns, rows] =
            [0, 1].map(|k| ((high[k] - low[k]) / (2.0 * half)).ceil().max(1.0) as usize);
        let cells = (0..columns * rows).map(|n| [n % columns, n / columns]);
        let mut initial: Vec<(Point, f64)> = cells
            .map(|cell| ([0, 1].map(|k| low[k] + half * (2 * cell[k] + 1) as f64), half))
            .collect();
        for _ in 0..200 {
            for (p, half) in initial.drain(..) {
                let clearance = self.clearance(p, across);
                // Of points with as much room, the middle is the first.
                if clearance > best.1 + 0.01 {
                    best = (p, clearance);
                }
                queue.push((clearance + half * corner, p, half));
            }
            let Some(index) = (0..queue.len()).max_by(|a, b| queue[*a].0.total_cmp(&queue[*b].0))
            else {
                break;
            };
            let (upper_bound, p, half) = queue.swap_remove(index);
            if upper_bound <= best.1 + 0.5 {
                break;
            }
            let h = half / 2.0;
            let offsets = [[-h, -h], [h, -h], [-h, h], [h, h]];
            initial.extend(offsets.map(|[i, j]| ([p[0] + i, p[1] + j], h)));
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
