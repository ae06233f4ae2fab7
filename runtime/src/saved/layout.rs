//! What stands where in a saved part: its records, and what lies after them.

use crate::bvh::{Boxes, WIDTH};
use crate::cloud::Cover;
use crate::cores;
use crate::mesh::Survey;
use crate::part::Part;
use crate::tree::{Leaf, Skin, Tree};
use crate::unit::Unit;
use bytemuck::{Pod, Zeroable};
use std::fmt;
use std::mem::size_of;

/// As PNG's: a byte above 127, both ends of lines and an end of file, so that what takes a file for
/// text spoils it visibly.
pub(super) const MAGIC: [u8; 16] = *b"\x89TOUCHOFF\r\n\x1a\n\0\0\0";
/// The version that is written, and the newest that is read.
pub(super) const VERSION: u32 = 1;
/// What every section's place and length is a multiple of.
pub(super) const ALIGN: usize = 64;
/// How many bytes a core sums at a time; a multiple of [`ALIGN`]. A change of it changes checksums.
const CHUNK: usize = 1 << 20;
/// Where the header's own checksum is.
const OWN: std::ops::Range<usize> = 16..20;

/// What a file begins with. Up to `file` it is the same in every version.
#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub(super) struct Start {
    pub(super) magic: [u8; 16],
    /// Of the whole header, this field taken for 0.
    pub(super) checksum: u32,
    pub(super) version: u32,
    /// How many bytes the header has, and the file.
    pub(super) header: u64,
    pub(super) file: u64,
    /// 1 mm, 2 inch, 3 m.
    pub(super) unit: u32,
    pub(super) trees: u32,
    /// Whether there is a survey: 0 or 1.
    pub(super) surveyed: u32,
    pub(super) zero: [u32; 3],
}

/// A survey; zeros where there is none.
#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub(super) struct Surveyed {
    area: f64,
    volume: f64,
    unit: u64,
    counts: [u64; 8],
}

/// What a tree has besides its lists. Behind it stands a [`Section`] for each of these.
#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub(super) struct Stem {
    pub(super) origin: [f64; 3],
    pub(super) scale: f64,
    pub(super) weight: f64,
    pub(super) radius: f64,
    pub(super) points: u64,
    pub(super) size: f32,
    pub(super) leaf_size: f32,
    /// The cover: 0 unknown, 1 estimated, 2 proved.
    pub(super) cover: u32,
    /// How many points were taken away.
    pub(super) gone: u32,
}

/// A list: where it begins, how many bytes it has without the zeros that fill it up to a multiple of
/// [`ALIGN`], and the checksum of it and of these.
#[derive(Clone, Copy, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub(super) struct Section {
    pub(super) at: u64,
    pub(super) bytes: u64,
    pub(super) checksum: u32,
    pub(super) zero: u32,
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

/// The lists of a tree of so many points, in the file's order, and how many items each has: boxes
/// from the root's children down. This is the shape that [`Tree::new`] gives them.
pub(super) fn lists(points: u64) -> Vec<(List, u64)> {
    let leaves = points.div_ceil(WIDTH as u64);
    let mut boxes = vec![leaves.div_ceil(WIDTH as u64)];
    while let Some(&count) = boxes.last()
        && count > 1
    {
        boxes.push(count.div_ceil(WIDTH as u64));
    }
    let boxes = boxes.into_iter().rev().enumerate();
    let boxes = boxes.map(|(level, count)| (List::Boxes(level), count));
    let rest = [(List::Leaves, leaves), (List::Skins, leaves), (List::Triangles, points)];
    boxes.chain(rest).collect()
}

impl List {
    /// How many bytes an item has.
    pub(super) fn item(self) -> u64 {
        let size = match self {
            List::Boxes(_) => size_of::<Boxes>(),
            List::Leaves => size_of::<Leaf>(),
            List::Skins => size_of::<Skin>(),
            List::Triangles => size_of::<u32>(),
        };
        size as u64
    }

    fn of(self, tree: &Tree) -> &[u8] {
        match self {
            List::Boxes(level) => bytemuck::cast_slice(&tree.levels[level]),
            List::Leaves => bytemuck::cast_slice(&tree.leaves),
            List::Skins => bytemuck::cast_slice(&tree.skins),
            List::Triangles => bytemuck::cast_slice(&tree.triangles),
        }
    }
}

impl Surveyed {
    fn of(survey: &Survey) -> Surveyed {
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

    /// The survey; `None` if a number cannot be one.
    pub(super) fn survey(&self) -> Option<Survey> {
        let mut counts = [0; 8];
        for (count, stored) in counts.iter_mut().zip(self.counts) {
            *count = usize::try_from(stored).ok()?;
        }
        let [triangles, degenerate, open_edges, crossed_edges, shared_edges, ..] = counts;
        let [.., opposed_normals, shells, inverted_shells] = counts;
        Some(Survey {
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

impl Stem {
    fn of(tree: &Tree) -> Stem {
        let (cover, radius) = match tree.cover {
            None => (0, 0.0),
            Some(Cover { radius, proved }) => (1 + u32::from(proved), radius),
        };
        Stem {
            origin: tree.frame.origin.into(),
            scale: tree.frame.scale,
            weight: tree.weight,
            radius,
            points: tree.places() as u64,
            size: tree.frame.size,
            leaf_size: tree.leaf_size,
            cover,
            gone: tree.gone as u32,
        }
    }
}

/// A unit's number.
fn code(unit: Unit) -> u32 {
    match unit {
        Unit::Millimetre => 1,
        Unit::Inch => 2,
        Unit::Metre => 3,
    }
}

/// The unit of a number.
pub(super) fn unit(number: u32) -> Option<Unit> {
    [Unit::Millimetre, Unit::Inch, Unit::Metre].into_iter().find(|unit| code(*unit) == number)
}

/// A part's header, and what comes after it, to be filled up section by section.
pub(super) fn of(part: &Part) -> (Vec<u8>, Vec<&[u8]>) {
    let shapes: Vec<_> =
        part.levels.iter().map(|tree| (tree, lists(tree.places() as u64))).collect();
    let sections: Vec<&[u8]> = shapes
        .iter()
        .flat_map(|(tree, lists)| lists.iter().map(|(list, _)| list.of(tree)))
        .collect();
    let mut sums = checksums(&sections).into_iter();

    let records = size_of::<Start>()
        + size_of::<Surveyed>()
        + part.levels.len() * size_of::<Stem>()
        + sections.len() * size_of::<Section>();
    let length = records.next_multiple_of(ALIGN);
    let mut header = vec![0; size_of::<Start>()];
    let surveyed = part.survey.as_ref().map_or_else(Surveyed::zeroed, Surveyed::of);
    header.extend(bytemuck::bytes_of(&surveyed));
    let mut at = length;
    for (tree, lists) in &shapes {
        header.extend(bytemuck::bytes_of(&Stem::of(tree)));
        for ((list, _), checksum) in lists.iter().zip(sums.by_ref()) {
            let bytes = list.of(tree).len();
            let section = Section { at: at as u64, bytes: bytes as u64, checksum, zero: 0 };
            header.extend(bytemuck::bytes_of(&section));
            at += bytes.next_multiple_of(ALIGN);
        }
    }
    header.resize(length, 0);
    let start = Start {
        magic: MAGIC,
        checksum: 0,
        version: VERSION,
        header: length as u64,
        file: at as u64,
        unit: code(part.unit),
        trees: u32::try_from(part.levels.len()).expect("fewer levels than 2^32"),
        surveyed: u32::from(part.survey.is_some()),
        zero: [0; 3],
    };
    header[..size_of::<Start>()].copy_from_slice(bytemuck::bytes_of(&start));
    seal(&mut header);
    (header, sections)
}

/// Writes a header's checksum into it.
pub(super) fn seal(header: &mut [u8]) {
    let sum = header_checksum(header);
    header[OWN].copy_from_slice(&sum.to_le_bytes());
}

/// A header's checksum, whatever stands in its place.
pub(super) fn header_checksum(header: &[u8]) -> u32 {
    let mut sum = crc32fast::Hasher::new();
    sum.update(&header[..OWN.start]);
    sum.update(&[0; OWN.end - OWN.start]);
    sum.update(&header[OWN.end..]);
    sum.finalize()
}

/// The checksum of each of some sections, filled up with zeros to a multiple of [`ALIGN`]: the CRC-32
/// of the CRC-32s of its chunks. A CRC-32 finds every change within 32 bits side by side. So a flipped
/// bit is found for certain: it changes its chunk's, which is 32 bits of what the last is taken of.
pub(super) fn checksums(sections: &[&[u8]]) -> Vec<u32> {
    let chunks: Vec<&[u8]> = sections.iter().flat_map(|bytes| bytes.chunks(CHUNK)).collect();
    let sums = cores::ranges(chunks.len(), 1, |at| {
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
