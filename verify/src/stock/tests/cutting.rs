//! Cuts against closed forms.

use super::*;
use std::f64::consts::PI;

/// An end mill cuts a slot into a box. Every node is compared with the slot, and the volume with slots that
/// are larger and smaller by the resolution.
#[test]
fn a_slot_has_its_volume() {
    let (radius, depth, [from, to]) = (3.0, 5.0, [15.0, 45.0]);
    for spacing in [1.0, 0.5, 0.25] {
        let mut stock = block([0.0, 0.0, -12.0], [60.0, 20.0, 0.0], spacing);
        let poses = [from, to].map(|x| upright([x, 10.0, -depth]));
        let contacts = advance(&mut stock, &Mill, poses, MotionMode::Feed, 0.0);
        assert_eq!(contacts, []);
        // Between samples the side is scalloped.
        let scallop = stock.step().powi(2) / (8.0 * radius) + 1e-6;
        for (at, is_left) in nodes(&stock) {
            let distance = (at[0] - at[0].clamp(from, to)).hypot(at[1] - 10.0);
            let inside = (radius - distance).min(at[2] + depth);
            assert!(if is_left { inside < scallop } else { inside > -1e-6 }, "{at:?} {inside}");
        }
        let volume = |margin: f64| {
            let radius = radius + margin;
            (2.0 * radius * (to - from) + PI * radius * radius) * (depth + margin)
        };
        let removed = 60.0 * 20.0 * 12.0 - stock.volume();
        let resolution = stock.missed_ball_radius() + 0.5 * stock.step();
        println!("spacing {spacing}: removed {removed:.1} mm³ of {:.1}", volume(0.0));
        assert!(volume(-resolution) < removed && removed < volume(resolution), "{removed}");
        // The errors along the wall cancel for the most part.
        assert!((removed / volume(0.0) - 1.0).abs() < 0.05 * spacing, "{removed}");
    }
}

/// A ball cuts parallel lines. The height of the cusps between them is `R − √(R² − (p/2)²)`, with p the
/// distance of the lines.
#[test]
fn a_ball_leaves_cusps_of_their_height() {
    let (radius, pitch, floor, spacing) = (3.0, 2.0, -2.0, 0.05);
    let mut stock = block([0.0, 0.0, -3.0], [2.0, 6.0, 0.0], spacing);
    for y in [-1.0, 1.0, 3.0, 5.0, 7.0] {
        let poses = [-4.0, 6.0].map(|x| upright([x, y, floor]));
        assert_eq!(advance(&mut stock, &Ball, poses, MotionMode::Feed, 0.0), []);
    }
    let height = |from_line: f64| radius - (radius * radius - from_line * from_line).sqrt();
    let sampling = stock.step().powi(2) / (8.0 * radius) + 1e-6;
    let remaining = stock.remaining();
    let [columns, rows, layers] = stock.lattice.counts();
    let mut highest = f64::NEG_INFINITY;
    for (i, j) in (0..columns).flat_map(|i| (0..rows).map(move |j| (i, j))) {
        let left = |k: &usize| remaining.contains(stock.lattice.index([i, j, *k]));
        let count = (0..layers).take_while(left).count();
        assert_eq!((0..layers).filter(left).count(), count, "a column has a gap");
        let top = stock.lattice.coordinate(2, count as f64 - 1.0) - floor;
        // The distance to the nearest line, which are at odd y.
        let y = stock.lattice.coordinate(1, j as f64);
        let expected = height((y.rem_euclid(pitch) - 1.0).abs());
        assert!(
            top <= expected + sampling && top > expected - spacing - 1e-6,
            "{y} {top} {expected}"
        );
        highest = highest.max(top);
    }
    let cusp = height(0.5 * pitch);
    println!("cusps {cusp:.4} mm high, highest point at {highest:.4} mm");
    assert!(highest <= cusp + sampling && highest > height(0.5 * pitch - 0.5 * spacing) - spacing);
}

/// A solid without an axis, turned by a quarter, cuts a slot of its other width.
#[test]
fn a_solid_cuts_by_its_sides() {
    touchoff::tool! {
        solid Punch "a box of 6 × 4 × 3 mm" {
            units mm;
            curve inside = min(3 - abs(x), 2 - abs(y), z, 3 - z);
            region punch as punch cutting where inside >= 0 { depth: inside; }
            niceness cutting: 1;
        }
    }
    let half = std::f64::consts::FRAC_1_SQRT_2;
    for (quaternion, width) in [([0.0, 0.0, 0.0, 1.0], 2.0), ([0.0, 0.0, half, half], 3.0)] {
        let mut stock = block([0.0, -10.0, -10.0], [40.0, 10.0, 0.0], 0.5);
        let [from, to] = [-300.0, 300.0]
            .map(|x| Pose::from_quaternion(Point3::new(x, 0.0, -2.0), quaternion).expect("a pose"));
        let motion = Motion::with_spin(&from, &to).expect("a motion");
        let travel = stock.max_travel(&Punch, &motion);
        let feed = MotionMode::Feed;
        let contacts = stock.advance(&Punch, &|time| motion.pose(time), travel, feed, 0.0);
        assert_eq!(contacts, Ok(vec![]));
        for (at, is_left) in nodes(&stock) {
            assert_eq!(is_left, at[1].abs() > width || at[2] < -2.0, "{at:?}");
        }
    }
}

/// A motion that is far away, or passes the stock in front, removes nothing; one in the next place cuts.
#[test]
fn motions_outside_remove_nothing() {
    let mut stock = block([0.0; 3], [10.0; 3], 0.5);
    for [from, to] in [
        [[-500.0, 0.0, 50.0], [500.0, 0.0, 50.0]],
        [[-50.0, 0.0, 10.01], [50.0, 0.0, 10.01]],
        [[-50.0, -3.01, 0.0], [50.0, -3.01, 0.0]],
        [[5.0, 5.0, 100.0], [5.0, 5.0, 10.01]],
        [[1e30, 0.0, 0.0], [1e30, 1.0, 0.0]],
    ] {
        for mode in [MotionMode::Feed, MotionMode::Rapid] {
            assert_eq!(advance(&mut stock, &Mill, [upright(from), upright(to)], mode, 0.0), []);
            assert_eq!(stock.len(), 8000);
        }
    }
    let poses = [[5.0, 5.0, 100.0], [5.0, 5.0, 9.0]].map(upright);
    assert_eq!(advance(&mut stock, &Mill, poses, MotionMode::Feed, 0.0), []);
    // Two layers of a circle with a radius of six spacings.
    let circle =
        (-6..6).flat_map(|i| (-6..6).map(move |j| (f64::from(i) + 0.5).hypot(f64::from(j) + 0.5)));
    assert_eq!(stock.len(), 8000 - 2 * circle.filter(|radius| *radius <= 6.0).count());
}

/// A stock that is cut away entirely has no volume, no surface and no contacts.
#[test]
fn nothing_can_be_left() {
    let mut stock = block([0.0; 3], [4.0, 4.0, 2.0], 0.5);
    let poses = [-10.0, 10.0].map(|x| upright([x, 2.0, -1.0]));
    assert_eq!(advance(&mut stock, &Mill, poses, MotionMode::Feed, 0.0), []);
    assert!(stock.is_empty() && stock.volume() == 0.0);
    assert_eq!(stock.remaining_mesh(), Err(StockError::NothingLeft));
    assert_eq!(advance(&mut stock, &Mill, poses, MotionMode::Rapid, 0.0), []);
}

/// The same motions give the same results to the bit.
#[test]
fn results_are_deterministic() {
    let run = || {
        let mut stock = block([-8.0; 3], [8.0; 3], 0.5);
        let (mut random, mut found) = (Random(7), Vec::new());
        let mut from = upright([30.0, 0.0, 0.0]);
        for k in 0..40 {
            let tip = Point3::from(20.0 * direction(&mut random));
            let to = Pose::from_axis(tip, direction(&mut random)).expect("a pose");
            let mode = if k % 3 == 0 { MotionMode::Rapid } else { MotionMode::Feed };
            found.push(advance(&mut stock, &Reduced, [from, to], mode, 0.05));
            from = to;
        }
        (found, stock.remaining())
    };
    let (first, second) = (run(), run());
    assert!(first.0.iter().flatten().count() > 20 && first.1.len() < 30_000);
    assert_eq!(first, second);
}
