//! The questions about motions: whether a tool stays clear, and how deep a surface is at most, proved.
//!
//! A sweep finds some place that is too deep, or proves that there is none. So the greatest depth is bounded by
//! asking it again and again what is deeper than the deepest that is known; that is found by climbing, in
//! time, from a few times of the motion and from where sweeps point. A sweep goes by time, and takes long
//! about places that are just as deep as it asks: so it is asked last, and not more closely than it pays.

use super::answer::{Along, Sweep, Witness};
use super::body::Body;
use super::containment::{Containment, Cores};
use super::question::Question;
use super::rounding;
use super::sweep::{Stop, Sweeper, Task};
use super::triangle::course::Goal;
use super::work::{MARGIN, Setting, Work};
use super::{Certifier, Touch, penetration};
use crate::motion::Motion;
use crate::tool::{Card, Shape};
use std::slice;

/// Returns the error bound of a point of the tool on a motion, in the tool's unit: `rounding` derives it.
pub(super) fn error(setting: &Setting<'_>, motion: &Motion) -> f64 {
    let turned = if motion.is_full() { setting.error } else { 0.5 * setting.error };
    setting.error + turned + rounding::far(motion.way().norm() / setting.length)
}

/// Returns whether a motion says where a tool is: that of a solid has to say the spin too.
pub(super) fn places(card: &Card, motion: &Motion) -> bool {
    card.shape == Shape::Revolved || motion.is_full()
}

/// How often a sweep is asked for something deeper than what is known.
const ROUNDS: u32 = 16;

/// At so many times of a motion, and at its beginning, it is asked before it is swept.
pub(super) const TIMES: u32 = 8;

/// The greatest depth of a motion is bounded to this part of what is too much.
const CLOSE: f64 = 0.125;

/// And with this part of the budget, since it costs no proof of what is clear.
const PART: u32 = 16;

/// A shorter time than this part of a motion is not told apart.
const SHORTEST: f64 = 1e-12;

impl Certifier<'_> {
    /// Whether the tool stays clear of the part all along a motion, or no deeper in it than is
    /// [allowed](Certifier::allow) by more than a tolerance, in the part's unit; one below what rounding
    /// adds is taken as that.
    ///
    /// Undecided are a solid without an axis on a motion without [spin](Motion::with_spin), and tools and parts larger
    /// than some 1e15 of the tool's unit.
    ///
    /// ```
    /// # use nalgebra::{Point3, Vector3};
    /// # use touchoff::certify::{Certifier, Facets, Sweep};
    /// # use touchoff::{Motion, Pose, Unit, mesh::shapes};
    /// touchoff::tool! {
    ///     tool EndMill "12 mm across, 20 mm of it cut" {
    ///         units mm;
    ///         profile {
    ///             start (0, 0);
    ///             line to (6, 0) as face cutting;
    ///             line to (6, 20) as flute cutting;
    ///             line to (6, 60), (0, 60) as shank;
    ///         }
    ///         niceness cutting: 1;
    ///     }
    /// }
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let (low, high) = (Point3::new(0., -30., 0.), Point3::new(40., 30., 25.));
    /// let wall = Facets::new(&shapes::cuboid(low, high, Unit::Millimetre)?);
    /// let pose = |y: f64, z: f64| Pose::from_axis(Point3::new(-4.0, y, z), Vector3::z());
    /// let mut certifier = Certifier::new(&wall, &EndMill)?
    ///     .allow("face", f64::INFINITY)?
    ///     .allow("flute", f64::INFINITY)?;
    /// // The flute cuts 2 mm into the wall, as high as that is; lower, the shank would rub.
    /// let cut = Motion::new(&pose(-20.0, 6.0)?, &pose(20.0, 6.0)?)?;
    /// assert_eq!(certifier.sweep_clear(&cut, 1e-6), Sweep::Clear);
    /// let lower = Motion::new(&pose(-20.0, 6.0)?, &pose(20.0, 4.0)?)?;
    /// assert!(matches!(certifier.sweep_clear(&lower, 1e-6), Sweep::Touching(at, _) if at >= 0.5));
    /// # Ok(()) }
    /// ```
    pub fn sweep_clear(&mut self, motion: &Motion, tolerance: f64) -> Sweep {
        if !places(self.card, motion) || self.setting.margin() > MARGIN {
            return Sweep::Undecided(0.0);
        }
        let Certifier { setting, card, whole, rules, cores, budget, sweeper, .. } = self;
        let rules = rules.as_deref().unwrap_or(slice::from_ref(whole));
        let error = self::error(setting, motion);
        // Written so that what is not a number is no tolerance.
        let tolerance = (16.0 * error).max(tolerance / setting.length);
        let mut first: Option<Stop> = None;
        // A margin that is no more than the tolerance asks for nothing.
        for question in
            rules.iter().filter(|rule| rule.limit >= 0.0 || rule.limit + tolerance < 0.0)
        {
            let limit = question.limit;
            let task = Task { setting, question, motion, limit, error, tolerance };
            let stop = sweeper.run(&task, *budget);
            first = match (first, stop) {
                (Some(first), Some(stop)) if stop.before(&first) => Some(stop),
                (first, stop) => first.or(stop),
            };
        }
        match first {
            Some(Stop::Deeper { at, best }) => {
                Sweep::Touching(at, setting.witness(&best, &motion.pose(at)))
            }
            Some(Stop::Spent { at }) => self.touches_from(motion, at),
            None => match setting.containment((card, cores), &motion.pose(0.0), tolerance) {
                Containment::Inside(surface) => Sweep::Inside(surface),
                Containment::Outside => Sweep::Clear,
                Containment::Unknown => Sweep::SurfaceOnly,
                Containment::Undecided => Sweep::Undecided(0.0),
            },
        }
    }

    /// Looks for contact at some times of a motion after the one at which the budget was spent. Just before contact a sweep
    /// takes the longest, and deep contact is found at once.
    fn touches_from(&mut self, motion: &Motion, from: f64) -> Sweep {
        for step in 1..=TIMES {
            let at = from + (1.0 - from) * f64::from(step) / f64::from(TIMES);
            if let Touch::Yes(witness) = self.touches(&motion.pose(at)) {
                return Sweep::Touching(at, witness);
            }
        }
        Sweep::Undecided(from)
    }

    /// How deep a surface, by its place in the card's list, gets all along a motion where it is the nearest:
    /// whether deeper than it may be by more than a tolerance, where it is deepest as far as was found, and how
    /// deep at most. Both are in the part's unit; a tolerance below what rounding adds is taken as that. Below
    /// 0 what is allowed is a margin: how far the surface has to keep from all of the part.
    ///
    /// Allowances that were [set](Certifier::allow) do not count, and what is not a number allows nothing. Undecided are a solid without an
    /// axis on a motion without [spin](Motion::with_spin), and a margin of a tool without a profile.
    ///
    /// ```
    /// # use nalgebra::{Point3, Vector3};
    /// # use touchoff::certify::{Along, Certifier, Facets};
    /// # use touchoff::{Motion, Pose, Unit, mesh::shapes};
    /// # touchoff::tool! {
    /// #     tool Ball "6 mm" {
    /// #         units mm;
    /// #         profile { start (0, 0); arc to (0, 6) center (0, 3) as ball cutting; }
    /// #         niceness cutting: 1;
    /// #     }
    /// # }
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let (low, high) = (Point3::new(-5., -5., -9.), Point3::new(5., 5., 0.));
    /// let block = Facets::new(&shapes::cuboid(low, high, Unit::Millimetre)?);
    /// let pose = |x: f64| Pose::from_axis(Point3::new(x, 0.0, -0.5), Vector3::z());
    /// // Both ends are clear of the block; between them the ball is 0.5 deep.
    /// let motion = Motion::new(&pose(-20.0)?, &pose(20.0)?)?;
    /// let found = Certifier::new(&block, &Ball)?.deepest_along(0, &motion, 0.0, 1e-6);
    /// let Along::Deeper { depth: [low, high], most, .. } = found else { panic!("{found:?}") };
    /// assert!(low <= 0.5 && 0.5 <= high && high - low < 1.1e-6 && most < 0.57);
    /// # Ok(()) }
    /// ```
    ///
    /// # Panics
    /// If there is no such surface.
    pub fn deepest_along(
        &mut self,
        surface: usize,
        motion: &Motion,
        allowed: f64,
        tolerance: f64,
    ) -> Along {
        let Certifier { setting, card, each, each_cores, work, budget, sweeper, .. } = self;
        if !places(card, motion) {
            return Along::Undecided(0.0);
        }
        let question = |limit| setting.question(limit, |other| other == surface);
        let error = error(setting, motion);
        // Written so that what is not a number is no tolerance.
        let tolerance = (32.0 * error).max(tolerance / setting.length);
        let allowed = if allowed.is_nan() { 0.0 } else { allowed / setting.length };
        let whole = each[surface].get_or_insert_with(|| question(0.0));
        let depth = allowed.max(0.0);
        let cores = match &mut each_cores[surface] {
            Some((known, cores)) if *known == depth => cores,
            other => {
                let all = 0..card.surfaces.len();
                let limits = all.map(|k| if k == surface { depth } else { f64::INFINITY });
                &mut other.insert((depth, Cores::new(limits))).1
            }
        };
        let budget = *budget;
        let mut search = Search {
            setting,
            card,
            cores,
            work,
            sweeper,
            motion,
            question: whole,
            tolerance,
            budget,
        };
        let found = search.deepest(depth);
        if allowed >= 0.0 || matches!(found, Along::Deeper { .. }) {
            return found;
        }
        if let Body::Field(_) = &setting.body {
            return Along::Undecided(0.0);
        }
        let near = question(allowed);
        search.question = &near;
        match search.deepest(allowed) {
            Along::Within => found,
            nearer => nearer,
        }
    }
}

/// What is asked of one surface on one motion; lengths are in the tool's unit.
struct Search<'a, 's> {
    setting: &'a Setting<'s>,
    card: &'a Card,
    /// Points of what the surface owns and may not be in the part.
    cores: &'a mut Cores,
    work: &'a mut Work,
    sweeper: &'a mut Sweeper,
    motion: &'a Motion,
    question: &'a Question,
    tolerance: f64,
    budget: u32,
}

/// How deep it is at a time.
#[derive(Clone, Copy)]
struct Peak {
    depth: [f64; 2],
    at: f64,
    witness: Witness,
}

impl Search<'_, '_> {
    fn deepest(&mut self, allowed: f64) -> Along {
        let times = (0..=TIMES).map(|k| f64::from(k) / f64::from(TIMES));
        let seen = times.filter_map(|at| self.at(at)).collect::<Vec<Peak>>();
        let seen = seen.into_iter().filter(|peak| peak.depth[0] > allowed).reduce(deeper);
        let first = match seen {
            Some(peak) => peak,
            None => match self.sweep(allowed, self.tolerance, self.budget) {
                None => return self.within(),
                Some(Stop::Spent { at }) => return Along::Undecided(at),
                Some(Stop::Deeper { at, best }) => {
                    let witness = self.setting.witness(&best, &self.motion.pose(at));
                    let depth = [allowed, allowed + self.tolerance];
                    let seen = Peak { depth, at, witness };
                    self.at(at).map_or(seen, |here| deeper(seen, here))
                }
            },
        };
        let top = self.climb(first);
        let (best, most) = self.bounded(top, allowed);
        let length = self.setting.length;
        let depth = best.depth.map(|depth| depth * length);
        Along::Deeper { at: best.at, depth, most: most * length, witness: best.witness }
    }

    /// Something deeper if there is, and what nothing is deeper than.
    fn bounded(&mut self, mut best: Peak, allowed: f64) -> (Peak, f64) {
        // No place is farther from the surface than the largest radius.
        let any = if self.question.limit < 0.0 { 0.0 } else { self.card.radius() };
        let mut close = CLOSE;
        for _ in 0..ROUNDS {
            let [low, high] = best.depth;
            let gap = self.tolerance.max(close * (high - allowed));
            // Half of it is for what a sweep does not tell apart, half for what each round gains.
            let limit = (low + 0.5 * gap).max(allowed);
            match self.sweep(limit, 0.5 * gap, self.budget / PART) {
                None => return (best, high.max(any.min(limit + 0.5 * gap))),
                Some(Stop::Spent { .. }) => close *= 4.0,
                Some(Stop::Deeper { at, .. }) => match self.at(at) {
                    Some(here) if here.depth[0] > low => best = self.climb(here),
                    _ => close *= 4.0,
                },
            }
        }
        (best, any.max(best.depth[1]))
    }

    /// What is deeper on the way than a limit, if anything is by more than a tolerance.
    fn sweep(&mut self, limit: f64, tolerance: f64, budget: u32) -> Option<Stop> {
        let Search { setting, question, motion, .. } = *self;
        if self.question.limit < 0.0 && limit + tolerance >= 0.0 {
            return None;
        }
        let error = error(setting, motion);
        let task = Task { setting, question, motion, limit, error, tolerance };
        self.sweeper.run(&task, budget)
    }

    /// Returns what there is to say where no triangle is too deep.
    fn within(&mut self) -> Along {
        let Search { setting, card, motion, tolerance, .. } = *self;
        match setting.containment((card, self.cores), &motion.pose(0.0), tolerance) {
            Containment::Inside(_) => Along::Inside,
            Containment::Outside | Containment::Unknown => Along::Within,
            Containment::Undecided => Along::Undecided(0.0),
        }
    }

    /// The deepest about a time: steps that gain are taken, those that do not are halved until they are too
    /// short for more than the tolerance.
    fn climb(&mut self, from: Peak) -> Peak {
        let Setting { size, length, .. } = *self.setting;
        let pace = self.motion.way().norm() / length + self.motion.angle() * size;
        let mut best = from;
        let mut step = 0.5 / f64::from(TIMES);
        while step * pace > self.fine() && step > SHORTEST {
            let sides = [best.at - step, best.at + step].map(|at| at.clamp(0.0, 1.0));
            let found = sides.map(|at| self.at(at)).into_iter().flatten();
            let found = found.fold(best, deeper);
            if found.depth[0] > best.depth[0] {
                best = found;
            } else {
                step *= 0.5;
            }
        }
        best
    }

    /// How closely depths are asked for.
    fn fine(&self) -> f64 {
        self.tolerance / 32.0
    }

    /// How deep it is at a part of the way, if it is.
    fn at(&mut self, at: f64) -> Option<Peak> {
        let tolerance = self.fine();
        let Search { setting, question, ref mut work, budget, .. } = *self;
        let pose = self.motion.pose(at);
        if question.limit >= 0.0 {
            let asked = (tolerance * setting.length, budget);
            let found = penetration(setting, question, work, &pose, asked);
            let depth = found.depth.map(|depth| depth / setting.length);
            return found.witness.map(|witness| Peak { depth, at, witness });
        }
        setting.look(work, &pose);
        let goal = Goal { least: question.limit, tolerance, enough: f64::INFINITY, budget };
        work.outside(setting, question, &pose, goal);
        let best = work.best?;
        let (found, more) = (work.search.best, error(setting, self.motion) + work.skew);
        let high = (found + tolerance).max(work.search.most) + more;
        Some(Peak { depth: [found - more, high], at, witness: setting.witness(&best, &pose) })
    }
}

fn deeper(one: Peak, other: Peak) -> Peak {
    if other.depth[0] > one.depth[0] { other } else { one }
}
