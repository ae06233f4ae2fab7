//! Interleaved timing of methods that answer the same query.

pub mod clock;
pub mod contender;
