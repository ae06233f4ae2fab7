//! A map's file in memory: as it was at one moment, to be read, and before it is written for the first time.

use redb::StorageBackend;
use redb::backends::InMemoryBackend;
use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom};
use std::sync::Arc;

/// What every `redb` store begins with.
pub(super) const MAGIC: &[u8] = b"redb\x1A\x0A\xA9\x0D\x0A";

/// Bytes of a store's header: its layout and two commit slots, of which each commit rewrites one.
const HEADER: usize = 320;

/// A store's header (redb's `docs/design.md`, "Database header").
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Header(Vec<u8>);

impl Header {
    /// That of a file, or as much of it as there is.
    pub(super) fn read(file: &mut File) -> io::Result<Header> {
        file.seek(SeekFrom::Start(0))?;
        let mut bytes = Vec::with_capacity(HEADER);
        file.take(HEADER as u64).read_to_end(&mut bytes)?;
        Ok(Header(bytes))
    }

    /// Whether it is that of a store.
    pub(super) fn is_store(&self) -> bool {
        self.0.starts_with(MAGIC)
    }

    /// Whether the last writer closed the file, so that all of the header holds. A killed writer may leave counts of
    /// regions that are not those of the file; they are counted again when it is opened.
    pub(super) fn is_closed(&self) -> bool {
        const UNCLOSED: u8 = 2;
        self.0.get(MAGIC.len()).is_some_and(|flags| flags & UNCLOSED == 0)
    }

    /// Bytes that the file has at least, by its own account.
    pub(super) fn length(&self) -> u64 {
        let field = |at: usize| {
            let bytes = self.0.get(at..at + 4).and_then(|bytes| bytes.try_into().ok());
            u128::from(bytes.map_or(0, u32::from_le_bytes))
        };
        let [page, head, most, full, last] = [12, 16, 20, 24, 28].map(field);
        let last = if last > 0 { head + last } else { 0 };
        // The header takes a page.
        let length = page * (1 + full * (head + most) + last);
        u64::try_from(length).unwrap_or(u64::MAX).max(HEADER as u64)
    }
}

/// Copies a file that another process may be writing into; `None` if that committed meanwhile.
///
/// Pages of the last commit are not written before the next one, and every commit changes the header: a copy with the
/// same header before and after has all pages of that commit.
pub(super) fn copy(file: &mut File) -> io::Result<Option<(Header, InMemoryBackend)>> {
    /// Bytes that are copied at once.
    const CHUNK: usize = 1 << 20;
    let before = Header::read(file)?;
    let length = file.metadata()?.len();
    let memory = InMemoryBackend::new();
    memory.set_len(length)?;
    let mut chunk = vec![0; CHUNK.min(usize::try_from(length).unwrap_or(CHUNK))];
    file.seek(SeekFrom::Start(0))?;
    let mut at = 0;
    while at < length {
        let size = chunk.len().min(usize::try_from(length - at).unwrap_or(CHUNK));
        match file.read_exact(&mut chunk[..size]) {
            Ok(()) => memory.write(at, &chunk[..size])?,
            // It was shortened meanwhile.
            Err(error) if error.kind() == io::ErrorKind::UnexpectedEof => return Ok(None),
            Err(error) => return Err(error),
        }
        at += size as u64;
    }
    let same = Header::read(file)? == before && file.metadata()?.len() == length;
    Ok(same.then_some((before, memory)))
}

/// Memory that a store is made in, and whose bytes are then written to a file.
#[derive(Clone, Debug, Default)]
pub(super) struct Draft(Arc<InMemoryBackend>);

impl Draft {
    /// All bytes, once the store is closed.
    pub(super) fn bytes(&self) -> io::Result<Vec<u8>> {
        let length = usize::try_from(self.0.len()?).map_err(io::Error::other)?;
        let mut bytes = vec![0; length];
        self.0.read(0, &mut bytes)?;
        Ok(bytes)
    }
}

impl StorageBackend for Draft {
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
