//! The shapes that are shown: part and fixtures, whose long triangles are divided, so that a value does not colour a whole
//! face, and tools.

use crate::picture::render::{Facet, Paint};
use nalgebra::{Point3, Vector3};
use std::collections::HashMap;
use touchoff::tool::{ProfileSegment, ToolInfo};
use touchoff::{Mesh, Pose, Unit};

/// Number of pieces that the largest extent of a body is divided into, if it is divided.
const PIECES: f64 = 96.0;
/// Number of triangles above which the pieces are made larger.
const MAX_TRIANGLES: usize = 150_000;

/// Returns the corners of the box of some points; the origin twice if there are none.
pub(super) fn bounds(mut points: impl Iterator<Item = Point3<f64>>) -> [Point3<f64>; 2] {
    let first = points.next().unwrap_or_default();
    points.fold([first; 2], |[low, high], point| [low.inf(&point), high.sup(&point)])
}

/// A body as it is shown.
pub(super) struct Shown {
    pub(super) name: String,
    pub(super) unit: Unit,
    pub(super) vertices: Vec<Point3<f64>>,
    pub(super) triangles: Vec<[u32; 3]>,
    /// The triangle of the file that each triangle is a piece of.
    pub(super) sources: Vec<u32>,
    /// Set for a fixture or another part, as opposed to the part and the stock.
    pub(super) is_fixture: bool,
    /// Set if the body has a frame of its own, in which the tool's poses at it are given.
    pub(super) has_own_frame: bool,
}

impl Shown {
    /// Returns the part, with its triangles divided.
    pub(super) fn new(name: &str, mesh: &Mesh) -> Shown {
        let whole = Shown::undivided(name, mesh);
        let mut longest = whole.extent() / PIECES;
        loop {
            match whole.divided(longest) {
                Some(shown) => return shown,
                // Half as long again: less than half as many pieces.
                None => longest *= 1.5,
            }
        }
    }

    /// Returns the part with the triangles of its mesh.
    pub(super) fn undivided(name: &str, mesh: &Mesh) -> Shown {
        Shown {
            name: name.to_owned(),
            unit: mesh.unit(),
            vertices: mesh.vertices().to_vec(),
            triangles: mesh.triangles().to_vec(),
            sources: (0..mesh.triangles().len() as u32).collect(),
            is_fixture: false,
            has_own_frame: false,
        }
    }

    /// Divides edges that are longer than `longest`; `None` if that makes too many triangles.
    fn divided(&self, longest: f64) -> Option<Shown> {
        let mut shown = Shown {
            name: self.name.clone(),
            vertices: self.vertices.clone(),
            triangles: Vec::new(),
            sources: Vec::new(),
            ..*self
        };
        // A finer mesh is shown as it is.
        let limit = MAX_TRIANGLES.max(self.triangles.len());
        let mut middles: HashMap<[u32; 2], u32> = HashMap::new();
        let mut open = Vec::new();
        for (source, triangle) in (0..).zip(&self.triangles) {
            open.push(*triangle);
            while let Some([a, b, c]) = open.pop() {
                // The longest edge is halved; of equal edges the one before in this list. Neighbours share its middle, so that
                // no gap opens between them.
                let turns = [[a, b, c], [b, c, a], [c, a, b]];
                let [from, to, tip] = turns.into_iter().fold(turns[0], |best, turn| {
                    if shown.length(turn) > shown.length(best) { turn } else { best }
                });
                if shown.length([from, to, tip]) <= longest {
                    shown.triangles.push([a, b, c]);
                    shown.sources.push(source);
                    if shown.triangles.len() > limit {
                        return None;
                    }
                    continue;
                }
                let middle = *middles.entry([from.min(to), from.max(to)]).or_insert_with(|| {
                    let ends = [from, to].map(|end| shown.vertices[end as usize]);
                    shown.vertices.push(nalgebra::center(&ends[0], &ends[1]));
                    shown.vertices.len() as u32 - 1
                });
                open.extend([[from, middle, tip], [middle, to, tip]]);
            }
        }
        Some(shown)
    }

    /// Returns the corners of all triangles.
    pub(super) fn corners(&self) -> impl Iterator<Item = [Point3<f64>; 3]> + '_ {
        self.triangles.iter().map(|triangle| triangle.map(|vertex| self.vertices[vertex as usize]))
    }

    /// Returns the corners of the box.
    pub(super) fn bounds(&self) -> [Point3<f64>; 2] {
        bounds(self.vertices.iter().copied())
    }

    /// Returns the largest extent along an axis.
    pub(super) fn extent(&self) -> f64 {
        let [low, high] = self.bounds();
        (high - low).max()
    }

    /// Returns the length of a triangle's first edge.
    fn length(&self, [from, to, _]: [u32; 3]) -> f64 {
        (self.vertices[to as usize] - self.vertices[from as usize]).norm()
    }
}

/// Returns the outward normal of a triangle, if it has an area.
pub(super) fn normal([a, b, c]: [Point3<f64>; 3]) -> Option<Vector3<f64>> {
    (b - a).cross(&(c - a)).try_normalize(0.0)
}

/// Number of chords of an arc, and of sides of the solid of revolution.
const CHORDS: usize = 10;
const SIDES: usize = 48;

/// Colours of surfaces that cut, and of others.
const CUTTING: [u8; 3] = [214, 134, 30];
const NOT_CUTTING: [u8; 3] = [100, 118, 150];

/// The profile of a tool, from its lower end upward, in the unit of the part.
pub(super) struct ToolShape {
    pub(super) lines: Vec<ProfileLine>,
    /// Set if the tool has a profile. Otherwise the lines are of cylinders that contain it.
    pub(super) is_exact: bool,
}

/// A line of a tool's profile. Its ends are a distance from the axis and a height.
pub(super) struct ProfileLine {
    pub(super) from: [f64; 2],
    pub(super) to: [f64; 2],
    pub(super) cuts: bool,
}

impl ToolShape {
    pub(super) fn new(info: &ToolInfo, unit: Unit) -> ToolShape {
        let factor = info.unit.factor_to(unit);
        let scaled = |point: [f64; 2]| point.map(|part| part * factor);
        let mut lines = Vec::new();
        for segment in info.outline.iter() {
            let cuts = info.surface(segment.surface).cutting;
            lines.extend(points(segment).windows(2).map(|ends| ProfileLine {
                from: scaled(ends[0]),
                to: scaled(ends[1]),
                cuts,
            }));
        }
        if lines.is_empty() {
            for slab in info.envelope.iter() {
                let [low, high] = [slab.low, slab.high].map(|z| scaled([slab.radius, z]));
                let [bottom, top] = [slab.low, slab.high].map(|z| scaled([0.0, z]));
                lines.extend(
                    [[bottom, low], [low, high], [high, top]].map(|[from, to]| ProfileLine {
                        from,
                        to,
                        cuts: false,
                    }),
                );
            }
        }
        ToolShape { lines, is_exact: info.is_exact() }
    }

    /// Returns the radius of the surfaces that cut, or of the whole tool if none does.
    pub(super) fn radius(&self) -> f64 {
        let cutting = widest(self.lines.iter().filter(|line| line.cuts));
        if cutting > 0.0 { cutting } else { widest(&self.lines) }
    }

    /// Returns the facets of the tool at a pose.
    pub(super) fn facets(&self, pose: &Pose) -> impl Iterator<Item = Facet> + '_ {
        let (tip, axis) = (pose.tip(), pose.axis());
        // Any direction across the axis, from one that is surely not parallel to it.
        let aside = if axis.x.abs() < 0.6 { Vector3::x() } else { Vector3::y() };
        let right = axis.cross(&aside).normalize();
        let front = axis.cross(&right);
        let at = move |[d, z]: [f64; 2], side: usize| -> Point3<f64> {
            let (sine, cosine) = (side as f64 * std::f64::consts::TAU / SIDES as f64).sin_cos();
            tip + axis * z + (right * cosine + front * sine) * d
        };
        self.lines.iter().flat_map(move |ProfileLine { from, to, cuts }| {
            let paint = Paint::Glass(if *cuts { CUTTING } else { NOT_CUTTING });
            (0..SIDES).flat_map(move |side| {
                let [a, b] = [side, side + 1].map(|side| at(*from, side));
                let [d, c] = [side, side + 1].map(|side| at(*to, side));
                [[a, b, c], [a, c, d]].map(|corners| Facet { corners, paint })
            })
        })
    }
}

/// Returns the greatest distance of lines from the axis.
fn widest<'l>(lines: impl IntoIterator<Item = &'l ProfileLine>) -> f64 {
    lines.into_iter().fold(0.0, |widest: f64, line| widest.max(line.from[0]).max(line.to[0]))
}

/// Returns points of a segment, with chords in place of an arc.
fn points(segment: &ProfileSegment) -> Vec<[f64; 2]> {
    let steps = if segment.circle.is_some() { CHORDS } else { 1 };
    segment.geometry().places(steps).map(|place| place.point).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchoff::mesh::shapes;

    #[test]
    fn pieces_are_short_and_cover_the_mesh() {
        let (low, high) = (Point3::new(0.0, 0.0, 0.0), Point3::new(8.0, 3.0, 1.0));
        let cuboid = shapes::cuboid(low, high, Unit::Millimetre).expect("a cuboid");
        let shown = Shown::new("part", &cuboid);
        let area = |[a, b, c]: [Point3<f64>; 3]| 0.5 * (b - a).cross(&(c - a)).norm();
        let mut areas = vec![0.0; cuboid.triangles().len()];
        for (corners, source) in shown.corners().zip(&shown.sources) {
            areas[*source as usize] += area(corners);
            for k in 0..3 {
                assert!((corners[k] - corners[(k + 1) % 3]).norm() <= 8.0 / PIECES);
            }
        }
        for (id, area) in cuboid.ids().zip(areas) {
            assert!((area - cuboid.area(id)).abs() < 1e-9, "{area}");
        }
        assert!(shown.triangles.len() <= MAX_TRIANGLES);
    }
}
