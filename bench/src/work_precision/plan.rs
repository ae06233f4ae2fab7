//! How much is measured.

/// Sizes, counts and times of a run.
#[derive(Clone, Debug)]
pub struct Plan {
    /// Points that are to be in contact on a patch, about.
    pub contacts: Vec<usize>,
    /// Points of clouds of a part.
    pub points: Vec<usize>,
    /// How many of both sizes have peers beside them: every so many.
    pub peers_every: usize,
    /// Poses that a path of the scenes is cut into.
    pub path: usize,
    /// Poses in contact at which errors are measured on a path.
    pub checks: usize,
    /// Placements on a patch that are timed.
    pub timed: usize,
    /// Placements on each cloud of a patch at which errors are measured.
    pub placements: usize,
    /// Budgets of nodes.
    pub budgets: Vec<usize>,
    /// Tolerances that depth is proved to, in the part's unit.
    pub tolerances: Vec<f64>,
    /// To what share force and torque of a path's truth are to be known, and by how many triangles at most.
    pub known: (f64, usize),
    /// How long a method may take for a row; slower ones sit out poses.
    pub seconds: f64,
    /// The same seed, the same clouds and placements.
    pub seed: u64,
    /// Whether it is the sample.
    pub quick: bool,
}

impl Plan {
    /// The measurement, some minutes long.
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

    /// A sample of it, less than a minute long.
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

    /// How many clouds of a kind are made of a patch, where so many points are in contact: the fewer, the more
    /// one differs from the other.
    pub fn clouds(&self, contacts: usize) -> usize {
        match contacts {
            _ if self.quick => 6,
            0..1_000 => 16,
            1_000..8_000 => 4,
            _ => 2,
        }
    }

    /// Whether peers race at a size, by its place counted from the largest.
    pub fn has_peers(&self, from_last: usize) -> bool {
        from_last.is_multiple_of(self.peers_every)
    }
}
