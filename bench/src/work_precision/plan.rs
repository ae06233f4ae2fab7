//! Extent of a measurement.

/// Sizes, counts and times of a measurement.
#[derive(Clone, Debug)]
pub struct Plan {
    /// Approximate numbers of points in contact on a patch, one per size.
    pub contacts: Vec<usize>,
    /// Numbers of points in the clouds of a part, one per size.
    pub points: Vec<usize>,
    /// Interval between sizes at which the peers take part, counted from the largest size.
    pub peers_every: usize,
    /// Number of poses per path of the scenes.
    pub path: usize,
    /// Number of poses in contact at which errors are measured on a path.
    pub checks: usize,
    /// Number of placements on a patch that are timed.
    pub timed: usize,
    /// Number of placements per cloud of a patch at which errors are measured.
    pub placements: usize,
    /// Budgets of nodes per query.
    pub budgets: Vec<usize>,
    /// Tolerances of certified depths, in the part's unit.
    pub tolerances: Vec<f64>,
    /// Wanted relative accuracy of the true force and torque on a path, and the limit on evaluated pieces of triangles.
    pub known: (f64, usize),
    /// Time limit of a method per row, s; slower methods skip poses.
    pub seconds: f64,
    /// Seed for clouds and placements.
    pub seed: u64,
    /// True if this is the sample.
    pub quick: bool,
}

impl Plan {
    /// Returns the full measurement, which takes some minutes.
    pub fn full(seed: u64) -> Plan {
        Plan {
            contacts: vec![10, 32, 100, 316, 1_000, 3_160, 10_000, 20_000],
            points: vec![300, 1_000, 3_000, 10_000, 30_000, 100_000, 300_000, 1_000_000],
            peers_every: 2,
            path: 10_000,
            checks: 100,
            timed: 2_000,
            placements: 50,
            budgets: vec![100, 300, 1_000, 3_000],
            tolerances: (1..=9).map(|k| 10f64.powi(-k)).collect(),
            known: (1e-5, 1 << 21),
            seconds: 0.25,
            seed,
            quick: false,
        }
    }

    /// Returns a sample that takes less than a minute.
    pub fn quick(seed: u64) -> Plan {
        Plan {
            contacts: vec![32, 178, 1_000],
            points: vec![1_000, 10_000, 100_000],
            peers_every: 2,
            path: 2_000,
            checks: 30,
            timed: 500,
            placements: 30,
            budgets: vec![100, 1_000],
            tolerances: vec![1e-1, 1e-3, 1e-6, 1e-9],
            known: (1e-4, 1 << 16),
            seconds: 0.03,
            seed,
            quick: true,
        }
    }

    /// Returns the number of clouds per kind for a patch with this number of points in contact. The fewer the points,
    /// the more clouds differ from each other.
    pub fn clouds(&self, contacts: usize) -> usize {
        match contacts {
            _ if self.quick => 6,
            0..1_000 => 16,
            1_000..8_000 => 4,
            _ => 2,
        }
    }

    /// Returns whether peers take part at a size, given by its index from the largest.
    pub fn has_peers(&self, from_last: usize) -> bool {
        from_last.is_multiple_of(self.peers_every)
    }
}
