//! The part that is felt: from its file to its points.

use crate::arguments::{PartFile, Sample};
use crate::failure::Failure;
use crate::files::{Found, length};
use crate::output::refuse_inputs;
use std::path::Path;
use touchoff::certify::Facets;
use touchoff::cloud::MOST_BLUE;
use touchoff::mesh::Shape;
use touchoff::tool::Card;
use touchoff::{Cloud, CloudError, Cover, Mesh, Part, Probe, Tool, Unit};

/// What names of saved parts end in.
const SAVED: &str = "touchoff";

/// A tolerance that wants more points than this is rather proved of the triangles: to spread so many takes
/// seconds, and to ask them no less than a proof (docs/measured/certified.md).
const RATHER_PROVED: usize = 1_000_000;

/// A part, and its mesh if it has one.
pub(crate) struct Loaded {
    pub(crate) part: Part,
    pub(crate) mesh: Option<Mesh>,
    /// To what tolerance depth has to be proved, as the points do not keep it.
    pub(crate) prove: Option<f64>,
}

/// What is done about a tolerance that wants very many points.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Fine {
    /// As many points are taken as there can be.
    Points,
    /// Depth is proved of the triangles.
    Proof,
}

/// Reads a part for its triangles, which `what` is asked of.
pub(crate) fn mesh(part: &Path, unit: Unit, what: &'static str) -> Result<Mesh, Failure> {
    let file = part.display();
    let no_mesh = || Failure::NoTriangles { file: file.to_string(), what };
    if is_saved(part) {
        return Err(no_mesh());
    }
    match Shape::read(part, unit)? {
        Shape::Mesh(mesh) => {
            for finding in mesh.survey().findings() {
                say!("{file}: {finding}");
            }
            Ok(mesh)
        }
        Shape::Points(_) => Err(no_mesh()),
    }
}

/// Reads a part and takes points of it, for that tool.
pub(crate) fn load(wanted: &PartFile, card: Option<&Card>, fine: Fine) -> Result<Loaded, Failure> {
    let file = wanted.part.display();
    let no_mesh = |what| Failure::NoTriangles { file: file.to_string(), what };
    if is_saved(&wanted.part) {
        if wanted.tolerance.is_some() {
            return Err(no_mesh("--tolerance"));
        }
        let part = Part::open(&wanted.part)?.to(wanted.unit);
        return Ok(Loaded { part, mesh: None, prove: None });
    }
    match Shape::read(&wanted.part, wanted.unit)? {
        Shape::Mesh(mesh) => {
            let survey = mesh.survey();
            for finding in survey.findings() {
                say!("{file}: {finding}");
            }
            let (cloud, prove) = spread(&mesh, wanted, card, fine)?;
            Ok(Loaded { part: Part::new(&cloud, survey), mesh: Some(mesh), prove })
        }
        Shape::Points(_) if wanted.tolerance.is_some() => Err(no_mesh("--tolerance")),
        Shape::Points(points) => {
            let estimated = if points.areas.is_some() { "cover" } else { "areas and cover" };
            say!("{file}: {} points, no triangles: {estimated} estimated", points.places.len());
            let part = Part::from_cloud(&Cloud::from_points(points, wanted.unit)?);
            Ok(Loaded { part, mesh: None, prove: None })
        }
    }
}

/// What is said where a mesh does not tell what is inside.
pub(crate) const NO_INSIDE: &str = "whether the tool is inside the material is unknown: the part's mesh leaks, is \
                                    not consistently oriented, or is inside out as a whole or in a piece";

/// Refuses a part of which it is not known what is inside, unless its surface alone is asked for.
pub(crate) fn has_inside(facets: &Facets, part: &Path, surface_only: bool) -> Result<(), Failure> {
    match (facets.has_inside(), surface_only) {
        (true, _) => Ok(()),
        (false, false) => Err(Failure::NoInside { file: part.display().to_string() }),
        (false, true) => {
            say!("{}: {NO_INSIDE}; only its surface is looked at", part.display());
            Ok(())
        }
    }
}

/// Whether a file's name is that of a saved part.
fn is_saved(file: &Path) -> bool {
    file.extension().is_some_and(|extension| extension.eq_ignore_ascii_case(SAVED))
}

/// As many points as are asked for, or as the tolerance wants; and what is to be proved, if these would be
/// too many.
fn spread(
    mesh: &Mesh,
    wanted: &PartFile,
    card: Option<&Card>,
    fine: Fine,
) -> Result<(Cloud, Option<f64>), Failure> {
    let PartFile { sampling, seed, unit, .. } = *wanted;
    let some = || {
        let points = usize::try_from(wanted.points).unwrap_or(usize::MAX);
        Cloud::sample(mesh, sampling, points, seed)
    };
    let Some(tolerance) = wanted.tolerance else { return Ok((some()?, None)) };
    let steepest = match card.map(|card| (card, card.depth.lipschitz)) {
        None => 1.0,
        Some((_, Some(steepest))) if steepest > 0.0 => steepest,
        Some((card, _)) => return Err(Failure::NoSteepness(card.name.to_string())),
    };
    // What rounding takes is less than this.
    let radius = tolerance / steepest * (1.0 - 1e-6);
    let most = if fine == Fine::Proof { RATHER_PROVED } else { MOST_BLUE };
    let wants = format!(
        "a tolerance of {}: depth grows by {steepest:.4} for each length at most, so no place may be \
         farther than {} from all points",
        length(tolerance, unit),
        length(radius, unit),
    );
    match Cloud::covering(mesh, radius, sampling, most, seed) {
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

/// Says what the points know of the surface between them.
pub(crate) fn about(part: &Part, tool: Option<&dyn Tool>, unit: Unit) {
    let Some(Cover { radius, proved }) = part.tree().cover() else { return };
    let sure = if proved { "proved" } else { "estimated" };
    let deeper = match tool.map(|tool| Probe::new(part, tool).unseen()) {
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

/// Takes points of a part and saves them.
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
    let Loaded { part, .. } = load(&wanted.part, tool.map(Tool::card), Fine::Points)?;
    about(&part, tool, wanted.part.unit);
    part.save(output)?;
    say!("{}: {} points", output.display(), part.tree().len());
    Ok(())
}
