//! Loads a part from its file: a mesh to sample, points, or a saved part; and the command `touchoff sample`.

use crate::arguments::{PartFile, Sample};
use crate::failure::Failure;
use crate::loaded_tool::LoadedTool;
use crate::output::refuse_inputs;
use crate::progress::Progress;
use std::path::Path;
use touchoff::certify::TriangleBvh;
use touchoff::cloud::MAX_BLUE_NOISE_POINTS;
use touchoff::mesh::Geometry;
use touchoff::tool::ToolInfo;
use touchoff::{Cloud, CloudError, CoveringRadius, Mesh, Part, Probe, Sampling, Tool, Unit};
use touchoff_verify::job::NO_INSIDE;

/// The file extension of saved parts.
const SAVED: &str = "touchoff";

/// Number of points above which `run` certifies depth instead: sampling more takes seconds, and queries take about as
/// long as certified ones (docs/accuracy.md).
const MAX_POINTS_OF_RUN: usize = 1_000_000;

/// A part, and its mesh if it has one.
pub(crate) struct LoadedPart {
    pub(crate) part: Part,
    pub(crate) mesh: Option<Mesh>,
    /// Tolerance of certified depth, in the part's unit, if the sampling error needs too many points.
    pub(crate) certify: Option<f64>,
    /// Set unless it has points whose outer side is unknown.
    pub(crate) has_normals: bool,
}

/// Handling of a sampling error that needs very many points.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum DenseSampling {
    /// Samples up to the largest possible number of points.
    Sample,
    /// Certifies the depth of the triangles.
    Certify,
}

/// Reads the triangles of a part for the request `what`.
///
/// # Errors
/// [`Failure::NoTriangles`] if the file has none.
pub(crate) fn mesh(part: &Path, unit: Unit, what: &'static str) -> Result<Mesh, Failure> {
    if !is_saved(part)
        && let Geometry::Mesh(mesh) = read_geometry(part, unit)?
    {
        return Ok(mesh);
    }
    Err(no_triangles(part, what))
}

/// Returns the failure for a request that needs triangles.
pub(crate) fn no_triangles(part: &Path, what: &'static str) -> Failure {
    Failure::NoTriangles { file: part.display().to_string(), what }
}

/// Reads a file of triangles or points, and prints the findings about a mesh.
fn read_geometry(part: &Path, unit: Unit) -> Result<Geometry, Failure> {
    let geometry = Geometry::read(part, unit)?;
    if let Geometry::Mesh(mesh) = &geometry {
        print_findings(part, mesh, true);
    }
    Ok(geometry)
}

/// Prints the findings about a mesh, and those of a mesh without irregularities if `verbose` is set.
pub(crate) fn print_findings(file: &Path, mesh: &Mesh, verbose: bool) {
    let findings = mesh.diagnostics().findings();
    // The first says what kind of mesh it is.
    for finding in findings.iter().filter(|_| verbose || findings.len() > 1) {
        message!("{}: {finding}", file.display());
    }
}

/// Prints the finding about the normals of a part that has no mesh.
fn print_normals(file: &Path, part: &Part) {
    if part.diagnostics().is_none() {
        for finding in part.findings() {
            message!("{}: {finding}", file.display());
        }
    }
}

/// Reads a part and samples its points. `--sampling-error` bounds the error of depth for the tool `info`; without a
/// tool, for every tool whose depth is a distance (L = 1). `json` suppresses the progress display.
pub(crate) fn load(
    arguments: &PartFile,
    info: Option<&ToolInfo>,
    dense: DenseSampling,
    json: bool,
) -> Result<LoadedPart, Failure> {
    let file = arguments.part.display();
    if is_saved(&arguments.part) {
        if arguments.sampling_error.is_some() {
            return Err(no_triangles(&arguments.part, "--sampling-error"));
        }
        let part = Part::open(&arguments.part)?.converted_to(arguments.unit);
        print_normals(&arguments.part, &part);
        return Ok(LoadedPart { part, mesh: None, certify: None, has_normals: true });
    }
    match read_geometry(&arguments.part, arguments.unit)? {
        Geometry::Mesh(mesh) => {
            let (cloud, certify) = sample_cloud(&mesh, arguments, info, dense, json)?;
            let part = Part::new(&cloud, mesh.diagnostics());
            Ok(LoadedPart { part, mesh: Some(mesh), certify, has_normals: true })
        }
        Geometry::Points(_) if arguments.sampling_error.is_some() => {
            Err(no_triangles(&arguments.part, "--sampling-error"))
        }
        Geometry::Points(points) => {
            let estimated = if points.areas.is_some() {
                "covering radius"
            } else {
                "areas and covering radius"
            };
            message!(
                "{file}: {} points without triangles: {estimated} are estimated",
                points.points.len()
            );
            if points.left_out > 0 {
                let count = points.left_out;
                message!("{file}: {count} points without coordinates (NaN) are left out");
            }
            let has_normals = !points.normals.is_empty();
            // Depth, and the directions of the tool, need none: `run` alone is content with them.
            let cloud = match has_normals || dense != DenseSampling::Certify {
                true => Cloud::from_points(points, arguments.unit)?,
                false => {
                    message!(
                        "{file}: the points have no normals: forces are along the directions of the tool"
                    );
                    Cloud::from_points_without_normals(points, arguments.unit)?
                }
            };
            let part = Part::from_cloud(&cloud);
            if has_normals {
                print_normals(&arguments.part, &part);
            }
            Ok(LoadedPart { part, mesh: None, certify: None, has_normals })
        }
    }
}

/// Fails for a part whose inside is undefined; with `surface_only` prints a warning instead.
///
/// # Errors
/// [`Failure::NoInside`].
pub(crate) fn require_inside(
    bvh: &TriangleBvh,
    part: &Path,
    surface_only: bool,
) -> Result<(), Failure> {
    match (bvh.has_inside(), surface_only) {
        (true, _) => Ok(()),
        (false, false) => Err(Failure::NoInside { file: part.display().to_string() }),
        (false, true) => {
            message!("{}: {NO_INSIDE}; only its surface is checked", part.display());
            Ok(())
        }
    }
}

/// Returns whether a file's name is that of a saved part.
fn is_saved(file: &Path) -> bool {
    file.extension().is_some_and(|extension| extension.eq_ignore_ascii_case(SAVED))
}

/// Samples as many points as requested, or as the sampling error needs. If these are too many to sample, samples the
/// default number and returns the tolerance of certified depth.
fn sample_cloud(
    mesh: &Mesh,
    arguments: &PartFile,
    info: Option<&ToolInfo>,
    dense: DenseSampling,
    json: bool,
) -> Result<(Cloud, Option<f64>), Failure> {
    let PartFile { sampling: method, seed, unit, .. } = *arguments;
    let points = usize::try_from(arguments.points).unwrap_or(usize::MAX);
    let by_number = Sampling { count: points, method, seed };
    let Some(error) = arguments.sampling_error else {
        let _progress = Progress::spinner("sampling", json);
        return Ok((Cloud::sample(mesh, by_number)?, None));
    };
    let lipschitz = match info.map(|info| (info, info.depth.lipschitz)) {
        None => 1.0,
        Some((_, Some(lipschitz))) if lipschitz > 0.0 => lipschitz,
        Some((info, _)) => return Err(Failure::NoLipschitz(info.name.to_string())),
    };
    // Leaves room for the rounding error bound that `Probe::sampling_error_bound` adds. If points are very uneven, that
    // bound may be larger than the room, and the printed bound then exceeds the requested error by the difference.
    let radius = error / lipschitz * (1.0 - 1e-6);
    let max_points =
        if dense == DenseSampling::Certify { MAX_POINTS_OF_RUN } else { MAX_BLUE_NOISE_POINTS };
    let reason = format!(
        "a sampling error of {} needs a sample within {} of every point of the surface (L = {lipschitz:.4})",
        unit.format(error),
        unit.format(radius),
    );
    let progress = Progress::spinner("sampling", json);
    let sampling = Sampling { count: max_points, method, seed };
    let cloud = Cloud::with_covering_radius(mesh, radius, sampling);
    drop(progress);
    match cloud {
        Ok(cloud) => {
            message!("{reason}: {} points", cloud.len());
            Ok((cloud, None))
        }
        Err(CloudError::TooFine { needed, .. }) if dense == DenseSampling::Certify => {
            let progress = Progress::spinner("sampling", json);
            let cloud = Cloud::sample(mesh, by_number)?;
            drop(progress);
            message!(
                "{reason}, and so about {needed:.0e} points: depth is certified on the triangles instead, and \
                 force is computed at {} points",
                cloud.len(),
            );
            Ok((cloud, Some(error)))
        }
        Err(failure) => Err(failure.into()),
    }
}

/// Prints the covering radius, and the sampling error bound for a tool. Prints nothing if the radius is unknown.
pub(crate) fn print_covering_radius(part: &Part, tool: Option<&dyn Tool>, unit: Unit) {
    let Some(CoveringRadius { radius, proved, .. }) = part.tree().covering_radius() else { return };
    let status = if proved { "proved" } else { "estimated" };
    let bound = match tool.map(|tool| Probe::new(part, tool).sampling_error_bound()) {
        Some(Some(error)) => {
            format!(": the true depth exceeds the reported one by at most {}", unit.format(error))
        }
        Some(None) => ": no bound on the error of depth is proved for this tool".to_owned(),
        None => String::new(),
    };
    message!(
        "every point of the surface is within {} of a sample ({status}){bound}",
        unit.format(radius)
    );
}

/// Samples points of a part and saves them.
pub(crate) fn sample(arguments: &Sample, json: bool) -> Result<(), Failure> {
    let tool = arguments.tool.as_deref().map(Path::new);
    let inputs = std::iter::once(&*arguments.part.part).chain(tool);
    refuse_inputs([&*arguments.output], inputs.chain(arguments.params.library.as_deref()))?;
    let loaded = match &arguments.tool {
        Some(name) => Some(LoadedTool::load(name, &arguments.params)?),
        None if arguments.params.is_empty() => None,
        None => return Err(Failure::UnusedParams("name one with `--tool FILE.tool`")),
    };
    let tool = loaded.as_ref().map(LoadedTool::tool);
    let output = &arguments.output;
    if !is_saved(output) {
        return Err(Failure::extension("a saved part ends in `.touchoff`", output, SAVED));
    }
    let LoadedPart { part, .. } =
        load(&arguments.part, tool.map(Tool::info), DenseSampling::Sample, json)?;
    print_covering_radius(&part, tool, arguments.part.unit);
    part.save(output)?;
    message!("{}: {} points", output.display(), part.tree().len());
    Ok(())
}
