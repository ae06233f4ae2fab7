//! The nearest-feature partition of a profile's inside: regions that nobody had to write.
//!
//! Features are the pieces of the profile and its reflex corners; the axis is a mirror and not a
//! feature, and a tangent joint owns nothing. A feature's region is bounded by a few curves:
//! where another feature comes as near, and where its own fan or sector ends. Which of them bound
//! it is found by looking: as long as some sample of the section is claimed by a region that is not
//! its owner's, the curve between the two is added. Owners of samples are told by plain distances
//! to the clamped pieces, which no curve takes part in.
//!
//! That a bound holds where it must: moving from its foot on a feature straight inward, a point's
//! distance to that feature grows by 1 and any other signed distance by at most 1, so a curve once
//! crossed is not crossed back.

mod curve;
pub(crate) mod outline;
mod samples;

use crate::expr::{Coord, Graph, Id};
use crate::number::Number;
use curve::{Bound, Curve};
use outline::{Place, Point, Segment, minus, norm, turn};

/// What a point of the inside can be nearest to.
#[derive(Clone, Debug)]
pub(crate) enum Feature {
    /// A piece, by its place in the outline.
    Piece(usize),
    /// The reflex corner behind a piece; before the first for `None`.
    Corner(Option<usize>),
}

/// A side of a curve: `value ≤ 0`.
pub(crate) type Side = Id;

/// A derived region: all of the conditions hold, of each one of its sides.
#[derive(Clone, Debug)]
pub(crate) struct Derived {
    pub(crate) feature: Feature,
    pub(crate) conditions: Vec<Vec<Side>>,
    pub(crate) depth: Id,
}

/// The most bounds that one region may need.
const MOST: usize = 64;

/// Distances that differ by less than this part of the tool's size tell no owner.
const CLOSE: f64 = 1e-9;

/// Why a profile could not be divided, with the place where it was noticed.
pub(crate) struct Undivided(pub(crate) Point);

/// The outline with its features.
struct Section<'o> {
    outline: &'o [Segment],
    features: Vec<Feature>,
    /// Every corner, and the feature that it is, if it is one.
    corners: Vec<(Point, Option<usize>)>,
    /// The diagonal of its box.
    size: f64,
}

/// Divides the inside of an outline.
pub(crate) fn nearest(graph: &mut Graph, outline: &[Segment]) -> Result<Vec<Derived>, Undivided> {
    if outline.is_empty() {
        return Ok(Vec::new());
    }
    let section = Section::new(outline);
    let mut samples: Vec<(Point, Option<usize>)> =
        samples::scattered(outline).into_iter().filter_map(|p| section.sample(p)).collect();
    section.refined(&mut samples);
    (0..section.features.len()).map(|feature| section.region(graph, feature, &samples)).collect()
}

/// The features along the profile: pieces, and the reflex corners between them.
fn features(outline: &[Segment]) -> Vec<Feature> {
    let mirrored = |t: Point| [t[0], -t[1]];
    let mut features = Vec::new();
    let Some(first) = outline.first() else { return features };
    // At the axis the profile meets its own mirror image.
    let start = first.tangent(false);
    if turn(mirrored(start), start) < 0.0 {
        features.push(Feature::Corner(None));
    }
    for (index, segment) in outline.iter().enumerate() {
        features.push(Feature::Piece(index));
        let end = segment.tangent(true);
        let next = outline.get(index + 1).map_or(mirrored(end), |next| next.tangent(false));
        if turn(end, next) < 0.0 {
            features.push(Feature::Corner(Some(index)));
        }
    }
    features
}

impl<'o> Section<'o> {
    fn new(outline: &'o [Segment]) -> Section<'o> {
        let features = features(outline);
        let all = std::iter::once(None).chain((0..outline.len()).map(Some));
        let corners = all
            .map(|behind| {
                let place = match behind {
                    Some(piece) => outline[piece].ends()[1],
                    None => outline[0].ends()[0],
                };
                let is = |f: &Feature| matches!(f, Feature::Corner(other) if *other == behind);
                (place, features.iter().position(is))
            })
            .collect();
        let [low, high] = outline::reach(outline);
        Section { outline, features, corners, size: norm(minus(high, low)) }
    }
}

impl Section<'_> {
    fn corner(&self, behind: Option<usize>) -> &Place {
        match behind {
            Some(piece) => &self.outline[piece].to,
            None => &self.outline[0].from,
        }
    }

    /// A point with its owner, if that is beyond doubt.
    fn sample(&self, p: Point) -> Option<(Point, Option<usize>)> {
        let (owner, clear) = self.owner(p);
        clear.then_some((p, owner))
    }

    /// The feature that a point of the inside is nearest to, `None` outside, by distances alone;
    /// and whether that is beyond doubt: no other is as near but for rounding.
    fn owner(&self, p: Point) -> (Option<usize>, bool) {
        let slack = CLOSE * self.size;
        let (mut best, mut owner) = (f64::INFINITY, None);
        let mut rival = f64::INFINITY;
        let mut offer = |distance: f64, by: Option<usize>| {
            if distance < best {
                if by != owner {
                    rival = best;
                }
                (best, owner) = (distance, by);
            } else if by != owner {
                rival = rival.min(distance);
            }
        };
        for (place, feature) in self.features.iter().enumerate() {
            if let Feature::Piece(index) = feature {
                let segment = &self.outline[*index];
                if segment.sector(p).iter().all(|side| *side >= -1e-3 * slack) {
                    let depth = segment.signed(p);
                    offer(depth.abs(), (depth >= 0.0).then_some(place));
                }
            }
        }
        for (place, by) in &self.corners {
            offer(norm(minus(p, *place)), *by);
        }
        (owner, rival - best > slack && best > slack)
    }

    /// The piece whose outer side a point outside is on.
    fn outer(&self, p: Point) -> Option<usize> {
        let distance = |index: &usize| {
            let segment = &self.outline[*index];
            let [before, after] = segment.sector(p);
            let [from, to] = segment.ends();
            match (before < 0.0, after < 0.0) {
                (true, _) => norm(minus(p, from)),
                (_, true) => norm(minus(p, to)),
                _ => segment.signed(p).abs(),
            }
        };
        (0..self.outline.len())
            .filter(|index| self.outline[*index].signed(p) < 0.0)
            .min_by(|a, b| distance(a).total_cmp(&distance(b)))
    }

    fn depth(&self, graph: &mut Graph, feature: &Feature) -> Option<Id> {
        match feature {
            Feature::Piece(index) => self.outline[*index].depth(graph),
            Feature::Corner(behind) => outline::distance(graph, self.corner(*behind)),
        }
    }

    fn depth_at(&self, feature: &Feature, p: Point) -> f64 {
        match feature {
            Feature::Piece(index) => self.outline[*index].signed(p),
            Feature::Corner(behind) => {
                norm(minus(p, self.corners[behind.map_or(0, |piece| piece + 1)].0))
            }
        }
    }

    /// The pieces that end in a corner, and which end it is.
    fn beside(&self, behind: Option<usize>) -> [Option<(usize, usize)>; 2] {
        match behind {
            None => [None, Some((0, 0))],
            Some(piece) => {
                let next = (piece + 1 < self.outline.len()).then_some((piece + 1, 0));
                [Some((piece, 1)), next]
            }
        }
    }

    /// The region of one feature.
    fn region(
        &self,
        graph: &mut Graph,
        place: usize,
        samples: &[(Point, Option<usize>)],
    ) -> Result<Derived, Undivided> {
        let feature = self.features[place].clone();
        let own: Vec<Point> =
            samples.iter().filter(|(_, owner)| *owner == Some(place)).map(|(p, _)| *p).collect();
        let mut bounds: Vec<Bound> = Vec::new();
        if let Feature::Piece(piece) = feature {
            bounds.push(Bound::one(Curve::Inside(feature.clone())));
            // Behind a concave arc's centre one is outside its circle too.
            if self.outline[piece].circle.as_ref().is_some_and(|circle| !circle.convex) {
                bounds.extend([0, 1].map(|end| Bound::one(Curve::Before { piece, end })));
            }
        } else if let Feature::Corner(behind) = feature {
            // A corner's fan lies between the normals of its pieces.
            for (piece, end) in self.beside(behind).into_iter().flatten() {
                bounds.push(Bound::one(Curve::Past { piece, end }));
            }
        }
        let sure = bounds.len();
        for (p, owner) in samples {
            if *owner == Some(place) || !bounds.iter().all(|bound| bound.holds(self, *p)) {
                continue;
            }
            let bound = self.bound(&feature, *owner, *p, &own).ok_or(Undivided(*p))?;
            bounds.push(bound);
            if bounds.len() > MOST {
                return Err(Undivided(*p));
            }
        }
        // Later bounds may have made earlier ones idle.
        for index in (sure..bounds.len()).rev() {
            let others = |p: Point| {
                bounds.iter().enumerate().all(|(k, bound)| k == index || bound.holds(self, p))
            };
            let idle = samples.iter().all(|(p, owner)| *owner == Some(place) || !others(*p));
            if idle {
                bounds.remove(index);
            }
        }
        let undivided = || Undivided(own.first().copied().unwrap_or([0.0, 0.0]));
        let depth = self.depth(graph, &feature).ok_or_else(undivided)?;
        let conditions = bounds
            .iter()
            .map(|bound| bound.0.iter().map(|curve| curve.side(self, graph)).collect())
            .collect::<Option<Vec<Vec<Id>>>>()
            .ok_or_else(undivided)?;
        // A convex arc's region lies in its circle. Any other is kept in the outline's box, so that
        // nothing is claimed where no sample was.
        let mut conditions = conditions;
        let in_circle = match feature {
            Feature::Piece(piece) => self.outline[piece].circle.as_ref().is_some_and(|c| c.convex),
            Feature::Corner(_) => false,
        };
        if !in_circle {
            conditions.extend(self.box_sides(graph).into_iter().map(|side| vec![side]));
        }
        Ok(Derived { feature, conditions, depth })
    }

    /// The sides of the outline's box, each at most 0 inside.
    fn box_sides(&self, graph: &mut Graph) -> Vec<Id> {
        let [low, high] = outline::reach(self.outline);
        let (d, z) = (graph.coord(Coord::D), graph.coord(Coord::Z));
        let mut number = |value: f64| graph.number(self.given(value));
        let (radius, low, high) = (number(high[0]), number(low[1]), number(high[1]));
        vec![graph.sub(d, radius), graph.sub(low, z), graph.sub(z, high)]
    }

    /// The constant of the outline that a double stands for, so that equal borders are one curve.
    fn given(&self, value: f64) -> Number {
        let places = self.outline.iter().flat_map(|segment| [&segment.from, &segment.to]);
        places
            .flatten()
            .find(|part| part.to_f64() == value)
            .cloned()
            .or_else(|| Number::from_f64(value))
            .unwrap_or_else(|| Number::int(0))
    }

    /// A bound that keeps a sample out and all own samples in.
    fn bound(
        &self,
        feature: &Feature,
        owner: Option<usize>,
        p: Point,
        own: &[Point],
    ) -> Option<Bound> {
        let other = match owner {
            Some(place) => self.features[place].clone(),
            None => Feature::Piece(self.outer(p)?),
        };
        let mut choices: Vec<Curve> = self.between(feature, &other);
        if let Feature::Piece(piece) = *feature {
            choices.extend([0, 1].map(|end| Curve::Before { piece, end }));
        }
        choices.push(Curve::Nearer { this: feature.clone(), other: other.clone() });
        if owner.is_none() {
            choices.push(Curve::Inside(other.clone()));
        }
        // Any other feature that the point is nearer to, or beyond, may do as well.
        for rest in &self.features {
            choices.push(Curve::Nearer { this: feature.clone(), other: rest.clone() });
        }
        if owner.is_none() {
            choices.extend((0..self.outline.len()).map(|k| Curve::Inside(Feature::Piece(k))));
        }
        choices.retain(|curve| !curve.holds(self, p));
        let keeps = |bound: &Bound| own.iter().all(|q| bound.holds(self, *q));
        if let Some(curve) = choices.iter().find(|curve| keeps(&Bound::one((*curve).clone()))) {
            return Some(Bound::one(curve.clone()));
        }
        // Only where the other is in reach does it bound.
        let mut guards = Vec::new();
        let near = [&other, feature].into_iter().chain(&self.features);
        for some in near {
            if let Feature::Piece(piece) = *some {
                guards.extend([0, 1].map(|end| Curve::Past { piece, end }));
                guards.extend([0, 1].map(|end| Curve::Before { piece, end }));
            }
        }
        guards.extend(choices.iter().cloned());
        for curve in &choices {
            for guard in guards.iter().filter(|guard| !guard.holds(self, p)) {
                let bound = Bound(vec![curve.clone(), guard.clone()]);
                if keeps(&bound) {
                    return Some(bound);
                }
            }
        }
        None
    }

    /// The curve between neighbours that a comparison of distances would only touch: the normal at
    /// their common end.
    fn between(&self, feature: &Feature, other: &Feature) -> Vec<Curve> {
        match (feature, other) {
            (Feature::Piece(piece), Feature::Corner(behind)) => self
                .beside(*behind)
                .into_iter()
                .flatten()
                .filter(|(beside, _)| beside == piece)
                .map(|(piece, end)| Curve::Before { piece, end })
                .collect(),
            (Feature::Corner(behind), Feature::Piece(piece)) => self
                .beside(*behind)
                .into_iter()
                .flatten()
                .filter(|(beside, _)| beside == piece)
                .map(|(piece, end)| Curve::Past { piece, end })
                .collect(),
            (Feature::Piece(a), Feature::Piece(b)) => {
                let (low, high) = (*a.min(b), *a.max(b));
                let tangent = high == low + 1
                    && turn(self.outline[low].tangent(true), self.outline[high].tangent(false))
                        == 0.0;
                let end = usize::from(*a == low);
                if tangent { vec![Curve::Before { piece: *a, end }] } else { Vec::new() }
            }
            _ => Vec::new(),
        }
    }
}

/// The direction to a feature's surface, before it is made a unit vector.
pub(crate) fn course(graph: &mut Graph, outline: &[Segment], feature: &Feature) -> Option<[Id; 2]> {
    let from = |graph: &mut Graph, place: &Place| {
        let here = [Coord::D, Coord::Z].map(|coord| graph.coord(coord));
        let there = place.clone().map(|part| graph.number(part));
        [graph.sub(here[0], there[0]), graph.sub(here[1], there[1])]
    };
    Some(match feature {
        Feature::Piece(index) => match &outline[*index].circle {
            None => {
                let [d, z] = outline[*index].direction()?;
                [graph.number(z), graph.number(-&d)]
            }
            Some(circle) => {
                let away = from(graph, &circle.centre);
                if circle.convex { away } else { away.map(|part| graph.neg(part)) }
            }
        },
        Feature::Corner(behind) => {
            let place = match behind {
                Some(piece) => &outline[*piece].to,
                None => &outline.first()?.from,
            };
            from(graph, place).map(|part| graph.neg(part))
        }
    })
}
