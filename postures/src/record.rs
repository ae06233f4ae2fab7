//! Data on record for a triangle.

use super::Piece;
use nalgebra::Point3;
use serde::{Deserialize, Serialize};
use std::cmp::Ordering;
use std::num::NonZeroU16;
use touchoff::{Pose, PoseError};

/// A posture on record: the pose of a tool at a triangle, its niceness, and its proved bounds. Lengths are in
/// the part's unit, points in its frame.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct PostureRecord {
    /// Index of the tool in the map's list.
    pub tool: u16,
    /// Position of the tip.
    pub tip: [f64; 3],
    /// Unit vector from the tip to the spindle.
    pub axis: [f64; 3],
    /// Niceness of the contact: the least of its points.
    pub niceness: f64,
    /// Upper bound on the depth of the part in the tool.
    pub depth: f64,
    /// Lower bound on the distance between the part and the surfaces that do not cut; 0 where they touch within
    /// their allowance.
    pub clearance: f64,
}

impl PostureRecord {
    /// Returns the validated pose, bit for bit.
    ///
    /// # Errors
    /// If tip and axis do not form a pose. Those of a map always do.
    pub fn pose(&self) -> Result<Pose, PoseError> {
        Pose::from_axis(Point3::from(self.tip), self.axis.into())
    }
}

/// The directions from which a tool reaches a triangle.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Accessibility {
    /// Index of the tool in the map's list.
    pub tool: u16,
    /// Bit set of directions: bit `k % 64` of word `k / 64` stands for direction `k` of the map's list.
    pub directions: Vec<u64>,
    /// Least stick-out from the holder that suffices for one of these directions, in the part's unit; `None` if
    /// the tool has no holder or the set is empty.
    pub stickout: Option<f64>,
}

/// A row of a map: the data on record for a triangle.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct MapRow {
    /// The best postures on record, the nicest first.
    pub best: Vec<PostureRecord>,
    /// One entry per tool that a sweep tried at this triangle; empty if no sweep has processed it.
    pub access: Vec<Accessibility>,
}

impl Accessibility {
    /// Returns whether the tool reaches the triangle, or the piece of one.
    pub fn is_reached(&self) -> bool {
        self.directions.iter().any(|word| *word != 0)
    }

    fn join(&mut self, other: &Accessibility) {
        let words = self.directions.iter_mut().zip(&other.directions);
        words.for_each(|(word, other)| *word |= other);
        self.stickout = match (self.stickout, other.stickout) {
            (Some(one), Some(other)) => Some(one.min(other)),
            (one, other) => one.or(other),
        };
    }
}

impl MapRow {
    /// Joins the rows of the pieces of a triangle to one: the best `keep` postures of all, and per tool the directions
    /// from which it reaches any of the pieces, with the least stick-out.
    pub fn joined(pieces: &[(Piece, MapRow)], keep: NonZeroU16) -> MapRow {
        let mut joined = MapRow::default();
        for (_, row) in pieces {
            merge(&mut joined.best, &row.best, keep);
            for access in &row.access {
                match joined.access.iter_mut().find(|known| known.tool == access.tool) {
                    Some(known) => known.join(access),
                    None => joined.access.push(access.clone()),
                }
            }
        }
        joined
    }

    /// Returns the lines of a table: the postures, the best first, each with its tool's accessibility, and then the tools without a
    /// posture.
    pub(crate) fn lines(
        &self,
    ) -> impl Iterator<Item = (Option<&PostureRecord>, Option<&Accessibility>)> {
        let access = |tool: u16| self.access.iter().find(move |access| access.tool == tool);
        let records = self.best.iter().map(move |record| (Some(record), access(record.tool)));
        let others = self
            .access
            .iter()
            .filter(|access| self.best.iter().all(|record| record.tool != access.tool));
        records.chain(others.map(|access| (None, Some(access))))
    }

    /// Returns the fraction of a triangle's area at a piece of it, with this row, that a tool reaches; `None` if no sweep
    /// tried the tool there.
    fn area_fraction(&self, piece: Piece, tool: u16) -> Option<f64> {
        let access = self.access.iter().find(|access| access.tool == tool)?;
        Some(if access.is_reached() { piece.fraction() } else { 0.0 })
    }
}

/// Returns the fraction of a triangle's area that a tool reaches, by its pieces; `None` if no sweep tried the tool at one of them.
pub(crate) fn area_reached(pieces: &[(Piece, MapRow)], tool: u16) -> Option<f64> {
    pieces.iter().map(|(piece, row)| row.area_fraction(*piece, tool)).sum()
}

/// Returns the number of directions from which a tool reaches a triangle.
pub(crate) fn direction_count(access: &Accessibility) -> u32 {
    access.directions.iter().map(|word| word.count_ones()).sum()
}

/// Orders the better posture first: the nicer one; of two that are equal but for rounding to `f32`, the one
/// with more clearance; then the less deep. The remaining fields make the result independent of the order of
/// arrival.
fn order(one: &PostureRecord, other: &PostureRecord) -> Ordering {
    // Rounding errors of niceness must not decide before clearance does.
    let nicer = (other.niceness as f32).total_cmp(&(one.niceness as f32));
    let clearer = other.clearance.total_cmp(&one.clearance);
    let [rest, other_rest] = [one, other].map(|record| {
        let ([x, y, z], [i, j, k]) = (record.tip, record.axis);
        [record.depth, f64::from(record.tool), x, y, z, i, j, k, record.niceness]
    });
    let pairs = rest.into_iter().zip(other_rest);
    let rest = pairs.map(|(a, b)| a.total_cmp(&b)).fold(Ordering::Equal, Ordering::then);
    nicer.then(clearer).then(rest)
}

/// Adds postures to a list and keeps the best `keep` of them, each once, the best first.
pub(crate) fn merge(best: &mut Vec<PostureRecord>, more: &[PostureRecord], keep: NonZeroU16) {
    best.extend(more);
    best.sort_by(order);
    best.dedup_by(|one, other| order(one, other).is_eq());
    best.truncate(keep.get().into());
}
