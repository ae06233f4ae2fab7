//! Programs of ISO 6983 and of its dialects: Fanuc and Haas, LinuxCNC, and DIN/ISO of Heidenhain.
//!
//! ```text
//! text ──flow──▶ line ──line, expression──▶ block ──▶ control
//! ```

mod expression;
mod flow;
mod line;
mod linuxcnc;

pub use expression::ExpressionFault;
pub(super) use flow::{Place, line};

use super::block::{Block, Code, Group};
use super::control::Control;
use super::error::{combination, missing, not_read};
use super::interpreter::{End, Progress};
use super::note::NoteKind;
use super::rules::{Choice, Rule};
use super::{GcodeError, GcodeFault};
use expression::Parameters;
use flow::{Flow, before_semicolon};
use line::{Label, Line, Role};
use std::mem;

/// A program, and the place of its execution.
#[derive(Clone, Debug)]
pub(super) struct Program<'a> {
    flow: Flow<'a>,
    parameters: Parameters,
    line: Line,
    /// The number of the first switch for optional blocks.
    switch: Option<String>,
}

impl<'a> Program<'a> {
    /// Reads what holds for the whole text, which is not copied: its extent, its unit, and its subprograms.
    ///
    /// # Errors
    /// If two subprograms have one label, or a `sub` and its `endsub` do not match.
    pub(super) fn new(text: &'a str, control: &mut Control) -> Result<Program<'a>, GcodeError> {
        let extent = flow::extent(text);
        let flow = Flow::new(&extent)?;
        if control.stated(Rule::Dialect) == Some(Choice::Rs274Ngc) && flow.has_subprograms() {
            linuxcnc::check_text(extent.text)?;
        }
        // The head of a program of Heidenhain is a title elsewhere. No other control reads it.
        if let Some(unit) = extent.unit
            && matches!(control.stated(Rule::Dialect), None | Some(Choice::Heidenhain))
        {
            (control.modal.unit, control.modal.unit_stated) = (unit, true);
            control.state_rule(Rule::Dialect, Choice::Heidenhain);
        }
        if let Some((line, has_blocks)) = extent.left_out {
            let kind = if has_blocks { NoteKind::OtherProgram } else { NoteKind::TextAfterEnd };
            control.notes.add(line, kind);
        }
        let (parameters, line, switch) = (Parameters::default(), Line::default(), None);
        Ok(Program { flow, parameters, line, switch })
    }

    /// Executes the next line.
    pub(super) fn execute_line(&mut self, control: &mut Control) -> Result<Progress, GcodeError> {
        let Some((line, text)) = self.flow.next_line()? else {
            return Ok(Progress::Ended(End::Percent));
        };
        let result = self.blocks(line, text, control);
        result.map_err(|fault| GcodeError { line, fault })
    }

    /// Executes the block of a line, and those after semicolons if they end a block.
    fn blocks(
        &mut self,
        number: usize,
        text: &str,
        control: &mut Control,
    ) -> Result<Progress, GcodeFault> {
        control.line = number;
        // Prose is taken for a comment, so that the rule is asked about blocks only.
        let after = after_semicolon(text).filter(|after| after.split(';').any(could_be_block));
        let mut progress = self.line(number, text, control)?;
        let Some(after) = after else { return Ok(progress) };
        if control.choice(Rule::Semicolon) == Choice::Comment {
            return Ok(progress);
        }
        for text in after.split(';').filter(|text| could_be_block(text)) {
            if progress != Progress::GoesOn {
                break;
            }
            if self.line.block.code_of(Group::Subprogram).is_some() {
                let condition = "its block calls or ends a subprogram";
                let remedy = "write the block after it on a line of its own";
                return Err(combination("`;`", condition, remedy));
            }
            progress = self.line(number, text, control)?;
        }
        Ok(progress)
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
    fn check_order(&self, label: &Label, control: &Control) -> Result<(), GcodeFault> {
        match control.stated(Rule::Dialect) == Some(Choice::Rs274Ngc) && self.flow.has_passed(label)
        {
            true => Err(combination(
                format!("a call of {label}"),
                "it stands before the call and was not called before",
                "move it to the end of the file: LinuxCNC seeks it after the call only",
            )),
            false => Ok(()),
        }
    }

    fn line(
        &mut self,
        number: usize,
        text: &str,
        control: &mut Control,
    ) -> Result<Progress, GcodeFault> {
        let mut line = mem::take(&mut self.line);
        let result = self.execute(&mut line, number, text, control);
        self.line = line;
        result
    }

    fn execute(
        &mut self,
        line: &mut Line,
        number: usize,
        text: &str,
        control: &mut Control,
    ) -> Result<Progress, GcodeFault> {
        let switch = text.trim_start().strip_prefix('/');
        let is_optional = switch.is_some();
        if let Some(text) = switch {
            let digits = text.bytes().take_while(u8::is_ascii_digit).count();
            let first = self.switch.get_or_insert_with(|| text[..digits].to_owned());
            // `/2` is a switch of its own on Fanuc and Siemens.
            if *first != text[..digits] {
                control.notes.add(number, NoteKind::OptionalSwitches);
            }
        }
        if is_optional && control.choice(Rule::OptionalBlocks) == Choice::LeftOut {
            control.notes.add(number, NoteKind::OmittedOptionalBlock);
            return Ok(Progress::GoesOn);
        }
        check_text(text, control)?;
        line.parse(text, &mut self.parameters)?;
        check_assignment(line, control)?;
        if is_optional {
            control.notes.add(number, NoteKind::ExecutedOptionalBlock);
        }
        // A line with an O-word has no other word.
        if let Some(word) = line.label.take() {
            if word.role == Role::Call {
                self.check_order(&word.label, control)?;
            }
            self.flow.o_word(word, &mut self.parameters)?;
            return Ok(Progress::GoesOn);
        }
        if line.is_empty() {
            return Ok(Progress::GoesOn);
        }
        let assigns = line.assigns;
        let block = &mut line.block;
        self.flow.start();
        let subprogram = block.code_of(Group::Subprogram);
        let is_call = matches!(subprogram, Some(Code { tenths: 980, .. }));
        if let Some(code) = subprogram
            && (assigns || block.has_more_than_call())
            && (is_call || control.stated(Rule::Dialect) != Some(Choice::Iso))
        {
            // LinuxCNC reads P and L, and executes no other word of the block.
            let condition = "its block has other words";
            let remedy = "write them in a block before";
            return Err(combination(code, condition, remedy));
        }
        control.execute(number, block)?;
        // A canned cycle in a repeated subprogram has many steps per block.
        self.flow.count(control.pending.len())?;
        let call = if is_call { Some(self.called(block)?) } else { None };
        block.check_used()?;
        match (call, subprogram) {
            (Some((label, times)), _) => {
                self.check_order(&label, control)?;
                self.flow.call(label, Role::Title, times, &mut self.parameters)?;
            }
            (None, Some(_)) => self.flow.end_subprogram(&mut self.parameters)?,
            (None, None) => {}
        }
        match block.tenths_of(Group::Stop) {
            Some(20 | 300) => {
                if let Some(line) = self.flow.text_after_end() {
                    control.notes.add(line, NoteKind::TextAfterEnd);
                }
                if let Some(line) = self.flow.other_program() {
                    control.notes.add(line, NoteKind::OtherProgram);
                }
                return Ok(Progress::Ended(End::Stop));
            }
            Some(_) => {
                control.pause_spindle();
                control.notes.add(number, NoteKind::Stop);
            }
            None => {}
        }
        Ok(Progress::GoesOn)
    }
}

/// Refuses a line that the control does not read, whatever its words.
fn check_text(text: &str, control: &Control) -> Result<(), GcodeFault> {
    match control.stated(Rule::Dialect) {
        Some(Choice::Rs274Ngc) => linuxcnc::check_line(text),
        Some(Choice::Heidenhain) => {
            let Some(found) = before_semicolon(text).chars().find(|c| matches!(c, '(' | '#'))
            else {
                return Ok(());
            };
            let meaning = "no word of DIN/ISO programs of Heidenhain";
            let remedy = "write comments after `;` and numbers as such, or state another `dialect`";
            Err(not_read(format!("`{found}`"), meaning, remedy))
        }
        _ => Ok(()),
    }
}

/// Refuses values that depend on when the assignment of their line takes effect.
fn check_assignment(line: &Line, control: &Control) -> Result<(), GcodeFault> {
    match line.assigns_beside_value && control.stated(Rule::Dialect) != Some(Choice::Rs274Ngc) {
        true => Err(combination(
            "an assignment",
            "its block has another computed value, which LinuxCNC computes before it",
            "write it in a block before",
        )),
        false => Ok(()),
    }
}

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
