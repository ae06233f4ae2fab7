//! Distances and feet against 200 bits: the bounds that `touchoff_plane` states.

use dashu_float::FBig;
use dashu_float::round::mode::HalfEven;
use touchoff_plane::{Circle, Point, Segment};

type Exact = FBig<HalfEven, 2>;

const UNIT_ROUNDOFF: f64 = f64::EPSILON / 2.0;

fn exact(x: f64) -> Exact {
    Exact::try_from(x).expect("a finite number").with_precision(200).value()
}

fn between([from, to]: [Point; 2]) -> [Exact; 2] {
    [0, 1].map(|k| exact(to[k]) - exact(from[k]))
}

fn dot(a: &[Exact; 2], b: &[Exact; 2]) -> Exact {
    &a[0] * &b[0] + &a[1] * &b[1]
}

fn cross(a: &[Exact; 2], b: &[Exact; 2]) -> Exact {
    &a[0] * &b[1] - &a[1] * &b[0]
}

fn norm(a: &[Exact; 2]) -> Exact {
    dot(a, a).sqrt()
}

/// Signed distance from the whole line or circle, distance, and nearest point.
struct Reference {
    signed: Exact,
    distance: Exact,
    foot: [Exact; 2],
}

fn reference([from, to]: [Point; 2], circle: Option<Circle>, turn: f64, p: Point) -> Reference {
    let zero = exact(0.0);
    let point = |p: Point| p.map(exact);
    let (to_start, to_end) = (between([from, p]), between([to, p]));
    let nearest_end = || {
        let [start, end] = [norm(&to_start), norm(&to_end)];
        if end < start { (end, point(to)) } else { (start, point(from)) }
    };
    let Some(Circle { centre, radius, convex }) = circle else {
        let along = between([from, to]);
        let length = norm(&along);
        let signed = cross(&along, &to_start) / &length;
        let share = dot(&along, &to_start) / (&length * &length);
        let (distance, foot) = if share <= zero || share >= exact(1.0) {
            nearest_end()
        } else {
            let foot = [0, 1].map(|k| exact(from[k]) + &share * &along[k]);
            (if signed < zero { -signed.clone() } else { signed.clone() }, foot)
        };
        return Reference { signed, distance, foot };
    };
    let [first, last, out] = [from, to, p].map(|p| between([centre, p]));
    let away = norm(&out);
    let excess = &away - exact(radius);
    let (after, before) = (cross(&first, &out), cross(&out, &last));
    let sides =
        if convex { [after >= zero, before >= zero] } else { [after <= zero, before <= zero] };
    let is_beside =
        if turn > std::f64::consts::PI { sides[0] || sides[1] } else { sides == [true; 2] };
    let (distance, foot) = if is_beside {
        let foot = [0, 1].map(|k| exact(centre[k]) + exact(radius) * &out[k] / &away);
        (if excess < zero { -excess.clone() } else { excess.clone() }, foot)
    } else {
        nearest_end()
    };
    Reference { signed: if convex { -excess } else { excess }, distance, foot }
}

/// A generator of numbers from 0 to 1: one of Marsaglia's xorshifts.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    fn point(&mut self, size: f64) -> Point {
        [0; 2].map(|_| size * (2.0 * self.next() - 1.0))
    }
}

/// Lines, and arcs of up to nearly a full turn, of all sizes; points anywhere, on them, and near the ends.
#[test]
fn distances_are_as_accurate_as_stated() {
    let mut random = Random(0x9e37_79b9_7f4a_7c15);
    let (mut worst, mut compared) = ([0.0f64; 3], [0; 3]);
    for round in 0..60_000 {
        let size = 10f64.powf(12.0 * random.next() - 6.0);
        let from = random.point(size);
        let kind = round % 3;
        let (to, circle, turn) = if kind == 0 {
            (random.point(size), None, 0.0)
        } else {
            let centre = random.point(size);
            let out = [0, 1].map(|k| from[k] - centre[k]);
            let turn = if kind == 1 { 3.1 * random.next() } else { 3.2 + 3.0 * random.next() };
            let convex = random.next() < 0.5;
            let (sine, cosine) = (if convex { turn } else { -turn }).sin_cos();
            let to = [
                centre[0] + out[0] * cosine - out[1] * sine,
                centre[1] + out[0] * sine + out[1] * cosine,
            ];
            (to, Some(Circle { centre, radius: out[0].hypot(out[1]), convex }), turn)
        };
        let segment = Segment::new([from, to], circle, 0);
        let p = match round % 4 {
            0 => segment.place(random.next()).point,
            1 => {
                let end = if random.next() < 0.5 { from } else { to };
                let off = random.point(1e-6 * size);
                [0, 1].map(|k| end[k] + off[k])
            }
            _ => random.point(2.0 * size),
        };
        let radius = circle.map_or(0.0, |circle| circle.radius);
        let centre = circle.map_or([0.0; 2], |circle| circle.centre);
        let largest =
            [from, to, p, centre].as_flattened().iter().fold(radius, |a, b| a.max(b.abs()));
        let expected = reference([from, to], circle, turn, p);
        let error = |value: f64, expected: &Exact| {
            let error = (exact(value) - expected).to_f64().value().abs();
            error / (UNIT_ROUNDOFF * largest)
        };
        let from_p = |half: &Segment| half.distance(p);
        let nearest = segment.halves().min_by(|a, b| from_p(a).total_cmp(&from_p(b)));
        let nearest = nearest.expect("one or two");
        let foot = nearest.foot(p);
        let errors = [
            error(segment.signed_distance(p), &expected.signed),
            error(nearest.distance(p), &expected.distance),
            error(foot[0], &expected.foot[0]).max(error(foot[1], &expected.foot[1])),
        ];
        for (worst, error) in worst.iter_mut().zip(errors) {
            *worst = worst.max(error);
        }
        compared[kind] += 1;
    }
    println!("signed distance, distance, foot: {worst:?} u S; {compared:?} lines, arcs, wide arcs");
    assert!(worst.iter().all(|error| *error <= 16.0), "{worst:?}");
}
