//! The workpiece, ready to be felt.

use crate::cloud::{Cloud, CloudError, Cover, check_place, unit_normal};
use crate::mesh::{Mesh, Shape, ShapeError, Survey};
use crate::pose::Pose;
use crate::probe::{BudgetError, Graded, Law, Probe};
use crate::tool::{Senses, Tool};
use crate::tree::Tree;
use crate::unit::Unit;
use nalgebra::{Point3, Vector3};
use std::path::Path;

/// The coarsest level of a part has as many points at least.
const FEWEST: usize = 100;

/// A part: its points in their tree, and what was found out about its mesh.
#[derive(Clone, Debug)]
pub struct Part {
    /// The finest first; each of the others has some of the points of the one before.
    pub(crate) levels: Vec<Tree>,
    pub(crate) unit: Unit,
    pub(crate) survey: Option<Survey>,
}

/// A part that could not be made.
#[derive(Debug, thiserror::Error)]
pub enum PartError {
    /// The file could not be read.
    #[error(transparent)]
    Shape(#[from] ShapeError),
    /// The cloud could not be made.
    #[error(transparent)]
    Cloud(#[from] CloudError),
}

impl Part {
    /// A part from a mesh in STL, PLY or OBJ, whose lengths are in `unit`, its points as
    /// [`Part::from_mesh`] spreads them; or from points with normals in PLY, all of them, as
    /// [`Cloud::from_points`] takes them.
    pub fn read(
        path: impl AsRef<Path>,
        unit: Unit,
        points: usize,
        seed: u64,
    ) -> Result<Part, PartError> {
        Ok(match Shape::read(path, unit)? {
            Shape::Mesh(mesh) => Part::from_mesh(&mesh, points, seed)?,
            Shape::Points(points) => Part::from_cloud(&Cloud::from_points(points, unit)?),
        })
    }

    /// A part from a mesh: `points` points spread evenly over the surface ([`Cloud::blue`]), the
    /// same for the same `seed`.
    pub fn from_mesh(mesh: &Mesh, points: usize, seed: u64) -> Result<Part, CloudError> {
        Ok(Part::new(&Cloud::blue(mesh, points, seed)?, mesh.survey()))
    }

    /// A part from a cloud on a mesh, and what was found out about that.
    pub fn new(cloud: &Cloud, survey: Survey) -> Part {
        Part { survey: Some(survey), ..Part::from_cloud(cloud) }
    }

    /// A part as [`Part::from_mesh`] makes it, with coarser levels: each has a quarter of the points of
    /// the one before, spread as evenly, with weights and a cover of their own, down to some hundred.
    /// [`Graded`](crate::Graded) chooses among them; all else asks the finest.
    pub fn detailed(mesh: &Mesh, points: usize, seed: u64) -> Result<Part, CloudError> {
        let mut cloud = Cloud::blue(mesh, points, seed)?;
        let mut part = Part::new(&cloud, mesh.survey());
        while cloud.len() >= 4 * FEWEST {
            cloud = cloud.thinned(mesh, cloud.len() / 4);
            part.levels.push(Tree::new(&cloud));
        }
        Ok(part)
    }

    /// A part from a cloud.
    pub fn from_cloud(cloud: &Cloud) -> Part {
        Part { levels: vec![Tree::new(cloud)], unit: cloud.unit(), survey: None }
    }

    /// Takes away what is inside a tool at a pose: the points that are deeper than what the cloud cannot
    /// see ([`Probe::unseen`]); how many, of all levels. The tree is not built anew.
    ///
    /// A place of the surface that is left has its nearest point where that was: if it had been taken
    /// away, the place would be inside the tool as well. So the cover holds for what is left of the
    /// surface. Of what is gone the points on its rim stay, no deeper than that; the new surface that a
    /// cut leaves has no points, and no question knows of it. Of a coarse level that sees less than the
    /// tool is deep nothing is taken. Where it is not known how steep depth is, or what the cover is, all
    /// points inside are taken, and no cover is known any more.
    pub fn cut(&mut self, tool: &dyn Tool, pose: &Pose) -> usize {
        let mut taken = 0;
        for tree in &mut self.levels {
            let mut probe = Probe::of(tree, self.unit, tool);
            let unseen = probe.unseen();
            let places = probe.deeper(pose, unseen.unwrap_or(-1.0));
            taken += places.len();
            if places.is_empty() {
                continue;
            }
            if unseen.is_none() {
                tree.cover = None;
            }
            tree.remove(places);
        }
        taken
    }

    /// Moves points and turns their unit normals, as `to` says for a point and its normal; the tree is
    /// not built anew, so queries get slower as neighbours part. Weights stay.
    ///
    /// The cover grows by twice how far the farthest point goes, which bounds it if no place between the
    /// points goes farther: that is the caller's word, so it counts as estimated from then on.
    ///
    /// # Errors
    /// A place or a normal that is none; nothing has moved then.
    pub fn displace(
        &mut self,
        mut to: impl FnMut(Point3<f64>, Vector3<f64>) -> (Point3<f64>, Vector3<f64>),
    ) -> Result<(), CloudError> {
        let mut moved = Vec::new();
        for tree in &self.levels {
            let mut here = Vec::new();
            for (place, point, normal) in tree.all() {
                let (there, turned) = to(point, normal);
                if there != point || turned != normal {
                    check_place(place, &there)?;
                    here.push((place, there, unit_normal(place, turned)?));
                }
            }
            moved.push(here);
        }
        for (tree, moved) in
            self.levels.iter_mut().zip(&moved).filter(|(_, moved)| !moved.is_empty())
        {
            let farthest = tree.put(moved);
            tree.cover = tree.cover.map(|Cover { radius, .. }| Cover {
                radius: radius + 2.0 * farthest,
                proved: false,
            });
        }
        Ok(())
    }

    /// The same part in another unit: its numbers are multiplied, its points and its tree stay.
    #[must_use]
    pub fn to(mut self, unit: Unit) -> Part {
        if unit != self.unit {
            let factor = self.unit.to(unit);
            self.levels.iter_mut().for_each(|tree| tree.scale_by(factor));
            self.survey = self.survey.map(|survey| survey.to(unit));
            self.unit = unit;
        }
        self
    }

    /// The points in their tree, the finest first.
    pub(crate) fn levels(&self) -> &[Tree] {
        &self.levels
    }

    /// The points in their tree: of several levels the finest.
    pub fn tree(&self) -> &Tree {
        &self.levels[0]
    }

    /// The unit of every length of the part.
    pub fn unit(&self) -> Unit {
        self.unit
    }

    /// What the mesh is like: closed, oriented, how large. `None` for a part made of points.
    pub fn survey(&self) -> Option<&Survey> {
        self.survey.as_ref()
    }
}

impl<'a, T: Senses + ?Sized> Probe<'a, T> {
    /// A probe with the thesis's law, area weights and the tip for a compliance centre.
    pub fn new(part: &'a Part, tool: &'a T) -> Probe<'a, T> {
        Probe::of(part.tree(), part.unit(), tool)
    }
}

impl<'a, T: Senses + ?Sized> Graded<'a, T> {
    /// A tool beside a part, with a budget of nodes a query, and a law.
    ///
    /// # Errors
    /// A budget that is not enough for the coarsest level wherever the tool is.
    pub fn new(
        part: &'a Part,
        tool: &'a T,
        budget: usize,
        law: Law,
    ) -> Result<Graded<'a, T>, BudgetError> {
        Graded::of(part.levels().iter().rev(), part.unit(), (tool, budget, law))
    }
}
