//! Mounts that are refused, each with its place and its message.

use super::{mounts, said, source};
use std::path::Path;
use touchoff_dsl::compile;
use touchoff_dsl::source::Source;

/// Asserts that there is one error, with all of `words`.
#[track_caller]
fn refused(items: &str, words: &[&str]) {
    let compiled = compile(&source(&mounts(items)));
    let said = said(&compiled);
    assert!(compiled.tool().is_none(), "taken: {items}");
    for word in words {
        assert!(said.contains(word), "`{word}` is missing in:\n{said}");
    }
    assert_eq!(said.matches("error[").count(), 1, "{said}");
}

#[test]
fn rejects_files_that_cannot_be_mounted() {
    refused("mount \"none.tool\" as a;", &["cannot read `none.tool`", "relative to the file"]);
    refused(
        "mount \"regions.tool\" as a;",
        &["`regions.tool` has regions but no profile and cannot be mounted"],
    );
    refused("mount \"plate.tool\" as a;", &["`plate.tool` is a `solid` and cannot be mounted"]);
    let text = mounts("mount \"er16.tool\" as a;");
    let nowhere = compile(&Source::new("t.tool", text));
    assert!(said(&nowhere).contains("this text does not come from a file"), "{}", said(&nowhere));
}

/// A mistake in a mounted file is shown there.
#[test]
fn mistakes_of_mounted_files() {
    refused(
        "mount \"broken.tool\" as a;",
        &["unknown name `length`", " broken.tool:5:18", "line to (length, 0)"],
    );
    refused("mount \"no_semicolon.tool\" as a;", &["`;` is missing", " no_semicolon.tool:3:"]);
    refused(
        "mount \"off_tip.tool\" as a;",
        &["the tool ends at z = 3, but `tip` is at z = 0", "off_tip.tool:1:6"],
    );
    refused("mount \"bad_law.tool\" as a;", &["adds a length to an area", "bad_law.tool:3:"]);
    // Reported once, though the file is mounted twice.
    refused("mount \"broken.tool\" as a; mount \"broken.tool\" as b at z = 2;", &["unknown name"]);
}

#[test]
fn files_that_mount_themselves() {
    refused(
        "mount \"ring_a.tool\" as a;",
        &["mounts itself", "ring_a.tool mounts ", "ring_b.tool mounts "],
    );
}

#[test]
fn the_compiled_file_is_part_of_the_mount_cycle() {
    let tools =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/compiler/mounts/tools/ring_b.tool");
    let compiled = compile(&Source::read(tools).expect("a file beside these tests"));
    let said = said(&compiled);
    assert!(said.contains("`ring_b.tool` mounts itself"), "{said}");
    assert_eq!(said.matches(" mounts ").count(), 3, "{said}");
}

#[test]
fn rejects_mount_heights_that_do_not_join() {
    let on_ball = |at: &str| {
        format!("mount \"ball.tool\" as cutter; mount \"er16.tool\" as nut at z = {at};")
    };
    refused(&on_ball("60"), &["`cutter` is only 50 long and cannot stick out 60", "own.tool:1:"]);
    refused(&on_ball("0"), &["`nut` at z = 0 is not above `cutter`"]);
    refused(&on_ball("-3"), &["is not above"]);
    refused(
        "mount \"ball.tool\" as a; mount \"er16.tool\" as b at z = 30; mount \"body.tool\" as c at z = 60;",
        &["`b` ends at z = 47.5 and does not reach z = 60"],
    );
    refused(
        "mount \"ball.tool\" as a; mount \"er16.tool\" as b at z = 30; mount \"body.tool\" as c at z = 20;",
        &["`c` at z = 20 is not above `b` at z = 30", "from the tip up"],
    );
    refused(
        "mount \"waisted.tool\" as a; mount \"er16.tool\" as b at z = 4;",
        &["the plane z = 4 cuts `a` more than once", "waisted.tool:", "second crossing"],
    );
    refused(
        "mount \"pointed.tool\" as a; mount \"er16.tool\" as b at z = 10;",
        &["`a` has radius 0 at z = 10"],
    );
    refused(
        "mount \"er16.tool\" as a; mount \"ball.tool\" as b at z = 10;",
        &["the first segment of `ball.tool` is not a flat face", "ball.tool:"],
    );
    refused(
        "mount \"er16.tool\" as a; mount \"hollow.tool\" as b at z = 10;",
        &["the first segment of `hollow.tool` is not a flat face"],
    );
}

#[test]
fn rejects_items_that_exclude_mounts() {
    let nut = "mount \"er16.tool\" as nut;";
    let profile = "profile { start (0, 0); line to (1, 0), (1, 5), (0, 5) as a; }";
    refused(&format!("{nut} tip z = 0;"), &["a tool with mounts cannot set `tip` or `spindle`"]);
    refused(&format!("spindle -z; {nut}"), &["a tool with mounts cannot set `tip` or `spindle`"]);
    refused(
        &format!("{nut} {profile}"),
        &["a tool has either a `profile` or mounts", "profile of this file"],
    );
    refused(
        &format!("{nut} region r where d <= 1 {{ depth: 1 - d; }}"),
        &["the profile already gives the depth"],
    );
    refused("mount \"er16.tool\" as nut cutting;", &["a mount cannot be marked `cutting`"]);
    refused("mount \"er16.tool\" as cutting;", &["a mount cannot be called `cutting`"]);
    refused("mount \"er16.tool\" as nut at z = 3;", &["the first mount cannot have a position"]);
    refused(
        &format!("{nut} mount \"body.tool\" as body;"),
        &["mount `body` has no position along the axis"],
    );
    refused(
        &format!("{nut} mount \"body.tool\" as nut at z = 10;"),
        &["two mounts are called `nut`"],
    );
    refused(&format!("{nut} mount \"body.tool\" as body at z = 10deg;"), &["`at` takes a length"]);
    refused(&format!("{nut} mount \"body.tool\" as body at z = d;"), &["`at` must be constant"]);
    refused(&format!("{nut} mount \"body.tool\" at z = 10;"), &["unexpected `at`"]);
}

#[test]
fn laws_name_the_parts_surfaces() {
    let ball = "mount \"ball.tool\" as cutter;";
    refused(&format!("{ball} magnitude ball: 3;"), &["unknown surface `ball`"]);
    refused(
        &format!("{ball} magnitude cutter: 3;"),
        &[
            "unknown surface `cutter`",
            "write a surface of the mounted tool: `cutter.ball`, `cutter.flute`",
        ],
    );
    refused(
        &format!("{ball} niceness cutter.shank: 1;"),
        &["`cutter.shank` is not marked `cutting`"],
    );
    refused(&format!("{ball} magnitude cutter.flut: 3;"), &["did you mean `cutter.flute`?"]);
}

#[test]
fn rejects_too_many_mounts() {
    let many: String =
        (1..=64).map(|k| format!("mount \"pin.tool\" as p{k} at z = {k};")).collect();
    refused(&format!("mount \"pin.tool\" as p; {many}"), &["more than 64 mounted files"]);
}
