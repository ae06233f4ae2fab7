//! G-code for a machine: the rotary axes follow from its inverse kinematics, and the tip is programmed in the frame of
//! the part, with tool centre point control. Of both solutions at each cutter location those are taken whose rotary axes
//! travel least along the path.

mod prove;

pub use prove::{Location, PathProver, planning_rules};

use crate::path::ToolAxisLimits;
use nalgebra::{Point3, Vector3};
use std::collections::BTreeMap;
use std::fmt::Write;
use touchoff::{Motion, MotionError, Pose, Unit};
use touchoff_verify::gcode::{Choice, ControlRules, ControlSetup, Rule};
use touchoff_verify::machine::{Chain, InverseError, JointError, Joints, Letter, Machine, Setup};
use touchoff_verify::program::Decimals;
use touchoff_verify::{Finding, MachineProgram, MachineProgramError, ToolSelection, VerifyError};

/// Largest number of times that the motion between two cutter locations is halved.
const MAX_HALVINGS: u32 = 8;

/// Number of halvings after which a motion with much travel of the rotary axes is led away from the part.
const HALVINGS_BEFORE_REWIND: u32 = 3;

/// Angle in radians from the great circle beyond which a motion is halved without a check.
const ASTRAY: f64 = 0.1;

/// Travel of the rotary axes, in degrees, that makes a motion a turn at a limit.
const REWIND_TRAVEL: f64 = 60.0;

/// Decimals of rotary words: half of 1e-6° moves a point at 300 mm from the tip by 3e-6 mm.
const ANGLE_DECIMALS: usize = 6;

/// Angle in radians from +z below which the tool axis at the end of a path counts as upright.
const UPRIGHT: f64 = 1e-6;

/// Words of a program besides its motions.
#[derive(Clone, Copy, Debug)]
pub struct Words {
    /// The tool's number.
    pub tool_number: u32,
    /// Feed per minute, in the part's unit.
    pub feed: f64,
    /// Revolutions per minute.
    pub spindle: Option<f64>,
}

/// The place of the part and of the tool on a machine. Lengths are in the part's unit.
#[derive(Clone, Copy, Debug)]
pub struct Placed {
    /// The origin of the part in machine coordinates (G54).
    pub work_offset: Point3<f64>,
    /// The distance from the tip to the gauge point of the spindle.
    pub tool_length: f64,
}

/// A reason for which a path is not written as a program.
#[derive(thiserror::Error)]
#[non_exhaustive]
pub enum PostError {
    /// A motion is not proved as it would be written.
    #[error(
        "{file}: the motion to cutter location {location} is not proved as it would be written, so nothing was \
         written: {reason}: raise `--tolerance`, or sweep and plan again with another stepover or `--max-tilt`"
    )]
    NotProved {
        /// The file that would be written, with the line if there is one.
        file: String,
        /// The planned cutter location, from 1.
        location: usize,
        /// The finding.
        reason: String,
    },
    /// The machine does not reach a cutter location.
    #[error(
        "`{machine}` does not reach cutter location {location}, with the axis {:.6},{:.6},{:.6}: {source}",
        .axis[0], .axis[1], .axis[2]
    )]
    Unreachable {
        /// The machine's name.
        machine: String,
        /// The planned cutter location, from 1.
        location: usize,
        /// The tool axis.
        axis: [f64; 3],
        /// The reason.
        source: InverseError,
    },
    /// An axis of the machine leaves its limits on the way to a cutter location.
    #[error(
        "`{machine}`: {letter} goes to {value:.4} on the way to cutter location {location}, beyond its limit of {limit}: \
         correct `--work-offset`, or limit the axis with `--max-tilt`"
    )]
    AxisLimit {
        /// The machine's name.
        machine: String,
        /// The planned cutter location, from 1.
        location: usize,
        /// The axis.
        letter: Letter,
        /// The joint value, in mm or degrees.
        value: f64,
        /// The limit, in mm or degrees.
        limit: f64,
    },
    /// The path cannot be verified.
    #[error(transparent)]
    Verify(#[from] VerifyError),
    /// An offset is out of range.
    #[error(transparent)]
    Joint(#[from] JointError),
    /// A motion is ambiguous.
    #[error(transparent)]
    Motion(#[from] MotionError),
    /// The program is refused when it is read again.
    #[error(transparent)]
    Program(#[from] MachineProgramError),
}

touchoff::debug_as_sentence!(PostError);

/// A post-processor for a machine.
#[derive(Debug)]
pub struct Post {
    machine: Machine,
    /// The chain of the inverse kinematics.
    chain: Chain,
    /// The same without the limits of the linear axes.
    rotary_chain: Chain,
    control: ControlSetup,
    unit: Unit,
    words: Words,
}

/// A cutter location of the program.
#[derive(Clone, Copy)]
struct PostedLocation {
    pose: Pose,
    rapid: bool,
    /// Index of the planned cutter location at which the motion ends.
    planned: usize,
    /// Number of times that the planned motion was halved.
    halvings: u32,
}

/// The text of a program.
struct PostedText {
    text: String,
    /// Number of lines before the first motion. Then each cutter location has one line.
    header_lines: usize,
    locations: usize,
}

impl PostedText {
    /// Returns the index of the cutter location of a line; of lines before and after all of them, the nearest.
    fn location(&self, line: usize) -> usize {
        line.saturating_sub(self.header_lines + 1).min(self.locations - 1)
    }
}

/// The reason for which the motion to a cutter location is divided.
enum Fault<'f> {
    /// In its middle the tool axis is far off the great circle.
    Astray,
    /// It is not proved.
    Found(&'f Finding),
}

impl Fault<'_> {
    /// Returns the failure for a motion that cannot be divided any further.
    fn failure(&self, prover: &PathProver<'_>, location: &PostedLocation) -> PostError {
        match self {
            Fault::Astray => {
                let reason =
                    "the rotary axes turn far, and there is no way out along the tool axis";
                prover.refusal(None, location.planned, reason.to_owned())
            }
            Fault::Found(finding) => prover.failure(finding, location.planned),
        }
    }
}

impl Post {
    /// Creates a post-processor for a part in a unit of length. Without a place the limits of the linear axes are not
    /// checked.
    ///
    /// # Errors
    /// If an offset is out of range.
    pub fn new(
        machine: Machine,
        placed: Option<Placed>,
        words: Words,
        unit: Unit,
    ) -> Result<Post, PostError> {
        // The program leaves one choice to the control: that rapid traverse is a straight line is part of what is proved.
        let rules = ControlRules::default()
            .with(Rule::Rapid, Choice::Straight)
            .with(Rule::ToolChange, Choice::Moves);
        let mut control = ControlSetup { rules, ..ControlSetup::default() };
        let in_mm = unit.millimetres();
        let chain = match placed {
            Some(Placed { work_offset: offset, tool_length: length }) => {
                let [x, y, z] = [offset.x, offset.y, offset.z].map(|value| value * in_mm);
                let work_offset = [x, y, z, 0.0, 0.0, 0.0];
                control.work_offsets[0] = Some(work_offset);
                control.lengths = BTreeMap::from([(words.tool_number, length * in_mm)]);
                machine.chain(&Setup { work_offset, tool_length: length * in_mm })?
            }
            None => machine.chain(&Setup::default())?.without_linear_limits(),
        };
        let rotary_chain = chain.without_linear_limits();
        Ok(Post { machine, chain, rotary_chain, control, unit, words })
    }

    /// Returns the text of the program for cutter locations, and the cutter locations that it has.
    ///
    /// Between two cutter locations the control interpolates joints, so that the tool axis leaves the great circle. A
    /// motion in which it is therefore too deep is halved on the great circle. If the rotary axes turn far in it
    /// nevertheless, since one of them is at a limit, the tool turns away from the part.
    ///
    /// # Errors
    /// If the machine does not reach a cutter location, if a motion leaves the limits of an axis, or if a motion is not
    /// proved.
    pub fn program(
        &self,
        prover: &PathProver<'_>,
        locations: &[Location],
        file: &str,
    ) -> Result<(String, Vec<Location>), PostError> {
        let posted = locations.iter().enumerate().map(|(planned, (pose, rapid))| PostedLocation {
            pose: *pose,
            rapid: *rapid,
            planned,
            halvings: 0,
        });
        let mut locations: Vec<PostedLocation> = posted.collect();
        loop {
            let joints = self.joints(&locations)?;
            let astray = self.astray(&locations, &joints, prover)?;
            if !astray.is_empty() {
                locations = refined(&locations, &joints, &astray, prover)?;
                continue;
            }
            let posted = self.text(&locations, &joints);
            // The text is read as any other program is, so that what is proved is what is written.
            let program = MachineProgram::new(
                file,
                posted.text.clone(),
                self.machine.clone(),
                self.control.clone(),
            )?;
            program.check_complete()?;
            if let Some((block, violation)) = program.summary().limits.first() {
                return Err(PostError::AxisLimit {
                    machine: self.machine.name().to_owned(),
                    location: locations[posted.location(block.line)].planned + 1,
                    letter: violation.letter,
                    value: violation.value,
                    limit: violation.limit,
                });
            }
            let findings =
                prover.findings(program.moves(ToolSelection::All, None, self.unit)?)?;
            if findings.is_empty() {
                let moves = program.moves(ToolSelection::All, None, self.unit)?;
                let in_stock = prover.findings_in_stock(moves)?;
                let Some(first) = in_stock.first() else {
                    let locations =
                        locations.iter().map(|location| (location.pose, location.rapid)).collect();
                    return Ok((posted.text, locations));
                };
                // Several surfaces may be in the stock on one motion. Each round changes a motion to feed, so the loop ends;
                // the way home is none of them.
                let mut has_changed = false;
                for finding in &in_stock {
                    let location = &mut locations[posted.location(finding.line)];
                    has_changed |= std::mem::replace(&mut location.rapid, false);
                }
                if !has_changed {
                    let location = posted.location(first.line);
                    return Err(prover.failure(first, locations[location].planned));
                }
                continue;
            }
            let mut found = BTreeMap::new();
            for finding in &findings {
                found.entry(posted.location(finding.line)).or_insert(Fault::Found(finding));
            }
            locations = refined(&locations, &joints, &found, prover)?;
        }
    }

    /// Returns the motions near the part in whose middle the tool axis is far off the great circle, by the indices of
    /// the cutter locations at which they end, as far as they can be halved. To check them would take long, and would
    /// find them too deep.
    fn astray(
        &self,
        locations: &[PostedLocation],
        joints: &[Joints],
        prover: &PathProver<'_>,
    ) -> Result<BTreeMap<usize, Fault<'static>>, PostError> {
        let mut astray = BTreeMap::new();
        for index in 1..locations.len() {
            let [from, to] = [&locations[index - 1], &locations[index]];
            let is_free = prover.is_away(&from.pose) && prover.is_away(&to.pose);
            if is_free || to.halvings >= MAX_HALVINGS {
                continue;
            }
            let middle: Joints =
                std::array::from_fn(|k| 0.5 * (joints[index - 1][k] + joints[index][k]));
            let axis = self.chain.pose(&middle)?.axis();
            let motion = Motion::new(&from.pose, &to.pose)?;
            if axis.angle(&motion.pose(0.5).axis()) > ASTRAY {
                astray.insert(index, Fault::Astray);
            }
        }
        Ok(astray)
    }

    /// Writes the program.
    fn text(&self, locations: &[PostedLocation], joints: &[Joints]) -> PostedText {
        let Words { tool_number, feed, spindle } = &self.words;
        // G-code has no metres.
        let unit = if self.unit == Unit::Inch { Unit::Inch } else { Unit::Millimetre };
        let scale = self.unit.factor_to(unit);
        let decimals = Decimals::of(unit).tip;
        let rotary: Vec<Letter> = Letter::ALL
            .into_iter()
            .filter(|l| l.is_rotary() && self.machine.axis(*l).is_some())
            .collect();
        let system = if unit == Unit::Inch { "G20" } else { "G21" };
        let mut text = format!("{system} G90 G94 G54\nT{tool_number} M6\n");
        if let Some(speed) = spindle {
            let _ = writeln!(text, "S{speed} M3");
        }
        let length = if rotary.is_empty() { "G43" } else { "G43.4" };
        let _ = writeln!(text, "{length} H{tool_number}");
        let header_lines = text.lines().count();
        let mut has_feed = false;
        for (location, joints) in locations.iter().zip(joints) {
            let tip = location.pose.tip() * scale;
            text += if location.rapid { "G0" } else { "G1" };
            for (letter, value) in [Letter::X, Letter::Y, Letter::Z].into_iter().zip(tip.iter()) {
                let _ = write!(text, " {letter}{}", word(*value, decimals));
            }
            for letter in &rotary {
                let _ = write!(text, " {letter}{}", word(joints[letter.index()], ANGLE_DECIMALS));
            }
            // The feed is modal: one word holds for all of the program.
            if !location.rapid && !std::mem::replace(&mut has_feed, true) {
                let _ = write!(text, " F{}", word(feed * scale, decimals));
            }
            text.push('\n');
        }
        // A control can keep the length offset and tool centre point control for its next program, and G53 is refused
        // under the latter.
        text += "G49\nM5\n";
        // Above the part the way home is along the tool axis. From elsewhere it is the operator's.
        let last = locations.last().map(|location| location.pose.axis());
        if last.is_some_and(|axis| axis.angle(&Vector3::z()) < UPRIGHT) {
            self.write_home(&mut text, unit);
        }
        text += "M30\n";
        PostedText { text, header_lines, locations: locations.len() }
    }

    /// Writes the way home: Z first, then X and Y together. The rotary axes stay: one without limits can have many turns
    /// to unwind.
    fn write_home(&self, text: &mut String, unit: Unit) {
        let scale = Unit::Millimetre.factor_to(unit);
        let [x, y, z] = [Letter::X, Letter::Y, Letter::Z].map(|letter| {
            let home = self.machine.home()[letter.index()];
            let number = home.map(|value| word(value * scale, Decimals::of(unit).tip));
            number.map_or_else(String::new, |number| format!(" {letter}{number}"))
        });
        if z.is_empty() {
            // The machine's file does not state it, but the control knows its reference position.
            *text += "G91 G28 Z0.\nG90\n";
            return;
        }
        let _ = writeln!(text, "G53 G0{z}");
        if !(x.is_empty() && y.is_empty()) {
            let _ = writeln!(text, "G53 G0{x}{y}");
        }
    }

    /// Returns the joint values of cutter locations.
    fn joints(&self, locations: &[PostedLocation]) -> Result<Vec<Joints>, PostError> {
        let targets = locations.iter().map(|location| Target {
            tip: location.pose.tip() * self.unit.millimetres(),
            axis: location.pose.axis(),
            rapid: location.rapid,
        });
        let targets: Vec<Target> = targets.collect();
        let home = self.machine.home().map(|value| value.unwrap_or(0.0));
        sequence(&self.chain, &targets, home).map_err(|(index, source)| PostError::Unreachable {
            machine: self.machine.name().to_owned(),
            location: locations[index].planned + 1,
            axis: targets[index].axis.into(),
            source,
        })
    }
}

impl ToolAxisLimits for Post {
    fn allow(&self, axis: &Vector3<f64>) -> bool {
        // Without limits of the linear axes the tip does not matter, and limits of rotary axes count whole turns.
        self.rotary_chain.solutions(&Point3::origin(), axis, &[0.0; 6]).is_ok()
    }
}

/// Inserts cutter locations into motions with a fault, by the indices of the cutter locations at which they end.
///
/// # Errors
/// The fault's failure, if a motion was halved as often as allowed, or cannot be.
fn refined(
    locations: &[PostedLocation],
    joints: &[Joints],
    faults: &BTreeMap<usize, Fault<'_>>,
    prover: &PathProver<'_>,
) -> Result<Vec<PostedLocation>, PostError> {
    let mut refined = Vec::with_capacity(locations.len() + faults.len());
    for (index, location) in locations.iter().enumerate() {
        let Some(fault) = faults.get(&index) else {
            refined.push(*location);
            continue;
        };
        let failure = || fault.failure(prover, location);
        // The first motion begins at the home position, which is no cutter location to halve from.
        let from = index.checked_sub(1).ok_or_else(failure)?;
        if location.halvings >= MAX_HALVINGS {
            return Err(failure());
        }
        let (before, travel) = (&locations[from], rotary_travel(&joints[from], &joints[index]));
        if location.halvings >= HALVINGS_BEFORE_REWIND && travel > REWIND_TRAVEL {
            // Away from the part the axes may turn as they like: none of these motions is halved again.
            let last = PostedLocation { halvings: MAX_HALVINGS, ..*location };
            let [out, back] = [before, location].map(|l| prover.away(&l.pose));
            let ([lead, outer], [lead_back, outer_back]) = out.zip(back).ok_or_else(failure)?;
            let inserted = [(lead, false), (outer, true), (outer_back, true), (lead_back, true)];
            refined.extend(inserted.into_iter().map(|(pose, rapid)| PostedLocation {
                pose,
                rapid,
                ..last
            }));
            refined.push(last);
        } else {
            let motion = Motion::new(&before.pose, &location.pose)?;
            let last = PostedLocation { halvings: location.halvings + 1, ..*location };
            refined.extend([PostedLocation { pose: motion.pose(0.5), ..last }, last]);
        }
    }
    Ok(refined)
}

/// Formats the number of a word: with a decimal point, since some controls count numbers without one in thousandths.
fn word(value: f64, decimals: usize) -> String {
    let fixed = format!("{value:.decimals$}");
    let short = fixed.trim_end_matches('0');
    if short == "-0." { "0.".to_owned() } else { short.to_owned() }
}

/// A cutter location: the tip in mm and the tool axis, in the frame of the part.
struct Target {
    tip: Point3<f64>,
    axis: Vector3<f64>,
    rapid: bool,
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
fn sequence(
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
    // The cheapest of the candidates with the same joint values is kept: all of them go on alike.
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
fn rotary_travel(from: &Joints, to: &Joints) -> f64 {
    (3..6).map(|k| (to[k] - from[k]).abs()).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_have_a_point_and_no_negative_zero() {
        for (value, text) in [(10.0, "10."), (-0.000_001, "0."), (-2.5, "-2.5"), (1e7, "10000000.")]
        {
            assert_eq!(word(value, 5), text);
        }
    }

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
