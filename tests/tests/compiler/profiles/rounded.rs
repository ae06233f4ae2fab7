//! Profiles with rounded corners, by growing balls: nothing is shared with the compiler.

use super::outline::{Outline, P2};
use touchoff_tests::oracle::plane::{add, norm, sub};
use touchoff_tests::oracle::segment::Segment;

/// Returns the pieces of a profile, shortened where arcs round its corners.
pub(crate) fn rounded(outline: &Outline, w: f64) -> Vec<Segment<f64>> {
    let pieces = outline.segments();
    let fans: Vec<Option<Segment<f64>>> = (0..=pieces.len()).map(|k| fan(outline, k, w)).collect();
    let mut rounded: Vec<Segment<f64>> = Vec::new();
    for (k, piece) in pieces.iter().enumerate() {
        if k == 0 {
            rounded.extend(fans[0]);
        }
        let from = fans[k].map_or(piece.from, |fan| fan.to);
        let to = fans[k + 1].map_or(piece.to, |fan| fan.from);
        if norm(&sub(&to, &from)) > 1e-9 {
            rounded.push(piece.between(from, to));
        }
        rounded.extend(fans[k + 1]);
    }
    rounded
}

/// Returns the arc of the corner before a piece, behind the last for their number, if the profile turns there. It
/// is the ball at `w` from the corner on one of its pieces, grown until it touches the other.
fn fan(outline: &Outline, k: usize, w: f64) -> Option<Segment<f64>> {
    let turn = outline.profile.turn(k);
    if turn.abs() < 1e-9 {
        return None;
    }
    let side = turn.signum();
    let away = |piece: &Segment<f64>, at_end: bool| {
        let part = w / piece.length();
        let from = piece.at(if at_end { 1.0 - part } else { part });
        (from, piece.outward(&from).map(|part| -side * part))
    };
    let before = k.checked_sub(1).map(|k| (&outline.segments()[k], true));
    let pieces = [before, outline.segments().get(k).map(|piece| (piece, false))];
    let corner = outline.profile.vertex(k);
    let arc = |from: P2, to: P2, centre: P2| Segment::about(from, to, centre, turn > 0.0);
    if let [None, Some((piece, at_end))] | [Some((piece, at_end)), None] = pieces {
        let (from, normal) = away(piece, at_end);
        let centre = add(&from, &normal, &(-from[0] / normal[0]));
        let radius = norm(&sub(&from, &centre));
        let up = if at_end == (turn > 0.0) { radius } else { -radius };
        let (centre, pole) = ([0.0, centre[1]], [0.0, centre[1] + up]);
        return Some(if at_end { arc(from, pole, centre) } else { arc(pole, from, centre) });
    }
    let [Some(before), Some(after)] = pieces else { return None };
    let found = [(before, after), (after, before)].map(|(one, other)| {
        let (from, normal) = away(one.0, one.1);
        let (mut radius, mut most) = (0.0, 1e3);
        for _ in 0..200 {
            let middle = f64::midpoint(radius, most);
            let free = side * other.0.inward(&add(&from, &normal, &middle)) > middle;
            if free { radius = middle } else { most = middle }
        }
        let centre = add(&from, &normal, &radius);
        let to = add(&centre, &other.0.outward(&centre), &(side * radius));
        let piece = if one.1 { arc(from, to, centre) } else { arc(to, from, centre) };
        (norm(&sub(&to, corner)), piece)
    });
    // The nearer of the two touches both pieces no farther than `w`.
    found.into_iter().min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, piece)| piece)
}

pub(crate) fn lowered(piece: &Segment<f64>, by: f64) -> Segment<f64> {
    piece.map(|p| add(p, &[0.0, by], &-1.0), f64::clone)
}
