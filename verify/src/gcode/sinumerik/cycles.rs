//! Calls of cycles: their arguments, drilling cycles, and CYCLE800.
//!
//! Positions of arguments are those of *NC programming*, section "Programming cycles externally". A drilling cycle moves in rapid
//! traverse to the safety distance above the reference plane, at feed rate to its depth, and back. Retracts between the infeeds of
//! CYCLE83 and CYCLE84 stay on the way of the drill, and are left out.

use super::expression::{Value, expression};
use super::text::Cursor;
use super::variables::Variables;
use crate::gcode::control::{Hole, Retract, Swivel, TapTurn, Tapping, Thread};
use crate::gcode::error::{combination, missing, not_read};
use crate::gcode::state::about;
use crate::gcode::{Alignment, ExpressionFault, GcodeFault};
use nalgebra::{Matrix3, Vector3};

/// Reads arguments in brackets, if there are any. One that is left out is `None`.
pub(super) fn arguments(
    cursor: &mut Cursor,
    known: &Variables,
) -> Result<Vec<Option<Value>>, GcodeFault> {
    let mut found = Vec::new();
    if !cursor.take(b'(') {
        return Ok(found);
    }
    loop {
        let is_left_out = matches!(cursor.peek(), Some(b',' | b')'));
        found.push(if is_left_out { None } else { Some(expression(cursor, known)?) });
        if cursor.take(b')') {
            return Ok(found);
        }
        if !cursor.take(b',') {
            return Err(ExpressionFault::OpenParenthesis.into());
        }
    }
}

/// The arguments of a cycle.
struct Arguments {
    cycle: &'static str,
    values: Vec<Option<Value>>,
}

impl Arguments {
    /// Returns a number, if it is given.
    fn number(&self, index: usize) -> Result<Option<f64>, GcodeFault> {
        self.values.get(index).and_then(Option::as_ref).map(Value::number).transpose()
    }

    fn number_or_zero(&self, index: usize) -> Result<f64, GcodeFault> {
        Ok(self.number(index)?.unwrap_or(0.0))
    }

    /// Returns a number with a code in each decimal digit, 0 if it is left out.
    fn digits(&self, index: usize) -> Result<u32, GcodeFault> {
        let value = self.number_or_zero(index)?;
        match value.fract() == 0.0 && (0.0..=1e9).contains(&value) {
            true => Ok(value as u32),
            false => Err(self.refused(index, "no whole number", "write a code of its manual")),
        }
    }

    fn refused(&self, index: usize, meaning: &'static str, remedy: &'static str) -> GcodeFault {
        not_read(format!("argument {} of {}", index + 1, self.cycle), meaning, remedy)
    }

    /// Refuses an argument that is neither left out nor 0.
    fn check_zero(
        &self,
        index: usize,
        meaning: &'static str,
        remedy: &'static str,
    ) -> Result<(), GcodeFault> {
        match self.number_or_zero(index)? == 0.0 {
            true => Ok(()),
            false => Err(self.refused(index, meaning, remedy)),
        }
    }
}

/// The arguments of a drilling cycle, by their places from 0.
struct Layout {
    cycle: &'static str,
    /// The drilling axis.
    axis: Option<usize>,
    /// Measure of the depth at the tool.
    geometry: usize,
    /// The plane.
    plane: usize,
    /// The meaning of the depth.
    depth: usize,
}

const LAYOUTS: [Layout; 8] = [
    Layout { cycle: "CYCLE81", axis: None, geometry: 6, plane: 7, depth: 8 },
    Layout { cycle: "CYCLE82", axis: None, geometry: 6, plane: 7, depth: 8 },
    Layout { cycle: "CYCLE83", axis: Some(12), geometry: 17, plane: 18, depth: 19 },
    Layout { cycle: "CYCLE84", axis: Some(12), geometry: 21, plane: 22, depth: 23 },
    Layout { cycle: "CYCLE840", axis: Some(11), geometry: 17, plane: 18, depth: 19 },
    Layout { cycle: "CYCLE85", axis: None, geometry: 8, plane: 9, depth: 10 },
    Layout { cycle: "CYCLE86", axis: None, geometry: 11, plane: 12, depth: 13 },
    Layout { cycle: "CYCLE89", axis: None, geometry: 6, plane: 7, depth: 8 },
];

/// Returns whether a name is that of a cycle which is read.
pub(super) fn is_cycle(name: &str) -> bool {
    name.eq_ignore_ascii_case("CYCLE800")
        || LAYOUTS.iter().any(|layout| name.eq_ignore_ascii_case(layout.cycle))
}

/// Reads the call of a drilling cycle after its name, or returns `None` for another name.
pub(super) fn hole(
    name: &str,
    cursor: &mut Cursor,
    known: &Variables,
) -> Result<Option<Hole>, GcodeFault> {
    let layout = LAYOUTS.iter().find(|layout| name.eq_ignore_ascii_case(layout.cycle));
    let Some(Layout { cycle, axis, geometry, plane, depth }) = layout else { return Ok(None) };
    let given = Arguments { cycle, values: arguments(cursor, known)? };
    // The meaning of the depth is the last one.
    if let Some(more) = (depth + 1..given.values.len()).find(|index| given.values[*index].is_some())
    {
        let meaning = "more than the arguments of the cycle";
        return Err(given.refused(more, meaning, "remove it"));
    }
    // In G17 the third axis is the drilling axis.
    if let Some(axis) = axis
        && !matches!(given.digits(*axis)?, 0 | 3)
    {
        return Err(given.refused(*axis, "another drilling axis", "leave it out, in G17"));
    }
    if !matches!(given.digits(*plane)? % 10, 0 | 1) {
        return Err(given.refused(*plane, "another plane than G17", "leave it out, in G17"));
    }
    if given.digits(*geometry)? / 10 % 10 != 0 {
        let meaning = "a depth by the diameter or the shank of the tool";
        return Err(given.refused(*geometry, meaning, "write the depth of the tip"));
    }
    let retract = given.number(0)?.ok_or_else(|| missing(*cycle, "its retract plane"))?;
    let reference = given.number_or_zero(1)?;
    let safe = reference + given.number_or_zero(2)?.abs();
    let depth = final_depth(&given, reference, *depth)?;
    if retract < reference {
        return Err(missing(*cycle, "a retract plane that is not below its reference plane"));
    }
    if depth >= reference {
        return Err(GcodeFault::CycleBelow { retract: reference, depth });
    }
    let mut hole = Hole {
        cycle,
        retract,
        safe,
        depth,
        returns_at_feed: false,
        has_feed: false,
        tapping: None,
    };
    match *cycle {
        "CYCLE84" | "CYCLE840" => {
            let after = given.digits(if *cycle == "CYCLE84" { 6 } else { 7 })?;
            // Its feed is the pitch times the speed.
            let pitch = if *cycle == "CYCLE84" { [7, 8] } else { [9, 10] };
            let [size, pitch] = pitch.map(|index| given.number_or_zero(index));
            let pitch = Some(size?).filter(|size| *size != 0.0).unwrap_or(pitch?);
            hole.has_feed = pitch != 0.0;
            let turn = match *cycle {
                "CYCLE84" => TapTurn::OfCycle(Thread::of_pitch(pitch)),
                _ => TapTurn::OfSpindle,
            };
            hole.tapping = Some(Tapping { turn, after });
            hole.returns_at_feed = true;
        }
        "CYCLE85" => {
            hole.has_feed = given.number_or_zero(6)? > 0.0;
            hole.returns_at_feed = true;
        }
        "CYCLE86" => {
            for index in 7..=9 {
                let meaning = "a lateral retract with a stopped spindle";
                given.check_zero(index, meaning, "post the hole with its motions")?;
            }
        }
        "CYCLE89" => hole.returns_at_feed = true,
        _ => {}
    }
    Ok(Some(hole))
}

/// Returns the depth of a hole: from its absolute argument, or from the one below the reference plane.
fn final_depth(given: &Arguments, reference: f64, meaning: usize) -> Result<f64, GcodeFault> {
    let (absolute, below) = (given.number(3)?, given.number(4)?.map(f64::abs));
    let needed = || missing(given.cycle, "its final depth");
    match given.digits(meaning)? % 10 {
        1 => below.map(|below| reference - below).ok_or_else(needed),
        2 => absolute.ok_or_else(needed),
        // A depth of 0 below the reference plane is none.
        _ => match (absolute, below.filter(|below| *below != 0.0)) {
            (Some(absolute), Some(below)) if absolute != reference - below => {
                let condition = "its two depths differ, of which the control takes the second";
                Err(combination(given.cycle, condition, "keep one of them"))
            }
            (_, Some(below)) => Ok(reference - below),
            (Some(absolute), None) => Ok(absolute),
            (None, None) => Err(needed()),
        },
    }
}

/// Reads the call of CYCLE800 after its name.
///
/// Its arguments are the retract, the swivel data record, the state, the mode, the point before the rotation X0 Y0 Z0, three angles,
/// the point after it X1 Y1 Z1, the direction, the distance of the retract, and codes. The mode has a code in each pair of bits, from the
/// lowest: the axes of the first, the second and the third rotation, and the kind of angles.
pub(super) fn swivel(cursor: &mut Cursor, known: &Variables) -> Result<Swivel, GcodeFault> {
    let given = Arguments { cycle: "CYCLE800", values: arguments(cursor, known)? };
    let name = match given.values.get(1) {
        Some(Some(Value::Text(name))) => name.as_str(),
        _ => "",
    };
    let is_reset = given.values.iter().all(Option::is_none) || name == "0";
    let retract = match given.digits(0)? {
        0 => Retract::None,
        1 => Retract::Z,
        2 => Retract::All,
        4 => Retract::Tool { distance: None },
        5 => Retract::Tool { distance: Some(given.number_or_zero(14)?) },
        _ => return Err(given.refused(0, "another retract", "write 0, 1, 2, 4 or 5")),
    };
    if is_reset {
        return Ok(Swivel { retract, ..Swivel::reset() });
    }
    let state = given.digits(2)?;
    if state / 100 % 1000 != 0 || state / 100_000 > 2 || state % 100 > 11 || state % 10 > 1 {
        let meaning = "another state than a new plane or an additional one";
        return Err(given.refused(
            2,
            meaning,
            "write 0 or 1, with the direction in its highest digit",
        ));
    }
    let mode = given.digits(3)?;
    if mode > 63 {
        let meaning =
            "a plane by solid angles, by projected angles or by the rotary axes themselves";
        return Err(given.refused(3, meaning, "write the angles axis by axis, such as mode 57"));
    }
    let mut rotation = Matrix3::identity();
    for (index, shift) in [(7, 0), (8, 2), (9, 4)] {
        let angle = given.number_or_zero(index)?;
        match mode >> shift & 3 {
            0 if angle == 0.0 => {}
            0 => {
                return Err(given.refused(
                    3,
                    "a mode without the axis of an angle",
                    "write mode 57",
                ));
            }
            axis => rotation *= about(axis as usize - 1, angle),
        }
    }
    let point = |first: usize| -> Result<Vector3<f64>, GcodeFault> {
        let [x, y, z] = [first, first + 1, first + 2].map(|index| given.number_or_zero(index));
        Ok(Vector3::new(x?, y?, z?))
    };
    let direction = given.number_or_zero(13)?;
    if ![-1.0, 0.0, 1.0].contains(&direction) {
        return Err(given.refused(13, "another direction", "write -1, 0 or 1"));
    }
    if !matches!(given.digits(15)? % 10, 0 | 1) {
        return Err(given.refused(15, "another plane than G17", "leave it out, in G17"));
    }
    Ok(Swivel {
        is_reset: false,
        is_additive: state % 10 == 1,
        before: point(4)?,
        rotation,
        after: point(10)?,
        alignment: (direction != 0.0).then_some(Alignment::Value { is_higher: direction > 0.0 }),
        follows_tip: state / 10 % 10 == 1,
        retract,
    })
}
