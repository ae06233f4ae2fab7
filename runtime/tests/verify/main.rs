//! Verification of programs: a comparison with brute force on random ones, and cases whose findings follow from
//! geometry.

mod cases;
mod oracle;

use nalgebra::Point3;
use oracle::{Draw, Mounted, SURFACES, Stand, Worst, along, places};
use touchoff::certify::{TriangleBvh, Witness};
use touchoff::mesh::shapes;
use touchoff::verify::{Finding, FindingKind, Verifier};
use touchoff::{Interval, Mesh, Pose, Program, SurfaceId, Unit};

pub(crate) fn block(low: [f64; 3], high: [f64; 3]) -> Mesh {
    shapes::cuboid(Point3::from(low), Point3::from(high), Unit::Millimetre).expect("a cuboid")
}

const RESOLUTION: f64 = 1e-3;
/// Distance between sample points of triangles, in mm.
const STEP: f64 = 0.6;
/// Number of time steps per motion.
const TIMES: u32 = 24;

/// Returns a random walk of poses about a block, each with a flag for rapid traverse.
fn walk(draw: &mut Draw, stops: usize) -> Vec<(Stand, bool)> {
    let mut tip = Point3::from(draw.vector(12.0));
    let mut axis = draw.vector(1.0).normalize();
    let mut walk = Vec::new();
    for _ in 0..stops {
        walk.push(((tip, axis), draw.between(0.0, 1.0) < 0.2));
        let size = if draw.between(0.0, 1.0) < 0.3 { 9.0 } else { 1.5 };
        // The factor keeps the walk near the block.
        tip = Point3::from((tip.coords + draw.vector(size)) * 0.95);
        axis = (axis + draw.vector(0.25)).normalize();
    }
    walk
}

/// Returns the depth that each surface is allowed in the motion to a stop.
fn limits(given: &[(&str, f64)], tolerance: f64, rapid: bool) -> [f64; 4] {
    SURFACES.map(|name| {
        let own = given.iter().find(|(known, _)| *known == name).map(|(_, allowed)| *allowed);
        let allowed = own.unwrap_or(tolerance);
        if rapid { allowed.min(tolerance) } else { allowed }
    })
}

/// Checks a finding at the witness that it names.
fn judge(found: &Finding, mesh: &Mesh, limits: &[f64; 4], (from, to): (&Stand, &Stand)) {
    let (tip, axis) = along((from, to), found.time);
    assert!((found.pose.tip() - tip).norm() < 1e-9 && (found.pose.axis() - axis).norm() < 1e-9);
    let stand = (tip, axis);
    let on = |witness: &Witness| {
        let [a, b, c] = mesh.triangle(witness.triangle);
        let normal = (b - a).cross(&(c - a)).normalize();
        assert!((witness.point - a).dot(&normal).abs() < 1e-9, "{found:?}");
        let mut there = Worst::none();
        there.add(&witness.point, &stand);
        there
    };
    match &found.kind {
        FindingKind::Deep {
            surface,
            allowed,
            depth: Interval { low, high },
            max_depth,
            witness,
            ..
        } => {
            let there = on(witness).depth[surface.0];
            assert_eq!(*allowed, limits[surface.0]);
            assert!(*low <= there + 1e-9 && there <= high + 1e-9, "{there}: {found:?}");
            assert!(
                there > allowed.max(0.0) && high - low < RESOLUTION && max_depth >= high,
                "{found:?}"
            );
        }
        FindingKind::Near {
            surface,
            margin,
            distance: Interval { low, high },
            min_distance,
            witness,
        } => {
            let there = on(witness).distance[surface.0];
            assert_eq!(-margin, limits[surface.0]);
            assert!(*low <= there + 1e-9 && there <= high + 1e-9, "{there}: {found:?}");
            assert!(there < *margin && high - low < RESOLUTION && min_distance <= low, "{found:?}");
        }
        other => panic!("{other:?} at {found:?}"),
    }
}

/// Compares the findings of a motion with the result of brute force.
fn hold(of: &[Finding], limits: &[f64; 4], worst: &Worst) {
    for (surface, limit) in limits.iter().enumerate() {
        let found: Vec<_> =
            of.iter().filter(|f| f.kind.surface() == Some(SurfaceId(surface))).collect();
        assert!(found.len() <= 1, "{found:?}");
        let (depth, distance) = (worst.depth[surface], worst.distance[surface]);
        let deep = depth > limit.max(0.0) + RESOLUTION;
        let near = *limit < 0.0 && distance < -limit - RESOLUTION;
        match found.first().map(|found| found.kind) {
            Some(FindingKind::Deep { max_depth, .. }) => {
                assert!(depth <= max_depth + 1e-9, "{depth}: {found:?}");
            }
            Some(FindingKind::Near { min_distance, .. }) => {
                assert!(!deep && distance >= min_distance - 1e-9, "{distance}: {found:?}");
            }
            _ => assert!(!deep && !near, "{surface}: {limit}, {worst:?}, {of:?}"),
        }
    }
}

#[test]
fn brute_force_finds_nothing_else() {
    let meshes = [
        block([-8.0, -8.0, -8.0], [8.0, 8.0, 8.0]),
        shapes::plane(18.0, 6, Unit::Millimetre).expect("a sheet"),
    ];
    let cut = f64::INFINITY;
    let allowances: [&[(&str, f64)]; 5] = [
        &[],
        &[("flute", cut), ("ball", 1.5)],
        &[("nut", -1.0), ("shank", -0.3)],
        &[("nut", -0.5), ("flute", 0.7), ("ball", cut)],
        &[("ball", cut), ("flute", cut), ("shank", -3.0), ("nut", -6.0)],
    ];
    let [mut deep, mut near, mut clear] = [0; 3];
    for (k, mesh) in meshes.iter().enumerate() {
        let (bvh, places) = (TriangleBvh::new(mesh), places(mesh, STEP));
        for (seed, given) in (10 * k as u64..).zip(allowances) {
            let tolerance = if seed % 2 == 0 { 0.0 } else { 0.05 };
            let walk = walk(&mut Draw::new(seed + 1), 60);
            let pose = |(tip, axis): &Stand| Pose::from_axis(*tip, *axis).expect("an axis");
            let poses = walk.iter().map(|(stand, rapid)| (pose(stand), *rapid));
            let program = Program::new("walk", None, poses).expect("stops");
            let verifier = Verifier::new(&bvh, &Mounted).expect("a profile");
            let verifier = verifier.with_tolerance(tolerance).expect("a length");
            let verifier = verifier.with_resolution(RESOLUTION).expect("a length");
            let verifier = given.iter().fold(verifier, |verifier, (name, to)| {
                verifier.with_allowance(name, *to).expect("a surface")
            });
            let report = verifier.check(&program).expect("it can be checked");
            assert_eq!((report.motions, report.inside_known), (59, k == 0));
            for (stop, (to, rapid)) in walk.iter().enumerate() {
                let from = &walk[stop.saturating_sub(1)].0;
                let limits = limits(given, tolerance, *rapid);
                let found: Vec<Finding> = report
                    .findings
                    .iter()
                    .filter(|found| found.location == stop)
                    .copied()
                    .collect();
                for finding in
                    found.iter().filter(|found| !matches!(found.kind, FindingKind::Inside { .. }))
                {
                    assert_eq!((finding.line, finding.rapid), (stop + 1, *rapid));
                    judge(finding, mesh, &limits, (from, to));
                    deep += usize::from(matches!(finding.kind, FindingKind::Deep { .. }));
                    near += usize::from(matches!(finding.kind, FindingKind::Near { .. }));
                }
                let mut worst = Worst::none();
                for time in 0..=TIMES {
                    let stand = along((from, to), f64::from(time) / f64::from(TIMES));
                    places.iter().for_each(|place| worst.add(place, &stand));
                }
                hold(&found, &limits, &worst);
                clear += usize::from(found.is_empty());
            }
        }
    }
    // Without these counts the test would prove nothing.
    assert!(deep > 100 && near > 20 && clear > 100, "{deep} deep, {near} near, {clear} clear");
}
