//! What stands in the way of a program beside the block that stops it.
//!
//! The execution goes on behind each error: without the words that are not read, if the rest of their block can be executed, or else with
//! the next block. From then on the state of the control can be another one than the program's. Errors that can follow from it are not
//! returned, and positions are not those of the program.

use super::control::Control;
use super::interpreter::{Interpreter, Language};
use super::note::Notes;
use super::{BlockLine, CompensationFault, GcodeError, GcodeFault, Step};
use std::collections::{HashSet, VecDeque};

/// Largest number of blocks and steps after the last block that was executed for the first time. A loop whose end depends on a block that
/// was not executed has no end: the program goes on behind it then.
const MAX_KNOWN: usize = 100_000;

/// An execution that goes on behind errors: an iterator over its steps, and over the errors that do not follow from what was left out.
/// [`Interpreter::survey`] makes one.
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
    /// Set once something was left out that can have changed the state of the control.
    is_uncertain: bool,
    /// The variables that blocks which were not executed would have assigned.
    left_open: HashSet<String>,
    /// Set if they can be any.
    leaves_all_open: bool,
}

impl<'a> Survey<'a> {
    /// Begins with the next block of an interpreter. `is_stopped` is set if that is the one which has stopped it.
    pub(super) fn new(interpreter: Interpreter<'a>, is_stopped: bool) -> Survey<'a> {
        let mut survey = Survey {
            interpreter,
            found: VecDeque::new(),
            faulty: HashSet::new(),
            executed: HashSet::new(),
            known: 0,
            is_uncertain: false,
            left_open: HashSet::new(),
            leaves_all_open: false,
        };
        if is_stopped {
            survey.execute();
            // The interpreter has returned it.
            survey.found.pop_front();
        }
        survey
    }

    /// Executes the next block.
    fn execute(&mut self) {
        // Its notes are not the program's, and each block copies the state: with them, the time would grow with the square of the errors.
        self.interpreter.control.notes = Notes::default();
        let before = self.interpreter.control.clone();
        let result = self.interpreter.execute_line();
        if self.executed.insert(self.interpreter.control.block()) {
            self.known = 0;
        }
        if let Err(error) = result {
            self.pass(error, before);
        }
    }

    /// Returns whether the state of the control can be another one than the program's.
    pub(crate) fn is_uncertain(&self) -> bool {
        self.is_uncertain
    }

    /// Goes on behind an error of the present block, and finds the others in it. `before` is the state before the block.
    fn pass(&mut self, mut error: GcodeError, before: Control) {
        let Some((_, text)) = self.interpreter.present else {
            // The text has ended. A caller in another file goes on.
            self.interpreter.finished = !self.interpreter.go_past();
            return;
        };
        let is_first = self.faulty.insert(self.interpreter.control.block());
        if is_first {
            // The first error of a survey is returned in any case.
            let is_sure = self.faulty.len() == 1 || self.is_sure(&error.fault, text);
            self.found.extend(is_sure.then(|| error.clone()));
        }
        let mut passed = Vec::new();
        let is_executed = loop {
            self.leaves_all_open |= error.fault.leaves_call_out();
            let word = error.fault.unread_word().map(str::to_owned);
            let Some(word) = word.filter(|word| !passed.contains(word)) else { break false };
            self.interpreter.control = before.clone();
            for word in passed.iter().chain([&word]) {
                self.interpreter.control.rules.pass_over(word);
            }
            passed.push(word);
            let Err(next) = self.interpreter.execute_again() else { break true };
            if next == error {
                // It cannot be passed over.
                break false;
            }
            // What follows a word of another kind than M can be its own.
            let can_be_own = passed.iter().any(|word| !is_m_word(word))
                && matches!(
                    next.fault.innermost(),
                    GcodeFault::Combination { .. } | GcodeFault::Missing { .. }
                );
            if is_first && !can_be_own && self.is_sure(&next.fault, text) {
                self.found.push_back(next.clone());
            }
            error = next;
        };
        self.is_uncertain |= !is_executed || passed.iter().any(|word| !is_m_word(word));
        if is_executed {
            for word in &passed {
                self.interpreter.control.rules.pass_over_no_longer(word);
            }
            return;
        }
        let BlockLine { line, within } = self.interpreter.control.block();
        self.interpreter.control = before;
        (self.interpreter.control.line, self.interpreter.control.within) = (line, within);
        self.leave_open(text);
        if !is_first {
            self.interpreter.leave_loop();
        }
        // Otherwise, execution would run into what follows.
        if let Some(end) = end_word(text) {
            let _ = self.interpreter.execute_instead(end);
            self.interpreter.control.pending.clear();
        }
    }

    /// Returns whether a fault of a block does not follow from what was left out.
    fn is_sure(&self, fault: &GcodeFault, text: &str) -> bool {
        if let Some(word) = fault.unread_word() {
            return !self.left_open.contains(&word.to_ascii_uppercase());
        }
        if !self.is_uncertain {
            return *fault.innermost() != GcodeFault::Unfinished;
        }
        if let GcodeFault::Compensation(CompensationFault::NoRadius { number }) = fault.innermost()
        {
            // Without D, it is that of the tool in the spindle.
            return text.to_ascii_uppercase().contains(&format!("D{number}"));
        }
        let is_open = |name: Name| {
            // Names of Sinumerik are those of its own program.
            let is_shared = !name.text.starts_with(|c: char| c.is_ascii_alphabetic())
                || name.text.ends_with(|c: char| c.is_ascii_digit() || c == '[');
            let can_be_any = self.leaves_all_open || name.is_computed && !self.left_open.is_empty();
            !name.is_assigned && (can_be_any && is_shared || self.left_open.contains(&name.text))
        };
        fault.is_of_block() && !names(text, self.interpreter.language()).any(is_open)
    }

    /// Notes the variables that a block would have assigned.
    fn leave_open(&mut self, text: &str) {
        let mut words = text.split(|c: char| !c.is_ascii_alphanumeric());
        let calls = ["G65", "G66", "M97", "M98", "M198", "CALL", "EXTCALL"];
        let is_call = |word: &str| calls.iter().any(|call| word.eq_ignore_ascii_case(call));
        self.leaves_all_open |= words.clone().any(is_call);
        let is_definition = words.any(|word| word.eq_ignore_ascii_case("DEF"));
        for name in names(text, self.interpreter.language()) {
            if name.is_assigned || is_definition {
                self.leaves_all_open |= name.is_computed;
                self.left_open.insert(name.text);
            }
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
            if self.interpreter.finished {
                return None;
            }
            if self.known > MAX_KNOWN {
                (self.known, self.is_uncertain) = (0, true);
                self.interpreter.finished = !self.interpreter.go_past();
                continue;
            }
            self.execute();
        }
    }
}

impl std::iter::FusedIterator for Survey<'_> {}

/// Returns whether a word is an M word.
fn is_m_word(word: &str) -> bool {
    word.strip_prefix(['M', 'm']).is_some_and(|rest| rest.starts_with(|c: char| c.is_ascii_digit()))
}

/// A variable in a block.
struct Name {
    /// In capitals, without blanks and leading zeros: `#5`, `#<DEPTH>`, `R5`, `DEPTH`; `#[` and `R[` for one whose number is computed.
    text: String,
    is_computed: bool,
    /// Set if `=` follows.
    is_assigned: bool,
}

/// Returns the variables in a block of a language.
fn names(text: &str, language: Language) -> impl Iterator<Item = Name> {
    let mut rest = text.split(';').next().unwrap_or_default().trim_start();
    // The number of the block.
    if let Some(number) = rest.strip_prefix(['N', 'n']) {
        rest = number.trim_start_matches(|c: char| c.is_ascii_digit());
    }
    let is_begin = move |c: char| match language {
        Language::Iso => c == '#',
        _ => c.is_ascii_alphabetic() || matches!(c, '$' | '_'),
    };
    std::iter::from_fn(move || {
        loop {
            rest = &rest[rest.find(is_begin)?..];
            let is_word = |c: char| c.is_ascii_alphanumeric() || matches!(c, '$' | '_');
            let letters = rest.find(|c: char| !c.is_ascii_alphabetic()).unwrap_or(rest.len());
            let is_numbered = match language {
                Language::Iso => true,
                Language::Klartext => {
                    matches!(&*rest[..letters].to_ascii_uppercase(), "Q" | "QL" | "QR" | "QS")
                }
                Language::Sinumerik => rest[..letters].eq_ignore_ascii_case("R"),
            };
            let prefix = if language == Language::Iso { 1 } else { letters };
            if !is_numbered {
                let end = rest.find(|c| !is_word(c)).unwrap_or(rest.len());
                let name = rest[..end].to_ascii_uppercase();
                rest = &rest[end..];
                // Words of one letter are addresses.
                if language == Language::Sinumerik && letters != 1 {
                    return Some(Name {
                        text: name,
                        is_computed: false,
                        is_assigned: assigns(rest),
                    });
                }
                continue;
            }
            let mut name = rest[..prefix].to_ascii_uppercase();
            rest = rest[prefix..].trim_start();
            if let Some(index) = rest.strip_prefix('[') {
                // Its index stays to be read, and what follows it says whether it is assigned.
                let after = rest.rsplit(']').next().unwrap_or_default();
                rest = index;
                name.push('[');
                return Some(Name { text: name, is_computed: true, is_assigned: assigns(after) });
            }
            let end = match rest.strip_prefix('<') {
                Some(inner) => inner.find('>').map_or(rest.len(), |at| at + 2),
                None => rest.find(|c: char| !c.is_ascii_digit()).unwrap_or(rest.len()),
            };
            let digits = rest[..end].replace(char::is_whitespace, "").to_ascii_uppercase();
            rest = &rest[end..];
            if !digits.is_empty() {
                name += match digits.trim_start_matches('0') {
                    "" => "0",
                    digits => digits,
                };
                return Some(Name { text: name, is_computed: false, is_assigned: assigns(rest) });
            }
        }
    })
}

/// Returns whether a text begins with `=`, and not with `==`.
fn assigns(text: &str) -> bool {
    text.trim_start().strip_prefix('=').is_some_and(|rest| !rest.starts_with('='))
}

/// Returns the word of a block that ends the program or a subprogram, without the others.
fn end_word(text: &str) -> Option<&str> {
    let code = text.split(';').next().unwrap_or_default();
    let trimmed = code.trim_start().trim_start_matches(|c: char| c.is_ascii_digit()).trim_start();
    if trimmed.get(..5).is_some_and(|start| start.eq_ignore_ascii_case("LBL 0")) {
        return Some("LBL 0");
    }
    let lower = code.to_ascii_lowercase();
    if lower.trim_start().starts_with('o') && (lower.contains("endsub") || lower.contains("return"))
    {
        return code.split('[').next();
    }
    let mut depth = 0;
    let mut before = ' ';
    for (at, c) in code.char_indices() {
        depth += i32::from(c == '(') - i32::from(c == ')');
        let is_word = depth == 0 && matches!(c, 'M' | 'm') && !before.is_ascii_alphabetic();
        before = c;
        if !is_word {
            continue;
        }
        let rest = &code[at + 1..];
        let end = rest.find(|c: char| !c.is_ascii_digit()).unwrap_or(rest.len());
        match rest[..end].parse() {
            Ok(2 | 30) => return Some("M30"),
            Ok(17) => return Some("M17"),
            Ok(99) => return Some("M99"),
            _ => {}
        }
    }
    let is_return = code.split_whitespace().any(|word| word.eq_ignore_ascii_case("RET"));
    is_return.then_some("RET")
}
