//! The findings, the worst first, and pictures of the worst.

use super::super::Content;
use super::{picture, plain};
use maud::{Markup, html};
use touchoff_verify::job::Severity;

pub(super) fn section(content: &Content<'_>) -> Markup {
    let lines = |[first, last]: [usize; 2]| {
        if first == last { first.to_string() } else { format!("{first} to {last}") }
    };
    html! {
        section {
            h2 { "Findings" }
            @if content.checked.findings().is_empty() {
                p { "None." }
            } @else {
                table.findings {
                    thead { tr { th { "#" } th { "severity" } th { "kind" } th { "line" } th { "lines" } th { "finding" } th {} } }
                    tbody {
                        @for (index, finding) in content.checked.findings().iter().enumerate() {
                            @let (class, severity) = severity(finding.severity);
                            tr id={ "finding-" (index + 1) } {
                                td.number { (index + 1) }
                                td { span.badge.(class) { (severity) } }
                                td.name { (finding.rule) }
                                td.number { (finding.line) }
                                td.number { (lines(finding.lines)) }
                                td.text { (plain(&finding.text)) }
                                td {
                                    @if content.has_place[index] {
                                        button.show type="button" data-finding=(index) { "show" }
                                    }
                                }
                            }
                        }
                    }
                }
            }
            @if !content.close_ups.is_empty() {
                h3 { "The worst in pictures" }
                p.note { "The tool is drawn as glass, orange where it cuts. What stands in front of the place is cut away. Findings near a worse one are left out." }
                div.close-ups {
                    @for (index, close_up) in &content.close_ups {
                        figure {
                            a href={ "#finding-" (index + 1) } { (picture(close_up)) }
                            figcaption { (plain(&content.checked.findings()[*index].text)) }
                        }
                    }
                }
            }
        }
    }
}

/// Returns the class and the name of a severity.
fn severity(severity: Severity) -> (&'static str, &'static str) {
    match severity {
        Severity::Violation => ("bad", "violation"),
        Severity::Undecided => ("open", "undecided"),
        Severity::Remark => ("remark", "warning"),
    }
}
