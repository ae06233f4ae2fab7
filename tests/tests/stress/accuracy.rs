//! The contract at many points of each tool: half of them within 1e-6 of the surface or of a splitting curve, the
//! others anywhere, and besides all corners, points on the axis and beside it (item 4), and the points with the largest
//! errors that a search found.
//!
//! With `--nocapture` the test prints one line per tool.

use crate::points::points;
use crate::run;
use crate::validator::{DEPTH, Validator};
use touchoff_tests::checks::assert_no_misses;
use touchoff_tests::count::case_count;
use touchoff_tests::oracle::restated;

/// Number of points that are evaluated at a time, so that a million take no gigabytes.
const POINTS_PER_CHUNK: usize = 1 << 15;

#[test]
fn every_tool_keeps_the_contract() {
    let count = case_count("POINTS", 6_000);
    let results = run(4, |subject, _, checks| {
        // Centres of a profile are given points of the half plane.
        let centres_are_rounded = restated::of(subject.name()).is_none();
        let validator = Validator::new(subject.tool, &*subject.truth);
        let validator = Validator { centres_are_rounded, ..validator };
        for chunk in points(&*subject.oracle, count, 2).chunks(POINTS_PER_CHUNK) {
            validator.validate(chunk, checks);
        }
    });
    results.iter().for_each(|checks| checks.print_line(DEPTH));
    assert_no_misses(&results);
}
