//! The control, and its motions: lines, arcs, returns to reference positions, machine coordinates.

use super::Plane;
use super::arc::{self, ArcWords};
use super::block::Block;
use super::code::Group;
use super::cycle::Cycle;
use super::modal::{FeedMode, Modal, Motion};
use super::note::{Notes, Subject};
use super::refuse::is_multiple;
use super::rules::{Choice, ControlRules, Rule};
use super::spindle::{Spindle, SpindleWords};
use super::state::{ControlState, LengthOffset, Position, Rotation, Tcp, WorkOffset};
use super::{ControlSetup, GcodeFault, Step, StepPath};
use std::collections::{BTreeMap, VecDeque};
use std::sync::Arc;

/// Letters of the axes.
pub(super) const AXES: [char; 6] = ['X', 'Y', 'Z', 'A', 'B', 'C'];

/// Distance between the paths of controls on an arc with two radii, in mm, up to which it is rounding: of I and J with three
/// decimals, or four in inches.
const RADII_TOLERANCE: f64 = 5e-3;

/// Returns two coordinates of a position, if both are known.
fn in_plane(position: &Position, axes: [usize; 2]) -> Option<[f64; 2]> {
    Some([position[axes[0]]?, position[axes[1]]?])
}

/// A control: everything that blocks change and motions depend on.
#[derive(Clone, Debug)]
pub(super) struct Control {
    pub(super) line: usize,
    pub(super) modal: Modal,
    pub(super) state: Arc<ControlState>,
    /// Position in program coordinates.
    pub(super) position: Position,
    /// Origin and rotation of the work offsets.
    pub(super) origins: BTreeMap<WorkOffset, (Position, f64)>,
    pub(super) lengths: BTreeMap<u32, f64>,
    pub(super) home: Option<[f64; 6]>,
    second_home: Option<[f64; 6]>,
    /// Shift by G52.
    pub(super) local: [f64; 6],
    /// Shift by G92.
    pub(super) preset: Position,
    /// The tool that the next M6 changes to.
    pub(super) staged: Option<u32>,
    /// The last D.
    pub(super) edge: Option<u32>,
    /// Set if tool centre point control was switched on by M428 or `TRAORI`, which G43 and G49 do not end.
    pub(super) transformed: bool,
    pub(super) cycle: Option<Cycle>,
    /// The last tool vector of G43.5.
    pub(super) vector: Option<[f64; 3]>,
    pub(super) notes: Notes,
    rules: ControlRules,
    /// The rules that the program depends on, each with the first line.
    pub(super) asked: BTreeMap<Rule, usize>,
    pub(super) axes: [bool; 6],
    /// Position in which M6 leaves the axes, if the machine states it.
    pub(super) change_position: Option<Position>,
    /// Set once a work offset was selected.
    pub(super) offset_stated: bool,
    /// Set by a return to a reference position (`false`) or by G53 along Z (`true`) under a length offset, until the next word or
    /// motion to which the offset matters.
    pub(super) returned: Option<bool>,
    /// The last H.
    pub(super) last_register: Option<u32>,
    /// Set by a change of the length offset, until Z is stated.
    pub(super) length_changed: bool,
    /// Set by a change of a work offset or a shift for its axes, until each is stated.
    pub(super) origin_changed: [bool; 6],
    /// Set by G68 and G69, until a position in the plane is stated.
    pub(super) rotation_changed: bool,
    /// The reason for which a work offset has to be selected before a position.
    pub(super) needs_offset: Option<&'static str>,
    /// Set if tool centre point control has begun with turned axes, until a position is stated.
    pub(super) tcp_position_needed: bool,
    /// Set once the program has a length.
    pub(super) unit_used: bool,
    /// Set if the length offset is that of the tool in the spindle without a word.
    pub(super) length_implicit: bool,
    /// Set by G49, until the next tool change.
    pub(super) length_cancelled: bool,
    pub(super) spindle: SpindleWords,
    /// Steps that were not yet returned.
    pub(super) pending: VecDeque<Step>,
}

impl Control {
    pub(super) fn new(setup: &ControlSetup) -> Control {
        let offsets = (1..).map(WorkOffset::Standard).zip(setup.work_offsets);
        let known =
            |origin: Option<[f64; 6]>| (origin.map_or([None; 6], |origin| origin.map(Some)), 0.0);
        let origins: BTreeMap<_, _> =
            offsets.map(|(offset, origin)| (offset, known(origin))).collect();
        let state = ControlState {
            tool: None,
            length: LengthOffset::Off,
            work_offset: WorkOffset::Standard(1),
            origin: origins.get(&WorkOffset::Standard(1)).map_or([None; 6], |(origin, _)| *origin),
            origin_rotation: 0.0,
            shift: [Some(0.0); 6],
            tcp: Tcp::Off,
            tcp_starts: 0,
            rotation: Rotation::Off,
        };
        Control {
            line: 0,
            modal: Modal::new(),
            state: Arc::new(state),
            position: setup.start,
            origins,
            lengths: setup.lengths.clone(),
            home: setup.home,
            second_home: setup.second_home,
            local: [0.0; 6],
            preset: [Some(0.0); 6],
            staged: None,
            edge: None,
            transformed: false,
            cycle: None,
            vector: None,
            notes: Notes::default(),
            rules: setup.rules.clone(),
            asked: BTreeMap::new(),
            axes: setup.axes,
            change_position: setup.tool_change,
            offset_stated: false,
            returned: None,
            last_register: None,
            length_changed: false,
            origin_changed: [false; 6],
            rotation_changed: false,
            needs_offset: None,
            tcp_position_needed: false,
            unit_used: false,
            length_implicit: false,
            length_cancelled: false,
            spindle: SpindleWords::new(),
            pending: VecDeque::new(),
        }
    }

    /// States the dialect of a program with the head of Heidenhain, which no other control reads, if no other is stated.
    pub(super) fn read_heidenhain(&mut self) {
        if self.stated(Rule::Dialect).is_none() {
            self.state_rule(Rule::Dialect, Choice::Heidenhain);
        }
    }

    /// States what the control does under a rule.
    pub(super) fn state_rule(&mut self, rule: Rule, choice: Choice) {
        self.rules = std::mem::take(&mut self.rules).with(rule, choice);
    }

    /// Returns what the control does under a rule, if that is stated.
    pub(super) fn stated(&self, rule: Rule) -> Option<Choice> {
        self.rules.get(rule)
    }

    /// Returns what the control does under a rule, and notes that the program depends on it.
    pub(super) fn choice(&mut self, rule: Rule) -> Choice {
        self.asked.entry(rule).or_insert(self.line);
        let first = || rule.choices().next().expect("a rule has choices");
        self.rules.get(rule).unwrap_or_else(first)
    }

    /// Reads the motion mode.
    pub(super) fn motion_mode(&mut self, block: &Block) {
        if block.code_of(Group::CycleOff).is_some() {
            self.modal.motion = None;
        }
        if let Some(code) = block.code_of(Group::Motion) {
            self.modal.motion = Some(match code.tenths {
                0 => Motion::Rapid,
                10 => Motion::Feed,
                20 => Motion::Arc { clockwise: true },
                30 => Motion::Arc { clockwise: false },
                tenths => Motion::Cycle(tenths / 10),
            });
        }
        if !matches!(self.modal.motion, Some(Motion::Cycle(_))) {
            self.cycle = None;
        }
        let is_tapping = matches!(self.modal.motion, Some(Motion::Cycle(74 | 84)));
        let has_motion =
            [Group::CycleOff, Group::Motion].map(|group| block.code_of(group).is_some());
        if has_motion.contains(&true) && !is_tapping {
            self.spindle.end_rigid();
        }
    }

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
        let has_vector = self.state.tcp == Tcp::Vector && block.has_any("IJK");
        let has_axes = block.has_any("XYZABC") || has_vector;
        match self.modal.motion {
            Some(Motion::Arc { clockwise }) if has_axes || explicit && block.has_any("IJKR") => {
                self.arc(block, clockwise)
            }
            Some(Motion::Cycle(number)) if has_axes => self.canned_cycle(block, number),
            Some(Motion::Rapid | Motion::Feed) if has_axes => self.straight(block),
            None if has_axes => Err(GcodeFault::NoMotionMode),
            Some(Motion::Cycle(number)) if explicit => {
                let word = format!("G{number}");
                Err(GcodeFault::Missing { word, needed: "X, Y or Z" })
            }
            _ => Ok(()),
        }
    }

    /// Takes the axis words of a block, in millimetres and degrees.
    pub(super) fn take_axes(&self, block: &mut Block) -> Position {
        let mut axes = AXES.map(|letter| block.take(letter));
        for value in &mut axes[..3] {
            *value = value.map(|value| self.modal.millimetres(value));
        }
        axes
    }

    /// Takes the axis words of a block as the end of a motion, with the axes that they name and those that they command.
    /// An increment of 0 commands nothing.
    fn take_end(&self, block: &mut Block) -> (Position, [bool; 6], [bool; 6]) {
        let axes = self.take_axes(block);
        let mut end = self.position;
        for (coordinate, value) in end.iter_mut().zip(axes) {
            if let Some(value) = value {
                let origin = if self.modal.incremental { *coordinate } else { Some(0.0) };
                *coordinate = origin.map(|origin| origin + value);
            }
        }
        let incremental = self.modal.incremental;
        let commanded = axes.map(|value| value.is_some_and(|value| !incremental || value != 0.0));
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
        let (mut end, _, mut commanded) = self.take_end(block);
        if turns {
            end[3..].fill(None);
            commanded[3..].fill(true);
        }
        self.push(rapid, end, commanded, StepPath::Line);
        Ok(())
    }

    /// Takes the tool vector under G43.5, and returns whether the block has one.
    fn take_vector(&mut self, block: &mut Block) -> Result<bool, GcodeFault> {
        if self.state.tcp != Tcp::Vector {
            return Ok(false);
        }
        let given = AXES[3..].iter().find(|letter| block.has(**letter));
        if let Some(letter) = given {
            return Err(GcodeFault::Combination {
                word: letter.to_string(),
                condition: "G43.5 is in force",
                remedy: "write the tool vector I J K, or select G43.4",
            });
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

    fn arc(&mut self, block: &mut Block, clockwise: bool) -> Result<(), GcodeFault> {
        let word = if clockwise { "G2" } else { "G3" };
        if self.state.tcp == Tcp::Vector {
            return Err(GcodeFault::Combination {
                word: word.to_owned(),
                condition: "G43.5 gives I J K another meaning",
                remedy: "post the arc as lines, or select G43.4",
            });
        }
        self.check_feed(word)?;
        self.check_tilted(block)?;
        let modal = self.modal;
        let length = |value: f64| modal.millimetres(value);
        let in_plane = self.modal.plane.axes().map(|axis| ['I', 'J', 'K'][axis]);
        if self.stated(Rule::Dialect) == Some(Choice::Heidenhain)
            && block.has(in_plane[0]) != block.has(in_plane[1])
        {
            return Err(GcodeFault::Combination {
                word: word.to_owned(),
                condition: "one coordinate of its pole is left out, which keeps it on Heidenhain",
                remedy: "write both",
            });
        }
        let words = ArcWords {
            clockwise,
            plane: self.modal.plane,
            offsets: ['I', 'J', 'K'].map(|letter| block.take(letter).map(length)),
            absolute: match self.modal.absolute_centres {
                Some(absolute) => absolute,
                None => self.choice(Rule::Dialect) == Choice::Heidenhain && !self.modal.incremental,
            },
            radius: block.take('R').map(length),
            turns: self.turns(block)?,
            unit: self.modal.unit,
        };
        self.check_position(block)?;
        let (end, _, commanded) = self.take_end(block);
        let path = arc::path(&words, self.position, end)?;
        self.check_radii(&path, &end)?;
        if let Some(radius) = words.radius
            && self.stated(Rule::Dialect) != Some(Choice::Rs274Ngc)
        {
            self.check_radius_digits(radius, &end);
        }
        self.push(false, end, commanded, path);
        Ok(())
    }

    /// Takes the number of turns of an arc.
    fn turns(&self, block: &mut Block) -> Result<u32, GcodeFault> {
        let turns = block.take_whole('P', 1, 1_000_000, "a number of turns from 1 after P")?;
        if turns.is_some_and(|turns| turns > 1)
            && self.stated(Rule::Dialect) != Some(Choice::Rs274Ngc)
        {
            let meaning = "a number of turns on LinuxCNC alone";
            let remedy = "write an arc per turn, or state `dialect = \"rs274ngc\"` of the control";
            return Err(GcodeFault::NotRead { word: "P of an arc".to_owned(), meaning, remedy });
        }
        Ok(turns.unwrap_or(1))
    }

    /// Refuses an arc that is a full circle where coordinates are rounded, and notes one that is no circle.
    fn check_radii(&mut self, path: &StepPath, end: &Position) -> Result<(), GcodeFault> {
        let StepPath::Arc { plane, centre, .. } = path else { return Ok(()) };
        let [first, second] = plane.axes();
        let (Some([x, y]), Some([u, v])) =
            (in_plane(&self.position, [first, second]), in_plane(end, [first, second]))
        else {
            return Ok(());
        };
        let chord = (u - x).hypot(v - y);
        let [across, along] = [(u - x).abs(), (v - y).abs()];
        if chord > 0.0 && across.max(along) < 2.0 * self.modal.millimetres(self.modal.increment()) {
            return Err(GcodeFault::Combination {
                word: "an arc".to_owned(),
                condition: "its end is less than two increments from its start, and can be the same where coordinates are rounded",
                remedy: "leave the end out for a full circle, or leave out the arc",
            });
        }
        // A control that moves the centre across the chord turns the arc about its start by the difference over the chord.
        let [from, to] = [[x, y], [u, v]].map(|[x, y]| (x - centre[0]).hypot(y - centre[1]));
        let turn = if chord > 0.0 { from.max(to) / chord } else { 0.0 };
        if (from - to).abs() * turn.max(1.0) > RADII_TOLERANCE {
            self.notes.add(self.line, Subject::TwoRadii);
        }
        Ok(())
    }

    /// Notes an arc by its radius whose path depends on digits below the least increment: one near a half circle, or near a full one.
    /// A radius below 0 is that of an arc of more than a half circle.
    fn check_radius_digits(&mut self, radius: f64, end: &Position) {
        let axes = self.modal.plane.axes();
        let (Some([x, y]), Some([u, v])) = (in_plane(&self.position, axes), in_plane(end, axes))
        else {
            return;
        };
        let increment = self.modal.millimetres(self.modal.increment());
        let is_whole = |value: f64| is_multiple(value, increment);
        if [x, y, u, v, radius].into_iter().all(is_whole) {
            return;
        }
        let is_major = radius < 0.0;
        // If every number changes by an increment, the chord changes by √8 increments, and its middle stays within one of them.
        let chord = (u - x).hypot(v - y);
        let sagitta = |change: f64| {
            let (radius, half) = (radius.abs() + change, 0.5 * chord - f64::sqrt(2.0) * change);
            let height = (radius * radius - half * half).max(0.0).sqrt();
            if is_major { radius + height } else { radius - height }
        };
        let farthest = if is_major { 2.0 * radius.abs() } else { chord };
        let turn = farthest / chord.max(increment) * f64::sqrt(8.0) * increment;
        if (sagitta(increment) - sagitta(-increment)).abs() + turn
            > RADII_TOLERANCE.max(8.0 * increment)
        {
            self.notes.add(self.line, Subject::RoundedRadius);
        }
    }

    /// Returns the remedy that ends tool centre point control.
    pub(super) fn tcp_remedy(&self) -> &'static str {
        match self.transformed {
            true => "end it with M429 or TRAFOOF before",
            false => "end it with G49 before",
        }
    }

    /// Checks that there is a feed rate.
    pub(super) fn check_feed(&self, word: &str) -> Result<(), GcodeFault> {
        let inverse = self.modal.feed_mode == FeedMode::InverseTime;
        match self.modal.feed {
            Some(_) => Ok(()),
            None => Err(GcodeFault::NoFeed { word: word.to_owned(), inverse }),
        }
    }

    /// Executes G53.
    fn machine_coordinates(&mut self, block: &mut Block) -> Result<(), GcodeFault> {
        let refused = |condition, remedy| {
            Err(GcodeFault::Combination { word: "G53".to_owned(), condition, remedy })
        };
        if self.modal.incremental {
            return refused("G91 is in force", "write G90 before");
        }
        if self.state.tcp != Tcp::Off {
            return refused("tool centre point control is on", self.tcp_remedy());
        }
        if matches!(self.state.rotation, Rotation::Plane { .. }) {
            return refused("a plane is rotated", "end it with G69 before");
        }
        match self.modal.motion {
            None if self.stated(Rule::Dialect) == Some(Choice::Rs274Ngc) => {
                return Err(GcodeFault::NoMotionMode);
            }
            None | Some(Motion::Rapid) => {}
            // Positioned in rapid traverse on Fanuc, at feed rate elsewhere.
            Some(Motion::Feed) => return refused("G1 is in force", "write G0 in the block"),
            _ => return refused("an arc or a canned cycle is in force", "write G0 in the block"),
        }
        let axes = self.take_axes(block);
        if axes.iter().all(Option::is_none) {
            return Err(GcodeFault::Missing { word: "G53".to_owned(), needed: "an axis word" });
        }
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
        // Home of Z is the top of its travel; from there on the other axes are free.
        let is_homeward = axes[2].map_or(self.position[2].is_none(), |z| z == 0.0);
        self.move_machine(axes.map(|value| value.is_some()), target, StepPath::Line);
        self.pending.back_mut().expect("the step that was added").is_homeward = is_homeward;
        if axes[2].is_some() && self.state.length != LengthOffset::Off {
            self.returned = self.returned.or(Some(true));
        }
        Ok(())
    }

    /// Executes G28 or G30: to the intermediate position, then to the reference position.
    pub(super) fn reference_return(
        &mut self,
        block: &mut Block,
        word: &str,
    ) -> Result<(), GcodeFault> {
        let refused = |condition, remedy| {
            Err(GcodeFault::Combination { word: word.to_owned(), condition, remedy })
        };
        if self.state.tcp != Tcp::Off {
            return refused("tool centre point control is on", self.tcp_remedy());
        }
        if matches!(self.modal.motion, Some(Motion::Cycle(_))) {
            return refused("a canned cycle is in force", "write G80 before");
        }
        if matches!(self.state.rotation, Rotation::Plane { .. }) {
            return refused("a plane is rotated", "end it with G69 before");
        }
        if word == "G30" {
            block.take_whole('P', 2, 2, "P2, or no P")?;
        }
        self.check_tilted(block)?;
        self.check_shifted(block)?;
        let (end, mut named, commanded) = self.take_end(block);
        if named.contains(&true) {
            self.push(true, end, commanded, StepPath::Line);
        } else if self.stated(Rule::Dialect) == Some(Choice::Rs274Ngc) {
            named = self.axes;
        } else {
            // All axes on LinuxCNC and Haas, none on Fanuc.
            let needed = "the axes that return";
            return Err(GcodeFault::Missing { word: word.to_owned(), needed });
        }
        if self.state.origin_rotation != 0.0 && named[0] != named[1] {
            return refused("the work offset is rotated", "name X and Y, or neither");
        }
        let home = if word == "G28" { self.home } else { self.second_home };
        let target = home.map_or([None; 6], |home| home.map(Some));
        self.move_machine(named, target, StepPath::Line);
        let step = self.pending.back_mut().expect("the step that was added");
        (step.is_return, step.is_homeward) = (true, true);
        self.returned = (self.state.length != LengthOffset::Off).then_some(false);
        Ok(())
    }

    /// Moves axes to machine coordinates in rapid traverse. An unknown coordinate leads where only the machine knows.
    pub(super) fn move_machine(
        &mut self,
        mut commanded: [bool; 6],
        target: Position,
        path: StepPath,
    ) {
        let mut machine = self.state.to_machine(self.position);
        for axis in 0..6 {
            if commanded[axis] {
                machine[axis] = target[axis];
            }
        }
        let mut end = self.state.from_machine(machine);
        // A rotation makes program axes depend on several machine axes.
        let is_coupled = match (self.state.rotation, self.state.origin_rotation == 0.0) {
            (Rotation::Off, true) => [false; 6],
            (Rotation::Off, false) => [true, true, false, false, false, false],
            _ => [true, true, true, false, false, false],
        };
        let moves_coupled = (0..6).any(|axis| commanded[axis] && is_coupled[axis]);
        for axis in 0..6 {
            if is_coupled[axis] && moves_coupled {
                commanded[axis] = true;
            } else if !commanded[axis] {
                end[axis] = self.position[axis];
            }
        }
        self.push(true, end, commanded, path);
        // Machine coordinates are stated in G91, too.
        self.pending.back_mut().expect("the step that was added").absolute = true;
    }

    /// Adds a step from the present position, and moves there.
    pub(super) fn push(
        &mut self,
        rapid: bool,
        end: Position,
        commanded: [bool; 6],
        path: StepPath,
    ) {
        if !self.modal.exact_path && !matches!(path, StepPath::ToolChange(_)) {
            self.notes.add_once(self.line, Subject::RoundedCorners);
        }
        let start = std::mem::replace(&mut self.position, end);
        let spindle = match self.modal.motion {
            Some(Motion::Cycle(74 | 84)) => Spindle::Tapping,
            _ => self.spindle(rapid),
        };
        let state = Arc::clone(&self.state);
        let (line, tool_vector) = (self.line, self.vector);
        self.pending.push_back(Step {
            line,
            rapid,
            start,
            end,
            commanded,
            path,
            tool_vector,
            spindle,
            absolute: !self.modal.incremental,
            is_homeward: false,
            is_return: false,
            state,
        });
    }

    /// Selects a plane.
    pub(super) fn select(&mut self, plane: Plane) -> Result<(), GcodeFault> {
        if plane != self.modal.plane {
            let is_rotated = matches!(self.state.rotation, Rotation::Plane { .. });
            if is_rotated || self.cycle.is_some() {
                return Err(GcodeFault::Combination {
                    word: "another plane".to_owned(),
                    condition: "a rotation (G68) or a canned cycle is in force",
                    remedy: "end it with G69 or G80 before",
                });
            }
        }
        self.modal.plane = plane;
        Ok(())
    }
}
