//! Reader of a PLY file: the header, then the body, one element after another.

use crate::cancellation;
use crate::mesh::location::{SourceLocation, Tokens, number, printable};
use crate::mesh::ply::error::PlyError;
use std::collections::HashSet;

#[derive(Clone, Copy, PartialEq)]
enum Encoding {
    Ascii,
    LittleEndian,
    BigEndian,
}

#[derive(Clone, Copy)]
enum Type {
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

    fn bytes(self) -> usize {
        match self {
            Type::I8 | Type::U8 => 1,
            Type::I16 | Type::U16 => 2,
            Type::I32 | Type::U32 | Type::F32 => 4,
            Type::F64 => 8,
        }
    }
}

struct Property<'a> {
    pub(super) name: &'a [u8],
    /// The type of the length of a list; `None` for a scalar.
    length: Option<Type>,
    /// The type of the value, or of each item of a list.
    value: Type,
}

pub(super) struct Element<'a> {
    pub(super) name: &'a [u8],
    pub(super) count: usize,
    properties: Vec<Property<'a>>,
}

impl Element<'_> {
    /// Returns the index of the scalar property with the given name.
    pub(super) fn number(&self, name: &str) -> Option<usize> {
        self.properties.iter().position(|p| p.name == name.as_bytes() && p.length.is_none())
    }

    /// Returns the index of the list property with the given name.
    pub(super) fn list(&self, name: &str) -> Option<usize> {
        self.properties.iter().position(|p| p.name == name.as_bytes() && p.length.is_some())
    }

    /// Returns the minimum number of bytes for all of these elements, to check `count` against the file length.
    fn min_bytes(&self, encoding: Encoding) -> u128 {
        let count = self.count as u128;
        if encoding == Encoding::Ascii {
            // A digit and a separator per value, except that the last value of the file needs no separator.
            return (2 * count * self.properties.len() as u128).saturating_sub(1);
        }
        let sizes = self.properties.iter().map(|p| p.length.unwrap_or(p.value).bytes() as u128);
        count * sizes.sum::<u128>()
    }
}

pub(super) struct Header<'a> {
    encoding: Encoding,
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
pub(super) fn read_header<'a>(
    bytes: &'a [u8],
    name: &str,
) -> Result<(Header<'a>, Tokens<'a>), PlyError> {
    if !begins(bytes) {
        return Err(PlyError::NotPly { file: name.to_owned() });
    }
    let mut lines = Lines { tokens: Tokens::new(bytes), name };
    lines.tokens.skip_line();
    // The first line shows how lines end; a CR alone may be followed by a body that begins with LF.
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
        let rest = lines.tokens.rest;
        let blanks = rest.iter().take_while(|byte| matches!(byte, b' ' | b'\t')).count();
        let rest = &rest[blanks..];
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
        let count = self
            .word("how many elements there are", |word| str::from_utf8(word).ok()?.parse().ok())?;
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

/// One element: the requested numbers and the items of the requested list.
pub(super) struct Record<'r, const N: usize> {
    pub(super) location: SourceLocation,
    pub(super) index: usize,
    pub(super) numbers: [f64; N],
    pub(super) items: &'r [f64],
}

/// A cursor over the file after its header.
pub(super) struct Body<'a, 'n> {
    name: &'n str,
    encoding: Encoding,
    tokens: Tokens<'a>,
    length: usize,
    index: usize,
}

impl<'a, 'n> Body<'a, 'n> {
    pub(super) fn new(bytes: &'a [u8], name: &'n str) -> Result<(Header<'a>, Self), PlyError> {
        let (header, tokens) = read_header(bytes, name)?;
        let encoding = header.encoding;
        Ok((header, Body { name, encoding, tokens, length: bytes.len(), index: 0 }))
    }

    /// Reads all elements of one kind, which must be next in the file. `visit` receives the numbers of the properties
    /// at the indices `requested` and the items of the list property at index `list`; `None` requests nothing.
    pub(super) fn read<const N: usize>(
        &mut self,
        element: &Element,
        requested: [Option<usize>; N],
        list: Option<usize>,
        mut visit: impl FnMut(Record<N>) -> Result<(), PlyError>,
    ) -> Result<(), PlyError> {
        // A wrong count must not reserve memory, or take long to be found out.
        let (min_bytes, found) = (element.min_bytes(self.encoding), self.tokens.rest.len());
        if min_bytes > found as u128 {
            let (file, element, count) = (self.file(), printable(element.name), element.count);
            return Err(PlyError::Promised { file, element, count, min_bytes, found });
        }
        // Any count of nothing takes no bytes, and would take as long as it says.
        if element.properties.is_empty() {
            return Ok(());
        }
        // For each property of the file, where its number is to go.
        let slots: Vec<Option<usize>> = (0..element.properties.len())
            .map(|property| requested.iter().position(|&requested| requested == Some(property)))
            .collect();
        let mut items = Vec::new();
        for index in 0..element.count {
            cancellation::check();
            self.index = index;
            let location = self.start();
            let mut numbers = [0.0; N];
            items.clear();
            for (at, (property, slot)) in element.properties.iter().zip(&slots).enumerate() {
                match (property.length, slot) {
                    (Some(length), _) => {
                        let output = (list == Some(at)).then_some(&mut items);
                        self.list(element, property, length, location, output)?;
                    }
                    (None, Some(slot)) => {
                        numbers[*slot] = self.number(element, property, property.value)?;
                    }
                    (None, None) => self.skip(element, property, 1)?,
                }
            }
            self.end_line()?;
            visit(Record { location, index, numbers, items: &items })?;
        }
        Ok(())
    }

    /// Checks that the file ends here.
    pub(super) fn end(mut self) -> Result<(), PlyError> {
        let location = self.start();
        if self.tokens.rest.is_empty() {
            Ok(())
        } else {
            Err(PlyError::Trailing { file: self.file(), location })
        }
    }

    fn file(&self) -> String {
        self.name.to_owned()
    }

    fn start(&mut self) -> SourceLocation {
        if self.encoding == Encoding::Ascii {
            self.tokens.skip_space();
        }
        self.location()
    }

    fn location(&self) -> SourceLocation {
        match self.encoding {
            Encoding::Ascii => SourceLocation::Line(self.tokens.line),
            _ => SourceLocation::Byte(self.length - self.tokens.rest.len()),
        }
    }

    fn end_line(&mut self) -> Result<(), PlyError> {
        if self.encoding == Encoding::Ascii
            && let Some(word) = self.tokens.next_on_line()
        {
            return Err(self.expected("the end of the line".to_owned(), Some(word)));
        }
        Ok(())
    }

    fn list(
        &mut self,
        element: &Element,
        property: &Property,
        length: Type,
        location: SourceLocation,
        output: Option<&mut Vec<f64>>,
    ) -> Result<(), PlyError> {
        let value = self.number(element, property, length)?;
        let Some(count) = to_u32(value) else {
            return Err(PlyError::Value {
                file: self.file(),
                location,
                element: printable(element.name),
                index: self.index,
                property: format!("the length of {}", printable(property.name)),
                value,
                rule: "a whole number, 0 or more, below 2^32",
            });
        };
        match output {
            None => self.skip(element, property, count as usize),
            Some(items) => (0..count).try_for_each(|_| {
                items.push(self.number(element, property, property.value)?);
                Ok(())
            }),
        }
    }

    fn number(
        &mut self,
        element: &Element,
        property: &Property,
        kind: Type,
    ) -> Result<f64, PlyError> {
        if self.encoding == Encoding::Ascii {
            let word = self.word(element, property)?;
            return number(word).ok_or_else(|| self.no_number(property, Some(word)));
        }
        Ok(match kind {
            Type::I8 => f64::from(i8::from_le_bytes(self.bytes(element)?)),
            Type::U8 => f64::from(u8::from_le_bytes(self.bytes(element)?)),
            Type::I16 => f64::from(i16::from_le_bytes(self.bytes(element)?)),
            Type::U16 => f64::from(u16::from_le_bytes(self.bytes(element)?)),
            Type::I32 => f64::from(i32::from_le_bytes(self.bytes(element)?)),
            Type::U32 => f64::from(u32::from_le_bytes(self.bytes(element)?)),
            Type::F32 => f64::from(f32::from_le_bytes(self.bytes(element)?)),
            Type::F64 => f64::from_le_bytes(self.bytes(element)?),
        })
    }

    /// Skips `count` values of a property.
    fn skip(
        &mut self,
        element: &Element,
        property: &Property,
        count: usize,
    ) -> Result<(), PlyError> {
        if self.encoding == Encoding::Ascii {
            return (0..count).try_for_each(|_| self.word(element, property).map(drop));
        }
        let bytes = count.saturating_mul(property.value.bytes());
        self.tokens.rest = self.tokens.rest.get(bytes..).ok_or_else(|| self.truncated(element))?;
        Ok(())
    }

    fn word(&mut self, element: &Element, property: &Property) -> Result<&'a [u8], PlyError> {
        match self.tokens.next_on_line() {
            Some(word) => Ok(word),
            None if self.tokens.rest.trim_ascii().is_empty() => Err(self.truncated(element)),
            None => Err(self.no_number(property, None)),
        }
    }

    /// Reads the next `N` bytes and returns them in little-endian order.
    fn bytes<const N: usize>(&mut self, element: &Element) -> Result<[u8; N], PlyError> {
        let Some((bytes, rest)) = self.tokens.rest.split_first_chunk() else {
            return Err(self.truncated(element));
        };
        self.tokens.rest = rest;
        let mut bytes = *bytes;
        if self.encoding == Encoding::BigEndian {
            bytes.reverse();
        }
        Ok(bytes)
    }

    fn no_number(&self, property: &Property, found: Option<&[u8]>) -> PlyError {
        self.expected(format!("a number for `{}`", printable(property.name)), found)
    }

    fn expected(&self, expected: String, found: Option<&[u8]>) -> PlyError {
        let found =
            found.map_or("the end of the line".to_owned(), |w| format!("`{}`", printable(w)));
        PlyError::Expected { file: self.file(), line: self.tokens.line, expected, found }
    }

    fn truncated(&self, element: &Element) -> PlyError {
        let location = match self.location() {
            SourceLocation::Byte(_) => SourceLocation::Byte(self.length),
            line => line,
        };
        PlyError::Ended {
            file: self.file(),
            location,
            element: printable(element.name),
            index: self.index,
            count: element.count,
        }
    }
}

/// Converts a number to `u32`, if it is integral and in range.
pub(super) fn to_u32(value: f64) -> Option<u32> {
    let integer = value as u32;
    (f64::from(integer) == value).then_some(integer)
}
