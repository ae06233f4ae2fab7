//! What was measured, a row of a table each. Times are of one query, ns, if they do not say else.

use crate::clock::Times;
use crate::passes::Block;
use serde::Serialize;

#[derive(Serialize)]
#[serde(tag = "table", rename_all = "lowercase")]
pub(crate) enum Row {
    Query(Query),
    Contact(Contact),
    Fit(Line),
    Apart(Apart),
    Build(Built),
}

/// What a question costs, timed in both ways.
#[derive(Serialize)]
pub(crate) struct Timing {
    /// `wrench` or `detect`.
    pub(crate) asked: &'static str,
    /// By `peers`' clock: CPU time on average, and percentiles of single queries.
    pub(crate) poses: usize,
    pub(crate) cpu_avg: f64,
    pub(crate) ns_p50: Option<u64>,
    pub(crate) ns_p99: Option<u64>,
    /// By passes.
    #[serde(flatten)]
    pub(crate) passed: Passed,
}

/// What passes over the same poses say.
#[derive(Serialize)]
pub(crate) struct Passed {
    pub(crate) passed: usize,
    pub(crate) colliding_avg: f64,
    /// The fastest pass of each block, summed: the machine undisturbed.
    pub(crate) ns_best: f64,
    /// The pass in the middle, with what disturbed it.
    pub(crate) ns_median: f64,
}

/// A question along a path.
#[derive(Serialize)]
pub(crate) struct Query {
    pub(crate) points: usize,
    pub(crate) scene: &'static str,
    /// The best time by how many points collide; `null` where none does.
    pub(crate) ns_a_point: Option<f64>,
    #[serde(flatten)]
    pub(crate) timing: Timing,
}

/// Wrenches at which about as many points collide.
#[derive(Serialize)]
pub(crate) struct Contact {
    pub(crate) points: usize,
    /// `wall`, where the ball is pushed in, or a path, from which alike blocks are taken.
    pub(crate) scene: &'static str,
    /// How deep the ball is in the wall, mm.
    pub(crate) depth: Option<f64>,
    #[serde(flatten)]
    pub(crate) passed: Passed,
}

/// The best times of a scene's contacts as a straight line.
#[derive(Serialize)]
pub(crate) struct Line {
    pub(crate) points: usize,
    pub(crate) scene: &'static str,
    /// Of a query at which nothing collides.
    pub(crate) ns_at_zero: f64,
    /// Of one more point that collides.
    pub(crate) ns_a_point: f64,
}

/// A question at a distance.
#[derive(Serialize)]
pub(crate) struct Apart {
    pub(crate) points: usize,
    /// From the ball to the wall, mm.
    pub(crate) gap: f64,
    #[serde(flatten)]
    pub(crate) timing: Timing,
}

/// What it takes to make a part of so many points, and to keep it.
#[derive(Serialize)]
pub(crate) struct Built {
    pub(crate) points: usize,
    pub(crate) builds: usize,
    pub(crate) cloud_ms_best: f64,
    pub(crate) cloud_ms_median: f64,
    pub(crate) tree_ms_best: f64,
    pub(crate) tree_ms_median: f64,
    /// Bytes a point: of the cloud, of the part made of it, and what of that the descent reads.
    pub(crate) cloud_bytes: f64,
    pub(crate) part_bytes: f64,
    pub(crate) geometry_bytes: f64,
}

impl Timing {
    pub(crate) fn new(asked: &'static str, times: &Times, blocks: &[Block]) -> Timing {
        Timing {
            asked,
            poses: times.poses(),
            cpu_avg: times.cpu(),
            ns_p50: times.percentile(0.5),
            ns_p99: times.percentile(0.99),
            passed: Passed::of(blocks),
        }
    }
}
