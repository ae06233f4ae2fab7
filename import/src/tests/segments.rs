//! Circle-segment mills against closed forms.

use super::{fusion, library, loaded};
use crate::{Note, Stated};
use serde_json::{Value, json};
use touchoff::tool::{Interpreted, ProfileSegment, Tool};

/// Returns a mill of 12 mm with flutes of 20 mm and these dimensions besides.
fn mill(kind: &str, more: &Value) -> Value {
    let mut dimensions = json!({ "DC": 12, "LCF": 20, "OAL": 80, "SFDM": 12 });
    for (key, value) in more.as_object().expect("an object") {
        dimensions[key] = value.clone();
    }
    fusion(&format!("circle segment {kind}"), &dimensions)
}

fn outline(tool: &Interpreted) -> &[ProfileSegment] {
    &tool.info().outline
}

fn assert_ends(tool: &Interpreted, expected: &[[f64; 2]]) {
    let ends: Vec<[f64; 2]> = outline(tool).iter().map(|segment| segment.to).collect();
    let same = ends.len() == expected.len()
        && ends.iter().zip(expected).all(|(a, b)| (a[0] - b[0]).hypot(a[1] - b[1]) < 1e-12);
    assert!(same, "{ends:?}, not {expected:?}");
}

/// Asserts an arc's centre and radius, to rounding.
fn assert_arc(segment: &ProfileSegment, centre: [f64; 2], radius: f64) {
    let circle = segment.circle.expect("an arc");
    let off = (circle.centre[0] - centre[0]).hypot(circle.centre[1] - centre[1]);
    assert!(circle.convex && off < 1e-11 && (circle.radius - radius).abs() < 1e-11, "{circle:?}");
}

/// The note that every circle-segment mill has.
fn arcs_note() -> Note {
    let drawn = "they are drawn tangent to each other".to_owned();
    Note::Unstated("construction of its arcs", drawn)
}

/// The flank's centre is (-42, 10), 47 from the centres of the edges, which are 9 below and above it.
#[test]
fn a_barrel_touches_the_planes_of_its_ends() {
    let barrel = json!({ "axial-distance": 10, "lower-radius": 1, "profile-radius": 48,
        "upper-radius": 1, "SFDM": 8 });
    let (entry, tool) = loaded(&mill("barrel", &barrel));
    assert_eq!(entry.notes, [arcs_note()]);
    let inner = (47f64 * 47.0 - 81.0).sqrt();
    let (edge, touch, drop) = (inner - 42.0, inner * 48.0 / 47.0 - 42.0, 9.0 * 48.0 / 47.0);
    assert!((edge - 4.130_250).abs() < 1e-6 && (touch - 5.111_745).abs() < 1e-6);
    let low = [[edge, 0.0], [touch, 10.0 - drop], [touch, 10.0 + drop], [edge, 20.0]];
    assert_ends(&tool, &[&low[..], &[[4.0, 20.0], [4.0, 80.0], [0.0, 80.0]]].concat());
    assert_arc(&outline(&tool)[2], [-42.0, 10.0], 48.0);
}

/// The corner's centre is 10.8 from the face's, and 4.8 from the axis.
#[test]
fn a_lens_touches_its_corner() {
    let (entry, tool) = loaded(&mill("lens", &json!({ "RE": 1.2, "lower-radius": 12 })));
    assert_eq!(entry.notes, [arcs_note()]);
    let rise = (10.8f64 * 10.8 - 4.8 * 4.8).sqrt();
    let touch = [4.8 / 0.9, 12.0 - rise / 0.9];
    assert!((12.0 - rise - 2.325_291).abs() < 1e-6 && (touch[1] - 1.250_323).abs() < 1e-6);
    assert_ends(&tool, &[touch, [6.0, 12.0 - rise], [6.0, 20.0], [6.0, 80.0], [0.0, 80.0]]);
    assert_arc(&outline(&tool)[0], [0.0, 12.0], 12.0);
    assert_arc(&outline(&tool)[1], [4.8, 12.0 - rise], 1.2);
}

/// The flank's centre is 174 beyond the axis, 178 from the tip's, which is 2 above the tip.
#[test]
fn an_oval_that_ends_below_its_widest_point_is_noted() {
    let high = 2.0 + (178f64 * 178.0 - 174.0 * 174.0).sqrt();
    let touch = [174.0 * 180.0 / 178.0 - 174.0, 2.0 - 2.0 * (high - 2.0) / 178.0];
    let whole = json!({ "lower-radius": 2, "profile-radius": 180, "LCF": 45 });
    let (entry, tool) = loaded(&mill("oval", &whole));
    assert_eq!(entry.notes, [arcs_note()]);
    assert_ends(&tool, &[touch, [6.0, high], [6.0, 45.0], [6.0, 80.0], [0.0, 80.0]]);
    assert_arc(&outline(&tool)[1], [-174.0, high], 180.0);

    let short = json!({ "lower-radius": 2, "profile-radius": 180, "SFDM": 8 });
    let (entry, tool) = loaded(&mill("oval", &short));
    let wide = (180f64 * 180.0 - (high - 20.0).powi(2)).sqrt() - 174.0;
    assert!((wide - 4.938).abs() < 1e-3);
    assert_ends(&tool, &[touch, [wide, 20.0], [4.0, 20.0], [4.0, 80.0], [0.0, 80.0]]);
    let [first, Note::Contradiction { first: diameter, second, .. }] = &entry.notes[..] else {
        panic!("{:?}", entry.notes)
    };
    assert_eq!((first, *diameter), (&arcs_note(), Stated { what: "diameter", value: 12.0 }));
    assert!((second.value - 2.0 * wide).abs() < 1e-9, "{second:?}");
}

/// Returns the dimensions of a circle-segment taper, with the tip's diameter, the radii of the tip, the flank and the
/// upper edge, and the taper angle.
fn taper([tip, lower, flank, upper, angle]: [f64; 5]) -> Value {
    let dimensions = json!({ "tip-diameter": tip, "lower-radius": lower, "profile-radius": flank,
        "upper-radius": upper, "TA": angle, "RE": 0, "axial-distance": 1 });
    mill("taper", &dimensions)
}

/// Tapers with ball, rounded and sharp tips, and with rounded and sharp upper edges.
const TAPERS: [[f64; 5]; 5] = [
    [0.0, 3.0, 375.0, 6.0, 20.0],
    [4.0, 1.5, 80.0, 3.0, 25.0],
    [4.0, 0.0, 80.0, 3.0, 25.0],
    [0.0, 2.0, 30.0, 0.0, 15.0],
    [0.0, 0.0, 60.0, 4.0, 30.0],
];

/// Each arc touches the next, the flank has the taper angle at its upper end, and the edge ends at the diameter.
#[test]
fn the_arcs_of_a_taper_touch_each_other() {
    for dimensions in TAPERS {
        let [tip, lower, flank, upper, angle] = dimensions;
        let (_, tool) = loaded(&taper(dimensions));
        let mut segments = outline(&tool).iter();
        let mut next = || segments.next().expect("a segment");
        let mut from = [tip / 2.0, 0.0];
        if tip > 0.0 {
            assert_eq!(next().to, from);
        }
        if lower > 0.0 {
            let arc = next();
            assert_arc(arc, [tip / 2.0, lower], lower);
            from = arc.to;
        }
        let arc = next();
        let centre = arc.circle.expect("the flank").centre;
        assert_arc(arc, centre, flank);
        assert_eq!(arc.from, from);
        let apart = |a: [f64; 2], b: [f64; 2]| (a[0] - b[0]).hypot(a[1] - b[1]);
        // Circles of which one is inside the other touch if their centres are apart by the difference of the radii.
        assert!((apart(centre, [tip / 2.0, lower]) - (flank - lower)).abs() < 1e-11, "{arc:?}");
        let end = arc.to;
        let slope = (end[1] - centre[1]).atan2(end[0] - centre[0]).to_degrees();
        assert!((slope + angle).abs() < 1e-9, "{slope}");
        if upper > 0.0 {
            let edge = next();
            let edge_centre = edge.circle.expect("the edge").centre;
            assert_arc(edge, [6.0 - upper, edge.to[1]], upper);
            assert!((apart(centre, edge_centre) - (flank - upper)).abs() < 1e-11, "{edge:?}");
        }
        let rest: Vec<[f64; 2]> = segments.map(|segment| segment.to).collect();
        assert_eq!(rest, [[6.0, 20.0], [6.0, 80.0], [0.0, 80.0]], "{dimensions:?}");
    }
}

/// The heights follow from the angles of the flank's two ends: over each, the distance from the axis grows by the
/// difference of the radius and the cosine, and the height by that of the sines.
#[test]
fn the_height_of_a_taper_is_that_of_its_drawing() {
    let (entry, tool) = loaded(&taper(TAPERS[0]));
    let [upper_end, lower_end] = [20f64.to_radians(), 20f64.to_radians()];
    // 372 cos b = 369 cos 20 and 369 cos c = 372 cos 20, where the radii of tip and edge are 3 and 6, and 6 - 6 is 0.
    let begin = (369.0 * upper_end.cos() / 372.0).acos();
    let end = (372.0 * lower_end.cos() / 369.0).acos();
    let wide = 3.0 + 372.0 * begin.sin() - 369.0 * upper_end.sin();
    let narrow = 3.0 + 372.0 * lower_end.sin() - 369.0 * end.sin();
    let flank = outline(&tool)[1].to;
    let drawn = 3.0 + 372.0 * begin.sin() - 375.0 * upper_end.sin();
    let off = [flank[0] - 6.0 * upper_end.cos(), flank[1] - drawn];
    assert!(off[0].hypot(off[1]) < 1e-11, "{flank:?}");
    assert!((outline(&tool)[2].to[1] - wide).abs() < 1e-11);
    let [first, Note::Unstated(what, taken)] = &entry.notes[..] else {
        panic!("{:?}", entry.notes)
    };
    assert_eq!(first, &arcs_note());
    assert_eq!(*what, "point of the flank that has the taper angle");
    assert!(taken.contains(&format!("{wide:.4};")), "{taken}, not {wide}");
    assert!(taken.ends_with(&format!("from {narrow:.4}")), "{taken}, not {narrow}");
}

/// Returns points on the flank and the upper edge of the taper whose flank begins at this angle from the axis.
fn reading([tip, lower, flank, upper, _]: [f64; 5], low: f64) -> Option<Vec<[f64; 2]>> {
    let centre = [tip / 2.0 - (flank - lower) * low.cos(), lower + (flank - lower) * low.sin()];
    let cos = (6.0 - upper - centre[0]) / (flank - upper);
    let high = (cos <= 1.0).then(|| cos.acos())?;
    let edge = [6.0 - upper, centre[1] - (flank - upper) * high.sin()];
    let arc = |centre: [f64; 2], radius: f64, from: f64, to: f64| {
        (0..=50).map(move |k| {
            let angle = from + (to - from) * f64::from(k) / 50.0;
            [centre[0] + radius * angle.cos(), centre[1] - radius * angle.sin()]
        })
    };
    Some(arc(centre, flank, low, high).chain(arc(edge, upper, high, 0.0)).collect())
}

/// Wherever on the flank the taper angle is, the tool lies inside the drawn one, and reaches its diameter between the
/// heights of the note.
#[test]
fn a_taper_contains_every_reading_of_its_angle() {
    for dimensions in TAPERS {
        let (entry, tool) = loaded(&taper(dimensions));
        let [.., Note::Unstated(_, taken)] = &entry.notes[..] else { panic!("{:?}", entry.notes) };
        let number = |text: &str| -> f64 {
            let digits = text.chars().take_while(|c| c.is_ascii_digit() || *c == '.');
            digits.collect::<String>().parse().expect("a number")
        };
        let heights: Vec<f64> = taken.split("from ").skip(1).map(number).collect();
        let [wide, narrow] = heights[..] else { panic!("{taken}") };
        let angle = dimensions[4].to_radians();
        let flank = |s: &&ProfileSegment| s.circle.is_some_and(|circle| circle.radius > 10.0);
        let flank = outline(&tool).iter().find(flank).expect("a flank");
        let centre = flank.circle.expect("an arc").centre;
        let drawn = (centre[1] - flank.from[1]).atan2(flank.from[0] - centre[0]);
        let mut read = 0;
        let mut last = 0.0;
        for k in 0..=40 {
            let low = drawn + (angle - drawn) * f64::from(k) / 40.0;
            let Some(points) = reading(dimensions, low) else { continue };
            read += 1;
            for [d, z] in &points {
                let outside = tool.clearance([*d, 0.0, *z]);
                assert!(outside < 1e-9, "{dimensions:?}: ({d}, {z}) is {outside} outside");
            }
            last = points[points.len() - 1][1];
            assert!(last > wide - 1e-4 && last < narrow + 1e-4, "{last} not in {wide}..{narrow}");
        }
        assert!(read > 5 && last > wide, "{dimensions:?}: {read} readings up to {last}");
    }
}

#[test]
fn tapers_that_are_no_solid_are_left_out() {
    let reason = |tool: &Value| library(tool).skipped()[0].reason.clone();
    let taper_reason = |dimensions: [f64; 5]| reason(&taper(dimensions));
    for (key, name) in [
        ("tip-diameter", "tip diameter"),
        ("lower-radius", "lower radius"),
        ("profile-radius", "profile radius"),
        ("upper-radius", "upper radius"),
        ("TA", "taper angle"),
    ] {
        let mut tool = taper(TAPERS[0]);
        tool["geometry"].as_object_mut().expect("an object").remove(key);
        assert!(reason(&tool).contains(&format!("does not state the {name}")), "{key}");
    }
    assert!(taper_reason([0.0, 3.0, 3.0, 1.0, 20.0]).contains("lower radius, 3"));
    assert!(taper_reason([0.0, 3.0, 5.0, 6.0, 20.0]).contains("upper radius, 6"));
    assert!(taper_reason([0.0, 3.0, -1.0, 1.0, 20.0]).contains("radius of the flank, -1"));
    assert!(taper_reason([0.0, 3.0, 5.0, 1.0, 89.0]).contains("radius of the flank, 5"));
    assert!(taper_reason([0.0, 3.0, 375.0, 6.0, 90.0]).contains("taper angle is 90"));
    assert!(taper_reason([8.0, 5.0, 80.0, 6.0, 20.0]).contains("lower radius, 5"));
    assert!(taper_reason([2.0, 4.999999, 80.0, 5.0, 20.0]).contains("lower radius, 4.999999"));
    assert!(taper_reason([13.0, 3.0, 375.0, 6.0, 20.0]).contains("tip diameter, 13"));
    // A flank that is not long enough within the flutes.
    let long = taper_reason([0.0, 1.0, 375.0, 6.0, 5.0]);
    assert!(
        long.contains("flute length, 20, does not fit the height of the full diameter"),
        "{long}"
    );
}
