//! Every evaluator of every tool of the library: all of them against the reference interpreter to
//! the last bit ([`agreement`]), and against the independent oracles ([`accuracy`]), on the same
//! points ([`points`]).
//!
//! `cargo test -p touchoff-tests --test evaluators -- --nocapture` prints a table.

mod accuracy;
mod agreement;
mod partitions;
mod points;

use std::path::Path;
use tool_dsl::source::Source;
use tool_dsl::{Checked, compile};
use touchoff::tool::Interpreted;
use touchoff_tests::oracle;

/// Lengths of the file's unit in the part's that are tried: the same unit, and mm in inches.
const LENGTHS: [f64; 2] = [1.0, 1.0 / 25.4];

/// The text of a tool of the library.
fn text(file: &str) -> Source {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../tools-library/tools").join(file);
    let text = std::fs::read_to_string(&path).expect("the library has the file");
    Source::new(file, text)
}

/// The tool of a text, checked for the reference interpreter.
fn checked(source: &Source) -> Checked {
    let compiled = compile(source);
    assert_eq!(compiled.reports, [], "a tool of the library has nothing to report");
    *compiled.tool.expect("no report, so a tool")
}

/// The tool of a text as it is loaded at run time.
fn interpreted(source: &Source) -> Interpreted {
    Interpreted::parse(source).expect("a tool of the library has no error")
}

macro_rules! suites {
    ($($test:ident: $tool:ident in $file:literal, $oracle:expr;)*) => {
        $(mod $test {
            use super::*;

            #[test]
            fn all_evaluators_agree() {
                let oracle = $oracle;
                let source = text($file);
                let (checked, tape) = (checked(&source), interpreted(&source));
                let points = points::all(&oracle, 1);
                agreement::of(tools_library::$tool, &oracle, &checked, &tape, &points);
            }

            #[test]
            fn the_oracle_agrees() {
                let oracle = $oracle;
                accuracy::of::<tools_library::$tool>(&oracle, &points::all(&oracle, 2));
            }
        })*

        #[test]
        fn no_tool_of_the_library_is_left_out() {
            let mut tested = [$(stringify!($tool)),*].map(String::from).to_vec();
            let mut there: Vec<String> =
                tools_library::TOOLS.iter().map(|tool| tool.card().name.to_string()).collect();
            tested.sort();
            there.sort();
            assert_eq!(tested, there);
            let mut oracles: Vec<String> =
                oracle::all().iter().map(|oracle| oracle.name().to_owned()).collect();
            oracles.sort();
            assert_eq!(tested, oracles);
        }
    };
}

suites! {
    unit_sphere: UnitSphere in "unit_sphere.tool", oracle::UnitSphere;
    cylinder: Cylinder in "cylinder.tool", oracle::Cylinder;
    half_sphere_cylinder: HalfSphereCylinder in "half_sphere_cylinder.tool", oracle::HalfSphereCylinder::default();
    fig_7_3: Fig73 in "fig_7_3.tool", oracle::Fig73::default();
    fig_7_3_exact: Fig73Exact in "fig_7_3_exact.tool", oracle::Fig73Exact::default();
    block: Block in "block.tool", oracle::Block;
    l_bracket: LBracket in "l_bracket.tool", oracle::LBracket;
    d2_ball: D2Ball in "d2_ball.tool", oracle::D2Ball::default();
}
