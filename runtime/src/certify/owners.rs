//! Which of a tool's features are asked about: those that own a place are the nearest to it.

use super::feature::Place;
use super::section::{Section, Slab};

/// Features, by their places in the section's list.
#[derive(Clone, Debug, Default)]
pub(super) struct Owners {
    /// `None` for all of them.
    some: Option<Vec<bool>>,
    /// How much farther than the nearest feature an owner may be.
    pub(super) slack: f64,
}

impl Owners {
    /// The features of some surfaces.
    pub(super) fn of(section: &Section, surfaces: impl Fn(usize) -> bool) -> Owners {
        let some: Vec<bool> = section.features.iter().map(|f| surfaces(f.surface)).collect();
        let some = some.contains(&false).then_some(some);
        Owners { some, slack: 0.0 }
    }

    /// Whether these are all features.
    #[inline]
    pub(super) fn all(&self) -> bool {
        self.some.is_none()
    }

    /// Whether a feature is one of them.
    #[inline]
    pub(super) fn own(&self, feature: usize) -> bool {
        self.some.as_ref().is_none_or(|some| some[feature])
    }

    /// Of each slab, between which heights these can own a place that is deeper than that.
    pub(super) fn zones(&self, section: &Section, deeper: f64) -> Vec<Option<[f64; 2]>> {
        let whole = |slab: &Slab| Some([slab.low, slab.high]);
        let zone = |slab| if self.all() { whole(slab) } else { self.zone(section, slab, deeper) };
        section.slabs.iter().map(zone).collect()
    }

    /// By rectangles of the slab, halved until an owner is the nearest in all of one, or in none, or it is
    /// too small to matter.
    fn zone(&self, section: &Section, slab: &Slab, deeper: f64) -> Option<[f64; 2]> {
        let small = section.size / f64::from(FINE);
        let mut zone: Option<[f64; 2]> = None;
        let mut stack = vec![([0.0, slab.low], [slab.radius, slab.high])];
        while let Some((low, high)) = stack.pop() {
            if zone.is_some_and(|[from, to]| from <= low[1] && high[1] <= to) {
                continue;
            }
            let middle: Place = [0, 1].map(|k| f64::midpoint(low[k], high[k]));
            let wide = [0, 1].map(|k| high[k] - low[k]);
            let reach = 0.5 * wide[0].hypot(wide[1]);
            let (mut owner, mut other) = (f64::INFINITY, f64::INFINITY);
            for (index, feature) in section.features.iter().enumerate() {
                let least = if self.own(index) { &mut owner } else { &mut other };
                *least = least.min(feature.away(middle));
            }
            // A distance changes by no more than the way.
            let apart = self.slack + 2.0 * reach + section.error;
            if owner > other + apart || owner.min(other) + reach <= deeper {
                continue;
            }
            let surely = owner + apart < other && owner - reach > deeper;
            if surely || reach <= small {
                let [from, to] = zone.unwrap_or([low[1], high[1]]);
                zone = Some([from.min(low[1]), to.max(high[1])]);
                continue;
            }
            let longer = usize::from(wide[1] > wide[0]);
            let (mut first, mut second) = ((low, high), (low, high));
            first.1[longer] = middle[longer];
            second.0[longer] = middle[longer];
            stack.extend([first, second]);
        }
        zone
    }
}

/// Zones are found to this part of the tool's size.
const FINE: u32 = 1 << 11;
