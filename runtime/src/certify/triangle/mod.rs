//! One triangle by itself: the ways through it along which it is deepest, and its halves.

pub(crate) mod course;
pub(crate) mod facet;
pub(crate) mod piece;
