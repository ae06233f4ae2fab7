//! The lines of a program, and the order in which they are executed: programs of a file, loops, jumps, repeats and calls.
//!
//! A file can have several programs, each after a line `%_N_NAME_MPF`, `%_N_NAME_SPF` or `PROC NAME`. The first main program is
//! executed. The places to which loops and branches go are found once; those of jumps when they are executed first.

use super::text::{Cursor, start};
use crate::gcode::error::{combination, missing, not_read};
use crate::gcode::iso::{Place, line};
use crate::gcode::{
    FREE_STEPS, GcodeError, GcodeFault, MAX_CALLS, Repeated, SubprogramFile, shown, work,
};
use std::collections::HashMap;
use std::hash::{DefaultHasher, Hasher};
use std::sync::{Arc, OnceLock};

/// A program of a file.
#[derive(Clone, Debug)]
pub(super) struct Section<'a> {
    /// Its name, empty for one without a title.
    name: &'a str,
    start: Place,
    /// The byte after its last line.
    end: usize,
    /// The parameters of `PROC`, as they are written.
    pub(super) parameters: &'a str,
}

/// A statement that opens or closes a part of the program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Structure {
    If,
    Else,
    EndIf,
    While,
    EndWhile,
    For,
    EndFor,
    Loop,
    EndLoop,
    Repeat,
    Until,
}

/// Their words. `IF` with a jump and `REPEAT` with a label open nothing.
const STRUCTURES: [(&str, Structure); 11] = [
    ("IF", Structure::If),
    ("ELSE", Structure::Else),
    ("ENDIF", Structure::EndIf),
    ("WHILE", Structure::While),
    ("ENDWHILE", Structure::EndWhile),
    ("FOR", Structure::For),
    ("ENDFOR", Structure::EndFor),
    ("LOOP", Structure::Loop),
    ("ENDLOOP", Structure::EndLoop),
    ("REPEAT", Structure::Repeat),
    ("UNTIL", Structure::Until),
];

impl Structure {
    /// Returns the statement that begins here, and the place after its word.
    pub(super) fn at(words: Cursor<'_>) -> Option<(Structure, Cursor<'_>)> {
        let mut after = words;
        let name = after.name();
        let (_, found) =
            STRUCTURES.into_iter().find(|(known, _)| name.eq_ignore_ascii_case(known))?;
        let opens = match found {
            Structure::If => !has_jump(after),
            Structure::Repeat => after.is_at_end(),
            _ => true,
        };
        opens.then_some((found, after))
    }

    /// Returns the statements that it closes.
    fn closes(self) -> &'static [Structure] {
        match self {
            Structure::Else => &[Structure::If],
            Structure::EndIf => &[Structure::If, Structure::Else],
            Structure::EndWhile => &[Structure::While],
            Structure::EndFor => &[Structure::For],
            Structure::EndLoop => &[Structure::Loop],
            Structure::Until => &[Structure::Repeat],
            _ => &[],
        }
    }

    fn opens(self) -> bool {
        self == Structure::Else || self.closes().is_empty()
    }

    fn word(self) -> &'static str {
        STRUCTURES.iter().find(|(_, known)| *known == self).map_or("", |(word, _)| word)
    }
}

/// Returns whether a jump follows in the line.
fn has_jump(mut words: Cursor) -> bool {
    while !words.is_at_end() {
        let name = words.name();
        if name.len() >= 4 && name[..4].eq_ignore_ascii_case("GOTO") {
            return true;
        }
        if name.is_empty() {
            if words.byte() == Some(b'"') && words.quoted().is_some() {
                continue;
            }
            // A character of several bytes stands in no statement.
            if !words.byte().is_some_and(|byte| byte.is_ascii()) {
                return false;
            }
            words.advance();
        }
    }
    false
}

/// The direction in which the target of a jump is sought.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Direction {
    /// To the end of the program (`GOTOF`).
    Forward,
    /// To its start (`GOTOB`).
    Backward,
    /// To the end, then from the start (`GOTO`, `GOTOC`).
    Both,
}

/// A subprogram that is being executed.
#[derive(Clone, Debug)]
struct Call {
    /// The program of the caller.
    caller: usize,
    return_to: Place,
    /// Executions that follow the present one.
    left: u32,
    /// Start of the variables of the caller.
    base: usize,
}

/// A part of the program that `REPEAT` executes again.
#[derive(Clone, Debug)]
struct Repeat {
    start: Place,
    /// Its last line.
    last: usize,
    return_to: Place,
    left: u32,
    /// The number of calls in which it stands.
    depth: usize,
}

/// A text, and what is found in it once.
#[derive(Debug)]
pub(super) struct Source<'a> {
    text: &'a str,
    sections: Vec<Section<'a>>,
    /// The programs by their names in capitals.
    names: HashMap<String, usize>,
    /// Targets of the statements that do not go on to the next line, by their lines.
    partners: HashMap<usize, Place>,
    /// The lines with a label or a block number, by the hash of its capitals, and then in their order; found at the first jump.
    labels: OnceLock<Vec<(u64, Place)>>,
    /// The program that is executed first.
    main: usize,
}

impl<'a> Source<'a> {
    /// Finds the programs of a text, and its loops and branches.
    ///
    /// # Errors
    /// If two programs have one name, or a loop or a branch has no end or no begin.
    pub(super) fn new(text: &'a str) -> Result<Source<'a>, GcodeError> {
        let (sections, names) = sections(text)?;
        let main =
            sections.iter().position(|section| section.name.is_empty() || section.is_main(text));
        let (main, partners) = (main.unwrap_or(0), partners(text, &sections)?);
        Ok(Source { text, sections, names, partners, labels: OnceLock::new(), main })
    }

    /// Returns the program with a name in a file of subprograms: one with that title, or the first one of a file of that name.
    pub(super) fn section(&self, file: &SubprogramFile, name: &str) -> Option<usize> {
        let is_file = plain_name(&file.name).eq_ignore_ascii_case(plain_name(name));
        self.subprogram(name).or_else(|| is_file.then_some(self.main))
    }

    /// Returns the parameters of a subprogram.
    pub(super) fn parameters(&self, section: usize) -> &'a str {
        self.sections[section].parameters
    }

    /// Returns the subprogram with a name.
    pub(super) fn subprogram(&self, name: &str) -> Option<usize> {
        let plain = Some(plain_name(name)).filter(|plain| !plain.is_empty())?;
        self.names.get(&plain.to_ascii_uppercase()).copied()
    }
}

/// The place of execution in a text. A subprogram of another file has a flow of its own, which its caller's flow waits for.
#[derive(Clone, Debug)]
pub(super) struct Flow<'a> {
    source: Arc<Source<'a>>,
    /// The number of calls in the flows that wait for this one.
    below: usize,
    place: Place,
    section: usize,
    /// The targets of jumps that were executed, by the place of their name.
    targets: HashMap<usize, Place>,
    calls: Vec<Call>,
    repeats: Vec<Repeat>,
    /// The end of the text that was executed: what stands before it is repeated.
    furthest: usize,
    /// The place after the last line of the main program that was executed.
    past: Place,
    repeated: Repeated,
}

impl<'a> Flow<'a> {
    /// Begins the main program of a text.
    pub(super) fn new(source: Arc<Source<'a>>, repeated: Repeated) -> Flow<'a> {
        Flow {
            below: 0,
            place: source.sections[source.main].start,
            section: source.main,
            past: source.sections[source.main].start,
            source,
            targets: HashMap::new(),
            calls: Vec::new(),
            repeats: Vec::new(),
            furthest: 0,
            repeated,
        }
    }

    /// Begins a program of another text, which this flow waits for.
    ///
    /// # Errors
    /// If subprograms call each other too deeply.
    pub(super) fn inside(
        &self,
        source: Arc<Source<'a>>,
        section: usize,
    ) -> Result<Flow<'a>, GcodeFault> {
        // One for the call itself.
        let below = self.below + self.calls.len() + 1;
        if below > MAX_CALLS {
            return Err(GcodeFault::TooDeep);
        }
        let place = source.sections[section].start;
        Ok(Flow { below, place, section, ..Flow::new(source, self.repeated) })
    }

    /// Goes on after a call of a subprogram in another file.
    pub(super) fn go_on_after(&mut self, called: &Flow) {
        self.repeated = called.repeated;
    }

    /// Returns the whole text.
    pub(super) fn text(&self) -> &'a str {
        self.source.text
    }

    /// Returns the next line, its place and the number of it.
    ///
    /// # Errors
    /// If the text ends without an end of the program; if too many blocks are repeated.
    pub(super) fn next_line(&mut self) -> Result<(usize, &'a str), GcodeError> {
        self.end_repeat();
        let end = self.source.sections[self.section].end;
        let found = line(self.text(), self.place).filter(|_| self.place.offset < end);
        let Some((text, after)) = found else {
            // The place is after the last line. An empty text has its fault in line 1.
            let last = self.place.line.max(2) - 1;
            return Err(GcodeError { line: last, fault: GcodeFault::Unfinished });
        };
        let number = self.place.line;
        let is_repeated = self.place.offset < self.furthest || self.is_called();
        self.furthest = self.furthest.max(after.offset);
        self.place = after;
        if !self.is_called() && self.past.offset < after.offset {
            self.past = after;
        }
        if is_repeated {
            self.count(work(text)).map_err(|fault| GcodeError { line: number, fault })?;
        }
        Ok((number, text))
    }

    fn is_called(&self) -> bool {
        self.below + self.calls.len() > 0
    }

    /// Counts blocks and steps that are executed again. Those of the main program are limited by its text.
    fn count(&mut self, number: usize) -> Result<(), GcodeFault> {
        self.repeated.add(number)
    }

    /// Counts the steps of a block, if it is executed again.
    pub(super) fn count_steps(&mut self, number: usize) -> Result<(), GcodeFault> {
        let is_repeated = self.place.offset < self.furthest || self.is_called();
        let is_counted = is_repeated || number > FREE_STEPS;
        if is_counted { self.count(number) } else { Ok(()) }
    }

    /// Goes on behind the last line of the main program that was executed, and returns whether it was not there.
    pub(super) fn go_past(&mut self) -> bool {
        let is_behind = self.is_called() || self.place.offset < self.past.offset;
        (self.place, self.section) = (self.past, self.source.main);
        self.calls.clear();
        self.repeats.clear();
        is_behind
    }

    /// Goes on where the statement of a line goes that is not followed by its next line.
    pub(super) fn go_to_partner(&mut self, line: usize) {
        if let Some(place) = self.source.partners.get(&line) {
            self.place = *place;
        }
    }

    /// Returns the line of the statement to which one of a line belongs: the `FOR` of an `ENDFOR`.
    pub(super) fn partner_line(&self, line: usize) -> usize {
        self.source.partners.get(&line).map_or(line, |place| place.line)
    }

    /// Goes to a label or a block number. `line` is that of the jump. Returns whether there is one.
    pub(super) fn jump(
        &mut self,
        target: &'a str,
        line: usize,
        direction: Direction,
    ) -> Result<bool, GcodeFault> {
        let key = target.as_ptr() as usize - self.text().as_ptr() as usize;
        let place = match self.targets.get(&key) {
            Some(place) => Some(*place),
            None => self.find(target, line, direction),
        };
        let Some(place) = place else { return Ok(false) };
        self.targets.insert(key, place);
        self.go(place)?;
        Ok(true)
    }

    fn go(&mut self, place: Place) -> Result<(), GcodeFault> {
        let depth = self.calls.len();
        if let Some(repeat) = self.repeats.last().filter(|repeat| repeat.depth == depth)
            && !(repeat.start.line..=repeat.last).contains(&place.line)
        {
            let condition = "it leaves a part of the program that REPEAT executes";
            return Err(combination("a jump", condition, "jump to a label within it"));
        }
        self.place = place;
        Ok(())
    }

    /// Finds a label or a block number in the present program.
    fn find(&self, target: &str, from: usize, direction: Direction) -> Option<Place> {
        let Section { start: begin, end, .. } = self.source.sections[self.section];
        let is_number = matches!(target.as_bytes(), [b'N' | b'n', rest @ ..] if rest.iter().all(u8::is_ascii_digit));
        let is_target = |(_, place): &&(u64, Place)| {
            let parts = line(self.text(), *place).map(|(text, _)| start(text));
            let found = parts.and_then(|parts| if is_number { parts.number } else { parts.label });
            found.is_some_and(|found| found.eq_ignore_ascii_case(target))
        };
        let labels = self.source.labels.get_or_init(|| labels(self.text()));
        let hash = label_hash(target);
        let to = |offset| {
            labels.partition_point(|(known, place)| (*known, place.offset) < (hash, offset))
        };
        let places = &labels[to(begin.offset)..to(end)];
        let (earlier, later) =
            places.split_at(places.partition_point(|(_, place)| place.line <= from));
        let after = later.iter().find(is_target);
        // A jump back goes to the nearest, its own line included.
        let before = match direction {
            Direction::Backward => earlier.iter().rfind(is_target),
            Direction::Forward | Direction::Both => earlier.iter().find(is_target),
        };
        let found = match direction {
            Direction::Forward => after,
            Direction::Backward => before,
            Direction::Both => after.or(before),
        };
        found.map(|(_, place)| *place)
    }

    /// Executes `REPEAT` with labels, or `REPEATB`, which repeats one line. `line` is its own.
    pub(super) fn repeat(&mut self, repeat: RepeatWords, line: usize) -> Result<(), GcodeFault> {
        let RepeatWords { first, last, is_block, times } = repeat;
        if times == 0 {
            return Ok(());
        }
        let find = |label: &str| {
            let found = self.find(label, line, Direction::Both);
            found.ok_or_else(|| no_target(label))
        };
        let start = find(first)?;
        let end = match last {
            // Several parts can end with the same label.
            Some(label) => match self.find(label, start.line, Direction::Forward) {
                Some(end) => end.line,
                None => find(label)?.line,
            },
            None if is_block => start.line,
            None => match self.find("ENDLABEL", start.line, Direction::Forward) {
                Some(end) if start.line > line || end.line < line => end.line,
                _ if start.line < line => line - 1,
                _ => {
                    return Err(missing(
                        "REPEAT",
                        "the end of its part: ENDLABEL:, or a second label",
                    ));
                }
            },
        };
        if end < start.line || (start.line..=end).contains(&line) {
            let condition = "its part ends before it begins, or contains it";
            return Err(combination(
                "REPEAT",
                condition,
                "name a part that stands before it or after it",
            ));
        }
        let (return_to, depth) = (self.place, self.calls.len());
        if self.repeats.len() > MAX_CALLS {
            return Err(GcodeFault::TooDeep);
        }
        self.repeats.push(Repeat { start, last: end, return_to, left: times - 1, depth });
        self.place = start;
        Ok(())
    }

    /// Repeats the part of `REPEAT` at its end, or goes on after that statement.
    fn end_repeat(&mut self) {
        while let Some(repeat) = self.repeats.last_mut() {
            if repeat.depth != self.calls.len() || self.place.line <= repeat.last {
                return;
            }
            if repeat.left > 0 {
                repeat.left -= 1;
                self.place = repeat.start;
                return;
            }
            self.place = repeat.return_to;
            self.repeats.pop();
        }
    }

    /// Begins a subprogram, `times` times. `base` is where the variables of the caller begin.
    pub(super) fn call(
        &mut self,
        section: usize,
        times: u32,
        base: usize,
    ) -> Result<(), GcodeFault> {
        if self.below + self.calls.len() >= MAX_CALLS {
            return Err(GcodeFault::TooDeep);
        }
        let (caller, return_to) = (self.section, self.place);
        self.calls.push(Call { caller, return_to, left: times - 1, base });
        self.section = section;
        self.place = self.source.sections[section].start;
        Ok(())
    }

    /// Ends the present program. Returns what follows.
    pub(super) fn leave(&mut self) -> Left {
        let depth = self.calls.len();
        self.repeats.retain(|repeat| repeat.depth < depth);
        match self.calls.last_mut() {
            None => Left::MainProgram,
            Some(call) if call.left > 0 => {
                call.left -= 1;
                self.place = self.source.sections[self.section].start;
                Left::Again
            }
            Some(call) => {
                let base = call.base;
                (self.section, self.place) = (call.caller, call.return_to);
                self.calls.pop();
                Left::Subprogram { base }
            }
        }
    }

    /// Returns the line of another main program of the file by its title, than the one that ends.
    pub(super) fn other_program(&self) -> Option<usize> {
        let others = self.source.sections.iter().enumerate();
        let mut others = others.filter(|(index, _)| *index != self.section);
        others
            .find(|(_, section)| section.is_main(self.text()))
            .map(|(_, section)| section.start.line)
    }

    /// Returns the line of the first text after the end of the main program that belongs to it.
    pub(super) fn text_after_end(&self) -> Option<usize> {
        let end = self.source.sections[self.section].end;
        let mut place = self.place;
        while let Some((text, after)) = line(self.text(), place).filter(|_| place.offset < end) {
            let mut words = start(text).words;
            if !words.is_at_end() && words.byte() != Some(b'%') {
                return Some(place.line);
            }
            place = after;
        }
        None
    }
}

/// The words of `REPEAT` or `REPEATB`.
#[derive(Clone, Copy, Debug)]
pub(super) struct RepeatWords<'a> {
    pub(super) first: &'a str,
    pub(super) last: Option<&'a str>,
    /// Set for `REPEATB`.
    pub(super) is_block: bool,
    pub(super) times: u32,
}

/// Continuation after the end of a program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Left {
    /// Nothing: it was the main program.
    MainProgram,
    /// The same subprogram again.
    Again,
    /// The caller, whose variables begin at `base`.
    Subprogram { base: usize },
}

/// Returns the fault of a jump without a target.
pub(super) fn no_target(label: &str) -> GcodeFault {
    GcodeFault::NoLabel { label: format!("{} in the direction of the jump", shown(label)) }
}

/// Returns the name of a subprogram without the parts that its file name adds.
pub(super) fn plain_name(name: &str) -> &str {
    let name = name.trim_matches('"').trim();
    let name = name.rsplit('/').next().unwrap_or(name);
    let upper = name.as_bytes();
    let has_prefix = upper.len() > 3 && upper[..3].eq_ignore_ascii_case(b"_N_");
    let name = if has_prefix { &name[3..] } else { name };
    for suffix in ["_SPF", "_MPF", ".SPF", ".MPF"] {
        let at = name.len().saturating_sub(suffix.len());
        if at > 0 && name.get(at..).is_some_and(|end| end.eq_ignore_ascii_case(suffix)) {
            return &name[..at];
        }
    }
    name
}

/// Returns the name of a program that begins with this line, as files of several programs have it: `%_N_NAME_MPF`.
pub(super) fn title(line: &str) -> Option<&str> {
    let name = line.trim().strip_prefix('%')?;
    name.get(..3).is_some_and(|prefix| prefix.eq_ignore_ascii_case("_N_")).then(|| name.trim_end())
}

impl Section<'_> {
    /// Returns whether its title is that of a main program.
    fn is_main(&self, text: &str) -> bool {
        let before = text[..self.start.offset].trim_end();
        let last = before.rsplit('\n').next().unwrap_or_default();
        title(last).is_some_and(|name| name.to_ascii_uppercase().ends_with("_MPF"))
    }
}

/// Finds the programs of a text, and their places by their names in capitals.
fn sections(text: &str) -> Result<(Vec<Section<'_>>, HashMap<String, usize>), GcodeError> {
    let begin = Place { offset: 0, line: 1 };
    let main = Section { name: "", start: begin, end: text.len(), parameters: "" };
    let mut found: Vec<(Section, usize)> = vec![(main, 1)];
    // Set once the last one has a statement, after which PROC begins another one.
    let mut has_words = false;
    let mut place = begin;
    while let Some((content, after)) = line(text, place) {
        let mut words = start(content).words;
        let mut proc = words;
        if let Some(name) = title(content) {
            let section =
                Section { name: plain_name(name), start: after, end: text.len(), parameters: "" };
            begin_section(&mut found, section, place, has_words);
            has_words = false;
        } else if proc.take_name("PROC") {
            let name = proc.name();
            let parameters = match proc.peek() {
                Some(b'(') => proc.bracketed([b'(', b')']).unwrap_or_default(),
                _ => "",
            };
            check_attributes(&mut proc).map_err(|fault| GcodeError { line: place.line, fault })?;
            let section = Section { name, start: after, end: text.len(), parameters };
            begin_section(&mut found, section, place, has_words);
            has_words = true;
        } else {
            has_words |= !words.is_at_end() && words.byte() != Some(b'%');
        }
        place = after;
    }
    let mut names = HashMap::new();
    for (index, (section, line)) in found.iter().enumerate() {
        if let Some(first) = names.insert(section.name.to_ascii_uppercase(), index) {
            let (label, first) = (shown(section.name), found[first].1);
            let fault = GcodeFault::SecondLabel { label, first };
            return Err(GcodeError { line: *line, fault });
        }
    }
    Ok((found.into_iter().map(|(section, _)| section).collect(), names))
}

/// Begins a program at a title, or names the one that has only a title so far.
fn begin_section<'a>(
    found: &mut Vec<(Section<'a>, usize)>,
    section: Section<'a>,
    place: Place,
    has_words: bool,
) {
    let Some((last, line)) = found.last_mut() else { return };
    if has_words {
        last.end = place.offset;
        found.push((section, place.line));
    } else {
        (*last, *line) = (section, place.line);
    }
}

/// Refuses attributes of `PROC` that change what its blocks do.
fn check_attributes(words: &mut Cursor) -> Result<(), GcodeFault> {
    while !words.is_at_end() {
        let name = words.name();
        match name.to_ascii_uppercase().as_str() {
            "DISPLOF" | "DISPLON" | "SBLOF" | "ACTBLOCNO" | "ICYCOF" | "IPTRLOCK" => {}
            "" => {
                return Err(not_read(
                    shown(words.rest()),
                    "no part of PROC",
                    "write its name and its parameters",
                ));
            }
            _ => {
                let meaning =
                    "an attribute of PROC that sets modes back at its end, or another one";
                return Err(not_read(
                    shown(name),
                    meaning,
                    "state the modes after the call instead",
                ));
            }
        }
    }
    Ok(())
}

/// Finds the lines with a label or a block number: a program may have as many jumps as lines.
fn labels(text: &str) -> Vec<(u64, Place)> {
    let mut labels = Vec::new();
    let mut place = Place { offset: 0, line: 1 };
    while let Some((content, after)) = line(text, place) {
        let parts = start(content);
        let found = [parts.number, parts.label].into_iter().flatten();
        labels.extend(found.map(|label| (label_hash(label), place)));
        place = after;
    }
    labels.sort_by_key(|(hash, place)| (*hash, place.offset));
    labels
}

/// Returns the hash of a label in capitals.
fn label_hash(label: &str) -> u64 {
    let mut hasher = DefaultHasher::new();
    label.bytes().for_each(|byte| hasher.write_u8(byte.to_ascii_uppercase()));
    hasher.finish()
}

/// Finds where the statements of loops and branches go.
fn partners(text: &str, sections: &[Section]) -> Result<HashMap<usize, Place>, GcodeError> {
    let mut partners = HashMap::new();
    for section in sections {
        // The statements that are open, each with its line and the place after it.
        let mut open: Vec<(Structure, Place, Place)> = Vec::new();
        let mut place = section.start;
        while let Some((content, after)) = line(text, place).filter(|_| place.offset < section.end)
        {
            let here = std::mem::replace(&mut place, after);
            let Some((found, _)) = Structure::at(start(content).words) else { continue };
            if !found.closes().is_empty() {
                let Some((_, at, next)) =
                    open.pop().filter(|(opened, ..)| found.closes().contains(opened))
                else {
                    let problem =
                        "closes no statement here: remove it, or add the statement that it closes";
                    return Err(structure(here.line, found, problem));
                };
                match found {
                    // If the condition is not met, the program goes on after it.
                    Structure::Else | Structure::EndIf => {
                        partners.insert(at.line, after);
                    }
                    Structure::EndWhile | Structure::EndFor => {
                        partners.insert(at.line, after);
                        partners.insert(here.line, at);
                    }
                    _ => {
                        partners.insert(here.line, next);
                    }
                }
            }
            if found.opens() {
                open.push((found, here, after));
            }
        }
        if let Some((opened, at, _)) = open.pop() {
            return Err(structure(at.line, opened, "has no end: add the statement that closes it"));
        }
    }
    Ok(partners)
}

fn structure(line: usize, structure: Structure, problem: &'static str) -> GcodeError {
    GcodeError { line, fault: GcodeFault::Structure { word: structure.word(), problem } }
}
