//! From postures to a path: a 5-axis program that is proved.
//!
//! ```text
//! mesh ──slice──▶ lines ──axes──▶ runs of postures ──smooth──▶ even turns ──link──▶ stops
//!                          ▲                                                  ▲
//!                     where a sweep reached                              sweep_clear
//! ```
//!
//! Parallel planes cut the part in lines; along each the tool stands where a sweep found that it can, with
//! the directions that turn least from place to place. Every posture is proved, and every way between two.
//! Where going straight is too deep, the tool is led over the edges between two places, with stops as near
//! as need be. What cannot be joined on the surface is joined over it: a little back along the axis, across,
//! and in along the next; or else out, around the part, and in.

mod axes;
mod link;
mod slice;

use super::touching::{Posture, Spot, Touching};
use super::{Directions, Judge, JudgeError, Rules};
use crate::certify::{Facets, Sweep};
use crate::cores;
use crate::mesh::Mesh;
use crate::motion::Motion;
use crate::pose::Pose;
use crate::tool::Tool;
use axes::{Run, Way};
use link::{Around, Leg};
use nalgebra::Vector3;
use slice::{Place, length_of_lines, slices};

/// How a surface is gone over.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pattern {
    /// The normal of the planes that cut the part; of any length.
    pub normal: [f64; 3],
    /// How far planes are apart, in the part's unit, or a little less or more so that they are evenly so.
    pub stepover: f64,
    /// How far places on a line are apart at most, in the part's unit.
    pub step: f64,
}

/// Why there is no path.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PathError {
    /// A pattern that is none.
    #[error("{what} of {value} is no length above 0: give one in the part's unit, such as 1")]
    Pattern {
        /// What is none.
        what: &'static str,
        /// What was given.
        value: f64,
    },
    /// The planes have no normal.
    #[error("the planes' normal is no direction: give three numbers that are not all 0")]
    Normal,
    /// The planes would be too many.
    #[error("{planes:.0} planes are more than {most}: take a larger stepover")]
    TooMany {
        /// How many they would be.
        planes: f64,
        /// How many may be.
        most: usize,
    },
    /// The places on the lines would be too many.
    #[error("{places:.0} places are more than {most}: take a larger step or stepover")]
    TooFine {
        /// How many they would be at most.
        places: f64,
        /// How many may be.
        most: usize,
    },
    /// The rules mean nothing, or nothing of the tool can be held to them.
    #[error(transparent)]
    Judge(#[from] JudgeError),
    /// There is no posture to go through.
    #[error(
        "the tool reaches none of the places where the planes cut the part: sweep with it first, or take \
         planes of another normal"
    )]
    Nowhere,
}

/// A path, and what it is made of.
#[derive(Clone, Debug)]
pub struct Path {
    /// Its stops, the first and the last away from the part, each with whether the tool comes there in rapid
    /// traverse.
    pub stops: Vec<(Pose, bool)>,
    /// Places at which the part is touched.
    pub places: usize,
    /// Places on the lines that it leaves out: the tool does not reach them, or no way to them was proved.
    pub left_out: usize,
    /// How often it leaves the surface.
    pub lifts: usize,
    /// The root mean square turn of the axis from place to place along the lines, in radians, before and
    /// after it was made even.
    pub turns: [f64; 2],
}

/// The most planes.
const MOST: usize = 100_000;

/// The most places, as far as the lines' length tells: some gigabytes, and weeks of any machine.
const MOST_PLACES: usize = 20_000_000;

/// Of the tolerance this part is for the way between stops.
const BETWEEN: f64 = 1.0 / 8.0;

/// Lines that are looked at together.
const TOGETHER: usize = 8;

/// What a question may look at: a way that is harder to prove is another way's to go.
const BUDGET: u32 = 1 << 18;

/// A tool beside a part, ready to be led over it.
pub(super) struct Leader<'a> {
    touching: Touching<'a>,
    judge: Judge<'a>,
    rules: &'a Rules,
    postures: Vec<Posture>,
}

/// A path of a tool over all that it reaches of a part: no deeper than the rules' tolerance at its stops and
/// between them, where the tip goes straight and the axis turns evenly; nicer than the rules ask at every
/// place. `access` has of each triangle, by its id, the directions from which a sweep found that the tool reaches
/// it, as [`Access`](super::Access) has them; nothing where it does not.
///
/// # Errors
/// If the pattern or the rules mean nothing, or there is nothing to go over.
pub fn path<'a>(
    (mesh, facets): (&Mesh, &'a Facets),
    (tool, rules): (&'a dyn Tool, &'a Rules),
    (directions, access): (&Directions, &[Vec<u64>]),
    pattern: &Pattern,
) -> Result<Path, PathError> {
    for (what, value) in [("a stepover", pattern.stepover), ("a step", pattern.step)] {
        if !(value > 0.0 && value.is_finite()) {
            return Err(PathError::Pattern { what, value });
        }
    }
    // By its largest part first, so that no square is too large or too small.
    let normal = Vector3::from(pattern.normal);
    let normal = (normal / normal.amax()).try_normalize(0.0).filter(|n| n.norm().is_finite());
    let normal = normal.ok_or(PathError::Normal)?;
    let [low, high] = mesh.bounds();
    let planes = (high - low).norm() / pattern.stepover;
    if planes > MOST as f64 {
        return Err(PathError::TooMany { planes, most: MOST });
    }
    let places = length_of_lines(mesh, &normal, pattern.stepover) / pattern.step;
    if places > MOST_PLACES as f64 {
        return Err(PathError::TooFine { places, most: MOST_PLACES });
    }
    let mut leader = Leader::new(facets, tool, rules)?;
    let around = Around::new(mesh, leader.touching.reach());
    let planes = slices(mesh, &normal, [pattern.stepover, pattern.step]);
    let lines: Vec<(usize, &Vec<Place>)> = planes
        .iter()
        .enumerate()
        .flat_map(|(k, lines)| lines.iter().map(move |line| (k, line)))
        .collect();
    let runs = cores::ranges(lines.len(), TOGETHER, |range| {
        // What was refused was refused above.
        let Ok(mut leader) = Leader::new(facets, tool, rules) else { return Vec::new() };
        let run = |(plane, line): &(usize, &Vec<Place>)| {
            leader.judge.certifier.forget();
            (*plane, leader.runs(mesh, (directions, access), line))
        };
        lines[range].iter().map(run).collect()
    });
    let mut path =
        Drawn { seen: lines.iter().map(|(_, line)| line.len()).sum(), ..Drawn::default() };
    let mut runs = runs.into_iter().flatten().peekable();
    while let Some((plane, mut here)) = runs.next() {
        while let Some((_, more)) = runs.next_if(|(other, _)| *other == plane) {
            here.extend(more);
        }
        here.iter().for_each(|run| path.count(run));
        // The nearest end of what is left comes next.
        while let Some((next, reverse)) = path.nearest(&here) {
            let mut run = here.swap_remove(next);
            if reverse {
                run.reverse();
            }
            path.follow(&mut leader, &around, &run, 3.0 * pattern.stepover);
        }
    }
    path.end(&mut leader, &around)
}

impl<'a> Leader<'a> {
    fn new(
        facets: &'a Facets,
        tool: &'a dyn Tool,
        rules: &'a Rules,
    ) -> Result<Leader<'a>, JudgeError> {
        let at_stops = Rules { tolerance: rules.tolerance * (1.0 - BETWEEN), ..rules.clone() };
        let mut judge = Judge::new(facets, tool, &at_stops)?;
        judge.certifier = judge.certifier.budget(BUDGET);
        let touching = Touching::new(tool, facets.unit());
        Ok(Leader { touching, judge, rules, postures: Vec::new() })
    }

    /// The tool at a place, its axis in a direction, if that is proved to be acceptable.
    fn stand(&mut self, spot: &Spot, axis: Vector3<f64>) -> Option<Way> {
        self.touching.list(*spot, [axis], &mut self.postures);
        let nice = self.postures.iter().filter(|posture| posture.niceness > self.rules.niceness);
        let mut poses = nice.filter_map(|posture| Pose::from_axis(posture.tip, axis).ok());
        let pose = poses.find(|pose| self.judge.accepts(pose))?;
        Some(Way { spot: *spot, pose, axis })
    }

    /// Whether the tool is proved to be no deeper than the tolerance on its way, or to be deeper; if neither,
    /// `None`.
    fn sweep(&mut self, from: &Pose, to: &Pose) -> Option<bool> {
        let motion = Motion::new(from, to).ok()?;
        let more = BETWEEN * self.rules.tolerance;
        match self.judge.certifier.sweep_clear(&motion, more) {
            Sweep::Clear | Sweep::SurfaceOnly => Some(true),
            Sweep::Touching(..) | Sweep::Inside(_) => Some(false),
            Sweep::Undecided(_) => None,
        }
    }

    /// Whether the tool is proved to be no deeper than the tolerance on its way.
    fn goes(&mut self, from: &Pose, to: &Pose) -> bool {
        self.sweep(from, to) == Some(true)
    }
}

/// What is drawn of a path.
#[derive(Default)]
struct Drawn {
    stops: Vec<(Pose, bool)>,
    /// Where the surface was come to last: the stop, and the way.
    came: Option<(usize, Leg)>,
    /// The last place on the surface.
    last: Option<Way>,
    seen: usize,
    places: usize,
    dropped: usize,
    lifts: usize,
    steps: usize,
    turned: [f64; 2],
}

impl Drawn {
    fn count(&mut self, run: &Run) {
        self.places += run.ways.len();
        self.steps += run.ways.len() - 1;
        self.turned[0] += run.turned;
        self.turned[1] += run.turns();
    }

    /// The run that has the nearest end, and whether that is its last.
    fn nearest(&self, runs: &[Run]) -> Option<(usize, bool)> {
        let from = self.last.as_ref().map(|last| last.pose.tip());
        let far = |way: &Way| from.map_or(0.0, |from| (way.pose.tip() - from).norm());
        let ends = runs.iter().enumerate().filter_map(|(index, run)| {
            let (first, last) = (run.ways.first()?, run.ways.last()?);
            Some([(far(first), index, false), (far(last), index, true)])
        });
        let nearest = ends.flatten().min_by(|a, b| a.0.total_cmp(&b.0));
        nearest.map(|(_, index, reverse)| (index, reverse))
    }

    fn stop(&mut self, pose: Pose, rapid: bool) {
        self.stops.push((pose, rapid));
    }

    /// Goes to a run and along it; where two places cannot be joined on the surface, over it or around the part.
    fn follow(&mut self, leader: &mut Leader<'_>, around: &Around, run: &Run, near: f64) {
        for (index, way) in run.ways.iter().enumerate() {
            let joined = match (index.checked_sub(1), &self.last) {
                // Whether the way before is the last is known by its place.
                (Some(before), Some(last)) if run.ways[before].pose == last.pose => {
                    run.joined[before].clone()
                }
                (_, Some(last)) if (way.spot.point - last.spot.point).norm() <= near => {
                    leader.join(last, way, &[])
                }
                _ => None,
            };
            if let Some(stops) = joined {
                stops.into_iter().for_each(|pose| self.stop(pose, false));
            } else if !self.hop(leader, around, way) && !self.go_round(leader, around, way) {
                self.dropped += 1;
                continue;
            }
            self.stop(way.pose, false);
            self.last = Some(*way);
        }
    }

    /// Lifts off the surface a little, and comes to a place of it over another, if that is proved.
    fn hop(&mut self, leader: &mut Leader<'_>, around: &Around, way: &Way) -> bool {
        let Some(last) = &self.last else { return false };
        let (from, to) = (last.pose, way.pose);
        let (Some(up), Some(over)) = (around.lifted(&from), around.lifted(&to)) else {
            return false;
        };
        let proved = leader.goes(&from, &up) && leader.goes(&up, &over) && leader.goes(&over, &to);
        if proved {
            self.stop(up, false);
            self.stop(over, true);
            self.lifts += 1;
        }
        proved
    }

    /// Leaves the surface, and comes to a place of it from outside, if that is proved.
    fn go_round(&mut self, leader: &mut Leader<'_>, around: &Around, way: &Way) -> bool {
        let Some(leg) = around.leg(leader, &way.pose) else { return false };
        let left = self.stops.len();
        if let Some(from) = self.leave(leader, around) {
            let Some(stops) = around.between(leader, &from, &leg.far) else {
                self.stops.truncate(left);
                return false;
            };
            stops.into_iter().for_each(|pose| self.stop(pose, true));
            self.lifts += 1;
        }
        self.stop(leg.far, true);
        self.stop(leg.near, true);
        self.came = Some((self.stops.len(), leg));
        true
    }

    /// Goes off the surface: where that is not proved from the last place, back along those before it, as
    /// far as the one that was come to from outside, hops and all. Where it ends; `None` if nothing was touched yet.
    fn leave(&mut self, leader: &mut Leader<'_>, around: &Around) -> Option<Pose> {
        let (first, came) = self.came?;
        let mut at = self.stops.len() - 1;
        let leg = loop {
            if at == first {
                break came;
            }
            if let Some(leg) = around.leg(leader, &self.stops[at].0) {
                break leg;
            }
            at -= 1;
            self.stop(self.stops[at].0, false);
        };
        self.stop(leg.near, false);
        self.stop(leg.far, true);
        Some(leg.far)
    }

    fn end(mut self, leader: &mut Leader<'_>, around: &Around) -> Result<Path, PathError> {
        self.leave(leader, around).ok_or(PathError::Nowhere)?;
        let steps = self.steps.max(1) as f64;
        let places = self.places - self.dropped;
        Ok(Path {
            places,
            left_out: self.seen - places,
            lifts: self.lifts,
            turns: self.turned.map(|turned| (turned / steps).sqrt()),
            stops: self.stops,
        })
    }
}
