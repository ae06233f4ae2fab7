//! The nearest-feature partition of one side of an outline, feature by feature.
//!
//! A point belongs to the feature whose ball, grown along the normal from the point's foot, reaches the point before it
//! touches anything else. A feature's cell is therefore the set of points between the feature and the lower envelope of
//! the radii at which other features stop the ball. Each of these radii has a closed form. The envelope is followed
//! along the feature. A change of the stopping feature is a vertex of the partition, and between two vertices lies a
//! slice of the cell.

use super::section::{FootPoint, Obstacle, Section};
use crate::geometry::outline::{Point, minus, norm};

/// A slice of a cell: the normals between two parameters, and the obstacle that ends them.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slice {
    pub(super) feature: usize,
    pub(super) from: f64,
    pub(super) to: f64,
    pub(super) obstacle: Obstacle,
}

/// Number of uniform intervals at whose ends every feature is sampled.
const EVEN_STEPS: u32 = 16;
/// Sample parameters near the ends of a feature.
const END_FRACTIONS: [f64; 4] = [1e-12, 1e-6, 1e-3, 0.02];
/// Bisections until a vertex is known to the last bit.
const MAX_HALVINGS: u32 = 60;
/// Slices narrower than this, as a fraction of the feature, are rounding errors.
const SLIVER_FRACTION: f64 = 1e-11;
/// Maximum number of rounds in which vertices found on one feature are sampled on the others.
const MAX_ROUNDS: usize = 4;

/// Returns all slices, feature by feature, in the order of the parameter.
pub(super) fn slices(section: &Section<'_>) -> Vec<Vec<Slice>> {
    let count = section.features.len();
    let mut samples: Vec<Vec<f64>> = (0..count)
        .map(|_| {
            let even = (1..EVEN_STEPS).map(|k| f64::from(k) / f64::from(EVEN_STEPS));
            END_FRACTIONS.into_iter().chain(even).chain(END_FRACTIONS.map(|t| 1.0 - t)).collect()
        })
        .collect();
    // The projections of corners onto a feature help to find small neighbours.
    for (feature, parameters) in samples.iter_mut().enumerate() {
        for segment in section.outline {
            let [from, to] = segment.ends();
            let middle = [0, 1].map(|k| from[k] / 2.0 + to[k] / 2.0);
            parameters.extend([from, middle].map(|p| section.parameter(feature, p)));
        }
    }
    let mut slices = envelope(section, &mut samples);
    for _ in 0..MAX_ROUNDS {
        let count_before: usize = slices.iter().map(Vec::len).sum();
        for slice in slices.iter().flatten() {
            let Obstacle::Feature(other) = slice.obstacle else { continue };
            for t in [slice.from, slice.to, slice.from / 2.0 + slice.to / 2.0] {
                let foot_point = section.foot_point(slice.feature, t);
                let stop = section.grow_ball(slice.feature, &foot_point);
                let parameter = section.parameter(other, foot_point.at(stop.radius));
                // The vertex seen from the other side, with its neighbourhood.
                samples[other].extend([parameter - 1e-7, parameter, parameter + 1e-7]);
            }
        }
        slices = envelope(section, &mut samples);
        // No new vertex: the samples found all.
        if slices.iter().map(Vec::len).sum::<usize>() == count_before {
            break;
        }
    }
    slices
}

/// Returns the slices of each feature: the lower envelope of the radii at which obstacles stop the ball, followed
/// from sample to sample. Sorts the samples.
fn envelope(section: &Section<'_>, samples: &mut [Vec<f64>]) -> Vec<Vec<Slice>> {
    let last = 1.0 - END_FRACTIONS[0];
    samples
        .iter_mut()
        .enumerate()
        .map(|(feature, parameters)| {
            parameters.retain(|t| (END_FRACTIONS[0]..=last).contains(t));
            parameters.sort_by(f64::total_cmp);
            parameters.dedup();
            let mut walk = EnvelopeWalk { section, feature, slices: Vec::new() };
            let mut previous = walk.sampled(parameters[0]);
            // The ball at the very end of a feature is a limit, so the first sample stands for it.
            walk.append(0.0, previous.t, previous.obstacle);
            for &t in &parameters[1..] {
                let current = walk.sampled(t);
                walk.divide(previous, current, MAX_HALVINGS);
                previous = current;
            }
            walk.append(previous.t, 1.0, previous.obstacle);
            merged(walk.slices)
        })
        .collect()
}

/// Merges slivers that rounding produces where the obstacle changes.
fn merged(slices: Vec<Slice>) -> Vec<Slice> {
    let any_wide = slices.iter().any(|slice| slice.to - slice.from >= SLIVER_FRACTION);
    let mut merged: Vec<Slice> = Vec::new();
    for slice in slices {
        match merged.last_mut() {
            Some(last)
                if last.obstacle == slice.obstacle
                    || (any_wide && slice.to - slice.from < SLIVER_FRACTION) =>
            {
                last.to = slice.to;
            }
            Some(last) if any_wide && last.to - last.from < SLIVER_FRACTION => {
                *last = Slice { from: last.from, ..slice };
            }
            _ => merged.push(slice),
        }
    }
    merged
}

/// The traversal of a feature's envelope, from its first parameter to its last.
struct EnvelopeWalk<'a> {
    section: &'a Section<'a>,
    feature: usize,
    /// The slices up to the current parameter.
    slices: Vec<Slice>,
}

/// A parameter and the obstacle that stops the ball there.
#[derive(Clone, Copy)]
struct Sampled {
    t: f64,
    obstacle: Obstacle,
}

impl EnvelopeWalk<'_> {
    fn sampled(&self, t: f64) -> Sampled {
        let foot_point = self.section.foot_point(self.feature, t);
        Sampled { t, obstacle: self.section.grow_ball(self.feature, &foot_point).obstacle }
    }

    /// Appends a slice, or extends the last one if it has the same obstacle.
    fn append(&mut self, from: f64, to: f64, obstacle: Obstacle) {
        match self.slices.last_mut() {
            Some(last) if last.obstacle == obstacle => last.to = to,
            _ => self.slices.push(Slice { feature: self.feature, from, to, obstacle }),
        }
    }

    /// Returns the parameter at which one obstacle takes over from another, if no third one lies between them.
    fn takeover(&self, first: Sampled, last: Sampled) -> Option<f64> {
        let (mut low, mut high) = (first.t, last.t);
        for _ in 0..MAX_HALVINGS {
            let middle = low / 2.0 + high / 2.0;
            if middle <= low || middle >= high {
                break;
            }
            let foot_point = self.section.foot_point(self.feature, middle);
            let to_first = self.section.growth_to(self.feature, &foot_point, first.obstacle);
            let to_last = self.section.growth_to(self.feature, &foot_point, last.obstacle);
            // The nearer of the two is the one that stops the ball.
            if to_first < to_last {
                low = middle;
            } else {
                high = middle;
            }
        }
        let is_direct = self.sampled(low).obstacle == first.obstacle
            && self.sampled(high).obstacle == last.obstacle;
        is_direct.then_some(high)
    }

    /// Appends the slices between two samples.
    fn divide(&mut self, first: Sampled, last: Sampled, halvings: u32) {
        if first.obstacle == last.obstacle {
            return self.append(first.t, last.t, first.obstacle);
        }
        if let Some(t) = self.takeover(first, last) {
            self.append(first.t, t, first.obstacle);
            return self.append(t, last.t, last.obstacle);
        }
        // Neither takes over from the other directly, so a third obstacle lies between.
        let (mut low, mut high) = (first.t, last.t);
        for halvings_left in (0..halvings).rev() {
            let middle = low / 2.0 + high / 2.0;
            if middle <= low || middle >= high {
                break;
            }
            let found = self.sampled(middle);
            if found.obstacle == first.obstacle {
                low = middle;
            } else if found.obstacle == last.obstacle {
                high = middle;
            } else {
                self.divide(Sampled { t: low, ..first }, found, halvings_left);
                return self.divide(found, Sampled { t: high, ..last }, halvings_left);
            }
        }
        // No third one was found within the halvings: its slice is narrower than rounding.
        self.append(first.t, high, first.obstacle);
        self.append(high, last.t, last.obstacle);
    }
}

impl Slice {
    /// Returns points along the slice's normals.
    pub(super) fn points_on_normals(&self, section: &Section<'_>, steps: u32) -> Vec<Point> {
        let fractions = (0..=steps).map(|k| f64::from(k) / f64::from(steps));
        let depths = [0.02, 0.1, 0.3, 0.5, 0.7, 0.9, 1.0];
        fractions.flat_map(|fraction| self.points_along(section, fraction, depths)).collect()
    }

    /// Returns the points of a normal at fractions of its length.
    fn points_along<const N: usize>(
        &self,
        section: &Section<'_>,
        fraction: f64,
        radius_fractions: [f64; N],
    ) -> [Point; N] {
        let foot_point = self.foot_at(section, fraction);
        let radius = self.radius(section, fraction);
        radius_fractions.map(|radius_fraction| foot_point.at(radius_fraction * radius))
    }

    fn parameter_at(&self, fraction: f64) -> f64 {
        self.from + fraction * (self.to - self.from)
    }

    /// Returns the foot of the normal at a fraction of the slice's width.
    pub(super) fn foot_at(&self, section: &Section<'_>, fraction: f64) -> FootPoint {
        section.foot_point(self.feature, self.parameter_at(fraction))
    }

    /// Returns the length of the normal at a fraction of the slice's width, by the slice's own obstacle even if another
    /// one is as near.
    pub(super) fn radius(&self, section: &Section<'_>, fraction: f64) -> f64 {
        // At the very ends of a feature the growth of the ball is a limit.
        let t = self.parameter_at(fraction).clamp(END_FRACTIONS[0], 1.0 - END_FRACTIONS[0]);
        let foot_point = section.foot_point(self.feature, t);
        let own_radius = match self.obstacle {
            Obstacle::Feature(_) => section.growth_to(self.feature, &foot_point, self.obstacle),
            _ => f64::INFINITY,
        };
        if own_radius.is_finite() {
            own_radius
        } else {
            section.grow_ball(self.feature, &foot_point).radius
        }
    }

    /// Returns whether the slice has negligible width, however different its normals' lengths.
    pub(super) fn is_thin(&self, section: &Section<'_>) -> bool {
        let ends = [0.0, 1.0].map(|fraction| self.foot_at(section, fraction));
        let radius = self.radius(section, 0.0).max(self.radius(section, 1.0));
        let width = |radius: f64| norm(minus(ends[0].at(radius), ends[1].at(radius)));
        width(0.0).max(width(radius)) < 1e-10 * section.size
    }
}
