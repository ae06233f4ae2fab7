//! One line or arc of a profile.

use super::real::Real;
use super::sample_curve;
use super::vector::{Point, add, cross, dot, left, norm, opposite, right, sub, turned, unit};

/// A line, or an arc of at most 180°, with the material on its left.
#[derive(Clone, Copy, Debug)]
pub struct Segment<T> {
    /// Its start.
    pub from: Point<T>,
    /// Its end.
    pub to: Point<T>,
    /// The circle of an arc.
    pub circle: Option<Circle<T>>,
    /// Unit vector from start to end, and their distance.
    along: Point<T>,
    chord: T,
    /// The point inside an arc at which z turns.
    summit: Option<Point<T>>,
}

/// The circle of an arc.
#[derive(Clone, Copy, Debug)]
pub struct Circle<T> {
    /// Its centre.
    pub centre: Point<T>,
    /// Its radius.
    pub radius: T,
    /// Counter-clockwise: the arc bulges out of the material.
    pub convex: bool,
    /// True if a text gives the radius, and not the centre.
    pub by_radius: bool,
}

impl<T: Real> Segment<T> {
    fn new(from: Point<T>, to: Point<T>, circle: Option<Circle<T>>) -> Segment<T> {
        let chord = sub(&to, &from);
        let (along, chord) = (unit(&chord), norm(&chord));
        let mut segment = Segment { from, to, circle, along, chord, summit: None };
        segment.summit = segment.turn_in_z();
        segment
    }

    /// Returns a line.
    pub fn line(from: Point<T>, to: Point<T>) -> Segment<T> {
        Segment::new(from, to, None)
    }

    /// Returns the arc of less than 180° about a centre.
    pub fn arc(from: Point<T>, to: Point<T>, centre: Point<T>) -> Segment<T> {
        let convex = cross(&sub(&from, &centre), &sub(&to, &centre)) >= T::zero();
        Segment::about(from, to, centre, convex)
    }

    /// Returns the arc about a centre, counter-clockwise if it is convex.
    pub fn about(from: Point<T>, to: Point<T>, centre: Point<T>, convex: bool) -> Segment<T> {
        let radius = norm(&sub(&from, &centre));
        Segment::new(from, to, Some(Circle { centre, radius, convex, by_radius: false }))
    }

    /// Returns the arc of a radius; a radius just below half of the chord makes half a circle.
    pub fn by_radius(from: Point<T>, to: Point<T>, radius: T, convex: bool) -> Segment<T> {
        let (chord, half) = (sub(&to, &from), T::exactly(0.5));
        let across = norm(&chord).times(&half);
        let square = radius.minus(&across).times(&radius.plus(&across));
        let distance = square.most(T::zero()).root();
        let normal = if convex { left(&unit(&chord)) } else { right(&unit(&chord)) };
        let centre = add(&add(&from, &chord, &half), &normal, &distance);
        Segment::new(from, to, Some(Circle { centre, radius, convex, by_radius: true }))
    }

    /// Returns the segment between other ends of its line or circle.
    pub fn between(&self, from: Point<T>, to: Point<T>) -> Segment<T> {
        Segment::new(from, to, self.circle.clone())
    }

    /// Returns the segment with each point mapped, lengths by `length`.
    pub fn map<U: Real>(
        &self,
        point: impl Fn(&Point<T>) -> Point<U>,
        length: impl Fn(&T) -> U,
    ) -> Segment<U> {
        let circle = self.circle.as_ref().map(|circle| Circle {
            centre: point(&circle.centre),
            radius: length(&circle.radius),
            convex: circle.convex,
            by_radius: circle.by_radius,
        });
        Segment::new(point(&self.from), point(&self.to), circle)
    }

    /// Returns the centre of an arc.
    pub fn centre(&self) -> Option<&Point<T>> {
        self.circle.as_ref().map(|circle| &circle.centre)
    }

    /// Returns the unit vector of travel at a point of the segment.
    pub fn tangent(&self, at: &Point<T>) -> Point<T> {
        left(&self.outward(at))
    }

    /// Returns the unit vector out of the material at the foot of a point on the material's side.
    pub fn outward(&self, p: &Point<T>) -> Point<T> {
        match &self.circle {
            None => right(&self.along),
            Some(circle) if circle.convex => unit(&sub(p, &circle.centre)),
            Some(circle) => unit(&sub(&circle.centre, p)),
        }
    }

    /// Returns the distance to the whole line or circle, positive on the material's side.
    pub fn inward(&self, p: &Point<T>) -> T {
        match &self.circle {
            None => cross(&self.along, &sub(p, &self.from)),
            Some(Circle { centre, radius, convex, .. }) => {
                let distance = norm(&sub(p, centre));
                if *convex { radius.minus(&distance) } else { distance.minus(radius) }
            }
        }
    }

    /// Returns whether the foot of a point on the whole line or circle lies on the segment.
    pub fn faces(&self, p: &Point<T>) -> bool {
        let zero = T::zero();
        match &self.circle {
            None => {
                let t = dot(&sub(p, &self.from), &self.along);
                zero <= t && t <= self.chord
            }
            Some(Circle { centre, convex, .. }) => {
                let q = sub(p, centre);
                let first = cross(&sub(&self.from, centre), &q);
                let last = cross(&q, &sub(&self.to, centre));
                if *convex { first >= zero && last >= zero } else { first <= zero && last <= zero }
            }
        }
    }

    /// Returns the distance, and the index of the nearest end if that is the nearest point.
    pub fn nearest(&self, p: &Point<T>) -> (T, Option<usize>) {
        if self.faces(p) {
            return (self.inward(p).absolute(), None);
        }
        let [a, b] = [&self.from, &self.to].map(|end| norm(&sub(p, end)));
        if b < a { (b, Some(1)) } else { (a, Some(0)) }
    }

    /// Returns the distance to the segment, its ends included.
    pub fn distance(&self, p: &Point<T>) -> T {
        self.nearest(p).0
    }

    /// Returns the nearest point of the whole line or circle.
    pub fn foot(&self, p: &Point<T>) -> Point<T> {
        match &self.circle {
            None => add(&self.from, &self.along, &dot(&sub(p, &self.from), &self.along)),
            Some(circle) => add(&circle.centre, &unit(&sub(p, &circle.centre)), &circle.radius),
        }
    }

    /// Counts the intersections with the ray from a point toward larger `d`. A vertex level with the point counts for
    /// the upper segment only.
    pub fn crossings(&self, p: &Point<T>) -> usize {
        match &self.summit {
            None => usize::from(self.crosses(&self.from, &self.to, p)),
            Some(summit) => {
                usize::from(self.crosses(&self.from, summit, p))
                    + usize::from(self.crosses(summit, &self.to, p))
            }
        }
    }

    /// Returns whether the ray from a point crosses a part of the segment along which z does not turn.
    fn crosses(&self, a: &Point<T>, b: &Point<T>, p: &Point<T>) -> bool {
        let rises = a[1] <= p[1];
        if rises == (b[1] <= p[1]) {
            return false;
        }
        let d = match &self.circle {
            None => {
                let part = p[1].minus(&a[1]).over(&b[1].minus(&a[1]));
                a[0].plus(&part.times(&b[0].minus(&a[0])))
            }
            Some(Circle { centre, radius, convex, .. }) => {
                let up = p[1].minus(&centre[1]);
                let square = radius.minus(&up).times(&radius.plus(&up));
                let across = square.most(T::zero()).root();
                // Counter-clockwise, a circle rises on its right side.
                if rises == *convex { centre[0].plus(&across) } else { centre[0].minus(&across) }
            }
        };
        d >= p[0]
    }

    /// Returns the point inside the arc at which z turns. Half a circle from its lowest to its highest point has none.
    fn turn_in_z(&self) -> Option<Point<T>> {
        let Circle { centre, radius, .. } = self.circle.as_ref()?;
        let turns =
            [radius.clone(), radius.negated()].map(|up| [centre[0].clone(), centre[1].plus(&up)]);
        let inside =
            |turn: &Point<T>| self.faces(turn) && turn[1] != self.from[1] && turn[1] != self.to[1];
        let mut inside = turns.into_iter().filter(inside);
        inside.next().filter(|_| inside.next().is_none())
    }
}

impl Segment<f64> {
    /// Returns the angle of an arc in rad, positive counter-clockwise; 0 for a line.
    pub fn sweep(&self) -> f64 {
        let Some(circle) = &self.circle else { return 0.0 };
        let (a, b) = (sub(&self.from, &circle.centre), sub(&self.to, &circle.centre));
        let angle = cross(&a, &b).atan2(dot(&a, &b)).abs();
        if circle.convex { angle } else { -angle }
    }

    /// Returns the length along the segment.
    pub fn length(&self) -> f64 {
        self.circle.as_ref().map_or(self.chord, |circle| circle.radius * self.sweep().abs())
    }

    /// Returns a point of the segment, from 0 at the start to 1 at the end, both exact.
    pub fn at(&self, share: f64) -> Point<f64> {
        if share == 0.0 || share == 1.0 {
            return if share == 0.0 { self.from } else { self.to };
        }
        match &self.circle {
            // Exact along level lines too.
            None => [0, 1].map(|k| {
                let (a, b) = (self.from[k], self.to[k]);
                if a == b { a } else { a * (1.0 - share) + b * share }
            }),
            Some(Circle { centre, .. }) => {
                let arm = sub(&self.from, centre);
                add(centre, &turned(&arm, share * self.sweep()), &1.0)
            }
        }
    }

    /// Returns points along the segment, its ends included.
    pub fn samples(&self) -> Vec<Point<f64>> {
        sample_curve(|share| self.at(share))
    }

    /// Returns the ends, and the points of an arc that are farthest to a side.
    pub fn extremes(&self) -> impl Iterator<Item = Point<f64>> {
        let sides = [[1.0, 0.0], [0.0, 1.0]].map(|side| [side, opposite(&side)]);
        let poles = self.circle.iter().flat_map(move |Circle { centre, radius, .. }| {
            sides.as_flattened().iter().map(|side| add(centre, side, radius)).collect::<Vec<_>>()
        });
        [self.from, self.to].into_iter().chain(poles.filter(|pole| self.faces(pole)))
    }
}
