//! Reading input files: regular files up to a maximum size.

use std::fs::{self, File};
use std::io::{self, Read};
use std::path::Path;

/// Maximum size of a file in bytes, 16 GiB: some 300 million triangles of binary STL.
const MAX_BYTES: u64 = 1 << 34;

/// Opens a regular file of at most [`MAX_BYTES`] bytes and returns it with its length.
///
/// # Errors
/// Returns the errors of the operating system. Refuses a longer file, and a directory, a pipe, a socket
/// or a device, whose content may be endless.
pub(crate) fn open(path: impl AsRef<Path>) -> io::Result<(File, u64)> {
    let refuse = |reason: String| Err(io::Error::new(io::ErrorKind::InvalidInput, reason));
    let irregular = || refuse("it is no regular file".to_owned());
    // Check before opening: opening a pipe waits for its writer.
    if !fs::metadata(&path)?.is_file() {
        return irregular();
    }
    let file = File::open(path)?;
    let metadata = file.metadata()?;
    match metadata.len() {
        _ if !metadata.is_file() => irregular(),
        bytes if bytes > MAX_BYTES => {
            refuse(format!("it has {bytes} bytes, more than the {MAX_BYTES} that are read"))
        }
        bytes => Ok((file, bytes)),
    }
}

/// Reads a regular file, up to the length that it had when it was opened.
///
/// # Errors
/// Returns the errors of the operating system, and `OutOfMemory` if the file does not fit into memory. Refuses a file of more
/// than 16 GiB, and a directory, a pipe, a socket or a device, whose content may be endless.
pub fn read_regular_file(path: impl AsRef<Path>) -> io::Result<Vec<u8>> {
    let (file, length) = open(path)?;
    let mut bytes = Vec::new();
    let capacity =
        usize::try_from(length).ok().filter(|capacity| bytes.try_reserve_exact(*capacity).is_ok());
    if capacity.is_none() {
        return Err(io::ErrorKind::OutOfMemory.into());
    }
    file.take(length).read_to_end(&mut bytes)?;
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_regular_files_are_read() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a");
        fs::write(&path, b"some").expect("written");
        assert_eq!(read_regular_file(&path).expect("read"), b"some");
        let refused =
            |path: &Path| read_regular_file(path).expect_err("no regular file").to_string();
        assert_eq!(refused(folder.path()), "it is no regular file");
        #[cfg(unix)]
        {
            let socket = folder.path().join("socket");
            let _listener = std::os::unix::net::UnixListener::bind(&socket).expect("a socket");
            let pipe = folder.path().join("pipe");
            let status = std::process::Command::new("mkfifo").arg(&pipe).status();
            assert!(status.expect("mkfifo").success());
            for path in [&socket, &pipe, Path::new("/dev/zero")] {
                assert_eq!(refused(path), "it is no regular file");
            }
        }
        // A sparse file takes no space on the disk.
        File::create(&path).and_then(|file| file.set_len(MAX_BYTES + 1)).expect("a long file");
        assert!(refused(&path).contains("17179869185 bytes, more than the 17179869184"));
    }
}
