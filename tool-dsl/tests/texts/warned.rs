//! Directions that are not those of steepest descent, and niceness that rises with depth. Both cause a
//! warning where they are certain, unless the file states that they are intended.

use std::path::PathBuf;
use touchoff_dsl::diagnostic::Severity;
use touchoff_dsl::prove::{CertainValue, Certificate};
use touchoff_dsl::source::Source;
use touchoff_dsl::{CheckedTool, Compiled, compile};

/// Returns a pin of 3 mm radius; its side is the nearest surface everywhere except at its ends.
fn pin(side: &str) -> String {
    format!(
        "tool Pin {{ units mm; curve side = 3 - d; curve low = z; curve high = 40 - z;
           region low where 0 <= low <= min(side, high) {{ depth: low; }}
           region high where 0 <= high <= min(side, low) {{ depth: high; }}
           region side as side cutting where 0 <= side <= min(low, high) {{ depth: side; {side} }} }}"
    )
}

fn profile(items: &str) -> String {
    format!(
        "tool Pin {{ units mm; profile {{ start (0, 0); line to (3, 0) as face cutting;
           line to (3, 20) as side cutting; line to (0, 20) as top; }} {items} }}"
    )
}

fn compiled(text: &str) -> Compiled {
    compile(&Source::new("pin.tool", text))
}

#[track_caller]
fn tool(text: &str) -> Box<CheckedTool> {
    let compiled = compiled(text);
    let reports = format!("{:#?}", compiled.diagnostics());
    compiled.into_tool().unwrap_or_else(|| panic!("{text}\n{reports}"))
}

/// Returns the warnings of the proof, each with the text of its location.
#[track_caller]
fn warned(text: &str) -> Vec<(String, String)> {
    let tool = tool(text);
    let reports = Certificate::prove(&tool).diagnostics(&tool);
    let said = reports.into_iter().map(|report| {
        assert_eq!(report.severity, Severity::Warning);
        assert!(report.help().contains("allow "));
        (report.message(), text[report.span.start..report.span.end].to_owned())
    });
    said.collect()
}

#[test]
fn a_direction_that_is_not_the_steepest_way_out_is_warned_of() {
    for (direction, angle) in [("(0, 1)", "90°"), ("(1, 1)", "45°"), ("(1, 0.001)", "0.0572958°")]
    {
        let written = format!("direction: {direction};");
        let said = warned(&pin(&written));
        let [(message, place)] = said.as_slice() else { panic!("{said:#?}") };
        let start =
            format!("the direction of side is {angle} off the steepest descent of its depth at (");
        assert!(message.starts_with(&start), "{message}");
        assert_eq!(*place, written);
    }
}

#[test]
fn the_largest_angle_is_given_with_its_place() {
    // The direction is exact where z is small, and increasingly oblique above.
    let tool = tool(&pin("direction: (40, z);"));
    let facts = &Certificate::prove(&tool).regions[2];
    let CertainValue { value: angle, point: [_, _, z] } =
        facts.oblique_witness.expect("the direction is oblique");
    assert!((angle.tan() - z / 40.0).abs() < 1e-12 && z > 38.0, "{angle} at {z}");
    assert!(facts.direction_error.is_some_and(|aside| aside.high >= angle));
}

#[test]
fn a_direction_that_leads_inward_is_warned_of() {
    let said = warned(&pin("direction: (-1, 0);"));
    assert!(said[0].0.starts_with("the direction of side points straight inward at ("), "{said:?}");
}

#[test]
fn the_steepest_way_out_is_not_warned_of() {
    for side in ["", "direction: (1, 0);", "direction: (3 - d, 0);", "direction: (1, 0.00005);"] {
        assert_eq!(warned(&pin(side)), [], "{side}");
    }
    for regions in ["", "regions nearest;", "regions smooth 0.5;"] {
        assert_eq!(warned(&profile(regions)), [], "{regions}");
    }
}

#[test]
fn an_oblique_direction_that_is_meant_is_not_warned_of_and_certified_all_the_same() {
    let text = pin("direction: (1, 1) allow oblique;");
    assert_eq!(warned(&text), []);
    let facts = Certificate::prove(&tool(&text)).regions.remove(2);
    let aside = facts.direction_error.expect("the direction is known").high.to_degrees();
    assert!((aside - 45.0).abs() < 1e-9, "{aside}");
}

#[test]
fn regions_of_a_profile_are_held_to_its_depth() {
    let split = |low: &str| {
        profile(&format!("region low where z <= 10 {{ {low} }} region high where z >= 10 {{}}"))
    };
    let said = warned(&split("direction: (0, -1);"));
    let [(message, place)] = said.as_slice() else { panic!("{said:#?}") };
    assert!(message.starts_with("the direction of low is 90° off"), "{message}");
    assert_eq!(place, "direction: (0, -1);");
    // Beside the note that one force law does not use it.
    let compiled = compiled(&split("direction: (0, -1);"));
    let mut codes: Vec<&str> = compiled.diagnostics().iter().map(|found| found.code()).collect();
    codes.sort_unstable();
    assert_eq!(codes, ["T0621", "T0629"]);
    assert_eq!(warned(&split("direction: (0, -1) allow oblique;")), []);
    // The gradient of a magnitude is a direction too.
    let said = warned(&split("magnitude: 3 - d;"));
    assert_eq!(said[0].1, "3 - d");
    assert_eq!(warned(&split("magnitude: depth^2;")), []);
}

#[test]
fn niceness_that_rises_with_depth_is_warned_of() {
    let said = warned(&pin("niceness: 1 - (3 - 2*depth)/10;"));
    let [(message, place)] = said.as_slice() else { panic!("{said:#?}") };
    assert!(message.starts_with("`niceness` of side increases with depth at ("), "{message}");
    assert!(message.ends_with("), by 0.2 per mm"), "{message}");
    assert_eq!(place, "1 - (3 - 2*depth)/10");
    // One law gives one warning, even for two surfaces.
    assert_eq!(warned(&profile("niceness cutting: depth;")).len(), 1);
    // It rises only up to half a millimetre.
    assert_eq!(warned(&profile("niceness side: depth*(1 - depth);")).len(), 1);
}

#[test]
fn niceness_that_is_meant_or_falls_or_does_not_count_is_not_warned_of() {
    for side in [
        "",
        "niceness: 0.5;",
        "niceness: 1 - depth/3;",
        "niceness: z/40;",
        "niceness: depth allow rising;",
        "niceness: depth - 4;",
    ] {
        assert_eq!(warned(&pin(side)), [], "{side}");
    }
    assert_eq!(warned(&profile("niceness cutting: depth allow rising;")), []);
    assert_eq!(warned(&profile("niceness side, face: depth/3 allow rising;")), []);
}

#[test]
fn niceness_that_may_rise_comes_along_with_a_mounted_file() {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("warned");
    std::fs::create_dir_all(&folder).expect("cargo's target folder can be written to");
    for (name, law, warnings) in [("meant", "depth allow rising", 0), ("not_meant", "depth", 1)] {
        let part = profile(&format!("niceness side: {law};"));
        std::fs::write(folder.join(format!("{name}.tool")), part).expect("a writable folder");
        let text = format!("tool Whole {{ units mm; mount \"{name}.tool\" as pin; }}");
        let compiled =
            compile(&Source::new("whole.tool", text).with_path(folder.join("whole.tool")));
        let tool = compiled.into_tool().expect("a tool");
        assert_eq!(Certificate::prove(&tool).diagnostics(&tool).len(), warnings, "{name}");
    }
}

#[test]
fn regions_by_hand_are_warned_of_while_they_are_compiled() {
    let said = |side: &str| -> Vec<String> {
        let compiled = compiled(&pin(side));
        assert!(compiled.tool().is_some());
        let found = compiled.diagnostics().iter();
        let warnings = found.filter(|report| report.severity == Severity::Warning);
        warnings.map(|report| report.message()).collect()
    };
    let both = said("direction: (0, 1); niceness: depth/3;");
    assert_eq!(both.len(), 2, "{both:?}");
    assert!(both[0].contains("90°") && both[1].contains("increases with depth"), "{both:?}");
    assert_eq!(said("direction: (0, 1) allow oblique; niceness: depth allow rising;"), [""; 0]);
}

#[test]
fn what_cannot_be_allowed_is_refused_with_the_words_that_can() {
    for (side, written) in [
        ("direction: (1, 0) allow slanted;", "slanted"),
        ("direction: (1, 0) allow rising;", "rising"),
        ("niceness: 1 allow oblique;", "oblique"),
        ("magnitude: depth allow rising;", "rising"),
        ("direction: (1, 0); niceness: 1 allow falling;", "falling"),
    ] {
        let text = pin(side);
        let compiled = compiled(&text);
        let Err(refusal) = &compiled.outcome else { panic!("{side}") };
        let errors: Vec<_> = refusal.errors().collect();
        assert_eq!(errors.len(), 1, "{side}: {errors:?}");
        assert_eq!(errors[0].message(), format!("`allow {written}` is not valid here"));
        let span = errors[0].span;
        assert_eq!(text[span.start..span.end], format!("allow {written}"));
        let help = errors[0].help();
        assert!(help.contains("allow oblique") && help.contains("allow rising"), "{help}");
    }
    let law = compiled(&profile("magnitude: depth allow rising;"));
    assert_eq!(law.diagnostics()[0].message(), "`allow rising` is not valid here");
}

#[test]
fn a_misspelt_allow_is_told_what_would_fit() {
    for side in ["direction: (1, 0) alow oblique;", "niceness: 1 alow rising;"] {
        let compiled = compiled(&pin(side));
        let Err(refusal) = &compiled.outcome else { panic!("{side}") };
        let first = &refusal.diagnostics()[0];
        assert_eq!(first.message(), "unexpected `alow`");
        assert!(first.help().contains("`allow`"), "{first:?}");
    }
}

#[test]
fn allow_is_a_name_where_one_stands() {
    let text =
        pin("niceness: allow allow rising;").replace("curve side", "let allow = 1; curve side");
    assert_eq!(warned(&text), []);
}

/// Magnitudes and nicenesses that are divided by 0 between samples or on the surface, and ranges of niceness.
#[test]
fn laws_without_a_value_or_out_of_range_are_reported() {
    let flute = "profile { start (0, 0); line to (3, 0) as face; line to (3, 20) as flute cutting; line to (0, 20) as top; }";
    let plain = flute.replace(" cutting", "");
    for (items, expected) in [
        (format!("{flute} niceness flute: 1mm/(d - 1.6180339mm);"), "T0612"),
        (format!("{flute} niceness flute: 1mm/(z - 10.1234mm);"), "T0612"),
        (format!("{flute} magnitude: depth/(2*(3 - d));"), "T0612"),
        (format!("{flute} niceness flute: depth/3 - 2;"), "T0625"),
        (format!("{flute} niceness flute: 5 - depth;"), "T0626"),
        (format!("{plain} niceness cutting: 1;"), "T0439"),
        (format!("{flute} niceness flute: 0;"), ""),
        (format!("{flute} niceness flute: 1/(1 + d);"), ""),
    ] {
        let compiled = compiled(&format!("tool T {{ units mm; {items} }}"));
        let codes: Vec<_> = compiled.diagnostics().iter().map(|found| found.code()).collect();
        assert_eq!(codes.first().copied().unwrap_or_default(), expected, "{items}: {codes:?}");
    }
}

/// Returns the codes about the force law `gradient` for a profile with a law, and for a pin with a property of its side.
fn of_force(law: &str, property: &str) -> [Vec<String>; 2] {
    [profile(law), pin(property)].map(|text| {
        let compiled = compiled(&text);
        let found = compiled.diagnostics().iter();
        let found = found.filter(|one| ("T0627".."T0630").contains(&one.code()));
        found.map(|one| format!("{} {:?} {}", one.code(), one.severity, one.message())).collect()
    })
}

#[test]
fn a_magnitude_without_a_slope_is_warned_of_once() {
    let [of_law, of_region] = of_force("magnitude: 5;", "magnitude: 5;");
    let said = "T0627 Warning `magnitude` of";
    assert!(matches!(&of_law[..], [one] if one.starts_with(said)), "{of_law:?}");
    assert!(matches!(&of_region[..], [one] if one.contains("of side is the same at every depth")));
    // No force is meant by a magnitude of 0.
    assert_eq!(of_force("magnitude: 0;", "magnitude: 0;").concat(), Vec::<String>::new());
}

#[test]
fn a_slope_that_counts_is_noted() {
    let [of_law, of_region] = of_force("magnitude: 2*depth;", "magnitude: 0.5*depth;");
    assert!(of_law.concat().starts_with("T0628 Note the slope of `magnitude` of"), "{of_law:?}");
    assert!(of_law.concat().contains(" is 2 per mm at ("), "{of_law:?}");
    assert!(of_region.concat().contains("of side is 0.5 per mm at ("), "{of_region:?}");
    for law in ["", "magnitude: depth;", "magnitude: depth + 1;"] {
        assert_eq!(of_force(law, law).concat(), Vec::<String>::new(), "{law}");
    }
}

#[test]
fn a_direction_that_is_not_used_is_noted() {
    let [_, of_region] = of_force("", "direction: (1, 1) allow oblique;");
    let said =
        "T0629 Note the direction of side is 45° off the steepest descent of its magnitude at (";
    assert!(of_region.concat().starts_with(said), "{of_region:?}");
    for used in ["direction: (1, 0);", "direction: (3 - d, 0);"] {
        assert_eq!(of_force("regions smooth 0.5;", used).concat(), Vec::<String>::new(), "{used}");
    }
}
