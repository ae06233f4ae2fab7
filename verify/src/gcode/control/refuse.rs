//! Words and positions that controls execute in different ways, and that are refused or noted for it.
//!
//! `docs/controls.md` lists them with what each control does.

use super::{AXES, Control, Motion, in_plane, linuxcnc};
use crate::gcode::block::{Block, Code, Group};
use crate::gcode::error::{combination, not_read, same_group};
use crate::gcode::note::NoteKind;
use crate::gcode::rules::{Choice, Rule};
use crate::gcode::state::{LengthOffset, Position, Rotation, Tcp};
use crate::gcode::{GcodeFault, StepPath};
use std::f64::consts::{PI, SQRT_2, TAU};

/// Distance between the paths of controls on an arc with two radii, in mm, up to which it is rounding: of I and J with three
/// decimals, or four in inches.
const RADII_TOLERANCE: f64 = 5e-3;

/// Controls that stop at an arc whose radii differ by more than a length in mm, and by more than a fraction of the radius.
const RADII_LIMITS: [(&str, f64, f64); 3] =
    [("grbl", 5e-3, 1e-3), ("Siemens", 1e-2, 1e-3), ("Heidenhain", 1.6e-2, 0.0)];

/// Names the controls that stop at an arc whose radii differ, in mm.
fn stops(difference: f64, radius: f64) -> String {
    let limits = RADII_LIMITS.iter();
    let stop = limits.filter(|(_, length, part)| difference > length.max(part * radius));
    match &stop.map(|(name, ..)| *name).collect::<Vec<_>>()[..] {
        [] => "some controls stop".to_owned(),
        [name] => format!("{name} stops"),
        names => format!("{} stop", names.join(", ")),
    }
}

/// Greatest width of a band that is checked as a whole, in mm, about an arc of more than half a turn.
const MAX_BAND: f64 = 0.12;

/// Least radius of a band, in mm.
const LEAST_RADIUS: f64 = 2e-4;

/// Returns the radii between which every curve of an arc is that controls take, from the vectors from its centre to its ends. There are
/// none if the radii differ by no more than rounding, or if the curves are far from each other.
///
/// Up to half a turn, curves are between the circles through both ends. A control that moves the centre to the same distance from both
/// ends moves it along the chord, and by more than the difference of the radii if the arc is longer. Its circle then winds around the
/// programmed centre, too, or the arc is a full turn, which covers every direction.
pub(crate) fn band_radii(arms: [[f64; 2]; 2], sweep: f64) -> Option<[f64; 2]> {
    let [from, to] = arms.map(|[u, v]| u.hypot(v));
    let difference = (from - to).abs();
    if difference <= RADII_TOLERANCE {
        return None;
    }
    let [least, most] = [from.min(to), from.max(to)];
    if sweep.abs() <= PI {
        return Some([least, most]);
    }
    let [[a, b], [c, d]] = arms;
    let chord = (c - a).hypot(d - b);
    let along = [(c - a) / chord, (d - b) / chord];
    let shift = 0.5 * ((a + c) * along[0] + (b + d) * along[1]);
    let radius = (a - shift * along[0]).hypot(b - shift * along[1]);
    let is_around = shift.abs() < radius || sweep.abs() > TAU - 1e-9;
    let band = [(least - shift.abs()).max(LEAST_RADIUS), most + shift.abs()];
    (is_around && band[1] - band[0] <= MAX_BAND).then_some(band)
}

impl Control {
    /// Refuses words that mean something else in the dialect of the control.
    pub(in crate::gcode) fn check_dialect(&mut self, block: &Block) -> Result<(), GcodeFault> {
        if let (Some(Choice::Iso | Choice::Rs274Ngc), Some(code)) =
            (self.stated(Rule::Dialect), block.code_of(Group::Units))
            && code.tenths > 210
        {
            if matches!(code.tenths, 700 | 710) && block.has_any("IJL") {
                let meaning = "a pattern of holes of Haas, on a circle or an arc";
                let remedy = "post its holes one by one";
                return Err(not_read(code, meaning, remedy));
            }
            let meaning = "a unit in programs of Sinumerik and Heidenhain, and a cycle elsewhere";
            let remedy = "write G20 or G21";
            return Err(not_read(code, meaning, remedy));
        }
        // The dialect is asked only if the block has such a word.
        let other = block.codes().find(|code| is_other_on_heidenhain(*code));
        if let Some(code) = other
            && self.choice(Rule::Dialect) == Choice::Heidenhain
        {
            let meaning = "another word in DIN/ISO programs of Heidenhain";
            let remedy = "post the program for this control, or state another `dialect`";
            return Err(not_read(code, meaning, remedy));
        }
        let dialect = self.stated(Rule::Dialect);
        if dialect == Some(Choice::Rs274Ngc) {
            linuxcnc::check_words(block)?;
        }
        if matches!(dialect, Some(Choice::Iso | Choice::Sinumerik))
            && let Some(code) = block.codes().find(is_of_linuxcnc)
        {
            let meaning = "a word of LinuxCNC alone";
            let remedy = "post the program for this control, or state another `dialect`";
            return Err(not_read(code, meaning, remedy));
        }
        if let Some(code) = block.code_of(Group::Kinematics)
            && dialect != Some(Choice::Rs274Ngc)
        {
            let meaning = "tool centre point control of LinuxCNC's five-axis configurations alone";
            let remedy = "write G43.4 H and G49, or state `dialect = \"rs274ngc\"` of the control";
            return Err(not_read(code, meaning, remedy));
        }
        if let Some(code) = block
            .code_of(Group::WorkOffset)
            .filter(|code| matches!(code.tenths, 1100..=1290 | 1540))
            && dialect != Some(Choice::Iso)
        {
            let meaning = "a work offset of Haas, and another word elsewhere";
            let remedy = "state `dialect = \"iso\"` of the control";
            return Err(not_read(code, meaning, remedy));
        }
        if block.distance_after_coordinate && dialect == Some(Choice::Heidenhain) {
            let condition = "a coordinate stands before it in the block";
            let remedy = "write it first: on Heidenhain it holds for the coordinates after it";
            return Err(combination("G90 or G91", condition, remedy));
        }
        Ok(())
    }

    /// Refuses words of a block that controls combine in different ways.
    pub(super) fn check_words(&self, block: &Block) -> Result<(), GcodeFault> {
        let dialect = self.stated(Rule::Dialect);
        if matches!(dialect, None | Some(Choice::Iso))
            && block.codes().filter(Code::is_m).nth(1).is_some()
            && let Some(code) = block
                .codes()
                .filter(Code::is_m)
                .find(|code| matches!(code.tenths, 0..=60 | 290 | 300 | 980 | 990 | 1980))
        {
            let condition =
                "its block has another M word, of which Haas and Fanuc as delivered execute one";
            let remedy = "write them in two blocks";
            return Err(combination(code, condition, remedy));
        }
        let mut spindle =
            block.codes().filter(|code| code.is_m() && matches!(code.tenths, 30 | 40 | 50 | 190));
        if let (Some(first), Some(second)) = (spindle.next(), spindle.next()) {
            return Err(same_group(first, second));
        }
        if let Some(value) = block.value('S').filter(|speed| *speed < 0.0) {
            let expected = "a number from 0";
            return Err(GcodeFault::NotAllowed { word: 'S', value, expected });
        }
        // G54.1 has its own P, and on LinuxCNC G64 takes it.
        let is_tolerance = dialect == Some(Choice::Rs274Ngc)
            && block.code_of(Group::PathControl).is_some_and(|code| code.tenths == 640);
        if block.has('P')
            && !is_tolerance
            && let Some(code) =
                block.code_of(Group::WorkOffset).filter(|code| !matches!(code.tenths, 541 | 1540))
        {
            let condition = "it selects another work offset on Fanuc and Siemens";
            let remedy = "write it in a block of its own";
            return Err(combination(format!("P beside {code}"), condition, remedy));
        }
        // The last word of the group counts on Fanuc, and the cycle on LinuxCNC (run: `rs274`).
        let cycle = block.code_of(Group::Motion).filter(|code| code.tenths >= 730);
        if let Some((cycle, end)) = cycle.zip(block.code_of(Group::CycleOff))
            && dialect != Some(Choice::Rs274Ngc)
        {
            return Err(same_group(cycle, end));
        }
        check_axis_words(block)?;
        self.check_shared(block)
    }

    /// Refuses a letter that two words of the block take: LinuxCNC gives its number to both, as P to G64 and to the turns of an
    /// arc (`interp_check.cc`, `interp_arc.cc`).
    fn check_shared(&self, block: &Block) -> Result<(), GcodeFault> {
        // The motion in force takes the letters of a block without a motion word.
        let is_executed = block.has_any("XYZIJKR") && block.code_of(Group::Motion).is_none();
        let in_force = match self.modal.motion.filter(|_| is_executed) {
            Some(Motion::Arc { clockwise: true }) => Some(20),
            Some(Motion::Arc { clockwise: false }) => Some(30),
            Some(Motion::Cycle(number)) => Some(10 * number),
            _ => None,
        };
        let in_force = in_force.map(|tenths| Code { letter: 'G', tenths });
        for letter in "PQLR".chars().filter(|letter| block.has(*letter)) {
            let mut users = block.codes().chain(in_force).filter(|code| takes(*code, letter));
            if let (Some(first), Some(second)) = (users.next(), users.next()) {
                let condition = "some controls give its number to both";
                let remedy = "write them in two blocks";
                return Err(combination(
                    format!("{letter} beside {first} and {second}"),
                    condition,
                    remedy,
                ));
            }
        }
        Ok(())
    }

    /// Refuses a position whose meaning depends on what a control does after a change of coordinates.
    pub(super) fn check_position(&mut self, block: &Block) -> Result<(), GcodeFault> {
        let is_incremental = self.modal.incremental;
        if std::mem::take(&mut self.tcp_position_needed)
            && (is_incremental || !"XYZ".chars().all(|letter| block.has(letter)))
        {
            let condition = "it is the first of tool centre point control that began with turned axes, and has not X, Y and Z in G90";
            let remedy = "write all three";
            return Err(combination("a position", condition, remedy));
        }
        // On Fanuc the change of the length acts on an increment, too.
        let length_changed = block.has('Z') && std::mem::take(&mut self.length_changed);
        self.height_before = self.height_before.filter(|_| self.length_changed);
        if length_changed && self.is_incremental(block, 'Z') {
            let condition = "G91 is in force and the length offset has changed";
            let remedy = "write it in G90";
            return Err(combination("Z", condition, remedy));
        }
        self.check_shifted(block)?;
        for (axis, letter) in AXES.into_iter().enumerate() {
            let Some(value) = block.value(letter) else { continue };
            // The way of a rotary axis to a stated angle is not that of an increment.
            if axis > 2 && block.own_distance(letter).is_some_and(|own| own != is_incremental) {
                let condition = "the other distance mode is in force";
                return Err(combination(
                    format!("AC or IC of {letter}"),
                    condition,
                    "write G90 or G91 in the block",
                ));
            }
            let is_incremental = self.is_incremental(block, letter);
            // An increment of 0 states no position: the axis still stands where the change has found it.
            self.origin_changed[axis] &= is_incremental && value == 0.0;
            if is_incremental && self.is_rounded(axis, value) {
                let condition = "G91 is in force, and it is no multiple of the least increment, to which controls round each";
                let remedy = "write it in G90";
                return Err(combination(format!("{letter}{value}"), condition, remedy));
            }
        }
        self.check_after_rotation(block)
    }

    /// Refuses increments along axes whose work offset, shift or length has changed, which Sinumerik adds to them, also to 0.
    pub(super) fn check_shifted(&self, block: &Block) -> Result<(), GcodeFault> {
        let is_sinumerik = matches!(self.stated(Rule::Dialect), None | Some(Choice::Sinumerik));
        let changed = (0..AXES.len()).find(|&axis| {
            block.has(AXES[axis])
                && self.is_incremental(block, AXES[axis])
                && (self.origin_changed[axis] || axis == 2 && self.length_changed)
        });
        match changed {
            Some(axis) if is_sinumerik => Err(combination(
                AXES[axis],
                "G91 is in force and its work offset, shift or length has changed, which Sinumerik adds",
                "write it in G90",
            )),
            _ => Ok(()),
        }
    }

    /// Refuses G92 where the position or its new value has digits that a control rounds: the rest would add up.
    pub(super) fn check_preset(&self, block: &Block) -> Result<(), GcodeFault> {
        for (axis, letter) in AXES.into_iter().enumerate() {
            let Some(value) = block.value(letter) else { continue };
            // The value is in the unit of the program, the position in mm.
            let unit = if axis < 3 { self.modal.millimetres(1.0) } else { 1.0 };
            let position = self.position[axis].map(|position| position / unit);
            if [Some(value), position]
                .into_iter()
                .flatten()
                .any(|value| self.is_rounded(axis, value))
            {
                let condition = "it or the position is no multiple of the least increment, to which controls round";
                let remedy = "move to such a position before";
                return Err(combination(format!("G92 {letter}{value}"), condition, remedy));
            }
        }
        Ok(())
    }

    /// Returns whether controls round a number of an axis, in the program's unit.
    fn is_rounded(&self, axis: usize, value: f64) -> bool {
        let increment = if axis < 3 { self.modal.increment() } else { 1e-3 };
        match self.stated(Rule::Dialect) {
            Some(Choice::Rs274Ngc) => false,
            // Sinumerik rounds inches to micrometres.
            None | Some(Choice::Sinumerik) if axis < 3 => {
                !is_multiple(value, increment) || !is_multiple(self.modal.millimetres(value), 1e-3)
            }
            _ => !is_multiple(value, increment),
        }
    }

    /// Refuses the first position after G68 or G69, if it is not that of both axes of the plane.
    pub(super) fn check_after_rotation(&mut self, block: &Block) -> Result<(), GcodeFault> {
        let axes = self.modal.plane.axes().map(|axis| AXES[axis]);
        let is_incremental = axes.map(|letter| self.is_incremental(block, letter));
        let given = [0, 1]
            .map(|k| block.value(axes[k]).is_some_and(|value| !is_incremental[k] || value != 0.0));
        // An arc or a cycle without them is at the present position.
        let is_straight = matches!(self.modal.motion, Some(Motion::Rapid | Motion::Feed));
        if !self.rotation_changed || given == [false; 2] && is_straight {
            return Ok(());
        }
        if is_incremental.contains(&true) || given != [true; 2] {
            let condition =
                "it is the first after G68 or G69, and not of both axes of the plane in G90";
            let remedy = "write both in G90";
            return Err(combination("a position", condition, remedy));
        }
        self.rotation_changed = false;
        Ok(())
    }

    /// Refuses motions in a tilted plane whose meaning depends on G53.1.
    pub(super) fn check_tilted(&self, block: &Block) -> Result<(), GcodeFault> {
        let Rotation::Tilted { aligned, frame } = self.state.rotation else { return Ok(()) };
        let has_length = self.state.tcp == Tcp::Off && self.state.length != LengthOffset::Off;
        // Along Z of the machine, or of the plane: the same where the plane keeps Z.
        if !aligned && has_length && frame.rotation[(2, 2)] != 1.0 && block.has_any("XYZ") {
            let condition = "a length offset is in force in a tilted plane that is not aligned";
            let remedy = "write G53.1 after G68.2, or G49 before";
            return Err(combination("a position", condition, remedy));
        }
        let moved = AXES.into_iter().filter(|letter| block.has(*letter));
        let at_zero = self.turns_nothing();
        for letter in moved {
            let is_rotary = AXES[3..].contains(&letter);
            let (condition, remedy) = match (aligned, is_rotary) {
                (true, true) => match self.stated(Rule::Dialect) {
                    Some(Choice::Heidenhain) => {
                        ("a tilted plane is in force", "write PLANE RESET before")
                    }
                    Some(Choice::Sinumerik) => {
                        ("a plane is swivelled (CYCLE800)", "write CYCLE800() before")
                    }
                    _ => ("a tilted plane is aligned (G53.1)", "end the plane with G69 before"),
                },
                (false, false) if !at_zero && self.state.tcp == Tcp::Off => {
                    ("a tilted plane is not aligned", "write G53.1 after G68.2")
                }
                _ => continue,
            };
            return Err(combination(letter, condition, remedy));
        }
        Ok(())
    }

    /// Refuses an arc that is a full circle where coordinates are rounded, and notes one that is no circle.
    pub(super) fn check_radii(
        &mut self,
        path: &StepPath,
        end: &Position,
    ) -> Result<(), GcodeFault> {
        let StepPath::Arc { plane, centre, sweep } = path else { return Ok(()) };
        let [first, second] = plane.axes();
        let (Some([x, y]), Some([u, v])) =
            (in_plane(&self.position, [first, second]), in_plane(end, [first, second]))
        else {
            return Ok(());
        };
        let chord = (u - x).hypot(v - y);
        // LinuxCNC rounds no coordinate.
        let rounds = self.stated(Rule::Dialect) != Some(Choice::Rs274Ngc);
        let [across, along] = [(u - x).abs(), (v - y).abs()];
        if rounds
            && chord > 0.0
            && across.max(along) < 2.0 * self.modal.millimetres(self.modal.increment())
        {
            let condition = "its end is less than two increments from its start, and can be the same where coordinates are rounded";
            let remedy = "leave the end out for a full circle, or leave out the arc";
            return Err(combination("an arc", condition, remedy));
        }
        let [from, to] = [[x, y], [u, v]].map(|[x, y]| (x - centre[0]).hypot(y - centre[1]));
        let difference = (from - to).abs();
        // A control that moves the centre across the chord turns the arc about its start by the difference over the chord. Up to half a
        // turn, all curves that begin and end there are between both circles.
        let is_minor = sweep.abs() <= PI;
        let turn = if chord > 0.0 && !is_minor { from.max(to) / chord } else { 0.0 };
        if difference * turn.max(1.0) <= RADII_TOLERANCE {
            return Ok(());
        }
        // The band of all curves is checked where the rotary axes rest.
        let turns = (3..6).any(|axis| end[axis] != self.position[axis]);
        let arms = [[x, y], [u, v]].map(|[x, y]| [x - centre[0], y - centre[1]]);
        let kind = match band_radii(arms, *sweep).is_some() && !turns {
            true => NoteKind::Spiral { stops: stops(difference, from.min(to)) },
            false => NoteKind::TwoRadii,
        };
        self.notes.add(self.block(), kind);
        Ok(())
    }

    /// Notes an arc by its radius whose path depends on digits below the least increment: one near a half circle, or near a full one.
    /// A radius below 0 is that of an arc of more than a half circle.
    pub(super) fn check_radius_digits(&mut self, radius: f64, end: &Position) {
        let axes = self.modal.plane.axes();
        let (Some([x, y]), Some([u, v])) = (in_plane(&self.position, axes), in_plane(end, axes))
        else {
            return;
        };
        let increment = self.modal.millimetres(self.modal.increment());
        if [x, y, u, v, radius].into_iter().all(|value| is_multiple(value, increment)) {
            return;
        }
        let is_major = radius < 0.0;
        // If every number changes by an increment, the chord changes by √8 increments, and its middle stays within one of them.
        let chord = (u - x).hypot(v - y);
        let [shallow, deep] = [-increment, increment]
            .map(|change| sagitta(radius.abs() + change, 0.5 * chord - SQRT_2 * change, is_major));
        let farthest = if is_major { 2.0 * radius.abs() } else { chord };
        let turn = farthest / chord.max(increment) * f64::sqrt(8.0) * increment;
        if (deep - shallow).abs() + turn > RADII_TOLERANCE.max(8.0 * increment) {
            self.notes.add(self.block(), NoteKind::RoundedRadius);
        }
    }
}

/// Returns the height of an arc over its chord: over the shorter arc, or over the longer one.
fn sagitta(radius: f64, half_chord: f64, is_major: bool) -> f64 {
    let height = (radius * radius - half_chord * half_chord).max(0.0).sqrt();
    if is_major { radius + height } else { radius - height }
}

/// Returns whether a word takes the number after a letter.
fn takes(code: Code, letter: char) -> bool {
    let is_cycle = code.letter == 'G' && (730..=890).contains(&code.tenths) && code.tenths != 800;
    let is_arc = code.letter == 'G' && matches!(code.tenths, 20 | 30);
    match (letter, code.letter) {
        ('P', 'G') => {
            is_arc
                || is_cycle
                || matches!(
                    code.tenths,
                    40 | 50 | 80 | 100 | 300 | 541 | 640 | 682 | 1030 | 1540 | 1870
                )
        }
        ('P', _) => matches!(code.tenths, 190 | 510..=530 | 620..=650 | 980 | 1980),
        ('Q', 'G') => is_cycle || matches!(code.tenths, 51 | 640),
        ('Q', _) => matches!(code.tenths, 190 | 670 | 680),
        ('L', 'G') => is_cycle || code.tenths == 100,
        ('L', _) => matches!(code.tenths, 980 | 1980),
        ('R', 'G') => is_arc || is_cycle || matches!(code.tenths, 100 | 640 | 680),
        _ => code.tenths == 190,
    }
}

/// Returns whether a word means something else in DIN/ISO programs of Heidenhain.
fn is_other_on_heidenhain(code: Code) -> bool {
    match (code.letter, code.tenths) {
        ('G', tenths) => matches!(
            tenths,
            90 | 100 | 150 | 160 | 200 | 210 | 230 | 280 | 300 | 430..=449 | 490 | 500..=511 | 520..=599 | 610..=649 | 670..=699 | 730 | 740
                | 810..=890 | 920..=979 | 980 | 990
        ),
        ('M', tenths) => matches!(tenths, 890 | 980 | 990 | 1980),
        _ => false,
    }
}

/// Returns whether a value is a multiple of an increment, but for rounding in doubles.
fn is_multiple(value: f64, increment: f64) -> bool {
    let steps = value / increment;
    (steps - steps.round()).abs() <= 1e-6
}

/// Returns whether Fanuc, Haas and Sinumerik stop at a word of LinuxCNC.
fn is_of_linuxcnc(code: &Code) -> bool {
    matches!((code.letter, code.tenths), ('G', 591..=593 | 611 | 901 | 911 | 922 | 923))
}

/// Refuses two words that would use the axis words of a block.
fn check_axis_words(block: &Block) -> Result<(), GcodeFault> {
    let one_shot = block
        .code_of(Group::OneShot)
        .filter(|code| matches!(code.tenths, 100 | 280 | 300 | 520 | 920));
    let rotation = block.code_of(Group::Rotation).filter(|code| code.tenths != 690);
    let machine = block.code_of(Group::Machine);
    let motion = block.code_of(Group::Motion);
    // `G0 G28` and `G0 G53` are common: the motion word only sets the mode.
    let is_return = one_shot.is_some_and(|code| matches!(code.tenths, 280 | 300));
    let is_plain = motion.is_some_and(|code| matches!(code.tenths, 0 | 10));
    let motion = motion.filter(|_| !(is_plain && (is_return || machine.is_some())));
    let mut users = [one_shot, rotation, machine, motion].into_iter().flatten();
    match (users.next(), users.next()) {
        (Some(first), Some(second)) => Err(same_group(first, second)),
        _ => Ok(()),
    }
}
