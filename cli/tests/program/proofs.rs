//! Certificates of the library, stages of a tool, and exit statuses by severity.

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
    let mut tools: Vec<PathBuf> = entries.map(|entry| entry.path()).collect();
    tools.retain(|path| path.is_file());
    tools.sort();
    tools
}

/// After a change of the proofs, run `INSTA_UPDATE=always cargo test -p touchoff-cli --test program` and read the
/// difference.
#[test]
fn certificates_of_the_library() {
    let output = touchoff(&["check", "--verbose"], &library());
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let shown = String::from_utf8(output.stdout).expect("text");
    let folder = format!("{}/", workspace().join("tools-library/tools").display());
    insta::with_settings!({ omit_expression => true }, {
        insta::assert_snapshot!("certificates", shown.replace(&folder, ""));
    });
}

/// Every stage of a tool can be printed.
#[test]
fn stages_of_a_tool() {
    let ball = [workspace().join("tools-library/tools/ball.tool")];
    for (stage, has) in [
        ("ast", "HalfPlane Ball Some("),
        ("model", "unit mm"),
        ("regions", "region ball as ball"),
        ("plan", "digraph"),
        ("rust", "Evaluators for Ball"),
    ] {
        let output = touchoff(&["expand", "--stage", stage], &ball);
        let text = String::from_utf8_lossy(&output.stdout);
        assert!(output.status.success() && text.contains(has), "{stage}: {text}");
    }
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

/// Five lines per tool suffice its author; `--verbose` changes nothing in JSON.
#[test]
fn the_summary_of_a_tool_is_short() {
    let output = touchoff(&["check"], &library()[..4]);
    let text = String::from_utf8_lossy(&output.stdout);
    assert_eq!(text.lines().count(), 4 * 5, "{text}");
    assert!(text.contains("borders: no jumps"), "{text}");
    let json =
        |more: &[&str]| touchoff(&[&["check", "--json"], more].concat(), &library()[..4]).stdout;
    assert_eq!(json(&[]), json(&["--verbose"]));
}
