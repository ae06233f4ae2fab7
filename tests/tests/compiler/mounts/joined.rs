//! Mounted files, against the same tool written as one profile.

use super::{mounts, same, tool};
use touchoff_dsl::CheckedTool;
use touchoff_dsl::interpret::Interpreter;
use touchoff_tests::oracle::restated::Restated;

/// Returns the tool of one profile, by its [drawing][Restated::drawn], the surfaces that cut and the laws.
fn written(drawing: &'static str, cutting: &'static str, laws: &str) -> Box<CheckedTool> {
    let drawn = Restated::drawn("T", drawing, &[]).cuts(cutting);
    let profile = drawn.text(|number| number.to_f64().to_string());
    tool(&mounts(&format!("{profile} {laws}")))
}

fn names(tool: &CheckedTool) -> Vec<&str> {
    tool.model.regions.iter().map(|region| region.name.as_str()).collect()
}

fn surfaces(tool: &CheckedTool) -> Vec<&str> {
    tool.model.surfaces.iter().map(|surface| surface.name.as_str()).collect()
}

const BALL_IN_NUT: &str =
    "0 0; ball 3 3 about 0 3; flute 3 20; shank 3 30; nut 12.9 30, 14 31.1, 14 47.5, 0 47.5";

#[test]
fn a_cutter_in_a_nut_is_one_profile() {
    let joined = tool(&mounts(
        "param stickout = 30;
         mount \"ball.tool\" as cutter with D = 6, flute = 20;
         mount \"er16.tool\" as nut at z = stickout;",
    ));
    same(&joined, &written(BALL_IN_NUT, "ball flute", "niceness cutting: 1 - depth/3;"));
    assert_eq!(surfaces(&joined), ["cutter.ball", "cutter.flute", "cutter.shank", "nut.nut"]);
    let cutting = joined.model.surfaces.iter().map(|surface| surface.cutting);
    assert_eq!(cutting.collect::<Vec<_>>(), [true, true, false, false]);
    assert_eq!(names(&joined)[2..5], ["cutter.shank", "cutter.shank/nut.nut.1", "nut.nut.1"]);
}

/// Mounted files with the height of the upper one; and the drawing, the surfaces that cut and the laws of the same tool as
/// one profile. Behind each mount stand the values that it is given. In these rows
/// - the cutter's top is where the nut begins: nothing of it is left above;
/// - a face of several surfaces loses what is in the part below, in four ways;
/// - equal radii leave no ring, and a seam that is no corner;
/// - the plane cuts a cone;
/// - the cone ends at z = 12 and the collar begins there: the collar's lower face is dropped with it;
/// - the ball of radius 5 about z = 9 is cut below its middle and above it;
/// - the ring between the radii is a top face of the wider part below, and nothing of the pin's foot is left;
/// - a concave arc is cut, which rises on the other side of its centre.
const JOINED: &str = "\
ball + er16 at 50 => 0 0; ball 3 3 about 0 3; flute 3 20; shank 3 50; nut 12.9 50, 14 51.1, 14 67.5, 0 67.5 \
    => ball flute => niceness cutting: 1 - depth/3;
pin with d0 = 6 + stepped at 10 => 0 0; foot 3 0; pin 3 10; rim 5 10; body 5 19, 0 19 => =>
pin with d0 = 2 + stepped at 10 => 0 0; foot 1 0; pin 1 10; bore 2 10; rim 5 10; body 5 19, 0 19 => =>
pin with d0 = 4 + stepped at 10 => 0 0; foot 2 0; pin 2 10; rim 5 10; body 5 19, 0 19 => =>
pin with d0 = 12 + stepped at 10 => 0 0; foot 6 0; pin 6 10, 5 10; body 5 19, 0 19 => =>
ball + pin with d0 = 6 at 30 => 0 0; ball 3 3 about 0 3; flute 3 20; shank 3 30; pin 3 40, 0 40 \
    => ball flute => niceness cutting: 1 - depth/3;
cone + er16 at 6 => 0 0; face 2 0; cone 5 6; nut 12.9 6, 14 7.1, 14 23.5, 0 23.5 => face cone => niceness cone: 0.25;
cone + pin with d0 = 10 at 12 => 0 0; face 2 0; cone 8 12, 5 12; pin 5 22, 0 22 => face cone => niceness cone: 0.25;
bulb + er16 at 6 => 0 0; face 3 0; neck 3 5; ball 4 6 about 0 9; nut 12.9 6, 14 7.1, 14 23.5, 0 23.5 => ball =>
bulb + er16 at 12 => 0 0; face 3 0; neck 3 5; ball 5 9 about 0 9, 4 12 about 0 9; \
    nut 12.9 12, 14 13.1, 14 29.5, 0 29.5 => ball =>
er16 + pin with d0 = 2 at 10 => 0 0; nut 12.9 0, 14 1.1, 14 10, 1 10; pin 1 20, 0 20 => =>
neck + er16 at 2 => 0 0; face 5 0, 5 1; neck 4 2 about 8 5; nut 12.9 2, 14 3.1, 14 19.5, 0 19.5 => =>";

#[test]
fn mounted_files_are_the_same_tool_as_one_profile() {
    let mounted = |part: &str| {
        let (name, rest) = part.split_once(' ').unwrap_or((part, ""));
        let rest = rest.replace("at ", "at z = ");
        format!("mount \"{name}.tool\" as {name} {rest};")
    };
    for row in JOINED.lines() {
        println!("{row}");
        let parts: Vec<&str> = row.split("=>").map(str::trim).collect();
        let [files, drawing, cutting, laws] = parts[..] else { panic!("not a row") };
        let files: String = files.split(" + ").map(mounted).collect();
        let (joined, written) = (tool(&mounts(&files)), written(drawing, cutting, laws));
        same(&joined, &written);
        let own = surfaces(&joined).into_iter().map(|name| name.rsplit('.').next().unwrap_or(name));
        assert_eq!(own.collect::<Vec<_>>(), surfaces(&written));
    }
}

#[test]
fn an_inch_cutter_in_a_metric_nut() {
    let joined = tool(&mounts(
        "mount \"inch_flat.tool\" as cutter;
         mount \"er16.tool\" as nut at z = 1.5inch;
         niceness cutting: 1;",
    ));
    let written = written(
        "0 0; face 3.175 0; flute 3.175 19.05; shank 3.175 38.1;
         nut 12.9 38.1, 14 39.2, 14 55.6, 0 55.6",
        "face flute",
        "",
    );
    // The profile is traversed the other way in the turned frame, so surfaces are listed in another order.
    let mut order = surfaces(&joined);
    order.sort_unstable();
    assert_eq!(order, ["cutter.face", "cutter.flute", "cutter.shank", "nut.nut"]);
    let own = |name: &&str| name.replace("cutter.", "").replace("nut.nut", "nut");
    assert_eq!(names(&joined).iter().map(own).collect::<Vec<_>>(), names(&written));
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
    let names = "tool.cutter.ball tool.cutter.flute tool.cutter.shank tool.nut.nut body.body";
    assert_eq!(surfaces(&joined).join(" "), names);
    let names = "cutter.ball cutter.flute cutter.shank holder.nut.nut holder.body.body";
    assert_eq!(surfaces(&flat).join(" "), names);
}
