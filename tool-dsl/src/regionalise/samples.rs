//! Points of the section at which regions are found, each with its owner.

use super::Section;
use super::outline::{self, Point, Segment, minus, norm};

/// Points close to every piece, and far away, where a bound that is missing shows itself.
pub(super) fn scattered(outline: &[Segment]) -> Vec<Point> {
    let [low, high] = outline::reach(outline);
    let size = norm(minus(high, low));
    let mut samples = Vec::new();
    for power in 0..40 {
        let reach = size * 2f64.powi(power);
        for k in 0..24 {
            let turned = (f64::from(k) + (f64::from(power) * 0.618_034).fract()) / 24.0;
            let angle = std::f64::consts::PI * (turned - 0.5);
            samples.push([reach * angle.cos(), low[1] + reach * angle.sin()]);
        }
    }
    // Along each piece and away from it, to where strips that a bound is missing of would run.
    let reaches: Vec<f64> = (0..28).map(|k| size * 0.02 * 1.6f64.powi(k)).collect();
    let offsets = [0.0007, 0.006, 0.03, 0.11, 0.3].map(|part| part * size);
    for segment in outline {
        let points = outline::along(segment);
        for (at_end, end) in segment.ends().into_iter().enumerate() {
            let along = segment.tangent(at_end == 1);
            let way = if at_end == 1 { along } else { [-along[0], -along[1]] };
            let left = [-along[1], along[0]];
            for reach in &reaches {
                for offset in offsets {
                    for side in [-offset, offset] {
                        samples.push([0, 1].map(|k| end[k] + reach * way[k] + side * left[k]));
                    }
                }
            }
        }
        for part in [0.03, 0.21, 0.5, 0.77, 0.97] {
            let index = (part * (points.len() - 1) as f64) as usize;
            let (from, to) = (points[index], points[index + 1]);
            let t = part * (points.len() - 1) as f64 - index as f64;
            let foot = [0, 1].map(|k| from[k] + t * (to[k] - from[k]));
            let way = minus(to, from);
            let length = norm(way);
            let left = [-way[1] / length, way[0] / length];
            for reach in &reaches {
                for side in [-reach, *reach] {
                    samples.push([0, 1].map(|k| foot[k] + side * left[k]));
                }
            }
        }
    }
    samples.retain(|p| p[0] >= 0.0);
    let around = outline.iter().flat_map(|segment| {
        let points = outline::along(segment);
        let steps = if points.len() > 2 { 1 } else { 16 };
        let pairs: Vec<[Point; 2]> = points.windows(2).map(|pair| [pair[0], pair[1]]).collect();
        pairs.into_iter().flat_map(move |[from, to]| {
            let way = minus(to, from);
            (0..=steps).map(move |k| {
                let t = f64::from(k) / f64::from(steps);
                [from[0] + t * way[0], from[1] + t * way[1]]
            })
        })
    });
    for (k, p) in around.enumerate() {
        for (step, power) in [-1.3, -2.2, -3.3].into_iter().enumerate() {
            let reach = size * 10f64.powf(power);
            for turn in 0..5 {
                let angle = (k * 7 + step * 3) as f64 * 0.618 + f64::from(turn) * 1.256_637;
                let q = [p[0] + reach * angle.cos(), p[1] + reach * angle.sin()];
                if q[0] >= 0.0 {
                    samples.push(q);
                }
            }
        }
    }
    samples
}

/// Cells along each side of the first grid.
const GRID: i32 = 24;
/// How often a cell is cut where two owners meet, and where three do.
const CUTS: [u32; 2] = [4, 10];

impl Section<'_> {
    /// Adds samples of a grid that grows finer where owners meet.
    pub(super) fn refined(&self, samples: &mut Vec<(Point, Option<usize>)>) {
        let [low, high] = outline::reach(self.outline);
        let margin = 0.15 * norm(minus(high, low));
        let from = [0.0, low[1] - margin];
        let step = [
            (high[0] + margin) / f64::from(GRID),
            (high[1] - low[1] + 2.0 * margin) / f64::from(GRID),
        ];
        for i in 0..GRID {
            for j in 0..GRID {
                let corner = [from[0] + f64::from(i) * step[0], from[1] + f64::from(j) * step[1]];
                self.cell(corner, step, 0, samples);
            }
        }
    }

    fn cell(&self, from: Point, size: Point, cuts: u32, samples: &mut Vec<(Point, Option<usize>)>) {
        // A little off the middle, so that no sample lies on a curve by symmetry.
        const PLACES: [Point; 5] = [
            [0.0103, 0.0071],
            [0.9912, 0.0117],
            [0.0089, 0.9931],
            [0.9871, 0.9903],
            [0.5077, 0.4931],
        ];
        let mut owners: Vec<Option<usize>> = Vec::with_capacity(5);
        for [u, v] in PLACES {
            let p = [from[0] + u * size[0], from[1] + v * size[1]];
            let (owner, clear) = self.owner(p);
            samples.extend(clear.then_some((p, owner)));
            if !owners.contains(&owner) {
                owners.push(owner);
            }
        }
        let most = match owners.len() {
            1 => 0,
            2 => CUTS[0],
            _ => CUTS[1],
        };
        if cuts < most {
            let half = [size[0] / 2.0, size[1] / 2.0];
            for (u, v) in [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)] {
                let corner = [from[0] + u * half[0], from[1] + v * half[1]];
                self.cell(corner, half, cuts + 1, samples);
            }
        }
    }
}
