//! Diagnostics of a tool, as tokens that make rustc show them.

use crate::diagnostic::{Diagnostic, Kind, Refusal, Severity};
use crate::source::Sources;
use proc_macro2::{Delimiter, Group, Span, TokenStream, TokenTree};
use quote::quote_spanned;

/// Returns message, code and remedy of an error that the arguments of a macro cause.
pub(super) fn with_help(kind: &Kind) -> String {
    format!("{} [{}]\nhelp: {}", kind.message(), kind.code(), kind.help())
}

/// Returns a tool's errors, each at its location.
pub(super) fn errors(refusal: &Refusal, sources: &Sources, fallback_span: Span) -> TokenStream {
    located(refusal.errors(), sources, fallback_span)
        .map(|(message, [first, last])| {
            let mut tokens = quote_spanned! { first => ::core::compile_error! };
            let mut message_group =
                Group::new(Delimiter::Brace, quote_spanned! { last => #message });
            message_group.set_span(last);
            tokens.extend([TokenTree::Group(message_group)]);
            tokens
        })
        .collect()
}

/// Returns a tool's warnings, each at its location. Notes are not shown in a build.
pub(super) fn warnings(
    diagnostics: &[Diagnostic],
    sources: &Sources,
    fallback_span: Span,
) -> TokenStream {
    let warnings = diagnostics.iter().filter(|diagnostic| diagnostic.severity == Severity::Warning);
    located(warnings, sources, fallback_span)
        .map(|(message, [first, _])| {
            // On stable Rust a macro cannot emit warnings. But rustc warns about the use of a deprecated item, and shows
            // the text of its deprecation note.
            quote_spanned! { first =>
                const _: () = {
                    #[deprecated(note = #message)]
                    const TOOL_WARNING: () = ();
                    TOOL_WARNING
                };
            }
        })
        .collect()
}

/// Returns texts, each with the first and last tokens at which rustc shows it. A diagnostic of the program's
/// own text is shown at its tokens. One of a mounted file is shown at the mount, with the line of its file.
/// All others are shown together at `fallback_span`.
fn located<'r>(
    diagnostics: impl Iterator<Item = &'r Diagnostic>,
    sources: &Sources,
    fallback_span: Span,
) -> impl Iterator<Item = (String, [Span; 2])> {
    let (mut texts, mut rest) = (Vec::new(), Vec::new());
    for diagnostic in diagnostics {
        let (source, inside) = sources.locate(diagnostic.span);
        match (source.tokens_at(inside), sources.tokens_at(diagnostic.span)) {
            (Some(tokens), _) => texts.push((plain_message(diagnostic, sources), tokens)),
            (None, Some(mount)) => texts.push((excerpt(diagnostic, sources), mount)),
            (None, None) => rest.push(excerpt(diagnostic, sources)),
        }
    }
    if !rest.is_empty() {
        texts.push((rest.join("\n\n"), [fallback_span, fallback_span]));
    }
    texts.into_iter()
}

/// Returns a diagnostic with the line of its file.
fn excerpt(diagnostic: &Diagnostic, sources: &Sources) -> String {
    let text = diagnostic.render(sources, false);
    // rustc adds "error: " and "warning: " itself; the code is moved after the message.
    let text = text.split_once("]: ").map_or(text.as_str(), |(_, message)| message);
    text.replacen('\n', &format!(" [{}]\n", diagnostic.code()), 1)
}

/// Returns a diagnostic for a location that rustc shows itself.
fn plain_message(diagnostic: &Diagnostic, sources: &Sources) -> String {
    let mut text = format!("{} [{}]", diagnostic.message(), diagnostic.code());
    if let Some((span, label)) = &diagnostic.secondary {
        let (source, inside) = sources.locate(*span);
        let quoted = sources.text(*span);
        text.push_str(&format!("\nnote: {label}: `{quoted}`"));
        text.push_str(&match source.tokens_at(inside) {
            Some([token, _]) => format!(", line {}", token.start().line),
            None => {
                let line = 1 + source.text[..inside.start].matches('\n').count();
                format!(", line {line} of {}", source.name)
            }
        });
    }
    text.push_str(&format!("\nhelp: {}", diagnostic.help()));
    text
}
