//! Lengths as text.

use touchoff::Unit;

/// Formats a length with its unit.
pub(crate) fn format_length(value: f64, unit: Unit) -> String {
    format!("{} {unit}", format_number(value, unit))
}

/// Formats a length without its unit, to a tenth of a micrometre or about as finely.
pub(crate) fn format_number(value: f64, unit: Unit) -> String {
    let decimals = match unit {
        Unit::Millimetre => 4,
        Unit::Inch => 5,
        Unit::Metre => 7,
    };
    format!("{value:.decimals$}")
}
