//! Thread mills with flat and round crests against closed forms.

use super::{assert_corners, fusion, library, loaded};
use crate::{Library, Note, Stated};
use serde_json::{Value, json};
use touchoff::tool::{Circle, ProfileSegment, Tool};

/// Returns a thread mill of 10 mm, its teeth a pitch of 2 apart, with these dimensions besides.
fn mill(more: &Value) -> Value {
    let mut dimensions = json!({ "TP": 2, "LCF": 5, "thread-profile-angle": 60, "SFDM": 8 });
    for (key, value) in more.as_object().expect("an object") {
        dimensions[key] = value.clone();
    }
    dimensions
}

fn notes(dimensions: &Value) -> Vec<Note> {
    loaded(&fusion("thread mill", dimensions)).0.notes
}

fn outline(dimensions: &Value) -> Vec<ProfileSegment> {
    loaded(&fusion("thread mill", dimensions)).1.info().outline.to_vec()
}

fn reason(dimensions: &Value) -> String {
    library(&fusion("thread mill", dimensions)).skipped()[0].reason.clone()
}

/// Flanks of 45 degrees are as high as they are deep.
#[test]
fn flat_crests_have_the_corners_of_their_drawing() {
    let top = [[4.0, 5.0], [4.0, 60.0], [0.0, 60.0]];
    let flat = json!({ "thread-tip-type": "flat", "thread-tip-width": 0.4, "NT": 2, "thread-profile-angle": 90 });
    let two = [
        [4.4, 0.0],
        [5.0, 0.6],
        [5.0, 1.0],
        [4.4, 1.6],
        [4.4, 2.0],
        [5.0, 2.6],
        [5.0, 3.0],
        [4.4, 3.6],
        [4.4, 5.0],
    ];
    assert_corners("thread mill", &mill(&flat), &[&two[..], &top].concat());
    let mut single = flat.clone();
    single["NT"] = json!(1);
    let one = [[4.2, 0.0], [5.0, 0.8], [5.0, 1.2], [4.2, 2.0], [4.2, 5.0]];
    assert_corners("thread mill", &mill(&single), &[&one[..], &top].concat());
    assert_eq!(notes(&mill(&flat)), []);

    // Flanks of 30 degrees are deeper than high by the tangent of 60.
    let flank = 0.7;
    let root = 5.0 - flank * 3f64.sqrt();
    let steep = [[root, 0.0], [5.0, 0.7], [5.0, 1.0], [root, 1.7], [root, 2.0], [5.0, 2.7]];
    let steep = [&steep[..], &[[5.0, 3.0], [root, 3.7], [root, 5.0]], &top].concat();
    let width = json!({ "thread-tip-type": "flat", "thread-tip-width": 0.3, "NT": 2 });
    assert_corners("thread mill", &mill(&width), &steep);
}

#[test]
fn flat_crests_fill_at_most_half_the_pitch() {
    let width = |width: f64, teeth: u32| {
        mill(&json!({ "thread-tip-type": "flat", "thread-tip-width": width, "NT": teeth }))
    };
    let cylinder = [[5.0, 0.0], [5.0, 5.0], [4.0, 5.0], [4.0, 60.0], [0.0, 60.0]];
    assert_corners("thread mill", &width(1.000_000_1, 2), &cylinder);
    assert_corners("thread mill", &width(2.0, 1), &cylinder);
    assert!(reason(&width(1.01, 2)).contains("width of the crests, 1.01, does not fit"));
    assert!(reason(&width(2.01, 1)).contains("width of the crests, 2.01, does not fit"));
    assert!(reason(&width(-1.0, 2)).contains("width of the crests is -1"));
}

fn is_near(a: f64, b: f64) -> bool {
    (a - b).abs() < 1e-12
}

fn assert_points(found: &[[f64; 2]], expected: &[[f64; 2]]) {
    let same = found.len() == expected.len()
        && found.iter().zip(expected).all(|(a, b)| is_near(a[0], b[0]) && is_near(a[1], b[1]));
    assert!(same, "{found:?}, not {expected:?}");
}

/// Returns the arcs of an outline, with the segments before and after.
fn arcs(outline: &[ProfileSegment]) -> Vec<(Circle, [ProfileSegment; 2])> {
    let neighbours = outline.windows(3);
    neighbours.filter_map(|w| Some((w[1].circle?, [w[0], w[2]]))).collect()
}

/// Returns the distance of a centre from the straight line of a segment.
fn distance_to_line(centre: [f64; 2], line: &ProfileSegment) -> f64 {
    let [along_d, along_z] = [line.to[0] - line.from[0], line.to[1] - line.from[1]];
    let [d, z] = [centre[0] - line.from[0], centre[1] - line.from[1]];
    (d * along_z - z * along_d).abs() / along_d.hypot(along_z)
}

/// The radius of the arcs is 0.2 in a pitch of 2, with flanks of 30 degrees. An arc touches its flanks at
/// `0.2 cos 30` above and below its centre.
#[test]
fn round_crests_and_roots_touch_their_flanks() {
    let round = mill(&json!({ "thread-tip-type": "round", "thread-tip-radius": 0.2, "NT": 2 }));
    assert_eq!(notes(&round), []);
    let outline = outline(&round);
    let (radius, rise) = (0.2, 0.2 * 3f64.sqrt() / 2.0);
    // Sharp teeth would have this radius, and roots that are a pitch times half the cotangent lower.
    let sharp = 5.0 + radius * (1.0 / 0.5 - 1.0);
    let root = sharp - 3f64.sqrt() + radius * (1.0 / 0.5 - 1.0);
    let centres: Vec<[f64; 2]> = arcs(&outline).iter().map(|(c, _)| c.centre).collect();
    let expected = [
        [4.8, 1.0 - rise],
        [root + radius, 2.0 - rise],
        [4.8, 3.0 - rise],
        [root + radius, 4.0 - rise],
    ];
    assert_points(&centres, &expected);
    for (k, (circle, [before, after])) in arcs(&outline).iter().enumerate() {
        assert!(is_near(circle.radius, radius) && circle.convex == (k % 2 == 0), "{circle:?}");
        // The last root passes into the neck.
        let is_last = k == 3;
        for line in [Some(before), Some(after).filter(|_| !is_last)].into_iter().flatten() {
            assert!(is_near(distance_to_line(circle.centre, line), radius), "{circle:?} {line:?}");
        }
    }
    // The lowest flank begins where it would touch a root below the tip: its tangent is at the angle of the flank.
    let first = [root + radius - radius * 0.5, 0.0];
    let touch = 4.8 + radius * 0.5;
    let ends = [
        first,
        [touch, 1.0 - 2.0 * rise],
        [touch, 1.0],
        [first[0], 2.0 - 2.0 * rise],
        [first[0], 2.0],
        [touch, 3.0 - 2.0 * rise],
        [touch, 3.0],
        [first[0], 4.0 - 2.0 * rise],
        [root, 4.0 - rise],
        [root, 5.0 - rise],
        [4.0, 5.0 - rise],
        [4.0, 60.0],
        [0.0, 60.0],
    ];
    let found: Vec<[f64; 2]> = outline.iter().map(|segment| segment.to).collect();
    assert_points(&found, &ends);
}

#[test]
fn one_round_tooth_has_sharp_roots() {
    let round = mill(&json!({ "thread-tip-type": "round", "thread-tip-radius": 0.5, "NT": 1 }));
    let outline = outline(&round);
    let rise = 0.5 * 3f64.sqrt() / 2.0;
    let root = 5.0 + 0.5 - 3f64.sqrt();
    let found: Vec<[f64; 2]> = outline.iter().map(|segment| segment.to).collect();
    let ends = [
        [root, 0.0],
        [4.75, 1.0 - rise],
        [4.75, 1.0 + rise],
        [root, 2.0],
        [root, 5.0 - rise],
        [4.0, 5.0 - rise],
        [4.0, 60.0],
        [0.0, 60.0],
    ];
    assert_points(&found, &ends);
    let [(circle, lines)] = arcs(&outline)[..] else { panic!("{outline:?}") };
    assert_points(&[circle.centre], &[[4.5, 1.0]]);
    assert!(lines.iter().all(|line| is_near(distance_to_line(circle.centre, line), 0.5)));
    // The whole tooth is drawn where the flutes are as long as the pitch.
    let mut short = round;
    short["LCF"] = json!(2);
    let short: Vec<[f64; 2]> =
        loaded(&fusion("thread mill", &short)).1.info().outline.iter().map(|s| s.to).collect();
    assert_points(&short, &[&ends[..4], &[[4.0, 2.0], [4.0, 60.0], [0.0, 60.0]]].concat());
}

/// With the largest radius, crests pass into roots without a flank. Libraries state that radius rounded.
#[test]
fn round_crests_fill_at_most_the_pitch() {
    let round = |radius: f64, teeth: u32| {
        mill(&json!({ "thread-tip-type": "round", "thread-tip-radius": radius, "NT": teeth }))
    };
    for (teeth, largest) in [(1, 2.0 / 3f64.sqrt()), (2, 1.0 / 3f64.sqrt())] {
        for off in [-1e-3, -2e-4, -1e-5, -1e-6, 0.0, 1e-6, 1e-5] {
            let outline = outline(&round(largest + off, teeth));
            let (circle, _) = arcs(&outline)[0];
            let taken = if off < -1e-4 { largest + off } else { largest };
            assert!(is_near(circle.radius, taken), "{} for {taken}", circle.radius);
        }
        assert!(reason(&round(largest * 1.001, teeth)).contains("radius of the crests"));
    }
    assert!(reason(&round(-0.1, 2)).contains("radius of the crests is -0.1"));
    // A radius below the precision of the library's numbers is none.
    let pointed = outline(&mill(&json!({ "NT": 2 })));
    assert_eq!(outline(&round(1e-5, 2)), pointed);
    assert_ne!(outline(&round(1e-4, 2)), pointed);
}

/// A radius or a width that is not stated is named, and so is a form of crest.
#[test]
fn unstated_crests_are_points_with_a_note() {
    let pointed: Vec<[f64; 2]> = outline(&mill(&json!({}))).iter().map(|s| s.to).collect();
    for (more, unstated) in [
        (json!({ "thread-tip-type": "flat" }), "width"),
        (json!({ "thread-tip-type": "flat", "thread-tip-width": 0 }), "width"),
        (json!({ "thread-tip-type": "flat", "thread-tip-radius": 0.2 }), "width"),
        (json!({ "thread-tip-type": "round", "thread-tip-width": 0.2 }), "radius"),
        (json!({ "thread-tip-width": 0.2 }), "form"),
        (json!({ "thread-tip-type": "wavy", "thread-tip-width": 0.2 }), "form"),
    ] {
        let mut mill = mill(&more);
        mill["NT"] = json!(1);
        let notes = notes(&mill);
        let [Note::Unstated(what, drawn)] = &notes[..] else { panic!("{more}: {notes:?}") };
        assert_eq!(*what, format!("{unstated} of the crests"), "{more}");
        assert!(drawn.contains("point"), "{drawn}");
        let corners: Vec<[f64; 2]> = outline(&mill).iter().map(|s| s.to).collect();
        assert_eq!(corners, pointed, "{more}");
    }
    assert_eq!(notes(&mill(&json!({ "NT": 1, "thread-tip-type": "point" }))), []);
    let wrong = reason(&mill(&json!({ "thread-tip-type": "flat", "thread-tip-width": "?" })));
    assert!(wrong.contains("`thread-tip-width` is \"?\", no number"), "{wrong}");
}

#[test]
fn teeth_that_do_not_fit_the_flutes_are_noted() {
    let taken = |fit: f64| Note::Contradiction {
        first: Stated { what: "number of teeth", value: 3.0 },
        second: Stated { what: "number of pitches in the flute length", value: fit },
        taken: "teeth that fit",
        is_narrower: true,
    };
    assert_eq!(notes(&mill(&json!({ "NT": 3 }))), [taken(2.0)]);
    let flat = json!({ "NT": 3, "LCF": 1.5, "thread-tip-type": "flat", "thread-tip-width": 0.4 });
    assert_eq!(notes(&mill(&flat)), [taken(0.0)]);
    // Without a tooth the roots' cylinder remains.
    let root = 5.0 - 0.6 * 3f64.sqrt();
    let neck = [[root, 0.0], [root, 1.5], [4.0, 1.5], [4.0, 60.0], [0.0, 60.0]];
    assert_corners("thread mill", &mill(&flat), &neck);
    assert_eq!(notes(&mill(&json!({ "NT": 2 }))), []);
}

#[test]
fn hsm_states_crests_as_fusion_does() {
    let hsm = r#"<tool-library><tool type="thread mill" unit="millimeters"><description>a tool</description>
        <body diameter="10" thread-pitch="2" flute-length="5" overall-length="60" shaft-diameter="8"
        thread-profile-angle="60" number-of-teeth="2" thread-tip-type="flat" thread-tip-width="0.3"/></tool>
        </tool-library>"#;
    let library = Library::parse("l.hsmlib".as_ref(), hsm.as_bytes()).expect("a library");
    let tool = library.tools()[0].load().expect("a tool");
    let flat = mill(&json!({ "thread-tip-type": "flat", "thread-tip-width": 0.3, "NT": 2 }));
    assert_eq!(tool.info().outline, outline(&flat));
    assert_eq!(library.tools()[0].entry.notes, []);
}
