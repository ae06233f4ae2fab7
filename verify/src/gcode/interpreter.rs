//! The interpreter: executes the lines of a program in order, and returns their motions.

use super::blank::Blank;
use super::control::Control;
use super::files::in_file;
use super::note::ProgramNote;
use super::rules::{Choice, Rule};
use super::survey::Survey;
use super::{
    BlockLine, ControlSetup, GcodeError, GcodeFault, Step, SubprogramFile, iso, klartext, sinumerik,
};
use std::collections::BTreeMap;
use touchoff::{Unit, cancellation};

/// An interpreter of a program: an iterator over its steps.
///
/// It holds the state of the control and the steps of one block, so memory does not grow with the program. Under cutter compensation, it holds
/// those from one motion in the plane to the next.
/// After an error it returns no more steps.
#[derive(Clone, Debug)]
pub struct Interpreter<'a> {
    front: Front<'a>,
    files: &'a [SubprogramFile],
    pub(super) control: Control,
    pub(super) finished: bool,
    /// The line that is executed, and its text.
    pub(super) present: Option<(usize, &'a str)>,
    /// The number of lines that were executed.
    lines: usize,
    /// Set if an error has stopped the program.
    is_stopped: bool,
    /// Itself before the first block.
    first: Option<Box<Interpreter<'a>>>,
}

/// The text of a program in the language of its control, and the place of its execution. A front end translates each line into
/// blocks, and decides which line is next.
#[derive(Clone, Debug)]
enum Front<'a> {
    Iso(Box<iso::Program<'a>>),
    Klartext(Box<klartext::Program<'a>>),
    Sinumerik(Box<sinumerik::Program<'a>>),
}

/// The language of a program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Language {
    Iso,
    Klartext,
    Sinumerik,
}

/// The state of a program after a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Progress {
    GoesOn,
    Ended,
}

impl<'a> Interpreter<'a> {
    /// Creates an interpreter of a text, which is not copied, nor are the files of subprograms in the setup.
    ///
    /// # Errors
    /// If two subprograms have one label, or a `sub` and its `endsub` do not match.
    pub fn new(text: &'a str, setup: &'a ControlSetup) -> Result<Interpreter<'a>, GcodeError> {
        let files = &setup.subprograms[..];
        if let Some(line) = lone_return(text) {
            return Err(GcodeError { line, fault: GcodeFault::LoneReturn });
        }
        for (index, file) in files.iter().enumerate() {
            if let Some(line) = lone_return(&file.text) {
                let error = GcodeError { line, fault: GcodeFault::LoneReturn };
                return Err(GcodeError { line: 1, fault: in_file(files, index + 1, error) });
            }
        }
        let mut control = Control::new(setup);
        // ISO words mean the same in native programs of Sinumerik, so that one without native words is read as another one.
        let is_sinumerik = control.stated(Rule::Dialect) == Some(Choice::Sinumerik);
        let can_be_native = is_sinumerik || control.stated(Rule::Dialect).is_none();
        let front = if klartext::is_program(text) {
            Front::Klartext(Box::new(klartext::Program::new(text, setup, &mut control)?))
        } else if can_be_native && sinumerik::is_native(text, is_sinumerik) {
            Front::Sinumerik(Box::new(sinumerik::Program::new(text, setup, &mut control)?))
        } else {
            Front::Iso(Box::new(iso::Program::new(text, setup, &mut control)?))
        };
        let first = Interpreter {
            front,
            files,
            control,
            finished: false,
            present: None,
            lines: 0,
            is_stopped: false,
            first: None,
        };
        Ok(Interpreter { first: Some(Box::new(first.clone())), ..first })
    }

    /// Adds a step per new tool in the spindle, after its change: a [`StepPath::ToolChange`](super::StepPath::ToolChange) that moves no
    /// axis, in the state of the new tool.
    pub(crate) fn with_loads(mut self) -> Interpreter<'a> {
        self.control.has_loads = true;
        if let Some(first) = &mut self.first {
            first.control.has_loads = true;
        }
        self
    }

    /// Returns the rules of the control on which the blocks depend that were executed so far, each with the first block.
    pub fn asked(&self) -> &BTreeMap<Rule, BlockLine> {
        &self.control.asked
    }

    /// Returns the notes about the blocks that were executed so far, by line.
    pub fn notes(&self) -> Vec<ProgramNote> {
        let mut notes = self.control.notes.clone().list();
        notes.sort_by_key(|note| note.line);
        notes
    }

    /// Returns an execution of what follows the present block, which goes on behind errors: it finds what else stands in the way of the
    /// program. It begins with the block that has stopped the program, if one has.
    pub fn survey(&self) -> Survey<'a> {
        let mut rest = match &self.first {
            // The block has changed a part of the state before its error.
            Some(first) if self.is_stopped => (**first).clone(),
            _ => Interpreter { finished: false, first: None, ..self.clone() },
        };
        while self.is_stopped && rest.lines + 1 < self.lines && rest.execute_line().is_ok() {
            rest.control.pending.clear();
        }
        Survey::new(rest, self.is_stopped)
    }

    /// Returns whether it is a program of ISO words, which several controls read.
    pub(crate) fn is_iso(&self) -> bool {
        self.language() == Language::Iso
    }

    /// Returns the language of the program.
    pub(super) fn language(&self) -> Language {
        match &self.front {
            Front::Iso(_) => Language::Iso,
            Front::Klartext(_) => Language::Klartext,
            Front::Sinumerik(_) => Language::Sinumerik,
        }
    }

    /// Returns the unit of the program: the last that it has stated.
    pub(crate) fn unit(&self) -> Unit {
        match &self.front {
            Front::Klartext(program) => program.unit(),
            Front::Iso(_) | Front::Sinumerik(_) => self.control.modal.unit,
        }
    }

    /// Returns the blank that the program has stated so far as a box: by BLK FORM of Heidenhain Klartext, or by G30 and G31 of its DIN/ISO
    /// programs.
    pub fn blank(&self) -> Option<Blank> {
        match &self.front {
            Front::Klartext(program) => program.blank.blank(),
            Front::Iso(program) => program.blank.blank(),
            Front::Sinumerik(_) => None,
        }
    }

    /// Executes the next line, and returns whether the program goes on.
    pub(super) fn execute_line(&mut self) -> Result<bool, GcodeError> {
        cancellation::check();
        self.lines += 1;
        let file = self.called_file();
        let next = match &mut self.front {
            Front::Iso(program) => program.next_line(),
            Front::Klartext(program) => program.next_line(),
            Front::Sinumerik(program) => program.next_line(),
        };
        self.present = None;
        self.present = next.map_err(|error| self.in_program(file, error))?;
        match self.present {
            Some(_) => self.execute_again(),
            None => self.end(),
        }
    }

    /// Executes the present line, and returns whether the program goes on.
    pub(super) fn execute_again(&mut self) -> Result<bool, GcodeError> {
        let file = self.called_file();
        let Some((line, text)) = self.present else { return Ok(!self.finished) };
        let control = &mut self.control;
        let progress = match &mut self.front {
            Front::Iso(program) => program.execute_line(line, text, control),
            Front::Klartext(program) => program.execute_line(line, text, control),
            Front::Sinumerik(program) => program.execute_line(line, text, control),
        };
        match progress.map_err(|fault| self.in_program(file, GcodeError { line, fault }))? {
            Progress::GoesOn => Ok(true),
            Progress::Ended => self.end(),
        }
    }

    /// Executes a text in place of the present line, and returns whether the program goes on.
    pub(super) fn execute_instead(&mut self, text: &'a str) -> Result<bool, GcodeError> {
        self.present = self.present.map(|(line, _)| (line, text));
        self.execute_again()
    }

    /// Ends the program.
    fn end(&mut self) -> Result<bool, GcodeError> {
        let line = self.control.line;
        self.control.end().map_err(|fault| GcodeError { line, fault })?;
        self.finished = true;
        Ok(false)
    }

    /// Goes on behind the last line of the main program that was executed, out of all loops and calls, and returns whether it was not there.
    pub(super) fn go_past(&mut self) -> bool {
        match &mut self.front {
            Front::Iso(program) => program.go_past(),
            Front::Klartext(program) => program.go_past(),
            Front::Sinumerik(program) => program.go_past(),
        }
    }

    /// Goes on after the end of the loop that begins in the present line, if one does.
    pub(super) fn leave_loop(&mut self) {
        let Some((line, _)) = self.present else { return };
        match &mut self.front {
            Front::Iso(program) => program.leave_loop(line),
            // Its loops are jumps back, which are not made if their condition is not known.
            Front::Klartext(_) => {}
            Front::Sinumerik(program) => program.leave_loop(line),
        }
    }

    fn called_file(&self) -> Option<usize> {
        match &self.front {
            Front::Iso(program) => program.called_file(),
            Front::Klartext(program) => program.called_file(),
            Front::Sinumerik(program) => program.called_file(),
        }
    }

    /// Returns an error of a line in a file, if not in the program, as that of the line which calls it.
    fn in_program(&self, file: Option<usize>, error: GcodeError) -> GcodeError {
        match file {
            Some(file) => {
                GcodeError { line: self.control.line, fault: in_file(self.files, file, error) }
            }
            None => error,
        }
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
                self.is_stopped = true;
                return Some(Err(error));
            }
        }
    }
}

impl std::iter::FusedIterator for Interpreter<'_> {}

/// Returns the line of the first carriage return without a line feed.
fn lone_return(text: &str) -> Option<usize> {
    let bytes = text.as_bytes();
    let index = (0..bytes.len())
        .find(|index| bytes[*index] == b'\r' && bytes.get(index + 1) != Some(&b'\n'))?;
    Some(1 + bytes[..index].iter().filter(|byte| **byte == b'\n').count())
}
