//! Drawings: every surface is explained, the measures are the file's, every region is named if regions are drawn, and
//! the bytes are the same every time. One is kept as a snapshot.

use touchoff_drawing::{Content, TextRendering, svg};
use touchoff_dsl::{CheckedTool, emit};
use touchoff_tests::library::checked;
use touchoff_tests::texts::tool;

fn profile(segments: &str) -> Box<CheckedTool> {
    tool(format!("tool T \"a <profile> & more\" {{ units mm; profile {{ {segments} }} }}"))
}

/// Returns the drawing of a tool with its regions as SVG.
fn drawn(tool: &CheckedTool, text: TextRendering) -> String {
    svg(tool, Content::Regions, text)
}

fn texts(svg: &str) -> Vec<String> {
    let mut texts: Vec<String> = svg
        .split("aria-label=\"")
        .skip(1)
        .filter_map(|rest| rest.split('"').next())
        .map(|text| text.replace("&lt;", "<").replace("&gt;", ">").replace("&amp;", "&"))
        .collect();
    texts.dedup();
    texts
}

#[track_caller]
fn assert_has(texts: &[String], expected: &[&str]) {
    for text in expected {
        assert!(texts.iter().any(|own| own == text), "no {text} in {texts:?}");
    }
}

/// Asserts that every element of an SVG document ends, and ends in the element in which it begins.
fn well_formed(svg: &str) {
    let mut open = Vec::new();
    for tag in svg.split('<').skip(1) {
        let (tag, _) = tag.split_once('>').unwrap_or_else(|| panic!("`<{tag}` does not end"));
        assert_eq!(tag.matches('"').count() % 2, 0, "an attribute of `<{tag}>` does not end");
        match tag.strip_prefix('/') {
            Some(name) => assert_eq!(open.pop(), Some(name)),
            None if tag.ends_with('/') => {}
            None => open.push(tag.split(' ').next().unwrap_or(tag)),
        }
    }
    assert!(open.is_empty(), "{open:?} do not end");
}

fn holds(tool: &CheckedTool) {
    let name = &tool.model.name;
    for content in [Content::Outline, Content::Regions] {
        let drawing = svg(tool, content, TextRendering::Strokes);
        assert_eq!(drawing, svg(tool, content, TextRendering::Strokes), "{name}: other bytes");
        well_formed(&drawing);
        let texts = texts(&drawing);
        let surface = |name: &str| tool.model.surfaces.iter().any(|surface| surface.name == name);
        for region in tool.model.regions.iter().map(|region| &region.name) {
            let expected = content == Content::Regions;
            let found = texts.contains(region);
            // Regions and surfaces may share a name.
            let is_right = if expected { found } else { !found || surface(region) };
            assert!(is_right, "{name}, {content:?}: label {region} in {texts:?}");
        }
        explains_surfaces(tool, &texts);
        assert!(!drawing.contains("NaN") && !drawing.contains("inf"), "{name}: {drawing}");
    }
    let page = drawn(tool, TextRendering::Page);
    assert!(page.len() < 20_000, "{name}: {} bytes on a page", page.len());
    assert!(!page.contains('\n'), "{name}: a blank line would end the block in rustdoc");
}

fn explains_surfaces(tool: &CheckedTool, texts: &[String]) {
    let name = &tool.model.name;
    for surface in &tool.model.surfaces {
        let words = format!("{}{}", surface.name, if surface.cutting { ", cutting" } else { "" });
        assert!(texts.contains(&words), "{name}: no legend for {words} in {texts:?}");
    }
}

#[test]
fn every_tool_of_the_library_is_drawn() {
    for name in
        ["cylinder", "d2_ball", "fig_7_3", "fig_7_3_exact", "half_sphere_cylinder", "unit_sphere"]
    {
        holds(&checked(name));
    }
}

#[test]
fn profiles_are_drawn() {
    // A bull nose, a lollipop, a flange's groove, a fillet, a needle and a saw.
    let profiles = [
        "start (0, 0); line to (3, 0) as face cutting; arc to (5, 2) center (3, 2) as torus cutting;
         line to (5, 22) as flute cutting; line to (4.6, 23), (4.6, 40), (0, 40) as shank;",
        "start (0, 0); arc to (3, 3) center (0, 3) as ball cutting;
         arc to (1.8, 5.4) center (0, 3) as ball cutting; line to (1.8, 30), (0, 30) as neck;",
        "start (0, 0); line to (16, 0), (16, 12), (31.5, 12), (31.5, 20), (26.5, 22.5),
         (26.5, 27.5), (31.5, 30), (31.5, 38), (0, 38) as flange;",
        "start (0, 0); line to (4, 0) as face cutting; line to (4, 20) as flute cutting;
         arc to (8, 24) radius 4 concave as fillet; line to (12, 24), (12, 32), (0, 32) as collar;",
        "start (0, 0); line to (0.45, 0), (0.5, 0.05), (0.5, 3) as flute cutting;
         line to (0.5, 60), (0, 60) as shank;",
        "start (0, 0); line to (8, 0), (8, 3), (20, 3) as arbor; line to (50, 3), (50, 4.6),
         (20, 4.6) as rim cutting; line to (20, 9), (8, 9), (8, 60), (0, 60) as arbor;",
    ];
    for segments in profiles {
        holds(&profile(segments));
    }
}

#[test]
fn dimensions_are_in_the_unit_of_the_file() {
    let tool = profile(
        "start (0, 0); arc to (3, 3) center (0, 3) as ball cutting; line to (3, 20) as flute cutting;
         line to (3, 30) as shank; line to (12.9, 30), (14, 31.1), (14, 47.5), (0, 47.5) as nut;",
    );
    let texts = texts(&drawn(&tool, TextRendering::Strokes));
    let title = "a <profile> & more";
    assert_has(&texts, &["ball R3", "flute ⌀6", "shank ⌀6", "nut ⌀28", title]);
    let mut heights = texts;
    heights.retain(|text| text.starts_with(|first: char| first.is_ascii_digit()));
    assert_eq!(heights, ["0", "3", "20", "30", "31.1", "47.5 mm"]);
}

/// A shortened needle is marked as such, and still shows its true length.
#[test]
fn long_tools_are_shortened() {
    let needle = profile("start (0, 0); line to (0.5, 0), (0.5, 60), (0, 60) as shank;");
    assert_has(&texts(&drawn(&needle, TextRendering::Strokes)), &["shortened", "60 mm"]);
}

/// The dimensions of the cutter stand in the detail, and those of the holder in the whole view.
#[test]
fn assemblies_have_a_detail() {
    let tool = checked("ball_er16");
    for content in [Content::Outline, Content::Regions] {
        let drawing = svg(&tool, content, TextRendering::Strokes);
        well_formed(&drawing);
        let detail = ["A", "A (2 : 1)", "cutter.ball R3", "18 mm", "nut.nut ⌀28", "47.5 mm"];
        assert_has(&texts(&drawing), &detail);
    }
}

/// Each section has its own overall dimensions, unless another view has them already.
#[test]
fn solids_are_drawn_in_three_sections() {
    let tool = checked("block");
    for content in [Content::Outline, Content::Regions] {
        let drawing = svg(&tool, content, TextRendering::Strokes);
        well_formed(&drawing);
        let texts = texts(&drawing);
        let sections = ["section y = 0", "section x = 0", "section z = 10"];
        let sides = ["x 40 (-20 to 20)", "y 30 (-15 to 15)", "z 20 (0 to 20)"];
        for text in [sections, sides].concat() {
            let count = texts.iter().filter(|own| *own == text).count();
            assert_eq!(count, 1, "{content:?}: {text} in {texts:?}");
        }
        explains_surfaces(&tool, &texts);
    }
}

#[test]
fn the_documentation_includes_the_drawing() {
    let tool = checked("unit_sphere");
    let drawing = svg(&tool, Content::Regions, TextRendering::Page);
    assert!(emit::with_drawing(&tool, &drawing).to_string().contains("doc = \"<div><svg"));
    assert!(!emit::emit(&tool).to_string().contains("svg"));
}

#[test]
fn the_exact_fig_7_3() {
    // One line per element, so that a difference can be read.
    let drawing = drawn(&checked("fig_7_3_exact"), TextRendering::Page).replace('>', ">\n");
    insta::with_settings!({ omit_expression => true }, {
        insta::assert_snapshot!("drawing_fig_7_3_exact", drawing);
    });
}
