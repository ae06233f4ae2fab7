//! Traces the borders of regions by hand on a lattice over the section.
//!
//! The plan's tree has the owner of each lattice point. A side of a lattice cell whose ends have different owners is crossed
//! by a border, and bisection has the point and the curve. The crossings of a cell are linked if they continue one curve
//! between the same owners. Otherwise they meet in a joint, at the intersection of their curves. From a cell the borders are
//! followed into those beyond the crossed sides.

use super::ROUNDING_FRACTION;
use super::curves::Curves;
use super::section::{Polygon, simplified};
use super::stroke::{MAX_TURN, Stroke, circle};
use std::collections::{HashMap, HashSet};
use touchoff_dsl::formula::CurveIndex;
use touchoff_dsl::plan::Tree;
use touchoff_plane::{Point, minus, norm};

/// The gain of the sine of an angle for which another pair of curves is taken for a joint, so that equal ones keep their order.
const MIN_GAIN: f64 = 1e-9;

/// The side of a lattice cell, in units of the sheet.
const CELL: f64 = 0.5;
/// The number of cells between the lines on which borders are looked for.
const SEED_STRIDE: i64 = 4;
/// The greatest number of lattice cells along a side of the window, since a needle is long for its width.
const MAX_CELLS: f64 = 4_000.0;
/// The number of halvings by which a crossing is found, to rounding of a tool's size.
const HALVINGS: usize = 40;
/// Points are on a circle within this distance, relative to its radius.
const ROUND_FRACTION: f64 = 1e-9;
/// Points are on a line within this distance, in cells.
const STRAIGHT_FRACTION: f64 = 1e-6;
/// The greatest distance of chords from a curve that is no line, in cells.
const FLATNESS: f64 = 0.1;

/// The area on one side of a border.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Side {
    /// A region, by its index.
    Region(usize),
    /// Outside the tool.
    Outside,
    /// The mirror image, across the axis.
    Axis,
}

/// A line with the same owners on both sides all along.
#[derive(Clone, Debug)]
pub(super) struct Border {
    /// The areas on its left and its right. A region is on the left; of two regions, the one listed first.
    pub(super) sides: [Side; 2],
    /// Its points, ends included. Lines that meet in a joint have the same end.
    pub(super) line: Vec<Point>,
    /// The same as lines and arcs; none if its ends coincide.
    pub(super) strokes: Vec<Stroke>,
    /// True if these are exact, and not chords.
    pub(super) exact: bool,
}

/// The point where a border crosses a side of the lattice.
struct Crossing {
    at: Point,
    /// The owners at the side's ends, the lower or left one first.
    sides: [Side; 2],
    /// True if the side is upright.
    upright: bool,
    /// The curve that is crossed; `None` for the axis.
    curve: Option<CurveIndex>,
    /// The next point in the cell below or left of the side, and in the other one.
    next: [Option<Next>; 2],
}

/// The point to which a crossing is linked.
#[derive(Clone, Copy, PartialEq)]
enum Next {
    Crossing(usize),
    Joint(Point),
}

/// A side of the lattice: its lower or left end, and whether it is upright.
type LatticeSide = ([i64; 2], bool);

struct Tracer<'c, 'm, 't> {
    curves: &'c Curves<'m>,
    tree: &'t Tree,
    low: Point,
    step: Point,
    owners: HashMap<[i64; 2], Side>,
    known: HashMap<LatticeSide, Option<usize>>,
    crossings: Vec<Crossing>,
}

/// Traces the borders in a window around a section. `unit` is a lower bound on one unit of the sheet.
pub(super) fn trace(
    curves: &Curves<'_>,
    tree: &Tree,
    [low, high]: [Point; 2],
    unit: f64,
) -> Vec<Border> {
    let step = [0, 1].map(|k| (CELL * unit).max((high[k] - low[k]) / MAX_CELLS));
    let mut low = low;
    // The axis runs through the middle of cells, so that it is traced like a border.
    if curves.has_axis() {
        low[0] = -0.5 * step[0];
    }
    let (owners, known, crossings) = (HashMap::new(), HashMap::new(), Vec::new());
    let mut tracer = Tracer { curves, tree, low, step, owners, known, crossings };
    let counts = [0, 1].map(|k| ((high[k] - low[k]) / step[k]).ceil() as i64);
    let mut pending = tracer.seeds(counts);
    let mut linked = HashSet::new();
    while let Some(cell) = pending.pop() {
        if linked.insert(cell) {
            tracer.link(cell, &mut pending);
        }
    }
    tracer.borders()
}

impl Tracer<'_, '_, '_> {
    /// Returns a point of the lattice.
    fn at(&self, [i, j]: [i64; 2]) -> Point {
        [self.low[0] + i as f64 * self.step[0], self.low[1] + j as f64 * self.step[1]]
    }

    /// Returns cells that are crossed by borders, found on every few lines of the lattice.
    fn seeds(&mut self, counts: [i64; 2]) -> Vec<[i64; 2]> {
        let mut seeds = Vec::new();
        for i in (0..counts[0]).step_by(SEED_STRIDE as usize) {
            for j in (0..counts[1]).step_by(SEED_STRIDE as usize) {
                for k in 0..2 {
                    let mut low = [i, j];
                    let mut high = low;
                    high[k] += SEED_STRIDE;
                    let owner = self.lattice_owner(low);
                    if owner == self.lattice_owner(high) {
                        continue;
                    }
                    while high[k] - low[k] > 1 {
                        let mut middle = low;
                        middle[k] = (low[k] + high[k]) / 2;
                        if self.lattice_owner(middle) == owner {
                            low = middle;
                        } else {
                            high = middle;
                        }
                    }
                    seeds.push(low);
                }
            }
        }
        seeds
    }

    /// Returns the owner of a point.
    fn owner(&self, p: Point) -> Side {
        if self.curves.has_axis() && p[0] < 0.0 {
            return Side::Axis;
        }
        let owner = self.tree.owner_at(&|curve| self.curves.value(curve, p));
        owner.map_or(Side::Outside, Side::Region)
    }

    /// Returns the owner of a point of the lattice.
    fn lattice_owner(&mut self, corner: [i64; 2]) -> Side {
        if let Some(owner) = self.owners.get(&corner) {
            return *owner;
        }
        let owner = self.owner(self.at(corner));
        self.owners.insert(corner, owner);
        owner
    }

    /// Returns the curve of the first test whose result differs at two points.
    fn curve_between(&self, p: Point, q: Point) -> Option<CurveIndex> {
        let mut tree = self.tree;
        while let Tree::Split { curve, strict, below, above } = tree {
            let holds = [p, q].map(|p| {
                let value = self.curves.value(*curve, p);
                value < 0.0 || (value == 0.0 && !strict)
            });
            if holds[0] != holds[1] {
                return Some(*curve);
            }
            tree = if holds[0] { below } else { above };
        }
        None
    }

    /// Returns the crossing of a side of the lattice, if its ends have different owners.
    fn crossing(&mut self, side @ ([i, j], upright): LatticeSide) -> Option<usize> {
        if let Some(known) = self.known.get(&side) {
            return *known;
        }
        let ends = [[i, j], if upright { [i, j + 1] } else { [i + 1, j] }];
        let sides = ends.map(|end| self.lattice_owner(end));
        let mut crossing = None;
        let is_region = |side: &Side| matches!(side, Side::Region(_));
        if sides[0] != sides[1] && sides.iter().any(is_region) {
            let [mut p, mut q] = ends.map(|end| self.at(end));
            for _ in 0..HALVINGS {
                let middle = [0, 1].map(|k| f64::midpoint(p[k], q[k]));
                if self.owner(middle) == sides[0] { p = middle } else { q = middle }
            }
            let is_axis = self.curves.has_axis() && p[0].min(q[0]) < 0.0;
            let curve = if is_axis { None } else { self.curve_between(p, q) };
            let at = if is_axis { [0.0, q[1]] } else { q };
            self.crossings.push(Crossing { at, sides, upright, curve, next: [None; 2] });
            crossing = Some(self.crossings.len() - 1);
        }
        self.known.insert(side, crossing);
        crossing
    }

    /// Links the crossings of a cell with each other, or with a joint, and adds the cells beyond the crossed sides.
    fn link(&mut self, [i, j]: [i64; 2], beyond: &mut Vec<[i64; 2]>) {
        // Each side with the cell beyond it, and the place of this cell beside it.
        let sides = [
            (([i, j], false), [i, j - 1], 1),
            (([i, j], true), [i - 1, j], 1),
            (([i, j + 1], false), [i, j + 1], 0),
            (([i + 1, j], true), [i + 1, j], 0),
        ];
        let mut found: Vec<(usize, usize)> = Vec::new();
        for (side, neighbour, place) in sides {
            if let Some(crossing) = self.crossing(side) {
                found.push((crossing, place));
                beyond.push(neighbour);
            }
        }
        if let [(a, place_a), (b, place_b)] = found[..] {
            let [first, second] = [&self.crossings[a], &self.crossings[b]];
            let [low, high] = first.sides;
            let is_same = second.sides == [low, high] || second.sides == [high, low];
            if is_same && first.curve == second.curve {
                self.crossings[a].next[place_a] = Some(Next::Crossing(b));
                self.crossings[b].next[place_b] = Some(Next::Crossing(a));
                return;
            }
        }
        if found.is_empty() {
            return;
        }
        let joint = self.joint(&found);
        for (crossing, place) in found {
            self.crossings[crossing].next[place] = Some(Next::Joint(joint));
        }
    }

    /// Returns the intersection of the curves of a cell's crossings, of the two at the largest angle.
    fn joint(&self, found: &[(usize, usize)]) -> Point {
        let crossings: Vec<&Crossing> =
            found.iter().map(|(index, _)| &self.crossings[*index]).collect();
        let mut middle = [0.0; 2];
        for Crossing { at, .. } in &crossings {
            middle = [0, 1].map(|k| middle[k] + at[k] / crossings.len() as f64);
        }
        let reach = 2.0 * norm(self.step);
        let (mut best, mut joint) = (0.0, middle);
        for (k, a) in crossings.iter().enumerate() {
            for b in crossings[k + 1..].iter().filter(|b| b.curve != a.curve) {
                if let Some((sine, at)) = self.curves.meet([a.curve, b.curve], middle, reach)
                    && sine > best + MIN_GAIN
                {
                    (best, joint) = (sine, at);
                }
            }
        }
        joint
    }

    /// Returns the borders along linked crossings, those between joints first.
    fn borders(&self) -> Vec<Border> {
        let mut borders = Vec::new();
        let mut taken = vec![false; self.crossings.len()];
        for closed in [false, true] {
            for (start, crossing) in self.crossings.iter().enumerate() {
                for place in [0, 1] {
                    let is_end = matches!(crossing.next[1 - place], Some(Next::Joint(_)));
                    if !taken[start] && is_end != closed {
                        borders.push(self.border(start, place, &mut taken));
                    }
                }
            }
        }
        borders
    }

    /// Returns the border that begins at a crossing and goes on in one of its cells.
    fn border(&self, start: usize, place: usize, taken: &mut [bool]) -> Border {
        let Crossing { sides, upright, next, .. } = self.crossings[start];
        let mut line = Vec::new();
        if let Some(Next::Joint(joint)) = next[1 - place] {
            line.push(joint);
        }
        let (mut at, mut after) = (start, Some(Next::Crossing(start)));
        while let Some(Next::Crossing(index)) = after {
            line.push(self.crossings[index].at);
            if taken[index] {
                break;
            }
            taken[index] = true;
            let [below, above] = self.crossings[index].next;
            after = if below == Some(Next::Crossing(at)) { above } else { below };
            if index == start {
                after = next[place];
            }
            at = index;
        }
        if let Some(Next::Joint(joint)) = after {
            line.push(joint);
        }
        // Upward through a level side, its left end is on the left; to the right through an upright one, its upper end is.
        let is_first_left = (place == 1) != upright;
        let mut sides = if is_first_left { sides } else { [sides[1], sides[0]] };
        if sides[0] > sides[1] {
            sides.reverse();
            line.reverse();
        }
        self.shaped(Border { sides, line, strokes: Vec::new(), exact: true })
    }

    /// Returns a border with its lines and arcs.
    fn shaped(&self, mut border: Border) -> Border {
        let cell = norm(self.step);
        let line = &border.line;
        let (first, last) = (line[0], line[line.len() - 1]);
        // Joints of neighbouring cells may be one.
        if line.len() == 3 && norm(minus(last, first)) < ROUNDING_FRACTION * cell {
            border.line = vec![first, last];
            return border;
        }
        if simplified(line, STRAIGHT_FRACTION * cell).len() == 2 {
            border.line = vec![first, last];
            border.strokes = vec![Stroke::line(first, last)];
            return border;
        }
        let arcs = arcs(line);
        border.line = simplified(line, FLATNESS * cell);
        border.exact = arcs.is_some();
        border.strokes = arcs.unwrap_or_else(|| {
            border.line.windows(2).map(|pair| Stroke::line(pair[0], pair[1])).collect()
        });
        border
    }
}

/// Returns the arcs of less than half a circle through points, if they are on one circle.
fn arcs(line: &[Point]) -> Option<Vec<Stroke>> {
    let last = line.len() - 1;
    // The last point of a closed circle is the first.
    let spread = if line[0] == line[last] { 3 } else { 2 };
    let (centre, radius) = circle([line[0], line[last / spread], line[last * 2 / spread]])?;
    let mut swept = 0.0;
    for pair in line.windows(2) {
        if (norm(minus(pair[1], centre)) - radius).abs() > ROUND_FRACTION * radius {
            return None;
        }
        swept += Stroke { from: pair[0], to: pair[1], circle: Some((centre, radius)) }.turn().abs();
    }
    let parts = ((swept / MAX_TURN).ceil() as usize).clamp(1, last);
    let mut arcs = Vec::new();
    for k in 0..parts {
        let [from, to] = [k, k + 1].map(|k| line[k * last / parts]);
        arcs.push(Stroke { from, to, circle: Some((centre, radius)) });
    }
    Some(arcs)
}

/// Returns the area bounded by those borders for which `inside` holds on exactly one side, as polygons.
pub(super) fn loops(borders: &[Border], inside: impl Fn(Side) -> bool) -> Vec<Polygon> {
    let mut rest: Vec<Vec<Point>> = Vec::new();
    for border in borders {
        match border.sides.map(&inside) {
            [true, false] => rest.push(border.line.clone()),
            [false, true] => rest.push(border.line.iter().rev().copied().collect()),
            _ => {}
        }
    }
    let mut loops = Vec::new();
    while let Some(mut polygon) = rest.pop() {
        while polygon[polygon.len() - 1] != polygon[0] {
            let end = polygon[polygon.len() - 1];
            let Some(next) = rest.iter().position(|line| line[0] == end) else { break };
            polygon.extend(rest.swap_remove(next));
        }
        polygon.dedup();
        loops.push(polygon);
    }
    loops
}
