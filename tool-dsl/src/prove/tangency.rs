//! Conics that touch. No box around the point of contact, however small, separates their signs, but a
//! combination of the two can (the S-lemma). The proof uses the 256 bits of constants.

use crate::expr::polynomial::Polynomial;
use crate::number::{Number, ROUNDING};

/// The coefficients of a conic: of 1, d, z, d², d z and z².
#[derive(Clone)]
struct Conic<N> {
    one: N,
    d: N,
    z: N,
    dd: N,
    dz: N,
    zz: N,
}

/// The number of Newton steps from a double to a point of 256 bits. Each gains as many digits as a double
/// has, less those lost if the point is badly conditioned.
const NEWTON_STEPS: usize = 24;

impl Conic<Number> {
    fn of(polynomial: &Polynomial) -> Option<Conic<Number>> {
        let factor = |d, z| polynomial.exact_factor([d, 0, 0, z]);
        polynomial.is_conic().then(|| Conic {
            one: factor(0, 0),
            d: factor(1, 0),
            z: factor(0, 1),
            dd: factor(2, 0),
            dz: factor(1, 1),
            zz: factor(0, 2),
        })
    }

    fn rounded(&self) -> Conic<f64> {
        let Conic { one, d, z, dd, dz, zz } = self;
        let [one, d, z, dd, dz, zz] = [one, d, z, dd, dz, zz].map(Number::to_f64);
        Conic { one, d, z, dd, dz, zz }
    }

    /// Returns the value at a point, and the sum of the absolute values of its terms.
    fn value(&self, [d, z]: &[Number; 2]) -> (Number, f64) {
        let [dd, dz, zz] = [&(&self.dd * d) * d, &(&self.dz * d) * z, &(&self.zz * z) * z];
        Number::sum(&[self.one.clone(), &self.d * d, &self.z * z, dd, dz, zz])
    }

    fn gradient(&self, [d, z]: &[Number; 2]) -> [Number; 2] {
        let two = Number::int(2);
        let by_d = Number::sum(&[self.d.clone(), &(&two * &self.dd) * d, &self.dz * z]).0;
        [by_d, Number::sum(&[self.z.clone(), &self.dz * d, &(&two * &self.zz) * z]).0]
    }
}

impl Conic<f64> {
    fn value(&self, [d, z]: [f64; 2]) -> f64 {
        let linear = self.one + self.d * d + self.z * z;
        linear + (self.dd * d * d + self.dz * d * z + self.zz * z * z)
    }

    fn gradient(&self, [d, z]: [f64; 2]) -> [f64; 2] {
        [self.d + 2.0 * self.dd * d + self.dz * z, self.z + self.dz * d + 2.0 * self.zz * z]
    }
}

/// Returns the step from a point where conic `b`'s value and the cross product of both gradients have these
/// values to one where they are nearly 0.
fn newton_step([a, b]: [&Conic<f64>; 2], p: [f64; 2], [first, second]: [f64; 2]) -> [f64; 2] {
    let ([ad, az], [bd, bz]) = (a.gradient(p), b.gradient(p));
    let d_derivative = 2.0 * a.dd * bz + ad * b.dz - a.dz * bd - az * 2.0 * b.dd;
    let z_derivative = a.dz * bz + ad * 2.0 * b.zz - 2.0 * a.zz * bd - az * b.dz;
    // The inverse of the 2 × 2 matrix of the derivatives, by Cramer's rule.
    let determinant = bd * z_derivative - bz * d_derivative;
    [
        (first * z_derivative - bz * second) / determinant,
        (bd * second - first * d_derivative) / determinant,
    ]
}

/// The contact of two conics near a point.
#[derive(Clone)]
pub(super) struct Contact {
    gradients: [[Number; 2]; 2],
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
        let conics = [Conic::of(a)?, Conic::of(b)?];
        let [a, b] = conics.each_ref().map(Conic::rounded);
        // The equations: one conic's value and the cross product of both gradients are 0. The first half of
        // the steps uses doubles.
        let mut p = near;
        for _ in 0..NEWTON_STEPS / 2 {
            let ([ad, az], [bd, bz]) = (a.gradient(p), b.gradient(p));
            let step = newton_step([&a, &b], p, [b.value(p), ad * bz - az * bd]);
            p = [p[0] - step[0], p[1] - step[1]];
        }
        // False for NaN too.
        let is_near = (p[0] - near[0]).hypot(p[1] - near[1]) < 1e-2 * size;
        let mut at = p.map(|at| Number::from_f64(at).filter(|_| is_near));
        for _ in NEWTON_STEPS / 2..NEWTON_STEPS {
            let [Some(d), Some(z)] = &at else { return None };
            let exact = [d.clone(), z.clone()];
            let [[ad, az], [bd, bz]] = conics.each_ref().map(|conic| conic.gradient(&exact));
            let cross = &(&ad * &bz) - &(&az * &bd);
            let values = [conics[1].value(&exact).0.to_f64(), cross.to_f64()];
            // The residuals have 256 bits; the matrix needs only a double's accuracy to gain a double's digits.
            let step = newton_step([&a, &b], [d.to_f64(), z.to_f64()], values);
            at = [0, 1].map(|k| Some(&exact[k] - &Number::from_f64(step[k])?));
        }
        let [Some(d), Some(z)] = at else { return None };
        let point = [d, z];
        let is_zero = |(value, size): (Number, f64)| value.to_f64().abs() <= ROUNDING * size;
        let gradients = conics.each_ref().map(|conic| conic.gradient(&point));
        let [[ad, az], [bd, bz]] = &gradients;
        // The search is in doubles and may stop anywhere, so the contact is checked.
        let touches = conics.iter().all(|conic| is_zero(conic.value(&point)))
            && is_zero(Number::sum(&[ad * bz, -&(az * bd)]));
        touches.then_some(Contact { gradients, conics })
    }

    /// Returns whether `from · a ≥ 0` implies `to · b ≥ 0`, for `from` and `to` of 1 or -1.
    pub(super) fn implies(&self, from: i64, to: i64) -> bool {
        let [a, b] = &self.conics;
        let [[ad, az], [bd, bz]] = &self.gradients;
        let (dot_product, _) = Number::sum(&[ad * bd, az * bz]);
        let (length, _) = Number::sum(&[ad * ad, az * az]);
        let Some(ratio) = (&Number::int(to * from) * &dot_product).checked_div(&length) else {
            return false;
        };
        // The S-lemma needs a positive multiple: of parallel gradients, the sides on which they point must agree.
        if ratio.is_zero() || ratio.is_negative() {
            return false;
        }
        let [from, to] = [from, to].map(Number::int);
        let rest = |of_a, of_b| Number::sum(&[&to * of_b, -&(&ratio * &(&from * of_a))]);
        let (dd, dd_size) = rest(&a.dd, &b.dd);
        let (dz, dz_size) = rest(&a.dz, &b.dz);
        let (zz, zz_size) = rest(&a.zz, &b.zz);
        let size = dd_size.max(dz_size).max(zz_size);
        // `to b - ratio · from a` is 0 at the point of contact with its gradient, so it is its quadratic part there, and
        // has to be a sum of squares.
        // A quadratic form is not negative if its diagonal and its determinant are not.
        let (discriminant, _) = Number::sum(&[&(&Number::int(4) * &dd) * &zz, -&(&dz * &dz)]);
        is_not_negative(&dd, size)
            && is_not_negative(&zz, size)
            && is_not_negative(&discriminant, size * size)
    }
}

/// Returns whether a sum of terms of a given size is not negative, up to rounding.
fn is_not_negative(value: &Number, size: f64) -> bool {
    value.to_f64() >= -ROUNDING * size
}
