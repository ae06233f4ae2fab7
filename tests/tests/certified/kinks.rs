//! Profiles of which some segments are nearly in line, as CAD draws balls by chords and as tapers are: the depth of each surface,
//! and verdicts with allowances and margins, against samples of the triangles.
//!
//! `KINKS=2500 cargo test --release -p touchoff-tests --test certified kinks -- --nocapture` examines 12,500 tools.

use crate::allowances::sampled::SurfaceAllowances;
use crate::pair::{CLEAR, IN_CONTACT, NEAR, QUERIED, UNDECIDED, WIDER};
use crate::prelude::*;
use std::fmt::Write;
use touchoff::tool::{
    Circle, Derivatives, EnvelopeSlab, Evaluations, Outputs, PointBatch, ProfileSegment, Surface,
    ToolInfo,
};
use touchoff_tests::oracle::restated::Restated;

/// A tool of which nothing but the profile is known, which is all that the certifier asks for: the compiler divides profiles
/// into regions, and refuses some of these.
struct Outlined(ToolInfo);

impl Outlined {
    fn new(tool: &Restated) -> Outlined {
        let mut info = drawn("0 0; side 1 0; side 0 1", "").info().clone();
        info.name = tool.text(|number| number.to_f64().to_string()).into();
        let mut names = tool.surfaces.clone();
        names.dedup();
        let surface = |name: &str| names.iter().position(|known| *known == name).expect("it");
        let oracle = Nearest::new(tool);
        let segments = oracle.profile().segments().iter().zip(&tool.surfaces);
        let outline: Vec<_> = segments
            .map(|(segment, name)| ProfileSegment {
                from: segment.from,
                to: segment.to,
                circle: segment.circle.map(|circle| Circle {
                    centre: circle.centre,
                    radius: circle.radius,
                    convex: circle.convex,
                }),
                surface: SurfaceId(surface(name)),
            })
            .collect();
        let [[_, low], [radius, high]] = oracle.profile().extent();
        info.envelope = vec![EnvelopeSlab::new(low, high, radius)].into();
        let named = |name: &&'static str| Surface { name: (*name).into(), cutting: false };
        info.surfaces = names.iter().map(named).collect::<Vec<_>>().into();
        info.outline = outline.into();
        Outlined(info)
    }
}

impl Tool for Outlined {
    fn info(&self) -> &ToolInfo {
        &self.0
    }
    fn evaluate(&self, _: Level, _: Outputs, _: &PointBatch, _: f64, _: &mut Evaluations) {
        unreachable!("the profile is known")
    }
    fn derivatives(&self, _: [f64; 3], _: f64, _: &mut Evaluations) -> Derivatives {
        unreachable!("the profile is known")
    }
}

/// Returns the tool of a drawing.
fn restated(drawing: String) -> Restated {
    Restated::drawn("Drawn", drawing.leak(), &[])
}

/// A flute and a body above it that turns in or out by an angle.
fn tapered(rng: &mut Rng) -> Restated {
    let (radius, flute) = (rng.power(0.0, 1.5), rng.between(2.0, 20.0));
    let height = rng.between(5.0, 40.0);
    let shift = height * rng.power(-6.0, -2.0) * rng.pick(&[1.0, -1.0]);
    let (top, out) = (flute + height, radius + shift.max(-0.5 * radius));
    restated(format!("0 0; face {radius} 0; flute {radius} {flute}; body {out} {top}, 0 {top}"))
}

/// The same with a groove in its end, so that the profile overhangs.
fn grooved(rng: &mut Rng) -> Restated {
    let shift = 7.0 * rng.power(-6.0, -2.0) * rng.pick(&[1.0, -1.0]);
    let (low, out) = (rng.between(1.0, 5.0), 20.0 + shift);
    let floor = rng.between(1.0, 6.0);
    restated(format!(
        "0 0; face 20 0; rim 20 {low}, {out} 10; top 12 10, 12 {floor}, 6 {floor}, 6 10, 0 10"
    ))
}

/// Chords of a quarter of a circle, rounded as in a file, below a shank.
fn chords(rng: &mut Rng) -> Restated {
    let (radius, count) = (rng.power(-0.3, 1.3), 6 + rng.index(19));
    let mut drawing = "0 0; ball ".to_owned();
    for k in 1..=count {
        let (sin, cos) = (std::f64::consts::FRAC_PI_2 * k as f64 / count as f64).sin_cos();
        let _ = write!(drawing, "{:.4} {:.4}, ", radius * sin, radius * (1.0 - cos));
    }
    let top = 6.0 * radius;
    restated(format!("{}; shank {radius:.4} {top}, 0 {top}", &drawing[..drawing.len() - 2]))
}

/// The corner of a bull nose, or a ball, that meets its flute and its face nearly in line.
fn rounded(rng: &mut Rng) -> Restated {
    let (radius, flat) = (rng.power(-0.3, 1.0), rng.pick(&[0.0, 0.3, 2.0, 10.0]));
    let height = rng.between(0.2, 3.0) * radius;
    let mut turn = || rng.power(-5.0, -2.0) * rng.pick(&[1.0, -1.0]);
    let (shift, rise) = (height * turn(), flat * turn());
    let face = if flat > 0.0 { format!("face {flat} 0; ") } else { String::new() };
    let (d, top) = (flat + radius, radius + height);
    restated(format!(
        "0 {rise}; {face}corner {d} {radius} about {flat} {radius}; flute {} {top}; top 0 {top}",
        d + shift
    ))
}

/// A tip of some hundredths below a shank of 20.
fn tiny(rng: &mut Rng) -> Restated {
    let (tip, out) = (rng.power(-3.0, -1.0), rng.power(-6.0, -2.0));
    let (low, high) = (10.0 * tip, rng.between(5.0, 20.0));
    let neck = tip + out * high;
    restated(format!(
        "0 0; tip {tip} 0; side {tip} {low}, {neck} {high}; shank 20 {high}, 20 60, 0 60"
    ))
}

/// Compares depths and verdicts with samples of a few triangles near a corner of the profile.
fn compare(tool: &Restated, rng: &mut Rng, tally: &mut Tally) {
    let (outlined, oracle) = (Outlined::new(tool), Nearest::new(tool));
    let [_, [far, top]] = oracle.profile().extent();
    let (size, corners) = (far.max(top), oracle.profile().corners());
    for _ in 0..3 {
        let [d, z] = rng.pick(&corners);
        let reach = size * rng.power(-3.0, 0.0);
        let near: [f64; 3] = [d * 0.6, d * 0.8, z];
        let triangles: Vec<[[f64; 3]; 3]> = (0..2)
            .map(|_| {
                let middle = Vector3::from(near) + Vector3::from(rng.direction()) * (0.3 * reach);
                [0; 3].map(|_| (middle + Vector3::from(rng.direction()) * reach).into())
            })
            .collect();
        let mesh = soup(&triangles);
        let bvh = TriangleBvh::new(&mesh);
        let brute = BruteForce::new(&mesh, &oracle, 1.0);
        let mut owned = SurfaceAllowances::new(&outlined, &bvh, brute);
        (owned.rounding, owned.max_share) = (1e-12 * size, 64);
        owned.check_depths(&mut owned.certifier(), &Pose::default(), 1e-6, tally, rng);
        owned.set_random_allowances(size, rng);
        owned.check_pose(&Pose::default(), tally, rng);
    }
}

/// Compares random tools of some kinds with samples; fails unless more than one query of 100 has each of some verdicts.
fn compare_all(kinds: &[fn(&mut Rng) -> Restated], verdicts: &[&'static str]) {
    let mut rng = Rng::new(70);
    let mut tally = Tally::default();
    for kind in kinds {
        for _ in 0..case_count("KINKS", 8) {
            compare(&kind(&mut rng), &mut rng, &mut tally);
        }
    }
    eprintln!("{tally}");
    assert!(5 * tally.count(IN_CONTACT) > tally.count(QUERIED), "{tally}");
    let is_seen = |kind: &&'static str| 100 * tally.count(kind) > tally.count(QUERIED);
    assert!(verdicts.iter().all(is_seen), "{tally}");
    let undecided = tally.count(WIDER) + tally.count(UNDECIDED);
    assert!(1000 * undecided <= tally.count(QUERIED), "{tally}");
}

#[test]
fn samples_are_within_the_depth_of_surfaces_nearly_in_line() {
    compare_all(&[tapered, grooved, chords, tiny], &[CLEAR, NEAR]);
}

/// Triangles near such a corner are seldom beside it, so that few margins are broken without contact.
#[test]
fn samples_are_within_the_depth_of_corners_nearly_in_line() {
    compare_all(&[rounded], &[CLEAR]);
}

/// The tool point (16, 3) is 3 mm from the face, on a tube's edge: the part is in the way wherever the rim tapers.
#[test]
fn a_face_inside_the_part_is_seen_below_a_tapered_rim() {
    let unlimited = ["rim", "top"].map(|surface| (surface, f64::INFINITY));
    for taper in [0.0, 1e-6, 1e-3, 0.02, 0.3] {
        let top = 20.0 - taper;
        let drawing =
            format!("0 0; face 20 0; rim 20 3, {top} 10; top 12 10, 12 1, 6 1, 6 10, 0 10");
        let tool = Outlined::new(&restated(drawing));
        let part = shapes::tube(15.5, 16.5, 2.0, 96, 1, Unit::Millimetre).expect("a tube");
        let part = TriangleBvh::new(&part);
        let mut certifier = Certifier::new(&part, &tool).expect("a profile");
        certifier = certifier.with_allowances(unlimited).expect("surfaces");
        let low = part.bounds()[0].z;
        let verdict = certifier.check_pose(&pose([0.0, 0.0, low - 1.0], UP));
        assert!(matches!(verdict, PoseVerdict::Touching(_)), "{taper}: {verdict:?}");
        let deep = certifier.check_pose(&pose([0.0, 0.0, low - 3.5], UP));
        assert_ne!(deep, PoseVerdict::Clear, "{taper}");
    }
}

/// A tool 5 mm deep in a block, and its body, which begins 7 mm above it.
#[test]
fn a_body_above_the_part_is_clear_however_little_it_tapers() {
    let block = TriangleBvh::new(&block([-100.0, -100.0, -30.0], [100.0, 100.0, 0.0]));
    for taper in [1e-6, 1e-4, 0.1, 1.0] {
        let drawing = format!("0 0; face 25 0; flute 25 12; body {} 42, 0 42", 25.0 - taper);
        let tool = Outlined::new(&restated(drawing));
        let mut certifier = Certifier::new(&block, &tool).expect("a profile");
        let pose = pose([0.0, 0.0, -5.0], UP);
        let body = certifier.deepest_on(SurfaceId(2), &pose, 1e-9).expect("a surface");
        assert!(body.depth.high < 1e-9 && body.witness.is_none(), "{taper}: {body:?}");
    }
}

/// Beside the acute edge of a dovetail the normal at the nearest point leads to the part.
#[test]
fn a_normal_at_an_acute_edge_leads_to_the_nearest_point() {
    let tool = drawn("0 0; face 8 0; flank 3 6; shank 3 30, 0 30", "");
    let mut rng = Rng::new(3);
    for _ in 0..200 {
        let [angle, away] = [rng.between(-1.2, 1.2), rng.power(-3.0, 0.7)];
        let near = [8.0 + away * angle.cos(), 0.0, away * angle.sin()];
        let part = [near, [near[0] + 0.5, 0.3, near[2]], [near[0] + 0.5, -0.3, near[2]]];
        let bvh = TriangleBvh::new(&soup(&[part]));
        let mut certifier = Certifier::new(&bvh, &tool).expect("a profile");
        let found = certifier.clearance(&pose([0.0; 3], UP), 1e-9);
        let [point, on_tool] = [found.witness.map(|w| w.point), found.on_tool.map(|t| t.point)]
            .map(|point: Option<Point3<f64>>| point.expect("a point"));
        let normal = found.on_tool.expect("a point").normal;
        let toward = (point - on_tool).normalize();
        assert!((normal - toward).norm() < 1e-6, "{near:?}: {normal:?} {toward:?}");
    }
}

/// Face, flute and a body that leans in by 0.007 are equally far from the deepest point of the flute: by 40 digits, 2.3597058363740087.
#[test]
fn the_end_of_a_border_between_surfaces_nearly_in_line_is_found() {
    let (corner, top) = ([30.817795231848585, 2.368075659712592], 17.86171960321537);
    let tool = restated(format!(
        "0 0; face {} 0; flute {} {}; body 30.707882638339523 {top}, 0 {top}",
        corner[0], corner[0], corner[1]
    ));
    let outlined = Outlined::new(&tool);
    let mesh = soup(&[[
        [21.42478669762714, 21.897397303809065, -6.055441337304873],
        [14.030211187872261, 18.811988592927168, 0.07516972074849951],
        [15.147346530050466, 25.066581440050808, 5.067254492190802],
    ]]);
    let mut certifier = certifier_of(&mesh, &outlined);
    for tolerance in [0.0, 1e-6] {
        let flute = certifier.deepest_on(SurfaceId(1), &Pose::default(), tolerance);
        let depth = flute.expect("a surface").depth;
        assert_contains(depth, 2.3597058363740087, tolerance + 1e-11, tolerance);
    }
}
