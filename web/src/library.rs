//! The texts of the library's tools.

use include_dir::{Dir, DirEntry, include_dir};
use std::collections::BTreeMap;
use std::path::PathBuf;

static TOOLS: Dir<'_> = include_dir!("$CARGO_MANIFEST_DIR/../tools-library/tools");

/// Returns the texts of all files, holders included, by path.
pub(crate) fn files() -> BTreeMap<PathBuf, String> {
    let mut files = BTreeMap::new();
    let mut folders = vec![&TOOLS];
    while let Some(folder) = folders.pop() {
        for entry in folder.entries() {
            match entry {
                DirEntry::Dir(folder) => folders.push(folder),
                DirEntry::File(file) => {
                    let text = file.contents_utf8().unwrap_or_default();
                    files.insert(file.path().to_owned(), text.to_owned());
                }
            }
        }
    }
    files
}
