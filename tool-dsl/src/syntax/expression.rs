//! Expressions: pairs of pest to sums, products and what they are made of.

use super::Rule;
use super::parse::Reader;
use super::tree::{Binary, Expr, ExprKind, Name};
use crate::number::{Number, RANGE};
use crate::report::Report;
use crate::source::Span;
use pest::iterators::{Pair, Pairs};
use std::str::FromStr;

/// The most operands of one sum or product.
const OPERANDS: usize = 64;

impl Reader<'_> {
    pub(super) fn expr(&mut self, pair: Pair<'_, Rule>) -> Expr {
        let span = self.span(&pair);
        let kind = match pair.as_rule() {
            Rule::expr | Rule::product => return self.chain(pair.into_inner()),
            Rule::group => match pair.into_inner().next() {
                Some(inner) => return Expr { span, ..self.expr(inner) },
                None => ExprKind::Name(String::new()),
            },
            Rule::signed | Rule::signed_atom => {
                let mut inner = pair.into_inner();
                match (inner.next(), inner.next()) {
                    (Some(_), Some(operand)) => ExprKind::Neg(Box::new(self.expr(operand))),
                    (Some(operand), None) => return self.expr(operand),
                    _ => ExprKind::Name(String::new()),
                }
            }
            Rule::power => {
                let mut inner = pair.into_inner();
                match (inner.next(), inner.next()) {
                    (Some(base), Some(exponent)) => ExprKind::Binary(
                        Binary::Pow,
                        Box::new(self.expr(base)),
                        Box::new(self.expr(exponent)),
                    ),
                    (Some(base), None) => return self.expr(base),
                    _ => ExprKind::Name(String::new()),
                }
            }
            Rule::number => self.number(pair.as_str(), span),
            Rule::call => {
                let mut inner = pair.into_inner();
                match inner.next() {
                    Some(name) => {
                        let name = self.name(&name);
                        ExprKind::Call(name, inner.map(|part| self.expr(part)).collect())
                    }
                    None => ExprKind::Name(String::new()),
                }
            }
            _ => ExprKind::Name(pair.as_str().trim().to_owned()),
        };
        Expr { kind, span }
    }

    /// `a + b - c` and `a * b / c`, both from the left.
    fn chain(&mut self, mut inner: Pairs<'_, Rule>) -> Expr {
        let mut left = match inner.next() {
            Some(first) => self.expr(first),
            None => Expr { kind: ExprKind::Name(String::new()), span: Span { start: 0, end: 0 } },
        };
        let mut operands = 1;
        while let (Some(operator), Some(right)) = (inner.next(), inner.next()) {
            operands += 1;
            if operands > OPERANDS {
                let report = Report::error(self.span(&right), "this expression is too long");
                self.reports.push(report.help("name a part of it with `let` or `curve`"));
                break;
            }
            let operator = match operator.as_str() {
                "+" => Binary::Add,
                "-" => Binary::Sub,
                "*" => Binary::Mul,
                _ => Binary::Div,
            };
            let right = self.expr(right);
            let span = left.span.to(right.span);
            left = Expr { kind: ExprKind::Binary(operator, Box::new(left), Box::new(right)), span };
        }
        left
    }

    fn number(&mut self, text: &str, span: Span) -> ExprKind {
        let digits = digits(text);
        // Longer ones, and exponents that are out of all range, would take their time.
        let exponent = text[..digits].rsplit_once(['e', 'E']).map_or("0", |(_, exponent)| exponent);
        let sane = digits <= 400 && exponent.parse::<i32>().is_ok_and(|e| e.abs() <= 400);
        let value = match sane.then(|| Number::decimal(&text[..digits])).flatten() {
            Some(value) if value.is_in_range() => value,
            _ => {
                self.reports.push(Report::error(span, "this number is out of range").help(RANGE));
                Number::int(1)
            }
        };
        let suffix = (digits < text.len()).then(|| Name {
            word: text[digits..].to_owned(),
            span: Span { start: span.start + digits, end: span.end },
        });
        ExprKind::Number(value, suffix)
    }
}

/// How much of a number token is the number; the rest is its unit.
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
