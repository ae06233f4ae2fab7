//! A job and the files that it names, read.

use super::bodies::{self, LoadedBody};
use super::file::{JobFile, NamedTool, PartEntry, StockEntry, has_ending};
use super::program::Program;
use super::report::Verdict;
use super::{
    Body, BodyFrame, BodyRole, Job, JobError, JobFileFault, JobGap, JobStock, JobTool, PART,
    StockShape,
};
use crate::gcode::{BlankDoubt, BlockLine, WorkOffset};
use crate::machine::{BodyShape, Machine};
use crate::stock::RemainingPoints;
use crate::{Gap, GapWeight, MachineProgram};
use nalgebra::{Point3, Vector3};
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;
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
    /// Files that the jobs of earlier set-ups were read from, each with its role.
    earlier_files: Vec<(String, PathBuf)>,
    /// Gaps in these inputs.
    gaps: Vec<Gap>,
}

/// Material that the job of an earlier set-up leaves.
struct EarlierSetup {
    remaining: RemainingPoints,
    /// The files that it was read from, each with its role.
    files: Vec<(String, PathBuf)>,
    /// Set if it has no clean verdict.
    gap: Option<Gap>,
}

/// The largest number of set-ups before one. Each needs a part of the stack while those before it are read.
const MAX_SETUPS: usize = 20;

/// Loads a tool by its name, and completes what its library states.
pub(super) type Load<'l, T, E> = &'l mut dyn FnMut(&mut NamedTool) -> Result<T, E>;

/// The part, another part, a fixture or a mesh of the machine, read.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct JobBody {
    /// Its name in findings.
    pub name: String,
    /// The file of its mesh; `None` for one that is made of numbers.
    pub file: Option<PathBuf>,
    /// Its mesh. Bodies with one mesh at one place share it.
    pub mesh: Arc<Mesh>,
    /// Its triangles.
    pub bvh: Arc<TriangleBvh>,
    /// The frame of its triangles.
    pub frame: BodyFrame,
    /// Role, which decides how near the surfaces of a tool may come.
    pub role: BodyRole,
    /// The work offset of another part.
    pub work_offset: Option<WorkOffset>,
}

/// The meshes of a job's files that were read, in its unit, by file and by how far they were moved.
struct Meshes {
    unit: Unit,
    known: HashMap<(PathBuf, [u64; 3]), Shared>,
}

/// A mesh and its triangles.
type Shared = (Arc<Mesh>, Arc<TriangleBvh>);

impl Meshes {
    /// Returns the mesh of a file, moved by a vector. `name` is that of its body.
    fn read(&mut self, name: &str, file: &Path, by: Vector3<f64>) -> Result<Shared, JobError> {
        let key = (file.to_owned(), [by.x, by.y, by.z].map(f64::to_bits));
        if let Some(shared) = self.known.get(&key) {
            return Ok(shared.clone());
        }
        let mut mesh = mesh(file, self.unit)?;
        if by != Vector3::zeros() {
            let moved = bodies::moved(&mesh, |vertex| vertex + by, self.unit);
            let name = name.to_owned();
            mesh = moved.map_err(|source| JobError::MachineMesh { name, source })?;
        }
        let bvh = TriangleBvh::new(&mesh);
        let shared: Shared = (Arc::new(mesh), Arc::new(bvh));
        self.known.insert(key, shared.clone());
        Ok(shared)
    }
}

impl JobBody {
    /// Reads a body that moves with the workpiece.
    fn read(
        name: &str,
        file: &Path,
        by: Vector3<f64>,
        role: BodyRole,
        meshes: &mut Meshes,
    ) -> Result<JobBody, JobError> {
        let (mesh, bvh) = meshes.read(name, file, by)?;
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
        meshes: &mut Meshes,
    ) -> Result<JobBody, JobError> {
        let index = entry.offset_index()?;
        let name = entry.name();
        if program.machine().is_none() {
            return Err(JobError::OtherPartForPositions { name });
        }
        let (Some(part), Some(other)) = (job.work_offsets[0], job.work_offsets[index]) else {
            return Err(JobError::OtherPartOrigin { name });
        };
        // The frames of both are parallel then, and their origins apart by the difference.
        if part[3..] != other[3..] {
            return Err(JobError::OtherPartTurned { name });
        }
        let file = entry.mesh.as_deref().unwrap_or(&job.part);
        let by = Vector3::from([0, 1, 2].map(|k| other[k] - part[k]));
        let by = by * Unit::Millimetre.factor_to(job.unit);
        let mut body = JobBody::read(&name, file, by, BodyRole::Part, meshes)?;
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
    /// Reads program, part, fixtures and stock of a job. `load` loads a tool by its name, and adds its hand and its doubts as its
    /// library states them.
    ///
    /// # Errors
    /// If a file cannot be read, or what they state does not fit together.
    pub fn read<E: From<JobError>>(
        file: JobFile,
        mut load: impl FnMut(&mut NamedTool) -> Result<T, E>,
    ) -> Result<JobInputs<T>, E> {
        JobInputs::read_after(file, &mut load, &mut Vec::new())
    }

    /// Reads a job whose stock is that of the jobs before it; `later` are the job files that are read for others.
    fn read_after<E: From<JobError>>(
        file: JobFile,
        load: Load<'_, T, E>,
        later: &mut Vec<PathBuf>,
    ) -> Result<JobInputs<T>, E> {
        let program = file.program()?;
        for (name, body) in body_files(&program) {
            file.check_within(name, body)?;
        }
        let (mut tools, mut gaps) = (Vec::new(), Vec::new());
        for mut named in file.used_tools(&program)? {
            let tool = load(&mut named)?;
            let name = &tool.as_ref().info().name;
            gaps.extend(named.doubts.iter().map(|doubt| {
                JobGap::LibraryTool { tool: name.to_string(), doubt: doubt.clone() }.open(0)
            }));
            tools.push((named, tool));
        }
        let meshes = &mut Meshes { unit: file.unit, known: HashMap::new() };
        let (role, still) = (BodyRole::Part, Vector3::zeros());
        let mut bodies = vec![JobBody::read(PART, &file.part, still, role, meshes)?];
        for entry in &file.other_parts {
            bodies.push(JobBody::read_other(entry, &file, &program, meshes)?);
        }
        for fixture in &file.fixtures {
            let link = match &fixture.moves_with {
                None => None,
                Some(axis) => program.link(axis)?,
            };
            let role = BodyRole::Fixture { margin: fixture.margin };
            let body = JobBody::read(&fixture.name, &fixture.mesh, still, role, meshes)?;
            let frame = link.map_or(BodyFrame::Part, BodyFrame::Table);
            bodies.push(JobBody { frame, ..body });
        }
        let mut revolved = Vec::new();
        if let Some(machine) = program.machine() {
            bodies.extend(bodies::meshes(machine, file.unit)?);
            revolved = bodies::revolved(machine, &bodies, &file, load)?;
        }
        let (mut stock, mut earlier_files) = (None, Vec::new());
        if let Some(entry) = &file.stock {
            let left = match &entry.from {
                Some(earlier) => {
                    let earlier = Self::earlier(earlier, &file, load, later)?;
                    earlier_files = earlier.files;
                    gaps.extend(earlier.gap);
                    Some(earlier.remaining)
                }
                None => None,
            };
            stock = Some(entry.stock(left, &program, file.unit)?);
        }
        Ok(JobInputs { file, program, tools, bodies, revolved, stock, earlier_files, gaps })
    }

    /// Checks the job of an earlier set-up, and returns what it leaves of its stock, in its own frame. `later` are the job files that it is read for.
    ///
    /// # Errors
    /// If the job cannot be checked, has no stock or another unit, leaves several stocks, or is among those that it is read for.
    fn earlier<E: From<JobError>>(
        file: &Path,
        job: &JobFile,
        load: Load<'_, T, E>,
        later: &mut Vec<PathBuf>,
    ) -> Result<EarlierSetup, E> {
        let name = || file.display().to_string();
        let refused =
            |fault: JobFileFault| E::from(JobError::File { file: name(), line: None, fault });
        let place = std::fs::canonicalize(file)
            .map_err(|source| E::from(JobError::Unreadable { file: name(), source }))?;
        if later.contains(&place) {
            return Err(refused(JobFileFault::OwnStock));
        }
        if later.len() == MAX_SETUPS {
            return Err(refused(JobFileFault::Setups { limit: MAX_SETUPS }));
        }
        later.push(place);
        let earlier = JobFile::read(file, job.root.as_deref())?;
        if earlier.unit != job.unit {
            return Err(refused(JobFileFault::OtherUnit));
        }
        let inputs = JobInputs::read_after(earlier, load, later)?;
        later.pop();
        let job = inputs.job();
        let report = job.check(&|_| ())?;
        let mut left = report.cuts.iter().map(|cut| cut.stock.remaining_points());
        let Some(first) = left.next() else {
            return Err(refused(JobFileFault::NoStock));
        };
        if left.any(|other| other != first) {
            return Err(refused(JobFileFault::SeveralStocks));
        }
        let gap = match report.verdict() {
            // What its own `anyway` has accepted is said.
            Verdict::Clean if report.is_lenient() => {
                let gap = JobGap::AcceptedSetup { file: name() };
                Some(Gap::said(0, gap.code(), gap.to_string()))
            }
            Verdict::Clean => None,
            verdict => {
                let mut gap = JobGap::EarlierSetup { file: name() }.open(0);
                // A violation is not left open, so `anyway` does not accept it.
                if verdict == Verdict::Findings {
                    gap.weight = GapWeight::Stops;
                }
                Some(gap)
            }
        };
        let own = inputs.files().into_iter();
        let files = own.map(|(role, file)| (format!("{}: {role}", name()), file.to_owned()));
        Ok(EarlierSetup { remaining: first, files: files.collect(), gap })
    }

    /// Returns the files that it was read from, each with its role: those of [`JobFile::files`], those of the machine's bodies, and
    /// those of earlier set-ups.
    pub fn files(&self) -> Vec<(String, &Path)> {
        let mut files = self.file.files();
        files.extend(self.further_files());
        files
    }

    /// Returns the files that [`JobFile::files`] does not know: those of the machine's bodies, and those of earlier set-ups.
    pub fn further_files(&self) -> Vec<(String, &Path)> {
        let mut files = Vec::new();
        files.extend(body_files(&self.program).map(|(name, file)| (name.to_owned(), file)));
        files.extend(self.earlier_files.iter().map(|(role, file)| (role.clone(), &**file)));
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
        job.gaps.clone_from(&self.gaps);
        (job.tolerance, job.resolution) = (self.file.tolerance, self.file.resolution);
        job.allow.clone_from(&self.file.allow);
        (job.surface_only, job.anyway) = (self.file.surface_only, self.file.anyway);
        job
    }
}

/// Returns the files of the bodies of a program's machine, each with the name of its body.
fn body_files(program: &Program) -> impl Iterator<Item = (&str, &Path)> {
    let bodies = program.machine().map_or(&[][..], Machine::bodies).iter();
    bodies.filter_map(|body| {
        let file = match &body.shape {
            BodyShape::Mesh { file, .. } => &**file,
            BodyShape::Tool { name, .. } if has_ending(Path::new(name), "tool") => Path::new(name),
            _ => return None,
        };
        Some((&*body.name, file))
    })
}

pub(super) fn mesh(file: &Path, unit: Unit) -> Result<Mesh, JobError> {
    match Geometry::read(file, unit)? {
        Geometry::Mesh(mesh) => Ok(mesh),
        Geometry::Points(_) => Err(JobError::NoTriangles { file: file.display().to_string() }),
    }
}

/// Returns the blank that a program states, in a unit.
fn blank(program: &Program, unit: Unit) -> Result<[Point3<f64>; 2], JobError> {
    let summary = program.readings().first().map(MachineProgram::summary);
    let Some((summary, blank)) = summary.and_then(|summary| Some((summary, summary.blank?))) else {
        return Err(JobError::NoBlank);
    };
    // Its corners are in the coordinates in force there, which are those of the part under G54 alone.
    let offset = summary.other_offset.map(|block| (block, BlankDoubt::Offset));
    if let Some((BlockLine { line, .. }, doubt)) = blank.doubt.or(offset) {
        return Err(JobError::DoubtfulBlank { line, doubt });
    }
    let factor = Unit::Millimetre.factor_to(unit);
    Ok(blank.corners.map(|corner| Point3::from(corner) * factor))
}

impl StockEntry {
    /// Returns the stock; `earlier` is what the set-up leaves that it names by `from`.
    ///
    /// # Errors
    /// If it has no shape or several, if its mesh cannot be read, or if the program states no blank.
    pub fn stock(
        &self,
        earlier: Option<RemainingPoints>,
        program: &Program,
        unit: Unit,
    ) -> Result<JobStock, JobError> {
        let is_placed = [self.origin, self.x, self.z].iter().any(Option::is_some);
        let spacing = match (&earlier, self.spacing) {
            (Some(points), None) => points.spacing(),
            (Some(_), Some(_)) => {
                return Err(JobError::SpacingOfEarlier);
            }
            (None, _) if is_placed => {
                return Err(JobError::PlaceOfStock);
            }
            (None, Some(spacing)) => spacing,
            (None, None) => {
                return Err(JobError::NoSpacing);
            }
        };
        let shape = match (&self.mesh, self.corners, self.blank, earlier) {
            (Some(file), None, false, None) => StockShape::Mesh(mesh(file, unit)?),
            (None, Some(corners), false, None) => StockShape::Box(corners.map(Point3::from)),
            (None, None, true, None) => StockShape::Box(blank(program, unit)?),
            (None, None, false, Some(points)) => StockShape::Points(points.placed(
                Point3::from(self.origin.unwrap_or_default()),
                self.x.unwrap_or([1.0, 0.0, 0.0]),
                self.z.unwrap_or([0.0, 0.0, 1.0]),
            )?),
            _ => {
                return Err(JobError::StockShape);
            }
        };
        Ok(JobStock { shape, spacing, tolerance: self.tolerance })
    }
}
