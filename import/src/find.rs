//! Tools by their names and numbers, in a library or in a folder of `.tool` files.

use super::{ImportedTool, Library};
use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::ffi::OsStr;
use std::io;
use std::path::{Component, Path, PathBuf};
use touchoff::{AtomicFile, FileKind, is_within, read_text_file};

/// A reason for which no tool is selected, or no number is listed.
#[derive(thiserror::Error)]
#[non_exhaustive]
pub enum FindError {
    /// The library has no such tool.
    #[error(
        "`{file}` has no tool with the name, title or number `{name}`: `touchoff import {file} --list` lists them"
    )]
    NotFound {
        /// The name, title or number.
        name: String,
        /// The library.
        file: String,
    },
    /// Several tools have the number or the title.
    #[error("`{file}` has {} tools `{name}`: {}; name one, in a job by `[tool.N] tool = \"FILE.tool\"`", tools.len(), tools.join(", "))]
    Several {
        /// The title or number, as it was asked for.
        name: String,
        /// The library or the folder.
        file: String,
        /// The tools, each in backquotes.
        tools: Vec<String>,
    },
    /// A tool with the number was left out when the folder was imported.
    #[error(
        "a tool {number} was left out when {folder} was imported: mend it in the library, remove {number} from `tools.toml` and import \
         that again, or name one, in a job by `[tool.N] tool = \"FILE.tool\"`"
    )]
    LeftOut {
        /// The number, as `T1`.
        number: String,
        /// The folder.
        folder: String,
    },
    /// A name that is that of no file directly in the folder of tools.
    #[error(
        "`{name}` is no name of a tool in {folder}: its tools are the files in it that end in `.tool`; name another as a file"
    )]
    NoName {
        /// The name.
        name: String,
        /// The folder.
        folder: String,
    },
    /// The file of a tool lies outside the folder of tools.
    #[error("{file} is outside the folder of tools {folder}: name it as a file, or copy it there")]
    Outside {
        /// The file.
        file: String,
        /// The folder.
        folder: String,
    },
    /// The list of numbers in a folder is refused.
    #[error("{file}: {message}")]
    Numbers {
        /// The list.
        file: String,
        /// The reason.
        message: String,
    },
    /// The list of numbers cannot be written.
    #[error(
        "cannot write {file}: {source}: check the folder, its permissions and the room on the disk"
    )]
    Unwritable {
        /// The list.
        file: String,
        /// The cause.
        source: io::Error,
    },
    /// The list of numbers cannot be read.
    #[error("{file}: cannot be read ({source}): check the path and its permissions")]
    Unreadable {
        /// The list.
        file: String,
        /// The cause.
        source: io::Error,
    },
}

touchoff::debug_as_sentence!(FindError);

/// The file of a folder that lists the numbers of its tools.
const NUMBERS: &str = "tools.toml";

/// The tools of a folder: file names by the number of the tool, as `T1`; none if one with the number was left out of the import.
type Numbers = BTreeMap<String, Vec<String>>;

impl Library {
    /// Returns the one tool with this name, title or number; see [`Library::find`].
    ///
    /// # Errors
    /// If there is none, or if several tools have the title or the number.
    pub fn select(&self, wanted: &str) -> Result<&ImportedTool, FindError> {
        let (name, file) = (wanted.to_owned(), self.file.display().to_string());
        match &self.find(wanted)[..] {
            [] => Err(FindError::NotFound { name, file }),
            [tool] => Ok(tool),
            several => {
                let tools = several.iter().map(|tool| format!("`{}`", tool.name)).collect();
                Err(FindError::Several { name, file, tools })
            }
        }
    }
}

/// Returns the file of a tool in a folder of `.tool` files, by its name, with or without its ending, or by its number in the folder's
/// list. The file may not exist. Its name ends in `.tool`, so that [`files_in_folder`] has it.
///
/// # Errors
/// If the name leads to another folder, if several tools have the number, or if the list cannot be read or names another kind of file.
pub fn find_in_folder(folder: &Path, name: &OsStr) -> Result<PathBuf, FindError> {
    let shown = || folder.display().to_string();
    let name_of = |name: &OsStr| name.to_string_lossy().into_owned();
    if !Path::new(name).components().eq([Component::Normal(name)]) {
        return Err(FindError::NoName { name: name_of(name), folder: shown() });
    }
    let mut file = folder.join(name);
    if !is_tool(&file) {
        file.as_mut_os_string().push(".tool");
    }
    let list = within(folder, folder.join(NUMBERS))?;
    let name = name_of(name).to_ascii_uppercase();
    let mut numbers = read_numbers(folder)?;
    let listed = numbers.remove(&name);
    if listed.as_ref().is_some_and(Vec::is_empty) {
        return Err(FindError::LeftOut { number: name, folder: shown() });
    }
    let mut tools = listed.unwrap_or_default();
    // A file with the name of a number is one more tool with this number.
    let own = file.file_name().map(|own| own.to_string_lossy().into_owned());
    if let Some(own) = own.filter(|own| !tools.contains(own) && file.is_file()) {
        tools.push(own);
    }
    match &tools[..] {
        [] => within(folder, file),
        [listed] if !is_tool(Path::new(listed)) => {
            let message =
                format!("{name} is `{listed}`, whose name does not end in `.tool`: rename it");
            Err(FindError::Numbers { file: list.display().to_string(), message })
        }
        [listed] => within(folder, folder.join(listed)),
        several => Err(FindError::Several {
            name,
            file: shown(),
            tools: several.iter().map(|tool| format!("`{tool}`")).collect(),
        }),
    }
}

/// Returns whether a key of the list is `T` with a number as [`write_numbers`] writes it.
fn is_number(key: &str) -> bool {
    let number = key.strip_prefix('T').and_then(|digits| digits.parse::<u32>().ok());
    number.is_some_and(|number| key == format!("T{number}"))
}

fn is_tool(file: &Path) -> bool {
    file.extension().is_some_and(|ending| ending == "tool")
}

/// Returns the files that tools of a folder are read from, as far as they can be read: those that end in `.tool`, those that its list
/// of numbers names, and the list.
pub fn files_in_folder(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let files = entries.map(|entry| entry.path()).filter(|file| is_tool(file));
    let mut files: Vec<PathBuf> = files.collect();
    let is_own = is_within(folder.join(NUMBERS), folder);
    let numbers = if is_own { read_numbers(folder).unwrap_or_default() } else { Numbers::new() };
    let listed = numbers.into_values().flatten();
    files.extend(listed.map(|file| folder.join(file)));
    files.push(folder.join(NUMBERS));
    files.retain(|file| file.is_file() && is_within(file, folder));
    files.sort();
    files.dedup();
    files
}

/// Returns the file of a tool of a folder, which must lie within it: a list or a link can be a stranger's.
fn within(folder: &Path, file: PathBuf) -> Result<PathBuf, FindError> {
    match is_within(&file, folder) {
        true => Ok(file),
        false => Err(FindError::Outside {
            file: file.display().to_string(),
            folder: folder.display().to_string(),
        }),
    }
}

/// Adds the numbers of imported tools to the list of a folder, and those of tools that were left out, which no file has then.
///
/// # Errors
/// If the list that is there cannot be read, or the new one cannot be written.
pub fn write_numbers(
    folder: &Path,
    tools: &[&ImportedTool],
    left_out: &[u32],
) -> Result<(), FindError> {
    // The folder is made with its first tool.
    if tools.is_empty() && !folder.is_dir() {
        return Ok(());
    }
    let path = within(folder, folder.join(NUMBERS))?;
    let mut numbers = read_numbers(folder)?;
    for tool in tools {
        let Some(number) = tool.entry.number else { continue };
        match numbers.entry(format!("T{number}")) {
            Entry::Vacant(entry) => drop(entry.insert(vec![tool.path()])),
            Entry::Occupied(mut entry) => {
                let files = entry.get_mut();
                // Numbers that another library left out stay so, and a second import of one lists each file once.
                if !files.is_empty() && !files.contains(&tool.path()) {
                    files.push(tool.path());
                }
            }
        }
    }
    for number in left_out {
        numbers.insert(format!("T{number}"), Vec::new());
    }
    if numbers.is_empty() {
        return Ok(());
    }
    let mut text =
        "# The numbers of the tools in this folder; without a file, that of a tool that was left out.\n"
            .to_owned();
    for (number, files) in &numbers {
        let files: Vec<String> = files.iter().map(|file| toml_string(file)).collect();
        text += &format!("{number} = [{}]\n", files.join(", "));
    }
    AtomicFile::write(&path, text)
        .map_err(|source| FindError::Unwritable { file: path.display().to_string(), source })
}

/// Returns a basic string of TOML.
fn toml_string(text: &str) -> String {
    let escaped = text.chars().map(|c| match c {
        '"' | '\\' => format!("\\{c}"),
        _ if c.is_control() => format!("\\u{:04x}", u32::from(c)),
        _ => c.to_string(),
    });
    format!("\"{}\"", escaped.collect::<String>())
}

fn read_numbers(folder: &Path) -> Result<Numbers, FindError> {
    let path = folder.join(NUMBERS);
    let file = path.display().to_string();
    match read_text_file(&path, FileKind::Settings) {
        Ok(text) => {
            let refused = |message: String| FindError::Numbers { file: file.clone(), message };
            let numbers: Numbers =
                toml::from_str(&text).map_err(|error| refused(error.message().to_owned()))?;
            // Another spelling of a number would not be found, and could contradict the one that is.
            match numbers.keys().find(|key| !is_number(key)) {
                Some(key) => Err(refused(format!("`{key}` is no number of a tool: write `T1`"))),
                None => Ok(numbers),
            }
        }
        // A folder of tools without numbers has no list.
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(Numbers::new()),
        Err(source) => Err(FindError::Unreadable { file, source }),
    }
}
