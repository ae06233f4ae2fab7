//! The results as Markdown.

use super::{Drawn, Found, Wanted};
use std::fmt::{Error, Write};

/// Maximum number of deviating postures listed.
const LISTED: usize = 20;

/// Returns the page below its title and head line.
///
/// # Errors
/// Never in practice: writing to a string cannot fail.
pub fn page(part: &str, wanted: &Wanted<'_>, found: &Found) -> Result<String, Error> {
    let mut page = String::new();
    let unit = wanted.mesh.unit();
    let (triangles, area) = found.all;
    writeln!(
        page,
        "{part}: {triangles} triangles, {area:.0} {unit}². {} directions a hemisphere, a tolerance of {} {unit}, niceness above {}.",
        wanted.hemisphere, wanted.tolerance, wanted.niceness
    )?;
    let tally = &found.tally;
    let of = |count: u64| 100.0 * count as f64 / tally.postures().max(1) as f64;
    writeln!(page, "\n## How postures were decided\n\n| by | postures | % |\n|---|--:|--:|")?;
    let rows = [
        ("nothing that cuts faces it", tally.not_facing),
        ("not nice enough", tally.below_niceness),
        ("a place that was in the way beside", tally.cached_obstruction),
        ("a place that a search found", tally.obstructed),
        ("rounding", tally.undecided),
        ("proved acceptable", tally.acceptable),
        ("all", tally.postures()),
    ];
    for (by, count) in rows {
        writeln!(page, "| {by} | {count} | {:.2} |", of(count))?;
    }
    let [swept, judged] = found.seconds;
    writeln!(
        page,
        "\n{swept:.1} s, {:.2} µs a posture on {} cores; brute force {judged:.0} s.",
        1e6 * swept / tally.postures().max(1) as f64,
        std::thread::available_parallelism().map_or(1, usize::from)
    )?;
    writeln!(
        page,
        "\n## What is reached\n\n| tool | triangles | % | % of the area | postures |\n|---|--:|--:|--:|--:|"
    )?;
    let share = |(count, part): (usize, f64)| {
        [100.0 * count as f64 / triangles as f64, 100.0 * part / area]
    };
    for reach in &found.reach {
        let [count, part] = share((reach.triangles, reach.area));
        writeln!(
            page,
            "| {} | {} | {count:.1} | {part:.1} | {} |",
            reach.tool, reach.triangles, reach.postures
        )?;
    }
    let [count, part] = share(found.any);
    writeln!(page, "| any | {} | {count:.1} | {part:.1} | {} |", found.any.0, tally.acceptable)?;
    writeln!(
        page,
        "\n## Judged again\n\n| said to be | judged | false | left open |\n|---|--:|--:|--:|\n\
         | accessible | {} | {} | {} |\n| not accessible | {} | {} | {} |",
        found.accessible.judged,
        found.accessible.wrong.len(),
        found.accessible.open.len(),
        found.refused.judged,
        found.refused.wrong.len(),
        found.refused.open.len()
    )?;
    writeln!(
        page,
        "\nAn accessible posture is false if brute force finds a place deeper than is allowed by more than {:.1e} {unit}; one that is not \
         accessible if it finds none. Open is what it does not tell from rounding.",
        found.rounding
    )?;
    odd(&mut page, "Accessible", &found.accessible)?;
    odd(&mut page, "Not accessible", &found.refused)?;
    Ok(page)
}

fn odd(page: &mut String, kind: &str, drawn: &Drawn) -> Result<(), Error> {
    for (of, list) in [("false", &drawn.wrong), ("open", &drawn.open)] {
        if list.is_empty() {
            continue;
        }
        writeln!(page, "\n### {kind}, {of}\n")?;
        for odd in list.iter().take(LISTED) {
            writeln!(page, "- {}: {}", odd.at, odd.what)?;
        }
        if list.len() > LISTED {
            writeln!(page, "- and {} more", list.len() - LISTED)?;
        }
    }
    Ok(())
}
