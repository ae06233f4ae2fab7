//! `touchoff explain` from the user's side.

use super::bench::{stderr, stdout, touchoff};
use std::process::Output;
use touchoff_dsl::diagnostic::entries;
use touchoff_verify::codes;

fn explain(arguments: &[&str]) -> Output {
    touchoff(&[&["explain"], arguments].concat())
}

#[test]
fn a_code_is_explained_with_remedy_and_example() {
    for code in ["T0203", "t0203"] {
        let output = explain(&[code]);
        assert!(output.status.success(), "{}", stderr(&output));
        let said = stdout(&output);
        assert!(said.starts_with("error[T0203]: name used above its definition\n"), "{said}");
        assert!(said.contains("Remedy: move the definition above this use."), "{said}");
        assert!(said.contains("Example:\n\ntool Ball {\n    units mm;\n"), "{said}");
    }
    let said = stdout(&explain(&["T0201"]));
    assert!(said.contains("- did you mean `SUGGESTION`?\n"), "{said}");
    let said = stdout(&explain(&["p0402"]));
    let expected = "error[P0402]: a position in the plane that only the machine knows\n\n\
                    Message: cutter compensation needs a known position in its plane\n\n\
                    Remedy: write both coordinates in G90 before G41 or G42.\n";
    assert_eq!(said, expected);
    let said = stdout(&explain(&["T0692"]));
    assert!(said.contains("No example: it is a bug in the compiler."), "{said}");
}

#[test]
fn all_codes_are_listed_with_titles() {
    let said = stdout(&explain(&[]));
    let of_tools = entries().map(|entry| format!("  {}  {}", entry.code, entry.title));
    let of_jobs = codes::entries().map(|entry| format!("  {}  {}", entry.code, entry.title()));
    for row in of_tools.chain(of_jobs) {
        assert!(said.contains(&row), "{row}");
    }
}

#[test]
fn an_unknown_code_names_the_nearest() {
    let output = explain(&["T0299"]);
    assert_eq!(output.status.code(), Some(1));
    let said = stderr(&output);
    assert!(
        said.starts_with(
            "error: no error, warning, finding or gap has the code `T0299`: did you mean `T0"
        ),
        "{said}"
    );
    assert!(output.stdout.is_empty());
    let said = stderr(&explain(&["P0199"]));
    assert!(said.contains("did you mean `P0"), "{said}");
    let said = stderr(&explain(&["spindle"]));
    assert!(said.contains("`touchoff explain` lists all codes"), "{said}");
}

#[test]
fn rows_of_json_hold_the_same() {
    let said = stdout(&explain(&["--json"]));
    assert_eq!(said.lines().count(), entries().count() + codes::entries().count());
    let row: serde_json::Value =
        serde_json::from_slice(&explain(&["T0203", "--json"]).stdout).expect("one object");
    assert_eq!(row["code"], "T0203");
    assert_eq!(row["remedies"][0], "move the definition above this use");
}
