//! Lowers expressions of the syntax tree to nodes of the graph, with their dimensions.

use crate::diagnostic::{
    Diagnostic, Kind, NameRemedy, Names, Operation, Reported, Role, ValueKind, nearest,
};
use crate::dimension::{Dimension, LENGTH};
use crate::domain::Domain;
use crate::expr::{Graph, Id};
use crate::model::{Frame, Unit};
use crate::number::Number;
use crate::source::Span;
use crate::syntax::MAX_EXPRESSION_HEIGHT;
use crate::syntax::tree::{Binary, Expr, ExprKind, Name};
use std::collections::{BTreeMap, BTreeSet};

/// Names reserved by the language, whatever the file's own coordinates.
const COORDINATES: [&str; 4] = ["d", "z", "x", "y"];
const UNITS: [&str; 5] = ["mm", "inch", "m", "deg", "rad"];

/// A value that has a name.
#[derive(Clone, Debug)]
pub(super) struct Value {
    pub(super) id: Id,
    dimension: Dimension,
    pub(super) span: Span,
    pub(super) used: bool,
}

/// A constant with its dimension, in the file's units.
pub(super) struct Constant {
    pub(super) value: Number,
    pub(super) dimension: Dimension,
}

/// The names that an expression may mention, by its context.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Allowed {
    /// Constants only, in this role.
    Constants(Role),
    /// Coordinates too.
    Coordinates,
    /// Coordinates and `depth`, which is this expression.
    Depth(Id),
}

/// The state of lowering a file.
#[derive(Clone)]
pub(super) struct Lowering {
    pub(super) domain: Domain,
    pub(super) graph: Graph,
    pub(super) unit: Unit,
    pub(super) frame: Frame,
    /// The number of the file's units of length per unit of the tool: 1 except in a mounted file.
    pub(super) scale: Number,
    pub(super) values: BTreeMap<String, Value>,
    /// The span at which each name is defined, above or below its use.
    pub(super) declared: BTreeMap<String, Span>,
    /// The names without a value, each with the evidence that its definition was rejected.
    pub(super) broken: BTreeMap<String, Reported>,
    /// The names whose values depend on params.
    pub(super) parametric: BTreeSet<String>,
    /// The surfaces of segments that are left out, as their params give them no length.
    pub(super) left_out: BTreeSet<String>,
}

/// The largest intermediate constant, 2^1000, large enough for powers of lengths.
const MAX_CONSTANT: f64 = 1.071508607186267e301;

/// A lowered expression.
pub(super) struct Lowered {
    pub(super) id: Id,
    pub(super) dimension: Dimension,
}

type LoweringResult = Result<Lowered, Diagnostic>;

impl Lowering {
    /// Defines a name.
    ///
    /// # Errors
    ///
    /// If the name is reserved or already defined.
    pub(super) fn define(
        &mut self,
        name: &Name,
        Lowered { id, dimension }: Lowered,
    ) -> Result<(), Diagnostic> {
        let word = name.text.as_str();
        if let Some(meaning) = self.domain.meaning(word) {
            let kind = ValueKind::ReservedName { name: word.to_owned(), meaning: Some(meaning) };
            return Err(Diagnostic::new(name.span, kind));
        }
        if COORDINATES.contains(&word)
            || FUNCTIONS.contains(&word)
            || word == "pi"
            || word == "depth"
        {
            let kind = ValueKind::ReservedName { name: word.to_owned(), meaning: None };
            return Err(Diagnostic::new(name.span, kind));
        }
        let value = Value { id, dimension, span: name.span, used: false };
        if let Some(earlier) = self.values.get(word) {
            return Err(Diagnostic::new(
                name.span,
                ValueKind::DuplicateDefinition { name: word.to_owned() },
            )
            .with_label(earlier.span, "first definition"));
        }
        self.values.insert(word.to_owned(), value);
        Ok(())
    }

    /// Reports a rejected definition, and records its name.
    pub(super) fn report(
        &mut self,
        name: &Name,
        defined: Result<(), Diagnostic>,
        diagnostics: &mut Vec<Diagnostic>,
    ) {
        if let Err(diagnostic) = defined {
            let reported = Reported::push(diagnostics, diagnostic);
            self.broken.insert(name.text.clone(), reported);
        }
    }

    /// Returns whether the value of an expression depends on a param.
    pub(super) fn is_parametric(&self, expr: &Expr) -> bool {
        mentioned(expr).iter().any(|(word, _)| self.parametric.contains(*word))
    }

    /// Lowers an expression that has to be constant, in this role.
    pub(super) fn constant(&mut self, expr: &Expr, role: Role) -> Result<Constant, Diagnostic> {
        let Lowered { id, dimension } = self.lower(expr, Allowed::Constants(role))?;
        match self.graph.constant(id) {
            Some(value) => Ok(Constant { value: value.clone(), dimension }),
            None => Err(not_constant(expr.span, None, role)),
        }
    }

    /// Lowers a constant length.
    pub(super) fn length(&mut self, expr: &Expr, role: Role) -> Result<Number, Diagnostic> {
        let Constant { value, dimension } = self.constant(expr, role)?;
        if !dimension.is_length() {
            return Err(Diagnostic::new(expr.span, ValueKind::NotLength { role, dimension }));
        }
        in_range(&value, expr.span)?;
        Ok(value)
    }

    /// Lowers any expression.
    pub(super) fn lower(&mut self, expr: &Expr, may: Allowed) -> LoweringResult {
        let Lowered { id, dimension } = self.node(expr, may)?;
        // Constants are checked at every step, before anything overflows.
        let size = self.graph.constant(id).map_or(0.0, |value| value.to_f64().abs());
        if size > MAX_CONSTANT {
            return Err(Diagnostic::new(expr.span, ValueKind::ConstantOutOfRange));
        }
        if self.graph.height(id) > MAX_EXPRESSION_HEIGHT {
            return Err(Diagnostic::new(
                expr.span,
                ValueKind::ExpressionTooDeep { limit: MAX_EXPRESSION_HEIGHT },
            ));
        }
        Ok(Lowered { id, dimension })
    }

    fn node(&mut self, expr: &Expr, may: Allowed) -> LoweringResult {
        match &expr.kind {
            ExprKind::Number(value, None) => Ok(Lowered {
                id: self.graph.number(value.clone()),
                dimension: Dimension::Dimensionless,
            }),
            ExprKind::Number(value, Some(unit)) => self.measured(value, unit, expr.span),
            ExprKind::Name(word) => self.name(word, expr.span, may),
            ExprKind::Neg(inner) => {
                let Lowered { id, dimension } = self.lower(inner, may)?;
                Ok(Lowered { id: self.graph.neg(id), dimension })
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

    fn measured(&mut self, value: &Number, unit: &Name, span: Span) -> LoweringResult {
        let word = unit.text.as_str();
        if let Some(from) = Unit::from_symbol(word) {
            let value = value * &from.factor_to(self.unit);
            return Ok(Lowered { id: self.graph.number(value), dimension: LENGTH });
        }
        match word {
            "rad" => {
                Ok(Lowered { id: self.graph.number(value.clone()), dimension: Dimension::Angle })
            }
            "deg" => {
                let radians = &(value * &Number::pi()) / &Number::int(180);
                Ok(Lowered { id: self.graph.number(radians), dimension: Dimension::Angle })
            }
            _ if COORDINATES.contains(&word) || self.values.contains_key(word) || word == "pi" => {
                let number = value.to_f64();
                let diameter = (self.domain, word) == (Domain::HalfPlane, "d") && number == 2.0;
                let factor = match (self.domain, word) {
                    (Domain::Space, "d") => "hypot(x, y)".to_owned(),
                    _ => word.to_owned(),
                };
                let name = word.to_owned();
                Err(Diagnostic::new(
                    span,
                    ValueKind::NumberJoinedToName { number, name, factor, diameter },
                ))
            }
            _ => {
                let suggestion = UNITS.into_iter().find(|unit| unit.eq_ignore_ascii_case(word));
                let known = Names::new(UNITS);
                Err(Diagnostic::new(
                    unit.span,
                    ValueKind::UnknownUnit { unit: word.to_owned(), suggestion, known },
                ))
            }
        }
    }

    fn name(&mut self, word: &str, span: Span, may: Allowed) -> LoweringResult {
        // A definition of a reserved name was rejected; what it would have meant is unknown.
        if let Some(reported) = self.broken.get(word) {
            return Err(without_value(span, word, *reported));
        }
        let coordinate = match word {
            "pi" => {
                return Ok(Lowered {
                    id: self.graph.number(Number::pi()),
                    dimension: Dimension::Dimensionless,
                });
            }
            "depth" => {
                return match may {
                    Allowed::Depth(depth) => Ok(Lowered { id: depth, dimension: LENGTH }),
                    Allowed::Coordinates => {
                        Err(Diagnostic::new(span, ValueKind::DepthNotAvailable))
                    }
                    Allowed::Constants(role) => Err(not_constant(span, Some(word), role)),
                };
            }
            _ => self.domain.coordinates().iter().find(|(.., name)| *name == word),
        };
        let coordinate = coordinate.map(|(coordinate, ..)| *coordinate);
        if coordinate.is_none() && COORDINATES.contains(&word) {
            let domain = if word == "d" { "tool" } else { "solid" };
            let kind = ValueKind::CoordinateOfOtherDomain { name: word.to_owned(), domain };
            return Err(Diagnostic::new(span, kind));
        }
        if let Some(coordinate) = coordinate {
            if let Allowed::Constants(role) = may {
                return Err(not_constant(span, Some(word), role));
            }
            return Ok(Lowered { id: self.coordinate_here(coordinate), dimension: LENGTH });
        }
        let Some(value) = self.values.get_mut(word) else {
            if let Some(definition) = self.declared.get(word) {
                // Constants are evaluated before curves, wherever they are written.
                if definition.start < span.start
                    && let Allowed::Constants(role) = may
                {
                    return Err(not_constant(span, Some(word), role)
                        .with_label(*definition, "defined as a curve here"));
                }
                return Err(Diagnostic::new(
                    span,
                    ValueKind::UsedBeforeDefinition { name: word.to_owned() },
                )
                .with_label(*definition, "defined here"));
            }
            let known = self.values.keys().map(String::as_str).chain(["pi"]);
            // A coordinate or the depth would be the next mistake where a constant is needed.
            let varying = (!matches!(may, Allowed::Constants(_))).then_some("depth");
            let remedy = match nearest(word, known.chain(varying)) {
                Some(suggestion) => NameRemedy::Similar(suggestion.to_owned()),
                None => NameRemedy::Define,
            };
            let kind = ValueKind::UnknownName { name: word.to_owned(), remedy };
            return Err(Diagnostic::new(span, kind));
        };
        value.used = true;
        let value = value.clone();
        if let Allowed::Constants(role) = may
            && self.graph.constant(value.id).is_none()
        {
            return Err(not_constant(span, Some(word), role));
        }
        Ok(Lowered { id: value.id, dimension: value.dimension })
    }

    fn binary(
        &mut self,
        operator: Binary,
        left: &Expr,
        right: &Expr,
        span: Span,
        may: Allowed,
    ) -> LoweringResult {
        let glued = operator == Binary::Sub && left.span.end + 1 == right.span.start;
        let Lowered { id: a, dimension: da } =
            self.lower(left, may).map_err(|mut diagnostic| {
                if let Kind::ValueKind(ValueKind::UnknownName { remedy, .. }) = &mut diagnostic.kind
                    && glued
                    && matches!(left.kind, ExprKind::Name(_))
                {
                    *remedy = NameRemedy::Dash;
                }
                diagnostic
            })?;
        let Lowered { id: b, dimension: db } = self.lower(right, may)?;
        let (dimension, operation) = match operator {
            Binary::Add => (da.common(db), Operation::Add),
            Binary::Sub => (da.common(db), Operation::Subtract),
            Binary::Mul => (da.times(db), Operation::Multiply),
            _ => (da.over(db), Operation::Divide),
        };
        let dimension = dimension.ok_or_else(|| {
            Diagnostic::new(span, ValueKind::MixedOperands { operation, left: da, right: db })
        })?;
        let id = match operator {
            Binary::Add => self.graph.add(a, b),
            Binary::Sub => self.graph.sub(a, b),
            Binary::Mul => self.graph.mul(a, b),
            _ => self
                .graph
                .div(a, b)
                .ok_or_else(|| Diagnostic::new(right.span, ValueKind::DivisionByZero))?,
        };
        Ok(Lowered { id, dimension })
    }

    fn power(&mut self, base: &Expr, exponent: &Expr, span: Span, may: Allowed) -> LoweringResult {
        let Lowered { id: base_id, dimension } = self.lower(base, may)?;
        let Constant { value, dimension: of_exponent } = self.constant(exponent, Role::Exponent)?;
        let halves =
            value
                .doubled_exponent()
                .filter(|_| of_exponent == Dimension::Dimensionless)
                .ok_or_else(|| Diagnostic::new(exponent.span, ValueKind::UnsupportedExponent))?;
        let dimension = dimension
            .power(halves)
            .ok_or_else(|| Diagnostic::new(span, ValueKind::PowerOfAngle))?;
        let id = self
            .graph
            .power(base_id, halves)
            .ok_or_else(|| Diagnostic::new(span, ValueKind::UndefinedPower))?;
        Ok(Lowered { id, dimension })
    }
}

/// Returns the names that an expression mentions, in the order of the text.
pub(super) fn mentioned(expr: &Expr) -> Vec<(&str, Span)> {
    let mut names = Vec::new();
    let mut pending = vec![expr];
    while let Some(expr) = pending.pop() {
        match &expr.kind {
            ExprKind::Number(..) => {}
            ExprKind::Name(word) => names.push((word.as_str(), expr.span)),
            ExprKind::Call(_, arguments) => pending.extend(arguments.iter().rev()),
            ExprKind::Neg(inner) => pending.push(inner),
            ExprKind::Binary(_, left, right) => pending.extend([&**right, &**left]),
        }
    }
    names
}

/// Checks that the compiler can work with the size of a constant.
pub(super) fn in_range(value: &Number, span: Span) -> Result<(), Diagnostic> {
    if value.is_in_range() {
        return Ok(());
    }
    Err(Diagnostic::new(span, ValueKind::ValueOutOfRange { value: value.to_f64() }))
}

fn not_constant(span: Span, word: Option<&str>, role: Role) -> Diagnostic {
    Diagnostic::new(span, ValueKind::NotConstant { name: word.map(str::to_owned), role })
}

/// Returns the error for the use of a name whose definition was rejected.
pub(super) fn without_value(span: Span, word: &str, refused: Reported) -> Diagnostic {
    let kind = ValueKind::NameWithoutValue { name: word.to_owned() };
    Diagnostic::new(span, kind).caused_by(refused)
}

static FUNCTIONS: [&str; 8] = ["min", "max", "hypot", "sqrt", "abs", "sin", "cos", "tan"];

impl Lowering {
    fn call(
        &mut self,
        name: &Name,
        arguments: &[Expr],
        span: Span,
        may: Allowed,
    ) -> LoweringResult {
        let word = name.text.as_str();
        let expected_count = match word {
            "min" | "max" | "hypot" => 2..=usize::MAX,
            "sqrt" | "abs" | "sin" | "cos" | "tan" => 1..=1,
            _ => {
                let kind = ValueKind::UnknownFunction {
                    name: word.to_owned(),
                    suggestion: nearest(word, FUNCTIONS),
                    known: &FUNCTIONS,
                };
                return Err(Diagnostic::new(name.span, kind));
            }
        };
        if !expected_count.contains(&arguments.len()) {
            let (function, variadic) = (word.to_owned(), *expected_count.start() == 2);
            let kind = ValueKind::WrongArgumentCount { function, variadic, count: arguments.len() };
            return Err(Diagnostic::new(span, kind));
        }
        if matches!(word, "sin" | "cos" | "tan") {
            return self.trigonometric(word, &arguments[0], span, may);
        }
        let Lowered { mut id, mut dimension } = self.lower(&arguments[0], may)?;
        match word {
            "abs" => return Ok(Lowered { id: self.graph.abs(id), dimension }),
            "sqrt" => {
                let dimension = dimension
                    .power(1)
                    .ok_or_else(|| Diagnostic::new(span, ValueKind::RootOfAngle))?;
                let root = self
                    .graph
                    .sqrt(id)
                    .ok_or_else(|| Diagnostic::new(arguments[0].span, ValueKind::RootOfNegative))?;
                return Ok(Lowered { id: root, dimension });
            }
            "hypot" => id = self.graph.mul(id, id),
            _ => {}
        }
        for argument in &arguments[1..] {
            let Lowered { id: other, dimension: of_other } = self.lower(argument, may)?;
            dimension = dimension.common(of_other).ok_or_else(|| {
                Diagnostic::new(
                    argument.span,
                    ValueKind::MixedArguments {
                        function: word.to_owned(),
                        first: dimension,
                        second: of_other,
                    },
                )
            })?;
            id = match word {
                "min" => self.graph.min(id, other),
                "max" => self.graph.max(id, other),
                _ => {
                    let square = self.graph.mul(other, other);
                    self.graph.add(id, square)
                }
            };
        }
        if word == "hypot" {
            id = self.graph.sqrt(id).unwrap_or(id);
        }
        Ok(Lowered { id, dimension })
    }

    fn trigonometric(
        &mut self,
        word: &str,
        argument: &Expr,
        span: Span,
        may: Allowed,
    ) -> LoweringResult {
        let Lowered { id, dimension } = self.lower(argument, may)?;
        let Some(angle) = self.graph.constant(id).cloned() else {
            return Err(Diagnostic::new(
                span,
                ValueKind::TrigonometryOfVariable { function: word.to_owned() },
            ));
        };
        if dimension != Dimension::Angle {
            return Err(Diagnostic::new(
                argument.span,
                ValueKind::NotAngle { function: word.to_owned(), dimension, value: angle.to_f64() },
            ));
        }
        if angle.to_f64().abs() > 1e6 {
            return Err(Diagnostic::new(argument.span, ValueKind::HugeAngle));
        }
        let cos = angle.cos();
        let value = match word {
            "sin" => angle.sin(),
            "cos" => cos,
            _ if cos.to_f64().abs() < 2f64.powi(-200) => {
                return Err(Diagnostic::new(span, ValueKind::TanOfRightAngle));
            }
            _ => &angle.sin() / &cos,
        };
        Ok(Lowered { id: self.graph.number(value), dimension: Dimension::Dimensionless })
    }
}
