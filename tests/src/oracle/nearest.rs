//! Tools whose owner is the nearest feature of the profile: nothing but [`Profile`] decides.

use super::profile::{Feature, Profile};
use super::restated::{self, Niceness, Restated};
use super::rng::Rng;
use super::vector::Point;
use super::{Meridian, Oracle, OracleEvaluation, in_space, sample_curve, sample_line};

/// Points along a curve.
type Points = Vec<Point<f64>>;

/// A profile tool: `depth` is the distance, `magnitude` the same, and the direction points to the nearest point.
#[derive(Clone, Debug)]
pub struct Nearest {
    name: &'static str,
    profile: Profile<f64>,
    /// What each owner of the profile is to the tool.
    regions: Vec<Region>,
    niceness: Niceness,
    /// Largest `d` and `z`.
    extent: [f64; 2],
    /// The splitting curves, if they are known as equations.
    splits: Option<Vec<Points>>,
}

#[derive(Clone, Debug)]
struct Region {
    name: String,
    surface: &'static str,
    cutting: bool,
    /// Its index in the tool's list.
    index: usize,
}

impl Nearest {
    /// Creates the oracle of a restated tool.
    pub fn new(tool: &Restated) -> Self {
        let profile = tool.profile.map(super::big::Big::to_f64);
        Self {
            name: tool.name,
            regions: regions(tool, &profile),
            extent: profile.extent()[1],
            profile,
            niceness: tool.niceness.clone(),
            splits: None,
        }
    }

    /// Creates the oracle of a restated tool, by its name.
    pub fn of(name: &str) -> Self {
        let tool = restated::of(name);
        Self::new(&tool.unwrap_or_else(|| panic!("`{name}` is not restated")))
    }

    fn with(mut self, splits: Vec<Points>) -> Self {
        self.splits = Some(splits);
        self
    }

    /// Lists the regions in another order than along the profile.
    fn listed<const N: usize>(mut self, indices: [usize; N]) -> Self {
        self.regions.iter_mut().zip(indices).for_each(|(region, index)| region.index = index);
        self
    }

    /// Returns the profile.
    pub fn profile(&self) -> &Profile<f64> {
        &self.profile
    }

    /// Returns the surface of each owner of the profile, and whether it cuts.
    pub fn surfaces(&self) -> impl Iterator<Item = (&'static str, bool)> {
        self.regions.iter().map(|region| (region.surface, region.cutting))
    }

    /// Returns the distance to the segments of a surface, from either side.
    pub fn distance_to_surface(&self, surface: &str, p: [f64; 3]) -> f64 {
        self.distance_where(|region| region.surface == surface, p)
    }

    /// Returns the distance to the segments that cut, or to the others, from either side.
    pub fn distance_to_cutting(&self, cutting: bool, p: [f64; 3]) -> f64 {
        self.distance_where(|region| region.cutting == cutting, p)
    }

    fn distance_where(&self, counts: impl Fn(&Region) -> bool, p: [f64; 3]) -> f64 {
        let at = Meridian::of(p).dz;
        let owned = self.profile.owners().iter().zip(&self.regions);
        let segments =
            owned.filter(|(owner, region)| matches!(owner, Feature::Segment(_)) && counts(region));
        segments.map(|(owner, _)| self.profile.distance(*owner, &at)).fold(f64::INFINITY, f64::min)
    }

    /// Returns points at which the nearest feature changes, found by bisection; one list per pair of owners.
    fn sample_splits(&self) -> Vec<Points> {
        const BISECTED_SEGMENTS: usize = 4_000;
        let owner = |q: [f64; 2]| self.evaluate([q[0], 0.0, q[1]]).map(|s| s.owner);
        let [radius, height] = self.extent;
        let mut rng = Rng::new(27);
        let mut all = std::collections::BTreeMap::<_, Points>::new();
        for _ in 0..BISECTED_SEGMENTS {
            let a = [rng.between(0.0, radius), rng.between(0.0, height)];
            let mut step = || rng.between(-0.3 * radius, 0.3 * radius);
            let b = [(a[0] + step()).abs(), a[1] + step()];
            let (Some(first), Some(last)) = (owner(a), owner(b)) else { continue };
            if first == last {
                continue;
            }
            let (mut a, mut b, mut beyond) = (a, b, last);
            for _ in 0..60 {
                let middle = [(a[0] + b[0]) / 2.0, (a[1] + b[1]) / 2.0];
                match owner(middle) {
                    Some(other) if other == first => a = middle,
                    Some(other) => (b, beyond) = (middle, other),
                    None => break,
                }
            }
            if (a[0] - b[0]).abs().max((a[1] - b[1]).abs()) <= 1e-13 * height {
                all.entry((first.min(beyond), first.max(beyond))).or_default().push(a);
            }
        }
        all.into_values().collect()
    }
}

/// Returns the names of regions, as the language gives them, and their surfaces. A corner's surface is that of the
/// neighbour that does not cut, or else of the first.
fn regions(tool: &Restated, profile: &Profile<f64>) -> Vec<Region> {
    let cuts = |surface: &str| tool.cutting.contains(&surface);
    let last = tool.surfaces.len() - 1;
    let mut fans: Vec<String> = Vec::new();
    let of = |(index, feature): (usize, &Feature)| match *feature {
        Feature::Segment(k) => {
            let surface = tool.surfaces[k];
            let count = |surfaces: &[&str]| surfaces.iter().filter(|s| **s == surface).count();
            let name = match count(&tool.surfaces) {
                1 => surface.to_owned(),
                _ => format!("{surface}.{}", count(&tool.surfaces[..=k])),
            };
            Region { name, surface, cutting: cuts(surface), index }
        }
        Feature::Corner(k) => {
            let [a, b] = [k.saturating_sub(1), k.min(last)].map(|k| tool.surfaces[k]);
            let surface = if cuts(a) && !cuts(b) { b } else { a };
            let pair = format!("{a}/{b}");
            fans.push(pair.clone());
            let count = fans.iter().filter(|other| **other == pair).count();
            Region { name: format!("{pair}.{count}"), surface, cutting: cuts(surface), index }
        }
    };
    profile.owners().iter().enumerate().map(of).collect()
}

impl Oracle for Nearest {
    fn name(&self) -> &'static str {
        self.name
    }

    fn regions(&self) -> Vec<&str> {
        let mut listed: Vec<&Region> = self.regions.iter().collect();
        listed.sort_by_key(|region| region.index);
        listed.into_iter().map(|region| region.name.as_str()).collect()
    }

    fn evaluate(&self, p: [f64; 3]) -> Option<OracleEvaluation> {
        let m = Meridian::of(p);
        let [d, z] = m.dz;
        if d > self.extent[0] || z < 0.0 || z > self.extent[1] {
            return None; // most points of most clouds
        }
        let near = self.profile.nearest(&m.dz);
        let depth = near.distance;
        if depth > 0.0 && !self.profile.encloses(&m.dz) {
            return None;
        }
        let region = &self.regions[self.profile.owner(near.feature)];
        let niceness = || self.niceness.at(region.surface, depth, m.dz).max(0.0);
        Some(OracleEvaluation {
            owner: region.index,
            depth,
            magnitude: depth,
            direction: m.lift(&self.profile.direction(near.feature, &m.dz)),
            niceness: if region.cutting { niceness() } else { 0.0 },
        })
    }

    fn signed_distance(&self, p: [f64; 3]) -> f64 {
        -self.profile.depth(&Meridian::of(p).dz)
    }

    fn border_distance(&self, p: [f64; 3]) -> f64 {
        self.profile.border_distance(&Meridian::of(p).dz)
    }

    fn singularity_distance(&self, p: [f64; 3]) -> f64 {
        let at = Meridian::of(p).dz;
        let near = self.profile.nearest(&at);
        let is_inside = near.distance == 0.0 || self.profile.encloses(&at);
        let singularity = || self.profile.singularity_distance(near.feature, &at);
        if is_inside { singularity() } else { f64::INFINITY }
    }

    fn corner_points(&self) -> Vec<[f64; 3]> {
        let known = self.splits.iter().flatten().flat_map(|c| [c[0], c[c.len() - 1]]);
        let mut all: Vec<[f64; 2]> = self.profile.corners().into_iter().chain(known).collect();
        all.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
        all.dedup();
        all.into_iter().map(in_space).collect()
    }

    fn curve_points(&self) -> Vec<Vec<[f64; 3]>> {
        let mut all = self.profile.surface();
        all.extend(self.splits.clone().unwrap_or_else(|| self.sample_splits()));
        all.into_iter().map(|curve| curve.into_iter().map(in_space).collect()).collect()
    }

    fn extent(&self) -> [f64; 2] {
        self.extent
    }
}

/// Returns the finite cylinder of radius 2 and height 6 (Ho 1999, fig. 4.2), whose side is listed first.
pub fn cylinder() -> Nearest {
    Nearest::of("Cylinder").listed([1, 0, 2]).with(vec![
        sample_line([2.0, 0.0], [0.0, 2.0]), // bottom | side
        sample_line([2.0, 6.0], [0.0, 4.0]), // side | top
    ])
}

/// Returns the half sphere of radius 2 joined to a cylinder of radius 1 (Ho 1999, fig. 2.2, 2.3), 8 long.
pub fn half_sphere_cylinder() -> Nearest {
    Nearest::of("HalfSphereCylinder").with(vec![
        // ball | step: 2 - |p - c| = 2 - z, a parabola.
        sample_curve(|t| {
            let d = 2.0 - t;
            [d, 1.0 + d * d / 4.0]
        }),
        // ball | corner: |p - c| + |p - q| = 2, an ellipse with foci (0, 2) and (1, 2).
        sample_curve(|t| {
            let d = 1.0 - t;
            [d, 2.0 - (0.75 * (1.0 - (d - 0.5) * (d - 0.5))).sqrt()]
        }),
        sample_line([1.0, 1.25], [1.0, 2.0]), // step | corner
        sample_line([1.0, 2.0], [0.0, 2.0]),  // corner | stem
        sample_line([1.0, 8.0], [0.0, 7.0]),  // stem | end
    ])
}

/// Returns the ball end mill of fig. 7.3 with true distances. Its regions, from the tip up, are the thesis's IX to
/// I; IV and VII are the reflex corners.
pub fn fig_7_3_exact() -> Nearest {
    let s2 = std::f64::consts::SQRT_2;
    Nearest::of("Fig73Exact").with(vec![
        sample_line([5.0, 20.0], [0.0, 15.0]), // I | II
        sample_line([5.0, 9.0], [3.0, 11.0]),  // II | III
        // II | IV, the parabola with focus (3, 9) and directrix d = 5.
        sample_curve(|t| {
            let up = 2.0 + 2.0 * t;
            [4.0 - up * up / 4.0, 9.0 + up]
        }),
        sample_line([3.0, 11.0], [3.0, 9.0]), // III | IV
        sample_line([3.0, 9.0], [0.0, 9.0]),  // IV | V
        sample_line([3.0, 7.0], [0.0, 4.0 + 3.0 * s2]), // V | VI
        sample_line([1.0, 5.0], [0.0, 6.0]),  // VI | VII
        sample_line([1.0, 5.0], [0.0, 5.0]),  // VII | VIII
        sample_line([1.0, 1.0], [0.0, 1.0]),  // VIII | IX
    ])
}

/// Returns a plain 2 mm ball end mill, 40 long, its flute up to 5: ball and flute cut, with niceness `1 - depth`.
pub fn d2_ball() -> Nearest {
    Nearest::of("D2Ball").with(vec![
        sample_line([1.0, 1.0], [0.0, 1.0]),   // ball | flute
        sample_line([1.0, 5.0], [0.0, 5.0]),   // flute | shank
        sample_line([1.0, 40.0], [0.0, 39.0]), // shank | end
    ])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn borders_go_to_the_first_listed() {
        let ball = d2_ball();
        let region = |d: f64, z: f64| ball.evaluate([d, 0.0, z]).map(|s| ball.regions()[s.owner]);
        for d in [0.0, 0.3, 1.0] {
            assert_eq!(region(d, 1.0), Some("ball"));
            assert_eq!(region(d, 5.0), Some("flute"));
        }
        assert_eq!(region(0.5, 39.5), Some("shank.1"));
        assert_eq!(region(1.0, 40.0), Some("shank.1"));
        assert_eq!(region(0.5, 40.0), Some("shank.2"));
        assert_eq!(region(1.0, 40.1), None);
        let cylinder = cylinder();
        let region =
            |d: f64, z: f64| cylinder.evaluate([d, 0.0, z]).map(|s| cylinder.regions()[s.owner]);
        assert_eq!(region(0.5, 1.0), Some("bottom"));
        assert_eq!(region(0.5, 5.0), Some("top"));
        assert_eq!((region(1.9, 3.0), region(2.0, 6.5)), (Some("side"), None));
    }
}
