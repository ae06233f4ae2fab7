//! Solids without an axis: evaluations of the library's at stated points, and refusals of others.

use touchoff::tool::{Evaluators, PointEvaluation, Symmetry};
use touchoff::{Interval, Unit};
use touchoff_dsl::interpret::Interpreter;
use touchoff_dsl::source::Source;
use touchoff_dsl::{Compiled, compile_with_arguments};
use touchoff_tests::checks::assert_near;
use touchoff_tests::library;
use touchoff_tests::oracle::rng::Rng;
use touchoff_tests::oracle::vector::distance;
use touchoff_tests::oracle::{Body, Oracle};
use touchoff_tests::texts::{
    accepted, assert_each_refused, assert_refused, compiled, said, with_one_error,
};
use touchoff_tools::{Block, LBracket};

fn at<T: Evaluators>(p: [f64; 3]) -> Option<(&'static str, f64)> {
    let evaluation = T::evaluate_point(p, 1.0)?;
    Some((T::info().regions[evaluation.region].name.as_ref(), evaluation.depth))
}

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
        assert_near(evaluation, depth, 32.0 * f64::EPSILON, p);
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
    let toward = inside::<LBracket>([-5.0, 0.0, 5.0], 1.0).direction;
    assert!(distance(&toward, &[half, 0.0, half]) < 1e-15, "{toward:?}");
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
                // The sides of the box are rounded outward to 1e-4 mm.
                assert!(clearance > distance.max(0.0) - 3e-4, "{clearance} {distance}");
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
        let tool = accepted(compile_with_arguments(&block, &given));
        let mut reference = Interpreter::new(&tool);
        let mut rng = Rng::new(7);
        let half = [w, l, h].map(|side| f64::from(side) / 2.0);
        for _ in 0..2_000 {
            let p = half.map(|half| rng.between(-half, half));
            let depth = (0..3).map(|k| half[k] - p[k].abs()).fold(f64::INFINITY, f64::min);
            let evaluation = reference.evaluate([p[0], p[1], p[2] + half[2]], 1.0).expect("inside");
            assert_near(evaluation.depth, depth, 1e-13, p);
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
    assert!(x.low <= -10.0 && (20.0..20.001).contains(&x.high), "{x}");
    assert!((10.0..10.001).contains(&y.high), "{y}");
    // The standing leg is slimmer than the lying one.
    let top = info.envelope.last().expect("slabs");
    assert!(top.low < 6.01 && top.radius >= 200f64.sqrt() && top.radius < 14.2, "{top:?}");
    assert_eq!(touchoff_tools::Cylinder::info().symmetry, Symmetry::Revolved);
}

fn solid(items: &str) -> Compiled {
    compiled(format!("solid S {{ units mm; {items} }}"))
}

const BALL: &str = "region b where hypot(x, y, z) <= 3 { depth: 3 - hypot(x, y, z);";

#[test]
fn a_round_solid_is_bounded_closely() {
    // Off the axis, so that nothing folds to the distance from it.
    let items = "let r = 3; curve far = hypot(x - 5, y + 1, z);
        region b as ball cutting where far <= r { depth: r - far; direction: away from (5, -1, 0); }
        niceness cutting: 1 - depth/r;";
    let tool = accepted(solid(items));
    let [x, y, z] = tool.extent.cell().sides;
    for (side, [low, high]) in [x, y, z].iter().zip([[2.0, 8.0], [-4.0, 2.0], [-3.0, 3.0]]) {
        assert!(side.low <= low && side.low > low - 0.1, "{side:?}");
        assert!(side.high >= high && side.high < high + 0.1, "{side:?}");
    }
    let radius = 26f64.sqrt() + 3.0;
    assert!((radius..1.05 * radius).contains(&tool.extent.radius), "{}", tool.extent.radius);
}

/// Properties of a ball, and the words of their one error.
const PROPERTIES: &str = "\
magnitude: d; => `d` is a coordinate of a `tool` only | in a `solid` use `hypot(x, y)`
magnitude: 2d; => write `2*hypot(x, y)`
direction: toward (1, 2); => a point in a solid has three numbers; this has 2 | write `(x, y, z)`
direction: away from (1, 2, 0, 5); => a decimal comma? write `0.5`
direction: (1, 0); => a direction in a solid has three numbers; this has 2 | write `(x, y, z)`
direction: (x, y, z^2); => this direction mixes";

/// Items beside a ball, and the words of their one error.
const ITEMS: &str = "\
let x = 3; => `x` is a coordinate and cannot be redefined
let d = 3; => `d` is a reserved name
tip z = 3; => `tip` exists in a `tool` only | a `solid` has no axis
spindle -z; => `spindle` exists in a `tool` only | a `solid` has no axis
profile { start (0, 0); line to (3, 0), (0, 3) as side; } => `profile` exists in a `tool` only | a `solid` has no axis
regions nearest; => `regions` exists in a `tool` only | a `solid` has no axis";

/// All items of a solid, and the words of its error: a point of space, or a coordinate.
const SOLIDS: &str = "\
region a where hypot(x, y, z) <= 3 { depth: 3 - hypot(x, y, z); } region b where hypot(x - 1, y, z) <= 3 { depth: 3 - hypot(x - 1, y, z); } => regions a and b overlap, for instance at (
region a where -1 <= x <= 1, -1 <= y <= 1 { depth: min(1 - abs(x), 1 - abs(y)); } => region a has no proved bound toward large z
region a where -1 <= x <= 1, -1 <= y <= 1, 0 <= z <= 2 { depth: min(1 - abs(x), 1 - abs(y), z); } => on the surface
region a where x >= 1, x <= -1, 0 <= y <= 1, 0 <= z <= 1 { depth: z; } => no point belongs to this solid
let a = 1; => `S` has no region";

#[test]
fn mistakes_in_a_solid_are_named() {
    assert_each_refused(PROPERTIES, |items| with_one_error(solid(&format!("{BALL} {items} }}"))));
    assert_each_refused(ITEMS, |items| with_one_error(solid(&format!("{items} {BALL} }}"))));
    assert_each_refused(SOLIDS, solid);
    // A point of space has three coordinates.
    let (items, _) = SOLIDS.split_once(" => ").expect("items and words");
    let overlap = said(&format!("solid S {{ units mm; {items} }}"));
    assert_eq!(overlap[0].0.split(')').next().map(|head| head.matches(',').count()), Some(3));
    let tool = "tool T { units mm; region r where hypot(d, z - 3) <= 3, y <= 4 { depth: 3 - hypot(d, z - 3); } }";
    let words = ["`y` is a coordinate of a `solid` only", "`d`, the distance from the axis"];
    assert_refused(&with_one_error(compiled(tool)), &words);
    let words = ["a file begins with `tool` or `solid`, not with `sold`", "did you mean `solid`?"];
    assert_refused(&compiled("sold S { units mm; }"), &words);
    let two = format!("solid S {{ units mm; {BALL} }} }} solid T {{ units mm; }}");
    let words = ["this is a second solid in one file", "move it to a file of its own"];
    assert_refused(&compiled(two), &words);
}
