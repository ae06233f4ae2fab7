//! Oracles that share no code with the project, and the scenes and tools that the tests use.

pub mod checks;
pub mod count;
pub mod evaluations;
pub mod fixtures;
pub mod fusion;
pub mod haptics;
pub mod library;
pub mod oracle;
pub mod points;
pub mod profiles;
pub mod tally;
pub mod texts;
pub mod turns;
