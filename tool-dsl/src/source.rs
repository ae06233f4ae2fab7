//! The text that a tool is written in, and places in it.

use std::io;
use std::path::Path;

use proc_macro2::{Delimiter, Spacing, TokenStream, TokenTree};

/// A stretch of a source's text, in bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Span {
    /// Offset of the first byte.
    pub start: usize,
    /// Offset behind the last byte.
    pub end: usize,
}

impl Span {
    /// The stretch from the start of `self` to the end of `other`.
    pub fn to(self, other: Span) -> Span {
        Span { start: self.start, end: other.end }
    }
}

/// A tool's text with the name it is known by.
#[derive(Clone, Debug)]
pub struct Source {
    /// A path, or a word for text that is not from a file.
    pub name: String,
    /// The text itself.
    pub text: String,
    tokens: Vec<(Span, proc_macro2::Span)>,
}

impl Source {
    /// A source from the text of a file.
    pub fn new(name: impl Into<String>, text: impl Into<String>) -> Source {
        Source { name: name.into(), text: text.into(), tokens: Vec::new() }
    }

    /// A source from a file, known by its path.
    pub fn read(path: impl AsRef<Path>) -> io::Result<Source> {
        let text = std::fs::read_to_string(&path)?;
        Ok(Source::new(path.as_ref().display().to_string(), text))
    }

    /// A source from the tokens inside `tool! { … }`: written out one space after each unless
    /// punctuation is joined, each token remembering where it came from.
    pub fn from_tokens(tokens: TokenStream) -> Source {
        let mut source = Source::new("tool!", "");
        source.write_out(tokens);
        source
    }

    fn write_out(&mut self, tokens: TokenStream) {
        let mut tokens = tokens.into_iter().peekable();
        while let Some(token) = tokens.next() {
            match token {
                // `///` comments reach a macro as `#[doc = "…"]`.
                TokenTree::Punct(hash) if hash.as_char() == '#' => {
                    let doc = |t: &TokenTree| matches!(t, TokenTree::Group(g) if g.delimiter() == Delimiter::Bracket && g.stream().to_string().starts_with("doc"));
                    if matches!(tokens.peek(), Some(TokenTree::Punct(p)) if p.as_char() == '!') {
                        let bang = tokens.next();
                        if tokens.peek().is_some_and(doc) {
                            tokens.next();
                            continue;
                        }
                        self.push("#", hash.span(), true);
                        if let Some(bang) = bang {
                            self.push(&bang.to_string(), bang.span(), true);
                        }
                        continue;
                    }
                    if tokens.peek().is_some_and(doc) {
                        tokens.next();
                        continue;
                    }
                    self.push("#", hash.span(), true);
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
                    // `. 5` would not be seen to be `.5`.
                    let apart = punct.spacing() == Spacing::Alone && punct.as_char() != '.';
                    self.push(&punct.as_char().to_string(), punct.span(), apart);
                }
                other => self.push(&other.to_string(), other.span(), true),
            }
        }
    }

    fn push(&mut self, token: &str, span: proc_macro2::Span, apart: bool) {
        let start = self.text.len();
        self.text.push_str(token);
        self.tokens.push((Span { start, end: self.text.len() }, span));
        if apart {
            self.text.push(' ');
        }
    }

    /// The span of the Rust token at a place, for a source made of tokens.
    pub fn token_at(&self, span: Span) -> Option<proc_macro2::Span> {
        let after = self.tokens.partition_point(|(place, _)| place.end <= span.start);
        self.tokens.get(after).or(self.tokens.last()).map(|(_, token)| *token)
    }
}
