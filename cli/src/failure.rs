//! Failures of the program, reported once at its end.

use touchoff::mesh::MeshError;
use touchoff::tool::ToolError;
use touchoff::{CloudError, ProgramError};

/// The exit status of a session that a signal ended, by the shells' convention.
pub(crate) const INTERRUPTED: u8 = 130;

impl Failure {
    /// Returns whether the message is the compiler's own, which begins with its severity.
    pub(crate) fn is_rendered(&self) -> bool {
        matches!(self, Failure::Tool(ToolError::Wrong(_)))
    }

    /// Returns the exit status: 2 if the options are wrong or an input cannot be used as requested, [`INTERRUPTED`]
    /// after a signal, 1 for all else.
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
        /// The requested code.
        code: String,
        /// The codes most like it.
        near: String,
    },
    /// A signal ended a session.
    #[error("the session was interrupted: all of it until then was kept")]
    Interrupted,
    /// The daemon of a SpaceMouse cannot be reached.
    #[error("{socket}: {source}: is `spacenavd` running?")]
    Spacenav {
        /// The daemon's socket.
        socket: &'static str,
        /// The reason.
        source: std::io::Error,
    },
    /// The system has no such core.
    #[error(transparent)]
    Core(#[from] touchoff::haptic::RealtimeError),
    /// A recording of the session is incomplete; the reason was reported when it happened.
    #[error("not all of the session was kept: make room, and record it again")]
    NotKept,
    /// A setting is out of range for the haptic loop.
    #[error(transparent)]
    Setting(#[from] touchoff::haptic::SettingError),
    /// The motion between two poses of a path is ambiguous.
    #[error(transparent)]
    Motion(touchoff::MotionError),
    /// The path could not be read.
    #[error(transparent)]
    Program(#[from] ProgramError),
    /// The tool could not be loaded.
    #[error(transparent)]
    Tool(#[from] ToolError),
    /// The requested proof is not possible.
    #[error(transparent)]
    Uncertified(#[from] touchoff::certify::NotCertifiable),
    /// A program could not be checked.
    #[error(transparent)]
    Verify(#[from] touchoff::verify::VerifyError),
    /// A sweep could not be done.
    #[error(transparent)]
    Sweep(#[from] touchoff::postures::sweep::SweepError),
    /// The rules of a sweep are invalid.
    #[error(transparent)]
    Rules(#[from] touchoff::postures::RulesError),
    /// A posture map could not be read or written.
    #[error(transparent)]
    Map(#[from] touchoff::postures::MapError),
    /// A session cannot be recorded.
    #[error(transparent)]
    Recorder(#[from] touchoff::postures::RecorderError),
    /// No path could be planned.
    #[error(transparent)]
    Path(#[from] touchoff::postures::path::PathError),
    /// A program could not be written.
    #[error(transparent)]
    Write(#[from] touchoff::program::WriteError),
    /// No format of a map has this file extension.
    #[error("a map is written as `.csv`, `.json`, `.ply` or `.png`, `{file}` is none of them")]
    MapForm {
        /// The requested file.
        file: String,
    },
    /// No format of a program has this file extension.
    #[error("a program is written as `.apt` or `.csv`, `{file}` is neither")]
    ProgramForm {
        /// The requested file.
        file: String,
    },
    /// The requested output shows the part, which was not given.
    #[error("`{file}` shows the part: give it with `--part`")]
    WantsPart {
        /// The file.
        file: String,
    },
    /// The map belongs to another part.
    #[error("{map} is of another part than {part}: give the mesh that was swept")]
    OtherPart {
        /// The map.
        map: String,
        /// The part.
        part: String,
    },
    /// The map does not have this tool.
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
    Shape(#[from] touchoff::mesh::GeometryError),
    /// A saved part could not be opened or written.
    #[error(transparent)]
    Saved(#[from] touchoff::SavedError),
    /// The file's extension is not that of a saved part.
    #[error("saved parts are told by their name: write `-o {}` instead of `{file}`", .better.display())]
    SavedName {
        /// The requested file.
        file: String,
        /// A suitable name.
        better: std::path::PathBuf,
    },
    /// The inside of the part is unknown.
    #[error("{file}: {}; mend the mesh, or give `--surface-only`", crate::part::NO_INSIDE)]
    NoInside {
        /// The part.
        file: String,
    },
    /// The request needs a mesh.
    #[error("`{what}` is for meshes: {file} has points and no triangles")]
    NoTriangles {
        /// The part.
        file: String,
        /// The request.
        what: &'static str,
    },
    /// No bound on the growth of the tool's depth is proved.
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
        /// The requested name.
        name: String,
        /// `; did you mean …?`, or nothing.
        meant: String,
    },
    /// `--set` was given, but no `.tool` file.
    #[error("`--set` is for `.tool` files: {0}")]
    NothingToSet(&'static str),
    /// Some `.tool` files have errors, which were shown.
    #[error("{wrong} of {all} files {} errors", if *.wrong == 1 { "has" } else { "have" })]
    Files {
        /// Number of files with errors.
        wrong: usize,
        /// Number of files checked.
        all: usize,
    },
    /// Some `.tool` files would be changed by `fmt`; their names were printed.
    #[error("{changed} of {all} files would change: `touchoff fmt` lays them out")]
    Unformatted {
        /// Number of files that would change.
        changed: usize,
        /// Number of files checked.
        all: usize,
    },
    /// No format of a drawing has this file extension.
    #[error("a drawing is an `.svg` or a `.png`, `{file}` is neither: write `-o {}`", .better.display())]
    Form {
        /// The requested file.
        file: String,
        /// A suitable name.
        better: std::path::PathBuf,
    },
    /// A solid without an axis has no section that shows it whole.
    #[error("`{0}` is a solid without an axis: only tools are drawn")]
    NoAxis(String),
    /// A drawing could not be rasterised.
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
        /// The reason.
        source: std::io::Error,
    },
    /// Standard output could not be written.
    #[error("the output could not be written whole: {0}")]
    Output(#[from] std::io::Error),
    /// A row could not be written as JSON.
    #[error("the output could not be written whole: {0}")]
    Json(#[from] serde_json::Error),
}

/// Returns the remedy for an unknown code.
fn near_codes(near: &str) -> String {
    match near {
        "" => "`touchoff explain` lists them".to_owned(),
        near => format!("did you mean `{near}`?"),
    }
}
