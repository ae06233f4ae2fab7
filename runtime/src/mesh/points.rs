//! Reading clouds of points: PCD of the Point Cloud Library, and tables `x y z` (`.xyz`, `.txt`, `.asc`, `.pts` and `.csv`).

use super::is_valid_coordinate;
use super::location::printable;
use super::outlier::{Outlier, find_outlier};
use super::ply::OrientedPoints;
use nalgebra::{Point3, Vector3};

/// Largest difference from 1 of the norms of three columns that are taken for a normal: files have few decimals.
const UNIT_TOLERANCE: f64 = 0.02;

/// Names of the coordinates of a normal in PCD.
const NORMAL_FIELDS: [&str; 3] = ["normal_x", "normal_y", "normal_z"];

/// Names of the coordinates of a normal in the heading of a table; `i j k` in metrology.
const NORMAL_COLUMNS: [[&str; 3]; 4] =
    [["nx", "ny", "nz"], NORMAL_FIELDS, ["normalx", "normaly", "normalz"], ["i", "j", "k"]];

/// Names of colours in the heading of a table.
const COLOUR_COLUMNS: [[&str; 3]; 2] = [["r", "g", "b"], ["red", "green", "blue"]];

/// Reasons why a cloud of points could not be read. Lines count from 1, points from 0.
#[derive(thiserror::Error)]
#[non_exhaustive]
pub enum PointsError {
    /// A line does not match the format.
    #[error(
        "{file}, line {line}: expected {expected}, found {found}: mend the line, or export the points again"
    )]
    Expected {
        /// The file name.
        file: String,
        /// The line number, from 1.
        line: usize,
        /// The expected content.
        expected: &'static str,
        /// The content found instead.
        found: String,
    },
    /// A row of a table has other columns than the heading names, or than the first row has.
    #[error(
        "{file}, line {line}: found {found} columns, expected {expected}, as in {like}: {remedy}"
    )]
    Columns {
        /// The file name.
        file: String,
        /// The line number, from 1.
        line: usize,
        /// The number of columns of the row.
        found: usize,
        /// The expected number.
        expected: usize,
        /// The line or heading that has the expected number.
        like: &'static str,
        /// The remedy.
        remedy: &'static str,
    },
    /// The data of a PCD file is in a form that is not read.
    #[error(
        "{file}: the data is `{data}`: save the cloud as `ascii`, `binary` or `binary_compressed`"
    )]
    Data {
        /// The file name.
        file: String,
        /// The form.
        data: String,
    },
    /// The file has other points than its header declares.
    #[error(
        "{file} has {found} points, and its header declares {declared}: export or copy it again"
    )]
    Count {
        /// The file name.
        file: String,
        /// The number of points found.
        found: usize,
        /// The number declared.
        declared: usize,
    },
    /// There are no points, or they lack coordinates.
    #[error("{file} has no points with `x`, `y` and `z`: export the points again")]
    NoPoints {
        /// The file name.
        file: String,
    },
    /// Columns of a table are normals or colours.
    #[error(
        "{file}, line {line}: columns 4 to 6 are normals or colours, as they have length 1 in all rows and no number below 0: name the columns in a \
         first line, `x y z nx ny nz` or `x y z r g b`"
    )]
    Ambiguous {
        /// The file name.
        file: String,
        /// The line of the first point, from 1.
        line: usize,
    },
    /// A coordinate is not finite or too large, or a normal is no direction.
    #[error(
        "{file}: {what} of point {point} (from 0) is {value}: remove the point, or compute it anew"
    )]
    Value {
        /// The file name.
        file: String,
        /// The point, from 0.
        point: usize,
        /// The coordinate or the normal.
        what: &'static str,
        /// The value found.
        value: f64,
    },
    /// A point is far outside the rest of the part.
    #[error(
        "{file}: point {point} (from 0): {outlier}: mend the coordinate, or export or copy the part again"
    )]
    Outlier {
        /// The file name.
        file: String,
        /// The point, from 0.
        point: usize,
        /// The outlying coordinate and its statistics.
        outlier: Outlier,
    },
}

crate::debug_as_sentence!(PointsError);

/// A field of a point in PCD.
struct Field<'a> {
    name: &'a str,
    /// Bytes of a number.
    size: usize,
    /// `F`, `I` or `U`.
    kind: u8,
    /// The number of numbers.
    count: usize,
}

impl OrientedPoints {
    /// Reads a PCD file with `ascii`, `binary` or `binary_compressed` data; errors name the file as `name`. Points with a coordinate NaN,
    /// which scanners write where nothing was measured, are left out. Without the fields `normal_x`, `normal_y` and `normal_z` there are no normals.
    ///
    /// # Errors
    /// See [`PointsError`].
    pub fn from_pcd(bytes: &[u8], name: &str) -> Result<OrientedPoints, PointsError> {
        let file = || name.to_owned();
        let mut fields: Vec<Field<'_>> = Vec::new();
        let (mut declared, mut width, mut height) = (None, 1, 1);
        let mut rest = bytes;
        let mut line = 0;
        let data = loop {
            let end = rest.iter().position(|byte| *byte == b'\n').unwrap_or(rest.len());
            let text = std::str::from_utf8(&rest[..end]).unwrap_or_default().trim();
            let is_last = end == rest.len();
            rest = &rest[(end + 1).min(rest.len())..];
            line += 1;
            let expected = |expected| PointsError::Expected {
                file: file(),
                line,
                expected,
                found: format!("`{}`", printable(text.as_bytes())),
            };
            let mut words = text.split_whitespace();
            let key = words.next().unwrap_or_default();
            let words: Vec<&str> = words.collect();
            let whole = || words.first().and_then(|word| word.parse::<usize>().ok());
            match key {
                "DATA" => break words.first().copied().unwrap_or_default(),
                "FIELDS" => {
                    let field = |name| Field { name, size: 4, kind: b'F', count: 1 };
                    fields = words.into_iter().map(field).collect();
                }
                "SIZE" | "TYPE" | "COUNT" => {
                    if words.len() != fields.len() {
                        return Err(expected("a value for each of `FIELDS`"));
                    }
                    for (field, word) in fields.iter_mut().zip(words) {
                        let number = word.parse().ok().filter(|number| (1..=4096).contains(number));
                        match (key, number) {
                            ("TYPE", _) => field.kind = word.as_bytes()[0],
                            ("SIZE", Some(size)) => field.size = size,
                            ("COUNT", Some(count)) => field.count = count,
                            _ => return Err(expected("whole numbers from 1")),
                        }
                    }
                }
                "WIDTH" => width = whole().ok_or_else(|| expected("a whole number"))?,
                "HEIGHT" => height = whole().ok_or_else(|| expected("a whole number"))?,
                "POINTS" => declared = Some(whole().ok_or_else(|| expected("a whole number"))?),
                _ if is_last => return Err(expected("`DATA`")),
                _ => {}
            }
        };
        let declared = declared.unwrap_or_else(|| width.saturating_mul(height));
        let place =
            |wanted: &str| fields.iter().position(|field| field.name == wanted && field.count == 1);
        let xyz = ["x", "y", "z"].map(place);
        let normal = NORMAL_FIELDS.map(place);
        let [Some(_), Some(_), Some(_)] = xyz else {
            return Err(PointsError::NoPoints { file: file() });
        };
        let mut reader = Reader::new(name, normal.iter().all(Option::is_some));
        let wanted: Vec<usize> = xyz.iter().chain(&normal).filter_map(|index| *index).collect();
        let wanted = if reader.has_normals { &wanted[..] } else { &wanted[..3] };
        let size = |field: &Field<'_>| field.size * field.count;
        let bytes_before = |index: usize| fields[..index].iter().map(size).sum::<usize>();
        let stride = bytes_before(fields.len());
        let columns: Vec<usize> = wanted
            .iter()
            .map(|index| fields[..*index].iter().map(|field| field.count).sum())
            .collect();
        let mut found = 0;
        match data {
            "ascii" => {
                let text = String::from_utf8_lossy(rest);
                for (index, row) in (line + 1..).zip(text.lines()) {
                    let numbers: Vec<&str> = row.split_whitespace().collect();
                    if numbers.is_empty() {
                        continue;
                    }
                    let number = |column: &usize| numbers.get(*column)?.parse::<f64>().ok();
                    let values: Option<Vec<f64>> = columns.iter().map(number).collect();
                    let values = values.ok_or_else(|| PointsError::Expected {
                        file: file(),
                        line: index,
                        expected: "a number for each of `FIELDS`",
                        found: format!("`{}`", printable(row.as_bytes())),
                    })?;
                    reader.push(&values)?;
                    found += 1;
                }
            }
            "binary" | "binary_compressed" => {
                // Compressed data has one field of all points after another.
                let is_packed = data == "binary_compressed";
                let unpacked = if is_packed { unpacked(rest) } else { Some(Vec::new()) };
                let Some(unpacked) = unpacked else {
                    return Err(PointsError::Count { file: file(), found, declared });
                };
                let bytes = if is_packed { &unpacked[..] } else { rest };
                let whole = (bytes.len() / stride).min(declared);
                let is_whole = !is_packed || bytes.len() / stride == declared;
                for point in 0..if is_whole { whole } else { 0 } {
                    let value = |index: &usize| {
                        let (Field { size, kind, .. }, before) =
                            (&fields[*index], bytes_before(*index));
                        let at = match is_packed {
                            true => declared * before + point * size,
                            false => point * stride + before,
                        };
                        binary(*kind, &bytes[at..at + size]).unwrap_or(f64::NAN)
                    };
                    reader.push(&wanted.iter().map(value).collect::<Vec<f64>>())?;
                }
                found = whole;
            }
            other => {
                return Err(PointsError::Data { file: file(), data: printable(other.as_bytes()) });
            }
        }
        if found != declared {
            return Err(PointsError::Count { file: file(), found, declared });
        }
        reader.finish()
    }

    /// Reads a table of points; errors name the file as `name`. The columns are separated by blanks, commas or semicolons; between blanks or
    /// semicolons, a comma is a decimal point. Lines that begin with `#` or `//` are comments, and a first line of words or of one number is a heading.
    /// A whole number there is the number of points. All rows have the same number of columns, which is that of a first line of names.
    /// A heading, or a comment that begins with `x`, can name the columns: `x y z`, and `nx ny nz` for a normal or `r g b`. Without names the first three
    /// are the coordinates, and the next three a normal if they are unit vectors in all rows, one of which has a number below 0. Other columns are skipped.
    ///
    /// # Errors
    /// See [`PointsError`].
    pub fn from_xyz(bytes: &[u8], name: &str) -> Result<OrientedPoints, PointsError> {
        let text = String::from_utf8_lossy(bytes);
        let mut columns = Columns::default();
        let mut rows: Vec<[f64; 6]> = Vec::new();
        let (mut first, mut heading, mut declared) = (0, None, None);
        let mut expected = None;
        let (mut are_units, mut has_negative) = (true, false);
        for (index, line) in text.lines().enumerate() {
            let line = line.trim();
            let is_comment = line.starts_with('#') || line.starts_with("//");
            if is_comment && rows.is_empty() {
                // Other comments are prose, which may have an x, too.
                let named = Heading::of(&cells(line.trim_start_matches(['#', '/'])));
                heading = named.filter(|named| named.columns.coordinates[0] == 0).or(heading);
            }
            if line.is_empty() || is_comment {
                continue;
            }
            let cells = cells(line);
            let numbers: Vec<Option<f64>> = cells.iter().map(|cell| cell.parse().ok()).collect();
            let is_heading =
                rows.is_empty() && (numbers.len() == 1 || numbers.iter().all(Option::is_none));
            if is_heading {
                declared = declared.or_else(|| line.parse::<usize>().ok());
                if let Some(named) = Heading::of(&cells) {
                    expected = Some((named.count, "the heading"));
                    heading = Some(named);
                }
                continue;
            }
            if rows.is_empty() {
                first = 1 + index;
                let named = heading.take().filter(|heading: &Heading| heading.count == cells.len());
                columns = named.map_or(columns, |heading| heading.columns);
            }
            let (count, like) = *expected.get_or_insert((cells.len(), "the first row"));
            if cells.len() != count {
                return Err(PointsError::Columns {
                    file: name.to_owned(),
                    line: 1 + index,
                    found: cells.len(),
                    expected: count,
                    like,
                    remedy: columns_remedy(line, cells.len() > count),
                });
            }
            let number = |column: usize| numbers.get(column).copied().flatten();
            let [Some(x), Some(y), Some(z)] = columns.coordinates.map(number) else {
                return Err(PointsError::Expected {
                    file: name.to_owned(),
                    line: 1 + index,
                    expected: "the coordinates x, y and z",
                    found: format!("`{}`", printable(line.as_bytes())),
                });
            };
            let normal = columns.normal.map(|column| number(column).unwrap_or(f64::NAN));
            are_units &= (Vector3::from(normal).norm() - 1.0).abs() < UNIT_TOLERANCE;
            has_negative |= normal.iter().any(|value| value.is_sign_negative());
            rows.push([x, y, z, normal[0], normal[1], normal[2]]);
        }
        if let Some(declared) = declared.filter(|declared| *declared != rows.len()) {
            let (file, found) = (name.to_owned(), rows.len());
            return Err(PointsError::Count { file, found, declared });
        }
        let has_normals = match columns.has_normals {
            Some(named) => named,
            None if are_units && !rows.is_empty() && !has_negative => {
                return Err(PointsError::Ambiguous { file: name.to_owned(), line: first });
            }
            None => are_units,
        };
        let mut reader = Reader::new(name, has_normals);
        for row in &rows {
            reader.push(if has_normals { row } else { &row[..3] })?;
        }
        reader.finish()
    }
}

/// Places of the columns of a table of points.
struct Columns {
    coordinates: [usize; 3],
    normal: [usize; 3],
    /// `None` if only the numbers can tell.
    has_normals: Option<bool>,
}

impl Default for Columns {
    fn default() -> Columns {
        Columns { coordinates: [0, 1, 2], normal: [3, 4, 5], has_normals: None }
    }
}

/// A heading of a table of points that names the coordinates.
struct Heading {
    columns: Columns,
    /// The number of its columns.
    count: usize,
}

impl Heading {
    fn of(cells: &[String]) -> Option<Heading> {
        let place = |wanted: &str| {
            let mut names = cells.iter().map(|name| name.trim_matches('"'));
            names.position(|name| name.eq_ignore_ascii_case(wanted))
        };
        let all = |wanted: [&str; 3]| match wanted.map(place) {
            [Some(x), Some(y), Some(z)] => Some([x, y, z]),
            _ => None,
        };
        let coordinates = all(["x", "y", "z"])?;
        let normal = NORMAL_COLUMNS.into_iter().find_map(all);
        let has_colours = COLOUR_COLUMNS.into_iter().any(|names| all(names).is_some());
        let has_normals = (normal.is_some() || has_colours).then_some(normal.is_some());
        let normal = normal.unwrap_or(Columns::default().normal);
        Some(Heading { columns: Columns { coordinates, normal, has_normals }, count: cells.len() })
    }
}

/// Points that are read one by one.
struct Reader<'n> {
    name: &'n str,
    has_normals: bool,
    /// The number of points so far, those that were left out included.
    count: usize,
    points: OrientedPoints,
}

impl Reader<'_> {
    fn new(name: &str, has_normals: bool) -> Reader<'_> {
        Reader { name, has_normals, count: 0, points: OrientedPoints::default() }
    }

    /// Adds a point: its coordinates, and its normal if the points have some.
    fn push(&mut self, values: &[f64]) -> Result<(), PointsError> {
        let (file, point) = (|| self.name.to_owned(), self.count);
        self.count += 1;
        if values[..3].iter().any(|value| value.is_nan()) {
            self.points.left_out += 1;
            return Ok(());
        }
        if let Some(value) = values[..3].iter().find(|value| !is_valid_coordinate(**value)) {
            let (what, value) = ("a coordinate", *value);
            return Err(PointsError::Value { file: file(), point, what, value });
        }
        if self.has_normals {
            let normal = Vector3::new(values[3], values[4], values[5]);
            let norm = normal.norm();
            if !norm.is_normal() || norm * norm < f64::MIN_POSITIVE {
                let what = "the norm of the normal";
                return Err(PointsError::Value { file: file(), point, what, value: norm });
            }
            self.points.normals.push(normal / norm);
        }
        self.points.points.push(Point3::new(values[0], values[1], values[2]));
        Ok(())
    }

    fn finish(self) -> Result<OrientedPoints, PointsError> {
        let file = self.name.to_owned();
        if self.points.points.is_empty() {
            return Err(PointsError::NoPoints { file });
        }
        match find_outlier(&self.points.points) {
            None => Ok(self.points),
            Some(found) => {
                Err(PointsError::Outlier { file, point: found.index, outlier: found.outlier })
            }
        }
    }
}

/// Returns the cells of a row of a table, with decimal points.
fn cells(row: &str) -> Vec<String> {
    let blank = [' ', '\t', ';'];
    let pieces: Vec<&str> = row.split(blank).filter(|piece| !piece.is_empty()).collect();
    let is_number = |piece: &&str| {
        piece.split_once(',').is_none_or(|(whole, decimals)| {
            whole.ends_with(|c: char| c.is_ascii_digit())
                && decimals.starts_with(|c: char| c.is_ascii_digit())
                && !decimals.contains(',')
        })
    };
    match pieces.len() >= 3 && pieces.iter().all(is_number) {
        true => pieces.into_iter().map(|piece| piece.replace(',', ".")).collect(),
        false => {
            let cells = pieces.into_iter().flat_map(|piece| piece.split(','));
            cells.filter(|cell| !cell.is_empty()).map(str::to_owned).collect()
        }
    }
}

/// Returns the remedy for a row with a wrong number of columns.
fn columns_remedy(row: &str, has_too_many: bool) -> &'static str {
    if has_too_many && row.contains(',') && !row.contains('.') {
        "if these are decimal commas (`0,5`), write points (`0.5`), or separate the columns by semicolons"
    } else {
        "correct the row, or export the points again"
    }
}

/// Returns the data of `binary_compressed`: two lengths of 4 bytes, and then LZF, which is groups of literal bytes, up to 32 of them, and of
/// references to at least 3 bytes up to 8192 before. `None` if it is damaged or cut off.
fn unpacked(data: &[u8]) -> Option<Vec<u8>> {
    /// The most bytes that a reference of 3 bytes stands for.
    const LONGEST: usize = 264;
    let (lengths, data) = data.split_first_chunk::<8>()?;
    let length = |at: usize| u32::from_le_bytes(std::array::from_fn(|k| lengths[at + k])) as usize;
    let (packed, whole) = (data.get(..length(0))?, length(4));
    // A wrong length must not reserve memory.
    if whole > packed.len().saturating_mul(LONGEST) {
        return None;
    }
    let mut out = Vec::with_capacity(whole);
    let mut bytes = packed.iter().map(|byte| usize::from(*byte));
    while let Some(control) = bytes.next() {
        if control < 32 {
            for _ in 0..=control {
                out.push(bytes.next()? as u8);
            }
            continue;
        }
        let mut count = (control >> 5) + 2;
        if count == 9 {
            count += bytes.next()?;
        }
        let back = ((control & 31) << 8) + bytes.next()? + 1;
        let start = out.len().checked_sub(back)?;
        for at in start..start + count {
            out.push(out[at]);
        }
        if out.len() > whole {
            return None;
        }
    }
    (out.len() == whole).then_some(out)
}

/// Returns a number in little-endian order, of a kind and a size that PCD has.
fn binary(kind: u8, bytes: &[u8]) -> Option<f64> {
    Some(match (kind, bytes.len()) {
        (b'F', 4) => f64::from(f32::from_le_bytes(bytes.try_into().ok()?)),
        (b'F', 8) => f64::from_le_bytes(bytes.try_into().ok()?),
        (b'U', 1) => f64::from(bytes[0]),
        (b'U', 2) => f64::from(u16::from_le_bytes(bytes.try_into().ok()?)),
        (b'U', 4) => f64::from(u32::from_le_bytes(bytes.try_into().ok()?)),
        (b'I', 1) => f64::from(bytes[0].cast_signed()),
        (b'I', 2) => f64::from(i16::from_le_bytes(bytes.try_into().ok()?)),
        (b'I', 4) => f64::from(i32::from_le_bytes(bytes.try_into().ok()?)),
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const HEADER: &str = "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z intensity normal_x normal_y normal_z\n\
        SIZE 4 4 4 4 4 4 4\nTYPE F F F F F F F\nCOUNT 1 1 1 1 1 1 1\nWIDTH 3\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 3\n";

    const ROWS: [[f32; 7]; 3] = [
        [1.0, 2.0, 3.0, 9.0, 0.0, 0.0, 2.0],
        [f32::NAN, f32::NAN, f32::NAN, 9.0, 0.0, 0.0, 1.0],
        [4.0, 5.0, 6.0, 9.0, 1.0, 0.0, 0.0],
    ];

    #[test]
    fn clouds_of_pcd_are_read_as_text_and_as_bytes() {
        let rows = ROWS.map(|row| row.map(|value| value.to_string()).join(" ")).join("\n");
        let ascii =
            OrientedPoints::from_pcd(format!("{HEADER}DATA ascii\n{rows}\n").as_bytes(), "a");
        let ascii = ascii.expect("a cloud");
        assert_eq!(ascii.points, [Point3::new(1.0, 2.0, 3.0), Point3::new(4.0, 5.0, 6.0)]);
        assert_eq!(ascii.normals, [Vector3::z(), Vector3::x()]);
        let mut bytes = format!("{HEADER}DATA binary\n").into_bytes();
        bytes.extend(ROWS.iter().flatten().flat_map(|value| value.to_le_bytes()));
        assert_eq!(OrientedPoints::from_pcd(&bytes, "a").expect("a cloud"), ascii);
        assert_eq!(ascii.left_out, 1);
        // One field of all points after another: literal bytes.
        let fields: Vec<u8> =
            (0..7).flat_map(|k| ROWS.map(|row| row[k].to_le_bytes())).flatten().collect();
        let mut packed: Vec<u8> =
            fields.chunks(32).flat_map(|part| [&[part.len() as u8 - 1], part].concat()).collect();
        let lengths = |packed: &[u8], whole: usize| {
            [packed.len() as u32, whole as u32].map(u32::to_le_bytes).concat()
        };
        let file = |packed: &[u8]| {
            let header = format!("{HEADER}DATA binary_compressed\n").into_bytes();
            [header, lengths(packed, fields.len()), packed.to_vec()].concat()
        };
        assert_eq!(OrientedPoints::from_pcd(&file(&packed), "a").expect("a cloud"), ascii);
        packed.pop();
        assert!(OrientedPoints::from_pcd(&file(&packed), "a").is_err());
        // "ab" and a reference to 2 bytes before, of 3 and of 264 bytes.
        assert_eq!(unpacked(&[5, 0, 0, 0, 5, 0, 0, 0, 1, 97, 98, 32, 1]), Some(b"ababa".to_vec()));
        let long = unpacked(&[6, 0, 0, 0, 10, 1, 0, 0, 1, 97, 98, 0xe0, 0xff, 1]);
        assert_eq!(long, Some(b"ab".repeat(133)));
        for damaged in
            [[5, 0, 0, 0, 5, 0, 0, 0, 1, 97, 98, 32, 2], [5, 0, 0, 0, 6, 0, 0, 0, 1, 97, 98, 32, 1]]
        {
            assert_eq!(unpacked(&damaged), None);
        }
        let cut = OrientedPoints::from_pcd(&bytes[..bytes.len() - 1], "a.pcd");
        assert!(matches!(cut, Err(PointsError::Count { found: 2, declared: 3, .. })), "{cut:?}");
        let bare = HEADER.replace("normal_", "n");
        let bare = format!("{bare}DATA ascii\n{rows}\n");
        let bare = OrientedPoints::from_pcd(bare.as_bytes(), "a").expect("a cloud");
        assert_eq!((bare.points.len(), bare.normals.len()), (2, 0));
        for (text, what) in [
            (format!("{HEADER}DATA binary_compressed\n"), "0 points"),
            (format!("{HEADER}DATA zip\n"), "ascii"),
            (HEADER.to_owned(), "DATA"),
            (format!("{}DATA ascii\n{rows}\n", HEADER.replace(" x ", " u ")), "no points"),
            (format!("{HEADER}DATA ascii\n1 2\n"), "line 12"),
        ] {
            let error = OrientedPoints::from_pcd(text.as_bytes(), "a.pcd").expect_err(what);
            assert!(error.to_string().contains(what), "{error}");
        }
    }

    #[test]
    fn tables_of_points_are_read_with_their_normals_or_without() {
        let read = |text: &str| OrientedPoints::from_xyz(text.as_bytes(), "a.xyz");
        let plain = read("2\n// of a scanner\n1 2 3\n4;5;6\n").expect("a cloud");
        assert_eq!(plain.points, [Point3::new(1.0, 2.0, 3.0), Point3::new(4.0, 5.0, 6.0)]);
        assert!(plain.normals.is_empty());
        let oriented = read("x y z nx ny nz\n1,2,3,0,0,1\n4,5,6,0.999,0.01,0\n").expect("a cloud");
        assert_eq!((oriented.points.len(), oriented.normals[0]), (2, Vector3::z()));
        // Decimal commas are no separators.
        for decimal in ["1,5 -2,25 3\n4 5 6\n", "1,5;-2,25;3,0\n4;5;6\n"] {
            let decimal = read(decimal).expect("a cloud").points;
            assert_eq!(decimal, [Point3::new(1.5, -2.25, 3.0), Point3::new(4.0, 5.0, 6.0)]);
        }
        assert_eq!(
            read("1, 2, 3\n1 ,2 ,3\n").expect("a cloud").points,
            [Point3::new(1.0, 2.0, 3.0); 2]
        );
        // Colours are no normals, and what may be either is named.
        for (text, normals) in [
            ("1 2 3 255 0 0\n4 5 6 0 0 1\n", Some(0)),
            ("1 2 3 1 0 0\n4 5 6 0 0 1\n", None),
            ("1 2 3 0.6 0.8 0\n", None),
            ("# a scan in mm\n1 2 3 1 0 0\n", None),
            ("1 2 3 -1 0 0\n4 5 6 0 0 1\n", Some(2)),
            ("x y z r g b\n1 2 3 1 0 0\n", Some(0)),
            ("//X,Y,Z,R,G,B\n// of a scanner\n1,2,3,1,0,0\n", Some(0)),
            ("\"X\";\"Y\";\"Z\";\"Nx\";\"Ny\";\"Nz\"\n1;2;3;1;0;0\n", Some(1)),
            ("#x y z normal_x normal_y normal_z\n1 2 3 1 0 0\n", Some(1)),
            ("x y z intensity nx ny nz\n1 2 3 9 0 0 5\n", Some(1)),
            ("id x y z\n7 1 2 3\n", Some(0)),
            ("# export in x y z\n1 2 3 7 8\n", Some(0)),
            ("x,y,z,i,j,k\n1,2,3,0,0,1\n", Some(1)),
            ("x y z a b c\n1 2 3 0 0 1\n", None),
            ("x y z a b c\n1 2 3 0 0 -1\n", Some(1)),
        ] {
            match (read(text), normals) {
                (Ok(cloud), Some(normals)) => {
                    assert_eq!(cloud.normals.len(), normals, "{text}");
                    assert_eq!(cloud.points[0], Point3::new(1.0, 2.0, 3.0), "{text}");
                }
                (Err(PointsError::Ambiguous { line, .. }), None) => {
                    assert_eq!(
                        line,
                        text.lines().count() - usize::from(text.contains("4 5 6")),
                        "{text}"
                    );
                }
                (found, _) => panic!("{text}: {found:?}"),
            }
        }
        assert!(matches!(read("x y\n1 2\n"), Err(PointsError::Expected { line: 2, .. })));
        for (text, said) in [
            (
                "x,y,z\n0,1,0,1,-0,3\n",
                "line 2: found 6 columns, expected 3, as in the heading: if these are decimal commas",
            ),
            (
                "x,y,z\n0,0,0,25\n0,0,0,75\n",
                "write points (`0.5`), or separate the columns by semicolons",
            ),
            (
                "x y z\n1 2 3 1 0 0\n",
                "found 6 columns, expected 3, as in the heading: correct the row",
            ),
            ("1 2 3\n1 2\n", "line 2: found 2 columns, expected 3, as in the first row"),
            ("1,2,3\n1,2,3,5\n", "line 2: found 4 columns"),
            ("5\n1 2 3\n", "has 1 points, and its header declares 5"),
            ("1\n1 2 3\n4 5 6\n", "has 2 points, and its header declares 1"),
        ] {
            let error = read(text).expect_err(text).to_string();
            assert!(error.contains(said), "{text}: {error}");
        }
        assert!(matches!(read("# none\n"), Err(PointsError::NoPoints { .. })));
    }
}
