//! Parses expressions: converts pairs of pest to sums, products and their operands.

use super::Rule;
use super::limits::MAX_EXPRESSION_HEIGHT;
use super::parse::Reader;
use super::tree::{Binary, Expr, ExprKind, Name};
use crate::diagnostic::{Diagnostic, SyntaxKind};
use crate::number::Number;
use crate::source::Span;
use pest::iterators::{Pair, Pairs};
use std::str::FromStr;

/// The maximum number of operands of one sum or product.
const MAX_OPERANDS: usize = 64;

/// An expression and its height in operations.
type Measured = (Expr, u32);

impl Reader<'_> {
    /// Parses an expression. If it is higher than the limit it is truncated and reported.
    pub(super) fn expr(&mut self, pair: Pair<'_, Rule>) -> Expr {
        let mut beyond = None;
        let (expr, _) = self.tree(pair, &mut beyond);
        if let Some(span) = beyond {
            self.diagnostics.push(Diagnostic::new(
                span,
                SyntaxKind::ExpressionTooDeep { limit: MAX_EXPRESSION_HEIGHT },
            ));
        }
        expr
    }

    /// Parses an expression recursively. The depth is that of nested brackets, which is limited. `beyond` receives the
    /// span at which the expression was truncated.
    fn tree(&mut self, pair: Pair<'_, Rule>, beyond: &mut Option<Span>) -> Measured {
        let span = self.span(&pair);
        let nothing = || (ExprKind::Name(String::new()), 0);
        let (kind, height) = match pair.as_rule() {
            Rule::expr | Rule::product => return self.chain(pair.into_inner(), beyond),
            Rule::group => match pair.into_inner().next() {
                Some(inner) => {
                    let (inner, height) = self.tree(inner, beyond);
                    (inner.kind, height)
                }
                None => nothing(),
            },
            Rule::signed | Rule::signed_atom => {
                let mut inner = pair.into_inner();
                match (inner.next(), inner.next()) {
                    (Some(_), Some(operand)) => {
                        let (operand, height) = self.tree(operand, beyond);
                        if height == MAX_EXPRESSION_HEIGHT {
                            *beyond = beyond.or(Some(span));
                            return (operand, height);
                        }
                        (ExprKind::Neg(Box::new(operand)), height + 1)
                    }
                    (Some(operand), None) => return self.tree(operand, beyond),
                    _ => nothing(),
                }
            }
            Rule::power => {
                let mut inner = pair.into_inner();
                match (inner.next(), inner.next()) {
                    (Some(base), Some(exponent)) => {
                        let base = self.tree(base, beyond);
                        let exponent = self.tree(exponent, beyond);
                        return binary(Binary::Pow, base, exponent, span, beyond);
                    }
                    (Some(base), None) => return self.tree(base, beyond),
                    _ => nothing(),
                }
            }
            Rule::number => (self.number(pair.as_str(), span), 0),
            Rule::call => {
                let mut inner = pair.into_inner();
                match inner.next() {
                    Some(name) => {
                        let name = self.name(&name);
                        let (mut arguments, mut tallest) = (Vec::new(), 0);
                        for part in inner {
                            let (argument, height) = self.tree(part, beyond);
                            tallest = tallest.max(height);
                            arguments.push(argument);
                        }
                        if tallest == MAX_EXPRESSION_HEIGHT {
                            *beyond = beyond.or(Some(span));
                            return (
                                Expr { kind: ExprKind::Number(Number::int(1), None), span },
                                0,
                            );
                        }
                        (ExprKind::Call(name, arguments), tallest + 1)
                    }
                    None => nothing(),
                }
            }
            _ => (ExprKind::Name(pair.as_str().trim().to_owned()), 0),
        };
        (Expr { kind, span }, height.min(MAX_EXPRESSION_HEIGHT))
    }

    /// Parses `a + b - c` or `a * b / c`, both left-associative.
    fn chain(&mut self, mut inner: Pairs<'_, Rule>, beyond: &mut Option<Span>) -> Measured {
        let mut left = match inner.next() {
            Some(first) => self.tree(first, beyond),
            None => {
                let span = Span { start: 0, end: 0 };
                (Expr { kind: ExprKind::Name(String::new()), span }, 0)
            }
        };
        let mut operands = 1;
        while let (Some(operator), Some(right)) = (inner.next(), inner.next()) {
            operands += 1;
            if operands > MAX_OPERANDS {
                let diagnostic = Diagnostic::new(self.span(&right), SyntaxKind::ExpressionTooLong);
                self.diagnostics.push(diagnostic);
                break;
            }
            let operator = match operator.as_str() {
                "+" => Binary::Add,
                "-" => Binary::Sub,
                "*" => Binary::Mul,
                _ => Binary::Div,
            };
            let right = self.tree(right, beyond);
            let span = left.0.span.to(right.0.span);
            left = binary(operator, left, right, span, beyond);
        }
        left
    }

    fn number(&mut self, text: &str, span: Span) -> ExprKind {
        let digits = digits(text);
        // Longer numbers and exponents far out of range would take too long to convert.
        let exponent = text[..digits].rsplit_once(['e', 'E']).map_or("0", |(_, exponent)| exponent);
        let sane = digits <= 400 && exponent.parse::<i32>().is_ok_and(|e| e.abs() <= 400);
        let value = match sane.then(|| Number::parse_decimal(&text[..digits])).flatten() {
            Some(value) if value.is_in_range() => value,
            _ => {
                self.diagnostics.push(Diagnostic::new(span, SyntaxKind::NumberOutOfRange));
                Number::int(1)
            }
        };
        let suffix = (digits < text.len()).then(|| Name {
            text: text[digits..].to_owned(),
            span: Span { start: span.start + digits, end: span.end },
        });
        ExprKind::Number(value, suffix)
    }
}

/// Returns the operation on two operands, or the first operand alone if the limit is reached.
fn binary(
    operator: Binary,
    left: Measured,
    right: Measured,
    span: Span,
    beyond: &mut Option<Span>,
) -> Measured {
    let tallest = left.1.max(right.1);
    if tallest == MAX_EXPRESSION_HEIGHT {
        *beyond = beyond.or(Some(right.0.span));
        return left;
    }
    let kind = ExprKind::Binary(operator, Box::new(left.0), Box::new(right.0));
    (Expr { kind, span }, tallest + 1)
}

/// Returns the length of the number in a number token; the rest is its unit.
fn digits(text: &str) -> usize {
    let bytes = text.as_bytes();
    let run = |mut at: usize| {
        while bytes.get(at).is_some_and(u8::is_ascii_digit) {
            at += 1;
        }
        at
    };
    let mut end = run(0);
    if bytes.get(end) == Some(&b'.') && bytes.get(end + 1).is_some_and(u8::is_ascii_digit) {
        end = run(end + 1);
    }
    if matches!(bytes.get(end), Some(b'e' | b'E')) {
        let sign = usize::from(matches!(bytes.get(end + 1), Some(b'+' | b'-')));
        if bytes.get(end + 1 + sign).is_some_and(u8::is_ascii_digit) {
            end = run(end + 1 + sign);
        }
    }
    // An exponent too long for any number is left to the range check.
    if f64::from_str(&text[..end]).is_err() { text.len() } else { end }
}
