//! Measurement library: the measurements behind the commands of `touchoff-bench`, the other methods that are timed for
//! comparison, and the writer of the pages in `docs/measured`. No package that a user installs depends on it.

pub mod compile;
pub mod haptics;
pub mod page;
#[cfg(feature = "peers")]
pub mod peers;
pub mod plot;
pub mod race;
pub mod work_precision;
