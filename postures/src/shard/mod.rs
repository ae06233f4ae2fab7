//! Shards: a sweep in equal parts, each with a file of its own, which merge to one map.
//!
//! A shard has some of the batches of a sweep, and the content of a batch depends on the part, the tools and the rules alone. The
//! bytes of a shard's file, and those of the merged map, are hence the same on every machine, in any order and as often as a shard is
//! computed.
//!
//! ```text
//! sweep ── shard 1/n ──▶ 1.parquet ─┐
//!       ── shard 2/n ──▶ 2.parquet ─┼─ merge ──▶ map, or one table
//!       ── …                        ┘
//! ```

mod table;
#[cfg(test)]
mod tests;

pub(crate) use table::{TableRow, encoded};

use crate::map::Difference;
use crate::record::area_reached;
use crate::{MapError, MapIdentity, MapRow, Piece, PostureMap};
use std::io::{self, Write};
use std::path::Path;
use touchoff::{
    AtomicFile, FileKind, Mesh, Shard, ShardSet, ShardSetError, TriangleId, read_regular_file,
};

/// A reason for which shards cannot be written, read or merged.
#[derive(thiserror::Error)]
#[non_exhaustive]
pub enum ShardError {
    /// A file cannot be read.
    #[error("cannot read {file}: {source}: check the path")]
    Unreadable {
        /// The file.
        file: String,
        /// The system's error.
        source: io::Error,
    },
    /// A file cannot be written. What was there is unchanged.
    #[error("cannot write {file}: {source}: check the path and the room left")]
    Unwritable {
        /// The file.
        file: String,
        /// The system's error.
        source: io::Error,
    },
    /// A file has no table of postures.
    #[error("{file} is no shard of a sweep: give files of `touchoff sweep --shard`")]
    Foreign {
        /// The file.
        file: String,
    },
    /// A table is that of a whole map.
    #[error(
        "{file} is the table of a whole map, and no shard: give files of `touchoff sweep --shard`"
    )]
    Whole {
        /// The file.
        file: String,
    },
    /// A file is not what was written.
    #[error("{file} is damaged: {what}: run its shard again")]
    Damaged {
        /// The file.
        file: String,
        /// The reason.
        what: String,
    },
    /// A file of another version, whose sweep may differ.
    #[error(
        "{file} was written by version {version} of Touchoff, and this is {reads}: remove it, and run its shard again"
    )]
    OtherVersion {
        /// The file.
        file: String,
        /// The version that has written it.
        version: String,
        /// This version.
        reads: &'static str,
    },
    /// A shard of another sweep.
    #[error("{file} is of another sweep than {first}: {difference}")]
    Differs {
        /// The file.
        file: String,
        /// The first file.
        first: String,
        /// The difference.
        difference: Difference,
    },
    /// A file that has another shard of the same sweep.
    #[error("{file} has shard {found}, and not {wanted}: give each shard a file of its own")]
    OtherShard {
        /// The file.
        file: String,
        /// Its shard.
        found: Shard,
        /// The shard that is to be written.
        wanted: Shard,
    },
    /// A shard that does not go with the others.
    #[error(transparent)]
    Set(#[from] ShardSetError),
    /// Shards are missing.
    #[error("{} of {count} shards are left, the first of them {first}: run them (`touchoff merge --left` lists them)", .left)]
    Incomplete {
        /// The number of missing shards.
        left: usize,
        /// The number of shards.
        count: u32,
        /// The first that is missing.
        first: Shard,
    },
    /// No shard was read, so that nothing says how many there are.
    #[error("no shard is given that can be read: give the files of `touchoff sweep --shard`")]
    Empty,
    /// The map cannot be written.
    #[error(transparent)]
    Map(#[from] MapError),
}

touchoff::debug_as_sentence!(ShardError);

/// Returns the rows of a shard as the bytes of a file in Apache Parquet. The rows may be in any order.
pub fn shard_bytes(
    mesh: &Mesh,
    identity: &MapIdentity,
    shard: Shard,
    rows: Vec<(TriangleId, MapRow)>,
) -> Vec<u8> {
    let rows = rows.into_iter().map(|(triangle, row)| {
        let pieces = [(Piece::whole(triangle), row)];
        let [(_, row)] = &pieces;
        let reached = row.access.iter().map(|access| area_reached(&pieces, access.tool)).collect();
        let [(_, row)] = pieces;
        TableRow { triangle, area: mesh.area(triangle), row, reached }
    });
    let mut rows: Vec<TableRow> = rows.collect();
    rows.sort_by_key(|row| row.triangle);
    encoded(identity, Some(shard), &rows)
}

/// Writes the bytes of a shard to a file, completely or not at all.
///
/// # Errors
/// [`ShardError::Unwritable`], in which case the file is as it was before.
pub fn write_shard(path: impl AsRef<Path>, bytes: &[u8]) -> Result<(), ShardError> {
    let path = path.as_ref();
    let unwritable = |source| ShardError::Unwritable { file: path.display().to_string(), source };
    let mut file = AtomicFile::create(path).map_err(unwritable)?;
    file.write_all(bytes).map_err(unwritable)?;
    file.commit().map_err(unwritable)
}

/// Reads a table from a file.
fn read_file(path: &Path) -> Result<table::Table, ShardError> {
    let file = path.display().to_string();
    let bytes = read_regular_file(path, FileKind::Geometry)
        .map_err(|source| ShardError::Unreadable { file: file.clone(), source })?;
    table::read(&file, bytes)
}

/// Returns whether a file has a shard of a sweep already, complete. A damaged one is none, and to be replaced.
///
/// # Errors
/// If there is a file of anything else: it is not to be replaced.
pub fn is_done(
    path: impl AsRef<Path>,
    identity: &MapIdentity,
    shard: Shard,
) -> Result<bool, ShardError> {
    let path = path.as_ref();
    if !path.is_file() {
        return Ok(false);
    }
    let found = match read_file(path) {
        Err(ShardError::Damaged { .. }) => return Ok(false),
        found => found?,
    };
    let file = path.display().to_string();
    let first = "this one".to_owned();
    if let Some(difference) = found.identity.difference(identity) {
        return Err(ShardError::Differs { file, first, difference });
    }
    match found.shard {
        None => Err(ShardError::Whole { file }),
        Some(found) if found == shard => Ok(true),
        Some(found) => Err(ShardError::OtherShard { file, found, wanted: shard }),
    }
}

/// The shards of a sweep, one file after the other.
#[derive(Debug, Default)]
pub struct Merge {
    /// The identity of the sweep, with the first file.
    study: Option<(MapIdentity, String)>,
    shards: ShardSet,
    rows: Vec<TableRow>,
}

/// All rows of a sweep, from its shards.
#[derive(Debug)]
pub struct Merged {
    identity: MapIdentity,
    rows: Vec<TableRow>,
}

impl Merge {
    /// Begins without a shard.
    pub fn new() -> Merge {
        Merge::default()
    }

    /// Adds the shard of a file.
    ///
    /// # Errors
    /// If the file cannot be read, is damaged or is no shard of the same sweep, or if its shard is there already. What was added
    /// before stays.
    pub fn add(&mut self, path: impl AsRef<Path>) -> Result<Shard, ShardError> {
        let path = path.as_ref();
        let file = path.display().to_string();
        let table::Table { identity, shard, rows } = read_file(path)?;
        let shard = shard.ok_or_else(|| ShardError::Whole { file: file.clone() })?;
        if let Some((known, first)) = &self.study
            && let Some(difference) = identity.difference(known)
        {
            return Err(ShardError::Differs { file, first: first.clone(), difference });
        }
        self.shards.add(shard, &file)?;
        self.study.get_or_insert((identity, file));
        self.rows.extend(rows);
        Ok(shard)
    }

    /// Returns whether no shard was added.
    pub fn is_empty(&self) -> bool {
        self.study.is_none()
    }

    /// Returns the shards that are missing; none without any shard, since nothing says how many there are.
    pub fn left(&self) -> impl Iterator<Item = Shard> + '_ {
        self.shards.left()
    }

    /// Joins all shards.
    ///
    /// # Errors
    /// [`ShardError::Incomplete`] if some are missing, [`ShardError::Empty`] if all are. [`ShardError::Damaged`] if they do not have
    /// each triangle once.
    pub fn finish(self) -> Result<Merged, ShardError> {
        let mut left = self.left();
        if let Some(first) = left.next() {
            let (left, count) = (1 + left.count(), first.count());
            return Err(ShardError::Incomplete { left, count, first });
        }
        drop(left);
        let Merge { study, mut rows, .. } = self;
        let (identity, first) = study.ok_or(ShardError::Empty)?;
        rows.sort_by_key(|row| row.triangle);
        let is_each_once = rows.len() == identity.part.triangles as usize
            && rows.is_sorted_by(|one, next| one.triangle < next.triangle);
        if !is_each_once {
            let what = "it and the other shards do not have each triangle once".to_owned();
            return Err(ShardError::Damaged { file: first, what });
        }
        Ok(Merged { identity, rows })
    }
}

impl Merged {
    /// Returns the part, the tools and the rules of the sweep.
    pub fn identity(&self) -> &MapIdentity {
        &self.identity
    }

    /// Writes a new posture map. Its bytes depend on the rows alone.
    ///
    /// # Errors
    /// If there is a file already, or the map cannot be written.
    pub fn write_map(&self, path: impl AsRef<Path>) -> Result<(), ShardError> {
        let rows = self.rows.iter().map(|TableRow { triangle, row, .. }| (*triangle, row));
        Ok(PostureMap::create_with(path.as_ref(), &self.identity, rows)?)
    }

    /// Writes all rows as one table in Apache Parquet.
    ///
    /// # Errors
    /// [`ShardError::Unwritable`].
    pub fn write_table(&self, path: impl AsRef<Path>) -> Result<(), ShardError> {
        write_shard(path, &encoded(&self.identity, None, &self.rows))
    }
}
