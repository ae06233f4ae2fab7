//! Division of triangles where one point says too little about them.
//!
//! A [`Refiner`] proposes pieces to judge, round by round. The first round divides long triangles evenly. Every later
//! round halves the pieces that meet others, at a corner or along an edge, which the tools reach differently.

use super::SweepError;
use crate::MapRow;
use crate::directions::contains;
use crate::piece::{Piece, add_ancestors, key, longest_edge, tiling};
use nalgebra::{Point3, center};
use std::collections::{HashMap, HashSet};
use touchoff::{Mesh, Tool, TriangleId, Unit};

/// Lengths of edges at which triangles are divided, in the part's unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Refinement {
    /// A piece with a longer edge is always divided.
    pub longest: f64,
    /// A piece with a longer edge is divided where it differs from its neighbours.
    pub finest: f64,
}

/// Largest edge of pieces that do not differ, as a multiple of the largest of those that do.
const LONGEST_TO_FINEST: f64 = 8.0;
/// Largest edge of pieces that differ, as a fraction of the least radius of the tools' cutting parts. At a right-angled
/// corner of a part, the strip that a ball does not reach is then some four pieces wide, and no undivided piece
/// along the corner has its centroid beyond the strip.
const FINEST_TO_RADIUS: f64 = 0.25;
/// Difference in niceness at which neighbours differ, as a fraction of the greater niceness.
const NICENESS_DIFFERENCE: f64 = 0.1;
/// Largest number of pieces of a part.
const MAX_PIECES: usize = 1 << 24;

impl Refinement {
    /// Returns a refinement down to pieces with edges of at most `finest`, in the part's unit.
    pub fn down_to(finest: f64) -> Refinement {
        Refinement { longest: LONGEST_TO_FINEST * finest, finest }
    }

    /// Returns the refinement down to a quarter of the cutting radius of the tools' slimmest, in a part's unit.
    pub fn of_tools(tools: &[&dyn Tool], unit: Unit) -> Refinement {
        let radii = tools.iter().map(|tool| {
            let info = tool.info();
            let cutting = info.outline.iter().filter(|piece| info.surface(piece.surface).cutting);
            let farthest =
                cutting.flat_map(|piece| [piece.from[0], piece.to[0]]).fold(0.0, f64::max);
            farthest * info.unit.factor_to(unit)
        });
        // A tool without a profile has no such radius. If all are so, the length is infinite, which `Refiner::new` refuses.
        let least = radii.filter(|radius| *radius > 0.0).fold(f64::INFINITY, f64::min);
        Refinement::down_to(FINEST_TO_RADIUS * least)
    }

    fn check(self) -> Result<Refinement, SweepError> {
        let are_lengths = [self.longest, self.finest].iter().all(|l| l.is_finite() && *l > 0.0);
        if are_lengths { Ok(self) } else { Err(SweepError::PieceSize(self.finest)) }
    }
}

/// Result at a piece's centroid.
#[derive(Clone, Debug)]
struct Judgement {
    /// Bit set of the tools that reach it.
    reached: Vec<u64>,
    /// The tool of the best posture, and its niceness.
    best: Option<(u16, f64)>,
}

/// Part of a triangle that tools reach, by the pieces whose centroids they reach.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct TriangleReach {
    /// The triangle.
    pub triangle: TriangleId,
    /// Number of pieces; 1 for an undivided triangle.
    pub pieces: usize,
    /// Fraction of its area that any tool reaches.
    pub area_fraction: f64,
    /// Fraction of its area that each tool reaches.
    pub by_tool: Vec<f64>,
    /// The tool of the nicest posture; of several as nice that of the first piece.
    pub best: Option<u16>,
}

/// Divides triangles into pieces, by what is known of those judged so far.
///
/// Give it the rows of all triangles. Then judge what [`Refiner::next_pieces`] returns and give it the rows, until no
/// pieces are left. The pieces depend on the rows alone.
#[derive(Debug)]
pub struct Refiner<'a> {
    mesh: &'a Mesh,
    refinement: Refinement,
    tools: usize,
    judged: HashMap<Piece, Judgement>,
    /// All pieces of which a part was judged.
    inner: HashSet<Piece>,
}

impl<'a> Refiner<'a> {
    /// Creates a refiner for a sweep of some tools over a mesh.
    ///
    /// # Errors
    /// [`SweepError::PieceSize`] if a length is not finite and above 0.
    pub fn new(
        mesh: &'a Mesh,
        tools: usize,
        refinement: Refinement,
    ) -> Result<Refiner<'a>, SweepError> {
        let (judged, inner) = (HashMap::new(), HashSet::new());
        Ok(Refiner { mesh, refinement: refinement.check()?, tools, judged, inner })
    }

    /// Adds the row of a judged piece.
    pub fn add(&mut self, piece: Piece, row: &MapRow) {
        let mut reached = vec![0; self.tools.div_ceil(64)];
        for access in &row.access {
            if access.is_reached() {
                reached[usize::from(access.tool) / 64] |= 1 << (access.tool % 64);
            }
        }
        let best = row.best.first().map(|best| (best.tool, best.niceness));
        self.judged.insert(piece, Judgement { reached, best });
        add_ancestors(piece, &mut self.inner);
    }

    /// Returns the pieces to judge next, those of a triangle together; none if the refinement is complete.
    ///
    /// # Errors
    /// [`SweepError::TooManyPieces`] if the part would have more than 2²⁴ pieces.
    pub fn next_pieces(&self) -> Result<Vec<Piece>, SweepError> {
        let leaves: Vec<(Piece, [Point3<f64>; 3])> = self
            .mesh
            .ids()
            .filter(|id| self.mesh.normal(*id).is_some())
            .flat_map(|id| self.pieces(id))
            .map(|piece| (piece, piece.corners(self.mesh)))
            .collect();
        let Refinement { longest, finest } = self.refinement;
        let room = MAX_PIECES.saturating_sub(leaves.len());
        let too_many = SweepError::TooManyPieces { finest, limit: MAX_PIECES };
        let mut next = Vec::new();
        // The first rounds divide what is too long; only when nothing is are neighbours compared.
        let long = leaves.iter().filter(|(_, corners)| longest_edge(*corners) > longest);
        // A triangle whose edges are no longer than `longest` has at most the area of the equilateral one, so the pieces are at least as many
        // as these fit into what is divided. The excess is far above the rounding of a sum of areas.
        let area = |piece: &Piece| self.mesh.area(piece.triangle()) * piece.fraction();
        let divided: f64 = long.clone().map(|(piece, _)| area(piece)).sum();
        let largest = 0.25 * 3f64.sqrt() * longest * longest;
        if divided > 1.001 * largest * room as f64 {
            return Err(too_many);
        }
        let mut open: Vec<Piece> = long.map(|(piece, _)| *piece).collect();
        // The stack gives the last first; reversed, the pieces of a triangle stay together and in order.
        open.reverse();
        while let Some(piece) = open.pop() {
            match piece.halves() {
                Some([one, other]) if longest_edge(piece.corners(self.mesh)) > longest => {
                    open.extend([other, one]);
                }
                _ => next.push(piece),
            }
            if next.len() + open.len() > room {
                return Err(too_many);
            }
        }
        if next.is_empty() {
            let corners = Corners::new(leaves.iter().map(|(piece, at)| (*at, &self.judged[piece])));
            for (piece, at) in &leaves {
                if longest_edge(*at) > finest && corners.differ_around(*at) {
                    next.extend(piece.halves().into_iter().flatten());
                }
            }
        }
        if next.len() > room { Err(too_many) } else { Ok(next) }
    }

    /// Returns the reach of the tools at each triangle that was judged.
    pub fn reach(&self) -> impl Iterator<Item = TriangleReach> + '_ {
        self.mesh.ids().filter_map(|triangle| {
            let pieces = self.pieces(triangle);
            let by_tool = (0..self.tools)
                .map(|tool| self.fraction(&pieces, |judgement| contains(&judgement.reached, tool)));
            let best = pieces.iter().filter_map(|piece| self.judged[piece].best);
            // `max_by` would return the last of several that are as nice.
            let best = best.reduce(|one, other| if other.1 > one.1 { other } else { one });
            (!pieces.is_empty()).then(|| TriangleReach {
                triangle,
                pieces: pieces.len(),
                area_fraction: self.fraction(&pieces, |judgement| judgement.best.is_some()),
                by_tool: by_tool.collect(),
                best: best.map(|(tool, _)| tool),
            })
        })
    }

    /// Returns the fraction of a triangle's area at those of its pieces whose judgement meets a condition.
    fn fraction(&self, pieces: &[Piece], is_reached: impl Fn(&Judgement) -> bool) -> f64 {
        let reached = pieces.iter().filter(|piece| is_reached(&self.judged[*piece]));
        reached.map(|piece| piece.fraction()).sum()
    }

    /// Returns the pieces of a triangle.
    fn pieces(&self, triangle: TriangleId) -> Vec<Piece> {
        tiling(Piece::whole(triangle), |piece| self.judged.contains_key(&piece), &self.inner)
    }
}

/// Summary of the judgements at the pieces that meet in a point.
#[derive(Clone, Debug)]
struct Summary {
    /// Tools that reach some of them.
    some: Vec<u64>,
    /// Tools that reach all of them.
    all: Vec<u64>,
    /// Least and greatest niceness of the best postures, if there are any.
    niceness: Option<[f64; 2]>,
}

impl Summary {
    fn of(judgement: &Judgement) -> Summary {
        let Judgement { reached, best } = judgement;
        let niceness = best.map(|(_, niceness)| [niceness; 2]);
        Summary { some: reached.clone(), all: reached.clone(), niceness }
    }

    fn join(&mut self, other: &Summary) {
        self.some.iter_mut().zip(&other.some).for_each(|(some, word)| *some |= word);
        self.all.iter_mut().zip(&other.all).for_each(|(all, word)| *all &= word);
        self.niceness = match (self.niceness, other.niceness) {
            (Some([low, high]), Some([l, h])) => Some([low.min(l), high.max(h)]),
            (one, other) => one.or(other),
        };
    }

    /// Returns whether a tool reaches only some of the pieces, or some of them much more nicely.
    fn differs(&self) -> bool {
        let niceness = self.niceness.is_some_and(|[low, high]| {
            high - low > NICENESS_DIFFERENCE * low.abs().max(high.abs())
        });
        niceness || self.some != self.all
    }
}

/// Judgements by the corners of the pieces.
struct Corners(HashMap<[u64; 3], Summary>);

impl Corners {
    fn new<'a>(pieces: impl Iterator<Item = ([Point3<f64>; 3], &'a Judgement)>) -> Corners {
        let mut corners: HashMap<[u64; 3], Summary> = HashMap::new();
        for (at, judgement) in pieces {
            let summary = Summary::of(judgement);
            for corner in at {
                corners
                    .entry(key(corner))
                    .and_modify(|known| known.join(&summary))
                    .or_insert_with(|| summary.clone());
            }
        }
        Corners(corners)
    }

    /// Returns whether the pieces differ that meet at a piece's corners or along its edges.
    fn differ_around(&self, [a, b, c]: [Point3<f64>; 3]) -> bool {
        let mut summary = self.0[&key(a)].clone();
        [b, c].iter().for_each(|corner| summary.join(&self.0[&key(*corner)]));
        for [from, to] in [[a, b], [b, c], [c, a]] {
            self.join_edge([from, to], &mut summary);
        }
        summary.differs()
    }

    /// Joins the corners of smaller pieces that lie on an edge.
    fn join_edge(&self, [from, to]: [Point3<f64>; 2], summary: &mut Summary) {
        let middle = center(&from, &to);
        if middle == from || middle == to {
            return;
        }
        // Every cut begins at the middle of an edge, so an edge without a corner there was not cut at all.
        if let Some(known) = self.0.get(&key(middle)) {
            summary.join(known);
            self.join_edge([from, middle], summary);
            self.join_edge([middle, to], summary);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Accessibility, PostureRecord};
    use touchoff::mesh::shapes;

    /// Returns a row of one tool, with or without a posture.
    fn row(niceness: Option<f64>) -> MapRow {
        let record = |niceness| PostureRecord {
            tool: 0,
            tip: [0.0; 3],
            axis: [0.0, 0.0, 1.0],
            niceness,
            depth: 0.0,
            clearance: 1.0,
        };
        let directions = vec![u64::from(niceness.is_some())];
        let access = vec![Accessibility { tool: 0, directions, stickout: None }];
        MapRow { best: niceness.map(record).into_iter().collect(), access }
    }

    /// Refines a plate of two triangles, 8 by 8 about the origin, whose rows depend on the point.
    fn refined(at: impl Fn(Point3<f64>) -> MapRow, refinement: Refinement) -> (usize, f64) {
        let mesh = shapes::plane(4.0, 1, Unit::Millimetre).expect("a plate");
        let mut refiner = Refiner::new(&mesh, 1, refinement).expect("lengths");
        let mut next: Vec<Piece> = mesh.ids().map(Piece::whole).collect();
        let mut judged = 0;
        while !next.is_empty() {
            for piece in next {
                let [a, b, c] = piece.corners(&mesh);
                refiner.add(piece, &at(Point3::from((a.coords + b.coords + c.coords) / 3.0)));
                judged += 1;
            }
            next = refiner.next_pieces().expect("few pieces");
        }
        let area = mesh.ids().map(|id| mesh.area(id)).sum::<f64>();
        let reached = refiner.reach().map(|reach| reach.area_fraction * mesh.area(reach.triangle));
        (judged, reached.sum::<f64>() / area)
    }

    #[test]
    fn pieces_follow_a_border() {
        let disc = |point: Point3<f64>| row((point.coords.norm() < 1.3).then_some(1.0));
        let side = shapes::plane(4.0, 1, Unit::Millimetre).expect("a plate").bounds();
        let area = (side[1] - side[0]).x.powi(2);
        let truth = std::f64::consts::PI * 1.3f64.powi(2) / area;
        let (judged, found) = refined(disc, Refinement::down_to(0.1));
        assert!((found / truth - 1.0).abs() < 0.03, "{found}, not {truth}, of {judged}");
        let (all, even) = refined(disc, Refinement { longest: 0.1, finest: 0.1 });
        assert!((even / truth - 1.0).abs() < 0.03, "{even}, not {truth}");
        assert!(judged < all / 4, "{judged} judged, evenly {all}");
    }

    #[test]
    fn what_is_alike_is_divided_no_further_than_long_pieces() {
        let [plain, nicer] = [
            refined(|_| row(Some(1.0)), Refinement { longest: 3.0, finest: 0.2 }),
            refined(
                |point| row(Some(if point.x < 0.3 { 1.0 } else { 0.8 })),
                Refinement { longest: 3.0, finest: 0.2 },
            ),
        ];
        assert!(plain.0 < 70, "{plain:?}");
        assert!(nicer.0 > 2 * plain.0, "{nicer:?}");
        assert!((plain.1 - 1.0).abs() < 1e-12 && (nicer.1 - 1.0).abs() < 1e-12);
    }

    #[test]
    fn invalid_lengths_and_too_many_pieces_are_refused() {
        let mesh = shapes::plane(4.0, 1, Unit::Millimetre).expect("a plate");
        for finest in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            let refused = Refiner::new(&mesh, 1, Refinement::down_to(finest));
            assert!(matches!(refused, Err(SweepError::PieceSize(_))), "{finest}");
        }
        let mut refiner = Refiner::new(&mesh, 1, Refinement::down_to(1e-6)).expect("lengths");
        mesh.ids().for_each(|id| refiner.add(Piece::whole(id), &row(None)));
        let error = refiner.next_pieces().expect_err("too many");
        assert!(matches!(error, SweepError::TooManyPieces { .. }), "{error}");
    }
}
