//! Directions spread evenly over the sphere.

use nalgebra::Vector3;
use std::f64::consts::PI;
use touchoff::cancellation;

/// A list of directions from which a part is approached.
#[derive(Clone, Debug, PartialEq)]
pub struct Directions {
    list: Vec<[f64; 3]>,
    /// Per direction, the indices of all directions by ascending angle from it.
    by_angle: Vec<Vec<u16>>,
}

impl Directions {
    /// Largest number of directions per hemisphere.
    pub const MAX_HEMISPHERE: usize = 2_000;

    /// Creates directions with about `hemisphere` of them in every hemisphere, at most [`Directions::MAX_HEMISPHERE`]: a
    /// spiral of twice as many, each of which stands for an equal area of the sphere (Fibonacci's lattice;
    /// González, *Measurement of areas on a sphere using Fibonacci and latitude–longitude lattices*, 2010).
    pub fn spread(hemisphere: usize) -> Directions {
        let count = 2 * hemisphere.min(Directions::MAX_HEMISPHERE);
        // The golden angle: neighbours on the spiral never line up from turn to turn.
        let golden = PI * (3.0 - 5f64.sqrt());
        let list = (0..count).map(|k| {
            // In the middles of layers of equal height, which cut equal areas from the sphere (Archimedes).
            let up = 1.0 - (2 * k + 1) as f64 / count as f64;
            let out = (1.0 - up * up).sqrt();
            // The sines of the system differ by a bit from one system to another, and maps compare directions.
            let (sine, cosine) = libm::sincos(golden * k as f64);
            let vector = Vector3::new(out * cosine, out * sine, up).normalize();
            [vector.x, vector.y, vector.z]
        });
        Directions::from(list.collect::<Vec<_>>())
    }

    /// Returns the unit vectors.
    pub fn list(&self) -> &[[f64; 3]] {
        &self.list
    }

    /// Returns the number of 64-bit words of a set of directions.
    pub(crate) fn words(&self) -> usize {
        self.list.len().div_ceil(64)
    }

    /// Returns the indices of all directions by ascending angle from one of them, which is the first.
    pub(crate) fn by_angle(&self, direction: usize) -> impl Iterator<Item = usize> {
        self.by_angle[direction].iter().map(|other| usize::from(*other))
    }

    /// Returns the cosine of the angle between a direction of a set and the nearest direction outside the set;
    /// -1 if the set has all directions.
    pub(crate) fn margin(&self, set: &[u64], direction: usize) -> f64 {
        let vector = Vector3::from(self.list[direction]);
        let out = self.by_angle(direction).find(|other| !contains(set, *other));
        out.map_or(-1.0, |other| vector.dot(&Vector3::from(self.list[other])))
    }

    /// Returns the solid angle of a set, in steradians. Each direction stands for an equal area of the sphere.
    pub fn solid_angle(&self, set: &[u64]) -> f64 {
        let count: u32 = set.iter().map(|word| word.count_ones()).sum();
        4.0 * PI * f64::from(count) / self.list.len().max(1) as f64
    }

    /// Returns the cone of a set: its direction with the largest angle to the nearest direction outside the
    /// set, and that angle in radians, which is half the cone's angle. Returns `None` for the empty set.
    pub fn cone(&self, set: &[u64]) -> Option<([f64; 3], f64)> {
        let members = (0..self.list.len()).filter(|direction| contains(set, *direction));
        let margins = members.map(|direction| (self.margin(set, direction), direction));
        let (cosine, best) = margins.min_by(|a, b| a.0.total_cmp(&b.0))?;
        Some((self.list[best], cosine.clamp(-1.0, 1.0).acos()))
    }
}

impl From<Vec<[f64; 3]>> for Directions {
    /// Takes unit vectors, at most twice [`Directions::MAX_HEMISPHERE`].
    fn from(list: Vec<[f64; 3]>) -> Directions {
        let vectors: Vec<Vector3<f64>> =
            list.iter().map(|direction| Vector3::from(*direction)).collect();
        let by_angle = vectors.iter().map(|direction| {
            cancellation::check();
            let mut others: Vec<(f64, u16)> =
                vectors.iter().zip(0..).map(|(other, k)| (-direction.dot(other), k)).collect();
            // Descending cosines; ties by index, so that the order is the same everywhere.
            others.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            others.into_iter().map(|(_, other)| other).collect()
        });
        let by_angle = by_angle.collect();
        Directions { list, by_angle }
    }
}

/// Returns whether a set of directions contains a direction.
pub(crate) fn contains(set: &[u64], direction: usize) -> bool {
    set[direction / 64] >> (direction % 64) & 1 == 1
}
