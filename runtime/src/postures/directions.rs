//! Directions, evenly spread over the sphere.

use nalgebra::Vector3;
use std::f64::consts::PI;

/// Directions that a part is approached from.
#[derive(Clone, Debug, PartialEq)]
pub struct Directions {
    list: Vec<[f64; 3]>,
    /// Of each all of them, the nearest first.
    beside: Vec<Vec<u16>>,
}

impl Directions {
    /// The most that a hemisphere may have.
    pub const MOST: usize = 2_000;

    /// Directions of which every hemisphere has about so many, at most [`Directions::MOST`]: a spiral of
    /// twice as many, each with as large a part of the sphere (Fibonacci's lattice; González, *Measurement
    /// of areas on a sphere using Fibonacci and latitude–longitude lattices*, 2010).
    pub fn spread(hemisphere: usize) -> Directions {
        let count = 2 * hemisphere.min(Directions::MOST);
        let golden = PI * (3.0 - 5f64.sqrt());
        let list = (0..count).map(|k| {
            let up = 1.0 - (2 * k + 1) as f64 / count as f64;
            let out = (1.0 - up * up).sqrt();
            let (sine, cosine) = (golden * k as f64).sin_cos();
            let way = Vector3::new(out * cosine, out * sine, up).normalize();
            [way.x, way.y, way.z]
        });
        Directions::from(list.collect::<Vec<_>>())
    }

    /// The unit vectors.
    pub fn list(&self) -> &[[f64; 3]] {
        &self.list
    }

    /// How many words of bits a set of them takes.
    pub(crate) fn words(&self) -> usize {
        self.list.len().div_ceil(64)
    }

    /// All directions, the nearest to one of them first, that is itself.
    pub(crate) fn beside(&self, direction: usize) -> impl Iterator<Item = usize> {
        self.beside[direction].iter().map(|other| usize::from(*other))
    }

    /// How far a direction of a set is from the nearest that is not, as the cosine of that angle; -1 if all
    /// are.
    pub(crate) fn margin(&self, set: &[u64], direction: usize) -> f64 {
        let way = Vector3::from(self.list[direction]);
        let out = self.beside(direction).find(|other| !has(set, *other));
        out.map_or(-1.0, |other| way.dot(&Vector3::from(self.list[other])))
    }

    /// The solid angle of a set, in steradians, each direction having as large a part of the sphere.
    pub fn solid_angle(&self, set: &[u64]) -> f64 {
        let count: u32 = set.iter().map(|word| word.count_ones()).sum();
        4.0 * PI * f64::from(count) / self.list.len().max(1) as f64
    }

    /// The cone of a set: the direction of it that is farthest from any that is not, and half the cone's
    /// angle, in radians: how far that is. `None` of the empty set.
    pub fn cone(&self, set: &[u64]) -> Option<([f64; 3], f64)> {
        let members = (0..self.list.len()).filter(|direction| has(set, *direction));
        let margins = members.map(|direction| (self.margin(set, direction), direction));
        let (cosine, best) = margins.min_by(|a, b| a.0.total_cmp(&b.0))?;
        Some((self.list[best], cosine.clamp(-1.0, 1.0).acos()))
    }
}

impl From<Vec<[f64; 3]>> for Directions {
    /// Of unit vectors, no more than twice [`Directions::MOST`].
    fn from(list: Vec<[f64; 3]>) -> Directions {
        let ways: Vec<Vector3<f64>> = list.iter().map(|way| Vector3::from(*way)).collect();
        let beside = ways.iter().map(|way| {
            let mut others: Vec<(f64, u16)> =
                ways.iter().zip(0..).map(|(other, k)| (-way.dot(other), k)).collect();
            others.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            others.into_iter().map(|(_, other)| other).collect()
        });
        let beside = beside.collect();
        Directions { list, beside }
    }
}

/// Whether a set of directions has one.
pub(crate) fn has(set: &[u64], direction: usize) -> bool {
    set[direction / 64] >> (direction % 64) & 1 == 1
}
