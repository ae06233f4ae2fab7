//! Items 1 and 2: points exactly on every vertex, splitting curve and surface, or the nearest doubles, and points one
//! ulp beside them.

use super::borders::{Bracket, brackets, is_exact, rotated_copies};
use super::ledger::{Kind, Ledger};
use super::truth::{Subject, to_exact};
use super::validator::{PointEvaluation, Validator};
use touchoff_tests::oracle::big::Big;
use touchoff_tests::oracle::rng::Rng;

/// Difference between the evaluated depth on a curve and the depth of each neighbouring region there.
const NEIGHBOUR_DEPTH: Kind = Kind::with_limit("both neighbours", "ulp(S)", 1.0);
/// Step of the evaluated depth across a curve, less the step of the true depth.
const STEP_ERROR: Kind = Kind::with_limit("step across", "ulp(S)", 1.0);
/// Number of points that lie on a curve exactly.
const EXACT_SHARE: Kind = Kind::informational("exactly on it", "share");

/// Validates item 1.
pub(super) fn points_on_borders(
    subject: &Subject,
    max_points: usize,
    rng: &mut Rng,
    ledger: &mut Ledger,
) {
    let validator = Validator::new(subject.tool, &*subject.truth);
    let (mut exact_count, mut count) = (0, 0);
    for bracket in brackets(subject, max_points, rng) {
        let side = nearer_end(subject, &bracket);
        count += 1;
        exact_count += usize::from(is_exact(subject, bracket.ends[side], bracket.owners));
        let answers = validator.validate(&bracket.ends, ledger);
        compare_neighbours(
            subject,
            bracket.ends[side],
            answers[side].as_ref(),
            &bracket.owners,
            ledger,
        );
        compare_step(subject, &bracket, &answers, ledger);
        let copies = rotated_copies(subject, bracket.ends[side], rng);
        validator.validate(&copies[1..], ledger);
    }
    for corner in subject.oracle.corner_points() {
        for p in rotated_copies(subject, corner, rng) {
            let answer = validator.validate(&[p], ledger).swap_remove(0);
            let owners = owners_at(subject, p);
            compare_neighbours(subject, p, answer.as_ref(), &owners, ledger);
        }
    }
    let share = if count > 0 { exact_count as f64 / count as f64 } else { 0.0 };
    ledger.record_info(EXACT_SHARE, count, share, &format!("{exact_count} of {count}"));
}

/// Returns the index of the bracket's end nearer to the border: there the depths of both sides differ less.
fn nearer_end(subject: &Subject, bracket: &Bracket) -> usize {
    let depth_difference = |p: [f64; 3]| {
        let depths = bracket.owners.map(|owner| region_depth(subject, p, owner));
        (&depths[0] - &depths[1]).abs()
    };
    usize::from(depth_difference(bracket.ends[1]) < depth_difference(bracket.ends[0]))
}

/// Returns the depth of a region at a point; outside it is 0.
fn region_depth(subject: &Subject, p: [f64; 3], owner: Option<usize>) -> Big {
    let claim = owner.and_then(|region| subject.truth.region_values(&to_exact(p), region));
    claim.map_or_else(Big::zero, |claim| claim.depth)
}

/// Returns all regions that own a point, to half an ulp(S).
fn owners_at(subject: &Subject, p: [f64; 3]) -> Vec<Option<usize>> {
    let exact_point = to_exact(p);
    let regions = 0..subject.tool.info().regions.len();
    let owning = regions.filter(|region| {
        let claim = subject.truth.region_values(&exact_point, *region);
        claim.is_some_and(|claim| claim.excess_distance <= subject.ulp() / 2.0)
    });
    owning.map(Some).collect()
}

fn compare_neighbours(
    subject: &Subject,
    p: [f64; 3],
    answer: Option<&PointEvaluation>,
    owners: &[Option<usize>],
    ledger: &mut Ledger,
) {
    let Some(answer) = answer else { return };
    let computed = Big::exactly(answer.depth());
    for owner in owners {
        let error = (&computed - &region_depth(subject, p, *owner)).abs().to_f64();
        ledger.record(NEIGHBOUR_DEPTH, error / subject.ulp(), || {
            format!("{p:?} beside region {owner:?}")
        });
    }
}

fn compare_step(
    subject: &Subject,
    bracket: &Bracket,
    answers: &[Option<PointEvaluation>],
    ledger: &mut Ledger,
) {
    if let [Some(a), Some(b)] = answers {
        let exact = bracket.ends.map(|p| subject.truth.depth(&to_exact(p)));
        let computed = &Big::exactly(a.depth()) - &Big::exactly(b.depth());
        let error = (&computed - &(&exact[0] - &exact[1])).abs().to_f64();
        ledger.record(STEP_ERROR, error / subject.ulp(), || format!("{:?}", bracket.ends));
    }
}

/// Validates item 2.
pub(super) fn points_near_borders(
    subject: &Subject,
    max_points: usize,
    rng: &mut Rng,
    ledger: &mut Ledger,
) {
    let validator = Validator::new(subject.tool, &*subject.truth);
    let neighbours = |v: f64| [v, v.next_up(), v.next_down()];
    let mut centres: Vec<[f64; 3]> = subject.oracle.corner_points();
    centres.extend(brackets(subject, max_points, rng).into_iter().flat_map(|bracket| bracket.ends));
    for [x, y, z] in centres {
        let mut points = Vec::new();
        for x in neighbours(x) {
            for z in neighbours(z) {
                if subject.oracle.is_revolved() {
                    let copies = rotated_copies(subject, [x.abs(), 0.0, z], rng);
                    points.push(copies[rng.bits() as usize % copies.len()]);
                } else {
                    points.extend(neighbours(y).map(|y| [x, y, z]));
                }
            }
        }
        validator.validate(&points, ledger);
    }
}
