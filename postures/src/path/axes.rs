//! Directions of the tool axis along a line.

use super::PathPlanner;
use super::slice::SlicePoint;
use crate::Directions;
use crate::directions::contains;
use crate::placement::SurfacePoint;
use nalgebra::{Point3, Vector3};
use touchoff::{Mesh, Pose};

/// A posture of a path.
#[derive(Clone, Copy, Debug)]
pub(super) struct PathPosture {
    pub(super) surface_point: SurfacePoint,
    pub(super) pose: Pose,
    pub(super) axis: Vector3<f64>,
}

/// Consecutive postures.
pub(super) struct PostureRun {
    pub(super) postures: Vec<PathPosture>,
    /// Per posture but the last, the intermediate cutter locations of the proved motion to the next; `None` if
    /// no motion is proved.
    pub(super) links: Vec<Option<Vec<Pose>>>,
    /// Sum of the squares of the axis turns, in radians, before smoothing.
    pub(super) squared_turns: f64,
}

impl PostureRun {
    pub(super) fn reverse(&mut self) {
        self.postures.reverse();
        self.links.reverse();
        self.links.iter_mut().flatten().for_each(|locations| locations.reverse());
    }

    /// Returns the sum of the squares of the axis turns, in radians.
    pub(super) fn turns(&self) -> f64 {
        squares(&self.postures)
    }
}

fn squares(postures: &[PathPosture]) -> f64 {
    postures.windows(2).map(|pair| pair[0].axis.angle(&pair[1].axis).powi(2)).sum()
}

/// A point, and the directions from which a sweep reached its triangle.
struct ReachableDirections<'a> {
    surface_point: SurfacePoint,
    set: &'a [u64],
    crossed: &'a [SurfacePoint],
}

/// Returns the directions from which a sweep reached the triangle of a point; `None` if there is none.
fn reachable_directions<'a>(
    mesh: &Mesh,
    directions: &Directions,
    access: &'a [Vec<u64>],
    place: &'a SlicePoint,
) -> Option<ReachableDirections<'a>> {
    let normal = mesh.normal(place.triangle)?;
    let set = access.get(place.triangle.index())?;
    // A set of another length belongs to other directions, and is ignored.
    let any = set.len() == directions.words() && set.iter().any(|word| *word != 0);
    any.then_some(ReachableDirections {
        surface_point: SurfacePoint { point: place.point, normal },
        set,
        crossed: &place.crossed,
    })
}

/// Cost of a direction at the rim of the accessible ones, relative to squared turns in radians.
const RIM_COST: f64 = 0.1;

/// Number of directions tried at a point, beginning with the one that turns least.
const MAX_DIRECTIONS_TRIED: usize = 12;

/// Largest number of smoothing passes over a run.
const MAX_SMOOTHING_PASSES: usize = 24;

/// Turn in radians below which an axis is left as it is.
const MIN_TURN: f64 = 1e-3;

/// Largest number of times that a motion between two points is halved.
const MAX_HALVINGS: u32 = 6;

/// Length below which the mean of two directions is taken as zero: they are opposite.
const MIN_MEAN_LENGTH: f64 = 1e-6;

impl PathPlanner<'_> {
    /// Returns the postures along a line, in runs, and the points that the tool does not reach, which end runs.
    pub(super) fn runs(
        &mut self,
        mesh: &Mesh,
        directions: &Directions,
        access: &[Vec<u64>],
        line: &[SlicePoint],
    ) -> (Vec<PostureRun>, Vec<Point3<f64>>) {
        let mut unreached = Vec::new();
        let reached: Vec<Option<ReachableDirections<'_>>> = line
            .iter()
            .map(|place| {
                let reachable = reachable_directions(mesh, directions, access, place);
                unreached.extend(reachable.is_none().then_some(place.point));
                reachable
            })
            .collect();
        let mut runs = Vec::new();
        for stretch in reached.split(Option::is_none) {
            let stretch: Vec<&ReachableDirections> = stretch.iter().flatten().collect();
            let mut run = Vec::new();
            for (point_directions, direction) in
                stretch.iter().zip(smoothest_directions(directions, &stretch))
            {
                match self.posture_near(directions, point_directions, direction) {
                    Some(posture) => run.push((posture, point_directions.crossed)),
                    None => {
                        unreached.push(point_directions.surface_point.point);
                        runs.push(std::mem::take(&mut run));
                    }
                }
            }
            runs.push(run);
        }
        runs.retain(|run| !run.is_empty());
        (runs.into_iter().map(|run| self.run(run)).collect(), unreached)
    }

    /// Smooths the turns of a run of postures and joins them. Each posture comes with the edges that the line
    /// crossed before it.
    fn run(&mut self, run: Vec<(PathPosture, &[SurfacePoint])>) -> PostureRun {
        let (postures, crossed): (Vec<PathPosture>, Vec<&[SurfacePoint]>) = run.into_iter().unzip();
        let squared_turns = squares(&postures);
        let postures = self.smooth(postures);
        let pairs = postures.windows(2).zip(&crossed[1..]);
        let links = pairs.map(|(pair, crossed)| self.link(&pair[0], &pair[1], crossed));
        let links = links.collect();
        PostureRun { postures, links, squared_turns }
    }

    /// Returns the intermediate cutter locations of a proved motion between two postures: none if the straight
    /// motion is proved, and otherwise as many as needed. Over convex edges the motion goes from one triangle's
    /// normal to the other's. Returns `None` if no motion is proved.
    pub(super) fn link(
        &mut self,
        from: &PathPosture,
        to: &PathPosture,
        crossed: &[SurfacePoint],
    ) -> Option<Vec<Pose>> {
        let mut locations = Vec::new();
        if !self.check_motion(&from.pose, &to.pose)? {
            let mut point_directions = *from;
            for (k, surface_point) in crossed.iter().enumerate() {
                // The axis turns evenly over the edges.
                let part = (k as f64 + 0.5) / crossed.len() as f64;
                let axis = from.axis.lerp(&to.axis, part).try_normalize(MIN_MEAN_LENGTH)?;
                // At a concave edge the tool does not reach the edge, and need not.
                if let Some(next) = self.posture_at(surface_point, axis)
                    && next.pose != point_directions.pose
                {
                    self.refine(&point_directions, &next, MAX_HALVINGS, &mut locations)?;
                    point_directions = next;
                }
            }
            self.refine(&point_directions, to, MAX_HALVINGS, &mut locations)?;
            // The last is the posture `to` itself.
            locations.pop();
        }
        Some(locations)
    }

    /// Appends the cutter locations of a proved motion to a posture, that posture included. A motion that is
    /// deeper than the tolerance is halved, at most `more` times.
    fn refine(
        &mut self,
        from: &PathPosture,
        to: &PathPosture,
        more: u32,
        locations: &mut Vec<Pose>,
    ) -> Option<()> {
        // A motion that exceeds the search budget would exceed it in halves too.
        if self.check_motion(&from.pose, &to.pose)? {
            locations.push(to.pose);
            return Some(());
        }
        let more = more.checked_sub(1)?;
        let point = nalgebra::center(&from.surface_point.point, &to.surface_point.point);
        let normal = from
            .surface_point
            .normal
            .lerp(&to.surface_point.normal, 0.5)
            .try_normalize(MIN_MEAN_LENGTH)?;
        let axis = from.axis.lerp(&to.axis, 0.5).try_normalize(MIN_MEAN_LENGTH)?;
        let middle = self.posture_at(&SurfacePoint { point, normal }, axis)?;
        self.refine(from, &middle, more, locations)?;
        self.refine(&middle, to, more, locations)
    }

    /// Returns the posture at a point, in a direction or in one near it that the sweep found for the triangle's
    /// centroid.
    fn posture_near(
        &mut self,
        directions: &Directions,
        point_directions: &ReachableDirections<'_>,
        direction: usize,
    ) -> Option<PathPosture> {
        // The set holds for the centroid, and this point is another: the chosen direction may fail here.
        let others =
            directions.by_angle(direction).filter(|other| contains(point_directions.set, *other));
        let mut tried = others.take(MAX_DIRECTIONS_TRIED);
        tried.find_map(|other| {
            self.posture_at(
                &point_directions.surface_point,
                Vector3::from(directions.list()[other]),
            )
        })
    }

    /// Moves the axes toward the mean of their neighbours, as far as each posture is proved again.
    fn smooth(&mut self, mut run: Vec<PathPosture>) -> Vec<PathPosture> {
        for _ in 0..MAX_SMOOTHING_PASSES {
            let mut converged = true;
            for k in 1..run.len().saturating_sub(1) {
                let [before, posture, after] = [run[k - 1].axis, run[k].axis, run[k + 1].axis];
                let middle = posture + 0.5 * (before + after);
                let Some(axis) = middle.try_normalize(MIN_MEAN_LENGTH) else { continue };
                if axis.angle(&posture) > MIN_TURN
                    && let Some(better) = self.posture_at(&run[k].surface_point, axis)
                {
                    run[k] = better;
                    converged = false;
                }
            }
            if converged {
                break;
            }
        }
        run
    }
}

/// Returns one direction per point, so that the sum of squared turns and of the costs of rims is least: a
/// shortest path (Viterbi).
fn smoothest_directions(
    directions: &Directions,
    stretch: &[&ReachableDirections<'_>],
) -> Vec<usize> {
    let list: Vec<Vector3<f64>> =
        directions.list().iter().map(|posture| Vector3::from(*posture)).collect();
    let mut steps: Vec<Vec<(u16, u16)>> = Vec::with_capacity(stretch.len());
    let mut costs: Vec<(u16, f64)> = Vec::new();
    for point_directions in stretch {
        let members =
            (0..list.len()).filter(|direction| contains(point_directions.set, *direction));
        let mut step = Vec::new();
        let mut next = Vec::new();
        for direction in members {
            // The margin is a cosine: the cost falls from the rim to 0 where every direction is accessible.
            let rim =
                RIM_COST * (1.0 + directions.margin(point_directions.set, direction)).max(0.0);
            let squared_turns = costs.iter().enumerate().map(|(k, (other, cost))| {
                // For unit vectors this is the square of the turn, as long as it is small.
                let turn = 2.0 - 2.0 * list[direction].dot(&list[usize::from(*other)]);
                (cost + turn, k)
            });
            let (cost, from) = squared_turns.min_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or((0.0, 0));
            next.push((direction as u16, cost + rim));
            step.push((direction as u16, from as u16));
        }
        costs = next;
        steps.push(step);
    }
    let least = costs.iter().enumerate().min_by(|(_, a), (_, b)| a.1.total_cmp(&b.1));
    let mut point_directions = least.map_or(0, |(k, _)| k);
    let mut chosen: Vec<usize> = steps
        .iter()
        .rev()
        .map(|step| {
            let (direction, from) = step[point_directions];
            point_directions = usize::from(from);
            usize::from(direction)
        })
        .collect();
    chosen.reverse();
    chosen
}
