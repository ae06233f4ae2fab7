//! Pieces of triangles, each of which stands for its part of the triangle's area.

use nalgebra::{Point3, center};
use std::collections::HashSet;
use touchoff::{Mesh, TriangleId};

/// A piece of a triangle: the whole triangle, or half of another piece, which was cut from the middle of its longest
/// edge to the opposite corner. Triangles that share an edge cut it at the same points.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Piece {
    triangle: TriangleId,
    /// A leading 1, then one bit per cut, the first cut first: 0 for the half at the start of the edge.
    path: u32,
}

impl Piece {
    /// Largest number of cuts.
    pub const MAX_CUTS: u32 = 31;

    /// Returns a whole triangle.
    pub fn whole(triangle: TriangleId) -> Piece {
        Piece { triangle, path: 1 }
    }

    /// Returns the piece of a triangle with a [`Piece::path`]; `None` for 0, which is none.
    pub fn from_path(triangle: TriangleId, path: u32) -> Option<Piece> {
        (path > 0).then_some(Piece { triangle, path })
    }

    /// Returns the triangle.
    pub fn triangle(self) -> TriangleId {
        self.triangle
    }

    /// Returns the cuts as a number: a leading 1, then a bit per cut, 0 for the half at the start of the longest edge.
    pub fn path(self) -> u32 {
        self.path
    }

    /// Returns the number of cuts.
    pub fn cuts(self) -> u32 {
        self.path.ilog2()
    }

    /// Returns the piece's fraction of the triangle's area.
    pub fn fraction(self) -> f64 {
        1.0 / (1u64 << self.cuts()) as f64
    }

    /// Returns both halves; `None` after [`Piece::MAX_CUTS`] cuts.
    pub fn halves(self) -> Option<[Piece; 2]> {
        let path = self.path.checked_mul(2)?;
        Some([path, path + 1].map(|path| Piece { path, ..self }))
    }

    /// Returns the piece that this one is a half of; `None` for a whole triangle.
    pub fn parent(self) -> Option<Piece> {
        Piece::from_path(self.triangle, self.path / 2)
    }

    /// Returns the corners, in the triangle's orientation.
    ///
    /// # Panics
    /// Panics if the mesh has no such triangle.
    pub fn corners(self, mesh: &Mesh) -> [Point3<f64>; 3] {
        (0..self.cuts()).rev().fold(mesh.triangle(self.triangle), |corners, bit| {
            halves(corners)[(self.path >> bit & 1) as usize]
        })
    }

    /// Returns the piece of a triangle at a point in its plane, out of pieces that cover it: those for which `contains`
    /// holds. The result is one of the smallest possible pieces if they do not cover the point.
    pub fn find(
        contains: impl Fn(Piece) -> bool,
        triangle: TriangleId,
        mesh: &Mesh,
        point: Point3<f64>,
    ) -> Piece {
        let (mut piece, mut corners) = (Piece::whole(triangle), mesh.triangle(triangle));
        while !contains(piece)
            && let Some(next) = piece.halves()
        {
            let halves = halves(corners);
            // The cut runs from the middle of an edge to the opposite corner.
            let [[start, middle, tip], _] = halves;
            let along = start - middle;
            let cut = tip - middle;
            let normal = along.cross(&cut).cross(&cut);
            let side = usize::from((point - middle).dot(&normal) * along.dot(&normal) < 0.0);
            (piece, corners) = (next[side], halves[side]);
        }
        piece
    }
}

/// Returns the halves of a triangle. Its longest edge is cut; of equal edges the first.
fn halves([a, b, c]: [Point3<f64>; 3]) -> [[Point3<f64>; 3]; 2] {
    let turns = [[a, b, c], [b, c, a], [c, a, b]];
    let length = |[from, to, _]: &[Point3<f64>; 3]| (to - from).norm_squared();
    let [from, to, tip] = turns
        .into_iter()
        .fold(turns[0], |best, turn| if length(&turn) > length(&best) { turn } else { best });
    // The sum does not depend on the order of the ends, so both triangles at the edge get the same point.
    let middle = center(&from, &to);
    [[from, middle, tip], [middle, to, tip]]
}

/// Returns the key of a point. Equal points have the same: the sum turns -0 into +0.
pub(super) fn key(point: Point3<f64>) -> [u64; 3] {
    [point.x, point.y, point.z].map(|coordinate| (coordinate + 0.0).to_bits())
}

/// Returns the length of the longest edge.
pub(super) fn longest_edge([a, b, c]: [Point3<f64>; 3]) -> f64 {
    (b - a).norm().max((c - b).norm()).max((a - c).norm())
}

/// Returns the smallest judged pieces that cover a triangle. A piece is replaced by its halves if judged pieces cover
/// both of them. `inner` has every piece of which a part was judged. The result is empty if nothing covers the triangle.
pub(super) fn tiling(
    whole: Piece,
    is_judged: impl Fn(Piece) -> bool,
    inner: &HashSet<Piece>,
) -> Vec<Piece> {
    let mut tiling = Tiling { is_judged, inner, pieces: Vec::new() };
    tiling.cover(whole);
    tiling.pieces
}

/// The search for the pieces that cover a triangle.
struct Tiling<'a, F> {
    is_judged: F,
    inner: &'a HashSet<Piece>,
    pieces: Vec<Piece>,
}

impl<F: Fn(Piece) -> bool> Tiling<'_, F> {
    /// Appends the pieces that cover a piece; returns whether there are any.
    fn cover(&mut self, piece: Piece) -> bool {
        let known = self.pieces.len();
        if self.inner.contains(&piece)
            && let Some([one, other]) = piece.halves()
        {
            if self.cover(one) && self.cover(other) {
                return true;
            }
            // At most one half is covered, so the piece itself has to serve.
            self.pieces.truncate(known);
        }
        let is_judged = (self.is_judged)(piece);
        self.pieces.extend(is_judged.then_some(piece));
        is_judged
    }
}

/// Adds all pieces that contain a piece to a set.
pub(super) fn add_ancestors(piece: Piece, inner: &mut HashSet<Piece>) {
    let mut next = piece.parent();
    // A piece that is there already has all its ancestors there.
    while let Some(piece) = next
        && inner.insert(piece)
    {
        next = piece.parent();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchoff::Unit;

    fn triangle() -> Mesh {
        let corners = [[0.0, 0.0, 1.0], [9.0, 1.0, 0.0], [2.0, 4.0, 3.0]];
        Mesh::new(corners.map(Point3::from).to_vec(), vec![[0, 1, 2]], Unit::Millimetre)
            .expect("a mesh")
    }

    fn area([a, b, c]: [Point3<f64>; 3]) -> f64 {
        0.5 * (b - a).cross(&(c - a)).norm()
    }

    #[test]
    fn halves_divide_area_and_keep_the_orientation() {
        let mesh = triangle();
        let mut pieces = vec![Piece::whole(TriangleId(0))];
        for cuts in 1..=8 {
            pieces = pieces.into_iter().flat_map(|piece| piece.halves().expect("few")).collect();
            for piece in &pieces {
                let [a, b, c] = piece.corners(&mesh);
                let fraction = area([a, b, c]) / mesh.area(TriangleId(0));
                assert!((fraction / piece.fraction() - 1.0).abs() < 1e-9, "{piece:?}");
                let normal = (b - a).cross(&(c - a)).normalize();
                let own = mesh.normal(TriangleId(0)).expect("an area");
                assert!((normal - own).norm() < 1e-9, "{piece:?}");
                assert_eq!(piece.cuts(), cuts);
                assert_eq!(
                    piece.parent().and_then(Piece::halves).map(|halves| halves.contains(piece)),
                    Some(true)
                );
            }
        }
        let smallest = pieces.iter().map(|piece| longest_edge(piece.corners(&mesh)));
        assert!(smallest.fold(0.0, f64::max) < 2.0);
        let deepest = Piece::from_path(TriangleId(0), u32::MAX).expect("a piece");
        assert_eq!((deepest.cuts(), deepest.halves()), (Piece::MAX_CUTS, None));
    }

    #[test]
    fn the_piece_at_a_point_is_found() {
        let mesh = triangle();
        let whole = Piece::whole(TriangleId(0));
        let [one, other] = whole.halves().expect("halves");
        let [third, fourth] = other.halves().expect("halves");
        let pieces: HashSet<Piece> = [one, third, fourth].into();
        for piece in &pieces {
            let [a, b, c] = piece.corners(&mesh);
            for [u, v] in [[0.1, 0.1], [0.8, 0.1], [0.1, 0.8], [0.3, 0.3]] {
                let point = a + (b - a) * u + (c - a) * v;
                let found =
                    Piece::find(|piece| pieces.contains(&piece), TriangleId(0), &mesh, point);
                assert_eq!(found, *piece);
            }
        }
    }

    #[test]
    fn a_tiling_has_the_smallest_pieces_that_cover_all() {
        let whole = Piece::whole(TriangleId(7));
        let [one, other] = whole.halves().expect("halves");
        let [third, fourth] = other.halves().expect("halves");
        let tiles = |judged: &[Piece]| {
            let mut inner = HashSet::new();
            judged.iter().for_each(|piece| add_ancestors(*piece, &mut inner));
            tiling(whole, |piece| judged.contains(&piece), &inner)
        };
        assert_eq!(tiles(&[]), []);
        assert_eq!(tiles(&[whole]), [whole]);
        assert_eq!(tiles(&[whole, one]), [whole]);
        assert_eq!(tiles(&[whole, one, other, third]), [one, other]);
        assert_eq!(tiles(&[whole, one, third, fourth]), [one, third, fourth]);
        assert_eq!(tiles(&[one, third]), []);
    }
}
