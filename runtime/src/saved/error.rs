//! Why a part could not be saved or opened.

use std::io;

/// Why a saved part could not be opened, or a part not be saved. Bytes count from 0.
#[derive(Debug, thiserror::Error)]
pub enum SavedError {
    /// The file system would not give it.
    #[error("cannot read {file}: {source}: check the path and its permissions")]
    Unreadable {
        /// The file.
        file: String,
        /// What the system said.
        source: io::Error,
    },
    /// It begins otherwise than saved parts do.
    #[error(
        "{file} is no saved part: it seems to be {seems}: open what `Part::save` wrote, and make \
         a part from a mesh by `Part::from_mesh`"
    )]
    Foreign {
        /// The file.
        file: String,
        /// What it seems to be.
        seems: &'static str,
    },
    /// It ends too early.
    #[error(
        "{file} is cut off: it has {has} bytes and needs at least {needs}: copy it again, or \
         make it again from the mesh"
    )]
    Truncated {
        /// The file.
        file: String,
        /// How many bytes it has.
        has: u64,
        /// How many it must have at least.
        needs: u64,
    },
    /// It goes on after its end.
    #[error(
        "{file} has {has} bytes, and the part in it ends after {needs}: copy it again, or make \
         it again from the mesh"
    )]
    Trailing {
        /// The file.
        file: String,
        /// How many bytes it has.
        has: u64,
        /// How many it should have.
        needs: u64,
    },
    /// It is of a version that came later.
    #[error(
        "{file} is a saved part of version {version}, and versions up to {reads} are read here: \
         update this program, or make the file again from the mesh"
    )]
    Newer {
        /// The file.
        file: String,
        /// Its version.
        version: u32,
        /// The newest version that is read.
        reads: u32,
    },
    /// Its bytes are not those that were written.
    #[error(
        "{file} is damaged: the checksum of {section}, bytes {from} to {to}, is wrong: copy it \
         again, or make it again from the mesh"
    )]
    Damaged {
        /// The file.
        file: String,
        /// What is damaged.
        section: String,
        /// Where that begins.
        from: u64,
        /// Where it ends: the first byte after it.
        to: u64,
    },
    /// Its bytes are those that were written, but they make no part.
    #[error(
        "{file} contradicts itself: {what}: the program that wrote it has a fault; make it again \
         from the mesh with another version, and report this"
    )]
    Unsound {
        /// The file.
        file: String,
        /// What does not fit.
        what: String,
    },
    /// The file system would not take it; what was there before is still there.
    #[error(
        "cannot write {file}: {source}: check the path, its permissions and the room left; the \
         file is as it was"
    )]
    Unwritable {
        /// The file.
        file: String,
        /// What the system said.
        source: io::Error,
    },
    /// This machine has its bytes the other way round.
    #[error(
        "{file}: saved parts are little-endian and this machine is big-endian: make the part \
         from the mesh instead"
    )]
    BigEndian {
        /// The file.
        file: String,
    },
}
