//! Tests of straight curves in single precision, without a root: `d ≤ s z + k` by squares.

use super::near::{Sign, everywhere};
use super::tokens::{Tokens, literal};
use crate::expr::polynomial::Polynomial;
use crate::expr::{Graph, Id};
use proc_macro2::{Ident, TokenStream};
use quote::{format_ident, quote};

/// The unit roundoff of `f32`.
const ROUNDOFF: f64 = 5.960_464_477_539_063e-8;

/// `a d + b z + c`
pub(super) struct Line {
    a: f64,
    b: f64,
    c: f64,
}

impl Line {
    /// A curve's value, if it is straight in `d` and `z`.
    pub(super) fn of(graph: &Graph, value: Id) -> Option<Line> {
        let mut line = Line { a: 0.0, b: 0.0, c: 0.0 };
        for (monomial, factor) in Polynomial::of(graph, value)?.terms() {
            let place = match monomial {
                [1, 0, 0, 0] => &mut line.a,
                [0, 0, 0, 1] => &mut line.b,
                [0, 0, 0, 0] => &mut line.c,
                _ => return None,
            };
            *place = factor.to_f64();
        }
        Some(line)
    }

    /// Whether it may have a sign within a margin of a point of a tool of this size.
    ///
    /// What rounding adds to the margin: 4 units of roundoff of each of the sizes that are added or
    /// squared, where there are no more than two roundings of each.
    pub(super) fn write(&self, code: &mut Tokens, bounds: &mut Bounds, sign: Sign, size: f64) {
        let [a, b, c] = match sign {
            Sign::NotAbove => [self.a, self.b, self.c],
            Sign::Above => [-self.a, -self.b, -self.c],
        };
        if a == 0.0 && b == 0.0 {
            return everywhere(code);
        }
        if a == 0.0 {
            let end = -c / b;
            let slack = Slack { margin: 1.0, rounding: 4.0 * ROUNDOFF * (end.abs() + size) };
            code.lane("le", |code| {
                if b > 0.0 {
                    code.word("z").sign(",").word(&bounds.most(end, &slack));
                } else {
                    code.word(&bounds.least(end, &slack)).sign(",").word("z");
                }
            });
            return;
        }
        let (slope, start) = (-b / a, -c / a);
        let slack = Slack {
            margin: 1.0 + slope.abs(),
            rounding: 4.0 * ROUNDOFF * ((1.0 + slope.abs()) * size + start.abs()),
        };
        if slope == 0.0 {
            code.lane("le", |code| {
                if a > 0.0 {
                    code.word("q").sign(",").word(&bounds.most_squared(start, &slack));
                } else {
                    code.word(&bounds.least_squared(start, &slack)).sign(",").word("q");
                }
            });
            return;
        }
        code.brace(|code| {
            code.word("let").word("root").sign("=");
            let root = |code: &mut Tokens, bound: &str| {
                code.word("z").sign("*").number(slope).sign("+").word(bound);
            };
            if a > 0.0 {
                root(code, &bounds.most(start, &slack));
                // A negative root has a negative square here, and nothing is within it.
                code.sign(";").lane("le", |code| {
                    code.word("q").sign(",").word("root").sign("*").word("root").sign(".");
                    code.word("abs").paren(|_| {});
                });
            } else {
                code.lane("max", |code| {
                    root(code, &bounds.least(start, &slack));
                    code.sign(",").of_lanes(0.0);
                });
                code.sign(";").lane("le", |code| {
                    code.word("root").sign("*").word("root").sign(",").word("q");
                });
            }
        });
    }
}

/// So many margins, and what rounding adds.
pub(super) struct Slack {
    pub(super) margin: f64,
    pub(super) rounding: f64,
}

/// What is compared with, each a constant and its slack: computed once for a margin.
#[derive(Default)]
pub(super) struct Bounds(Vec<TokenStream>);

impl Bounds {
    fn put(&mut self, bound: TokenStream) -> String {
        self.0.push(bound);
        format!("bound{}", self.0.len() - 1)
    }

    /// The name of a constant with its slack.
    pub(super) fn most(&mut self, c: f64, slack: &Slack) -> String {
        let (c, margin) = (literal(c + slack.rounding), literal(slack.margin));
        self.put(quote! { #c + margin * #margin })
    }

    /// The name of a constant less its slack.
    pub(super) fn least(&mut self, c: f64, slack: &Slack) -> String {
        let (c, margin) = (literal(c - slack.rounding), literal(slack.margin));
        self.put(quote! { #c - margin * #margin })
    }

    /// The square of the same; of a negative number, negative.
    pub(super) fn most_squared(&mut self, c: f64, slack: &Slack) -> String {
        let (c, margin) = (literal(c + slack.rounding), literal(slack.margin));
        self.put(quote! { (#c + margin * #margin) * (#c + margin * #margin).abs() })
    }

    /// The square of the same; of a negative number, 0.
    pub(super) fn least_squared(&mut self, c: f64, slack: &Slack) -> String {
        let (c, margin) = (literal(c - slack.rounding), literal(slack.margin));
        self.put(quote! { Lane::max(#c - margin * #margin, 0.0) * Lane::max(#c - margin * #margin, 0.0) })
    }

    /// The function that computes them, and code that has them in lanes.
    pub(super) fn done(self, code: &TokenStream) -> [TokenStream; 2] {
        let (all, names) = (&self.0, (0..self.0.len()).map(|k| format_ident!("bound{k}")));
        let names: Vec<Ident> = names.collect();
        let count = names.len();
        let compute = quote! {
            fn near_bounds(margin: f64) -> impl AsRef<[f64]> {
                let bounds: [f64; #count] = [#(#all),*];
                bounds
            }
        };
        let take = quote! {
            match bounds {
                &[#(#names),*] => {
                    #(let #names = z.single(#names);)*
                    #code
                }
                // Of what is not this tool's, nothing.
                _ => Lane::lt(z, z),
            }
        };
        [compute, take]
    }
}
