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

/// Curves that are passed over because their points belong to both sides.
const DOUBLES: usize = 6;

type Owners = Tree<Option<usize>>;

/// Bits that an addition must be worth.
const PRICE: f64 = 0.01;
/// What a test costs that the tree does elsewhere too: lanes do it once.
const AGAIN: f64 = 0.3;
/// Additions that a side where several owners are left will cost at least.
const TEST: f64 = 8.0;

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
        let Some((curve, halves, zeros)) = self.choose(&pieces, &samples, &mut open) else {
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
    ) -> Option<(CurveIndex, Halves, Zeros)> {
        let mut counts = Vec::new();
        let mut ranked: Vec<(f64, CurveIndex)> = open
            .iter()
            .map(|curve| {
                let again = if self.used[*curve] { AGAIN } else { 1.0 };
                let gain = self.gain(*curve, samples, &mut counts);
                (gain - PRICE * again * self.costs[*curve], *curve)
            })
            .collect();
        let listed = |curve: CurveIndex| self.model.first.iter().position(|f| *f == curve);
        ranked.sort_by(|a, b| {
            let order = |curve| listed(curve).unwrap_or(usize::MAX);
            order(a.1).cmp(&order(b.1)).then(b.0.total_cmp(&a.0))
        });
        let (mut fallback, mut double, mut doubles) = (None, None, 0);
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
            if owners(&halves.below) == all && owners(&halves.above) == all {
                fallback = fallback.or(Some((curve, halves, Zeros::Below)));
                continue;
            }
            // A curve whose points belong to both sides costs a tree of its own.
            let zeros = self.zeros(curve, &halves);
            if zeros != Zeros::Both {
                return Some((curve, halves, zeros));
            }
            double.get_or_insert((curve, halves, zeros));
            doubles += 1;
            if doubles > DOUBLES {
                break;
            }
        }
        let fallback = fallback.map(|(curve, halves, _)| {
            let zeros = self.zeros(curve, &halves);
            (curve, halves, zeros)
        });
        double.or(fallback)
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

    /// What a curve's side tells about the owners of samples, in bits, less what is left to test.
    fn gain(&self, curve: CurveIndex, samples: &[u32], counts: &mut Vec<[f64; 2]>) -> f64 {
        counts.clear();
        counts.resize(self.inside.len() + 1, [0.0; 2]);
        for sample in samples {
            let sample = &self.samples[*sample as usize];
            let owner = sample.owner.map_or(0, |owner| owner + 1);
            counts[owner][usize::from(!sample.below[curve])] += sample.weight;
        }
        counts.retain(|count| count[0] + count[1] > 0.0);
        let owners = |side: usize| counts.iter().filter(|count| count[side] > 0.0).count();
        let open = [0, 1].map(|side| if owners(side) > 1 { PRICE * TEST } else { 0.0 });
        super::information(counts.iter().copied()) - open[0] - open[1]
    }

    /// Which side the points on a curve go to: that of the solid, so that its surface is its own;
    /// where both are, that of the owner listed first, if one side is so all along.
    fn zeros(&self, curve: CurveIndex, halves: &Halves) -> Zeros {
        let [below, above] = [&halves.below, &halves.above].map(|half| self.rim(curve, half));
        let (mut must, mut prefers) = ([false; 2], [false; 2]);
        for p in below.points.iter().chain(&above.points) {
            let [b, a] = [&below, &above].map(|rim| rim.first_at(p.0, 1e-9 * self.size));
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

    /// What of some pieces lies on a curve.
    fn rim(&self, curve: CurveIndex, pieces: &[Piece]) -> Rim {
        let shape = &self.shapes[curve];
        let mut rim = Rim::default();
        for piece in pieces {
            let rank = piece.owner.unwrap_or(usize::MAX);
            let on: Vec<bool> =
                piece.vertices.iter().map(|p| shape.side(*p, self.size) == 0).collect();
            for (k, p) in piece.vertices.iter().enumerate().filter(|(k, _)| on[*k]) {
                rim.points.push((*p, rank));
                let next = (k + 1) % on.len();
                if on[next] && piece.edges[k] == Edge::Straight {
                    rim.edges.push(([*p, piece.vertices[next]], rank));
                }
            }
        }
        rim
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

/// Points and straight edges on a curve, with the rank of their owner: its place in the list.
#[derive(Default)]
struct Rim {
    points: Vec<(Point, usize)>,
    edges: Vec<([Point; 2], usize)>,
}

impl Rim {
    /// The first of the owners that touch a point.
    fn first_at(&self, p: Point, close: f64) -> usize {
        let near = |q: Point| (p[0] - q[0]).abs() < close && (p[1] - q[1]).abs() < close;
        let points = self.points.iter().filter(|(q, _)| near(*q)).map(|(_, rank)| *rank);
        let along = |[a, b]: [Point; 2]| {
            let (way, off) = (minus(b, a), minus(p, a));
            let length = norm(way);
            let along = (way[0] * off[0] + way[1] * off[1]) / length;
            let across = (way[0] * off[1] - way[1] * off[0]) / length;
            across.abs() < close && (0.0..=length).contains(&along)
        };
        let edges = self.edges.iter().filter(|(edge, _)| along(*edge)).map(|(_, rank)| *rank);
        points.chain(edges).min().unwrap_or(usize::MAX)
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
            let [low, high] = [true, false].map(|holds| b.knowing(*curve, *strict, holds));
            Tree::split(*curve, *strict, first(below, &low), first(above, &high))
        }
    }
}
