//! The modes in force: motion, plane, unit, distance and feed.

use super::{AXES, Control, Thread};
use crate::gcode::block::{Block, Code, Group};
use crate::gcode::error::{combination, not_read};
use crate::gcode::note::NoteKind;
use crate::gcode::rules::{Choice, Rule};
use crate::gcode::state::Rotation;
use crate::gcode::{BlockLine, GcodeFault, Plane};
use touchoff::Unit;

/// Modal settings.
#[derive(Clone, Copy, Debug)]
pub(in crate::gcode) struct Modal {
    /// `None` at the start and after G80, but where that goes back to `path`.
    pub(super) motion: Option<Motion>,
    /// The last of G0 to G3, which cycles do not end on Fanuc and Haas.
    pub(super) path: Option<Motion>,
    pub(super) plane: Plane,
    pub(in crate::gcode) unit: Unit,
    /// Set by G20 and G21.
    pub(in crate::gcode) unit_stated: bool,
    /// G91.
    pub(super) incremental: bool,
    /// G90.1 or G91.1; `None` before either.
    pub(super) absolute_centres: Option<bool>,
    pub(super) feed_mode: FeedMode,
    pub(super) feed: Option<f64>,
    /// Set where the path goes through the corners (G61).
    pub(in crate::gcode) exact_path: bool,
    /// G99: canned cycles end in the plane R; `None` before G98 or G99.
    pub(super) retract_to_r: Option<bool>,
}

/// Modes that a program has stated.
#[derive(Clone, Copy, Debug, Default)]
pub(in crate::gcode) struct StatedModes {
    pub(super) distance: bool,
    pub(super) plane: bool,
    pub(super) feed: bool,
}

impl StatedModes {
    /// Those of a language in which no mode is assumed.
    pub(in crate::gcode) const ALL: StatedModes =
        StatedModes { distance: true, plane: true, feed: true };
}

/// The word that a block with axis words obeys.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Motion {
    Rapid,
    Feed,
    Arc {
        clockwise: bool,
    },
    /// A canned cycle, by its number.
    Cycle(u32),
    /// The stroke of a tap, which a cycle with a name makes and no word selects.
    Tap(Option<Thread>),
}

/// Meaning of F.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum FeedMode {
    PerMinute,
    /// G93: every block with a feed has its own F.
    InverseTime,
    PerRevolution,
}

impl Modal {
    pub(super) fn new() -> Modal {
        Modal {
            motion: None,
            path: None,
            plane: Plane::Xy,
            unit: Unit::Millimetre,
            unit_stated: false,
            incremental: false,
            absolute_centres: None,
            feed_mode: FeedMode::PerMinute,
            feed: None,
            exact_path: false,
            retract_to_r: None,
        }
    }

    /// Returns the number of the canned cycle in force.
    pub(super) fn cycle(&self) -> Option<u32> {
        match self.motion {
            Some(Motion::Cycle(number)) => Some(number),
            _ => None,
        }
    }

    /// Returns whether axis words move at feed rate, at last.
    pub(super) fn is_feed(&self) -> bool {
        !matches!(self.motion, None | Some(Motion::Rapid))
    }

    /// Returns the least increment of a length, in the unit of the program.
    pub(in crate::gcode) fn increment(&self) -> f64 {
        if self.unit == Unit::Inch { 1e-4 } else { 1e-3 }
    }

    /// Converts a length of the program to millimetres.
    pub(super) fn millimetres(&self, length: f64) -> f64 {
        length * self.unit.millimetres()
    }
}

/// Takes the words of a path mode.
fn path_control(block: &mut Block, code: Code) -> Result<(), GcodeFault> {
    let switch = match code.tenths {
        640 | 1870 => {
            block.take('P');
            // The tolerance of Haas is E.
            block.take(if code.tenths == 640 { 'Q' } else { 'E' });
            return Ok(());
        }
        610 | 611 => return Ok(()),
        51 => 'Q',
        _ => 'P',
    };
    // Smooth interpolation (G5.1 Q2) and nano smoothing (Q3) name axes by zeros, and nothing moves.
    if code.tenths == 51 && block.has('Q') && block.code_of(Group::Motion).is_none() {
        for axis in "XYZ".chars().filter(|axis| block.value(*axis) == Some(0.0)).collect::<Vec<_>>()
        {
            block.take(axis);
        }
    }
    // Fanuc's modes G5 P, G5.1 Q and G8 P. With axis words they are splines, without any a mode of a lathe.
    match block.take(switch) {
        Some(number) if code.tenths == 50 && (10_001.0..=10_999.0).contains(&number) => {
            let meaning = "a cycle that the control has stored (high-speed cycle machining)";
            Err(not_read(code, meaning, "post the program with lines and arcs"))
        }
        Some(_) if !block.has_any("XYZIJK") => {
            // The level of precision of Fanuc's G5.1.
            if code.tenths == 51 {
                block.take('R');
            }
            Ok(())
        }
        _ => {
            let meaning = "a spline, or a mode of a lathe, without the word of its path mode";
            let remedy = "post the program with lines and arcs";
            Err(not_read(code, meaning, remedy))
        }
    }
}

impl Control {
    /// Reads the feed mode and F.
    pub(super) fn feed(&mut self, block: &mut Block) -> Result<(), GcodeFault> {
        if let Some(code) = block.code_of(Group::FeedMode) {
            let mode = match code.tenths {
                930 => FeedMode::InverseTime,
                940 => FeedMode::PerMinute,
                _ => FeedMode::PerRevolution,
            };
            // LinuxCNC asks for F again after each word.
            if mode != self.modal.feed_mode || self.stated(Rule::Dialect) == Some(Choice::Rs274Ngc)
            {
                self.modal.feed = None;
            }
            self.modal.feed_mode = mode;
        }
        // F of G93 is the time of one block.
        if self.modal.feed_mode == FeedMode::InverseTime {
            self.modal.feed = None;
        }
        // F of a dwell is its time on some controls.
        let is_dwell = block.code_of(Group::Dwell).is_some();
        match block.value('F') {
            Some(value) if value < 0.0 => {
                let expected = "a positive number";
                return Err(GcodeFault::NotAllowed { word: 'F', value, expected });
            }
            Some(feed) if !is_dwell => {
                block.take('F');
                self.modal.feed = Some(feed).filter(|feed| *feed > 0.0);
            }
            _ => {}
        }
        // LinuxCNC asks for a feed rate also where no axis moves (`convert_straight`).
        match block.code_of(Group::Motion) {
            Some(Code { tenths: 10, .. })
                if self.stated(Rule::Dialect) == Some(Choice::Rs274Ngc) =>
            {
                self.check_feed("G1")
            }
            _ => Ok(()),
        }
    }

    /// Reads the settings that convert and interpret the other words.
    pub(super) fn settings(&mut self, block: &mut Block) -> Result<(), GcodeFault> {
        for code in block.passed_over.clone() {
            let letters = match (code.letter, code.tenths) {
                // The number of blocks that Haas reads ahead, or of an output of LinuxCNC, or whether it can be overridden.
                ('G', 1030) | ('M', 510..=530 | 620..=650) => "P",
                // The number of an output of LinuxCNC and its value.
                ('M', 670 | 680) => "EQ",
                _ => "",
            };
            for letter in letters.chars() {
                block.take(letter);
            }
        }
        if let Some(unit) = block.tenths_of(Group::Units) {
            let is_inch = matches!(unit, 200 | 700 | 7000);
            let unit = if is_inch { Unit::Inch } else { Unit::Millimetre };
            // Fanuc then reads its offsets in the other unit, too.
            let switches = self.unit_used && unit != self.modal.unit;
            if switches && matches!(self.stated(Rule::Dialect), None | Some(Choice::Iso)) {
                let condition = "the program has lengths in another unit";
                let remedy = "select the unit once, at the start";
                return Err(combination(if is_inch { "G20" } else { "G21" }, condition, remedy));
            }
            self.modal.unit = unit;
            self.modal.unit_stated = true;
        }
        if let Some(distance) = block.tenths_of(Group::Distance) {
            self.modal.incremental = distance == 910;
        }
        if let Some(distance) = block.tenths_of(Group::ArcDistance) {
            self.modal.absolute_centres = Some(distance == 901);
        }
        if let Some(retract) = block.tenths_of(Group::Retract) {
            self.modal.retract_to_r = Some(retract == 990);
        }
        if let Some(plane) = block.tenths_of(Group::Plane) {
            self.select(match plane {
                170 => Plane::Xy,
                180 => Plane::Zx,
                _ => Plane::Yz,
            })?;
        }
        if let Some(code) = block.code_of(Group::PathControl) {
            path_control(block, code)?;
            self.modal.exact_path = matches!(code.tenths, 610 | 611);
            self.notes.add(self.block(), NoteKind::PassedOver { word: code.to_string() });
        }
        Ok(())
    }

    /// Notes the modes on which a motion depends, and which the program has not stated.
    pub(super) fn note_assumed(&mut self, block: &Block) {
        let StatedModes { distance, plane, feed } = &mut self.stated;
        let has = |group| block.code_of(group).is_some();
        *distance |= has(Group::Distance);
        *plane |= has(Group::Plane);
        *feed |= has(Group::FeedMode);
        if !block.is_programmed() || block.owns_axis_words() {
            return;
        }
        let is_own = |letter| block.has(letter) && block.own_distance(letter).is_none();
        let depends = [
            ("G90", distance, AXES.into_iter().any(is_own)),
            (
                "G17",
                plane,
                matches!(self.modal.motion, Some(Motion::Arc { .. } | Motion::Cycle(_))),
            ),
            ("G94", feed, self.modal.is_feed()),
        ];
        let block = BlockLine { line: self.line, within: self.within };
        for (word, is_stated, depends) in depends {
            if depends && !*is_stated {
                *is_stated = true;
                self.notes.add_once(block, NoteKind::AssumedMode { word });
            }
        }
    }

    /// Reads the motion mode.
    pub(super) fn motion_mode(&mut self, block: &Block) {
        if block.code_of(Group::CycleOff).is_some() {
            // Cycles and G80 are a group of their own on Fanuc and Haas. After an arc the next block is mostly not meant as one.
            let has_groups = self.stated(Rule::Dialect) == Some(Choice::Iso);
            let is_straight = |motion: &Motion| matches!(motion, Motion::Rapid | Motion::Feed);
            self.modal.motion = self.modal.path.filter(|path| has_groups && is_straight(path));
        }
        if let Some(code) = block.code_of(Group::Motion) {
            let motion = match code.tenths {
                0 => Motion::Rapid,
                10 => Motion::Feed,
                20 => Motion::Arc { clockwise: true },
                30 => Motion::Arc { clockwise: false },
                tenths => Motion::Cycle(tenths / 10),
            };
            self.modal.motion = Some(motion);
            if !matches!(motion, Motion::Cycle(_)) {
                self.modal.path = Some(motion);
            }
        }
        // Another motion word, or G80, ends the series with its initial level.
        if self.modal.cycle().is_none() {
            self.cycle = None;
        }
        let is_tapping = matches!(self.modal.motion, Some(Motion::Cycle(74 | 84)));
        let has_motion =
            [Group::CycleOff, Group::Motion].map(|group| block.code_of(group).is_some());
        // M29 holds until G80 or another motion word.
        if has_motion.contains(&true) && !is_tapping {
            self.spindle.rigid = false;
        }
    }

    /// Selects a plane.
    pub(super) fn select(&mut self, plane: Plane) -> Result<(), GcodeFault> {
        if plane != self.modal.plane {
            let is_rotated = matches!(self.state.rotation, Rotation::Plane { .. });
            if is_rotated || self.cycle.is_some() {
                let condition = "a rotation (G68) or a canned cycle is in force";
                let remedy = "end it with G69 or G80 before";
                return Err(combination("another plane", condition, remedy));
            }
        }
        self.modal.plane = plane;
        Ok(())
    }

    /// Checks that there is a feed rate.
    pub(super) fn check_feed(&self, word: &str) -> Result<(), GcodeFault> {
        let inverse = self.modal.feed_mode == FeedMode::InverseTime;
        match self.modal.feed {
            Some(_) => Ok(()),
            None => Err(GcodeFault::NoFeed { word: word.to_owned(), inverse }),
        }
    }
}
