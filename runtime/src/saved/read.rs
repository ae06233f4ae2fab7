//! From a file's bytes to the part that they are.

use super::SavedError;
use super::foreign::seems;
use super::layout::{
    ALIGN, List, MAGIC, Section, Start, Stem, Surveyed, VERSION, checksums, header_checksum, lists,
    unit,
};
use crate::Part;
use crate::cloud::Cover;
use crate::tree::{Frame, Shelf, Tree, WIDTH};
use bytemuck::Pod;
use memmap2::Mmap;
use nalgebra::Point3;
use std::mem::size_of;
use std::ops::Range;
use std::sync::Arc;

/// The part of a whole file, whose name is `file`.
pub(super) fn part(map: &Arc<Mmap>, file: &str) -> Result<Part, SavedError> {
    let reader = Reader { map, file };
    let (start, header) = reader.start()?;
    let mut records = Records { reader: &reader, left: &header[size_of::<Start>()..] };
    let unsound = |what: &str| reader.unsound(what.to_owned());

    let surveyed: Surveyed = records.next()?;
    let survey = match start.surveyed {
        0 => None,
        1 => Some(surveyed.survey().ok_or_else(|| unsound("its survey has impossible numbers"))?),
        _ => return Err(unsound("it neither has a survey nor has none")),
    };
    let unit = unit(start.unit).ok_or_else(|| unsound("it names no known unit"))?;
    if start.trees == 0 {
        return Err(unsound("it has no points"));
    }
    let mut outlines = Vec::new();
    let mut at = start.header;
    for _ in 0..start.trees {
        outlines.push(records.outline(&mut at)?);
    }
    if at != start.file || records.left.len() >= ALIGN {
        return Err(unsound("its lists do not fill it"));
    }
    reader.check(&outlines)?;
    let levels = outlines.iter().map(|outline| reader.tree(outline));
    Ok(Part { levels: levels.collect::<Result<_, _>>()?, unit, survey })
}

/// A file, and what is to be said of it.
struct Reader<'a> {
    map: &'a Arc<Mmap>,
    file: &'a str,
}

/// The records of a header that have not been read yet.
struct Records<'a> {
    reader: &'a Reader<'a>,
    left: &'a [u8],
}

/// A tree as the header has it.
struct Outline {
    stem: Stem,
    lists: Vec<Place>,
}

/// Where a list lies: all of it, and with what fills it up.
struct Place {
    list: List,
    bytes: Range<usize>,
    filled: Range<usize>,
    checksum: u32,
}

impl Reader<'_> {
    fn unsound(&self, what: String) -> SavedError {
        SavedError::Unsound { file: self.file.to_owned(), what }
    }

    fn damaged(&self, section: String, bytes: &Range<usize>) -> SavedError {
        let (from, to) = (bytes.start as u64, bytes.end as u64);
        SavedError::Damaged { file: self.file.to_owned(), section, from, to }
    }

    /// What the file begins with, and its header; the file is as long as these say.
    fn start(&self) -> Result<(Start, &[u8]), SavedError> {
        let (bytes, file) = (&self.map[..], || self.file.to_owned());
        let has = bytes.len() as u64;
        let truncated = |needs| Err(SavedError::Truncated { file: file(), has, needs });
        let known = bytes.len().min(MAGIC.len());
        if bytes.is_empty() || bytes[..known] != MAGIC[..known] {
            return Err(SavedError::Foreign { file: file(), seems: seems(bytes) });
        }
        let Some(start) = bytes.get(..size_of::<Start>()) else {
            return truncated(size_of::<Start>() as u64);
        };
        let start: Start = bytemuck::pod_read_unaligned(start);
        let length = usize::try_from(start.header).ok().filter(|length| *length <= bytes.len());
        let Some(header) = length.and_then(|length| bytes.get(..length)) else {
            if start.file > has {
                return truncated(start.file);
            }
            return Err(self.damaged("the header".to_owned(), &(0..size_of::<Start>())));
        };
        if header.len() < size_of::<Start>() || header_checksum(header) != start.checksum {
            let bytes = 0..header.len().max(size_of::<Start>());
            return Err(self.damaged("the header".to_owned(), &bytes));
        }
        if start.version > VERSION {
            let (version, reads) = (start.version, VERSION);
            return Err(SavedError::Newer { file: file(), version, reads });
        }
        if start.version != VERSION {
            return Err(self.unsound(format!("there is no version {}", start.version)));
        }
        match start.file {
            needs if needs > has => truncated(needs),
            needs if needs < has => Err(SavedError::Trailing { file: file(), has, needs }),
            _ => Ok((start, header)),
        }
    }

    /// Checks every list's checksum.
    fn check(&self, outlines: &[Outline]) -> Result<(), SavedError> {
        let places = || {
            let trees = outlines.iter().enumerate();
            trees.flat_map(|(tree, outline)| outline.lists.iter().map(move |place| (tree, place)))
        };
        let sections: Vec<&[u8]> =
            places().map(|(_, place)| &self.map[place.filled.clone()]).collect();
        let wrong = places()
            .zip(checksums(&sections))
            .find(|((_, place), checksum)| place.checksum != *checksum);
        match wrong {
            None => Ok(()),
            Some(((tree, place), _)) => {
                Err(self.damaged(format!("{} of tree {tree}", place.list), &place.filled))
            }
        }
    }

    fn tree(&self, Outline { stem, lists }: &Outline) -> Result<Tree, SavedError> {
        let unsound = |what: &str| self.unsound(what.to_owned());
        let positive = [stem.weight, stem.radius, stem.size.into(), stem.leaf_size.into()];
        if !(stem.scale > 0.0 && positive.iter().all(|number| *number >= 0.0)) {
            return Err(unsound("a tree has a size that is no size"));
        }
        if u64::from(stem.gone) > stem.points {
            return Err(unsound("a tree lacks more points than it has"));
        }
        let mut levels = Vec::new();
        let (mut leaves, mut skins, mut triangles) = (None, None, None);
        for place in lists {
            match place.list {
                List::Boxes(_) => levels.push(self.shelf(place)?),
                List::Leaves => leaves = Some(self.shelf(place)?),
                List::Skins => skins = Some(self.shelf(place)?),
                List::Triangles => triangles = Some(self.shelf(place)?),
            }
        }
        let (Some(leaves), Some(skins), Some(triangles)) = (leaves, skins, triangles) else {
            return Err(unsound("a tree lacks a list"));
        };
        let tree = Tree {
            frame: Frame { origin: Point3::from(stem.origin), scale: stem.scale, size: stem.size },
            levels,
            leaves,
            leaf_size: stem.leaf_size,
            skins,
            weight: stem.weight,
            triangles,
            cover: match stem.cover {
                0 => None,
                1 => Some(Cover { radius: stem.radius, proved: false }),
                2 => Some(Cover { radius: stem.radius, proved: true }),
                _ => return Err(unsound("a tree has an unknown kind of cover")),
            },
            gone: stem.gone as usize,
        };
        if ends(&tree) { Ok(tree) } else { Err(unsound("a tree has boxes or points of nothing")) }
    }

    fn shelf<T: Pod>(&self, place: &Place) -> Result<Shelf<T>, SavedError> {
        let shelf = Shelf::mapped(self.map, place.bytes.clone());
        shelf.ok_or_else(|| self.unsound(format!("{} are not where they should be", place.list)))
    }
}

/// Whether a descent can lead to nothing that is not there: behind the last of every level come only
/// boxes that are none. Then every index that a query meets is that of a box, a leaf or a point.
fn ends(tree: &Tree) -> bool {
    let none = |centre: &[[f32; WIDTH]; 3], count: usize| {
        // Of a full one all are there.
        let used = (count + WIDTH - 1) % WIDTH + 1;
        centre.iter().all(|list| list[used..].iter().all(|part| part.is_nan()))
    };
    let below = tree.levels.iter().skip(1).map(|level| level.len()).chain([tree.leaves.len()]);
    let boxes = tree
        .levels
        .iter()
        .zip(below)
        .all(|(level, below)| level.last().is_some_and(|last| none(&last.centre, below)));
    boxes && tree.leaves.last().is_some_and(|last| none(&last.offset, tree.places()))
}

impl Records<'_> {
    fn next<T: Pod>(&mut self) -> Result<T, SavedError> {
        let Some((record, left)) = self.left.split_at_checked(size_of::<T>()) else {
            return Err(self.reader.unsound("its header ends too early".to_owned()));
        };
        self.left = left;
        Ok(bytemuck::pod_read_unaligned(record))
    }

    /// A tree whose lists begin at `end`, which moves to where they end.
    fn outline(&mut self, end: &mut u64) -> Result<Outline, SavedError> {
        let stem: Stem = self.next()?;
        let reader = self.reader;
        if stem.points == 0 || u32::try_from(stem.points).is_err() {
            return Err(reader.unsound(format!("a tree has {} points", stem.points)));
        }
        let mut places = Vec::new();
        for (list, count) in lists(stem.points) {
            let section: Section = self.next()?;
            // Items have at most 384 bytes, and there are fewer than 2^32.
            let bytes = count * list.item();
            let misplaced = || reader.unsound(format!("{list} are not where they should be"));
            if (section.at, section.bytes) != (*end, bytes)
                || !section.at.is_multiple_of(ALIGN as u64)
            {
                return Err(misplaced());
            }
            let filled_to = end.checked_add(bytes.next_multiple_of(ALIGN as u64));
            let filled_to = filled_to.filter(|to| *to <= reader.map.len() as u64);
            let filled_to = filled_to.ok_or_else(misplaced)?;
            // Both are within the file, which is in memory.
            let (at, to) = (*end as usize, filled_to as usize);
            let bytes = at..at + bytes as usize;
            places.push(Place { list, bytes, filled: at..to, checksum: section.checksum });
            *end = filled_to;
        }
        Ok(Outline { stem, lists: places })
    }
}
