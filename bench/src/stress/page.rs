//! The page `docs/measured/stress.md`.

use super::ledger::{ITEMS, Item, Kind, Row};
use std::fmt::Write;

/// Description of each item.
const DESCRIPTIONS: [&str; ITEMS.len()] = [
    "Where the truth in 256 bits goes from one owner to another, or from inside to outside, the two doubles side by side between which it does \
     are found by halving, along z and along d; and every vertex and centre is taken. There the contract of section 1 is held, and what the code \
     says is compared with the depth that *each* neighbour has there in 256 bits. Last, what it says on the two sides is compared, less \
     what the truth changes by.",
    "The same places, and all with one ulp more or less in each coordinate; also turned about the axis. The contract.",
    "Vertices of the subdivision by nearest feature, inside and as far as half the tool's radius outside: every two borders (two features as far; \
     the edge of a fan) are intersected by Newton's method, and what no other feature is nearer to is kept. The contract there and an ulp \
     beside; and all regions that such a point belongs to agree. Of `Fig73` inside it is where its own regions meet, of the two solids where \
     four faces do.",
    "The axis at d = 0, -0, 5e-324 and 2^-540, at the heights of all corners, an ulp beside them, at ±0, 5e-324 and 2^-540, and others; of a \
     solid each coordinate so. The contract.",
    "Each tool is written out as a `.tool` file with all lengths multiplied, compiled and interpreted. By 2^k, k = -300 … 300: the same bits up to \
     the scale for -40 ≤ k ≤ 160; only a gradient's last bits may differ, since a radius of 1 is simplified away. Beyond that sizes whose fourth \
     powers leave doubles are refused, and so are numbers that are not between 1e-90 and 1e90; regions by hand that are much smaller than 1e-9 \
     of their unit are divided by a tolerance that is not small beside them. By 1e-9, 25.4 and 1e6: the contract in the new ulp(S). Where an \
     arc's radius is above S (by 25.4 those of `Barrel` and `Oval`) the distance from its centre is rounded as what is larger than S: the contract's 1 ulp(S) is \
     missed there, as the last two rows have it, and 2 are held.",
    "Points beside the tool, part and pose moved together. By powers of two, where no coordinate loses a bit: the same bits of contacts and \
     wrench. By 1e3 … 1e12 (1, -0.7, 0.3): no depth differs by more than both clouds' `Probe::rounding_error_bound` and what the coordinates' own rounding \
     can do; each scene is also judged by itself in 256 bits.",
    "Quarter and half turns, with and without rounding, all axes, tilts of 1e-9 rad. Each contact's depth in 256 bits is that of the given \
     point at the pose as it is in doubles; it may be off by `Probe::rounding_error_bound`. The scene turned as a whole by turns without rounding has the \
     same bits.",
    "A tool's end pressed into a plane, its longest side into a sphere and into a bore that is wider by a tenth, by 1e-1 … 1e-15. The deepest \
     place is a point, whose depth is a closed form. The certifier's interval, of triangles, holds it.",
    "Profiles that hardly are any. Each is refused, or keeps the contract.",
    "Of each tool one point, all points the same, all points inside. For the rest see what is refused below.",
    "1, 2, 3, 15, 16, 17, 255, 256 and 257 points: a leaf has 16 by design. All orders of up to three points, some of more: the same contacts to \
     the last bit, and those of 256 bits.",
    "Cycles of poses and wrenches with a running checksum of all their bits: again on two threads, and at every SIMD level of this machine.",
    "Coordinates, depths, weights and poses of 5e-324 to 1e-300. The contract; and no weight is stored farther from the given one than 2^-24 of \
     the largest.",
    "The scene turned by any rotation; mirrored; the tool spun; two clouds merged, whose contacts come together and whose forces add; the scene in \
     mm, inch and m, given so and by `Part::to`. What loses no bit has the same bits, else depths differ by both clouds' `Probe::rounding_error_bound` and rounding.",
];

/// Returns the page for these rows.
pub fn page(rows: &[Row]) -> Result<String, std::fmt::Error> {
    let mut page = String::new();
    for item in Item::all() {
        let item_rows: Vec<&Row> = rows.iter().filter(|row| row.item == item).collect();
        if item_rows.is_empty() {
            continue;
        }
        writeln!(
            page,
            "## {}. {}\n\n{}\n",
            item.0,
            capitalized(item.name()),
            DESCRIPTIONS[item.0 - 1]
        )?;
        write_worst(&item_rows, &mut page)?;
        match item.0 {
            9 => write_cases(&item_rows, &mut page)?,
            10 => write_cases(&item_rows, &mut page)?,
            12 => write_checksums(&item_rows, &mut page)?,
            _ => {}
        }
    }
    write_shares(rows, &mut page)?;
    page += "## Missed\n\n";
    let missed: Vec<String> = rows
        .iter()
        .filter(|row| row.exceeds_limit())
        .map(|row| format!("- {}", row.describe()))
        .collect();
    page += &if missed.is_empty() { "Nothing.\n".to_owned() } else { missed.join("\n") + "\n" };
    Ok(page)
}

fn capitalized(text: &str) -> String {
    let mut characters = text.chars();
    characters
        .next()
        .map_or_else(String::new, |first| first.to_uppercase().chain(characters).collect())
}

/// Formats a number with about three digits.
fn format_value(value: f64) -> String {
    match value {
        0.0 => "0".to_owned(),
        v if v.fract() == 0.0 && v.abs() < 1e9 => format!("{v}"),
        v if (1e-3..1e4).contains(&v.abs()) => format!("{v:.3}"),
        v => format!("{v:.2e}"),
    }
}

/// Formats text for a table cell, without vertical bars and line breaks.
fn code_cell(text: &str) -> String {
    let flat: String = text.replace('|', "/").replace('\n', " ");
    if flat.is_empty() { String::new() } else { format!("`{}`", flat.replace('`', "'")) }
}

/// Writes the worst row of each kind over all tools.
fn write_worst(rows: &[&Row], page: &mut String) -> std::fmt::Result {
    let mut kinds: Vec<Kind> = Vec::new();
    for row in rows.iter().filter(|row| row.kind.quantity != "refused") {
        if !kinds.contains(&row.kind) {
            kinds.push(row.kind);
        }
    }
    writeln!(page, "| figure | cases | worst | bar | unit | tool | where |")?;
    writeln!(page, "|---|--:|--:|--:|---|---|---|")?;
    for kind in kinds {
        let kind_rows = || rows.iter().filter(|row| row.kind == kind);
        let cases: usize = kind_rows().map(|row| row.cases).sum();
        let total: f64 = kind_rows().map(|row| row.worst).sum();
        let Some(worst_row) = kind_rows().max_by(|a, b| a.worst.total_cmp(&b.worst)) else {
            continue;
        };
        let (value, bar) = match kind.limit {
            0.0 => (total, "0".to_owned()),
            f64::INFINITY => (worst_row.worst, "told".to_owned()),
            bar => (worst_row.worst, format_value(bar)),
        };
        let (tool, location) = if value == 0.0 {
            (String::new(), String::new())
        } else {
            (worst_row.tool.clone(), code_cell(&worst_row.location))
        };
        writeln!(
            page,
            "| {} | {cases} | {} | {bar} | {} | {tool} | {location} |",
            escape_bars(kind.quantity),
            format_value(value),
            escape_bars(kind.unit),
        )?;
    }
    writeln!(page)
}

fn escape_bars(text: &str) -> String {
    text.replace('|', "\\|")
}

/// Writes the outcome of each case.
fn write_cases(rows: &[&Row], page: &mut String) -> std::fmt::Result {
    let mut names: Vec<&str> = Vec::new();
    for row in rows {
        if !names.contains(&row.tool.as_str()) && tools_library::find(&row.tool).is_none() {
            names.push(&row.tool);
        }
    }
    writeln!(page, "| case | comes to |\n|---|---|")?;
    for name in names {
        let case_rows = || rows.iter().filter(|row| row.tool == name);
        let rejection = case_rows().find(|row| row.kind.quantity == "refused");
        let missed: Vec<String> =
            case_rows().filter(|row| row.exceeds_limit()).map(|row| row.describe()).collect();
        let depth = case_rows().find(|row| row.kind.quantity == "depth");
        let outcome = match (rejection, depth) {
            _ if !missed.is_empty() => format!("**missed**: {}", code_cell(&missed.join("; "))),
            (Some(rejection), _) => format!("refused: {}", code_cell(&rejection.location)),
            (_, Some(depth)) => {
                format!(
                    "exact: depth to {} ulp(S) at {} points inside",
                    format_value(depth.worst),
                    depth.cases
                )
            }
            _ => "taken".to_owned(),
        };
        writeln!(page, "| {name} | {outcome} |")?;
    }
    writeln!(page)
}

fn write_checksums(rows: &[&Row], page: &mut String) -> std::fmt::Result {
    writeln!(page, "| tool | cycles | touching | checksum |\n|---|--:|--:|---|")?;
    for row in rows.iter().filter(|row| row.kind.limit.is_infinite()) {
        let share = 100.0 * row.worst;
        writeln!(
            page,
            "| {} | {} | {share:.1} % | {} |",
            row.tool,
            row.cases,
            code_cell(&row.location)
        )?;
    }
    writeln!(page)
}

/// Writes for each tool and item the largest ratio of a figure to its limit.
fn write_shares(rows: &[Row], page: &mut String) -> std::fmt::Result {
    let mut tools: Vec<&str> = rows.iter().map(|row| row.tool.as_str()).collect();
    tools.retain(|tool| tools_library::find(tool).is_some());
    tools.sort_unstable();
    tools.dedup();
    writeln!(
        page,
        "## Tool by tool\n\nThe largest part of its bar that any figure of an item comes to; 0 where only what must not be is counted, and was not.\n"
    )?;
    let items: Vec<Item> = Item::all().filter(|item| item.0 != 9).collect();
    let head: Vec<String> = items.iter().map(|item| item.0.to_string()).collect();
    writeln!(page, "| tool | {} |", head.join(" | "))?;
    writeln!(page, "|---|{}", "--:|".repeat(items.len()))?;
    for tool in tools {
        let share = |item: &Item| {
            let tool_rows = rows.iter().filter(|row| row.tool == tool && row.item == *item);
            let shares: Vec<f64> = tool_rows
                .filter(|row| row.kind.limit.is_finite())
                .map(Row::limit_fraction)
                .collect();
            if shares.is_empty() {
                return String::new();
            }
            format!("{:.2}", shares.into_iter().fold(0.0, f64::max))
        };
        let cells: Vec<String> = items.iter().map(share).collect();
        writeln!(page, "| {tool} | {} |", cells.join(" | "))?;
    }
    writeln!(page)
}
