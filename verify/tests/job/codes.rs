//! Tests of the table of codes: each is unique, in the order of its family, explained, and listed in `docs/refusals.md`.
//!
//! After a change: run `UPDATE_ERRORS=1 cargo test -p touchoff-verify --test job codes`, and review the difference.

use std::fmt::Write;
use std::path::Path;
use touchoff_verify::codes::{Entry, FAMILIES, entries, entry};

#[test]
fn codes_are_unique_and_ordered_and_of_their_family() {
    let codes: Vec<&str> = entries().map(|entry| entry.code).collect();
    assert!(codes.is_sorted_by(|a, b| a < b), "{codes:?}");
    for family in FAMILIES {
        assert!(family.entries().count() > 0, "{}", family.prefix);
        for (number, entry) in (1..).zip(family.entries()) {
            assert_eq!(entry.code, format!("{}{number:02}", family.prefix));
        }
    }
    assert_eq!(entry("P0101").map(|entry| entry.code), Some("P0101"));
    assert_eq!(entry("P0100"), None);
}

#[test]
fn entries_are_written_for_people() {
    for entry in entries() {
        let (code, title, explanation) = (entry.code, entry.title(), entry.explanation());
        assert!(!title.is_empty() && !title.contains(". "), "{code}: {title}");
        assert!(explanation.is_empty() || explanation.ends_with('.'), "{code}: {explanation}");
        let said = format!("{} {}", entry.message(), entry.remedy());
        assert!(!said.trim().is_empty() || entry.message().is_empty(), "{code}");
        let opened = said.matches('{').count();
        assert!(opened == said.matches('}').count() && opened <= 1, "{code}: {said}");
    }
}

/// Every refusal has a remedy, but for messages of other libraries and those that name it among their data.
#[test]
fn what_is_refused_has_a_remedy() {
    let is_refusal = |entry: &&Entry| entry.severity() == "error" && !entry.message().is_empty();
    let without: Vec<String> = entries()
        .filter(is_refusal)
        .filter(|entry| entry.remedy().is_empty())
        .map(|entry| format!("{} {}", entry.code, entry.message()))
        .collect();
    assert!(without.len() <= 20, "{without:#?}");
}

/// Generates `docs/refusals.md`.
fn page() -> String {
    let mut page = String::from(
        "# Refusals, findings and gaps

A program, a machine, a control or a job that is refused is refused with one of these codes; a finding has one, and what a check
leaves open. A code keeps its meaning; the words of a message may change. `touchoff explain P0101` prints a section of this page, and
[errors.md](errors.md) has the codes of tools. Words in capitals stand for data. It is generated:
`UPDATE_ERRORS=1 cargo test -p touchoff-verify --test job codes`.
",
    );
    for family in FAMILIES {
        write!(page, "\n## {}\n", family.title).expect("a string");
        for entry in family.entries() {
            section(&mut page, entry).expect("a string");
        }
    }
    page
}

fn section(page: &mut String, entry: &Entry) -> std::fmt::Result {
    writeln!(page, "\n### {}: {}", entry.code, entry.title())?;
    let (message, remedy) = (entry.message(), entry.remedy());
    match (message.is_empty(), remedy.is_empty()) {
        (true, _) => {}
        (false, true) => writeln!(page, "\n```text\n{message}\n```")?,
        (false, false) => writeln!(page, "\n```text\n{message}: {remedy}\n```")?,
    }
    match entry.explanation() {
        explanation if explanation.is_empty() => Ok(()),
        explanation => writeln!(page, "\n{explanation}"),
    }
}

#[test]
fn the_page_of_refusals_is_generated() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/refusals.md");
    let page = page();
    if std::env::var_os("UPDATE_ERRORS").is_some() {
        std::fs::write(&path, &page).expect("the page can be written");
    }
    let kept = std::fs::read_to_string(&path).unwrap_or_default();
    assert!(kept == page, "docs/refusals.md is stale: UPDATE_ERRORS=1 writes it anew");
}
