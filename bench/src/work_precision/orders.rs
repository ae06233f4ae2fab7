//! Orders of convergence: the slopes of errors over the number of points, both logarithmic.

use super::row::{Quantity, Row};

/// The orders fitted for a scene and a kind of cloud.
#[derive(Clone, Debug, PartialEq)]
pub struct Orders {
    /// The scene.
    pub scene: String,
    /// The sampling pattern.
    pub sampling: &'static str,
    /// The kind of weights.
    pub weights: &'static str,
    /// Slopes for force, torque and depth. `None` if too few errors exceed the accuracy of the true values.
    pub slopes: [Option<f64>; 3],
}

/// Returns the expected order for a smooth contact whose border is a curve on the part.
pub fn expected(weights: &str, quantity: Quantity) -> f64 {
    match quantity {
        Quantity::Depth => -1.0,
        _ if weights == super::lineup::EQUAL => -0.5,
        _ => -1.26,
    }
}

/// Fits all orders that the rows allow, in the order of the rows.
pub fn orders(rows: &[Row]) -> Vec<Orders> {
    let mut orders: Vec<Orders> = Vec::new();
    let clouds = rows.iter().filter(|row| is_cloud_row(row));
    for row in clouds {
        let (Some(sampling), Some(weights)) = (row.sampling, row.weights) else { continue };
        let belongs = |other: &Row| {
            is_cloud_row(other)
                && other.scene == row.scene
                && (other.sampling, other.weights) == (row.sampling, row.weights)
        };
        let is_same = |fitted: &Orders| {
            fitted.scene == row.scene && (fitted.sampling, fitted.weights) == (sampling, weights)
        };
        if !orders.iter().any(is_same) {
            let own_rows: Vec<&Row> = rows.iter().filter(|other| belongs(other)).collect();
            let slopes = Quantity::ALL.map(|quantity| slope(&own_rows, quantity));
            orders.push(Orders { scene: row.scene.clone(), sampling, weights, slopes });
        }
    }
    orders
}

fn is_cloud_row(row: &Row) -> bool {
    row.method == "cloud"
}

fn slope(rows: &[&Row], quantity: Quantity) -> Option<f64> {
    const MIN_POINTS: usize = 3;
    let point = |row: &&Row| {
        let is_not_floored = !row.floored.contains(&quantity.name());
        let error = quantity.error(row).filter(|error| is_not_floored && *error > 0.0)?;
        Some([row.points? as f64, error])
    };
    let points: Vec<[f64; 2]> = rows.iter().filter_map(point).collect();
    (points.len() >= MIN_POINTS).then(|| order(&points))
}

/// Returns the order `p` of `y = c x^p`, by least squares on the logarithms.
fn order(points: &[[f64; 2]]) -> f64 {
    let logs = points.iter().map(|[x, y]| [x.ln(), y.ln()]).collect::<Vec<_>>();
    let mean = |axis: usize| logs.iter().map(|p| p[axis]).sum::<f64>() / logs.len() as f64;
    let [x, y] = [mean(0), mean(1)];
    let covariance: f64 = logs.iter().map(|p| (p[0] - x) * (p[1] - y)).sum();
    let variance: f64 = logs.iter().map(|p| (p[0] - x) * (p[0] - x)).sum();
    covariance / variance
}

#[cfg(test)]
mod tests {
    use super::super::{Plan, measure};
    use super::*;

    #[test]
    fn recovers_the_exponent_of_a_power() {
        let points = [1.0, 10.0, 400.0].map(|x: f64| [x, 3.0 * x.powf(-1.26)]);
        assert!((order(&points) + 1.26).abs() < 1e-12);
    }

    #[test]
    fn a_ball_in_a_plane_converges_with_the_known_orders() {
        let plan = Plan {
            contacts: vec![30, 100, 300, 1_000],
            tolerances: vec![],
            timed: 25,
            ..Plan::quick(1)
        };
        let measured = measure(&["CF1"], None, &plan, &mut drop).expect("a patch");
        let fitted = orders(&measured.rows);
        assert_eq!(fitted.len(), 4);
        for orders in &fitted {
            for quantity in [Quantity::Force, Quantity::Torque] {
                let slope = orders.slopes[quantity as usize].expect("four sizes");
                let difference = (slope - expected(orders.weights, quantity)).abs();
                assert!(difference < 0.2, "{orders:?}");
            }
        }
    }

    #[test]
    fn centroids_are_exact_where_depth_is_affine() {
        let plan =
            Plan { contacts: vec![10, 500], tolerances: vec![], timed: 25, ..Plan::quick(1) };
        let measured = measure(&["CF9"], None, &plan, &mut drop).expect("a patch");
        let force = |sampling: &str| {
            let sampled = measured.rows.iter().filter(|row| row.sampling == Some(sampling));
            let errors = sampled.filter_map(|row| row.err_force).collect::<Vec<f64>>();
            assert!(errors.len() >= 2, "{sampling}");
            errors
        };
        assert!(force("centroids").iter().all(|error| *error < 1e-12), "{:?}", force("centroids"));
        // The exactness comes from the centroids, not from the scene: clouds have errors there.
        assert!(force("blue").iter().all(|error| *error > 1e-6), "{:?}", force("blue"));
    }
}
