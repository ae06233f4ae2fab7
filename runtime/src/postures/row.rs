//! What is known of a triangle.

use std::cmp::Ordering;

/// A posture on record: how a tool stands at a triangle, and what is proved of it. Lengths are in the
/// part's unit, places in its frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Record {
    /// The tool, by its place in the map's list.
    pub tool: u16,
    /// Where its tip is.
    pub tip: [f64; 3],
    /// The unit vector from the tip to the spindle.
    pub axis: [f64; 3],
    /// How good the contact is, the least niceness of its points.
    pub niceness: f64,
    /// No place of the part is deeper in the tool.
    pub depth: f64,
    /// What of the tool does not cut is no nearer to the part; 0 where it touches as deep as is allowed.
    pub clearance: f64,
}

impl Record {
    /// Which of two is better: the nicer, then that with more clearance, then the less deep, then the
    /// earlier tool; where all is the same, the order of their numbers.
    pub fn order(&self, other: &Record) -> Ordering {
        let numbers = |record: &Record| [record.tip, record.axis].concat();
        let (mine, others) = (numbers(self), numbers(other));
        let by_number = mine.iter().zip(&others).map(|(a, b)| a.total_cmp(b));
        (other.niceness as f32)
            .total_cmp(&(self.niceness as f32))
            .then(other.clearance.total_cmp(&self.clearance))
            .then(self.depth.total_cmp(&other.depth))
            .then(self.tool.cmp(&other.tool))
            .then_with(|| by_number.fold(Ordering::Equal, Ordering::then))
    }
}

/// From where a tool reaches a triangle.
#[derive(Clone, Debug, PartialEq)]
pub struct Access {
    /// The tool, by its place in the map's list.
    pub tool: u16,
    /// The directions from which it does, by their place in the map's list: bit `k % 64` of word `k / 64`.
    pub directions: Vec<u64>,
    /// How far it sticks out of its holder at least, where one of these directions needs the least;
    /// `None` if it has no holder, or no direction is left.
    pub stickout: Option<f64>,
}

/// What a map knows of a triangle.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Row {
    /// The best postures on record, the nicest first.
    pub best: Vec<Record>,
    /// What a sweep found of each tool that it tried here; empty where none came by.
    pub access: Vec<Access>,
}
