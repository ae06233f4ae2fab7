//! The cells of a row as text.

use super::row::Row;

/// Returns the cells after the scene: method, setting, sampling, weights, times, errors, and the percentage of missed
/// contacts.
pub(super) fn cells(row: &Row) -> [String; 11] {
    [
        row.method.to_owned(),
        format_setting(row),
        row.sampling.unwrap_or("-").to_owned(),
        row.weights.unwrap_or("-").to_owned(),
        format_micros(row.p50_ns),
        format_micros(row.p99_ns),
        format_marked_error(row, "force", row.err_force),
        format_marked_error(row, "torque", row.err_torque),
        format_marked_error(row, "depth", row.err_depth),
        format_error(row.worst_depth),
        format!("{:.2}", 100.0 * row.missed),
    ]
}

/// Returns the setting of a method: its budget, tolerance or number of points.
pub(super) fn format_setting(row: &Row) -> String {
    match (row.points, row.budget, row.tolerance) {
        (_, Some(budget), _) => format!("≤ {budget}"),
        (_, _, Some(tolerance)) => format!("{tolerance:.0e}"),
        (Some(points), ..) => points.to_string(),
        _ => "-".to_owned(),
    }
}

/// Formats a time in microseconds with three digits.
pub(super) fn format_micros(ns: Option<u64>) -> String {
    let Some(ns) = ns else { return "-".to_owned() };
    let micros = ns as f64 / 1e3;
    let decimals = match micros {
        0.0..10.0 => 2,
        10.0..100.0 => 1,
        _ => 0,
    };
    format!("{micros:.decimals$}")
}

/// Formats an error with two digits.
pub(super) fn format_error(error: Option<f64>) -> String {
    error.map_or("-".to_owned(), |error| format!("{error:.1e}"))
}

/// Formats an error, with `≤` before it if the true value is not known better.
pub(super) fn format_marked_error(row: &Row, quantity: &str, value: Option<f64>) -> String {
    let floored = row.floored.contains(&quantity);
    format!("{}{}", if floored { "≤" } else { "" }, format_error(value))
}
