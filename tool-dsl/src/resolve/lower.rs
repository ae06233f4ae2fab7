//! Expressions of the syntax tree to nodes of the graph, with their dimension.

use super::call::{FUNCTIONS, NO_POWER};
use super::dimension::{Dimension, LENGTH};
use crate::domain::Domain;
use crate::expr::{Graph, Id};
use crate::model::{Frame, Unit};
use crate::number::{Number, RANGE};
use crate::report::{Missing, Report, Reported, nearest};
use crate::source::Span;
use crate::syntax::TALLEST;
use crate::syntax::tree::{Binary, Expr, ExprKind, Name};
use std::collections::BTreeMap;

/// Names that belong to the language, whatever the file's own coordinates.
const COORDINATES: [&str; 4] = ["d", "z", "x", "y"];
const UNITS: [&str; 5] = ["mm", "inch", "m", "deg", "rad"];

/// A value that has a name.
#[derive(Clone, Debug)]
pub(super) struct Value {
    pub(super) id: Id,
    pub(super) dimension: Dimension,
    pub(super) span: Span,
    pub(super) used: bool,
}

/// What an expression may mention where it stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum May {
    /// Constants only, for what (to be named in errors).
    Constants(&'static str),
    /// Coordinates too.
    Coordinates,
    /// And `depth`, which is this here.
    Depth(Id),
}

/// Everything that lowering needs and fills.
#[derive(Clone)]
pub(super) struct Lowering {
    pub(super) domain: Domain,
    pub(super) graph: Graph,
    pub(super) unit: Unit,
    pub(super) frame: Frame,
    /// How many of the file's unit are one of the tool's: 1 but for a mounted file.
    pub(super) scale: Number,
    pub(super) values: BTreeMap<String, Value>,
    /// Where each name is defined, above or below.
    pub(super) declared: BTreeMap<String, Span>,
    /// The names without a value, each with the evidence that its definition was refused.
    pub(super) broken: BTreeMap<String, Reported>,
}

/// The largest constant on the way to a length, 2^1000: powers of lengths fit.
const LARGEST: f64 = 1.071508607186267e301;

pub(super) type Lowered = Result<(Id, Dimension), Report>;

impl Lowering {
    /// Gives a value its name.
    pub(super) fn define(
        &mut self,
        name: &Name,
        (id, dimension): (Id, Dimension),
    ) -> Result<(), Report> {
        let word = name.word.as_str();
        if let Some(what) = self.domain.meaning(word) {
            let report =
                Report::error(name.span, format!("`{word}` is {what} and cannot be defined"));
            return Err(report.help(match word {
                "d" => "for a diameter use `D`",
                _ => "take another name",
            }));
        }
        if COORDINATES.contains(&word)
            || FUNCTIONS.contains(&word)
            || word == "pi"
            || word == "depth"
        {
            let report = Report::error(
                name.span,
                format!("`{word}` belongs to the language and cannot be defined"),
            );
            return Err(report.help("take another name"));
        }
        let value = Value { id, dimension, span: name.span, used: false };
        if let Some(earlier) = self.values.get(word) {
            return Err(Report::error(name.span, format!("`{word}` is defined twice"))
                .and(earlier.span, "first here")
                .help("drop one, or give it another name"));
        }
        self.values.insert(word.to_owned(), value);
        Ok(())
    }

    /// Reports a definition that was refused, and remembers its name.
    pub(super) fn note(
        &mut self,
        name: &Name,
        defined: Result<(), Report>,
        reports: &mut Vec<Report>,
    ) {
        if let Err(report) = defined {
            let reported = Reported::push(reports, report);
            self.broken.insert(name.word.clone(), reported);
        }
    }

    /// An expression that must come out constant, for what.
    pub(super) fn constant(
        &mut self,
        expr: &Expr,
        what: &'static str,
    ) -> Result<(Number, Dimension), Report> {
        let (id, dimension) = self.lower(expr, May::Constants(what))?;
        match self.graph.constant(id) {
            Some(value) => Ok((value.clone(), dimension)),
            None => Err(not_constant(expr.span, "this", what)),
        }
    }

    /// A constant length.
    pub(super) fn length(&mut self, expr: &Expr, what: &'static str) -> Result<Number, Report> {
        let (value, dimension) = self.constant(expr, what)?;
        if !dimension.is_length() {
            return Err(Report::error(
                expr.span,
                format!("{what} takes a length, this is {dimension}"),
            )
            .help("lengths are numbers with or without `mm`, `inch` or `m`"));
        }
        in_range(&value, expr.span)?;
        Ok(value)
    }

    /// Any expression.
    pub(super) fn lower(&mut self, expr: &Expr, may: May) -> Lowered {
        let (id, dimension) = self.node(expr, may)?;
        // Constants are checked as they grow, before anything overflows.
        let size = self.graph.constant(id).map_or(0.0, |value| value.to_f64().abs());
        if size > LARGEST {
            return Err(Report::error(expr.span, "this constant is out of range").help(RANGE));
        }
        if self.graph.height(id) > TALLEST {
            return Err(Report::error(
                expr.span,
                "this is built of too many steps upon each other",
            )
            .help(format!("at most {TALLEST} operations lie between a value and a coordinate")));
        }
        Ok((id, dimension))
    }

    fn node(&mut self, expr: &Expr, may: May) -> Lowered {
        match &expr.kind {
            ExprKind::Number(value, None) => {
                Ok((self.graph.number(value.clone()), Dimension::Bare))
            }
            ExprKind::Number(value, Some(unit)) => self.measured(value, unit, expr.span),
            ExprKind::Name(word) => self.name(word, expr.span, may),
            ExprKind::Neg(inner) => {
                let (id, dimension) = self.lower(inner, may)?;
                Ok((self.graph.neg(id), dimension))
            }
            ExprKind::Binary(Binary::Pow, base, exponent) => {
                self.power(base, exponent, expr.span, may)
            }
            ExprKind::Binary(operator, left, right) => {
                self.binary(*operator, left, right, expr.span, may)
            }
            ExprKind::Call(name, arguments) => self.call(name, arguments, expr.span, may),
        }
    }

    fn measured(&mut self, value: &Number, unit: &Name, span: Span) -> Lowered {
        let word = unit.word.as_str();
        if let Some(from) = Unit::from_word(word) {
            let value = value * &from.to(self.unit);
            return Ok((self.graph.number(value), LENGTH));
        }
        let report = match word {
            "rad" => return Ok((self.graph.number(value.clone()), Dimension::Angle)),
            "deg" => {
                let radians = &(value * &Number::pi()) / &Number::int(180);
                return Ok((self.graph.number(radians), Dimension::Angle));
            }
            "in" | "inches" | "zoll" => Report::error(unit.span, format!("unknown unit `{word}`"))
                .missing(Missing::Definition(word.to_owned()))
                .help("write `inch`, as in `0.25inch`"),
            _ if COORDINATES.contains(&word) || self.values.contains_key(word) || word == "pi" => {
                let number = value.to_f64();
                let report = Report::error(span, format!("`{number}{word}` is not a number"));
                let written = match (self.domain, word) {
                    (Domain::Space, "d") => "hypot(x, y)",
                    _ => word,
                };
                let times = match (self.domain, word) {
                    (Domain::HalfPlane, "d") if number == 2.0 => {
                        " for two times the distance from the axis"
                    }
                    _ => "",
                };
                return Err(report.help(format!("write `{number}*{written}`{times}")));
            }
            _ => {
                let report = Report::error(unit.span, format!("unknown unit `{word}`"))
                    .missing(Missing::Definition(word.to_owned()));
                match UNITS.iter().find(|unit| unit.eq_ignore_ascii_case(word)) {
                    Some(meant) => report.help(format!("did you mean `{meant}`?")),
                    None => report
                        .help(format!("units are {}", UNITS.map(|u| format!("`{u}`")).join(", "))),
                }
            }
        };
        Err(report)
    }

    fn name(&mut self, word: &str, span: Span, may: May) -> Lowered {
        let coordinate = match word {
            "pi" => return Ok((self.graph.number(Number::pi()), Dimension::Bare)),
            "depth" => {
                return match may {
                    May::Depth(depth) => Ok((depth, LENGTH)),
                    May::Coordinates => Err(Report::error(span, "`depth` is not known here")
                        .help("only `magnitude` and `niceness` may mention `depth`")),
                    May::Constants(what) => Err(not_constant(span, &format!("`{word}`"), what)),
                };
            }
            _ => self.domain.coordinates().iter().find(|(.., name)| *name == word),
        };
        let coordinate = coordinate.map(|(coordinate, ..)| *coordinate);
        if coordinate.is_none() && COORDINATES.contains(&word) {
            let other = if word == "d" { "tool" } else { "solid" };
            let report = Report::error(span, format!("`{word}` exists in a `{other}` only"));
            return Err(report.help(self.domain.instead()));
        }
        if let Some(coordinate) = coordinate {
            if let May::Constants(what) = may {
                return Err(not_constant(span, &format!("`{word}`"), what));
            }
            return Ok((self.coordinate_here(coordinate), LENGTH));
        }
        let Some(value) = self.values.get_mut(word) else {
            if let Some(reported) = self.broken.get(word) {
                return Err(Report::follow_up(span, *reported));
            }
            if let Some(definition) = self.declared.get(word) {
                // Constants are settled before curves, wherever these stand.
                if definition.start < span.start
                    && let May::Constants(what) = may
                {
                    return Err(
                        not_constant(span, &format!("`{word}`"), what).and(*definition, "a curve")
                    );
                }
                return Err(Report::error(span, format!("`{word}` is used above its definition"))
                    .and(*definition, "defined here")
                    .help("move the definition up"));
            }
            let report = Report::error(span, format!("unknown name `{word}`"))
                .missing(Missing::Name(word.to_owned()));
            let coordinates = self.domain.coordinates().iter().map(|(.., name)| *name);
            let known = self.values.keys().map(String::as_str).chain(coordinates);
            let known = known.chain(["pi", "depth"]);
            return Err(match nearest(word, known) {
                Some(meant) => report.help(format!("did you mean `{meant}`?")),
                None => report.help(format!("define it above, as in `let {word} = 3;`")),
            });
        };
        value.used = true;
        let value = value.clone();
        if let May::Constants(what) = may
            && self.graph.constant(value.id).is_none()
        {
            return Err(not_constant(span, &format!("`{word}`"), what));
        }
        Ok((value.id, value.dimension))
    }

    fn binary(
        &mut self,
        operator: Binary,
        left: &Expr,
        right: &Expr,
        span: Span,
        may: May,
    ) -> Lowered {
        let glued = operator == Binary::Sub && left.span.end + 1 == right.span.start;
        let (a, da) = self.lower(left, may).map_err(|report| match &left.kind {
            ExprKind::Name(word) if glued && !self.values.contains_key(word) => {
                report.help("a name has no dash: write `_`; a difference has spaces about its `-`")
            }
            _ => report,
        })?;
        let (b, db) = self.lower(right, may)?;
        let (dimension, verb) = match operator {
            Binary::Add | Binary::Sub => (da.alike(db), "adds"),
            Binary::Mul => (da.times(db), "multiplies"),
            _ => (da.over(db), "divides"),
        };
        let Some(dimension) = dimension else {
            let (what, with) = match operator {
                Binary::Add => (format!("adds {da} to {db}"), ""),
                Binary::Sub => (format!("subtracts {db} from {da}"), ""),
                _ => (format!("{verb} {da} by {db}"), ""),
            };
            let report = Report::error(span, format!("this {what}{with}"));
            return Err(report.help(match (da, db) {
                (Dimension::Angle, _) | (_, Dimension::Angle) => {
                    "an angle is for `sin`, `cos` and `tan`: angles go with angles"
                }
                _ => "both sides want the same power of length; a bare number fits any",
            }));
        };
        let id = match operator {
            Binary::Add => self.graph.add(a, b),
            Binary::Sub => self.graph.sub(a, b),
            Binary::Mul => self.graph.mul(a, b),
            _ => self.graph.div(a, b).ok_or_else(|| {
                Report::error(right.span, "division by zero")
                    .help("this is 0; divide by what is not")
            })?,
        };
        Ok((id, dimension))
    }

    fn power(&mut self, base: &Expr, exponent: &Expr, span: Span, may: May) -> Lowered {
        let (base_id, dimension) = self.lower(base, may)?;
        let (value, of_exponent) = self.constant(exponent, "an exponent")?;
        let halves =
            value.halves().filter(|_| of_exponent == Dimension::Bare).ok_or_else(|| {
                Report::error(exponent.span, "an exponent is a multiple of one half from -16 to 16")
                    .help("only square roots run at every contact")
            })?;
        let dimension = dimension
            .power(halves)
            .ok_or_else(|| Report::error(span, "an angle has no powers").help(NO_POWER))?;
        let id = self.graph.power(base_id, halves).ok_or_else(|| {
            Report::error(span, "this power of a constant does not exist")
                .help("the base is negative under a root, or 0 under a negative exponent")
        })?;
        Ok((id, dimension))
    }
}

/// Whether a constant has a size that the compiler can work with.
pub(super) fn in_range(value: &Number, span: Span) -> Result<(), Report> {
    if value.is_in_range() {
        return Ok(());
    }
    let size = format!("{:e} is out of range", value.to_f64());
    Err(Report::error(span, size).help(RANGE))
}

fn not_constant(span: Span, word: &str, what: &str) -> Report {
    let report = Report::error(
        span,
        format!("{word} changes from point to point; {what} takes constants only"),
    );
    report.help(match what {
        "a `let`" | "a `param`" => "name a function of the coordinates with `curve`",
        _ => "write a number, or a `let` or `param`",
    })
}
