//! Words that change what positions mean: tools and their lengths, work offsets, shifts, tool centre point
//! control, rotated and tilted planes.

use super::{AXES, Control, Motion, Returned};
use crate::gcode::block::{Block, Code, Group, Keyword};
use crate::gcode::error::{combination, missing, not_read, same_group};
use crate::gcode::note::NoteKind;
use crate::gcode::rules::{Choice, Rule};
use crate::gcode::state::{
    ControlState, Frame, LengthOffset, Position, Rotation, Tcp, WorkOffset, about,
};
use crate::gcode::{GcodeFault, Plane, StepPath, Z_ALONE};
use nalgebra::{Matrix3, Vector3};
use std::sync::Arc;

/// Largest number of a tool or a register.
const MAX_REGISTER: u32 = 99_999_999;

impl Control {
    /// Changes the state. The machine stands still, so its position gets other coordinates.
    pub(super) fn change(&mut self, edit: impl FnOnce(&mut ControlState)) {
        let mut new = (*self.state).clone();
        edit(&mut new);
        // Steps share the state until it changes.
        if new != *self.state {
            if new.length != self.state.length {
                self.length_changed = true;
                // Tool centre point control ends where the kinematics have it.
                let is_plain = [&new, &self.state].iter().all(|state| state.tcp == Tcp::Off);
                self.height_before = self.height_before.or(self.position[2]).filter(|_| is_plain);
            }
            // A plane that turns nothing leaves nothing open.
            let is_upright = [&new, &self.state].iter().all(|state| {
                state.rotation.frame().is_none_or(|frame| frame.rotation == Matrix3::identity())
            });
            self.rotation_changed |= new.rotation != self.state.rotation && !is_upright;
            for (axis, changed) in self.origin_changed.iter_mut().enumerate() {
                *changed |= new.origin[axis] != self.state.origin[axis]
                    || new.shift[axis] != self.state.shift[axis];
            }
            self.position = self.state.carry_over(&new, self.position, &self.rotary_axes);
            self.state = Arc::new(new);
        }
    }

    /// Returns whether it is certain that no rotary axis turns the tool or the part.
    pub(in crate::gcode) fn turns_nothing(&self) -> bool {
        self.state.turns_nothing(self.position, &self.rotary_axes) == [true; 3]
    }

    /// Counts a tilted plane that begins, also where its frame is that of the plane before.
    pub(in crate::gcode) fn begin_plane(&mut self) {
        let is_tilted = matches!(self.state.rotation, Rotation::Tilted { .. });
        self.change(|state| state.plane_starts += usize::from(is_tilted));
    }

    /// Reads T, M6 and D.
    pub(super) fn tool(&mut self, block: &mut Block) -> Result<(), GcodeFault> {
        let expected = "a whole number from 0";
        let (has_tool, before) = (block.has('T'), self.staged);
        let has_change = block.code_of(Group::ToolChange).is_some();
        if let Some(tool) = block.take_whole('T', 0, MAX_REGISTER, expected)? {
            self.staged = Some(tool);
        }
        let compensation = block.tenths_of(Group::CutterCompensation).unwrap_or(400);
        // D of G41.1 and G42.1 is a diameter.
        let has_diameter = matches!(compensation, 411 | 421);
        if !has_diameter && let Some(edge) = block.take_whole('D', 0, MAX_REGISTER, expected)? {
            // D in the block of T or M6 holds for the tool after the change, where D1 is in force anyway. In a block of its own it is that
            // of the tool in the spindle on Sinumerik, whatever tool the changer prepares.
            let is_native = self.stated(Rule::Dialect) == Some(Choice::Sinumerik);
            let is_staged = self.staged.is_some()
                && self.staged != self.state.tool
                && !(is_native && self.state.tool.is_some());
            let is_between = (edge != 1 || self.length_cancelled)
                && (has_tool || has_change || is_staged)
                && self.choice(Rule::ToolLength) == Choice::Always;
            let can_wait = edge < 2 && self.stated(Rule::Dialect) == Some(Choice::Sinumerik);
            if is_between && !can_wait {
                let condition = "a tool is about to be changed, for which it counts";
                let remedy = "write it after the change";
                return Err(combination(format!("D{edge}"), condition, remedy));
            }
            self.edge = Some(edge);
            if compensation == 400 {
                self.notes.add(self.block(), NoteKind::PassedOver { word: "D".to_owned() });
            }
            self.staged_edge = is_between.then_some(edge);
            self.needs_edge &= is_between;
            // D1 is in force after the change anyway. D0 ends the length of the tool in the spindle.
            if !is_between || edge == 0 && !has_change && self.state.tool.is_some() {
                self.edge_length(edge)?;
            }
        }
        let changes = match self.stated(Rule::Dialect) {
            // T changes the tool at once, and an M6 after it finds it in the spindle.
            Some(Choice::Heidenhain) => has_tool || has_change && self.staged != self.state.tool,
            _ => has_change,
        };
        // These words act before the change on some controls, and after it on others.
        let mut groups = [Group::OneShot, Group::Machine, Group::Length].into_iter();
        if has_change && let Some(code) = groups.find_map(|group| block.code_of(group)) {
            let remedy = "write it in a block before or after";
            return Err(combination(code, "its block has M6", remedy));
        }
        if (has_change || changes) && block.has_any("XYZABCIJK") {
            let condition = "its block has axis words";
            let remedy = "write them in a block before or after";
            return Err(combination(if has_change { "M6" } else { "T" }, condition, remedy));
        }
        // Some changers take T in the block of M6 for the tool after this one.
        if has_change
            && let (Some(before), Some(tool)) = (before, self.staged)
            && before != tool
            && self.state.tool != Some(before)
        {
            let condition = "another tool is staged";
            let remedy = "write T in a block before M6";
            return Err(combination(format!("T{tool} M6"), condition, remedy));
        }
        if has_change || changes {
            self.stop_spindle();
        }
        match self.staged {
            Some(tool) if changes => self.change_tool(tool),
            None if changes => {
                let needed = "the number of a tool (T) in this block or before";
                return Err(missing("M6", needed));
            }
            _ => {}
        }
        Ok(())
    }

    /// Changes the tool.
    fn change_tool(&mut self, tool: u32) {
        self.notes.add(self.block(), NoteKind::ToolChange);
        // The tool before the first change may be the same.
        let before = self.state.tool;
        self.leave_for_change(before.is_none_or(|before| before == tool));
        self.length_cancelled = false;
        // The first edge of the new tool is in force.
        self.edge = None;
        self.needs_edge = self.staged_edge.take() == Some(0);
        self.change(|state| state.tool = Some(tool));
        // Not asked: whether the length counts matters at the next motion only.
        let is_always = self.stated(Rule::ToolLength) == Some(Choice::Always);
        if self.length_implicit || is_always && self.state.length == LengthOffset::Off {
            self.imply_length(tool);
        }
        // The new tool is where the change has left the axes, also if it moves no more.
        if self.has_loads && before != Some(tool) {
            self.push(true, self.position, [false; 6], StepPath::ToolChange([None; 6]));
        }
    }

    /// Refuses Z where a D between T and M6 leaves the length to the control: before the change for D1, after it for D0.
    pub(super) fn check_staged_edge(&self, block: &Block) -> Result<(), GcodeFault> {
        let is_position = block.is_programmed() || block.code_of(Group::Machine).is_some();
        let is_open = self.needs_edge || self.staged_edge == Some(1);
        match is_open && is_position && block.has('Z') {
            true => {
                let condition = "D was written between T and M6, for the tool before the change or for the one after it";
                Err(combination("Z", condition, "write D after the change"))
            }
            false => Ok(()),
        }
    }

    /// Executes D where it selects the length of the tool: 0 is none, and 1 the only edge whose length is known.
    fn edge_length(&mut self, edge: u32) -> Result<(), GcodeFault> {
        let Some(tool) = self.state.tool else {
            if edge != 1 && self.choice(Rule::ToolLength) == Choice::Always {
                let needed = "a tool in the spindle (T M6) before";
                return Err(missing(format!("D{edge}"), needed));
            }
            return Ok(());
        };
        // D1 is in force without a word, unless the offset was cancelled.
        let is_first = edge == 1 && !self.length_cancelled;
        if is_first || self.choice(Rule::ToolLength) != Choice::Always {
            return Ok(());
        }
        if edge == 1 {
            self.length_cancelled = false;
            self.imply_length(tool);
            return Ok(());
        }
        if edge > 1 {
            let expected = "D1, the only cutting edge whose length is known";
            return Err(GcodeFault::NotAllowed { word: 'D', value: f64::from(edge), expected });
        }
        (self.length_cancelled, self.length_implicit) = (true, false);
        self.change(|state| state.length = LengthOffset::Off);
        Ok(())
    }

    /// Applies the length of the tool in the spindle, of which an empty one has none.
    fn imply_length(&mut self, tool: u32) {
        self.length_implicit = true;
        let length = if tool == 0 { LengthOffset::Off } else { self.registered(tool) };
        self.change(|state| state.length = length);
    }

    /// Moves the axes as a tool change does. A change to the tool in the spindle may leave them.
    fn leave_for_change(&mut self, is_same: bool) {
        let stated = self.change_position;
        let (moved, target) = match stated {
            Some(target) => (target.map(|value| value.is_some()), target),
            None => match self.choice(Rule::ToolChange) {
                Choice::Retracts => {
                    // A change to the tool in the spindle may leave Z on Haas: its height is unknown then, unless it stands at
                    // its home.
                    let height = self.home[2];
                    let present = self.state.to_machine(self.position)[2];
                    if is_same && present.is_none() {
                        return;
                    }
                    let stays = is_same && present != height;
                    let height = height.filter(|_| !stays);
                    (Z_ALONE, [None, None, height, None, None, None])
                }
                Choice::Moves => (self.axes, [None; 6]),
                _ => return,
            },
        };
        if moved.contains(&true) {
            self.move_machine(moved, target, StepPath::ToolChange(target));
        }
    }

    /// Ends the length offset that a return has cancelled, before a block to which it matters.
    pub(super) fn returned_length(&mut self, block: &Block) {
        let one_shot = block.tenths_of(Group::OneShot);
        let matters = match one_shot {
            // By increments of 0 the intermediate position is where the machine stands.
            Some(280 | 300) => block.is_nonzero("Z") || block.has('Z') && !self.modal.incremental,
            Some(920) => block.has('Z'),
            Some(_) => false,
            None => self.depends_on_length(block) || block.code_of(Group::Rotation).is_some(),
        };
        let Some(returned) = self.returned.filter(|_| matters) else { return };
        self.returned = None;
        let cancels = match self.choice(Rule::ReferenceReturn) {
            Choice::CancelsLength => returned != Returned::MachineHeight,
            Choice::CancelsLengthByG53 => true,
            _ => false,
        };
        if cancels {
            self.length_cancelled = true;
            self.change(|state| state.length = LengthOffset::Off);
        }
    }

    /// Returns whether the length offset matters to the motion of a block in program coordinates. It moves Z alone, but in a
    /// rotated plane, or the normal of the plane where it counts without a word.
    pub(super) fn depends_on_length(&self, block: &Block) -> bool {
        let is_cycle = self.modal.cycle().is_some();
        let normal = AXES[self.modal.plane.normal()];
        let is_moved = block.has('Z') || block.has(normal);
        block.is_programmed() && (is_moved || is_cycle || self.state.rotation != Rotation::Off)
    }

    /// Gives the length offset the value that the control gives it without a word, before a motion to which it matters.
    pub(super) fn length_without_word(&mut self) {
        if let (LengthOffset::Off, false, Some(tool)) =
            (self.state.length, self.length_cancelled, self.state.tool)
            && tool != 0
            && self.choice(Rule::ToolLength) == Choice::Always
        {
            self.imply_length(tool);
        }
    }

    /// Executes the words that change coordinates and use no axis words, and G68.
    pub(super) fn coordinates(&mut self, block: &mut Block) -> Result<(), GcodeFault> {
        let rotation = block.code_of(Group::Rotation);
        if rotation.is_some_and(|code| code.tenths == 690) {
            self.change(|state| state.rotation = Rotation::Off);
        }
        if let Some(code) = block.code_of(Group::Length) {
            let (before, height) = (Arc::clone(&self.state), self.position[2]);
            let has_returned =
                matches!(self.returned, Some(Returned::Height | Returned::MachineHeight));
            self.length(block, code)?;
            // The Z of G53 is that of a motion, those of G28, G52, G92, G10 and a rotation are none.
            let is_owned = block.owns_axis_words() && block.code_of(Group::Machine).is_none();
            // At a reference position the offset is suspended, so that its change moves nothing.
            if (is_owned || !block.has('Z'))
                && !has_returned
                && self.moves_by_length(&before, height)
            {
                let is_rotated = self.state.rotation != Rotation::Off;
                let others = if is_owned { "XYZABCIJK" } else { "XYABCIJK" };
                if is_rotated || block.has_any(others) {
                    let condition = "the length offset changes, and moves Z";
                    let remedy = "write it in a block of its own, without a rotation";
                    return Err(combination(code, condition, remedy));
                }
                let rapid = matches!(self.modal.motion, None | Some(Motion::Rapid));
                self.move_along_z(height, rapid);
            } else if has_returned {
                self.height_before = None;
            }
        }
        self.transformation(block)?;
        if let Some(code) = block.code_of(Group::WorkOffset) {
            self.work_offset(block, code)?;
        }
        match rotation {
            Some(code) if code.tenths == 680 => self.rotate(block, code),
            Some(code) if code.tenths == 682 => self.tilt(block, code),
            _ => Ok(()),
        }
    }

    /// Executes G43, G49 and the words for tool centre point control of their group.
    fn length(&mut self, block: &mut Block, code: Code) -> Result<(), GcodeFault> {
        let at_zero = self.turns_nothing();
        if self.transformed && self.state.tcp == Tcp::Rotary && !at_zero {
            let condition = "M428 is in force with turned axes, which LinuxCNC moves by it";
            return Err(combination(code, condition, "write it before M428, or at 0"));
        }
        // From here on the offset is what the program says, whatever a return or the tool change has done to it.
        (self.returned, self.length_implicit) = (None, false);
        // G43 and G49 do not end a transformation.
        let kept = if self.transformed { self.state.tcp } else { Tcp::Off };
        if code.tenths == 490 {
            let is_return = block.code_of(Group::OneShot).is_some();
            if self.state.tcp != kept && !is_return && block.has_any("XYZABC") {
                let condition = "its block has a position, and it ends tool centre point control";
                return Err(combination(code, condition, "write it in a block of its own"));
            }
            self.vector = None;
            self.length_cancelled = true;
            self.change(|state| (state.length, state.tcp) = (LengthOffset::Off, kept));
            return Ok(());
        }
        let tcp = match code.tenths {
            430 => kept,
            _ if self.transformed => {
                return Err(combination(code, "M428 or TRAORI is in force", "end it before"));
            }
            435 => Tcp::Vector,
            _ => Tcp::Rotary,
        };
        if tcp == Tcp::Vector && self.state.rotation != Rotation::Off {
            return Err(combination(code, "a plane is rotated", "end it with G69 before"));
        }
        let is_tcp = matches!(self.state.tcp, Tcp::Rotary | Tcp::Vector);
        if code.tenths == 430 && is_tcp && !self.transformed {
            let condition = "tool centre point control is on, which it ends on some controls";
            return Err(combination(code, condition, "write G49 before"));
        }
        let is_across = code.tenths == 430 && self.modal.plane != Plane::Xy;
        if is_across && self.stated(Rule::Dialect) != Some(Choice::Rs274Ngc) {
            let condition =
                "G18 or G19 is in force, across which Fanuc can count the length (TLB, TLC)";
            return Err(combination(code, condition, "write it while G17 is in force"));
        }
        if code.tenths == 2340 && !block.has('H') {
            let needed = "H in its block, since Haas cancels the one before";
            return Err(missing(code, needed));
        }
        if code.tenths != 430 && block.has_any("ABCIJK") {
            let condition = "its block turns the axes, without tool centre point control on Fanuc";
            return Err(combination(code, condition, "write it in a block before"));
        }
        // With turned axes the offset moves X and Y too, on Fanuc and Haas, unless the block states where to.
        self.tcp_position_needed = code.tenths != 430 && !at_zero;
        let mut given = block.take_whole('H', 0, MAX_REGISTER, "a whole number from 0 after H")?;
        let is_zero = given == Some(0) && code.tenths == 430;
        if given.is_none()
            && (code.tenths == 430 || self.state.length == LengthOffset::Off)
            && self.last_register != self.state.tool
            && self.choice(Rule::LengthRegister) == Choice::LastH
        {
            given = Some(self.last_register.unwrap_or(0));
        }
        self.last_register = given.or(self.last_register);
        if is_zero {
            match self.stated(Rule::Dialect) {
                Some(Choice::Rs274Ngc) => given = None,
                None => {
                    let condition =
                        "it ends the length offset, or takes that of the tool on LinuxCNC";
                    return Err(combination(code, condition, "write G49, or name the control"));
                }
                Some(_) => {}
            }
        }
        self.length_cancelled = given == Some(0);
        let length = match (given, self.state.length, self.state.tool) {
            (Some(0), ..) => LengthOffset::Off,
            (Some(register), ..) => self.registered(register),
            // Under tool centre point control, H of the block before stays in force.
            (None, known @ LengthOffset::On { .. }, _) if code.tenths != 430 => known,
            (None, _, Some(tool)) => self.registered(tool),
            (None, _, None) => {
                let needed =
                    "H with the number of a length, or a tool in the spindle before (T and M6)";
                return Err(missing(code, needed));
            }
        };
        self.vector = None;
        let is_start = code.tenths != 430;
        self.change(|state| {
            (state.length, state.tcp) = (length, tcp);
            state.tcp_starts += usize::from(is_start);
        });
        Ok(())
    }

    /// Returns whether the control moves Z by a change of the length offset without a word for Z: as by an increment of 0.
    fn moves_by_length(&mut self, before: &ControlState, height: Option<f64>) -> bool {
        height.is_some()
            && before.length != self.state.length
            && before.tcp == Tcp::Off
            && self.state.tcp == Tcp::Off
            && self.choice(Rule::LengthChange) == Choice::MovesZ
    }

    /// Moves Z to the coordinate that it had before.
    pub(super) fn move_along_z(&mut self, height: Option<f64>, rapid: bool) {
        let mut end = self.position;
        end[2] = height;
        (self.length_changed, self.height_before) = (false, None);
        self.push(rapid, end, Z_ALONE, StepPath::Line);
    }

    fn registered(&self, register: u32) -> LengthOffset {
        LengthOffset::On { register, length: self.lengths.get(&register).copied() }
    }

    /// Executes M428, M429, `TRAORI` and `TRAFOOF`.
    fn transformation(&mut self, block: &Block) -> Result<(), GcodeFault> {
        let kinematics = block.code_of(Group::Kinematics);
        let word = match (kinematics, block.keyword) {
            (Some(code), Some(_)) => {
                let (first, second) = (code.to_string(), "TRAORI or TRAFOOF".to_owned());
                return Err(same_group(first, second));
            }
            (Some(code), None) => code.to_string(),
            (None, Some(Keyword::TransformationOn)) => "TRAORI".to_owned(),
            (None, Some(Keyword::TransformationOff)) => "TRAFOOF".to_owned(),
            (None, None) => return self.check_edge(),
        };
        if self.state.tcp != Tcp::Off && !self.transformed {
            let condition = "G43.4, G43.5 or G234 is in force";
            let remedy = "end it with G49 before";
            return Err(combination(word, condition, remedy));
        }
        if block.keyword.is_some() {
            if block.has_words() {
                let condition =
                    "its block has other words, before or after which the transformation changes";
                let remedy = "write it in a block of its own";
                return Err(combination(word, condition, remedy));
            }
            self.transformation_changed = true;
        }
        if word == "M429" || word == "TRAFOOF" {
            // A tool vector ends with the transformation.
            (self.transformed, self.vector) = (false, None);
            self.change(|state| state.tcp = Tcp::Off);
            return Ok(());
        }
        let mut length = self.state.length;
        // Sinumerik applies the length of the tool in the spindle without a word.
        if block.keyword.is_some() && length == LengthOffset::Off {
            let Some(tool) = self.state.tool else {
                return Err(missing(word, "a tool in the spindle (T M6)"));
            };
            length = self.registered(tool);
        }
        self.transformed = true;
        // Only LinuxCNC has M428, also where its dialect follows from the program.
        if block.keyword.is_none() {
            self.choice(Rule::RotaryDirection);
            self.choice(Rule::HeadLength);
        }
        let tcp = if block.keyword.is_some() { Tcp::Transformation } else { Tcp::Rotary };
        self.change(|state| {
            (state.length, state.tcp) = (length, tcp);
            state.tcp_starts += 1;
        });
        self.check_edge()
    }

    /// Refuses another cutting edge than the first of the tool under `TRAORI`: it has another length.
    fn check_edge(&self) -> Result<(), GcodeFault> {
        match self.edge {
            Some(edge) if self.transformed && edge != 1 => Err(GcodeFault::NotAllowed {
                word: 'D',
                value: f64::from(edge),
                expected: "D1, the only cutting edge whose length is known, under TRAORI",
            }),
            _ => Ok(()),
        }
    }

    /// Executes G54 to G59.3 and G54.1.
    fn work_offset(&mut self, block: &mut Block, code: Code) -> Result<(), GcodeFault> {
        let offset = match code.tenths {
            tenths @ 1100..=1290 => {
                WorkOffset::Additional((tenths / 10 - WorkOffset::FIRST_OF_HAAS + 1) as u16)
            }
            541 | 1540 => {
                let expected = "a whole number from 1 to 300 after P";
                match block.take_whole('P', 1, 300, expected)? {
                    Some(number) => WorkOffset::Additional(number as u16),
                    None => {
                        let needed = "P with the number of the offset";
                        return Err(missing(code, needed));
                    }
                }
            }
            tenths @ 540..=590 => WorkOffset::Standard((tenths / 10 - 53) as u8),
            // G59.1 to G59.3 go on from G59.
            tenths => WorkOffset::Standard((tenths - 590 + 6) as u8),
        };
        if matches!(code.tenths, 580 | 590) {
            match self.stated(Rule::Dialect) {
                None => self.notes.add(self.block(), NoteKind::OffsetOrShift),
                Some(Choice::Sinumerik) => {
                    let meaning = "a shift in native programs of Sinumerik";
                    let remedy = "write G54 to G57, or state `dialect = \"iso\"` of the control";
                    return Err(not_read(code, meaning, remedy));
                }
                Some(_) => {}
            }
        }
        // The centre of a rotation is in coordinates of the work offset before.
        if offset != self.state.work_offset && self.stated(Rule::Dialect) != Some(Choice::Sinumerik)
        {
            self.check_unrotated(code)?;
        }
        self.select_offset(offset);
        Ok(())
    }

    /// Puts a work offset in force.
    pub(super) fn select_offset(&mut self, offset: WorkOffset) {
        self.offset_stated = true;
        (self.needs_offset, self.transformation_changed) = (None, false);
        self.activate(offset);
    }

    fn activate(&mut self, offset: WorkOffset) {
        let origin = self.origin_of(offset);
        self.change(|state| {
            state.work_offset = offset;
            (state.origin, state.origin_rotation) = origin;
        });
    }

    /// Returns the origin of a work offset in machine coordinates, and its rotation about z in degrees.
    pub(super) fn origin_of(&self, offset: WorkOffset) -> (Position, f64) {
        self.origins.get(&offset).copied().unwrap_or(([None; 6], 0.0))
    }

    fn check_unrotated(&self, code: Code) -> Result<(), GcodeFault> {
        match self.state.rotation {
            Rotation::Off => Ok(()),
            _ => Err(combination(code, "a plane is rotated", "end it with G69 before")),
        }
    }

    /// Executes the words for one block that use axis words.
    pub(super) fn one_shot(&mut self, block: &mut Block) -> Result<(), GcodeFault> {
        let Some(code) = block.code_of(Group::OneShot) else { return Ok(()) };
        match code.tenths {
            280 => return self.reference_return(block, "G28"),
            300 => return self.reference_return(block, "G30"),
            531 => return self.align(code),
            _ => {}
        }
        self.check_unrotated(code)?;
        match code.tenths {
            100 => self.set_origin(block, code),
            520 => self.set_local(block, code),
            920 => self.preset(block, code),
            923 => {
                let meaning = "a shift that another program may have left";
                let remedy = "write G92 with its axes";
                Err(not_read(code, meaning, remedy))
            }
            _ => self.end_preset(code),
        }
    }

    /// Executes `G10 L2 P`: sets the origin of a work offset.
    fn set_origin(&mut self, block: &mut Block, code: Code) -> Result<(), GcodeFault> {
        let dialect = self.stated(Rule::Dialect);
        let form =
            block.take_whole('L', 0, 999, "L2 or L20, which set the origin of a work offset")?;
        let offset = match (form, dialect) {
            (None, _) => return Err(missing(code, "L2")),
            (Some(2), _) => self.offset_of_number(block, code)?,
            (Some(20), Some(Choice::Rs274Ngc)) => return self.set_origin_here(block, code),
            // A further work offset (G54.1).
            (Some(20), Some(Choice::Iso)) => {
                let needed = "P with the number of the work offset";
                let number = block.take_whole('P', 1, 300, "a work offset from P1 to P300")?;
                WorkOffset::Additional(number.ok_or_else(|| missing(code, needed))? as u16)
            }
            (Some(20), _) => {
                let meaning = "the origin of a further work offset on Fanuc, and the present position on LinuxCNC";
                return Err(not_read("L20 of G10", meaning, "state the `dialect` of the control"));
            }
            (Some(form @ (1 | 10..=13)), _) => {
                let meaning = "a length or a radius of a tool, which the job states";
                let remedy = "remove the block, and state `length` and `radius_offset` of the tool";
                return Err(not_read(format!("L{form} of G10"), meaning, remedy));
            }
            (Some(form), _) => {
                let meaning = "a setting of the control";
                return Err(not_read(
                    format!("L{form} of G10"),
                    meaning,
                    "check the program without it",
                ));
            }
        };
        if self.modal.incremental {
            return Err(combination(code, "G91 is in force", "write G90 before"));
        }
        let turn = block.take('R');
        if turn.is_some() && self.stated(Rule::Dialect) != Some(Choice::Rs274Ngc) {
            let meaning = "a rotation of the work offset on LinuxCNC alone";
            let remedy = "write G68, or state `dialect = \"rs274ngc\"` of the control";
            return Err(not_read("R of G10", meaning, remedy));
        }
        let axes = self.take_axes(block);
        let is_turned = self.origins.get(&offset).is_some_and(|(_, rotation)| *rotation != 0.0);
        let is_shifted = self.state.shift != [Some(0.0); 6];
        if self.state.work_offset == offset && is_shifted && (turn.is_some() || is_turned) {
            let condition = "G52 or G92 is in force, and it rotates";
            let remedy = "end it before";
            return Err(combination(code, condition, remedy));
        }
        let is_known = self.origins.get(&offset).is_some_and(|(origin, _)| *origin != [None; 6]);
        // A program that sets G54 moves the part, and is refused on a machine.
        if turn.is_none()
            && !is_known
            && offset != WorkOffset::Standard(1)
            && matches!(self.stated(Rule::Dialect), None | Some(Choice::Rs274Ngc))
        {
            let needed = "R0, since LinuxCNC keeps a rotation of the work offset; or state its origin in `work_offsets`";
            return Err(missing(code, needed));
        }
        let (origin, rotation) = self.origins.entry(offset).or_insert(([None; 6], 0.0));
        for (coordinate, value) in origin.iter_mut().zip(axes) {
            *coordinate = value.or(*coordinate);
        }
        *rotation = turn.unwrap_or(*rotation);
        if self.state.work_offset == offset {
            self.activate(offset);
            if matches!(self.stated(Rule::Dialect), None | Some(Choice::Sinumerik)) {
                let needed = "its work offset (G54) after G10, since Sinumerik activates the new origin by that word";
                self.needs_offset = Some(needed);
            }
        }
        Ok(())
    }

    /// Takes P of G10 L2.
    fn offset_of_number(&self, block: &mut Block, code: Code) -> Result<WorkOffset, GcodeFault> {
        let expected = "a work offset from P1 (G54) to P9 (G59.3)";
        let number = block
            .take_whole('P', 0, 9, expected)?
            .ok_or_else(|| missing(code, "P with the number of the work offset"))?;
        match (number, self.stated(Rule::Dialect)) {
            (0, Some(Choice::Rs274Ngc)) => Ok(self.state.work_offset),
            (0, _) => {
                let meaning = "the external work offset on Fanuc, and the one in force on LinuxCNC";
                Err(not_read("P0 of G10", meaning, "write the number of the offset"))
            }
            (number, _) => Ok(WorkOffset::Standard(number as u8)),
        }
    }

    /// Executes `G10 L20 P` of LinuxCNC: the present position gets the given coordinates in a work offset.
    fn set_origin_here(&mut self, block: &mut Block, code: Code) -> Result<(), GcodeFault> {
        let offset = self.offset_of_number(block, code)?;
        let rotation = self.origin_of(offset).1;
        let is_plain = self.state.shift == [Some(0.0); 6]
            && self.state.origin_rotation == 0.0
            && rotation == 0.0
            && block.take('R').is_none();
        if !is_plain {
            let condition = "a shift is in force, or a work offset is rotated";
            return Err(combination("G10 L20", condition, "write G10 L2"));
        }
        let axes = self.take_axes(block);
        let (mut origin, _) = self.origin_of(offset);
        for axis in 0..AXES.len() {
            if let Some(value) = axes[axis] {
                let place = self.position[axis].zip(self.state.origin[axis]);
                origin[axis] = place.map(|(position, present)| position + present - value);
            }
        }
        self.origins.insert(offset, (origin, rotation));
        if self.state.work_offset == offset {
            self.activate(offset);
        }
        Ok(())
    }

    /// Executes G52.
    fn set_local(&mut self, block: &mut Block, code: Code) -> Result<(), GcodeFault> {
        if self.preset != [Some(0.0); 6] {
            return Err(combination(code, "G92 is in force", "end G92 with G92.1 before"));
        }
        if self.modal.incremental && self.stated(Rule::Dialect) != Some(Choice::Rs274Ngc) {
            return Err(combination(code, "G91 is in force", "write G90 before"));
        }
        let axes = self.take_axes(block);
        if axes.iter().all(Option::is_none) {
            return Err(missing(code, "an axis word"));
        }
        if matches!(self.stated(Rule::Dialect), None | Some(Choice::Sinumerik))
            && (0..6).any(|axis| axes[axis].is_none() && self.local[axis] != 0.0)
        {
            let remedy = "name them, too";
            return Err(combination(
                code,
                "it leaves axes out that an earlier one has shifted",
                remedy,
            ));
        }
        for (local, value) in self.local.iter_mut().zip(axes) {
            *local = value.unwrap_or(*local);
        }
        self.update_shift();
        Ok(())
    }

    /// Executes G92: the present position gets the given coordinates.
    fn preset(&mut self, block: &mut Block, code: Code) -> Result<(), GcodeFault> {
        self.check_local(code)?;
        if self.modal.incremental {
            return Err(combination(code, "G91 is in force", "write G90 before"));
        }
        self.check_preset(block)?;
        let axes = self.take_axes(block);
        if axes.iter().all(Option::is_none) {
            return Err(missing(code, "an axis word"));
        }
        let workpiece = self.state.to_workpiece(self.position);
        for axis in 0..AXES.len() {
            if let Some(value) = axes[axis] {
                self.preset[axis] = workpiece[axis].map(|coordinate| coordinate - value);
            }
        }
        self.update_shift();
        // The position is stated by the word, also where it was not known.
        for (coordinate, value) in self.position.iter_mut().zip(axes) {
            *coordinate = value.or(*coordinate);
        }
        Ok(())
    }

    /// Executes G92.1 and G92.2.
    fn end_preset(&mut self, code: Code) -> Result<(), GcodeFault> {
        self.check_local(code)?;
        if self.preset != [Some(0.0); 6] && self.choice(Rule::PresetEnd) == Choice::EndsPreset {
            self.preset = [Some(0.0); 6];
            self.update_shift();
        }
        Ok(())
    }

    fn check_local(&self, code: Code) -> Result<(), GcodeFault> {
        match self.local == [0.0; 6] {
            true => Ok(()),
            false => Err(combination(code, "G52 is in force", "end it with G52 X0 Y0 Z0 before")),
        }
    }

    fn update_shift(&mut self) {
        let shift = self.total_shift();
        self.change(|state| state.shift = shift);
    }

    /// Returns the sum of the shifts by G52, by G92 and by frames.
    pub(super) fn total_shift(&self) -> Position {
        let (mut shift, frame) = (self.preset, self.frames.shift());
        for (axis, shift) in shift.iter_mut().enumerate() {
            *shift = shift.map(|preset| preset + self.local[axis] + frame[axis]);
        }
        shift
    }

    /// Executes G68: a rotation about the normal of the plane, by R degrees about a centre.
    fn rotate(&mut self, block: &mut Block, code: Code) -> Result<(), GcodeFault> {
        self.check_unrotated(code)?;
        if self.state.tcp != Tcp::Off {
            return Err(combination(code, "tool centre point control is on", "write G68.2"));
        }
        if self.modal.incremental {
            return Err(combination(code, "G91 is in force", "write G90 before"));
        }
        let angle = block.take('R').ok_or_else(|| missing(code, "the angle R"))?;
        let mut centre = Vector3::zeros();
        for axis in self.modal.plane.axes() {
            let given = self.take_length(block, AXES[axis]);
            centre[axis] = given.or(self.position[axis]).ok_or_else(|| {
                missing(code, "both coordinates of the centre, since the position is not known")
            })?;
        }
        // p ↦ R (p − c) + c for the centre c.
        let rotation = about(self.modal.plane.normal(), angle);
        let frame = Frame { rotation, origin: centre - rotation * centre };
        self.change(|state| state.rotation = Rotation::Plane { frame });
        Ok(())
    }

    /// Executes G68.2: a tilted plane with an origin and the Euler angles I, J and K, in degrees, about z,
    /// the new x and the new z (Fanuc).
    fn tilt(&mut self, block: &mut Block, code: Code) -> Result<(), GcodeFault> {
        self.check_unrotated(code)?;
        if self.state.tcp == Tcp::Vector {
            return Err(combination(code, "G43.5 is in force", "end it with G49 before"));
        }
        if self.modal.incremental {
            return Err(combination(code, "G91 is in force", "write G90 before"));
        }
        block.take_whole('P', 0, 0, "P0, or no P: the angles are Euler's")?;
        let mut numbers = [0.0; 6];
        for (number, letter) in numbers.iter_mut().zip(['X', 'Y', 'Z', 'I', 'J', 'K']) {
            let needed = "X Y Z and the Euler angles I J K";
            *number = block.take(letter).ok_or_else(|| missing(code, needed))?;
        }
        let [x, y, z, i, j, k] = numbers;
        let origin = Vector3::new(x, y, z).map(|length| self.modal.millimetres(length));
        let rotation = about(2, i) * about(0, j) * about(2, k);
        let frame = Frame { rotation, origin };
        self.change(|state| state.rotation = Rotation::Tilted { frame, aligned: false });
        self.begin_plane();
        Ok(())
    }

    /// Executes G53.1: the rotary axes align the tool with z of the tilted plane.
    fn align(&mut self, code: Code) -> Result<(), GcodeFault> {
        let Rotation::Tilted { frame, .. } = self.state.rotation else {
            let needed = "a tilted plane (G68.2) in a block before";
            return Err(missing(code, needed));
        };
        if self.modal.cycle().is_some() {
            return Err(combination(code, "a canned cycle is in force", "write G80 before"));
        }
        if matches!(self.modal.motion, Some(Motion::Feed | Motion::Arc { .. })) {
            let condition = "a motion at feed rate is in force, at which Fanuc turns the axes";
            return Err(combination(code, condition, "write G0 before"));
        }
        let mut end = self.position;
        end[3..].fill(None);
        let commanded = [false, false, false, true, true, true];
        self.push(true, end, commanded, StepPath::Align);
        self.change(|state| state.rotation = Rotation::Tilted { frame, aligned: true });
        Ok(())
    }

    /// Refuses a position before the work offset that it depends on is selected.
    pub(super) fn check_offset(&mut self, block: &Block) -> Result<(), GcodeFault> {
        if !self.uses_offset(block) {
            return Ok(());
        }
        let mut needed = self.needs_offset;
        if self.transformation_changed
            && self.choice(Rule::TransformationOffset) == Choice::DeselectsOffset
        {
            needed = Some("a work offset (G54) before, since TRAORI and TRAFOOF deselect it");
        }
        if !self.offset_stated && self.choice(Rule::StartOffset) == Choice::NoOffset {
            needed
                .get_or_insert("a work offset (G54) before, since this control starts without one");
        }
        let Some(needed) = needed else { return Ok(()) };
        Err(missing("a position", needed))
    }

    /// Returns whether a block has a position that depends on the work offset.
    fn uses_offset(&self, block: &Block) -> bool {
        let is_absolute = !self.modal.incremental && block.has_any("XYZABC");
        let one_shot = block.tenths_of(Group::OneShot);
        let rotation = block.tenths_of(Group::Rotation);
        block.is_programmed()
            || matches!(one_shot, Some(520 | 531 | 920))
            || matches!(rotation, Some(680 | 682))
            || is_absolute && matches!(one_shot, Some(280 | 300))
    }
}
