//! Mistakes in tools as seen by a person who builds a program with them: the output of rustc, in a file beside each
//! case. One mistake gives one error, though the tool is used; each error states a remedy, and the terminal shows
//! the same.
//!
//! After a change of the wording, run `TRYBUILD=overwrite cargo test -p touchoff-macros --test mistakes` and read the
//! difference.

use std::path::{Path, PathBuf};
use touchoff_dsl::compile;
use touchoff_dsl::diagnostic::Severity;
use touchoff_dsl::source::Source;

/// Returns the folder in which trybuild builds its cases, to which `include_tool!` is relative.
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

/// Returns the cases: each its program, and the output of rustc for it.
fn cases() -> Vec<(PathBuf, String)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/compile_fail");
    let files = std::fs::read_dir(folder).expect("the folder of cases");
    let programs = files.map(|entry| entry.expect("the folder of cases").path());
    let programs = programs.filter(|path| path.extension().is_some_and(|end| end == "rs"));
    programs
        .map(|path| {
            let said = std::fs::read_to_string(path.with_extension("stderr"));
            (path, said.expect("each case has its expected output"))
        })
        .collect()
}

/// Returns the tool that a case writes or includes, as a text of its own.
fn tool(program: &Path) -> Option<Source> {
    let code = std::fs::read_to_string(program).expect("a case can be read");
    if let Some((_, inline)) = code.split_once("touchoff::tool! {") {
        let text = inline.split("\n}").next()?;
        return Some(Source::new("tool!", text).with_path(program));
    }
    // With params given, or another name, it is no text alone.
    let name = code.split_once("include_tool!(\"")?.1.split_once("\");")?.0;
    let file = program.with_file_name(Path::new(name).file_name()?);
    Source::read_as(name, &file).ok()
}

#[test]
fn mistakes_in_tools() {
    let cases = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/compile_fail");
    place_tools(&cases);
    trybuild::TestCases::new().compile_fail("tests/compile_fail/*.rs");
}

/// A tool with warnings. Only a build that denies warnings has errors, as in `compile_fail/denied_warning*.rs`.
#[expect(deprecated, reason = "the compiler's warnings are shown as notes of deprecated items")]
mod warned {
    touchoff::tool! {
        tool Pin {
            units mm;
            curve side = 3 - d;
            curve low = z;
            curve high = 40 - z;
            let idle = 3;
            region low where 0 <= low <= min(side, high) { depth: low; }
            region high where 0 <= high <= min(side, low) { depth: high; }
            region side as side cutting where 0 <= side <= min(low, high) {
                depth: side;
                direction: (0, 1);
                niceness: depth;
            }
        }
    }
}

/// Checks that a tool with warnings is compiled.
#[test]
fn warnings_do_not_stop_a_build() {
    assert_eq!(touchoff::Tool::info(&warned::Pin).name, "Pin");
}

#[test]
fn one_mistake_gives_one_error() {
    let cases = cases();
    for (program, said) in &cases {
        let errors = said.lines().filter(|line| line.starts_with("error")).count();
        let several = program.ends_with("several_mistakes.rs");
        assert_eq!(errors, if several { 8 } else { 1 }, "{}", program.display());
    }
    assert!(cases.len() >= 90);
}

#[test]
fn the_terminal_says_the_same() {
    let mut compared = 0;
    for (program, said) in cases() {
        let Some(source) = tool(&program) else { continue };
        let compiled = compile(&source);
        let lines: Vec<&str> = said.lines().map(str::trim).collect();
        let denied =
            program.file_name().is_some_and(|name| name.display().to_string().contains("denied"));
        let wanted = if denied { Severity::Warning } else { Severity::Error };
        let wanted = compiled.diagnostics().iter().filter(|report| report.severity == wanted);
        for report in wanted {
            let place = program.display();
            let title = format!("{} [{}]", report.message(), report.code());
            let help = report.help();
            let label = report.secondary.as_ref().map(|(_, label)| label.as_str());
            for text in [Some(title.as_str()), Some(&help), label].into_iter().flatten() {
                assert!(said.contains(text), "{place}: {text}");
            }
            let rendered = report.render(&compiled.sources, false);
            let file = source.name != "tool!";
            // The build prints the severity and the code in its own way.
            for line in rendered.lines().skip(1).map(str::trim).filter(|_| file) {
                assert!(lines.contains(&line), "{place}: {line}");
            }
        }
        compared += 1;
    }
    assert!(compared >= 85, "{compared}");
}
