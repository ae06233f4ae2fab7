//! Notes beside the section: names and dimensions of faces on the left, names of small regions and heights on the
//! right. The dimensions are those of the tool's surface.

use super::lettering::width;
use super::picture::Picture;
use super::regions::{Arrow, Marks, heads};
use super::section::{Edge, Section};
use super::sheet::{Anchor, Look, SECONDARY_COLOUR, Sheet, lines, trimmed};
use super::stroke::Stroke;
use super::{ROUNDING_FRACTION, paint};
use touchoff_dsl::model::Unit;
use touchoff_plane::{Point, cross, dot, minus, norm};

/// The slope up to which a cone is a cylinder on a drawing: its angle would be written as 0.
const MIN_CONE_SLOPE: f64 = 5e-5;

/// A length up to this is 0; a longer one has as many digits as it needs.
const SHOWN_AS_0: f64 = 1e-12;

/// The height of capitals, in sheet units.
const TEXT_SIZE: f64 = 7.5;
/// The distances between lines of names, and of heights, in sheet units.
const LINE_SPACING: f64 = 13.5;
const HEIGHT_SPACING: f64 = 11.5;
/// Distances from the section to the bend of a leader, and to the notes, in sheet units.
const BEND_DISTANCE: f64 = 12.0;
const NOTES_DISTANCE: f64 = 30.0;
/// Lengths that differ by less than this fraction of the tool's size are considered equal.
const LENGTH_TOLERANCE_FRACTION: f64 = 1e-7;

/// Draws the notes on both sides.
pub(super) fn draw(picture: &Picture<'_>, marks: &Marks, sheet: &mut Sheet) {
    draw_faces(picture, sheet);
    let steps = steps(picture);
    let edge = draw_regions(picture, marks, &steps, sheet);
    draw_heights(picture, &steps, edge, sheet);
}

/// A line of text at a preferred height, with its leader from the point that it refers to up to the last bend.
struct Note {
    text: String,
    look: Look,
    height: f64,
    leader: Vec<Point>,
}

/// Writes notes in one column, as near to their preferred heights as they have room. Returns the whole leaders.
fn draw_column(mut notes: Vec<Note>, x: f64, spacing: f64, sheet: &mut Sheet) -> Vec<Vec<Point>> {
    // Leaders do not cross.
    notes.sort_by(|a, b| a.leader[0][1].total_cmp(&b.leader[0][1]));
    let heights: Vec<f64> = notes.iter().map(|note| note.height).collect();
    let mut leaders = Vec::new();
    // From the bottom to the top, as heights are read.
    for (mut note, y) in notes.into_iter().zip(spread(&heights, spacing)).rev() {
        let away = if note.look.anchor == Anchor::Right { -4.0 } else { 4.0 };
        sheet.text(&note.text, [x + away, y], note.look);
        note.leader.push([x, y]);
        leaders.push(note.leader);
    }
    leaders
}

/// Draws the notes of faces: the surface's name and the face's dimension.
fn draw_faces(picture: &Picture<'_>, sheet: &mut Sheet) {
    let half = picture.view.half;
    let capacity = ((picture.view.height + 60.0) / LINE_SPACING) as usize;
    let colours = paint::surface_colours(picture.model);
    let (mut notes, mut arrows) = (Vec::new(), Vec::<Arrow>::new());
    for face in chosen(picture, capacity) {
        let mut text = picture.model.surfaces[face.surface].name.clone();
        if let Some(figure) = &face.figure {
            text = format!("{text} {figure}");
        }
        let look = Look { colour: colours[face.surface], ..Look::plain(TEXT_SIZE, Anchor::Right) };
        let (at, bend) = pointed(picture, &face.longest);
        let mut leader = vec![at, bend, [-half - BEND_DISTANCE, bend[1]]];
        leader.dedup();
        arrows.push([leader[1], at]);
        notes.push(Note { text, look, height: bend[1], leader });
    }
    let leaders = draw_column(notes, -half - NOTES_DISTANCE, LINE_SPACING, sheet);
    draw_thin_lines(&leaders, &arrows, sheet);
}

/// Draws leaders or dimension lines, and the heads of arrows.
pub(super) fn draw_thin_lines<R: AsRef<[Point]>>(rows: &[R], arrows: &[Arrow], sheet: &mut Sheet) {
    let look = format!("fill=\"none\" stroke=\"{SECONDARY_COLOUR}\" stroke-width=\".7\"");
    sheet.path(&look, &lines(rows));
    sheet.path(&format!("fill=\"{SECONDARY_COLOUR}\""), &heads(arrows, 6.0));
}

/// All parts of a surface with one dimension.
struct Face {
    surface: usize,
    /// The dimension as text.
    figure: Option<String>,
    /// True if the dimension is always noted. That of a cone is not, since it is often only a broken edge.
    is_telling: bool,
    /// The total length.
    length: f64,
    longest: Stroke,
}

/// Chooses the faces to note: cylinders and arcs, and at least one face of every surface. If they are more than
/// `capacity`, the longest ones are kept.
fn chosen(picture: &Picture<'_>, capacity: usize) -> Vec<Face> {
    let mut faces = faces(picture);
    faces.sort_by(|a, b| b.is_telling.cmp(&a.is_telling).then(b.length.total_cmp(&a.length)));
    let (mut chosen, mut more) = (Vec::<Face>::new(), Vec::new());
    for face in faces {
        if !chosen.iter().any(|other| other.surface == face.surface) {
            chosen.push(face);
        } else if face.is_telling {
            more.push(face);
        }
    }
    let room = capacity.max(4).saturating_sub(chosen.len());
    chosen.extend(more.into_iter().take(room));
    chosen
}

/// Returns the faces of the surface that a view describes.
fn faces(picture: &Picture<'_>) -> Vec<Face> {
    let mut faces: Vec<Face> = Vec::new();
    for Edge { surface, strokes, exact } in &picture.section.edges {
        for stroke in strokes {
            if !picture.describes([stroke.widest(), stroke.span()[1]]) {
                continue;
            }
            let near = LENGTH_TOLERANCE_FRACTION * picture.size;
            let (figure, is_telling) = match figure(stroke, near, picture.model.unit) {
                Some((figure, is_telling)) if *exact => (Some(figure), is_telling),
                _ => (None, false),
            };
            let (surface, length, longest) = (*surface, stroke.length(), *stroke);
            let mut known = faces.iter_mut();
            match known.find(|face| face.surface == surface && face.figure == figure) {
                Some(face) => {
                    face.length += length;
                    // The first of equal strokes stays, whatever the rounding of their lengths.
                    if length > face.longest.length() * (1.0 + LENGTH_TOLERANCE_FRACTION) {
                        face.longest = longest;
                    }
                }
                None => faces.push(Face { surface, figure, is_telling, length, longest }),
            }
        }
    }
    faces
}

/// Returns the dimension of a stroke, if it has one, and whether that is always noted.
fn figure(stroke: &Stroke, near: f64, unit: Unit) -> Option<(String, bool)> {
    if let Some((_, radius)) = stroke.circle {
        return Some((format!("R{}", tidy(radius, unit)), true));
    }
    let [d, z] = minus(stroke.to, stroke.from).map(f64::abs);
    if d < near.max(z * MIN_CONE_SLOPE) {
        let diameter = stroke.from[0] + stroke.to[0];
        return Some((format!("⌀{}", tidy(diameter, unit)), true));
    }
    let angle = d.atan2(z).to_degrees();
    (z > near).then(|| (format!("{}° a side", trimmed(&format!("{angle:.2}"))), false))
}

/// Returns the end of a face's leader in the left half, and the point at which it bends toward it.
fn pointed(picture: &Picture<'_>, stroke: &Stroke) -> (Point, Point) {
    let view = &picture.view;
    let stroke = view.stroke(stroke);
    let [mut x, mut y] = stroke.at(0.5);
    if stroke.circle.is_none() {
        // Moves the end away from a break line.
        for seam in view.seams() {
            if (y - seam).abs() < 12.0 {
                y = seam - 22.0;
                let share = (y - stroke.from[1]) / (stroke.to[1] - stroke.from[1]);
                x = stroke.at(share.clamp(0.0, 1.0))[0];
            }
        }
    }
    let at = [-x, y];
    // The leader points away from the material. The material is on the left of a stroke in the tool's coordinates, and
    // on its right on the sheet, where y points downward.
    let tangent = minus(stroke.at(0.51), stroke.at(0.49));
    let length = norm(tangent);
    let [dx, dy] = [tangent[1] / length, tangent[0] / length];
    let [dx, dy] = if dx < -0.98 { [-1.0, 0.0] } else { [dx.min(-0.4), dy] };
    if dy == 0.0 { (at, at) } else { (at, [at[0] + 15.0 * dx, at[1] + 15.0 * dy]) }
}

/// Draws the names of regions that do not fit inside. Returns the x coordinate that they reach.
fn draw_regions(picture: &Picture<'_>, marks: &Marks, steps: &[Point], sheet: &mut Sheet) -> f64 {
    let half = picture.view.half;
    let levels: Vec<f64> = steps.iter().map(|step| picture.view.to_sheet(*step)[1]).collect();
    let look = Look { halo: true, ..Look::plain(TEXT_SIZE, Anchor::Left) };
    let (mut edge, mut notes) = (half + 4.0, Vec::new());
    for (region, point) in &marks.unnamed {
        let text = picture.model.regions[*region].name.clone();
        edge = edge.max(half + NOTES_DISTANCE + 4.0 + width(&text, TEXT_SIZE));
        let height = sheet_height(point[1], &levels);
        let leader = vec![*point, [half + BEND_DISTANCE, point[1]]];
        notes.push(Note { text, look, height, leader });
    }
    let leaders = draw_column(notes, half + NOTES_DISTANCE, LINE_SPACING, sheet);
    sheet.path("fill=\"none\" stroke=\"#22272e\" stroke-width=\".7\"", &lines(&leaders));
    sheet.group("fill=\"#22272e\"", |sheet| {
        leaders.iter().for_each(|leader| sheet.ring(leader[0], 1.4));
    });
    edge
}

/// Returns a height at which a note lies between dimension lines rather than on one.
fn sheet_height(y: f64, levels: &[f64]) -> f64 {
    let nearest = levels.iter().copied().min_by(|a, b| (a - y).abs().total_cmp(&(b - y).abs()));
    match nearest {
        Some(level) if (level - y).abs() < 8.0 => level + if y < level { -8.0 } else { 8.0 },
        _ => y,
    }
}

/// Returns the heights to note, of which the first is the tip. If there are too many, the most crowded ones are left
/// out.
fn steps(picture: &Picture<'_>) -> Vec<Point> {
    let mut steps = heights(&picture.section, picture.size, |p| picture.describes(p));
    let max_notes = ((picture.view.height + 80.0) / HEIGHT_SPACING) as usize;
    while steps.len() > max_notes.max(3) {
        let crowded = |k: &usize| steps[k + 1][1] - steps[k - 1][1];
        let most_crowded =
            (1..steps.len() - 1).min_by(|a, b| crowded(a).total_cmp(&crowded(b))).unwrap_or(1);
        steps.remove(most_crowded);
    }
    steps
}

/// Draws the heights as dimensions along one line from the tip.
fn draw_heights(picture: &Picture<'_>, steps: &[Point], edge: f64, sheet: &mut Sheet) {
    let unit = picture.model.unit;
    let x = edge + 20.0;
    let (mut notes, mut thin, mut arrows) = (Vec::new(), Vec::new(), Vec::<Arrow>::new());
    let [mut lowest, mut below] = [f64::INFINITY; 2];
    for (k, step) in steps.iter().enumerate() {
        let [from, y] = picture.view.to_sheet(*step);
        let is_last = k + 1 == steps.len();
        if k == 0 {
            (lowest, below) = (y, y);
        } else if below - y > 7.0 || is_last {
            arrows.push([[x, y + 6.0], [x, y]]);
            below = y;
        } else {
            thin.push(vec![[x - 2.5, y + 2.5], [x + 2.5, y - 2.5]]);
        }
        if is_last {
            thin.push(vec![[x, lowest], [x, y]]);
        }
        let mut text = tidy(step[1] - steps[0][1], unit);
        if is_last {
            text = format!("{text} {}", unit.symbol());
        }
        let look = Look::plain(TEXT_SIZE, Anchor::Left);
        let leader = vec![[from + 3.0, y], [x + 4.0, y]];
        notes.push(Note { text, look, height: y, leader });
    }
    thin.extend(draw_column(notes, x + 12.0, HEIGHT_SPACING, sheet));
    draw_thin_lines(&thin, &arrows, sheet);
    let look = format!("fill=\"#fff\" stroke=\"{SECONDARY_COLOUR}\" stroke-width=\".9\"");
    sheet.group(&look, |sheet| sheet.ring([x, lowest], 2.4));
}

/// Returns positions for notes with preferred positions `target_heights`, which are in ascending order. No two are
/// nearer than `gap`; notes that would crowd are centred on the mean of their preferred positions.
pub(super) fn spread(target_heights: &[f64], gap: f64) -> Vec<f64> {
    // Each cluster: the sum of the positions that its notes would give its first note, and the number of notes.
    let mut clusters: Vec<(f64, usize)> = Vec::new();
    for height in target_heights {
        let mut cluster = (*height, 1);
        while let Some((sum, count)) = clusters.last().copied() {
            let end = sum / count as f64 + gap * count as f64;
            if end <= cluster.0 / cluster.1 as f64 {
                break;
            }
            // The two clusters would overlap: they become one, centred on all its notes.
            clusters.pop();
            let shifted = cluster.0 - gap * (count * cluster.1) as f64;
            cluster = (sum + shifted, count + cluster.1);
        }
        clusters.push(cluster);
    }
    clusters
        .into_iter()
        .flat_map(|(sum, count)| (0..count).map(move |k| sum / count as f64 + gap * k as f64))
        .collect()
}

/// Formats a length, with as many decimals as usual in a workshop.
pub(super) fn tidy(value: f64, unit: Unit) -> String {
    let decimals = match unit {
        Unit::Millimetre => 3,
        Unit::Inch => 4,
        Unit::Metre => 6,
    };
    match trimmed(&format!("{value:.decimals$}")) {
        // A length too small for that gets as many digits as it needs.
        text if text == "0" && value.abs() > SHOWN_AS_0 => {
            touchoff_dsl::diagnostic::format_number(value)
        }
        text => text,
    }
}

/// Returns the heights at which the surface has a corner, a tangent joint of two faces, or an end, from bottom to top.
/// Each is given with its outermost point. Except for the lowest, only points that are `described` count.
pub(super) fn heights(
    section: &Section,
    size: f64,
    described: impl Fn(Point) -> bool,
) -> Vec<Point> {
    let near = LENGTH_TOLERANCE_FRACTION * size;
    let mut steps: Vec<Point> = Vec::new();
    for edge in &section.edges {
        let (first, last) = (edge.strokes[0], edge.strokes[edge.strokes.len() - 1]);
        let (mut goes_on, mut is_end) = (false, true);
        for other in &section.edges {
            let [from, to] = [other.strokes[0], other.strokes[other.strokes.len() - 1]];
            let is_before = norm(minus(to.to, first.from)) < near;
            // A joint within one face is no height of its own.
            goes_on |= is_before && other.surface == edge.surface && one(&to, &first, size);
            is_end &= norm(minus(from.from, last.to)) >= near;
        }
        if !goes_on {
            steps.push(first.from);
        }
        if is_end {
            steps.push(last.to);
        }
    }
    // An arc may reach beyond its ends.
    let low = section.surface().map(|stroke| stroke.span()[0]).fold(f64::INFINITY, f64::min);
    let high = section.surface().map(|stroke| stroke.span()[1]).fold(low, f64::max);
    for stroke in section.surface() {
        let ends = stroke.span().into_iter().filter(|z| *z == low || *z == high);
        steps.extend(ends.map(|z| [stroke.from[0].max(stroke.to[0]), z]));
    }
    steps.sort_by(|a, b| a[1].total_cmp(&b[1]));
    let mut levels: Vec<Point> = Vec::new();
    for step in steps {
        if !levels.is_empty() && !described(step) {
            continue;
        }
        match levels.last_mut() {
            Some(level) if step[1] - level[1] < near => level[0] = level[0].max(step[0]),
            _ => levels.push(step),
        }
    }
    levels
}

/// Returns whether two strokes continue each other on one line or lie on one circle.
fn one(a: &Stroke, b: &Stroke, size: f64) -> bool {
    match (a.circle, b.circle) {
        (None, None) => {
            let (u, v) = (minus(a.to, a.from), minus(b.to, b.from));
            let lengths = norm(u) * norm(v);
            cross(u, v).abs() < ROUNDING_FRACTION * lengths && dot(u, v) > 0.0
        }
        (Some((p, r)), Some((q, s))) => {
            norm(minus(p, q)) + (r - s).abs() < LENGTH_TOLERANCE_FRACTION * size
        }
        _ => false,
    }
}
