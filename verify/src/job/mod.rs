//! The verified job: a program with its tools, against the part, fixtures and stock.
//!
//! ```text
//! JobFile (TOML) ──JobInputs::read──▶ program, tools, meshes ──job──▶ Job ──check──▶ JobReport ──▶ findings, verdict, SARIF
//! ```
//!
//! Each reading of the program is executed once more than its summary needs: the blocks of one pass go to every tool at every
//! body, and to the stock.

mod bodies;
mod comment;
mod error;
mod file;
mod finding;
mod gap;
mod inputs;
mod json;
mod level;
mod machine;
mod pass;
mod program;
mod report;
mod stock;

pub use bodies::RevolvedBody;
pub use error::{JobError, JobFileFault};
pub use file::{FixtureEntry, JobFile, JobTools, NamedTool, PartEntry, StockEntry, ToolEntry};
pub use finding::FindingRule;
pub(crate) use gap::JobGap;
pub use inputs::{JobBody, JobInputs};
pub use machine::{MachineFinding, MachineFindingKind, SpindleFault};
pub use program::{DEFAULT_MACHINE, Program, read_control, read_machine};
pub use report::{
    FindingDetail, JobFinding, JobReport, Moving, NO_INSIDE, NoVerdict, PairReport, Remedy,
    Severity, Verdict,
};
pub use stock::{CutStock, StockFinding};

use crate::gcode::WorkOffset;
use crate::machine::{Letter, Link, Machine, Side};
use crate::stock::{RemainingPoints, Stock, StockError};
use crate::{Gap, ToolSelection, Verifier};
use nalgebra::Point3;
use serde::Deserialize;
use touchoff::certify::TriangleBvh;
use touchoff::tool::ToolInfo;
use touchoff::{Mesh, Tool, Unit};

/// The name of the part in findings.
pub const PART: &str = "the part";
/// Name of the stock in findings.
pub(crate) const STOCK: &str = "the stock";

/// A program with its tools, against the part, fixtures and stock.
///
/// Lengths are in the part's unit, frames are right-handed, and positions are in the frame of the part: that of G54 for G-code.
///
/// ```
/// use nalgebra::Point3;
/// use touchoff::{Unit, certify::TriangleBvh, mesh::shapes};
/// use touchoff_verify::gcode::{ControlRules, ControlSetup};
/// use touchoff_verify::job::{Job, JobTool, Program, Verdict};
/// use touchoff_verify::machine::Machine;
///
/// touchoff::tool! {
///     tool Mill "10 mm end mill" {
///         units mm;
///         profile {
///             start (0, 0); line to (5, 0) as tip cutting; line to (5, 20) as flute cutting;
///             line to (5, 50) as shank; line to (0, 50) as top;
///         }
///         niceness cutting: 1;
///     }
/// }
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let (low, high) = (Point3::new(0., 0., -10.), Point3::new(40., 40., 0.));
/// let part = TriangleBvh::new(&shapes::cuboid(low, high, Unit::Millimetre)?);
/// let text = "G21 G90 G54 G0 X-20. Y20. Z5.\nT1 M6\nS900 M3\nG43 H1 Z5.\nG1 X20. Z-0.5 F100.\nG0 Z5.\nM30\n";
/// let setup = ControlSetup { rules: ControlRules::named("linuxcnc")?, ..ControlSetup::default() };
/// let program = Program::parse(text, "plate.nc", Machine::named("3-axis")?, &setup)?;
/// let mut job = Job::new(&program, &part);
/// job.tools.push(JobTool::numbered(1, &Mill));
/// job.tolerance = 0.01;
/// let report = job.check(&|_| ())?;
/// assert_eq!(report.verdict(), Verdict::Findings);
/// assert!(report.findings()[0].text.contains("tip is 0.5000 mm deep in the part"));
/// # Ok(()) }
/// ```
#[derive(Debug)]
#[non_exhaustive]
pub struct Job<'a> {
    /// The program.
    pub program: &'a Program,
    /// The part, then other parts, the fixtures and the meshes of the machine.
    pub bodies: Vec<Body<'a>>,
    /// The tools of the program.
    pub tools: Vec<JobTool<'a>>,
    /// The bodies of the machine that are solids of revolution.
    pub revolved: Vec<RevolvedBody<'a>>,
    /// The stock.
    pub stock: Option<JobStock>,
    /// Depth in the part that any surface may have, unless it is allowed another.
    pub tolerance: f64,
    /// Excess of depth up to which a finding may or may not be reported; `None` for 0.001 mm.
    pub resolution: Option<f64>,
    /// Depths that surfaces of the tools may have in the part, by their names ([`Verifier::with_allowance`]).
    pub allow: Vec<(String, f64)>,
    /// Checks the surface alone of a body whose mesh has no inside.
    pub surface_only: bool,
    /// Gaps in its inputs, beside what the program leaves open.
    pub gaps: Vec<Gap>,
    /// Accepts what the program leaves open, and a program that seems to be meant for another part.
    pub anyway: bool,
}

/// A body that the tool must not violate: the part, a fixture, or a mesh of the machine.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Body<'a> {
    /// Its name in findings.
    pub name: String,
    /// Its triangles.
    pub bvh: &'a TriangleBvh,
    /// The frame of its triangles.
    pub frame: BodyFrame,
    /// How near the surfaces of a tool may come.
    pub role: BodyRole,
    /// The work offset of another part, under which the program is meant for it.
    pub work_offset: Option<WorkOffset>,
}

/// The frame of the triangles of a body, which moves with a link of the machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BodyFrame {
    /// That of the part, with which it moves.
    Part,
    /// That of the part while all axes are at 0. It moves with a link of the table ([`Program::link`]).
    Table(usize),
    /// Machine coordinates while all axes are at 0. It moves with any link.
    Machine(Link),
}

impl BodyFrame {
    /// Returns the link of a machine with which the body moves.
    fn link(self, machine: &Machine) -> Link {
        match self {
            BodyFrame::Part => machine.last_link(Side::Table),
            BodyFrame::Table(0) => Link::Base,
            // Links are numbered from the base on.
            BodyFrame::Table(index) => {
                let table = machine.axes().iter().filter(|axis| axis.side == Side::Table);
                let letters: Vec<Letter> = table.map(|axis| axis.letter).collect();
                letters.get(index - 1).map_or(Link::Base, |letter| Link::Axis(*letter))
            }
            BodyFrame::Machine(link) => link,
        }
    }
}

/// The role of a body in a job, which decides how near the surfaces of a tool may come.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BodyRole {
    /// The part: surfaces may be as deep in it as the job's tolerance and allowances state.
    Part,
    /// A fixture: every surface keeps a distance from it.
    Fixture {
        /// The distance, 0 or more; at 0 surfaces may touch.
        margin: f64,
    },
    /// A mesh of the machine: what it is checked against keeps a distance from it.
    Machine {
        /// The distance, 0 or more; at 0 surfaces may touch.
        margin: f64,
        /// Set if the tools of the program are checked against it.
        meets_tools: bool,
    },
}

/// A tool of a job.
#[derive(Clone)]
#[non_exhaustive]
pub struct JobTool<'a> {
    /// The motions that it makes.
    pub motions: ToolSelection,
    /// The tool.
    pub tool: &'a dyn Tool,
    /// The hand of its cutting edges; `None` if neither the job nor its library states it: right, or that of its thread.
    pub hand: Option<Hand>,
    /// Depths that its surfaces may have in the part, beside those of the job.
    pub allow: Vec<(String, f64)>,
}

/// The hand of cutting edges.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Hand {
    /// It cuts while the spindle turns clockwise (M3).
    #[default]
    Right,
    /// It cuts while the spindle turns counter-clockwise (M4).
    Left,
}

impl Hand {
    /// Returns the hand of edges that cut while the spindle turns counter-clockwise, or not.
    pub fn of(is_left: bool) -> Hand {
        if is_left { Hand::Left } else { Hand::Right }
    }
}

/// The stock of a job.
#[derive(Clone, Debug, PartialEq)]
pub struct JobStock {
    /// Its shape before the program.
    pub shape: StockShape,
    /// Distance between neighbouring points of its lattice.
    pub spacing: f64,
    /// Depth in it that surfaces may have which must not touch; `None` for the length of a step of the lattice.
    pub tolerance: Option<f64>,
}

/// The shape of a stock.
#[derive(Clone, Debug, PartialEq)]
pub enum StockShape {
    /// The inside of a mesh.
    Mesh(Mesh),
    /// Remains of an earlier set-up, in the frame of the part. Its spacing is that of its points.
    Points(RemainingPoints),
    /// A box, by its lowest and its highest corner.
    Box([Point3<f64>; 2]),
}

/// Returns the margin of a fixture if it is a length of 0 or more.
fn checked_margin(margin: f64) -> Result<f64, JobError> {
    // NaN is in no range.
    match (0.0..f64::INFINITY).contains(&margin) {
        true => Ok(margin),
        false => Err(JobError::Margin),
    }
}

impl<'a> Job<'a> {
    /// Creates a job without tools, fixtures and stock, in which nothing may be deeper in the part than 0.
    pub fn new(program: &'a Program, part: &'a TriangleBvh) -> Job<'a> {
        let (frame, role) = (BodyFrame::Part, BodyRole::Part);
        let part = Body { name: PART.to_owned(), bvh: part, frame, role, work_offset: None };
        Job {
            program,
            bodies: vec![part],
            tools: Vec::new(),
            revolved: Vec::new(),
            stock: None,
            tolerance: 0.0,
            resolution: None,
            allow: Vec::new(),
            surface_only: false,
            gaps: Vec::new(),
            anyway: false,
        }
    }

    /// Returns the unit of lengths: that of the part.
    pub fn unit(&self) -> Unit {
        self.bodies[0].bvh.unit()
    }

    /// Returns the verifier of a tool at a body.
    fn verifier(&self, tool: &JobTool<'a>, body: &Body<'a>) -> Result<Verifier<'a>, JobError> {
        let info = tool.tool.info();
        let mut verifier = Verifier::new(body.bvh, tool.tool)?;
        match body.role {
            BodyRole::Fixture { margin } | BodyRole::Machine { margin, .. } => {
                verifier = with_margin(verifier, info, margin)?;
            }
            BodyRole::Part => {
                // An allowance of a job holds for the tools that have the surface, and one has to have it.
                let of_job = self.allow.iter().filter(|(surface, _)| {
                    let has =
                        |tool: &JobTool<'_>| tool.tool.info().surface_named(surface).is_some();
                    has(tool) || !self.tools.iter().any(has)
                });
                let allowances = of_job.chain(&tool.allow);
                verifier = verifier
                    .with_tolerance(self.tolerance)?
                    .with_allowances(allowances.map(|(surface, depth)| (&**surface, *depth)))?;
            }
        }
        if let Some(resolution) = self.resolution {
            verifier = verifier.with_resolution(resolution)?;
        }
        Ok(verifier)
    }

    /// Returns the verifier of a body of the machine at another body: both keep the larger of their margins.
    fn verifier_between(
        &self,
        revolved: &RevolvedBody<'a>,
        body: &Body<'a>,
    ) -> Result<Verifier<'a>, JobError> {
        revolved.check_shape()?;
        let margin = match body.role {
            BodyRole::Part => 0.0,
            BodyRole::Fixture { margin } | BodyRole::Machine { margin, .. } => {
                checked_margin(margin)?
            }
        };
        let margin = checked_margin(revolved.margin)?.max(margin);
        let verifier = Verifier::new(body.bvh, revolved.shape)?;
        let verifier = with_margin(verifier, revolved.shape.info(), margin)?;
        Ok(match self.resolution {
            Some(resolution) => verifier.with_resolution(resolution)?,
            None => verifier,
        })
    }
}

/// Sets the distance that all surfaces of a tool keep.
fn with_margin<'a>(
    verifier: Verifier<'a>,
    info: &ToolInfo,
    margin: f64,
) -> Result<Verifier<'a>, JobError> {
    // Surfaces without another allowance have 0.
    if checked_margin(margin)? == 0.0 {
        return Ok(verifier);
    }
    let surfaces = info.surfaces.iter();
    Ok(verifier.with_allowances(surfaces.map(|surface| (&*surface.name, -margin)))?)
}

impl<'a> Body<'a> {
    /// Creates a fixture that moves with the workpiece and may be touched, and not be entered.
    pub fn fixture(name: &str, bvh: &'a TriangleBvh) -> Body<'a> {
        let role = BodyRole::Fixture { margin: 0.0 };
        Body { name: name.to_owned(), bvh, frame: BodyFrame::Part, role, work_offset: None }
    }

    /// Creates another part, which the program cuts under another work offset. Its triangles are in the frame of the part: those of
    /// its own frame, moved by the difference of both origins.
    pub fn other_part(name: &str, bvh: &'a TriangleBvh, work_offset: WorkOffset) -> Body<'a> {
        let (frame, role) = (BodyFrame::Part, BodyRole::Part);
        Body { name: name.to_owned(), bvh, frame, role, work_offset: Some(work_offset) }
    }

    /// Creates a mesh of the machine, in machine coordinates with all axes at 0, that moves with a link and may be touched by the
    /// tools of the program, and not be entered.
    pub fn machine(name: &str, bvh: &'a TriangleBvh, link: Link) -> Body<'a> {
        let role = BodyRole::Machine { margin: 0.0, meets_tools: true };
        let (frame, work_offset) = (BodyFrame::Machine(link), None);
        Body { name: name.to_owned(), bvh, frame, role, work_offset }
    }

    /// Returns whether it is the part or another part, and no fixture or mesh of the machine.
    pub fn is_part(&self) -> bool {
        self.role == BodyRole::Part
    }

    /// Returns whether the tools of the program are checked against it.
    fn meets_tools(&self) -> bool {
        !matches!(self.role, BodyRole::Machine { meets_tools: false, .. })
    }
}

impl<'a> JobTool<'a> {
    /// Creates the tool that makes all motions, whatever number the program gives it.
    pub fn of_all(tool: &'a dyn Tool) -> JobTool<'a> {
        JobTool { motions: ToolSelection::All, tool, hand: None, allow: Vec::new() }
    }

    /// Creates the tool with a number in the program.
    pub fn numbered(number: u32, tool: &'a dyn Tool) -> JobTool<'a> {
        let motions = ToolSelection::Number(Some(number));
        JobTool { motions, ..JobTool::of_all(tool) }
    }

    /// Returns its number in the program, if tools are selected by number.
    pub fn number(&self) -> Option<u32> {
        match self.motions {
            ToolSelection::All => None,
            ToolSelection::Number(number) => number,
        }
    }
}

impl std::fmt::Debug for JobTool<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("JobTool")
            .field("motions", &self.motions)
            .field("tool", &self.tool.info().name)
            .field("hand", &self.hand)
            .field("allow", &self.allow)
            .finish()
    }
}

impl JobStock {
    /// Returns the lowest and the highest corner of its box before the program.
    fn bounds(&self) -> [Point3<f64>; 2] {
        match &self.shape {
            StockShape::Box(corners) => *corners,
            StockShape::Mesh(mesh) => mesh.bounds(),
            StockShape::Points(points) => points.bounds(),
        }
    }

    /// Makes the stock.
    fn build(&self, unit: Unit) -> Result<Stock, StockError> {
        match &self.shape {
            StockShape::Mesh(mesh) => Stock::from_mesh(mesh, self.spacing),
            StockShape::Points(points) => Stock::from_points(points),
            StockShape::Box(corners) => Stock::from_box(*corners, self.spacing, unit),
        }
    }
}
