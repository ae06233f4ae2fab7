//! Opening of maps, for recording, and for reading a copy of the file at one moment.

use super::{
    FACTS, FORMAT_VERSION, IDENTITY, MapError, MapIdentity, PostureMap, ROWS, VERSION, as_damage,
    decode, encode,
};
use crate::MapRow;
use redb::backends::InMemoryBackend;
use redb::{Builder, Database, ReadableDatabase, StorageBackend};
use std::fs::{File, TryLockError};
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicI64, Ordering};
use std::time::Duration;
use touchoff::{AtomicFile, FileKind, TriangleId, open_regular_file};

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
        let mut bytes = open_store(path)?;
        for attempt in 0..MAX_COPY_ATTEMPTS {
            // A commit is short, so the first copies follow at once.
            if attempt > 2 {
                std::thread::sleep(RETRY_INTERVAL);
            }
            // A closed file has the length that its header implies; a crafted one may be sparse, and its copy is not.
            let header = Header::read(&mut bytes).map_err(|source| unreadable(&file, source))?;
            let length = bytes.metadata().map_err(|source| unreadable(&file, source))?.len();
            if header.is_closed() && length > header.length() {
                let what = format!("it has {length} bytes, not {}", header.length());
                return Err(MapError::Damaged { file, what });
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

    /// Writes a new map with rows, which are by triangle: beside its target, and renamed when it is complete, so that no partial map is
    /// ever found. Its bytes depend on the identity and the rows alone.
    ///
    /// # Errors
    /// [`MapError::Exists`] if there is a file already, or if the map cannot be written.
    pub(crate) fn create_with<'r>(
        path: &Path,
        identity: &MapIdentity,
        rows: impl Iterator<Item = (TriangleId, &'r MapRow)>,
    ) -> Result<(), MapError> {
        let file = path.display().to_string();
        let unwritable = |source| MapError::written(file.clone(), source);
        let draft = MemoryStore::default();
        let database = Builder::new().create_with_backend(draft.clone());
        let database = database.map_err(|error| MapError::from_database(&file, error))?;
        write_facts(&database, identity)
            .and_then(|()| write_rows(&database, rows))
            .map_err(|error| MapError::from_database(&file, error))?;
        database.close().map_err(|error| MapError::from_database(&file, error))?;
        let bytes = draft.bytes().map_err(unwritable)?;
        let mut new = AtomicFile::create(path).map_err(unwritable)?;
        new.write_all(&bytes).map_err(unwritable)?;
        new.commit_new().map_err(|error| match error.kind() {
            io::ErrorKind::AlreadyExists => MapError::Exists { file: file.clone() },
            _ => unwritable(error),
        })
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

/// Writes rows into a new store, in one transaction.
fn write_rows<'r>(
    database: &Database,
    rows: impl Iterator<Item = (TriangleId, &'r MapRow)>,
) -> Result<(), redb::Error> {
    let mut rows = rows.peekable();
    if rows.peek().is_none() {
        return Ok(());
    }
    let write = database.begin_write()?;
    let mut table = write.open_table(ROWS)?;
    for (triangle, row) in rows {
        table.insert(triangle.0, encode(row).as_slice())?;
    }
    drop(table);
    Ok(write.commit()?)
}

/// Reads the facts of a map, and returns its identity.
fn read_facts(database: &Database, file: &str) -> Result<MapIdentity, MapError> {
    let foreign = || MapError::Foreign { file: file.to_owned() };
    let version = read_fact(database, file, VERSION)?;
    let version = version.and_then(|bytes| bytes.try_into().ok()).ok_or_else(foreign)?;
    let version = u32::from_le_bytes(version);
    // Before the identity is read, as a newer version may encode it in another way.
    if version > FORMAT_VERSION {
        return Err(MapError::Newer { file: file.to_owned(), version, reads: FORMAT_VERSION });
    }
    let identity = read_fact(database, file, IDENTITY)?.ok_or_else(foreign)?;
    let identity: MapIdentity = decode(&identity).ok_or_else(|| MapError::Damaged {
        file: file.to_owned(),
        what: "what it says of itself is not what was written".to_owned(),
    })?;
    match identity.oversized() {
        Some(what) => Err(MapError::Oversized { file: file.to_owned(), what }),
        None => Ok(identity),
    }
}

/// Returns the bytes of a fact, if there is such a fact.
fn read_fact(database: &Database, file: &str, name: &str) -> Result<Option<Vec<u8>>, MapError> {
    let read = || -> Result<Option<Vec<u8>>, redb::Error> {
        let facts = database.begin_read()?.open_table(FACTS)?;
        Ok(facts.get(name)?.map(|bytes| bytes.value().to_vec()))
    };
    read().map_err(|error| MapError::from_database(file, error))
}

/// Writes a new map, unless another process was faster: its file is the one to open.
fn create(path: &Path, identity: &MapIdentity) -> Result<(), MapError> {
    match PostureMap::create_with(path, identity, std::iter::empty()) {
        Err(MapError::Exists { .. }) => Ok(()),
        done => done,
    }
}

/// Opens a store's file for reading.
fn open_store(path: &Path) -> Result<File, MapError> {
    let file = path.display().to_string();
    let opened = open_regular_file(path, FileKind::PostureMap);
    match opened.and_then(|(mut bytes, _)| Ok((Header::read(&mut bytes)?, bytes))) {
        Ok((header, bytes)) if header.is_store() => Ok(bytes),
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

/// The first bytes of every `redb` store.
const MAGIC: &[u8] = b"redb\x1A\x0A\xA9\x0D\x0A";

/// Size of a store's header in bytes: its layout and two commit slots, of which each commit rewrites one.
const HEADER: usize = 320;

/// A store's header (redb's `docs/design.md`, "Database header").
#[derive(Clone, Debug, PartialEq, Eq)]
struct Header(Vec<u8>);

impl Header {
    /// Reads the header of a file, or as much of it as there is.
    fn read(file: &mut File) -> io::Result<Header> {
        file.seek(SeekFrom::Start(0))?;
        let mut bytes = Vec::with_capacity(HEADER);
        file.take(HEADER as u64).read_to_end(&mut bytes)?;
        Ok(Header(bytes))
    }

    /// Returns whether this is the header of a store.
    fn is_store(&self) -> bool {
        self.0.starts_with(MAGIC)
    }

    /// Returns whether the last writer closed the file, so that the whole header is valid. A killed writer may
    /// leave counts of regions that are not those of the file; they are counted again when it is opened.
    fn is_closed(&self) -> bool {
        const UNCLOSED: u8 = 2;
        self.0.get(MAGIC.len()).is_some_and(|flags| flags & UNCLOSED == 0)
    }

    /// Returns the least size of the file in bytes that its header implies.
    fn length(&self) -> u64 {
        // In 128 bits, as the fields of a crafted header overflow 64.
        let [page, head, max_region, full_regions, trailing_region] =
            [12, 16, 20, 24, 28].map(|offset| {
                let bytes = self.0.get(offset..offset + 4).and_then(|bytes| bytes.try_into().ok());
                u128::from(bytes.map_or(0, u32::from_le_bytes))
            });
        let trailing_region = if trailing_region > 0 { head + trailing_region } else { 0 };
        // The header takes one page.
        let length = page * (1 + full_regions * (head + max_region) + trailing_region);
        u64::try_from(length).unwrap_or(u64::MAX).max(HEADER as u64)
    }
}

/// Copies a file that another process may be writing to. Returns `None` if that process committed meanwhile.
///
/// Pages of the last commit are not written before the next one, and every commit changes the header. A copy
/// with the same header before and after therefore has all pages of that commit.
fn copy(file: &mut File) -> io::Result<Option<(Header, Snapshot)>> {
    /// Bytes that are copied at once.
    const CHUNK: usize = 1 << 20;
    let before = Header::read(file)?;
    let length = file.metadata()?.len();
    let memory = InMemoryBackend::new();
    memory.set_len(length)?;
    let mut chunk = vec![0; CHUNK.min(usize::try_from(length).unwrap_or(CHUNK))];
    file.seek(SeekFrom::Start(0))?;
    let mut offset = 0;
    while offset < length {
        let size = chunk.len().min(usize::try_from(length - offset).unwrap_or(CHUNK));
        match file.read_exact(&mut chunk[..size]) {
            Ok(()) => memory.write(offset, &chunk[..size])?,
            // The file was shortened meanwhile.
            Err(error) if error.kind() == io::ErrorKind::UnexpectedEof => return Ok(None),
            Err(error) => return Err(error),
        }
        offset += size as u64;
    }
    let same = Header::read(file)? == before && file.metadata()?.len() == length;
    Ok(same.then(|| (before, Snapshot::new(memory, length))))
}

/// A copy of a file, with a limit on what the check may read: no more than a tree of its pages takes.
///
/// A crafted file can name a page as the child of another many times over, so that a traversal of a few pages
/// takes forever.
#[derive(Clone, Debug)]
struct Snapshot {
    memory: Arc<InMemoryBackend>,
    /// Bytes that may still be read.
    remaining: Arc<AtomicI64>,
}

impl Snapshot {
    fn new(memory: InMemoryBackend, length: u64) -> Snapshot {
        /// Number of times that each byte may be read; a check reads each page fewer than ten times.
        const MAX_READS_PER_BYTE: u64 = 64;
        /// Bytes that may be read in addition.
        const EXTRA_BYTES: i64 = 1 << 24;
        let remaining =
            i64::try_from(length.saturating_mul(MAX_READS_PER_BYTE)).unwrap_or(i64::MAX);
        let remaining = Arc::new(AtomicI64::new(remaining.saturating_add(EXTRA_BYTES)));
        Snapshot { memory: Arc::new(memory), remaining }
    }

    /// Ends the check, and with it the limit on reading.
    fn end_check(&self) {
        self.remaining.store(i64::MAX, Ordering::Relaxed);
    }
}

impl StorageBackend for Snapshot {
    fn len(&self) -> io::Result<u64> {
        self.memory.len()
    }

    fn read(&self, offset: u64, out: &mut [u8]) -> io::Result<()> {
        let size = i64::try_from(out.len()).unwrap_or(i64::MAX);
        if self.remaining.fetch_sub(size, Ordering::Relaxed) < size {
            // Make all later reads fail too.
            self.remaining.store(0, Ordering::Relaxed);
            return Err(io::Error::new(io::ErrorKind::InvalidData, "its pages form no tree"));
        }
        self.memory.read(offset, out)
    }

    fn set_len(&self, len: u64) -> io::Result<()> {
        self.memory.set_len(len)
    }

    fn sync_data(&self) -> io::Result<()> {
        self.memory.sync_data()
    }

    fn write(&self, offset: u64, data: &[u8]) -> io::Result<()> {
        self.memory.write(offset, data)
    }
}

/// Memory in which a store is created, before its bytes are written to a file.
#[derive(Clone, Debug, Default)]
struct MemoryStore(Arc<InMemoryBackend>);

impl MemoryStore {
    /// Returns all bytes. The store has to be closed.
    fn bytes(&self) -> io::Result<Vec<u8>> {
        let length = usize::try_from(self.0.len()?).map_err(io::Error::other)?;
        let mut bytes = vec![0; length];
        self.0.read(0, &mut bytes)?;
        Ok(bytes)
    }
}

impl StorageBackend for MemoryStore {
    fn len(&self) -> io::Result<u64> {
        self.0.len()
    }

    fn read(&self, offset: u64, out: &mut [u8]) -> io::Result<()> {
        self.0.read(offset, out)
    }

    fn set_len(&self, len: u64) -> io::Result<()> {
        self.0.set_len(len)
    }

    fn sync_data(&self) -> io::Result<()> {
        self.0.sync_data()
    }

    fn write(&self, offset: u64, data: &[u8]) -> io::Result<()> {
        self.0.write(offset, data)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_walk_that_does_not_end_is_ended() {
        let memory = InMemoryBackend::new();
        memory.set_len(4096).expect("memory");
        let snapshot = Snapshot::new(memory, 4096);
        let mut page = [0; 4096];
        let reads = (0..100_000).take_while(|_| snapshot.read(0, &mut page).is_ok()).count();
        assert_eq!(reads, 64 + (1 << 24) / 4096);
        assert!(snapshot.read(0, &mut page[..1]).is_err());
        snapshot.end_check();
        assert!((0..10_000).all(|_| snapshot.read(0, &mut page).is_ok()));
    }
}
