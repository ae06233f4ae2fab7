//! Postures: where tools stand well at a part, triangle by triangle (Ho 1999, chapter 6).

mod row;

pub use row::{Access, Record, Row};
