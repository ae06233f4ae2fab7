//! Canned cycles: drilling, tapping and boring along the normal of the plane.
//!
//! A cycle moves in rapid traverse over its hole, in rapid traverse to the plane R, at feed rate to its
//! depth, and back: to R (G99), or to the level at which the first cycle of the series began (G98). Under
//! G91, R is relative to that level and the depth to R. A [rule](Rule::CycleBelowR) of the control decides
//! whether a tool that begins below R rises to it before it moves sideways.
//!
//! Where G91 follows a cycle of G90 on Fanuc and Haas, as in `G81 X0 Z-3. R2.` and `G91 X10. K3`, the cycle keeps its levels.
//!
//! The retracts of G73 by an amount that the control holds are left out: they stay on the stroke of the
//! drill. G83 returns to its last depth in rapid traverse; the clearance that a control keeps there is taken
//! as zero.

use super::{AXES, Control, Cycle, FeedMode, Spindle, Thread, linuxcnc};
use crate::gcode::block::{Block, Group};
use crate::gcode::error::{combination, missing};
use crate::gcode::note::NoteKind;
use crate::gcode::rules::{Choice, Rule};
use crate::gcode::state::{Position, Tcp};
use crate::gcode::{GcodeFault, MAX_CYCLE_STEPS, Plane, StepPath};
use std::sync::Arc;

/// Returns whether a level is below another.
fn is_below(level: Option<f64>, other: Option<f64>) -> bool {
    level.zip(other).is_some_and(|(level, other)| level < other)
}

/// The levels of a cycle along the normal. Unknown if they depend on an unknown position.
#[derive(Clone, Copy)]
struct Levels {
    retract: Option<f64>,
    depth: Option<f64>,
    clear: Option<f64>,
}

impl Control {
    /// Executes a canned cycle.
    pub(super) fn canned_cycle(
        &mut self,
        block: &mut Block,
        number: u32,
    ) -> Result<(), GcodeFault> {
        let word = format!("G{number}");
        self.check_cycle(block, number, &word)?;
        self.check_feed(&word)?;
        self.check_tilted(block)?;
        self.check_position(block)?;
        let normal = self.modal.plane.normal();
        let cycle = self.cycle_words(block, number, &word)?;
        let levels = self.levels(&cycle)?;
        let repeats = self.repeats(block)?;
        match repeats {
            0 => self.define_cycle(),
            _ => self.call_cycle(),
        }
        // Only G83 leaves the hole between its pecks.
        let strokes = match (number, cycle.peck, levels.retract.zip(levels.depth)) {
            (83, Some(peck), Some((retract, depth))) => ((retract - depth) / peck).ceil().max(1.0),
            _ => 1.0,
        };
        // The way to a hole takes three steps at most, and each stroke as many.
        if f64::from(repeats) * (3.0 * strokes + 3.0) > MAX_CYCLE_STEPS as f64 {
            return Err(GcodeFault::CycleTooLong);
        }
        if levels.depth.is_some() && levels.depth == levels.retract {
            self.notes.add(self.block(), NoteKind::EmptyCycle);
        }
        let axes = self.take_axes(block);
        // LinuxCNC compares the initial level, and not the present one, with R.
        if repeats > 0
            && is_below(cycle.initial, levels.retract)
            && self.position[normal] != levels.retract
            && self.choice(Rule::CycleBelowR) == Choice::RaisesFirst
        {
            self.move_along(normal, true, levels.retract);
        }
        for _ in 0..repeats {
            self.move_over(axes, levels);
            if self.position[normal] != levels.retract || levels.retract.is_none() {
                self.move_along(normal, true, levels.retract);
            }
            self.stroke(number, normal, cycle.peck, levels, strokes);
        }
        self.cycle = Some(cycle);
        Ok(())
    }

    /// Notes that a cycle is defined, which has to be called, and the one before if it was not.
    pub(in crate::gcode) fn define_cycle(&mut self) {
        if let Some(before) = self.uncalled.replace(self.block()) {
            self.notes.add(before, NoteKind::UncalledCycle);
        }
    }

    /// Notes that the cycle is called.
    pub(in crate::gcode) fn call_cycle(&mut self) {
        self.uncalled = None;
    }

    /// Returns how often the cycle is executed. The word that is not that of the control says nothing.
    fn repeats(&mut self, block: &mut Block) -> Result<u32, GcodeFault> {
        let by_l = block.take_whole('L', 0, 1_000_000, "a number of repeats after L")?.unwrap_or(1);
        let by_k = block.take_whole('K', 0, 1_000_000, "a number of repeats after K")?.unwrap_or(1);
        let (word, repeats) = match by_l == by_k {
            // One number, whichever word the control reads.
            true => ("L0", by_l),
            false if self.choice(Rule::CycleRepeats) == Choice::RepeatsByK => ("K0", by_k),
            false => ("L0", by_l),
        };
        // Without a place the words of the cycle are stored, and nothing moves.
        if repeats == 0 && block.has_any("XYABC") {
            let condition = "its block has a canned cycle and a place, to which Haas moves";
            let remedy = "write the place in a block before, or after it with G80 and G0";
            return Err(combination(word, condition, remedy));
        }
        Ok(repeats)
    }

    /// Refuses a cycle that controls execute in different ways.
    fn check_cycle(&mut self, block: &Block, number: u32, word: &str) -> Result<(), GcodeFault> {
        self.check_series(block, word)?;
        let is_linuxcnc = self.stated(Rule::Dialect) == Some(Choice::Rs274Ngc);
        if is_linuxcnc {
            linuxcnc::check_cycle(block, number)?;
            if self.modal.feed_mode == FeedMode::InverseTime {
                let condition = "G93 is in force, which LinuxCNC does not allow";
                let remedy = "write G94 before";
                return Err(combination(word, condition, remedy));
            }
        }
        // LinuxCNC drills again at Z, R or Q alone, Haas does not.
        let in_plane = self.modal.plane.axes().map(|axis| AXES[axis]);
        let has_place = in_plane.iter().chain(&AXES[3..]).any(|letter| block.has(*letter));
        if self.cycle.is_some() && !is_linuxcnc && !has_place {
            let condition = "its block goes on with a series and has no place of a hole, and is executed or not";
            let remedy = "write X or Y";
            return Err(combination(word, condition, remedy));
        }
        // LinuxCNC drills along the normal of the plane, but taps along another axis (`convert_cycle_g74_g84` of its interpreter).
        // Fanuc drills along Z by a parameter.
        let is_across = self.modal.plane != Plane::Xy;
        if is_across && (!is_linuxcnc || matches!(number, 74 | 84)) {
            let condition =
                "G18 or G19 is in force, where a cycle is along Z or along the normal of the plane";
            let remedy = "write G17 before, or state `dialect = \"rs274ngc\"` of the control";
            return Err(combination(word, condition, remedy));
        }
        if block.code_of(Group::Length).is_some() {
            let condition =
                "its block changes the length offset, before or after its initial level is taken";
            let remedy = "write G43 or G49 in a block before";
            return Err(combination(word, condition, remedy));
        }
        if let Some(thread) = thread_of(number)
            && !self.can_tap(thread)
        {
            let condition =
                "the spindle does not turn into the thread, which some controls start themselves";
            let remedy = "write M3 before G84, M4 before G74, or M29 for rigid tapping";
            return Err(combination(word, condition, remedy));
        }
        // Fanuc ends G86 by turning the spindle clockwise (parameter 5112).
        if number == 86
            && self.spindle(false) == Spindle::CounterClockwise
            && matches!(self.stated(Rule::Dialect), None | Some(Choice::Iso))
        {
            let condition =
                "the spindle turns counter-clockwise, which it does not do after it on Fanuc";
            let remedy = "post the hole with its motions";
            return Err(combination(word, condition, remedy));
        }
        Ok(())
    }

    /// Refuses a cycle under another state than that of its series.
    fn check_series(&self, block: &Block, word: &str) -> Result<(), GcodeFault> {
        // On Fanuc and Haas rotary axes turn to the place of the hole with X and Y.
        let is_refused = self.stated(Rule::Dialect) != Some(Choice::Iso);
        let rotary = AXES[3..].iter().find(|letter| is_refused && block.has(**letter));
        let changed = self
            .cycle
            .as_ref()
            .is_some_and(|cycle| *cycle.state != *self.state || cycle.unit != self.modal.unit);
        let (word, condition, remedy) = match rotary {
            Some(letter) => (
                letter.to_string(),
                "a canned cycle is in force",
                "turn the axis in a block before, with G80",
            ),
            None if self.state.tcp != Tcp::Off => {
                (word.to_owned(), "tool centre point control is on", self.tcp_remedy())
            }
            None if changed => (
                word.to_owned(),
                "coordinates, unit or tool have changed since the series of cycles began",
                "write G80 before, and all words of the cycle again",
            ),
            None => return Ok(()),
        };
        Err(combination(word, condition, remedy))
    }

    /// Returns whether the control is one that repeats a cycle by L, so that it has another meaning for K (Haas).
    fn repeats_by_l(&self) -> bool {
        self.stated(Rule::Dialect) == Some(Choice::Iso)
            && self.stated(Rule::CycleRepeats) == Some(Choice::RepeatsByL)
    }

    /// Takes the words of the cycle. Those that are missing are the ones of the cycle before.
    fn cycle_words(&self, block: &mut Block, number: u32, word: &str) -> Result<Cycle, GcodeFault> {
        let known = self.cycle.as_ref();
        let mut incremental = self.modal.incremental;
        let dialect = self.stated(Rule::Dialect);
        // LinuxCNC asks for R and the depth again after another cycle.
        let is_linuxcnc = dialect == Some(Choice::Rs274Ngc);
        let usable = known.filter(|cycle| !is_linuxcnc || cycle.number == number);
        let normal = self.modal.plane.normal();
        let has = [AXES[normal], 'R'].map(|letter| block.has(letter));
        // Under the other distance mode the numbers had another meaning.
        if let Some(cycle) = usable.filter(|cycle| cycle.incremental != incremental)
            && has != [true; 2]
        {
            // Fanuc and Haas keep the levels, so that G91 repeats the hole along X and Y.
            if has != [false; 2] || cycle.incremental || dialect != Some(Choice::Iso) {
                let condition =
                    "its depth or R is of a block before, under the other one of G90 and G91,";
                let remedy = "write the depth and R in this block";
                return Err(combination(word, condition, remedy));
            }
            incremental = false;
        }
        let depth = self.take_length(block, AXES[normal]).or(usable.map(|cycle| cycle.depth));
        let retract = self.take_length(block, 'R').or(usable.map(|cycle| cycle.retract));
        let peck = match number {
            // The first peck of Haas, by how much less each of the next is, and the least: all on the way of a hole.
            73 | 83 if block.has('I') && self.repeats_by_l() => {
                block.take('J');
                block.take('K');
                block.take('Q');
                self.take_length(block, 'I')
            }
            73 | 74 | 83 | 84 => {
                // How much faster Haas retracts from a tapped hole, and after how many pecks, or from which depth, it retracts to R.
                if self.repeats_by_l() {
                    block.take(if matches!(number, 74 | 84) { 'J' } else { 'K' });
                }
                self.take_length(block, 'Q').or(known.and_then(|cycle| cycle.peck))
            }
            _ => known.and_then(|cycle| cycle.peck),
        };
        // The time of the dwell.
        block.take('P');
        let depth =
            depth.ok_or_else(|| missing(word, "the depth: Z in G17, Y in G18, X in G19"))?;
        let retract = retract.ok_or_else(|| missing(word, "the retract plane R"))?;
        if matches!(number, 73 | 83) && !peck.is_some_and(|peck| peck > 0.0) {
            return Err(missing(word, "a positive depth of peck Q"));
        }
        // G98 returns to the level before the first cycle of the series, whatever the others have left.
        let initial = known.map_or(self.position[normal], |cycle| cycle.initial);
        let (unit, state) = (self.modal.unit, Arc::clone(&self.state));
        Ok(Cycle { number, retract, depth, peck, incremental, initial, unit, state })
    }

    fn levels(&mut self, cycle: &Cycle) -> Result<Levels, GcodeFault> {
        let (retract, depth) = match cycle.incremental {
            false => (Some(cycle.retract), Some(cycle.depth)),
            true => {
                let retract = cycle.initial.map(|initial| initial + cycle.retract);
                (retract, retract.map(|retract| retract + cycle.depth))
            }
        };
        let is_inverted = match cycle.incremental {
            false => cycle.retract < cycle.depth,
            true => cycle.depth > 0.0,
        };
        if is_inverted {
            let (retract, depth) = (cycle.retract, cycle.depth);
            return Err(GcodeFault::CycleBelow { retract, depth });
        }
        let to_r = match self.modal.retract_to_r {
            Some(to_r) => to_r,
            // A cycle that begins at R returns there in either case.
            None if cycle.initial.is_some() && cycle.initial == retract => true,
            None => {
                self.notes.add_once(self.block(), NoteKind::AssumedMode { word: "G98 or G99" });
                self.choice(Rule::CycleReturn) == Choice::PlaneR
            }
        };
        let clear = match to_r {
            true => retract,
            // A level below R is left for R by a control that rises first.
            false
                if is_below(cycle.initial, retract)
                    && self.choice(Rule::CycleBelowR) == Choice::RaisesFirst =>
            {
                retract
            }
            false => retract.and(cycle.initial),
        };
        Ok(Levels { retract, depth, clear })
    }

    /// Moves over the next hole, at the present level. In a series, LinuxCNC moves straight to a level that is higher
    /// (`CYCLE_MACRO` of its interpreter).
    fn move_over(&mut self, axes: Position, Levels { retract, clear, .. }: Levels) {
        let normal = self.modal.plane.normal();
        let mut end = self.position;
        let mut commanded = [false; 6];
        if self.cycle.is_some()
            && !is_below(retract, end[normal])
            && is_below(end[normal], clear)
            && self.choice(Rule::CycleBelowR) == Choice::RaisesFirst
        {
            end[normal] = clear;
            commanded[normal] = true;
        }
        for axis in self.modal.plane.axes().into_iter().chain(3..AXES.len()) {
            if let Some(value) = axes[axis] {
                let origin = if self.modal.incremental { end[axis] } else { Some(0.0) };
                end[axis] = origin.map(|origin| origin + value);
                commanded[axis] = true;
            }
        }
        if commanded.contains(&true) {
            self.push(true, end, commanded, StepPath::Line);
        }
    }

    pub(super) fn move_along(&mut self, axis: usize, rapid: bool, level: Option<f64>) {
        let mut end = self.position;
        end[axis] = level;
        let mut commanded = [false; 6];
        commanded[axis] = true;
        self.push(rapid, end, commanded, StepPath::Line);
    }

    /// Moves from the retract plane to the depth and back to the clear level.
    fn stroke(
        &mut self,
        number: u32,
        axis: usize,
        peck: Option<f64>,
        levels: Levels,
        strokes: f64,
    ) {
        let Levels { retract, depth, clear } = levels;
        if let (83, Some(peck), Some(from)) = (number, peck, retract) {
            for k in 1..strokes as u32 {
                let level = from - f64::from(k) * peck;
                self.move_along(axis, false, Some(level));
                self.move_along(axis, true, retract);
                self.move_along(axis, true, Some(level));
            }
        }
        self.move_along(axis, false, depth);
        match number {
            // LinuxCNC leaves the thread in one motion (`convert_cycle_g74_g84`).
            74 | 84 if self.stated(Rule::Dialect) == Some(Choice::Rs274Ngc) => {
                self.move_along(axis, false, clear);
            }
            // Tapping and boring leave the hole at feed rate.
            74 | 84 | 85 | 89 => {
                self.move_along(axis, false, retract);
                if clear != retract || clear.is_none() {
                    self.move_along(axis, true, clear);
                }
            }
            _ => self.move_along(axis, true, clear),
        }
        if let Some(thread) = thread_of(number) {
            self.end_tapping(Some(thread));
        }
    }
}

/// Returns the thread that a cycle taps.
fn thread_of(number: u32) -> Option<Thread> {
    match number {
        74 => Some(Thread::Left),
        84 => Some(Thread::Right),
        _ => None,
    }
}
