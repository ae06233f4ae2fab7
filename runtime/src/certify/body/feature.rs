//! A piece of a profile as geometry of the half plane.

use crate::tool::{Circle, Piece};

/// A place in the half plane, `[d, z]`.
pub(crate) type Place = [f64; 2];

/// Three places. Of those that bound what lies between two ends, the third is the apex.
pub(crate) type Triangle = [Place; 3];

/// A piece, an arc no more than a quarter of its circle, so that it is monotone.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Feature {
    pub(crate) ends: [Place; 2],
    /// From end to end: a unit vector.
    pub(crate) along: Place,
    pub(crate) length: f64,
    pub(crate) circle: Option<Circle>,
    pub(crate) surface: usize,
}

pub(crate) fn minus(a: Place, b: Place) -> Place {
    [a[0] - b[0], a[1] - b[1]]
}

pub(crate) fn dot(a: Place, b: Place) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

pub(crate) fn cross(a: Place, b: Place) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

pub(crate) fn norm(a: Place) -> f64 {
    dot(a, a).sqrt()
}

fn least([a, b, c]: [f64; 3]) -> f64 {
    a.min(b).min(c)
}

fn most([a, b, c]: [f64; 3]) -> f64 {
    a.max(b).max(c)
}

impl Feature {
    fn new(ends: [Place; 2], circle: Option<Circle>, surface: usize) -> Feature {
        let way = minus(ends[1], ends[0]);
        let length = norm(way);
        let along = if length > 0.0 { way.map(|part| part / length) } else { [0.0; 2] };
        Feature { ends, along, length, circle, surface }
    }

    /// The direction of travel at its beginning or end.
    pub(crate) fn heading(&self, end: usize) -> Place {
        let Some(Circle { centre, radius, convex }) = self.circle else { return self.along };
        let [d, z] = minus(self.ends[end], centre).map(|part| part / radius);
        if convex { [-z, d] } else { [z, -d] }
    }

    /// The line itself, or one that touches a convex arc at its middle.
    pub(crate) fn tangent(&self) -> Option<Feature> {
        match self.circle {
            None => Some(*self),
            Some(Circle { centre, radius, convex: true }) => {
                let out = [self.along[1], -self.along[0]];
                let touch = [0, 1].map(|k| centre[k] + radius * out[k]);
                Some(Feature { ends: [touch; 2], length: 0.0, circle: None, ..*self })
            }
            Some(_) => None,
        }
    }

    /// A ball about a place of the axis that holds that of a convex arc about the axis, in a tool of that
    /// size: its height and radius. None where that is so large that `f32` would tell nothing of it. It holds the arc's
    /// however far that is from the axis; from a part in 10^9 on it is not close enough to be of use.
    pub(crate) fn ball(&self, size: f64) -> Option<[f64; 2]> {
        let Circle { centre: [d, z], radius, convex } = self.circle?;
        let small = radius.max(z.abs()) <= 4.0 * size;
        (convex && small && d.abs() <= 1e-9 * size).then_some([z, radius + d.abs()])
    }

    /// 1 where the tool is toward the axis, -1 where it is away from it.
    fn sense(&self) -> f64 {
        if self.ends[1][1] < self.ends[0][1] { -1.0 } else { 1.0 }
    }

    /// The distance from the axis at a height between its ends.
    pub(crate) fn radius_at(&self, z: f64) -> f64 {
        let [[d0, z0], [d1, z1]] = self.ends;
        if z == z0 || z == z1 {
            return if z == z0 { d0 } else { d1 };
        }
        let radius = match self.circle {
            None => d0 + (d1 - d0) * ((z - z0) / (z1 - z0)),
            Some(Circle { centre, radius, convex }) => {
                let side = if convex { self.sense() } else { -self.sense() };
                let up = z - centre[1];
                centre[0] + side * ((radius - up) * (radius + up)).max(0.0).sqrt()
            }
        };
        radius.clamp(d0.min(d1), d0.max(d1))
    }

    /// How far a place is on the tool's side of this, of the places of its heights: at least 0 just
    /// inside. A convex arc is taken to go on level into the tool, a hollow one out of it.
    #[inline]
    pub(crate) fn over(&self, p: Place) -> f64 {
        let Some(Circle { centre, radius, convex }) = self.circle else {
            return cross(self.along, minus(p, self.ends[0]));
        };
        let [d, z] = minus(p, centre);
        let d = self.sense() * d;
        if convex {
            radius - norm([d.max(0.0), z])
        } else if d <= 0.0 {
            norm([d, z]) - radius
        } else {
            z.abs() - radius - d
        }
    }

    /// The gradient of [`Feature::over`].
    pub(crate) fn inward(&self, p: Place) -> Place {
        let Some(Circle { centre, convex, .. }) = self.circle else {
            return [-self.along[1], self.along[0]];
        };
        let sense = self.sense();
        let [d, z] = minus(p, centre);
        let d = sense * d;
        let way = if convex { [-d.max(0.0), -z] } else { [d, z] };
        let far = norm(way);
        let [d, z] = if (!convex && d > 0.0) || far == 0.0 {
            [-1.0, 0.0]
        } else {
            way.map(|part| part / far)
        };
        [sense * d, z]
    }

    /// No less than [`Feature::over`] at any place in a triangle.
    #[inline]
    pub(crate) fn over_at_most(&self, triangle: &Triangle) -> f64 {
        match &self.circle {
            // Tangents that touch on the tool's side bound nothing: the tool goes on there.
            Some(circle) if circle.convex => {
                let sense = self.sense();
                below_tangents(circle, triangle, |[d, z]| [sense * (sense * d).max(0.0), z])
            }
            // Linear, or convex where it is not below 0.
            _ => most(triangle.map(|p| self.over(p))),
        }
    }

    /// Whether the foot of a place on an arc's circle lies on the arc.
    #[inline]
    fn sector(&self, circle: &Circle, p: Place) -> bool {
        let [from, to] = self.ends.map(|end| minus(end, circle.centre));
        let out = minus(p, circle.centre);
        let (first, last) = (cross(from, out), cross(out, to));
        if circle.convex { first >= 0.0 && last >= 0.0 } else { first <= 0.0 && last <= 0.0 }
    }

    /// At which ends the nearest point of places of a triangle, a rectangle or the like may be: `None` unless
    /// it surely is at one of them.
    pub(crate) fn at_ends(&self, corners: &[Place]) -> Option<[bool; 2]> {
        let [first, last] = self.ends;
        let middle = [0, 1].map(|k| f64::midpoint(first[k], last[k]));
        let all = |beyond: &dyn Fn(Place) -> f64| corners.iter().all(|p| beyond(*p) > 0.0);
        let beyond = match &self.circle {
            None => [
                all(&|p| -dot(self.along, minus(p, first))),
                all(&|p| dot(self.along, minus(p, last))),
            ],
            // As seen from the centre.
            Some(Circle { centre, convex, .. }) => {
                let sense = if *convex { 1.0 } else { -1.0 };
                let out = |from: Place, p: Place| cross(minus(from, *centre), minus(p, *centre));
                [all(&|p| -sense * out(first, p)), all(&|p| sense * out(last, p))]
            }
        };
        if beyond == [false, false] {
            return None;
        }
        let nearer = [
            all(&|p| -dot(self.along, minus(p, middle))),
            all(&|p| dot(self.along, minus(p, middle))),
        ];
        match nearer {
            [true, _] => Some([true, false]),
            [_, true] => Some([false, true]),
            _ => Some([true, true]),
        }
    }

    fn faces(&self, circle: &Circle, triangle: &Triangle) -> bool {
        triangle.iter().all(|p| self.sector(circle, *p))
    }

    /// Whether [`Feature::over`] is the distance from the feature, below 0 beyond it, at all places of a
    /// triangle: their feet are `from` one place `to` another of a line, or on the arc.
    #[inline]
    pub(crate) fn square(&self, triangle: &Triangle, [from, to]: [f64; 2]) -> bool {
        match &self.circle {
            None => triangle.iter().all(|p| {
                let at = dot(self.along, minus(*p, self.ends[0]));
                from <= at && at <= to
            }),
            Some(circle) => self.faces(circle, triangle),
        }
    }

    /// The nearest point.
    #[inline]
    pub(crate) fn foot(&self, p: Place) -> Place {
        match &self.circle {
            None => {
                let at = dot(self.along, minus(p, self.ends[0]));
                if at <= 0.0 {
                    self.ends[0]
                } else if at >= self.length {
                    self.ends[1]
                } else {
                    [0, 1].map(|k| self.ends[0][k] + at * self.along[k])
                }
            }
            Some(circle) if self.sector(circle, p) => {
                let out = minus(p, circle.centre);
                let far = norm(out);
                if far > 0.0 {
                    [0, 1].map(|k| circle.centre[k] + circle.radius * (out[k] / far))
                } else {
                    self.ends[0]
                }
            }
            Some(_) => {
                let [from, to] = self.ends.map(|end| minus(p, end));
                self.ends[usize::from(dot(to, to) < dot(from, from))]
            }
        }
    }

    /// The distance.
    #[inline]
    pub(crate) fn away(&self, p: Place) -> f64 {
        match &self.circle {
            None => {
                let off = minus(p, self.ends[0]);
                let at = dot(self.along, off);
                if at <= 0.0 {
                    norm(off)
                } else if at >= self.length {
                    norm(minus(p, self.ends[1]))
                } else {
                    cross(self.along, off).abs()
                }
            }
            Some(circle) if self.sector(circle, p) => {
                (norm(minus(p, circle.centre)) - circle.radius).abs()
            }
            Some(_) => {
                let [from, to] = self.ends.map(|end| minus(p, end));
                dot(from, from).min(dot(to, to)).sqrt()
            }
        }
    }

    /// The gradient of [`Feature::away`].
    pub(crate) fn outward(&self, p: Place) -> Place {
        let way = minus(p, self.foot(p));
        let far = norm(way);
        if far > 0.0 { way.map(|part| part / far) } else { self.inward(p) }
    }

    /// No less than the distance of any place in a triangle.
    #[inline]
    pub(crate) fn at_most(&self, triangle: &Triangle) -> f64 {
        match &self.circle {
            // The distance from a convex set is convex.
            None => most(triangle.map(|p| self.away(p))),
            Some(circle) if self.faces(circle, triangle) => {
                let out = most(triangle.map(|p| norm(minus(p, circle.centre)) - circle.radius));
                out.max(below_tangents(circle, triangle, |n| n))
            }
            Some(_) => {
                let [from, to] = self.ends.map(|end| most(triangle.map(|p| norm(minus(p, end)))));
                from.min(to)
            }
        }
    }

    /// No more than the distance of any place in a triangle.
    #[inline]
    pub(crate) fn at_least(&self, triangle: &Triangle) -> f64 {
        let [first, second, middle] = *triangle;
        // A distance changes by no more than the way.
        let reach = norm(minus(first, middle)).max(norm(minus(second, middle)));
        let coarse = self.away(middle) - reach;
        if let Some(Circle { centre, radius, convex: false }) = self.circle {
            // From inside the circle; from beyond it only an end is near.
            return coarse.max(least(triangle.map(|p| radius - norm(minus(p, centre)))));
        }
        let nearer = if self.away(first) < self.away(second) { first } else { second };
        coarse.max(self.parted(triangle, middle)).max(self.parted(triangle, nearer))
    }

    /// How far a triangle is from the line beyond the feature that is normal to the way from it to `seen`.
    fn parted(&self, triangle: &Triangle, seen: Place) -> f64 {
        let way = minus(seen, self.foot(seen));
        let far = norm(way);
        if far == 0.0 {
            return 0.0;
        }
        let [from, to] = self.ends.map(|end| dot(way, end));
        let most = match &self.circle {
            Some(circle) if self.sector(circle, [0, 1].map(|k| circle.centre[k] + way[k])) => {
                dot(way, circle.centre) + circle.radius * far
            }
            _ => from.max(to),
        };
        (least(triangle.map(|p| dot(way, p))) - most) / far
    }
}

/// No less than how far any place of a triangle is inside a circle: no place is deeper than under a
/// tangent. Taken are those at the feet of the end that is farther inside and of the apex, in the directions
/// that `touching` makes of theirs.
#[inline]
fn below_tangents(circle: &Circle, triangle: &Triangle, touching: impl Fn(Place) -> Place) -> f64 {
    let out = triangle.map(|p| minus(p, circle.centre));
    let beneath = |out_of: Place| {
        let n = touching(out_of);
        let far = norm(n);
        if far > 0.0 { circle.radius - least(out.map(|v| dot(n, v))) / far } else { circle.radius }
    };
    let deeper = usize::from(dot(out[1], out[1]) < dot(out[0], out[0]));
    beneath(out[deeper]).min(beneath(out[2]))
}

/// The features of a piece: an arc is cut where it is level or upright.
pub(crate) fn quarters(piece: &Piece) -> Vec<Feature> {
    let Some(circle) = piece.circle else {
        return vec![Feature::new([piece.from, piece.to], None, piece.surface)];
    };
    let Circle { centre, radius, convex } = circle;
    const FULL: f64 = std::f64::consts::TAU;
    let angle = |p: Place| (p[1] - centre[1]).atan2(p[0] - centre[0]);
    let sense = if convex { 1.0 } else { -1.0 };
    let turned = |p: Place| (sense * (angle(p) - angle(piece.from))).rem_euclid(FULL);
    // Ends so near each other are those of a short arc, whose angles rounding may have put the other way round.
    let turn = Some(turned(piece.to)).filter(|turn| *turn < FULL - 1e-9).unwrap_or(0.0);
    let mut cuts: Vec<Place> = [[radius, 0.0], [0.0, radius], [-radius, 0.0], [0.0, -radius]]
        .into_iter()
        .map(|[d, z]| [centre[0] + d, centre[1] + z])
        // Those at the ends are none. An arc that goes so much farther than a quarter reaches beyond its end by
        // radius (1 - cos 1e-9), 5e-19 of the radius, which is less than its centre and radius are rounded by.
        .filter(|cut| turned(*cut) >= 1e-9 && turned(*cut) < turn - 1e-9)
        .collect();
    cuts.sort_by(|a, b| turned(*a).total_cmp(&turned(*b)));
    cuts.push(piece.to);
    let mut from = piece.from;
    cuts.into_iter()
        .map(|to| Feature::new([std::mem::replace(&mut from, to), to], Some(circle), piece.surface))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Its end is an ulp before its beginning, as rounding may have it.
    #[test]
    fn an_arc_as_short_as_rounding_is_no_full_circle() {
        let (from, to) = ([5.0, 0.3], [5.0, 0.3f64.next_down()]);
        for convex in [true, false] {
            let (from, to) = if convex { (from, to) } else { (to, from) };
            let circle = Some(Circle { centre: [3.0, 0.1], radius: 2.0_f64.hypot(0.2), convex });
            assert_eq!(quarters(&Piece { from, to, circle, surface: 0 }).len(), 1);
        }
    }
}
