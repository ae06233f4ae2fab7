//! The tools of a program.

use super::job::{Hand, Tools};
use crate::arguments::ToolArguments;
use crate::failure::Failure;
use crate::loaded_tool::{LoadedTool, compile_named};
use std::collections::BTreeMap;
use std::ffi::OsString;
use tool_dsl::Compiled;
use touchoff::Tool;
use touchoff_verify::ToolSelection;

/// A tool of a program.
pub(crate) struct ProgramTool {
    /// Its number in the program, if tools are selected by number.
    pub(crate) number: Option<u32>,
    /// The motions that it makes.
    pub(super) selection: ToolSelection,
    loaded: LoadedTool,
    /// Its name, and the arguments that it was loaded with.
    named: (OsString, ToolArguments),
    /// Allowances of its own surfaces.
    pub(super) allow: Vec<(String, f64)>,
    pub(super) hand: Hand,
}

impl ProgramTool {
    pub(crate) fn tool(&self) -> &dyn Tool {
        self.loaded.tool()
    }

    /// Compiles the tool again, for its drawing and its proof.
    ///
    /// # Errors
    /// If its file cannot be read any more.
    pub(crate) fn compile(&self) -> Result<Compiled, Failure> {
        let (name, arguments) = &self.named;
        compile_named(name, arguments)
    }
}

/// Loads the tools that a program uses, by its numbers; `None` stands for motions before the first tool change, and for
/// a program without numbers.
///
/// # Errors
/// If a tool cannot be loaded, or no tool is given for a number.
pub(super) fn load(tools: &Tools, used: &[Option<u32>]) -> Result<Vec<ProgramTool>, Failure> {
    match tools {
        Tools::One(name, arguments) => {
            let mut numbers = used.iter().flatten();
            if let (Some(first), Some(second)) = (numbers.next(), numbers.next()) {
                return Err(Failure::SeveralTools { first: *first, second: *second });
            }
            Ok(vec![ProgramTool {
                number: None,
                selection: ToolSelection::All,
                loaded: LoadedTool::load(name, arguments)?,
                named: (name.clone(), arguments.clone()),
                allow: Vec::new(),
                hand: Hand::Right,
            }])
        }
        Tools::Numbered { library, entries } => {
            let missing = |number: Option<u32>| Failure::NoTool { number };
            let load = |number: &Option<u32>| {
                // A program without numbers needs no choice if there is one tool.
                let known = match (number, entries.iter().next()) {
                    (None, Some((only, _))) if entries.len() == 1 => *only,
                    (None, _) => return Err(missing(None)),
                    (Some(number), _) => *number,
                };
                let entry = entries.get(&known);
                let named = entry.and_then(|entry| entry.tool.clone());
                let params = entry.map(|entry| entry.params()).unwrap_or_default();
                let (name, library) = match (named, library) {
                    (Some(name), _) => (OsString::from(name), None),
                    (None, Some(library)) => (format!("T{known}").into(), Some(library.clone())),
                    (None, None) => return Err(missing(*number)),
                };
                let arguments = ToolArguments { library, params };
                Ok(ProgramTool {
                    number: *number,
                    selection: ToolSelection::Number(*number),
                    loaded: LoadedTool::load(&name, &arguments)?,
                    named: (name, arguments),
                    hand: entry.map_or(Hand::Right, |entry| entry.hand),
                    allow: entry.map_or(Vec::new(), |entry| {
                        entry.allow.iter().map(|(name, depth)| (name.clone(), *depth)).collect()
                    }),
                })
            };
            used.iter().map(load).collect()
        }
    }
}

/// Returns the lengths of the tools that a job states, by number, in mm.
pub(super) fn lengths(tools: &Tools) -> BTreeMap<u32, f64> {
    match tools {
        Tools::One(..) => BTreeMap::new(),
        Tools::Numbered { entries, .. } => {
            entries.iter().filter_map(|(number, entry)| Some((*number, entry.length?))).collect()
        }
    }
}
