//! Solids without an axis: a block, and an L-bracket with a hole, by their faces. Inside, the depth of a point is its
//! distance to the nearest face of its zone; outside, its distance is that to boxes and to the hole.

use super::real::Real;
use super::rng::Rng;
use super::{Oracle, OracleEvaluation};
use std::sync::OnceLock;

/// A point in space.
type P3<T> = [T; 3];

/// A solid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Body {
    /// The block of 40 × 30 × 20, standing on the middle of its underside.
    Block,
    /// The bracket: legs of 30 along x and 24 along z, 20 wide, 6 thick, with a hole of radius 3.3 through the lying
    /// leg, 10 from the origin.
    LBracket,
}

/// The nearest feature of a region.
#[derive(Clone, Copy, Debug)]
pub enum Face {
    /// The plane on which a coordinate equals a number, and the side of the material. The depth is `sign * (coordinate -
    /// number)`.
    Plane(usize, f64, f64),
    /// Both planes `y = ±10`.
    Sides,
    /// The wall of the hole.
    Bore,
    /// The inner edge.
    Edge,
}

/// The zone of the solid in which a region may lie.
#[derive(Clone, Copy, PartialEq)]
enum Zone {
    Anywhere,
    /// The horizontal leg, up to the inner edge.
    Lying,
    /// The part below and behind the inner edge.
    Heel,
    /// The vertical leg, from the inner edge upward.
    Standing,
}

/// The standing leg's inner face and the lying leg's upper one, which meet in the inner edge.
const WALL: f64 = -4.0;
const LEDGE: f64 = 6.0;
/// The hole's axis and radius.
const BORE: f64 = 10.0;
const BORE_RADIUS: f64 = 3.3;

const BLOCK: [(&str, Zone, Face); 6] = [
    ("left", Zone::Anywhere, Face::Plane(0, -20.0, 1.0)),
    ("right", Zone::Anywhere, Face::Plane(0, 20.0, -1.0)),
    ("front", Zone::Anywhere, Face::Plane(1, -15.0, 1.0)),
    ("back", Zone::Anywhere, Face::Plane(1, 15.0, -1.0)),
    ("bottom", Zone::Anywhere, Face::Plane(2, 0.0, 1.0)),
    ("top", Zone::Anywhere, Face::Plane(2, 20.0, -1.0)),
];

const BRACKET: [(&str, Zone, Face); 13] = [
    ("lying_bottom", Zone::Lying, Face::Plane(2, 0.0, 1.0)),
    ("lying_top", Zone::Lying, Face::Plane(2, LEDGE, -1.0)),
    ("lying_end", Zone::Lying, Face::Plane(0, 20.0, -1.0)),
    ("lying_side", Zone::Lying, Face::Sides),
    ("bore", Zone::Lying, Face::Bore),
    ("heel_bottom", Zone::Heel, Face::Plane(2, 0.0, 1.0)),
    ("heel_back", Zone::Heel, Face::Plane(0, -10.0, 1.0)),
    ("heel_side", Zone::Heel, Face::Sides),
    ("heel_edge", Zone::Heel, Face::Edge),
    ("standing_back", Zone::Standing, Face::Plane(0, -10.0, 1.0)),
    ("standing_inner", Zone::Standing, Face::Plane(0, WALL, -1.0)),
    ("standing_side", Zone::Standing, Face::Sides),
    ("standing_top", Zone::Standing, Face::Plane(2, 24.0, -1.0)),
];

/// Returns the vector from the hole's axis.
fn from_bore_axis<T: Real>(p: &P3<T>) -> [T; 2] {
    [p[0].minus(&T::exactly(BORE)), p[1].clone()]
}

/// Returns the vector from the inner edge.
fn from_edge<T: Real>(p: &P3<T>) -> [T; 2] {
    [p[0].minus(&T::exactly(WALL)), p[2].minus(&T::exactly(LEDGE))]
}

impl Face {
    /// Returns the signed distance inside the face, which is the depth of its region; for the edge, the distance from it.
    pub fn inward<T: Real>(self, p: &P3<T>) -> T {
        match self {
            Face::Plane(axis, at, sign) => T::exactly(sign).times(&p[axis].minus(&T::exactly(at))),
            Face::Sides => T::exactly(10.0).minus(&p[1].absolute()),
            Face::Bore => {
                let [x, y] = from_bore_axis(p);
                x.hypot(&y).minus(&T::decimal(BORE_RADIUS))
            }
            Face::Edge => {
                let [x, z] = from_edge(p);
                x.hypot(&z)
            }
        }
    }

    /// Returns the unit vector from a point inside to the face.
    pub fn direction<T: Real>(self, p: &P3<T>) -> P3<T> {
        match self {
            Face::Plane(axis, _, sign) => {
                std::array::from_fn(|k| T::exactly(if k == axis { -sign } else { 0.0 }))
            }
            Face::Sides => {
                let sign = if p[1] < T::zero() { -1.0 } else { 1.0 };
                [0.0, sign, 0.0].map(T::exactly)
            }
            Face::Bore => {
                let [x, y] = from_bore_axis(p);
                let norm = x.hypot(&y);
                [x.negated().over(&norm), y.negated().over(&norm), T::zero()]
            }
            Face::Edge => {
                let [x, z] = from_edge(p);
                match x.hypot(&z) {
                    norm if norm == T::zero() => [0.0, 0.0, 1.0].map(T::exactly),
                    norm => [x.negated().over(&norm), T::zero(), z.negated().over(&norm)],
                }
            }
        }
    }

    /// Returns the distance to the nearest point at which the direction is undefined, or for which another direction is
    /// equally good.
    pub fn singularity_distance<T: Real>(self, p: &P3<T>) -> f64 {
        let [a, b] = match self {
            Face::Plane(..) | Face::Sides => return f64::INFINITY,
            Face::Bore => from_bore_axis(p),
            Face::Edge => from_edge(p),
        };
        a.hypot(&b).to_f64()
    }
}

impl Zone {
    /// Returns the distance by which a point is outside the zone.
    fn distance<T: Real>(self, p: &P3<T>) -> T {
        let [beyond_wall, above_ledge] = from_edge(p);
        let signed = match self {
            Zone::Anywhere => T::zero(),
            Zone::Lying => beyond_wall.negated(),
            Zone::Heel => beyond_wall.most(above_ledge),
            Zone::Standing => beyond_wall.most(above_ledge.negated()),
        };
        signed.most(T::zero())
    }
}

impl Body {
    fn faces(self) -> &'static [(&'static str, Zone, Face)] {
        match self {
            Body::Block => &BLOCK,
            Body::LBracket => &BRACKET,
        }
    }

    /// Returns the nearest region of a zone and the depth there, negative outside, and the same of the next.
    fn nearest_two<T: Real>(self, zone: Zone, p: &P3<T>) -> Option<[(usize, T); 2]> {
        let own = self.faces().iter().enumerate().filter(|(_, (_, other, _))| *other == zone);
        let mut all: Vec<(usize, T)> =
            own.map(|(region, (.., face))| (region, face.inward(p))).collect();
        all.sort_by(|a, b| a.1.partial_cmp(&b.1).expect("a number"));
        let mut all = all.into_iter();
        Some([all.next()?, all.next()?])
    }

    fn ranked<T: Real>(self, p: &P3<T>) -> [(usize, T); 2] {
        let zones = [Zone::Anywhere, Zone::Lying, Zone::Heel, Zone::Standing];
        let own = zones.into_iter().filter(|zone| zone.distance(p) == T::zero());
        let ranked = own.filter_map(|zone| self.nearest_two(zone, p));
        let deeper = |a: [(usize, T); 2], b: [(usize, T); 2]| if b[0].1 > a[0].1 { b } else { a };
        ranked.reduce(deeper).expect("every place is in a zone that has faces")
    }

    /// Returns the region of the nearest face in the point's zone, among equals the first listed, and the depth of the
    /// point, negative outside. Zones meet in planes; there the zone counts in which the point is deeper.
    pub fn nearest<T: Real>(self, p: &P3<T>) -> (usize, T) {
        let [nearest, _] = self.ranked(p);
        nearest
    }

    /// Returns the depth of a point; minus the distance outside.
    pub fn depth<T: Real>(self, p: &P3<T>) -> T {
        let (_, inward) = self.nearest(p);
        if inward < T::zero() { self.distance_outside(p).negated() } else { inward }
    }

    /// Returns the face of a region.
    pub fn face(self, region: usize) -> Face {
        self.faces()[region].2
    }

    /// Returns the distance by which a point misses a region: beyond the border to a neighbouring zone, at least its
    /// distance from the zone.
    pub fn excess_distance<T: Real>(self, region: usize, p: &P3<T>) -> T {
        let excess = self.face(region).inward(p).minus(&self.nearest(p).1).absolute();
        excess.most(self.faces()[region].1.distance(p))
    }

    /// Returns the distance from a point outside to the boxes of the solid, or to the hole if that is nearest.
    fn distance_outside<T: Real>(self, p: &P3<T>) -> T {
        let to_box = |low: [f64; 3], high: [f64; 3]| {
            let outside = |k: usize| {
                let below = T::exactly(low[k]).minus(&p[k]);
                below.most(p[k].minus(&T::exactly(high[k]))).most(T::zero())
            };
            outside(0).hypot(&outside(1)).hypot(&outside(2))
        };
        let [low, high] = self.bounds();
        if self == Body::Block {
            return to_box(low, high);
        }
        let lying = to_box(low, [high[0], high[1], LEDGE]);
        let standing = to_box(low, [WALL, high[1], high[2]]);
        let [x, y] = from_bore_axis(p);
        // Over the hole, its rim is the nearest point of the horizontal leg.
        let bore = T::decimal(BORE_RADIUS).minus(&x.hypot(&y)).most(T::zero());
        bore.hypot(&lying).least(standing)
    }

    /// Returns the least and the largest coordinates.
    fn bounds(self) -> [P3<f64>; 2] {
        match self {
            Body::Block => [[-20.0, -15.0, 0.0], [20.0, 15.0, 20.0]],
            Body::LBracket => [[-10.0, -10.0, 0.0], [20.0, 10.0, 24.0]],
        }
    }

    /// Returns points on borders, found by bisection between points of which one is inside and the other has
    /// another owner or none.
    fn borders(self) -> Vec<Vec<P3<f64>>> {
        let owner = |p: P3<f64>| self.evaluate(p).map(|evaluation| evaluation.owner);
        let [low, high] = self.bounds();
        let mut rng = Rng::new(77);
        let mut random_point = || [0, 1, 2].map(|k| rng.between(low[k] - 1.0, high[k] + 1.0));
        let mut points = Vec::new();
        while points.len() < 16 * 66 {
            let (mut a, mut b) = (random_point(), random_point());
            let first = owner(a);
            if first == owner(b) {
                continue;
            }
            for _ in 0..60 {
                let middle = [0, 1, 2].map(|k| (a[k] + b[k]) / 2.0);
                if owner(middle) == first { a = middle } else { b = middle }
            }
            points.push(if first.is_some() { a } else { b });
        }
        points.chunks(66).map(<[P3<f64>]>::to_vec).collect()
    }
}

impl Oracle for Body {
    fn name(&self) -> &'static str {
        match self {
            Body::Block => "Block",
            Body::LBracket => "LBracket",
        }
    }

    fn regions(&self) -> Vec<&str> {
        self.faces().iter().map(|(name, ..)| *name).collect()
    }

    fn evaluate(&self, p: P3<f64>) -> Option<OracleEvaluation> {
        let (owner, depth) = self.nearest(&p);
        (depth >= 0.0).then(|| {
            let direction = self.face(owner).direction(&p);
            OracleEvaluation { owner, depth, magnitude: depth, direction, niceness: 0.0 }
        })
    }

    fn signed_distance(&self, p: P3<f64>) -> f64 {
        -self.depth(&p)
    }

    fn border_distance(&self, p: P3<f64>) -> f64 {
        let [(region, depth), (_, next)] = self.ranked(&p);
        if depth < 0.0 {
            return self.distance_outside(&p);
        }
        // A step changes each distance by at most its own length.
        let border = depth.min((next - depth) / 2.0);
        if self.faces()[region].1 == Zone::Anywhere {
            return border;
        }
        let [wall, ledge] = from_edge(&p);
        let other_zones = if wall <= 0.0 { wall.abs().min(ledge.abs()) } else { wall };
        border.min(other_zones)
    }

    fn singularity_distance(&self, p: P3<f64>) -> f64 {
        let owner = self.evaluate(p).map(|evaluation| evaluation.owner);
        owner.map_or(f64::INFINITY, |owner| self.face(owner).singularity_distance(&p))
    }

    fn is_revolved(&self) -> bool {
        false
    }

    fn corner_points(&self) -> Vec<P3<f64>> {
        if *self == Body::Block {
            // Vertices, middles of edges and faces, and the ends of the ridges inside.
            let mut all = grid(&[-20.0, 0.0, 20.0], &[-15.0, 0.0, 15.0], &[0.0, 10.0, 20.0]);
            all.extend(grid(&[-10.0, 10.0], &[-5.0, 5.0], &[10.0]));
            return all;
        }
        let across = [-10.0, 0.0, 10.0];
        let mut all = grid(&[-10.0, -7.0, WALL, 5.0, 20.0], &across, &[0.0, 3.0, LEDGE]);
        all.extend(grid(&[-10.0, -7.0, WALL], &across, &[15.0, 24.0]));
        // The rim of the hole, and points half way up its wall.
        for k in 0..16 {
            let (sin, cos) = (f64::from(k) * std::f64::consts::FRAC_PI_8).sin_cos();
            let at = |z: f64| [BORE + BORE_RADIUS * cos, BORE_RADIUS * sin, z];
            all.extend([0.0, 3.0, LEDGE].map(at));
        }
        all
    }

    fn curve_points(&self) -> Vec<Vec<P3<f64>>> {
        static FOUND: [OnceLock<Vec<Vec<P3<f64>>>>; 2] = [const { OnceLock::new() }; 2];
        FOUND[*self as usize].get_or_init(|| self.borders()).clone()
    }

    fn extent(&self) -> [f64; 2] {
        match self {
            Body::Block => [25.0, 20.0],
            Body::LBracket => [500f64.sqrt(), 24.0],
        }
    }
}

/// Returns every combination of one number per axis.
fn grid(x: &[f64], y: &[f64], z: &[f64]) -> Vec<P3<f64>> {
    let column = |x: f64, y: f64| z.iter().map(move |z| [x, y, *z]);
    x.iter().flat_map(|x| y.iter().flat_map(move |y| column(*x, *y))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Inside the hole the wall is nearest, and below the hole its rim.
    #[test]
    fn distances_outside_are_those_to_the_nearest_face_or_edge() {
        for (body, p, distance) in [
            (Body::Block, [23.0, 19.0, 10.0], 5.0),
            (Body::LBracket, [10.0, 1.0, 3.0], 2.3),
            (Body::LBracket, [10.0, 1.0, -1.0], 2.3f64.hypot(1.0)),
        ] {
            assert!((body.signed_distance(p) - distance).abs() < 1e-15, "{body:?} {p:?}");
        }
    }

    /// The depth of a point is the distance to the nearest point of the other side, by steps along the axes and to the
    /// corners: no step shorter than the depth leaves the solid, and some step a little longer does.
    #[test]
    fn depths_are_distances() {
        let mut rng = Rng::new(3);
        for body in [Body::Block, Body::LBracket] {
            let [low, high] = body.bounds();
            for _ in 0..4_000 {
                let p = [0, 1, 2].map(|k| rng.between(low[k] - 2.0, high[k] + 2.0));
                let depth = body.depth(&p);
                let step = |by: f64, u: P3<f64>| [0, 1, 2].map(|k| p[k] + by * u[k]);
                for _ in 0..8 {
                    let q = step(0.999_999 * depth.abs(), rng.direction());
                    assert_eq!(body.depth(&q) >= 0.0, depth >= 0.0, "{body:?} {p:?} {q:?}");
                }
                if depth >= 0.0 {
                    let (owner, _) = body.nearest(&p);
                    let q = step(depth + 1e-9, body.face(owner).direction(&p));
                    assert!(body.depth(&q) < 0.0, "{body:?} {p:?} {q:?}");
                }
            }
        }
    }
}
