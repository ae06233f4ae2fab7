//! Random profiles of every kind, shrunk where they fail.

use super::compare::{Flaw, compare};
use super::draw::{Recipe, recipe};
use super::outline::Outline;
use super::tool;
use super::valid::is_valid;
use crate::generated::digests;
use proptest::strategy::{Strategy, ValueTree};
use proptest::test_runner::{Config, RngAlgorithm, TestRng, TestRunner};
use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use touchoff::tool::Interpreted;
use touchoff_dsl::emit;
use touchoff_dsl::prove::Certificate;
use touchoff_dsl::source::Source;
use touchoff_tests::oracle::rng::Rng;
use touchoff_tests::oracle::segment::Segment;
use touchoff_tests::oracle::vector::{cross, dot, norm, sub};
use touchoff_tests::texts::compiled;

const POINTS: usize = 320;
const SHRINKS: usize = 250;
/// Number of failures of one kind that are shrunk and shown.
const SHOWN: usize = 4;
/// Number of profiles, of those that every run has, whose proofs are compared with those before.
const DIGESTS: usize = 20;

fn tried(outline: &Outline) -> Result<(), Flaw> {
    let text = outline.text();
    let run = || {
        let tool = tool(&text).map_err(|message| (refusal(&text), message))?;
        let planned = Interpreted::parse(&Source::new("t.tool", &text)).expect("as before");
        compare(outline, (&tool, &planned), POINTS, &mut Rng::new(1))
    };
    catch_unwind(AssertUnwindSafe(run)).unwrap_or_else(|_| Err(("panic", String::new())))
}

/// Returns whether depth is proved to be the distance to a profile's surface, and how: the boxes that the proof examines, and
/// digests of the tool's code and of all that is proved.
fn proof(outline: &Outline) -> (bool, String) {
    let Ok(tool) = tool(&outline.text()) else { return (false, "refused".into()) };
    let proved = Certificate::prove(&tool);
    let [code, facts] = digests(&emit::source_code(&tool), &proved);
    (proved.is_exact(), format!("{} boxes, {code:016x}, {facts:016x}", proved.examined_boxes))
}

/// Returns the kind of a refusal, by the codes of its diagnostics.
fn refusal(text: &str) -> &'static str {
    let compiled = compiled(text);
    let has = |code: &str| compiled.diagnostics().iter().any(|report| report.code() == code);
    if has("T0607") {
        "refused: features too close together"
    } else if has("T0319") {
        "refused: not divided"
    } else {
        "refused: not understood"
    }
}

/// Returns the smallest profile found that fails in the same way.
fn shrunk(mut tree: impl ValueTree<Value = Recipe>, flaw: Flaw) -> (Outline, Flaw) {
    let mut best = (tree.current().outline(), flaw);
    let mut more = tree.simplify();
    for _ in 0..SHRINKS {
        if !more {
            break;
        }
        let outline = tree.current().outline();
        let same = if is_valid(&outline) { tried(&outline).err() } else { None };
        more = match same.filter(|flaw| flaw.0 == best.1.0) {
            Some(flaw) => {
                best = (outline, flaw);
                tree.simplify()
            }
            None => tree.complicate(),
        };
    }
    best
}

/// Returns the kinds of pieces and joints that occur in a profile.
fn kinds(outline: &Outline) -> Vec<&'static str> {
    let mut all = Vec::new();
    for (k, piece) in outline.segments().iter().enumerate() {
        let [d, z] = [0, 1].map(|k| piece.to[k] - piece.from[k]);
        all.push(match piece.circle {
            None if z == 0.0 && d < 0.0 => "radial step inward",
            None if z == 0.0 => "radial step outward",
            None if d == 0.0 => "line along the axis",
            None if z < 0.0 => "undercut",
            None => "cone",
            Some(r) if r.convex && r.by_radius => "convex arc by radius",
            Some(r) if r.convex => "convex arc by centre",
            Some(r) if r.by_radius => "concave arc by radius",
            Some(_) => "concave arc by centre",
        });
        if piece.sweep().abs() > std::f64::consts::PI - 1e-6 {
            all.push("half of a circle");
        }
        if piece.circle.is_some_and(|round| round.centre[0] == 0.0) {
            all.push("arc about the axis");
        }
        if k > 0 {
            let [a, b] = outline.profile.tangents(k);
            let round = [k - 1, k].map(|k| outline.segments()[k].circle.is_some());
            let tangent = cross(a, b).abs() < 1e-9 && dot(a, b) > 0.0;
            match (tangent, round) {
                (true, [true, true]) => all.push("arc tangent to arc"),
                (true, [true, false] | [false, true]) => all.push("arc tangent to line"),
                (false, _) if cross(a, b) < 0.0 => all.push("reflex corner"),
                _ => {}
            }
        }
        let thin = |next: &Segment<f64>| dot(&sub(&next.to, &next.from), &[d, z]);
        if let Some(after) = outline.segments().get(k + 2)
            && thin(after) < 0.0
            && outline.segments()[k + 1].circle.is_none()
            && norm(&sub(&after.from, &piece.to)) < 0.02 * outline.size()
        {
            all.push("thin piece or groove");
        }
    }
    if outline.down {
        all.push("spindle -z");
    }
    all
}

/// Profiles with a taper: a number with a sign is larger or smaller by it.
const TAPERED: [&str; 8] = [
    "0 0, 10 0, 10+ 30, 0 30",
    "0 0, 10 0, 10- 30, 0 30",
    "0 0, 5 5 about 0 5, 5+ 35, 0 35",
    "0 0, 8 0, 10 2 about 8 2, 10+ 32, 0 32",
    "0 0, 10 0, 10+ 30, 10+ 60, 0 60",
    "0 0, 10 0, 10 30, 10+ 60, 0 60",
    "0 0, 10 0, 10- 20, 10 40, 0 40",
    "0 0, 10 0, 10 10, 8 10, 8+ 40, 12 40, 12 60, 0 60",
];

/// Neighbours that hardly turn are equally near for long, and no matter which of them owns a point, its depth is the distance.
#[test]
fn tapers_of_any_angle_are_divided() {
    for drawing in TAPERED {
        for taper in [1e-6, 1e-5, 1e-4, 3e-4, 1e-3, 3e-3, 1e-2] {
            let number = |word: &str| match word.split_at(word.len() - 1) {
                (number, "+") => (number.parse::<f64>().expect("a number") + taper).to_string(),
                (number, "-") => (number.parse::<f64>().expect("a number") - taper).to_string(),
                _ => word.to_owned(),
            };
            let words: Vec<String> = drawing.replace(',', " ,").split(' ').map(number).collect();
            let outline = Outline::parse(&words.join(" ").replace(" ,", ","));
            // A corner that turns by some 1e-4 to 1e-3 may spend the boxes of the proof.
            assert!(taper > 3e-3 || proof(&outline).0, "{drawing} by {taper} is not proved");
            assert_eq!(tried(&outline), Ok(()), "{drawing} by {taper}");
        }
    }
}

#[test]
fn random_profiles_of_every_kind() {
    let count = super::profiles();
    let rng = TestRng::from_seed(RngAlgorithm::ChaCha, &[7; 32]);
    let mut runner = TestRunner::new_with_rng(Config::default(), rng);
    let strategy = recipe();
    let (mut valid, mut drawn, mut proved) = (0, 0, 0);
    let mut proofs = Vec::new();
    let mut seen: BTreeMap<&str, usize> = BTreeMap::new();
    let mut flaws: BTreeMap<&str, usize> = BTreeMap::new();
    while valid < count {
        drawn += 1;
        let tree = strategy.new_tree(&mut runner).expect("recipes are not filtered");
        let outline = tree.current().outline();
        if !is_valid(&outline) {
            continue;
        }
        valid += 1;
        let (is_proved, how) = proof(&outline);
        proved += usize::from(is_proved);
        proofs.push(how);
        kinds(&outline).into_iter().for_each(|kind| *seen.entry(kind).or_default() += 1);
        if let Err(flaw) = tried(&outline) {
            let times = flaws.entry(flaw.0).or_default();
            *times += 1;
            if *times <= SHOWN {
                let (least, (kind, message)) = shrunk(tree, flaw);
                println!("{kind}: {message}\n{}\n", least.text());
            }
        }
    }
    println!("{valid} valid profiles of {drawn} drawn, {proved} proved: {seen:?}, {flaws:?}");
    // Shows which profiles a change of the compiler affects, and what it costs to prove them.
    proofs.truncate(DIGESTS);
    insta::with_settings!({ omit_expression => true }, {
        insta::assert_snapshot!("random_profiles", proofs.join("\n"));
    });
    let is_refused = |kind: &str| kind.starts_with("refused");
    let refused: usize = flaws.iter().filter(|flaw| is_refused(flaw.0)).map(|flaw| flaw.1).sum();
    flaws.retain(|kind, _| !is_refused(kind));
    assert!(refused * 200 <= count, "{refused} of {count} valid profiles are refused");
    assert!(flaws.is_empty(), "{flaws:?}");
    assert!(proved * 10 >= valid * 9, "{proved} of {valid} profiles are proved");
    if count >= 60 {
        assert!(seen.len() >= 16, "{seen:?}");
    }
}
