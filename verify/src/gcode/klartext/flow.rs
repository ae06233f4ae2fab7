//! The order in which blocks are executed: labels, their calls and repeats, and jumps.
//!
//! `CALL LBL n` executes the blocks after the label up to `LBL 0`. `CALL LBL n REP r` executes the section from the label to the call
//! r times more (TNC 640, *Klartext programming*, "Labeling subprograms and program section repeats"). `LBL 0` outside of a call does
//! nothing: "subprograms located before M2 or M30 will be executed at least once even if they are not called".

use super::expression::{Parameters, value};
use super::line::{Cursor, Place, begin, block};
use crate::gcode::error::{combination, missing};
use crate::gcode::{FREE_STEPS, GcodeError, GcodeFault, MAX_CALLS, Repeated, work};
use std::collections::HashMap;
use std::fmt;
use std::sync::Arc;

/// Largest number after REP.
const MAX_REPEATS: f64 = 65_534.0;

/// A label.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Label<'a> {
    Number(u32),
    Name(&'a str),
}

impl fmt::Display for Label<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Label::Number(number) => write!(f, "LBL {number}"),
            Label::Name(name) => write!(f, "LBL {}", crate::gcode::shown(name)),
        }
    }
}

/// Reads the number or the name of a label.
pub(super) fn label<'a>(
    cursor: &mut Cursor<'a>,
    known: &Parameters,
) -> Result<Label<'a>, GcodeFault> {
    if cursor.peek() == Some(b'"') {
        return Ok(Label::Name(cursor.quoted()?));
    }
    let mut start = *cursor;
    let number = value(cursor, known)?;
    match number.fract() == 0.0 && (0.0..=65_535.0).contains(&number) {
        true => Ok(Label::Number(number as u32)),
        false => Err(start.unexpected("a whole number from 0, or a name in quotation marks")),
    }
}

/// A subprogram that is being executed.
#[derive(Clone, Copy, Debug)]
struct Call {
    return_to: Place,
    /// The number of repeats that its caller has begun.
    repeats: usize,
}

/// A section that is being repeated.
#[derive(Clone, Copy, Debug)]
struct Repeat {
    /// Its first byte, and that of its last block.
    section: [usize; 2],
    /// Executions that follow the present one.
    left: u32,
}

/// The place of a label.
#[derive(Clone, Copy, Debug)]
struct Target {
    /// The place after it.
    after: Place,
    /// The first byte of its block.
    at: usize,
    /// The first byte before it from which on only labels stand, and comments.
    run: usize,
}

/// A block that is read before it is executed.
pub(super) struct Ahead<'a> {
    pub(super) cursor: Cursor<'a>,
    /// Set if it begins with `/`.
    pub(super) is_optional: bool,
    /// The place after it.
    pub(super) after: Place,
}

/// The place of execution in a text. A called program has a flow of its own, which its caller's flow waits for.
#[derive(Clone, Debug)]
pub(super) struct Flow<'a> {
    text: &'a str,
    /// The number of calls in the flows that wait for this one.
    below: usize,
    /// The next block.
    place: Place,
    /// The present block.
    present: Place,
    /// The place after the last block of the main program that was executed.
    past: Place,
    labels: Arc<HashMap<Label<'a>, Target>>,
    /// The bytes at which `LBL 0` stands, in order.
    ends: Arc<[usize]>,
    calls: Vec<Call>,
    repeats: Vec<Repeat>,
    /// Set if the present block was executed before, or is of a subprogram.
    is_repeated: bool,
    pub(super) repeated: Repeated,
}

impl<'a> Flow<'a> {
    /// Finds the labels of a text whose first block is at a place.
    ///
    /// # Errors
    /// A label that stands twice, with its line.
    pub(super) fn new(
        text: &'a str,
        start: Place,
        repeated: Repeated,
    ) -> Result<Flow<'a>, GcodeError> {
        let mut labels = HashMap::new();
        let mut ends = Vec::new();
        let mut lines: HashMap<Label, usize> = HashMap::new();
        let known = Parameters::new();
        let mut place = start;
        let mut run = start.offset;
        while let Some((found, after)) = block(text, place) {
            let at = std::mem::replace(&mut place, after);
            let (mut cursor, is_optional) = begin(found);
            if matches!(cursor.peek(), None | Some(b'*')) {
                continue;
            }
            let is_label = cursor.peek() == Some(b'L') && cursor.take_word("LBL");
            // A label that is not understood is refused where it is executed.
            let Some(label) = is_label.then(|| label(&mut cursor, &known).ok()).flatten() else {
                run = after.offset;
                continue;
            };
            if is_optional {
                run = after.offset;
            }
            if label == Label::Number(0) {
                ends.push(at.offset);
            } else if let Some(first) = lines.insert(label, at.line) {
                let fault = GcodeFault::SecondLabel { label: label.to_string(), first };
                return Err(GcodeError { line: at.line, fault });
            } else {
                labels.insert(label, Target { after, at: at.offset, run });
            }
        }
        Ok(Flow {
            text,
            below: 0,
            place: start,
            present: start,
            past: start,
            labels: Arc::new(labels),
            ends: ends.into(),
            calls: Vec::new(),
            repeats: Vec::new(),
            is_repeated: false,
            repeated,
        })
    }

    /// Begins a program that another flow calls.
    ///
    /// # Errors
    /// If it is called too deeply.
    pub(super) fn called_by(self, caller: &Flow) -> Result<Flow<'a>, GcodeFault> {
        // One for the call itself, which has no place here.
        let below = caller.below + caller.calls.len() + 1;
        match below <= MAX_CALLS {
            true => Ok(Flow { below, repeated: caller.repeated, ..self }),
            false => Err(GcodeFault::TooDeep),
        }
    }

    /// Goes on after the call of a program.
    pub(super) fn go_on_after(&mut self, called: &Flow) {
        self.repeated = called.repeated;
    }

    /// Returns the next block and its line.
    ///
    /// # Errors
    /// If the text ends without an end of the program, with its last line; if too many blocks are repeated.
    pub(super) fn next_block(&mut self) -> Result<(usize, &'a str), GcodeError> {
        let Some((found, after)) = block(self.text, self.place) else {
            let last = self.place.line.max(2) - 1;
            return Err(GcodeError { line: last, fault: GcodeFault::Unfinished });
        };
        self.present = self.place;
        self.place = after;
        let line = self.present.line;
        let is_called = self.below + self.calls.len() > 0;
        self.is_repeated = is_called || self.present.offset < self.past.offset;
        if !self.is_repeated {
            self.past = after;
        }
        self.count(work(found)).map_err(|fault| GcodeError { line, fault })?;
        Ok((line, found))
    }

    /// Goes on behind the last block of the main program that was executed, and returns whether it was not there.
    pub(super) fn go_past(&mut self) -> bool {
        let is_behind = !self.calls.is_empty() || self.place.offset < self.past.offset;
        self.place = self.past;
        self.calls.clear();
        self.repeats.clear();
        is_behind
    }

    /// Counts the present block or its steps if it is repeated, or a long cycle. The others are limited by the text.
    pub(super) fn count(&mut self, number: usize) -> Result<(), GcodeFault> {
        let is_counted = self.is_repeated || number > FREE_STEPS;
        if is_counted { self.repeated.add(number) } else { Ok(()) }
    }

    /// Returns the first block from a place on that is neither blank nor a comment.
    pub(super) fn ahead(&self, mut place: Place) -> Option<Ahead<'a>> {
        loop {
            let (found, after) = block(self.text, place)?;
            let (mut cursor, is_optional) = begin(found);
            if !matches!(cursor.peek(), None | Some(b'*')) {
                return Some(Ahead { cursor, is_optional, after });
            }
            place = after;
        }
    }

    /// Returns the place of the next block.
    pub(super) fn place(&self) -> Place {
        self.place
    }

    /// Goes on at a place.
    pub(super) fn go_on_at(&mut self, place: Place) {
        self.place = place;
    }

    fn find(&self, label: Label) -> Result<Place, GcodeFault> {
        let found = self.labels.get(&label).map(|target| target.after);
        found.ok_or_else(|| GcodeFault::NoLabel { label: label.to_string() })
    }

    /// Obeys `CALL LBL` without REP.
    pub(super) fn call(&mut self, label: Label) -> Result<(), GcodeFault> {
        let place = self.find(label)?;
        if self.below + self.calls.len() >= MAX_CALLS {
            return Err(GcodeFault::TooDeep);
        }
        self.calls.push(Call { return_to: self.place, repeats: self.repeats.len() });
        self.place = place;
        Ok(())
    }

    /// Obeys `CALL LBL n REP r`.
    pub(super) fn repeat(&mut self, label: Label, times: f64) -> Result<(), GcodeFault> {
        let place = self.find(label)?;
        let section = [place.offset, self.present.offset];
        let word = format!("REP of {label}");
        if section[0] > section[1] {
            let condition = "the label stands after the call";
            return Err(combination(word, condition, "write the call after the section"));
        }
        if self.ends_between(section[0], section[1]) {
            let condition = "LBL 0 stands in the section, which ends a subprogram";
            let remedy = "remove LBL 0, or write a CALL LBL without REP for each execution";
            return Err(combination(word, condition, remedy));
        }
        if times.fract() != 0.0 || !(0.0..=MAX_REPEATS).contains(&times) {
            let shown = format!("REP {times}");
            return Err(GcodeFault::Sentence { shown, expected: "a whole number from 0 to 65534" });
        }
        let own = self.calls.last().map_or(0, |call| call.repeats);
        let known = self.repeats[own..].iter().position(|known| known.section == section);
        let index = match known {
            Some(index) => own + index,
            None => {
                self.repeats.push(Repeat { section, left: times as u32 });
                self.repeats.len() - 1
            }
        };
        // Repeats that were begun in it have been left.
        self.repeats.truncate(index + 1);
        match self.repeats[index].left {
            0 => self.repeats.truncate(index),
            left => {
                self.repeats[index].left = left - 1;
                self.place = place;
            }
        }
        Ok(())
    }

    /// Obeys `GOTO LBL`.
    pub(super) fn jump(&mut self, label: Label) -> Result<(), GcodeFault> {
        let place = self.find(label)?;
        let own = self.calls.last().map_or(0, |call| call.repeats);
        // A section that is left begins anew the next time.
        let mut index = 0;
        self.repeats.retain(|repeat| {
            index += 1;
            index <= own || (repeat.section[0]..=repeat.section[1]).contains(&place.offset)
        });
        self.place = place;
        Ok(())
    }

    /// Returns whether only labels stand before a label that is next.
    pub(super) fn leads_to(&self, wanted: Label) -> bool {
        let Some(Target { at, run, .. }) = self.labels.get(&wanted) else { return false };
        let from = self.place.offset;
        // LBL 0 ends a subprogram.
        let is_ended = !self.calls.is_empty() && self.ends_between(from, *at);
        (*run..=*at).contains(&from) && !is_ended
    }

    /// Returns whether `LBL 0` begins at a byte or behind it, and before another byte.
    fn ends_between(&self, from: usize, to: usize) -> bool {
        let next = self.ends.partition_point(|end| *end < from);
        self.ends.get(next).is_some_and(|end| *end < to)
    }

    /// Obeys `LBL 0`.
    pub(super) fn end_subprogram(&mut self) {
        if let Some(call) = self.calls.pop() {
            self.repeats.truncate(call.repeats);
            self.place = call.return_to;
        }
    }

    /// Returns the line of the first text after the present block, and whether it is another program.
    pub(super) fn text_after(&self) -> Option<(usize, bool)> {
        let mut place = self.place;
        let mut first = None;
        while let Some((found, after)) = block(self.text, place) {
            if super::line::head(found).is_some() {
                return Some((place.line, true));
            }
            if !begin(found).0.is_at_end() {
                first.get_or_insert((place.line, false));
            }
            place = after;
        }
        first
    }
}

/// Reads `CALL LBL`, after these words.
pub(super) fn call<'a>(
    cursor: &mut Cursor<'a>,
    flow: &mut Flow<'a>,
    known: &Parameters,
) -> Result<(), GcodeFault> {
    let label = label(cursor, known)?;
    if label == Label::Number(0) {
        return Err(missing("CALL LBL", "another label than 0, which ends a subprogram"));
    }
    if !cursor.take_text("REP") {
        cursor.check_end()?;
        return flow.call(label);
    }
    let times = value(cursor, known)?;
    // Older controls write the executions that are left, too, as in `REP 5/5`.
    if cursor.take(b'/') {
        cursor.number()?;
    }
    cursor.check_end()?;
    flow.repeat(label, times)
}
