//! Files of subprograms beside that of the program.

use super::error::combination;
use super::{GcodeError, GcodeFault, shown};
use std::collections::BTreeMap;
use std::sync::Arc;

/// A file of subprograms that a program can call.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SubprogramFile {
    /// Its name without a folder. Controls find subprograms by it.
    pub name: String,
    /// Its text.
    pub text: Arc<str>,
}

impl SubprogramFile {
    /// Returns the name without the part after its last point.
    pub(crate) fn stem(&self) -> &str {
        self.name.rsplit_once('.').map_or(&self.name, |(stem, _)| stem)
    }
}

/// A line of a file that was called.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct SubprogramLine {
    /// The number of the file: from 1 on in [`ControlSetup::subprograms`](super::ControlSetup::subprograms), 0 for the file of the
    /// program, which a subprogram of another file can call.
    pub file: usize,
    /// The line, 1-based.
    pub line: usize,
}

/// The place of a block, or of a cutter location.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct BlockLine {
    /// The line in the program, 1-based; of a block in a file of subprograms, that of the program's block which calls it.
    pub line: usize,
    /// The line in the file of subprograms that has the block.
    pub within: Option<SubprogramLine>,
}

/// A line of the program itself.
impl From<usize> for BlockLine {
    fn from(line: usize) -> BlockLine {
        BlockLine { line, within: None }
    }
}

/// Returns the name of a file as a call on a control has it, without its folder.
pub(super) fn without_folder(name: &str) -> &str {
    name.rsplit(['/', '\\']).next().unwrap_or(name).trim()
}

/// The folders in which calls seek programs, by the names of these. The files of a program have no folders: one answers for a name.
#[derive(Clone, Debug, Default)]
pub(super) struct CalledFolders(BTreeMap<String, String>);

impl CalledFolders {
    /// Checks that a call, whose text is `called`, names the same folder as the calls of the program `name` before it, or none.
    ///
    /// # Errors
    /// If it names another one, in which another program can be.
    pub(super) fn check(&mut self, called: &str, name: &str) -> Result<(), GcodeFault> {
        let folder = called.trim().strip_suffix(without_folder(called)).unwrap_or_default();
        let folder = folder.to_ascii_uppercase().replace('\\', "/");
        if folder.is_empty() {
            return Ok(());
        }
        let first = self.0.entry(name.to_ascii_uppercase()).or_insert_with(|| folder.clone());
        if *first == folder {
            return Ok(());
        }
        let condition = "another call seeks a program of this name in another folder";
        let remedy =
            "give the two programs different names, or the calls of one program the same folder";
        Err(combination(shown(called), condition, remedy))
    }
}

/// Returns the number of the file that a call on a control names, with its ending or without. Controls do not distinguish cases.
pub(super) fn find(files: &[SubprogramFile], name: &str) -> Option<usize> {
    let name = without_folder(name);
    let mut found = files.iter().position(|file| file.name.eq_ignore_ascii_case(name));
    if found.is_none() {
        found = files.iter().position(|file| file.stem().eq_ignore_ascii_case(name));
    }
    found.map(|index| index + 1)
}

/// Returns the name of a file by its [number](SubprogramLine::file), for messages.
pub(super) fn name(files: &[SubprogramFile], number: usize) -> &str {
    match number {
        0 => "the program itself",
        number => &files[number - 1].name,
    }
}

/// Returns the fault of a line in a file of subprograms.
pub(super) fn in_file(files: &[SubprogramFile], file: usize, error: GcodeError) -> GcodeFault {
    let GcodeError { line, fault } = error;
    GcodeFault::InFile { name: name(files, file).to_owned(), line, fault: Box::new(fault) }
}

/// Returns the line that a fault in a file of subprograms names; `None` of a fault in the program.
pub(crate) fn line_of(files: &[SubprogramFile], fault: &GcodeFault) -> Option<SubprogramLine> {
    let GcodeFault::InFile { name: wanted, line, .. } = fault else { return None };
    let file = (0..=files.len()).find(|number| name(files, *number) == wanted)?;
    Some(SubprogramLine { file, line: *line })
}
