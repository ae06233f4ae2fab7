//! A job and the files that it names, read.

use super::file::{JobFile, NamedTool, StockEntry};
use super::program::Program;
use super::{Body, BodyRole, Job, JobError, JobStock, JobTool, PART, StockShape};
use nalgebra::Point3;
use std::path::{Path, PathBuf};
use touchoff::certify::TriangleBvh;
use touchoff::mesh::Geometry;
use touchoff::{Mesh, Tool, Unit};

/// A job and the files that it names, read. `T` is a tool, such as a `Box<dyn Tool>`.
#[derive(Debug)]
#[non_exhaustive]
pub struct JobInputs<T> {
    /// The job as it was stated.
    pub file: JobFile,
    /// The program.
    pub program: Program,
    /// The tools that the program uses, in the order of their first motions.
    pub tools: Vec<(NamedTool, T)>,
    /// The part, then the fixtures.
    pub bodies: Vec<JobBody>,
    /// The stock.
    pub stock: Option<JobStock>,
}

/// A part or a fixture, read from its file.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct JobBody {
    /// Its name in findings.
    pub name: String,
    /// The file of its mesh.
    pub file: PathBuf,
    /// Its mesh.
    pub mesh: Mesh,
    /// Its triangles.
    pub bvh: TriangleBvh,
    link: Option<usize>,
    role: BodyRole,
}

impl JobBody {
    /// Reads a body that moves with the workpiece.
    fn read(name: &str, file: &Path, unit: Unit, role: BodyRole) -> Result<JobBody, JobError> {
        let mesh = mesh(file, unit)?;
        let bvh = TriangleBvh::new(&mesh);
        Ok(JobBody { name: name.to_owned(), file: file.to_owned(), mesh, bvh, link: None, role })
    }

    /// Returns whether it moves with another axis than the workpiece. The tool's poses at it are then in its own frame.
    pub fn has_own_frame(&self) -> bool {
        self.link.is_some()
    }
}

impl<T: AsRef<dyn Tool>> JobInputs<T> {
    /// Reads program, part, fixtures and stock of a job. `load` loads a tool by its name.
    ///
    /// # Errors
    /// If a file cannot be read, or what they state does not fit together.
    pub fn read<E: From<JobError>>(
        file: JobFile,
        mut load: impl FnMut(&NamedTool) -> Result<T, E>,
    ) -> Result<JobInputs<T>, E> {
        let program = file.program()?;
        let mut tools = Vec::new();
        for named in file.used_tools(&program)? {
            let tool = load(&named)?;
            tools.push((named, tool));
        }
        let mut bodies = vec![JobBody::read(PART, &file.part, file.unit, BodyRole::Part)?];
        for fixture in &file.fixtures {
            let link = match &fixture.moves_with {
                None => None,
                Some(axis) => program.link(axis)?,
            };
            let role = BodyRole::Fixture { margin: fixture.margin };
            let body = JobBody::read(&fixture.name, &fixture.mesh, file.unit, role)?;
            bodies.push(JobBody { link, ..body });
        }
        let stock = file.stock.as_ref().map(|entry| stock(entry, file.unit)).transpose()?;
        Ok(JobInputs { file, program, tools, bodies, stock })
    }

    /// Returns the job.
    pub fn job(&self) -> Job<'_> {
        let mut job = Job::new(&self.program, &self.bodies[0].bvh);
        for body in &self.bodies[1..] {
            let mut fixture = Body::fixture(&body.name, &body.bvh);
            (fixture.link, fixture.role) = (body.link, body.role);
            job.bodies.push(fixture);
        }
        for (named, tool) in &self.tools {
            let mut tool = JobTool::of_all(tool.as_ref());
            (tool.motions, tool.hand) = (named.motions, named.hand);
            tool.allow.clone_from(&named.allow);
            job.tools.push(tool);
        }
        job.stock.clone_from(&self.stock);
        (job.tolerance, job.resolution) = (self.file.tolerance, self.file.resolution);
        job.allow.clone_from(&self.file.allow);
        (job.surface_only, job.anyway) = (self.file.surface_only, self.file.anyway);
        job
    }
}

fn mesh(file: &Path, unit: Unit) -> Result<Mesh, JobError> {
    match Geometry::read(file, unit)? {
        Geometry::Mesh(mesh) => Ok(mesh),
        Geometry::Points(_) => Err(JobError::NoTriangles { file: file.display().to_string() }),
    }
}

fn stock(entry: &StockEntry, unit: Unit) -> Result<JobStock, JobError> {
    let shape = match (&entry.mesh, entry.corners) {
        (Some(file), None) => StockShape::Mesh(mesh(file, unit)?),
        (None, Some(corners)) => StockShape::Box(corners.map(Point3::from)),
        _ => return Err(JobError::Mismatch("a stock has a `mesh` or a `box`, and not both")),
    };
    Ok(JobStock { shape, spacing: entry.spacing, tolerance: entry.tolerance })
}
