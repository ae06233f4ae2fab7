//! One line or arc of a profile.

use super::{sample_curve, sample_line, unit_or_z};

/// A point or vector of the half plane.
pub(super) type P2 = [f64; 2];

pub(super) fn sub(a: P2, b: P2) -> P2 {
    [a[0] - b[0], a[1] - b[1]]
}
pub(super) fn dot(a: P2, b: P2) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}
pub(super) fn cross(a: P2, b: P2) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}
pub(super) fn len(a: P2) -> f64 {
    a[0].hypot(a[1])
}

/// A line, or an arc of less than 180°, with the material on its left.
#[derive(Clone, Copy, Debug)]
pub(super) struct Piece {
    pub(super) a: P2,
    pub(super) b: P2,
    /// Index of its owner in the order of listing.
    pub(super) rank: usize,
    shape: Shape,
}

#[derive(Clone, Copy, Debug)]
enum Shape {
    Line {
        along: P2,
        length: f64,
    },
    /// `sense` is 1 counter-clockwise (bulging out of the material), -1 clockwise.
    Arc {
        centre: P2,
        radius: f64,
        sense: f64,
    },
}

impl Piece {
    pub(super) fn new(a: P2, b: P2, centre: Option<P2>, rank: usize) -> Self {
        let shape = match centre {
            None => Shape::Line { along: unit_or_z(sub(b, a)), length: len(sub(b, a)) },
            Some(centre) => {
                let (a, b) = (sub(a, centre), sub(b, centre));
                Shape::Arc { centre, radius: len(a), sense: cross(a, b).signum() }
            }
        };
        Self { a, b, rank, shape }
    }

    pub(super) fn centre(&self) -> Option<P2> {
        match self.shape {
            Shape::Line { .. } => None,
            Shape::Arc { centre, .. } => Some(centre),
        }
    }

    /// Returns the unit tangent at a point of the piece, along the profile.
    pub(super) fn tangent(&self, at: P2) -> P2 {
        match self.shape {
            Shape::Line { along, .. } => along,
            Shape::Arc { centre, sense, .. } => {
                let arm = unit_or_z(sub(at, centre));
                [-sense * arm[1], sense * arm[0]]
            }
        }
    }

    /// Returns the unit vector from a point inside that the piece owns to its surface.
    pub(super) fn outward(&self, p: P2) -> P2 {
        match self.shape {
            Shape::Line { along, .. } => [along[1], -along[0]],
            Shape::Arc { centre, sense, .. } if sense > 0.0 => unit_or_z(sub(p, centre)),
            Shape::Arc { centre, .. } => unit_or_z(sub(centre, p)),
        }
    }

    /// Returns whether the foot of `p` on the whole line or circle lies on this piece.
    pub(super) fn faces(&self, p: P2) -> bool {
        match self.shape {
            Shape::Line { along, length } => (0.0..=length).contains(&dot(sub(p, self.a), along)),
            Shape::Arc { centre, sense, .. } => {
                let (a, b, q) = (sub(self.a, centre), sub(self.b, centre), sub(p, centre));
                sense * cross(a, q) >= 0.0 && sense * cross(q, b) >= 0.0
            }
        }
    }

    /// Returns the distance to the whole line or circle.
    pub(super) fn distance(&self, p: P2) -> f64 {
        match self.shape {
            Shape::Line { along, .. } => cross(along, sub(p, self.a)).abs(),
            Shape::Arc { centre, radius, .. } => (radius - len(sub(p, centre))).abs(),
        }
    }

    /// Returns the distance to the piece, its ends included.
    pub(super) fn clamped(&self, p: P2) -> f64 {
        if self.faces(p) { self.distance(p) } else { len(sub(p, self.a)).min(len(sub(p, self.b))) }
    }

    /// Returns the nearest point of the whole line or circle.
    pub(super) fn foot(&self, p: P2) -> P2 {
        match self.shape {
            Shape::Line { along, .. } => {
                let t = dot(sub(p, self.a), along);
                [self.a[0] + t * along[0], self.a[1] + t * along[1]]
            }
            Shape::Arc { centre, radius, .. } => {
                let arm = unit_or_z(sub(p, centre));
                [centre[0] + radius * arm[0], centre[1] + radius * arm[1]]
            }
        }
    }

    /// Counts the intersections of the piece with the ray from `p` toward larger `d`. A vertex level with `p`
    /// counts for the upper piece only.
    pub(super) fn crossings(&self, p: P2) -> usize {
        let spans = |a: P2, b: P2| (a[1] <= p[1]) != (b[1] <= p[1]);
        let Shape::Arc { centre, radius, .. } = self.shape else {
            let (a, b) = (self.a, self.b);
            let d = || a[0] + (p[1] - a[1]) / (b[1] - a[1]) * (b[0] - a[0]);
            return usize::from(spans(a, b) && d() >= p[0]);
        };
        // Cut the arc where it turns in z; each part then lies on one side of its centre.
        let turns = [-radius, radius].map(|r| [centre[0], centre[1] + r]);
        let inner = turns.into_iter().filter(|t| *t != self.a && *t != self.b && self.faces(*t));
        let cuts: Vec<P2> = [self.a].into_iter().chain(inner).chain([self.b]).collect();
        let meets = |w: &&[P2]| {
            let side = (w[0][0] + w[1][0] - 2.0 * centre[0]).signum();
            let up = p[1] - centre[1];
            let d = || centre[0] + side * ((radius - up) * (radius + up)).max(0.0).sqrt();
            spans(w[0], w[1]) && d() >= p[0]
        };
        cuts.windows(2).filter(meets).count()
    }

    /// Returns points along the piece, its ends included.
    pub(super) fn samples(&self) -> Vec<P2> {
        let Shape::Arc { centre, .. } = self.shape else {
            return sample_line(self.a, self.b);
        };
        let mut points = sample_curve(|t| self.turned(centre, t));
        if let Some(last) = points.last_mut() {
            *last = self.b;
        }
        points
    }

    /// Returns the point of an arc at the fraction `t` of its sweep.
    fn turned(&self, centre: P2, t: f64) -> P2 {
        let (a, b) = (sub(self.a, centre), sub(self.b, centre));
        let (sin, cos) = (t * cross(a, b).atan2(dot(a, b))).sin_cos();
        [centre[0] + a[0] * cos - a[1] * sin, centre[1] + a[0] * sin + a[1] * cos]
    }

    /// Returns the piece as a polyline, exact but for the sagitta of `n` chords.
    #[cfg(test)]
    pub(super) fn chords(&self, n: u32) -> Vec<(P2, P2)> {
        let Shape::Arc { centre, .. } = self.shape else {
            return vec![(self.a, self.b)];
        };
        let at = |i: u32| self.turned(centre, f64::from(i) / f64::from(n));
        (0..n).map(|i| (at(i), at(i + 1))).collect()
    }
}
