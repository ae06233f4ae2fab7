//! Points of a half plane that are equally near to three or more features of a profile: the vertices of the subdivision
//! by nearest feature, inside and outside.
//!
//! Features are the segments, each for the points whose foot lies on it, and the vertices, each for its fan. Borders
//! are the points equally far from two features, and the edges of fans, where a segment and its end are equally far.
//! Every two borders are intersected by Newton's method. An intersection is kept if no other feature is nearer. All
//! computations are in doubles: the points found are validated in 256 bits wherever they are.

use touchoff_tests::oracle::draw::Rng;
use touchoff_tests::oracle::restated::Restated;

type P2 = [f64; 2];

/// A point, and the number of features that it is equally near to.
#[derive(Clone, Copy, Debug)]
pub(super) struct Meeting {
    /// The point as `[d, z]`.
    pub at: P2,
    /// The number of features.
    pub features: usize,
}

#[derive(Clone, Copy)]
enum Feature {
    Line { from: P2, along: P2, length: f64 },
    Arc { centre: P2, radius: f64, ends: [P2; 2], sense: f64 },
    Vertex { at: P2, tangents: [Option<P2>; 2], turn: f64 },
}

/// A border, as the zero set of a function.
#[derive(Clone, Copy)]
enum Border {
    Pair(usize, usize),
    Fan { at: P2, tangent: P2 },
}

fn sub(a: P2, b: P2) -> P2 {
    [a[0] - b[0], a[1] - b[1]]
}
fn dot(a: P2, b: P2) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}
fn cross(a: P2, b: P2) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}
fn unit(a: P2) -> P2 {
    let n = a[0].hypot(a[1]);
    if n > 0.0 { [a[0] / n, a[1] / n] } else { [0.0, 1.0] }
}

impl Feature {
    /// Returns the distance and its gradient.
    fn distance(&self, p: P2) -> (f64, P2) {
        match *self {
            Feature::Line { from, along, .. } => {
                let off = cross(along, sub(p, from));
                (off.abs(), [-along[1] * off.signum(), along[0] * off.signum()])
            }
            Feature::Arc { centre, radius, .. } => {
                let arm = sub(p, centre);
                let off = arm[0].hypot(arm[1]) - radius;
                (off.abs(), unit(arm).map(|c| c * off.signum()))
            }
            Feature::Vertex { at, .. } => {
                let arm = sub(p, at);
                (arm[0].hypot(arm[1]), unit(arm))
            }
        }
    }

    /// Returns whether the feature may own a point, on this side of the profile, to the tolerance `close`.
    fn faces(&self, p: P2, close: f64) -> bool {
        match *self {
            Feature::Line { from, along, length } => {
                (-close..=length + close).contains(&dot(sub(p, from), along))
            }
            Feature::Arc { centre, ends, sense, radius } => {
                let (q, [a, b]) = (unit(sub(p, centre)), ends.map(|end| unit(sub(end, centre))));
                let close = close / radius;
                sense * cross(a, q) >= -close && sense * cross(q, b) >= -close
            }
            Feature::Vertex { at, tangents, turn } => {
                let from = sub(p, at);
                let beside = tangents.iter().zip([1.0, -1.0]).all(|(tangent, sign)| {
                    tangent.is_none_or(|tangent| sign * dot(from, tangent) >= -close)
                });
                // A smooth joint owns no points.
                beside && turn.abs() > 1e-9
            }
        }
    }
}

fn features(tool: &Restated) -> Vec<Feature> {
    let double = |p: &touchoff_tests::oracle::restated::Point| [p[0].to_f64(), p[1].to_f64()];
    let mut at = double(&tool.start);
    let (mut pieces, mut corners) = (Vec::new(), vec![at]);
    for way in &tool.ways {
        let to = double(&way.to);
        pieces.push(match way.centre.as_ref().map(double) {
            None => {
                let along = sub(to, at);
                let length = along[0].hypot(along[1]);
                Feature::Line { from: at, along: unit(along), length }
            }
            Some(centre) => {
                let (a, b) = (sub(at, centre), sub(to, centre));
                let (radius, sense) = (a[0].hypot(a[1]), cross(a, b).signum());
                Feature::Arc { centre, radius, ends: [at, to], sense }
            }
        });
        corners.push(to);
        at = to;
    }
    let tangent = |piece: Option<&Feature>, at: P2| match *piece? {
        Feature::Line { along, .. } => Some(along),
        Feature::Arc { centre, sense, .. } => {
            let arm = unit(sub(at, centre));
            Some([-sense * arm[1], sense * arm[0]])
        }
        Feature::Vertex { .. } => None,
    };
    let vertices: Vec<Feature> = corners
        .iter()
        .enumerate()
        .map(|(k, at)| {
            let before = k.checked_sub(1).and_then(|k| tangent(pieces.get(k), *at));
            let after = tangent(pieces.get(k), *at);
            let turn = before.zip(after).map_or(1.0, |(before, after)| cross(before, after));
            Feature::Vertex { at: *at, tangents: [before, after], turn }
        })
        .collect();
    pieces.extend(vertices);
    pieces
}

fn borders(features: &[Feature]) -> Vec<Border> {
    let mut all = Vec::new();
    for (k, feature) in features.iter().enumerate() {
        all.extend((0..k).map(|other| Border::Pair(other, k)));
        if let Feature::Vertex { at, tangents, .. } = feature {
            all.extend(tangents.iter().flatten().map(|t| Border::Fan { at: *at, tangent: *t }));
        }
    }
    all
}

fn miss(features: &[Feature], border: Border, p: P2) -> (f64, P2) {
    match border {
        Border::Pair(a, b) => {
            let ((da, ga), (db, gb)) = (features[a].distance(p), features[b].distance(p));
            (da - db, sub(ga, gb))
        }
        Border::Fan { at, tangent } => (dot(sub(p, at), tangent), tangent),
    }
}

/// Intersects two borders by Newton's method. Returns `None` if it does not converge.
fn meet(features: &[Feature], [a, b]: [Border; 2], mut p: P2, size: f64) -> Option<P2> {
    for _ in 0..30 {
        let ((f, u), (g, v)) = (miss(features, a, p), miss(features, b, p));
        let det = cross(u, v);
        if det.abs() < 1e-9 {
            return None;
        }
        let step = [(f * v[1] - g * u[1]) / det, (u[0] * g - v[0] * f) / det];
        p = sub(p, step);
        let far = p[0].abs() + p[1].abs();
        if far.is_nan() || far >= 4.0 * size {
            return None;
        }
        if step[0].abs().max(step[1].abs()) < 1e-15 * size {
            return Some(p);
        }
    }
    None
}

/// Returns points off the surface with three or more nearest features, inside and outside. Newton's method begins at
/// `starts` random points per pair of borders: up to twice the tool's radius from the axis, and up to half its radius
/// beyond its ends. Only every `every`-th pair is used.
pub(super) fn meetings(
    tool: &Restated,
    size: f64,
    (starts, every): (usize, usize),
    draw: &mut Rng,
) -> Vec<Meeting> {
    let features = features(tool);
    let borders = borders(&features);
    let radius = tool.ways.iter().map(|way| way.to[0].to_f64()).fold(0.0, f64::max);
    let height = tool.ways.iter().map(|way| way.to[1].to_f64()).fold(0.0, f64::max);
    let mut found: Vec<Meeting> = Vec::new();
    let pairs = borders
        .iter()
        .enumerate()
        .flat_map(|(k, one)| borders[..k].iter().map(move |other| [*one, *other]));
    for pair in pairs.skip(draw.bits() as usize % every).step_by(every) {
        for _ in 0..starts {
            let start = [
                draw.between(0.0, 2.0 * radius),
                draw.between(-0.5 * radius, height + 0.5 * radius),
            ];
            let Some(at) = meet(&features, pair, start, size) else { continue };
            let Some(count) = equals(&features, at, size) else { continue };
            let near = |other: &Meeting| sub(other.at, at).iter().all(|c| c.abs() < 1e-9 * size);
            if !found.iter().any(near) {
                found.push(Meeting { at, features: count });
            }
        }
    }
    found
}

/// Returns the number of nearest features. Returns `None` if there are fewer than three, or if the point is on the
/// surface or far away.
fn equals(features: &[Feature], p: P2, size: f64) -> Option<usize> {
    let close = 1e-12 * size;
    if p[0] < 0.0 || p[0] > 2.0 * size || p[1].abs() > 2.0 * size {
        return None;
    }
    let here = || features.iter().filter(|feature| feature.faces(p, close));
    let least = here().map(|feature| feature.distance(p).0).fold(f64::INFINITY, f64::min);
    let count = here().filter(|feature| feature.distance(p).0 <= least + close).count();
    (count >= 3 && least > 1e-6 * size).then_some(count)
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchoff_tests::oracle::restated;

    /// In the thesis's frame, the points (5, 13) and (11, 19) outside fig. 7.3 are equally near to four features.
    #[test]
    fn the_ones_that_are_known() {
        let tool = restated::of("Fig73Exact").expect("it is restated");
        let found = meetings(&tool, 32.0, (2, 1), &mut Rng::new(1));
        for known in [[5.0, 7.0], [11.0, 1.0]] {
            let meeting = found.iter().find(|m| sub(m.at, known).iter().all(|c| c.abs() < 1e-12));
            assert_eq!(meeting.map(|m| m.features), Some(4), "{known:?} in {found:?}");
        }
    }
}
