//! The values that colour the triangles of a body.

use super::body::{Shown, normal};
use crate::failure::Failure;
use crate::picture::Scale;
use crate::postures::picture::MapValues;
use nalgebra::Point3;
use std::collections::HashMap;
use touchoff::{Cloud, Escaped, Mesh, Part, Probe, TriangleId, Unit};
use touchoff_verify::job::CutStock;
use touchoff_verify::stock::PartComparison;
use touchoff_verify::{FindingKind, JobReport};

/// A quantity on a body as it is shown.
pub(super) struct Layer {
    /// The index of the body.
    pub(super) body: usize,
    pub(super) scale: Scale,
    /// The value of each triangle, if it has one.
    pub(super) values: Vec<Option<f64>>,
}

/// Returns the depth of the deepest finding at each triangle of a body: at its centre, near its corners, and at the
/// deepest points of findings.
///
/// # Errors
/// If the points of the body cannot be made ready for queries.
pub(super) fn depths(
    checked: &JobReport<'_>,
    index: usize,
    shown: &Shown,
) -> Result<Layer, Failure> {
    let mut values = vec![None; shown.triangles.len()];
    let mut include = |triangle: usize, depth: f64| {
        let value: &mut Option<f64> = &mut values[triangle];
        *value = Some(value.map_or(depth, |known| known.max(depth)));
    };
    let part = Part::from_cloud(&cloud(shown)?);
    let pairs = checked.pairs.iter().filter(|pair| pair.body == index);
    for pair in pairs.filter(|pair| !pair.report.findings.is_empty()) {
        let mut probe = Probe::new(&part, checked.tool(pair).tool);
        for finding in &pair.report.findings {
            let FindingKind::Deep { surface, allowed, depth, witness, .. } = finding.kind else {
                continue;
            };
            for contact in probe.contacts(&finding.pose) {
                if contact.surface == surface && contact.depth > allowed {
                    include(contact.triangle.index(), contact.depth);
                }
            }
            if let Some(piece) = piece(shown, witness.triangle, &witness.point) {
                include(piece, depth.low);
            }
        }
    }
    let place = if index == 0 { String::new() } else { format!(" in {}", Escaped(&shown.name)) };
    let quantity = format!("depth of the deepest finding{place}, {}", shown.unit);
    let scale = scale_of_lengths(quantity, "no finding", &values, shown.unit);
    Ok(Layer { body: index, scale, values })
}

/// Returns points of the triangles: their centres, and points near their corners.
fn cloud(shown: &Shown) -> Result<Cloud, Failure> {
    let (mut points, mut normals) = (Vec::new(), Vec::new());
    let (mut triangles, mut areas) = (Vec::new(), Vec::new());
    for (id, corners) in (0..).map(TriangleId).zip(shown.corners()) {
        let Some(normal) = normal(corners) else { continue };
        let [a, b, c] = corners;
        let centre = a + ((b - a) + (c - a)) / 3.0;
        let area = 0.5 * (b - a).cross(&(c - a)).norm();
        let near = corners.map(|corner| corner + (centre - corner) / 16.0);
        for point in near.into_iter().chain([centre]) {
            points.push(point);
            normals.push(normal);
            triangles.push(id);
            areas.push(0.25 * area);
        }
    }
    Ok(Cloud::new(points, normals, triangles, areas, shown.unit)?)
}

/// Returns the piece of a triangle of the file whose centre is the nearest to a point.
fn piece(shown: &Shown, source: TriangleId, point: &Point3<f64>) -> Option<usize> {
    let first = shown.sources.partition_point(|known| *known < source.0);
    let pieces = first..shown.sources.partition_point(|known| *known <= source.0);
    let distance = |piece: &usize| {
        let [a, b, c] = shown.triangles[*piece].map(|vertex| shown.vertices[vertex as usize]);
        (a.coords + b.coords + c.coords - 3.0 * point.coords).norm_squared()
    };
    pieces.min_by(|one, other| distance(one).total_cmp(&distance(other)))
}

/// Returns a scale of lengths from 0 to the greatest value.
fn scale_of_lengths(
    quantity: String,
    nothing: &'static str,
    values: &[Option<f64>],
    unit: Unit,
) -> Scale {
    let known = values.iter().copied().flatten();
    Scale::new((quantity, unit.symbol()), known, (nothing, true))
}

/// Returns the values of a map at the centres of the pieces of a body's triangles.
pub(super) fn of_map(
    index: usize,
    shown: &Shown,
    mesh: &Mesh,
    values: &MapValues,
    scale: Scale,
) -> Layer {
    let pieces = shown.corners().zip(&shown.sources);
    let values = pieces.map(|([a, b, c], source)| {
        let centre = Point3::from((a.coords + b.coords + c.coords) / 3.0);
        values.at(mesh, TriangleId(*source), centre)
    });
    Layer { body: index, values: values.collect(), scale }
}

/// Number of triangles above which what remains of the stock is not shown.
const MAX_STOCK_TRIANGLES: usize = 300_000;

/// Returns what remains of the stock as a body, coloured by its distance from the finished part; `None` if nothing remains,
/// or if its surface has too many triangles.
///
/// # Errors
/// If the stock cannot be compared with the part.
pub(super) fn stock(
    cut: &CutStock,
    comparison: &PartComparison,
    index: usize,
) -> Result<Option<(Shown, Layer)>, Failure> {
    if cut.stock.is_empty() {
        return Ok(None);
    }
    let mesh = cut.stock.remaining_mesh()?;
    if mesh.triangles().len() > MAX_STOCK_TRIANGLES {
        return Ok(None);
    }
    let unit = mesh.unit();
    let spacing = cut.stock.spacing();
    // The nodes of the lattice are far enough apart for keys of a quarter of the spacing.
    let key = |point: Point3<f64>| {
        let [x, y, z]: [f64; 3] = (point.coords * (4.0 / spacing)).into();
        [x, y, z].map(|part| part.round() as i64)
    };
    let near = |point: Point3<f64>| {
        let [x, y, z] = key(point);
        let around = [-1, 0, 1];
        around.into_iter().flat_map(move |i| {
            around.into_iter().flat_map(move |j| around.map(move |k| [x + i, y + j, z + k]))
        })
    };
    let excess: HashMap<[i64; 3], f64> =
        comparison.excess.iter().map(|point| (key(point.point), point.distance)).collect();
    let values: Vec<Option<f64>> = mesh
        .ids()
        .map(|id| {
            let corners = mesh.triangle(id);
            // A face of a cell is two triangles, whose longest edge goes through its middle.
            let edges = [[0, 1], [1, 2], [2, 0]].map(|ends| ends.map(|end: usize| corners[end]));
            let length = |[from, to]: &[Point3<f64>; 2]| (to - from).norm();
            let diagonal = edges.into_iter().max_by(|a, b| length(a).total_cmp(&length(b)))?;
            let node =
                nalgebra::center(&diagonal[0], &diagonal[1]) - mesh.normal(id)? * (0.5 * spacing);
            near(node).find_map(|key| excess.get(&key).copied())
        })
        .collect();
    let shown = Shown {
        name: "what remains of the stock".to_owned(),
        unit,
        vertices: mesh.vertices().to_vec(),
        triangles: mesh.triangles().to_vec(),
        sources: (0..mesh.triangles().len() as u32).collect(),
        is_fixture: false,
        has_own_frame: false,
    };
    let quantity = format!("material left over the finished part, {unit}");
    let scale = scale_of_lengths(quantity, "on the part", &values, unit);
    Ok(Some((shown, Layer { body: index, scale, values })))
}
