//! Depths of single triangles that are sensitive to rounding, compared with 256 bits: a sample of a section of the page
//! `certified.md`.

use touchoff_bench::rounding::cases::Family;
use touchoff_bench::rounding::{RoundingCheck, Row};

const CASES: u64 = 33_000;

fn rows(pinch: f64, cases: u64) -> Vec<Row> {
    let mut rounding = RoundingCheck::new(7);
    rounding.tightening = pinch;
    let mut rows = Family::ALL.map(Row::new).to_vec();
    (0..cases).for_each(|number| rounding.run_case(number, &mut rows));
    rows
}

#[test]
fn no_upper_bound_is_below_the_truth() {
    for row in rows(0.0, CASES) {
        assert_eq!(row.upper_violations, 0, "{row:?}");
        assert_eq!(row.too_wide, 0, "{row:?}");
        assert!(row.touching > row.cases / 3 && row.cases > 2900, "{row:?}");
    }
}

/// If the bounds lack what is added for rounding, the validation reports violations in each family.
#[test]
fn bounds_without_widening_are_reported_as_violations() {
    for row in rows(1.0, 2_200) {
        assert!(row.upper_violations > row.cases / 20, "{row:?}");
    }
}

#[test]
fn no_lower_bound_is_above_the_truth() {
    for row in rows(0.0, CASES) {
        assert_eq!(row.violations(), 0, "{row:?}");
    }
}
