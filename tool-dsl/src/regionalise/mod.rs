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

pub(crate) mod outline;

use crate::expr::{Coord, Graph, Id};
use outline::{Place, Point, Segment, doubles, minus, norm, turn};

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

/// Why a profile could not be divided, with the place where it was noticed.
pub(crate) struct Undivided(pub(crate) Point);

/// The outline with its features.
struct Section<'o> {
    outline: &'o [Segment],
    features: Vec<Feature>,
}

/// Divides the inside of an outline.
pub(crate) fn nearest(graph: &mut Graph, outline: &[Segment]) -> Result<Vec<Derived>, Undivided> {
    let section = Section { outline, features: features(outline) };
    let samples: Vec<(Point, Option<usize>)> =
        samples(outline).into_iter().map(|p| (p, section.owner(p))).collect();
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

impl Section<'_> {
    fn corner(&self, behind: Option<usize>) -> &Place {
        match behind {
            Some(piece) => &self.outline[piece].to,
            None => &self.outline[0].from,
        }
    }

    /// The feature that a point of the inside is nearest to; `None` outside. By distances alone.
    fn owner(&self, p: Point) -> Option<usize> {
        let mut best: Option<(f64, Option<usize>)> = None;
        let mut offer = |distance: f64, owner: Option<usize>| {
            // What is as near as a corner's own pieces is the corner's only if it is nearer.
            if best.is_none_or(|(least, _)| distance < least) {
                best = Some((distance, owner));
            }
        };
        for (place, feature) in self.features.iter().enumerate() {
            if let Feature::Piece(index) = feature {
                let segment = &self.outline[*index];
                if segment.sector(p).iter().all(|side| *side >= 0.0) {
                    let depth = segment.signed(p);
                    offer(depth.abs(), (depth >= 0.0).then_some(place));
                }
            }
        }
        let corners = std::iter::once(None).chain((0..self.outline.len()).map(Some));
        for behind in corners {
            let owner = self
                .features
                .iter()
                .position(|feature| matches!(feature, Feature::Corner(other) if *other == behind));
            offer(norm(minus(p, doubles(self.corner(behind)))), owner);
        }
        best.and_then(|(_, owner)| owner)
    }

    /// The piece whose outer side a point outside is on.
    fn outer(&self, p: Point) -> Option<usize> {
        let distance = |index: &usize| {
            let segment = &self.outline[*index];
            let [before, after] = segment.sector(p);
            let end = if before < 0.0 {
                Some(&segment.from)
            } else if after < 0.0 {
                Some(&segment.to)
            } else {
                None
            };
            end.map_or(segment.signed(p).abs(), |end| norm(minus(p, doubles(end))))
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
            Feature::Corner(behind) => norm(minus(p, doubles(self.corner(*behind)))),
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
        if let Feature::Piece(_) = feature {
            bounds.push(Bound::one(Curve::Inside(feature.clone())));
        } else if let Feature::Corner(behind) = feature {
            // A corner's fan lies between the normals of its pieces.
            for (piece, end) in self.beside(behind).into_iter().flatten() {
                bounds.push(Bound::one(Curve::Past { piece, end }));
            }
        }
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
        for index in (0..bounds.len()).rev() {
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
        Ok(Derived { feature, conditions, depth })
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
        choices.retain(|curve| !curve.holds(self, p));
        let keeps = |bound: &Bound| own.iter().all(|q| bound.holds(self, *q));
        if let Some(curve) = choices.iter().find(|curve| keeps(&Bound::one((*curve).clone()))) {
            return Some(Bound::one(curve.clone()));
        }
        // Only where the other is in reach does it bound.
        let mut guards = Vec::new();
        for some in [&other, feature] {
            if let Feature::Piece(piece) = *some {
                guards.extend([0, 1].map(|end| Curve::Past { piece, end }));
                guards.extend([0, 1].map(|end| Curve::Before { piece, end }));
            }
        }
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

/// A side of a curve, by its meaning.
#[derive(Clone, Debug)]
enum Curve {
    /// On the material's side of a piece's whole line or circle.
    Inside(Feature),
    /// Not beyond the normal at an end of a piece (0 its start, 1 its end).
    Before { piece: usize, end: usize },
    /// Beyond it.
    Past { piece: usize, end: usize },
    /// No nearer to another feature.
    Nearer { this: Feature, other: Feature },
}

impl Curve {
    fn holds(&self, section: &Section<'_>, p: Point) -> bool {
        match self {
            Curve::Inside(feature) => section.depth_at(feature, p) >= 0.0,
            Curve::Before { piece, end } => section.outline[*piece].sector(p)[*end] >= 0.0,
            Curve::Past { piece, end } => section.outline[*piece].sector(p)[*end] <= 0.0,
            Curve::Nearer { this, other } => {
                section.depth_at(this, p) <= section.depth_at(other, p)
            }
        }
    }

    /// The expression that is at most 0 on this side.
    fn side(&self, section: &Section<'_>, graph: &mut Graph) -> Option<Id> {
        match self {
            Curve::Inside(feature) => {
                let depth = section.depth(graph, feature)?;
                Some(graph.neg(depth))
            }
            Curve::Before { piece, end } => {
                let side = section.outline[*piece].sides(graph)?[*end];
                Some(graph.neg(side))
            }
            Curve::Past { piece, end } => Some(section.outline[*piece].sides(graph)?[*end]),
            Curve::Nearer { this, other } => section.comparison(graph, this, other),
        }
    }
}

impl Section<'_> {
    /// An expression that is at most 0 where one feature is no farther than another, inside. A
    /// corner and a line, or two corners, need no root.
    fn comparison(&self, graph: &mut Graph, this: &Feature, other: &Feature) -> Option<Id> {
        let line = |feature: &Feature| match feature {
            Feature::Piece(index) => self.outline[*index].circle.is_none(),
            Feature::Corner(_) => false,
        };
        match (this, other) {
            (Feature::Corner(a), Feature::Corner(b)) => {
                let a = outline::squared(graph, self.corner(*a));
                let b = outline::squared(graph, self.corner(*b));
                Some(graph.sub(a, b))
            }
            (Feature::Corner(corner), piece) if line(piece) => {
                let away = outline::squared(graph, self.corner(*corner));
                let depth = self.depth(graph, piece)?;
                let square = graph.mul(depth, depth);
                Some(graph.sub(away, square))
            }
            (piece, Feature::Corner(corner)) if line(piece) => {
                let away = outline::squared(graph, self.corner(*corner));
                let depth = self.depth(graph, piece)?;
                let square = graph.mul(depth, depth);
                Some(graph.sub(square, away))
            }
            _ => {
                let (this, other) = (self.depth(graph, this)?, self.depth(graph, other)?);
                Some(graph.sub(this, other))
            }
        }
    }
}

/// One of these sides holds.
#[derive(Clone, Debug)]
struct Bound(Vec<Curve>);

impl Bound {
    fn one(curve: Curve) -> Bound {
        Bound(vec![curve])
    }

    fn holds(&self, section: &Section<'_>, p: Point) -> bool {
        self.0.iter().any(|curve| curve.holds(section, p))
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

/// Points of the section and its surroundings: spread evenly, and close to every piece and corner.
fn samples(outline: &[Segment]) -> Vec<Point> {
    const EVEN: usize = 6000;
    let points: Vec<Point> = outline.iter().flat_map(outline::along).collect();
    let [mut low, mut high] = [[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]];
    for p in &points {
        for k in 0..2 {
            low[k] = low[k].min(p[k]);
            high[k] = high[k].max(p[k]);
        }
    }
    let size = norm(minus(high, low));
    let (a, b) = (0.754_877_666_246_693, 0.569_840_290_998_053);
    let mut samples: Vec<Point> = (1..=EVEN)
        .map(|k| {
            let (u, v) = ((a * k as f64).fract(), (b * k as f64).fract());
            let margin = 0.15 * size;
            [u * (high[0] + margin), low[1] - margin + v * (high[1] - low[1] + 2.0 * margin)]
        })
        .collect();
    let around = points.windows(2).flat_map(|pair| {
        let (from, way) = (pair[0], minus(pair[1], pair[0]));
        (0..=24).map(move |k| {
            let t = f64::from(k) / 24.0;
            [from[0] + t * way[0], from[1] + t * way[1]]
        })
    });
    for (k, p) in around.enumerate() {
        for (step, power) in [-0.9, -1.6, -2.4, -3.3].into_iter().enumerate() {
            let reach = size * 10f64.powf(power);
            for turn in 0..6 {
                let angle = (k * 7 + step * 3) as f64 * 0.618 + f64::from(turn) * 1.047_197_551;
                let q = [p[0] + reach * angle.cos(), p[1] + reach * angle.sin()];
                if q[0] >= 0.0 {
                    samples.push(q);
                }
            }
        }
    }
    samples
}
