//! Conics that touch: beside the point where they do, no box can tell their signs apart, however
//! small, but a combination of the two can.

use crate::expr::polynomial::Polynomial;

/// A conic's six factors: 1, d, z, d², dz, z².
type Conic = [f64; 6];

/// What of a conic's values is rounding.
const ROUNDING: f64 = 1e-11;

fn conic(polynomial: &Polynomial) -> Option<Conic> {
    let mut factors = [0.0; 6];
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
        factors[at] = value.to_f64();
    }
    Some(factors)
}

fn value(c: &Conic, [d, z]: [f64; 2]) -> f64 {
    c[0] + c[1] * d + c[2] * z + c[3] * d * d + c[4] * d * z + c[5] * z * z
}

fn slope(c: &Conic, [d, z]: [f64; 2]) -> [f64; 2] {
    [c[1] + 2.0 * c[3] * d + c[4] * z, c[2] + c[4] * d + 2.0 * c[5] * z]
}

/// Where two conics touch, near a point, and how.
#[derive(Clone)]
pub(super) struct Touch {
    at: [f64; 2],
    conics: [Conic; 2],
    size: f64,
}

impl Touch {
    /// The point near another at which two conics touch, if they do.
    pub(super) fn near(a: &Polynomial, b: &Polynomial, near: [f64; 2], size: f64) -> Option<Touch> {
        let conics = [conic(a)?, conic(b)?];
        let [a, b] = &conics;
        let mut p = near;
        for _ in 0..30 {
            let ([ad, az], [bd, bz]) = (slope(a, p), slope(b, p));
            // One conic's value and the cross product of the slopes are 0.
            let (first, second) = (value(b, p), ad * bz - az * bd);
            let down = 2.0 * a[3] * bz + ad * b[4] - a[4] * bd - az * 2.0 * b[3];
            let up = a[4] * bz + ad * 2.0 * b[5] - 2.0 * a[5] * bd - az * b[4];
            let det = bd * up - bz * down;
            let step = [(first * up - bz * second) / det, (bd * second - first * down) / det];
            p = [p[0] - step[0], p[1] - step[1]];
            if !(p[0].is_finite() && p[1].is_finite()) {
                return None;
            }
        }
        let touch = Touch { at: p, conics, size };
        let close = (p[0] - near[0]).hypot(p[1] - near[1]) < 1e-2 * size;
        let zero = |c: &Conic| {
            let [d, z] = slope(c, p);
            value(c, p).abs() <= ROUNDING * size * d.hypot(z)
        };
        (close && touch.conics.iter().all(zero)).then_some(touch)
    }

    /// Whether `from · a ≥ 0` makes `to · b ≥ 0`, with `from` and `to` one of 1 and -1: then `to b`
    /// is a positive multiple of `from a` and a square sum that is 0 where they touch.
    pub(super) fn implies(&self, from: f64, to: f64) -> bool {
        let [a, b] = &self.conics;
        let ([ad, az], [bd, bz]) = (slope(a, self.at), slope(b, self.at));
        let length = ad * ad + az * az;
        let share = to * from * (ad * bd + az * bz) / length;
        if share.is_nan() || share <= 0.0 {
            return false;
        }
        let bent = |k: usize| to * b[k] - share * from * a[k];
        let (dd, dz, zz) = (bent(3), bent(4), bent(5));
        let scale = (3..6).map(|k| b[k].abs() + share * a[k].abs()).fold(0.0, f64::max);
        let slack = ROUNDING * scale.max(bd.hypot(bz) / self.size);
        dd >= -slack && zz >= -slack && 4.0 * dd * zz - dz * dz >= -slack * scale
    }
}
