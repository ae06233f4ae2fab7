//! The control: everything that blocks change and motions depend on, and the order in which it executes the words of a block.

mod compensation;
mod coordinates;
mod corner;
mod cycle;
mod end;
mod figure;
mod frame;
mod heidenhain;
mod hole;
mod linuxcnc;
mod modal;
mod motion;
mod offset;
mod refuse;
mod report;
mod spindle;

pub(super) use corner::{Corner, CornerShape, WRITE_OUT};
pub(super) use modal::StatedModes;
pub(crate) use refuse::band_radii;
pub(super) use report::Report;
pub use spindle::Spindle;
pub(super) use spindle::{TapTurn, Thread};

pub(super) use heidenhain::{Circle, Curve};

use super::block::{Block, Group};
use super::error::combination;
use super::note::{NoteKind, Notes};
use super::rules::{Choice, ControlRules, Rule};
use super::state::{ControlState, LengthOffset, Position, RotaryAxes, Rotation, Tcp, WorkOffset};
use super::{BlockLine, ControlSetup, GcodeFault, Plane, Step, StepPath, SubprogramLine};
use compensation::Compensation;
use modal::{FeedMode, Modal, Motion};
use spindle::SpindleWords;
use std::collections::{BTreeMap, VecDeque};
use std::sync::Arc;
use touchoff::Unit;

pub(super) use frame::{FrameStep, Retract, Swivel};
pub(super) use hole::{Hole, Tapping};

/// Letters of the axes.
const AXES: [char; 6] = ['X', 'Y', 'Z', 'A', 'B', 'C'];

/// A control: everything that blocks change and motions depend on.
#[derive(Clone, Debug)]
pub(super) struct Control {
    /// The line of the program.
    pub(super) line: usize,
    /// The line of the file of subprograms that it has called.
    pub(super) within: Option<SubprogramLine>,
    pub(super) modal: Modal,
    state: Arc<ControlState>,
    /// Position in program coordinates.
    position: Position,
    /// Origin and rotation of the work offsets.
    origins: BTreeMap<WorkOffset, (Position, f64)>,
    /// These are shared, since a survey keeps the control before each block.
    lengths: Arc<BTreeMap<u32, f64>>,
    radius_offsets: Arc<BTreeMap<u32, f64>>,
    /// The numbers of work offsets, by those of presets (Heidenhain).
    presets: Arc<BTreeMap<u32, u8>>,
    /// The sum that a program of Heidenhain adds to the radius offset of its tool.
    radius_allowance: f64,
    tool_names: Arc<BTreeMap<String, u32>>,
    home: Position,
    second_home: Option<[f64; 6]>,
    /// Upper end of the travel of Z.
    top: Option<f64>,
    /// The point from which M92 counts, in machine coordinates.
    builder_point: Option<[f64; 6]>,
    /// Shift by G52.
    local: [f64; 6],
    /// Shift by G92.
    preset: Position,
    /// The frames of Sinumerik.
    frames: frame::Frames,
    /// The tool that the next M6 changes to.
    staged: Option<u32>,
    /// The last D.
    edge: Option<u32>,
    /// The D between a T and its M6, on Sinumerik.
    staged_edge: Option<u32>,
    /// Set by a change after D0 between T and M6, until the next D.
    needs_edge: bool,
    /// Set if tool centre point control was switched on by M428 or `TRAORI`, which G43 and G49 do not end.
    transformed: bool,
    cycle: Option<Cycle>,
    /// Cutter radius compensation.
    compensation: Option<Compensation>,
    /// The line or arc whose corner is not known yet (`,R`, `,C`, RND).
    held_motion: Option<corner::HeldMotion>,
    /// Polar coordinates (G16).
    polar: Option<figure::Polar>,
    /// The mirror image (G51.1).
    mirror: figure::Mirror,
    /// The last tool vector of G43.5.
    vector: Option<[f64; 3]>,
    pub(super) notes: Notes,
    pub(super) rules: ControlRules,
    /// Choices that the language of the program settles, whatever the rules state.
    settled: ControlRules,
    /// The rules that the program depends on, each with the first line.
    pub(super) asked: BTreeMap<Rule, BlockLine>,
    axes: [bool; 6],
    rotary_axes: RotaryAxes,
    /// Position in which M6 leaves the axes, if the machine states it.
    change_position: Option<Position>,
    /// Set once a work offset was selected.
    offset_stated: bool,
    /// A return that can have cancelled the length offset, until the next word or motion to which the offset matters.
    returned: Option<Returned>,
    /// The last H.
    last_register: Option<u32>,
    /// Set by a change of the length offset, until Z is stated.
    length_changed: bool,
    /// The coordinate Z before that change.
    height_before: Option<f64>,
    /// Set by a change of a work offset or a shift for its axes, until each is stated.
    origin_changed: [bool; 6],
    /// Set by G68 and G69, until a position in the plane is stated.
    rotation_changed: bool,
    /// The block that has defined a cycle, until it is called.
    uncalled: Option<BlockLine>,
    /// The reason for which a work offset has to be selected before a position.
    needs_offset: Option<&'static str>,
    /// Set by TRAORI and TRAFOOF, until a work offset is selected.
    transformation_changed: bool,
    /// Set if tool centre point control has begun with turned axes, until a position is stated.
    tcp_position_needed: bool,
    /// Set once the program has a length.
    unit_used: bool,
    /// Set if the length offset is that of the tool in the spindle without a word.
    length_implicit: bool,
    /// Set by G49, until the next tool change.
    length_cancelled: bool,
    spindle: SpindleWords,
    /// The modes that the program states, or does not need to.
    pub(super) stated: StatedModes,
    /// Set to return a step per new tool in the spindle.
    pub(super) has_loads: bool,
    /// Steps that were not yet returned.
    pub(super) pending: VecDeque<Step>,
}

/// A return under a length offset.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Returned {
    /// A return of Z to a reference position, with other axes or alone.
    Height,
    /// A return of other axes alone.
    OtherAxes,
    /// A motion of Z by G53.
    MachineHeight,
}

/// Words that stay in force from one cycle to the next, lengths in millimetres as given.
#[derive(Clone, Debug, PartialEq)]
struct Cycle {
    number: u32,
    retract: f64,
    depth: f64,
    peck: Option<f64>,
    /// Distance mode under which retract and depth were given.
    incremental: bool,
    /// Level at the start of the series.
    initial: Option<f64>,
    unit: Unit,
    state: Arc<ControlState>,
}

impl Control {
    pub(super) fn new(setup: &ControlSetup) -> Control {
        let offsets = (1..).map(WorkOffset::Standard).zip(setup.work_offsets);
        let known =
            |origin: Option<[f64; 6]>| (origin.map_or([None; 6], |origin| origin.map(Some)), 0.0);
        let mut origins: BTreeMap<_, _> =
            offsets.map(|(offset, origin)| (offset, known(origin))).collect();
        origins.extend(
            setup
                .additional_offsets
                .iter()
                .map(|(number, origin)| (WorkOffset::Additional(*number), known(Some(*origin)))),
        );
        origins.insert(WorkOffset::Off, known(Some([0.0; 6])));
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
            plane_starts: 0,
            orientation: None,
            shorter_way: false,
        };
        Control {
            line: 0,
            within: None,
            modal: Modal::new(),
            state: Arc::new(state),
            position: setup.start,
            origins,
            lengths: Arc::new(setup.lengths.clone()),
            radius_offsets: Arc::new(setup.radius_offsets.clone()),
            presets: Arc::new(setup.presets.clone()),
            radius_allowance: 0.0,
            tool_names: Arc::new(setup.tool_names.clone()),
            home: setup.home,
            second_home: setup.second_home,
            top: setup.top,
            builder_point: setup.builder_point,
            local: [0.0; 6],
            preset: [Some(0.0); 6],
            frames: frame::Frames::new(),
            staged: None,
            edge: None,
            staged_edge: None,
            needs_edge: false,
            transformed: false,
            cycle: None,
            compensation: None,
            held_motion: None,
            polar: None,
            mirror: [None; 3],
            vector: None,
            notes: Notes::default(),
            rules: setup.rules.clone(),
            settled: ControlRules::default(),
            asked: BTreeMap::new(),
            axes: setup.axes,
            rotary_axes: RotaryAxes {
                carries_tool: setup.carries_tool,
                tilts: setup.tilts,
                part: setup.work_offsets[0].map_or([None; 6], |origin| origin.map(Some)),
            },
            change_position: setup.tool_change,
            offset_stated: false,
            returned: None,
            last_register: None,
            length_changed: false,
            height_before: None,
            origin_changed: [false; 6],
            rotation_changed: false,
            uncalled: None,
            needs_offset: None,
            transformation_changed: false,
            tcp_position_needed: false,
            unit_used: false,
            length_implicit: false,
            length_cancelled: false,
            spindle: SpindleWords::new(),
            stated: StatedModes::default(),
            has_loads: false,
            pending: VecDeque::new(),
        }
    }

    /// States what the control does under a rule.
    pub(super) fn state_rule(&mut self, rule: Rule, choice: Choice) {
        self.rules = std::mem::take(&mut self.rules).with(rule, choice);
    }

    /// States what the language of the program settles on every control.
    pub(super) fn settle(&mut self, rules: &[(Rule, Choice)]) {
        for (rule, choice) in rules {
            self.settled = std::mem::take(&mut self.settled).with(*rule, *choice);
        }
    }

    /// Returns what the control does under a rule, if that is stated.
    pub(super) fn stated(&self, rule: Rule) -> Option<Choice> {
        self.settled.get(rule).or_else(|| self.rules.get(rule))
    }

    /// Returns what the control does under a rule, and notes that the program depends on it.
    pub(super) fn choice(&mut self, rule: Rule) -> Choice {
        if let Some(choice) = self.settled.get(rule) {
            return choice;
        }
        let block = self.block();
        self.asked.entry(rule).or_insert(block);
        self.rules.get(rule).unwrap_or_else(|| rule.choices().next().expect("a rule has choices"))
    }

    /// Returns whether a canned cycle is in force.
    pub(super) fn is_in_cycle(&self) -> bool {
        self.modal.cycle().is_some()
    }

    /// Returns whether the setup ignores a word.
    pub(super) fn ignores(&self, word: &str) -> bool {
        !self.rules.ignored().is_empty() && self.rules.ignored().contains_key(word)
    }

    /// Notes a word that the setup ignores.
    pub(super) fn ignore(&mut self, word: String) {
        let reason = self.rules.ignored().get(&word).cloned().unwrap_or_default();
        self.notes.add(self.block(), NoteKind::Ignored { word, reason });
    }

    /// Returns the number of the tool with a name.
    pub(super) fn tool_number(&self, name: &str) -> Option<u32> {
        self.tool_named(name).or_else(|| name.parse().ok())
    }

    /// Returns the number of the tool with a name that the job states.
    pub(super) fn tool_named(&self, name: &str) -> Option<u32> {
        let known = self.tool_names.iter().find(|(known, _)| known.eq_ignore_ascii_case(name));
        known.map(|(_, number)| *number)
    }

    /// Returns the place of the block that is executed.
    pub(super) fn block(&self) -> BlockLine {
        BlockLine { line: self.line, within: self.within }
    }

    /// Sets the line of the block that is executed next; `file` is that of a called subprogram in another file. The line of the program is that
    /// of the call then.
    pub(super) fn set_line(&mut self, file: Option<usize>, line: usize) {
        self.within = file.map(|file| SubprogramLine { file, line });
        if file.is_none() {
            self.line = line;
        }
    }

    /// Executes a block, in the order of RS274/NGC, table 8.
    pub(super) fn execute(&mut self, block: &mut Block) -> Result<(), GcodeFault> {
        let (known, register) = (self.pending.len(), block.value('D'));
        self.note_words(block);
        self.check_dialect(block)?;
        self.check_words(block)?;
        self.feed(block)?;
        self.tool(block)?;
        // S beside G4 is a time on Sinumerik, so it is refused before it is read as a speed.
        self.dwell(block)?;
        let turned = self.spindle_words(block);
        self.motion_mode(block);
        // The spindle changes before such a motion or after it, by the control.
        if let Some(word) = turned.filter(|_| block.is_programmed() && self.modal.is_feed()) {
            let condition = "a motion at feed rate is in its block";
            let remedy = "write it in a block before or after";
            return Err(combination(word, condition, remedy));
        }
        // The unit and the distance mode hold for the numbers of their own block.
        self.settings(block)?;
        self.numbers(block);
        self.figure_words(block)?;
        self.map_coordinates(block)?;
        self.compensation_words(block, register)?;
        // A centre that is not stated is the position, which depends on it.
        if block.code_of(Group::Rotation).is_some() && block.code_of(Group::Length).is_none() {
            self.returned_length(block);
        }
        self.coordinates(block)?;
        self.returned_length(block);
        if self.depends_on_length(block) {
            self.length_without_word();
        }
        if self.modal.plane != Plane::Xy
            && (block.is_programmed() || block.code_of(Group::Machine).is_some())
            && (self.length_implicit || self.state.tcp == Tcp::Transformation)
        {
            let condition = "G18 or G19 is in force and the length of the tool counts without G43, across the plane";
            let remedy = "post the program in G17";
            return Err(combination("a position", condition, remedy));
        }
        self.check_offset(block)?;
        self.check_staged_edge(block)?;
        self.note_assumed(block);
        self.motion(block)?;
        self.corners(block.corner.take(), known)?;
        self.compensate(known)?;
        match block.tenths_of(Group::Stop) {
            Some(20 | 300) => self.end_compensation(),
            _ => Ok(()),
        }
    }

    /// Takes the word with the time of G4: P, or X in ISO programs, or F, which is no feed rate then.
    fn dwell(&mut self, block: &mut Block) -> Result<(), GcodeFault> {
        if block.code_of(Group::Dwell).is_none() {
            return Ok(());
        }
        if block.has('S') {
            let condition = "its block has G4, of which it is the time in turns of the spindle";
            let remedy = "write it in a block before";
            return Err(combination("S", condition, remedy));
        }
        // Native programs of Sinumerik and of Heidenhain have the time in F.
        let dialect = self.stated(Rule::Dialect);
        let has_time_in_x = !matches!(dialect, Some(Choice::Sinumerik | Choice::Heidenhain));
        block.take('F');
        if block.take('P').is_none() && block.code_of(Group::Motion).is_none() && has_time_in_x {
            block.take('X');
        }
        Ok(())
    }

    /// Gives the numbers of a block the unit that the control gives them.
    fn numbers(&mut self, block: &mut Block) {
        // Zeros are the same in every unit.
        let has_length = block.is_nonzero("XYZIJKRQ");
        self.unit_of_lengths(has_length);
        if block.has_whole() && self.choice(Rule::WholeNumbers) == Choice::Increments {
            let (length, motion) = (self.modal.increment(), self.modal.motion);
            // G15 and G16 hold for their own block.
            let is_polar = match block.tenths_of(Group::Polar) {
                Some(tenths) => tenths == 160,
                None => self.polar.is_some(),
            };
            let has_polar_angle = is_polar && !block.owns_axis_words();
            let angles = match block.tenths_of(Group::Rotation) {
                Some(680) => "R",
                Some(682) => "IJKR",
                _ => "",
            };
            // The rule is asked only where it matters: each that is not stated doubles the readings.
            let has_whole_radius = block.is_whole('R') || block.is_whole('Q');
            let keeps_radii = has_whole_radius && self.choice(Rule::WholeRadii) == Choice::Units;
            block.scale_whole(|letter| match letter {
                'R' | 'Q' if keeps_radii => 1.0,
                // The least increment of an angle, whatever the unit.
                'A' | 'B' | 'C' => 1e-3,
                'Y' if has_polar_angle => 1e-3,
                letter if angles.contains(letter) => 1e-3,
                // The number of repeats of a cycle.
                'K' if matches!(motion, Some(Motion::Cycle(_))) => 1.0,
                _ => length,
            });
        }
    }

    /// Gives lengths the unit that the control gives them before the program states one.
    fn unit_of_lengths(&mut self, has_length: bool) {
        self.unit_used |= has_length;
        if !self.modal.unit_stated && has_length {
            self.modal.unit = match self.choice(Rule::Unit) {
                Choice::Inch => Unit::Inch,
                _ => Unit::Millimetre,
            };
        }
    }

    /// Notes the words that are passed over.
    fn note_words(&mut self, block: &Block) {
        for code in &block.passed_over {
            self.notes.add(self.block(), NoteKind::PassedOver { word: code.to_string() });
        }
        if block.has('S') {
            self.notes.add(self.block(), NoteKind::PassedOver { word: "S".to_owned() });
        }
    }

    /// Takes the axis words of a block, in millimetres and degrees.
    fn take_axes(&self, block: &mut Block) -> Position {
        let mut axes = AXES.map(|letter| block.take(letter));
        for value in &mut axes[..3] {
            *value = value.map(|value| self.modal.millimetres(value));
        }
        axes
    }

    /// Takes the number after a letter, a length in millimetres.
    fn take_length(&self, block: &mut Block, letter: char) -> Option<f64> {
        block.take(letter).map(|length| self.modal.millimetres(length))
    }

    /// Returns the remedy that ends tool centre point control.
    fn tcp_remedy(&self) -> &'static str {
        match self.transformed {
            true => "end it with M429 or TRAFOOF before",
            false => "end it with G49 before",
        }
    }

    /// Adds a step from the present position, and moves there.
    fn push(&mut self, rapid: bool, end: Position, commanded: [bool; 6], path: StepPath) {
        if !self.modal.exact_path && !matches!(path, StepPath::ToolChange(_)) {
            self.notes.add_once(self.block(), NoteKind::RoundedCorners);
        }
        let start = std::mem::replace(&mut self.position, end);
        let spindle = match self.modal.motion {
            Some(Motion::Cycle(84) | Motion::Tap(Some(Thread::Right))) => Spindle::RightTap,
            Some(Motion::Cycle(74) | Motion::Tap(Some(Thread::Left))) => Spindle::LeftTap,
            Some(Motion::Tap(None)) => Spindle::Tapping,
            _ => self.spindle(rapid),
        };
        let state = Arc::clone(&self.state);
        let (line, within, tool_vector) = (self.line, self.within, self.vector);
        self.pending.push_back(Step {
            line,
            within,
            rapid,
            start,
            end,
            commanded,
            path,
            tool_vector,
            alignment: None,
            spindle,
            absolute: !self.modal.incremental,
            is_homeward: false,
            machine_height: None,
            is_return: false,
            shortest: [false; 6],
            state,
        });
    }
}

/// Returns two coordinates of a position, if both are known.
fn in_plane(position: &Position, axes: [usize; 2]) -> Option<[f64; 2]> {
    Some([position[axes[0]]?, position[axes[1]]?])
}
