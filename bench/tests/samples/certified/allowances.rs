//! Allowances of surfaces, and how deep each is: against the oracle's owners, and where geometry says it.

use super::{oracle, overhang, plate, pose, tool};
use nalgebra::Point3;
use touchoff::certify::{AllowanceError, Certifier, Clear, Facets, Sweep, Witness};
use touchoff::mesh::shapes;
use touchoff::{Mesh, Motion, Pose, Tool, Unit};
use touchoff_bench::certified::brute::Brute;
use touchoff_bench::certified::owned::Owned;
use touchoff_bench::certified::{poses, ways};
use touchoff_tests::oracle::draw::Draw;

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

/// Poses and ways of each part and tool.
const POSES: usize = 7;
const WAYS: usize = 5;
/// Times of a way.
const TIMES: u32 = 12;

fn block(low: [f64; 3], high: [f64; 3]) -> Mesh {
    shapes::cuboid(Point3::from(low), Point3::from(high), Unit::Millimetre).expect("a cuboid")
}

fn names(tool: &dyn Tool) -> Vec<String> {
    tool.card().surfaces.iter().map(|surface| surface.name.to_string()).collect()
}

/// A certifier with allowances by name; all others are 0.
fn allowing<'a>(facets: &'a Facets, name: &str, allowed: &[(&str, f64)]) -> Certifier<'a> {
    let certifier = Certifier::new(facets, tool(name)).expect("a profile");
    allowed.iter().fold(certifier, |certifier, (surface, allowed)| {
        certifier.allow(surface, *allowed).expect("a surface")
    })
}

/// Asks something of all tools and parts.
fn everywhere(tools: &[&str], mut ask: impl FnMut(&str, &Facets, &Owned<'_>, &mut Draw)) {
    let mut draw = Draw::new(5);
    for (_, mesh) in poses::parts().expect("parts") {
        let facets = Facets::new(&mesh);
        for name in tools {
            let oracle = oracle(name);
            let length = tool(name).card().unit.to(mesh.unit());
            let brute = Brute::new(&mesh, &oracle, length);
            let names = names(tool(name));
            let owned = Owned { brute: &brute, allowed: vec![0.0; names.len()], names };
            ask(name, &facets, &owned, &mut draw);
        }
    }
}

fn any_pose(owned: &Owned<'_>, draw: &mut Draw) -> Pose {
    ways::way(owned.brute, "still", draw).from
}

/// Any allowances, about what poses have.
fn any_allowed(owned: &mut Owned<'_>, draw: &mut Draw) {
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

/// Asks how deep each surface is; of how many surfaces and poses samples were.
fn each_surface(tools: &[&str]) -> usize {
    let mut owners = 0;
    everywhere(tools, |name, facets, owned, draw| {
        let mut certifier = Certifier::new(facets, tool(name)).expect("a profile");
        let rounding = rounding(owned);
        for k in 0..POSES {
            let (pose, tolerance) = (any_pose(owned, draw), [0.0, 1e-6, 1e-3][k % 3]);
            let samples = owned.samples(&pose, draw);
            let mut most = [0.0f64; 2];
            for surface in 0..owned.names.len() {
                let found = certifier.deepest_on(surface, &pose, tolerance);
                let text = format!("{name} {surface} at {pose:?}, {tolerance:e}: {found:?}");
                let [low, high] = found.depth;
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
                    assert_eq!(witness.surface, surface, "{text}");
                } else {
                    assert_eq!(low, 0.0, "{text}");
                }
                most = [most[0].max(low), most[1].max(high)];
            }
            let whole = certifier.deepest(&pose, tolerance).depth;
            let agree = most[0] <= whole[1] + rounding && whole[0] <= most[1] + rounding;
            assert!(agree, "{name} at {pose:?}: {most:?} of each, {whole:?} of all");
        }
    });
    owners
}

/// A witness has to be deeper than its surface is allowed, or nearer.
fn holds(owned: &Owned<'_>, pose: &Pose, witness: &Witness, text: &str) {
    let p = owned.brute.inside(pose, witness.point);
    let (slack, allowed) = (4.0 * rounding(owned), owned.allowed[witness.surface]);
    let (depth, away) = (owned.brute.depth(p) * owned.brute.length, owned.away(witness.surface, p));
    let deep = away <= depth + slack && depth >= allowed.max(0.0) - slack;
    assert!(deep || away <= -allowed + slack, "{text}: {depth} deep, {away} away");
}

#[test]
fn clear_goes_by_allowances() {
    let mut seen = [0; 2];
    everywhere(&TOOLS, |name, facets, owned, draw| {
        for _ in 0..POSES {
            let mut owned =
                Owned { names: owned.names.clone(), allowed: owned.allowed.clone(), ..*owned };
            any_allowed(&mut owned, draw);
            let allowed: Vec<_> =
                owned.names.iter().map(String::as_str).zip(owned.allowed.iter().copied()).collect();
            let mut certifier = allowing(facets, name, &allowed);
            let pose = any_pose(&owned, draw);
            let found = certifier.clear(&pose);
            let text = format!("{name} at {pose:?} with {allowed:?}: {found:?}");
            let over = |draw: &mut Draw| {
                let samples = owned.samples(&pose, draw);
                owned.most(&pose, &samples, |p| owned.over(p), draw).map_or(0.0, |best| best.value)
            };
            match found {
                Clear::Clear | Clear::Inside(_) | Clear::SurfaceOnly => {
                    let over = over(draw);
                    assert!(over <= 4.0 * rounding(&owned), "{text}: {over}");
                    seen[0] += 1;
                }
                Clear::Touching(witness) => {
                    holds(&owned, &pose, &witness, &text);
                    seen[1] += 1;
                }
                Clear::Undecided(high) => {
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
    everywhere(&TOOLS, |name, facets, owned, draw| {
        for k in 0..WAYS {
            let mut owned =
                Owned { names: owned.names.clone(), allowed: owned.allowed.clone(), ..*owned };
            any_allowed(&mut owned, draw);
            let allowed: Vec<_> =
                owned.names.iter().map(String::as_str).zip(owned.allowed.iter().copied()).collect();
            let mut certifier = allowing(facets, name, &allowed).budget(1 << 17);
            let way = ways::way(owned.brute, ways::KINDS[(5 * k) % ways::KINDS.len()], draw);
            let motion = Motion::new(&way.from, &way.to).expect("one way");
            let tolerance = [0.0, 1e-3][k % 2];
            let found = certifier.sweep_clear(&motion, tolerance);
            let text = format!("{name} on {way:?} with {allowed:?}, {tolerance:e}: {found:?}");
            let until = match found {
                Sweep::Touching(at, witness) => {
                    holds(&owned, &motion.pose(at), &witness, &text);
                    seen[1] += 1;
                    continue;
                }
                Sweep::Undecided(at) => {
                    seen[2] += 1;
                    at
                }
                Sweep::Clear | Sweep::Inside(_) | Sweep::SurfaceOnly => {
                    seen[0] += 1;
                    1.0
                }
            };
            let rounding = rounding(&owned) + 64.0 * f64::EPSILON * motion.way().norm();
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
    // The flute is from 0 to 26 and 6 thick; the shank above is as thick.
    let beside = pose([0.0; 3], UP);
    for (top, clear) in [(25.0, true), (25.5, true), (26.0 + 1e-3, false), (40.0, false)] {
        let wall = block([4.0, -30.0, 5.0], [40.0, 30.0, top]);
        let facets = Facets::new(&wall);
        let mut certifier = allowing(&facets, "Flat", &[("flute", f64::INFINITY)]);
        let found = certifier.clear(&beside);
        let still = certifier.sweep_clear(&Motion::new(&beside, &beside).expect("one way"), 0.0);
        if clear {
            assert_eq!((found, still), (Clear::Clear, Sweep::Clear), "{top}");
        } else {
            let Clear::Touching(witness) = found else { panic!("{top}: {found:?}") };
            assert_eq!(names(tool("Flat"))[witness.surface], "shank", "{top}");
            assert!(matches!(still, Sweep::Touching(..)), "{top}: {still:?}");
        }
    }
    let wall = block([4.0, -30.0, 5.0], [40.0, 30.0, 20.0]);
    let facets = Facets::new(&wall);
    for (allowed, clear) in [(2.0 + 1e-9, true), (2.0 - 1e-9, false), (0.0, false)] {
        let mut certifier = allowing(&facets, "Flat", &[("flute", allowed)]);
        assert_eq!(certifier.clear(&beside) == Clear::Clear, clear, "{allowed}");
        // Along the wall it stays as deep.
        let found = certifier.sweep_clear(&along_the_wall(), 0.02);
        assert_eq!(found == Sweep::Clear, allowed > 1.0, "{allowed}: {found:?}");
    }
}

/// The flute stays 2 mm in a wall at x = 4.
fn along_the_wall() -> Motion {
    Motion::new(&pose([0.0, -10.0, 0.0], UP), &pose([0.0, 10.0, 0.0], UP)).expect("one way")
}

#[test]
fn a_flute_cuts_along_a_wall() {
    let wall = block([4.0, -30.0, 5.0], [40.0, 30.0, 20.0]);
    let facets = Facets::new(&wall);
    for allowed in [2.01, 3.0, f64::INFINITY] {
        for tolerance in [0.0, 1e-6, 1e-3] {
            let mut certifier = allowing(&facets, "Flat", &[("flute", allowed)]);
            let found = certifier.sweep_clear(&along_the_wall(), tolerance);
            assert_eq!(found, Sweep::Clear, "{allowed} {tolerance:e}");
        }
    }
}

/// A part that is so far from the nut.
type Case = (&'static str, fn(f64) -> Mesh);

#[test]
fn a_nut_keeps_its_margin_from_all_sides() {
    // The nut's ring is at 30, its cone from 12.9 to 14, its side at 14 until 47.5.
    let diagonal = std::f64::consts::FRAC_1_SQRT_2;
    let cases: [Case; 4] = [
        ("ring", |gap| block([7.0, -1.0, 20.0], [9.0, 1.0, 30.0 - gap])),
        ("side", |gap| block([14.0 + gap, -9.0, 35.0], [30.0, 9.0, 40.0])),
        ("end", |gap| block([-9.0, -9.0, 47.5 + gap], [9.0, 9.0, 60.0])),
        ("past the ring", |gap| block([7.0, -1.0, 20.0], [40.0, 1.0, 30.0 - gap])),
    ];
    for (case, part) in cases {
        for (gap, clear) in [(0.4, false), (0.5 - 1e-9, false), (0.5 + 1e-9, true), (0.6, true)] {
            let facets = Facets::new(&part(gap));
            let mut certifier = allowing(&facets, "BallEr16", &[("nut.nut", -0.5)]);
            let here = pose([0.0; 3], UP);
            let found = certifier.clear(&here);
            let turned = Motion::new(&pose([0.0; 3], UP), &here).expect("one way");
            let still = certifier.sweep_clear(&turned, 0.0);
            if clear {
                assert_eq!((found, still), (Clear::Clear, Sweep::Clear), "{case} {gap}");
            } else {
                let Clear::Touching(witness) = found else { panic!("{case} {gap}: {found:?}") };
                assert_eq!(names(tool("BallEr16"))[witness.surface], "nut.nut");
                assert!(matches!(still, Sweep::Touching(..)), "{case} {gap}: {still:?}");
            }
            // Down from afar to there.
            let lift = if case == "end" { -30.0 } else { 3.0 };
            let down = Motion::new(&pose([0.0, 0.0, lift], UP), &here).expect("one way");
            let down = certifier.sweep_clear(&down, 0.0);
            if case != "side" {
                assert_eq!(down == Sweep::Clear, clear, "{case} {gap}: {down:?}");
            }
        }
    }
    // A corner of a part beside the cone, by the diagonal.
    for (gap, clear) in [(0.4, false), (0.6, true)] {
        let at = [13.45 + gap * diagonal, 0.0, 30.55 - gap * diagonal];
        let facets = Facets::new(&block([at[0], -1.0, 20.0], [at[0] + 5.0, 1.0, at[2]]));
        let mut certifier = allowing(&facets, "BallEr16", &[("nut.nut", -0.5)]);
        assert_eq!(certifier.clear(&pose([0.0; 3], UP)) == Clear::Clear, clear, "{gap}");
    }
}

#[test]
fn a_level_face_alone_keeps_its_margin() {
    let facets = Facets::new(&plate());
    for (tip, clear) in [(0.4, false), (0.6, true), (0.5 + 1e-9, true), (0.5 - 1e-9, false)] {
        let mut certifier = allowing(&facets, "Flat", &[("face", -0.5)]);
        let here = pose([1.0, 2.0, tip], UP);
        let found = certifier.clear(&here);
        assert_eq!(found == Clear::Clear, clear, "{tip}: {found:?}");
        for from in [[-60.0, 2.0, tip], [1.0, 2.0, 30.0]] {
            let way = Motion::new(&pose(from, UP), &here).expect("one way");
            let found = certifier.sweep_clear(&way, 0.0);
            assert_eq!(found == Sweep::Clear, clear, "{tip}: {found:?}");
        }
        // From the inside of the tool: a part in its middle, with the flute allowed.
        let inside = Facets::new(&block([-1.0, -1.0, tip], [1.0, 1.0, 5.0]));
        let allowed = [("face", -0.5), ("flute", f64::INFINITY), ("shank", f64::INFINITY)];
        let mut certifier = allowing(&inside, "Flat", &allowed);
        // What the face is nearest to may not be inside at all.
        let found = certifier.clear(&pose([0.0; 3], UP));
        assert!(matches!(found, Clear::Touching(_)), "{tip}: {found:?}");
        let above = Facets::new(&block([5.8, -0.1, tip], [5.9, 0.1, 5.0]));
        let mut certifier = allowing(&above, "Flat", &allowed);
        let found = certifier.clear(&pose([0.0; 3], UP));
        assert_eq!(matches!(found, Clear::Clear | Clear::SurfaceOnly), clear, "{tip}: {found:?}");
        let way = Motion::new(&pose([0.0; 3], UP), &pose([0.0; 3], UP)).expect("one way");
        let found = certifier.sweep_clear(&way, 0.0);
        assert_eq!(found == Sweep::Clear, clear, "{tip}: {found:?}");
    }
}

#[test]
fn all_surfaces_may_be_in_a_part_or_have_to_keep_off_it() {
    let facets = Facets::new(&plate());
    let deep = pose([0.0, 0.0, -5.0], UP);
    let all = |allowed: f64| names(tool("Flat")).into_iter().map(move |name| (name, allowed));
    for (allowed, clear) in [(f64::INFINITY, true), (5.1, true), (4.9, false), (-1.0, false)] {
        let of: Vec<_> = all(allowed).collect();
        let of: Vec<_> = of.iter().map(|(name, allowed)| (name.as_str(), *allowed)).collect();
        let mut certifier = allowing(&facets, "Flat", &of);
        let found = certifier.clear(&deep);
        assert_eq!(matches!(found, Clear::Touching(_)), !clear, "{allowed}: {found:?}");
        let high = certifier.clear(&pose([0.0, 0.0, 1.0 + 1e-6], UP));
        assert_eq!(high, Clear::Clear, "{allowed}");
        let way = Motion::new(&deep, &pose([3.0, 0.0, -5.0], UP)).expect("one way");
        let found = certifier.sweep_clear(&way, 0.0);
        assert_eq!(matches!(found, Sweep::Touching(..)), !clear, "{allowed}: {found:?}");
    }
}

#[test]
fn allowances_that_mean_nothing_are_refused() {
    let facets = Facets::new(&plate());
    let refused = |surface: &str, allowed: f64| {
        let certifier = Certifier::new(&facets, tool("Flat")).expect("a profile");
        certifier.allow(surface, allowed).err().expect("no allowance")
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

/// The corner that the neck shares with what is below it owns places of the flute's heights, but not the
/// flute: what touches that does not touch the neck.
#[test]
fn the_neck_is_not_touched_where_the_flute_is() {
    for off in -40..=40 {
        let wall = block([8.25 + f64::from(off) * 1e-13, -20.0, 0.5], [30.0, 20.0, 2.5]);
        let facets = Facets::new(&wall);
        let mut certifier = allowing(&facets, "Woodruff", &[("flute", 0.01)]);
        let clear = certifier.clear(&pose([0.0; 3], UP));
        assert!(matches!(clear, Clear::Clear), "{off}: {clear:?}");
    }
}
