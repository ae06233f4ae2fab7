//! Code that the compiler writes for the tools of the library: its text as snapshots, and checks that it is
//! straight-line code which cannot panic, cannot loop and is the same every time.
//!
//! After a change of the emitter, run `INSTA_UPDATE=always cargo test -p touchoff-tests --test compiler generated`
//! and read the difference.

use std::path::PathBuf;
use syn::visit::{self, Visit};
use touchoff_dsl::prove::Certificate;
use touchoff_dsl::{compile, emit};
use touchoff_tests::library::{self, checked, library};

/// Methods that generated code may call: none panics, none is a libm function.
const METHODS: [&str; 10] = [
    "sqrt",
    "abs",
    "of",
    "or",
    "assign",
    "set_depth",
    "set_magnitude",
    "set_niceness",
    "set_direction",
    "set_gradient",
];
const FUNCTIONS: [&str; 20] = [
    "touchoff::tool::EvaluationEnclosure::of",
    "touchoff::Interval::new",
    "Some",
    "L::le",
    "L::lt",
    "L::select",
    "L::min",
    "L::max",
    "L::component",
    "L::quotient",
    "L::any",
    "touchoff::tool::LaneEvaluation::none",
    "Cow::Borrowed",
    "ProfileSegment::line",
    "ProfileSegment::arc",
    "Circle::convex",
    "Circle::concave",
    "Region::new",
    "EnvelopeSlab::new",
    "Surface::new",
];

fn generated(name: &str) -> String {
    emit::source_code(&checked(name))
}

/// Returns the names of the library's files without their endings, sorted.
fn names() -> Vec<String> {
    let stem = |path: PathBuf| path.file_stem().and_then(|stem| Some(stem.to_str()?.to_owned()));
    library::files().into_iter().filter_map(stem).collect()
}

/// The page that follows a tool from its text to its code quotes both as they are, and a group of regions of another tool.
#[test]
fn the_page_quotes_a_tool_and_its_code() {
    let page = include_str!("../../../tool-dsl/README.md");
    let text = include_str!("../../../tools-library/tools/d2_ball.tool");
    let tool = page.split("```tool\n").nth(1).and_then(|block| block.split("```").next());
    assert_eq!(tool, Some(text));
    let trimmed = |text: &str| text.lines().map(str::trim).collect::<Vec<_>>().join("\n");
    let code = trimmed(&[generated("d2_ball"), generated("thread_mill")].concat());
    let quotes: Vec<&str> = page.split("```rust,ignore\n").skip(1).collect();
    assert!(quotes.len() > 1);
    for quote in quotes.iter().filter_map(|block| block.split("```").next()) {
        assert!(code.contains(&trimmed(quote)), "{quote}");
    }
    assert!(page.contains(&format!("{} lines", generated("d2_ball").lines().count())));
}

/// Collects constructs that generated code must not have.
#[derive(Default)]
struct Refused(Vec<String>);

impl Refused {
    fn refuse(&mut self, what: &str, detail: impl Into<String>) {
        self.0.push(format!("{what} {}", detail.into()));
    }
}

impl<'ast> Visit<'ast> for Refused {
    fn visit_expr(&mut self, expr: &'ast syn::Expr) {
        use syn::Expr;
        match expr {
            Expr::ForLoop(_) | Expr::Loop(_) | Expr::While(_) => self.refuse("a loop", ""),
            Expr::Index(_) => self.refuse("an index", ""),
            Expr::Closure(_) => self.refuse("a closure", ""),
            Expr::Unsafe(_) => self.refuse("unsafe code", ""),
            Expr::Cast(_) => self.refuse("a cast", ""),
            Expr::Try(_) | Expr::Return(_) | Expr::Break(_) => self.refuse("a jump", ""),
            Expr::MethodCall(call) if !METHODS.contains(&call.method.to_string().as_str()) => {
                self.refuse("the method", call.method.to_string());
            }
            Expr::Call(call) => {
                let name = match &*call.func {
                    Expr::Path(path) => {
                        let words: Vec<String> =
                            path.path.segments.iter().map(|part| part.ident.to_string()).collect();
                        words.join("::")
                    }
                    _ => "no name".to_owned(),
                };
                if !FUNCTIONS.contains(&name.as_str()) {
                    self.refuse("a call of", name);
                }
            }
            _ => {}
        }
        visit::visit_expr(self, expr);
    }

    fn visit_macro(&mut self, invoked: &'ast syn::Macro) {
        let name = invoked.path.segments.last().map(|part| part.ident.to_string());
        self.refuse("the macro", name.unwrap_or_default());
    }
}

#[test]
fn every_tool_of_the_library_is_straight_line_code() {
    let names = names();
    assert_eq!(names.len(), touchoff_tools::TOOLS.len());
    for name in names {
        let tree = syn::parse_file(&generated(&name)).expect("generated code is Rust");
        let mut refused = Refused::default();
        refused.visit_file(&tree);
        assert_eq!(refused.0, Vec::<String>::new(), "{name}");
    }
}

#[test]
fn every_tool_of_the_library_has_a_feature() {
    let manifest = library::folder().join("../Cargo.toml");
    let manifest = std::fs::read_to_string(manifest).expect("the library's manifest");
    let features = manifest.lines().filter_map(|line| line.strip_suffix(" = []"));
    let features: Vec<&str> = features.filter(|feature| *feature != "all").collect();
    assert_eq!(features, names());
}

/// One line per tool with digests of its code and of all that is proved of it: shows which tools a change of the compiler affects.
/// A bound that is weaker than it was may change no more than the number of boxes that the proof examines.
#[test]
fn digests_of_code_and_proofs() {
    let lines = library().into_iter().map(|source| {
        let tool = compile(&source).into_tool().expect("a tool of the library has no error");
        let code = emit::source_code(&tool);
        let proved = Certificate::prove(&tool);
        let [digest, facts] = digests(&code, &proved);
        let (name, lines, boxes) = (&tool.model.name, code.lines().count(), proved.examined_boxes);
        format!("{name} {lines} lines {digest:016x}, {boxes} boxes {facts:016x}\n")
    });
    let all: String = lines.collect();
    insta::with_settings!({ omit_expression => true }, {
        insta::assert_snapshot!("digests", all);
    });
}

/// Returns digests of a tool's code, and of all that is proved of the tool.
pub(crate) fn digests(code: &str, proved: &Certificate) -> [u64; 2] {
    [code, &format!("{proved:?}")].map(|text| fnv(text.as_bytes()))
}

/// Computes Fowler, Noll and Vo's hash, 1a: the same on every machine.
fn fnv(bytes: &[u8]) -> u64 {
    let next = |hash: u64, byte: &u8| (hash ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3);
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, next)
}

/// A tool may have a name that its own code imports, since only functions import; `compile_pass` compiles one.
#[test]
fn only_functions_import() {
    let tree = syn::parse_file(&generated("ball")).expect("generated code is Rust");
    assert!(tree.items.iter().all(|item| !matches!(item, syn::Item::Use(_))));
}

/// As many as can be read: the thesis's solids, a cone, a torus in inches, an assembly, a block.
#[test]
fn code_is_as_kept() {
    for name in [
        "ball_er16",
        "block",
        "cylinder",
        "d2_ball",
        "fig_7_3",
        "fig_7_3_exact",
        "half_sphere_cylinder",
        "quarter_inch_flat",
        "tapered_ball",
        "unit_sphere",
    ] {
        let code = generated(name);
        // A hash map's order, which differs every time, must not show.
        assert_eq!(code, generated(name));
        insta::with_settings!({ omit_expression => true }, {
            insta::assert_snapshot!(name, code);
        });
    }
}

/// The check above detects each kind of construct.
#[test]
fn rejects_code_that_is_not_straight_line() {
    let bad = "fn f(x: [f64; 2]) -> f64 {
        for _ in 0..2 {}
        let g = |a: f64| a.sin();
        unreachable!();
        g(x[0]) + x[1].abs()
    }";
    let mut refused = Refused::default();
    refused.visit_file(&syn::parse_file(bad).expect("this is Rust"));
    let expected = [
        "a loop ",
        "a closure ",
        "the method sin",
        "the macro unreachable",
        "a call of g",
        "an index ",
        "an index ",
    ];
    assert_eq!(refused.0, expected);
}
