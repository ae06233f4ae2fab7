//! Motions: lines, arcs, returns to reference positions, machine coordinates.

use super::{AXES, Control, Motion, Returned, in_plane};
use crate::gcode::block::{Block, Group};
use crate::gcode::error::{ArcFault, combination, missing, not_read};
use crate::gcode::rules::{Choice, Rule};
use crate::gcode::state::{LengthOffset, Position, Rotation, Tcp};
use crate::gcode::{GcodeFault, Plane, StepPath};
use nalgebra::Vector3;
use std::f64::consts::{SQRT_2, TAU};
use touchoff::Unit;

impl Control {
    /// Executes the motion of a block.
    pub(super) fn motion(&mut self, block: &mut Block) -> Result<(), GcodeFault> {
        let explicit = block.code_of(Group::Motion).is_some();
        self.one_shot(block)?;
        if block.code_of(Group::Machine).is_some() {
            return self.machine_coordinates(block);
        }
        if block.owns_axis_words() {
            return Ok(());
        }
        let has_vector =
            self.state.tcp == Tcp::Vector && block.has_any("IJK") || block.vector.is_some();
        let has_axes = block.has_any("XYZABC") || has_vector;
        match self.modal.motion {
            // A full circle has no end: its word and a centre are enough, and on Fanuc and Haas the centre alone.
            Some(Motion::Arc { clockwise })
                if has_axes
                    || explicit && block.has_any("IJKR")
                    || self.stated(Rule::Dialect) == Some(Choice::Iso) && block.has_any("IJK") =>
            {
                self.arc(block, clockwise)
            }
            // Only the words of later blocks are known to obey the motion before the series.
            Some(Motion::Rapid | Motion::Feed)
                if has_axes && !explicit && block.code_of(Group::CycleOff).is_some() =>
            {
                Err(GcodeFault::NoMotionMode)
            }
            Some(Motion::Cycle(number)) if has_axes => self.canned_cycle(block, number),
            Some(Motion::Rapid | Motion::Feed) if has_axes => self.straight(block),
            None if has_axes => Err(GcodeFault::NoMotionMode),
            Some(Motion::Cycle(number)) if explicit => {
                let word = format!("G{number}");
                Err(missing(word, "X, Y or Z"))
            }
            _ => Ok(()),
        }
    }

    /// Returns whether the number after a letter is an increment.
    pub(super) fn is_incremental(&self, block: &Block, letter: char) -> bool {
        block.own_distance(letter).unwrap_or(self.modal.incremental)
    }

    /// Takes the axis words of a block as the end of a motion, with the axes that they name and those that they command.
    /// An increment of 0 commands nothing.
    pub(super) fn take_end(&self, block: &mut Block) -> (Position, [bool; 6], [bool; 6]) {
        let axes = self.take_axes(block);
        let mut end = self.position;
        let mut commanded = [false; 6];
        for axis in 0..AXES.len() {
            if let Some(value) = axes[axis] {
                let is_incremental = self.is_incremental(block, AXES[axis]);
                let origin = if is_incremental { end[axis] } else { Some(0.0) };
                end[axis] = origin.map(|origin| origin + value);
                commanded[axis] = !is_incremental || value != 0.0;
            }
        }
        (end, axes.map(|value| value.is_some()), commanded)
    }

    fn straight(&mut self, block: &mut Block) -> Result<(), GcodeFault> {
        let rapid = self.modal.motion == Some(Motion::Rapid);
        if !rapid {
            self.check_feed("G1")?;
        }
        self.check_tilted(block)?;
        let turns = self.take_vector(block)?;
        self.check_position(block)?;
        let shortest = AXES.map(|letter| block.is_shortest(letter));
        let (mut end, _, mut commanded) = self.take_end(block);
        // The machine turns its axes to the tool vector: the angles are not the program's.
        if turns {
            end[3..].fill(None);
            commanded[3..].fill(true);
        }
        self.push(rapid, end, commanded, StepPath::Line);
        self.pending.back_mut().expect("the step that was added").shortest = shortest;
        Ok(())
    }

    /// Takes the tool vector under G43.5 or `TRAORI`, and returns whether the block has one.
    fn take_vector(&mut self, block: &mut Block) -> Result<bool, GcodeFault> {
        if let Some(vector) = block.vector.take() {
            return self.transformed_vector(block, vector).map(|()| true);
        }
        // The angles of rotary axes end a vector under TRAORI.
        if self.state.tcp == Tcp::Transformation && block.has_any("ABC") {
            self.vector = None;
        }
        if self.state.tcp != Tcp::Vector {
            return Ok(false);
        }
        let given = AXES[3..].iter().find(|letter| block.has(**letter));
        if let Some(letter) = given {
            let condition = "G43.5 is in force";
            let remedy = "write the tool vector I J K, or select G43.4";
            return Err(combination(*letter, condition, remedy));
        }
        if !block.has_any("IJK") {
            return Ok(false);
        }
        let vector = ['I', 'J', 'K'].map(|letter| block.take(letter).unwrap_or(0.0));
        let norm = vector.iter().map(|value| value * value).sum::<f64>().sqrt();
        if norm < 1e-6 {
            return Err(GcodeFault::NoDirection);
        }
        self.vector = Some(vector.map(|value| value / norm));
        Ok(true)
    }

    /// Takes the tool vector under `TRAORI`, which is in program coordinates.
    fn transformed_vector(&mut self, block: &Block, vector: [f64; 3]) -> Result<(), GcodeFault> {
        if self.state.tcp != Tcp::Transformation {
            return Err(combination("A3=", "TRAORI is not in force", "write TRAORI before"));
        }
        if let Some(letter) = AXES[3..].iter().find(|letter| block.has(**letter)) {
            let condition = "its block has a tool vector";
            return Err(combination(*letter, condition, "write the vector, or the angles"));
        }
        let vector = Vector3::from(vector);
        let norm = vector.norm();
        if norm < 1e-6 {
            return Err(GcodeFault::NoDirection);
        }
        let turned = match self.state.rotation.frame() {
            Some(frame) => frame.rotation * vector,
            None => vector,
        };
        self.vector = Some((turned / norm).into());
        Ok(())
    }

    fn arc(&mut self, block: &mut Block, clockwise: bool) -> Result<(), GcodeFault> {
        let word = if clockwise { "G2" } else { "G3" };
        let clockwise = clockwise != self.turns_over(self.modal.plane);
        if let Some(letter) = AXES.iter().find(|letter| block.is_shortest(**letter)) {
            let condition = "its block has an arc";
            return Err(combination(
                format!("DC of {letter}"),
                condition,
                "turn the axis in a block before",
            ));
        }
        if block.vector.is_some() || self.vector.is_some() && block.has_any("ABC") {
            let condition = "its block has a tool vector, or angles after one";
            return Err(combination(word, condition, "post the arc as lines"));
        }
        if self.state.tcp == Tcp::Vector {
            let condition = "G43.5 gives I J K another meaning";
            let remedy = "post the arc as lines, or select G43.4";
            return Err(combination(word, condition, remedy));
        }
        self.check_feed(word)?;
        self.check_tilted(block)?;
        let in_plane = self.modal.plane.axes().map(|axis| ['I', 'J', 'K'][axis]);
        if self.stated(Rule::Dialect) == Some(Choice::Heidenhain)
            && block.has(in_plane[0]) != block.has(in_plane[1])
        {
            let condition = "one coordinate of its pole is left out, which keeps it on Heidenhain";
            let remedy = "write both";
            return Err(combination(word, condition, remedy));
        }
        let words = ArcWords {
            clockwise,
            plane: self.modal.plane,
            offsets: ['I', 'J', 'K'].map(|letter| self.take_length(block, letter)),
            absolute: match (self.absolute_centre(block)?, self.modal.absolute_centres) {
                (true, _) => true,
                (false, Some(absolute)) => absolute,
                (false, None) => {
                    self.choice(Rule::Dialect) == Choice::Heidenhain && !self.modal.incremental
                }
            },
            radius: self.take_length(block, 'R'),
            turns: self.turns(block)? + block.full_turns,
            unit: self.modal.unit,
        };
        self.check_position(block)?;
        let (end, _, commanded) = self.take_end(block);
        let path = path(&words, self.position, end)?;
        self.check_turn(word, &path, &end, words.turns)?;
        self.check_radii(&path, &end)?;
        if let Some(radius) = words.radius
            && self.stated(Rule::Dialect) != Some(Choice::Rs274Ngc)
        {
            self.check_radius_digits(radius, &end);
        }
        self.push(false, end, commanded, path);
        Ok(())
    }

    /// Refuses an arc that releases of LinuxCNC take for a full circle, or a full circle that they take for an arc: its ends are apart by
    /// rounding alone (`CIRCLE_FUZZ` of `_posemath.c` up to 2.8, `min_arc_angle` of `emccanon.cc`).
    fn check_turn(
        &self,
        word: &str,
        path: &StepPath,
        end: &Position,
        turns: u32,
    ) -> Result<(), GcodeFault> {
        let StepPath::Arc { plane, sweep, .. } = *path else { return Ok(()) };
        // The angle of the last turn.
        let angle = sweep.abs() - TAU * f64::from(turns - 1);
        let ends = [&self.position, end].map(|position| in_plane(position, plane.axes()));
        let [Some(from), Some(to)] = ends else { return Ok(()) };
        let distance = (from[0] - to[0]).hypot(from[1] - to[1]);
        let is_doubtful = match angle < TAU {
            true => angle < LEAST_SWEEP,
            false => distance > 0.0 && distance < SAME_POINT,
        };
        match is_doubtful && self.stated(Rule::Dialect) == Some(Choice::Rs274Ngc) {
            true => {
                let condition = "its ends differ by so little that it is a full circle, or none, by the release";
                Err(combination(word, condition, "write a line, or the end as the start"))
            }
            false => Ok(()),
        }
    }

    /// Returns whether the centre of an arc is absolute by its own words (`I=AC(…)`), of which both coordinates are then.
    fn absolute_centre(&self, block: &Block) -> Result<bool, GcodeFault> {
        let letters = self.modal.plane.axes().map(|axis| ['I', 'J', 'K'][axis]);
        let absolute = letters.map(|letter| block.own_distance(letter) == Some(false));
        match absolute {
            [false, false] => Ok(false),
            [true, true] => Ok(true),
            _ => {
                let condition = "the other coordinate of its centre is no AC";
                Err(combination("AC of a centre", condition, "write AC for both"))
            }
        }
    }

    /// Takes the number of turns of an arc.
    fn turns(&self, block: &mut Block) -> Result<u32, GcodeFault> {
        let turns = block.take_whole('P', 1, 1_000_000, "a number of turns from 1 after P")?;
        if turns.is_some_and(|turns| turns > 1)
            && self.stated(Rule::Dialect) != Some(Choice::Rs274Ngc)
        {
            let meaning = "a number of turns on LinuxCNC alone";
            let remedy = "write an arc per turn, or state `dialect = \"rs274ngc\"` of the control";
            return Err(not_read("P of an arc", meaning, remedy));
        }
        Ok(turns.unwrap_or(1))
    }

    /// Executes G53.
    fn machine_coordinates(&mut self, block: &mut Block) -> Result<(), GcodeFault> {
        if self.modal.incremental {
            return Err(combination("G53", "G91 is in force", "write G90 before"));
        }
        if self.state.tcp != Tcp::Off {
            return Err(combination("G53", "tool centre point control is on", self.tcp_remedy()));
        }
        let is_sinumerik = self.stated(Rule::Dialect) == Some(Choice::Sinumerik);
        if matches!(self.state.rotation, Rotation::Plane { .. }) && !is_sinumerik {
            return Err(combination("G53", "a plane is rotated", "end it with G69 before"));
        }
        match self.modal.motion {
            None if self.stated(Rule::Dialect) == Some(Choice::Rs274Ngc) => {
                return Err(GcodeFault::NoMotionMode);
            }
            // Elsewhere G53 alone moves in rapid traverse.
            None | Some(Motion::Rapid) => {}
            // Positioned in rapid traverse on Fanuc, at feed rate elsewhere.
            Some(Motion::Feed) => {
                let remedy = "write G0 in the block";
                return Err(combination("G53", "G1 is in force", remedy));
            }
            _ => {
                let condition = "an arc or a canned cycle is in force";
                return Err(combination("G53", condition, "write G0 in the block"));
            }
        }
        if let Some(letter) = AXES.into_iter().find(|letter| block.own_distance(*letter).is_some())
        {
            let condition = "its block has AC, IC or DC of an axis";
            let remedy = "write the axis without them, or without SUPA";
            return Err(combination(format!("G53 with {letter}"), condition, remedy));
        }
        let is_turned =
            self.rotary_axes.tilts_tool(self.state.turns_nothing(self.position, &self.rotary_axes));
        if is_turned
            && self.state.length.length() != Some(0.0)
            && self.choice(Rule::MachineCoordinates) == Choice::WithLength
        {
            let condition = "the head is turned, and the length of the tool counts along it";
            return Err(combination("SUPA", condition, "turn it back before, or write D0"));
        }
        let axes = self.take_axes(block);
        if axes.iter().all(Option::is_none) {
            return Err(missing("G53", "an axis word"));
        }
        self.move_to_machine(axes);
        // G53 can cancel the length offset as G28 does, by a parameter of Fanuc (5001, EVO).
        if axes[2].is_some() && self.state.length != LengthOffset::Off {
            self.returned = self.returned.or(Some(Returned::MachineHeight));
        }
        Ok(())
    }

    /// Moves axes to machine coordinates as they are programmed.
    pub(super) fn move_to_machine(&mut self, axes: Position) {
        let mut target = axes;
        // Without the place of the part on the machine its coordinates lead nowhere that is known.
        let length = self.state.length.length();
        if let Some(z) = axes[2]
            && length != Some(0.0)
            && self.state.origin[2].is_some()
            && self.choice(Rule::MachineCoordinates) == Choice::WithLength
        {
            target[2] = length.map(|length| z + length);
        }
        let is_homeward = self.leads_home(axes);
        self.move_machine(axes.map(|value| value.is_some()), target, StepPath::Line);
        self.set_homeward(is_homeward);
    }

    /// Returns whether axes move to the top of Z's travel, or from there, where they are free.
    pub(super) fn leads_home(&self, axes: Position) -> bool {
        axes[2].map_or(self.position[2].is_none(), |z| self.is_top(z))
    }

    /// Returns whether Z is at the top of its travel or its reference position, in machine coordinates. Where the machine does not state
    /// its limits, the top is at 0.
    fn is_top(&self, z: f64) -> bool {
        self.top.unwrap_or_default() == z || self.home[2] == Some(z)
    }

    /// Notes whether the last step is the way home.
    pub(super) fn set_homeward(&mut self, is_homeward: bool) {
        self.pending.back_mut().expect("the step that was added").is_homeward = is_homeward;
    }

    /// Executes G28 or G30: to the intermediate position, then to the reference position.
    pub(super) fn reference_return(
        &mut self,
        block: &mut Block,
        word: &str,
    ) -> Result<(), GcodeFault> {
        if self.state.tcp != Tcp::Off {
            return Err(combination(word, "tool centre point control is on", self.tcp_remedy()));
        }
        if self.modal.cycle().is_some() {
            return Err(combination(word, "a canned cycle is in force", "write G80 before"));
        }
        if matches!(self.state.rotation, Rotation::Plane { .. }) {
            return Err(combination(word, "a plane is rotated", "end it with G69 before"));
        }
        if word == "G30" {
            block.take_whole('P', 2, 2, "P2, or no P")?;
        }
        self.check_tilted(block)?;
        // An increment of 0 along Z states nothing, and on Fanuc the change of the length acts on it: the way through the place where the
        // offset leads is that of controls on which it does, too.
        let is_dropped = self.length_changed && block.has('Z') && self.is_incremental(block, 'Z');
        match block.value('Z') {
            Some(0.0) if is_dropped => {
                self.check_shifted(block)?;
                self.check_after_rotation(block)?;
                let is_linuxcnc = self.stated(Rule::Dialect) == Some(Choice::Rs274Ngc);
                if let Some(height) = self.height_before.filter(|_| !is_linuxcnc) {
                    if block.is_nonzero("XYABC") {
                        let condition =
                            "the length offset has changed, which may act on Z in its block";
                        return Err(combination(word, condition, "write Z in a block before"));
                    }
                    self.move_along_z(Some(height), true);
                }
            }
            _ => self.check_position(block)?,
        }
        let (end, mut named, commanded) = self.take_end(block);
        // Without axes all return on LinuxCNC and Haas, and none on Fanuc.
        if !named.contains(&true) {
            if self.stated(Rule::Dialect) != Some(Choice::Rs274Ngc) {
                return Err(missing(word, "the axes that return"));
            }
            named = self.axes;
        }
        // By increments of 0 the intermediate position is where the machine stands.
        if commanded.contains(&true) {
            self.push(true, end, commanded, StepPath::Line);
        }
        // LinuxCNC returns along the axis that is rotated.
        if self.state.origin_rotation != 0.0 && named[0] != named[1] {
            let condition = "the work offset is rotated";
            let remedy = "name X and Y, or neither";
            return Err(combination(word, condition, remedy));
        }
        // The other axes are free where Z returns, too, or stands at its home or where nobody knows.
        let machine = self.state.to_machine(self.position)[2];
        let is_at_top = machine.is_some_and(|z| self.is_top(z));
        let is_homeward = named[2] || self.position[2].is_none() || is_at_top;
        let second = || self.second_home.map_or([None; 6], |home| home.map(Some));
        let target = if word == "G28" { self.home } else { second() };
        self.move_machine(named, target, StepPath::Line);
        let step = self.pending.back_mut().expect("the step that was added");
        (step.is_return, step.is_homeward) = (true, is_homeward);
        let returned = if named[2] { Returned::Height } else { Returned::OtherAxes };
        self.returned = (self.state.length != LengthOffset::Off).then_some(returned);
        Ok(())
    }

    /// Moves axes to machine coordinates in rapid traverse. An unknown coordinate leads where only the machine knows.
    pub(super) fn move_machine(
        &mut self,
        mut commanded: [bool; 6],
        target: Position,
        path: StepPath,
    ) {
        if commanded[2] {
            self.height_before = None;
        }
        // The kinematics have no part while the rotary axes turn nothing.
        let mut state = (*self.state).clone();
        if self.turns_nothing() {
            state.tcp = Tcp::Off;
            if let Rotation::Tilted { aligned, .. } = &mut state.rotation {
                *aligned = false;
            }
        }
        let mut machine = state.to_machine(self.position);
        for axis in 0..6 {
            if commanded[axis] {
                machine[axis] = target[axis];
            }
        }
        let mut end = state.from_machine(machine);
        // A target that turns an axis moves the part, and positions with it. Those of turned axes are the machine's alone.
        let turned = (3..6).any(|axis| commanded[axis] && end[axis] != self.position[axis]);
        let follows = self.state.turns_with_workpiece() && (turned || !self.turns_nothing());
        // A rotation makes program axes depend on several machine axes.
        let is_coupled = match (self.state.rotation, self.state.origin_rotation == 0.0) {
            (Rotation::Off, true) => [false; 6],
            (Rotation::Off, false) => [true, true, false, false, false, false],
            _ => [true, true, true, false, false, false],
        };
        let moved = commanded;
        let moves_coupled = (0..6).any(|axis| commanded[axis] && is_coupled[axis]);
        for axis in 0..6 {
            if is_coupled[axis] && moves_coupled {
                commanded[axis] = true;
            } else if !commanded[axis] {
                end[axis] = self.position[axis];
            }
        }
        let mut path = path;
        if follows {
            end[..3].fill(None);
            if path == StepPath::Line {
                path = StepPath::Machine(target);
            }
        }
        // These state which axes of the machine move: the others stay, also in a rotated plane.
        let is_of_machine = matches!(path, StepPath::ToolChange(_) | StepPath::Machine(_));
        self.push(true, end, if is_of_machine { moved } else { commanded }, path);
        let step = self.pending.back_mut().expect("the step that was added");
        // Machine coordinates are stated in G91, too.
        step.absolute = true;
        step.machine_height = target[2].filter(|_| moved[2]);
    }
}

/// Words of an arc, lengths in millimetres.
#[derive(Clone, Copy, Debug)]
pub(super) struct ArcWords {
    pub(super) clockwise: bool,
    pub(super) plane: Plane,
    /// Numbers after I, J and K.
    pub(super) offsets: [Option<f64>; 3],
    /// Set by G90.1: I J K are coordinates, not distances from the start.
    pub(super) absolute: bool,
    pub(super) radius: Option<f64>,
    /// Number of turns, a begun one included.
    pub(super) turns: u32,
    /// The unit of the program, in which the tolerances are defined.
    pub(super) unit: Unit,
}

/// Distance below which start and end are the same point, in millimetres. It is a hundredth of the least
/// increment of a control, and far above the rounding of a position.
const SAME_POINT: f64 = 1e-5;
/// The least angle of an arc that is none for LinuxCNC's earlier releases, with a margin, in radians.
const LEAST_SWEEP: f64 = 2e-6;
/// Smallest radius, in millimetres.
const LEAST_RADIUS: f64 = 1e-7;
/// Largest relative difference of the radii of start and end: LinuxCNC's.
const RELATIVE_TOLERANCE: f64 = 1e-3;
/// LinuxCNC's absolute tolerance is a hundred times as large as the one that it allows beyond the relative
/// one.
const LARGEST_FACTOR: f64 = 100.0;

/// Returns the difference of radii that is always allowed, in millimetres. A centre that is rounded to 0.01
/// mm or 0.001 inch in both coordinates differs by as much (LinuxCNC's `CENTER_ARC_RADIUS_TOLERANCE`).
fn radius_tolerance(unit: Unit) -> f64 {
    match unit {
        Unit::Inch => 2.0 * 0.001 * SQRT_2 * Unit::Inch.millimetres(),
        _ => 2.0 * 0.01 * SQRT_2,
    }
}

/// Returns the largest excess of half the chord over a radius R, in millimetres: LinuxCNC's 0.00005 inch.
const CHORD_TOLERANCE: f64 = 0.00005 * 25.4;

/// Computes the path of an arc between two positions in program coordinates.
///
/// The arc is in the plane's coordinates (first axis, second axis), in which a positive sweep is from the
/// first to the second. With a centre, an end within 1e-5 mm of the start is a full circle. With a radius R,
/// the sweep is at most half a turn for R > 0, and at least half a turn for R < 0. Near half a turn, the
/// centre is ill-conditioned: an error δ of the end moves it by up to √(2 R δ). With a centre, the sweep of
/// one turn is within 2⁻⁴⁹ (1 + D / r) of exact, for the radius r and the largest coordinate D.
pub(super) fn path(words: &ArcWords, start: Position, end: Position) -> Result<StepPath, ArcFault> {
    let [first, second] = words.plane.axes();
    let letters = centre_letters(words.plane);
    let normal = words.plane.normal();
    // Posts that always write I, J and K give 0 for the third.
    let other = words.offsets[normal].filter(|offset| words.absolute || *offset != 0.0);
    if other.is_some() {
        return Err(ArcFault::OtherPlane { letter: ['I', 'J', 'K'][normal], centre: letters });
    }
    let offsets = [words.offsets[first], words.offsets[second]];
    let known = in_plane(&start, [first, second]).zip(in_plane(&end, [first, second]));
    match (words.radius, offsets) {
        (None, [None, None]) => Err(ArcFault::NoCentre { centre: letters }),
        (Some(radius), [None, None]) => match known {
            Some((start, end)) => by_radius(words, radius, start, end),
            None => Ok(StepPath::Undetermined),
        },
        (Some(_), _) => Err(ArcFault::CentreAndRadius),
        (None, [None, _] | [_, None]) if words.absolute => {
            Err(ArcFault::HalfCentre { centre: letters })
        }
        (None, [i, j]) => match known {
            Some((start, end)) => {
                let [i, j] = [i.unwrap_or(0.0), j.unwrap_or(0.0)];
                let centre = if words.absolute { [i, j] } else { [start[0] + i, start[1] + j] };
                by_centre(words, centre, start, end)
            }
            None => Ok(StepPath::Undetermined),
        },
    }
}

fn by_centre(
    words: &ArcWords,
    centre: [f64; 2],
    start: [f64; 2],
    end: [f64; 2],
) -> Result<StepPath, ArcFault> {
    let [from, to] = [start, end].map(|point| [point[0] - centre[0], point[1] - centre[1]]);
    let [start_radius, end_radius] = [from, to].map(|[u, v]| u.hypot(v));
    if start_radius < LEAST_RADIUS || end_radius < LEAST_RADIUS {
        return Err(ArcFault::ZeroRadius);
    }
    let difference = (start_radius - end_radius).abs();
    let tolerance = radius_tolerance(words.unit);
    let relative = RELATIVE_TOLERANCE * start_radius.max(end_radius);
    let allowed = relative.clamp(tolerance, LARGEST_FACTOR * tolerance);
    if difference > allowed {
        let (start, end, tolerance) = (start_radius, end_radius, allowed);
        return Err(ArcFault::Radii { start, end, tolerance });
    }
    let is_full = (start[0] - end[0]).hypot(start[1] - end[1]) < SAME_POINT;
    let sweep = if is_full { TAU } else { counterclockwise(from, to, words.clockwise) };
    Ok(arc(words, centre, sweep))
}

fn by_radius(
    words: &ArcWords,
    radius: f64,
    start: [f64; 2],
    end: [f64; 2],
) -> Result<StepPath, ArcFault> {
    let chord = [end[0] - start[0], end[1] - start[1]];
    let half = 0.5 * chord[0].hypot(chord[1]);
    if 2.0 * half < SAME_POINT {
        return Err(ArcFault::SamePoint { centre: centre_letters(words.plane) });
    }
    if radius.abs() < LEAST_RADIUS {
        return Err(ArcFault::ZeroRadius);
    }
    if half - radius.abs() > CHORD_TOLERANCE {
        return Err(ArcFault::TooShort { radius: radius.abs(), half });
    }
    // The product of sum and difference keeps its digits near half a turn.
    let squared = (radius.abs() - half) * (radius.abs() + half);
    let height = squared.max(0.0).sqrt();
    // The centre of a counter-clockwise arc of less than half a turn is left of its chord.
    let side = if words.clockwise == (radius > 0.0) { -height } else { height };
    let scale = side / (2.0 * half);
    let middle = [0.5 * (start[0] + end[0]), 0.5 * (start[1] + end[1])];
    let centre = [middle[0] - chord[1] * scale, middle[1] + chord[0] * scale];
    let half_angle = half.atan2(height);
    let sweep = if radius > 0.0 { 2.0 * half_angle } else { TAU - 2.0 * half_angle };
    Ok(arc(words, centre, sweep))
}

/// Returns the angle, from 0 to a full turn, from one direction to another, in the direction of the arc.
fn counterclockwise(from: [f64; 2], to: [f64; 2], clockwise: bool) -> f64 {
    let cross = from[0] * to[1] - from[1] * to[0];
    let dot = from[0] * to[0] + from[1] * to[1];
    let angle = if clockwise { (-cross).atan2(dot) } else { cross.atan2(dot) };
    // The end of a spiral in the direction of its start is a whole turn away: a full circle was told apart before.
    if angle <= 0.0 { angle + TAU } else { angle }
}

fn arc(words: &ArcWords, centre: [f64; 2], sweep: f64) -> StepPath {
    let sweep = sweep + TAU * f64::from(words.turns - 1);
    let sweep = if words.clockwise { -sweep } else { sweep };
    StepPath::Arc { plane: words.plane, centre, sweep }
}

/// Returns the letters of a centre in a plane.
const fn centre_letters(plane: Plane) -> &'static str {
    match plane {
        Plane::Xy => "I and J",
        Plane::Zx => "I and K",
        Plane::Yz => "J and K",
    }
}
