//! The jobs of `integrations/jobs`, by the program, by the script of the action and the hook, and by what the hook's file says.

use crate::bench::{findings, stderr, touchoff};
use serde::Deserialize;
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// The verdict that a job has to have.
#[derive(Deserialize)]
struct Expected {
    status: i32,
    /// Each surface with the body that it violates: `shank in the part`.
    findings: Vec<String>,
}

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

fn expected() -> BTreeMap<String, Expected> {
    let text = std::fs::read_to_string(root().join("integrations/jobs/expected.toml"));
    toml::from_str(&text.expect("the table of verdicts")).expect("a table")
}

fn job(name: &str) -> String {
    root().join("integrations/jobs").join(name).with_extension("toml").display().to_string()
}

#[test]
fn jobs_have_their_verdicts() {
    let jobs = expected();
    assert_eq!(jobs.len(), 3);
    for (name, Expected { status, findings: expected }) in jobs {
        let output = touchoff(&["verify", &job(&name), "--json"]);
        assert_eq!(output.status.code(), Some(status), "{name}: {}", stderr(&output));
        let found: Vec<String> = findings(&output)
            .iter()
            .map(|row| {
                let word = |key: &str| row[key].as_str().expect("a word").to_owned();
                assert_eq!(row["kind"], "deep", "{row}");
                format!("{} in {}", word("surface"), word("body"))
            })
            .collect();
        assert_eq!(found, expected, "{name}");
    }
}

/// Runs a script of the repository with the program that was built.
fn script(command: &str, folder: &Path, arguments: &[String]) -> Output {
    let mut words = command.split(' ');
    let program = root().join(words.next().expect("a script"));
    let mut command = Command::new(program);
    command.args(words).args(arguments).current_dir(folder);
    command.env("TOUCHOFF", env!("CARGO_BIN_EXE_touchoff")).output().expect("bash")
}

#[test]
fn the_action_and_the_hook_verify_jobs() {
    let jobs: Vec<String> = expected().keys().map(|name| job(name)).collect();
    let hooks = std::fs::read_to_string(root().join(".pre-commit-hooks.yaml")).expect("hooks");
    let entry = hooks.lines().find_map(|line| line.trim().strip_prefix("entry: "));
    let action =
        std::fs::read_to_string(root().join("integrations/github/action.yml")).expect("an action");
    assert!(action.contains("/../verify-jobs\" \"${{ inputs.sarif }}\" ${{ inputs.jobs }}"));
    for command in [entry.expect("an entry"), "integrations/verify-jobs touchoff-sarif"] {
        let folder = tempfile::tempdir().expect("a folder");
        let output = script(command, folder.path(), &jobs);
        assert_eq!(output.status.code(), Some(1), "{}", stderr(&output));
        let files = std::fs::read_dir(folder.path().join("touchoff-sarif")).expect("a folder");
        let results = files.map(|file| {
            let text = std::fs::read(file.expect("a file").path()).expect("a log");
            let log: Value = serde_json::from_slice(&text).expect("JSON");
            assert_eq!(log["version"], "2.1.0");
            log["runs"][0]["results"].as_array().expect("results").len()
        });
        let mut results: Vec<usize> = results.collect();
        results.sort_unstable();
        assert!(results.len() == 3 && results[1] > 0, "{results:?}");
    }
    let folder = tempfile::tempdir().expect("a folder");
    let clean = script("integrations/verify-jobs out", folder.path(), &[job("clean")]);
    assert_eq!(clean.status.code(), Some(0), "{}", stderr(&clean));
    let missing =
        script("integrations/verify-jobs out", folder.path(), &[job("clean"), job("none")]);
    assert_eq!(missing.status.code(), Some(2), "{}", stderr(&missing));
    let none = script("integrations/verify-jobs out", folder.path(), &[]);
    assert!(none.status.code() == Some(2) && stderr(&none).contains("usage"));
}
