//! Rows of pieces of triangles. They are stored beside those of the triangles, which they leave as they are.

use super::{MapError, PostureMap, codec::encode};
use crate::piece::{add_ancestors, tiling};
use crate::{MapRow, Piece};
use redb::{ReadOnlyTable, ReadableDatabase, TableDefinition, TableError};
use std::collections::{BTreeMap, HashSet};
use touchoff::TriangleId;

/// Rows by triangle and [`Piece::path`]. A map that was never refined does not have this table.
pub(super) const PIECES: TableDefinition<'_, (u32, u32), &[u8]> = TableDefinition::new("pieces");

impl PostureMap {
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
        if self.is_copy {
            return Err(MapError::ReadOnly { file: self.file.clone() });
        }
        let write = self.database.begin_write().map_err(|error| self.store_error(error))?;
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
}

type PieceTable = ReadOnlyTable<(u32, u32), &'static [u8]>;

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
    let pieces = tiling(whole, &|piece| rows.contains_key(&piece), &inner);
    pieces.into_iter().filter_map(|piece| Some((piece, rows.remove(&piece)?))).collect()
}
