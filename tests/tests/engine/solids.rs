//! Solids without an axis: evaluations of the library's at stated points, and refusals of others.

use touchoff::Interval;
use touchoff::Unit;
use touchoff::tool::{Evaluators, PointEvaluation, Symmetry};
use touchoff_dsl::diagnostic::any_error;
use touchoff_dsl::interpret::Interpreter;
use touchoff_dsl::source::Source;
use touchoff_dsl::{CheckedTool, compile, compile_with_arguments};
use touchoff_tests::library;
use touchoff_tests::oracle::rng::Rng;
use touchoff_tests::oracle::{Body, Oracle};
use touchoff_tools::{Block, LBracket};

/// Returns the region and the depth at a point.
fn at<T: Evaluators>(p: [f64; 3]) -> Option<(&'static str, f64)> {
    let evaluation = T::evaluate_point(p, 1.0)?;
    Some((T::info().regions[evaluation.region].name.as_ref(), evaluation.depth))
}

/// Returns the evaluation at a point inside.
fn inside<T: Evaluators>(p: [f64; 3], length: f64) -> PointEvaluation {
    T::evaluate_point(p, length).unwrap_or_else(|| panic!("{p:?} is outside"))
}

#[test]
fn a_block_at_faces_edges_and_corners() {
    assert_eq!(at::<Block>([19.0, 1.0, 10.0]), Some(("right", 1.0)));
    assert_eq!(at::<Block>([-20.0, 1.0, 10.0]), Some(("left", 0.0)));
    assert_eq!(at::<Block>([3.0, 14.5, 9.0]), Some(("back", 0.5)));
    assert_eq!(at::<Block>([3.0, -15.0, 9.0]), Some(("front", 0.0)));
    assert_eq!(at::<Block>([3.0, 2.0, 2.5]), Some(("bottom", 2.5)));
    assert_eq!(at::<Block>([3.0, 2.0, 20.0]), Some(("top", 0.0)));
    // Edges and corners belong to the first listed, and to the solid.
    assert_eq!(at::<Block>([20.0, 15.0, 10.0]), Some(("right", 0.0)));
    assert_eq!(at::<Block>([20.0, 15.0, 20.0]), Some(("right", 0.0)));
    assert_eq!(at::<Block>([-20.0, -15.0, 0.0]), Some(("left", 0.0)));
    assert_eq!(at::<Block>([0.0, 15.0, 20.0]), Some(("back", 0.0)));
    assert_eq!(at::<Block>([18.0, 13.0, 10.0]), Some(("right", 2.0)));
    assert_eq!(at::<Block>([0.0, 0.0, 10.0]), Some(("bottom", 10.0)));
    for axis in 0..3 {
        let mut p = [20.0, 15.0, 20.0];
        p[axis] = f64::next_up(p[axis]);
        assert!(!Block::contains(p), "{p:?}");
    }
    let near_the_back = inside::<Block>([3.0, 14.5, 9.0], 1.0);
    assert_eq!(near_the_back.direction, [0.0, 1.0, 0.0]);
    assert_eq!(near_the_back.gradient, [0.0, -1.0, 0.0]);
    // A magnitude that is the depth, in the part's unit.
    assert_eq!(inside::<Block>([3.0, 2.0, 2.5], 2.0).magnitude, 5.0);
}

#[test]
fn a_bracket_at_its_hole_and_edges() {
    let assert_close = |p: [f64; 3], region: &str, depth: f64| {
        let (name, evaluation) = at::<LBracket>(p).unwrap_or_else(|| panic!("{p:?} is outside"));
        assert_eq!(name, region, "{p:?}");
        assert!(
            (evaluation - depth).abs() <= 32.0 * f64::EPSILON,
            "{p:?}: {evaluation}, not {depth}"
        );
    };
    assert_close([0.0, 0.0, 2.0], "lying_bottom", 2.0);
    assert_close([0.0, 9.0, 3.0], "lying_side", 1.0);
    assert_close([19.5, 0.0, 3.0], "lying_end", 0.5);
    assert_close([-7.5, 0.0, 15.0], "standing_back", 2.5);
    assert_close([-4.5, -2.0, 15.0], "standing_inner", 0.5);
    assert_close([-7.0, 9.5, 20.0], "standing_side", 0.5);
    assert_close([-7.0, 0.0, 23.0], "standing_top", 1.0);
    // In the heel the inner edge is nearer than either of its faces' planes would suggest.
    assert_close([-5.0, 0.0, 5.0], "heel_edge", 2f64.sqrt());
    assert_close([-7.0, 3.0, 2.0], "heel_bottom", 2.0);
    assert_close([-5.0, 9.25, 5.0], "heel_side", 0.75);
    // The wall of the hole, its rims, and half way through.
    assert_close([14.0, 0.0, 3.0], "bore", 0.7);
    assert_close([10.0, -4.3, 3.0], "bore", 1.0);
    assert_close([14.5, 0.0, 0.5], "lying_bottom", 0.5);
    for z in [0.0, 6.0] {
        assert!(!LBracket::contains([13.299_999, 0.0, z]));
        let (_, depth) = at::<LBracket>([13.300_001, 0.0, z]).expect("the rim");
        assert_eq!(depth, 0.0);
    }
    assert!(!LBracket::contains([10.0, 0.0, 3.0]) && !LBracket::contains([-3.9, 0.0, 6.1]));
    // Sheets of no thickness do not belong to it.
    for p in [[20.0, 0.0, 10.0], [0.0, 10.0, 10.0], [0.0, 0.0, 24.0], [10.0, 0.0, 0.0]] {
        assert!(!LBracket::contains(p), "{p:?}");
    }
    let toward = inside::<LBracket>([14.0, 0.0, 3.0], 1.0).direction;
    assert_eq!(toward, [-1.0, 0.0, 0.0]);
    let half = 0.5f64.sqrt();
    for (part, expected) in
        inside::<LBracket>([-5.0, 0.0, 5.0], 1.0).direction.into_iter().zip([half, 0.0, half])
    {
        assert!((part - expected).abs() < 1e-15);
    }
}

/// Outside, clearance is the distance to the solid's box: the true distance for a block, else a bound.
#[test]
fn clearance_is_that_of_the_box() {
    for oracle in [Body::Block, Body::LBracket] {
        let tool = library::tool(oracle.name());
        assert!(!tool.info().is_exact());
        let mut rng = Rng::new(8);
        for _ in 0..20_000 {
            let p = [0; 3].map(|_| rng.between(-40.0, 40.0));
            let (clearance, distance) = (tool.clearance(p), oracle.signed_distance(p));
            assert!(clearance <= distance.max(0.0), "{clearance} > {distance} at {p:?}");
            if oracle.name() == "Block" {
                assert!((clearance - distance.max(0.0)).abs() < 1e-9, "{clearance} {distance}");
            }
        }
    }
}

/// A block of any sides, given from outside, is divided as well.
#[test]
fn a_block_with_other_dimensions() {
    let block = library::source("block");
    for (w, l, h) in [(10, 50, 80), (30, 30, 30), (100, 1, 1)] {
        let given = [("w", w), ("l", l), ("h", h)]
            .map(|(name, value)| Source::new("a test", format!("{name} = {value}")));
        let compiled = compile_with_arguments(&block, &given);
        assert!(compiled.diagnostics().is_empty(), "{:?}", compiled.diagnostics());
        let tool = compiled.into_tool().expect("a block");
        let mut reference = Interpreter::new(&tool);
        let mut rng = Rng::new(7);
        let half = [w, l, h].map(|side| f64::from(side) / 2.0);
        for _ in 0..2_000 {
            let p = half.map(|half| rng.between(-half, half));
            let depth = (0..3).map(|k| half[k] - p[k].abs()).fold(f64::INFINITY, f64::min);
            let evaluation = reference.evaluate([p[0], p[1], p[2] + half[2]], 1.0).expect("inside");
            assert!(
                (evaluation.depth - depth).abs() < 1e-13,
                "{p:?}: {}, not {depth}",
                evaluation.depth
            );
        }
    }
}

/// Bounds are proved, and hardly wider than the solid.
#[test]
fn info_has_the_extents_of_solids() {
    let info = Block::info();
    assert_eq!(info.unit, Unit::Millimetre);
    let Symmetry::Solid { extent: [x, y] } = info.symmetry else { panic!("a solid") };
    let [z, radius] = [info.reach(), Interval::new(0.0, info.radius())];
    for (Interval { low, high }, [from, to]) in
        [x, y, z, radius].into_iter().zip([[-20.0, 20.0], [-15.0, 15.0], [0.0, 20.0], [0.0, 25.0]])
    {
        assert!(low <= from && low > from - 1e-3 && high >= to && high < to + 1e-3);
    }
    let info = LBracket::info();
    let Symmetry::Solid { extent: [x, y] } = info.symmetry else { panic!("a solid") };
    assert!(
        x.low <= -10.0 && x.high >= 20.0 && x.high < 20.001 && y.high >= 10.0 && y.high < 10.001
    );
    // The standing leg is slimmer than the lying one.
    let top = info.envelope.last().expect("slabs");
    assert!(top.low < 6.01 && top.radius >= 200f64.sqrt() && top.radius < 14.2, "{top:?}");
    assert_eq!(touchoff_tools::Cylinder::info().symmetry, Symmetry::Revolved);
}

fn solid(items: &str) -> touchoff_dsl::Compiled {
    compile(&Source::new("t.tool", format!("solid S {{ units mm; {items} }}")))
}

fn taken(items: &str) -> CheckedTool {
    let compiled = solid(items);
    assert!(!any_error(compiled.diagnostics()), "{:?}", compiled.diagnostics());
    *compiled.into_tool().expect("no error, so a solid")
}

/// Returns the messages of a text that must be refused, with their help.
fn refused(items: &str) -> String {
    let compiled = solid(items);
    assert!(any_error(compiled.diagnostics()) && compiled.tool().is_none(), "{items} was taken");
    let format_diagnostic =
        |r: &touchoff_dsl::diagnostic::Diagnostic| format!("{}: {}", r.message(), r.help());
    compiled.diagnostics().iter().map(format_diagnostic).collect::<Vec<_>>().join("; ")
}

const BALL: &str = "region b where hypot(x, y, z) <= 3 { depth: 3 - hypot(x, y, z);";

#[test]
fn a_round_solid_is_bounded_closely() {
    // Off the axis, so that nothing folds to the distance from it.
    let items = "let r = 3; curve far = hypot(x - 5, y + 1, z);
        region b as ball cutting where far <= r { depth: r - far; direction: away from (5, -1, 0); }
        niceness cutting: 1 - depth/r;";
    let tool = taken(items);
    let [x, y, z] = tool.extent.cell().sides;
    for (side, [low, high]) in [x, y, z].iter().zip([[2.0, 8.0], [-4.0, 2.0], [-3.0, 3.0]]) {
        assert!(side.low <= low && side.low > low - 0.1, "{side:?}");
        assert!(side.high >= high && side.high < high + 0.1, "{side:?}");
    }
    let radius = 26f64.sqrt() + 3.0;
    assert!((radius..1.05 * radius).contains(&tool.extent.radius), "{}", tool.extent.radius);
}

#[test]
fn diagnostics_name_coordinates_of_the_other_domain() {
    let message = refused(&format!("{BALL} magnitude: d; }}"));
    assert_eq!(message, "`d` is a coordinate of a `tool` only: in a `solid` use `hypot(x, y)`");
    let tool = "tool T { units mm; region r where hypot(d, z - 3) <= 3, y <= 4 { depth: 3 - hypot(d, z - 3); } }";
    let compiled = compile(&Source::new("t.tool", tool));
    assert_eq!(compiled.diagnostics().len(), 1);
    assert_eq!(compiled.diagnostics()[0].message(), "`y` is a coordinate of a `solid` only");
    let help = compiled.diagnostics()[0].help();
    assert!(help.contains("`d`, the distance from the axis"), "{help}");
    assert!(refused("let x = 3;").contains("`x` is a coordinate and cannot be redefined"));
    assert!(refused("let d = 3;").contains("`d` is a reserved name"));
    assert!(refused(&format!("{BALL} magnitude: 2d; }}")).contains("write `2*hypot(x, y)`"));
}

#[test]
fn diagnostics_name_items_that_only_tools_have() {
    let ball = format!("{BALL} }}");
    for (item, word) in [
        ("tip z = 3;", "tip"),
        ("spindle -z;", "spindle"),
        ("profile { start (0, 0); line to (3, 0), (0, 3) as side; }", "profile"),
        ("regions nearest;", "regions"),
    ] {
        let message = refused(&format!("{item} {ball}"));
        let expected = format!("`{word}` exists in a `tool` only: a `solid` has no axis");
        assert!(message.starts_with(&expected), "{message}");
        assert!(!message.contains("; `"), "{message}");
    }
}

#[test]
fn points_have_three_numbers() {
    let message = refused(&format!("{BALL} direction: toward (1, 2); }}"));
    assert_eq!(message, "a point in a solid has three numbers; this has 2: write `(x, y, z)`");
    let message = refused(&format!("{BALL} direction: away from (1, 2, 0, 5); }}"));
    assert!(message.contains("a decimal comma? write `0.5`"), "{message}");
    let message = refused(&format!("{BALL} direction: (1, 0); }}"));
    assert_eq!(message, "a direction in a solid has three numbers; this has 2: write `(x, y, z)`");
    assert!(
        refused(&format!("{BALL} direction: (x, y, z^2); }}")).contains("this direction mixes")
    );
}

/// Each mistake is shown with a point of space.
#[test]
fn diagnostics_include_a_point() {
    let both = "region a where hypot(x, y, z) <= 3 { depth: 3 - hypot(x, y, z); }
        region b where hypot(x - 1, y, z) <= 3 { depth: 3 - hypot(x - 1, y, z); }";
    let message = refused(both);
    assert!(message.starts_with("regions a and b overlap, for instance at ("), "{message}");
    assert_eq!(message.split(')').next().map(|head| head.matches(',').count()), Some(3));
    let slab = "region a where -1 <= x <= 1, -1 <= y <= 1 { depth: min(1 - abs(x), 1 - abs(y)); }";
    let message = refused(slab);
    assert!(message.starts_with("region a has no proved bound toward large z"), "{message}");
    // A face that nothing closes.
    let open = "region a where -1 <= x <= 1, -1 <= y <= 1, 0 <= z <= 2 {
        depth: min(1 - abs(x), 1 - abs(y), z); }";
    assert!(refused(open).contains("on the surface"));
    assert!(
        refused("region a where x >= 1, x <= -1, 0 <= y <= 1, 0 <= z <= 1 { depth: z; }")
            .starts_with("no point belongs to this solid")
    );
    assert!(refused("").starts_with("`S` has no region"));
}

#[test]
fn rejects_files_with_another_first_keyword() {
    let message = |text: &str| {
        let report = compile(&Source::new("t.tool", text)).diagnostics()[0].clone();
        format!("{}: {}", report.message(), report.help())
    };
    assert_eq!(
        message("sold S { units mm; }"),
        "a file begins with `tool` or `solid`, not with `sold`: did you mean `solid`?"
    );
    let two = format!("solid S {{ units mm; {BALL} }} }} solid T {{ units mm; }}");
    assert_eq!(message(&two), "this is a second solid in one file: move it to a file of its own");
}
