//! What the program is asked for.

pub(crate) mod postures;

use clap::{Args, Parser, Subcommand, ValueEnum};
use nalgebra::Point3;
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use tool_dsl::source::Source;
use touchoff::tool::{Interpreted, ToolError};
use touchoff::{Law, Sampling, Unit, Weights};

/// The exit statuses of all commands.
const STATUSES: &str = "\
Exit status:
  0  done; `verify` without findings, `check` without warnings
  1  failed, or something is wrong: findings of `verify`, errors of `check`, files that `fmt --check` would
     change
  2  wrong options, an output that is also an input, or a program that `verify` could not check
  3  `check` only warns
The status is the same if the reader of the output closes it early. Output that cannot be written, as on a full
disk, is a failure. Files are replaced when they are whole: one that cannot be written is left as it was.";

/// What a cutting tool feels of a workpiece, at any pose. Alone: `touchoff demo`.
#[derive(Parser)]
#[command(version, about, after_help = STATUSES)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    pub(crate) command: Option<Command>,
    /// One JSON object a row: a pose, a tool, a line of the table.
    #[arg(long, global = true)]
    pub(crate) json: bool,
}

#[derive(Subcommand)]
pub(crate) enum Command {
    /// Table 7.1 of Ho (1999), measured here, beside the thesis's own figures.
    Demo,
    /// Feel a part with a tool along a path.
    Run(Box<Run>),
    /// Check a program against the finished part: where on its way is a tool deeper than it may be?
    ///
    /// Every motion is proved, between its points too; a line a finding. Ends with status 1 if there are any,
    /// with 2 if the program could not be checked.
    Verify(Box<Verify>),
    /// Feel a part with a tool in a hand: the haptic loop, in real time.
    ///
    /// Prints how long cycles took, how many missed their time, the largest force, and what became of the
    /// hand's energy.
    Haptic(Box<Haptic>),
    /// Try tools at every triangle of a part, from every direction: which reach it, and which stands best?
    ///
    /// Every posture that counts is proved. With `--out` the map of them is kept, and gone on with.
    Sweep(Box<postures::Sweep>),
    /// Say what a map of postures knows, and write it as a table, JSON, a coloured mesh, or pictures.
    Map(Box<postures::Map>),
    /// Lead a tool over all that it reaches of a part, and write the 5-axis program, proved at and between its
    /// stops.
    Path(Box<postures::Path>),
    /// Take points of a part, and save them to be felt later.
    Sample(Box<Sample>),
    /// Measure run time against error: clouds by their number of points, certified depth by its tolerance.
    ///
    /// Prints a row per method: median and 99th percentile of single queries, relative errors of force and torque
    /// (root mean squares, beside a larger cloud), the largest error of a depth (beside certified depth) and its bound.
    Bench(Box<Bench>),
    /// List the compiled tools, or those of files.
    Tools {
        /// Files to list in their place.
        #[arg(value_name = "FILE.tool")]
        files: Vec<PathBuf>,
        #[command(flatten)]
        given: Given,
    },
    /// Look `.tool` files over, and say what is proved of them.
    ///
    /// Ends with status 1 if any is wrong, with 3 if something is only warned of.
    Check {
        /// The files.
        #[arg(required = true, value_name = "FILE.tool")]
        files: Vec<PathBuf>,
        #[command(flatten)]
        given: Given,
    },
    /// Explain a code of an error or a warning, with its remedy and an example; without one, list all codes.
    Explain {
        /// The code, as between the brackets of a message.
        #[arg(value_name = "CODE")]
        code: Option<String>,
    },
    /// Lay `.tool` files out as they are usually written.
    Fmt {
        /// Change nothing: name the files that would change, and fail if there are any.
        #[arg(long)]
        check: bool,
        /// The files; `-` is standard input, laid out on standard output.
        #[arg(required = true, value_name = "FILE.tool")]
        files: Vec<PathBuf>,
    },
    /// Print the Rust that a `.tool` file becomes, or an earlier stage of its compilation.
    Expand {
        /// The files.
        #[arg(required = true, value_name = "FILE.tool")]
        files: Vec<PathBuf>,
        /// The stage to print.
        #[arg(long, value_enum, default_value_t = Stage::Rust)]
        stage: Stage,
        #[command(flatten)]
        given: Given,
    },
    /// Draw a `.tool` file: its section, regions, surfaces and measures.
    Draw {
        /// The file.
        #[arg(value_name = "FILE.tool")]
        file: PathBuf,
        /// Where the drawing goes, `.svg` or `.png` [default: SVG on standard output].
        #[arg(short, long, value_name = "OUT.svg|OUT.png")]
        output: Option<PathBuf>,
        #[command(flatten)]
        given: Given,
    },
}

/// A stage of a file's compilation.
#[derive(ValueEnum, Clone, Copy)]
pub(crate) enum Stage {
    /// The syntax tree.
    Ast,
    /// Values, surfaces and regions, resolved.
    Model,
    /// The regions in the order of the tool's surfaces, with their sides.
    Regions,
    /// The tree of splits in DOT, for Graphviz.
    Plan,
    /// The Rust code.
    Rust,
}

/// What a file's params are given.
#[derive(Args, Default)]
pub(crate) struct Given {
    /// A value for a `param` of the `.tool` file, as the language writes it: `--set D=0.25inch`.
    #[arg(long, value_name = "PARAM=VALUE", allow_hyphen_values = true)]
    set: Vec<String>,
    /// The folder below which the `.tool` file may mount others [default: its own].
    #[arg(long, value_name = "DIR")]
    root: Option<PathBuf>,
}

impl Given {
    pub(crate) fn is_none(&self) -> bool {
        self.set.is_empty()
    }

    /// The values as the compiler reads them.
    pub(crate) fn sources(&self) -> Vec<Source> {
        self.set.iter().map(|text| Source::new("--set", text)).collect()
    }

    /// The text of a `.tool` file, with the folder below which it may mount others.
    pub(crate) fn source(&self, file: &Path) -> Result<Source, ToolError> {
        let source = Interpreted::source(file)?;
        Ok(match &self.root {
            Some(root) => source.within(root),
            None => source,
        })
    }
}

/// The part, and how it is felt as points.
#[derive(Args)]
pub(crate) struct PartFile {
    /// The part: a mesh in STL, PLY or OBJ, points with normals in PLY, or a `.touchoff` that was saved.
    #[arg(long, value_name = "FILE")]
    pub(crate) part: PathBuf,
    /// The part's unit, which most formats do not say: `mm`, `inch` or `m`.
    #[arg(long)]
    pub(crate) unit: Unit,
    /// Points that are taken of the surface.
    #[arg(long, default_value_t = 20_000, value_parser = clap::value_parser!(u64).range(1..=100_000_000), allow_hyphen_values = true)]
    pub(crate) points: u64,
    /// As many points as it takes for no place of the surface to be deeper than found by more than this,
    /// in the part's unit; where `run` would take more than a million, it proves depth to that instead.
    #[arg(long, value_name = "TOLERANCE", value_parser = positive, conflicts_with = "points", allow_hyphen_values = true)]
    pub(crate) tolerance: Option<f64>,
    /// How the points are spread: `blue`, evenly, or `random`.
    #[arg(long, default_value_t = Sampling::Blue)]
    pub(crate) sampling: Sampling,
    /// The same seed, the same points.
    #[arg(long, default_value_t = 1, allow_hyphen_values = true)]
    pub(crate) seed: u64,
}

/// The part, as triangles.
#[derive(Args)]
pub(crate) struct MeshFile {
    /// The finished part: a mesh in STL, PLY or OBJ.
    #[arg(long, value_name = "FILE")]
    pub(crate) part: PathBuf,
    /// The part's unit, which most formats do not say: `mm`, `inch` or `m`.
    #[arg(long)]
    pub(crate) unit: Unit,
}

#[derive(Args)]
pub(crate) struct Sample {
    #[command(flatten)]
    pub(crate) part: PartFile,
    /// The tool that a tolerance is meant for, by name or as a `.tool` file [default: one of exact depths].
    #[arg(long, value_name = "NAME|FILE.tool")]
    pub(crate) tool: Option<OsString>,
    #[command(flatten)]
    pub(crate) given: Given,
    /// Where the points go.
    #[arg(short, long, value_name = "OUT.touchoff")]
    pub(crate) output: PathBuf,
}

#[derive(Args)]
pub(crate) struct Run {
    #[command(flatten)]
    pub(crate) part: PartFile,
    /// A compiled tool by name, or any `.tool` file.
    #[arg(long, value_name = "NAME|FILE.tool")]
    pub(crate) tool: OsString,
    #[command(flatten)]
    pub(crate) given: Given,
    /// The path: a table of `x,y,z,i,j,k` or `x,y,z,qx,qy,qz,qw`, or APT-CL.
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
    /// Prove how deep the part's triangles are in the tool, to this tolerance in the part's unit; 0 is as
    /// close as arithmetic allows.
    #[arg(long, value_name = "TOLERANCE", value_parser = tolerance, allow_hyphen_values = true)]
    pub(crate) certify: Option<f64>,
}

#[derive(Args)]
pub(crate) struct Verify {
    #[command(flatten)]
    pub(crate) mesh: MeshFile,
    /// A compiled tool by name, or any `.tool` file.
    #[arg(long, value_name = "NAME|FILE.tool")]
    pub(crate) tool: OsString,
    #[command(flatten)]
    pub(crate) given: Given,
    /// The program: APT-CL, or a table of `x,y,z,i,j,k` or `x,y,z,qx,qy,qz,qw`.
    #[arg(long, value_name = "FILE")]
    pub(crate) program: PathBuf,
    /// How deep any surface of the tool may be in the part, in the part's unit.
    #[arg(long, value_name = "TOLERANCE", value_parser = tolerance, default_value_t = 0.0, allow_hyphen_values = true)]
    pub(crate) tolerance: f64,
    /// How deep one surface may be instead, where it is the nearest and in feed; `inf` for any depth, below 0 a
    /// margin that it has to keep: `--allow flute=0.05 --allow nut=-1`.
    #[arg(long, value_name = "SURFACE=DEPTH", value_parser = allowance, allow_hyphen_values = true)]
    pub(crate) allow: Vec<(String, f64)>,
    /// What is deeper than it may be by no more than this may or may not be found, in the part's unit
    /// [default: 0.001 mm].
    #[arg(long, value_name = "LENGTH", value_parser = tolerance, allow_hyphen_values = true)]
    pub(crate) resolution: Option<f64>,
    /// Check the part's surface alone where its mesh leaks or is inside out, so that whether the tool is inside
    /// the material is unknown; otherwise that ends with status 2.
    #[arg(long)]
    pub(crate) surface_only: bool,
    /// Take a program that never comes within the tool's diameter of the part; otherwise that ends with status 2.
    #[arg(long)]
    pub(crate) anyway: bool,
}

#[derive(Args)]
pub(crate) struct Haptic {
    #[command(flatten)]
    pub(crate) part: PartFile,
    /// A compiled tool by name, or any `.tool` file.
    #[arg(long, value_name = "NAME|FILE.tool")]
    pub(crate) tool: OsString,
    #[command(flatten)]
    pub(crate) given: Given,
    /// What is held: `hand`, a simulated one that presses the tool onto the part; `path FILE`, a path played once;
    /// `spacenav`, a SpaceMouse by its daemon.
    #[arg(long, num_args = 1..=2, value_names = ["hand|path|spacenav", "FILE"], default_value = "hand")]
    pub(crate) device: Vec<String>,
    /// Cycles a second.
    #[arg(long, default_value_t = 1000.0, value_parser = rate, allow_hyphen_values = true)]
    pub(crate) rate: f64,
    /// How long.
    #[arg(long, default_value_t = 10.0, value_parser = above_zero, allow_hyphen_values = true)]
    pub(crate) seconds: f64,
    /// Force law: `thesis`, `gradient` or `facing`.
    #[arg(long, default_value_t = Law::Gradient)]
    pub(crate) law: Law,
    /// Stiffness of contact, N for each unit of the law's force: N/mm³ for a part in mm.
    #[arg(long, default_value_t = 1.0, value_parser = above_zero, allow_hyphen_values = true)]
    pub(crate) stiffness: f64,
    /// The stiffest spring that the device can render, N/mm.
    #[arg(long, default_value_t = 1.0, value_parser = above_zero, allow_hyphen_values = true)]
    pub(crate) device_stiffness: f64,
    /// The largest force of the device, N.
    #[arg(long, default_value_t = 8.0, value_parser = above_zero, allow_hyphen_values = true)]
    pub(crate) most_force: f64,
    /// Push with what the tool feels where the device is, scaled to what that can render, without a coupling.
    #[arg(long)]
    pub(crate) direct: bool,
    /// Ask the system for real-time priority and locked memory.
    #[arg(long)]
    pub(crate) realtime: bool,
    /// Stay on that core.
    #[arg(long, allow_hyphen_values = true)]
    pub(crate) core: Option<usize>,
    /// Stay awake for so many µs before each cycle: what the system takes to wake a thread.
    #[arg(long, default_value_t = 60, allow_hyphen_values = true)]
    pub(crate) awake: u64,
    /// Write every state to a table, which takes its name when the session ends. If the disk is full, that is said
    /// at once and the session goes on without the table; the exit status is then 1.
    #[arg(long, value_name = "FILE.csv")]
    pub(crate) record: Option<PathBuf>,
    /// Keep the postures that are found acceptable in this map, an old one or a new one.
    #[arg(long, value_name = "MAP")]
    pub(crate) postures: Option<PathBuf>,
}

#[derive(Args)]
pub(crate) struct Bench {
    /// Fewer and smaller clouds: some seconds.
    #[arg(long)]
    pub(crate) quick: bool,
    /// The seed of the clouds.
    #[arg(long, default_value_t = 1, allow_hyphen_values = true)]
    pub(crate) seed: u64,
    /// The part, a mesh in STL, PLY or OBJ [default: the tube of the figures, with its tool and path].
    #[arg(long, value_name = "FILE", requires_all = ["unit", "tool", "path"])]
    pub(crate) part: Option<PathBuf>,
    /// The part's unit: `mm`, `inch` or `m`.
    #[arg(long, requires = "part")]
    pub(crate) unit: Option<Unit>,
    /// A compiled tool by name, or any `.tool` file.
    #[arg(long, value_name = "NAME|FILE.tool", requires = "part")]
    pub(crate) tool: Option<OsString>,
    #[command(flatten)]
    pub(crate) given: Given,
    /// The tool's path along the part: a table, or APT-CL.
    #[arg(long, value_name = "FILE", requires = "part")]
    pub(crate) path: Option<PathBuf>,
}

/// A length that is not negative.
fn tolerance(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value >= 0.0 && value.is_finite() => Ok(value),
        Ok(value) => Err(format!("{value} is no tolerance: write a length of 0 or more")),
        Err(_) => Err(format!("`{text}` is not a number")),
    }
}

/// A surface and a depth.
fn allowance(text: &str) -> Result<(String, f64), String> {
    let (surface, depth) = text.split_once('=').ok_or("write SURFACE=DEPTH: `flute=0.05`")?;
    let depth = depth.trim();
    let number = depth.parse().map_err(|_| format!("`{depth}` is not a number"))?;
    Ok((surface.trim().to_owned(), number))
}

/// A length above 0.
fn positive(text: &str) -> Result<f64, String> {
    match tolerance(text)? {
        0.0 => Err("no cloud is exact: write a length above 0, or ask for `--certify`".to_owned()),
        value => Ok(value),
    }
}

/// A number above 0.
fn above_zero(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value > 0.0 && value.is_finite() => Ok(value),
        _ => Err(format!("`{text}` is not a number above 0")),
    }
}

/// Cycles a second.
fn rate(text: &str) -> Result<f64, String> {
    match above_zero(text)? {
        rate @ 1.0..=100_000.0 => Ok(rate),
        rate => Err(format!("{rate} Hz: devices take 1 to 100000")),
    }
}

/// What is held.
#[derive(Clone, Debug)]
pub(crate) enum Wielded {
    Hand,
    Path(PathBuf),
    Spacenav,
}

impl Haptic {
    /// What is held; what is wrong with the words for it, if something is.
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

/// `x,y,z`
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
