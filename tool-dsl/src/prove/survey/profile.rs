//! Borders of a profile's regions. That depth is continuous there follows from the partition; boxes only describe where regions
//! meet and how directions and magnitudes differ.

use super::super::Pair;
use super::super::cover::half_diagonal;
use super::super::{SMALL_BOX_FRACTION, TOLERANCE};
use super::{BoxSize, Survey};
use crate::expr::interval::{Cell, ZERO as NOTHING};

/// The curve that stands for all that separate two regions of a profile.
const ANY_CURVE: usize = 0;

impl Survey<'_> {
    /// Returns whether enough is known about the borders between the owners of the current box.
    pub(super) fn describe_borders(
        &mut self,
        cell: Cell,
        owners: &[Option<usize>],
        box_size: BoxSize,
    ) -> bool {
        let pairs = pairs(owners);
        // Smaller boxes tell apart borders that meet.
        let is_vague = pairs.len() > 1
            || pairs.iter().any(|pair| self.turns_vaguely_on_surface(*pair))
            || self.may_jump(pairs[0]) && half_diagonal(&cell) > SMALL_BOX_FRACTION * self.size;
        if is_vague && !box_size.is_last() {
            return false;
        }
        // Without boxes left, all that may be neighbours are.
        if pairs.len() == 1 || box_size == BoxSize::Last {
            self.neighbours.extend(&pairs);
        }
        for pair in pairs {
            let key = (pair, ANY_CURVE);
            let jump = if self.deviation.is_some() { NOTHING } else { self.jump(pair) };
            if self.may_jump(pair) && !self.jump_points.contains_key(&key) {
                let jump_point = self.witness.find_jump(pair, cell);
                self.jump_points.extend(jump_point.map(|jump_point| (key, jump_point)));
            }
            self.add_border(key, jump, self.jump_points.get(&key).copied());
        }
        true
    }

    /// Returns whether depths that are not proved differ in the current box.
    fn may_jump(&mut self, pair: Pair) -> bool {
        self.deviation.is_none() && self.jump(pair).low > TOLERANCE / 2.0 * self.size
    }
}

/// Returns the pairs of a box's owners, of which there are at least two, in ascending order.
fn pairs(owners: &[Option<usize>]) -> Vec<Pair> {
    let mut pairs = Vec::new();
    for (k, first) in owners.iter().enumerate() {
        for second in &owners[k + 1..] {
            pairs.extend(match (*first, *second) {
                (Some(own), other) => Some(Pair { own, other }),
                (None, own) => own.map(|own| Pair { own, other: None }),
            });
        }
    }
    pairs
}
