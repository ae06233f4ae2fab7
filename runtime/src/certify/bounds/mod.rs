//! What depth is no more than: in boxes and triangles side by side, at rest and on their way.

pub(crate) mod batch;
pub(crate) mod descent;
pub(crate) mod hull;
pub(crate) mod nearest;
pub(crate) mod shell;
pub(crate) mod swath;
pub(crate) mod swept;
