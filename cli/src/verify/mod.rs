//! `touchoff verify`: a program checked against a part, fixtures and stock. Prints one line per finding, as compilers
//! do, and a summary.

mod entry;
mod job;
mod json;
mod machine;
mod sarif;
mod source;
mod stock;
mod text;
mod tools;

use crate::arguments::Verify;
use crate::failure::Failure;
use crate::output::{Output, write_file};
use crate::part::{self, NO_INSIDE};
use crate::progress::Progress;
use entry::entries;
pub(crate) use entry::{Entry, EntrySource, Severity};
use job::Fixture;
pub(crate) use job::Job;
use machine::MachineFinding;
use serde::Serialize;
pub(crate) use source::{CheckedProgram, DEFAULT_MACHINE};
use std::io::Write;
use std::process::ExitCode;
pub(crate) use stock::CutStock;
use text::summary;
pub(crate) use tools::ProgramTool;
use touchoff::certify::TriangleBvh;
use touchoff::tool::ToolInfo;
use touchoff::{Mesh, Unit};
use touchoff_verify::{FindingGroup, FindingKind, Gap, Move, Tilt, Verifier, VerifyReport};

/// The exit status if there are findings.
const FOUND: u8 = 1;

/// The exit status if there is no verdict, even with findings; the same as for wrong options.
pub(crate) const NOT_CHECKED: u8 = 2;

/// The name of the part in findings.
const PART: &str = "the part";

/// The subject of findings.
pub(crate) struct Scope<'a> {
    pub(crate) info: &'a ToolInfo,
    /// The tool's number in the program.
    pub(crate) number: Option<u32>,
    /// The part or the fixture.
    body: &'a str,
    unit: Unit,
}

/// The changes that clear the worst motion of a finding at its pose.
#[derive(Clone, Copy)]
struct Remedy {
    /// Travel along the axis.
    lift: Option<f64>,
    /// Tilt of the axis about the tip, where the program can tilt it.
    tilt: Option<Tilt>,
}

/// A tool checked against the part or a fixture.
pub(crate) struct CheckedPair<'a> {
    pub(crate) scope: Scope<'a>,
    /// Index of the reading of the program.
    pub(crate) reading: usize,
    pub(crate) report: VerifyReport,
    pub(crate) groups: Vec<FindingGroup>,
    /// Remedies of the worst motion of each group.
    remedies: Vec<Remedy>,
    /// Set for the part, as opposed to a fixture.
    pub(crate) is_part: bool,
}

/// Returns the keyword of a finding's kind.
fn rule(kind: &FindingKind) -> &'static str {
    match kind {
        FindingKind::Deep { .. } => "deep",
        FindingKind::Near { .. } => "near",
        FindingKind::Inside { .. } => "inside",
        FindingKind::Undecided { .. } => "undecided",
        FindingKind::Ambiguous(_) => "ambiguous",
    }
}

/// A part or a fixture.
pub(crate) struct Body {
    pub(crate) name: String,
    pub(crate) mesh: Mesh,
    pub(crate) bvh: TriangleBvh,
    /// The link of the table that it moves with; `None` for the workpiece.
    link: Option<usize>,
    /// Distance that every surface has to keep, for a fixture.
    margin: Option<f64>,
}

impl Body {
    /// Returns whether it moves with another axis than the workpiece. The tool's poses at it are then in its own frame.
    pub(crate) fn has_own_frame(&self) -> bool {
        self.link.is_some()
    }
}

/// A job and the files that it names, read.
pub(crate) struct Inputs {
    pub(crate) job: Job,
    /// Name of the program's file.
    pub(crate) file: String,
    pub(crate) program: CheckedProgram,
    pub(crate) tools: Vec<ProgramTool>,
    /// The part, then the fixtures.
    pub(crate) bodies: Vec<Body>,
}

impl Inputs {
    /// Reads program, tools, part and fixtures of a job.
    ///
    /// # Errors
    /// If one of them cannot be read, or they do not fit.
    pub(crate) fn read(job: Job) -> Result<Inputs, Failure> {
        let program = CheckedProgram::read(&job)?;
        let tools = tools::load(&job.tools, &program.tools())?;
        for tool in &tools {
            program.check(tool, job.unit, &job.program)?;
        }
        let bodies = bodies(&job, &program)?;
        let file = job.program.display().to_string();
        Ok(Inputs { job, file, program, tools, bodies })
    }

    /// Checks the program. `json` suppresses the progress display.
    ///
    /// # Errors
    /// If a tool cannot be certified, or the stock cannot be made.
    pub(crate) fn check(&self, json: bool) -> Result<Verification<'_>, Failure> {
        let Inputs { job, program, tools, bodies, .. } = self;
        let progress = Progress::steps(program.motions() * bodies.len(), "motions", json);
        let mut pairs = Vec::new();
        for reading in 0..program.reading_count() {
            for tool in tools {
                for body in bodies {
                    pairs.push(self.check_pair(reading, (tool, body), &progress)?);
                }
            }
        }
        drop(progress);
        let mut cuts = Vec::new();
        if let Some(stock) = &job.stock {
            for reading in 0..program.reading_count() {
                cuts.push(stock::cut(job, stock, (program, reading), tools)?);
            }
        }
        let machine = program.machine_findings(&self.file, tools);
        let gaps = self.gaps()?;
        Ok(Verification { inputs: self, pairs, machine, cuts, gaps })
    }

    /// Checks the motions of a tool in a reading against a body.
    fn check_pair<'a>(
        &self,
        reading: usize,
        (tool, body): (&'a ProgramTool, &'a Body),
        progress: &Progress,
    ) -> Result<CheckedPair<'a>, Failure> {
        let Inputs { job, program, tools, .. } = self;
        let info = tool.tool().info();
        let mut verifier = Verifier::new(&body.bvh, tool.tool())?;
        match body.margin {
            Some(margin) if margin > 0.0 => {
                for surface in info.surfaces.iter() {
                    verifier = verifier.with_allowance(&surface.name, -margin)?;
                }
            }
            Some(_) => (),
            None => {
                verifier = verifier.with_tolerance(job.tolerance)?;
                for (surface, allowed) in &job.allow {
                    // An allowance of a job holds for the tools that have the surface, and one has to have it.
                    let has =
                        |tool: &ProgramTool| tool.tool().info().surface_named(surface).is_some();
                    if has(tool) || !tools.iter().any(has) {
                        verifier = verifier.with_allowance(surface, *allowed)?;
                    }
                }
                for (surface, allowed) in &tool.allow {
                    verifier = verifier.with_allowance(surface, *allowed)?;
                }
            }
        }
        if let Some(resolution) = job.resolution {
            verifier = verifier.with_resolution(resolution)?;
        }
        let moves = program.moves(reading, tool, body.link, job.unit)?;
        let report = verifier.check_moves(moves, &|count| progress.advance(count))?;
        let groups = FindingGroup::join(&report.findings);
        let remedy = |group: &FindingGroup| Remedy {
            lift: verifier.lift(&group.worst),
            tilt: verifier.tilt(&group.worst).filter(|_| program.turns_axis()),
        };
        let remedies = groups.iter().map(remedy).collect();
        let scope = Scope { info, number: tool.number, body: &body.name, unit: job.unit };
        let is_part = body.margin.is_none();
        Ok(CheckedPair { scope, reading, report, groups, remedies, is_part })
    }

    /// Returns what the program leaves open, here and on its machine.
    fn gaps(&self) -> Result<Vec<Gap>, Failure> {
        let Inputs { job, program, bodies, .. } = self;
        let mut gaps = program.gaps();
        let any_rapid = program.readings().iter().find_map(|reading| reading.summary().any_rapid);
        if let (Some(line), Some(_)) = (any_rapid, &job.stock) {
            let reason = "the path of several axes in rapid traverse is checked against the stock on the straight line only: \
                          state `rapid` of the control, or the `rapid` rates of the machine's axes";
            gaps.push(Gap::open(line, reason.to_owned()));
        }
        for (reading, read) in program.readings().iter().enumerate() {
            let offsets = &read.summary().work_offsets;
            for (offset, line) in offsets.iter().filter(|_| offsets.len() > 1) {
                let mut is_near = false;
                for tool in &self.tools {
                    let is_its = |step: &Move| step.work_offset == Some(*offset);
                    let moves = program.moves(reading, tool, None, job.unit)?.filter(is_its);
                    let mut moves = moves.peekable();
                    if moves.peek().is_some() {
                        let approach =
                            Verifier::new(&bodies[0].bvh, tool.tool())?.approach(moves)?;
                        is_near |= !approach.is_far();
                    }
                }
                let gap = Gap::open(
                    *line,
                    format!(
                        "under {offset} the tool never comes within its diameter of the part: check {offset} in `work_offsets`, \
                     or give a job per part"
                    ),
                );
                if !is_near && !gaps.contains(&gap) {
                    gaps.push(gap);
                }
            }
        }
        gaps.sort_by_key(|gap| (!gap.is_open, gap.line));
        Ok(gaps)
    }
}

/// The result of checking a program.
pub(crate) struct Verification<'a> {
    inputs: &'a Inputs,
    /// Each tool at each body.
    pub(crate) pairs: Vec<CheckedPair<'a>>,
    /// The findings about the machine, each with the index of its reading.
    machine: Vec<(usize, MachineFinding<'a>)>,
    /// The stock after each reading.
    cuts: Vec<CutStock>,
    /// Everything that the program leaves open.
    pub(crate) gaps: Vec<Gap>,
}

impl Verification<'_> {
    /// Returns all findings, the worst first.
    pub(crate) fn entries(&self) -> Vec<Entry<'_>> {
        entries(self)
    }

    /// Summarises the findings of each tool at each body, those of several readings in one line if they are alike.
    pub(crate) fn summaries(&self) -> Vec<String> {
        let texts = self.pairs.iter().map(|pair| (pair.reading, summary(pair)));
        let named =
            |(text, readings): (String, Vec<usize>)| match self.inputs.program.under(&readings) {
                Some(under) => format!("{under}: {text}"),
                None => text,
            };
        by_reading(texts, |known, text| known == text).into_iter().map(named).collect()
    }

    /// Returns the stock after the first reading, if the job has one.
    pub(crate) fn cut(&self) -> Option<&CutStock> {
        self.cuts.first()
    }

    /// Prints the reasons for which there is no verdict, then the summary, and writes what the job asks for of the stock.
    ///
    /// # Errors
    /// If a file cannot be written.
    pub(crate) fn print(&self) -> Result<(), Failure> {
        let Inputs { job, program, bodies, .. } = self.inputs;
        for reason in self.refusals() {
            message!("not verified: {reason}");
        }
        program.print(&self.pairs, job.unit);
        for gap in self.gaps.iter().filter(|gap| !gap.is_open || job.anyway) {
            message!("{}", not_checked(gap));
        }
        for summary in self.summaries() {
            message!("{summary}");
        }
        if let (Some(cut), Some(entry)) = (self.cut(), &job.stock) {
            cut.report(entry, &bodies[0].bvh)?;
        }
        if self.is_surface_only() {
            message!("{NO_INSIDE}; only its surface was checked");
        }
        Ok(())
    }

    /// Returns the exit status. A violation is one whatever else is left open.
    pub(crate) fn status(&self, entries: &[Entry<'_>]) -> u8 {
        let has = |severity: Severity| entries.iter().any(|entry| entry.severity == severity);
        match self.refusals().is_empty() {
            _ if has(Severity::Violation) && !self.is_misplaced() => FOUND,
            false => NOT_CHECKED,
            true if has(Severity::Undecided) => FOUND,
            true => 0,
        }
    }

    /// Returns whether the program seems to be in another unit than the part, so that findings mean nothing.
    fn is_misplaced(&self) -> bool {
        let mut parts = self.pairs.iter().filter(|pair| pair.is_part);
        !self.inputs.job.anyway && parts.any(|pair| pair.report.approach.unit_factor.is_some())
    }

    /// Returns whether the inside of a body is unknown, and only its surface was to be checked.
    pub(crate) fn is_surface_only(&self) -> bool {
        self.inputs.job.surface_only && self.pairs.iter().any(|pair| !pair.report.inside_known)
    }

    /// Returns the reasons for which a result without findings proves nothing.
    pub(crate) fn refusals(&self) -> Vec<String> {
        let Inputs { job, program, .. } = self.inputs;
        let open = self.gaps.iter().filter(|gap| gap.is_open && !job.anyway);
        let mut reasons: Vec<String> = open.map(described).collect();
        let mut is_checked = true;
        for reading in 0..program.reading_count() {
            let pairs: Vec<&CheckedPair<'_>> =
                self.pairs.iter().filter(|pair| pair.reading == reading).collect();
            if pairs.iter().all(|pair| pair.report.moves == 0) {
                is_checked = false;
            } else {
                let touches_stock =
                    self.cuts.get(reading).is_some_and(|cut| !cut.findings.is_empty());
                for reason in implausibilities(&pairs, job, touches_stock) {
                    if !reasons.contains(&reason) {
                        reasons.push(reason);
                    }
                }
            }
        }
        if !is_checked {
            reasons.push("no motion could be checked".to_owned());
        }
        reasons
    }
}

/// Joins what several readings have alike: each with the readings that have it, in the order of the first.
fn by_reading<T>(
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

/// Returns the reason of a gap with its line.
fn described(gap: &Gap) -> String {
    match gap.line {
        0 => gap.reason.clone(),
        line => format!("line {line}: {}", gap.reason),
    }
}

/// Returns the line of the verdict about a gap.
pub(crate) fn not_checked(gap: &Gap) -> String {
    format!("not checked: {}", described(gap))
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

/// Checks a program, and returns the exit status.
pub(crate) fn verify(arguments: Verify, json: bool) -> Result<ExitCode, Failure> {
    let sarif = arguments.sarif.clone();
    let inputs = Inputs::read(Job::new([arguments.job, arguments.part], arguments.check)?)?;
    let verification = inputs.check(json)?;
    let entries = verification.entries();
    let mut out = Output::rows();
    for entry in &entries {
        if json {
            serde_json::to_writer(&mut out, &entry.row)?;
            writeln!(out)?;
        } else {
            out.styled(entry.severity.style(), &format!("{}:{}:", inputs.file, entry.line))?;
            writeln!(out, " {}", entry.text)?;
        }
    }
    if json {
        for Gap { line, is_open, reason, .. } in &verification.gaps {
            let (file, open) = (&*inputs.file, *is_open);
            let row = GapRow { file, line: *line, kind: "not-checked", open, reason };
            serde_json::to_writer(&mut out, &row)?;
            writeln!(out)?;
        }
    }
    out.flush()?;
    verification.print()?;
    let status = verification.status(&entries);
    if let Some(file) = sarif {
        let log = sarif::log(&entries, &inputs.job.program, status != NOT_CHECKED)?;
        write_file(&file, log)?;
    }
    Ok(ExitCode::from(status))
}

/// Reads the part and the fixtures.
fn bodies(job: &Job, program: &CheckedProgram) -> Result<Vec<Body>, Failure> {
    let mesh = part::mesh(&job.part, job.unit, "verify")?;
    let bvh = TriangleBvh::new(&mesh);
    let mut bodies = vec![Body { name: PART.to_owned(), mesh, bvh, link: None, margin: None }];
    for Fixture { name, mesh, moves_with, margin } in &job.fixtures {
        if !(0.0..f64::INFINITY).contains(margin) {
            return Err(Failure::Usage("the margin of a fixture is a length of 0 or more"));
        }
        let link = match moves_with {
            None => None,
            Some(axis) => program.link(axis, job)?,
        };
        let mesh = part::mesh(mesh, job.unit, "verify")?;
        let bvh = TriangleBvh::new(&mesh);
        bodies.push(Body { name: name.clone(), mesh, bvh, link, margin: Some(*margin) });
    }
    Ok(bodies)
}

/// Returns the reasons to doubt that the motions that were checked are meant for these bodies.
fn implausibilities(pairs: &[&CheckedPair<'_>], job: &Job, touches_stock: bool) -> Vec<String> {
    let mut reasons = Vec::new();
    for pair in pairs {
        let CheckedPair { scope, report, .. } = pair;
        if !report.inside_known && !job.surface_only {
            reasons.push(format!(
                "{}: {NO_INSIDE}: repair the mesh, or check its surface alone with `--surface-only`",
                scope.body
            ));
        }
        if report.unrestricted {
            reasons.push(
                "`--tolerance`, `--allow` and `--resolution` allow every surface its greatest possible depth, so \
                 nothing could be found: lower them"
                    .to_owned(),
            );
        }
    }
    let parts = || pairs.iter().filter(|pair| pair.is_part);
    // A program that touches a fixture or the stock is meant for this setup.
    let touches = touches_stock || pairs.iter().any(|pair| !pair.groups.is_empty());
    if !job.anyway && !touches && parts().all(|pair| pair.report.approach.is_far()) {
        reasons.push(
            "the program never comes within the tool's diameter of the part: check the part, its position and its \
             unit, or accept the program with `--anyway`"
                .to_owned(),
        );
    }
    let factor = parts().find_map(|pair| pair.report.approach.unit_factor);
    if let (false, Some(factor)) = (job.anyway, factor) {
        reasons.push(format!(
            "the positions in feed lie outside the part's box, but would fit if they were {factor} times as large: check \
             the units of part and program, or accept the program with `--anyway`"
        ));
    }
    reasons
}
