//! The order in which blocks are executed: subprograms and their repeats.

use super::block::{begin, next};
use super::code::Group;
use super::expression::Parameters;
use super::label::{Label, OWord, Place, Role, Subprogram, Subprograms};
use super::text::{self, Extent};
use super::{GcodeFault, MAX_CALLS, MAX_REPEATED};
use std::collections::HashSet;

/// A subprogram that is being executed.
#[derive(Clone, Debug)]
struct Call {
    label: Label,
    subprogram: Subprogram,
    return_to: Place,
    /// Executions that follow the present one.
    repeats: u32,
    /// The caller's parameters that the subprogram does not see.
    locals: Parameters,
}

/// The place of execution in a text.
#[derive(Clone, Debug)]
pub(super) struct Flow<'a> {
    text: &'a str,
    place: Place,
    closed: bool,
    subprograms: Subprograms,
    calls: Vec<Call>,
    /// The labels that were called, or passed as a `sub`.
    found: HashSet<Label>,
    /// Set once the program has a title.
    titled: bool,
    /// Set once a block of the main program was executed.
    started: bool,
    repeated: usize,
}

impl<'a> Flow<'a> {
    pub(super) fn new(extent: &Extent<'a>) -> Result<Flow<'a>, (usize, GcodeFault)> {
        Ok(Flow {
            text: extent.text,
            place: extent.start,
            closed: extent.closed,
            subprograms: Subprograms::find(extent.text)?,
            calls: Vec::new(),
            found: HashSet::new(),
            titled: false,
            started: false,
            repeated: 0,
        })
    }

    /// Returns the next line and its number, or `None` where the text ends the program.
    ///
    /// # Errors
    /// If the text ends without an end of the program, with its last line; if too many blocks are repeated.
    pub(super) fn next_line(&mut self) -> Result<Option<(usize, &'a str)>, (usize, GcodeFault)> {
        let Some((line, after)) = text::line(self.text, self.place) else {
            let is_whole = self.closed && self.calls.is_empty();
            let last = self.place.line.max(2) - 1;
            return if is_whole { Ok(None) } else { Err((last, GcodeFault::Unfinished)) };
        };
        let number = self.place.line;
        self.place = after;
        self.count(1).map_err(|fault| (number, fault))?;
        Ok(Some((number, line)))
    }

    /// Returns whether the text has subprograms.
    pub(super) fn has_subprograms(&self) -> bool {
        self.subprograms.is_known()
    }

    /// Returns whether a subprogram stands before the present line, and was neither called nor passed as a `sub` so far.
    pub(super) fn has_passed(&self, label: &Label) -> bool {
        let is_before = |known: &Subprogram| known.body.offset <= self.place.offset;
        self.subprograms.get(label).is_some_and(is_before) && !self.found.contains(label)
    }

    /// Returns whether there is a subprogram with a label.
    pub(super) fn has(&self, label: &Label) -> bool {
        self.subprograms.get(label).is_some()
    }

    /// Counts blocks or steps of a subprogram. Those of the main program are limited by its text.
    pub(super) fn count(&mut self, number: usize) -> Result<(), GcodeFault> {
        self.repeated += if self.calls.is_empty() { 0 } else { number };
        if self.repeated > MAX_REPEATED { Err(GcodeFault::TooLong) } else { Ok(()) }
    }

    /// Returns the line of text that follows the end of the main program and is no subprogram.
    pub(super) fn text_after_end(&self) -> Option<usize> {
        if !self.calls.is_empty() {
            return None;
        }
        let mut place = self.place;
        while let Some((line, after)) = text::line(self.text, place) {
            let (_, mut cursor) = begin(line);
            match next(&mut cursor) {
                Ok(Some(b'O' | b'o')) => return None,
                Ok(None) => place = after,
                _ => return Some(place.line),
            }
        }
        None
    }

    /// Returns the line of the title of another main program after the present one: one that ends as such.
    pub(super) fn other_program(&self) -> Option<usize> {
        let mut place = if self.calls.is_empty() { self.place } else { return None };
        let mut title = None;
        while let Some((line, after)) = text::line(self.text, place) {
            let (_, mut cursor) = begin(line);
            if let Ok(Some(b'O' | b'o')) = next(&mut cursor) {
                title = Some(place.line);
            } else if title.is_some() {
                let stop = text::block(line).and_then(|block| block.code_of(Group::Stop));
                if stop.is_some_and(|code| matches!(code.tenths, 20 | 300)) {
                    return title;
                }
            }
            place = after;
        }
        None
    }

    /// Notes that a block of the main program is executed.
    pub(super) fn start(&mut self) {
        self.started = true;
    }

    /// Obeys an O-word.
    pub(super) fn o_word(
        &mut self,
        word: OWord,
        parameters: &mut Parameters,
    ) -> Result<(), GcodeFault> {
        let OWord { label, role } = word;
        match role {
            Role::Call => self.call(label, Role::Sub, 1, parameters),
            Role::EndSub => self.end_sub(&label, parameters),
            Role::Title if self.calls.is_empty() && !self.started && !self.titled => {
                self.titled = true;
                Ok(())
            }
            Role::Sub if self.calls.is_empty() && !self.titled => {
                let known = self.subprograms.get(&label).and_then(|known| known.after);
                self.found.insert(label.clone());
                self.place = known.ok_or_else(|| GcodeFault::Nesting {
                    label: label.to_string(),
                    word: "sub",
                    problem: "its label depends on a parameter: write a number or a name",
                })?;
                Ok(())
            }
            Role::Title | Role::Sub => Err(GcodeFault::RunsInto { label: label.to_string() }),
        }
    }

    /// Calls a subprogram with a title (M98) or of O-words (`call`).
    pub(super) fn call(
        &mut self,
        label: Label,
        role: Role,
        times: u32,
        parameters: &mut Parameters,
    ) -> Result<(), GcodeFault> {
        let Some(subprogram) = self.subprograms.get(&label).copied() else {
            return Err(GcodeFault::NoSubprogram { label: label.to_string() });
        };
        if subprogram.role != role {
            let label = label.to_string();
            let (what, remedy) = match role {
                Role::Sub => ("a program without `sub`", "call it by M98 P"),
                _ => ("a subprogram with `sub`", "call it by its O-word and `call`"),
            };
            return Err(GcodeFault::MixedCall { label, what, remedy });
        }
        if self.calls.len() >= MAX_CALLS {
            return Err(GcodeFault::TooDeep);
        }
        if times == 0 {
            return Ok(());
        }
        self.found.insert(label.clone());
        let locals = parameters.take_locals(role == Role::Sub);
        let return_to = self.place;
        self.place = subprogram.body;
        self.calls.push(Call { label, subprogram, return_to, repeats: times - 1, locals });
        Ok(())
    }

    /// Obeys `endsub`.
    fn end_sub(&mut self, label: &Label, parameters: &mut Parameters) -> Result<(), GcodeFault> {
        match self.calls.last() {
            Some(call) if call.label == *label && call.subprogram.role == Role::Sub => {
                self.leave(parameters)
            }
            Some(call) if call.label == *label => Err(GcodeFault::MixedCall {
                label: label.to_string(),
                what: "a program without `sub`",
                remedy: "end it with M99",
            }),
            _ => {
                let remedy = "remove it, or add the `sub` that it ends";
                Err(GcodeFault::StrayReturn { word: format!("{label} endsub"), remedy })
            }
        }
    }

    /// Obeys M99.
    pub(super) fn end_subprogram(&mut self, parameters: &mut Parameters) -> Result<(), GcodeFault> {
        match self.calls.last() {
            Some(call) if call.subprogram.role == Role::Sub => Err(GcodeFault::MixedCall {
                label: call.label.to_string(),
                what: "a subprogram with `sub`",
                remedy: "end it with its O-word and `endsub`",
            }),
            Some(_) => self.leave(parameters),
            None => {
                let remedy = "end the main program with M30";
                Err(GcodeFault::StrayReturn { word: "M99".to_owned(), remedy })
            }
        }
    }

    /// Repeats the subprogram, or returns to its caller.
    fn leave(&mut self, parameters: &mut Parameters) -> Result<(), GcodeFault> {
        self.count(1)?;
        match self.calls.last_mut() {
            Some(call) if call.repeats > 0 => {
                call.repeats -= 1;
                self.place = call.subprogram.body;
            }
            _ => {
                if let Some(call) = self.calls.pop() {
                    self.place = call.return_to;
                    parameters.restore_locals(call.locals, call.subprogram.role == Role::Sub);
                }
            }
        }
        Ok(())
    }
}
