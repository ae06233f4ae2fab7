//! Item 9: profiles that hardly are any. Each is refused by the compiler, or keeps the contract.

use crate::prelude::*;
use crate::text::profile_text;
use crate::truth::Profiled;
use std::f64::consts::TAU;
use touchoff::tool::Interpreted;
use touchoff_dsl::source::Source;
use touchoff_tests::oracle::profile::Profile;
use touchoff_tests::oracle::restated::Restated;

/// Profiles that may be refused. An arc has its centre after `about`.
const DEGENERATE: [(&str, &str); 23] = [
    ("half circle", "0 0, 0 4 about 0 2"),
    ("half circle off the axis", "0 0, 2 0, 2 4 about 2 2, 2 9, 0 9"),
    ("almost a half circle", "0 0, 1e-9 4 about 0 2, 1e-9 9, 0 9"),
    ("needle of 1e-12", "0 0, 1e-12 0, 1e-12 9, 0 9"),
    ("round needle of 1e-12", "0 0, 1e-12 1e-12 about 0 1e-12, 1e-12 9, 0 9"),
    ("cone of 1e-12", "0 0, 1e-12 9, 0 9"),
    ("collinear edges", "0 0, 1 0, 2 0, 2 5, 2 9, 0 9"),
    ("tangent line and arc", "0 0, 2 0, 4 2 about 2 2, 4 9, 0 9"),
    ("tangent arcs", "0 0, 2 2 about 0 2, 3 3 about 3 2, 3 9, 0 9"),
    ("two arcs of one circle", "0 0, 1.5 0.5 about 0 2.5, 2.5 2.5 about 0 2.5, 2.5 9, 0 9"),
    ("torus", "0 0, 5 0, 6 1 about 5 1, 5 2 about 5 1, 0 2"),
    ("torus about the axis", "0 0, 0.5 0, 2.5 2 about 0.5 2, 0.5 4 about 0.5 2, 0 4"),
    ("arc centred beyond the axis", "0 0, 1 0, 1 8 about -2 4, 0 9"),
    ("concave arc", "0 0, 2 0, 2 2, 4 4 about 4 2, 4 9, 0 9"),
    ("concave arc into the tip", "0 0, 3 3 about 3 0, 3 9, 0 9"),
    ("step of 1e-12", "0 0, 2 0, 2 4, 2.000000000001 4, 2.000000000001 9, 0 9"),
    ("chamfer of 1e-12", "0 0, 2 0, 2.000000000001 1e-12, 2.000000000001 9, 0 9"),
    ("groove of 1e-12", "0 0, 2 0, 2 4, 1 4, 1 4.000000000001, 2 4.000000000001, 2 9, 0 9"),
    ("arc as good as straight", "0 0, 2 0, 2 8 about -1e9 4, 2 9, 0 9"),
    ("turn of 1e-8", "0 0, 2 0, 2 4, 2.00000005 9, 0 9"),
    ("arc that misses its tangent by 1e-10", "0 0, 2 0, 4 2 about 2 2, 4.000000000699 9, 0 9"),
    ("disc of 1e-12", "0 0, 9 0, 9 1e-12, 0 1e-12"),
    ("hollow below", "0 1, 1 1, 3 0, 3 9, 0 9"),
];

#[test]
fn degenerate_profiles_are_refused_or_exact() {
    let mut rng = Rng::new(crate::SEED);
    let mut results = Vec::new();
    for (name, profile) in DEGENERATE {
        let mut checks = Checks::new(name);
        let restated = restated(profile);
        if let Some(tool) = compile(&restated) {
            let truth = Profiled::new(&tool, &restated);
            let points = points(&Nearest::new(&restated), &mut rng);
            Validator::new(&tool, &truth).validate(&points, &mut checks);
        }
        results.push(checks);
    }
    print_worst("item 9", &results);
    assert_no_misses(&results);
    assert!(results.iter().any(|checks| checks.cases() > 0));
}

fn restated(profile: &str) -> Restated {
    Restated::of_profile("Case", Profile::parse(profile))
}

/// Compiles a profile; `None` if it is refused.
fn compile(profile: &Restated) -> Option<Interpreted> {
    Interpreted::parse(&Source::new("case", profile_text(profile, "1"))).ok()
}

/// Returns points on the surface, at 1e-16 to 1 of the tool's size from it, on the axis and anywhere.
fn points(oracle: &Nearest, rng: &mut Rng) -> Vec<[f64; 3]> {
    let surface: Vec<[f64; 2]> = oracle.profile().surface().into_iter().flatten().collect();
    let [radius, height] = oracle.extent();
    let mut points = Vec::new();
    for [d, _, z] in oracle.corner_points() {
        for z in [z, z.next_up(), z.next_down()] {
            points.extend([[d, 0.0, z], [0.0, -d.next_up(), z], [d.next_down().max(0.0), 0.0, z]]);
        }
    }
    while points.len() < extent(200, 4_000) {
        let [d, z] = surface[rng.index(surface.len())];
        let distance = rng.power(-16.0, 0.0);
        let beside_d = d + distance * radius * rng.between(-1.0, 1.0);
        let beside_z = z + distance * height * rng.between(-1.0, 1.0);
        let (sin, cos) = rng.between(0.0, TAU).sin_cos();
        points.push([d, 0.0, z]);
        points.push([beside_d * cos, beside_d * sin, beside_z]);
        points.push([0.0, 0.0, rng.between(0.0, height)]);
        let [x, y] = [0; 2].map(|_| rng.between(-1.1, 1.1) * radius);
        points.push([x, y, rng.between(-0.1, 1.1) * height]);
    }
    points
}
