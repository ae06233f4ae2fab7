//! Bounds that hold for whole boxes and triangles, several at a time in SIMD lanes, and the tree traversal that uses
//! them.
//!
//! - `hull`: upper bounds of a tool's depth in boxes and triangles.
//! - `support`: upper bounds of depth beside a triangle, by planes that touch the tool.
//! - `shell`: lower bounds of a tool's distance from boxes and triangles, in `f32`.
//! - `swept`: upper bounds of depth in moving boxes and triangles.
//! - `batch`: eight triangles in `f64`.
//! - `descent`: depth-first traversal of the tree, children with the largest bounds first.
//! - `nearest`, `clip`, `ring`: geometry of triangles relative to the tool's axis, shared by all bounds.
//! - `lanes`: vectors in SIMD lanes.
//!
//! Lengths are in the tool's unit. Absent boxes and triangles have NaN coordinates. A bound at or below the caller's
//! threshold need not be tight.

pub(crate) mod batch;
pub(crate) mod clip;
pub(crate) mod descent;
pub(crate) mod hull;
pub(crate) mod lanes;
pub(crate) mod nearest;
pub(crate) mod ring;
pub(crate) mod shell;
pub(crate) mod support;
pub(crate) mod swept;
