//! The `touchoff` program: words for people over the libraries.

mod arguments;
mod demo;
mod failure;
mod files;
mod run;
mod timing;

use arguments::{Arguments, Command};
use clap::Parser;
use failure::Failure;
use std::process::ExitCode;

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    let done = match arguments.command {
        None => demo::demo(arguments.json),
        Some(Command::Demo { json }) => demo::demo(json || arguments.json),
        Some(Command::Run(wanted)) => run::run(&wanted),
        Some(Command::Tools { json }) => files::tools(json),
        Some(Command::Check { files }) => files::check(&files),
        Some(Command::Expand { file }) => files::expand(&file),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        // Whoever read the output has enough of it.
        Err(Failure::Output(error)) if error.kind() == std::io::ErrorKind::BrokenPipe => {
            ExitCode::SUCCESS
        }
        Err(failure) => {
            eprintln!("error: {failure}");
            ExitCode::FAILURE
        }
    }
}
