//! Why the program fails, said once at its end.

use touchoff::mesh::MeshError;
use touchoff::tool::ToolError;
use touchoff::{CloudError, ProgramError};

/// The exit status of a session that a signal ended, as shells have it.
pub(crate) const INTERRUPTED: u8 = 130;

impl Failure {
    /// Returns whether the words are those of the compiler, which begin with their severity.
    pub(crate) fn is_rendered(&self) -> bool {
        matches!(self, Failure::Tool(ToolError::Wrong(_)))
    }

    /// The exit status: 2 where the options are wrong or an input cannot be taken as what was asked for, 1 for all
    /// else.
    pub(crate) fn status(&self) -> u8 {
        match self {
            Failure::IsInput { .. } | Failure::Program(_) | Failure::NoInside { .. } => 2,
            Failure::Interrupted => INTERRUPTED,
            _ => 1,
        }
    }
}

/// The reason for which the program ends with an exit status other than 0.
#[derive(Debug, thiserror::Error)]
pub(crate) enum Failure {
    /// A cloud could not be made.
    #[error(transparent)]
    Cloud(#[from] CloudError),
    /// A mesh could not be made.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// There is no such device.
    #[error("{0}")]
    Device(String),
    /// No diagnostic has such a code.
    #[error("no code is called `{code}`: {}", near_codes(near))]
    Code {
        /// The code that was asked for.
        code: String,
        /// The codes that are most like it.
        near: String,
    },
    /// A signal ended a session.
    #[error("the session was interrupted: all of it until then was kept")]
    Interrupted,
    /// Nobody speaks for a SpaceMouse.
    #[error("{socket}: {source}: is `spacenavd` running?")]
    Spacenav {
        /// Where it would listen.
        socket: &'static str,
        /// Why not.
        source: std::io::Error,
    },
    /// The system has no such core.
    #[error(transparent)]
    Core(#[from] touchoff::haptic::Refused),
    /// A part of what was to be kept of a session was not; the reason was said when it happened.
    #[error("not all of the session was kept: make room, and record it again")]
    NotKept,
    /// A number that the haptic loop cannot run with.
    #[error(transparent)]
    Setting(#[from] touchoff::haptic::SettingError),
    /// A path does not say which way it goes.
    #[error(transparent)]
    Motion(touchoff::MotionError),
    /// The path could not be read.
    #[error(transparent)]
    Program(#[from] ProgramError),
    /// The tool could not be loaded.
    #[error(transparent)]
    Tool(#[from] ToolError),
    /// What was asked to be proved cannot be.
    #[error(transparent)]
    Uncertified(#[from] touchoff::certify::Uncertified),
    /// A program could not be checked.
    #[error(transparent)]
    Verify(#[from] touchoff::verify::VerifyError),
    /// A sweep could not be done.
    #[error(transparent)]
    Sweep(#[from] touchoff::postures::sweep::SweepError),
    /// Rules mean nothing.
    #[error(transparent)]
    Rules(#[from] touchoff::postures::RulesError),
    /// A posture map could not be read or written.
    #[error(transparent)]
    Map(#[from] touchoff::postures::MapError),
    /// Nothing can be recorded of a session.
    #[error(transparent)]
    Recorder(#[from] touchoff::postures::RecorderError),
    /// There is no path.
    #[error(transparent)]
    Path(#[from] touchoff::postures::path::PathError),
    /// A program could not be written.
    #[error(transparent)]
    Write(#[from] touchoff::program::WriteError),
    /// A map is written in a form that there is none of.
    #[error("a map is written as `.csv`, `.json`, `.ply` or `.png`, `{file}` is none of them")]
    MapForm {
        /// What was asked for.
        file: String,
    },
    /// A program is written in a form that there is none of.
    #[error("a program is written as `.apt` or `.csv`, `{file}` is neither")]
    ProgramForm {
        /// What was asked for.
        file: String,
    },
    /// A form of a map that shows the part.
    #[error("`{file}` shows the part: give it with `--part`")]
    WantsPart {
        /// The file.
        file: String,
    },
    /// A map of another part.
    #[error("{map} is of another part than {part}: give the mesh that was swept")]
    OtherPart {
        /// The map.
        map: String,
        /// The part.
        part: String,
    },
    /// A tool that a map does not have.
    #[error(
        "{map} has no `{tool}`, or that of another version: sweep with it first, into another map"
    )]
    OtherTool {
        /// The map.
        map: String,
        /// The tool.
        tool: String,
    },
    /// The part's file could not be read.
    #[error(transparent)]
    Shape(#[from] touchoff::mesh::ShapeError),
    /// A saved part could not be opened or written.
    #[error(transparent)]
    Saved(#[from] touchoff::SavedError),
    /// A saved part is told by its name.
    #[error("saved parts are told by their name: write `-o {}` instead of `{file}`", .better.display())]
    SavedName {
        /// What was asked for.
        file: String,
        /// A name that would do.
        better: std::path::PathBuf,
    },
    /// It is not known what is inside a part.
    #[error("{file}: {}; mend the mesh, or give `--surface-only`", crate::part::NO_INSIDE)]
    NoInside {
        /// The part.
        file: String,
    },
    /// What is asked for wants a mesh.
    #[error("`{what}` is for meshes: {file} has points and no triangles")]
    NoTriangles {
        /// The part.
        file: String,
        /// What was asked for.
        what: &'static str,
    },
    /// Nothing is proved of how a tool's depth grows.
    #[error(
        "how fast depth grows in `{0}` is not proved (`touchoff check` says why), so no number of points \
         has a tolerance: give `--points`"
    )]
    NoSteepness(String),
    /// No tool has this name.
    #[error(
        "no tool is called `{name}`{meant}: `touchoff tools` lists them; a file's name ends in `.tool`"
    )]
    UnknownTool {
        /// What was asked for.
        name: String,
        /// `; did you mean …?`, or nothing.
        meant: String,
    },
    /// What is compiled has its values.
    #[error("`--set` is for `.tool` files: {0}")]
    NothingToSet(&'static str),
    /// Some `.tool` files have errors, which were shown.
    #[error("{wrong} of {all} files {} errors", if *.wrong == 1 { "has" } else { "have" })]
    Files {
        /// How many have errors.
        wrong: usize,
        /// How many were looked at.
        all: usize,
    },
    /// Some `.tool` files would be changed by `fmt`; they were named.
    #[error("{changed} of {all} files would change: `touchoff fmt` lays them out")]
    Unformatted {
        /// How many would change.
        changed: usize,
        /// How many were looked at.
        all: usize,
    },
    /// A drawing is wanted in a form that there is none of.
    #[error("a drawing is an `.svg` or a `.png`, `{file}` is neither: write `-o {}`", .better.display())]
    Form {
        /// What was asked for.
        file: String,
        /// A name that would do.
        better: std::path::PathBuf,
    },
    /// A shape without an axis has no section that shows it whole.
    #[error("`{0}` is a solid without an axis: only tools are drawn")]
    NoAxis(String),
    /// A drawing could not be made into pixels.
    #[error("the drawing could not be made a PNG: {0}; an `.svg` needs no pixels")]
    Pixels(String),
    /// An output is also an input.
    #[error("`{output}` is `{input}`, which is read: write to another file")]
    IsInput {
        /// The output.
        output: String,
        /// The input that is the same file.
        input: String,
    },
    /// A file could not be written.
    #[error("cannot write `{file}`: {source}; does its folder exist, and may you write there?")]
    Unwritable {
        /// The file.
        file: String,
        /// Why.
        source: std::io::Error,
    },
    /// Standard output could not be written.
    #[error("the output could not be written whole: {0}")]
    Output(#[from] std::io::Error),
    /// A row could not be written as JSON.
    #[error("the output could not be written whole: {0}")]
    Json(#[from] serde_json::Error),
}

/// The remedy for a code that there is none of.
fn near_codes(near: &str) -> String {
    match near {
        "" => "`touchoff explain` lists them".to_owned(),
        near => format!("did you mean `{near}`?"),
    }
}
