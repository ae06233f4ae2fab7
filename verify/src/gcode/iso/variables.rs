//! Variables of macros: `#1`, `#<name>`.
//!
//! | | Fanuc and Haas | LinuxCNC |
//! |---|---|---|
//! | local to a call | #1 to #33, vacant in a macro until they are given | #1 to #30, 0 until they are given; names |
//! | common | #100 to #199, #500 to #999 | #31 to #5000, names with `_` |
//! | of the control | #0 (vacant), from #1000 | from #5001, some names with `_` |
//!
//! A common variable keeps the value that an earlier program or the operator has left in it. It is known only where the program has
//! assigned it, or the setup declares it.

use super::expression::{ExpressionFault, Language, Reader, Rounding, Value, expression};
use super::{language, system};
use crate::gcode::control::Control;
use crate::gcode::cursor::Cursor;
use std::collections::BTreeMap;

/// The last local variable of Fanuc.
const LAST_LOCAL_FANUC: u32 = 33;
/// The last local variable of LinuxCNC (`INTERP_SUB_PARAMS`).
const LAST_LOCAL_LINUXCNC: u32 = 30;
/// The first variable of the control, on Fanuc.
const FIRST_SYSTEM_FANUC: u32 = 1000;
/// The first variable of the control, on LinuxCNC.
const FIRST_SYSTEM_LINUXCNC: u32 = 5001;

/// The number of variables of LinuxCNC (`RS274NGC_MAX_PARAMETERS`).
const LINUXCNC_PARAMETERS: u32 = 5602;

/// A variable.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Parameter {
    Numbered(u32),
    /// A name in small letters without blanks, as names are compared.
    Named(String),
}

impl Parameter {
    pub(super) fn shown(&self) -> String {
        match self {
            Parameter::Numbered(number) => format!("#{number}"),
            Parameter::Named(name) => format!("#<{name}>"),
        }
    }

    /// Reads a variable as a job declares it: `#500`, `500` or `#<_name>`.
    pub(super) fn declared(text: &str) -> Option<Parameter> {
        let text = text.trim();
        let text = text.strip_prefix('#').unwrap_or(text);
        match text.strip_prefix('<').and_then(|name| name.strip_suffix('>')) {
            Some(name) => {
                Some(named(name)).filter(|named| *named != Parameter::Named(String::new()))
            }
            None => {
                let is_whole = text.bytes().all(|byte| byte.is_ascii_digit());
                text.parse().ok().filter(|number| is_whole && *number > 0).map(Parameter::Numbered)
            }
        }
    }
}

fn named(name: &str) -> Parameter {
    let name: String = name.chars().filter(|c| !c.is_whitespace()).collect();
    Parameter::Named(name.to_lowercase())
}

/// The variables of one call.
#[derive(Clone, Debug, Default)]
pub(super) struct Locals {
    pub(super) numbered: BTreeMap<u32, Value>,
    pub(super) named: BTreeMap<String, f64>,
    /// Set in a macro of Fanuc, in which those that are not given are vacant.
    pub(super) is_macro: bool,
}

/// The variables of a program.
#[derive(Clone, Debug, Default)]
pub(super) struct Variables {
    pub(super) locals: Locals,
    /// Set in a subprogram.
    pub(super) is_called: bool,
    common: BTreeMap<u32, Value>,
    global: BTreeMap<String, f64>,
    /// Variables of the control that the setup declares.
    declared: BTreeMap<Parameter, f64>,
    /// Set if the program computes sines or angles, whose last digits differ between controls.
    pub(super) has_angles: bool,
}

/// Inputs of an expression: the variables, the control, and the language, if the control is stated.
pub(super) struct Scope<'a> {
    pub(super) variables: &'a Variables,
    pub(super) control: &'a Control,
    pub(super) language: Option<Language>,
}

/// Returns whether a numbered variable is local to a call.
fn is_local(number: u32, language: Language) -> bool {
    number
        <= match language {
            Language::Fanuc => LAST_LOCAL_FANUC,
            Language::LinuxCnc => LAST_LOCAL_LINUXCNC,
        }
}

/// Returns whether a numbered variable is one of the control.
fn is_system(number: u32, language: Language) -> bool {
    number
        >= match language {
            Language::Fanuc => FIRST_SYSTEM_FANUC,
            Language::LinuxCnc => FIRST_SYSTEM_LINUXCNC,
        }
}

impl Locals {
    /// Returns those of a subprogram of O-words before its arguments (`convert_control_functions`: "zero the remaining params").
    pub(super) fn of_call() -> Locals {
        let numbered = (1..=LAST_LOCAL_LINUXCNC).map(|number| (number, Some(0.0))).collect();
        Locals { numbered, ..Locals::default() }
    }
}

impl Variables {
    /// Creates the variables before a program, with those that a job declares.
    pub(super) fn new(declared: &BTreeMap<String, Vec<f64>>) -> Variables {
        let mut variables = Variables::default();
        variables.set_returned(None);
        for (name, values) in declared {
            let Some(value) = values.first() else { continue };
            match Parameter::declared(name) {
                Some(Parameter::Numbered(number)) if number < FIRST_SYSTEM_FANUC => {
                    variables.store(number, Some(*value), Language::LinuxCnc);
                }
                Some(Parameter::Named(name)) if !name.starts_with('_') => {
                    variables.locals.named.insert(name, *value);
                }
                Some(parameter) => {
                    variables.declared.insert(parameter, *value);
                }
                None => {}
            }
        }
        variables
    }

    /// Stores a variable that is not one of the control.
    fn store(&mut self, number: u32, value: Value, language: Language) {
        match is_local(number, language) {
            true => self.locals.numbered.insert(number, value),
            false => self.common.insert(number, value),
        };
    }

    /// Sets the value with which a subprogram of O-words has returned.
    pub(super) fn set_returned(&mut self, value: Value) {
        self.global.insert("_value".to_owned(), value.unwrap_or(0.0));
        self.global.insert("_value_returned".to_owned(), f64::from(u8::from(value.is_some())));
    }

    /// Forgets that value: M99 and an `endsub` that is passed over change it, but not in all releases.
    pub(super) fn forget_returned(&mut self) {
        self.global.remove("_value");
        self.global.remove("_value_returned");
    }

    /// Assigns a variable that is not one of the control, and returns whether it was one that can be assigned.
    pub(super) fn assign(
        &mut self,
        parameter: &Parameter,
        value: Value,
        language: Option<Language>,
    ) -> Result<(), ExpressionFault> {
        // Of a program that names no control, numbers have the meaning that they have on all.
        match parameter {
            Parameter::Numbered(number) => {
                let language = language.unwrap_or(match is_system(*number, Language::Fanuc) {
                    true => Language::LinuxCnc,
                    false => Language::Fanuc,
                });
                if *number == 0 || is_system(*number, language) {
                    return Err(ExpressionFault::ReadOnly { parameter: parameter.shown() });
                }
                self.store(*number, value, language);
            }
            Parameter::Named(name) => {
                let value = value
                    .ok_or_else(|| ExpressionFault::Vacant { parameter: parameter.shown() })?;
                if name.starts_with('_') && system::is_predefined(name) {
                    return Err(ExpressionFault::ReadOnly { parameter: parameter.shown() });
                }
                let names =
                    if name.starts_with('_') { &mut self.global } else { &mut self.locals.named };
                names.insert(name.clone(), value);
            }
        }
        Ok(())
    }
}

impl<'a> Scope<'a> {
    /// Creates the scope of a line that is executed.
    pub(super) fn new(variables: &'a Variables, control: &'a Control) -> Scope<'a> {
        Scope { variables, control, language: language(control) }
    }

    /// Returns the value of a variable.
    pub(super) fn get(
        &self,
        parameter: &Parameter,
        language: Language,
    ) -> Result<Value, ExpressionFault> {
        let variables = self.variables;
        let found = match parameter {
            Parameter::Numbered(0) if language == Language::Fanuc => return Ok(None),
            Parameter::Numbered(number) if is_system(*number, language) => {
                let known = system::numbered(*number, language, self.control);
                // Without a control, the number has no meaning.
                let known = known.filter(|_| self.language.is_some());
                let known = known.or_else(|| variables.declared.get(parameter).copied());
                return known
                    .map(Some)
                    .ok_or_else(|| ExpressionFault::System { parameter: parameter.shown() });
            }
            Parameter::Numbered(number) if is_local(*number, language) => {
                match variables.locals.numbered.get(number) {
                    Some(value) => Some(*value),
                    None if variables.locals.is_macro => Some(None),
                    None => None,
                }
            }
            Parameter::Numbered(number) => {
                let declared = || variables.declared.get(parameter).copied().map(Some);
                variables.common.get(number).copied().or_else(declared)
            }
            Parameter::Named(name) if name.starts_with('_') => {
                let assigned = variables.global.get(name).copied();
                let reported = || system::named(name, self.control);
                let declared = || variables.declared.get(parameter).copied();
                match assigned.or_else(reported).or_else(declared) {
                    Some(value) => Some(Some(value)),
                    None if system::is_predefined(name) => {
                        return Err(ExpressionFault::System { parameter: parameter.shown() });
                    }
                    None => None,
                }
            }
            Parameter::Named(name) => variables.locals.named.get(name).copied().map(Some),
        };
        found.ok_or_else(|| ExpressionFault::Unassigned { parameter: parameter.shown() })
    }

    /// Returns whether LinuxCNC has a variable: every number of its table, and names with a value.
    ///
    /// # Errors
    /// For a name without a value that an earlier program can have left: a global one, one of the main program, and those of
    /// configurations (`_ini[…]`).
    pub(super) fn has(&self, parameter: &Parameter) -> Result<bool, ExpressionFault> {
        match parameter {
            Parameter::Numbered(number) => Ok(*number < LINUXCNC_PARAMETERS),
            Parameter::Named(name) if system::is_predefined(name) => Ok(true),
            Parameter::Named(name) => match self.get(parameter, Language::LinuxCnc) {
                Ok(_) => Ok(true),
                Err(_) if self.variables.is_called && !name.starts_with('_') => Ok(false),
                Err(fault) => Err(fault),
            },
        }
    }
}

/// Reads a variable, which begins with `#`.
pub(super) fn parameter(
    reader: &Reader,
    cursor: &mut Cursor,
    depth: usize,
) -> Result<Parameter, ExpressionFault> {
    cursor.take(b'#');
    if cursor.take(b'<') {
        let name = cursor.take_until('>').ok_or(ExpressionFault::OpenName)?;
        let parameter = named(name);
        return match parameter == Parameter::Named(String::new()) {
            true => Err(ExpressionFault::System { parameter: parameter.shown() }),
            false => Ok(parameter),
        };
    }
    let index = reader.unsigned(cursor, depth + 1)?.unwrap_or(0.0);
    let is_vacant = reader.language == Language::Fanuc && index == 0.0;
    let is_index = index.fract() == 0.0 && (1.0..=99_999.0).contains(&index);
    match is_index || is_vacant {
        true => Ok(Parameter::Numbered(index as u32)),
        false => Err(ExpressionFault::Index { index }),
    }
}

/// Reads an assignment `#1 = value`.
pub(super) fn assignment(
    cursor: &mut Cursor,
    scope: &Scope,
) -> Result<(Parameter, Value), ExpressionFault> {
    let language = scope.language.unwrap_or(Language::LinuxCnc);
    let target = parameter(&Reader { scope, language, rounding: Rounding::Whole }, cursor, 0)?;
    match cursor.take(b'=') {
        true => Ok((target, expression(cursor, scope)?)),
        false => Err(ExpressionFault::NoAssignment { parameter: target.shown() }),
    }
}
