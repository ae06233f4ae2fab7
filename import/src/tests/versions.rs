//! Libraries of Fusion 360 and HSM since version 36: pitches of thread mills, and probes.

use super::super::{Library, Note};
use super::{corners, fusion, library, loaded};
use serde_json::{Value, json};

/// Returns a thread mill with some teeth, 4 mm wide, and these pitches.
fn mill(teeth: u32, pitches: &Value) -> Value {
    let mut dimensions = json!({ "DC": 4, "NT": teeth, "LCF": 8, "SFDM": 6, "shoulder-length": 10,
        "shoulder-diameter": 2.5, "thread-profile-angle": 60, "thread-tip-type": "point" });
    for (key, pitch) in pitches.as_object().expect("an object") {
        dimensions[key] = pitch.clone();
    }
    fusion("thread mill", &dimensions)
}

#[test]
fn a_thread_mill_has_its_least_and_greatest_pitch() {
    for teeth in [1, 5] {
        let (entry, _) = loaded(&mill(teeth, &json!({ "TPN": 0.8, "TPX": 0.8 })));
        assert_eq!(entry.notes, []);
        let both = corners(&mill(teeth, &json!({ "TPN": 0.8, "TPX": 0.8 })));
        assert_eq!(both, corners(&mill(teeth, &json!({ "TP": 0.8 }))));
        // Fusion 360 writes 0 for what it does not know.
        assert_eq!(both, corners(&mill(teeth, &json!({ "TPN": 0, "TPX": 0.8, "TP": 0 }))));
    }
    // One tooth cuts several pitches, several teeth are one pitch apart.
    let range = json!({ "TPN": 0.6, "TPX": 1.0 });
    let (entry, _) = loaded(&mill(1, &range));
    let [Note::Unstated("pitch of the thread that is cut", drawn)] = &entry.notes[..] else {
        panic!("{:?}", entry.notes);
    };
    assert!(drawn.ends_with("greatest pitch, 1"), "{drawn}");
    assert_eq!(corners(&mill(1, &range)), corners(&mill(1, &json!({ "TP": 1.0 }))));
    let several = library(&mill(5, &range));
    assert!(several.tools().is_empty());
    let reason = &several.skipped()[0].reason;
    assert!(reason.contains("5 teeth and pitches from 0.6 to 1"), "{reason}");
    let other = loaded(&mill(1, &json!({ "TPN": 0.8, "TPX": 0.8, "TP": 0.5 }))).0;
    assert!(matches!(other.notes[..], [Note::Contradiction { .. }]), "{:?}", other.notes);
}

/// A least pitch above the greatest is a mistake, and no pitch.
#[test]
fn pitches_that_contradict_each_other_are_refused() {
    for teeth in [1, 5] {
        let swapped = library(&mill(teeth, &json!({ "TPN": 1.0, "TPX": 0.6 })));
        let reason = &swapped.skipped()[0].reason;
        assert!(
            reason.contains("the least pitch, 1, does not fit the greatest pitch, 0.6"),
            "{reason}"
        );
    }
}

/// Fusion 360 computes dimensions anew from their expressions.
#[test]
fn an_expression_of_another_length_is_noted() {
    let notes = |expressions: Value| {
        let mut tool = fusion("flat end mill", &json!({ "SFDM": 10 }));
        tool["expressions"] = expressions;
        loaded(&tool).0.notes
    };
    let same = json!({ "tool_diameter": "10 mm", "tool_fluteLength": "0.7874015748 in", "tool_overallLength": "60",
        "tool_bodyLength": "tool_overallLength - 20 mm", "tool_description": "'a'" });
    assert_eq!(notes(same), []);
    let other = notes(json!({ "tool_diameter": "0.5in" }));
    assert!(matches!(&other[..], [Note::OtherExpression { expression: 12.7, .. }]), "{other:?}");
    // A plain length has a unit in letters of any case, an exponent, a comma, quotes, or is a number.
    for length in [
        json!("2 cm"),
        json!("20 MM"),
        json!("2e1 mm"),
        json!("20,0 mm"),
        json!("'20 mm'"),
        json!("(20 mm)"),
        json!("0.02 meters"),
        json!(20),
    ] {
        let other = notes(json!({ "tool_diameter": length }));
        assert!(matches!(&other[..], [Note::OtherExpression { expression: 20.0, .. }]), "{length}");
    }
    assert_eq!(notes(json!({ "tool_diameter": "1 cm", "tool_fluteLength": "20 mm * 2" })), []);
}

#[test]
fn the_kind_of_a_taper_may_stand_among_the_dimensions() {
    let taper = |mut tool: Value, place: &str| {
        let place = if place.is_empty() { &mut tool } else { &mut tool[place] };
        place["tapered-type"] = "tapered_ball".into();
        corners(&tool)
    };
    let tool = fusion("tapered mill", &json!({ "RE": 2, "TA": 5, "DC": 4, "SFDM": 10 }));
    assert_eq!(taper(tool.clone(), "geometry"), taper(tool.clone(), ""));
    assert_ne!(taper(tool.clone(), ""), corners(&tool));
}

#[test]
fn hsm_has_the_pitches_of_fusion() {
    let text = r#"<tool-library version="36"><tool type="thread mill" unit="millimeters"><description>a tool</description>
        <body TPN="0.8" TPX="0.8" diameter="4" flute-length="8" number-of-flutes="3" number-of-teeth="5"
        overall-length="60" shaft-diameter="6" shoulder-diameter="2.5" shoulder-length="10" thread-profile-angle="60"
        thread-tip-type="point"/></tool></tool-library>"#;
    let hsm = Library::parse("l.hsmlib".as_ref(), text.as_bytes()).expect("a library");
    let fusion = library(&mill(5, &json!({ "TPN": 0.8, "TPX": 0.8 })));
    let body = |library: &Library| {
        let text = library.tools()[0].files[0].text.clone();
        // The first line names the library.
        text.split_once('\n').map(|(_, rest)| rest.to_owned())
    };
    assert_eq!(body(&hsm), body(&fusion));
}

#[test]
fn a_probe_without_lengths_ends_at_its_holder() {
    let probe = |dimensions: Value| {
        json!({ "type": "probe", "unit": "millimeters", "description": "a probe",
            "geometry": dimensions })
    };
    let (entry, tool) = loaded(&probe(json!({ "DC": 6, "SFDM": 4, "LB": 35 })));
    let unstated: Vec<&str> = entry
        .notes
        .iter()
        .map(|note| match note {
            Note::Unstated(what, _) => *what,
            other => panic!("{other}"),
        })
        .collect();
    assert_eq!(unstated, ["overall length", "flute length"]);
    let found: Vec<[f64; 2]> =
        touchoff::Tool::info(&tool).outline.iter().map(|segment| segment.to).collect();
    let neck = 3.0 + 5f64.sqrt();
    let expected = [[3.0, 3.0], [2.0, neck], [2.0, 35.0], [0.0, 35.0]];
    assert_eq!(found.len(), expected.len(), "{found:?}");
    for (found, expected) in found.iter().zip(expected) {
        assert!((found[0] - expected[0]).hypot(found[1] - expected[1]) < 1e-12, "{found:?}");
    }
    let nowhere = library(&probe(json!({ "DC": 6, "SFDM": 4 })));
    assert!(nowhere.skipped()[0].reason.contains("overall length"), "{:?}", nowhere.skipped());
}
