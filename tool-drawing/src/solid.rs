//! Solids, which have no axis: three sections through the middle, perpendicular to y, x and z.
//!
//! They are arranged in third-angle projection: the view from the front (from −y), to its right the view from the right
//! (from +x), and above it the view from above (from +z).

use super::curves::Plane;
use super::legend::{self, Entry, Sign};
use super::notes::{draw_thin_lines, tidy};
use super::picture::Picture;
use super::regions::name;
use super::section::Section;
use super::sheet::{Anchor, Look, Sheet, lines};
use super::view::View;
use super::{Content, ROUNDING_FRACTION, paint};
use touchoff_dsl::CheckedTool;
use touchoff_dsl::expr::interval::Interval;

/// The part of the size below which a coordinate is written as 0.
const SHOWN_AS_0: f64 = 1e-9;

/// The axes, and those perpendicular to the front view, the side view and the top view.
const AXES: [&str; 3] = ["x", "y", "z"];
const NORMALS: [usize; 3] = [1, 0, 2];
/// The largest width and height of two views together, in sheet units.
const MAX_EXTENT: f64 = 460.0;
/// Distances between views, and from a section to its dimension lines, in sheet units.
const VIEW_DISTANCE: f64 = 36.0;
const DIMENSION_DISTANCE: f64 = 24.0;
/// The height of capitals in dimensions and in the names of sections, in sheet units.
const DIMENSION_SIZE: f64 = 7.5;
const NAME_SIZE: f64 = 9.0;

/// Draws the three sections and their legend.
pub(super) fn draw(tool: &CheckedTool, content: Content, sheet: &mut Sheet) {
    let sections = sections(tool, content);
    let mut known = Vec::new();
    let [front, side, top] = sections.each_ref().map(|section| {
        let mut part = Sheet::new(sheet.lettering);
        section.draw(&sections, &mut part);
        section.draw_dimensions(&mut known, &mut part);
        section.draw_name(&mut part);
        part
    });
    let [[_, upper], [right, _]] = front.frame();
    sheet.place(&front, [0.0, 0.0]);
    sheet.place(&side, [right + VIEW_DISTANCE - side.frame()[0][0], 0.0]);
    sheet.place(&top, [0.0, upper - VIEW_DISTANCE - top.frame()[1][1]]);
    let regions = match content {
        Content::Outline => Vec::new(),
        Content::Regions => regions(&sections),
    };
    legend::draw(&[legend::surfaces(&tool.model), regions], sheet);
}

/// The section in the plane perpendicular to an axis at a coordinate.
pub(super) struct SectionView<'m> {
    normal: usize,
    pub(super) at: f64,
    pub(super) picture: Picture<'m>,
}

/// The extent of a section along an axis.
type Dimension = (usize, Interval);

/// Returns the three sections through the middle, in the order of `NORMALS` and to one scale.
pub(super) fn sections<'m>(tool: &'m CheckedTool, content: Content) -> [SectionView<'m>; 3] {
    let proved = tool.extent.cell().sides;
    let [x, y, z] = proved.map(|side| side.high - side.low);
    let (size, unit) = (x.max(y).max(z), (x + y).max(z + y) / (1.1 * MAX_EXTENT));
    // Proved extents may be a few percent too wide, so the middle is that of coarse sections through their middle.
    let rough = planes(tool, proved.map(Interval::middle), 8.0 * unit);
    let mut middle = extents(&rough, proved).map(Interval::middle);
    for coordinate in &mut middle {
        if coordinate.abs() < ROUNDING_FRACTION * size {
            *coordinate = 0.0;
        }
    }
    let sections = planes(tool, middle, unit);
    let sides = extents(&sections, proved);
    let [x, y, z] = sides.map(|side| side.high - side.low);
    let scale = MAX_EXTENT / (x + y).max(z + y);
    let fills = paint::distinct_area_colours(tool.model.regions.len());
    let [front, side, top] = sections;
    [(1, front), (0, side), (2, top)].map(|(normal, section)| {
        let [u, v] = axes(normal).map(|axis| sides[axis]);
        let view = View::framed([[u.low, v.low], [u.high, v.high]], scale);
        let picture = Picture::of(&tool.model, content, section, size, view, fills.clone());
        SectionView { normal, at: middle[normal], picture }
    })
}

/// Returns the sections in the planes at these coordinates along x, y and z, in the order of `NORMALS`.
fn planes(tool: &CheckedTool, at: [f64; 3], unit: f64) -> [Section; 3] {
    let sides = tool.extent.cell().sides;
    NORMALS.map(|normal| {
        let [u, v] = axes(normal).map(|axis| sides[axis]);
        // Odd shares, so that no side of the lattice runs along a curve.
        let low = [u, v].map(|side| side.low - 0.0213 * (side.high - side.low));
        let high = [u, v].map(|side| side.high + 0.0197 * (side.high - side.low));
        Section::new(tool, Plane::Across { axis: normal, at: at[normal] }, [low, high], unit)
    })
}

/// Returns the axes to the right and up in the view of a section.
fn axes(normal: usize) -> [usize; 2] {
    [[1, 2], [0, 2], [0, 1]][normal]
}

/// Returns the box around three sections; `proved` where there is none.
fn extents(sections: &[Section; 3], proved: [Interval; 3]) -> [Interval; 3] {
    let mut sides: [Option<Interval>; 3] = [None; 3];
    for (normal, section) in NORMALS.into_iter().zip(sections) {
        for (axis, side) in axes(normal).into_iter().zip(bounds(section).into_iter().flatten()) {
            sides[axis] = Some(sides[axis].map_or(side, |known| known.hull(side)));
        }
    }
    [0, 1, 2].map(|axis| sides[axis].unwrap_or(proved[axis]))
}

/// Returns the extent of a section along its two coordinates, unless it is empty.
fn bounds(section: &Section) -> Option<[Interval; 2]> {
    let mut bounds: Option<[Interval; 2]> = None;
    for stroke in section.surface() {
        let sides = [stroke.breadth(), stroke.span()].map(|[low, high]| Interval::new(low, high));
        let [u, v] = bounds.unwrap_or(sides);
        bounds = Some([u.hull(sides[0]), v.hull(sides[1])]);
    }
    bounds
}

impl SectionView<'_> {
    /// Draws areas, surfaces and the names of regions, and beside them the ends of the other sections' planes.
    fn draw(&self, all: &[SectionView<'_>; 3], sheet: &mut Sheet) {
        let picture = &self.picture;
        let view = &picture.view;
        paint::whole(picture, sheet);
        if picture.content == Content::Regions {
            paint::splits(picture, sheet);
            self.draw_names(sheet);
        }
        paint::outline(picture, false, sheet);
        let others = axes(self.normal).map(|axis| {
            all.iter().find(|section| section.normal == axis).map_or(0.0, |section| section.at)
        });
        let [u, v] = view.to_sheet(others);
        let (near, far) = (3.0, 15.0);
        let rows = [
            [[u, near], [u, far]],
            [[u, -view.height - near], [u, -view.height - far]],
            [[-view.half - near, v], [-view.half - far, v]],
            [[view.half + near, v], [view.half + far, v]],
        ];
        sheet.path("fill=\"none\" stroke=\"#22272e\" stroke-width=\".9\"", &lines(rows));
        rows.into_iter().flatten().for_each(|p| sheet.reach(p));
    }

    /// Draws the names of regions that have room for them; the legend names all.
    fn draw_names(&self, sheet: &mut Sheet) {
        for (region, shape) in self.picture.shapes.iter().enumerate() {
            if let Some(name) = name(&self.picture, region, shape, &[]) {
                let text = &self.picture.model.regions[region].name;
                sheet.text(text, name.at, Look::plain(name.size, Anchor::Middle));
            }
        }
    }

    /// Draws the dimensions of the section except those that are `known` from other views.
    fn draw_dimensions(&self, known: &mut Vec<Dimension>, sheet: &mut Sheet) {
        let Picture { section, size, model, view, .. } = &self.picture;
        let Some(bounds) = bounds(section) else { return };
        for (k, (axis, side)) in axes(self.normal).into_iter().zip(bounds).enumerate() {
            let is_known = known.iter().any(|(other, known)| {
                let difference = (known.low - side.low).abs() + (known.high - side.high).abs();
                *other == axis && difference < ROUNDING_FRACTION * size
            });
            if is_known {
                continue;
            }
            known.push((axis, side));
            let ends = [side.low, side.high];
            let on_sheet = ends.map(|end| view.to_sheet([end, end])[k]);
            let middle = f64::midpoint(on_sheet[0], on_sheet[1]);
            let line = [DIMENSION_DISTANCE, -view.half - DIMENSION_DISTANCE][k];
            self.draw_dimension_line(k, on_sheet, line, sheet);
            let [from, to] = ends.map(|end| self.figure(end));
            let length = tidy(side.high - side.low, model.unit);
            let text = format!("{} {length} ({from} to {to})", AXES[axis]);
            let (at, anchor) =
                [([middle, line + 13.0], Anchor::Middle), ([line - 8.0, middle], Anchor::Right)][k];
            sheet.text(&text, at, Look::plain(DIMENSION_SIZE, anchor));
        }
    }

    /// Draws a dimension line between two coordinates of the sheet, below the section if they are horizontal, otherwise
    /// on the left, and lines that extend to it from the surface. `line` is its other coordinate.
    fn draw_dimension_line(&self, k: usize, ends: [f64; 2], line: f64, sheet: &mut Sheet) {
        let outward = line.signum();
        let point =
            |along: f64, across: f64| if k == 0 { [along, across] } else { [across, along] };
        let mut thin = vec![ends.map(|end| point(end, line))];
        for end in ends {
            let mut nearest = f64::NEG_INFINITY;
            for stroke in self.picture.section.surface() {
                for p in self.picture.view.stroke(stroke).points(0.05) {
                    if (p[k] - end).abs() < 0.5 {
                        nearest = nearest.max(p[1 - k] * outward);
                    }
                }
            }
            if nearest.is_finite() {
                let from = point(end, (nearest + 3.0) * outward);
                thin.push([from, point(end, line + 4.0 * outward)]);
            }
        }
        let [from, to] = thin[0];
        draw_thin_lines(&thin, &[[from, to], [to, from]], sheet);
    }

    /// Draws the name of the section above everything drawn so far.
    fn draw_name(&self, sheet: &mut Sheet) {
        let [[_, upper], _] = sheet.frame();
        let name = format!("section {} = {}", AXES[self.normal], self.figure(self.at));
        sheet.text(&name, [0.0, upper - 14.0], Look::plain(NAME_SIZE, Anchor::Middle));
    }

    /// Formats a coordinate. Values that are 0 except for rounding are 0.
    fn figure(&self, value: f64) -> String {
        let value = if value.abs() < SHOWN_AS_0 * self.picture.size { 0.0 } else { value };
        tidy(value, self.picture.model.unit)
    }
}

/// Returns the legend's entries of the regions that appear in a section.
fn regions(sections: &[SectionView<'_>; 3]) -> Vec<Entry> {
    let Picture { model, fills, .. } = &sections[0].picture;
    let mut entries = Vec::new();
    for (index, (region, colour)) in model.regions.iter().zip(fills).enumerate() {
        if sections.iter().any(|section| !section.picture.shapes[index].is_empty()) {
            entries.push((Sign::Area(colour), region.name.clone()));
        }
    }
    entries
}
