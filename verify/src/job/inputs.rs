//! A job and the files that it names, read.

use super::bodies::{self, LoadedBody};
use super::file::{JobFile, NamedTool, PartEntry, StockEntry};
use super::program::Program;
use super::{Body, BodyFrame, BodyRole, Job, JobError, JobStock, JobTool, PART, StockShape};
use crate::gcode::WorkOffset;
use crate::machine::{BodyShape, Machine};
use nalgebra::{Point3, Vector3};
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
    /// The part, then other parts, the fixtures and the meshes of the machine.
    pub bodies: Vec<JobBody>,
    /// The bodies of the machine that are solids of revolution.
    revolved: Vec<LoadedBody<T>>,
    /// The stock.
    pub stock: Option<JobStock>,
}

/// The part, another part, a fixture or a mesh of the machine, read.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct JobBody {
    /// Its name in findings.
    pub name: String,
    /// The file of its mesh; `None` for one that is made of numbers.
    pub file: Option<PathBuf>,
    /// Its mesh.
    pub mesh: Mesh,
    /// Its triangles.
    pub bvh: TriangleBvh,
    /// The frame of its triangles.
    pub frame: BodyFrame,
    /// How near the surfaces of a tool may come.
    pub role: BodyRole,
    /// The work offset of another part.
    pub work_offset: Option<WorkOffset>,
}

impl JobBody {
    /// Reads a body that moves with the workpiece.
    fn read(name: &str, file: &Path, unit: Unit, role: BodyRole) -> Result<JobBody, JobError> {
        let mesh = mesh(file, unit)?;
        let bvh = TriangleBvh::new(&mesh);
        let (name, file) = (name.to_owned(), Some(file.to_owned()));
        let (frame, work_offset) = (BodyFrame::Part, None);
        Ok(JobBody { name, file, mesh, bvh, frame, role, work_offset })
    }

    /// Reads another part, and puts it at its work offset.
    ///
    /// # Errors
    /// If its mesh cannot be read, or its place is not stated.
    fn read_other(
        entry: &PartEntry,
        job: &JobFile,
        program: &Program,
    ) -> Result<JobBody, JobError> {
        let index = entry.offset_index()?;
        let refused = |reason| JobError::OtherPart { name: entry.name(), reason };
        if program.machine().is_none() {
            return Err(refused(
                "other parts are for G-code, whose work offsets have a place: remove `[[other_part]]`",
            ));
        }
        let (Some(part), Some(other)) = (job.work_offsets[0], job.work_offsets[index]) else {
            return Err(refused("state its origin and that of G54 in `work_offsets`"));
        };
        // The frames of both are parallel then, and their origins apart by the difference.
        if part[3..] != other[3..] {
            return Err(refused(
                "its origin turns a rotary axis otherwise than that of G54: state the same angles, and turn its mesh",
            ));
        }
        let file = entry.mesh.as_deref().unwrap_or(&job.part);
        let mut body = JobBody::read(&entry.name(), file, job.unit, BodyRole::Part)?;
        let by = Vector3::from([0, 1, 2].map(|k| other[k] - part[k]));
        let by = by * Unit::Millimetre.factor_to(job.unit);
        let moved = bodies::moved(&body.mesh, |vertex| vertex + by, job.unit);
        body.mesh = moved.map_err(|source| JobError::MachineMesh { name: entry.name(), source })?;
        body.bvh = TriangleBvh::new(&body.mesh);
        body.work_offset = Some(WorkOffset::Standard(index as u8 + 1));
        Ok(body)
    }

    /// Returns whether it is another part than the first.
    pub fn is_other_part(&self) -> bool {
        self.work_offset.is_some()
    }

    /// Returns whether it is a fixture.
    pub fn is_fixture(&self) -> bool {
        matches!(self.role, BodyRole::Fixture { .. })
    }

    /// Returns whether it is a mesh of the machine, and neither the part nor a fixture.
    pub fn is_of_machine(&self) -> bool {
        matches!(self.role, BodyRole::Machine { .. })
    }

    /// Returns whether it moves with another axis than the workpiece. The tool's poses at it are then in its own frame.
    pub fn has_own_frame(&self) -> bool {
        self.frame != BodyFrame::Part
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
        for entry in &file.other_parts {
            bodies.push(JobBody::read_other(entry, &file, &program)?);
        }
        for fixture in &file.fixtures {
            let link = match &fixture.moves_with {
                None => None,
                Some(axis) => program.link(axis)?,
            };
            let role = BodyRole::Fixture { margin: fixture.margin };
            let body = JobBody::read(&fixture.name, &fixture.mesh, file.unit, role)?;
            let frame = link.map_or(BodyFrame::Part, BodyFrame::Table);
            bodies.push(JobBody { frame, ..body });
        }
        let mut revolved = Vec::new();
        if let Some(machine) = program.machine() {
            bodies.extend(bodies::meshes(machine, file.unit)?);
            revolved = bodies::revolved(machine, &bodies, file.unit, &mut load)?;
        }
        let stock = file.stock.as_ref().map(|entry| stock(entry, file.unit)).transpose()?;
        Ok(JobInputs { file, program, tools, bodies, revolved, stock })
    }

    /// Returns the files that it was read from, each with its role: those of [`JobFile::files`], and those of the machine's bodies.
    pub fn files(&self) -> Vec<(String, &Path)> {
        let mut files = self.file.files();
        let bodies = self.program.machine().map_or(&[][..], Machine::bodies).iter();
        files.extend(bodies.filter_map(|body| {
            let file = match &body.shape {
                BodyShape::Mesh { file, .. } => &**file,
                BodyShape::Tool { name, .. } if name.ends_with(".tool") => Path::new(name),
                _ => return None,
            };
            Some((body.name.clone(), file))
        }));
        files
    }

    /// Returns the job.
    pub fn job(&self) -> Job<'_> {
        let mut job = Job::new(&self.program, &self.bodies[0].bvh);
        for body in &self.bodies[1..] {
            let mut other = Body::fixture(&body.name, &body.bvh);
            (other.frame, other.role) = (body.frame, body.role);
            other.work_offset = body.work_offset;
            job.bodies.push(other);
        }
        job.revolved.extend(self.revolved.iter().map(LoadedBody::body));
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

pub(super) fn mesh(file: &Path, unit: Unit) -> Result<Mesh, JobError> {
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
