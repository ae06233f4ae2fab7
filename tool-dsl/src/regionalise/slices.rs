//! The nearest-feature partition of one side of an outline, feature by feature.
//!
//! A point belongs to the feature whose ball, grown along the normal from the point's foot, reaches the point before it
//! touches anything else. A feature's cell is therefore the set of points between the feature and the lower envelope of
//! the radii at which other features stop the ball. Each of these radii has a closed form. The envelope is followed
//! along the feature. A change of the stopping feature is a vertex of the partition, and between two vertices lies a
//! slice of the cell.

use super::section::{Obstacle, Section};
use crate::geometry::outline::{Point, minus, norm};

/// A slice of a cell: the normals between two parameters, and the obstacle that ends them.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slice {
    pub(super) feature: usize,
    pub(super) from: f64,
    pub(super) to: f64,
    pub(super) stop: Obstacle,
}

/// Number of uniform intervals at whose ends every feature is sampled.
const EVEN: u32 = 16;
/// Sample parameters near the ends of a feature.
const ENDS: [f64; 4] = [1e-12, 1e-6, 1e-3, 0.02];
/// Bisections until a vertex is known to the last bit.
const HALVINGS: u32 = 60;
/// Slices narrower than this, as a fraction of the feature, are rounding errors.
const SLIVER: f64 = 1e-11;
/// Maximum number of rounds in which vertices found on one feature are sampled on the others.
const ROUNDS: usize = 4;

/// Returns all slices, feature by feature, in the order of the parameter.
pub(super) fn slices(section: &Section<'_>) -> Vec<Vec<Slice>> {
    let count = section.features.len();
    let mut samples: Vec<Vec<f64>> = (0..count)
        .map(|_| {
            let even = (1..EVEN).map(|k| f64::from(k) / f64::from(EVEN));
            ENDS.into_iter().chain(even).chain(ENDS.map(|t| 1.0 - t)).collect()
        })
        .collect();
    // The projections of corners onto a feature help to find small neighbours.
    for (feature, own) in samples.iter_mut().enumerate() {
        for segment in section.outline {
            let [from, to] = segment.ends();
            let middle = [0, 1].map(|k| from[k] / 2.0 + to[k] / 2.0);
            own.extend([from, middle].map(|p| section.parameter(feature, p)));
        }
    }
    let mut found = envelope(section, &mut samples);
    for _ in 0..ROUNDS {
        let before: usize = found.iter().map(Vec::len).sum();
        for slice in found.iter().flatten() {
            let Obstacle::Feature(other) = slice.stop else { continue };
            for t in [slice.from, slice.to, slice.from / 2.0 + slice.to / 2.0] {
                let seat = section.seat(slice.feature, t);
                let at = section.parameter(other, seat.at(section.growth(slice.feature, &seat).0));
                samples[other].extend([at - 1e-7, at, at + 1e-7]);
            }
        }
        found = envelope(section, &mut samples);
        if found.iter().map(Vec::len).sum::<usize>() == before {
            break;
        }
    }
    found
}

fn envelope(section: &Section<'_>, samples: &mut [Vec<f64>]) -> Vec<Vec<Slice>> {
    let last = 1.0 - ENDS[0];
    samples
        .iter_mut()
        .enumerate()
        .map(|(feature, own)| {
            own.retain(|t| (ENDS[0]..=last).contains(t));
            own.sort_by(f64::total_cmp);
            own.dedup();
            let mut walk = Walk { section, feature, slices: Vec::new() };
            let mut before = (own[0], walk.stop(own[0]));
            walk.put(0.0, own[0], before.1);
            for &t in &own[1..] {
                let here = (t, walk.stop(t));
                walk.divide(before, here, HALVINGS);
                before = here;
            }
            walk.put(before.0, 1.0, before.1);
            merged(walk.slices)
        })
        .collect()
}

/// Merges slivers that rounding produces where the obstacle changes.
fn merged(slices: Vec<Slice>) -> Vec<Slice> {
    let wide = slices.iter().any(|slice| slice.to - slice.from >= SLIVER);
    let mut merged: Vec<Slice> = Vec::new();
    for slice in slices {
        match merged.last_mut() {
            Some(last) if last.stop == slice.stop || (wide && slice.to - slice.from < SLIVER) => {
                last.to = slice.to;
            }
            Some(last) if wide && last.to - last.from < SLIVER => {
                *last = Slice { from: last.from, ..slice };
            }
            _ => merged.push(slice),
        }
    }
    merged
}

struct Walk<'a> {
    section: &'a Section<'a>,
    feature: usize,
    slices: Vec<Slice>,
}

impl Walk<'_> {
    fn stop(&self, t: f64) -> Obstacle {
        self.section.growth(self.feature, &self.section.seat(self.feature, t)).1
    }

    fn put(&mut self, from: f64, to: f64, stop: Obstacle) {
        match self.slices.last_mut() {
            Some(last) if last.stop == stop => last.to = to,
            _ => self.slices.push(Slice { feature: self.feature, from, to, stop }),
        }
    }

    /// Returns the parameter at which one obstacle takes over from another, if no third one lies between them.
    fn taken_over(&self, a: f64, b: f64, [first, last]: [Obstacle; 2]) -> Option<f64> {
        let (mut low, mut high) = (a, b);
        for _ in 0..HALVINGS {
            let middle = low / 2.0 + high / 2.0;
            if middle <= low || middle >= high {
                break;
            }
            let seat = self.section.seat(self.feature, middle);
            let [own, other] = [first, last].map(|s| self.section.grown(self.feature, &seat, s));
            if own < other {
                low = middle;
            } else {
                high = middle;
            }
        }
        (self.stop(low) == first && self.stop(high) == last).then_some(high)
    }

    /// Appends the slices between two parameters whose obstacles are known.
    fn divide(&mut self, (a, first): (f64, Obstacle), (b, last): (f64, Obstacle), halvings: u32) {
        if first == last {
            return self.put(a, b, first);
        }
        if let Some(at) = self.taken_over(a, b, [first, last]) {
            self.put(a, at, first);
            return self.put(at, b, last);
        }
        let (mut low, mut high) = (a, b);
        for step in 0..halvings {
            let middle = low / 2.0 + high / 2.0;
            if middle <= low || middle >= high {
                break;
            }
            let stop = self.stop(middle);
            if stop == first {
                low = middle;
            } else if stop == last {
                high = middle;
            } else {
                let left = halvings - step - 1;
                self.divide((low, first), (middle, stop), left);
                return self.divide((middle, stop), (high, last), left);
            }
        }
        self.put(a, high, first);
        self.put(high, b, last);
    }
}

impl Slice {
    /// Returns points along the far end of the slice, from the first parameter to the last.
    pub(super) fn rim(&self, section: &Section<'_>, steps: u32) -> Vec<Point> {
        (0..=steps).map(|k| self.rim_at(section, f64::from(k) / f64::from(steps))).collect()
    }

    /// Returns points along the slice's normals.
    pub(super) fn rays(&self, section: &Section<'_>, steps: u32) -> Vec<Point> {
        let ray = |k: u32| {
            let part = f64::from(k) / f64::from(steps);
            let seat = section.seat(self.feature, self.from + part * (self.to - self.from));
            let radius = self.radius(section, part);
            [0.02, 0.1, 0.3, 0.5, 0.7, 0.9, 1.0].map(|share| seat.at(share * radius))
        };
        (0..=steps).flat_map(ray).collect()
    }

    /// Returns points along the slice's normals, most densely near its ends.
    pub(super) fn probes(&self, section: &Section<'_>) -> Vec<Point> {
        const EVEN: u32 = 12;
        let near = (2..10).map(|k| 0.25f64.powi(k));
        let parts = (1..EVEN).map(|k| f64::from(k) / f64::from(EVEN));
        let parts = parts.chain(near.clone()).chain(near.map(|part| 1.0 - part));
        let along = |part: f64| {
            let seat = section.seat(self.feature, self.from + part * (self.to - self.from));
            let radius = self.radius(section, part);
            [0.1, 0.5, 0.9, 0.99, 1.0].map(|share| seat.at(share * radius))
        };
        parts.flat_map(along).filter(|p| p[0] >= 0.0).collect()
    }

    /// Returns the point of the far end at a fraction of the slice's width.
    pub(super) fn rim_at(&self, section: &Section<'_>, part: f64) -> Point {
        let seat = section.seat(self.feature, self.from + part * (self.to - self.from));
        seat.at(self.radius(section, part))
    }

    /// Returns the length of the normal at a fraction of the slice's width, by the slice's own obstacle even if another
    /// one is as near.
    pub(super) fn radius(&self, section: &Section<'_>, part: f64) -> f64 {
        // At the very ends of a feature the growth of the ball is a limit.
        let t = (self.from + part * (self.to - self.from)).clamp(ENDS[0], 1.0 - ENDS[0]);
        let seat = section.seat(self.feature, t);
        let own = match self.stop {
            Obstacle::Feature(_) => section.grown(self.feature, &seat, self.stop),
            _ => f64::INFINITY,
        };
        if own.is_finite() { own } else { section.growth(self.feature, &seat).0 }
    }

    /// Returns whether the slice has negligible width.
    pub(super) fn is_thin(&self, section: &Section<'_>) -> bool {
        let [a, b] = [0.0, 1.0].map(|part| {
            let seat = section.seat(self.feature, self.from + part * (self.to - self.from));
            [seat.foot, seat.at(self.radius(section, part))]
        });
        norm(minus(a[0], b[0])).max(norm(minus(a[1], b[1]))) < 1e-10 * section.size
    }
}
