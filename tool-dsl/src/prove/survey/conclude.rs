//! The certificate: the conclusions from all boxes.

use super::{OpenProof, RegionFacts, Survey, TOLERANCE, unless_rounding, up};
use crate::diagnostic::Statement;
use crate::expr::interval::{Cell, Interval};
use crate::prove::Certificate;
use crate::prove::jordan::Profile;
use crate::prove::range::Ranges;
use crate::prove::witness::BESIDE;

impl Survey<'_> {
    /// Returns the certificate that follows from all boxes.
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
                    direction_error: aim.off,
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

    /// Returns an upper bound of the amount that depth may gain by jumps along a straight path, and by
    /// differing from an exact distance.
    ///
    /// Let all depths differ by less than `off` from distances to lines, circles or points. On a path of
    /// length `t`, each of these distances minus `t` does not grow, inside or outside its own region. When
    /// the path returns to a region, it has therefore not gained since it left. Only the jumps that remain
    /// after such loops are removed count: one per pair of regions. Other depths may be steep outside their
    /// regions, so every jump counts. A straight path crosses a conic twice.
    fn crossed(&self) -> f64 {
        let steps = self.steps.values().copied().fold(0.0, up);
        let Some(feet) = &self.feet else { return up(self.jumps, 2.0 * steps) };
        let off = unless_rounding(feet.off, self.size);
        let pairs = (self.widest.len() + self.steps.len()) as f64;
        self.widest.values().copied().fold(up(steps, up(off, 2.0 * pairs * off)), up)
    }

    /// Returns an upper bound of the distance from the solid's surface to its profile, given the slack of
    /// depth.
    fn off_profile(&mut self, slack: f64) -> f64 {
        let Some(section) = &self.tool.model.section else { return 0.0 };
        let (off, ends) = self.witness.off_profile(&section.outline);
        let open = off
            .into_iter()
            .map(|at| OpenProof { cell: Cell::point(at), statement: Statement::EndsOnProfile });
        self.undecided.extend(open);
        // Nothing follows if a proof is open, or if depth is not the distance to the profile.
        if self.feet.is_none() || !self.undecided.is_empty() {
            return 0.0;
        }
        let off = Profile::new(&section.outline).off(slack, BESIDE * self.size).filter(|_| ends);
        off.unwrap_or_else(|| {
            self.undecided.push(OpenProof {
                cell: self.tool.extent.cell(),
                statement: Statement::EndsOnProfile,
            });
            0.0
        })
    }
}
