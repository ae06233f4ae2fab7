//! The arguments of the posture commands.

use super::values::{
    allowance, direction, direction_count, finite, point, positive, positive_length, posture_count,
    tilt, tool_number,
};
use super::{MeshFile, ToolArguments};
use clap::{Args, ValueEnum};
use nalgebra::Point3;
use std::ffi::OsString;
use std::num::NonZeroU16;
use std::path::PathBuf;
use touchoff::Shard;

#[derive(Args)]
pub(crate) struct Sweep {
    #[command(flatten)]
    pub(crate) mesh: MeshFile,
    /// Built-in tool by name (`touchoff tools` lists them), or any `.tool` file; several by commas or by repeating
    /// the option.
    #[arg(long = "tool", required = true, value_delimiter = ',', value_name = "NAME|FILE.tool")]
    pub(crate) tools: Vec<OsString>,
    #[command(flatten)]
    pub(crate) params: ToolArguments,
    /// Number of directions per hemisphere, from 1 to 2000.
    #[arg(long, value_name = "NUMBER", default_value_t = 200, value_parser = direction_count)]
    pub(crate) directions: u16,
    /// Largest depth allowed for surfaces that cut, in the part's unit [default: 0.01 mm].
    #[arg(long, value_name = "LENGTH", value_parser = positive_length)]
    pub(crate) tolerance: Option<f64>,
    /// Niceness that a contact has to exceed.
    #[arg(long, value_name = "NUMBER", default_value_t = 0.0, value_parser = finite)]
    pub(crate) min_niceness: f64,
    /// Largest depth allowed for a surface in the part, in the part's unit; below 0, a distance to keep. A surface
    /// that does not cut and is not named may not touch.
    #[arg(long, value_name = "SURFACE=LENGTH", value_parser = allowance)]
    pub(crate) allow: Vec<(String, f64)>,
    /// Number of postures to keep per triangle, from 1 to 65535.
    #[arg(long, value_name = "NUMBER", default_value_t = NonZeroU16::MIN, value_parser = posture_count)]
    pub(crate) keep: NonZeroU16,
    /// Divide triangles into pieces, and judge each piece: those with edges longer than eight times LENGTH, and down
    /// to edges of LENGTH where neighbours differ in whether or how nicely a tool reaches them. LENGTH is in the
    /// part's unit [default: a quarter of the least cutting radius of the tools].
    #[arg(long, value_name = "LENGTH", num_args = 0..=1, value_parser = positive_length)]
    pub(crate) refine: Option<Option<f64>>,
    /// Check only the part's surface where its mesh leaks or is inside out, so that its inside is unknown. Without
    /// this option, such a part ends with status 2.
    #[arg(long)]
    pub(crate) surface_only: bool,
    /// Table of postures that were exported from the page of `touchoff live`. They are proved and added to the map, in
    /// place of a sweep.
    #[arg(long, value_name = "FILE.csv", requires = "output", conflicts_with = "refine")]
    pub(crate) touched: Option<PathBuf>,
    /// Sweep one part of the triangles only, such as 3/8, the third of eight, into a table that `touchoff merge` joins
    /// with the others. A table that is there already is kept.
    #[arg(long, value_name = "NUMBER/COUNT", requires = "output", conflicts_with_all = ["refine", "touched"])]
    pub(crate) shard: Option<Shard>,
    /// Posture map to fill; triangles that it already has are skipped. With `--shard`, a table in `.parquet`.
    #[arg(short, long, value_name = "MAP")]
    pub(crate) output: Option<PathBuf>,
}

#[derive(Args)]
pub(crate) struct Merge {
    /// Tables of `touchoff sweep --shard`, in any order.
    #[arg(value_name = "SHARD.parquet", required = true)]
    pub(crate) files: Vec<PathBuf>,
    /// Output file: a new posture map in `.postures`, one table in `.parquet`. Can be repeated.
    #[arg(short, long, value_name = "OUT.postures|.parquet")]
    pub(crate) output: Vec<PathBuf>,
    /// List the shards that are missing or cannot be read, one per line, and end with status 3 if there are any.
    #[arg(long, conflicts_with = "output")]
    pub(crate) left: bool,
}

#[derive(Args)]
pub(crate) struct Map {
    /// Posture map, filled by `sweep` or by the recorder of a haptic loop.
    #[arg(value_name = "MAP")]
    pub(crate) map: PathBuf,
    /// Output file: a table in `.csv` or `.parquet`, the whole map in `.json`, the part coloured by niceness in `.ply`,
    /// pictures in `.png`. Can be repeated.
    #[arg(short, long, value_name = "OUT.csv|.parquet|.json|.ply|.png")]
    pub(crate) output: Vec<PathBuf>,
    /// Quantity that pictures show.
    #[arg(long, value_enum, value_name = "QUANTITY", default_value_t = Quantity::Niceness)]
    pub(crate) color_by: Quantity,
    /// Tool whose accessibility or least stick-out pictures show, by its name in the map [default: all tools, so that the
    /// least stick-out is that of any].
    #[arg(long, value_name = "NAME")]
    pub(crate) tool: Option<String>,
    /// Part, for `.parquet`, `.ply` and `.png`: a mesh in STL, PLY or OBJ, in the map's unit.
    #[arg(long, value_name = "FILE")]
    pub(crate) part: Option<PathBuf>,
}

/// The quantity that pictures show.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Quantity {
    /// Niceness of the best posture.
    Niceness,
    /// Solid angle from which the tools reach a triangle, in steradians.
    Accessibility,
    /// Least stick-out of a tool from its own holder, at most that of the tool as it is.
    StickOut,
}

#[derive(Args)]
pub(crate) struct Path {
    /// Posture map, filled by `sweep`.
    #[arg(value_name = "MAP")]
    pub(crate) map: PathBuf,
    /// Part: the mesh that was swept, in the map's unit.
    #[arg(long, value_name = "FILE")]
    pub(crate) part: PathBuf,
    /// Tool, one of the map's: by name or as a `.tool` file.
    #[arg(long, value_name = "NAME|FILE.tool")]
    pub(crate) tool: OsString,
    #[command(flatten)]
    pub(crate) params: ToolArguments,
    /// Largest depth allowed for surfaces that cut, at cutter locations and between them, in the part's unit
    /// [default: the map's tolerance].
    #[arg(long, value_name = "LENGTH", value_parser = positive_length)]
    pub(crate) tolerance: Option<f64>,
    /// Normal of the parallel planes whose lines on the part are followed.
    #[arg(long, value_name = "X,Y,Z", value_parser = direction, default_value = "1,0,0")]
    pub(crate) plane_normal: Point3<f64>,
    /// Distance between planes, in the part's unit.
    #[arg(long, value_name = "LENGTH", value_parser = positive_length)]
    pub(crate) stepover: f64,
    /// Largest distance between points on a line, in the part's unit [default: half the stepover].
    #[arg(long, value_name = "LENGTH", value_parser = positive_length)]
    pub(crate) forward_step: Option<f64>,
    /// Largest angle between the tool axis and +z of the part, in degrees, above 0 and up to 180 [default: 180, any
    /// axis]. With 90 no tool axis points below the table. The limits of the rotary axes of `--machine` hold as well.
    #[arg(long, value_name = "DEGREES", value_parser = tilt)]
    pub(crate) max_tilt: Option<f64>,
    /// Number of the tool: `LOADTL` in `.apt`, `T`, `M6` and `H` in `.nc`, which needs it.
    #[arg(long, value_name = "NUMBER", value_parser = tool_number)]
    pub(crate) tool_number: Option<u32>,
    /// Feed per minute, in the part's unit: `FEDRAT` in `.apt`, `F` in `.nc`, which needs it.
    #[arg(long, value_name = "LENGTH", value_parser = positive)]
    pub(crate) feed: Option<f64>,
    /// Spindle speed in revolutions per minute, clockwise: `SPINDL` in `.apt`, `S` and `M3` in `.nc`.
    #[arg(long, value_name = "RPM", value_parser = positive)]
    pub(crate) spindle: Option<f64>,
    #[command(flatten)]
    pub(crate) machine: MachineArguments,
    /// Stock that the program starts with, in the frame of the part and the map's unit: a mesh in STL, PLY or OBJ. Rapid
    /// traverse keeps clear of it, and the tool moves through it in feed.
    #[arg(long, value_name = "FILE")]
    pub(crate) stock: Option<PathBuf>,
    /// Check only the part's surface where its mesh leaks or is inside out, so that its inside is unknown. Without
    /// this option, such a part ends with status 2.
    #[arg(long)]
    pub(crate) surface_only: bool,
    /// Output file for the program: APT-CL in `.apt`, a table in `.csv`, G-code for a machine in `.nc`.
    #[arg(short, long, value_name = "OUT.apt|.csv|.nc")]
    pub(crate) output: PathBuf,
    /// Output file for a picture of the points that are left out, by reason.
    #[arg(long, value_name = "OUT.png")]
    pub(crate) picture: Option<PathBuf>,
}

/// The machine of a G-code program.
#[derive(Args)]
pub(crate) struct MachineArguments {
    /// Machine of `.nc`, which needs it: a built-in one by name, such as `A-C trunnion`, or a file.
    #[arg(long, value_name = "NAME|FILE.toml")]
    pub(crate) machine: Option<PathBuf>,
    /// Origin of the part in machine coordinates (G54), in the part's unit. With it the limits of the linear axes and
    /// the way from the home position are checked; needs `--tool-length`.
    #[arg(long, value_name = "X,Y,Z", value_parser = point, requires_all = ["machine", "tool_length"])]
    pub(crate) work_offset: Option<Point3<f64>>,
    /// Distance from the tip to the gauge point of the spindle, in the part's unit; needs `--work-offset`.
    #[arg(long, value_name = "LENGTH", value_parser = positive_length, requires = "work_offset")]
    pub(crate) tool_length: Option<f64>,
}
