//! The thesis's own magnitudes of fig. 7.3 against the exact distances (`fig73-exact.md`, section 3).

use super::rng::Rng;
use super::{Fig73, Oracle, fig_7_3_exact};

const S2: f64 = std::f64::consts::SQRT_2;

/// Returns the point `(d, z)` of the thesis's frame in the tool's frame.
fn at(d: f64, z: f64) -> [f64; 3] {
    [d, 0.0, 20.0 - z]
}

/// Computes the integral of the magnitude over the half profile, by the midpoint rule with about `n` steps per unit. The
/// number of steps differs between the two directions, since otherwise whole diagonals of midpoints would fall on the
/// diagonal borders.
fn integral(o: &dyn Oracle, n: u32) -> f64 {
    let (h_d, h_z) = (1.0 / f64::from(n), 1.0 / f64::from(n + 1));
    let cells = (0..5 * n).flat_map(|i| (0..20 * (n + 1)).map(move |k| (i, k)));
    let magnitude = |(i, k): (u32, u32)| {
        let p = [(f64::from(i) + 0.5) * h_d, 0.0, (f64::from(k) + 0.5) * h_z];
        o.evaluate(p).map_or(0.0, |s| s.magnitude)
    };
    h_d * h_z * cells.map(magnitude).sum::<f64>()
}

/// Section 3: eq. 7.1 is never below the distance and at most √5 times it, and the worst case is known.
#[test]
fn the_thesis_overestimates_by_at_most_root_five() {
    let (thesis, exact) = (Fig73::default(), fig_7_3_exact());
    let mut rng = Rng::new(3);
    let (mut most, mut ratio) = (0.0f64, 0.0f64);
    for _ in 0..400_000 {
        let p = at(rng.between(0.0, 5.0), rng.between(0.0, 20.0));
        let (Some(t), Some(e)) = (thesis.evaluate(p), exact.evaluate(p)) else {
            assert!(thesis.evaluate(p).is_none() && exact.evaluate(p).is_none(), "{p:?}");
            continue;
        };
        assert!(
            t.magnitude >= e.depth - 1e-14 && t.magnitude <= 5f64.sqrt() * e.depth + 1e-14,
            "{p:?}"
        );
        most = most.max(t.magnitude - e.depth);
        ratio = ratio.max(t.magnitude / e.depth);
    }
    // On the axis at 14 the thesis has 3, and the corner (1, 15) is √2 away; no point is worse.
    let axis = |o: &dyn Oracle| o.evaluate(at(0.0, 14.0)).map_or(0.0, |s| s.magnitude);
    assert!((axis(&thesis) - 3.0).abs() < 1e-15 && (axis(&exact) - S2).abs() < 1e-15);
    assert!(most > 1.5 && most <= 3.0 - S2);
    assert!(ratio > 2.2);
    // The mean over the half profile: 0.1156.
    assert!((integral(&exact, 200) - 117.863_898_104_678_9).abs() < 1e-4);
    let mean = (integral(&thesis, 100) - 117.863_898_104_678_9) / 69.785_398_163_397_4;
    assert!((mean - 0.115_56).abs() < 5e-5, "{mean}");
}

#[test]
fn the_thesis_magnitudes_meet_without_a_jump() {
    let tool = Fig73::default();
    for curve in tool.curve_points().iter().skip(7) {
        for c in curve {
            let m =
                |dd: f64, dz: f64| tool.evaluate([c[0] + dd, 0.0, c[2] + dz]).map(|s| s.magnitude);
            let neighbourhood = [m(1e-9, 0.0), m(-1e-9, 0.0), m(0.0, 1e-9), m(0.0, -1e-9)];
            let found = neighbourhood.into_iter().flatten();
            let (low, high) = found.fold((f64::INFINITY, 0.0f64), |(l, h), m| (l.min(m), h.max(m)));
            assert!(high - low < 1e-8, "{c:?}");
        }
    }
}

#[test]
fn niceness_of_equation_7_3() {
    for o in [&Fig73::default() as &dyn Oracle, &fig_7_3_exact()] {
        let nice = |d, z| o.evaluate(at(d, z)).map(|s| s.niceness);
        assert_eq!(nice(1.0, 19.0), Some(2.0));
        assert_eq!(nice(0.0, 20.0), Some(1.0));
        assert_eq!(nice(0.5, 17.0), Some(0.5));
        assert_eq!(nice(2.0, 12.0), Some(0.0));
    }
}

#[test]
fn directions_of_equation_7_2() {
    let tool = Fig73::default();
    let u = |d, z| tool.evaluate(at(d, z)).expect("inside").direction;
    let near = |a: [f64; 3], b: [f64; 3]| (0..3).all(|k| (a[k] - b[k]).abs() < 1e-15);
    assert!(near(u(1.0, 10.0), [1.0 / S2, 0.0, -1.0 / S2])); // IV
    assert!(near(u(1.5, 14.0), [1.0 / S2, 0.0, -1.0 / S2])); // VI
    let s5 = 5f64.sqrt();
    assert!(near(u(0.5, 15.0), [2.0 / s5, 0.0, -1.0 / s5])); // VII
    assert!(near(u(2.0, 1.0), [0.0, 0.0, 1.0])); // I: toward the spindle
    assert!(near(u(0.0, 19.0), [1.0, 0.0, 0.0])); // VIII is listed before IX
}
