//! Failures of the program, reported once at its end.

use std::error::Error;
use std::path::{Path, PathBuf};
use touchoff::tool::ToolError;
use touchoff_import::FindError;
use touchoff_verify::stock::StockError;
use touchoff_verify::{JobError, ProgramError, VerifyError};

/// The exit status of a session that a signal ended, by the shells' convention.
pub(crate) const INTERRUPTED: u8 = 130;

impl Failure {
    /// Returns whether the message is the compiler's own, which begins with its severity.
    pub(crate) fn is_rendered(&self) -> bool {
        matches!(self, Failure::Tool(ToolError::Invalid(_)))
    }

    /// Returns whether the message lists faults, one per line, and has escaped what it shows of files.
    pub(crate) fn has_lines(&self) -> bool {
        let Failure::Refused { error, .. } = self else { return false };
        let error = match error.downcast_ref() {
            Some(JobError::Verify(VerifyError::Allowances(_))) => return true,
            Some(JobError::Program(error)) => Some(error),
            _ => error.downcast_ref(),
        };
        matches!(error, Some(ProgramError::Line { .. }))
    }

    /// Returns the code of the [table](touchoff_verify::codes), if the failure has one.
    pub(crate) fn code(&self) -> Option<&'static str> {
        match self {
            Failure::Refused { code, .. } | Failure::Coded { code, .. } => Some(code),
            Failure::StockNoInside { .. } => Some(StockError::NoInside { what: "stock" }.code()),
            _ => None,
        }
    }

    /// Returns the exit status: 2 if the options are wrong or an input cannot be used as requested, [`INTERRUPTED`]
    /// after a signal, 1 for all else.
    pub(crate) fn status(&self) -> u8 {
        match self {
            Failure::Usage(_)
            | Failure::IsInput { .. }
            | Failure::SameOutput { .. }
            | Failure::NoFolder { .. }
            | Failure::Refused { .. }
            | Failure::MeshForJob { .. }
            | Failure::Find(
                FindError::Several { .. } | FindError::Numbers { .. } | FindError::NoName { .. },
            )
            | Failure::NoInside { .. } => 2,
            Failure::Interrupted => INTERRUPTED,
            _ => 1,
        }
    }

    /// Returns the failure for an output whose extension is not that of its format, as `rule` states it; `extension` is one
    /// that is.
    pub(crate) fn extension(rule: &'static str, file: &Path, extension: &str) -> Failure {
        let better = file.with_extension(extension);
        Failure::Extension { rule, file: file.display().to_string(), better }
    }
}

/// The reason for which the program ends with an exit status other than 0.
#[derive(Debug, thiserror::Error)]
pub(crate) enum Failure {
    /// A program, a job, a machine or a control cannot be used as requested.
    #[error("{error}")]
    Refused { code: &'static str, error: Box<dyn Error + Send + Sync> },
    /// A program, a stock or joint values could not be computed with.
    #[error("{error}")]
    Coded { code: &'static str, error: Box<dyn Error + Send + Sync> },
    /// A library could not do what was asked for.
    #[error("{0}")]
    Library(Box<dyn Error + Send + Sync>),
    /// The tool could not be loaded.
    #[error(transparent)]
    Tool(#[from] ToolError),
    /// The options do not go together, or this system lacks the device.
    #[error("{0}")]
    Usage(&'static str),
    /// No folder can be named after a library.
    #[error(
        "no folder can be named after {file}, or a link has that name: name the one for its tools by `-o`"
    )]
    NoFolder { file: String },
    /// Nothing has such a code.
    #[error("no error, warning, finding or gap has the code `{code}`: {}", near_codes(near))]
    Code {
        code: String,
        /// The codes most like it.
        near: String,
    },
    /// A table of touched postures is refused.
    #[error("{file}, line {line}: {reason}")]
    Touched {
        file: String,
        /// The line, 1-based.
        line: usize,
        /// The reason, and the remedy.
        reason: String,
    },
    /// A signal ended a session.
    #[error("the session was interrupted; what was recorded until then is complete")]
    Interrupted,
    /// The port of the page is taken or not allowed.
    #[error(
        "cannot listen at 127.0.0.1:{port}: {source}; give another `--port`, or none for a free one"
    )]
    Port { port: u16, source: std::io::Error },
    /// The daemon of a SpaceMouse cannot be reached.
    #[error(
        "cannot reach the SpaceMouse at {socket}: {source}: start `spacenavd`, or take another `--device`"
    )]
    Spacenav {
        /// The daemon's socket.
        socket: &'static str,
        source: std::io::Error,
    },
    /// A recording of the session is incomplete; the reason was reported when it happened.
    #[error("the recording is incomplete: make room on the disk, and run the session again")]
    RecordingFailed,
    /// A mesh stands where a job file does.
    #[error(
        "`{file}` is a mesh, and `verify` takes a job file: name a mesh by `--part`, with `--unit`, `--tool` and `--program`"
    )]
    MeshForJob {
        /// The mesh.
        file: String,
    },
    /// No tool of a library or a folder is selected.
    #[error(transparent)]
    Find(#[from] FindError),
    /// A file could not be read.
    #[error("{file}: cannot be read ({source}): check the path and its permissions")]
    Unreadable { file: String, source: std::io::Error },
    /// The requested output shows the part, which was not given.
    #[error("`{file}` shows the part: give its mesh with `--part FILE`")]
    PartMissing { file: String },
    /// The map belongs to another part.
    #[error(
        "{map} belongs to another part than {part}: give the mesh that was swept, unchanged and in the same unit"
    )]
    OtherPart { map: String, part: String },
    /// The map does not have this tool.
    #[error(
        "{map} was not swept with this `{tool}`: sweep with it into another map, or give the `--tool` and `--set` of the \
         sweep"
    )]
    OtherTool { map: String, tool: String },
    /// The inside of the part is unknown.
    #[error(
        "{file}: {}: repair the mesh, or check its surface alone with `--surface-only`",
        touchoff_verify::job::NO_INSIDE
    )]
    NoInside { file: String },
    /// The inside of the stock is unknown.
    #[error("{file}: {}", StockError::NoInside { what: "stock" })]
    StockNoInside { file: String },
    /// The request needs a mesh.
    #[error(
        "`{what}` needs triangles, and {file} has only points: give the mesh that they were sampled from"
    )]
    NoTriangles { file: String, what: &'static str },
    /// No bound on the growth of the tool's depth is proved.
    #[error(
        "no Lipschitz constant of the depth of `{0}` is proved (`touchoff check` says why), so no number of points \
         guarantees a sampling error: give `--points` instead"
    )]
    NoLipschitz(String),
    /// No tool has this name.
    #[error("no built-in tool is called `{name}`: {hint}")]
    UnknownTool {
        name: String,
        /// The remedy.
        hint: String,
    },
    /// A built-in tool was named where a file is expected.
    #[error(
        "`{0}` is a built-in tool, and a file is expected here: `touchoff tools show {0} -o FILE.tool` writes its file"
    )]
    FileExpected(String),
    /// `--set` was given, but no `.tool` file to take the values.
    #[error("`--set` gives values to the params of `.tool` files, and there is none: {0}")]
    UnusedParams(&'static str),
    /// A built-in tool was given values.
    #[error(
        "`{0}` is a built-in tool, whose values are fixed, so `--set` does not apply: `touchoff tools show {0} -o \
         FILE.tool` writes its text to a file, which `--tool FILE.tool --set` changes"
    )]
    FixedParams(String),
    /// Some `.tool` files have errors, which were shown.
    #[error("{wrong} of {all} files {} errors", if *.wrong == 1 { "has" } else { "have" })]
    Files {
        /// Number of files with errors.
        wrong: usize,
        /// Number of files checked.
        all: usize,
    },
    /// Some `.tool` files would be changed by `fmt`; their names were printed.
    #[error("{changed} of {all} files would be rewritten: run `touchoff fmt` without `--check`")]
    Unformatted {
        /// Number of files that would change.
        changed: usize,
        /// Number of files checked.
        all: usize,
    },
    /// The output's extension is that of no format.
    #[error("{formats}, and `{file}` is none of them: change its extension")]
    Format {
        /// The formats, in a sentence.
        formats: &'static str,
        file: String,
    },
    /// The output's extension is not that of its format.
    #[error("{rule}: write `-o {}` instead of `{file}`", .better.display())]
    Extension {
        /// The extensions of the format, in a sentence.
        rule: &'static str,
        file: String,
        /// A suitable name.
        better: PathBuf,
    },
    /// No format of a drawing has this file extension.
    #[error("a drawing is an `.svg` or a `.png`, and `{file}` is neither: write `-o {}`", .better.display())]
    DrawingFormat {
        file: String,
        /// A suitable name.
        better: PathBuf,
    },
    /// A file that a tool mounts would replace another.
    #[error(
        "`{name}` mounts a file that would replace `{file}`: write the tool to another name or another folder"
    )]
    MountedFileExists { file: String, name: String },
    /// A drawing could not be rasterised.
    #[error("the PNG could not be rendered: {0}: write an `.svg`, or another format")]
    Pixels(String),
    /// An output is also an input.
    #[error("the output `{output}` is also an input (`{input}`): write to another file")]
    IsInput {
        output: String,
        /// The input that is the same file.
        input: String,
    },
    /// Two outputs are one file.
    #[error("`{output}` is named for two outputs: write one of them to another file")]
    SameOutput { output: String },
    /// A file could not be written.
    #[error("cannot write `{file}`: {}", cause(source))]
    Unwritable { file: String, source: std::io::Error },
    /// The system allows no thread for `--max-time`.
    #[error(
        "the system refuses a thread for `--max-time`: {0}: allow more threads or memory, or leave the option out"
    )]
    NoTimer(std::io::Error),
    /// Standard output could not be written.
    #[error("standard output could not be written: {}", cause(.0))]
    Output(#[from] std::io::Error),
    /// A row could not be written as JSON.
    #[error("standard output could not be written: {0}: redirect it elsewhere")]
    Json(#[from] serde_json::Error),
}

/// Converts errors of libraries, which the exit status and the code tell apart.
macro_rules! converted {
    ($variant:ident of code: $($error:ty),* $(,)?) => {
        $(impl From<$error> for Failure {
            fn from(error: $error) -> Failure {
                Failure::$variant { code: error.code(), error: Box::new(error) }
            }
        })*
    };
    ($variant:ident: $($error:ty),* $(,)?) => {
        $(impl From<$error> for Failure {
            fn from(error: $error) -> Failure {
                Failure::$variant(Box::new(error))
            }
        })*
    };
}

converted! {
    Refused of code:
    touchoff_verify::ProgramError,
    touchoff_verify::JobError,
    touchoff_verify::MachineProgramError,
    touchoff_verify::gcode::ControlError,
    touchoff_verify::machine::MachineError,
}

converted! {
    Coded of code:
    touchoff_verify::VerifyError,
    touchoff_verify::machine::JointError,
    touchoff_verify::program::WriteError,
    touchoff_verify::stock::StockError,
}

converted! {
    Library:
    touchoff::CloudError,
    touchoff::MotionError,
    touchoff::SavedError,
    touchoff::certify::NotCertifiable,
    touchoff::mesh::GeometryError,
    touchoff::mesh::MeshError,
    touchoff_haptics::RealtimeError,
    touchoff_haptics::SettingError,
    touchoff_import::ImportError,
    touchoff_postures::MapError,
    touchoff_postures::RecorderError,
    touchoff_postures::RulesError,
    touchoff_postures::path::PathError,
    touchoff_postures::post::PostError,
    touchoff_postures::shard::ShardError,
    touchoff_postures::sweep::SweepError,
}

/// Returns the cause of a failure to write, and its remedy.
fn cause(error: &std::io::Error) -> String {
    use std::io::ErrorKind;
    match error.kind() {
        ErrorKind::NotFound => {
            "its folder does not exist: create it, or write elsewhere".to_owned()
        }
        ErrorKind::StorageFull | ErrorKind::QuotaExceeded | ErrorKind::FileTooLarge => {
            format!("{error}: make room, or write elsewhere")
        }
        _ => format!("{error}: check its folder and your permissions, or write elsewhere"),
    }
}

/// Returns the remedy for an unknown code.
fn near_codes(near: &str) -> String {
    match near {
        "" => "`touchoff explain` lists all codes".to_owned(),
        near => format!("did you mean `{near}`?"),
    }
}
