//! The result of a method on a scene.

use serde::Serialize;

/// The law of all forces.
pub const LAW: &str = "thesis";

/// A method and its settings, which identify its rows within a scene.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Label {
    /// The method's name.
    pub method: &'static str,
    /// Number of points in the cloud; `None` for methods on triangles.
    pub points: Option<usize>,
    /// The sampling pattern.
    pub sampling: Option<&'static str>,
    /// The weights: `equal`, the area over the number of points, or `cells`.
    pub weights: Option<&'static str>,
    /// Tolerance of certified depths, in the part's unit.
    pub tolerance: Option<f64>,
    /// Maximum number of nodes visited per query.
    pub budget: Option<usize>,
}

impl Label {
    /// Returns the label of a method on the part's triangles.
    pub fn triangles(method: &'static str) -> Label {
        Label { method, ..Label::default() }
    }
}

/// The result of a method on a scene. Times are per query, in nanoseconds. Errors are root mean squares over the poses
/// in true contact, relative to the root mean square of the true value. They are `None` if the method does not compute
/// that quantity.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Row {
    /// The scene's name.
    pub scene: String,
    /// See [`Label`].
    pub method: &'static str,
    /// See [`Label`].
    pub points: Option<usize>,
    /// See [`Label`].
    pub sampling: Option<&'static str>,
    /// See [`Label`].
    pub weights: Option<&'static str>,
    /// Median time per query.
    pub p50_ns: Option<u64>,
    /// 99th percentile of the time per query; `None` if there are too few queries.
    pub p99_ns: Option<u64>,
    /// Error of the force.
    pub err_force: Option<f64>,
    /// Error of the torque about the tip.
    pub err_torque: Option<f64>,
    /// Error of the greatest depth.
    pub err_depth: Option<f64>,
    /// Share of poses in true contact at which the method reports none. In a scene without contact: share of poses at
    /// which it reports contact.
    pub missed: f64,
    /// The force law.
    pub law: &'static str,
    /// See [`Label`].
    pub tolerance: Option<f64>,
    /// See [`Label`].
    pub budget: Option<usize>,
    /// The largest error of depth, in the part's unit.
    pub worst_depth: Option<f64>,
    /// Quantities whose error was below the accuracy of the true value, and is given as that accuracy.
    pub floored: Vec<&'static str>,
    /// Number of timed poses.
    pub poses: usize,
    /// Number of placements at which errors were measured.
    pub checked: usize,
    /// Mean number of points inside; for methods on triangles, the share of poses in contact.
    pub colliding: f64,
    /// Mean time per query.
    pub ns_avg: f64,
}

impl Row {
    /// Returns the label.
    pub fn label(&self) -> Label {
        Label {
            method: self.method,
            points: self.points,
            sampling: self.sampling,
            weights: self.weights,
            tolerance: self.tolerance,
            budget: self.budget,
        }
    }

    /// Returns the median time in microseconds.
    pub fn micros(&self) -> Option<f64> {
        self.p50_ns.map(|ns| ns as f64 / 1e3)
    }

    /// Returns the row as a JSON object on one line.
    ///
    /// # Panics
    /// Never: rows contain only numbers and strings.
    pub fn json(&self) -> String {
        serde_json::to_string(self).expect("a row of numbers and words")
    }
}

/// A quantity that is compared with its true value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// The force.
    Force,
    /// The torque about the tip.
    Torque,
    /// The greatest depth.
    Depth,
}

impl Quantity {
    /// All three, in the order used in arrays.
    pub const ALL: [Quantity; 3] = [Quantity::Force, Quantity::Torque, Quantity::Depth];

    /// Returns the name.
    pub const fn name(self) -> &'static str {
        match self {
            Quantity::Force => "force",
            Quantity::Torque => "torque",
            Quantity::Depth => "depth",
        }
    }

    /// Returns its error in a row.
    pub fn error(self, row: &Row) -> Option<f64> {
        match self {
            Quantity::Force => row.err_force,
            Quantity::Torque => row.err_torque,
            Quantity::Depth => row.err_depth,
        }
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use serde_json::Value;

    /// Returns a row in which only the given values matter.
    pub(crate) fn row(scene: &str, method: &'static str, ns: u64, error: f64, depth: f64) -> Row {
        Row {
            scene: scene.to_owned(),
            method,
            points: Some(1000),
            sampling: Some("blue"),
            weights: Some("cells"),
            p50_ns: Some(ns),
            p99_ns: None,
            err_force: Some(error),
            err_torque: Some(error),
            err_depth: Some(error),
            missed: 0.0,
            law: LAW,
            tolerance: None,
            budget: None,
            worst_depth: Some(depth),
            floored: vec!["force"],
            poses: 10,
            checked: 10,
            colliding: 3.5,
            ns_avg: ns as f64,
        }
    }

    #[test]
    fn json_starts_with_the_promised_keys() {
        let text = row("outside", "cloud", 300, 0.1, 0.01).json();
        let read: Value = serde_json::from_str(&text).expect("an object");
        let object = read.as_object().expect("an object");
        let first_keys = [
            "scene",
            "method",
            "points",
            "sampling",
            "weights",
            "p50_ns",
            "p99_ns",
            "err_force",
            "err_torque",
            "err_depth",
            "missed",
        ];
        let other_keys = [
            "law",
            "tolerance",
            "budget",
            "worst_depth",
            "floored",
            "poses",
            "checked",
            "colliding",
            "ns_avg",
        ];
        assert_eq!(object.len(), first_keys.len() + other_keys.len());
        for key in first_keys.iter().chain(&other_keys) {
            assert!(object.contains_key(*key), "{key} is missing in {text}");
        }
        // The keys appear in the text in this order.
        let positions = first_keys.map(|key| text.find(&format!("\"{key}\":")).expect("the key"));
        assert!(positions.is_sorted(), "{text}");
        assert!(object["p99_ns"].is_null() && object["err_force"] == 0.1);
    }
}
