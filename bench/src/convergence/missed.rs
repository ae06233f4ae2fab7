//! How often a shallow contact of a ball with a plane is not noticed.

use super::Pattern;
use nalgebra::{Point3, Vector3};
use rayon::prelude::*;
use std::f64::consts::PI;
use touchoff::mesh::shapes;
use touchoff::{Part, Pose, Probe, Unit};
use touchoff_tests::oracle::draw::Draw;

/// Points to the square of the unit.
pub const DENSITY: f64 = 13.0;
/// How deep the ball of radius 1 is.
pub const DEPTHS: [f64; 8] = [0.001, 0.002, 0.005, 0.01, 0.02, 0.03, 0.05, 0.1];
/// Half of the plane.
const HALF: f64 = 20.0;

/// What was counted at a depth.
#[derive(Clone, Copy, Debug)]
pub struct Row {
    /// How deep.
    pub depth: f64,
    /// Placements of each pattern.
    pub placements: usize,
    /// The share that was missed, by pattern.
    pub missed: [f64; 2],
    /// The standard error of that, from cloud to cloud.
    pub spread: [f64; 2],
}

impl Row {
    /// What is missed of a random cloud: `exp(-density π a²)`, a the radius of the disc in contact.
    pub fn random(&self) -> f64 {
        (-self.disc()).exp()
    }

    /// What is missed at least of any cloud: no more discs have a point than there are points in discs.
    pub fn least(&self) -> f64 {
        (1.0 - self.disc()).max(0.0)
    }

    /// Points in the disc, on average.
    pub fn disc(&self) -> f64 {
        DENSITY * PI * self.depth * (2.0 - self.depth)
    }
}

/// So many placements on each of so many clouds of each pattern.
///
/// # Panics
/// If the ball is not in the library any more.
pub fn rows(clouds: usize, placements: usize, seed: u64) -> Vec<Row> {
    let mesh = shapes::plane(HALF, 1, Unit::Millimetre).expect("a plane");
    let ball = tools_library::find("UnitSphere").expect("a tool of the library");
    let points = (DENSITY * mesh.survey().area).round() as usize;
    let counts = Pattern::ALL.map(|pattern| {
        let one = |k: usize| {
            let seed = seed.wrapping_mul(1 << 20) + k as u64;
            let part = Part::from_cloud(&pattern.cloud(&mesh, points, seed));
            let (mut probe, mut draw) = (Probe::new(&part, ball), Draw::new(!seed));
            let mut missed = [0; DEPTHS.len()];
            for _ in 0..placements {
                // Discs do not reach the border.
                let [x, y] = [0; 2].map(|_| draw.between(1.0 - HALF, HALF - 1.0));
                for (depth, missed) in DEPTHS.into_iter().zip(&mut missed) {
                    let tip = Point3::new(x, y, -depth);
                    let pose = Pose::from_axis(tip, Vector3::z()).expect("a finite pose");
                    *missed += usize::from(!probe.detect(&pose));
                }
            }
            missed
        };
        (0..clouds).into_par_iter().map(one).collect::<Vec<_>>()
    });
    let row = |(at, depth)| {
        let shares = counts.each_ref().map(|clouds| {
            let share = |cloud: &[usize; DEPTHS.len()]| cloud[at] as f64 / placements as f64;
            mean_and_error(&clouds.iter().map(share).collect::<Vec<_>>())
        });
        Row {
            depth,
            placements: clouds * placements,
            missed: shares.map(|[mean, _]| mean),
            spread: shares.map(|[_, error]| error),
        }
    };
    DEPTHS.into_iter().enumerate().map(row).collect()
}

/// Of draws from the same: placements on one cloud are not independent of each other, clouds are.
fn mean_and_error(draws: &[f64]) -> [f64; 2] {
    let count = draws.len() as f64;
    let mean = draws.iter().sum::<f64>() / count;
    let squares: f64 = draws.iter().map(|draw| (draw - mean).powi(2)).sum();
    [mean, (squares / (count - 1.0).max(1.0) / count).sqrt()]
}
