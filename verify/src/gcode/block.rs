//! One block: the words of a line, and which of them are known.
//!
//! A line is an optional `/`, an optional `N` with a number, and words in any order. A word is a letter and a
//! value. Comments are `( … )` and `; …`. Case does not matter, and blanks may stand between words and
//! between a letter and its value. A character that belongs to none of these stops the interpreter.

use super::error::{not_read, same_group};
use super::expression::{Cursor, Parameter, Parameters, assignment, begins_value, value};
use super::{ExpressionFault, GcodeFault, MAX_ASSIGNMENTS};
use std::fmt;

/// Words of more than one letter that are read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Keyword {
    /// `TRAORI`: tool centre point control on.
    TransformationOn,
    /// `TRAFOOF`: tool centre point control off.
    TransformationOff,
}

/// Words of Heidenhain Klartext that begin a line or end one.
const KLARTEXT: [&str; 14] = [
    "BEGIN", "BLK", "CALL", "CC", "CYCL", "END", "FMAX", "FN", "FUNCTION", "LBL", "PGM", "PLANE",
    "TCPM", "TOOL",
];

/// Words that decide what is executed, of macro programs and of Sinumerik.
const DECISIONS: [&str; 14] = [
    "CASE", "DO", "ELSE", "ENDIF", "FOR", "GOTO", "GOTOB", "GOTOF", "IF", "LOOP", "REPEAT", "THEN",
    "UNTIL", "WHILE",
];

/// The words of a block. Words that no other word uses remain in it, and are refused at its end.
#[derive(Clone, Debug, Default)]
pub(super) struct Block {
    values: [f64; 26],
    /// Letters that the block has and that no word has used, as bits from A.
    unused: u32,
    codes: [Option<Code>; GROUPS],
    /// Words that are passed over.
    pub(super) passed_over: Vec<Code>,
    pub(super) label: Option<OWord>,
    pub(super) keyword: Option<Keyword>,
    assignments: Vec<(Parameter, f64)>,
    /// Coordinates that have no decimal point and are not zero, as bits from A.
    whole: u32,
    /// Letters whose number is a parameter or an expression, as bits from A.
    computed: u32,
    /// Set if the block has an assignment.
    assigns: bool,
    /// Set if the block has an assignment, and another value that is computed.
    pub(super) assigns_beside_value: bool,
    /// Set if the line begins with `/`.
    deletable: bool,
    /// Set if G90 or G91 stands after a coordinate.
    pub(super) distance_after_coordinate: bool,
}

/// Removes `/`, which may be followed by the number of its switch, and a block number.
pub(super) fn begin<'a>(line: &'a str) -> (bool, Cursor<'a>) {
    let mut cursor = Cursor::new(line);
    let deletable = cursor.take(b'/');
    if deletable {
        cursor.take_while(|byte| byte.is_ascii_digit());
    }
    let mut numbered = cursor;
    if numbered.take(b'N') || numbered.take(b'n') {
        numbered.peek();
        if !numbered.take_while(|byte| byte.is_ascii_digit() || byte == b'.').is_empty() {
            return (deletable, numbered);
        }
    }
    (deletable, cursor)
}

impl Block {
    /// Reads a line. Assignments take effect on `parameters` at its end.
    pub(super) fn parse(
        &mut self,
        line: &str,
        parameters: &mut Parameters,
    ) -> Result<(), GcodeFault> {
        self.clear();
        let (deletable, mut cursor) = begin(line);
        self.deletable = deletable;
        // The assignments whose value depends on a parameter: with another assignment in the block, it depends on the control
        // whether that is in force yet.
        let mut uses = 0;
        while let Some(byte) = next(&mut cursor)? {
            match byte {
                b'#' => {
                    let start = cursor.rest();
                    if self.assignments.len() == MAX_ASSIGNMENTS {
                        return Err(GcodeFault::Assignments);
                    }
                    self.assignments.push(assignment(&mut cursor, parameters)?);
                    let written = &start[1..start.len() - cursor.rest().len()];
                    uses += usize::from(written.contains('#'));
                }
                b'O' | b'o' if self.is_empty() => {
                    self.label = Some(o_word(&mut cursor, parameters)?);
                }
                _ if byte.is_ascii_alphabetic() => self.word(&mut cursor, parameters)?,
                b',' => {
                    let word: String =
                        cursor.rest().chars().take(2).flat_map(char::escape_debug).collect();
                    let meaning = "a rounded or chamfered corner";
                    return Err(not_read(word, meaning, "post the program with its motions"));
                }
                b'0'..=b'9' if self.is_empty() => return Err(numbered_line(cursor)),
                _ => return Err(unexpected(&cursor)),
            }
        }
        self.assigns = !self.assignments.is_empty();
        self.assigns_beside_value =
            self.assigns && self.computed != 0 || uses > 0 && self.assignments.len() > 1;
        // All values of the block were computed with the parameters before it (RS274/NGC, section 3.3.3.4).
        for (parameter, value) in self.assignments.drain(..) {
            parameters.assign(parameter, value);
        }
        Ok(())
    }

    fn clear(&mut self) {
        self.unused = 0;
        self.codes = [None; GROUPS];
        self.passed_over.clear();
        self.label = None;
        self.keyword = None;
        self.assignments.clear();
        (self.whole, self.computed) = (0, 0);
        (self.assigns, self.assigns_beside_value) = (false, false);
        self.distance_after_coordinate = false;
    }

    /// Returns whether the block has no word yet.
    pub(super) fn is_empty(&self) -> bool {
        self.unused == 0
            && self.codes.iter().all(Option::is_none)
            && self.passed_over.is_empty()
            && self.label.is_none()
            && self.keyword.is_none()
            && self.assignments.is_empty()
    }

    /// Reads a word that begins with a letter.
    fn word(&mut self, cursor: &mut Cursor, parameters: &Parameters) -> Result<(), GcodeFault> {
        let start = *cursor;
        let letter = char::from(start.rest().as_bytes()[0]).to_ascii_uppercase();
        cursor.advance();
        if !begins_value(cursor) {
            return self.name(start, cursor, letter);
        }
        let text = cursor.rest();
        let value = value(cursor, parameters)?;
        let written = &text[..text.len() - cursor.rest().len()];
        match letter {
            'G' | 'M' => self.code(letter, value, written),
            'E' | 'U' | 'V' | 'W' => Err(GcodeFault::Axis { word: letter }),
            'N' | 'O' => Err(GcodeFault::Unused { word: letter }),
            _ => {
                let bit = 1 << (letter as u8 - b'A');
                if self.unused & bit != 0 {
                    return Err(GcodeFault::Repeated { word: letter });
                }
                self.unused |= bit;
                self.values[usize::from(letter as u8 - b'A')] = value;
                // Only these are counted in increments (`whole_numbers`).
                let is_coordinate = "XYZABCIJKRQ".contains(letter);
                let is_whole = !written.contains(['.', '[', '#']);
                if is_coordinate && is_whole && value != 0.0 {
                    self.whole |= bit;
                }
                if written.contains(['[', '#']) {
                    self.computed |= bit;
                }
                Ok(())
            }
        }
    }

    fn code(&mut self, letter: char, value: f64, written: &str) -> Result<(), GcodeFault> {
        let tenths = (10.0 * value).round();
        let digits = written.trim();
        let is_literal = digits.bytes().all(|byte| byte.is_ascii_digit() || byte == b'.');
        if !is_literal || (10.0 * value - tenths).abs() > 1e-9 || tenths > 99_999.0 {
            let expected = "a number with one decimal at most";
            return Err(GcodeFault::NotAllowed { word: letter, value, expected });
        }
        let code = Code { letter, tenths: tenths as u32 };
        let group = group(code)?;
        self.distance_after_coordinate |= group == Group::Distance && self.has_any("XYZABCIJK");
        match group {
            Group::PassedOver => self.passed_over.push(code),
            group => match &mut self.codes[group as usize] {
                Some(first) => {
                    return Err(same_group(*first, code));
                }
                empty => *empty = Some(code),
            },
        }
        Ok(())
    }

    /// Reads a letter without a value: a word of another dialect, or a mistake.
    fn name<'a>(
        &mut self,
        start: Cursor<'a>,
        cursor: &mut Cursor<'a>,
        letter: char,
    ) -> Result<(), GcodeFault> {
        let mut whole = start;
        let name = whole.take_while(|byte| byte.is_ascii_alphanumeric() || byte == b'_');
        let upper = name.to_ascii_uppercase();
        let keyword = match upper.as_str() {
            "TRAORI" => Keyword::TransformationOn,
            "TRAFOOF" => Keyword::TransformationOff,
            _ if KLARTEXT.contains(&upper.as_str()) || is_klartext_line(start.rest()) => {
                return Err(GcodeFault::Klartext { word: upper });
            }
            _ if DECISIONS.contains(&upper.trim_end_matches(|c: char| c.is_ascii_digit())) => {
                return Err(GcodeFault::ControlFlow { word: upper });
            }
            _ if upper.starts_with("CUT3D") => {
                let meaning = "three-dimensional cutter compensation of Sinumerik";
                return Err(not_read(upper, meaning, "post the program with the path of the tool"));
            }
            _ if name.len() > 1 => {
                return Err(GcodeFault::UnknownWord { word: super::unquoted(name) });
            }
            _ => {
                cursor.peek();
                let function = cursor.take_while(|byte| byte.is_ascii_alphabetic());
                return match function.len() > 1 && cursor.take(b'[') {
                    true => {
                        let name = function.to_ascii_uppercase();
                        Err(ExpressionFault::Operation { name }.into())
                    }
                    false => Err(GcodeFault::NoNumber { word: letter }),
                };
            }
        };
        if self.keyword.replace(keyword).is_some() {
            // Both keywords begin with it.
            return Err(GcodeFault::Repeated { word: 'T' });
        }
        // Parameters of the transformation, and no comment: offsets of the axes, or another data set than the first.
        if whole.peek() == Some(b'(') {
            let parameters = whole.take_until(')').ok_or(GcodeFault::OpenComment)?;
            if !matches!(parameters[1..].trim(), "" | "1") {
                let word = super::unquoted(&format!("{upper}{parameters})"));
                return Err(GcodeFault::UnknownWord { word });
            }
        }
        *cursor = whole;
        Ok(())
    }

    /// Returns all G and M words.
    pub(super) fn codes(&self) -> impl Iterator<Item = Code> + '_ {
        self.codes.iter().flatten().chain(&self.passed_over).copied()
    }

    /// Returns the word of a group.
    pub(super) fn code_of(&self, group: Group) -> Option<Code> {
        self.codes[group as usize]
    }

    /// Returns the number of the word of a group, in tenths.
    pub(super) fn tenths_of(&self, group: Group) -> Option<u32> {
        self.code_of(group).map(|code| code.tenths)
    }

    /// Returns whether the block has a letter that no word has used.
    pub(super) fn has(&self, letter: char) -> bool {
        self.unused & (1 << (letter as u8 - b'A')) != 0
    }

    /// Returns whether the block has one of the letters.
    pub(super) fn has_any(&self, letters: &str) -> bool {
        letters.chars().any(|letter| self.has(letter))
    }

    /// Returns whether a coordinate that no word has used has no decimal point.
    pub(super) fn has_whole(&self) -> bool {
        self.whole & self.unused != 0
    }

    /// Returns whether the coordinate after a letter, which no word has used, has no decimal point.
    pub(super) fn is_whole(&self, letter: char) -> bool {
        self.whole & self.unused & (1 << (letter as u8 - b'A')) != 0
    }

    /// Multiplies the coordinates without a decimal point by a factor of their letter.
    pub(super) fn scale_whole(&mut self, factor: impl Fn(char) -> f64) {
        for index in 0..26u8 {
            if self.whole & self.unused & (1 << index) != 0 {
                self.values[usize::from(index)] *= factor(char::from(b'A' + index));
            }
        }
    }

    /// Returns whether one of the letters has a number other than 0.
    pub(super) fn is_nonzero(&self, letters: &str) -> bool {
        letters.chars().any(|letter| self.value(letter).is_some_and(|value| value != 0.0))
    }

    /// Returns whether a block with M98 has words that are no part of the call, or numbers that are computed: a control that
    /// repeats the call computes them again.
    pub(super) fn has_more_than_call(&self) -> bool {
        let call = 1 << (b'P' - b'A') | 1 << (b'L' - b'A');
        self.unused & !call != 0
            || self.computed & self.unused & call != 0 && self.has('L')
            || self.assigns
            || self.codes().nth(1).is_some()
            || self.keyword.is_some()
    }

    /// Returns whether a word of the block can name axes without moving them, or by a path of its own. What it leaves of the axis
    /// words moves on some controls.
    pub(super) fn owns_axis_words(&self) -> bool {
        let owners = [Group::OneShot, Group::Machine, Group::Dwell];
        owners.into_iter().any(|group| self.code_of(group).is_some())
            || self.code_of(Group::Rotation).is_some_and(|code| code.tenths != 690)
            || self.passed_over.iter().any(|code| {
                code.letter == 'G' && matches!(code.tenths, 150 | 230 | 500 | 501 | 670)
            })
    }

    /// Returns whether the block has a position in program coordinates for a motion.
    pub(super) fn is_programmed(&self) -> bool {
        self.has_any("XYZABCIJK")
            && self.code_of(Group::OneShot).is_none()
            && self.code_of(Group::Machine).is_none()
    }

    /// Returns whether the block has words besides a keyword, of which none was used.
    pub(super) fn has_words(&self) -> bool {
        self.unused != 0 || self.codes().next().is_some()
    }

    /// Returns whether the block moves, or changes what motions do.
    pub(super) fn has_effect(&self) -> bool {
        self.codes.iter().any(Option::is_some) || self.keyword.is_some() || self.has_any("XYZABC")
    }

    /// Returns the number after a letter that no word has used.
    pub(super) fn value(&self, letter: char) -> Option<f64> {
        self.has(letter).then_some(self.values[usize::from(letter as u8 - b'A')])
    }

    /// Returns the number after a letter, which counts as used.
    pub(super) fn take(&mut self, letter: char) -> Option<f64> {
        let found = self.value(letter);
        self.unused &= !(1 << (letter as u8 - b'A'));
        found
    }

    /// Returns the whole number after a letter, if there is one.
    ///
    /// # Errors
    /// If the number is not whole, or not from `least` to `greatest`.
    pub(super) fn take_whole(
        &mut self,
        word: char,
        least: u32,
        greatest: u32,
        expected: &'static str,
    ) -> Result<Option<u32>, GcodeFault> {
        let Some(value) = self.take(word) else { return Ok(None) };
        // Expressions such as `[10 * 0.1]` may miss a whole number by rounding.
        let whole = value.round();
        match (value - whole).abs() < 1e-9
            && (f64::from(least)..=f64::from(greatest)).contains(&whole)
        {
            true => Ok(Some(whole as u32)),
            false => Err(GcodeFault::NotAllowed { word, value, expected }),
        }
    }

    /// Refuses a word that no other word has used.
    pub(super) fn check_used(&self) -> Result<(), GcodeFault> {
        match self.unused {
            0 => Ok(()),
            rest => {
                Err(GcodeFault::Unused { word: char::from(b'A' + rest.trailing_zeros() as u8) })
            }
        }
    }
}

/// Passes over blanks and comments, and returns the next byte.
pub(super) fn next(cursor: &mut Cursor) -> Result<Option<u8>, GcodeFault> {
    loop {
        match cursor.peek() {
            Some(b'(') => {
                let comment = cursor.take_until(')').ok_or(GcodeFault::OpenComment)?;
                if comment[1..].contains('(') {
                    return Err(GcodeFault::OpenComment);
                }
                check_comment(&comment[1..])?;
            }
            Some(b';') => {
                check_comment(&cursor.rest()[1..])?;
                return Ok(None);
            }
            None => return Ok(None),
            // The end of a block in DIN/ISO programs of Heidenhain.
            Some(b'*') if cursor.rest()[1..].trim().is_empty() => return Ok(None),
            Some(byte) => return Ok(Some(byte)),
        }
    }
}

/// Returns whether a comment begins with a word, in either case.
pub(super) fn begins(comment: &str, word: &str) -> bool {
    let start = comment.trim_start().as_bytes().get(..word.len());
    start.is_some_and(|start| start.eq_ignore_ascii_case(word.as_bytes()))
}

/// Refuses a comment that LinuxCNC executes.
fn check_comment(comment: &str) -> Result<(), GcodeFault> {
    if begins(comment, "py,") || begins(comment, "pyrun,") {
        let meaning = "a comment whose Python LinuxCNC executes";
        let remedy = "remove it, or write a blank before the comma";
        return Err(not_read("py,", meaning, remedy));
    }
    Ok(())
}

/// Returns the fault of a character that begins no word.
fn unexpected(cursor: &Cursor) -> GcodeFault {
    let shown = cursor.rest().chars().take(1).flat_map(char::escape_debug).collect::<String>();
    GcodeFault::Character { shown: format!("`{shown}`") }
}

/// Returns the fault of a line that begins with a number, as those of Heidenhain Klartext do.
fn numbered_line(mut cursor: Cursor) -> GcodeFault {
    let start = cursor;
    cursor.take_while(|byte| byte.is_ascii_digit());
    cursor.peek();
    let line = cursor;
    let word = cursor.take_while(|byte| byte.is_ascii_alphabetic()).to_ascii_uppercase();
    match KLARTEXT.contains(&word.as_str()) || is_klartext_line(line.rest()) {
        true => GcodeFault::Klartext { word },
        false => unexpected(&start),
    }
}

/// Returns whether a line is a motion of Heidenhain Klartext: `L X+10 FMAX`, `C X+5 DR+`.
fn is_klartext_line(line: &str) -> bool {
    let mut words = line.split_ascii_whitespace();
    matches!(words.next(), Some("L" | "C" | "CR" | "CT" | "LP" | "LN"))
        && words
            .next()
            .is_some_and(|word| word.starts_with(['X', 'Y', 'Z', 'A', 'B', 'C', 'I', 'P']))
}

/// The label of a program or a subprogram.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(super) enum Label {
    Number(u32),
    /// A name in small letters without blanks, as names are compared.
    Name(String),
}

impl fmt::Display for Label {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Label::Number(number) => write!(f, "O{number}"),
            Label::Name(name) => write!(f, "O<{name}>"),
        }
    }
}

/// The word after a label.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Role {
    /// None: a program or subprogram of ISO 6983, which M30 or M99 ends.
    Title,
    /// `sub`: a subprogram of O-words, which `endsub` ends.
    Sub,
    EndSub,
    Call,
}

/// An O-word.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct OWord {
    pub(super) label: Label,
    pub(super) role: Role,
}

/// Reads an O-word. The label can be an expression.
pub(super) fn o_word(cursor: &mut Cursor, parameters: &Parameters) -> Result<OWord, GcodeFault> {
    cursor.advance();
    let label = match cursor.take(b'<') {
        true => {
            let name = cursor.take_until('>').ok_or(super::ExpressionFault::OpenName)?;
            let name: String = name.chars().filter(|c| !c.is_whitespace()).collect();
            Label::Name(name.to_lowercase())
        }
        false => match value(cursor, parameters)? {
            number if number.fract() == 0.0 && (0.0..=1e8).contains(&number) => {
                Label::Number(number as u32)
            }
            value => {
                let expected = "a whole number from 0";
                return Err(GcodeFault::NotAllowed { word: 'O', value, expected });
            }
        },
    };
    next(cursor)?;
    let word = cursor.take_while(|byte| byte.is_ascii_alphabetic());
    let role = match word.to_ascii_lowercase().as_str() {
        "" => Role::Title,
        "sub" => Role::Sub,
        "endsub" => Role::EndSub,
        "call" => Role::Call,
        _ => return Err(GcodeFault::ControlFlow { word: super::unquoted(word) }),
    };
    match next(cursor)? {
        None => Ok(OWord { label, role }),
        Some(b'[') if role != Role::Title => {
            let remedy = "assign parameters from #31 on before the call instead";
            let meaning = "a word with arguments";
            Err(not_read(word.to_ascii_lowercase(), meaning, remedy))
        }
        Some(_) => Err(unexpected(cursor)),
    }
}

/// A G or M word: its letter, and its number in tenths (`G43.4` is 434).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Code {
    pub(super) letter: char,
    pub(super) tenths: u32,
}

impl From<Code> for String {
    fn from(code: Code) -> String {
        code.to_string()
    }
}

impl Code {
    pub(super) fn is_m(&self) -> bool {
        self.letter == 'M'
    }
}

impl fmt::Display for Code {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Code { letter, tenths } = *self;
        match tenths % 10 {
            0 => write!(f, "{letter}{}", tenths / 10),
            part => write!(f, "{letter}{}.{part}", tenths / 10),
        }
    }
}

/// Groups of words of which a block can have one (RS274/NGC, table 4, and the words of other dialects).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Group {
    /// G0 to G3 and the canned cycles.
    Motion,
    /// G80, which may stand beside a motion.
    CycleOff,
    Plane,
    Units,
    Distance,
    ArcDistance,
    FeedMode,
    CutterCompensation,
    Length,
    WorkOffset,
    PathControl,
    Retract,
    Rotation,
    /// Words for one block that use axis words: G10, G28, G30, G52, G53.1, G92.
    OneShot,
    /// G53.
    Machine,
    /// G4.
    Dwell,
    /// M0, M1, M2, M30.
    Stop,
    /// M98 and M99.
    Subprogram,
    /// M6.
    ToolChange,
    /// M428 and M429.
    Kinematics,
    /// Words that neither move the tool nor change what positions mean. A block can have several.
    PassedOver,
}

/// The number of groups of which a block can have one word.
const GROUPS: usize = Group::PassedOver as usize;

/// Returns the group of a word.
///
/// # Errors
/// If the word is not read.
fn group(code: Code) -> Result<Group, GcodeFault> {
    match code.letter {
        'G' => g_group(code),
        _ => m_group(code),
    }
}

fn g_group(code: Code) -> Result<Group, GcodeFault> {
    Ok(match code.tenths {
        0 | 10 | 20 | 30 => Group::Motion,
        730 | 740 | 810 | 820 | 830 | 840 | 850 | 860 | 890 => Group::Motion,
        800 => Group::CycleOff,
        170 | 180 | 190 => Group::Plane,
        // G70 and G71, G700 and G710 are Sinumerik's.
        200 | 210 | 700 | 710 | 7000 | 7100 => Group::Units,
        900 | 910 => Group::Distance,
        901 | 911 => Group::ArcDistance,
        930 | 940 | 950 => Group::FeedMode,
        400 | 410 | 411 | 420 | 421 => Group::CutterCompensation,
        430 | 434 | 435 | 490 | 2340 => Group::Length,
        540 | 541 | 550 | 560 | 570 | 580 | 590 | 591 | 592 | 593 => Group::WorkOffset,
        // G187 is Haas'.
        50 | 51 | 80 | 610 | 611 | 640 | 1870 => Group::PathControl,
        980 | 990 => Group::Retract,
        680 | 682 | 690 => Group::Rotation,
        100 | 280 | 300 | 520 | 531 | 920 | 921 | 922 | 923 => Group::OneShot,
        530 => Group::Machine,
        40 => Group::Dwell,
        // Exact stop; polar coordinates, stored stroke check, scaling, mirroring and macro calls off; spindle
        // speed; blocks read ahead on Haas.
        90 | 150 | 230 | 500 | 501 | 670 | 960 | 970 | 1030 => Group::PassedOver,
        tenths => return Err(refused_g(code, tenths)),
    })
}

fn m_group(code: Code) -> Result<Group, GcodeFault> {
    Ok(match code.tenths {
        0 | 10 | 20 | 300 => Group::Stop,
        60 => Group::ToolChange,
        980 | 990 => Group::Subprogram,
        4280 | 4290 => Group::Kinematics,
        // Spindle and coolant, orientation of the spindle, rigid tapping, overrides.
        30 | 40 | 50 | 70 | 80 | 90 | 190 | 290 | 480 | 490 => Group::PassedOver,
        // Clamps of rotary axes, chip conveyor, gears, LinuxCNC's overrides and outputs, coolant
        // through the spindle, air jets.
        100 | 110 | 120 | 310 | 330 | 410 | 420 | 430 | 440 => Group::PassedOver,
        510 | 520 | 530 | 620 | 630 | 640 | 650 | 670 | 680 => Group::PassedOver,
        830 | 840 | 880 | 890 => Group::PassedOver,
        tenths => return Err(refused_m(code, tenths)),
    })
}

fn refused_g(code: Code, tenths: u32) -> GcodeFault {
    let (meaning, remedy) = match tenths {
        412..=416 | 422..=426 | 1410 => {
            ("three-dimensional cutter compensation", "post the program with the path of the tool")
        }
        401 => ("control of the normal direction", "post the program with the angles of the axis"),
        4500 | 4510 => (
            "the path around outside corners",
            "remove it, and state `outside_corner` of the control",
        ),
        52 | 53 | 61 | 62 => ("a spline", "post the program with lines and arcs"),
        70 => ("diameter mode of a lathe", "post the program for a mill"),
        160 => ("polar coordinates", "post the program with X Y Z"),
        281 | 301 => {
            ("storing a reference position", "state the position before the program instead")
        }
        270 | 290 => ("a reference return", "write G28 or G53"),
        310 | 382 | 383 | 384 | 385 => {
            ("probing, whose end only the machine knows", "check the program without it")
        }
        320 | 330 | 331 => ("threading", "check the program without it"),
        431 | 432 | 440 => ("another form of tool length offset", "write G43 H"),
        510 | 511 => ("scaling or mirroring", "post the program with final coordinates"),
        542 | 543 | 2540 | 2550 => ("a dynamic work offset", "write G68.2, or G43.4"),
        650 | 660 | 661 => ("a macro call", "post the program with its motions"),
        683 | 684 => ("another form of tilted plane", "write G68.2 with the angles I J K"),
        760 => ("fine boring or threading, by dialect", "post the program with its motions"),
        870 | 880 => {
            ("a boring cycle with a lateral or manual motion", "post the program with its motions")
        }
        _ => return GcodeFault::UnknownCode { word: code.to_string() },
    };
    not_read(code, meaning, remedy)
}

fn refused_m(code: Code, tenths: u32) -> GcodeFault {
    let (meaning, remedy) = match tenths {
        1280 | 1290 => {
            ("tool centre point control of Heidenhain", "write G43.4 H, and G49 to end it")
        }
        130 | 140 => (
            "the spindle with coolant, or a brake of a rotary axis on Haas",
            "write M3 or M4, and M8",
        ),
        170 => ("a return of Sinumerik", "write M99"),
        500 => (
            "a pallet change on Haas, and a switch of the override on LinuxCNC",
            "check the program without it",
        ),
        600 => ("a pallet change, which moves the part", "give one program per setup"),
        970 => ("a call of a block number", "write M98 with an O-number"),
        _ => return GcodeFault::UnknownCode { word: code.to_string() },
    };
    not_read(code, meaning, remedy)
}
