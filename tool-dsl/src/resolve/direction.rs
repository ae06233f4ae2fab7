//! Points and directions as tuples: two components in a tool, three in a solid.

use super::lower::Allowed;
use super::region::RegionResolver;
use crate::diagnostic::{Diagnostic, RegionKind, Role};
use crate::dimension::Dimension;
use crate::domain::Domain;
use crate::expr::{Coord, Id};
use crate::model::DirectionSource;
use crate::source::Span;
use crate::syntax::tree::{Direction, Expr, Region, Tuple};

/// A direction that is not yet normalised, with its span and its source.
#[derive(Clone, Copy)]
pub(super) struct RawDirection {
    pub(super) parts: [Id; 3],
    pub(super) span: Span,
    pub(super) source: DirectionSource,
}

impl RegionResolver<'_> {
    /// Returns the direction that a region writes, if it does.
    pub(super) fn resolve_direction(
        &mut self,
        written: &Region,
    ) -> Result<Option<RawDirection>, Diagnostic> {
        match written.direction.as_slice() {
            [] => Ok(None),
            [resolve_direction] => Ok(Some(RawDirection {
                parts: self.direction(&resolve_direction.direction)?,
                span: resolve_direction.span,
                source: match resolve_direction.allow_oblique {
                    true => DirectionSource::Oblique,
                    false => DirectionSource::Written,
                },
            })),
            [first, second, ..] => {
                Err(Diagnostic::new(second.span, RegionKind::DuplicateDirection)
                    .with_label(first.span, "first direction"))
            }
        }
    }

    /// Returns the vector of a direction, not normalised.
    fn direction(&mut self, direction: &Direction) -> Result<[Id; 3], Diagnostic> {
        match direction {
            Direction::Vector(tuple) => self.along(tuple),
            Direction::AwayFrom(tuple) => self.direction_from_point(tuple),
            Direction::Toward(tuple) => {
                let from_point = self.direction_from_point(tuple)?;
                Ok(from_point.map(|part| self.lowering.graph.neg(part)))
            }
        }
    }

    fn along(&mut self, tuple: &Tuple) -> Result<[Id; 3], Diagnostic> {
        let domain = self.lowering.domain;
        let (mut parts, mut dimension) = (Vec::new(), Dimension::Dimensionless);
        for part in components(tuple, domain, Role::Direction)? {
            let (id, of_part) = self.lowering.lower(part, Allowed::Coordinates)?;
            let common_dimension = dimension.common(of_part).filter(|d| *d != Dimension::Angle);
            dimension = common_dimension.ok_or_else(|| {
                Diagnostic::new(
                    tuple.span,
                    RegionKind::MixedDirection { first: dimension, second: of_part },
                )
            })?;
            parts.push(id);
        }
        let down = self.lowering.frame.spindle_down;
        let graph = &mut self.lowering.graph;
        let [x, y, z] = domain.vector(graph, &parts);
        Ok([x, y, if down { graph.neg(z) } else { z }])
    }

    /// Returns the vector from a fixed point to the evaluated point.
    fn direction_from_point(&mut self, tuple: &Tuple) -> Result<[Id; 3], Diagnostic> {
        let domain = self.lowering.domain;
        let mut parts = Vec::new();
        for (part, (coord, ..)) in
            components(tuple, domain, Role::Point)?.into_iter().zip(domain.coordinates())
        {
            let constant = self.lowering.length(part, Role::Point)?;
            let constant = match coord {
                Coord::Z => self.lowering.frame.to_tool(&constant),
                _ => constant,
            };
            let graph = &mut self.lowering.graph;
            let (coordinate, constant) = (graph.coord(*coord), graph.number(constant));
            parts.push(graph.sub(coordinate, constant));
        }
        Ok(domain.vector(&mut self.lowering.graph, &parts))
    }
}

/// Returns the components of a tuple, which has to have as many as the domain has coordinates.
fn components(tuple: &Tuple, domain: Domain, role: Role) -> Result<Vec<&Expr>, Diagnostic> {
    let (count, expected) = (tuple.components.len(), domain.coordinates().len());
    if count == expected {
        return Ok(tuple.components.iter().collect());
    }
    let (domain, coordinates) = (domain.keyword(), domain.tuple());
    let kind = RegionKind::WrongComponentCount { role, domain, expected, count, coordinates };
    Err(Diagnostic::new(tuple.span, kind))
}

/// Returns the two components of a point of a tool.
pub(super) fn pair(tuple: &Tuple, role: Role) -> Result<[&Expr; 2], Diagnostic> {
    components(tuple, Domain::HalfPlane, role).map(|_| [&tuple.components[0], &tuple.components[1]])
}
