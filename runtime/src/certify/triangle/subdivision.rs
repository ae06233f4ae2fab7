//! Triangles for subdivision by halving.

use crate::certify::space::{Point, dot, minus};

/// A triangle, or a piece of one.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct SubTriangle {
    /// The corners; the longest side is from the first to the second.
    corners: [Point; 3],
}

fn middle(a: Point, b: Point) -> Point {
    [0, 1, 2].map(|axis| f64::midpoint(a[axis], b[axis]))
}

fn square(a: Point) -> f64 {
    dot(a, a)
}

/// A triangle of a part or a piece of one, relative to the part's origin and in the part's unit.
#[derive(Clone, Copy)]
pub(crate) struct TrianglePiece {
    pub(crate) index: u32,
    pub(crate) piece: SubTriangle,
}

impl SubTriangle {
    pub(crate) fn new([a, b, c]: [Point; 3]) -> SubTriangle {
        let [ab, bc, ca] = [minus(b, a), minus(c, b), minus(a, c)].map(square);
        let corners = if ab >= bc && ab >= ca {
            [a, b, c]
        } else if bc >= ca {
            [b, c, a]
        } else {
            [c, a, b]
        };
        SubTriangle { corners }
    }

    pub(crate) fn corners(&self) -> &[Point; 3] {
        &self.corners
    }

    /// Returns the length of its longest side.
    pub(crate) fn longest(&self) -> f64 {
        square(minus(self.corners[1], self.corners[0])).sqrt()
    }

    /// Returns the centre and radius of a ball that contains it.
    pub(crate) fn ball(&self) -> (Point, f64) {
        let [a, b, c] = self.corners;
        let mean = [0, 1, 2].map(|axis| (a[axis] + b[axis] + c[axis]) / 3.0);
        let [half, mean] = [middle(a, b), mean].map(|centre| {
            let far = [a, b, c].map(|corner| square(minus(corner, centre)));
            (centre, far[0].max(far[1]).max(far[2]).sqrt())
        });
        if half.1 < mean.1 { half } else { mean }
    }

    /// Returns the corners of a rectangle of the half plane with all points within `displacement` of the triangle.
    pub(crate) fn rectangle(&self, displacement: f64) -> [[f64; 2]; 4] {
        let (mut far, mut low, mut high) = (0.0f64, f64::INFINITY, f64::NEG_INFINITY);
        for [x, y, z] in self.corners {
            far = far.max((x * x + y * y).sqrt());
            (low, high) = (low.min(z), high.max(z));
        }
        let (low, high, far) = (low - displacement, high + displacement, far + displacement);
        [[0.0, low], [far, low], [far, high], [0.0, high]]
    }

    /// Returns both halves, cut at the middle of its longest side; none if that is too short to be halved.
    pub(crate) fn halves(&self) -> impl Iterator<Item = SubTriangle> + use<> {
        let [a, b, c] = self.corners;
        let half = middle(a, b);
        let halves = [SubTriangle::new([a, half, c]), SubTriangle::new([half, b, c])];
        halves.into_iter().filter(move |_| half != a && half != b)
    }
}
