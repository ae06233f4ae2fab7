//! Postures: where tools stand well at a part, triangle by triangle (Ho 1999, chapter 6).

mod contact;
mod directions;
mod holder;
mod judge;
mod map;
pub mod path;
mod ramp;
#[cfg(feature = "haptic")]
mod recorder;
mod row;
pub mod sweep;
mod touching;

pub use directions::Directions;
pub use judge::{Judge, JudgeError, Rules, RulesError};
pub use map::{Coverage, Difference, Identity, MapError, PartStamp, PostureMap, Rows, ToolStamp};
pub use ramp::colour;
#[cfg(feature = "haptic")]
pub use recorder::{Recorded, Recorder, RecorderError};
pub use row::{Access, Record, Row};
