//! Errors that reach the page.

use touchoff::mesh::{GeometryError, MeshError};
use touchoff::{CloudError, ParseUnitError, PoseError};
use touchoff_haptics::SettingError;
use touchoff_verify::machine::MachineError;
use touchoff_verify::program::ProgramError;
use touchoff_verify::{JobError, VerifyError};

/// A request that could not be met. The message is meant for people.
#[derive(Debug, thiserror::Error)]
pub(crate) enum EngineError {
    /// The file of a part could not be read.
    #[error(transparent)]
    Geometry(#[from] GeometryError),
    /// A generated part is invalid.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// The part could not be sampled.
    #[error(transparent)]
    Cloud(#[from] CloudError),
    /// A unit is unknown.
    #[error(transparent)]
    Unit(#[from] ParseUnitError),
    /// A pose is invalid.
    #[error(transparent)]
    Pose(#[from] PoseError),
    /// A setting of the session is out of its range.
    #[error(transparent)]
    Setting(#[from] SettingError),
    /// A program cannot be read, or does not fit the part or the tool.
    #[error(transparent)]
    Program(#[from] ProgramError),
    /// A machine is unknown, or its file cannot be read.
    #[error(transparent)]
    Machine(#[from] MachineError),
    /// A program cannot be interpreted or checked.
    #[error(transparent)]
    Job(#[from] JobError),
    /// A tool cannot be certified.
    #[error(transparent)]
    Verify(#[from] VerifyError),
    /// A program has more motions than the page holds.
    #[error(
        "{name} has {motions} motions, and the page holds {limit}: check it with `touchoff verify`"
    )]
    LongProgram {
        /// The program's file.
        name: String,
        /// The number of motions.
        motions: usize,
        /// The greatest number that the page holds.
        limit: usize,
    },
    /// A tool of a program is not given.
    #[error("{}", missing_tool(*.0))]
    MissingTool(Option<u32>),
    /// The text of a tool that is checked has errors.
    #[error("{0} has errors: mend them in the editor, then the program is checked")]
    ToolErrors(String),
    /// A file has points only.
    #[error("{0} has points without triangles, which cannot be drawn: open a mesh")]
    NoTriangles(String),
    /// A generated part is unknown.
    #[error("no generated part is named `{0}`: take `pocket` or `tube`")]
    UnknownShape(String),
    /// A library tool is unknown.
    #[error("no library tool is in the file `{0}`")]
    UnknownTool(String),
    /// There is no part, tool or session yet.
    #[error("something is missing: load a part and a tool, and a program to check one")]
    NotLoaded,
    /// A pose has the wrong number of values.
    #[error("a pose has 7 values, the tip and a quaternion (x, y, z, w), not {0}")]
    PoseLength(usize),
    /// A box has the wrong number of values.
    #[error("a box has 6 values, its lowest and its highest corner, not {0}")]
    Corners(usize),
    /// The files given with a tool are not a JSON object of texts.
    #[error("the files of a tool must be a JSON object from path to text: {0}")]
    Files(#[from] serde_json::Error),
}

fn missing_tool(number: Option<u32>) -> String {
    match number {
        Some(number) => {
            format!("T{number} of the program has no tool: choose one beside the verdict")
        }
        None => "the program moves before its first tool change: choose a tool for these motions"
            .to_owned(),
    }
}
