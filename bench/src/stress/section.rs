//! Points of a half plane that are equally near to three or more features of a profile: the vertices of the subdivision
//! by nearest feature, inside and outside.
//!
//! Features are the segments, each for the points whose foot lies on it, and the vertices, each for its fan. Borders
//! are the points equally far from two features, and the edges of fans, where a segment and its end are equally far.
//! Every two borders are intersected by Newton's method. An intersection is kept if no other feature is nearer. All
//! computations are in doubles: the points found are validated in 256 bits wherever they are.

use touchoff_tests::oracle::restated::Restated;
use touchoff_tests::oracle::rng::Rng;

type P2 = [f64; 2];

/// A point, and the number of features that it is equally near to.
#[derive(Clone, Copy, Debug)]
pub(super) struct EquidistantPoint {
    /// The point as `[d, z]`.
    pub point: P2,
    /// The number of features.
    pub features: usize,
}

#[derive(Clone, Copy)]
enum Feature {
    Line { from: P2, direction: P2, length: f64 },
    Arc { centre: P2, radius: f64, ends: [P2; 2], sense: f64 },
    Vertex { point: P2, tangents: [Option<P2>; 2], turn: f64 },
}

/// A border, as the zero set of a function.
#[derive(Clone, Copy)]
enum Border {
    Pair(usize, usize),
    Fan { point: P2, tangent: P2 },
}

fn subtract(a: P2, b: P2) -> P2 {
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
            Feature::Line { from, direction, .. } => {
                let offset = cross(direction, subtract(p, from));
                (offset.abs(), [-direction[1] * offset.signum(), direction[0] * offset.signum()])
            }
            Feature::Arc { centre, radius, .. } => {
                let from_centre = subtract(p, centre);
                let offset = from_centre[0].hypot(from_centre[1]) - radius;
                (offset.abs(), unit(from_centre).map(|c| c * offset.signum()))
            }
            Feature::Vertex { point, .. } => {
                let from_vertex = subtract(p, point);
                (from_vertex[0].hypot(from_vertex[1]), unit(from_vertex))
            }
        }
    }

    /// Returns whether the feature may own a point, on this side of the profile, to a tolerance.
    fn faces(&self, p: P2, tolerance: f64) -> bool {
        match *self {
            Feature::Line { from, direction, length } => {
                (-tolerance..=length + tolerance).contains(&dot(subtract(p, from), direction))
            }
            Feature::Arc { centre, ends, sense, radius } => {
                let (q, [a, b]) =
                    (unit(subtract(p, centre)), ends.map(|end| unit(subtract(end, centre))));
                let tolerance = tolerance / radius;
                sense * cross(a, q) >= -tolerance && sense * cross(q, b) >= -tolerance
            }
            Feature::Vertex { point, tangents, turn } => {
                let from_vertex = subtract(p, point);
                let is_in_fan = tangents.iter().zip([1.0, -1.0]).all(|(tangent, sign)| {
                    tangent.is_none_or(|tangent| sign * dot(from_vertex, tangent) >= -tolerance)
                });
                // A smooth joint owns no points.
                is_in_fan && turn.abs() > 1e-9
            }
        }
    }
}

fn features(tool: &Restated) -> Vec<Feature> {
    let double = |p: &touchoff_tests::oracle::restated::Point| [p[0].to_f64(), p[1].to_f64()];
    let mut point = double(&tool.start);
    let (mut segments, mut corners) = (Vec::new(), vec![point]);
    for step in &tool.segments {
        let to = double(&step.to);
        segments.push(match step.centre.as_ref().map(double) {
            None => {
                let direction = subtract(to, point);
                let length = direction[0].hypot(direction[1]);
                Feature::Line { from: point, direction: unit(direction), length }
            }
            Some(centre) => {
                let (a, b) = (subtract(point, centre), subtract(to, centre));
                let (radius, sense) = (a[0].hypot(a[1]), cross(a, b).signum());
                Feature::Arc { centre, radius, ends: [point, to], sense }
            }
        });
        corners.push(to);
        point = to;
    }
    let tangent = |segment: Option<&Feature>, point: P2| match *segment? {
        Feature::Line { direction, .. } => Some(direction),
        Feature::Arc { centre, sense, .. } => {
            let arm = unit(subtract(point, centre));
            Some([-sense * arm[1], sense * arm[0]])
        }
        Feature::Vertex { .. } => None,
    };
    let vertices: Vec<Feature> = corners
        .iter()
        .enumerate()
        .map(|(k, point)| {
            let before = k.checked_sub(1).and_then(|k| tangent(segments.get(k), *point));
            let after = tangent(segments.get(k), *point);
            let turn = before.zip(after).map_or(1.0, |(before, after)| cross(before, after));
            Feature::Vertex { point: *point, tangents: [before, after], turn }
        })
        .collect();
    segments.extend(vertices);
    segments
}

fn borders(features: &[Feature]) -> Vec<Border> {
    let mut borders = Vec::new();
    for (k, feature) in features.iter().enumerate() {
        borders.extend((0..k).map(|other| Border::Pair(other, k)));
        if let Feature::Vertex { point, tangents, .. } = feature {
            borders.extend(
                tangents.iter().flatten().map(|t| Border::Fan { point: *point, tangent: *t }),
            );
        }
    }
    borders
}

fn residual(features: &[Feature], border: Border, p: P2) -> (f64, P2) {
    match border {
        Border::Pair(a, b) => {
            let ((da, ga), (db, gb)) = (features[a].distance(p), features[b].distance(p));
            (da - db, subtract(ga, gb))
        }
        Border::Fan { point, tangent } => (dot(subtract(p, point), tangent), tangent),
    }
}

/// Intersects two borders by Newton's method. Returns `None` if it does not converge.
fn intersect(features: &[Feature], [a, b]: [Border; 2], mut p: P2, size: f64) -> Option<P2> {
    for _ in 0..30 {
        let ((f, u), (g, v)) = (residual(features, a, p), residual(features, b, p));
        let det = cross(u, v);
        if det.abs() < 1e-9 {
            return None;
        }
        let step = [(f * v[1] - g * u[1]) / det, (u[0] * g - v[0] * f) / det];
        p = subtract(p, step);
        let sum_of_coordinates = p[0].abs() + p[1].abs();
        if sum_of_coordinates.is_nan() || sum_of_coordinates >= 4.0 * size {
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
/// beyond its ends. Only every `stride`-th pair is used.
pub(super) fn find_equidistant_points(
    tool: &Restated,
    size: f64,
    (starts, stride): (usize, usize),
    rng: &mut Rng,
) -> Vec<EquidistantPoint> {
    let features = features(tool);
    let borders = borders(&features);
    let radius = tool.segments.iter().map(|segment| segment.to[0].to_f64()).fold(0.0, f64::max);
    let height = tool.segments.iter().map(|segment| segment.to[1].to_f64()).fold(0.0, f64::max);
    let mut points: Vec<EquidistantPoint> = Vec::new();
    let pairs = borders
        .iter()
        .enumerate()
        .flat_map(|(k, first)| borders[..k].iter().map(move |second| [*first, *second]));
    for pair in pairs.skip(rng.bits() as usize % stride).step_by(stride) {
        for _ in 0..starts {
            let start =
                [rng.between(0.0, 2.0 * radius), rng.between(-0.5 * radius, height + 0.5 * radius)];
            let Some(point) = intersect(&features, pair, start, size) else { continue };
            let Some(count) = nearest_count(&features, point, size) else { continue };
            let is_same = |other: &EquidistantPoint| {
                subtract(other.point, point).iter().all(|c| c.abs() < 1e-9 * size)
            };
            if !points.iter().any(is_same) {
                points.push(EquidistantPoint { point, features: count });
            }
        }
    }
    points
}

/// Returns the number of nearest features. Returns `None` if there are fewer than three, or if the point is on the
/// surface or far away.
fn nearest_count(features: &[Feature], p: P2, size: f64) -> Option<usize> {
    let tolerance = 1e-12 * size;
    if p[0] < 0.0 || p[0] > 2.0 * size || p[1].abs() > 2.0 * size {
        return None;
    }
    let facing = || features.iter().filter(|feature| feature.faces(p, tolerance));
    let min_distance = facing().map(|feature| feature.distance(p).0).fold(f64::INFINITY, f64::min);
    let count =
        facing().filter(|feature| feature.distance(p).0 <= min_distance + tolerance).count();
    (count >= 3 && min_distance > 1e-6 * size).then_some(count)
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchoff_tests::oracle::restated;

    /// In the thesis's frame, the points (5, 13) and (11, 19) outside fig. 7.3 are equally near to four features.
    #[test]
    fn finds_the_known_points_near_four_features() {
        let tool = restated::of("Fig73Exact").expect("it is restated");
        let found = find_equidistant_points(&tool, 32.0, (2, 1), &mut Rng::new(1));
        for known in [[5.0, 7.0], [11.0, 1.0]] {
            let point =
                found.iter().find(|m| subtract(m.point, known).iter().all(|c| c.abs() < 1e-12));
            assert_eq!(point.map(|m| m.features), Some(4), "{known:?} in {found:?}");
        }
    }
}
