//! Reader of a PLY file's body, one element after another.

use super::PlyError;
use super::header::{self, Element, Encoding, Header, Property, Type};
use crate::mesh::location::{SourceLocation, Tokens, number, printable};

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
        let (header, tokens) = header::read(bytes, name)?;
        let encoding = header.encoding;
        Ok((header, Body { name, encoding, tokens, length: bytes.len(), index: 0 }))
    }

    /// Reads all elements of one kind, which must be next in the file. `visit` receives the numbers of
    /// the properties at the indices `requested` and the items of the list property at index `list`;
    /// `None` requests nothing.
    pub(super) fn read<const N: usize>(
        &mut self,
        element: &Element,
        requested: [Option<usize>; N],
        list: Option<usize>,
        mut visit: impl FnMut(Record<N>) -> Result<(), PlyError>,
    ) -> Result<(), PlyError> {
        let (min_bytes, found) = (element.min_bytes(self.encoding), self.tokens.rest.len());
        if min_bytes > found as u128 {
            let (file, element, count) = (self.file(), printable(element.name), element.count);
            return Err(PlyError::Promised { file, element, count, min_bytes, found });
        }
        if element.properties.is_empty() {
            return Ok(());
        }
        let slots: Vec<Option<usize>> = (0..element.properties.len())
            .map(|property| requested.iter().position(|&requested| requested == Some(property)))
            .collect();
        let mut items = Vec::new();
        for index in 0..element.count {
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

    pub(super) fn file(&self) -> String {
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
