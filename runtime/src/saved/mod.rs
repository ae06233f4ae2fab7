//! Parts in files: made once from a mesh, opened in no time.
//!
//! **The file** is the part as it lies in memory, little-endian. A header tells what there is: the
//! [magic bytes](layout::MAGIC), the header's checksum and length, the version, the file's length, the unit, a survey,
//! and for each tree its frame, how many points it has, and of each of its lists the place, length and
//! checksum ([`layout`] has the records). Then come the lists, each at a multiple of 64 bytes: of each tree,
//! the finest first, the boxes level by level from the root's children, the points, their normals and weights,
//! their triangles' ids.
//!
//! **Opening** maps the file and checks it all: what it begins with, how long it is, every checksum, and
//! that the lists are as long as so many points make them and end where they should. After that no query
//! can be led out of a list. Nothing is copied.

mod error;
mod foreign;
mod layout;
mod read;

pub use error::SavedError;

use crate::{AtomicFile, Part};
use layout::ALIGN;
use memmap2::{Mmap, MmapOptions};
use std::fs::{self, File};
use std::io::{self, Write};
use std::path::Path;
use std::sync::Arc;

impl Part {
    /// Writes the part to a file that [`Part::open`] opens, in place of one that is there: whole, or,
    /// when anything fails, not at all. It is written beside the old one and then takes its name, so
    /// parts that were opened from the old one keep what they have.
    ///
    /// # Errors
    /// What the file system says.
    pub fn save(&self, path: impl AsRef<Path>) -> Result<(), SavedError> {
        let path = path.as_ref();
        let file = || path.display().to_string();
        refuse_big_endian(path)?;
        let (header, sections) = layout::of(self);
        replace(path, |out| write(out, &header, &sections))
            .map_err(|source| SavedError::Unwritable { file: file(), source })
    }

    /// Opens what [`Part::save`] wrote. Every question has the answers of the part that was saved, bit
    /// for bit.
    ///
    /// The part is not read but mapped into memory, which is shared with other programs that open it; it
    /// takes some milliseconds for a million points that the system has in its cache. While a part is open its file must not
    /// be written into or shortened: [`Part::save`] does neither, it puts a new file in place of the old
    /// one, and so do `mv` and installers. Should another program do it all the same, answers may be wrong, a
    /// question may panic, and the system may end the program (`SIGBUS`) when it looks for what was cut off.
    /// Where that cannot be ruled out, open a copy.
    ///
    /// # Errors
    /// A file that cannot be read, is no saved part, is cut off, too long or damaged, or was made by a
    /// newer version.
    ///
    /// ```
    /// # use touchoff::{Part, Unit, mesh::shapes};
    /// # use nalgebra::Point3;
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// # let folder = tempfile::tempdir()?;
    /// # let path = folder.path().join("block.part");
    /// let block = shapes::cuboid(Point3::origin(), Point3::new(40., 40., 10.), Unit::Millimetre)?;
    /// Part::from_mesh(&block, 1_000, 1)?.save(&path)?;
    /// let part = Part::open(&path)?;
    /// assert_eq!(part.tree().len(), 1_000);
    /// # Ok(()) }
    /// ```
    pub fn open(path: impl AsRef<Path>) -> Result<Part, SavedError> {
        let path = path.as_ref();
        refuse_big_endian(path)?;
        let file = path.display().to_string();
        match map(path) {
            Ok(map) => read::part(&Arc::new(map), &file),
            Err(source) => Err(SavedError::Unreadable { file, source }),
        }
    }
}

/// The file is the memory's image, so both must have the same order of bytes.
fn refuse_big_endian(path: &Path) -> Result<(), SavedError> {
    if cfg!(target_endian = "big") {
        return Err(SavedError::BigEndian { file: path.display().to_string() });
    }
    Ok(())
}

/// A file in memory.
fn map(path: &Path) -> io::Result<Mmap> {
    // Asked first: a pipe would be waited for.
    if !fs::metadata(path)?.is_file() {
        return Err(io::Error::new(io::ErrorKind::InvalidInput, "it is no regular file"));
    }
    let file = File::open(path)?;
    mapped(&file)
}

#[expect(unsafe_code, reason = "a file in memory can be changed from outside")]
fn mapped(file: &File) -> io::Result<Mmap> {
    // All of it is about to be read: one call finds the pages of all.
    // SAFETY: bytes that lie in a map must not change while a slice of them is held. This program does not write
    // into files of saved parts (`replace` makes new ones), and `Part::open` demands the same of others. No bytes
    // make an invalid value: all that they are taken for is `Pod`.
    unsafe { MmapOptions::new().populate().map(file) }
}

/// Writes a header and sections, these filled up with zeros.
fn write(out: &mut dyn Write, header: &[u8], sections: &[&[u8]]) -> io::Result<()> {
    out.write_all(header)?;
    for bytes in sections {
        out.write_all(bytes)?;
        out.write_all(&[0; ALIGN][..bytes.len().next_multiple_of(ALIGN) - bytes.len()])?;
    }
    Ok(())
}

/// Puts a new file in place of an old one when it is whole and on the disk.
fn replace(path: &Path, write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<()> {
    let mut new = AtomicFile::create(path)?;
    write(&mut new)?;
    new.commit()
}

#[cfg(test)]
mod tests;
