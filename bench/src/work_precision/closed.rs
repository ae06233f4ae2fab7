//! Measurements on patches with closed-form contacts.

use super::lineup::{CELLS, Kind, Lineup, Truths, kinds};
use super::methods::Proved;
use super::patch::Patch;
use super::peers;
use super::plan::Plan;
use super::row::{Label, Row};
use super::truth::{Tally, Truth};
use super::{Facts, Failure, Sink};
use rayon::prelude::*;
use touchoff::certify::{Certifier, TriangleBvh};
use touchoff::{CloudError, Mesh, Pose};
use touchoff_tests::oracle::draw::Rng;

/// Measures a patch with clouds of all sizes.
///
/// # Errors
/// If no cloud can have the number of points, or if nothing can be certified for the tool.
pub(super) fn measure(patch: Patch, plan: &Plan, sink: Sink<'_>) -> Result<Facts, Failure> {
    let mesh = patch.mesh();
    let bvh = TriangleBvh::new(&mesh);
    let times = patch.times();
    let mut typical = Tally::default();
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
        typical.join(&truths);
    }
    Ok(Facts {
        scene: patch.name().to_owned(),
        about: patch.about(),
        path: false,
        typical: typical.typical(),
        known: patch.known(),
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

    fn kinds(&self, cloud: usize) -> Result<Vec<Kind>, CloudError> {
        let carry = |cloud| self.patch.exact(cloud);
        let mut all = kinds(self.mesh, self.count, self.seed(cloud), carry)?;
        let centroids = self.patch.centroids(self.count);
        all.extend(centroids.map(|cloud| Kind::new(["centroids", CELLS], cloud)));
        Ok(all)
    }

    fn placed(&self, cloud: usize, count: usize) -> (Vec<Pose>, Vec<(usize, Truth)>) {
        let mut draw = Rng::new(!self.seed(cloud));
        let placed = (0..count).map(|_| self.patch.place(&mut draw));
        let (poses, truths): (Vec<Pose>, Vec<Truth>) = placed.unzip();
        (poses, truths.into_iter().enumerate().collect())
    }

    fn check(&self, lineup: &mut Lineup<'_>, cloud: usize) -> Vec<Tally> {
        let (poses, truths) = self.placed(cloud, self.plan.placements);
        lineup.check(&poses, Truths { true_depths: &truths, thesis: &truths })
    }

    /// Returns the rows of this size, and a tally of the true values.
    fn measure(&self, bvh: &TriangleBvh) -> Result<(Vec<Row>, Tally), Failure> {
        let others = |cloud: usize| {
            let kinds = self.kinds(cloud)?;
            let mut lineup = Lineup::default();
            self.add_points(&mut lineup, &kinds);
            Ok(self.check(&mut lineup, cloud))
        };
        let others: Vec<Vec<Tally>> =
            (1..self.clouds).into_par_iter().map(others).collect::<Result<_, CloudError>>()?;
        let kinds = self.kinds(0)?;
        let mut lineup = Lineup::default();
        self.add_points(&mut lineup, &kinds);
        self.add_triangles(&mut lineup, bvh)?;
        let mut tallies = self.check(&mut lineup, 0);
        // Methods on triangles come after those on points. The other clouds have no results for them.
        for other in &others {
            tallies.iter_mut().zip(other).for_each(|(tally, other)| tally.join(other));
        }
        let known = self.patch.known();
        let (poses, truths) = self.placed(self.clouds, self.plan.timed);
        let times = lineup.race(&poses, self.plan.seconds);
        let deep = truths.iter().map(|(_, truth)| truth.depth).fold(0.0, f64::max);
        let errors = tallies.iter().map(|tally| Ok(tally.errors(known, known[2] * deep)));
        let rows = lineup.rows(self.patch.name(), &times, errors);
        Ok((rows, tallies.swap_remove(0)))
    }

    fn add_points<'a>(&self, lineup: &mut Lineup<'a>, kinds: &'a [Kind]) {
        lineup.add_clouds(kinds, self.patch.cutter());
        let peers = self.patch.is_of_ball_or_flute() && self.plan.has_peers(self.from_last);
        if peers && let Some(kind) = kinds.iter().find(|kind| kind.words == ["blue", CELLS]) {
            peers::add_points(lineup, kind);
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
            let proved = Certifier::new(bvh, self.patch.cutter().tool())?;
            let label = Label::triangles("certified");
            let label = Label { tolerance: Some(*tolerance), ..label };
            lineup.add(label, Box::new(Proved::new(proved, *tolerance)));
        }
        if self.patch.is_of_ball_or_flute() {
            peers::add_triangles(lineup, self.mesh);
        }
        Ok(())
    }
}
