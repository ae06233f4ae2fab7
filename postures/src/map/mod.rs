//! Posture maps in files: the data on record for each triangle of a part, stored as it is found.
//!
//! The file is a `redb` store of two tables: facts about the map (its version, its [`MapIdentity`]) and rows by
//! triangle ([`coding`] has the bytes). A refined map has a third one, rows by piece. A batch is one transaction, stored whole or not at all. It is on disk
//! when [`PostureMap::record`] or [`PostureMap::merge`] returns.

mod codec;
mod error;
mod export;
mod identity;
mod merge;
mod open;
mod pieces;
mod snapshot;
#[cfg(test)]
mod tests;

pub use error::MapError;
pub use identity::{Difference, MapIdentity, PartFingerprint, ToolFingerprint};

use super::{Accessibility, MapRow, PostureRecord};
use codec::{decode, encode};
pub(super) use merge::merge;
use redb::{Database, Range, ReadOnlyTable, ReadableDatabase, ReadableTable, TableDefinition};
use std::collections::BTreeSet;
use std::fmt;
use touchoff::TriangleId;

const FACTS: TableDefinition<'_, &str, &[u8]> = TableDefinition::new("facts");
const ROWS: TableDefinition<'_, u32, &[u8]> = TableDefinition::new("rows");
/// Key of the version among the facts: a little-endian `u32` in every version.
const VERSION: &str = "version";
/// Key of the identity among the facts.
const IDENTITY: &str = "identity";
/// The version that is written, and the newest that is read.
const FORMAT_VERSION: u32 = 1;

/// Postures at a part, per triangle, in a file.
///
/// ```
/// # use nalgebra::Point3;
/// # use touchoff_postures::{MapIdentity, PostureMap, PostureRecord, Rules};
/// # use touchoff::{TriangleId, Unit, mesh::shapes};
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
/// let identity = MapIdentity::new(&block, &[&Ball], rules)?;
/// let map = PostureMap::open(&path, &identity)?;
/// let (tip, axis) = ([20.0, 20.0, 9.995], [0.0, 0.0, 1.0]);
/// let record = PostureRecord { tool: 0, tip, axis, niceness: 1.0, depth: 0.005, clearance: 1.0 };
/// map.merge(&[(TriangleId(3), record)])?;
/// assert_eq!(map.row(TriangleId(3))?.map(|row| row.best), Some(vec![record]));
/// assert_eq!(map.coverage()?.covered, 1);
/// # Ok(()) }
/// ```
#[derive(Debug)]
pub struct PostureMap {
    database: Database,
    identity: MapIdentity,
    file: String,
    /// Set if this is a copy of the file, made for reading only.
    is_copy: bool,
}

/// Coverage of a part by a map.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct Coverage {
    /// Number of triangles with a posture on record; a divided one has it at any of its pieces.
    pub covered: u32,
    /// Number of triangles that are divided into pieces.
    pub divided: u32,
    /// Number of their pieces.
    pub pieces: u32,
    /// Number of triangles that a sweep has processed.
    pub swept: u32,
    /// Number of triangles of the part.
    pub triangles: u32,
}

/// An iterator over the rows of a map by triangle, as they were when it was created.
pub struct MapRows<'a> {
    range: Range<'static, u32, &'static [u8]>,
    map: &'a PostureMap,
    /// The least triangle id that may come next.
    next: u64,
}

impl fmt::Debug for MapRows<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("MapRows").field("next", &self.next).finish_non_exhaustive()
    }
}

impl Iterator for MapRows<'_> {
    type Item = Result<(TriangleId, MapRow), MapError>;

    fn next(&mut self) -> Option<Self::Item> {
        let entry = self.range.next()?;
        Some(entry.map_err(|error| self.map.store_error(error)).and_then(|(triangle, bytes)| {
            let triangle = TriangleId(triangle.value());
            if u64::from(triangle.0) < self.next {
                return Err(self.map.damaged(format!("triangle {triangle} is there twice")));
            }
            self.next = u64::from(triangle.0) + 1;
            Ok((triangle, self.map.decoded(triangle, bytes.value())?))
        }))
    }
}

impl PostureMap {
    /// Returns the part, the tools and the rules that the map belongs to.
    pub fn identity(&self) -> &MapIdentity {
        &self.identity
    }

    /// Returns the row of a triangle, if there is one.
    ///
    /// # Errors
    /// If the file cannot be read, or the row is damaged.
    pub fn row(&self, triangle: TriangleId) -> Result<Option<MapRow>, MapError> {
        let table = self.table()?;
        let bytes = table.get(triangle.0).map_err(|error| self.store_error(error))?;
        bytes.map(|bytes| self.decoded(triangle, bytes.value())).transpose()
    }

    /// Returns all rows, by triangle.
    ///
    /// # Errors
    /// If the file cannot be read. A damaged row is an error of its own in the iteration.
    pub fn rows(&self) -> Result<MapRows<'_>, MapError> {
        let range = self.table()?.range::<u32>(..).map_err(|error| self.store_error(error))?;
        Ok(MapRows { range, map: self, next: 0 })
    }

    /// Stores the rows of a sweep, all of them or none. Accessibility entries replace those on record. Postures
    /// join those on record, of which the best are kept. When this returns, the rows are on disk.
    ///
    /// # Errors
    /// If the map was opened for reading only, if there is no room, if the file cannot be written, or if a row
    /// does not fit the map.
    pub fn record(&self, rows: &[(TriangleId, MapRow)]) -> Result<(), MapError> {
        for (triangle, row) in rows {
            self.check_row(*triangle, &row.best, &row.access)?;
        }
        self.update(rows, |known, row| {
            known.access.clone_from(&row.access);
            merge(&mut known.best, &row.best, self.identity.keep);
        })
    }

    /// Adds postures to triangles, all of them or none, and keeps the best: the nicest, then those with the
    /// largest clearance, then the least deep. The result does not depend on the order of arrival. When this
    /// returns, it is on disk.
    ///
    /// # Errors
    /// If the map was opened for reading only, if there is no room, if the file cannot be written, or if a
    /// record does not fit the map.
    pub fn merge(&self, records: &[(TriangleId, PostureRecord)]) -> Result<(), MapError> {
        for (triangle, record) in records {
            self.check_row(*triangle, std::slice::from_ref(record), &[])?;
        }
        self.update(records, |known, record| {
            merge(&mut known.best, std::slice::from_ref(record), self.identity.keep);
        })
    }

    /// Returns the triangles that a sweep has processed.
    ///
    /// # Errors
    /// If the file cannot be read, or a row is damaged.
    pub fn swept(&self) -> Result<BTreeSet<TriangleId>, MapError> {
        let mut swept = BTreeSet::new();
        for entry in self.rows()? {
            let (triangle, row) = entry?;
            if !row.access.is_empty() {
                swept.insert(triangle);
            }
        }
        Ok(swept)
    }

    /// Returns the coverage of the part.
    ///
    /// # Errors
    /// If the file cannot be read, or a row is damaged.
    pub fn coverage(&self) -> Result<Coverage, MapError> {
        let triangles = self.identity.part.triangles;
        let mut coverage = Coverage { triangles, ..Coverage::default() };
        self.for_each_triangle(|_, pieces| {
            let any = |is_there: fn(&MapRow) -> bool| pieces.iter().any(|(_, row)| is_there(row));
            coverage.covered += u32::from(any(|row| !row.best.is_empty()));
            coverage.swept += u32::from(any(|row| !row.access.is_empty()));
            if pieces.len() > 1 {
                coverage.divided += 1;
                coverage.pieces += pieces.len() as u32;
            }
            Ok::<(), MapError>(())
        })?;
        Ok(coverage)
    }

    /// Joins new data to rows, in one transaction.
    fn update<T>(
        &self,
        updates: &[(TriangleId, T)],
        join: impl Fn(&mut MapRow, &T),
    ) -> Result<(), MapError> {
        if self.is_copy {
            return Err(MapError::ReadOnly { file: self.file.clone() });
        }
        let write = self.database.begin_write().map_err(|error| self.store_error(error))?;
        let mut table = write.open_table(ROWS).map_err(|error| self.store_error(error))?;
        let mut changed = false;
        for (triangle, new) in updates {
            let old = match table.get(triangle.0).map_err(|error| self.store_error(error))? {
                Some(bytes) => self.decoded(*triangle, bytes.value())?,
                None => MapRow::default(),
            };
            let mut row = old.clone();
            join(&mut row, new);
            if row != old {
                let bytes = encode(&row);
                table
                    .insert(triangle.0, bytes.as_slice())
                    .map_err(|error| self.store_error(error))?;
                changed = true;
            }
        }
        drop(table);
        // Without a change there is no commit to wait for.
        if changed {
            write.commit().map_err(|error| self.store_error(error))
        } else {
            write.abort().map_err(|error| self.store_error(error))
        }
    }

    fn table(&self) -> Result<ReadOnlyTable<u32, &'static [u8]>, MapError> {
        let read = self.database.begin_read().map_err(|error| self.store_error(error))?;
        read.open_table(ROWS).map_err(|error| self.store_error(error))
    }

    /// Decodes a row, and checks that it fits the map.
    fn decoded(&self, triangle: TriangleId, bytes: &[u8]) -> Result<MapRow, MapError> {
        let identity = &self.identity;
        let check_row = |row: &MapRow| {
            row.best.len() <= usize::from(identity.keep.get())
                && identity.row_error(triangle, &row.best, &row.access).is_none()
        };
        decode(bytes).filter(check_row).ok_or_else(|| {
            self.damaged(format!("the row of triangle {triangle} is not what was written"))
        })
    }

    fn damaged(&self, what: String) -> MapError {
        MapError::Damaged { file: self.file.clone(), what }
    }

    fn check_row(
        &self,
        triangle: TriangleId,
        best: &[PostureRecord],
        access: &[Accessibility],
    ) -> Result<(), MapError> {
        match self.identity.row_error(triangle, best, access) {
            Some(what) => Err(MapError::Unfit { file: self.file.clone(), triangle, what }),
            None => Ok(()),
        }
    }

    fn store_error(&self, error: impl Into<redb::Error>) -> MapError {
        let error = MapError::from_database(&self.file, error);
        if self.is_copy { as_damage(error) } else { error }
    }
}

/// Returns an error of a copy as damage: a copy makes no system calls, so the cause is in the file.
fn as_damage(error: MapError) -> MapError {
    match error {
        MapError::Unwritable { file, source } | MapError::Full { file, source } => {
            MapError::Damaged { file, what: source.to_string() }
        }
        error => error,
    }
}
