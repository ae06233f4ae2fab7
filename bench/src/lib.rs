//! The laboratory: the measurements behind the commands of the program, other methods to race against, and the pages that
//! are written. Nothing that a user installs depends on it.

pub mod certified;
pub mod compile;
pub mod haptics;
pub mod mutants;
pub mod page;
pub mod parallel;
#[cfg(feature = "peers")]
pub mod peers;
pub mod plot;
pub mod postures;
pub mod race;
pub mod rounding;
pub mod stress;
pub mod work_precision;
