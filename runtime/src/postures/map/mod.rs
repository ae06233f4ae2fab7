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
#[cfg(test)]
mod tests;

pub use error::MapError;
pub use identity::{Difference, Identity, PartStamp, ToolStamp};

use super::{Access, Record, Row};
use coding::{decode, encode};
pub(super) use merge::merge;
use redb::{
    Builder, Database, Range, ReadOnlyTable, ReadableDatabase, ReadableTable, TableDefinition,
};
use std::fs::{self, File};
use std::io::{self, Read};
use std::path::Path;

const FACTS: TableDefinition<'_, &str, &[u8]> = TableDefinition::new("facts");
const ROWS: TableDefinition<'_, u32, &[u8]> = TableDefinition::new("rows");
/// Of the facts: the version, a little-endian `u32` in every version, and the identity.
const VERSION: &str = "version";
const IDENTITY: &str = "identity";
/// The version that is written, and the newest that is read.
const NEWEST: u32 = 1;
/// What every `redb` store begins with.
const MAGIC: &[u8] = b"redb\x1A\x0A\xA9\x0D\x0A";

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
}

impl Iterator for Rows<'_> {
    type Item = Result<(u32, Row), MapError>;

    fn next(&mut self) -> Option<Self::Item> {
        let entry = self.range.next()?;
        Some(entry.map_err(|error| self.map.says(error)).and_then(|(triangle, bytes)| {
            let triangle = triangle.value();
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
        if matches!(path.try_exists(), Ok(false)) {
            begin(path, identity)?;
        }
        let map = PostureMap::read(path)?;
        match map.identity.differs(identity) {
            Some(difference) => Err(MapError::Differs { file: map.file, difference }),
            None => Ok(map),
        }
    }

    /// Opens a map for what it is, to look at or to export.
    ///
    /// # Errors
    /// Those of [`PostureMap::open`] but of belonging; a file that is not there is one that cannot be read.
    pub fn read(path: impl AsRef<Path>) -> Result<PostureMap, MapError> {
        let path = path.as_ref();
        let file = path.display().to_string();
        match starts_as_store(path) {
            Ok(true) => (),
            Ok(false) => return Err(MapError::Foreign { file }),
            Err(source) => return Err(MapError::Unreadable { file, source }),
        }
        let store = Builder::new().set_check_integrity_on_open(true).open(path);
        match store {
            Ok(database) => PostureMap::of(database, file),
            Err(redb::DatabaseError::Storage(redb::StorageError::Io(source))) => {
                Err(MapError::Unreadable { file, source })
            }
            Err(error) => Err(MapError::of(&file, error)),
        }
    }

    /// The map in a store.
    fn of(database: Database, file: String) -> Result<PostureMap, MapError> {
        let identity = read_facts(&database, &file)?;
        Ok(PostureMap { database, identity, file })
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
        Ok(Rows { range, map: self })
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

    /// Of each triangle, whether a sweep came to it.
    ///
    /// # Errors
    /// If the file cannot be read, or a row is damaged.
    pub fn swept(&self) -> Result<Vec<bool>, MapError> {
        let mut swept = vec![false; self.identity.part.triangles as usize];
        for entry in self.rows()? {
            let (triangle, row) = entry?;
            swept[triangle as usize] = !row.access.is_empty();
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
        let fits = |row: &Row| self.identity.refuses(triangle, &row.best, &row.access).is_none();
        decode(bytes).filter(fits).ok_or_else(|| MapError::Damaged {
            file: self.file.clone(),
            what: format!("the row of triangle {triangle} is not what was written"),
        })
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
    decode(&fact(IDENTITY)?).ok_or_else(|| MapError::Damaged {
        file: file.to_owned(),
        what: "what it says of itself is not what was written".to_owned(),
    })
}

/// Begins a map beside its place, and gives it its name when it is whole: nobody finds half of one.
fn begin(path: &Path, identity: &Identity) -> Result<(), MapError> {
    let file = path.display().to_string();
    let unwritable = |source| MapError::written(file.clone(), source);
    let folder = match path.parent() {
        Some(folder) if folder != Path::new("") => folder,
        _ => Path::new("."),
    };
    let mut builder = tempfile::Builder::new();
    #[cfg(unix)]
    {
        // As of any new file: the system takes away what the user wants no one to do.
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(fs::Permissions::from_mode(0o666));
    }
    let new = builder.prefix(".touchoff-").tempfile_in(folder).map_err(unwritable)?;
    let database = Database::create(new.path()).map_err(|error| MapError::of(&file, error))?;
    write_facts(&database, identity).map_err(|error| MapError::of(&file, error))?;
    drop(database);
    new.as_file().sync_all().map_err(unwritable)?;
    match new.persist_noclobber(path) {
        // The name too; where folders cannot be synchronised, the system does it in its own time.
        Ok(_) => {
            #[cfg(unix)]
            let _ = File::open(folder).and_then(|folder| folder.sync_all());
            Ok(())
        }
        // Another was faster: it is that one which is opened.
        Err(error) if error.error.kind() == io::ErrorKind::AlreadyExists => Ok(()),
        Err(error) => Err(unwritable(error.error)),
    }
}

/// Whether a file begins as a store does.
fn starts_as_store(path: &Path) -> io::Result<bool> {
    // Asked first: a pipe would be waited for.
    if !fs::metadata(path)?.is_file() {
        return Err(io::Error::new(io::ErrorKind::InvalidInput, "it is no regular file"));
    }
    let mut start = Vec::new();
    File::open(path)?.take(MAGIC.len() as u64).read_to_end(&mut start)?;
    Ok(start == MAGIC)
}
