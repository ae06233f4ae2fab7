//! The stress list: every library tool at points, poses and scenes that are hard, against arithmetic of 256 bits.
//!
//! *The contract* of an evaluator is this. Let S be the next power of two above the tool's largest coordinate,
//! ε = 2^-52, ulp(S) = ε S, and ρ the distance from a point to the nearest one at which its direction u does not exist.
//!
//! - A depth is within 1 ulp(S). The depth of `Fig73` is its own magnitude.
//! - A distance outside is within 1 ulp(S), where S is also at least the power of two above the point's distance from the
//!   origin. A tool that knows only a lower bound of the distance does not exceed it by more.
//! - The side and the region are right beyond 2 ulp(S) from a border.
//! - ||u| - 1| ≤ 4 ε, and u is within 8 ε max(1, S/ρ).
//! - No number is NaN or infinite, and no depth, magnitude, niceness or distance is below 0.
//! - Scalar and SIMD code have the same bits.
//!
//! Each item of the list is a module. `STRESS=N` takes N times the sample, up to the extents of the full list, which
//! `N = 3000` reaches; that takes some minutes. With `--nocapture` the tests print the worst value of each quantity
//! beside its limit:
//!
//! ```sh
//! STRESS=3000 cargo test --release -p touchoff-tests --test stress -- --nocapture
//! POINTS=1000000 cargo test --release -p touchoff-tests --test stress accuracy -- --nocapture
//! ```

mod accuracy;
mod aligned;
mod border_points;
mod cycles;
mod degenerate;
mod denormal;
mod equidistant;
mod equivalent;
mod input;
mod leaves;
mod prelude;
mod scaled;
mod scene;
mod tangent;
mod text;
mod truth;
mod validator;

use rayon::prelude::*;
use std::sync::LazyLock;
use touchoff_tests::checks::{Checks, assert_no_misses, print_worst};
use touchoff_tests::count::case_count;
use touchoff_tests::oracle::rng::Rng;
use truth::{Subject, subjects};
use validator::Validator;

const SEED: u64 = 7;

static SUBJECTS: LazyLock<Vec<Subject>> = LazyLock::new(subjects);

/// Returns how much to test: the extent of the sample times the variable `STRESS`, at most that of the full list.
fn extent(sample: usize, full: usize) -> usize {
    sample.saturating_mul(case_count("STRESS", 1)).min(full)
}

/// Runs the item of this number for every tool, in parallel. The random numbers depend on the item and the tool only, so the results
/// do not depend on the number of cores.
fn run(item: u64, check: impl Fn(&Subject, &mut Rng, &mut Checks) + Sync) -> Vec<Checks> {
    // Threads take one tool at a time, since tools differ in computing time.
    let tools = SUBJECTS.par_iter().with_max_len(1);
    tools
        .map(|subject| {
            let name = subject.name();
            let hash =
                name.bytes().fold(0u64, |sum, c| sum.wrapping_mul(31).wrapping_add(c.into()));
            let mut rng = Rng::new(SEED ^ hash.wrapping_mul(64).wrapping_add(item));
            let mut checks = Checks::new(name);
            check(subject, &mut rng, &mut checks);
            checks
        })
        .collect()
}

/// Runs an item that has cases for every tool, and fails if a limit is exceeded.
fn check_tools(item: u64, check: impl Fn(&Subject, &mut Rng, &mut Checks) + Sync) {
    let tools = run(item, check);
    print_worst(&format!("item {item}"), &tools);
    assert_no_misses(&tools);
    for (checks, subject) in tools.iter().zip(&*SUBJECTS) {
        assert!(checks.cases() > 0, "no case of {}", subject.name());
    }
}

fn subject(name: &str) -> &'static Subject {
    SUBJECTS.iter().find(|subject| subject.name() == name).expect("a tool of the library")
}

#[test]
fn a_seed_gives_the_same_results() {
    let results = || {
        let tools = run(1, |subject, rng, checks| {
            if subject.name() == "Fig73Exact" {
                border_points::points_on_borders(subject, rng, checks);
            }
        });
        format!("{tools:?}")
    };
    assert_eq!(results(), results());
}

/// A tool compared with the true values of another must fail.
#[test]
fn the_truth_of_another_tool_exceeds_limits() {
    let (ball, other) = (subject("D2Ball"), subject("Fig73Exact"));
    let points: Vec<[f64; 3]> =
        (0..200).map(|k| [0.4 * f64::from(k % 5), 0.0, 0.1 * f64::from(k)]).collect();
    let mut checks = Checks::new("D2Ball");
    Validator::new(ball.tool, &*other.truth).validate(&points, &mut checks);
    for quantity in [validator::DEPTH, validator::WRONG_SIDE] {
        assert!(checks.is_missed(quantity), "{quantity}");
    }
}
