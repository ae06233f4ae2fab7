//! What is kept of the library's way to Rust, and how severe a file's faults are.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn touchoff(arguments: &[&str], files: &[PathBuf]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_touchoff"));
    command.args(arguments).args(files).output().expect("the program runs")
}

fn workspace() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("the program lies in the workspace")
}

fn library() -> Vec<PathBuf> {
    let tools = workspace().join("tools-library/tools");
    let entries =
        std::fs::read_dir(tools).expect("the library").map(|entry| entry.expect("a file"));
    entries.map(|entry| entry.path()).filter(|path| path.is_file()).collect()
}

/// After a change of the compiler: `touchoff expand --stages tests/stages tools-library/tools/*.tool`,
/// and read the difference.
#[test]
fn the_stages_of_the_library_are_what_is_kept() {
    let kept = workspace().join("tests/stages");
    let kept = kept.to_str().expect("a folder's name");
    let output = touchoff(&["expand", "--check", kept], &library());
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}

#[test]
fn what_is_stale_is_named() {
    let bench = tempfile::tempdir().expect("a folder");
    let folder = bench.path().to_str().expect("a folder's name");
    let ball = [workspace().join("tools-library/tools/ball.tool")];
    assert!(touchoff(&["expand", "--stages", folder], &ball).status.success());
    assert!(touchoff(&["expand", "--check", folder], &ball).status.success());
    let plan = bench.path().join("ball/plan.dot");
    let text = std::fs::read_to_string(&plan).expect("the plan");
    std::fs::write(&plan, text.replacen("yes", "no", 1)).expect("the plan");
    std::fs::create_dir(bench.path().join("gone")).expect("a folder");
    let output = touchoff(&["expand", "--check", folder], &ball);
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1));
    assert!(said.contains("plan.dot: stale") && said.contains("gone: stale"), "{said}");
    assert!(said.contains("2 of what is kept") && !said.contains("model.txt"), "{said}");
}

#[test]
fn the_exit_status_is_as_severe_as_what_is_wrong() {
    let bench = tempfile::tempdir().expect("a folder");
    let file = |name: &str, text: &str| {
        let path = bench.path().join(name);
        std::fs::write(&path, text).expect("a file");
        path
    };
    let of = |core: &str| {
        format!(
            "tool Core {{ units mm; curve r = hypot(d, z - 3);
               region core where r <= 1 {{ depth: {core}; direction: away from (0, 3); }}
               region shell where 1 <= r <= 3 {{ depth: 3 - r; direction: away from (0, 3); }}
             }}"
        )
    };
    let good = file("good.tool", &of("3 - r"));
    let warned = file("warned.tool", &of("3 - r").replace("curve", "let idle = 3; curve"));
    let jumping = file("jumping.tool", &of("3.5 - r"));
    let status = |files: &[&PathBuf]| {
        let files: Vec<PathBuf> = files.iter().map(|file| (*file).clone()).collect();
        touchoff(&["check"], &files).status.code()
    };
    assert_eq!(status(&[&good]), Some(0));
    assert_eq!(status(&[&good, &warned]), Some(3));
    assert_eq!(status(&[&warned, &jumping]), Some(1));
    let said = touchoff(&["check"], &[jumping]);
    let said = String::from_utf8_lossy(&said.stderr);
    assert!(said.contains("depth jumps from 2.5 to 2 at ("), "{said}");
}
