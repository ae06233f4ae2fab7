//! Posture maps in files: what is known of each triangle of a part, kept as it is found.
//!
//! The file is a `redb` store of two tables: facts about the map (its version, its [`Identity`]) and rows by
//! triangle ([`coding`] has the bytes). A batch is one transaction: it is there whole or not at all, and once
//! [`PostureMap::record`] or [`PostureMap::offer`] returns it is on the disk.

mod coding;
mod error;
mod export;
mod identity;
mod merge;
mod open;
mod snapshot;
#[cfg(test)]
mod tests;

pub use error::MapError;
pub use identity::{Difference, Identity, PartStamp, ToolStamp};

use super::{Access, Record, Row};
use coding::{decode, encode};
pub(super) use merge::merge;
use redb::{Database, Range, ReadOnlyTable, ReadableDatabase, ReadableTable, TableDefinition};
use std::collections::BTreeSet;

const FACTS: TableDefinition<'_, &str, &[u8]> = TableDefinition::new("facts");
const ROWS: TableDefinition<'_, u32, &[u8]> = TableDefinition::new("rows");
/// Of the facts: the version, a little-endian `u32` in every version, and the identity.
const VERSION: &str = "version";
const IDENTITY: &str = "identity";
/// The version that is written, and the newest that is read.
const NEWEST: u32 = 1;

/// Postures at a part, triangle by triangle, in a file.
///
/// ```
/// # use nalgebra::Point3;
/// # use touchoff::postures::{Identity, PostureMap, Record, Rules};
/// # use touchoff::{Unit, mesh::shapes};
/// # touchoff::tool! {
/// #     tool Ball "a ball of 3 mm radius" {
/// #         units mm;
/// #         profile { start (0, 0); arc to (0, 6) center (0, 3) as ball cutting; }
/// #         niceness cutting: 1;
/// #     }
/// # }
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// # let folder = tempfile::tempdir()?;
/// # let path = folder.path().join("block.postures");
/// let block = shapes::cuboid(Point3::origin(), Point3::new(40., 40., 10.), Unit::Millimetre)?;
/// let rules = Rules { tolerance: 0.01, niceness: 0.5, allowed: Vec::new() };
/// let identity = Identity::new(&block, &[&Ball], rules)?;
/// let map = PostureMap::open(&path, &identity)?;
/// let (tip, axis) = ([20.0, 20.0, 9.995], [0.0, 0.0, 1.0]);
/// let record = Record { tool: 0, tip, axis, niceness: 1.0, depth: 0.005, clearance: 1.0 };
/// map.offer(&[(3, record)])?;
/// assert_eq!(map.row(3)?.map(|row| row.best), Some(vec![record]));
/// assert_eq!(map.coverage()?.covered, 1);
/// # Ok(()) }
/// ```
#[derive(Debug)]
pub struct PostureMap {
    database: Database,
    identity: Identity,
    file: String,
    /// Whether this is a copy of the file, made to be read.
    is_copy: bool,
}

/// How much of a part is known.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Coverage {
    /// How many triangles have a posture on record.
    pub covered: u32,
    /// To how many a sweep came.
    pub swept: u32,
    /// How many there are.
    pub triangles: u32,
}

/// The rows of a map by triangle, as they were when this was asked for.
pub struct Rows<'a> {
    range: Range<'static, u32, &'static [u8]>,
    map: &'a PostureMap,
    /// The first triangle that may come next.
    next: u64,
}

impl Iterator for Rows<'_> {
    type Item = Result<(u32, Row), MapError>;

    fn next(&mut self) -> Option<Self::Item> {
        let entry = self.range.next()?;
        Some(entry.map_err(|error| self.map.says(error)).and_then(|(triangle, bytes)| {
            let triangle = triangle.value();
            if u64::from(triangle) < self.next {
                return Err(self.map.damaged(format!("triangle {triangle} is there twice")));
            }
            self.next = u64::from(triangle) + 1;
            Ok((triangle, self.map.decoded(triangle, bytes.value())?))
        }))
    }
}

impl PostureMap {
    /// To what it belongs.
    pub fn identity(&self) -> &Identity {
        &self.identity
    }

    /// What is known of a triangle, if anything.
    ///
    /// # Errors
    /// If the file cannot be read, or the row is damaged.
    pub fn row(&self, triangle: u32) -> Result<Option<Row>, MapError> {
        let table = self.table()?;
        let bytes = table.get(triangle).map_err(|error| self.says(error))?;
        bytes.map(|bytes| self.decoded(triangle, bytes.value())).transpose()
    }

    /// All rows that there are, by triangle.
    ///
    /// # Errors
    /// If the file cannot be read; each row by itself, if it is damaged.
    pub fn rows(&self) -> Result<Rows<'_>, MapError> {
        let range = self.table()?.range::<u32>(..).map_err(|error| self.says(error))?;
        Ok(Rows { range, map: self, next: 0 })
    }

    /// Takes in what a sweep found of triangles, all of it or nothing: its accesses in place of those that
    /// were there, its postures beside those on record, of which the best stay. When this returns, it is on
    /// the disk.
    ///
    /// # Errors
    /// If there is no room, or the file cannot be written; if a row does not fit the map.
    pub fn record(&self, rows: &[(u32, Row)]) -> Result<(), MapError> {
        for (triangle, row) in rows {
            self.fits(*triangle, &row.best, &row.access)?;
        }
        self.change(rows, |known, row| {
            known.access.clone_from(&row.access);
            merge(&mut known.best, &row.best, self.identity.keep);
        })
    }

    /// Takes in postures at triangles, all of them or nothing, of which the best stay: the nicest, of those
    /// the ones that clear the part by most, then the least deep. In whatever order they come, the same
    /// stay. When this returns, they are on the disk.
    ///
    /// # Errors
    /// If there is no room, or the file cannot be written; if a record does not fit the map.
    pub fn offer(&self, records: &[(u32, Record)]) -> Result<(), MapError> {
        for (triangle, record) in records {
            self.fits(*triangle, std::slice::from_ref(record), &[])?;
        }
        self.change(records, |known, record| {
            merge(&mut known.best, std::slice::from_ref(record), self.identity.keep);
        })
    }

    /// The triangles that a sweep came to.
    ///
    /// # Errors
    /// If the file cannot be read, or a row is damaged.
    pub fn swept(&self) -> Result<BTreeSet<u32>, MapError> {
        let mut swept = BTreeSet::new();
        for entry in self.rows()? {
            let (triangle, row) = entry?;
            if !row.access.is_empty() {
                swept.insert(triangle);
            }
        }
        Ok(swept)
    }

    /// How much of the part is known.
    ///
    /// # Errors
    /// If the file cannot be read, or a row is damaged.
    pub fn coverage(&self) -> Result<Coverage, MapError> {
        let triangles = self.identity.part.triangles;
        self.rows()?.try_fold(Coverage { triangles, ..Coverage::default() }, |known, entry| {
            let (_, row) = entry?;
            Ok(Coverage {
                covered: known.covered + u32::from(!row.best.is_empty()),
                swept: known.swept + u32::from(!row.access.is_empty()),
                ..known
            })
        })
    }

    /// Joins what is new to rows, in one transaction.
    fn change<T>(&self, news: &[(u32, T)], join: impl Fn(&mut Row, &T)) -> Result<(), MapError> {
        if self.is_copy {
            return Err(MapError::ReadOnly { file: self.file.clone() });
        }
        let write = self.database.begin_write().map_err(|error| self.says(error))?;
        let mut table = write.open_table(ROWS).map_err(|error| self.says(error))?;
        let mut changed = false;
        for (triangle, new) in news {
            let old = match table.get(triangle).map_err(|error| self.says(error))? {
                Some(bytes) => self.decoded(*triangle, bytes.value())?,
                None => Row::default(),
            };
            let mut row = old.clone();
            join(&mut row, new);
            if row != old {
                let bytes = encode(&row);
                table.insert(triangle, bytes.as_slice()).map_err(|error| self.says(error))?;
                changed = true;
            }
        }
        drop(table);
        // If nothing is better than what is on the disk, there is nothing to wait for.
        if changed {
            write.commit().map_err(|error| self.says(error))
        } else {
            write.abort().map_err(|error| self.says(error))
        }
    }

    fn table(&self) -> Result<ReadOnlyTable<u32, &'static [u8]>, MapError> {
        let read = self.database.begin_read().map_err(|error| self.says(error))?;
        read.open_table(ROWS).map_err(|error| self.says(error))
    }

    /// A row of bytes.
    fn decoded(&self, triangle: u32, bytes: &[u8]) -> Result<Row, MapError> {
        let identity = &self.identity;
        let fits = |row: &Row| {
            row.best.len() <= usize::from(identity.keep.get())
                && identity.refuses(triangle, &row.best, &row.access).is_none()
        };
        decode(bytes).filter(fits).ok_or_else(|| {
            self.damaged(format!("the row of triangle {triangle} is not what was written"))
        })
    }

    fn damaged(&self, what: String) -> MapError {
        MapError::Damaged { file: self.file.clone(), what }
    }

    fn fits(&self, triangle: u32, best: &[Record], access: &[Access]) -> Result<(), MapError> {
        match self.identity.refuses(triangle, best, access) {
            Some(what) => Err(MapError::Unfit { file: self.file.clone(), triangle, what }),
            None => Ok(()),
        }
    }

    fn says(&self, error: impl Into<redb::Error>) -> MapError {
        let error = MapError::of(&self.file, error);
        if self.is_copy { as_damage(error) } else { error }
    }
}

/// An error of a copy as damage: it asks nothing of the system, so the cause is in the file.
fn as_damage(error: MapError) -> MapError {
    match error {
        MapError::Unwritable { file, source } | MapError::Full { file, source } => {
            MapError::Damaged { file, what: source.to_string() }
        }
        error => error,
    }
}
