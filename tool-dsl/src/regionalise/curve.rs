//! The curves between regions: what they mean, and what they are.

use super::outline::{self, Point};
use super::{Feature, Section};
use crate::expr::polynomial::Polynomial;
use crate::expr::{Graph, Id};

/// A side of a curve, by its meaning.
#[derive(Clone, Debug)]
pub(super) enum Curve {
    /// On the material's side of a piece's whole line or circle.
    Inside(Feature),
    /// Not beyond the normal at an end of a piece (0 its start, 1 its end).
    Before { piece: usize, end: usize },
    /// Beyond it.
    Past { piece: usize, end: usize },
    /// No nearer to another feature.
    Nearer { this: Feature, other: Feature },
}

impl Curve {
    pub(super) fn holds(&self, section: &Section<'_>, p: Point) -> bool {
        match self {
            Curve::Inside(feature) => section.depth_at(feature, p) >= 0.0,
            Curve::Before { piece, end } => section.outline[*piece].sector(p)[*end] >= 0.0,
            Curve::Past { piece, end } => section.outline[*piece].sector(p)[*end] <= 0.0,
            Curve::Nearer { this, other } => {
                section.depth_at(this, p) <= section.depth_at(other, p)
            }
        }
    }

    /// The expression that is at most 0 on this side.
    pub(super) fn side(&self, section: &Section<'_>, graph: &mut Graph) -> Option<Id> {
        match self {
            Curve::Inside(feature) => {
                let depth = section.depth(graph, feature)?;
                Some(graph.neg(depth))
            }
            Curve::Before { piece, end } => {
                let side = section.outline[*piece].sides(graph)?[*end];
                Some(graph.neg(side))
            }
            Curve::Past { piece, end } => Some(section.outline[*piece].sides(graph)?[*end]),
            Curve::Nearer { this, other } => section.comparison(graph, this, other),
        }
    }
}

impl Section<'_> {
    /// An expression that is at most 0 where one feature is no farther than another, inside. A
    /// corner and a line, or two corners, need no root.
    fn comparison(&self, graph: &mut Graph, this: &Feature, other: &Feature) -> Option<Id> {
        let line = |feature: &Feature| match feature {
            Feature::Piece(index) => self.outline[*index].circle.is_none(),
            Feature::Corner(_) => false,
        };
        let difference = match (this, other) {
            (Feature::Corner(a), Feature::Corner(b)) => {
                let a = outline::squared(graph, self.corner(*a));
                let b = outline::squared(graph, self.corner(*b));
                graph.sub(a, b)
            }
            (Feature::Corner(corner), piece) | (piece, Feature::Corner(corner)) if line(piece) => {
                let away = outline::squared(graph, self.corner(*corner));
                let depth = self.depth(graph, piece)?;
                let square = graph.mul(depth, depth);
                let from_corner = graph.sub(away, square);
                if matches!(this, Feature::Corner(_)) {
                    from_corner
                } else {
                    graph.neg(from_corner)
                }
            }
            _ => {
                let (this, other) = (self.depth(graph, this)?, self.depth(graph, other)?);
                graph.sub(this, other)
            }
        };
        // Expanded, so that squares which cancel are not subtracted at every point.
        Some(match Polynomial::of(graph, difference) {
            Some(polynomial) => polynomial.expression(graph),
            None => difference,
        })
    }
}

/// One of these sides holds.
#[derive(Clone, Debug)]
pub(super) struct Bound(pub(super) Vec<Curve>);

impl Bound {
    pub(super) fn one(curve: Curve) -> Bound {
        Bound(vec![curve])
    }

    pub(super) fn holds(&self, section: &Section<'_>, p: Point) -> bool {
        self.0.iter().any(|curve| curve.holds(section, p))
    }
}
