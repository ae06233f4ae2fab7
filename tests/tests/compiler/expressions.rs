//! The expression graph against a plain tree of the same operations: values, derivatives, enclosures. The tree is
//! evaluated by itself, so folding cannot hide a mistake.

use proptest::prelude::*;
use touchoff_dsl::expr::derive::derivative;
use touchoff_dsl::expr::interval::{Cell, Encloser, Interval};
use touchoff_dsl::expr::polynomial::Polynomial;
use touchoff_dsl::expr::value::{EvaluationPoint, Evaluator};
use touchoff_dsl::expr::{Coord, Graph, Id};
use touchoff_dsl::number::Number;

/// An expression as it would be written.
#[derive(Clone, Debug)]
enum Tree {
    Const(f64),
    D,
    Z,
    Neg(Box<Tree>),
    Abs(Box<Tree>),
    /// `sqrt(a² + b² + 1)`: a root without a kink
    Hypot(Box<Tree>, Box<Tree>),
    Add(Box<Tree>, Box<Tree>),
    Sub(Box<Tree>, Box<Tree>),
    Mul(Box<Tree>, Box<Tree>),
    /// `a / (b² + 1)`: never a division by 0
    Over(Box<Tree>, Box<Tree>),
    Min(Box<Tree>, Box<Tree>),
    Max(Box<Tree>, Box<Tree>),
}

/// A value and its two partial derivatives, carried along.
#[derive(Clone, Copy, Debug)]
struct Dual {
    value: f64,
    slope: [f64; 2],
    /// Distance of the point from a kink of the expression.
    smooth: f64,
}

impl Tree {
    fn build(&self, graph: &mut Graph) -> Id {
        let one = graph.int(1);
        match self {
            Tree::Const(value) => {
                let number = Number::from_f64(*value).expect("finite");
                graph.number(number)
            }
            Tree::D => graph.coord(Coord::D),
            Tree::Z => graph.coord(Coord::Z),
            Tree::Neg(a) => {
                let a = a.build(graph);
                graph.neg(a)
            }
            Tree::Abs(a) => {
                let a = a.build(graph);
                graph.abs(a)
            }
            Tree::Hypot(a, b) => {
                let (a, b) = (a.build(graph), b.build(graph));
                let (aa, bb) = (graph.mul(a, a), graph.mul(b, b));
                let sum = graph.add(aa, bb);
                let sum = graph.add(sum, one);
                graph.sqrt(sum).expect("at least 1")
            }
            Tree::Over(a, b) => {
                let (a, b) = (a.build(graph), b.build(graph));
                let bb = graph.mul(b, b);
                let below = graph.add(bb, one);
                graph.div(a, below).expect("at least 1")
            }
            Tree::Add(a, b) => binary(graph, a, b, Graph::add),
            Tree::Sub(a, b) => binary(graph, a, b, Graph::sub),
            Tree::Mul(a, b) => binary(graph, a, b, Graph::mul),
            Tree::Min(a, b) => binary(graph, a, b, Graph::min),
            Tree::Max(a, b) => binary(graph, a, b, Graph::max),
        }
    }

    fn at(&self, d: f64, z: f64) -> Dual {
        let flat = |value, slope| Dual { value, slope, smooth: f64::INFINITY };
        let two = |a: &Tree, b: &Tree| (a.at(d, z), b.at(d, z));
        let join = |a: Dual, b: Dual, value: f64, by: [f64; 2]| Dual {
            value,
            slope: [0, 1].map(|k| by[0] * a.slope[k] + by[1] * b.slope[k]),
            smooth: a.smooth.min(b.smooth),
        };
        match self {
            Tree::Const(value) => flat(*value, [0.0; 2]),
            Tree::D => flat(d, [1.0, 0.0]),
            Tree::Z => flat(z, [0.0, 1.0]),
            Tree::Neg(a) => {
                let a = a.at(d, z);
                Dual { value: -a.value, slope: a.slope.map(|s| -s), ..a }
            }
            Tree::Abs(a) => {
                let a = a.at(d, z);
                let sign = a.value.signum();
                Dual {
                    value: a.value.abs(),
                    slope: a.slope.map(|s| s * sign),
                    smooth: a.smooth.min(a.value.abs()),
                }
            }
            Tree::Hypot(a, b) => {
                let (a, b) = two(a, b);
                let value = (a.value * a.value + b.value * b.value + 1.0).sqrt();
                join(a, b, value, [a.value / value, b.value / value])
            }
            Tree::Over(a, b) => {
                let (a, b) = two(a, b);
                let below = b.value * b.value + 1.0;
                let by = [1.0 / below, -a.value / (below * below) * 2.0 * b.value];
                join(a, b, a.value / below, by)
            }
            Tree::Add(a, b) => {
                let (a, b) = two(a, b);
                join(a, b, a.value + b.value, [1.0, 1.0])
            }
            Tree::Sub(a, b) => {
                let (a, b) = two(a, b);
                join(a, b, a.value - b.value, [1.0, -1.0])
            }
            Tree::Mul(a, b) => {
                let (a, b) = two(a, b);
                join(a, b, a.value * b.value, [b.value, a.value])
            }
            Tree::Min(a, b) | Tree::Max(a, b) => {
                let (a, b) = two(a, b);
                let first = (a.value < b.value) == matches!(self, Tree::Min(..));
                let chosen = if first { a } else { b };
                let smooth = a.smooth.min(b.smooth).min((a.value - b.value).abs());
                Dual { smooth, ..chosen }
            }
        }
    }
}

fn binary(graph: &mut Graph, a: &Tree, b: &Tree, join: fn(&mut Graph, Id, Id) -> Id) -> Id {
    let (a, b) = (a.build(graph), b.build(graph));
    join(graph, a, b)
}

fn tree() -> impl Strategy<Value = Tree> {
    let leaf = prop_oneof![
        (-8i32..=8).prop_map(|k| Tree::Const(f64::from(k) / 2.0)),
        Just(Tree::D),
        Just(Tree::Z),
    ];
    leaf.prop_recursive(5, 24, 2, |inner| {
        let one = inner.clone().prop_map(Box::new);
        let two = (one.clone(), one.clone());
        prop_oneof![
            one.clone().prop_map(Tree::Neg),
            one.prop_map(Tree::Abs),
            two.clone().prop_map(|(a, b)| Tree::Hypot(a, b)),
            two.clone().prop_map(|(a, b)| Tree::Add(a, b)),
            two.clone().prop_map(|(a, b)| Tree::Sub(a, b)),
            two.clone().prop_map(|(a, b)| Tree::Mul(a, b)),
            two.clone().prop_map(|(a, b)| Tree::Over(a, b)),
            two.clone().prop_map(|(a, b)| Tree::Min(a, b)),
            two.prop_map(|(a, b)| Tree::Max(a, b)),
        ]
    })
}

fn steady() -> ProptestConfig {
    ProptestConfig { cases: 2000, failure_persistence: None, ..ProptestConfig::default() }
}

/// Returns whether two values agree but for rounding in another order.
fn near(a: f64, b: f64, scale: f64) -> bool {
    (a - b).abs() <= 1e-9 * (1.0 + a.abs().max(b.abs()) + scale)
}

proptest! {
    #![proptest_config(steady())]

    #[test]
    fn folding_keeps_the_value_and_the_derivative(tree in tree(), d in 0.0..3.0f64, z in -3.0..3.0f64) {
        let expected = tree.at(d, z);
        prop_assume!(expected.value.abs() < 1e6 && expected.slope.iter().all(|s| s.abs() < 1e6));
        let mut graph = Graph::default();
        let root = tree.build(&mut graph);
        let slopes = [Coord::D, Coord::Z].map(|by| derivative(&mut graph, root, by));
        let mut evaluator = Evaluator::new(&graph, [root, slopes[0], slopes[1]]);
        evaluator.evaluate(EvaluationPoint::on_meridian(d, z));
        prop_assert!(near(evaluator.get(root), expected.value, 100.0), "{} {:?}", evaluator.get(root), expected);
        if expected.smooth > 1e-6 {
            for (id, slope) in slopes.into_iter().zip(expected.slope) {
                prop_assert!(near(evaluator.get(id), slope, 1000.0), "{} {:?}", evaluator.get(id), expected);
            }
        }
    }

    #[test]
    fn enclosures_contain_the_values(
        tree in tree(),
        (d, z) in (0.0..3.0f64, -3.0..3.0f64),
        (width, height) in (0.0..1.0f64, 0.0..1.0f64),
        (u, v) in (0.0..=1.0f64, 0.0..=1.0f64),
    ) {
        let mut graph = Graph::default();
        let root = tree.build(&mut graph);
        let slope = derivative(&mut graph, root, Coord::Z);
        let mut encloser = Encloser::new(&graph, [root, slope]);
        encloser.set(Cell::half_plane(Interval::new(d, d + width), Interval::new(z, z + height)));
        let mut evaluator = Evaluator::new(&graph, [root, slope]);
        evaluator.evaluate(EvaluationPoint::on_meridian((d + u * width).min(d + width), (z + v * height).min(z + height)));
        for id in [root, slope] {
            let (value, within) = (evaluator.get(id), encloser.get(id));
            prop_assert!(within.low <= value && value <= within.high, "{value} outside {within:?}");
        }
    }

    #[test]
    fn enclosures_enclose_in_space(
        tree in tree(),
        p in [-3.0..3.0f64, -3.0..3.0f64, -3.0..3.0f64],
        width in [0.0..1.0f64, 0.0..1.0f64, 0.0..1.0f64],
        part in [0.0..=1.0f64, 0.0..=1.0f64, 0.0..=1.0f64],
    ) {
        let mut graph = Graph::default();
        let root = tree.build(&mut graph);
        let [x, y, _] = p;
        let d = x.hypot(y);
        let expected = tree.at(d, p[2]);
        let slopes = [Coord::X, Coord::Y, Coord::Z].map(|by| derivative(&mut graph, root, by));
        let all = [root, slopes[0], slopes[1], slopes[2]];
        let (mut evaluator, mut encloser) = (Evaluator::new(&graph, all), Encloser::new(&graph, all));
        let sane = expected.value.abs() < 1e6 && expected.slope.iter().all(|s| s.abs() < 1e6);
        if sane && expected.smooth > 1e-6 && d > 1e-3 {
            evaluator.evaluate(EvaluationPoint::new(x, y, p[2]));
            let [radial, axial] = expected.slope;
            for (id, slope) in slopes.into_iter().zip([radial * x / d, radial * y / d, axial]) {
                prop_assert!(near(evaluator.get(id), slope, 1000.0), "{} {slope}", evaluator.get(id));
            }
        }
        encloser.set(Cell { sides: [0, 1, 2].map(|k| Interval::new(p[k], p[k] + width[k])) });
        let [x, y, z] = [0, 1, 2].map(|k| (p[k] + part[k] * width[k]).min(p[k] + width[k]));
        evaluator.evaluate(EvaluationPoint::new(x, y, z));
        for id in all {
            let (value, within) = (evaluator.get(id), encloser.get(id));
            prop_assert!(within.low <= value && value <= within.high, "{value} outside {within:?}");
        }
    }

    #[test]
    fn a_multiple_of_a_polynomial_is_recognised(
        (a, b, c) in (-9i64..=9, -9i64..=9, -9i64..=9),
        factor in (-7i64..=7).prop_filter("not 0", |k| *k != 0),
    ) {
        prop_assume!(a != 0 || b != 0);
        let mut graph = Graph::default();
        let (d, z) = (graph.coord(Coord::D), graph.coord(Coord::Z));
        let mut linear = |k: i64| {
            let (ka, kb, kc) = (graph.int(k * a), graph.int(k * b), graph.int(k * c));
            let (ad, bz) = (graph.mul(ka, d), graph.mul(kb, z));
            let sum = graph.add(bz, kc);
            graph.sub(sum, ad)
        };
        let (one, many) = (linear(1), linear(factor));
        let polynomial = |id| Polynomial::from_expression(&graph, id).expect("a polynomial");
        let ratio = polynomial(many).ratio(&polynomial(one)).expect("a multiple");
        prop_assert_eq!(ratio.to_f64(), factor as f64);
    }
}

/// Constants are rounded once: 0.1 + 0.2 is 0.3, and a third of three is one.
#[test]
fn constants_carry_more_than_a_double() {
    let decimal = |text| Number::parse_decimal(text).expect("a number");
    assert_eq!((&decimal("0.1") + &decimal("0.2")).to_f64(), 0.3);
    let third = &Number::int(1) / &Number::int(3);
    assert_eq!((&third * &Number::int(3)).to_f64(), 1.0);
    assert_eq!(Number::pi().to_f64(), std::f64::consts::PI);
    let root = Number::int(2).sqrt().expect("positive");
    assert!((&root * &root).nearly_equals(&Number::int(2)));
    let angle = &(&Number::int(30) * &Number::pi()) / &Number::int(180);
    assert_eq!(angle.sin().to_f64(), 0.5);
    assert_eq!(decimal("1e300").doubled_exponent(), None);
    assert_eq!(decimal("1.5").doubled_exponent(), Some(3));
}
