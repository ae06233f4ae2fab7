//! The certificate: what all boxes together prove.

use super::{RegionFacts, Survey, TOLERANCE, Undecided, unless_rounding, up};
use crate::diagnostic::Statement;
use crate::expr::interval::{Cell, Interval};
use crate::prove::Certificate;
use crate::prove::jordan::Profile;
use crate::prove::range::Ranges;
use crate::prove::witness::BESIDE;

impl Survey<'_> {
    /// Returns what all boxes together prove.
    pub(super) fn certificate(mut self) -> Certificate {
        let shares = self.witness.shares();
        let (least, short) = self.least();
        let slack = [self.crossed(), 2.0 * self.beyond, up(0.0, least.max(0.0) * short)];
        let slack = slack.into_iter().fold(0.0, up);
        let slack = up(slack, self.off_profile(slack));
        let mut ranges = Ranges {
            cover: &mut self.cover,
            slopes: &mut self.slopes,
            whole: self.tool.extent.cell(),
        };
        if self.alone {
            let known = self.regions.iter_mut().zip(&self.tool.model.regions).enumerate();
            for (index, (facts, region)) in known {
                if let Some(facts) = facts {
                    facts.niceness = ranges.niceness(index, region, facts.niceness);
                }
            }
        }
        let known = self.aims.into_iter().zip(self.certain);
        let facts = self.regions.into_iter().zip(shares).zip(known).enumerate();
        let regions: Vec<RegionFacts> = facts
            .map(|(index, ((facts, share), (aim, certain)))| {
                let facts = facts.unwrap_or(RegionFacts::NONE);
                let distance = self.parting.is_distance(index);
                RegionFacts {
                    share,
                    distance,
                    steepness: if distance { Interval::new(1.0, 1.0) } else { facts.steepness },
                    aside: aim.off,
                    oblique: certain.oblique,
                    rises: certain.rises,
                    singular: aim.singular,
                    on_axis: aim.on_axis,
                    ..facts
                }
            })
            .collect();
        Certificate {
            least,
            slack,
            regions,
            borders: self.borders.into_values().collect(),
            undecided: self.undecided,
            tolerance: TOLERANCE * self.size,
            boxes: self.boxes,
        }
    }

    /// Returns how much depth may gain by jumps on a straight way, and by being no exact distance.
    ///
    /// Let all depths be distances from lines, circles or points, less than `off` apart from these. On a way of length `t` each of
    /// these distances less `t` does not grow, wherever its own region is. So when the way comes back to a region it has not
    /// gained since it left it, and only the jumps between regions count that remain when such loops are cut out: each pair once.
    /// Other depths may be steep outside of their regions, so that each jump counts; a straight way crosses a conic twice.
    fn crossed(&self) -> f64 {
        let steps = self.steps.values().copied().fold(0.0, up);
        let Some(feet) = &self.feet else { return up(self.jumps, 2.0 * steps) };
        let off = unless_rounding(feet.off, self.size);
        let pairs = (self.widest.len() + self.steps.len()) as f64;
        self.widest.values().copied().fold(up(steps, up(off, 2.0 * pairs * off)), up)
    }

    /// Returns how far the solid's surface may be from the nearest place of its profile, given the slack of depth.
    fn off_profile(&mut self, slack: f64) -> f64 {
        let Some(section) = &self.tool.model.section else { return 0.0 };
        let (off, ends) = self.witness.off_profile(&section.outline);
        let open = off
            .into_iter()
            .map(|at| Undecided { cell: Cell::point(at), statement: Statement::EndsOnProfile });
        self.undecided.extend(open);
        // Where something is open, or depth is not the distance from the profile, nothing follows.
        if self.feet.is_none() || !self.undecided.is_empty() {
            return 0.0;
        }
        let off = Profile::new(&section.outline).off(slack, BESIDE * self.size).filter(|_| ends);
        off.unwrap_or_else(|| {
            self.undecided.push(Undecided {
                cell: self.tool.extent.cell(),
                statement: Statement::EndsOnProfile,
            });
            0.0
        })
    }
}
