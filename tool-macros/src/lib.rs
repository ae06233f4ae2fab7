//! The macros that compile tools. They hand text to `tool-dsl` and its answer to Rust.

use proc_macro::TokenStream;
use quote::{quote, quote_spanned};
use std::path::{Path, PathBuf};
use syn::LitStr;
use tool_dsl::report::{Report, Severity};
use tool_dsl::source::Source;
use tool_dsl::{Compiled, compile, emit};

/// `include_tool!("tools/ball.tool")`: the type that the file's tool describes. The path is
/// relative to the package's folder; touching the file rebuilds.
#[proc_macro]
pub fn include_tool(input: TokenStream) -> TokenStream {
    let path = syn::parse_macro_input!(input as LitStr);
    match at_root(&path)
        .and_then(|root| Ok(file(&root.join(path.value()), &path.value(), &path)?.0))
    {
        Ok(tokens) => tokens.into(),
        Err(error) => error.into_compile_error().into(),
    }
}

/// `tool! { tool Ball { … } }`: a tool written in place. A mistake is shown where it stands.
#[proc_macro]
pub fn tool(input: TokenStream) -> TokenStream {
    let source = Source::from_tokens(input.into());
    let compiled = compile(&source);
    let mut tokens = proc_macro2::TokenStream::new();
    for report in compiled.reports.iter().filter(|r| r.severity == Severity::Error) {
        let span = source.token_at(report.span).unwrap_or_else(proc_macro2::Span::call_site);
        let message = in_words(report, &source);
        tokens.extend(quote_spanned! { span => ::core::compile_error! { #message } });
    }
    tokens.extend(meaning(&compiled));
    tokens.into()
}

/// `tool_library!("tools")`: the types of all `.tool` files of a folder, in the order of their
/// names, and `TOOLS`, a list of them all. A file that is added needs a build script that says
/// `cargo::rerun-if-changed=tools`.
#[proc_macro]
pub fn tool_library(input: TokenStream) -> TokenStream {
    let folder = syn::parse_macro_input!(input as LitStr);
    match library(&folder) {
        Ok(tokens) => tokens.into(),
        Err(error) => error.into_compile_error().into(),
    }
}

fn library(folder: &LitStr) -> syn::Result<proc_macro2::TokenStream> {
    let place = at_root(folder)?.join(folder.value());
    let unreadable = |error: std::io::Error| {
        syn::Error::new(
            folder.span(),
            format!("cannot read the folder `{}`: {error}", folder.value()),
        )
    };
    let mut files: Vec<PathBuf> = Vec::new();
    for entry in std::fs::read_dir(&place).map_err(unreadable)? {
        let path = entry.map_err(unreadable)?.path();
        if path.extension().is_some_and(|extension| extension == "tool") {
            files.push(path);
        }
    }
    files.sort();
    if files.is_empty() {
        let message = format!("the folder `{}` has no .tool file", folder.value());
        return Err(syn::Error::new(folder.span(), message));
    }
    let mut tokens = proc_macro2::TokenStream::new();
    let mut names = Vec::new();
    for path in &files {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let (file, tool) = file(path, &format!("{}/{name}", folder.value()), folder)?;
        tokens.extend(file);
        if let Some(tool) = tool {
            names.push(syn::Ident::new(&tool, folder.span()));
        }
    }
    Ok(quote! {
        #tokens
        /// Every tool of the library, in the order of their files' names.
        pub static TOOLS: &[&dyn ::touchoff::Tool] = &[#(&#names),*];
    })
}

/// The package whose source the macro stands in.
fn at_root(path: &LitStr) -> syn::Result<PathBuf> {
    match std::env::var_os("CARGO_MANIFEST_DIR") {
        Some(root) => Ok(PathBuf::from(root)),
        None => Err(syn::Error::new(
            path.span(),
            "paths are relative to the package that cargo builds, and cargo builds none",
        )),
    }
}

/// A file's tool, and its name.
fn file(
    path: &Path,
    shown: &str,
    place: &LitStr,
) -> syn::Result<(proc_macro2::TokenStream, Option<String>)> {
    let text = std::fs::read_to_string(path).map_err(|error| {
        syn::Error::new(place.span(), format!("cannot read `{shown}`: {error}"))
    })?;
    let source = Source::new(shown, text);
    let compiled = compile(&source);
    let errors: Vec<String> = compiled
        .reports
        .iter()
        .filter(|report| report.severity == Severity::Error)
        // rustc says "error: " itself.
        .map(|report| report.render(&source, false).trim_start_matches("error: ").to_owned())
        .collect();
    let mut tokens = meaning(&compiled);
    if !errors.is_empty() {
        let message = errors.join("\n\n");
        tokens.extend(quote_spanned! { place.span() => ::core::compile_error! { #message } });
    }
    // Cargo rebuilds when a file that is included changes.
    let absolute = path.display().to_string();
    tokens.extend(quote! { const _: &[u8] = ::core::include_bytes!(#absolute); });
    Ok((tokens, compiled.name))
}

/// A tool's code; a stand-in for one that has errors.
fn meaning(compiled: &Compiled) -> proc_macro2::TokenStream {
    match (&compiled.tool, &compiled.name) {
        (Some(tool), _) => emit::emit(tool),
        (None, Some(name)) if syn::parse_str::<syn::Ident>(name).is_ok() => emit::skeleton(name),
        _ => quote! {},
    }
}

/// A report where rustc shows the place itself.
fn in_words(report: &Report, source: &Source) -> String {
    let mut text = report.message.clone();
    if let Some((span, label)) = &report.second {
        let place = source.text.get(span.start..span.end).unwrap_or_default();
        text.push_str(&format!("\nnote: {label}: `{place}`"));
    }
    if let Some(help) = &report.help {
        text.push_str(&format!("\nhelp: {help}"));
    }
    text
}
