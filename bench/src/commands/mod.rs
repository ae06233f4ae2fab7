//! The commands, one per page.

mod accuracy;
mod certified;
mod compile;
mod haptics;
mod imported;
mod interpreter;
mod mutants;
mod postures;
mod programs;
mod proofs;
mod stress;
mod triangles;
mod work_precision;

pub(crate) use accuracy::Accuracy;
pub(crate) use certified::Certified;
pub(crate) use compile::Compile;
pub(crate) use haptics::Haptics;
pub(crate) use postures::Postures;
pub(crate) use programs::Programs;
pub(crate) use proofs::Proofs;
pub(crate) use stress::Stress;
pub(crate) use triangles::Triangles;
pub(crate) use work_precision::WorkPrecision;

use std::path::{Path, PathBuf};

/// Returns the folder of parts: the one given, or else the default beside the repository.
fn parts(folder: Option<&Path>) -> PathBuf {
    let default_folder = || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/data/parts");
    folder.map_or_else(default_folder, Path::to_owned)
}

/// Parses a finite number of 0 or more.
fn not_negative(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value >= 0.0 && value.is_finite() => Ok(value),
        _ => Err("write a number of 0 or more".to_owned()),
    }
}

/// Checks that the library has a tool with this name.
fn tool(text: &str) -> Result<String, String> {
    match tools_library::find(text) {
        Some(_) => Ok(text.to_owned()),
        None => Err("the library has no such tool".to_owned()),
    }
}
