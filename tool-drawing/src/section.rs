//! The section of a tool or solid: its surface, the areas of its regions, and the lines between them.
//!
//! For a profile all of it is computed from the segments (`cells`). For regions by hand, and for a plane through a solid,
//! it is traced in the plan's tree (`trace`).

use super::cells::cells;
use super::curves::{Curves, Plane};
use super::stroke::Stroke;
use super::trace::{Border, Side, loops, trace};
use touchoff_dsl::{CheckedTool, Features};
use touchoff_plane::{Point, cross, minus, norm};

/// The vertices of an area's border, in order.
pub(super) type Polygon = Vec<Point>;

/// A part of the surface: one line, one arc, or one other curve. The material is on its left.
#[derive(Clone, Debug)]
pub(super) struct Edge {
    pub(super) surface: usize,
    pub(super) strokes: Vec<Stroke>,
    /// True for lines and arcs, false for the chords of another curve.
    pub(super) exact: bool,
}

/// A line between two regions.
#[derive(Clone, Debug)]
pub(super) struct Split {
    pub(super) regions: [usize; 2],
    pub(super) line: Vec<Point>,
}

/// A section in the tool's unit.
#[derive(Clone, Debug, Default)]
pub(super) struct Section {
    pub(super) edges: Vec<Edge>,
    /// The polygons of each region.
    pub(super) areas: Vec<Vec<Polygon>>,
    /// The polygons of all regions together.
    pub(super) material: Vec<Polygon>,
    pub(super) splits: Vec<Split>,
}

/// The largest distance of a chord from its curve, in units of the sheet.
const FLATNESS: f64 = 0.06;
/// The same for an arc that is cut, relative to its length.
const CUT_FLATNESS: f64 = 1e-4;

impl Section {
    /// Returns the section of a tool in a plane, within a box. `unit` is a lower bound on one unit of the sheet, in the
    /// tool's unit.
    pub(super) fn new(tool: &CheckedTool, plane: Plane, window: [Point; 2], unit: f64) -> Section {
        if let Some(features) = Features::of(&tool.model) {
            return cells(&tool.model, &features, FLATNESS * unit);
        }
        let curves = Curves::new(&tool.model, &tool.extent, plane);
        let borders = trace(&curves, &tool.tree, window, unit);
        let regions = tool.model.regions.len();
        let mut section = Section::default();
        for region in 0..regions {
            section.areas.push(loops(&borders, |side| side == Side::Region(region)));
        }
        section.material = loops(&borders, |side| matches!(side, Side::Region(_)));
        for Border { sides, line, strokes, exact, .. } in borders {
            match sides {
                [Side::Region(a), Side::Region(b)] => {
                    section.splits.push(Split { regions: [a, b], line });
                }
                [Side::Region(region), Side::Outside] if !strokes.is_empty() => {
                    let surface = tool.model.regions[region].surface;
                    section.edges.push(Edge { surface, strokes, exact });
                }
                _ => {}
            }
        }
        section
    }

    /// Returns all strokes of the surface.
    pub(super) fn surface(&self) -> impl Iterator<Item = &Stroke> {
        self.edges.iter().flat_map(|edge| &edge.strokes)
    }

    /// Returns the part up to a distance from the axis and up to a height.
    pub(super) fn clipped(&self, corner: Point) -> Section {
        let mut clipped = Section::default();
        for edge in &self.edges {
            let strokes: Vec<Stroke> =
                edge.strokes.iter().flat_map(|stroke| clipped_stroke(stroke, corner)).collect();
            if !strokes.is_empty() {
                clipped.edges.push(Edge { strokes, ..*edge });
            }
        }
        for polygons in &self.areas {
            clipped.areas.push(clipped_polygons(polygons, corner));
        }
        clipped.material = clipped_polygons(&self.material, corner);
        for Split { regions, line } in &self.splits {
            let lines = clipped_line(line, corner).into_iter();
            clipped.splits.extend(lines.map(|line| Split { regions: *regions, line }));
        }
        clipped
    }
}

/// Returns the parts of a line of chords whose coordinates are at most those of a corner.
fn clipped_line(line: &[Point], corner: Point) -> Vec<Vec<Point>> {
    let mut lines = vec![line.to_vec()];
    for k in 0..2 {
        let mut parts = Vec::new();
        for line in lines {
            let mut part: Vec<Point> = Vec::new();
            for (index, p) in line.iter().enumerate() {
                let before = line[index.saturating_sub(1)];
                let is_inside = p[k] <= corner[k];
                if is_inside != (before[k] <= corner[k]) {
                    let share = (corner[k] - before[k]) / (p[k] - before[k]);
                    part.push(Stroke::line(before, *p).at(share));
                }
                if is_inside {
                    part.push(*p);
                } else if part.len() > 1 {
                    parts.push(std::mem::take(&mut part));
                }
            }
            if part.len() > 1 {
                parts.push(part);
            }
        }
        lines = parts;
    }
    lines
}

/// Returns the parts of a stroke whose coordinates are at most those of a corner. An arc that is cut is chords from there on.
pub(super) fn clipped_stroke(stroke: &Stroke, corner: Point) -> Vec<Stroke> {
    if stroke.breadth()[1] <= corner[0] && stroke.span()[1] <= corner[1] {
        return vec![*stroke];
    }
    let mut points = stroke.points(CUT_FLATNESS * stroke.length());
    points.push(stroke.to);
    let mut parts = Vec::new();
    for line in clipped_line(&points, corner) {
        parts.extend(line.windows(2).map(|pair| Stroke::line(pair[0], pair[1])));
    }
    parts
}

/// Returns the parts of polygons whose coordinates are at most those of a corner.
fn clipped_polygons(polygons: &[Polygon], corner: Point) -> Vec<Polygon> {
    let mut clipped = Vec::new();
    for polygon in polygons {
        let mut ring = polygon.clone();
        for limit in [[corner[0], f64::INFINITY], [f64::INFINITY, corner[1]]] {
            ring.extend(ring.first().copied());
            // The parts of a ring are joined along the limit.
            ring = clipped_line(&ring, limit).concat();
        }
        if ring.len() > 2 {
            clipped.push(ring);
        }
    }
    clipped
}

/// Returns the vertices of a line without those that are within a distance of its chords (Douglas and Peucker 1973).
pub(super) fn simplified(line: &[Point], flat: f64) -> Vec<Point> {
    let last = line.len() - 1;
    let chord = minus(line[last], line[0]);
    let (mut farthest, mut distance) = (0, flat);
    for (k, p) in line.iter().enumerate() {
        let offset = minus(*p, line[0]);
        let length = norm(chord);
        let away = if length > 0.0 { cross(chord, offset).abs() / length } else { norm(offset) };
        if away > distance {
            (farthest, distance) = (k, away);
        }
    }
    if farthest == 0 {
        return vec![line[0], line[last]];
    }
    let mut vertices = simplified(&line[..=farthest], flat);
    vertices.pop();
    vertices.extend(simplified(&line[farthest..], flat));
    vertices
}
