//! Typed indices.

use std::fmt;

/// A triangle of a mesh: its position in the mesh's list, which is the order of the file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct TriangleId(pub u32);

impl TriangleId {
    /// Returns the position in the mesh's list.
    pub const fn index(self) -> usize {
        self.0 as usize
    }
}

impl fmt::Display for TriangleId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

/// A surface of a tool: its position in [`ToolInfo::surfaces`](crate::tool::ToolInfo::surfaces).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct SurfaceId(pub usize);
