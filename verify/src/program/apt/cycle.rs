//! Cycles and arcs of APT-CL, as positions.
//!
//! `CYCLE/DRILL,FEDTO,5.,MMPM,125.,RAPTO,3.,RTRCTO,25.,DWELL,0` drills at each `GOTO` after it, up to `CYCLE/OFF`: the tool moves at its
//! height over the point, in rapid traverse to `RAPTO` above it, at feed rate to `FEDTO` below it, and back to `RTRCTO` above it. Lengths
//! are along the tool axis, from the point. Creo's words for them are `DEPTH`, `CLEAR` and `RETURN`. NX writes `DRILL,DEEP` and
//! `DRILL,BRKCHP`, and changes single lengths by `CYCLE/ON`.
//!
//! `CIRCLE/xc,yc,zc,i,j,k` states the centre of the arc to the next `GOTO` and the normal of its plane, about which it turns
//! counter-clockwise, but clockwise in files of NX. `MOVARC` of Autodesk's post processors states the angle of the turn as well. CATIA
//! states the direction at the start, `INDIRV/x,y,z`, then circle and end, `TLON,GOFWD/(CIRCLE/xc,yc,zc,r),ON,(LINE/xc,yc,zc,x,y,z)`, where
//! `ON,2,INTOF` tells an arc of more than half a turn. Arcs become chords.

use super::super::{ProgramFault, number};
use nalgebra::{Point3, Vector3};
use std::collections::HashSet;
use std::f64::consts::{PI, TAU};
use touchoff::{Pose, Unit};

/// Distance between an arc and its chords, in mm.
const CHORD_TOLERANCE: f64 = 2e-5;

/// Largest number of chords of an arc, as in G-code.
const MAX_CHORDS: f64 = 100_000.0;

/// Largest difference of the radii at the ends of an arc, and of the ways that controls make of it, in mm.
const RADII: f64 = 1e-3;

/// Least step of coordinates, in mm. An arc between two positions that are nearer can be a whole turn.
const LEAST_STEP: f64 = 5e-4;

/// Largest distance of two positions that are the same up to rounding, in the unit of the program.
const SAME: f64 = 1e-6;

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
    /// Reads the arguments of `CYCLE`, which may change the cycle in force; `None` for its end.
    pub(super) fn read(
        arguments: &str,
        in_force: Option<&Cycle>,
    ) -> Result<Option<Cycle>, ProgramFault> {
        let upper = arguments.to_ascii_uppercase();
        let mut words = upper.split(',').map(str::trim).peekable();
        let kind = words.next().unwrap_or_default();
        let refused = |word: &str| ProgramFault::Cycle { word: super::unquoted(word) };
        let (mut depth, mut rapid_to, mut retract) = (None, 0.0, Retract::RapidTo);
        let feeds_out = match (kind, in_force) {
            ("OFF" | "NOMORE" | "INIT", _) => return Ok(None),
            ("DRILL", _) => {
                words.next_if(|word| matches!(*word, "DEEP" | "BRKCHP"));
                false
            }
            ("DEEP" | "BRKCHP" | "FACE", _) => false,
            ("TAP" | "REAM" | "BORE", _) => true,
            ("ON", Some(cycle)) => {
                (depth, rapid_to, retract) = (Some(cycle.depth), cycle.rapid_to, cycle.retract);
                cycle.feeds_out
            }
            (other, _) => return Err(refused(other)),
        };
        let mut start = None;
        while let Some(word) = words.next() {
            let mut value = || words.next().ok_or_else(|| refused(word)).and_then(number);
            match word {
                "FEDTO" | "DEPTH" => depth = Some(value()?.abs()),
                // One of two may count from the other.
                "RAPTO" | "CLEAR" if start.replace(word).is_none() => rapid_to = value()?,
                "RTRCTO" | "RETURN" => {
                    let word = words.next().unwrap_or_default();
                    retract = match word {
                        "AUTO" => Retract::Before,
                        "NONE" => Retract::RapidTo,
                        height => Retract::To(number(height)?),
                    };
                }
                // The feed, and times and amounts on the way down.
                "MMPM" | "IPM" | "MMPR" | "IPR" | "PERMIN" | "PERREV" | "DWELL" | "STEP"
                | "INCR" => drop(value()?),
                other => return Err(refused(other)),
            }
        }
        let Some(depth) = depth.filter(|depth| *depth > 0.0) else {
            return Err(refused("a cycle without FEDTO or DEPTH"));
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
            // Some controls move over the hole first, and some rise first.
            let aside = before.tip() - point.tip() - level * axis;
            if aside.norm() > SAME {
                let word = "a hole above the level before it, to which controls go in two ways,"
                    .to_owned();
                return Err(ProgramFault::Cycle { word });
            }
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
    direction: Direction,
    /// The angles up to the last position on the arc, and between two of them, where several are on it.
    turned: f64,
    step: f64,
}

/// The statement from which the direction of an arc follows.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Direction {
    /// The normal: the arc turns counter-clockwise about it.
    Normal,
    /// The angle of the turn, in radians, where it fits one direction only.
    Angle(f64),
    /// The normal, if other arcs prove that those of the file state directions.
    Unproved,
}

/// Evidence about the normals of `MOVARC`: newer post processors turn the normal of a clockwise arc, older ones state one normal for both
/// directions.
#[derive(Default)]
pub(super) struct Normals {
    /// The normals with the tool axes, in steps of [`Normals::STEP`].
    known: HashSet<[Vector3<i32>; 2]>,
    is_proved: bool,
    /// Set if an arc turns clockwise about its normal.
    is_refuted: bool,
    /// The line of the first arc that fits both directions.
    open: Option<usize>,
}

impl Normals {
    const STEP: f64 = 1e-4;

    /// Adds an arc as the file states it, and as its angle turns it.
    pub(super) fn add(&mut self, line: usize, stated: &Arc, turned: &Arc, ends: [&Pose; 2]) {
        if stated.direction == Direction::Normal {
            return;
        }
        let [before, end] = ends;
        let is_open = stated.fits_both_ways(before, end);
        if is_open {
            self.open.get_or_insert(line);
        }
        let is_turned = !is_open && stated.normal != turned.normal;
        self.is_refuted |= is_turned;
        let axis = end.axis();
        let rounded = |vector: Vector3<f64>| vector.map(|part| (part / Self::STEP).round() as i32);
        // A counter-clockwise arc has the same normal in files of both kinds.
        let is_clockwise = stated.normal.dot(&axis) < Self::STEP - 1.0;
        let is_opposite = self.known.contains(&[-stated.normal, axis].map(rounded));
        self.is_proved |= !is_turned && (is_clockwise || is_opposite);
        self.known.insert([stated.normal, axis].map(rounded));
    }

    /// Returns the line of the first arc whose direction the file does not tell.
    pub(super) fn ambiguous(&self) -> Option<usize> {
        self.open.filter(|_| self.is_refuted || !self.is_proved)
    }
}

/// Largest difference between a stated angle and that of an arc's ends, in radians.
const ANGLE_TOLERANCE: f64 = 1e-2;

impl Arc {
    fn new([x, y, z]: [f64; 3], normal: [f64; 3]) -> Result<Arc, ProgramFault> {
        let normal = Vector3::from(normal);
        match (normal.norm() - 1.0).abs() < 1e-3 {
            true => {
                let centre = Point3::new(x, y, z);
                let normal = normal.normalize();
                Ok(Arc { centre, normal, direction: Direction::Normal, turned: 0.0, step: 0.0 })
            }
            false => Err(arc("has a normal that is no unit vector")),
        }
    }

    /// Reads the arguments of `CIRCLE`: the centre and the normal, and possibly the radius, which follows from the ends. NX adds four
    /// numbers about tolerances and the tool.
    pub(super) fn circle(arguments: &str, is_nx: bool) -> Result<Arc, ProgramFault> {
        let values = arguments.split(',').map(number).collect::<Result<Vec<f64>, _>>()?;
        let (6 | 7 | 11, &[x, y, z, i, j, k, ..]) = (values.len(), &values[..]) else {
            return Err(arc("has other numbers than a centre and a normal"));
        };
        Arc::new([x, y, z], if is_nx { [-i, -j, -k] } else { [i, j, k] })
    }

    /// Reads the arguments of `MOVARC`: centre, normal, radius and angle in degrees, or the first three by their names.
    pub(super) fn movarc(arguments: &str) -> Result<Arc, ProgramFault> {
        let upper = arguments.to_ascii_uppercase();
        let words: Vec<&str> = upper.split(',').map(str::trim).collect();
        let (place, angle) = match &words[..] {
            ["CENTER", x, y, z, "AXIS", i, j, k, "RADIUS", _] => ([x, y, z, i, j, k], None),
            [x, y, z, i, j, k, _, "ANGLE", angle] => ([x, y, z, i, j, k], Some(number(angle)?)),
            _ => return Err(arc("has other arguments than centre, normal, radius and angle")),
        };
        let mut values = [0.0; 6];
        for (value, word) in values.iter_mut().zip(place) {
            *value = number(word)?;
        }
        let [x, y, z, i, j, k] = values;
        let angle = angle.map(|angle| Direction::Angle(angle.abs().to_radians()));
        let direction = angle.unwrap_or(Direction::Unproved);
        Ok(Arc { direction, ..Arc::new([x, y, z], [i, j, k])? })
    }

    /// Reads the arguments of CATIA's `TLON,GOFWD`, the arc from a position in a direction, and returns it with its end.
    pub(super) fn catia(
        arguments: &str,
        from: &Pose,
        direction: Vector3<f64>,
    ) -> Result<(Arc, Pose), ProgramFault> {
        let text: String = arguments.chars().filter(|c| !c.is_whitespace()).collect();
        let text = text.to_ascii_uppercase().replace("ON,2,INTOF", "INTOF");
        let cells = text.split([',', '(', ')', '/']).filter(|cell| !cell.is_empty());
        let (numbers, words): (Vec<&str>, Vec<&str>) = cells.partition(|cell| number(cell).is_ok());
        let values = numbers.into_iter().map(number).collect::<Result<Vec<f64>, _>>()?;
        let (["CIRCLE", side @ ("ON" | "INTOF"), "LINE"], &[xc, yc, zc, _, _, _, _, x, y, z]) =
            (&words[..], &values[..])
        else {
            return Err(arc("of CATIA is not understood"));
        };
        let centre = Point3::new(xc, yc, zc);
        let Some(normal) = (from.tip() - centre).cross(&direction).try_normalize(0.0) else {
            return Err(arc("begins in no direction"));
        };
        let end = Pose::from_axis(Point3::new(x, y, z), from.axis())?;
        let direction = Direction::Normal;
        let found = Arc { centre, normal, direction, turned: 0.0, step: 0.0 };
        // The line through centre and end meets the circle twice.
        let is_long = found.turn(from, &end) > PI - ANGLE_TOLERANCE;
        let is_short = found.turn(from, &end) < PI + ANGLE_TOLERANCE;
        match if *side == "ON" { is_short } else { is_long } {
            true => Ok((found, end)),
            false => Err(arc("ends elsewhere than its line says")),
        }
    }

    /// Returns the angle from a position to another about the normal: above 0, and a whole turn between positions of one point of the
    /// circle.
    fn turn(&self, from: &Pose, to: &Pose) -> f64 {
        let [from, to] = [from, to].map(|pose| self.arm(pose).0);
        if (to - from).norm() <= SAME {
            return TAU;
        }
        from.cross(&to).dot(&self.normal).atan2(from.dot(&to)).rem_euclid(TAU)
    }

    /// Returns the angle of the turn about the normal; `None` if the arc states another one.
    fn sweep(&self, before: &Pose, end: &Pose) -> Option<f64> {
        let turn = self.turn(before, end);
        let Direction::Angle(angle) = self.direction else { return Some(turn) };
        // Rounding may put the end of a whole turn behind its start.
        let beyond = Some(turn + TAU).filter(|_| turn <= ANGLE_TOLERANCE);
        let mut sweeps = [Some(turn), beyond].into_iter().flatten();
        sweeps.find(|sweep| (sweep - angle).abs() <= ANGLE_TOLERANCE)
    }

    /// Returns the distance of two positions in the plane of the arc.
    fn gap(&self, before: &Pose, end: &Pose) -> f64 {
        (self.arm(before).0 - self.arm(end).0).norm()
    }

    /// Returns whether the arc can turn in both directions: without an angle, or with that of half a turn or of a whole one of a helix.
    fn fits_both_ways(&self, before: &Pose, end: &Pose) -> bool {
        let rises = (self.arm(before).1 - self.arm(end).1).abs() > SAME;
        match self.direction {
            Direction::Normal => false,
            // Both ways around a whole circle are one.
            Direction::Unproved => rises || self.gap(before, end) > SAME,
            Direction::Angle(angle) => {
                (angle - PI).abs() <= 2.0 * ANGLE_TOLERANCE
                    || rises && angle > TAU - 2.0 * ANGLE_TOLERANCE
            }
        }
    }

    /// Returns the way from the axis of the arc to a position, and its height along the axis.
    fn arm(&self, pose: &Pose) -> (Vector3<f64>, f64) {
        let arm = pose.tip() - self.centre;
        let height = arm.dot(&self.normal);
        (arm - height * self.normal, height)
    }

    /// Returns the arc from a position on to another, if both are on it: Creo states several, three or more of a whole circle, equally far
    /// from each other. A longer way is a chord of a straight motion.
    ///
    /// # Errors
    /// If the way is shorter: it may be the rest of the arc, or a chord.
    pub(super) fn continued(
        &self,
        before: &Pose,
        end: &Pose,
        unit: Option<Unit>,
    ) -> Result<Option<Arc>, ProgramFault> {
        let turn = self.turn(before, end);
        let is_left =
            turn < self.step + ANGLE_TOLERANCE && self.turned + turn < TAU + ANGLE_TOLERANCE;
        let moves = self.gap(before, end) >= LEAST_STEP / scale(unit);
        let is_straight = (before.axis() - end.axis()).norm() <= 1e-9;
        let is_on = is_straight && self.radii(before, end, unit).is_some();
        if !(is_left && moves && is_on) {
            return Ok(None);
        }
        match turn > self.step - ANGLE_TOLERANCE {
            true => Ok(Some(*self).filter(|_| turn < TAU / 3.0 + ANGLE_TOLERANCE)),
            false => Err(arc(
                "has a nearer position behind others at equal distances, to which it or a straight line may lead",
            )),
        }
    }

    /// Returns the radii at two positions, if they are one up to rounding.
    fn radii(&self, before: &Pose, end: &Pose, unit: Option<Unit>) -> Option<[f64; 2]> {
        let arms = [before, end].map(|pose| self.arm(pose).0);
        let radii = arms.map(|arm| arm.norm());
        let difference = (radii[0] - radii[1]).abs();
        // A control that moves the centre, so that both radii are one, moves it along the chord.
        let shift = match difference > 0.0 {
            true => difference * (radii[0] + radii[1]) / (2.0 * (arms[0] - arms[1]).norm()),
            false => 0.0,
        };
        let is_one = difference.max(shift) <= RADII / scale(unit);
        (radii[0] > 0.0 && is_one).then_some(radii)
    }

    /// Returns the positions along the arc, the last of which is its end, and the arc on from there. `chords` is the number of chords of
    /// the arcs before it.
    ///
    /// # Errors
    /// If the ends and the arc contradict each other, or if there are too many chords.
    pub(super) fn stops(
        mut self,
        before: Option<&Pose>,
        end: &Pose,
        unit: Option<Unit>,
        chords: usize,
    ) -> Result<(Vec<Pose>, Arc), ProgramFault> {
        let Some(before) = before else {
            return Err(arc("begins at no position"));
        };
        let axis = end.axis();
        if (before.axis() - axis).norm() > 1e-9 {
            return Err(arc("turns the tool axis"));
        }
        let Some([start_radius, end_radius]) = self.radii(before, end, unit) else {
            return Err(arc("has another radius at its start than at its end"));
        };
        let gap = self.gap(before, end);
        let states_angle = matches!(self.direction, Direction::Angle(_));
        if gap > SAME && gap < LEAST_STEP / scale(unit) && !states_angle {
            return Err(arc("ends so near its start that it could be a whole turn"));
        }
        let mut found = self.sweep(before, end);
        if found.is_none() {
            // Older post processors state one normal for both directions.
            self.normal = -self.normal;
            found = self.sweep(before, end);
        }
        let sweep = found.ok_or(arc("has another angle than its ends"))?;
        let [(from, low), (_, high)] = [before, end].map(|pose| self.arm(pose));
        let angle =
            (8.0 * CHORD_TOLERANCE / scale(unit) / start_radius.max(end_radius)).sqrt().min(0.1);
        let count = (sweep / angle).ceil().max(1.0);
        if count > MAX_CHORDS {
            let [degrees, limit] = [sweep, MAX_CHORDS * angle].map(f64::to_degrees);
            return Err(ProgramFault::LongArc { degrees, limit });
        }
        if chords + count as usize > super::MAX_ALL_CHORDS {
            return Err(ProgramFault::ManyChords);
        }
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
        let poses = poses.chain([Ok(*end)]).collect::<Result<_, ProgramFault>>()?;
        let step = if self.step == 0.0 { sweep } else { self.step };
        Ok((poses, Arc { turned: self.turned + sweep, step, ..self }))
    }
}

/// Returns the millimetres of a unit. A program without one is read as in millimetres, and arcs in it fit no part in another unit
/// (`ClData::check_unit`).
fn scale(unit: Option<Unit>) -> f64 {
    unit.unwrap_or(Unit::Millimetre).millimetres()
}

fn arc(what: &'static str) -> ProgramFault {
    ProgramFault::Arc { what }
}
