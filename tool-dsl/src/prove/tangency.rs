//! Conics that touch. No box around the point of contact, however small, separates their signs, but a
//! combination of the two can (the S-lemma). The proof uses the 256 bits of constants.

use crate::expr::polynomial::Polynomial;
use crate::number::{Number, ROUNDING};

/// A conic's six coefficients: 1, d, z, d², dz, z².
type Conic<N> = [N; 6];

/// The number of Newton steps from a double to a point of 256 bits. Each gains as many digits as a double
/// has, less those lost if the point is badly conditioned.
const NEWTON_STEPS: usize = 24;

fn conic(polynomial: &Polynomial) -> Option<Conic<Number>> {
    let mut factors = [(); 6].map(|()| Number::int(0));
    for (monomial, value) in polynomial.terms() {
        let at = match monomial {
            [0, 0, 0, 0] => 0,
            [1, 0, 0, 0] => 1,
            [0, 0, 0, 1] => 2,
            [2, 0, 0, 0] => 3,
            [1, 0, 0, 1] => 4,
            [0, 0, 0, 2] => 5,
            _ => return None,
        };
        factors[at] = value.clone();
    }
    Some(factors)
}

fn slope(c: &Conic<f64>, [d, z]: [f64; 2]) -> [f64; 2] {
    [c[1] + 2.0 * c[3] * d + c[4] * z, c[2] + c[4] * d + 2.0 * c[5] * z]
}

fn exact_value(c: &Conic<Number>, [d, z]: &[Number; 2]) -> (Number, f64) {
    let [dd, dz, zz] = [&(&c[3] * d) * d, &(&c[4] * d) * z, &(&c[5] * z) * z];
    Number::sum(&[c[0].clone(), &c[1] * d, &c[2] * z, dd, dz, zz])
}

fn exact_slope(c: &Conic<Number>, [d, z]: &[Number; 2]) -> [Number; 2] {
    let two = Number::int(2);
    let d_slope = Number::sum(&[c[1].clone(), &(&two * &c[3]) * d, &c[4] * z]).0;
    [d_slope, Number::sum(&[c[2].clone(), &c[4] * d, &(&two * &c[5]) * z]).0]
}

/// Returns the step from a point where conic `b`'s value and the cross product of both gradients have these
/// values to one where they are nearly 0.
fn newton_step([a, b]: [&Conic<f64>; 2], p: [f64; 2], [first, second]: [f64; 2]) -> [f64; 2] {
    let ([ad, az], [bd, bz]) = (slope(a, p), slope(b, p));
    let d_derivative = 2.0 * a[3] * bz + ad * b[4] - a[4] * bd - az * 2.0 * b[3];
    let z_derivative = a[4] * bz + ad * 2.0 * b[5] - 2.0 * a[5] * bd - az * b[4];
    let determinant = bd * z_derivative - bz * d_derivative;
    [
        (first * z_derivative - bz * second) / determinant,
        (bd * second - first * d_derivative) / determinant,
    ]
}

/// The contact of two conics near a point.
#[derive(Clone)]
pub(super) struct Contact {
    slopes: [[Number; 2]; 2],
    conics: [Conic<Number>; 2],
}

impl Contact {
    /// Returns the point near another at which two conics touch, if there is one.
    pub(super) fn near(
        a: &Polynomial,
        b: &Polynomial,
        near: [f64; 2],
        size: f64,
    ) -> Option<Contact> {
        let conics = [conic(a)?, conic(b)?];
        let [a, b] = conics.each_ref().map(|conic| conic.each_ref().map(Number::to_f64));
        // The equations: one conic's value and the cross product of both gradients are 0. The first half of
        // the steps uses doubles.
        let mut p = near;
        for _ in 0..NEWTON_STEPS / 2 {
            let ([ad, az], [bd, bz]) = (slope(&a, p), slope(&b, p));
            let value = b[0] + b[1] * p[0] + b[2] * p[1];
            let quadratic = b[3] * p[0] * p[0] + b[4] * p[0] * p[1] + b[5] * p[1] * p[1];
            let step = newton_step([&a, &b], p, [value + quadratic, ad * bz - az * bd]);
            p = [p[0] - step[0], p[1] - step[1]];
        }
        // False for NaN too.
        let is_near = (p[0] - near[0]).hypot(p[1] - near[1]) < 1e-2 * size;
        let mut at = p.map(|at| Number::from_f64(at).filter(|_| is_near));
        for _ in NEWTON_STEPS / 2..NEWTON_STEPS {
            let [Some(d), Some(z)] = &at else { return None };
            let exact = [d.clone(), z.clone()];
            let [[ad, az], [bd, bz]] = conics.each_ref().map(|c| exact_slope(c, &exact));
            let cross = &(&ad * &bz) - &(&az * &bd);
            let values = [exact_value(&conics[1], &exact).0.to_f64(), cross.to_f64()];
            let step = newton_step([&a, &b], [d.to_f64(), z.to_f64()], values);
            at = [0, 1].map(|k| Some(&exact[k] - &Number::from_f64(step[k])?));
        }
        let [Some(d), Some(z)] = at else { return None };
        let point = [d, z];
        let is_zero = |(value, size): (Number, f64)| value.to_f64().abs() <= ROUNDING * size;
        let slopes = conics.each_ref().map(|conic| exact_slope(conic, &point));
        let [[ad, az], [bd, bz]] = &slopes;
        let touches = conics.iter().all(|conic| is_zero(exact_value(conic, &point)))
            && is_zero(Number::sum(&[ad * bz, -&(az * bd)]));
        touches.then_some(Contact { slopes, conics })
    }

    /// Returns whether `from · a ≥ 0` implies `to · b ≥ 0`, for `from` and `to` of 1 or -1. Then `to b` is a
    /// positive multiple of `from a` plus a sum of squares that is 0 at the point of contact.
    pub(super) fn implies(&self, from: i64, to: i64) -> bool {
        let [a, b] = &self.conics;
        let [[ad, az], [bd, bz]] = &self.slopes;
        let (dot_product, _) = Number::sum(&[ad * bd, az * bz]);
        let (length, _) = Number::sum(&[ad * ad, az * az]);
        let Some(ratio) = (&Number::int(to * from) * &dot_product).checked_div(&length) else {
            return false;
        };
        if ratio.is_zero() || ratio.is_negative() {
            return false;
        }
        let [from, to] = [from, to].map(Number::int);
        let quadratic = |k: usize| Number::sum(&[&to * &b[k], -&(&ratio * &(&from * &a[k]))]);
        let [(dd, dd_size), (dz, dz_size), (zz, zz_size)] = [3, 4, 5].map(quadratic);
        let size = dd_size.max(dz_size).max(zz_size);
        let (discriminant, _) = Number::sum(&[&(&Number::int(4) * &dd) * &zz, -&(&dz * &dz)]);
        let is_not_negative = |value: &Number, size: f64| value.to_f64() >= -ROUNDING * size;
        is_not_negative(&dd, size)
            && is_not_negative(&zz, size)
            && is_not_negative(&discriminant, size * size)
    }
}
