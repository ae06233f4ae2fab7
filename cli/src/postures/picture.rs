//! Pictures on a part, in a fixed set of views: of a map, and of the points that a path leaves out.

use crate::arguments::postures::Quantity;
use crate::failure::Failure;
use crate::output::file_name;
use crate::picture::render::{Facet, Paint};
use crate::picture::{Heading, Legend, Measure, NOTHING, Scale, facets, sheet};
use nalgebra::{Point3, Vector3};
use std::collections::HashMap;
use std::path::Path;
use touchoff::{Escaped, Mesh, TriangleId};
use touchoff_postures::path::{LeftOutReason, ToolPath};
use touchoff_postures::{Directions, MapRow, Piece, PostureMap};

/// Side of a view, in pixels.
const SIDE: usize = 700;

/// A quantity of a map.
#[derive(Clone, Copy)]
pub(crate) struct MapQuantity {
    pub(crate) by: Quantity,
    /// Index of the tool whose quantity it is; `None` for all of them.
    pub(crate) tool: Option<u16>,
}

/// Renders a map on its part as a PNG.
///
/// # Errors
/// If the map cannot be read, or the picture cannot be made.
pub(super) fn of_map(
    map: &PostureMap,
    mesh: &Mesh,
    part: &Path,
    quantity: MapQuantity,
) -> Result<Vec<u8>, Failure> {
    let (values, scale) = quantity.values(map)?;
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
        *pieces.get(&Piece::find(|piece| pieces.contains_key(&piece), triangle, mesh, point))?
    }
}

impl MapQuantity {
    /// Returns the values of a map, and their scale.
    ///
    /// # Errors
    /// If the map cannot be read.
    pub(crate) fn values(self, map: &PostureMap) -> Result<(MapValues, Scale), Failure> {
        let identity = map.identity();
        let directions = Directions::from(identity.directions.clone());
        let mut values = vec![HashMap::new(); identity.part.triangles as usize];
        map.for_each_triangle(|triangle, pieces| {
            let pieces =
                pieces.into_iter().map(|(piece, row)| (piece, self.value(&row, &directions)));
            values[triangle.index()] = pieces.collect();
            Ok::<(), Failure>(())
        })?;
        let known = values.iter().flat_map(HashMap::values).copied().flatten();
        let unit = if self.by == Quantity::StickOut { identity.part.unit.symbol() } else { "" };
        let of = match self.tool {
            Some(tool) => format!(" of {}", Escaped(&identity.tools[usize::from(tool)].name)),
            None if identity.tools.len() > 1 => " of any tool".to_owned(),
            None => String::new(),
        };
        let measure = Measure {
            quantity: match self.by {
                Quantity::Niceness => "niceness of the best posture".to_owned(),
                Quantity::Accessibility => format!("solid angle of access{of}, steradians"),
                Quantity::StickOut => format!("least stick-out{of}, {unit}"),
            },
            unit,
            // The least stick-out of all is a property of the tool, and far from 0.
            from_zero: self.by != Quantity::StickOut,
            nothing: "not reached",
        };
        let scale = Scale::new(measure, known);
        Ok((MapValues(values), scale))
    }

    /// Returns the value shown for a piece, if it has one.
    fn value(self, row: &MapRow, directions: &Directions) -> Option<f64> {
        let mut access =
            row.access.iter().filter(|access| self.tool.is_none_or(|tool| access.tool == tool));
        match self.by {
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
}

/// Colours of points that are not reached, and of those without a proved motion.
const NOT_REACHED: [u8; 3] = [204, 60, 50];
const NO_MOTION: [u8; 3] = [40, 90, 200];

/// Radius of a point, as a fraction of the part's diagonal.
const RADIUS: f64 = 0.004;

/// Draws a part with the points that a path over it leaves out, as a PNG.
///
/// # Errors
/// If the picture cannot be made.
pub(super) fn of_left_out(
    mesh: &Mesh,
    part: &Path,
    tool: &str,
    path: &ToolPath,
) -> Result<Vec<u8>, Failure> {
    let plain =
        mesh.ids().map(|id| Facet { corners: mesh.triangle(id), paint: Paint::Plain(NOTHING) });
    let [low, high] = mesh.bounds();
    let radius = RADIUS * (high - low).norm();
    let points = path.left_out.iter().flat_map(|left_out| {
        let paint = Paint::Value(match left_out.reason {
            LeftOutReason::NotReached => NOT_REACHED,
            LeftOutReason::NoMotion => NO_MOTION,
        });
        octahedron(left_out.point, radius).map(|corners| Facet { corners, paint })
    });
    let facets: Vec<Facet> = plain.chain(points).collect();
    let [not_reached, no_motion] = [LeftOutReason::NotReached, LeftOutReason::NoMotion]
        .map(|reason| path.count_left_out(reason));
    let keys = [
        (NOT_REACHED, format!("not reached: {not_reached} points")),
        (NO_MOTION, format!("without a proved motion: {no_motion} points")),
        (NOTHING, "the part".to_owned()),
    ];
    let heading = Heading {
        title: format!("{}: points left out by the path", Escaped(&file_name(part))),
        subtitle: format!("{}", Escaped(tool)),
    };
    sheet(&facets, &heading, &Legend::Keys(&keys), mesh.unit(), SIDE)
}

/// Returns the triangles of an octahedron.
fn octahedron(centre: Point3<f64>, radius: f64) -> [[Point3<f64>; 3]; 8] {
    std::array::from_fn(|octant| {
        [0, 1, 2].map(|axis| {
            let side = if octant >> axis & 1 == 0 { radius } else { -radius };
            centre + Vector3::ith(axis, side)
        })
    })
}
