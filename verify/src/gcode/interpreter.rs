//! The interpreter: reads blocks, executes them in order, and returns their motions.

use super::block::{Block, Code, Group, Label, Role};
use super::control::Control;
use super::error::{combination, missing};
use super::expression::Parameters;
use super::flow::{self, Flow};
use super::linuxcnc;
use super::note::NoteKind;
use super::rules::{Choice, Rule};
use super::{ControlSetup, GcodeError, GcodeFault, Step};
use std::collections::BTreeMap;
use std::mem;

/// An interpreter of a program: an iterator over its steps.
///
/// It holds the state of the control and the steps of one block, so memory does not grow with the program. Under cutter compensation, it holds
/// those from one motion in the plane to the next.
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
    pub(super) end: Option<End>,
    /// Itself before the first block.
    pub(super) first: Option<Box<Interpreter<'a>>>,
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
        if let Some(line) = flow::lone_return(text) {
            return Err(GcodeError { line, fault: GcodeFault::LoneReturn });
        }
        let extent = flow::extent(text);
        let flow = Flow::new(&extent)?;
        if setup.rules.get(Rule::Dialect) == Some(Choice::Rs274Ngc) && flow.has_subprograms() {
            linuxcnc::check_text(extent.text)?;
        }
        let mut control = Control::new(setup);
        let dialect = setup.rules.get(Rule::Dialect);
        // The head of a program of Heidenhain is a title elsewhere. No other control reads it.
        if let Some(unit) = extent.unit
            && matches!(dialect, None | Some(Choice::Heidenhain))
        {
            (control.modal.unit, control.modal.unit_stated) = (unit, true);
            control.state_rule(Rule::Dialect, Choice::Heidenhain);
        }
        if let Some((line, has_blocks)) = extent.left_out {
            let kind = if has_blocks { NoteKind::OtherProgram } else { NoteKind::TextAfterEnd };
            control.notes.add(line, kind);
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

    /// Returns the rules of the control on which the blocks depend that were executed so far, each with the first line.
    pub fn asked(&self) -> &BTreeMap<Rule, usize> {
        &self.control.asked
    }

    /// Executes the next line, and returns whether the program goes on.
    pub(super) fn execute_line(&mut self) -> Result<bool, GcodeError> {
        let Some((line, text)) = self.flow.next_line()? else {
            let line = self.control.line;
            self.control.end_compensation().map_err(|fault| GcodeError { line, fault })?;
            self.finish(End::Percent);
            return Ok(false);
        };
        let mut block = mem::take(&mut self.block);
        let result = self.blocks(line, text, &mut block);
        self.block = block;
        result.map_err(|fault| GcodeError { line, fault })?;
        Ok(!self.finished)
    }

    fn finish(&mut self, end: End) {
        self.finished = true;
        self.end = Some(end);
    }

    /// Executes the block of a line, and those after semicolons if they end a block.
    fn blocks(&mut self, line: usize, text: &str, block: &mut Block) -> Result<(), GcodeFault> {
        self.control.line = line;
        // Prose is taken for a comment, so that the rule is asked about blocks only.
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
                let condition = "its block calls or ends a subprogram";
                let remedy = "write the block after it on a line of its own";
                return Err(combination("`;`", condition, remedy));
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
            return Err(missing("M98", needed));
        };
        // Older controls take the last four digits as the number, and those before as repeats.
        if number > 9999 && self.flow.has(&Label::Number(number % 10_000)) {
            let condition = "its last four digits are the number of a program, too";
            let remedy = "give the program another number, and write repeats after L";
            return Err(combination(format!("M98 P{number}"), condition, remedy));
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
            true => Err(combination(
                format!("a call of {label}"),
                "it stands before the call and was not called before",
                "move it to the end of the file: LinuxCNC seeks it after the call only",
            )),
            false => Ok(()),
        }
    }

    fn line(&mut self, line: usize, text: &str, block: &mut Block) -> Result<(), GcodeFault> {
        let switch = text.trim_start().strip_prefix('/');
        let is_optional = switch.is_some();
        if let Some(text) = switch {
            let digits = text.bytes().take_while(u8::is_ascii_digit).count();
            let first = self.switch.get_or_insert_with(|| text[..digits].to_owned());
            // `/2` is a switch of its own on Fanuc and Siemens.
            if *first != text[..digits] {
                self.control.notes.add(line, NoteKind::OptionalSwitches);
            }
        }
        if is_optional && self.control.choice(Rule::OptionalBlocks) == Choice::LeftOut {
            self.control.notes.add(line, NoteKind::OmittedOptionalBlock);
            return Ok(());
        }
        self.control.check_line(text)?;
        block.parse(text, &mut self.parameters)?;
        self.control.check_assignment(block)?;
        if is_optional {
            self.control.notes.add(line, NoteKind::ExecutedOptionalBlock);
        }
        // A line with an O-word has no other word.
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
            let condition = "its block has other words";
            let remedy = "write them in a block before";
            return Err(combination(code, condition, remedy));
        }
        self.control.execute(line, block)?;
        // A canned cycle in a repeated subprogram has many steps per block.
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
        match block.tenths_of(Group::Stop) {
            Some(20 | 300) => {
                self.finish(End::Stop);
                if let Some(line) = self.flow.text_after_end() {
                    self.control.notes.add(line, NoteKind::TextAfterEnd);
                }
                if let Some(line) = self.flow.other_program() {
                    self.control.notes.add(line, NoteKind::OtherProgram);
                }
            }
            Some(_) => {
                self.control.pause_spindle();
                self.control.notes.add(line, NoteKind::Stop);
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
            if let Err(error) = self.execute_line() {
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

/// Returns whether a character may stand before the first word: of `/`, of a number of its switch, or a blank.
fn can_precede_block(c: char) -> bool {
    c == '/' || c.is_ascii_digit() || c.is_whitespace()
}

/// Returns whether a text begins as a block does, and not as prose: with a word, an assignment or a statement.
fn could_be_block(text: &str) -> bool {
    let mut rest = text.trim_start_matches(can_precede_block);
    while let Some(comment) = rest.strip_prefix('(') {
        // A comment without an end is refused as on a line of its own.
        let Some((_, after)) = comment.split_once(')') else { return true };
        rest = after.trim_start_matches(can_precede_block);
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
