//! Directions of the tool axis along a line.

use super::PathPlanner;
use super::slice::SlicePoint;
use crate::mesh::Mesh;
use crate::pose::Pose;
use crate::postures::Directions;
use crate::postures::directions::has;
use crate::postures::placement::SurfacePoint;
use nalgebra::Vector3;

/// A posture of a path.
#[derive(Clone, Copy, Debug)]
pub(super) struct PathPosture {
    pub(super) spot: SurfacePoint,
    pub(super) pose: Pose,
    pub(super) axis: Vector3<f64>,
}

/// Consecutive postures.
pub(super) struct PostureRun {
    pub(super) ways: Vec<PathPosture>,
    /// Per posture but the last, the intermediate cutter locations of the proved motion to the next; `None` if
    /// no motion is proved.
    pub(super) joined: Vec<Option<Vec<Pose>>>,
    /// Sum of the squares of the axis turns, in radians, before smoothing.
    pub(super) turned: f64,
}

impl PostureRun {
    pub(super) fn reverse(&mut self) {
        self.ways.reverse();
        self.joined.reverse();
        self.joined.iter_mut().flatten().for_each(|stops| stops.reverse());
    }

    /// Returns the sum of the squares of the axis turns, in radians.
    pub(super) fn turns(&self) -> f64 {
        squares(&self.ways)
    }
}

fn squares(ways: &[PathPosture]) -> f64 {
    ways.windows(2).map(|pair| pair[0].axis.angle(&pair[1].axis).powi(2)).sum()
}

/// A point, and the directions from which a sweep reached its triangle.
struct ReachableDirections<'a> {
    spot: SurfacePoint,
    set: &'a [u64],
    crossed: &'a [SurfacePoint],
}

/// Cost of a direction at the rim of the accessible ones, relative to squared turns in radians.
const RIM: f64 = 0.1;

/// Number of directions tried at a point, beginning with the one that turns least.
const OTHERS: usize = 12;

/// Largest number of smoothing passes over a run.
const EVEN: usize = 24;

/// Turn in radians below which an axis is left as it is.
const SMALL: f64 = 1e-3;

/// Largest number of times that a motion between two points is halved.
const FINEST: u32 = 6;

/// Length below which the mean of two directions is taken as zero: they are opposite.
const HALF: f64 = 1e-6;

impl PathPlanner<'_> {
    /// Returns the postures along a line, in runs. A point that the tool does not reach ends a run.
    pub(super) fn runs(
        &mut self,
        mesh: &Mesh,
        (directions, access): (&Directions, &[Vec<u64>]),
        line: &[SlicePoint],
    ) -> Vec<PostureRun> {
        let reached: Vec<Option<ReachableDirections<'_>>> = line
            .iter()
            .map(|place| {
                let normal = mesh.normal(place.triangle)?;
                let set = access.get(place.triangle.index())?;
                // A set of another length belongs to other directions, and is ignored.
                let any = set.len() == directions.words() && set.iter().any(|word| *word != 0);
                any.then_some(ReachableDirections {
                    spot: SurfacePoint { point: place.point, normal },
                    set,
                    crossed: &place.crossed,
                })
            })
            .collect();
        let mut runs = Vec::new();
        for stretch in reached.split(Option::is_none) {
            let stretch: Vec<&ReachableDirections> = stretch.iter().flatten().collect();
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

    /// Smooths the turns of a run of postures and joins them. Each posture comes with the edges that the line
    /// crossed before it.
    fn run(&mut self, run: Vec<(PathPosture, &[SurfacePoint])>) -> PostureRun {
        let (ways, crossed): (Vec<PathPosture>, Vec<&[SurfacePoint]>) = run.into_iter().unzip();
        let turned = squares(&ways);
        let ways = self.smooth(ways);
        let pairs = ways.windows(2).zip(&crossed[1..]);
        let joined = pairs.map(|(pair, crossed)| self.join(&pair[0], &pair[1], crossed));
        let joined = joined.collect();
        PostureRun { ways, joined, turned }
    }

    /// Returns the intermediate cutter locations of a proved motion between two postures: none if the straight
    /// motion is proved, and otherwise as many as needed. Over convex edges the motion goes from one triangle's
    /// normal to the other's. Returns `None` if no motion is proved.
    pub(super) fn join(
        &mut self,
        from: &PathPosture,
        to: &PathPosture,
        crossed: &[SurfacePoint],
    ) -> Option<Vec<Pose>> {
        let mut stops = Vec::new();
        if !self.sweep(&from.pose, &to.pose)? {
            let mut at = *from;
            for (k, spot) in crossed.iter().enumerate() {
                let part = (k as f64 + 0.5) / crossed.len() as f64;
                let axis = from.axis.lerp(&to.axis, part).try_normalize(HALF)?;
                // At a concave edge the tool does not reach the edge, and need not.
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

    /// Appends the cutter locations of a proved motion to a posture, that posture included. A motion that is
    /// deeper than the tolerance is halved, at most `more` times.
    fn refine(
        &mut self,
        from: &PathPosture,
        to: &PathPosture,
        more: u32,
        stops: &mut Vec<Pose>,
    ) -> Option<()> {
        // A motion that exceeds the search budget would exceed it in halves too.
        if self.sweep(&from.pose, &to.pose)? {
            stops.push(to.pose);
            return Some(());
        }
        let more = more.checked_sub(1)?;
        let point = nalgebra::center(&from.spot.point, &to.spot.point);
        let normal = from.spot.normal.lerp(&to.spot.normal, 0.5).try_normalize(HALF)?;
        let axis = from.axis.lerp(&to.axis, 0.5).try_normalize(HALF)?;
        let middle = self.stand(&SurfacePoint { point, normal }, axis)?;
        self.refine(from, &middle, more, stops)?;
        self.refine(&middle, to, more, stops)
    }

    /// Returns the posture at a point, in a direction or in one near it that the sweep found for the triangle's
    /// centroid.
    fn stand_near(
        &mut self,
        directions: &Directions,
        at: &ReachableDirections<'_>,
        direction: usize,
    ) -> Option<PathPosture> {
        let others = directions.beside(direction).filter(|other| has(at.set, *other));
        let mut tried = others.take(OTHERS);
        tried.find_map(|other| self.stand(&at.spot, Vector3::from(directions.list()[other])))
    }

    /// Moves the axes toward the mean of their neighbours, as far as each posture is proved again.
    fn smooth(&mut self, mut run: Vec<PathPosture>) -> Vec<PathPosture> {
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

/// Returns one direction per point, so that the sum of squared turns and of the costs of rims is least: a
/// shortest path (Viterbi).
fn even(directions: &Directions, stretch: &[&ReachableDirections<'_>]) -> Vec<usize> {
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
                // For unit vectors this is the square of the turn, as long as it is small.
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
