//! Hill climbing over some numbers, down to their last bits.

use touchoff_tests::oracle::draw::Draw;

/// The places of doubles in their order, so that neighbours differ by one.
fn place(value: f64) -> i64 {
    let bits = value.to_bits().cast_signed();
    if bits < 0 { i64::MIN - bits } else { bits }
}

fn at(place: i64) -> f64 {
    let bits = if place < 0 { i64::MIN - place } else { place };
    f64::from_bits(bits.cast_unsigned())
}

/// The double that many doubles away; the number itself where that is none.
pub fn beside(value: f64, ulps: i64) -> f64 {
    let moved = at(place(value).saturating_add(ulps));
    if moved.is_finite() { moved } else { value }
}

/// The double halfway between two, counted in doubles; one of them if they are neighbours.
pub fn halfway(a: f64, b: f64) -> f64 {
    // Of two places of different sign the sum fits.
    let (a, b) = (place(a), place(b));
    at((a >> 1) + (b >> 1) + (a & b & 1))
}

/// Neighbouring points, one double apart in one coordinate, that are told apart by a label, found by halving the way between two
/// that are.
pub fn neighbours<const N: usize, L: PartialEq>(
    mut a: [f64; N],
    mut b: [f64; N],
    mut label: impl FnMut(&[f64; N]) -> L,
) -> Option<[[f64; N]; 2]> {
    let first = label(&a);
    if first == label(&b) {
        return None;
    }
    loop {
        let middle: [f64; N] = std::array::from_fn(|k| halfway(a[k], b[k]));
        if middle == a || middle == b {
            break;
        }
        if label(&middle) == first { a = middle } else { b = middle }
    }
    for k in 0..N {
        while a[k] != b[k] {
            let mut next = a;
            next[k] = if b[k] > a[k] { a[k].next_up() } else { a[k].next_down() };
            if label(&next) != first {
                return Some([a, next]);
            }
            a = next;
        }
    }
    None
}

/// What a climb begins with.
#[derive(Clone, Copy, Debug)]
pub struct Climb {
    /// How many places are tried.
    pub steps: usize,
    /// How far the first steps go.
    pub reach: f64,
}

/// The best place found so far.
#[derive(Clone, Copy, Debug)]
pub struct Best<const N: usize> {
    /// Where.
    pub place: [f64; N],
    /// What was climbed there.
    pub value: f64,
}

impl Climb {
    /// Climbs from a place: coordinates and all of them together by steps that shrink while nothing is better, single bits, as many
    /// doubles as there are between 1 and 64, coarser and rounder numbers, and the last good step once more. As good is good enough,
    /// so that plateaus are crossed; what is not a number is best of all.
    pub fn from<const N: usize>(
        self,
        start: [f64; N],
        draw: &mut Draw,
        mut value: impl FnMut([f64; N]) -> f64,
    ) -> Best<N> {
        let mut best = Best { place: start, value: value(start) };
        let mut reach = self.reach;
        let mut last = [0.0; N];
        for step in 0..self.steps {
            // From wide to the last bit over the whole climb, with some noise.
            let part = step as f64 / self.steps as f64;
            let shrink = 2f64.powf(-52.0 * part + draw.between(-6.0, 6.0));
            let tried = moved(best.place, reach * shrink, last, draw);
            if tried == best.place || !tried.iter().all(|c| c.is_finite()) {
                continue;
            }
            let found = value(tried);
            if found >= best.value || (found.is_nan() && !best.value.is_nan()) {
                if found > best.value {
                    last = std::array::from_fn(|k| tried[k] - best.place[k]);
                    reach = (2.0 * reach).min(self.reach);
                }
                best = Best { place: tried, value: found };
            } else {
                reach = (0.999 * reach).max(1e-6 * self.reach);
            }
        }
        best
    }
}

fn moved<const N: usize>(from: [f64; N], reach: f64, last: [f64; N], draw: &mut Draw) -> [f64; N] {
    let mut to = from;
    let k = draw.bits() as usize % N;
    match draw.bits() % 8 {
        0 | 1 => to[k] += draw.between(-reach, reach),
        2 | 3 => to.iter_mut().for_each(|c| *c += draw.between(-reach, reach)),
        4 => {
            let ulps = 1 << (draw.bits() % 7);
            to[k] = beside(to[k], if draw.bits().is_multiple_of(2) { ulps } else { -ulps });
        }
        5 => to[k] = f64::from_bits(to[k].to_bits() ^ (1 << (draw.bits() % 48))),
        6 => {
            // Rounder: so many low bits are cleared.
            let low = draw.bits() % 50;
            to[k] = f64::from_bits(to[k].to_bits() >> low << low);
        }
        _ => {
            let times = [0.5, 1.0, 2.0][draw.bits() as usize % 3];
            to.iter_mut().zip(last).for_each(|(c, step)| *c += times * step);
        }
    }
    to
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn doubles_are_counted() {
        assert_eq!(beside(1.0, 1), 1f64.next_up());
        assert_eq!(beside(1.0, -1), 1f64.next_down());
        assert_eq!(beside(0.0, -1), -5e-324);
        assert_eq!(beside(5e-324, -2), -5e-324);
        assert_eq!(halfway(1.0, 1f64.next_up()), 1.0);
        assert_eq!(halfway(-1.0, 1.0), 0.0);
        assert_eq!(halfway(f64::MAX, f64::MAX), f64::MAX);
    }

    #[test]
    fn a_border_is_found_between_neighbours() {
        let label = |p: &[f64; 2]| p[0] + p[1] > 1.0;
        let [a, b] = neighbours([-3.0, 0.1], [2.0, 0.7], label).expect("one is on either side");
        assert!(!label(&a) && label(&b));
        assert_eq!((0..2).filter(|k| a[*k] != b[*k]).count(), 1);
        assert!((0..2).all(|k| a[k] == b[k] || a[k].next_up() == b[k] || b[k].next_up() == a[k]));
        assert_eq!(neighbours([0.0, 0.0], [0.1, 0.2], label), None);
    }

    #[test]
    fn a_climb_finds_the_last_bit() {
        let mut draw = Draw::new(3);
        let top = [0.3, -7.1];
        let hill = |p: [f64; 2]| -(p[0] - top[0]).abs() - (p[1] - top[1]).abs();
        let best = Climb { steps: 20_000, reach: 1.0 }.from([0.0, 0.0], &mut draw, hill);
        assert!(best.value > -4e-15, "{best:?}");
    }
}
