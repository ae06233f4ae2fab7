//! The certificate for people: in a few lines for the author of a tool, and as a table.

use super::{niceness, sides};
use std::io::Write;
use touchoff_dsl::CheckedTool;
use touchoff_dsl::diagnostic::format_number;
use touchoff_dsl::expr::interval::Interval;
use touchoff_dsl::prove::{Border, Certificate, RegionFacts};

/// Writes the certificate in four lines: the verdict, the regions, the borders, and direction and niceness.
pub(super) fn write_summary(
    out: &mut impl Write,
    tool: &CheckedTool,
    certificate: &Certificate,
) -> std::io::Result<()> {
    writeln!(out, "  {}", verdict(tool, certificate))?;
    let regions = &certificate.regions;
    let distances = regions.iter().filter(|facts| facts.is_distance).count();
    let share = match regions.len() - distances {
        0 => "all".to_owned(),
        others => format!("all but {others}"),
    };
    writeln!(out, "  regions: {}, depth is a distance in {share} of them", regions.len())?;
    writeln!(out, "  borders: {}", worst_jump(tool, certificate))?;
    writeln!(
        out,
        "  direction: {}; niceness: {}",
        worst_direction(tool, certificate),
        niceness_range(tool, certificate)
    )
}

/// Describes the worst border.
fn worst_jump(tool: &CheckedTool, certificate: &Certificate) -> String {
    let unit = tool.model.unit.symbol();
    let borders = borders(tool, certificate);
    let open = match certificate.undecided.len() {
        0 => String::new(),
        count => format!("; {count} not decided"),
    };
    let jumping =
        borders.iter().filter(|(border, _)| border.depth_jump.high > certificate.tolerance);
    let depth = jumping.max_by(|(a, _), (b, _)| a.depth_jump.high.total_cmp(&b.depth_jump.high));
    let magnitude = borders
        .iter()
        .max_by(|(a, _), (b, _)| a.magnitude_jump.high.total_cmp(&b.magnitude_jump.high));
    match (depth, magnitude) {
        (Some((border, name)), _) => {
            let verb = verb(border.depth_jump, certificate.tolerance);
            format!("depth {verb} by {} {unit} at {name}{open}", range(border.depth_jump))
        }
        (None, Some((border, name))) if border.magnitude_jump.high > certificate.tolerance => {
            let verb = verb(border.magnitude_jump, certificate.tolerance);
            let step = range(border.magnitude_jump);
            format!("no jumps of depth; magnitude {verb} by {step} at {name}{open}")
        }
        _ => format!("no jumps{open}"),
    }
}

/// Returns the verb for a jump: the interval of a border that is not proved begins at 0.
fn verb(jump: Interval, tolerance: f64) -> &'static str {
    if jump.low > tolerance { "jumps" } else { "may jump" }
}

/// Describes the region whose direction is farthest from the steepest descent of depth.
fn worst_direction(tool: &CheckedTool, certificate: &Certificate) -> String {
    let regions = tool.model.regions.iter().zip(&certificate.regions);
    let unknown = regions.clone().find(|(_, facts)| facts.direction_error.is_none());
    let errors = regions.filter_map(|(region, facts)| Some((region, facts.direction_error?)));
    match (unknown, errors.max_by(|(_, a), (_, b)| a.high.total_cmp(&b.high))) {
        (Some((region, _)), _) => format!("not known in {}", region.name),
        (None, Some((region, error))) if error.high > 0.0 => {
            format!(
                "up to {} from steepest descent in {}",
                degrees(Interval::new(error.high, error.high)),
                region.name
            )
        }
        _ => "steepest descent".to_owned(),
    }
}

/// Describes the range of niceness, and the regions where it may rise with depth.
fn niceness_range(tool: &CheckedTool, certificate: &Certificate) -> String {
    let all = certificate
        .regions
        .iter()
        .map(niceness)
        .reduce(|one, other| Interval::new(one.low.min(other.low), one.high.max(other.high)));
    let shown = all.map_or_else(|| "none".to_owned(), range);
    let regions = tool.model.regions.iter().zip(&certificate.regions);
    let rising = regions.filter(|(_, facts)| facts.rising_witness.is_some());
    let rising: Vec<&str> = rising.map(|(region, _)| region.name.as_str()).collect();
    match rising.as_slice() {
        [] => shown,
        names => format!("{shown}, rises with depth in {}", names.join(", ")),
    }
}

/// Writes the certificate as a table.
pub(super) fn write_table(
    out: &mut impl Write,
    tool: &CheckedTool,
    certificate: &Certificate,
) -> std::io::Result<()> {
    let model = &tool.model;
    writeln!(out, "\n  {}\n", verdict(tool, certificate))?;
    let names = column_width(model.regions.iter().map(|region| region.name.len()));
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
            if facts.is_distance { "a distance" } else { "other" },
            direction(tool, facts),
        )?;
    }
    let borders = borders(tool, certificate);
    if borders.is_empty() {
        return writeln!(out);
    }
    let names = column_width(borders.iter().map(|(_, name)| name.len()));
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

fn column_width(names: impl Iterator<Item = usize>) -> usize {
    names.max().unwrap_or(0).max(8)
}

/// Returns the borders between regions, each pair once, and the jumps at the outside.
fn borders(tool: &CheckedTool, certificate: &Certificate) -> Vec<(Border, String)> {
    let mut borders: Vec<(Border, String)> = Vec::new();
    let shown = certificate
        .borders
        .iter()
        .filter(|border| {
            border.depth_jump.high > certificate.tolerance || border.has_equal_depths()
        })
        .filter(|border| border.sides.other.is_some() || !border.has_equal_depths());
    for border in shown {
        match borders.iter_mut().find(|(known, _)| known.sides == border.sides) {
            Some((known, _)) => known.merge(border),
            None => borders.push((border.clone(), sides(&tool.model, border).join(" | "))),
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
fn verdict(tool: &CheckedTool, certificate: &Certificate) -> String {
    let boxes = certificate.examined_boxes;
    let slack = match certificate.slack {
        0.0 => String::new(),
        slack => format!(", to within {slack:.0e} {}", tool.model.unit.symbol()),
    };
    let [least, most] =
        [certificate.lower_slope(), certificate.lipschitz()].map(|bound| bound.map(format_number));
    match (least, most) {
        _ if certificate.is_exact() && tool.model.is_exact() => {
            format!("proved by its partition: depth is the distance to the surface{slack}")
        }
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
        _ if tool.model.is_exact() => {
            "not proved by its partition: depth may differ from the distance to the surface"
                .to_owned()
        }
        // Compilation may decide hand-written regions in fewer boxes.
        _ if tool.bounds().lipschitz.is_some() => format!(
            "proved while compiling: depth is at most {} times the distance to the surface; not proved \
             again in {boxes} boxes",
            tool.bounds().lipschitz.map(format_number).unwrap_or_default()
        ),
        _ => format!(
            "not proved in {boxes} boxes: depth may jump, and does not bound the distance to the surface"
        ),
    }
}

fn range(value: Interval) -> String {
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

fn degrees(turn: Interval) -> String {
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
