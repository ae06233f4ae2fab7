//! The command-line arguments.

mod common;
mod contact;
mod examples;
pub(crate) mod postures;
mod tools;
mod values;

pub(crate) use common::{MeshFile, ParamArguments, PartFile, ToolArguments};
pub(crate) use contact::{CheckArguments, DeviceKind, Haptic, Live, Report, Run, Sample, Verify};
pub(crate) use tools::{
    Check, Draw, Expand, Explain, Export, Fmt, Import, Stage, Tools, ToolsCommand,
};

use crate::failure::Failure;
use crate::output::open_or;
use clap::{Parser, Subcommand};
use std::io::{self, Write as _};

/// The end of the program's help text: examples, and the exit statuses of all commands.
const AFTER_HELP: &str = "\
Examples:
  Find gouges deeper than 0.01 mm in a 5-axis program:
    touchoff verify --part part.stl --unit mm --tool D2Ball --program program.apt --tolerance 0.01
  Describe the options of a command:
    touchoff verify --help

Exit status:
  0  success; `verify` without findings, `check` without warnings
  1  failure, or something is wrong: findings of `verify` and `report`, errors of `check`, files that
     `fmt --check` would rewrite
  2  wrong options, an output that is also an input, a part whose inside is undefined where it is needed, a
     program that could not be checked, or no time (`--max-time`) or memory left
  3  `check` only warns; `import` or `export` left a tool out
  130  a signal ended `haptic`
The status is the same if the reader of the output closes it early. Output that cannot be written, as on a full
disk, is a failure. A file is replaced once it is whole: one that cannot be written is left as it was.";

/// Compute, render and verify the contact of cutting tools with a workpiece, at any pose.
#[derive(Parser)]
#[command(version, after_help = AFTER_HELP)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    pub(crate) command: Command,
    /// Print JSON, one object per row: per pose, per tool or per line of a table. `report`, `sample`, `expand` and
    /// `draw` print no rows.
    #[arg(long, global = true)]
    pub(crate) json: bool,
    /// End with status 2 after this time, in seconds, whatever is left to do.
    #[arg(long, global = true, value_name = "SECONDS", value_parser = values::positive)]
    pub(crate) max_time: Option<f64>,
}

#[derive(Subcommand)]
pub(crate) enum Command {
    /// Compute depth, force, torque and niceness of a tool in a part, at each pose of a program.
    #[command(after_help = examples::RUN)]
    Run(Box<Run>),
    /// Check a program against the finished part, fixtures and stock: find where the tool is deeper than allowed.
    ///
    /// Every motion is proved, not only its end points. Prints one line per finding, the worst first, up to 1,000. The exit
    /// status is 1 if there are findings, and 2 if the program could not be checked.
    #[command(after_help = examples::VERIFY)]
    Verify(Box<Verify>),
    /// Write one HTML file about a program or a posture map, to send around: verdict, findings, the part in 3-D, tools, forces.
    ///
    /// Checks the program as `verify` does, with the same exit status. The file opens in any browser, and nothing in it
    /// asks for another file.
    #[command(after_help = examples::REPORT)]
    Report(Box<Report>),
    /// Run the haptic loop in real time: a device moves a tool that touches a part.
    ///
    /// Prints the cycle times, the number of missed deadlines, the largest force, and the balance of the hand's
    /// energy.
    #[command(after_help = examples::HAPTIC)]
    Haptic(Box<Haptic>),
    /// Touch a part with a tool in the browser: serve a page on this machine, and open it.
    ///
    /// The tool is dragged by mouse, touch, gamepad or SpaceMouse, and its text can be edited. Nothing leaves the machine.
    /// The server runs until Ctrl-C.
    #[command(after_help = examples::LIVE)]
    Live(Live),
    /// Try tools at every triangle of a part, from every direction: find which tools reach it, and the best
    /// posture.
    ///
    /// Every posture that counts is proved. With `--output`, postures are kept in a map, and a later sweep continues
    /// it.
    #[command(after_help = examples::SWEEP)]
    Sweep(Box<postures::Sweep>),
    /// Join the shards of a sweep to one map, or list those that are left.
    ///
    /// Shards are checked: one of another part, tool, rule or version, a damaged one, one that is missing or there twice is
    /// named and refused. The map has the same bytes wherever and in whatever order they were swept.
    #[command(after_help = examples::MERGE)]
    Merge(postures::Merge),
    /// Summarise a posture map, and write it as a table, JSON, a coloured mesh, or pictures.
    #[command(after_help = examples::MAP)]
    Map(Box<postures::Map>),
    /// Plan a path of a tool over all that it reaches of a part, and write it as a 5-axis program, proved at and
    /// between its cutter locations.
    #[command(after_help = examples::PATH)]
    Path(Box<postures::Path>),
    /// Sample points of a part, and save them for later runs.
    #[command(after_help = examples::SAMPLE)]
    Sample(Box<Sample>),
    /// Import the tools of a CAM system's library as `.tool` files, with a proof of each.
    ///
    /// Cutters and holders become files of their own, which the tool mounts. The exit status is 3 if a tool was left out.
    #[command(after_help = examples::IMPORT)]
    Import(Import),
    /// Export tools to the format of a CAM system: Fusion 360, FreeCAD or APT.
    ///
    /// Each is imported again: what a format cannot express is left out with the reason. The exit status is then 3.
    #[command(after_help = examples::EXPORT)]
    Export(Export),
    /// List the built-in tools or the tools of files and libraries, or print the text of a built-in tool.
    #[command(after_help = examples::TOOLS)]
    Tools(Tools),
    /// List the controls that are known, with what each does where controls differ; or print one as a file to edit.
    #[command(after_help = examples::CONTROLS)]
    Controls {
        /// Control to print as a file.
        #[arg(value_name = "NAME")]
        name: Option<String>,
    },
    /// List the machines that come along, with limits, homes and pivots of their axes; or print the file of one.
    #[command(after_help = examples::MACHINES)]
    Machines {
        /// Machine whose file is printed.
        #[arg(value_name = "NAME")]
        name: Option<String>,
    },
    /// Check `.tool` files, and print the bounds that are proved for them.
    ///
    /// The exit status is 1 if a file has errors, and 3 if there are only warnings.
    #[command(after_help = examples::CHECK)]
    Check(Check),
    /// Explain an error or warning code, with its remedy and an example; without a code, list all codes.
    #[command(after_help = examples::EXPLAIN)]
    Explain(Explain),
    /// Format `.tool` files in the standard layout.
    #[command(after_help = examples::FMT)]
    Fmt(Fmt),
    /// Print the Rust code that a `.tool` file compiles to, or an earlier stage of its compilation.
    #[command(after_help = examples::EXPAND)]
    Expand(Expand),
    /// Draw a `.tool` file: its section with surfaces and dimensions, and its regions if requested.
    #[command(after_help = examples::DRAW)]
    Draw(Draw),
}

impl Arguments {
    /// Parses the program's arguments; ends the program with a message if they are wrong, and with the text that `--help` asks for.
    ///
    /// # Errors
    /// If that text cannot be written.
    pub(crate) fn read() -> Result<Arguments, Failure> {
        let arguments = values::join_negative_numbers(std::env::args_os());
        let refusal = match Arguments::try_parse_from(arguments) {
            Ok(arguments) => return Ok(arguments),
            Err(refusal) => refusal,
        };
        let printed = refusal.print().and_then(|()| io::stdout().flush());
        if !refusal.use_stderr() {
            open_or(printed, ())?;
        }
        std::process::exit(refusal.exit_code());
    }
}
