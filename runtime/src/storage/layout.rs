//! Layout of a saved part: its records, and the lists that follow them.

use crate::bvh::{Boxes, WIDTH};
use crate::cloud::CoveringRadius;
use crate::mesh::MeshDiagnostics;
use crate::parallel;
use crate::part::Part;
use crate::point_bvh::{Leaf, LeafAttributes, PointBvh};
use crate::unit::Unit;
use bytemuck::{Pod, Zeroable};
use std::fmt;
use std::mem::size_of;

/// Magic bytes, modelled on PNG's: a byte above 127, both kinds of line ends and an end-of-file
/// character, so that a transfer as text damages them visibly.
pub(super) const MAGIC: [u8; 16] = *b"\x89TOUCHOFF\r\n\x1a\n\0\0\0";
/// The version that is written, and the newest that is read.
pub(super) const VERSION: u32 = 1;
/// Every section's offset and length in the file are multiples of this number of bytes.
pub(super) const ALIGN: usize = 64;
/// Bytes per chunk of a checksum; a multiple of [`ALIGN`]. Changing it changes the checksums.
const CHUNK: usize = 1 << 20;
/// The position of the header's own checksum.
const CHECKSUM_RANGE: std::ops::Range<usize> = 16..20;

/// The beginning of a file. The fields up to `file` are the same in every version.
#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub(super) struct Start {
    magic: [u8; 16],
    /// The checksum of the whole header, computed with this field set to 0.
    pub(super) checksum: u32,
    pub(super) version: u32,
    /// The lengths of the header and of the file, in bytes.
    pub(super) header: u64,
    pub(super) file: u64,
    /// The unit of length: 1 mm, 2 inch, 3 m.
    pub(super) unit: u32,
    pub(super) trees: u32,
    /// 1 if there are mesh diagnostics, otherwise 0.
    pub(super) surveyed: u32,
    zero: [u32; 3],
}

/// Mesh diagnostics; all zeros if there are none.
#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub(super) struct Surveyed {
    area: f64,
    volume: f64,
    unit: u64,
    counts: [u64; 8],
}

/// Properties of a tree other than its lists. A [`SectionHeader`] for each list follows.
#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub(super) struct FileHeader {
    pub(super) origin: [f64; 3],
    pub(super) scale: f64,
    pub(super) weight: f64,
    pub(super) radius: f64,
    pub(super) points: u64,
    pub(super) size: f32,
    pub(super) leaf_size: f32,
    /// The covering radius: 0 unknown, 1 estimated, 2 proved.
    pub(super) cover: u32,
    /// The number of removed points.
    pub(super) gone: u32,
}

/// A list: its offset, its length in bytes without the zeros that pad it to a multiple of [`ALIGN`], and
/// the checksum of the padded list.
#[derive(Clone, Copy, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub(super) struct SectionHeader {
    pub(super) at: u64,
    pub(super) bytes: u64,
    pub(super) checksum: u32,
    zero: u32,
}

/// One of a tree's lists.
#[derive(Clone, Copy)]
pub(super) enum List {
    Boxes(usize),
    Leaves,
    Skins,
    Triangles,
}

impl fmt::Display for List {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            List::Boxes(level) => write!(f, "the boxes of level {level}"),
            List::Leaves => f.write_str("the points"),
            List::Skins => f.write_str("the normals and weights"),
            List::Triangles => f.write_str("the triangle ids"),
        }
    }
}

/// Returns the lists of a tree with `points` points in file order, each with its number of items. Boxes
/// come first, from the root's children down. The counts are those of [`PointBvh::new`].
pub(super) fn lists(points: u64) -> Vec<(List, u64)> {
    let leaves = points.div_ceil(WIDTH as u64);
    let mut boxes = vec![leaves.div_ceil(WIDTH as u64)];
    while let Some(&count) = boxes.last()
        && count > 1
    {
        // As the tree is built: until one block holds a whole level.
        boxes.push(count.div_ceil(WIDTH as u64));
    }
    let boxes = boxes.into_iter().rev().enumerate();
    let boxes = boxes.map(|(level, count)| (List::Boxes(level), count));
    let rest = [(List::Leaves, leaves), (List::Skins, leaves), (List::Triangles, points)];
    boxes.chain(rest).collect()
}

impl List {
    /// Returns the size of an item in bytes.
    pub(super) fn item(self) -> u64 {
        let size = match self {
            List::Boxes(_) => size_of::<Boxes>(),
            List::Leaves => size_of::<Leaf>(),
            List::Skins => size_of::<LeafAttributes>(),
            List::Triangles => size_of::<u32>(),
        };
        size as u64
    }

    fn of(self, tree: &PointBvh) -> &[u8] {
        match self {
            List::Boxes(level) => bytemuck::cast_slice(&tree.levels[level]),
            List::Leaves => bytemuck::cast_slice(&tree.leaves),
            List::Skins => bytemuck::cast_slice(&tree.attributes),
            List::Triangles => bytemuck::cast_slice(&tree.triangles),
        }
    }
}

impl Surveyed {
    fn of(survey: &MeshDiagnostics) -> Surveyed {
        let counts = [
            survey.triangles,
            survey.degenerate,
            survey.open_edges,
            survey.crossed_edges,
            survey.shared_edges,
            survey.opposed_normals,
            survey.shells,
            survey.inverted_shells,
        ];
        Surveyed {
            area: survey.area,
            volume: survey.volume,
            unit: u64::from(code(survey.unit)),
            counts: counts.map(|count| count as u64),
        }
    }

    /// Returns the diagnostics, or `None` if a number is out of range.
    pub(super) fn survey(&self) -> Option<MeshDiagnostics> {
        let mut counts = [0; 8];
        for (count, stored) in counts.iter_mut().zip(self.counts) {
            *count = usize::try_from(stored).ok()?;
        }
        let [triangles, degenerate, open_edges, crossed_edges, shared_edges, ..] = counts;
        let [.., opposed_normals, shells, inverted_shells] = counts;
        Some(MeshDiagnostics {
            unit: unit(u32::try_from(self.unit).ok()?)?,
            triangles,
            degenerate,
            area: self.area,
            volume: self.volume,
            open_edges,
            crossed_edges,
            shared_edges,
            opposed_normals,
            shells,
            inverted_shells,
        })
    }
}

impl FileHeader {
    fn of(tree: &PointBvh) -> FileHeader {
        let (cover, radius) = match tree.covering_radius {
            None => (0, 0.0),
            Some(CoveringRadius { radius, proved }) => (1 + u32::from(proved), radius),
        };
        FileHeader {
            origin: tree.frame.origin.into(),
            scale: tree.frame.scale,
            weight: tree.weight,
            radius,
            points: tree.slots() as u64,
            size: tree.frame.size,
            leaf_size: tree.leaf_size,
            cover,
            gone: tree.removed as u32,
        }
    }
}

/// Returns the numeric code of a unit.
fn code(unit: Unit) -> u32 {
    match unit {
        Unit::Millimetre => 1,
        Unit::Inch => 2,
        Unit::Metre => 3,
    }
}

/// Returns the unit with the given code.
pub(super) fn unit(number: u32) -> Option<Unit> {
    [Unit::Millimetre, Unit::Inch, Unit::Metre].into_iter().find(|unit| code(*unit) == number)
}

/// Returns a part's header and the sections that follow it, each still to be padded.
pub(super) fn of(part: &Part) -> (Vec<u8>, Vec<&[u8]>) {
    let shapes: Vec<_> =
        part.levels.iter().map(|tree| (tree, lists(tree.slots() as u64))).collect();
    let sections: Vec<&[u8]> = shapes
        .iter()
        .flat_map(|(tree, lists)| lists.iter().map(|(list, _)| list.of(tree)))
        .collect();
    // All at once, on all cores: the header that holds them comes first in the file.
    let mut sums = checksums(&sections).into_iter();

    let records = size_of::<Start>()
        + size_of::<Surveyed>()
        + part.levels.len() * size_of::<FileHeader>()
        + sections.len() * size_of::<SectionHeader>();
    let length = records.next_multiple_of(ALIGN);
    let mut header = vec![0; size_of::<Start>()];
    let surveyed = part.diagnostics.as_ref().map_or_else(Surveyed::zeroed, Surveyed::of);
    header.extend(bytemuck::bytes_of(&surveyed));
    let mut at = length;
    for (tree, lists) in &shapes {
        header.extend(bytemuck::bytes_of(&FileHeader::of(tree)));
        for ((list, _), checksum) in lists.iter().zip(sums.by_ref()) {
            let bytes = list.of(tree).len();
            let section = SectionHeader { at: at as u64, bytes: bytes as u64, checksum, zero: 0 };
            header.extend(bytemuck::bytes_of(&section));
            at += bytes.next_multiple_of(ALIGN);
        }
    }
    // So that the first list begins at a multiple of the alignment.
    header.resize(length, 0);
    let start = Start {
        magic: MAGIC,
        checksum: 0,
        version: VERSION,
        header: length as u64,
        file: at as u64,
        unit: code(part.unit),
        trees: u32::try_from(part.levels.len()).expect("fewer levels than 2^32"),
        surveyed: u32::from(part.diagnostics.is_some()),
        zero: [0; 3],
    };
    header[..size_of::<Start>()].copy_from_slice(bytemuck::bytes_of(&start));
    seal(&mut header);
    (header, sections)
}

/// Writes a header's checksum into it.
pub(super) fn seal(header: &mut [u8]) {
    let sum = header_checksum(header);
    header[CHECKSUM_RANGE].copy_from_slice(&sum.to_le_bytes());
}

/// Returns a header's checksum, computed as if the checksum field were 0.
pub(super) fn header_checksum(header: &[u8]) -> u32 {
    let mut sum = crc32fast::Hasher::new();
    sum.update(&header[..CHECKSUM_RANGE.start]);
    sum.update(&[0; CHECKSUM_RANGE.end - CHECKSUM_RANGE.start]);
    sum.update(&header[CHECKSUM_RANGE.end..]);
    sum.finalize()
}

/// Returns the checksum of each section, padded with zeros to a multiple of [`ALIGN`]: the CRC-32 of the CRC-32s of its
/// chunks. A CRC-32 detects every change within 32 consecutive bits. A flipped bit is therefore always detected: it
/// changes its chunk's CRC-32, which is 32 consecutive bits of the input of the last CRC-32.
pub(super) fn checksums(sections: &[&[u8]]) -> Vec<u32> {
    let chunks: Vec<&[u8]> = sections.iter().flat_map(|bytes| bytes.chunks(CHUNK)).collect();
    // In chunks, so that one long list is not left to one core.
    let sums = parallel::ranges(chunks.len(), 1, |at| {
        let chunk = chunks[at.start];
        let mut sum = crc32fast::Hasher::new();
        sum.update(chunk);
        sum.update(&[0; ALIGN][..chunk.len().next_multiple_of(ALIGN) - chunk.len()]);
        sum.finalize()
    });
    let mut sums = sums.into_iter();
    let counts = sections.iter().map(|bytes| bytes.len().div_ceil(CHUNK));
    counts
        .map(|count| {
            let mut sum = crc32fast::Hasher::new();
            sums.by_ref().take(count).for_each(|chunk| sum.update(&chunk.to_le_bytes()));
            sum.finalize()
        })
        .collect()
}
