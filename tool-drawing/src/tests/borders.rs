//! Borders of regions and of surfaces.

use super::{library, tool, whole};
use crate::paint;
use crate::picture::Picture;
use touchoff_dsl::expr::value::{EvaluationPoint, Evaluator};

/// The areas of the regions of the exact fig. 7.3 have closed forms.
#[test]
fn regions_have_their_areas() {
    let tool = library("fig_7_3_exact");
    let picture = whole(&tool);
    let sqrt = f64::sqrt(2.0);
    // The lines from (3, 13) and from (1, 15) to the axis.
    let spindle = 3.0 * (5.0 - 3.0 * sqrt) + 4.5 * (sqrt - 1.0);
    let taper = 10.0 - 0.5 - spindle;
    let expected =
        [12.5, 187.0 / 6.0, 2.0, 28.0 / 3.0, spindle, taper, 0.5, 4.0, std::f64::consts::FRAC_PI_4];
    // The profile runs from the tip upward; the thesis lists the regions from the housing downward.
    for (region, expected) in expected.into_iter().rev().enumerate() {
        let scale = picture.view.scale;
        let area = picture.shapes[region].area() / (scale * scale);
        let name = &tool.model.regions[region].name;
        // Areas are computed from chords that are a third of a sheet unit off at most.
        assert!((area - expected).abs() < 0.03, "{name}: {area}, not {expected}");
    }
}

/// Asserts that the regions' areas add up to that of the section, and that none is missing.
fn closed(picture: &Picture<'_>) {
    let mut sum = 0.0;
    for (region, shape) in picture.model.regions.iter().zip(&picture.shapes) {
        assert!(!shape.is_empty(), "{} is nowhere", region.name);
        sum += shape.area();
    }
    let whole = paint::material(picture).area();
    let name = &picture.model.name;
    assert!((sum - whole).abs() < 1e-3 * whole, "{name}: {sum}, not {whole}");
}

/// The regions of all these tools meet without a gap, whatever curves bound them.
#[test]
fn regions_are_closed() {
    let profiles = [
        "start (0, 0); line to (10.1, 0), (10.5, 0.4), (10.5, 9), (5, 9), (5, 29), (6, 30),
         (6, 74), (0, 74) as a;",
        "start (0, 0); line to (16, 0), (16, 12), (31.5, 12), (31.5, 20), (26.5, 22.5),
         (26.5, 27.5), (31.5, 30), (31.5, 38), (0, 38) as a;",
        "start (0, 0); arc to (5, 1) radius 20 as a; arc to (5, 13) radius 40 as b;
         line to (4, 15), (4, 40), (0, 40) as c;",
        "start (0, 0); line to (4, 0), (4, 20) as a; arc to (8, 24) radius 4 concave as b;
         line to (12, 24), (12, 32), (0, 32) as c;",
        "start (0, 0); arc to (3, 3) center (0, 3) as a; arc to (1.8, 5.4) center (0, 3) as a;
         line to (1.8, 30), (0, 30) as b;",
        // Kinks of 1e-6, to both sides.
        "start (0, 0); line to (5, 0), (5.00001, 10), (5, 20), (5.00001, 30), (0, 30) as a;",
    ];
    // A ball of chords, as CAD polylines have it.
    let mut chords = String::from("start (0, 0); line to ");
    for k in 1..=12 {
        let (sin, cos) = (f64::from(k) * std::f64::consts::PI / 24.0).sin_cos();
        chords += &format!("({:.9}, {:.9}), ", 5.0 * sin, 5.0 - 5.0 * cos);
    }
    chords += "(5, 30), (0, 30) as a;";
    for segments in profiles.into_iter().chain([&*chords]) {
        let text = format!("tool T {{ units mm; profile {{ {segments} }} }}");
        closed(&whole(&tool(&text)));
    }
    for name in ["half_sphere_cylinder", "fig_7_3", "unit_sphere"] {
        closed(&whole(&library(name)));
    }
}

/// Points within a region's area belong to it by the plan, whether the area is computed or traced.
#[test]
fn areas_belong_to_the_owners_of_their_points() {
    let smooth = tool(
        "tool T { units mm; profile { start (0, 0); line to (4, 0), (4, 20), (9, 20), (9, 32), (0, 32) as a; }
         regions smooth 0.5; }",
    );
    let names = [
        "ball_er16",
        "bull_nose",
        "fig_7_3",
        "half_sphere_cylinder",
        "lens",
        "oval",
        "t_slot",
        "thread_mill",
    ];
    let tools: Vec<_> = names.into_iter().map(library).chain([smooth]).collect();
    for tool in &tools {
        let picture = whole(tool);
        let values = tool.model.curves.iter().map(|curve| curve.value);
        let mut evaluator = Evaluator::new(&tool.model.graph, values);
        for i in 0..60 {
            for j in 0..200 {
                let at = [
                    (f64::from(i) + 0.5) / 60.0 * picture.view.half,
                    -f64::from(j) / 200.0 * picture.view.height,
                ];
                let [d, z] = picture.view.point(at);
                evaluator.evaluate(EvaluationPoint::on_meridian(d, z));
                let owner =
                    tool.tree.owner_at(&|curve| evaluator.get(tool.model.curves[curve].value));
                for (region, shape) in picture.shapes.iter().enumerate() {
                    // Break lines are lines of a shape, too.
                    let clearance = if shape.is_empty() { -1.0 } else { shape.clearance(at, 1.0) };
                    let (name, own) = (&tool.model.name, owner == Some(region));
                    assert!(
                        clearance.abs() < 0.3 || own == (clearance > 0.0),
                        "{name}: {region} at {d}, {z}: {clearance}"
                    );
                }
            }
        }
    }
}

/// The surface is connected: from the axis, from joint to joint, back to the axis.
#[test]
fn a_drawn_profile_matches_its_outline() {
    let text = r#"tool Slot "of a profile with an undercut and a fillet" {
        units mm;
        profile {
            start (0, 0);
            line to (6, 0)                          as face cutting;
            arc  to (7, 1) center (6, 1)            as corner cutting;
            line to (7, 4), (3, 4), (3, 8)          as side cutting;
            arc  to (5, 10) radius 2 concave        as neck;
            line to (9, 10), (9, 12), (0, 12)       as neck;
        }
    }"#;
    let tool = tool(text);
    let picture = whole(&tool);
    let mut points: Vec<[f64; 2]> = picture.section.surface().map(|stroke| stroke.from).collect();
    points.sort_by(|a, b| a[1].total_cmp(&b[1]).then(a[0].total_cmp(&b[0])));
    let expected = [
        [0.0, 0.0],
        [6.0, 0.0],
        [7.0, 1.0],
        [3.0, 4.0],
        [7.0, 4.0],
        [3.0, 8.0],
        [5.0, 10.0],
        [9.0, 10.0],
        [9.0, 12.0],
    ];
    assert_eq!(points.len(), expected.len(), "{points:?}");
    for (point, expected) in points.iter().zip(expected) {
        let distance = (point[0] - expected[0]).hypot(point[1] - expected[1]);
        assert!(distance < 1e-9, "{point:?}, not {expected:?}");
    }
    let arcs = picture.section.surface().filter_map(|stroke| stroke.circle);
    let arcs: Vec<f64> = arcs.map(|(_, radius)| radius).collect();
    assert_eq!(arcs.len(), 2);
    assert!(arcs.iter().all(|r| (r - 1.0).abs() < 1e-9 || (r - 2.0).abs() < 1e-9), "{arcs:?}");
}
