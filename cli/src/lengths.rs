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
    let text = format!("{value:.decimals$}");
    match text.strip_prefix('-') {
        Some(zero) if zero.bytes().all(|byte| b"0.".contains(&byte)) => zero.to_owned(),
        _ => text,
    }
}

/// Formats a point without its unit.
pub(crate) fn format_point(point: &Point3<f64>, unit: Unit) -> String {
    let [x, y, z] = [point.x, point.y, point.z].map(|value| format_number(value, unit));
    format!("({x}, {y}, {z})")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_rounds_to_zero_has_no_sign() {
        assert_eq!(format_number(-1e-9, Unit::Millimetre), "0.0000");
        assert_eq!(format_number(-1e-4, Unit::Millimetre), "-0.0001");
        assert_eq!(format_number(-0.0, Unit::Inch), "0.00000");
    }
}
