//! Errors of the import.

use std::path::PathBuf;

/// A file that is not a tool library that can be read.
#[derive(thiserror::Error)]
#[non_exhaustive]
pub enum ImportError {
    /// The file could not be read.
    #[error("cannot read {}: {source}: check the path and its permissions", .file.display())]
    Unreadable {
        /// The file.
        file: PathBuf,
        /// The cause.
        source: std::io::Error,
    },
    /// Neither the name's ending nor the content is that of a format that can be read.
    #[error(
        "{} is none of the formats that can be read: Fusion 360 (`.json`, `.tools`), Kiri:Moto (`.json`), \
         CAMotics (`.json`, `.camotics`), FreeCAD (`.fctb`, `.fctl`, `.fcholder`), HSM (`.hsmlib`), LinuxCNC (`.tbl`), \
         APT and NX (`.apt`, `.cl`, `.cls`): export the library in one of these", .file.display()
    )]
    UnknownFormat {
        /// The file.
        file: PathBuf,
    },
    /// The file is not in the format that its ending states.
    #[error("{}: not {format}: {reason}: export the library again", .file.display())]
    Malformed {
        /// The file.
        file: PathBuf,
        /// The format.
        format: &'static str,
        /// The error, with its position if known.
        reason: String,
    },
    /// The library has more tools than the limit.
    #[error("{}: more than {limit} tools: split the library", .file.display())]
    TooManyTools {
        /// The file.
        file: PathBuf,
        /// The limit.
        limit: usize,
    },
    /// A file could not be written.
    #[error("cannot write {}: {source}: check the folder, its permissions and the room on the disk", .file.display())]
    Unwritable {
        /// The file.
        file: PathBuf,
        /// The cause.
        source: std::io::Error,
    },
    /// A link leads out of the folder of tools.
    #[error("{} leads out of the folder of tools: remove the link, or choose another folder", .file.display())]
    Outside {
        /// The file.
        file: PathBuf,
    },
    /// A file exists and is not what would be written.
    #[error("{} exists with other content: remove it, or choose another folder", .file.display())]
    Exists {
        /// The file.
        file: PathBuf,
    },
    /// The tool does not compile.
    #[error(transparent)]
    Tool(#[from] touchoff::tool::ToolError),
}

touchoff::debug_as_sentence!(ImportError);
