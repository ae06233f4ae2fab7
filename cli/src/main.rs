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
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

fn main() -> ExitCode {
    end_when_memory_is_used_up();
    // A panic, as where the system refuses a thread, has a status of the manual, too.
    let report = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |panic| {
        end_soon();
        report(panic);
        end_at_once();
    }));
    let Arguments { command, json, max_time } = match Arguments::read() {
        Ok(arguments) => arguments,
        Err(failure) => return fail(&failure, 1),
    };
    if let Some(Err(failure)) = max_time.map(end_after) {
        return fail(&failure, verify::NOT_CHECKED);
    }
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
    let status = result.unwrap_or_else(|failure| fail(&failure, min_status));
    if IS_ENDING.swap(true, Ordering::Relaxed) {
        // The timer ends the program, with its message and its status.
        loop {
            std::thread::park();
        }
    }
    status
}

/// The choice between the main thread and the timer of `--max-time`: the first of them to set it ends the program.
static IS_ENDING: AtomicBool = AtomicBool::new(false);

/// The exit status of a command that had no time or no memory left, or has a fault itself.
const OUT_OF_RESOURCES: i32 = 2;

/// Ends the program after a time. What it does then, a proof or the reader of a file, need not be able to stop.
///
/// # Errors
/// If the system allows no thread for it.
fn end_after(seconds: f64) -> Result<(), failure::Failure> {
    let timer = move || {
        // A time too long for a duration does not pass.
        std::thread::sleep(Duration::try_from_secs_f64(seconds).unwrap_or(Duration::MAX));
        if IS_ENDING.swap(true, Ordering::Relaxed) {
            return;
        }
        // The reader of standard error may have stopped: the message has a moment.
        let say = move || {
            message!(
                "error: not done after {seconds} s (`--max-time`): allow more time, or ask for less"
            );
        };
        if let Ok(said) = std::thread::Builder::new().spawn(say) {
            let end = Instant::now() + Duration::from_millis(200);
            while !said.is_finished() && Instant::now() < end {
                std::thread::sleep(Duration::from_millis(5));
            }
        }
        end_at_once();
    };
    let spawned = std::thread::Builder::new().spawn(timer);
    spawned.map(drop).map_err(failure::Failure::NoTimer)
}

/// Ends the program without anything that could wait.
fn end_at_once() {
    #[cfg(unix)]
    #[expect(unsafe_code, reason = "the standard library has no exit that waits for nothing")]
    // SAFETY: it ends the process.
    unsafe {
        libc::_exit(OUT_OF_RESOURCES)
    };
    #[cfg(not(unix))]
    std::process::exit(OUT_OF_RESOURCES);
}

/// Ends the program with a status of its own, and not by a signal, when the system refuses memory: the library aborts then.
#[cfg(unix)]
#[expect(
    unsafe_code,
    reason = "handlers of signals are the system's, and what one may call is for its author to ensure"
)]
fn end_when_memory_is_used_up() {
    let end: extern "C" fn(libc::c_int) = end_without_memory;
    // SAFETY: the handler has the signature that the system calls.
    unsafe { libc::signal(libc::SIGABRT, end as libc::sighandler_t) };
}

/// Handles a signal: says that there is no memory, and ends the program.
#[cfg(unix)]
#[expect(unsafe_code, reason = "a handler of a signal may call the system alone")]
extern "C" fn end_without_memory(_: libc::c_int) {
    const MESSAGE: &[u8] =
        b"error: the system has no more memory for the program: allow more, or ask for less\n";
    // SAFETY: a handler may call both, and the bytes are those of the message.
    unsafe {
        libc::write(libc::STDERR_FILENO, MESSAGE.as_ptr().cast(), MESSAGE.len());
        libc::_exit(OUT_OF_RESOURCES);
    }
}

#[cfg(not(unix))]
fn end_when_memory_is_used_up() {}

/// Ends the program after seconds that the report of a panic may take. Where the system refuses memory, its backtrace waits for itself.
#[cfg(unix)]
#[expect(unsafe_code, reason = "alarms are the system's")]
fn end_soon() {
    /// More than a backtrace takes.
    const SECONDS: libc::c_uint = 10;
    // SAFETY: both are calls of the system without pointers of ours; the handler ends the process.
    unsafe {
        libc::signal(
            libc::SIGALRM,
            end_without_memory as extern "C" fn(libc::c_int) as libc::sighandler_t,
        );
        libc::alarm(SECONDS);
    }
}

#[cfg(not(unix))]
fn end_soon() {}

/// Reports a failure, and returns its exit status, which is `min_status` or higher.
fn fail(failure: &failure::Failure, min_status: u8) -> ExitCode {
    match failure.code() {
        _ if failure.is_rendered() => output::show_lines(&failure.to_string()),
        // Each line is escaped by itself.
        Some(code) if failure.has_lines() => {
            output::show_lines(&format!("error[{code}]: {failure}"));
        }
        Some(code) => message!("error[{code}]: {failure}"),
        None => message!("error: {failure}"),
    }
    ExitCode::from(failure.status().max(min_status))
}
