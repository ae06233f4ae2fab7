//! Opening of maps, for reading and for recording.

use super::codec::{decode, encode};
use super::snapshot::{Header, MemoryStore, copy};
use super::{
    FACTS, FORMAT_VERSION, IDENTITY, MapError, MapIdentity, PostureMap, ROWS, VERSION, as_damage,
};
use redb::{Builder, Database, ReadableDatabase, StorageBackend as _};
use std::fs::{self, File, TryLockError};
use std::io::{self, Write};
use std::path::Path;
use std::time::Duration;
use touchoff::AtomicFile;

/// Number of attempts to copy a map that another process writes to.
const MAX_COPY_ATTEMPTS: u32 = 200;
/// Time between attempts, after the first few.
const RETRY_INTERVAL: Duration = Duration::from_millis(5);
/// Bytes that the store may cache of a copy. The copy is in memory already, and its reads are counted.
const CACHE_BYTES: usize = 0;

impl PostureMap {
    /// Opens a map to continue it, or creates one if there is no such file. A file whose writer was killed is
    /// as it was after the last batch.
    ///
    /// The whole file is checked. One process can have it open at a time.
    ///
    /// # Errors
    /// If the file belongs to another part, other tools or other rules; if it is no map, damaged, or of a newer
    /// version; if it is open in another process; or if it cannot be read and written.
    pub fn open(path: impl AsRef<Path>, identity: &MapIdentity) -> Result<PostureMap, MapError> {
        let path = path.as_ref();
        if let Some(what) = identity.oversized() {
            return Err(MapError::Oversized { file: path.display().to_string(), what });
        }
        if matches!(path.try_exists(), Ok(false)) {
            create(path, identity)?;
        }
        // Read a copy first, so that a file that is refused is not changed.
        match read_identity(path)?.difference(identity) {
            Some(difference) => {
                Err(MapError::Differs { file: path.display().to_string(), difference })
            }
            None => open_writable(path),
        }
    }

    /// Opens an existing map to continue it, with the identity that it has.
    ///
    /// # Errors
    /// Those of [`PostureMap::open`] except for the identity. A missing file is one that cannot be read.
    pub fn resume(path: impl AsRef<Path>) -> Result<PostureMap, MapError> {
        let path = path.as_ref();
        read_identity(path)?;
        open_writable(path)
    }

    /// Reads a map as it is at this moment, for inspection or export. It cannot be recorded into.
    ///
    /// The file is copied into memory and not changed. It needs no permission to write, and another process,
    /// such as a sweep, may have it open and go on meanwhile. The whole copy is checked.
    ///
    /// # Errors
    /// Those of [`PostureMap::open`] except for the identity and for writing. A missing file is one that cannot
    /// be read. [`MapError::Busy`] if the file is written to so fast that no copy is whole.
    pub fn read(path: impl AsRef<Path>) -> Result<PostureMap, MapError> {
        let path = path.as_ref();
        let file = path.display().to_string();
        let (mut bytes, _) = open_store(path)?;
        for attempt in 0..MAX_COPY_ATTEMPTS {
            if attempt > 2 {
                std::thread::sleep(RETRY_INTERVAL);
            }
            let copied = copy(&mut bytes).map_err(|source| unreadable(&file, source))?;
            let Some((header, memory)) = copied else { continue };
            let length = memory.len().map_err(|source| unreadable(&file, source))?;
            if header.is_closed() && length < header.length() {
                return Err(MapError::Truncated { file, length, expected: header.length() });
            }
            let mut builder = Builder::new();
            builder.set_check_integrity_on_open(true).set_cache_size(CACHE_BYTES);
            let read = builder
                .create_with_backend(memory.clone())
                .map_err(|error| MapError::from_database(&file, error))
                .and_then(|database| PostureMap::from_database(database, file.clone()))
                .map_err(|error| truncated_or(as_damage(error), &header, length));
            match read {
                Ok(map) => {
                    memory.end_check();
                    return Ok(PostureMap { is_copy: true, ..map });
                }
                // A commit reaches the disk page by page; the next copy may have all of it.
                Err(MapError::Damaged { .. } | MapError::Truncated { .. })
                    if is_written(&bytes) => {}
                Err(error) => return Err(error),
            }
        }
        Err(MapError::Busy { file })
    }

    /// Returns the map in a store.
    pub(super) fn from_database(database: Database, file: String) -> Result<PostureMap, MapError> {
        let identity = read_facts(&database, &file)?;
        Ok(PostureMap { database, identity, file, is_copy: false })
    }
}

/// Reads the identity of a map that is to be opened for recording.
fn read_identity(path: &Path) -> Result<MapIdentity, MapError> {
    match PostureMap::read(path) {
        Ok(map) => Ok(map.identity),
        // A file that is being written is in use.
        Err(MapError::Busy { file }) => Err(MapError::Locked { file }),
        Err(error) => Err(error),
    }
}

/// Opens a map's file for recording. A copy of it was checked before.
fn open_writable(path: &Path) -> Result<PostureMap, MapError> {
    let file = path.display().to_string();
    let store = Builder::new().set_check_integrity_on_open(true).open(path);
    let database = store.map_err(|error| match error {
        redb::DatabaseError::Storage(redb::StorageError::Io(source)) => unreadable(&file, source),
        error => MapError::from_database(&file, error),
    })?;
    PostureMap::from_database(database, file)
}

/// Writes the facts of a map into an empty store, and creates the table of rows.
pub(super) fn write_facts(database: &Database, identity: &MapIdentity) -> Result<(), redb::Error> {
    let write = database.begin_write()?;
    let mut facts = write.open_table(FACTS)?;
    facts.insert(VERSION, FORMAT_VERSION.to_le_bytes().as_slice())?;
    facts.insert(IDENTITY, encode(identity).as_slice())?;
    drop(facts);
    write.open_table(ROWS)?;
    Ok(write.commit()?)
}

/// Reads the facts of a map, and returns its identity.
fn read_facts(database: &Database, file: &str) -> Result<MapIdentity, MapError> {
    let store_error = |error: redb::Error| MapError::from_database(file, error);
    let read = database.begin_read().map_err(|error| store_error(error.into()))?;
    let facts = read.open_table(FACTS).map_err(|error| store_error(error.into()))?;
    let fact = |name| {
        let bytes = facts.get(name).map_err(|error| store_error(error.into()))?;
        let bytes = bytes.map(|bytes| bytes.value().to_vec());
        bytes.ok_or_else(|| MapError::Foreign { file: file.to_owned() })
    };
    let version = fact(VERSION)?;
    let version = version.try_into().map(u32::from_le_bytes);
    let version = version.map_err(|_| MapError::Foreign { file: file.to_owned() })?;
    if version > FORMAT_VERSION {
        return Err(MapError::Newer { file: file.to_owned(), version, reads: FORMAT_VERSION });
    }
    let identity: MapIdentity = decode(&fact(IDENTITY)?).ok_or_else(|| MapError::Damaged {
        file: file.to_owned(),
        what: "what it says of itself is not what was written".to_owned(),
    })?;
    match identity.oversized() {
        Some(what) => Err(MapError::Oversized { file: file.to_owned(), what }),
        None => Ok(identity),
    }
}

/// Writes a new map beside its target and renames it when it is complete, so that no partial map is ever found.
fn create(path: &Path, identity: &MapIdentity) -> Result<(), MapError> {
    let file = path.display().to_string();
    let unwritable = |source| MapError::written(file.clone(), source);
    let draft = MemoryStore::default();
    let database = Builder::new().create_with_backend(draft.clone());
    let database = database.map_err(|error| MapError::from_database(&file, error))?;
    write_facts(&database, identity).map_err(|error| MapError::from_database(&file, error))?;
    database.close().map_err(|error| MapError::from_database(&file, error))?;
    let bytes = draft.bytes().map_err(unwritable)?;
    let mut new = AtomicFile::create(path).map_err(unwritable)?;
    new.write_all(&bytes).map_err(unwritable)?;
    match new.commit_new() {
        // Another process was faster: its file is the one to open.
        Err(error) if error.kind() == io::ErrorKind::AlreadyExists => Ok(()),
        done => done.map_err(unwritable),
    }
}

/// Opens a store's file for reading, and reads its header.
fn open_store(path: &Path) -> Result<(File, Header), MapError> {
    let file = path.display().to_string();
    let open = || {
        // Check before opening: opening a pipe would block.
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

/// Returns an error, or [`MapError::Truncated`] instead of damage if the file is too short.
fn truncated_or(error: MapError, header: &Header, length: u64) -> MapError {
    match error {
        MapError::Damaged { file, .. } if length < header.length() => {
            MapError::Truncated { file, length, expected: header.length() }
        }
        error => error,
    }
}

/// Returns whether another handle has a file open for writing.
fn is_written(file: &File) -> bool {
    let locked = matches!(file.try_lock_shared(), Err(TryLockError::WouldBlock));
    // A failure means that there was nothing to unlock.
    let _ = file.unlock();
    locked
}

fn unreadable(file: &str, source: io::Error) -> MapError {
    MapError::Unreadable { file: file.to_owned(), source }
}
