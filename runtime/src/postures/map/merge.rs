//! Which posture is better.

use crate::postures::Record;
use std::cmp::Ordering;
use std::num::NonZeroU16;

/// The better first: the nicer, of those that are as nice but for rounding the one that clears the part by
/// more, then the one that is less deep. What is left decides only so that the order in which postures come
/// does not.
fn order(one: &Record, other: &Record) -> Ordering {
    let rest = |record: &Record| {
        let ([x, y, z], [i, j, k]) = (record.tip, record.axis);
        [record.depth, f64::from(record.tool), x, y, z, i, j, k, record.niceness]
    };
    let nicer = (other.niceness as f32).total_cmp(&(one.niceness as f32));
    let clearer = other.clearance.total_cmp(&one.clearance);
    let pairs = rest(one).into_iter().zip(rest(other));
    let rest = pairs.map(|(a, b)| a.total_cmp(&b)).fold(Ordering::Equal, Ordering::then);
    nicer.then(clearer).then(rest)
}

/// Takes more postures in; so many stay, each once, the best first.
pub(in crate::postures) fn merge(best: &mut Vec<Record>, more: &[Record], keep: NonZeroU16) {
    best.extend(more);
    best.sort_by(order);
    best.dedup_by(|one, other| order(one, other).is_eq());
    best.truncate(keep.get().into());
}
