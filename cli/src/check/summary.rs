//! The certificate in a few lines, for the author of a tool.

use super::niceness;
use super::table::{borders, degrees, range, verdict};
use std::io::Write;
use tool_dsl::CheckedTool;
use tool_dsl::expr::interval::Interval;
use tool_dsl::prove::Certificate;

/// Writes the certificate in four lines: the verdict, the regions, the borders, and direction and niceness.
pub(super) fn write(
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
    writeln!(out, "  borders: {}", jumps(tool, certificate))?;
    writeln!(
        out,
        "  direction: {}; niceness: {}",
        direction(tool, certificate),
        nice(tool, certificate)
    )
}

/// Describes the worst border.
fn jumps(tool: &CheckedTool, certificate: &Certificate) -> String {
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
    // The interval of a border that is not proved begins at 0.
    let verb = |jump: Interval| if jump.low > certificate.tolerance { "jumps" } else { "may jump" };
    match (depth, magnitude) {
        (Some((border, name)), _) => {
            let verb = verb(border.depth_jump);
            format!("depth {verb} by {} {unit} at {name}{open}", range(border.depth_jump))
        }
        (None, Some((border, name))) if border.magnitude_jump.high > certificate.tolerance => {
            let (verb, step) = (verb(border.magnitude_jump), range(border.magnitude_jump));
            format!("no jumps of depth; magnitude {verb} by {step} at {name}{open}")
        }
        _ => format!("no jumps{open}"),
    }
}

/// Describes the region whose direction is farthest from the steepest descent of depth.
fn direction(tool: &CheckedTool, certificate: &Certificate) -> String {
    let regions = || tool.model.regions.iter().zip(&certificate.regions);
    let unknown = regions().find(|(_, facts)| facts.direction_error.is_none());
    let errors = regions().filter_map(|(region, facts)| Some((region, facts.direction_error?)));
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

fn hull(one: Interval, other: Interval) -> Interval {
    Interval::new(one.low.min(other.low), one.high.max(other.high))
}

/// Describes the range of niceness, and the regions where it may rise with depth.
fn nice(tool: &CheckedTool, certificate: &Certificate) -> String {
    let all = certificate.regions.iter().map(niceness).reduce(hull);
    let shown = all.map_or_else(|| "none".to_owned(), range);
    let regions = tool.model.regions.iter().zip(&certificate.regions);
    let rising = regions.filter(|(_, facts)| facts.rising_witness.is_some());
    let rising: Vec<&str> = rising.map(|(region, _)| region.name.as_str()).collect();
    match rising.as_slice() {
        [] => shown,
        names => format!("{shown}, rises with depth in {}", names.join(", ")),
    }
}
