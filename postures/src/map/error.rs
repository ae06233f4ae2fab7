//! Errors of posture maps.

use super::Difference;
use std::io;
use touchoff::TriangleId;

/// A reason for which a posture map cannot be opened, read or written.
#[derive(thiserror::Error)]
#[non_exhaustive]
pub enum MapError {
    /// The file cannot be opened or read.
    #[error("cannot open {file}: {source}: check the path and its permissions")]
    Unreadable {
        /// The file.
        file: String,
        /// The system's error.
        source: io::Error,
    },
    /// The file is not a posture map.
    #[error("{file} is no posture map: give another path, or remove it if it is not needed")]
    Foreign {
        /// The file.
        file: String,
    },
    /// The map has a newer version than this library reads.
    #[error(
        "{file} is a posture map of version {version}, and versions up to {reads} are read here: update this \
         program, or make the map again at another path"
    )]
    Newer {
        /// The file.
        file: String,
        /// The map's version.
        version: u32,
        /// The newest version that is read.
        reads: u32,
    },
    /// Another process has the file open.
    #[error("{file} is open in another process: wait until that has ended, or end it")]
    Locked {
        /// The file.
        file: String,
    },
    /// Another process writes to the file without a pause long enough to copy it.
    #[error("{file} is written into too fast to be read: try again, or wait until that has ended")]
    Busy {
        /// The file.
        file: String,
    },
    /// The map was opened for reading only.
    #[error(
        "{file} was opened to be read only: open it with `PostureMap::resume` to record into it"
    )]
    ReadOnly {
        /// The file.
        file: String,
    },
    /// The end of the file is missing.
    #[error(
        "{file} is truncated: it has {length} of {expected} bytes: take a complete copy, or remove it and make it \
         again"
    )]
    Truncated {
        /// The file.
        file: String,
        /// Size of the file, in bytes.
        length: u64,
        /// Least size of the whole file, in bytes.
        expected: u64,
    },
    /// The map exceeds a limit of all maps.
    #[error("{file} is no map that can be used: {what}")]
    Oversized {
        /// The file.
        file: String,
        /// The quantity that is too large, and its limit.
        what: String,
    },
    /// The bytes differ from those that were written.
    #[error("{file} is damaged: {what}: take a complete copy, or remove it and make it again")]
    Damaged {
        /// The file.
        file: String,
        /// A description of the damage.
        what: String,
    },
    /// The map belongs to another part, or to other tools, rules or directions.
    #[error(
        "{file} cannot be continued: {difference}: give another path for a new map, or remove the file"
    )]
    Differs {
        /// The file.
        file: String,
        /// The difference.
        difference: Difference,
    },
    /// There is no room left.
    #[error(
        "no room for {file}: {source}: what was recorded before is safe in it; make room and open it again"
    )]
    Full {
        /// The file.
        file: String,
        /// The system's error.
        source: io::Error,
    },
    /// The file cannot be written.
    #[error(
        "cannot write {file}: {source}: what was recorded before is safe in it; mend the cause and open it again"
    )]
    Unwritable {
        /// The file.
        file: String,
        /// The system's error.
        source: io::Error,
    },
    /// A record does not fit the map; nothing of its batch was stored.
    #[error("triangle {triangle} cannot be recorded in {file}: {what}")]
    Unfit {
        /// The file.
        file: String,
        /// The triangle.
        triangle: TriangleId,
        /// The reason.
        what: &'static str,
    },
    /// A map is written where there is a file.
    #[error("{file} is there already, and a merged map is new: remove it, or give another path")]
    Exists {
        /// The file.
        file: String,
    },
    /// An export could not be written.
    #[error("cannot write what {file} has: {source}: check the path and the room left")]
    Export {
        /// The map's file.
        file: String,
        /// The system's error.
        source: io::Error,
    },
}

touchoff::debug_as_sentence!(MapError);

impl MapError {
    /// Converts an error of the store.
    pub(super) fn from_database(file: &str, error: impl Into<redb::Error>) -> MapError {
        use redb::Error as Store;
        let file = file.to_owned();
        match error.into() {
            Store::Io(source) => MapError::written(file, source),
            Store::PreviousIo => {
                let source = io::Error::other("an earlier write to it failed");
                MapError::Unwritable { file, source }
            }
            Store::DatabaseAlreadyOpen | Store::LockProtocolMismatch => MapError::Locked { file },
            Store::TableDoesNotExist(_)
            | Store::TableTypeMismatch { .. }
            | Store::TableIsMultimap(_)
            | Store::UpgradeRequired(_) => MapError::Foreign { file },
            Store::Corrupted(what) => MapError::Damaged { file, what },
            other => MapError::Damaged { file, what: other.to_string() },
        }
    }

    /// Converts an error of the system in writing the file.
    pub(super) fn written(file: String, source: io::Error) -> MapError {
        match source.kind() {
            io::ErrorKind::StorageFull
            | io::ErrorKind::QuotaExceeded
            | io::ErrorKind::FileTooLarge => MapError::Full { file, source },
            _ => MapError::Unwritable { file, source },
        }
    }
}
