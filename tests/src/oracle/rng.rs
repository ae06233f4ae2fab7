//! Random numbers for the oracles' own tests: the same on every machine, from nothing but integers.

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

    /// Returns a unit vector, uniform over all directions.
    pub fn direction(&mut self) -> [f64; 3] {
        loop {
            let v = [0; 3].map(|_| self.between(-1.0, 1.0));
            let norm = v.iter().map(|c| c * c).sum::<f64>().sqrt();
            if (0.01..=1.0).contains(&norm) {
                return v.map(|c| c / norm);
            }
        }
    }
}
