//! The commands, one per page.

mod certified;
mod compile;
mod haptics;
mod imported;
mod interpreter;
mod programs;
mod proofs;
mod speed;
mod work_precision;

pub(crate) use certified::Certified;
pub(crate) use compile::Compile;
pub(crate) use haptics::Haptics;
pub(crate) use programs::Programs;
pub(crate) use speed::Speed;
pub(crate) use work_precision::WorkPrecision;

/// Parses a finite number of 0 or more.
fn not_negative(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value >= 0.0 && value.is_finite() => Ok(value),
        _ => Err("write a number of 0 or more".to_owned()),
    }
}
