//! Coordinates: the preset, the datum shift, mirrored axes, a rotation, tilted planes.
//!
//! A position is mirrored, rotated about z of the plane by cycle 10, turned with the tilted plane, and shifted by cycle 7. A shift in a
//! tilted plane is along its axes. Where the manual leaves the order of two of them open, the second one is refused.
//!
//! The angles of a plane are about the fixed axes x, y and z of the workpiece, in this order; those of PLANE EULER about z, the new x
//! and the new z (TNC 640, *Klartext programming*, "The PLANE function"). The preset that a program selects is the frame of the part; of
//! several, each has a work offset that the setup states.

use super::Program;
use super::block::{Coordinate, Feed, Retract, Scale, Words};
use super::expression::value;
use super::line::{Cursor, expected};
use super::words::{Entry, PLANES, find};
use crate::gcode::GcodeFault;
use crate::gcode::control::Control;
use crate::gcode::error::{combination, missing, not_read, same_group};
use crate::gcode::note::NoteKind;
use crate::gcode::state::{Frame as Map, Rotation, about};
use nalgebra::{Matrix3, Vector3};

/// Cosine of the angle between the vectors of PLANE VECTOR above which they are no right angle.
const LARGEST_COSINE: f64 = 1e-3;

/// The coordinates of a program.
#[derive(Clone, Debug)]
pub(super) struct Frame {
    /// The values of the datum shift.
    shift: [f64; 6],
    /// The shift that is in force outside of the tilted plane.
    base: [f64; 6],
    /// The angle of cycle 10, in degrees.
    turn: f64,
    /// Signs of X, Y and Z.
    pub(super) mirror: [f64; 3],
    tilt: Option<Matrix3<f64>>,
    /// The angles of the last cycle 19; `None` if PLANE has come after it.
    cycle_angles: Option<[f64; 3]>,
    /// Set if the rotary axes stand as the plane needs them.
    aligned: bool,
    /// Set if they are all at 0 then.
    is_at_zero: bool,
    /// The sign of the master axis in the plane, if the program states it (SEQ).
    master_is_positive: Option<bool>,
    /// The reason for which the shift depends on the control.
    pub(super) doubt: Option<&'static str>,
    /// The number of the preset, if the program has selected one.
    preset: Option<f64>,
    /// The allowance on the length of the tool (DL), by which the tip is higher along its axis.
    allowance: f64,
}

impl Frame {
    pub(super) fn new() -> Frame {
        Frame {
            shift: [0.0; 6],
            base: [0.0; 6],
            turn: 0.0,
            mirror: [1.0; 3],
            tilt: None,
            cycle_angles: Some([0.0; 3]),
            aligned: false,
            is_at_zero: false,
            master_is_positive: None,
            doubt: None,
            preset: None,
            allowance: 0.0,
        }
    }

    /// Notes that the rotary axes stand as the plane needs them.
    pub(super) fn stand(&mut self) {
        self.aligned = true;
    }

    /// Returns whether the tip is off the programmed position along the tool.
    pub(super) fn has_allowance(&self) -> bool {
        self.allowance != 0.0
    }

    /// Returns whether axes are mirrored.
    pub(super) fn is_mirrored(&self) -> bool {
        self.mirror != [1.0; 3]
    }

    /// Returns the rotation of the control.
    fn rotation(&self) -> Rotation {
        let turn = about(2, self.turn);
        match self.tilt {
            None if self.turn == 0.0 => Rotation::Off,
            None => Rotation::Plane { frame: Map { rotation: turn, origin: Vector3::zeros() } },
            Some(tilt) => {
                let [x, y, z] = [0, 1, 2].map(|axis| self.shift[axis] - self.base[axis]);
                let mut in_plane = if self.doubt.is_some() { [0.0; 3] } else { [x, y, z] };
                in_plane[2] += self.allowance;
                let frame = Map { rotation: tilt * turn, origin: tilt * Vector3::from(in_plane) };
                Rotation::Tilted { frame, aligned: self.aligned }
            }
        }
    }
}

impl Program<'_> {
    /// Gives the control the coordinates that hold now.
    fn change_frame(&mut self, control: &mut Control) {
        self.before.forget();
        let mut shift = self.frame.base;
        if self.frame.tilt.is_none() {
            shift[2] += self.frame.allowance;
        }
        control.set_coordinates(shift, self.frame.rotation());
    }

    /// Sets the allowance on the length of the tool. The tip is at the programmed position with it.
    pub(super) fn set_allowance(&mut self, allowance: f64, control: &mut Control) {
        if self.frame.allowance != allowance {
            self.frame.allowance = allowance;
            self.change_frame(control);
        }
    }

    /// Executes a line of an old cycle after its number and its part: 7, 8, 10 or 19.
    pub(super) fn old_cycle(
        &mut self,
        number: u32,
        cursor: &mut Cursor,
        control: &mut Control,
    ) -> Result<(), GcodeFault> {
        match number {
            7 => self.datum_shift(cursor, control),
            8 => self.mirror(cursor, control),
            10 => self.rotate(cursor, control),
            _ => self.working_plane(cursor, control),
        }
    }

    /// Executes the axes of CYCL DEF 7 or TRANS DATUM AXIS.
    pub(super) fn datum_shift(
        &mut self,
        cursor: &mut Cursor,
        control: &mut Control,
    ) -> Result<(), GcodeFault> {
        if cursor.peek() == Some(b'#') {
            let meaning = "a row of a datum table, which is another file";
            return Err(not_read("CYCL DEF 7 #", meaning, "write the values of its axes"));
        }
        let words = self.coordinates(cursor, "an axis with its shift")?;
        let mut shift = self.frame.shift;
        for (value, coordinate) in shift.iter_mut().zip(words.axes) {
            match coordinate {
                Some(Coordinate::Absolute(given)) => *value = given,
                Some(Coordinate::Incremental(given)) => *value += given,
                _ => {}
            }
        }
        self.set_shift(shift, control)
    }

    /// Sets the datum shift.
    pub(super) fn set_shift(
        &mut self,
        shift: [f64; 6],
        control: &mut Control,
    ) -> Result<(), GcodeFault> {
        let is_turned = self.frame.turn != 0.0 || self.frame.is_mirrored();
        if is_turned && shift != self.frame.shift && shift != [0.0; 6] {
            let condition = "axes are rotated (CYCL DEF 10) or mirrored (CYCL DEF 8)";
            return Err(combination("a datum shift", condition, "end that before"));
        }
        self.frame.shift = shift;
        if self.frame.tilt.is_none() {
            (self.frame.base, self.frame.doubt) = (shift, None);
        } else if shift == self.frame.base {
            self.frame.doubt = None;
        } else if self.frame.base != [0.0; 6] || shift[3..] != [0.0; 3] {
            self.frame.doubt =
                Some("the datum shift has changed in a tilted plane, which had another one before");
        }
        self.change_frame(control);
        Ok(())
    }

    /// Reads coordinates without other words.
    fn coordinates(
        &mut self,
        cursor: &mut Cursor,
        wanted: &'static str,
    ) -> Result<Words, GcodeFault> {
        let mut start = *cursor;
        let mut codes = Vec::new();
        let words = Scale::new(&self.parameters, self.unit).words(cursor, &mut codes)?;
        if !words.is_plain() || !codes.is_empty() || words.axes.contains(&Some(Coordinate::OfPlane))
        {
            return Err(start.unexpected(wanted));
        }
        Ok(words)
    }

    /// Executes the axes of CYCL DEF 8. Without one, none is mirrored.
    fn mirror(&mut self, cursor: &mut Cursor, control: &mut Control) -> Result<(), GcodeFault> {
        let mut mirror = [1.0; 3];
        while let Some(byte) = cursor.peek() {
            match byte {
                b'X' => mirror[0] = -1.0,
                b'Y' => mirror[1] = -1.0,
                _ => return Err(cursor.unexpected("X or Y, the axes that can be mirrored")),
            }
            cursor.advance();
        }
        if mirror != [1.0; 3] && (self.frame.turn != 0.0 || self.frame.tilt.is_some()) {
            let condition = "axes are rotated (CYCL DEF 10, PLANE)";
            return Err(combination("CYCL DEF 8", condition, "end that before"));
        }
        self.frame.mirror = mirror;
        self.change_frame(control);
        Ok(())
    }

    /// Executes the angle of CYCL DEF 10.
    fn rotate(&mut self, cursor: &mut Cursor, control: &mut Control) -> Result<(), GcodeFault> {
        let is_increment = cursor.take_text("IROT");
        if !is_increment && !cursor.take_text("ROT") {
            return Err(cursor.unexpected("ROT with an angle"));
        }
        let angle = value(cursor, &self.parameters)?;
        cursor.check_end()?;
        let turn = if is_increment { self.frame.turn + angle } else { angle };
        if turn != 0.0 && self.frame.is_mirrored() {
            let condition = "axes are mirrored (CYCL DEF 8)";
            return Err(combination("CYCL DEF 10", condition, "end that before"));
        }
        self.check_tcp("CYCL DEF 10", turn != 0.0, control)?;
        self.frame.turn = turn;
        self.change_frame(control);
        Ok(())
    }

    fn check_tcp(
        &self,
        word: &'static str,
        rotates: bool,
        control: &Control,
    ) -> Result<(), GcodeFault> {
        match rotates && control.is_tcp() {
            true => Err(combination(word, "M128 is in force", "write M129 before")),
            false => Ok(()),
        }
    }

    /// Executes the angles of CYCL DEF 19. Without one, no plane is tilted.
    fn working_plane(
        &mut self,
        cursor: &mut Cursor,
        control: &mut Control,
    ) -> Result<(), GcodeFault> {
        if cursor.is_at_end() {
            return self.end_plane(control);
        }
        let wanted =
            "the angles A, B and C without F and ABST, by which the control turns the axes";
        let words = self.coordinates(cursor, wanted)?;
        let mut angles = [0.0; 3];
        for (axis, (angle, coordinate)) in angles.iter_mut().zip(&words.axes[3..]).enumerate() {
            match coordinate {
                Some(Coordinate::Absolute(value)) => *angle = *value,
                // An angle that is not written is that of the plane before (TNC 640, cycle 19).
                None if self.frame.cycle_angles.is_some_and(|before| before[axis] == 0.0) => {}
                None => return Err(missing("CYCL DEF 19", "all of A, B and C after a plane")),
                Some(_) => return Err(expected("CYCL DEF 19", wanted)),
            }
        }
        self.tilt("CYCL DEF 19", spatial(angles), control)?;
        self.frame.cycle_angles = Some(angles);
        Ok(())
    }

    /// Tilts the plane. The axes rest.
    fn tilt(
        &mut self,
        word: &'static str,
        rotation: Matrix3<f64>,
        control: &mut Control,
    ) -> Result<(), GcodeFault> {
        self.check_tcp(word, true, control)?;
        if self.frame.turn != 0.0 || self.frame.is_mirrored() {
            let condition = "axes are rotated (CYCL DEF 10) or mirrored (CYCL DEF 8)";
            return Err(combination(word, condition, "end that before"));
        }
        if self.frame.tilt.is_some() && self.frame.shift != self.frame.base {
            let condition = "the datum shift has changed in a tilted plane";
            return Err(combination(word, condition, "write PLANE RESET before"));
        }
        (self.frame.tilt, self.frame.aligned) = (Some(rotation), false);
        self.frame.cycle_angles = None;
        (self.frame.master_is_positive, self.frame.is_at_zero) = (None, false);
        self.change_frame(control);
        control.begin_plane();
        Ok(())
    }

    /// Ends the tilted plane. The axes rest.
    fn end_plane(&mut self, control: &mut Control) -> Result<(), GcodeFault> {
        if self.frame.turn != 0.0 && self.frame.tilt.is_some() {
            let condition = "axes are rotated in the tilted plane (CYCL DEF 10)";
            return Err(combination("the end of a plane", condition, "end that before"));
        }
        let has_moved = self.frame.shift != self.frame.base && self.frame.shift != [0.0; 6];
        self.frame.doubt =
            has_moved.then_some("the datum shift has changed in a tilted plane, which has ended");
        (self.frame.tilt, self.frame.aligned) = (None, false);
        self.frame.base = self.frame.shift;
        self.change_frame(control);
        Ok(())
    }

    /// Executes PLANE.
    pub(super) fn plane(
        &mut self,
        cursor: &mut Cursor,
        control: &mut Control,
    ) -> Result<(), GcodeFault> {
        let form = cursor.letters().to_ascii_uppercase();
        let Some(entry) = find(&PLANES, &form) else {
            return Err(expected(&form, "SPATIAL, EULER, VECTOR, RELATIV or RESET after PLANE"));
        };
        entry.check()?;
        let words = self.plane_words(cursor, control)?;
        let [spa, spb, spc, precession, nutation, turn, bx, by, bz, nx, ny, nz] = words.values;
        let needed = |value: Option<f64>, needed| {
            value.ok_or_else(|| missing(format!("PLANE {form}"), needed))
        };
        let rotation = match form.as_str() {
            "RESET" => None,
            "SPATIAL" => {
                let all = "the angles SPA, SPB and SPC";
                Some(spatial([needed(spa, all)?, needed(spb, all)?, needed(spc, all)?]))
            }
            "EULER" => {
                let all = "the angles EULPR, EULNU and EULROT";
                let [first, second, third] =
                    [needed(precession, all)?, needed(nutation, all)?, needed(turn, all)?];
                Some(about(2, first) * about(0, second) * about(2, third))
            }
            "VECTOR" => {
                let all = "the vectors BX BY BZ and NX NY NZ";
                let base = Vector3::new(needed(bx, all)?, needed(by, all)?, needed(bz, all)?);
                let normal = Vector3::new(needed(nx, all)?, needed(ny, all)?, needed(nz, all)?);
                Some(from_vectors(base, normal)?)
            }
            "RELATIV" => {
                // Without a plane before, the angle is about an axis of the untilted one.
                let tilt = self.frame.tilt.unwrap_or_else(Matrix3::identity);
                let (axis, angle) = match (spa, spb, spc) {
                    (Some(angle), None, None) => (0, angle),
                    (None, Some(angle), None) => (1, angle),
                    (None, None, Some(angle)) => (2, angle),
                    _ => return Err(missing("PLANE RELATIV", "one of SPA, SPB and SPC")),
                };
                Some(tilt * about(axis, angle))
            }
            _ => return Err(expected(&form, "the form of the plane after PLANE")),
        };
        if rotation.is_some() && words.positioning.is_none() {
            return Err(missing(format!("PLANE {form}"), "TURN, MOVE or STAY"));
        }
        let (turns, pivot) = match words.positioning {
            Some(Positioning::Turn) => (true, None),
            Some(Positioning::Move { distance }) => (true, Some(distance)),
            Some(Positioning::Stay) | None => (false, None),
        };
        if pivot.is_some() && self.frame.has_allowance() {
            let condition = "the tool has an allowance on its length (DL)";
            return Err(combination("MOVE", condition, "write DL+0 in TOOL CALL"));
        }
        if pivot.is_some() && !control.has_length() {
            return Err(missing("MOVE", "a tool with its length (TOOL CALL) before"));
        }
        if let Some(retract) = words.retract.filter(|_| turns) {
            control.retract(retract.distance, retract.rapid);
        }
        match rotation {
            Some(rotation) => {
                // Where the normal stays, only the table or only the plane turns. Without any turn, the table is at 0.
                let is_at_zero = words.turns_table && rotation == Matrix3::identity();
                if let Some(entry) = words.symmetry.filter(|_| !is_at_zero) {
                    entry.check()?;
                }
                if words.turns_table && !is_at_zero && (rotation[(2, 2)] - 1.0).abs() < 1e-12 {
                    let meaning = "a turn of the table about the tool, which leaves the plane";
                    return Err(not_read("TABLE ROT", meaning, "write COORD ROT"));
                }
                self.tilt("PLANE", rotation, control)?;
                self.frame.master_is_positive = words.master_is_positive;
                self.frame.is_at_zero = is_at_zero;
                if turns && is_at_zero {
                    control.turn_to_zero(pivot);
                    self.frame.aligned = true;
                    self.change_frame(control);
                } else if turns {
                    control.align_with_plane(pivot, words.master_is_positive);
                    self.frame.aligned = true;
                }
            }
            None => {
                self.end_plane(control)?;
                if turns {
                    control.turn_to_zero(pivot);
                }
            }
        }
        Ok(())
    }

    /// Reads the words after the form of a plane.
    fn plane_words(
        &mut self,
        cursor: &mut Cursor,
        control: &mut Control,
    ) -> Result<PlaneWords, GcodeFault> {
        let scale = Scale::new(&self.parameters, self.unit);
        let mut words = PlaneWords::default();
        while !cursor.is_at_end() {
            if let Some(index) = VALUES.iter().position(|name| cursor.take_text(name)) {
                words.values[index] = Some(value(cursor, &self.parameters)?);
                continue;
            }
            let mut refused = PLANES.iter().filter(|entry| entry.check().is_err());
            match refused.find(|entry| cursor.take_text(entry.word)) {
                Some(entry) if entry.word.starts_with("SYM") => {
                    words.symmetry = Some(entry);
                    continue;
                }
                Some(entry) => entry.check()?,
                None => {}
            }
            if cursor.take_text("TURN") {
                words.set(Positioning::Turn)?;
            } else if cursor.take_text("MOVE") {
                let has_distance = ["DIST", "ABST", "SETUP"].iter().any(|w| cursor.take_text(w));
                let distance = if has_distance { scale.length(cursor)? } else { 0.0 };
                if distance < 0.0 {
                    return Err(missing("DIST", "a distance from 0"));
                }
                words.set(Positioning::Move { distance })?;
            } else if cursor.take_text("STAY") {
                words.set(Positioning::Stay)?;
            } else if cursor.take_text("COORD") && cursor.take_text("ROT") {
                let word = "COORD ROT".to_owned();
                control.notes.add(control.block(), NoteKind::PassedOver { word });
            } else if cursor.take_text("TABLE") && cursor.take_text("ROT") {
                words.turns_table = true;
            } else if cursor.take_text("SEQ") {
                let is_positive = cursor.take(b'+');
                if !is_positive && !cursor.take(b'-') {
                    return Err(cursor.unexpected("SEQ+ or SEQ-"));
                }
                words.master_is_positive = Some(is_positive);
            } else if matches!(cursor.peek(), Some(b'M')) {
                words.retract = Some(scale.retract(cursor)?);
            } else if matches!(cursor.peek(), Some(b'F')) {
                // The rate of the rotary axes: their path is the same.
                let _: Feed = scale.feed(cursor)?;
            } else {
                return Err(cursor.unexpected("an angle, a vector, TURN, MOVE, STAY, MB or F"));
            }
        }
        Ok(words)
    }

    /// Turns the rotary axes to the tilted plane: `L A+Q120 B+Q121 C+Q122`.
    pub(super) fn turn_to_plane(
        &mut self,
        words: &Words,
        control: &mut Control,
    ) -> Result<(), GcodeFault> {
        let is_other =
            |word: &Option<Coordinate>| !matches!(word, None | Some(Coordinate::OfPlane));
        if words.axes.iter().any(is_other) {
            let condition = "its block has another coordinate";
            let remedy = "turn the axes in a block of their own";
            return Err(combination("Q120 to Q122", condition, remedy));
        }
        if !matches!(control.rotation(), Rotation::Tilted { .. }) {
            return Err(missing("Q120 to Q122", "a tilted plane (PLANE) before"));
        }
        let missed = control.rotary_axes().zip(&words.axes[3..]).zip(["A", "B", "C"]);
        if let Some((_, letter)) =
            missed.into_iter().find(|((has, word), _)| *has && word.is_none())
        {
            let needed = "all rotary axes of the machine, since the plane depends on each";
            return Err(missing(format!("Q120 to Q122 without {letter}"), needed));
        }
        control.execute(&mut self.block)?;
        if self.frame.is_at_zero {
            control.turn_to_zero(None);
            self.frame.aligned = true;
            self.change_frame(control);
        } else {
            control.align_with_plane(None, self.frame.master_is_positive);
        }
        self.frame.aligned = true;
        self.before.forget();
        Ok(())
    }

    /// Executes CYCL DEF 247.
    pub(super) fn preset(&mut self, number: f64, control: &mut Control) -> Result<(), GcodeFault> {
        let word = format!("CYCL DEF 247 Q339={number}");
        match self.frame.preset {
            Some(before) if before != number && !control.has_presets() => {
                let meaning =
                    "another preset than the one before, whose place only the machine knows";
                let remedy = "state the work offset of each in `presets` of the job";
                return Err(not_read(word, meaning, remedy));
            }
            None if self.positioned => {
                let condition = "positions of the preset before it stand in the program";
                return Err(combination(word, condition, "select the preset first"));
            }
            _ => {}
        }
        if self.frame.tilt.is_some() {
            let condition = "a plane is tilted";
            return Err(combination(word, condition, "write PLANE RESET before"));
        }
        // It ends the shift, mirrored axes and the rotation.
        let allowance = self.frame.allowance;
        self.frame = Frame { preset: Some(number), allowance, ..Frame::new() };
        self.change_frame(control);
        if control.has_presets() && !control.select_preset(number) {
            let meaning = "a preset whose work offset is not stated";
            return Err(not_read(word, meaning, "state it in `presets` of the job"));
        }
        Ok(())
    }
}

/// The motion of the rotary axes.
#[derive(Clone, Copy)]
enum Positioning {
    /// They turn, and X, Y and Z rest.
    Turn,
    /// They turn, and X, Y and Z follow about the point below the tip by a distance in millimetres.
    Move { distance: f64 },
    /// They rest.
    Stay,
}

/// The words after the form of a plane.
#[derive(Default)]
struct PlaneWords {
    /// By the order of [`VALUES`].
    values: [Option<f64>; 12],
    positioning: Option<Positioning>,
    /// TABLE ROT.
    turns_table: bool,
    /// SEQ+ or SEQ-.
    master_is_positive: Option<bool>,
    /// SYM+ or SYM-, which says nothing where nothing turns.
    symmetry: Option<&'static Entry>,
    retract: Option<Retract>,
}

impl Positioning {
    fn word(self) -> &'static str {
        match self {
            Positioning::Turn => "TURN",
            Positioning::Move { .. } => "MOVE",
            Positioning::Stay => "STAY",
        }
    }
}

impl PlaneWords {
    fn set(&mut self, positioning: Positioning) -> Result<(), GcodeFault> {
        match self.positioning.replace(positioning) {
            Some(before) => Err(same_group(before.word(), positioning.word())),
            None => Ok(()),
        }
    }
}

/// The numbers of a plane.
const VALUES: [&str; 12] =
    ["SPA", "SPB", "SPC", "EULPR", "EULNU", "EULROT", "BX", "BY", "BZ", "NX", "NY", "NZ"];

/// Returns the rotation by angles in degrees about the fixed x, y and z, in this order.
fn spatial([a, b, c]: [f64; 3]) -> Matrix3<f64> {
    about(2, c) * about(1, b) * about(0, a)
}

/// Returns the rotation whose x has the direction of a base, and whose z is a normal.
fn from_vectors(base: Vector3<f64>, normal: Vector3<f64>) -> Result<Matrix3<f64>, GcodeFault> {
    let lengths = [base.norm(), normal.norm()];
    let expected = "two vectors at right angles";
    let shown = || "PLANE VECTOR".to_owned();
    if lengths.iter().any(|length| *length < 1e-6) {
        return Err(GcodeFault::Sentence { shown: shown(), expected });
    }
    let (base, normal) = (base / lengths[0], normal / lengths[1]);
    if base.dot(&normal).abs() > LARGEST_COSINE {
        return Err(GcodeFault::Sentence { shown: shown(), expected });
    }
    let y = normal.cross(&base).normalize();
    Ok(Matrix3::from_columns(&[y.cross(&normal), y, normal]))
}
