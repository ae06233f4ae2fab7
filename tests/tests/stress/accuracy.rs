//! The contract at many points of each profile: half of them within 1e-6 of the surface or of a splitting curve, the
//! others anywhere, and besides all corners, the axis, and the points with the largest errors that a search found.
//!
//! With `--nocapture` the test prints one line per tool.

use crate::points::points;
use crate::truth::Profiled;
use crate::validator::{DEPTH, Validator};
use rayon::prelude::*;
use touchoff_tests::checks::{Checks, assert_no_misses};
use touchoff_tests::count::case_count;
use touchoff_tests::oracle::Nearest;
use touchoff_tests::profiles::tools;

/// Number of points that are evaluated at a time, so that a million take no gigabytes.
const POINTS_PER_CHUNK: usize = 1 << 15;

#[test]
fn every_profile_keeps_the_contract() {
    let count = case_count("POINTS", 6_000);
    let tools = tools();
    // All tools but the thesis's own, whose magnitudes are not distances, and the two solids.
    assert_eq!(tools.len(), touchoff_tools::TOOLS.len() - 3);
    let results: Vec<Checks> = tools
        .par_iter()
        .with_max_len(1)
        .map(|(tool, restated)| {
            let mut checks = Checks::new(restated.name);
            let truth = Profiled::new(*tool, restated);
            let validator =
                Validator { centres_are_rounded: false, ..Validator::new(*tool, &truth) };
            for chunk in points(&Nearest::new(restated), count, 2).chunks(POINTS_PER_CHUNK) {
                validator.validate(chunk, &mut checks);
            }
            checks
        })
        .collect();
    results.iter().for_each(|checks| checks.print_line(DEPTH));
    assert_no_misses(&results);
}
