//! Reasons for which a job is refused: in its file, and in what it names.

use crate::codes::faults;
use crate::gcode::{BlankDoubt, ControlError, ControlRules, GENERIC, WorkOffset};
use crate::machine::{JointError, MAX_NAME, MachineError};
use crate::program::ProgramError;
use crate::stock::StockError;
use crate::{MachineProgramError, VerifyError};
use std::convert::Infallible;
use touchoff::mesh::{GeometryError, MeshError};
use touchoff::{ParseUnitError, PoseError};

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
