//! The G and M words that are known: their modal groups, and the reasons for refusing the others.

use super::GcodeFault;
use std::fmt;

/// A G or M word: its letter, and its number in tenths (`G43.4` is 434).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Code {
    pub(super) letter: char,
    pub(super) tenths: u32,
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
pub(super) const GROUPS: usize = Group::PassedOver as usize;

/// Returns the group of a word.
///
/// # Errors
/// If the word is not read.
pub(super) fn group(code: Code) -> Result<Group, GcodeFault> {
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
        400 => Group::CutterCompensation,
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
        410 | 411 | 420 | 421 => {
            ("cutter radius compensation", "post the program with the path of the tool's centre")
        }
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
    GcodeFault::NotRead { word: code.to_string(), meaning, remedy }
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
    GcodeFault::NotRead { word: code.to_string(), meaning, remedy }
}
