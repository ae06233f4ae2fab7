//! Imported tool libraries: files with errors, files that leave something out, one tool in all notations, and
//! exported tools.

mod exported;
mod libraries;
mod mutated;
mod notations;
mod omitted;
