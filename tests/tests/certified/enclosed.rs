//! Tools in a block of material, where no triangle shows a violation.
//!
//! The tool's extents are known from the dimensions of its drawing, so the correct verdict on a whole tool is known: it is
//! inside a block unless a face of the block cuts it. Some surfaces of a tool may be in the material and others not. Which
//! of them are there is known from samples of the tool's section, whose depth and nearest surface the oracle evaluates.

use crate::depth_oracle::{DepthOracle, FIELDS, PROFILES};
use crate::pair::{INSIDE, QUERIED, TOUCHING, VIOLATIONS};
use crate::prelude::*;
use touchoff_tools::TOOLS;

/// Checks the verdicts on random blocks around a tool. One face of each is a small distance inside or outside the tool's
/// extent, and the others are farther away.
fn check_blocks(name: &str, blocks: usize) -> Tally {
    let (tool, subject) = (tool(name), DepthOracle::of(name));
    let mut rng = Rng::new(5);
    let info = tool.info();
    let mut tally = Tally::default();
    let [radius, height] = subject.oracle.extent();
    let size = radius.max(height);
    for _ in 0..blocks {
        let gap = size * rng.power(subject.min_gap.log10(), -1.0);
        let inside = rng.once_in(2);
        let near_face = rng.index(6);
        let extent = [radius, radius, 0.0, radius, radius, height];
        let faces: [f64; 6] = std::array::from_fn(|face| {
            let margin = if face == near_face && inside {
                gap
            } else if face == near_face {
                -gap.min(0.1 * radius)
            } else {
                size * rng.between(0.2, 1.0)
            };
            let coordinate = extent[face] + margin;
            if face < 3 { -coordinate } else { coordinate }
        });
        let [low, high] = [Point3::from_slice(&faces[..3]), Point3::from_slice(&faces[3..])];
        let cuboid = shapes::cuboid(low, high, info.unit).expect("a cuboid");
        let tip = Point3::from(rng.direction()) * size;
        let pose = Pose::from_axis(tip, Vector3::from(rng.direction())).expect("an axis");
        let to_world = |p: &Point3<f64>| pose.tip() + pose.rotation() * p.coords;
        let mut certifier = certifier_of(&moved(&cuboid, to_world), tool);
        let verdict = certifier.check_pose(&pose);
        tally.add(QUERIED, 1);
        match (inside, verdict) {
            (true, PoseVerdict::Inside(_)) => tally.add(INSIDE, 1),
            (false, PoseVerdict::Touching(_)) => tally.add(TOUCHING, 1),
            (_, PoseVerdict::Undecided(_)) => {}
            _ => {
                let case = format!("{name} in {faces:?}, inside {inside}: {verdict:?} at {pose:?}");
                tally.find(VIOLATIONS, case);
            }
        }
    }
    tally
}

#[test]
fn a_tool_in_a_block_is_inside_unless_a_face_cuts_it() {
    // The extents of a solid are not distances from an axis.
    let fields: Vec<&str> =
        FIELDS.into_iter().filter(|name| !["Block", "LBracket"].contains(name)).collect();
    let mut tallies = Vec::new();
    for (tools, blocks) in [(&PROFILES[..], 1000), (&fields, 20)] {
        for name in tools {
            let tally = check_blocks(name, blocks);
            let is_enough = |kind: &str| 4 * tally.count(kind) > blocks as u64;
            assert!(is_enough(INSIDE) && is_enough(TOUCHING), "{name}: {tally}");
            tallies.push(tally);
        }
    }
    let total: Tally = tallies.into_iter().sum();
    eprintln!("blocks: {total}");
    total.assert_none(VIOLATIONS);
}

/// Returns a cube around the origin that contains any library tool.
fn large_cube() -> TriangleBvh {
    TriangleBvh::new(&block([-2000.0; 3], [2000.0; 3]))
}

/// Returns a certifier that restricts only some surfaces; the others may have any depth.
fn restricted<'a>(
    bvh: &'a TriangleBvh,
    tool: &'a dyn Tool,
    limit: impl Fn(usize) -> Option<f64>,
) -> Certifier<'a> {
    let all = 0..tool.info().surfaces.len();
    let certifier = Certifier::new(bvh, tool).expect("a tool of the library");
    allowing(certifier, tool, all.map(|index| limit(index).unwrap_or(f64::INFINITY)))
}

/// Each surface of each tool alone, inside a solid, at a pose and on a motion.
#[test]
fn each_restricted_surface_is_found_inside() {
    let bvh = large_cube();
    let pose_from = |tip: [f64; 3], quaternion| {
        Pose::from_quaternion(tip.into(), quaternion).expect("a quaternion")
    };
    let start = pose_from([1.3, -2.7, 5.1], [0.36, 0.48, 0.0, 0.8]);
    let motion = Motion::with_spin(&start, &pose_from([9.0, 4.0, -3.0], [0.6, 0.0, 0.0, 0.8]));
    let motion = motion.expect("less than half a turn");
    for tool in TOOLS {
        for (index, surface) in tool.info().surfaces.iter().enumerate() {
            let limit = |other: usize| (other == index).then_some(0.0);
            let mut certifier = restricted(&bvh, *tool, limit);
            let (name, index) = (&tool.info().name, SurfaceId(index));
            let verdicts = (certifier.check_pose(&start), certifier.check_motion(&motion, 1e-6));
            let expected = (PoseVerdict::Inside(index), MotionVerdict::Inside(index));
            assert_eq!(verdicts, expected, "{name}/{}", surface.name);
        }
    }
}

#[test]
fn random_sets_of_restricted_surfaces_are_found_inside() {
    let bvh = large_cube();
    let mut rng = Rng::new(7);
    for tool in TOOLS {
        let count = tool.info().surfaces.len();
        for _ in 0..8 {
            let bits = rng.bits();
            let limit = |other: usize| (bits >> (other % 64) & 1 == 1).then_some(0.0);
            let mut certifier = restricted(&bvh, *tool, limit);
            let is_restricted = (0..count).any(|index| limit(index).is_some());
            let pose = Pose::from_axis(Point3::from([3.0; 3]), Vector3::from(rng.direction()));
            let verdict = certifier.check_pose(&pose.expect("an axis"));
            let is_right = match verdict {
                PoseVerdict::Inside(surface) => limit(surface.0).is_some(),
                other => !is_restricted && other == PoseVerdict::Clear,
            };
            assert!(is_right, "{}: {verdict:?}", tool.info().name);
        }
    }
}

/// Random limits at random heights. If a restricted sample of the tool's section is in the part beyond its limit, the
/// tool is not clear.
#[test]
fn inside_verdicts_agree_with_samples_of_the_section() {
    const SAMPLES: usize = 20_000;
    let bvh = TriangleBvh::new(&block([-2000.0; 3], [2000.0, 2000.0, 0.0]));
    let (mut inside, mut clear) = (0, 0);
    for name in ["Barrel", "BullNose", "TSlot", "BallEr16", "Lollipop", "TaperedBall"] {
        let (tool, oracle) = (tool(name), Nearest::of(name));
        let length = tool.info().unit.factor_to(Unit::Millimetre);
        let surfaces: Vec<&str> = tool.info().surfaces.iter().map(|s| &*s.name).collect();
        let [radius, height] = oracle.extent();
        let mut rng = Rng::new(11);
        // Each sample has the point, its depth, and the index of the nearest surface.
        let samples: Vec<([f64; 2], f64, usize)> = (0..SAMPLES)
            .filter_map(|_| {
                let point = [rng.between(0.0, radius), rng.between(0.0, height)];
                let evaluation = oracle.evaluate([point[0], 0.0, point[1]])?;
                let distance_to =
                    |surface: &str| oracle.distance_to_surface(surface, [point[0], 0.0, point[1]]);
                let nearest = (0..surfaces.len()).min_by(|a, b| {
                    distance_to(surfaces[*a]).total_cmp(&distance_to(surfaces[*b]))
                })?;
                Some((point, evaluation.depth, nearest))
            })
            .collect();
        for _ in 0..60 {
            let limits: Vec<Option<f64>> = surfaces
                .iter()
                .map(|_| match rng.bits() % 3 {
                    0 => None,
                    1 => Some(0.0),
                    _ => Some(radius * length * rng.between(0.0, 0.9)),
                })
                .collect();
            let mut certifier = restricted(&bvh, tool, |index| limits[index]);
            // Upright or upside down: the material is below a height of the tool, or above it.
            let (up, cut) = (rng.once_in(2), rng.between(-0.1, 1.1) * height);
            let axis = [0.0, 0.0, if up { 1.0 } else { -1.0 }];
            let tip = [0.1, 0.2, if up { -cut } else { cut } * length];
            let verdict = certifier.check_pose(&pose(tip, axis));
            let margin = 1e-6 * radius;
            let forbidden = samples.iter().filter(|([_, z], depth, surface)| {
                let below = if up { cut - z } else { z - cut };
                limits[*surface].is_some_and(|limit| *depth > limit / length + margin)
                    && below > margin
            });
            let forbidden = forbidden.count();
            match verdict {
                PoseVerdict::Clear => {
                    clear += 1;
                    assert_eq!(forbidden, 0, "{name} {limits:?} {cut} {up}");
                }
                PoseVerdict::Inside(surface) => {
                    inside += 1;
                    assert!(limits[surface.0].is_some(), "{name}");
                }
                PoseVerdict::Touching(_) => {}
                other => panic!("{name}: {other:?} {limits:?} {cut} {up}"),
            }
        }
    }
    assert!(inside > 30 && clear > 60, "{inside} inside, {clear} clear");
}

/// A tool in the material whose surface meets the part's without a depth, or reaches out of it: what the triangles show is not all that
/// is in the material.
#[test]
fn tools_that_meet_the_surface_from_inside_are_inside() {
    let drum = drawn("0 0; drum 5 0, 5 20, 0 20", "");
    let part = block([-10.0, -10.0, 0.0], [10.0, 10.0, 30.0]);
    let mut certifier = certifier_of(&part, &drum);
    // The height of the tip, whether the tool is inside, and a bound of the signed distance.
    for (tip, is_inside, ends_below) in [
        (0.0, true, -1.0),
        (5.0, true, -1.0),
        (10.0, true, -1.0),
        (-1.0, true, -0.9),
        (-4.0, true, -3.9),
        (29.0, false, -0.9),
        (30.0, false, 1e-6),
        (31.0, false, 1.1),
    ] {
        let tip_at = pose([0.0, 0.0, tip], UP);
        let depth = certifier.deepest(&tip_at, 1e-9).depth;
        assert_eq!(certifier.is_inside(&tip_at, depth.high), Some(is_inside), "{tip}: {depth:?}");
        let signed = certifier.signed_distance(&tip_at, 1e-9);
        assert!(signed.high < ends_below, "{tip}: {signed:?}");
        let is_open = is_inside && depth.low == 0.0;
        assert_eq!(signed.low == f64::NEG_INFINITY, is_open, "{tip}: {signed:?}");
    }
}
