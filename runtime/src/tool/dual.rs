//! Dual numbers: numbers with their derivatives along x, y and z. Generated code evaluated on them yields exact
//! derivatives, operation by operation, by the chain rule (Griewank and Walther, *Evaluating Derivatives*, 2008,
//! section 3.1).

use super::Lane;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// A number and its derivatives along three directions.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Dual {
    /// The value.
    pub value: f64,
    /// The derivatives along the three directions.
    pub slope: [f64; 3],
}

impl Dual {
    /// Returns a constant, with derivatives 0.
    pub fn constant(value: f64) -> Dual {
        Dual { value, slope: [0.0; 3] }
    }

    /// Returns a point's coordinates, each with derivative 1 along its own axis.
    pub fn point(point: [f64; 3]) -> [Dual; 3] {
        [0, 1, 2].map(|axis| {
            let mut slope = [0.0; 3];
            slope[axis] = 1.0;
            Dual { value: point[axis], slope }
        })
    }

    /// Returns a function of one number, given the function's value and derivative there.
    #[inline(always)]
    fn chain(self, value: f64, derivative: f64) -> Dual {
        Dual { value, slope: self.slope.map(|slope| derivative * slope) }
    }

    /// Returns a function of two numbers, given its value and its partial derivatives.
    #[inline(always)]
    fn combine(self, other: Dual, value: f64, partials: [f64; 2]) -> Dual {
        let slope = [0, 1, 2].map(|k| partials[0] * self.slope[k] + partials[1] * other.slope[k]);
        Dual { value, slope }
    }
}

impl Add for Dual {
    type Output = Dual;
    #[inline(always)]
    fn add(self, other: Dual) -> Dual {
        self.combine(other, self.value + other.value, [1.0, 1.0])
    }
}

impl Sub for Dual {
    type Output = Dual;
    #[inline(always)]
    fn sub(self, other: Dual) -> Dual {
        self.combine(other, self.value - other.value, [1.0, -1.0])
    }
}

impl Mul for Dual {
    type Output = Dual;
    #[inline(always)]
    fn mul(self, other: Dual) -> Dual {
        self.combine(other, self.value * other.value, [other.value, self.value])
    }
}

impl Div for Dual {
    type Output = Dual;
    #[inline(always)]
    fn div(self, other: Dual) -> Dual {
        let value = self.value / other.value;
        // (a/b)' = a'/b - (a/b) b'/b: the quotient is at hand.
        self.combine(other, value, [1.0 / other.value, -value / other.value])
    }
}

impl Neg for Dual {
    type Output = Dual;
    #[inline(always)]
    fn neg(self) -> Dual {
        self.chain(-self.value, -1.0)
    }
}

impl Add<f64> for Dual {
    type Output = Dual;
    #[inline(always)]
    fn add(self, other: f64) -> Dual {
        Dual { value: self.value + other, ..self }
    }
}

impl Sub<f64> for Dual {
    type Output = Dual;
    #[inline(always)]
    fn sub(self, other: f64) -> Dual {
        Dual { value: self.value - other, ..self }
    }
}

impl Mul<f64> for Dual {
    type Output = Dual;
    #[inline(always)]
    fn mul(self, other: f64) -> Dual {
        self.chain(self.value * other, other)
    }
}

/// The derivatives of a square root and of an absolute value at 0 do not exist; they are set to 0. The quotient
/// [`Lane::quotient`] by 0 is the constant 0, with derivative 0.
impl Lane for Dual {
    type Mask = bool;

    #[inline(always)]
    fn of(self, value: f64) -> Dual {
        Dual::constant(value)
    }
    #[inline(always)]
    fn sqrt(self) -> Dual {
        let root = self.value.sqrt();
        self.chain(root, if root > 0.0 { 0.5 / root } else { 0.0 })
    }
    #[inline(always)]
    fn abs(self) -> Dual {
        // The sign of a zero is 1 or -1, neither of which is a derivative there.
        let sign = if self.value == 0.0 { 0.0 } else { self.value.signum() };
        self.chain(self.value.abs(), sign)
    }
    #[inline(always)]
    fn le(a: Dual, b: Dual) -> bool {
        a.value <= b.value
    }
    #[inline(always)]
    fn lt(a: Dual, b: Dual) -> bool {
        a.value < b.value
    }
    #[inline(always)]
    fn any(mask: bool) -> bool {
        mask
    }
    #[inline(always)]
    fn select(mask: bool, yes: Dual, no: Dual) -> Dual {
        if mask { yes } else { no }
    }
}
