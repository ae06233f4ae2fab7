//! The niceness that comes with a mounted file.

use super::{mounts, tool};
use touchoff_dsl::interpret::Interpreter;

fn evaluation(text: &str, p: [f64; 3]) -> (f64, f64) {
    let tool = tool(text);
    let evaluation = Interpreter::new(&tool).evaluate(p, 1.0).expect("inside");
    (evaluation.magnitude, evaluation.niceness)
}

/// The file's law uses its own radius and z in inches, with z = 2 at the tip and the spindle toward smaller z. It keeps its
/// frame when mounted farther up, by files in two units.
#[test]
fn a_law_keeps_its_unit_and_frame() {
    let text = mounts("mount \"inch_flat.tool\" as cutter; mount \"er16.tool\" as nut at z = 30;");
    assert_eq!(evaluation(&text, [0.0, 0.0, 0.25]).1, 0.5);
    let higher = mounts("mount \"pin.tool\" as pin; mount \"inch_flat.tool\" as mill at z = 5;");
    for (text, z) in [(text, 12.7), (higher, 17.7)] {
        let (magnitude, niceness) = evaluation(&text, [3.0, 0.0, z]);
        let depth = 0.125 - 3.0 / 25.4;
        assert!((niceness - (1.0 - depth / 0.125 + 0.5 / 8.0)).abs() < 1e-14, "{niceness}");
        // Its magnitude does not come along.
        assert!((magnitude - depth * 25.4).abs() < 1e-14, "{magnitude}");
    }
}

#[test]
fn a_law_uses_the_arguments_of_its_file() {
    let text = mounts(
        "let r = 60; mount \"ball.tool\" as cutter with D = 2*r/24; mount \"er16.tool\" as nut at z = 30;",
    );
    assert_eq!(evaluation(&text, [2.0, 0.0, 10.0]).1, 0.8);
}

#[test]
fn a_law_of_the_assembly_comes_first() {
    let with = |law: &str| {
        mounts(&format!(
            "mount \"ball.tool\" as cutter; mount \"er16.tool\" as nut at z = 30; {law}"
        ))
    };
    let flute = [2.0, 0.0, 10.0];
    assert!((evaluation(&with(""), flute).1 - 2.0 / 3.0).abs() < 1e-15);
    assert_eq!(evaluation(&with("niceness cutter.flute: 0.5;"), flute).1, 0.5);
    assert!((evaluation(&with("niceness cutter.ball: 0.5;"), flute).1 - 2.0 / 3.0).abs() < 1e-15);
    assert_eq!(evaluation(&with("niceness cutting: 0.25;"), flute).1, 0.25);
    assert_eq!(evaluation(&with("magnitude cutter . flute, nut.nut: 3*depth;"), flute).0, 3.0);
}
