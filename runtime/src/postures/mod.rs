//! Postures: where tools stand well at a part, triangle by triangle (Ho 1999, chapter 6).

mod contact;
mod directions;
mod holder;
pub mod path;
mod row;
mod rules;
pub mod sweep;

pub use directions::Directions;
pub use row::{Access, Record, Row};
pub use rules::{Rules, RulesError};
