//! The values that colour the triangles of a body.

use super::shapes::{Shown, normal};
use crate::arguments::postures::Quantity;
use crate::failure::Failure;
use crate::picture::{Measure, Scale};
use crate::postures::picture::MapQuantity;
use nalgebra::Point3;
use std::collections::HashMap;
use touchoff::{Cloud, Escaped, Mesh, Part, Probe, TriangleId, Unit};
use touchoff_postures::PostureMap;
use touchoff_verify::job::{CutStock, JobBody};
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

/// The bodies of a report as they are shown, and the quantities on them.
pub(super) struct ColouredBodies {
    pub(super) bodies: Vec<Shown>,
    pub(super) layers: Vec<Layer>,
}

impl ColouredBodies {
    /// Returns part, fixtures and meshes of the machine with the depths of findings; the part's layer is there even without a
    /// finding.
    ///
    /// # Errors
    /// If the points of a body cannot be made ready for queries.
    pub(super) fn new(
        checked: &JobReport<'_>,
        bodies: &[JobBody],
    ) -> Result<ColouredBodies, Failure> {
        let shown = bodies.iter().enumerate().map(|(index, body)| {
            let mut pairs = checked.pairs.iter().filter(|pair| pair.body == index);
            // A mesh of the machine is shown with its findings alone, and is coarse without any.
            let is_plain = body.is_of_machine() && pairs.all(|pair| pair.groups.is_empty());
            let shown = match is_plain {
                true => Shown::undivided(&body.name, &body.mesh),
                false => Shown::new(&body.name, &body.mesh),
            };
            Shown {
                is_fixture: index > 0 && !body.is_of_machine(),
                has_own_frame: body.has_own_frame(),
                ..shown
            }
        });
        let bodies: Vec<Shown> = shown.collect();
        let mut layers = Vec::new();
        for (index, body) in bodies.iter().enumerate() {
            let layer = depths(checked, index, body)?;
            if index == 0 || layer.scale.has_values {
                layers.push(layer);
            }
        }
        Ok(ColouredBodies { bodies, layers })
    }

    /// Adds the quantities of a map of the part. They come after the depths: close-ups and the viewer show a finding by the
    /// first layer of its body.
    ///
    /// # Errors
    /// If the map cannot be read.
    pub(super) fn add_map(&mut self, map: &PostureMap, mesh: &Mesh) -> Result<(), Failure> {
        let tools = 0..map.identity().tools.len() as u16;
        let quantities = [Quantity::Niceness, Quantity::Accessibility]
            .map(|by| MapQuantity { by, tool: None })
            .into_iter()
            .chain(tools.map(|tool| MapQuantity { by: Quantity::StickOut, tool: Some(tool) }));
        for quantity in quantities {
            let (values, scale) = quantity.values(map)?;
            if !scale.has_values {
                continue;
            }
            // At the centre of each piece, as a piece has one colour.
            let part = &self.bodies[0];
            let values = part.corners().zip(&part.sources).map(|([a, b, c], source)| {
                let centre = Point3::from((a.coords + b.coords + c.coords) / 3.0);
                values.at(mesh, TriangleId(*source), centre)
            });
            self.layers.push(Layer { body: 0, values: values.collect(), scale });
        }
        Ok(())
    }

    /// Adds what remains of the stock as a body, coloured by its distance from the finished part, unless nothing remains or
    /// its surface has too many triangles.
    ///
    /// # Errors
    /// If the stock cannot be compared with the part.
    pub(super) fn add_stock(
        &mut self,
        cut: &CutStock,
        comparison: &PartComparison,
    ) -> Result<(), Failure> {
        if cut.stock.is_empty() {
            return Ok(());
        }
        let mesh = cut.stock.remaining_mesh()?;
        if mesh.triangles().len() > MAX_STOCK_TRIANGLES {
            return Ok(());
        }
        let values = excesses(&mesh, cut.stock.spacing(), comparison);
        let quantity = format!("material left over the finished part, {}", mesh.unit());
        let scale = scale_of_lengths(quantity, "on the part", &values, mesh.unit());
        self.layers.push(Layer { body: self.bodies.len(), scale, values });
        self.bodies.push(Shown::undivided("what remains of the stock", &mesh));
        Ok(())
    }
}

/// Returns the depth of the deepest finding at each triangle of a body: at its centre, near its corners, and at the
/// deepest points of findings.
///
/// # Errors
/// If the points of the body cannot be made ready for queries.
fn depths(checked: &JobReport<'_>, index: usize, shown: &Shown) -> Result<Layer, Failure> {
    let mut values = vec![None; shown.triangles.len()];
    let part = Part::from_cloud(&cloud(shown)?);
    let pairs = checked.pairs.iter().filter(|pair| pair.body == index);
    for pair in pairs.filter(|pair| !pair.report.findings.is_empty()) {
        let mut probe = Probe::new(&part, checked.shape(pair));
        for finding in &pair.report.findings {
            let FindingKind::Deep { surface, allowed, depth, witness, .. } = finding.kind else {
                continue;
            };
            for contact in probe.contacts(&finding.pose) {
                if contact.surface == surface && contact.depth > allowed {
                    include(&mut values[contact.triangle.index()], contact.depth);
                }
            }
            // The deepest point is seldom one of the samples.
            if let Some(piece) = piece(shown, witness.triangle, &witness.point) {
                include(&mut values[piece], depth.low);
            }
        }
    }
    let place = if index == 0 { String::new() } else { format!(" in {}", Escaped(&shown.name)) };
    let quantity = format!("depth of the deepest finding{place}, {}", shown.unit);
    let scale = scale_of_lengths(quantity, "no finding", &values, shown.unit);
    Ok(Layer { body: index, scale, values })
}

/// Raises a value to a depth, if it is not as deep.
fn include(value: &mut Option<f64>, depth: f64) {
    *value = Some(value.map_or(depth, |known| known.max(depth)));
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
        // A little inside, so that each point is in one triangle only. Four points share the area.
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
    let measure = Measure { quantity, unit: unit.symbol(), from_zero: true, nothing };
    Scale::new(measure, values.iter().copied().flatten())
}

/// Number of triangles above which what remains of the stock is not shown.
const MAX_STOCK_TRIANGLES: usize = 300_000;

/// Returns the distance from the finished part of each triangle of what remains of the stock, where there is an excess.
fn excesses(mesh: &Mesh, spacing: f64, comparison: &PartComparison) -> Vec<Option<f64>> {
    let points = comparison.excess.iter();
    let excess: HashMap<[i64; 3], f64> =
        points.map(|point| (key(point.point, spacing), point.distance)).collect();
    let values = mesh.ids().map(|id| {
        // A face of a cell is two triangles, whose longest edge goes through its middle.
        let [a, b, c] = mesh.triangle(id);
        let length = |[from, to]: &[Point3<f64>; 2]| (to - from).norm();
        let edges = [[a, b], [b, c], [c, a]].into_iter();
        let [from, to] = edges.max_by(|one, other| length(one).total_cmp(&length(other)))?;
        let node = nalgebra::center(&from, &to) - mesh.normal(id)? * (0.5 * spacing);
        near(key(node, spacing)).find_map(|key| excess.get(&key).copied())
    });
    values.collect()
}

/// Returns the key of a node of a lattice, in quarters of its spacing: far finer than nodes lie apart, and far coarser than
/// rounding errors.
fn key(point: Point3<f64>, spacing: f64) -> [i64; 3] {
    let [x, y, z]: [f64; 3] = (point.coords * (4.0 / spacing)).into();
    [x, y, z].map(|part| part.round() as i64)
}

/// Returns a key and those around it, as rounding may lead to any of them.
fn near([x, y, z]: [i64; 3]) -> impl Iterator<Item = [i64; 3]> {
    let around = [-1, 0, 1];
    around.into_iter().flat_map(move |i| {
        around.into_iter().flat_map(move |j| around.map(move |k| [x + i, y + j, z + k]))
    })
}
