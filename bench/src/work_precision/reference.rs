//! Reference values of a path: certified depths of the part's triangles, and force and torque by their refinement.

use super::Failure;
use super::cutter::Cutter;
use super::plan::Plan;
use super::refine::{Quadrature, StopCriteria};
use super::truth::{ErrorStats, Truth};
use crate::race::contender::Answer;
use rayon::prelude::*;
use touchoff::certify::{Certifier, TriangleBvh};
use touchoff::{Interval, Mesh, Pose, Tool};

/// Tolerance of the certified depths, in the part's unit.
const TOLERANCE: f64 = 1e-9;
/// Number of poses that one task processes with one certifier.
const POSES_PER_TASK: usize = 64;

/// The true values at some poses, and their accuracy.
#[derive(Clone, Debug)]
pub(super) struct Reference {
    /// True values, each with the index of its pose.
    pub(super) truths: Vec<(usize, Truth)>,
    /// Root mean squares of force, torque and depth.
    pub(super) typical: [f64; 3],
    /// Relative accuracy, as shares of `typical`.
    pub(super) reference_error: [f64; 3],
    /// The largest possible error of a depth, in the part's unit.
    pub(super) depth: f64,
}

/// Returns the poses at which a triangle is certainly inside the tool, deeper than rounding.
///
/// # Errors
/// If nothing can be certified for the tool.
pub(super) fn in_contact(
    bvh: &TriangleBvh,
    tool: &dyn Tool,
    poses: &[Pose],
) -> Result<Vec<Pose>, Failure> {
    let depths = depths(bvh, tool, poses)?;
    let intervals = poses.iter().zip(depths);
    Ok(intervals
        .filter(|(_, Interval { low, .. })| *low > 2.0 * TOLERANCE)
        .map(|(pose, _)| *pose)
        .collect())
}

/// Returns the interval of the depth at each pose.
fn depths(bvh: &TriangleBvh, tool: &dyn Tool, poses: &[Pose]) -> Result<Vec<Interval>, Failure> {
    let certify = |poses: &[Pose]| {
        let mut certifier = Certifier::new(bvh, tool)?;
        let intervals = poses.iter().map(|pose| certifier.deepest(pose, TOLERANCE).depth);
        Ok(intervals.collect::<Vec<_>>())
    };
    let chunks: Vec<Vec<Interval>> =
        poses.par_chunks(POSES_PER_TASK).map(certify).collect::<Result<_, Failure>>()?;
    Ok(chunks.concat())
}

impl Reference {
    /// Computes true values at poses in contact, evenly spaced along `poses`.
    ///
    /// # Errors
    /// If nothing can be certified for the tool.
    pub(super) fn new(
        mesh: &Mesh,
        bvh: &TriangleBvh,
        cutter: Cutter<'_>,
        poses: &[Pose],
        plan: &Plan,
    ) -> Result<Reference, Failure> {
        let depths = |poses: &[Pose]| depths(bvh, cutter.tool(), poses);
        Reference::compute(
            &Quadrature::new(mesh, cutter.tool(), cutter.tool_with_profile()),
            poses,
            plan,
            depths,
        )
    }

    /// Computes true values with the thesis's magnitudes. Their deepest points differ from those of the true depth.
    ///
    /// # Errors
    /// Never: the magnitudes are bounded without the certifier.
    #[cfg(feature = "peers")]
    pub(super) fn with_thesis_magnitudes(
        mesh: &Mesh,
        poses: &[Pose],
        plan: &Plan,
    ) -> Result<Reference, Failure> {
        use crate::peers::deepest::{TOLERANCE, deepest};
        let cutter = Cutter::THESIS;
        let depth = |pose: &Pose| {
            let low = deepest(mesh, pose, 0.0);
            Interval::new(low, low + TOLERANCE)
        };
        let depths = |poses: &[Pose]| Ok(poses.par_iter().map(depth).collect());
        Reference::compute(
            &Quadrature::new(mesh, cutter.tool(), cutter.tool_with_profile()),
            poses,
            plan,
            depths,
        )
    }

    fn compute(
        quadrature: &Quadrature<'_>,
        poses: &[Pose],
        plan: &Plan,
        depths: impl Fn(&[Pose]) -> Result<Vec<Interval>, Failure>,
    ) -> Result<Reference, Failure> {
        let count = plan.checks.min(poses.len());
        let indices: Vec<usize> = (0..count).map(|k| k * poses.len() / count).collect();
        let checked_poses: Vec<Pose> = indices.iter().map(|index| poses[*index]).collect();
        let (relative_error, max_pieces) = plan.known;
        let sums = quadrature
            .sums_at_all_poses(&checked_poses, StopCriteria { relative_error, max_pieces });
        let depths = depths(&checked_poses)?;
        let (mut typical, mut uncertainty) = (ErrorStats::default(), ErrorStats::default());
        let mut truths = Vec::new();
        for ((index, sums), Interval { low, high }) in indices.into_iter().zip(sums).zip(depths) {
            let truth =
                Truth { force: sums.force, torque: sums.torque, depth: f64::midpoint(low, high) };
            typical.add(&Answer::default(), &truth);
            let [force, torque] = sums.change;
            uncertainty.add_sizes([force, torque, (high - low) / 2.0]);
            truths.push((index, truth));
        }
        let (typical, change) = (typical.typical(), uncertainty.typical());
        let known = [0, 1, 2].map(|k: usize| change[k] / typical[k]);
        Ok(Reference {
            truths,
            typical,
            reference_error: known,
            depth: uncertainty.largest_depth(),
        })
    }
}
