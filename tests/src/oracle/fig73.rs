//! The ball end mill of fig. 7.3 with the thesis's own functions (Ho 1999, eq. 7.1 to 7.3), written out by hand.
//!
//! The thesis measures z from the back of the housing, with the tip at 20. The magnitudes of IV, VI and VII are not
//! distances. The splits are where the thesis's magnitudes meet without a jump.

use super::real::Real;
use super::vector::{Point, norm, opposite, unit};
use super::{Meridian, Nearest, Oracle, OracleEvaluation, fig_7_3_exact, in_space, sample_line};

/// The thesis's names of the regions, in its order.
pub const REGIONS: [&str; 9] = ["I", "II", "III", "IV", "V", "VI", "VII", "VIII", "IX"];

/// A point in the thesis's frame, and its values in each region.
pub struct ThesisPoint<T> {
    d: T,
    z: T,
}

impl<T: Real> ThesisPoint<T> {
    /// Transforms a point of the tool's half plane to the thesis's frame.
    pub fn new([d, z]: &Point<T>) -> ThesisPoint<T> {
        ThesisPoint { d: d.clone(), z: T::exactly(20.0).minus(z) }
    }

    /// Returns `a + b d + c z`.
    fn sum(&self, a: f64, b: f64, c: f64) -> T {
        let [a, b, c] = [a, b, c].map(T::exactly);
        a.plus(&b.times(&self.d)).plus(&c.times(&self.z))
    }

    /// Returns the vector from the ball's centre.
    fn arm(&self) -> Point<T> {
        [self.d.clone(), self.sum(-19.0, 0.0, 1.0)]
    }

    /// Returns the magnitude of a region.
    pub fn magnitude(&self, region: usize) -> T {
        match region {
            0 => self.z.clone(),
            1 => self.sum(5.0, -1.0, 0.0),
            2 => self.sum(11.0, 0.0, -1.0),
            3 => self.sum(14.0, -1.0, -1.0),
            4 => self.sum(3.0, -1.0, 0.0),
            5 => self.sum(16.0, -1.0, -1.0),
            6 => self.sum(17.0, -2.0, -1.0),
            7 => self.sum(1.0, -1.0, 0.0),
            _ => T::exactly(1.0).minus(&norm(&self.arm())),
        }
    }

    /// Returns the largest violation of a region's conditions, or 0 inside the region.
    pub fn outside(&self, region: usize) -> T {
        let s = |a, b, c| self.sum(a, b, c);
        let violations = match region {
            0 => vec![s(0.0, 0.0, -1.0), s(-5.0, 1.0, 1.0)],
            1 => vec![
                s(-5.0, 1.0, 0.0),
                s(5.0, -1.0, -1.0),
                s(-9.0, 0.0, 1.0).least(s(-6.0, -1.0, 1.0)),
            ],
            2 => vec![s(3.0, -1.0, 0.0), s(6.0, 1.0, -1.0), s(-11.0, 0.0, 1.0)],
            3 => vec![s(-3.0, 1.0, 0.0), s(9.0, 0.0, -1.0), s(-11.0, 0.0, 1.0)],
            4 => vec![
                s(-3.0, 1.0, 0.0),
                s(11.0, 0.0, -1.0),
                s(-13.0, 0.0, 1.0).least(s(-14.0, 1.0, 1.0)),
            ],
            5 => vec![s(1.0, -1.0, 0.0), s(13.0, 0.0, -1.0), s(-16.0, 1.0, 1.0)],
            6 => vec![s(-1.0, 1.0, 0.0), s(14.0, -1.0, -1.0), s(-16.0, 1.0, 1.0)],
            7 => vec![s(-1.0, 1.0, 0.0), s(16.0, -1.0, -1.0), s(-19.0, 0.0, 1.0)],
            _ => vec![s(19.0, 0.0, -1.0), self.magnitude(8).negated()],
        };
        violations.into_iter().fold(T::zero(), T::most)
    }

    /// Returns the region that the point belongs to: the first that contains it.
    pub fn owner(&self) -> Option<usize> {
        (0..REGIONS.len()).find(|region| self.outside(*region) == T::zero())
    }

    /// Returns the gradient of a region's magnitude, in the tool's half plane. The direction is opposite.
    pub fn slope(&self, region: usize) -> Point<T> {
        let slope = |d, z| [T::exactly(d), T::exactly(z)];
        let [d, z] = match region {
            0 => slope(0.0, 1.0),
            1 | 4 | 7 => slope(-1.0, 0.0),
            2 => slope(0.0, -1.0),
            3 | 5 => slope(-1.0, -1.0),
            6 => slope(-2.0, -1.0),
            // The direction where it vanishes is the tool's +z, the thesis's -z.
            _ if norm(&self.arm()) == T::zero() => slope(0.0, 1.0),
            _ => opposite(&unit(&self.arm())),
        };
        // A half turn about x flips z in the half plane.
        [d, z.negated()]
    }

    /// Returns the direction toward the surface by the thesis, in the tool's half plane.
    pub fn direction(&self, region: usize) -> Point<T> {
        unit(&opposite(&self.slope(region)))
    }

    /// Returns the distance to the nearest point at which a region's direction does not exist.
    pub fn singularity_distance(&self, region: usize) -> f64 {
        match region {
            0 | 2 => f64::INFINITY,
            8 => self.d.to_f64().min(norm(&self.arm()).to_f64()),
            _ => self.d.to_f64(),
        }
    }
}

/// The tool of fig. 7.3. Its depth is its magnitude, which is never below the true distance and at most √5 times
/// it.
#[derive(Clone, Debug)]
pub struct Fig73 {
    exact: Nearest,
}

impl Default for Fig73 {
    fn default() -> Self {
        Self { exact: fig_7_3_exact() }
    }
}

impl Oracle for Fig73 {
    fn name(&self) -> &'static str {
        "Fig73"
    }

    fn regions(&self) -> Vec<&str> {
        REGIONS.to_vec()
    }

    fn evaluate(&self, p: [f64; 3]) -> Option<OracleEvaluation> {
        let m = Meridian::of(p);
        let point = ThesisPoint::new(&m.dz);
        let owner = point.owner()?;
        let ThesisPoint { d, z } = point;
        let magnitude = point.magnitude(owner);
        Some(OracleEvaluation {
            owner,
            depth: magnitude,
            magnitude,
            direction: m.lift(&point.direction(owner)),
            niceness: match owner {
                7 => 2.0 * d * d,
                8 => 2.0 * d * d + (z - 19.0) * (z - 19.0),
                _ => 0.0,
            },
        })
    }

    fn gradient(&self, p: [f64; 3]) -> Option<[f64; 3]> {
        let m = Meridian::of(p);
        let point = ThesisPoint::new(&m.dz);
        Some(m.lift(&point.slope(point.owner()?)))
    }

    fn signed_distance(&self, p: [f64; 3]) -> f64 {
        self.exact.signed_distance(p)
    }

    fn border_distance(&self, p: [f64; 3]) -> f64 {
        let surface = self.signed_distance(p).abs();
        let point = ThesisPoint::new(&Meridian::of(p).dz);
        if point.owner().is_none() {
            return surface;
        }
        let ThesisPoint { d, z } = point;
        // Each split counts as a whole line, so the bound is a little smaller than necessary.
        let level = [d - 3.0, d - 1.0, z - 9.0, z - 11.0, z - 13.0, z - 19.0];
        let sloped = [z + d - 5.0, z - d - 6.0, z + d - 14.0, z + d - 16.0];
        let level = level.into_iter().map(f64::abs);
        let sloped = sloped.into_iter().map(|s| s.abs() / std::f64::consts::SQRT_2);
        level.chain(sloped).fold(surface, f64::min)
    }

    fn singularity_distance(&self, p: [f64; 3]) -> f64 {
        let point = ThesisPoint::new(&Meridian::of(p).dz);
        point.owner().map_or(f64::INFINITY, |owner| point.singularity_distance(owner))
    }

    fn magnitude_is_depth(&self) -> bool {
        false
    }

    fn corner_points(&self) -> Vec<[f64; 3]> {
        let thesis = [
            [0.0, 0.0],
            [5.0, 0.0],
            [5.0, 11.0],
            [3.0, 11.0],
            [3.0, 13.0],
            [1.0, 15.0],
            [1.0, 19.0],
            [0.0, 20.0],
            [0.0, 19.0],
            [0.0, 5.0],
            [3.0, 9.0],
            [0.0, 9.0],
            [0.0, 11.0],
            [1.0, 13.0],
            [0.0, 14.0],
            [0.0, 16.0],
        ];
        thesis.map(|[d, z]| [d, 0.0, 20.0 - z]).to_vec()
    }

    fn curve_points(&self) -> Vec<Vec<[f64; 3]>> {
        let thesis = [
            ([5.0, 0.0], [0.0, 5.0]),   // I | II
            ([5.0, 11.0], [3.0, 9.0]),  // II | III
            ([3.0, 9.0], [0.0, 9.0]),   // II | IV
            ([3.0, 9.0], [3.0, 11.0]),  // III | IV
            ([3.0, 11.0], [0.0, 11.0]), // IV | V
            ([3.0, 13.0], [1.0, 13.0]), // V | VI
            ([1.0, 13.0], [0.0, 14.0]), // V | VII
            ([1.0, 13.0], [1.0, 15.0]), // VI | VII
            ([1.0, 15.0], [0.0, 16.0]), // VII | VIII
            ([1.0, 19.0], [0.0, 19.0]), // VIII | IX
        ];
        let splits = thesis.map(|ends| {
            let [a, b] = <[[f64; 2]; 2]>::from(ends).map(|[d, z]| [d, 20.0 - z]);
            sample_line(a, b).into_iter().map(in_space).collect()
        });
        // The first seven are the pieces of the surface.
        self.exact.curve_points().into_iter().take(7).chain(splits).collect()
    }

    fn extent(&self) -> [f64; 2] {
        self.exact.extent()
    }
}
