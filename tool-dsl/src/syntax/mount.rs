//! Mounts, and what a tool's params are given.

use super::limits::within_limits;
use super::parse::{Reader, is_word};
use super::tree::{Definition, Mount, Name};
use super::{Grammar, Rule, refuse};
use crate::report::Report;
use crate::source::{Source, Span};
use pest::Parser;
use pest::iterators::Pair;

/// Reads what a tool's params are given from outside its file: `D = 0.25inch, flute = 18`.
pub fn given(source: &Source) -> (Vec<Definition>, Vec<Report>) {
    pest::set_error_detail(true);
    if let Err(report) = within_limits(&source.text) {
        return (Vec::new(), vec![report.behind(source.base)]);
    }
    let pairs = match Grammar::parse(Rule::given, &source.text) {
        Ok(pairs) => pairs,
        Err(error) => {
            let report = refuse::given(&source.text, &error);
            return (Vec::new(), vec![report.behind(source.base)]);
        }
    };
    let (mut reports, mut broken) = (Vec::new(), Vec::new());
    let mut reader = Reader { offset: source.base, reports: &mut reports, broken: &mut broken };
    let settings = pairs.flatten().filter(|pair| pair.as_rule() == Rule::setting);
    let given = settings.filter_map(|pair| reader.definition(pair.into_inner())).collect();
    (given, reports)
}

impl Reader<'_> {
    pub(super) fn mount<'i>(
        &mut self,
        mut inner: impl Iterator<Item = Pair<'i, Rule>>,
        span: Span,
    ) -> Option<Mount> {
        let mut file = self.name(&inner.next()?);
        file.word = file.word.trim_matches('"').to_owned();
        let (name, cutting) = self.surface(inner.next()?);
        let mut mount = Mount { file, name: name?, cutting, with: Vec::new(), at: None, span };
        for pair in inner {
            let rule = pair.as_rule();
            let parts = pair.into_inner().filter(|part| !is_word(part.as_rule()));
            for part in parts {
                match rule {
                    Rule::with => mount.with.extend(self.definition(part.into_inner())),
                    _ => mount.at = Some(self.expr(part)),
                }
            }
        }
        Some(mount)
    }

    /// `cutter.ball`, which inline comes with spaces.
    pub(super) fn path(&self, pair: Pair<'_, Rule>) -> Name {
        let span = self.span(&pair);
        let names: Vec<&str> = pair.into_inner().map(|part| part.as_str()).collect();
        Name { word: names.join("."), span }
    }
}
