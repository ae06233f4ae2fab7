//! Verification of programs: a comparison with brute force on random ones, and cases whose findings follow from
//! geometry.

mod bodies;
mod cases;
#[path = "../frozen/mod.rs"]
mod frozen;
mod joints;
mod machines;
mod oracle;
mod random_programs;
mod rapid;

use nalgebra::Point3;
use oracle::{Mounted, Random, SURFACES, ToolPose, Worst, interpolate, sample_points};
use touchoff::certify::{TriangleBvh, Witness};
use touchoff::mesh::shapes;
use touchoff::{Interval, Mesh, Pose, SurfaceId, Unit};
use touchoff_verify::{ClData, Finding, FindingKind, Verifier};

pub(crate) fn block(low: [f64; 3], high: [f64; 3]) -> Mesh {
    shapes::cuboid(Point3::from(low), Point3::from(high), Unit::Millimetre).expect("a cuboid")
}

const RESOLUTION: f64 = 1e-3;
/// Distance between sample points of triangles, in mm.
const SAMPLE_SPACING: f64 = 0.6;
/// Number of time steps per motion.
const TIME_STEPS: u32 = 24;

/// Returns a random walk of poses about a block, each with a flag for rapid traverse.
fn walk(random: &mut Random, count: usize) -> Vec<(ToolPose, bool)> {
    let mut tip = Point3::from(random.vector(12.0));
    let mut axis = random.vector(1.0).normalize();
    let mut walk = Vec::new();
    for _ in 0..count {
        walk.push(((tip, axis), random.chance(0.2)));
        let step = if random.chance(0.3) { 9.0 } else { 1.5 };
        // The factor keeps the walk near the block.
        tip = Point3::from((tip.coords + random.vector(step)) * 0.95);
        axis = (axis + random.vector(0.25)).normalize();
    }
    walk
}

/// Returns the depth that each surface is allowed in the motion to a cutter location.
fn limits(allowances: &[(&str, f64)], tolerance: f64, rapid: bool) -> [f64; 4] {
    SURFACES.map(|name| {
        let own_limit =
            allowances.iter().find(|(surface, _)| *surface == name).map(|(_, allowed)| *allowed);
        let allowed = own_limit.unwrap_or(tolerance);
        if rapid { allowed.min(tolerance) } else { allowed }
    })
}

/// Checks a finding at the witness that it names.
fn check_finding(
    finding: &Finding,
    mesh: &Mesh,
    limits: &[f64; 4],
    (start, end): (&ToolPose, &ToolPose),
) {
    let (tip, axis) = interpolate((start, end), finding.time);
    assert!((finding.pose.tip() - tip).norm() < 1e-9 && (finding.pose.axis() - axis).norm() < 1e-9);
    let pose = (tip, axis);
    let worst_at = |witness: &Witness| {
        let [a, b, c] = mesh.triangle(witness.triangle);
        let normal = (b - a).cross(&(c - a)).normalize();
        assert!((witness.point - a).dot(&normal).abs() < 1e-9, "{finding:?}");
        let mut actual = Worst::none();
        actual.add(&witness.point, &pose);
        actual
    };
    match &finding.kind {
        FindingKind::Deep {
            surface,
            allowed,
            depth: Interval { low, high },
            max_depth,
            witness,
            ..
        } => {
            let actual = worst_at(witness).depth[surface.0];
            assert_eq!(*allowed, limits[surface.0]);
            assert!(*low <= actual + 1e-9 && actual <= high + 1e-9, "{actual}: {finding:?}");
            assert!(
                actual > allowed.max(0.0) && high - low < RESOLUTION && max_depth >= high,
                "{finding:?}"
            );
        }
        FindingKind::Near {
            surface,
            margin,
            distance: Interval { low, high },
            min_distance,
            witness,
        } => {
            let actual = worst_at(witness).distance[surface.0];
            assert_eq!(-margin, limits[surface.0]);
            assert!(*low <= actual + 1e-9 && actual <= high + 1e-9, "{actual}: {finding:?}");
            assert!(
                actual < *margin && high - low < RESOLUTION && min_distance <= low,
                "{finding:?}"
            );
        }
        other => panic!("{other:?} at {finding:?}"),
    }
}

/// Compares the findings of a motion with the result of brute force.
fn compare_with_brute_force(findings: &[Finding], limits: &[f64; 4], worst: &Worst) {
    for (surface, limit) in limits.iter().enumerate() {
        let found: Vec<_> =
            findings.iter().filter(|f| f.kind.surface() == Some(SurfaceId(surface))).collect();
        assert!(found.len() <= 1, "{found:?}");
        let (depth, distance) = (worst.depth[surface], worst.distance[surface]);
        let is_too_deep = depth > limit.max(0.0) + RESOLUTION;
        let is_too_near = *limit < 0.0 && distance < -limit - RESOLUTION;
        match found.first().map(|found| found.kind) {
            Some(FindingKind::Deep { max_depth, .. }) => {
                assert!(depth <= max_depth + 1e-9, "{depth}: {found:?}");
            }
            Some(FindingKind::Near { min_distance, .. }) => {
                assert!(!is_too_deep && distance >= min_distance - 1e-9, "{distance}: {found:?}");
            }
            _ => {
                assert!(
                    !is_too_deep && !is_too_near,
                    "{surface}: {limit}, {worst:?}, {findings:?}"
                );
            }
        }
    }
}

#[test]
fn findings_agree_with_brute_force() {
    let meshes = [
        block([-8.0, -8.0, -8.0], [8.0, 8.0, 8.0]),
        shapes::plane(18.0, 6, Unit::Millimetre).expect("a sheet"),
    ];
    let unlimited = f64::INFINITY;
    let allowances: [&[(&str, f64)]; 5] = [
        &[],
        &[("flute", unlimited), ("ball", 1.5)],
        &[("nut", -1.0), ("shank", -0.3)],
        &[("nut", -0.5), ("flute", 0.7), ("ball", unlimited)],
        &[("ball", unlimited), ("flute", unlimited), ("shank", -3.0), ("nut", -6.0)],
    ];
    let [mut deep, mut near, mut clear] = [0; 3];
    for (k, mesh) in meshes.iter().enumerate() {
        let (bvh, points) = (TriangleBvh::new(mesh), sample_points(mesh, SAMPLE_SPACING));
        for (seed, allowances) in (10 * k as u64..).zip(allowances) {
            let tolerance = if seed % 2 == 0 { 0.0 } else { 0.05 };
            let walk = walk(&mut Random::new(seed + 1), 60);
            let pose = |(tip, axis): &ToolPose| Pose::from_axis(*tip, *axis).expect("an axis");
            let poses = walk.iter().map(|(state, rapid)| (pose(state), *rapid));
            let program = ClData::new("walk", None, poses).expect("stops");
            let verifier = Verifier::new(&bvh, &Mounted).expect("a profile");
            let verifier = verifier.with_tolerance(tolerance).expect("a length");
            let verifier = verifier.with_resolution(RESOLUTION).expect("a length");
            let verifier = allowances.iter().fold(verifier, |verifier, (name, to)| {
                verifier.with_allowance(name, *to).expect("a surface")
            });
            let report = verifier.check(&program).expect("it can be checked");
            assert_eq!((report.motions, report.inside_known), (59, k == 0));
            for (location, (to, rapid)) in walk.iter().enumerate() {
                let from = &walk[location.saturating_sub(1)].0;
                let limits = limits(allowances, tolerance, *rapid);
                let found: Vec<Finding> = report
                    .findings
                    .iter()
                    .filter(|found| found.location == location)
                    .copied()
                    .collect();
                for finding in
                    found.iter().filter(|found| !matches!(found.kind, FindingKind::Inside { .. }))
                {
                    assert_eq!((finding.line, finding.rapid), (location + 1, *rapid));
                    check_finding(finding, mesh, &limits, (from, to));
                    deep += usize::from(matches!(finding.kind, FindingKind::Deep { .. }));
                    near += usize::from(matches!(finding.kind, FindingKind::Near { .. }));
                }
                let mut expected = Worst::none();
                for time in 0..=TIME_STEPS {
                    let pose = interpolate((from, to), f64::from(time) / f64::from(TIME_STEPS));
                    points.iter().for_each(|point| expected.add(point, &pose));
                }
                compare_with_brute_force(&found, &limits, &expected);
                clear += usize::from(found.is_empty());
            }
        }
    }
    // Without these counts the test would prove nothing.
    assert!(deep > 100 && near > 20 && clear > 100, "{deep} deep, {near} near, {clear} clear");
}
