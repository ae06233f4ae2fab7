//! The tool of Ho (1999), fig. 7.3, written by hand in the forms that the other methods need.
//!
//! Points are in the tool's frame, with the tip at the origin, in mm. As in the thesis, `z` runs from the back of the
//! housing to the tip at [`TIP`]; `d` is the distance from the axis.

use fearless_simd::{Simd, SimdBase, SimdFloat, f32x16};

/// The tip's coordinate along the thesis's `z`, mm.
pub const TIP: f64 = 20.0;

/// The largest radius of the tool, mm.
pub const RADIUS: f64 = 5.0;

/// Magnitude, and direction as radial part and part along the thesis's `z`, not normalised.
type Value = (f64, [f64; 2]);

/// Returns the magnitude and unit direction at a point of the tool's frame, or `None` outside. Three decision trees are
/// arranged along the axis.
#[inline]
pub fn evaluate(p: [f64; 3]) -> Option<(f64, [f64; 3])> {
    let z = TIP - p[2];
    let squared = p[0] * p[0] + p[1] * p[1];
    let evaluation = if z >= 15.0 {
        cutter(squared, z)
    } else if z > 11.0 {
        spindle(squared, z)
    } else {
        housing(squared, z)
    };
    evaluation.map(|evaluation| in_space(p, squared, evaluation))
}

/// Evaluates the cutter and its ball, 15 ≤ z ≤ 20; `squared` is `d²`.
#[inline]
pub fn cutter(squared: f64, z: f64) -> Option<Value> {
    if squared > 1.0 || z > TIP {
        return None;
    }
    if z >= 19.0 {
        let above = z - 19.0;
        let square = squared + above * above;
        // The sign of the magnitude decides, so that the surface belongs to the tool.
        let magnitude = 1.0 - square.sqrt();
        return (magnitude >= 0.0).then(|| (magnitude, [squared.sqrt(), above]));
    }
    let d = squared.sqrt();
    if d + z >= 16.0 { Some((1.0 - d, [1.0, 0.0])) } else { Some((17.0 - 2.0 * d - z, [2.0, 1.0])) }
}

/// Evaluates the spindle and its taper, 11 < z < 15; `squared` is `d²`.
#[inline]
pub fn spindle(squared: f64, z: f64) -> Option<Value> {
    if squared > 9.0 {
        return None;
    }
    let d = squared.sqrt();
    if z <= 13.0 || (d < 1.0 && z + d <= 14.0) {
        return Some((3.0 - d, [1.0, 0.0]));
    }
    if d < 1.0 {
        return Some((17.0 - 2.0 * d - z, [2.0, 1.0]));
    }
    (z + d <= 16.0).then_some((16.0 - d - z, [1.0, 1.0]))
}

/// Evaluates the housing, 0 ≤ z ≤ 11; `squared` is `d²`.
#[inline]
pub fn housing(squared: f64, z: f64) -> Option<Value> {
    if squared > 25.0 || z < 0.0 {
        return None;
    }
    let d = squared.sqrt();
    if z + d <= 5.0 {
        Some((z, [0.0, -1.0]))
    } else if d <= 3.0 && z >= 9.0 {
        Some((14.0 - d - z, [1.0, 1.0]))
    } else if d > 3.0 && z >= d + 6.0 {
        Some((11.0 - z, [0.0, 1.0]))
    } else {
        Some((5.0 - d, [1.0, 0.0]))
    }
}

/// Returns the magnitude, and the direction as a unit vector in the tool's frame. On the axis the radial direction is
/// +x. A direction of length 0 becomes +z.
#[inline]
pub fn in_space(p: [f64; 3], squared: f64, (magnitude, direction): Value) -> (f64, [f64; 3]) {
    let length = (direction[0] * direction[0] + direction[1] * direction[1]).sqrt();
    let d = squared.sqrt();
    let radial = if d > 0.0 { [p[0] / d, p[1] / d] } else { [1.0, 0.0] };
    let [radial_part, axial_part] =
        if length > 0.0 { direction.map(|c| c / length) } else { [0.0, -1.0] };
    (magnitude, [radial_part * radial[0], radial_part * radial[1], -axial_part])
}

/// Returns whether a point is outside judging by its axial position and distance from the axis alone, without branches.
#[inline]
pub fn is_outside_envelope(p: [f64; 3]) -> bool {
    let radius = if p[2] < 9.0 { (p[2] - 4.0).clamp(1.0, 3.0) } else { RADIUS };
    (p[0] * p[0] + p[1] * p[1] > radius * radius) | (p[2] < 0.0) | (p[2] > TIP)
}

/// Returns the magnitude as one formula of minima and maxima, negative outside. It equals the magnitudes of the
/// regions, since these join without jumps. It is √5-Lipschitz everywhere.
pub fn magnitude(p: [f64; 3]) -> f64 {
    let d = p[0].hypot(p[1]);
    let z = TIP - p[2];
    let housing = 14.0 - d.min(3.0) - z;
    let spindle = (3.0 - d).min(16.0 - d - z + (1.0 - d).max(0.0));
    let cutter = 1.0 - d.hypot((z - 19.0).max(0.0));
    z.min(5.0 - d).min(housing.max(spindle).max(cutter))
}

/// Returns five concave functions of `d` and `z` whose maximum is [`magnitude`], each with its two derivatives.
pub fn concave_pieces(d: f64, z: f64) -> [(f64, [f64; 2]); 5] {
    let linear =
        |by_d: f64, by_z: f64, constant: f64| (constant + by_d * d + by_z * z, [by_d, by_z]);
    let min = |a: (f64, [f64; 2]), b: (f64, [f64; 2])| if b.0 < a.0 { b } else { a };
    let side = linear(-1.0, 0.0, 3.0);
    let above = (z - 19.0).max(0.0);
    let from_centre = d.hypot(above);
    let cutter = (
        1.0 - from_centre,
        if from_centre > 0.0 { [-d / from_centre, -above / from_centre] } else { [0.0; 2] },
    );
    [
        linear(-1.0, -1.0, 14.0),
        linear(0.0, -1.0, 11.0),
        min(side, linear(-1.0, -1.0, 16.0)),
        min(side, linear(-2.0, -1.0, 17.0)),
        cutter,
    ]
    .map(|piece| min(piece, min(linear(0.0, 1.0, 0.0), linear(-1.0, 0.0, 5.0))))
}

/// Returns [`magnitude`] at sixteen points, given by `x² + y²` and the thesis's `z`.
#[inline(always)]
fn magnitude_lanes<S: Simd>(squared: f32x16<S>, z: f32x16<S>) -> f32x16<S> {
    let simd = z.simd;
    let zero = f32x16::splat(simd, 0.0);
    let splat = |value: f32| f32x16::splat(simd, value);
    let d = squared.sqrt();
    let above = (z - 19.0).max(zero);
    let housing = splat(14.0) - d.min(splat(3.0)) - z;
    let spindle = (splat(3.0) - d).min(splat(16.0) - d - z + (splat(1.0) - d).max(zero));
    let cutter = splat(1.0) - (squared + above * above).sqrt();
    z.min(splat(5.0) - d).min(housing.max(spindle).max(cutter))
}

/// Returns [`magnitude`] at sixteen points of the world frame; `rows` and `tip` transform them to the tool's frame.
#[inline(always)]
pub fn magnitude_from<S: Simd>(
    simd: S,
    [xs, ys, zs]: [&[f32]; 3],
    (rows, tip): ([[f32; 3]; 3], [f32; 3]),
) -> f32x16<S> {
    let x = f32x16::from_slice(simd, xs) - tip[0];
    let y = f32x16::from_slice(simd, ys) - tip[1];
    let z = f32x16::from_slice(simd, zs) - tip[2];
    let local_x = x * rows[0][0] + y * rows[0][1] + z * rows[0][2];
    let local_y = x * rows[1][0] + y * rows[1][1] + z * rows[1][2];
    let local_z = x * rows[2][0] + y * rows[2][1] + z * rows[2][2];
    magnitude_lanes(
        local_x * local_x + local_y * local_y,
        f32x16::splat(simd, TIP as f32) - local_z,
    )
}

/// Returns whether a box of the tool's frame, given by its centre and half extents, may touch the tool. It cannot if it
/// is beyond the tool's ends, or farther from the axis than the largest radius over its axial range.
#[inline]
pub fn may_touch(centre: [f64; 3], half: [f64; 3]) -> bool {
    let (low, high) = (centre[2] - half[2], centre[2] + half[2]);
    if high < 0.0 || low > TIP {
        return false;
    }
    // The radius does not decrease with the distance from the tip, so the far end of the range has the largest radius.
    let radius = match high {
        h if h < 1.0 => (h * (2.0 - h)).sqrt(),
        h if h < 5.0 => 1.0,
        h if h < 7.0 => h - 4.0,
        h if h < 9.0 => 3.0,
        _ => RADIUS,
    };
    let gaps = [0, 1].map(|axis| (centre[axis].abs() - half[axis]).max(0.0));
    gaps[0] * gaps[0] + gaps[1] * gaps[1] <= radius * radius
}
