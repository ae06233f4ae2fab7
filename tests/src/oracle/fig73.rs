//! The ball end mill of fig. 7.3 with the thesis's own functions (Ho 1999, eq. 7.1 to 7.3), written out by hand.
//!
//! The thesis measures z from the back of the housing, with the tip at 20. The magnitudes of IV, VI and VII are not
//! distances. The splits are where the thesis's magnitudes meet without a jump.

use super::{Meridian, Nearest, Oracle, OracleEvaluation, fig_7_3_exact, sample_line, unit_or_z};

/// The thesis's names of the regions, in its order.
const REGIONS: [&str; 9] = ["I", "II", "III", "IV", "V", "VI", "VII", "VIII", "IX"];

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

/// Magnitude, its gradient and the direction in the thesis's `(d, z)`, and niceness.
type Value = (f64, [f64; 2], [f64; 2], f64);

/// Returns the region that `(d, z)`, in the thesis's frame, belongs to: the first that contains it.
fn owner(d: f64, z: f64) -> Option<usize> {
    let ball = d.hypot(z - 19.0) - 1.0;
    let holds = [
        z >= 0.0 && z + d <= 5.0,
        d <= 5.0 && z + d >= 5.0 && (z <= 9.0 || z <= d + 6.0),
        d >= 3.0 && z >= d + 6.0 && z <= 11.0,
        d <= 3.0 && (9.0..=11.0).contains(&z),
        d <= 3.0 && z >= 11.0 && (z <= 13.0 || z + d <= 14.0),
        d >= 1.0 && z >= 13.0 && z + d <= 16.0,
        d <= 1.0 && z + d >= 14.0 && z + d <= 16.0,
        d <= 1.0 && z + d >= 16.0 && z <= 19.0,
        z >= 19.0 && ball <= 0.0,
    ];
    holds.into_iter().position(|h| h)
}

fn evaluation(owner: usize, d: f64, z: f64) -> Value {
    match owner {
        0 => (z, [0.0, 1.0], [0.0, -1.0], 0.0),
        1 => (5.0 - d, [-1.0, 0.0], [1.0, 0.0], 0.0),
        2 => (11.0 - z, [0.0, -1.0], [0.0, 1.0], 0.0),
        3 => (14.0 - d - z, [-1.0, -1.0], [1.0, 1.0], 0.0),
        4 => (3.0 - d, [-1.0, 0.0], [1.0, 0.0], 0.0),
        5 => (16.0 - d - z, [-1.0, -1.0], [1.0, 1.0], 0.0),
        6 => (17.0 - 2.0 * d - z, [-2.0, -1.0], [2.0, 1.0], 0.0),
        7 => (1.0 - d, [-1.0, 0.0], [1.0, 0.0], 2.0 * d * d),
        _ => {
            let arm = [d, z - 19.0];
            // Where the direction vanishes, the tool's +z is the thesis's -z.
            let outward = if arm == [0.0, 0.0] { [0.0, -1.0] } else { unit_or_z(arm) };
            let nice = 2.0 * d * d + arm[1] * arm[1];
            (1.0 - d.hypot(arm[1]), outward.map(|c| -c), outward, nice)
        }
    }
}

/// Transforms a vector from the thesis's frame to the tool's: a half turn about x, which flips z in the half plane.
fn turned([e_d, e_z]: [f64; 2]) -> [f64; 2] {
    [e_d, -e_z]
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
        let (d, z) = (m.dz[0], 20.0 - m.dz[1]);
        let owner = owner(d, z)?;
        let (magnitude, _, direction, niceness) = evaluation(owner, d, z);
        Some(OracleEvaluation {
            owner,
            depth: magnitude,
            magnitude,
            direction: m.lift(unit_or_z(turned(direction))),
            niceness,
        })
    }

    fn gradient(&self, p: [f64; 3]) -> Option<[f64; 3]> {
        let m = Meridian::of(p);
        let (d, z) = (m.dz[0], 20.0 - m.dz[1]);
        let (_, slope, _, _) = evaluation(owner(d, z)?, d, z);
        Some(m.lift(turned(slope)))
    }

    fn signed_distance(&self, p: [f64; 3]) -> f64 {
        self.exact.signed_distance(p)
    }

    fn border_distance(&self, p: [f64; 3]) -> f64 {
        let surface = self.signed_distance(p).abs();
        if self.evaluate(p).is_none() {
            return surface;
        }
        let Meridian { dz: [d, z], .. } = Meridian::of(p);
        let z = 20.0 - z;
        // Each split counts as a whole line, so the bound is a little smaller than necessary.
        let level = [d - 3.0, d - 1.0, z - 9.0, z - 11.0, z - 13.0, z - 19.0];
        let sloped = [z + d - 5.0, z - d - 6.0, z + d - 14.0, z + d - 16.0];
        let level = level.into_iter().map(f64::abs);
        let sloped = sloped.into_iter().map(|s| s.abs() / std::f64::consts::SQRT_2);
        level.chain(sloped).fold(surface, f64::min)
    }

    fn singularity_distance(&self, p: [f64; 3]) -> f64 {
        let [d, z] = Meridian::of(p).dz;
        match owner(d, 20.0 - z) {
            None | Some(0 | 2) => f64::INFINITY,
            Some(8) => d.min(d.hypot(z - 1.0)),
            Some(_) => d,
        }
    }

    fn magnitude_is_depth(&self) -> bool {
        false
    }

    fn corners(&self) -> Vec<[f64; 2]> {
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
        thesis.map(|[d, z]| [d, 20.0 - z]).to_vec()
    }

    fn curves(&self) -> Vec<Vec<[f64; 2]>> {
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
        let mut all: Vec<_> = self.exact.curves().into_iter().take(7).collect(); // the seven pieces of the surface
        all.extend(thesis.map(|(a, b)| sample_line([a[0], 20.0 - a[1]], [b[0], 20.0 - b[1]])));
        all
    }

    fn extent(&self) -> [f64; 2] {
        self.exact.extent()
    }
}
