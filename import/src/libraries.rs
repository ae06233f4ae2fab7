//! Libraries of which several tools are taken.

use crate::{ImportError, Library};
use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::path::{Path, PathBuf};

/// Libraries that were read, by their files and the folders within which they read others. Each is read once for all its tools.
#[derive(Debug, Default)]
pub struct Libraries(BTreeMap<(PathBuf, Option<PathBuf>), Library>);

impl Libraries {
    /// Returns a library, which is read at the first time: within the folder `root`, as by [`Library::read_within`], if it is given.
    ///
    /// # Errors
    /// As for [`Library::read`].
    pub fn read(&mut self, file: &Path, root: Option<&Path>) -> Result<&Library, ImportError> {
        Ok(match self.0.entry((file.to_owned(), root.map(Path::to_owned))) {
            Entry::Occupied(known) => known.into_mut(),
            Entry::Vacant(entry) => entry.insert(match root {
                Some(root) => Library::read_within(file, root)?,
                None => Library::read(file)?,
            }),
        })
    }
}
