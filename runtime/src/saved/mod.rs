//! Parts in files: made once from a mesh, opened in milliseconds.
//!
//! **The file** is the part as it lies in memory, little-endian. A header tells what there is: the
//! [magic bytes](layout::MAGIC), the header's checksum and length, the version, the file's length, the unit, a survey,
//! and for each tree its frame, how many points it has, and of each of its lists the place, length and
//! checksum ([`layout`] has the records). Then come the lists, each at a multiple of 64 bytes: of each tree,
//! the finest first, the boxes level by level from the root's children, the points, their normals and weights,
//! their triangles' ids.
//!
//! **Opening** reads the file, each list straight to where it stays, and checks it all: what it begins with, how long it
//! is, every checksum, and that the lists are as long as so many points make them and end where they should. After that
//! no query can be led out of a list. The lists are not mapped: a file in memory may be shortened by others, which ends
//! the program, and no safe function can rule that out.

mod error;
mod foreign;
mod layout;
mod read;

pub use error::SavedError;

use crate::atomic_file::AtomicFile;
use crate::input;
use crate::part::Part;
use layout::ALIGN;
use std::io::{self, Write};
use std::path::Path;

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
    /// The file is read into memory, 34 bytes for each point of each level, and then checked.
    /// So the part does not depend on the file any more: it may be changed, shortened or removed while the part is
    /// in use. A million points, 34 MB, take some 10 to 100 ms: mostly for fresh pages of memory.
    ///
    /// # Errors
    /// A file that cannot be read or is no regular one, is no saved part, is cut off, too long or damaged, or was made by a
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
        match input::open(path) {
            Ok((source, length)) => read::part(source, length, &file),
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
