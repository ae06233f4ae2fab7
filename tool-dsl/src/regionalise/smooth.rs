//! An outline whose corners are rounded, of which directions are taken.
//!
//! A corner is rounded by the arc that touches both edges at a distance `w` from it, the tangent
//! length; its radius is `w / tan(θ/2)`, θ being the turn. Normals of the rounded outline turn
//! steadily, so a direction that follows them does not jump along the surface.

use super::outline::{Circle, Place, Segment, doubles, turn};
use crate::number::Number;

/// Where a piece of the rounded outline comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Origin {
    /// A piece of the outline, by its place.
    Piece(usize),
    /// The corner behind a piece; before the first for `None`.
    Fan(Option<usize>),
}

/// Why an outline cannot be rounded.
pub(crate) enum Rough {
    /// The corner behind a piece joins an arc.
    Round(Option<usize>),
    /// A piece is too short for its corners: its length, and how many there are.
    Short(usize, f64, usize),
}

/// The rounded outline with the origin of each piece.
pub(crate) fn rounded(
    outline: &[Segment],
    length: &Number,
) -> Result<Vec<(Segment, Origin)>, Rough> {
    let count = outline.len();
    // Corner k lies before piece k; the last behind all.
    let corners: Vec<Option<Corner>> =
        (0..=count).map(|k| corner(outline, k, length)).collect::<Result<_, _>>()?;
    let ends = |k: usize| usize::from(corners[k].is_some()) + usize::from(corners[k + 1].is_some());
    let room = |k: &usize| outline[*k].chord() / ends(*k) as f64;
    if let Some(tightest) = (0..count).min_by(|a, b| room(a).total_cmp(&room(b)))
        && length.to_f64() > room(&tightest) * (1.0 + 1e-12)
    {
        return Err(Rough::Short(tightest, outline[tightest].chord(), ends(tightest)));
    }
    let mut pieces = Vec::new();
    for (k, segment) in outline.iter().enumerate() {
        let (before, after) = (&corners[k], &corners[k + 1]);
        if k == 0
            && let Some(corner) = before
        {
            pieces.push((corner.arc(segment), Origin::Fan(None)));
        }
        let used = length.to_f64() * ends(k) as f64;
        if used < segment.chord() * (1.0 - 1e-12) {
            let from = before.as_ref().map_or(&segment.from, |corner| &corner.to);
            let to = after.as_ref().map_or(&segment.to, |corner| &corner.from);
            let ends = [from.clone(), to.clone()];
            let whole = Segment::new(ends, segment.circle.clone(), segment.surface, segment.span);
            pieces.push((whole, Origin::Piece(k)));
        }
        if let Some(corner) = after {
            pieces.push((corner.arc(segment), Origin::Fan(Some(k))));
        }
    }
    Ok(pieces)
}

/// A corner's arc.
struct Corner {
    from: Place,
    to: Place,
    circle: Circle,
}

impl Corner {
    fn arc(&self, beside: &Segment) -> Segment {
        let ends = [self.from.clone(), self.to.clone()];
        Segment::new(ends, Some(self.circle.clone()), beside.surface, beside.span)
    }
}

fn corner(outline: &[Segment], k: usize, length: &Number) -> Result<Option<Corner>, Rough> {
    let behind = k.checked_sub(1);
    let (before, after) = (behind.map(|k| &outline[k]), outline.get(k));
    // At the axis the outline meets its mirror image.
    let mirrored = |t: [f64; 2]| [t[0], -t[1]];
    let incoming = before.map(|s| s.tangent(true));
    let outgoing = after.map(|s| s.tangent(false));
    let (Some(a), Some(b)) =
        (incoming.or(outgoing.map(mirrored)), outgoing.or(incoming.map(mirrored)))
    else {
        return Ok(None);
    };
    let turned = turn(a, b);
    if turned == 0.0 {
        return Ok(None);
    }
    let line = |segment: Option<&Segment>| match segment {
        Some(segment) if segment.circle.is_some() => Err(Rough::Round(behind)),
        Some(segment) => Ok(segment.direction()),
        None => Ok(None),
    };
    let mirror = |[d, z]: &Place| [d.clone(), -z];
    let (first, last) = (line(before)?, line(after)?);
    let a = first.clone().or_else(|| last.as_ref().map(mirror)).ok_or(Rough::Round(behind))?;
    let b = last.or_else(|| first.as_ref().map(mirror)).ok_or(Rough::Round(behind))?;
    let place = match (before, after) {
        (Some(before), _) => &before.to,
        (None, Some(after)) => &after.from,
        (None, None) => return Ok(None),
    };
    let along = |way: &Place, by: &Number| [0, 1].map(|k| &place[k] + &(&way[k] * by));
    let (from, to) = (along(&a, &-length), along(&b, length));
    let sine = &(&a[0] * &b[1]) - &(&a[1] * &b[0]);
    let cosine = &(&a[0] * &b[0]) + &(&a[1] * &b[1]);
    // 1 / tan(θ/2) = (1 + cos θ) / |sin θ|
    let radius =
        (&(&Number::int(1) + &cosine) * length).over(&sine.abs()).ok_or(Rough::Round(behind))?;
    let toward = if turned > 0.0 { radius.clone() } else { -&radius };
    let centre = [&from[0] - &(&a[1] * &toward), &from[1] + &(&a[0] * &toward)];
    let circle = Circle { centre, radius, convex: turned > 0.0 };
    // Half of an arc that crosses the axis is the mirror image's.
    let pole = |start: &Place| {
        let up = doubles(start)[1] > doubles(&circle.centre)[1];
        let reach = if up { circle.radius.clone() } else { -&circle.radius };
        [Number::int(0), &circle.centre[1] + &reach]
    };
    let axis = Number::int(0);
    let centred = |circle: &Circle| Circle {
        centre: [axis.clone(), circle.centre[1].clone()],
        ..circle.clone()
    };
    Ok(Some(match (before, after) {
        (None, _) => Corner { from: pole(&to), to, circle: centred(&circle) },
        (_, None) => Corner { to: pole(&from), from, circle: centred(&circle) },
        _ => Corner { from, to, circle },
    }))
}
