//! The results as Markdown.

use super::{ComparisonResults, ComparisonSettings, ValidatedPostures};
use std::fmt::{Error, Write};

/// Maximum number of deviating postures listed.
const MAX_LISTED: usize = 20;

/// Returns the page below its title and head line.
///
/// # Errors
/// Never in practice: writing to a string cannot fail.
pub fn page(
    part: &str,
    settings: &ComparisonSettings<'_>,
    results: &ComparisonResults,
) -> Result<String, Error> {
    let mut page = String::new();
    let unit = settings.mesh.unit();
    let (triangles, area) = results.total;
    writeln!(
        page,
        "{part}: {triangles} triangles, {area:.0} {unit}². {} directions a hemisphere, a tolerance of {} {unit}, niceness above {}.",
        settings.hemisphere, settings.tolerance, settings.niceness
    )?;
    let stats = &results.stats;
    let percent = |count: u64| 100.0 * count as f64 / stats.postures().max(1) as f64;
    writeln!(page, "\n## How postures were decided\n\n| by | postures | % |\n|---|--:|--:|")?;
    let rows = [
        ("nothing that cuts faces it", stats.not_facing),
        ("not nice enough", stats.below_niceness),
        ("a place that was in the way beside", stats.cached_obstruction),
        ("a place that a search found", stats.obstructed),
        ("rounding", stats.undecided),
        ("proved acceptable", stats.acceptable),
        ("all", stats.postures()),
    ];
    for (reason, count) in rows {
        writeln!(page, "| {reason} | {count} | {:.2} |", percent(count))?;
    }
    let [sweep_seconds, brute_force_seconds] = results.seconds;
    writeln!(
        page,
        "\n{sweep_seconds:.1} s, {:.2} µs a posture on {} cores; brute force {brute_force_seconds:.0} s.",
        1e6 * sweep_seconds / stats.postures().max(1) as f64,
        std::thread::available_parallelism().map_or(1, usize::from)
    )?;
    writeln!(
        page,
        "\n## What is reached\n\n| tool | triangles | % | % of the area | postures |\n|---|--:|--:|--:|--:|"
    )?;
    let share = |(count, part): (usize, f64)| {
        [100.0 * count as f64 / triangles as f64, 100.0 * part / area]
    };
    for reach in &results.reach {
        let [count, part] = share((reach.triangles, reach.area));
        writeln!(
            page,
            "| {} | {} | {count:.1} | {part:.1} | {} |",
            reach.tool, reach.triangles, reach.postures
        )?;
    }
    let [count, part] = share(results.reached);
    writeln!(
        page,
        "| any | {} | {count:.1} | {part:.1} | {} |",
        results.reached.0, stats.acceptable
    )?;
    writeln!(
        page,
        "\n## Judged again\n\n| said to be | judged | false | left open |\n|---|--:|--:|--:|\n\
         | accessible | {} | {} | {} |\n| not accessible | {} | {} | {} |",
        results.accessible.count,
        results.accessible.contradicted.len(),
        results.accessible.undecided.len(),
        results.inaccessible.count,
        results.inaccessible.contradicted.len(),
        results.inaccessible.undecided.len()
    )?;
    writeln!(
        page,
        "\nAn accessible posture is false if brute force finds a place deeper than is allowed by more than {:.1e} {unit}; one that is not \
         accessible if it finds none. Open is what it does not tell from rounding.",
        results.rounding
    )?;
    list_findings(&mut page, "Accessible", &results.accessible)?;
    list_findings(&mut page, "Not accessible", &results.inaccessible)?;
    Ok(page)
}

fn list_findings(
    page: &mut String,
    kind: &str,
    validated: &ValidatedPostures,
) -> Result<(), Error> {
    for (verdict, findings) in [("false", &validated.contradicted), ("open", &validated.undecided)]
    {
        if findings.is_empty() {
            continue;
        }
        writeln!(page, "\n### {kind}, {verdict}\n")?;
        for finding in findings.iter().take(MAX_LISTED) {
            writeln!(page, "- {}: {}", finding.posture, finding.result)?;
        }
        if findings.len() > MAX_LISTED {
            writeln!(page, "- and {} more", findings.len() - MAX_LISTED)?;
        }
    }
    Ok(())
}
