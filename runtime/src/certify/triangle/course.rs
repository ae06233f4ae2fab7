//! Straight ways through the tool's frame, and where along one a tool is deepest.
//!
//! Seen in the half plane a straight way is a branch of a hyperbola: z is linear, d convex. Between two
//! of its places it stays in the triangle of these and the apex where its tangents meet; what bounds
//! depth in the triangle bounds it on the way. An interval whose bound is above what was found is cut
//! where depth is likely to be greatest, until none is.

use crate::certify::body::feature::{Place, Triangle, dot};
use crate::certify::body::owners::Owners;
use crate::certify::body::section::{Depth, Section};

/// A straight way, `base + t way`: at `t`, `d² = off² + (start + t slide)²`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Course {
    base: [f64; 3],
    way: [f64; 3],
    off: f64,
    start: f64,
    slide: f64,
    span: [f64; 2],
}

/// A place on a course, and how d changes there.
#[derive(Clone, Copy)]
struct End {
    t: f64,
    place: Place,
    slope: f64,
}

/// What is between two places of a course.
#[derive(Clone, Copy)]
struct Interval(End, End);

impl Course {
    /// A part of a line.
    pub(crate) fn new(base: [f64; 3], way: [f64; 3], span: [f64; 2]) -> Course {
        let slide = (way[0] * way[0] + way[1] * way[1]).sqrt();
        let (start, off) = if slide > 0.0 {
            let level = [way[0] / slide, way[1] / slide];
            (base[0] * level[0] + base[1] * level[1], base[0] * level[1] - base[1] * level[0])
        } else {
            (0.0, (base[0] * base[0] + base[1] * base[1]).sqrt())
        };
        Course { base, way, off, start, slide, span }
    }

    pub(crate) fn point(&self, t: f64) -> [f64; 3] {
        [0, 1, 2].map(|axis| self.base[axis] + t * self.way[axis])
    }

    fn height(&self, t: f64) -> f64 {
        self.base[2] + t * self.way[2]
    }

    fn place(&self, t: f64) -> Place {
        let along = self.start + t * self.slide;
        [(self.off * self.off + along * along).sqrt(), self.height(t)]
    }

    /// The end at `t` of an interval on whose side of the axis `t` toward is.
    fn end(&self, t: f64, toward: f64) -> End {
        let place = self.place(t);
        let along = self.start + t * self.slide;
        let slope = if place[0] > 0.0 {
            self.slide * (along / place[0])
        } else {
            self.slide.copysign(self.start + toward * self.slide)
        };
        End { t, place, slope }
    }

    fn interval(&self, from: f64, to: f64) -> Interval {
        let middle = from / 2.0 + to / 2.0;
        Interval(self.end(from, middle), self.end(to, middle))
    }

    /// The spans on either side of where it is nearest to the axis.
    fn halves(&self) -> impl Iterator<Item = [f64; 2]> {
        let [from, to] = self.span;
        let nearest = -self.start / self.slide;
        if from < nearest && nearest < to {
            [Some([from, nearest]), Some([nearest, to])].into_iter().flatten()
        } else {
            [Some(self.span), None].into_iter().flatten()
        }
    }

    /// The part of a span between two heights.
    fn within(&self, [from, to]: [f64; 2], [low, high]: [f64; 2]) -> Option<[f64; 2]> {
        let (height, rise) = (self.base[2], self.way[2]);
        if rise == 0.0 {
            return (low <= height && height <= high).then_some([from, to]);
        }
        let [a, b] = [low, high].map(|z| (z - height) / rise);
        let (from, to) = (from.max(a.min(b)), to.min(a.max(b)));
        (from <= to).then_some([from, to])
    }
}

impl Interval {
    /// The triangle that the course stays in.
    fn triangle(&self, course: &Course) -> Triangle {
        let Interval(first, last) = self;
        let length = last.t - first.t;
        let meet =
            (last.place[0] - first.place[0] - last.slope * length) / (first.slope - last.slope);
        let x = if meet.is_finite() { meet.clamp(0.0, length) } else { 0.5 * length };
        // Beneath both tangents, whatever was rounded.
        let d = (first.place[0] + first.slope * x).min(last.place[0] - last.slope * (length - x));
        let apex = [d.max(0.0), course.height(first.t + x)];
        [first.place, last.place, apex]
    }
}

/// How fast depth changes along a course.
fn change(depth: &Depth, end: &End, course: &Course) -> f64 {
    dot(depth.gradient, [end.slope, course.way[2]])
}

/// Where to cut between two places: where the feature that is nearest at both is deepest, or else
/// where depths go over into each other, as far as slopes tell. Wherever it is cut both parts are looked at, so no number
/// here makes an answer wrong.
fn cut(Interval(first, last): &Interval, depths: [&Depth; 2], course: &Course) -> f64 {
    let length = last.t - first.t;
    let [up, down] = [change(depths[0], first, course), change(depths[1], last, course)];
    let x = if depths[0].feature == depths[1].feature {
        length * (up / (up - down))
    } else {
        (depths[1].value - depths[0].value - down * length) / (up - down)
    };
    let part = x / length;
    if part > 1e-3 && part < 1.0 - 1e-3 {
        first.t + length * part.clamp(0.05, 0.95)
    } else {
        first.t + 0.5 * length
    }
}

/// The deepest place that was found.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Found {
    pub(crate) t: f64,
    pub(crate) feature: usize,
}

/// How a search goes: what is no deeper than `least` is left, it ends within a tolerance of the deepest,
/// or as soon as something is deeper than `enough`, or with its budget.
#[derive(Clone, Copy)]
pub(crate) struct Goal {
    pub(crate) least: f64,
    pub(crate) tolerance: f64,
    pub(crate) enough: f64,
    pub(crate) budget: u32,
}

/// The deepest place of all triangles so far, in the tool's frame.
#[derive(Clone, Copy)]
pub(crate) struct Best {
    pub(crate) point: [f64; 3],
    pub(crate) feature: usize,
    pub(crate) index: u32,
}

/// The search for the deepest place.
#[derive(Default)]
pub(crate) struct Search {
    /// The greatest depth found.
    pub(crate) best: f64,
    /// How much more is not worth looking for.
    tolerance: f64,
    /// What is deeper than that ends the search.
    enough: f64,
    /// How deep what was left open may be, where the budget was spent.
    pub(crate) most: f64,
    /// Whether anything was found.
    found: bool,
    budget: u32,
    stack: Vec<Interval>,
}

impl Search {
    /// Begins to look for what is deeper than that.
    pub(crate) fn begin(&mut self, goal: Goal) {
        let Goal { least, tolerance, enough, budget } = goal;
        self.best = least;
        self.tolerance = tolerance;
        self.enough = enough;
        self.most = f64::NEG_INFINITY;
        self.found = false;
        self.budget = budget;
    }

    /// Whether what was found is deep enough to end.
    pub(crate) fn enough(&self) -> bool {
        self.best > self.enough
    }

    /// What is no deeper is not worth looking for. Whether there is anything is always worth it.
    pub(crate) fn wanted(&self) -> f64 {
        if self.found { self.best + self.tolerance } else { self.best }
    }

    /// Whether something was left open because the budget was spent.
    pub(crate) fn open(&self) -> bool {
        self.most > f64::NEG_INFINITY
    }

    /// Looks for what is less deep by so much too, if nothing was found yet; returns what it looked for.
    pub(crate) fn lower(&mut self, by: f64) -> Option<f64> {
        if self.found {
            return None;
        }
        let before = self.best;
        self.best -= by;
        Some(before)
    }

    /// Looks for what it looked for before. Whether what was found since is not as deep as that; it stays open.
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

    /// Leaves open what is no deeper than that, since it cannot be looked at more closely.
    pub(crate) fn leave(&mut self, bound: f64) {
        self.most = self.most.max(bound);
    }

    /// Spends one of the budget on what is no deeper than that; without any it stays open.
    pub(crate) fn spend(&mut self, bound: f64) -> bool {
        if self.budget == 0 {
            self.leave(bound);
            return false;
        }
        self.budget -= 1;
        true
    }

    /// What is left of the budget.
    pub(crate) fn left(&self) -> u32 {
        self.budget
    }

    /// Takes a place if it is the deepest so far.
    pub(crate) fn take(&mut self, depth: &Depth) -> bool {
        let deeper = depth.value > self.best;
        if deeper {
            self.best = depth.value;
            self.found = true;
        }
        deeper
    }

    fn note(&mut self, t: f64, depth: &Depth, found: &mut Option<Found>) {
        if self.take(depth) {
            *found = Some(Found { t, feature: depth.feature });
        }
    }

    /// The place of a course where owners are deepest, if deeper than the best, where that is at least 0. They have
    /// what is no farther than `slack` from what they own.
    pub(crate) fn inside(
        &mut self,
        (section, owners, slack): (&Section, &Owners, f64),
        course: &Course,
    ) -> Option<Found> {
        let mut found = None;
        for half in course.halves() {
            let [low, high] = half.map(|t| course.height(t));
            for slab in section.from(low.min(high)) {
                let heights = [slab.low - section.error, slab.high + section.error];
                if heights[0] > low.max(high) {
                    break;
                }
                if let Some([from, to]) = course.within(half, heights) {
                    let bound = |triangle: &Triangle, enough| {
                        section.at_most((owners, slack), slab, triangle, enough)
                    };
                    let depth = |place| section.depth((owners, slack), slab, place);
                    self.run(course, course.interval(from, to), bound, depth, &mut found);
                }
            }
        }
        found
    }

    /// The place of a course that is nearest to the owners, where the best is below 0. If all are, what is
    /// inside is at 0.
    pub(crate) fn outside(
        &mut self,
        (section, owners): (&Section, &Owners),
        course: &Course,
    ) -> Option<Found> {
        let mut found = None;
        for [from, to] in course.halves() {
            let bound = |triangle: &Triangle, best| section.no_nearer(owners, triangle, best);
            let depth = |place| {
                if owners.all() && section.contains(place) {
                    Depth { value: 0.0, gradient: [0.0; 2], feature: 0 }
                } else {
                    section.distance(owners, place)
                }
            };
            self.run(course, course.interval(from, to), bound, depth, &mut found);
        }
        found
    }

    fn run(
        &mut self,
        course: &Course,
        whole: Interval,
        bound: impl Fn(&Triangle, f64) -> f64,
        depth: impl Fn(Place) -> Depth,
        found: &mut Option<Found>,
    ) {
        self.stack.clear();
        self.stack.push(whole);
        while let Some(interval) = self.stack.pop() {
            let bound = bound(&interval.triangle(course), self.wanted());
            if bound <= self.wanted() || !self.spend(bound) {
                continue;
            }
            if self.enough() {
                break;
            }
            let Interval(first, last) = interval;
            let depths = [first, last].map(|end| depth(end.place));
            self.note(first.t, &depths[0], found);
            self.note(last.t, &depths[1], found);
            if bound <= self.wanted() {
                continue;
            }
            let t = cut(&interval, [&depths[0], &depths[1]], course);
            if t <= first.t || t >= last.t {
                self.leave(bound);
                continue;
            }
            let middle = course.end(t, first.t / 2.0 + last.t / 2.0);
            self.note(t, &depth(middle.place), found);
            self.stack.push(Interval(first, middle));
            self.stack.push(Interval(middle, last));
        }
    }
}
