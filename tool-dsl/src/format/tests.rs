//! Exact layouts, and invariants of every layout.

use super::token::tokens;
use super::{format, layout};
use crate::source::Source;
use crate::syntax::parse;
use proptest::prelude::*;
use std::path::{Path, PathBuf};

/// Every construct of the language, including those that the grammar does not know yet.
const EVERY_CONSTRUCT: &str = include_str!("whole.tool");

fn formatted(text: &str) -> String {
    layout(text).expect("tokens")
}

/// Returns the tokens and the comments, each in order.
fn content(text: &str) -> (Vec<String>, Vec<String>) {
    let tokens = tokens(text).expect("tokens");
    let (comments, code): (Vec<_>, Vec<_>) = tokens.iter().partition(|token| token.is_comment());
    let texts = |tokens: Vec<&super::token::Token<'_>>| {
        tokens.iter().map(|token| token.text.to_owned()).collect()
    };
    (texts(code), texts(comments))
}

/// Returns the tokens that Rust's own lexer finds in a text, without spans and spacing.
fn rust_tokens(text: &str) -> Vec<String> {
    fn flatten(stream: proc_macro2::TokenStream, all: &mut Vec<String>) {
        for token in stream {
            match token {
                proc_macro2::TokenTree::Group(group) => {
                    all.push(format!("{:?}", group.delimiter()));
                    flatten(group.stream(), all);
                    all.push("end".to_owned());
                }
                other => all.push(other.to_string()),
            }
        }
    }
    let mut all = Vec::new();
    flatten(text.parse().expect("Rust's tokens"), &mut all);
    all
}

/// Returns the syntax tree without source locations.
fn tree(text: &str) -> String {
    let tree = parse(&Source::new("t.tool", text), &mut Vec::new()).ok();
    let shown = format!("{tree:?}");
    let mut parts = shown.split("Span { ");
    let first = parts.next().unwrap_or_default().to_owned();
    parts.fold(first, |all, part| all + part.split_once('}').map_or("", |(_, rest)| rest))
}

/// Formats a text and checks the invariants of every layout.
fn sound(text: &str) -> String {
    let once = formatted(text);
    assert_eq!(formatted(&once), once, "not idempotent:\n{text}");
    assert_eq!(content(&once), content(text), "the content changed:\n{text}\n{once}");
    assert!(once.ends_with('\n') && !once.contains("\n\n\n"), "{once}");
    let spaced = |line: &str| line.ends_with(' ') || line.ends_with('\t');
    assert!(once.contains("/*") || !once.lines().any(spaced), "{once}");
    once
}

fn tool_files() -> Vec<PathBuf> {
    let home = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let folders = [
        "tools-library/tools",
        "runtime/examples",
        "runtime/tests/mistakes",
        "tool-dsl/src/format",
    ];
    let own = folders.map(|folder| home.join(folder).read_dir().expect("a folder of the project"));
    // The shared examples are added where they exist; a checkout alone has none.
    let shared = home.join("../shared/examples").read_dir().ok();
    let mut files = Vec::new();
    for entry in own.into_iter().chain(shared).flatten() {
        let path = entry.expect("a folder's entry").path();
        if path.extension().is_some_and(|extension| extension == "tool") {
            files.push(path);
        }
    }
    assert!(files.len() >= 10);
    files
}

#[test]
fn every_construct_is_formatted() {
    assert_eq!(sound(EVERY_CONSTRUCT), EVERY_CONSTRUCT);
    // As little space as possible, and a line per token.
    let (code, _) = content(EVERY_CONSTRUCT);
    let without_comments: String = sound(&code.join(" ")).split_whitespace().collect();
    assert_eq!(sound(&code.join("\n")).split_whitespace().collect::<String>(), without_comments);
}

#[test]
fn every_tool_keeps_its_meaning() {
    for file in tool_files() {
        let text = std::fs::read_to_string(&file).expect("a readable file");
        let once = sound(&text);
        if text.parse::<proc_macro2::TokenStream>().is_ok() {
            assert_eq!(rust_tokens(&once), rust_tokens(&text), "{}", file.display());
        }
        if let Ok(formatted) = format(&Source::new("t.tool", text.clone())) {
            assert_eq!(formatted, once);
            assert_eq!(tree(&formatted), tree(&text), "{}", file.display());
        }
    }
}

#[test]
fn the_library_is_formatted() {
    for file in
        tool_files().iter().filter(|file| file.components().any(|c| c.as_os_str() == "tools"))
    {
        let source = Source::read(file).expect("a readable file");
        assert_eq!(format(&source).expect("a good tool"), source.text, "{}", file.display());
    }
}

/// The examples on the language page are formatted.
#[test]
fn the_examples_of_the_language_page_are_formatted() {
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/language.md");
    let page = std::fs::read_to_string(page).expect("the page on the language");
    let mut count = 0;
    for part in page.split("\n```tool").skip(1) {
        let example = part.split_once('\n').and_then(|(_, rest)| rest.split_once("```\n"));
        let (text, _) = example.expect("a fence closes");
        assert_eq!(sound(text), text);
        count += 1;
    }
    assert!(count > 10);
}

/// Formats a statement of a tool, and removes the indent.
fn statement(text: &str) -> String {
    let all = sound(&format!("tool T {{\n{text}\n}}"));
    let inside = all.strip_prefix("tool T {\n").and_then(|all| all.strip_suffix("}\n"));
    inside
        .expect("a tool")
        .lines()
        .map(|line| line.get(4..).unwrap_or(line).to_owned() + "\n")
        .collect()
}

#[test]
fn operators_are_spaced_by_precedence() {
    let one = |text: &str| statement(text).trim_end().to_owned();
    assert_eq!(one("let a=- b *( c+-d )/2 ^ - e-  - f;"), "let a = -b*(c + -d)/2^-e - -f;");
    assert_eq!(one("let a = min ( 1mm,-2 , hypot(-3,4) );"), "let a = min(1mm, -2, hypot(-3, 4));");
    assert_eq!(one("spindle   - z;"), "spindle -z;");
    assert_eq!(one("let a = 1e-5 - 2E+3mm-1;"), "let a = 1e-5 - 2E+3mm - 1;");
    assert_eq!(one("niceness a . b ,cutting:- 1;"), "niceness a.b, cutting: -1;");
    // Keywords of the language are names elsewhere.
    assert_eq!(
        one("curve c=where-radius*start-to -toward;"),
        "curve c = where - radius*start - to - toward;"
    );
    assert_eq!(
        one("region where as as where where-1<=- where{direction:toward(-1,from-2);}"),
        "region where as as where where - 1 <= -where { direction: toward (-1, from - 2); }"
    );
    assert_eq!(
        one("region a where -d<=(z)-1 {direction:away from(0,1);}"),
        "region a where -d <= (z) - 1 { direction: away from (0, 1); }"
    );
    assert_eq!(one("region a where(d)^2<=1 { }"), "region a where (d)^2 <= 1 {}");
}

#[test]
fn blank_lines_collapse() {
    let text = "\n\n// a\n\n\n// b\ntool T {\n\n\nunits mm;\n\n\n\nlet a = 1;\n\n}\n\n\n";
    assert_eq!(sound(text), "// a\n\n// b\ntool T {\n    units mm;\n\n    let a = 1;\n}\n");
    assert_eq!(sound("tool T {\n}"), "tool T {}\n");
}

#[test]
fn comments_keep_their_positions() {
    let text = "/* head */ tool T /* name */ { // behind the brace
        units mm; // behind /* no block
        /* before */ let a /* in */ = /* = */ 1; /* behind */
        let b = 2; /* before c */ let c = 3; /* and */ // two
        /* of
           lines */ let e = 4;
        let f = 6 / /* divided */ 2;
        // alone
    } // end
    // last";
    assert_eq!(
        sound(text),
        "/* head */ tool T /* name */ { // behind the brace
    units mm; // behind /* no block
    /* before */ let a /* in */ = /* = */ 1; /* behind */
    let b = 2;
    /* before c */ let c = 3; /* and */ // two
    /* of
           lines */
    let e = 4;
    let f = 6/ /* divided */ 2;
    // alone
} // end
// last
"
    );
}

#[test]
fn line_comments_break_a_statement() {
    let text = "profile { start (0, 0); line to (1, 0), // face
        (1, 20), // side
        // the end
        (0, 20) as all; // all of it
        } bsp { a, // one
        b }
        region r // why
        where a <= 0, // first
        b <= 0 { depth: // deep
        -a; }";
    assert_eq!(
        statement(text),
        "profile {
    start (0, 0);
    line to (1, 0), // face
        (1, 20), // side
        // the end
        (0, 20) as all; // all of it
}
bsp {
    a, // one
    b
}
region r // why
    where a <= 0, // first
        b <= 0
{
    depth: // deep
        -a;
}
"
    );
}

#[test]
fn one_property_may_stay_on_its_line() {
    assert_eq!(statement("region a { depth: 1; }"), "region a { depth: 1; }\n");
    assert_eq!(statement("region a {\ndepth: 1; }"), "region a {\n    depth: 1;\n}\n");
    let two = "region a { depth: 1; niceness: 1; }";
    assert_eq!(statement(two), "region a {\n    depth: 1;\n    niceness: 1;\n}\n");
    assert!(statement("region a { /* x */ depth: 1; }").lines().count() == 3);
    let long = format!("region a {{ depth: {}; }}", ["long_name"; 7].join(" + "));
    assert_eq!(statement(&long).lines().count(), 3);
}

#[test]
fn long_statements_are_broken() {
    for length in 1..40 {
        let names: Vec<String> = (0..length).map(|n| format!("name_{n}")).collect();
        let points: Vec<String> = (0..length).map(|n| format!("({n}, {n} + 1)")).collect();
        let conditions: Vec<String> = names.iter().map(|name| format!("0 <= {name}")).collect();
        for text in [
            format!("let a = {};", names.join("+")),
            format!("let a = {};", names.join("*")),
            format!("let a = max({});", names.join(",")),
            format!("let a = 1 + max({});", names.join("*")),
            format!("bsp {{ {} }}", names.join(",")),
            format!("magnitude {}: depth;", names.join(",")),
            format!("profile {{ line to {} as nut; }}", points.join(",")),
            format!("region a as b cutting where {} {{ depth: 1; }}", conditions.join(",")),
            format!("region a where {} <= 0 {{ depth: 1; }}", names.join("+")),
        ] {
            let formatted = statement(&text);
            assert!(formatted.lines().all(|line| line.len() + 4 <= 100), "{formatted}");
        }
    }
}

fn between() -> impl Strategy<Value = &'static str> {
    prop::sample::select(vec![
        "",
        "",
        " ",
        " ",
        "\n",
        "\n\n\n",
        "\t",
        " \r ",
        " /* in */",
        " /* a /* nested */\n  b */",
        "\n/* own */ ",
        " // ends\n",
        "\n// own\n",
        "\n\n/// doc\n\n",
        " /* \" */ ",
        " // ; { }\n",
    ])
}

/// Joins tokens with gaps before them. Words and numbers keep at least one space between them.
fn spaced(code: &[String], gaps: &[&str]) -> String {
    let glues = |text: &str| text.ends_with(|c: char| c.is_ascii_alphanumeric() || c == '"');
    let mut text = String::new();
    for (token, gap) in code.iter().zip(gaps.iter().cycle()) {
        let needs_space = gap.is_empty() && glues(&text) && glues(token);
        text += if needs_space { " " } else { gap };
        text += token;
    }
    text
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    /// With any gaps between the tokens, formatting keeps the content and is idempotent.
    #[test]
    fn any_spacing_is_sound(gaps in prop::collection::vec(between(), 600)) {
        let (code, _) = content(EVERY_CONSTRUCT);
        let spaced = spaced(&code, &gaps);
        let formatted = sound(&spaced);
        prop_assert_eq!(rust_tokens(&code.join(" ")), rust_tokens(&formatted.replace("///", "//")));
    }

    /// The existing tools keep their meaning, however they are spaced.
    #[test]
    fn any_spacing_keeps_the_meaning(
        file in prop::sample::select(tool_files()),
        gaps in prop::collection::vec(between(), 600),
    ) {
        let text = std::fs::read_to_string(&file).expect("a readable file");
        let (code, _) = content(&text);
        let spaced = spaced(&code, &gaps);
        if let Ok(formatted) = format(&Source::new("t.tool", spaced.clone())) {
            prop_assert_eq!(&formatted, &sound(&spaced));
            prop_assert_eq!(tree(&formatted), tree(&text), "{}", file.display());
        }
    }

    /// Spaces alone matter only where a region is on one line.
    #[test]
    fn line_breaks_do_not_affect_the_result(gaps in prop::collection::vec(prop::sample::select(vec!["\n", "  \n", "\n\t"]), 600)) {
        let (code, _) = content(EVERY_CONSTRUCT);
        let spaced = spaced(&code, &gaps);
        prop_assert_eq!(formatted(&spaced), formatted(&code.join("\n")));
    }

    /// The formatter accepts any text, valid or not, and loses nothing of it.
    #[test]
    fn arbitrary_text_does_not_panic(text in "([a-z{}();,:=+*^/. \n\"-]|/\\*|\\*/|//|bsp|where|region|[0-9]){0,60}") {
        let all = |text: &str| text.chars().filter(|c| !c.is_whitespace()).collect::<String>();
        prop_assert_eq!(all(&formatted(&text)), all(&text));
    }
}

#[test]
fn errors_of_syntax_are_reported() {
    let diagnostics = format(&Source::new("t.tool", "tool T { units mm let a = 1; }"));
    assert!(diagnostics.is_err_and(|diagnostics| diagnostics[0].code() == "T0117"));
    // The formatter does not report errors in the tool itself.
    assert!(format(&Source::new("t.tool", "tool T{let a=b;}")).is_ok());
}

#[test]
fn line_endings_are_kept() {
    let text = "tool T { // a \r\n\r\n\r\nunits mm; /* b\r\n c */\r\n}";
    let formatted = sound(&text.replace("\r\n", "\n")).replace('\n', "\r\n");
    assert_eq!(layout(text).expect("tokens"), formatted);
    assert_eq!(layout(&formatted).expect("tokens"), formatted);
}
