//! A profile of lines and arcs, and its nearest piece by exhaustive search.
//!
//! For a surface of revolution the nearest surface point lies in the half plane through the query point, so two
//! dimensions are enough; the axis is a mirror and not a feature. Each piece counts only for points whose foot lies
//! on it, and each vertex for all points. The smallest distance wins, and among equals the feature listed first.
//! Inside is decided by crossings (even-odd), not by the nearest piece.

use super::piece::{P2, Piece, cross, dot, len, sub};
use super::unit_or_z;

/// The turn of the profile at a vertex.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Turn {
    /// An end of the profile, on the axis.
    Axis,
    /// The material fills less than a half turn: nearest from outside only.
    Convex,
    /// No turn: the vertex owns nothing.
    Smooth,
    /// The material fills more than a half turn: the vertex owns a fan inside, with this rank.
    Reflex(usize),
}

#[derive(Clone, Copy, Debug)]
struct Vertex {
    point: P2,
    turn: Turn,
}

/// The nearest feature of a profile.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NearestFeature {
    /// Index in the order of listing. For a convex vertex (outside only), that of the piece listed first of the two
    /// that meet there.
    pub owner: usize,
    /// Distance to the foot.
    pub distance: f64,
    /// The nearest point of the profile.
    pub foot: P2,
    /// True if the foot is a reflex corner that owns the point.
    pub corner: bool,
}

/// A closed profile from the axis to the axis, counter-clockwise with `d` to the right and `z` up.
#[derive(Clone, Debug)]
pub struct Profile {
    pieces: Vec<Piece>,
    vertices: Vec<Vertex>,
    owners: Vec<Feature>,
}

/// The specification of a piece: its end, and its centre if it is an arc.
pub type SegmentSpec = ([f64; 2], Option<[f64; 2]>);

/// A feature that may own points inside.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Feature {
    /// A piece, by its index.
    Piece(usize),
    /// The reflex corner behind a piece, by the piece's index.
    Corner(usize),
}

impl Profile {
    /// Creates the profile that starts at `start` and goes on through `drafts`. Owners are numbered along it, each
    /// reflex corner between its pieces; the first wins a tie.
    pub fn new(start: P2, segments: &[SegmentSpec]) -> Self {
        let mut at = start;
        let mut pieces: Vec<Piece> = Vec::new();
        let mut vertices = vec![Vertex { point: start, turn: Turn::Axis }];
        let mut owners = Vec::new();
        for (index, &(to, centre)) in segments.iter().enumerate() {
            let mut piece = Piece::new(at, to, centre, 0);
            if let Some(before) = pieces.last() {
                let bend = cross(before.tangent(at), piece.tangent(at));
                let turn = if bend < -1e-12 {
                    owners.push(Feature::Corner(index - 1));
                    Turn::Reflex(owners.len() - 1)
                } else if bend > 1e-12 {
                    Turn::Convex
                } else {
                    Turn::Smooth
                };
                vertices.push(Vertex { point: at, turn });
            }
            piece.rank = owners.len();
            owners.push(Feature::Piece(index));
            pieces.push(piece);
            at = to;
        }
        vertices.push(Vertex { point: at, turn: Turn::Axis });
        Self { pieces, vertices, owners }
    }

    /// Returns the turn behind a piece.
    pub fn turn(&self, piece: usize) -> Turn {
        self.vertices[piece + 1].turn
    }

    /// Returns the features that may own points inside, in the order of listing.
    pub fn owners(&self) -> &[Feature] {
        &self.owners
    }

    /// Returns the nearest feature, from inside or outside.
    ///
    /// Beside a fan or joint, the distances of two features differ only by the square of the distance from their
    /// border, far below rounding. Each feature therefore counts only on its own side, and ties are left for the
    /// borders themselves.
    pub fn nearest(&self, p: P2) -> NearestFeature {
        let mut best = NearestFeature { owner: 0, distance: f64::INFINITY, foot: p, corner: false };
        for piece in self.pieces.iter().filter(|piece| piece.faces(p)) {
            let (owner, distance) = (piece.rank, piece.distance(p));
            if (distance, owner) < (best.distance, best.owner) {
                best = NearestFeature { owner, distance, foot: piece.foot(p), corner: false };
            }
        }
        for (i, v) in self.vertices.iter().enumerate() {
            let neighbour = [i.checked_sub(1), Some(i)].map(|k| self.pieces.get(k?));
            let from = sub(p, v.point);
            let in_fan = neighbour.iter().zip([1.0, -1.0]).all(|(piece, sign)| {
                piece.is_none_or(|piece| sign * dot(from, piece.tangent(v.point)) >= 0.0)
            });
            let first = neighbour.iter().flatten().map(|piece| piece.rank).min();
            let (owner, corner) = match v.turn {
                Turn::Reflex(rank) => (rank, true),
                _ => (first.unwrap_or(0), false),
            };
            // A joint, and a corner outside its fan, only catch points that rounding let fall between their
            // neighbours.
            let distance = len(from);
            let wins = match v.turn {
                Turn::Reflex(_) if in_fan => (distance, owner) < (best.distance, best.owner),
                Turn::Reflex(_) | Turn::Smooth => distance < best.distance * (1.0 - 1e-9),
                Turn::Axis | Turn::Convex => distance < best.distance,
            };
            if wins {
                best = NearestFeature { owner, distance, foot: v.point, corner };
            }
        }
        best
    }

    /// Returns the distance to a piece, its ends included, from either side.
    pub fn distance_to_piece(&self, piece: usize, p: P2) -> f64 {
        self.pieces[piece].clamped(p)
    }

    /// Returns whether `p` is in the solid or on its surface.
    pub fn contains(&self, p: P2) -> bool {
        self.encloses(p) || self.nearest(p).distance == 0.0
    }

    /// Returns, for a point of the solid, its nearest feature and the unit vector `(radial, axial)` toward it;
    /// `None` outside.
    pub fn evaluate(&self, p: P2) -> Option<(NearestFeature, P2)> {
        let near = self.nearest(p);
        (near.distance == 0.0 || self.encloses(p)).then(|| (near, self.direction(&near, p)))
    }

    /// Applies the even-odd rule on the ray from `p` away from the axis. Undecided on the surface.
    fn encloses(&self, p: P2) -> bool {
        let crossed = self.pieces.iter().map(|piece| piece.crossings(p)).sum::<usize>();
        crossed % 2 == 1
    }

    /// Returns the signed distance to the surface, negative inside.
    pub fn signed_distance(&self, p: P2) -> f64 {
        let distance = self.nearest(p).distance;
        if self.contains(p) { -distance } else { distance }
    }

    fn direction(&self, near: &NearestFeature, p: P2) -> P2 {
        if near.corner {
            return unit_or_z(sub(near.foot, p));
        }
        self.owner_piece(near, p).outward(p)
    }

    /// Returns a lower bound of the distance to the surface and to the curves on which the nearest feature changes;
    /// outside, of the distance to the surface only.
    ///
    /// Two features meet either at a shared fan line or joint, whose distance is plain, or on the curve where their
    /// distances agree. Distances are 1-Lipschitz, so that curve is at least half their difference away.
    pub fn border_distance(&self, p: P2) -> f64 {
        let near = self.nearest(p);
        if !self.contains(p) {
            return near.distance;
        }
        let mut min_distance = near.distance;
        let mut linked = vec![near.owner];
        for (i, v) in self.vertices.iter().enumerate() {
            let (Some(before), Some(after)) =
                (i.checked_sub(1).map(|k| self.pieces[k]), self.pieces.get(i))
            else {
                continue;
            };
            let fan = match v.turn {
                Turn::Reflex(rank) => Some(rank),
                Turn::Smooth => None,
                Turn::Axis | Turn::Convex => continue,
            };
            let owners = [Some(before.rank), fan, Some(after.rank)];
            if owners.contains(&Some(near.owner)) {
                linked.extend(owners.into_iter().flatten());
                for tangent in [before.tangent(v.point), after.tangent(v.point)] {
                    min_distance = min_distance.min(dot(sub(p, v.point), tangent).abs());
                }
            }
        }
        for piece in self.pieces.iter().filter(|piece| !linked.contains(&piece.rank)) {
            min_distance = min_distance.min((piece.clamped(p) - near.distance) / 2.0);
        }
        for v in &self.vertices {
            if matches!(v.turn, Turn::Reflex(rank) if !linked.contains(&rank)) {
                min_distance = min_distance.min((len(sub(p, v.point)) - near.distance) / 2.0);
            }
        }
        min_distance.max(0.0)
    }

    /// Returns the distance defined at [`super::Oracle::singularity_distance`].
    pub fn singularity_distance(&self, p: P2) -> f64 {
        let Some((near, direction)) = self.evaluate(p) else {
            return f64::INFINITY;
        };
        let axis = if direction[0] == 0.0 { f64::INFINITY } else { p[0] };
        let point = if near.corner {
            near.distance
        } else {
            let centre = self.owner_piece(&near, p).centre();
            centre.map_or(f64::INFINITY, |centre| len(sub(p, centre)))
        };
        axis.min(point)
    }

    /// Returns the vertices, and the centres of arcs.
    pub fn corners(&self) -> Vec<P2> {
        let vertices = self.vertices.iter().map(|v| v.point);
        vertices.chain(self.pieces.iter().filter_map(Piece::centre)).collect()
    }

    /// Returns points along each piece.
    pub fn surface(&self) -> Vec<Vec<P2>> {
        self.pieces.iter().map(Piece::samples).collect()
    }

    /// Returns the piece with the owner's rank whose foot is the nearest point; failing that, the first with that
    /// rank.
    fn owner_piece(&self, near: &NearestFeature, p: P2) -> &Piece {
        let owned_pieces = || self.pieces.iter().filter(|piece| piece.rank == near.owner);
        let facing = owned_pieces().find(|piece| piece.faces(p) && piece.foot(p) == near.foot);
        facing.or_else(|| owned_pieces().next()).unwrap_or(&self.pieces[0])
    }
}

#[cfg(test)]
mod tests {
    use super::super::rng::Rng;
    use super::*;

    /// A body with a neck: convex and concave arcs, a taper, both kinds of corner.
    fn vase() -> Profile {
        Profile::new(
            [0.0, 0.0],
            &[
                ([2.0, 2.0], Some([0.0, 2.0])),
                ([1.0, 3.0], Some([2.0, 3.0])),
                ([3.0, 5.0], None),
                ([3.0, 6.0], None),
                ([0.0, 6.0], None),
            ],
        )
    }

    /// Compares with a polyline so fine that only its sagitta (below 1e-6) is left.
    #[test]
    fn distances_agree_with_a_fine_polyline() {
        let vase = vase();
        let fine: Vec<_> = vase.pieces.iter().flat_map(|piece| piece.chords(2000)).collect();
        let mut rng = Rng::new(5);
        for _ in 0..2_000 {
            let p = [rng.between(0.0, 5.0), rng.between(-2.0, 8.0)];
            let polyline = fine.iter().map(|&(a, b)| {
                let e = sub(b, a);
                let t = (dot(sub(p, a), e) / dot(e, e)).clamp(0.0, 1.0);
                len([p[0] - a[0] - t * e[0], p[1] - a[1] - t * e[1]])
            });
            let min_distance = polyline.fold(f64::INFINITY, f64::min);
            let near = vase.nearest(p);
            assert!((min_distance - near.distance).abs() < 1e-6, "{p:?}");
            assert!((len(sub(p, near.foot)) - near.distance).abs() < 1e-14);
        }
    }

    /// Compares two unlike tests: even-odd, and the side of the nearest feature.
    #[test]
    fn inside_agrees_with_the_side_of_the_nearest_feature() {
        let vase = vase();
        let mut rng = Rng::new(6);
        for _ in 0..100_000 {
            let p = [rng.between(0.0, 4.0), rng.between(-1.0, 7.0)];
            let near = vase.nearest(p);
            if near.distance < 1e-12 {
                continue;
            }
            let at_vertex = vase.vertices.iter().any(|v| v.point == near.foot);
            let inside = near.corner
                || (!at_vertex && {
                    let piece = vase.owner_piece(&near, p);
                    cross(piece.tangent(near.foot), sub(p, near.foot)) > 0.0
                });
            assert_eq!(inside, vase.contains(p), "{p:?} {near:?}");
        }
    }

    #[test]
    fn directions_step_onto_the_surface() {
        let vase = vase();
        let mut rng = Rng::new(7);
        for _ in 0..100_000 {
            let p = [rng.between(0.0, 4.0), rng.between(-1.0, 7.0)];
            let Some((near, u)) = vase.evaluate(p) else {
                continue;
            };
            for k in 0..2 {
                assert!(
                    (p[k] + near.distance * u[k] - near.foot[k]).abs() < 1e-13,
                    "{p:?} {near:?} {u:?}"
                );
            }
        }
    }

    #[test]
    fn the_surface_belongs_to_the_solid() {
        let vase = vase();
        for p in vase.corners() {
            let centre = vase.pieces.iter().any(|piece| piece.centre() == Some(p));
            assert!(centre || vase.contains(p), "{p:?}");
        }
        for p in [[0.0, 0.0], [3.0, 5.5], [1.5, 6.0], [3.0, 6.0], [2.0, 2.0]] {
            assert!(vase.contains(p) && vase.nearest(p).distance == 0.0, "{p:?}");
        }
    }
}
