//! Random profiles as recipes, which shrink.

use super::outline::{Outline, P2};
use proptest::prelude::*;
use touchoff_tests::oracle::profile::Profile;
use touchoff_tests::oracle::segment::Segment;
use touchoff_tests::oracle::vector::{add, cross, dot, left, norm, right, sub, turned};

const MAX_SEGMENTS: usize = 12;
/// Number of grid steps per unit of length in a recipe.
const GRID: f64 = 64.0;

/// The beginning, the moves and the end of a profile, in whole numbers.
#[derive(Clone, Debug)]
pub(crate) struct Recipe {
    nose: Nose,
    moves: Vec<Move>,
    cap: Cap,
    /// Thousandths, and a power of ten.
    scale: (i32, i32),
    lift: i32,
    down: bool,
}

#[derive(Clone, Copy, Debug)]
enum Nose {
    /// The first move begins at the axis.
    Open,
    /// An arc about the axis: its radius, and its angle in degrees.
    Ball(i32, i32),
    /// A flat face to the first number, and a quarter of a circle of the second.
    Torus(i32, i32),
    /// A cone tip, or a dished one.
    Cone(i32, i32),
}

#[derive(Clone, Copy, Debug)]
enum Cap {
    Flat,
    Cone(i32),
    /// An arc about the axis whose centre lies this far below its start, or above for a dish.
    Dome(i32),
}

#[derive(Clone, Copy, Debug)]
enum Move {
    Line(i32, i32),
    /// An arc to a point, whose radius is `ratio` hundredths of the chord.
    Arc {
        to: (i32, i32),
        ratio: i32,
        convex: bool,
        by_radius: bool,
    },
    /// Upward half of a circle.
    Half {
        radius: i32,
        convex: bool,
    },
    /// An arc that goes on in the direction of travel and turns by an angle in degrees.
    Tangent {
        radius: i32,
        degrees: i32,
    },
    /// In, up and out again.
    Groove {
        depth: i32,
        width: i32,
    },
    /// Out, up and in again; thin ones are needles.
    Flange {
        reach: i32,
        width: i32,
    },
    /// The corner behind is rounded over `share` sixteenths of the shorter edge beside it.
    Fillet {
        share: i32,
        by_radius: bool,
    },
}

pub(crate) fn recipe() -> impl Strategy<Value = Recipe> {
    let nose = prop_oneof![
        3 => Just(Nose::Open),
        2 => (16..256i32, 10..=90i32).prop_map(|(r, a)| Nose::Ball(r, a)),
        1 => (16..256i32, 4..128i32).prop_map(|(face, r)| Nose::Torus(face, r)),
        2 => (16..256i32, -64..256i32).prop_map(|(d, z)| Nose::Cone(d, z)),
    ];
    let cap = prop_oneof![
        3 => Just(Cap::Flat),
        2 => (-64..256i32).prop_map(Cap::Cone),
        1 => (-128..128i32).prop_map(Cap::Dome),
    ];
    let to = || (-200..=200i32, -64..=256i32);
    let one = prop_oneof![
        3 => to().prop_map(|(d, z)| Move::Line(d, z)),
        1 => (-200..=200i32).prop_map(|d| Move::Line(d, 0)),
        1 => (1..=256i32).prop_map(|z| Move::Line(0, z)),
        3 => (to(), 51..400i32, any::<bool>(), any::<bool>())
            .prop_map(|(to, ratio, convex, by_radius)| Move::Arc { to, ratio, convex, by_radius }),
        1 => (2..96i32, any::<bool>()).prop_map(|(radius, convex)| Move::Half { radius, convex }),
        2 => (4..256i32, prop_oneof![-170..-5i32, 5..170i32])
            .prop_map(|(radius, degrees)| Move::Tangent { radius, degrees }),
        1 => (4..128i32, 4..128i32).prop_map(|(depth, width)| Move::Groove { depth, width }),
        1 => (4..256i32, prop_oneof![Just(1i32), 2..64i32])
            .prop_map(|(reach, width)| Move::Flange { reach, width }),
        4 => (prop_oneof![2 => 1..16i32, 1 => Just(16i32)], any::<bool>())
            .prop_map(|(share, by_radius)| Move::Fillet { share, by_radius }),
    ];
    let scale = prop_oneof![
        2 => Just((1000, 0)),
        2 => (1000..9999i32, -4..=1i32),
    ];
    let moves = proptest::collection::vec(one, 1..=9);
    (nose, moves, cap, scale, prop_oneof![Just(0i32), -500..500i32], any::<bool>()).prop_map(
        |(nose, moves, cap, scale, lift, down)| Recipe { nose, moves, cap, scale, lift, down },
    )
}

/// A piece to be added, and the share of the shorter edge over which its first corner is rounded.
struct Step {
    piece: Segment<f64>,
    fillet: Option<(f64, bool)>,
}

struct Pen {
    scale: f64,
    at: P2,
    steps: Vec<Step>,
    fillet: Option<(f64, bool)>,
}

impl Recipe {
    /// Returns the profile, which is not always valid.
    pub(crate) fn outline(&self) -> Outline {
        let scale = f64::from(self.scale.0) / 1000.0 * 10f64.powi(self.scale.1);
        let start = [0.0, f64::from(self.lift) / GRID * scale];
        let mut pen = Pen { scale, at: start, steps: Vec::new(), fillet: None };
        self.nose.draw(&mut pen);
        for step in &self.moves {
            if pen.steps.len() < MAX_SEGMENTS {
                step.draw(&mut pen);
            }
        }
        let [d, z] = pen.at;
        match self.cap {
            Cap::Flat => pen.line([0.0, z]),
            Cap::Cone(up) => pen.line([0.0, z + pen.unit(up)]),
            Cap::Dome(below) => {
                let h = pen.unit(below);
                let (radius, sign) = (d.hypot(h), if below < 0 { -1.0 } else { 1.0 });
                let centre = [0.0, z - h];
                let to = [0.0, centre[1] + sign * radius];
                pen.push(Segment::about(pen.at, to, centre, below >= 0));
            }
        }
        if pen.steps.is_empty() {
            // A profile of nothing, which is not valid.
            pen.steps.push(Step { piece: Segment::line(start, start), fillet: None });
        }
        Outline { profile: Profile::new(rounded(&pen.steps)), down: self.down }
    }
}

impl Pen {
    fn unit(&self, count: i32) -> f64 {
        f64::from(count) / GRID * self.scale
    }

    /// Returns a point relative to the current one, kept off the axis.
    fn by(&self, d: i32, z: i32) -> P2 {
        let [x, y] = add(&self.at, &[self.unit(d), self.unit(z)], &1.0);
        [x.max(self.unit(8)), y]
    }

    fn push(&mut self, piece: Segment<f64>) {
        if piece.from != piece.to {
            self.at = piece.to;
            self.steps.push(Step { piece, fillet: self.fillet.take() });
        }
    }

    fn line(&mut self, to: P2) {
        self.push(Segment::line(self.at, to));
    }
}

impl Nose {
    fn draw(self, pen: &mut Pen) {
        let [_, z] = pen.at;
        match self {
            Nose::Open => {}
            Nose::Ball(radius, degrees) => {
                let radius = pen.unit(radius);
                let (sin, cos) = f64::from(degrees).to_radians().sin_cos();
                let to = if degrees == 90 {
                    [radius, z + radius]
                } else {
                    [radius * sin, z + radius * (1.0 - cos)]
                };
                pen.push(Segment::about(pen.at, to, [0.0, z + radius], true));
            }
            Nose::Torus(face, radius) => {
                let (face, radius) = (pen.unit(face), pen.unit(radius));
                pen.line([face, z]);
                let to = [face + radius, z + radius];
                pen.push(Segment::about(pen.at, to, [face, z + radius], true));
            }
            Nose::Cone(d, up) => pen.line([pen.unit(d), z + pen.unit(up)]),
        }
    }
}

impl Move {
    fn draw(self, pen: &mut Pen) {
        match self {
            Move::Line(d, z) => pen.line(pen.by(d, z)),
            Move::Arc { to: (d, z), ratio, convex, by_radius } => {
                let to = pen.by(d, z);
                let radius = f64::from(ratio) / 100.0 * norm(&sub(&to, &pen.at));
                let arc = Segment::by_radius(pen.at, to, radius, convex);
                let centre = arc.circle.map_or([0.0; 2], |round| round.centre);
                pen.push(if by_radius { arc } else { Segment::about(pen.at, to, centre, convex) });
            }
            Move::Half { radius, convex } => {
                let r = pen.unit(radius);
                let (to, centre) = (add(&pen.at, &[0.0, r], &2.0), add(&pen.at, &[0.0, r], &1.0));
                let mut arc = Segment::about(pen.at, to, centre, convex);
                if let Some(round) = &mut arc.circle {
                    // Elsewhere half of the rounded chord need not be the rounded radius.
                    let exact = |part: f64| pen.scale == 1.0 && (part * GRID).fract() == 0.0;
                    round.by_radius = exact(pen.at[1]) && radius % 2 == 0;
                }
                pen.push(arc);
            }
            Move::Tangent { radius, degrees } => {
                let Some(last) = pen.steps.last() else { return };
                let t = last.piece.tangent(&pen.at);
                let convex = degrees > 0;
                let toward = if convex { left(&t) } else { right(&t) };
                let centre = add(&pen.at, &toward, &pen.unit(radius));
                let arm = turned(&sub(&pen.at, &centre), f64::from(degrees).to_radians());
                let to = add(&centre, &arm, &1.0);
                pen.push(Segment::about(pen.at, to, centre, convex));
            }
            Move::Groove { depth, width } => {
                pen.line(pen.by(-depth, 0));
                pen.line(pen.by(0, width));
                pen.line(pen.by(depth, 0));
            }
            Move::Flange { reach, width } => {
                pen.line(pen.by(reach, 0));
                pen.line(pen.by(0, width));
                pen.line(pen.by(-reach, 0));
            }
            Move::Fillet { share, by_radius } => {
                pen.fillet = Some((f64::from(share) / 32.0, by_radius));
            }
        }
    }
}

/// Returns the pieces, with corners between lines rounded where a step says so.
fn rounded(steps: &[Step]) -> Vec<Segment<f64>> {
    let mut pieces: Vec<Segment<f64>> = Vec::new();
    for step in steps {
        let next = step.piece;
        let fillet = step.fillet.and_then(|fillet| Some((fillet, pieces.pop()?))).map(
            |((share, by_radius), last)| {
                let (a, b) = (sub(&last.to, &last.from), sub(&next.to, &next.from));
                // A corner before may have taken half of the edge already.
                let whole = steps.iter().map(|s| s.piece).find(|p| p.to == last.to);
                let edge = whole.map_or(norm(&a), |piece| norm(&sub(&piece.to, &piece.from)));
                let cut = (share * edge.min(norm(&b))).min(norm(&a));
                (last, corner(last, next, cut, by_radius))
            },
        );
        match fillet {
            Some((last, Some((arc, rest)))) => {
                // Two arcs that share an edge meet in its middle.
                let left = norm(&sub(&arc.from, &last.from));
                if left <= 1e-9 * norm(&sub(&arc.to, &arc.from)) {
                    pieces.extend([arc.between(last.from, arc.to), rest]);
                } else {
                    pieces.extend([Segment::line(last.from, arc.from), arc, rest]);
                }
            }
            Some((last, None)) => pieces.extend([last, next]),
            None => pieces.push(next),
        }
    }
    pieces
}

/// Returns the arc that touches two lines at a distance of `cut` from their corner, and what it leaves of the
/// second.
fn corner(
    last: Segment<f64>,
    next: Segment<f64>,
    cut: f64,
    by_radius: bool,
) -> Option<(Segment<f64>, Segment<f64>)> {
    if last.circle.is_some() || next.circle.is_some() {
        return None;
    }
    let (a, b) = (last.tangent(&last.to), next.tangent(&next.from));
    let turn = cross(&a, &b).atan2(dot(&a, &b));
    if !(0.02..3.0).contains(&turn.abs()) {
        return None;
    }
    let (from, to) = (add(&last.to, &a, &-cut), add(&last.to, &b, &cut));
    let radius = cut / (turn.abs() / 2.0).tan();
    let toward = if turn > 0.0 { left(&a) } else { right(&a) };
    let arc = if by_radius {
        Segment::by_radius(from, to, radius, turn > 0.0)
    } else {
        Segment::about(from, to, add(&from, &toward, &radius), turn > 0.0)
    };
    Some((arc, Segment::line(to, next.to)))
}
