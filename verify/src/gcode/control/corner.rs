//! Corners of a contour (`,R` and `,C` of Fanuc and Haas, `RND=`, `CHR=` and `CHF=` of Sinumerik): the arc or the chamfer between two lines.
//!
//! The line that states a corner is held until the next motion (known: Fanuc, *Optional chamfering and corner R*; Siemens, *NC programming*).

use super::{Control, FeedMode, in_plane};
use crate::gcode::block::Block;
use crate::gcode::error::{combination, missing, not_read};
use crate::gcode::rules::{Choice, Rule};
use crate::gcode::{GcodeFault, Plane, Step, StepPath};
use nalgebra::Vector2;
use std::f64::consts::PI;
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
    /// An arc that touches both lines, by its radius.
    Round,
    /// A chamfer, by the distance of both ends from the corner.
    Chamfer,
    /// A chamfer, by its own length.
    Chord,
}

/// A line, and the corner at its end.
#[derive(Clone, Debug)]
pub(super) struct HeldLine {
    step: Step,
    corner: Corner,
    /// In millimetres.
    length: f64,
    plane: Plane,
}

/// Smallest sine of the angle between two lines with a corner.
const SMALLEST_SINE: f64 = 1e-6;

impl Control {
    /// Ends the line that is held with its corner, and holds the one that the block has added after the step `first`, if it states a corner.
    pub(super) fn corners(&mut self, block: &mut Block, first: usize) -> Result<(), GcodeFault> {
        if let (Some(held), true) = (&self.held_line, self.pending.len() > first) {
            let steps = round(held, &self.pending[first], self.modal.plane)?;
            self.pending.remove(first);
            for (index, step) in steps.into_iter().enumerate() {
                self.pending.insert(first + index, step);
            }
            self.held_line = None;
        }
        let Some(corner) = block.corner.take() else { return Ok(()) };
        let word = corner.word;
        let is_increment = corner.is_whole && self.choice(Rule::WholeNumbers) == Choice::Increments;
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
        let step = self.pending.pop_back_if(|step| is_moved && is_line(step));
        let Some(step) = step else {
            return Err(not_read(word, "a corner that is not between two lines", WRITE_OUT));
        };
        self.held_line = Some(HeldLine { step, corner, length, plane: self.modal.plane });
        Ok(())
    }

    /// Refuses a corner without a motion after it.
    pub(super) fn check_corner(&self) -> Result<(), GcodeFault> {
        match &self.held_line {
            None => Ok(()),
            Some(held) => Err(missing(held.corner.word, "a line (G1) in its plane after it")),
        }
    }
}

const WRITE_OUT: &str = "write the corner as a motion of its own";

fn is_line(step: &Step) -> bool {
    step.path == StepPath::Line && !step.rapid && step.tool_vector.is_none()
}

/// Returns a line up to the corner at its end, the corner, and the line after it.
fn round(held: &HeldLine, next: &Step, plane: Plane) -> Result<[Step; 3], GcodeFault> {
    let HeldLine { step, corner, length, .. } = held;
    let axes = plane.axes();
    let word = corner.word;
    let beside =
        || not_read(word, "a corner that is not between two lines in its plane", WRITE_OUT);
    let is_level = |step: &Step| {
        let others = (0..6).filter(|axis| !axes.contains(axis));
        others.into_iter().all(|axis| !step.commanded[axis] || step.start[axis] == step.end[axis])
    };
    let is_one_frame = Arc::ptr_eq(&step.state, &next.state) && held.plane == plane;
    if !is_line(next) || !is_level(step) || !is_level(next) || !is_one_frame {
        return Err(beside());
    }
    let place = |position| in_plane(position, axes).map(Vector2::from);
    let (Some(start), Some(point), Some(end)) =
        (place(&step.start), place(&step.end), place(&next.end))
    else {
        return Err(missing(word, "known positions in its plane before it"));
    };
    let (back, ahead) = (start - point, end - point);
    let lengths = [back.norm(), ahead.norm()];
    if lengths.contains(&0.0) {
        return Err(beside());
    }
    let (back, ahead) = (back / lengths[0], ahead / lengths[1]);
    // The turn from the direction into the corner to the one out of it.
    let (cross, dot) = (-back.perp(&ahead), -back.dot(&ahead));
    if cross.abs() < SMALLEST_SINE {
        let condition = "the next line goes on in its direction, or back";
        return Err(combination(word, condition, "remove it"));
    }
    let turn = cross.atan2(dot);
    // Half of the angle between both lines.
    let half = 0.5 * (PI - turn.abs());
    let cut = match corner.shape {
        CornerShape::Round => length / half.tan(),
        CornerShape::Chamfer => *length,
        CornerShape::Chord => 0.5 * length / half.sin(),
    };
    if cut > lengths[0].min(lengths[1]) {
        let condition = "a line beside it is shorter than what it takes of it";
        return Err(combination(word, condition, "make the corner smaller"));
    }
    let [from, to] = [back, ahead].map(|direction| point + cut * direction);
    let path = if corner.shape == CornerShape::Round {
        let inward = (back + ahead).normalize();
        let centre = point + inward * (length / half.sin());
        StepPath::Arc { plane, centre: centre.into(), sweep: turn }
    } else {
        StepPath::Line
    };
    let at = |place: Vector2<f64>| {
        let mut position = step.end;
        for (axis, value) in axes.into_iter().zip(place.iter()) {
            position[axis] = Some(*value);
        }
        position
    };
    let mut commanded = [false; 6];
    axes.into_iter().for_each(|axis| commanded[axis] = true);
    let line = Step { end: at(from), commanded, ..step.clone() };
    let corner = Step { start: at(from), end: at(to), commanded, path, ..step.clone() };
    let next = Step { start: at(to), commanded, ..next.clone() };
    Ok([line, corner, next])
}
