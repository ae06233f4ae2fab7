//! The worst that was ever found of each tool, asked again: `tests/found.tsv`, written by
//! `cargo run --release -p touchoff-bench -- search --found bench/tests/found.tsv`, which keeps what is worse; and a small search in every build.

use touchoff_bench::search::asked::Asked;
use touchoff_bench::search::found::{Line, lines};
use touchoff_bench::search::page::missed;
use touchoff_bench::search::tool::{hunt, names, scale};
use touchoff_bench::search::{Effort, Question};
use touchoff_tests::accuracy::Judge;
use touchoff_tests::library::read;
use touchoff_tests::oracle::reference::Reference;
use touchoff_tests::oracle::{Nearest, restated};

const FOUND: &str = include_str!("found.tsv");

fn found() -> Vec<Line> {
    let read = |line: &str| Line::read(line).unwrap_or_else(|| panic!("no line: {line}"));
    FOUND.lines().map(read).collect()
}

#[test]
fn the_worst_places_keep_the_contract() {
    let found = found();
    let mut broken = Vec::new();
    for name in names() {
        let own: Vec<&Line> = found.iter().filter(|line| line.tool == name).collect();
        assert!(!own.is_empty(), "{name} was never searched");
        let tool = tools_library::find(&name).expect("a tool of the library");
        let (interpreted, _) = read(&name);
        let mut asked = Asked::new(tool, &interpreted);
        let restated = restated::of(&name);
        let known = restated.as_ref().map(|tool| (Nearest::new(tool), Reference::new(tool)));
        let judge = known.as_ref().map(|(oracle, reference)| Judge::new(tool, reference, oracle));
        let ulp = scale(tool) * f64::EPSILON;
        for line in own {
            let error = line.again(&mut asked, judge.as_ref(), ulp);
            // Written so that what is no number is no pass.
            if !matches!(error.partial_cmp(&line.bar), Some(order) if order.is_le()) {
                broken.push(format!("{error:?}: {}", line.text()));
            }
        }
        asked.compare();
        broken
            .extend(asked.unlike.iter().map(|find| format!("{name}: forms differ at {}", find.at)));
    }
    assert!(broken.is_empty(), "{broken:#?}");
}

/// That the lines are places of hard points and not of any: what was found there is still there, unless code got better.
#[test]
fn the_list_is_of_hard_places() {
    let found = found();
    let largest = |question: Question| {
        let errors = found.iter().filter(|line| line.question == question).map(|line| line.error);
        errors.fold(0.0, f64::max)
    };
    assert!(largest(Question::Depth) > 0.5, "{}", largest(Question::Depth));
    assert!(largest(Question::Length) > 1.0, "{}", largest(Question::Length));
    assert!(largest(Question::PushJump) > 1.0, "{}", largest(Question::PushJump));
    for line in &found {
        assert_eq!(Line::read(&line.text()).as_ref(), Some(line));
    }
}

/// A climb of its own in every build, with seeds that no other has.
#[test]
fn a_small_search_misses_no_bar() {
    for name in ["D2Ball", "Fig73", "Fig73Exact", "HalfInchBallCat40", "LBracket"] {
        let hunted = hunt(name, Effort::of(120), 77);
        let missed = missed(std::slice::from_ref(&hunted));
        assert!(missed.is_empty(), "{missed:#?}");
        assert!(hunted.compared > 10_000 && !lines(&hunted).is_empty());
    }
}
