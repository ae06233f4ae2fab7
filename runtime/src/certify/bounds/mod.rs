//! Upper bounds of depth in boxes and triangles, several at a time in SIMD lanes, at rest and in motion.

pub(crate) mod batch;
pub(crate) mod descent;
pub(crate) mod hull;
pub(crate) mod nearest;
pub(crate) mod shell;
pub(crate) mod swept;
pub(crate) mod swept_batch;
