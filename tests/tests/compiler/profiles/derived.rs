//! Regions that the compiler derives from a profile: how many curves they need, and what a law makes of their depth.

use super::tool;
use std::collections::BTreeSet;
use touchoff_dsl::interpret::Interpreter;
use touchoff_dsl::plan::Tree;
use touchoff_tests::texts::compiled;

pub(crate) const FIG_7_3: &str = "tool Fig73 { units mm; tip z = 20; spindle -z;
    profile {
        start (0, 0);
        line to (5, 0), (5, 11), (3, 11) as housing;
        line to (3, 13), (1, 15)         as spindle;
        line to (1, 19)                  as flute cutting;
        arc  to (0, 20) center (0, 19)   as nose  cutting;
    } }";

const D2_BALL: &str = "tool D2 { units mm;
    profile {
        start (0, 0);
        arc  to (1, 1) radius 1 as ball  cutting;
        line to (1, 5)          as flute cutting;
        line to (1, 40), (0, 40) as shank;
    }
    niceness cutting: 1 - depth/1; }";

/// Nine curves divide fig. 7.3, as in fig73-exact; five bound where no divider's line does. That the regions are right is
/// tested for the tool of the library, which has this profile.
#[test]
fn the_thesis_tool_needs_few_curves() {
    let tool = tool(FIG_7_3).expect("a good profile");
    let mut curves = BTreeSet::new();
    tested(&tool.tree, &mut curves);
    assert!(curves.len() <= 9 + 5, "{}", curves.len());
}

fn tested(tree: &Tree, curves: &mut BTreeSet<usize>) {
    if let Tree::Split { curve, below, above, .. } = tree {
        curves.insert(*curve);
        tested(below, curves);
        tested(above, curves);
    }
}

/// A magnitude that is the depth is a length and changes with the part's unit; a law of another form is the file's
/// own number.
#[test]
fn a_law_that_is_the_depth_is_a_length() {
    let evaluation = |law: &str| {
        let text = D2_BALL.replace("niceness cutting", &format!("{law} niceness cutting"));
        // A note gives the slope of another law.
        let tool = compiled(&text).into_tool();
        Interpreter::new(&tool.expect("a good profile"))
            .evaluate([0.5, 0.0, 3.0], 0.25)
            .expect("inside")
    };
    assert_eq!(evaluation("").magnitude, 0.125);
    assert_eq!(evaluation("magnitude: depth;").magnitude, 0.125);
    assert_eq!(evaluation("magnitude: 2*depth;").magnitude, 1.0);
}
