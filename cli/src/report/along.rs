//! Depth, clearance, force and niceness along a program.

use crate::failure::Failure;
use crate::timing::nanoseconds;
use crate::verify::Inputs;
use std::time::Instant;
use touchoff::certify::Certifier;
use touchoff::{Cloud, Law, Part, Probe, Sampling, SurfaceId};
use touchoff_verify::job::PairReport;
use touchoff_verify::{FindingKind, JobReport};

/// Number of positions per tool at which force and distances are computed.
const SAMPLES: usize = 2000;
/// Number of points of the part from which forces are summed.
pub(super) const POINTS: usize = 100_000;
/// Tolerance of clearances, as a fraction of the tool's size.
const CLEARANCE_TOLERANCE: f64 = 1.0 / 256.0;

/// The state at one position.
pub(super) struct Sample {
    /// Index of the position among those of the tool, from 0.
    pub(super) location: usize,
    /// Proved upper bound on the depth of the part's triangles.
    pub(super) depth: f64,
    /// Upper bound on the distance of the surfaces that do not cut from the part; `None` if all cut, or if it is unknown.
    pub(super) clearance: Option<f64>,
    /// Force of the gradient law and least niceness, if a surface that cuts touches.
    pub(super) contact: Option<(f64, f64)>,
    /// Time of the query for force and torque, in nanoseconds.
    pub(super) query_ns: u64,
    /// Time of the proof of depth, in nanoseconds.
    pub(super) proof_ns: u64,
}

/// The positions of a tool.
pub(super) struct Along {
    /// The index of the tool.
    pub(super) tool: usize,
    /// Line of each position.
    pub(super) lines: Vec<u32>,
    /// Each of so many positions has a sample.
    pub(super) stride: usize,
    pub(super) samples: Vec<Sample>,
    /// The positions at which motions with a deep finding end, with the depth found on them.
    pub(super) findings: Vec<(usize, f64)>,
}

/// Returns the points of the part from which forces are summed.
///
/// # Errors
/// If the part cannot be sampled.
pub(super) fn points(inputs: &Inputs) -> Result<Part, Failure> {
    let mesh = &inputs.bodies[0].mesh;
    Ok(Part::new(&Cloud::sample(mesh, Sampling::new(POINTS))?, mesh.diagnostics()))
}

/// Follows a tool along the program.
///
/// # Errors
/// If the tool cannot be certified.
pub(super) fn follow(
    checked: &JobReport<'_>,
    part: &Part,
    pair: &PairReport,
) -> Result<Along, Failure> {
    let tool = checked.tool(pair);
    let (unit, info) = (checked.job.unit(), tool.tool.info());
    let mut certifier = Certifier::new(checked.body(pair).bvh, tool.tool).map_err(Failure::from)?;
    let mut probe = Probe::new(part, tool.tool).with_law(Law::Gradient);
    let surfaces = || info.surfaces.iter().enumerate();
    let cuts = |id: SurfaceId| info.surface(id).cutting;
    let others: Vec<SurfaceId> =
        surfaces().filter(|(_, surface)| !surface.cutting).map(|(id, _)| SurfaceId(id)).collect();
    let reach = info.reach();
    let size = reach.high.max(-reach.low).max(info.radius()) * info.unit.factor_to(unit);
    let tolerance = size * 1e-6;
    let stride = pair.report.moves.div_ceil(SAMPLES).max(1);
    let mut along = Along {
        tool: pair.tool,
        lines: Vec::new(),
        stride,
        samples: Vec::new(),
        findings: Vec::new(),
    };
    let program = checked.job.program;
    let moves = program.moves(pair.reading, tool.motions, info.symmetry, None, unit)?;
    for (location, step) in moves.enumerate() {
        along.lines.push(u32::try_from(step.line).unwrap_or(u32::MAX));
        if location % stride != 0 {
            continue;
        }
        let pose = step.path.pose(1.0);
        let start = Instant::now();
        let wrench = probe.wrench(&pose);
        let query_ns = nanoseconds(start.elapsed());
        let start = Instant::now();
        let depth = certifier.deepest(&pose, tolerance).depth.high;
        let proof_ns = nanoseconds(start.elapsed());
        let clearance = certifier.clearance_of(&others, &pose, size * CLEARANCE_TOLERANCE);
        let clearance = clearance.ok().map(|clearance| clearance.distance.high);
        let touches = wrench.colliding > 0
            && probe.contacts(&pose).iter().any(|contact| cuts(contact.surface));
        along.samples.push(Sample {
            location,
            depth: if depth > tolerance { depth } else { 0.0 },
            clearance: clearance.filter(|distance| distance.is_finite()),
            contact: touches.then(|| (wrench.force.norm(), wrench.niceness.unwrap_or_default())),
            query_ns,
            proof_ns,
        });
    }
    along.findings = pair
        .report
        .findings
        .iter()
        .filter_map(|finding| match finding.kind {
            FindingKind::Deep { depth, .. } => Some((finding.location, depth.high)),
            _ => None,
        })
        .collect();
    Ok(along)
}
