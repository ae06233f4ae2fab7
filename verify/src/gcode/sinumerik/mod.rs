//! Native programs of Sinumerik 840D (`.mpf`, `.spf`).
//!
//! ```text
//! text ──flow──▶ line ──statements, words──▶ block ──▶ control
//!                     ──cycles──▶ frames, holes ──▶ control
//! ```
//!
//! `flow` decides which line is next, `expression` and `variables` compute values, `words` builds the block of a line, `cycles` reads the
//! calls of CYCLE800 and of drilling cycles, and `table` has the words that are passed over and those that are refused.

mod cycles;
mod expression;
mod flow;
mod table;
mod text;
mod variables;
mod words;

use super::block::Block;
use super::control::{Control, Hole};
use super::error::{combination, missing, not_read};
use super::files::{self, CalledFolders, in_file, without_folder};
use super::interpreter::Progress;
use super::note::NoteKind;
use super::rules::{Choice, Rule};
use super::{ControlSetup, GcodeError, GcodeFault, Repeated, SubprogramFile, shown};
use expression::{Value, expression, number};
use flow::{Direction, Flow, Left, RepeatWords, Source, Structure, no_target, title};
use std::collections::HashMap;
use std::mem;
use std::sync::Arc;
pub(super) use table::has_effect;
pub(crate) use table::is_word;
use text::{Cursor, Start, start};
pub(crate) use variables::variable_name;
use variables::{Reference, Variables};

/// Meaning of native programs on every Sinumerik, whatever a control's file says about programs in ISO mode.
const NATIVE: [(Rule, Choice); 4] = [
    (Rule::Dialect, Choice::Sinumerik),
    // D1 is in force from the tool change on (MD20270), and there is no G43.
    (Rule::ToolLength, Choice::Always),
    (Rule::WholeNumbers, Choice::Units),
    // SUPA and G53 suppress frames, and no tool offset.
    (Rule::MachineCoordinates, Choice::WithLength),
];

/// The frame of tool vectors.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum OrientationFrame {
    /// ORIWKS.
    Workpiece,
    /// ORIMKS.
    Machine,
}

/// A program, and the place of its execution.
#[derive(Clone, Debug)]
pub(super) struct Program<'a> {
    flow: Flow<'a>,
    /// The callers of subprograms in other files.
    waiting: Vec<Waiting<'a>>,
    /// The text of the program, then the files of subprograms.
    sources: Vec<Arc<Source<'a>>>,
    files: &'a [SubprogramFile],
    /// The index of the text that is executed.
    file: usize,
    variables: Variables,
    block: Block,
    /// The number of the first switch for optional blocks.
    switch: Option<&'a str>,
    /// The cycle of `MCALL`, which each motion calls.
    modal_hole: Option<Hole>,
    /// ORIWKS or ORIMKS, once one is stated.
    orientation_frame: Option<OrientationFrame>,
    /// ORIAXES or ORIVECT, once one is stated.
    interpolation: Option<Choice>,
    /// The line of the `FOR` whose `ENDFOR` was executed last, until that line is executed.
    stepping: Option<usize>,
    /// The last value of each loop that counts, by the line of its `FOR`.
    ends: HashMap<usize, f64>,
    folders: CalledFolders,
}

/// A caller of a subprogram in another file.
#[derive(Clone, Debug)]
struct Waiting<'a> {
    flow: Flow<'a>,
    file: usize,
    stepping: Option<usize>,
    ends: HashMap<usize, f64>,
    /// The called program, before its first block.
    called: Flow<'a>,
    /// Executions that follow the present one.
    left: u32,
    /// Start of the variables of the caller.
    base: usize,
}

/// Returns whether a text is a native program of Sinumerik: whether it has a statement that no other language has, or, if the control is
/// stated to be one, a call by a name alone, or nothing of its ISO mode ([`is_of_iso_mode`], comments in brackets, `#`, `%`). Otherwise it
/// has no `#` either, which begins the parameters of others, and no line that begins with a number, as those of Heidenhain Klartext do.
/// Comments are not read.
pub(super) fn is_native(text: &str, is_stated: bool) -> bool {
    let (mut found, mut has_iso_mode) = (false, false);
    for line in text.lines() {
        if title(line).is_some_and(|name| name.len() > 7) {
            found = true;
            continue;
        }
        let parts = start(line);
        let mut words = parts.words;
        found |= parts.label.is_some();
        if !is_stated && words.peek().is_some_and(|byte| byte.is_ascii_digit()) {
            return false;
        }
        found |= is_stated && is_call(words);
        let mut is_first = true;
        while !words.is_at_end() {
            match words.byte() {
                Some(b'#') if !is_stated => return false,
                Some(b'#' | b'%') => {
                    has_iso_mode = true;
                    words.advance();
                }
                // A comment elsewhere, and the arguments of a call here, whose name was read before.
                Some(b'(') => {
                    has_iso_mode = true;
                    if words.bracketed([b'(', b')']).is_none() {
                        break;
                    }
                }
                Some(b'"') => {
                    if words.quoted().is_none() {
                        break;
                    }
                }
                Some(byte) if byte.is_ascii_alphabetic() || matches!(byte, b'_' | b'$') => {
                    has_iso_mode |= is_of_iso_mode(words);
                    found |= is_native_word(&mut words, is_first);
                    is_first = false;
                }
                Some(byte) if byte.is_ascii() => words.advance(),
                _ => break,
            }
        }
    }
    found || is_stated && !has_iso_mode
}

/// Returns whether a text begins with words of which Sinumerik executes one in its ISO mode only: in its own language it is another one,
/// or none. Words may follow each other without blanks.
fn is_of_iso_mode(mut words: Cursor) -> bool {
    loop {
        let letter = words.take_while(|byte| byte.is_ascii_alphabetic());
        let digits = words.take_while(|byte| byte.is_ascii_digit());
        if letter.len() != 1 || digits.is_empty() {
            return false;
        }
        let is_iso = match letter.as_bytes()[0].to_ascii_uppercase() {
            // G54.1 and its like: a decimal point follows.
            b'G' if words.byte() == Some(b'.') => true,
            b'G' => matches!(
                digits.trim_start_matches('0'),
                "10" | "15"
                    | "16"
                    | "20"
                    | "21"
                    | "28"
                    | "30"
                    | "43"
                    | "44"
                    | "49"
                    | "50"
                    | "51"
                    | "52"
                    | "65"
                    | "66"
                    | "67"
                    | "68"
                    | "69"
                    | "73"
                    | "76"
                    | "80"
                    | "81"
                    | "82"
                    | "83"
                    | "84"
                    | "85"
                    | "86"
                    | "87"
                    | "88"
                    | "89"
                    | "92"
                    | "98"
                    | "99"
                    | "291"
            ),
            b'M' => matches!(digits, "98" | "99"),
            b'H' | b'O' => true,
            _ => false,
        };
        if is_iso {
            return true;
        }
    }
}

/// Returns whether a line is the call of a subprogram: `NAME`, `NAME(…)`, `NAME P3` or `L100`.
fn is_call(mut words: Cursor) -> bool {
    let name = words.name();
    let is_number = name.len() > 1 && name.as_bytes()[1..].iter().all(u8::is_ascii_digit);
    let is_name = match name.as_bytes() {
        [b'L' | b'l', _, ..] => true,
        [first, second, ..] => first.is_ascii_alphabetic() && second.is_ascii_alphabetic(),
        _ => false,
    };
    let is_known = super::block::is_keyword(&name.to_ascii_uppercase());
    let is_alone = words.is_at_end() || matches!(words.byte(), Some(b'(' | b'P' | b'p'));
    is_name && !is_known && is_alone && (is_number || name.as_bytes()[0].is_ascii_alphabetic())
}

/// Passes over a name, and returns whether it begins a statement of Sinumerik alone: a word of the tables, a value after `=`, or one of
/// its work offsets.
fn is_native_word(words: &mut Cursor, is_first: bool) -> bool {
    let name = words.name();
    // O-words of LinuxCNC have statements of the same names.
    let is_o_word =
        name.starts_with(['O', 'o']) && name.len() > 1 && name.as_bytes()[1].is_ascii_digit();
    if is_o_word || name.eq_ignore_ascii_case("O") {
        words.take_while(|byte| byte != b'#' && byte.is_ascii());
        return false;
    }
    let is_offset = name.strip_prefix(['G', 'g']).is_some_and(|digits| {
        let is_settable = digits.len() == 3 && digits.starts_with('5');
        is_settable || matches!(digits, "153" | "290")
    });
    is_offset || table::is_marker(name, is_first) || words.take_assignment()
}

impl<'a> Program<'a> {
    /// Reads what holds for the whole text, which is not copied: its programs, its loops and branches.
    ///
    /// # Errors
    /// If two programs have one name, or a loop or a branch has no end or no begin.
    pub(super) fn new(
        text: &'a str,
        setup: &'a ControlSetup,
        control: &mut Control,
    ) -> Result<Program<'a>, GcodeError> {
        let files = &setup.subprograms[..];
        let mut sources = vec![Arc::new(Source::new(text)?)];
        for (index, file) in (1..).zip(files) {
            let source = Source::new(&file.text);
            let source = source
                .map_err(|error| GcodeError { line: 1, fault: in_file(files, index, error) })?;
            sources.push(Arc::new(source));
        }
        control.settle(&NATIVE);
        Ok(Program {
            flow: Flow::new(Arc::clone(&sources[0]), Repeated::new(setup)),
            waiting: Vec::new(),
            sources,
            files,
            file: 0,
            variables: Variables::new(&setup.variables),
            block: Block::default(),
            switch: None,
            modal_hole: None,
            orientation_frame: None,
            interpolation: None,
            stepping: None,
            ends: HashMap::new(),
            folders: CalledFolders::default(),
        })
    }

    /// Returns the number of the file of a called subprogram, if it is not in the program's.
    pub(super) fn called_file(&self) -> Option<usize> {
        (!self.waiting.is_empty()).then_some(self.file)
    }

    /// Returns the next line and its number.
    pub(super) fn next_line(&mut self) -> Result<Option<(usize, &'a str)>, GcodeError> {
        self.flow.next_line().map(Some)
    }

    /// Goes on behind the last line of the main program that was executed, out of all loops and calls, and returns whether it was not there.
    pub(super) fn go_past(&mut self) -> bool {
        let is_called = !self.waiting.is_empty();
        if is_called {
            let Waiting { flow, file, stepping, ends, .. } = self.waiting.swap_remove(0);
            (self.flow, self.file, self.stepping, self.ends) = (flow, file, stepping, ends);
            self.waiting.clear();
        }
        self.variables.leave_all();
        self.flow.go_past() || is_called
    }

    /// Goes on after the end of the loop that begins in a line, if one does.
    pub(super) fn leave_loop(&mut self, line: usize) {
        self.flow.go_to_partner(line);
    }

    /// Executes a line.
    pub(super) fn execute_line(
        &mut self,
        line: usize,
        text: &'a str,
        control: &mut Control,
    ) -> Result<Progress, GcodeFault> {
        control.set_line(self.called_file(), line);
        let Start { switch, mut words, .. } = start(text);
        let is_percent = words.byte() == Some(b'%') && words.rest().trim_end() == "%";
        if words.is_at_end() || is_percent {
            return Ok(Progress::GoesOn);
        }
        if let Some(digits) = switch {
            let first = *self.switch.get_or_insert(digits);
            // `/2` is a switch of its own.
            if first != digits {
                control.notes.add(control.block(), NoteKind::OptionalSwitches);
            }
            if control.choice(Rule::OptionalBlocks) == Choice::LeftOut {
                control.notes.add(control.block(), NoteKind::OmittedOptionalBlock);
                return Ok(Progress::GoesOn);
            }
            control.notes.add(control.block(), NoteKind::ExecutedOptionalBlock);
        }
        if let Some((structure, mut after)) = Structure::at(words) {
            self.structure(structure, &mut after, line)?;
            return end_of_line(&mut after).map(|()| Progress::GoesOn);
        }
        let mut after = words;
        let name = after.name();
        let is_word = name.as_bytes().get(1).is_some_and(|byte| !byte.is_ascii_digit());
        // A program of the user is found before a cycle of the control.
        let is_own = cycles::is_cycle(name) && self.called(name, &after)?.is_some();
        if is_word && !is_own && self.statement(name, &mut after, line, control)? {
            return end_of_line(&mut after).map(|()| Progress::GoesOn);
        }
        if name.eq_ignore_ascii_case("RET") {
            end_of_line(&mut after)?;
            return Ok(self.leave(control));
        }
        if let Some(callee) = self.called(name, &after)? {
            self.call(callee, &mut after)?;
            return end_of_line(&mut after).map(|()| Progress::GoesOn);
        }
        self.words(words, control)
    }

    /// Executes a statement of a loop or a branch.
    fn structure(
        &mut self,
        structure: Structure,
        words: &mut Cursor,
        line: usize,
    ) -> Result<(), GcodeFault> {
        let goes_on = match structure {
            Structure::If | Structure::While | Structure::Until => {
                expression(words, &self.variables)?.truth()?
            }
            Structure::For => self.count(words, line)?,
            Structure::EndFor => {
                self.stepping = Some(self.flow.partner_line(line));
                false
            }
            Structure::EndIf | Structure::Loop | Structure::Repeat => true,
            Structure::Else | Structure::EndWhile | Structure::EndLoop => false,
        };
        if !goes_on {
            self.flow.go_to_partner(line);
        }
        Ok(())
    }

    /// Executes `FOR` after that word, and returns whether the loop goes on.
    fn count(&mut self, words: &mut Cursor, line: usize) -> Result<bool, GcodeFault> {
        let is_step = self.stepping.take() == Some(line);
        let variable = self.assigned(words)?;
        let first = number(words, &self.variables)?;
        let value = match is_step {
            true => self.variables.get(variable)?.number()? + 1.0,
            false => first,
        };
        self.variables.set(variable, Value::Number(value))?;
        if !words.take_name("TO") {
            return Err(missing("FOR", "TO with the last value of its variable"));
        }
        let last = number(words, &self.variables)?;
        let before = match is_step {
            true => self.ends.get(&line).copied(),
            false => {
                self.ends.insert(line, last);
                Some(last)
            }
        };
        if before != Some(last) {
            let remedy = "write WHILE, or a last value that stays";
            return Err(combination("FOR", "its last value changes while it counts", remedy));
        }
        Ok(value <= last)
    }

    /// Reads a variable and the `=` after it.
    fn assigned(&self, words: &mut Cursor) -> Result<Reference, GcodeFault> {
        let name = { *words }.name();
        let Some(reference) = expression::reference(words, &self.variables, 0)? else {
            return Err(undefined(name));
        };
        match words.take_assignment() {
            true => Ok(reference),
            false => Err(missing(shown(name), "`=` and a value")),
        }
    }

    /// Executes a statement that begins with a name, and returns whether it is one.
    fn statement(
        &mut self,
        name: &str,
        words: &mut Cursor<'a>,
        line: usize,
        control: &mut Control,
    ) -> Result<bool, GcodeFault> {
        match name.to_ascii_uppercase().as_str() {
            "GOTO" | "GOTOF" | "GOTOB" | "GOTOC" | "GOTOS" => self.jump(name, words, line)?,
            // A line can have several conditions, each with its jump.
            "IF" => loop {
                let is_met = expression(words, &self.variables)?.truth()?;
                let jump = words.name();
                if is_met {
                    self.jump(jump, words, line)?;
                    if words.take_name("IF") {
                        words.take_while(|byte| byte != b';');
                    }
                    break;
                }
                jump_direction(jump)?;
                words.name();
                if !words.take_name("IF") {
                    break;
                }
            },
            "CASE" => self.case(words, line)?,
            "REPEAT" | "REPEATB" => {
                let is_block = name.len() == "REPEATB".len();
                let repeat = self.repeat_words(words, is_block)?;
                self.flow.repeat(repeat, line)?;
            }
            "ENDLABEL" => {}
            "DEF" => self.variables.define(words)?,
            "CALL" if words.take_name("BLOCK") => {
                let first = self.stated_name("CALL BLOCK", words)?;
                if !words.take_name("TO") {
                    return Err(missing("CALL BLOCK", "two labels with TO between"));
                }
                let last = Some(self.stated_name("CALL BLOCK", words)?);
                let repeat = RepeatWords { first, last, is_block: false, times: 1 };
                self.flow.repeat(repeat, line)?;
            }
            "CALL" => {
                words.peek();
                let called = match words.quoted() {
                    Some(quoted) => quoted,
                    None => self.stated_name("CALL", words)?,
                };
                self.folders.check(called, flow::plain_name(called))?;
                match self.subprogram(called)? {
                    Some(callee) => self.call(callee, words)?,
                    None => return Err(no_subprogram(called)),
                }
            }
            "EXTCALL" => {
                let mut name = *words;
                if words.peek() == Some(b'(') {
                    let inner = words.bracketed([b'(', b')']).unwrap_or_default();
                    name = Cursor::new(inner);
                } else if words.peek() == Some(b'"') {
                    words.quoted();
                }
                name.peek();
                let name = name.quoted().unwrap_or_default();
                self.folders.check(name, flow::plain_name(without_folder(name)))?;
                let name = without_folder(name);
                match self.found(name, |file| file != self.file)? {
                    Some(callee) => self.call(callee, words)?,
                    None => return Err(no_subprogram(name)),
                }
            }
            "MCALL" if words.is_at_end() => self.modal_hole = None,
            "MCALL" => {
                let cycle = words.name();
                let is_own = self.subprogram(cycle)?.is_some();
                let hole = match is_own {
                    true => None,
                    false => cycles::hole(cycle, words, &self.variables)?,
                };
                let Some(hole) = hole else {
                    let meaning = "a modal call of another program than a drilling cycle";
                    return Err(not_read(
                        format!("MCALL {}", shown(cycle)),
                        meaning,
                        "call it after each position",
                    ));
                };
                control.check_hole(&hole)?;
                control.define_cycle();
                self.modal_hole = Some(hole);
            }
            "TRANS" | "ATRANS" | "ROT" | "AROT" => {
                let turn = self.frame_words(name, words)?;
                control.program_frame(turn)?;
            }
            "CYCLE800" => {
                let swivel = cycles::swivel(words, &self.variables)?;
                control.swivel(&swivel)?;
                self.flow.count_steps(control.pending.len())?;
            }
            _ => {
                let Some(hole) = cycles::hole(name, words, &self.variables)? else {
                    return Ok(false);
                };
                control.drill(&hole)?;
                self.flow.count_steps(control.pending.len())?;
            }
        }
        Ok(true)
    }

    /// Reads the name of a label or a program after a word.
    ///
    /// # Errors
    /// If it is missing, or that of a variable, whose text is the name.
    fn stated_name(&self, word: &str, words: &mut Cursor<'a>) -> Result<&'a str, GcodeFault> {
        let name = words.name();
        if !name.is_empty() && self.variables.find(name).is_none() {
            return Ok(name);
        }
        let remedy = "write the label, the block number or the program itself after it";
        Err(not_read(word.to_ascii_uppercase(), "a name that is computed", remedy))
    }

    /// Executes a jump after its word.
    fn jump(&mut self, word: &str, words: &mut Cursor<'a>, line: usize) -> Result<(), GcodeFault> {
        let direction = jump_direction(word)?;
        let target = self.stated_name(word, words)?;
        let is_found = self.flow.jump(target, line, direction)?;
        if !is_found && !word.eq_ignore_ascii_case("GOTOC") {
            return Err(no_target(target));
        }
        Ok(())
    }

    /// Executes `CASE(expression) OF value GOTOF label … DEFAULT GOTOF label` after its first word.
    fn case(&mut self, words: &mut Cursor<'a>, line: usize) -> Result<(), GcodeFault> {
        let value = number(words, &self.variables)?;
        if !words.take_name("OF") {
            return Err(missing("CASE", "OF after its expression"));
        }
        while !words.is_at_end() {
            let is_met = words.take_name("DEFAULT") || number(words, &self.variables)? == value;
            let jump = words.name();
            if is_met {
                self.jump(jump, words, line)?;
                words.take_while(|byte| byte != b';');
                return Ok(());
            }
            words.name();
        }
        Ok(())
    }

    /// Reads the labels of `REPEAT`, and how often.
    fn repeat_words(
        &self,
        words: &mut Cursor<'a>,
        is_block: bool,
    ) -> Result<RepeatWords<'a>, GcodeFault> {
        let first = words.name();
        if first.is_empty() {
            return Err(missing("REPEATB", "the label of its line"));
        }
        let mut ahead = *words;
        let second = ahead.name();
        let is_label = second.as_bytes().get(1).is_some_and(|byte| !byte.is_ascii_digit());
        let last = (is_label && !is_block).then_some(second);
        if last.is_some() {
            *words = ahead;
        }
        let times = self.times(words)?.unwrap_or(1);
        Ok(RepeatWords { first, last, is_block, times })
    }

    /// Reads how often a subprogram or a part is executed: `P3` or `P=3`.
    fn times(&self, words: &mut Cursor) -> Result<Option<u32>, GcodeFault> {
        if !matches!(words.peek(), Some(b'P' | b'p')) {
            return Ok(None);
        }
        words.advance();
        let value = match words.take_assignment() {
            true => number(words, &self.variables)?,
            false => {
                words.peek();
                expression::unsigned(words)?
            }
        };
        match value.fract() == 0.0 && (0.0..=9999.0).contains(&value) {
            true => Ok(Some(value as u32)),
            false => {
                let expected = "a whole number from 0 to 9999 after P";
                Err(GcodeFault::NotAllowed { word: 'P', value, expected })
            }
        }
    }

    /// Returns the subprogram that a line calls by its first name: `NAME`, `NAME(…)` or `L123`.
    fn called(&self, name: &str, after: &Cursor) -> Result<Option<Callee>, GcodeFault> {
        let mut after = *after;
        let is_call = after.is_at_end() || matches!(after.byte(), Some(b'(' | b'P' | b'p'));
        let is_named = name.len() > 1
            && (name.starts_with(['L', 'l']) || !name.as_bytes()[1].is_ascii_digit());
        let is_one = is_call && is_named && self.variables.find(name).is_none();
        if is_one { self.subprogram(name) } else { Ok(None) }
    }

    /// Returns the subprogram with a name, of all files.
    fn subprogram(&self, name: &str) -> Result<Option<Callee>, GcodeFault> {
        self.found(name, |_| true)
    }

    /// Returns the subprogram with a name, of the files that are `sought` by their numbers.
    ///
    /// # Errors
    /// If two files have it: which one a control takes depends on its folders.
    fn found(
        &self,
        name: &str,
        sought: impl Fn(usize) -> bool,
    ) -> Result<Option<Callee>, GcodeFault> {
        let in_file = |file: usize| match file {
            0 => self.sources[0].subprogram(name),
            file => self.sources[file].section(&self.files[file - 1], name),
        };
        let mut found = (0..self.sources.len())
            .filter(|file| sought(*file))
            .filter_map(|file| Some(Callee { file, section: in_file(file)? }));
        let first = found.next();
        if let (Some(first), Some(second)) = (first, found.next()) {
            let [first, second] =
                [first.file, second.file].map(|file| files::name(self.files, file).to_owned());
            return Err(GcodeFault::TwoFiles { label: name.to_owned(), first, second });
        }
        Ok(first)
    }

    /// Calls a subprogram with the arguments and the number of times that follow.
    fn call(&mut self, callee: Callee, words: &mut Cursor) -> Result<(), GcodeFault> {
        let arguments = cycles::arguments(words, &self.variables)?;
        let times = self.times(words)?;
        let parameters = self.sources[callee.file].parameters(callee.section);
        if times.is_some_and(|times| times > 1) && !parameters.is_empty() {
            let condition = "the subprogram has parameters";
            return Err(combination("P", condition, "call it once for each time"));
        }
        if times == Some(0) {
            return Ok(());
        }
        let times = times.unwrap_or(1);
        // A call that is too deep leaves the variables those of the caller.
        if callee.file == self.file {
            self.flow.call(callee.section, times, self.variables.base())?;
            self.variables.enter();
        } else {
            let source = Arc::clone(&self.sources[callee.file]);
            let called = self.flow.inside(source, callee.section)?;
            let base = self.variables.enter();
            let flow = mem::replace(&mut self.flow, called.clone());
            self.waiting.push(Waiting {
                flow,
                file: mem::replace(&mut self.file, callee.file),
                stepping: self.stepping.take(),
                ends: mem::take(&mut self.ends),
                called,
                left: times - 1,
                base,
            });
        }
        self.bind(parameters, arguments)
    }

    /// Gives the parameters of a subprogram the values of its call.
    fn bind(&mut self, parameters: &str, arguments: Vec<Option<Value>>) -> Result<(), GcodeFault> {
        let mut cursor = Cursor::new(parameters);
        let mut arguments = arguments.into_iter();
        while !cursor.is_at_end() {
            let value = arguments.next().flatten();
            self.variables.define_parameter(&mut cursor, value)?;
            if !cursor.take(b',') {
                break;
            }
        }
        match cursor.is_at_end() && arguments.all(|value| value.is_none()) {
            true => Ok(()),
            false => {
                let meaning = "more than the parameters of the subprogram";
                Err(not_read("an argument", meaning, "give as many as its PROC has"))
            }
        }
    }

    /// Ends the present program.
    fn leave(&mut self, control: &mut Control) -> Progress {
        match self.flow.leave() {
            Left::MainProgram if !self.waiting.is_empty() => self.leave_file(),
            Left::MainProgram => {
                if let Some(line) = self.flow.text_after_end() {
                    control.notes.add(line.into(), NoteKind::TextAfterEnd);
                }
                if let Some(line) = self.flow.other_program() {
                    control.notes.add(line.into(), NoteKind::OtherProgram);
                }
                return Progress::Ended;
            }
            // It has no parameters, and defines its variables again.
            Left::Again => self.variables.clear(),
            Left::Subprogram { base } => self.variables.leave(base),
        }
        Progress::GoesOn
    }

    /// Begins a program of another file again, or goes on after its call.
    fn leave_file(&mut self) {
        if let Some(caller) = self.waiting.last_mut().filter(|caller| caller.left > 0) {
            caller.left -= 1;
            let called = mem::replace(&mut self.flow, caller.called.clone());
            self.flow.go_on_after(&called);
            self.variables.clear();
        } else if let Some(caller) = self.waiting.pop() {
            let called = mem::replace(&mut self.flow, caller.flow);
            self.flow.go_on_after(&called);
            (self.file, self.stepping, self.ends) = (caller.file, caller.stepping, caller.ends);
            self.variables.leave(caller.base);
        }
    }
}

/// A subprogram that is called.
#[derive(Clone, Copy, Debug)]
struct Callee {
    file: usize,
    section: usize,
}

/// Refuses words after a statement.
fn end_of_line(words: &mut Cursor) -> Result<(), GcodeFault> {
    match words.is_at_end() {
        true => Ok(()),
        false => {
            let condition = "it stands after a statement that has its block for itself";
            Err(combination(shown(words.rest()), condition, "write it in a block before or after"))
        }
    }
}

/// Returns the fault of a name that is neither a variable nor a word.
fn undefined(name: &str) -> GcodeFault {
    let meaning = "no variable that DEF defines, and no address that is read";
    not_read(
        shown(name),
        meaning,
        "define it with DEF in the program, or post the program without it",
    )
}

/// Returns the fault of a subprogram that is not in the file.
fn no_subprogram(name: &str) -> GcodeFault {
    let meaning =
        "no word that is read, and no subprogram of this file or of those that the job names";
    not_read(
        shown(name),
        meaning,
        "name its file in `subprograms` of the job, or append it after a line `%_N_NAME_SPF`",
    )
}

/// Returns the direction of a jump by its word.
fn jump_direction(word: &str) -> Result<Direction, GcodeFault> {
    match word.to_ascii_uppercase().as_str() {
        "GOTOF" => Ok(Direction::Forward),
        "GOTOB" => Ok(Direction::Backward),
        "GOTO" | "GOTOC" => Ok(Direction::Both),
        // NC programming, jump to the start of the program: by a signal of the PLC the control goes on with the next block.
        "GOTOS" => Err(not_read(
            "GOTOS".to_owned(),
            "a jump that a signal of the machine allows",
            "write GOTOB and a label at the start",
        )),
        _ => Err(missing("IF", "a jump after its condition")),
    }
}
