//! Words at which LinuxCNC stops with an error.
//!
//! Each was run with its interpreter (`rs274`). M428 and M429 of its configurations for five axes are read.

use crate::gcode::GcodeFault;
use crate::gcode::block::{Block, Code, Group};
use crate::gcode::error::{missing, not_read, same_group};

/// Refuses the words of a block that are known elsewhere.
pub(super) fn check_words(block: &Block) -> Result<(), GcodeFault> {
    if let Some(code) = block.codes().find(is_unknown) {
        let (meaning, remedy) = ("no word of LinuxCNC", "remove it, or state another `dialect`");
        return Err(not_read(code, meaning, remedy));
    }
    for code in block.codes() {
        let (is_missing, needed) = match (code.letter, code.tenths) {
            ('M', 620..=650) => (!block.has('P'), "P with the number of an output"),
            ('M', 670 | 680) => (!block.has('E'), "E with the number of an output"),
            ('G', 960) => (!block.has('S'), "S with a speed"),
            ('G', 40) => (!block.has('P'), "P with a time"),
            ('G', 20 | 30) => (!block.has_any("XYZABCIJKR"), "its end, its centre or its radius"),
            ('G', 820 | 860 | 890) => (!block.has('P'), "P with the time of its dwell"),
            _ => continue,
        };
        if is_missing {
            return Err(missing(code, needed));
        }
    }
    // -1 stands for a word that is not there.
    if let Some(value) = block.value('P').filter(|value| *value < 0.0) {
        return Err(GcodeFault::NotAllowed { word: 'P', value, expected: "a number from 0" });
    }
    if block.has('D') && block.tenths_of(Group::CutterCompensation).is_none_or(|code| code == 400) {
        return Err(GcodeFault::Unused { word: 'D' });
    }
    let motion = block.code_of(Group::Motion);
    if let Some((code, motion)) =
        block.code_of(Group::OneShot).filter(|code| matches!(code.tenths, 280 | 300)).zip(motion)
    {
        return Err(same_group(code, motion));
    }
    for (index, code) in block.codes().enumerate() {
        let Some(group) = m_group(code) else { continue };
        let mut others = block.codes().skip(index + 1);
        if let Some(other) = others.find(|other| m_group(*other) == Some(group)) {
            return Err(same_group(code, other));
        }
    }
    Ok(())
}

/// Refuses the words of a canned cycle that it does not take.
pub(super) fn check_cycle(block: &Block, number: u32) -> Result<(), GcodeFault> {
    let unused = match number {
        73 | 83 => "KP",
        81 | 85 => "KPQ",
        // `check_items` of LinuxCNC lets G73, G76 and G81 to G89 repeat.
        74 => "KLQ",
        _ => "KQ",
    };
    if let Some(word) = unused.chars().find(|letter| block.has(*letter)) {
        return Err(GcodeFault::Unused { word });
    }
    match block.value('L') {
        Some(value) if value < 1.0 => {
            let expected = "a number of repeats from 1";
            Err(GcodeFault::NotAllowed { word: 'L', value, expected })
        }
        _ => Ok(()),
    }
}

/// Returns whether a word is read for other controls only.
fn is_unknown(code: &Code) -> bool {
    match code.letter {
        'G' => matches!(
            code.tenths,
            50 | 51 | 80 | 90 | 150 | 160 | 230 | 434 | 435 | 500 | 501 | 511 | 531 | 541 | 1100..=1290 | 1540 | 670 | 680
                ..=690 | 1030 | 1870 | 2340
        ),
        _ => matches!(
            code.tenths,
            100 | 110 | 120 | 290 | 970 | 310 | 330 | 410..=440 | 830 | 840 | 880 | 890 | 1980
        ),
    }
}

/// Returns the modal group of an M word that neither moves, nor stops, nor turns the spindle (RS274/NGC, table 4).
fn m_group(code: Code) -> Option<u32> {
    match (code.letter, code.tenths) {
        ('M', 620..=680) => Some(5),
        ('M', 70 | 80 | 90) => Some(8),
        ('M', 480..=530) => Some(9),
        _ => None,
    }
}
