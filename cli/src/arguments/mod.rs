//! The command-line arguments.

pub(crate) mod postures;

use clap::{Args, Parser, Subcommand, ValueEnum};
use nalgebra::Point3;
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use tool_dsl::source::Source;
use touchoff::tool::{Interpreted, ToolError};
use touchoff::{Law, SamplingMethod, Unit, Weights};

/// Exit statuses of all commands, shown after the help text.
const STATUSES: &str = "\
Exit status:
  0  done; `verify` without findings, `check` without warnings
  1  failed, or something is wrong: findings of `verify`, errors of `check`, files that `fmt --check` would
     change
  2  wrong options, an output that is also an input, or a program that `verify` could not check
  3  `check` only warns
The status is the same if the reader of the output closes it early. Output that cannot be written, as on a full
disk, is a failure. Files are replaced when they are whole: one that cannot be written is left as it was.";

/// Compute, render and verify the contact of cutting tools with a workpiece, at any pose. Without a command, run
/// `touchoff demo`.
#[derive(Parser)]
#[command(version, about, after_help = STATUSES)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    pub(crate) command: Option<Command>,
    /// Print JSON, one object per row: per pose, per tool or per line of a table.
    #[arg(long, global = true)]
    pub(crate) json: bool,
}

#[derive(Subcommand)]
pub(crate) enum Command {
    /// Measure table 7.1 of Ho (1999) here, and print it beside the thesis's own figures.
    Demo,
    /// Compute depth, force, torque and niceness of a tool in a part, at each pose of a path.
    Run(Box<Run>),
    /// Check a program against the finished part: find where the tool is deeper than it may be.
    ///
    /// Every motion is proved, between its points too. Prints one line per finding. The exit status is 1 if there
    /// are findings, and 2 if the program could not be checked.
    Verify(Box<Verify>),
    /// Run the haptic loop in real time: a tool in a hand touches a part.
    ///
    /// Prints the cycle times, the number of missed deadlines, the largest force, and the balance of the hand's
    /// energy.
    Haptic(Box<Haptic>),
    /// Try tools at every triangle of a part, from every direction: find which tools reach it, and the best
    /// posture.
    ///
    /// Every posture that counts is proved. With `--out`, postures are kept in a map, and a later sweep continues
    /// it.
    Sweep(Box<postures::Sweep>),
    /// Summarise a posture map, and write it as a table, JSON, a coloured mesh, or pictures.
    Map(Box<postures::Map>),
    /// Plan a path of a tool over all that it reaches of a part, and write it as a 5-axis program, proved at and
    /// between its cutter locations.
    Path(Box<postures::Path>),
    /// Sample points of a part, and save them for later runs.
    Sample(Box<Sample>),
    /// Measure run time against error: clouds by their number of points, certified depth by its tolerance.
    ///
    /// Prints one row per method: median and 99th percentile of the times of single queries, relative errors of
    /// force and torque (root mean squares, against a larger cloud), the largest error of a depth (against
    /// certified depth) and its bound.
    Bench(Box<Bench>),
    /// List the compiled tools, or the tools of files.
    Tools {
        /// `.tool` files to list instead of the compiled tools.
        #[arg(value_name = "FILE.tool")]
        files: Vec<PathBuf>,
        #[command(flatten)]
        given: ParamArguments,
    },
    /// Check `.tool` files, and print the bounds that are proved for them.
    ///
    /// The exit status is 1 if a file has errors, and 3 if there are only warnings.
    Check {
        /// `.tool` files to check.
        #[arg(required = true, value_name = "FILE.tool")]
        files: Vec<PathBuf>,
        #[command(flatten)]
        given: ParamArguments,
    },
    /// Explain an error or warning code, with its remedy and an example; without a code, list all codes.
    Explain {
        /// Code to explain, as printed between the brackets of a message.
        #[arg(value_name = "CODE")]
        code: Option<String>,
    },
    /// Format `.tool` files in the standard layout.
    Fmt {
        /// Change nothing: print the names of the files that would change, and fail if there are any.
        #[arg(long)]
        check: bool,
        /// `.tool` files to format in place; `-` reads standard input and writes standard output.
        #[arg(required = true, value_name = "FILE.tool")]
        files: Vec<PathBuf>,
    },
    /// Print the Rust code that a `.tool` file compiles to, or an earlier stage of its compilation.
    Expand {
        /// `.tool` files to expand.
        #[arg(required = true, value_name = "FILE.tool")]
        files: Vec<PathBuf>,
        /// Stage to print.
        #[arg(long, value_enum, default_value_t = Stage::Rust)]
        stage: Stage,
        #[command(flatten)]
        given: ParamArguments,
    },
    /// Draw a `.tool` file: its section, regions, surfaces and measures.
    Draw {
        /// `.tool` file to draw.
        #[arg(value_name = "FILE.tool")]
        file: PathBuf,
        /// Output file, `.svg` or `.png` [default: SVG on standard output].
        #[arg(short, long, value_name = "OUT.svg|OUT.png")]
        output: Option<PathBuf>,
        #[command(flatten)]
        given: ParamArguments,
    },
}

/// A stage of a file's compilation.
#[derive(ValueEnum, Clone, Copy)]
pub(crate) enum Stage {
    /// Syntax tree.
    Ast,
    /// Values, surfaces and regions, after name resolution.
    Model,
    /// Regions in the order of the tool's surfaces, with their sides.
    Regions,
    /// Decision tree of splits in DOT, for Graphviz.
    Plan,
    /// Rust code.
    Rust,
}

/// Values for a file's params, and the root of its mounts.
#[derive(Args, Default)]
pub(crate) struct ParamArguments {
    /// Value for a `param` of the `.tool` file, written as in the language: `--set D=0.25inch`.
    #[arg(long, value_name = "PARAM=VALUE", allow_hyphen_values = true)]
    set: Vec<String>,
    /// Folder below which the `.tool` file may mount others [default: its own].
    #[arg(long, value_name = "DIR")]
    root: Option<PathBuf>,
}

impl ParamArguments {
    pub(crate) fn is_none(&self) -> bool {
        self.set.is_empty()
    }

    /// Returns the values as sources for the compiler.
    pub(crate) fn sources(&self) -> Vec<Source> {
        self.set.iter().map(|text| Source::new("--set", text)).collect()
    }

    /// Reads a `.tool` file, and sets the folder below which it may mount others.
    ///
    /// # Errors
    /// If the file cannot be read.
    pub(crate) fn source(&self, file: &Path) -> Result<Source, ToolError> {
        let source = Interpreted::source(file)?;
        Ok(match &self.root {
            Some(root) => source.with_root(root),
            None => source,
        })
    }
}

/// The part, and the sampling of its points.
#[derive(Args)]
pub(crate) struct PartFile {
    /// Part: a mesh in STL, PLY or OBJ, points with normals in PLY, or a saved `.touchoff`.
    #[arg(long, value_name = "FILE")]
    pub(crate) part: PathBuf,
    /// Unit of the part, which most formats do not store: `mm`, `inch` or `m`.
    #[arg(long)]
    pub(crate) unit: Unit,
    /// Number of points to sample on the surface.
    #[arg(long, default_value_t = 20_000, value_parser = clap::value_parser!(u64).range(1..=100_000_000), allow_hyphen_values = true)]
    pub(crate) points: u64,
    /// Largest depth that may be missed between points, in the part's unit: samples as many points as that takes.
    /// Where `run` would need more than a million points, it proves depth to this tolerance instead.
    #[arg(long, value_name = "TOLERANCE", value_parser = positive, conflicts_with = "points", allow_hyphen_values = true)]
    pub(crate) tolerance: Option<f64>,
    /// Distribution of the points: `blue`, evenly spread, or `random`.
    #[arg(long, default_value_t = SamplingMethod::BlueNoise)]
    pub(crate) sampling: SamplingMethod,
    /// Seed of the sampling; the same seed gives the same points.
    #[arg(long, default_value_t = 1, allow_hyphen_values = true)]
    pub(crate) seed: u64,
}

/// The part, as triangles.
#[derive(Args)]
pub(crate) struct MeshFile {
    /// Finished part: a mesh in STL, PLY or OBJ.
    #[arg(long, value_name = "FILE")]
    pub(crate) part: PathBuf,
    /// Unit of the part, which most formats do not store: `mm`, `inch` or `m`.
    #[arg(long)]
    pub(crate) unit: Unit,
}

#[derive(Args)]
pub(crate) struct Sample {
    #[command(flatten)]
    pub(crate) part: PartFile,
    /// Tool for which `--tolerance` is meant, by name or as a `.tool` file [default: a tool of exact depths].
    #[arg(long, value_name = "NAME|FILE.tool")]
    pub(crate) tool: Option<OsString>,
    #[command(flatten)]
    pub(crate) given: ParamArguments,
    /// Output file for the points.
    #[arg(short, long, value_name = "OUT.touchoff")]
    pub(crate) output: PathBuf,
}

#[derive(Args)]
pub(crate) struct Run {
    #[command(flatten)]
    pub(crate) part: PartFile,
    /// Compiled tool by name, or any `.tool` file.
    #[arg(long, value_name = "NAME|FILE.tool")]
    pub(crate) tool: OsString,
    #[command(flatten)]
    pub(crate) given: ParamArguments,
    /// Path: a table of `x,y,z,i,j,k` or `x,y,z,qx,qy,qz,qw`, or APT-CL.
    #[arg(long, value_name = "FILE")]
    pub(crate) path: PathBuf,
    /// Force law: `thesis`, `gradient` or `facing`.
    #[arg(long, default_value_t = Law::Thesis)]
    pub(crate) law: Law,
    /// Weights of the points: `area` or `unit`.
    #[arg(long, default_value_t = Weights::Area)]
    pub(crate) weights: Weights,
    /// Compliance centre, in the tool's frame and the part's unit [default: the tip].
    #[arg(long, value_name = "X,Y,Z", value_parser = point, allow_hyphen_values = true)]
    pub(crate) center: Option<Point3<f64>>,
    /// Prove the depth of the part's triangles in the tool to this tolerance, in the part's unit; 0 is as close as
    /// arithmetic allows.
    #[arg(long, value_name = "TOLERANCE", value_parser = tolerance, allow_hyphen_values = true)]
    pub(crate) certify: Option<f64>,
}

#[derive(Args)]
pub(crate) struct Verify {
    #[command(flatten)]
    pub(crate) mesh: MeshFile,
    /// Compiled tool by name, or any `.tool` file.
    #[arg(long, value_name = "NAME|FILE.tool")]
    pub(crate) tool: OsString,
    #[command(flatten)]
    pub(crate) given: ParamArguments,
    /// Program: APT-CL, or a table of `x,y,z,i,j,k` or `x,y,z,qx,qy,qz,qw`.
    #[arg(long, value_name = "FILE")]
    pub(crate) program: PathBuf,
    /// Largest depth allowed for any surface of the tool in the part, in the part's unit.
    #[arg(long, value_name = "TOLERANCE", value_parser = tolerance, default_value_t = 0.0, allow_hyphen_values = true)]
    pub(crate) tolerance: f64,
    /// Largest depth allowed for one surface instead, where it is the nearest and in feed, in the part's unit:
    /// `--allow flute=0.05 --allow nut=-1`. `inf` allows any depth; a value below 0 is a margin to keep.
    #[arg(long, value_name = "SURFACE=DEPTH", value_parser = allowance, allow_hyphen_values = true)]
    pub(crate) allow: Vec<(String, f64)>,
    /// Excess over the allowed depth, in the part's unit, up to which a finding may or may not be reported
    /// [default: 0.001 mm].
    #[arg(long, value_name = "LENGTH", value_parser = tolerance, allow_hyphen_values = true)]
    pub(crate) resolution: Option<f64>,
    /// Check only the part's surface where its mesh leaks or is inside out, as it is then unknown whether the tool
    /// is inside the material. Without this option, such a part ends with status 2.
    #[arg(long)]
    pub(crate) surface_only: bool,
    /// Accept a program that never comes within the tool's diameter of the part. Without this option, such a
    /// program ends with status 2.
    #[arg(long)]
    pub(crate) anyway: bool,
}

#[derive(Args)]
pub(crate) struct Haptic {
    #[command(flatten)]
    pub(crate) part: PartFile,
    /// Compiled tool by name, or any `.tool` file.
    #[arg(long, value_name = "NAME|FILE.tool")]
    pub(crate) tool: OsString,
    #[command(flatten)]
    pub(crate) given: ParamArguments,
    /// Device: `hand`, a simulated hand that presses the tool onto the part; `path FILE`, a path played once;
    /// `spacenav`, a SpaceMouse through its daemon.
    #[arg(long, num_args = 1..=2, value_names = ["hand|path|spacenav", "FILE"], default_value = "hand")]
    pub(crate) device: Vec<String>,
    /// Rate of the loop, in cycles per second, from 1 to 100000.
    #[arg(long, default_value_t = 1000.0, value_parser = rate, allow_hyphen_values = true)]
    pub(crate) rate: f64,
    /// Duration of the session, in seconds.
    #[arg(long, default_value_t = 10.0, value_parser = above_zero, allow_hyphen_values = true)]
    pub(crate) seconds: f64,
    /// Force law: `thesis`, `gradient` or `facing`.
    #[arg(long, default_value_t = Law::Gradient)]
    pub(crate) law: Law,
    /// Stiffness of contact, in N per unit of the law's force: N/mm³ for a part in mm.
    #[arg(long, default_value_t = 1.0, value_parser = above_zero, allow_hyphen_values = true)]
    pub(crate) stiffness: f64,
    /// Stiffest spring that the device can render, in N/mm.
    #[arg(long, default_value_t = 1.0, value_parser = above_zero, allow_hyphen_values = true)]
    pub(crate) device_stiffness: f64,
    /// Largest force of the device, in N.
    #[arg(long, default_value_t = 8.0, value_parser = above_zero, allow_hyphen_values = true)]
    pub(crate) most_force: f64,
    /// Render the contact at the device's own pose, without a coupling, scaled to what the device can render.
    #[arg(long)]
    pub(crate) direct: bool,
    /// Ask the system for real-time priority and locked memory.
    #[arg(long)]
    pub(crate) realtime: bool,
    /// Run the loop on this core only, counted from 0 [default: any].
    #[arg(long, allow_hyphen_values = true)]
    pub(crate) core: Option<usize>,
    /// Time to stay awake before each cycle, in µs, to cover the system's delay in waking a thread.
    #[arg(long, default_value_t = 60, allow_hyphen_values = true)]
    pub(crate) awake: u64,
    /// Write every state to a table, which takes its name when the session ends. A full disk is reported at once,
    /// and the session goes on without the table; the exit status is then 1.
    #[arg(long, value_name = "FILE.csv")]
    pub(crate) record: Option<PathBuf>,
    /// Posture map, old or new, to which acceptable postures of the session are added.
    #[arg(long, value_name = "MAP")]
    pub(crate) postures: Option<PathBuf>,
}

#[derive(Args)]
pub(crate) struct Bench {
    /// Use fewer and smaller clouds, for a run of some seconds.
    #[arg(long)]
    pub(crate) quick: bool,
    /// Seed of the clouds.
    #[arg(long, default_value_t = 1, allow_hyphen_values = true)]
    pub(crate) seed: u64,
    /// Part: a mesh in STL, PLY or OBJ [default: the tube of the figures, with its tool and path].
    #[arg(long, value_name = "FILE", requires_all = ["unit", "tool", "path"])]
    pub(crate) part: Option<PathBuf>,
    /// Unit of the part: `mm`, `inch` or `m`.
    #[arg(long, requires = "part")]
    pub(crate) unit: Option<Unit>,
    /// Compiled tool by name, or any `.tool` file.
    #[arg(long, value_name = "NAME|FILE.tool", requires = "part")]
    pub(crate) tool: Option<OsString>,
    #[command(flatten)]
    pub(crate) given: ParamArguments,
    /// Path of the tool along the part: a table, or APT-CL.
    #[arg(long, value_name = "FILE", requires = "part")]
    pub(crate) path: Option<PathBuf>,
}

/// Parses a finite length of 0 or more.
fn tolerance(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value >= 0.0 && value.is_finite() => Ok(value),
        Ok(value) => Err(format!("{value} is no tolerance: write a length of 0 or more")),
        Err(_) => Err(format!("`{text}` is not a number")),
    }
}

/// Parses a surface and a depth, `SURFACE=DEPTH`.
fn allowance(text: &str) -> Result<(String, f64), String> {
    let (surface, depth) = text.split_once('=').ok_or("write SURFACE=DEPTH: `flute=0.05`")?;
    let depth = depth.trim();
    let number = depth.parse().map_err(|_| format!("`{depth}` is not a number"))?;
    Ok((surface.trim().to_owned(), number))
}

/// Parses a finite length above 0.
fn positive(text: &str) -> Result<f64, String> {
    match tolerance(text)? {
        0.0 => Err("no cloud is exact: write a length above 0, or ask for `--certify`".to_owned()),
        value => Ok(value),
    }
}

/// Parses a finite number above 0.
fn above_zero(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value > 0.0 && value.is_finite() => Ok(value),
        _ => Err(format!("`{text}` is not a number above 0")),
    }
}

/// Parses a rate in Hz, from 1 to 100000.
fn rate(text: &str) -> Result<f64, String> {
    match above_zero(text)? {
        rate @ 1.0..=100_000.0 => Ok(rate),
        rate => Err(format!("{rate} Hz: devices take 1 to 100000")),
    }
}

/// The device that moves the tool.
#[derive(Clone, Debug)]
pub(crate) enum Wielded {
    Hand,
    Path(PathBuf),
    Spacenav,
}

impl Haptic {
    /// Returns the device.
    ///
    /// # Errors
    /// A message for the user if the words name no device.
    pub(crate) fn wielded(&self) -> Result<Wielded, String> {
        let words: Vec<&str> = self.device.iter().map(String::as_str).collect();
        match words[..] {
            ["hand"] => Ok(Wielded::Hand),
            ["spacenav"] => Ok(Wielded::Spacenav),
            ["path", file] => Ok(Wielded::Path(file.into())),
            ["path"] => Err("`--device path` wants a file: write `--device path FILE`".to_owned()),
            _ => Err(format!(
                "there is no device `{}`: write `hand`, `path FILE` or `spacenav`",
                words.join(" ")
            )),
        }
    }
}

/// Parses a finite point, `x,y,z`.
fn point(text: &str) -> Result<Point3<f64>, String> {
    let numbers: Vec<f64> = text
        .split(',')
        .map(|part| {
            part.trim().parse::<f64>().map_err(|_| format!("`{}` is not a number", part.trim()))
        })
        .collect::<Result<_, _>>()?;
    match numbers.as_slice() {
        [x, y, z] if numbers.iter().all(|n| n.is_finite()) => Ok(Point3::new(*x, *y, *z)),
        [_, _, _] => Err("a coordinate is not finite".to_owned()),
        _ => Err(format!("write three numbers, `x,y,z`; these are {}", numbers.len())),
    }
}
