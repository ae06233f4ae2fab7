//! The result of checking a job: its findings, and the verdict.

use super::machine::MachineFinding;
use super::stock::{CutStock, StockFinding};
use super::{Body, FindingRule, Job, JobGap, JobTool, RevolvedBody};
use crate::codes::faults;
use crate::gcode::SubprogramLine;
use crate::{Approach, FindingGroup, Gap, GapWeight, Tilt, VerifyReport};
use std::fmt;
use touchoff::Tool;
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

/// The sentence of the verdict.
impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Verdict::Clean => "every motion is proved to stay within its limits",
            Verdict::Findings => "a rule is violated, or it is not decided whether one is",
            Verdict::None => "no verdict: something stands in the way of a proof",
        })
    }
}

impl Verdict {
    /// Returns its word in JSON.
    pub fn keyword(self) -> &'static str {
        match self {
            Verdict::Clean => "clean",
            Verdict::Findings => "findings",
            Verdict::None => "none",
        }
    }
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

/// Something that moves against a body: its index in the job.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Moving {
    /// A tool of the program.
    Tool(usize),
    /// A body of the machine that is a solid of revolution.
    Revolved(usize),
}

impl Moving {
    /// Returns the index of a tool of the program.
    pub fn tool(self) -> Option<usize> {
        match self {
            Moving::Tool(index) => Some(index),
            Moving::Revolved(_) => None,
        }
    }
}

/// A tool, or a body of the machine, checked against a body, in one reading of the program.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct PairReport {
    /// Object that moves against the body.
    pub moving: Moving,
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
    pub(super) findings: Vec<JobFinding>,
}

impl JobReport<'_> {
    /// Returns all findings: violations, then what is undecided, then remarks. Within each the worst comes first: a tool inside the
    /// material, then the depth beyond its limit at a body or in the stock, then the distance short of a margin, then the machine,
    /// whose findings have no depth. A finding of several readings is one, and so are the motions on which a tool passes right
    /// through a body.
    pub fn findings(&self) -> &[JobFinding] {
        &self.findings
    }

    /// Returns the tool of a pair; `None` if a body of the machine moves in it.
    pub fn tool(&self, pair: &PairReport) -> Option<&JobTool<'_>> {
        Some(&self.job.tools[pair.moving.tool()?])
    }

    /// Returns the body of the machine that moves in a pair; `None` if it is a tool.
    pub fn revolved(&self, pair: &PairReport) -> Option<&RevolvedBody<'_>> {
        match pair.moving {
            Moving::Tool(_) => None,
            Moving::Revolved(index) => Some(&self.job.revolved[index]),
        }
    }

    /// Returns the shape that moves in a pair: a tool, or that of a body of the machine.
    pub fn shape(&self, pair: &PairReport) -> &dyn Tool {
        match pair.moving {
            Moving::Tool(index) => self.job.tools[index].tool,
            Moving::Revolved(index) => self.job.revolved[index].shape,
        }
    }

    /// Returns the tools at the part in the first reading, one pair per tool.
    pub fn tools_at_part(&self) -> impl Iterator<Item = &PairReport> {
        let is_first = |pair: &&PairReport| pair.body == 0 && pair.reading == 0;
        self.pairs.iter().filter(is_first).filter(|pair| pair.moving.tool().is_some())
    }

    /// Returns the body of a pair.
    pub fn body(&self, pair: &PairReport) -> &Body<'_> {
        &self.job.bodies[pair.body]
    }

    pub(super) fn info(&self, pair: &PairReport) -> &ToolInfo {
        self.shape(pair).info()
    }

    /// Returns the stock after the first reading, if the job has one.
    pub fn cut(&self) -> Option<&CutStock> {
        self.cuts.first()
    }

    /// Returns the verdict. A violation is one whatever else is left open.
    pub fn verdict(&self) -> Verdict {
        let has =
            |severity: Severity| self.findings.iter().any(|finding| finding.severity == severity);
        match self.refusals().is_empty() {
            // A violation is proved whatever is left open, unless the program seems to be in another unit.
            _ if has(Severity::Violation) && !self.is_misplaced() => Verdict::Findings,
            false => Verdict::None,
            true if has(Severity::Undecided) => Verdict::Findings,
            true => Verdict::Clean,
        }
    }

    /// Returns the verdict with the numbers of findings, in a line without a full stop.
    pub fn headline(&self) -> String {
        let nouns = [
            (Severity::Violation, "violation"),
            (Severity::Undecided, "undecided finding"),
            (Severity::Remark, "remark"),
        ];
        let counts = nouns.into_iter().filter_map(|(severity, noun)| {
            let own = self.findings.iter().filter(|finding| finding.severity == severity);
            match own.count() {
                0 => None,
                1 => Some(format!("1 {noun}")),
                count => Some(format!("{count} {noun}s")),
            }
        });
        let counts = counts.collect::<Vec<_>>().join(", ");
        let separator = if counts.is_empty() { "" } else { "; " };
        match self.verdict() {
            Verdict::Findings => format!("findings: {counts}"),
            Verdict::Clean if self.gaps.is_empty() => {
                format!("no findings: {}{separator}{counts}", Verdict::Clean)
            }
            Verdict::Clean => format!(
                "no findings: {}, but for what is not checked{separator}{counts}",
                Verdict::Clean
            ),
            Verdict::None => format!("{}{separator}{counts}", Verdict::None),
        }
    }

    /// Returns whether a pair is a tool of the program at the part.
    fn is_tool_at_part(&self, pair: &PairReport) -> bool {
        pair.moving.tool().is_some() && self.body(pair).is_part()
    }

    /// Returns whether the program seems to be in another unit than the part, so that findings mean nothing.
    fn is_misplaced(&self) -> bool {
        let mut readings = 0..self.job.program.reading_count();
        !self.job.anyway && readings.any(|reading| self.unit_factor(reading).is_some())
    }

    /// Returns the factor of a unit by which the positions of all tools in a reading would fit the part much better.
    fn unit_factor(&self, reading: usize) -> Option<f64> {
        let at_part = |pair: &&PairReport| {
            pair.reading == reading && self.is_tool_at_part(pair) && pair.body == 0
        };
        let tools = self.pairs.iter().filter(at_part);
        Approach::unit_factor_of(tools.map(|pair| &pair.report.approach))
    }

    /// Returns whether the inside of a body is unknown, and only its surface was to be checked.
    pub fn is_surface_only(&self) -> bool {
        self.job.surface_only && self.pairs.iter().any(|pair| !pair.report.inside_known)
    }

    /// Returns the reasons for which a result without findings proves nothing.
    pub fn refusals(&self) -> Vec<NoVerdict> {
        self.refusals_if(self.job.anyway)
    }

    /// Returns whether the job has accepted a reason for which there would be no verdict.
    pub(super) fn is_lenient(&self) -> bool {
        let is_before =
            |gap: &Gap| gap.code() == JobGap::AcceptedSetup { file: String::new() }.code();
        self.job.anyway && !self.refusals_if(false).is_empty() || self.gaps.iter().any(is_before)
    }

    /// Returns the reasons for which a result without findings proves nothing, if the job accepts what is left open or not.
    fn refusals_if(&self, anyway: bool) -> Vec<NoVerdict> {
        let open = self.gaps.iter().filter(|gap| match gap.weight {
            GapWeight::Stops => true,
            GapWeight::Open => !anyway,
            GapWeight::Said => false,
        });
        let mut reasons: Vec<NoVerdict> = open
            .map(|gap| match gap.weight {
                GapWeight::Stops if gap.line > 0 => NoVerdict::Unread {
                    program: self.job.program.name().to_owned(),
                    gap: gap.clone(),
                },
                _ => NoVerdict::Open(gap.clone()),
            })
            .collect();
        let mut is_checked = true;
        for reading in 0..self.job.program.reading_count() {
            let pairs: Vec<&PairReport> =
                self.pairs.iter().filter(|pair| pair.reading == reading).collect();
            // Without motions the approach says nothing.
            if pairs.iter().all(|pair| pair.report.moves == 0) {
                is_checked = false;
                continue;
            }
            let touches_stock = self.cuts.get(reading).is_some_and(|cut| !cut.findings.is_empty());
            for reason in self.implausibilities(&pairs, touches_stock, anyway) {
                if !reasons.contains(&reason) {
                    reasons.push(reason);
                }
            }
        }
        if !is_checked {
            reasons.push(NoVerdict::NoMotion);
        }
        reasons
    }

    /// Returns the reasons to doubt that the motions of a reading are meant for these bodies.
    fn implausibilities(
        &self,
        pairs: &[&PairReport],
        touches_stock: bool,
        anyway: bool,
    ) -> Vec<NoVerdict> {
        let mut reasons = Vec::new();
        for pair in pairs {
            if !pair.report.inside_known && !self.job.surface_only {
                reasons.push(NoVerdict::NoInside { body: self.body(pair).name.clone() });
            }
            if pair.report.unrestricted {
                reasons.push(NoVerdict::Unrestricted);
            } else if !anyway && !pair.report.unchecked_surfaces.is_empty() {
                let info = self.info(pair);
                let names = pair.report.unchecked_surfaces.iter();
                let names = names.map(|surface| &*info.surface(*surface).name);
                let tool = info.name.to_string();
                let surfaces = names.collect::<Vec<_>>().join(", ");
                reasons.push(NoVerdict::SmallSurfaces { tool, surfaces });
            }
        }
        let parts = || pairs.iter().filter(|pair| self.is_tool_at_part(pair));
        // A program that touches a fixture or the stock is meant for this setup.
        let touches = touches_stock || pairs.iter().any(|pair| !pair.groups.is_empty());
        if !anyway && !touches && parts().all(|pair| pair.report.approach.is_far()) {
            reasons.push(NoVerdict::Far);
        }
        let factor = pairs.first().and_then(|pair| self.unit_factor(pair.reading));
        if let (false, Some(factor)) = (anyway, factor) {
            reasons.push(NoVerdict::OtherUnit { factor });
        }
        reasons
    }
}

faults! {
    #[family("V02", "No verdict")]
    /// A reason for which a result without findings proves nothing.
    #[derive(Clone, PartialEq, thiserror::Error)]
    #[non_exhaustive]
    pub enum NoVerdict {
        /// The program is not read to its end.
        #[code_of(gap)]
        #[error("{program}:{}: {}", gap.line, gap.reason)]
        Unread {
            /// The program.
            program: String,
            /// The gap.
            gap: Gap,
        },
        /// A gap that the job does not accept.
        #[code_of(0)]
        #[error("{0}")]
        Open(Gap),
        /// A body whose inside is undefined.
        ///
        /// A tool that is wholly inside the material would not be found.
        #[code = V0201]
        #[error(
            "{body}: {NO_INSIDE}: repair the mesh, or check its surface alone with `--surface-only`"
        )]
        NoInside {
            /// The body.
            body: String,
        },
        /// Limits that allow every depth.
        #[code = V0202]
        #[error(
            "`--tolerance`, `--allow` and `--resolution` allow every surface its greatest possible depth, so nothing could be found: lower \
             them"
        )]
        Unrestricted,
        /// A program that stays far from the part.
        #[code = V0203]
        #[error(
            "the program never comes within the tool's diameter of the part: check the part, its position and its unit, or accept the \
             program with `--anyway`"
        )]
        Far,
        /// A program that seems to be in another unit than the part.
        #[code = V0204]
        #[error(
            "the positions in feed lie outside the part's box or fill little of it, but would fit if they were {factor} times as large: \
             check the units of part and program, or accept the program with `--anyway`"
        )]
        OtherUnit {
            /// The factor by which they would fit.
            factor: f64,
        },
        /// A program of which no motion can be checked.
        #[code = V0205]
        #[error("no motion could be checked")]
        NoMotion,
        /// Surfaces that are nowhere as deep as the tolerance, such as those of a thin disc.
        ///
        /// However far they are in the material, no finding of them is possible.
        #[code = V0206]
        #[error(
            "{surfaces} of {tool} can nowhere be deeper than what is allowed, so they are not checked: lower the tolerance, state what they may \
             have by `allow`, or accept it with `--anyway`"
        )]
        SmallSurfaces {
            /// The tool.
            tool: String,
            /// The names of the surfaces.
            surfaces: String,
        },
    }
}

impl NoVerdict {
    /// Returns the line of the program that it concerns, 1-based; 0 if it concerns none.
    pub fn line(&self) -> usize {
        match self {
            NoVerdict::Unread { gap, .. } | NoVerdict::Open(gap) => gap.line,
            _ => 0,
        }
    }
}

/// The reason for which nothing inside a mesh can be found.
pub const NO_INSIDE: &str = "the part's inside is undefined: its mesh leaks, is not consistently oriented, or \
                             is inside out, as a whole or in one connected component";

/// A finding of a job.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct JobFinding {
    /// The rule that it violates.
    pub rule: FindingRule,
    /// Its consequence.
    pub severity: Severity,
    /// The line of the worst motion.
    pub line: usize,
    /// The line of its block in the file of subprograms that has it.
    pub within: Option<SubprogramLine>,
    /// The lines of the first and the last motion.
    pub lines: [usize; 2],
    /// A sentence without a full stop, with the readings for which it holds.
    pub text: String,
    /// The readings of the program under which it holds, if not under all.
    pub under: Option<String>,
    /// The finding itself.
    pub detail: FindingDetail,
}

/// The sentence of the finding.
impl fmt::Display for JobFinding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

/// Subject of a finding.
#[derive(Clone, Debug)]
pub enum FindingDetail {
    /// A surface of a tool, or of a body of the machine, at another body.
    Surface {
        /// Index of both in the report's pairs.
        pair: usize,
        /// The consecutive motions. There are several groups, in the order of the program, if the tool passes right through the
        /// body on each: depth does not tell them apart.
        groups: Vec<FindingGroup>,
        /// Number of blocks or cutter locations in all groups together.
        motions: usize,
        /// The changes that clear the worst motion of the first group.
        remedy: Remedy,
    },
    /// The machine.
    Machine(MachineFinding),
    /// The stock.
    Stock(StockFinding),
}

/// The consequence of a finding, from the worst.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    /// A rule is violated.
    Violation,
    /// A motion could not be checked in full.
    Undecided,
    /// The verdict does not depend on it.
    Remark,
}

impl Severity {
    /// Returns its word in JSON.
    pub fn keyword(self) -> &'static str {
        match self {
            Severity::Violation => "violation",
            Severity::Undecided => "undecided",
            Severity::Remark => "remark",
        }
    }
}
