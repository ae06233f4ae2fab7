//! Findings in SARIF 2.1.0, the format in which services of continuous integration take the results of analyses.
//!
//! Own types: the crate `serde-sarif` generates those of the whole standard while it is built, and findings need these.

use super::report::JobReport;
use super::{JobFinding, Severity, Verdict};
use serde::Serialize;

#[derive(Serialize)]
pub(super) struct Log {
    #[serde(rename = "$schema")]
    schema: &'static str,
    version: &'static str,
    runs: [Run; 1],
}

#[derive(Serialize)]
struct Run {
    tool: Tool,
    invocations: [Invocation; 1],
    results: Vec<Finding>,
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct Invocation {
    /// Set if there is a verdict.
    execution_successful: bool,
}

#[derive(Serialize)]
struct Tool {
    driver: Driver,
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct Driver {
    name: &'static str,
    version: &'static str,
    rules: Vec<Rule>,
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct Rule {
    id: &'static str,
    short_description: Text,
}

#[derive(Serialize)]
struct Text {
    text: String,
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct Finding {
    rule_id: &'static str,
    level: &'static str,
    message: Text,
    locations: [Location; 1],
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct Location {
    physical_location: PhysicalLocation,
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct PhysicalLocation {
    artifact_location: Artifact,
    region: Region,
}

#[derive(Serialize)]
struct Artifact {
    uri: String,
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct Region {
    start_line: usize,
    end_line: usize,
}

/// The rules, with what each finds.
const RULES: [(&str, &str); 10] = [
    ("deep", "A surface of the tool is deeper in the part, a fixture or the machine than allowed."),
    ("near", "A surface of the tool comes nearer than its margin."),
    ("inside", "The tool, or a piece of it, is inside the material."),
    ("spindle", "A feed motion has a spindle that does not turn, or turns the wrong way round."),
    ("length", "A feed motion has the length offset of another tool."),
    ("limit", "An axis of the machine goes beyond its limit."),
    ("singular", "A rotary axis turns far while the tool axis hardly moves."),
    (
        "stock",
        "A surface that does not cut, or a rapid motion, touches material that is still there.",
    ),
    ("undecided", "It is not decided whether a surface exceeds its limit."),
    ("ambiguous", "The rotation of a motion is ambiguous, so that only its end was checked."),
];

/// Returns the findings of a job as a SARIF log.
pub(super) fn log(report: &JobReport<'_>) -> Log {
    let uri = uri(report.job.program.name());
    let result = |finding: &JobFinding| Finding {
        rule_id: finding.rule,
        level: if finding.severity == Severity::Violation { "error" } else { "warning" },
        message: Text { text: finding.text.clone() },
        locations: [Location {
            physical_location: PhysicalLocation {
                artifact_location: Artifact { uri: uri.clone() },
                // Subprograms may stand before the blocks that call them.
                region: Region {
                    start_line: finding.lines[0].min(finding.lines[1]),
                    end_line: finding.lines[0].max(finding.lines[1]),
                },
            },
        }],
    };
    let results = report.findings().iter().map(result).collect();
    let rules =
        RULES.map(|(id, text)| Rule { id, short_description: Text { text: text.to_owned() } });
    let driver =
        Driver { name: "touchoff", version: env!("CARGO_PKG_VERSION"), rules: rules.into() };
    Log {
        schema: "https://json.schemastore.org/sarif-2.1.0.json",
        version: "2.1.0",
        runs: [Run {
            tool: Tool { driver },
            invocations: [Invocation { execution_successful: report.verdict() != Verdict::None }],
            results,
        }],
    }
}

/// Returns a relative URI reference for a path, with all but unreserved characters and `/` percent-encoded (RFC 3986).
fn uri(path: &str) -> String {
    let mut uri = String::new();
    for byte in path.replace('\\', "/").bytes() {
        match byte {
            b'A'..=b'Z' | b'a'..=b'z' | b'0'..=b'9' | b'-' | b'.' | b'_' | b'~' | b'/' => {
                uri.push(char::from(byte));
            }
            _ => uri.push_str(&format!("%{byte:02X}")),
        }
    }
    uri
}
