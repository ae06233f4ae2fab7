//! Files that are written whole or not at all.

use std::fs::{self, File, Metadata, OpenOptions, TryLockError};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use tempfile::NamedTempFile;

/// A file that takes its name when it is whole.
///
/// Bytes go to a temporary file in the target's folder. [`AtomicFile::commit`] brings them to the disk and renames:
/// who reads the target finds all of the old content or all of the new. Dropped before that, the temporary is
/// removed and the target is as it was.
///
/// - A new file has the permissions of any new file (the umask holds), a replaced one keeps its own. A file that may
///   not be written is not replaced either.
/// - A link keeps leading to its file, which is replaced.
/// - What is no regular file, such as a device or a pipe, is written to directly; so are standard output and standard
///   error by their names in `/dev` and `/proc`.
/// - Temporaries are named `.touchoff-….tmp` and are locked while their writer lives. Those that a killed process left
///   in the folder are removed here.
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
    /// Where the temporary goes; empty of what is written to directly.
    target: PathBuf,
}

#[derive(Debug)]
enum Sink {
    Temporary(NamedTempFile),
    Direct(File),
}

impl Write for Sink {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match self {
            Sink::Temporary(file) => file.write(bytes),
            Sink::Direct(file) => file.write(bytes),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        match self {
            Sink::Temporary(file) => file.flush(),
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

/// Names of temporaries begin and end in these.
const PREFIX: &str = ".touchoff-";
const SUFFIX: &str = ".tmp";

impl AtomicFile {
    /// Begins a file.
    ///
    /// # Errors
    /// A folder that is not there or may not be written, a target that may not be written or is a folder, and
    /// whatever else the file system says.
    pub fn create(path: impl AsRef<Path>) -> io::Result<AtomicFile> {
        let path = path.as_ref();
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
            // Opened, not written: a file that may not be written is refused here, and a folder too.
            OpenOptions::new().write(true).open(path)?;
        }
        let target = followed(path)?;
        let folder = folder_of(&target);
        remove_abandoned(folder);
        let temporary = temporary(folder)?;
        if let Some(old) = old {
            keep(temporary.as_file(), &old)?;
        }
        Ok(AtomicFile { out: BufWriter::new(Sink::Temporary(temporary)), target })
    }

    /// Writes a whole file.
    ///
    /// # Errors
    /// Those of [`AtomicFile::create`] and [`AtomicFile::commit`].
    pub fn write(path: impl AsRef<Path>, bytes: impl AsRef<[u8]>) -> io::Result<()> {
        let mut file = AtomicFile::create(path)?;
        file.write_all(bytes.as_ref())?;
        file.commit()
    }

    /// Brings the file to the disk and gives it its name.
    ///
    /// # Errors
    /// What the file system says, above all that there is no room; then the target is as it was.
    pub fn commit(self) -> io::Result<()> {
        self.finish(|temporary, target| temporary.persist(target).map_err(|failed| failed.error))
    }

    /// [`AtomicFile::commit`] for a file that must be new.
    ///
    /// # Errors
    /// `AlreadyExists` if there is a file of that name by now, which is left as it is.
    pub fn commit_new(self) -> io::Result<()> {
        let persist = |temporary: NamedTempFile, target: &Path| {
            temporary.persist_noclobber(target).map_err(|failed| failed.error)
        };
        self.finish(persist)
    }

    fn finish(
        self,
        persist: impl FnOnce(NamedTempFile, &Path) -> io::Result<File>,
    ) -> io::Result<()> {
        match self.out.into_inner().map_err(io::IntoInnerError::into_error)? {
            Sink::Direct(mut file) => file.flush(),
            Sink::Temporary(temporary) => {
                temporary.as_file().sync_all()?;
                persist(temporary, &self.target)?;
                // The name too; where folders cannot be synchronised, the system does it in its own time.
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

/// Returns what a path's links lead to, which need not be there.
fn followed(path: &Path) -> io::Result<PathBuf> {
    /// As many as Linux follows.
    const LINKS: usize = 40;
    let mut target = path.to_owned();
    for _ in 0..LINKS {
        match fs::read_link(&target) {
            Ok(next) => target = folder_of(&target).join(next),
            Err(_) => return Ok(target),
        }
    }
    Err(io::Error::new(io::ErrorKind::InvalidInput, "too many links lead on from it"))
}

/// Standard output or standard error, if a path names one of them. The same open file, so that what is written
/// stands behind what was written to the stream before.
#[cfg(unix)]
fn standard_stream(path: &Path) -> Option<io::Result<File>> {
    use std::os::fd::AsFd;
    let own = |stream: io::Result<std::os::fd::OwnedFd>| Some(stream.map(File::from));
    match path.to_str()? {
        "/dev/stdout" | "/dev/fd/1" | "/proc/self/fd/1" => {
            own(io::stdout().as_fd().try_clone_to_owned())
        }
        "/dev/stderr" | "/dev/fd/2" | "/proc/self/fd/2" => {
            own(io::stderr().as_fd().try_clone_to_owned())
        }
        _ => None,
    }
}

#[cfg(not(unix))]
fn standard_stream(_: &Path) -> Option<io::Result<File>> {
    None
}

/// A new file in a folder, locked so that nobody takes it for abandoned.
fn temporary(folder: &Path) -> io::Result<NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(PREFIX).suffix(SUFFIX);
    #[cfg(unix)]
    {
        // As of any new file: the system takes away what the user wants no one to do.
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(fs::Permissions::from_mode(0o666));
    }
    /// More often than chance and a few other processes would have it.
    const TRIES: usize = 16;
    for _ in 0..TRIES {
        // Without the temporary's name, which nobody asked for.
        let file = builder.tempfile_in(folder).map_err(|error| io::Error::from(error.kind()))?;
        match file.as_file().try_lock() {
            // Another process took it for abandoned before it was locked, and removes it.
            Err(TryLockError::WouldBlock) => {}
            Ok(()) if !file.path().exists() => {}
            // Not every file system has locks; where there are none, nothing is taken for abandoned.
            Ok(()) | Err(TryLockError::Error(_)) => return Ok(file),
        }
    }
    Err(io::Error::other("temporary files there are removed as soon as they are made"))
}

/// Removes the temporaries of a folder whose writers are gone. What cannot be removed stays.
fn remove_abandoned(folder: &Path) {
    let Ok(entries) = fs::read_dir(folder) else { return };
    for entry in entries.flatten() {
        let name = entry.file_name();
        let is_ours = name.to_str().is_some_and(|n| n.starts_with(PREFIX) && n.ends_with(SUFFIX));
        if is_ours && entry.file_type().is_ok_and(|kind| kind.is_file()) {
            let path = entry.path();
            let open = OpenOptions::new().write(true).open(&path);
            if open.is_ok_and(|file| file.try_lock().is_ok()) {
                let _ = fs::remove_file(&path);
            }
        }
    }
}

/// Gives a new file what an old one has: its permissions and, where the system lets, its owner.
fn keep(new: &File, old: &Metadata) -> io::Result<()> {
    #[cfg(unix)]
    {
        use std::os::unix::fs::{MetadataExt, fchown};
        let own = new.metadata()?;
        if (own.uid(), own.gid()) != (old.uid(), old.gid()) {
            // Before the permissions: it takes some of them away.
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
