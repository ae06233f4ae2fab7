//! Outputs: standard output, standard error, and the files that may be written.

use crate::failure::Failure;
use std::io::{self, BufWriter, IsTerminal, StdoutLock, Write};
use std::path::{Path, PathBuf};
use tool_dsl::diagnostic::Diagnostic;
use tool_dsl::source::{Source, Sources};
use touchoff::{AtomicFile, EscapedLines};

/// Standard output.
///
/// A reader that has enough and closes it is no failure: what is written from then on goes nowhere, and the command
/// goes on to its verdict. Any other failure is one, such as a full disk; [`Write::flush`] at the end of a command
/// brings out the last of them.
///
/// Control characters are escaped, so that no name in a file is obeyed by a terminal.
pub(crate) struct Output {
    out: Buffered,
    escaped: bool,
}

enum Buffered {
    /// Line by line, so that lines of standard error come between them in their order.
    Lines(StdoutLock<'static>),
    /// In blocks.
    Blocks(BufWriter<StdoutLock<'static>>),
}

impl Output {
    /// For lines of text and of JSON.
    pub(crate) fn lines() -> Output {
        Output { out: Buffered::Lines(io::stdout().lock()), escaped: true }
    }

    /// For very many lines.
    pub(crate) fn rows() -> Output {
        Output { out: Buffered::Blocks(BufWriter::new(io::stdout().lock())), escaped: true }
    }

    /// For a file's content, byte for byte.
    pub(crate) fn bytes() -> Output {
        Output { escaped: false, ..Output::rows() }
    }

    fn out(&mut self) -> &mut dyn Write {
        match &mut self.out {
            Buffered::Lines(out) => out,
            Buffered::Blocks(out) => out,
        }
    }
}

impl Write for Output {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let is_plain = |byte: &u8| matches!(byte, b' '..=b'~' | b'\n' | b'\t');
        if !self.escaped || bytes.iter().all(is_plain) {
            return open_or(self.out().write(bytes), bytes.len());
        }
        // Callers write whole characters; what is none passes as it is.
        let text = match std::str::from_utf8(bytes) {
            Ok(text) => text,
            Err(wrong) if wrong.valid_up_to() > 0 => {
                std::str::from_utf8(&bytes[..wrong.valid_up_to()]).unwrap_or_default()
            }
            Err(_) => return open_or(self.out().write(bytes), bytes.len()),
        };
        let written = write!(self.out(), "{}", EscapedLines(text));
        open_or(written.map(|()| text.len()), text.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        open_or(self.out().flush(), ())
    }
}

/// The outcome of writing, or `gone` if nobody reads any more.
fn open_or<T>(written: io::Result<T>, gone: T) -> io::Result<T> {
    match written {
        Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Ok(gone),
        other => other,
    }
}

/// A line on standard error, its control characters escaped; where that cannot be written, nobody is there to be
/// told.
macro_rules! say {
    ($($words:tt)*) => {{
        use std::io::Write as _;
        let words = format!($($words)*);
        let _ = writeln!(std::io::stderr(), "{}", touchoff::EscapedLines(&words));
    }};
}

/// Shows a diagnostic of the compiler on standard error, in colours where that is a terminal.
pub(crate) fn show(diagnostic: &Diagnostic, sources: &Sources) {
    let plain = diagnostic.render(sources, false);
    let escaped = EscapedLines(&plain).to_string();
    // Colours are control characters too: they are left out where there are others.
    let colours = io::stderr().is_terminal() && escaped == plain;
    let shown = if colours { diagnostic.render(sources, true) } else { escaped };
    let _ = writeln!(io::stderr(), "{shown}\n");
}

/// Writes a whole file, in place of an old one once it is on the disk.
pub(crate) fn write_file(file: &Path, bytes: impl AsRef<[u8]>) -> Result<(), Failure> {
    AtomicFile::write(file, bytes).map_err(|source| unwritable(file, source))
}

/// The failure to write a file.
pub(crate) fn unwritable(file: &Path, source: io::Error) -> Failure {
    Failure::Unwritable { file: file.display().to_string(), source }
}

/// Refuses outputs that are inputs, before anything is written: the same file under any name, by links too, and files
/// that a tool's file mounts.
///
/// # Errors
/// [`Failure::IsInput`] for the first of them.
pub(crate) fn refuse_inputs<'a>(
    outputs: impl IntoIterator<Item = &'a Path>,
    inputs: impl IntoIterator<Item = &'a Path>,
) -> Result<(), Failure> {
    // What is not there is no input.
    let outputs: Vec<&Path> = outputs.into_iter().filter(|output| output.is_file()).collect();
    if outputs.is_empty() {
        return Ok(());
    }
    for input in inputs {
        for read in std::iter::once(input.to_owned()).chain(mounted(input)) {
            if let Some(output) = outputs.iter().find(|output| is_same_file(output, &read)) {
                let [output, input] = [*output, &read].map(|file| file.display().to_string());
                return Err(Failure::IsInput { output, input });
            }
        }
    }
    Ok(())
}

/// The files that a tool's file mounts, as far as it can be read.
fn mounted(tool: &Path) -> Vec<PathBuf> {
    if tool.extension().is_none_or(|extension| extension != "tool") {
        return Vec::new();
    }
    let Ok(source) = Source::read(tool) else { return Vec::new() };
    let compiled = tool_dsl::compile(&source);
    compiled.sources.all().iter().filter_map(|source| source.path().map(Path::to_owned)).collect()
}

/// Returns whether two paths lead to one regular file that is there.
#[cfg(unix)]
fn is_same_file(one: &Path, other: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    let place = |path: &Path| {
        let file = std::fs::metadata(path).ok().filter(|file| file.is_file())?;
        Some((file.dev(), file.ino()))
    };
    place(one).is_some_and(|one| Some(one) == place(other))
}

#[cfg(not(unix))]
fn is_same_file(one: &Path, other: &Path) -> bool {
    let place = |path: &Path| path.canonicalize().ok().filter(|path| path.is_file());
    place(one).is_some_and(|one| Some(one) == place(other))
}
