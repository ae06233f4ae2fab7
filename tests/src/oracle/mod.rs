//! Reference evaluations of the tools, computed independently of the compiler.
//!
//! An [`Oracle`] evaluates one tool at one point. Nothing here shares code with the project. Solids that the
//! compiler derives from a profile are evaluated by brute force over the profile's segments ([`profile`]), the
//! thesis's own tool by its equations written out by hand ([`fig73`]), contacts by textbook integrals
//! ([`closed_forms`]). Profiles, fig. 7.3 and the solids are generic over the number: doubles, or 256 bits ([`real`]).
//!
//! **Frame.** Everything is in the tool frame: tip at the origin, +z from the tip to the spindle, lengths in the
//! tool file's unit. `[d, z]` is a point of the half plane `d >= 0`, `d` being the distance from the axis.
//!
//! **Singular points.** On the axis the radial part of a direction is that of +x. Where the vector in the half
//! plane itself vanishes (centre of an arc, or a reflex corner that owns the point), the direction is +z.

pub mod big;
pub mod bodies;
pub mod closed_forms;
pub mod fig73;
#[cfg(test)]
mod fig73_table;
pub mod nearest;
pub mod profile;
pub mod real;
pub mod reference;
pub mod restated;
pub mod rng;
pub mod segment;
pub mod space;
pub mod sum;
pub mod triangle;
pub mod vector;

pub use bodies::Body;
pub use fig73::Fig73;
pub use nearest::{Nearest, cylinder, d2_ball, fig_7_3_exact, half_sphere_cylinder};
use real::Real;
use vector::{Point, unit};

/// The evaluation of a tool at a point inside.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OracleEvaluation {
    /// Index of the owner in [`Oracle::regions`].
    pub owner: usize,
    /// Depth of the point, `>= 0`: the true distance to the surface, except for [`Fig73`], where it is the
    /// magnitude.
    pub depth: f64,
    /// Magnitude of the push.
    pub magnitude: f64,
    /// Unit vector toward the tool's surface.
    pub direction: [f64; 3],
    /// Niceness of a contact here; 0 where the surface does not cut.
    pub niceness: f64,
}

/// The reference evaluation of one tool.
pub trait Oracle: Send + Sync {
    /// Returns the tool's name, as in its file.
    fn name(&self) -> &'static str;

    /// Returns the regions in the order of listing: on a border the first one owns the point.
    fn regions(&self) -> Vec<&str>;

    /// Evaluates the tool at `p`; `None` outside. The surface belongs to the solid.
    fn evaluate(&self, p: [f64; 3]) -> Option<OracleEvaluation>;

    /// Returns the gradient of the magnitude inside, in the tool's frame, per unit of the tool's file. For a
    /// magnitude that is the distance this is minus the direction; on the axis it follows the same convention.
    fn gradient(&self, p: [f64; 3]) -> Option<[f64; 3]> {
        Some(self.evaluate(p)?.direction.map(|c| -c))
    }

    /// Returns the true signed distance to the solid's surface: negative inside, positive outside.
    fn signed_distance(&self, p: [f64; 3]) -> f64;

    /// Returns a lower bound of the distance in the half plane from `p` to the surface and to every splitting
    /// curve. Where it exceeds rounding, the side and the owner are beyond doubt. It is 0 on the curves themselves.
    fn border_distance(&self, p: [f64; 3]) -> f64;

    /// Returns the distance from `p` to the nearest point at which its owner's direction does not exist: the axis
    /// where the direction has a radial part, the centre of an arc, the owning corner. Infinite where there is
    /// none, and outside.
    fn singularity_distance(&self, p: [f64; 3]) -> f64;

    /// Returns whether the magnitude is the depth itself, so that it is a length and comes out in the part's unit.
    /// A magnitude that the file writes is a number in the file's unit.
    fn magnitude_is_depth(&self) -> bool {
        true
    }

    /// Returns whether the solid is symmetric under all rotations about z.
    fn is_revolved(&self) -> bool {
        true
    }

    /// Returns vertices, ends of splitting curves and centres of arcs; of a solid of revolution those in the half plane
    /// y = 0.
    fn corner_points(&self) -> Vec<[f64; 3]>;

    /// Returns points along every splitting curve and every piece of the surface, a list for each, ends included; of a
    /// solid of revolution those in the half plane y = 0.
    fn curve_points(&self) -> Vec<Vec<[f64; 3]>>;

    /// Returns the largest distance from the axis, and the largest z. The smallest z is 0.
    fn extent(&self) -> [f64; 2];
}

/// Returns every oracle, for suites that run over all of them.
pub fn all() -> Vec<Box<dyn Oracle>> {
    let catalogue = restated::catalogue().into_iter();
    let catalogue = catalogue.map(|tool| Box::new(Nearest::new(&tool)) as Box<dyn Oracle>);
    thesis().into_iter().chain(catalogue).collect()
}

/// Returns the oracle of a tool of the library.
pub fn of(name: &str) -> Box<dyn Oracle> {
    let known = thesis().into_iter().find(|oracle| oracle.name() == name);
    known.unwrap_or_else(|| Box::new(Nearest::of(name)))
}

/// Returns the oracles of the thesis's solids and the plain ball cutter, whose splitting curves are known as
/// equations, and of two solids without an axis.
pub fn thesis() -> Vec<Box<dyn Oracle>> {
    vec![
        Box::new(Nearest::of("UnitSphere")),
        Box::new(cylinder()),
        Box::new(half_sphere_cylinder()),
        Box::<Fig73>::default(),
        Box::new(fig_7_3_exact()),
        Box::new(d2_ball()),
        Box::new(Body::Block),
        Box::new(Body::LBracket),
    ]
}

/// Moves a point by `step`: in space, or for a solid of revolution within the half plane, after which the point is
/// turned about z by `angle` (rad).
pub fn displaced(o: &dyn Oracle, [x, y, z]: [f64; 3], step: [f64; 3], angle: f64) -> [f64; 3] {
    if !o.is_revolved() {
        return [x + step[0], y + step[1], z + step[2]];
    }
    let (sin, cos) = angle.sin_cos();
    let d = (x.hypot(y) + step[0]).abs();
    [d * cos, d * sin, z + step[2]]
}

/// A point in the half plane through it and the axis.
#[derive(Clone, Copy, Debug)]
pub struct Meridian<T> {
    /// Distance from the axis, and z.
    pub dz: Point<T>,
    /// Unit vector away from the axis; +x on the axis.
    pub radial: [T; 2],
}

impl<T: Real> Meridian<T> {
    /// Returns the half plane through a point.
    pub fn of([x, y, z]: [T; 3]) -> Self {
        let d = x.hypot(&y);
        // A denormal `d` has too few bits to divide by: the quotient would not be a unit vector.
        let scale = T::exactly(if d.to_f64() < 1e-290 { 2f64.powi(600) } else { 1.0 });
        let across = [x.times(&scale), y.times(&scale)];
        let radial = if d > T::zero() { unit(&across) } else { [T::exactly(1.0), T::zero()] };
        Self { dz: [d, z], radial }
    }

    /// Returns the vector with these radial and axial parts, in space.
    pub fn lift(&self, [e_d, e_z]: &Point<T>) -> [T; 3] {
        [e_d.times(&self.radial[0]), e_d.times(&self.radial[1]), e_z.clone()]
    }
}

/// Returns a point of the half plane y = 0 in space.
fn in_space([d, z]: [f64; 2]) -> [f64; 3] {
    [d, 0.0, z]
}

/// Returns points evenly spaced from `a` to `b`, both included.
pub fn sample_line(a: [f64; 2], b: [f64; 2]) -> Vec<[f64; 2]> {
    segment::Segment::line(a, b).samples()
}

/// Returns 65 points of a curve given on `0..=1`.
pub fn sample_curve(at: impl Fn(f64) -> [f64; 2]) -> Vec<[f64; 2]> {
    const STEPS: u32 = 64;
    (0..=STEPS).map(|i| at(f64::from(i) / f64::from(STEPS))).collect()
}

#[cfg(test)]
mod tests {
    use super::rng::Rng;
    use super::*;
    use crate::points::to_space;

    fn random_point(o: &dyn Oracle, rng: &mut Rng) -> [f64; 3] {
        let [d, z] = o.extent();
        to_space([rng.between(0.0, 1.2 * d), rng.between(-0.2 * d, z + 0.2 * d)], rng.azimuth())
    }

    #[test]
    fn evaluations_are_consistent() {
        for o in all() {
            let mut rng = Rng::new(1);
            for _ in 0..20_000 {
                let p = random_point(&*o, &mut rng);
                let sd = o.signed_distance(p);
                let Some(s) = o.evaluate(p) else {
                    assert!(sd > -1e-12, "{} {p:?} {sd}", o.name());
                    continue;
                };
                assert!(sd < 1e-12, "{} {p:?} {sd}", o.name());
                assert!(s.owner < o.regions().len());
                let norm = s.direction.iter().map(|c| c * c).sum::<f64>().sqrt();
                assert!((norm - 1.0).abs() < 4.0 * f64::EPSILON);
                assert!(s.depth >= 0.0 && s.magnitude == s.depth && s.niceness >= 0.0);
                if o.name() != "Fig73" {
                    assert!((s.depth + sd).abs() < 1e-13);
                }
            }
        }
    }

    /// No point changes owner or side within its border.
    #[test]
    fn borders_are_lower_bounds() {
        for o in all() {
            let mut rng = Rng::new(2);
            for _ in 0..20_000 {
                let p = random_point(&*o, &mut rng);
                let reach = o.border_distance(p) * 0.999_999;
                let owner = o.evaluate(p).map(|s| s.owner);
                let m = Meridian::of(p);
                for k in 0..8 {
                    let (sin, cos) = (f64::from(k) * std::f64::consts::FRAC_PI_4).sin_cos();
                    let d = m.dz[0] + reach * cos;
                    let q = if o.is_revolved() {
                        [d * m.radial[0], d * m.radial[1], p[2] + reach * sin]
                    } else {
                        let direction = rng.direction();
                        [0, 1, 2].map(|axis| p[axis] + reach * direction[axis])
                    };
                    let other_owner = o.evaluate(q).map(|s| s.owner);
                    assert_eq!(owner, other_owner, "{} {p:?} {q:?}", o.name());
                }
            }
        }
    }

    /// On each curve the border is 0 to rounding, and some owner or side changes close by.
    #[test]
    fn curves_and_corners_lie_on_borders() {
        let mut rng = Rng::new(5);
        for o in all() {
            for curve in o.curve_points() {
                let inner = curve.iter().skip(1).take(curve.len().saturating_sub(2));
                for &p in inner {
                    let rounding = 1e-14 * o.extent()[1].max(1.0);
                    assert!(o.border_distance(p) < rounding, "{} {p:?}", o.name());
                    let mut owners = (0..32).map(|k| {
                        let turn = 0.1 + f64::from(k) * std::f64::consts::FRAC_PI_8;
                        let flat = [turn.cos(), 0.0, turn.sin()];
                        let step = if o.is_revolved() { flat } else { rng.direction() };
                        let q = displaced(&*o, p, step.map(|c| 1e-6 * c), 0.0);
                        o.evaluate(q).map(|s| s.owner)
                    });
                    let first = owners.next().expect("many of them");
                    assert!(owners.any(|other| other != first), "{} {p:?}", o.name());
                }
            }
        }
    }

    #[test]
    fn no_owner_is_lost_between_the_curves() {
        // Every change of owner that random short steps find has a listed curve nearby.
        for o in thesis().into_iter().filter(|o| o.is_revolved()) {
            let [width, height] = o.extent();
            let all: Vec<_> = o.curve_points().into_iter().flatten().collect();
            let step = 0.05;
            let mut rng = Rng::new(3);
            for _ in 0..2_000 {
                let a = [rng.between(0.0, width), rng.between(0.0, height)];
                let b = [a[0] + step, a[1] + rng.between(-step, step)];
                let owner = |q: [f64; 2]| o.evaluate([q[0], 0.0, q[1]]).map(|s| s.owner);
                if owner(a) == owner(b) {
                    continue;
                }
                let distances = all.iter().map(|c| (c[0] - a[0]).hypot(c[2] - a[1]));
                let near = distances.fold(f64::INFINITY, f64::min);
                let spacing = height / 64.0;
                assert!(near < 2.0 * step + spacing, "{} {a:?} {near}", o.name());
            }
        }
    }

    #[test]
    fn the_gradient_is_the_slope_of_the_magnitude() {
        for o in all() {
            let mut rng = Rng::new(4);
            for _ in 0..20_000 {
                let p = random_point(&*o, &mut rng);
                let h = 1e-5;
                if o.border_distance(p) < 3.0 * h || o.singularity_distance(p) < 1e-2 {
                    continue;
                }
                let Some(g) = o.gradient(p) else {
                    assert!(o.evaluate(p).is_none());
                    continue;
                };
                for k in 0..3 {
                    let m = |s: f64| {
                        let mut q = p;
                        q[k] += s;
                        o.evaluate(q).expect("inside its border").magnitude
                    };
                    let slope = (m(h) - m(-h)) / (2.0 * h);
                    assert!((slope - g[k]).abs() < 1e-6, "{} {p:?} {k}", o.name());
                }
            }
        }
    }
}
