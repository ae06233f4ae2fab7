//! The result of checking a job.

use super::machine::MachineFinding;
use super::stock::CutStock;
use super::text::summary;
use super::{Body, Job, JobError, JobFinding, JobTool, Severity, finding, sarif};
use crate::{FindingGroup, Gap, Tilt, VerifyReport};
use serde::Serialize;
use touchoff::tool::ToolInfo;

/// The verdict about a job.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// Every motion is proved to stay within its limits.
    Clean,
    /// A rule is violated, or it is not decided whether one is.
    Findings,
    /// A result without findings would prove nothing: [`JobReport::refusals`] has the reasons.
    None,
}

/// The changes that clear the worst motion of a group of findings at its pose.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Remedy {
    /// Travel along the axis, in the part's unit.
    pub lift: Option<f64>,
    /// Tilt of the axis about the tip, where the program can tilt it.
    pub tilt: Option<Tilt>,
}

/// A tool checked against the part or a fixture, in one reading of the program.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct PairReport {
    /// Index of the tool in the job.
    pub tool: usize,
    /// Index of the body in the job.
    pub body: usize,
    /// Index of the reading of the program.
    pub reading: usize,
    /// The result for its motions.
    pub report: VerifyReport,
    /// The findings, joined.
    pub groups: Vec<FindingGroup>,
    /// The remedies for the worst motion of each group.
    pub remedies: Vec<Remedy>,
}

/// The result of checking a job.
#[derive(Debug)]
#[non_exhaustive]
pub struct JobReport<'a> {
    /// The job.
    pub job: &'a Job<'a>,
    /// Each tool at each body, by the reading of the program.
    pub pairs: Vec<PairReport>,
    /// The findings about the machine, each with the index of its reading.
    pub machine: Vec<(usize, MachineFinding)>,
    /// The stock after each reading, if the job has one.
    pub cuts: Vec<CutStock>,
    /// Everything that the program leaves open: first what allows no verdict, each in the order of lines.
    pub gaps: Vec<Gap>,
    findings: Vec<JobFinding>,
}

/// A gap as a JSON object.
#[derive(Serialize)]
struct GapRow<'a> {
    file: &'a str,
    line: usize,
    kind: &'static str,
    /// Set if it allows no verdict.
    open: bool,
    reason: &'a str,
}

impl Job<'_> {
    /// Checks the program in every reading. `progress` is called with the number of motions checked since the last call, from any
    /// thread; the numbers add up to [`Program::motions`](super::Program::motions) times the number of bodies.
    ///
    /// # Errors
    /// If the program states another unit or cutter than the job, a tool cannot be certified or has not a surface that is allowed a
    /// depth, or the stock cannot be made or cut.
    pub fn check(&self, progress: &(dyn Fn(usize) + Sync)) -> Result<JobReport<'_>, JobError> {
        for JobTool { motions, tool, .. } in &self.tools {
            self.program.check_tool(*motions, tool.info(), self.unit())?;
        }
        let (mut pairs, mut cuts) = (Vec::new(), Vec::new());
        let mut gaps = self.program.gaps();
        let summaries = || self.program.readings().iter().map(|reading| reading.summary());
        if let (Some(line), Some(_)) =
            (summaries().find_map(|summary| summary.any_rapid), &self.stock)
        {
            let reason = "the path of several axes in rapid traverse is checked against the stock on the straight line only: \
                          state `rapid` of the control, or the `rapid` rates of the machine's axes";
            gaps.push(Gap::open(line, reason.to_owned()));
        }
        for reading in 0..self.program.reading_count() {
            let result = self.check_reading(reading, progress)?;
            pairs.extend(result.pairs);
            let far = result.far_offsets.into_iter().map(|(offset, line)| {
                let reason = format!(
                    "under {offset} the tool never comes within its diameter of the part: check {offset} in `work_offsets`, \
                     or give a job per part"
                );
                (line, reason)
            });
            let thin = result.cut.iter().flat_map(|cut| cut.too_thin.iter().cloned());
            for (line, reason) in far.chain(thin) {
                let gap = Gap::open(line, reason);
                if !gaps.contains(&gap) {
                    gaps.push(gap);
                }
            }
            cuts.extend(result.cut);
        }
        gaps.sort_by_key(|gap| (!gap.is_open, gap.line));
        let machine = MachineFinding::all(self);
        let mut report = JobReport { job: self, pairs, machine, cuts, gaps, findings: Vec::new() };
        report.findings = finding::all(&report);
        Ok(report)
    }
}

impl JobReport<'_> {
    /// Returns all findings: those of surfaces, the worst first, then those of the machine and of the stock. A finding of several
    /// readings is one.
    pub fn findings(&self) -> &[JobFinding] {
        &self.findings
    }

    /// Returns the tool of a pair.
    pub fn tool(&self, pair: &PairReport) -> &JobTool<'_> {
        &self.job.tools[pair.tool]
    }

    /// Returns the body of a pair.
    pub fn body(&self, pair: &PairReport) -> &Body<'_> {
        &self.job.bodies[pair.body]
    }

    pub(super) fn info(&self, pair: &PairReport) -> &ToolInfo {
        self.tool(pair).tool.info()
    }

    /// Returns the stock after the first reading, if the job has one.
    pub fn cut(&self) -> Option<&CutStock> {
        self.cuts.first()
    }

    /// Summarises the findings of each tool at each body, those of several readings in one line if they are alike.
    pub fn summaries(&self) -> Vec<String> {
        let texts = self.pairs.iter().map(|pair| (pair.reading, summary(self, pair)));
        let named = |(text, readings): (String, Vec<usize>)| match self.job.program.under(&readings)
        {
            Some(under) => format!("{under}: {text}"),
            None => text,
        };
        by_reading(texts, |known, text| known == text).into_iter().map(named).collect()
    }

    /// Returns the verdict. A violation is one whatever else is left open.
    pub fn verdict(&self) -> Verdict {
        let has =
            |severity: Severity| self.findings.iter().any(|finding| finding.severity == severity);
        match self.refusals().is_empty() {
            _ if has(Severity::Violation) && !self.is_misplaced() => Verdict::Findings,
            false => Verdict::None,
            true if has(Severity::Undecided) => Verdict::Findings,
            true => Verdict::Clean,
        }
    }

    /// Returns whether the program seems to be in another unit than the part, so that findings mean nothing.
    fn is_misplaced(&self) -> bool {
        let mut parts = self.pairs.iter().filter(|pair| self.body(pair).is_part());
        !self.job.anyway && parts.any(|pair| pair.report.approach.unit_factor.is_some())
    }

    /// Returns whether the inside of a body is unknown, and only its surface was to be checked.
    pub fn is_surface_only(&self) -> bool {
        self.job.surface_only && self.pairs.iter().any(|pair| !pair.report.inside_known)
    }

    /// Returns the reasons for which a result without findings proves nothing.
    pub fn refusals(&self) -> Vec<String> {
        let open = self.gaps.iter().filter(|gap| gap.is_open && !self.job.anyway);
        let mut reasons: Vec<String> = open.map(Gap::to_string).collect();
        let mut is_checked = true;
        for reading in 0..self.job.program.reading_count() {
            let pairs: Vec<&PairReport> =
                self.pairs.iter().filter(|pair| pair.reading == reading).collect();
            if pairs.iter().all(|pair| pair.report.moves == 0) {
                is_checked = false;
                continue;
            }
            let touches_stock = self.cuts.get(reading).is_some_and(|cut| !cut.findings.is_empty());
            for reason in self.implausibilities(&pairs, touches_stock) {
                if !reasons.contains(&reason) {
                    reasons.push(reason);
                }
            }
        }
        if !is_checked {
            reasons.push("no motion could be checked".to_owned());
        }
        reasons
    }

    /// Returns the reasons to doubt that the motions of a reading are meant for these bodies.
    fn implausibilities(&self, pairs: &[&PairReport], touches_stock: bool) -> Vec<String> {
        let mut reasons = Vec::new();
        for pair in pairs {
            if !pair.report.inside_known && !self.job.surface_only {
                reasons.push(format!(
                    "{}: {NO_INSIDE}: repair the mesh, or check its surface alone with `--surface-only`",
                    self.body(pair).name
                ));
            }
            if pair.report.unrestricted {
                reasons.push(
                    "`--tolerance`, `--allow` and `--resolution` allow every surface its greatest possible depth, so \
                     nothing could be found: lower them"
                        .to_owned(),
                );
            }
        }
        let parts = || pairs.iter().filter(|pair| self.body(pair).is_part());
        // A program that touches a fixture or the stock is meant for this setup.
        let touches = touches_stock || pairs.iter().any(|pair| !pair.groups.is_empty());
        if !self.job.anyway && !touches && parts().all(|pair| pair.report.approach.is_far()) {
            reasons.push(
                "the program never comes within the tool's diameter of the part: check the part, its position and its \
                 unit, or accept the program with `--anyway`"
                    .to_owned(),
            );
        }
        let factor = parts().find_map(|pair| pair.report.approach.unit_factor);
        if let (false, Some(factor)) = (self.job.anyway, factor) {
            reasons.push(format!(
                "the positions in feed lie outside the part's box, but would fit if they were {factor} times as large: check \
                 the units of part and program, or accept the program with `--anyway`"
            ));
        }
        reasons
    }

    /// Returns a finding as an object for JSON.
    pub fn row<'r>(&'r self, finding: &'r JobFinding) -> impl Serialize + 'r {
        finding::FindingRow::of(self, finding)
    }

    /// Returns what is left open as objects for JSON.
    pub fn gap_rows(&self) -> impl Iterator<Item = impl Serialize + '_> {
        self.gaps.iter().map(|Gap { line, is_open, reason, .. }| GapRow {
            file: self.job.program.name(),
            line: *line,
            kind: "not-checked",
            open: *is_open,
            reason,
        })
    }

    /// Returns the findings in SARIF 2.1.0, for services of continuous integration.
    pub fn sarif(&self) -> impl Serialize {
        sarif::log(self)
    }
}

/// The reason for which nothing inside a mesh can be found.
pub const NO_INSIDE: &str = "the part's inside is undefined: its mesh leaks, is not consistently oriented, or \
                             is inside out, as a whole or in one connected component";

/// Joins what several readings have alike: each with the readings that have it, in the order of the first.
pub(super) fn by_reading<T>(
    found: impl Iterator<Item = (usize, T)>,
    is_same: impl Fn(&T, &T) -> bool,
) -> Vec<(T, Vec<usize>)> {
    let mut joined: Vec<(T, Vec<usize>)> = Vec::new();
    for (reading, item) in found {
        // The first reading has nothing to be joined with.
        let mut known = joined.iter_mut().filter(|_| reading > 0);
        match known.find(|(known, _)| is_same(known, &item)) {
            Some((_, readings)) if !readings.contains(&reading) => readings.push(reading),
            _ => joined.push((item, vec![reading])),
        }
    }
    joined
}
