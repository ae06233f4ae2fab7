//! The expression graph against a plain tree of the same operations: values, derivatives, enclosures. The tree is
//! evaluated by itself, so folding cannot hide a mistake.

use super::derive::derivative;
use super::interval::{Cell, Encloser, Interval};
use super::polynomial::Polynomial;
use super::value::{EvaluationPoint, Evaluator};
use super::{Coord, Graph, Id};
use crate::number::Number;
use proptest::prelude::*;

#[derive(Clone, Debug)]
enum Tree {
    Const(f64),
    D,
    Z,
    One(One, Box<Tree>),
    Two(Two, Box<Tree>, Box<Tree>),
}

#[derive(Clone, Copy, Debug)]
enum One {
    Neg,
    Abs,
}

#[derive(Clone, Copy, Debug)]
enum Two {
    /// `sqrt(a² + b² + 1)`: a root without a kink.
    Hypot,
    Add,
    Sub,
    Mul,
    /// `a / (b² + 1)`: never a division by 0.
    Over,
    Min,
    Max,
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
        match self {
            Tree::Const(value) => graph.number(Number::from_f64(*value).expect("finite")),
            Tree::D => graph.coord(Coord::D),
            Tree::Z => graph.coord(Coord::Z),
            Tree::One(one, a) => {
                let a = a.build(graph);
                match one {
                    One::Neg => graph.neg(a),
                    One::Abs => graph.abs(a),
                }
            }
            Tree::Two(two, a, b) => {
                let (a, b) = (a.build(graph), b.build(graph));
                let (one, bb) = (graph.int(1), graph.mul(b, b));
                match two {
                    Two::Hypot => {
                        let aa = graph.mul(a, a);
                        let sum = graph.add(aa, bb);
                        let sum = graph.add(sum, one);
                        graph.sqrt(sum).expect("at least 1")
                    }
                    Two::Over => {
                        let below = graph.add(bb, one);
                        graph.div(a, below).expect("at least 1")
                    }
                    Two::Add => graph.add(a, b),
                    Two::Sub => graph.sub(a, b),
                    Two::Mul => graph.mul(a, b),
                    Two::Min => graph.min(a, b),
                    Two::Max => graph.max(a, b),
                }
            }
        }
    }

    fn at(&self, d: f64, z: f64) -> Dual {
        let flat = |value, slope| Dual { value, slope, smooth: f64::INFINITY };
        match self {
            Tree::Const(value) => flat(*value, [0.0; 2]),
            Tree::D => flat(d, [1.0, 0.0]),
            Tree::Z => flat(z, [0.0, 1.0]),
            Tree::One(one, a) => {
                let a = a.at(d, z);
                let (sign, kink) = match one {
                    One::Neg => (-1.0, f64::INFINITY),
                    One::Abs => (a.value.signum(), a.value.abs()),
                };
                let slope = a.slope.map(|s| s * sign);
                Dual { value: sign * a.value, slope, smooth: a.smooth.min(kink) }
            }
            Tree::Two(two, a, b) => {
                let (a, b) = (a.at(d, z), b.at(d, z));
                let (u, v) = (a.value, b.value);
                let root = (u * u + v * v + 1.0).sqrt();
                let below = v * v + 1.0;
                let first =
                    if (u < v) == matches!(two, Two::Min) { [1.0, 0.0] } else { [0.0, 1.0] };
                let (value, by) = match two {
                    Two::Hypot => (root, [u / root, v / root]),
                    Two::Over => (u / below, [1.0 / below, -u / (below * below) * 2.0 * v]),
                    Two::Add => (u + v, [1.0, 1.0]),
                    Two::Sub => (u - v, [1.0, -1.0]),
                    Two::Mul => (u * v, [v, u]),
                    Two::Min => (u.min(v), first),
                    Two::Max => (u.max(v), first),
                };
                let is_kinked = matches!(two, Two::Min | Two::Max);
                let kink = if is_kinked { (u - v).abs() } else { f64::INFINITY };
                Dual {
                    value,
                    slope: [0, 1].map(|k| by[0] * a.slope[k] + by[1] * b.slope[k]),
                    smooth: a.smooth.min(b.smooth).min(kink),
                }
            }
        }
    }
}

fn tree() -> impl Strategy<Value = Tree> {
    let leaf = prop_oneof![
        (-8i32..=8).prop_map(|k| Tree::Const(f64::from(k) / 2.0)),
        Just(Tree::D),
        Just(Tree::Z),
    ];
    let one = || proptest::sample::select(&[One::Neg, One::Abs][..]);
    let all = [Two::Hypot, Two::Add, Two::Sub, Two::Mul, Two::Over, Two::Min, Two::Max];
    let two = move || proptest::sample::select(all.to_vec());
    leaf.prop_recursive(5, 24, 2, move |inner| {
        let inner = inner.prop_map(Box::new);
        prop_oneof![
            2 => (one(), inner.clone()).prop_map(|(one, a)| Tree::One(one, a)),
            7 => (two(), inner.clone(), inner).prop_map(|(two, a, b)| Tree::Two(two, a, b)),
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
        // A cell of space, and one of the half plane.
        let inside = |low: f64, k: usize| (low + part[k] * width[k]).min(low + width[k]);
        let side = |low: f64, k: usize| Interval::new(low, low + width[k]);
        let [x, y, z] = [0, 1, 2].map(|k| inside(p[k], k));
        let space = Cell { sides: [0, 1, 2].map(|k| side(p[k], k)) };
        let far = p[0].abs();
        let half_plane = Cell::half_plane(side(far, 0), side(p[2], 2));
        let on_meridian = EvaluationPoint::on_meridian(inside(far, 0), z);
        for (cell, point, ids) in [
            (space, EvaluationPoint::new(x, y, z), &all[..]),
            (half_plane, on_meridian, &[root, slopes[2]]),
        ] {
            encloser.set(cell);
            evaluator.evaluate(point);
            for id in ids {
                let (value, within) = (evaluator.get(*id), encloser.get(*id));
                prop_assert!(within.low <= value && value <= within.high, "{value} outside {within:?}");
            }
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
