//! What can be wrong with a map.

use super::Difference;
use std::io;

/// Why a posture map could not be opened, read or written into.
#[derive(Debug, thiserror::Error)]
pub enum MapError {
    /// The file system would not give it.
    #[error("cannot open {file}: {source}: check the path and its permissions")]
    Unreadable {
        /// The file.
        file: String,
        /// What the system said.
        source: io::Error,
    },
    /// It is something else.
    #[error("{file} is no posture map: give another path, or remove it if it is not needed")]
    Foreign {
        /// The file.
        file: String,
    },
    /// It is of a version that came later.
    #[error(
        "{file} is a posture map of version {version}, and versions up to {reads} are read here: update this \
         program, or make the map again at another path"
    )]
    Newer {
        /// The file.
        file: String,
        /// Its version.
        version: u32,
        /// The newest version that is read.
        reads: u32,
    },
    /// Another has it open.
    #[error("{file} is open in another process: wait until that has ended, or end it")]
    Locked {
        /// The file.
        file: String,
    },
    /// Another writes into it without a pause long enough to copy it.
    #[error("{file} is written into too fast to be read: try again, or wait until that has ended")]
    Busy {
        /// The file.
        file: String,
    },
    /// It was opened to be read.
    #[error(
        "{file} was opened to be read only: open it with `PostureMap::resume` to record into it"
    )]
    ReadOnly {
        /// The file.
        file: String,
    },
    /// Its end is missing.
    #[error(
        "{file} is truncated: it has {length} of {whole} bytes: take a copy that is whole, or remove it and make it \
         again"
    )]
    Truncated {
        /// The file.
        file: String,
        /// The bytes that it has.
        length: u64,
        /// The bytes that it had at least.
        whole: u64,
    },
    /// It has more of something than any map.
    #[error("{file} is no map that can be used: {what}")]
    Oversized {
        /// The file.
        file: String,
        /// What there is too much of, and how much there may be.
        what: String,
    },
    /// Its bytes are not those that were written.
    #[error("{file} is damaged: {what}: take a copy that is whole, or remove it and make it again")]
    Damaged {
        /// The file.
        file: String,
        /// What was found.
        what: String,
    },
    /// It belongs to something else.
    #[error(
        "{file} cannot go on: {difference}: give another path for a new map, or remove the file"
    )]
    Differs {
        /// The file.
        file: String,
        /// What is not the same.
        difference: Difference,
    },
    /// There is no room left.
    #[error(
        "no room for {file}: {source}: what was recorded before is safe in it; make room and open it again"
    )]
    Full {
        /// The file.
        file: String,
        /// What the system said.
        source: io::Error,
    },
    /// The file system would not take it.
    #[error(
        "cannot write {file}: {source}: what was recorded before is safe in it; mend the cause and open it again"
    )]
    Unwritable {
        /// The file.
        file: String,
        /// What the system said.
        source: io::Error,
    },
    /// Something was to be recorded that this map has no place for; nothing of its batch was.
    #[error("triangle {triangle} cannot be recorded in {file}: {what}")]
    Unfit {
        /// The file.
        file: String,
        /// The triangle.
        triangle: u32,
        /// What does not fit.
        what: &'static str,
    },
    /// An export could not be written.
    #[error("cannot write what {file} has: {source}: check the path and the room left")]
    Export {
        /// The map's file.
        file: String,
        /// What the system said.
        source: io::Error,
    },
}

impl MapError {
    /// What the store says, in words.
    pub(super) fn of(file: &str, error: impl Into<redb::Error>) -> MapError {
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

    /// What the system said when it was written into.
    pub(super) fn written(file: String, source: io::Error) -> MapError {
        match source.kind() {
            io::ErrorKind::StorageFull
            | io::ErrorKind::QuotaExceeded
            | io::ErrorKind::FileTooLarge => MapError::Full { file, source },
            _ => MapError::Unwritable { file, source },
        }
    }
}
