//! The arguments of the commands for tools and their files.

use super::{ParamArguments, ToolArguments, examples};
use clap::{Args, Subcommand, ValueEnum};
use std::ffi::OsString;
use std::path::PathBuf;

#[derive(Args)]
#[command(subcommand_value_name = "list|show", args_conflicts_with_subcommands = true)]
pub(crate) struct Tools {
    /// `.tool` files and tool libraries to list instead of the built-in tools.
    #[arg(value_name = "FILE")]
    pub(crate) files: Vec<PathBuf>,
    /// Action; without one, list the built-in tools.
    #[command(subcommand)]
    pub(crate) command: Option<ToolsCommand>,
}

#[derive(Subcommand)]
pub(crate) enum ToolsCommand {
    /// List the built-in tools, or the tools of files, with their units and titles. Tools of a library are listed with
    /// number, type, sizes and holder, and with the proof that depth is exact.
    #[command(after_help = examples::TOOLS_LIST)]
    List {
        /// `.tool` files and tool libraries to list instead of the built-in tools.
        #[arg(value_name = "FILE")]
        files: Vec<PathBuf>,
        #[command(flatten)]
        params: ParamArguments,
    },
    /// Print the text of a built-in tool, to be mounted or changed.
    ///
    /// With `--output`, a tool that mounts others works from its new folder: the files that it mounts are written
    /// below that folder too.
    #[command(after_help = examples::TOOLS_SHOW)]
    Show {
        /// Name of the built-in tool.
        #[arg(value_name = "NAME")]
        name: String,
        /// Output file, whose folder is made if it is missing [default: standard output, without the files that the
        /// tool mounts].
        #[arg(short, long, value_name = "OUT.tool")]
        output: Option<PathBuf>,
    },
}

#[derive(Args)]
pub(crate) struct Import {
    /// Libraries: Fusion 360 (`.json`, `.tools`), Kiri:Moto (`.json`), CAMotics (`.json`, `.camotics`), FreeCAD
    /// (`.fctb`, `.fctl`, `.fcholder`), HSM (`.hsmlib`), LinuxCNC (`.tbl`), APT and NX (`.apt`, `.cl`, `.cls`).
    #[arg(required = true, value_name = "FILE")]
    pub(crate) files: Vec<PathBuf>,
    /// Output folder [default: the library's name, in the current folder].
    #[arg(short, long, value_name = "DIR")]
    pub(crate) output: Option<PathBuf>,
    /// List the tools, and write nothing.
    #[arg(long)]
    pub(crate) list: bool,
    /// Import only the tool with this name, title or number.
    #[arg(long, value_name = "NAME")]
    pub(crate) only: Option<String>,
}

#[derive(Args)]
pub(crate) struct Export {
    /// Tools to export: built-in tools, `.tool` files, or tools of the library `--tools`.
    #[arg(required = true, value_name = "NAME|FILE.tool")]
    pub(crate) tools: Vec<OsString>,
    /// Output file; its ending gives the format: `.json` (Fusion 360), `.fctb` (FreeCAD, one tool) or `.apt`.
    #[arg(short, long, value_name = "OUT.json|OUT.fctb|OUT.apt")]
    pub(crate) output: PathBuf,
    #[command(flatten)]
    pub(crate) tool: ToolArguments,
}

#[derive(Args)]
pub(crate) struct Check {
    /// `.tool` files to check.
    #[arg(required = true, value_name = "FILE.tool")]
    pub(crate) files: Vec<PathBuf>,
    #[command(flatten)]
    pub(crate) params: ParamArguments,
    /// Print the whole table: every region and every border between regions. Without this option, five lines per
    /// file.
    #[arg(short, long)]
    pub(crate) verbose: bool,
}

#[derive(Args)]
pub(crate) struct Explain {
    /// Code to explain, as printed between the brackets of a message, such as T0201 or P0112.
    #[arg(value_name = "CODE")]
    pub(crate) code: Option<String>,
}

#[derive(Args)]
pub(crate) struct Fmt {
    /// Change nothing: print the names of the files that would be rewritten, and fail if there are any.
    #[arg(long)]
    pub(crate) check: bool,
    /// `.tool` files to format in place; `-` reads standard input and writes standard output.
    #[arg(required = true, value_name = "FILE.tool")]
    pub(crate) files: Vec<PathBuf>,
}

#[derive(Args)]
pub(crate) struct Expand {
    /// `.tool` files to expand.
    #[arg(required = true, value_name = "FILE.tool")]
    pub(crate) files: Vec<PathBuf>,
    /// Stage to print.
    #[arg(long, value_enum, default_value_t = Stage::Rust)]
    pub(crate) stage: Stage,
    #[command(flatten)]
    pub(crate) params: ParamArguments,
    /// Output file [default: standard output].
    #[arg(short, long, value_name = "OUT")]
    pub(crate) output: Option<PathBuf>,
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

#[derive(Args)]
pub(crate) struct Draw {
    /// `.tool` file to draw.
    #[arg(value_name = "FILE.tool")]
    pub(crate) file: PathBuf,
    /// Also draw the regions, with the direction to the surface in each.
    #[arg(long)]
    pub(crate) regions: bool,
    /// Output file, `.svg` or `.png` [default: SVG on standard output].
    #[arg(short, long, value_name = "OUT.svg|OUT.png")]
    pub(crate) output: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) params: ParamArguments,
}
