//! Measurements on patches with closed-form contacts.

use super::lineup::{CELLS, LabelledCloud, Lineup, Truths, labelled_clouds};
use super::methods::CertifiedDepth;
use super::patch::Patch;
use super::peers;
use super::plan::Plan;
use super::row::{Label, Row};
use super::truth::{ErrorStats, Truth};
use super::{Failure, SceneInfo, Sink};
use rayon::prelude::*;
use touchoff::certify::{Certifier, TriangleBvh};
use touchoff::{CloudError, Mesh, Pose};
use touchoff_tests::oracle::rng::Rng;

/// Measures a patch with clouds of all sizes.
///
/// # Errors
/// If no cloud can have the number of points, or if nothing can be certified for the tool.
pub(super) fn measure(patch: Patch, plan: &Plan, sink: Sink<'_>) -> Result<SceneInfo, Failure> {
    let mesh = patch.mesh();
    let bvh = TriangleBvh::new(&mesh);
    let times = patch.area_ratio();
    let mut totals = ErrorStats::default();
    for (from_last, contacts) in plan.contacts.iter().rev().enumerate().rev() {
        let size = Size {
            patch,
            plan,
            mesh: &mesh,
            count: (*contacts as f64 * times).round() as usize,
            clouds: plan.clouds(*contacts),
            from_last,
        };
        let (rows, truths) = size.measure(&bvh)?;
        rows.into_iter().for_each(&mut *sink);
        totals.merge(&truths);
    }
    Ok(SceneInfo {
        scene: patch.name().to_owned(),
        description: patch.description(),
        is_path: false,
        typical: totals.typical(),
        reference_error: patch.accuracy(),
        unit: mesh.unit(),
    })
}

struct Size<'a> {
    patch: Patch,
    plan: &'a Plan,
    mesh: &'a Mesh,
    count: usize,
    clouds: usize,
    /// The index of the size, counted from the largest.
    from_last: usize,
}

impl Size<'_> {
    fn seed(&self, cloud: usize) -> u64 {
        // Each size has its own seed: otherwise the first points of a larger cloud would be those of a smaller one.
        self.plan.seed.wrapping_mul(1 << 40) + ((self.count as u64) << 12) + cloud as u64
    }

    fn labelled_clouds(&self, cloud: usize) -> Result<Vec<LabelledCloud>, CloudError> {
        let project = |cloud| self.patch.exact(cloud);
        let mut clouds = labelled_clouds(self.mesh, self.count, self.seed(cloud), project)?;
        let centroids = self.patch.centroids(self.count);
        clouds.extend(centroids.map(|cloud| LabelledCloud::new(["centroids", CELLS], cloud)));
        Ok(clouds)
    }

    fn placements(&self, cloud: usize, count: usize) -> (Vec<Pose>, Vec<(usize, Truth)>) {
        let mut rng = Rng::new(!self.seed(cloud));
        let placements = (0..count).map(|_| self.patch.random_placement(&mut rng));
        let (poses, truths): (Vec<Pose>, Vec<Truth>) = placements.unzip();
        (poses, truths.into_iter().enumerate().collect())
    }

    fn check(&self, lineup: &mut Lineup<'_>, cloud: usize) -> Vec<ErrorStats> {
        let (poses, truths) = self.placements(cloud, self.plan.placements);
        lineup.check(&poses, Truths { true_depths: &truths, thesis: &truths })
    }

    /// Returns the rows of this size, and the statistics of the true values.
    fn measure(&self, bvh: &TriangleBvh) -> Result<(Vec<Row>, ErrorStats), Failure> {
        let check_cloud = |cloud: usize| {
            let clouds = self.labelled_clouds(cloud)?;
            let mut lineup = Lineup::default();
            self.add_points(&mut lineup, &clouds);
            Ok(self.check(&mut lineup, cloud))
        };
        let others: Vec<Vec<ErrorStats>> =
            (1..self.clouds).into_par_iter().map(check_cloud).collect::<Result<_, CloudError>>()?;
        let clouds = self.labelled_clouds(0)?;
        let mut lineup = Lineup::default();
        self.add_points(&mut lineup, &clouds);
        self.add_triangles(&mut lineup, bvh)?;
        let mut method_stats = self.check(&mut lineup, 0);
        // Methods on triangles come after those on points. The other clouds have no results for them.
        for other in &others {
            method_stats.iter_mut().zip(other).for_each(|(stats, other)| stats.merge(other));
        }
        let accuracy = self.patch.accuracy();
        let (poses, truths) = self.placements(self.clouds, self.plan.timed);
        let times = lineup.race(&poses, self.plan.seconds);
        let max_depth = truths.iter().map(|(_, truth)| truth.depth).fold(0.0, f64::max);
        let errors =
            method_stats.iter().map(|stats| Ok(stats.errors(accuracy, accuracy[2] * max_depth)));
        let rows = lineup.rows(self.patch.name(), &times, errors);
        Ok((rows, method_stats.swap_remove(0)))
    }

    fn add_points<'a>(&self, lineup: &mut Lineup<'a>, clouds: &'a [LabelledCloud]) {
        lineup.add_clouds(clouds, self.patch.cutter());
        let has_peers = self.patch.touches_ball_or_flute() && self.plan.has_peers(self.from_last);
        if has_peers && let Some(cloud) = clouds.iter().find(|cloud| cloud.names == ["blue", CELLS])
        {
            peers::add_points(lineup, cloud);
        }
    }

    /// Adds the methods on triangles, for the largest size only, since they do not depend on the cloud.
    fn add_triangles<'a>(
        &self,
        lineup: &mut Lineup<'a>,
        bvh: &'a TriangleBvh,
    ) -> Result<(), Failure> {
        if self.from_last > 0 || !self.patch.is_flat() {
            return Ok(());
        }
        for tolerance in &self.plan.tolerances {
            let certifier = Certifier::new(bvh, self.patch.cutter().tool())?;
            let label = Label::triangles("certified");
            let label = Label { tolerance: Some(*tolerance), ..label };
            lineup.add(label, Box::new(CertifiedDepth::new(certifier, *tolerance)));
        }
        if self.patch.touches_ball_or_flute() {
            peers::add_triangles(lineup, self.mesh);
        }
        Ok(())
    }
}
