//! What is left of a rotation after many of them.

use nalgebra::{Matrix3, Point3, Unit, UnitQuaternion, Vector3};
use std::time::Instant;
use touchoff::Pose;
use touchoff_tests::oracle::big::Big;

/// Nine numbers to 256 bits, row by row.
type Matrix = [[Big; 3]; 3];

/// A rotation that is composed with itself.
#[derive(Clone, Copy, Debug)]
pub struct Turn {
    /// What it is about.
    pub axis: [f64; 3],
    /// By how much, in radians.
    pub angle: f64,
}

impl Turn {
    /// Small and large, about any axis and about those of the frame, and such as come back to where they began.
    pub fn all() -> Vec<Turn> {
        use std::f64::consts::{FRAC_PI_2, FRAC_PI_3, TAU};
        let turn = |axis: [f64; 3], angle: f64| Turn { axis, angle };
        vec![
            turn([1.0, 2.0, 3.0], 1e-3),
            turn([3.0, -1.0, 2.0], 1.0),
            turn([-0.2, 0.7, 0.1], 1e-9),
            turn([0.0, 0.0, 1.0], TAU / 360.0),
            turn([1.0, 1.0, 1.0], FRAC_PI_3),
            turn([0.0, 1.0, 0.0], FRAC_PI_2),
            turn([0.6, -0.5, 2.0], TAU / 7.0),
        ]
    }

    /// Whether so few of them that it matters are once round.
    pub fn comes_round(&self) -> bool {
        let times = std::f64::consts::TAU / self.angle;
        times < 1e3 && (times - times.round()).abs() < 1e-9
    }

    /// The motion: about a point that is not the origin.
    ///
    /// # Panics
    /// If the axis has no length.
    pub fn motion(&self) -> Pose {
        let axis = Unit::new_normalize(Vector3::from(self.axis));
        let turn = UnitQuaternion::from_axis_angle(&axis, self.angle);
        let fixed = Point3::new(10.0, -20.0, 5.0);
        let q = turn.coords;
        let tip = fixed - turn * fixed.coords;
        Pose::from_quaternion(Point3::from(tip.coords), [q.x, q.y, q.z, q.w])
            .expect("a unit quaternion")
    }
}

/// What is found after so many compositions.
#[derive(Clone, Copy, Debug)]
pub struct Row {
    /// The rotation.
    pub turn: Turn,
    /// How many.
    pub count: usize,
    /// The largest entry of `RᵀR - I` on the way, in ε.
    pub apart: f64,
    /// The angle between the last rotation and the true one, in radians.
    pub angle: f64,
    /// The same two of products that are left as they are.
    pub plain: [f64; 2],
    /// By how much the tip's distance from the axis has changed, by that distance.
    pub tip: f64,
    /// Nanoseconds of a composition, and of the plain product with its tip.
    pub ns: [f64; 2],
}

/// The largest entry of `RᵀR - I`, in ε: products without rounding, sums of six as if in twice the precision.
pub fn apart(rotation: &Matrix3<f64>) -> f64 {
    let mut most = 0f64;
    for i in 0..3 {
        for j in i..3 {
            let (mut sum, mut rest) = (if i == j { -1.0 } else { 0.0 }, 0.0);
            for k in 0..3 {
                let (a, b) = (rotation[(k, i)], rotation[(k, j)]);
                let product = a * b;
                rest += a.mul_add(b, -product);
                // Knuth's sum of two: what it rounds away is known.
                let total: f64 = sum + product;
                let back = total - sum;
                rest += (sum - (total - back)) + (product - back);
                sum = total;
            }
            most = most.max((sum + rest).abs());
        }
    }
    most / f64::EPSILON
}

fn exactly(rotation: &Matrix3<f64>) -> Matrix {
    [0, 1, 2].map(|i| [0, 1, 2].map(|j| Big::exactly(rotation[(i, j)])))
}

fn product(a: &Matrix, b: &Matrix) -> Matrix {
    let entry = |i: usize, j: usize| {
        &(&(&a[i][0] * &b[0][j]) + &(&a[i][1] * &b[1][j])) + &(&a[i][2] * &b[2][j])
    };
    [0, 1, 2].map(|i| [0, 1, 2].map(|j| entry(i, j)))
}

fn transposed(a: &Matrix) -> Matrix {
    [0, 1, 2].map(|i| [0, 1, 2].map(|j| a[j][i].clone()))
}

/// The nearest rotation, by Newton's method for the inverse of what is turned back: `(R + R⁻ᵀ)/2`, with `R⁻ᵀ` from cofactors.
fn nearest(matrix: &Matrix) -> Matrix {
    let mut r = matrix.clone();
    for _ in 0..6 {
        let minor = |i: usize, j: usize| {
            let [i1, i2, j1, j2] = [(i + 1) % 3, (i + 2) % 3, (j + 1) % 3, (j + 2) % 3];
            &(&r[i1][j1] * &r[i2][j2]) - &(&r[i1][j2] * &r[i2][j1])
        };
        let cofactors = [0, 1, 2].map(|i| [0, 1, 2].map(|j| minor(i, j)));
        let mut det = Big::zero();
        for (entry, cofactor) in r[0].iter().zip(&cofactors[0]) {
            det = &det + &(entry * cofactor);
        }
        let half = Big::exactly(0.5);
        let mean = |i: usize, j: usize| &(&r[i][j] + &(&cofactors[i][j] / &det)) * &half;
        r = [0, 1, 2].map(|i| [0, 1, 2].map(|j| mean(i, j)));
    }
    r
}

/// A rotation so many times, to 256 bits.
fn power(rotation: &Matrix, count: usize) -> Matrix {
    let mut result = exactly(&Matrix3::identity());
    let mut square = rotation.clone();
    let mut left = count;
    while left > 0 {
        if left & 1 == 1 {
            result = product(&square, &result);
        }
        square = product(&square, &square);
        left >>= 1;
    }
    result
}

/// The angle of the rotation from one to another that is nearly the same, in radians.
fn between(a: &Matrix, b: &Matrix) -> f64 {
    let off = product(&transposed(a), b);
    let half = |i: usize, j: usize| (&off[i][j] - &off[j][i]).to_f64() / 2.0;
    let sine = (half(2, 1).powi(2) + half(0, 2).powi(2) + half(1, 0).powi(2)).sqrt();
    let trace = (&(&off[0][0] + &off[1][1]) + &off[2][2]).to_f64();
    sine.atan2((trace - 1.0) / 2.0)
}

/// The angle between a rotation and what so many of a motion make of another, to 256 bits.
pub fn angle(start: &Pose, motion: &Pose, count: usize, end: &Matrix3<f64>) -> f64 {
    let turns = power(&nearest(&exactly(motion.rotation())), count);
    let expected = product(&turns, &nearest(&exactly(start.rotation())));
    between(&expected, &nearest(&exactly(end)))
}

/// Composes a rotation with itself so many times; how far from a rotation it is is looked at each so often.
///
/// # Panics
/// Never: the start is a pose.
pub fn row(turn: Turn, count: usize, every: usize) -> Row {
    let motion = turn.motion();
    let start = Pose::from_quaternion(Point3::new(1.0, 2.0, 3.0), [0.1, -0.7, 0.5, 0.5]);
    let start = start.expect("a unit quaternion");
    let (mut pose, mut most) = (start, 0f64);
    for k in 0..count {
        pose = pose.then(&motion);
        if k.is_multiple_of(every) {
            most = most.max(apart(pose.rotation()));
        }
    }
    most = most.max(apart(pose.rotation()));
    let mut plain = (*start.rotation(), start.tip());
    let begun = Instant::now();
    for _ in 0..count {
        plain.1 = motion.tip() + motion.rotation() * plain.1.coords;
        plain.0 = motion.rotation() * plain.0;
    }
    let plainly = begun.elapsed();
    let mut timed = start;
    let begun = Instant::now();
    for _ in 0..count {
        timed = timed.then(&motion);
    }
    let took = begun.elapsed();
    assert_eq!(timed, pose, "the same bits on every run");
    let axis = Unit::new_normalize(Vector3::from(turn.axis));
    let from_axis = |tip: Point3<f64>| (tip - Point3::new(10.0, -20.0, 5.0)).cross(&axis).norm();
    let ns = |time: std::time::Duration| time.as_secs_f64() * 1e9 / count as f64;
    Row {
        turn,
        count,
        apart: most,
        angle: angle(&start, &motion, count, pose.rotation()),
        plain: [apart(&plain.0), angle(&start, &motion, count, &plain.0)],
        tip: (from_axis(pose.tip()) / from_axis(start.tip()) - 1.0).abs(),
        ns: [ns(took), ns(plainly)],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchoff_tests::oracle::draw::Draw;

    /// What doubles say of a matrix is what 256 bits say.
    #[test]
    fn how_far_from_a_rotation() {
        let mut draw = Draw::new(4);
        for _ in 0..200 {
            let mut r =
                *Turn { axis: draw.direction(), angle: draw.between(0.0, 6.0) }.motion().rotation();
            r[(0, 1)] += draw.between(-1e-14, 1e-14);
            let big = exactly(&r);
            let off = product(&transposed(&big), &big);
            let entry = |i: usize, j: usize| {
                let one = Big::exactly(f64::from(u8::from(i == j)));
                (&off[i][j] - &one).abs().to_f64()
            };
            let most = (0..9).map(|k| entry(k / 3, k % 3)).fold(0.0, f64::max) / f64::EPSILON;
            assert!((most - apart(&r)).abs() < 1e-9 * most.max(1.0), "{most} {}", apart(&r));
        }
    }

    #[test]
    fn powers_come_round() {
        let quarter = exactly(&Matrix3::new(0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0));
        assert_eq!(between(&power(&quarter, 1_000_001), &quarter), 0.0);
        let third = Turn { axis: [1.0, 1.0, 1.0], angle: std::f64::consts::TAU / 3.0 }.motion();
        let found = between(
            &power(&nearest(&exactly(third.rotation())), 3),
            &exactly(&Matrix3::identity()),
        );
        assert!(found < 1e-15, "{found}");
    }
}
