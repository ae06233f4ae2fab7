//! The nearest feature of a restated profile, with 256 bits.
//!
//! Candidates for the nearest piece are found in doubles, with a margin of 1e-9 of the tool's size, a million times
//! the error of doubles. All results are computed from these pieces with 256 bits.

use super::big::Big;
use super::piece::Piece;
use super::profile::{Feature, Profile, Turn};
use super::restated::{Point, Restated};
use super::{Meridian, Nearest};

/// Margin, as a fraction of the tool's size, by which a piece may be farther than the nearest in doubles and is
/// still considered.
const BORDER_MARGIN: f64 = 1e-9;

/// A point, and the half plane through it and the axis.
pub struct QueryPoint {
    dz: Point,
    /// Unit vector away from the axis; +x on the axis.
    radial: [Big; 2],
    dz_f64: [f64; 2],
}

impl QueryPoint {
    /// Creates the point with these coordinates, taken exactly.
    pub fn new(p: [f64; 3]) -> Self {
        Self::of(p.map(Big::exactly))
    }

    /// Creates the point with coordinates of 256 bits.
    pub fn of([x, y, z]: [Big; 3]) -> Self {
        let dz_f64 = Meridian::of([&x, &y, &z].map(Big::to_f64)).dz;
        let d = (&(&x * &x) + &(&y * &y)).sqrt();
        let radial =
            if d == Big::zero() { [Big::exactly(1.0), Big::zero()] } else { [&x / &d, &y / &d] };
        Self { dz: [d, z], radial, dz_f64 }
    }
}

/// A tool's profile with 256 bits.
pub struct Reference {
    tool: Restated,
    segments: Vec<ExactSegment>,
    /// The turn of the profile behind each piece.
    turns: Vec<Turn>,
    owners: Vec<Feature>,
    size: f64,
}

struct ExactSegment {
    piece: Piece,
    a: Point,
    b: Point,
    shape: Shape,
}

enum Shape {
    Line {
        along: Point,
        length: Big,
    },
    Arc {
        centre: Point,
        radius: Big,
        /// Counter-clockwise: bulging out of the material.
        convex: bool,
    },
}

/// The distance to a piece.
struct SegmentDistance {
    distance: Big,
    /// `None` if the foot is an end of the piece; otherwise true if the point is on its inner side.
    side: Option<bool>,
}

fn sub(a: &Point, b: &Point) -> Point {
    [&a[0] - &b[0], &a[1] - &b[1]]
}

fn dot(a: &Point, b: &Point) -> Big {
    &(&a[0] * &b[0]) + &(&a[1] * &b[1])
}

fn cross(a: &Point, b: &Point) -> Big {
    &(&a[0] * &b[1]) - &(&a[1] * &b[0])
}

fn norm(a: &Point) -> Big {
    dot(a, a).sqrt()
}

fn double(p: &Point) -> [f64; 2] {
    [p[0].to_f64(), p[1].to_f64()]
}

impl ExactSegment {
    fn distance(&self, p: &Point) -> SegmentDistance {
        let ends = || {
            let [a, b] = [&self.a, &self.b].map(|end| norm(&sub(p, end)));
            SegmentDistance { distance: if b < a { b } else { a }, side: None }
        };
        let zero = Big::zero();
        let faces = match &self.shape {
            Shape::Line { along, length } => {
                let t = dot(&sub(p, &self.a), along);
                t >= zero && t <= length * length
            }
            Shape::Arc { centre, convex, .. } => {
                let from = sub(p, centre);
                let first = cross(&sub(&self.a, centre), &from);
                let last = cross(&from, &sub(&self.b, centre));
                if *convex { first >= zero && last >= zero } else { first <= zero && last <= zero }
            }
        };
        if !faces {
            return ends();
        }
        let inward = self.inward(p);
        SegmentDistance { distance: inward.abs(), side: Some(!inward.is_negative()) }
    }

    /// Returns the distance of a point from the whole line or circle, positive on the inner side.
    fn inward(&self, p: &Point) -> Big {
        match &self.shape {
            Shape::Line { along, length } => &cross(along, &sub(p, &self.a)) / length,
            Shape::Arc { centre, radius, convex } => {
                let inward = radius - &norm(&sub(p, centre));
                if *convex { inward } else { -&inward }
            }
        }
    }

    /// Returns the unit vector from a point inside to its nearest point here; `None` at a centre.
    fn outward(&self, p: &Point) -> Option<Point> {
        match &self.shape {
            Shape::Line { along, length } => Some([&along[1] / length, &(-&along[0]) / length]),
            Shape::Arc { centre, convex, .. } => {
                let arm = if *convex { sub(p, centre) } else { sub(centre, p) };
                unit(&arm)
            }
        }
    }
}

fn unit(v: &Point) -> Option<Point> {
    let n = norm(v);
    (n != Big::zero()).then(|| [&v[0] / &n, &v[1] / &n])
}

impl Reference {
    /// Creates the reference of a restated tool.
    pub fn new(tool: &Restated) -> Self {
        let oracle = Nearest::new(tool);
        let profile: &Profile = oracle.profile();
        let mut at = tool.start.clone();
        let mut segments: Vec<ExactSegment> = Vec::new();
        for segment in &tool.segments {
            let shape = match &segment.centre {
                None => {
                    let along = sub(&segment.to, &at);
                    let length = norm(&along);
                    Shape::Line { along, length }
                }
                Some(centre) => {
                    let (a, b) = (sub(&at, centre), sub(&segment.to, centre));
                    let convex = !cross(&a, &b).is_negative();
                    Shape::Arc { centre: centre.clone(), radius: norm(&a), convex }
                }
            };
            let centre = segment.centre.as_ref().map(double);
            let piece = Piece::new(double(&at), double(&segment.to), centre, segments.len());
            segments.push(ExactSegment { piece, a: at, b: segment.to.clone(), shape });
            at = segment.to.clone();
        }
        let owners = profile.owners().to_vec();
        let turns = (0..segments.len()).map(|piece| profile.turn(piece)).collect();
        let largest = segments.iter().flat_map(|part| double(&part.b)).fold(0.0, f64::max);
        Self { tool: tool.clone(), segments, turns, owners, size: largest }
    }

    /// Returns the restated tool.
    pub fn tool(&self) -> &Restated {
        &self.tool
    }

    /// Returns the depth of a point: the distance to the surface, negative outside.
    pub fn depth(&self, at: &QueryPoint) -> Big {
        let distances: Vec<f64> =
            self.segments.iter().map(|part| part.piece.clamped(at.dz_f64)).collect();
        let reach =
            distances.iter().copied().fold(f64::INFINITY, f64::min) + BORDER_MARGIN * self.size;
        let mut best: Option<(SegmentDistance, usize)> = None;
        for (index, part) in
            self.segments.iter().enumerate().filter(|(k, _)| distances[*k] <= reach)
        {
            let distance = part.distance(&at.dz);
            let is_nearer = best.as_ref().is_none_or(|(best, _)| {
                distance.distance < best.distance
                    || (distance.distance == best.distance && best.side.is_none())
            });
            if is_nearer {
                best = Some((distance, index));
            }
        }
        let Some((distance, index)) = best else { return Big::zero() };
        if distance.side.unwrap_or_else(|| self.is_inside_at_end(at, index)) {
            distance.distance
        } else {
            -&distance.distance
        }
    }

    /// Returns whether a point is inside whose nearest point is an end of a piece: in the fan of a reflex corner,
    /// or where rounding alone keeps it from facing the piece.
    fn is_inside_at_end(&self, at: &QueryPoint, index: usize) -> bool {
        let part = &self.segments[index];
        let [a, b] = [&part.a, &part.b].map(|end| norm(&sub(&at.dz, end)));
        let turn = if b < a { Some(index) } else { index.checked_sub(1) };
        match turn.map(|piece| self.turns[piece]) {
            Some(Turn::Reflex(_)) => true,
            Some(Turn::Smooth) => !part.inward(&at.dz).is_negative(),
            Some(Turn::Convex | Turn::Axis) | None => false,
        }
    }

    /// Returns the owner of a point of the solid: the nearest feature. Among equals a corner comes before the
    /// pieces that end in it, otherwise the first listed. `None` outside.
    pub fn owner(&self, at: &QueryPoint) -> Option<usize> {
        let depth = self.depth(at);
        if depth.is_negative() {
            return None;
        }
        let reach = depth.to_f64() + BORDER_MARGIN * self.size;
        let is_near = |owner: &usize| match self.owners[*owner] {
            Feature::Piece(piece) | Feature::Corner(piece) => {
                self.segments[piece].piece.clamped(at.dz_f64) <= reach
            }
        };
        let mut best: Option<(Big, bool, usize)> = None;
        for owner in (0..self.owners.len()).filter(is_near) {
            let is_piece = matches!(self.owners[owner], Feature::Piece(_));
            let distance = self.distance_to(at, owner);
            let is_nearer = best.as_ref().is_none_or(|(min_distance, is_best_piece, _)| {
                distance < *min_distance
                    || (distance == *min_distance && *is_best_piece && !is_piece)
            });
            if is_nearer {
                best = Some((distance, is_piece, owner));
            }
        }
        best.map(|(.., owner)| owner)
    }

    /// Returns the distance to an owner: a piece with its ends, or a corner.
    pub fn distance_to(&self, at: &QueryPoint, owner: usize) -> Big {
        match self.owners[owner] {
            Feature::Piece(piece) => self.segments[piece].distance(&at.dz).distance,
            Feature::Corner(piece) => norm(&sub(&at.dz, &self.segments[piece].b)),
        }
    }

    /// Returns the unit vector from a point that an owner owns to its nearest point of the surface; where there is
    /// none, +z.
    pub fn direction(&self, at: &QueryPoint, owner: usize) -> [Big; 3] {
        let outward = match self.owners[owner] {
            Feature::Piece(piece) => self.segments[piece].outward(&at.dz),
            Feature::Corner(piece) => unit(&sub(&self.segments[piece].b, &at.dz)),
        };
        let [d, z] = outward.unwrap_or_else(|| [Big::zero(), Big::exactly(1.0)]);
        [&d * &at.radial[0], &d * &at.radial[1], z]
    }

    /// Returns the distance from a point to the nearest one at which its owner's direction does not exist.
    pub fn singularity_distance(&self, at: &QueryPoint, owner: usize) -> f64 {
        let (distance, level) = match self.owners[owner] {
            Feature::Piece(piece) => match &self.segments[piece].shape {
                Shape::Line { along, .. } => (f64::INFINITY, along[1] == Big::zero()),
                Shape::Arc { centre, .. } => (norm(&sub(&at.dz, centre)).to_f64(), false),
            },
            Feature::Corner(piece) => (norm(&sub(&at.dz, &self.segments[piece].b)).to_f64(), false),
        };
        if level { distance } else { distance.min(at.dz[0].to_f64()) }
    }

    /// Returns the next power of two above the tool's largest coordinate, S; errors are measured in ulp(S).
    pub fn scale(&self) -> f64 {
        let mut scale = 2f64.powi(self.size.log2().floor() as i32);
        while scale <= self.size {
            scale *= 2.0;
        }
        scale
    }
}

#[cfg(test)]
mod tests {
    use super::super::rng::Rng;
    use super::super::{Oracle, restated};
    use super::*;

    #[test]
    fn doubles_agree_with_256_bits() {
        for tool in restated::all() {
            let (oracle, reference) = (Nearest::new(&tool), Reference::new(&tool));
            let [radius, height] = oracle.extent();
            let size = radius.max(height);
            let mut rng = Rng::new(8);
            for _ in 0..300 {
                let [x, y] = [0; 2].map(|_| rng.between(-1.1 * radius, 1.1 * radius));
                let p = [x, y, rng.between(-0.1 * height, 1.1 * height)];
                let at = QueryPoint::new(p);
                let depth = reference.depth(&at).to_f64();
                let expected = -oracle.signed_distance(p);
                assert!((depth - expected).abs() < 1e-13 * size, "{} {p:?}", tool.name);
                let Some(evaluation) = oracle.evaluate(p) else { continue };
                let distance = reference.distance_to(&at, evaluation.owner).to_f64();
                assert!((distance - depth).abs() < 1e-13 * size, "{} {p:?}", tool.name);
                assert!(
                    (reference.singularity_distance(&at, evaluation.owner)
                        - oracle.singularity_distance(p))
                    .abs()
                        < 1e-12 * size
                        || oracle.singularity_distance(p) == f64::INFINITY
                );
                let u = reference.direction(&at, evaluation.owner);
                for (u, v) in u.iter().zip(evaluation.direction) {
                    assert!((u.to_f64() - v).abs() < 1e-9, "{} {p:?}", tool.name);
                }
            }
        }
    }
}
