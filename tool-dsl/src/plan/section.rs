//! The plan of a profile's tool: the partition is known as polygons, and splits cut them until one
//! owner is left.

use super::shape::{Cutter, Edge, Piece, Shape};
use super::{LARGEST, Tree, costs};
use crate::expr::Id;
use crate::formula::{CurveIndex, Formula};
use crate::model::{Model, Section};
use crate::regionalise::cells::Cell;
use crate::regionalise::outline::{Point, minus, norm};
use crate::report::Report;
use std::cmp::Ordering;

/// Chords of a curved edge, at first and where so few misled.
const CHORDS: [u32; 2] = [8, 40];

type Owners = Tree<Option<usize>>;

/// Bits that an addition must be worth.
const PRICE: f64 = 0.01;
/// What a test costs that the tree does elsewhere too: lanes do it once.
const AGAIN: f64 = 0.3;

/// The owners' tree, and that of the features which are nearest outside.
pub(super) fn trees(model: &Model, section: &Section) -> Result<(Owners, Tree<Id>), Report> {
    let mut tried = try_trees(model, section, CHORDS[0]);
    for chords in &CHORDS[1..] {
        if tried.is_err() {
            tried = try_trees(model, section, *chords);
        }
    }
    tried
}

fn try_trees(model: &Model, section: &Section, chords: u32) -> Result<(Owners, Tree<Id>), Report> {
    let (inner, outer) = (section.inner.cells(chords), section.outer.cells(chords));
    let of = |cell: &Cell| Some(cell.part);
    let outside: Vec<_> = outer.iter().map(|cell| (cell, of(cell))).collect();
    let all = inner.iter().map(|cell| (cell, of(cell)));
    let all: Vec<_> = all.chain(outer.iter().map(|cell| (cell, None))).collect();
    let inside = model.regions.iter().map(|region| &region.inside).collect();
    let beside = section.outside.iter().map(|part| &part.beside).collect();
    let owners = plan(model, &all, inside)?;
    let outside = plan(model, &outside, beside)?;
    let clearance = |part: &Option<usize>| part.map(|part| section.outside[part].clearance);
    let outside = outside.map(&clearance);
    Ok((owners, outside.unwrap_or(Tree::Leaf(section.outside[0].clearance))))
}

/// Plans by cells; each names its owner by its place in the model's list, `None` outside.
///
/// Curved edges are chords here, so a cut may leave a sliver that is nobody's; `inside` are the
/// owners' conditions, by which such are told.
fn plan(
    model: &Model,
    cells: &[(&Cell, Option<usize>)],
    inside: Vec<&Formula>,
) -> Result<Owners, Report> {
    let near = cells.iter().filter(|(_, owner)| owner.is_some());
    let vertices = || near.clone().flat_map(|(cell, _)| &cell.vertices);
    let [low, high] = [f64::min, f64::max].map(|pick: fn(f64, f64) -> f64| {
        [0, 1].map(|k| vertices().map(|p| p[k]).reduce(pick).unwrap_or(0.0))
    });
    let middle = [0, 1].map(|k| low[k] / 2.0 + high[k] / 2.0);
    let shapes: Vec<Shape<'_>> =
        model.curves.iter().map(|curve| Shape::new(&model.graph, curve.value, middle)).collect();
    let samples: Vec<Sample> = cells
        .iter()
        .flat_map(|(cell, owner)| cell.samples.iter().map(|(p, weight)| (*p, *weight, *owner)))
        .map(|(p, weight, owner)| Sample {
            below: shapes.iter().map(|shape| shape.below(p)).collect(),
            weight,
            owner,
        })
        .collect();
    let size = norm(minus(high, low));
    let pieces = cells.iter().map(|(cell, owner)| piece(cell, *owner, &shapes, size)).collect();
    let all = (0..samples.len() as u32).collect();
    let mut planner = Planner {
        model,
        shapes,
        costs: costs(model),
        samples,
        inside,
        used: vec![false; model.curves.len()],
        size,
        tests: 0,
    };
    let open = (0..model.curves.len()).collect();
    let tree = planner.tree(pieces, all, open)?;
    for (cell, owner) in cells {
        for p in &cell.witnesses {
            if tree.at(&|curve| planner.shapes[curve].value(*p)) != owner {
                return Err(planner.inseparable(*p));
            }
        }
    }
    Ok(tree)
}

/// A cell as a piece whose curved edges know their curve.
fn piece(cell: &Cell, owner: Option<usize>, shapes: &[Shape<'_>], size: f64) -> Piece {
    let count = cell.vertices.len();
    let mut edges = vec![Edge::Straight; count];
    let mut run: Vec<usize> = Vec::new();
    for k in 0..=count {
        if k < count && !cell.straight[k] {
            run.push(k);
        } else if !run.is_empty() {
            let on = |shape: &Shape<'_>| {
                run.iter().all(|k| {
                    [*k, (*k + 1) % count].iter().all(|v| shape.side(cell.vertices[*v], size) == 0)
                })
            };
            let edge = shapes.iter().position(on).map_or(Edge::Chord, Edge::Along);
            run.drain(..).for_each(|k| edges[k] = edge);
        }
    }
    Piece { owner, vertices: cell.vertices.clone(), edges }
}

/// A point: on which side of each curve it lies, and how much it counts.
struct Sample {
    below: Vec<bool>,
    weight: f64,
    owner: Option<usize>,
}

struct Planner<'m> {
    model: &'m Model,
    shapes: Vec<Shape<'m>>,
    costs: Vec<f64>,
    samples: Vec<Sample>,
    inside: Vec<&'m Formula>,
    used: Vec<bool>,
    size: f64,
    tests: usize,
}

/// Pieces on the two sides of a curve.
struct Halves {
    below: Vec<Piece>,
    above: Vec<Piece>,
}

impl Planner<'_> {
    fn tree(
        &mut self,
        pieces: Vec<Piece>,
        samples: Vec<u32>,
        mut open: Vec<CurveIndex>,
    ) -> Result<Owners, Report> {
        let Some(first) = pieces.first() else { return Ok(Tree::Leaf(None)) };
        if pieces.iter().all(|piece| piece.owner == first.owner) {
            return Ok(Tree::Leaf(first.owner));
        }
        let Some((curve, halves)) = self.choose(&pieces, &samples, &mut open) else {
            return Ok(Tree::Leaf(self.settle(&pieces)));
        };
        self.used[curve] = true;
        self.tests += 1;
        if self.tests > LARGEST {
            return Err(Report::error(
                self.model.name_span,
                format!("the regions need more than {LARGEST} tests to tell apart"),
            )
            .help("divide the tool by fewer curves"));
        }
        open.retain(|other| *other != curve);
        let (low, high): (Vec<u32>, Vec<u32>) =
            samples.into_iter().partition(|s| self.samples[*s as usize].below[curve]);
        let zeros = self.zeros(curve, &halves);
        let on = match zeros {
            Zeros::Both => Some(self.touching(curve, &halves, &open)?),
            _ => None,
        };
        let below = self.tree(halves.below, low, open.clone())?;
        let above = self.tree(halves.above, high, open)?;
        Ok(match on {
            Some(on) if on == above => Tree::split(curve, true, below, above),
            Some(on) if on != below => {
                let below = Tree::split(curve, true, below, on);
                Tree::split(curve, false, below, above)
            }
            _ => Tree::split(curve, zeros == Zeros::Above, below, above),
        })
    }

    /// The curve that tells most about the owners for what it costs, and what it divides.
    fn choose(
        &self,
        pieces: &[Piece],
        samples: &[u32],
        open: &mut Vec<CurveIndex>,
    ) -> Option<(CurveIndex, Halves)> {
        let mut ranked: Vec<(f64, CurveIndex)> = open
            .iter()
            .map(|curve| {
                let again = if self.used[*curve] { AGAIN } else { 1.0 };
                (self.gain(*curve, samples) - PRICE * again * self.costs[*curve], *curve)
            })
            .collect();
        let listed = |curve: CurveIndex| self.model.first.iter().position(|f| *f == curve);
        ranked.sort_by(|a, b| {
            let order = |curve| listed(curve).unwrap_or(usize::MAX);
            order(a.1).cmp(&order(b.1)).then(b.0.total_cmp(&a.0))
        });
        let mut fallback = None;
        for (_, curve) in ranked {
            let halves = self.halves(curve, pieces);
            if halves.below.is_empty() || halves.above.is_empty() {
                open.retain(|other| *other != curve);
                continue;
            }
            // A curve that only cuts through cells brings nobody apart; keep it for later.
            let owners = |pieces: &[Piece]| {
                let mut owners: Vec<_> = pieces.iter().map(|piece| piece.owner).collect();
                owners.sort_unstable();
                owners.dedup();
                owners.len()
            };
            let all = owners(pieces);
            if owners(&halves.below) < all || owners(&halves.above) < all {
                return Some((curve, halves));
            }
            fallback = fallback.or(Some((curve, halves)));
        }
        fallback
    }

    /// Whose pieces are that no curve tells apart: slivers between a curve and its chord, but for
    /// one owner's.
    fn settle(&self, pieces: &[Piece]) -> Option<usize> {
        let true_ones: Vec<&Piece> = pieces.iter().filter(|piece| self.owns(piece)).collect();
        let rest = if true_ones.is_empty() { pieces.iter().collect() } else { true_ones };
        let largest = rest.into_iter().max_by(|a, b| a.area().total_cmp(&b.area()));
        largest.and_then(|piece| piece.owner)
    }

    /// Whether a piece is its owner's, in its middle.
    fn owns(&self, piece: &Piece) -> bool {
        let middle = piece.middle();
        let value = |curve: CurveIndex| self.shapes[curve].value(middle);
        match piece.owner {
            Some(owner) => self.inside[owner].holds(&value),
            None => !self.inside.iter().any(|inside| inside.holds(&value)),
        }
    }

    fn inseparable(&self, [d, z]: Point) -> Report {
        let z = self.model.frame.to_file(z);
        Report::error(
            self.model.name_span,
            format!("no curve tells the nearest features apart near ({d:.4}, {z:.4})"),
        )
        .help("features closer than 10^-10 of the tool's size cannot be told apart")
    }

    fn halves(&self, curve: CurveIndex, pieces: &[Piece]) -> Halves {
        let mut halves = Halves { below: Vec::new(), above: Vec::new() };
        for piece in pieces {
            let [below, above] = piece.cut(Cutter { shapes: &self.shapes, curve, size: self.size });
            halves.below.extend(below);
            halves.above.extend(above);
        }
        halves
    }

    /// Bits of information that a curve's side gives about the owners of samples.
    fn gain(&self, curve: CurveIndex, samples: &[u32]) -> f64 {
        let mut counts: Vec<(Option<usize>, [f64; 2])> = Vec::new();
        for sample in samples {
            let sample = &self.samples[*sample as usize];
            let side = usize::from(!sample.below[curve]);
            match counts.iter_mut().find(|(owner, _)| *owner == sample.owner) {
                Some((_, count)) => count[side] += sample.weight,
                None => {
                    let mut count = [0.0; 2];
                    count[side] = sample.weight;
                    counts.push((sample.owner, count));
                }
            }
        }
        super::information(counts.iter().map(|(_, count)| *count))
    }

    /// Which side the points on a curve go to: that of the solid, so that its surface is its own;
    /// where both are, that of the owner listed first, if one side is so all along.
    fn zeros(&self, curve: CurveIndex, halves: &Halves) -> Zeros {
        let shape = &self.shapes[curve];
        let on = |pieces: &[Piece]| -> Vec<(Point, usize)> {
            let of = |piece: &Piece| {
                let rank = piece.owner.unwrap_or(usize::MAX);
                let on = piece.vertices.iter().filter(|p| shape.side(**p, self.size) == 0);
                on.map(|p| (*p, rank)).collect::<Vec<_>>()
            };
            pieces.iter().flat_map(of).collect()
        };
        let (below, above) = (on(&halves.below), on(&halves.above));
        let (mut must, mut prefers) = ([false; 2], [false; 2]);
        for (p, _) in below.iter().chain(&above) {
            let b = self.best(*p, &below, curve, &halves.below);
            let a = self.best(*p, &above, curve, &halves.above);
            let inside = [b, a].map(|rank| rank != usize::MAX);
            match (inside, b.cmp(&a)) {
                ([true, false], _) => must[0] = true,
                ([false, true], _) => must[1] = true,
                (_, Ordering::Less) => prefers[0] = true,
                (_, Ordering::Greater) => prefers[1] = true,
                _ => {}
            }
        }
        match (must, prefers) {
            ([true, true], _) => Zeros::Both,
            ([false, true], _) | ([false, false], [false, true]) => Zeros::Above,
            _ => Zeros::Below,
        }
    }

    /// The first of the owners that a point on a curve touches on one side.
    fn best(&self, p: Point, on: &[(Point, usize)], curve: CurveIndex, pieces: &[Piece]) -> usize {
        let close = 1e-9 * self.size;
        let at = on.iter().filter(|(q, _)| norm(minus(p, *q)) < close).map(|(_, rank)| *rank);
        let along = pieces
            .iter()
            .filter(|piece| self.on_edge(p, piece, curve))
            .map(|piece| piece.owner.unwrap_or(usize::MAX));
        at.chain(along).min().unwrap_or(usize::MAX)
    }

    /// Whether a point lies on a straight edge of a piece along a curve.
    fn on_edge(&self, p: Point, piece: &Piece, curve: CurveIndex) -> bool {
        let count = piece.vertices.len();
        (0..count).filter(|k| piece.edges[*k] == Edge::Straight).any(|k| {
            let (a, b) = (piece.vertices[k], piece.vertices[(k + 1) % count]);
            let (way, off) = (minus(b, a), minus(p, a));
            let length = norm(way);
            let along = (way[0] * off[0] + way[1] * off[1]) / length;
            let across = (way[0] * off[1] - way[1] * off[0]) / length;
            across.abs() < 1e-9 * self.size
                && (0.0..=length).contains(&along)
                && [a, b].iter().all(|q| self.shapes[curve].side(*q, self.size) == 0)
        })
    }

    /// The owners of the points on a curve: the first of both sides'.
    fn touching(
        &mut self,
        curve: CurveIndex,
        halves: &Halves,
        open: &[CurveIndex],
    ) -> Result<Owners, Report> {
        let shape = &self.shapes[curve];
        let touches =
            |piece: &&Piece| piece.vertices.iter().any(|p| shape.side(*p, self.size) == 0);
        let [below, above] = [&halves.below, &halves.above]
            .map(|pieces| pieces.iter().filter(touches).cloned().collect::<Vec<_>>());
        let below = self.tree(below, Vec::new(), open.to_vec())?;
        let above = self.tree(above, Vec::new(), open.to_vec())?;
        Ok(first(&below, &above))
    }
}

/// The side that a curve's own points go to.
#[derive(Clone, Copy, PartialEq)]
enum Zeros {
    Below,
    Above,
    Both,
}

/// The tree that gives the first listed of two trees' owners.
fn first(a: &Owners, b: &Owners) -> Owners {
    match a {
        Tree::Leaf(own) => {
            let rank = |owner: &Option<usize>| owner.unwrap_or(usize::MAX);
            let least =
                |other: &Option<usize>| Some(if rank(other) < rank(own) { *other } else { *own });
            b.map(&least).unwrap_or(Tree::Leaf(*own))
        }
        Tree::Split { curve, strict, below, above } => {
            Tree::split(*curve, *strict, first(below, b), first(above, b))
        }
    }
}
