//! The rules of a control: what it does where controls differ.
//!
//! A program means different motions on different controls wherever it leaves a choice to them. Each such choice is a
//! [`Rule`], and a control makes one [`Choice`] of each. `docs/controls.md` has the sources.

use super::block::{Code, is_keyword};
use super::{klartext, sinumerik};
use crate::codes::faults;
use crate::gcode::shown;
use std::collections::BTreeMap;
use std::fmt;
use toml::Spanned;

/// A choice that programs leave to the control.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[non_exhaustive]
pub enum Rule {
    /// The axes after a tool change (M6).
    ToolChange,
    /// The order of motions of a canned cycle that begins below its plane R.
    CycleBelowR,
    /// The way of a rotary axis without limits to an absolute position.
    Rotary,
    /// The path of several axes in rapid traverse (G0).
    Rapid,
    /// Numbers without a decimal point.
    WholeNumbers,
    /// Text after a semicolon.
    Semicolon,
    /// The unit before the first G20 or G21.
    Unit,
    /// The tool length offset after a return to the reference position (G28, G30).
    ReferenceReturn,
    /// The tool length without G43.
    ToolLength,
    /// The spindle after a stop (M0, M1).
    Stop,
    /// The level to which a canned cycle returns before the first G98 or G99.
    CycleReturn,
    /// The tool length offset under G53.
    MachineCoordinates,
    /// The work offset before the first G54 to G59.
    StartOffset,
    /// The meaning of words.
    Dialect,
    /// The register of a G43 without H.
    LengthRegister,
    /// The shift by G92 after a G92.1 without axis words.
    PresetEnd,
    /// A change of the tool length offset in a block without Z.
    LengthChange,
    /// The word for the repeats of a canned cycle.
    CycleRepeats,
    /// Numbers after R and Q without a decimal point, where those of axes are increments.
    WholeRadii,
    /// Coordinates under tool centre point control that begins while the table is turned.
    TcpStart,
    /// The tool axis between two positions of the rotary axes under `TRAORI`.
    ToolOrientation,
    /// The work offset after `TRAORI` and `TRAFOOF`.
    TransformationOffset,
    /// The path around an outside corner under cutter compensation.
    OutsideCorner,
    /// The first and the last motion of cutter compensation.
    CompensationStart,
    /// The directions of the rotary axes of a machine of the library, whose file is not that of a real one.
    RotaryDirection,
    /// The length of a tool that a rotary axis of the head tilts, under M428.
    HeadLength,
    /// The rotary axis whose lower or higher value the direction of CYCLE800 selects.
    SwivelAxis,
    /// Blocks that begin with `/`: the operator's switch, which no control states.
    OptionalBlocks,
}

/// An action of a control under a [`Rule`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[non_exhaustive]
#[allow(missing_docs)]
pub enum Choice {
    Stays,
    Retracts,
    Moves,
    RaisesFirst,
    SidewaysFirst,
    Counts,
    Shortest,
    WithinTurn,
    Straight,
    EachAxis,
    Units,
    Increments,
    Comment,
    EndOfBlock,
    Millimetre,
    Inch,
    KeepsLength,
    CancelsLength,
    CancelsLengthByG53,
    WithG43,
    Always,
    KeepsSpindle,
    StopsSpindle,
    InitialLevel,
    PlaneR,
    WithoutLength,
    WithLength,
    FirstOffset,
    NoOffset,
    Iso,
    Rs274Ngc,
    Sinumerik,
    Heidenhain,
    OfTool,
    LastH,
    EndsPreset,
    KeepsPreset,
    WithNextZ,
    MovesZ,
    RepeatsByL,
    RepeatsByK,
    TableAtZero,
    TableAsItStands,
    ByAxes,
    GreatCircle,
    DeselectsOffset,
    KeepsOffset,
    ArcCorner,
    StraightCorner,
    NextMotion,
    OutsideCorners,
    EntryMotion,
    Iso841,
    Reversed,
    ReversedA,
    ReversedB,
    ReversedC,
    Compensated,
    AlongZ,
    FirstAxis,
    SecondAxis,
    Executed,
    LeftOut,
}

/// The choices of one rule: its key, what it is about, and for each choice its word and its meaning.
struct Entry {
    rule: Rule,
    key: &'static str,
    about: &'static str,
    choices: &'static [(Choice, &'static str, &'static str)],
}

/// All rules. Without a statement the interpreter makes the first choice of each.
const RULES: [Entry; 28] = [
    Entry {
        rule: Rule::ToolChange,
        key: "tool_change",
        about: "the axes after M6",
        choices: &[
            (Choice::Stays, "stays", "they stay where they are"),
            (Choice::Retracts, "retracts", "Z is at its home, the others stay"),
            (Choice::Moves, "moves", "they are where only the machine knows"),
        ],
    },
    Entry {
        rule: Rule::CycleBelowR,
        key: "cycle_below_r",
        about: "a canned cycle that begins below R",
        choices: &[
            (Choice::RaisesFirst, "raises first", "rises to R, then moves sideways"),
            (Choice::SidewaysFirst, "sideways first", "moves sideways, then rises to R"),
        ],
    },
    Entry {
        rule: Rule::Rotary,
        key: "rotary",
        about: "a rotary axis without limits, to an absolute position",
        choices: &[
            (Choice::Counts, "counts", "turns by the difference: C345 to C15 by -330 degrees"),
            (Choice::Shortest, "shortest", "turns the shorter way: C345 to C15 by +30 degrees"),
            (
                Choice::WithinTurn,
                "within a turn",
                "turns between angles from 0 to 360: C345 to C15 by -330 degrees, C450 to C280 by +190",
            ),
        ],
    },
    Entry {
        rule: Rule::Rapid,
        key: "rapid",
        about: "several axes in rapid traverse",
        choices: &[
            (Choice::Straight, "straight", "move on a straight line"),
            (Choice::EachAxis, "each axis", "move each at its own rate: a dog-leg"),
        ],
    },
    Entry {
        rule: Rule::WholeNumbers,
        key: "whole_numbers",
        about: "a coordinate without a decimal point",
        choices: &[
            (Choice::Units, "units", "Z5 is 5 mm, inches or degrees"),
            (Choice::Increments, "increments", "Z5 is 0.005 mm or degrees, or 0.0005 inch"),
        ],
    },
    Entry {
        rule: Rule::Semicolon,
        key: "semicolon",
        about: "the text after `;`",
        choices: &[
            (Choice::Comment, "comment", "is a comment"),
            (Choice::EndOfBlock, "end of block", "is the next block"),
        ],
    },
    Entry {
        rule: Rule::Unit,
        key: "unit",
        about: "lengths before G20 or G21",
        choices: &[
            (Choice::Millimetre, "mm", "are in millimetres"),
            (Choice::Inch, "inch", "are in inches"),
        ],
    },
    Entry {
        rule: Rule::ReferenceReturn,
        key: "reference_return",
        about: "the tool length offset after G28 or G30",
        choices: &[
            (Choice::KeepsLength, "keeps length", "stays in force"),
            (Choice::CancelsLength, "cancels length", "is off, as after G49"),
            (Choice::CancelsLengthByG53, "cancels length, as G53", "is off, also after G53"),
        ],
    },
    Entry {
        rule: Rule::ToolLength,
        key: "tool_length",
        about: "the length of the tool in the spindle",
        choices: &[
            (Choice::WithG43, "with G43", "counts after G43 H only"),
            (Choice::Always, "always", "counts from the tool change on"),
        ],
    },
    Entry {
        rule: Rule::Stop,
        key: "stop",
        about: "the spindle after M0 or M1",
        choices: &[
            (Choice::KeepsSpindle, "keeps spindle", "turns on"),
            (Choice::StopsSpindle, "stops spindle", "stands until the next M3 or M4"),
        ],
    },
    Entry {
        rule: Rule::CycleReturn,
        key: "cycle_return",
        about: "a canned cycle before G98 or G99",
        choices: &[
            (Choice::InitialLevel, "initial level", "returns to the level at which it began (G98)"),
            (Choice::PlaneR, "plane R", "returns to R (G99)"),
        ],
    },
    Entry {
        rule: Rule::MachineCoordinates,
        key: "machine_coordinates",
        about: "Z under G53 with a tool length offset",
        choices: &[
            (Choice::WithoutLength, "without length", "is that of the spindle's gauge point"),
            (Choice::WithLength, "with length", "is that of the tip"),
        ],
    },
    Entry {
        rule: Rule::StartOffset,
        key: "start_offset",
        about: "the work offset before G54 to G59",
        choices: &[
            (Choice::FirstOffset, "G54", "is G54"),
            (Choice::NoOffset, "none", "is none: positions are the machine's"),
        ],
    },
    Entry {
        rule: Rule::Dialect,
        key: "dialect",
        about: "words",
        choices: &[
            (Choice::Iso, "iso", "mean what they mean on Fanuc and Haas"),
            (
                Choice::Rs274Ngc,
                "rs274ngc",
                "mean what they mean on LinuxCNC: R of G10 L2 rotates a work offset, and cycles are along the normal of the plane",
            ),
            (
                Choice::Sinumerik,
                "sinumerik",
                "mean what they mean in native programs of Sinumerik: G58 and G59 are shifts, and G70 and G71 select the unit",
            ),
            (
                Choice::Heidenhain,
                "heidenhain",
                "mean what they mean in DIN/ISO programs of Heidenhain: I, J and K are the position of the pole, and G28, \
                 G43, G54, G73, G98, G99, M98, M99 and others are not read",
            ),
        ],
    },
    Entry {
        rule: Rule::LengthRegister,
        key: "length_register",
        about: "G43 without H",
        choices: &[
            (Choice::OfTool, "of the tool", "takes the register of the tool in the spindle"),
            (Choice::LastH, "last H", "takes the H before, or none"),
        ],
    },
    Entry {
        rule: Rule::PresetEnd,
        key: "preset_end",
        about: "the shift by G92 after G92.1 without axis words",
        choices: &[
            (Choice::EndsPreset, "ends", "is off"),
            (Choice::KeepsPreset, "stays", "stays in force"),
        ],
    },
    Entry {
        rule: Rule::LengthChange,
        key: "length_change",
        about: "G43 or G49 in a block without Z",
        choices: &[
            (
                Choice::WithNextZ,
                "with the next Z",
                "moves nothing: the next Z is to the new length",
            ),
            (Choice::MovesZ, "moves Z", "moves Z by the change of the length"),
        ],
    },
    Entry {
        rule: Rule::CycleRepeats,
        key: "cycle_repeats",
        about: "the repeats of a canned cycle",
        choices: &[
            (Choice::RepeatsByL, "L", "are the number after L"),
            (Choice::RepeatsByK, "K", "are the number after K"),
        ],
    },
    Entry {
        rule: Rule::WholeRadii,
        key: "whole_radii",
        about: "a number after R or Q without a decimal point, where those of axes are increments",
        choices: &[
            (Choice::Increments, "increments", "R5 is 0.005 mm or degrees, or 0.0005 inch"),
            (Choice::Units, "units", "R5 is 5 mm, inches or degrees"),
        ],
    },
    Entry {
        rule: Rule::TcpStart,
        key: "tcp_start",
        about: "coordinates under tool centre point control (G43.4) or in a tilted plane (G68.2) that begins while the table is turned",
        choices: &[
            (Choice::TableAtZero, "table at zero", "are those of the part with its axes at 0"),
            (
                Choice::TableAsItStands,
                "table as it stands",
                "are those of the part as it stands, and are not followed",
            ),
        ],
    },
    Entry {
        rule: Rule::ToolOrientation,
        key: "tool_orientation",
        about: "the tool axis between two positions of the rotary axes under TRAORI",
        choices: &[
            (Choice::ByAxes, "by axes", "turns with the axes, each in proportion (ORIAXES)"),
            (
                Choice::GreatCircle,
                "great circle",
                "turns in the plane of both directions (ORIVECT), and is not followed",
            ),
        ],
    },
    Entry {
        rule: Rule::TransformationOffset,
        key: "traori_offset",
        about: "the work offset after TRAORI and TRAFOOF",
        choices: &[
            (Choice::DeselectsOffset, "deselects", "is deselected, until it is programmed again"),
            (Choice::KeepsOffset, "keeps", "stays in force"),
        ],
    },
    Entry {
        rule: Rule::OutsideCorner,
        key: "outside_corner",
        about: "the tool at an outside corner under cutter compensation",
        choices: &[
            (Choice::ArcCorner, "arc", "moves on an arc about the corner"),
            (
                Choice::StraightCorner,
                "straight",
                "moves straight on to where the paths meet, and above a turn of 90 degrees by two points",
            ),
        ],
    },
    Entry {
        rule: Rule::CompensationStart,
        key: "compensation_start",
        about: "the tool at the end of the first motion of cutter compensation",
        choices: &[
            (Choice::NextMotion, "next motion", "is beside the start of the next one (type A)"),
            (
                Choice::OutsideCorners,
                "outside corners",
                "is so at inside corners, and goes around outside ones, also before the last motion (type B)",
            ),
            (
                Choice::EntryMotion,
                "entry motion",
                "is beside that motion, and goes on as at other corners",
            ),
        ],
    },
    Entry {
        rule: Rule::RotaryDirection,
        key: "rotary_direction",
        about: "a positive command of a rotary axis of a built-in machine",
        choices: &[
            (
                Choice::Iso841,
                "iso 841",
                "turns the tool counter-clockwise relative to the part, a table clockwise",
            ),
            (
                Choice::Reversed,
                "reversed",
                "turns the other way: a table counter-clockwise, as LinuxCNC's xyzac-trt and xyzbc-trt without `conventional-directions`",
            ),
            (Choice::ReversedA, "A reversed", "turns the other way on A alone"),
            (Choice::ReversedB, "B reversed", "turns the other way on B alone"),
            (Choice::ReversedC, "C reversed", "turns the other way on C alone"),
        ],
    },
    Entry {
        rule: Rule::HeadLength,
        key: "head_length",
        about: "the length of a tool that the head tilts, under M428",
        choices: &[
            (
                Choice::Compensated,
                "compensated",
                "is along the tool, so that the tip is where the program says",
            ),
            (
                Choice::AlongZ,
                "along z",
                "is along z of the machine, as in releases of LinuxCNC's maxkins, and is not followed",
            ),
        ],
    },
    Entry {
        rule: Rule::SwivelAxis,
        key: "swivel_axis",
        about: "the rotary axis of two positions of which CYCLE800 takes the lower or the higher one, by its direction",
        choices: &[
            (Choice::FirstAxis, "first", "is the first of the machine's rotary axes A, B, C"),
            (Choice::SecondAxis, "second", "is the second of them"),
        ],
    },
    Entry {
        rule: Rule::OptionalBlocks,
        key: "optional_blocks",
        about: "blocks that begin with `/`",
        choices: &[
            (Choice::Executed, "executed", "are executed"),
            (Choice::LeftOut, "left out", "are left out"),
        ],
    },
];

/// The name of no control, of which no rule is stated.
pub const GENERIC: &str = "generic";

/// The controls that are known by name.
const CONTROLS: [&str; 5] = ["fanuc", "haas", "linuxcnc", "siemens", "heidenhain"];

/// Their choices, a column per control, in the order of [`RULES`] without the operator's switch. Each is the control as
/// delivered: a builder can set most of them otherwise.
#[rustfmt::skip]
const CONTROL_CHOICES: [[Choice; 5]; 27] = {
    use Choice::*;
    [
        [Moves,           Retracts,      Stays,         Moves,         Moves],
        [SidewaysFirst,   SidewaysFirst, RaisesFirst,   SidewaysFirst, SidewaysFirst],
        [Shortest,        Counts,        Counts,        WithinTurn,    Counts],
        [EachAxis,        EachAxis,      Straight,      Straight,      Straight],
        [Increments,      Increments,    Units,         Units,         Units],
        [EndOfBlock,      EndOfBlock,    Comment,       Comment,       Comment],
        [Millimetre,      Inch,          Millimetre,    Millimetre,    Millimetre],
        [KeepsLength,     CancelsLength, KeepsLength,   KeepsLength,   KeepsLength],
        [WithG43,         WithG43,       WithG43,       Always,        Always],
        [KeepsSpindle,    StopsSpindle,  KeepsSpindle,  KeepsSpindle,  StopsSpindle],
        [InitialLevel,    InitialLevel,  PlaneR,        InitialLevel,  InitialLevel],
        [WithoutLength,   WithoutLength, WithoutLength, WithLength,    WithoutLength],
        [FirstOffset,     FirstOffset,   FirstOffset,   NoOffset,      FirstOffset],
        [Iso,             Iso,           Rs274Ngc,      Sinumerik,     Heidenhain],
        [LastH,           LastH,         OfTool,        OfTool,        OfTool],
        [KeepsPreset,     KeepsPreset,   EndsPreset,    EndsPreset,    EndsPreset],
        [MovesZ,          MovesZ,        WithNextZ,     WithNextZ,     WithNextZ],
        [RepeatsByK,      RepeatsByL,    RepeatsByL,    RepeatsByK,    RepeatsByL],
        [Increments,      Units,         Units,         Units,         Units],
        [TableAsItStands, TableAtZero,   TableAtZero,   TableAtZero,   TableAtZero],
        [ByAxes,          ByAxes,        ByAxes,        ByAxes,        ByAxes],
        [KeepsOffset,     KeepsOffset,   KeepsOffset,   KeepsOffset,   KeepsOffset],
        [StraightCorner,  StraightCorner, ArcCorner,    ArcCorner,     ArcCorner],
        [NextMotion,      NextMotion,    EntryMotion,   NextMotion,    NextMotion],
        [Iso841,          Iso841,        Iso841,        Iso841,        Iso841],
        [Compensated,     Compensated,   Compensated,   Compensated,   Compensated],
        [FirstAxis,       FirstAxis,     FirstAxis,     FirstAxis,     FirstAxis],
    ]
};

/// Rules that a control leaves to a parameter without a usual value: every choice is a reading.
const OPEN: [(&str, Rule); 13] = [
    ("fanuc", Rule::ReferenceReturn),
    ("fanuc", Rule::LengthChange),
    // K, and L on the Series 15 and in its format.
    ("fanuc", Rule::CycleRepeats),
    ("haas", Rule::LengthChange),
    // Setting 162 does not list R and Q.
    ("haas", Rule::WholeRadii),
    // The pin `conventional-directions` of its kinematics, which is off unless a configuration sets it.
    ("linuxcnc", Rule::RotaryDirection),
    ("linuxcnc", Rule::HeadLength),
    // Native programs have no G43, and those in ISO mode need it.
    ("siemens", Rule::ToolLength),
    // Within a turn in native programs, the shorter way in ISO mode (MD20734).
    ("siemens", Rule::Rotary),
    ("siemens", Rule::ToolOrientation),
    // MD10602, by which the machine's builder clears the frame with the change of the axes.
    ("siemens", Rule::TransformationOffset),
    // The swivel data record of the machine.
    ("siemens", Rule::SwivelAxis),
    // The display of the axis below 360 degrees, and M126.
    ("heidenhain", Rule::Rotary),
];

impl Rule {
    /// Returns all rules.
    pub fn all() -> impl Iterator<Item = Rule> {
        RULES.iter().map(|entry| entry.rule)
    }

    fn entry(self) -> &'static Entry {
        // The table is in the order of the enum, which a test checks.
        &RULES[self as usize]
    }

    /// Returns the key that states the rule in a control's file.
    pub fn key(self) -> &'static str {
        self.entry().key
    }

    /// Returns what the rule is about.
    pub fn about(self) -> &'static str {
        self.entry().about
    }

    /// Returns whether each choice is a reading of its own. The other rules are judged by the choice that includes all.
    pub(crate) fn is_branched(self) -> bool {
        !matches!(self, Rule::ToolChange | Rule::Unit | Rule::StartOffset | Rule::Dialect)
    }

    /// Returns whether the choice depends on the machine.
    fn is_of_machine(self) -> bool {
        matches!(self, Rule::RotaryDirection | Rule::HeadLength | Rule::SwivelAxis)
    }

    /// Returns whether a control's file need not state the rule: the operator's switch, and what depends on the machine.
    fn is_optional(self) -> bool {
        self.is_of_machine() || self == Rule::OptionalBlocks
    }

    /// Returns the choices, of which the first is made where none is stated.
    pub fn choices(self) -> impl Iterator<Item = Choice> {
        self.entry().choices.iter().map(|(choice, ..)| *choice)
    }

    /// Returns the word of a choice in a control's file, and its meaning.
    ///
    /// # Panics
    /// Panics for a choice of another rule.
    pub fn describe(self, choice: Choice) -> [&'static str; 2] {
        let known = self.entry().choices.iter().find(|(known, ..)| *known == choice);
        known.map(|(_, word, meaning)| [*word, *meaning]).expect("a choice of the rule")
    }
}

/// The choices of a control, as far as they are stated.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ControlRules {
    stated: BTreeMap<Rule, Choice>,
    /// Words that are passed over, each with its reason.
    ignored: BTreeMap<String, String>,
}

/// The table of a control's file, or of a job, with words that are passed over.
const IGNORE: &str = "ignore";

impl ControlRules {
    /// Returns the names of the controls that are known.
    pub fn names() -> impl Iterator<Item = &'static str> {
        CONTROLS.into_iter()
    }

    /// Returns a control that is known by name: it states every rule but the operator's switch for
    /// [optional blocks](Rule::OptionalBlocks), and what depends on a parameter that is set either way. [`GENERIC`] states none, so that
    /// a result holds for each of them.
    ///
    /// # Errors
    /// [`ControlError::UnknownName`] for another name.
    pub fn named(name: &str) -> Result<ControlRules, ControlError> {
        if name == GENERIC {
            return Ok(ControlRules::default());
        }
        let Some(control) = CONTROLS.iter().position(|known| *known == name) else {
            return Err(ControlError::UnknownName {
                name: shown(name),
                nearest: closest(name, ControlRules::names().chain([GENERIC])),
            });
        };
        let stated = Rule::all().zip(CONTROL_CHOICES.map(|choices| choices[control]));
        Ok(ControlRules {
            stated: stated.filter(|(rule, _)| !OPEN.contains(&(name, *rule))).collect(),
            ignored: BTreeMap::new(),
        })
    }

    /// Parses a control from TOML: every rule by its key, but for the operator's switch and rules that depend on the machine, which may
    /// be missing, and in the table `ignore` the words that it passes over, each with a reason. `file` is the file's name in errors.
    ///
    /// # Errors
    /// If the text is not TOML, or if a key is unknown or missing, or its value is no choice.
    ///
    /// ```
    /// use touchoff_verify::gcode::{Choice, ControlRules, Rule};
    ///
    /// let text = ControlRules::named("linuxcnc")?.to_toml();
    /// let control = ControlRules::parse(&text, "mine.toml")?;
    /// assert_eq!(control.get(Rule::Rapid), Some(Choice::Straight));
    /// let error = ControlRules::parse(&text.replace("rapid", "rapids"), "mine.toml").expect_err("a key");
    /// assert!(error.to_string().contains("`rapids` is no rule: did you mean `rapid`?"), "{error}");
    /// # Ok::<(), touchoff_verify::gcode::ControlError>(())
    /// ```
    pub fn parse(text: &str, file: &str) -> Result<ControlRules, ControlError> {
        let refused = |start: usize, fault: ControlFault| {
            let line = 1 + text[..start].matches('\n').count();
            ControlError::Line { file: file.to_owned(), line, fault }
        };
        let parsed: BTreeMap<Spanned<String>, Spanned<toml::Value>> = toml::from_str(text)
            .map_err(|error| {
                let message = error.message().trim().replace('\n', ", ");
                let start = error.span().map_or(0, |span| span.start);
                refused(start, ControlFault::Syntax { message })
            })?;
        let mut stated = BTreeMap::new();
        let mut ignoring = ControlRules::default();
        for (key, value) in &parsed {
            let word = key.get_ref();
            if word == IGNORE {
                let words = value.get_ref().as_table().into_iter().flatten();
                for (word, reason) in words {
                    let reason = reason.as_str().unwrap_or_default();
                    ignoring
                        .ignore(word, reason)
                        .map_err(|fault| refused(key.span().start, fault))?;
                }
                continue;
            }
            let Some(entry) = RULES.iter().find(|entry| entry.key == word) else {
                let nearest = closest(word, RULES.iter().map(|entry| entry.key));
                let fault = ControlFault::UnknownRule { key: shown(word), nearest };
                return Err(refused(key.span().start, fault));
            };
            let choice = value
                .get_ref()
                .as_str()
                .and_then(|value| entry.choices.iter().find(|(_, known, _)| *known == value));
            let Some((choice, ..)) = choice else {
                let words: Vec<String> =
                    entry.choices.iter().map(|(_, known, _)| format!("\"{known}\"")).collect();
                let fault = ControlFault::Choice { key: entry.key, choices: words.join(", ") };
                return Err(refused(value.span().start, fault));
            };
            stated.insert(entry.rule, *choice);
        }
        match RULES
            .iter()
            .find(|entry| !entry.rule.is_optional() && !stated.contains_key(&entry.rule))
        {
            None => Ok(ControlRules { stated, ignored: ignoring.ignored }),
            Some(Entry { key, about, .. }) => {
                Err(ControlError::Missing { file: file.to_owned(), key, about })
            }
        }
    }

    /// Returns the choice of a rule, if it is stated.
    pub fn get(&self, rule: Rule) -> Option<Choice> {
        self.stated.get(&rule).copied()
    }

    /// States a rule.
    #[must_use]
    pub fn with(mut self, rule: Rule, choice: Choice) -> ControlRules {
        self.stated.insert(rule, choice);
        self
    }

    /// Passes over a word that is not read: a G or M word, or a name with its arguments. The reason is that for which it can
    /// neither move the tool nor change what positions mean, and is repeated with the verdict.
    ///
    /// # Errors
    /// If the reason is empty, or if the word is read and has an effect, or is known to have one.
    pub fn ignoring(mut self, word: &str, reason: &str) -> Result<ControlRules, ControlError> {
        self.ignore(word, reason)?;
        Ok(self)
    }

    /// Passes over a word for a reason, as [`ControlRules::ignoring`] does.
    fn ignore(&mut self, word: &str, reason: &str) -> Result<(), ControlFault> {
        let upper = word.trim().to_ascii_uppercase();
        // `M08` is M8.
        let upper = Code::parse(&upper).map_or(upper, |code| code.to_string());
        let is_reason = !reason.trim().is_empty() && !reason.contains(char::is_control);
        match (can_be_ignored(&upper), is_reason) {
            (false, _) => Err(ControlFault::HasEffect { word: shown(word) }),
            (true, false) => Err(ControlFault::NoReason { word: shown(word) }),
            (true, true) => {
                self.ignored.insert(upper, reason.trim().to_owned());
                Ok(())
            }
        }
    }

    /// Passes over a word, whatever its effect, and returns whether it was not passed over before.
    pub(super) fn pass_over(&mut self, word: &str) -> bool {
        self.ignored.insert(word.to_ascii_uppercase(), String::new()).is_none()
    }

    /// Passes over a word no longer.
    pub(super) fn pass_over_no_longer(&mut self, word: &str) {
        self.ignored.remove(&word.to_ascii_uppercase());
    }

    /// Returns the words that are passed over, each with its reason.
    pub fn ignored(&self) -> &BTreeMap<String, String> {
        &self.ignored
    }

    /// States the rules of another, where these do not.
    #[must_use]
    pub fn and(mut self, other: &ControlRules) -> ControlRules {
        for (rule, choice) in &other.stated {
            self.stated.entry(*rule).or_insert(*choice);
        }
        for (word, reason) in &other.ignored {
            self.ignored.entry(word.clone()).or_insert_with(|| reason.clone());
        }
        self
    }

    /// Writes the rules as a control's file. One that is not stated is a comment with its choices.
    pub fn to_toml(&self) -> String {
        let rules = Rule::all().filter(|rule| *rule != Rule::OptionalBlocks);
        let lines = rules.map(|rule| {
            let (key, about) = (rule.key(), rule.about());
            match self.get(rule) {
                Some(choice) => {
                    let [word, meaning] = rule.describe(choice);
                    format!("# {about}: {meaning}\n{key} = \"{word}\"\n")
                }
                None => {
                    let words =
                        rule.choices().map(|choice| format!("\"{}\"", rule.describe(choice)[0]));
                    let words = words.collect::<Vec<_>>().join(" or ");
                    format!("# {about}: state {key} = {words}\n")
                }
            }
        });
        let mut text: String = lines.collect();
        if !self.ignored.is_empty() {
            text += &format!("[{IGNORE}]\n");
            for (word, reason) in &self.ignored {
                let reason = reason.replace('\\', r"\\").replace('"', r#"\""#);
                text += &format!("{word} = \"{reason}\"\n");
            }
        }
        text
    }
}

/// Returns whether nothing is known of an effect of a word, in capitals.
fn can_be_ignored(word: &str) -> bool {
    if klartext::is_ignorable(word) {
        return true;
    }
    let is_name = word.len() > 1
        && word.chars().all(|c| c.is_ascii_alphanumeric() || c == '_')
        && word.starts_with(|c: char| c.is_ascii_alphabetic());
    match Code::parse(word) {
        Some(code) => code.can_be_ignored(),
        None => {
            let is_address =
                word.get(1..).is_some_and(|rest| rest.chars().all(|c| c.is_ascii_digit()));
            is_name && !is_address && !is_keyword(word) && !sinumerik::has_effect(word)
        }
    }
}

/// The rules as the keys of a file: `rapid = "straight", unit = "mm"`.
impl fmt::Display for ControlRules {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, (rule, choice)) in self.stated.iter().enumerate() {
            let comma = if index > 0 { ", " } else { "" };
            write!(f, "{comma}{} = \"{}\"", rule.key(), rule.describe(*choice)[0])?;
        }
        Ok(())
    }
}

faults! {
    #[family("K04", "Controls: names and files")]
    /// A control that cannot be read.
    #[derive(Clone, PartialEq, Eq, thiserror::Error)]
    #[non_exhaustive]
    pub enum ControlError {
        /// A name that is that of no known control.
        #[code = K0401]
        #[error(
            "{name} is no control that is known: did you mean `{nearest}`? `touchoff controls` lists them, and a file ends in `.toml`"
        )]
        UnknownName {
            /// The name.
            name: String,
            /// The nearest known one.
            nearest: &'static str,
        },
        /// A line of the file is refused.
        #[code_of(fault)]
        #[error("{file}:{line}: {fault}")]
        Line {
            /// The file.
            file: String,
            /// The line, 1-based.
            line: usize,
            /// The fault in it.
            fault: ControlFault,
        },
        /// A word cannot be passed over.
        #[code_of(0)]
        #[error(transparent)]
        NotIgnored(#[from] ControlFault),
        /// A rule that the file does not state.
        ///
        /// A control's file states all rules, so that nothing of it is assumed.
        #[code = K0402]
        #[error(
            "{file}: the rule `{key}` is missing ({about}): state it; `touchoff controls NAME` prints a whole file"
        )]
        Missing {
            /// The file.
            file: String,
            /// The key.
            key: &'static str,
            /// The subject of the rule.
            about: &'static str,
        },
    }
}

faults! {
    #[family("K05", "Controls: rules and words that are passed over")]
    /// A fault in a line of a control's file, or a word that cannot be passed over.
    #[derive(Clone, PartialEq, Eq, thiserror::Error)]
    #[non_exhaustive]
    pub enum ControlFault {
        /// A text that is not TOML.
        #[code = K0501]
        #[error("{message}")]
        Syntax {
            /// The parser's message.
            message: String,
        },
        /// A key that is no rule.
        #[code = K0502]
        #[error("{key} is no rule: did you mean `{nearest}`?")]
        UnknownRule {
            /// The escaped key.
            key: String,
            /// The nearest known one.
            nearest: &'static str,
        },
        /// A value that is no choice of its rule.
        #[code = K0503]
        #[error("`{key}` is one of {choices}")]
        Choice {
            /// The rule's key.
            key: &'static str,
            /// Its choices, as a list.
            choices: String,
        },
        /// A word to be ignored that has an effect.
        ///
        /// A word is passed over only if it is not known to move the tool or to change what positions mean.
        #[code = K0504]
        #[error("{word} cannot be ignored: it has an effect, or is no G or M word and no name")]
        HasEffect {
            /// The escaped word.
            word: String,
        },
        /// A word to be ignored without a reason.
        ///
        /// The reason is repeated with the verdict, since the check relies on it.
        #[code = K0505]
        #[error(
            "{word} cannot be ignored: its reason is missing, or is no line of text: write `WORD = \"reason\"`"
        )]
        NoReason {
            /// The escaped word.
            word: String,
        },
    }
}

/// Returns the known word with the fewest changes of letters.
fn closest(word: &str, known: impl Iterator<Item = &'static str>) -> &'static str {
    // A word of any length is not compared as a whole.
    let word: String = word.chars().take(40).collect();
    known.min_by_key(|known| strsim::damerau_levenshtein(known, &word)).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_is_in_the_order_of_the_enum_and_controls_choose_what_it_has() {
        for (index, rule) in Rule::all().enumerate() {
            assert_eq!(rule as usize, index, "{rule:?}");
        }
        for name in ControlRules::names() {
            let mut control = ControlRules::named(name).expect("a control");
            let open = OPEN.iter().filter(|(open, rule)| *open == name && !rule.is_optional());
            for (_, rule) in open {
                let error = ControlRules::parse(&control.to_toml(), name).expect_err("it is open");
                assert!(error.to_string().contains("is missing"), "{error}");
                let first = rule.choices().next().expect("a choice");
                control = control.with(*rule, first);
            }
            let file = control.to_toml();
            assert_eq!(ControlRules::parse(&file, name), Ok(control), "{file}");
        }
    }

    #[test]
    fn a_file_with_a_fault_is_refused_with_its_line_and_the_nearest_key() {
        let file = ControlRules::named("linuxcnc").expect("a control").to_toml();
        let refused = |from: &str, to: &str| {
            let text = file.replace(from, to);
            ControlRules::parse(&text, "c.toml").expect_err(&text).to_string()
        };
        let line = |key: &str| 1 + file[..file.find(key).expect("a key")].matches('\n').count();
        assert_eq!(
            refused("\ncycle_below_r", "\ncycle_below"),
            format!(
                "c.toml:{}: `cycle_below` is no rule: did you mean `cycle_below_r`?",
                line("cycle_below_r")
            )
        );
        assert_eq!(
            refused("\"counts\"", "true"),
            format!(
                "c.toml:{}: `rotary` is one of \"counts\", \"shortest\", \"within a turn\"",
                line("rotary =")
            )
        );
        assert!(refused("stop = ", "# stop = ").contains("the rule `stop` is missing"));
        assert!(refused("\"straight\"", "\"straight").starts_with("c.toml:"));
        let unknown = ControlRules::named("fanac").expect_err("a name").to_string();
        assert!(unknown.contains("did you mean `fanuc`?"), "{unknown}");
    }
}
