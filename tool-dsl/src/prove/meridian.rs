//! Solids of revolution about a coordinate axis, proved in a half plane through it.
//!
//! Depths, curves, magnitudes and nicenesses must be functions of the coordinate along the axis and the
//! distance from it, and directions must turn with the point, except where they vanish. All proved facts are
//! then the same in each half plane that ends on the axis, and one of them suffices, as for a tool. This
//! takes far fewer boxes, and nested lengths such as `hypot(x, hypot(y, z) - r)` become lengths.

use super::rounding::RoundingErrors;
use super::witness::Witness;
use super::{CertainValue, Certificate, JumpPoint, RegionFacts};
use crate::bound::Extent;
use crate::domain::Domain;
use crate::expr::interval::{Cell, Interval, ZERO};
use crate::expr::polynomial::{Polynomial, Polynomials, monomial_of};
use crate::expr::{Coord, Graph, Id, Node};
use crate::model::{Model, RegionOutputs};
use crate::plan::PlannedTool;
use std::collections::HashMap;

const SPACE_COORDINATES: [Coord; 3] = [Coord::X, Coord::Y, Coord::Z];

/// A solid of revolution as a tool in a half plane.
pub(super) struct Meridian {
    pub(super) tool: PlannedTool,
    axis: usize,
    /// The axes perpendicular to it. The half plane lies along the first.
    perpendicular: [usize; 2],
}

impl Meridian {
    /// Returns the half plane of a solid, if it can be shown to be a solid of revolution.
    pub(super) fn of(tool: &PlannedTool) -> Option<Meridian> {
        if tool.model.domain != Domain::Space {
            return None;
        }
        let mut axes = [(0, [1, 2]), (1, [2, 0]), (2, [0, 1])].into_iter();
        let (axis, perpendicular) = axes.find(|(axis, perpendicular)| {
            let coords = perpendicular.map(|axis| SPACE_COORDINATES[axis]);
            let behaviour = &mut RotationBehaviour::new(&tool.model.graph, coords);
            let model = &tool.model;
            let [first, second] = *perpendicular;
            model.curves.iter().all(|curve| behaviour.is_invariant(curve.value))
                && model.regions.iter().all(|region| {
                    let evaluation = [region.depth, region.magnitude, region.niceness];
                    let (direction, _) = region.raw_direction;
                    evaluation
                        .into_iter()
                        .chain([direction[*axis]])
                        .all(|id| behaviour.is_invariant(id))
                        && behaviour.rotates([direction[first], direction[second]])
                })
        })?;
        let model = in_half_plane(&tool.model, axis, perpendicular)?;
        let sides = tool.extent.cell().sides;
        let reach = perpendicular.map(|axis| sides[axis].abs().high);
        // The solid turns, so it reaches no farther than along its shorter side.
        let radius = reach[0].min(reach[1]);
        let cell = Cell::half_plane(Interval::new(0.0, radius), sides[axis]);
        let extent = Extent::of(cell, radius);
        let tool =
            PlannedTool { model, extent, tree: tool.tree.clone(), deviation: tool.deviation };
        Some(Meridian { tool, axis, perpendicular })
    }

    /// Converts the certificate of the half plane to that of the solid.
    pub(super) fn revolved(&self, proved: Certificate, tool: &PlannedTool) -> Certificate {
        let (model, whole) = (&tool.model, tool.extent.cell());
        let depths = model.regions.iter().map(|region| region.depth);
        let mut errors = RoundingErrors::new(&model.graph, model.domain, depths);
        let shares = Witness::new(tool, proved.tolerance).shares();
        let facts = proved.regions.into_iter().zip(&model.regions).zip(shares);
        let regions = facts.map(|((facts, region), share)| RegionFacts {
            share,
            // Angles and rates are the same at the point of the half plane in space.
            oblique_witness: facts.oblique_witness.map(|certain| self.certain(certain)),
            rising_witness: facts.rising_witness.map(|certain| self.certain(certain)),
            steep_at: facts.steep_at.map(|point| self.point(point)),
            singular_cells: facts.singular_cells.iter().map(|cell| self.cell(cell)).collect(),
            rounding_error: errors.over(region.depth, &whole),
            ..facts
        });
        let regions = regions.collect();
        let mut borders = proved.borders;
        for border in &mut borders {
            border.jump_point =
                border.jump_point.map(|jump| JumpPoint { point: self.point(jump.point), ..jump });
        }
        let mut undecided = proved.undecided;
        undecided.iter_mut().for_each(|open| open.cell = self.cell(&open.cell));
        Certificate { regions, borders, undecided, ..proved }
    }

    fn certain(&self, CertainValue { value, point }: CertainValue) -> CertainValue {
        CertainValue { value, point: self.point(point) }
    }

    fn point(&self, [d, _, z]: [f64; 3]) -> [f64; 3] {
        let mut point = [0.0; 3];
        point[self.axis] = z;
        point[self.perpendicular[0]] = d;
        point
    }

    /// Returns a box around the rotation of a box of the half plane.
    fn cell(&self, cell: &Cell) -> Cell {
        let [d, _, z] = cell.sides;
        let mut sides = [ZERO; 3];
        sides[self.axis] = z;
        // Rotation takes a point at the distance `d` from the axis to any place within `d` of it.
        for axis in self.perpendicular {
            sides[axis] = Interval { low: -d.high, high: d.high };
        }
        Cell { sides }
    }
}

/// A classification of nodes by their behaviour under rotation of the point about an axis.
struct RotationBehaviour<'g> {
    graph: &'g Graph,
    /// The coordinates perpendicular to the axis.
    perpendicular: [Coord; 2],
    polynomials: Polynomials,
    known: HashMap<Id, bool>,
}

impl<'g> RotationBehaviour<'g> {
    fn new(graph: &'g Graph, perpendicular: [Coord; 2]) -> RotationBehaviour<'g> {
        RotationBehaviour {
            graph,
            perpendicular,
            polynomials: Polynomials::default(),
            known: HashMap::new(),
        }
    }

    /// Returns whether a node is invariant: a polynomial if `y ∂/∂z - z ∂/∂y` of it is 0, any other node if
    /// its operands are.
    fn is_invariant(&mut self, id: Id) -> bool {
        for id in self.graph.dependencies([id]) {
            if !self.known.contains_key(&id) {
                let node = self.graph.node(id);
                let is_invariant = match self.polynomials.of(self.graph, id).and_then(in_space) {
                    Some(polynomial) => is_invariant_polynomial(&polynomial, self.perpendicular),
                    None if *node == Node::Coord(Coord::D) => {
                        self.perpendicular == [Coord::X, Coord::Y]
                    }
                    None => node.operands().all(|operand| self.known[&operand]),
                };
                self.known.insert(id, is_invariant);
            }
        }
        self.known[&id]
    }

    /// Returns whether two nodes turn with the point: they are the coordinates perpendicular to the axis,
    /// multiplied by a common invariant factor.
    fn rotates(&mut self, [a, b]: [Id; 2]) -> bool {
        let graph = self.graph;
        match (graph.node(a), graph.node(b)) {
            (Node::Const(a), Node::Const(b)) if a.is_zero() && b.is_zero() => true,
            (Node::Coord(a), Node::Coord(b)) => [*a, *b] == self.perpendicular,
            (Node::Neg(a), Node::Neg(b)) => self.rotates([*a, *b]),
            (Node::Add(a, b), Node::Add(c, d)) => {
                self.rotates([*a, *c]) && self.rotates([*b, *d])
                    || self.rotates([*a, *d]) && self.rotates([*b, *c])
            }
            (Node::Sub(a, b), Node::Sub(c, d)) => self.rotates([*a, *c]) && self.rotates([*b, *d]),
            (Node::Div(a, b), Node::Div(c, d)) | (Node::Quotient(a, b), Node::Quotient(c, d)) => {
                b == d && self.is_invariant(*b) && self.rotates([*a, *c])
            }
            (Node::Mul(a, b), Node::Mul(c, d)) => {
                [(a, b), (b, a)].into_iter().any(|(factor, part)| {
                    [(c, d), (d, c)].into_iter().any(|(other, other_part)| {
                        factor == other
                            && self.is_invariant(*factor)
                            && self.rotates([*part, *other_part])
                    })
                })
            }
            (
                Node::Select { low, high, then: a, other: b },
                Node::Select { low: lower, high: higher, then: c, other: d },
            ) => {
                // Both must choose alike, and so wherever the point turns to.
                [low, high] == [lower, higher]
                    && self.is_invariant(*low)
                    && self.is_invariant(*high)
                    && self.rotates([*a, *c])
                    && self.rotates([*b, *d])
            }
            _ => false,
        }
    }
}

/// Returns a polynomial with `x² + y²` in place of `d²`; none if it has an odd power of `d`.
fn in_space(polynomial: &Polynomial) -> Option<Polynomial> {
    let [x, y] = [Coord::X, Coord::Y].map(Polynomial::coordinate);
    let square = x.times(&x)?.plus(&y.times(&y)?);
    let mut sum = Polynomial::zero();
    for (monomial, factor) in polynomial.terms() {
        let mut term = Polynomial::from_constant(factor);
        for (exponent, coord) in monomial[1..].iter().zip(SPACE_COORDINATES) {
            for _ in 0..*exponent {
                term = term.times(&Polynomial::coordinate(coord))?;
            }
        }
        for _ in 0..monomial[0] / 2 {
            term = term.times(&square)?;
        }
        sum = if monomial[0] % 2 == 0 { sum.plus(&term) } else { return None };
    }
    Some(sum)
}

/// Returns whether a polynomial is invariant under rotation about an axis.
fn is_invariant_polynomial(polynomial: &Polynomial, perpendicular: [Coord; 2]) -> bool {
    let [y, z] = perpendicular;
    let term = |by: Coord, times: Coord| {
        let index = monomial_of(by).iter().position(|exponent| *exponent > 0)?;
        polynomial.derivative(index).times(&Polynomial::coordinate(times))
    };
    // The derivative by the angle of rotation is 0.
    let Some((first_term, second_term)) = term(z, y).zip(term(y, z)) else { return false };
    first_term.plus(&second_term.scaled(&crate::number::Number::int(-1))).is_zero()
}

/// Returns the model on the half plane where the second coordinate perpendicular to the axis is 0 and the
/// first is not negative.
fn in_half_plane(model: &Model, axis: usize, perpendicular: [usize; 2]) -> Option<Model> {
    let mut graph = Graph::default();
    let mut mapped: HashMap<Id, Id> = HashMap::new();
    let mut coordinates = [graph.int(0); 3];
    coordinates[axis] = graph.coord(Coord::Z);
    coordinates[perpendicular[0]] = graph.coord(Coord::D);
    let squares = [0, 1].map(|axis| graph.mul(coordinates[axis], coordinates[axis]));
    let square = graph.add(squares[0], squares[1]);
    for id in model.graph.dependencies(model.roots()) {
        let at = |id: &Id| mapped[id];
        let image = match model.graph.node(id) {
            Node::Const(value) => graph.number(value.clone()),
            Node::Coord(Coord::X) => coordinates[0],
            Node::Coord(Coord::Y) => coordinates[1],
            Node::Coord(Coord::Z) => coordinates[2],
            // `d` and `q` belong to the z axis of space, whatever the axis of the solid is.
            Node::Coord(Coord::Q) => square,
            Node::Coord(Coord::D) => graph.sqrt(square)?,
            Node::Coord(coord) => graph.coord(*coord),
            Node::Neg(a) => graph.neg(at(a)),
            Node::Add(a, b) => graph.add(at(a), at(b)),
            Node::Sub(a, b) => graph.sub(at(a), at(b)),
            Node::Mul(a, b) => graph.mul(at(a), at(b)),
            Node::Div(a, b) => graph.div(at(a), at(b))?,
            Node::Quotient(a, b) => graph.quotient(at(a), at(b)),
            Node::Min(a, b) => graph.min(at(a), at(b)),
            Node::Max(a, b) => graph.max(at(a), at(b)),
            Node::Abs(a) => graph.abs(at(a)),
            Node::Sqrt(a) => graph.sqrt(at(a))?,
            Node::Select { low, high, then, other } => {
                graph.select(at(low), at(high), at(then), at(other))
            }
        };
        mapped.insert(id, image);
    }
    let zero = graph.int(0);
    let at = |id: Id| mapped[&id];
    let in_plane = |vector: [Id; 3]| [at(vector[perpendicular[0]]), zero, at(vector[axis])];
    let mut model = Model { domain: Domain::HalfPlane, graph, ..model.clone() };
    model.curves.iter_mut().for_each(|curve| curve.value = at(curve.value));
    for region in &mut model.regions {
        region.direction = in_plane(region.direction);
        region.raw_direction.0 = in_plane(region.raw_direction.0);
        [region.depth, region.magnitude, region.niceness] =
            [region.depth, region.magnitude, region.niceness].map(at);
        region.outputs = RegionOutputs {
            depth: region.depth,
            magnitude: region.magnitude,
            gradient: [zero; 3],
            direction: region.direction,
            niceness: region.niceness,
        };
    }
    Some(model)
}
