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
fn paths_along_the_tube_agree_with_the_oracle() {
    for (points, poses) in [(1_000, 600), (5_000, 240), (20_000, 120)] {
        for path in ScenePath::ALL {
            let seen = along(path, points, poses);
            let is_busy = points < 20_000 || seen.contacts > 5 * poses;
            assert!(is_busy, "{path:?} hardly touches: {seen:?}");
        }
    }
}
