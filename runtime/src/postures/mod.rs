//! Postures: where tools stand well at a part, triangle by triangle (Ho 1999, chapter 6).

mod judge;
mod map;
mod ramp;
#[cfg(feature = "haptic")]
mod recorder;
mod row;

pub use judge::{Judge, JudgeError, Rules, RulesError};
pub use map::{Coverage, Difference, Identity, MapError, PartStamp, PostureMap, Rows, ToolStamp};
pub use ramp::colour;
#[cfg(feature = "haptic")]
pub use recorder::{Recorded, Recorder, RecorderError};
pub use row::{Access, Record, Row};
