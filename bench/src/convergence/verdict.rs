//! What the tables say, in sentences whose figures come from the tables.

use super::errors::{Row, Table};
use super::plots::KINDS;
use super::{Pattern, bounds, cover, missed};
use std::fmt::{Error, Write};

/// Orders of the prototype's force errors in CF1, by kind.
pub(super) const ORDERS: [f64; 4] = [-0.50, -1.26, -0.51, -1.26];
/// Its errors at so many contacts, by kind.
const PROTOTYPE: [(f64, [f64; 4]); 2] =
    [(152.0, [9.3e-2, 6.0e-3, 2.8e-2, 1.2e-3]), (611.0, [5e-2, 9.4e-4, 1.4e-2, 2.1e-4])];
/// What it missed of contacts 0.01 deep: random, and points as far apart as discs.
const MISSED: [f64; 2] = [0.45, 0.21];

/// The errors in CF1 beside those of the prototype.
pub(super) fn beside_prototype(page: &mut String, table: &Table) -> Result<(), Error> {
    writeln!(page, "\n### CF1 beside a prototype\n")?;
    let names = KINDS.map(|(_, _, name)| format!(" {name} | prototype |")).concat();
    writeln!(page, "| in contact |{names}\n|--:|{}", "--:|".repeat(8))?;
    let mut ratios = Vec::new();
    for (contacts, expected) in PROTOTYPE {
        let Some(row) = table.at(contacts) else { continue };
        write!(page, "| {:.1} |", row.colliding)?;
        for (found, expected) in kinds(row).into_iter().zip(expected) {
            write!(page, " {found:.1e} | {expected:.1e} |")?;
            ratios.push(found / expected);
        }
        writeln!(page)?;
    }
    let [low, high] = range(ratios);
    let last = table.rows.last().map_or([f64::NAN; 4], kinds);
    let contacts = table.rows.last().map_or(0.0, |row| row.colliding);
    writeln!(
        page,
        "\nErrors are {low:.2} to {high:.2} times the prototype's. At {contacts:.0} contacts cells make the error of random points {:.0} times less, \
         even spreading alone {:.1} times, both together {:.0} times.",
        last[0] / last[1],
        last[0] / last[2],
        last[0] / last[3]
    )
}

/// Errors of the force by kind.
fn kinds(row: &Row) -> [f64; 4] {
    KINDS.map(|(pattern, weighing, _)| row.force[pattern as usize][weighing as usize])
}

/// What all contacts have in common.
pub(super) fn orders(tables: &[Table]) -> String {
    let of = |kind: usize| {
        let (pattern, weighing, name) = KINDS[kind];
        let [low, high] = range(tables.iter().map(|t| t.force(pattern, weighing)[0]));
        format!("{name}: {high:.2} to {low:.2}")
    };
    let depths = |line: bool| {
        let tables = tables.iter().filter(|table| table.contact.is_line() == line);
        range(tables.flat_map(|table| Pattern::ALL.map(|pattern| table.depth(pattern)[0])))
    };
    let ([low, high], [low_line, high_line]) = (depths(false), depths(true));
    format!(
        "Over all contacts {}; {}; {}; {}. The deepest depth has {high:.2} to {low:.2} where a ball touches. A side touches along a line: there the \
         nearest point's distance falls as N^-1, not N^-1/2, and the depth's error as its square: {high_line:.2} to {low_line:.2}.",
        of(0),
        of(1),
        of(2),
        of(3)
    )
}

/// What is missed at a depth of 0.01, and how far chance is from the formula.
pub(super) fn missed(rows: &[missed::Row]) -> String {
    // Where hardly any cloud missed one its errors say nothing.
    let often = |row: &&missed::Row| row.missed[0] * row.placements as f64 > 1000.0;
    let errors = |row: &missed::Row| (row.missed[0] - row.random()).abs() / row.spread[0];
    let most = rows.iter().filter(often).map(errors).fold(0.0, f64::max);
    let below = rows.iter().filter(|row| row.missed[1] < row.least() * 0.99).count();
    let found = rows.iter().find(|row| row.depth == 0.01);
    let at = found.map_or(String::new(), |row| {
        let [random, blue] = row.missed.map(|share| 100.0 * share);
        let [expected, disc] = MISSED.map(|share| 100.0 * share);
        format!("At 0.01 random points miss {random:.1} % (prototype {expected:.0} %), blue ones {blue:.1} % ({disc:.0} %). ")
    });
    let never = rows.iter().find(|row| row.missed[1] == 0.0);
    let never = never.map_or(String::new(), |row| {
        let random = 100.0 * row.missed[0];
        format!(" From {} on blue clouds missed none, random ones {random:.2} % there.", row.depth)
    });
    format!(
        "{at}Random shares are within {most:.1} standard errors of the formula; {below} blue shares are below the least by more than a hundredth of it.{never}"
    )
}

/// Whether promises are kept.
pub(super) fn bounds(rows: &[bounds::Row]) -> String {
    let sum = |of: &dyn Fn(&bounds::Row) -> usize| rows.iter().map(of).sum::<usize>();
    let flat = |at: bool| {
        let of = move |row: &bounds::Row| (row.place == bounds::Place::Plane) == at;
        let rows = rows.iter().filter(|row| of(row));
        rows.fold([0, 0], |sum, row| [sum[0] + row.beyond_flat, sum[1] + row.placements])
    };
    let ([plane, planes], [other, others]) = (flat(true), flat(false));
    let placements = sum(&|row| row.placements);
    let most = rows.iter().map(|row| row.most).fold(0.0, f64::max);
    format!(
        "On the plane {plane} of {planes} balls deeper than `r - √(r² - ε²)` were missed, elsewhere {other} of {others}: beside a convex edge the nearest point can be \
         farther from the ball's middle than on a plane, so there that bound is none, and ε is: deeper than ε {} of {placements} were missed. \
         Found + ε was less than the depth {} times in {placements}; it is tight: the depth came to {:.1} % of ε beyond what was found.",
        sum(&|row| row.beyond),
        sum(&|row| row.too_deep),
        100.0 * most
    )
}

/// How large the radius is, and how fast clouds are made.
pub(super) fn cover(rows: &[cover::Row]) -> String {
    let Some(points) = rows.iter().map(|row| row.points).max() else { return String::new() };
    let dense = || rows.iter().filter(|row| row.points >= 10_000);
    let [low, high] = range(dense().map(|row| row.radius[1]));
    let [low_random, high_random] = range(dense().map(|row| row.radius[0]));
    let largest = || rows.iter().filter(|row| row.points == points);
    let seconds = |of: fn(&cover::Row) -> f64| range(largest().map(of));
    let [quick, long] = seconds(|row| row.work.as_secs_f64());
    let [slow, fast] = seconds(|row| row.one.as_secs_f64() / row.all.as_secs_f64());
    let [least, most] = seconds(|row| 100.0 * row.work.as_secs_f64() / row.one.as_secs_f64());
    let shared = least < 95.0;
    let rest = if shared {
        ": the rest other programs had, so what more cores save is not told"
    } else {
        ""
    };
    format!(
        "From 10,000 points on ε √(N/area) is {low:.3} to {high:.3} of blue clouds and {low_random:.2} to {high_random:.2} of random ones. {points} points keep \
         one core busy for {quick:.1} to {long:.1} s; by the clock it took {slow:.2} to {fast:.2} times as long as all cores, \
         and was busy for {least:.0} to {most:.0} % of that{rest}."
    )
}

fn range(values: impl IntoIterator<Item = f64>) -> [f64; 2] {
    let from = [f64::INFINITY, f64::NEG_INFINITY];
    values.into_iter().fold(from, |[low, high], value| [low.min(value), high.max(value)])
}
