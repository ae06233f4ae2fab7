//! Item 3: points that are equally near to three, four or more features.

use super::ledger::{Kind, Ledger};
use super::section::find_equidistant_points;
use super::truth::{Subject, to_exact};
use super::validator::Validator;
use touchoff_tests::oracle::big::Big;
use touchoff_tests::oracle::restated;
use touchoff_tests::oracle::rng::Rng;

/// Difference between the evaluated depth and the depth of each region that owns the point.
const OWNER_DEPTH: Kind = Kind::with_limit("all owners", "ulp(S)", 1.0);
const THREE_FEATURES: Kind = Kind::informational("as near to three", "features");
const FOUR_FEATURES: Kind = Kind::informational("as near to four or more", "features");

/// Validates these points and their neighbours at one ulp.
pub(super) fn equidistant_points(
    subject: &Subject,
    starts: (usize, usize),
    rng: &mut Rng,
    ledger: &mut Ledger,
) {
    let validator = Validator::new(subject.tool, &*subject.truth);
    let neighbours = |v: f64| [v, v.next_up(), v.next_down()];
    for ([x, y, z], count) in candidate_points(subject, starts, rng) {
        let kind = if count > 3 { FOUR_FEATURES } else { THREE_FEATURES };
        ledger.record_info(kind, 1, count as f64, &format!("{:?}", [x, y, z]));
        let mut points = Vec::new();
        for x in neighbours(x) {
            for z in neighbours(z) {
                if subject.oracle.is_revolved() {
                    let (sin, cos) = rng.between(0.0, std::f64::consts::TAU).sin_cos();
                    points.extend([[x.abs(), 0.0, z], [x * cos, x * sin, z]]);
                } else {
                    points.extend(neighbours(y).map(|y| [x, y, z]));
                }
            }
        }
        let answers = validator.validate(&points, ledger);
        if let Some(answer) = &answers[0] {
            let exact_point = to_exact(points[0]);
            for region in 0..subject.tool.info().regions.len() {
                let Some(claim) = subject.truth.region_values(&exact_point, region) else {
                    continue;
                };
                if claim.excess_distance > subject.ulp() / 2.0 {
                    continue;
                }
                let error = (&Big::exactly(answer.depth()) - &claim.depth).abs().to_f64();
                ledger.record(OWNER_DEPTH, error / subject.ulp(), || format!("{:?}", points[0]));
            }
        }
    }
}

/// Returns the points, each with the number of its nearest features.
fn candidate_points(
    subject: &Subject,
    starts: (usize, usize),
    rng: &mut Rng,
) -> Vec<([f64; 3], usize)> {
    let profile_points = |name: &str, rng: &mut Rng| {
        let tool = restated::of(name).expect("every profile is restated");
        let points = find_equidistant_points(&tool, subject.scale(), starts, rng);
        points.into_iter().map(|m| ([m.point[0], 0.0, m.point[1]], m.features)).collect::<Vec<_>>()
    };
    match subject.name() {
        "Block" => {
            // The ends of the ridge.
            let ends = [-10.0, 10.0].into_iter().flat_map(|x| [-5.0, 5.0].map(|y| [x, y, 10.0]));
            ends.map(|p| (p, 4)).collect()
        }
        "LBracket" => bracket_points(),
        "Fig73" => {
            // Inside: the corners of its own regions. Outside: the points for the exact solid.
            let own_corners = subject.oracle.corner_points().into_iter().map(|p| (p, 3));
            let outside = profile_points("Fig73Exact", rng).into_iter();
            own_corners
                .chain(outside.filter(|(p, _)| subject.oracle.evaluate(*p).is_none()))
                .collect()
        }
        name => profile_points(name, rng),
    }
}

/// Returns the points of the bracket where four of its faces and its edge are equally near, from its drawing.
fn bracket_points() -> Vec<([f64; 3], usize)> {
    // Bottom, back and edge: the distance a from both faces equals that from the edge, a = √2 (6 - a).
    let a = 6.0 * 2f64.sqrt() / (1.0 + 2f64.sqrt());
    let mut points = Vec::new();
    for side in [-1.0, 1.0] {
        points.push(([17.0, 7.0 * side, 3.0], 4)); // bottom, ledge, end, side
        points.push(([-4.0, 7.0 * side, 3.0], 4)); // bottom, ledge, edge, side
        points.push(([-7.0, 7.0 * side, 6.0], 4)); // back, wall, edge, side
        points.push(([-7.0, 7.0 * side, 21.0], 4)); // back, wall, top, side
        points.push(([a - 10.0, (10.0 - a) * side, a], 4)); // bottom, back, edge, side
    }
    points
}
