//! Parsers of option values.

use nalgebra::Point3;
use std::ffi::OsString;
use std::num::NonZeroU16;
use std::ops::RangeInclusive;

/// Joins a long option and a negative value after it to one argument, `--option=-1e-3`, so that the option's own
/// parser judges the value. clap by itself takes `-.5`, `-1e-3` and `-1,0,0` for options; if it were told to take
/// any value, it would also take the next option for one.
pub(super) fn join_negative_numbers(arguments: impl Iterator<Item = OsString>) -> Vec<OsString> {
    let mut joined: Vec<OsString> = Vec::new();
    let mut before_double_dash = true;
    for argument in arguments {
        before_double_dash &= argument != "--";
        match joined.last_mut() {
            Some(option)
                if before_double_dash && is_negative(&argument) && is_long_option(option) =>
            {
                option.push("=");
                option.push(argument);
            }
            _ => joined.push(argument),
        }
    }
    joined
}

/// Returns whether an argument is a negative number, or begins with one.
fn is_negative(argument: &OsString) -> bool {
    let Some(value) = argument.to_str().and_then(|text| text.strip_prefix('-')) else {
        return false;
    };
    value.starts_with(|first: char| first.is_ascii_digit() || first == '.')
        || value.parse::<f64>().is_ok()
}

/// Returns whether an argument is a long option without a value.
fn is_long_option(argument: &OsString) -> bool {
    argument.to_str().is_some_and(|text| {
        text.strip_prefix("--").is_some_and(|name| !name.is_empty() && !name.contains('='))
    })
}

/// Parses a number of points to sample.
pub(super) fn point_count(text: &str) -> Result<u64, String> {
    whole(text, 1..=100_000_000)
}

/// Parses a whole number of 0 or more.
pub(super) fn count(text: &str) -> Result<u64, String> {
    whole(text, 0..=u64::MAX)
}

/// Parses the index of a processor core.
pub(super) fn core(text: &str) -> Result<usize, String> {
    whole(text, 0..=usize::MAX as u64).map(|value| value as usize)
}

/// Parses a number of directions per hemisphere.
pub(super) fn direction_count(text: &str) -> Result<u16, String> {
    whole(text, 1..=2000).map(|value| value as u16)
}

/// Parses a number of postures to keep.
pub(super) fn posture_count(text: &str) -> Result<NonZeroU16, String> {
    let value = whole(text, 1..=u16::MAX.into())?;
    Ok(NonZeroU16::new(value as u16).expect("the range begins at 1"))
}

fn whole(text: &str, range: RangeInclusive<u64>) -> Result<u64, String> {
    let value = text.parse().ok().filter(|value| range.contains(value));
    value.ok_or_else(|| match (*range.start(), *range.end()) {
        (low, u64::MAX) => format!("give a whole number of {low} or more, in digits"),
        (low, high) => format!("give a whole number from {low} to {high}, in digits"),
    })
}

/// Parses a finite length of 0 or more.
pub(super) fn length(text: &str) -> Result<f64, String> {
    let remedy = "give a finite length of 0 or more, such as 0.01";
    number_if(|value| value >= 0.0 && value.is_finite(), text, remedy)
}

/// Parses a finite length above 0.
pub(super) fn positive_length(text: &str) -> Result<f64, String> {
    number_if(is_finite_positive, text, "give a finite length above 0, such as 0.01")
}

/// Parses a finite number above 0.
pub(super) fn positive(text: &str) -> Result<f64, String> {
    number_if(is_finite_positive, text, "give a finite number above 0")
}

/// Parses a largest tilt in degrees.
pub(super) fn tilt(text: &str) -> Result<f64, String> {
    let remedy = "give an angle in degrees above 0 and up to 180, such as 90";
    number_if(|value| value > 0.0 && value <= 180.0, text, remedy)
}

/// Parses the number of a tool.
pub(super) fn tool_number(text: &str) -> Result<u32, String> {
    whole(text, 0..=99_999_999).map(|value| value as u32)
}

/// Parses a finite number.
pub(super) fn finite(text: &str) -> Result<f64, String> {
    number_if(f64::is_finite, text, "give a finite number")
}

/// Parses a rate in Hz, from 1 to 100000.
pub(super) fn rate(text: &str) -> Result<f64, String> {
    let remedy = "give a rate of 1 to 100000 cycles per second";
    number_if(|value| (1.0..=100_000.0).contains(&value), text, remedy)
}

/// Parses a surface and its allowance, `SURFACE=LENGTH`.
pub(super) fn allowance(text: &str) -> Result<(String, f64), String> {
    let form = "write SURFACE=LENGTH, such as `flute=0.05`, or `flute=inf` for any depth";
    let (surface, depth) = text.split_once('=').ok_or(form)?;
    match number(depth.trim())? {
        depth if depth.is_nan() || depth == f64::NEG_INFINITY => Err(form.to_owned()),
        depth => Ok((surface.trim().to_owned(), depth)),
    }
}

/// Parses a finite point, `X,Y,Z`.
pub(super) fn point(text: &str) -> Result<Point3<f64>, String> {
    let numbers: Vec<f64> =
        text.split(',').map(|part| number(part.trim())).collect::<Result<_, _>>()?;
    match numbers.as_slice() {
        [x, y, z] if numbers.iter().all(|n| n.is_finite()) => Ok(Point3::new(*x, *y, *z)),
        [_, _, _] => Err("give three finite numbers, such as 0,0,1".to_owned()),
        _ => Err(format!("give three numbers, such as 0,0,1; these are {}", numbers.len())),
    }
}

/// Parses a direction: a finite point other than the origin.
pub(super) fn direction(text: &str) -> Result<Point3<f64>, String> {
    match point(text)? {
        point if point == Point3::origin() => {
            Err("a direction is not zero: give one such as 0,0,1".to_owned())
        }
        point => Ok(point),
    }
}

fn is_finite_positive(value: f64) -> bool {
    value > 0.0 && value.is_finite()
}

/// Parses a number that meets a condition; `remedy` is the error if it does not.
fn number_if(is_valid: impl Fn(f64) -> bool, text: &str, remedy: &str) -> Result<f64, String> {
    let value = number(text)?;
    if is_valid(value) { Ok(value) } else { Err(remedy.to_owned()) }
}

fn number(text: &str) -> Result<f64, String> {
    text.parse().map_err(|_| {
        format!("`{text}` is not a number: write decimals with a point and no unit, such as 0.01")
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_negative_numbers_join_the_option_before_them() {
        let joined = |line: &str| {
            let words = join_negative_numbers(line.split(' ').map(OsString::from));
            words.iter().map(|word| word.to_string_lossy().into_owned()).collect::<Vec<_>>()
        };
        for value in ["-1", "-.5", "-1e-3", "-inf", "-1,0,0"] {
            assert_eq!(
                joined(&format!("run --center {value}")),
                ["run", &format!("--center={value}")]
            );
        }
        for line in ["run --tolerance --json", "fmt -", "run --a=1 -2", "x -- --a -1", "run -o -1"]
        {
            assert_eq!(joined(line).join(" "), line);
        }
    }
}
