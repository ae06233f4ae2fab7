//! Allowances of surfaces and depths per surface, checked against the oracle's owners and against known geometry.

use super::{oracle, overhang, plate, pose, tool};
use nalgebra::Point3;
use touchoff::certify::{
    AllowanceError, Certifier, MotionVerdict, PoseVerdict, TriangleBvh, Witness,
};
use touchoff::mesh::shapes;
use touchoff::{Interval, Mesh, Motion, Pose, SurfaceId, Tool, Unit};
use touchoff_bench::certified::brute::Brute;
use touchoff_bench::certified::owned::Owned;
use touchoff_bench::certified::{poses, ways};
use touchoff_tests::oracle::draw::Rng;

const UP: [f64; 3] = [0.0, 0.0, 1.0];
const TOOLS: [&str; 10] = [
    "Fig73Exact",
    "BullNose",
    "TSlot",
    "BallEr16",
    "Lollipop",
    "Barrel",
    "FaceMill",
    "Dished",
    "Bell",
    "Skirt",
];

/// Number of poses and of motions per part and tool.
const POSES: usize = 7;
const WAYS: usize = 5;
/// Number of times sampled per motion.
const TIMES: u32 = 12;

fn block(low: [f64; 3], high: [f64; 3]) -> Mesh {
    shapes::cuboid(Point3::from(low), Point3::from(high), Unit::Millimetre).expect("a cuboid")
}

fn names(tool: &dyn Tool) -> Vec<String> {
    tool.info().surfaces.iter().map(|surface| surface.name.to_string()).collect()
}

/// Returns a certifier with allowances by name; those of all other surfaces are 0.
fn allowing<'a>(bvh: &'a TriangleBvh, name: &str, allowed: &[(&str, f64)]) -> Certifier<'a> {
    let certifier = Certifier::new(bvh, tool(name)).expect("a profile");
    allowed.iter().fold(certifier, |certifier, (surface, allowed)| {
        certifier.with_allowance(surface, *allowed).expect("a surface")
    })
}

/// Runs a check for all parts and tools.
fn everywhere(tools: &[&str], mut ask: impl FnMut(&str, &TriangleBvh, &Owned<'_>, &mut Rng)) {
    let mut draw = Rng::new(5);
    for (_, mesh) in poses::parts().expect("parts") {
        let bvh = TriangleBvh::new(&mesh);
        for name in tools {
            let oracle = oracle(name);
            let length = tool(name).info().unit.factor_to(mesh.unit());
            let brute = Brute::new(&mesh, &oracle, length);
            let names = names(tool(name));
            let owned = Owned { brute: &brute, allowed: vec![0.0; names.len()], names };
            ask(name, &bvh, &owned, &mut draw);
        }
    }
}

fn any_pose(owned: &Owned<'_>, draw: &mut Rng) -> Pose {
    ways::way(owned.brute, "still", draw).from
}

/// Sets random allowances of the order of the depths that occur.
fn any_allowed(owned: &mut Owned<'_>, draw: &mut Rng) {
    for allowed in &mut owned.allowed {
        let size = 10f64.powf(draw.between(-3.0, 0.7));
        *allowed = match draw.bits() % 5 {
            0 => 0.0,
            1 => f64::INFINITY,
            2 => -size,
            _ => size,
        };
    }
}

fn rounding(owned: &Owned<'_>) -> f64 {
    64.0 * f64::EPSILON * owned.brute.size
}

#[test]
fn no_sample_of_a_surface_is_deeper_than_it_was_said_to_be() {
    let owners = each_surface(&["Fig73Exact", "TSlot", "BallEr16", "Lollipop"]);
    assert!(owners > 80, "{owners}");
}

#[test]
fn nor_is_one_of_a_corner() {
    let owners = each_surface(&["BullNose", "Barrel", "CornerRounding"]);
    assert!(owners > 60, "{owners}");
}

#[test]
fn nor_is_one_of_a_profile_that_overhangs() {
    let owners = each_surface(&[&["FaceMill", "BoringBar"], &overhang::ALL[..]].concat());
    assert!(owners > 100, "{owners}");
}

/// Checks the certified depth of each surface against samples. Returns the number of surfaces and poses with samples.
fn each_surface(tools: &[&str]) -> usize {
    let mut owners = 0;
    everywhere(tools, |name, bvh, owned, draw| {
        let mut certifier = Certifier::new(bvh, tool(name)).expect("a profile");
        let rounding = rounding(owned);
        for k in 0..POSES {
            let (pose, tolerance) = (any_pose(owned, draw), [0.0, 1e-6, 1e-3][k % 3]);
            let samples = owned.samples(&pose, draw);
            let mut most = [0.0f64; 2];
            for surface in 0..owned.names.len() {
                let found =
                    certifier.deepest_on(SurfaceId(surface), &pose, tolerance).expect("a surface");
                let text = format!("{name} {surface} at {pose:?}, {tolerance:e}: {found:?}");
                let Interval { low, high } = found.depth;
                assert!(0.0 <= low && low <= high, "{text}");
                let best = owned.most(&pose, &samples, |p| owned.depth(surface, p), draw);
                if let Some(best) = best {
                    assert!(best.value <= high + rounding, "{text}, {best:?}");
                    owners += 1;
                }
                if let Some(witness) = found.witness {
                    let p = owned.brute.inside(&pose, witness.point);
                    let depth = owned.brute.depth(p) * owned.brute.length;
                    assert!(depth >= low - rounding, "{text}: {depth}");
                    assert!(owned.away(surface, p) <= depth.abs() + 4.0 * rounding, "{text}");
                    assert_eq!(witness.surface, SurfaceId(surface), "{text}");
                } else {
                    assert_eq!(low, 0.0, "{text}");
                }
                most = [most[0].max(low), most[1].max(high)];
            }
            let whole = certifier.deepest(&pose, tolerance).depth;
            let agree = most[0] <= whole.high + rounding && whole.low <= most[1] + rounding;
            assert!(agree, "{name} at {pose:?}: {most:?} of each, {whole:?} of all");
        }
    });
    owners
}

/// Checks that a witness is deeper than its surface's allowance, or nearer than the distance to keep.
fn holds(owned: &Owned<'_>, pose: &Pose, witness: &Witness, text: &str) {
    let p = owned.brute.inside(pose, witness.point);
    let (slack, allowed) = (4.0 * rounding(owned), owned.allowed[witness.surface.0]);
    let (depth, away) =
        (owned.brute.depth(p) * owned.brute.length, owned.away(witness.surface.0, p));
    let deep = away <= depth + slack && depth >= allowed.max(0.0) - slack;
    assert!(deep || away <= -allowed + slack, "{text}: {depth} deep, {away} away");
}

#[test]
fn clear_goes_by_allowances() {
    let mut seen = [0; 2];
    everywhere(&TOOLS, |name, bvh, owned, draw| {
        for _ in 0..POSES {
            let mut owned =
                Owned { names: owned.names.clone(), allowed: owned.allowed.clone(), ..*owned };
            any_allowed(&mut owned, draw);
            let allowed: Vec<_> =
                owned.names.iter().map(String::as_str).zip(owned.allowed.iter().copied()).collect();
            let mut certifier = allowing(bvh, name, &allowed);
            let pose = any_pose(&owned, draw);
            let found = certifier.check_pose(&pose);
            let text = format!("{name} at {pose:?} with {allowed:?}: {found:?}");
            let over = |draw: &mut Rng| {
                let samples = owned.samples(&pose, draw);
                owned.most(&pose, &samples, |p| owned.over(p), draw).map_or(0.0, |best| best.value)
            };
            match found {
                PoseVerdict::Clear | PoseVerdict::Inside(_) | PoseVerdict::SurfaceOnly => {
                    let over = over(draw);
                    assert!(over <= 4.0 * rounding(&owned), "{text}: {over}");
                    seen[0] += 1;
                }
                PoseVerdict::Touching(witness) => {
                    holds(&owned, &pose, &witness, &text);
                    seen[1] += 1;
                }
                PoseVerdict::Undecided(high) => {
                    let over = over(draw);
                    assert!(over <= high + 4.0 * rounding(&owned), "{text}: {over}");
                }
            }
        }
    });
    assert!(seen.iter().all(|count| *count > 20), "{seen:?}");
}

#[test]
fn sweeps_go_by_allowances() {
    let mut seen = [0; 3];
    everywhere(&TOOLS, |name, bvh, owned, draw| {
        for k in 0..WAYS {
            let mut owned =
                Owned { names: owned.names.clone(), allowed: owned.allowed.clone(), ..*owned };
            any_allowed(&mut owned, draw);
            let allowed: Vec<_> =
                owned.names.iter().map(String::as_str).zip(owned.allowed.iter().copied()).collect();
            let mut certifier = allowing(bvh, name, &allowed).with_budget(1 << 17);
            let way = ways::way(owned.brute, ways::KINDS[(5 * k) % ways::KINDS.len()], draw);
            let motion = Motion::new(&way.from, &way.to).expect("one way");
            let tolerance = [0.0, 1e-3][k % 2];
            let found = certifier.check_motion(&motion, tolerance);
            let text = format!("{name} on {way:?} with {allowed:?}, {tolerance:e}: {found:?}");
            let until = match found {
                MotionVerdict::Touching(at, witness) => {
                    holds(&owned, &motion.pose(at), &witness, &text);
                    seen[1] += 1;
                    continue;
                }
                MotionVerdict::Undecided(at) => {
                    seen[2] += 1;
                    at
                }
                MotionVerdict::Clear | MotionVerdict::Inside(_) | MotionVerdict::SurfaceOnly => {
                    seen[0] += 1;
                    1.0
                }
            };
            let rounding = rounding(&owned) + 64.0 * f64::EPSILON * motion.displacement().norm();
            for time in 0..TIMES {
                let t = until * f64::from(time) / f64::from(TIMES - 1);
                let pose = way.pose(t);
                let samples = owned.samples(&pose, draw);
                let over = owned.most(&pose, &samples, |p| owned.over(p), draw);
                let over = over.map_or(0.0, |best| best.value);
                assert!(
                    over <= tolerance.max(16.0 * rounding) + 4.0 * rounding,
                    "{text}: {over} at {t}"
                );
            }
        }
    });
    eprintln!("{seen:?}");
    assert!(seen[0] > 10 && seen[1] > 20, "{seen:?}");
}

#[test]
fn a_flute_may_cut_and_a_shank_may_not() {
    // The flute extends from z = 0 to 26 and has a radius of 6; the shank above is as thick.
    let beside = pose([0.0; 3], UP);
    for (top, clear) in [(25.0, true), (25.5, true), (26.0 + 1e-3, false), (40.0, false)] {
        let wall = block([4.0, -30.0, 5.0], [40.0, 30.0, top]);
        let bvh = TriangleBvh::new(&wall);
        let mut certifier = allowing(&bvh, "Flat", &[("flute", f64::INFINITY)]);
        let found = certifier.check_pose(&beside);
        let still = certifier.check_motion(&Motion::new(&beside, &beside).expect("one way"), 0.0);
        if clear {
            assert_eq!((found, still), (PoseVerdict::Clear, MotionVerdict::Clear), "{top}");
        } else {
            let PoseVerdict::Touching(witness) = found else { panic!("{top}: {found:?}") };
            assert_eq!(names(tool("Flat"))[witness.surface.0], "shank", "{top}");
            assert!(matches!(still, MotionVerdict::Touching(..)), "{top}: {still:?}");
        }
    }
    let wall = block([4.0, -30.0, 5.0], [40.0, 30.0, 20.0]);
    let bvh = TriangleBvh::new(&wall);
    for (allowed, clear) in [(2.0 + 1e-9, true), (2.0 - 1e-9, false), (0.0, false)] {
        let mut certifier = allowing(&bvh, "Flat", &[("flute", allowed)]);
        assert_eq!(certifier.check_pose(&beside) == PoseVerdict::Clear, clear, "{allowed}");
        // Along the wall the depth is constant.
        let found = certifier.check_motion(&along_the_wall(), 0.02);
        assert_eq!(found == MotionVerdict::Clear, allowed > 1.0, "{allowed}: {found:?}");
    }
}

/// Returns a motion on which the flute stays 2 mm deep in a wall at x = 4.
fn along_the_wall() -> Motion {
    Motion::new(&pose([0.0, -10.0, 0.0], UP), &pose([0.0, 10.0, 0.0], UP)).expect("one way")
}

#[test]
fn a_flute_cuts_along_a_wall() {
    let wall = block([4.0, -30.0, 5.0], [40.0, 30.0, 20.0]);
    let bvh = TriangleBvh::new(&wall);
    for allowed in [2.01, 3.0, f64::INFINITY] {
        for tolerance in [0.0, 1e-6, 1e-3] {
            let mut certifier = allowing(&bvh, "Flat", &[("flute", allowed)]);
            let found = certifier.check_motion(&along_the_wall(), tolerance);
            assert_eq!(found, MotionVerdict::Clear, "{allowed} {tolerance:e}");
        }
    }
}

/// A part at a given distance from the nut.
type Case = (&'static str, fn(f64) -> Mesh);

#[test]
fn a_nut_keeps_its_margin_from_all_sides() {
    // The nut's ring is at z = 30, its cone has radii 12.9 to 14, its side has radius 14 up to z = 47.5.
    let diagonal = std::f64::consts::FRAC_1_SQRT_2;
    let cases: [Case; 4] = [
        ("ring", |gap| block([7.0, -1.0, 20.0], [9.0, 1.0, 30.0 - gap])),
        ("side", |gap| block([14.0 + gap, -9.0, 35.0], [30.0, 9.0, 40.0])),
        ("end", |gap| block([-9.0, -9.0, 47.5 + gap], [9.0, 9.0, 60.0])),
        ("past the ring", |gap| block([7.0, -1.0, 20.0], [40.0, 1.0, 30.0 - gap])),
    ];
    for (case, part) in cases {
        for (gap, clear) in [(0.4, false), (0.5 - 1e-9, false), (0.5 + 1e-9, true), (0.6, true)] {
            let bvh = TriangleBvh::new(&part(gap));
            let mut certifier = allowing(&bvh, "BallEr16", &[("nut.nut", -0.5)]);
            let here = pose([0.0; 3], UP);
            let found = certifier.check_pose(&here);
            let turned = Motion::new(&pose([0.0; 3], UP), &here).expect("one way");
            let still = certifier.check_motion(&turned, 0.0);
            if clear {
                assert_eq!(
                    (found, still),
                    (PoseVerdict::Clear, MotionVerdict::Clear),
                    "{case} {gap}"
                );
            } else {
                let PoseVerdict::Touching(witness) = found else {
                    panic!("{case} {gap}: {found:?}")
                };
                assert_eq!(names(tool("BallEr16"))[witness.surface.0], "nut.nut");
                assert!(matches!(still, MotionVerdict::Touching(..)), "{case} {gap}: {still:?}");
            }
            // Approach from far away along the axis.
            let lift = if case == "end" { -30.0 } else { 3.0 };
            let down = Motion::new(&pose([0.0, 0.0, lift], UP), &here).expect("one way");
            let down = certifier.check_motion(&down, 0.0);
            if case != "side" {
                assert_eq!(down == MotionVerdict::Clear, clear, "{case} {gap}: {down:?}");
            }
        }
    }
    // A corner of a part beside the cone, at a distance along the diagonal.
    for (gap, clear) in [(0.4, false), (0.6, true)] {
        let at = [13.45 + gap * diagonal, 0.0, 30.55 - gap * diagonal];
        let bvh = TriangleBvh::new(&block([at[0], -1.0, 20.0], [at[0] + 5.0, 1.0, at[2]]));
        let mut certifier = allowing(&bvh, "BallEr16", &[("nut.nut", -0.5)]);
        assert_eq!(certifier.check_pose(&pose([0.0; 3], UP)) == PoseVerdict::Clear, clear, "{gap}");
    }
}

#[test]
fn a_level_face_alone_keeps_its_margin() {
    let bvh = TriangleBvh::new(&plate());
    for (tip, clear) in [(0.4, false), (0.6, true), (0.5 + 1e-9, true), (0.5 - 1e-9, false)] {
        let mut certifier = allowing(&bvh, "Flat", &[("face", -0.5)]);
        let here = pose([1.0, 2.0, tip], UP);
        let found = certifier.check_pose(&here);
        assert_eq!(found == PoseVerdict::Clear, clear, "{tip}: {found:?}");
        for from in [[-60.0, 2.0, tip], [1.0, 2.0, 30.0]] {
            let way = Motion::new(&pose(from, UP), &here).expect("one way");
            let found = certifier.check_motion(&way, 0.0);
            assert_eq!(found == MotionVerdict::Clear, clear, "{tip}: {found:?}");
        }
        // A part inside the middle of the tool, with depth allowed for the flute.
        let inside = TriangleBvh::new(&block([-1.0, -1.0, tip], [1.0, 1.0, 5.0]));
        let allowed = [("face", -0.5), ("flute", f64::INFINITY), ("shank", f64::INFINITY)];
        let mut certifier = allowing(&inside, "Flat", &allowed);
        // The face is the nearest surface here, and it must not be in the part at all.
        let found = certifier.check_pose(&pose([0.0; 3], UP));
        assert!(matches!(found, PoseVerdict::Touching(_)), "{tip}: {found:?}");
        let above = TriangleBvh::new(&block([5.8, -0.1, tip], [5.9, 0.1, 5.0]));
        let mut certifier = allowing(&above, "Flat", &allowed);
        let found = certifier.check_pose(&pose([0.0; 3], UP));
        assert_eq!(
            matches!(found, PoseVerdict::Clear | PoseVerdict::SurfaceOnly),
            clear,
            "{tip}: {found:?}"
        );
        let way = Motion::new(&pose([0.0; 3], UP), &pose([0.0; 3], UP)).expect("one way");
        let found = certifier.check_motion(&way, 0.0);
        assert_eq!(found == MotionVerdict::Clear, clear, "{tip}: {found:?}");
    }
}

#[test]
fn all_surfaces_may_be_in_a_part_or_have_to_keep_off_it() {
    let bvh = TriangleBvh::new(&plate());
    let deep = pose([0.0, 0.0, -5.0], UP);
    let all = |allowed: f64| names(tool("Flat")).into_iter().map(move |name| (name, allowed));
    for (allowed, clear) in [(f64::INFINITY, true), (5.1, true), (4.9, false), (-1.0, false)] {
        let of: Vec<_> = all(allowed).collect();
        let of: Vec<_> = of.iter().map(|(name, allowed)| (name.as_str(), *allowed)).collect();
        let mut certifier = allowing(&bvh, "Flat", &of);
        let found = certifier.check_pose(&deep);
        assert_eq!(matches!(found, PoseVerdict::Touching(_)), !clear, "{allowed}: {found:?}");
        let high = certifier.check_pose(&pose([0.0, 0.0, 1.0 + 1e-6], UP));
        assert_eq!(high, PoseVerdict::Clear, "{allowed}");
        let way = Motion::new(&deep, &pose([3.0, 0.0, -5.0], UP)).expect("one way");
        let found = certifier.check_motion(&way, 0.0);
        assert_eq!(matches!(found, MotionVerdict::Touching(..)), !clear, "{allowed}: {found:?}");
    }
}

#[test]
fn allowances_that_mean_nothing_are_refused() {
    let bvh = TriangleBvh::new(&plate());
    let refused = |surface: &str, allowed: f64| {
        let certifier = Certifier::new(&bvh, tool("Flat")).expect("a profile");
        certifier.with_allowance(surface, allowed).expect_err("no allowance")
    };
    let known = "`face`, `flute`, `shank`".to_owned();
    let expected =
        AllowanceError::NoSurface { tool: "Flat".into(), surface: "flank".into(), known };
    assert_eq!(refused("flank", 1.0), expected);
    let text = "Flat has no surface `flank`; it has `face`, `flute`, `shank`";
    assert_eq!(expected.to_string(), text);
    let text = refused("flute", f64::NAN).to_string();
    assert_eq!(text, "an allowance of NaN for `flute` is no length");
    let text = refused("flute", f64::NEG_INFINITY).to_string();
    assert_eq!(text, "an allowance of -inf for `flute` is no length");
}

/// The corner that the neck shares with the surface below owns points at the flute's heights, but not points of the
/// flute: a part that touches the flute does not touch the neck.
#[test]
fn the_neck_is_not_touched_where_the_flute_is() {
    for off in -40..=40 {
        let wall = block([8.25 + f64::from(off) * 1e-13, -20.0, 0.5], [30.0, 20.0, 2.5]);
        let bvh = TriangleBvh::new(&wall);
        let mut certifier = allowing(&bvh, "Woodruff", &[("flute", 0.01)]);
        let clear = certifier.check_pose(&pose([0.0; 3], UP));
        assert!(matches!(clear, PoseVerdict::Clear), "{off}: {clear:?}");
    }
}
