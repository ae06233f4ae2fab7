//! A single triangle: the lines in it on which depth can be greatest, and its subdivision.

pub(crate) mod line_search;
pub(crate) mod local;
pub(crate) mod subdivision;
