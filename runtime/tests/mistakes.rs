//! Mistakes in tools as seen by a person who builds a program with them. Beside each case is the output of rustc for it. One mistake
//! gives one error, though the tool is used; each error states a remedy, and the terminal shows the same.
//!
//! The expansions are compared with these outputs in this process. That rustc prints them so is what `mistakes_in_tools` asks, which
//! builds the library again and is left to the full run. After a change of the wording, `scripts/accept` overwrites the outputs.

use proc_macro2::{Delimiter, Group, Span, TokenStream, TokenTree};
use std::iter::Peekable;
use std::path::{Path, PathBuf};
use std::str::FromStr;
use touchoff_dsl::compile;
use touchoff_dsl::diagnostic::Severity;
use touchoff_dsl::emit;
use touchoff_dsl::expand::Expander;
use touchoff_dsl::source::Source;

/// An error as rustc shows it: its text, where it begins, and its width if it lies in one line.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Shown {
    line: usize,
    column: usize,
    width: Option<usize>,
    text: String,
}

impl Shown {
    fn new(text: String, [first, last]: [Span; 2]) -> Shown {
        let (start, end) = (first.start(), last.end());
        let width = (start.line == end.line).then(|| end.column - start.column);
        // rustc counts columns from 1.
        Shown { line: start.line, column: start.column + 1, width, text }
    }
}

/// Returns the errors in the output of rustc.
fn shown_by_rustc(output: &str) -> Vec<Shown> {
    let mut shown = Vec::new();
    let mut lines = output.lines();
    while let Some(line) = lines.next() {
        let Some(title) = line.strip_prefix("error: ") else { continue };
        let title = title.strip_prefix("use of deprecated constant `_::TOOL_WARNING`: ");
        let mut text = title.unwrap_or(&line["error: ".len()..]).to_owned();
        // The next lines of a message stand below its first word.
        let place = loop {
            let line = lines.next().expect("an error has a place");
            match (line.strip_prefix("       "), line.trim_start().strip_prefix("--> ")) {
                (None, Some(place)) => break place,
                (more, _) => text = format!("{text}\n{}", more.unwrap_or(line)),
            }
        };
        let mut numbers = place.rsplit(':').map(|number| number.parse().expect("a number"));
        let (Some(column), Some(line)) = (numbers.next(), numbers.next()) else {
            panic!("no line and column: {place}")
        };
        // A frame, the line of the program, and carets below it. Errors over several lines begin with `_`.
        let carets = lines.nth(2).unwrap_or_default();
        let carets = carets.split_once('|').map_or("", |(_, carets)| carets.trim());
        let is_one_line = !carets.is_empty() && carets.chars().all(|sign| sign == '^');
        shown.push(Shown { line, column, width: is_one_line.then_some(carets.len()), text });
    }
    shown.sort();
    shown
}

/// Finds the calls of the macros in a program, and expands them. Paths are relative to the folder above the cases.
struct Calls {
    expander: Expander,
    shown: Vec<Shown>,
}

impl Calls {
    fn expand_in(&mut self, program: TokenStream) {
        let mut tokens = program.into_iter().peekable();
        while let Some(token) = tokens.next() {
            match token {
                TokenTree::Ident(name) => {
                    if let Some(input) = called(&mut tokens) {
                        self.expand(&name.to_string(), input);
                    }
                }
                TokenTree::Group(group) => self.expand_in(group.stream()),
                TokenTree::Punct(_) | TokenTree::Literal(_) => {}
            }
        }
    }

    fn expand(&mut self, name: &str, input: TokenStream) {
        let expansion = match name {
            "tool" => self.expander.tool(input),
            "include_tool" => self.expander.include_tool(input),
            "tool_library" => self.expander.tool_library(input, None),
            _ => return,
        };
        self.collect_errors(expansion);
    }

    /// Collects the messages that rustc shows: of `compile_error! { … }`, and of `deprecated(note = …)`, at whose constant it shows them.
    fn collect_errors(&mut self, expansion: TokenStream) {
        let mut tokens = expansion.into_iter().peekable();
        // A path is shown from its first token on.
        let mut start = Span::call_site();
        let mut is_in_path = false;
        while let Some(token) = tokens.next() {
            if !is_in_path {
                start = token.span();
            }
            is_in_path = matches!(&token, TokenTree::Punct(sign) if sign.as_char() == ':')
                || matches!(&token, TokenTree::Ident(_)) && is_colon(tokens.peek());
            match token {
                TokenTree::Ident(name) if name == "compile_error" => {
                    let Some(TokenTree::Group(message)) = tokens.nth(1) else { continue };
                    self.shown.push(Shown::new(text_of(&message), [start, message.span_close()]));
                }
                TokenTree::Ident(name) if name == "deprecated" => {
                    let Some(TokenTree::Group(note)) = tokens.next() else { continue };
                    self.shown.push(Shown::new(text_of(&note), [name.span(); 2]));
                }
                TokenTree::Group(group) if group.delimiter() != Delimiter::Parenthesis => {
                    self.collect_errors(group.stream());
                }
                _ => {}
            }
        }
    }
}

fn is_colon(token: Option<&TokenTree>) -> bool {
    matches!(token, Some(TokenTree::Punct(sign)) if sign.as_char() == ':')
}

/// Returns the input of a macro whose name has just been read.
fn called(tokens: &mut Peekable<proc_macro2::token_stream::IntoIter>) -> Option<TokenStream> {
    tokens.next_if(|token| matches!(token, TokenTree::Punct(sign) if sign.as_char() == '!'))?;
    match tokens.next() {
        Some(TokenTree::Group(input)) => Some(input.stream()),
        _ => None,
    }
}

/// Returns the text of the last token, a literal.
fn text_of(group: &Group) -> String {
    let literal = group.stream().into_iter().last().expect("a message");
    syn::parse2::<syn::LitStr>(literal.into()).expect("a text").value()
}

#[test]
fn expansions_show_what_rustc_prints() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests");
    for (program, said) in cases() {
        let code = std::fs::read_to_string(&program).expect("a case can be read");
        let expander = Expander {
            package: Some(folder.clone()),
            file: Some(program.clone()),
            emit: emit::emit,
        };
        let mut calls = Calls { expander, shown: Vec::new() };
        calls.expand_in(TokenStream::from_str(&code).expect("tokens of Rust"));
        // Only a build that denies warnings ends with them.
        calls.shown.sort();
        assert_eq!(calls.shown, shown_by_rustc(&said), "{}", program.display());
    }
}

/// Returns the folder in which trybuild builds its cases, to which `include_tool!` is relative.
fn package() -> PathBuf {
    let own = std::env::current_exe().expect("a test knows its own place");
    // target/debug/deps/mistakes-…
    let target = own.ancestors().nth(3).expect("a test lies in cargo's target folder");
    target.join("tests/trybuild").join(env!("CARGO_PKG_NAME"))
}

/// Puts the cases' tool files where `include_tool!("mistakes/….tool")` finds them.
fn place_tools(cases: &Path) {
    let mistakes = package().join("mistakes");
    std::fs::create_dir_all(&mistakes).expect("cargo's target folder can be written to");
    for entry in std::fs::read_dir(cases).expect("the folder of cases") {
        let path = entry.expect("the folder of cases").path();
        if path.extension().is_some_and(|extension| extension == "tool") {
            let name = path.file_name().expect("a file has a name");
            std::fs::copy(&path, mistakes.join(name)).expect("a case's tool can be copied");
        }
    }
}

/// Returns the cases: each its program, and the output of rustc for it.
fn cases() -> Vec<(PathBuf, String)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/mistakes");
    let files = std::fs::read_dir(folder).expect("the folder of cases");
    let programs = files.map(|entry| entry.expect("the folder of cases").path());
    let programs = programs.filter(|path| path.extension().is_some_and(|end| end == "rs"));
    programs
        .map(|path| {
            let said = std::fs::read_to_string(path.with_extension("stderr"));
            (path, said.expect("each case has its expected output"))
        })
        .collect()
}

/// Returns the tool that a case writes or includes, as a text of its own.
fn tool(program: &Path) -> Option<Source> {
    let code = std::fs::read_to_string(program).expect("a case can be read");
    if let Some((_, inline)) = code.split_once("touchoff::tool! {") {
        let text = inline.split("\n}").next()?;
        return Some(Source::new("tool!", text).with_path(program));
    }
    // With params given, or another name, it is no text alone.
    let name = code.split_once("include_tool!(\"")?.1.split_once("\");")?.0;
    let file = program.with_file_name(Path::new(name).file_name()?);
    Source::read_as(name, &file).ok()
}

#[test]
#[ignore = "builds the library again, and rustc compiles each case: the full run does"]
fn mistakes_in_tools() {
    let cases = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/mistakes");
    place_tools(&cases);
    trybuild::TestCases::new().compile_fail("tests/mistakes/*.rs");
}

/// A tool with warnings. Only a build that denies warnings has errors, as in `mistakes/denied_warning*.rs`.
#[expect(deprecated, reason = "the compiler's warnings are shown as notes of deprecated items")]
mod warned {
    touchoff::tool! {
        tool Pin {
            units mm;
            curve side = 3 - d;
            curve low = z;
            curve high = 40 - z;
            let idle = 3;
            region low where 0 <= low <= min(side, high) { depth: low; }
            region high where 0 <= high <= min(side, low) { depth: high; }
            region side as side cutting where 0 <= side <= min(low, high) {
                depth: side;
                direction: (0, 1);
                niceness: depth;
            }
        }
    }
}

/// Checks that a tool with warnings is compiled.
#[test]
fn warnings_do_not_stop_a_build() {
    assert_eq!(touchoff::Tool::info(&warned::Pin).name, "Pin");
}

#[test]
fn one_mistake_gives_one_error() {
    let cases = cases();
    for (program, said) in &cases {
        let errors = said.lines().filter(|line| line.starts_with("error")).count();
        let several = program.ends_with("several_mistakes.rs");
        assert_eq!(errors, if several { 8 } else { 1 }, "{}", program.display());
    }
    assert!(cases.len() >= 90);
}

#[test]
fn the_terminal_says_the_same() {
    let mut compared = 0;
    for (program, said) in cases() {
        let Some(source) = tool(&program) else { continue };
        let compiled = compile(&source);
        let lines: Vec<&str> = said.lines().map(str::trim).collect();
        let denied =
            program.file_name().is_some_and(|name| name.display().to_string().contains("denied"));
        let wanted = if denied { Severity::Warning } else { Severity::Error };
        let wanted = compiled.diagnostics().iter().filter(|report| report.severity == wanted);
        for report in wanted {
            let place = program.display();
            let title = format!("{} [{}]", report.message(), report.code());
            let help = report.help();
            let label = report.secondary.as_ref().map(|(_, label)| label.as_str());
            for text in [Some(title.as_str()), Some(&help), label].into_iter().flatten() {
                assert!(said.contains(text), "{place}: {text}");
            }
            let rendered = report.render(&compiled.sources, false);
            let file = source.name != "tool!";
            // The build prints the severity and the code in its own way.
            for line in rendered.lines().skip(1).map(str::trim).filter(|_| file) {
                assert!(lines.contains(&line), "{place}: {line}");
            }
        }
        compared += 1;
    }
    assert!(compared >= 85, "{compared}");
}
