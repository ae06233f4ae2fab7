//! Item 9: degenerate profiles. Each must give a compile error or exact values.

use super::ledger::{Item, Kind, Ledger, Row};
use super::text::profile_text;
use super::truth::Profiled;
use super::validator::Validator;
use tool_dsl::source::Source;
use touchoff::tool::Interpreted;
use touchoff_tests::oracle::big::Big;
use touchoff_tests::oracle::restated::{Restated, Segment};
use touchoff_tests::oracle::rng::Rng;
use touchoff_tests::oracle::{Nearest, Oracle};

/// Rejected by the compiler; the location is the message.
const REJECTED: Kind = Kind::informational("refused", "");
/// A profile that must be rejected, but was accepted.
const ACCEPTED: Kind = Kind::forbidden_event("taken");

/// A step of a profile: the end point, and the centre if it is an arc.
type Step = ([f64; 2], Option<[f64; 2]>);

/// A profile, and whether it is invalid and must be rejected.
struct Case {
    name: &'static str,
    start: [f64; 2],
    steps: Vec<Step>,
    is_invalid: bool,
}

fn line(d: f64, z: f64) -> Step {
    ([d, z], None)
}

fn arc(d: f64, z: f64, centre: [f64; 2]) -> Step {
    ([d, z], Some(centre))
}

fn case(name: &'static str, steps: Vec<Step>) -> Case {
    Case { name, start: [0.0, 0.0], steps, is_invalid: false }
}

fn invalid(name: &'static str, steps: Vec<Step>) -> Case {
    Case { is_invalid: true, ..case(name, steps) }
}

fn cases() -> Vec<Case> {
    let end = || line(0.0, 9.0);
    let mut cases = vec![
        invalid("edge of no length", vec![line(2.0, 0.0), line(2.0, 0.0), line(2.0, 9.0), end()]),
        invalid(
            "arc of 0°",
            vec![line(2.0, 0.0), arc(2.0, 0.0, [1.0, 0.0]), line(2.0, 9.0), end()],
        ),
        invalid(
            "vertex repeated later",
            vec![
                line(2.0, 0.0),
                line(2.0, 4.0),
                line(1.0, 2.0),
                line(2.0, 4.0),
                line(2.0, 9.0),
                end(),
            ],
        ),
        invalid("edge on the axis", vec![line(0.0, 3.0), line(2.0, 4.0), line(2.0, 9.0), end()]),
        invalid(
            "edge through itself",
            vec![
                line(4.0, 0.0),
                line(1.0, 6.0),
                line(4.0, 6.0),
                line(1.0, 0.5),
                line(1.0, 9.0),
                end(),
            ],
        ),
        invalid(
            "touching itself",
            vec![line(4.0, 0.0), line(4.0, 6.0), line(2.0, 0.0), line(2.0, 9.0), end()],
        ),
        invalid("no inside", vec![line(2.0, 0.0), line(0.0, 0.0)]),
        case("half circle", vec![arc(0.0, 4.0, [0.0, 2.0])]),
        case(
            "half circle off the axis",
            vec![line(2.0, 0.0), arc(2.0, 4.0, [2.0, 2.0]), line(2.0, 9.0), end()],
        ),
        case("almost a half circle", vec![arc(1e-9, 4.0, [0.0, 2.0]), line(1e-9, 9.0), end()]),
        case("needle of 1e-12", vec![line(1e-12, 0.0), line(1e-12, 9.0), end()]),
        case(
            "round needle of 1e-12",
            vec![arc(1e-12, 1e-12, [0.0, 1e-12]), line(1e-12, 9.0), end()],
        ),
        case("cone of 1e-12", vec![line(1e-12, 9.0), end()]),
        case(
            "collinear edges",
            vec![line(1.0, 0.0), line(2.0, 0.0), line(2.0, 5.0), line(2.0, 9.0), end()],
        ),
        case(
            "tangent line and arc",
            vec![line(2.0, 0.0), arc(4.0, 2.0, [2.0, 2.0]), line(4.0, 9.0), end()],
        ),
        case(
            "tangent arcs",
            vec![arc(2.0, 2.0, [0.0, 2.0]), arc(3.0, 3.0, [3.0, 2.0]), line(3.0, 9.0), end()],
        ),
        case(
            "two arcs of one circle",
            vec![arc(1.5, 0.5, [0.0, 2.5]), arc(2.5, 2.5, [0.0, 2.5]), line(2.5, 9.0), end()],
        ),
        case(
            "torus",
            vec![
                line(5.0, 0.0),
                arc(6.0, 1.0, [5.0, 1.0]),
                arc(5.0, 2.0, [5.0, 1.0]),
                line(0.0, 2.0),
            ],
        ),
        case(
            "torus about the axis",
            vec![
                line(0.5, 0.0),
                arc(2.5, 2.0, [0.5, 2.0]),
                arc(0.5, 4.0, [0.5, 2.0]),
                line(0.0, 4.0),
            ],
        ),
        case(
            "arc centred beyond the axis",
            vec![line(1.0, 0.0), arc(1.0, 8.0, [-2.0, 4.0]), end()],
        ),
        case(
            "concave arc",
            vec![line(2.0, 0.0), line(2.0, 2.0), arc(4.0, 4.0, [4.0, 2.0]), line(4.0, 9.0), end()],
        ),
        case("concave arc into the tip", vec![arc(3.0, 3.0, [3.0, 0.0]), line(3.0, 9.0), end()]),
        case(
            "step of 1e-12",
            vec![
                line(2.0, 0.0),
                line(2.0, 4.0),
                line(2.000000000001, 4.0),
                line(2.000000000001, 9.0),
                end(),
            ],
        ),
        case(
            "chamfer of 1e-12",
            vec![line(2.0, 0.0), line(2.000000000001, 1e-12), line(2.000000000001, 9.0), end()],
        ),
        case(
            "groove of 1e-12",
            vec![
                line(2.0, 0.0),
                line(2.0, 4.0),
                line(1.0, 4.0),
                line(1.0, 4.000000000001),
                line(2.0, 4.000000000001),
                line(2.0, 9.0),
                end(),
            ],
        ),
        case(
            "arc as good as straight",
            vec![line(2.0, 0.0), arc(2.0, 8.0, [-1e9, 4.0]), line(2.0, 9.0), end()],
        ),
        case("turn of 1e-8", vec![line(2.0, 0.0), line(2.0, 4.0), line(2.00000005, 9.0), end()]),
        invalid(
            "turn of 1e-10",
            vec![line(2.0, 0.0), line(2.0, 4.0), line(2.0000000005, 9.0), end()],
        ),
        invalid(
            "turn of 1e-12",
            vec![line(2.0, 0.0), line(2.0, 4.0), line(2.000000000005, 9.0), end()],
        ),
        case(
            "arc that misses its tangent by 1e-10",
            vec![line(2.0, 0.0), arc(4.0, 2.0, [2.0, 2.0]), line(4.000000000699, 9.0), end()],
        ),
        case("disc of 1e-12", vec![line(9.0, 0.0), line(9.0, 1e-12), line(0.0, 1e-12)]),
    ];
    cases.push(Case {
        start: [0.0, 1.0],
        ..case("hollow below", vec![line(1.0, 1.0), line(3.0, 0.0), line(3.0, 9.0), end()])
    });
    cases.push(Case {
        start: [0.5, 0.0],
        ..invalid("beginning off the axis", vec![line(2.0, 0.0), line(2.0, 9.0), end()])
    });
    cases
}

fn restated(case: &Case) -> Restated {
    let point = |p: [f64; 2]| p.map(Big::decimal);
    let segment = |(to, centre): &Step| Segment {
        to: point(*to),
        centre: centre.map(point),
        surface: "side",
    };
    Restated {
        name: "Case",
        start: point(case.start),
        segments: case.steps.iter().map(segment).collect(),
        cutting: Vec::new(),
        niceness: |_, _, _| 1.0,
    }
}

/// Returns points on the surface, at 1e-16 to 1 of the tool's size from it, on the axis and anywhere.
fn points(oracle: &Nearest, count: usize, rng: &mut Rng) -> Vec<[f64; 3]> {
    let surface: Vec<[f64; 2]> = oracle.profile().surface().into_iter().flatten().collect();
    let [radius, height] = oracle.extent();
    let mut points = Vec::new();
    for [d, z] in oracle.corners() {
        for z in [z, z.next_up(), z.next_down()] {
            points.extend([[d, 0.0, z], [0.0, -d.next_up(), z], [d.next_down().max(0.0), 0.0, z]]);
        }
    }
    while points.len() < count {
        let [d, z] = surface[rng.bits() as usize % surface.len()];
        let distance = 10f64.powf(rng.between(-16.0, 0.0));
        let point_d = d + distance * radius * rng.between(-1.0, 1.0);
        let point_z = z + distance * height * rng.between(-1.0, 1.0);
        let (sin, cos) = rng.between(0.0, std::f64::consts::TAU).sin_cos();
        points.push([d, 0.0, z]);
        points.push([point_d * cos, point_d * sin, point_z]);
        points.push([0.0, 0.0, rng.between(0.0, height)]);
        let [x, y] = [0; 2].map(|_| rng.between(-1.1, 1.1) * radius);
        points.push([x, y, rng.between(-0.1, 1.1) * height]);
    }
    points
}

/// Validates every case.
pub(super) fn degenerate_profiles(item: Item, count: usize, rng: &mut Rng) -> Vec<Row> {
    let mut rows = Vec::new();
    for case in cases() {
        let mut ledger = Ledger::new(item, case.name);
        let restated = restated(&case);
        match Interpreted::parse(&Source::new("case", profile_text(&restated, "1"))) {
            Err(error) => {
                let message = error.to_string();
                let first = message.lines().next().unwrap_or_default().to_owned();
                ledger.record_info(REJECTED, 1, 0.0, &first);
            }
            Ok(tool) => {
                ledger.count(ACCEPTED, case.is_invalid, || case.name.to_owned());
                let truth = Profiled::new(&tool, &restated);
                let points = points(&Nearest::new(&restated), count, rng);
                Validator::new(&tool, &truth).validate(&points, &mut ledger);
            }
        }
        rows.extend(ledger.rows());
    }
    rows
}
