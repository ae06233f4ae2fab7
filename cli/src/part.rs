//! The part: from its file to its points.

use crate::arguments::{PartFile, Sample};
use crate::failure::Failure;
use crate::files::{Found, length};
use crate::output::refuse_inputs;
use std::path::Path;
use touchoff::certify::TriangleBvh;
use touchoff::cloud::MAX_BLUE_NOISE_POINTS;
use touchoff::mesh::Geometry;
use touchoff::tool::ToolInfo;
use touchoff::{Cloud, CloudError, CoveringRadius, Mesh, Part, Probe, Tool, Unit};

/// The file extension of saved parts.
const SAVED: &str = "touchoff";

/// Number of points above which a tolerance is rather proved of the triangles: sampling that many takes seconds,
/// and querying them no less time than a proof (docs/measured/certified.md).
const RATHER_PROVED: usize = 1_000_000;

/// A part, and its mesh if it has one.
pub(crate) struct Loaded {
    pub(crate) part: Part,
    pub(crate) mesh: Option<Mesh>,
    /// The tolerance to which depth has to be proved, if the points do not meet it.
    pub(crate) prove: Option<f64>,
}

/// Handling of a tolerance that needs very many points.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Fine {
    /// Samples up to the largest possible number of points.
    Points,
    /// Proves depth of the triangles.
    Proof,
}

/// Reads the triangles of a part for the request `what`.
///
/// # Errors
/// [`Failure::NoTriangles`] if the file has none.
pub(crate) fn mesh(part: &Path, unit: Unit, what: &'static str) -> Result<Mesh, Failure> {
    let file = part.display();
    let no_mesh = || Failure::NoTriangles { file: file.to_string(), what };
    if is_saved(part) {
        return Err(no_mesh());
    }
    match Geometry::read(part, unit)? {
        Geometry::Mesh(mesh) => {
            for finding in mesh.diagnostics().findings() {
                say!("{file}: {finding}");
            }
            Ok(mesh)
        }
        Geometry::Points(_) => Err(no_mesh()),
    }
}

/// Reads a part and samples its points, for that tool.
pub(crate) fn load(
    wanted: &PartFile,
    info: Option<&ToolInfo>,
    fine: Fine,
) -> Result<Loaded, Failure> {
    let file = wanted.part.display();
    let no_mesh = |what| Failure::NoTriangles { file: file.to_string(), what };
    if is_saved(&wanted.part) {
        if wanted.tolerance.is_some() {
            return Err(no_mesh("--tolerance"));
        }
        let part = Part::open(&wanted.part)?.converted_to(wanted.unit);
        return Ok(Loaded { part, mesh: None, prove: None });
    }
    match Geometry::read(&wanted.part, wanted.unit)? {
        Geometry::Mesh(mesh) => {
            let survey = mesh.diagnostics();
            for finding in survey.findings() {
                say!("{file}: {finding}");
            }
            let (cloud, prove) = spread(&mesh, wanted, info, fine)?;
            Ok(Loaded { part: Part::new(&cloud, survey), mesh: Some(mesh), prove })
        }
        Geometry::Points(_) if wanted.tolerance.is_some() => Err(no_mesh("--tolerance")),
        Geometry::Points(points) => {
            let estimated = if points.areas.is_some() { "cover" } else { "areas and cover" };
            say!("{file}: {} points, no triangles: {estimated} estimated", points.places.len());
            let part = Part::from_cloud(&Cloud::from_points(points, wanted.unit)?);
            Ok(Loaded { part, mesh: None, prove: None })
        }
    }
}

/// The message for a mesh that does not determine its inside.
pub(crate) const NO_INSIDE: &str = "whether the tool is inside the material is unknown: the part's mesh leaks, is \
                                    not consistently oriented, or is inside out as a whole or in a piece";

/// Refuses a part whose inside is unknown, unless only its surface is requested.
///
/// # Errors
/// [`Failure::NoInside`].
pub(crate) fn has_inside(
    bvh: &TriangleBvh,
    part: &Path,
    surface_only: bool,
) -> Result<(), Failure> {
    match (bvh.has_inside(), surface_only) {
        (true, _) => Ok(()),
        (false, false) => Err(Failure::NoInside { file: part.display().to_string() }),
        (false, true) => {
            say!("{}: {NO_INSIDE}; only its surface is looked at", part.display());
            Ok(())
        }
    }
}

/// Returns whether a file's name is that of a saved part.
fn is_saved(file: &Path) -> bool {
    file.extension().is_some_and(|extension| extension.eq_ignore_ascii_case(SAVED))
}

/// Samples as many points as requested, or as the tolerance needs. Returns the tolerance that is to be proved if
/// these would be too many.
fn spread(
    mesh: &Mesh,
    wanted: &PartFile,
    info: Option<&ToolInfo>,
    fine: Fine,
) -> Result<(Cloud, Option<f64>), Failure> {
    let PartFile { sampling, seed, unit, .. } = *wanted;
    let some = || {
        let points = usize::try_from(wanted.points).unwrap_or(usize::MAX);
        Cloud::sample(mesh, sampling, points, seed)
    };
    let Some(tolerance) = wanted.tolerance else { return Ok((some()?, None)) };
    let steepest = match info.map(|info| (info, info.depth.lipschitz)) {
        None => 1.0,
        Some((_, Some(steepest))) if steepest > 0.0 => steepest,
        Some((info, _)) => return Err(Failure::NoSteepness(info.name.to_string())),
    };
    // The margin is larger than the effect of rounding.
    let radius = tolerance / steepest * (1.0 - 1e-6);
    let most = if fine == Fine::Proof { RATHER_PROVED } else { MAX_BLUE_NOISE_POINTS };
    let wants = format!(
        "a tolerance of {}: depth grows by {steepest:.4} for each length at most, so no place may be \
         farther than {} from all points",
        length(tolerance, unit),
        length(radius, unit),
    );
    match Cloud::with_covering_radius(mesh, radius, sampling, most, seed) {
        Ok(cloud) => {
            say!("{wants}: {} points", cloud.len());
            Ok((cloud, None))
        }
        Err(CloudError::TooFine { needed, .. }) if fine == Fine::Proof => {
            let cloud = some()?;
            say!(
                "{wants}, which takes some {needed:.0e} points: depth is proved of the triangles instead, \
                 force is that of {} points",
                cloud.len(),
            );
            Ok((cloud, Some(tolerance)))
        }
        Err(error) => Err(error.into()),
    }
}

/// Prints the covering radius of the points and the sampling error for a tool.
pub(crate) fn about(part: &Part, tool: Option<&dyn Tool>, unit: Unit) {
    let Some(CoveringRadius { radius, proved }) = part.tree().covering_radius() else { return };
    let sure = if proved { "proved" } else { "estimated" };
    let deeper = match tool.map(|tool| Probe::new(part, tool).sampling_error_bound()) {
        Some(Some(unseen)) => {
            format!(": the surface is no more than {} deeper than found", length(unseen, unit))
        }
        Some(None) => ": how much deeper it is than found is not known for this tool".to_owned(),
        None => String::new(),
    };
    say!(
        "no place of the surface is farther than {} from all points ({sure}){deeper}",
        length(radius, unit)
    );
}

/// Samples points of a part and saves them.
pub(crate) fn sample(wanted: &Sample) -> Result<(), Failure> {
    let tool = wanted.tool.as_deref().map(Path::new);
    refuse_inputs([&*wanted.output], std::iter::once(&*wanted.part.part).chain(tool))?;
    let found = match &wanted.tool {
        Some(name) => Some(Found::find(name, &wanted.given)?),
        None if wanted.given.is_none() => None,
        None => return Err(Failure::NothingToSet("name one with `--tool`")),
    };
    let tool = found.as_ref().map(Found::tool);
    let output = &wanted.output;
    if !is_saved(output) {
        let (file, better) = (output.display().to_string(), output.with_extension(SAVED));
        return Err(Failure::SavedName { file, better });
    }
    let Loaded { part, .. } = load(&wanted.part, tool.map(Tool::info), Fine::Points)?;
    about(&part, tool, wanted.part.unit);
    part.save(output)?;
    say!("{}: {} points", output.display(), part.tree().len());
    Ok(())
}
