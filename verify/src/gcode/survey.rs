//! What stands in the way of a program beside the block that stops it.
//!
//! The execution goes on behind each error: without the word that is not read, if the rest of its block can be executed, or else with
//! the next block. The state of the control can be another one than the program's from then on, so that errors which depend on it are
//! not returned, and positions are not those of the program.

use super::interpreter::Interpreter;
use super::{BlockLine, GcodeError, GcodeFault, Step};
use std::collections::{HashSet, VecDeque};

/// Largest number of blocks and steps after the last block that was executed for the first time. A loop whose end depends on a block that
/// was not executed has no end.
const MAX_KNOWN: usize = 100_000;

/// An execution that goes on behind errors: an iterator over its steps, and over the errors that would be there whatever the blocks before
/// them. [`Interpreter::survey`] makes one.
#[derive(Clone, Debug)]
pub struct Survey<'a> {
    interpreter: Interpreter<'a>,
    /// Errors that are to be returned.
    found: VecDeque<GcodeError>,
    /// The blocks that had an error.
    faulty: HashSet<BlockLine>,
    /// The blocks that were executed.
    executed: HashSet<BlockLine>,
    /// The number of blocks and steps since the last new one.
    known: usize,
    /// The words of the blocks that were not executed, in capitals.
    skipped: HashSet<String>,
}

impl<'a> Survey<'a> {
    /// Begins with the block that has stopped an interpreter by an error, if one has, or with the next one.
    pub(super) fn new(interpreter: Interpreter<'a>, error: Option<GcodeError>) -> Survey<'a> {
        let mut survey = Survey {
            interpreter,
            found: VecDeque::new(),
            faulty: HashSet::new(),
            executed: HashSet::new(),
            known: 0,
            skipped: HashSet::new(),
        };
        if let Some(error) = error {
            survey.faulty.insert(survey.interpreter.control.block());
            survey.pass(&error);
        }
        survey
    }

    /// Goes on behind an error of the present block, and finds the others in it.
    fn pass(&mut self, error: &GcodeError) {
        let interpreter = &mut self.interpreter;
        interpreter.control.pending.clear();
        let Some((_, text)) = interpreter.present else {
            // The text has ended.
            interpreter.finished = true;
            return;
        };
        let mut passed = Vec::new();
        let mut error = error.clone();
        let is_executed = loop {
            let rules = &mut self.interpreter.control.rules;
            let word = error.fault.unread_word().map(str::to_owned);
            let Some(word) = word.filter(|word| rules.pass_over(word)) else { break false };
            passed.push(word);
            let Err(next) = self.interpreter.execute_again() else { break true };
            // Other words can be arguments of the one without which the block is read.
            if next != error && !matches!(next.fault.innermost(), GcodeFault::Combination { .. }) {
                self.add(next.clone());
            }
            error = next;
        };
        for word in passed {
            self.interpreter.control.rules.pass_over_no_longer(&word);
        }
        if !is_executed {
            self.interpreter.control.pending.clear();
            let words = text.split(|c: char| !c.is_ascii_alphanumeric() && !"_#<>$".contains(c));
            self.skipped.extend(words.map(str::to_ascii_uppercase));
        }
    }

    /// Keeps an error that would be there whatever the blocks before it.
    fn add(&mut self, error: GcodeError) {
        let fault = &error.fault;
        let is_left_open = |name: &str| self.skipped.contains(&name.to_ascii_uppercase());
        if fault.is_of_block() && !fault.missing_value().is_some_and(is_left_open) {
            self.found.push_back(error);
        }
    }
}

impl Iterator for Survey<'_> {
    type Item = Result<Step, GcodeError>;

    fn next(&mut self) -> Option<Self::Item> {
        loop {
            if let Some(error) = self.found.pop_front() {
                return Some(Err(error));
            }
            self.known += 1;
            if let Some(step) = self.interpreter.control.pending.pop_front() {
                return Some(Ok(step));
            }
            if self.interpreter.finished || self.known > MAX_KNOWN {
                return None;
            }
            let result = self.interpreter.execute_line();
            if self.executed.insert(self.interpreter.control.block()) {
                self.known = 0;
            }
            let Err(error) = result else { continue };
            if self.faulty.insert(self.interpreter.control.block()) {
                self.add(error.clone());
                self.pass(&error);
            } else {
                self.interpreter.control.pending.clear();
                self.interpreter.leave_loop();
            }
        }
    }
}

impl std::iter::FusedIterator for Survey<'_> {}
