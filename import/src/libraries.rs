//! Libraries of which several tools are taken.

use crate::{Entry, FindError, ImportError, Library};
use std::collections::BTreeMap;
use std::collections::btree_map;
use std::ffi::OsStr;
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
            btree_map::Entry::Occupied(known) => known.into_mut(),
            btree_map::Entry::Vacant(entry) => entry.insert(match root {
                Some(root) => Library::read_within(file, root)?,
                None => Library::read(file)?,
            }),
        })
    }

    /// Returns what a library file states of a tool that it names; `None` without a library, and for a folder of `.tool` files, which
    /// states nothing else.
    ///
    /// # Errors
    /// As for [`Libraries::read`], or if no tool has the name, or several have.
    pub fn entry<E: From<ImportError> + From<FindError>>(
        &mut self,
        library: Option<&Path>,
        name: &OsStr,
        root: Option<&Path>,
    ) -> Result<Option<&Entry>, E> {
        let Some(file) = library.filter(|library| !library.is_dir()) else { return Ok(None) };
        Ok(Some(&self.read(file, root)?.select(&name.to_string_lossy())?.entry))
    }
}
