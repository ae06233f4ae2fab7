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
use entry::{Severity, entries};
use job::{Fixture, Job};
use source::CheckedProgram;
use std::io::Write;
use std::process::ExitCode;
use text::summary;
use tools::ProgramTool;
use touchoff::Unit;
use touchoff::certify::TriangleBvh;
use touchoff::tool::ToolInfo;
use touchoff::verify::{FindingGroup, FindingKind, Tilt, Verifier, VerifyReport};

/// The exit status if there are findings.
const FOUND: u8 = 1;

/// The exit status if there is no verdict, even with findings; the same as for wrong options.
pub(crate) const NOT_CHECKED: u8 = 2;

/// The name of the part in findings.
const PART: &str = "the part";

/// The subject of findings.
struct Scope<'a> {
    info: &'a ToolInfo,
    /// The tool's number in the program.
    number: Option<u32>,
    /// The part or the fixture.
    body: &'a str,
    unit: Unit,
}

/// What clears the worst motion of a finding at its pose.
#[derive(Clone, Copy)]
struct Remedy {
    /// Travel along the axis.
    lift: Option<f64>,
    /// Tilt of the axis about the tip, where the program can tilt it.
    tilt: Option<Tilt>,
}

/// A tool checked against the part or a fixture.
struct CheckedPair<'a> {
    scope: Scope<'a>,
    report: VerifyReport,
    groups: Vec<FindingGroup>,
    /// Remedies of the worst motion of each group.
    remedies: Vec<Remedy>,
    /// Set for the part, as opposed to a fixture.
    is_part: bool,
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
struct Body {
    name: String,
    bvh: TriangleBvh,
    /// The link of the table that it moves with; `None` for the workpiece.
    link: Option<usize>,
    /// Distance that every surface has to keep, for a fixture.
    margin: Option<f64>,
}

/// Checks a program, and returns the exit status.
pub(crate) fn verify(arguments: Verify, json: bool) -> Result<ExitCode, Failure> {
    let sarif = arguments.sarif.clone();
    let job = Job::new(arguments)?;
    let program = CheckedProgram::read(&job)?;
    let tools = tools::load(&job.tools, &program.tools())?;
    for tool in &tools {
        program.check(tool, job.unit, &job.program)?;
    }
    let bodies = bodies(&job, &program)?;
    let progress = Progress::steps(program.motions() * bodies.len(), "motions", json);
    let mut pairs = Vec::new();
    for tool in &tools {
        for body in &bodies {
            pairs.push(check(&job, (&program, &tools), tool, body, &progress)?);
        }
    }
    drop(progress);
    let cut = match &job.stock {
        Some(stock) => Some((stock::cut(&job, stock, &program, &tools)?, stock)),
        None => None,
    };
    let stock = cut.as_ref().map_or(&[][..], |(cut, _)| &cut.findings);
    let file = job.program.display().to_string();
    let machine = program.machine_findings(&file);
    let entries = entries(&pairs, &machine, stock, (&file, job.unit));
    let mut out = Output::rows();
    for entry in &entries {
        if json {
            serde_json::to_writer(&mut out, &entry.row)?;
            writeln!(out)?;
        } else {
            out.styled(entry.severity.style(), &format!("{file}:{}:", entry.line))?;
            writeln!(out, " {}", entry.text)?;
        }
    }
    out.flush()?;
    program.print(&pairs, job.unit);
    for pair in &pairs {
        message!("{}", summary(pair));
    }
    if let Some((cut, entry)) = &cut {
        cut.report(entry, &bodies[0].bvh)?;
    }
    let is_clear = entries.iter().all(|entry| entry.severity == Severity::Remark);
    let mut status = status(&pairs, &job, if is_clear { 0 } else { FOUND });
    if let (false, Some(line)) = (job.anyway, program.unknown_feed()) {
        message!(
            "not verified: the feed motion at line {line} starts or ends where only the machine knows: state tool lengths and \
             work offsets in a job, or accept the rest with `--anyway`"
        );
        status = NOT_CHECKED;
    }
    if let Some(file) = sarif {
        let log = sarif::log(&entries, &job.program, status != NOT_CHECKED)?;
        write_file(&file, log)?;
    }
    Ok(ExitCode::from(status))
}

/// Reads the part and the fixtures.
fn bodies(job: &Job, program: &CheckedProgram) -> Result<Vec<Body>, Failure> {
    let mesh = part::mesh(&job.part, job.unit, "verify")?;
    let mut bodies = vec![Body {
        name: PART.to_owned(),
        bvh: TriangleBvh::new(&mesh),
        link: None,
        margin: None,
    }];
    for Fixture { name, mesh, moves_with, margin } in &job.fixtures {
        if !(0.0..f64::INFINITY).contains(margin) {
            return Err(Failure::Usage("the margin of a fixture is a length of 0 or more"));
        }
        let link = match moves_with {
            None => None,
            Some(axis) => program.link(axis, job)?,
        };
        let bvh = TriangleBvh::new(&part::mesh(mesh, job.unit, "verify")?);
        bodies.push(Body { name: name.clone(), bvh, link, margin: Some(*margin) });
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

/// Returns the given exit status, or that without a verdict, and reports why there is none.
fn status(pairs: &[CheckedPair<'_>], job: &Job, mut status: u8) -> u8 {
    let mut refuse = |text: String| {
        message!("not verified: {text}");
        status = NOT_CHECKED;
    };
    if pairs.iter().all(|pair| pair.report.moves == 0) {
        refuse(
            "no motion could be checked, since only the machine knows where each starts or ends: state tool lengths and \
             work offsets in a job"
                .to_owned(),
        );
        return status;
    }
    for pair in pairs {
        let CheckedPair { scope, report, .. } = pair;
        if !report.inside_known && !job.surface_only {
            refuse(format!(
                "{}: {NO_INSIDE}: repair the mesh, or check its surface alone with `--surface-only`",
                scope.body
            ));
        }
        if report.unrestricted {
            refuse(
                "`--tolerance`, `--allow` and `--resolution` allow every surface its greatest possible depth, so \
                 nothing could be found: lower them"
                    .to_owned(),
            );
        }
    }
    let parts = || pairs.iter().filter(|pair| pair.is_part);
    if !job.anyway && parts().all(|pair| pair.report.approach.is_far()) {
        refuse(
            "the program never comes within the tool's diameter of the part: check the part, its position and its \
             unit, or accept the program with `--anyway`"
                .to_owned(),
        );
    }
    let factor = parts().find_map(|pair| pair.report.approach.unit_factor);
    if let (false, Some(factor)) = (job.anyway, factor) {
        refuse(format!(
            "the positions in feed lie outside the part's box, but would fit if they were {factor} times as large: check \
             the units of part and program, or accept the program with `--anyway`"
        ));
    }
    if job.surface_only && pairs.iter().any(|pair| !pair.report.inside_known) {
        message!("{NO_INSIDE}; only its surface was checked");
    }
    status
}
