//! Outputs: standard output, standard error, and files.

use crate::failure::Failure;
use anstream::{AutoStream, ColorChoice};
use anstyle::Style;
use serde::Serialize;
use std::borrow::Cow;
use std::io::{self, BufWriter, IsTerminal, StdoutLock, Write};
use std::path::{Path, PathBuf};
use touchoff::{AtomicFile, Escaped, EscapedLines};
use touchoff_dsl::diagnostic::Diagnostic;
use touchoff_dsl::source::{Source, Sources};
use touchoff_import::{Library, files_in_folder};

/// A writer to standard output.
///
/// A reader that closes the pipe early is no failure: later output is discarded, and the command goes on to its
/// verdict. Any other error is a failure, such as a full disk; [`Write::flush`] at the end of a command reports the
/// last of them.
///
/// Control characters are escaped, except in raw bytes, so that a terminal does not obey names from files. Lines of text end after
/// [`MAX_LINE`] bytes; those of JSON are whole.
pub(crate) struct Output {
    out: Buffered,
    escaped: bool,
    /// Number of bytes of the current line of text.
    line: usize,
}

/// Number of bytes of a line of text above which the rest is left out: a name from a file may be of any length.
const MAX_LINE: usize = 16_384;

enum Buffered {
    /// Line by line, so that lines on standard error keep their order among them.
    Lines(StdoutLock<'static>),
    /// In blocks.
    Blocks(BufWriter<StdoutLock<'static>>),
}

impl Output {
    /// Returns an output for lines of text and of JSON.
    pub(crate) fn lines() -> Output {
        Output { out: Buffered::Lines(io::stdout().lock()), escaped: true, line: 0 }
    }

    /// Returns an output for very many lines.
    pub(crate) fn rows() -> Output {
        Output {
            out: Buffered::Blocks(BufWriter::new(io::stdout().lock())),
            escaped: true,
            line: 0,
        }
    }

    /// Returns an output for a file's content, byte for byte.
    pub(crate) fn bytes() -> Output {
        Output { escaped: false, ..Output::rows() }
    }

    /// Writes a row as a line of JSON.
    pub(crate) fn json(&mut self, row: &impl Serialize) -> Result<(), Failure> {
        let row = serde_json::to_string(row)?;
        Ok(open_or(writeln!(self.out(), "{}", Escaped(&row)), ())?)
    }

    /// Writes a text in a style, if standard output is a terminal that shows colours; otherwise without it.
    pub(crate) fn styled(&mut self, style: Style, text: &str) -> io::Result<()> {
        if AutoStream::choice(&io::stdout()) == ColorChoice::Never {
            return self.write_all(text.as_bytes());
        }
        let style_end = style.render_reset();
        let written = write!(self.out(), "{style}{}{style_end}", EscapedLines(text));
        open_or(written, ())
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
        if !self.escaped {
            return open_or(self.out().write(bytes), bytes.len());
        }
        // Callers write whole characters; bytes that are not UTF-8 pass unchanged.
        let text = match std::str::from_utf8(bytes) {
            Ok(text) => text,
            Err(wrong) if wrong.valid_up_to() > 0 => {
                std::str::from_utf8(&bytes[..wrong.valid_up_to()]).unwrap_or_default()
            }
            Err(_) => return open_or(self.out().write(bytes), bytes.len()),
        };
        for line in text.split_inclusive('\n') {
            let (content, end) = match line.strip_suffix('\n') {
                Some(content) => (content, "\n"),
                None => (line, ""),
            };
            let left = MAX_LINE.saturating_sub(self.line);
            let kept = &content[..content.floor_char_boundary(left)];
            // Said once a line, where its rest begins.
            let cut = if kept.len() < content.len() && left > 0 { LEFT_OUT } else { "" };
            self.line = if end.is_empty() { self.line.saturating_add(content.len()) } else { 0 };
            open_or(write!(self.out(), "{}{cut}{end}", EscapedLines(kept)), ())?;
        }
        Ok(text.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        open_or(self.out().flush(), ())
    }
}

/// The end of a line whose rest is left out.
const LEFT_OUT: &str = " … (the rest of this line is left out; `--json` has it)";

/// Returns lines without what is beyond the beginning and the end of a line that is longer than [`MAX_LINE`].
pub(crate) fn shortened(text: &str) -> Cow<'_, str> {
    const HALF: usize = MAX_LINE / 2;
    if text.len() <= MAX_LINE || text.lines().all(|line| line.len() <= MAX_LINE) {
        return Cow::Borrowed(text);
    }
    let lines = text.split_inclusive('\n').map(|line| {
        if line.len() <= MAX_LINE {
            return Cow::Borrowed(line);
        }
        let begin = &line[..line.floor_char_boundary(HALF)];
        let end = &line[line.ceil_char_boundary(line.len() - HALF)..];
        let bytes = line.len() - begin.len() - end.len();
        Cow::Owned(format!("{begin} … ({bytes} bytes left out) … {end}"))
    });
    Cow::Owned(lines.collect())
}

/// Returns the outcome of writing, or `gone` if the reader has closed the pipe.
pub(crate) fn open_or<T>(written: io::Result<T>, gone: T) -> io::Result<T> {
    match written {
        Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Ok(gone),
        other => other,
    }
}

/// Prints a line on standard error, with its control characters escaped, line breaks included: names from files have them, too. Write
/// errors are ignored, as there is no other place to report them.
macro_rules! message {
    ($($arguments:tt)*) => {{
        use std::io::Write as _;
        let text = format!($($arguments)*);
        let text = touchoff::Escaped(&text).to_string();
        let _ = writeln!(std::io::stderr(), "{}", $crate::output::shortened(&text));
    }};
}

/// Prints lines of the compiler on standard error, which has escaped what it shows of files.
pub(crate) fn show_lines(text: &str) {
    let _ = writeln!(io::stderr(), "{}", shortened(&EscapedLines(text).to_string()));
}

/// Shows a diagnostic of the compiler on standard error, in colours if that is a terminal.
pub(crate) fn show(diagnostic: &Diagnostic, sources: &Sources) {
    let plain = diagnostic.render(sources, false);
    let escaped = shortened(&EscapedLines(&plain).to_string()).into_owned();
    // Colours are control characters too, so they are left out if the text has others.
    let colours = io::stderr().is_terminal() && escaped == plain;
    let shown = if colours { diagnostic.render(sources, true) } else { escaped };
    let _ = writeln!(io::stderr(), "{shown}\n");
}

/// Writes a whole file, which replaces an old one once it is on the disk.
pub(crate) fn write_file(file: &Path, bytes: impl AsRef<[u8]>) -> Result<(), Failure> {
    AtomicFile::write(file, bytes).map_err(|source| unwritable(file, source))
}

/// Returns a file's extension in lower case.
pub(crate) fn extension(file: &Path) -> Option<String> {
    file.extension().and_then(|extension| extension.to_str()).map(str::to_ascii_lowercase)
}

/// Returns the last part of a path.
pub(crate) fn file_name(file: &Path) -> String {
    file.file_name().unwrap_or(file.as_os_str()).to_string_lossy().into_owned()
}

/// Returns the failure to read a file.
pub(crate) fn unreadable(file: &Path, source: io::Error) -> Failure {
    Failure::Unreadable { file: file.display().to_string(), source }
}

/// Returns the failure to write a file.
pub(crate) fn unwritable(file: &Path, source: io::Error) -> Failure {
    Failure::Unwritable { file: file.display().to_string(), source }
}

/// Refuses outputs that are inputs or one another, before anything is written. Files are compared, not names, so that links are
/// found; what an input lists is an input too ([`listed`]).
///
/// # Errors
/// [`Failure::IsInput`] or [`Failure::SameOutput`] for the first of them.
pub(crate) fn refuse_inputs<'a>(
    outputs: impl IntoIterator<Item = &'a Path>,
    inputs: impl IntoIterator<Item = &'a Path>,
) -> Result<(), Failure> {
    refuse_inputs_within(Path::new("/"), outputs, inputs)
}

/// Refuses outputs like [`refuse_inputs`]; what inputs list outside of `root` is not read.
///
/// # Errors
/// As [`refuse_inputs`].
pub(crate) fn refuse_inputs_within<'a>(
    root: &Path,
    outputs: impl IntoIterator<Item = &'a Path>,
    inputs: impl IntoIterator<Item = &'a Path>,
) -> Result<(), Failure> {
    let outputs: Vec<&Path> = outputs.into_iter().collect();
    for (index, output) in outputs.iter().enumerate() {
        let is_same = |other: &&Path| place(other) == place(output) || is_same_file(other, output);
        if outputs[..index].iter().any(is_same) {
            return Err(Failure::SameOutput { output: output.display().to_string() });
        }
    }
    // A file that does not exist yet is no input.
    let outputs: Vec<&Path> = outputs.into_iter().filter(|output| output.is_file()).collect();
    if outputs.is_empty() {
        return Ok(());
    }
    for input in inputs {
        for read in std::iter::once(input.to_owned()).chain(listed(input, root)) {
            if let Some(output) = outputs.iter().find(|output| is_same_file(output, &read)) {
                let [output, input] = [*output, &read].map(|file| file.display().to_string());
                return Err(Failure::IsInput { output, input });
            }
        }
    }
    Ok(())
}

/// Returns the files that are read for an input beside it, as far as they can be: those that a tool's file mounts, those that a tool
/// library lists, and of a folder its tools, with what they mount, and the list of their numbers.
fn listed(input: &Path, root: &Path) -> Vec<PathBuf> {
    if input.is_dir() {
        let files = files_in_folder(input);
        let mounted: Vec<PathBuf> = files.iter().flat_map(|file| listed(file, root)).collect();
        return files.into_iter().chain(mounted).collect();
    }
    match extension(input).as_deref() {
        Some("tool") => {
            let Ok(source) = Source::read(input) else { return Vec::new() };
            // The loader of the tool decides which files within the root it may mount.
            let compiled = touchoff_dsl::compile(&source.with_root(root));
            files_of(&compiled.sources).map(Path::to_owned).collect()
        }
        Some("fctl") => {
            let library = Library::read_within(input, root);
            library.map_or(Vec::new(), |library| library.listed_files().to_vec())
        }
        _ => Vec::new(),
    }
}

/// Returns the files of a tool's texts: its own, and those that it mounts.
pub(crate) fn files_of(sources: &Sources) -> impl Iterator<Item = &Path> {
    sources.all().iter().filter_map(Source::path)
}

/// Returns the place to which a file is written, which need not exist yet, with links followed.
fn place(output: &Path) -> PathBuf {
    let output = match output.canonicalize() {
        Ok(place) => return place,
        // A link that leads nowhere is kept, and its target is made.
        Err(_) => AtomicFile::target(output).unwrap_or_else(|_| output.to_owned()),
    };
    let folder = output.parent().filter(|folder| *folder != Path::new(""));
    match folder.unwrap_or(Path::new(".")).canonicalize() {
        Ok(folder) => folder.join(output.file_name().unwrap_or_default()),
        Err(_) => output,
    }
}

/// Returns whether two paths lead to the same existing regular file.
#[cfg(unix)]
fn is_same_file(one: &Path, other: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    let identity = |path: &Path| {
        let file = std::fs::metadata(path).ok().filter(|file| file.is_file())?;
        Some((file.dev(), file.ino()))
    };
    identity(one).is_some_and(|one| Some(one) == identity(other))
}

#[cfg(not(unix))]
fn is_same_file(one: &Path, other: &Path) -> bool {
    let identity = |path: &Path| path.canonicalize().ok().filter(|path| path.is_file());
    identity(one).is_some_and(|one| Some(one) == identity(other))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Files that a stranger's tool mounts outside of the root are not even opened.
    #[test]
    fn files_outside_of_the_root_are_not_listed() {
        let folder = tempfile::tempdir().expect("a folder");
        let inside = folder.path().join("inside");
        std::fs::create_dir(&inside).expect("a folder");
        let mounted = "tool Outer { units mm; profile { start (0, 0); arc to (0, 6) center (0, 3) as ball cutting; } \
                       niceness cutting: 1; }";
        std::fs::write(folder.path().join("outer.tool"), mounted).expect("written");
        let tool = inside.join("tool.tool");
        let mounting = "tool Inner { units mm; mount \"../outer.tool\" as outer; }";
        std::fs::write(&tool, mounting).expect("written");
        let count = |root: &Path| listed(&tool, root).len();
        assert_eq!((count(&inside), count(folder.path())), (1, 2));
    }

    #[test]
    fn long_lines_keep_their_beginning_and_their_end() {
        let name = "é".repeat(MAX_LINE);
        let text = format!("short\nerror: {name}: give another\n");
        let shown = shortened(&text);
        assert!(shown.starts_with("short\nerror: é"), "{}", &shown[..40]);
        assert!(shown.ends_with("é: give another\n"));
        assert!(shown.contains(" bytes left out) … ") && shown.len() < MAX_LINE + 200);
        assert_eq!(shortened("short\n"), "short\n");
    }
}
