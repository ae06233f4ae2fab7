//! Line searches: the deepest point of a tool along a line segment in the tool's frame.
//!
//! In the half plane a line is a branch of a hyperbola: z is linear, d convex. Between two of its points it stays
//! in the triangle of these points and the apex where its tangents meet, so a bound of depth in the triangle
//! holds on the line. An interval whose bound exceeds the greatest depth found is cut where depth is likely to be
//! greatest, until none is left.

use crate::certify::space::MeridianPoint;
use crate::certify::tool_model::owners::Owners;
use crate::certify::tool_model::quarter::Triangle;
use crate::certify::tool_model::section::{Depth, Section};
use touchoff_plane::dot;

/// The least part of an interval that a cut where two bounds meet leaves: one nearer to an end would leave almost the whole interval
/// to be bounded again.
const MIN_PART: f64 = 1e-3;

/// A line segment, `base + t direction`, with `t` in `span`. At `t`, `d² = off² + (start + t slide)²`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SearchLine {
    base: [f64; 3],
    direction: [f64; 3],
    off: f64,
    start: f64,
    slide: f64,
    span: [f64; 2],
}

/// A point on a line, and the derivative of d by `t` there.
#[derive(Clone, Copy)]
struct End {
    t: f64,
    point: MeridianPoint,
    slope: f64,
}

/// The interval between two points of a line.
#[derive(Clone, Copy)]
struct LineInterval(End, End);

impl SearchLine {
    /// Creates the segment of a line with `t` in `span`.
    pub(crate) fn new(base: [f64; 3], direction: [f64; 3], span: [f64; 2]) -> SearchLine {
        let slide = (direction[0] * direction[0] + direction[1] * direction[1]).sqrt();
        let (start, off) = if slide > 0.0 {
            let level = [direction[0] / slide, direction[1] / slide];
            (base[0] * level[0] + base[1] * level[1], base[0] * level[1] - base[1] * level[0])
        } else {
            (0.0, (base[0] * base[0] + base[1] * base[1]).sqrt())
        };
        SearchLine { base, direction, off, start, slide, span }
    }

    pub(crate) fn point(&self, t: f64) -> [f64; 3] {
        [0, 1, 2].map(|axis| self.base[axis] + t * self.direction[axis])
    }

    fn height(&self, t: f64) -> f64 {
        self.base[2] + t * self.direction[2]
    }

    fn meridian_point(&self, t: f64) -> MeridianPoint {
        let along = self.start + t * self.slide;
        [(self.off * self.off + along * along).sqrt(), self.height(t)]
    }

    /// Returns the end at `t` of an interval that lies on the same side of the axis as `toward`.
    fn end(&self, t: f64, toward: f64) -> End {
        let point = self.meridian_point(t);
        let along = self.start + t * self.slide;
        // On the axis d has a kink; the slope is that of the side toward which the interval lies.
        let slope = if point[0] > 0.0 {
            self.slide * (along / point[0])
        } else {
            self.slide.copysign(self.start + toward * self.slide)
        };
        End { t, point, slope }
    }

    fn interval(&self, from: f64, to: f64) -> LineInterval {
        let middle = from / 2.0 + to / 2.0;
        LineInterval(self.end(from, middle), self.end(to, middle))
    }

    /// Returns the spans on either side of the point nearest to the axis.
    fn halves(&self) -> impl Iterator<Item = [f64; 2]> {
        let [from, to] = self.span;
        // A line through the axis has a kink there, over which a triangle of tangents would not hold.
        let nearest = -self.start / self.slide;
        if from < nearest && nearest < to {
            [Some([from, nearest]), Some([nearest, to])].into_iter().flatten()
        } else {
            [Some(self.span), None].into_iter().flatten()
        }
    }

    /// Returns the portion of the segment between two heights.
    pub(crate) fn between(&self, heights: [f64; 2]) -> Option<SearchLine> {
        Some(SearchLine { span: self.within(self.span, heights)?, ..*self })
    }

    /// Returns the portion of a span between two heights.
    fn within(&self, [from, to]: [f64; 2], [low, high]: [f64; 2]) -> Option<[f64; 2]> {
        let (height, rise) = (self.base[2], self.direction[2]);
        if rise == 0.0 {
            return (low <= height && height <= high).then_some([from, to]);
        }
        let [a, b] = [low, high].map(|z| (z - height) / rise);
        let (from, to) = (from.max(a.min(b)), to.min(a.max(b)));
        (from <= to).then_some([from, to])
    }
}

impl LineInterval {
    /// Returns a triangle of the half plane that contains the interval.
    fn triangle(&self, line: &SearchLine) -> Triangle {
        let LineInterval(first, last) = self;
        let length = last.t - first.t;
        let meet =
            (last.point[0] - first.point[0] - last.slope * length) / (first.slope - last.slope);
        let x = if meet.is_finite() { meet.clamp(0.0, length) } else { 0.5 * length };
        // Keeps the apex below both tangents, whatever the rounding errors.
        let d = (first.point[0] + first.slope * x).min(last.point[0] - last.slope * (length - x));
        let apex = [d.max(0.0), line.height(first.t + x)];
        [first.point, last.point, apex]
    }
}

/// Returns the derivative of depth along a line.
fn change(depth: &Depth, end: &End, line: &SearchLine) -> f64 {
    dot(depth.gradient, [end.slope, line.direction[2]])
}

/// Returns the parameter at which an interval is cut. If the same feature is nearest at both ends, it is an
/// estimate of where that is deepest, else of where the two depths are equal, as the slopes predict. Both pieces
/// are examined wherever the cut is, so its value never makes a result wrong.
fn cut(LineInterval(first, last): &LineInterval, depths: [&Depth; 2], line: &SearchLine) -> f64 {
    let length = last.t - first.t;
    let [up, down] = [change(depths[0], first, line), change(depths[1], last, line)];
    let x = if depths[0].feature == depths[1].feature {
        length * (up / (up - down))
    } else {
        (depths[1].value - depths[0].value - down * length) / (up - down)
    };
    let part = x / length;
    if part > MIN_PART && part < 1.0 - MIN_PART {
        first.t + length * part.clamp(0.05, 0.95)
    } else {
        first.t + 0.5 * length
    }
}

/// The deepest point found on a line.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LineMaximum {
    pub(crate) t: f64,
    pub(crate) feature: usize,
}

/// The goal of a search. Depths up to `threshold` are ignored. The search ends within `tolerance` of the greatest
/// depth, at a depth that is above `stop_depth` for certain, or when the budget is spent.
#[derive(Clone, Copy)]
pub(crate) struct Goal {
    pub(crate) threshold: f64,
    pub(crate) tolerance: f64,
    pub(crate) stop_depth: f64,
    pub(crate) budget: u32,
}

/// The deepest point found in all triangles, in the tool's frame.
#[derive(Clone, Copy)]
pub(crate) struct DeepestCandidate {
    pub(crate) point: [f64; 3],
    pub(crate) feature: usize,
    pub(crate) index: u32,
}

/// The search for the greatest depth.
#[derive(Clone, Default)]
pub(crate) struct DepthSearch {
    /// The greatest depth found, or else the least depth searched for.
    pub(crate) best: f64,
    /// The gain in depth that is not worth searching for.
    tolerance: f64,
    /// The depth above which the search ends.
    stop_depth: f64,
    /// The largest skew of a triangle examined, by which a depth found may be too large.
    pub(crate) skew: f64,
    /// The greatest bound of the regions left open because the budget was spent or they could not be divided.
    pub(crate) open_bound: f64,
    /// True if a point was found.
    found: bool,
    budget: u32,
    stack: Vec<LineInterval>,
}

impl DepthSearch {
    /// Begins a search.
    pub(crate) fn begin(&mut self, goal: Goal) {
        let Goal { threshold, tolerance, stop_depth, budget } = goal;
        self.best = threshold;
        self.tolerance = tolerance;
        self.stop_depth = stop_depth;
        self.skew = 0.0;
        self.open_bound = f64::NEG_INFINITY;
        self.found = false;
        self.budget = budget;
    }

    /// Returns whether the depth found ends the search: whatever is left cannot change the verdict.
    pub(crate) fn is_done(&self) -> bool {
        self.best > self.stop_depth + self.skew
    }

    /// Returns the depth up to which regions can be pruned. The tolerance is added only once a point was found.
    pub(crate) fn threshold(&self) -> f64 {
        if self.found { self.best + self.tolerance } else { self.best }
    }

    /// Returns whether some region was left open.
    pub(crate) fn has_open(&self) -> bool {
        self.open_bound > f64::NEG_INFINITY
    }

    /// Lowers the threshold of a search that has found nothing yet, and returns the previous one.
    pub(crate) fn lower(&mut self, by: f64) -> Option<f64> {
        if self.found {
            return None;
        }
        let before = self.best;
        self.best -= by;
        Some(before)
    }

    /// Restores a threshold. Returns whether the best depth is not above it; a point found since is then left open.
    pub(crate) fn raise(&mut self, before: f64, by: f64) -> bool {
        let shallow = self.best <= before;
        if shallow {
            if self.found {
                self.leave(self.best + by);
            }
            self.found = false;
            self.best = before;
        }
        shallow
    }

    /// Leaves a region with this bound open, since it cannot be examined more closely.
    pub(crate) fn leave(&mut self, bound: f64) {
        self.open_bound = self.open_bound.max(bound);
    }

    /// Spends one unit of the budget on a region with this bound. If none is left, leaves it open and returns false.
    pub(crate) fn spend(&mut self, bound: f64) -> bool {
        if self.budget == 0 {
            self.leave(bound);
            return false;
        }
        self.budget -= 1;
        true
    }

    /// Returns the rest of the budget.
    pub(crate) fn remaining_budget(&self) -> u32 {
        self.budget
    }

    /// Takes a point if it is the deepest so far.
    pub(crate) fn take(&mut self, depth: &Depth) -> bool {
        let deeper = depth.value > self.best;
        if deeper {
            self.best = depth.value;
            self.found = true;
        }
        deeper
    }

    fn note(&mut self, t: f64, depth: &Depth, found: &mut Option<LineMaximum>) {
        if self.take(depth) {
            *found = Some(LineMaximum { t, feature: depth.feature });
        }
    }

    /// Returns the deepest owned point of a line, if it is deeper than the best so far, which has to be at least 0.
    /// Points within `slack` of owned points count as owned.
    pub(crate) fn inside(
        &mut self,
        section: &Section,
        owners: &Owners,
        slack: f64,
        line: &SearchLine,
    ) -> Option<LineMaximum> {
        let mut found = None;
        for half in line.halves() {
            let [low, high] = half.map(|t| line.height(t));
            for slab in section.slabs_from(low.min(high)) {
                // Wider by the error, so that no point falls between two slabs.
                let heights = [slab.low - section.outline.error, slab.high + section.outline.error];
                if heights[0] > low.max(high) {
                    break;
                }
                if let Some([from, to]) = line.within(half, heights) {
                    self.run(
                        line,
                        line.interval(from, to),
                        |triangle, threshold| {
                            section.depth_bound(owners, slack, slab, triangle, threshold)
                        },
                        |point| section.depth(owners, slack, slab, point),
                        &mut found,
                    );
                }
            }
        }
        found
    }

    /// Returns the point of a line nearest to the owners, where the best so far is below 0. If all features are
    /// owners, points inside count as 0.
    pub(crate) fn outside(
        &mut self,
        section: &Section,
        owners: &Owners,
        line: &SearchLine,
    ) -> Option<LineMaximum> {
        let mut found = None;
        for [from, to] in line.halves() {
            self.run(
                line,
                line.interval(from, to),
                |triangle, threshold| {
                    let bound = section.negative_distance_bound(owners, triangle, threshold);
                    // A triangle that meets no feature is inside as a whole or not at all.
                    let is_inside = bound < 0.0 && owners.all() && section.contains(triangle[0]);
                    if is_inside { 0.0 } else { bound }
                },
                |point| {
                    if owners.all() && section.contains(point) {
                        Depth { value: 0.0, gradient: [0.0; 2], feature: 0 }
                    } else {
                        section.distance(owners, point)
                    }
                },
                &mut found,
            );
        }
        found
    }

    fn run(
        &mut self,
        line: &SearchLine,
        whole: LineInterval,
        bound: impl Fn(&Triangle, f64) -> f64,
        depth: impl Fn(MeridianPoint) -> Depth,
        found: &mut Option<LineMaximum>,
    ) {
        self.stack.clear();
        self.stack.push(whole);
        while let Some(interval) = self.stack.pop() {
            let bound = bound(&interval.triangle(line), self.threshold());
            if bound <= self.threshold() || !self.spend(bound) {
                continue;
            }
            if self.is_done() {
                break;
            }
            let LineInterval(first, last) = interval;
            let depths = [first, last].map(|end| depth(end.point));
            self.note(first.t, &depths[0], found);
            self.note(last.t, &depths[1], found);
            // The ends may be deep enough to rule out what lies between them.
            if bound <= self.threshold() {
                continue;
            }
            let t = cut(&interval, [&depths[0], &depths[1]], line);
            // No double lies between the ends.
            if t <= first.t || t >= last.t {
                self.leave(bound);
                continue;
            }
            let middle = line.end(t, first.t / 2.0 + last.t / 2.0);
            self.note(t, &depth(middle.point), found);
            self.stack.push(LineInterval(first, middle));
            self.stack.push(LineInterval(middle, last));
        }
    }
}
