//! Programs of ISO 6983 and of its dialects: Fanuc and Haas, LinuxCNC, and DIN/ISO of Heidenhain.
//!
//! ```text
//! text ──flow──▶ line ──line, expression──▶ block ──▶ control
//! ```

mod blank;
mod expression;
mod flow;
mod line;
mod structure;
mod system;
mod variables;

pub use expression::ExpressionFault;
pub(super) use flow::{Place, line};

use super::blank::{BlankCorner, BlankWords};
use super::block::{Block, Code, Group};
use super::control::Control;
use super::cursor::Cursor;
use super::error::{combination, missing, not_read};
use super::files::{self, CalledFolders, in_file};
use super::interpreter::Progress;
use super::note::NoteKind;
use super::rules::{Choice, Rule};
use super::{ControlSetup, GcodeError, GcodeFault, Repeated, SubprogramFile, shown, work};
use blank::{BlankLine, blank_line};
use expression::{Language, Rounding, Value, condition, value};
use flow::{Callee, Flow, Source, before_semicolon};
use line::{
    Label, Line, MacroCall, OWord, Role, Statement, begin, begins_title, check_end, next, o_word,
};
use std::mem;
use structure::{Clause, Structure, Subprogram};
use variables::{Locals, Parameter, Scope, Variables};

/// Returns the name of a variable in one spelling: `#500`, or `#<_depth>`.
pub(crate) fn variable_name(text: &str) -> Option<String> {
    Parameter::declared(text).map(|parameter| parameter.shown())
}

/// A program, and the place of its execution.
#[derive(Clone, Debug)]
pub(super) struct Program<'a> {
    flow: Flow<'a>,
    /// The flows of other files that wait for the end of a subprogram.
    waiting: Vec<Flow<'a>>,
    files: &'a [SubprogramFile],
    variables: Variables,
    line: Line,
    /// The number of the first switch for optional blocks.
    switch: Option<String>,
    pub(super) blank: BlankWords,
    folders: CalledFolders,
}

impl<'a> Program<'a> {
    /// Reads what holds for the whole text and for the files of subprograms, which are not copied: extent, unit, subprograms and loops.
    ///
    /// # Errors
    /// If two subprograms have one label, or a `sub` and its `endsub` do not match.
    pub(super) fn new(
        text: &'a str,
        setup: &'a ControlSetup,
        control: &mut Control,
    ) -> Result<Program<'a>, GcodeError> {
        let files = &setup.subprograms[..];
        let extent = flow::extent(text);
        let mut variables = Variables::new(&setup.variables);
        variables.has_angles = has_angles(text) || files.iter().any(|file| has_angles(&file.text));
        let structure = Structure::find(extent.text, &Scope::new(&variables, control))?;
        let in_file = |index, error| GcodeError { line: 1, fault: in_file(files, index, error) };
        let mut others = Vec::new();
        for (index, file) in (1..).zip(files) {
            let extent = flow::extent(&file.text);
            let found = Structure::find(extent.text, &Scope::new(&variables, control));
            let found = found.map_err(|error| in_file(index, error))?;
            others.push(Source::new(Some(file), extent, found));
        }
        // The head of a program of Heidenhain is a title elsewhere. No other control reads it.
        if let Some(unit) = extent.unit
            && matches!(control.stated(Rule::Dialect), None | Some(Choice::Heidenhain))
        {
            (control.modal.unit, control.modal.unit_stated) = (unit, true);
            control.state_rule(Rule::Dialect, Choice::Heidenhain);
        }
        // No other control executes these statements.
        if control.stated(Rule::Dialect).is_none() {
            let all = || others.iter().map(|other| &other.structure).chain([&structure]);
            match (all().any(|one| one.fanuc.is_some()), all().any(|one| one.linuxcnc.is_some())) {
                (true, false) => control.state_rule(Rule::Dialect, Choice::Iso),
                (false, true) => control.state_rule(Rule::Dialect, Choice::Rs274Ngc),
                _ => {}
            }
        }
        if let Some((line, has_blocks)) = extent.left_out {
            let kind = if has_blocks { NoteKind::OtherProgram } else { NoteKind::TextAfterEnd };
            control.notes.add(line.into(), kind);
        }
        let sources: Vec<Source> =
            [Source::new(None, extent, structure)].into_iter().chain(others).collect();
        flow::check_files(&sources, files, is_linuxcnc(control))?;
        let flow = Flow::new(sources.into(), Repeated::new(setup));
        let (waiting, line) = (Vec::new(), Line::default());
        Ok(Program {
            flow,
            waiting,
            files,
            variables,
            line,
            switch: None,
            blank: BlankWords::default(),
            folders: CalledFolders::default(),
        })
    }

    /// Returns the number of the file of a called subprogram, if it is not in the program's.
    pub(super) fn called_file(&self) -> Option<usize> {
        (!self.waiting.is_empty()).then_some(self.flow.file)
    }

    /// Returns the next line and its number, or `None` where `%` ends the program.
    pub(super) fn next_line(&mut self) -> Result<Option<(usize, &'a str)>, GcodeError> {
        self.flow.next_line()
    }

    /// Executes a line.
    pub(super) fn execute_line(
        &mut self,
        line: usize,
        text: &'a str,
        control: &mut Control,
    ) -> Result<Progress, GcodeFault> {
        let result = self.blocks(line, text, control);
        while self.flow.is_left()
            && let Some(flow) = self.waiting.pop()
        {
            let called = mem::replace(&mut self.flow, flow);
            self.flow.go_on_after(&called);
        }
        result
    }

    /// Goes on behind the last line of the main program that was executed, out of all loops and calls, and returns whether it was not there.
    pub(super) fn go_past(&mut self) -> bool {
        let is_called = !self.waiting.is_empty() || !self.flow.is_main();
        if !self.waiting.is_empty() {
            self.flow = self.waiting.swap_remove(0);
            self.waiting.clear();
        }
        self.flow.go_past(&mut self.variables) || is_called
    }

    /// Goes on after the end of the loop that begins in a line, if one does.
    pub(super) fn leave_loop(&mut self, line: usize) {
        if let Some(clause) = self.flow.structure().clause(line) {
            self.flow.jump(clause.after);
        }
    }

    /// Returns whether a subprogram with a label is in one of the files.
    fn has(&self, label: &Label, control: &Control) -> bool {
        self.flow.find(label, is_linuxcnc(control)).is_some()
    }

    /// Calls a subprogram with a title (M98, G65) or of O-words (`call`), of the present file or, if that has none, of another one.
    fn call(&mut self, callee: Callee, control: &Control) -> Result<(), GcodeFault> {
        let label = &callee.label;
        match self.flow.find(label, is_linuxcnc(control)) {
            Some((file, subprogram)) => self.enter(file, subprogram, callee),
            None => Err(GcodeFault::NoSubprogram { label: label.to_string() }),
        }
    }

    /// Calls a subprogram of a file.
    fn enter(
        &mut self,
        file: usize,
        subprogram: Subprogram,
        callee: Callee,
    ) -> Result<(), GcodeFault> {
        if file != self.flow.file {
            let called = self.flow.inside(file);
            self.waiting.push(mem::replace(&mut self.flow, called));
        }
        self.flow.call(subprogram, callee, &mut self.variables)
    }

    /// Executes the block of a line, and those after semicolons if they end a block.
    fn blocks(
        &mut self,
        number: usize,
        text: &str,
        control: &mut Control,
    ) -> Result<Progress, GcodeFault> {
        control.set_line(self.called_file(), number);
        // Prose is taken for a comment, so that the rule is asked about blocks only.
        let after = after_semicolon(text).filter(|after| after.split(';').any(could_be_block));
        self.line.has_branched = false;
        let mut progress = self.line(number, text, control)?;
        let Some(after) = after else { return Ok(progress) };
        if control.choice(Rule::Semicolon) == Choice::Comment {
            return Ok(progress);
        }
        for text in after.split(';').filter(|text| could_be_block(text)) {
            if progress != Progress::GoesOn {
                break;
            }
            if self.line.has_branched {
                let condition = "its block decides, or calls or ends a subprogram";
                let remedy = "write the block after it on a line of its own";
                return Err(combination("`;`", condition, remedy));
            }
            progress = self.line(number, text, control)?;
        }
        Ok(progress)
    }

    /// Executes one block: a line, or a part of one after a semicolon.
    fn line(
        &mut self,
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
                control.notes.add(control.block(), NoteKind::OptionalSwitches);
            }
        }
        if is_optional && control.choice(Rule::OptionalBlocks) == Choice::LeftOut {
            control.notes.add(control.block(), NoteKind::OmittedOptionalBlock);
            return Ok(Progress::GoesOn);
        }
        check_text(text, control)?;
        let mut cursor = begin(text);
        let byte = next(&mut cursor)?;
        let is_linuxcnc = control.stated(Rule::Dialect) == Some(Choice::Rs274Ngc);
        if byte
            .is_some_and(|byte| begins_title(byte) && (!is_linuxcnc || byte.is_ascii_alphabetic()))
        {
            self.o_word(&mut cursor, number, control)?;
            return Ok(Progress::GoesOn);
        }
        let mut modes = None;
        if is_heidenhain(control)
            && let Some(line) = blank_line(text)
        {
            modes = Some(self.blank_corner(line?, control));
        }
        let mut line = mem::take(&mut self.line);
        let scope = Scope::new(&self.variables, control);
        let text = modes.as_deref().unwrap_or(text);
        let result = line.parse(text, &scope).and_then(|()| {
            if is_optional {
                control.notes.add(control.block(), NoteKind::ExecutedOptionalBlock);
            }
            self.execute(&mut line, number, control)
        });
        self.line = line;
        result
    }

    /// Keeps a corner of the blank, and returns the words of its line that are executed.
    fn blank_corner(&mut self, line: BlankLine, control: &mut Control) -> String {
        let scale = control.modal.unit.millimetres();
        let position = line.position.map(|position| position.map(|value| value * scale));
        let is_called = !self.waiting.is_empty();
        let is_moved = control.moves_coordinates();
        let corner = line.corner;
        self.blank.corner(BlankCorner { corner, position, is_called, is_moved }, control);
        let word = ["G30", "G31"][line.corner].to_owned();
        control.notes.add(control.block(), NoteKind::PassedOver { word });
        line.modes
    }

    /// Executes a line that was read.
    fn execute(
        &mut self,
        line: &mut Line,
        number: usize,
        control: &mut Control,
    ) -> Result<Progress, GcodeFault> {
        check_assignment(line, control)?;
        // All values of the block were computed with the variables before it (RS274/NGC, section 3.3.3.4).
        for (parameter, value) in line.assignments.drain(..) {
            self.assign(&parameter, value, control)?;
        }
        // M words have no axis words.
        let can_own_axes = line.ignored.iter().any(|word| !word.starts_with('M'));
        for word in line.ignored.drain(..) {
            control.ignore(word);
        }
        if line.is_empty() {
            return Ok(Progress::GoesOn);
        }
        self.flow.start();
        if let Some(statement) = line.statement {
            line.has_branched = !matches!(statement, Statement::Nothing | Statement::Print(_));
            self.decide(statement, number, control)?;
            return Ok(Progress::GoesOn);
        }
        if let Some(call) = line.call.take() {
            line.has_branched = !call.is_modal;
            let is_within = self.waiting.iter().chain([&self.flow]).any(Flow::is_in_modal_call);
            if is_within || self.flow.modal.is_some() {
                let (condition, remedy) = ("G66 is in force", "write G67 before");
                return Err(combination(
                    if call.is_modal { "G66" } else { "G65" },
                    condition,
                    remedy,
                ));
            }
            match call.is_modal {
                true => self.flow.modal = Some(call),
                false => self.call_macro(&call, control)?,
            }
            return Ok(Progress::GoesOn);
        }
        let block = &mut line.block;
        let subprogram = block.code_of(Group::Subprogram);
        line.has_branched = subprogram.is_some();
        let is_call = matches!(subprogram, Some(Code { tenths: 970 | 980 | 1980, .. }));
        if let Some(code) = subprogram
            && (line.assigns || block.has_more_than_call())
            && (is_call || control.stated(Rule::Dialect) != Some(Choice::Iso))
        {
            // LinuxCNC reads P and L, and executes no other word of the block.
            let condition = "its block has other words";
            let remedy = "write them in a block before";
            return Err(combination(code, condition, remedy));
        }
        // They could be the word's own.
        if can_own_axes && block.has_any("XYZABCIJK") {
            let condition = "its block has an ignored word, whose own they could be";
            let remedy = "write them in a block of their own";
            return Err(combination("axis words", condition, remedy));
        }
        let ignores = line.ignores;
        // The next G43 or G41 takes the last H or D, and a cycle its letters.
        let of_cycle = if control.is_in_cycle() { "QRL" } else { "" };
        let taken =
            [("H", Group::Length), ("D", Group::CutterCompensation), (of_cycle, Group::Motion)];
        let taken = taken
            .into_iter()
            .find(|(letters, group)| block.code_of(*group).is_none() && block.has_any(letters));
        if let (true, Some((letters, _))) = (ignores, taken) {
            let condition = "its block has an ignored word, whose own it could be, as well as that of what is in force";
            return Err(combination(letters, condition, "write the word in a block of its own"));
        }
        // Letters that no other word has used belong to an ignored one.
        let check_used = |block: &mut Block| {
            if ignores {
                block.drop_letters("PQLRDHE");
            }
            block.check_used()
        };
        if block.passed_over.iter().any(|code| (code.letter, code.tenths) == ('G', 670)) {
            self.flow.modal = None;
        }
        if self.flow.modal.is_some() {
            let is_return = |code: &Code| matches!(code.tenths, 280 | 300);
            let one_shot = block.code_of(Group::OneShot).filter(is_return);
            if let Some(code) = one_shot.or(block.code_of(Group::Machine)) {
                let condition = "G66 is in force, which calls the macro after each motion";
                return Err(combination(code, condition, "write G67 before"));
            }
        }
        let owns = block.owns_axis_words();
        let [has_end, has_centre] = ["XYZABC", "IJK"].map(|letters| block.has_any(letters));
        let before = control.pending.len();
        control.execute(block)?;
        // The centre of a full circle moves without an end.
        let moves = !owns && (has_end || has_centre && control.pending.len() > before);
        // A canned cycle in a repeated subprogram has many steps per block.
        self.flow.count(control.pending.len())?;
        match subprogram.map(|code| code.tenths) {
            Some(tenths @ (970 | 980 | 1980)) => {
                let call = self.called(block, tenths, line.file.take(), control)?;
                check_used(block)?;
                self.subprogram(call, number, control)?;
            }
            Some(_) => {
                let expected = "M99 P with a sequence number of the caller";
                let target = block.take_whole('P', 1, 99_999_999, expected)?;
                check_used(block)?;
                self.variables.forget_returned();
                if self.flow.is_main() && target.is_none() {
                    control.notes.add(control.block(), NoteKind::Endless);
                    self.note_other_program(control);
                    return Ok(Progress::Ended);
                }
                match (target, self.flow.returns_to_file(), self.waiting.last_mut()) {
                    (Some(target), true, Some(caller)) => {
                        caller.return_to(target)?;
                        self.flow.abandon(&mut self.variables)?;
                    }
                    _ => self.flow.end_subprogram(target, number, &mut self.variables)?,
                }
            }
            None => check_used(block)?,
        }
        if moves
            && subprogram.is_none()
            && let Some(call) = self.flow.modal.clone()
        {
            line.has_branched = true;
            self.call_macro(&call, control)?;
        }
        match block.tenths_of(Group::Stop) {
            Some(20 | 300) => {
                if let Some(line) = self.flow.text_after_end() {
                    control.notes.add(line.into(), NoteKind::TextAfterEnd);
                }
                self.note_other_program(control);
                return Ok(Progress::Ended);
            }
            Some(_) => {
                control.pause_spindle();
                control.notes.add(control.block(), NoteKind::Stop);
            }
            None => {}
        }
        Ok(Progress::GoesOn)
    }

    /// Notes that the file has another program, which is not executed.
    fn note_other_program(&self, control: &mut Control) {
        if let Some(line) = self.flow.other_program() {
            control.notes.add(line.into(), NoteKind::OtherProgram);
        }
    }

    /// Assigns a variable.
    fn assign(
        &mut self,
        parameter: &Parameter,
        value: Value,
        control: &mut Control,
    ) -> Result<(), GcodeFault> {
        let language = language(control);
        if let (Parameter::Numbered(number), Some(Language::Fanuc)) = (parameter, language) {
            match number {
                // An alarm stops the machine, and a message until the operator starts it again.
                3000 => return Err(GcodeFault::Alarm { number: value.unwrap_or(0.0) }),
                3006 => {
                    control.pause_spindle();
                    control.notes.add(control.block(), NoteKind::Stop);
                    return Ok(());
                }
                // Single block, and exact stop, which leave the path.
                3003 | 3004 => {
                    let word = format!("#{number}");
                    control.notes.add(control.block(), NoteKind::PassedOver { word });
                    return Ok(());
                }
                _ => {}
            }
        }
        Ok(self.variables.assign(parameter, value, language)?)
    }

    /// Obeys a statement of a macro of Fanuc.
    fn decide(
        &mut self,
        statement: Statement,
        line: usize,
        control: &mut Control,
    ) -> Result<(), GcodeFault> {
        let clause = || {
            let clause = self.flow.structure().clause(line);
            clause.ok_or(GcodeFault::OpenLoop)
        };
        match statement {
            Statement::GoTo(number) => self.flow.go_to(number, line)?,
            Statement::Do { holds } => {
                let after = clause()?.after;
                if !holds {
                    self.flow.jump(after);
                }
            }
            Statement::End => {
                let head = clause()?.head;
                self.flow.jump(head);
            }
            Statement::Nothing => {}
            Statement::Print(word) => {
                let word = word.to_owned();
                control.notes.add(control.block(), NoteKind::PassedOver { word });
            }
        }
        Ok(())
    }

    /// Calls a macro with its arguments.
    fn call_macro(&mut self, call: &MacroCall, control: &Control) -> Result<(), GcodeFault> {
        let locals =
            Locals { numbered: call.arguments.clone(), is_macro: true, ..Locals::default() };
        let callee = Callee {
            label: Label::Number(call.program),
            role: Role::Title,
            times: call.repeats,
            locals: Some(locals),
        };
        self.call(callee, control)
    }

    /// Returns the subprogram of M98, M97 or M198; `file` is the name of a file beside it.
    fn called(
        &mut self,
        block: &mut Block,
        tenths: u32,
        file: Option<String>,
        control: &Control,
    ) -> Result<Called, GcodeFault> {
        let is_linuxcnc = is_linuxcnc(control);
        let expected = "the number of a program after P";
        let (word, needed) = match tenths {
            970 => ("M97", "P with a sequence number"),
            980 => ("M98", "P with the number of a program"),
            _ => ("M198", "P with the number of a program"),
        };
        let number = block.take_whole('P', 0, 99_999_999, expected)?;
        let least = u32::from(!is_linuxcnc);
        let expected = "a number of repeats from 1 after L";
        let times = block.take_whole('L', least, 99_999_999, expected)?;
        let Some(number) = number else {
            let Some(name) = file else { return Err(missing(word, needed)) };
            self.folders.check(&name, files::without_folder(&name))?;
            // A program is named by its title, and one without a title by its file.
            let label = Label::of_title(&name);
            let target = match self.flow.find(&label, is_linuxcnc) {
                Some((0, _)) => Target::Program(label),
                Some((file, subprogram)) => Target::File(file, subprogram),
                None => match files::find(self.files, &name) {
                    Some(file) => Target::File(file, self.flow.whole(file)),
                    None => return Err(GcodeFault::NoSubprogram { label: shown(&name) }),
                },
            };
            return Ok(Called { target, times: times.unwrap_or(1) });
        };
        let target = match tenths {
            970 => Target::Sequence(number),
            1980 => {
                let label = Label::Number(number);
                let found = self.flow.find(&label, is_linuxcnc).filter(|(file, _)| *file > 0);
                let Some((file, subprogram)) = found else {
                    return Err(GcodeFault::NoSubprogram { label: label.to_string() });
                };
                Target::File(file, subprogram)
            }
            _ if number > 9999 && !is_linuxcnc => {
                return self.called_with_repeats(number, times, control);
            }
            _ => Target::Program(Label::Number(number)),
        };
        Ok(Called { target, times: times.unwrap_or(1) })
    }

    /// Returns the subprogram of M98 with more than four digits: older controls take the last four as the number, and those before as
    /// repeats.
    fn called_with_repeats(
        &self,
        number: u32,
        times: Option<u32>,
        control: &Control,
    ) -> Result<Called, GcodeFault> {
        let [whole, last] =
            [number, number % 10_000].map(|number| self.has(&Label::Number(number), control));
        let (number, times) = match (whole, last, times) {
            (true, true, _) => {
                let condition = "its last four digits are the number of a program, too";
                let remedy = "give the program another number, and write repeats after L";
                return Err(combination(format!("M98 P{number}"), condition, remedy));
            }
            (false, true, None) => (number % 10_000, number / 10_000),
            _ => (number, times.unwrap_or(1)),
        };
        Ok(Called { target: Target::Program(Label::Number(number)), times })
    }

    /// Calls a subprogram by M98 or M97.
    fn subprogram(
        &mut self,
        call: Called,
        line: usize,
        control: &Control,
    ) -> Result<(), GcodeFault> {
        let Called { target, times } = call;
        // LinuxCNC passes over `M98 L0`.
        if times == 0 {
            return Ok(());
        }
        let callee = |label| Callee { label, role: Role::Title, times, locals: None };
        match target {
            Target::Sequence(number) => {
                self.flow.call_local(number, times, line, &mut self.variables)
            }
            Target::Program(label) => {
                self.check_order(&label, control)?;
                self.call(callee(label), control)
            }
            Target::File(file, subprogram) => {
                let label = Label::of_file(self.files[file - 1].stem());
                self.enter(file, subprogram, callee(label))
            }
        }
    }

    /// Refuses a call of a subprogram that LinuxCNC does not find: it seeks those that it does not know after the call only
    /// (`control_back_to`).
    fn check_order(&self, label: &Label, control: &Control) -> Result<(), GcodeFault> {
        match is_linuxcnc(control) && self.flow.has_passed(label) {
            true => Err(combination(
                format!("a call of {label}"),
                "it stands before the call and was not called before",
                "move it to the end of the file: LinuxCNC seeks it after the call only",
            )),
            false => Ok(()),
        }
    }

    /// Executes a line with an O-word, which has no other word.
    fn o_word(
        &mut self,
        cursor: &mut Cursor,
        line: usize,
        control: &mut Control,
    ) -> Result<(), GcodeFault> {
        let scope = Scope::new(&self.variables, control);
        let OWord { label, role } = o_word(cursor, &scope)?;
        if role.is_decision()
            && !matches!(control.stated(Rule::Dialect), None | Some(Choice::Rs274Ngc))
        {
            let (meaning, remedy) = ("an O-word of LinuxCNC", "state another `dialect`");
            return Err(not_read(role.word(), meaning, remedy));
        }
        match role {
            Role::Title => {
                check_end(cursor)?;
                self.flow.title(&label)
            }
            Role::Sub => {
                check_end(cursor)?;
                self.variables.forget_returned();
                self.flow.pass_sub(&label)
            }
            Role::Call => {
                let mut locals = Locals::of_call();
                let mut number = 0;
                while next(cursor)? == Some(b'[') {
                    number += 1;
                    if number > 30 {
                        return Err(GcodeFault::TooManyArguments);
                    }
                    locals.numbered.insert(number, value(cursor, &scope, Rounding::Whole)?);
                }
                check_end(cursor)?;
                self.check_order(&label, control)?;
                let callee = Callee { label, role: Role::Sub, times: 1, locals: Some(locals) };
                self.call(callee, control)
            }
            Role::EndSub | Role::Return => {
                let returned = match next(cursor)? {
                    Some(b'[') => value(cursor, &scope, Rounding::Whole)?,
                    _ => None,
                };
                check_end(cursor)?;
                self.variables.set_returned(returned);
                self.flow.end_sub(&label, role.word(), &mut self.variables)
            }
            _ => self.o_decision(cursor, &label, role, line, control),
        }
    }

    /// Executes an O-word of a decision or a loop.
    fn o_decision(
        &mut self,
        cursor: &mut Cursor,
        label: &Label,
        role: Role,
        line: usize,
        control: &Control,
    ) -> Result<(), GcodeFault> {
        let scope = Scope::new(&self.variables, control);
        let Some(clause) = self.flow.structure().clause(line) else {
            let problem = match role {
                Role::If | Role::Do | Role::While | Role::Repeat => "it has no end: add it",
                _ => "it has no beginning: add it",
            };
            let (label, word) = (label.to_string(), role.word());
            return Err(GcodeFault::Nesting { label, word, problem });
        };
        self.flow.start();
        match role {
            Role::If | Role::While if clause.role == role => {
                let holds = condition(cursor, &scope)?;
                check_end(cursor)?;
                match (holds, role) {
                    (true, _) => Ok(()),
                    (false, Role::If) => self.next_branch(clause, control),
                    (false, _) => {
                        self.flow.jump(clause.after);
                        Ok(())
                    }
                }
            }
            // The condition of a `do`.
            Role::While => {
                let holds = condition(cursor, &scope)?;
                check_end(cursor)?;
                if holds {
                    self.flow.jump(clause.head);
                }
                Ok(())
            }
            Role::Repeat => {
                let times = value(cursor, &scope, Rounding::Whole)?.unwrap_or(0.0).round();
                check_end(cursor)?;
                // Refused before the first of too many.
                let mut ahead = self.flow.repeated;
                ahead.add(times as usize)?;
                if !self.flow.repeat(line, times.max(0.0) as u32) {
                    self.flow.jump(clause.after);
                }
                Ok(())
            }
            Role::EndRepeat => {
                check_end(cursor)?;
                if self.flow.end_repeat(clause.head.line) {
                    self.flow.jump_after(clause.head);
                }
                Ok(())
            }
            Role::EndWhile => {
                check_end(cursor)?;
                self.flow.jump(clause.head);
                Ok(())
            }
            // A branch that was executed ends here.
            Role::ElseIf | Role::Else => {
                self.flow.jump(clause.after);
                Ok(())
            }
            Role::Break | Role::Continue => {
                check_end(cursor)?;
                self.flow.check_leaving(clause.head, role.word())?;
                if self.flow.structure().head_role(clause) == Some(Role::Repeat) {
                    let (meaning, remedy) = ("no word of a `repeat`", "write a `while`");
                    return Err(not_read(role.word(), meaning, remedy));
                }
                self.flow.jump(if role == Role::Break { clause.after } else { clause.last });
                Ok(())
            }
            _ => check_end(cursor),
        }
    }

    /// Goes on at the next branch of an `if` whose condition holds, or after its end.
    fn next_branch(&mut self, mut clause: Clause, control: &Control) -> Result<(), GcodeFault> {
        loop {
            let place = clause.next;
            let Some(next_clause) = self.flow.structure().clause(place.line) else {
                return Err(GcodeFault::OpenLoop);
            };
            clause = next_clause;
            match clause.role {
                Role::ElseIf => {
                    let text = self.flow.text_at(place);
                    // Its condition is as much work as that of a block.
                    self.flow.count(work(text))?;
                    let scope = Scope::new(&self.variables, control);
                    let mut cursor = begin(text);
                    next(&mut cursor)?;
                    o_word(&mut cursor, &scope)?;
                    let holds = condition(&mut cursor, &scope)?;
                    check_end(&mut cursor)?;
                    if holds {
                        self.flow.jump_after(place);
                        return Ok(());
                    }
                }
                Role::Else => {
                    self.flow.jump_after(place);
                    return Ok(());
                }
                _ => {
                    self.flow.jump(clause.after);
                    return Ok(());
                }
            }
        }
    }
}

/// A call of a subprogram by M98, M97 or M198.
#[derive(Clone, Debug)]
struct Called {
    target: Target,
    times: u32,
}

/// A subprogram that is called.
#[derive(Clone, Debug)]
enum Target {
    /// The blocks from a sequence number of the same program on (M97).
    Sequence(u32),
    /// The program with a label.
    Program(Label),
    /// A program of another file.
    File(usize, Subprogram),
}

fn is_linuxcnc(control: &Control) -> bool {
    control.stated(Rule::Dialect) == Some(Choice::Rs274Ngc)
}

/// Returns the language of macros of a control, if it is stated and has one.
fn language(control: &Control) -> Option<Language> {
    match control.stated(Rule::Dialect) {
        Some(Choice::Iso) => Some(Language::Fanuc),
        Some(Choice::Rs274Ngc) => Some(Language::LinuxCnc),
        _ => None,
    }
}

/// Returns whether a program is read as DIN/ISO of Heidenhain.
fn is_heidenhain(control: &Control) -> bool {
    control.stated(Rule::Dialect) == Some(Choice::Heidenhain)
}

/// Refuses a line that the control does not read, whatever its words.
fn check_text(text: &str, control: &Control) -> Result<(), GcodeFault> {
    if !is_heidenhain(control) {
        return Ok(());
    }
    let Some(found) = before_semicolon(text).chars().find(|c| matches!(c, '(' | '#')) else {
        return Ok(());
    };
    let meaning = "no word of DIN/ISO programs of Heidenhain";
    let remedy = "write comments after `;` and numbers as such, or state another `dialect`";
    Err(not_read(format!("`{found}`"), meaning, remedy))
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

/// Returns whether a text has the name of a sine or an angle, before its argument in brackets.
fn has_angles(text: &str) -> bool {
    let names = ["SIN", "COS", "TAN"].map(str::as_bytes);
    // Most programs have no bracket, and are long.
    let brackets = text.match_indices('[');
    brackets.map(|(at, _)| text[..at].trim_end().as_bytes()).any(|before| {
        before
            .last_chunk::<3>()
            .is_some_and(|end| names.iter().any(|name| name.eq_ignore_ascii_case(end)))
    })
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
