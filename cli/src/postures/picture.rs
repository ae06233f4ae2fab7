//! Pictures of a map on its part, in a fixed set of views.

use crate::arguments::postures::Quantity;
use crate::failure::Failure;
use crate::lengths::format_number;
use crate::picture::{Heading, Legend, Scale, facets, sheet};
use std::path::Path;
use touchoff::postures::{Directions, MapRow, PostureMap};
use touchoff::{Escaped, Mesh, Unit};

/// Side of a view, in pixels.
pub(super) const SIDE: usize = 700;

/// Renders a map on its part as a PNG.
///
/// # Errors
/// If the map cannot be read, or the picture cannot be made.
pub(super) fn of(
    map: &PostureMap,
    (mesh, part): (&Mesh, &Path),
    by: Quantity,
) -> Result<Vec<u8>, Failure> {
    let (values, scale) = quantity(map, by)?;
    let triangles = mesh.ids().map(|id| mesh.triangle(id));
    let facets: Vec<_> = facets(triangles, &values, &scale).collect();
    let title = format!("{}: {}", Escaped(&file_name(part)), scale.quantity);
    let heading = Heading { title, subtitle: describe(map) };
    sheet(&facets, (&heading, &Legend::Scale(&scale)), mesh.unit(), SIDE)
}

/// Returns the last part of a path.
pub(super) fn file_name(file: &Path) -> String {
    file.file_name().unwrap_or(file.as_os_str()).to_string_lossy().into_owned()
}

/// Describes the tools and the rules of a map.
pub(crate) fn describe(map: &PostureMap) -> String {
    let identity = map.identity();
    let tools: Vec<&str> = identity.tools.iter().map(|tool| &*tool.name).collect();
    let (unit, directions) = (identity.part.unit, identity.directions.len());
    let tools = format!("{}", Escaped(&tools.join(", ")));
    format!("{tools}, {directions} directions, depth up to {} {unit}", identity.rules.tolerance)
}

/// Returns the value of each triangle of a map, and the scale of all values.
///
/// # Errors
/// If the map cannot be read.
pub(crate) fn quantity(
    map: &PostureMap,
    by: Quantity,
) -> Result<(Vec<Option<f64>>, Scale), Failure> {
    let directions = Directions::from(map.identity().directions.clone());
    let mut values = vec![None; map.identity().part.triangles as usize];
    for entry in map.rows()? {
        let (triangle, row) = entry?;
        values[triangle.index()] = value(&row, &directions, by);
    }
    let known = || values.iter().copied().flatten();
    let (low, high) = (known().fold(f64::INFINITY, f64::min), known().fold(0.0, f64::max));
    // The scale begins at 0, except for stick-outs: the least of these is a property of the tool.
    let low = if by == Quantity::StickOut { low.min(high) } else { 0.0 };
    let (quantity, ends) = label(by, [low, high], map.identity().part.unit);
    let has_values = known().count() > 0;
    let scale = Scale { quantity, range: [low, high], ends, nothing: "not reached", has_values };
    Ok((values, scale))
}

/// Returns the value shown for a triangle, if it has one.
fn value(row: &MapRow, directions: &Directions, by: Quantity) -> Option<f64> {
    match by {
        Quantity::Niceness => row.best.first().map(|best| best.niceness),
        Quantity::Accessibility => {
            // The union of the directions of all tools.
            let mut all = vec![0u64; row.access.first()?.directions.len()];
            for access in &row.access {
                all.iter_mut().zip(&access.directions).for_each(|(all, word)| *all |= word);
            }
            let angle = directions.solid_angle(&all);
            (angle > 0.0).then_some(angle)
        }
        Quantity::StickOut => {
            let stickouts = row.access.iter().filter_map(|access| access.stickout);
            stickouts.reduce(f64::min)
        }
    }
}

/// Returns the name of a quantity with its unit, and the ends of its scale.
fn label(by: Quantity, ends: [f64; 2], unit: Unit) -> (String, [String; 2]) {
    match by {
        Quantity::Niceness => {
            ("niceness of the best posture (0 to 1)".to_owned(), ends.map(|v| format!("{v:.3}")))
        }
        Quantity::Accessibility => {
            ("solid angle of access, steradians".to_owned(), ends.map(|v| format!("{v:.2}")))
        }
        Quantity::StickOut => (
            format!("least stick-out, {unit}"),
            ends.map(|value| format!("{} {unit}", format_number(value, unit))),
        ),
    }
}
