//! The arguments of the posture commands.

use super::{MeshFile, above_zero, allowance, point};
use clap::{Args, ValueEnum};
use nalgebra::Point3;
use std::ffi::OsString;
use std::num::NonZeroU16;
use std::path::PathBuf;

#[derive(Args)]
pub(crate) struct Sweep {
    #[command(flatten)]
    pub(crate) mesh: MeshFile,
    /// Compiled tools by name, or `.tool` files.
    #[arg(long, required = true, num_args = 1.., value_delimiter = ',', value_name = "NAME|FILE.tool")]
    pub(crate) tools: Vec<OsString>,
    /// Number of directions per hemisphere, from 1 to 2000.
    #[arg(long, default_value_t = 200, value_parser = clap::value_parser!(u16).range(1..=2000), allow_hyphen_values = true)]
    pub(crate) directions: u16,
    /// Largest depth allowed for surfaces that cut, in the part's unit [default: 0.01 mm].
    #[arg(long, value_name = "LENGTH", value_parser = above_zero, allow_hyphen_values = true)]
    pub(crate) tolerance: Option<f64>,
    /// Niceness that a contact has to exceed.
    #[arg(long, default_value_t = 0.0, allow_hyphen_values = true)]
    pub(crate) niceness: f64,
    /// Largest depth allowed for a surface in the part, in the part's unit; below 0, a distance to keep. A surface
    /// that does not cut and is not named may not touch.
    #[arg(long, value_name = "SURFACE=LENGTH", value_parser = allowance, allow_hyphen_values = true)]
    pub(crate) allow: Vec<(String, f64)>,
    /// Number of postures to keep per triangle.
    #[arg(long, default_value_t = NonZeroU16::MIN, allow_hyphen_values = true)]
    pub(crate) keep: NonZeroU16,
    /// Check only the part's surface where its mesh leaks or is inside out, so that its inside is unknown. Without
    /// this option, such a part ends with status 2.
    #[arg(long)]
    pub(crate) surface_only: bool,
    /// Posture map to fill; triangles that it already has are skipped.
    #[arg(short, long, value_name = "MAP")]
    pub(crate) out: Option<PathBuf>,
}

#[derive(Args)]
pub(crate) struct Map {
    /// Posture map, filled by `sweep` or by the recorder of a haptic loop.
    #[arg(value_name = "MAP")]
    pub(crate) map: PathBuf,
    /// Output files: a table in `.csv`, the whole map in `.json`, the part coloured by niceness in `.ply`, pictures
    /// in `.png`.
    #[arg(long, value_name = "OUT.csv|.json|.ply|.png")]
    pub(crate) to: Vec<PathBuf>,
    /// Quantity that pictures show.
    #[arg(long, value_enum, default_value_t = Shown::Niceness)]
    pub(crate) by: Shown,
    /// Part, for `.ply` and `.png`: a mesh in STL, PLY or OBJ.
    #[arg(long, value_name = "FILE")]
    pub(crate) part: Option<PathBuf>,
}

/// The quantity that pictures show.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Shown {
    /// Niceness of the best posture.
    Niceness,
    /// Solid angle from which any tool reaches a triangle.
    Access,
    /// Least stick-out of a tool from its holder.
    Stickout,
}

#[derive(Args)]
pub(crate) struct Path {
    /// Posture map, filled by `sweep`.
    #[arg(value_name = "MAP")]
    pub(crate) map: PathBuf,
    /// Part: the mesh that was swept.
    #[arg(long, value_name = "FILE")]
    pub(crate) part: PathBuf,
    /// Tool, one of the map's: by name or as a `.tool` file.
    #[arg(long, value_name = "NAME|FILE.tool")]
    pub(crate) tool: OsString,
    /// Largest depth allowed for surfaces that cut, at cutter locations and between them, in the part's unit
    /// [default: the map's tolerance].
    #[arg(long, value_name = "LENGTH", value_parser = above_zero, allow_hyphen_values = true)]
    pub(crate) tolerance: Option<f64>,
    /// Normal of the parallel planes whose lines on the part are followed.
    #[arg(long, value_name = "X,Y,Z", value_parser = point, default_value = "1,0,0", allow_hyphen_values = true)]
    pub(crate) planes: Point3<f64>,
    /// Distance between planes, in the part's unit.
    #[arg(long, value_name = "LENGTH", value_parser = above_zero, allow_hyphen_values = true)]
    pub(crate) stepover: f64,
    /// Largest distance between points on a line, in the part's unit [default: half the stepover].
    #[arg(long, value_name = "LENGTH", value_parser = above_zero, allow_hyphen_values = true)]
    pub(crate) step: Option<f64>,
    /// Check only the part's surface where its mesh leaks or is inside out, so that its inside is unknown. Without
    /// this option, such a part ends with status 2.
    #[arg(long)]
    pub(crate) surface_only: bool,
    /// Output file for the program.
    #[arg(long, value_name = "OUT.apt|.csv")]
    pub(crate) to: PathBuf,
}
