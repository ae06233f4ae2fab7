//! Programs: reading, checks against tool and unit, position relative to the part, and ignored words.

use crate::failure::Failure;
use nalgebra::Point3;
use std::collections::BTreeMap;
use std::fmt::Display;
use std::path::Path;
use touchoff::Unit;
use touchoff::tool::ToolInfo;
use touchoff_verify::{Approach, ClData, VerifyReport};

/// Reads a program for a tool and a part in that unit.
///
/// # Errors
/// If it cannot be read, or its unit, poses or cutter do not fit.
pub(crate) fn read(path: &Path, info: &ToolInfo, unit: Unit) -> Result<ClData, Failure> {
    let program = ClData::read(path)?;
    program.check_unit(unit)?;
    program.check_poses(info)?;
    if let Some(line) = program.check_cutter(info, unit)? {
        warn_of_cutter(&path.display(), line, info);
    }
    Ok(program)
}

/// Warns of a cutter in a program that is not compared with the tool.
pub(crate) fn warn_of_cutter(program: &dyn Display, line: usize, info: &ToolInfo) {
    message!(
        "{program}:{line}: no more than the diameter of the stated cutter is compared with `{}`: check that it is the tool of the program",
        info.name
    );
}

/// Prints the boxes of part and program, the travelled length, and the nearest approach of the tool.
pub(crate) fn print_approach(report: &VerifyReport, unit: Unit) {
    let Approach {
        part, program: tips, travel, distance, line, diameter, proved_clearance, ..
    } = report.approach;
    // Without a motion nothing was approached.
    if report.moves == 0 {
        return;
    }
    message!("part: {} in {unit}", extent(part, unit));
    message!(
        "program: {} positions, tips in {} in {unit}, {} in feed and {} in rapid traverse",
        report.moves,
        extent(tips, unit),
        unit.format(travel[0]),
        unit.format(travel[1]),
    );
    match (distance, proved_clearance) {
        (0.0, _) => message!("nearest approach: contact, line {line}"),
        (f64::INFINITY, None) => {
            message!("nearest approach: not known, as the tool has no profile");
        }
        (_, None) => message!(
            "nearest approach: {}, line {line}; along the motions it may be less",
            unit.format(distance)
        ),
        (_, Some(keeps)) => {
            let measured = match distance {
                f64::INFINITY => String::new(),
                _ => format!("{}, line {line}; ", unit.format(distance)),
            };
            message!(
                "nearest approach: {measured}at least {} on all motions, more than the tool's diameter of {}",
                unit.format(keeps),
                unit.format(diameter),
            );
        }
    }
}

/// Returns the words that were ignored, and how often each occurs; `None` if there are none.
pub(crate) fn ignored_words(programs: &[ClData]) -> Option<String> {
    let mut words: BTreeMap<&str, usize> = BTreeMap::new();
    for (_, word) in programs.iter().flat_map(|program| &program.ignored) {
        *words.entry(word).or_default() += 1;
    }
    let list: Vec<String> = words
        .into_iter()
        .map(|(word, count)| if count == 1 { word.to_owned() } else { format!("{word} ({count})") })
        .collect();
    (!list.is_empty()).then(|| list.join(", "))
}

/// Prints the words that were ignored.
pub(crate) fn print_ignored(programs: &[ClData]) {
    if let Some(words) = ignored_words(programs) {
        message!("ignored, as they move nothing: {words}");
    }
}

/// Formats a box by its two corners.
pub(crate) fn extent([low, high]: [Point3<f64>; 2], unit: Unit) -> String {
    format!("{} to {}", unit.format_point(&low), unit.format_point(&high))
}
