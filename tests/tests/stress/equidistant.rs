//! Item 3: points that are equally near to three or more features of a profile, inside and as far as half the tool's
//! radius outside, and an ulp beside them. The contract; and all regions that such a point belongs to agree. Inside
//! `Fig73` these are the points where its own regions meet, in the two solids those where four faces do.

use crate::border_points::{compare_neighbours, owners_at};
use crate::truth::Subject;
use crate::validator::Validator;
use crate::voronoi::{Search, find_voronoi_vertices};
use crate::{extent, run};
use touchoff_tests::checks::{assert_no_misses, print_worst};
use touchoff_tests::oracle::Nearest;
use touchoff_tests::oracle::rng::Rng;
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
