//! The structure of a text: its programs and subprograms, and the lines that belong to one decision or loop.

use super::expression::Language;
use super::flow::{Place, line};
use super::line::{Label, OWord, Role, begin, begins_title, loop_number, next, o_word, statement};
use super::variables::Scope;
use crate::gcode::cursor::Cursor;
use crate::gcode::{GcodeError, GcodeFault};
use std::collections::{BTreeMap, HashMap, HashSet};

/// Largest number of decisions and loops that are open at once.
const MAX_OPEN: usize = 1000;

/// A subprogram.
#[derive(Clone, Copy, Debug)]
pub(super) struct Subprogram {
    /// [`Role::Title`] or [`Role::Sub`].
    pub(super) role: Role,
    /// The line after the label.
    pub(super) body: Place,
    /// The line after `endsub`.
    pub(super) after: Option<Place>,
}

/// One line of a decision or a loop, such as `if`, `elseif` and `endif`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Clause {
    /// Its word. The `while` that ends a `do` is [`Role::EndWhile`].
    pub(super) role: Role,
    /// The first line.
    pub(super) head: Place,
    /// The next line of the group, which is the last one for itself.
    pub(super) next: Place,
    /// The last line.
    pub(super) last: Place,
    /// The line after the last one.
    pub(super) after: Place,
}

/// The kind of a label: O-words and loops of Fanuc have their own numbers.
#[derive(Clone, Debug, PartialEq, Eq)]
enum Key {
    OWord(Label),
    Loop(u32),
}

/// A decision or a loop whose end was not found yet.
#[derive(Debug)]
struct Group {
    key: Key,
    lines: Vec<(Role, Place)>,
    /// `break` and `continue`, which are no ends of a part.
    jumps: Vec<(Role, Place)>,
}

/// A loop of Fanuc.
#[derive(Clone, Copy, Debug)]
struct Loop {
    last: usize,
    /// The first line of the one around it.
    outer: Option<usize>,
}

/// The structure of a text.
#[derive(Debug, Default)]
pub(super) struct Structure {
    subprograms: HashMap<Label, Subprogram>,
    /// By line.
    clauses: HashMap<usize, Clause>,
    /// The lines of titles of programs, in order.
    pub(super) titles: Vec<Place>,
    /// The loops of Fanuc, by their first lines.
    loops: BTreeMap<usize, Loop>,
    pub(super) lines: usize,
    /// Set if it has a `do` loop of O-words.
    pub(super) has_do: bool,
    /// The first line with a statement that only macros of Fanuc and Haas have.
    pub(super) fanuc: Option<usize>,
    /// The first line with an O-word that only LinuxCNC has, `sub`, `endsub` and `call` excepted.
    pub(super) linuxcnc: Option<usize>,
}

impl Structure {
    /// Reads the labels of a text. Lines that are not understood are left to the interpreter.
    ///
    /// # Errors
    /// A label that stands twice, a `sub` in another, a `sub` without `endsub`; each with its line.
    pub(super) fn find(text: &str, scope: &Scope) -> Result<Structure, GcodeError> {
        let mut found = Structure::default();
        let mut labels: HashMap<Label, usize> = HashMap::new();
        let mut open: Option<(Label, usize)> = None;
        let mut groups: Vec<Group> = Vec::new();
        // The labels of `do` loops of the present subprogram.
        let mut done: HashSet<Label> = HashSet::new();
        let mut place = Place { offset: 0, line: 1 };
        while let Some((line, after)) = line(text, place) {
            let here = place;
            place = after;
            found.lines = here.line;
            let mut cursor = begin(line);
            let word = match next(&mut cursor) {
                Ok(Some(byte)) if begins_title(byte) => o_word(&mut cursor, scope),
                Ok(Some(byte)) if b"GgIiWwDdEe".contains(&byte) => {
                    found.statement(&mut groups, cursor, here, after);
                    continue;
                }
                _ => continue,
            };
            // A label that is an expression can only be called. Words after a number are those of the block of a title (Fanuc).
            let OWord { label, role } = match word {
                Ok(word) => word,
                Err(GcodeFault::ControlFlow { .. })
                    if open.is_none() && scope.language != Some(Language::LinuxCnc) =>
                {
                    found.titles.push(here);
                    continue;
                }
                Err(_) => continue,
            };
            if role.is_decision() {
                found.linuxcnc.get_or_insert(here.line);
                if let Some(problem) = problem_of(line, &label, role, &groups, &done) {
                    return Err(nesting(here.line, &label, role.word(), problem));
                }
                if role == Role::Do {
                    found.has_do = true;
                    done.insert(label.clone());
                }
                found.add(&mut groups, Key::OWord(label), role, here, after);
                continue;
            }
            match (role, &open) {
                (Role::Sub, Some(_)) => {
                    let problem = "it stands in another subprogram: end that with endsub before";
                    return Err(nesting(here.line, &label, "sub", problem));
                }
                (Role::Sub | Role::Title, _) => {
                    if let Some(first) = labels.insert(label.clone(), here.line) {
                        let fault = GcodeFault::SecondLabel { label: label.to_string(), first };
                        return Err(GcodeError { line: here.line, fault });
                    }
                    if role == Role::Sub {
                        open = Some((label.clone(), here.line));
                    } else {
                        found.titles.push(here);
                    }
                    groups.clear();
                    done.clear();
                    found.subprograms.insert(label, Subprogram { role, body: after, after: None });
                }
                (Role::EndSub, Some((opened, _))) if *opened == label => {
                    if let Some(known) = found.subprograms.get_mut(&label) {
                        known.after = Some(after);
                    }
                    open = None;
                    groups.clear();
                    done.clear();
                }
                (Role::EndSub, Some(_)) => {
                    let problem = "another subprogram is open: end that before";
                    return Err(nesting(here.line, &label, "endsub", problem));
                }
                // The end of a subprogram that has a title is refused where it is executed.
                _ => {}
            }
        }
        match open {
            Some((label, line)) => Err(nesting(line, &label, "sub", "it has no endsub: add it")),
            None => {
                found.nest_loops();
                Ok(found)
            }
        }
    }

    /// Adds a line that begins with a statement of a macro of Fanuc.
    fn statement(
        &mut self,
        groups: &mut Vec<Group>,
        mut cursor: Cursor,
        here: Place,
        after: Place,
    ) {
        if cursor.take_text("G65") || cursor.take_text("G66") {
            self.fanuc.get_or_insert(here.line);
            return;
        }
        let Some(word) = statement(&mut cursor) else { return };
        self.fanuc.get_or_insert(here.line);
        if word == "WHILE" {
            pass_bracket(&mut cursor);
            if !cursor.take_text("DO") {
                return;
            }
        }
        let role = match word {
            "WHILE" | "DO" => Role::Do,
            "END" => Role::EndWhile,
            _ => return,
        };
        if let Ok(number) = loop_number(&mut cursor, word) {
            self.add(groups, Key::Loop(number), role, here, after);
        }
    }

    /// Adds a line of a decision or a loop. A group that is not complete has no clauses, and is refused where it is executed.
    fn add(&mut self, groups: &mut Vec<Group>, key: Key, role: Role, here: Place, after: Place) {
        let position = groups.iter().rposition(|group| group.key == key);
        let head = position.map(|position| groups[position].lines[0].0);
        match (role, head) {
            (Role::Break | Role::Continue, Some(_)) => {
                groups[position.expect("a group with a head")].jumps.push((role, here));
            }
            // The condition after a `do`.
            (Role::While, Some(Role::Do))
            | (Role::EndWhile, Some(Role::Do | Role::While))
            | (Role::EndRepeat, Some(Role::Repeat))
            | (Role::EndIf, Some(Role::If)) => {
                let position = position.expect("a group with a head");
                let role = if role == Role::While { Role::EndWhile } else { role };
                groups[position].lines.push((role, here));
                // Groups inside that have no end of their own are dropped.
                let group = groups.drain(position..).next().expect("the group");
                self.close(group, after);
            }
            (Role::ElseIf | Role::Else, Some(Role::If)) => {
                let position = position.expect("a group with a head");
                groups[position].lines.push((role, here));
                groups.truncate(position + 1);
            }
            (Role::If | Role::Do | Role::While | Role::Repeat, _) => {
                groups.push(Group { key, lines: vec![(role, here)], jumps: Vec::new() });
            }
            _ => {}
        }
    }

    fn close(&mut self, group: Group, after: Place) {
        let (head, last) = (group.lines[0].1, group.lines[group.lines.len() - 1].1);
        if matches!(group.key, Key::Loop(_)) {
            self.loops.insert(head.line, Loop { last: last.line, outer: None });
        }
        let nexts = group.lines.iter().skip(1).map(|(_, place)| *place).chain([last]);
        for ((role, here), next) in group.lines.iter().zip(nexts) {
            self.clauses.insert(here.line, Clause { role: *role, head, next, last, after });
        }
        for (role, here) in group.jumps {
            self.clauses.insert(here.line, Clause { role, head, next: last, last, after });
        }
    }

    /// Finds the loop around each loop.
    fn nest_loops(&mut self) {
        let mut open: Vec<(usize, usize)> = Vec::new();
        for (first, found) in &mut self.loops {
            while open.pop_if(|(_, last)| *last < *first).is_some() {}
            found.outer = open.last().map(|(outer, _)| *outer);
            open.push((*first, found.last));
        }
    }

    /// Returns the clause of a line.
    pub(super) fn clause(&self, line: usize) -> Option<Clause> {
        self.clauses.get(&line).copied()
    }

    /// Returns the role of the head of a clause's group.
    pub(super) fn head_role(&self, clause: Clause) -> Option<Role> {
        self.clause(clause.head.line).map(|head| head.role)
    }

    /// Returns whether a text has subprograms.
    pub(super) fn has_subprograms(&self) -> bool {
        !self.subprograms.is_empty()
    }

    /// Returns the labels of the subprograms.
    pub(super) fn labels(&self) -> impl Iterator<Item = &Label> {
        self.subprograms.keys()
    }

    /// Returns a subprogram.
    pub(super) fn get(&self, label: &Label) -> Option<&Subprogram> {
        self.subprograms.get(label)
    }

    /// Returns whether a line is in each loop of Fanuc in which another line is.
    pub(super) fn can_jump(&self, from: usize, to: usize) -> bool {
        let mut around = self.loops.range(..=to).next_back();
        while let Some((first, Loop { last, outer })) = around {
            if to <= *last {
                // Loops around it contain both.
                return (*first..=*last).contains(&from);
            }
            around = outer.and_then(|outer| self.loops.get_key_value(&outer));
        }
        true
    }

    /// Returns the lines of the program that has a line: from its title, or from the first line, to the next title.
    pub(super) fn program(&self, line: usize) -> [usize; 2] {
        let next = self.titles.partition_point(|title| title.line <= line);
        let first = next.checked_sub(1).map_or(1, |last| self.titles[last].line);
        [first, self.titles.get(next).map_or(usize::MAX, |title| title.line - 1)]
    }
}

/// Returns what LinuxCNC does not execute as it is written in a line of a decision or a loop, if there is such a thing.
fn problem_of(
    line: &str,
    label: &Label,
    role: Role,
    groups: &[Group],
    done: &HashSet<Label>,
) -> Option<&'static str> {
    let is_open =
        || groups.iter().any(|group| matches!(&group.key, Key::OWord(open) if open == label));
    if line.trim_start().starts_with('/') {
        Some(
            "it is an optional block, which LinuxCNC leaves out only where it comes to it: remove `/`",
        )
    } else if groups.len() >= MAX_OPEN {
        Some("more than 1,000 decisions and loops are open: end some before")
    } else if matches!(role, Role::If | Role::Do | Role::While | Role::Repeat)
        && done.contains(label)
        && (role == Role::Do || !is_open())
    {
        Some(
            "a `do` before has the same label, and LinuxCNC goes back to that one: write another label",
        )
    } else {
        None
    }
}

/// Passes over an expression in brackets.
fn pass_bracket(cursor: &mut Cursor) {
    let mut depth = 0;
    while let Some(byte) = cursor.peek() {
        if !byte.is_ascii() {
            return;
        }
        cursor.advance();
        depth += i32::from(byte == b'[') - i32::from(byte == b']');
        if depth == 0 {
            return;
        }
    }
}

/// Returns the error of an O-word at a wrong place.
pub(super) fn nesting(
    line: usize,
    label: &Label,
    word: &'static str,
    problem: &'static str,
) -> GcodeError {
    GcodeError { line, fault: GcodeFault::Nesting { label: label.to_string(), word, problem } }
}
