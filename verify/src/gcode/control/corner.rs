//! Corners of a contour (`,R` and `,C` of Fanuc and Haas, `RND=`, `CHR=` and `CHF=` of Sinumerik, RND and CHF of Klartext): the arc
//! between two lines or arcs, the chamfer between two lines.
//!
//! The motion that states a corner is held until the next one (known: Fanuc, *Optional chamfering and corner R*; Siemens, *NC
//! programming*; Heidenhain, *Klartext programming*).
//!
//! An arc of radius r that touches both motions has its centre at the distance r from each, on the side to which the contour turns:
//! at a crossing of two curves, a line and its parallel, or a circle with the radius R ± r about the centre of an arc. Of several
//! crossings the one next to the corner is taken.

use super::{Control, FeedMode, in_plane};
use crate::gcode::error::{combination, missing, not_read};
use crate::gcode::rules::{Choice, Rule};
use crate::gcode::{GcodeFault, Plane, Step, StepPath};
use nalgebra::Vector2;
use std::f64::consts::{PI, TAU};
use std::sync::Arc;

/// A corner, as its block states it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::gcode) struct Corner {
    /// The word, for messages.
    pub(in crate::gcode) word: &'static str,
    pub(in crate::gcode) shape: CornerShape,
    /// The length that gives its size, in the unit of the program.
    pub(in crate::gcode) length: f64,
    /// Set if it is written without a decimal point.
    pub(in crate::gcode) is_whole: bool,
}

/// The shape of a corner, and the length that gives its size.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::gcode) enum CornerShape {
    /// An arc that touches both motions, by its radius.
    Round,
    /// A chamfer, by the distance of both ends from the corner.
    Chamfer,
    /// As [`CornerShape::Chamfer`], of a square corner alone.
    SquareChamfer,
    /// A chamfer, by its own length.
    Chord,
}

/// A line or an arc, and the corner at its end.
#[derive(Clone, Debug)]
pub(super) struct HeldMotion {
    step: Step,
    corner: Corner,
    /// In millimetres.
    length: f64,
    plane: Plane,
    /// Set in the block that states the corner.
    is_new: bool,
}

impl HeldMotion {
    /// Returns whether the present block states the corner.
    pub(super) fn take_new(&mut self) -> bool {
        std::mem::take(&mut self.is_new)
    }
}

/// Smallest sine of the angle between two motions with a corner.
const SMALLEST_SINE: f64 = 1e-6;

/// Distance in millimetres by which a corner may be longer than a motion beside it.
const SAME_POINT: f64 = 1e-9;

impl Control {
    /// Ends the motion that is held with its corner, and holds the one that the block has added after the step `first`, if it states a
    /// corner.
    pub(super) fn corners(
        &mut self,
        corner: Option<Corner>,
        first: usize,
    ) -> Result<(), GcodeFault> {
        if let (Some(held), true) = (&self.held_motion, self.pending.len() > first) {
            let steps = trimmed(held, &self.pending[first], self.modal.plane)?;
            self.pending.remove(first);
            for (index, step) in steps.into_iter().enumerate() {
                self.pending.insert(first + index, step);
            }
            self.held_motion = None;
        }
        let Some(corner) = corner else { return Ok(()) };
        let word = corner.word;
        // `,R` has the letter of a radius.
        let is_increment = corner.is_whole
            && self.choice(Rule::WholeNumbers) == Choice::Increments
            && (corner.shape != CornerShape::Round
                || self.choice(Rule::WholeRadii) == Choice::Increments);
        let factor = if is_increment { self.modal.increment() } else { 1.0 };
        let length = self.modal.millimetres(corner.length * factor);
        if length <= 0.0 || length.is_nan() {
            return Err(missing(word, "a length above 0"));
        }
        // Its time would be that of each of its motions.
        if self.modal.feed_mode == FeedMode::InverseTime {
            return Err(combination(word, "G93 is in force", "write G94 before"));
        }
        if self.polar.is_some() {
            return Err(combination(word, "polar coordinates are in force (G16)", WRITE_OUT));
        }
        let is_moved = self.pending.len() > first;
        let step = self.pending.pop_back_if(|step| is_moved && is_contour(step));
        let Some(step) = step else { return Err(beside(&corner)) };
        let plane = self.modal.plane;
        self.held_motion = Some(HeldMotion { step, corner, length, plane, is_new: true });
        Ok(())
    }

    /// Refuses the begin or the end of cutter compensation after a motion that is held for its corner: both motions would be another
    /// one's.
    pub(super) fn check_corner_before_compensation(&self) -> Result<(), GcodeFault> {
        match &self.held_motion {
            None => Ok(()),
            Some(held) => {
                let condition = "the next motion begins or ends cutter compensation";
                Err(combination(held.corner.word, condition, WRITE_OUT))
            }
        }
    }

    /// Refuses a corner without a motion after it.
    pub(in crate::gcode) fn check_corner(&self) -> Result<(), GcodeFault> {
        match &self.held_motion {
            None => Ok(()),
            Some(held) => Err(missing(held.corner.word, "a motion at feed in its plane after it")),
        }
    }
}

pub(in crate::gcode) const WRITE_OUT: &str = "write the corner as a motion of its own";

/// Returns the fault of a corner whose neighbours are not those that it needs.
fn beside(corner: &Corner) -> GcodeFault {
    let meaning = match corner.shape {
        CornerShape::Round => "a corner that is not between two lines or arcs in its plane",
        _ => "a corner that is not between two lines in its plane",
    };
    not_read(corner.word, meaning, WRITE_OUT)
}

fn is_contour(step: &Step) -> bool {
    let is_known = matches!(step.path, StepPath::Line | StepPath::Arc { .. });
    is_known && !step.rapid && step.tool_vector.is_none()
}

/// A motion in the plane.
#[derive(Clone, Copy, Debug)]
struct Element {
    start: Vector2<f64>,
    end: Vector2<f64>,
    /// The centre and the angle of an arc.
    arc: Option<(Vector2<f64>, f64)>,
}

/// The points at a distance from an element, continued beyond its ends.
enum Parallel {
    Line { point: Vector2<f64>, direction: Vector2<f64> },
    Circle { centre: Vector2<f64>, radius: f64 },
}

impl Element {
    /// Returns a step in the plane; `None` if it moves other axes, or less than two points of it are known or differ.
    fn new(step: &Step, plane: Plane) -> Option<Element> {
        let axes = plane.axes();
        let mut others = (0..6).filter(|axis| !axes.contains(axis));
        if others.any(|axis| step.commanded[axis] && step.start[axis] != step.end[axis]) {
            return None;
        }
        let [start, end] =
            [step.start, step.end].map(|position| in_plane(&position, axes).map(Vector2::from));
        let (start, end) = (start?, end?);
        let arc = match step.path {
            StepPath::Line if start != end => None,
            StepPath::Arc { plane: of_arc, centre, sweep } if of_arc == plane => {
                Some((Vector2::from(centre), sweep))
            }
            _ => return None,
        };
        Some(Element { start, end, arc })
    }

    /// Returns the direction of motion at a point of the element.
    fn direction(&self, at: Vector2<f64>) -> Vector2<f64> {
        match self.arc {
            None => (self.end - self.start).normalize(),
            Some((centre, sweep)) => sweep.signum() * left((at - centre).normalize()),
        }
    }

    /// Returns the points at a distance on the left; on the right, if it is below 0. An arc of radius R has none at R and beyond on the
    /// side of its centre.
    fn parallel(&self, at: Vector2<f64>, distance: f64) -> Option<Parallel> {
        match self.arc {
            None => {
                let direction = self.direction(at);
                Some(Parallel::Line { point: at + distance * left(direction), direction })
            }
            Some((centre, sweep)) => {
                let radius = (at - centre).norm() - sweep.signum() * distance;
                (radius > 0.0).then_some(Parallel::Circle { centre, radius })
            }
        }
    }

    /// Returns the point of the element that is next to another point; `at` is a point of it.
    fn foot(&self, at: Vector2<f64>, of: Vector2<f64>) -> Vector2<f64> {
        match self.arc {
            None => {
                let direction = self.direction(at);
                at + direction.dot(&(of - at)) * direction
            }
            Some((centre, _)) => centre + (at - centre).norm() * (of - centre).normalize(),
        }
    }

    /// Returns the element up to a point, or from it on, if the point is on it.
    fn part(&self, point: Vector2<f64>, is_before: bool) -> Option<Element> {
        let arc = match self.arc {
            None => {
                let direction = self.direction(point);
                let along = direction.dot(&(point - self.start));
                let length = (self.end - self.start).norm();
                if along < -SAME_POINT || along > length + SAME_POINT {
                    return None;
                }
                None
            }
            Some((centre, sweep)) => {
                let other = if is_before { self.end } else { self.start };
                let turn = angle(point - centre, other - centre);
                let sense = if is_before { sweep.signum() } else { -sweep.signum() };
                // The angle of the part that goes.
                let cut = (sense * turn).rem_euclid(TAU);
                if cut > sweep.abs() {
                    return None;
                }
                Some((centre, sweep.signum() * (sweep.abs() - cut)))
            }
        };
        Some(match is_before {
            true => Element { end: point, arc, ..*self },
            false => Element { start: point, arc, ..*self },
        })
    }

    fn path(&self, plane: Plane) -> StepPath {
        match self.arc {
            None => StepPath::Line,
            Some((centre, sweep)) => StepPath::Arc { plane, centre: centre.into(), sweep },
        }
    }
}

/// Returns a direction turned to the left.
fn left(direction: Vector2<f64>) -> Vector2<f64> {
    Vector2::new(-direction.y, direction.x)
}

/// Returns the angle from one direction to another, from −π to π.
fn angle(from: Vector2<f64>, to: Vector2<f64>) -> f64 {
    from.perp(&to).atan2(from.dot(&to))
}

impl Parallel {
    /// Returns the points that are on both curves.
    fn crossings(&self, other: &Parallel) -> Vec<Vector2<f64>> {
        match (self, other) {
            (
                Parallel::Line { point, direction },
                Parallel::Line { point: other, direction: across },
            ) => {
                let along = (other - point).perp(across) / direction.perp(across);
                vec![point + along * direction]
            }
            (Parallel::Line { point, direction }, Parallel::Circle { centre, radius })
            | (Parallel::Circle { centre, radius }, Parallel::Line { point, direction }) => {
                let middle = point + direction.dot(&(centre - point)) * direction;
                let half = (radius * radius - (middle - centre).norm_squared()).sqrt();
                [-half, half].map(|along| middle + along * direction).to_vec()
            }
            (
                Parallel::Circle { centre, radius },
                Parallel::Circle { centre: other, radius: other_radius },
            ) => {
                let between = other - centre;
                let distance = between.norm();
                let (one, two) = (radius * radius, other_radius * other_radius);
                let along = (distance + (one - two) / distance) / 2.0;
                let half = (one - along * along).sqrt();
                let direction = between / distance;
                let middle = centre + along * direction;
                [-half, half].map(|across| middle + across * left(direction)).to_vec()
            }
        }
    }
}

/// Returns a motion up to the corner at its end, the corner if there is one, and the motion after it.
fn trimmed(held: &HeldMotion, next: &Step, plane: Plane) -> Result<Vec<Step>, GcodeFault> {
    let HeldMotion { step, corner, length, .. } = held;
    let is_one_frame = Arc::ptr_eq(&step.state, &next.state) && held.plane == plane;
    let elements = [step, next].map(|step| Element::new(step, plane));
    let ([Some(before), Some(after)], true) = (elements, is_contour(next) && is_one_frame) else {
        return Err(beside(corner));
    };
    let word = corner.word;
    let has_arc = before.arc.is_some() || after.arc.is_some();
    if has_arc && corner.shape != CornerShape::Round {
        return Err(beside(corner));
    }
    let point = before.end;
    let (into, out) = (before.direction(point), after.direction(point));
    let (cross, dot) = (into.perp(&out), into.dot(&out));
    if cross.abs() < SMALLEST_SINE {
        if dot > 0.0 {
            // Motions that go on in one direction have no corner.
            return Ok(vec![step.clone(), next.clone()]);
        }
        return Err(combination(word, "the next motion goes back in its direction", "remove it"));
    }
    let parts = match corner.shape {
        CornerShape::Round => rounded(&before, &after, *length, cross.signum()),
        CornerShape::SquareChamfer if dot.abs() > 1e-9 => {
            let meaning = "a chamfer of a corner that is not square";
            return Err(not_read(word, meaning, "write the chamfer as a line"));
        }
        CornerShape::SquareChamfer | CornerShape::Chamfer => {
            chamfered(&before, &after, *length, [into, out])
        }
        CornerShape::Chord => {
            // Half of the angle between both lines.
            let half = 0.5 * (PI - cross.atan2(dot).abs());
            chamfered(&before, &after, 0.5 * length / half.sin(), [into, out])
        }
    };
    let Some([before, between, after]) = parts else {
        let condition = "a motion beside it is shorter than what it takes of it";
        return Err(combination(word, condition, "make the corner smaller"));
    };
    let axes = plane.axes();
    let at = |place: Vector2<f64>| {
        let mut position = step.end;
        for (axis, value) in axes.into_iter().zip(place.iter()) {
            position[axis] = Some(*value);
        }
        position
    };
    let mut commanded = [false; 6];
    axes.into_iter().for_each(|axis| commanded[axis] = true);
    let moved = |element: &Element, step: &Step| Step {
        start: at(element.start),
        end: at(element.end),
        commanded,
        path: element.path(plane),
        ..step.clone()
    };
    let first = Step { start: step.start, ..moved(&before, step) };
    let between = moved(&between, step);
    let last = Step { end: next.end, ..moved(&after, next) };
    Ok(vec![first, between, last])
}

/// Returns two elements cut off by an arc that touches both, and the arc between them. `side` is 1 if the contour turns to the left,
/// and −1 if it turns to the right.
fn rounded(before: &Element, after: &Element, radius: f64, side: f64) -> Option<[Element; 3]> {
    let point = before.end;
    let [one, two] = [before, after].map(|element| element.parallel(point, side * radius));
    let mut centres = one?.crossings(&two?);
    centres.retain(|centre| centre.iter().all(|value| value.is_finite()));
    centres.sort_by(|a, b| (a - point).norm_squared().total_cmp(&(b - point).norm_squared()));
    centres.into_iter().find_map(|centre| {
        let [from, to] = [before, after].map(|element| element.foot(point, centre));
        let sweep = side * (side * angle(from - centre, to - centre)).rem_euclid(TAU);
        let between = Element { start: from, end: to, arc: Some((centre, sweep)) };
        Some([before.part(from, true)?, between, after.part(to, false)?])
    })
}

/// Returns two lines without a length at the corner between them, and the line between.
fn chamfered(
    before: &Element,
    after: &Element,
    cut: f64,
    [into, out]: [Vector2<f64>; 2],
) -> Option<[Element; 3]> {
    let (from, to) = (before.end - cut * into, before.end + cut * out);
    let between = Element { start: from, end: to, arc: None };
    Some([before.part(from, true)?, between, after.part(to, false)?])
}
