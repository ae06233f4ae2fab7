//! The thesis's smallest solids, by their equations.

use super::plane::unit;
use super::{Meridian, Oracle, OracleEvaluation, sample_curve, sample_line};

/// The unit sphere (Ho 1999, eq. 4.1, 4.2), its lowest point at the origin: depth `1 - |p - c|`, direction away
/// from the centre (0, 0, 1).
#[derive(Clone, Copy, Debug, Default)]
pub struct UnitSphere;

impl UnitSphere {
    fn from_centre(p: [f64; 3]) -> (Meridian, [f64; 2], f64) {
        let m = Meridian::of(p);
        let arm = [m.dz[0], m.dz[1] - 1.0];
        (m, arm, arm[0].hypot(arm[1]))
    }
}

impl Oracle for UnitSphere {
    fn name(&self) -> &'static str {
        "UnitSphere"
    }

    fn regions(&self) -> Vec<&str> {
        vec!["ball"]
    }

    fn evaluate(&self, p: [f64; 3]) -> Option<OracleEvaluation> {
        let (m, arm, rho) = Self::from_centre(p);
        (rho <= 1.0).then(|| OracleEvaluation {
            owner: 0,
            depth: 1.0 - rho,
            magnitude: 1.0 - rho,
            direction: m.lift(unit(&arm)),
            niceness: 0.0,
        })
    }

    fn gradient(&self, p: [f64; 3]) -> Option<[f64; 3]> {
        Some(self.evaluate(p)?.direction.map(|c| -c))
    }

    fn signed_distance(&self, p: [f64; 3]) -> f64 {
        Self::from_centre(p).2 - 1.0
    }

    fn border_distance(&self, p: [f64; 3]) -> f64 {
        self.signed_distance(p).abs()
    }

    fn singularity_distance(&self, p: [f64; 3]) -> f64 {
        // Across the axis the direction continues smoothly, but `x / d` is still computed there.
        let (m, _, rho) = Self::from_centre(p);
        if rho <= 1.0 { rho.min(m.dz[0]) } else { f64::INFINITY }
    }

    fn corners(&self) -> Vec<[f64; 2]> {
        vec![[0.0, 0.0], [0.0, 2.0], [0.0, 1.0]]
    }

    fn curves(&self) -> Vec<Vec<[f64; 2]>> {
        vec![sample_curve(|t| {
            let (sin, cos) = (t * std::f64::consts::PI).sin_cos();
            [sin, 1.0 - cos]
        })]
    }

    fn extent(&self) -> [f64; 2] {
        [1.0, 2.0]
    }
}

/// The finite cylinder of radius 2 and height 6 (Ho 1999, fig. 4.2), its bottom at z = 0. Regions are listed as
/// side, bottom, top.
#[derive(Clone, Copy, Debug, Default)]
pub struct Cylinder;

const REGIONS: [&str; 3] = ["side", "bottom", "top"];

impl Cylinder {
    /// Returns the distances inward from the side, the bottom and the top.
    fn inward(p: [f64; 3]) -> (Meridian, [f64; 3]) {
        let m = Meridian::of(p);
        (m, [2.0 - m.dz[0], m.dz[1], 6.0 - m.dz[1]])
    }
}

impl Oracle for Cylinder {
    fn name(&self) -> &'static str {
        "Cylinder"
    }

    fn regions(&self) -> Vec<&str> {
        REGIONS.to_vec()
    }

    fn evaluate(&self, p: [f64; 3]) -> Option<OracleEvaluation> {
        let (m, [side, low, high]) = Self::inward(p);
        let (owner, depth, direction) = if side >= 0.0 && side <= low.min(high) {
            (0, side, [1.0, 0.0])
        } else if low >= 0.0 && low <= side.min(high) {
            (1, low, [0.0, -1.0])
        } else if high >= 0.0 && high <= side.min(low) {
            (2, high, [0.0, 1.0])
        } else {
            return None;
        };
        Some(OracleEvaluation {
            owner,
            depth,
            magnitude: depth,
            direction: m.lift(direction),
            niceness: 0.0,
        })
    }

    fn gradient(&self, p: [f64; 3]) -> Option<[f64; 3]> {
        Some(self.evaluate(p)?.direction.map(|c| -c))
    }

    fn signed_distance(&self, p: [f64; 3]) -> f64 {
        let (_, [side, low, high]) = Self::inward(p);
        let out = [-side, -low.min(high)];
        let inside = out[0].max(out[1]).min(0.0);
        inside + out[0].max(0.0).hypot(out[1].max(0.0))
    }

    fn border_distance(&self, p: [f64; 3]) -> f64 {
        let (_, [side, low, high]) = Self::inward(p);
        if self.evaluate(p).is_none() {
            return self.signed_distance(p).abs();
        }
        let diagonals = (side - low).abs().min((side - high).abs()) / std::f64::consts::SQRT_2;
        side.min(low).min(high).min(diagonals)
    }

    fn singularity_distance(&self, p: [f64; 3]) -> f64 {
        match self.evaluate(p) {
            Some(OracleEvaluation { owner: 0, .. }) => Meridian::of(p).dz[0],
            _ => f64::INFINITY,
        }
    }

    fn corners(&self) -> Vec<[f64; 2]> {
        vec![[0.0, 0.0], [2.0, 0.0], [2.0, 6.0], [0.0, 6.0], [0.0, 2.0], [0.0, 4.0]]
    }

    fn curves(&self) -> Vec<Vec<[f64; 2]>> {
        vec![
            sample_line([0.0, 0.0], [2.0, 0.0]),
            sample_line([2.0, 0.0], [2.0, 6.0]),
            sample_line([2.0, 6.0], [0.0, 6.0]),
            sample_line([2.0, 0.0], [0.0, 2.0]),
            sample_line([2.0, 6.0], [0.0, 4.0]),
        ]
    }

    fn extent(&self) -> [f64; 2] {
        [2.0, 6.0]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sphere_at_a_few_points() {
        let s = UnitSphere.evaluate([0.3, 0.0, 0.6]).expect("inside");
        assert!((s.depth - 0.5).abs() < 1e-15);
        assert!((s.direction[0] - 0.6).abs() < 1e-15 && (s.direction[2] + 0.8).abs() < 1e-15);
        assert_eq!(
            UnitSphere.evaluate([0.0, 0.0, 1.0]).map(|s| s.direction),
            Some([0.0, 0.0, 1.0])
        );
        assert_eq!(UnitSphere.evaluate([0.0, 0.0, 0.0]).map(|s| s.depth), Some(0.0));
        assert!(UnitSphere.evaluate([0.0, 0.0, -1e-15]).is_none());
    }

    #[test]
    fn the_cylinder_gives_its_borders_to_the_first_listed() {
        let region = |p| Cylinder.evaluate(p).map(|s| REGIONS[s.owner]);
        assert_eq!(region([1.0, 0.0, 1.0]), Some("side"));
        assert_eq!(region([1.0, 0.0, 5.0]), Some("side"));
        assert_eq!(region([0.5, 0.0, 1.0]), Some("bottom"));
        assert_eq!(region([0.5, 0.0, 5.0]), Some("top"));
        assert_eq!(region([0.0, 2.0, 0.0]), Some("side"));
        assert_eq!(region([0.0, 2.0, 6.5]), None);
        assert_eq!(Cylinder.evaluate([0.0, 0.0, 3.0]).map(|s| s.direction), Some([1.0, 0.0, 0.0]));
    }
}
