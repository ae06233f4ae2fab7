//! The time of steps on a machine, by the programmed feed and the rates of its axes.

use super::resolve::{Band, Resolved};
use crate::check::CycleTime;
use crate::gcode::{Dwells, Feed, Step, StepPath};
use crate::machine::{JointMotion, Machine};

impl CycleTime {
    /// Returns the time of a tool on a machine before its first motion.
    pub(super) fn new(tool: Option<u32>, machine: &Machine) -> CycleTime {
        let has_rates = machine.axes().iter().all(|axis| axis.rapid.is_some());
        CycleTime { tool, rapid: has_rates.then_some(0.0), ..CycleTime::default() }
    }

    /// Adds a step that is no tool change, with what the machine makes of it.
    pub(super) fn add(&mut self, step: &Step, resolved: &Resolved, machine: &Machine) {
        let motions = match resolved {
            Resolved::Motions(motions) | Resolved::Band(Band { motions, .. }) => Some(motions),
            Resolved::AnyRapid(_)
            | Resolved::Arrival(..)
            | Resolved::Departure(..)
            | Resolved::Unknown(_)
            | Resolved::ToolChange
            | Resolved::Loaded(_) => None,
        };
        let joints = motions.map(|motions| motions.iter().map(|(motion, _)| motion));
        let seconds = joints.and_then(|joints| match step.rapid {
            true => rapid_seconds(joints, machine),
            false => feed_seconds(step, joints),
        });
        match (seconds, &mut self.rapid) {
            (Some(seconds), Some(rapid)) if step.rapid => *rapid += seconds,
            (Some(seconds), _) if !step.rapid => self.feed += seconds,
            _ => self.add_unknown(1, step.line),
        }
    }

    /// Adds the dwells of the tool.
    pub(super) fn add_dwells(&mut self, dwells: &Dwells) {
        self.dwell += dwells.seconds;
        if let Some(line) = dwells.first_unknown {
            self.add_unknown(dwells.unknown, line);
        }
    }
}

/// Returns the time of a motion in rapid traverse; `None` if the machine states no rates.
fn rapid_seconds<'a>(
    motions: impl Iterator<Item = &'a JointMotion>,
    machine: &Machine,
) -> Option<f64> {
    let mut minutes = 0.0;
    for motion in motions {
        let [start, end] = [0.0, 1.0].map(|time| motion.joints(time));
        let mut longest: f64 = 0.0;
        for axis in machine.axes() {
            let index = axis.letter.index();
            longest = longest.max((end[index] - start[index]).abs() / axis.rapid?);
        }
        minutes += longest;
    }
    Some(60.0 * minutes)
}

/// Returns the time of a motion at feed rate; `None` if the feed or the length of its path is not known.
fn feed_seconds<'a>(step: &Step, motions: impl Iterator<Item = &'a JointMotion>) -> Option<f64> {
    let minutes = match step.feed? {
        Feed::Time { minutes } => minutes,
        Feed::Speed { length, angle } => match path_length(step)? {
            way if way > 0.0 => way / length,
            _ => {
                let turns = motions.map(|motion| {
                    let [start, end] = [0.0, 1.0].map(|time| motion.joints(time));
                    (3..6).map(|axis| (end[axis] - start[axis]).powi(2)).sum::<f64>().sqrt()
                });
                turns.sum::<f64>() / angle
            }
        },
    };
    Some(60.0 * minutes)
}

/// Returns the length of the programmed path of X, Y and Z, in millimetres; `None` if an end of it is not known. The radius of an
/// arc is the mean of those at its ends, which differ by a thousandth at most.
fn path_length(step: &Step) -> Option<f64> {
    let way = |axis: usize| match (step.start[axis], step.end[axis]) {
        (Some(start), Some(end)) => Some(end - start),
        // It stays where it is.
        (_, None) if !step.commanded[axis] => Some(0.0),
        _ => None,
    };
    match step.path {
        StepPath::Arc { plane, centre, sweep } => {
            let [first, second] = plane.axes();
            let radius = |position: &[Option<f64>; 6]| {
                Some((position[first]? - centre[0]).hypot(position[second]? - centre[1]))
            };
            let mean = 0.5 * (radius(&step.start)? + radius(&step.end)?);
            Some((mean * sweep).hypot(way(plane.normal())?))
        }
        StepPath::Line | StepPath::Align => {
            let [x, y, z] = [way(0)?, way(1)?, way(2)?];
            Some(x.hypot(y).hypot(z))
        }
        StepPath::Pivot { .. }
        | StepPath::Undetermined
        | StepPath::Machine(_)
        | StepPath::ToolChange(_) => None,
    }
}
