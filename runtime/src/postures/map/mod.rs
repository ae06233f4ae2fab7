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
mod snapshot;
#[cfg(test)]
mod tests;

pub use error::MapError;
pub use identity::{Difference, Identity, PartStamp, ToolStamp};

use super::{Access, Record, Row};
use crate::AtomicFile;
use coding::{decode, encode};
pub(super) use merge::merge;
use redb::{
    Builder, Database, Range, ReadOnlyTable, ReadableDatabase, ReadableTable, TableDefinition,
};
use snapshot::{Draft, Header, copy};
use std::collections::BTreeSet;
use std::fs::{self, File, TryLockError};
use std::io::{self, Write};
use std::path::Path;
use std::time::Duration;

const FACTS: TableDefinition<'_, &str, &[u8]> = TableDefinition::new("facts");
const ROWS: TableDefinition<'_, u32, &[u8]> = TableDefinition::new("rows");
/// Of the facts: the version, a little-endian `u32` in every version, and the identity.
const VERSION: &str = "version";
const IDENTITY: &str = "identity";
/// The version that is written, and the newest that is read.
const NEWEST: u32 = 1;
/// How often a map is copied that is written into meanwhile, and how long to wait after the first few.
const COPIES: u32 = 200;
const PAUSE: Duration = Duration::from_millis(5);
/// Bytes that the store may keep of a copy that is in memory already.
const CACHE: usize = 1 << 22;

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
    /// Opens a map to go on with it, or begins one if there is no such file. A file that was killed over is
    /// as it was after the last batch.
    ///
    /// All of the file is checked. One process has it open at a time.
    ///
    /// # Errors
    /// A file that belongs to another part, other tools or rules; is no map, damaged, or of a newer version;
    /// is open in another process; or cannot be read and written.
    pub fn open(path: impl AsRef<Path>, identity: &Identity) -> Result<PostureMap, MapError> {
        let path = path.as_ref();
        if let Some(what) = identity.oversized() {
            return Err(MapError::Oversized { file: path.display().to_string(), what });
        }
        if matches!(path.try_exists(), Ok(false)) {
            begin(path, identity)?;
        }
        let map = PostureMap::resume(path)?;
        match map.identity.differs(identity) {
            Some(difference) => Err(MapError::Differs { file: map.file, difference }),
            None => Ok(map),
        }
    }

    /// Opens a map for what it is, to go on with it.
    ///
    /// # Errors
    /// Those of [`PostureMap::open`] but of belonging; a file that is not there is one that cannot be read.
    pub fn resume(path: impl AsRef<Path>) -> Result<PostureMap, MapError> {
        let path = path.as_ref();
        let file = path.display().to_string();
        let (bytes, header) = start(path)?;
        let length = bytes.metadata().map_err(|source| unreadable(&file, source))?.len();
        drop(bytes);
        if header.is_closed() && length < header.length() {
            return Err(MapError::Truncated { file, length, whole: header.length() });
        }
        let store = Builder::new().set_check_integrity_on_open(true).open(path);
        let database = store.map_err(|error| match error {
            redb::DatabaseError::Storage(redb::StorageError::Io(source)) => {
                unreadable(&file, source)
            }
            error => truncated_or(MapError::of(&file, error), &header, length),
        })?;
        PostureMap::of(database, file)
    }

    /// Reads a map as it is at this moment, to look at or to export; it cannot be recorded into.
    ///
    /// The file is copied into memory and not changed, so it needs no permission to be written, and another process,
    /// such as a sweep, may have it open and go on meanwhile. All of it is checked.
    ///
    /// # Errors
    /// Those of [`PostureMap::open`] but of belonging and of writing; a file that is not there is one that cannot be
    /// read; one that is written into so fast that no copy has a whole.
    pub fn read(path: impl AsRef<Path>) -> Result<PostureMap, MapError> {
        let path = path.as_ref();
        let file = path.display().to_string();
        let (mut bytes, _) = start(path)?;
        for attempt in 0..COPIES {
            if attempt > 2 {
                std::thread::sleep(PAUSE);
            }
            let copied = copy(&mut bytes).map_err(|source| unreadable(&file, source))?;
            let Some((header, memory)) = copied else { continue };
            let length =
                redb::StorageBackend::len(&memory).map_err(|source| unreadable(&file, source))?;
            if header.is_closed() && length < header.length() {
                return Err(MapError::Truncated { file, length, whole: header.length() });
            }
            let mut builder = Builder::new();
            builder.set_check_integrity_on_open(true).set_cache_size(CACHE);
            let read = builder
                .create_with_backend(memory)
                .map_err(|error| truncated_or(MapError::of(&file, error), &header, length))
                .and_then(|database| PostureMap::of(database, file.clone()));
            match read {
                Ok(map) => return Ok(PostureMap { is_copy: true, ..map }),
                // A commit comes to the disk page by page: a whole one may be there the next time.
                Err(MapError::Damaged { .. } | MapError::Truncated { .. })
                    if is_written(&bytes) => {}
                Err(error) => return Err(error),
            }
        }
        Err(MapError::Busy { file })
    }

    /// The map in a store.
    fn of(database: Database, file: String) -> Result<PostureMap, MapError> {
        let identity = read_facts(&database, &file)?;
        Ok(PostureMap { database, identity, file, is_copy: false })
    }

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
        MapError::of(&self.file, error)
    }
}

/// Writes what a map says of itself into a store that has nothing in it.
fn write_facts(database: &Database, identity: &Identity) -> Result<(), redb::Error> {
    let write = database.begin_write()?;
    let mut facts = write.open_table(FACTS)?;
    facts.insert(VERSION, NEWEST.to_le_bytes().as_slice())?;
    facts.insert(IDENTITY, encode(identity).as_slice())?;
    drop(facts);
    write.open_table(ROWS)?;
    Ok(write.commit()?)
}

/// What a map says of itself.
fn read_facts(database: &Database, file: &str) -> Result<Identity, MapError> {
    let says = |error: redb::Error| MapError::of(file, error);
    let read = database.begin_read().map_err(|error| says(error.into()))?;
    let facts = read.open_table(FACTS).map_err(|error| says(error.into()))?;
    let fact = |name| {
        let bytes = facts.get(name).map_err(|error| says(error.into()))?;
        let bytes = bytes.map(|bytes| bytes.value().to_vec());
        bytes.ok_or_else(|| MapError::Foreign { file: file.to_owned() })
    };
    let version = fact(VERSION)?;
    let version = version.try_into().map(u32::from_le_bytes);
    let version = version.map_err(|_| MapError::Foreign { file: file.to_owned() })?;
    if version > NEWEST {
        return Err(MapError::Newer { file: file.to_owned(), version, reads: NEWEST });
    }
    let identity: Identity = decode(&fact(IDENTITY)?).ok_or_else(|| MapError::Damaged {
        file: file.to_owned(),
        what: "what it says of itself is not what was written".to_owned(),
    })?;
    match identity.oversized() {
        Some(what) => Err(MapError::Oversized { file: file.to_owned(), what }),
        None => Ok(identity),
    }
}

/// Begins a map beside its place, and gives it its name when it is whole: nobody finds half of one.
fn begin(path: &Path, identity: &Identity) -> Result<(), MapError> {
    let file = path.display().to_string();
    let unwritable = |source| MapError::written(file.clone(), source);
    let draft = Draft::default();
    let database = Builder::new().create_with_backend(draft.clone());
    let database = database.map_err(|error| MapError::of(&file, error))?;
    write_facts(&database, identity).map_err(|error| MapError::of(&file, error))?;
    database.close().map_err(|error| MapError::of(&file, error))?;
    let bytes = draft.bytes().map_err(unwritable)?;
    let mut new = AtomicFile::create(path).map_err(unwritable)?;
    new.write_all(&bytes).map_err(unwritable)?;
    match new.commit_new() {
        // Another was faster: it is that one which is opened.
        Err(error) if error.kind() == io::ErrorKind::AlreadyExists => Ok(()),
        done => done.map_err(unwritable),
    }
}

/// A store's file, open to be read, and its header.
fn start(path: &Path) -> Result<(File, Header), MapError> {
    let file = path.display().to_string();
    let open = || {
        // Asked first: a pipe would be waited for.
        if !fs::metadata(path)?.is_file() {
            return Err(io::Error::new(io::ErrorKind::InvalidInput, "it is no regular file"));
        }
        let mut bytes = File::open(path)?;
        let header = Header::read(&mut bytes)?;
        Ok((bytes, header))
    };
    match open() {
        Ok((bytes, header)) if header.is_store() => Ok((bytes, header)),
        Ok(_) => Err(MapError::Foreign { file }),
        Err(source) => Err(MapError::Unreadable { file, source }),
    }
}

/// An error, or rather that the file is too short, where that is the cause.
fn truncated_or(error: MapError, header: &Header, length: u64) -> MapError {
    match error {
        MapError::Damaged { file, .. } if length < header.length() => {
            MapError::Truncated { file, length, whole: header.length() }
        }
        error => error,
    }
}

/// Whether another handle has a file open to write into it.
fn is_written(file: &File) -> bool {
    let locked = matches!(file.try_lock_shared(), Err(TryLockError::WouldBlock));
    // A failure means that there was nothing to unlock.
    let _ = file.unlock();
    locked
}

fn unreadable(file: &str, source: io::Error) -> MapError {
    MapError::Unreadable { file: file.to_owned(), source }
}
