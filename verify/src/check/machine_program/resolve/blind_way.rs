//! Ways on which some axes are not known, and those of an empty spindle, judged by what they pass over.

use super::super::{BlindWay, Level, StepFault};
use super::{Band, Resolved, Resolver, UPRIGHT};
use crate::gcode::{Position, Step, Z_ALONE};
use crate::machine::{Axis, Chain, JointMotion, Joints, Side};
use nalgebra::Vector3;

/// The joints other than Z.
const BESIDE_Z: [usize; 5] = [0, 1, 3, 4, 5];

impl Resolver<'_> {
    /// Returns a step with joints at its ends on which Z is known, and X, Y or rotary axes are not. The tool is nowhere below its levels,
    /// wherever these are: below all at a link or part that tilts. At the top of Z's travel a table may.
    pub(super) fn blind_way(&self, step: &Step, ends: [Position; 2]) -> Option<BlindWay> {
        let is_unknown = |k: usize, end: &Position| end[k].is_none() && self.has_axis(k);
        let [starts_blind, ends_blind] =
            ends.each_ref().map(|end| BESIDE_Z.into_iter().any(|k| is_unknown(k, end)));
        let [starts_at_level, ends_at_level] = ends.map(|end| end[2].is_some());
        // A way from an unknown height, but aside or about an axis between known places, is none that the operator moves.
        let goes_aside = !starts_at_level
            && ends_at_level
            && BESIDE_Z
                .into_iter()
                .any(|k| ends[0][k].is_some_and(|from| ends[1][k] != Some(from)));
        if !step.commanded.contains(&true) || !(starts_blind || ends_blind || goes_aside) {
            return None;
        }
        // From where nothing is known, the operator moves to the first position. Under tool centre point control Z of the tip can be
        // stated before the axes are known.
        let states_z = step.state.turns_with_workpiece() && step.start[2].is_some();
        if !(starts_at_level || ends_at_level && ends_blind || states_z || goes_aside) {
            return None;
        }
        let is_high =
            |is_there: &dyn Fn(f64) -> bool| ends.iter().all(|end| end[2].is_some_and(is_there));
        let is_at_top = is_high(&|z| self.stands_high(z));
        // From wherever the operator has left it, Z alone goes to the top of its travel or to its reference position, at which the others
        // are free.
        let is_retract = step.commanded == Z_ALONE && !starts_at_level && self.at_top.is_some();
        let is_aside = self.was_at_top.is_some() && self.at_top.is_some() && !step.commanded[2];
        let chain = self.chain.as_ref()?.1.without_linear_limits();
        let turns =
            |k: usize| ends.iter().any(|end| is_unknown(k, end)) || ends[0][k] != ends[1][k];
        // A part that the table tilts by unknown angles is as high as it can swing.
        let tilts = |side: Side| self.tilting(&turns).any(|axis| axis.side == side);
        let is_of_head = tilts(Side::Tool) && !tilts(Side::Table);
        // A table can tilt at the top of the travel, and swing into a tool at a lower reference position.
        let is_free = is_high(&|z| self.is_top(z)) && self.tilting(&turns).next().is_some();
        if is_retract || is_free || (is_at_top || is_aside) && is_of_head {
            return None;
        }
        let known = ends.iter().filter(|end| end[2].is_some());
        let levels = known
            .map(|end| self.levels_while(&chain, &end.map(Option::unwrap_or_default), &turns))
            .reduce(|one, other| Level::lower(&one, &other));
        // Otherwise only Z of the tip is known, with which the axes move.
        let levels = levels.unwrap_or_else(|| vec![Level::BELOW; chain.link() + 1]);
        Some(BlindWay { levels, is_at_top })
    }

    /// Returns the level of the gauge point during a step that moves axes aside at the top of Z's travel, or at a reference position, or
    /// that leads to one below the top.
    pub(in crate::check) fn top_way(&mut self, step: &Step, has_length: bool) -> Option<BlindWay> {
        let height = self.at_top.filter(|height| match step.commanded[2] {
            // From the tip of a tool of unknown length it may lead down.
            true => !self.is_top(*height),
            false => self.was_at_top.is_some(),
        })?;
        if !self.is_placed {
            return None;
        }
        // A machine without a chain to the gauge point has refused every motion.
        let chain = self.chain(0.0).ok()?.without_linear_limits();
        let turns = |k: usize| step.commanded[k] || self.joints[k].is_none() && self.has_axis(k);
        // A head that swings by an unknown angle has no level. Below the top a table may tilt, which is known to be out of the way of a tool
        // of a stated length alone.
        if self.tilting(&turns).any(|axis| axis.side == Side::Tool || has_length) {
            return None;
        }
        let mut joints = self.joints.map(Option::unwrap_or_default);
        joints[2] = height;
        let levels = self.levels_while(&chain, &joints, &turns);
        // The reference position can be lower than the end of the travel, and counts as the top, too.
        Some(BlindWay { levels, is_at_top: self.is_high(height) })
    }

    /// Returns the level of a way between two joint positions on which Z is nowhere below `lowest`.
    pub(super) fn level_way(&self, chain: &Chain, ends: [Joints; 2], lowest: f64) -> BlindWay {
        let chain = chain.without_linear_limits();
        let [start, end] = ends;
        let [one, other] = ends.map(|mut joints| {
            joints[2] = lowest;
            self.levels_while(&chain, &joints, &|k| start[k] != end[k])
        });
        BlindWay { levels: Level::lower(&one, &other), is_at_top: self.stands_high(lowest) }
    }

    /// Returns the known motions of a step without a tool, with the levels of the spindle's gauge point.
    ///
    /// # Errors
    /// If the machine has no chain to it.
    pub(super) fn empty_way(&mut self, resolved: &Resolved) -> Result<Option<BlindWay>, StepFault> {
        let motions: Vec<(&JointMotion, f64)> = match resolved {
            Resolved::Motions(motions) => {
                motions.iter().map(|(motion, error)| (motion, *error)).collect()
            }
            Resolved::Band(Band { motions, curves }) => {
                motions.iter().chain(curves).map(|(motion, error)| (motion, *error)).collect()
            }
            // At any rates Z is between its ends.
            Resolved::AnyRapid(any) => vec![(&any.straight, 0.0)],
            Resolved::Arrival(motion, _)
            | Resolved::Departure(motion, _)
            | Resolved::Loaded(motion) => vec![(motion, 0.0)],
            Resolved::Unknown(_) | Resolved::ToolChange => return Ok(None),
        };
        let chain = self.chain(0.0)?;
        let ways = motions.into_iter().map(|(motion, error)| {
            let ends = [0.0, 1.0].map(|at| motion.joints(at));
            // Under tool centre point control Z follows the axes that turn.
            match motion.lowest_z() {
                Some(lowest) => self.level_way(&chain, ends, lowest - error),
                None => BlindWay { levels: vec![Level::BELOW; chain.link() + 1], is_at_top: false },
            }
        });
        Ok(ways.reduce(|one, other| BlindWay {
            levels: Level::lower(&one.levels, &other.levels),
            is_at_top: one.is_at_top && other.is_at_top,
        }))
    }

    /// Returns the levels of the tip at joint values while rotary axes turn by angles that are not known: below all at a link or part
    /// that tilts.
    fn levels_while(
        &self,
        chain: &Chain,
        joints: &Joints,
        turns: &dyn Fn(usize) -> bool,
    ) -> Vec<Level> {
        // The links before the first axis of the table that tilts keep their levels, if the head tilts no tool.
        let table = || self.machine.axes().iter().filter(|axis| axis.side == Side::Table);
        let level_links = self.tilting(turns).map(|axis| match axis.side {
            Side::Table => table().take_while(|other| other.letter != axis.letter).count() + 1,
            Side::Tool => 0,
        });
        let level_links = level_links.min().unwrap_or(usize::MAX);
        // Axes about Z turn the part, and change no height while it is not tilted.
        let is_turning = self.rotary_axes(turns).any(|axis| !axis.tilts());
        let mut levels = self.levels(chain, joints);
        for (link, level) in levels.iter_mut().enumerate() {
            if link >= level_links || is_turning && level.up != Vector3::z() {
                *level = Level::BELOW;
            }
        }
        levels
    }

    /// Returns the rotary axes that turn.
    fn rotary_axes<'s>(
        &'s self,
        turns: &'s dyn Fn(usize) -> bool,
    ) -> impl Iterator<Item = &'s Axis> {
        let rotary = self.machine.axes().iter().filter(|axis| axis.letter.is_rotary());
        rotary.filter(|axis| turns(axis.letter.index()))
    }

    /// Returns the axes that turn, and tilt the part or the tool.
    fn tilting<'s>(&'s self, turns: &'s dyn Fn(usize) -> bool) -> impl Iterator<Item = &'s Axis> {
        self.rotary_axes(turns).filter(|axis| axis.tilts())
    }

    /// Returns the levels of the tip at joint values, relative to each link of the table and to the part.
    pub(super) fn levels(&self, chain: &Chain, joints: &Joints) -> Vec<Level> {
        let links = (0..chain.link()).map(|link| chain.relative_to(link));
        let level = |chain: Chain| level(&chain.without_linear_limits(), joints).ok();
        let levels = links.chain([Ok(*chain)]).map(|chain| chain.ok().and_then(level));
        levels.map(|level| level.unwrap_or(Level::BELOW)).collect()
    }
}

/// Returns the level of the tip at joint values.
fn level(chain: &Chain, joints: &Joints) -> Result<Level, StepFault> {
    let mut above = *joints;
    above[2] += 1.0;
    let [pose, above] = [chain.pose(joints)?, chain.pose(&above)?];
    // A link that Z of the table does not carry stands still while that moves.
    let mut up = (above.tip() - pose.tip()).try_normalize(UPRIGHT).unwrap_or_else(Vector3::z);
    if (up - Vector3::z()).norm() <= UPRIGHT {
        up = Vector3::z();
    }
    // X and Y leave the level of a tool along Z of the machine, unless a tilted table carries them, and any part of the tool is beyond
    // its tip.
    let is_along = (pose.axis() - up).norm() <= UPRIGHT;
    let height = pose.tip().coords.dot(&up);
    for k in [0, 1] {
        let mut beside = *joints;
        beside[k] += 1.0;
        let change = chain.pose(&beside)?.tip().coords.dot(&up) - height;
        if change.abs() > UPRIGHT {
            return Ok(Level { up, ..Level::BELOW });
        }
    }
    let height = if is_along { height } else { f64::NEG_INFINITY };
    Ok(Level { up, height })
}
