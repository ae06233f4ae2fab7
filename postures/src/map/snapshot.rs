//! A map's file in memory: a copy of one moment, for reading, and a new map before its first write.

use redb::StorageBackend;
use redb::backends::InMemoryBackend;
use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom};
use std::sync::Arc;
use std::sync::atomic::{AtomicI64, Ordering};

/// The first bytes of every `redb` store.
pub(super) const MAGIC: &[u8] = b"redb\x1A\x0A\xA9\x0D\x0A";

/// Size of a store's header in bytes: its layout and two commit slots, of which each commit rewrites one.
const HEADER: usize = 320;

/// A store's header (redb's `docs/design.md`, "Database header").
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Header(Vec<u8>);

impl Header {
    /// Reads the header of a file, or as much of it as there is.
    pub(super) fn read(file: &mut File) -> io::Result<Header> {
        file.seek(SeekFrom::Start(0))?;
        let mut bytes = Vec::with_capacity(HEADER);
        file.take(HEADER as u64).read_to_end(&mut bytes)?;
        Ok(Header(bytes))
    }

    /// Returns whether this is the header of a store.
    pub(super) fn is_store(&self) -> bool {
        self.0.starts_with(MAGIC)
    }

    /// Returns whether the last writer closed the file, so that the whole header is valid. A killed writer may
    /// leave counts of regions that are not those of the file; they are counted again when it is opened.
    pub(super) fn is_closed(&self) -> bool {
        const UNCLOSED: u8 = 2;
        self.0.get(MAGIC.len()).is_some_and(|flags| flags & UNCLOSED == 0)
    }

    /// Returns the least size of the file in bytes that its header implies.
    pub(super) fn length(&self) -> u64 {
        let field = |offset: usize| {
            let bytes = self.0.get(offset..offset + 4).and_then(|bytes| bytes.try_into().ok());
            u128::from(bytes.map_or(0, u32::from_le_bytes))
        };
        let [page, head, max_region, full_regions, trailing_region] =
            [12, 16, 20, 24, 28].map(field);
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
pub(super) fn copy(file: &mut File) -> io::Result<Option<(Header, Snapshot)>> {
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
pub(super) struct Snapshot {
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
    pub(super) fn end_check(&self) {
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
pub(super) struct MemoryStore(Arc<InMemoryBackend>);

impl MemoryStore {
    /// Returns all bytes. The store has to be closed.
    pub(super) fn bytes(&self) -> io::Result<Vec<u8>> {
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
