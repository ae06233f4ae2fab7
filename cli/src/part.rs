//! The part that is felt: from its file to its points.

use crate::arguments::PartFile;
use crate::failure::Failure;
use crate::files::length;
use touchoff::mesh::Shape;
use touchoff::tool::Card;
use touchoff::{Cloud, Cover, Mesh, Part, Probe, Tool, Unit};

/// A part, and its mesh if it has one.
pub(crate) struct Loaded {
    pub(crate) part: Part,
    pub(crate) mesh: Option<Mesh>,
}

/// Reads a part and takes points of it, for that tool.
pub(crate) fn load(wanted: &PartFile, card: &Card) -> Result<Loaded, Failure> {
    let file = wanted.part.display();
    match Shape::read(&wanted.part, wanted.unit)? {
        Shape::Mesh(mesh) => {
            let survey = mesh.survey();
            for finding in survey.findings() {
                say!("{file}: {finding}");
            }
            let cloud = spread(&mesh, wanted, card)?;
            Ok(Loaded { part: Part::new(&cloud, survey), mesh: Some(mesh) })
        }
        Shape::Points(points) if wanted.tolerance.is_none() => {
            let estimated =
                if points.areas.is_some() { "their cover is" } else { "areas and cover are" };
            say!("{file}: {} points without triangles: {estimated} estimated", points.places.len());
            let cloud = Cloud::from_points(points, wanted.unit)?;
            Ok(Loaded { part: Part::from_cloud(&cloud), mesh: None })
        }
        Shape::Points(_) => {
            Err(Failure::NoTriangles { file: file.to_string(), what: "--tolerance" })
        }
    }
}

/// As many points as are asked for, or as the tolerance wants.
fn spread(mesh: &Mesh, wanted: &PartFile, card: &Card) -> Result<Cloud, Failure> {
    let PartFile { sampling, seed, unit, .. } = *wanted;
    let Some(tolerance) = wanted.tolerance else {
        let points = usize::try_from(wanted.points).unwrap_or(usize::MAX);
        return Ok(Cloud::sample(mesh, sampling, points, seed)?);
    };
    let Some(steepest) = card.depth.lipschitz else {
        return Err(Failure::NoSteepness(card.name.to_string()));
    };
    let radius = tolerance / steepest;
    let cloud = Cloud::covering(mesh, radius, sampling, seed)?;
    say!(
        "a tolerance of {}: depth grows by {steepest:.4} at most for each length, so no place may be \
         farther than {} from all points: {} points",
        length(tolerance, unit),
        length(radius, unit),
        cloud.len(),
    );
    Ok(cloud)
}

/// What the points know of the surface between them.
pub(crate) fn about(part: &Part, tool: &dyn Tool, unit: Unit) {
    let Some(Cover { radius, proved }) = part.tree().cover() else { return };
    let sure = if proved { "proved" } else { "estimated" };
    let deeper = match Probe::new(part, tool).unseen() {
        Some(unseen) => {
            format!("the surface is no more than {} deeper than found", length(unseen, unit))
        }
        None => "how much deeper it is than found is not known for this tool".to_owned(),
    };
    say!(
        "no place of the surface is farther than {} from all points ({sure}): {deeper}",
        length(radius, unit)
    );
}
