//! The G and M words of ISO programs, and what becomes of each. `docs/controls.md` has the table.
//!
//! A word can have more conditions, by its control and its block: `control/refuse.rs`, `control/linuxcnc.rs`.

use super::GcodeFault;
use super::block::{Code, Group};
use super::error::not_read;
use std::collections::HashMap;
use std::sync::LazyLock;

/// Treatment of a word.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Treatment {
    /// It is executed, or passed over if its group says so.
    Read(Group),
    /// It is refused, with a remedy.
    Refused(&'static str),
}

/// Words with one meaning.
#[derive(Clone, Copy, Debug)]
struct Entry {
    letter: char,
    /// The numbers of the words in tenths.
    tenths: &'static [u32],
    meaning: &'static str,
    treatment: Treatment,
}

const fn g(tenths: &'static [u32], group: Group, meaning: &'static str) -> Entry {
    Entry { letter: 'G', tenths, meaning, treatment: Treatment::Read(group) }
}

const fn m(tenths: &'static [u32], group: Group, meaning: &'static str) -> Entry {
    Entry { letter: 'M', tenths, meaning, treatment: Treatment::Read(group) }
}

const fn no_g(tenths: &'static [u32], meaning: &'static str, remedy: &'static str) -> Entry {
    Entry { letter: 'G', tenths, meaning, treatment: Treatment::Refused(remedy) }
}

const fn no_m(tenths: &'static [u32], meaning: &'static str, remedy: &'static str) -> Entry {
    Entry { letter: 'M', tenths, meaning, treatment: Treatment::Refused(remedy) }
}

const MOTIONS: &str = "post the program with its motions";
const LINES: &str = "post the program with lines and arcs";
const WITHOUT: &str = "check the program without it";
const CENTRE: &str = "post the program with the path of the tool";
const FINAL: &str = "post the program with final coordinates";
pub(super) const IGNORE: &str =
    "name it in `[ignore]` of the job if it moves nothing on this machine";

/// The words by letter and number.
#[rustfmt::skip]
const WORDS: [Entry; 106] = [
    g(&[0], Group::Motion, "rapid traverse"),
    g(&[10], Group::Motion, "a line at feed rate"),
    g(&[20, 30], Group::Motion, "an arc or a helix, clockwise and counter-clockwise"),
    g(&[40], Group::Dwell, "a dwell"),
    g(&[50, 51, 80], Group::PathControl, "a path mode of Fanuc, with P or Q (and R of G5.1) and without axes, or with zeros of those that G5.1 smooths"),
    no_g(&[52, 53, 61, 62], "a spline", LINES),
    no_g(&[70], "diameter mode of a lathe", "post the program for a mill"),
    no_g(&[71, 1070], "a contour on a cylinder", MOTIONS),
    g(&[90], Group::PassedOver, "an exact stop"),
    g(&[100], Group::OneShot, "the origin of a work offset: L2 and L20"),
    no_g(&[106], "a retract that the operator can start", WITHOUT),
    g(&[110], Group::PassedOver, "the end of data by G10"),
    no_g(&[120, 130], "a circular pocket of Haas, whose path is the control's own", MOTIONS),
    no_g(&[121, 131], "polar coordinate interpolation, of a rotary and a linear axis", MOTIONS),
    g(&[150, 160], Group::Polar, "the end of polar coordinates, and polar coordinates"),
    g(&[170, 180, 190], Group::Plane, "the plane XY, ZX or YZ"),
    no_g(&[171, 181, 191], "a plane of U, V and W", "post the program with X Y Z A B C"),
    g(&[200, 210], Group::Units, "inches, and millimetres"),
    no_g(&[220], "limits that the tool must not leave", WITHOUT),
    g(&[230], Group::PassedOver, "the end of G22"),
    no_g(&[270, 290], "a reference return", "write G28 or G53"),
    g(&[280, 300], Group::OneShot, "a return to a reference position"),
    no_g(&[281, 301], "storing a reference position", "state the position before the program instead"),
    no_g(&[310, 350, 360, 370, 382, 383, 384, 385, 1360], "probing, whose end only the machine knows", WITHOUT),
    no_g(&[320, 330, 331], "threading", WITHOUT),
    no_g(&[390], "an arc at a corner under cutter compensation", CENTRE),
    g(&[400], Group::CutterCompensation, "the end of cutter compensation"),
    no_g(&[401], "control of the normal direction", "post the program with the angles of the axis"),
    g(&[410, 420], Group::CutterCompensation, "cutter compensation to the left, and to the right"),
    g(&[411, 421], Group::CutterCompensation, "the same of LinuxCNC, with a diameter"),
    no_g(&[412, 413, 414, 415, 416, 422, 423, 424, 425, 426, 1410], "three-dimensional cutter compensation", CENTRE),
    g(&[430], Group::Length, "the tool length offset"),
    no_g(&[431, 432, 440, 1430], "another form of tool length offset", "write G43 H"),
    g(&[434, 435, 2340], Group::Length, "tool centre point control, with rotary axes (G43.4, G234) or tool vectors"),
    no_g(&[450, 460, 480], "a way that an offset makes longer or shorter", FINAL),
    no_g(&[470], "engraving of text, whose path is the control's own", MOTIONS),
    g(&[490], Group::Length, "the end of a length offset and of tool centre point control"),
    g(&[500], Group::PassedOver, "the end of scaling"),
    g(&[501, 511], Group::Mirror, "the end of a mirror image, and a mirror image"),
    no_g(&[510], "scaling, whose axes and unit of P are set by parameters (5400 and 5401 of Fanuc)", FINAL),
    no_g(&[1000, 1010], "a mirror image of Haas", "write G50.1 and G51.1, or post the program with final coordinates"),
    g(&[520], Group::OneShot, "a shift"),
    g(&[530], Group::Machine, "machine coordinates"),
    g(&[531], Group::OneShot, "the alignment of the tool with a tilted plane"),
    no_g(&[536], "an alignment that turns the axes about the tip", "write G53.1"),
    g(&[540, 550, 560, 570, 580, 590], Group::WorkOffset, "a work offset"),
    g(&[541], Group::WorkOffset, "a further work offset, by P"),
    no_g(&[542, 543, 2540, 2550], "a dynamic work offset", "write G68.2, or G43.4"),
    no_g(&[544], "a compensation of the part's place, which only the machine knows", WITHOUT),
    g(&[591, 592, 593], Group::WorkOffset, "a work offset of LinuxCNC"),
    no_g(&[600], "a position that is approached from one side, beyond which the tool goes by a parameter", MOTIONS),
    g(&[610, 611], Group::PathControl, "the path through the corners"),
    no_g(&[620], "a feed that the control chooses in corners", "write G61 or G64"),
    g(&[640], Group::PathControl, "rounded corners"),
    no_g(&[650, 660, 661], "a macro call of Fanuc and Haas", "state their `dialect`, or post the program with its motions"),
    g(&[670], Group::PassedOver, "the end of G66"),
    g(&[680, 690], Group::Rotation, "a rotation in the plane, and its end"),
    g(&[682], Group::Rotation, "a tilted plane by Euler angles"),
    no_g(&[683, 684, 2680, 2690], "another form of tilted plane", "write G68.2 with the angles I J K"),
    g(&[700, 710, 7000, 7100], Group::Units, "units of Sinumerik and Heidenhain"),
    no_g(&[711, 721, 722, 720], "a cycle of a lathe, or a copied figure", MOTIONS),
    g(&[730, 830], Group::Motion, "drilling with pecks"),
    g(&[740, 840], Group::Motion, "tapping, left and right"),
    no_g(&[760], "fine boring or threading, by dialect", MOTIONS),
    no_g(&[770], "back boring", MOTIONS),
    g(&[800], Group::CycleOff, "the end of a canned cycle"),
    g(&[810, 820], Group::Motion, "drilling"),
    no_g(&[811], "an axis that goes to and fro", WITHOUT),
    g(&[850, 860, 890], Group::Motion, "boring"),
    no_g(&[870, 880], "a boring cycle with a lateral or manual motion", MOTIONS),
    g(&[900, 910], Group::Distance, "absolute positions, and increments"),
    g(&[901, 911], Group::ArcDistance, "absolute centres, and increments"),
    g(&[920, 921, 922], Group::OneShot, "a position that gets new coordinates, and the end of it"),
    g(&[923], Group::OneShot, "the shift by G92 again: refused"),
    g(&[930, 940, 950], Group::FeedMode, "a feed by time, per minute, per turn"),
    g(&[960, 970], Group::PassedOver, "the speed of the spindle"),
    g(&[980, 990], Group::Retract, "the level to which a canned cycle returns"),
    g(&[1030], Group::PassedOver, "the blocks that Haas reads ahead"),
    g(&[1100, 1110, 1120, 1130, 1140, 1150, 1160, 1170, 1180, 1190, 1200, 1210, 1220, 1230, 1240, 1250, 1260, 1270, 1280, 1290], Group::WorkOffset, "a work offset of Haas, as G154 P1 to P20"),
    no_g(&[1500], "a pocket of Haas, whose path is the control's own", MOTIONS),
    no_g(&[1530], "machine coordinates of Sinumerik, and a hole of Haas along the tool axis", "write G53, or post the program with its motions"),
    g(&[1540], Group::WorkOffset, "a work offset of Haas, by P"),
    no_g(&[1550, 1560, 1610, 1620, 1630, 1640, 1650, 1660, 1690, 1740, 1840], "a hole of Haas along the tool axis, or broaching", MOTIONS),
    g(&[1870], Group::PathControl, "the smoothness of Haas"),
    no_g(&[1880], "a program of a list of pallets", "give one program per setup"),
    no_g(&[2530], "an alignment of Haas with a tilted plane", "write G53.1"),
    no_g(&[2660], "a linear rapid traverse of some axes", MOTIONS),
    no_g(&[4500, 4510], "the path around outside corners", "remove it, and state `outside_corner` of the control"),
    m(&[0, 10, 20, 300], Group::Stop, "a stop, an optional stop, the end of the program"),
    m(&[30, 40, 50, 190], Group::PassedOver, "the spindle"),
    m(&[60], Group::ToolChange, "a tool change"),
    m(&[70, 80, 90, 830, 840, 880, 890], Group::PassedOver, "coolant, air"),
    m(&[100, 110, 120, 310, 330, 410, 420, 430, 440], Group::PassedOver, "clamps of rotary axes, the chip conveyor, gears"),
    no_m(&[130, 140], "the spindle with coolant, or a brake of a rotary axis on Haas", "write M3 or M4, and M8"),
    no_m(&[160], "a tool change of some controls", "write M6"),
    no_m(&[170], "a return of Sinumerik", "write M99"),
    no_m(&[210, 220, 230, 240, 250, 260, 270, 280, 340, 350, 360, 590, 690, 750, 950], "a function of the machine", IGNORE),
    no_m(&[460, 660, 780, 960], "a jump, a wait or an alarm by an input, which only the machine knows", WITHOUT),
    m(&[290, 480, 490, 510, 520, 530, 620, 630, 640, 650, 670, 680], Group::PassedOver, "rigid tapping, overrides, outputs of LinuxCNC"),
    no_m(&[500], "a pallet change on Haas, and a switch of the override on LinuxCNC", "check the program without it"),
    no_m(&[600], "a pallet change, which moves the part", "give one program per setup"),
    no_m(&[610], "another tool number without a change", "write M6"),
    no_m(&[700, 710, 720, 730], "modes of LinuxCNC that are kept and come back", "write the modes"),
    m(&[970, 980, 990, 1980], Group::Subprogram, "a subprogram: M97, M98 and M198 (of another file) call it, M99 ends it"),
    no_m(&[1280, 1290], "tool centre point control of Heidenhain", "write G43.4 H, and G49 to end it"),
    m(&[4280, 4290], Group::Kinematics, "tool centre point control of LinuxCNC, on and off"),
];

/// The entries by word.
static BY_CODE: LazyLock<HashMap<Code, &'static Entry>> = LazyLock::new(|| {
    let codes = |entry: &'static Entry| {
        let letter = entry.letter;
        entry.tenths.iter().map(move |tenths| (Code { letter, tenths: *tenths }, entry))
    };
    WORDS.iter().flat_map(codes).collect()
});

/// Returns the group of a word.
///
/// # Errors
/// If the word is not read.
pub(super) fn group(code: Code) -> Result<Group, GcodeFault> {
    match BY_CODE.get(&code) {
        Some(Entry { treatment: Treatment::Read(group), .. }) => Ok(*group),
        Some(Entry { treatment: Treatment::Refused(remedy), meaning, .. }) => {
            Err(not_read(code, meaning, remedy))
        }
        None => Err(GcodeFault::UnknownCode { word: code.to_string() }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the table as `docs/controls.md` prints it.
    fn printed() -> String {
        let mut text = "| words | meaning | here |\n|---|---|---|\n".to_owned();
        for entry in &WORDS {
            let words = entry.tenths.iter().map(|tenths| {
                let code = Code { letter: entry.letter, tenths: *tenths };
                code.to_string()
            });
            let here = match entry.treatment {
                Treatment::Read(Group::PassedOver | Group::PathControl) => "passed over".to_owned(),
                Treatment::Read(_) => "read".to_owned(),
                Treatment::Refused(remedy) => format!("refused: {remedy}"),
            };
            let words = words.collect::<Vec<_>>().join(" ");
            text += &format!("| {words} | {} | {here} |\n", entry.meaning);
        }
        text
    }

    /// Prints the table with `WORDS=1 cargo test -p touchoff-verify --lib words -- --nocapture`.
    #[test]
    fn the_documentation_has_the_table() {
        let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/controls.md");
        let page = std::fs::read_to_string(&path).expect("the page");
        if std::env::var_os("WORDS").is_some() {
            println!("{}", printed());
        }
        assert!(page.contains(printed().trim_end()), "docs/controls.md has another table");
    }

    #[test]
    fn no_word_has_two_entries() {
        let count: usize = WORDS.iter().map(|entry| entry.tenths.len()).sum();
        assert_eq!(BY_CODE.len(), count);
    }
}
