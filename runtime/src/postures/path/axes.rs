//! Which way the axis goes along a line.

use super::Leader;
use super::slice::Place;
use crate::mesh::Mesh;
use crate::pose::Pose;
use crate::postures::Directions;
use crate::postures::directions::has;
use crate::postures::touching::Spot;
use nalgebra::Vector3;

/// A posture of a path.
#[derive(Clone, Copy, Debug)]
pub(super) struct Way {
    pub(super) spot: Spot,
    pub(super) pose: Pose,
    pub(super) axis: Vector3<f64>,
}

/// Postures one behind the other.
pub(super) struct Run {
    pub(super) ways: Vec<Way>,
    /// Of each but the last, over which stops the way to the next is proved, if it is.
    pub(super) joined: Vec<Option<Vec<Pose>>>,
    /// The sum of the squares of the axis's turns, in radians, before they were made even.
    pub(super) turned: f64,
}

impl Run {
    pub(super) fn reverse(&mut self) {
        self.ways.reverse();
        self.joined.reverse();
        self.joined.iter_mut().flatten().for_each(|stops| stops.reverse());
    }

    /// The sum of the squares of the axis's turns, in radians.
    pub(super) fn turns(&self) -> f64 {
        squares(&self.ways)
    }
}

fn squares(ways: &[Way]) -> f64 {
    ways.windows(2).map(|pair| pair[0].axis.angle(&pair[1].axis).powi(2)).sum()
}

/// A place, and the directions from which a sweep reached its triangle.
struct Reached<'a> {
    spot: Spot,
    set: &'a [u64],
    crossed: &'a [Spot],
}

/// What it costs to stand at the rim of what is accessible, beside a turn of as many radians, squared.
const RIM: f64 = 0.1;

/// How many directions are tried where that which turns least does not do at a place.
const OTHERS: usize = 12;

/// How often the axes of a run are made more even.
const EVEN: usize = 24;

/// Turns that are smaller are even, in radians.
const SMALL: f64 = 1e-3;

/// How often a way from place to place is halved at most.
const FINEST: u32 = 6;

/// Directions whose mean is shorter point opposite ways.
const HALF: f64 = 1e-6;

impl Leader<'_> {
    /// The postures along a line, in runs: a place that the tool does not reach ends one.
    pub(super) fn runs(
        &mut self,
        mesh: &Mesh,
        (directions, access): (&Directions, &[Vec<u64>]),
        line: &[Place],
    ) -> Vec<Run> {
        let reached: Vec<Option<Reached<'_>>> = line
            .iter()
            .map(|place| {
                let normal = mesh.normal(place.triangle)?;
                let set = access.get(place.triangle as usize)?;
                // A set of other directions says nothing.
                let any = set.len() == directions.words() && set.iter().any(|word| *word != 0);
                any.then_some(Reached {
                    spot: Spot { point: place.point, normal },
                    set,
                    crossed: &place.crossed,
                })
            })
            .collect();
        let mut runs = Vec::new();
        for stretch in reached.split(Option::is_none) {
            let stretch: Vec<&Reached> = stretch.iter().flatten().collect();
            let mut run = Vec::new();
            for (at, direction) in stretch.iter().zip(even(directions, &stretch)) {
                match self.stand_near(directions, at, direction) {
                    Some(way) => run.push((way, at.crossed)),
                    None => runs.push(std::mem::take(&mut run)),
                }
            }
            runs.push(run);
        }
        runs.retain(|run| !run.is_empty());
        runs.into_iter().map(|run| self.run(run)).collect()
    }

    /// A run of postures, its turns made even; with each, what the line crossed before it.
    fn run(&mut self, run: Vec<(Way, &[Spot])>) -> Run {
        let (ways, crossed): (Vec<Way>, Vec<&[Spot]>) = run.into_iter().unzip();
        let turned = squares(&ways);
        let ways = self.smooth(ways);
        let pairs = ways.windows(2).zip(&crossed[1..]);
        let joined = pairs.map(|(pair, crossed)| self.join(&pair[0], &pair[1], crossed));
        let joined = joined.collect();
        Run { ways, joined, turned }
    }

    /// The stops of a proved way from place to place, without its ends: none, if it goes straight, and else as many
    /// as it needs. Over edges that bulge it goes from the one triangle's normal to the other's.
    pub(super) fn join(&mut self, from: &Way, to: &Way, crossed: &[Spot]) -> Option<Vec<Pose>> {
        let mut stops = Vec::new();
        if !self.sweep(&from.pose, &to.pose)? {
            let mut at = *from;
            for (k, spot) in crossed.iter().enumerate() {
                let part = (k as f64 + 0.5) / crossed.len() as f64;
                let axis = from.axis.lerp(&to.axis, part).try_normalize(HALF)?;
                // Where an edge is hollow the tool does not come to it, and need not.
                if let Some(next) = self.stand(spot, axis)
                    && next.pose != at.pose
                {
                    self.refine(&at, &next, FINEST, &mut stops)?;
                    at = next;
                }
            }
            self.refine(&at, to, FINEST, &mut stops)?;
            stops.pop();
        }
        Some(stops)
    }

    /// Adds the stops of a proved way to a place, that with them: what does not go straight is halved, so many
    /// times at most.
    fn refine(&mut self, from: &Way, to: &Way, more: u32, stops: &mut Vec<Pose>) -> Option<()> {
        // What is too much to prove is not less by halves.
        if self.sweep(&from.pose, &to.pose)? {
            stops.push(to.pose);
            return Some(());
        }
        let more = more.checked_sub(1)?;
        let point = nalgebra::center(&from.spot.point, &to.spot.point);
        let normal = from.spot.normal.lerp(&to.spot.normal, 0.5).try_normalize(HALF)?;
        let axis = from.axis.lerp(&to.axis, 0.5).try_normalize(HALF)?;
        let middle = self.stand(&Spot { point, normal }, axis)?;
        self.refine(from, &middle, more, stops)?;
        self.refine(&middle, to, more, stops)
    }

    /// The tool at a place, in a direction or one near it that the sweep found for the triangle's middle.
    fn stand_near(
        &mut self,
        directions: &Directions,
        at: &Reached<'_>,
        direction: usize,
    ) -> Option<Way> {
        let others = directions.beside(direction).filter(|other| has(at.set, *other));
        let mut tried = others.take(OTHERS);
        tried.find_map(|other| self.stand(&at.spot, Vector3::from(directions.list()[other])))
    }

    /// The same places with axes that turn more evenly, each as proved as before.
    fn smooth(&mut self, mut run: Vec<Way>) -> Vec<Way> {
        for _ in 0..EVEN {
            let mut still = true;
            for k in 1..run.len().saturating_sub(1) {
                let [before, way, after] = [run[k - 1].axis, run[k].axis, run[k + 1].axis];
                let middle = way + 0.5 * (before + after);
                let Some(axis) = middle.try_normalize(1e-6) else { continue };
                if axis.angle(&way) > SMALL
                    && let Some(better) = self.stand(&run[k].spot, axis)
                {
                    run[k] = better;
                    still = false;
                }
            }
            if still {
                break;
            }
        }
        run
    }
}

/// Of each place the direction, such that turns are least, squared, and the rims of what is accessible far:
/// the shortest way through all (Viterbi).
fn even(directions: &Directions, stretch: &[&Reached<'_>]) -> Vec<usize> {
    let list: Vec<Vector3<f64>> = directions.list().iter().map(|way| Vector3::from(*way)).collect();
    let mut steps: Vec<Vec<(u16, u16)>> = Vec::with_capacity(stretch.len());
    let mut costs: Vec<(u16, f64)> = Vec::new();
    for at in stretch {
        let members = (0..list.len()).filter(|direction| has(at.set, *direction));
        let mut step = Vec::new();
        let mut next = Vec::new();
        for direction in members {
            let rim = RIM * (1.0 + directions.margin(at.set, direction)).max(0.0);
            let turned = costs.iter().enumerate().map(|(k, (other, cost))| {
                // Of unit vectors this is the square of the turn, as long as that is small.
                let turn = 2.0 - 2.0 * list[direction].dot(&list[usize::from(*other)]);
                (cost + turn, k)
            });
            let (cost, from) = turned.min_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or((0.0, 0));
            next.push((direction as u16, cost + rim));
            step.push((direction as u16, from as u16));
        }
        costs = next;
        steps.push(step);
    }
    let least = costs.iter().enumerate().min_by(|(_, a), (_, b)| a.1.total_cmp(&b.1));
    let mut at = least.map_or(0, |(k, _)| k);
    let mut chosen: Vec<usize> = steps
        .iter()
        .rev()
        .map(|step| {
            let (direction, from) = step[at];
            at = usize::from(from);
            usize::from(direction)
        })
        .collect();
    chosen.reverse();
    chosen
}
