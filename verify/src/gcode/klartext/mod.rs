//! Heidenhain Klartext: conversational programs of the TNC controls (`.h`).
//!
//! ```text
//! text ──flow──▶ block ──line, block, expression──▶ words ──motion, cycle, frame──▶ control
//! ```
//!
//! `words` lists what is read, passed over and refused.

mod block;
mod cycle;
mod expression;
mod flow;
mod frame;
mod line;
mod motion;
mod words;

use super::blank::{BlankCorner, BlankWords};
use super::block::{Block, Code};
use super::control::{Control, StatedModes};
use super::error::{combination, missing, not_read};
use super::files::{self, CalledFolders, in_file};
use super::interpreter::Progress;
use super::note::NoteKind;
use super::rules::{Choice, ControlRules, Rule};
use super::{ControlSetup, GcodeError, GcodeFault, Repeated, SubprogramFile, shown, unquoted};
use block::{Feed, Scale, Words, m_entry};
use cycle::Cycle;
pub(super) use cycle::is_ignorable;
pub(crate) use expression::variable_name;
use expression::{Parameters, angle, finite, formula, parameter, value};
use flow::{Flow, Label, label};
use frame::Frame;
use line::{Cursor, Place, begin, expected, head};
use motion::{Before, number};
use std::collections::{BTreeMap, BTreeSet};
use std::mem;
use touchoff::Unit;
pub(super) use words::has_effect;
use words::{Entry, FUNCTIONS, STATEMENTS, Treatment, find};

/// Largest number of a tool.
const MAX_TOOL: f64 = 99_999_999.0;

/// A program, and the place of its execution.
#[derive(Clone, Debug)]
pub(super) struct Program<'a> {
    flow: Flow<'a>,
    /// The programs that wait for the end of one that they have called.
    waiting: Vec<Waiting<'a>>,
    /// The file of the program that is executed.
    file: usize,
    files: &'a [SubprogramFile],
    /// The files that were called, each before its first block.
    called: BTreeMap<usize, Flow<'a>>,
    parameters: Parameters,
    unit: Unit,
    frame: Frame,
    before: Before,
    cycle: Option<Cycle>,
    /// The parameters of the cycle at its definition, by their numbers; NaN for one without a value.
    cycle_parameters: Vec<(u16, f64)>,
    /// Set by M89.
    is_modal_call: bool,
    /// The tools that were called, and those whose length the job states.
    called_tools: BTreeSet<u32>,
    stated_lengths: BTreeSet<u32>,
    /// F of the last TOOL CALL.
    tool_feed: Option<f64>,
    /// Set once a position in program coordinates was executed.
    positioned: bool,
    pub(super) blank: BlankWords,
    folders: CalledFolders,
    /// The words of a block for the control.
    block: Block,
    /// The numbers of the M words of a block that the control executes.
    codes: Vec<u32>,
}

/// A program that waits for the end of one that it has called.
#[derive(Clone, Debug)]
struct Waiting<'a> {
    flow: Flow<'a>,
    file: usize,
    /// Its parameters QL.
    local: Vec<f64>,
}

/// Returns the first block of a text that is no comment, if it is the head of a program in Klartext: its unit and the place after it.
fn first_block(text: &str) -> Option<(Unit, Place, usize)> {
    let mut place = Place { offset: 0, line: 1 };
    while let Some((found, after)) = line::block(text, place) {
        if !begin(found).0.is_at_end() {
            return Some((head(found)?, after, place.line));
        }
        place = after;
    }
    None
}

/// Returns whether a text is a program in Klartext.
pub(super) fn is_program(text: &str) -> bool {
    first_block(text).is_some()
}

/// Returns the rules of the only control that reads Klartext.
pub(super) fn rules() -> ControlRules {
    ControlRules::named("heidenhain").expect("a control that is known by name")
}

impl<'a> Program<'a> {
    /// Reads what holds for the whole text, which is not copied: its unit and its labels. The control is a Heidenhain then.
    ///
    /// # Errors
    /// If the control states another dialect, or a label stands twice.
    pub(super) fn new(
        text: &'a str,
        setup: &'a ControlSetup,
        control: &mut Control,
    ) -> Result<Program<'a>, GcodeError> {
        let (unit, start, line) =
            first_block(text).ok_or(GcodeError { line: 1, fault: GcodeFault::Unfinished })?;
        if let Some(choice) = control.stated(Rule::Dialect).filter(|c| *c != Choice::Heidenhain) {
            let [dialect, _] = Rule::Dialect.describe(choice);
            return Err(GcodeError { line, fault: GcodeFault::OtherControl { dialect } });
        }
        let rules = rules();
        for rule in Rule::all() {
            if let (None, Some(choice)) = (control.stated(rule), rules.get(rule)) {
                control.state_rule(rule, choice);
            }
        }
        control.stated = StatedModes::ALL;
        // Lengths are converted where they are read.
        (control.modal.unit, control.modal.unit_stated) = (Unit::Millimetre, true);
        Ok(Program {
            flow: Flow::new(text, start, Repeated::new(setup))?,
            waiting: Vec::new(),
            file: 0,
            files: &setup.subprograms,
            called: BTreeMap::new(),
            parameters: Parameters::stated(&setup.variables),
            unit,
            frame: Frame::new(),
            before: Before::new(),
            cycle: None,
            cycle_parameters: Vec::new(),
            is_modal_call: false,
            called_tools: BTreeSet::new(),
            stated_lengths: setup.lengths.keys().copied().collect(),
            tool_feed: None,
            positioned: false,
            blank: BlankWords::default(),
            folders: CalledFolders::default(),
            block: Block::default(),
            codes: Vec::new(),
        })
    }

    /// Returns the unit of the program.
    pub(super) fn unit(&self) -> Unit {
        self.unit
    }

    /// Returns the number of the file of a called program.
    pub(super) fn called_file(&self) -> Option<usize> {
        (!self.waiting.is_empty()).then_some(self.file)
    }

    /// Calls the program of a file, after `CALL PGM`.
    fn call_program(&mut self, cursor: &Cursor<'a>) -> Result<(), GcodeFault> {
        let name = cursor.rest().split([';', '\n']).next().unwrap_or_default();
        let name = name.trim().trim_matches('"');
        let Some(file) = files::find(self.files, name) else {
            return Err(GcodeFault::NoSubprogram { label: shown(name) });
        };
        self.folders.check(name, files::without_folder(name))?;
        let flow = match self.called.get(&file) {
            Some(flow) => flow.clone(),
            None => {
                let text = &self.files[file - 1].text;
                let Some((unit, start, line)) = first_block(text) else {
                    let (meaning, remedy) =
                        ("no program in Klartext", "name a file that begins with BEGIN PGM");
                    return Err(not_read(shown(name), meaning, remedy));
                };
                if unit != self.unit {
                    let error = GcodeError { line, fault: GcodeFault::OtherUnit };
                    return Err(in_file(self.files, file, error));
                }
                let flow = Flow::new(text, start, self.flow.repeated);
                let flow = flow.map_err(|error| in_file(self.files, file, error))?;
                self.called.insert(file, flow.clone());
                flow
            }
        };
        let called = flow.called_by(&self.flow)?;
        let flow = mem::replace(&mut self.flow, called);
        let file = mem::replace(&mut self.file, file);
        let local = self.parameters.hide_local();
        self.waiting.push(Waiting { flow, file, local });
        Ok(())
    }

    /// Goes on behind the last block of the main program that was executed, out of all repeats and calls, and returns whether it was not
    /// there.
    pub(super) fn go_past(&mut self) -> bool {
        let is_called = !self.waiting.is_empty();
        if is_called {
            let Waiting { flow, file, local } = self.waiting.swap_remove(0);
            (self.flow, self.file) = (flow, file);
            self.parameters.show_local(&local);
            self.waiting.clear();
        }
        self.flow.go_past() || is_called
    }

    /// Returns the next block and its line.
    pub(super) fn next_line(&mut self) -> Result<Option<(usize, &'a str)>, GcodeError> {
        self.flow.next_block().map(Some)
    }

    /// Executes a block.
    pub(super) fn execute_line(
        &mut self,
        line: usize,
        text: &'a str,
        control: &mut Control,
    ) -> Result<Progress, GcodeFault> {
        control.set_line(self.called_file(), line);
        let progress = self.statement(text, control)?;
        // A cycle in a repeated section has many steps per block.
        self.flow.count(control.pending.len())?;
        Ok(progress)
    }

    /// Executes the statement of a block.
    fn statement(&mut self, text: &'a str, control: &mut Control) -> Result<Progress, GcodeFault> {
        let (mut cursor, is_optional) = begin(text);
        // A line that begins with `*` is a heading.
        if matches!(cursor.peek(), None | Some(b'*')) {
            return Ok(Progress::GoesOn);
        }
        if is_optional {
            let is_left_out = control.choice(Rule::OptionalBlocks) == Choice::LeftOut;
            let kind = match is_left_out {
                true => NoteKind::OmittedOptionalBlock,
                false => NoteKind::ExecutedOptionalBlock,
            };
            control.notes.add(control.block(), kind);
            if is_left_out {
                return Ok(Progress::GoesOn);
            }
        }
        let start = cursor;
        let head = cursor.letters();
        let motion = ["L", "CP", "C", "CR", "CT", "LP", "CTP"];
        if let Some(head) = motion.into_iter().find(|known| known.eq_ignore_ascii_case(head)) {
            return self.motion(head, &mut cursor, control);
        }
        let upper = head.to_ascii_uppercase();
        if matches!(upper.as_str(), "TOOL" | "CYCL" | "PLANE" | "TRANS" | "FUNCTION") {
            control.check_uncompensated(&*upper)?;
            control.check_corner()?;
        }
        match upper.as_str() {
            "CC" => self.pole(&mut cursor, control)?,
            // M words alone.
            "M" => return self.motion("L", &mut { start }, control),
            "Q" | "QL" | "QR" | "QS" => self.assign(&mut { start })?,
            "FN" => self.function(&mut cursor, control)?,
            "IF" => self.jump(&mut cursor)?,
            "LBL" => {
                let label = label(&mut cursor, &self.parameters)?;
                cursor.check_end()?;
                if label == Label::Number(0) {
                    self.flow.end_subprogram();
                }
            }
            "STOP" => {
                control.check_corner()?;
                self.codes.clear();
                self.codes.push(0);
                let scale = Scale::new(&self.parameters, self.unit);
                if scale.words(&mut cursor, &mut self.codes)? != Words::default() {
                    let condition = "its block has other words than M words of the machine";
                    return Err(combination("STOP", condition, "write them in a block before"));
                }
                self.start_words(control)?;
                return self.end_words(control);
            }
            "TOOL" => self.tool(&mut cursor, control)?,
            "CYCL" if cursor.take_word("DEF") => self.define_cycle(&mut cursor, control)?,
            "CYCL" if cursor.take_word("CALL") => {
                if cursor.take_word("PAT") {
                    refuse("CYCL CALL PAT")?;
                }
                return self.cycle_call(&mut cursor, control);
            }
            "CALL" if cursor.take_word("PGM") => self.call_program(&cursor)?,
            "CALL" if cursor.take_word("LBL") => {
                flow::call(&mut cursor, &mut self.flow, &self.parameters)?;
            }
            "PLANE" => self.plane(&mut cursor, control)?,
            "TRANS" if cursor.take_word("DATUM") => self.trans_datum(&mut cursor, control)?,
            "FUNCTION" => self.mode(&mut cursor, control)?,
            "BLK" => {
                self.blank_corner(&mut cursor, control)?;
                let text = start.rest().split([';', '\n']).next().unwrap_or_default();
                let word = unquoted(&text.split_whitespace().collect::<Vec<_>>().join(" "));
                control.notes.add(control.block(), NoteKind::PassedOver { word });
            }
            "END" if cursor.take_word("PGM") => {
                if let Some(Waiting { flow, file, local }) = self.waiting.pop() {
                    let called = mem::replace(&mut self.flow, flow);
                    self.flow.go_on_after(&called);
                    self.file = file;
                    self.parameters.show_local(&local);
                    return Ok(Progress::GoesOn);
                }
                self.note_end(control);
                if let Some((line, is_program)) = self.flow.text_after() {
                    let kind = match is_program {
                        true => NoteKind::OtherProgram,
                        false => NoteKind::TextAfterEnd,
                    };
                    control.notes.add(line.into(), kind);
                }
                return Ok(Progress::Ended);
            }
            "RND" | "CHF" => {
                return Err(missing(upper, "a motion before it, and another one after it"));
            }
            _ => return Err(unknown(&upper, start, cursor)),
        }
        Ok(Progress::GoesOn)
    }

    /// Reads a corner of the blank: `BLK FORM 0.1 Z X+0 Y+0 Z-40`, the lowest one, or `BLK FORM 0.2 X+100 Y+80 Z+0`. Blanks of another form
    /// have none.
    fn blank_corner(&mut self, cursor: &mut Cursor, control: &Control) -> Result<(), GcodeFault> {
        let mut corners = ["0.1", "0.2"].iter();
        let is_form = cursor.take_word("FORM");
        let corner = corners.position(|number| is_form && cursor.take_text(number));
        let Some(corner) = corner else {
            self.blank.other_form(control);
            return Ok(());
        };
        if corner == 0 {
            // The tool axis.
            cursor.letters();
        }
        let scale = Scale::new(&self.parameters, self.unit);
        let mut position = [None; 3];
        while let Some(axis @ b'X'..=b'Z') = cursor.peek().map(|byte| byte.to_ascii_uppercase()) {
            cursor.advance();
            position[usize::from(axis - b'X')] = Some(scale.length(cursor)?);
        }
        let [x, y, z] = position;
        let position = x.zip(y).zip(z).map(|((x, y), z)| [x, y, z]);
        let position = position.filter(|_| cursor.is_at_end());
        let is_called = !self.waiting.is_empty();
        let is_moved = control.moves_coordinates() || self.frame.is_mirrored();
        self.blank.corner(BlankCorner { corner, position, is_called, is_moved }, control);
        Ok(())
    }

    /// Executes the M words that act at the start of their block.
    fn start_words(&mut self, control: &mut Control) -> Result<(), GcodeFault> {
        if self.codes.is_empty() {
            return Ok(());
        }
        let turns = |code: &&u32| matches!(**code, 3 | 4 | 13 | 14);
        let codes = std::mem::take(&mut self.codes);
        if let [first, second, ..] = codes.iter().filter(turns).collect::<Vec<_>>()[..] {
            return Err(super::error::same_group(format!("M{first}"), format!("M{second}")));
        }
        for code in &codes {
            match code {
                3 | 13 => self.m_word(3, control)?,
                4 | 14 => self.m_word(4, control)?,
                126 => control.set_shorter_way(true),
                128 => self.set_tcp(true, control)?,
                _ => {
                    let word = format!("M{code}");
                    match m_entry(*code) {
                        Ok(entry) if entry.treatment == Treatment::PassedOver => {
                            control.notes.add(control.block(), NoteKind::PassedOver { word });
                        }
                        Ok(_) => {}
                        Err(_) if control.ignores(&word) => control.ignore(word),
                        Err(fault) => return Err(fault),
                    }
                }
            }
        }
        self.codes = codes;
        Ok(())
    }

    /// Executes the M words that act at the end of their block.
    fn end_words(&mut self, control: &mut Control) -> Result<Progress, GcodeFault> {
        let codes = std::mem::take(&mut self.codes);
        let mut progress = Progress::GoesOn;
        for code in &codes {
            match code {
                5 | 19 => self.m_word(*code, control)?,
                127 => control.set_shorter_way(false),
                129 => self.set_tcp(false, control)?,
                0 | 1 => {
                    control.pause_spindle();
                    control.notes.add(control.block(), NoteKind::Stop);
                }
                2 | 30 if !self.waiting.is_empty() => {
                    let condition =
                        "CALL PGM has called the program, whose end they are on some controls";
                    let remedy = "remove it: END PGM leads back to the caller";
                    return Err(combination(format!("M{code}"), condition, remedy));
                }
                2 | 30 => {
                    self.note_end(control);
                    if let Some((line, true)) = self.flow.text_after() {
                        control.notes.add(line.into(), NoteKind::OtherProgram);
                    }
                    progress = Progress::Ended;
                }
                _ => {}
            }
        }
        self.codes = codes;
        Ok(progress)
    }

    /// Notes mirrored axes at the end of the program, which the control does not know.
    fn note_end(&self, control: &mut Control) {
        if self.frame.is_mirrored() {
            let words = "CYCL DEF 8".to_owned();
            control.notes.add(control.block(), NoteKind::LeftModes { words });
        }
    }

    /// Executes an M word of the spindle.
    fn m_word(&mut self, code: u32, control: &mut Control) -> Result<(), GcodeFault> {
        self.block.clear();
        self.block.add_code(Code { letter: 'M', tenths: 10 * code })?;
        control.execute(&mut self.block)
    }

    /// Executes M128 and M129.
    fn set_tcp(&mut self, is_on: bool, control: &mut Control) -> Result<(), GcodeFault> {
        control.check_uncompensated("M128 or M129")?;
        if is_on && control.rotation() != super::Rotation::Off {
            let condition = "axes are rotated (CYCL DEF 10, PLANE)";
            return Err(combination("M128", condition, "end that before"));
        }
        if is_on && self.frame.has_allowance() {
            let condition = "the tool has an allowance on its length (DL)";
            return Err(combination("M128", condition, "write DL+0 in TOOL CALL"));
        }
        if is_on && !control.has_length() {
            return Err(missing("M128", "a tool with its length (TOOL CALL) before"));
        }
        control.set_tcp(is_on);
        Ok(())
    }

    /// Executes a formula.
    fn assign(&mut self, cursor: &mut Cursor) -> Result<(), GcodeFault> {
        let target = parameter(cursor)?;
        if !cursor.take(b'=') {
            return Err(cursor.unexpected("= and a formula after a parameter"));
        }
        let value = formula(cursor, &self.parameters)?;
        cursor.check_end()?;
        Ok(self.parameters.assign(target, value)?)
    }

    /// Executes FN.
    fn function(
        &mut self,
        cursor: &mut Cursor<'a>,
        control: &mut Control,
    ) -> Result<(), GcodeFault> {
        cursor.peek();
        let digits = cursor.take_while(|byte| byte.is_ascii_digit());
        let word = format!("FN {digits}");
        let Some(entry) = find(&FUNCTIONS, &word) else {
            let remedy = "check the program without it";
            return Err(not_read(word, "a function that is not known", remedy));
        };
        entry.check()?;
        if entry.treatment == Treatment::PassedOver {
            control.notes.add(control.block(), NoteKind::PassedOver { word });
            return Ok(());
        }
        if !cursor.take(b':') {
            return Err(cursor.unexpected("a colon after the number of FN"));
        }
        if matches!(digits, "9" | "10" | "11" | "12") {
            if !cursor.take_word("IF") {
                return Err(cursor.unexpected("IF"));
            }
            return self.jump(cursor);
        }
        let target = parameter(cursor)?;
        if !cursor.take(b'=') {
            return Err(cursor.unexpected("= after the parameter"));
        }
        let operation = entry.word;
        let known = &self.parameters;
        let result = match digits {
            "0" => value(cursor, known)?,
            "5" | "6" | "7" => {
                let name = match digits {
                    "5" => "SQRT",
                    "6" => "SIN",
                    _ => "COS",
                };
                let mut ahead = *cursor;
                if !ahead.take_text(name) {
                    return Err(cursor.unexpected("SQRT, SIN or COS, as the number of FN says"));
                }
                formula(cursor, known)?
            }
            _ => {
                let first = value(cursor, known)?;
                let is_between = match digits {
                    "1" => cursor.take(b'+'),
                    "2" => cursor.take(b'-'),
                    "3" => cursor.take(b'*'),
                    "4" => cursor.take_text("DIV") || cursor.take(b'/'),
                    "8" => cursor.take_text("LEN"),
                    _ => cursor.take_text("ANG"),
                };
                if !is_between {
                    return Err(cursor.unexpected("the operator of FN"));
                }
                let second = value(cursor, known)?;
                match digits {
                    "1" => finite(first + second, operation)?,
                    "2" => finite(first - second, operation)?,
                    "3" => finite(first * second, operation)?,
                    "4" => finite(first / second, operation)?,
                    "8" => finite(first.hypot(second), operation)?,
                    _ => angle(first, second)?,
                }
            }
        };
        cursor.check_end()?;
        Ok(self.parameters.assign(target, result)?)
    }

    /// Executes a jump after IF.
    fn jump(&mut self, cursor: &mut Cursor<'a>) -> Result<(), GcodeFault> {
        if self.leads_on_anyway(*cursor) {
            return Ok(());
        }
        let first = value(cursor, &self.parameters)?;
        let comparison = cursor.letters().to_ascii_uppercase();
        let second = value(cursor, &self.parameters)?;
        // Values that are equal but for rounding are not compared: controls may compute them in another way.
        let difference = first - second;
        if difference != 0.0 && difference.abs() < 1e-9 * first.abs().max(second.abs()).max(1.0) {
            let condition = "they differ by rounding alone";
            let remedy = "count in whole numbers";
            return Err(combination("a comparison of values", condition, remedy));
        }
        let holds = match comparison.as_str() {
            "EQU" => difference == 0.0,
            "NE" => difference != 0.0,
            "GT" => difference > 0.0,
            "LT" => difference < 0.0,
            _ => return Err(expected(&comparison, "EQU, NE, GT or LT between two values")),
        };
        if !cursor.take_word("GOTO") || !cursor.take_word("LBL") {
            return Err(cursor.unexpected("GOTO LBL and a label"));
        }
        let label = label(cursor, &self.parameters)?;
        cursor.check_end()?;
        if holds { self.flow.jump(label) } else { Ok(()) }
    }

    /// Returns whether a jump leads to where the program goes on without it, over labels alone: its condition, which only the machine may
    /// know, does not matter.
    fn leads_on_anyway(&self, mut cursor: Cursor<'a>) -> bool {
        let upper = cursor.rest().to_ascii_uppercase();
        let Some(at) = upper.find("GOTO") else { return false };
        for _ in 0..at + "GOTO".len() {
            cursor.advance();
        }
        let label = match cursor.take_word("LBL") {
            true => label(&mut cursor, &self.parameters),
            false => return false,
        };
        label.is_ok_and(|label| self.flow.leads_to(label))
    }

    /// Executes TOOL CALL and TOOL DEF, after TOOL.
    fn tool(&mut self, cursor: &mut Cursor, control: &mut Control) -> Result<(), GcodeFault> {
        let is_call = cursor.take_word("CALL");
        if !is_call && !cursor.take_word("DEF") {
            return Err(cursor.unexpected("CALL or DEF after TOOL"));
        }
        let word = if is_call { "TOOL CALL" } else { "TOOL DEF" };
        let mut named = None;
        if cursor.peek() == Some(b'"') {
            let name = cursor.quoted()?;
            if is_call {
                let Some(number) = control.tool_named(name) else {
                    let meaning = "a tool by its name, whose number the job does not state";
                    let word = format!("TOOL CALL \"{}\"", unquoted(name));
                    let remedy = "state `name` in `[tool.N]` of the job, or write the number";
                    return Err(not_read(word, meaning, remedy));
                };
                named = Some(f64::from(number));
            }
        }
        let has_number = matches!(cursor.peek(), Some(b'0'..=b'9' | b'+' | b'Q'));
        let tool = match named {
            None if has_number => Some(value(cursor, &self.parameters)?),
            named => named,
        };
        if let Some(tool) = tool
            && (tool.fract() != 0.0 || !(0.0..=MAX_TOOL).contains(&tool))
        {
            let shown = format!("{word} {tool}");
            return Err(GcodeFault::Sentence { shown, expected: "the whole number of a tool" });
        }
        if is_call && tool.is_some() && control.is_tcp() {
            return Err(combination(word, "M128 is in force", "write M129 before"));
        }
        self.block.clear();
        let (mut length, mut allowance) = (None, None);
        let (mut radius, mut radius_allowance) = (None, None);
        while let Some(byte) = cursor.peek() {
            let start = *cursor;
            let scale = Scale::new(&self.parameters, self.unit);
            match byte.to_ascii_uppercase() {
                b'Z' => cursor.advance(),
                b'X' | b'Y' | b'U'..=b'W' => {
                    let shown = format!("{word} {}", char::from(byte));
                    return Err(not_read(shown, "another tool axis than Z", "write Z"));
                }
                b'S' => {
                    cursor.advance();
                    let speed = value(cursor, &self.parameters)?;
                    self.block.add('S', number(speed))?;
                }
                b'F' => match scale.feed(cursor)? {
                    Feed::Rate(rate) => {
                        self.tool_feed = Some(rate);
                        self.block.add('F', number(rate))?;
                    }
                    _ => return Err({ start }.unexpected("F with a number")),
                },
                b'D' if cursor.take_text("DL") => {
                    // Tables of tools write it with a colon.
                    cursor.take(b':');
                    allowance = Some(scale.length(cursor)?);
                }
                b'D' if cursor.take_text("DR") => {
                    let is_of_corner = cursor.take_text("2");
                    cursor.take(b':');
                    let value = scale.length(cursor)?;
                    // The radius of the corner moves no path.
                    match is_of_corner {
                        true => {
                            let word = "DR2".to_owned();
                            control.notes.add_once(control.block(), NoteKind::PassedOver { word });
                        }
                        false => radius_allowance = Some(value),
                    }
                }
                b'L' if !is_call => {
                    cursor.advance();
                    length = Some(scale.length(cursor)?);
                }
                b'R' if !is_call => {
                    cursor.advance();
                    radius = Some(scale.length(cursor)?);
                }
                _ => return Err(cursor.unexpected("Z, S, F, DL or DR after the tool")),
            }
        }
        if !is_call {
            if let Some(tool) = tool {
                self.check_definition(tool as u32, length, radius, control)?;
            }
            if let (Some(tool), Some(radius)) = (tool, radius) {
                control.define_radius(tool as u32, radius);
            }
            if let (Some(tool), Some(length)) = (tool, length) {
                control.define_length(tool as u32, length);
            } else {
                let word = word.to_owned();
                control.notes.add(control.block(), NoteKind::PassedOver { word });
            }
            return Ok(());
        }
        if let Some(tool) = tool {
            self.called_tools.insert(tool as u32);
            self.block.add('T', number(tool))?;
            self.before.leave();
            allowance.get_or_insert(0.0);
            radius_allowance.get_or_insert(0.0);
        }
        if allowance.is_some_and(|allowance| allowance != 0.0) && control.is_tcp() {
            let condition = "M128 is in force, under which it is along an axis that turns";
            return Err(combination("DL", condition, "write M129 before, or DL+0"));
        }
        control.execute(&mut self.block)?;
        if let Some(allowance) = allowance {
            self.set_allowance(allowance, control);
        }
        if let Some(allowance) = radius_allowance {
            control.set_radius_allowance(allowance);
        }
        Ok(())
    }

    /// Refuses a definition that changes the tool in the spindle, or the length of one whose motions took another length for its own.
    fn check_definition(
        &self,
        tool: u32,
        length: Option<f64>,
        radius: Option<f64>,
        control: &Control,
    ) -> Result<(), GcodeFault> {
        let word = format!("TOOL DEF {tool}");
        let changes_length = length.is_some_and(|new| control.defined_length(tool) != Some(new));
        let changes_radius = radius.is_some_and(|new| control.defined_radius(tool) != Some(new));
        if control.has_in_spindle(tool) && (changes_length || changes_radius) {
            let condition = "the tool is in the spindle with another length or radius";
            return Err(combination(word, condition, "write it before TOOL CALL"));
        }
        let is_stated = self.stated_lengths.contains(&tool);
        if changes_length && self.called_tools.contains(&tool) && !is_stated {
            let meaning = "another length of a tool that was called, and the job states none";
            return Err(not_read(word, meaning, "state its `length` in `[tool.N]` of the job"));
        }
        Ok(())
    }

    /// Executes TRANS DATUM, after these words.
    fn trans_datum(
        &mut self,
        cursor: &mut Cursor,
        control: &mut Control,
    ) -> Result<(), GcodeFault> {
        if cursor.take_word("RESET") {
            cursor.check_end()?;
            return self.set_shift([0.0; 6], control);
        }
        match cursor.take_word("AXIS") {
            true => self.datum_shift(cursor, control),
            false => Err(cursor.unexpected("AXIS or RESET after TRANS DATUM")),
        }
    }

    /// Executes FUNCTION.
    fn mode(&mut self, cursor: &mut Cursor, control: &mut Control) -> Result<(), GcodeFault> {
        let word = cursor.letters().to_ascii_uppercase();
        match word.as_str() {
            "RESET" if cursor.take_word("TCPM") => {
                cursor.check_end()?;
                self.set_tcp(false, control)
            }
            "TCPM" if cursor.take_word("RESET") => self.set_tcp(false, control),
            "TCPM" => {
                while !cursor.is_at_end() {
                    let start = *cursor;
                    let pair = [cursor.letters(), cursor.letters()];
                    match pair.map(str::to_ascii_uppercase).each_ref().map(String::as_str) {
                        ["F", "TCP" | "CONT"] | ["AXIS", "POS"] | ["PATHCTRL", "AXIS"] => {}
                        ["REFPNT", "TIP"] if cursor.take_text("-TIP") => {}
                        ["AXIS", "SPAT"] => {
                            let meaning = "angles of the workpiece instead of the axes";
                            return Err(not_read("AXIS SPAT", meaning, "write AXIS POS"));
                        }
                        ["PATHCTRL", "VECTOR"] => {
                            let meaning = "a tool axis that turns in a plane between two positions";
                            return Err(not_read(
                                "PATHCTRL VECTOR",
                                meaning,
                                "write PATHCTRL AXIS",
                            ));
                        }
                        _ => return Err({ start }.unexpected("AXIS POS, PATHCTRL AXIS or F TCP")),
                    }
                }
                self.set_tcp(true, control)
            }
            "DWELL" => {
                let word = "FUNCTION DWELL".to_owned();
                control.notes.add(control.block(), NoteKind::PassedOver { word });
                Ok(())
            }
            "MODE" if cursor.take_word("MILL") => {
                if !cursor.is_at_end() {
                    let word = "FUNCTION MODE MILL with a name";
                    let meaning = "a choice of other kinematics than those of the machine's file";
                    return Err(not_read(word, meaning, "write FUNCTION MODE MILL alone"));
                }
                let word = "FUNCTION MODE".to_owned();
                control.notes.add(control.block(), NoteKind::PassedOver { word });
                Ok(())
            }
            _ => {
                let entry = find(&STATEMENTS, "FUNCTION").expect("an entry of the table");
                match entry.treatment {
                    Treatment::Refused(remedy) => {
                        let word = format!("FUNCTION {word}");
                        Err(not_read(word, entry.meaning, remedy))
                    }
                    _ => Ok(()),
                }
            }
        }
    }
}

/// Refuses a statement of the table.
fn refuse(word: &str) -> Result<(), GcodeFault> {
    find(&STATEMENTS, word).map_or(Ok(()), Entry::check)
}

/// Returns the fault of a block that begins with no word that is read.
fn unknown(head: &str, mut start: Cursor, mut after: Cursor) -> GcodeFault {
    let second = after.letters().to_ascii_uppercase();
    for word in [format!("{head} {second}"), head.to_owned()] {
        if let Err(fault) = refuse(&word) {
            return fault;
        }
    }
    if head.len() > 1 || start.peek().is_some_and(|byte| byte.is_ascii_alphabetic()) {
        let text = unquoted(start.rest().lines().next().unwrap_or(head).trim_end());
        return GcodeFault::UnknownCode { word: format!("`{text}`") };
    }
    start.unexpected("a word of Klartext, as L, TOOL CALL or CYCL DEF")
}
