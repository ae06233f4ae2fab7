//! Item 3: points that are equally near to three, four or more features.

use super::judge::Judge;
use super::ledger::{Kind, Ledger};
use super::section::meetings;
use super::truth::{Subject, place};
use touchoff_tests::oracle::big::Big;
use touchoff_tests::oracle::draw::Rng;
use touchoff_tests::oracle::restated;

/// Difference between the evaluated depth and the depth of each region that owns the point.
const AGREE: Kind = Kind::of("all owners", "ulp(S)", 1.0);
const THREE: Kind = Kind::told("as near to three", "features");
const FOUR: Kind = Kind::told("as near to four or more", "features");

/// Validates these points and their neighbours at one ulp.
pub(super) fn meeting(
    subject: &Subject,
    starts: (usize, usize),
    draw: &mut Rng,
    ledger: &mut Ledger,
) {
    let judge = Judge::new(subject.tool, &*subject.truth);
    let around = |v: f64| [v, v.next_up(), v.next_down()];
    for ([x, y, z], count) in places(subject, starts, draw) {
        let kind = if count > 3 { FOUR } else { THREE };
        ledger.tell(kind, 1, count as f64, &format!("{:?}", [x, y, z]));
        let mut points = Vec::new();
        for x in around(x) {
            for z in around(z) {
                if subject.oracle.revolved() {
                    let (sin, cos) = draw.between(0.0, std::f64::consts::TAU).sin_cos();
                    points.extend([[x.abs(), 0.0, z], [x * cos, x * sin, z]]);
                } else {
                    points.extend(around(y).map(|y| [x, y, z]));
                }
            }
        }
        let answers = judge.points(&points, ledger);
        if let Some(answer) = &answers[0] {
            let at = place(points[0]);
            for region in 0..subject.tool.info().regions.len() {
                let Some(claim) = subject.truth.claim(&at, region) else { continue };
                if claim.behind > subject.ulp() / 2.0 {
                    continue;
                }
                let off = (&Big::exactly(answer.depth()) - &claim.depth).abs().to_f64();
                ledger.see(AGREE, off / subject.ulp(), || format!("{:?}", points[0]));
            }
        }
    }
}

/// Returns the points, each with the number of its nearest features.
fn places(subject: &Subject, starts: (usize, usize), draw: &mut Rng) -> Vec<([f64; 3], usize)> {
    let of = |name: &str, draw: &mut Rng| {
        let tool = restated::of(name).expect("every profile is restated");
        let found = meetings(&tool, subject.scale(), starts, draw);
        found.into_iter().map(|m| ([m.at[0], 0.0, m.at[1]], m.features)).collect::<Vec<_>>()
    };
    match subject.name() {
        "Block" => {
            // The ends of the ridge.
            let ends = [-10.0, 10.0].into_iter().flat_map(|x| [-5.0, 5.0].map(|y| [x, y, 10.0]));
            ends.map(|p| (p, 4)).collect()
        }
        "LBracket" => bracket(),
        "Fig73" => {
            // Inside: the corners of its own regions. Outside: the points for the exact solid.
            let own = subject.oracle.corner_points().into_iter().map(|p| (p, 3));
            let outside = of("Fig73Exact", draw).into_iter();
            own.chain(outside.filter(|(p, _)| subject.oracle.sense(*p).is_none())).collect()
        }
        name => of(name, draw),
    }
}

/// Returns the points of the bracket where four of its faces and its edge are equally near, from its drawing.
fn bracket() -> Vec<([f64; 3], usize)> {
    // Bottom, back and edge: the distance a from both faces equals that from the edge, a = √2 (6 - a).
    let a = 6.0 * 2f64.sqrt() / (1.0 + 2f64.sqrt());
    let mut all = Vec::new();
    for side in [-1.0, 1.0] {
        all.push(([17.0, 7.0 * side, 3.0], 4)); // bottom, ledge, end, side
        all.push(([-4.0, 7.0 * side, 3.0], 4)); // bottom, ledge, edge, side
        all.push(([-7.0, 7.0 * side, 6.0], 4)); // back, wall, edge, side
        all.push(([-7.0, 7.0 * side, 21.0], 4)); // back, wall, top, side
        all.push(([a - 10.0, (10.0 - a) * side, a], 4)); // bottom, back, edge, side
    }
    all
}
