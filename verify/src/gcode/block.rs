//! One block: the words that a control executes together, in the terms of ISO 6983. Each dialect translates its text into
//! blocks.

use super::GcodeFault;
use super::error::{not_read, same_group};
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
        (self.vector, self.full_turns) = (None, 0);
        self.distance_after_coordinate = false;
    }

    /// Returns whether the block has no word yet.
    pub(super) fn is_empty(&self) -> bool {
        self.unused == 0
            && self.codes.iter().all(Option::is_none)
            && self.passed_over.is_empty()
            && self.keyword.is_none()
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
        matches!(
            group(self),
            Ok(Group::PassedOver | Group::PathControl) | Err(GcodeFault::UnknownCode { .. })
        )
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
        // M97 is Haas'.
        970 | 980 | 990 => Group::Subprogram,
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
        _ => return GcodeFault::UnknownCode { word: code.to_string() },
    };
    not_read(code, meaning, remedy)
}
