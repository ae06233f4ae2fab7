//! Saving parts to files and opening them in milliseconds.
//!
//! **The file** is the part's memory image, little-endian. Its header contains the [magic bytes](layout::MAGIC), the
//! header's checksum and length, the version, the file's length, the unit, and the mesh diagnostics. For each tree it
//! contains the frame, the number of points, and the offset, length and checksum of each list ([`layout`] defines the
//! records). Then come the lists, each at a multiple of 64 bytes, with the finest tree first. The lists of a tree are
//! the boxes level by level from the root's children, the points, their normals and weights, and their triangles' ids.
//!
//! **Opening** reads each list directly into its final memory and then validates it. The checks cover the magic bytes,
//! the file length, every checksum, the lengths of the lists for the number of points, and the ends of the lists. After
//! that, no query can index outside a list. The lists are not memory-mapped: another process may shorten a mapped file,
//! which terminates the program, and no safe function can rule that out.

mod layout;
mod read;

use crate::atomic_file::AtomicFile;
use crate::input::{self, FileKind};
use crate::part::Part;
use layout::ALIGN;
use std::io::{self, Write};
use std::path::Path;

/// Reasons why a saved part could not be opened, or why a part could not be saved. Byte offsets count from 0.
#[derive(thiserror::Error)]
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

crate::debug_as_sentence!(SavedError);

impl Part {
    /// Writes the part to a file for [`Part::open`], replacing an existing file: completely or, if
    /// anything fails, not at all. The new file is written beside the old one and then renamed, so parts
    /// opened from the old file are unaffected.
    ///
    /// # Errors
    /// Returns the errors of the file system, and [`SavedError::BigEndian`] on a big-endian machine.
    pub fn save(&self, path: impl AsRef<Path>) -> Result<(), SavedError> {
        let path = path.as_ref();
        refuse_big_endian(path)?;
        let (header, sections) = layout::of(self);
        replace(path, |out| write(out, &header, &sections))
            .map_err(|source| SavedError::Unwritable { file: path.display().to_string(), source })
    }

    /// Opens a part written by [`Part::save`]. Every query gives bitwise the same answers as with the saved part.
    ///
    /// The file is read into memory, 34 bytes per point and level, and then validated. The part does not
    /// depend on the file afterwards: the file may be changed, shortened or removed while the part is in
    /// use. A million points, 34 MB, take some 10 to 100 ms, mostly for fresh pages of memory.
    ///
    /// # Errors
    /// Fails if the file cannot be read, is not a regular file or a saved part, is cut off, too long or
    /// damaged, or has a newer version. Fails with [`SavedError::BigEndian`] on a big-endian machine.
    ///
    /// ```
    /// # use touchoff::{Part, Sampling, Unit, mesh::shapes};
    /// # use nalgebra::Point3;
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// # let folder = tempfile::tempdir()?;
    /// # let path = folder.path().join("block.part");
    /// let block = shapes::cuboid(Point3::origin(), Point3::new(40., 40., 10.), Unit::Millimetre)?;
    /// Part::from_mesh(&block, Sampling::new(1_000))?.save(&path)?;
    /// let part = Part::open(&path)?;
    /// assert_eq!(part.tree().len(), 1_000);
    /// # Ok(()) }
    /// ```
    pub fn open(path: impl AsRef<Path>) -> Result<Part, SavedError> {
        let path = path.as_ref();
        refuse_big_endian(path)?;
        let file = path.display().to_string();
        match input::open_regular_file(path, FileKind::Geometry) {
            Ok((source, length)) => read::part(source, length, &file),
            Err(source) => Err(SavedError::Unreadable { file, source }),
        }
    }
}

/// Fails on big-endian machines: the file is a memory image, so both must have the same byte order.
fn refuse_big_endian(path: &Path) -> Result<(), SavedError> {
    if cfg!(target_endian = "big") {
        return Err(SavedError::BigEndian { file: path.display().to_string() });
    }
    Ok(())
}

/// Writes a header and sections, padding the sections with zeros.
fn write(out: &mut dyn Write, header: &[u8], sections: &[&[u8]]) -> io::Result<()> {
    out.write_all(header)?;
    for bytes in sections {
        out.write_all(bytes)?;
        out.write_all(&[0; ALIGN][..bytes.len().next_multiple_of(ALIGN) - bytes.len()])?;
    }
    Ok(())
}

/// Replaces an old file by a new one that is complete and on the disk.
fn replace(path: &Path, write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<()> {
    let mut new = AtomicFile::create(path)?;
    write(&mut new)?;
    new.commit()
}

#[cfg(test)]
mod tests;
