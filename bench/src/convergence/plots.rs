//! The plots beside the page.

use super::contact::Contact;
use super::errors::Table;
use super::missed::{self, Row};
use super::{Pattern, Weighing};
use crate::plot::{Axis, Plot, Series};

/// The four kinds of cloud, in the order of tables.
pub const KINDS: [(Pattern, Weighing, &str); 4] = [
    (Pattern::Random, Weighing::Equal, "random, equal"),
    (Pattern::Random, Weighing::Cells, "random, cells"),
    (Pattern::Blue, Weighing::Equal, "blue, equal"),
    (Pattern::Blue, Weighing::Cells, "blue, cells"),
];

/// Errors of the force by the points in contact, with the fitted powers.
pub fn errors(table: &Table) -> Plot {
    let mut plot = Plot::new(
        format!("Error of the force, {}", table.contact.name()),
        Axis::log("points in contact"),
        Axis::log("rms error of the force, relative"),
    );
    for (look, (pattern, weighing, name)) in KINDS.into_iter().enumerate() {
        let at = |points: f64| points / table.patch;
        let [slope, log] = table.force(pattern, weighing);
        let fitted =
            |points: usize| [at(points as f64), (log + slope * (points as f64).ln()).exp()];
        let ends = [table.rows.first(), table.rows.last()];
        let line = ends.into_iter().flatten().map(|row| fitted(row.points)).collect();
        let error = |row: &super::errors::Row| row.force[pattern as usize][weighing as usize];
        let points = table.rows.iter().map(|row| [at(row.points as f64), error(row)]).collect();
        plot = plot.with(Series::points(name, points).look(look));
        plot = plot.with(Series::dashes(format!("N^{slope:.2}"), line).look(look));
    }
    plot
}

/// Shares of contacts that are missed.
pub fn missed(rows: &[Row]) -> Plot {
    let mut plot = Plot::new(
        format!("Contacts missed at {} points to the square of the unit", missed::DENSITY),
        Axis::log("how deep the ball of radius 1 is"),
        Axis::linear("share missed").reaching(1.0),
    );
    for (look, pattern) in Pattern::ALL.into_iter().enumerate() {
        let points = rows.iter().map(|row| [row.depth, row.missed[look]]).collect();
        plot = plot.with(Series::points(pattern.name(), points).look(look));
    }
    let [low, high] = [rows.first(), rows.last()].map(|row| row.map_or(1.0, |row| row.depth));
    let depths = (0..=60).map(|k| low * (high / low).powf(f64::from(k) / 60.0));
    let none = [0.0; 2];
    let rows = depths.map(|depth| Row { depth, placements: 0, missed: none, spread: none });
    let (random, least): (Vec<_>, Vec<_>) =
        rows.map(|row| ([row.depth, row.random()], [row.depth, row.least()])).unzip();
    plot.with(Series::dashes("exp(-points in the disc)", random).look(0))
        .with(Series::dashes("1 - points in the disc", least).look(1))
}

/// The contact that is drawn.
pub const DRAWN: Contact = Contact::BallInPlane;
