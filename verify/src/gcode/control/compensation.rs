//! Cutter radius compensation (G40, G41, G42): the path of the tool's centre beside the programmed one.
//!
//! It changes the stream of steps. The control's position stays the programmed one; the steps of a block go through
//! [`Control::compensate`] before they are returned. Where a motion ends depends on the next one in the plane, so one motion is held back,
//! with those across the plane after it.
//!
//! The radius is that of a D number (Fanuc, Haas) or of a tool (LinuxCNC's D is a tool's number; Sinumerik and Heidenhain take that of the
//! tool in the spindle). A negative one exchanges the sides (operator's manual of the Fanuc Series 16/18-C, section 15.4.7;
//! `convert_cutter_compensation_on` of LinuxCNC's interpreter). With a radius of 0 the path is the programmed one, but the first and the last motion have to be straight all
//! the same.
//!
//! **Entry and exit.** The first motion starts at the position, the last ends at it. Where the tool is at its other end is a
//! [rule](Rule::CompensationStart) of the control.

use super::offset::{self, Bend, Contour, Corner, Leg, Outside, Shape, Vector};
use super::{AXES, Control, Modal, corner, in_plane};
use crate::gcode::block::{Block, Code, Group};
use crate::gcode::error::{CompensationFault, combination, missing, not_read};
use crate::gcode::rules::{Choice, Rule};
use crate::gcode::state::{Position, Rotation, Tcp};
use crate::gcode::{GcodeFault, Plane, Step, StepPath};
use touchoff::Unit;

/// Largest difference of directions, in radians, of motions that LinuxCNC takes as tangent (`TOLERANCE_CONCAVE_CORNER`).
const LINUXCNC_TANGENT: f64 = 0.05;
/// That of other controls: the rounding of directions.
const TANGENT: f64 = 1e-6;
/// Length in millimetres below which nothing moves in the plane.
const STILL: f64 = 1e-9;

/// Compensation in force.
#[derive(Clone, Debug)]
pub(super) struct Compensation {
    /// G41 or G42.
    code: Code,
    /// The offset to the left, in millimetres.
    offset: f64,
    tool: Option<u32>,
    plane: Plane,
    unit: Unit,
    phase: Phase,
    /// Blocks without a motion in the plane since the last one with it.
    idle: usize,
    /// The motion whose end is not known yet. With an offset of 0 there is none.
    held: Option<Held>,
    /// Motions across the plane after it.
    waiting: Vec<Step>,
}

/// A motion whose end the next one decides.
#[derive(Clone, Debug)]
struct Held {
    step: Step,
    contour: Contour,
    /// Start of the tool.
    from: Vector,
    is_entry: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Phase {
    /// Before the first motion in the plane.
    Entry,
    Contour,
    /// After G40, before the motion that leads back to the programmed path.
    Exit {
        /// Set while the block of G40 is executed.
        is_here: bool,
    },
}

impl Held {
    /// Refuses a motion whose direction would turn round, since its corners cut off more than it has.
    fn check_room(&self) -> Result<(), CompensationFault> {
        match self.contour.is_kept() {
            true => Ok(()),
            false => Err(CompensationFault::NoRoom { line: self.step.line }),
        }
    }
}

impl Compensation {
    /// Returns whether the tool is beside the programmed path, or will be with the next motion.
    fn is_on(&self) -> bool {
        !matches!(self.phase, Phase::Exit { .. })
    }

    /// Returns whether the tool is beside the programmed path, or will be, or can be.
    fn is_in_force(&self) -> bool {
        self.is_on() || self.offset != 0.0
    }
}

impl Control {
    /// Reads G40, G41 and G42, and refuses words that change what a compensated path means. `register` is the number after D in the
    /// block.
    pub(super) fn compensation_words(
        &mut self,
        block: &mut Block,
        register: Option<f64>,
    ) -> Result<(), GcodeFault> {
        let known = self.compensation.as_ref();
        let changes = match block.code_of(Group::CutterCompensation) {
            Some(Code { tenths: 400, .. }) => known.is_some(),
            Some(code) => known.is_none_or(|known| !known.is_on() || known.code != code),
            None => false,
        };
        if changes {
            self.check_corner_before_compensation()?;
        }
        match block.code_of(Group::CutterCompensation) {
            Some(Code { tenths: 400, .. }) => match &mut self.compensation {
                Some(compensation) if compensation.phase == Phase::Contour => {
                    compensation.phase = Phase::Exit { is_here: true };
                }
                Some(compensation) if compensation.phase == Phase::Entry => {
                    self.compensation = None;
                }
                _ => {}
            },
            Some(code) => self.start_compensation(block, code, register)?,
            None => {}
        }
        // After G40 there is nothing to lead back from an offset of 0.
        let Some(compensation) = self.compensation.as_ref().filter(|known| known.is_in_force())
        else {
            return Ok(());
        };
        self.check_compensated(block, compensation)?;
        let is_selected = block.code_of(Group::CutterCompensation).is_some();
        match register.filter(|_| !is_selected) {
            Some(register) => Err(under_compensation(format!("D{register}"))),
            None => Ok(()),
        }
    }

    /// Executes G41 or G42.
    fn start_compensation(
        &mut self,
        block: &mut Block,
        code: Code,
        register: Option<f64>,
    ) -> Result<(), GcodeFault> {
        let is_linuxcnc = self.stated(Rule::Dialect) == Some(Choice::Rs274Ngc);
        let offset = self.offset(block, code, register)?;
        if let Some(known) = self.compensation.as_ref().filter(|known| known.is_in_force()) {
            // The same words again change nothing.
            let is_same = known.code == code && known.offset == offset && known.is_on();
            return match is_same && !is_linuxcnc {
                true => Ok(()),
                false => Err(under_compensation(code)),
            };
        }
        let (condition, remedy) = if self.modal.cycle().is_some() {
            ("a canned cycle is in force", "write G80 before")
        } else if self.state.tcp != Tcp::Off {
            ("tool centre point control is on", self.tcp_remedy())
        } else if matches!(self.state.rotation, Rotation::Tilted { aligned: false, .. }) {
            ("a tilted plane is not aligned", "write G53.1 after G68.2")
        } else if self.modal.plane == Plane::Yz && is_linuxcnc {
            ("G19 is in force, which LinuxCNC does not allow", "post the program in G17 or G18")
        } else {
            let Modal { plane, unit, .. } = self.modal;
            self.compensation = Some(Compensation {
                code,
                offset,
                tool: self.state.tool,
                plane,
                unit,
                phase: Phase::Entry,
                idle: 0,
                held: None,
                waiting: Vec::new(),
            });
            return Ok(());
        };
        Err(combination(code, condition, remedy))
    }

    /// Returns the offset to the left, in millimetres.
    fn offset(
        &self,
        block: &mut Block,
        code: Code,
        register: Option<f64>,
    ) -> Result<f64, GcodeFault> {
        let is_left = matches!(code.tenths, 410 | 411) != self.turns_over(self.modal.plane);
        let side = if is_left { 1.0 } else { -1.0 };
        let dialect = self.stated(Rule::Dialect);
        if matches!(code.tenths, 411 | 421) {
            if dialect != Some(Choice::Rs274Ngc) {
                let meaning = "cutter compensation by a diameter on LinuxCNC, and control of the normal direction on Fanuc";
                let remedy =
                    "write G41 or G42 with D, or state `dialect = \"rs274ngc\"` of the control";
                return Err(not_read(code, meaning, remedy));
            }
            let diameter = self.take_length(block, 'D');
            return match diameter {
                Some(diameter) => Ok(0.5 * side * diameter),
                None => Err(missing(code, "D with the diameter of the cutter")),
            };
        }
        let needed_tool =
            "a tool in the spindle before (T and M6, or TOOL CALL), whose radius counts";
        let of_tool = || self.state.tool.ok_or_else(|| missing(code, needed_tool));
        let number = match dialect {
            Some(Choice::Rs274Ngc) if register.is_none_or(|register| register == 0.0) => of_tool()?,
            // D0 selects no edge, which has no radius.
            Some(Choice::Sinumerik) if self.edge == Some(0) => 0,
            Some(Choice::Sinumerik | Choice::Heidenhain) => of_tool()?,
            _ => self.edge.ok_or_else(|| {
                missing(code, "D with the number of a radius offset, in its block or before")
            })?,
        };
        if dialect.is_none() {
            self.check_radius_of_all(code, number)?;
        }
        if number == 0 {
            return Ok(0.0);
        }
        let Some(radius) = self.radius_offsets.get(&number) else {
            return Err(CompensationFault::NoRadius { number }.into());
        };
        let radius = radius + self.radius_allowance;
        if radius < 0.0 && dialect == Some(Choice::Heidenhain) {
            let condition = "its radius offset is negative";
            return Err(combination(code, condition, "write the other of G41 and G42"));
        }
        Ok(side * radius)
    }

    /// Checks that all controls take the radius of a register: on Sinumerik and Heidenhain it is that of the tool, and D0 is the tool's
    /// on LinuxCNC.
    fn check_radius_of_all(&self, code: Code, number: u32) -> Result<(), GcodeFault> {
        let radius = |number: u32| self.radius_offsets.get(&number);
        let of_tool = self.state.tool.map(radius);
        match number != 0 && of_tool.is_none_or(|of_tool| of_tool == radius(number)) {
            true => Ok(()),
            false => Err(combination(
                code,
                "the radius is that of the register after D on some controls, and that of the tool on others, and the two differ",
                "state the control",
            )),
        }
    }

    /// Refuses words under which a compensated path is another one on some controls, or at which they stop.
    fn check_compensated(
        &self,
        block: &Block,
        compensation: &Compensation,
    ) -> Result<(), GcodeFault> {
        use Group::{
            Kinematics, Length, Machine, OneShot, PathControl, Retract, Rotation, Stop, ToolChange,
            WorkOffset,
        };
        let dialect = self.stated(Rule::Dialect);
        let mut groups =
            [WorkOffset, Length, Rotation, OneShot, Machine, ToolChange, Kinematics].into_iter();
        if let Some(code) = groups.find_map(|group| block.code_of(group)) {
            return Err(under_compensation(code));
        }
        if block.keyword.is_some() {
            return Err(under_compensation("TRAORI or TRAFOOF"));
        }
        if let Some(number) = self.modal.cycle() {
            return Err(under_compensation(format!("G{number}")));
        }
        // Heidenhain changes the tool by T alone.
        if self.state.tool != compensation.tool {
            return Err(under_compensation("T"));
        }
        if self.modal.plane != compensation.plane {
            return Err(under_compensation("another plane"));
        }
        if self.modal.unit != compensation.unit {
            return Err(under_compensation("another unit"));
        }
        match dialect {
            // LinuxCNC stops at these (`convert_control_mode`, `convert_retract_mode` and `convert_m` of its interpreter).
            Some(Choice::Rs274Ngc) if compensation.is_on() => {
                let modes =
                    [PathControl, Retract].into_iter().find_map(|group| block.code_of(group));
                let outputs = block
                    .passed_over
                    .iter()
                    .copied()
                    .find(|code| code.is_m() && matches!(code.tenths, 480..=530 | 620..=680));
                modes.or(outputs).map_or(Ok(()), |code| Err(under_compensation(code)))
            }
            // Fanuc reads no block ahead of these.
            _ => match block.code_of(Stop) {
                Some(code)
                    if matches!(code.tenths, 0 | 10) && dialect != Some(Choice::Rs274Ngc) =>
                {
                    Err(under_compensation(code))
                }
                _ => Ok(()),
            },
        }
    }

    /// Returns the word of compensation that is in force.
    pub(in crate::gcode) fn compensation_code(&self) -> Option<Code> {
        self.compensation.as_ref().filter(|known| known.is_on()).map(|known| known.code)
    }

    /// Refuses an arc in another plane than that of compensation.
    pub(super) fn check_compensated_plane(&self, plane: Plane) -> Result<(), GcodeFault> {
        match self.compensation.as_ref().is_some_and(|known| known.plane != plane) {
            true => Err(under_compensation("an arc in another plane")),
            false => Ok(()),
        }
    }

    /// Refuses a word that moves the tool by itself, or changes coordinates, while compensation is in force.
    pub(in crate::gcode) fn check_uncompensated(
        &self,
        word: impl Into<String>,
    ) -> Result<(), GcodeFault> {
        match self.compensation.as_ref().is_some_and(Compensation::is_in_force) {
            true => Err(under_compensation(word)),
            false => Ok(()),
        }
    }

    /// Replaces the steps that a block has added after the first ones by those of the tool's centre that are known now.
    pub(super) fn compensate(&mut self, first: usize) -> Result<(), GcodeFault> {
        // A motion that is held for its corner is compensated with the next one.
        let is_held = self.held_motion.as_mut().is_some_and(corner::HeldMotion::take_new);
        if self.compensation.is_none() || is_held && self.pending.len() <= first {
            return Ok(());
        }
        let mut is_idle = true;
        for step in self.pending.split_off(first) {
            match self.compensation.take() {
                Some(compensation) => is_idle &= !self.compensate_step(compensation, step)?,
                None => self.pending.push_back(step),
            }
        }
        if let Some(compensation) = self.compensation.as_mut().filter(|_| is_idle) {
            compensation.idle += 1;
            if let Phase::Exit { is_here } = &mut compensation.phase {
                *is_here = false;
            }
        }
        // An offset of 0 ends with the block of G40.
        self.compensation = self.compensation.take().filter(Compensation::is_in_force);
        Ok(())
    }

    /// Executes a step under compensation, and returns whether it moves in the plane.
    fn compensate_step(
        &mut self,
        mut compensation: Compensation,
        step: Step,
    ) -> Result<bool, GcodeFault> {
        let is_linuxcnc = self.stated(Rule::Dialect) == Some(Choice::Rs274Ngc);
        if !compensation.is_in_force() {
            if matches!(step.path, StepPath::Arc { .. }) && !is_linuxcnc {
                return Err(CompensationFault::ArcExit.into());
            }
            self.pending.push_back(step);
            return Ok(true);
        }
        if let Some(axis) = (3..6).find(|axis| step.commanded[*axis]) {
            return Err(under_compensation(AXES[axis]));
        }
        let axes = compensation.plane.axes();
        let place = |position: &Position| in_plane(position, axes).map(Vector::from);
        let shape = match step.path {
            StepPath::Line => Some(Shape::Line),
            StepPath::Arc { centre, sweep, .. } => {
                Some(Shape::Arc { centre: Vector::from(centre), sweep })
            }
            _ => None,
        };
        let (Some(start), Some(end), Some(shape)) = (place(&step.start), place(&step.end), shape)
        else {
            return Err(CompensationFault::Unknown.into());
        };
        // A length that comes into force without a word moves the coordinates of a plane along it.
        let is_joined = |held: &Held| (held.contour.end() - start).norm() < STILL;
        if !compensation.held.as_ref().is_none_or(is_joined) {
            return Err(under_compensation("a change of the tool length"));
        }
        let moves = shape != Shape::Line || (end - start).norm() >= STILL;
        let names_plane = axes.into_iter().any(|axis| step.commanded[axis]);
        // LinuxCNC takes every motion for the first one, and for the last.
        let counts = moves || names_plane || is_linuxcnc;
        let is_offset = compensation.offset != 0.0;
        if compensation.phase != Phase::Contour && !counts {
            if !compensation.is_on() {
                return Err(CompensationFault::ExitAcross.into());
            }
            self.pending.push_back(step);
            self.compensation = Some(compensation);
            return Ok(false);
        }
        if shape != Shape::Line && (is_offset || !is_linuxcnc) {
            match compensation.phase {
                Phase::Entry if !is_linuxcnc => return Err(CompensationFault::ArcEntry.into()),
                Phase::Exit { .. } => return Err(CompensationFault::ArcExit.into()),
                _ => {}
            }
        }
        if !is_offset {
            self.pending.push_back(step);
            if compensation.phase == Phase::Entry {
                compensation.phase = Phase::Contour;
            }
            compensation.idle = 0;
            self.compensation = Some(compensation);
            return Ok(moves);
        }
        match compensation.phase {
            Phase::Entry => {
                let contour = self.entry([start, end], shape, &compensation)?;
                compensation.phase = Phase::Contour;
                compensation.held = Some(Held { step, contour, from: start, is_entry: true });
            }
            Phase::Contour if moves => {
                let contour = Contour::new([start, end], shape, compensation.offset)?;
                self.next_motion(&mut compensation, step, contour)?;
            }
            Phase::Contour => {
                // Controls take a motion of no length in the plane for more than one block without any.
                let is_across = step.commanded[compensation.plane.normal()] && !names_plane;
                compensation.idle += usize::from(!is_across);
                compensation.waiting.push(step);
                self.compensation = Some(compensation);
                return Ok(false);
            }
            Phase::Exit { is_here } => {
                self.exit(compensation, step, [start, end], is_here)?;
                return Ok(true);
            }
        }
        compensation.idle = 0;
        self.compensation = Some(compensation);
        Ok(true)
    }

    /// Returns the contour of the first motion.
    fn entry(
        &self,
        ends: [Vector; 2],
        shape: Shape,
        compensation: &Compensation,
    ) -> Result<Contour, CompensationFault> {
        let (length, offset) = ((ends[1] - ends[0]).norm(), compensation.offset);
        // A motion as long as the offset does for other controls than LinuxCNC (`convert_straight_comp1`).
        let is_short = match self.stated(Rule::Dialect) {
            Some(Choice::Rs274Ngc) => length <= offset.abs(),
            _ => length < offset.abs() - STILL || length < STILL,
        };
        if is_short {
            return Err(CompensationFault::ShortEntry { length, offset: offset.abs() });
        }
        match shape {
            Shape::Line => Contour::new(ends, shape, offset),
            Shape::Arc { centre, sweep } => Contour::entry_arc(ends, centre, sweep, offset),
        }
    }

    /// Leads from the motion that is held to the next one in the plane, and holds that.
    fn next_motion(
        &mut self,
        compensation: &mut Compensation,
        step: Step,
        mut contour: Contour,
    ) -> Result<(), GcodeFault> {
        // The first motion has set it.
        let Some(mut held) = compensation.held.take() else { return Ok(()) };
        let (bend, turn) = self.bend(&held.contour, &contour)?;
        self.check_idle(compensation, bend)?;
        let is_beside_next = held.is_entry
            && bend != Bend::Tangent
            && match self.choice(Rule::CompensationStart) {
                Choice::NextMotion => true,
                Choice::OutsideCorners => bend == Bend::Inside,
                _ => false,
            };
        let corner = match bend {
            _ if is_beside_next => offset::at(contour.beside(0)),
            Bend::Tangent => offset::at(held.contour.beside(1)),
            Bend::Inside => {
                let (before, after) = (&mut held.contour, &mut contour);
                let corner = offset::meet(before, after, false).or_else(|| {
                    // The next corner can be an outside one, at which the motion goes straight on.
                    let is_lengthened = self.choice(Rule::OutsideCorner) == Choice::StraightCorner;
                    is_lengthened.then(|| offset::meet(before, after, true)).flatten()
                });
                corner.ok_or(CompensationFault::NoRoom { line: held.step.line })?
            }
            Bend::Outside => {
                let form = self.outside(step.rapid)?;
                let stands_between = !compensation.waiting.is_empty();
                offset::around(&mut held.contour, &mut contour, turn, form, stands_between)?
            }
        };
        held.check_room()?;
        let place = self.leave(compensation, &held, &corner)?;
        if let Some(leg) = corner.after {
            self.add_leg(compensation.plane, &step, step.start, place, leg);
        }
        compensation.held = Some(Held { step, contour, from: corner.start, is_entry: false });
        Ok(())
    }

    /// Executes the motion after G40, which leads back to the programmed path. G40 in its block is set if `is_here`.
    fn exit(
        &mut self,
        mut compensation: Compensation,
        mut step: Step,
        ends: [Vector; 2],
        is_here: bool,
    ) -> Result<(), GcodeFault> {
        let Some(mut held) = compensation.held.take() else { return Ok(()) };
        let mut corner = offset::at(held.contour.beside(1));
        if is_here && (ends[1] - ends[0]).norm() >= STILL {
            let mut contour = Contour::new(ends, Shape::Line, compensation.offset)?;
            let (bend, turn) = self.bend(&held.contour, &contour)?;
            if bend == Bend::Outside
                && self.choice(Rule::CompensationStart) == Choice::OutsideCorners
            {
                self.check_idle(&compensation, bend)?;
                let form = self.outside(step.rapid)?;
                let stands_between = !compensation.waiting.is_empty();
                corner =
                    offset::around(&mut held.contour, &mut contour, turn, form, stands_between)?;
            }
        }
        held.check_room()?;
        let place = self.leave(&mut compensation, &held, &corner)?;
        if let Some(leg) = corner.after {
            self.add_leg(compensation.plane, &step, step.start, place, leg);
        }
        move_in_plane(&mut step, compensation.plane, [corner.start, ends[1]]);
        self.pending.push_back(step);
        Ok(())
    }

    /// Ends compensation with the program: after G40 the tool stays beside the programmed path.
    pub(crate) fn end_compensation(&mut self) -> Result<(), GcodeFault> {
        self.check_corner()?;
        let Some(mut compensation) = self.compensation.take() else { return Ok(()) };
        if compensation.is_on() {
            return Err(under_compensation("the end of the program"));
        }
        if let Some(held) = compensation.held.take() {
            held.check_room()?;
            let place = held.contour.beside(1);
            self.leave(&mut compensation, &held, &offset::at(place))?;
            for (axis, value) in compensation.plane.axes().into_iter().zip([place.x, place.y]) {
                self.position[axis] = Some(value);
            }
        }
        Ok(())
    }

    /// Returns the form of the path around an outside corner, by the control. The motion after it is in rapid traverse if `rapid`.
    fn outside(&mut self, rapid: bool) -> Result<Outside, GcodeFault> {
        match self.choice(Rule::OutsideCorner) {
            Choice::ArcCorner if !rapid => Ok(Outside::Arc),
            // `convert_straight_comp2` of LinuxCNC's interpreter.
            Choice::ArcCorner if self.stated(Rule::Dialect) == Some(Choice::Rs274Ngc) => {
                Ok(Outside::Chord)
            }
            Choice::ArcCorner => {
                let condition = "it follows an outside corner under cutter compensation, around which the tool moves on an arc or straight";
                Err(combination("G0", condition, "write G1, or G40 in its block"))
            }
            _ => Ok(Outside::Straight),
        }
    }

    /// Refuses more blocks without a motion in the plane than the control reads ahead, at a corner that depends on the motion after them:
    /// one on Fanuc as delivered (B-63944EN section 6.6.3, parameter 19625), three on Sinumerik (MD20250), any number on LinuxCNC.
    fn check_idle(&self, compensation: &Compensation, bend: Bend) -> Result<(), CompensationFault> {
        let most = match self.stated(Rule::Dialect) {
            Some(Choice::Rs274Ngc) => return Ok(()),
            Some(Choice::Sinumerik) => 3,
            _ => 1,
        };
        match bend != Bend::Tangent && compensation.idle > most {
            true => Err(CompensationFault::LookAhead { blocks: compensation.idle, most }),
            false => Ok(()),
        }
    }

    /// Returns the bend between two contours and the angle by which they turn.
    ///
    /// # Errors
    /// If it is a corner on some controls only, and none is stated.
    fn bend(&self, before: &Contour, after: &Contour) -> Result<(Bend, f64), GcodeFault> {
        let [most, on_linuxcnc] =
            [TANGENT, LINUXCNC_TANGENT].map(|tolerance| offset::bend(before, after, tolerance));
        match self.stated(Rule::Dialect) {
            Some(Choice::Rs274Ngc) => Ok(on_linuxcnc),
            None if most.0 != on_linuxcnc.0 => {
                let condition = "it turns by less than 0.05 radians under cutter compensation, which is no corner to LinuxCNC";
                Err(combination("a corner", condition, "state the `control`"))
            }
            _ => Ok(most),
        }
    }

    /// Adds the motion that was held, what the corner adds to it, and the motions across the plane after it. Returns the place of these.
    ///
    /// # Errors
    /// If LinuxCNC takes an arc the other way: it knows the ends and the direction (`convert_arc_comp2`), and at a corner that is none to it
    /// the start may be beyond the end.
    fn leave(
        &mut self,
        compensation: &mut Compensation,
        held: &Held,
        corner: &Corner,
    ) -> Result<Vector, GcodeFault> {
        let plane = compensation.plane;
        if self.stated(Rule::Dialect) == Some(Choice::Rs274Ngc)
            && !held.contour.keeps_direction(held.from, corner.end)
        {
            let condition = "it begins at a corner of less than 0.05 radians under cutter compensation, beyond its own end";
            return Err(combination("an arc", condition, "write it as a tangent, or longer"));
        }
        let mut step = held.step.clone();
        step.path = step_path(plane, held.contour.path(held.from, corner.end));
        move_in_plane(&mut step, plane, [held.from, corner.end]);
        self.pending.push_back(step);
        let mut place = corner.end;
        for leg in &corner.before {
            self.add_leg(plane, &held.step, held.step.end, place, *leg);
            place = leg.end;
        }
        for mut step in compensation.waiting.drain(..) {
            for (axis, value) in plane.axes().into_iter().zip([place.x, place.y]) {
                (step.start[axis], step.end[axis]) = (Some(value), Some(value));
            }
            self.pending.push_back(step);
        }
        Ok(place)
    }

    /// Adds a path of a corner, which belongs to the block of `step`. The axes that are not in the plane stay at `others`.
    fn add_leg(&mut self, plane: Plane, step: &Step, others: Position, from: Vector, leg: Leg) {
        let mut step = Step { start: others, end: others, ..step.clone() };
        step.commanded = [false; 6];
        step.path = step_path(plane, leg.shape);
        move_in_plane(&mut step, plane, [from, leg.end]);
        self.pending.push_back(step);
    }
}

fn step_path(plane: Plane, shape: Shape) -> StepPath {
    match shape {
        Shape::Line => StepPath::Line,
        Shape::Arc { centre, sweep } => StepPath::Arc { plane, centre: centre.into(), sweep },
    }
}

/// Gives a step other ends in the plane.
fn move_in_plane(step: &mut Step, plane: Plane, ends: [Vector; 2]) {
    let [start, end]: [[f64; 2]; 2] = ends.map(Into::into);
    for (index, axis) in plane.axes().into_iter().enumerate() {
        (step.start[axis], step.end[axis]) = (Some(start[index]), Some(end[index]));
        step.commanded[axis] = true;
    }
}

/// Refuses a word while compensation is on.
fn under_compensation(word: impl Into<String>) -> GcodeFault {
    let condition = "cutter compensation is in force (G41, G42, or G40 without its motion)";
    combination(word, condition, "write G40 in a block with G0 or G1 before")
}
