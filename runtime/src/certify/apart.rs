//! How far a tool is from a part.

use super::Certifier;
use super::answer::Clearance;
use super::body::Body;
use super::question::Question;
use super::rounding;
use super::triangle::course::Goal;
use super::work::{Setting, Work};
use crate::pose::Pose;

/// What is asked of some surfaces: what is in them, and how far the others are.
pub(super) struct Apart {
    surfaces: Vec<usize>,
    inside: Question,
    outside: Question,
}

impl Certifier<'_> {
    /// How far the part's triangles are from the tool: an interval no wider than the tolerance, in the
    /// part's unit, and what rounding adds; 0 where they touch. A tool wholly inside the material is as
    /// far from its surface.
    pub fn clearance(&mut self, pose: &Pose, tolerance: f64) -> Clearance {
        let Certifier { setting, whole, work, budget, .. } = self;
        distance(setting, [whole, whole], work, pose, (tolerance, *budget))
    }

    /// How far the part's triangles are from some surfaces of the tool, by their places in the card's list:
    /// the same, of these alone; 0 where a point inside the tool is nearest to one of them. What the others
    /// cut is as far as the nearest of these surfaces. From none it is infinitely far. Where it is not known
    /// which surface is the nearest (see [`Certifier::allow`]), it is no less than from the whole tool, and
    /// how much is not known.
    ///
    /// # Panics
    /// If there is no such surface.
    pub fn clearance_of(&mut self, surfaces: &[usize], pose: &Pose, tolerance: f64) -> Clearance {
        assert!(surfaces.iter().all(|surface| *surface < self.card.surfaces.len()));
        if surfaces.is_empty() {
            return Clearance { distance: [f64::INFINITY; 2], witness: None };
        }
        let Body::Profile(section) = &self.setting.body else {
            let [low, _] = self.clearance(pose, tolerance).distance;
            return Clearance { distance: [low, f64::INFINITY], witness: None };
        };
        if self.apart.as_ref().is_none_or(|apart| apart.surfaces != surfaces) {
            let margin = self.setting.setup.margin;
            let of = |limit| Question::new(section, margin, limit, |k| surfaces.contains(&k));
            // A limit below 0 asks for the surfaces themselves, whatever it is.
            let (inside, outside) = (of(0.0), of(-1.0));
            self.apart = Some(Apart { surfaces: surfaces.to_vec(), inside, outside });
        }
        let Certifier { setting, apart, work, budget, .. } = self;
        let Apart { inside, outside, .. } = apart.as_ref().expect("it was just made");
        distance(setting, [inside, outside], work, pose, (tolerance, *budget))
    }
}

/// The distance to the nearest place, or 0 if one is inside.
fn distance(
    setting: &Setting<'_>,
    [inside, outside]: [&Question; 2],
    work: &mut Work,
    pose: &Pose,
    (tolerance, budget): (f64, u32),
) -> Clearance {
    let touch = 2.0 * setting.error;
    let goal = Goal { least: -touch, tolerance: touch, enough: touch, budget };
    work.inside(setting, inside, pose, goal);
    if let Some(best) = &work.best {
        let witness = setting.witness(best, pose);
        let high = if work.search.best > touch { 0.0 } else { 2.0 * touch + work.skew };
        let distance = [0.0, high * setting.length];
        return Clearance { distance, witness: Some(witness) };
    }
    let unsure = work.search.open();
    // Rounding grows with the distance.
    let error = setting.error + rounding::far(work.far());
    // Written so that what is not a number is no tolerance.
    let tolerance = (4.0 * error).max(tolerance / setting.length);
    let [least, enough] = [f64::NEG_INFINITY, f64::INFINITY];
    work.outside(setting, outside, pose, Goal { least, tolerance, enough, budget });
    let more = error + work.skew;
    let low = -work.search.wanted().max(work.search.most) - more;
    let low = if unsure { 0.0 } else { low.max(0.0) };
    // What a field says of places outside is no more than the distance.
    let high = if setting.exact { -work.search.best + more } else { f64::INFINITY };
    Clearance {
        distance: [low, high].map(|distance| distance * setting.length),
        witness: work.best.as_ref().map(|best| setting.witness(best, pose)),
    }
}
