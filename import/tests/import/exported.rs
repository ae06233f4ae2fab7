//! Exported tools, imported again, are the same solids: by depth at random points, not by the outlines that the export
//! compares itself.

use crate::notations::{assert_same_solid, load};
use touchoff::Tool;
use touchoff::tool::Interpreted;
use touchoff_import::export::{Export, Format, export};
use touchoff_tests::library::library;

/// Largest difference in ulp(S). Angles are computed from corners, and the corners from angles again.
const LIMIT: f64 = 8.0;

fn write(tool: &Interpreted, format: Format) -> Export {
    export(&[tool.info()], format)
}

/// Every library tool with a profile that Fusion 360 can express.
#[test]
fn library_tools_return_from_fusion() {
    let mut types = Vec::new();
    for source in library() {
        let Ok(tool) = Interpreted::parse(&source) else { continue };
        let exported = write(&tool, Format::Fusion);
        let name = &tool.info().name;
        match &exported.tools[0].kind {
            Ok(kind) => {
                types.push(format!("{name}: {kind}"));
                assert_same_solid(name, [&load("l.json", &exported.text), &tool], LIMIT);
            }
            Err(reason) => types.push(format!("{name} left out: {reason}")),
        }
    }
    insta::assert_snapshot!("fusion", types.join("\n"));
}

/// Cutters without a holder return whole from FreeCAD, and those that end with their flutes from APT.
#[test]
fn cutters_return_from_freecad_and_apt() {
    let cutter = |profile: &str| {
        let text = format!("tool T {{ units mm; profile {{ start (0, 0); {profile} }} }}");
        let tool = Interpreted::parse(&touchoff_dsl::source::Source::new("t.tool", &text));
        tool.unwrap_or_else(|error| panic!("{error}"))
    };
    let (sin, cos) = 10f64.to_radians().sin_cos();
    let (low, wide) = (1.0 - sin, cos + (11.0 + sin) * sin / cos);
    let tapered = format!(
        "arc to ({cos}, {low}) center (0, 1) as ball cutting; line to ({wide}, 12), (0, 12) as flute cutting;"
    );
    let profiles = [
        ("endmill", "line to (3, 0), (3, 20), (0, 20) as flute cutting;"),
        (
            "ballend",
            "arc to (3, 3) center (0, 3) as ball cutting; line to (3, 20), (0, 20) as flute cutting;",
        ),
        (
            "bullnose",
            "line to (2, 0) as face cutting; arc to (3, 1) center (2, 1) as corner cutting;
             line to (3, 20), (0, 20) as flute cutting;",
        ),
        ("v-bit", "line to (3, 3), (3, 20), (0, 20) as flute cutting;"),
        ("taperedballnose", &tapered),
    ];
    for (shape, profile) in profiles {
        let tool = cutter(profile);
        for (format, file) in [(Format::FreeCad, "t.fctb"), (Format::Apt, "t.apt")] {
            let exported = write(&tool, format);
            let kind = exported.tools[0].kind.as_ref().unwrap_or_else(|e| panic!("{shape}: {e}"));
            assert!(kind == shape || kind == "CUTTER", "{shape}: {kind}");
            assert_eq!(exported.tools[0].gaps, [""; 0], "{shape} in {file}");
            assert_same_solid(shape, [&load(file, &exported.text), &tool], LIMIT);
        }
    }
}

#[test]
fn tools_without_an_equal_are_left_out() {
    let parse = |text: &str| {
        Interpreted::parse(&touchoff_dsl::source::Source::new("t.tool", text)).expect("a tool")
    };
    let reason = |text: &str, format| {
        let exported = write(&parse(text), format);
        exported.tools[0].kind.clone().expect_err("no equal in the format")
    };
    let by_hand = "tool T { units mm; region ball where hypot(d, z - 3) <= 3 { depth: 3 - hypot(d, z - 3); } }";
    assert!(reason(by_hand, Format::Fusion).contains("no profile"));
    let dull =
        "tool T { units mm; profile { start (0, 0); line to (3, 0), (3, 9), (0, 9) as body; } }";
    assert!(reason(dull, Format::Apt).contains("cutting"));
    let dished = "tool T { units mm; profile { start (0, 1); line to (3, 0), (3, 9), (0, 9) as body cutting; } }";
    assert!(reason(dished, Format::Apt).contains("CUTTER"));
    assert!(reason(dished, Format::FreeCad).contains("FreeCAD"));
}
