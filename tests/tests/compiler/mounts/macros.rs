//! Mounts and given values in a program.

use touchoff::Tool;

touchoff::include_tool!("tests/compiler/mounts/tools/ball.tool");
touchoff::include_tool!(
    "tests/compiler/mounts/tools/ball.tool" as QuarterInchBall,
    D = 0.25inch,
    flute = 18
);
touchoff::include_tool!("tests/compiler/mounts/tools/ball.tool" as Thin, D = 2 * 1mm,);
touchoff::include_tool!("tests/compiler/mounts/tools/clamped.tool" as ClampedFour, D = 4);

touchoff::tool! {
    tool Inline "a ball cutter in a nut on a body" {
        units mm;
        mount "tools/ball.tool" as cutter with D = 6, flute = 18;
        mount "tools/holder.tool" as holder at z = 30;
        magnitude holder.nut.nut, holder.body.body: 2*depth;
        niceness cutter.ball: 0.5;
    }
}

fn radius(tool: &dyn Tool) -> f64 {
    tool.info().radius()
}

#[test]
fn one_file_is_several_tools() {
    let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-3, "{a}, not {b}");
    near(radius(&BallCutter), 3.0);
    near(radius(&QuarterInchBall), 3.175);
    near(radius(&Thin), 1.0);
    assert_eq!(QuarterInchBall.info().name, "QuarterInchBall");
    assert_eq!(ClampedFour.info().surfaces[0].name, "cutter.ball");
}

#[test]
fn an_inline_tool_mounts_files_beside_its_own() {
    let surfaces: Vec<&str> = Inline.info().surfaces.iter().map(|s| s.name.as_ref()).collect();
    let expected =
        ["cutter.ball", "cutter.flute", "cutter.shank", "holder.nut.nut", "holder.body.body"];
    assert_eq!(surfaces, expected);
    assert!((radius(&Inline) - 25.4).abs() < 1e-2);
}

/// Cargo builds these tests again when a mounted file changes, or one that it mounts.
#[test]
fn a_mounted_file_is_watched() {
    let own = std::env::current_exe().expect("a test knows its own place");
    let watched = std::fs::read_to_string(own.with_extension("d")).expect("cargo's list of inputs");
    for file in ["ball.tool", "clamped.tool", "er16.tool", "holder.tool", "body.tool"] {
        assert!(watched.contains(file), "{file} is not watched");
    }
}
