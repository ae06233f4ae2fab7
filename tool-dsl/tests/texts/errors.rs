//! Tests of every code of a diagnostic: it is unique, explained, caused by an example text, and listed in
//! `docs/errors.md`.
//!
//! After a change: run `UPDATE_ERRORS=1 cargo test -p touchoff-dsl --test texts errors`, and review the
//! difference.

use std::collections::BTreeSet;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use touchoff_dsl::diagnostic::{Diagnostic, Entry, Example, FAMILIES, Severity, entries, entry};
use touchoff_dsl::emit::emit;
use touchoff_dsl::source::Source;
use touchoff_dsl::{Compiled, compile};

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/errors")
}

/// Compiles the example of a code.
fn compiled(code: &str) -> Compiled {
    let name = format!("{code}.tool");
    compile(&Source::read_as(&name, &folder().join(&name)).expect("an example can be read"))
}

fn with_examples() -> impl Iterator<Item = &'static Entry> {
    entries().filter(|entry| matches!(entry.example, Example::Text(_)))
}

#[test]
fn codes_are_unique_and_ordered_and_of_their_family() {
    let codes: Vec<&str> = entries().map(|entry| entry.code).collect();
    assert!(codes.is_sorted_by(|a, b| a < b), "{codes:?}");
    for family in FAMILIES {
        for Entry { code, .. } in family.entries {
            assert!(code.starts_with(family.prefix) && code.len() == 5, "{code}");
        }
    }
}

/// Whatever a warning says, a tool that compiles has an evaluator.
#[test]
fn code_is_written_for_every_example_that_compiles() {
    let tools = with_examples().filter_map(|entry| compiled(entry.code).into_tool());
    let written = tools.map(|tool| emit(&tool).to_string());
    assert!(written.filter(|code| code.contains("ToolInfo")).count() > 5);
}

#[test]
fn entries_are_written_for_people() {
    for entry in entries() {
        let code = entry.code;
        assert!(!entry.title.is_empty() && !entry.title.ends_with('.'), "{code}");
        assert!(entry.explanation.ends_with('.'), "{code}");
        assert!(entry.explanation.split(". ").count() <= 3, "{code}");
        assert!(entry.remedies().all(|remedy| !remedy.is_empty()), "{code}");
        assert!(!matches!(entry.example, Example::Without("")), "{code}");
    }
}

#[test]
fn each_example_causes_its_code() {
    let mut wrong = String::new();
    for entry in with_examples() {
        let compiled = compiled(entry.code);
        let found = compiled.diagnostics().iter().find(|found| found.code() == entry.code);
        match found {
            Some(found) => assert_eq!(found.severity, entry.severity, "{}", entry.code),
            None => {
                let said: Vec<String> = compiled.diagnostics().iter().map(brief).collect();
                writeln!(wrong, "{}: {said:?}", entry.code).expect("a string");
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong}");
}

fn brief(diagnostic: &Diagnostic) -> String {
    format!("{} {}", diagnostic.code(), diagnostic.message())
}

/// The files of examples are those of the table.
#[test]
fn each_file_is_an_example() {
    for file in std::fs::read_dir(folder()).expect("the folder of examples") {
        let path = file.expect("an entry").path();
        let code = path.file_stem().expect("a name").to_string_lossy().into_owned();
        let entry = entry(&code).unwrap_or_else(|| panic!("no code is called {code}"));
        assert!(matches!(entry.example, Example::Text(_)), "{code}");
    }
}

/// Few codes have no example, each for a reason stated in the table.
#[test]
fn few_codes_have_no_example() {
    let without: BTreeSet<&str> = entries()
        .filter(|entry| matches!(entry.example, Example::Without(_)))
        .map(|entry| entry.code)
        .collect();
    assert!(without.len() <= 25, "{without:?}");
}

/// Generates `docs/errors.md`.
fn page() -> String {
    let mut page = String::from(
        "# Errors and warnings

The compiler of `.tool` files says what is wrong by these codes. A code keeps its meaning; the words of a message may
change. `touchoff explain T0201` prints a section of this page. It is generated:
`UPDATE_ERRORS=1 cargo test -p touchoff-dsl --test texts errors`.
",
    );
    for family in FAMILIES {
        write!(page, "\n## {}\n", family.title).expect("a string");
        for entry in family.entries {
            section(&mut page, entry).expect("a string");
        }
    }
    page
}

fn section(page: &mut String, entry: &Entry) -> std::fmt::Result {
    let kind = match entry.severity {
        Severity::Error => "",
        Severity::Warning => " (warning)",
        Severity::Note => " (note)",
    };
    write!(page, "\n### {}: {}{kind}\n\n{}\n\n", entry.code, entry.title, entry.explanation)?;
    match entry.remedies().collect::<Vec<_>>().as_slice() {
        [one] => writeln!(page, "Remedy: {one}.")?,
        many => {
            writeln!(page, "Remedy, as the case may be:\n")?;
            for remedy in many {
                writeln!(page, "- {remedy}")?;
            }
        }
    }
    match entry.example {
        Example::Without(reason) => writeln!(page, "\nNo example: {reason}."),
        Example::Text(text) => {
            let compiled = compiled(entry.code);
            let found = compiled.diagnostics().iter().find(|found| found.code() == entry.code);
            let shown = found.map_or(String::new(), |found| found.render(&compiled.sources, false));
            writeln!(page, "\n```text\n{}\n```\n\n```text\n{shown}\n```", visible(text).trim_end())
        }
    }
}

/// Replaces each invisible character of a text with an escape.
fn visible(text: &str) -> String {
    let lines = text.lines().map(|line| touchoff_dsl::diagnostic::escaped(line).into_owned());
    lines.collect::<Vec<_>>().join("\n")
}

#[test]
fn the_page_of_errors_is_generated() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/errors.md");
    let page = page();
    if std::env::var_os("UPDATE_ERRORS").is_some() {
        std::fs::write(&path, &page).expect("the page can be written");
    }
    let kept = std::fs::read_to_string(&path).unwrap_or_default();
    assert!(kept == page, "docs/errors.md is stale: UPDATE_ERRORS=1 writes it anew");
}
