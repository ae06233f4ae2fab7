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

/// Number of contacts that are computed for the colours of a body at most: a large tool touches all points of the part at each finding.
const MAX_CONTACTS: usize = 8_000_000;
/// Number of contacts for which a query counts that finds none.
const QUERY_CONTACTS: usize = 256;

/// Returns the depth of the deepest finding at each triangle of a body: at its centre, near its corners, and at the
/// deepest points of findings. Above [`MAX_CONTACTS`], only the deepest findings of each tool count at centres and near corners.
///
/// # Errors
/// If the points of the body cannot be made ready for queries.
fn depths(checked: &JobReport<'_>, index: usize, shown: &Shown) -> Result<Layer, Failure> {
    let mut values = vec![None; shown.triangles.len()];
    let part = Part::from_cloud(&cloud(shown)?);
    let pieces = Pieces::new(shown);
    let pairs: Vec<_> = checked
        .pairs
        .iter()
        .filter(|pair| pair.body == index && !pair.report.findings.is_empty())
        .collect();
    let (mut queried, mut deep) = (0, 0);
    for pair in &pairs {
        let mut probe = Probe::new(&part, checked.shape(pair));
        let mut findings: Vec<_> = pair
            .report
            .findings
            .iter()
            .filter_map(|finding| match finding.kind {
                FindingKind::Deep { surface, allowed, depth, witness, .. } => {
                    Some((depth.low, surface, allowed, witness, finding.pose))
                }
                _ => None,
            })
            .collect();
        findings.sort_by(|one, other| other.0.total_cmp(&one.0));
        deep += findings.len();
        let mut left = MAX_CONTACTS / pairs.len();
        for (depth, surface, allowed, witness, pose) in findings {
            if left > 0 {
                queried += 1;
                let contacts = probe.contacts(&pose);
                left = left.saturating_sub(contacts.len() + QUERY_CONTACTS);
                for contact in contacts {
                    if contact.surface == surface && contact.depth > allowed {
                        include(&mut values[contact.triangle.index()], contact.depth);
                    }
                }
            }
            // The deepest point is seldom one of the samples.
            if let Some(piece) = pieces.nearest(witness.triangle, &witness.point) {
                include(&mut values[piece], depth);
            }
        }
    }
    let place = if index == 0 { String::new() } else { format!(" in {}", Escaped(&shown.name)) };
    let of = if queried < deep {
        format!(" ({queried} of {deep}; of the others, at the deepest point)")
    } else {
        String::new()
    };
    let quantity = format!("depth of the deepest finding{place}{of}, {}", shown.unit);
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

/// The pieces of a body's triangles, by places of their centres.
struct Pieces<'s> {
    shown: &'s Shown,
    /// The longest edge of a piece.
    longest: f64,
    /// Pieces by the triangle of the file, and the cell of side `longest` around their centres.
    cells: HashMap<(u32, [i64; 3]), Vec<usize>>,
}

impl Pieces<'_> {
    fn new(shown: &Shown) -> Pieces<'_> {
        let edges = shown.corners().flat_map(|[a, b, c]| [b - a, c - b, a - c]);
        let longest = edges.map(|edge| edge.norm()).fold(f64::MIN_POSITIVE, f64::max);
        let mut pieces = Pieces { shown, longest, cells: HashMap::new() };
        for (piece, source) in shown.sources.iter().enumerate() {
            let cell = pieces.cell(&pieces.centre(piece));
            pieces.cells.entry((*source, cell)).or_default().push(piece);
        }
        pieces
    }

    fn centre(&self, piece: usize) -> Point3<f64> {
        let [a, b, c] =
            self.shown.triangles[piece].map(|vertex| self.shown.vertices[vertex as usize]);
        Point3::from((a.coords + b.coords + c.coords) / 3.0)
    }

    fn cell(&self, point: &Point3<f64>) -> [i64; 3] {
        key(*point, 4.0 * self.longest)
    }

    /// Returns the piece of a triangle of the file whose centre is the nearest to a point of that triangle. The point lies in a
    /// piece, whose centre is nearer than its longest edge: it is in the same cell or beside it.
    fn nearest(&self, source: TriangleId, point: &Point3<f64>) -> Option<usize> {
        let cells = near(self.cell(point)).filter_map(|cell| self.cells.get(&(source.0, cell)));
        let distance = |piece: &usize| (self.centre(*piece) - point).norm_squared();
        cells
            .flatten()
            .copied()
            .min_by(|one, other| distance(one).total_cmp(&distance(other)).then(one.cmp(other)))
    }
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

#[cfg(test)]
mod tests {
    use super::*;
    use touchoff::mesh::shapes;

    #[test]
    fn the_nearest_piece_is_that_of_all_pieces_of_the_triangle() {
        let (low, high) = (Point3::new(0.0, 0.0, 0.0), Point3::new(8.0, 3.0, 1.0));
        let cuboid = shapes::cuboid(low, high, Unit::Millimetre).expect("a cuboid");
        let shown = Shown::new("part", &cuboid);
        let pieces = Pieces::new(&shown);
        for id in cuboid.ids() {
            let [a, b, c] = cuboid.triangle(id);
            for (s, t) in [(0.0, 0.0), (1.0, 0.0), (0.31, 0.57), (0.02, 0.9), (0.5, 0.5)] {
                let point = a + (b - a) * s + (c - a) * t;
                let distance = |piece: usize| (pieces.centre(piece) - point).norm();
                let of_triangle = (0..shown.sources.len()).filter(|k| shown.sources[*k] == id.0);
                let nearest = of_triangle.map(distance).fold(f64::INFINITY, f64::min);
                let found = pieces.nearest(id, &point).expect("a piece");
                assert_eq!(shown.sources[found], id.0);
                assert_eq!(distance(found), nearest, "{point}");
            }
        }
    }
}
