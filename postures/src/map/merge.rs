//! Ranking of postures.

use crate::PostureRecord;
use std::cmp::Ordering;
use std::num::NonZeroU16;

/// Orders the better posture first: the nicer one; of two that are equal but for rounding to `f32`, the one
/// with more clearance; then the less deep. The remaining fields make the result independent of the order of
/// arrival.
fn order(one: &PostureRecord, other: &PostureRecord) -> Ordering {
    let rest = |record: &PostureRecord| {
        let ([x, y, z], [i, j, k]) = (record.tip, record.axis);
        [record.depth, f64::from(record.tool), x, y, z, i, j, k, record.niceness]
    };
    let nicer = (other.niceness as f32).total_cmp(&(one.niceness as f32));
    let clearer = other.clearance.total_cmp(&one.clearance);
    let pairs = rest(one).into_iter().zip(rest(other));
    let rest = pairs.map(|(a, b)| a.total_cmp(&b)).fold(Ordering::Equal, Ordering::then);
    nicer.then(clearer).then(rest)
}

/// Adds postures to a list and keeps the best `keep` of them, each once, the best first.
pub(crate) fn merge(best: &mut Vec<PostureRecord>, more: &[PostureRecord], keep: NonZeroU16) {
    best.extend(more);
    best.sort_by(order);
    best.dedup_by(|one, other| order(one, other).is_eq());
    best.truncate(keep.get().into());
}
