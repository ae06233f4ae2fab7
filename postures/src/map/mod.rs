//! Posture maps in files: the data on record for each triangle of a part, stored as it is found.
//!
//! The file is a `redb` store of two tables: facts about the map (its version, its [`MapIdentity`]) and rows by
//! triangle. A refined map has a third one, rows by piece, beside those of the triangles, which it leaves as they are. Values
//! are a CRC-32 of the rest, little-endian, then `postcard`. A batch is one transaction, stored whole or not at all. It is on
//! disk when [`PostureMap::record`] or [`PostureMap::merge`] returns.

mod error;
mod export;
mod identity;
mod open;
#[cfg(test)]
pub(crate) mod tests;

pub use error::MapError;
pub use identity::{Difference, MapIdentity, PartFingerprint, ToolFingerprint};

use crate::piece::{add_ancestors, tiling};
use crate::record::merge;
use crate::{Accessibility, MapRow, Piece, PostureRecord};
use redb::{
    Database, Range, ReadOnlyTable, ReadableDatabase, ReadableTable, TableDefinition, TableError,
    WriteTransaction,
};
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::collections::{BTreeMap, BTreeSet, HashSet};
use std::fmt;
use touchoff::TriangleId;

const FACTS: TableDefinition<'_, &str, &[u8]> = TableDefinition::new("facts");
const ROWS: TableDefinition<'_, u32, &[u8]> = TableDefinition::new("rows");
/// Rows by triangle and [`Piece::path`]. A map that was never refined does not have this table.
const PIECES: TableDefinition<'_, (u32, u32), &[u8]> = TableDefinition::new("pieces");
type PieceTable = ReadOnlyTable<(u32, u32), &'static [u8]>;
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
            // Keys come in ascending order unless the store is damaged.
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
        self.update(rows.iter().map(|(triangle, row)| (*triangle, row)), |known, row| {
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
        self.update(records.iter().map(|(triangle, row)| (*triangle, row)), |known, record| {
            merge(&mut known.best, std::slice::from_ref(record), self.identity.keep);
        })
    }

    /// Stores the rows of pieces of triangles, all of them or none. They replace those on record. When this returns,
    /// the rows are on disk.
    ///
    /// # Errors
    /// If the map was opened for reading only, if there is no room, if the file cannot be written, if a row does not
    /// fit the map, or if a piece is a whole triangle, which [`PostureMap::record`] takes.
    pub fn record_pieces(&self, rows: &[(Piece, MapRow)]) -> Result<(), MapError> {
        for (piece, row) in rows {
            let triangle = piece.triangle();
            self.check_row(triangle, &row.best, &row.access)?;
            if piece.cuts() == 0 {
                let what = "it is a whole triangle and not a piece of one";
                return Err(MapError::Unfit { file: self.file.clone(), triangle, what });
            }
        }
        let write = self.begin_write()?;
        let mut table = write.open_table(PIECES).map_err(|error| self.store_error(error))?;
        for (piece, row) in rows {
            let (key, bytes) = ((piece.triangle().0, piece.path()), encode(row));
            table.insert(key, bytes.as_slice()).map_err(|error| self.store_error(error))?;
        }
        drop(table);
        write.commit().map_err(|error| self.store_error(error))
    }

    /// Returns the rows of all pieces that were judged, without the whole triangles.
    ///
    /// # Errors
    /// If the file cannot be read, or a row is damaged.
    pub fn piece_rows(&self) -> Result<BTreeMap<Piece, MapRow>, MapError> {
        let Some(table) = self.piece_table()? else { return Ok(BTreeMap::new()) };
        self.piece_range(&table, [(0, 0), (u32::MAX, u32::MAX)])
    }

    /// Returns the pieces that a triangle consists of, with their rows. An undivided triangle is one piece; a triangle
    /// without a row has none.
    ///
    /// # Errors
    /// If the file cannot be read, or a row is damaged.
    pub fn pieces(&self, triangle: TriangleId) -> Result<Vec<(Piece, MapRow)>, MapError> {
        let whole = self.row(triangle)?;
        let rows = match self.piece_table()? {
            Some(table) => self.rows_of(&table, triangle)?,
            None => BTreeMap::new(),
        };
        Ok(tiles(triangle, whole, rows))
    }

    /// Passes each triangle that has a row to `each`, with its pieces as in [`PostureMap::pieces`].
    ///
    /// # Errors
    /// Those of `each`, or if the file cannot be read, or if a row is damaged.
    pub fn for_each_triangle<E: From<MapError>>(
        &self,
        mut each: impl FnMut(TriangleId, Vec<(Piece, MapRow)>) -> Result<(), E>,
    ) -> Result<(), E> {
        let table = self.piece_table()?;
        for entry in self.rows()? {
            let (triangle, row) = entry?;
            let rows = match &table {
                Some(table) => self.rows_of(table, triangle)?,
                None => BTreeMap::new(),
            };
            each(triangle, tiles(triangle, Some(row), rows))?;
        }
        Ok(())
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
            coverage.covered += u32::from(pieces.iter().any(|(_, row)| !row.best.is_empty()));
            coverage.swept += u32::from(pieces.iter().any(|(_, row)| !row.access.is_empty()));
            if pieces.len() > 1 {
                coverage.divided += 1;
                coverage.pieces += pieces.len() as u32;
            }
            Ok::<(), MapError>(())
        })?;
        Ok(coverage)
    }

    /// Joins new data to rows, in one transaction.
    fn update<'t, T: 't>(
        &self,
        updates: impl Iterator<Item = (TriangleId, &'t T)>,
        join: impl Fn(&mut MapRow, &T),
    ) -> Result<(), MapError> {
        let write = self.begin_write()?;
        let mut table = write.open_table(ROWS).map_err(|error| self.store_error(error))?;
        let mut changed = false;
        for (triangle, new) in updates {
            let old = match table.get(triangle.0).map_err(|error| self.store_error(error))? {
                Some(bytes) => self.decoded(triangle, bytes.value())?,
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

    fn begin_write(&self) -> Result<WriteTransaction, MapError> {
        // A copy would take the data and lose them.
        if self.is_copy {
            return Err(MapError::ReadOnly { file: self.file.clone() });
        }
        self.database.begin_write().map_err(|error| self.store_error(error))
    }

    fn table(&self) -> Result<ReadOnlyTable<u32, &'static [u8]>, MapError> {
        let read = self.database.begin_read().map_err(|error| self.store_error(error))?;
        read.open_table(ROWS).map_err(|error| self.store_error(error))
    }

    /// Returns the rows of a triangle's pieces.
    fn rows_of(
        &self,
        table: &PieceTable,
        TriangleId(triangle): TriangleId,
    ) -> Result<BTreeMap<Piece, MapRow>, MapError> {
        self.piece_range(table, [(triangle, 0), (triangle, u32::MAX)])
    }

    fn piece_range(
        &self,
        table: &PieceTable,
        [first, last]: [(u32, u32); 2],
    ) -> Result<BTreeMap<Piece, MapRow>, MapError> {
        let range = table.range(first..=last).map_err(|error| self.store_error(error))?;
        range
            .map(|entry| {
                let (key, bytes) = entry.map_err(|error| self.store_error(error))?;
                let (triangle, path) = key.value();
                let triangle = TriangleId(triangle);
                let piece = Piece::from_path(triangle, path).filter(|piece| piece.cuts() > 0);
                let piece = piece.ok_or_else(|| {
                    self.damaged(format!("a piece of triangle {triangle} is none"))
                })?;
                Ok((piece, self.decoded(triangle, bytes.value())?))
            })
            .collect()
    }

    /// Returns the table of pieces, if there is one.
    fn piece_table(&self) -> Result<Option<PieceTable>, MapError> {
        let read = self.database.begin_read().map_err(|error| self.store_error(error))?;
        match read.open_table(PIECES) {
            Ok(table) => Ok(Some(table)),
            Err(TableError::TableDoesNotExist(_)) => Ok(None),
            Err(error) => Err(self.store_error(error)),
        }
    }

    /// Decodes a row, and checks that it fits the map.
    fn decoded(&self, triangle: TriangleId, bytes: &[u8]) -> Result<MapRow, MapError> {
        // The checksum is no proof of origin: a row that was made elsewhere must not lead beyond the map's lists.
        let identity = &self.identity;
        let row = decode(bytes).filter(|row: &MapRow| {
            row.best.len() <= usize::from(identity.keep.get())
                && identity.row_error(triangle, &row.best, &row.access).is_none()
        });
        row.ok_or_else(|| {
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

/// Returns the smallest pieces with rows that cover a triangle.
fn tiles(
    triangle: TriangleId,
    row: Option<MapRow>,
    mut rows: BTreeMap<Piece, MapRow>,
) -> Vec<(Piece, MapRow)> {
    let whole = Piece::whole(triangle);
    let mut inner = HashSet::new();
    rows.keys().for_each(|piece| add_ancestors(*piece, &mut inner));
    rows.extend(row.map(|row| (whole, row)));
    let pieces = tiling(whole, |piece| rows.contains_key(&piece), &inner);
    pieces.into_iter().filter_map(|piece| Some((piece, rows.remove(&piece)?))).collect()
}

/// Encodes a value.
pub(crate) fn encode(value: &impl Serialize) -> Vec<u8> {
    let payload = postcard::to_allocvec(value).expect("lists of known length");
    let mut bytes = crc32fast::hash(&payload).to_le_bytes().to_vec();
    bytes.extend(payload);
    bytes
}

/// Decodes a value; `None` if the bytes are not those that were written.
pub(crate) fn decode<T: DeserializeOwned>(bytes: &[u8]) -> Option<T> {
    let (checksum, payload) = bytes.split_first_chunk()?;
    if u32::from_le_bytes(*checksum) != crc32fast::hash(payload) {
        return None;
    }
    match postcard::take_from_bytes(payload) {
        Ok((value, [])) => Some(value),
        _ => None,
    }
}
