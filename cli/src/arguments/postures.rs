//! What the commands about postures are asked for.

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
    /// Directions that each hemisphere has.
    #[arg(long, default_value_t = 200, value_parser = clap::value_parser!(u16).range(1..=2000), allow_hyphen_values = true)]
    pub(crate) directions: u16,
    /// How deep the part may be in what cuts, in the part's unit [default: 0.01 mm].
    #[arg(long, value_name = "LENGTH", value_parser = above_zero, allow_hyphen_values = true)]
    pub(crate) tolerance: Option<f64>,
    /// Contacts have to be nicer than this.
    #[arg(long, default_value_t = 0.0, allow_hyphen_values = true)]
    pub(crate) niceness: f64,
    /// How deep a surface may be in the part, in the part's unit; below 0, how far it has to keep. What does
    /// not cut and is not named may not touch.
    #[arg(long, value_name = "SURFACE=LENGTH", value_parser = allowance, allow_hyphen_values = true)]
    pub(crate) allow: Vec<(String, f64)>,
    /// Postures that are kept of each triangle.
    #[arg(long, default_value_t = NonZeroU16::MIN, allow_hyphen_values = true)]
    pub(crate) keep: NonZeroU16,
    /// Look at the part's surface alone where its mesh leaks or is inside out, so that what is inside is unknown.
    #[arg(long)]
    pub(crate) surface_only: bool,
    /// The map that is filled: what is in it already is not done again.
    #[arg(short, long, value_name = "MAP")]
    pub(crate) out: Option<PathBuf>,
}

#[derive(Args)]
pub(crate) struct Map {
    /// The map, as `sweep` or the recorder of a loop filled it.
    #[arg(value_name = "MAP")]
    pub(crate) map: PathBuf,
    /// Where it goes: a table in `.csv`, all of it in `.json`, the part coloured by niceness in `.ply`, pictures
    /// in `.png`.
    #[arg(long, value_name = "OUT.csv|.json|.ply|.png")]
    pub(crate) to: Vec<PathBuf>,
    /// What pictures show.
    #[arg(long, value_enum, default_value_t = Shown::Niceness)]
    pub(crate) by: Shown,
    /// The part, for `.ply` and `.png`: a mesh in STL, PLY or OBJ.
    #[arg(long, value_name = "FILE")]
    pub(crate) part: Option<PathBuf>,
}

/// What pictures show.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Shown {
    /// The niceness of the best posture.
    Niceness,
    /// The solid angle from which any tool reaches a triangle.
    Access,
    /// How far a tool has to stick out of its holder at least.
    Stickout,
}

#[derive(Args)]
pub(crate) struct Path {
    /// The map, filled by `sweep`.
    #[arg(value_name = "MAP")]
    pub(crate) map: PathBuf,
    /// The part: the same mesh.
    #[arg(long, value_name = "FILE")]
    pub(crate) part: PathBuf,
    /// The tool, one of the map's: by name or as a `.tool` file.
    #[arg(long, value_name = "NAME|FILE.tool")]
    pub(crate) tool: OsString,
    /// How deep the part may be in what cuts, at stops and between them [default: the map's tolerance].
    #[arg(long, value_name = "LENGTH", value_parser = above_zero, allow_hyphen_values = true)]
    pub(crate) tolerance: Option<f64>,
    /// The normal of the planes whose lines on the part are followed.
    #[arg(long, value_name = "X,Y,Z", value_parser = point, default_value = "1,0,0", allow_hyphen_values = true)]
    pub(crate) planes: Point3<f64>,
    /// How far planes are apart, in the part's unit.
    #[arg(long, value_name = "LENGTH", value_parser = above_zero, allow_hyphen_values = true)]
    pub(crate) stepover: f64,
    /// How far places on a line are apart at most, in the part's unit [default: half the stepover].
    #[arg(long, value_name = "LENGTH", value_parser = above_zero, allow_hyphen_values = true)]
    pub(crate) step: Option<f64>,
    /// Look at the part's surface alone where its mesh leaks or is inside out, so that what is inside is unknown.
    #[arg(long)]
    pub(crate) surface_only: bool,
    /// Where the program goes.
    #[arg(long, value_name = "OUT.apt|.csv")]
    pub(crate) to: PathBuf,
}
