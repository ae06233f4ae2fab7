//! The lines of a program, and the order in which they are executed: its extent in the file, its subprograms and their repeats.
//!
//! A subprogram of another file has a flow of its own, which its caller's flow waits for.

use super::line::{Label, MacroCall, Role, begin, begins_title, code, next};
use super::structure::{Structure, Subprogram};
use super::variables::{Locals, Variables};
use crate::gcode::error::combination;
use crate::gcode::files::name;
use crate::gcode::{FREE_STEPS, GcodeError, GcodeFault, MAX_CALLS, Repeated, SubprogramFile, work};
use std::collections::{BTreeMap, HashMap, HashSet};
use std::mem;
use std::sync::{Arc, OnceLock};
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

/// The extent of a program in its file.
#[derive(Clone, Copy, Debug)]
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
                *has_blocks |= has_effect(found);
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

/// A text: that of the program, or a file of subprograms.
#[derive(Debug)]
pub(super) struct Source<'a> {
    /// The label that its name stands for: that of `O9001.nc` or `9001.nc` is O9001, that of `probe.ngc` is `O<probe>`.
    label: Option<Label>,
    extent: Extent<'a>,
    pub(super) structure: Structure,
    /// The places of sequence numbers, once a line has asked for one.
    numbers: OnceLock<HashMap<u32, Vec<Place>>>,
}

impl<'a> Source<'a> {
    pub(super) fn new(
        file: Option<&SubprogramFile>,
        extent: Extent<'a>,
        structure: Structure,
    ) -> Source<'a> {
        let label = file.map(|file| Label::of_file(file.stem()));
        Source { label, extent, structure, numbers: OnceLock::new() }
    }

    pub(super) fn text(&self) -> &'a str {
        self.extent.text
    }

    /// Returns the place after the title with which the text begins, or that of its first line.
    fn body(&self) -> Place {
        let mut place = self.extent.start;
        while let Some((found, after)) = line(self.text(), place) {
            match next(&mut begin(found)) {
                Ok(Some(byte)) if begins_title(byte) => return after,
                Ok(None) => place = after,
                _ => break,
            }
        }
        self.extent.start
    }

    /// Returns the subprogram with a label. A file without titles is a subprogram under its own name, and LinuxCNC finds in a file the one
    /// that has its name.
    fn subprogram(&self, label: &Label, is_linuxcnc: bool) -> Option<Subprogram> {
        let has_name = self.label.as_ref() == Some(label);
        if is_linuxcnc && !has_name && self.label.is_some() {
            return None;
        }
        let known = self.structure.get(label).copied();
        known.or_else(|| {
            let is_whole = has_name && !is_linuxcnc && !self.structure.has_subprograms();
            is_whole.then(|| Subprogram { role: Role::Title, body: self.body(), after: None })
        })
    }

    fn sequence_numbers(&self) -> &HashMap<u32, Vec<Place>> {
        self.numbers.get_or_init(|| {
            let mut numbers: HashMap<u32, Vec<Place>> = HashMap::new();
            let mut place = Place { offset: 0, line: 1 };
            while let Some((line, after)) = line(self.text(), place) {
                if let Some(number) = sequence_number(line) {
                    numbers.entry(number).or_default().push(place);
                }
                // Execution cannot begin at the blocks after a semicolon, where one ends a block: as if their numbers stood twice.
                for number in line.split(';').skip(1).filter_map(sequence_number) {
                    numbers.entry(number).or_default().extend([place; 2]);
                }
                place = after;
            }
            numbers
        })
    }
}

/// Refuses a subprogram that two texts have. LinuxCNC finds in a file the one that has its name, and the others from there only.
pub(super) fn check_files(
    sources: &[Source],
    files: &[SubprogramFile],
    is_linuxcnc: bool,
) -> Result<(), GcodeError> {
    let mut known: HashMap<&Label, usize> = HashMap::new();
    for (index, source) in sources.iter().enumerate() {
        let has_titles = source.structure.has_subprograms();
        let titles = source.structure.labels().filter(|_| index == 0 || !is_linuxcnc);
        let own = source.label.as_ref().filter(|_| !has_titles || is_linuxcnc);
        for label in titles.chain(own) {
            if let Some(first) = known.insert(label, index) {
                let [first, second] = [first, index].map(|index| name(files, index).to_owned());
                let fault = GcodeFault::TwoFiles { label: label.to_string(), first, second };
                return Err(GcodeError { line: 1, fault });
            }
        }
    }
    Ok(())
}

/// A subprogram that is being executed.
#[derive(Clone, Debug)]
struct Call {
    label: Label,
    /// [`Role::Title`] for a program that M99 ends, [`Role::Sub`] for one of O-words.
    role: Role,
    body: Place,
    return_to: Place,
    /// Executions that follow the present one.
    repeats: u32,
    /// State of the caller that the subprogram does not have.
    hidden: Hidden,
}

/// State of a caller that a subprogram does not have.
#[derive(Clone, Debug)]
enum Hidden {
    /// All local variables, of which a macro has its own, and the macro that each motion calls.
    Macro { locals: Locals, modal: Option<MacroCall> },
    /// Names: it shares the numbered variables (M98).
    Names(BTreeMap<String, f64>),
}

/// A `repeat` that is being executed.
#[derive(Clone, Copy, Debug)]
struct Repeat {
    line: usize,
    /// The number of calls around it.
    depth: usize,
    remaining: u32,
}

/// A call of a subprogram.
#[derive(Debug)]
pub(super) struct Callee {
    pub(super) label: Label,
    /// [`Role::Title`] (M98, G65) or [`Role::Sub`] (`call`).
    pub(super) role: Role,
    /// The number of executions, once at least.
    pub(super) times: u32,
    /// Its own variables; `None` if it shares the numbered ones of the caller.
    pub(super) locals: Option<Locals>,
}

/// The place of execution in a text.
#[derive(Clone, Debug)]
pub(super) struct Flow<'a> {
    /// The text of the program, then the files of subprograms.
    sources: Arc<[Source<'a>]>,
    /// The index of the text that is executed.
    pub(super) file: usize,
    /// Set for a subprogram in another file than its caller.
    is_inner: bool,
    /// The number of calls in the flows that wait for this one.
    below: usize,
    place: Place,
    calls: Vec<Call>,
    repeats: Vec<Repeat>,
    /// The labels that were called, or passed as a `sub`.
    found: HashSet<Label>,
    /// The macro that each motion calls (G66).
    pub(super) modal: Option<MacroCall>,
    /// Set once the program has a title.
    titled: bool,
    /// Set once a block of the main program was executed.
    started: bool,
    /// The place after the last line of the main program that was executed.
    past: Place,
    /// Set if the present line was executed before, or is of a subprogram.
    is_repeated: bool,
    pub(super) repeated: Repeated,
}

impl<'a> Flow<'a> {
    /// Begins the first of several texts.
    pub(super) fn new(sources: Arc<[Source<'a>]>, repeated: Repeated) -> Flow<'a> {
        Flow {
            file: 0,
            is_inner: false,
            below: 0,
            place: sources[0].extent.start,
            calls: Vec::new(),
            repeats: Vec::new(),
            found: HashSet::new(),
            modal: None,
            titled: false,
            started: false,
            past: sources[0].extent.start,
            is_repeated: false,
            sources,
            repeated,
        }
    }

    fn source(&self) -> &Source<'a> {
        &self.sources[self.file]
    }

    fn text(&self) -> &'a str {
        self.source().text()
    }

    /// Returns the structure of the present text.
    pub(super) fn structure(&self) -> &Structure {
        &self.source().structure
    }

    /// Returns the flow of a subprogram in another file, before its call.
    pub(super) fn inside(&self, file: usize) -> Flow<'a> {
        Flow {
            file,
            is_inner: true,
            below: self.depth(),
            place: self.sources[file].extent.start,
            modal: self.modal.clone(),
            // Its blocks are those of a subprogram.
            started: true,
            titled: true,
            ..Flow::new(Arc::clone(&self.sources), self.repeated)
        }
    }

    /// Goes on after a call of a subprogram in another file, which has ended.
    pub(super) fn go_on_after(&mut self, called: &Flow<'a>) {
        self.repeated = called.repeated;
        self.modal.clone_from(&called.modal);
    }

    /// Returns whether a macro that a motion called (G66) is being executed.
    pub(super) fn is_in_modal_call(&self) -> bool {
        let is_modal = |call: &Call| matches!(call.hidden, Hidden::Macro { modal: Some(_), .. });
        self.calls.iter().any(is_modal)
    }

    /// Returns the number of calls that are being executed.
    fn depth(&self) -> usize {
        self.below + self.calls.len()
    }

    /// Returns whether a subprogram of this file has ended that another file has called.
    pub(super) fn is_left(&self) -> bool {
        self.is_inner && self.calls.is_empty()
    }

    /// Returns whether the end of the present subprogram leads to another file.
    pub(super) fn returns_to_file(&self) -> bool {
        self.is_inner && self.calls.len() == 1
    }

    /// Returns the next line and its number, or `None` where the text ends the program.
    ///
    /// # Errors
    /// If the text ends without an end of the program, with its last line; if too many blocks are repeated.
    pub(super) fn next_line(&mut self) -> Result<Option<(usize, &'a str)>, GcodeError> {
        let Some((line, after)) = line(self.text(), self.place) else {
            let is_whole = self.source().extent.closed && self.is_main();
            // The place is after the last line. An empty text has its fault in line 1.
            let last = self.place.line.max(2) - 1;
            return match is_whole {
                true => Ok(None),
                false => Err(GcodeError { line: last, fault: GcodeFault::Unfinished }),
            };
        };
        let number = self.place.line;
        self.place = after;
        self.is_repeated = !self.is_main() || number < self.past.line;
        if !self.is_repeated {
            self.past = after;
        }
        self.count(work(line)).map_err(|fault| GcodeError { line: number, fault })?;
        Ok(Some((number, line)))
    }

    /// Returns whether a subprogram stands before the present line, and was neither called nor passed as a `sub` so far.
    pub(super) fn has_passed(&self, label: &Label) -> bool {
        self.structure().get(label).is_some_and(|known| known.body.offset <= self.place.offset)
            && !self.found.contains(label)
    }

    /// Returns the subprogram with a label in the present text or, if that has none, in another one, with the index of the text.
    pub(super) fn find(&self, label: &Label, is_linuxcnc: bool) -> Option<(usize, Subprogram)> {
        if let Some(own) = self.structure().get(label) {
            return Some((self.file, *own));
        }
        let mut found =
            self.sources.iter().enumerate().filter_map(|(index, source)| {
                Some((index, source.subprogram(label, is_linuxcnc)?))
            });
        found.next()
    }

    /// Returns the program of a whole file.
    pub(super) fn whole(&self, file: usize) -> Subprogram {
        Subprogram { role: Role::Title, body: self.sources[file].body(), after: None }
    }

    /// Returns whether the main program is executed.
    pub(super) fn is_main(&self) -> bool {
        self.depth() == 0
    }

    /// Counts the block of the present line or its steps if it is repeated, or a long cycle. The others are limited by the text.
    pub(super) fn count(&mut self, number: usize) -> Result<(), GcodeFault> {
        let is_counted = self.is_repeated || number > FREE_STEPS;
        if is_counted { self.repeated.add(number) } else { Ok(()) }
    }

    /// Returns the line of text that follows the end of the main program and is no subprogram.
    pub(super) fn text_after_end(&self) -> Option<usize> {
        if !self.is_main() {
            return None;
        }
        let mut place = self.place;
        while let Some((line, after)) = line(self.text(), place) {
            let mut cursor = begin(line);
            match next(&mut cursor) {
                // Subprograms are read before, and another program has a note of its own.
                Ok(Some(byte)) if begins_title(byte) => return None,
                Ok(None) => place = after,
                _ => return Some(place.line),
            }
        }
        None
    }

    /// Returns the line of the title of another main program of the file than the first: one that was not called, and ends as such, or calls
    /// others or changes the tool, as one that begins anew does.
    pub(super) fn other_program(&self) -> Option<usize> {
        let source = &self.sources[0];
        let structure = &source.structure;
        let called = self.found.iter().filter_map(|label| structure.get(label));
        let called: HashSet<usize> = called.map(|known| known.body.line).collect();
        let first = source.body().line;
        let ends = |title: &Place| {
            let [_, last] = structure.program(title.line);
            let mut place = *title;
            while let Some((line, after)) =
                line(source.text(), place).filter(|_| place.line <= last)
            {
                if is_of_main(line) {
                    return true;
                }
                place = after;
            }
            false
        };
        let others = structure
            .titles
            .iter()
            .filter(|title| title.line >= first && !called.contains(&(title.line + 1)));
        others.filter(|title| ends(title)).map(|title| title.line).next()
    }

    /// Notes that a block of the main program is executed.
    pub(super) fn start(&mut self) {
        self.started = true;
    }

    /// Passes the title of a program.
    pub(super) fn title(&mut self, label: &Label) -> Result<(), GcodeFault> {
        match self.is_main() && !self.started && !self.titled {
            true => {
                self.titled = true;
                Ok(())
            }
            false => Err(GcodeFault::RunsInto { label: label.to_string() }),
        }
    }

    /// Passes over a subprogram of O-words.
    pub(super) fn pass_sub(&mut self, label: &Label) -> Result<(), GcodeFault> {
        if !self.is_main() || self.titled {
            return Err(GcodeFault::RunsInto { label: label.to_string() });
        }
        let after = self.structure().get(label).and_then(|known| known.after);
        self.found.insert(label.clone());
        self.place = after.ok_or_else(|| GcodeFault::Nesting {
            label: label.to_string(),
            word: "sub",
            problem: "its label depends on a parameter: write a number or a name",
        })?;
        Ok(())
    }

    /// Goes on at a place.
    pub(super) fn jump(&mut self, place: Place) {
        self.place = place;
    }

    /// Goes on behind the last line of the main program that was executed, and returns whether it was not there.
    pub(super) fn go_past(&mut self, variables: &mut Variables) -> bool {
        while let Some(call) = self.calls.pop() {
            self.end_call(call, variables);
        }
        self.repeats.clear();
        let is_behind = self.place.offset < self.past.offset;
        self.place = self.past;
        is_behind
    }

    /// Goes on after the line at a place.
    pub(super) fn jump_after(&mut self, place: Place) {
        self.place = line(self.text(), place).map_or(place, |(_, after)| after);
    }

    /// Returns the line at a place.
    pub(super) fn text_at(&self, place: Place) -> &'a str {
        line(self.text(), place).map_or("", |(line, _)| line)
    }

    /// Returns the place of a sequence number in the program that is executed.
    fn sequence(&self, number: u32, line_of_jump: usize) -> Result<Place, GcodeFault> {
        let [first, last] = self.structure().program(line_of_jump);
        let places = self.source().sequence_numbers().get(&number).map_or(&[][..], Vec::as_slice);
        // In the order of lines.
        let places = &places[places.partition_point(|place| place.line < first)..];
        let mut places = places.iter().take_while(|place| place.line <= last).copied();
        let Some(place) = places.next() else {
            return Err(GcodeFault::NoSequenceNumber { number });
        };
        match places.next() {
            // Controls seek from different places.
            Some(second) => {
                let (first, second) = (place.line, second.line);
                Err(GcodeFault::SecondSequenceNumber { number, first, second })
            }
            None => Ok(place),
        }
    }

    /// Obeys `GOTO` in a line.
    pub(super) fn go_to(&mut self, number: u32, line: usize) -> Result<(), GcodeFault> {
        let place = self.sequence(number, line)?;
        if !self.structure().can_jump(line, place.line) {
            let condition = "it leads into a loop (DO … END) from outside";
            return Err(combination(
                format!("GOTO {number}"),
                condition,
                "enter the loop by its DO",
            ));
        }
        self.place = place;
        Ok(())
    }

    /// Begins a `repeat`, and returns whether it is executed.
    pub(super) fn repeat(&mut self, line: usize, times: u32) -> bool {
        let remaining = times.saturating_sub(1);
        if times > 0 {
            self.repeats.push(Repeat { line, depth: self.calls.len(), remaining });
        }
        times > 0
    }

    /// Ends one execution of a `repeat`, and returns whether there is another.
    pub(super) fn end_repeat(&mut self, head: usize) -> bool {
        let depth = self.calls.len();
        match self.repeats.last_mut() {
            Some(repeat)
                if repeat.line == head && repeat.depth == depth && repeat.remaining > 0 =>
            {
                repeat.remaining -= 1;
                true
            }
            _ => {
                self.repeats.pop();
                false
            }
        }
    }

    /// Calls a subprogram of the present text with a title (M98, G65) or of O-words (`call`).
    pub(super) fn call(
        &mut self,
        subprogram: Subprogram,
        callee: Callee,
        variables: &mut Variables,
    ) -> Result<(), GcodeFault> {
        let Callee { label, role, times, locals } = callee;
        if subprogram.role != role {
            let label = label.to_string();
            let (what, remedy) = match role {
                Role::Sub => ("a program without `sub`", "call it by M98 P"),
                _ => ("a subprogram with `sub`", "call it by its O-word and `call`"),
            };
            return Err(GcodeFault::MixedCall { label, what, remedy });
        }
        self.found.insert(label.clone());
        self.enter(label, role, subprogram.body, times, locals, variables)
    }

    /// Calls the blocks from a sequence number of the same program on (M97).
    pub(super) fn call_local(
        &mut self,
        number: u32,
        times: u32,
        line: usize,
        variables: &mut Variables,
    ) -> Result<(), GcodeFault> {
        let body = self.sequence(number, line)?;
        self.enter(Label::Number(number), Role::Title, body, times, None, variables)
    }

    fn enter(
        &mut self,
        label: Label,
        role: Role,
        body: Place,
        times: u32,
        locals: Option<Locals>,
        variables: &mut Variables,
    ) -> Result<(), GcodeFault> {
        if self.depth() >= MAX_CALLS {
            return Err(GcodeFault::TooDeep);
        }
        let return_to = self.place;
        self.place = body;
        variables.is_called = true;
        let hidden = match locals {
            Some(locals) => Hidden::Macro {
                locals: mem::replace(&mut variables.locals, locals),
                modal: self.modal.take(),
            },
            None => Hidden::Names(mem::take(&mut variables.locals.named)),
        };
        self.calls.push(Call { label, role, body, return_to, repeats: times - 1, hidden });
        Ok(())
    }

    /// Refuses to leave a `repeat` of the present call that begins after a line. LinuxCNC keeps the number of executions that remain for
    /// its next time (`repeat_count`).
    fn check_repeats(&self, word: &'static str, line: usize) -> Result<(), GcodeFault> {
        let depth = self.calls.len();
        let is_left = |repeat: &Repeat| repeat.depth == depth && repeat.line > line;
        match self.repeats.iter().any(is_left) {
            true => {
                let condition = "a `repeat` is being executed, whose count LinuxCNC keeps";
                Err(combination(word, condition, "end the `repeat` before"))
            }
            false => Ok(()),
        }
    }

    /// Refuses `break` and `continue` of the loop that begins at a place where LinuxCNC does not execute them as such: in a program with
    /// `do` loops, which they end or go on with later (`doing_break`, `doing_continue`), and out of a `repeat`.
    pub(super) fn check_leaving(&self, head: Place, word: &'static str) -> Result<(), GcodeFault> {
        if self.sources.iter().any(|source| source.structure.has_do) {
            let condition = "the program has a `do` loop, which it can end, too";
            return Err(combination(word, condition, "write `while` loops, or `if` without it"));
        }
        self.check_repeats(word, head.line)
    }

    /// Obeys `endsub`, or `return`, whose label has no meaning.
    pub(super) fn end_sub(
        &mut self,
        label: &Label,
        word: &'static str,
        variables: &mut Variables,
    ) -> Result<(), GcodeFault> {
        match self.calls.last() {
            Some(call)
                if call.role == Role::Sub
                    && (call.label == *label || word == Role::Return.word()) =>
            {
                self.check_repeats(word, 0)?;
                self.leave(variables)
            }
            Some(call) if call.label == *label => Err(GcodeFault::MixedCall {
                label: label.to_string(),
                what: "a program without `sub`",
                remedy: "end it with M99",
            }),
            _ => {
                let remedy = "remove it, or add the `sub` that it ends";
                Err(GcodeFault::StrayReturn { word: format!("{label} {word}"), remedy })
            }
        }
    }

    /// Obeys M99 in a subprogram, with the sequence number of the caller at which it goes on (`M99 P`).
    pub(super) fn end_subprogram(
        &mut self,
        target: Option<u32>,
        line: usize,
        variables: &mut Variables,
    ) -> Result<(), GcodeFault> {
        self.check_repeats("M99", 0)?;
        match (self.calls.last(), target) {
            (Some(call), _) if call.role == Role::Sub => Err(GcodeFault::MixedCall {
                label: call.label.to_string(),
                what: "a subprogram with `sub`",
                remedy: "end it with its O-word and `endsub`",
            }),
            (Some(_), Some(number)) => {
                self.abandon(variables)?;
                self.return_to(number)
            }
            (Some(_), None) => self.leave(variables),
            (None, Some(number)) => self.go_to(number, line),
            (None, None) => Ok(()),
        }
    }

    /// Ends the present subprogram, whatever repeats of it were to follow.
    pub(super) fn abandon(&mut self, variables: &mut Variables) -> Result<(), GcodeFault> {
        if let Some(call) = self.calls.last_mut() {
            call.repeats = 0;
        }
        self.leave(variables)
    }

    /// Goes on at a sequence number, after a call in the line before.
    pub(super) fn return_to(&mut self, number: u32) -> Result<(), GcodeFault> {
        self.place = self.sequence(number, self.place.line.max(2) - 1)?;
        Ok(())
    }

    /// Repeats the subprogram, or returns to its caller.
    fn leave(&mut self, variables: &mut Variables) -> Result<(), GcodeFault> {
        self.repeated.add(1)?;
        match self.calls.last_mut() {
            Some(call) if call.repeats > 0 => {
                call.repeats -= 1;
                self.place = call.body;
                // Each execution is a call of its own (`enter_context`).
                if matches!(call.hidden, Hidden::Names(_)) {
                    variables.locals.named.clear();
                }
            }
            Some(Call { hidden: Hidden::Macro { .. }, .. }) if self.modal.is_some() => {
                let condition = "G66 of the macro is in force, and stays so in the caller";
                return Err(combination("M99", condition, "write G67 before"));
            }
            _ => {
                if let Some(call) = self.calls.pop() {
                    self.end_call(call, variables);
                }
            }
        }
        Ok(())
    }

    /// Returns to the caller.
    fn end_call(&mut self, call: Call, variables: &mut Variables) {
        self.place = call.return_to;
        variables.is_called = self.depth() > 0;
        match call.hidden {
            Hidden::Macro { locals, modal } => {
                let own = mem::replace(&mut variables.locals, locals);
                // A modal call does not set the arguments anew (B-63944EN, restrictions of G66).
                self.modal = modal.map(|call| MacroCall { arguments: own.numbered, ..call });
            }
            Hidden::Names(names) => variables.locals.named = names,
        }
    }
}

/// Returns the number of a line that begins with N, or with comments and N.
fn sequence_number(line: &str) -> Option<u32> {
    let mut line = line.trim_start();
    if let Some(rest) = line.strip_prefix('/') {
        line = rest.trim_start_matches(|c: char| c.is_ascii_digit()).trim_start();
    }
    while let Some(comment) = line.strip_prefix('(') {
        line = comment.split_once(')')?.1.trim_start();
    }
    let digits = line.strip_prefix(['N', 'n'])?.trim_start();
    let end = digits.find(|c: char| !c.is_ascii_digit()).unwrap_or(digits.len());
    digits[..end].parse().ok()
}

/// Returns whether a line has a word that main programs have: M2 or M30, M6, or a call (M97, M98, M198, G65, G66).
fn is_of_main(line: &str) -> bool {
    let code = code(line).unwrap_or_default();
    let has = |letter: char, numbers: &[u32]| {
        code.split(letter).skip(1).any(|word| {
            let end = word.find(|c: char| !c.is_ascii_digit()).unwrap_or(word.len());
            word[..end].parse().is_ok_and(|number: u32| numbers.contains(&number))
        })
    };
    has('M', &[2, 6, 30, 97, 98, 198]) || has('G', &[65, 66])
}

/// Returns whether a line has a G or M word, or the position of an axis.
fn has_effect(line: &str) -> bool {
    let code = code(line).unwrap_or_default();
    code.as_bytes().windows(2).any(|pair| {
        b"GMXYZABC".contains(&pair[0]) && (pair[1].is_ascii_digit() || b"+-.[#".contains(&pair[1]))
    })
}
