//! Items 1 and 2: points exactly on every vertex, splitting curve and surface, or the nearest doubles, and points one
//! ulp beside them.

use super::borders::{Bracket, brackets, exact, turned};
use super::judge::{Answer, Judge};
use super::ledger::{Kind, Ledger};
use super::truth::{Subject, place};
use touchoff_tests::oracle::big::Big;
use touchoff_tests::oracle::draw::Rng;

/// Difference between the evaluated depth on a curve and the depth of each neighbouring region there.
const AGREE: Kind = Kind::of("both neighbours", "ulp(S)", 1.0);
/// Step of the evaluated depth across a curve, less the step of the true depth.
const STEP: Kind = Kind::of("step across", "ulp(S)", 1.0);
/// Number of points that lie on a curve exactly.
const EXACTLY: Kind = Kind::told("exactly on it", "share");

/// Validates item 1.
pub(super) fn exactly(subject: &Subject, most: usize, draw: &mut Rng, ledger: &mut Ledger) {
    let judge = Judge::new(subject.tool, &*subject.truth);
    let (mut on, mut all) = (0, 0);
    for bracket in brackets(subject, most, draw) {
        let side = nearer(subject, &bracket);
        all += 1;
        on += usize::from(exact(subject, bracket.ends[side], bracket.owners));
        let answers = judge.points(&bracket.ends, ledger);
        neighbours(subject, bracket.ends[side], answers[side].as_ref(), &bracket.owners, ledger);
        step(subject, &bracket, &answers, ledger);
        let around = turned(subject, bracket.ends[side], draw);
        judge.points(&around[1..], ledger);
    }
    for corner in subject.oracle.corner_points() {
        for p in turned(subject, corner, draw) {
            let answer = judge.points(&[p], ledger).swap_remove(0);
            let owners = owners_at(subject, p);
            neighbours(subject, p, answer.as_ref(), &owners, ledger);
        }
    }
    let share = if all > 0 { on as f64 / all as f64 } else { 0.0 };
    ledger.tell(EXACTLY, all, share, &format!("{on} of {all}"));
}

/// Returns the index of the bracket's end nearer to the border: there the depths of both sides differ less.
fn nearer(subject: &Subject, bracket: &Bracket) -> usize {
    let apart = |p: [f64; 3]| {
        let depths = bracket.owners.map(|owner| depth_of(subject, p, owner));
        (&depths[0] - &depths[1]).abs()
    };
    usize::from(apart(bracket.ends[1]) < apart(bracket.ends[0]))
}

/// Returns the depth of a region at a point; outside it is 0.
fn depth_of(subject: &Subject, p: [f64; 3], owner: Option<usize>) -> Big {
    let claim = owner.and_then(|region| subject.truth.claim(&place(p), region));
    claim.map_or_else(Big::zero, |claim| claim.depth)
}

/// Returns all regions that own a point, to half an ulp(S).
fn owners_at(subject: &Subject, p: [f64; 3]) -> Vec<Option<usize>> {
    let at = place(p);
    let regions = 0..subject.tool.info().regions.len();
    let here = regions.filter(|region| {
        let claim = subject.truth.claim(&at, *region);
        claim.is_some_and(|claim| claim.behind <= subject.ulp() / 2.0)
    });
    here.map(Some).collect()
}

fn neighbours(
    subject: &Subject,
    p: [f64; 3],
    answer: Option<&Answer>,
    owners: &[Option<usize>],
    ledger: &mut Ledger,
) {
    let Some(answer) = answer else { return };
    let found = Big::exactly(answer.depth());
    for owner in owners {
        let off = (&found - &depth_of(subject, p, *owner)).abs().to_f64();
        ledger.see(AGREE, off / subject.ulp(), || format!("{p:?} beside region {owner:?}"));
    }
}

fn step(subject: &Subject, bracket: &Bracket, answers: &[Option<Answer>], ledger: &mut Ledger) {
    if let [Some(a), Some(b)] = answers {
        let exact = bracket.ends.map(|p| subject.truth.depth(&place(p)));
        let found = &Big::exactly(a.depth()) - &Big::exactly(b.depth());
        let off = (&found - &(&exact[0] - &exact[1])).abs().to_f64();
        ledger.see(STEP, off / subject.ulp(), || format!("{:?}", bracket.ends));
    }
}

/// Validates item 2.
pub(super) fn beside(subject: &Subject, most: usize, draw: &mut Rng, ledger: &mut Ledger) {
    let judge = Judge::new(subject.tool, &*subject.truth);
    let around = |v: f64| [v, v.next_up(), v.next_down()];
    let mut places: Vec<[f64; 3]> = subject.oracle.corner_points();
    places.extend(brackets(subject, most, draw).into_iter().flat_map(|bracket| bracket.ends));
    for [x, y, z] in places {
        let mut points = Vec::new();
        for x in around(x) {
            for z in around(z) {
                if subject.oracle.revolved() {
                    let turned = turned(subject, [x.abs(), 0.0, z], draw);
                    points.push(turned[draw.bits() as usize % turned.len()]);
                } else {
                    points.extend(around(y).map(|y| [x, y, z]));
                }
            }
        }
        judge.points(&points, ledger);
    }
}
