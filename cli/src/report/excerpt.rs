//! The text of a program around the lines of its findings.

use crate::output::file_name;
use touchoff::Escaped;
use touchoff_verify::gcode::SubprogramLine;
use touchoff_verify::job::{FindingDetail, JobFile, JobFinding};
use touchoff_verify::program::{lines, read_text};

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

/// Consecutive lines of a file.
pub(super) struct Excerpt {
    /// The file of subprograms; `None` for the program.
    pub(super) file: Option<String>,
    pub(super) lines: Vec<ExcerptLine>,
}

/// Returns the lines of the program around each finding, and those of the file of subprograms that has its worst motion. A file that can no longer
/// be read as text has none.
pub(super) fn excerpts(job: &JobFile, findings: &[JobFinding]) -> Vec<Vec<Excerpt>> {
    let texts: Vec<String> = [&job.program]
        .into_iter()
        .chain(&job.subprograms)
        .map(|file| read_text(file).unwrap_or_default())
        .collect();
    let texts: Vec<Vec<&str>> =
        texts.iter().map(|text| lines(text).map(|(_, line)| line).collect()).collect();
    findings.iter().map(|finding| excerpts_of(job, &texts, finding)).collect()
}

/// Returns the excerpts of a finding. The texts are those of the program and of its files of subprograms.
fn excerpts_of(job: &JobFile, texts: &[Vec<&str>], finding: &JobFinding) -> Vec<Excerpt> {
    let ranges = match &finding.detail {
        FindingDetail::Surface { groups, .. } => {
            groups.iter().map(|group| [group.first.line, group.last.line]).collect()
        }
        FindingDetail::Machine(_) | FindingDetail::Stock(_) => vec![finding.lines],
    };
    let lines = around(&texts[0], finding.line, &ranges);
    let mut excerpts = vec![Excerpt { file: None, lines }];
    if let Some(SubprogramLine { file, line }) = finding.within {
        let lines = around(&texts[file], line, &[]);
        let file = file.checked_sub(1).map(|index| file_name(&job.subprograms[index]));
        excerpts.push(Excerpt { file, lines });
    }
    excerpts
}

/// Returns the lines around the worst one.
fn around(text: &[&str], worst: usize, ranges: &[[usize; 2]]) -> Vec<ExcerptLine> {
    // A subprogram may stand before the block that calls it.
    let is_within =
        |line| ranges.iter().any(|[one, end]| (*one.min(end)..=*one.max(end)).contains(&line));
    let shown = worst.saturating_sub(AROUND).max(1)..=worst + AROUND;
    let lines = shown.filter_map(|number| {
        let role = if number == worst {
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
