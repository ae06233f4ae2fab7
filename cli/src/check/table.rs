//! The certificate for people.

use super::niceness;
use std::io::Write;
use tool_dsl::CheckedTool;
use tool_dsl::diagnostic::format_number;
use tool_dsl::expr::interval::Interval;
use tool_dsl::prove::{Border, Certificate, RegionFacts};

/// Writes the certificate as a table.
pub(super) fn write(
    out: &mut impl Write,
    tool: &CheckedTool,
    certificate: &Certificate,
) -> std::io::Result<()> {
    let model = &tool.model;
    writeln!(out, "\n  {}\n", verdict(tool, certificate))?;
    let column_width = |names: &mut dyn Iterator<Item = usize>| names.max().unwrap_or(0).max(8);
    let names = column_width(&mut model.regions.iter().map(|region| region.name.len()));
    writeln!(
        out,
        "  {:<names$}  {:>7}  {:>13}  {:>15}  {:>13}  {:>8}  {:<11}  direction",
        "region", "share", "depth", "steepness", "niceness", "rounding", "depth is"
    )?;
    for (region, facts) in model.regions.iter().zip(&certificate.regions) {
        writeln!(
            out,
            "  {:<names$}  {:>5.1} %  {:>13}  {:>15}  {:>13}  {:>8.0e}  {:<11}  {}",
            region.name,
            100.0 * facts.share,
            range(facts.depth),
            range(facts.gradient_length),
            range(niceness(facts)),
            facts.rounding_error,
            kind(facts),
            direction(tool, facts),
        )?;
    }
    let borders = borders(tool, certificate);
    if borders.is_empty() {
        return writeln!(out);
    }
    let names = column_width(&mut borders.iter().map(|(_, name)| name.len()));
    writeln!(
        out,
        "\n  {:<names$}  {:>13}  {:>13}  {:>14}  {:>15}  {:>15}",
        "border", "depth", "depth jump", "magnitude jump", "turn", "turn on surface"
    )?;
    for (border, name) in borders {
        let on_surface = border.direction_angle_on_surface.map_or("-".to_owned(), degrees);
        writeln!(
            out,
            "  {name:<names$}  {:>13}  {:>13}  {:>14}  {:>15}  {on_surface:>15}",
            range(border.depth),
            none_or(border.depth_jump),
            none_or(border.magnitude_jump),
            degrees(border.direction_angle),
        )?;
    }
    writeln!(out)
}

/// Returns the borders between regions, each pair once, and the jumps at the outside.
pub(super) fn borders(tool: &CheckedTool, certificate: &Certificate) -> Vec<(Border, String)> {
    let mut borders: Vec<(Border, String)> = Vec::new();
    let shown = certificate
        .borders
        .iter()
        .filter(|border| {
            border.depth_jump.high > certificate.tolerance || border.has_equal_depths()
        })
        .filter(|border| border.sides.1.is_some() || !border.has_equal_depths());
    for border in shown {
        match borders.iter_mut().find(|(known, _)| known.sides == border.sides) {
            Some((known, _)) => known.merge(border),
            None => borders.push((border.clone(), pair(tool, border))),
        }
    }
    borders
}

fn none_or(jump: Interval) -> String {
    if jump.high == 0.0 { "none".to_owned() } else { range(jump) }
}

/// Describes the direction of a region.
fn direction(tool: &CheckedTool, facts: &RegionFacts) -> String {
    let mut text = match facts.direction_error {
        None => "not known".to_owned(),
        Some(Interval { low: 0.0, high: 0.0 }) => "steepest descent".to_owned(),
        Some(error) => format!("{} from steepest descent", degrees(error)),
    };
    if let [first, more @ ..] = facts.singular_cells.as_slice() {
        text += &format!("; vanishes near {}", tool.model.format_point(first.middle()));
        if !more.is_empty() {
            text += &format!(" and {} more points", more.len());
        }
    }
    text
}

/// Describes how a tool's depth relates to the distance to its surface.
pub(super) fn verdict(tool: &CheckedTool, certificate: &Certificate) -> String {
    let proved = |bound: Option<f64>| bound.map(format_number);
    let boxes = certificate.examined_boxes;
    let slack = match certificate.slack {
        0.0 => String::new(),
        slack => format!(", to within {slack:.0e} {}", tool.model.unit.symbol()),
    };
    match (proved(certificate.lower_slope()), proved(certificate.lipschitz())) {
        _ if certificate.is_exact() => {
            format!("proved in {boxes} boxes: depth is the distance to the surface{slack}")
        }
        (Some(least), Some(most)) => format!(
            "proved in {boxes} boxes: depth is {least} to {most} times the distance to the surface{slack}"
        ),
        (None, Some(most)) => format!(
            "proved in {boxes} boxes: depth is at most {most} times the distance to the surface and \
             changes by at most {most} per length{slack}; no lower bound is proved"
        ),
        _ if tool.model.is_exact() => format!(
            "by construction: depth is the distance to the surface; not proved in {boxes} boxes"
        ),
        // Compilation may decide hand-written regions in fewer boxes.
        _ if tool.bounds().lipschitz.is_some() => format!(
            "proved while compiling: depth is at most {} times the distance to the surface; not proved \
             again in {boxes} boxes",
            proved(tool.bounds().lipschitz).unwrap_or_default()
        ),
        _ => format!(
            "not proved in {boxes} boxes: depth may jump, and does not bound the distance to the surface"
        ),
    }
}

fn kind(facts: &RegionFacts) -> &'static str {
    if facts.is_distance { "a distance" } else { "other" }
}

fn pair(tool: &CheckedTool, border: &Border) -> String {
    let regions = &tool.model.regions;
    let (own, other) = border.sides;
    let other = other.map_or("outside", |other| regions[other].name.as_str());
    format!("{} | {other}", regions[own].name)
}

pub(super) fn range(value: Interval) -> String {
    let [low, high] = [value.low, value.high].map(short);
    if !value.high.is_finite() {
        // No bound was found, which does not mean that such a value exists.
        return if value.low.is_finite() {
            format!("{low} or more")
        } else {
            "not bounded".to_owned()
        };
    }
    if low == high { low } else { format!("{low} to {high}") }
}

pub(super) fn degrees(turn: Interval) -> String {
    let [low, high] = [turn.low, turn.high].map(|end| short(end.to_degrees()));
    if low == high { format!("{low}°") } else { format!("{low}° to {high}°") }
}

/// Formats a number with four digits, which are enough to read.
fn short(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return format!("{value}");
    }
    let digits = (3 - value.abs().log10().floor() as i32).clamp(0, 6) as usize;
    let text = format!("{value:.digits$}");
    if !text.contains('.') {
        return text;
    }
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".to_owned() } else { text.to_owned() }
}
