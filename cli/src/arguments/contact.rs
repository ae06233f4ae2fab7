//! The arguments of the commands that compute contact: `run`, `verify`, `report`, `haptic`, `live` and `sample`.

use super::values::{allowance, core, count, length, point, positive, rate};
use super::{PartFile, ToolArguments};
use clap::{Args, ValueEnum};
use nalgebra::Point3;
use std::ffi::OsString;
use std::path::PathBuf;
use touchoff::{Law, Unit, Weights};

#[derive(Args)]
pub(crate) struct Sample {
    #[command(flatten)]
    pub(crate) part: PartFile,
    /// Tool for which `--sampling-error` holds, by name or as a `.tool` file [default: any tool whose depth is the
    /// distance to its surface].
    #[arg(long, value_name = "NAME|FILE.tool")]
    pub(crate) tool: Option<OsString>,
    #[command(flatten)]
    pub(crate) params: ToolArguments,
    /// Output file for the points.
    #[arg(short, long, value_name = "OUT.touchoff")]
    pub(crate) output: PathBuf,
}

#[derive(Args)]
pub(crate) struct Run {
    #[command(flatten)]
    pub(crate) part: PartFile,
    /// Built-in tool by name (`touchoff tools` lists them), or any `.tool` file.
    #[arg(long, value_name = "NAME|FILE.tool")]
    pub(crate) tool: OsString,
    #[command(flatten)]
    pub(crate) params: ToolArguments,
    /// Program: APT-CL, or a table of `x,y,z,i,j,k` or `x,y,z,qx,qy,qz,qw`, in the part's unit.
    #[arg(long, value_name = "FILE")]
    pub(crate) program: PathBuf,
    /// Force law: `thesis`, `gradient` or `facing`.
    #[arg(long, default_value_t = Law::default())]
    pub(crate) law: Law,
    /// Weights of the points: `area` or `unit`.
    #[arg(long, default_value_t = Weights::Area)]
    pub(crate) weights: Weights,
    /// Compliance centre, in the tool's frame and the part's unit [default: the tip].
    #[arg(long, value_name = "X,Y,Z", value_parser = point)]
    pub(crate) center: Option<Point3<f64>>,
    /// Prove the depth of the part's triangles in the tool to this tolerance, in the part's unit; 0 is as close as
    /// arithmetic allows [default: depth is computed at the points only].
    #[arg(long, value_name = "LENGTH", value_parser = length)]
    pub(crate) certify: Option<f64>,
}

#[derive(Args)]
pub(crate) struct Verify {
    /// Job file, which states part, program, machine, tools by number, fixtures and stock, instead of the options.
    #[arg(value_name = "JOB.toml", conflicts_with_all = ["part", "unit", "tool", "program", "machine", "tolerance", "allow"])]
    pub(crate) job: Option<PathBuf>,
    /// Finished part: a mesh in STL, PLY or OBJ.
    #[arg(long, value_name = "FILE", required_unless_present = "job")]
    pub(crate) part: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) check: CheckArguments,
    /// Write the findings as SARIF 2.1.0, for services of continuous integration.
    #[arg(long, value_name = "OUT.sarif")]
    pub(crate) sarif: Option<PathBuf>,
}

/// The check of a program against a part.
#[derive(Args)]
pub(crate) struct CheckArguments {
    /// Unit of the part, which most formats do not store: `mm`, `inch` or `m`.
    #[arg(long, required_unless_present = "job")]
    pub(crate) unit: Option<Unit>,
    /// Built-in tool by name (`touchoff tools` lists them), or any `.tool` file. With `--tools` alone the program takes the
    /// library's tools by their numbers.
    #[arg(long, value_name = "NAME|FILE.tool", required_unless_present_any = ["job", "library"])]
    pub(crate) tool: Option<OsString>,
    #[command(flatten)]
    pub(crate) params: ToolArguments,
    /// Program: APT-CL, or a table of `x,y,z,i,j,k` or `x,y,z,qx,qy,qz,qw`, in the part's unit; or G-code.
    #[arg(long, value_name = "FILE", required_unless_present = "job")]
    pub(crate) program: Option<PathBuf>,
    /// Machine of a G-code program: a built-in one by name, such as `A-C trunnion` (`touchoff machines` lists them), or a
    /// file [default: `3-axis`].
    #[arg(long, value_name = "NAME|FILE.toml")]
    pub(crate) machine: Option<OsString>,
    /// Control of a G-code program: `fanuc`, `haas`, `linuxcnc`, `siemens`, `heidenhain`, or a file (`touchoff controls`
    /// prints one); `generic` checks what every one of them does. G-code needs one, but for Klartext.
    #[arg(long, value_name = "NAME|FILE.toml")]
    pub(crate) control: Option<OsString>,
    /// Largest depth allowed for any surface of the tool in the part, in the part's unit.
    #[arg(long, value_name = "LENGTH", value_parser = length, default_value_t = 0.0)]
    pub(crate) tolerance: f64,
    /// Largest depth allowed for one surface instead, where it is the nearest and in feed, in the part's unit:
    /// `--allow flute=0.05 --allow nut=-1`. `inf` allows any depth; a value below 0 is a margin to keep.
    #[arg(long, value_name = "SURFACE=LENGTH", value_parser = allowance)]
    pub(crate) allow: Vec<(String, f64)>,
    /// Excess over the allowed depth, in the part's unit, up to which a finding may or may not be reported
    /// [default: 0.001 mm].
    #[arg(long, value_name = "LENGTH", value_parser = length)]
    pub(crate) resolution: Option<f64>,
    /// Check only the part's surface where its mesh leaks or is inside out, as it is then unknown whether the tool
    /// is inside the material. Without this option, such a part ends with status 2.
    #[arg(long)]
    pub(crate) surface_only: bool,
    /// Write nothing that the job asks for.
    #[arg(long, requires = "job")]
    pub(crate) read_only: bool,
    /// Accept what is left open: motions that only the machine knows, and an implausible program, which never comes within
    /// the tool's diameter of the part or would fit it in another unit. Without this option, these end with status 2.
    #[arg(long)]
    pub(crate) anyway: bool,
    /// Print what was read, too: meshes, boxes of part and program, travel, nearest approach, machine, and the findings of each tool at
    /// each body.
    #[arg(short, long)]
    pub(crate) verbose: bool,
}

impl CheckArguments {
    /// Returns whether they state what a job file states: all but resolution and leniency.
    pub(crate) fn states_subject(&self) -> bool {
        let files = self.tool.is_some() || self.program.is_some() || self.machine.is_some();
        let limits = self.tolerance != 0.0 || !self.allow.is_empty();
        files || limits || self.unit.is_some() || !self.params.is_empty()
    }

    /// Returns whether they state all that a check of a part needs.
    pub(crate) fn has_subject(&self) -> bool {
        let has_tool = self.tool.is_some() || self.params.library.is_some();
        self.unit.is_some() && has_tool && self.program.is_some()
    }
}

#[derive(Args)]
pub(crate) struct Report {
    /// Job file as for `verify`; or the finished part, a mesh in STL, PLY or OBJ, with the options below.
    #[arg(value_name = "JOB.toml|PART")]
    pub(crate) job: PathBuf,
    #[command(flatten)]
    pub(crate) check: CheckArguments,
    /// Posture map of the part, by which the part is coloured too: niceness, solid angle of access, least stick-out.
    #[arg(long, value_name = "MAP")]
    pub(crate) map: Option<PathBuf>,
    /// Output file.
    #[arg(short, long, value_name = "OUT.html")]
    pub(crate) output: PathBuf,
}

#[derive(Args)]
pub(crate) struct Haptic {
    #[command(flatten)]
    pub(crate) part: PartFile,
    /// Built-in tool by name (`touchoff tools` lists them), or any `.tool` file.
    #[arg(long, value_name = "NAME|FILE.tool")]
    pub(crate) tool: OsString,
    #[command(flatten)]
    pub(crate) params: ToolArguments,
    /// Device that moves the tool.
    #[arg(long, value_enum, default_value_t = DeviceKind::Hand)]
    pub(crate) device: DeviceKind,
    /// Program that `--device playback` plays once, and that `--device hand` follows once while it presses: APT-CL, or a table of poses,
    /// in the part's unit.
    #[arg(long, value_name = "FILE", required_if_eq("device", "playback"))]
    pub(crate) program: Option<PathBuf>,
    /// Place above which the hand begins and that it presses, in the part's unit [default: the middle of the part's highest surface].
    #[arg(long, value_name = "X,Y,Z", value_parser = point, conflicts_with = "program")]
    pub(crate) at: Option<Point3<f64>>,
    /// Radius of the circles on which the hand moves while it presses, in mm.
    #[arg(long, value_name = "MM", default_value_t = 1.0, value_parser = length)]
    pub(crate) circle: f64,
    /// Force with which the hand presses, in N.
    #[arg(long, value_name = "NEWTON", default_value_t = 0.5, value_parser = positive)]
    pub(crate) press: f64,
    /// Rate of the loop, in cycles per second, from 1 to 100000.
    #[arg(long, value_name = "HZ", default_value_t = 1000.0, value_parser = rate)]
    pub(crate) rate: f64,
    /// Duration of the session, in seconds.
    #[arg(long, value_name = "SECONDS", default_value_t = 10.0, value_parser = positive)]
    pub(crate) duration: f64,
    /// Force law: `thesis`, `gradient` or `facing`.
    #[arg(long, default_value_t = Law::default())]
    pub(crate) law: Law,
    /// Stiffness of contact, in N per unit of the law's force: N/mm³ for a part in mm [default: such that `--max-force` presses the tool
    /// by a quarter of the contact's radius, or of the part's least thickness].
    #[arg(long, value_name = "NUMBER", value_parser = positive)]
    pub(crate) stiffness: Option<f64>,
    /// Stiffest spring that the device can render, in N/mm.
    #[arg(long, value_name = "NUMBER", default_value_t = 1.0, value_parser = positive)]
    pub(crate) device_stiffness: f64,
    /// Largest force of the device, in N.
    #[arg(long, value_name = "NEWTON", default_value_t = 8.0, value_parser = positive)]
    pub(crate) max_force: f64,
    /// Render the contact at the device's own pose, without a virtual coupling, scaled to what the device can
    /// render.
    #[arg(long)]
    pub(crate) direct: bool,
    /// Ask the system for real-time priority and locked memory.
    #[arg(long)]
    pub(crate) realtime: bool,
    /// Run the loop on this core only, counted from 0 [default: any].
    #[arg(long, value_name = "NUMBER", value_parser = core)]
    pub(crate) core: Option<usize>,
    /// Busy waiting before each cycle, in µs, to cover the system's delay in waking a thread.
    #[arg(long, value_name = "MICROSECONDS", default_value_t = 60, value_parser = count)]
    pub(crate) spin: u64,
    /// Write every state to a table, which takes its name when the session ends, and is `FILE.csv.part` until then. A full disk is
    /// reported at once, and the session goes on without the table; the exit status is then 1.
    #[arg(long, value_name = "FILE.csv")]
    pub(crate) record: Option<PathBuf>,
    /// Posture map, old or new, to which acceptable postures of the session are added.
    #[arg(long, value_name = "MAP")]
    pub(crate) postures: Option<PathBuf>,
}

#[derive(Args)]
pub(crate) struct Live {
    /// Part: a mesh in STL, PLY or OBJ [default: a generated plate with a pocket].
    #[arg(long, value_name = "FILE", requires = "unit")]
    pub(crate) part: Option<PathBuf>,
    /// Unit of the part: `mm`, `inch` or `m`.
    #[arg(long, requires = "part")]
    pub(crate) unit: Option<Unit>,
    /// Built-in tool by name (`touchoff tools` lists them), or any `.tool` file [default: `D2Ball`]. The tools of a program with
    /// several are given by their numbers: `--tool 1=D2Ball,2=drill.tool`.
    #[arg(long, value_name = "[NUMBER=]NAME|FILE.tool", value_delimiter = ',')]
    pub(crate) tool: Vec<OsString>,
    /// Program to follow: positions of the tip, or G-code.
    #[arg(long, value_name = "FILE")]
    pub(crate) program: Option<PathBuf>,
    /// Machine of a G-code program: its name or its file [default: `3-axis`].
    #[arg(long, value_name = "NAME|FILE.toml", requires = "program")]
    pub(crate) machine: Option<OsString>,
    /// Port to listen at, on 127.0.0.1; 0 is any that is free.
    #[arg(long, value_name = "NUMBER", default_value_t = 0)]
    pub(crate) port: u16,
    /// Open no browser, only print the address.
    #[arg(long)]
    pub(crate) no_open: bool,
}

/// The device that moves the tool.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum DeviceKind {
    /// A simulated hand that presses the tool onto the part.
    Hand,
    /// The poses of `--program`, played once.
    Playback,
    /// A SpaceMouse, through its daemon `spacenavd`.
    Spacenav,
}

impl DeviceKind {
    /// Returns the device's name on the command line.
    pub(crate) fn name(self) -> &'static str {
        match self {
            DeviceKind::Hand => "hand",
            DeviceKind::Playback => "playback",
            DeviceKind::Spacenav => "spacenav",
        }
    }
}
