//! Reading input files: regular files, up to the length that their kind may have.

use crate::atomic_file::is_temporary;
use std::fs::{self, File};
use std::io::{self, Read};
use std::path::{Component, Path};

/// Kinds of input files. Each limits the length of a file, so that a stranger's file cannot fill memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum FileKind {
    /// Triangles or points, a saved part, a shard of a sweep: 16 GiB, some 300 million triangles of binary STL.
    Geometry,
    /// A posture map, which is copied into memory: 4 GiB.
    PostureMap,
    /// A program, or a table of poses or postures: 1 GiB.
    Program,
    /// A tool library: 64 MiB.
    Library,
    /// Text that a person writes: a job, a machine, a control, a list of tools: 4 MiB.
    Settings,
}

impl FileKind {
    /// Returns the length of the longest file of this kind that is read, in bytes.
    pub const fn max_bytes(self) -> u64 {
        match self {
            FileKind::Geometry => 1 << 34,
            FileKind::PostureMap => 1 << 32,
            FileKind::Program => 1 << 30,
            FileKind::Library => 1 << 26,
            FileKind::Settings => 1 << 22,
        }
    }
}

/// Opens a regular file and returns it with its length.
///
/// # Errors
/// Returns the errors of the operating system. Refuses a file longer than its [kind](FileKind::max_bytes) may be, a directory, a
/// pipe, a socket or a device, whose content may be endless, and a temporary file of [`AtomicFile`](crate::AtomicFile), which the
/// next output in its folder removes.
pub fn open_regular_file(path: impl AsRef<Path>, kind: FileKind) -> io::Result<(File, u64)> {
    let refuse = |reason: String| Err(io::Error::new(io::ErrorKind::InvalidInput, reason));
    let irregular = || refuse("it is no regular file".to_owned());
    let place = path.as_ref().canonicalize();
    if place.is_ok_and(|place| place.file_name().is_some_and(is_temporary)) {
        let reason = "its name is that of a temporary file, which the next output in its folder removes: rename it";
        return refuse(reason.to_owned());
    }
    // Check before opening: opening a pipe waits for its writer.
    if !fs::metadata(&path)?.is_file() {
        return irregular();
    }
    let file = File::open(path)?;
    let metadata = file.metadata()?;
    match metadata.len() {
        _ if !metadata.is_file() => irregular(),
        bytes if bytes > kind.max_bytes() => refuse(format!(
            "it has {bytes} bytes, more than the {} that are read",
            kind.max_bytes()
        )),
        bytes => Ok((file, bytes)),
    }
}

/// Reads a regular file, up to the length that it had when it was opened.
///
/// # Errors
/// As for [`open_regular_file`], and `OutOfMemory` if the file does not fit into memory.
pub fn read_regular_file(path: impl AsRef<Path>, kind: FileKind) -> io::Result<Vec<u8>> {
    let (file, length) = open_regular_file(path, kind)?;
    let mut bytes = Vec::new();
    let capacity =
        usize::try_from(length).ok().filter(|capacity| bytes.try_reserve_exact(*capacity).is_ok());
    if capacity.is_none() {
        return Err(io::ErrorKind::OutOfMemory.into());
    }
    file.take(length).read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// Reads a regular file as text.
///
/// # Errors
/// As for [`read_regular_file`], and `InvalidData`, with the line, if the content is not UTF-8.
pub fn read_text_file(path: impl AsRef<Path>, kind: FileKind) -> io::Result<String> {
    String::from_utf8(read_regular_file(path, kind)?).map_err(|error| {
        let good = &error.as_bytes()[..error.utf8_error().valid_up_to()];
        let line = 1 + good.iter().filter(|byte| **byte == b'\n').count();
        let reason = format!("line {line} is no UTF-8 text: save it as UTF-8");
        io::Error::new(io::ErrorKind::InvalidData, reason)
    })
}

/// Returns whether a path leads to a folder or below it, with links followed. Of a file that does not exist, the existing
/// folders on its way decide; a link that leads nowhere, and steps up after a folder that does not exist, give `false`.
pub fn is_within(path: impl AsRef<Path>, folder: impl AsRef<Path>) -> bool {
    let existing = |path: &Path| match path {
        path if path == Path::new("") => Path::new(".").canonicalize(),
        path => path.canonicalize(),
    };
    let (path, Ok(folder)) = (path.as_ref(), existing(folder.as_ref())) else { return false };
    for ancestor in path.ancestors() {
        if let Ok(resolved) = existing(ancestor) {
            let mut rest = path.strip_prefix(ancestor).unwrap_or(path).components();
            return resolved.starts_with(folder)
                && rest.all(|part| matches!(part, Component::Normal(_)));
        }
        if ancestor.is_symlink() {
            return false;
        }
    }
    false
}

#[cfg(test)]
mod tests {
    use super::*;

    const SETTINGS: FileKind = FileKind::Settings;

    #[test]
    fn only_regular_files_are_read() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a");
        fs::write(&path, b"some").expect("written");
        assert_eq!(read_regular_file(&path, SETTINGS).expect("read"), b"some");
        let refused = |path: &Path| {
            read_regular_file(path, SETTINGS).expect_err("no regular file").to_string()
        };
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
        // An output in the folder would remove it, whatever its content and the link that leads to it.
        let temporary = folder.path().join(".touchoff-0123456789abcdef.tmp");
        fs::write(&temporary, b"some").expect("written");
        assert!(refused(&temporary).ends_with("removes: rename it"));
        #[cfg(unix)]
        {
            let link = folder.path().join("link");
            std::os::unix::fs::symlink(&temporary, &link).expect("a link");
            assert!(refused(&link).ends_with("removes: rename it"));
        }
        fs::write(&path, b"a\nb\xff").expect("written");
        let garbled = read_text_file(&path, SETTINGS).expect_err("no text").to_string();
        assert!(garbled.starts_with("line 2 is no UTF-8 text"), "{garbled}");
        // A sparse file takes no space on the disk.
        let length = SETTINGS.max_bytes() + 1;
        File::create(&path).and_then(|file| file.set_len(length)).expect("a long file");
        assert!(refused(&path).contains("4194305 bytes, more than the 4194304"));
    }

    #[test]
    fn a_path_is_within_a_folder_with_links_followed() {
        let folder = tempfile::tempdir().expect("a folder");
        let [inner, outside] = ["inner", "outside"].map(|name| folder.path().join(name));
        for made in [&inner, &outside, &inner.join("deep")] {
            fs::create_dir(made).expect("a folder");
        }
        fs::write(outside.join("file"), b"").expect("written");
        for (path, expected) in [
            ("new", true),
            ("deep/new", true),
            ("deep/../new", true),
            ("..", false),
            (".", true),
            ("../outside/file", false),
            ("../outside/new", false),
            ("deep/../../outside/new", false),
            ("absent/new", true),
            ("absent/../new", false),
        ] {
            assert_eq!(is_within(inner.join(path), &inner), expected, "{path}");
        }
        assert!(!is_within(inner.join("new"), inner.join("absent")));
        #[cfg(unix)]
        {
            use std::os::unix::fs::symlink;
            for (target, name) in
                [("../outside/file", "file"), ("../outside/new", "new"), ("../outside", "folder")]
            {
                symlink(target, inner.join(name)).expect("a link");
            }
            for path in ["file", "new", "folder/file", "folder/new"] {
                assert!(!is_within(inner.join(path), &inner), "{path}");
            }
        }
    }
}
