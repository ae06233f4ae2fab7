//! What the tests stand on: oracles that share no code with the project.

pub mod measure;
pub mod oracle;
#[cfg(feature = "peers")]
pub mod peers;
pub mod plot;
pub mod race;
