//! One compiled profile against brute force.

use super::outline::{Outline, P2};
use touchoff::Level;
use touchoff::tool::{Interpreted, PointEvaluation, Tool};
use touchoff_dsl::CheckedTool;
use touchoff_dsl::interpret::Interpreter;
use touchoff_tests::evaluations::{evaluate_points, of_reference};
use touchoff_tests::oracle::profile::Feature;
use touchoff_tests::oracle::rng::Rng;
use touchoff_tests::oracle::segment::Segment;
use touchoff_tests::oracle::vector::{add, cross, norm, sub};

pub(crate) type Flaw = (&'static str, String);

/// Returns points anywhere, beside the surface, beside borders, on the axis, at the corners, and where borders meet.
pub(crate) fn points(outline: &Outline, count: usize, rng: &mut Rng) -> Vec<P2> {
    let size = outline.size();
    let [low, high] = outline.profile.extent();
    let span = sub(&high, &low).map(|component| component.max(0.05 * size));
    let random_point = |rng: &mut Rng| {
        let d = rng.between(0.0, high[0] + 0.2 * span[0]);
        [d, rng.between(low[1] - 0.2 * span[1], high[1] + 0.2 * span[1])]
    };
    let random_small_distance = |rng: &mut Rng| size * rng.power(-6.0, -2.0);
    let mut all: Vec<P2> =
        (0..=outline.segments().len()).map(|k| *outline.profile.vertex(k)).collect();
    for k in 0..count {
        all.push(match k % 8 {
            0..3 => random_point(rng),
            3 => [0.0, random_point(rng)[1]],
            4 | 5 => {
                let piece = &outline.segments()[rng.bits() as usize % outline.segments().len()];
                let on = piece.at(rng.between(0.0, 1.0));
                let offset = random_small_distance(rng) * if rng.once_in(2) { 1.0 } else { -1.0 };
                add(&on, &piece.outward(&on), &offset)
            }
            _ => {
                let (mut a, mut b) = (random_point(rng), random_point(rng));
                let kind =
                    |p: P2| (outline.profile.nearest(&p).feature, outline.profile.encloses(&p));
                let from = kind(a);
                // Halves a segment down to a point where the nearest feature, or inside and outside, change, and
                // steps aside from it.
                for _ in 0..40 {
                    let middle = [0, 1].map(|k| f64::midpoint(a[k], b[k]));
                    if kind(middle) == from { a = middle } else { b = middle }
                }
                let direction = rng.direction();
                add(&a, &[direction[0], direction[1]], &random_small_distance(rng))
            }
        });
    }
    all.extend(points_of_ties(outline, count / 16, rng));
    all.iter_mut().for_each(|p| p[0] = p[0].abs());
    all
}

/// Returns points where borders meet, and the doubles beside them, of which rounding says on which side of each they are: centres of
/// arcs, meetings of the lines and circles of two segments, and points, found from `count` others, with three nearest features.
fn points_of_ties(outline: &Outline, count: usize, rng: &mut Rng) -> Vec<P2> {
    let segments = outline.segments();
    let mut all: Vec<P2> = segments.iter().filter_map(Segment::centre).copied().collect();
    for (k, one) in segments.iter().enumerate() {
        for other in &segments[..k] {
            let values =
                |p: P2| [one, other].map(|segment| (segment.inward(&p), segment.outward(&p)));
            all.extend([one.from, one.to, other.from, other.to].map(|start| root(start, values)));
        }
    }
    let [low, high] = outline.profile.extent();
    for _ in 0..count {
        let start = [rng.between(0.0, high[0]), rng.between(low[1], high[1])];
        let mut owners = outline.profile.owners().to_vec();
        let distance = |feature: &Feature, p: &P2| outline.profile.distance(*feature, p);
        all.push(root(start, |p| {
            owners.sort_by(|a, b| distance(a, &p).total_cmp(&distance(b, &p)));
            let [first, others @ ..] = [0, 1, 2].map(|k| {
                let feature = owners[k.min(owners.len() - 1)];
                (distance(&feature, &p), outline.profile.direction(feature, &p))
            });
            others.map(|(value, outward)| (value - first.0, sub(&outward, &first.1)))
        }));
    }
    let reach = 2.0 * outline.size();
    all.retain(|p| p.iter().all(|part| part.abs() <= reach));
    let beside = |p: P2| {
        let around = p.map(|x| [x, x.next_up(), x.next_down()]);
        [[0, 0], [1, 0], [2, 0], [0, 1], [0, 2]].map(|by| [0, 1].map(|k| around[k][by[k]]))
    };
    all.into_iter().flat_map(beside).collect()
}

/// Returns where two values are 0, by Newton's method; each comes with the direction in which it falls as fast as the point moves.
fn root(mut p: P2, mut values: impl FnMut(P2) -> [(f64, P2); 2]) -> P2 {
    for _ in 0..50 {
        let [(one, a), (other, b)] = values(p);
        let step = [one * b[1] - other * a[1], other * a[0] - one * b[0]];
        let moved = add(&p, &step, &(1.0 / cross(&a, &b)));
        if !moved.iter().all(|part| part.is_finite()) {
            break;
        }
        p = moved;
    }
    p
}

/// Compares the reference and the planned tool with brute force at `count` points.
pub(crate) fn compare(
    outline: &Outline,
    (tool, planned): (&CheckedTool, &Interpreted),
    count: usize,
    rng: &mut Rng,
) -> Result<(), Flaw> {
    let mut reference = Interpreter::new(tool);
    let turned = points(outline, count, rng).into_iter().map(|p| outline.turned(p));
    let points_in_space: Vec<[f64; 3]> = turned.map(|[d, z]| [d, 0.0, z]).collect();
    let planned_evaluations = evaluate_points(planned, Level::new(), &points_in_space);
    for (point, found) in points_in_space.into_iter().zip(planned_evaluations) {
        let p = outline.back([point[0], point[2]]);
        let at = |(kind, text): Flaw, who: &str| {
            let vertex = (0..=outline.segments().len()).any(|k| *outline.profile.vertex(k) == p);
            let kind = match (p[0] == 0.0, vertex) {
                (_, true) => "wrong at a vertex",
                (true, _) => "wrong on the axis",
                _ => kind,
            };
            (kind, format!("{who}, at {p:?}: {text}"))
        };
        let clearance = planned.clearance(point);
        let describe_evaluation = |found: Option<PointEvaluation>| {
            found.map_or("outside", |found| tool.model.regions[found.region].name.as_str())
        };
        let results =
            [("reference", reference.evaluate(point, 1.0).map(of_reference)), ("plan", found)];
        for (who, got) in results {
            let who = || format!("{who} says {}", describe_evaluation(got));
            check_point(outline, tool, p, got, clearance).map_err(|flaw| at(flaw, &who()))?;
        }
    }
    Ok(())
}

/// Returns the feature that a region is named after: `s3` is piece 3, `s3/s4.1` the corner between pieces 3 and 4.
/// The number after the point tells regions of one name apart.
pub(crate) fn feature(outline: &Outline, name: &str) -> Option<Feature> {
    let number = |word: &str| word.strip_prefix('s')?.parse::<usize>().ok();
    let Some((a, b)) = name.split_once('/') else { return number(name).map(Feature::Segment) };
    let (a, b) = (number(a)?, number(b.split_once('.')?.0)?);
    let last = outline.segments().len() - 1;
    match (a.min(b), a.max(b)) {
        (low, high) if high == low + 1 => Some(Feature::Corner(high)),
        // At the axis the piece meets itself.
        (0, 0) if last > 0 || outline.profile.turn(0) < 0.0 => Some(Feature::Corner(0)),
        (low, high) if low == high && low == last => Some(Feature::Corner(last + 1)),
        _ => None,
    }
}

fn check_point(
    outline: &Outline,
    tool: &CheckedTool,
    p: P2,
    got: Option<PointEvaluation>,
    clearance: f64,
) -> Result<(), Flaw> {
    let size = outline.size();
    let tolerance = 1e-12 * size;
    let least = outline.profile.depth(&p).abs();
    let inside = outline.profile.encloses(&p);
    // Within the tolerance of the surface either side is right.
    let is_clear_of_surface = least > tolerance;
    if is_clear_of_surface && got.is_some() != inside {
        return Err(("wrong side", format!("inside is {inside}, distance {least:e}")));
    }
    if is_clear_of_surface && (clearance > 0.0) == inside {
        return Err(("wrong side", format!("clearance {clearance}, inside is {inside}")));
    }
    if clearance < -tolerance || clearance.is_nan() {
        return Err(("wrong clearance", format!("{clearance} is below 0")));
    }
    let Some(got) = got else {
        if is_clear_of_surface && (clearance - least).abs() > tolerance {
            return Err(("wrong clearance", format!("{clearance} is not {least}")));
        }
        return Ok(());
    };
    if !((got.depth - least).abs() <= tolerance && got.magnitude == got.depth) {
        return Err(("wrong depth", format!("{} is not {least}", got.depth)));
    }
    let name = &tool.model.regions[got.region].name;
    let owner = feature(outline, name);
    let excess = owner.map_or(f64::INFINITY, |owner| outline.excess(owner, p));
    let Some(owner) = owner.filter(|_| excess <= tolerance) else {
        return Err(("wrong owner", format!("{name} is {excess:e} farther than the nearest")));
    };
    // The distance to the nearest point at which the direction does not exist.
    let direction = outline.profile.direction(owner, &p);
    let distance_to_singularity = match owner {
        Feature::Segment(k) => {
            let segment = &outline.segments()[k];
            let to_centre = segment.centre().map_or(f64::INFINITY, |c| norm(&sub(&p, c)));
            to_centre.min(norm(&sub(&segment.to, &segment.from)))
        }
        Feature::Corner(_) => least,
    };
    let length = got.direction.iter().map(|component| component * component).sum::<f64>().sqrt();
    if !((length - 1.0).abs() < 1e-14 && got.direction[1] == 0.0) {
        return Err(("wrong direction", format!("{:?} is no unit vector", got.direction)));
    }
    if distance_to_singularity < 1e-9 * size {
        return Ok(());
    }
    let direction = if outline.down { [direction[0], -direction[1]] } else { direction };
    let off = norm(&sub(&[got.direction[0], got.direction[2]], &direction));
    if off > 1e-13 + 1e-13 * size / distance_to_singularity {
        return Err(("wrong direction", format!("{:?} is not {direction:?}", got.direction)));
    }
    Ok(())
}
