//! The lines of a program, and the order in which they are executed: its extent in the file, its subprograms and their repeats.

use super::expression::Parameters;
use super::line::{Label, Line, OWord, Role, begin, next, o_word};
use crate::gcode::block::{Block, Group};
use crate::gcode::{GcodeError, GcodeFault, MAX_CALLS, MAX_REPEATED};
use std::collections::{HashMap, HashSet};
use touchoff::Unit;

/// A place in the text: the byte at which a line begins, and its number from 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::gcode) struct Place {
    pub(in crate::gcode) offset: usize,
    pub(in crate::gcode) line: usize,
}

/// Returns the line at a place, and the place after it. Lines end in LF or CRLF.
pub(in crate::gcode) fn line(text: &str, place: Place) -> Option<(&str, Place)> {
    let rest = text.get(place.offset..).filter(|rest| !rest.is_empty())?;
    let (found, length) = match rest.split_once('\n') {
        Some((found, _)) => (found, found.len() + 1),
        None => (rest, rest.len()),
    };
    let after = Place { offset: place.offset + length, line: place.line + 1 };
    Some((found.strip_suffix('\r').unwrap_or(found), after))
}

/// Returns the text of a line before the first semicolon.
pub(super) fn before_semicolon(line: &str) -> &str {
    line.split(';').next().unwrap_or_default()
}

/// Returns whether a line is the `%` that encloses a program. A name may follow the first one.
fn is_percent(line: &str, is_first: bool) -> bool {
    match line.trim().strip_prefix('%') {
        Some("") => true,
        Some(rest) => {
            let rest = rest.trim();
            rest.starts_with(['(', ';'])
                || is_first && rest.chars().all(|c| c.is_ascii_alphanumeric() || c == '_')
        }
        None => false,
    }
}

/// Returns the unit of the head of a DIN/ISO program of Heidenhain, `%NAME G71 *`, or of its last line, which a block number
/// may precede.
fn head(line: &str) -> Option<Unit> {
    let line = line.trim().trim_end_matches('*').trim_end();
    let line = match line.strip_prefix(['N', 'n']) {
        Some(rest) => rest.trim_start_matches(|c: char| c.is_ascii_digit()).trim_start(),
        None => line,
    };
    let (name, unit) = line.strip_prefix('%')?.trim_end().rsplit_once(char::is_whitespace)?;
    match unit.to_ascii_uppercase().as_str() {
        _ if !name.chars().all(|c| c.is_ascii_alphanumeric() || "_-. ".contains(c)) => None,
        "G70" => Some(Unit::Inch),
        "G71" => Some(Unit::Millimetre),
        _ => None,
    }
}

/// Returns whether a line has no words: it is blank, or one comment.
fn is_empty(line: &str) -> bool {
    let line = line.trim();
    line.is_empty()
        || line.starts_with(';')
        || line.starts_with('(') && line.find(')') == Some(line.len() - 1)
}

/// Reads a line on its own, as far as it depends on no parameter.
fn block(line: &str) -> Option<Block> {
    let mut parsed = Line::default();
    parsed.parse(line, &mut Parameters::default()).ok().map(|()| parsed.block)
}

/// The extent of a program in its file.
#[derive(Debug)]
pub(super) struct Extent<'a> {
    /// The text without what follows the last `%`.
    pub(super) text: &'a str,
    /// The first line of the program.
    start: Place,
    /// Set if `%` ends the program.
    closed: bool,
    /// The line of the first text after it, and whether there are blocks in that text.
    pub(super) left_out: Option<(usize, bool)>,
    /// The unit that the head states.
    pub(super) unit: Option<Unit>,
}

/// Finds the first line and the end of a program.
pub(super) fn extent(text: &str) -> Extent<'_> {
    let mut extent = Extent {
        text,
        start: Place { offset: 0, line: 1 },
        closed: false,
        left_out: None,
        unit: None,
    };
    let mut place = extent.start;
    let mut is_first = true;
    while let Some((found, after)) = line(text, place) {
        if extent.closed {
            if !found.trim().is_empty() && !is_percent(found, false) {
                let (_, has_blocks) = extent.left_out.get_or_insert((place.line, false));
                *has_blocks |= block(found).is_some_and(|block| block.has_effect());
            }
        } else if is_percent(found, is_first) || head(found).is_some() {
            if is_first {
                (extent.start, extent.unit) = (after, head(found));
            } else {
                extent.text = &text[..place.offset];
                extent.closed = true;
            }
        }
        // Comments may stand before the head.
        is_first &= is_empty(found);
        place = after;
    }
    extent
}

/// A subprogram.
#[derive(Clone, Copy, Debug)]
struct Subprogram {
    /// [`Role::Title`] or [`Role::Sub`].
    role: Role,
    /// The line after the label.
    body: Place,
    /// The line after `endsub`.
    after: Option<Place>,
}

/// The subprograms of a file.
#[derive(Clone, Debug, Default)]
struct Subprograms {
    known: HashMap<Label, Subprogram>,
}

impl Subprograms {
    /// Finds the labels of a text. Lines that are not understood are left to the interpreter.
    ///
    /// # Errors
    /// A label that stands twice, a `sub` in another, a `sub` without `endsub`; each with its line.
    fn find(text: &str) -> Result<Subprograms, GcodeError> {
        let mut found = Subprograms::default();
        let mut lines: HashMap<Label, usize> = HashMap::new();
        let mut open: Option<(Label, usize)> = None;
        let mut place = Place { offset: 0, line: 1 };
        while let Some((line, after)) = line(text, place) {
            let at = place.line;
            place = after;
            let mut cursor = begin(line);
            if !matches!(next(&mut cursor), Ok(Some(b'O' | b'o'))) {
                continue;
            }
            // A label that is an expression can only be called.
            let Ok(OWord { label, role }) = o_word(&mut cursor, &Parameters::default()) else {
                continue;
            };
            match (role, &open) {
                (Role::Call, _) => {}
                (Role::Sub, Some(_)) => {
                    let problem = "it stands in another subprogram: end that with endsub before";
                    return Err(nesting(at, &label, "sub", problem));
                }
                (Role::Sub | Role::Title, _) => {
                    if let Some(first) = lines.insert(label.clone(), at) {
                        let fault = GcodeFault::SecondLabel { label: label.to_string(), first };
                        return Err(GcodeError { line: at, fault });
                    }
                    if role == Role::Sub {
                        open = Some((label.clone(), at));
                    }
                    found.known.insert(label, Subprogram { role, body: after, after: None });
                }
                (Role::EndSub, Some((opened, _))) if *opened == label => {
                    if let Some(known) = found.known.get_mut(&label) {
                        known.after = Some(after);
                    }
                    open = None;
                }
                (Role::EndSub, Some(_)) => {
                    let problem = "another subprogram is open: end that before";
                    return Err(nesting(at, &label, "endsub", problem));
                }
                // The end of a subprogram that has a title is refused where it is executed.
                (Role::EndSub, None) => {}
            }
        }
        match open {
            Some((label, at)) => Err(nesting(at, &label, "sub", "it has no endsub: add it")),
            None => Ok(found),
        }
    }

    /// Returns whether there is one.
    fn is_known(&self) -> bool {
        !self.known.is_empty()
    }

    fn get(&self, label: &Label) -> Option<&Subprogram> {
        self.known.get(label)
    }
}

/// Returns the error of a `sub` or `endsub` at a wrong place.
fn nesting(line: usize, label: &Label, word: &'static str, problem: &'static str) -> GcodeError {
    GcodeError { line, fault: GcodeFault::Nesting { label: label.to_string(), word, problem } }
}

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
    pub(super) fn new(extent: &Extent<'a>) -> Result<Flow<'a>, GcodeError> {
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
    pub(super) fn next_line(&mut self) -> Result<Option<(usize, &'a str)>, GcodeError> {
        let Some((line, after)) = line(self.text, self.place) else {
            let is_whole = self.closed && self.calls.is_empty();
            // The place is after the last line. An empty text has its fault in line 1.
            let last = self.place.line.max(2) - 1;
            return match is_whole {
                true => Ok(None),
                false => Err(GcodeError { line: last, fault: GcodeFault::Unfinished }),
            };
        };
        let number = self.place.line;
        self.place = after;
        self.count(1).map_err(|fault| GcodeError { line: number, fault })?;
        Ok(Some((number, line)))
    }

    /// Returns whether the text has subprograms.
    pub(super) fn has_subprograms(&self) -> bool {
        self.subprograms.is_known()
    }

    /// Returns whether a subprogram stands before the present line, and was neither called nor passed as a `sub` so far.
    pub(super) fn has_passed(&self, label: &Label) -> bool {
        self.subprograms.get(label).is_some_and(|known| known.body.offset <= self.place.offset)
            && !self.found.contains(label)
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
        while let Some((line, after)) = line(self.text, place) {
            let mut cursor = begin(line);
            match next(&mut cursor) {
                // Subprograms are read before, and another program has a note of its own.
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
        while let Some((line, after)) = line(self.text, place) {
            let mut cursor = begin(line);
            if let Ok(Some(b'O' | b'o')) = next(&mut cursor) {
                title = Some(place.line);
            } else if title.is_some() {
                let stop = block(line).and_then(|block| block.code_of(Group::Stop));
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

    /// Calls a subprogram with a title (M98) or of O-words (`call`), once at least.
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
        self.found.insert(label.clone());
        // Those that the subprogram has of its own begin without values.
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
