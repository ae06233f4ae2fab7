//! Cost of a tool: splits of its plan, operations of its code, and compile time.

use std::f64::consts::FRAC_PI_2;
use std::time::Instant;
use syn::visit::{self, Visit};
use touchoff_dsl::expr::value::{EvaluationPoint, Evaluator};
use touchoff_dsl::plan::Tree;
use touchoff_dsl::source::Source;
use touchoff_dsl::{CheckedTool, compile, emit};
use touchoff_tests::library::{folder, library};
use touchoff_tests::oracle::rng::Rng;

/// Number of points at which splits are counted.
const SPLIT_SAMPLES: usize = 100_000;
/// Distance from the surface of the points in the shell, as a fraction of the tool's largest radius.
const SHELL: f64 = 0.02;

/// Cutter, nut, holder and spindle: 30 segments.
const ASSEMBLY: &str = r#"tool Assembly30 "12 mm bull nose end mill, ER32, HSK-A63, spindle nose" {
    units mm;
    mount "bull_nose.tool" as cutter;
    mount "holders/er32.tool" as nut at z = 45;
    mount "holders/hsk63.tool" as holder at z = 67.5;
    mount "holders/spindle_a63.tool" as spindle at z = 131.5;
}"#;

/// Returns a ball on a shank that is drawn as 200 chords, with ends of so many decimals; 17 are those of doubles.
fn chords(name: &str, decimals: usize) -> Source {
    let end = |k: u32| {
        let (sine, cosine) = (FRAC_PI_2 * f64::from(k) / 200.0).sin_cos();
        format!("({:.decimals$}, {:.decimals$})", 5.0 * sine, 5.0 - 5.0 * cosine)
    };
    let ends: Vec<String> = (1..=200).map(end).collect();
    let ball = format!("start (0, 0); line to {} as ball cutting;", ends.join(", "));
    let text = format!(
        "tool {name} {{ units mm; profile {{ {ball} line to (5, 60), (0, 60) as shank; }} }}"
    );
    Source::new(name, text)
}

/// Returns the sources of all library tools, of the assembly of 30 segments, and of balls drawn as chords.
///
/// # Panics
/// If the library's folder cannot be read.
pub fn sources() -> Vec<Source> {
    let mut sources = library();
    sources.push(Source::new("Assembly30", ASSEMBLY).with_path(folder().join("assembly.tool")));
    sources.extend([chords("Chords200", 17), chords("Chords200Rounded", 9)]);
    sources
}

/// Times from source text to tokens, s, over several runs.
#[derive(Clone, Copy, Debug, Default)]
pub struct CompileTimes {
    /// The shortest, which other load on the machine disturbs least.
    pub best: f64,
    /// The median.
    pub median: f64,
    /// The longest.
    pub worst: f64,
}

/// Times the compilation of a tool from source text to tokens, `count` times but at least once.
///
/// # Panics
/// If the tool has an error.
pub fn compile_times(source: &Source, count: usize) -> CompileTimes {
    let mut seconds: Vec<f64> = (0..count.max(1))
        .map(|_| {
            let start = Instant::now();
            let compiled = compile(source);
            let tokens = emit::emit(&compiled.into_tool().expect("a tool of the library"));
            let time = start.elapsed().as_secs_f64();
            assert!(!tokens.is_empty());
            time
        })
        .collect();
    seconds.sort_by(f64::total_cmp);
    CompileTimes {
        best: seconds[0],
        median: seconds[seconds.len() / 2],
        worst: seconds[seconds.len() - 1],
    }
}

/// Size statistics of a compiled tool.
#[derive(Clone, Debug)]
pub struct ToolStats {
    /// The tool's name.
    pub name: String,
    /// Number of regions.
    pub regions: usize,
    /// Number of profile segments, if the tool has a profile.
    pub segments: Option<usize>,
    /// Number of curves that bound regions, inside or outside.
    pub curves: usize,
    /// Number of tests in the tree of owners.
    pub tests: usize,
    /// Mean number of tests per point: within 2 % of the largest radius from the surface, and in the tool's box.
    pub splits: [f64; 2],
    /// Number of operations in the code for lanes.
    pub operations: usize,
}

/// Compiles a tool and collects its statistics.
///
/// # Panics
/// If the tool has an error.
pub fn tool_stats(source: &Source) -> ToolStats {
    let tool = compile(source).into_tool().expect("a tool of the library");
    let regions = &tool.model.regions;
    let segments = regions.iter().filter(|region| !region.name.contains('/')).count();
    ToolStats {
        name: tool.model.name.clone(),
        regions: regions.len(),
        segments: tool.model.is_exact().then_some(segments),
        curves: tool.model.curves.len(),
        tests: tool.tree.test_count(),
        splits: splits(&tool),
        operations: operations(&emit::source_code(&tool)),
    }
}

fn splits(tool: &CheckedTool) -> [f64; 2] {
    let mut tree = TreeWalk::new(tool);
    let mut rng = Rng::new(4);
    let (radius, low, high) = (tool.extent.radius, tool.extent.low, tool.extent.high);
    let shell = SHELL * radius;
    // A point is near the surface if a step of the shell's thickness along d or z changes inside to outside or back.
    let steps = [[shell, 0.0], [-shell, 0.0], [0.0, shell], [0.0, -shell]];
    let mut means = [(0, 0); 2];
    for _ in 0..SPLIT_SAMPLES {
        let [d, z] = [rng.between(0.0, 1.1 * radius), rng.between(low, high)];
        let (inside, tests) = tree.walk([d, z]);
        let near = steps.iter().any(|s| tree.walk([(d + s[0]).abs(), z + s[1]]).0 != inside);
        for (_, (count, sum)) in [near, true].iter().zip(&mut means).filter(|(counts, _)| **counts)
        {
            *count += 1;
            *sum += tests;
        }
    }
    means.map(|(count, sum): (usize, usize)| sum as f64 / count.max(1) as f64)
}

/// The tree of owners, traversed as the nested code does.
struct TreeWalk<'t> {
    tool: &'t CheckedTool,
    curves: Evaluator<'t>,
}

impl<'t> TreeWalk<'t> {
    fn new(tool: &'t CheckedTool) -> TreeWalk<'t> {
        let curves = tool.model.curves.iter().map(|curve| curve.value);
        TreeWalk { tool, curves: Evaluator::new(&tool.model.graph, curves) }
    }

    /// Returns whether a point is inside, and the number of tests on its path.
    fn walk(&mut self, [d, z]: [f64; 2]) -> (bool, usize) {
        self.curves.evaluate(EvaluationPoint::on_meridian(d, z));
        let (mut tree, mut tests) = (&self.tool.tree, 0);
        loop {
            match tree {
                Tree::Leaf(owner) => return (owner.is_some(), tests),
                Tree::Split { curve, strict, below, above } => {
                    tests += 1;
                    let value = self.curves.get(self.tool.model.curves[*curve].value);
                    let holds = if *strict { value < 0.0 } else { value <= 0.0 };
                    tree = if holds { below } else { above };
                }
            }
        }
    }
}

/// Counts arithmetic, comparisons and selects in an expression tree.
#[derive(Default)]
struct Count(usize);

impl<'ast> Visit<'ast> for Count {
    fn visit_expr(&mut self, expr: &'ast syn::Expr) {
        let is_operation = match expr {
            syn::Expr::Binary(_) => true,
            // The sign of a literal is not an operation.
            syn::Expr::Unary(unary) => !matches!(*unary.expr, syn::Expr::Lit(_)),
            syn::Expr::MethodCall(call) => call.method != "of",
            syn::Expr::Call(call) => {
                !matches!(&*call.func, syn::Expr::Path(path) if path.path.segments.last().is_some_and(|last| last.ident == "of"))
            }
            _ => false,
        };
        self.0 += usize::from(is_operation);
        visit::visit_expr(self, expr);
    }
}

/// Counts the operations of the code for lanes.
///
/// # Panics
/// If the generated code has none.
fn operations(code: &str) -> usize {
    struct Lanes(Option<usize>);
    impl<'ast> Visit<'ast> for Lanes {
        fn visit_impl_item_fn(&mut self, function: &'ast syn::ImplItemFn) {
            if function.sig.ident == "evaluate_lanes" {
                let mut count = Count::default();
                count.visit_block(&function.block);
                self.0 = Some(count.0);
            }
        }
    }
    let mut lanes = Lanes(None);
    lanes.visit_file(&syn::parse_file(code).expect("generated code"));
    lanes.0.expect("the code for lanes")
}
