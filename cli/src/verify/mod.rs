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
pub(crate) use source::{CheckedProgram, DEFAULT_MACHINE};
use std::io::Write;
use std::process::ExitCode;
pub(crate) use stock::CutStock;
pub(crate) use text::summary;
pub(crate) use tools::ProgramTool;
use touchoff::certify::TriangleBvh;
use touchoff::tool::ToolInfo;
use touchoff::verify::{FindingGroup, FindingKind, Tilt, Verifier, VerifyReport};
use touchoff::{Mesh, Unit};

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
        for tool in tools {
            for body in bodies {
                pairs.push(check(job, (program, tools), tool, body, &progress)?);
            }
        }
        drop(progress);
        let cut = match &job.stock {
            Some(stock) => Some(stock::cut(job, stock, program, tools)?),
            None => None,
        };
        let machine = program.machine_findings(&self.file);
        Ok(Verification { inputs: self, pairs, machine, cut })
    }
}

/// The result of checking a program.
pub(crate) struct Verification<'a> {
    inputs: &'a Inputs,
    /// Each tool at each body.
    pub(crate) pairs: Vec<CheckedPair<'a>>,
    machine: Vec<MachineFinding<'a>>,
    pub(crate) cut: Option<CutStock>,
}

impl Verification<'_> {
    /// Returns all findings, the worst first.
    pub(crate) fn entries(&self) -> Vec<Entry<'_>> {
        let stock = self.cut.as_ref().map_or(&[][..], |cut| &cut.findings);
        entries(&self.pairs, &self.machine, stock, (&self.inputs.file, self.inputs.job.unit))
    }

    /// Prints the summary, and writes what the job asks for of the stock.
    ///
    /// # Errors
    /// If a file cannot be written.
    pub(crate) fn print(&self) -> Result<(), Failure> {
        let Inputs { job, program, bodies, .. } = self.inputs;
        program.print(&self.pairs, job.unit);
        for pair in &self.pairs {
            message!("{}", summary(pair));
        }
        if let (Some(cut), Some(entry)) = (&self.cut, &job.stock) {
            cut.report(entry, &bodies[0].bvh)?;
        }
        Ok(())
    }

    /// Returns the exit status, and reports why there is no verdict.
    pub(crate) fn status(&self, entries: &[Entry<'_>]) -> u8 {
        let refusals = self.refusals();
        for reason in &refusals {
            message!("not verified: {reason}");
        }
        if self.is_surface_only() {
            message!("{NO_INSIDE}; only its surface was checked");
        }
        match entries.iter().all(|entry| entry.severity == Severity::Remark) {
            _ if !refusals.is_empty() => NOT_CHECKED,
            true => 0,
            false => FOUND,
        }
    }

    /// Returns whether the inside of a body is unknown, and only its surface was to be checked.
    pub(crate) fn is_surface_only(&self) -> bool {
        self.inputs.job.surface_only && self.pairs.iter().any(|pair| !pair.report.inside_known)
    }

    /// Returns the reasons for which a result without findings proves nothing.
    pub(crate) fn refusals(&self) -> Vec<String> {
        let (pairs, job) = (&self.pairs, &self.inputs.job);
        let mut reasons = Vec::new();
        if pairs.iter().all(|pair| pair.report.moves == 0) {
            reasons.push(
                "no motion could be checked, since only the machine knows where each starts or ends: state tool lengths \
                 and work offsets in a job"
                    .to_owned(),
            );
        } else {
            reasons.extend(implausibilities(pairs, job));
        }
        if let (false, Some(line)) = (job.anyway, self.inputs.program.unknown_feed()) {
            reasons.push(format!(
                "the feed motion at line {line} starts or ends where only the machine knows: state tool lengths and \
                 work offsets in a job, or accept the rest with `--anyway`"
            ));
        }
        reasons
    }
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

/// Checks the motions of a tool against a body.
fn check<'a>(
    job: &Job,
    (program, tools): (&CheckedProgram, &[ProgramTool]),
    tool: &'a ProgramTool,
    body: &'a Body,
    progress: &Progress,
) -> Result<CheckedPair<'a>, Failure> {
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
                let has = |tool: &ProgramTool| tool.tool().info().surface_named(surface).is_some();
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
    let moves = program.moves(tool, body.link, job.unit)?;
    let report = verifier.check_moves(moves, &|count| progress.advance(count))?;
    let groups = FindingGroup::join(&report.findings);
    let remedy = |group: &FindingGroup| Remedy {
        lift: verifier.lift(&group.worst),
        tilt: verifier.tilt(&group.worst).filter(|_| program.turns_axis()),
    };
    let remedies = groups.iter().map(remedy).collect();
    let scope = Scope { info, number: tool.number, body: &body.name, unit: job.unit };
    Ok(CheckedPair { scope, report, groups, remedies, is_part: body.margin.is_none() })
}

/// Returns the reasons to doubt that the motions that were checked are meant for these bodies.
fn implausibilities(pairs: &[CheckedPair<'_>], job: &Job) -> Vec<String> {
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
    if !job.anyway && parts().all(|pair| pair.report.approach.is_far()) {
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
