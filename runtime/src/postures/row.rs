//! What is known of a triangle.

use crate::pose::{Pose, PoseError};
use nalgebra::Point3;
use serde::{Deserialize, Serialize};

/// A posture on record: how a tool stands at a triangle, and what is proved of it. Lengths are in the
/// part's unit, places in its frame.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
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
    /// The pose that was judged, bit for bit.
    ///
    /// # Errors
    /// If tip and axis are none; those of a map are.
    pub fn pose(&self) -> Result<Pose, PoseError> {
        Pose::from_axis(Point3::from(self.tip), self.axis.into())
    }
}

/// From where a tool reaches a triangle.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
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
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// The best postures on record, the nicest first.
    pub best: Vec<Record>,
    /// What a sweep found of each tool that it tried here; empty where none came by.
    pub access: Vec<Access>,
}
