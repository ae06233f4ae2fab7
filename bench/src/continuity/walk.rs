//! A path of the scenes, cut into steps of a given length.

use touchoff::Pose;
use touchoff::scenes::Path;

/// Parts of a path, so many that any fraction of it is one of them.
const PARTS: usize = 1 << 50;
/// Length of the tool of fig. 7.3, mm.
const LENGTH: f64 = 20.0;

/// A way along a path in steps of which none moves a point of the tool's axis farther than it says.
#[derive(Clone, Copy, Debug)]
pub struct Walk {
    path: Path,
    length: f64,
    at: f64,
    end: f64,
    part: f64,
}

/// The pose at a fraction of a path, from 0 to less than 1.
pub(super) fn pose(path: Path, at: f64) -> Pose {
    path.pose((at * PARTS as f64) as usize, PARTS)
}

/// How far the farthest point of the axis goes between two poses.
pub(super) fn moved(a: &Pose, b: &Pose) -> f64 {
    let top = |pose: &Pose| pose.tip() + LENGTH * pose.axis();
    (b.tip() - a.tip()).norm().max((top(b) - top(a)).norm())
}

impl Walk {
    /// From a fraction of a path in so many steps of at most a length, mm.
    pub fn new(path: Path, from: f64, to: f64, length: f64) -> Walk {
        Walk { path, length, at: from.max(0.0), end: to.min(1.0), part: 1e-9 }
    }

    /// From so far before a fraction of a path to so far behind it, mm.
    pub fn around(path: Path, at: f64, reach: f64, length: f64) -> Walk {
        let part = reach / speed(path, at);
        Walk::new(path, at - part, at + part, length)
    }
}

/// How far the tool goes in all of a path, if it went on as it does at a fraction of it, mm.
fn speed(path: Path, at: f64) -> f64 {
    const SMALL: f64 = 1e-9;
    let at = at.min(1.0 - 2.0 * SMALL);
    moved(&pose(path, at), &pose(path, at + SMALL)) / SMALL
}

impl Iterator for Walk {
    /// A fraction of the path, and the pose there.
    type Item = (f64, Pose);

    fn next(&mut self) -> Option<(f64, Pose)> {
        if self.at >= self.end {
            return None;
        }
        let here = (self.at, pose(self.path, self.at));
        self.part = 0.99 * self.length / speed(self.path, self.at).max(1.0);
        self.at += self.part;
        Some(here)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_step_is_longer() {
        for path in Path::ALL {
            let poses: Vec<Pose> = Walk::new(path, 0.1, 0.1 + 1e-4, 1e-3).map(|p| p.1).collect();
            let steps = poses.windows(2).map(|pair| moved(&pair[0], &pair[1]));
            let [least, most] = steps.fold([1.0, 0.0], |[a, b]: [f64; 2], s| [a.min(s), b.max(s)]);
            assert!(most <= 1e-3 && least > 0.9e-3, "{}: {least} {most}", path.name());
        }
    }
}
