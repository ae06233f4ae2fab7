//! Joint values along a path: of both solutions of the inverse kinematics at each cutter location, those whose rotary
//! axes travel least.

use nalgebra::{Point3, Vector3};
use touchoff_verify::machine::{Chain, InverseError, Joints};

/// A cutter location: the tip in mm and the tool axis, in the frame of the part.
pub(super) struct Target {
    pub(super) tip: Point3<f64>,
    pub(super) axis: Vector3<f64>,
    pub(super) rapid: bool,
}

/// A candidate for the joint values of a cutter location.
struct Candidate {
    joints: Joints,
    /// Travel of the rotary axes until then, in degrees, with that in rapid traverse at a lower weight.
    cost: f64,
    /// Index of the candidate before.
    from: usize,
}

/// Weight of travel in rapid traverse, where a turn of the axes rather does no harm.
const RAPID_WEIGHT: f64 = 0.1;

/// Number of candidates that are kept per cutter location. There are two solutions, each with several whole turns.
const MAX_CANDIDATES: usize = 8;

/// Difference of joint values, in degrees, below which they are the same.
const SAME: f64 = 1e-6;

/// Returns the joint values of cutter locations: a shortest path (Viterbi) over the solutions within limits. `start` has
/// the joint values before the first.
///
/// # Errors
/// The index of the first cutter location that no sequence reaches, and the reason.
pub(super) fn sequence(
    chain: &Chain,
    targets: &[Target],
    start: Joints,
) -> Result<Vec<Joints>, (usize, InverseError)> {
    let mut layers: Vec<Vec<Candidate>> = Vec::with_capacity(targets.len());
    let first = [Candidate { joints: start, cost: 0.0, from: 0 }];
    for (index, target) in targets.iter().enumerate() {
        let before = layers.last().map_or(&first[..], Vec::as_slice);
        let layer = candidates(chain, target, before).map_err(|error| (index, error))?;
        layers.push(layer);
    }
    // Candidates are sorted by cost.
    let mut at = 0;
    let mut joints: Vec<Joints> = layers
        .iter()
        .rev()
        .map(|layer| {
            let candidate = &layer[at];
            at = candidate.from;
            candidate.joints
        })
        .collect();
    joints.reverse();
    Ok(joints)
}

/// Returns the candidates of a cutter location by ascending cost, at least one.
fn candidates(
    chain: &Chain,
    target: &Target,
    before: &[Candidate],
) -> Result<Vec<Candidate>, InverseError> {
    let weight = if target.rapid { RAPID_WEIGHT } else { 1.0 };
    let (mut all, mut fault) = (Vec::new(), None);
    for (from, last) in before.iter().enumerate() {
        match chain.solutions(&target.tip, &target.axis, &last.joints) {
            Ok(solutions) => all.extend(solutions.into_iter().map(|solution| Candidate {
                joints: solution.joints,
                cost: last.cost + weight * rotary_travel(&last.joints, &solution.joints),
                from,
            })),
            Err(error) => fault = fault.or(Some(error)),
        }
    }
    if let (true, Some(fault)) = (all.is_empty(), fault) {
        return Err(fault);
    }
    all.sort_by(|one, other| one.cost.total_cmp(&other.cost));
    let mut kept: Vec<Candidate> = Vec::new();
    for candidate in all {
        let is_known =
            kept.iter().any(|known| rotary_travel(&known.joints, &candidate.joints) < SAME);
        if !is_known && kept.len() < MAX_CANDIDATES {
            kept.push(candidate);
        }
    }
    Ok(kept)
}

/// Returns the travel of the rotary axes between joint values, in degrees.
pub(super) fn rotary_travel(from: &Joints, to: &Joints) -> f64 {
    (3..6).map(|k| (to[k] - from[k]).abs()).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchoff_verify::machine::{Machine, Setup};

    /// An axis that turns about z by more than a turn at a tilt, which only one of both solutions follows within the
    /// limits of A, although the other is nearer to the start.
    #[test]
    fn takes_the_solution_that_lasts() {
        let machine = Machine::named("A-C trunnion").expect("a machine");
        let setup = Setup { work_offset: [0.0, 0.0, -480.0, 0.0, 0.0, 0.0], tool_length: 100.0 };
        let chain = machine.chain(&setup).expect("a chain");
        let target = |tilt: f64| {
            let (sine, cosine) = tilt.to_radians().sin_cos();
            Target { tip: Point3::origin(), axis: Vector3::new(0.0, -sine, cosine), rapid: false }
        };
        // The limits of A are -120 and 30: from 20 on the way leads to 30 at most with A above 0.
        let targets: Vec<Target> = (20..60).map(|tilt| target(f64::from(tilt))).collect();
        let joints = sequence(&chain, &targets, [0.0; 6]).expect("a sequence");
        for (joints, target) in joints.iter().zip(&targets) {
            let pose = chain.pose(joints).expect("a pose");
            assert!((pose.axis() - target.axis).norm() < 1e-9 && joints[3] < 0.0, "{joints:?}");
        }
        let jumps = joints.windows(2).map(|pair| rotary_travel(&pair[0], &pair[1]));
        assert!(jumps.fold(0.0, f64::max) < 1.1);
        // The nearest solution at each step runs into the limit, and has to turn by half a turn in between.
        let mut near = [0.0; 6];
        let greedy = targets.iter().map(|target| {
            let joints =
                chain.inverse(&target.tip, &target.axis, &near).expect("a solution").joints;
            let jump = rotary_travel(&near, &joints);
            near = joints;
            jump
        });
        assert!(greedy.skip(1).fold(0.0, f64::max) > 180.0);
    }

    #[test]
    fn names_what_is_not_reached() {
        let machine = Machine::named("3-axis").expect("a machine");
        let chain = machine.chain(&Setup::default()).expect("a chain");
        let target =
            |axis: Vector3<f64>| Target { tip: Point3::new(0.0, 0.0, -100.0), axis, rapid: true };
        let targets = [target(Vector3::z()), target(Vector3::new(0.0, 0.1, 1.0))];
        let (index, error) = sequence(&chain, &targets, [0.0; 6]).expect_err("three axes");
        assert_eq!(index, 1);
        assert!(matches!(error, InverseError::Unreachable { .. }), "{error}");
    }
}
