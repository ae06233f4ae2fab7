//! Tables of postures in Apache Parquet.
//!
//! A table has the lines of [`PostureMap::write_csv`](crate::PostureMap::write_csv): one per posture on record, and one per tool
//! without a posture at a triangle. Its metadata have the identity of the map and a digest of the whole file, so that a table that was
//! changed or cut off is refused before its columns are read: the decoders of `parquet` panic at some.

use super::ShardError;
use crate::map::{MapIdentity, decode, encode};
use crate::record::direction_count;
use crate::{Accessibility, MapRow, PostureRecord};
use parquet::basic::Compression;
use parquet::column::reader::get_typed_column_reader;
use parquet::data_type::{ByteArray, ByteArrayType, DataType, DoubleType, Int32Type};
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::{EnabledStatistics, WriterProperties};
use parquet::file::reader::{FileReader, RowGroupReader, SerializedFileReader};
use parquet::file::writer::{SerializedFileWriter, SerializedRowGroupWriter};
use parquet::schema::parser::parse_message_type;
use siphasher::sip::SipHasher24;
use std::hash::Hasher;
use std::io::Write;
use std::sync::Arc;
use touchoff::{Shard, TriangleId};

/// The columns, in the order in which they are written. Lengths are in the part's unit. Bit k of `direction_set`, counted from the
/// most significant bit of the first byte, stands for direction k.
const SCHEMA: &str = "
    message postures {
        REQUIRED INT32 triangle (INTEGER(32, false));
        REQUIRED DOUBLE area;
        REQUIRED INT32 tool_index (INTEGER(32, false));
        REQUIRED BINARY tool (UTF8);
        OPTIONAL INT32 rank (INTEGER(32, false));
        OPTIONAL DOUBLE x;
        OPTIONAL DOUBLE y;
        OPTIONAL DOUBLE z;
        OPTIONAL DOUBLE i;
        OPTIONAL DOUBLE j;
        OPTIONAL DOUBLE k;
        OPTIONAL DOUBLE niceness;
        OPTIONAL DOUBLE depth;
        OPTIONAL DOUBLE clearance;
        OPTIONAL INT32 directions (INTEGER(32, false));
        OPTIONAL DOUBLE stickout;
        OPTIONAL DOUBLE area_reached;
        OPTIONAL BINARY direction_set;
    }";

/// Number of numbers of a posture: its tip, axis, niceness, depth and clearance.
const RECORD_NUMBERS: usize = 9;

/// Number of lines of a row group.
const GROUP_LINES: usize = 1 << 16;

/// The version of the columns and of the metadata.
const FORMAT: &str = "1";

/// Keys of the metadata.
const KEY_FORMAT: &str = "touchoff.format";
const KEY_VERSION: &str = "touchoff.version";
const KEY_IDENTITY: &str = "touchoff.identity";
const KEY_SHARD: &str = "touchoff.shard";
const KEY_DIGEST: &str = "touchoff.digest";
/// The identity as JSON, for readers of the table.
const KEY_MAP: &str = "touchoff.map";

/// The version of the program, which tables carry.
const VERSION: &str = env!("CARGO_PKG_VERSION");

/// The data on record for a triangle.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct TableRow {
    pub(crate) triangle: TriangleId,
    /// In the square of the part's unit.
    pub(crate) area: f64,
    pub(crate) row: MapRow,
    /// Per entry of [`MapRow::access`], the fraction of the area that the tool reaches, if it was tried everywhere.
    pub(crate) reached: Vec<Option<f64>>,
}

/// A table, as it is read.
#[derive(Debug)]
pub(crate) struct Table {
    pub(crate) identity: MapIdentity,
    /// The shard, unless the table is that of a whole map.
    pub(crate) shard: Option<Shard>,
    /// The rows, by triangle.
    pub(crate) rows: Vec<TableRow>,
}

/// A line of the table.
struct Line<'a> {
    of: &'a TableRow,
    tool: u16,
    /// The place of the posture among those of the triangle.
    rank: u16,
    record: Option<&'a PostureRecord>,
    access: Option<&'a Accessibility>,
}

impl TableRow {
    fn lines(&self) -> impl Iterator<Item = Line<'_>> {
        // Postures come first.
        (0..).zip(self.row.lines()).filter_map(|(rank, (record, access))| {
            let tool = record.map(|record| record.tool).or(access.map(|access| access.tool))?;
            Some(Line { of: self, tool, rank, record, access })
        })
    }
}

impl Line<'_> {
    fn numbers(&self) -> Option<[f64; RECORD_NUMBERS]> {
        let PostureRecord { tip: [x, y, z], axis: [i, j, k], niceness, depth, clearance, .. } =
            self.record?;
        Some([*x, *y, *z, *i, *j, *k, *niceness, *depth, *clearance])
    }

    fn area_reached(&self) -> Option<f64> {
        let TableRow { row, reached, .. } = self.of;
        let index = row.access.iter().position(|access| access.tool == self.tool)?;
        reached[index]
    }
}

/// Returns the bytes of a set of directions, the most significant bit of each first.
fn to_bytes(set: &[u64], count: usize) -> Vec<u8> {
    let bytes = set.iter().flat_map(|word| word.to_le_bytes()).map(u8::reverse_bits);
    bytes.take(count.div_ceil(8)).collect()
}

/// Returns the words of a set of directions.
fn to_words(bytes: &[u8]) -> Vec<u64> {
    let words = bytes.chunks(8).map(|chunk| {
        let mut word = [0; 8];
        for (byte, found) in word.iter_mut().zip(chunk) {
            *byte = found.reverse_bits();
        }
        u64::from_le_bytes(word)
    });
    words.collect()
}

/// Start of the digest in the last of the metadata.
const DIGEST: &[u8] = b"sip24:";

/// Returns the digits of the digest in the bytes of a table.
fn digest_digits(bytes: &mut [u8]) -> Option<&mut [u8]> {
    let at = bytes.windows(DIGEST.len()).rposition(|window| window == DIGEST)?;
    bytes[at + DIGEST.len()..].first_chunk_mut::<16>().map(|digits| &mut digits[..])
}

/// Returns the digest of the bytes of a table, in which that of the digest is 0: SipHash-2-4 without a key.
fn digest(bytes: &[u8]) -> String {
    let mut hasher = SipHasher24::new();
    hasher.write(bytes);
    format!("{:016x}", hasher.finish())
}

fn shard_text(shard: Option<Shard>) -> String {
    shard.map_or(String::new(), |shard| shard.to_string())
}

/// Writes a column.
fn column<T: DataType>(
    group: &mut SerializedRowGroupWriter<'_, impl Write + Send>,
    values: &[T::T],
    levels: Option<&[i16]>,
) -> Result<(), ParquetError> {
    let mut column = group.next_column()?.expect("a column of the schema");
    column.typed::<T>().write_batch(values, levels, None)?;
    column.close()
}

/// Writes a column with values that may be missing.
fn optional<T: DataType>(
    group: &mut SerializedRowGroupWriter<'_, impl Write + Send>,
    values: impl Iterator<Item = Option<T::T>>,
) -> Result<(), ParquetError> {
    let values: Vec<Option<T::T>> = values.collect();
    let levels: Vec<i16> = values.iter().map(|value| i16::from(value.is_some())).collect();
    let values: Vec<T::T> = values.into_iter().flatten().collect();
    column::<T>(group, &values, Some(&levels))
}

/// Returns the bytes of a table. Rows are by triangle.
pub(crate) fn encoded(identity: &MapIdentity, shard: Option<Shard>, rows: &[TableRow]) -> Vec<u8> {
    try_encoded(identity, shard, rows)
        .expect("columns of the schema, in memory that takes all bytes")
}

fn try_encoded(
    identity: &MapIdentity,
    shard: Option<Shard>,
    rows: &[TableRow],
) -> Result<Vec<u8>, ParquetError> {
    let schema = Arc::new(parse_message_type(SCHEMA)?);
    let properties = WriterProperties::builder()
        .set_compression(Compression::UNCOMPRESSED)
        .set_created_by("touchoff".to_owned())
        .set_statistics_enabled(EnabledStatistics::Chunk)
        .set_offset_index_disabled(true)
        .build();
    let mut writer = SerializedFileWriter::new(Vec::new(), schema, Arc::new(properties))?;
    let count = identity.directions.len();
    let lines: Vec<Line<'_>> = rows.iter().flat_map(TableRow::lines).collect();
    for lines in lines.chunks(GROUP_LINES) {
        let mut group = writer.next_row_group()?;
        let triangles: Vec<i32> =
            lines.iter().map(|line| line.of.triangle.0.cast_signed()).collect();
        column::<Int32Type>(&mut group, &triangles, None)?;
        let areas: Vec<f64> = lines.iter().map(|line| line.of.area).collect();
        column::<DoubleType>(&mut group, &areas, None)?;
        let tools: Vec<i32> = lines.iter().map(|line| i32::from(line.tool)).collect();
        column::<Int32Type>(&mut group, &tools, None)?;
        let names = lines.iter().map(|line| identity.tools[usize::from(line.tool)].name.as_str());
        let names: Vec<ByteArray> = names.map(ByteArray::from).collect();
        column::<ByteArrayType>(&mut group, &names, None)?;
        let ranks = lines.iter().map(|line| line.record.map(|_| i32::from(line.rank)));
        optional::<Int32Type>(&mut group, ranks)?;
        for number in 0..RECORD_NUMBERS {
            let numbers = lines.iter().map(|line| line.numbers().map(|numbers| numbers[number]));
            optional::<DoubleType>(&mut group, numbers)?;
        }
        let access = || lines.iter().map(|line| line.access);
        let counts =
            access().map(|access| access.map(|access| direction_count(access).cast_signed()));
        optional::<Int32Type>(&mut group, counts)?;
        let stickouts = access().map(|access| access.and_then(|access| access.stickout));
        optional::<DoubleType>(&mut group, stickouts)?;
        optional::<DoubleType>(&mut group, lines.iter().map(Line::area_reached))?;
        let sets = access().map(|access| {
            access.map(|access| ByteArray::from(to_bytes(&access.directions, count)))
        });
        optional::<ByteArrayType>(&mut group, sets)?;
        group.close()?;
    }
    let identity_bytes = encode(identity);
    let identity_text: String = identity_bytes.iter().map(|byte| format!("{byte:02x}")).collect();
    let json = serde_json::to_string(identity)
        .map_err(|error| ParquetError::General(error.to_string()))?;
    for (key, value) in [
        (KEY_FORMAT, FORMAT.to_owned()),
        (KEY_VERSION, VERSION.to_owned()),
        (KEY_SHARD, shard_text(shard)),
        (KEY_MAP, json),
        (KEY_IDENTITY, identity_text),
        // The last one, where it is found.
        (KEY_DIGEST, "sip24:0000000000000000".to_owned()),
    ] {
        writer.append_key_value_metadata(KeyValue::new(key.to_owned(), value));
    }
    let mut bytes = writer.into_inner()?;
    let found = digest(&bytes);
    digest_digits(&mut bytes)
        .expect("the digest that was written")
        .copy_from_slice(found.as_bytes());
    Ok(bytes)
}

/// Reads a column of a row group, which has `count` lines.
fn values<T: DataType>(
    group: &dyn RowGroupReader,
    index: usize,
    count: usize,
    is_optional: bool,
) -> Result<Vec<Option<T::T>>, ParquetError> {
    let mut reader = get_typed_column_reader::<T>(group.get_column_reader(index)?);
    let (mut levels, mut found) = (Vec::new(), Vec::new());
    loop {
        let wanted = if is_optional { Some(&mut levels) } else { None };
        let (records, _, _) = reader.read_records(count, wanted, None, &mut found)?;
        if records == 0 {
            break;
        }
    }
    if !is_optional {
        return Ok(found.into_iter().map(Some).collect());
    }
    let mut found = found.into_iter();
    Ok(levels.into_iter().map(|level| if level == 1 { found.next() } else { None }).collect())
}

/// The columns of a row group.
struct Columns {
    triangle: Vec<Option<i32>>,
    area: Vec<Option<f64>>,
    tool: Vec<Option<i32>>,
    numbers: Vec<Vec<Option<f64>>>,
    stickout: Vec<Option<f64>>,
    reached: Vec<Option<f64>>,
    directions: Vec<Option<ByteArray>>,
}

impl Columns {
    fn read(group: &dyn RowGroupReader) -> Result<Columns, ParquetError> {
        let count = usize::try_from(group.metadata().num_rows())?;
        let numbers = (0..RECORD_NUMBERS).map(|k| values::<DoubleType>(group, 5 + k, count, true));
        Ok(Columns {
            triangle: values::<Int32Type>(group, 0, count, false)?,
            area: values::<DoubleType>(group, 1, count, false)?,
            tool: values::<Int32Type>(group, 2, count, false)?,
            numbers: numbers.collect::<Result<_, _>>()?,
            stickout: values::<DoubleType>(group, 15, count, true)?,
            reached: values::<DoubleType>(group, 16, count, true)?,
            directions: values::<ByteArrayType>(group, 17, count, true)?,
        })
    }

    /// Adds the lines to the rows of their triangles. Returns `None` if a value is missing, or out of range.
    fn add_to(&self, rows: &mut Vec<TableRow>) -> Option<()> {
        for (at, triangle) in self.triangle.iter().enumerate() {
            let triangle = TriangleId((*triangle)?.cast_unsigned());
            let area = (*self.area.get(at)?)?;
            if rows.last().is_none_or(|row| row.triangle != triangle) {
                let (row, reached) = (MapRow::default(), Vec::new());
                rows.push(TableRow { triangle, area, row, reached });
            }
            let TableRow { row, reached, .. } = rows.last_mut()?;
            let tool = u16::try_from((*self.tool.get(at)?)?).ok()?;
            if self.numbers[0].get(at)?.is_some() {
                let mut numbers = [0.0; RECORD_NUMBERS];
                for (number, column) in numbers.iter_mut().zip(&self.numbers) {
                    *number = (*column.get(at)?)?;
                }
                let [x, y, z, i, j, k, niceness, depth, clearance] = numbers;
                let (tip, axis) = ([x, y, z], [i, j, k]);
                row.best.push(PostureRecord { tool, tip, axis, niceness, depth, clearance });
            }
            let known = row.access.iter().any(|access| access.tool == tool);
            if let (Some(set), false) = (self.directions.get(at)?, known) {
                // Entries are in the order of tools.
                let place = row.access.partition_point(|access| access.tool < tool);
                let directions = to_words(set.data());
                let stickout = *self.stickout.get(at)?;
                row.access.insert(place, Accessibility { tool, directions, stickout });
                reached.insert(place, *self.reached.get(at)?);
            }
        }
        Some(())
    }
}

/// Reads a table, all of whose lines are checked.
///
/// # Errors
/// [`ShardError::Foreign`] if it is no such table, [`ShardError::OtherVersion`] if another version of Touchoff has written it,
/// [`ShardError::Damaged`] if it is not what was written.
pub(crate) fn read(file: &str, mut bytes: Vec<u8>) -> Result<Table, ShardError> {
    let damaged = |what: String| ShardError::Damaged { file: file.to_owned(), what };
    let broken = |error: ParquetError| damaged(error.to_string());
    if !bytes.starts_with(b"PAR1") {
        return Err(ShardError::Foreign { file: file.to_owned() });
    }
    if bytes.len() < 12 || !bytes.ends_with(b"PAR1") {
        return Err(damaged("it ends before its end: its writer was stopped".to_owned()));
    }
    let Some(digits) = digest_digits(&mut bytes) else {
        return Err(ShardError::Foreign { file: file.to_owned() });
    };
    let written = digits.to_vec();
    digits.fill(b'0');
    if digest(&bytes).as_bytes() != written {
        return Err(damaged("it is not what was written".to_owned()));
    }
    let reader = SerializedFileReader::new(bytes::Bytes::from(bytes)).map_err(broken)?;
    let metadata = reader.metadata().file_metadata();
    let keys = metadata.key_value_metadata().map_or(&[][..], |keys| keys);
    let key =
        |name: &str| keys.iter().find(|key| key.key == name).and_then(|key| key.value.as_deref());
    let Some(format) = key(KEY_FORMAT) else {
        return Err(ShardError::Foreign { file: file.to_owned() });
    };
    let version = key(KEY_VERSION).unwrap_or_default();
    if format != FORMAT || version != VERSION {
        let [file, version] = [file, version].map(str::to_owned);
        return Err(ShardError::OtherVersion { file, version, reads: VERSION });
    }
    let identity = key(KEY_IDENTITY).and_then(from_hex).and_then(|bytes| decode(&bytes));
    let identity: MapIdentity = identity
        .ok_or_else(|| damaged("what it says of itself is not what was written".to_owned()))?;
    let shard = match key(KEY_SHARD) {
        Some("") => None,
        text => {
            let shard = text.and_then(|text| text.parse().ok());
            Some(shard.ok_or_else(|| damaged("its shard is none".to_owned()))?)
        }
    };
    let expected = parse_message_type(SCHEMA).map_err(broken)?;
    if *metadata.schema() != expected {
        return Err(damaged("its columns are others".to_owned()));
    }
    let mut rows: Vec<TableRow> = Vec::new();
    for index in 0..reader.num_row_groups() {
        let group = reader.get_row_group(index).map_err(broken)?;
        let columns = Columns::read(&*group).map_err(broken)?;
        let missing = || damaged("a value of a line is missing".to_owned());
        columns.add_to(&mut rows).ok_or_else(missing)?;
    }
    for TableRow { triangle, row, .. } in &rows {
        let has_more = row.best.len() > usize::from(identity.keep.get());
        let too_many = has_more.then_some("it has more postures than are kept");
        let what = identity.row_error(*triangle, &row.best, &row.access).or(too_many);
        if let Some(what) = what {
            return Err(damaged(format!("triangle {triangle}: {what}")));
        }
    }
    if !rows.is_sorted_by(|one, next| one.triangle < next.triangle) {
        return Err(damaged("a triangle is there twice".to_owned()));
    }
    Ok(Table { identity, shard, rows })
}

fn from_hex(text: &str) -> Option<Vec<u8>> {
    let digits = text
        .as_bytes()
        .chunks(2)
        .map(|pair| u8::from_str_radix(std::str::from_utf8(pair).ok()?, 16).ok());
    digits.collect()
}
