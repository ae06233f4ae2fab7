//! Both questions at a distance.

use crate::Options;
use crate::query::both;
use crate::row::Apart;
use touchoff::{Part, Pose, scenes};

/// From the ball to the wall, mm.
const GAPS: [f64; 5] = [0.01, 0.1, 1.0, 10.0, 100.0];

pub(crate) fn apart(part: &Part, options: &Options) -> Vec<Apart> {
    let count = options.poses.get();
    GAPS.into_iter()
        .flat_map(|gap| {
            let poses: Vec<Pose> = (0..count).map(|k| scenes::apart(gap, k, count)).collect();
            let timings = both(part, &poses, options.seconds);
            timings.map(|timing| Apart { points: part.tree().len(), gap, timing })
        })
        .collect()
}
