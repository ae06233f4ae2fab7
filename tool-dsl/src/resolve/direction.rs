//! Points and directions as a file writes them, two numbers in a tool and three in a solid.

use super::dimension::Dimension;
use super::lower::May;
use super::region::Felt;
use crate::domain::Domain;
use crate::expr::{Coord, Id};
use crate::model::DirectionSource;
use crate::report::Report;
use crate::source::Span;
use crate::syntax::tree::{Direction, Expr, Region, Tuple};

/// A direction that is no unit vector yet, where it is said and where it comes from.
#[derive(Clone, Copy)]
pub(super) struct Course {
    pub(super) parts: [Id; 3],
    pub(super) span: Span,
    pub(super) source: DirectionSource,
}

impl Felt<'_> {
    /// The direction that a region writes, if it does.
    pub(super) fn course(&mut self, written: &Region) -> Result<Option<Course>, Report> {
        match written.direction.as_slice() {
            [] => Ok(None),
            [course] => Ok(Some(Course {
                parts: self.direction(&course.direction)?,
                span: course.span,
                source: match course.oblique {
                    true => DirectionSource::Oblique,
                    false => DirectionSource::Written,
                },
            })),
            [first, second, ..] => Err(Report::error(second.span, "the direction is said twice")
                .and(first.span, "first here")
                .help("drop one")),
        }
    }

    /// The vector that a region writes, not yet a unit vector.
    fn direction(&mut self, direction: &Direction) -> Result<[Id; 3], Report> {
        match direction {
            Direction::Along(tuple) => self.along(tuple),
            Direction::AwayFrom(tuple) => self.away_from(tuple),
            Direction::Toward(tuple) => {
                let away = self.away_from(tuple)?;
                Ok(away.map(|part| self.lowering.graph.neg(part)))
            }
        }
    }

    fn along(&mut self, tuple: &Tuple) -> Result<[Id; 3], Report> {
        let domain = self.lowering.domain;
        let (mut parts, mut dimension) = (Vec::new(), Dimension::Bare);
        for part in components(tuple, domain, "a direction")? {
            let (id, of_part) = self.lowering.lower(part, May::Coordinates)?;
            let alike = dimension.alike(of_part).filter(|d| *d != Dimension::Angle);
            dimension = alike.ok_or_else(|| {
                let message = format!("a direction of {dimension} and {of_part}");
                Report::error(tuple.span, message).help("all its parts are alike")
            })?;
            parts.push(id);
        }
        let down = self.lowering.frame.down;
        let graph = &mut self.lowering.graph;
        let [x, y, z] = domain.vector(graph, &parts);
        Ok([x, y, if down { graph.neg(z) } else { z }])
    }

    /// The vector from a point to where one feels.
    fn away_from(&mut self, tuple: &Tuple) -> Result<[Id; 3], Report> {
        let domain = self.lowering.domain;
        let mut parts = Vec::new();
        for (part, (coord, ..)) in
            components(tuple, domain, "a point")?.into_iter().zip(domain.coordinates())
        {
            let there = self.lowering.length(part, "a point")?;
            let there = match coord {
                Coord::Z => self.lowering.frame.to_tool(&there),
                _ => there,
            };
            let graph = &mut self.lowering.graph;
            let (here, there) = (graph.coord(*coord), graph.number(there));
            parts.push(graph.sub(here, there));
        }
        Ok(domain.vector(&mut self.lowering.graph, &parts))
    }
}

/// The parts of a tuple, as many as the domain has coordinates.
fn components<'t>(tuple: &'t Tuple, domain: Domain, what: &str) -> Result<Vec<&'t Expr>, Report> {
    let (count, wanted) = (tuple.parts.len(), domain.coordinates().len());
    if count == wanted {
        return Ok(tuple.parts.iter().collect());
    }
    let (word, number) = (domain.word(), if wanted == 2 { "two" } else { "three" });
    let report = Report::error(
        tuple.span,
        format!("{what} in a {word} has {number} numbers, this has {count}"),
    );
    Err(match (what, domain) {
        ("a point", _) => {
            let comma = if count > wanted { "; a decimal comma? write `0.5`" } else { "" };
            report.help(format!("write `{}`{comma}", domain.tuple()))
        }
        (_, Domain::HalfPlane) => {
            report.help("write `(radial, axial)`: across the axis, and along the file's z")
        }
        (_, Domain::Space) => report.help("write `(x, y, z)`"),
    })
}

/// The two parts of a point of a tool.
pub(super) fn pair<'t>(tuple: &'t Tuple, what: &str) -> Result<[&'t Expr; 2], Report> {
    components(tuple, Domain::HalfPlane, what).map(|_| [&tuple.parts[0], &tuple.parts[1]])
}
