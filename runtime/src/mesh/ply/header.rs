//! Reader of a PLY file's header.

use super::PlyError;
use crate::mesh::location::{Tokens, printable};
use std::collections::HashSet;

#[derive(Clone, Copy, PartialEq)]
pub(super) enum Encoding {
    Ascii,
    LittleEndian,
    BigEndian,
}

#[derive(Clone, Copy)]
pub(super) enum Type {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Type {
    fn named(word: &[u8]) -> Option<Type> {
        Some(match word {
            b"char" | b"int8" => Type::I8,
            b"uchar" | b"uint8" => Type::U8,
            b"short" | b"int16" => Type::I16,
            b"ushort" | b"uint16" => Type::U16,
            b"int" | b"int32" => Type::I32,
            b"uint" | b"uint32" => Type::U32,
            b"float" | b"float32" => Type::F32,
            b"double" | b"float64" => Type::F64,
            _ => return None,
        })
    }

    pub(super) fn bytes(self) -> usize {
        match self {
            Type::I8 | Type::U8 => 1,
            Type::I16 | Type::U16 => 2,
            Type::I32 | Type::U32 | Type::F32 => 4,
            Type::F64 => 8,
        }
    }
}

pub(super) struct Property<'a> {
    pub(super) name: &'a [u8],
    /// The type of the length of a list; `None` for a scalar.
    pub(super) length: Option<Type>,
    /// The type of the value, or of each item of a list.
    pub(super) value: Type,
}

pub(super) struct Element<'a> {
    pub(super) name: &'a [u8],
    pub(super) count: usize,
    pub(super) properties: Vec<Property<'a>>,
}

impl Element<'_> {
    /// Returns the index of the scalar property with the given name.
    pub(super) fn number(&self, name: &str) -> Option<usize> {
        let matches = |p: &Property| p.name == name.as_bytes() && p.length.is_none();
        self.properties.iter().position(matches)
    }

    /// Returns the index of the list property with the given name.
    pub(super) fn list(&self, name: &str) -> Option<usize> {
        let matches = |p: &Property| p.name == name.as_bytes() && p.length.is_some();
        self.properties.iter().position(matches)
    }

    /// Returns the minimum number of bytes for all of these elements, to check `count` against the file
    /// length.
    pub(super) fn min_bytes(&self, encoding: Encoding) -> u128 {
        let count = self.count as u128;
        if encoding == Encoding::Ascii {
            // A digit and a separator per value, except that the last value of the file needs no
            // separator.
            return (2 * count * self.properties.len() as u128).saturating_sub(1);
        }
        let sizes = self.properties.iter().map(|p| p.length.unwrap_or(p.value).bytes() as u128);
        count * sizes.sum::<u128>()
    }
}

pub(super) struct Header<'a> {
    pub(super) encoding: Encoding,
    pub(super) elements: Vec<Element<'a>>,
}

impl<'a> Header<'a> {
    pub(super) fn element(&self, name: &str) -> Option<&Element<'a>> {
        self.elements.iter().find(|element| element.name == name.as_bytes())
    }
}

/// Returns whether a file begins as PLY does.
pub(in crate::mesh) fn begins(bytes: &[u8]) -> bool {
    let mut tokens = Tokens::new(bytes);
    tokens.rest.starts_with(b"ply")
        && tokens.next() == Some(b"ply")
        && tokens.next_on_line().is_none()
}

/// Reads the header and returns it with the tokens that follow it.
pub(super) fn read<'a>(bytes: &'a [u8], name: &str) -> Result<(Header<'a>, Tokens<'a>), PlyError> {
    if !begins(bytes) {
        return Err(PlyError::NotPly { file: name.to_owned() });
    }
    let mut lines = Lines { tokens: Tokens::new(bytes), name };
    lines.tokens.skip_line();
    let ends_in_cr = matches!(lines.tokens.rest, [b'\r', next, ..] if *next != b'\n');
    let mut encoding = None;
    let mut elements: Vec<Element> = Vec::new();
    // The names of all elements, and of the properties of the last.
    let (mut names, mut properties) = (HashSet::new(), HashSet::new());
    loop {
        lines.tokens.skip_space();
        let keyword = lines.tokens.next_on_line();
        match keyword {
            Some(b"comment" | b"obj_info") => lines.tokens.skip_line(),
            Some(b"format") if encoding.is_some() => return Err(lines.duplicate(b"format")),
            Some(b"format") => encoding = Some(lines.format()?),
            Some(b"element") => {
                let element = lines.element()?;
                if !names.insert(element.name) {
                    return Err(lines.duplicate(element.name));
                }
                properties.clear();
                elements.push(element);
            }
            Some(b"property") => {
                let property = lines.property()?;
                let Some(element) = elements.last_mut() else {
                    return Err(lines.expected("`element` before the first `property`", keyword));
                };
                if !properties.insert(property.name) {
                    return Err(lines.duplicate(property.name));
                }
                element.properties.push(property);
            }
            Some(b"end_header") => break,
            _ => return Err(lines.expected("a line of the header, or `end_header`", keyword)),
        }
        lines.end()?;
    }
    let Some(encoding) = encoding else {
        return Err(lines.expected("`format` before the end of the header", Some(b"end_header")));
    };
    if encoding == Encoding::Ascii {
        lines.end()?;
    } else {
        // The first byte of the body may look like part of the line end, so strip exactly one.
        let line_end: &[u8] = if ends_in_cr { b"\r" } else { b"\r\n" };
        let is_blank = |byte: &u8| *byte == b' ' || *byte == b'\t';
        let rest = lines.tokens.rest;
        let rest = &rest[rest.iter().take_while(|byte| is_blank(byte)).count()..];
        let body = rest.strip_prefix(line_end).or_else(|| rest.strip_prefix(b"\n"));
        let Some(body) = body else {
            return Err(lines.expected("the end of the line", Some(rest)));
        };
        lines.tokens.rest = body;
    }
    Ok((Header { encoding, elements }, lines.tokens))
}

/// A parser for the header's lines, with one function per phrase of the grammar.
struct Lines<'a, 'n> {
    tokens: Tokens<'a>,
    name: &'n str,
}

impl<'a> Lines<'a, '_> {
    fn expected(&self, expected: &str, found: Option<&[u8]>) -> PlyError {
        let location = if self.tokens.rest.is_empty() { "the file" } else { "the line" };
        PlyError::Expected {
            file: self.name.to_owned(),
            line: self.tokens.line,
            expected: expected.to_owned(),
            found: found
                .map_or(format!("the end of {location}"), |word| format!("`{}`", printable(word))),
        }
    }

    fn duplicate(&self, name: &[u8]) -> PlyError {
        PlyError::Duplicate {
            file: self.name.to_owned(),
            line: self.tokens.line,
            name: printable(name),
        }
    }

    /// Reads a word and converts it with `parse`, or returns an error that names the expected content.
    fn word<T>(
        &mut self,
        expected: &str,
        parse: impl FnOnce(&'a [u8]) -> Option<T>,
    ) -> Result<T, PlyError> {
        let word = self.tokens.next_on_line();
        word.and_then(parse).ok_or_else(|| self.expected(expected, word))
    }

    fn end(&mut self) -> Result<(), PlyError> {
        match self.tokens.next_on_line() {
            None => Ok(()),
            word => Err(self.expected("the end of the line", word)),
        }
    }

    fn format(&mut self) -> Result<Encoding, PlyError> {
        let expected = "`ascii`, `binary_little_endian` or `binary_big_endian`";
        let encoding = self.word(expected, |word| match word {
            b"ascii" => Some(Encoding::Ascii),
            b"binary_little_endian" => Some(Encoding::LittleEndian),
            b"binary_big_endian" => Some(Encoding::BigEndian),
            _ => None,
        })?;
        self.word("the version 1.0", |word| (word == b"1.0").then_some(encoding))
    }

    fn element(&mut self) -> Result<Element<'a>, PlyError> {
        let name = self.word("the element's name", Some)?;
        let parse_count = |word: &[u8]| str::from_utf8(word).ok()?.parse().ok();
        let count = self.word("how many elements there are", parse_count)?;
        Ok(Element { name, count, properties: Vec::new() })
    }

    fn property(&mut self) -> Result<Property<'a>, PlyError> {
        let kind = self.word("a type, such as `float`, or `list`", |word| match word {
            b"list" => Some(None),
            word => Type::named(word).map(Some),
        })?;
        let (length, value) = match kind {
            Some(value) => (None, value),
            None => {
                let length = self.word("the type of the list's length", Type::named)?;
                (Some(length), self.word("the type of the list's items", Type::named)?)
            }
        };
        Ok(Property { name: self.word("the property's name", Some)?, length, value })
    }
}
