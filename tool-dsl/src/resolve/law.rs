//! Laws: what is said of surfaces, wherever these are.

use super::mount::Along;
use crate::model::Surface;
use crate::report::{Missing, Report, enough, nearest};
use crate::source::Span;
use crate::syntax::tree::{Law, Quantity};
use std::collections::BTreeMap;

/// A tool's laws.
pub(super) struct Laws<'t> {
    own: &'t [&'t Law],
    /// The niceness that comes along with the surfaces of mounted files.
    pub(super) along: BTreeMap<String, Along>,
}

impl<'t> Laws<'t> {
    pub(super) fn new(own: &'t [&'t Law], along: BTreeMap<String, Along>) -> Laws<'t> {
        Laws { own, along }
    }

    /// The law for a surface: for the surface itself, for `cutting`, for all.
    pub(super) fn find(&self, quantity: Quantity, surface: &Surface) -> Option<&'t Law> {
        let for_word = |word: &str| {
            self.own
                .iter()
                .filter(is(quantity))
                .find(|law| law.surfaces.iter().any(|name| name.word == word))
        };
        for_word(&surface.name)
            .or_else(|| if surface.cutting { for_word("cutting") } else { None })
            .or_else(|| self.own.iter().filter(is(quantity)).find(|law| law.surfaces.is_empty()))
            .copied()
    }

    /// What is wrong with the laws themselves.
    pub(super) fn check(&self, surfaces: &[Surface], reports: &mut Vec<Report>) {
        let mut seen: Vec<(Quantity, &str, Span)> = Vec::new();
        for law in self.own {
            if enough(reports) {
                return;
            }
            let what = law.quantity.word();
            if law.quantity == Quantity::Niceness && law.surfaces.is_empty() {
                reports.push(
                    Report::error(law.span, "for which surfaces is this niceness?")
                        .help("write `niceness cutting: …;` or name the surfaces"),
                );
            }
            let words: Vec<(&str, Span)> = if law.surfaces.is_empty() {
                vec![("", law.span)]
            } else {
                law.surfaces.iter().map(|name| (name.word.as_str(), name.span)).collect()
            };
            for (word, span) in words {
                if let Some((.., first)) =
                    seen.iter().find(|(q, w, _)| *q == law.quantity && *w == word)
                {
                    let of =
                        if word.is_empty() { "everything".to_owned() } else { format!("`{word}`") };
                    reports.push(
                        Report::error(span, format!("two laws give the {what} of {of}"))
                            .and(*first, "the first")
                            .help("drop one"),
                    );
                }
                seen.push((law.quantity, word, span));
                let surface = surfaces.iter().find(|surface| surface.name == word);
                if word.is_empty() || word == "cutting" {
                    continue;
                }
                match surface {
                    None => {
                        let report = Report::error(span, format!("unknown surface `{word}`"))
                            .missing(Missing::Surface(word.to_owned()));
                        let known = surfaces.iter().map(|s| s.name.as_str());
                        // Of a part's surface the part may have been forgotten.
                        let of_part = format!(".{word}");
                        let whole = known.clone().find(|name| name.ends_with(&of_part));
                        reports.push(match whole.or(nearest(word, known)) {
                            Some(meant) => report.help(format!("did you mean `{meant}`?")),
                            None => report.help(named(word, surfaces)),
                        });
                    }
                    Some(s) if law.quantity == Quantity::Niceness && !s.cutting => {
                        reports.push(idle_niceness(span, s));
                    }
                    Some(_) => {}
                }
            }
        }
    }
}

/// Which surfaces there are: those of a mounted part, if it is named.
fn named(word: &str, surfaces: &[Surface]) -> String {
    let of = format!("{word}.");
    let list = |names: Vec<&Surface>| {
        names.iter().map(|s| format!("`{}`", s.name)).collect::<Vec<_>>().join(", ")
    };
    let part: Vec<&Surface> = surfaces.iter().filter(|s| s.name.starts_with(&of)).collect();
    match part.as_slice() {
        [] => format!("surfaces are {}", list(surfaces.iter().take(8).collect())),
        _ => format!("name a surface of the part: {}", list(part)),
    }
}

pub(super) fn idle_niceness(span: Span, surface: &Surface) -> Report {
    Report::error(span, format!("`{}` does not cut, its niceness is 0", surface.name))
        .and(surface.span, "not `cutting` here")
        .help("make it `cutting` or drop the rule")
}

/// Which rule a law is of.
fn is(quantity: Quantity) -> impl Fn(&&&Law) -> bool {
    move |law| law.quantity == quantity
}
