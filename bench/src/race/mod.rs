//! Methods that answer the same question, asked in turns and timed.

pub mod clock;
pub mod contender;
