//! Errors of the interpreter.

use super::control::WRITE_OUT;
use super::iso::ExpressionFault;
use crate::codes::faults;

/// A line that stops the interpreter.
#[derive(Clone, PartialEq, thiserror::Error)]
#[error("line {line}: {fault}")]
pub struct GcodeError {
    /// The line, 1-based.
    pub line: usize,
    /// The fault in it.
    pub fault: GcodeFault,
}

touchoff::debug_as_sentence!(GcodeError);

impl GcodeError {
    /// Returns the stable [code](crate::codes) of the fault.
    pub fn code(&self) -> &'static str {
        self.fault.code()
    }
}

faults! {
    #[family("P01", "Programs of controls: words, blocks and subprograms")]
    /// A fault in a line of a G-code program.
    #[derive(Clone, PartialEq, thiserror::Error)]
    #[non_exhaustive]
    pub enum GcodeFault {
        /// A character that begins no word.
        #[code = P0101]
        #[error("the character {shown} begins no word of G-code: correct the line where it was posted")]
        Character {
            /// The escaped character.
            shown: String,
        },
        /// A carriage return that ends a line on some controls only.
        #[code = P0102]
        #[error(
            "a carriage return without a line feed ends the line on some controls only: save the file with line feeds"
        )]
        LoneReturn,
        /// A comment without its end.
        #[code = P0103]
        #[error("the comment has no `)`, or another `(` in it: close it on its line")]
        OpenComment,
        /// A word without a number.
        #[code = P0104]
        #[error("{word} has no number: write one after the letter")]
        NoNumber {
            /// The word's letter.
            word: char,
        },
        /// A number beyond the largest one that is read.
        #[code = P0105]
        #[error("the number of {word} is beyond {}: correct it", super::LARGEST_NUMBER)]
        TooLarge {
            /// The word's letter.
            word: char,
        },
        /// A number that has to be a whole number in a range.
        #[code = P0106]
        #[error("{word}{value} is not understood: write {expected}")]
        NotAllowed {
            /// The word's letter.
            word: char,
            /// The number.
            value: f64,
            /// The numbers that are.
            expected: &'static str,
        },
        /// A fault in a parameter or an expression.
        #[code_of(0)]
        #[error(transparent)]
        Expression(#[from] ExpressionFault),
        /// A name that is no word of the dialects that are read.
        #[code = P0107]
        #[error(
            "`{word}` is not understood and could move the tool: post the program as ISO G-code, or remove the word if \
             it moves nothing"
        )]
        UnknownWord {
            /// The word.
            word: String,
        },
        /// A word of Heidenhain's conversational programs in another program.
        #[code = P0108]
        #[error(
            "`{word}` is a word of Heidenhain Klartext: begin the program with `BEGIN PGM NAME MM`, or post it as ISO G-code"
        )]
        Klartext {
            /// The word.
            word: String,
        },
        /// A program of Heidenhain Klartext for another control.
        #[code = P0109]
        #[error(
            "the program is Heidenhain Klartext, and `dialect` of the control is \"{dialect}\": name the control `heidenhain`"
        )]
        OtherControl {
            /// The dialect that is stated.
            dialect: &'static str,
        },
        /// A text that is not what Klartext has at its place.
        #[code = P0110]
        #[error("`{shown}` is not understood here: write {expected}")]
        Sentence {
            /// The text.
            shown: String,
            /// The texts that are.
            expected: &'static str,
        },
        /// A label that is not in the program.
        #[code = P0111]
        #[error("there is no {label} in this program: add the label, or correct the call")]
        NoLabel {
            /// The label, for example `LBL 1`.
            label: String,
        },
        /// A statement that decides at run time what is executed.
        #[code = P0112]
        #[error(
            "`{word}` decides while the program runs what is executed, which is not read: post the program without it"
        )]
        ControlFlow {
            /// The statement.
            word: String,
        },
        /// An axis that is not read.
        #[code = P0113]
        #[error("the axis {word} is not read: post the program with X Y Z A B C")]
        Axis {
            /// The axis's letter.
            word: char,
        },
        /// A G or M word that is not known.
        #[code = P0114]
        #[error(
            "{word} is not understood and could move the tool or change what positions mean: post the program without \
             it, or remove it if it does neither"
        )]
        UnknownCode {
            /// The word.
            word: String,
        },
        /// A known word that is not read.
        #[code = P0115]
        #[error("{word} is {meaning}, which is not read: {remedy}")]
        NotRead {
            /// The word.
            word: String,
            /// Its meaning.
            meaning: &'static str,
            /// The remedy.
            remedy: &'static str,
        },
        /// A letter that stands twice in a block.
        #[code = P0116]
        #[error("{word} stands twice in the block: give each letter once")]
        Repeated {
            /// The letter.
            word: char,
        },
        /// Two words of one modal group.
        #[code = P0117]
        #[error("{first} and {second} exclude each other in one block: keep one of them")]
        SameGroup {
            /// The word before.
            first: String,
            /// The word after it.
            second: String,
        },
        /// A word that no G or M word of the block uses.
        #[code = P0118]
        #[error(
            "{word} is used by no G or M word of its block, and moves the tool on some controls: post the program without it, or \
             add the word that uses it"
        )]
        Unused {
            /// The word's letter.
            word: char,
        },
        /// A G or M word without a word that it needs.
        #[code = P0119]
        #[error("{word} needs {needed}: add it{}", if is_elsewhere(needed) { "" } else { " to the block" })]
        Missing {
            /// The word.
            word: String,
            /// The missing word.
            needed: &'static str,
        },
        /// Words that controls combine in different ways, or do not allow together.
        #[code = P0120]
        #[error("{word} while {condition} differs between controls: {remedy}")]
        Combination {
            /// The word.
            word: String,
            /// The condition in force.
            condition: &'static str,
            /// The remedy.
            remedy: &'static str,
        },
        /// Axis words without a motion mode.
        #[code = P0121]
        #[error("axis words without a motion mode: write G0, G1, G2 or G3 in this block or before")]
        NoMotionMode,
        /// A motion at feed rate without a feed rate.
        #[code = P0122]
        #[error(
            "{word} needs a feed rate: write F with a positive number in this block{}",
            if *.inverse { " (G93)" } else { " or before" }
        )]
        NoFeed {
            /// The motion word.
            word: String,
            /// Set if G93 is in force, under which every block needs its own.
            inverse: bool,
        },
        /// A fault in an arc.
        #[code_of(0)]
        #[error(transparent)]
        Arc(#[from] ArcFault),
        /// A fault of cutter radius compensation.
        #[code_of(0)]
        #[error(transparent)]
        Compensation(#[from] CompensationFault),
        /// A canned cycle whose plane R is not above its depth.
        #[code = P0123]
        #[error(
            "the plane R {retract} is not above the depth {depth} of the cycle (mm): correct or exchange them"
        )]
        CycleBelow {
            /// The plane, in millimetres.
            retract: f64,
            /// The depth, in millimetres.
            depth: f64,
        },
        /// A canned cycle that takes more steps than the limit.
        #[code = P0124]
        #[error("the cycle takes more than {} motions: correct Q, L or K", super::MAX_CYCLE_STEPS)]
        CycleTooLong,
        /// A tool vector of length zero.
        #[code = P0125]
        #[error(
            "the tool vector I J K is zero and points nowhere: give the direction from the tip to the spindle"
        )]
        NoDirection,
        /// A subprogram that is in no file.
        #[code = P0126]
        #[error(
            "there is no {label} in this file, nor in those that the job names: append the subprogram, or name its file in `subprograms` of \
             the job"
        )]
        NoSubprogram {
            /// The label, for example `O100`.
            label: String,
        },
        /// A label that stands twice.
        #[code = P0127]
        #[error("{label} is already defined in line {first}: give it another number")]
        SecondLabel {
            /// The label.
            label: String,
            /// The line of the first.
            first: usize,
        },
        /// A `sub` or `endsub` at a wrong place.
        #[code = P0128]
        #[error("{label} {word}: {problem}")]
        Nesting {
            /// The label.
            label: String,
            /// `sub` or `endsub`.
            word: &'static str,
            /// The problem, and the remedy.
            problem: &'static str,
        },
        /// A sequence number that the program does not have.
        #[code = P0129]
        #[error("there is no N{number} in this program: write it before the block at which to go on")]
        NoSequenceNumber {
            /// The number.
            number: u32,
        },
        /// A sequence number that stands twice, and is a target.
        #[code = P0130]
        #[error(
            "N{number} stands in lines {first} and {second}, of which controls find one or the other: number the blocks anew"
        )]
        SecondSequenceNumber {
            /// The number.
            number: u32,
            /// The line of the first.
            first: usize,
            /// The line of another.
            second: usize,
        },
        /// A loop or a decision without its other end.
        #[code = P0131]
        #[error(
            "the loop or decision has no other end: add `END` with its number, or the `DO` that it ends"
        )]
        OpenLoop,
        /// A letter that is no argument of a macro.
        #[code = P0132]
        #[error("{word} is no argument of {call}: post the call with the letters of its arguments")]
        NotAnArgument {
            /// The letter.
            word: char,
            /// The word that calls the macro.
            call: String,
        },
        /// More arguments than a subprogram has.
        #[code = P0133]
        #[error("a call has more than 30 arguments: pass the others in global parameters")]
        TooManyArguments,
        /// An alarm that the program raises.
        #[code = P0134]
        #[error("the program stops with alarm {number} here (#3000): correct what it has found")]
        Alarm {
            /// Its number.
            number: f64,
        },
        /// A subprogram of one dialect that is called or ended as one of another.
        #[code = P0135]
        #[error("{label} is {what}: {remedy}")]
        MixedCall {
            /// The label.
            label: String,
            /// The kind of subprogram.
            what: &'static str,
            /// The remedy.
            remedy: &'static str,
        },
        /// An end of a subprogram outside one.
        #[code = P0136]
        #[error("{word} ends no subprogram here: {remedy}")]
        StrayReturn {
            /// The word.
            word: String,
            /// The remedy.
            remedy: &'static str,
        },
        /// A program that runs into the next one.
        #[code = P0137]
        #[error("the program runs into {label}: end it with M30 (or M99 for a subprogram) before")]
        RunsInto {
            /// The label.
            label: String,
        },
        /// The end of the file before the end of the program.
        #[code = P0138]
        #[error(
            "the program stops here without M2, M30, END PGM or %: post it again, or add its end if this is the end"
        )]
        Unfinished,
        /// Subprograms that call each other too deeply.
        #[code = P0139]
        #[error(
            "subprograms call each other more than {} deep: remove the recursion",
            super::MAX_CALLS
        )]
        TooDeep,
        /// More assignments in a block than LinuxCNC keeps.
        #[code = P0140]
        #[error(
            "a block has more than {} assignments, which LinuxCNC mixes up: write them in several blocks",
            super::MAX_ASSIGNMENTS
        )]
        Assignments,
        /// A statement of a loop or a branch without the other one that it belongs to.
        #[code = P0141]
        #[error("{word} {problem}")]
        Structure {
            /// The statement.
            word: &'static str,
            /// The problem, and the remedy.
            problem: &'static str,
        },
        /// A program of another unit than that of the one that calls it.
        #[code = P0142]
        #[error(
            "the program is in another unit than the one that calls it: post both in the same unit"
        )]
        OtherUnit,
        /// A subprogram that two files have.
        #[code = P0143]
        #[error("{label} is in two files, {first} and {second}: name one of them in `subprograms`")]
        TwoFiles {
            /// The label.
            label: String,
            /// The file of the first.
            first: String,
            /// The file of the second.
            second: String,
        },
        /// A fault in another file than that of the program, or in that of the program after a call from another one.
        #[code_of(fault)]
        #[error("{name}, line {line}: {fault}")]
        InFile {
            /// The file of subprograms, or words for the program.
            name: String,
            /// The line, 1-based.
            line: usize,
            /// The fault in it.
            fault: Box<GcodeFault>,
        },
        /// Subprograms, loops and jumps that take too many blocks and steps.
        #[code = P0144]
        #[error(
            "loops, jumps and subprograms take more than {limit} blocks and motions in each reading of the program: end the loop, reduce the \
             repeats, or state the control and the variables, so that there are fewer readings"
        )]
        TooLong {
            /// The largest number of them.
            limit: usize,
        },
    }
}

/// The first words of conditions of a block, whatever stands before it.
const OF_BLOCK: [&str; 3] = ["its block", "its number", "other words"];
/// The words for what stands in other blocks.
const ELSEWHERE: [&str; 2] = ["before", "after it"];

/// Returns whether a condition or a need is one of other blocks.
fn is_elsewhere(text: &str) -> bool {
    ELSEWHERE.iter().any(|word| text.contains(word))
}

impl GcodeFault {
    /// Returns the fault without the file that has it.
    pub(crate) fn innermost(&self) -> &GcodeFault {
        match self {
            GcodeFault::InFile { fault, .. } => fault.innermost(),
            fault => fault,
        }
    }

    /// Returns whether the fault is one of the block itself: whether it would be there whatever the blocks before have done to the
    /// state of the control.
    pub(super) fn is_of_block(&self) -> bool {
        match self.innermost() {
            GcodeFault::Combination { condition, .. } => {
                OF_BLOCK.iter().any(|start| condition.starts_with(start))
                    && !is_elsewhere(condition)
            }
            GcodeFault::Missing { needed, .. } => !is_elsewhere(needed),
            GcodeFault::NotRead { remedy, .. } => *remedy != WRITE_OUT,
            GcodeFault::Expression(fault) => !matches!(fault, ExpressionFault::Tie { .. }),
            GcodeFault::Unused { .. }
            | GcodeFault::NoMotionMode
            | GcodeFault::NoFeed { .. }
            | GcodeFault::Arc(_)
            | GcodeFault::Compensation(_)
            | GcodeFault::CycleBelow { .. }
            | GcodeFault::CycleTooLong
            | GcodeFault::RunsInto { .. }
            | GcodeFault::StrayReturn { .. }
            | GcodeFault::MixedCall { .. }
            | GcodeFault::Nesting { .. }
            | GcodeFault::OpenLoop
            | GcodeFault::Alarm { .. }
            | GcodeFault::TooDeep
            | GcodeFault::TooLong { .. }
            | GcodeFault::Unfinished => false,
            _ => true,
        }
    }

    /// Returns the word that is not read, without which the rest of its block can be: a G or M word, or a name that is not known. Known names
    /// begin statements, to which the rest belongs.
    pub(super) fn unread_word(&self) -> Option<&str> {
        let is_name =
            |word: &str| word.chars().all(|c| c.is_ascii_alphanumeric() || "_.$".contains(c));
        let is_code = |word: &str| {
            let number = word.strip_prefix(['G', 'M']);
            number.is_some_and(|number| number.starts_with(|c: char| c.is_ascii_digit()))
        };
        match self.innermost() {
            GcodeFault::UnknownWord { word } | GcodeFault::UnknownCode { word } => {
                Some(word.as_str()).filter(|word| is_name(word))
            }
            GcodeFault::NotRead { word, .. } if is_code(word) => Some(word),
            GcodeFault::NotRead { word, .. } => {
                word.strip_prefix('`')?.strip_suffix('`').filter(|word| is_name(word))
            }
            _ => None,
        }
    }

    /// Returns whether what is not read can be a call, which assigns variables.
    pub(super) fn leaves_call_out(&self) -> bool {
        let unread = self.innermost();
        let is_name = matches!(unread, GcodeFault::NotRead { word, .. } if word.starts_with('`'));
        is_name
            || matches!(unread, GcodeFault::NoSubprogram { .. } | GcodeFault::UnknownWord { .. })
    }
}

/// Returns [`GcodeFault::Combination`]. A condition of the block alone begins with one of [`OF_BLOCK`].
pub(super) fn combination(
    word: impl Into<String>,
    condition: &'static str,
    remedy: &'static str,
) -> GcodeFault {
    GcodeFault::Combination { word: word.into(), condition, remedy }
}

/// Returns [`GcodeFault::NotRead`].
pub(super) fn not_read(
    word: impl Into<String>,
    meaning: &'static str,
    remedy: &'static str,
) -> GcodeFault {
    GcodeFault::NotRead { word: word.into(), meaning, remedy }
}

/// Returns [`GcodeFault::Missing`]. What other blocks lack is needed [before or after](ELSEWHERE).
pub(super) fn missing(word: impl Into<String>, needed: &'static str) -> GcodeFault {
    GcodeFault::Missing { word: word.into(), needed }
}

/// Returns [`GcodeFault::SameGroup`].
pub(super) fn same_group(first: impl Into<String>, second: impl Into<String>) -> GcodeFault {
    GcodeFault::SameGroup { first: first.into(), second: second.into() }
}

faults! {
    #[family("P03", "Programs of controls: arcs")]
    /// A fault in an arc.
    #[derive(Clone, PartialEq, thiserror::Error)]
    #[non_exhaustive]
    pub enum ArcFault {
        /// Neither a centre nor a radius.
        #[code = P0301]
        #[error("the arc has neither a centre nor a radius: write {centre}, or R")]
        NoCentre {
            /// The letters of the centre.
            centre: &'static str,
        },
        /// A centre and a radius.
        #[code = P0302]
        #[error("the arc has a centre and a radius: write one of them")]
        CentreAndRadius,
        /// A coordinate of the centre that is not in the plane of the arc.
        #[code = P0303]
        #[error("{letter} is not in the plane of the arc: write {centre}, or select another plane")]
        OtherPlane {
            /// The letter.
            letter: char,
            /// The letters of the centre.
            centre: &'static str,
        },
        /// An absolute centre (G90.1) with one coordinate.
        #[code = P0304]
        #[error("under G90.1 the centre needs both coordinates: write {centre}")]
        HalfCentre {
            /// The letters of the centre.
            centre: &'static str,
        },
        /// Start and end have different distances from the centre.
        #[code = P0305]
        #[error(
            "start and end have the distances {start} and {end} (mm) from the centre, which differ by more than \
             {tolerance:.4}: correct the end or the centre"
        )]
        Radii {
            /// Distance of the start, in millimetres.
            start: f64,
            /// Distance of the end, in millimetres.
            end: f64,
            /// The tolerance, in millimetres.
            tolerance: f64,
        },
        /// A centre on the start or the end, or a radius of zero.
        #[code = P0306]
        #[error("the arc has the radius zero: correct its centre or its radius")]
        ZeroRadius,
        /// A radius that does not reach the end.
        #[code = P0307]
        #[error(
            "the radius {radius} is less than half the distance from start to end, {half} (mm): correct it"
        )]
        TooShort {
            /// The radius, in millimetres.
            radius: f64,
            /// Half of the chord, in millimetres.
            half: f64,
        },
        /// A radius with an end that is the start.
        #[code = P0308]
        #[error("the arc ends where it starts, so its radius leaves the centre open: write {centre}")]
        SamePoint {
            /// The letters of the centre.
            centre: &'static str,
        },
    }
}

faults! {
    #[family("P04", "Programs of controls: cutter radius compensation")]
    /// A fault of cutter radius compensation (G41, G42). Lengths are in millimetres.
    #[derive(Clone, PartialEq, thiserror::Error)]
    #[non_exhaustive]
    pub enum CompensationFault {
        /// A radius that is not stated.
        #[code = P0401]
        #[error(
            "the radius offset {number} is not known: state it in mm in the job, by `radius_offset` of `[tool.{number}]` or as \
             `D{number}` in `[radius_offsets]`"
        )]
        NoRadius {
            /// The number after D, or of the tool.
            number: u32,
        },
        /// A position in the plane that only the machine knows.
        #[code = P0402]
        #[error(
            "cutter compensation needs a known position in its plane: write both coordinates in G90 before G41 or G42"
        )]
        Unknown,
        /// A first motion that is shorter than the offset.
        #[code = P0403]
        #[error(
            "the first motion of cutter compensation is {length} long, and the radius offset {offset} (mm): begin farther away"
        )]
        ShortEntry {
            /// The length of the motion.
            length: f64,
            /// The radius offset.
            offset: f64,
        },
        /// A first motion along an arc.
        #[code = P0404]
        #[error("cutter compensation begins with an arc: write G0 or G1 in the block of G41 or G42")]
        ArcEntry,
        /// A first motion along an arc on which the tool cannot come to its offset.
        #[code = P0405]
        #[error(
            "the tool cannot come beside the arc with which cutter compensation begins: begin with G1"
        )]
        EntryArc,
        /// A motion back to the programmed path along an arc.
        #[code = P0406]
        #[error("the motion after G40 is an arc: write G0 or G1, which ends cutter compensation")]
        ArcExit,
        /// A motion across the plane between G40 and the one that ends compensation.
        #[code = P0407]
        #[error(
            "a motion across the plane follows G40, and the tool leaves its offset before or after it: write G40 in the block of a motion in \
             the plane"
        )]
        ExitAcross,
        /// An arc inside which the tool does not fit.
        #[code = P0408]
        #[error(
            "the tool is inside an arc of radius {radius}, which is not larger than the radius offset {offset} (mm), and would gouge: take a \
             smaller tool or a larger arc"
        )]
        InsideArc {
            /// The radius of the arc.
            radius: f64,
            /// The radius offset.
            offset: f64,
        },
        /// An inside corner into which the tool does not fit.
        #[code = P0409]
        #[error(
            "the tool does not fit into the inside corner at the end of the motion of line {line}, and would gouge: one of both motions is \
             shorter than what the radius offset cuts off at its corners"
        )]
        NoRoom {
            /// The line of the motion before the corner, 1-based.
            line: usize,
        },
        /// A motion across the plane in an outside corner that has two points.
        #[code = P0410]
        #[error(
            "a motion across the plane follows an outside corner of less than 90 degrees, around which the tool moves by two points: write it \
             elsewhere"
        )]
        MotionInCorner,
        /// More blocks without a motion in the plane than the control reads ahead.
        #[code = P0411]
        #[error(
            "{blocks} blocks without a motion in the plane of cutter compensation stand before this one, and controls read {most} ahead: write \
             them before G41 or G42, or in the blocks of motions"
        )]
        LookAhead {
            /// The number of blocks.
            blocks: usize,
            /// The number that is read ahead.
            most: usize,
        },
    }
}
