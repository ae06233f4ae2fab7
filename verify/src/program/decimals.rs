//! Decimals of written coordinates.

use touchoff::Unit;

/// Numbers of decimals to which a program is rounded. A coordinate changes by at most half a unit of its last
/// decimal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Decimals {
    /// Decimals of the tip's coordinates, in the program's unit.
    pub tip: usize,
    /// Decimals of the components of the tool axis, a unit vector.
    pub axis: usize,
}

impl Decimals {
    /// Returns the decimals that suit a unit: tips to 1e-5 mm, 1e-7 inch or 1e-8 m, axes to 1e-9. Such an axis
    /// errs by less than 1e-9 rad, which is 3e-7 mm at 300 mm from the tip.
    pub fn of(unit: Unit) -> Decimals {
        let tip = match unit {
            Unit::Millimetre => 5,
            Unit::Inch => 7,
            Unit::Metre => 8,
        };
        Decimals { tip, axis: 9 }
    }
}

/// Formats a number with at most the given decimals, without exponent, trailing zeros, and the sign of zero.
pub(super) fn rounded(number: f64, decimals: usize) -> String {
    let fixed = format!("{number:.decimals$}");
    let short = match fixed.contains('.') {
        true => fixed.trim_end_matches('0').trim_end_matches('.'),
        false => &fixed,
    };
    if short == "-0" { "0".to_owned() } else { short.to_owned() }
}

#[cfg(test)]
mod tests {
    use super::rounded;

    #[test]
    fn rounds_without_exponent_trailing_zeros_and_negative_zero() {
        for (number, decimals, text) in [
            (12.345_678, 5, "12.34568"),
            (-0.000_004, 5, "0"),
            (-0.000_006, 5, "-0.00001"),
            (100.0, 5, "100"),
            (1e9, 0, "1000000000"),
            (0.1 + 0.2, 9, "0.3"),
            (-1.0, 9, "-1"),
        ] {
            assert_eq!(rounded(number, decimals), text);
        }
    }
}
