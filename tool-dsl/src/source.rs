//! The source text of a tool, and locations in it.

use proc_macro2::{Delimiter, Spacing, TokenStream, TokenTree};
use std::collections::BTreeMap;
use std::ffi::OsStr;
use std::fs::File;
use std::io::{self, Read};
use std::path::{Component, Path, PathBuf};
use std::sync::Arc;

/// The length of the longest text that is read, in bytes.
pub const MAX_SOURCE_BYTES: usize = 1 << 20;

/// Reads the text of a file.
///
/// # Errors
/// If the path is not a regular file or is a temporary one, the text is longer than [`MAX_SOURCE_BYTES`] or not UTF-8, or reading
/// fails.
fn text(path: &Path) -> io::Result<String> {
    let wrong = |why: String| io::Error::new(io::ErrorKind::InvalidData, why);
    let kind = std::fs::metadata(path)?;
    if path.canonicalize()?.file_name().is_some_and(is_temporary) {
        let why = "its name is that of a temporary file, which the next output in its folder removes: rename it";
        return Err(wrong(why.to_owned()));
    }
    // Checked before opening: opening a pipe blocks until there is a writer.
    if !kind.is_file() && !kind.is_dir() {
        return Err(wrong("it is no regular file: save the text as a file first".to_owned()));
    }
    if kind.len() > MAX_SOURCE_BYTES as u64 {
        return Err(wrong(format!("it is longer than {MAX_SOURCE_BYTES} bytes")));
    }
    let mut bytes = Vec::new();
    // A file of the system may have no length and no end.
    File::open(path)?.take(kind.len()).read_to_end(&mut bytes)?;
    String::from_utf8(bytes).map_err(|error| {
        let good = &error.as_bytes()[..error.utf8_error().valid_up_to()];
        let line = 1 + good.iter().filter(|byte| **byte == b'\n').count();
        wrong(format!("line {line} is no UTF-8 text: save it as UTF-8"))
    })
}

/// Returns whether a name is one of those of temporary files, as `touchoff::AtomicFile` gives them.
fn is_temporary(name: &OsStr) -> bool {
    let digits =
        name.to_str().and_then(|name| name.strip_prefix(".touchoff-")?.strip_suffix(".tmp"));
    digits.is_some_and(|digits| digits.len() == 16 && digits.bytes().all(|b| b.is_ascii_hexdigit()))
}

/// Returns the folder of a file.
fn folder(path: &Path) -> &Path {
    path.parent().unwrap_or(Path::new(""))
}

/// A byte range of text: in one source, or in all [`Sources`] concatenated.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Span {
    /// The offset of the first byte.
    pub start: usize,
    /// The offset after the last byte.
    pub end: usize,
}

impl Span {
    /// Returns the range from the start of `self` to the end of `other`.
    pub fn to(self, other: Span) -> Span {
        Span { start: self.start, end: other.end }
    }

    /// Returns the same range in a text that begins at `base`.
    pub fn offset_by(self, base: usize) -> Span {
        Span { start: self.start + base, end: self.end + base }
    }
}

/// The text of a tool, with the name shown for it.
#[derive(Clone, Debug)]
pub struct Source {
    /// A path, or a keyword for text that does not come from a file.
    pub name: String,
    /// The text itself.
    pub text: String,
    /// The offset at which it begins among all sources of a tool.
    pub(crate) base: usize,
    /// The file that contains the text.
    path: Option<PathBuf>,
    /// The folder that contains all files that may be mounted, if it is not the text's own folder.
    root: Option<PathBuf>,
    /// The files that may be mounted, by path, if they are not read from the file system.
    files: Option<Arc<BTreeMap<PathBuf, String>>>,
    /// The range and origin of each token, for a text made from Rust tokens.
    tokens: Option<Vec<(Span, proc_macro2::Span)>>,
    /// The location of the `mount` that requested the text.
    by: Option<Span>,
}

impl Source {
    /// Returns a source with the given name and text.
    pub fn new(name: impl Into<String>, text: impl Into<String>) -> Source {
        Source {
            name: name.into(),
            text: text.into(),
            base: 0,
            path: None,
            root: None,
            files: None,
            tokens: None,
            by: None,
        }
    }

    /// Reads a source from a file; the path is its name.
    ///
    /// # Errors
    /// If the file cannot be read, is longer than [`MAX_SOURCE_BYTES`] or is not UTF-8.
    pub fn read(path: impl AsRef<Path>) -> io::Result<Source> {
        Source::read_as(path.as_ref().display().to_string(), path.as_ref())
    }

    /// Reads a source from a file under another name.
    ///
    /// # Errors
    /// As for [`Source::read`].
    pub fn read_as(name: impl Into<String>, path: &Path) -> io::Result<Source> {
        Ok(Source::new(name, text(path)?).with_path(path))
    }

    /// Sets the file that contains the text. Paths of mounted files are relative to its folder.
    #[must_use]
    pub fn with_path(mut self, path: impl Into<PathBuf>) -> Source {
        self.path = Some(path.into());
        self
    }

    /// Sets the folder that must contain all mounted files. The default is
    /// [that of the file](Source::with_path).
    #[must_use]
    pub fn with_root(mut self, root: impl Into<PathBuf>) -> Source {
        self.root = Some(root.into());
        self
    }

    /// Sets the texts of the files that may be mounted, by path, for a system without files. The text's own
    /// [path](Source::with_path) is one among them. Nothing is read from the file system then.
    #[must_use]
    pub fn with_files(mut self, files: Arc<BTreeMap<PathBuf, String>>) -> Source {
        self.files = Some(files);
        self
    }

    /// Returns the folder that must contain all mounted files.
    fn root(&self) -> Option<&Path> {
        self.root.as_deref().or_else(|| self.path.as_deref().map(folder))
    }

    /// Makes a source from the tokens inside `tool! { … }`. A space follows each token, except between joined
    /// punctuation. Each token keeps its origin.
    pub fn from_tokens(tokens: TokenStream) -> Source {
        let mut source = Source::new("tool!", "");
        source.tokens = Some(Vec::new());
        source.write_out(tokens);
        source
    }

    fn write_out(&mut self, tokens: TokenStream) {
        let mut tokens = tokens.into_iter().peekable();
        while let Some(token) = tokens.next() {
            match token {
                // `///` comments reach a macro as `#[doc = "…"]`.
                TokenTree::Punct(hash) if hash.as_char() == '#' => {
                    let bang = tokens.next_if(is_bang);
                    if tokens.next_if(is_doc_attribute).is_some() {
                        continue;
                    }
                    self.push("#", hash.span(), true);
                    if let Some(bang) = bang {
                        self.push("!", bang.span(), true);
                    }
                }
                TokenTree::Group(group) => {
                    let (open, close) = match group.delimiter() {
                        Delimiter::Parenthesis => ("(", ")"),
                        Delimiter::Brace => ("{", "}"),
                        Delimiter::Bracket => ("[", "]"),
                        Delimiter::None => ("", ""),
                    };
                    self.push(open, group.span_open(), true);
                    self.write_out(group.stream());
                    self.push(close, group.span_close(), true);
                }
                TokenTree::Punct(punct) => {
                    // A space in `. 5` would hide that the text was `.5`.
                    let is_separate = punct.spacing() == Spacing::Alone && punct.as_char() != '.';
                    self.push(&punct.as_char().to_string(), punct.span(), is_separate);
                }
                other => self.push(&other.to_string(), other.span(), true),
            }
        }
    }

    fn push(&mut self, token: &str, span: proc_macro2::Span, is_separate: bool) {
        let start = self.text.len();
        self.text.push_str(token);
        let token_span = Span { start, end: self.text.len() };
        self.tokens.get_or_insert_default().push((token_span, span));
        if is_separate {
            self.text.push(' ');
        }
    }

    /// Returns the first and the last Rust token of a location, for a source made of tokens.
    pub fn tokens_at(&self, span: Span) -> Option<[proc_macro2::Span; 2]> {
        let tokens = self.tokens.as_ref()?;
        let end = tokens.len().checked_sub(1)?;
        let first = tokens.partition_point(|(token_span, _)| token_span.end <= span.start).min(end);
        let end_index = tokens.partition_point(|(token_span, _)| token_span.start < span.end);
        Some([first, end_index.saturating_sub(1).max(first)].map(|at| tokens[at].1))
    }

    /// Returns the file that contains the text, if there is one.
    pub fn path(&self) -> Option<&Path> {
        self.path.as_deref()
    }

    /// Resolves a path that this text mentions.
    fn resolve_path(&self, file: &str) -> Option<MentionedFile> {
        let near = |path: &Path| folder(path).join(file);
        let shown = match self.tokens {
            Some(_) => file.to_owned(),
            None => near(Path::new(&self.name)).display().to_string(),
        };
        Some(MentionedFile { shown, path: near(self.path.as_deref()?) })
    }
}

/// Returns whether a token is the `!` of an inner attribute.
fn is_bang(token: &TokenTree) -> bool {
    matches!(token, TokenTree::Punct(punct) if punct.as_char() == '!')
}

/// Returns whether a token is the bracket of a doc comment's attribute.
fn is_doc_attribute(token: &TokenTree) -> bool {
    matches!(token, TokenTree::Group(group)
        if group.delimiter() == Delimiter::Bracket && group.stream().to_string().starts_with("doc"))
}

/// A file that a text mentions: its path to show, and the path to open.
pub(crate) struct MentionedFile {
    pub(crate) shown: String,
    pub(crate) path: PathBuf,
}

/// All texts that a tool consists of: its own, then the arguments given from outside, then the mounted files.
/// A [`Span`] is a range in their concatenation.
#[derive(Clone, Debug)]
pub struct Sources(Vec<Source>);

impl Sources {
    /// Makes the list from a tool's own text and its arguments.
    pub fn new(main: Source, arguments: impl IntoIterator<Item = Source>) -> Sources {
        let mut sources = Sources(Vec::new());
        for source in std::iter::once(main).chain(arguments) {
            sources.add(source);
        }
        sources
    }

    fn add(&mut self, mut source: Source) -> &Source {
        // The extra byte gives the position after each text's end an offset of its own.
        source.base = self.0.last().map_or(0, |last| last.base + last.text.len() + 1);
        let at = self.0.len();
        self.0.push(source);
        &self.0[at]
    }

    /// Returns the tool's own text.
    pub fn main(&self) -> &Source {
        &self.0[0]
    }

    /// Returns all texts, the tool's own first.
    pub fn all(&self) -> &[Source] {
        &self.0
    }

    /// Returns the source that contains a location, and the location in that source's own text.
    pub fn locate(&self, span: Span) -> (&Source, Span) {
        let after = self.0.partition_point(|source| source.base <= span.start).max(1);
        let source = &self.0[after - 1];
        let start = span.start - source.base;
        (source, Span { start, end: span.end.saturating_sub(source.base).max(start) })
    }

    /// Returns the text of a location.
    pub fn text(&self, span: Span) -> &str {
        let (source, span) = self.locate(span);
        source.text.get(span.start..span.end).unwrap_or_default()
    }

    /// Returns the first and last Rust tokens of a location. For a location in a mounted file they are those
    /// of the `mount` that requested it; `None` if that `mount` is itself in a file.
    pub fn tokens_at(&self, mut span: Span) -> Option<[proc_macro2::Span; 2]> {
        loop {
            let (source, inside) = self.locate(span);
            match (source.tokens_at(inside), source.by) {
                (None, Some(by)) => span = by,
                (token, _) => return token,
            }
        }
    }

    /// Returns the paths of the `.tool` files that were read.
    pub fn files(&self) -> impl Iterator<Item = &Path> {
        let files = self.0.iter().filter(|source| source.tokens.is_none());
        files.filter_map(|source| source.path.as_deref())
    }

    /// Resolves a path mentioned at a location. Returns `None` if the mentioning text has no file.
    pub(crate) fn resolve_path(&self, by: Span, file: &str) -> Option<MentionedFile> {
        self.locate(by).0.resolve_path(file)
    }

    /// Returns the folder that must contain mounted files, if it was [set](Source::with_root).
    pub(crate) fn given_root(&self) -> Option<&Path> {
        self.main().root.as_deref()
    }

    /// Returns whether a file lies below the folder that must contain mounted files, with links followed. For
    /// a file that does not exist, its name decides.
    pub(crate) fn may_mount(&self, path: &Path) -> bool {
        if self.main().files.is_some() {
            return without_steps_up(path).is_some();
        }
        let Some(root) = self.main().root() else { return false };
        let root = if root == Path::new("") { Path::new(".") } else { root };
        let real = |path: &Path| {
            let in_real_folder =
                || Ok(folder(path).canonicalize()?.join(path.file_name().unwrap_or_default()));
            path.canonicalize()
                .or_else(|_| in_real_folder())
                .or_else(|_: io::Error| std::path::absolute(path))
        };
        let (Ok(root), Ok(path_on_disk)) = (real(root), real(path)) else { return false };
        let leads_up = path_on_disk.components().any(|part| part == Component::ParentDir);
        path_on_disk.starts_with(root) && !leads_up
    }

    /// Reads a file that a `mount` mentions, unless it was read before.
    ///
    /// # Errors
    /// As for [`Source::read`].
    pub(crate) fn read(
        &mut self,
        by: Span,
        MentionedFile { shown, path }: MentionedFile,
    ) -> io::Result<&Source> {
        if let Some(files) = self.main().files.clone() {
            return self.read_from(&files, by, shown, &path);
        }
        let real = |path: &Path| path.canonicalize().unwrap_or_else(|_| path.to_owned());
        let path_on_disk = real(&path);
        let known = self.0.iter().position(|source| {
            source.tokens.is_none() && source.path().is_some_and(|path| real(path) == path_on_disk)
        });
        if let Some(known) = known {
            return Ok(&self.0[known]);
        }
        let source = Source::read_as(shown, &path)?;
        Ok(self.add(Source { by: Some(by), ..source }))
    }

    /// Takes a file that a `mount` mentions from the given ones, unless it was taken before.
    fn read_from(
        &mut self,
        files: &BTreeMap<PathBuf, String>,
        by: Span,
        shown: String,
        path: &Path,
    ) -> io::Result<&Source> {
        let path = without_steps_up(path).unwrap_or_default();
        let known = self.0.iter().position(|source| source.path() == Some(&*path));
        if let Some(known) = known {
            return Ok(&self.0[known]);
        }
        let text = files.get(&path).ok_or(io::ErrorKind::NotFound)?;
        Ok(self.add(Source { by: Some(by), ..Source::new(shown, text.as_str()).with_path(path) }))
    }
}

/// Removes the steps `.` and `..` from a relative path; `None` if it leads out of the folder that it begins in.
fn without_steps_up(path: &Path) -> Option<PathBuf> {
    let mut normal = PathBuf::new();
    for component in path.components() {
        match component {
            Component::Normal(name) => normal.push(name),
            Component::CurDir => {}
            Component::ParentDir if normal.pop() => {}
            Component::ParentDir | Component::RootDir | Component::Prefix(_) => return None,
        }
    }
    Some(normal)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Reading ends where the file ended when it was looked at: this one has no length, and its reads give bytes.
    #[test]
    #[cfg(target_os = "linux")]
    fn a_file_without_a_length_is_empty() {
        assert_eq!(text(Path::new("/proc/self/status")).expect("read"), "");
    }

    #[test]
    fn temporary_files_are_not_read() {
        let name = format!("touchoff-source-{}", std::process::id());
        let place = std::env::temp_dir().join(name);
        std::fs::create_dir_all(&place).expect("a folder");
        let file = place.join(".touchoff-0123456789abcdef.tmp");
        std::fs::write(&file, "tool").expect("written");
        let refused = text(&file).expect_err("a temporary file").to_string();
        std::fs::remove_dir_all(&place).expect("removed");
        assert!(refused.ends_with("removes: rename it"), "{refused}");
    }
}
