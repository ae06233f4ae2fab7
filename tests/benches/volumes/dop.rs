//! Polytopes of fixed directions, k-DOPs (Klosowski 1997): middle and half of each of k/2 slabs.
//!
//! How far a k-DOP reaches along another direction is a linear programme. Writing the direction as a
//! sum of the three of the k about it gives an upper bound that takes no more than that of a box. The
//! tool's axes are the same for a whole query, so each is written so once. To hold the bound to that
//! of the part's axes as well spared at most one test of fourteen with k = 14, none with 18 and 26,
//! and took longer.

use crate::contender::dot;
use crate::split::{Bounds, Item};
use crate::volume::{Frame, Place, Volume};

/// With `K` numbers: that is k.
pub(crate) struct Dop<const K: usize>;

const EDGE: f64 = std::f64::consts::FRAC_1_SQRT_2;
const CORNER: f64 = 0.577_350_269_189_625_8;

const AXES: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// Between two axes each, in the order of [`edge`].
const EDGES: [[f64; 3]; 6] = [
    [EDGE, EDGE, 0.0],
    [EDGE, -EDGE, 0.0],
    [EDGE, 0.0, EDGE],
    [EDGE, 0.0, -EDGE],
    [0.0, EDGE, EDGE],
    [0.0, EDGE, -EDGE],
];

/// Between three axes each, in the order of [`corner`].
const CORNERS: [[f64; 3]; 4] = [
    [CORNER, CORNER, CORNER],
    [CORNER, CORNER, -CORNER],
    [CORNER, -CORNER, CORNER],
    [CORNER, -CORNER, -CORNER],
];

/// The directions of a k-DOP; those of 26 are all there are.
fn ways(k: usize) -> Vec<[f64; 3]> {
    let (edges, corners) = (k != 14, k != 18);
    let chosen = |given: bool, ways: &'static [[f64; 3]]| if given { ways } else { &[] };
    [&AXES, chosen(edges, &EDGES), chosen(corners, &CORNERS)].concat()
}

/// A direction of the k, and how much of it.
type Share = (usize, f32);

/// The tool's axes as sums of three directions.
pub(crate) struct Seen {
    origin: [f32; 3],
    axes: [[Share; 3]; 3],
}

impl<const K: usize> Volume<K> for Dop<K> {
    type Seen = Seen;

    fn about(items: &[Item]) -> [f32; K] {
        let mut written = [0.0; K];
        let (middles, halves) = written.split_at_mut(K / 2);
        for ((way, middle), half) in ways(K).into_iter().zip(middles).zip(halves) {
            let bounds = Bounds::of_places(items.iter().map(|item| [dot(way, item.at); 3]));
            (*middle, *half) = (bounds.middle(0) as f32, (bounds.side(0) / 2.0) as f32);
        }
        written
    }

    fn seen(frame: &Frame) -> Seen {
        Seen { origin: frame.origin, axes: frame.rows.map(|row| about(K, row)) }
    }

    #[inline(always)]
    fn may_touch<const W: usize>(seen: &Seen, volumes: &[[f32; W]; K], lane: usize) -> bool {
        let along = |axis: usize| {
            let (middle, half) = stretch::<W, K>(volumes, lane, seen.axes[axis]);
            (middle + seen.origin[axis], half)
        };
        let (x, y, z) = (along(0), along(1), along(2));
        Place::of_box([x.0, y.0, z.0], [x.1, y.1, z.1]).may_touch()
    }
}

/// Middle and half of what a k-DOP reaches at most along a sum of its directions.
#[inline(always)]
fn stretch<const W: usize, const K: usize>(
    volumes: &[[f32; W]; K],
    lane: usize,
    shares: [Share; 3],
) -> (f32, f32) {
    let [(a, by_a), (b, by_b), (c, by_c)] = shares;
    let (halves, [a, b, c]) = (&volumes[K / 2..], [a % (K / 2), b % (K / 2), c % (K / 2)]);
    let middle = by_a * volumes[a][lane] + by_b * volumes[b][lane] + by_c * volumes[c][lane];
    let half =
        by_a.abs() * halves[a][lane] + by_b.abs() * halves[b][lane] + by_c.abs() * halves[c][lane];
    (middle, half)
}

/// A direction as a sum of the three of the k directions about it, none of them negative.
fn about(k: usize, row: [f32; 3]) -> [Share; 3] {
    let size = |axis: usize| row[axis].abs();
    let mut by_size = [0, 1, 2];
    by_size.sort_unstable_by(|&a, &b| size(b).total_cmp(&size(a)));
    let [a, b, c] = by_size;
    let (u, v, w) = (size(a), size(b), size(c));
    let sign = row.map(|part| 1f32.copysign(part));
    let mirrored = [0, 1, 2].map(|axis| if axis == c { -sign[axis] } else { sign[axis] });
    match k {
        14 => [
            (a, sign[a] * (u - v)),
            corner(3, sign, 0.5 * (v + w)),
            corner(3, mirrored, 0.5 * (v - w)),
        ],
        18 if u >= v + w => {
            [(a, sign[a] * (u - v - w)), edge([a, b], sign, v), edge([a, c], sign, w)]
        }
        18 => [
            edge([a, b], sign, 0.5 * (u + v - w)),
            edge([a, c], sign, 0.5 * (u + w - v)),
            edge([b, c], sign, 0.5 * (v + w - u)),
        ],
        _ => [(a, sign[a] * (u - v)), edge([a, b], sign, v - w), corner(9, sign, w)],
    }
}

/// So much of the direction between two axes, their signs given.
fn edge([a, b]: [usize; 2], sign: [f32; 3], much: f32) -> Share {
    let (first, other) = (a.min(b), a.max(b));
    let place = 3 + 2 * (a + b - 1) + usize::from(sign[first] != sign[other]);
    (place, much * sign[first] / EDGE as f32)
}

/// So much of the direction between all axes, their signs given; `from` is the first such.
fn corner(from: usize, sign: [f32; 3], much: f32) -> Share {
    let place = from + 2 * usize::from(sign[1] != sign[0]) + usize::from(sign[2] != sign[0]);
    (place, much * sign[0] / CORNER as f32)
}
