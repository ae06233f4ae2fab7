//! R parameters, and the variables that `DEF` defines.
//!
//! R parameters keep their values from one program to the next, so one that the program has not assigned has a value that only the
//! machine knows, or that a job states. A variable of `DEF` begins with 0, FALSE or an empty text, and belongs to its program or subprogram.

use super::expression::{Value, expression, number};
use super::text::Cursor;
use crate::gcode::error::{combination, not_read};
use crate::gcode::{ExpressionFault, GcodeFault, shown};
use std::collections::{BTreeMap, HashMap};

/// The greatest R parameter (MD28050 allows as many).
const MAX_R: f64 = 32_534.0;
/// The largest number of elements of an array.
const MAX_ELEMENTS: f64 = 10_000.0;

/// The largest number of elements of all variables that are defined.
const MAX_ALL_ELEMENTS: usize = 200_000;

/// The type of a variable.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Int,
    Real,
    Bool,
    Text,
}

#[derive(Clone, Debug)]
struct Variable {
    name: String,
    kind: Kind,
    /// The lengths of its dimensions; 1 for those that it lacks.
    lengths: [usize; 2],
    dimensions: usize,
    values: Vec<Value>,
}

/// A variable, or one element of an array.
#[derive(Clone, Copy, Debug)]
pub(super) enum Reference {
    R(usize),
    Named { variable: usize, element: usize },
}

impl Reference {
    /// Returns the R parameter with an index.
    ///
    /// # Errors
    /// If there is none.
    pub(super) fn r(index: f64) -> Result<Reference, GcodeFault> {
        match index.fract() == 0.0 && (0.0..=MAX_R).contains(&index) {
            true => Ok(Reference::R(index as usize)),
            false => {
                let expected = "a whole number from 0 to 32534 after R";
                Err(GcodeFault::NotAllowed { word: 'R', value: index, expected })
            }
        }
    }
}

/// The variables that are known.
#[derive(Clone, Debug, Default)]
pub(super) struct Variables {
    r: Vec<Option<f64>>,
    /// The variables of all programs that are being executed. Those of the present one begin at `base`.
    named: Vec<Variable>,
    base: usize,
    /// The places of those of the present program by their names in capitals.
    own: HashMap<String, usize>,
    /// Those of its callers.
    callers: Vec<HashMap<String, usize>>,
    /// The number of elements of all variables.
    elements: usize,
}

/// Returns the name of an R parameter in one spelling.
pub(crate) fn variable_name(text: &str) -> Option<String> {
    r_index(text).map(|index| format!("R{index}"))
}

/// Returns the index of an R parameter by its name.
fn r_index(name: &str) -> Option<usize> {
    let index = name.strip_prefix(['R', 'r'])?;
    let is_whole = !index.is_empty() && index.bytes().all(|byte| byte.is_ascii_digit());
    index.parse().ok().filter(|index| is_whole && *index as f64 <= MAX_R)
}

impl Variables {
    /// Creates the variables of a program, of which a job states the R parameters in `stated`.
    pub(super) fn new(stated: &BTreeMap<String, Vec<f64>>) -> Variables {
        let mut variables = Variables::default();
        for (name, values) in stated {
            if let Some((index, value)) = r_index(name).zip(values.first()) {
                variables.set_r(index, *value);
            }
        }
        variables
    }

    fn set_r(&mut self, index: usize, value: f64) {
        if self.r.len() <= index {
            self.r.resize(index + 1, None);
        }
        self.r[index] = Some(value);
    }

    /// Returns where the variables of the present program begin.
    pub(super) fn base(&self) -> usize {
        self.base
    }

    /// Begins the variables of a subprogram, and returns where those of the caller begin.
    pub(super) fn enter(&mut self) -> usize {
        self.callers.push(std::mem::take(&mut self.own));
        std::mem::replace(&mut self.base, self.named.len())
    }

    /// Ends the variables of a subprogram.
    pub(super) fn leave(&mut self, base: usize) {
        self.clear();
        self.own = self.callers.pop().unwrap_or_default();
        self.base = base;
    }

    /// Ends the variables of all subprograms, or those of the main program if there is none.
    pub(super) fn leave_all(&mut self) {
        let main = self.callers.drain(..).next();
        if let Some(main) = main {
            // The variables of the main program stand before all others.
            self.base = main.values().max().map_or(0, |last| last + 1);
            self.clear();
            self.own = main;
        } else {
            self.clear();
        }
        self.base = 0;
    }

    /// Removes the variables of the present program.
    pub(super) fn clear(&mut self) {
        let removed = self.named.drain(self.base..);
        self.elements -= removed.map(|variable| variable.values.len()).sum::<usize>();
        self.own.clear();
    }

    /// Returns the variable with a name.
    pub(super) fn find(&self, name: &str) -> Option<usize> {
        self.own.get(&name.to_ascii_uppercase()).copied()
    }

    /// Returns an element of a variable.
    ///
    /// # Errors
    /// If it has another number of dimensions, or an index is outside.
    pub(super) fn element(
        &self,
        variable: usize,
        indices: &[f64],
    ) -> Result<Reference, GcodeFault> {
        let Variable { name, lengths, dimensions, .. } = &self.named[variable];
        let mut element = 0;
        for (index, length) in indices.iter().zip(lengths) {
            if index.fract() != 0.0 || !(0.0..*length as f64).contains(index) {
                return Err(no_element(name));
            }
            element = element * length + *index as usize;
        }
        match indices.len() == *dimensions {
            true => Ok(Reference::Named { variable, element }),
            false => Err(no_element(name)),
        }
    }

    /// Returns the value of a variable.
    ///
    /// # Errors
    /// If it is an R parameter that the program has not assigned.
    pub(super) fn get(&self, reference: Reference) -> Result<Value, GcodeFault> {
        match reference {
            Reference::R(index) => match self.r.get(index).copied().flatten() {
                Some(number) => Ok(Value::Number(number)),
                None => Err(ExpressionFault::Unassigned { parameter: format!("R{index}") }.into()),
            },
            Reference::Named { variable, element } => {
                Ok(self.named[variable].values[element].clone())
            }
        }
    }

    /// Assigns a value to a variable, converted to its type: a REAL is rounded to an INT.
    ///
    /// # Errors
    /// If the value has no such conversion.
    pub(super) fn set(&mut self, reference: Reference, value: Value) -> Result<(), GcodeFault> {
        match reference {
            Reference::R(index) => {
                self.set_r(index, value.number()?);
            }
            Reference::Named { variable, element } => {
                let Variable { kind, values, .. } = &mut self.named[variable];
                values[element] = kind.converted(value)?;
            }
        }
        Ok(())
    }

    /// Executes `DEF` after that word: a type, and names with dimensions and values.
    pub(super) fn define(&mut self, cursor: &mut Cursor) -> Result<(), GcodeFault> {
        let kind = Kind::read(cursor)?;
        loop {
            let name = cursor.name();
            if name.len() < 2 || name.starts_with('$') {
                return Err(unexpected_definition(cursor));
            }
            let (mut lengths, mut dimensions) = ([1; 2], 0);
            if cursor.take(b'[') {
                for length in &mut lengths {
                    if dimensions > 0 && !cursor.take(b',') {
                        break;
                    }
                    let value = number(cursor, self)?;
                    if value.fract() != 0.0 || !(1.0..=MAX_ELEMENTS).contains(&value) {
                        return Err(no_array(name));
                    }
                    *length = value as usize;
                    dimensions += 1;
                }
                if !cursor.take(b']') {
                    return Err(ExpressionFault::OpenBracket.into());
                }
            }
            if (lengths[0] * lengths[1]) as f64 > MAX_ELEMENTS {
                return Err(no_array(name));
            }
            let value = match cursor.take_assignment() {
                true if dimensions > 0 => {
                    let meaning = "an array with values";
                    return Err(not_read(shown(name), meaning, "assign its elements after DEF"));
                }
                true => kind.converted(expression(cursor, self)?)?,
                false => kind.empty(),
            };
            self.add(name, kind, value, lengths, dimensions)?;
            if !cursor.take(b',') {
                break;
            }
        }
        match cursor.is_at_end() {
            true => Ok(()),
            false => Err(unexpected_definition(cursor)),
        }
    }

    /// Defines a parameter of a subprogram, whose type and name follow, with the value of its call.
    pub(super) fn define_parameter(
        &mut self,
        cursor: &mut Cursor,
        value: Option<Value>,
    ) -> Result<(), GcodeFault> {
        if cursor.take_name("VAR") {
            let meaning = "a parameter that the subprogram can change";
            return Err(not_read("VAR", meaning, "write an R parameter"));
        }
        let kind = Kind::read(cursor)?;
        let name = cursor.name();
        if name.len() < 2 {
            return Err(unexpected_definition(cursor));
        }
        let value = value.map_or(Ok(kind.empty()), |value| kind.converted(value))?;
        self.add(name, kind, value, [1; 2], 0)
    }

    fn add(
        &mut self,
        name: &str,
        kind: Kind,
        value: Value,
        lengths: [usize; 2],
        dimensions: usize,
    ) -> Result<(), GcodeFault> {
        // A definition that is executed again, as in a loop, is an error on the control.
        if self.find(name).is_some() {
            let remedy = "define each name once, at the start of the program";
            return Err(combination(shown(name), "it is already defined", remedy));
        }
        let elements = lengths[0] * lengths[1];
        if self.elements + elements > MAX_ALL_ELEMENTS {
            return Err(no_array(name));
        }
        self.elements += elements;
        self.own.insert(name.to_ascii_uppercase(), self.named.len());
        let values = vec![value; elements];
        self.named.push(Variable { name: name.to_owned(), kind, lengths, dimensions, values });
        Ok(())
    }
}

impl Kind {
    fn read(cursor: &mut Cursor) -> Result<Kind, GcodeFault> {
        let mut after = *cursor;
        let name = after.name();
        let kind = match name.to_ascii_uppercase().as_str() {
            "INT" => Kind::Int,
            "REAL" => Kind::Real,
            "BOOL" => Kind::Bool,
            "STRING" => {
                // The greatest length of the text.
                if after.peek() == Some(b'[') && after.bracketed([b'[', b']']).is_none() {
                    return Err(ExpressionFault::OpenBracket.into());
                }
                Kind::Text
            }
            _ => return Err(unexpected_definition(cursor)),
        };
        *cursor = after;
        Ok(kind)
    }

    fn empty(self) -> Value {
        match self {
            Kind::Int | Kind::Real => Value::Number(0.0),
            Kind::Bool => Value::Truth(false),
            Kind::Text => Value::Text(String::new()),
        }
    }

    fn converted(self, value: Value) -> Result<Value, GcodeFault> {
        Ok(match (self, value) {
            (Kind::Int, Value::Truth(truth)) => Value::Number(f64::from(u8::from(truth))),
            (Kind::Int, value) => Value::Number(value.number()?.round()),
            (Kind::Real, value) => Value::Number(value.number()?),
            (Kind::Bool, value) => Value::Truth(value.truth()?),
            (Kind::Text, value @ Value::Text(_)) => value,
            (Kind::Text, _) => {
                return Err(ExpressionFault::Kind { found: "a number", wanted: "a text" }.into());
            }
        })
    }
}

fn no_array(name: &str) -> GcodeFault {
    let condition = "an array has 1 to 10,000 elements, and all of a program 200,000";
    combination(format!("an array of {}", shown(name)), condition, "define fewer or shorter arrays")
}

fn no_element(name: &str) -> GcodeFault {
    let remedy = "write whole indices from 0, below the length of each dimension";
    combination(format!("an index of {}", shown(name)), "it is outside of the array", remedy)
}

fn unexpected_definition(cursor: &mut Cursor) -> GcodeFault {
    cursor.peek();
    let rest = cursor.rest();
    let word = if rest.is_empty() { "the end of DEF".to_owned() } else { shown(rest) };
    let meaning = "no part of a definition of INT, REAL, BOOL or STRING";
    not_read(word, meaning, "define variables of these types, each with its name")
}
