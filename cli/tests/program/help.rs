//! Help texts: every command has two examples that work as they stand.

use crate::bench::{Bench, TOOL, stderr, stdout, touchoff};
use crate::import::LIBRARY;
use std::process::{Command, Output};

const COMMANDS: [&str; 20] = [
    // `sweep` makes the map that `map` and `path` read.
    "sweep", "merge", "map", "path", "run", "verify", "report", "haptic", "live", "sample",
    "import", "export", "tools", "controls", "machines", "check", "explain", "fmt", "expand",
    "draw",
];

const PROGRAM: &str =
    "UNITS/MM\nGOTO/-9,0,3,0,0,1\nGOTO/-9,0,-0.5,0,0,1\nGOTO/9,0,-0.5,0,0,1\nFINI\n";

/// Returns the examples at the end of a help text, without their explanations.
fn examples(help: &str) -> Vec<Vec<&str>> {
    let (_, examples) = help.split_once("\nExamples:\n").expect("examples at the end");
    let lines = examples.lines().filter_map(|line| line.trim().strip_prefix("touchoff "));
    lines.map(|line| line.split(' ').collect()).collect()
}

/// Runs a command in the folder of a bench. Of a partial command, and of one that runs for seconds or until it is ended, clap parses the
/// options and then shows the help text.
pub(super) fn parsed(bench: &Bench, mut arguments: Vec<&str>, partial: bool) -> Output {
    let command = arguments.first().copied().unwrap_or_default();
    if partial || ["haptic", "live"].contains(&command) {
        arguments.push("--help");
    }
    let mut program = Command::new(env!("CARGO_BIN_EXE_touchoff"));
    program.args(arguments).current_dir(&bench.folder).output().expect("the program runs")
}

/// Runs the commands of a page's first block of commands in the folder of a bench, and returns each with its output.
pub(super) fn page_commands(bench: &Bench, page: &'static str) -> Vec<(&'static str, Output)> {
    let (_, block) = page.split_once("```sh\n").expect("a block of commands");
    let (block, _) = block.split_once("```").expect("its end");
    let run = |line: &'static str| {
        let command = line.split_once(" #").map_or(line, |(command, _)| command).trim_end();
        (command, parsed(bench, command.split(' ').skip(1).collect(), false))
    };
    block.lines().map(run).collect()
}

/// Returns a bench with the files that help texts and pages name.
pub(super) fn example_files() -> Bench {
    let bench = Bench::new();
    let block = bench.folder.path().join("block.stl");
    std::fs::copy(block, bench.folder.path().join("part.stl")).expect("a writable folder");
    bench.write("program.apt", PROGRAM);
    bench.write("my.tool", TOOL);
    bench.write("library.json", LIBRARY);
    bench
}

#[test]
fn all_commands_are_listed() {
    let help = stdout(&touchoff(&["--help"]));
    let (_, rest) = help.split_once("Commands:\n").expect("a list");
    let (list, _) = rest.split_once("\n\n").expect("its end");
    let mut listed: Vec<&str> =
        list.lines().filter_map(|line| line.split_whitespace().next()).collect();
    listed.retain(|command| *command != "help");
    let mut commands = COMMANDS.to_vec();
    listed.sort_unstable();
    commands.sort_unstable();
    assert_eq!(listed, commands);
}

#[test]
fn examples_work_as_they_stand() {
    let bench = example_files();
    for number in 1..=2 {
        let sweep = "sweep --part part.stl --unit mm --tool D2Ball --directions 10";
        let shard = bench.touchoff(&format!("{sweep} --shard {number}/2 -o {number}.parquet"));
        assert!(shard.status.success(), "{}", stderr(&shard));
    }
    for command in COMMANDS.into_iter().chain(["tools list", "tools show"]) {
        let words: Vec<&str> = command.split(' ').chain(["--help"]).collect();
        let help = stdout(&touchoff(&words));
        let examples = examples(&help);
        assert_eq!(examples.len(), 2, "{command}: {help}");
        for example in examples {
            assert!(example.join(" ").starts_with(command), "{command}: {example:?}");
            let output = parsed(&bench, example.clone(), false);
            let status = output.status.code().expect("a status");
            assert!(status == 0, "{}: {status}: {}", example.join(" "), stderr(&output));
        }
    }
}

/// Every option says what it does.
#[test]
fn options_have_a_description() {
    for command in COMMANDS {
        let help = stdout(&touchoff(&[command, "--help"]));
        let lines: Vec<&str> = help.lines().collect();
        for pair in lines.windows(2).filter(|pair| pair[0].trim_start().starts_with("--")) {
            assert!(!pair[1].trim().is_empty() || pair[0].contains("  "), "{command}: {}", pair[0]);
        }
    }
}
