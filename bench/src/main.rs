//! The measurement program. Each command writes a page of measurements and its drawings to `docs/measured`:
//!
//! ```sh
//! cargo run --release -p touchoff-bench -- NAME [options]
//! ```

mod commands;

use clap::{Parser, Subcommand};
use std::error::Error;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;
use touchoff_bench::page::Page;

/// Measures Touchoff and writes pages of measurements.
#[derive(Parser)]
#[command(after_help = "\
Exit status:
  0  done
  1  failed
  2  wrong options")]
struct Arguments {
    #[command(subcommand)]
    command: Command,
    /// Output folder for the page and its drawings; existing files are replaced [default: `docs/measured` of the
    /// repository].
    #[arg(long, global = true, value_name = "DIR")]
    to: Option<PathBuf>,
}

#[derive(Subcommand)]
enum Command {
    Certified(commands::Certified),
    Compile(commands::Compile),
    Haptics(commands::Haptics),
    Programs(commands::Programs),
    Speed(commands::Speed),
    WorkPrecision(commands::WorkPrecision),
}

impl Command {
    /// Runs the measurement. Returns the page, or `None` if the command makes none.
    fn run(&self) -> Result<Option<Page>, Box<dyn Error>> {
        match self {
            Command::Certified(command) => command.run(),
            Command::Compile(command) => command.run(),
            Command::Haptics(command) => command.run(),
            Command::Programs(command) => command.run(),
            Command::Speed(command) => command.run(),
            Command::WorkPrecision(command) => command.run(),
        }
    }
}

fn main() -> ExitCode {
    match measure(&Arguments::parse()) {
        Ok(code) => code,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

fn measure(arguments: &Arguments) -> Result<ExitCode, Box<dyn Error>> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let folder = arguments.to.clone().unwrap_or_else(|| root.join("docs/measured"));
    // Measurements take hours: create the folder first, so that an unusable one is reported at once.
    let named = |error| format!("{}: {error}", folder.display());
    std::fs::create_dir_all(&folder).map_err(named)?;
    let start = Instant::now();
    let Some(page) = arguments.command.run()? else { return Ok(ExitCode::SUCCESS) };
    page.write(&folder, &command()).map_err(named)?;
    eprintln!("{} in {:.0} s", page.path(&folder).display(), start.elapsed().as_secs_f64());
    Ok(ExitCode::SUCCESS)
}

/// Returns the command line that makes the same page, without the `--to` option.
fn command() -> String {
    let features = if cfg!(feature = "peers") { " --features peers" } else { "" };
    let mut command = vec![format!("cargo run --release -p touchoff-bench{features} --")];
    let mut words = std::env::args_os().skip(1).map(|word| word.to_string_lossy().into_owned());
    while let Some(word) = words.next() {
        match word.as_str() {
            "--to" => drop(words.next()),
            _ if word.starts_with("--to=") => (),
            _ => command.push(word),
        }
    }
    command.join(" ")
}
