//! Cycles: drilling, reaming, boring, tapping and bore milling, and the calls of a cycle.
//!
//! A cycle moves in rapid traverse along Z to the set-up clearance (Q200) over the surface (Q203), at feed rate to its depth (Q201)
//! and back, and to the second set-up clearance (Q204) if that is higher (TNC 640, *Cycle programming*, "Fixed cycles: drilling").
//! The depths of infeeds are from the surface; between them the tool leaves the hole, and returns in rapid traverse to the set-up
//! clearance over the depth that was reached (200, 203), or to the advanced stop distance over it (205: the lesser of Q258 and Q259).
//! The retracts of chip breaking (Q256) stay on the stroke of the drill, and are left out. Bore milling (208) moves to the wall at the
//! set-up clearance, down a helix with the pitch Q334, around at the depth, and back to the axis. Where the helix begins is the
//! control's own: a note says so.

use super::Program;
use super::block::{Coordinate, Words};
use super::expression::{Parameter, value};
use super::line::Cursor;
use super::words::{Entry, Treatment, find_cycle};
use crate::gcode::control::{Control, TapTurn, Thread};
use crate::gcode::error::{combination, missing, not_read};
use crate::gcode::note::NoteKind;
use crate::gcode::{GcodeFault, MAX_CYCLE_STEPS};
use std::f64::consts::TAU;

/// The distance by which cycle 202 leaves the wall of the bore, in millimetres (Q214).
const DISENGAGING: f64 = 0.2;

/// A drilling cycle. Lengths are in millimetres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Cycle {
    number: u32,
    /// Distance of the set-up clearance from the surface.
    clearance: f64,
    /// Depth from the surface, below 0.
    depth: f64,
    surface: f64,
    /// Distance of the second set-up clearance from the surface.
    second: f64,
    /// The infeeds, if the tool leaves the hole between them.
    infeed: Option<Infeed>,
    /// Set if cycle 201, 202 or 203 leaves the hole in rapid traverse (Q208).
    is_fast: bool,
    /// The direction in which cycle 202 leaves the wall.
    side: Option<Side>,
    /// The bore that cycle 208 mills.
    bore: Option<Bore>,
    /// The thread of rigid tapping, by the sign of its pitch (Q239).
    thread: Option<Thread>,
}

/// A bore that is milled on a helix.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Bore {
    diameter: f64,
    /// Diameter before, or 0.
    rough: f64,
    pitch: f64,
    clockwise: bool,
}

/// A direction along an axis (Q214).
#[derive(Clone, Copy, Debug, PartialEq)]
struct Side {
    axis: usize,
    sign: f64,
}

/// The directions of Q214 from 1.
const SIDES: [Side; 4] = [
    Side { axis: 0, sign: -1.0 },
    Side { axis: 1, sign: -1.0 },
    Side { axis: 0, sign: 1.0 },
    Side { axis: 1, sign: 1.0 },
];

/// The infeeds of a cycle.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Infeed {
    first: f64,
    /// The decrease of each.
    decrement: f64,
    least: f64,
    /// The infeeds before the tool leaves the hole.
    count: u32,
    /// Distance from the depth that was reached at which the tool returns to it.
    stop: f64,
}

/// The parameters that are feeds, for which a word can stand.
const FEEDS: [u16; 4] = [206, 207, 208, 253];

/// Difference of diameters below which they are the same, in millimetres.
const SAME_DIAMETER: f64 = 1e-6;

/// Largest number of turns of a helix.
const MAX_TURNS: f64 = 1000.0;

/// Feed in mm per minute from which it is rapid traverse.
const RAPID_FEED: f64 = 99_999.0;

/// The parameters that a cycle has.
struct CycleParameters {
    number: u32,
    /// Those that are read, or that change nothing about the path.
    known: &'static [u16],
    /// Those that change depths unless they are 0.
    zero: &'static [u16],
}

const PARAMETERS: [CycleParameters; 11] = [
    with(200, &[200, 201, 202, 203, 204, 206, 210, 211], &[395]),
    with(201, &[200, 201, 203, 204, 206, 208, 211], &[]),
    with(202, &[200, 201, 203, 204, 206, 208, 211, 214, 336], &[]),
    with(203, &[200, 201, 202, 203, 204, 205, 206, 208, 210, 211, 212, 213, 256], &[395]),
    with(
        205,
        &[200, 201, 202, 203, 204, 205, 206, 208, 211, 212, 253, 256, 257, 258, 259],
        &[379, 395],
    ),
    with(206, &[200, 201, 203, 204, 206, 211], &[]),
    with(207, &[200, 201, 203, 204, 206, 239], &[]),
    with(208, &[200, 201, 203, 204, 206, 334, 335, 342, 351], &[]),
    with(209, &[200, 201, 203, 204, 206, 239, 256, 257, 336, 403], &[]),
    with(240, &[200, 201, 203, 204, 206, 211, 253, 343, 344], &[342]),
    with(247, &[339], &[]),
];

const fn with(number: u32, known: &'static [u16], zero: &'static [u16]) -> CycleParameters {
    CycleParameters { number, known, zero }
}

/// The Q parameters of a cycle. `MAX` is an infinite number, and `AUTO` none.
struct Given {
    number: u32,
    values: Vec<(u16, Option<f64>)>,
}

impl Given {
    /// Checks that the meaning of each parameter is known.
    ///
    /// # Errors
    /// If the cycle has one that is not read, which may change its depth.
    fn check(&self) -> Result<(), GcodeFault> {
        let Some(CycleParameters { known, zero, .. }) =
            PARAMETERS.iter().find(|cycle| cycle.number == self.number)
        else {
            return Ok(());
        };
        for (parameter, value) in &self.values {
            let word = || format!("Q{parameter} of CYCL DEF {}", self.number);
            if *value == Some(f64::INFINITY) && !matches!(parameter, 208 | 253) {
                let meaning = "MAX where the cycle has a number, or a feed into the part";
                return Err(not_read(word(), meaning, "write the number"));
            }
            if value.is_none() && !FEEDS.contains(parameter) {
                let meaning = "a word where the cycle has a number";
                return Err(not_read(word(), meaning, "write the number"));
            }
            if zero.contains(parameter) {
                if *value != Some(0.0) {
                    let meaning = "a parameter by which the tool goes to another depth than Q201";
                    return Err(not_read(word(), meaning, "write 0, and Q201 for the tip"));
                }
            } else if !known.contains(parameter) {
                let meaning = "a parameter that is not known in this cycle";
                return Err(not_read(word(), meaning, "post the program with its motions"));
            }
        }
        Ok(())
    }

    fn get(&self, parameter: u16) -> Option<f64> {
        self.values.iter().find(|(number, _)| *number == parameter).and_then(|(_, value)| *value)
    }

    fn needed(&self, parameter: u16, needed: &'static str) -> Result<f64, GcodeFault> {
        let value = self.get(parameter).filter(|value| value.is_finite());
        value.ok_or_else(|| missing(format!("CYCL DEF {}", self.number), needed))
    }

    /// Returns a length in the unit of the program, which is 0 if it is not given.
    fn length(&self, parameter: u16) -> f64 {
        self.get(parameter).filter(|value| value.is_finite()).unwrap_or_default()
    }

    /// Returns the fault of a value.
    fn refused(&self, parameter: u16, expected: &'static str) -> GcodeFault {
        let value = self.get(parameter).unwrap_or_default();
        GcodeFault::Sentence { shown: format!("Q{parameter}={value}"), expected }
    }
}

impl Program<'_> {
    /// Executes CYCL DEF.
    pub(super) fn define_cycle(
        &mut self,
        cursor: &mut Cursor,
        control: &mut Control,
    ) -> Result<(), GcodeFault> {
        cursor.peek();
        let digits = cursor.take_while(|byte| byte.is_ascii_digit());
        let Ok(number) = digits.parse::<u32>() else {
            return Err(cursor.unexpected("the number of a cycle after CYCL DEF"));
        };
        // Old cycles have a line for each of their values, the first of which is the name alone.
        let mut ahead = *cursor;
        let part = match ahead.peek() {
            Some(b'.') => {
                *cursor = ahead;
                cursor.advance();
                let part = cursor.take_while(|byte| byte.is_ascii_digit());
                Some(part.parse::<u32>().map_err(|_| cursor.unexpected("the line of the cycle"))?)
            }
            _ => None,
        };
        let word = || format!("CYCL DEF {number}");
        // The builder of a machine has cycles of its own.
        if control.ignores(&word()) && is_ignorable(&word()) {
            control.ignore(word());
            return Ok(());
        }
        let Some(entry) = find_cycle(number) else {
            let remedy = "post the program with its motions, or name it in `[ignore]` of the job with the reason for which it moves nothing";
            return Err(not_read(word(), "a cycle that is not known", remedy));
        };
        match entry.treatment {
            Treatment::Refused(remedy) => return Err(not_read(word(), entry.meaning, remedy)),
            Treatment::PassedOver => {
                if part.unwrap_or(0) == 0 {
                    let word = word();
                    control.notes.add(control.block(), NoteKind::PassedOver { word });
                }
                return Ok(());
            }
            Treatment::Read => {}
        }
        if matches!(number, 7 | 8 | 10 | 19) {
            return match part {
                None => Err(missing(word(), "the line of the cycle, as in CYCL DEF 7.1")),
                Some(0) => Ok(()),
                Some(_) => self.old_cycle(number, cursor, control),
            };
        }
        let given = self.cycle_parameters(number, cursor)?;
        given.check()?;
        if number == 247 {
            let preset = given.needed(339, "Q339, the number of the preset")?;
            return self.preset(preset, control);
        }
        self.cycle = Some(cycle(&given, self.unit.millimetres())?);
        self.keep_parameters(number);
        self.is_modal_call = false;
        control.define_cycle();
        Ok(())
    }

    /// Keeps the values of a cycle's parameters, which are those of the whole program.
    fn keep_parameters(&mut self, number: u32) {
        let known = PARAMETERS.iter().find(|cycle| cycle.number == number);
        let numbers = known.into_iter().flat_map(|cycle| cycle.known.iter().chain(cycle.zero));
        let values = numbers.map(|q| (*q, self.parameters.value(Parameter::global(*q))));
        self.cycle_parameters = values.collect();
    }

    /// Refuses a call after a parameter of the cycle has got another value, which the control takes from there on.
    fn check_parameters(&self, number: u32) -> Result<(), GcodeFault> {
        let changed = self.cycle_parameters.iter().find(|(q, value)| {
            let now = self.parameters.value(Parameter::global(*q));
            now != *value && !(now.is_nan() && value.is_nan())
        });
        match changed {
            Some((q, _)) => {
                let word = format!("Q{q} of CYCL DEF {number}");
                let meaning = "assigned between the definition and the call";
                Err(not_read(word, meaning, "write its value in CYCL DEF"))
            }
            None => Ok(()),
        }
    }

    /// Reads the Q parameters after the name of a cycle, and assigns them.
    fn cycle_parameters(&mut self, number: u32, cursor: &mut Cursor) -> Result<Given, GcodeFault> {
        let mut given = Given { number, values: Vec::new() };
        while cursor.peek().is_some() {
            let mut ahead = *cursor;
            let is_parameter =
                ahead.take_text("Q") && ahead.byte().is_some_and(|b| b.is_ascii_digit());
            if !is_parameter && !given.values.is_empty() {
                return Err(cursor.unexpected("a parameter of the cycle, as Q201=-5"));
            }
            if !is_parameter {
                // The name of the cycle.
                cursor
                    .take_while(|byte| !byte.is_ascii_whitespace() && !matches!(byte, b';' | b'~'));
                continue;
            }
            let digits = ahead.take_while(|byte| byte.is_ascii_digit());
            let Some(parameter) = digits.parse().ok().filter(|number: &u16| *number < 2000) else {
                return Err(cursor.unexpected("Q0 to Q1999"));
            };
            ahead.take(b'=');
            let is_word = matches!(ahead.peek(), Some(byte) if byte.is_ascii_alphabetic() && !matches!(byte, b'Q' | b'q'));
            let value = match is_word {
                true => {
                    // A feed of the control's choice.
                    let word = ahead.letters();
                    if word.eq_ignore_ascii_case("PREDEF") {
                        let meaning = "a value of GLOBAL DEF";
                        return Err(not_read("PREDEF", meaning, "write it in the cycle"));
                    }
                    // A feed per turn or per tooth.
                    if ["FU", "FZ"].iter().any(|known| word.eq_ignore_ascii_case(known)) {
                        value(&mut ahead, &self.parameters)?;
                    }
                    let is_rapid = ["MAX", "FMAX"].iter().any(|max| word.eq_ignore_ascii_case(max));
                    is_rapid.then_some(f64::INFINITY)
                }
                false => Some(value(&mut ahead, &self.parameters)?),
            };
            match value.filter(|value| value.is_finite()) {
                Some(value) => self.parameters.assign(Parameter::global(parameter), value)?,
                None => self.parameters.forget(Parameter::global(parameter)),
            }
            given.values.push((parameter, value));
            *cursor = ahead;
        }
        Ok(given)
    }

    /// Executes CYCL CALL and CYCL CALL POS, after these words.
    pub(super) fn cycle_call(
        &mut self,
        cursor: &mut Cursor,
        control: &mut Control,
    ) -> Result<super::Progress, GcodeFault> {
        let is_position = cursor.take_word("POS");
        self.codes.clear();
        let scale = super::Scale::new(&self.parameters, self.unit);
        let mut words = scale.words(cursor, &mut self.codes)?;
        words.check_used("CYCL CALL")?;
        if !is_position {
            if words != (Words { feed: words.feed, ..Words::default() }) {
                let condition = "its block has other words than F and M words of the machine";
                return Err(combination("CYCL CALL", condition, "write them in a block before"));
            }
            self.start_words(control)?;
            self.call_cycle(0.0, control)?;
            return self.end_words(control);
        }
        self.is_modal_call = false;
        let lift = match words.axes {
            [
                Some(Coordinate::Absolute(_)),
                Some(Coordinate::Absolute(_)),
                Some(Coordinate::Absolute(lift)),
                None,
                None,
                None,
            ] => lift,
            _ => return Err(missing("CYCL CALL POS", "X, Y and Z, absolute")),
        };
        let surface = self.cycle.map(|cycle| cycle.surface + lift);
        if control.position()[2].zip(surface).is_some_and(|(z, surface)| z <= surface) {
            let condition = "the tool is not above the surface, and rises first to a clear height";
            return Err(combination("CYCL CALL POS", condition, "move it above before"));
        }
        words.axes[2] = None;
        words.feed = Some(words.feed.unwrap_or(super::block::Feed::Rapid));
        self.start_words(control)?;
        // Its feed is that of the way to the position alone (known: TNC 640, *Cycle programming*).
        let feed = control.replace_feed(None);
        let moved = self.line(words, control);
        control.replace_feed(feed);
        moved?;
        self.call_cycle(lift, control)?;
        self.end_words(control)
    }

    /// Executes the cycle at the present position, with a surface that is higher by `lift` millimetres.
    pub(super) fn call_cycle(
        &mut self,
        lift: f64,
        control: &mut Control,
    ) -> Result<(), GcodeFault> {
        let Some(cycle) = self.cycle else {
            return Err(missing("a call of a cycle", "a drilling cycle before (CYCL DEF 200)"));
        };
        let word = format!("CYCL DEF {}", cycle.number);
        control.call_cycle();
        self.check_parameters(cycle.number)?;
        control.check_corner()?;
        control.check_uncompensated(&*word)?;
        if control.is_tcp() {
            return Err(combination(word, "M128 is in force", "write M129 before"));
        }
        self.check_level(control)?;
        if cycle.depth == 0.0 {
            control.notes.add(control.block(), NoteKind::EmptyCycle);
            return Ok(());
        }
        self.execute_cycle(&cycle, lift, control)
    }

    fn execute_cycle(
        &mut self,
        cycle: &Cycle,
        lift: f64,
        control: &mut Control,
    ) -> Result<(), GcodeFault> {
        let surface = cycle.surface + lift;
        let (top, bottom) = (surface + cycle.clearance, surface + cycle.depth);
        let clear = surface + cycle.second.max(cycle.clearance);
        let is_tap = matches!(cycle.number, 206 | 207 | 209);
        control.move_to_level(top, true);
        if let Some(infeed) = cycle.infeed {
            infeeds(cycle, infeed, [surface, top, bottom], control)?;
        }
        match cycle.bore {
            Some(bore) => mill(bore, [top, bottom], control)?,
            None if is_tap => {
                let turn = match cycle.number {
                    206 => TapTurn::OfSpindle,
                    _ => TapTurn::OfCycle(cycle.thread),
                };
                control.tap([top, bottom], turn);
            }
            None => control.move_to_level(bottom, false),
        }
        match cycle.number {
            201 | 203 => control.move_to_level(top, cycle.is_fast),
            202 => {
                let aside = cycle.side.map(|Side { axis, sign }| {
                    (axis, sign * DISENGAGING * self.frame.mirror[axis])
                });
                if let Some((axis, increment)) = aside {
                    control.move_by(axis, increment, false);
                }
                control.move_to_level(top, cycle.is_fast);
                control.move_to_level(clear, true);
                if let Some((axis, increment)) = aside {
                    control.move_by(axis, -increment, true);
                }
            }
            _ => {}
        }
        control.move_to_level(clear, true);
        Ok(())
    }
}

/// Returns whether a job can pass over a cycle, `CYCL DEF` with its number: one of the machine's builder, or one that is not known.
pub(in crate::gcode) fn is_ignorable(word: &str) -> bool {
    let Some(number) = word.strip_prefix("CYCL DEF ") else { return false };
    let is_number = !number.starts_with('0') && number.bytes().all(|byte| byte.is_ascii_digit());
    let number = number.parse::<u32>().ok().filter(|_| is_number);
    number.is_some_and(|number| find_cycle(number).is_none_or(Entry::is_of_builder))
}

/// Moves to the depths of all infeeds but the last.
fn infeeds(
    cycle: &Cycle,
    infeed: Infeed,
    [surface, top, bottom]: [f64; 3],
    control: &mut Control,
) -> Result<(), GcodeFault> {
    let is_fast = cycle.number != 203 || cycle.is_fast;
    let (mut level, mut depth, mut steps) = (surface, infeed.first, 0);
    for index in 1.. {
        level -= depth;
        if level <= bottom + 1e-9 {
            return Ok(());
        }
        // A decrement beyond the least infeed stops there.
        depth = (depth - infeed.decrement).max(infeed.least.min(depth));
        if index % infeed.count == 0 {
            control.move_to_level(level, false);
            control.move_to_level(top, is_fast);
            control.move_to_level((level + infeed.stop).min(top), true);
        }
        steps += 3;
        if steps > MAX_CYCLE_STEPS {
            return Err(GcodeFault::CycleTooLong);
        }
    }
    Ok(())
}

/// Mills a bore about the present position.
fn mill(bore: Bore, [top, bottom]: [f64; 2], control: &mut Control) -> Result<(), GcodeFault> {
    const WORD: &str = "CYCL DEF 208";
    let Bore { diameter, rough, pitch, clockwise } = bore;
    let tool = 2.0 * control.tool_radius(WORD)?;
    let position = control.position();
    let (Some(x), Some(y)) = (position[0], position[1]) else {
        return Err(missing(WORD, "X and Y of the hole before"));
    };
    let radius = 0.5 * (diameter - tool);
    if radius < -SAME_DIAMETER {
        let condition = "the tool is wider than the bore (Q335)";
        return Err(combination(WORD, condition, "correct the diameter or the radius of the tool"));
    }
    if diameter - rough.max(0.0) > 2.0 * tool + SAME_DIAMETER {
        let meaning =
            "a bore of more than twice the tool, which some controls mill in several passes";
        return Err(not_read("Q335 of CYCL DEF 208", meaning, "post the program with CP"));
    }
    if radius < SAME_DIAMETER {
        control.move_to_level(bottom, false);
        return Ok(());
    }
    control.notes.add_once(control.block(), NoteKind::HelixStart);
    let turns = (top - bottom) / pitch;
    if turns > MAX_TURNS {
        return Err(GcodeFault::CycleTooLong);
    }
    let sense = if clockwise { -TAU } else { TAU };
    control.move_in_plane([x + radius, y]);
    control.helix([x, y], sense * turns, bottom);
    control.helix([x, y], sense, bottom);
    control.move_in_plane([x, y]);
    Ok(())
}

/// Returns the cycle of its parameters. `unit` is that of the program in millimetres.
fn cycle(given: &Given, unit: f64) -> Result<Cycle, GcodeFault> {
    let number = given.number;
    let clearance = unit * given.needed(200, "Q200, the set-up clearance")?;
    let depth = unit * given.needed(201, "Q201, the depth")?;
    let surface = unit * given.needed(203, "Q203, the coordinate of the surface")?;
    let second = unit * given.needed(204, "Q204, the second set-up clearance")?;
    if clearance < 0.0 {
        return Err(given.refused(200, "a set-up clearance from 0"));
    }
    if depth > 0.0 {
        return Err(given.refused(201, "a depth below 0"));
    }
    let feed = if is_thread(number) { 239 } else { 206 };
    if given.get(feed) == Some(0.0) {
        return Err(given.refused(feed, "a feed or a pitch other than 0"));
    }
    if number == 240 && given.needed(343, "Q343, the choice of depth or diameter")? != 0.0 {
        let meaning = "centring by a diameter, which depends on the tool";
        return Err(not_read("Q343=1 of CYCL DEF 240", meaning, "write the depth, with Q343=0"));
    }
    let infeed = match number {
        200 | 203 | 205 => {
            let first = unit * given.needed(202, "Q202, the infeed depth")?;
            if first <= 0.0 {
                return Err(given.refused(202, "an infeed depth above 0"));
            }
            let (decrement, least) = (unit * given.length(212), unit * given.length(205));
            if decrement < 0.0 || decrement > 0.0 && least <= 0.0 {
                return Err(missing("Q212", "Q205 above 0, the least infeed depth"));
            }
            let stops = [258, 259].map(|q| given.length(q));
            let stop = match number {
                205 => unit * stops[0].min(stops[1]).max(0.0),
                _ => clearance,
            };
            let breaks = if number == 203 { given.length(213) } else { 0.0 };
            let count = 1 + breaks.clamp(0.0, 1e6) as u32;
            Some(Infeed { first, decrement, least, count, stop })
        }
        _ => None,
    };
    let side = match number {
        202 => match given.needed(214, "Q214, the direction in which the tool leaves the wall")? {
            0.0 => None,
            side => {
                let known = (1..).zip(SIDES).find(|(number, _)| f64::from(*number) == side);
                let (_, side) = known.ok_or_else(|| given.refused(214, "0 to 4"))?;
                Some(side)
            }
        },
        _ => None,
    };
    let bore = match number {
        208 => {
            let pitch = unit * given.needed(334, "Q334, the infeed per turn")?;
            let diameter = unit * given.needed(335, "Q335, the diameter of the bore")?;
            if pitch <= 0.0 {
                return Err(given.refused(334, "an infeed per turn above 0"));
            }
            // Climb milling, unless Q351 says otherwise.
            let clockwise = given.length(351) < 0.0;
            Some(Bore { diameter, rough: unit * given.length(342), pitch, clockwise })
        }
        _ => None,
    };
    let is_fast =
        matches!(number, 201..=203) && given.get(208).is_some_and(|feed| feed >= RAPID_FEED);
    let thread = Thread::of_pitch(given.length(239)).filter(|_| is_thread(number));
    Ok(Cycle { number, clearance, depth, surface, second, infeed, is_fast, side, bore, thread })
}

fn is_thread(number: u32) -> bool {
    matches!(number, 207 | 209)
}
