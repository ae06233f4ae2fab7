//! A profile of lines and arcs, and its nearest feature by exhaustive search: the one oracle of what a profile is, for
//! any number type.
//!
//! For a surface of revolution the nearest surface point lies in the half plane through the query point, so two
//! dimensions are enough. At the axis the profile meets its mirror image. Each segment counts only for points whose foot
//! lies on it, each reflex corner for those of its fan. The smallest distance wins, and among equals the feature listed
//! first. Inside is decided by crossings (even-odd), not by the nearest feature.

use super::real::Real;
use super::segment::Segment;
use super::vector::{Point, cross, dot, norm, sub, unit};

/// Sine of a turn, below which a vertex is smooth.
const SMOOTH: f64 = 1e-12;

/// A feature of a profile.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Feature {
    /// A segment, by its index.
    Segment(usize),
    /// The corner before a segment; behind the last for their number. If it is reflex, it owns a fan inside.
    Corner(usize),
}

/// The nearest feature of a profile, from inside or outside.
#[derive(Clone, Debug)]
pub struct NearestFeature<T> {
    /// The feature.
    pub feature: Feature,
    /// The distance to it.
    pub distance: T,
}

/// A closed profile from the axis to the axis, counter-clockwise with `d` to the right and `z` up.
#[derive(Clone, Debug)]
pub struct Profile<T> {
    segments: Vec<Segment<T>>,
    /// The unit vectors of travel into each vertex and out of it. At the axis one is the other's mirror image.
    tangents: Vec<[Point<T>; 2]>,
    /// The sine of the turn at each vertex, negative at a reflex corner.
    turns: Vec<f64>,
    owners: Vec<Feature>,
}

impl<T: Real> Profile<T> {
    /// Creates the profile of segments, each of which begins where the last ends.
    pub fn new(segments: Vec<Segment<T>>) -> Profile<T> {
        assert!(!segments.is_empty(), "a profile has segments");
        let count = segments.len();
        let mirrored = |t: &Point<T>| [t[0].clone(), t[1].negated()];
        let (mut tangents, mut turns, mut owners) = (Vec::new(), Vec::new(), Vec::new());
        for k in 0..=count {
            let before = k.checked_sub(1).map(|k| segments[k].tangent(&segments[k].to));
            let after = segments.get(k).map(|segment| segment.tangent(&segment.from));
            let into = before.clone().or(after.as_ref().map(mirrored));
            let out = after.or(before.as_ref().map(mirrored));
            let [into, out] = [into, out].map(|t| t.expect("a vertex has a segment on one side"));
            turns.push(cross(&into, &out).to_f64());
            tangents.push([into, out]);
            owners.extend((turns[k] < -SMOOTH).then_some(Feature::Corner(k)));
            owners.extend((k < count).then_some(Feature::Segment(k)));
        }
        Profile { segments, tangents, turns, owners }
    }

    /// Reads the profile of vertices separated by commas: `d z` after a line, `d z about c h` after an arc with its centre,
    /// `d z radius r` or `d z hollow radius r` after one with its radius.
    pub fn parse(text: &str) -> Profile<T> {
        Profile::read(text, |word| T::decimal(word.parse().expect("a number")))
    }

    /// Reads the profile of [these vertices][Profile::parse], each of whose words stands for a number.
    pub fn read(text: &str, number: impl Fn(&str) -> T) -> Profile<T> {
        let numbers = |text: &str| -> Vec<T> { text.split_whitespace().map(&number).collect() };
        let point = |text: &str| <Point<T>>::try_from(numbers(text)).expect("two coordinates");
        let mut vertices = text.split(',');
        let mut from = point(vertices.next().unwrap_or_default());
        let segment = |vertex: &str| {
            let start = from.clone();
            let segment = if let Some((to, centre)) = vertex.split_once("about") {
                Segment::arc(start, point(to), point(centre))
            } else if let Some((to, radius)) = vertex.split_once("radius") {
                let (to, convex) =
                    to.split_once("hollow").map_or((to, true), |(to, _)| (to, false));
                Segment::by_radius(start, point(to), numbers(radius).remove(0), convex)
            } else {
                Segment::line(start, point(vertex))
            };
            from = segment.to.clone();
            segment
        };
        Profile::new(vertices.map(segment).collect())
    }

    /// Returns the profile with each number mapped.
    pub fn map<U: Real>(&self, number: impl Fn(&T) -> U) -> Profile<U> {
        let point = |p: &Point<T>| p.each_ref().map(&number);
        Profile::new(self.segments.iter().map(|segment| segment.map(point, &number)).collect())
    }

    /// Returns the segments.
    pub fn segments(&self) -> &[Segment<T>] {
        &self.segments
    }

    /// Returns the features that may own points inside, in the order of listing: along the profile.
    pub fn owners(&self) -> &[Feature] {
        &self.owners
    }

    /// Returns the vertex before a segment, or behind the last.
    pub fn vertex(&self, k: usize) -> &Point<T> {
        self.segments.get(k).map_or_else(|| &self.segments[k - 1].to, |segment| &segment.from)
    }

    /// Returns the unit vectors of travel into a vertex and out of it. At the axis one is the other's mirror image.
    pub fn tangents(&self, k: usize) -> &[Point<T>; 2] {
        &self.tangents[k]
    }

    /// Returns the sine of the turn at a vertex, negative at a reflex corner.
    pub fn turn(&self, k: usize) -> f64 {
        self.turns[k]
    }

    fn is_reflex(&self, k: usize) -> bool {
        self.turns[k] < -SMOOTH
    }

    /// Returns whether a point is inside, by the even-odd rule on the ray away from the axis. Undecided on the profile
    /// itself.
    pub fn encloses(&self, p: &Point<T>) -> bool {
        self.segments.iter().map(|segment| segment.crossings(p)).sum::<usize>() % 2 == 1
    }

    /// Returns the depth of a point: the distance to the profile, negative outside.
    pub fn depth(&self, p: &Point<T>) -> T {
        let distances = self.segments.iter().map(|segment| segment.distance(p));
        let distance = distances.reduce(T::least).expect("a profile has segments");
        if distance == T::zero() || self.encloses(p) { distance } else { distance.negated() }
    }

    /// Returns the nearest feature.
    pub fn nearest(&self, p: &Point<T>) -> NearestFeature<T> {
        self.nearest_of(|_| true, p)
    }

    /// Returns the nearest feature among some segments and their ends, one of which is the nearest.
    ///
    /// Beside a fan or joint, the distances of two features differ only by the square of the distance from their
    /// border, far below rounding. Each feature therefore counts only on its own side, and ties are left for the
    /// borders themselves.
    pub fn nearest_of(&self, is_near: impl Fn(usize) -> bool, p: &Point<T>) -> NearestFeature<T> {
        let count = self.segments.len();
        let is_near_end = |k: usize| (k > 0 && is_near(k - 1)) || (k < count && is_near(k));
        let mut best: Option<NearestFeature<T>> = None;
        for feature in (0..=count).flat_map(|k| [Feature::Corner(k), Feature::Segment(k)]) {
            let distance = match feature {
                Feature::Corner(k) if is_near_end(k) && self.owns_fan_at(k, p) => {
                    norm(&sub(p, self.vertex(k)))
                }
                Feature::Segment(k) if k < count && is_near(k) && self.segments[k].faces(p) => {
                    self.segments[k].inward(p).absolute()
                }
                _ => continue,
            };
            if best.as_ref().is_none_or(|best| distance < best.distance) {
                best = Some(NearestFeature { feature, distance });
            }
        }
        // A joint, and a corner outside its fan, only catch points that rounding let fall between their neighbours.
        for k in (0..=count).filter(|k| is_near_end(*k) && !self.owns_fan_at(*k, p)) {
            let distance = norm(&sub(p, self.vertex(k)));
            let share = if self.turns[k] > SMOOTH { 1.0 } else { 1.0 - 1e-9 };
            let is_nearer = best.as_ref().is_none_or(|best| {
                distance < best.distance
                    && (share == 1.0 || distance.to_f64() < best.distance.to_f64() * share)
            });
            if is_nearer {
                best = Some(NearestFeature { feature: Feature::Corner(k), distance });
            }
        }
        best.expect("one segment is near")
    }

    /// Returns whether a vertex is a reflex corner, in whose fan a point lies.
    fn owns_fan_at(&self, k: usize, p: &Point<T>) -> bool {
        let [before, after] = &self.tangents[k];
        let from = || sub(p, self.vertex(k));
        self.is_reflex(k) && dot(&from(), before) >= T::zero() && dot(&from(), after) <= T::zero()
    }

    /// Returns the index of a feature in the order of listing; for a corner that owns nothing, that of the segment listed
    /// first of those that meet there.
    pub fn owner(&self, feature: Feature) -> usize {
        let index = |feature| self.owners.iter().position(|owner| *owner == feature);
        let Feature::Corner(k) = feature else {
            return index(feature).expect("each segment is listed");
        };
        index(feature).unwrap_or_else(|| self.owner(Feature::Segment(k.saturating_sub(1))))
    }

    /// Returns the distance to a feature, to a segment with its ends.
    pub fn distance(&self, feature: Feature, p: &Point<T>) -> T {
        match feature {
            Feature::Segment(k) => self.segments[k].distance(p),
            Feature::Corner(k) => norm(&sub(p, self.vertex(k))),
        }
    }

    /// Returns the unit vector from a point inside to its nearest point, if that is of this feature.
    pub fn direction(&self, feature: Feature, p: &Point<T>) -> Point<T> {
        match feature {
            Feature::Segment(k) => self.segments[k].outward(p),
            Feature::Corner(k) if self.is_reflex(k) => unit(&sub(self.vertex(k), p)),
            // Only the corner itself is inside and nearest to a corner that owns nothing.
            Feature::Corner(k) => self.segments[k.saturating_sub(1)].outward(p),
        }
    }

    /// Returns the distance from a point that a feature owns to the nearest one at which its direction does not exist:
    /// the axis unless the direction is along it, the centre of an arc, a corner.
    pub fn singularity_distance(&self, feature: Feature, p: &Point<T>) -> f64 {
        let has_radial_part = self.direction(feature, p)[0] != T::zero();
        let axis = if has_radial_part { p[0].to_f64() } else { f64::INFINITY };
        let centre = match feature {
            Feature::Segment(k) => self.segments[k].centre(),
            Feature::Corner(k) if self.is_reflex(k) => Some(self.vertex(k)),
            Feature::Corner(k) => self.segments[k.saturating_sub(1)].centre(),
        };
        centre.map_or(axis, |centre| axis.min(norm(&sub(p, centre)).to_f64()))
    }

    /// Returns the commands of a `.tool` file that draw the profile, with the words for each number and each surface.
    pub fn text(&self, number: impl Fn(&T) -> String, surface: impl Fn(usize) -> String) -> String {
        let point = |[d, z]: &Point<T>| format!("({}, {})", number(d), number(z));
        let mut text = format!("profile {{\n  start {};\n", point(self.vertex(0)));
        for (k, segment) in self.segments.iter().enumerate() {
            let to = point(&segment.to);
            let command = match &segment.circle {
                None => format!("line to {to}"),
                Some(circle) => {
                    let concave = if circle.convex { "" } else { " concave" };
                    if circle.by_radius {
                        format!("arc to {to} radius {}{concave}", number(&circle.radius))
                    } else {
                        format!("arc to {to} center {}{concave}", point(&circle.centre))
                    }
                }
            };
            text += &format!("  {command} as {};\n", surface(k));
        }
        text + "}"
    }
}

impl Profile<f64> {
    /// Returns a lower bound of the distance to the surface and to the curves on which the nearest feature changes;
    /// outside, of the distance to the surface only.
    ///
    /// Two features meet either at a shared fan line or joint, whose distance is plain, or on the curve where their
    /// distances agree. Distances are 1-Lipschitz, so that curve is at least half their difference away.
    pub fn border_distance(&self, p: &Point<f64>) -> f64 {
        let near = self.nearest(p);
        let least = near.distance;
        if least > 0.0 && !self.encloses(p) {
            return least;
        }
        let owner = self.owners[self.owner(near.feature)];
        let mut linked = vec![owner];
        let mut border = least;
        let count = self.segments.len();
        for k in (0..=count).filter(|k| self.turns[*k] <= SMOOTH) {
            let before = k.checked_sub(1).map(Feature::Segment);
            let after = (k < count).then_some(Feature::Segment(k));
            let corner = self.is_reflex(k).then_some(Feature::Corner(k));
            let around = [before, corner, after];
            // A smooth profile at the axis has no other side.
            let is_border = corner.is_some() || (before.is_some() && after.is_some());
            if is_border && around.contains(&Some(owner)) {
                linked.extend(around.into_iter().flatten());
                for tangent in self.tangents(k) {
                    border = border.min(dot(&sub(p, self.vertex(k)), tangent).abs());
                }
            }
        }
        for other in self.owners.iter().filter(|other| !linked.contains(other)) {
            border = border.min((self.distance(*other, p) - least) / 2.0);
        }
        border.max(0.0)
    }

    /// Returns the vertices, and the centres of arcs.
    pub fn corners(&self) -> Vec<Point<f64>> {
        let vertices = (0..=self.segments.len()).map(|k| *self.vertex(k));
        vertices.chain(self.segments.iter().filter_map(Segment::centre).copied()).collect()
    }

    /// Returns points along each segment.
    pub fn surface(&self) -> Vec<Vec<Point<f64>>> {
        self.segments.iter().map(Segment::samples).collect()
    }

    /// Returns the least and the largest `[d, z]`.
    pub fn extent(&self) -> [Point<f64>; 2] {
        let extremes = self.segments.iter().flat_map(Segment::extremes);
        extremes.fold([[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]], |[low, high], p| {
            [[0, 1].map(|k| low[k].min(p[k])), [0, 1].map(|k| high[k].max(p[k]))]
        })
    }
}

#[cfg(test)]
mod tests {
    use super::super::big::Big;
    use super::super::restated;
    use super::super::rng::Rng;
    use super::super::vector::add;
    use super::*;

    /// A body with a neck: convex and concave arcs, a taper, both kinds of corner.
    fn vase() -> Profile<f64> {
        Profile::parse("0 0, 2 2 about 0 2, 1 3 about 2 3, 3 5, 3 6, 0 6")
    }

    /// Returns the point of a segment nearest to another, by trying points along it closer and closer together.
    fn nearest_along(segment: &Segment<f64>, p: &Point<f64>) -> Point<f64> {
        let distance = |share: &f64| norm(&sub(p, &segment.at(*share)));
        let (mut best, mut step) = (0.5, 1.0 / 64.0);
        while step > 1e-11 {
            let around = (-32..=32).map(|k| (best + f64::from(k) * step).clamp(0.0, 1.0));
            let measured = around.map(|share| (distance(&share), share));
            best = measured.min_by(|a, b| a.0.total_cmp(&b.0)).map_or(best, |(_, share)| share);
            step /= 16.0;
        }
        segment.at(best)
    }

    /// Every thirtieth point is compared with a search along each segment, which uses nothing but its points.
    #[test]
    fn the_nearest_feature_is_the_one_that_a_search_along_the_segments_finds() {
        let restated = restated::all().into_iter().map(|tool| tool.profile.map(Big::to_f64));
        for profile in restated.chain([vase()]) {
            let [_, [radius, height]] = profile.extent();
            let size = radius.max(height);
            let mut rng = Rng::new(5);
            for k in 0..6_000 {
                let p = [rng.between(0.0, 1.5) * radius, rng.between(-0.2, 1.2) * height];
                let near = profile.nearest(&p);
                let depth = profile.depth(&p).abs();
                assert!((depth - near.distance).abs() < 1e-13 * size, "{p:?}");
                if near.distance < 1e-12 * size {
                    continue;
                }
                // Even-odd, and the side of the nearest feature.
                let is_inside = match near.feature {
                    Feature::Segment(k) => profile.segments()[k].inward(&p) > 0.0,
                    Feature::Corner(k) => profile.is_reflex(k),
                };
                assert_eq!(is_inside, profile.encloses(&p), "{p:?} {near:?}");
                let foot = is_inside.then(|| {
                    let u = profile.direction(near.feature, &p);
                    add(&p, &u, &near.distance)
                });
                if let Some(foot) = foot {
                    assert!(profile.nearest(&foot).distance < 1e-13 * size, "{p:?} {near:?}");
                    if let Feature::Segment(k) = near.feature {
                        let off = norm(&sub(&profile.segments()[k].foot(&p), &foot));
                        assert!(off < 1e-13 * size, "{p:?} {near:?}");
                    }
                }
                if k % 30 != 0 {
                    continue;
                }
                let found = profile.segments().iter().map(|segment| nearest_along(segment, &p));
                let found = found.map(|point| (norm(&sub(&p, &point)), point)).enumerate();
                let (k, (least, point)) =
                    found.min_by(|a, b| a.1.0.total_cmp(&b.1.0)).expect("a segment");
                assert!((near.distance - least).abs() < 1e-13 * size, "{p:?}");
                let is_clear = profile.border_distance(&p) > 1e-5 * size;
                if let Some(foot) = foot.filter(|_| is_clear) {
                    assert!(norm(&sub(&foot, &point)) < 1e-6 * size, "{p:?} {near:?}");
                    let is_owner = match near.feature {
                        Feature::Segment(owner) => owner == k,
                        Feature::Corner(k) => norm(&sub(profile.vertex(k), &point)) < 1e-9 * size,
                    };
                    assert!(is_owner, "{p:?} {near:?}, not {k}");
                }
            }
        }
    }

    #[test]
    fn the_surface_belongs_to_the_solid() {
        let vase = vase();
        for p in
            [[0.0, 0.0], [3.0, 5.5], [1.5, 6.0], [3.0, 6.0], [2.0, 2.0], [1.0, 3.0], [3.0, 5.0]]
        {
            assert_eq!(vase.depth(&p), 0.0, "{p:?}");
        }
    }

    /// At the axis a dished end is a reflex corner, which owns a fan, and a pointed one is not.
    #[test]
    fn the_axis_is_a_mirror() {
        let dished = Profile::<f64>::parse("0 1, 3 0, 3 8, 0 9");
        assert_eq!(dished.owners()[..2], [Feature::Corner(0), Feature::Segment(0)]);
        assert_eq!(dished.owners().len(), 4);
        let near = dished.nearest(&[0.1, 2.0]);
        assert_eq!((near.feature, near.distance), (Feature::Corner(0), 0.1f64.hypot(1.0)));
        assert_eq!(dished.direction(near.feature, &[0.1, 2.0]), unit(&[-0.1, -1.0]));
    }
}
