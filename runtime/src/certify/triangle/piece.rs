//! Triangles that are halved.

use crate::certify::space::{Point, dot, minus};

/// A triangle, or a part of one.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Piece {
    /// The longest side is from the first to the second.
    corners: [Point; 3],
}

fn middle(a: Point, b: Point) -> Point {
    [0, 1, 2].map(|axis| f64::midpoint(a[axis], b[axis]))
}

fn square(a: Point) -> f64 {
    dot(a, a)
}

/// A triangle of a part, or a part of one, from the part's middle in its unit.
#[derive(Clone, Copy)]
pub(crate) struct Part {
    pub(crate) index: u32,
    pub(crate) piece: Piece,
}

impl Piece {
    pub(crate) fn new([a, b, c]: [Point; 3]) -> Piece {
        let [ab, bc, ca] = [minus(b, a), minus(c, b), minus(a, c)].map(square);
        let corners = if ab >= bc && ab >= ca {
            [a, b, c]
        } else if bc >= ca {
            [b, c, a]
        } else {
            [c, a, b]
        };
        Piece { corners }
    }

    pub(crate) fn corners(&self) -> &[Point; 3] {
        &self.corners
    }

    /// Its longest side.
    pub(crate) fn longest(&self) -> f64 {
        square(minus(self.corners[1], self.corners[0])).sqrt()
    }

    /// A place of it, and how far it reaches from there.
    pub(crate) fn ball(&self) -> (Point, f64) {
        let [a, b, c] = self.corners;
        let mean = [0, 1, 2].map(|axis| (a[axis] + b[axis] + c[axis]) / 3.0);
        let [half, mean] = [middle(a, b), mean].map(|centre| {
            let far = [a, b, c].map(|corner| square(minus(corner, centre)));
            (centre, far[0].max(far[1]).max(far[2]).sqrt())
        });
        if half.1 < mean.1 { half } else { mean }
    }

    /// The corners of a rectangle of the half plane that what is no farther from it than `goes` is in.
    pub(crate) fn rectangle(&self, goes: f64) -> [[f64; 2]; 4] {
        let (mut far, mut low, mut high) = (0.0f64, f64::INFINITY, f64::NEG_INFINITY);
        for [x, y, z] in self.corners {
            far = far.max((x * x + y * y).sqrt());
            (low, high) = (low.min(z), high.max(z));
        }
        let (low, high, far) = (low - goes, high + goes, far + goes);
        [[0.0, low], [far, low], [far, high], [0.0, high]]
    }

    /// Both halves of its longest side; none if that is too short to be halved.
    pub(crate) fn halves(&self) -> impl Iterator<Item = Piece> + use<> {
        let [a, b, c] = self.corners;
        let half = middle(a, b);
        let halves = [Piece::new([a, half, c]), Piece::new([half, b, c])];
        halves.into_iter().filter(move |_| half != a && half != b)
    }
}
