//! The workpiece, prepared for queries.

use crate::cloud::{Cloud, CloudError, CoveringRadius, Sampling, check_position, unit_normal};
use crate::handle::Handle;
use crate::mesh::{Geometry, GeometryError, Mesh, MeshDiagnostics};
use crate::point_bvh::{Enclosure, PointBvh, TreePoint};
use crate::pose::Pose;
use crate::probe::{BudgetError, Law, LodProbe, PartPoints, Probe};
use crate::tool::{BatchEvaluator, Tool};
use crate::unit::Unit;
use nalgebra::{Point3, Vector3};
use std::path::Path;
use std::sync::Arc;

/// Minimum number of points of a part's coarsest level.
const MIN_LEVEL_POINTS: usize = 100;

/// A part: its points in a bounding volume hierarchy, and the diagnostics of its mesh.
#[derive(Clone, Debug)]
pub struct Part {
    /// The levels of detail, the finest first; each level has a subset of the points of the level before.
    pub(crate) levels: Vec<PointBvh>,
    pub(crate) unit: Unit,
    pub(crate) diagnostics: Option<MeshDiagnostics>,
}

/// Reasons why a part could not be built.
#[derive(thiserror::Error)]
#[non_exhaustive]
pub enum PartError {
    /// The file could not be read.
    #[error(transparent)]
    Geometry(#[from] GeometryError),
    /// The cloud could not be built.
    #[error(transparent)]
    Cloud(#[from] CloudError),
}

crate::debug_as_sentence!(PartError);

impl Part {
    /// Reads a part from a file whose lengths are in `unit`. A mesh in STL, PLY or OBJ is sampled as by
    /// [`Part::from_mesh`]; points with normals in PLY are all used, as by [`Cloud::from_points`].
    ///
    /// # Errors
    /// Fails if the file cannot be read or the cloud cannot be built.
    pub fn read(path: impl AsRef<Path>, unit: Unit, sampling: Sampling) -> Result<Part, PartError> {
        Ok(match Geometry::read(path, unit)? {
            Geometry::Mesh(mesh) => Part::from_mesh(&mesh, sampling)?,
            Geometry::Points(points) => Part::from_cloud(&Cloud::from_points(points, unit)?),
        })
    }

    /// Builds a part from a mesh whose surface is sampled. Equal meshes and samplings give equal parts.
    ///
    /// # Errors
    /// See [`Cloud::sample`].
    pub fn from_mesh(mesh: &Mesh, sampling: Sampling) -> Result<Part, CloudError> {
        Ok(Part::new(&Cloud::sample(mesh, sampling)?, mesh.diagnostics()))
    }

    /// Builds a part from a cloud on a mesh and the mesh's diagnostics.
    pub fn new(cloud: &Cloud, diagnostics: MeshDiagnostics) -> Part {
        Part { diagnostics: Some(diagnostics), ..Part::from_cloud(cloud) }
    }

    /// Builds a part as [`Part::from_mesh`] does, with coarser levels of detail. Each has a quarter of the points of
    /// the level before, spread as evenly, with its own weights and covering radius, down to some hundred points.
    /// [`LodProbe`](crate::LodProbe) chooses among them; all other queries use the finest.
    ///
    /// # Errors
    /// See [`Cloud::sample`].
    pub fn with_lods(mesh: &Mesh, sampling: Sampling) -> Result<Part, CloudError> {
        let mut cloud = Cloud::sample(mesh, sampling)?;
        let mut part = Part::new(&cloud, mesh.diagnostics());
        while cloud.len() >= 4 * MIN_LEVEL_POINTS {
            cloud = cloud.decimated(mesh, cloud.len() / 4);
            part.levels.push(PointBvh::new(&cloud));
        }
        Ok(part)
    }

    /// Builds a part from a cloud, without mesh diagnostics.
    pub fn from_cloud(cloud: &Cloud) -> Part {
        Part { levels: vec![PointBvh::new(cloud)], unit: cloud.unit(), diagnostics: None }
    }

    /// Removes the points inside a tool at a pose, namely those deeper than the sampling error bound
    /// ([`Probe::sampling_error_bound`]). Returns the number of points removed from all levels. The tree
    /// is not rebuilt.
    ///
    /// The nearest point of every remaining surface point is still there: if it had been removed, the surface point
    /// would be inside the tool as well. The covering radius therefore holds for the remaining surface. Points near the
    /// rim of the removed surface remain, no deeper than the bound. The new surface left by a cut has no points, and no
    /// query knows of it. A coarse level whose bound exceeds the tool's depth loses no points. If the bound is unknown,
    /// because the tool has no Lipschitz constant or the cloud no covering radius, all points inside are removed and
    /// the covering radius becomes unknown.
    pub fn cut(&mut self, tool: &dyn Tool, pose: &Pose) -> usize {
        let mut removed = 0;
        for tree in &mut self.levels {
            let mut probe = Probe::of(PartPoints::Level(tree), self.unit, Handle::Borrowed(tool));
            let error_bound = probe.sampling_error_bound();
            let indices = probe.deeper(pose, error_bound.unwrap_or(-1.0));
            removed += indices.len();
            if indices.is_empty() {
                continue;
            }
            if error_bound.is_none() {
                tree.covering_radius = None;
            }
            tree.remove(indices);
        }
        removed
    }

    /// Moves points and rotates their unit normals: `map` takes a point with its normal and returns the new
    /// ones. The tree is not rebuilt, so queries get slower as neighbours move apart. Weights are unchanged.
    ///
    /// The covering radius grows by twice the largest displacement of a point. This is a bound if no surface point
    /// between the points moves farther, which only the caller can know, so the radius counts as estimated afterwards.
    ///
    /// # Errors
    /// Fails for an invalid position or normal; no point has moved then.
    pub fn displace(
        &mut self,
        mut map: impl FnMut(Point3<f64>, Vector3<f64>) -> (Point3<f64>, Vector3<f64>),
    ) -> Result<(), CloudError> {
        // All points are checked before any is moved.
        let mut levels = Vec::new();
        for tree in &self.levels {
            let mut moved_points = Vec::new();
            for TreePoint { slot, position, normal } in tree.all() {
                let (new_position, new_normal) = map(position, normal);
                if new_position != position || new_normal != normal {
                    check_position(slot, &new_position)?;
                    moved_points.push(TreePoint {
                        slot,
                        position: new_position,
                        normal: unit_normal(slot, new_normal)?,
                    });
                }
            }
            levels.push(moved_points);
        }
        for (tree, moved) in
            self.levels.iter_mut().zip(&levels).filter(|(_, moved)| !moved.is_empty())
        {
            let max_displacement = tree.replace(moved);
            tree.covering_radius = tree.covering_radius.map(|CoveringRadius { radius, .. }| {
                CoveringRadius { radius: radius + 2.0 * max_displacement, proved: false }
            });
        }
        Ok(())
    }

    /// Converts the part to another unit: its numbers are multiplied, its points and its tree remain.
    #[must_use]
    pub fn converted_to(mut self, unit: Unit) -> Part {
        if unit != self.unit {
            // The tree stays as it is: only its frame is in the part's unit.
            let factor = self.unit.factor_to(unit);
            self.levels.iter_mut().for_each(|tree| tree.scale_by(factor));
            self.diagnostics = self.diagnostics.map(|diagnostics| diagnostics.to(unit));
            self.unit = unit;
        }
        self
    }

    /// Returns the trees of all levels, the finest first.
    pub(crate) fn levels(&self) -> &[PointBvh] {
        &self.levels
    }

    /// Returns the tree of the finest level.
    pub fn tree(&self) -> &PointBvh {
        &self.levels[0]
    }

    /// Returns the unit of every length of the part.
    pub fn unit(&self) -> Unit {
        self.unit
    }

    /// Returns the diagnostics of the mesh, or `None` for a part built from points alone.
    pub fn diagnostics(&self) -> Option<&MeshDiagnostics> {
        self.diagnostics.as_ref()
    }

    /// Returns the findings about the part, a sentence each: those about its mesh ([`MeshDiagnostics::findings`]); of a part of points,
    /// whether their normals face into the material, or may do so. That is decided by whether the surface closes around the side that
    /// the normals face. Of points on a plane it cannot be known.
    pub fn findings(&self) -> Vec<String> {
        match &self.diagnostics {
            Some(diagnostics) => diagnostics.findings(),
            None => Enclosure::of(self.tree()).finding().into_iter().collect(),
        }
    }
}

impl<'a, T: BatchEvaluator + ?Sized> Probe<'a, T> {
    /// Creates a probe with the gradient law, area weights and the tip as compliance centre.
    pub fn new(part: &'a Part, tool: &'a T) -> Probe<'a, T> {
        Probe::of(PartPoints::Level(part.tree()), part.unit(), Handle::Borrowed(tool))
    }

    /// Creates the same probe, which shares its part and its tool, so that a struct or a thread can hold all three.
    ///
    /// ```
    /// # use std::sync::Arc;
    /// # use touchoff::{Part, Probe, Sampling, Tool, scenes};
    /// struct Hand {
    ///     probe: Probe<'static>,
    /// }
    ///
    /// # fn grasp(tool: Arc<dyn Tool>) -> Result<Hand, touchoff::CloudError> {
    /// let part = Part::from_mesh(&scenes::tube(), Sampling::new(1_000))?;
    /// let hand = Hand { probe: Probe::shared(Arc::new(part), tool) };
    /// # Ok(hand) }
    /// ```
    pub fn shared(part: Arc<Part>, tool: Arc<T>) -> Probe<'a, T> {
        let unit = part.unit();
        Probe::of(PartPoints::Shared(part), unit, Handle::Shared(tool))
    }
}

impl<'a, T: BatchEvaluator + ?Sized> LodProbe<'a, T> {
    /// Creates a probe for a tool and a part with levels of detail, with a budget of nodes per query and a law.
    ///
    /// # Errors
    /// Fails if the budget is too small for the coarsest level at some pose of the tool.
    pub fn new(
        part: &'a Part,
        tool: &'a T,
        budget: usize,
        law: Law,
    ) -> Result<LodProbe<'a, T>, BudgetError> {
        LodProbe::of(part.levels().iter().rev(), part.unit(), tool, budget, law)
    }
}
