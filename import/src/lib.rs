//! Import of tool libraries: CAM systems' tools become `.tool` files.
//!
//! [`Library::read`] reads a library of Fusion 360, FreeCAD, HSM, Kiri:Moto, CAMotics or LinuxCNC, or the cutters of an APT
//! or NX program, and [`ImportedTool::write_to`] writes a `.tool` file for each tool, with the holder in a file of its own that is mounted.
//! A [`Note`] names each thing that a format leaves open; statements that contradict each other are
//! reported with the one that was taken. A tool without a shape that can be derived is [`Skipped`], with the reason.
//! The same file gives the same bytes each time.
//!
//! ```
//! use touchoff_import::Library;
//!
//! let json = r#"{"data": [{"type": "ball end mill", "unit": "millimeters", "description": "D6 ball",
//!     "geometry": {"DC": 6, "RE": 3, "LCF": 20, "OAL": 50, "SFDM": 6}}]}"#;
//! let library = Library::parse("library.json".as_ref(), json.as_bytes())?;
//! let tool = &library.tools()[0];
//! assert_eq!(tool.files[0].path, "d6_ball.tool");
//! assert!(tool.files[0].text.contains("arc to (R, R) center (0, R) as ball cutting;"));
//! # Ok::<(), touchoff_import::ImportError>(())
//! ```

#![deny(missing_docs, missing_debug_implementations, unnameable_types)]

mod apt;
mod camotics;
mod entry;
mod error;
pub mod export;
mod files;
mod find;
mod freecad;
mod fusion;
mod hsm;
mod json;
mod kiri;
mod libraries;
mod linuxcnc;
mod outline;
mod shape;
#[cfg(test)]
mod tests;

pub use entry::{Entry, Note, Skipped, Stated};
pub use error::ImportError;
pub use files::ToolFile;
pub use find::{FindError, files_in_folder, find_in_folder, write_numbers};
pub use libraries::Libraries;

use entry::reason;
use files::Writer;
use serde_json::Value;
use std::collections::BTreeMap;
use std::fs;
use std::io::{self, Read as _};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use touchoff::tool::Interpreted;
use touchoff::{AtomicFile, FileKind, is_within, read_regular_file};
use touchoff_dsl::source::Source;

/// The largest number of tools in a library.
const MAX_TOOLS: usize = 20_000;

/// A tool library.
#[derive(Clone, Debug)]
pub struct Library {
    file: PathBuf,
    tools: Vec<ImportedTool>,
    skipped: Vec<Skipped>,
    listed_files: Vec<PathBuf>,
}

/// A tool of a library, with its files.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct ImportedTool {
    /// The tool as the library states it.
    pub entry: Entry,
    /// The tool's name, which is the name of its file without the ending.
    pub name: String,
    /// The files: those that it mounts, then its own. Tools with the same holder share its file.
    pub files: Vec<ToolFile>,
}

/// The result of a format's reader for one tool.
type Found = Result<Entry, Problem>;

/// A tool that could not be read.
struct Problem {
    name: String,
    /// The number by which programs select it, if it is known.
    number: Option<u32>,
    reason: String,
}

impl Problem {
    fn new(name: &str, reason: &str) -> Problem {
        Problem { name: name.to_owned(), number: None, reason: reason.to_owned() }
    }

    /// States its number, as a library has it.
    fn numbered(self, value: Option<&Value>) -> Problem {
        Problem { number: value.and_then(json::tool_number), ..self }
    }
}

impl Library {
    /// Reads a tool library. A FreeCAD `.fctl` reads the `.fctb` files that it lists.
    ///
    /// # Errors
    /// If the file cannot be read, or is not in a format that can be read.
    pub fn read(file: &Path) -> Result<Library, ImportError> {
        Library::parse(file, &bytes(file)?)
    }

    /// Reads a tool library like [`Library::read`], and lists as missing what lies outside a folder, with links followed: for
    /// a library that a stranger has chosen.
    ///
    /// # Errors
    /// As for [`Library::read`].
    pub fn read_within(file: &Path, root: &Path) -> Result<Library, ImportError> {
        Library::parse_within(file, &bytes(file)?, Some(root))
    }

    /// Reads a tool library from the content of a file. The name gives the format by its ending, and the folder of the
    /// files that a FreeCAD `.fctl` lists.
    ///
    /// # Errors
    /// If the content is not in the format.
    pub fn parse(file: &Path, content: &[u8]) -> Result<Library, ImportError> {
        Library::parse_within(file, content, None)
    }

    fn parse_within(
        file: &Path,
        content: &[u8],
        root: Option<&Path>,
    ) -> Result<Library, ImportError> {
        let mut listed_files = Vec::new();
        let ending = file.extension().map(|ending| ending.to_ascii_lowercase());
        let ending = ending.as_deref().and_then(|ending| ending.to_str()).unwrap_or("");
        let (format, found) = match ending {
            "json" | "camotics" => (
                "a tool library of Fusion 360, Kiri:Moto or CAMotics",
                text(content).and_then(|t| json_tools(&t)),
            ),
            "tools" => {
                ("a Fusion 360 tool library", unzipped(content).and_then(|t| json_tools(&t)))
            }
            "fctb" => ("a FreeCAD tool bit", text(content).and_then(|t| freecad::bit(&t))),
            "fctl" => {
                let bits = text(content).and_then(|t| freecad::library(&t, file, root));
                let found = bits.map(|bits| {
                    listed_files = bits.files;
                    bits.found
                });
                ("a FreeCAD tool library", found)
            }
            "fcholder" => {
                ("a FreeCAD tool holder", text(content).and_then(|t| freecad::holder(&t)))
            }
            "hsmlib" | "xml" => ("an HSM tool library", text(content).and_then(|t| hsm::read(&t))),
            "tbl" => ("a LinuxCNC tool table", text(content).and_then(|t| linuxcnc::read(&t))),
            "apt" | "cl" | "cls" | "apt-cl" | "ncl" => {
                ("an APT program", apt::read(&text_of_program(content)))
            }
            _ => return Err(ImportError::UnknownFormat { file: file.to_owned() }),
        };
        let found = found.map_err(|reason| ImportError::Malformed {
            file: file.to_owned(),
            format,
            reason,
        })?;
        if found.is_empty() {
            return Ok(Library::of(file, vec![Err(Problem::new("library", "it has no tools"))]));
        }
        if found.len() > MAX_TOOLS {
            return Err(ImportError::TooManyTools { file: file.to_owned(), limit: MAX_TOOLS });
        }
        Ok(Library { listed_files, ..Library::of(file, found) })
    }

    fn of(file: &Path, found: Vec<Found>) -> Library {
        let source = file.file_name().map(|name| name.to_string_lossy()).unwrap_or_default();
        let mut writer = Writer::default();
        let mut library = Library {
            file: file.to_owned(),
            tools: Vec::new(),
            skipped: Vec::new(),
            listed_files: Vec::new(),
        };
        for (index, found) in found.into_iter().enumerate() {
            let position = index + 1;
            match found {
                Err(Problem { name, number, reason }) => {
                    library.skipped.push(Skipped { position, name, number, reason });
                }
                Ok(mut entry) => {
                    entry.add_notes();
                    match writer.write(&entry, &source) {
                        Ok((name, files)) => {
                            library.tools.push(ImportedTool { entry, name, files });
                        }
                        Err(error) => library.skipped.push(Skipped {
                            position,
                            name: entry.label().to_owned(),
                            number: entry.number,
                            reason: reason(&error),
                        }),
                    }
                }
            }
        }
        library
    }

    /// Returns the tools that have a shape, in the library's order.
    pub fn tools(&self) -> &[ImportedTool] {
        &self.tools
    }

    /// Returns the further files that it was read from: the bits that a FreeCAD library lists.
    pub fn listed_files(&self) -> &[PathBuf] {
        &self.listed_files
    }

    /// Returns the tools that were left out.
    pub fn skipped(&self) -> &[Skipped] {
        &self.skipped
    }

    /// Returns the tools that a text names. `T5` are those with the number 5, as programs select them, if a tool of the library has a number;
    /// none if one of them was left out. Otherwise come those with this name; without one, those with this title, and then those with this
    /// number.
    pub fn find(&self, wanted: &str) -> Vec<&ImportedTool> {
        let number: Option<u32> = wanted.trim_start_matches(['T', 't']).parse().ok();
        let has_number = |tool: &ImportedTool| number.is_some() && tool.entry.number == number;
        let is_selection = number.is_some_and(|number| wanted == format!("T{number}"))
            && (self.tools.iter().any(|tool| tool.entry.number.is_some())
                || self.skipped.iter().any(|skipped| skipped.number.is_some()));
        if is_selection {
            let is_left_out = self.skipped.iter().any(|skipped| skipped.number == number);
            return self.tools.iter().filter(|tool| !is_left_out && has_number(tool)).collect();
        }
        let is_wanted: [&dyn Fn(&ImportedTool) -> bool; 3] =
            [&|tool| tool.name == wanted, &|tool| tool.entry.title == wanted, &has_number];
        let mut found = is_wanted
            .into_iter()
            .map(|is_wanted| self.tools.iter().filter(|tool| is_wanted(tool)).collect::<Vec<_>>());
        found.find(|found| !found.is_empty()).unwrap_or_default()
    }
}

impl ImportedTool {
    /// Returns the path of the tool's own file, relative to the output folder.
    pub fn path(&self) -> String {
        format!("{}.tool", self.name)
    }

    /// Writes the tool's files below a folder, which is made if it does not exist, and returns the path of the tool's
    /// own. A file with other content is not replaced.
    ///
    /// # Errors
    /// If a file exists with other content, or cannot be written.
    pub fn write_to(&self, folder: &Path) -> Result<PathBuf, ImportError> {
        fs::create_dir_all(folder)
            .map_err(|source| ImportError::Unwritable { file: folder.to_owned(), source })?;
        for ToolFile { path, text } in &self.files {
            let file = folder.join(path);
            let unwritable = |source| ImportError::Unwritable { file: file.clone(), source };
            // The folder can be a stranger's, with links.
            if !is_within(&file, folder) {
                return Err(ImportError::Outside { file });
            }
            match read_regular_file(&file, FileKind::Library) {
                // Tools share files of holders, and a library can be imported again.
                Ok(known) if known == text.as_bytes() => continue,
                Err(error) if error.kind() == io::ErrorKind::NotFound => {}
                Ok(_) | Err(_) => return Err(ImportError::Exists { file }),
            }
            if let Some(parent) = file.parent() {
                fs::create_dir_all(parent).map_err(unwritable)?;
            }
            // A part of it, on a full disk, would be other content at the next import.
            AtomicFile::write(&file, text).map_err(unwritable)?;
        }
        Ok(folder.join(self.path()))
    }

    /// Returns the text of the tool with those that it mounts. Nothing is written or read.
    pub fn source(&self) -> Source {
        let files = self.files.iter().map(|file| (PathBuf::from(&file.path), file.text.clone()));
        let files: BTreeMap<PathBuf, String> = files.collect();
        let path = self.path();
        let text = files.get(Path::new(&path)).cloned().unwrap_or_default();
        Source::new(&path, text).with_path(&path).with_files(Arc::new(files))
    }

    /// Loads the tool, interpreted.
    ///
    /// # Errors
    /// [`ImportError::Tool`] if the tool does not compile: its dimensions are no solid.
    pub fn load(&self) -> Result<Interpreted, ImportError> {
        Ok(Interpreted::parse(&self.source())?)
    }
}

/// Reads a file.
fn bytes(file: &Path) -> Result<Vec<u8>, ImportError> {
    read_regular_file(file, FileKind::Library)
        .map_err(|source| ImportError::Unreadable { file: file.to_owned(), source })
}

/// Decodes a text by its byte-order mark; without one it has to be UTF-8.
fn text(content: &[u8]) -> Result<String, String> {
    let (encoding, mark) =
        encoding_rs::Encoding::for_bom(content).unwrap_or((encoding_rs::UTF_8, 0));
    encoding
        .decode_without_bom_handling_and_without_replacement(&content[mark..])
        .map(String::from)
        .ok_or_else(|| format!("its text is not {}", encoding.name()))
}

/// Decodes a program as [`text`]; one that is not UTF-8 is in Windows-1252, as posts write names of tools.
fn text_of_program(content: &[u8]) -> String {
    text(content).unwrap_or_else(|_| {
        encoding_rs::WINDOWS_1252.decode_without_bom_handling(content).0.into_owned()
    })
}

/// Reads the tools of a JSON text; their keys tell which program wrote it.
fn json_tools(text: &str) -> Result<Vec<Found>, String> {
    let value = json::parse(text)?;
    if kiri::is_tool(&value) {
        return Ok(vec![kiri::tool(&value)]);
    }
    let table = value.get("tools").unwrap_or(&value);
    if let Some(table) = table.as_object().filter(|table| camotics::is_table(table)) {
        return Ok(camotics::read(table));
    }
    let tools = match &value {
        Value::Array(tools) => Some(tools),
        _ => value.get("data").or_else(|| value.get("tools")).and_then(Value::as_array),
    };
    let tools = tools.ok_or("there is no list of tools, neither `data` nor `tools`")?;
    // One more tells a library that is refused.
    Ok(tools
        .iter()
        .take(MAX_TOOLS + 1)
        .map(|tool| if kiri::is_tool(tool) { kiri::tool(tool) } else { fusion::tool(tool) })
        .collect())
}

/// Returns the number of files that a ZIP archive states in its end record (APPNOTE 4.3.16), unless that is in the record of a larger archive.
fn files_of_archive(content: &[u8]) -> Option<usize> {
    let at = content.windows(4).rposition(|bytes| bytes == b"PK\x05\x06")?;
    let count = content.get(at + 10..at + 12)?;
    let count = u16::from_le_bytes([count[0], count[1]]);
    (count != u16::MAX).then_some(usize::from(count))
}

/// Returns the JSON file of an archive, which has one.
fn unzipped(content: &[u8]) -> Result<String, String> {
    let mut archive =
        zip::ZipArchive::new(std::io::Cursor::new(content)).map_err(|error| error.to_string())?;
    // The reader keeps the last of several files with one name.
    if files_of_archive(content).is_some_and(|count| count != archive.len()) {
        return Err("the archive has two files of one name".to_owned());
    }
    let named = |k: &usize| archive.name_for_index(*k).unwrap_or_default().ends_with(".json");
    let found: Vec<usize> = (0..archive.len()).filter(named).collect();
    let [json] = found[..] else {
        return Err(match found.len() {
            0 => "the archive has no `.json` file".to_owned(),
            count => {
                format!("the archive has {count} `.json` files, of which each is a library")
            }
        });
    };
    let file = archive.by_index(json).map_err(|error| error.to_string())?;
    let mut content = Vec::new();
    let max_bytes = FileKind::Library.max_bytes();
    // A byte beyond the limit tells a text that is longer.
    file.take(max_bytes + 1).read_to_end(&mut content).map_err(|error| error.to_string())?;
    if content.len() as u64 > max_bytes {
        return Err(format!("its content is larger than {max_bytes} bytes"));
    }
    text(&content)
}
