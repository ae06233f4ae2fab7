//! What may not be in the part and is wholly inside it, where no triangle shows it.

use super::{pose, tool};
use nalgebra::{Point3, Vector3};
use tools_library::TOOLS;
use touchoff::certify::{Certifier, Clear, Facets, Sweep};
use touchoff::mesh::shapes;
use touchoff::{Motion, Pose, Tool, Unit};
use touchoff_tests::oracle::draw::Draw;
use touchoff_tests::oracle::{Nearest, Oracle};

/// A cube that any tool of the library fits into, in its middle.
fn solid() -> Facets {
    let half = 2000.0;
    let cube = shapes::cuboid(Point3::from([-half; 3]), Point3::from([half; 3]), Unit::Millimetre);
    Facets::new(&cube.expect("a cuboid"))
}

/// A certifier to which only some surfaces matter; all others may be as deep as they will.
fn restricted<'a>(
    facets: &'a Facets,
    tool: &'static dyn Tool,
    limit: impl Fn(usize) -> Option<f64>,
) -> Option<Certifier<'a>> {
    let mut certifier = Certifier::new(facets, tool).ok()?;
    for (index, surface) in tool.card().surfaces.iter().enumerate() {
        let allowed = limit(index).unwrap_or(f64::INFINITY);
        certifier = certifier.allow(&surface.name, allowed).ok()?;
    }
    Some(certifier)
}

/// Every surface of every tool by itself, in the middle of a solid: at a pose and on a motion.
#[test]
fn every_surface_of_every_tool_is_found_inside() {
    let facets = solid();
    let full = |tip: [f64; 3], turn| Pose::from_quaternion(tip.into(), turn).expect("a quaternion");
    let at = full([1.3, -2.7, 5.1], [0.36, 0.48, 0.0, 0.8]);
    let motion = Motion::with_spin(&at, &full([9.0, 4.0, -3.0], [0.6, 0.0, 0.0, 0.8]));
    let motion = motion.expect("less than half a turn");
    let mut asked = 0;
    for tool in TOOLS {
        for (index, surface) in tool.card().surfaces.iter().enumerate() {
            let only = |other: usize| (other == index).then_some(0.0);
            let Some(mut certifier) = restricted(&facets, *tool, only) else { continue };
            let (name, surface) = (&tool.card().name, &surface.name);
            assert_eq!(certifier.clear(&at), Clear::Inside(index), "{name}/{surface}");
            asked += 1;
            let swept = certifier.sweep_clear(&motion, 1e-6);
            assert_eq!(swept, Sweep::Inside(index), "{name}/{surface}");
        }
    }
    assert!(asked > 100, "{asked}");
}

#[test]
fn any_surfaces_of_any_tool_are_found_inside() {
    let facets = solid();
    let mut draw = Draw::new(7);
    for tool in TOOLS {
        let count = tool.card().surfaces.len();
        for _ in 0..8 {
            let bits = draw.bits();
            let only = |other: usize| (bits >> (other % 64) & 1 == 1).then_some(0.0);
            let Some(mut certifier) = restricted(&facets, *tool, only) else { continue };
            let any = (0..count).any(|index| only(index).is_some());
            let at = Pose::from_axis(Point3::from([3.0; 3]), Vector3::from(draw.direction()));
            let found = certifier.clear(&at.expect("an axis"));
            match found {
                Clear::Inside(surface) => assert!(only(surface).is_some(), "{}", tool.card().name),
                other => assert!(!any && other == Clear::Clear, "{}: {other:?}", tool.card().name),
            }
        }
    }
}

/// With any limits, at any height: where a sample of the tool's section that may not be in the part is in
/// it, the tool is not clear; and a tool that is inside has such a sample, unless they are few.
#[test]
fn samples_of_the_section_agree_with_what_is_inside() {
    const SAMPLES: usize = 20_000;
    let half = 2000.0;
    let (low, high) = (Point3::from([-half, -half, -half]), Point3::from([half, half, 0.0]));
    let facets = Facets::new(&shapes::cuboid(low, high, Unit::Millimetre).expect("a cuboid"));
    let (mut inside, mut clear) = (0, 0);
    for name in ["Barrel", "BullNose", "TSlot", "BallEr16", "Lollipop", "TaperedBall"] {
        let (tool, oracle) = (tool(name), Nearest::of(name));
        let length = tool.card().unit.to(Unit::Millimetre);
        let surfaces: Vec<&str> = tool.card().surfaces.iter().map(|s| &*s.name).collect();
        let [radius, height] = oracle.extent();
        let mut draw = Draw::new(11);
        // Of each sample: where, how deep, and the surface that is the nearest.
        let samples: Vec<([f64; 2], f64, usize)> = (0..SAMPLES)
            .filter_map(|_| {
                let at = [draw.between(0.0, radius), draw.between(0.0, height)];
                let sense = oracle.sense([at[0], 0.0, at[1]])?;
                let away = |surface: &str| oracle.away(surface, [at[0], 0.0, at[1]]);
                let nearest = (0..surfaces.len())
                    .min_by(|a, b| away(surfaces[*a]).total_cmp(&away(surfaces[*b])))?;
                Some((at, sense.depth, nearest))
            })
            .collect();
        for _ in 0..60 {
            let limits: Vec<Option<f64>> = surfaces
                .iter()
                .map(|_| match draw.bits() % 3 {
                    0 => None,
                    1 => Some(0.0),
                    _ => Some(radius * length * draw.between(0.0, 0.9)),
                })
                .collect();
            let Some(mut certifier) = restricted(&facets, tool, |index| limits[index]) else {
                panic!("{name} has a profile");
            };
            // Upright, or upside down: the material is below a height of the tool, or above.
            let (up, cut) = (draw.bits().is_multiple_of(2), draw.between(-0.1, 1.1) * height);
            let axis = [0.0, 0.0, if up { 1.0 } else { -1.0 }];
            let tip = [0.1, 0.2, if up { -cut } else { cut } * length];
            let found = certifier.clear(&pose(tip, axis));
            let margin = 1e-6 * radius;
            let forbidden = samples.iter().filter(|([_, z], depth, surface)| {
                let below = if up { cut - z } else { z - cut };
                limits[*surface].is_some_and(|limit| *depth > limit / length + margin)
                    && below > margin
            });
            let forbidden = forbidden.count();
            match found {
                Clear::Clear => {
                    clear += 1;
                    assert_eq!(forbidden, 0, "{name} {limits:?} {cut} {up}");
                }
                Clear::Inside(surface) => {
                    inside += 1;
                    assert!(limits[surface].is_some(), "{name}");
                }
                Clear::Touching(_) => {}
                other => panic!("{name}: {other:?} {limits:?} {cut} {up}"),
            }
        }
    }
    assert!(inside > 30 && clear > 60, "{inside} inside, {clear} clear");
}
