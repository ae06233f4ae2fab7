//! Validity of a drawn profile, with room to spare, from points along it.

use super::outline::{Outline, P2};
use touchoff_tests::oracle::segment::Segment;
use touchoff_tests::oracle::vector::{cross, dot, norm, sub};

/// Least distance of a profile from itself, as a fraction of its size.
const MIN_DISTANCE_FRACTION: f64 = 3e-4;
/// Sharpest corner that is allowed, as a sine.
const MIN_CORNER_SINE: f64 = 0.03;
const CHORDS: u32 = 48;

/// Returns whether the profile is valid, and stays so if moved a little.
pub(crate) fn is_valid(outline: &Outline) -> bool {
    let size = outline.size();
    let margin = MIN_DISTANCE_FRACTION * size;
    let pieces = outline.segments();
    let count = pieces.len();
    let [first, last] = [outline.profile.vertex(0), outline.profile.vertex(count)];
    let joined = pieces.windows(2).all(|pair| pair[0].to == pair[1].from);
    assert!(joined && first[0] == 0.0 && last[0] == 0.0, "{outline:?}");
    let lines: Vec<Vec<P2>> = pieces.iter().map(chords).collect();
    let long = |piece: &Segment<f64>| {
        let chord = norm(&sub(&piece.to, &piece.from));
        chord > 0.0
            && chord >= margin
            && piece.circle.is_none_or(|r| r.radius <= 20.0 * size && r.radius >= margin)
            && piece.sweep().abs() <= std::f64::consts::PI * (1.0 + 1e-9)
    };
    let sharp = |k: usize| {
        let [a, b] = outline.profile.tangents(k);
        dot(a, b) < 0.0 && cross(a, b).abs() < MIN_CORNER_SINE
    };
    if !pieces.iter().all(long) || (0..=count).any(sharp) || area(&lines) < margin * size {
        return false;
    }
    for (k, line) in lines.iter().enumerate() {
        // Off the axis, and beside the ends steadily away from it.
        let clear = |p: &P2| {
            let from = norm(&sub(p, first)).min(norm(&sub(p, last)));
            p[0] >= margin.min(MIN_CORNER_SINE * from)
        };
        let ends = usize::from(k == 0)..line.len() - usize::from(k + 1 == count);
        if !line[ends].iter().all(clear) {
            return false;
        }
        for (j, other) in lines.iter().enumerate().skip(k + 1) {
            let joint = (j == k + 1).then(|| *outline.profile.vertex(j));
            if near(line, other, joint, margin) || near(other, line, joint, margin) {
                return false;
            }
        }
    }
    true
}

/// Returns points along a piece; those of lines are close together near the ends.
fn chords(piece: &Segment<f64>) -> Vec<P2> {
    let fraction = |k: u32| f64::from(k) / f64::from(CHORDS);
    let share = |f: f64| if piece.circle.is_some() { f } else { f.powi(2) * (3.0 - 2.0 * f) };
    (0..=CHORDS).map(|k| piece.at(share(fraction(k)))).collect()
}

/// Returns whether a point of one polyline is too near the other, or they cross. Beside a joint they may be as near
/// as it is.
fn near(line: &[P2], other: &[P2], joint: Option<P2>, margin: f64) -> bool {
    let limit = |p: P2| {
        joint.map_or(margin, |joint| margin.min(0.5 * MIN_CORNER_SINE * norm(&sub(&p, &joint))))
    };
    line.windows(2).any(|a| {
        other.windows(2).any(|b| {
            let is_adjacent = joint.is_some_and(|joint| {
                a.iter().chain(b).any(|p| norm(&sub(p, &joint)) < 1e-9 * margin)
            });
            Segment::line(b[0], b[1]).distance(&a[1]) < limit(a[1])
                || (!is_adjacent && cross_each_other(a, b))
        })
    })
}

fn cross_each_other(a: &[P2], b: &[P2]) -> bool {
    let side = |a: &[P2], p: P2| cross(&sub(&a[1], &a[0]), &sub(&p, &a[0])) > 0.0;
    side(a, b[0]) != side(a, b[1]) && side(b, a[0]) != side(b, a[1])
}

/// Returns the signed area, positive if the material is on the left.
fn area(lines: &[Vec<P2>]) -> f64 {
    lines.iter().flat_map(|line| line.windows(2)).map(|pair| cross(&pair[0], &pair[1]) / 2.0).sum()
}
