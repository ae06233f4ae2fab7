//! Cycles and arcs of APT-CL, as positions.
//!
//! `CYCLE/DRILL,FEDTO,5.,MMPM,125.,RAPTO,3.,RTRCTO,25.,DWELL,0` drills at each `GOTO` after it, up to `CYCLE/OFF`: the tool moves at its
//! height over the point, in rapid traverse to `RAPTO` above it, at feed rate to `FEDTO` below it, and back to `RTRCTO` above it. Lengths
//! are along the tool axis, from the point.
//!
//! `CIRCLE/xc,yc,zc,i,j,k` states the centre of the arc to the next `GOTO` and the normal of its plane, about which it turns
//! counter-clockwise. The arc becomes chords.

use super::super::{ProgramFault, number};
use nalgebra::{Point3, Vector3};
use std::f64::consts::TAU;
use touchoff::{Pose, Unit};

/// Distance between an arc and its chords, in mm.
const CHORD_TOLERANCE: f64 = 2e-5;

/// Largest number of chords of an arc. Of larger arcs, chords are at a larger distance.
const MAX_CHORDS: f64 = 20_000.0;

/// Largest difference of the radii at the ends of an arc: as a fraction, and in mm.
const RADII: [f64; 2] = [1e-3, 0.01];

/// A drilling cycle. Lengths are along the tool axis from the point of a hole.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Cycle {
    depth: f64,
    rapid_to: f64,
    retract: Retract,
    /// Set if the tool leaves the hole at feed rate.
    feeds_out: bool,
}

/// The height to which a cycle returns.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Retract {
    To(f64),
    /// The height before the hole.
    Before,
    /// That at which the feed begins.
    RapidTo,
}

/// A position of a cycle or an arc.
pub(super) struct Stop {
    pub(super) pose: Pose,
    pub(super) rapid: bool,
}

impl Cycle {
    /// Reads the arguments of `CYCLE`; `None` for its end.
    pub(super) fn read(arguments: &str) -> Result<Option<Cycle>, ProgramFault> {
        let upper = arguments.to_ascii_uppercase();
        let mut words = upper.split(',').map(str::trim);
        let kind = words.next().unwrap_or_default();
        let refused = |word: &str| ProgramFault::Cycle { word: super::unquoted(word) };
        let feeds_out = match kind {
            "OFF" | "NOMORE" | "INIT" => return Ok(None),
            "DRILL" | "DEEP" | "BRKCHP" | "FACE" => false,
            "TAP" | "REAM" | "BORE" => true,
            other => return Err(refused(other)),
        };
        let (mut depth, mut rapid_to, mut retract) = (None, 0.0, Retract::RapidTo);
        while let Some(word) = words.next() {
            let mut value = || words.next().ok_or_else(|| refused(word)).and_then(number);
            match word {
                "FEDTO" => depth = Some(value()?.abs()),
                "RAPTO" => rapid_to = value()?,
                "RTRCTO" => {
                    let word = words.next().unwrap_or_default();
                    retract = match word {
                        "AUTO" => Retract::Before,
                        "NONE" => Retract::RapidTo,
                        height => Retract::To(number(height)?),
                    };
                }
                // The feed, and times and amounts on the way down.
                "MMPM" | "IPM" | "MMPR" | "IPR" | "DWELL" | "STEP" | "INCR" => drop(value()?),
                other => return Err(refused(other)),
            }
        }
        let Some(depth) = depth.filter(|depth| *depth > 0.0) else {
            return Err(refused("a cycle without FEDTO"));
        };
        Ok(Some(Cycle { depth, rapid_to, retract, feeds_out }))
    }

    /// Returns the positions of a hole at a point, from where the tool is before.
    pub(super) fn stops(
        &self,
        point: &Pose,
        before: Option<&Pose>,
    ) -> Result<Vec<Stop>, ProgramFault> {
        let axis = point.axis();
        let highest = match self.retract {
            Retract::To(height) => height.max(self.rapid_to),
            Retract::Before | Retract::RapidTo => self.rapid_to,
        };
        if before.is_some_and(|before| (before.axis() - axis).norm() > 1e-9) {
            return Err(ProgramFault::Cycle { word: "a tool axis that turns in it".to_owned() });
        }
        let level = before.map_or(highest, |before| (before.tip() - point.tip()).dot(&axis));
        let at = |height: f64| -> Result<Pose, ProgramFault> {
            Ok(Pose::from_axis(point.tip() + height * axis, axis)?)
        };
        let mut stops = Vec::new();
        let mut add = |pose, rapid| stops.push(Stop { pose, rapid });
        if let Some(before) = before.filter(|_| level < self.rapid_to) {
            let raised = before.tip() + (self.rapid_to - level) * axis;
            add(Pose::from_axis(raised, axis)?, true);
        }
        let over = level.max(self.rapid_to);
        add(at(over)?, true);
        if over > self.rapid_to {
            add(at(self.rapid_to)?, true);
        }
        add(at(-self.depth)?, false);
        let clear = match self.retract {
            Retract::To(height) => height,
            Retract::Before => over,
            Retract::RapidTo => self.rapid_to,
        };
        if self.feeds_out {
            add(at(self.rapid_to)?, false);
        }
        if !self.feeds_out || clear != self.rapid_to {
            add(at(clear)?, true);
        }
        Ok(stops)
    }
}

/// The arc to the next position.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Arc {
    centre: Point3<f64>,
    normal: Vector3<f64>,
}

impl Arc {
    /// Reads the arguments of `CIRCLE`: the centre, the normal, and possibly the radius, which follows from the ends.
    pub(super) fn read(arguments: &str) -> Result<Arc, ProgramFault> {
        let values = arguments.split(',').map(number).collect::<Result<Vec<f64>, _>>()?;
        let (&[x, y, z, i, j, k] | &[x, y, z, i, j, k, _]) = &values[..] else {
            return Err(arc("has other numbers than a centre and a normal"));
        };
        let normal = Vector3::new(i, j, k);
        match (normal.norm() - 1.0).abs() < 1e-3 {
            true => Ok(Arc { centre: Point3::new(x, y, z), normal: normal.normalize() }),
            false => Err(arc("has a normal that is no unit vector")),
        }
    }

    /// Returns the positions along the arc, the last of which is its end.
    pub(super) fn stops(
        &self,
        before: Option<&Pose>,
        end: &Pose,
        unit: Option<Unit>,
    ) -> Result<Vec<Pose>, ProgramFault> {
        let Some(before) = before else {
            return Err(arc("begins at no position"));
        };
        let axis = end.axis();
        if (before.axis() - axis).norm() > 1e-9 {
            return Err(arc("turns the tool axis"));
        }
        let arms = [before, end].map(|pose| {
            let arm = pose.tip() - self.centre;
            (arm - arm.dot(&self.normal) * self.normal, arm.dot(&self.normal))
        });
        let [(from, low), (to, high)] = arms;
        let (start_radius, end_radius) = (from.norm(), to.norm());
        let scale = unit.unwrap_or(Unit::Millimetre).millimetres();
        let allowed = (RADII[0] * start_radius).max(RADII[1] / scale);
        if start_radius == 0.0 || (start_radius - end_radius).abs() > allowed {
            return Err(arc("has another radius at its start than at its end"));
        }
        let turn = from.cross(&to).dot(&self.normal).atan2(from.dot(&to));
        let is_full = (from - to).norm() < 1e-6 * start_radius;
        let sweep = if is_full { TAU } else { turn.rem_euclid(TAU) };
        let angle = (8.0 * CHORD_TOLERANCE / scale / start_radius.max(end_radius)).sqrt().min(0.1);
        let count = (sweep / angle).ceil().clamp(1.0, MAX_CHORDS);
        let (along, across) = (from / start_radius, self.normal.cross(&from) / start_radius);
        let poses = (1..count as u32).map(|k| {
            let at = f64::from(k) / count;
            let (sine, cosine) = (at * sweep).sin_cos();
            let radius = start_radius + at * (end_radius - start_radius);
            let height = low + at * (high - low);
            let tip =
                self.centre + radius * (cosine * along + sine * across) + height * self.normal;
            Ok(Pose::from_axis(tip, axis)?)
        });
        poses.chain([Ok(*end)]).collect()
    }
}

fn arc(what: &'static str) -> ProgramFault {
    ProgramFault::Arc { what }
}
