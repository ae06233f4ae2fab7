//! Tools whose owner is the nearest feature of the profile: nothing but [`Profile`] decides, the splitting curves are only listed.

use super::profile::Profile;
use super::{Meridian, Oracle, Sense, sampled, straight};

/// A profile tool: `depth` is the distance, `magnitude` the same, the direction points to the nearest point.
#[derive(Clone, Debug)]
struct Nearest {
    profile: Profile,
    regions: &'static [&'static str],
    /// Largest `d` and `z`.
    extent: [f64; 2],
}

impl Nearest {
    fn sense(&self, p: [f64; 3], niceness: impl Fn(usize, f64, [f64; 2]) -> f64) -> Option<Sense> {
        let m = Meridian::of(p);
        let [d, z] = m.dz;
        if d > self.extent[0] || z < 0.0 || z > self.extent[1] {
            return None; // most points of most clouds
        }
        let (near, toward) = self.profile.sense(m.dz)?;
        Some(Sense {
            region: self.regions[near.owner],
            owner: near.owner,
            depth: near.distance,
            magnitude: near.distance,
            direction: m.lift(toward),
            niceness: niceness(near.owner, near.distance, m.dz),
        })
    }
}

/// What the three tools below have in common.
macro_rules! ask_the_profile {
    () => {
        fn name(&self) -> &'static str {
            Self::NAME
        }
        fn regions(&self) -> &'static [&'static str] {
            self.0.regions
        }
        fn gradient(&self, p: [f64; 3]) -> Option<[f64; 3]> {
            Some(self.sense(p)?.direction.map(|c| -c))
        }
        fn signed_distance(&self, p: [f64; 3]) -> f64 {
            self.0.profile.signed_distance(Meridian::of(p).dz)
        }
        fn border(&self, p: [f64; 3]) -> f64 {
            self.0.profile.border(Meridian::of(p).dz)
        }
        fn singular(&self, p: [f64; 3]) -> f64 {
            self.0.profile.singular(Meridian::of(p).dz)
        }
        fn corners(&self) -> Vec<[f64; 2]> {
            let ends = Self::splits().into_iter().flat_map(|c| [c[0], c[c.len() - 1]]);
            let mut all: Vec<[f64; 2]> = self.0.profile.corners().into_iter().chain(ends).collect();
            all.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
            all.dedup();
            all
        }
        fn curves(&self) -> Vec<Vec<[f64; 2]>> {
            let mut all = self.0.profile.surface();
            all.extend(Self::splits());
            all
        }
        fn extent(&self) -> [f64; 2] {
            self.0.extent
        }
    };
}

/// The half sphere of radius 2 joined to a cylinder of radius 1 (Ho 1999, fig. 2.2, 2.3), 8 long.
///
/// Regions along the profile: `ball`, `step`, `step/stem` (the reflex corner (1, 2)), `stem`, `end`. The example file calls the last two
/// pieces by one name, `stem`.
#[derive(Clone, Debug)]
pub struct HalfSphereCylinder(Nearest);

impl HalfSphereCylinder {
    const NAME: &'static str = "HalfSphereCylinder";

    fn splits() -> Vec<Vec<[f64; 2]>> {
        vec![
            // ball | step: 2 - |p - c| = 2 - z, a parabola.
            sampled(|t| {
                let d = 2.0 - t;
                [d, 1.0 + d * d / 4.0]
            }),
            // ball | corner: |p - c| + |p - q| = 2, an ellipse with foci (0, 2) and (1, 2).
            sampled(|t| {
                let d = 1.0 - t;
                [d, 2.0 - (0.75 * (1.0 - (d - 0.5) * (d - 0.5))).sqrt()]
            }),
            straight([1.0, 1.25], [1.0, 2.0]), // step | corner
            straight([1.0, 2.0], [0.0, 2.0]),  // corner | stem
            straight([1.0, 8.0], [0.0, 7.0]),  // stem | end
        ]
    }
}

impl Default for HalfSphereCylinder {
    fn default() -> Self {
        let regions = &["ball", "step", "step/stem", "stem", "end"];
        let profile = Profile::new(
            [0.0, 0.0],
            &[
                ([2.0, 2.0], Some([0.0, 2.0]), "ball"),
                ([1.0, 2.0], None, "step"),
                ([1.0, 8.0], None, "stem"),
                ([0.0, 8.0], None, "end"),
            ],
            &["step/stem"],
            regions,
        );
        Self(Nearest { profile, regions, extent: [2.0, 8.0] })
    }
}

impl Oracle for HalfSphereCylinder {
    ask_the_profile!();

    fn sense(&self, p: [f64; 3]) -> Option<Sense> {
        self.0.sense(p, |_, _, _| 0.0)
    }
}

/// The ball end mill of fig. 7.3 with true distances. Regions I to IX by feature, in the thesis's order (from the spindle's end); IV and
/// VII are the reflex corners. Niceness as eq. 7.3.
#[derive(Clone, Debug)]
pub struct Fig73Exact(Nearest);

impl Fig73Exact {
    const NAME: &'static str = "Fig73Exact";

    fn splits() -> Vec<Vec<[f64; 2]>> {
        let s2 = std::f64::consts::SQRT_2;
        vec![
            straight([5.0, 20.0], [0.0, 15.0]), // I | II
            straight([5.0, 9.0], [3.0, 11.0]),  // II | III
            // II | IV, the parabola around (3, 9) that d = 5 directs.
            sampled(|t| {
                let up = 2.0 + 2.0 * t;
                [4.0 - up * up / 4.0, 9.0 + up]
            }),
            straight([3.0, 11.0], [3.0, 9.0]),           // III | IV
            straight([3.0, 9.0], [0.0, 9.0]),            // IV | V
            straight([3.0, 7.0], [0.0, 4.0 + 3.0 * s2]), // V | VI
            straight([1.0, 5.0], [0.0, 6.0]),            // VI | VII
            straight([1.0, 5.0], [0.0, 5.0]),            // VII | VIII
            straight([1.0, 1.0], [0.0, 1.0]),            // VIII | IX
        ]
    }
}

impl Default for Fig73Exact {
    fn default() -> Self {
        let regions = &super::fig73::REGIONS;
        let profile = Profile::new(
            [0.0, 0.0],
            &[
                ([1.0, 1.0], Some([0.0, 1.0]), "IX"),
                ([1.0, 5.0], None, "VIII"),
                ([3.0, 7.0], None, "VI"),
                ([3.0, 9.0], None, "V"),
                ([5.0, 9.0], None, "III"),
                ([5.0, 20.0], None, "II"),
                ([0.0, 20.0], None, "I"),
            ],
            &["VII", "IV"],
            regions,
        );
        Self(Nearest { profile, regions, extent: [5.0, 20.0] })
    }
}

impl Oracle for Fig73Exact {
    ask_the_profile!();

    fn sense(&self, p: [f64; 3]) -> Option<Sense> {
        self.0.sense(p, |owner, _, [d, z]| match owner {
            7 => 2.0 * d * d,
            8 => 2.0 * d * d + (z - 1.0) * (z - 1.0),
            _ => 0.0,
        })
    }
}

/// A plain 2 mm ball end mill, 40 long, its flute 5: ball and flute cut, with niceness `1 - depth`.
#[derive(Clone, Debug)]
pub struct D2Ball(Nearest);

impl D2Ball {
    const NAME: &'static str = "D2Ball";

    fn splits() -> Vec<Vec<[f64; 2]>> {
        vec![
            straight([1.0, 1.0], [0.0, 1.0]),   // ball | flute
            straight([1.0, 5.0], [0.0, 5.0]),   // flute | shank
            straight([1.0, 40.0], [0.0, 39.0]), // shank | end
        ]
    }
}

impl Default for D2Ball {
    fn default() -> Self {
        let regions = &["ball", "flute", "shank", "end"];
        let profile = Profile::new(
            [0.0, 0.0],
            &[
                ([1.0, 1.0], Some([0.0, 1.0]), "ball"),
                ([1.0, 5.0], None, "flute"),
                ([1.0, 40.0], None, "shank"),
                ([0.0, 40.0], None, "end"),
            ],
            &[],
            regions,
        );
        Self(Nearest { profile, regions, extent: [1.0, 40.0] })
    }
}

impl Oracle for D2Ball {
    ask_the_profile!();

    fn sense(&self, p: [f64; 3]) -> Option<Sense> {
        self.0.sense(p, |owner, depth, _| if owner < 2 { 1.0 - depth } else { 0.0 })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn borders_go_to_the_first_listed() {
        let ball = D2Ball::default();
        let region = |d: f64, z: f64| ball.sense([d, 0.0, z]).map(|s| s.region);
        for d in [0.0, 0.3, 1.0] {
            assert_eq!(region(d, 1.0), Some("ball"));
            assert_eq!(region(d, 5.0), Some("flute"));
        }
        assert_eq!(region(0.5, 39.5), Some("shank"));
        assert_eq!(region(1.0, 40.0), Some("shank"));
        assert_eq!(region(0.5, 40.0), Some("end"));
        assert_eq!(region(1.0, 40.1), None);
    }

    #[test]
    fn the_half_sphere_is_mostly_its_step_and_corner() {
        let tool = HalfSphereCylinder::default();
        let at = |d: f64, z: f64| tool.sense([0.0, d, z]).expect("inside");
        let s = at(0.0, 2.0); // the arc's centre: the corner is nearer than the ball
        assert_eq!((s.region, s.depth, s.direction), ("step/stem", 1.0, [1.0, 0.0, 0.0]));
        let s = at(0.0, 1.25); // ball and corner tie on the axis
        assert!((s.depth - 1.25).abs() < 1e-15);
        let s = at(1.5, 1.8);
        assert_eq!((s.region, s.direction), ("step", [0.0, 0.0, 1.0]));
        assert_eq!(at(0.1, 5.0).region, "stem");
        assert_eq!(at(0.1, 7.5).region, "end");
    }
}
