//! The programs of the folder `shared/data/gcode`, which need not exist.

use std::fs;
use std::path::{Path, PathBuf};

/// Returns the folder, or prints that it is absent.
pub(crate) fn folder() -> Option<PathBuf> {
    let found = Path::new(env!("CARGO_MANIFEST_DIR"))
        .ancestors()
        .map(|folder| folder.join("shared/data/gcode"))
        .find(|folder| folder.is_dir());
    if found.is_none() {
        println!("shared/data/gcode is absent: its programs are not tested");
    }
    found
}

pub(crate) fn text(path: &Path) -> String {
    fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}
