//! The words of Klartext: what each is, and what is done with it. The parser takes its refusals from these tables, and
//! `docs/controls.md` prints them.

use crate::gcode::GcodeFault;
use crate::gcode::error::not_read;

/// Treatment of a word.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Treatment {
    Read,
    /// It can neither move the tool nor change what positions mean: a note names it.
    PassedOver,
    /// It is refused, with a remedy.
    Refused(&'static str),
}

/// A word.
#[derive(Clone, Copy, Debug)]
pub(super) struct Entry {
    pub(super) word: &'static str,
    pub(super) meaning: &'static str,
    pub(super) treatment: Treatment,
}

impl Entry {
    /// Refuses the word, if it is not read.
    pub(super) fn check(&self) -> Result<(), GcodeFault> {
        match self.treatment {
            Treatment::Refused(remedy) => Err(not_read(self.word, self.meaning, remedy)),
            Treatment::Read | Treatment::PassedOver => Ok(()),
        }
    }
}

impl Entry {
    /// Returns whether it is a cycle of the machine's builder, which a job can pass over.
    pub(super) fn is_of_builder(&self) -> bool {
        self.treatment == Treatment::Refused(BUILDER)
    }
}

/// Returns the entry of a cycle.
pub(super) fn find_cycle(number: u32) -> Option<&'static Entry> {
    let word = match number {
        300..400 => BUILDERS.to_owned(),
        number => number.to_string(),
    };
    find(&CYCLES, &word)
}

/// Returns whether an M word moves the tool or changes what positions mean, as far as it is known.
pub(in crate::gcode) fn has_effect(word: &str) -> bool {
    find(&M_WORDS, word).is_some_and(|entry| entry.treatment != Treatment::PassedOver)
}

/// Returns the entry of a word.
pub(super) fn find(table: &'static [Entry], word: &str) -> Option<&'static Entry> {
    table.iter().find(|entry| entry.word == word)
}

const fn read(word: &'static str, meaning: &'static str) -> Entry {
    Entry { word, meaning, treatment: Treatment::Read }
}

const fn passed(word: &'static str, meaning: &'static str) -> Entry {
    Entry { word, meaning, treatment: Treatment::PassedOver }
}

const fn refused(word: &'static str, meaning: &'static str, remedy: &'static str) -> Entry {
    Entry { word, meaning, treatment: Treatment::Refused(remedy) }
}

const MOTIONS: &str = "post the program with its motions";
const LINES: &str = "post the program with L, C, CR and CT";
const WITHOUT: &str = "check the program without it";
const SPATIAL: &str = "write PLANE SPATIAL";
const CENTRE: &str = "post the program with the path of the tool's centre, R0";
/// The numbers that are left to the builders of machines.
const BUILDERS: &str = "300 to 399";
const BUILDER: &str = "name it in `[ignore]` of the job with the reason for which it moves nothing, or check the program without it";
const OWN: &str = "the path of the cycle is the control's own: post the program with its motions";

/// The words that begin a block.
pub(super) const STATEMENTS: [Entry; 50] = [
    read("BEGIN PGM", "the head of the program, with its unit"),
    read("END PGM", "the end of the program"),
    read("L", "a line"),
    read("C", "an arc about the pole CC"),
    read("CC", "the pole"),
    read("CR", "an arc by its radius"),
    read("CT", "an arc that begins in the direction of the motion before"),
    read("LP", "a line to polar coordinates"),
    read("CP", "an arc or a helix about the pole by its angle"),
    read("CTP", "CT to polar coordinates"),
    read("RND", "a rounded corner between two lines or arcs in the plane"),
    read("CHF", "a chamfer between two lines in the plane at a right angle"),
    read(
        "TOOL CALL",
        "a tool change, by the number of the tool, or by the `name` that the job's `[tool.N]` states; DL raises the tip along the tool",
    ),
    read("TOOL DEF", "the length of a tool, or the tool that is called next"),
    read("LBL", "a label"),
    read("CALL LBL", "a subprogram, or a section that is repeated (REP)"),
    read("CALL PGM", "a program of a file that the job names"),
    read("Q", "a formula (Q, QL, QR)"),
    read("FN", "arithmetic and jumps: see below"),
    read("IF", "a jump, as FN 9 to FN 12"),
    read("CYCL DEF", "a cycle: see below"),
    read(
        "CYCL CALL",
        "the cycle at the present position, or at another one (POS), alone in its block but for F and M words of the machine",
    ),
    read("PLANE", "a tilted plane: see below"),
    read("TRANS DATUM", "the datum shift, as CYCL DEF 7"),
    read("FUNCTION TCPM", "tool centre point control, as M128, with AXIS POS and PATHCTRL AXIS"),
    read("FUNCTION RESET", "its end"),
    read("STOP", "a stop, as M0, alone in its block but for M words of the machine"),
    passed("BLK FORM", "the blank; a job can take its box for the stock (`blank = true`)"),
    passed("FUNCTION DWELL", "a dwell"),
    passed("FUNCTION MODE", "the mode of the machine, MILL alone"),
    refused("APPR", "an approach to a compensated contour", CENTRE),
    refused("DEP", "a departure from a compensated contour", CENTRE),
    refused(
        "LN",
        "a line with a normal of the surface",
        "post the program with L and the axes A, B and C",
    ),
    refused("LT", "a line of a contour that the control completes", LINES),
    refused("FL", "free contour programming", LINES),
    refused("FLT", "free contour programming", LINES),
    refused("FC", "free contour programming", LINES),
    refused("FCT", "free contour programming", LINES),
    refused("FPOL", "free contour programming", LINES),
    refused("FSELECT", "free contour programming", LINES),
    refused("SPL", "a spline", LINES),
    refused(
        "CALL SELECTED",
        "a call of another program, which is another file",
        "insert its blocks as a subprogram (LBL)",
    ),
    refused("SEL", "a table or a program, which is another file", MOTIONS),
    refused(
        "CYCL CALL PAT",
        "the cycle at the points of a pattern",
        "write CYCL CALL POS or M99 for each point",
    ),
    refused("PATTERN", "a pattern of points", "write CYCL CALL POS or M99 for each point"),
    refused("CONTOUR", "the contour of a cycle whose path is the control's own", MOTIONS),
    refused("GLOBAL", "values for several cycles", "write them in each cycle"),
    refused("TCH PROBE", "probing, whose end only the machine knows", WITHOUT),
    refused("DECLARE", "a parameter of text", "write numbers instead"),
    refused("FUNCTION", "another function of the control", MOTIONS),
];

/// The M words.
pub(super) const M_WORDS: [Entry; 57] = [
    read("M0", "a stop"),
    read("M1", "an optional stop"),
    read("M2", "the end of the program"),
    read("M3", "the spindle clockwise, from the start of the block"),
    read("M4", "the spindle counter-clockwise, from the start of the block"),
    read("M5", "the spindle off, at the end of the block"),
    read("M13", "M3 and M8"),
    read("M14", "M4 and M8"),
    read("M19", "the orientation of the spindle, which stands then"),
    read("M30", "the end of the program"),
    read("M89", "the cycle after each motion, until M99"),
    read(
        "M91",
        "machine coordinates; a rotary axis turns alone, also in an aligned plane, whose positions are not followed after it",
    ),
    read("M92", "coordinates from a point of the builder, which the machine's file states (`m92`)"),
    read("M99", "the cycle after the motion"),
    read("M126", "the shorter way of rotary axes"),
    read("M127", "its end"),
    read("M128", "tool centre point control"),
    read("M129", "its end"),
    read("M140", "a retract along the tool axis, by MB or to the end of the travel (MB MAX)"),
    passed("M7", "coolant"),
    passed("M8", "coolant"),
    passed("M9", "coolant"),
    passed("M90", "the speed in corners"),
    passed("M102", "the end of M101"),
    passed("M103", "the feed along the tool axis"),
    passed("M107", "an error for the delta of replacement tools"),
    passed("M108", "its end"),
    passed("M109", "the feed at the cutting edge"),
    passed("M110", "the feed at the cutting edge"),
    passed("M111", "its end"),
    passed("M116", "the feed of rotary axes"),
    passed("M117", "its end"),
    passed("M136", "a feed per turn"),
    passed("M137", "its end"),
    passed("M120", "the look-ahead of a compensated contour"),
    passed("M134", "an exact stop of rotary axes"),
    passed("M135", "its end"),
    passed("M141", "the monitoring of the probe"),
    passed("M145", "the end of M144"),
    passed("M148", "the lift-off at a stop"),
    passed("M149", "its end"),
    refused("M6", "a tool change by hand", "write TOOL CALL"),
    refused("M60", "a pallet change, which moves the part", "give one program per setup"),
    refused("M94", "another count of a rotary axis", "write angles from 0 to 360"),
    refused("M97", "small steps of a compensated contour", CENTRE),
    refused("M98", "open corners of a compensated contour", CENTRE),
    refused("M101", "a change to a replacement tool whenever the tool is worn", WITHOUT),
    refused("M104", "the datum before the program", "write CYCL DEF 247"),
    refused("M118", "motions by hand during the program", WITHOUT),
    refused("M124", "points that the control leaves out", WITHOUT),
    refused(
        "M130",
        "a position in the untilted plane",
        "write the position without it, after PLANE RESET",
    ),
    refused("M138", "the axes that a tilted plane turns", WITHOUT),
    refused("M143", "the end of a basic rotation that the operator has set", WITHOUT),
    refused(
        "M144",
        "positions that follow the axes without tool centre point control",
        "write M128",
    ),
    refused("M150", "a motion beyond the limits of an axis", WITHOUT),
    refused("M197", "a rounded corner of a compensated contour", "write RND"),
    refused("M200", "a laser", WITHOUT),
];

/// The numbers of FN.
pub(super) const FUNCTIONS: [Entry; 25] = [
    read("FN 0", "an assignment"),
    read("FN 1", "a sum"),
    read("FN 2", "a difference"),
    read("FN 3", "a product"),
    read("FN 4", "a quotient (DIV)"),
    read("FN 5", "a root (SQRT)"),
    read("FN 6", "a sine (SIN)"),
    read("FN 7", "a cosine (COS)"),
    read("FN 8", "the root of a sum of squares (LEN)"),
    read("FN 9", "a jump if equal (EQU)"),
    read("FN 10", "a jump if unequal (NE)"),
    read("FN 11", "a jump if greater (GT)"),
    read("FN 12", "a jump if less (LT)"),
    read("FN 13", "an angle (ANG)"),
    refused("FN 14", "an error at which the control stops", "correct the values that lead to it"),
    passed("FN 15", "text for a file or the screen"),
    passed("FN 16", "text for a file or the screen"),
    refused("FN 17", "writing to the control", WITHOUT),
    refused("FN 18", "a value that only the machine knows", "assign it as a number"),
    refused("FN 19", "a value for the machine's own program", WITHOUT),
    refused("FN 20", "waiting for the machine's own program", WITHOUT),
    refused("FN 26", "a table, which is another file", "assign its values as numbers"),
    refused("FN 27", "a table, which is another file", "assign its values as numbers"),
    refused("FN 28", "a table, which is another file", "assign its values as numbers"),
    refused("FN 29", "values for the machine's own program", WITHOUT),
];

/// The forms of PLANE, and the words after them.
pub(super) const PLANES: [Entry; 18] = [
    read("SPATIAL", "by the angles SPA, SPB and SPC about the fixed x, y and z, in this order"),
    read("EULER", "by the angles EULPR, EULNU and EULROT about z, the new x and the new z"),
    read("VECTOR", "by its x (BX BY BZ) and its normal (NX NY NZ)"),
    read("RELATIV", "by one more angle SPA, SPB or SPC about an axis of the plane"),
    read("RESET", "none"),
    read("TURN", "the rotary axes turn to the plane, and X Y Z rest"),
    read(
        "STAY",
        "the axes rest; `L A+Q120 B+Q121 C+Q122` turns them, or numbers that are compared with the plane",
    ),
    read(
        "MOVE",
        "the rotary axes turn, and X Y Z follow about a point below the tip by DIST, which rests at the part",
    ),
    read("MB", "a retract along the tool axis before, as M140"),
    passed("COORD", "COORD ROT: the plane turns, and not the table, where both are possible"),
    refused("PROJECTED", "a plane by projected angles", SPATIAL),
    refused("POINTS", "a plane by three points", SPATIAL),
    refused(
        "AXIAL",
        "a plane by the angles of the axes, whose x depends on the model of the machine",
        SPATIAL,
    ),
    read(
        "SEQ+",
        "the angle of the master axis is above 0: the rotary axis next to the tool, or else next to the base",
    ),
    read("SEQ-", "it is below 0"),
    refused(
        "SYM+",
        "one of two positions of the axes, by the master axis, where the plane turns them",
        "remove it: where two positions differ, this is said",
    ),
    refused(
        "SYM-",
        "one of two positions of the axes, by the master axis, where the plane turns them",
        "remove it: where two positions differ, this is said",
    ),
    read(
        "TABLE",
        "TABLE ROT: the table turns, and not the plane, where both are possible; a plane that turns about z alone is refused",
    ),
];

/// The cycles.
pub(super) const CYCLES: [Entry; 71] = [
    read("7", "the datum shift"),
    read("8", "mirrored axes, without a rotation"),
    read("10", "a rotation about the datum"),
    read(
        "19",
        "a tilted plane, as PLANE SPATIAL STAY, without F and ABST, with all of A, B and C after a plane",
    ),
    read("200", "drilling"),
    read("201", "reaming"),
    read("202", "boring"),
    read("203", "universal drilling"),
    read("205", "universal pecking"),
    read("206", "tapping with a floating holder"),
    read("207", "rigid tapping"),
    read("208", "bore milling on a helix"),
    read("209", "tapping with chip breaking"),
    read("240", "centring, by its depth"),
    read("247", "the preset; of several, a job states the work offset of each (`presets`)"),
    passed("9", "a dwell"),
    passed("13", "an orientation of the spindle"),
    passed("32", "the tolerance of corners"),
    refused("1", "an old form of pecking", "write CYCL DEF 200"),
    refused("2", "an old form of tapping", "write CYCL DEF 206"),
    refused("3", "slot milling", OWN),
    refused("4", "pocket milling", OWN),
    refused("5", "a circular pocket", OWN),
    refused("6", "an old form of a contour pocket", OWN),
    refused(
        "11",
        "scaling, in the plane or in space by a parameter of the machine",
        "post the program with final coordinates",
    ),
    refused(
        "12",
        "a call of another program, which is another file",
        "insert its blocks as a subprogram (LBL)",
    ),
    refused("14", "the contour of a cycle", OWN),
    refused("17", "an old form of rigid tapping", "write CYCL DEF 207"),
    refused("18", "thread cutting", OWN),
    refused("20", "data of a contour", OWN),
    refused("21", "pilot drilling of a contour", OWN),
    refused("22", "roughing of a contour", OWN),
    refused("23", "floor finishing of a contour", OWN),
    refused("24", "side finishing of a contour", OWN),
    refused("25", "a contour train", OWN),
    refused("26", "scaling of axes", "post the program with final coordinates"),
    refused("27", "a cylinder surface", OWN),
    refused("28", "a cylinder surface", OWN),
    refused("29", "a cylinder surface", OWN),
    refused("30", "the points of a file", OWN),
    refused("39", "a cylinder surface", OWN),
    refused(
        "204",
        "back boring, in which a standing tooth passes the bore on one side, as no solid of revolution does",
        WITHOUT,
    ),
    refused("210", "a slot", OWN),
    refused("211", "a circular slot", OWN),
    refused("212", "a pocket", OWN),
    refused("213", "a stud", OWN),
    refused("214", "a circular pocket", OWN),
    refused("215", "a circular stud", OWN),
    refused("220", "a circular pattern", "write CYCL CALL POS or M99 for each point"),
    refused("221", "a pattern of rows", "write CYCL CALL POS or M99 for each point"),
    refused("230", "multipass milling", OWN),
    refused("231", "a ruled surface", OWN),
    refused("232", "face milling", OWN),
    refused("233", "face milling", OWN),
    refused("241", "single-lip deep-hole drilling, which switches the spindle", MOTIONS),
    refused("251", "a rectangular pocket", OWN),
    refused("252", "a circular pocket", OWN),
    refused("253", "a slot", OWN),
    refused("254", "a circular slot", OWN),
    refused("256", "a rectangular stud", OWN),
    refused("257", "a circular stud", OWN),
    refused("258", "a polygonal stud", OWN),
    refused("262", "thread milling", OWN),
    refused("263", "thread milling and countersinking", OWN),
    refused("264", "thread drilling and milling", OWN),
    refused("265", "helical thread drilling and milling", OWN),
    refused("267", "outside thread milling", OWN),
    refused("270", "data of a contour train", OWN),
    refused("275", "a trochoidal slot", OWN),
    refused("276", "a contour train in space", OWN),
    refused(BUILDERS, "a cycle of the machine's builder", BUILDER),
];

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the tables as `docs/controls.md` prints them.
    fn printed() -> String {
        let tables: [(&str, &str, &[Entry]); 5] = [
            ("word", "", &STATEMENTS),
            ("M word", "", &M_WORDS),
            ("function", "", &FUNCTIONS),
            ("after PLANE", "", &PLANES),
            ("cycle", "CYCL DEF ", &CYCLES),
        ];
        let mut text = String::new();
        for (title, prefix, entries) in tables {
            text += &format!("| {title} | meaning | here |\n|---|---|---|\n");
            for Entry { word, meaning, treatment } in entries {
                let here = match treatment {
                    Treatment::Read => "read".to_owned(),
                    Treatment::PassedOver => "passed over".to_owned(),
                    Treatment::Refused(remedy) => format!("refused: {remedy}"),
                };
                text += &format!("| {prefix}{word} | {meaning} | {here} |\n");
            }
            text.push('\n');
        }
        text
    }

    /// Prints the tables with `KLARTEXT=1 cargo test -p touchoff-verify --lib klartext -- --nocapture`.
    #[test]
    fn the_documentation_has_the_tables() {
        let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/controls.md");
        let page = std::fs::read_to_string(&path).expect("the page");
        if std::env::var_os("KLARTEXT").is_some() {
            println!("{}", printed());
        }
        assert!(page.contains(printed().trim_end()), "docs/controls.md has other tables");
    }

    #[test]
    fn no_word_has_two_entries() {
        for table in [&STATEMENTS[..], &M_WORDS, &FUNCTIONS, &PLANES, &CYCLES] {
            for (index, entry) in table.iter().enumerate() {
                assert!(
                    table[..index].iter().all(|other| other.word != entry.word),
                    "{}",
                    entry.word
                );
            }
        }
    }
}
