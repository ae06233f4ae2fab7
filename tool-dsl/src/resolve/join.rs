//! Joins one outline onto another at a plane, with the ring between them.

use crate::geometry::outline::{Circle, ExactPoint, Segment, doubles};
use crate::number::Number;

/// Lengths below this fraction of the tool's size are rounding errors.
const ROUNDING: f64 = 1e-12;
/// The largest distance of a tool's end from its stated tip, in sizes of the tool.
pub(super) const TIP_TOLERANCE_FRACTION: f64 = 1e-6;

/// The reason why two outlines cannot be joined at a plane.
#[derive(Debug)]
pub(super) enum JoinError {
    /// The lower outline ends below the plane.
    Short,
    /// The lower outline meets the axis at the plane.
    Point,
    /// The lower outline crosses the plane again, with this segment.
    Back(Box<Segment>),
    /// The upper outline begins not with a flat face but with this segment.
    NoFace(Box<Segment>),
}

/// Returns an outline with its lengths multiplied by `scale`, then moved along the axis by `by`. Surface indices are
/// increased by `first`.
pub(super) fn transformed_outline(
    outline: &[Segment],
    scale: &Number,
    by: &Number,
    first: usize,
) -> Vec<Segment> {
    let transformed = |[d, z]: &ExactPoint| [d * scale, &(z * scale) + by];
    let transformed_outline = |segment: &Segment| {
        let circle = segment.circle.as_ref().map(|circle| Circle {
            centre: transformed(&circle.centre),
            radius: &circle.radius * scale,
            convex: circle.convex,
        });
        let ends = [transformed(&segment.from), transformed(&segment.to)];
        Segment::new(ends, circle, segment.surface + first, segment.span)
    };
    outline.iter().map(transformed_outline).collect()
}

/// Returns the outline of the solid `lower` below a plane across the axis and of the solid `upper` above it. `upper`
/// has to begin at the plane. The ring between their radii at the plane belongs to the wider solid.
///
/// # Errors
///
/// If `lower` does not cross the plane exactly once away from the axis, or if `upper` has no flat face there.
pub(super) fn join(
    lower: &[Segment],
    upper: &[Segment],
    plane: &Number,
) -> Result<Vec<Segment>, JoinError> {
    let slack = ROUNDING * size(lower).max(size(upper));
    let mut joined = below(lower, plane, slack)?;
    let Some(last) = joined.last() else { return Err(JoinError::Short) };
    let (radius, ring) = (last.to[0].clone(), (last.surface, last.span));
    if radius.to_f64() <= slack {
        return Err(JoinError::Point);
    }
    let (height, off_tip) = (plane.to_f64(), TIP_TOLERANCE_FRACTION * size(upper));
    let flat = |segment: &&Segment| {
        let [[inner, a], [outer, b]] = segment.ends();
        let level = [a, b].into_iter().all(|z| (z - height).abs() <= off_tip);
        segment.circle.is_none() && level && inner < outer
    };
    let faces = upper.iter().take_while(flat).count();
    let (face, rest) = upper.split_at(faces);
    let (Some(rim), Some((wall, rest))) = (face.last(), rest.split_first()) else {
        return Err(JoinError::NoFace(Box::new(upper.first().unwrap_or(last).clone())));
    };
    let on_plane = |d: &Number| [d.clone(), plane.clone()];
    let mut at = on_plane(&radius);
    let (inner, outer) = (radius.to_f64(), rim.to[0].to_f64());
    if inner > outer + slack {
        let to = on_plane(&rim.to[0]);
        joined.push(Segment::new([at, to.clone()], None, ring.0, ring.1));
        at = to;
    }
    for segment in face.iter().filter(|segment| segment.to[0].to_f64() > inner + slack) {
        let to = on_plane(&segment.to[0]);
        joined.push(Segment::new([at, to.clone()], None, segment.surface, segment.span));
        at = to;
    }
    let ends = [at, wall.to.clone()];
    joined.push(Segment::new(ends, wall.circle.clone(), wall.surface, wall.span));
    joined.extend(rest.iter().cloned());
    Ok(joined)
}

/// Returns the surface that rises highest above a plane, and the height of its end, among those for which `counts` holds.
pub(super) fn highest_above(
    outline: &[Segment],
    plane: &Number,
    counts: impl Fn(usize) -> bool,
) -> Option<(usize, f64)> {
    let slack = ROUNDING * size(outline);
    outline
        .iter()
        .filter(|segment| counts(segment.surface))
        .map(|segment| (segment.surface, segment.ends()[1][1]))
        .filter(|(_, end)| *end > plane.to_f64() + slack)
        .max_by(|a, b| a.1.total_cmp(&b.1))
}

fn size(outline: &[Segment]) -> f64 {
    let ends = outline.iter().flat_map(|segment| segment.ends());
    ends.flatten().fold(0.0, |size, part| size.max(part.abs()))
}

/// Returns the part of an outline up to a plane, which it has to cross exactly once.
fn below(outline: &[Segment], plane: &Number, slack: f64) -> Result<Vec<Segment>, JoinError> {
    let height = plane.to_f64();
    let side = |z: f64| match z - height {
        off if off.abs() <= slack => 0,
        off if off < 0.0 => -1,
        _ => 1,
    };
    let mut lower_outline: Vec<Segment> = Vec::new();
    let mut reached = false;
    for segment in outline {
        let turning_heights = turning_heights(segment);
        if reached {
            if turning_heights.iter().any(|z| side(*z) < 0) {
                return Err(JoinError::Back(Box::new(segment.clone())));
            }
            continue;
        }
        match turning_heights.iter().position(|z| side(*z) >= 0) {
            None => lower_outline.push(segment.clone()),
            // The plane goes through the first corner of the outline, so nothing lies below it.
            Some(0) => return Err(JoinError::Point),
            Some(stop) => {
                if turning_heights[stop..].iter().any(|z| side(*z) < 0) {
                    return Err(JoinError::Back(Box::new(segment.clone())));
                }
                let at_end = stop + 1 == turning_heights.len() && side(turning_heights[stop]) == 0;
                let d = if at_end { segment.to[0].clone() } else { crossing(segment, plane) };
                let ends = [segment.from.clone(), [d, plane.clone()]];
                let circle = segment.circle.clone();
                lower_outline.push(Segment::new(ends, circle, segment.surface, segment.span));
                reached = true;
            }
        }
    }
    if reached { Ok(lower_outline) } else { Err(JoinError::Short) }
}

/// Returns the z of a segment's ends and, between them, the z at which an arc reverses along the axis.
fn turning_heights(segment: &Segment) -> Vec<f64> {
    let [from, to] = segment.ends().map(|end| end[1]);
    let turns = segment.circle.as_ref().and_then(|circle| {
        let ([_, centre], radius) = (doubles(&circle.centre), circle.radius.to_f64());
        [centre - radius, centre + radius].into_iter().find(|z| {
            let strictly = [from, to].iter().all(|end| (end - z).abs() > ROUNDING * radius);
            let point = [doubles(&circle.centre)[0], *z];
            strictly && segment.sector(point).iter().all(|side| *side > 0.0)
        })
    });
    [Some(from), turns, Some(to)].into_iter().flatten().collect()
}

/// Returns the distance from the axis at which a segment rises through a plane.
fn crossing(segment: &Segment, plane: &Number) -> Number {
    let [[d, z], [to_d, to_z]] = [&segment.from, &segment.to];
    match &segment.circle {
        None => {
            let part = (plane - z).checked_div(&(to_z - z)).unwrap_or_else(|| Number::int(0));
            d + &(&part * &(to_d - d))
        }
        Some(circle) => {
            let height = plane - &circle.centre[1];
            let square = &(&circle.radius * &circle.radius) - &(&height * &height);
            let offset = square.sqrt().unwrap_or_else(|| Number::int(0));
            // The material is on the left, which is toward the axis where the outline rises.
            let offset = if circle.convex { offset } else { -&offset };
            &circle.centre[0] + &offset
        }
    }
}
