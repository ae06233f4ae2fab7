//! Errors of saving and opening parts.

use std::io;

/// Reasons why a saved part could not be opened, or why a part could not be saved. Byte offsets count
/// from 0.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SavedError {
    /// The file system refused to read the file.
    #[error("cannot read {file}: {source}: check the path and its permissions")]
    Unreadable {
        /// The file name.
        file: String,
        /// The error of the operating system.
        source: io::Error,
    },
    /// The file does not begin as saved parts do.
    #[error(
        "{file} is no saved part: it seems to be {seems}: open what `Part::save` wrote, and make \
         a part from a mesh by `Part::from_mesh`"
    )]
    UnknownFormat {
        /// The file name.
        file: String,
        /// The presumed kind of file.
        seems: &'static str,
    },
    /// The file is shorter than its header declares.
    #[error(
        "{file} is cut off: it has {has} bytes and needs at least {needs}: copy it again, or \
         make it again from the mesh"
    )]
    Truncated {
        /// The file name.
        file: String,
        /// The file length in bytes.
        has: u64,
        /// The minimum file length in bytes.
        needs: u64,
    },
    /// The file continues after the end of the part.
    #[error(
        "{file} has {has} bytes, and the part in it ends after {needs}: copy it again, or make \
         it again from the mesh"
    )]
    Trailing {
        /// The file name.
        file: String,
        /// The file length in bytes.
        has: u64,
        /// The expected file length in bytes.
        needs: u64,
    },
    /// The file has a later version than this program supports.
    #[error(
        "{file} is a saved part of version {version}, and versions up to {reads} are read here: \
         update this program, or make the file again from the mesh"
    )]
    Newer {
        /// The file name.
        file: String,
        /// The version of the file.
        version: u32,
        /// The newest supported version.
        reads: u32,
    },
    /// A checksum does not match the bytes.
    #[error(
        "{file} is damaged: the checksum of {section}, bytes {from} to {to}, is wrong: copy it \
         again, or make it again from the mesh"
    )]
    Damaged {
        /// The file name.
        file: String,
        /// The damaged section.
        section: String,
        /// The byte offset at which the section begins.
        from: u64,
        /// The byte offset at which the section ends: the first byte after it.
        to: u64,
    },
    /// The checksums match, but the content is not a valid part.
    #[error(
        "{file} contradicts itself: {what}: the program that wrote it has a fault; make it again \
         from the mesh with another version, and report this"
    )]
    Inconsistent {
        /// The file name.
        file: String,
        /// The contradiction found.
        what: String,
    },
    /// The file system refused to write the file; any previous file is unchanged.
    #[error(
        "cannot write {file}: {source}: check the path, its permissions and the room left; the \
         file is as it was"
    )]
    Unwritable {
        /// The file name.
        file: String,
        /// The error of the operating system.
        source: io::Error,
    },
    /// This machine is big-endian.
    #[error(
        "{file}: saved parts are little-endian and this machine is big-endian: make the part \
         from the mesh instead"
    )]
    BigEndian {
        /// The file name.
        file: String,
    },
}
