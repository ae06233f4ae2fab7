//! One tool in all notations is one solid, and fig. 7.3 of Ho (1999) from a tool library is the tool by hand.

use crate::libraries;
use serde_json::{Value, json};
use touchoff::Level;
use touchoff::tool::{Evaluations, Interpreted, Outputs, PointBatch, Tool};
use touchoff_dsl::source::Source;
use touchoff_import::Library;
use touchoff_tests::count::case_count;
use touchoff_tests::fusion;
use touchoff_tests::oracle::rng::Rng;

/// Number of points per comparison; the variable `POINTS` changes it.
const POINTS: usize = 20_000;

/// Returns the first tool of a library.
pub(super) fn load(name: &str, text: &str) -> Interpreted {
    let library = Library::parse(name.as_ref(), text.as_bytes()).expect("a library");
    let tool = library.tools().first().unwrap_or_else(|| panic!("{name}: {:?}", library.skipped()));
    tool.load().unwrap_or_else(|error| panic!("{name}: {error}\n{:?}", tool.files))
}

/// A ball end mill of 6 mm as six systems state it.
fn ball() -> [(&'static str, String); 6] {
    let dimensions = json!({ "DC": 6, "RE": 3, "SFDM": 6, "OAL": 50, "shoulder-diameter": 6 });
    let fusion = fusion::tool("ball end mill", &dimensions);
    let kiri = json!([{ "number": 1, "type": "ballmill", "name": "ball", "metric": true, "shaft_diam": 6,
        "shaft_len": 30, "flute_diam": 6, "flute_len": 20, "taper_tip": 0 }]);
    let camotics =
        json!({ "1": { "units": "metric", "shape": "ballnose", "length": 50, "diameter": 6 } });
    let hsm = r#"<tool-library><tool type="ball end mill" unit="millimeters"><body diameter="6" corner-radius="3"
        flute-length="20" overall-length="50" shaft-diameter="6"/></tool></tool-library>"#;
    [
        ("fusion.json", json!({ "data": [fusion] }).to_string()),
        ("ball.fctb", libraries::bit("ballend", &[]).to_string()),
        ("l.hsmlib", hsm.to_owned()),
        ("p.apt", "UNITS/MM\nCUTTER/6,3,0,3,0,0,50\nFINI\n".to_owned()),
        ("kiri.json", kiri.to_string()),
        ("camotics.json", camotics.to_string()),
    ]
}

/// Returns the depth of each point, negative outside.
fn depths(tool: &Interpreted, points: &PointBatch, list: &[[f64; 3]]) -> Vec<f64> {
    let mut evaluations = Evaluations::default();
    tool.evaluate(Level::new(), Outputs::EVERYTHING, points, 1.0, &mut evaluations);
    let is_inside = |k: usize| evaluations.inside[k / 8] >> (k % 8) & 1 == 1;
    let depth = |(k, point): (usize, &[f64; 3])| {
        if is_inside(k) { evaluations.depth[k] } else { -tool.clearance(*point) }
    };
    list.iter().enumerate().map(depth).collect()
}

/// Asserts that depth and clearance are the same to so many ulp(S) at random points in and around both tools, S being
/// the tool's size.
pub(super) fn assert_same_solid(name: &str, [a, b]: [&Interpreted; 2], limit: f64) {
    let reach = a.info().reach();
    let (radius, size) = (a.info().radius(), (reach.high - reach.low).max(a.info().radius()));
    // The distance from S to the next double.
    let ulp = f64::from_bits(size.to_bits() + 1) - size;
    let margin = 0.05 * size;
    let mut rng = Rng::new(7);
    let count = case_count("POINTS", POINTS);
    let point = |_| {
        let (d, angle) = (rng.between(0.0, radius + margin), rng.between(-3.2, 3.2));
        let z = rng.between(reach.low - margin, reach.high + margin);
        [d * angle.cos(), d * angle.sin(), z]
    };
    let list: Vec<[f64; 3]> = (0..count).map(point).collect();
    let mut points = PointBatch::default();
    list.iter().for_each(|point| points.push(*point));
    let [x, y] = [a, b].map(|tool| depths(tool, &points, &list));
    let inside = x.iter().filter(|depth| **depth > 0.0).count();
    let worst = x.iter().zip(&y).map(|(x, y)| (x - y).abs()).fold(0.0, f64::max) / ulp;
    println!("{name}: {count} points, {inside} inside; largest difference {worst:.2} ulp(S)");
    assert!(inside * 5 > count && inside * 20 < count * 19, "{name}: {inside} of {count}");
    assert!(worst <= limit, "{name}: depths differ by {worst} ulp(S)");
}

#[test]
fn a_ball_end_mill_is_one_solid_in_all_notations() {
    let by_hand = Interpreted::parse(&Source::new(
        "ball.tool",
        "tool Ball { units mm; profile { start (0, 0); arc to (3, 3) center (0, 3) as ball cutting;
         line to (3, 50), (0, 50) as shank; } }",
    ));
    let by_hand = by_hand.expect("a tool");
    for (name, text) in ball() {
        assert_same_solid(name, [&load(name, &text), &by_hand], 1.0);
    }
}

/// The library's tool has its tip at z = 0; its housing begins above the taper and the spindle.
#[test]
fn fig_7_3_from_a_library_is_the_tool_by_hand() {
    let segment = |height: f64, lower: f64, upper: f64| json!({ "height": height, "lower-diameter": lower, "upper-diameter": upper });
    let mut tool: Value = fusion::tool(
        "ball end mill",
        &json!({ "DC": 2, "RE": 1, "LCF": 5, "shoulder-length": 5, "shoulder-diameter": 2, "LB": 5,
            "SFDM": 2, "OAL": 20 }),
    );
    tool["holder"] = json!({ "type": "holder", "unit": "millimeters", "description": "spindle and housing",
        "segments": [segment(2.0, 2.0, 6.0), segment(2.0, 6.0, 6.0), segment(11.0, 10.0, 10.0)] });
    let imported = load("fig73.json", &json!({ "data": [tool] }).to_string());
    let by_hand = Interpreted::load(concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../tools-library/tools/fig_7_3_exact.tool"
    ));
    assert_same_solid("fig. 7.3", [&imported, &by_hand.expect("the library's tool")], 1.0);
}
