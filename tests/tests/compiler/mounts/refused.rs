//! Mounts that are refused, each with its place and its message.

use super::{mounts, source};
use std::path::Path;
use touchoff_dsl::compile;
use touchoff_dsl::source::Source;
use touchoff_tests::texts::{assert_each_refused, assert_refused, rendered, with_one_error};

/// Asserts that each line of `cases` is refused: the items of a tool after `before`, and the words of its one error.
#[track_caller]
fn all_refused(before: &str, cases: &str) {
    let compiled = |items: &str| compile(&source(&mounts(&format!("{before} {items}"))));
    assert_each_refused(cases, |items| with_one_error(compiled(items)));
}

/// A mistake in a mounted file is shown there, and once though the file is mounted twice.
#[test]
fn rejects_files_that_cannot_be_mounted() {
    all_refused(
        "",
        r#"
mount "none.tool" as a; => cannot read `none.tool` | relative to the file
mount "regions.tool" as a; => `regions.tool` has regions but no profile and cannot be mounted
mount "plate.tool" as a; => `plate.tool` is a `solid` and cannot be mounted
mount "broken.tool" as a; => unknown name `length` |  broken.tool:5:18 | line to (length, 0)
mount "broken.tool" as a; mount "broken.tool" as b at z = 2; => unknown name
mount "no_semicolon.tool" as a; => `;` is missing |  no_semicolon.tool:3:
mount "off_tip.tool" as a; => the tool ends at z = 3, but `tip` is at z = 0 | off_tip.tool:1:6
mount "bad_law.tool" as a; => adds a length to an area | bad_law.tool:3:
mount "ring_a.tool" as a; => mounts itself | ring_a.tool mounts  | ring_b.tool mounts "#,
    );
    let text = mounts("mount \"er16.tool\" as a;");
    let nowhere = compile(&Source::new("t.tool", text));
    assert_refused(&nowhere, &["this text does not come from a file"]);
}

#[test]
fn the_compiled_file_is_part_of_the_mount_cycle() {
    let tools =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/compiler/mounts/tools/ring_b.tool");
    let compiled = compile(&Source::read(tools).expect("a file beside these tests"));
    assert_refused(&compiled, &["`ring_b.tool` mounts itself"]);
    assert_eq!(rendered(&compiled).matches(" mounts ").count(), 3, "{}", rendered(&compiled));
}

#[test]
fn rejects_mount_heights_that_do_not_join() {
    all_refused(
        r#"mount "ball.tool" as a;"#,
        r#"
mount "er16.tool" as nut at z = 60; => `a` is only 50 long and cannot stick out 60 | own.tool:1:
mount "er16.tool" as nut at z = 0; => `nut` at z = 0 is not above `a`
mount "er16.tool" as nut at z = -3; => is not above
mount "er16.tool" as b at z = 30; mount "body.tool" as c at z = 60; => `b` ends at z = 47.5 and does not reach z = 60
mount "er16.tool" as b at z = 30; mount "body.tool" as c at z = 20; => `c` at z = 20 is not above `b` at z = 30 | from the tip up"#,
    );
    all_refused(
        "",
        r#"
mount "waisted.tool" as a; mount "er16.tool" as b at z = 4; => the plane z = 4 cuts `a` more than once | waisted.tool: | second crossing
mount "pointed.tool" as a; mount "er16.tool" as b at z = 10; => `a` has radius 0 at z = 10
mount "er16.tool" as a; mount "ball.tool" as b at z = 10; => the first segment of `ball.tool` is not a flat face | ball.tool:
mount "er16.tool" as a; mount "hollow.tool" as b at z = 10; => the first segment of `hollow.tool` is not a flat face"#,
    );
}

#[test]
fn rejects_items_that_exclude_mounts() {
    all_refused(
        r#"mount "er16.tool" as nut;"#,
        r#"
tip z = 0; => a tool with mounts cannot set `tip` or `spindle`
profile { start (0, 0); line to (1, 0), (1, 5), (0, 5) as a; } => a tool has either a `profile` or mounts | profile of this file
region r where d <= 1 { depth: 1 - d; } => the profile already gives the depth
mount "body.tool" as body; => mount `body` has no position along the axis
mount "body.tool" as nut at z = 10; => two mounts are called `nut`
mount "body.tool" as body at z = 10deg; => `at` takes a length
mount "body.tool" as body at z = d; => `at` must be constant
mount "body.tool" at z = 10; => unexpected `at`"#,
    );
    all_refused(
        "",
        r#"
spindle -z; mount "er16.tool" as nut; => a tool with mounts cannot set `tip` or `spindle`
mount "er16.tool" as nut cutting; => a mount cannot be marked `cutting`
mount "er16.tool" as cutting; => a mount cannot be called `cutting`
mount "er16.tool" as nut at z = 3; => the first mount cannot have a position"#,
    );
}

#[test]
fn laws_name_the_parts_surfaces() {
    all_refused(
        r#"mount "ball.tool" as cutter;"#,
        r#"
magnitude ball: 3; => unknown surface `ball`
magnitude cutter: 3; => unknown surface `cutter` | write a surface of the mounted tool: `cutter.ball`, `cutter.flute`
niceness cutter.shank: 1; => `cutter.shank` is not marked `cutting`
magnitude cutter.flut: 3; => did you mean `cutter.flute`?"#,
    );
}

#[test]
fn rejects_too_many_mounts() {
    let many: String =
        (1..=64).map(|k| format!("mount \"pin.tool\" as p{k} at z = {k};")).collect();
    all_refused("", &format!("mount \"pin.tool\" as p; {many} => more than 64 mounted files"));
}
