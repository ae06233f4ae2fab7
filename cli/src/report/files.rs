//! The files that a report is about, with their digests.

use crate::failure::Failure;
use sha2::{Digest, Sha256};
use std::fmt::Write;
use std::path::Path;

/// A file as it was read.
pub(super) struct InputFile {
    pub(super) role: String,
    pub(super) name: String,
    pub(super) bytes: usize,
    /// SHA-256 of its content, in hexadecimal digits.
    pub(super) digest: String,
}

impl InputFile {
    /// Reads a file.
    ///
    /// # Errors
    /// [`Failure::Unreadable`].
    pub(super) fn read(role: String, file: &Path) -> Result<InputFile, Failure> {
        let name = file.display().to_string();
        let content = std::fs::read(file)
            .map_err(|source| Failure::Unreadable { file: name.clone(), source })?;
        let mut digest = String::new();
        for byte in Sha256::digest(&content) {
            // Writing to a String does not fail.
            let _ = write!(digest, "{byte:02x}");
        }
        Ok(InputFile { role, name, bytes: content.len(), digest })
    }
}
