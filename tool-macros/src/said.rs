//! What the compiler says of a tool, where rustc shows it.

use proc_macro2::{Delimiter, Group, Span, TokenStream, TokenTree};
use quote::quote_spanned;
use tool_dsl::report::{Refusal, Report};
use tool_dsl::source::Sources;

/// A tool's errors: one that stands in the program's own text at its token, one that stands in a
/// mounted file at the mount, with its file's line; all others together at the macro's call.
pub(crate) fn errors(refusal: &Refusal, sources: &Sources, place: Span) -> TokenStream {
    let mut tokens = TokenStream::new();
    let mut rest = Vec::new();
    for report in refusal.errors() {
        let (source, inside) = sources.locate(report.span);
        match (source.tokens_at(inside), sources.tokens_at(report.span)) {
            (Some(place), _) => tokens.extend(error(&in_words(report, sources), place)),
            (None, Some(mount)) => tokens.extend(error(&excerpt(report, sources), mount)),
            (None, None) => rest.push(excerpt(report, sources)),
        }
    }
    if !rest.is_empty() {
        tokens.extend(error(&rest.join("\n\n"), [place, place]));
    }
    tokens
}

/// An error that rustc shows from the first token to the last.
fn error(message: &str, [first, last]: [Span; 2]) -> TokenStream {
    let mut tokens = quote_spanned! { first => ::core::compile_error! };
    let mut said = Group::new(Delimiter::Brace, quote_spanned! { last => #message });
    said.set_span(last);
    tokens.extend([TokenTree::Group(said)]);
    tokens
}

/// A report with the line of its file.
fn excerpt(report: &Report, sources: &Sources) -> String {
    // rustc says "error: " itself.
    report.render(sources, false).trim_start_matches("error: ").to_owned()
}

/// A report where rustc shows the place itself.
fn in_words(report: &Report, sources: &Sources) -> String {
    let mut text = report.message.clone();
    if let Some((span, label)) = &report.second {
        let (source, inside) = sources.locate(*span);
        let place = sources.text(*span);
        text.push_str(&format!("\nnote: {label}: `{place}`"));
        text.push_str(&match source.tokens_at(inside) {
            Some([token, _]) => format!(", line {}", token.unwrap().line()),
            None => {
                let line = 1 + source.text[..inside.start].matches('\n').count();
                format!(", line {line} of {}", source.name)
            }
        });
    }
    if let Some(help) = &report.help {
        text.push_str(&format!("\nhelp: {help}"));
    }
    text
}
