//! Notes beside the section: names and dimensions of faces on the left, names of small regions and heights on the
//! right. The dimensions are those of the tool's surface.

use super::lettering::width;
use super::regions::{Marks, head};
use super::section::{Edge, Section};
use super::sheet::{Anchor, Look, SECONDARY_COLOUR, Sheet, lines};
use super::stroke::Stroke;
use super::{Picture, paint};
use touchoff_dsl::model::Unit;
use touchoff_dsl::vector::{Point, cross, dot, minus, norm};

/// The height of capitals, in sheet units.
const TEXT_SIZE: f64 = 7.5;
/// The distance between lines of notes, in sheet units.
const LINE_SPACING: f64 = 13.5;
/// Distances from the section to the bend of a leader, and to the notes, in sheet units.
const BEND_DISTANCE: f64 = 12.0;
const NOTES_DISTANCE: f64 = 30.0;

/// Draws the notes on both sides.
pub(super) fn draw(picture: &Picture<'_>, marks: &Marks, sheet: &mut Sheet) {
    draw_left_notes(picture, sheet);
    let steps = steps(picture);
    let edge = right(picture, marks, &steps, sheet);
    levels(picture, &steps, edge, sheet);
}

/// A note, with the point that it refers to.
struct Note {
    text: String,
    colour: &'static str,
    /// The end of its leader.
    at: Point,
    /// The point at which its leader bends toward the end.
    bend: Point,
}

/// Draws the notes of faces: the surface's name and the face's dimension.
fn draw_left_notes(picture: &Picture<'_>, sheet: &mut Sheet) {
    let view = &picture.view;
    let capacity = ((view.height + 60.0) / LINE_SPACING) as usize;
    let chosen = chosen(picture, capacity);
    let colours = paint::surface_colours(picture.model);
    let mut notes: Vec<Note> = chosen
        .iter()
        .map(|face| {
            let name = &picture.model.surfaces[face.surface].name;
            let text = match face.figure(picture.model.unit) {
                Some(figure) => format!("{name} {figure}"),
                None => name.clone(),
            };
            let (at, bend) = pointed(picture, face);
            Note { text, colour: colours[face.surface], at, bend }
        })
        .collect();
    notes.sort_by(|a, b| a.bend[1].total_cmp(&b.bend[1]));
    let target_heights: Vec<f64> = notes.iter().map(|note| note.bend[1]).collect();
    let (knee, text) = (-view.half - BEND_DISTANCE, -view.half - NOTES_DISTANCE);
    let mut leaders = Vec::new();
    let mut heads = Vec::new();
    for (note, y) in notes.iter().zip(spread(&target_heights, LINE_SPACING)) {
        let look = Look { colour: note.colour, ..Look::plain(TEXT_SIZE, Anchor::Right) };
        sheet.text(&note.text, [text - 4.0, y], look);
        let mut leader = vec![[text, y], [knee, note.bend[1]], note.bend];
        if norm(minus(note.at, note.bend)) > 0.1 {
            leader.push(note.at);
        }
        let before = leader[leader.len() - 2];
        let [a, b, c] = head([before, note.at], 6.0);
        heads.push([a, b, c, a]);
        leaders.push(leader);
    }
    sheet.path(
        &format!("fill=\"none\" stroke=\"{SECONDARY_COLOUR}\" stroke-width=\".8\""),
        &lines(&leaders),
    );
    sheet.path(&format!("fill=\"{SECONDARY_COLOUR}\""), &lines(&heads));
}

/// Chooses the faces to note: cylinders and arcs, and at least one face of every surface. If they are more than
/// `capacity`, the longest ones are kept.
fn chosen(picture: &Picture<'_>, capacity: usize) -> Vec<Face> {
    let unit = picture.model.unit;
    let all = faces(&picture.section, picture.size);
    let mut chosen: Vec<Face> = Vec::new();
    let described =
        |face: &&Face| picture.describes([face.longest.widest(), face.longest.span()[1]]);
    for face in all.iter().filter(described) {
        let same =
            |other: &Face| other.surface == face.surface && other.figure(unit) == face.figure(unit);
        match chosen.iter_mut().find(|other| same(other)) {
            Some(known) if face.length > known.length => *known = face.clone(),
            Some(_) => {}
            None => chosen.push(face.clone()),
        }
    }
    // The longest face of each surface that has no cylinder and no arc.
    let only = (0..picture.model.surfaces.len()).filter_map(|surface| {
        let of_surface = || (0..chosen.len()).filter(|index| chosen[*index].surface == surface);
        let is_named = of_surface().any(|index| chosen[index].is_telling());
        of_surface()
            .max_by(|a, b| chosen[*a].length.total_cmp(&chosen[*b].length))
            .filter(|_| !is_named)
    });
    let only: Vec<usize> = only.collect();
    let mut index = 0;
    chosen.retain(|face| {
        index += 1;
        face.is_telling() || only.contains(&(index - 1))
    });
    while chosen.len() > capacity.max(4) {
        let alone =
            |face: &Face| chosen.iter().filter(|other| other.surface == face.surface).count() == 1;
        let least_telling = (0..chosen.len())
            .filter(|index| !alone(&chosen[*index]))
            .min_by(|a, b| chosen[*a].length.total_cmp(&chosen[*b].length));
        // Every surface keeps one face.
        let Some(least_telling) = least_telling else { break };
        chosen.remove(least_telling);
    }
    chosen
}

/// Returns the end of a face's leader in the left half, and the point at which it bends toward it.
fn pointed(picture: &Picture<'_>, face: &Face) -> (Point, Point) {
    let view = &picture.view;
    let stroke = view.stroke(&face.longest);
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
    let tangent = match stroke.circle {
        None => minus(stroke.to, stroke.from),
        Some((centre, _)) => {
            let [u, v] = minus([x, y], centre);
            if stroke.left() { [-v, u] } else { [v, -u] }
        }
    };
    let length = norm(tangent);
    let [dx, dy] = [tangent[1] / length, tangent[0] / length];
    let [dx, dy] = if dx < -0.98 { [-1.0, 0.0] } else { [dx.min(-0.4), dy] };
    if dy == 0.0 { (at, at) } else { (at, [at[0] + 15.0 * dx, at[1] + 15.0 * dy]) }
}

/// Draws the names of regions that do not fit inside. Returns the x coordinate that they reach.
fn right(picture: &Picture<'_>, marks: &Marks, levels: &[Point], sheet: &mut Sheet) -> f64 {
    let half = picture.view.half;
    let mut rows: Vec<(&str, Point)> = marks
        .unnamed
        .iter()
        .map(|(region, point)| (picture.model.regions[*region].name.as_str(), *point))
        .collect();
    rows.sort_by(|a, b| a.1[1].total_cmp(&b.1[1]));
    let levels: Vec<f64> = levels.iter().map(|level| picture.view.to_sheet(*level)[1]).collect();
    let target_heights: Vec<f64> =
        rows.iter().map(|(_, point)| sheet_height(point[1], &levels)).collect();
    let heights = spread(&target_heights, LINE_SPACING);
    let mut edge = half + 4.0;
    let mut leaders = Vec::new();
    let mut first = 0;
    while first < rows.len() {
        // Notes close together begin at the same distance from the section.
        let end = (first + 1..rows.len())
            .take_while(|k| heights[*k] - heights[*k - 1] < 1.3 * LINE_SPACING)
            .last()
            .unwrap_or(first)
            + 1;
        let low = heights[first].min(rows[first].1[1]) - TEXT_SIZE;
        let high = heights[end - 1].max(rows[end - 1].1[1]) + TEXT_SIZE;
        let side = widest(picture, [low, high]);
        for ((text, point), y) in rows[first..end].iter().zip(&heights[first..end]) {
            let left = side + NOTES_DISTANCE;
            let look = Look { halo: true, ..Look::plain(TEXT_SIZE, Anchor::Left) };
            sheet.text(text, [left + 4.0, *y], look);
            leaders.push([*point, [side + BEND_DISTANCE, point[1]], [left, *y]]);
            edge = edge.max(left + 4.0 + width(text, TEXT_SIZE));
        }
        first = end;
    }
    sheet.path("fill=\"none\" stroke=\"#22272e\" stroke-width=\".7\"", &lines(&leaders));
    sheet.group("fill=\"#22272e\"", |sheet| {
        rows.iter().for_each(|(_, point)| sheet.ring(*point, 1.4));
    });
    edge
}

/// Returns the radius of the tool on the sheet between two heights of the sheet.
fn widest(picture: &Picture<'_>, [low, high]: [f64; 2]) -> f64 {
    let mut widest = 0.0f64;
    for stroke in picture.section.surface() {
        let stroke = picture.view.stroke(stroke);
        let [top, bottom] = stroke.span();
        if top <= high && bottom >= low {
            widest = widest.max(stroke.widest());
        }
    }
    widest
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
    let max_notes = ((picture.view.height + 80.0) / 11.5) as usize;
    while steps.len() > max_notes.max(3) {
        let crowded = |k: &usize| steps[k + 1][1] - steps[k - 1][1];
        let most_crowded =
            (1..steps.len() - 1).min_by(|a, b| crowded(a).total_cmp(&crowded(b))).unwrap_or(1);
        steps.remove(most_crowded);
    }
    steps
}

/// Draws the heights as dimensions along one line from the tip.
fn levels(picture: &Picture<'_>, steps: &[Point], edge: f64, sheet: &mut Sheet) {
    let view = &picture.view;
    let Some(&[_, origin]) = steps.first() else { return };
    let line = edge + 20.0;
    let unit = picture.model.unit;
    let positions: Vec<Point> = steps.iter().map(|step| view.to_sheet(*step)).collect();
    // The order is from the top of the sheet, as `spread` requires.
    let target_heights: Vec<f64> = positions.iter().rev().map(|position| position[1]).collect();
    let texts = spread(&target_heights, 11.5);
    let mut thin = Vec::new();
    let mut heads = Vec::new();
    let mut below = f64::INFINITY;
    for (k, position) in positions.iter().enumerate() {
        let (y, text_y) = (position[1], texts[texts.len() - 1 - k]);
        thin.push(vec![[position[0] + 3.0, y], [line + 4.0, y]]);
        thin.push(vec![[line + 4.0, y], [line + 12.0, text_y]]);
        let last = k + 1 == positions.len();
        if k > 0 && (below - y > 7.0 || last) {
            let [a, b, c] = head([[line, y + 6.0], [line, y]], 6.0);
            heads.push([a, b, c, a]);
            below = y;
        } else if k > 0 {
            thin.push(vec![[line - 2.5, y + 2.5], [line + 2.5, y - 2.5]]);
        } else {
            below = y;
        }
        let mut figure = tidy(steps[k][1] - origin, unit);
        if last {
            figure = format!("{figure} {}", unit.symbol());
        }
        sheet.text(&figure, [line + 15.0, text_y], Look::plain(TEXT_SIZE, Anchor::Left));
    }
    thin.push(vec![[line, positions[0][1]], [line, positions[positions.len() - 1][1]]]);
    sheet.path(
        &format!("fill=\"none\" stroke=\"{SECONDARY_COLOUR}\" stroke-width=\".7\""),
        &lines(&thin),
    );
    sheet.path(&format!("fill=\"{SECONDARY_COLOUR}\""), &lines(&heads));
    sheet.group(
        &format!("fill=\"#fff\" stroke=\"{SECONDARY_COLOUR}\" stroke-width=\".9\""),
        |sheet| {
            sheet.ring([line, positions[0][1]], 2.4);
        },
    );
}

/// Returns positions for notes with preferred positions `target_heights`, which are in ascending order. No two are
/// nearer than `gap`; notes that would crowd are centred on the mean of their preferred positions.
fn spread(target_heights: &[f64], gap: f64) -> Vec<f64> {
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

/// Lengths that differ by less than this fraction of the tool's size are considered equal.
const LENGTH_TOLERANCE_FRACTION: f64 = 1e-7;

/// The dimension of a face.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Measure {
    /// A cylinder, by its radius.
    Cylinder(f64),
    /// An arc, by its centre and radius.
    Arc(Point, f64),
    /// A cone, by its angle to the axis in degrees.
    Cone(f64),
    /// No dimension.
    Other,
}

/// All parts of a surface on one cylinder or one arc; or a single other stroke of it.
#[derive(Clone, Debug)]
struct Face {
    surface: usize,
    measure: Measure,
    /// The total length.
    length: f64,
    /// The longest stroke.
    longest: Stroke,
}

impl Face {
    /// Returns the dimension as text.
    fn figure(&self, unit: Unit) -> Option<String> {
        match self.measure {
            Measure::Cylinder(radius) => Some(format!("⌀{}", tidy(2.0 * radius, unit))),
            Measure::Arc(_, radius) => Some(format!("R{}", tidy(radius, unit))),
            Measure::Cone(angle) => Some(format!("{}° a side", trimmed(&format!("{angle:.2}")))),
            Measure::Other => None,
        }
    }

    /// Returns whether the dimension is always noted. That of a cone is not, since it is often only a broken edge.
    fn is_telling(&self) -> bool {
        matches!(self.measure, Measure::Cylinder(_) | Measure::Arc(..))
    }
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
        text if text == "0" && value.abs() > 1e-12 => {
            touchoff_dsl::diagnostic::format_number(value)
        }
        text => text,
    }
}

/// Removes trailing zeros of a decimal number.
fn trimmed(text: &str) -> String {
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".to_owned() } else { text.to_owned() }
}

/// Returns the faces of the surface.
fn faces(section: &Section, size: f64) -> Vec<Face> {
    let mut faces: Vec<Face> = Vec::new();
    for Edge { surface, strokes, exact } in &section.edges {
        for stroke in strokes {
            let measure = if *exact { measure(stroke, size) } else { Measure::Other };
            let length = stroke.length();
            let known = faces
                .iter_mut()
                .find(|face| face.surface == *surface && are_equal(face.measure, measure, size));
            match known {
                Some(face) => {
                    face.length += length;
                    // The first of equal strokes stays, whatever the rounding of their lengths.
                    if length > face.longest.length() * (1.0 + LENGTH_TOLERANCE_FRACTION) {
                        face.longest = *stroke;
                    }
                }
                None => faces.push(Face { surface: *surface, measure, length, longest: *stroke }),
            }
        }
    }
    faces
}

fn measure(stroke: &Stroke, size: f64) -> Measure {
    match stroke.circle {
        Some((centre, radius)) => Measure::Arc(centre, radius),
        None if (stroke.from[0] - stroke.to[0]).abs() < LENGTH_TOLERANCE_FRACTION * size => {
            Measure::Cylinder(stroke.from[0] / 2.0 + stroke.to[0] / 2.0)
        }
        None if (stroke.from[1] - stroke.to[1]).abs() > LENGTH_TOLERANCE_FRACTION * size => {
            let [d, z] = [0, 1].map(|k| (stroke.to[k] - stroke.from[k]).abs());
            Measure::Cone(d.atan2(z).to_degrees())
        }
        _ => Measure::Other,
    }
}

fn are_equal(a: Measure, b: Measure, size: f64) -> bool {
    let near = |a: f64, b: f64| (a - b).abs() < LENGTH_TOLERANCE_FRACTION * size;
    match (a, b) {
        (Measure::Cylinder(a), Measure::Cylinder(b)) => near(a, b),
        (Measure::Arc(p, r), Measure::Arc(q, s)) => {
            near(r, s) && near(p[0], q[0]) && near(p[1], q[1])
        }
        _ => false,
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
        let (Some(first), Some(last)) = (edge.strokes.first(), edge.strokes.last()) else {
            continue;
        };
        // A joint within one face is no height of its own.
        let goes_on = section.edges.iter().any(|before| {
            before.surface == edge.surface
                && before.strokes.last().is_some_and(|before| {
                    norm(minus(before.to, first.from)) < near && one(before, first, size)
                })
        });
        if !goes_on {
            steps.push(first.from);
        }
        let is_joint = |after: &Stroke| norm(minus(after.from, last.to)) < near;
        if !section.edges.iter().any(|after| after.strokes.first().is_some_and(is_joint)) {
            steps.push(last.to);
        }
    }
    // An arc may reach beyond its ends.
    let mut ends: Option<[Point; 2]> = None;
    let mut widest = 0.0f64;
    for stroke in section.surface() {
        let [low, high] = stroke.span();
        let d = stroke.from[0].max(stroke.to[0]);
        widest = widest.max(stroke.from[0]);
        let [lowest, highest] = ends.unwrap_or([[d, low], [d, high]]);
        ends = Some([
            if low < lowest[1] { [d, low] } else { lowest },
            if high > highest[1] { [d, high] } else { highest },
        ]);
    }
    steps.extend(ends.into_iter().flatten().map(|[d, z]| [d.min(widest), z]));
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
            cross(u, v).abs() < 1e-6 * lengths && dot(u, v) > 0.0
        }
        (Some((p, r)), Some((q, s))) => {
            norm(minus(p, q)) + (r - s).abs() < LENGTH_TOLERANCE_FRACTION * size
        }
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use super::spread;

    #[test]
    fn notes_keep_their_spacing_and_stay_near_their_anchors() {
        assert_eq!(spread(&[0.0, 30.0, 60.0], 10.0), [0.0, 30.0, 60.0]);
        assert_eq!(spread(&[0.0, 0.0], 10.0), [-5.0, 5.0]);
        let heights = spread(&[0.0, 1.0, 2.0, 3.0, 50.0], 10.0);
        assert!(heights.windows(2).all(|pair| pair[1] - pair[0] >= 10.0 - 1e-9));
        assert_eq!(heights[4], 50.0);
    }
}
