//! The tables as Markdown.

use super::contact::Contact;
use super::errors::Table;
use super::plots::KINDS;
use super::verdict;
use super::{Pattern, Weighing, bounds, cover, missed};
use std::fmt::{Error, Write};

/// All that was measured.
#[derive(Clone, Debug)]
pub struct Measured {
    /// Errors by contact.
    pub tables: Vec<Table>,
    /// Contacts that were missed.
    pub missed: Vec<missed::Row>,
    /// What the covering radius promised.
    pub bounds: Vec<bounds::Row>,
    /// How large it is.
    pub cover: Vec<cover::Row>,
    /// How many cores `all` is.
    pub cores: usize,
}

/// The page below its title.
///
/// # Errors
/// None that a text could have.
pub fn page(measured: &Measured) -> Result<String, Error> {
    let mut page = String::new();
    writeln!(page, "## Errors by points\n")?;
    let depth = super::contact::DEPTH;
    writeln!(
        page,
        "Each tool is {depth} deep, the law is the thesis's. *Equal*: each point counts for the area over the number of points; *cells*: for
the area of its cell. Errors are root mean squares over all clouds and placements: of the force the length of the difference by
the force, of the torque about the tip alike, of the deepest depth by the depth. Points of CF3 and CF5 are carried from the mesh to
the true surface along the radius, with true normals, and weights grow as areas do on that way: so flats do not count. The last line has the
order p in `N^p`, by least squares of the logarithms.\n\n![errors](convergence.svg)"
    )?;
    for table in &measured.tables {
        errors(&mut page, table)?;
    }
    orders(&mut page, &measured.tables)?;
    if let Some(table) = measured.tables.iter().find(|t| t.contact == Contact::BallInPlane) {
        verdict::beside_prototype(&mut page, table)?;
    }
    missed(&mut page, &measured.missed)?;
    bounds(&mut page, &measured.bounds)?;
    cover(&mut page, &measured.cover, measured.cores)?;
    Ok(page)
}

fn errors(page: &mut String, table: &Table) -> Result<(), Error> {
    let contact = table.contact;
    writeln!(
        page,
        "\n### {}\n\n{}; the patch has {:.1} times the area of the contact.\n",
        contact.name(),
        contact.about(),
        table.patch
    )?;
    let torque = contact.is_line();
    let kinds = |what: &str| KINDS.map(|(_, _, name)| format!(" {what}: {name} |")).concat();
    let torques = if torque { kinds("torque") } else { String::new() };
    writeln!(
        page,
        "| in contact | points | placements |{}{torques} depth: random | depth: blue |",
        kinds("force")
    )?;
    writeln!(page, "|{}", "--:|".repeat(if torque { 13 } else { 9 }))?;
    for row in &table.rows {
        let placements = row.often.clouds * row.often.placements;
        write!(page, "| {:.1} | {} | {placements} |", row.colliding, row.points)?;
        for errors in [Some(row.force), torque.then_some(row.torque)].into_iter().flatten() {
            for error in errors.concat() {
                write!(page, " {error:.1e} |")?;
            }
        }
        writeln!(page, " {:.1e} | {:.1e} |", row.depth[0], row.depth[1])?;
    }
    write!(page, "| order | | |")?;
    let orders = |of: fn(&Table, Pattern, Weighing) -> [f64; 2]| {
        KINDS.map(|(pattern, weighing, _)| of(table, pattern, weighing)[0])
    };
    let mut all = orders(Table::force).to_vec();
    if torque {
        all.extend(orders(Table::torque));
    }
    all.extend(Pattern::ALL.map(|pattern| table.depth(pattern)[0]));
    for order in all {
        write!(page, " {order:.2} |")?;
    }
    writeln!(page)
}

fn orders(page: &mut String, tables: &[Table]) -> Result<(), Error> {
    writeln!(
        page,
        "\n### Orders\n\nOf the force and of the deepest depth in the number of points, and those of a prototype in CF1.\n"
    )?;
    let names = KINDS.map(|(_, _, name)| format!(" {name} |")).concat();
    writeln!(page, "| contact |{names} depth: random | depth: blue |\n|---|{}", "--:|".repeat(6))?;
    let expected = verdict::ORDERS.map(|order| format!(" {order:.2} |")).concat();
    writeln!(page, "| prototype |{expected} -1 | -1 |")?;
    for table in tables {
        write!(page, "| {} |", table.contact.name())?;
        for (pattern, weighing, _) in KINDS {
            write!(page, " {:.2} |", table.force(pattern, weighing)[0])?;
        }
        let [random, blue] = Pattern::ALL.map(|pattern| table.depth(pattern)[0]);
        writeln!(page, " {random:.2} | {blue:.2} |")?;
    }
    writeln!(page, "\n{}", verdict::orders(tables))
}

fn missed(page: &mut String, rows: &[missed::Row]) -> Result<(), Error> {
    let count = rows.first().map_or(0, |row| row.placements);
    writeln!(
        page,
        "\n## Missed contacts\n\nA ball of radius 1 in a plane with {} points to the square of the unit, {count} placements of each pattern at each
depth. *Expected* of a random cloud: `exp(-n)`, n the points that are in the disc in contact on average; of no cloud less than `1 - n`.\n
![missed](convergence-missed.svg)\n\n| depth | n | random | expected | blue | at least |\n|--:|--:|--:|--:|--:|--:|",
        missed::DENSITY
    )?;
    for row in rows {
        let [random, blue] = [0, 1].map(|pattern: usize| {
            let [share, error] = [row.missed[pattern], row.spread[pattern]];
            format!("{:.3} ± {:.3} %", 100.0 * share, 100.0 * error)
        });
        writeln!(
            page,
            "| {} | {:.2} | {random} | {:.3} % | {blue} | {:.3} % |",
            row.depth,
            row.disc(),
            100.0 * row.random(),
            100.0 * row.least()
        )?;
    }
    writeln!(page, "\n{}", verdict::missed(rows))
}

fn bounds(page: &mut String, rows: &[bounds::Row]) -> Result<(), Error> {
    writeln!(
        page,
        "\n## What the covering radius promises\n\nThe ball again, {} points to the square of the unit, ε proved of each cloud. *Flat bound*: how many balls
were missed that are `r - √(r² - ε²)` deep (and what single precision takes away); *ε*: that are ε deep; *found + ε*: how often that was less than the depth,
at depths up to r. The last two columns are what the depth was more than what was found, by ε. A ball about a box is at a side, an edge or
a corner; so it is in a hollow of the shape of the box.\n
| where | cloud | ε | placements | flat bound: missed | ε: missed | found + ε: too little | most | mean |\n|---|---|--:|--:|--:|--:|--:|--:|--:|",
        bounds::DENSITY
    )?;
    for row in rows {
        writeln!(
            page,
            "| {} | {} | {:.4} | {} | {} | {} | {} | {:.4} | {:.4} |",
            row.place.name(),
            row.pattern.name(),
            row.radius,
            row.placements,
            row.beyond_flat,
            row.beyond,
            row.too_deep,
            row.most,
            row.mean
        )?;
    }
    writeln!(page, "\n{}", verdict::bounds(rows))
}

fn cover(page: &mut String, rows: &[cover::Row], cores: usize) -> Result<(), Error> {
    writeln!(
        page,
        "\n## The covering radius\n\nε by the root of a point's share of the area, `ε √(N/area)`: on a plane 0.620 at the least, where points are in a lattice of
equal triangles. Times are to make the blue cloud, with weights and ε, on {cores} cores and on one, the best of a few below a million points. Other programs may have had
the cores: *busy* is how long the one core was at it. Both clouds were the same to the last bit.\n
| part | triangles | points | ε, random | ε, blue | s, {cores} cores | s, one core | busy |\n|---|--:|--:|--:|--:|--:|--:|--:|"
    )?;
    for row in rows {
        writeln!(
            page,
            "| {} | {} | {} | {:.3} | {:.3} | {:.3} | {:.3} | {:.3} |",
            row.part,
            row.triangles,
            row.points,
            row.radius[0],
            row.radius[1],
            row.all.as_secs_f64(),
            row.one.as_secs_f64(),
            row.work.as_secs_f64()
        )?;
    }
    writeln!(page, "\n{}", verdict::cover(rows))
}
