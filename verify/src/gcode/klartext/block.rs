//! The words of a motion: coordinates, feed and M words.

use super::expression::{Parameters, value};
use super::line::Cursor;
use super::words::{Entry, M_WORDS};
use crate::gcode::GcodeFault;
use crate::gcode::block::Code;
use crate::gcode::error::not_read;
use touchoff::Unit;

/// A coordinate, in millimetres or degrees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Coordinate {
    Absolute(f64),
    /// From the position before (`IX`).
    Incremental(f64),
    /// The angle at which the tool stands along z of the tilted plane: Q120, Q121 or Q122 as the axis's own.
    OfPlane,
}

/// A feed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Feed {
    /// Rapid traverse, in this block alone.
    Rapid,
    /// A number, per minute, per turn (FU) or per tooth (FZ).
    Rate(f64),
    /// The feed of the last TOOL CALL (`F AUTO`).
    OfTool,
}

/// A retract along the tool axis (M140).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Retract {
    /// In millimetres; `None`: to the end of the travel.
    pub(super) distance: Option<f64>,
    pub(super) rapid: bool,
}

/// The side of the programmed path on which the tool moves, seen along it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Side {
    /// R0: on it.
    On,
    /// RL.
    Left,
    /// RR.
    Right,
}

impl Side {
    /// Returns the word of ISO programs.
    pub(super) fn code(self) -> Code {
        let tenths = match self {
            Side::On => 400,
            Side::Left => 410,
            Side::Right => 420,
        };
        Code { letter: 'G', tenths }
    }

    pub(super) fn word(self) -> &'static str {
        match self {
            Side::On => "R0",
            Side::Left => "RL",
            Side::Right => "RR",
        }
    }
}

/// The words of a motion. M words that are not here are in a list of their own.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Words {
    /// X Y Z A B C.
    pub(super) axes: [Option<Coordinate>; 6],
    pub(super) polar_radius: Option<Coordinate>,
    pub(super) polar_angle: Option<Coordinate>,
    pub(super) radius: Option<f64>,
    pub(super) side: Option<Side>,
    pub(super) clockwise: Option<bool>,
    pub(super) feed: Option<Feed>,
    pub(super) retract: Option<Retract>,
    /// M91 or M92.
    pub(super) is_machine: bool,
    /// M92.
    pub(super) is_from_point: bool,
    /// M99.
    pub(super) is_call: bool,
    /// M89.
    pub(super) is_modal_call: bool,
}

impl Words {
    /// Returns whether the block has a coordinate of an axis.
    pub(super) fn has_axes(&self) -> bool {
        self.axes.iter().any(Option::is_some)
    }

    /// Refuses a word that a statement does not use.
    pub(super) fn check_used(&self, head: &'static str) -> Result<(), GcodeFault> {
        let unused = [
            ("R", self.radius.is_some() && head != "CR"),
            ("DR", self.clockwise.is_some() && !matches!(head, "C" | "CR" | "CP")),
            ("PR", self.polar_radius.is_some() && !matches!(head, "LP" | "CTP")),
            ("PA", self.polar_angle.is_some() && !matches!(head, "LP" | "CTP" | "CP")),
        ];
        match unused.into_iter().find(|(_, is_unused)| *is_unused) {
            Some((word, _)) => {
                let remedy = "remove it, or write the statement that uses it";
                Err(not_read(format!("{word} beside {head}"), "a word of another motion", remedy))
            }
            None => Ok(()),
        }
    }

    /// Returns whether the block has coordinates of axes alone.
    pub(super) fn is_plain(&self) -> bool {
        *self == Words { axes: self.axes, ..Words::default() }
    }

    pub(super) fn is_rapid(&self) -> bool {
        self.feed == Some(Feed::Rapid)
    }
}

/// Settings that numbers are read with.
#[derive(Clone, Copy, Debug)]
pub(super) struct Scale<'a> {
    known: &'a Parameters,
    /// The unit of the program in millimetres.
    unit: f64,
}

impl<'a> Scale<'a> {
    pub(super) fn new(known: &'a Parameters, unit: Unit) -> Scale<'a> {
        Scale { known, unit: unit.millimetres() }
    }

    /// Reads a length, and returns it in millimetres.
    pub(super) fn length(&self, cursor: &mut Cursor) -> Result<f64, GcodeFault> {
        Ok(self.unit * value(cursor, self.known)?)
    }

    /// Reads the words of a motion. `codes` gets the numbers of M words.
    pub(super) fn words(
        &self,
        cursor: &mut Cursor,
        codes: &mut Vec<u32>,
    ) -> Result<Words, GcodeFault> {
        let mut words = Words::default();
        while let Some(byte) = cursor.peek() {
            match byte.to_ascii_uppercase() {
                letter @ (b'X'..=b'Z' | b'A'..=b'C') => {
                    cursor.advance();
                    self.axis(cursor, letter, false, &mut words)?;
                }
                b'I' => {
                    let start = *cursor;
                    cursor.advance();
                    match cursor.byte().map(|byte| byte.to_ascii_uppercase()) {
                        Some(letter @ (b'X'..=b'Z' | b'A'..=b'C')) => {
                            cursor.advance();
                            self.axis(cursor, letter, true, &mut words)?;
                        }
                        Some(b'P') => self.polar(cursor, true, &mut words)?,
                        _ => {
                            let mut start = start;
                            return Err(start.unexpected("an axis after I"));
                        }
                    }
                }
                b'P' => self.polar(cursor, false, &mut words)?,
                b'R' => self.radius(cursor, &mut words)?,
                b'D' if cursor.take_text("DR") => {
                    let is_clockwise = cursor.take(b'-');
                    if !is_clockwise && !cursor.take(b'+') {
                        return Err(cursor.unexpected("DR+ or DR-"));
                    }
                    words.clockwise = Some(is_clockwise);
                }
                b'F' => words.feed = Some(self.feed(cursor)?),
                b'M' => self.m_word(cursor, &mut words, codes)?,
                letter @ b'U'..=b'W' => return Err(GcodeFault::Axis { word: char::from(letter) }),
                _ => return Err(cursor.unexpected("a coordinate, R0, DR, F or an M word")),
            }
        }
        Ok(words)
    }

    fn axis(
        &self,
        cursor: &mut Cursor,
        letter: u8,
        incremental: bool,
        words: &mut Words,
    ) -> Result<(), GcodeFault> {
        let axis = match letter {
            b'A'..=b'C' => usize::from(letter - b'A') + 3,
            _ => usize::from(letter - b'X'),
        };
        let coordinate = if axis >= 3 && !incremental && takes_angle_of_plane(cursor, letter) {
            Coordinate::OfPlane
        } else {
            let value = value(cursor, self.known)?;
            let value = if axis < 3 { self.unit * value } else { value };
            match incremental {
                true => Coordinate::Incremental(value),
                false => Coordinate::Absolute(value),
            }
        };
        match words.axes[axis].replace(coordinate) {
            Some(_) => Err(GcodeFault::Repeated { word: char::from(letter) }),
            None => Ok(()),
        }
    }

    /// Reads PR or PA.
    fn polar(
        &self,
        cursor: &mut Cursor,
        incremental: bool,
        words: &mut Words,
    ) -> Result<(), GcodeFault> {
        let is_radius = cursor.take_text("PR");
        if !is_radius && !cursor.take_text("PA") {
            return Err(cursor.unexpected("PR or PA"));
        }
        let value = value(cursor, self.known)?;
        let value = if is_radius { self.unit * value } else { value };
        let coordinate = match incremental {
            true => Coordinate::Incremental(value),
            false => Coordinate::Absolute(value),
        };
        match is_radius {
            true => words.polar_radius = Some(coordinate),
            false => words.polar_angle = Some(coordinate),
        }
        Ok(())
    }

    /// Reads R0, RL, RR or a radius.
    fn radius(&self, cursor: &mut Cursor, words: &mut Words) -> Result<(), GcodeFault> {
        cursor.advance();
        let sign = cursor.rest().split(|c: char| c.is_whitespace() || c == ';').next();
        if let Some(sign @ ("+" | "-")) = sign {
            let shown = format!("R{sign}");
            let meaning = "cutter compensation of a motion along one axis";
            return Err(not_read(shown, meaning, "write the position of the tool's centre"));
        }
        // The next word may follow without a blank: `R0FMAX`.
        let side = match cursor.byte().map(|byte| byte.to_ascii_uppercase()) {
            Some(b'L') => Side::Left,
            Some(b'R') => Side::Right,
            _ => {
                match self.length(cursor)? {
                    0.0 => words.side = Some(Side::On),
                    radius => words.radius = Some(radius),
                }
                return Ok(());
            }
        };
        cursor.advance();
        words.side = Some(side);
        Ok(())
    }

    /// Reads a feed.
    pub(super) fn feed(&self, cursor: &mut Cursor) -> Result<Feed, GcodeFault> {
        cursor.advance();
        match cursor.byte().map(|byte| byte.to_ascii_uppercase()) {
            Some(b'U' | b'Z') => cursor.advance(),
            Some(b'T') => {
                return Err(not_read("FT", "a feed by the time of a block", "write F"));
            }
            _ => {}
        }
        if cursor.take_text("MAX") {
            return match cursor.byte() {
                Some(b'T' | b't') => {
                    Err(not_read("FMAXT", "a feed by the time of a block", "write FMAX"))
                }
                _ => Ok(Feed::Rapid),
            };
        }
        if cursor.take_text("AUTO") {
            return Ok(Feed::OfTool);
        }
        Ok(Feed::Rate(value(cursor, self.known)?))
    }

    fn m_word(
        &self,
        cursor: &mut Cursor,
        words: &mut Words,
        codes: &mut Vec<u32>,
    ) -> Result<(), GcodeFault> {
        cursor.advance();
        let digits = cursor.take_while(|byte| byte.is_ascii_digit());
        let Ok(number) = digits.parse::<u32>() else {
            return Err(GcodeFault::NoNumber { word: 'M' });
        };
        // The setup can ignore one that is not known.
        if let Ok(entry) = m_entry(number) {
            entry.check()?;
        }
        match number {
            91 => words.is_machine = true,
            92 => (words.is_machine, words.is_from_point) = (true, true),
            99 => words.is_call = true,
            89 => words.is_modal_call = true,
            140 => words.retract = Some(self.retract(cursor)?),
            // The feed of the motion that follows the rotary axes, and that along the tool axis in percent.
            103 | 128 => {
                codes.push(number);
                if matches!(cursor.peek(), Some(b'F' | b'f')) {
                    self.feed(cursor)?;
                }
            }
            120 => {
                codes.push(number);
                if cursor.take_text("LA") {
                    value(cursor, self.known)?;
                }
            }
            _ => codes.push(number),
        }
        Ok(())
    }

    /// Reads `MB` and its feed.
    pub(super) fn retract(&self, cursor: &mut Cursor) -> Result<Retract, GcodeFault> {
        if !cursor.take_text("MB") {
            return Err(cursor.unexpected("MB with a distance, or MB MAX, after M140"));
        }
        let is_whole = cursor.take_text("MAX");
        let distance = if is_whole { None } else { Some(self.length(cursor)?) };
        if let Some(value) = distance.filter(|distance| *distance < 0.0) {
            let shown = format!("MB {value}");
            return Err(GcodeFault::Sentence { shown, expected: "a distance from 0" });
        }
        let has_feed = matches!(cursor.peek(), Some(b'F' | b'f'));
        let feed = if has_feed { self.feed(cursor)? } else { Feed::Rapid };
        Ok(Retract { distance, rapid: feed == Feed::Rapid })
    }
}

/// Returns the entry of an M word.
pub(super) fn m_entry(number: u32) -> Result<&'static Entry, GcodeFault> {
    let known = M_WORDS.iter().find(|entry| entry.word[1..].parse() == Ok(number));
    known.ok_or_else(|| GcodeFault::UnknownCode { word: format!("M{number}") })
}

/// Passes over `+Q120` after A, `+Q121` after B and `+Q122` after C.
fn takes_angle_of_plane(cursor: &mut Cursor, letter: u8) -> bool {
    let mut ahead = *cursor;
    ahead.take(b'+');
    let is_angle = ahead.take_text("Q12") && ahead.byte() == Some(letter - b'A' + b'0');
    if is_angle {
        ahead.advance();
    }
    let found = is_angle && !ahead.byte().is_some_and(|byte| byte.is_ascii_digit());
    if found {
        *cursor = ahead;
    }
    found
}
