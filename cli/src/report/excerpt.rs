//! The text of a program around the lines of its findings.

use std::path::Path;
use touchoff::Escaped;
use touchoff_verify::job::{FindingDetail, JobFinding};
use touchoff_verify::program::lines;

/// Number of lines before and after that of the worst motion.
const AROUND: usize = 3;
/// Number of characters of a line that are shown.
const MAX_CHARACTERS: usize = 120;

/// The role of a line in a finding.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum LineRole {
    /// The line of the worst motion.
    Worst,
    /// Within the lines of the finding.
    Within,
    /// Before or after them.
    Around,
}

/// A line of a program.
pub(super) struct ExcerptLine {
    pub(super) number: usize,
    /// Its text, without characters that a display interprets, and shortened.
    pub(super) text: String,
    pub(super) role: LineRole,
}

/// Returns the lines of a program around each finding; none if the file can no longer be read as text.
pub(super) fn excerpts(program: &Path, findings: &[JobFinding]) -> Vec<Vec<ExcerptLine>> {
    let text = std::fs::read_to_string(program).unwrap_or_default();
    let text: Vec<&str> = lines(&text).map(|(_, line)| line).collect();
    findings.iter().map(|finding| excerpt(&text, finding)).collect()
}

/// Returns the lines around a finding.
fn excerpt(text: &[&str], finding: &JobFinding) -> Vec<ExcerptLine> {
    let ranges = match &finding.detail {
        FindingDetail::Surface { groups, .. } => {
            groups.iter().map(|group| [group.first.line, group.last.line]).collect()
        }
        FindingDetail::Machine(_) | FindingDetail::Stock(_) => vec![finding.lines],
    };
    // A subprogram may stand before the block that calls it.
    let is_within =
        |line| ranges.iter().any(|[one, end]| (*one.min(end)..=*one.max(end)).contains(&line));
    let shown = finding.line.saturating_sub(AROUND).max(1)..=finding.line + AROUND;
    let lines = shown.filter_map(|number| {
        let role = if number == finding.line {
            LineRole::Worst
        } else if is_within(number) {
            LineRole::Within
        } else {
            LineRole::Around
        };
        Some(ExcerptLine { number, text: shortened(text.get(number - 1)?), role })
    });
    lines.collect()
}

/// Returns a line as it is shown: tabs as blanks, and no more than [`MAX_CHARACTERS`].
fn shortened(line: &str) -> String {
    let mut characters = line.chars();
    let mut shown: String = characters.by_ref().take(MAX_CHARACTERS).collect();
    if characters.next().is_some() {
        shown.push('…');
    }
    Escaped(&shown.replace('\t', "    ")).to_string()
}
