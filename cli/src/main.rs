//! The `touchoff` program: a command line for the libraries.

#[macro_use]
mod output;

mod arguments;
mod bench;
mod check;
mod demo;
mod draw;
mod explain;
mod failure;
mod files;
mod fmt;
mod haptic;
mod part;
mod postures;
mod program;
mod run;
mod timing;
mod verify;

use arguments::{Arguments, Command};
use clap::Parser;
use std::process::ExitCode;

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    let done = match arguments.command {
        None | Some(Command::Demo) => demo::demo(arguments.json),
        Some(Command::Run(wanted)) => run::run(&wanted, arguments.json),
        Some(Command::Verify(wanted)) => {
            return ended_or(verify::verify(&wanted, arguments.json), verify::NOT_CHECKED);
        }
        Some(Command::Haptic(wanted)) => haptic::haptic(&wanted, arguments.json),
        Some(Command::Sweep(wanted)) => postures::sweep::sweep(&wanted, arguments.json),
        Some(Command::Map(wanted)) => postures::map::map(&wanted, arguments.json),
        Some(Command::Path(wanted)) => postures::path::path(&wanted, arguments.json),
        Some(Command::Sample(wanted)) => part::sample(&wanted),
        Some(Command::Bench(wanted)) => bench::bench(&wanted, arguments.json),
        Some(Command::Tools { files, given }) => files::tools(&files, &given, arguments.json),
        Some(Command::Check { files, given }) => {
            return ended(check::check(&files, &given, arguments.json));
        }
        Some(Command::Expand { files, stage, given }) => files::expand(&files, stage, &given),
        Some(Command::Explain { code }) => explain::explain(code.as_deref(), arguments.json),
        Some(Command::Fmt { check, files }) => fmt::fmt(&files, check, arguments.json),
        Some(Command::Draw { file, output, given }) => draw::draw(&file, output.as_deref(), &given),
    };
    ended(done.map(|()| ExitCode::SUCCESS))
}

fn ended(done: Result<ExitCode, failure::Failure>) -> ExitCode {
    ended_or(done, 1)
}

/// Reports a failure and returns its exit status, which is `failed` or higher.
fn ended_or(done: Result<ExitCode, failure::Failure>, failed: u8) -> ExitCode {
    match done {
        Ok(code) => code,
        Err(failure) => {
            let severity = if failure.is_rendered() { "" } else { "error: " };
            say!("{severity}{failure}");
            ExitCode::from(failure.status().max(failed))
        }
    }
}
