//! Files that are written completely or not at all.

use std::ffi::OsStr;
use std::fs::{self, File, Metadata, OpenOptions, TryLockError};
use std::hash::{BuildHasher, RandomState};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

/// A file that replaces its target only when it is complete.
///
/// Bytes are written to a temporary file in the target's folder. [`AtomicFile::commit`] synchronises it
/// to the disk and renames it: a reader of the target finds either all of the old content or all of the
/// new. If the value is dropped before that, the temporary file is removed and the target is unchanged.
///
/// - A new file has the permissions of any new file (the umask applies); a replaced file keeps its own.
///   A file without write permission is not replaced either.
/// - A symbolic link is kept, and the file it points to is replaced.
/// - Targets that are not regular files, such as devices or pipes, are written directly. The same holds
///   for standard output and standard error by their names in `/dev` and `/proc`.
/// - Temporary files are named `.touchoff-….tmp` and are locked while their writer lives. Temporary
///   files left in the folder by killed processes are removed; no file of such a name is read as an input.
///
/// ```
/// # use std::io::Write;
/// # fn main() -> std::io::Result<()> {
/// # let folder = tempfile::tempdir()?;
/// # let path = folder.path().join("report.txt");
/// let mut file = touchoff::AtomicFile::create(&path)?;
/// writeln!(file, "depth 0.25 mm")?;
/// assert!(!path.exists());
/// file.commit()?;
/// assert_eq!(std::fs::read_to_string(&path)?, "depth 0.25 mm\n");
/// # Ok(()) }
/// ```
#[derive(Debug)]
pub struct AtomicFile {
    out: BufWriter<Sink>,
    /// The target path; empty if the file is written directly.
    target: PathBuf,
}

#[derive(Debug)]
enum Sink {
    Temporary(Temporary),
    Direct(File),
}

/// A file that does not have its name yet.
#[derive(Debug)]
struct Temporary {
    file: File,
    path: PathBuf,
    /// Set if it stays when it is dropped.
    is_kept: bool,
}

impl Drop for Temporary {
    fn drop(&mut self) {
        if !self.is_kept {
            // After a rename there is no file of that name.
            let _ = fs::remove_file(&self.path);
        }
    }
}

impl Write for Sink {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match self {
            Sink::Temporary(temporary) => temporary.file.write(bytes),
            Sink::Direct(file) => file.write(bytes),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        match self {
            Sink::Temporary(temporary) => temporary.file.flush(),
            Sink::Direct(file) => file.flush(),
        }
    }
}

impl Write for AtomicFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.out.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.out.flush()
    }
}

/// Prefix and suffix of the names of temporary files.
const PREFIX: &str = ".touchoff-";
const SUFFIX: &str = ".tmp";
/// Ending of the name of a file that is kept while it is written.
const PART_SUFFIX: &str = ".part";

impl AtomicFile {
    /// Begins a file.
    ///
    /// # Errors
    /// Fails if the folder does not exist or is not writable, if the target is not writable or is a
    /// folder, and for any other error of the file system.
    pub fn create(path: impl AsRef<Path>) -> io::Result<AtomicFile> {
        AtomicFile::begin(path.as_ref(), create_temporary)
    }

    /// Begins a file of which nothing may be lost, such as a recording: until it is committed, its bytes are in `NAME.part` beside
    /// the target. That file stays if the value is dropped or the process is killed.
    ///
    /// # Errors
    /// As for [`AtomicFile::create`], and `AlreadyExists` if `NAME.part` is there already.
    pub fn create_kept(path: impl AsRef<Path>) -> io::Result<AtomicFile> {
        AtomicFile::begin(path.as_ref(), |target| {
            let mut path = target.as_os_str().to_owned();
            path.push(PART_SUFFIX);
            let path = PathBuf::from(path);
            match OpenOptions::new().write(true).create_new(true).open(&path) {
                Ok(file) => Ok(Temporary { file, path, is_kept: true }),
                Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {
                    let name = path.display();
                    let reason = format!(
                        "{name} is there already, from one that was not completed: rename or remove it"
                    );
                    Err(io::Error::new(error.kind(), reason))
                }
                Err(error) => Err(error),
            }
        })
    }

    /// Begins a file; `make` makes that of its bytes for the target.
    fn begin(
        path: &Path,
        make: impl FnOnce(&Path) -> io::Result<Temporary>,
    ) -> io::Result<AtomicFile> {
        let direct =
            |file| AtomicFile { out: BufWriter::new(Sink::Direct(file)), target: PathBuf::new() };
        if let Some(stream) = standard_stream(path) {
            return stream.map(direct);
        }
        let old = match fs::metadata(path) {
            Ok(old) if old.is_file() || old.is_dir() => Some(old),
            Ok(_) => return OpenOptions::new().write(true).open(path).map(direct),
            Err(error) if error.kind() == io::ErrorKind::NotFound => None,
            Err(error) => return Err(error),
        };
        if old.is_some() {
            // Open without writing, to refuse a file that is not writable, or a folder.
            OpenOptions::new().write(true).open(path)?;
        }
        let target = resolve_links(path)?;
        remove_abandoned(folder_of(&target));
        let temporary = make(&target)?;
        if let Some(old) = old {
            copy_permissions(&temporary.file, &old)?;
        }
        Ok(AtomicFile { out: BufWriter::new(Sink::Temporary(temporary)), target })
    }

    /// Returns the path that is written to for a path: the one to which its symbolic links lead, which need not exist.
    ///
    /// # Errors
    /// If too many links lead on from it.
    pub fn target(path: impl AsRef<Path>) -> io::Result<PathBuf> {
        resolve_links(path.as_ref())
    }

    /// Writes a whole file.
    ///
    /// # Errors
    /// Returns the errors of [`AtomicFile::create`] and [`AtomicFile::commit`].
    pub fn write(path: impl AsRef<Path>, bytes: impl AsRef<[u8]>) -> io::Result<()> {
        let mut file = AtomicFile::create(path)?;
        file.write_all(bytes.as_ref())?;
        file.commit()
    }

    /// Synchronises the file to the disk and renames it to its target.
    ///
    /// # Errors
    /// Returns the errors of the file system, above all for lack of space; the target is then unchanged.
    pub fn commit(self) -> io::Result<()> {
        self.finish(|temporary, target| fs::rename(temporary, target))
    }

    /// Commits a file like [`AtomicFile::commit`], if its target does not exist.
    ///
    /// # Errors
    /// `AlreadyExists` if there is a file of that name by now; that file is unchanged.
    pub fn commit_new(self) -> io::Result<()> {
        // Unlike a rename, a link never replaces a file; its other name is removed with the temporary file.
        self.finish(|temporary, target| fs::hard_link(temporary, target))
    }

    /// Synchronises the file and gives it its name: `publish` takes the temporary path and the target.
    fn finish(self, publish: impl FnOnce(&Path, &Path) -> io::Result<()>) -> io::Result<()> {
        match self.out.into_inner().map_err(io::IntoInnerError::into_error)? {
            Sink::Direct(mut file) => file.flush(),
            Sink::Temporary(temporary) => {
                temporary.file.sync_all()?;
                publish(&temporary.path, &self.target)?;
                // Synchronise the folder entry too. Where folders cannot be synchronised, the system
                // writes it in its own time.
                #[cfg(unix)]
                let _ = File::open(folder_of(&self.target)).and_then(|folder| folder.sync_all());
                Ok(())
            }
        }
    }
}

fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if folder != Path::new("") => folder,
        _ => Path::new("."),
    }
}

/// Resolves a path's symbolic links. The final target need not exist.
fn resolve_links(path: &Path) -> io::Result<PathBuf> {
    /// Maximum number of links in a path, as on Linux.
    const MAX_LINKS: usize = 40;
    let mut target = path.to_owned();
    for _ in 0..MAX_LINKS {
        match fs::read_link(&target) {
            Ok(next) => target = folder_of(&target).join(next),
            Err(_) => return Ok(target),
        }
    }
    Err(io::Error::new(io::ErrorKind::InvalidInput, "too many links lead on from it"))
}

/// Returns standard output or standard error, if a path names one of them. The result shares the open
/// file, so new output follows the output already written to the stream.
#[cfg(unix)]
fn standard_stream(path: &Path) -> Option<io::Result<File>> {
    use std::os::fd::AsFd;
    let into_file = |stream: io::Result<std::os::fd::OwnedFd>| Some(stream.map(File::from));
    match path.to_str()? {
        "/dev/stdout" | "/dev/fd/1" | "/proc/self/fd/1" => {
            into_file(io::stdout().as_fd().try_clone_to_owned())
        }
        "/dev/stderr" | "/dev/fd/2" | "/proc/self/fd/2" => {
            into_file(io::stderr().as_fd().try_clone_to_owned())
        }
        _ => None,
    }
}

#[cfg(not(unix))]
fn standard_stream(_: &Path) -> Option<io::Result<File>> {
    None
}

/// Creates a temporary file beside a target, locked so that no process treats it as abandoned.
fn create_temporary(target: &Path) -> io::Result<Temporary> {
    /// Number of attempts, more than chance and a few other processes require.
    const MAX_ATTEMPTS: usize = 16;
    for _ in 0..MAX_ATTEMPTS {
        // Each `RandomState` has keys of its own, so that an empty hash is a random number.
        let random = RandomState::new().hash_one(());
        let path = folder_of(target).join(format!("{PREFIX}{random:016x}{SUFFIX}"));
        let file = match OpenOptions::new().write(true).create_new(true).open(&path) {
            Ok(file) => file,
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => continue,
            Err(error) => return Err(error),
        };
        let temporary = Temporary { file, path, is_kept: false };
        match temporary.file.try_lock() {
            // Another process took the file for abandoned before it was locked, and removes it.
            Err(TryLockError::WouldBlock) => {}
            Ok(()) if !temporary.path.exists() => {}
            // Not every file system supports locks; without them no file is treated as abandoned.
            Ok(()) | Err(TryLockError::Error(_)) => return Ok(temporary),
        }
    }
    Err(io::Error::other("temporary files there are removed as soon as they are made"))
}

/// Removes the temporary files of a folder whose writers have ended. Files that cannot be removed remain.
fn remove_abandoned(folder: &Path) {
    let Ok(entries) = fs::read_dir(folder) else { return };
    for entry in entries.flatten() {
        let is_file = entry.file_type().is_ok_and(|kind| kind.is_file());
        if is_file && is_temporary(&entry.file_name()) {
            let path = entry.path();
            let open = OpenOptions::new().write(true).open(&path);
            if open.is_ok_and(|file| file.try_lock().is_ok()) {
                let _ = fs::remove_file(&path);
            }
        }
    }
}

/// Returns whether a name is one of those of temporary files.
pub(crate) fn is_temporary(name: &OsStr) -> bool {
    let random = name.to_str().and_then(|name| name.strip_prefix(PREFIX)?.strip_suffix(SUFFIX));
    random.is_some_and(|digits| digits.len() == 16 && digits.bytes().all(|b| b.is_ascii_hexdigit()))
}

/// Copies the permissions of an old file to a new one and, where the system allows it, the owner.
fn copy_permissions(new: &File, old: &Metadata) -> io::Result<()> {
    #[cfg(unix)]
    {
        use std::os::unix::fs::{MetadataExt, fchown};
        let metadata = new.metadata()?;
        if (metadata.uid(), metadata.gid()) != (old.uid(), old.gid()) {
            // Change the owner before the permissions, since it clears some of them.
            let _ = fchown(new, Some(old.uid()), Some(old.gid()));
        }
    }
    if new.metadata()?.permissions() == old.permissions() {
        return Ok(());
    }
    new.set_permissions(old.permissions())
}

#[cfg(test)]
mod tests;
