//! Random numbers for oracles and tests: the same on every machine, from nothing but integers.

use super::vector::{add, dot, norm, unit};

/// A stream of pseudo-random numbers (splitmix64: Steele, Lea, Flood 2014).
#[derive(Clone, Debug)]
pub struct Rng(u64);

impl Rng {
    /// Creates a stream; equal seeds give equal streams.
    pub fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// Returns the next 64 bits.
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Returns a number uniform in `low..high`.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        // The upper 53 bits are exact in f64.
        let unit = (self.bits() >> 11) as f64 * 2f64.powi(-53);
        low + (high - low) * unit
    }

    /// Returns a power of ten whose exponent is uniform in `low..high`.
    pub fn power(&mut self, low: f64, high: f64) -> f64 {
        10f64.powf(self.between(low, high))
    }

    /// Returns an index below `count`.
    pub fn index(&mut self, count: usize) -> usize {
        (self.bits() % count as u64) as usize
    }

    /// Returns an item of a list.
    pub fn pick<T: Copy>(&mut self, list: &[T]) -> T {
        list[self.index(list.len())]
    }

    /// Returns true once in `count` times.
    pub fn once_in(&mut self, count: u64) -> bool {
        self.bits().is_multiple_of(count)
    }

    /// Returns a unit vector, uniform over all directions.
    pub fn direction(&mut self) -> [f64; 3] {
        self.unit_vector()
    }

    /// Returns a unit vector across a unit vector, uniform over all such.
    pub fn across(&mut self, direction: [f64; 3]) -> [f64; 3] {
        loop {
            let candidate = self.direction();
            let across = add(&candidate, &direction, &-dot(&direction, &candidate));
            if norm(&across) > 0.1 {
                return unit(&across);
            }
        }
    }

    /// Returns a unit quaternion, uniform over all rotations.
    pub fn quaternion(&mut self) -> [f64; 4] {
        self.unit_vector()
    }

    fn unit_vector<const N: usize>(&mut self) -> [f64; N] {
        loop {
            let v = [0; N].map(|_| self.between(-1.0, 1.0));
            let norm = v.iter().map(|c| c * c).sum::<f64>().sqrt();
            if (0.01..=1.0).contains(&norm) {
                return v.map(|c| c / norm);
            }
        }
    }

    /// Returns two barycentric weights of a point uniform over a triangle.
    pub fn weights(&mut self) -> [f64; 2] {
        let [v, w] = [self.between(0.0, 1.0), self.between(0.0, 1.0)];
        if v + w > 1.0 { [1.0 - v, 1.0 - w] } else { [v, w] }
    }

    /// Returns the sine and cosine of an angle uniform over the circle, as `[cos, sin]`.
    pub fn azimuth(&mut self) -> [f64; 2] {
        let (sin, cos) = self.between(0.0, std::f64::consts::TAU).sin_cos();
        [cos, sin]
    }
}
