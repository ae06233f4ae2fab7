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
    let jobs: Vec<String> = expected().keys().map(|name| format!("{name}.toml")).collect();
    let hooks = std::fs::read_to_string(root().join(".pre-commit-hooks.yaml")).expect("hooks");
    let entry = hooks.lines().find_map(|line| line.trim().strip_prefix("entry: "));
    for command in [entry.expect("an entry"), "integrations/verify-jobs touchoff-sarif"] {
        let folder = jobs_folder();
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
    let folder = jobs_folder();
    let status = |jobs: &[&str]| {
        let jobs: Vec<String> = jobs.iter().map(|job| (*job).to_owned()).collect();
        let output = script("integrations/verify-jobs out", folder.path(), &jobs);
        (output.status.code().expect("a status"), stderr(&output))
    };
    assert_eq!(status(&["clean.toml"]).0, 0);
    assert_eq!(status(&["clean.toml", "none.toml"]).0, 2);
    let (none, said) = status(&[]);
    assert!(none == 2 && said.contains("usage"), "{said}");
}

/// Returns a copy of the folder of jobs.
fn jobs_folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    for file in std::fs::read_dir(root().join("integrations/jobs")).expect("the jobs") {
        let file = file.expect("a file");
        std::fs::copy(file.path(), folder.path().join(file.file_name())).expect("copied");
    }
    folder
}

/// Jobs of a stranger, whose names and links the script must not obey.
#[test]
#[cfg(unix)]
fn names_and_links_of_jobs_are_no_commands() {
    use std::os::unix::fs::symlink;
    let folder = jobs_folder();
    let place = |name: &str| folder.path().join(name);
    for inner in ["a", "a%2Fb.toml.d"] {
        std::fs::create_dir(place(inner)).expect("a folder");
    }
    let text = std::fs::read_to_string(place("shank.toml")).expect("a job");
    let below = ["bracket.stl", "shank.nc", "mill.tool", "clamp.stl"]
        .iter()
        .fold(text.clone(), |text, file| {
            text.replace(&format!("\"{file}"), &format!("\"../{file}"))
        });
    let names = ["-h.toml", "--help", "a b.toml", "$(touch broken).toml", "é.toml", "a-b.toml"];
    for name in names {
        std::fs::write(place(name), &text).expect("written");
    }
    std::fs::write(place("a/b.toml"), &below).expect("written");
    let jobs = names.iter().chain(&["a/b.toml"]);
    let jobs: Vec<String> = jobs.map(|name| (*name).to_owned()).collect();
    for job in &jobs {
        let output =
            script("integrations/verify-jobs out", folder.path(), std::slice::from_ref(job));
        assert_eq!(output.status.code(), Some(1), "{job}: {}", stderr(&output));
    }
    assert!(!place("broken").exists());
    let count = std::fs::read_dir(place("out")).expect("the findings").count();
    assert_eq!(count, jobs.len());
    // Two jobs whose names differ by `./` alone, of which one has no name of its own.
    let [absolute, other] =
        ["clean.toml", "shank.toml"].map(|name| place(name).display().to_string());
    let below = place(&format!(".{absolute}"));
    std::fs::create_dir_all(below.parent().expect("a folder")).expect("folders");
    std::fs::write(&below, "").expect("written");
    let twice = [absolute.clone(), format!("./{absolute}"), "./a-b.toml".to_owned(), other];
    script("integrations/verify-jobs both", folder.path(), &twice);
    let count = std::fs::read_dir(place("both")).expect("the findings").count();
    assert_eq!(count, 3, "the empty job has no findings, and overwrites none");
    let dash = script("integrations/verify-jobs -", folder.path(), &["clean.toml".to_owned()]);
    assert_eq!(dash.status.code(), Some(0), "{}", stderr(&dash));
    assert!(place("-/clean.toml.sarif").exists());
    // A link where findings go is replaced, and one instead of the folder is refused.
    std::fs::write(place("victim"), "kept").expect("written");
    let findings = place("out/a-b.toml.sarif");
    std::fs::remove_file(&findings).expect("removed");
    symlink("../victim", &findings).expect("a link");
    let again = script("integrations/verify-jobs out", folder.path(), &["a-b.toml".to_owned()]);
    assert_eq!(again.status.code(), Some(1), "{}", stderr(&again));
    assert_eq!(std::fs::read_to_string(place("victim")).expect("read"), "kept");
    assert!(!findings.is_symlink());
    let elsewhere = tempfile::tempdir().expect("a folder");
    symlink(elsewhere.path(), place("linked")).expect("a link");
    let linked = script("integrations/verify-jobs linked", folder.path(), &["a-b.toml".to_owned()]);
    assert_eq!(linked.status.code(), Some(2), "{}", stderr(&linked));
    let below =
        script("integrations/verify-jobs linked/out", folder.path(), &["a-b.toml".to_owned()]);
    assert_eq!(below.status.code(), Some(2), "{}", stderr(&below));
    // A shell strips line breaks, and this link leads to another one.
    std::fs::create_dir(place("d")).expect("a folder");
    symlink("d\n", place("to_d")).expect("a link");
    symlink(elsewhere.path(), place("d\n")).expect("a link");
    for findings in ["to_d", "new/../../d"] {
        let command = format!("integrations/verify-jobs {findings}");
        let outside = script(&command, folder.path(), &["a-b.toml".to_owned()]);
        assert_eq!(outside.status.code(), Some(2), "{}", stderr(&outside));
        assert!(!place("new").exists());
    }
    assert_eq!(std::fs::read_dir(elsewhere.path()).expect("a folder").count(), 0);
    // Findings that a repository brings along are removed where those of the run go, and nowhere else.
    std::fs::write(elsewhere.path().join("kept.sarif"), "").expect("written");
    std::fs::write(place("out/brought.sarif"), "").expect("written");
    for (findings, status) in [("linked/", 2), ("out", 0)] {
        let mut clearing = Command::new(root().join("integrations/verify-jobs"));
        clearing.args([findings, "clean.toml"]).current_dir(folder.path());
        clearing.env("TOUCHOFF", env!("CARGO_BIN_EXE_touchoff")).env("TOUCHOFF_CLEAR", "1");
        // A shell that looks for folders elsewhere, too.
        clearing.env("CDPATH", "/");
        let output = clearing.output().expect("bash");
        assert_eq!(output.status.code(), Some(status), "{findings}: {}", stderr(&output));
    }
    assert!(elsewhere.path().join("kept.sarif").exists() && !place("out/brought.sarif").exists());
    // A message does not tell what there is elsewhere.
    std::fs::write(elsewhere.path().join("mill.tool"), "").expect("written");
    let named = elsewhere.path().join("mill").display().to_string();
    std::fs::write(place("hint.toml"), text.replace("mill.tool", &named)).expect("written");
    let hinted = script("integrations/verify-jobs out", folder.path(), &["hint.toml".to_owned()]);
    assert_eq!(hinted.status.code(), Some(2), "{}", stderr(&hinted));
    assert!(!stderr(&hinted).contains("mill.tool"), "{}", stderr(&hinted));
    // A job writes nothing: not over what another one reads, whatever its ending.
    let victim = std::fs::read(place("clamp.stl")).expect("a mesh");
    let clean = std::fs::read_to_string(place("clean.toml")).expect("a job");
    let stock = "[stock]\nbox = [[0, 0, 0], [60, 40, 41]]\nspacing = 4\noutput = \"clamp.stl\"\n";
    std::fs::write(place("over.toml"), format!("{clean}\n{stock}")).expect("written");
    script("integrations/verify-jobs out", folder.path(), &["over.toml".to_owned()]);
    assert_eq!(std::fs::read(place("clamp.stl")).expect("a mesh"), victim);
    // Limits are numbers, and no expressions.
    let mut limited = Command::new(root().join("integrations/verify-jobs"));
    limited.args(["out", "clean.toml"]).current_dir(folder.path());
    let status = limited.env("TOUCHOFF_MAX_MEMORY", "x[$(touch broken)]").status();
    assert!(status.expect("bash").code() == Some(2) && !place("broken").exists());
    // A program that is not there, or is killed, is no verdict.
    let mut missing = Command::new(root().join("integrations/verify-jobs"));
    missing.args(["out", "clean.toml"]).current_dir(folder.path()).env("TOUCHOFF", "./none");
    assert_eq!(missing.status().expect("bash").code(), Some(2));
}

/// Text of inputs reaches the shell of the action as variables alone.
#[test]
fn the_action_interpolates_no_input_into_a_shell() {
    let text = std::fs::read_to_string(root().join("integrations/github/action.yml"));
    let action = text.expect("an action");
    let mut in_script = false;
    for line in action.lines() {
        let key = line.trim_start().trim_start_matches("- ");
        in_script = key.starts_with("run:") || (in_script && line.starts_with("        "));
        assert!(!in_script || !line.contains("${{"), "{line}");
    }
    assert!(action.contains("bash \"$ACTION/../verify-jobs\" \"$SARIF\" $JOBS"));
}
