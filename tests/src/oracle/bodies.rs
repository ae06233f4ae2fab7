//! Solids without an axis: a block, and an L-bracket with a hole. Their surfaces are patches. The depth of a point
//! is its distance to the nearest patch, found by clamping to each. Splitting surfaces are used only to bound
//! [`Oracle::border_distance`].

use super::rng::Rng;
use super::{Oracle, OracleEvaluation};
use std::sync::OnceLock;

type P3 = [f64; 3];

/// A patch of a surface.
#[derive(Clone, Copy, Debug)]
enum Patch {
    /// The rectangle from `low` to `high`, which are equal along `axis`, except for a hole through it.
    Plate { axis: usize, out: f64, low: P3, high: P3, hole: Option<Hole> },
    /// The wall of a hole, from z = 0 to a height; the material is around it.
    Bore { hole: Hole, height: f64 },
}

/// A round hole along z.
#[derive(Clone, Copy, Debug)]
struct Hole {
    centre: [f64; 2],
    radius: f64,
}

impl Hole {
    fn offset(&self, p: P3) -> [f64; 2] {
        [p[0] - self.centre[0], p[1] - self.centre[1]]
    }

    /// Returns the point of the rim, or wall, that is nearest to `p`.
    fn rim(&self, p: P3) -> P3 {
        let [x, y] = self.offset(p);
        let part = self.radius / x.hypot(y);
        [self.centre[0] + part * x, self.centre[1] + part * y, p[2]]
    }
}

impl Patch {
    fn plate(axis: usize, out: f64, low: P3, high: P3) -> Patch {
        assert_eq!(low[axis], high[axis]);
        Patch::Plate { axis, out, low, high, hole: None }
    }

    /// Returns the nearest point of the patch.
    fn foot(&self, p: P3) -> P3 {
        match *self {
            Patch::Plate { low, high, hole, .. } => {
                let foot = [0, 1, 2].map(|k| p[k].clamp(low[k], high[k]));
                match hole {
                    Some(hole) if length2(hole.offset(foot)) < hole.radius => hole.rim(foot),
                    _ => foot,
                }
            }
            Patch::Bore { hole, height } => {
                let [x, y, z] = hole.rim(p);
                [x, y, z.clamp(0.0, height)]
            }
        }
    }

    fn distance(&self, p: P3) -> f64 {
        match *self {
            // More accurate than by the foot.
            Patch::Bore { hole, height } => {
                let height_outside = p[2] - p[2].clamp(0.0, height);
                (length2(hole.offset(p)) - hole.radius).abs().hypot(height_outside)
            }
            Patch::Plate { .. } => {
                let foot = self.foot(p);
                let [x, y, z] = [0, 1, 2].map(|k| foot[k] - p[k]);
                x.hypot(y).hypot(z)
            }
        }
    }

    /// Returns the unit vector from a point inside to the foot; out of the material where they coincide.
    fn direction(&self, p: P3) -> P3 {
        match *self {
            Patch::Plate { axis, out, .. } => {
                let foot = self.foot(p);
                let direction = [0, 1, 2].map(|k| foot[k] - p[k]);
                if (0..3).all(|k| k == axis || direction[k] == 0.0) {
                    let mut normal = [0.0; 3];
                    normal[axis] = out;
                    return normal;
                }
                let size = direction[0].hypot(direction[1]).hypot(direction[2]);
                direction.map(|c| c / size)
            }
            Patch::Bore { hole, .. } => {
                let [x, y] = hole.offset(p);
                let size = x.hypot(y);
                [-x / size, -y / size, 0.0]
            }
        }
    }
}

fn length2([x, y]: [f64; 2]) -> f64 {
    x.hypot(y)
}

/// A region that wins a point: its index, its patch and the distance to the patch.
type Winner = (usize, Patch, f64);

/// Returns the winner of a point among candidate regions, each with its patch: the nearest, or among equals the
/// first listed. Also returns how much farther the next is.
fn nearest(candidates: impl Iterator<Item = (usize, Patch)>, p: P3) -> Option<(Winner, f64)> {
    let all: Vec<Winner> =
        candidates.map(|(region, patch)| (region, patch, patch.distance(p))).collect();
    let winner = *all.iter().min_by(|a, b| a.2.total_cmp(&b.2).then(a.0.cmp(&b.0)))?;
    let others = all.iter().filter(|other| other.0 != winner.0);
    let margin = others.fold(f64::INFINITY, |m, other| m.min(other.2 - winner.2));
    Some((winner, margin))
}

/// The queries of the two solids.
trait Body {
    const REGIONS: &'static [&'static str];
    fn inside(&self, p: P3) -> bool;
    fn patches(&self) -> Vec<Patch>;
    /// Returns the regions that may own a point inside, each with its patch.
    fn candidates(&self, p: P3) -> Vec<(usize, Patch)>;
    /// Returns the distance to points that other regions may own.
    fn distance_to_other_regions(&self, p: P3) -> f64;

    fn distance(&self, p: P3) -> f64 {
        self.patches().iter().fold(f64::INFINITY, |m, patch| m.min(patch.distance(p)))
    }

    fn winner(&self, p: P3) -> Option<(Winner, f64)> {
        if self.inside(p) { nearest(self.candidates(p).into_iter(), p) } else { None }
    }

    /// Returns points on borders, found by bisection between points of which one is inside and the other has
    /// another owner or none.
    fn borders(&self, low: P3, high: P3) -> Vec<Vec<P3>> {
        let owner = |p: P3| self.winner(p).map(|((region, ..), _)| region);
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
        points.chunks(66).map(<[P3]>::to_vec).collect()
    }
}

macro_rules! body_oracle {
    ($name:literal, $extent:expr, $low:expr, $high:expr) => {
        fn name(&self) -> &'static str {
            $name
        }
        fn regions(&self) -> Vec<&str> {
            Self::REGIONS.to_vec()
        }
        fn evaluate(&self, p: P3) -> Option<OracleEvaluation> {
            let ((owner, patch, depth), _) = self.winner(p)?;
            Some(OracleEvaluation {
                owner,
                depth,
                magnitude: depth,
                direction: patch.direction(p),
                niceness: 0.0,
            })
        }
        fn gradient(&self, p: P3) -> Option<P3> {
            Some(self.evaluate(p)?.direction.map(|c| -c))
        }
        fn signed_distance(&self, p: P3) -> f64 {
            if self.inside(p) { -self.distance(p) } else { self.distance(p) }
        }
        fn border_distance(&self, p: P3) -> f64 {
            // A step changes each distance by at most its own length.
            match self.winner(p) {
                Some(((.., depth), margin)) => {
                    depth.min(margin / 2.0).min(self.distance_to_other_regions(p))
                }
                None => self.distance(p),
            }
        }
        fn is_revolved(&self) -> bool {
            false
        }
        fn curve_points(&self) -> Vec<Vec<P3>> {
            static FOUND: OnceLock<Vec<Vec<P3>>> = OnceLock::new();
            FOUND.get_or_init(|| self.borders($low, $high)).clone()
        }
        fn extent(&self) -> [f64; 2] {
            $extent
        }
    };
}

/// Returns every combination of one number per axis.
fn grid(x: &[f64], y: &[f64], z: &[f64]) -> Vec<P3> {
    let column = |x: f64, y: f64| z.iter().map(move |z| [x, y, *z]);
    x.iter().flat_map(|x| y.iter().flat_map(move |y| column(*x, *y))).collect()
}

/// The block of 40 × 30 × 20, standing on the middle of its underside.
#[derive(Clone, Copy, Debug, Default)]
pub struct Block;

impl Body for Block {
    const REGIONS: &'static [&'static str] = &["left", "right", "front", "back", "bottom", "top"];

    fn inside(&self, [x, y, z]: P3) -> bool {
        x.abs() <= 20.0 && y.abs() <= 15.0 && (0.0..=20.0).contains(&z)
    }

    fn patches(&self) -> Vec<Patch> {
        let (low, high) = ([-20.0, -15.0, 0.0], [20.0, 15.0, 20.0]);
        let mut patches = Vec::new();
        for axis in 0..3 {
            for (out, from) in [(-1.0, low), (1.0, high)] {
                let at = |mut p: P3| {
                    p[axis] = from[axis];
                    p
                };
                patches.push(Patch::plate(axis, out, at(low), at(high)));
            }
        }
        patches
    }

    fn candidates(&self, _: P3) -> Vec<(usize, Patch)> {
        self.patches().into_iter().enumerate().collect()
    }

    fn distance_to_other_regions(&self, _: P3) -> f64 {
        f64::INFINITY
    }
}

impl Oracle for Block {
    body_oracle!("Block", [25.0, 20.0], [-20.0, -15.0, 0.0], [20.0, 15.0, 20.0]);

    fn singularity_distance(&self, _: P3) -> f64 {
        f64::INFINITY
    }

    fn corner_points(&self) -> Vec<P3> {
        // Vertices, middles of edges and faces, and the ends of the ridges inside.
        let mut all = grid(&[-20.0, 0.0, 20.0], &[-15.0, 0.0, 15.0], &[0.0, 10.0, 20.0]);
        all.extend(grid(&[-10.0, 10.0], &[-5.0, 5.0], &[10.0]));
        all
    }
}

/// The bracket: legs of 30 along x and 24 along z, 20 wide, 6 thick, with a hole of radius 3.3 through the lying
/// leg.
#[derive(Clone, Copy, Debug, Default)]
pub struct LBracket;

const HOLE: Hole = Hole { centre: [10.0, 0.0], radius: 3.3 };
/// The standing leg's inner face and the lying leg's upper one, which meet in the inner edge.
const WALL_POSITION: f64 = -4.0;
const LEDGE_HEIGHT: f64 = 6.0;

impl LBracket {
    fn bottom() -> Patch {
        Self::drilled(-1.0, [-10.0, -10.0, 0.0], [20.0, 10.0, 0.0])
    }
    fn ledge() -> Patch {
        Self::drilled(1.0, [WALL_POSITION, -10.0, LEDGE_HEIGHT], [20.0, 10.0, LEDGE_HEIGHT])
    }
    fn drilled(out: f64, low: P3, high: P3) -> Patch {
        Patch::Plate { axis: 2, out, low, high, hole: Some(HOLE) }
    }
    fn end() -> Patch {
        Patch::plate(0, 1.0, [20.0, -10.0, 0.0], [20.0, 10.0, LEDGE_HEIGHT])
    }
    fn back() -> Patch {
        Patch::plate(0, -1.0, [-10.0, -10.0, 0.0], [-10.0, 10.0, 24.0])
    }
    fn wall() -> Patch {
        Patch::plate(0, 1.0, [WALL_POSITION, -10.0, LEDGE_HEIGHT], [WALL_POSITION, 10.0, 24.0])
    }
    fn top() -> Patch {
        Patch::plate(2, 1.0, [-10.0, -10.0, 24.0], [WALL_POSITION, 10.0, 24.0])
    }
    fn bore() -> Patch {
        Patch::Bore { hole: HOLE, height: LEDGE_HEIGHT }
    }
    /// Returns the rectangle of a leg on both sides. Each side is an L: two rectangles, one of which ends at `x`
    /// and `z`.
    fn sides([x, z]: [f64; 2]) -> [Patch; 2] {
        [-10.0, 10.0].map(|y: f64| Patch::plate(1, y.signum(), [-10.0, y, 0.0], [x, y, z]))
    }
}

const LYING: [f64; 2] = [20.0, LEDGE_HEIGHT];
const STANDING: [f64; 2] = [WALL_POSITION, 24.0];

impl Body for LBracket {
    const REGIONS: &'static [&'static str] = &[
        "lying_bottom",
        "lying_top",
        "lying_end",
        "lying_side",
        "bore",
        "heel_bottom",
        "heel_back",
        "heel_side",
        "heel_edge",
        "standing_back",
        "standing_inner",
        "standing_side",
        "standing_top",
    ];

    fn inside(&self, [x, y, z]: P3) -> bool {
        let lying = (WALL_POSITION..=20.0).contains(&x) && (0.0..=LEDGE_HEIGHT).contains(&z);
        let standing = (-10.0..=WALL_POSITION).contains(&x) && (0.0..=24.0).contains(&z);
        (lying || standing) && y.abs() <= 10.0 && length2(HOLE.offset([x, y, z])) >= HOLE.radius
    }

    fn patches(&self) -> Vec<Patch> {
        let faces = [Self::bottom(), Self::ledge(), Self::end(), Self::back(), Self::wall()];
        let rest = [Self::top(), Self::bore()];
        let sides = [LYING, STANDING].into_iter().flat_map(Self::sides);
        faces.into_iter().chain(rest).chain(sides).collect()
    }

    fn candidates(&self, [x, _, z]: P3) -> Vec<(usize, Patch)> {
        let sides = |region: usize, leg| Self::sides(leg).map(|side| (region, side));
        let mut all = Vec::new();
        if x >= WALL_POSITION {
            all.extend([(0, Self::bottom()), (1, Self::ledge()), (2, Self::end())]);
            all.extend(sides(3, LYING));
            all.push((4, Self::bore()));
        }
        if x <= WALL_POSITION && z <= LEDGE_HEIGHT {
            all.extend([(5, Self::bottom()), (6, Self::back())]);
            all.extend(sides(7, STANDING));
            // Both end in the inner edge.
            all.extend([(8, Self::ledge()), (8, Self::wall())]);
        }
        if x <= WALL_POSITION && z >= LEDGE_HEIGHT {
            all.extend([(9, Self::back()), (10, Self::wall())]);
            all.extend(sides(11, STANDING));
            all.push((12, Self::top()));
        }
        all
    }

    fn distance_to_other_regions(&self, [x, _, z]: P3) -> f64 {
        (x - WALL_POSITION).abs().min(if x <= WALL_POSITION {
            (z - LEDGE_HEIGHT).abs()
        } else {
            f64::INFINITY
        })
    }
}

impl Oracle for LBracket {
    body_oracle!("LBracket", [500f64.sqrt(), 24.0], [-10.0, -10.0, 0.0], [20.0, 10.0, 24.0]);

    fn singularity_distance(&self, p: P3) -> f64 {
        match self.winner(p) {
            Some(((4, ..), _)) => length2(HOLE.offset(p)),
            Some(((8, ..), _)) => (p[0] - WALL_POSITION).hypot(p[2] - LEDGE_HEIGHT),
            _ => f64::INFINITY,
        }
    }

    fn corner_points(&self) -> Vec<P3> {
        let mut all = grid(
            &[-10.0, -7.0, WALL_POSITION, 5.0, 20.0],
            &[-10.0, 0.0, 10.0],
            &[0.0, 3.0, LEDGE_HEIGHT],
        );
        all.extend(grid(&[-10.0, -7.0, WALL_POSITION], &[-10.0, 0.0, 10.0], &[15.0, 24.0]));
        // The rim of the hole, and points half way up its wall.
        for k in 0..16 {
            let (sin, cos) = (f64::from(k) * std::f64::consts::FRAC_PI_8).sin_cos();
            all.extend([0.0, 3.0, LEDGE_HEIGHT].map(|z| [10.0 + 3.3 * cos, 3.3 * sin, z]));
        }
        all
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_block_at_a_few_points() {
        let at = |p| Block.evaluate(p).map(|s| (Block::REGIONS[s.owner], s.depth, s.direction));
        assert_eq!(at([18.0, 0.0, 10.0]), Some(("right", 2.0, [1.0, 0.0, 0.0])));
        assert_eq!(at([0.0, -14.5, 10.0]), Some(("front", 0.5, [0.0, -1.0, 0.0])));
        assert_eq!(at([0.0, 0.0, 10.0]), Some(("bottom", 10.0, [0.0, 0.0, -1.0])));
        assert_eq!(at([20.0, 15.0, 20.0]).map(|s| (s.0, s.1)), Some(("right", 0.0)));
        assert_eq!(at([20.5, 0.0, 0.0]), None);
        assert_eq!(Block.signed_distance([23.0, 19.0, 10.0]), 5.0);
    }

    #[test]
    fn the_bracket_at_a_few_points() {
        let at = |p| LBracket.evaluate(p).map(|s| (LBracket::REGIONS[s.owner], s.depth));
        assert_eq!(at([0.0, 0.0, 2.0]), Some(("lying_bottom", 2.0)));
        assert_eq!(at([-7.5, 0.0, 15.0]), Some(("standing_back", 2.5)));
        assert_eq!(at([-5.0, 0.0, 5.0]), Some(("heel_edge", 2f64.sqrt())));
        assert_eq!(at([10.0, 0.0, 3.0]), None);
        assert_eq!(at([-3.0, 0.0, 7.0]), None);
        let (region, depth) = at([14.0, 0.0, 3.0]).expect("beside the hole");
        assert_eq!(region, "bore");
        assert!((depth - 0.7).abs() < 1e-15);
        // Inside the hole the wall is nearest, and below the hole its rim.
        assert!((LBracket.signed_distance([10.0, 1.0, 3.0]) - 2.3).abs() < 1e-15);
        assert!((LBracket.signed_distance([10.0, 1.0, -1.0]) - 2.3f64.hypot(1.0)).abs() < 1e-15);
    }
}
