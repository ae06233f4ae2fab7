//! Pictures of a map on its part, in a fixed set of views.

use crate::arguments::postures::Quantity;
use crate::failure::Failure;
use crate::output::file_name;
use crate::picture::{Heading, Legend, Scale, facets, sheet};
use nalgebra::Point3;
use std::collections::HashMap;
use std::path::Path;
use touchoff::{Escaped, Mesh, TriangleId};
use touchoff_postures::{Directions, MapRow, Piece, PostureMap};

/// Side of a view, in pixels.
pub(super) const SIDE: usize = 700;

/// Renders a map on its part as a PNG.
///
/// # Errors
/// If the map cannot be read, or the picture cannot be made.
pub(super) fn of(
    map: &PostureMap,
    (mesh, part): (&Mesh, &Path),
    (by, tool): (Quantity, Option<u16>),
) -> Result<Vec<u8>, Failure> {
    let (values, scale) = quantity(map, by, tool)?;
    let (corners, values) = values.pieces(mesh);
    let facets: Vec<_> = facets(corners.into_iter(), &values, &scale).collect();
    let title = format!("{}: {}", Escaped(&file_name(part)), scale.quantity);
    let heading = Heading { title, subtitle: describe(map) };
    sheet(&facets, &heading, &Legend::Scale(&scale), mesh.unit(), SIDE)
}

/// Describes the tools and the rules of a map.
pub(crate) fn describe(map: &PostureMap) -> String {
    let identity = map.identity();
    let tools: Vec<&str> = identity.tools.iter().map(|tool| &*tool.name).collect();
    let (unit, directions) = (identity.part.unit, identity.directions.len());
    let tools = format!("{}", Escaped(&tools.join(", ")));
    format!("{tools}, {directions} directions, depth up to {} {unit}", identity.rules.tolerance)
}

/// The values of a map, by the pieces of each triangle.
pub(crate) struct MapValues(Vec<HashMap<Piece, Option<f64>>>);

impl MapValues {
    /// Returns the corners of all pieces with their values. A triangle that no sweep has processed is one piece.
    fn pieces(&self, mesh: &Mesh) -> (Vec<[Point3<f64>; 3]>, Vec<Option<f64>>) {
        let pieces = mesh.ids().zip(&self.0).flat_map(|(id, pieces)| {
            let whole = pieces.is_empty().then_some((Piece::whole(id), None));
            pieces.iter().map(|(piece, value)| (*piece, *value)).chain(whole)
        });
        pieces.map(|(piece, value)| (piece.corners(mesh), value)).unzip()
    }

    /// Returns the value at a point of a triangle.
    pub(crate) fn at(&self, mesh: &Mesh, triangle: TriangleId, point: Point3<f64>) -> Option<f64> {
        let pieces = &self.0[triangle.index()];
        let contains = |piece| pieces.contains_key(&piece);
        *pieces.get(&Piece::find(contains, triangle, mesh, point))?
    }
}

/// Returns the values of a map, of one tool or of all, and their scale.
///
/// # Errors
/// If the map cannot be read.
pub(crate) fn quantity(
    map: &PostureMap,
    by: Quantity,
    tool: Option<u16>,
) -> Result<(MapValues, Scale), Failure> {
    let identity = map.identity();
    let directions = Directions::from(identity.directions.clone());
    let mut values = vec![HashMap::new(); identity.part.triangles as usize];
    map.for_each_triangle(|triangle, pieces| {
        let of = |(piece, row): (Piece, MapRow)| (piece, value(&row, &directions, (by, tool)));
        values[triangle.index()] = pieces.into_iter().map(of).collect();
        Ok::<(), Failure>(())
    })?;
    let known = values.iter().flat_map(HashMap::values).copied().flatten();
    // The scale begins at 0, except for stick-outs: the least of these is a property of the tool.
    let from_zero = by != Quantity::StickOut;
    let unit = if by == Quantity::StickOut { identity.part.unit.symbol() } else { "" };
    let of = match tool {
        Some(tool) => format!(" of {}", Escaped(&identity.tools[usize::from(tool)].name)),
        None if identity.tools.len() > 1 => " of any tool".to_owned(),
        None => String::new(),
    };
    let quantity = match by {
        Quantity::Niceness => "niceness of the best posture".to_owned(),
        Quantity::Accessibility => format!("solid angle of access{of}, steradians"),
        Quantity::StickOut => format!("least stick-out{of}, {unit}"),
    };
    let scale = Scale::new((quantity, unit), known, ("not reached", from_zero));
    Ok((MapValues(values), scale))
}

/// Returns the value shown for a piece, if it has one.
fn value(
    row: &MapRow,
    directions: &Directions,
    (by, tool): (Quantity, Option<u16>),
) -> Option<f64> {
    let mut access = row.access.iter().filter(|access| tool.is_none_or(|tool| access.tool == tool));
    match by {
        Quantity::Niceness => row.best.first().map(|best| best.niceness),
        Quantity::Accessibility => {
            // The union of the directions of all tools.
            let mut all = access.next()?.directions.clone();
            for access in access {
                all.iter_mut().zip(&access.directions).for_each(|(all, word)| *all |= word);
            }
            let angle = directions.solid_angle(&all);
            (angle > 0.0).then_some(angle)
        }
        Quantity::StickOut => access.filter_map(|access| access.stickout).reduce(f64::min),
    }
}
