//! Reading a saved part, and recognition of files that are not saved parts.

use crate::bvh::{Frame, WIDTH};
use crate::cloud::CoveringRadius;
use crate::mesh::is_valid_coordinate;
use crate::part::Part;
use crate::point_bvh::PointBvh;
use crate::storage::SavedError;
use crate::storage::layout::{
    ALIGN, FileHeader, List, MAGIC, SectionHeader, Start, Surveyed, VERSION, checksums,
    header_checksum, lists, unit,
};
use bytemuck::Pod;
use nalgebra::Point3;
use std::io::{self, Cursor, Read};
use std::mem::size_of;
use std::ops::Range;

/// Reads the part in a file of `length` bytes; errors name it as `file`. The lists are copied into
/// memory before they are checked, so later changes of the file have no effect.
pub(super) fn part(source: impl Read, length: u64, file: &str) -> Result<Part, SavedError> {
    let about = FileContext { length, file };
    let (start, header, mut rest) = about.start(source)?;
    let mut records = Records { about: &about, left: &header[size_of::<Start>()..] };
    let surveyed: Surveyed = records.next()?;
    let survey = match start.surveyed {
        0 => None,
        1 => Some(
            surveyed.survey().ok_or_else(|| about.unsound("its survey has impossible numbers"))?,
        ),
        _ => return Err(about.unsound("it neither has a survey nor has none")),
    };
    let unit = unit(start.unit).ok_or_else(|| about.unsound("it names no known unit"))?;
    if start.trees == 0 {
        return Err(about.unsound("it has no points"));
    }
    let mut outlines = Vec::new();
    let mut at = start.header;
    for _ in 0..start.trees {
        outlines.push(records.outline(&mut at)?);
    }
    if at != start.file || records.left.len() >= ALIGN {
        return Err(about.unsound("its lists do not fill it"));
    }
    let trees = outlines.iter().enumerate();
    let levels = trees.map(|(tree, outline)| about.tree(tree, outline, &mut rest));
    Ok(Part { levels: levels.collect::<Result<_, _>>()?, unit, diagnostics: survey })
}

/// The length and the name of the file, for checks and errors.
struct FileContext<'a> {
    length: u64,
    file: &'a str,
}

/// The records of a header that have not been read yet.
struct Records<'a> {
    about: &'a FileContext<'a>,
    left: &'a [u8],
}

/// A tree as described in the header.
struct Outline {
    stem: FileHeader,
    lists: Vec<ListLocation>,
}

/// The location of a list of `bytes` bytes; `filled` includes the padding.
struct ListLocation {
    list: List,
    bytes: usize,
    filled: Range<u64>,
    checksum: u32,
}

impl FileContext<'_> {
    fn unsound(&self, what: impl Into<String>) -> SavedError {
        SavedError::Inconsistent { file: self.file.to_owned(), what: what.into() }
    }

    fn misplaced(&self, list: List) -> SavedError {
        self.unsound(format!("{list} are not where they should be"))
    }

    fn unreadable(&self, source: io::Error) -> SavedError {
        SavedError::Unreadable { file: self.file.to_owned(), source }
    }

    fn truncated(&self, needs: u64) -> SavedError {
        SavedError::Truncated { file: self.file.to_owned(), has: self.length, needs }
    }

    fn damaged(&self, section: String, bytes: &Range<u64>) -> SavedError {
        let (from, to) = (bytes.start, bytes.end);
        SavedError::Damaged { file: self.file.to_owned(), section, from, to }
    }

    /// Reads the file's beginning and header. Returns them with the rest of the source, after checking the file length.
    fn start(&self, mut source: impl Read) -> Result<(Start, Vec<u8>, impl Read), SavedError> {
        let (file, has) = (self.file.to_owned(), self.length);
        let mut bytes = Vec::new();
        // A little first: a file of another kind is described, not read.
        let beginning = source.by_ref().take(PREFIX_LENGTH as u64).read_to_end(&mut bytes);
        beginning.map_err(|source| self.unreadable(source))?;
        let known = bytes.len().min(MAGIC.len());
        if bytes.is_empty() || bytes[..known] != MAGIC[..known] {
            return Err(SavedError::UnknownFormat { file, seems: describe(&bytes, has) });
        }
        let Some(start) = bytes.get(..size_of::<Start>()) else {
            return Err(self.truncated(size_of::<Start>() as u64));
        };
        let start: Start = bytemuck::pod_read_unaligned(start);
        // The length of the file comes before the checksum of the header, which a file that was cut off lacks.
        if start.header > has {
            if start.file > has {
                return Err(self.truncated(start.file));
            }
            return Err(self.damaged("the header".to_owned(), &(0..size_of::<Start>() as u64)));
        }
        let mut source = Cursor::new(bytes).chain(source);
        let mut header = Vec::new();
        let whole = source.by_ref().take(start.header).read_to_end(&mut header);
        whole.map_err(|source| self.unreadable(source))?;
        if header.len() < size_of::<Start>() || header_checksum(&header) != start.checksum {
            let bytes = 0..header.len().max(size_of::<Start>()) as u64;
            return Err(self.damaged("the header".to_owned(), &bytes));
        }
        // A newer version may lay out its lists differently, but not the beginning of its header.
        if start.version > VERSION {
            let (version, reads) = (start.version, VERSION);
            return Err(SavedError::Newer { file, version, reads });
        }
        if start.version != VERSION {
            return Err(self.unsound(format!("there is no version {}", start.version)));
        }
        match start.file {
            needs if needs > has => Err(self.truncated(needs)),
            needs if needs < has => Err(SavedError::Trailing { file, has, needs }),
            _ => Ok((start, header, source)),
        }
    }

    /// Reads the next tree of the file.
    fn tree(
        &self,
        number: usize,
        Outline { stem, lists }: &Outline,
        source: &mut impl Read,
    ) -> Result<PointBvh, SavedError> {
        let sizes = [stem.weight, stem.radius, stem.size.into(), stem.leaf_size.into(), stem.scale];
        let is_size = |size: &f64| *size >= 0.0 && is_valid_coordinate(*size);
        if !(stem.scale > 0.0 && sizes.iter().all(is_size)) {
            return Err(self.unsound("a tree has a size that is no size"));
        }
        if !stem.origin.iter().all(|coordinate| is_valid_coordinate(*coordinate)) {
            return Err(self.unsound("a tree has a frame without a place"));
        }
        if u64::from(stem.gone) > stem.points {
            return Err(self.unsound("a tree lacks more points than it has"));
        }
        let mut levels = Vec::new();
        let (mut leaves, mut attributes, mut triangles) = (None, None, None);
        for place in lists {
            match place.list {
                List::Boxes(_) => levels.push(self.list(number, place, source)?),
                List::Leaves => leaves = Some(self.list(number, place, source)?),
                List::Skins => attributes = Some(self.list(number, place, source)?),
                List::Triangles => triangles = Some(self.list(number, place, source)?),
            }
        }
        let (Some(leaves), Some(attributes), Some(triangles)) = (leaves, attributes, triangles)
        else {
            return Err(self.unsound("a tree lacks a list"));
        };
        let tree = PointBvh {
            frame: Frame { origin: Point3::from(stem.origin), scale: stem.scale, size: stem.size },
            levels,
            leaves,
            leaf_size: stem.leaf_size,
            attributes,
            weight: stem.weight,
            triangles,
            covering_radius: match stem.cover {
                0 => None,
                1 => Some(CoveringRadius { radius: stem.radius, proved: false }),
                2 => Some(CoveringRadius { radius: stem.radius, proved: true }),
                _ => return Err(self.unsound("a tree has an unknown kind of cover")),
            },
            removed: stem.gone as usize,
        };
        if ends(&tree) {
            Ok(tree)
        } else {
            Err(self.unsound("a tree has boxes or points of nothing"))
        }
    }

    /// Reads and checks the next list of the file.
    fn list<T: Pod>(
        &self,
        tree: usize,
        place: &ListLocation,
        source: &mut impl Read,
    ) -> Result<Vec<T>, SavedError> {
        let mut list: Vec<T> = vec![T::zeroed(); place.bytes / size_of::<T>()];
        let bytes: &mut [u8] = bytemuck::cast_slice_mut(&mut list);
        let mut filling = [0; ALIGN];
        let filling = &mut filling[..place.bytes.next_multiple_of(ALIGN) - place.bytes];
        // Straight into its final place, which is then checked there.
        let read = source.read_exact(bytes).and_then(|()| source.read_exact(filling));
        read.map_err(|source| self.unreadable(source))?;
        if filling.iter().any(|byte| *byte != 0) || checksums(&[bytes])[0] != place.checksum {
            return Err(self.damaged(format!("{} of tree {tree}", place.list), &place.filled));
        }
        Ok(list)
    }
}

/// Returns whether every level is padded with empty (NaN) boxes after its last item. Every index that a
/// query meets is then that of an existing box, leaf or point.
fn ends(tree: &PointBvh) -> bool {
    let below = tree.levels.iter().skip(1).map(|level| level.len()).chain([tree.leaves.len()]);
    let boxes = tree
        .levels
        .iter()
        .zip(below)
        .all(|(level, below)| level.last().is_some_and(|last| is_padded(&last.centre, below)));
    boxes && tree.leaves.last().is_some_and(|last| is_padded(&last.offset, tree.slots()))
}

/// Returns whether the last block of a list of `count` items is NaN after its last item.
fn is_padded(block: &[[f32; WIDTH]; 3], count: usize) -> bool {
    // A full node has no padding.
    let used = (count + WIDTH - 1) % WIDTH + 1;
    block.iter().all(|list| list[used..].iter().all(|part| part.is_nan()))
}

impl Records<'_> {
    fn next<T: Pod>(&mut self) -> Result<T, SavedError> {
        let Some((record, left)) = self.left.split_at_checked(size_of::<T>()) else {
            return Err(self.about.unsound("its header ends too early"));
        };
        self.left = left;
        Ok(bytemuck::pod_read_unaligned(record))
    }

    /// Reads the description of a tree whose lists begin at offset `end`, and moves `end` to the end of the lists.
    fn outline(&mut self, end: &mut u64) -> Result<Outline, SavedError> {
        let stem: FileHeader = self.next()?;
        let about = self.about;
        if stem.points == 0 || u32::try_from(stem.points).is_err() {
            return Err(about.unsound(format!("a tree has {} points", stem.points)));
        }
        let mut places = Vec::new();
        for (list, count) in lists(stem.points) {
            let section: SectionHeader = self.next()?;
            // Items have at most 384 bytes, and there are fewer than 2^32 of them, so the product does not overflow.
            let bytes = count * list.item();
            if (section.at, section.bytes) != (*end, bytes)
                || !section.at.is_multiple_of(ALIGN as u64)
            {
                return Err(about.misplaced(list));
            }
            let filled_to = end.checked_add(bytes.next_multiple_of(ALIGN as u64));
            let filled_to =
                filled_to.filter(|to| *to <= about.length).ok_or_else(|| about.misplaced(list))?;
            let bytes = usize::try_from(bytes).map_err(|_| about.misplaced(list))?;
            places.push(ListLocation {
                list,
                bytes,
                filled: *end..filled_to,
                checksum: section.checksum,
            });
            *end = filled_to;
        }
        Ok(Outline { stem, lists: places })
    }
}

/// Letters that occur at the beginning of every saved part.
const NAME: &[u8] = b"TOUCHOFF";
/// The number of bytes examined at the beginning of a file.
const PREFIX_LENGTH: usize = 512;
/// Bytes of a binary STL file before its triangles, and per triangle.
const STL: [u64; 2] = [84, 50];

/// Initial bytes of known file formats.
const SIGNATURES: [(&[u8], &str); 12] = [
    (b"solid", "an STL mesh (text)"),
    (b"ply\n", "a PLY file"),
    (b"ply\r", "a PLY file"),
    (b"ISO-10303-21", "a STEP file"),
    (b"PK\x03\x04", "a zip archive (3MF is one)"),
    (b"\x1f\x8b", "a gzip archive"),
    (b"\x28\xb5\x2f\xfd", "a zstd archive"),
    (b"\x89PNG", "a PNG picture"),
    (b"\x89HDF", "an HDF5 file"),
    (b"glTF", "a glTF mesh"),
    (b"\x7fELF", "a program"),
    (b"version https://git-lfs", "a pointer of Git LFS: `git lfs pull` brings the file itself"),
];

/// Returns a description of a file of `length` bytes that begins with `prefix`.
fn describe(prefix: &[u8], length: u64) -> &'static str {
    let prefix = &prefix[..prefix.len().min(PREFIX_LENGTH)];
    if prefix.is_empty() {
        return "an empty file";
    }
    if (0..=3).any(|at| prefix.get(at..).is_some_and(|rest| rest.starts_with(NAME))) {
        return "a saved part that was changed on its way, as where it is sent as text: send it \
                as binary";
    }
    if prefix.iter().all(|byte| *byte == 0) {
        return "zeros, as a copy that was interrupted leaves them";
    }
    if let Some((_, kind)) = SIGNATURES.iter().find(|(start, _)| prefix.starts_with(start)) {
        return kind;
    }
    // Binary STL has no signature, but its length follows from its count.
    if let Some(count) = prefix.get(80..84) {
        let triangles = count.iter().rev().fold(0, |count, byte| count << 8 | u64::from(*byte));
        if STL[0] + STL[1] * triangles == length {
            return "an STL mesh (binary)";
        }
    }
    let Ok(text) = str::from_utf8(prefix).or_else(|error| {
        // The last character may be cut in two.
        str::from_utf8(&prefix[..error.valid_up_to().max(PREFIX_LENGTH - 4).min(prefix.len())])
    }) else {
        return "a binary file of another program";
    };
    match text {
        _ if text.lines().any(is_obj_line) => "an OBJ mesh",
        _ if text.starts_with(['{', '[']) => "a JSON file",
        _ if text.starts_with('<') => "an XML or HTML file",
        _ if text.chars().any(|c| c.is_control() && !c.is_whitespace()) => {
            "a binary file of another program"
        }
        _ => "a text file",
    }
}

fn is_obj_line(line: &str) -> bool {
    ["v ", "vn ", "f ", "mtllib "].iter().any(|keyword| line.starts_with(keyword))
}
