//! The line that heads a page of figures: commit, command, machine, and the paths that it vouches for.

use std::process::Command;

/// Returns the head line of a page: by which `command` its figures were made, at which commit, on which machine, and
/// which paths of the repository they depend on. A commit ends with `-dirty` where files differ from it.
pub fn made(command: &str, covers: &[&str]) -> String {
    let git = Command::new("git").args(["describe", "--always", "--dirty", "--exclude=*"]).output();
    let commit = git.ok().and_then(|output| String::from_utf8(output.stdout).ok());
    let commit = commit.unwrap_or_default();
    let cpus = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let model = cpus.lines().find_map(|line| line.strip_prefix("model name")?.split_once(": "));
    let model = model.map_or("an unknown processor", |(_, model)| model);
    let cores = std::thread::available_parallelism().map_or(0, usize::from);
    let covers = covers.iter().map(|path| format!("`{path}`")).collect::<Vec<_>>().join(", ");
    format!(
        "*Made at commit {} by `{command}` on {cores} cores of {model}; covers {covers}.*",
        commit.trim()
    )
}
