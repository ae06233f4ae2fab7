//! Choice of the fastest setting that meets a tolerance.

use super::row::{Label, Row};

/// A requirement on the error of a method.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ErrorRequirement {
    /// The root-mean-square error of the force is at most this share of the typical force.
    Force(f64),
    /// The largest error of depth is at most this, in the part's unit.
    Depth(f64),
}

impl ErrorRequirement {
    /// The requirements of the last table in `docs/measured/work-precision.md`.
    pub const ALL: [ErrorRequirement; 7] = [
        ErrorRequirement::Force(0.1),
        ErrorRequirement::Force(0.01),
        ErrorRequirement::Force(0.001),
        ErrorRequirement::Depth(0.1),
        ErrorRequirement::Depth(0.01),
        ErrorRequirement::Depth(0.001),
        ErrorRequirement::Depth(1e-6),
    ];

    /// Returns a row's error in the quantity of the requirement.
    fn error(self, row: &Row) -> Option<f64> {
        match self {
            ErrorRequirement::Force(_) => row.err_force,
            ErrorRequirement::Depth(_) => row.worst_depth,
        }
    }

    /// Returns the largest allowed error.
    fn max_error(self) -> f64 {
        match self {
            ErrorRequirement::Force(max_error) | ErrorRequirement::Depth(max_error) => max_error,
        }
    }
}

/// A setting that meets a requirement.
#[derive(Clone, Debug, PartialEq)]
pub struct Choice {
    /// The setting.
    pub label: Label,
    /// The median time per query in each scene, ns, in the order of the scenes.
    pub median_ns: Vec<u64>,
    /// The largest error over all scenes.
    pub error: f64,
}

/// Returns the setting that meets the requirement in every scene and has the shortest time in its slowest scene.
/// Returns `None` if no setting does, or if there are no scenes. `allowed` selects settings; it must give the same
/// answer for all rows of a setting.
pub fn fastest(
    rows: &[Row],
    scenes: &[&str],
    requirement: ErrorRequirement,
    allowed: impl Fn(&Row) -> bool,
) -> Option<Choice> {
    let mut labels: Vec<Label> = Vec::new();
    for row in rows.iter().filter(|row| allowed(row)) {
        let label = row.label();
        if !labels.contains(&label) {
            labels.push(label);
        }
    }
    let choices = labels.into_iter().filter_map(|label| choice(rows, scenes, requirement, label));
    let slowest_median = |choice: &Choice| choice.median_ns.iter().copied().max();
    choices.min_by_key(slowest_median)
}

/// Returns a setting's results in all scenes, if it meets the requirement in each.
fn choice(
    rows: &[Row],
    scenes: &[&str],
    requirement: ErrorRequirement,
    label: Label,
) -> Option<Choice> {
    let (mut median_ns, mut error) = (Vec::new(), 0.0f64);
    for scene in scenes {
        let row = rows.iter().find(|row| row.scene == *scene && row.label() == label)?;
        // `f64::max` would drop a NaN, and the method would count as exact.
        error = error.max(requirement.error(row).filter(|error| !error.is_nan())?);
        median_ns.push(row.p50_ns?);
    }
    let is_met = !median_ns.is_empty() && error <= requirement.max_error();
    is_met.then_some(Choice { label, median_ns, error })
}

#[cfg(test)]
mod tests {
    use super::super::row::tests::row;
    use super::*;

    #[test]
    fn takes_the_fastest_setting_that_meets_the_requirement_in_every_scene() {
        let rows = [
            // Fast, but inaccurate in one scene.
            row("a", "quick", 100, 0.005, 0.001),
            row("b", "quick", 100, 0.05, 0.2),
            // Accurate in both scenes; the second setting is faster in its slowest scene.
            row("a", "good", 200, 0.005, 0.005),
            row("b", "good", 900, 0.008, 0.009),
            row("a", "even", 700, 0.009, 0.002),
            row("b", "even", 700, 0.002, 0.02),
            // The best, but not measured in one scene.
            row("a", "elsewhere", 1, 0.0, 0.0),
        ];
        let fastest_for = |requirement| fastest(&rows, &["a", "b"], requirement, |_| true);
        let name = |requirement| fastest_for(requirement).map(|choice| choice.label.method);
        assert_eq!(name(ErrorRequirement::Force(0.1)), Some("quick"));
        assert_eq!(name(ErrorRequirement::Force(0.01)), Some("even"));
        assert_eq!(name(ErrorRequirement::Depth(0.01)), Some("good"));
        assert_eq!(name(ErrorRequirement::Depth(0.001)), None);
        let even = fastest_for(ErrorRequirement::Force(0.01)).expect("there is one");
        assert_eq!((even.median_ns.as_slice(), even.error), (&[700, 700][..], 0.009));
        let only =
            fastest(&rows, &["a"], ErrorRequirement::Force(0.1), |row| row.method != "elsewhere");
        assert_eq!(only.map(|choice| choice.label.method), Some("quick"));
        assert_eq!(fastest(&rows, &[], ErrorRequirement::Force(0.1), |_| true), None);
        let mut without_force = rows[2].clone();
        without_force.err_force = None;
        let mut invalid_force = without_force.clone();
        invalid_force.err_force = Some(f64::NAN);
        for row in [without_force, invalid_force] {
            assert_eq!(fastest(&[row], &["a"], ErrorRequirement::Force(1.0), |_| true), None);
        }
    }
}
