//! The `touchoff` program: a command line for the libraries.

#[macro_use]
mod output;

mod arguments;
mod check;
mod controls;
mod draw;
mod expand;
mod explain;
mod export;
mod failure;
mod fmt;
mod haptic;
mod import;
mod live;
mod loaded_tool;
mod part;
mod picture;
mod postures;
mod program;
mod progress;
mod report;
mod run;
mod timing;
mod tools;
mod verify;

use arguments::{Arguments, Command};
use std::process::ExitCode;

fn main() -> ExitCode {
    let Arguments { command, json } = Arguments::read();
    // A program that could not be checked must not look like one with findings.
    let min_status = match command {
        Command::Verify(_) | Command::Report(_) => verify::NOT_CHECKED,
        _ => 1,
    };
    let success = |()| ExitCode::SUCCESS;
    let result = match command {
        Command::Run(arguments) => run::run(&arguments, json).map(success),
        Command::Verify(arguments) => verify::verify(*arguments, json),
        Command::Report(arguments) => report::report(*arguments, json),
        Command::Haptic(arguments) => haptic::haptic(&arguments, json).map(success),
        Command::Live(arguments) => live::live(&arguments, json).map(success),
        Command::Sweep(arguments) => postures::sweep::sweep(&arguments, json).map(success),
        Command::Merge(arguments) => postures::shard::merge(&arguments, json),
        Command::Map(arguments) => postures::map::map(&arguments, json).map(success),
        Command::Path(arguments) => postures::path::path(&arguments, json).map(success),
        Command::Sample(arguments) => part::sample(&arguments, json).map(success),
        Command::Import(arguments) => import::import(&arguments, json),
        Command::Export(arguments) => export::export(&arguments, json),
        Command::Tools(arguments) => tools::tools(&arguments, json).map(success),
        Command::Controls { name } => controls::controls(name.as_deref(), json).map(success),
        Command::Machines { name } => controls::machines(name.as_deref(), json).map(success),
        Command::Check(arguments) => check::check(&arguments, json),
        Command::Explain(arguments) => {
            explain::explain(arguments.code.as_deref(), json).map(success)
        }
        Command::Fmt(arguments) => fmt::fmt(&arguments, json).map(success),
        Command::Expand(arguments) => expand::expand(&arguments).map(success),
        Command::Draw(arguments) => draw::draw(&arguments).map(success),
    };
    result.unwrap_or_else(|failure| fail(&failure, min_status))
}

/// Reports a failure, and returns its exit status, which is `min_status` or higher.
fn fail(failure: &failure::Failure, min_status: u8) -> ExitCode {
    match failure.code() {
        _ if failure.is_rendered() => message!("{failure}"),
        Some(code) => message!("error[{code}]: {failure}"),
        None => message!("error: {failure}"),
    }
    ExitCode::from(failure.status().max(min_status))
}
