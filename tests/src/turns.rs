//! Quaternions `[x, y, z, w]` of quarter and half turns, and of turns by 120° that exchange the axes.

use std::f64::consts::FRAC_1_SQRT_2;

/// Turns whose rotations are not rounded.
pub const EXACT_TURNS: [[f64; 4]; 7] = [
    [0.0, 0.0, 0.0, 1.0],
    [1.0, 0.0, 0.0, 0.0],
    [0.0, 1.0, 0.0, 0.0],
    [0.0, 0.0, 1.0, 0.0],
    [0.5, 0.5, 0.5, 0.5],
    [-0.5, 0.5, 0.5, 0.5],
    [0.5, -0.5, 0.5, 0.5],
];

/// Turns with rounding.
pub const ROUNDED_TURNS: [[f64; 4]; 4] = [
    [FRAC_1_SQRT_2, 0.0, 0.0, FRAC_1_SQRT_2],
    [0.0, FRAC_1_SQRT_2, 0.0, -FRAC_1_SQRT_2],
    [0.0, 0.0, FRAC_1_SQRT_2, FRAC_1_SQRT_2],
    [FRAC_1_SQRT_2, FRAC_1_SQRT_2, 0.0, 0.0],
];
