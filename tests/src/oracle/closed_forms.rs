//! Contacts whose integrals are known in closed form: continuous surfaces, infinitely many points.
//!
//! Conventions (those of `closed-forms.md`, except for the sign of the force): `m` is the depth of a point of the
//! part's surface, `u` the unit direction to the tool's surface, `n` the part's outward normal, `h` the largest
//! depth. Forces are **on the tool**, along an axis that each function names. The thesis law is `∫ m (n - u) dA`,
//! the gradient law `-∫ m u dA`.

use std::f64::consts::PI;

/// The integrals over a contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// `∫ m dA`.
    pub integral: f64,
    /// Force on the tool under the thesis law, along the stated axis.
    pub force: f64,
    /// Force on the tool under the gradient law, along the same axis.
    pub gradient_force: f64,
    /// Elastic energy `½ ∫ m² dA`; the gradient law is its slope.
    pub energy: f64,
}

impl Contact {
    /// No contact.
    pub const NONE: Self = Self { integral: 0.0, force: 0.0, gradient_force: 0.0, energy: 0.0 };
}

/// CF1: ball of radius `r`, pressed `h` deep (`0 <= h <= r`) into a plane. Axis: the plane's outward normal.
pub fn ball_in_plane(r: f64, h: f64) -> Contact {
    Contact {
        integral: PI / 3.0 * h * h * (3.0 * r - 2.0 * h),
        force: PI / 3.0 * h * h * (6.0 * r - 5.0 * h),
        gradient_force: PI * (r - h) * h * h,
        energy: PI / 12.0 * h.powi(3) * (4.0 * r - 3.0 * h),
    }
}

/// CF2: side of a cylinder of radius `r`, its axis parallel to a plane, pressed `h` deep (`0 <= h < r`); **per unit
/// length**. Axis: the plane's outward normal.
pub fn cylinder_in_plane(r: f64, h: f64) -> Contact {
    let c = r - h;
    let a = (h * (2.0 * r - h)).sqrt();
    let log = (a / c).asinh(); // = ln((r + a) / c)
    let integral = r * a - c * c * log;
    let gradient_force = 2.0 * c * (r * log - a);
    Contact {
        integral,
        force: integral + gradient_force,
        gradient_force,
        energy: c * c * a + a.powi(3) / 3.0 - r * c * c * log,
    }
}

/// CF3: ball of radius `r` on a ball of radius `part`, `h` deep. Axis: from the part's centre to the tool's.
pub fn ball_on_ball(r: f64, part: f64, h: f64) -> Contact {
    spheres(r, part, h, r + part - h, 1.0)
}

/// CF4: ball of radius `r` in a spherical cavity of radius `part > r`, `h` deep. Axis: from the cavity's centre to
/// the tool's.
pub fn ball_in_cavity(r: f64, part: f64, h: f64) -> Contact {
    spheres(r, part, h, part - r + h, -1.0)
}

/// CF3 and CF4: `dist` is the distance between the centres, `sigma` the sign of the part's normal against its
/// radius.
fn spheres(r: f64, part: f64, h: f64, dist: f64, sigma: f64) -> Contact {
    // M_k = ∫ t (r - t)^k dt over 0..h, where t is the depth.
    let m0 = h.powi(2) / 2.0;
    let m1 = r * h.powi(2) / 2.0 - h.powi(3) / 3.0;
    let m2 = r.powi(2) * h.powi(2) / 2.0 - 2.0 * r * h.powi(3) / 3.0 + h.powi(4) / 4.0;
    let m3 = r.powi(3) * h.powi(2) / 2.0 - r.powi(2) * h.powi(3) + 3.0 * r * h.powi(4) / 4.0
        - h.powi(5) / 5.0;
    let ring = 2.0 * PI * part / dist;
    let along_u = ring * ((part - dist) * (part + dist) * m0 - m2) / (2.0 * dist); // ∫ m u·e dA
    let along_n = ring * sigma * ((part * part + dist * dist) * m1 - m3) / (2.0 * part * dist); // ∫ m n·e dA
    Contact {
        integral: PI * part * h * h * (3.0 * r - 2.0 * h) / (3.0 * dist),
        force: along_n - along_u,
        gradient_force: -along_u,
        energy: PI * part * h.powi(3) * (4.0 * r - 3.0 * h) / (12.0 * dist),
    }
}

/// CF5: cylinder of radius `r` in a bore of radius `bore`, axes parallel and `offset` apart; **per unit length**.
/// The tool's axis has to be inside the bore (`offset < bore`). Axis: from the bore's axis to the tool's.
///
/// The integral is the closed form with the incomplete elliptic integral; forces and energy are quadratures over
/// the bore.
pub fn cylinder_in_bore(r: f64, bore: f64, offset: f64) -> Contact {
    if offset + r <= bore {
        return Contact::NONE;
    }
    let half_angle = bore_half_angle(r, bore, offset);
    let gap = bore - offset;
    let kappa = 4.0 * bore * offset / (gap * gap);
    let integral = 2.0 * bore * (r * half_angle - 2.0 * gap * elliptic_e(half_angle / 2.0, -kappa));
    // Over half the contact: `s` is the distance from the tool's axis to the point at angle `phi` of the bore.
    let integrate = |f: &dyn Fn(f64, f64, f64) -> f64| {
        2.0 * bore
            * quadrature(0.0, half_angle, |phi| {
                let half = (phi / 2.0).sin();
                let s = (gap * gap + 4.0 * bore * offset * half * half).sqrt();
                f(phi, s, r - s)
            })
    };
    let along_u = integrate(&|phi, s, m| m * (bore * phi.cos() - offset) / s);
    let along_n = integrate(&|phi, _, m| -m * phi.cos());
    Contact {
        integral,
        force: along_n - along_u,
        gradient_force: -along_u,
        energy: integrate(&|_, _, m| m * m / 2.0),
    }
}

/// Returns half the angle of the bore that lies inside the tool.
fn bore_half_angle(r: f64, bore: f64, offset: f64) -> f64 {
    if bore + offset <= r {
        return PI;
    }
    let cos = (bore * bore + offset * offset - r * r) / (2.0 * bore * offset);
    cos.clamp(-1.0, 1.0).acos()
}

/// Computes the incomplete elliptic integral of the second kind, `E(φ | m) = ∫ √(1 - m sin²θ) dθ` over `0..φ`
/// (parameter `m`, not the modulus).
pub fn elliptic_e(phi: f64, m: f64) -> f64 {
    quadrature(0.0, phi, |theta| {
        let sin = theta.sin();
        (1.0 - m * sin * sin).sqrt()
    })
}

/// Computes `∫ f` over `a..b` by Gauss-Legendre, eight points on each of 128 equal panels: for smooth `f`, to
/// rounding.
pub fn quadrature(a: f64, b: f64, f: impl Fn(f64) -> f64) -> f64 {
    // Abramowitz and Stegun, table 25.4: abscissas and weights.
    const RULE: [(f64, f64); 4] = [
        (0.183_434_642_495_649_8, 0.362_683_783_378_362),
        (0.525_532_409_916_329, 0.313_706_645_877_887_3),
        (0.796_666_477_413_626_7, 0.222_381_034_453_374_5),
        (0.960_289_856_497_536_3, 0.101_228_536_290_376_3),
    ];
    const PANELS: u32 = 128;
    let half = (b - a) / f64::from(2 * PANELS);
    let panel = |i: u32| {
        let middle = a + half * f64::from(2 * i + 1);
        let pairs = RULE.iter().map(|(x, w)| w * (f(middle - half * x) + f(middle + half * x)));
        half * pairs.sum::<f64>()
    };
    (0..PANELS).map(panel).collect::<super::sum::Sum>().value()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::checks::assert_near;

    #[track_caller]
    fn assert_close(a: f64, b: f64, relative: f64) {
        assert_near(a, b, relative * b.abs(), "relative");
    }

    #[test]
    fn quadrature_is_exact_for_degree_fifteen() {
        assert_close(quadrature(0.0, 2.0, |x| x.powi(15)), 4096.0, 1e-14);
        assert_close(quadrature(0.0, 1.0, f64::exp), 1f64.exp_m1(), 1e-15);
        // E(π/2 | 1/2), and E(φ | 1) = sin φ.
        assert_close(elliptic_e(PI / 2.0, 0.5), 1.350_643_881_047_675_5, 1e-15);
        assert_close(elliptic_e(1.0, 1.0), 1f64.sin(), 1e-15);
    }

    /// The page prints the force on the part of CF3 and CF4, and none of CF5.
    #[test]
    fn the_printed_figures() {
        let printed = [
            (ball_in_plane(1.0, 0.1), 0.029_321_531_433_504_737, 0.057_595_865_315_812_88),
            (ball_in_plane(1.0, 0.3), 0.226_194_671_058_465_1, 0.424_115_008_234_622_1),
            (ball_in_plane(1.0, 0.5), PI / 6.0, 0.916_297_857_297_023),
            (cylinder_in_plane(1.0, 0.1), 0.057_502_194_790_425_12, 0.113_761_939_538_975_51),
            (cylinder_in_plane(1.0, 0.3), 0.275_304_674_084_596_85, 0.529_328_033_430_564),
            (cylinder_in_plane(3.0, 0.25), 0.396_155_482_203_256_47, 0.785_272_214_625_612_2),
            (ball_on_ball(1.0, 4.0, 0.3), 0.192_506_103_028_480_95, 0.364_070_767_548_657_5),
            (ball_on_ball(1.0, 10.0, 0.1), 0.026_900_487_553_674_07, 0.052_914_025_840_625_12),
            (ball_in_cavity(1.0, 4.0, 0.3), 0.274_175_358_858_745_6, -0.504_313_897_058_370_1),
            (ball_in_cavity(1.0, 10.0, 0.1), 0.032_221_463_113_741_47, -0.063_164_070_519_779_03),
        ];
        let tolerances = [[1e-15; 2]; 3].into_iter().chain([[1e-14; 2]; 3]);
        let tolerances = tolerances.chain([[1e-14, 1e-13]; 4]);
        for (k, ((c, integral, force), tolerance)) in
            printed.into_iter().zip(tolerances).enumerate()
        {
            assert_close(c.integral, integral, tolerance[0]);
            assert_close(c.force, force, tolerance[1]);
            if k < 3 {
                assert_close(c.integral + c.gradient_force, force, tolerance[1]);
            }
        }
        for (r, offset, integral) in [
            (1.0, 2.2, 0.182_863_132_313_677_82),
            (2.9, 0.3, 0.916_568_383_211_115_4),
            (3.1, 0.0, 2.0 * PI * 3.0 * 0.1),
        ] {
            assert_close(cylinder_in_bore(r, 3.0, offset).integral, integral, 1e-13);
        }
        assert_eq!(cylinder_in_bore(1.0, 3.0, 2.0), Contact::NONE);
    }

    #[test]
    fn limits_of_contacts_are_known() {
        // Stiffness changes sign at h = 0.8 r.
        let stiffness = |h: f64| {
            (ball_in_plane(1.0, h + 1e-6).force - ball_in_plane(1.0, h - 1e-6).force) / 2e-6
        };
        assert_close(stiffness(0.5), PI * 0.5 * 1.5, 1e-8);
        assert!(stiffness(0.79) > 0.0 && stiffness(0.81) < 0.0);
        let h = 1e-6f64;
        assert_close(cylinder_in_plane(1.0, h).integral, 4.0 / 3.0 * h * (2.0 * h).sqrt(), 1e-5);
        // A part of large radius approximates a plane.
        let (large, plane) = (ball_on_ball(1.0, 1e6, 0.3), ball_in_plane(1.0, 0.3));
        assert_close(large.force, plane.force, 1e-5);
        assert_close(large.gradient_force, plane.gradient_force, 1e-5);
        assert_close(large.energy, plane.energy, 1e-5);
    }

    /// A bore of large radius approximates a plane, and the integral is also a plain quadrature.
    #[test]
    fn cf5_against_itself() {
        let (wide, plane) = (cylinder_in_bore(1.0, 1e5, 1e5 - 0.7), cylinder_in_plane(1.0, 0.3));
        assert_close(-wide.force, plane.force, 1e-4);
        for (r, bore, offset) in
            [(1.0, 3.0, 2.2), (2.9, 3.0, 0.3), (1.0, 3.0, 2.001), (3.2, 3.0, 0.1)]
        {
            let reach = bore_half_angle(r, bore, offset);
            let depth = |phi: f64| {
                r - (bore * bore + offset * offset - 2.0 * bore * offset * phi.cos()).sqrt()
            };
            let plain = 2.0 * bore * quadrature(0.0, reach, depth);
            assert_near(
                cylinder_in_bore(r, bore, offset).integral,
                plain,
                1e-13 * bore * r,
                offset,
            );
        }
    }

    /// The gradient law is the slope of the energy, in every contact.
    #[test]
    fn gradient_forces_are_slopes_of_the_energy() {
        type At = fn(f64) -> Contact;
        let contacts: [(&str, f64, At); 5] = [
            ("CF1", 1.0, |h| ball_in_plane(1.0, h)),
            ("CF2", 1.0, |h| cylinder_in_plane(1.0, h)),
            ("CF3", 1.0, |h| ball_on_ball(1.0, 4.0, h)),
            // Deeper is farther from the centre: the force points back along the axis.
            ("CF4", -1.0, |h| ball_in_cavity(1.0, 4.0, h)),
            ("CF5", -1.0, |h| cylinder_in_bore(1.0, 3.0, 2.0 + h)),
        ];
        for (name, sign, at) in contacts {
            for h in [0.05, 0.2, 0.6] {
                let step = 1e-5;
                let slope = (at(h + step).energy - at(h - step).energy) / (2.0 * step);
                let force = sign * at(h).gradient_force;
                assert_near(slope, force, 1e-8, (name, h));
            }
        }
    }
}
