//! What every bounding volume has in common, and the one test against the tool that all are put to.
//!
//! A volume says from where to where it reaches along the tool's axis, and no more than how far it
//! is from that axis; the tool's largest radius over that stretch decides. So volumes differ by how
//! closely they say it and by what that costs, not by the test.

use crate::contender::View;
use crate::formula::{RADIUS, TIP};
use crate::split::Item;

/// A kind of volume, of which one is written in `F` numbers.
pub(crate) trait Volume<const F: usize> {
    /// What a query works out once.
    type Seen;

    /// The volume about some points.
    fn about(items: &[Item]) -> [f32; F];

    fn seen(frame: &Frame) -> Self::Seen;

    /// Whether the tool may reach one of `W` volumes side by side; not if it is NaN.
    fn may_touch<const W: usize>(seen: &Self::Seen, volumes: &[[f32; W]; F], lane: usize) -> bool;
}

/// The map to the tool's frame, in `f32`.
#[derive(Clone, Copy)]
pub(crate) struct Frame {
    pub(crate) rows: [[f32; 3]; 3],
    /// What volumes are written relative to: the middle of the part.
    pub(crate) origin: [f32; 3],
}

impl Frame {
    pub(crate) fn of(view: &View, middle: [f64; 3]) -> Frame {
        Frame { rows: view.single(), origin: view.turn(view.arm(middle)).map(|c| c as f32) }
    }
}

/// More than what single precision loses on coordinates below 50: volumes are so much larger.
pub(crate) const MARGIN: f32 = 5e-5;

/// Where a volume lies in the tool's half plane.
pub(crate) struct Place {
    /// From where to where along the axis, from the tip.
    pub(crate) low: f32,
    pub(crate) high: f32,
    /// Square of a distance that it keeps from the axis.
    pub(crate) beside: f32,
}

impl Place {
    /// A box of the tool's frame, by its centre and half extents.
    #[inline(always)]
    pub(crate) fn of_box(centre: [f32; 3], half: [f32; 3]) -> Place {
        let x = most(centre[0].abs() - half[0] - MARGIN, 0.0);
        let y = most(centre[1].abs() - half[1] - MARGIN, 0.0);
        let reach = half[2] + MARGIN;
        Place { low: centre[2] - reach, high: centre[2] + reach, beside: x * x + y * y }
    }

    /// Whether the tool may reach there; not if anything is NaN. The tool is nowhere thinner than
    /// nearer to its tip, so the upper end has the largest radius: that of the ball, then 1, a taper
    /// from 1 to 3, 3, and the housing's.
    #[inline(always)]
    pub(crate) fn may_touch(&self) -> bool {
        let ball = least(self.high, 1.0);
        let taper = most(least(self.high - 4.0, 3.0), 1.0);
        let neck = ball * (2.0 - ball) * (taper * taper);
        let squared = if self.high < 9.0 { neck } else { (RADIUS * RADIUS) as f32 };
        (self.low <= TIP as f32) & (self.beside <= squared)
    }
}

// `f32::min` and `max` have to mind NaN, which takes longer.

#[inline(always)]
pub(crate) fn least(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

#[inline(always)]
pub(crate) fn most(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

#[inline(always)]
pub(crate) fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}
