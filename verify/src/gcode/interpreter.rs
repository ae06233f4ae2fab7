//! The interpreter: reads blocks, executes them in order, and returns their motions.

use super::Plane;
use super::block::Block;
use super::code::{Code, Group};
use super::coordinates::is_programmed;
use super::expression::Parameters;
use super::flow::Flow;
use super::label::{Label, Role};
use super::linuxcnc;
use super::modal::{FeedMode, Motion};
use super::motion::Control;
use super::next_run;
use super::note::{ProgramNote, Subject};
use super::rules::{Choice, Rule};
use super::state::Tcp;
use super::{ControlSetup, GcodeError, GcodeFault, Step, text};
use std::collections::BTreeMap;
use std::mem;
use touchoff::Unit;

/// An interpreter of a program: an iterator over its steps.
///
/// It holds the state of the control and the steps of one block, so memory does not grow with the program.
/// After an error it returns no more steps.
#[derive(Clone, Debug)]
pub struct Interpreter<'a> {
    flow: Flow<'a>,
    parameters: Parameters,
    block: Block,
    pub(super) control: Control,
    /// The number of the first switch for optional blocks.
    switch: Option<String>,
    finished: bool,
    /// The end of the program, once it was executed.
    end: Option<End>,
    /// Itself before the first block.
    first: Option<Box<Interpreter<'a>>>,
}

/// The word that ends a program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum End {
    /// M2 or M30, at which some controls set modes.
    Stop,
    /// `%`.
    Percent,
}

impl<'a> Interpreter<'a> {
    /// Creates an interpreter of a text, which is not copied.
    ///
    /// # Errors
    /// If two subprograms have one label, or a `sub` and its `endsub` do not match.
    pub fn new(text: &'a str, setup: &ControlSetup) -> Result<Interpreter<'a>, GcodeError> {
        if let Some(line) = text::lone_return(text) {
            return Err(GcodeError { line, fault: GcodeFault::LoneReturn });
        }
        let extent = text::extent(text);
        let located = |(line, fault)| GcodeError { line, fault };
        let flow = Flow::new(&extent).map_err(located)?;
        if setup.rules.get(Rule::Dialect) == Some(Choice::Rs274Ngc) && flow.has_subprograms() {
            linuxcnc::check_text(extent.text).map_err(located)?;
        }
        let mut control = Control::new(setup);
        let dialect = setup.rules.get(Rule::Dialect);
        // The head of a program of Heidenhain is a title elsewhere.
        if let Some(unit) = extent.unit
            && matches!(dialect, None | Some(Choice::Heidenhain))
        {
            (control.modal.unit, control.modal.unit_stated) = (unit, true);
            control.read_heidenhain();
        }
        if let Some((line, has_blocks)) = extent.left_out {
            let subject = if has_blocks { Subject::OtherProgram } else { Subject::TextAfterEnd };
            control.notes.add(line, subject);
        }
        let first = Interpreter {
            flow,
            parameters: Parameters::default(),
            block: Block::default(),
            control,
            switch: None,
            finished: false,
            end: None,
            first: None,
        };
        Ok(Interpreter { first: Some(Box::new(first.clone())), ..first })
    }

    /// Returns the notes about the blocks that were executed so far, by line.
    pub fn notes(&self) -> Vec<ProgramNote> {
        let mut notes = self.control.notes.list();
        if let (Some(first), Some(end)) = (&self.first, self.end) {
            notes.extend(next_run::note(first, &self.control, end));
        }
        notes.sort_by_key(|note| note.line);
        notes
    }

    /// Returns the rules of the control on which the blocks depend that were executed so far, each with the first line.
    pub fn asked(&self) -> &BTreeMap<Rule, usize> {
        &self.control.asked
    }

    /// Executes the next line.
    fn advance(&mut self) -> Result<(), GcodeError> {
        let located = |(line, fault)| GcodeError { line, fault };
        let Some((line, text)) = self.flow.next_line().map_err(located)? else {
            self.finish(End::Percent);
            return Ok(());
        };
        let mut block = mem::take(&mut self.block);
        let result = self.blocks(line, text, &mut block);
        self.block = block;
        result.map_err(|fault| GcodeError { line, fault })
    }

    /// Executes the next line, and returns whether the program goes on.
    pub(super) fn execute_line(&mut self) -> Result<bool, GcodeError> {
        self.advance()?;
        Ok(!self.finished)
    }

    fn finish(&mut self, end: End) {
        self.finished = true;
        self.end = Some(end);
    }

    /// Executes the block of a line, and those after semicolons if they end a block.
    fn blocks(&mut self, line: usize, text: &str, block: &mut Block) -> Result<(), GcodeFault> {
        self.control.line = line;
        let after = after_semicolon(text).filter(|after| after.split(';').any(could_be_block));
        self.line(line, text, block)?;
        let Some(after) = after else { return Ok(()) };
        if self.control.choice(Rule::Semicolon) == Choice::Comment {
            return Ok(());
        }
        for text in after.split(';').filter(|text| could_be_block(text)) {
            if self.finished {
                break;
            }
            if block.code_of(Group::Subprogram).is_some() {
                return Err(GcodeFault::Combination {
                    word: "`;`".to_owned(),
                    condition: "its block calls or ends a subprogram",
                    remedy: "write the block after it on a line of its own",
                });
            }
            self.line(line, text, block)?;
        }
        Ok(())
    }

    /// Returns the label and the repeats of M98.
    fn called(&self, block: &mut Block) -> Result<(Label, u32), GcodeFault> {
        let expected = "the number of a program after P";
        let Some(number) = block.take_whole('P', 0, 99_999_999, expected)? else {
            let needed = "P with the number of a program";
            return Err(GcodeFault::Missing { word: "M98".to_owned(), needed });
        };
        // Older controls take the last four digits as the number, and those before as repeats.
        if number > 9999 && self.flow.has(&Label::Number(number % 10_000)) {
            return Err(GcodeFault::Combination {
                word: format!("M98 P{number}"),
                condition: "its last four digits are the number of a program, too",
                remedy: "give the program another number, and write repeats after L",
            });
        }
        let times = block.take_whole('L', 1, 99_999_999, "a number of repeats from 1 after L")?;
        Ok((Label::Number(number), times.unwrap_or(1)))
    }

    /// Refuses a call of a subprogram that LinuxCNC does not find: it seeks those that it does not know after the call only
    /// (`control_back_to`).
    fn check_order(&self, label: &Label) -> Result<(), GcodeFault> {
        match self.control.stated(Rule::Dialect) == Some(Choice::Rs274Ngc)
            && self.flow.has_passed(label)
        {
            true => Err(GcodeFault::Combination {
                word: format!("a call of {label}"),
                condition: "it stands before the call and was not called before",
                remedy: "move it to the end of the file: LinuxCNC seeks it after the call only",
            }),
            false => Ok(()),
        }
    }

    fn line(&mut self, line: usize, text: &str, block: &mut Block) -> Result<(), GcodeFault> {
        let switch = text.trim_start().strip_prefix('/');
        let is_optional = switch.is_some();
        if let Some(text) = switch {
            let digits = text.bytes().take_while(u8::is_ascii_digit).count();
            let first = self.switch.get_or_insert_with(|| text[..digits].to_owned());
            if *first != text[..digits] {
                self.control.notes.add(line, Subject::OptionalSwitches);
            }
        }
        if is_optional && self.control.choice(Rule::OptionalBlocks) == Choice::LeftOut {
            self.control.notes.add(line, Subject::OmittedOptionalBlock);
            return Ok(());
        }
        self.control.check_line(text)?;
        block.parse(text, &mut self.parameters)?;
        self.control.check_assignment(block)?;
        if is_optional {
            self.control.notes.add(line, Subject::ExecutedOptionalBlock);
        }
        if let Some(word) = block.label.take() {
            if word.role == Role::Call {
                self.check_order(&word.label)?;
            }
            return self.flow.o_word(word, &mut self.parameters);
        }
        if block.is_empty() {
            return Ok(());
        }
        self.flow.start();
        let subprogram = block.code_of(Group::Subprogram);
        let is_call = matches!(subprogram, Some(Code { tenths: 980, .. }));
        if let Some(code) = subprogram
            && block.has_more_than_call()
            && (is_call || self.control.stated(Rule::Dialect) != Some(Choice::Iso))
        {
            // LinuxCNC reads P and L, and executes no other word of the block.
            return Err(GcodeFault::Combination {
                word: code.to_string(),
                condition: "its block has other words",
                remedy: "write them in a block before",
            });
        }
        self.control.execute(line, block)?;
        self.flow.count(self.control.pending.len())?;
        let call = if is_call { Some(self.called(block)?) } else { None };
        block.check_used()?;
        match (call, subprogram) {
            (Some((label, times)), _) => {
                self.check_order(&label)?;
                self.flow.call(label, Role::Title, times, &mut self.parameters)?;
            }
            (None, Some(_)) => self.flow.end_subprogram(&mut self.parameters)?,
            (None, None) => {}
        }
        match block.code_of(Group::Stop).map(|code| code.tenths) {
            Some(20 | 300) => {
                self.finish(End::Stop);
                if let Some(line) = self.flow.text_after_end() {
                    self.control.notes.add(line, Subject::TextAfterEnd);
                }
                if let Some(line) = self.flow.other_program() {
                    self.control.notes.add(line, Subject::OtherProgram);
                }
            }
            Some(_) => {
                self.control.pause_spindle();
                self.control.notes.add(line, Subject::Stop);
            }
            None => {}
        }
        Ok(())
    }
}

impl Iterator for Interpreter<'_> {
    type Item = Result<Step, GcodeError>;

    fn next(&mut self) -> Option<Self::Item> {
        loop {
            if let Some(step) = self.control.pending.pop_front() {
                return Some(Ok(step));
            }
            if self.finished {
                return None;
            }
            if let Err(error) = self.advance() {
                self.finished = true;
                self.control.pending.clear();
                return Some(Err(error));
            }
        }
    }
}

impl std::iter::FusedIterator for Interpreter<'_> {}

/// Returns the text after the first semicolon outside comments in brackets.
fn after_semicolon(text: &str) -> Option<&str> {
    let mut depth = 0;
    let position = text.bytes().position(|byte| {
        depth += i32::from(byte == b'(') - i32::from(byte == b')');
        byte == b';' && depth == 0
    })?;
    Some(&text[position + 1..])
}

/// Returns whether a text begins as a block does, and not as prose: with a word, an assignment or a statement.
fn could_be_block(text: &str) -> bool {
    let begin = |c: char| c == '/' || c.is_ascii_digit() || c.is_whitespace();
    let mut rest = text.trim_start_matches(begin);
    while let Some(comment) = rest.strip_prefix('(') {
        // A comment without an end is refused as on a line of its own.
        let Some((_, after)) = comment.split_once(')') else { return true };
        rest = after.trim_start_matches(begin);
    }
    let mut letters = rest.chars().filter(|c| !c.is_whitespace());
    let is_word = match letters.next() {
        Some('#') => true,
        Some(letter) if letter.is_ascii_alphabetic() => {
            letters.next().is_some_and(|next| next.is_ascii_digit() || "+-.[#".contains(next))
        }
        _ => false,
    };
    let name = rest.split(|c: char| !c.is_ascii_alphabetic()).next().unwrap_or_default();
    is_word || ["GOTO", "IF", "WHILE", "TRAORI", "TRAFOOF"].contains(&&*name.to_ascii_uppercase())
}

impl Control {
    /// Executes a block, in the order of RS274/NGC, table 8.
    pub(super) fn execute(&mut self, line: usize, block: &mut Block) -> Result<(), GcodeFault> {
        self.line = line;
        self.note_words(block);
        self.check_dialect(block)?;
        self.check_words(block)?;
        self.feed(block)?;
        self.tool(block)?;
        self.dwell(block)?;
        let turned = self.spindle_words(block);
        self.motion_mode(block);
        if let Some(word) = turned.filter(|_| is_programmed(block) && self.modal.is_feed()) {
            return Err(GcodeFault::Combination {
                word,
                condition: "its block has a motion at feed rate",
                remedy: "write it in a block before or after",
            });
        }
        self.settings(block)?;
        self.numbers(block);
        self.coordinates(block)?;
        self.returned_length(block);
        if self.depends_on_length(block) {
            self.length_without_word();
        }
        if self.modal.plane != Plane::Xy
            && is_programmed(block)
            && (self.length_implicit || self.state.tcp == Tcp::Transformation)
        {
            return Err(GcodeFault::Combination {
                word: "a position".to_owned(),
                condition: "G18 or G19 is in force and the length of the tool counts without G43, across the plane",
                remedy: "post the program in G17",
            });
        }
        self.check_offset(block)?;
        self.motion(block)
    }

    /// Takes the word with the time of G4: P, or X in ISO programs, or F, which is no feed rate then.
    fn dwell(&self, block: &mut Block) -> Result<(), GcodeFault> {
        if block.code_of(Group::Dwell).is_none() {
            return Ok(());
        }
        if block.has('S') {
            return Err(GcodeFault::Combination {
                word: "S".to_owned(),
                condition: "its block has G4, of which it is the time in turns of the spindle",
                remedy: "write it in a block before",
            });
        }
        let dialect = self.stated(Rule::Dialect);
        let has_time_in_x = !matches!(dialect, Some(Choice::Sinumerik | Choice::Heidenhain));
        if block.take('P').is_none() && block.code_of(Group::Motion).is_none() && has_time_in_x {
            block.take('X');
        }
        Ok(())
    }

    /// Gives the numbers of a block the unit that the control gives them.
    fn numbers(&mut self, block: &mut Block) {
        let has_length = block.is_nonzero("XYZIJKRQ");
        self.unit_used |= has_length;
        if !self.modal.unit_stated && has_length {
            self.modal.unit = match self.choice(Rule::Unit) {
                Choice::Inch => Unit::Inch,
                _ => Unit::Millimetre,
            };
        }
        if block.has_whole() && self.choice(Rule::WholeNumbers) == Choice::Increments {
            let has_angles = block.code_of(Group::Rotation).is_some();
            let (length, motion) = (self.modal.increment(), self.modal.motion);
            let has_whole_radius = block.is_whole('R') || block.is_whole('Q');
            let keeps_radii = has_whole_radius && self.choice(Rule::WholeRadii) == Choice::Units;
            block.scale_whole(|letter| match letter {
                'R' | 'Q' if keeps_radii => 1.0,
                'A' | 'B' | 'C' => 1e-3,
                // The number of repeats of a cycle.
                'K' if matches!(motion, Some(Motion::Cycle(_))) => 1.0,
                'I' | 'J' | 'K' | 'R' if has_angles => 1e-3,
                _ => length,
            });
        }
    }

    /// Notes the words that are passed over.
    fn note_words(&mut self, block: &Block) {
        for code in &block.passed_over {
            self.notes.add(self.line, Subject::PassedOver(*code));
        }
        if block.has('S') {
            self.notes.add(self.line, Subject::PassedOver(Code { letter: 'S', tenths: 0 }));
        }
    }

    /// Reads the feed mode and F.
    fn feed(&mut self, block: &mut Block) -> Result<(), GcodeFault> {
        if let Some(code) = block.code_of(Group::FeedMode) {
            let mode = match code.tenths {
                930 => FeedMode::InverseTime,
                940 => FeedMode::PerMinute,
                _ => FeedMode::PerRevolution,
            };
            // LinuxCNC asks for F again after each word.
            if mode != self.modal.feed_mode || self.stated(Rule::Dialect) == Some(Choice::Rs274Ngc)
            {
                self.modal.feed = None;
            }
            self.modal.feed_mode = mode;
        }
        if self.modal.feed_mode == FeedMode::InverseTime {
            self.modal.feed = None;
        }
        // F of a dwell is its time on some controls.
        let is_dwell = block.code_of(Group::Dwell).is_some();
        match block.take('F') {
            Some(value) if value < 0.0 => {
                let expected = "a positive number";
                return Err(GcodeFault::NotAllowed { word: 'F', value, expected });
            }
            Some(feed) if !is_dwell => self.modal.feed = Some(feed).filter(|feed| *feed > 0.0),
            _ => {}
        }
        // LinuxCNC asks for a feed rate also where no axis moves (`convert_straight`).
        match block.code_of(Group::Motion) {
            Some(Code { tenths: 10, .. })
                if self.stated(Rule::Dialect) == Some(Choice::Rs274Ngc) =>
            {
                self.check_feed("G1")
            }
            _ => Ok(()),
        }
    }

    /// Reads the settings that convert and interpret the other words.
    fn settings(&mut self, block: &mut Block) -> Result<(), GcodeFault> {
        let takes_p = |code: &Code| *code == READ_AHEAD || code.letter == 'M' && is_output(*code);
        if block.passed_over.iter().any(takes_p) {
            block.take('P');
        }
        let tenths = |group| block.code_of(group).map(|code| code.tenths);
        if let Some(unit) = tenths(Group::Units) {
            let is_inch = matches!(unit, 200 | 700 | 7000);
            let unit = if is_inch { Unit::Inch } else { Unit::Millimetre };
            let switches = self.unit_used && unit != self.modal.unit;
            if switches && matches!(self.stated(Rule::Dialect), None | Some(Choice::Iso)) {
                return Err(GcodeFault::Combination {
                    word: if is_inch { "G20" } else { "G21" }.to_owned(),
                    condition: "the program has lengths in another unit",
                    remedy: "select the unit once, at the start",
                });
            }
            self.modal.unit = unit;
            self.modal.unit_stated = true;
        }
        if let Some(distance) = tenths(Group::Distance) {
            self.modal.incremental = distance == 910;
        }
        if let Some(distance) = tenths(Group::ArcDistance) {
            self.modal.absolute_centres = Some(distance == 901);
        }
        if let Some(retract) = tenths(Group::Retract) {
            self.modal.retract_to_r = Some(retract == 990);
        }
        if let Some(plane) = tenths(Group::Plane) {
            self.select(match plane {
                170 => Plane::Xy,
                180 => Plane::Zx,
                _ => Plane::Yz,
            })?;
        }
        if let Some(code) = block.code_of(Group::PathControl) {
            path_control(block, code)?;
            self.modal.exact_path = matches!(code.tenths, 610 | 611);
            self.notes.add(self.line, Subject::PassedOver(code));
        }
        Ok(())
    }
}

/// The number of blocks that a Haas reads ahead (G103 P).
const READ_AHEAD: Code = Code { letter: 'G', tenths: 1030 };

/// Returns whether an M word sets an output of LinuxCNC (M62 to M65).
fn is_output(code: Code) -> bool {
    matches!(code.tenths, 620 | 630 | 640 | 650)
}

/// Takes the words of a path mode.
fn path_control(block: &mut Block, code: Code) -> Result<(), GcodeFault> {
    let switch = match code.tenths {
        640 | 1870 => {
            block.take('P');
            if code.tenths == 640 {
                block.take('Q');
            }
            return Ok(());
        }
        610 | 611 => return Ok(()),
        51 => 'Q',
        _ => 'P',
    };
    // Fanuc's modes G5 P, G5.1 Q and G8 P. With axis words they are splines, without any a mode of a lathe.
    match block.take(switch) {
        Some(_) if !block.has_any("XYZIJK") => Ok(()),
        _ => {
            let meaning = "a spline, or a mode of a lathe, without the word of its path mode";
            let remedy = "post the program with lines and arcs";
            Err(GcodeFault::NotRead { word: code.to_string(), meaning, remedy })
        }
    }
}
