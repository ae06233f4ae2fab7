//! Cycles of definitions.

use crate::diagnostic::{CycleLinks, Diagnostic, Reported, ValueKind};
use crate::source::Span;
use crate::syntax::tree::{Definition, Expr, ExprKind};
use std::collections::BTreeMap;

/// The maximum number of links of a cycle that a message lists.
const MAX_LISTED_LINKS: usize = 64;

/// Reports each cycle of definitions once, with its links, and returns the names on the cycles. If a name is defined
/// twice, the first definition counts.
pub(super) fn refused<'t>(
    definitions: impl Iterator<Item = &'t Definition>,
    diagnostics: &mut Vec<Diagnostic>,
) -> BTreeMap<String, Reported> {
    let mut of_name: BTreeMap<&str, &Definition> = BTreeMap::new();
    for definition in definitions {
        of_name.entry(&definition.name.text).or_insert(definition);
    }
    let mut refused = BTreeMap::new();
    let mut done: BTreeMap<&str, bool> = BTreeMap::new();
    // In the order of the text, so that a cycle begins at its first definition.
    let mut roots: Vec<&Definition> = of_name.values().copied().collect();
    roots.sort_by_key(|definition| definition.name.span.start);
    for root in roots {
        if done.contains_key(root.name.text.as_str()) {
            continue;
        }
        // The path from the root; each step has the names still to be followed. It is iterative rather than recursive,
        // since a chain of definitions may be as long as a file.
        done.insert(&root.name.text, false);
        let mut path = vec![Step::new(root, root.name.span)];
        while let Some(step) = path.last_mut() {
            let Some((word, span)) = step.pending.pop() else {
                done.insert(&step.definition.name.text, true);
                path.pop();
                continue;
            };
            let Some(next) = of_name.get(word) else { continue };
            match done.get(word) {
                Some(true) => {}
                Some(false) => {
                    let first = path.iter().position(|step| step.definition.name.text == word);
                    let cycle = &path[first.unwrap_or_default()..];
                    let known = cycle.iter().any(|step| refused.contains_key(step.word()));
                    if !known {
                        let reported = Reported::push(diagnostics, circular(cycle, span));
                        refused.extend(cycle.iter().map(|step| (step.word().to_owned(), reported)));
                    }
                }
                None => {
                    done.insert(word, false);
                    path.push(Step::new(next, span));
                }
            }
        }
    }
    refused
}

/// A definition on the path, the span at which the previous one mentions it, and the names that it mentions itself.
struct Step<'t> {
    definition: &'t Definition,
    span: Span,
    pending: Vec<(&'t str, Span)>,
}

impl<'t> Step<'t> {
    fn new(definition: &'t Definition, span: Span) -> Step<'t> {
        let mut pending = mentioned(&definition.value);
        pending.reverse();
        Step { definition, span, pending }
    }

    fn word(&self) -> &'t str {
        &self.definition.name.text
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

/// Returns the error for a cycle. `span` is where its last definition mentions the first one.
fn circular(cycle: &[Step<'_>], span: Span) -> Diagnostic {
    let name = cycle[0].word().to_owned();
    let [_, second, ..] = cycle else {
        let kind = ValueKind::CircularDefinition { name, links: CycleLinks(Vec::new()), more: 0 };
        return Diagnostic::new(span, kind);
    };
    let next = cycle.iter().skip(1).chain(&cycle[..1]);
    let link = |(step, next): (&Step<'_>, &Step<'_>)| [step.word(), next.word()].map(str::to_owned);
    let links: Vec<[String; 2]> = cycle.iter().zip(next).take(MAX_LISTED_LINKS).map(link).collect();
    let more = cycle.len() - links.len();
    let kind = ValueKind::CircularDefinition { name, links: CycleLinks(links), more };
    Diagnostic::new(span, kind).with_label(second.span, "first link of the cycle")
}
