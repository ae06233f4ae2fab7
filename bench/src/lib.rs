//! Measurement library: the measurements behind the commands of `touchoff-bench`, the other methods that are timed for
//! comparison, and the writers of the pages in `docs/measured`. No package that a user installs depends on it.

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
