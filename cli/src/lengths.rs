//! Lengths as text.

use nalgebra::Point3;
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

/// Formats a point without its unit.
pub(crate) fn format_point(point: &Point3<f64>, unit: Unit) -> String {
    let [x, y, z] = [point.x, point.y, point.z].map(|value| format_number(value, unit));
    format!("({x}, {y}, {z})")
}
