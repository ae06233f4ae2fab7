//! Functions: what they take, and what comes of it.

use super::dimension::Dimension;
use super::lower::{Lowered, Lowering, May};
use crate::report::{Missing, Report, nearest};
use crate::source::Span;
use crate::syntax::tree::{Expr, Name};

pub(super) const FUNCTIONS: [&str; 8] = ["min", "max", "hypot", "sqrt", "abs", "sin", "cos", "tan"];

/// What angles are for.
pub(super) const NO_POWER: &str = "take `sin`, `cos` or `tan` of it first, which are numbers";

impl Lowering {
    pub(super) fn call(
        &mut self,
        name: &Name,
        arguments: &[Expr],
        span: Span,
        may: May,
    ) -> Lowered {
        let word = name.word.as_str();
        let wanted = match word {
            "min" | "max" | "hypot" => 2..=usize::MAX,
            "sqrt" | "abs" | "sin" | "cos" | "tan" => 1..=1,
            _ => {
                let report = Report::error(name.span, format!("unknown function `{word}`"))
                    .missing(Missing::Definition(word.to_owned()));
                return Err(match nearest(word, FUNCTIONS) {
                    Some(meant) => report.help(format!("did you mean `{meant}`?")),
                    None => report.help(format!("functions are {}", FUNCTIONS.join(", "))),
                });
            }
        };
        if !wanted.contains(&arguments.len()) {
            let much = if *wanted.start() == 2 { "two or more values" } else { "one value" };
            let report =
                Report::error(span, format!("`{word}` takes {much}, this has {}", arguments.len()));
            return Err(match *wanted.start() {
                2 => report.help(format!("write `{word}(a, b)`")),
                _ => report.help(format!("write `{word}(a)`")),
            });
        }
        if matches!(word, "sin" | "cos" | "tan") {
            return self.trigonometric(word, &arguments[0], span, may);
        }
        let (mut id, mut dimension) = self.lower(&arguments[0], may)?;
        match word {
            "abs" => return Ok((self.graph.abs(id), dimension)),
            "sqrt" => {
                let dimension = dimension.power(1).ok_or_else(|| {
                    Report::error(span, "an angle has no square root").help(NO_POWER)
                })?;
                let root = self.graph.sqrt(id).ok_or_else(|| {
                    Report::error(arguments[0].span, "square root of a negative number")
                        .help("take the root of what is 0 or more")
                })?;
                return Ok((root, dimension));
            }
            "hypot" => id = self.graph.mul(id, id),
            _ => {}
        }
        for argument in &arguments[1..] {
            let (other, of_other) = self.lower(argument, may)?;
            dimension = dimension.alike(of_other).ok_or_else(|| {
                Report::error(
                    argument.span,
                    format!("`{word}` compares {dimension} with {of_other}"),
                )
                .help("all its values want the same power of length")
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

    fn trigonometric(&mut self, word: &str, argument: &Expr, span: Span, may: May) -> Lowered {
        let (id, dimension) = self.lower(argument, may)?;
        let Some(angle) = self.graph.constant(id).cloned() else {
            return Err(Report::error(span, format!("this `{word}` would run at every contact"))
                .help(format!("`{word}` takes constants only: numbers, `let`s and `param`s")));
        };
        if dimension != Dimension::Angle {
            let value = angle.to_f64();
            return Err(Report::error(
                argument.span,
                format!("`{word}` takes an angle, this is {dimension}"),
            )
            .help(format!("write `{word}({value}deg)` or `{word}({value}rad)`")));
        }
        if angle.to_f64().abs() > 1e6 {
            return Err(Report::error(argument.span, "this angle is more than a million radians")
                .help("angles are written in `deg` or `rad`"));
        }
        let cos = angle.cos();
        let value = match word {
            "sin" => angle.sin(),
            "cos" => cos,
            _ if cos.to_f64().abs() < 2f64.powi(-200) => {
                return Err(Report::error(span, "`tan` of a right angle does not exist")
                    .help("write the angle that is meant, less than 90deg"));
            }
            _ => &angle.sin() / &cos,
        };
        Ok((self.graph.number(value), Dimension::Bare))
    }
}
