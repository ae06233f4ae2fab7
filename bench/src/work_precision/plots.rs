//! Diagrams of time against error.

use super::row::{Quantity, Row};
use crate::plot::{Axis, Plot, Series};

/// A group of rows that share a name and a colour.
struct Family {
    name: String,
    colour: usize,
    /// True if the points are joined by a line. Those of peers are not, so that this project's lines remain visible.
    joined: bool,
    bold: bool,
}

/// The peers, in the order of their colour numbers from `FIRST_PEER`.
const PEERS: [&str; 6] =
    ["brute-f64", "brute-f32", "thesis", "parry-bvh", "fidget", "parry-contact"];
const FIRST_PEER: usize = 10;

/// Returns the family of a row, or `None` if the row has no error of that quantity or another row represents it.
fn family(row: &Row, quantity: Quantity) -> Option<Family> {
    quantity.error(row)?;
    let (sampling, weights) = (row.sampling.unwrap_or("-"), row.weights.unwrap_or("-"));
    let depth = quantity == Quantity::Depth;
    let ours = |name: String, colour| Some(Family { name, colour, joined: true, bold: false });
    match (row.method, sampling, weights) {
        ("cloud", "centroids", _) => ours("centroids".to_owned(), 7),
        // Depth does not depend on the weights.
        ("cloud", _, "equal") if depth => None,
        ("cloud", "blue", "cells") => {
            let kind = if depth { "blue" } else { "blue, cells" };
            Some(Family { name: kind.to_owned(), colour: 3, joined: true, bold: true })
        }
        ("cloud", "random", "cells") if depth => ours("random".to_owned(), 1),
        ("cloud", ..) => {
            let colour = match (sampling, weights) {
                ("random", "equal") => 0,
                ("random", _) => 1,
                _ => 2,
            };
            ours(format!("{sampling}, {weights}"), colour)
        }
        ("cloud + bound", ..) => {
            ours(format!("{sampling} + bound"), if sampling == "random" { 0 } else { 2 })
        }
        ("graded", ..) => ours("graded".to_owned(), 4),
        ("certified", ..) => ours("certified".to_owned(), 6),
        (peer, ..) => {
            let index = PEERS.iter().position(|name| *name == peer)?;
            let colour = FIRST_PEER + index;
            Some(Family { name: peer.to_owned(), colour, joined: false, bold: false })
        }
    }
}

/// Returns the points on the Pareto front, in the order of the front. A point is left out if its error is less than one
/// per cent below that of a faster point: such rows are the same sums in another order.
pub(super) fn improving_front(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    const MAX_ERROR_RATIO: f64 = 0.99;
    let mut corners = front(points);
    let mut best = f64::INFINITY;
    corners.retain(|[_, error]| {
        let improves = *error < MAX_ERROR_RATIO * best;
        best = if improves { *error } else { best };
        improves
    });
    corners
}

/// Returns the Pareto front, from left to right: the points that no other point undercuts in both coordinates. One of
/// several equal points is kept; points that are not finite are left out.
fn front(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let mut sorted: Vec<[f64; 2]> =
        points.iter().copied().filter(|p| p.iter().all(|c| c.is_finite())).collect();
    sorted.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    let mut best = f64::INFINITY;
    sorted.retain(|[_, y]| {
        let improves = *y < best;
        best = best.min(*y);
        improves
    });
    sorted
}

/// Plots the error of a quantity over the time of a query.
pub(super) fn plot(rows: &[&Row], scene: &str, quantity: Quantity) -> Plot {
    let mut plot = Plot::new(
        format!("{scene}: error of the {} against time", quantity.name()),
        Axis::log("median time of a query, µs; of this project, dashes to the 99th percentile"),
        Axis::log(format!("rms error of the {}, relative", quantity.name())),
    );
    let mut families: Vec<(Family, Vec<[f64; 2]>)> = Vec::new();
    let mut percentile_lines = Vec::new();
    for row in rows {
        let (Some(family), Some(micros)) = (family(row, quantity), row.micros()) else { continue };
        let Some(error) = quantity.error(row) else { continue };
        if let Some(p99) = row.p99_ns.filter(|_| family.joined) {
            percentile_lines
                .push((family.colour, vec![[micros, error], [p99 as f64 / 1e3, error]]));
        }
        match families.iter_mut().find(|(existing, _)| existing.name == family.name) {
            Some((_, points)) => points.push([micros, error]),
            None => families.push((family, vec![[micros, error]])),
        }
    }
    for (colour, ends) in percentile_lines {
        plot = plot.with_series(Series::dashes("", ends).with_colour(colour));
    }
    for (family, points) in families {
        let series = match family.joined {
            true => Series::line(family.name, points),
            false => Series::points(family.name, points),
        };
        let series = series.with_colour(family.colour);
        plot = plot.with_series(if family.bold { series.bold() } else { series });
    }
    plot
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keeps_the_points_that_no_other_point_undercuts() {
        let points = [[2.0, 2.0], [1.0, 5.0], [3.0, 2.0], [4.0, 1.0], [1.0, 6.0], [2.0, 2.0]];
        assert_eq!(front(&points), [[1.0, 5.0], [2.0, 2.0], [4.0, 1.0]]);
        assert_eq!(front(&[[f64::NAN, 0.0], [1.0, f64::INFINITY]]), [[0.0; 2]; 0]);
    }

    #[test]
    fn leaves_out_points_that_hardly_improve() {
        let points = [[1.0, 0.5], [2.0, 0.499], [3.0, 0.498], [4.0, 0.25], [0.5, 0.9], [5.0, 0.3]];
        assert_eq!(improving_front(&points), [[0.5, 0.9], [1.0, 0.5], [4.0, 0.25]]);
        assert_eq!(improving_front(&[]), [[0.0; 2]; 0]);
    }
}
