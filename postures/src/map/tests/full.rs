//! A full disk: nothing that was recorded is lost.

use super::*;
use redb::StorageBackend;
use redb::backends::InMemoryBackend;
use std::sync::Arc;
use std::sync::atomic::{AtomicI64, Ordering};
use touchoff::TriangleId;

/// A disk with room for a limited number of further bytes.
#[derive(Clone, Debug)]
struct Disk {
    bytes: Arc<InMemoryBackend>,
    room: Arc<AtomicI64>,
}

impl Disk {
    /// Creates a disk with a map that has no rows.
    fn new() -> Disk {
        let disk = Disk { bytes: Arc::default(), room: Arc::new(AtomicI64::new(i64::MAX)) };
        write_facts(&disk.store().expect("room"), &identity()).expect("written");
        disk
    }

    fn store(&self) -> Result<Database, redb::DatabaseError> {
        Builder::new().set_check_integrity_on_open(true).create_with_backend(self.clone())
    }

    fn map(&self) -> Result<PostureMap, MapError> {
        let store = self.store().map_err(|error| MapError::from_database("disk", error))?;
        PostureMap::from_database(store, "disk".to_owned())
    }

    fn take(&self, count: usize) -> io::Result<()> {
        let count = i64::try_from(count).expect("a small count");
        match self.room.fetch_sub(count, Ordering::Relaxed) >= count {
            true => Ok(()),
            false => Err(io::ErrorKind::StorageFull.into()),
        }
    }
}

impl StorageBackend for Disk {
    fn len(&self) -> io::Result<u64> {
        self.bytes.len()
    }

    fn read(&self, offset: u64, out: &mut [u8]) -> io::Result<()> {
        self.bytes.read(offset, out)
    }

    fn set_len(&self, len: u64) -> io::Result<()> {
        self.bytes.set_len(len)
    }

    fn sync_data(&self) -> io::Result<()> {
        self.take(0)?;
        self.bytes.sync_data()
    }

    fn write(&self, offset: u64, data: &[u8]) -> io::Result<()> {
        self.take(data.len())?;
        self.bytes.write(offset, data)
    }
}

#[test]
fn a_full_disk_says_so_and_keeps_what_was_recorded() {
    let mut random = Pcg64Mcg::seed_from_u64(6);
    let mut stopped = [0; 2];
    for room in (0..200).map(|k| 997 * k) {
        let disk = Disk::new();
        let map = disk.map().expect("room");
        disk.room.store(room, Ordering::Relaxed);
        let mut acknowledged: Vec<(TriangleId, MapRow)> = Vec::new();
        for triangle in 0..12 {
            let row = MapRow { best: vec![any_record(&mut random)], access: Vec::new() };
            match map.record(&[(TriangleId(triangle), row.clone())]) {
                Ok(()) => acknowledged.push((TriangleId(triangle), row)),
                Err(error) => {
                    let text = error.to_string();
                    assert!(matches!(error, MapError::Full { .. }), "{error:?}");
                    assert!(text.contains("what was recorded before is safe in it"), "{text}");
                    stopped[usize::from(triangle > 0)] += 1;
                    // A further attempt fails as well.
                    let again =
                        map.record(&[(TriangleId(triangle), row)]).expect_err("no room yet");
                    assert!(matches!(again, MapError::Unwritable { .. } | MapError::Full { .. }));
                    break;
                }
            }
        }
        drop(map);
        disk.room.store(i64::MAX, Ordering::Relaxed);
        let found = rows(&disk.map().expect("room again"));
        // The last batch may be stored although it could not be acknowledged.
        assert!(found.starts_with(&acknowledged), "{room}: {found:?} {acknowledged:?}");
        assert!(found.len() <= acknowledged.len() + 1);
    }
    assert!(stopped.iter().all(|count| *count > 0), "{stopped:?}");
}
