//! Mounted files, against the same tool written as one profile.

use super::{mounts, same, tool};
use touchoff_dsl::CheckedTool;
use touchoff_dsl::interpret::Interpreter;

/// Asserts that mounted files are the same tool as one profile, and returns it.
fn joins(mounted: &str, written: &str) -> Box<CheckedTool> {
    let joined = tool(&mounts(mounted));
    same(&joined, &tool(&mounts(written)));
    joined
}

fn names(tool: &CheckedTool) -> Vec<&str> {
    tool.model.regions.iter().map(|region| region.name.as_str()).collect()
}

const IN_ER16: &str = "tool T { units mm; let r = 6/2;
    profile {
        start (0, 0);
        arc  to (r, r) center (0, r)                           as ball  cutting;
        line to (r, 20)                                        as flute cutting;
        line to (r, 30)                                        as shank;
        line to (12.9, 30), (14, 31.1), (14, 47.5), (0, 47.5)  as nut;
    }
    niceness cutting: 1 - depth/r; }";

#[test]
fn a_cutter_in_a_nut_is_one_profile() {
    let joined = tool(&mounts(
        "param stickout = 30;
         mount \"ball.tool\" as cutter with D = 6, flute = 20;
         mount \"er16.tool\" as nut at z = stickout;",
    ));
    same(&joined, &tool(IN_ER16));
    let surfaces: Vec<(&str, bool)> =
        joined.model.surfaces.iter().map(|s| (s.name.as_str(), s.cutting)).collect();
    assert_eq!(
        surfaces,
        [
            ("cutter.ball", true),
            ("cutter.flute", true),
            ("cutter.shank", false),
            ("nut.nut", false)
        ]
    );
    assert_eq!(names(&joined)[2..5], ["cutter.shank", "cutter.shank/nut.nut.1", "nut.nut.1"]);
}

/// The cutter's top is where the nut begins: nothing of it is left above.
#[test]
fn a_plane_at_the_top_takes_the_top() {
    let joined =
        tool(&mounts("mount \"ball.tool\" as cutter; mount \"er16.tool\" as nut at z = 50;"));
    let written = IN_ER16.replace("30", "50").replace("31.1", "51.1").replace("47.5", "67.5");
    same(&joined, &tool(&written));
}

#[test]
fn an_inch_cutter_in_a_metric_nut() {
    let joined = tool(&mounts(
        "mount \"inch_flat.tool\" as cutter;
         mount \"er16.tool\" as nut at z = 1.5inch;
         niceness cutting: 1;",
    ));
    let written = tool(&mounts(
        "profile {
            start (0, 0);
            line to (3.175, 0)      as face  cutting;
            line to (3.175, 19.05)  as flute cutting;
            line to (3.175, 38.1)   as shank;
            line to (12.9, 38.1), (14, 39.2), (14, 55.6), (0, 55.6)  as nut;
        }",
    ));
    // The profile is traversed the other way in the turned frame, so surfaces are listed in another order.
    let mut order: Vec<&str> = joined.model.surfaces.iter().map(|s| s.name.as_str()).collect();
    order.sort_unstable();
    assert_eq!(order, ["cutter.face", "cutter.flute", "cutter.shank", "nut.nut"]);
    let regions = |tool: &CheckedTool| -> Vec<String> {
        names(tool)
            .iter()
            .map(|name| name.replace("cutter.", "").replace("nut.nut", "nut"))
            .collect()
    };
    assert_eq!(regions(&joined), regions(&written));
    let (mut a, mut b) = (Interpreter::new(&joined), Interpreter::new(&written));
    for k in 0..4000 {
        let p = [f64::from(k % 40) * 0.4, 0.01, f64::from(k / 40) * 0.61 - 1.0];
        match (a.evaluate(p, 1.0), b.evaluate(p, 1.0)) {
            (Some(a), Some(b)) => {
                assert!((a.depth - b.depth).abs() < 1e-13 && a.region == b.region);
            }
            (a, b) => assert_eq!(a.is_some(), b.is_some(), "{p:?}"),
        }
    }
}

/// The ring between the radii is a top face of the wider one below.
#[test]
fn a_wide_part_below_keeps_the_ring() {
    let joined = joins(
        "mount \"er16.tool\" as nut; mount \"pin.tool\" as pin with d0 = 2 at z = 10;",
        "profile {
            start (0, 0);
            line to (12.9, 0), (14, 1.1), (14, 10), (1, 10)  as nut;
            line to (1, 20), (0, 20)                         as pin;
        }",
    );
    // Nothing of the pin's foot is left.
    assert_eq!(joined.model.surfaces[1].name, "pin.pin");
}

/// A face of several surfaces loses what is in the part below.
#[test]
fn a_face_of_two_surfaces_keeps_its_rim() {
    let joined = |below: &str| {
        let mounts = format!(
            "mount \"pin.tool\" as pin with d0 = {below}; mount \"stepped.tool\" as s at z = 10;"
        );
        tool(&super::mounts(&mounts))
    };
    let written = |pieces: &str| {
        tool(&mounts(&format!(
            "profile {{
                start (0, 0);
                {pieces}
                line to (5, 19), (0, 19) as body;
            }}",
        )))
    };
    let thick = "line to (3, 0) as foot; line to (3, 10) as pin; line to (5, 10) as rim;";
    same(&joined("6"), &written(thick));
    let thin = "line to (1, 0) as foot; line to (1, 10) as pin;
                line to (2, 10) as bore; line to (5, 10) as rim;";
    same(&joined("2"), &written(thin));
    let even = "line to (2, 0) as foot; line to (2, 10) as pin; line to (5, 10) as rim;";
    same(&joined("4"), &written(even));
    let wide = "line to (6, 0) as foot; line to (6, 10), (5, 10) as pin;";
    same(&joined("12"), &written(wide));
}

/// Equal radii leave no ring, and a seam that is no corner.
#[test]
fn equal_radii_leave_no_ring() {
    joins(
        "mount \"ball.tool\" as cutter; mount \"pin.tool\" as pin with d0 = 6 at z = 30;",
        "profile {
            start (0, 0);
            arc  to (3, 3) center (0, 3) as ball  cutting;
            line to (3, 20)              as flute cutting;
            line to (3, 30)              as shank;
            line to (3, 40), (0, 40)     as pin;
        }
        niceness cutting: 1 - depth/3;",
    );
}

#[test]
fn the_plane_cuts_a_cone() {
    joins(
        "mount \"cone.tool\" as cone; mount \"er16.tool\" as nut at z = 6;",
        "profile {
            start (0, 0);
            line to (2, 0) as face cutting;
            line to (5, 6) as cone cutting;
            line to (12.9, 6), (14, 7.1), (14, 23.5), (0, 23.5)  as nut;
        }
        niceness cone: 0.25;",
    );
}

/// At z = 12 the cone ends and the collar begins: the collar's lower face is dropped with it.
#[test]
fn the_plane_runs_along_a_face() {
    joins(
        "mount \"cone.tool\" as cone; mount \"pin.tool\" as pin with d0 = 10 at z = 12;",
        "profile {
            start (0, 0);
            line to (2, 0)           as face cutting;
            line to (8, 12), (5, 12) as cone cutting;
            line to (5, 22), (0, 22) as pin;
        }
        niceness cone: 0.25;",
    );
}

/// The ball of radius 5 about z = 9, cut below its middle and above it.
#[test]
fn the_plane_cuts_an_arc() {
    joins(
        "mount \"bulb.tool\" as bulb; mount \"er16.tool\" as nut at z = 6;",
        "profile {
            start (0, 0);
            line to (3, 0)               as face;
            line to (3, 5)               as neck;
            arc  to (4, 6) center (0, 9) as ball cutting;
            line to (12.9, 6), (14, 7.1), (14, 23.5), (0, 23.5)  as nut;
        }",
    );
    joins(
        "mount \"bulb.tool\" as bulb; mount \"er16.tool\" as nut at z = 12;",
        "profile {
            start (0, 0);
            line to (3, 0)                as face;
            line to (3, 5)                as neck;
            arc  to (5, 9) center (0, 9)  as ball cutting;
            arc  to (4, 12) center (0, 9) as ball cutting;
            line to (12.9, 12), (14, 13.1), (14, 29.5), (0, 29.5)  as nut;
        }",
    );
}

/// A concave arc rises on the other side of its centre.
#[test]
fn the_plane_cuts_a_concave_arc() {
    let neck = "tool Neck { units mm; profile { start (0, 0); line to (5, 0), (5, 1) as face;
        arc to (3, 5) center (8, 5) concave as neck; line to (3, 9), (0, 9) as stem; } }";
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("neck.tool"), neck).expect("a writable folder");
    let nut = include_str!("tools/er16.tool");
    std::fs::write(folder.path().join("er16.tool"), nut).expect("a writable folder");
    let text = mounts("mount \"neck.tool\" as neck; mount \"er16.tool\" as nut at z = 2;");
    let source = touchoff_dsl::source::Source::new("own.tool", text);
    let compiled = touchoff_dsl::compile(&source.with_path(folder.path().join("own.tool")));
    let joined = compiled.into_tool().expect("a tool without errors");
    let written = tool(&mounts(
        "profile {
            start (0, 0);
            line to (5, 0), (5, 1)               as face;
            arc  to (4, 2) center (8, 5) concave as neck;
            line to (12.9, 2), (14, 3.1), (14, 19.5), (0, 19.5)  as nut;
        }",
    ));
    same(&joined, &written);
}

/// A holder of two files, in another unit, is mounted as one.
#[test]
fn mounted_files_mount_files() {
    let joined = tool(&mounts(
        "mount \"clamped.tool\" as tool with D = 4;
         mount \"body.tool\" as body at z = 47.5;",
    ));
    let flat = tool(&mounts(
        "mount \"ball.tool\" as cutter with D = 4;
         mount \"holder.tool\" as holder at z = 30;
         niceness cutter.flute: 0.75;",
    ));
    same(&joined, &flat);
    let surfaces = |tool: &CheckedTool| -> Vec<String> {
        tool.model.surfaces.iter().map(|s| s.name.clone()).collect()
    };
    assert_eq!(
        surfaces(&joined),
        ["tool.cutter.ball", "tool.cutter.flute", "tool.cutter.shank", "tool.nut.nut", "body.body"]
    );
    assert_eq!(
        surfaces(&flat),
        ["cutter.ball", "cutter.flute", "cutter.shank", "holder.nut.nut", "holder.body.body"]
    );
}
