//! Procedural macros that compile tools into Rust types: [`tool!`] for a tool in the source file, [`include_tool!`] for
//! one file, [`tool_library!`] for a folder. Use them through the crate `touchoff`, which the generated code refers to.

#![deny(missing_docs, missing_debug_implementations, unnameable_types)]

mod diagnostics;

use proc_macro::TokenStream;
use quote::quote;
use std::path::{Path, PathBuf};
use syn::parse::{Parse, ParseStream};
use syn::{Ident, LitStr, Token};
use touchoff_dsl::diagnostic::{Kind, SyntaxKind};
use touchoff_dsl::source::Source;
use touchoff_dsl::{CheckedTool, Compiled, compile, compile_with_arguments, emit, syntax};

/// `include_tool!("tools/ball.tool")` expands to the type that the file's tool describes. The path is
/// relative to the package's folder. A change of the file, or of one that it mounts, triggers a rebuild.
///
/// ```ignore
/// include_tool!("tools/ball.tool");
/// include_tool!("tools/ball.tool" as QuarterInchBall, D = 0.25inch, flute = 18);
/// ```
///
/// `as` renames the type. The assignments set the file's `param`s to constant expressions of the language; numbers
/// without a unit are in the file's unit.
///
/// rustc shows a tool's warnings as uses of a deprecated constant: `#![deny(warnings)]` makes them errors,
/// and `#[allow(deprecated)]` on a module around the macro silences them.
#[proc_macro]
pub fn include_tool(input: TokenStream) -> TokenStream {
    let call = syn::parse_macro_input!(input as Call);
    match call.tool() {
        Ok(tokens) => tokens.into(),
        Err(error) => error.into_compile_error().into(),
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

impl Call {
    fn tool(&self) -> syn::Result<proc_macro2::TokenStream> {
        if let Some(name) = &self.name
            && !syntax::is_type_name(&name.to_string())
        {
            let kind = Kind::from(SyntaxKind::NotTypeName { name: name.to_string() });
            return Err(syn::Error::new(name.span(), diagnostics::with_help(&kind)));
        }
        let shown = self.path.value();
        let source = read(&package_root(&self.path)?.join(&shown), &shown, &self.path)?;
        let mut compiled = compile_with_arguments(&source, self.arguments.as_slice());
        if let Some(name) = &self.name {
            compiled = compiled.renamed(&name.to_string());
        }
        Ok(expand(&compiled, self.path.span()))
    }
}

/// `tool! { tool Ball { … } }`: a tool written in the source file. Errors are shown at its tokens. Mounted
/// files are read relative to the source file's folder; without a source file, as in an editor's preview, mounts are
/// refused.
#[proc_macro]
pub fn tool(input: TokenStream) -> TokenStream {
    let mut source = Source::from_tokens(input.into());
    let here = proc_macro::Span::call_site().local_file();
    if let Some(file) = here.and_then(|file| std::path::absolute(file).ok()) {
        source = source.with_path(file);
    }
    expand(&compile(&source), proc_macro2::Span::call_site()).into()
}

/// `tool_library!("tools")` expands to one type per `.tool` file of a folder, in the order of file names; to `TOOLS`, a
/// list of all tools; and to `SOURCES`, the paths and contents of each tool's files. To pick up added files, the package
/// needs a build script that prints `cargo::rerun-if-changed=tools`.
///
/// If that script also prints `cargo::rustc-env=TOUCHOFF_TOOLS=ball,drill`, only these files are compiled; an
/// empty list compiles none. A package's features can thus select among its tools.
#[proc_macro]
pub fn tool_library(input: TokenStream) -> TokenStream {
    let folder = syn::parse_macro_input!(input as LitStr);
    match library(&folder) {
        Ok(tokens) => tokens.into(),
        Err(error) => error.into_compile_error().into(),
    }
}

fn library(folder: &LitStr) -> syn::Result<proc_macro2::TokenStream> {
    let root = package_root(folder)?.join(folder.value());
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
    if let Ok(wanted) = std::env::var("TOUCHOFF_TOOLS") {
        files = select_files(&wanted, &files, folder)?;
    } else if files.is_empty() {
        let message = format!("the folder `{}` has no .tool file", folder.value());
        return Err(syn::Error::new(folder.span(), message));
    }
    let mut tokens = proc_macro2::TokenStream::new();
    let (mut names, mut file_lists) = (Vec::new(), Vec::new());
    for path in &files {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let source = read(path, &format!("{}/{name}", folder.value()), folder)?;
        let compiled = compile(&source);
        tokens.extend(expand(&compiled, folder.span()));
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

/// Returns a tool's files, as pairs of the path relative to `folder` and the content. A file outside `folder` keeps its
/// absolute path.
fn sources(compiled: &Compiled, folder: &Path) -> proc_macro2::TokenStream {
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

/// Returns the folder of the package that is compiled. Errors are shown at `literal`.
fn package_root(literal: &LitStr) -> syn::Result<PathBuf> {
    match std::env::var_os("CARGO_MANIFEST_DIR") {
        Some(root) => Ok(PathBuf::from(root)),
        None => Err(syn::Error::new(
            literal.span(),
            "`CARGO_MANIFEST_DIR` is not set, and paths are relative to it: build with cargo, or set it",
        )),
    }
}

/// Reads a file; `shown` is its name in messages. Errors are shown at `literal`.
fn read(path: &Path, shown: &str, literal: &LitStr) -> syn::Result<Source> {
    Source::read_as(shown, path)
        .map_err(|error| syn::Error::new(literal.span(), format!("cannot read `{shown}`: {error}")))
}

/// Emits a tool, with its drawing for its documentation.
#[cfg(feature = "drawings")]
fn emitted(tool: &CheckedTool) -> proc_macro2::TokenStream {
    // rustc discards documentation, so the drawing is made for rustdoc only.
    let program = std::env::current_exe();
    if !program.is_ok_and(|program| program.file_stem().is_some_and(|name| name == "rustdoc")) {
        return emit::emit(tool);
    }
    let (content, text) =
        (touchoff_drawing::Content::Regions, touchoff_drawing::TextRendering::Page);
    emit::with_drawing(tool, &touchoff_drawing::svg(tool, content, text))
}

/// Emits a tool, without its drawing.
#[cfg(not(feature = "drawings"))]
fn emitted(tool: &CheckedTool) -> proc_macro2::TokenStream {
    emit::emit(tool)
}

/// Expands a compiled tool: its code and warnings, or its errors and a placeholder type, and a dependency on each file.
/// `call_site` is the position of messages about other files.
fn expand(compiled: &Compiled, call_site: proc_macro2::Span) -> proc_macro2::TokenStream {
    let mut tokens = match (&compiled.outcome, &compiled.name) {
        (Ok(accepted), _) => emitted(&accepted.tool),
        (Err(_), Some(name)) if syn::parse_str::<Ident>(name).is_ok() => emit::placeholder(name),
        _ => quote! {},
    };
    tokens.extend(match &compiled.outcome {
        Ok(accepted) => diagnostics::warnings(&accepted.warnings, &compiled.sources, call_site),
        Err(refusal) => diagnostics::errors(refusal, &compiled.sources, call_site),
    });
    // Cargo rebuilds when an included file changes.
    for file in compiled.sources.files() {
        let file = file.display().to_string();
        tokens.extend(quote! { const _: &[u8] = ::core::include_bytes!(#file); });
    }
    tokens
}
