//! The oracles of fig. 7.3 against the table of their exact regions (`fig73-exact.md`), sections 1 to 4.

use super::rng::Rng;
use super::{Fig73, Meridian, Oracle, fig_7_3_exact};

const S2: f64 = std::f64::consts::SQRT_2;

/// Returns the point `(d, z)` of the thesis's frame in the tool's frame.
fn at(d: f64, z: f64) -> [f64; 3] {
    [d, 0.0, 20.0 - z]
}

/// Returns the index in the thesis's list, which runs from the spindle's end, of a region that is listed from the
/// tip.
fn table_row(owner: usize) -> usize {
    8 - owner
}

/// Computes area, integral of the depth, and largest depth of each region, by the midpoint rule with about `n`
/// steps per unit. The number of steps differs between the two directions, since otherwise whole diagonals of
/// midpoints would fall on the diagonal borders.
fn integrate(o: &dyn Oracle, n: u32) -> [[f64; 3]; 9] {
    let (h_d, h_z) = (1.0 / f64::from(n), 1.0 / f64::from(n + 1));
    let mut sums = [[0.0; 3]; 9];
    for i in 0..5 * n {
        for k in 0..20 * (n + 1) {
            let p = [(f64::from(i) + 0.5) * h_d, 0.0, (f64::from(k) + 0.5) * h_z];
            if let Some(s) = o.evaluate(p) {
                let row: &mut [f64; 3] = &mut sums[s.owner];
                row[0] += h_d * h_z;
                row[1] += h_d * h_z * s.depth;
                row[2] = row[2].max(s.depth);
            }
        }
    }
    sums
}

#[test]
fn areas_and_integrals_of_the_table() {
    use std::f64::consts::PI;
    let table = [
        [12.5, 125.0 / 6.0, 5.0],
        [187.0 / 6.0, 59.033_333_333_333_3, 5.0],
        [2.0, 4.0 / 3.0, 2.0],
        [28.0 / 3.0, 22.854_866_410_117_6, 5.0],
        [4.136_038_969_321_07, 5.272_077_938_642_14, 3.0],
        [5.363_961_030_678_93, 5.892_556_509_887_90, 3.0],
        [0.5, 0.382_597_858_232_106, S2],
        [4.0, 2.0, 1.0],
        [PI / 4.0, PI / 12.0, 1.0],
    ];
    let found = integrate(&fig_7_3_exact(), 200);
    for (owner, row) in found.iter().enumerate() {
        let want = table[table_row(owner)];
        assert!((row[0] - want[0]).abs() < 2e-3, "{row:?} {want:?}");
        assert!((row[1] - want[1]).abs() < 4e-3, "{row:?} {want:?}");
        assert!(row[2] <= want[2] && row[2] > want[2] - 0.02, "{row:?} {want:?}");
    }
    let total = |k: usize| found.iter().map(|row| row[k]).sum::<f64>();
    assert!((total(0) - (69.0 + PI / 4.0)).abs() < 1e-4);
    assert!((total(1) - 117.863_898_104_678_9).abs() < 1e-4, "{}", total(1));
    let sum = |k: usize| table.iter().map(|row| row[k]).sum::<f64>();
    assert!((sum(0) - 69.785_398_163_397_4).abs() < 1e-12);
    assert!((sum(1) - 117.863_898_104_678_9).abs() < 1e-12);
}

/// Evaluates section 2's tree of splits, with section 1's depths and directions.
fn by_splits(d: f64, z: f64) -> (usize, f64, [f64; 2]) {
    let parabola = 4.0 * d - 16.0 + (z - 11.0) * (z - 11.0);
    let q = z - 16.0 + 3.0 * S2 - (S2 - 1.0) * d;
    let owner = if z <= 11.0 {
        if z + d < 5.0 {
            0
        } else if d >= 3.0 {
            if z > d + 6.0 { 2 } else { 1 }
        } else if parabola > 0.0 {
            1
        } else {
            3
        }
    } else if z <= 15.0 {
        if q < 0.0 {
            4
        } else if z - d > 14.0 {
            6
        } else {
            5
        }
    } else if z <= 19.0 {
        7
    } else {
        8
    };
    let toward = |qd: f64, qz: f64| {
        let m = (qd - d).hypot(qz - z);
        (m, [(qd - d) / m, (qz - z) / m])
    };
    let (m, u) = match owner {
        0 => (z, [0.0, -1.0]),
        1 => (5.0 - d, [1.0, 0.0]),
        2 => (11.0 - z, [0.0, 1.0]),
        3 => toward(3.0, 11.0),
        4 => (3.0 - d, [1.0, 0.0]),
        5 => ((16.0 - d - z) / S2, [1.0 / S2, 1.0 / S2]),
        6 => toward(1.0, 15.0),
        7 => (1.0 - d, [1.0, 0.0]),
        _ => {
            let rho = d.hypot(z - 19.0);
            (1.0 - rho, [d / rho, (z - 19.0) / rho])
        }
    };
    (owner, m, u)
}

#[test]
fn the_splits_find_the_nearest_feature() {
    let tool = fig_7_3_exact();
    let mut rng = Rng::new(73);
    let (mut inside, mut skipped) = (0, 0);
    while inside < 100_000 {
        let (d, z) = (rng.between(0.0, 5.0), rng.between(0.0, 20.0));
        let p = at(d, z);
        let Some(s) = tool.evaluate(p) else { continue };
        inside += 1;
        let (owner, m, u) = by_splits(d, z);
        assert!((s.depth - m).abs() < 1e-14, "{d} {z} {s:?}");
        if tool.border_distance(p) < 1e-9 {
            skipped += 1;
            continue;
        }
        assert_eq!(table_row(s.owner), owner, "{d} {z}");
        assert!((s.direction[0] - u[0]).abs() < 1e-12 && (s.direction[2] + u[1]).abs() < 1e-12);
    }
    assert!(skipped < 10);
}

#[test]
fn the_axis_has_the_owners_of_the_table() {
    let tool = fig_7_3_exact();
    let ends = [0.0, 5.0, 7.0, 11.0, 16.0 - 3.0 * S2, 14.0, 15.0, 19.0, 20.0];
    for (w, owner) in ends.windows(2).zip([0, 1, 3, 4, 5, 6, 7, 8]) {
        for t in [0.01, 0.5, 0.99] {
            let s = tool.evaluate(at(0.0, w[0] + t * (w[1] - w[0]))).expect("inside");
            assert_eq!(table_row(s.owner), owner);
        }
    }
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
    let total: f64 = integrate(&thesis, 100).iter().map(|row| row[1]).sum();
    let mean = (total - 117.863_898_104_678_9) / 69.785_398_163_397_4;
    assert!((mean - 0.115_56).abs() < 5e-5, "{mean}");
}

#[test]
fn the_thesis_magnitudes_meet_without_a_jump() {
    let tool = Fig73::default();
    for curve in tool.curves().iter().skip(7) {
        for c in curve {
            let m =
                |dd: f64, dz: f64| tool.evaluate([c[0] + dd, 0.0, c[1] + dz]).map(|s| s.magnitude);
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

/// Returns the distance to the nearest feature outside, by section 4's table.
fn outside(d: f64, z: f64) -> f64 {
    let to = |qd: f64, qz: f64| (d - qd).hypot(z - qz);
    let a = d * d + (z - 19.0) * (z - 19.0);
    let l = 10.0 * d - 16.0 * z + 216.0;
    let lower = z <= 11.0
        || (z <= 19.0 && z - d - 8.0 <= 0.0)
        || (z > 19.0 && l >= 0.0 && l * l >= 4.0 * a);
    if lower {
        match (z, d) {
            _ if z < 0.0 && d <= 5.0 => -z,
            _ if z < 0.0 => to(5.0, 0.0),
            _ if z <= 11.0 => d - 5.0,
            _ if d <= 5.0 => z - 11.0,
            _ => to(5.0, 11.0),
        }
    } else if z > 19.0 {
        a.sqrt() - 1.0
    } else if z <= 13.0 {
        d - 3.0
    } else if z - d <= 10.0 && 4.0 * (d - 2.0) > (z - 13.0) * (z - 13.0) {
        to(3.0, 13.0)
    } else if z - d <= 10.0 || z - 16.0 + S2 - (S2 - 1.0) * d > 0.0 {
        d - 1.0
    } else {
        (d + z - 16.0) / S2
    }
}

#[test]
fn the_outside_of_the_table() {
    let tool = fig_7_3_exact();
    let mut rng = Rng::new(4);
    for _ in 0..100_000 {
        let (d, z) = (rng.between(0.0, 40.0), rng.between(-20.0, 60.0));
        let p = at(d, z);
        if tool.evaluate(p).is_none() {
            let got = tool.signed_distance(p);
            assert!((got - outside(d, z)).abs() < 1e-13, "{:?} {got}", Meridian::of(p));
        }
    }
}
