//! The stock of a later set-up.

use super::*;
use nalgebra::{Matrix3, Point3};

/// Returns the positions of the points that are left, in thousandths, sorted.
fn positions(stock: &Stock, place: impl Fn(Point3<f64>) -> Point3<f64>) -> Vec<[i64; 3]> {
    let points = stock.remaining();
    let points = points.iter().map(|node| place(stock.lattice.position(node).into()));
    let mut points: Vec<[i64; 3]> = points
        .map(|point| <[f64; 3]>::from(point.coords).map(|value| (1000.0 * value).round() as i64))
        .collect();
    points.sort_unstable();
    points
}

/// In each of the 24 quarter turns, the points are those of the earlier set-up, moved as its frame is.
#[test]
fn points_of_a_set_up_move_with_its_frame() {
    let mut stock = block([-9.0, -6.0, -5.0], [12.0, 7.0, 0.5], 0.5);
    let whole = stock.len();
    let motion = Motion::new(&upright([-20.0, 2.0, -3.0]), &upright([4.0, 5.0, -2.0]));
    let motion = motion.expect("a motion");
    let travel = stock.max_travel(&Mill, &motion);
    let cut = |time| motion.pose(time);
    stock.advance(&Mill, &cut, travel, MotionMode::Feed, 0.1).expect("contacts");
    let left = stock.remaining_points();
    assert!(stock.len() < whole && !stock.is_empty());
    // Its box is half a spacing larger than the points.
    let points = positions(&stock, |point| point);
    let (lowest, highest) =
        (points.iter().map(|point| point[2]).min(), points.iter().map(|point| point[2]).max());
    let [low, high] = left.bounds().map(|corner| (1000.0 * corner.z).round() as i64);
    assert_eq!((Some(low + 250), Some(high - 250)), (lowest, highest));
    let origin = Point3::new(3.0, -200.0, 17.25);
    let units = [0, 1, 2].map(|axis| Vector3::ith(axis, 1.0));
    let directions: Vec<Vector3<f64>> = units.into_iter().flat_map(|unit| [unit, -unit]).collect();
    let mut turns = 0;
    for x in &directions {
        for z in directions.iter().filter(|z| z.dot(x) == 0.0) {
            let placed = left.placed(origin, (*x).into(), (*z).into()).expect("a quarter turn");
            let placed = Stock::from_points(&placed).expect("a stock");
            let rotation = Matrix3::from_columns(&[*x, z.cross(x), *z]);
            let expected = positions(&stock, |point| origin + rotation * point.coords);
            assert_eq!(positions(&placed, |point| point), expected, "{x:?} {z:?}");
            assert_eq!((placed.spacing(), placed.len()), (stock.spacing(), stock.len()));
            turns += 1;
        }
    }
    assert_eq!(turns, 24);
    for (x, z) in [
        ([1.0, 0.0, 0.0], [-1.0, 0.0, 0.0]),
        ([0.6, 0.8, 0.0], [0.0, 0.0, 1.0]),
        ([2.0, 0.0, 0.0], [0.0, 0.0, 1.0]),
        ([0.0, 0.0, 0.0], [0.0, 0.0, 1.0]),
        ([f64::NAN, 0.0, 0.0], [0.0, 0.0, 1.0]),
    ] {
        let refused = left.placed(origin, x, z);
        assert!(matches!(refused, Err(StockError::Turn { .. })), "{x:?} {z:?}");
    }
    let far = left.placed(Point3::new(1e30, 0.0, 0.0), [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]);
    assert!(matches!(far, Err(StockError::Resolution { .. })));
}
