//! Postures per triangle of a part: tool poses with a good contact and proved depth (Ho 1999, chapter 6).

mod colormap;
mod directions;
mod holder;
mod map;
pub mod path;
mod piece;
mod placement;
pub mod post;
mod record;
mod recorder;
pub mod shard;
pub mod sweep;
mod validator;

pub use colormap::colormap;
pub use directions::Directions;
pub use map::{
    Coverage, Difference, MapError, MapIdentity, MapRows, PartFingerprint, PostureMap,
    ToolFingerprint,
};
pub use piece::Piece;
pub use record::{Accessibility, MapRow, PostureRecord};
pub use recorder::{Recorder, RecorderError, RecorderStats};
pub use validator::{Rules, RulesError, Validator, ValidatorError};
