//! The nearest feature of a restated profile, with 256 bits.
//!
//! Candidates for the nearest segment are found in doubles, with a margin of 1e-9 of the tool's size, a million times
//! the error of doubles. All results are computed from these segments with 256 bits.

use super::Meridian;
use super::big::Big;
use super::profile::{Feature, NearestFeature, Profile};
use super::restated::Restated;

/// Margin, as a fraction of the tool's size, by which a segment may be farther than the nearest in doubles and is
/// still considered.
const MARGIN: f64 = 1e-9;

/// A tool's profile with 256 bits.
pub struct Reference {
    profile: Profile<Big>,
    sketch: Profile<f64>,
    size: f64,
}

impl Reference {
    /// Creates the reference of a restated tool.
    pub fn new(tool: &Restated) -> Self {
        let profile = tool.profile.clone();
        let sketch = profile.map(Big::to_f64);
        let size = sketch.extent()[1].into_iter().fold(0.0, f64::max);
        Self { profile, sketch, size }
    }

    /// Returns the nearest feature.
    fn nearest(&self, at: &Meridian<Big>) -> NearestFeature<Big> {
        let segments = self.sketch.segments().iter();
        let dz = at.dz.each_ref().map(Big::to_f64);
        let distances: Vec<f64> = segments.map(|segment| segment.distance(&dz)).collect();
        let reach = distances.iter().copied().fold(f64::INFINITY, f64::min) + MARGIN * self.size;
        self.profile.nearest_of(|k| distances[k] <= reach, &at.dz)
    }

    /// Returns the nearest feature of a point, and the depth: the distance, negative outside.
    fn feature_and_depth(&self, at: &Meridian<Big>) -> (Feature, Big) {
        let NearestFeature { feature, distance } = self.nearest(at);
        let is_inside = if distance.to_f64() > MARGIN * self.size {
            self.sketch.encloses(&at.dz.each_ref().map(Big::to_f64))
        } else {
            distance == Big::zero() || self.profile.encloses(&at.dz)
        };
        (feature, if is_inside { distance } else { -&distance })
    }

    /// Returns the depth of a point: the distance to the surface, negative outside.
    pub fn depth(&self, at: &Meridian<Big>) -> Big {
        self.feature_and_depth(at).1
    }

    /// Returns the owner of a point of the solid: the nearest feature, among equals the first listed. `None` outside.
    pub fn owner(&self, at: &Meridian<Big>) -> Option<usize> {
        let (feature, depth) = self.feature_and_depth(at);
        (!depth.is_negative()).then(|| self.profile.owner(feature))
    }

    /// Returns the distance to an owner: a segment with its ends, or a corner.
    pub fn distance_to(&self, at: &Meridian<Big>, owner: usize) -> Big {
        self.profile.distance(self.profile.owners()[owner], &at.dz)
    }

    /// Returns the unit vector from a point that an owner owns to its nearest point of the surface; where there is
    /// none, +z.
    pub fn direction(&self, at: &Meridian<Big>, owner: usize) -> [Big; 3] {
        at.lift(&self.profile.direction(self.profile.owners()[owner], &at.dz))
    }

    /// Returns the distance from a point to the nearest one at which its owner's direction does not exist. The axis
    /// counts, unless the owner is level.
    pub fn singularity_distance(&self, at: &Meridian<Big>, owner: usize) -> f64 {
        let owner = self.profile.owners()[owner];
        let distance = self.profile.singularity_distance(owner, &at.dz);
        let is_level = |segment: &super::segment::Segment<Big>| {
            segment.circle.is_none() && segment.from[1] == segment.to[1]
        };
        match owner {
            Feature::Segment(k) if is_level(&self.profile.segments()[k]) => distance,
            _ => distance.min(if at.dz[0] == Big::zero() { 0.0 } else { f64::INFINITY }),
        }
    }

    /// Returns the next power of two above the tool's largest coordinate, S; errors are measured in ulp(S).
    pub fn scale(&self) -> f64 {
        power_above(self.size)
    }
}

/// Returns the next power of two above a number.
pub fn power_above(number: f64) -> f64 {
    let power = number.log2().floor().exp2();
    if power > number { power } else { 2.0 * power }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_power_above_is_larger() {
        let powers = [0.99, 1.0, 1.5, 25.0, 32.0].map(power_above);
        assert_eq!(powers, [1.0, 2.0, 2.0, 32.0, 64.0]);
    }
}
