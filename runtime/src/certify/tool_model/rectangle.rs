//! Rectangles of the half plane.

use crate::certify::space::MeridianPoint;
use touchoff_plane::minus;

/// A rectangle of the half plane.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Rectangle {
    pub(crate) low: MeridianPoint,
    pub(crate) high: MeridianPoint,
}

impl Rectangle {
    pub(crate) fn corners(&self) -> [MeridianPoint; 4] {
        let Rectangle { low, high } = *self;
        [low, [high[0], low[1]], high, [low[0], high[1]]]
    }

    /// Returns whether it has points in common with another.
    pub(crate) fn meets(&self, other: &Rectangle) -> bool {
        (0..2).all(|k| self.low[k] <= other.high[k] && other.low[k] <= self.high[k])
    }

    /// Returns whether another lies within it.
    pub(crate) fn contains(&self, other: &Rectangle) -> bool {
        (0..2).all(|k| self.low[k] <= other.low[k] && other.high[k] <= self.high[k])
    }

    fn size(&self) -> MeridianPoint {
        minus(self.high, self.low)
    }

    /// Returns its centre, and the distance from there to its corners.
    pub(crate) fn ball(&self) -> (MeridianPoint, f64) {
        let [across, up] = self.size();
        ([0, 1].map(|k| f64::midpoint(self.low[k], self.high[k])), 0.5 * across.hypot(up))
    }

    /// Returns both halves of its longer side.
    pub(crate) fn halves(&self) -> [Rectangle; 2] {
        let ([across, up], (middle, _)) = (self.size(), self.ball());
        let longer = usize::from(up > across);
        let (mut first, mut second) = (*self, *self);
        first.high[longer] = middle[longer];
        second.low[longer] = middle[longer];
        [first, second]
    }

    /// Returns it without strips of some height along those of its level sides that a slab from `low` to `high` has too, and the
    /// strips.
    pub(crate) fn without_seams(
        &self,
        [low, high]: [f64; 2],
        height: f64,
    ) -> (Rectangle, Vec<Rectangle>) {
        let (mut inner, mut strips) = (*self, Vec::new());
        if self.low[1] == low {
            inner.low[1] += height;
            strips.push(Rectangle { high: [self.high[0], inner.low[1]], ..*self });
        }
        if self.high[1] == high {
            inner.high[1] -= height;
            strips.push(Rectangle { low: [self.low[0], inner.high[1]], ..*self });
        }
        (inner, strips)
    }

    /// Returns the least rectangle that contains it and another.
    pub(crate) fn widened(&self, other: &Rectangle) -> Rectangle {
        Rectangle {
            low: [0, 1].map(|k| self.low[k].min(other.low[k])),
            high: [0, 1].map(|k| self.high[k].max(other.high[k])),
        }
    }
}
