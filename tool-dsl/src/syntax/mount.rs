//! Parses mounts, and arguments of a tool's parameters.

use super::limits::within_limits;
use super::parse::{Reader, is_word};
use super::tree::{Definition, Mount, Name};
use super::{Grammar, Rule, refuse};
use crate::diagnostic::Diagnostic;
use crate::source::{Source, Span};
use pest::Parser;
use pest::iterators::Pair;

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
    pub(super) fn mount<'i>(
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
    pub(super) fn path(&self, pair: Pair<'_, Rule>) -> Name {
        let span = self.span(&pair);
        let names: Vec<&str> = pair.into_inner().map(|part| part.as_str()).collect();
        Name { text: names.join("."), span }
    }
}
