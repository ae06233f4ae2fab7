//! What is said of a method on a scene.

use serde::Serialize;

/// The law that all forces are made by.
pub const LAW: &str = "thesis";

/// What a method is, beside its word: what tells its rows from each other.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Label {
    /// The word for it.
    pub method: &'static str,
    /// Points of the cloud; none of a method that asks triangles.
    pub points: Option<usize>,
    /// How they are spread.
    pub sampling: Option<&'static str>,
    /// What each counts for: `equal`, the area over their number, or `cells`.
    pub weights: Option<&'static str>,
    /// How closely depth is proved, in the part's unit.
    pub tolerance: Option<f64>,
    /// How many nodes a query may look at.
    pub budget: Option<usize>,
}

impl Label {
    /// A method that asks the part's triangles.
    pub fn triangles(method: &'static str) -> Label {
        Label { method, ..Label::default() }
    }
}

/// A method on a scene. Times are of single queries, in nanoseconds. Errors are root mean squares over
/// the poses in true contact, by the root mean square of what is true; `None` where the method has no
/// such answer.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Row {
    /// The scene's word.
    pub scene: String,
    /// See [`Label`].
    pub method: &'static str,
    /// See [`Label`].
    pub points: Option<usize>,
    /// See [`Label`].
    pub sampling: Option<&'static str>,
    /// See [`Label`].
    pub weights: Option<&'static str>,
    /// Half of the queries took no longer.
    pub p50_ns: Option<u64>,
    /// Of a hundred 99 took no longer; `None` of too few.
    pub p99_ns: Option<u64>,
    /// Of the force.
    pub err_force: Option<f64>,
    /// Of the torque about the tip.
    pub err_torque: Option<f64>,
    /// Of the deepest depth.
    pub err_depth: Option<f64>,
    /// The share of poses in true contact at which nothing was felt; where nothing is in contact, at which
    /// something was.
    pub missed: f64,
    /// The force law.
    pub law: &'static str,
    /// See [`Label`].
    pub tolerance: Option<f64>,
    /// See [`Label`].
    pub budget: Option<usize>,
    /// The largest error of depth, in the part's unit.
    pub worst_depth: Option<f64>,
    /// Which errors were below what the truth itself is known to, and are given as that.
    pub floored: Vec<&'static str>,
    /// At how many poses it was timed.
    pub poses: usize,
    /// At how many placements errors were measured.
    pub checked: usize,
    /// Points inside on average (of a method that asks triangles, the share of poses in contact).
    pub colliding: f64,
    /// A query on average.
    pub ns_avg: f64,
}

impl Row {
    /// What it is.
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

    /// The median in microseconds.
    pub fn micros(&self) -> Option<f64> {
        self.p50_ns.map(|ns| ns as f64 / 1e3)
    }

    /// As one object.
    ///
    /// # Panics
    /// Never: it is made of numbers and words.
    pub fn json(&self) -> String {
        serde_json::to_string(self).expect("a row of numbers and words")
    }
}

/// What is compared with the truth.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// The force.
    Force,
    /// The torque about the tip.
    Torque,
    /// The deepest depth.
    Depth,
}

impl Quantity {
    /// All three, in the order of lists.
    pub const ALL: [Quantity; 3] = [Quantity::Force, Quantity::Torque, Quantity::Depth];

    /// The word for it.
    pub const fn name(self) -> &'static str {
        match self {
            Quantity::Force => "force",
            Quantity::Torque => "torque",
            Quantity::Depth => "depth",
        }
    }

    /// Its error in a row.
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

    /// A row of which only some matters.
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
    fn rows_are_objects_whose_first_keys_are_the_promised_ones() {
        let text = row("outside", "cloud", 300, 0.1, 0.01).json();
        let read: Value = serde_json::from_str(&text).expect("an object");
        let object = read.as_object().expect("an object");
        let promised = [
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
        let more = [
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
        assert_eq!(object.len(), promised.len() + more.len());
        for key in promised.iter().chain(&more) {
            assert!(object.contains_key(*key), "{key} is missing in {text}");
        }
        // In the text they stand in this order.
        let places = promised.map(|key| text.find(&format!("\"{key}\":")).expect("the key"));
        assert!(places.is_sorted(), "{text}");
        assert!(object["p99_ns"].is_null() && object["err_force"] == 0.1);
    }
}
