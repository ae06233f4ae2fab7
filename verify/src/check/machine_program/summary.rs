//! Summary of a program on its machine: what it uses, and the gaps, which are everything that a verdict about it leaves open.

use super::{Assumption, BlockError, MachineProgram, Obstacle};
use crate::codes::faults;
use crate::gcode::{
    Blank, BlockLine, Choice, ControlSetup, LengthOffset, NoteKind, ProgramNote, Rule, Spindle,
    StatedTool, Step, SubprogramLine, WorkOffset,
};
use crate::machine::{LimitViolation, SingularPass};
use nalgebra::Vector3;
use std::collections::{BTreeMap, BTreeSet, HashSet};
use std::fmt;

/// Summary of a program on its machine.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct MachineSummary {
    /// The tools in the order of their first motion that is checked.
    pub tools: Vec<ToolUse>,
    /// Tools with motions of which none is checked, each with the block of its first. The tool that is in the spindle before
    /// the first change is not among them.
    pub unchecked_tools: Vec<(u32, BlockLine)>,
    /// Motions that are not checked, by their cause.
    pub unknown: Vec<UnknownMotions>,
    /// The blocks of rapid traverse at rates that are not known of which one axis is rotary, with the level of the tip: the lowest of each
    /// direction. Only their straight paths are checked.
    pub rotary_ways: Vec<(BlockLine, BlindWay)>,
    /// The spindle during motions at feed rate, without those of taps: the line of the first by tool and spindle.
    pub spindle: Vec<(BlockLine, Option<u32>, Spindle)>,
    /// The block of the first feed without a tool length offset, in a program that names no tool or has no offset at all:
    /// positions are taken as those of the tip.
    pub no_offset: Option<BlockLine>,
    /// The same for the first motion in rapid traverse that is checked.
    pub no_rapid_offset: Option<BlockLine>,
    /// The blocks of ways to the first position on which X, Y or rotary axes are not known at the start and Z is, with the level of the
    /// tip: the lowest of each direction.
    pub blind_ways: Vec<(BlockLine, BlindWay)>,
    /// The blocks of ways to a reference position that is not known, in more axes than Z, with the level at which they begin: the lowest
    /// of each direction.
    pub ways_home: Vec<(BlockLine, BlindWay)>,
    /// The blocks of motions of an empty spindle, with the level of its gauge point: the lowest of each direction.
    pub empty_ways: Vec<(BlockLine, BlindWay)>,
    /// The ways aside at the top of Z's travel whose place is not known, one of each tool.
    pub top_ways: Vec<TopWay>,
    /// The block of the first motion of an empty spindle.
    pub first_empty: Option<BlockLine>,
    /// The number of motions of an empty spindle whose ends are known.
    pub empty_motions: usize,
    /// The blocks of all its motions.
    pub(crate) empty_blocks: HashSet<BlockLine>,
    /// The blocks without a length offset in a program that has them, in which Z is that of the gauge point.
    pub(crate) bare_blocks: HashSet<BlockLine>,
    /// The block of the first motion under tool centre point control, or in an aligned plane, without a tool length offset, and with
    /// a tool whose length is not stated.
    pub tcp_without_length: Option<BlockLine>,
    /// The work offsets of motions at feed rate, each with the block of the first.
    pub work_offsets: Vec<(WorkOffset, BlockLine)>,
    /// Work offsets other than G54 that the program sets to other values than the setup states, each with the line of its first
    /// motion.
    pub moved_offsets: Vec<(WorkOffset, usize)>,
    /// Rules of the control on which the program depends and which are not stated, each with the first block.
    pub open_rules: BTreeMap<Rule, BlockLine>,
    /// Feed motions with the length offset of another tool: the line of the first, the register and the tool.
    pub other_lengths: Vec<(BlockLine, u32, u32)>,
    /// Axes that leave their limits, each with its line: the worst per axis and limit. Those of X, Y and Z are checked if the
    /// origin of the part on the machine is given.
    pub limits: Vec<(BlockLine, LimitViolation)>,
    /// Set if the machine states limits of X, Y or Z that are not checked.
    pub limits_unchecked: bool,
    /// The first block with a tool whose length is not known, if the machine states limits of Z: its upper one is not checked.
    pub z_limit_unchecked: Option<BlockLine>,
    /// The first block with a turned axis whose direction is that of ISO 841, as no control is stated.
    pub(crate) direction_assumed: Option<BlockLine>,
    /// Singular passes, each with its line.
    pub singular: Vec<(BlockLine, SingularPass)>,
    /// The blank that the program states.
    pub blank: Option<Blank>,
    /// The first block with a step under another work offset than G54.
    pub(crate) other_offset: Option<BlockLine>,
    /// The tools that comments of the program describe.
    pub stated_tools: Vec<StatedTool>,
    /// Notes of the interpreter.
    pub notes: Vec<ProgramNote>,
    /// The line at which the program stops being read, if it does.
    pub stop: Option<ProgramStop>,
}

/// A way on which some axes are not known, and Z is.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct BlindWay {
    /// The lowest level of the tip, relative to each link of the table, from the base on, in machine coordinates with all axes at 0; the
    /// last is relative to the part, in its frame.
    pub levels: Vec<Level>,
    /// Set if Z stays at the top of its travel.
    pub is_at_top: bool,
}

/// A way aside at the top of Z's travel, which only the machine knows.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct TopWay {
    /// The first block.
    pub block: BlockLine,
    /// The tool; `None` before the program names one.
    pub tool: Option<u32>,
    /// Its length, if it is stated.
    pub length: Option<f64>,
    /// The highest level at which the spindle's gauge point can be.
    pub way: BlindWay,
}

/// A level that the tool is beyond, wherever X and Y are.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Level {
    /// The direction of Z of the machine, a unit vector.
    pub up: Vector3<f64>,
    /// The tip along it, in mm; below all for a tool that is tilted against it.
    pub height: f64,
}

impl Level {
    /// The level below all.
    pub(super) const BELOW: Level =
        Level { up: Vector3::new(0.0, 0.0, 1.0), height: f64::NEG_INFINITY };

    /// Returns the lower of two levels of each link; below all where their directions differ.
    pub(super) fn lower(levels: &[Level], others: &[Level]) -> Vec<Level> {
        let pairs = levels.iter().zip(others);
        let lower = pairs.map(|(one, other)| match one.up == other.up {
            true => Level { up: one.up, height: one.height.min(other.height) },
            false => Level { up: one.up, ..Level::BELOW },
        });
        lower.collect()
    }
}

/// The end of what is read of a program. The motions before it are checked.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct ProgramStop {
    /// The block and its fault.
    pub error: BlockError,
    /// The number of blocks that have this fault.
    pub count: usize,
    /// The first hundred obstacles behind it.
    pub obstacles: Vec<Obstacle>,
    /// The number of blocks with obstacles that are not among these.
    pub unlisted: usize,
}

/// Motions that are not checked for one cause.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct UnknownMotions {
    /// The cause.
    pub cause: UnknownCause,
    /// Their number.
    pub count: usize,
    /// The block of the first.
    pub first: BlockLine,
    /// The block of the first that allows no verdict: one in feed, or one between positions that the program states. The way
    /// to its first position is the operator's, and that to the reference position the machine's.
    pub first_open: Option<BlockLine>,
}

/// A tool's use in a program.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct ToolUse {
    /// The tool's number; `None` before the first tool change.
    pub number: Option<u32>,
    /// Line of its first motion.
    pub line: usize,
    /// Number of motions.
    pub motions: usize,
}

faults! {
    #[family("V04", "Motions that are not checked")]
    /// The reason for which only the machine knows where a motion starts or ends.
    #[derive(Clone, Copy, PartialEq, Eq, thiserror::Error)]
    #[non_exhaustive]
    pub enum UnknownCause {
        /// A motion from a position that the program has not stated.
        ///
        /// In rapid traverse it is the operator's way to the first position, and a verdict is possible.
        #[code = V0401]
        #[error("the program states no position before")]
        Start,
        /// A motion while the position of another axis is not stated.
        #[code = V0402]
        #[error("the position of another axis is not stated before: write all axes of the machine in the first blocks")]
        Axis,
        /// A motion from where a tool change leaves the axes.
        ///
        /// A verdict is possible if Z moves to the top of its travel first, and the other axes while it is there.
        #[code = V0403]
        #[error(
            "only the machine knows where the tool change leaves its axes: state `tool_change` in the machine's file, or the control (a \
             place in machine coordinates needs the origin of G54 in `work_offsets`)"
        )]
        ToolChange,
        /// A motion to machine coordinates that are not known.
        #[code = V0404]
        #[error(
            "only the machine knows where its coordinates and its reference position are: state the origin of G54 in `work_offsets`, \
             `home` of its axes, and the `length` of the tool; for M92 `m92` of the machine's file"
        )]
        Return,
        /// The way of axes from known positions to machine coordinates that are not known.
        ///
        /// It is the machine's own way to its reference position, and a verdict is possible.
        #[code = V0405]
        #[error(
            "only the machine knows where its coordinates and its reference position are: state the origin of G54 in `work_offsets`, and \
             `home` of its axes; for M92 `m92` of the machine's file"
        )]
        Home,
        /// A shift by G92 at an unknown position.
        #[code = V0406]
        #[error("G92 shifts a position that is not known")]
        Shift,
        /// A motion without a tool length offset, while the length of the tool is not stated.
        #[code = V0407]
        #[error(
            "T{tool} moves without a tool length offset: write G43 H{tool}, or state the length of tool {tool} in the job (0 if Z of the \
             work offset is that of its tip)"
        )]
        NoOffset {
            /// The tool.
            tool: u32,
        },
        /// The length offset of another tool, while one of both lengths is not stated.
        #[code = V0408]
        #[error(
            "T{tool} moves with the length offset H{register} of another tool: state the lengths of both in the job"
        )]
        OtherOffset {
            /// The tool.
            tool: u32,
            /// The register.
            register: u32,
        },
        /// A head that turns a tool whose length is not stated.
        #[code = V0409]
        #[error("the head turns the tool, whose length is not stated: state it in the job")]
        NoLever,
        /// A table that turns a part whose position is not stated.
        #[code = V0410]
        #[error(
            "the table turns the part, whose position is not stated: state the origin of G54 in `work_offsets`"
        )]
        NoPartPosition,
        /// An axis that turns by half a turn.
        #[code = V0411]
        #[error("an axis turns by half a turn, for which both ways are as short: write an angle between")]
        HalfTurn,
        /// A tool axis that two positions of the rotary axes give.
        #[code = V0412]
        #[error(
            "two positions of the rotary axes give the tool axis, and controls choose in different ways: turn the axes near to one of \
             them before"
        )]
        TwoPositions,
        /// A rotary axis without limits that returns to its reference position.
        #[code = V0413]
        #[error(
            "a rotary axis without limits returns to its reference position in a direction of the machine's: turn it there by G0 before"
        )]
        ReturnWay,
        /// A tool axis that turns on a great circle, which is not followed.
        #[code = V0414]
        #[error(
            "the tool axis may turn on a great circle under TRAORI (ORIWKS, ORIVECT): state `tool_orientation` of the control, if it turns each axis \
             in proportion (ORIAXES)"
        )]
        GreatCircle,
        /// Tool centre point control or a tilted plane that begins while the table is turned.
        ///
        /// Some controls take the part as it stands then.
        #[code = V0415]
        #[error(
            "the table is turned where tool centre point control or a tilted plane begins, and positions are those of the part as it \
             stands: turn it to 0 before, or state `tcp_start` of the control"
        )]
        TurnedTable,
        /// Tool centre point control, or an aligned plane, without a tool length offset.
        ///
        /// The control computes with the length offset that is in force, and without one with a tool of length 0.
        #[code = V0416]
        #[error(
            "tool centre point control or an aligned plane (G53.1) is in force, and no length offset: write H with the number of the \
             length, or G43 H before"
        )]
        TcpWithoutLength,
        /// An arc whose start follows from the kinematics of the machine.
        ///
        /// The control knows it, as after tool centre point control with turned axes, and the program has not stated it.
        #[code = V0417]
        #[error("an arc begins at a position that the program does not state: write X, Y and Z before it")]
        ArcStart,
        /// A rotary axis that turns within 360 degrees, of which it is not stated where they begin.
        ///
        /// The origin of the axis is not 0, and the way is another one by the angles of the program than by those of the machine.
        #[code = V0418]
        #[error(
            "a rotary axis turns between angles from 0 to 360, which its work offset shifts, by the angles of the program or of the \
             machine: write an angle between, or state 0 for the axis in `work_offsets`"
        )]
        TurnOrigin,
        /// A tool that the head tilts under M428.
        ///
        /// Releases of LinuxCNC's maxkins add the length of the tool along z of the machine, and not along the tool.
        #[code = V0419]
        #[error(
            "the head tilts the tool under M428, whose length some releases of LinuxCNC's kinematics add along z: state `head_length` of \
             the control"
        )]
        HeadLength,
        /// A rotary axis that moves in machine coordinates, or by a tool change, in an aligned plane.
        ///
        /// The tool no longer stands along the plane, and controls take the positions after it in different ways.
        #[code = V0420]
        #[error(
            "a rotary axis has moved in machine coordinates while an aligned plane is in force: end the plane before, or begin it anew"
        )]
        LeftPlane,
        /// A motion of an empty spindle (T0) at a height that is not known.
        ///
        /// A verdict is possible if Z moves to the top of its travel first, and the other axes while it is there.
        #[code = V0421]
        #[error(
            "the empty spindle (T0) moves at a height that is not known: state the origin of G54 in `work_offsets`, or move Z to its \
             reference position first, and the other axes while it is there"
        )]
        EmptySpindle,
        /// A motion of an empty spindle (T0) with a length offset that is not known.
        #[code = V0422]
        #[error(
            "the empty spindle (T0) moves with the length offset H{register}, whose length is not stated: write G49 before, or state the \
             length of tool {register} in the job"
        )]
        EmptyOffset {
            /// The register.
            register: u32,
        },
        /// A motion from where another tool, an empty spindle (T0) or machine coordinates have left Z.
        ///
        /// Between the axis and the tip is a length that is not stated. A verdict is possible if Z is at the top of its travel, and leaves it
        /// alone.
        #[code = V0423]
        #[error(
            "only the machine knows where the tip is: another tool, an empty spindle (T0) or machine coordinates have left Z there, and a \
             length is not stated: state the lengths of all tools in the job"
        )]
        TipHeight,
    }
}

impl UnknownCause {
    /// Returns whether the height of an empty spindle is not known.
    pub(super) fn is_of_empty(self) -> bool {
        matches!(self, UnknownCause::EmptySpindle | UnknownCause::EmptyOffset { .. })
    }
}

faults! {
    #[family("V03", "What a check leaves open")]
    /// A reason for a gap that concerns no single motion.
    #[derive(Clone, PartialEq, thiserror::Error)]
    pub(crate) enum CheckGap {
        /// A tool of which no motion is checked.
        ///
        /// Other gaps say why.
        #[code = V0301]
        #[error("no motion of T{tool} is checked")]
        Unchecked { tool: u32 },
        /// Rapid traverse of a rotary axis with others, whose path is not stated, lower than something that it can meet.
        #[code = V0302]
        #[error(
            "the path of several axes in rapid traverse, one of them rotary, is checked on the straight line only, and the tool is lower there \
             than {name} can be: state `rapid` of the control, or the `rapid` rates of the machine's axes, or move Z above it before"
        )]
        RotaryRapid { name: String },
        /// A length before the program states its unit.
        #[code = V0303]
        #[error("no G20 or G21 before a length, which is read in mm: write one, or state `unit` of the control")]
        Unit,
        /// A position before the program states its work offset.
        #[code = V0304]
        #[error(
            "no work offset before a position, which is taken in G54: write G54, or state `start_offset` of the control"
        )]
        StartOffset,
        /// A program that never starts the spindle.
        #[code = V0305]
        #[error("the program feeds and never starts the spindle: write M3 with S before")]
        NoSpindle,
        /// A feed after a tapping cycle, with a spindle that may stand.
        #[code = V0306]
        #[error(
            "a tapping cycle before a feed leaves the spindle standing or turning, by the control: write M3 after G80"
        )]
        AfterTapping,
        /// A feed without a tool length offset, in a program that names tools.
        ///
        /// The gauge point of the spindle goes then where the program says, unless the work offset was set with the tool.
        #[code = V0307]
        #[error(
            "no tool length offset (G43) is in force: positions are taken as those of the tip, as if the work offset were set with the \
             tool: write G43, or state the lengths of the tools in the job (0 if Z of the work offset is that of the tip)"
        )]
        NoOffset,
        /// A program that names no tool and no tool length offset, whose positions are taken as those of the tip.
        ///
        /// It is set up with the tool that is in the spindle, and a verdict is possible.
        #[code = V0308]
        #[error(
            "no tool length offset (G43) is in force: positions are taken as those of the tip, as if the work offset were set with the \
             tool"
        )]
        OffIsTip,
        /// Limits of linear axes that are not checked.
        ///
        /// They are limits in machine coordinates, in which the part has to have a place. A verdict is possible.
        #[code = V0309]
        #[error("the limits of X, Y and Z are not checked: state the origin of G54 in `work_offsets`")]
        Limits,
        /// Rotary axes of a built-in machine, whose directions are taken as those of ISO 841.
        ///
        /// LinuxCNC turns them as its kinematics or its drives do, and no control is stated. A verdict is possible.
        #[code = V0310]
        #[error(
            "the rotary axes are taken to turn as ISO 841 says, which LinuxCNC leaves to the machine: state the control, with \
             `rotary_direction` for LinuxCNC, or a machine's file"
        )]
        RotaryDirection,
        /// Blocks that cannot be read, beyond those that are listed.
        ///
        /// Prose and files of another kind have one in each line.
        #[code = V0311]
        #[error(
            "{count} more line{} cannot be read for other reasons, which are not listed: mend those above first, or check that the file \
             is a program of this control",
            if *count == 1 { "" } else { "s" }
        )]
        Unlisted { count: usize },
        /// Motions after T0, which leaves the spindle empty.
        ///
        /// The job states no tool 0. A verdict is possible if the gauge point of the spindle stays above part, stock, fixtures and bodies of
        /// the machine; what of the spindle is lower than its gauge point, such as drive keys, is not known. A changer of LinuxCNC that is
        /// `RANDOM_TOOLCHANGER` has a tool 0.
        #[code = V0312]
        #[error(
            "T0 is taken to leave the spindle empty, and its motions are checked by the height of the gauge point alone: state `[tool.0]` if a \
             tool has this number"
        )]
        EmptySpindle,
        /// The upper limit of Z, where the length of a tool is not stated.
        ///
        /// The axis is higher than the tip by the length. What is certainly beyond it is a finding. A verdict is possible.
        #[code = V0313]
        #[error(
            "the upper limit of Z, and limits of all linear axes where a head turns, are not checked, as the tool's length is not known: \
             state its `length`"
        )]
        UpperLimit,
    }
}

/// Something that was not checked, or that was taken for granted.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Gap {
    /// The line of its first occurrence, 1-based; 0 if it concerns no line.
    pub line: usize,
    /// The line of its first occurrence in the file of subprograms that has it.
    pub within: Option<SubprogramLine>,
    /// Its consequence.
    pub weight: GapWeight,
    /// The stable code of its cause.
    code: &'static str,
    /// The subject that was not checked, the cause, and the remedy. A sentence without a full stop.
    pub reason: String,
}

/// The consequence of a gap.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum GapWeight {
    /// There is no verdict, whatever a job accepts: the program is not read to its end, or the set-up before it has findings.
    Stops,
    /// There is no verdict unless a job accepts it: a collision could be missed that the program alone makes.
    Open,
    /// A verdict is possible.
    Said,
}

impl Gap {
    /// Creates a gap that leaves a verdict possible. `code` is that of its cause.
    pub fn said(place: impl Into<BlockLine>, code: &'static str, reason: String) -> Gap {
        Gap::new(place.into(), GapWeight::Said, code, reason)
    }

    /// Creates a gap that allows no verdict. `code` is that of its cause.
    pub fn open(place: impl Into<BlockLine>, code: &'static str, reason: String) -> Gap {
        Gap::new(place.into(), GapWeight::Open, code, reason)
    }

    fn new(place: BlockLine, weight: GapWeight, code: &'static str, reason: String) -> Gap {
        let BlockLine { line, within } = place;
        Gap { line, within, weight, code, reason }
    }

    /// Returns the stable [code](crate::codes) of its cause.
    pub fn code(&self) -> &'static str {
        self.code
    }

    /// Returns whether there is no verdict with it.
    pub fn is_open(&self) -> bool {
        self.weight != GapWeight::Said
    }
}

/// The reason with its line.
impl fmt::Display for Gap {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.line {
            0 => f.write_str(&self.reason),
            line => write!(f, "line {line}: {}", self.reason),
        }
    }
}

impl MachineSummary {
    /// Returns the use of the tool of a step, which begins with it if the tool is new.
    pub(super) fn use_of(&mut self, step: &Step) -> &mut ToolUse {
        let number = step.state.tool;
        let known = self.tools.iter().position(|tool| tool.number == number);
        let index = known.unwrap_or_else(|| {
            self.tools.push(ToolUse { number, line: step.line, motions: 0 });
            self.tools.len() - 1
        });
        &mut self.tools[index]
    }

    /// Notes what a motion at feed rate needs.
    pub(super) fn add_feed(&mut self, step: &Step, off_is_tip: bool) {
        let tool = step.state.tool;
        // The interpreter has refused a tap whose spindle does not turn into the thread; the tool may have the other hand.
        if step.spindle != Spindle::Tapping
            && !self
                .spindle
                .iter()
                .any(|(_, known, spindle)| (*known, *spindle) == (tool, step.spindle))
        {
            self.spindle.push((step.block(), tool, step.spindle));
        }
        if (tool.is_none() || off_is_tip) && step.state.length == LengthOffset::Off {
            self.no_offset.get_or_insert(step.block());
        }
        let offset = step.state.work_offset;
        if !self.work_offsets.iter().any(|(known, _)| *known == offset) {
            self.work_offsets.push((offset, step.block()));
        }
    }

    /// Notes a motion in rapid traverse that is checked as that of the tip without a length offset.
    pub(super) fn add_rapid(&mut self, step: &Step, off_is_tip: bool, unnamed_tool: Option<u32>) {
        let is_tip = off_is_tip || step.state.tool.is_none() && unnamed_tool.is_none();
        if is_tip && step.state.length == LengthOffset::Off {
            self.no_rapid_offset.get_or_insert(step.block());
        }
    }

    /// Adds a way aside at the top of Z's travel: the lowest level of each tool is kept.
    pub(super) fn add_top_way(&mut self, added: TopWay) {
        match self.top_ways.iter_mut().find(|known| known.tool == added.tool) {
            Some(TopWay { way, .. }) => way.levels = Level::lower(&way.levels, &added.way.levels),
            None => self.top_ways.push(added),
        }
    }

    /// Notes a way to the first position, or to a reference position that is not known. Of those with the same directions the lowest is
    /// kept.
    pub(super) fn add_blind_way(
        ways: &mut Vec<(BlockLine, BlindWay)>,
        block: BlockLine,
        way: BlindWay,
    ) {
        /// Largest number of ways that are kept. Further ones are below all.
        const MAX_WAYS: usize = 64;
        let is_along = |known: &BlindWay| {
            let mut pairs = known.levels.iter().zip(&way.levels);
            known.is_at_top == way.is_at_top && pairs.all(|(one, other)| one.up == other.up)
        };
        let Some(index) = ways.iter().position(|(_, known)| is_along(known)) else {
            if ways.len() < MAX_WAYS {
                ways.push((block, way));
            } else {
                ways[0].1.levels.iter_mut().for_each(|level| level.height = f64::NEG_INFINITY);
            }
            return;
        };
        let levels = Level::lower(&ways[index].1.levels, &way.levels);
        if levels != ways[index].1.levels {
            ways[index] = (block, BlindWay { levels, ..way });
        }
    }

    /// Notes that the work offset of a step has another origin than a setup states.
    pub(super) fn add_offset(&mut self, step: &Step, setup: &ControlSetup) {
        let (state, offset) = (&step.state, step.state.work_offset);
        if !matches!(offset, WorkOffset::Standard(1) | WorkOffset::Off) {
            self.other_offset.get_or_insert(step.block());
        }
        let stated = match offset {
            WorkOffset::Standard(number @ 2..) => {
                setup.work_offsets.get(usize::from(number) - 1).and_then(Option::as_ref)
            }
            WorkOffset::Additional(number) => setup.additional_offsets.get(&number),
            WorkOffset::Standard(_) | WorkOffset::Off => None,
        };
        let Some(stated) = stated else { return };
        let mut origin = state.origin.iter().zip(stated);
        let is_moved = state.origin_rotation != 0.0
            || origin.any(|(set, stated)| set.is_some_and(|set| set != *stated));
        if is_moved && self.moved_offsets.iter().all(|(known, _)| *known != offset) {
            self.moved_offsets.push((offset, step.line));
        }
    }

    /// Notes a motion that is not checked. `is_judged` is set if it hits nothing all the same, or that is said elsewhere.
    pub(super) fn add_unknown(&mut self, step: &Step, cause: UnknownCause, is_judged: bool) {
        let position = self.unknown.iter().position(|known| known.cause == cause);
        let position = position.unwrap_or_else(|| {
            let motions = UnknownMotions { cause, count: 0, first: step.block(), first_open: None };
            self.unknown.push(motions);
            self.unknown.len() - 1
        });
        let unknown = &mut self.unknown[position];
        unknown.count += 1;
        // The way to the first position is the operator's, and that to the reference position the machine's.
        let is_said = is_judged || matches!(cause, UnknownCause::Start | UnknownCause::Home);
        if !step.rapid || !is_said {
            unknown.first_open.get_or_insert(step.block());
        }
    }

    /// Adds a violation, or keeps the worse one of the same axis and limit.
    pub(super) fn add_violation(&mut self, block: BlockLine, violation: LimitViolation) {
        let known = self
            .limits
            .iter_mut()
            .find(|(_, known)| known.letter == violation.letter && known.limit == violation.limit);
        match known {
            None => self.limits.push((block, violation)),
            Some(known) if violation.excess() > known.1.excess() => *known = (block, violation),
            Some(_) => (),
        }
    }

    /// Returns what this reading leaves open.
    fn gaps(&self) -> Vec<Gap> {
        let mut gaps = Vec::new();
        if let Some(ProgramStop { error, count, obstacles, unlisted }) = &self.stop {
            let weight = GapWeight::Stops;
            let times = |count| if count > 1 { format!(" ({count} times)") } else { String::new() };
            let BlockError { block, fault } = error;
            let reason = format!("{fault}{}; the program is checked up to here", times(*count));
            gaps.push(Gap::new(*block, weight, fault.code(), reason));
            gaps.extend(obstacles.iter().map(|Obstacle { block, count, fault }| {
                Gap::new(*block, weight, fault.code(), format!("{fault}{}", times(*count)))
            }));
            if *unlisted > 0 {
                let gap = CheckGap::Unlisted { count: *unlisted };
                gaps.push(Gap::new(*block, weight, gap.code(), gap.to_string()));
            }
        }
        for UnknownMotions { cause, count, first, first_open } in &self.unknown {
            let plural = if *count == 1 { "" } else { "s" };
            let line = first.line;
            let reason =
                format!("{count} motion{plural} not checked, first at line {line}: {cause}");
            gaps.push(match first_open {
                Some(first_open) => Gap::open(*first_open, cause.code(), reason),
                None => Gap::said(*first, cause.code(), reason),
            });
        }
        let open = |block: BlockLine, gap: CheckGap| Gap::open(block, gap.code(), gap.to_string());
        for (tool, block) in &self.unchecked_tools {
            gaps.push(open(*block, CheckGap::Unchecked { tool: *tool }));
        }
        if let Some(block) = self.open_rules.get(&Rule::Unit) {
            gaps.push(open(*block, CheckGap::Unit));
        }
        if let Some(block) = self.open_rules.get(&Rule::StartOffset) {
            gaps.push(open(*block, CheckGap::StartOffset));
        }
        if let (Some(block), false) = (self.first_feed(Spindle::NotStated), self.states_spindle()) {
            gaps.push(open(block, CheckGap::NoSpindle));
        }
        if let Some(block) = self.first_feed(Spindle::AfterTapping) {
            gaps.push(open(block, CheckGap::AfterTapping));
        }
        let said = |place: BlockLine, gap: CheckGap| Gap::said(place, gap.code(), gap.to_string());
        if let Some(block) = self.no_offset.or(self.no_rapid_offset) {
            // A program that names no tool is set up with the one that is in the spindle.
            gaps.push(match self.tools.iter().any(|tool| tool.number.is_some()) {
                true => open(block, CheckGap::NoOffset),
                false => said(block, CheckGap::OffIsTip),
            });
        }
        if let Some(block) = self.tcp_without_length {
            let cause = UnknownCause::TcpWithoutLength;
            let reason = format!("tips are taken as programmed, but {cause}");
            gaps.push(Gap::open(block, cause.code(), reason));
        }
        if let Some(block) = self.first_empty {
            gaps.push(said(block, CheckGap::EmptySpindle));
        }
        if let Some(block) = self.direction_assumed {
            gaps.push(said(block, CheckGap::RotaryDirection));
        }
        if self.limits_unchecked {
            gaps.push(said(BlockLine::from(0), CheckGap::Limits));
        } else if let Some(block) = self.z_limit_unchecked {
            gaps.push(said(block, CheckGap::UpperLimit));
        }
        for note in &self.notes {
            let weight = match note.kind {
                NoteKind::PassedOver { .. } => continue,
                NoteKind::OtherProgram
                | NoteKind::OptionalSwitches
                | NoteKind::TwoRadii
                | NoteKind::EmptyCycle
                | NoteKind::UncalledCycle
                | NoteKind::RoundedRadius
                | NoteKind::OffsetOrShift => GapWeight::Open,
                NoteKind::RoundedCorners
                | NoteKind::Spiral { .. }
                | NoteKind::AssumedMode { .. }
                | NoteKind::ToolChange
                | NoteKind::Ignored { .. }
                | NoteKind::Endless
                | NoteKind::LeftModes { .. }
                | NoteKind::HelixStart
                | NoteKind::Stop
                | NoteKind::ExecutedOptionalBlock
                | NoteKind::OmittedOptionalBlock
                | NoteKind::TextAfterEnd => GapWeight::Said,
            };
            let times =
                if note.count > 1 { format!(" ({} times)", note.count) } else { String::new() };
            let reason = format!("{}{times}", note.kind);
            let place = BlockLine { line: note.line, within: note.within };
            gaps.push(Gap::new(place, weight, note.kind.code(), reason));
        }
        gaps
    }

    /// Returns the block of the first feed with a spindle.
    fn first_feed(&self, wanted: Spindle) -> Option<BlockLine> {
        self.spindle.iter().find(|(.., spindle)| *spindle == wanted).map(|(block, ..)| *block)
    }

    /// Returns whether the program says something about the spindle before some feed. Otherwise it leaves the spindle to the
    /// operator.
    pub fn states_spindle(&self) -> bool {
        let mut spindles = self.spindle.iter().map(|(.., spindle)| spindle);
        spindles.any(|spindle| {
            use Spindle::{AfterTapping, LeftTap, NotStated, RightTap};
            !matches!(spindle, NotStated | AfterTapping | RightTap | LeftTap)
        })
    }
}

impl MachineProgram {
    /// Returns what the readings of a program leave open: first what allows no verdict, each in the order of lines.
    pub fn gaps(readings: &[MachineProgram]) -> Vec<Gap> {
        let mut gaps: Vec<(Gap, Vec<&Assumption>)> = Vec::new();
        for program in readings {
            for mut gap in program.summary.gaps() {
                // Faults that stop a program name the line themselves.
                if gap.weight != GapWeight::Stops {
                    gap.reason += &program.name_within(gap.within);
                }
                match gaps.iter_mut().find(|(known, _)| *known == gap) {
                    Some((_, rules)) => rules.push(&program.assumed),
                    None => gaps.push((gap, vec![&program.assumed])),
                }
            }
        }
        let gaps = gaps.into_iter().map(|(mut gap, rules)| {
            if let Some(under) = MachineProgram::under(readings, &rules) {
                gap.reason = format!("{} ({under})", gap.reason);
            }
            gap
        });
        let mut gaps: Vec<Gap> = gaps.collect();
        gaps.sort_by_key(|gap| (gap.weight, gap.line));
        gaps
    }

    /// Returns the name of a file: that of the program, or by its [number](SubprogramLine::file) of a file of subprograms.
    pub(crate) fn file_name(&self, number: usize) -> &str {
        let file = number.checked_sub(1).and_then(|index| self.subprograms().get(index));
        file.map_or(self.name(), |file| &file.name)
    }

    /// Names a line in a file of subprograms, for the end of a sentence; empty without one.
    pub(crate) fn name_within(&self, place: Option<SubprogramLine>) -> String {
        place.map_or(String::new(), |within| {
            format!(" ({}, line {})", self.file_name(within.file), within.line)
        })
    }

    /// Names the readings for which something holds, by what they assume: `under rotary = "shortest"`. `None` if it holds for
    /// all.
    pub fn under(readings: &[MachineProgram], holds: &[&Assumption]) -> Option<String> {
        if holds.len() == readings.len() {
            return None;
        }
        // A rule whose choices in these are not all that it has in the readings is a condition.
        let first = holds.first()?;
        let mut common: Vec<String> = Vec::new();
        for rule in Rule::all() {
            let choices = |of: &mut dyn Iterator<Item = &Assumption>| -> BTreeSet<Choice> {
                of.filter_map(|assumed| assumed.rules.get(rule)).collect()
            };
            let held = choices(&mut holds.iter().copied());
            if held.len() < choices(&mut readings.iter().map(|reading| &reading.assumed)).len() {
                let words = held.iter().map(|choice| format!("\"{}\"", rule.describe(*choice)[0]));
                let words: Vec<String> = words.collect();
                common.push(format!("{} = {}", rule.key(), words.join(" or ")));
            }
        }
        for (name, value) in &first.variables {
            if holds.iter().all(|assumed| assumed.variables.get(name) == Some(value)) {
                common.push(format!("{name} = {value}"));
            }
        }
        match common.is_empty() {
            false => Some(format!("under {}", common.join(", "))),
            true if holds.len() <= 3 => {
                let each: Vec<String> = holds.iter().map(|assumed| assumed.to_string()).collect();
                Some(format!("under {}", each.join(", or ")))
            }
            true => Some(format!("under {} of {} readings", holds.len(), readings.len())),
        }
    }
}
