//! Voronoi vertices of the features of a profile: points of a half plane that are equally near to three or more.
//!
//! Features are the segments, each for the points whose foot lies on it, and the corners, each for its fan. Borders
//! are the points equally far from two features, and the edges of fans, where a segment and its end are equally far.
//! Every two borders are intersected by Newton's method. An intersection is kept if no other feature is nearer. All
//! computations are in doubles: the points found are validated in 256 bits wherever they are.

use nalgebra::Vector2;
use touchoff_tests::oracle::restated::{self, Restated};
use touchoff_tests::oracle::rng::Rng;

/// A vector in the half plane, as `[d, z]`.
type Vector = Vector2<f64>;

/// A point, and the number of features that it is equally near to.
#[derive(Clone, Copy, Debug)]
pub(crate) struct VoronoiVertex {
    pub(crate) point: Vector,
    pub(crate) features: usize,
}

/// The extent of a search.
#[derive(Clone, Copy)]
pub(crate) struct Search {
    /// Number of random points per pair of borders at which Newton's method starts.
    pub(crate) starts: usize,
    /// Every `stride`-th pair is taken.
    pub(crate) stride: usize,
}

#[derive(Clone, Copy)]
enum Feature {
    Line {
        from: Vector,
        direction: Vector,
        length: f64,
    },
    /// `sense` is 1 if the arc runs counter-clockwise, otherwise -1.
    Arc {
        centre: Vector,
        radius: f64,
        ends: [Vector; 2],
        sense: f64,
    },
    /// `turn` is the sine of the angle by which the profile turns here.
    Corner {
        point: Vector,
        tangents: [Option<Vector>; 2],
        turn: f64,
    },
}

/// A border, as the zero set of a function.
#[derive(Clone, Copy)]
enum Border {
    Pair(Feature, Feature),
    Fan { point: Vector, tangent: Vector },
}

fn norm(v: Vector) -> f64 {
    v.x.hypot(v.y)
}

fn unit(v: Vector) -> Vector {
    let norm = norm(v);
    if norm > 0.0 { v / norm } else { Vector::y() }
}

impl Feature {
    /// Returns the distance and its gradient.
    fn distance(&self, p: Vector) -> (f64, Vector) {
        match *self {
            Feature::Line { from, direction, .. } => {
                let offset = direction.perp(&(p - from));
                (offset.abs(), offset.signum() * Vector::new(-direction.y, direction.x))
            }
            Feature::Arc { centre, radius, .. } => {
                let offset = norm(p - centre) - radius;
                (offset.abs(), offset.signum() * unit(p - centre))
            }
            Feature::Corner { point, .. } => (norm(p - point), unit(p - point)),
        }
    }

    /// Returns whether the feature may own a point, on this side of the profile, to a tolerance.
    fn faces(&self, p: Vector, tolerance: f64) -> bool {
        match *self {
            Feature::Line { from, direction, length } => {
                (-tolerance..=length + tolerance).contains(&direction.dot(&(p - from)))
            }
            Feature::Arc { centre, ends, sense, radius } => {
                let [a, b] = ends.map(|end| unit(end - centre));
                let q = unit(p - centre);
                let angle = tolerance / radius;
                sense * a.perp(&q) >= -angle && sense * q.perp(&b) >= -angle
            }
            Feature::Corner { point, tangents: [before, after], turn } => {
                let is_beyond = |tangent: Option<Vector>, sign: f64| {
                    tangent.is_none_or(|tangent| sign * tangent.dot(&(p - point)) >= -tolerance)
                };
                // A smooth joint owns no points.
                is_beyond(before, 1.0) && is_beyond(after, -1.0) && turn.abs() > 1e-9
            }
        }
    }

    /// Returns the tangent of a segment at one of its points.
    fn tangent(&self, point: Vector) -> Option<Vector> {
        match *self {
            Feature::Line { direction, .. } => Some(direction),
            Feature::Arc { centre, sense, .. } => {
                let arm = unit(point - centre);
                Some(sense * Vector::new(-arm.y, arm.x))
            }
            Feature::Corner { .. } => None,
        }
    }
}

fn features(tool: &Restated) -> Vec<Feature> {
    let double = |p: &restated::Point| Vector::new(p[0].to_f64(), p[1].to_f64());
    let mut corners = vec![double(&tool.start)];
    corners.extend(tool.segments.iter().map(|segment| double(&segment.to)));
    let segments = tool.segments.iter().zip(corners.windows(2)).map(|(segment, ends)| {
        let [from, to] = [ends[0], ends[1]];
        match segment.centre.as_ref().map(double) {
            None => Feature::Line { from, direction: unit(to - from), length: norm(to - from) },
            Some(centre) => {
                let (a, b) = (from - centre, to - centre);
                let sense = a.perp(&b).signum();
                Feature::Arc { centre, radius: norm(a), ends: [from, to], sense }
            }
        }
    });
    let mut features: Vec<Feature> = segments.collect();
    for (k, point) in corners.into_iter().enumerate() {
        let tangent =
            |segment: Option<usize>| features[..tool.segments.len()].get(segment?)?.tangent(point);
        let [before, after] = [tangent(k.checked_sub(1)), tangent(Some(k))];
        let turn = before.zip(after).map_or(1.0, |(before, after)| before.perp(&after));
        features.push(Feature::Corner { point, tangents: [before, after], turn });
    }
    features
}

fn borders(features: &[Feature]) -> Vec<Border> {
    let mut borders = Vec::new();
    for (k, feature) in features.iter().enumerate() {
        borders.extend(features[..k].iter().map(|other| Border::Pair(*other, *feature)));
        if let Feature::Corner { point, tangents, .. } = *feature {
            let fan = |tangent| Border::Fan { point, tangent };
            borders.extend(tangents.into_iter().flatten().map(fan));
        }
    }
    borders
}

impl Border {
    /// Returns the function that is zero on the border, and its gradient.
    fn residual(&self, p: Vector) -> (f64, Vector) {
        match self {
            Border::Pair(a, b) => {
                let ((a, to_a), (b, to_b)) = (a.distance(p), b.distance(p));
                (a - b, to_a - to_b)
            }
            Border::Fan { point, tangent } => (tangent.dot(&(p - point)), *tangent),
        }
    }
}

/// Intersects two borders by Newton's method. Returns `None` if it does not converge.
fn intersect(borders: [&Border; 2], mut p: Vector, size: f64) -> Option<Vector> {
    for _ in 0..30 {
        let [(f, u), (g, v)] = borders.map(|border| border.residual(p));
        let determinant = u.perp(&v);
        if determinant.abs() < 1e-9 {
            return None;
        }
        let step = Vector::new(f * v.y - g * u.y, u.x * g - v.x * f) / determinant;
        p -= step;
        let reach = p.x.abs() + p.y.abs();
        if reach.is_nan() || reach >= 4.0 * size {
            return None;
        }
        if step.amax() < 1e-15 * size {
            return Some(p);
        }
    }
    None
}

/// Returns points off the surface with three or more nearest features, inside and outside. Newton's method begins up
/// to twice the tool's radius from the axis, and up to half its radius beyond its ends.
pub(crate) fn find_voronoi_vertices(
    tool: &Restated,
    size: f64,
    search: Search,
    rng: &mut Rng,
) -> Vec<VoronoiVertex> {
    let features = features(tool);
    let borders = borders(&features);
    let largest = |axis: usize| {
        let coordinates = tool.segments.iter().map(|segment| segment.to[axis].to_f64());
        coordinates.fold(0.0, f64::max)
    };
    let [radius, height] = [largest(0), largest(1)];
    let mut vertices: Vec<VoronoiVertex> = Vec::new();
    let pairs = (0..borders.len()).flat_map(|k| (0..k).map(move |other| [k, other]));
    for pair in pairs.skip(rng.bits() as usize % search.stride).step_by(search.stride) {
        for _ in 0..search.starts {
            let d = rng.between(0.0, 2.0 * radius);
            let start = Vector::new(d, rng.between(-0.5 * radius, height + 0.5 * radius));
            let Some(point) = intersect(pair.map(|k| &borders[k]), start, size) else { continue };
            let Some(features) = nearest_count(&features, point, size) else { continue };
            let is_known = vertices.iter().any(|known| (known.point - point).amax() < 1e-9 * size);
            if !is_known {
                vertices.push(VoronoiVertex { point, features });
            }
        }
    }
    vertices
}

/// Returns the number of nearest features. Returns `None` if there are fewer than three, or if the point is on the
/// surface or far away.
fn nearest_count(features: &[Feature], p: Vector, size: f64) -> Option<usize> {
    let tolerance = 1e-12 * size;
    if p.x < 0.0 || p.x > 2.0 * size || p.y.abs() > 2.0 * size {
        return None;
    }
    let facing = features.iter().filter(|feature| feature.faces(p, tolerance));
    let distances: Vec<f64> = facing.map(|feature| feature.distance(p).0).collect();
    let nearest = distances.iter().copied().fold(f64::INFINITY, f64::min);
    let count = distances.iter().filter(|distance| **distance <= nearest + tolerance).count();
    (count >= 3 && nearest > 1e-6 * size).then_some(count)
}

/// In the thesis's frame, the points (5, 13) and (11, 19) outside fig. 7.3 are equally near to four features.
#[test]
fn finds_the_known_points_near_four_features() {
    let tool = restated::of("Fig73Exact").expect("it is restated");
    let search = Search { starts: 2, stride: 1 };
    let found = find_voronoi_vertices(&tool, 32.0, search, &mut Rng::new(1));
    for known in [Vector::new(5.0, 7.0), Vector::new(11.0, 1.0)] {
        let vertex = found.iter().find(|vertex| (vertex.point - known).amax() < 1e-12);
        assert_eq!(vertex.map(|vertex| vertex.features), Some(4), "{known:?} in {found:?}");
    }
}
