//! The workpiece, ready to be felt.

use crate::Unit;
use crate::cloud::{Cloud, CloudError};
use crate::mesh::{Mesh, StlError, Survey};
use crate::tree::Tree;
use std::path::Path;

/// A part: its points in their tree, and what was found out about its mesh.
#[derive(Clone, Debug)]
pub struct Part {
    /// The finest first; each of the others has some of the points of the one before.
    levels: Vec<Tree>,
    unit: Unit,
    survey: Option<Survey>,
}

/// A part that could not be made.
#[derive(Debug, thiserror::Error)]
pub enum PartError {
    /// The mesh could not be read.
    #[error(transparent)]
    Stl(#[from] StlError),
    /// The cloud could not be made.
    #[error(transparent)]
    Cloud(#[from] CloudError),
}

impl Part {
    /// A part from an STL file, whose lengths are in `unit`, its points as [`Part::from_mesh`]
    /// spreads them.
    pub fn read_stl(
        path: impl AsRef<Path>,
        unit: Unit,
        points: usize,
        seed: u64,
    ) -> Result<Part, PartError> {
        Ok(Part::from_mesh(&Mesh::read_stl(path, unit)?, points, seed)?)
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

    /// A part from a cloud.
    pub fn from_cloud(cloud: &Cloud) -> Part {
        Part { levels: vec![Tree::new(cloud)], unit: cloud.unit(), survey: None }
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

    /// The points in their tree.
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
