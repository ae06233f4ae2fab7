//! Errors of force, torque and deepest depth by the number of points.

use super::contact::{Contact, DEPTH};
use super::{Pattern, Weighing, equal, order, rms};
use rayon::prelude::*;
use touchoff::{Cloud, Mesh, Part, Probe};
use touchoff_tests::oracle::draw::Draw;

/// How often a size is measured.
#[derive(Clone, Copy, Debug)]
pub struct Often {
    /// How many points are to be in contact, about.
    pub contacts: f64,
    /// Clouds of a pattern.
    pub clouds: usize,
    /// Placements of the tool on each.
    pub placements: usize,
}

/// What was measured at a size.
#[derive(Clone, Debug)]
pub struct Row {
    /// How often.
    pub often: Often,
    /// Points of the cloud.
    pub points: usize,
    /// Points in contact, on average over all placements.
    pub colliding: f64,
    /// Root mean squares: the length of the force's error by the force, of the torque's by the
    /// torque, by pattern and weighing.
    pub force: [[f64; 2]; 2],
    /// See `force`.
    pub torque: [[f64; 2]; 2],
    /// That of the deepest depth by the depth, by pattern.
    pub depth: [f64; 2],
}

/// What a contact gave, size by size.
#[derive(Clone, Debug)]
pub struct Table {
    /// The contact.
    pub contact: Contact,
    /// By how much larger the patch is.
    pub patch: f64,
    /// From few points to many.
    pub rows: Vec<Row>,
}

/// One placement: how many collide, the errors of force and torque by weighing, that of the depth.
struct Felt {
    colliding: usize,
    errors: [[f64; 2]; 2],
    depth: f64,
}

/// Measures a contact.
///
/// # Panics
/// If a size asks for no points.
pub fn table(contact: Contact, sizes: &[Often], seed: u64) -> Table {
    let mesh = contact.mesh();
    let patch = mesh.survey().area / contact.area();
    let rows = sizes.iter().map(|often| row(contact, &mesh, patch, *often, seed)).collect();
    Table { contact, patch, rows }
}

fn row(contact: Contact, mesh: &Mesh, patch: f64, often: Often, seed: u64) -> Row {
    let points = (often.contacts * patch).round() as usize;
    let felt = Pattern::ALL.map(|pattern| {
        let one = |k: usize| {
            // Other clouds for every size: the first points of a longer one are those of a shorter.
            let seed = seed.wrapping_mul(1 << 40) + ((points as u64) << 12) + k as u64;
            let cells = pattern.cloud(mesh, points, seed);
            feel(contact, mesh, cells, often.placements, seed)
        };
        (0..often.clouds).into_par_iter().flat_map_iter(one).collect::<Vec<Felt>>()
    });
    let all = felt.iter().flatten().count();
    let error = |what: usize| {
        [0, 1].map(|pattern: usize| {
            [0, 1].map(|weighing| rms(felt[pattern].iter().map(|felt| felt.errors[weighing][what])))
        })
    };
    Row {
        often,
        points,
        colliding: felt.iter().flatten().map(|felt| felt.colliding as f64).sum::<f64>()
            / all as f64,
        force: error(0),
        torque: error(1),
        depth: [0, 1].map(|pattern: usize| rms(felt[pattern].iter().map(|felt| felt.depth))),
    }
}

fn feel(contact: Contact, mesh: &Mesh, cells: Cloud, count: usize, seed: u64) -> Vec<Felt> {
    let clouds = [equal(&cells, mesh), cells];
    let parts = clouds.map(|cloud| Part::from_cloud(&contact.exact(cloud)));
    let tool = contact.tool();
    let mut probes = [0, 1].map(|weighing: usize| Probe::new(&parts[weighing], tool));
    let mut draw = Draw::new(!seed);
    let one = |_| {
        let placed = contact.place(&mut draw);
        let wrenches = probes.each_mut().map(|probe| probe.wrench(&placed.pose));
        let errors = wrenches.each_ref().map(|wrench| {
            [
                (wrench.force - placed.force).norm() / placed.force.norm(),
                (wrench.torque - placed.torque).norm() / placed.torque.norm(),
            ]
        });
        let [wrench, _] = &wrenches;
        Felt { colliding: wrench.colliding, errors, depth: (DEPTH - wrench.depth()).abs() / DEPTH }
    };
    (0..count).map(one).collect()
}

impl Table {
    /// Order and logarithm at one point of an error of the force.
    pub fn force(&self, pattern: Pattern, weighing: Weighing) -> [f64; 2] {
        self.order(|row| row.force[pattern as usize][weighing as usize])
    }

    /// Those of the torque.
    pub fn torque(&self, pattern: Pattern, weighing: Weighing) -> [f64; 2] {
        self.order(|row| row.torque[pattern as usize][weighing as usize])
    }

    /// Those of the deepest depth.
    pub fn depth(&self, pattern: Pattern) -> [f64; 2] {
        self.order(|row| row.depth[pattern as usize])
    }

    /// In the number of points.
    pub fn order(&self, of: impl Fn(&Row) -> f64) -> [f64; 2] {
        let points: Vec<_> = self.rows.iter().map(|row| [row.points as f64, of(row)]).collect();
        order(&points)
    }

    /// The row that is nearest to so many contacts.
    pub fn at(&self, contacts: f64) -> Option<&Row> {
        let far = |row: &&Row| (row.often.contacts / contacts).ln().abs();
        self.rows.iter().min_by(|a, b| far(a).total_cmp(&far(b)))
    }
}
