//! The scenes that figures are quoted on.

use super::compare::{Case, Statistics, tools};
use super::parts;
use touchoff::scenes::ScenePath;

/// Checks the poses of a path cut into `poses`, with every tool. Returns the statistics of the thesis's tool.
fn along(path: ScenePath, count: usize, poses: usize) -> Statistics {
    let part = parts::tube(count);
    let mut fig73 = Statistics::default();
    for (tool, oracle) in tools() {
        let mut case = Case::new(&part, tool, &*oracle);
        // The scenes are those of the thesis's tool; for the others every fifth pose is enough.
        let step = if oracle.name() == "Fig73" { 1 } else { 5 };
        for k in (0..poses).step_by(step) {
            case.check(&path.pose(k, poses), k / step);
        }
        println!("{} {count} {}: {:?}", path.name(), oracle.name(), case.statistics);
        assert_eq!(case.statistics.disputed, 0);
        if step == 1 {
            fig73 = case.statistics;
        }
    }
    fig73
}

#[test]
fn a_thousand_points() {
    for path in ScenePath::ALL {
        along(path, 1_000, 600);
    }
}

#[test]
fn five_thousand_points() {
    for path in ScenePath::ALL {
        along(path, 5_000, 240);
    }
}

#[test]
fn twenty_thousand_points() {
    for path in ScenePath::ALL {
        let seen = along(path, 20_000, 120);
        assert!(seen.contacts > 5 * seen.poses, "{path:?} hardly touches: {seen:?}");
    }
}
