//! Laws: magnitude and niceness stated for surfaces instead of regions.

use super::mount::MountedNiceness;
use crate::diagnostic::{Diagnostic, Names, RegionKind, SurfaceRemedy, enough, nearest};
use crate::model::Surface;
use crate::source::Span;
use crate::syntax::tree::{Law, Quantity};
use std::collections::{BTreeMap, BTreeSet};

/// A tool's laws.
pub(super) struct Laws<'t> {
    own: &'t [&'t Law],
    /// The niceness laws that come with the surfaces of mounted files, by surface.
    pub(super) niceness_by_surface: BTreeMap<String, MountedNiceness>,
}

impl<'t> Laws<'t> {
    pub(super) fn new(
        own: &'t [&'t Law],
        niceness_by_surface: BTreeMap<String, MountedNiceness>,
    ) -> Laws<'t> {
        Laws { own, niceness_by_surface }
    }

    /// Returns the law for a surface: one for the surface itself, otherwise one for `cutting`, otherwise one for all
    /// surfaces.
    pub(super) fn find(&self, quantity: Quantity, surface: &Surface) -> Option<&'t Law> {
        let for_word = |word: &str| {
            self.own
                .iter()
                .filter(is(quantity))
                .find(|law| law.surfaces.iter().any(|name| name.text == word))
        };
        for_word(&surface.name)
            .or_else(|| if surface.cutting { for_word("cutting") } else { None })
            .or_else(|| self.own.iter().filter(is(quantity)).find(|law| law.surfaces.is_empty()))
            .copied()
    }

    /// Reports errors in the laws themselves. A law may be for a surface that is left out.
    pub(super) fn check(
        &self,
        surfaces: &[Surface],
        left_out: &BTreeSet<String>,
        diagnostics: &mut Vec<Diagnostic>,
    ) {
        let mut known_laws: Vec<(Quantity, &str, Span)> = Vec::new();
        for law in self.own {
            if enough(diagnostics) {
                return;
            }
            let what = law.quantity.keyword();
            if law.quantity == Quantity::Niceness && law.surfaces.is_empty() {
                diagnostics.push(Diagnostic::new(law.span, RegionKind::NicenessWithoutSurface));
            }
            let words: Vec<(&str, Span)> = if law.surfaces.is_empty() {
                vec![("", law.span)]
            } else {
                law.surfaces.iter().map(|name| (name.text.as_str(), name.span)).collect()
            };
            for (word, span) in words {
                if let Some((.., first)) =
                    known_laws.iter().find(|(q, w, _)| *q == law.quantity && *w == word)
                {
                    let surface = (!word.is_empty()).then(|| word.to_owned());
                    diagnostics.push(
                        Diagnostic::new(span, RegionKind::DuplicateLaw { quantity: what, surface })
                            .with_label(*first, "first law"),
                    );
                }
                known_laws.push((law.quantity, word, span));
                let surface = surfaces.iter().find(|surface| surface.name == word);
                if word.is_empty() || word == "cutting" {
                    continue;
                }
                match surface {
                    None if left_out.contains(word) => {}
                    None => {
                        let known = surfaces.iter().map(|s| s.name.as_str());
                        // The part may have been omitted from the name of a part's surface.
                        let of_part = format!(".{word}");
                        let qualified_name = known.clone().find(|name| name.ends_with(&of_part));
                        let remedy = match qualified_name.or(nearest(word, known)) {
                            Some(suggestion) => SurfaceRemedy::Similar(suggestion.to_owned()),
                            None => named(word, surfaces),
                        };
                        let kind = RegionKind::UnknownSurface { name: word.to_owned(), remedy };
                        diagnostics.push(Diagnostic::new(span, kind));
                    }
                    Some(s) if law.quantity == Quantity::Niceness && !s.cutting => {
                        diagnostics.push(idle_niceness(span, s));
                    }
                    Some(_) => {}
                }
            }
        }
    }
}

/// Lists the surfaces of the mounted part with this name, or some of all surfaces if there is no such part.
fn named(word: &str, surfaces: &[Surface]) -> SurfaceRemedy {
    let of = format!("{word}.");
    let names = || surfaces.iter().map(|surface| surface.name.as_str());
    if names().any(|name| name.starts_with(&of)) {
        SurfaceRemedy::OfMount(Names::new(names().filter(|name| name.starts_with(&of))))
    } else {
        SurfaceRemedy::List(Names::new(names().take(8)))
    }
}

pub(super) fn idle_niceness(span: Span, surface: &Surface) -> Diagnostic {
    Diagnostic::new(span, RegionKind::NicenessOfNonCutting { surface: surface.name.clone() })
        .with_label(surface.span, "not marked `cutting` here")
}

/// Returns a filter of laws by quantity.
fn is(quantity: Quantity) -> impl Fn(&&&Law) -> bool {
    move |law| law.quantity == quantity
}
