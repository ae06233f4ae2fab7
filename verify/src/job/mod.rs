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
mod file;
mod finding;
mod inputs;
mod json;
mod level;
mod machine;
mod pass;
mod program;
mod report;
mod stock;

pub use bodies::RevolvedBody;
pub use file::{FixtureEntry, JobFile, JobTools, NamedTool, PartEntry, StockEntry, ToolEntry};
pub use finding::FindingRule;
pub use inputs::{JobBody, JobInputs};
pub use machine::{MachineFinding, MachineFindingKind, SpindleFault};
pub use program::{DEFAULT_MACHINE, Program, read_control, read_machine};
pub use report::{
    FindingDetail, JobFinding, JobReport, Moving, NO_INSIDE, NoVerdict, PairReport, Remedy,
    Severity, Verdict,
};
pub use stock::{CutStock, StockFinding};

use crate::check::CheckGap;
use crate::codes::faults;
use crate::gcode::{BlankDoubt, BlockLine, ControlError, ControlRules, GENERIC, WorkOffset};
use crate::machine::{JointError, Letter, Link, MAX_NAME, Machine, MachineError, Side};
use crate::program::ProgramError;
use crate::stock::{RemainingPoints, Stock, StockError};
use crate::{Gap, MachineProgramError, ToolSelection, Verifier, VerifyError};
use nalgebra::Point3;
use serde::Deserialize;
use std::convert::Infallible;
use touchoff::certify::TriangleBvh;
use touchoff::mesh::{GeometryError, MeshError};
use touchoff::tool::ToolInfo;
use touchoff::{Mesh, ParseUnitError, PoseError, Tool, Unit};

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

faults! {
    #[family("J01", "Jobs")]
    /// A reason for which a job cannot be read or checked.
    #[derive(thiserror::Error)]
    #[non_exhaustive]
    pub enum JobError {
        /// The job's file is refused.
        #[code_of(fault)]
        #[error("{file}: {}{fault}", line.map_or(String::new(), |line| format!("line {line}: ")))]
        File {
            /// The file.
            file: String,
            /// The line, from 1, if it is known.
            line: Option<usize>,
            /// The fault in it.
            fault: JobFileFault,
        },
        /// A file cannot be read.
        #[code = J0101]
        #[error("{file}: cannot be read ({source}): check the path and its permissions")]
        Unreadable {
            /// The file.
            file: String,
            /// The reason.
            source: std::io::Error,
        },
        /// Two files of subprograms have one name.
        #[code = J0102]
        #[error(
            "two files of `subprograms` have the name {name}, by which controls find them: rename one of them"
        )]
        SecondSubprogram {
            /// The name.
            name: String,
        },
        /// A number of a tool in the program for which no tool is given.
        #[code = J0103]
        #[error(
            "line {line}: no tool is given for T{number}{}: state `tools = \"LIBRARY\"` or `[tool.{number}]` with `tool = \"FILE.tool\"` in the job",
            further_tools(others)
        )]
        NoTool {
            /// The number.
            number: u32,
            /// The line of the first motion with it, 1-based.
            line: usize,
            /// Further numbers without a tool.
            others: Vec<u32>,
        },
        /// Motions of no tool in particular, in a job with several.
        #[code = J0104]
        #[error(
            "line {line}: the program moves before its first tool change, or names no tool: give one tool in the job, or use `--tool`"
        )]
        UnnamedTool {
            /// The line of the first of them, 1-based.
            line: usize,
        },
        /// A program changes tools, and one was given.
        #[code = J0105]
        #[error("the program uses T{first} and T{second}: give its tools by number in a job file")]
        SeveralTools {
            /// The first tool.
            first: u32,
            /// Another tool.
            second: u32,
        },
        /// A work offset has another name, or another number of coordinates.
        #[code = J0106]
        #[error(
            "work offset `{name}`: write `G54 = [x, y, z]` or `[x, y, z, a, b, c]`, once for each of G54 to G59.3, `\"G54.1 P1\"`, \
             `\"G154 P1\"`, G110 to G129 and G507 to G599"
        )]
        WorkOffset {
            /// The given name.
            name: String,
        },
        /// The program is refused.
        #[code_of(0)]
        #[error(transparent)]
        Program(#[from] ProgramError),
        /// The program cannot be executed on its machine.
        #[code_of(0)]
        #[error(transparent)]
        MachineProgram(#[from] MachineProgramError),
        /// The machine has no such link.
        #[code_of(0)]
        #[error(transparent)]
        Joint(#[from] JointError),
        /// The machine is refused.
        #[code_of(0)]
        #[error(transparent)]
        Machine(#[from] MachineError),
        /// The control is refused.
        #[code_of(0)]
        #[error(transparent)]
        Control(#[from] ControlError),
        /// A tool cannot be certified, or has no surface of a name.
        #[code_of(0)]
        #[error(transparent)]
        Verify(#[from] VerifyError),
        /// The stock cannot be made or cut.
        #[code_of(0)]
        #[error(transparent)]
        Stock(#[from] StockError),
        /// An isometry is no pose.
        #[code = J0107]
        #[error(transparent)]
        Pose(#[from] PoseError),
        /// A body of the job is no mesh.
        #[code = J0108]
        #[error(transparent)]
        Geometry(#[from] GeometryError),
        /// The program sets the work offset of another part to other values than the job.
        #[code = J0109]
        #[error(
            "line {line}: the program sets {offset}, at which another part of the job stands, to other values than the job: state its \
             origin in `work_offsets`, or remove the block"
        )]
        MovedPart {
            /// The work offset.
            offset: WorkOffset,
            /// The line of the first motion under it.
            line: usize,
        },
        /// A mesh of the machine is none in its place.
        #[code = J0110]
        #[error("the body `{name}` of the machine is no mesh in its place: {source}")]
        MachineMesh {
            /// Its name.
            name: String,
            /// The reason.
            source: MeshError,
        },
        /// A body of the machine that moves against meshes is no solid of revolution.
        #[code = J0111]
        #[error(
            "the body `{name}` of the machine is a `solid` of the tool language: give a `tool`, a solid of revolution that contains it"
        )]
        NotRevolved {
            /// Its name.
            name: String,
        },
        /// Bodies of the machine that have no place, since the length of a tool is not stated.
        #[code = J0112]
        #[error(
            "the bodies of the machine are placed by the length of the tool in the spindle, and that of T{number} is not stated: state \
             `length` in `[tool.{number}]` of the job, or name a machine without bodies"
        )]
        NoLength {
            /// The number of the tool.
            number: u32,
            /// The line of the first motion with it, 1-based.
            line: usize,
        },
        /// Bodies of the machine that have no place, since motions are of no tool in particular.
        #[code = J0113]
        #[error(
            "line {line}: the bodies of the machine are placed by the length of the tool in the spindle, and the program moves before its \
             first tool change, or names no tool: write T and M6 before, or name a machine without bodies"
        )]
        NoToolForLength {
            /// The line of the first of them, 1-based.
            line: usize,
        },
        /// A body of the job is a cloud of points.
        #[code = J0114]
        #[error(
            "{file}: the job needs triangles, and this has only points: give the mesh that they were sampled from"
        )]
        NoTriangles {
            /// The file.
            file: String,
        },
        /// A machine or a control for a program that states positions of the tip.
        #[code = J0115]
        #[error("a machine or a control is for G-code: this program states positions of the tip")]
        MachineForPositions,
        /// Bodies of a machine beside a program of positions.
        #[code = J0116]
        #[error("bodies of a machine are for programs on a machine")]
        BodiesForPositions,
        /// Bodies of the machine that have no place, since the origin of the part is not stated.
        #[code = J0117]
        #[error(
            "the bodies of the machine have a place relative to the part if the origin of G54 is stated: state it in `work_offsets` of the \
             job, or name a machine without bodies"
        )]
        NoPlace,
        /// A body of the machine that moves against a body which the job lacks.
        #[code = J0118]
        #[error("a body of the machine is checked against a body of the job that there is not")]
        NoSuchBody,
        /// A margin that is no length.
        #[code = J0119]
        #[error("the margin of a fixture or of a body of the machine is a length of 0 or more")]
        Margin,
        /// `moves_with` beside a program of positions.
        #[code = J0120]
        #[error("`moves_with` is for programs on a machine")]
        MovesWithoutMachine,
        /// `moves_with` another axis than the part's, while the origin of the part is not stated.
        #[code = J0121]
        #[error(
            "`moves_with` another axis than the part's needs the origin of G54 in `work_offsets`, without rotary offsets"
        )]
        MovesWithoutOrigin,
        /// `moves_with` that names no axis of the table.
        #[code = J0122]
        #[error("`moves_with` names an axis of the machine's table, or `base`")]
        MovesWithNothing,
        /// A stock that is the program's blank, of a program that states none.
        #[code = J0123]
        #[error(
            "the program states no box by BLK FORM 0.1 and 0.2 (G30 and G31 in DIN/ISO): state the stock by a `mesh` or a `box`"
        )]
        NoBlank,
        /// A spacing for a stock that has one.
        #[code = J0124]
        #[error("a stock `from` an earlier set-up has the spacing of that one: remove `spacing`")]
        SpacingOfEarlier,
        /// A place for a stock that has one.
        #[code = J0125]
        #[error(
            "`origin`, `x` and `z` of a stock place that of an earlier set-up: state it by `from`, or remove them"
        )]
        PlaceOfStock,
        /// A stock without a spacing.
        #[code = J0126]
        #[error("a stock of a `mesh`, a `box` or a `blank` has a `spacing`")]
        NoSpacing,
        /// A stock with no shape, or with several.
        #[code = J0127]
        #[error("a stock has a `mesh`, a `box`, `blank = true` or `from`, and only one of them")]
        StockShape,
        /// Another part beside a program of positions.
        #[code = J0128]
        #[error(
            "{name}: other parts are for G-code, whose work offsets have a place: remove `[[other_part]]`"
        )]
        OtherPartForPositions {
            /// The part's name.
            name: String,
        },
        /// Another part at the work offset of the part, or at none.
        #[code = J0129]
        #[error("{name}: its `work_offset` is one of G55 to G59.3, since the part stands at G54")]
        OtherPartOffset {
            /// The part's name.
            name: String,
        },
        /// Another part without a place, since an origin is not stated.
        #[code = J0130]
        #[error("{name}: state its origin and that of G54 in `work_offsets`")]
        OtherPartOrigin {
            /// The part's name.
            name: String,
        },
        /// Another part that stands turned against the part.
        #[code = J0131]
        #[error(
            "{name}: its origin turns a rotary axis otherwise than that of G54: state the same angles, and turn its mesh"
        )]
        OtherPartTurned {
            /// The part's name.
            name: String,
        },
        /// An input in another folder.
        ///
        /// A job can be a stranger's, of a pull request or an archive: it reads within its own folder, or within the one that
        /// whoever runs it names.
        #[code = J0132]
        #[error(
            "{role}: {file} is outside {root}: a job reads within its own folder, or within that of `--root` (`root` in Python)"
        )]
        Outside {
            /// The role of the file in the job.
            role: String,
            /// The file.
            file: String,
            /// The folder.
            root: String,
        },
        /// Too many things that move, each checked against too many bodies.
        #[code = J0133]
        #[error(
            "{moving} tools and bodies of the machine are checked against {bodies} bodies, in {pairs} pairs of at most {limit}: join \
             the meshes of fixtures, state fewer bodies in the machine's `against`, or divide the program by its tools"
        )]
        Pairs {
            /// Number of tools and of bodies of the machine that are solids of revolution.
            moving: usize,
            /// Number of the bodies that they are checked against.
            bodies: usize,
            /// Number of pairs.
            pairs: usize,
            /// The largest number of pairs.
            limit: usize,
        },
        /// A tool of the program whose gauge point is below its tip.
        #[code = J0134]
        #[error(
            "tool {number} has the length {length} mm: state the distance from its tip to the gauge point of the spindle, 0 or more"
        )]
        ToolLength {
            /// The number.
            number: u32,
            /// The length, in mm.
            length: f64,
        },
        /// A G-code program without a control.
        ///
        /// Controls read one program in different ways, and a verdict holds for the one that reads it.
        #[code = J0135]
        #[error(
            "{file}: state the control that reads it, by `--control NAME` or by `control` in the job: {}, `{GENERIC}` for what holds on \
             each of these, or a file (`touchoff controls NAME` prints one)",
            control_names()
        )]
        NoControl {
            /// The program.
            file: String,
        },
        /// A blank that may not be the material that is clamped.
        #[code = J0136]
        #[error("line {line}: {doubt}: state the stock by a `box` in the frame of the part, in place of `blank = true`")]
        DoubtfulBlank {
            /// The line of the program, 1-based.
            line: usize,
            /// The reason.
            doubt: BlankDoubt,
        },
    }
}

/// Lists the controls that are known by name.
fn control_names() -> String {
    ControlRules::names().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ")
}

/// Tells how many other comments describe another tool.
fn more_comments(count: usize) -> String {
    match count {
        0 => String::new(),
        1 => " (and 1 more comment)".to_owned(),
        count => format!(" (and {count} more comments)"),
    }
}

/// Lists further tools without a file, and the number of those left out.
fn further_tools(numbers: &[u32]) -> String {
    const MAX_SHOWN: usize = 20;
    let (shown, left_out) = numbers.split_at(numbers.len().min(MAX_SHOWN));
    let mut text: String = shown.iter().map(|number| format!(", T{number}")).collect();
    if !left_out.is_empty() {
        text += &format!(" and {} more tools", left_out.len());
    }
    text
}

// A pose needs no conversion.
impl From<Infallible> for JobError {
    fn from(never: Infallible) -> JobError {
        match never {}
    }
}

faults! {
    #[family("J02", "Jobs: keys of their files")]
    /// A fault in a job's file.
    #[derive(Clone, PartialEq, thiserror::Error)]
    #[non_exhaustive]
    pub enum JobFileFault {
        /// A text that is not TOML, or a key that is unknown, missing or of the wrong type.
        #[code = J0201]
        #[error("{message}")]
        Syntax {
            /// The parser's message.
            message: String,
        },
        /// A unit that is not known.
        #[code = J0202]
        #[error(transparent)]
        Unit(#[from] ParseUnitError),
        /// A tolerance or a resolution that is no length.
        #[code = J0203]
        #[error("`tolerance` and `resolution` are lengths of 0 or more")]
        Length,
        /// A margin that is no length.
        #[code = J0204]
        #[error("the margin of a fixture or of a body of the machine is a length of 0 or more")]
        Margin,
        /// A variable that no program has, or one without a value.
        #[code = J0205]
        #[error(
            "`{name}` in `[variables]`: write `\"#500\" = 2.5`, `R1 = 2.5` or `Q1 = 2.5`, or all values that it can have as a list"
        )]
        Variable {
            /// The given name.
            name: String,
        },
        /// A key of `[tool]` that is no number.
        #[code = J0206]
        #[error("`{number}` is no tool number: write `[tool.3]`")]
        ToolNumber {
            /// The given key.
            number: String,
        },
        /// A name that two tools have.
        #[code = J0207]
        #[error("the tool name `{name}` is given twice: keep one of both")]
        SecondToolName {
            /// The name.
            name: String,
        },
        /// A number that two tools have.
        #[code = J0208]
        #[error("tool {number} is given twice: keep one of both")]
        SecondTool {
            /// The number.
            number: u32,
        },
        /// A radius offset without a number.
        #[code = J0209]
        #[error("radius offset `{name}`: write its number as in the program, `D21 = 0.02`")]
        RadiusOffset {
            /// The given key.
            name: String,
        },
        /// A radius offset with two values.
        #[code = J0210]
        #[error("radius offset {number} is given twice: keep one of both")]
        SecondRadiusOffset {
            /// The number.
            number: u32,
        },
        /// A radius offset that is no length.
        #[code = J0211]
        #[error("radius offset {number} is a length in mm")]
        RadiusLength {
            /// The number.
            number: u32,
        },
        /// A preset without a number, that stands for no work offset, or that is given twice.
        #[code = J0212]
        #[error("preset `{preset}`: write its number and a work offset, `2 = \"G55\"`, once")]
        Preset {
            /// The given key.
            preset: String,
        },
        /// A set-up whose stock comes from itself.
        #[code = J0213]
        #[error(
            "the stock of this set-up comes from itself: give the first one a `mesh` or a `box`"
        )]
        OwnStock,
        /// A set-up in another unit than that after it.
        #[code = J0214]
        #[error("this set-up is in another unit than that after it: state both in the same one")]
        OtherUnit,
        /// A set-up without a stock, from which another one takes its own.
        #[code = J0215]
        #[error("this set-up has no stock, and so leaves none: state its `[stock]`")]
        NoStock,
        /// A set-up that leaves several stocks, by the reading of its program.
        #[code = J0216]
        #[error("this set-up leaves one stock or another, by the control: state its `control`")]
        SeveralStocks,
        /// An output in another folder, or one that is there and is a link or no regular file.
        ///
        /// A job can be a stranger's, of a pull request or an archive: it writes within its own folder only.
        #[code = J0217]
        #[error(
            "`{key}` is written to `{output}`, which is outside the folder of the job, a link or no regular file: name another file"
        )]
        OutputOutside {
            /// The key.
            key: String,
            /// The output.
            output: String,
        },
        /// An output whose name has not the ending of its kind.
        #[code = J0218]
        #[error("`{key}` is written to `{file}`: its name ends in `.{endings}`")]
        OutputEnding {
            /// The key.
            key: String,
            /// The output.
            file: String,
            /// The endings of its kind.
            endings: String,
        },
        /// A name of a fixture or of another part that is empty, is long, or has a control character.
        #[code = J0219]
        #[error(
            "the name of a fixture or of another part is empty, is long, or has a control character: give it one line, of up to {MAX_NAME} characters"
        )]
        Name,
        /// A set-up after too many others.
        #[code = J0220]
        #[error(
            "more than {limit} set-ups come one after the other: give this one its stock by a `mesh`"
        )]
        Setups {
            /// The largest number of set-ups.
            limit: usize,
        },
        /// A variable that is given twice, by two spellings of its name.
        #[code = J0221]
        #[error("{name} in `[variables]` is given twice: keep one of both")]
        SecondVariable {
            /// The name.
            name: String,
        },
        /// A name that two bodies have.
        #[code = J0222]
        #[error("{name} is the name of two bodies: name each `[[fixture]]` and `[[other_part]]` so that findings tell them apart")]
        SecondBody {
            /// The name.
            name: String,
        },
    }
}

faults! {
    #[family("V06", "What a job leaves open")]
    /// A reason for a gap of a job.
    #[derive(Clone, PartialEq, thiserror::Error)]
    pub(crate) enum JobGap {
        /// A gap of a motion that depends on what the job checks it against.
        #[code_of(0)]
        #[error("{0}")]
        Motion(CheckGap),
        /// Bodies of the machine that are not checked, as the page of `touchoff live` has none of their files.
        #[code = V0601]
        #[error(
            "the bodies that the machine's file states are not checked here: check them by a job file, or name a machine without bodies"
        )]
        MachineBodies,
        /// Rapid traverse of several axes through the stock, whose path is not stated.
        #[code = V0602]
        #[error(
            "the path of several axes in rapid traverse is checked against the stock on the straight line only: state `rapid` of the \
             control, or the `rapid` rates of the machine's axes"
        )]
        StockRapid,
        /// A work offset under which the tool stays far from the part.
        ///
        /// Something else stands there, which nothing was checked against.
        #[code = V0603]
        #[error(
            "under {offset} the tool never comes within its diameter of the part: check {offset} in `work_offsets`, state what stands \
             there as `[[other_part]]`, or give a job per part"
        )]
        FarOffset { offset: WorkOffset },
        /// A tool that is thinner than the points of the stock are apart.
        #[code = V0604]
        #[error(
            "{name} is thin for a stock whose points are {spacing} apart, and may pass through material {found} unseen: state a smaller \
             `spacing`, or a smaller `tolerance` of the stock"
        )]
        ThinTool { name: String, spacing: String, found: String },
        /// A set-up whose stock comes from one that is not clean.
        #[code = V0605]
        #[error(
            "the set-up before, whose stock this is, is not clean: verify {file} by itself"
        )]
        EarlierSetup { file: String },
        /// The motion to the first position after a tool change of a program of positions.
        ///
        /// A verdict is possible.
        #[code = V0606]
        #[error(
            "{count} motion{} to the first position after a tool change not checked, first to line {line}: only the machine knows where \
             they start",
            if *count == 1 { "" } else { "s" }
        )]
        ToolChange { count: usize, line: usize },
        /// The way to the first position at a height at which something stands.
        ///
        /// The program states Z before X, Y or rotary axes, so that the tool comes from wherever it stands, at that height. A body of the
        /// machine that does not move with the part can be anywhere.
        #[code = V0607]
        #[error(
            "the way to the first position in X, Y or rotary axes is not checked, and at Z it is lower than {name}: state them before this \
             Z, or a Z above it"
        )]
        LowWay { name: String },
        /// A comment of the program that describes another tool than the job has.
        ///
        /// Post-processors write the tools for which a program was made. A verdict about another tool says nothing about them.
        #[code = V0608]
        #[error(
            "the comment {comment} describes another T{number} than the job has, which is {mounted}{}: give the tool of the program, or \
             correct the comment", more_comments(*others)
        )]
        OtherTool { comment: String, number: u32, mounted: String, others: usize },
        /// The way to a reference position from a height at which something stands.
        ///
        /// G28, G30 or G53 moves Z with other axes to where only the machine knows, and so in a direction that is not known. Z alone goes
        /// straight up, which is checked.
        #[code = V0609]
        #[error(
            "the way to the reference position in X and Y is not checked, and begins lower than {name}: move Z there first, or state the \
             origin of G54 in `work_offsets`, and `home` of the axes"
        )]
        LowWayHome { name: String },
        /// A motion of an empty spindle (T0) at a height at which something stands.
        ///
        /// The job has no tool 0, and the shape of the spindle's nose is not known. Its gauge point has to stay above part, stock, fixtures
        /// and bodies of the machine, wherever X and Y are. Under tool centre point control, and where a head tilts the spindle, it is taken
        /// to be below all.
        #[code = V0610]
        #[error(
            "the gauge point of the empty spindle (T0) is not known to stay above {name}: move Z above it before, with a spindle that is not \
             tilted, or state `[tool.0]` with the shape of the spindle's nose and `length = 0`"
        )]
        LowSpindle { name: String },
        /// An earlier set-up whose own file accepts what is left open.
        ///
        /// A verdict is possible.
        #[code = V0611]
        #[error("the set-up before, whose stock this is, leaves something open, which {file} accepts by `anyway`")]
        AcceptedSetup { file: String },
        /// A motion aside at the top of Z's travel, whose place is not known, over something that is higher than the tool's tip by its length
        /// or, if that is not stated, as it is drawn.
        #[code = V0612]
        #[error(
            "at the top of Z, {} reaches lower than {name}: state its `length` and `home` of the axes, with which its motions there are \
             checked",
            tool.map_or("the tool".to_owned(), |tool| format!("T{tool}"))
        )]
        LowTop { name: String, tool: Option<u32> },
        /// A note in the library of a tool: programs of its system have another origin, or it has a holder that is not drawn.
        #[code = V0613]
        #[error("{tool}: {doubt}")]
        LibraryTool { tool: String, doubt: String },
    }
}

impl JobGap {
    /// Returns the gap that allows no verdict.
    fn open(&self, place: impl Into<BlockLine>) -> Gap {
        Gap::open(place, self.code(), self.to_string())
    }
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
