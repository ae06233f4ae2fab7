//! Item 3: points that are equally near to three or more features of a profile, inside and as far as half the tool's
//! radius outside, and an ulp beside them. The contract; and all regions that such a point belongs to agree. Inside
//! `Fig73` these are the points where its own regions meet, in the two solids those where four faces do.
//!
//! The points are the Voronoi vertices of a profile's features: the segments, each for the points whose foot lies on it, and
//! the corners, each for its fan. Borders are the points equally far from two features, the edges of fans, where a segment
//! and its end are equally far, and the axis, where each feature is as far as its mirror image. Every two borders are
//! intersected by Newton's method. An intersection is kept if no other feature is nearer. All computations are in doubles:
//! the points found are validated in 256 bits wherever they are.

use crate::border_points::{compare_neighbours, owners_at};
use crate::prelude::*;
use crate::run;
use touchoff_tests::oracle::profile::{Feature, Profile};
use touchoff_tests::oracle::vector::{Point, add, cross, dot, opposite, sub, unit};
use touchoff_tests::points::{add_turned, neighbourhood};

#[test]
fn points_near_several_features_keep_the_contract() {
    let tools = run(3, |subject, rng, checks| {
        let validator = Validator::new(subject.tool, &*subject.truth);
        for p in equidistant_points(subject, rng) {
            let mut points = Vec::new();
            for p in neighbourhood(&*subject.oracle, p) {
                add_turned(&*subject.oracle, p, &[[1.0, 0.0], rng.azimuth()], &mut points);
            }
            let evaluations = validator.validate(&points, checks);
            let (p, evaluation) = (points[0], evaluations[0].as_ref());
            compare_neighbours(subject, p, evaluation, &owners_at(subject, p), checks);
        }
    });
    print_worst("item 3", &tools);
    assert_no_misses(&tools);
    // A sample does not find a point of every tool.
    assert!(tools.iter().any(|checks| checks.cases() > 0));
}

fn equidistant_points(subject: &Subject, rng: &mut Rng) -> Vec<[f64; 3]> {
    let starts = extent(1, 3);
    let search = Search { starts, stride: 3_usize.div_ceil(starts) };
    let of_profile = |name: &str, rng: &mut Rng| {
        let tool = Nearest::of(name);
        let vertices = find_voronoi_vertices(tool.profile(), subject.scale(), search, rng);
        vertices.into_iter().map(|vertex| [vertex.point[0], 0.0, vertex.point[1]]).collect()
    };
    match subject.name() {
        "Block" => {
            // The ends of the ridge.
            vec![[-10.0, -5.0, 10.0], [-10.0, 5.0, 10.0], [10.0, -5.0, 10.0], [10.0, 5.0, 10.0]]
        }
        "LBracket" => bracket_points(),
        "Fig73" => {
            // Inside: the corners of its own regions. Outside: the points for the exact solid.
            let mut points: Vec<[f64; 3]> = of_profile("Fig73Exact", rng);
            points.retain(|p| subject.oracle.evaluate(*p).is_none());
            points.splice(0..0, subject.oracle.corner_points());
            points
        }
        name => of_profile(name, rng),
    }
}

/// Returns the points of the bracket where four of its faces and its edge are equally near, from its drawing.
fn bracket_points() -> Vec<[f64; 3]> {
    // Bottom, back and edge: the distance a from both faces equals that from the edge, a = √2 (6 - a).
    let a = 6.0 * 2f64.sqrt() / (1.0 + 2f64.sqrt());
    let mut points = Vec::new();
    for side in [-1.0, 1.0] {
        points.push([17.0, 7.0 * side, 3.0]); // bottom, ledge, end, side
        points.push([-4.0, 7.0 * side, 3.0]); // bottom, ledge, edge, side
        points.push([-7.0, 7.0 * side, 6.0]); // back, wall, edge, side
        points.push([-7.0, 7.0 * side, 21.0]); // back, wall, top, side
        points.push([a - 10.0, (10.0 - a) * side, a]); // bottom, back, edge, side
    }
    points
}

type Vector = Point<f64>;

#[derive(Clone, Copy, Debug)]
struct VoronoiVertex {
    point: Vector,
    features: usize,
}

#[derive(Clone, Copy)]
struct Search {
    /// Number of random points per pair of borders at which Newton's method starts.
    starts: usize,
    /// Every `stride`-th pair is taken.
    stride: usize,
}

/// A border, as the zero set of a function.
#[derive(Clone, Copy)]
enum Border {
    Pair(Feature, Feature),
    /// The line through a point across a tangent.
    Line(Vector, Vector),
}

/// The features of a profile; a smooth joint is none.
fn features(profile: &Profile<f64>) -> Vec<Feature> {
    let segments = (0..profile.segments().len()).map(Feature::Segment);
    let corners = (0..=profile.segments().len()).filter(|k| profile.turn(*k).abs() > 1e-9);
    segments.chain(corners.map(Feature::Corner)).collect()
}

fn distance(profile: &Profile<f64>, feature: Feature, p: &Vector) -> (f64, Vector) {
    match feature {
        Feature::Segment(k) => {
            let segment = &profile.segments()[k];
            let (inward, outward) = (segment.inward(p), segment.outward(p));
            (inward.abs(), if inward > 0.0 { opposite(&outward) } else { outward })
        }
        Feature::Corner(k) => (profile.distance(feature, p), unit(&sub(p, profile.vertex(k)))),
    }
}

/// Returns whether a feature may own a point, on this side of the profile, to a tolerance.
fn faces(profile: &Profile<f64>, feature: Feature, p: &Vector, tolerance: f64) -> bool {
    // Beyond the first tangent, and before the second.
    let [(from, first), (to, second)] = match feature {
        Feature::Segment(k) => {
            let segment = &profile.segments()[k];
            [segment.from, segment.to].map(|end| (end, segment.tangent(&end)))
        }
        Feature::Corner(k) => profile.tangents(k).map(|tangent| (*profile.vertex(k), tangent)),
    };
    dot(&first, &sub(p, &from)) >= -tolerance && dot(&second, &sub(p, &to)) <= tolerance
}

fn borders(profile: &Profile<f64>, features: &[Feature]) -> Vec<Border> {
    let mut borders = vec![Border::Line([0.0, 0.0], [1.0, 0.0])];
    for (k, feature) in features.iter().enumerate() {
        borders.extend(features[..k].iter().map(|other| Border::Pair(*other, *feature)));
        if let Feature::Corner(k) = *feature {
            borders.extend(
                profile.tangents(k).map(|tangent| Border::Line(*profile.vertex(k), tangent)),
            );
        }
    }
    borders
}

impl Border {
    /// Returns the function that is zero on the border, and its gradient.
    fn residual(&self, profile: &Profile<f64>, p: &Vector) -> (f64, Vector) {
        match self {
            Border::Pair(a, b) => {
                let [(a, to_a), (b, to_b)] = [a, b].map(|side| distance(profile, *side, p));
                (a - b, sub(&to_a, &to_b))
            }
            Border::Line(point, tangent) => (dot(tangent, &sub(p, point)), *tangent),
        }
    }
}

/// Intersects two borders by Newton's method. Returns `None` if it does not converge.
fn intersect(
    profile: &Profile<f64>,
    borders: [&Border; 2],
    mut p: Vector,
    size: f64,
) -> Option<Vector> {
    for _ in 0..30 {
        let [(f, u), (g, v)] = borders.map(|border| border.residual(profile, &p));
        let determinant = cross(&u, &v);
        if determinant.abs() < 1e-9 {
            return None;
        }
        let step = [(f * v[1] - g * u[1]) / determinant, (u[0] * g - v[0] * f) / determinant];
        p = add(&p, &step, &-1.0);
        let reach = p[0].abs() + p[1].abs();
        if reach.is_nan() || reach >= 4.0 * size {
            return None;
        }
        if step[0].abs().max(step[1].abs()) < 1e-15 * size {
            return Some(p);
        }
    }
    None
}

/// Returns points off the surface with three or more nearest features, inside and outside. Newton's method begins up
/// to twice the tool's radius from the axis, and up to half its radius beyond its ends.
fn find_voronoi_vertices(
    profile: &Profile<f64>,
    size: f64,
    search: Search,
    rng: &mut Rng,
) -> Vec<VoronoiVertex> {
    let features = features(profile);
    let borders = borders(profile, &features);
    let [_, [radius, height]] = profile.extent();
    let mut vertices: Vec<VoronoiVertex> = Vec::new();
    let pairs = (0..borders.len()).flat_map(|k| (0..k).map(move |other| [k, other]));
    for pair in pairs.skip(rng.index(search.stride)).step_by(search.stride) {
        for _ in 0..search.starts {
            let d = rng.between(0.0, 2.0 * radius);
            let start = [d, rng.between(-0.5 * radius, height + 0.5 * radius)];
            let pair = pair.map(|k| &borders[k]);
            let Some(point) = intersect(profile, pair, start, size) else { continue };
            let Some(features) = nearest_count(profile, &features, &point, size) else { continue };
            if !vertices.iter().any(|known| is_same(known.point, point, 1e-9 * size)) {
                vertices.push(VoronoiVertex { point, features });
            }
        }
    }
    vertices
}

fn is_same(a: Vector, b: Vector, tolerance: f64) -> bool {
    (0..2).all(|k| (a[k] - b[k]).abs() < tolerance)
}

/// Returns the number of nearest features, on the axis with their mirror images. Returns `None` if there are fewer than
/// three, or if the point is on the surface or far away.
fn nearest_count(
    profile: &Profile<f64>,
    features: &[Feature],
    p: &Vector,
    size: f64,
) -> Option<usize> {
    let tolerance = 1e-12 * size;
    if p[0] < 0.0 || p[0] > 2.0 * size || p[1].abs() > 2.0 * size {
        return None;
    }
    let facing = features.iter().filter(|feature| faces(profile, **feature, p, tolerance));
    let distances: Vec<f64> = facing.map(|feature| distance(profile, *feature, p).0).collect();
    let nearest = distances.iter().copied().fold(f64::INFINITY, f64::min);
    let count = distances.iter().filter(|distance| **distance <= nearest + tolerance).count();
    let count = if p[0] < tolerance { 2 * count } else { count };
    (count >= 3 && nearest > 1e-6 * size).then_some(count)
}

/// In the thesis's frame, the points (5, 13) and (11, 19) outside fig. 7.3 are equally near to four features.
#[test]
fn finds_the_known_points_near_four_features() {
    let tool = Nearest::of("Fig73Exact");
    let search = Search { starts: 2, stride: 1 };
    let found = find_voronoi_vertices(tool.profile(), 32.0, search, &mut Rng::new(1));
    for known in [[5.0, 7.0], [11.0, 1.0]] {
        let vertex = found.iter().find(|vertex| is_same(vertex.point, known, 1e-12));
        assert_eq!(vertex.map(|vertex| vertex.features), Some(4), "{known:?} in {found:?}");
    }
}
