//! Profiles that are wrong, or nearly: each gives an exact result or an error at its place.

use super::compare::compare;
use super::outline::Outline;
use super::tool;
use std::f64::consts::{FRAC_PI_2, PI};
use std::panic::{AssertUnwindSafe, catch_unwind};
use touchoff::Level;
use touchoff::tool::{Interpreted, Tool};
use touchoff_dsl::source::Source;
use touchoff_tests::checks::assert_near;
use touchoff_tests::evaluations::evaluate_points;
use touchoff_tests::oracle::profile::Profile;
use touchoff_tests::oracle::rng::Rng;
use touchoff_tests::oracle::segment::Segment;
use touchoff_tests::oracle::vector::{norm, sub};
use touchoff_tests::texts::{assert_mistakes, said};

fn text(profile: &str) -> String {
    format!("tool T {{ units mm; profile {{ start {profile} }} }}")
}

/// A profile a line, its message, and the beginning of its place; without a message it is good.
const MISTAKES: &str = "\
(0, 0); line to (3, 0), (3, 20) as a; line to (2, 30) as b; => ends at (2, 30), not on the axis => line to (2, 30)
(1, 0); line to (3, 0), (3, 20), (0, 20) as a; => starts at (1, 0), not on the axis => (1, 0)
(0, 20); line to (3, 20), (3, 0), (0, 0) as a; => runs clockwise => (3, 20)
(0, 0); line to (4, 0), (1, 5), (4, 5), (1, 1), (0, 9) as a; => crosses another one at (2.33333, 2.77778) => (1, 1)
(0, 0); line to (10, 0) as a; arc to (10, 10) center (10, 5) as b; line to (20, 5), (20, 12), (0, 12) as c; => crosses another one at (14, 8) => (20, 5)
(0, 0); line to (10, 0) as a; arc to (10, 10) center (10, 5) as b; arc to (19, 3) center (18, 11) as c; line to (30, 3), (30, 20), (0, 20) as d; => crosses another one at (14.8, 3.6) => arc to (19, 3)
(0, 0); line to (4, 0), (4, 5), (2, 5), (2, 0), (1, 0), (1, 9), (0, 9) as a; => touches another one at (2, 0) => (2, 0)
(0, 0); line to (4, 0), (4, 2), (3, 2), (4, 1), (5, 6), (0, 6) as a; => touches another one at (4, 1) => (4, 1)
(0, 0); line to (3, 0), (3, 5) as a; arc to (3, 9) radius 3 concave as b; line to (0, 9) as c; line to (0.5, 7) as d; line to (0, 9) as e; => this segment => line to (0, 9)
(0, 0); line to (3, 0), (3, 0), (3, 5), (0, 5) as a; => has zero length => (3, 0)
(0, 0); arc to (0, 0) radius 3 as a; line to (3, 5), (0, 5) as a; => has zero length => arc to (0, 0)
(0, 0); line to (3, 0) as a; arc to (3, 0) center (2, 0) as b; line to (3, 5), (0, 5) as c; => has zero length => arc to (3, 0)
(0, 0); line to (2, 0), (2, 4), (1, 2), (2, 4), (2, 9), (0, 9) as a; => turns straight back at (1, 2) => (2, 4)
(0, 0); line to (2, 0), (0, 0) as a; => runs clockwise => (2, 0)
(0, 0); line to (3, 0), (3, 5), (3.000000000005, 9), (0, 9) as a; => turns by less than 1e-9 rad at (3, 5) => (3.000000000005, 9)
(0, 0); line to (0, 2), (3, 2), (3, 5), (0, 5) as a; => lies on the axis => (0, 2)
(0, 0); line to (3, 0), (3, 5), (3.0000000005, 9), (0, 9) as a; => turns by less than 1e-9 rad at (3, 5) => (3.0000000005, 9)
(0, 0); line to (3, 0), (3, 5), (0, 5) as a; line to (0, 9) as b; => lies on the axis => line to (0, 9)
(0, 0); line to (3, 0), (0, 4), (3, 8), (0, 8) as a; => axis => (
(0, 0); line to (3, 0) as a; arc to (3, 6) center (4, 3) concave as b; line to (-1, 8), (0, 9) as c; => crosses the axis => (-1, 8)
(0, 0); line to (3, 0) as a; arc to (3, 8) radius 4.5 concave as b; line to (0, 8) as c;
(0, 0); line to (3, 0) as a; arc to (3, 8) center (3, 4) concave as b; line to (0, 8) as c; => crosses the axis => arc to (3, 8)
(0, 0); line to (2, 0) as a; arc to (2, 8) center (5, 4) concave as b; line to (0, 8) as c; => axis => arc to (2, 8)
(0, 0); line to (3, 0), (5, 0), (4, 0), (4, 5), (0, 5) as a; => turns straight back at (5, 0) => (4, 0)
(0, 0); line to (3, 0), (3, 5), (3, 3), (0, 3) as a; => turns straight back at (3, 5) => (3, 3)
(0, 0); arc to (3, 3) center (0, 3.02) as a; line to (0, 3) as b; => the arc starts 3.02 from its centre but ends  => arc to
(0, 0); line to (3, 0) as a; arc to (3, 5) radius 2 as b; line to (0, 5) as c; => a radius of 2 is too small: the end points are 5 apart => arc to
(0, 0); line to (3, 0) as a; arc to (3, 5) radius -4 as b; line to (0, 5) as c; => the radius of an arc must be greater than 0 => -4
(0, 0); line to (3, 0) as a; arc to (3, 5) center (5, 2.5) as b; line to (0, 5) as c; => this arc is not marked `concave`, but its centre (5, 2.5) => arc to
(0, 0); line to (3, 0) as a; arc to (3, 5) center (1, 2.5) concave as b; line to (0, 5) as c; => this arc is marked `concave` => concave
(0, 0); line to (3, 0) as a cutting; line to (3, 5), (0, 5) as a; => `a` is  => a
(0, 0); line to (3, 0), (3, 5), (0, 5) as cutting; => cutting => cutting
(0, 1); line to (3, 1), (3, 5), (0, 5) as a; => the tool ends at z = 1, but `tip` is at z = 0
(0, 0); line to (3, 0, 1), (3, 5), (0, 5) as a; => two numbers => (3, 0, 1)
(0, 0); line to (3, 0), (3, sqrt(-1)), (0, 5) as a; => square root";

#[test]
fn each_mistake_is_shown_at_its_segment() {
    assert_mistakes(MISTAKES, text);
}

/// Dishes at the axis, and collinear and tangent joints, are exact; a sphere is one arc. So are points where three curves meet of
/// which rounding makes what no point has: vertices, also on another segment's line, centres of arcs, where circles and lines come
/// back, on the axis and outside, and where three features are equally near. So are lines on which the circle of an arc touches the
/// line of another segment, and two points that no border separates.
#[test]
fn odd_profiles_are_exact() {
    let sphere = Segment::about([0.0, 0.0], [0.0, 6.0], [0.0, 3.0], true);
    let others = [
        "0 0, 1 0, 1 5, 0 4",
        "0 1, 1 0, 1 5, 0 5",
        "0 0, 1 0, 1 5, 0 4.5 about 0 5.75",
        "0 0, 1 0, 2 0, 2 1, 2 3, 1 3, 0 3",
        "0 0, 3 1 about 0 5, 4 2 about 0 5, 5 5 about 0 5, 5 8, 0 8",
        "0 0, 18.785 0, 18.785 23.48125, 9.11625 28.45375, 9.11625 54.6975 about -15.412883374927862 41.575625,
        9.11625 71.825 about 9.11625 63.26125, 3.8675000000000006 56.355000000000004, 0 56.355000000000004",
        "0 0, 0.00050625 0.009365624999999999, 0.00050625 0.015946875 radius 0.0161240625, 0.00050625 0.01879453125,
        0 0.01930078125 about 0 0.01879453125",
        "0 0, 4 3, 7 3, 5 5, 4 7 about 2.5 5, 4 9, 0 10",
        "0 0, 3 1 about 0 5, 3 7, 4 8, 4 9, 0 9",
        "0 0, 1 5, 2 6, 5 9 about 2 9, 1 9 about 3 3, 4 12, 0 16 about 0 12",
        "0 0, 0.7 1.4, 0.7 4.2 about 4.9 2.8, 3.5 7 about 0.7 7, 2.1 8.4 about 2.1 7, 4.9 11.2, 0 11.9",
        "0 0, 1.4 0.7, 2.8 2.1, 2.8 2.8 about 2.8 2.45, 2.8 4.2, 2.1 8.4 about 2.45 6.3, 0 8.4",
        "0 0, 4 2, 4 4.5, 5 5.5, 4 6.5 about 5 6.5, 4 14.5, 0 14.5",
        "0 0, 0.5 0, 0.5 0.5, 0.5 1 about 1 0.75, 2.5 3, 0.5 5, 2 5, 0.5 6, 1.5 7 about 0.5 7, 0 8",
        "0 0, 1.5 1.5, 1.5 1.75, 11 11.25 about 1.5 11.25, 11 13.5, 10.25 13.5, 10.25 17.5, 1.5 26.25, 0 26.75",
        "0 0, 4 10, 1 13 about 4 13, 6 15 about 3.5 14, 0 16",
        "0 0, 2 12, 5 16 about 3.5 14, 5 14 about 4 15, 0 14",
        "0 0, 5 0, 5 11, 8 11 hollow radius 1.5, 5 13 about 6.5 12, 0 13",
        "0 0, 0.8 0.4 radius 1, 1.000000000001 1 radius 1, 0 2",
        "0 0, 1.7 0, 1.7 5.792145219109247, 1.7 8.042145219109248 radius 1.125, 0 8.042145219109248",
        "0 0, 1 0, 1.0005 50, 1.500499999975 50.499995 about 1.500499999975 49.999995, 2.000499999975 50.499995,
        2.000999999975 100.499995, 0 100.499995",
        "0 0, 4 6, 4 7, 9 12 about 4 12, 9 13, 4 19.666667, 4 23.666667, 0 23.666667",
    ];
    let up = others.map(Outline::parse).into_iter().chain([Outline::up(vec![sphere])]);
    up.flat_map(|up| [Outline { down: true, ..up.clone() }, up])
        .for_each(|outline| assert_exact(&outline));
}

/// More than half a ball on a neck, drawn as chords whose ends have a few decimals, as CAD writes them: about the centre, where all
/// chords are nearly equally near, rounding decides which of them own points at all.
#[test]
fn balls_drawn_as_chords_are_exact() {
    let drawn = |radius: f64, chords: u32, decimals: usize, end: f64| {
        let vertex = |k: u32| {
            let angle = (end + FRAC_PI_2) * f64::from(k) / f64::from(chords) - FRAC_PI_2;
            let [d, z] = [radius * angle.cos(), radius + radius * angle.sin()];
            format!("{d:.decimals$} {z:.decimals$}")
        };
        let (d, z) = (radius * end.cos(), radius + radius * end.sin());
        let neck = format!("{d:.decimals$} {}, 0 {}", z + radius, z + radius);
        let chords: Vec<String> = (1..=chords).map(vertex).collect();
        Outline::parse(&format!("0 0, {}, {neck}", chords.join(", ")))
    };
    assert_exact(&drawn(4.0, 77, 5, 0.35 * PI));
    assert_exact(&drawn(6.6, 75, 5, 0.25 * PI));
    assert_exact(&drawn(2.0, 48, 3, 0.4 * PI));
    // In full doubles all borders of 120 chords meet in one point but for rounding. Two neighbours have one, not each two of all.
    for (decimals, end) in [(17, 0.0), (14, 0.0), (12, 0.0), (17, 0.4 * PI)] {
        let ball = drawn(5.0, 120, decimals, end);
        assert_exact(&ball);
        let tool = touchoff_dsl::compile(&Source::new("t.tool", ball.text()));
        let curves = tool.into_tool().expect("as before").model.curves.len();
        assert!(curves < 8 * 120, "{decimals} {end}: {curves}");
    }
}

/// Beside a corner of the tip nothing but the corner is near, and the cell of its end goes on there under a wide flange.
#[test]
fn tips_under_flanges_are_exact() {
    for vertices in [
        "0 0, 1 0, 0.988 0.31, 0.96 1, 20 1, 20 30, 0 30",
        "0 0, 1 0, 0.9982 0.2144, 0.99 0.86, 4.95 0.86, 4.95 1.177, 24.75 1.177, 24.75 496.507, 0 496.507",
    ] {
        assert_exact(&Outline::parse(vertices));
    }
}

fn assert_exact(outline: &Outline) {
    let text = outline.text();
    let tool = tool(&text).unwrap_or_else(|said| panic!("{text}\n{said}"));
    let planned = Interpreted::parse(&Source::new("t.tool", &text)).expect("as before");
    let compared = compare(outline, (&tool, &planned), 2_000, &mut Rng::new(41));
    compared.unwrap_or_else(|flaw| panic!("{flaw:?}\n{text}"));
}

/// The line of a nearly straight arc comes back far away, where nothing is.
#[test]
fn nothing_is_inside_far_away() {
    let vertices = [
        "0 0, 4 -1, 3 0 hollow radius 707107.4882933288, 0 2 radius 5.4083269131959835",
        "0 0, 4.000000000000025 2, 0 3 about 500002.49999974994 2000004.4999990126",
        "0 0, 2 1 hollow radius 1118035.1067838836, 0 3.000000000000039 radius 2.1213203435596633",
        "0 0, 0.46 0.4, 0.8693415177384363 0.7592634366343137 about 0.44031081460131627 0.8352654142109466,
        1.6872381108635173 1.5582111047988931, 1.0067450892331866 1.6557449996199325,
        0.9314020953099618 2.761804042071062 about 110606.87331732265 7536.508166749152, 0.9314020953099618 4.418170491416046,
        0 4.543771945752921",
    ];
    for outline in vertices.map(Outline::parse) {
        let text = outline.text();
        assert_eq!(refused_or_exact(&outline), None, "{text}");
        let mut points = Vec::new();
        for segment in outline.segments() {
            let along = sub(&segment.to, &segment.from);
            let along = along.map(|part| part / norm(&along));
            for (direction, end) in [along, [-along[1], along[0]]]
                .into_iter()
                .flat_map(|direction| [(direction, segment.from), (direction, segment.to)])
            {
                points.extend((3..48).flat_map(|power| {
                    let distance = 2f64.powi(power);
                    [distance, -distance].map(|distance| {
                        let [d, z] = [0, 1].map(|k| end[k] + distance * direction[k]);
                        [d.abs(), 0.0, z - outline.tip()]
                    })
                }));
            }
        }
        // All other points are beyond the solid.
        points.retain(|[d, _, z]| *d > 5.0 || z.abs() > 5.0);
        let planned = Interpreted::parse(&Source::new("t.tool", &text)).expect("nothing was said");
        let found = evaluate_points(&planned, Level::new(), &points);
        for (point, found) in points.iter().zip(found) {
            assert!(found.is_none(), "{point:?} is in {found:?}\n{text}");
        }
    }
}

/// A disc, a slot and a bulge so thin that rounding is near: exact or refused at a segment.
#[test]
fn needles_are_exact_or_refused_at_their_place() {
    let mut tried = Vec::new();
    for thin in [1e-3, 1e-6, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12, 1e-13] {
        let level = 2.0 + thin;
        let inner = 3.0 - thin;
        tried.extend(
            [
                // A disc and a slot, a lance and a coin, a spike and a notch, a rounded edge.
                format!("0 0, 1 0, 1 2, 3 2, 3 {level}, 1 {level}, 1 5, 0 5"),
                format!("0 0, 3 0, 3 2, 1 2, 1 {level}, 3 {level}, 3 5, 0 5"),
                format!("0 0, {thin} 0, {thin} 5, 0 5"),
                format!("0 0, 3 0, 3 {thin}, 0 {thin}"),
                format!("0 0, {thin} 4, 3 4, 3 5, 0 5"),
                format!("0 0, 3 0, 3 2, 1 2, 3 {level}, 3 5, 0 5"),
                format!("0 0, {inner} 0, 3 {thin} about {inner} {thin}, 3 5, 0 5"),
            ]
            .map(|vertices| Outline::parse(&vertices)),
        );
        for convex in [true, false] {
            let bulged =
                Outline::parse(&format!("0 0, 3 0, 3 2, 3 {}, 3 5, 0 5", 2.0 + 2.0 * thin));
            let mut segments = bulged.segments().to_vec();
            let chord = segments[2];
            segments[2] = Segment::about(chord.from, chord.to, [3.0, level], convex);
            tried.push(Outline::up(segments));
        }
    }
    let mut flawed = Vec::new();
    for outline in tried {
        match catch_unwind(AssertUnwindSafe(|| refused_or_exact(&outline))) {
            Ok(None | Some(true)) => {}
            shown => flawed.push(format!("{shown:?}: {}", outline.text())),
        }
    }
    assert!(flawed.is_empty(), "{} needles: {}", flawed.len(), flawed.join("\n"));
}

/// Returns whether a refusal shows a segment of the profile; `None` if the profile is accepted. An accepted profile
/// must have true distances, and the right side except beside the surface.
fn refused_or_exact(outline: &Outline) -> Option<bool> {
    let text = outline.text();
    let said = said(&text);
    if !said.is_empty() {
        let is_segment = |at: &String| ["line to", "arc to", "("].iter().any(|w| at.starts_with(w));
        return Some(said.iter().any(|(_, at)| is_segment(at)));
    }
    let planned = Interpreted::parse(&Source::new("t.tool", &text)).expect("nothing was said");
    let tool = tool(&text).expect("nothing was said");
    let mut reference = touchoff_dsl::interpret::Interpreter::new(&tool);
    let size = outline.size();
    let near = 1e-8 * size;
    for p in super::compare::points(outline, 160, &mut Rng::new(42)) {
        let [d, z] = outline.turned(p);
        let least = outline.profile.depth(&p).abs();
        let evaluation = reference.evaluate([d, 0.0, z], 1.0);
        let depth = evaluation.map_or(0.0, |evaluation| evaluation.depth);
        assert_near(depth + planned.clearance([d, 0.0, z]), least, near, (p, &text));
        if least > near {
            assert_eq!(evaluation.is_some(), outline.profile.encloses(&p), "at {p:?}\n{text}");
        }
    }
    None
}

/// Returns a profile with corners on a small grid, some moved by next to nothing, joined by lines and arcs.
fn nearly(rng: &mut Rng) -> Outline {
    let pick = |rng: &mut Rng, count: u64| rng.bits() % count;
    let little = |rng: &mut Rng| match pick(rng, 3) {
        0 => rng.between(-1.0, 1.0) * rng.power(-16.0, -5.0),
        _ => 0.0,
    };
    let count = 1 + pick(rng, 6);
    let mut points = vec![[0.0, 0.0]];
    for k in 0..count {
        let [_, z] = points[points.len() - 1];
        let up = [0.0, 0.0, 1.0, 1.0, 2.0, -1.0][pick(rng, 6) as usize];
        let d = (pick(rng, 4) + u64::from(k == 0)) as f64;
        points.push([d + little(rng).abs(), z + up + little(rng)]);
    }
    let end = points[points.len() - 1][1] + (pick(rng, 3) as f64) + little(rng);
    points.push([0.0, end]);
    let mut pieces = Vec::new();
    for pair in points.windows(2) {
        let chord = norm(&sub(&pair[1], &pair[0]));
        if pick(rng, 3) > 0 || chord == 0.0 {
            pieces.push(Segment::line(pair[0], pair[1]));
            continue;
        }
        let radius =
            chord / 2.0 * (1.0 + [0.0, 0.5, 2.0, 1e6][pick(rng, 4) as usize] + little(rng).abs());
        let mut arc = Segment::by_radius(pair[0], pair[1], radius, pick(rng, 2) == 0);
        if let Some(round) = &mut arc.circle {
            round.by_radius = pick(rng, 2) == 0;
        }
        pieces.push(arc);
    }
    Outline { profile: Profile::new(pieces), down: pick(rng, 4) == 0 }
}

/// Corners from a small grid, some moved by next to nothing: nearly touching, nearly tangent, nearly without
/// length. Nothing panics, and accepted profiles are right.
#[test]
fn nearly_bad_profiles_never_panic() {
    let count = super::profiles();
    let mut rng = Rng::new(43);
    let (mut taken, mut vague, mut flawed) = (0, 0, Vec::new());
    for _ in 0..10 * count {
        let outline = nearly(&mut rng);
        match catch_unwind(AssertUnwindSafe(|| refused_or_exact(&outline))) {
            Ok(shown) => {
                taken += usize::from(shown.is_none());
                vague += usize::from(shown == Some(false));
            }
            Err(_) => flawed.push(outline.text()),
        }
    }
    let count = 10 * count;
    println!("{taken} of {count} nearly bad profiles were taken, {vague} refused elsewhere");
    assert!(flawed.is_empty(), "{} of them, such as\n{}", flawed.len(), flawed[0]);
}
