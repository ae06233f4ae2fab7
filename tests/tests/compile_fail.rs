//! Mistakes in tools as the person sees them who builds a program with them: what rustc prints, as
//! a file beside each case. One mistake gives one error, though the tool is used.
//!
//! After a change of the wording: `TRYBUILD=overwrite cargo test -p touchoff-tests --test
//! compile_fail`, and read the difference.

use std::path::{Path, PathBuf};

/// Where trybuild builds its cases: what `include_tool!` is relative to.
fn package() -> PathBuf {
    let own = std::env::current_exe().expect("a test knows its own place");
    // target/debug/deps/compile_fail-…
    let target = own.ancestors().nth(3).expect("a test lies in cargo's target folder");
    target.join("tests/trybuild").join(env!("CARGO_PKG_NAME"))
}

/// Puts the cases' tool files where `include_tool!("mistakes/….tool")` finds them.
fn place_tools(cases: &Path) {
    let mistakes = package().join("mistakes");
    std::fs::create_dir_all(&mistakes).expect("cargo's target folder can be written to");
    for entry in std::fs::read_dir(cases).expect("the folder of cases") {
        let path = entry.expect("the folder of cases").path();
        if path.extension().is_some_and(|extension| extension == "tool") {
            let name = path.file_name().expect("a file has a name");
            std::fs::copy(&path, mistakes.join(name)).expect("a case's tool can be copied");
        }
    }
}

/// rustc's errors in a case's expected output.
fn errors(stderr: &Path) -> usize {
    let text = std::fs::read_to_string(stderr).expect("each case has its expected output");
    text.lines().filter(|line| line.starts_with("error")).count()
}

#[test]
fn mistakes_in_tools() {
    let cases = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/compile_fail");
    place_tools(&cases);
    trybuild::TestCases::new().compile_fail("tests/compile_fail/*.rs");
}

#[test]
fn one_mistake_gives_one_error() {
    let cases = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/compile_fail");
    let mut seen = 0;
    for entry in std::fs::read_dir(cases).expect("the folder of cases") {
        let path = entry.expect("the folder of cases").path();
        if path.extension().is_some_and(|extension| extension == "stderr") {
            assert_eq!(errors(&path), 1, "{}", path.display());
            seen += 1;
        }
    }
    assert!(seen >= 15);
}
