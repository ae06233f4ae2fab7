//! Certified interference of a tool and a part's triangles: penetration depth, clearance and motions, with proved
//! bounds.
//!
//! ```text
//! pose ──traverse──▶ nodes ──hull──▶ triangles ──batch──▶ eight at a time ──triangle, line search──▶ deepest
//!           f32               f32                 f64                             f64
//! ```
//!
//! A point cloud says nothing about the surface between its points, so a [`Certifier`] searches the triangles
//! themselves. It traverses a bounding volume hierarchy, [`TriangleBvh`], by branch and bound, and prunes what
//! cannot be deeper than the deepest point found so far. Depth is the distance to the surface that the tool's
//! profile describes. Bounds come from the segments of the profile (`bounds/hull`). Where they leave a triangle
//! undecided, its edges are searched, and the one line in it on which depth can be greatest (`triangle`).
//!
//! **Rounding.** The coordinates of a point are known to within 2^-46 of the sizes of tool and part together, and every
//! answer is widened by that. The bound is larger for thin triangles: their *skew* is added. `rounding` derives both.

mod bounds;
mod containment;
mod motion_depth;
mod nearest;
mod part;
mod rounding;
mod scene;
mod search;
mod space;
mod sweep;
mod tool_model;
mod trajectory;
mod triangle;
mod verdict;

pub use containment::Containment;
pub use motion_depth::{MIN_SWEEP_ERRORS, THROUGH_FRACTION};
pub use nearest::NearestTriangle;
pub use part::{BoxVisitor, Location, TriangleBvh};
pub use scene::{BodyAnswer, CertifiedScene};
pub use trajectory::{Approximation, Trajectory};
pub use verdict::{
    AllowanceError, AllowanceErrors, Clearance, MotionDepth, MotionVerdict, NoSuchSurface,
    NotCertifiable, Penetration, PoseVerdict, ToolPoint, Witness,
};

use crate::bvh::QuerySetup;
use crate::debug::debug;
use crate::handle::{Handle, ToolHandle};
use crate::id::SurfaceId;
use crate::interval::Interval;
use crate::pose::Pose;
use crate::tool::Tool;
#[cfg(feature = "parallel")]
use crate::{cancellation, parallel};
use containment::CorePoints;
use fearless_simd::Level;
use nalgebra::{Point3, Vector3};
use search::{DepthQuery, QuerySetting, SearchState};
use std::slice;
use std::sync::Arc;
use sweep::Sweeper;
use tool_model::ToolModel;
use tool_model::owners::Owners;
use tool_model::profile::ProfileModel;
use triangle::line_search::Goal;

/// A tool at a part's triangles: it answers queries at one pose after another with proved bounds.
///
/// Memory is kept between queries, and each query begins at the triangle at which the last one ended. The tool is
/// represented by its profile, or by its depth function if it has no profile.
///
/// ```
/// use nalgebra::{Point3, Vector3};
/// use touchoff::certify::{Certifier, TriangleBvh};
/// use touchoff::{Interval, Pose, Unit, mesh::shapes};
///
/// touchoff::tool! {
///     tool Ball "a ball of 3 mm radius" {
///         units mm;
///         profile {
///             start (0, 0);
///             arc to (0, 6) center (0, 3) as ball cutting;
///         }
///         niceness cutting: 1;
///     }
/// }
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let low = Point3::new(-20.0, -20.0, -10.0);
/// let block = shapes::cuboid(low, Point3::new(20.0, 20.0, 0.0), Unit::Millimetre)?;
/// let bvh = TriangleBvh::new(&block);
/// let mut certifier = Certifier::new(&bvh, &Ball)?;
/// let pose = Pose::from_axis(Point3::new(0.3, 0.1, -0.5), Vector3::z())?;
/// let Interval { low, high } = certifier.deepest(&pose, 1e-9).depth;
/// assert!(low <= 0.5 && 0.5 <= high && high - low < 2e-9);
/// # Ok(()) }
/// ```
///
/// A clone has the same settings, and memory of its own: both may answer at the same time.
#[derive(Clone)]
pub struct Certifier<'a> {
    setting: QuerySetting<'a>,
    /// The query for the depth of the whole tool.
    whole_query: DepthQuery,
    /// The query for the depth of each surface, made on first use.
    surface_queries: Vec<Option<DepthQuery>>,
    /// An upper bound on the depth that each surface can have, in the tool's unit, computed on first use.
    surface_max_depths: Vec<Option<f64>>,
    allowances: Allowances,
    /// Points of the restricted interior of the tool, the region that may not be inside the part: by the allowances,
    /// of the whole tool, and of each surface with its allowed depth in the tool's unit.
    core_points: CorePoints,
    whole_core_points: CorePoints,
    surface_core_points: Vec<Option<(f64, CorePoints)>>,
    /// The clearance query for the surfaces of the last call.
    clearance_query: Option<ClearanceQuery>,
    budget: u32,
    state: SearchState,
    sweeper: Sweeper,
}

debug!([] Certifier<'_>, "Certifier", |this| {
    tool: this.setting.info().name, allowed: this.allowances.depths, budget: this.budget,
});

/// The allowance of each surface.
#[derive(Clone)]
struct Allowances {
    /// The allowed depths, in the part's unit.
    depths: Vec<f64>,
    /// The queries that check them, made on first use.
    queries: Option<Vec<DepthQuery>>,
}

impl Allowances {
    /// Returns the queries that check allowed depths, and those that check margins. `whole_query` is that of the whole tool
    /// with the limit 0.
    fn queries<'q>(
        &'q mut self,
        setting: &QuerySetting<'_>,
        whole_query: &'q DepthQuery,
    ) -> [&'q [DepthQuery]; 2] {
        if self.depths.iter().all(|depth| *depth == 0.0) {
            return [slice::from_ref(whole_query), &[]];
        }
        let Allowances { depths, queries } = self;
        let queries = queries.get_or_insert_with(|| {
            let depths: Vec<f64> = depths.iter().map(|depth| depth / setting.length).collect();
            DepthQuery::all(setting, &depths)
        });
        // They are in descending order of their limits.
        queries.split_at(queries.partition_point(|query| query.limit >= 0.0)).into()
    }
}

impl<'a> Certifier<'a> {
    /// Creates a certifier for a tool at a part.
    ///
    /// # Errors
    /// [`NotCertifiable`] if the tool has no profile and no bound is proved on the rate at which its depth changes.
    pub fn new(bvh: &'a TriangleBvh, tool: &'a dyn Tool) -> Result<Certifier<'a>, NotCertifiable> {
        Certifier::of(Handle::Borrowed(bvh), ToolHandle::Borrowed(tool))
    }

    /// Creates a certifier that shares its part and its tool, so that a struct or a thread can hold all three.
    ///
    /// # Errors
    /// As for [`Certifier::new`].
    pub fn shared(
        bvh: Arc<TriangleBvh>,
        tool: Arc<dyn Tool>,
    ) -> Result<Certifier<'static>, NotCertifiable> {
        Certifier::of(Handle::Shared(bvh), ToolHandle::Shared(tool))
    }

    fn of(
        bvh: Handle<'a, TriangleBvh>,
        tool: ToolHandle<'a>,
    ) -> Result<Certifier<'a>, NotCertifiable> {
        let (info, level) = (tool.info(), Level::new());
        let length = info.unit.factor_to(bvh.unit());
        let setup = QuerySetup::new(&bvh.frame, info, length);
        let part = f64::from(bvh.frame.size) * bvh.frame.scale / length;
        let point_error = rounding::point_error_bound(info, part);
        let Some(tool_model) = ToolModel::new(&tool, level, point_error) else {
            return Err(NotCertifiable { tool: info.name.to_string() });
        };
        let error = tool_model.depth_error(point_error);
        let surfaces = info.surfaces.len();
        let (size, exact) = (info.size(), info.is_exact());
        let core_points = CorePoints::whole(info);
        let setting =
            QuerySetting { bvh, tool, tool_model, size, exact, setup, level, length, error };
        let whole_query = setting.depth_query(0.0, |_| true);
        Ok(Certifier {
            whole_query,
            surface_queries: (0..surfaces).map(|_| None).collect(),
            surface_max_depths: vec![None; surfaces],
            allowances: Allowances { depths: vec![0.0; surfaces], queries: None },
            core_points: core_points.clone(),
            whole_core_points: core_points,
            surface_core_points: (0..surfaces).map(|_| None).collect(),
            clearance_query: None,
            budget: 1 << 20,
            state: SearchState::default(),
            sweeper: Sweeper::default(),
            setting,
        })
    }

    /// Returns the least tolerance of [`Certifier::check_motion`], in the part's unit, for motions along poses without an error of their
    /// own that are no faster than the part is large: a lower one is taken as that. It grows with the extent of the part.
    pub fn least_motion_tolerance(&self) -> f64 {
        let Certifier { setting, .. } = self;
        2.0 * motion_depth::MIN_SWEEP_TOLERANCE * setting.error * setting.length
    }

    /// Sets the budget of a query: the number of nodes, triangles and intervals of edges that it may examine. When
    /// the budget is spent, the answer is the bound proved until then. The default is 2^20.
    #[must_use]
    pub fn with_budget(mut self, budget: u32) -> Certifier<'a> {
        self.budget = budget;
        self
    }

    /// Sets the SIMD level. The default is the best of this machine.
    #[must_use]
    pub fn with_level(mut self, level: Level) -> Certifier<'a> {
        self.setting.level = level;
        if let ToolModel::Field(field) = &mut self.setting.tool_model {
            field.level = level;
        }
        self
    }

    /// Sets the allowance of a surface: the depth in the part, in the part's unit, that it may have where it is the
    /// nearest surface. Infinity allows any depth. A negative allowance is a margin: the distance that the surface
    /// has to keep from all of the part. [`Certifier::check_pose`] and [`Certifier::check_motion`] use the
    /// allowances; the default is 0.
    ///
    /// # Errors
    /// [`AllowanceError::NoSurface`] if there is no such surface, [`AllowanceError::NoLength`] if the allowance is
    /// NaN or negative infinity. [`AllowanceError::NoMargin`] if it is negative and the tool has no profile: the
    /// distances of outside points from each surface are then unknown.
    pub fn with_allowance(
        mut self,
        surface: &str,
        allowed: f64,
    ) -> Result<Certifier<'a>, AllowanceError> {
        self.allow(surface, allowed)?;
        Ok(self)
    }

    /// Sets the allowances of several surfaces, as [`Certifier::with_allowance`] does. The last one of a surface holds.
    ///
    /// # Errors
    /// All that are wrong.
    pub fn with_allowances<'n>(
        mut self,
        allowances: impl IntoIterator<Item = (&'n str, f64)>,
    ) -> Result<Certifier<'a>, AllowanceErrors> {
        let allowances = allowances.into_iter();
        let errors = allowances.filter_map(|(surface, allowed)| self.allow(surface, allowed).err());
        let errors: Vec<AllowanceError> = errors.collect();
        if errors.is_empty() { Ok(self) } else { Err(AllowanceErrors(errors)) }
    }

    fn allow(&mut self, surface: &str, allowed: f64) -> Result<(), AllowanceError> {
        if allowed.is_nan() || allowed / self.setting.length == f64::NEG_INFINITY {
            return Err(AllowanceError::NoLength { surface: surface.to_owned(), allowed });
        }
        let Some(SurfaceId(index)) = self.setting.info().surface_named(surface) else {
            let surfaces = self.setting.info().surfaces.iter();
            let known: Vec<String> = surfaces.map(|s| format!("`{}`", s.name)).collect();
            return Err(AllowanceError::NoSurface {
                tool: self.setting.info().name.to_string(),
                surface: surface.to_owned(),
                known: known.join(", "),
            });
        };
        if let (ToolModel::Field(_), true) = (&self.setting.tool_model, allowed < 0.0) {
            let (tool, surface) = (self.setting.info().name.to_string(), surface.to_owned());
            return Err(AllowanceError::NoMargin { tool, surface });
        }
        self.allowances.depths[index] = allowed;
        self.allowances.queries = None;
        let length = self.setting.length;
        self.core_points =
            CorePoints::new(self.allowances.depths.iter().map(|depth| depth / length));
        Ok(())
    }

    /// Computes the deepest penetration of the part's triangles into the tool. The interval is at most as wide as the
    /// tolerance, in the part's unit, plus the rounding error bound. A tolerance below that bound, 0 or NaN is replaced
    /// by it. The interval is wider where triangles are thinner than the tolerance, or if the budget is spent.
    pub fn deepest(&mut self, pose: &Pose, tolerance: f64) -> Penetration {
        let Certifier { setting, whole_query, state, budget, .. } = self;
        let goal = PenetrationGoal { tolerance, threshold: 0.0, budget: *budget };
        penetration(setting, whole_query, state, pose, goal)
    }

    /// Computes the deepest penetration where one surface is the nearest.
    /// Points as near to two surfaces count for both. For a tool without a profile, the nearest surface of a point is
    /// that of the region that contains it. The interval is that of [`Certifier::deepest`].
    ///
    /// # Errors
    /// If there is no such surface.
    pub fn deepest_on(
        &mut self,
        surface: SurfaceId,
        pose: &Pose,
        tolerance: f64,
    ) -> Result<Penetration, NoSuchSurface> {
        let surface = self.checked(surface)?;
        let Certifier { setting, surface_queries, state, budget, .. } = self;
        let query = surface_queries[surface]
            .get_or_insert_with(|| setting.depth_query(0.0, |other| other == surface));
        let goal = PenetrationGoal { tolerance, threshold: 0.0, budget: *budget };
        Ok(penetration(setting, query, state, pose, goal))
    }

    /// Checks whether the tool is clear of the part, or at most as deep in it as is
    /// [allowed](Certifier::with_allowance). The search stops at the first point that is deeper.
    pub fn check_pose(&mut self, pose: &Pose) -> PoseVerdict {
        let Certifier { setting, whole_query, allowances, core_points, state, budget, .. } = self;
        let [depths, margins] = allowances.queries(setting, whole_query);
        match touches(setting, depths, state, pose, setting.error, *budget) {
            ContactVerdict::Yes(witness) => return PoseVerdict::Touching(witness),
            ContactVerdict::Undecided(high) => return PoseVerdict::Undecided(high),
            ContactVerdict::No => {}
        }
        // A tool inside the material is at some distance from its surface, too: margins come last.
        let clear = match setting.containment(core_points, pose, rounding::APART * setting.error) {
            Containment::Inside(surface) => return PoseVerdict::Inside(surface),
            Containment::Undecided => return PoseVerdict::Undecided(0.0),
            Containment::Outside => PoseVerdict::Clear,
            Containment::Unknown => PoseVerdict::SurfaceOnly,
        };
        match touches(setting, margins, state, pose, setting.error, *budget) {
            ContactVerdict::Yes(witness) => PoseVerdict::Near(witness),
            ContactVerdict::Undecided(high) => PoseVerdict::Undecided(high),
            ContactVerdict::No => clear,
        }
    }

    /// Locates the restricted interior of the tool relative to the part: the points deeper than is
    /// [allowed](Certifier::with_allowance). The answer holds only if [`Certifier::touches`] finds no triangle in contact.
    pub fn containment(&mut self, pose: &Pose) -> Containment {
        let error = rounding::APART * self.setting.error;
        self.setting.containment(&mut self.core_points, pose, error)
    }

    /// Returns whether the whole tool is inside the material and touches no triangle, whatever the allowances.
    /// Returns `None` if that is unknown: the part has no inside, rounding decides, or the budget is spent.
    pub fn is_buried(&mut self, pose: &Pose) -> Option<bool> {
        let Certifier { setting, whole_query, whole_core_points, state, budget, .. } = self;
        match touches(setting, slice::from_ref(whole_query), state, pose, setting.error, *budget) {
            ContactVerdict::Yes(_) => Some(false),
            ContactVerdict::Undecided(_) => None,
            ContactVerdict::No => {
                let error = rounding::APART * setting.error;
                setting.containment(whole_core_points, pose, error).is_inside()
            }
        }
    }

    /// Returns whether some of the tool is inside the material where no triangle reaches: of the points of the tool that are deeper than
    /// `depth`, the upper bound of [`Certifier::deepest`] at the pose. Such a piece is wholly inside or wholly outside, since no triangle
    /// meets it. A tool whose surface coincides with the part's has no depth, and is in the material all the same.
    /// Returns `None` if that is unknown: the part has no inside, rounding decides, or the tool has no profile and touches.
    pub fn is_inside(&mut self, pose: &Pose, depth: f64) -> Option<bool> {
        self.located_piece(pose, depth).0.is_inside()
    }

    /// Locates the pieces of the tool that are deeper than the triangles. Returns also the radius of a ball in both the tool and the
    /// material, in the part's unit, or 0 if none is known.
    fn located_piece(&mut self, pose: &Pose, depth: f64) -> (Containment, f64) {
        let Certifier { setting, whole_core_points, .. } = self;
        let error = rounding::APART * setting.error;
        let tolerance = error.max(depth / setting.length + error);
        // The points for each depth anew would be a search of its own for a tool without a profile.
        let is_new = tolerance > 2.0 * error;
        if is_new && matches!(setting.tool_model, ToolModel::Field(_)) {
            return (Containment::Undecided, 0.0);
        }
        let location = setting.containment(whole_core_points, pose, tolerance);
        let ball = match location {
            Containment::Inside(_) => setting.common_ball(whole_core_points, pose, tolerance),
            _ => 0.0,
        };
        (location, ball)
    }

    /// Returns an upper bound on the depth that a surface can have, in the
    /// part's unit. The depth occurs where the part's surface passes through the deepest point of the tool to which
    /// that surface is the nearest. The bound is at most 1 % above it unless a fixed budget is spent first; `None` if
    /// the budget is spent before any such point is found.
    ///
    /// # Errors
    /// If there is no such surface.
    pub fn max_possible_depth(&self, surface: SurfaceId) -> Result<Option<f64>, NoSuchSurface> {
        let surface = self.checked(surface)?;
        let depth = max_possible_depth(&self.setting, surface);
        Ok(depth.map(|depth| depth * self.setting.length))
    }

    /// Returns a surface's position in the tool's list, if the tool has it.
    fn checked(&self, surface: SurfaceId) -> Result<usize, NoSuchSurface> {
        let count = self.setting.info().surfaces.len();
        if surface.0 < count {
            return Ok(surface.0);
        }
        Err(NoSuchSurface { tool: self.setting.info().name.to_string(), count, surface })
    }

    /// Returns whether the restricted interior is one connected piece: the points deeper than their limit by more
    /// than twice the rounding error, as in [`Certifier::is_too_deep`].
    pub fn is_one_piece(&mut self) -> bool {
        self.setting.is_one_piece(&mut self.core_points, self.setting.error)
    }

    /// Resets the starting triangle, as if no query had been made. Answers within the tolerance may depend on it, so equal
    /// queries after it have equal bits.
    pub fn clear_caches(&mut self) {
        self.state.clear_cache();
    }

    /// Checks whether a triangle of the part is deeper in the tool than is [allowed](Certifier::with_allowance), or else nearer
    /// than a margin. A tool wholly inside the material touches none.
    pub fn touches(&mut self, pose: &Pose) -> ContactVerdict {
        let Certifier { setting, whole_query, allowances, state, budget, .. } = self;
        let [depths, margins] = allowances.queries(setting, whole_query);
        match touches(setting, depths, state, pose, setting.error, *budget) {
            ContactVerdict::No => touches(setting, margins, state, pose, setting.error, *budget),
            found => found,
        }
    }

    /// Runs a query for each item of a list, such as a pose or a motion, on all cores, and returns the results in its
    /// order. Answers within a tolerance may depend on the query before: each stretch of 64 items begins
    /// [without one](Certifier::clear_caches), so that equal lists have equal results on any number of cores.
    #[cfg(feature = "parallel")]
    pub fn par_map<I: Sync, R: Send>(
        &self,
        items: &[I],
        query: impl Fn(&mut Certifier<'a>, &I) -> R + Sync,
    ) -> Vec<R> {
        const ITEMS_PER_TASK: usize = 64;
        let run = |certifier: &mut Certifier<'a>, items: &[I]| {
            certifier.clear_caches();
            let one = |item| {
                cancellation::check();
                query(certifier, item)
            };
            items.iter().map(one).collect()
        };
        parallel::stretches(items, ITEMS_PER_TASK, || self.clone(), run)
    }

    /// Returns whether a point in world coordinates is certainly deeper than is [allowed](Certifier::with_allowance), in a tool
    /// that its tip and its axis, a unit vector, place: a tool with a profile.
    pub fn is_too_deep(
        &mut self,
        tip: &Point3<f64>,
        axis: &Vector3<f64>,
        point: &Point3<f64>,
    ) -> bool {
        let Certifier { setting, whole_query, allowances, state, .. } = self;
        let offset = (point - tip) / setting.length;
        let z = offset.dot(axis);
        let d = (offset.norm_squared() - z * z).max(0.0).sqrt();
        let [depths, _] = allowances.queries(setting, whole_query);
        depths.iter().any(|query| {
            state.depth(setting, query, [d, 0.0, z]) > query.limit + rounding::TOUCH * setting.error
        })
    }
}

/// The queries for the distance of some surfaces: the depth of points inside the tool, and the distance of those
/// outside.
#[derive(Clone)]
struct ClearanceQuery {
    surfaces: Vec<SurfaceId>,
    inside: DepthQuery,
    outside: DepthQuery,
}

impl Certifier<'_> {
    /// Computes the distance of the part's triangles from the tool. The interval is at most as wide as the tolerance,
    /// in the part's unit, plus the rounding error bound. It is 0 in contact. For a tool inside the material it is
    /// the distance to the part's surface.
    pub fn clearance(&mut self, pose: &Pose, tolerance: f64) -> Clearance {
        let Certifier { setting, whole_query, state, budget, .. } = self;
        distance(setting, [whole_query, whole_query], state, pose, tolerance, *budget)
    }

    /// Computes the signed distance of the tool from the part: the distance where they are apart, and below 0 the depth of
    /// the deepest point of the part's triangles in the tool. Both bounds are proved, and as wide as those of
    /// [`Certifier::deepest`] and [`Certifier::clearance`]; 0 is between them where rounding decides.
    ///
    /// A tool that is inside the material and touches no triangle has to move at least by its distance from the surface to come out,
    /// or by a ball that it and the material share, if its surface coincides with the part's: the upper bound is below 0, and there
    /// is no lower one. Of a part without an inside only the surface counts.
    ///
    /// ```
    /// use nalgebra::{Point3, Vector3};
    /// use touchoff::certify::{Certifier, TriangleBvh};
    /// use touchoff::{Pose, Unit, mesh::shapes};
    /// # touchoff::tool! {
    /// #     tool Ball "6 mm ball" {
    /// #         units mm;
    /// #         profile { start (0, 0); arc to (0, 6) center (0, 3) as ball cutting; }
    /// #         niceness cutting: 1;
    /// #     }
    /// # }
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let block = shapes::cuboid(Point3::new(-20., -20., -10.), Point3::new(20., 20., 0.), Unit::Millimetre)?;
    /// let bvh = TriangleBvh::new(&block);
    /// let mut certifier = Certifier::new(&bvh, &Ball)?;
    /// for height in [-0.5, 0.25] {
    ///     let pose = Pose::from_axis(Point3::new(1.0, 2.0, height), Vector3::z())?;
    ///     let distance = certifier.signed_distance(&pose, 1e-9);
    ///     assert!(distance.contains(height) && distance.width() < 2e-9);
    /// }
    /// # Ok(()) }
    /// ```
    pub fn signed_distance(&mut self, pose: &Pose, tolerance: f64) -> Interval {
        let depth = self.deepest(pose, tolerance).depth;
        if depth.low > 0.0 {
            return Interval::new(-depth.high, -depth.low);
        }
        let (location, ball) = self.located_piece(pose, depth.high);
        let distance = self.clearance(pose, tolerance).distance;
        match location {
            // A distance below the tolerance may be a contact.
            Containment::Outside | Containment::Unknown if distance.low == 0.0 => {
                Interval::new(-depth.high, distance.high)
            }
            Containment::Outside | Containment::Unknown => distance,
            // It may touch the surface from inside.
            Containment::Inside(_) => {
                let least = if distance.low > 0.0 { distance.low } else { ball };
                Interval::new(f64::NEG_INFINITY, 0.0 - least)
            }
            Containment::Undecided => Interval::new(f64::NEG_INFINITY, distance.high),
        }
    }

    /// Computes the distance of the part's triangles from some surfaces of the tool. The interval is that of
    /// [`Certifier::clearance`]. It is 0 if a point inside the tool is the nearest to one of these surfaces. For a point in a region
    /// of the tool that other surfaces own, it is the
    /// distance from the nearest of these surfaces. Without any surfaces it is infinite. For a tool without a profile
    /// the nearest surface is unknown (see [`Certifier::with_allowance`]): the lower bound is that of the whole tool,
    /// the upper bound infinite.
    ///
    /// # Errors
    /// If there is no such surface.
    pub fn clearance_of(
        &mut self,
        surfaces: &[SurfaceId],
        pose: &Pose,
        tolerance: f64,
    ) -> Result<Clearance, NoSuchSurface> {
        for surface in surfaces {
            self.checked(*surface)?;
        }
        if surfaces.is_empty() {
            let distance = Interval::new(f64::INFINITY, f64::INFINITY);
            return Ok(Clearance { distance, witness: None, on_tool: None });
        }
        if let ToolModel::Field(_) = &self.setting.tool_model {
            let Interval { low, .. } = self.clearance(pose, tolerance).distance;
            let distance = Interval::new(low, f64::INFINITY);
            return Ok(Clearance { distance, witness: None, on_tool: None });
        }
        let known = self.clearance_query.take().filter(|known| known.surfaces == surfaces);
        let ClearanceQuery { inside, outside, .. } =
            self.clearance_query.insert(known.unwrap_or_else(|| {
                // Any limit below 0 makes a query for the distance from the surfaces themselves.
                let [inside, outside] = [0.0, -1.0].map(|limit| {
                    self.setting.depth_query(limit, |k| surfaces.contains(&SurfaceId(k)))
                });
                ClearanceQuery { surfaces: surfaces.to_vec(), inside, outside }
            }));
        let queries = [&*inside, &*outside];
        Ok(distance(&self.setting, queries, &mut self.state, pose, tolerance, self.budget))
    }
}

/// Returns an upper bound on the depth that a surface can have, in the tool's unit.
fn max_possible_depth(setting: &QuerySetting<'_>, surface: usize) -> Option<f64> {
    match &setting.tool_model {
        ToolModel::Profile(ProfileModel { section, .. }) => {
            Some(Owners::of(section, |other| other == surface).greatest_depth(section))
        }
        ToolModel::Field(field) => {
            let owners =
                Owners::of_regions(setting.info(), |_, region| region.surface.0 == surface);
            field.greatest_depth(&owners)
        }
    }
}

/// Computes the distance of the nearest point, or 0 if one is inside.
fn distance(
    setting: &QuerySetting<'_>,
    [inside, outside]: [&DepthQuery; 2],
    state: &mut SearchState,
    pose: &Pose,
    tolerance: f64,
    budget: u32,
) -> Clearance {
    // A depth is certain to be above 0 if it is found to be more than two errors: its own, and that by which slabs
    // are widened.
    let touch = rounding::TOUCH * setting.error;
    let goal = Goal { threshold: -touch, tolerance: touch, stop_depth: touch, budget };
    state.inside(setting, inside, pose, goal);
    if let Some(best) = &state.best {
        let (witness, on_tool) = (setting.witness(best, pose), setting.tool_point(best, pose));
        let high = if state.search.is_done() { 0.0 } else { 2.0 * touch + state.search.skew };
        let distance = Interval::new(0.0, high * setting.length);
        return Clearance { distance, witness: Some(witness), on_tool };
    }
    // Nodes left open may be inside: then no distance above 0 is proved.
    let unsure = state.search.has_open();
    // The rounding error grows with the distance.
    let error = setting.error + rounding::distance_error_bound(state.max_distance());
    // Written so that a NaN tolerance is replaced.
    let tolerance = (rounding::APART * error).max(tolerance / setting.length);
    let [threshold, stop_depth] = [f64::NEG_INFINITY, f64::INFINITY];
    state.outside(setting, outside, pose, Goal { threshold, tolerance, stop_depth, budget });
    let more = error + state.search.skew;
    let low = -state.search.threshold().max(state.search.open_bound) - more;
    let low = if unsure { 0.0 } else { low.max(0.0) };
    // For a point outside, a depth field gives only a lower bound of the distance.
    let high = if setting.exact { -state.search.best + more } else { f64::INFINITY };
    Clearance {
        distance: Interval::new(low, high).scaled_by(setting.length),
        witness: state.best.as_ref().map(|best| setting.witness(best, pose)),
        on_tool: state.best.as_ref().and_then(|best| setting.tool_point(best, pose)),
    }
}

/// The result of comparing the depth of triangles with the allowances.
#[derive(Clone, Debug)]
pub enum ContactVerdict {
    /// No triangle is deeper than is allowed.
    No,
    /// A point of a triangle is deeper.
    Yes(Witness),
    /// Rounding decides, or the budget is spent: no triangle exceeds its allowance by more than this, in the part's unit.
    Undecided(f64),
}

/// Checks whether a triangle is deeper than the rules allow, for points of the tool with the given error, in its unit.
fn touches(
    setting: &QuerySetting<'_>,
    allowance_queries: &[DepthQuery],
    state: &mut SearchState,
    pose: &Pose,
    error: f64,
    budget: u32,
) -> ContactVerdict {
    let touch = rounding::TOUCH * error;
    let mut undecided: Option<f64> = None;
    for query in allowance_queries {
        let threshold = query.limit - touch;
        let stop_depth = query.limit + touch;
        let goal = Goal { threshold, tolerance: touch, stop_depth, budget };
        if query.limit < 0.0 {
            setting.set_pose(state, pose);
            state.outside(setting, query, pose, goal);
        } else {
            state.inside(setting, query, pose, goal);
        }
        if let Some(best) = &state.best
            && state.search.is_done()
        {
            return ContactVerdict::Yes(setting.witness(best, pose));
        }
        if state.best.is_some() || state.search.has_open() {
            let high =
                state.search.open_bound.max(state.search.threshold()) + touch + state.search.skew;
            undecided = Some(undecided.unwrap_or(0.0).max(high - query.limit));
        }
    }
    undecided.map_or(ContactVerdict::No, |high| ContactVerdict::Undecided(high * setting.length))
}

/// The goal of a search for the deepest point.
#[derive(Clone, Copy)]
struct PenetrationGoal {
    /// The tolerance of the depth, in the part's unit.
    tolerance: f64,
    /// A depth that is known already, in the tool's unit: only deeper points are searched for.
    threshold: f64,
    budget: u32,
}

/// Computes the deepest penetration of a query.
fn penetration(
    setting: &QuerySetting<'_>,
    query: &DepthQuery,
    state: &mut SearchState,
    pose: &Pose,
    goal: PenetrationGoal,
) -> Penetration {
    let PenetrationGoal { tolerance, threshold, budget } = goal;
    // Written so that a NaN tolerance is replaced.
    let tolerance = (rounding::APART * setting.error).max(tolerance / setting.length);
    let least = setting.error.max(threshold);
    let goal = Goal { threshold: least, tolerance, stop_depth: f64::INFINITY, budget };
    state.inside(setting, query, pose, goal);
    let more = setting.error + state.search.skew;
    let (low, high) = match state.best {
        // Slabs are widened by the error, so a point outside may be measured as that deep.
        Some(_) => (state.search.best - more - setting.error, state.search.best + tolerance),
        None => (0.0, least),
    };
    let high = if state.descent.started() { high.max(state.search.open_bound) + more } else { 0.0 };
    Penetration {
        depth: Interval::new(low.max(0.0), high).scaled_by(setting.length),
        witness: state.best.as_ref().map(|best| setting.witness(best, pose)),
    }
}
