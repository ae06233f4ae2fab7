//! Every evaluator of every tool of the library: all of them against the reference interpreter to the last bit
//! ([`agreement`]), and against the independent oracles ([`accuracy`]), at the same points ([`points`]).
//!
//! `cargo test -p touchoff-tests --test engine evaluators -- --nocapture` prints a table.

mod accuracy;
mod agreement;
mod info;
mod partitions;
mod points;

use std::path::Path;
use tool_dsl::source::Source;
use tool_dsl::{CheckedTool, compile};
use touchoff::tool::Interpreted;
use touchoff_tests::oracle::{self, Nearest, restated};

/// Lengths of the file's unit in the part's that are tested: the same unit, and mm in inches.
const LENGTHS: [f64; 2] = [1.0, 1.0 / 25.4];

/// Returns the text of a tool of the library.
fn text(file: &str) -> Source {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../tools-library/tools").join(file);
    Source::read(path).expect("the library has the file")
}

/// Returns the tool of a text, checked for the reference interpreter.
fn checked(source: &Source) -> CheckedTool {
    let compiled = compile(source);
    assert_eq!(compiled.diagnostics(), [], "a tool of the library has nothing to report");
    *compiled.into_tool().expect("no report, so a tool")
}

/// Returns the tool of a text as it is loaded at run time.
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
            fn the_card_agrees() {
                let info = touchoff::Tool::info(&tools_library::$tool);
                match restated::of(stringify!($tool)) {
                    Some(tool) => info::of(&tools_library::$tool, &Nearest::new(&tool)),
                    None => assert!(info.outline.is_empty(), "its profile is not restated"),
                }
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
                tools_library::TOOLS.iter().map(|tool| tool.info().name.to_string()).collect();
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
    half_sphere_cylinder: HalfSphereCylinder in "half_sphere_cylinder.tool", oracle::half_sphere_cylinder();
    fig_7_3: Fig73 in "fig_7_3.tool", oracle::Fig73::default();
    block: Block in "block.tool", oracle::Block;
    l_bracket: LBracket in "l_bracket.tool", oracle::LBracket;
    fig_7_3_exact: Fig73Exact in "fig_7_3_exact.tool", oracle::fig_7_3_exact();
    d2_ball: D2Ball in "d2_ball.tool", oracle::d2_ball();
    ball: Ball in "ball.tool", Nearest::of("Ball");
    ball_er16: BallEr16 in "ball_er16.tool", Nearest::of("BallEr16");
    barrel: Barrel in "barrel.tool", Nearest::of("Barrel");
    boring_bar: BoringBar in "boring_bar.tool", Nearest::of("BoringBar");
    bull_nose: BullNose in "bull_nose.tool", Nearest::of("BullNose");
    bull_nose_hsk63: BullNoseHsk63 in "bull_nose_hsk63.tool", Nearest::of("BullNoseHsk63");
    chamfer_mill: ChamferMill in "chamfer_mill.tool", Nearest::of("ChamferMill");
    corner_rounding: CornerRounding in "corner_rounding.tool", Nearest::of("CornerRounding");
    countersink: Countersink in "countersink.tool", Nearest::of("Countersink");
    deburrer: Deburrer in "deburrer.tool", Nearest::of("Deburrer");
    dovetail: Dovetail in "dovetail.tool", Nearest::of("Dovetail");
    drill: Drill in "drill.tool", Nearest::of("Drill");
    drill_bt40: DrillBt40 in "drill_bt40.tool", Nearest::of("DrillBt40");
    engraver: Engraver in "engraver.tool", Nearest::of("Engraver");
    face_mill: FaceMill in "face_mill.tool", Nearest::of("FaceMill");
    flat: Flat in "flat.tool", Nearest::of("Flat");
    half_inch_ball_cat40: HalfInchBallCat40 in "half_inch_ball_cat40.tool", Nearest::of("HalfInchBallCat40");
    lens: Lens in "lens.tool", Nearest::of("Lens");
    lollipop: Lollipop in "lollipop.tool", Nearest::of("Lollipop");
    oval: Oval in "oval.tool", Nearest::of("Oval");
    quarter_inch_flat: QuarterInchFlat in "quarter_inch_flat.tool", Nearest::of("QuarterInchFlat");
    reamer: Reamer in "reamer.tool", Nearest::of("Reamer");
    single_tooth: SingleTooth in "single_tooth.tool", Nearest::of("SingleTooth");
    spot_drill: SpotDrill in "spot_drill.tool", Nearest::of("SpotDrill");
    t_slot: TSlot in "t_slot.tool", Nearest::of("TSlot");
    tapered_ball: TaperedBall in "tapered_ball.tool", Nearest::of("TaperedBall");
    thread_mill: ThreadMill in "thread_mill.tool", Nearest::of("ThreadMill");
    woodruff: Woodruff in "woodruff.tool", Nearest::of("Woodruff");
}
