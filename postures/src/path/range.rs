//! The directions that the tool axis may take: those within a tilt that a machine reaches.

use super::tilt::TiltLimit;
use crate::Directions;
use nalgebra::Vector3;
use std::f64::consts::PI;

/// The limits that a machine sets to the tool axis.
pub trait ToolAxisLimits: Sync {
    /// Returns whether the machine can hold the tool axis in a direction, a unit vector from the tip to the spindle in
    /// the part's frame.
    fn allow(&self, axis: &Vector3<f64>) -> bool;
}

/// The allowed directions of the tool axis.
#[derive(Clone, Copy)]
pub(super) struct AxisRange<'a> {
    pub(super) tilt: TiltLimit,
    /// The limits of the machine, if one is given.
    pub(super) machine: Option<&'a dyn ToolAxisLimits>,
}

/// Largest angle, in radians, between directions of a turn that are asked of a machine: 2°.
const TURN_STEP: f64 = PI / 90.0;

/// Number of directions between one and +z that are tried in its place: every 4° at most.
const CLAMP_STEPS: u32 = 45;

/// Angle in radians, 5°, by which a direction is turned farther: two axes at the largest tilt have a lower great circle
/// between them.
const CLAMP_MARGIN: f64 = PI / 36.0;

impl AxisRange<'_> {
    /// Returns whether the axis may take a direction.
    pub(super) fn allows(&self, axis: &Vector3<f64>) -> bool {
        self.tilt.allows(axis) && self.machine.is_none_or(|machine| machine.allow(axis))
    }

    /// Returns whether the axis is within the range while it turns from one direction to another, on a great circle.
    /// A machine is asked for directions up to 2° apart; between them its joints are proved when the program is posted.
    pub(super) fn allows_turn(&self, from: &Vector3<f64>, to: &Vector3<f64>) -> bool {
        if !self.tilt.allows_turn(from, to) {
            return false;
        }
        let Some(machine) = self.machine else { return true };
        let steps = (from.angle(to) / TURN_STEP).ceil().max(1.0);
        (0..=steps as u32).all(|k| machine.allow(&from.slerp(to, f64::from(k) / steps)))
    }

    /// Returns a direction that is allowed, or one turned from it toward +z until the axis may take it, and a little
    /// farther, so that it may also turn to the next such direction. Returns `None` if none on the way is allowed.
    pub(super) fn clamped(&self, direction: &Vector3<f64>) -> Option<Vector3<f64>> {
        if self.allows(direction) {
            return Some(*direction);
        }
        let top = Vector3::z();
        // From -z every great circle leads to +z: the one by +x is taken.
        let is_bottom = direction.angle(&top) > PI - TURN_STEP;
        let first = if is_bottom { Vector3::x() } else { *direction };
        let angle = first.angle(&top);
        let mut turns = (0..=CLAMP_STEPS).map(|k| f64::from(k) / f64::from(CLAMP_STEPS));
        let turned = turns.find(|turn| self.allows(&first.slerp(&top, *turn)))?;
        let farther = first.slerp(&top, (turned + CLAMP_MARGIN / angle).min(1.0));
        Some(if self.allows(&farther) { farther } else { first.slerp(&top, turned) })
    }

    /// Returns sets of directions without those beyond the range, and whether any direction is left. A set of another
    /// length belongs to other directions, and becomes empty.
    pub(super) fn filter(
        &self,
        directions: &Directions,
        sets: &[Vec<u64>],
    ) -> (Vec<Vec<u64>>, bool) {
        let mut within = vec![0u64; directions.words()];
        for (index, direction) in directions.list().iter().enumerate() {
            if self.allows(&Vector3::from(*direction)) {
                within[index / 64] |= 1 << (index % 64);
            }
        }
        let filtered = sets.iter().map(|set| match set.len() == within.len() {
            true => set.iter().zip(&within).map(|(word, within)| word & within).collect(),
            false => Vec::new(),
        });
        (filtered.collect(), within.iter().any(|word| *word != 0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A trunnion that leans by up to 40° to one side and 110° to the other, on a table that does not turn.
    struct Leaning;

    impl ToolAxisLimits for Leaning {
        fn allow(&self, axis: &Vector3<f64>) -> bool {
            let angle = axis.y.atan2(axis.z).to_degrees();
            axis.x.abs() < 0.5 && (-40.0..=110.0).contains(&angle)
        }
    }

    fn range(max_tilt: f64, machine: Option<&dyn ToolAxisLimits>) -> AxisRange<'_> {
        AxisRange { tilt: TiltLimit::new(max_tilt).expect("an angle"), machine }
    }

    /// Both limits hold, at the ends of a turn and between them, by sampling it.
    #[test]
    fn a_turn_is_allowed_as_its_samples_are() {
        let directions = Directions::spread(120);
        let range = range(1.7, Some(&Leaning));
        let mut counts = [0; 2];
        for from in directions.list().iter().map(|direction| Vector3::from(*direction)) {
            for to in directions.list().iter().map(|direction| Vector3::from(*direction)) {
                if from.dot(&to) < -0.99 || !(range.allows(&from) && range.allows(&to)) {
                    continue;
                }
                let samples = (0..=400)
                    .filter_map(|k| from.lerp(&to, f64::from(k) / 400.0).try_normalize(1e-9));
                let outside = samples.filter(|axis| !range.allows(axis)).count();
                // Turns that only touch a limit may be judged either way.
                if outside == 0 || outside > 20 {
                    assert_eq!(range.allows_turn(&from, &to), outside == 0, "{from} {to}");
                    counts[usize::from(outside == 0)] += 1;
                }
            }
        }
        assert!(counts[0] > 20 && counts[1] > 100, "{counts:?}");
    }

    #[test]
    fn a_clamped_direction_is_allowed_and_the_first_on_its_way() {
        for direction in Directions::spread(60).list() {
            let direction = Vector3::from(*direction);
            for machine in [None, Some(&Leaning as &dyn ToolAxisLimits)] {
                let range = range(1.7, machine);
                let clamped = range.clamped(&direction).expect("+z is allowed");
                assert!(range.allows(&clamped), "{direction}");
                assert!(!range.allows(&direction) || clamped == direction, "{direction}");
                assert!(clamped.z >= direction.z - 1e-9, "{direction}");
            }
        }
        assert!(range(PI, Some(&Leaning)).clamped(&-Vector3::z()).is_some());
    }

    #[test]
    fn directions_beyond_a_limit_are_left_out() {
        let directions = Directions::spread(60);
        let all = vec![u64::MAX; directions.words()];
        let range = range(1.7, Some(&Leaning));
        let (filtered, any) = range.filter(&directions, &[all, vec![1]]);
        assert!(any && filtered[1].is_empty());
        for (index, direction) in directions.list().iter().enumerate() {
            let kept = filtered[0][index / 64] >> (index % 64) & 1 == 1;
            assert_eq!(kept, range.allows(&Vector3::from(*direction)), "{direction:?}");
        }
    }
}
