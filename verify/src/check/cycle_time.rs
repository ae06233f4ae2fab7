//! The time that the motions of a program take, by the programmed feed and the rates of rapid traverse.

use crate::program::{ClData, CutterLocation};
use std::fmt;
use touchoff::Unit;

/// The assumptions of a [`CycleTime`], as a sentence.
pub const CYCLE_TIME_ASSUMPTIONS: &str = "F, or FEDRAT of CL data, is the speed of the tip along the programmed path of X, Y and Z, and F that of rotary axes where \
     they move alone; in rapid traverse the slowest axis takes its way at the rate that the machine's file states, and CL data state \
     none. Acceleration, look-ahead, overrides, tool changes and stops of the program are not counted";

/// The time that a tool is in motion, and dwells, in one reading of a program. Times are in seconds.
///
/// A motion at feed rate takes the length of its path, of which that of an arc is by its mean radius, over the feed: from G94, or
/// from G95 at the speed of the spindle, or from `FEDRAT` in CL data. Under G93 it takes its time. One in rapid traverse takes the
/// longest time of an axis at its rate. Acceleration, look-ahead, overrides, tool changes and stops of the program are not counted.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct CycleTime {
    /// The tool's number; `None` before the first tool change.
    pub tool: Option<u32>,
    /// Time at feed rate.
    pub feed: f64,
    /// Time in rapid traverse; `None` if no rates are stated: on a machine without, and in CL data.
    pub rapid: Option<f64>,
    /// Time of dwells by G4, and of `DELAY` in CL data.
    pub dwell: f64,
    /// Number of motions and dwells whose time is not known, and not counted: where the start, the feed or the rates are not.
    pub unknown: usize,
    /// The line of the first of them.
    pub first_unknown: Option<usize>,
}

impl CycleTime {
    /// Returns the time that is known.
    pub fn known(&self) -> f64 {
        self.feed + self.rapid.unwrap_or_default() + self.dwell
    }

    /// Returns the time of each tool of CL data, in the order of the program; none if it states neither feeds nor delays. `unit` is
    /// that of positions whose program states none.
    pub(crate) fn of_locations(programs: &[ClData], unit: Unit) -> Vec<CycleTime> {
        let states_times = |program: &ClData| {
            !program.delays.is_empty()
                || program.locations.iter().any(|location| location.feed.is_some())
        };
        let mut times: Vec<CycleTime> = Vec::new();
        if !programs.iter().any(states_times) {
            return times;
        }
        for program in programs {
            let known = times.iter().position(|time| time.tool == program.tool);
            let index = known.unwrap_or(times.len());
            if known.is_none() {
                times.push(CycleTime { tool: program.tool, ..CycleTime::default() });
            }
            times[index].add_locations(program, program.unit.unwrap_or(unit));
        }
        times
    }

    /// Adds the motions and the delays of CL data, whose positions are in `unit`.
    fn add_locations(&mut self, program: &ClData, unit: Unit) {
        // Only the machine knows where the way to the first position begins.
        if !program.starts_at_first() {
            self.add_unknown(1, program.locations[0].line);
        }
        for (from, to) in program.locations.iter().zip(&program.locations[1..]) {
            match seconds_between(from, to, unit) {
                Some(seconds) => self.feed += seconds,
                None => self.add_unknown(1, to.line),
            }
        }
        for delay in &program.delays {
            match delay.seconds {
                Some(seconds) => self.dwell += seconds,
                None => self.add_unknown(1, delay.line),
            }
        }
    }

    /// Counts motions or dwells whose time is not known.
    pub(super) fn add_unknown(&mut self, count: usize, line: usize) {
        self.unknown += count;
        self.first_unknown = Some(self.first_unknown.map_or(line, |first| first.min(line)));
    }
}

/// The times as a sentence: `30.0 s in feed, 1.2 s in rapid traverse; the time of 3 motions or dwells is not known, the first in
/// line 7`.
impl fmt::Display for CycleTime {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:.1} s in feed", self.feed)?;
        match self.rapid {
            Some(rapid) => write!(f, ", {rapid:.1} s in rapid traverse"),
            None => f.write_str(", rapid traverse not known, as no rates are stated"),
        }?;
        if self.dwell > 0.0 {
            write!(f, ", {:.1} s in dwells", self.dwell)?;
        }
        match self.first_unknown {
            Some(line) => write!(
                f,
                "; the time of {} motions or dwells is not known, the first in line {line}",
                self.unknown
            ),
            None => Ok(()),
        }
    }
}

/// Returns the time of the motion between two cutter locations, whose positions are in `unit`; `None` if it is not known.
fn seconds_between(from: &CutterLocation, to: &CutterLocation, unit: Unit) -> Option<f64> {
    let feed = to.feed?;
    let way = unit.millimetres() * (to.pose.tip() - from.pose.tip()).norm();
    // The speed of the tip says nothing about a turn in place.
    (way > 0.0 || from.pose == to.pose).then_some(60.0 * way / feed)
}
