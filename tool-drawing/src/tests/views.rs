//! The choice of views: the detail of a tool, and the sections of a solid.

use super::{library, tool};
use crate::detail::{Detail, scale_factor};
use crate::picture::{Part, Picture};
use crate::{Content, TextRendering, notes, paint, solid, svg};
use std::f64::consts::PI;
use touchoff_dsl::CheckedTool;

fn profile(segments: &str) -> Box<CheckedTool> {
    tool(&format!("tool T {{ units mm; profile {{ start (0, 0); {segments} }} }}"))
}

/// Returns whether the outline of a tool has a detail, and the detail's largest height.
fn detail_top(tool: &CheckedTool, content: Content) -> Option<f64> {
    Detail::new(tool, &Picture::new(tool, content)).map(|detail| detail.corner[1])
}

#[test]
fn a_small_cutting_part_has_a_detail() {
    let nut = "line to (12.9, 30), (14, 31.1), (14, 47.5), (0, 47.5) as nut;";
    let thin = profile(&format!(
        "arc to (3, 3) center (0, 3) as ball cutting; line to (3, 20) as flute cutting;
         line to (3, 30) as shank; {nut}"
    ));
    let top = detail_top(&thin, Content::Outline).expect("a detail");
    assert!((20.0..25.0).contains(&top), "{top}");
    // The regions of a single file are drawn in one view.
    assert_eq!(detail_top(&thin, Content::Regions), None);

    // A shoulder at the end of the cutting part is cut off beside it.
    let shouldered = profile(
        "line to (2, 0), (2, 12) as flute cutting; line to (20, 12), (21, 13), (21, 50), (0, 50) as head;",
    );
    let whole = Picture::new(&shouldered, Content::Outline);
    let [radius, _] = Detail::new(&shouldered, &whole).expect("a detail").corner;
    assert!((2.0..4.0).contains(&radius), "{radius}");

    let wide = profile(
        "line to (6, 0) as face cutting; line to (6, 15) as flute cutting; line to (6, 30), (0, 30) as shank;",
    );
    assert_eq!(detail_top(&wide, Content::Outline), None);
    let blunt = profile(&format!("line to (3, 0), (3, 30) as pin; {nut}"));
    assert_eq!(detail_top(&blunt, Content::Outline), None);
}

#[test]
fn assemblies_have_a_detail_with_and_without_regions() {
    for content in [Content::Outline, Content::Regions] {
        for name in ["ball_er16", "drill_bt40"] {
            let tool = library(name);
            assert!(detail_top(&tool, content).is_some(), "{name}");
            let drawing = svg(&tool, content, TextRendering::Page);
            assert!(drawing.contains(" : 1)</text>"), "{name}: {drawing}");
        }
    }
}

/// Each face is measured in one view: the cutting part in the detail, the rest in the whole view.
#[test]
fn dimensions_are_divided_between_the_views() {
    let tool = library("ball_er16");
    let mut picture = Picture::new(&tool, Content::Outline);
    let corner = Detail::new(&tool, &picture).expect("a detail").corner;
    for p in notes::heights(&picture.section, picture.size, |_| true) {
        picture.part = Part::OutsideDetail(corner);
        let outside = picture.describes(p);
        picture.part = Part::Detail(corner);
        assert_ne!(outside, picture.describes(p), "{p:?}");
    }
    let drawing = svg(&tool, Content::Outline, TextRendering::Page);
    for text in ["cutter.ball R3", "cutter.flute ⌀6", "nut.nut ⌀28"] {
        assert_eq!(drawing.matches(&format!(">{text}</text>")).count(), 1, "{text}");
    }
}

#[test]
fn scale_factors_are_round() {
    let cases =
        [(1.9, None), (2.0, Some(2.0)), (3.9, Some(2.5)), (9.9, Some(8.0)), (24.0, Some(20.0))];
    for (most, expected) in cases {
        assert_eq!(scale_factor(most), expected, "{most}");
    }
}

/// Asserts the areas of the three sections, front, side and top, to half a percent: areas are computed from chords.
fn areas(tool: &CheckedTool, expected: [f64; 3]) {
    let sections = solid::sections(tool, Content::Regions);
    for (section, expected) in sections.iter().zip(expected) {
        let scale = section.picture.view.scale;
        let area = paint::material(&section.picture).area() / (scale * scale);
        let regions: f64 = section.picture.shapes.iter().map(|s| s.area() / (scale * scale)).sum();
        for area in [area, regions] {
            assert!((area - expected).abs() < 0.005 * expected, "{area}, not {expected}");
        }
    }
}

#[test]
fn sections_of_solids_have_their_areas() {
    // 40 x 30 x 20.
    areas(&library("block"), [800.0, 600.0, 1200.0]);
    let ball = tool(
        "solid Ball { units mm; curve shell = 10 - hypot(hypot(x - 3, y), z + 5);
         region ball where shell >= 0 { depth: shell; } }",
    );
    areas(&ball, [100.0 * PI; 3]);
    // The middle is (5, 0, 12): the section x = 5 misses the standing leg, and z = 12 the lying one.
    areas(&library("l_bracket"), [30.0 * 6.0 + 18.0 * 6.0 - 6.6 * 6.0, 20.0 * 6.0, 20.0 * 6.0]);
    for (section, expected) in solid::sections(&ball, Content::Outline).iter().zip([0.0, 3.0, -5.0])
    {
        assert!((section.at - expected).abs() < 1e-12, "{}, not {expected}", section.at);
    }
}

#[test]
fn notes_keep_their_spacing_and_stay_near_their_anchors() {
    assert_eq!(notes::spread(&[0.0, 30.0, 60.0], 10.0), [0.0, 30.0, 60.0]);
    assert_eq!(notes::spread(&[0.0, 0.0], 10.0), [-5.0, 5.0]);
    let heights = notes::spread(&[0.0, 1.0, 2.0, 3.0, 50.0], 10.0);
    assert!(heights.windows(2).all(|pair| pair[1] - pair[0] >= 10.0 - 1e-9));
    assert_eq!(heights[4], 50.0);
}
