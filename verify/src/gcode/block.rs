//! One block: the words that a control executes together, in the terms of ISO 6983. Each dialect translates its text into
//! blocks.

use super::GcodeFault;
use super::control::Corner;
use super::error::same_group;
use super::words::{IGNORE, group};
use std::fmt;

/// Words of more than one letter that are read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Keyword {
    /// `TRAORI`: tool centre point control on.
    TransformationOn,
    /// `TRAFOOF`: tool centre point control off.
    TransformationOff,
}

/// A number after a letter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Number {
    pub(super) value: f64,
    /// Set if it is written without a decimal point.
    pub(super) is_whole: bool,
    /// Set if it is a variable or an expression.
    pub(super) is_computed: bool,
}

/// The meaning of a number that holds for its axis alone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Distance {
    Absolute,
    Incremental,
    /// A position of a rotary axis, to which it turns the shorter way.
    Shortest,
}

/// The words of a block. Words that no other word uses remain in it, and are refused at its end.
#[derive(Clone, Debug, Default)]
pub(super) struct Block {
    values: [f64; 26],
    /// Letters that the block has and that no word has used, as bits from A.
    unused: u32,
    codes: [Option<Code>; GROUPS],
    /// Words that are passed over.
    pub(super) passed_over: Vec<Code>,
    pub(super) keyword: Option<Keyword>,
    /// Coordinates that have no decimal point and are not zero, as bits from A.
    whole: u32,
    /// Letters whose number is a parameter or an expression, as bits from A.
    computed: u32,
    /// Letters with a distance mode of their own, those of them that are increments, and those that turn the shorter way, as bits
    /// from A.
    own_distance: u32,
    own_increment: u32,
    shortest: u32,
    /// The tool vector (A3, B3, C3).
    pub(super) vector: Option<[f64; 3]>,
    /// The corner at the end of a motion.
    pub(super) corner: Option<Corner>,
    /// The full turns of an arc beside its way to the end (TURN).
    pub(super) full_turns: u32,
    /// Set if G90 or G91 stands after a coordinate.
    pub(super) distance_after_coordinate: bool,
}

impl Block {
    pub(super) fn clear(&mut self) {
        self.unused = 0;
        self.codes = [None; GROUPS];
        self.passed_over.clear();
        self.keyword = None;
        (self.whole, self.computed) = (0, 0);
        (self.own_distance, self.own_increment, self.shortest) = (0, 0, 0);
        (self.vector, self.corner, self.full_turns) = (None, None, 0);
        self.distance_after_coordinate = false;
    }

    /// Returns whether the block has no word yet.
    pub(super) fn is_empty(&self) -> bool {
        self.unused == 0
            && self.codes.iter().all(Option::is_none)
            && self.passed_over.is_empty()
            && self.keyword.is_none()
            && self.corner.is_none()
    }

    /// Adds a letter with its number.
    ///
    /// # Errors
    /// If the block has the letter.
    pub(super) fn add(&mut self, letter: char, number: Number) -> Result<(), GcodeFault> {
        let bit = 1 << (letter as u8 - b'A');
        if self.unused & bit != 0 {
            return Err(GcodeFault::Repeated { word: letter });
        }
        self.unused |= bit;
        self.values[usize::from(letter as u8 - b'A')] = number.value;
        // Only these are counted in increments (`whole_numbers`).
        if number.is_whole && "XYZABCIJKRQ".contains(letter) && number.value != 0.0 {
            self.whole |= bit;
        }
        if number.is_computed {
            self.computed |= bit;
        }
        Ok(())
    }

    /// Gives the number after a letter a distance mode of its own.
    pub(super) fn set_distance(&mut self, letter: char, distance: Distance) {
        let bit = 1 << (letter as u8 - b'A');
        self.own_distance |= bit;
        self.own_increment |= if distance == Distance::Incremental { bit } else { 0 };
        self.shortest |= if distance == Distance::Shortest { bit } else { 0 };
    }

    /// Returns whether the axis of a letter turns the shorter way.
    pub(super) fn is_shortest(&self, letter: char) -> bool {
        self.shortest & (1 << (letter as u8 - b'A')) != 0
    }

    /// Returns the distance mode of the number after a letter, if it has one of its own: whether it is an increment.
    pub(super) fn own_distance(&self, letter: char) -> Option<bool> {
        let bit = 1 << (letter as u8 - b'A');
        (self.own_distance & bit != 0).then_some(self.own_increment & bit != 0)
    }

    /// Adds a G or M word.
    ///
    /// # Errors
    /// If it is not read, or if the block has another word of its group.
    pub(super) fn add_code(&mut self, code: Code) -> Result<(), GcodeFault> {
        let group = group(code)?;
        self.distance_after_coordinate |= group == Group::Distance && self.has_any("XYZABCIJK");
        match group {
            Group::PassedOver => self.passed_over.push(code),
            group => match &mut self.codes[group as usize] {
                Some(first) => return Err(same_group(*first, code)),
                empty => *empty = Some(code),
            },
        }
        Ok(())
    }

    /// Returns whether a number of the block is computed.
    pub(super) fn is_computed(&self) -> bool {
        self.computed != 0
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
            || self.codes().nth(1).is_some()
            || self.keyword.is_some()
    }

    /// Returns whether a word of the block can name axes without moving them, or by a path of its own. What it leaves of the axis
    /// words moves on some controls.
    pub(super) fn owns_axis_words(&self) -> bool {
        let owners = [Group::OneShot, Group::Machine, Group::Dwell, Group::Mirror];
        owners.into_iter().any(|group| self.code_of(group).is_some())
            || self.code_of(Group::Rotation).is_some_and(|code| code.tenths != 690)
            || self
                .passed_over
                .iter()
                .any(|code| code.letter == 'G' && matches!(code.tenths, 230 | 500 | 670))
    }

    /// Returns whether the block has a position in program coordinates for a motion.
    pub(super) fn is_programmed(&self) -> bool {
        self.has_any("XYZABCIJK")
            && [Group::OneShot, Group::Machine, Group::Mirror]
                .into_iter()
                .all(|group| self.code_of(group).is_none())
    }

    /// Returns whether the block has words besides a keyword, of which none was used.
    pub(super) fn has_words(&self) -> bool {
        self.unused != 0 || self.codes().next().is_some()
    }

    /// Returns the number after a letter that no word has used.
    pub(super) fn value(&self, letter: char) -> Option<f64> {
        self.has(letter).then_some(self.values[usize::from(letter as u8 - b'A')])
    }

    /// Replaces the number after a letter.
    pub(super) fn set(&mut self, letter: char, value: f64) {
        self.unused |= 1 << (letter as u8 - b'A');
        self.values[usize::from(letter as u8 - b'A')] = value;
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

    /// Drops letters that no word has used.
    pub(super) fn drop_letters(&mut self, letters: &str) {
        for letter in letters.bytes() {
            self.unused &= !(1 << (letter - b'A'));
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

/// A G or M word: its letter, and its number in tenths (`G43.4` is 434).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) struct Code {
    pub(super) letter: char,
    pub(super) tenths: u32,
}

impl From<Code> for String {
    fn from(code: Code) -> String {
        code.to_string()
    }
}

/// Returns whether a word of letters, in capitals, is read by a control, or decides what is executed.
pub(super) fn is_keyword(word: &str) -> bool {
    const WORDS: [&str; 22] = [
        "CALL", "CASE", "DO", "ELSE", "END", "ENDFOR", "ENDIF", "ENDLOOP", "ENDWHILE", "FOR",
        "GOTO", "GOTOB", "GOTOF", "IF", "LOOP", "REPEAT", "SUPA", "THEN", "TRAFOOF", "TRAORI",
        "UNTIL", "WHILE",
    ];
    WORDS.contains(&word.trim_end_matches(|c: char| c.is_ascii_digit()))
}

impl Code {
    /// Reads a G or M word in capitals, such as `G43.4`.
    pub(super) fn parse(word: &str) -> Option<Code> {
        let letter = word.chars().next().filter(|letter| matches!(letter, 'G' | 'M'))?;
        let number: f64 = word[1..].parse().ok()?;
        let tenths = (10.0 * number).round();
        let is_number = word[1..].starts_with(|c: char| c.is_ascii_digit())
            && (10.0 * number - tenths).abs() < 1e-9
            && tenths <= 99_999.0;
        is_number.then_some(Code { letter, tenths: tenths as u32 })
    }

    /// Returns whether nothing is known of an effect on the path.
    pub(super) fn can_be_ignored(self) -> bool {
        match group(self) {
            // The turn of the spindle has findings, M29 is the tapping of the next cycle, and G67 ends the calls of G66.
            Ok(_)
                if matches!(
                    (self.letter, self.tenths),
                    ('M', 30 | 40 | 50 | 190 | 290 | 890) | ('G', 670)
                ) =>
            {
                false
            }
            // The words of path control decide what is said of corners.
            Ok(group) => group == Group::PassedOver,
            Err(GcodeFault::NotRead { remedy, .. }) => remedy == IGNORE,
            // Work offsets and frames of Sinumerik, and its change of the language.
            Err(_) => !matches!(
                (self.letter, self.tenths),
                ('G', 1530 | 2900 | 2910 | 5000 | 5050..=5990)
            ),
        }
    }

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
    /// G15 and G16.
    Polar,
    /// G50.1 and G51.1.
    Mirror,
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
