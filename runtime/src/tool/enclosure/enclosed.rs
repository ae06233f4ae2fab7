//! What a tool feels in a box.

use super::Enclosure;
#[cfg(feature = "interpreter")]
use super::bit;
use super::choice::{Choice, Choices, Maybe};
use crate::tool::compiled::FeltLanes;
use crate::tool::{Ask, Evaluators};

/// What a tool feels in a box of its frame.
#[derive(Clone, Copy, Debug)]
pub struct Enclosed {
    /// Whether places of the box may be inside.
    pub inside: bool,
    /// Whether places of the box may be outside.
    pub outside: bool,
    /// What depth is where it is inside.
    pub(super) depth: Enclosure,
    /// The regions that places of the box may belong to, a bit each; the 64th stands for all larger ones too.
    pub regions: u64,
}

impl Enclosed {
    /// Of a compiled tool; a box of one with an axis lies in the half plane `y = 0`, `x ≥ 0`. Slopes are told from
    /// a point of the box.
    pub fn of<T: Evaluators>(sides: [[f64; 2]; 3], at: [f64; 3]) -> Enclosed {
        let present = Maybe { yes: true, no: false, gaps: [None; 2] };
        let ask = Ask { depth: true, region: true, ..Ask::INSIDE };
        let one = Enclosure::constant(1.0);
        let FeltLanes { inside, depth, region, .. } =
            T::feel_lanes(Enclosure::of_box(sides, at), one, present, ask);
        Enclosed { inside: inside.yes, outside: inside.no, depth, regions: region.regions }
    }

    /// No less than the depth of any place of the box.
    pub fn most(&self) -> f64 {
        self.depth.value.high
    }

    /// No less than the depth of any place of the convex hull of some, given how far each is from the point along x,
    /// y and z: between two ends each. Infinite or NaN where a slope is not known.
    ///
    /// The point has to be in the box and in the hull. Where the argument of a root may be below 0 its slope has no
    /// end, and then the bound of some corner has none. By the mean value theorem a region's formula at a place is that at the point and slopes times the way. A choice `f` where `g ≤ 0` is no more than `f - λ g` there, for any `λ ≥ 0` (Lagrange); the least
    /// of the most of that at the corners is at 0 or where two corners are as much.
    pub fn most_between(&self, ways: [[[f64; 2]; 3]; 3]) -> f64 {
        let Choices::Two(two) = self.depth.choices else {
            let most = ways.map(|way| self.depth.course.values(way).high);
            return most[0].max(most[1]).max(most[2]);
        };
        let bounds = two.map(|Choice { value, gap }| {
            let ends = ways.map(|way| (value.values(way).high, gap.values(way).low));
            // Not 0 times what may be infinite.
            let most = |scale: f64| {
                let less = |gap: f64| if scale > 0.0 { (scale * gap).next_down() } else { 0.0 };
                let at = ends.map(|(value, gap)| (value - less(gap)).next_up());
                at[0].max(at[1]).max(at[2])
            };
            let mut least = most(0.0);
            for (first, second) in [(0, 1), (1, 2), (2, 0)] {
                let scale = (ends[first].0 - ends[second].0) / (ends[first].1 - ends[second].1);
                if scale > 0.0 && scale.is_finite() {
                    least = least.min(most(scale));
                }
            }
            least
        });
        bounds[0].max(bounds[1])
    }
}

#[cfg(feature = "interpreter")]
impl Enclosed {
    /// Where no place was looked at yet.
    pub(in crate::tool) fn nothing() -> Enclosed {
        Enclosed { inside: false, outside: false, depth: Enclosure::NOTHING, regions: 0 }
    }

    /// Takes places of a region with their depth, or places outside: those where a test that was not decided is
    /// below 0, or above.
    pub(in crate::tool) fn take(
        &mut self,
        owner: Option<(usize, Enclosure)>,
        test: Option<(Enclosure, bool)>,
    ) {
        let Some((region, depth)) = owner else {
            self.outside = true;
            return;
        };
        let gap =
            test.map(|(value, below)| if below { value.course } else { value.course.negated() });
        let choices = self.depth.choices.and(depth.choices(gap));
        self.inside = true;
        self.regions |= bit(region);
        self.depth = Enclosure { choices, ..self.depth.hull(depth) };
    }
}
