//! Procedural macros that compile tools into Rust types: [`tool!`] for a tool in the source file, [`include_tool!`] for
//! one file, [`tool_library!`] for a folder. Use them through the crate `touchoff`, which the generated code refers to.
//! The expansions are [`touchoff_dsl::expand`].

#![deny(missing_docs, missing_debug_implementations, unnameable_types)]

use proc_macro::{Span, TokenStream};
use touchoff_dsl::CheckedTool;
use touchoff_dsl::expand::Expander;

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
    expander().include_tool(input.into()).into()
}

/// `tool! { tool Ball { … } }`: a tool written in the source file. Errors are shown at its tokens. Mounted
/// files are read relative to the source file's folder; without a source file, as in an editor's preview, mounts are
/// refused.
#[proc_macro]
pub fn tool(input: TokenStream) -> TokenStream {
    expander().tool(input.into()).into()
}

/// `tool_library!("tools")` expands to one type per `.tool` file of a folder, in the order of file names; to `TOOLS`, a
/// list of all tools; and to `SOURCES`, the paths and contents of each tool's files. To pick up added files, the package
/// needs a build script that prints `cargo::rerun-if-changed=tools`.
///
/// If that script also prints `cargo::rustc-env=TOUCHOFF_TOOLS=ball,drill`, only these files are compiled; an
/// empty list compiles none. A package's features can thus select among its tools.
#[proc_macro]
pub fn tool_library(input: TokenStream) -> TokenStream {
    let wanted = std::env::var("TOUCHOFF_TOOLS").ok();
    expander().tool_library(input.into(), wanted.as_deref()).into()
}

fn expander() -> Expander {
    let file = Span::call_site().local_file();
    Expander {
        package: std::env::var_os("CARGO_MANIFEST_DIR").map(Into::into),
        file: file.and_then(|file| std::path::absolute(file).ok()),
        emit: emitted,
    }
}

/// Emits a tool, with its drawing for its documentation.
#[cfg(feature = "drawings")]
fn emitted(tool: &CheckedTool) -> proc_macro2::TokenStream {
    // rustc discards documentation, so the drawing is made for rustdoc only.
    let program = std::env::current_exe();
    if !program.is_ok_and(|program| program.file_stem().is_some_and(|name| name == "rustdoc")) {
        return touchoff_dsl::emit::emit(tool);
    }
    let (content, text) =
        (touchoff_drawing::Content::Regions, touchoff_drawing::TextRendering::Page);
    touchoff_dsl::emit::with_drawing(tool, &touchoff_drawing::svg(tool, content, text))
}

/// Emits a tool, without its drawing.
#[cfg(not(feature = "drawings"))]
fn emitted(tool: &CheckedTool) -> proc_macro2::TokenStream {
    touchoff_dsl::emit::emit(tool)
}
