//! What the tests stand on: oracles that share no code with the project.

pub mod measure;
pub mod oracle;
pub mod plot;
