//! The expansions of the macros `tool!`, `include_tool!` and `tool_library!`: tokens in; Rust, or errors at their tokens, out.
//!
//! The package `touchoff-macros` passes its input on to these functions. They are an ordinary library, so tests call them without rustc.

mod messages;

use crate::diagnostic::{Kind, SyntaxKind};
use crate::source::Source;
use crate::{CheckedTool, Compiled, compile, compile_with_arguments, emit, syntax};
use proc_macro2::TokenStream;
use quote::quote;
use std::path::{Path, PathBuf};
use syn::parse::{Parse, ParseStream};
use syn::{Ident, LitStr, Token};

/// The surroundings of a macro's call.
#[derive(Clone, Debug)]
pub struct Expander {
    /// The folder to which the paths of `include_tool!` and `tool_library!` are relative: that of the package.
    pub package: Option<PathBuf>,
    /// The file that contains the call, to which the mounts of `tool!` are relative.
    pub file: Option<PathBuf>,
    /// Emits the code of a tool.
    pub emit: fn(&CheckedTool) -> TokenStream,
}

impl Expander {
    /// Expands `tool! { … }`. Errors are shown at its tokens.
    pub fn tool(&self, input: TokenStream) -> TokenStream {
        let mut source = Source::from_tokens(input);
        if let Some(file) = &self.file {
            source = source.with_path(file);
        }
        self.expand(&compile(&source), proc_macro2::Span::call_site())
    }

    /// Expands `include_tool!("ball.tool" as Ball, D = 4)`.
    pub fn include_tool(&self, input: TokenStream) -> TokenStream {
        let tokens = syn::parse2(input).and_then(|call: Call| self.included(&call));
        tokens.unwrap_or_else(syn::Error::into_compile_error)
    }

    /// Expands `tool_library!("tools")`. `wanted` are comma-separated names of files without the extension, if only
    /// some are compiled.
    pub fn tool_library(&self, input: TokenStream, wanted: Option<&str>) -> TokenStream {
        let tokens = syn::parse2(input).and_then(|folder: LitStr| self.library(&folder, wanted));
        tokens.unwrap_or_else(syn::Error::into_compile_error)
    }

    fn included(&self, call: &Call) -> syn::Result<TokenStream> {
        if let Some(name) = &call.name
            && !syntax::is_type_name(&name.to_string())
        {
            let kind = Kind::from(SyntaxKind::NotTypeName { name: name.to_string() });
            return Err(syn::Error::new(name.span(), messages::with_help(&kind)));
        }
        let shown = call.path.value();
        let source = read(&self.package_root(&call.path)?.join(&shown), &shown, &call.path)?;
        let mut compiled = compile_with_arguments(&source, call.arguments.as_slice());
        if let Some(name) = &call.name {
            compiled = compiled.renamed(&name.to_string());
        }
        Ok(self.expand(&compiled, call.path.span()))
    }

    fn library(&self, folder: &LitStr, wanted: Option<&str>) -> syn::Result<TokenStream> {
        let root = self.package_root(folder)?.join(folder.value());
        let unreadable = |error: std::io::Error| {
            syn::Error::new(
                folder.span(),
                format!("cannot read the folder `{}`: {error}", folder.value()),
            )
        };
        let mut files: Vec<PathBuf> = Vec::new();
        for entry in std::fs::read_dir(&root).map_err(unreadable)? {
            let path = entry.map_err(unreadable)?.path();
            if path.extension().is_some_and(|extension| extension == "tool") {
                files.push(path);
            }
        }
        // The order of a folder's entries differs between platforms.
        files.sort();
        if let Some(wanted) = wanted {
            files = select_files(wanted, &files, folder)?;
        } else if files.is_empty() {
            let message = format!("the folder `{}` has no .tool file", folder.value());
            return Err(syn::Error::new(folder.span(), message));
        }
        let mut tokens = TokenStream::new();
        let (mut names, mut file_lists) = (Vec::new(), Vec::new());
        for path in &files {
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            let source = read(path, &format!("{}/{name}", folder.value()), folder)?;
            let compiled = compile(&source);
            tokens.extend(self.expand(&compiled, folder.span()));
            if let Some(tool) = &compiled.name {
                names.push(syn::Ident::new(tool, folder.span()));
                file_lists.push(sources(&compiled, &root));
            }
        }
        Ok(quote! {
            #tokens
            /// Every tool of the library, in the order of their files' names.
            pub static TOOLS: &[&dyn ::touchoff::Tool] = &[#(&#names),*];
            /// The files of every tool in [`TOOLS`], in the same order: the tool's own file first, then those that it
            /// mounts. Each has its path relative to the folder of the library, and its content.
            pub static SOURCES: &[&[(&str, &str)]] = &[#(#file_lists),*];
        })
    }

    /// Returns the folder of the package that is compiled. Errors are shown at `literal`.
    fn package_root(&self, literal: &LitStr) -> syn::Result<&Path> {
        self.package.as_deref().ok_or_else(|| {
            syn::Error::new(
                literal.span(),
                "`CARGO_MANIFEST_DIR` is not set, and paths are relative to it: build with cargo, or set it",
            )
        })
    }

    /// Expands a compiled tool: its code and warnings, or its errors and a placeholder type, and a dependency on each file.
    /// `fallback_span` is the position of messages about other files.
    fn expand(&self, compiled: &Compiled, fallback_span: proc_macro2::Span) -> TokenStream {
        let sources = &compiled.sources;
        let (mut tokens, messages) = match &compiled.outcome {
            Ok(accepted) => (
                (self.emit)(&accepted.tool),
                messages::warnings(&accepted.warnings, sources, fallback_span),
            ),
            Err(refusal) => {
                let name =
                    compiled.name.as_deref().filter(|name| syn::parse_str::<Ident>(name).is_ok());
                let placeholder = name.map(emit::placeholder).unwrap_or_default();
                (placeholder, messages::errors(refusal, sources, fallback_span))
            }
        };
        tokens.extend(messages);
        // Cargo rebuilds when an included file changes.
        for file in compiled.sources.files() {
            let file = file.display().to_string();
            tokens.extend(quote! { const _: &[u8] = ::core::include_bytes!(#file); });
        }
        tokens
    }
}

/// The arguments of `include_tool!`.
struct Call {
    path: LitStr,
    name: Option<Ident>,
    arguments: Option<Source>,
}

impl Parse for Call {
    fn parse(input: ParseStream<'_>) -> syn::Result<Call> {
        let path = input.parse()?;
        let name = match input.parse::<Option<Token![as]>>()? {
            Some(_) => Some(input.parse()?),
            None => None,
        };
        if !input.is_empty() {
            input.parse::<Token![,]>()?;
        }
        let tokens: proc_macro2::TokenStream = input.parse()?;
        let arguments = (!tokens.is_empty()).then(|| Source::from_tokens(tokens));
        Ok(Call { path, name, arguments })
    }
}

/// Returns a tool's files, as pairs of the path relative to `folder` and the content. A file outside `folder` keeps its
/// absolute path.
fn sources(compiled: &Compiled, folder: &Path) -> TokenStream {
    let files = compiled.sources.files().map(|file| {
        let name = file.strip_prefix(folder).unwrap_or(file).display().to_string();
        let path = file.display().to_string();
        quote! { (#name, ::core::include_str!(#path)) }
    });
    quote! { &[#(#files),*] }
}

/// Returns the selected files, given by comma-separated names without the extension.
fn select_files(wanted: &str, files: &[PathBuf], folder: &LitStr) -> syn::Result<Vec<PathBuf>> {
    let wanted = wanted.split(',').filter(|name| !name.is_empty());
    wanted
        .map(|name| {
            let file = files.iter().find(|path| path.file_stem().is_some_and(|stem| stem == name));
            file.cloned().ok_or_else(|| {
                let message = format!(
                    "`TOUCHOFF_TOOLS` names `{name}`, but the folder `{}` has no `{name}.tool`",
                    folder.value()
                );
                syn::Error::new(folder.span(), message)
            })
        })
        .collect()
}

/// Reads a file; `shown` is its name in messages. Errors are shown at `literal`.
fn read(path: &Path, shown: &str, literal: &LitStr) -> syn::Result<Source> {
    Source::read_as(shown, path)
        .map_err(|error| syn::Error::new(literal.span(), format!("cannot read `{shown}`: {error}")))
}
