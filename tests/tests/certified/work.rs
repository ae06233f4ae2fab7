//! The work of queries: the least budget with which each gives the answer that it gives without a limit.
//!
//! A bound that is weaker than it was changes no answer, only the number of nodes, triangles and intervals of edges that are
//! examined before it is proved. The numbers are in a snapshot: a change of the certifier shows there what it costs.

use crate::pair::generated_parts;
use crate::prelude::*;
use std::fmt::{Debug, Write};

/// Tools with a profile, and at the end one without.
const TOOLS: [&str; 8] =
    ["Fig73Exact", "BullNose", "Lollipop", "TSlot", "Dovetail", "TaperedBall", "Bell", "Fig73"];

/// Number of poses of each tool at each part.
const POSES: usize = 4;

/// Least depths and distances that are told apart, mm.
const TOLERANCE: f64 = 1e-3;

type Answer = Box<dyn Debug>;
type Query = fn(&mut Certifier<'_>, &[Pose; 2]) -> Answer;

/// Queries by name, at the first of two poses or from one to the other.
const QUERIES: [(&str, Query); 9] = [
    ("check_pose", |certifier, [pose, _]| Box::new(certifier.check_pose(pose))),
    ("touches", |certifier, [pose, _]| Box::new(certifier.touches(pose))),
    ("deepest", |certifier, [pose, _]| Box::new(certifier.deepest(pose, TOLERANCE))),
    ("deepest_on", |certifier, [pose, _]| {
        Box::new(certifier.deepest_on(SurfaceId(0), pose, TOLERANCE))
    }),
    ("clearance", |certifier, [pose, _]| Box::new(certifier.clearance(pose, TOLERANCE))),
    ("clearance_of", |certifier, [pose, _]| {
        Box::new(certifier.clearance_of(&[SurfaceId(0)], pose, TOLERANCE))
    }),
    ("signed_distance", |certifier, [pose, _]| {
        Box::new(certifier.signed_distance(pose, TOLERANCE))
    }),
    ("check_motion", |certifier, [from, to]| {
        Box::new(certifier.check_motion(&motion(from, to), 10.0 * TOLERANCE))
    }),
    ("motion_depth", |certifier, [from, to]| {
        Box::new(certifier.motion_depth(SurfaceId(0), &motion(from, to), 0.05, 10.0 * TOLERANCE))
    }),
];

/// Returns the work of a query.
fn work(certifier: &Certifier<'_>, query: Query, poses: &[Pose; 2]) -> u32 {
    // A clone has the queries that the first one makes.
    let mut certifier = certifier.clone();
    let whole = format!("{:?}", query(&mut certifier, poses));
    certifier.clear_caches();
    let answer = |budget| format!("{:?}", query(&mut certifier.clone().with_budget(budget), poses));
    let [mut low, mut enough] = [0, 1];
    while answer(enough) != whole {
        low = enough + 1;
        enough *= 2;
    }
    while low < enough {
        let middle = low.midpoint(enough);
        if answer(middle) == whole { enough = middle } else { low = middle + 1 }
    }
    enough
}

/// Returns a certifier with an allowance, a margin and no limit, in turns, on the surfaces of a tool.
fn restricted<'a>(certifier: &Certifier<'a>, tool: &dyn Tool) -> Certifier<'a> {
    let is_profile = tool.info().is_exact();
    let allowed = [0.3, if is_profile { -0.2 } else { 0.1 }, f64::INFINITY];
    allowing(certifier.clone(), tool, allowed.into_iter().cycle())
}

/// Bounds of triangles exist in vectors only; without them their boxes are all that rules them out.
#[cfg(target_arch = "x86_64")]
#[test]
fn queries_examine_as_many_nodes_as_before() {
    insta::assert_snapshot!("boxes", works(Level::baseline()));
    if let Some(token) = Level::new().as_avx2() {
        insta::assert_snapshot!("triangles", works(Level::Avx2(token)));
    }
}

/// Returns the work of all queries of all tools at all parts, at a SIMD level.
fn works(level: Level) -> String {
    let mut text = String::new();
    for part in generated_parts() {
        let oracle = Nearest::of("BallEr16");
        let brute = BruteForce::new(&part.mesh, &oracle, 1.0);
        for name in TOOLS {
            let mut rng = Rng::new(11);
            let certifier = Certifier::new(&part.bvh, tool(name)).expect("a profile or a bound");
            let certifier = certifier.with_level(level);
            let poses: Vec<[Pose; 2]> =
                (0..POSES).map(|_| [(); 2].map(|()| brute.random_pose(&mut rng))).collect();
            let mut write = |label: &str, certifier: &Certifier<'_>, query: Query| {
                let total: u32 = poses.iter().map(|poses| work(certifier, query, poses)).sum();
                writeln!(text, "{name} at {}, {label}: {total}", part.name).expect("a text");
            };
            // Distances from a tool without a profile take long, as do motions at the tube.
            let queries = match (tool(name).info().is_exact(), part.name) {
                (false, "tube") => &[],
                (false, _) => &QUERIES[..4],
                (true, "tube") => &QUERIES[..7],
                (true, _) => &QUERIES[..],
            };
            for (label, query) in queries {
                write(label, &certifier, *query);
            }
            let restricted = restricted(&certifier, tool(name));
            for (label, query) in queries.iter().filter(|(label, _)| label.starts_with("check")) {
                write(&format!("{label} with allowances"), &restricted, *query);
            }
        }
    }
    text
}
