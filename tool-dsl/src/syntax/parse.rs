//! Converts pairs of pest to the syntax tree.

use super::lexeme::{MAX_EXPRESSION_HEIGHT, in_name, too_much, within_limits};
use super::refuse::{self, OBLIQUE_KEYWORD, RISING_KEYWORD};
use super::tree::*;
use super::{Grammar, Rule};
use crate::diagnostic::{Diagnostic, Reported, SyntaxKind, enough};
use crate::domain::Domain;
use crate::number::Number;
use crate::source::{Source, Span};
use pest::Parser;
use pest::iterators::{Pair, Pairs};
use std::str::FromStr;

/// Names that Rust itself uses.
const RESERVED_NAMES: [&str; 8] = ["Box", "Err", "None", "Ok", "Option", "Result", "Self", "Some"];

/// Parses a tool. Returns the items that could be read even if others have errors, so that later passes can report
/// theirs.
///
/// # Errors
///
/// If the text has no tool, or exceeds a limit; the error is among the diagnostics.
pub fn parse(source: &Source, diagnostics: &mut Vec<Diagnostic>) -> Result<Tool, Reported> {
    // Requests the tokens that would have matched too, not only the rules.
    pest::set_error_detail(true);
    let text = &source.text;
    let pairs = within_limits(text)
        .and_then(|()| {
            Grammar::parse(Rule::file, text).map_err(|error| refuse::syntax(text, 0, &error))
        })
        .and_then(|pairs| too_much(pairs.clone()).map_or(Ok(pairs), Err));
    let pair = pairs
        .and_then(|pairs| {
            pairs
                .flatten()
                .find(|pair| matches!(pair.as_rule(), Rule::tool | Rule::solid))
                .ok_or_else(|| refuse::nothing(text))
        })
        .map_err(|diagnostic| Reported::push(diagnostics, diagnostic.offset_by(source.base)))?;
    let mut broken = Vec::new();
    let mut reader = Reader { offset: source.base, diagnostics, broken: &mut broken };
    let tool = reader.tool(pair);
    Ok(Tool { unparsed: broken, ..tool })
}

struct Reader<'a> {
    /// The offset of the parsed text among all sources.
    offset: usize,
    diagnostics: &'a mut Vec<Diagnostic>,
    /// The first words of items that could not be read, and the names that they define.
    broken: &'a mut Vec<String>,
}

impl Reader<'_> {
    fn span(&self, pair: &Pair<'_, Rule>) -> Span {
        let text = pair.as_str().trim_end();
        let start = pair.as_span().start() + self.offset;
        Span { start, end: start + text.len() }
    }

    fn tool(&mut self, pair: Pair<'_, Rule>) -> Tool {
        let domain = if pair.as_rule() == Rule::solid { Domain::Space } else { Domain::HalfPlane };
        let mut name = Name { text: String::new(), span: self.span(&pair) };
        let mut title = None;
        let mut items = Vec::new();
        for pair in pair.into_inner() {
            match pair.as_rule() {
                Rule::name => {
                    name = self.name(&pair);
                    if RESERVED_NAMES.contains(&name.text.as_str()) {
                        self.diagnostics.push(Diagnostic::new(
                            name.span,
                            SyntaxKind::ReservedToolName { name: name.text.clone() },
                        ));
                    } else if !is_type_name(&name.text) {
                        self.diagnostics.push(Diagnostic::new(
                            name.span,
                            SyntaxKind::NotTypeName { name: name.text.clone() },
                        ));
                    }
                }
                Rule::text => {
                    title = Some(pair.as_str().trim_matches('"').to_owned());
                    self.diagnostics.extend(refuse::hidden(pair.as_str(), self.span(&pair)));
                }
                Rule::stray if enough(self.diagnostics) => {}
                Rule::stray => items.extend(self.report_stray(&pair)),
                Rule::k_tool | Rule::k_solid => {}
                _ => items.extend(self.item(pair)),
            }
        }
        Tool { domain, name, title, items, unparsed: Vec::new() }
    }

    /// Parses again an item that the grammar could not read, alone, to find its specific error.
    fn report_stray(&mut self, pair: &Pair<'_, Rule>) -> Option<Item> {
        let text = pair.as_str();
        let offset = self.offset + pair.as_span().start();
        match Grammar::parse(Rule::item, text) {
            Ok(mut pairs) => {
                let inner = pairs.next()?.into_inner().next()?;
                Reader { offset, diagnostics: self.diagnostics, broken: self.broken }.item(inner)
            }
            Err(error) => {
                self.diagnostics.push(refuse::syntax(text, offset, &error));
                // The names that it would have defined, and those in text it includes because of a missing `;`.
                let words: Vec<&str> =
                    text.split(|c| !in_name(c)).filter(|w| !w.is_empty()).collect();
                self.broken.extend(words.first().map(|word| (*word).to_owned()));
                let defined = words
                    .windows(2)
                    .filter(|pair| ["let", "param", "curve", "region"].contains(&pair[0]));
                self.broken.extend(defined.map(|pair| pair[1].to_owned()));
                None
            }
        }
    }

    fn item(&mut self, pair: Pair<'_, Rule>) -> Option<Item> {
        let span = self.span(&pair);
        let rule = pair.as_rule();
        let mut inner = pair.into_inner().filter(|p| !is_word(p.as_rule()));
        Some(match rule {
            Rule::units => Item::Units(self.name(&inner.next()?)),
            Rule::let_ => Item::Let(self.definition(inner)?),
            Rule::param => Item::Param(self.definition(inner)?),
            Rule::curve => Item::Curve(self.definition(inner)?),
            Rule::tip => Item::Tip(self.expr(inner.next()?)),
            Rule::spindle => Item::Spindle { down: inner.next()?.as_str() == "-", span },
            Rule::profile => {
                let word = Span { end: span.start + "profile".len(), ..span };
                Item::Profile(self.profile(inner, word)?)
            }
            Rule::mount => Item::Mount(self.mount(inner, span)?),
            Rule::regions => {
                let smooth = inner.find(|pair| pair.as_rule() == Rule::smooth);
                let length =
                    smooth.and_then(|pair| pair.into_inner().find(|pair| !is_word(pair.as_rule())));
                Item::Regions { span, smooth: length.map(|pair| self.expr(pair)) }
            }
            Rule::region => Item::Region(self.region(inner)?),
            Rule::bsp => Item::Bsp(inner.map(|pair| self.name(&pair)).collect()),
            Rule::law => {
                let quantity = quantity(&inner.next()?);
                let mut surfaces = Vec::new();
                let mut next = inner.next()?;
                if next.as_rule() == Rule::which {
                    surfaces = next.into_inner().map(|pair| self.path(pair)).collect();
                    next = inner.next()?;
                }
                let value = self.expr(next);
                let rising =
                    self.allows(inner.next(), RISING_KEYWORD, quantity == Quantity::Niceness);
                Item::Law(Law { quantity, surfaces, value, allow_rising: rising, span })
            }
            _ => return None,
        })
    }

    fn name(&self, pair: &Pair<'_, Rule>) -> Name {
        Name { text: pair.as_str().to_owned(), span: self.span(pair) }
    }

    fn definition<'i>(
        &mut self,
        mut inner: impl Iterator<Item = Pair<'i, Rule>>,
    ) -> Option<Definition> {
        Some(Definition { name: self.name(&inner.next()?), value: self.expr(inner.next()?) })
    }

    fn region<'i>(&mut self, mut inner: impl Iterator<Item = Pair<'i, Rule>>) -> Option<Region> {
        let mut region = Region {
            name: self.name(&inner.next()?),
            surface: None,
            cutting: None,
            conditions: Vec::new(),
            scalars: Vec::new(),
            direction: Vec::new(),
        };
        for pair in inner {
            let span = self.span(&pair);
            match pair.as_rule() {
                Rule::surface => (region.surface, region.cutting) = self.surface(pair),
                Rule::where_ => {
                    for part in pair.into_inner().filter(|p| p.as_rule() == Rule::condition) {
                        let condition = self.condition(part);
                        region.conditions.extend(condition);
                    }
                }
                Rule::scalar => {
                    let mut parts = pair.into_inner();
                    let quantity = quantity(&parts.next()?);
                    let value = self.expr(parts.next()?);
                    let rising =
                        self.allows(parts.next(), RISING_KEYWORD, quantity == Quantity::Niceness);
                    region.scalars.push(ScalarProperty {
                        quantity,
                        value,
                        allow_rising: rising,
                        span,
                    });
                }
                Rule::direction => {
                    let mut parts = pair.into_inner().filter(|p| !is_word(p.as_rule()));
                    let part = parts.next()?;
                    let direction = match part.as_rule() {
                        Rule::away => Direction::AwayFrom(self.inner_tuple(part)?),
                        Rule::toward => Direction::Toward(self.inner_tuple(part)?),
                        _ => Direction::Vector(self.tuple(part)),
                    };
                    let oblique = self.allows(parts.next(), OBLIQUE_KEYWORD, true);
                    region.direction.push(DirectionProperty {
                        direction,
                        allow_oblique: oblique,
                        span,
                    });
                }
                _ => {}
            }
        }
        Some(region)
    }

    /// Returns whether a property allows `word`. Reports any other word, and `word` itself unless it `fits` the
    /// property.
    fn allows(&mut self, pair: Option<Pair<'_, Rule>>, word: &str, fits: bool) -> bool {
        let Some(pair) = pair else { return false };
        let span = self.span(&pair);
        let written = pair.into_inner().find(|part| part.as_rule() == Rule::name);
        let meant = fits && written.as_ref().is_some_and(|written| written.as_str() == word);
        if !meant {
            let written = written.map_or("", |written| written.as_str());
            self.diagnostics.push(refuse::allowance(span, written));
        }
        meant
    }

    /// Parses `as NAME cutting`.
    fn surface(&self, pair: Pair<'_, Rule>) -> (Option<Name>, Option<Span>) {
        let (mut name, mut cutting) = (None, None);
        for part in pair.into_inner() {
            match part.as_rule() {
                Rule::name => name = Some(self.name(&part)),
                Rule::cutting => cutting = Some(self.span(&part)),
                _ => {}
            }
        }
        (name, cutting)
    }

    fn profile<'i>(
        &mut self,
        inner: impl Iterator<Item = Pair<'i, Rule>>,
        span: Span,
    ) -> Option<Profile> {
        let (mut start, mut pieces) = (None, Vec::new());
        for pair in inner {
            match pair.as_rule() {
                Rule::start => start = self.inner_tuple(pair),
                Rule::line | Rule::arc => self.pieces(pair, &mut pieces),
                _ => {}
            }
        }
        Some(Profile { start: start?, segments: pieces, span })
    }

    fn pieces(&mut self, pair: Pair<'_, Rule>, pieces: &mut Vec<PathSegment>) {
        let pair_span = self.span(&pair);
        let (mut points, mut round, mut concave) = (Vec::new(), None, None);
        let (mut surface, mut cutting) = (None, None);
        for part in pair.into_inner() {
            match part.as_rule() {
                Rule::tuple => points.push(self.tuple(part)),
                Rule::center => round = self.inner_tuple(part).map(ArcCircle::Center),
                Rule::radius => {
                    let value = part.into_inner().find(|p| p.as_rule() == Rule::expr);
                    round = value.map(|value| ArcCircle::Radius(self.expr(value)));
                }
                Rule::concave => concave = Some(self.span(&part)),
                Rule::surface => (surface, cutting) = self.surface(part),
                _ => {}
            }
        }
        let Some(surface) = surface else { return };
        let one = points.len() == 1;
        for to in points {
            let span = if one { pair_span } else { to.span };
            let arc = round.clone().map(|round| Arc { circle: round, concave });
            pieces.push(PathSegment { end: to, arc, surface: surface.clone(), cutting, span });
        }
    }

    fn inner_tuple(&mut self, pair: Pair<'_, Rule>) -> Option<Tuple> {
        let tuple = pair.into_inner().find(|p| p.as_rule() == Rule::tuple)?;
        Some(self.tuple(tuple))
    }

    fn tuple(&mut self, pair: Pair<'_, Rule>) -> Tuple {
        let span = self.span(&pair);
        Tuple { components: pair.into_inner().map(|part| self.expr(part)).collect(), span }
    }

    fn condition(&mut self, pair: Pair<'_, Rule>) -> Option<Condition> {
        let span = self.span(&pair);
        let mut inner = pair.into_inner();
        let first = self.expr(inner.next()?);
        let mut rest = Vec::new();
        while let (Some(compare), Some(next)) = (inner.next(), inner.next()) {
            let compare_span = self.span(&compare);
            let compare = match compare.as_str() {
                "<=" => Compare::AtMost,
                ">=" => Compare::AtLeast,
                other => {
                    self.diagnostics.push(refuse::comparison(compare_span, other));
                    return None;
                }
            };
            rest.push((compare, self.expr(next)));
        }
        Some(Condition { first, rest, span })
    }
}

/// Returns whether a word is usable as the name of a Rust type.
pub fn is_type_name(name: &str) -> bool {
    name.starts_with(|c: char| c.is_ascii_uppercase())
        && !name.contains('_')
        && !RESERVED_NAMES.contains(&name)
}

fn quantity(pair: &Pair<'_, Rule>) -> Quantity {
    match pair.as_rule() {
        Rule::depth => Quantity::Depth,
        Rule::magnitude => Quantity::Magnitude,
        _ => Quantity::Niceness,
    }
}

/// Returns the tokens and comments of a text in order.
pub(crate) fn tokens(text: &str) -> Result<Pairs<'_, Rule>, Diagnostic> {
    match Grammar::parse(Rule::tokens, text) {
        Ok(mut pairs) => Ok(pairs.next().map_or(pairs, Pair::into_inner)),
        Err(error) => Err(refuse::syntax(text, 0, &error)),
    }
}

/// Returns whether a rule is a keyword that carries no information.
fn is_word(rule: Rule) -> bool {
    matches!(
        rule,
        Rule::k_units
            | Rule::k_smooth
            | Rule::k_let
            | Rule::k_param
            | Rule::k_curve
            | Rule::k_tip
            | Rule::k_z
            | Rule::k_spindle
            | Rule::k_region
            | Rule::k_as
            | Rule::k_where
            | Rule::k_direction
            | Rule::k_bsp
            | Rule::k_profile
            | Rule::k_regions
            | Rule::k_mount
            | Rule::k_with
            | Rule::k_at
            | Rule::k_allow
    )
}

/// The maximum number of operands of one sum or product.
const MAX_OPERANDS: usize = 64;

/// An expression and its height in operations.
type Measured = (Expr, u32);

impl Reader<'_> {
    /// Parses an expression. If it is higher than the limit it is truncated and reported.
    fn expr(&mut self, pair: Pair<'_, Rule>) -> Expr {
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

/// Parses the arguments of a tool's parameters given from outside its file: `D = 0.25inch, flute = 18`. Errors are
/// added to the diagnostics.
pub fn parse_argument(source: &Source, diagnostics: &mut Vec<Diagnostic>) -> Vec<Definition> {
    pest::set_error_detail(true);
    let text = &source.text;
    let pairs = within_limits(text).and_then(|()| {
        Grammar::parse(Rule::given, text).map_err(|error| refuse::given(text, &error))
    });
    let pairs = match pairs {
        Ok(pairs) => pairs,
        Err(diagnostic) => {
            diagnostics.push(diagnostic.offset_by(source.base));
            return Vec::new();
        }
    };
    let mut broken = Vec::new();
    let mut reader = Reader { offset: source.base, diagnostics, broken: &mut broken };
    let settings = pairs.flatten().filter(|pair| pair.as_rule() == Rule::setting);
    settings.filter_map(|pair| reader.definition(pair.into_inner())).collect()
}

impl Reader<'_> {
    fn mount<'i>(
        &mut self,
        mut inner: impl Iterator<Item = Pair<'i, Rule>>,
        span: Span,
    ) -> Option<Mount> {
        let mut file = self.name(&inner.next()?);
        self.diagnostics.extend(refuse::hidden(&file.text, file.span));
        file.text = file.text.trim_matches('"').to_owned();
        let (name, cutting) = self.surface(inner.next()?);
        let mut mount =
            Mount { file, name: name?, cutting, arguments: Vec::new(), position: None, span };
        for pair in inner {
            let rule = pair.as_rule();
            let parts = pair.into_inner().filter(|part| !is_word(part.as_rule()));
            for part in parts {
                match rule {
                    Rule::with => mount.arguments.extend(self.definition(part.into_inner())),
                    _ => mount.position = Some(self.expr(part)),
                }
            }
        }
        Some(mount)
    }

    /// Parses a path such as `cutter.ball`, whose tokens are separated by blanks in an inline tool.
    fn path(&self, pair: Pair<'_, Rule>) -> Name {
        let span = self.span(&pair);
        let names: Vec<&str> = pair.into_inner().map(|part| part.as_str()).collect();
        Name { text: names.join("."), span }
    }
}
