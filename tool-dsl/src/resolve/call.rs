//! Lowers function calls: their arguments, dimensions and results.

use super::lower::{Allowed, Lowered, Lowering};
use crate::diagnostic::{Diagnostic, ValueKind, nearest};
use crate::dimension::Dimension;
use crate::source::Span;
use crate::syntax::tree::{Expr, Name};

pub(super) static FUNCTIONS: [&str; 8] =
    ["min", "max", "hypot", "sqrt", "abs", "sin", "cos", "tan"];

impl Lowering {
    pub(super) fn call(
        &mut self,
        name: &Name,
        arguments: &[Expr],
        span: Span,
        may: Allowed,
    ) -> Lowered {
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
        let (mut id, mut dimension) = self.lower(&arguments[0], may)?;
        match word {
            "abs" => return Ok((self.graph.abs(id), dimension)),
            "sqrt" => {
                let dimension = dimension
                    .power(1)
                    .ok_or_else(|| Diagnostic::new(span, ValueKind::RootOfAngle))?;
                let root = self
                    .graph
                    .sqrt(id)
                    .ok_or_else(|| Diagnostic::new(arguments[0].span, ValueKind::RootOfNegative))?;
                return Ok((root, dimension));
            }
            "hypot" => id = self.graph.mul(id, id),
            _ => {}
        }
        for argument in &arguments[1..] {
            let (other, of_other) = self.lower(argument, may)?;
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
        Ok((id, dimension))
    }

    fn trigonometric(&mut self, word: &str, argument: &Expr, span: Span, may: Allowed) -> Lowered {
        let (id, dimension) = self.lower(argument, may)?;
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
        Ok((self.graph.number(value), Dimension::Dimensionless))
    }
}
