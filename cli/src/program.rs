//! Programs: reading, checks against tool and unit, position relative to the part, and ignored words.

use crate::failure::Failure;
use crate::files::{figure, length};
use nalgebra::Point3;
use std::collections::BTreeMap;
use std::path::Path;
use touchoff::tool::ToolInfo;
use touchoff::verify::{Approach, VerifyReport};
use touchoff::{Program, Unit};

/// Reads a program for a tool and a part in that unit.
///
/// # Errors
/// If it cannot be read, or its unit, poses or cutter do not fit.
pub(crate) fn read(path: &Path, info: &ToolInfo, unit: Unit) -> Result<Program, Failure> {
    let program = Program::read(path)?;
    program.check_unit(unit)?;
    program.check_poses(info)?;
    if let Some(line) = program.check_cutter(info, unit)? {
        say!(
            "{}:{line}: CUTTER is not compared: it cannot describe `{}`",
            path.display(),
            info.name
        );
    }
    Ok(program)
}

/// Prints the boxes of part and program, the nearest approach of the tool, and the ignored words.
pub(crate) fn print(report: &VerifyReport, program: &Program, unit: Unit) {
    let Approach { part, program: tips, distance, line, diameter, proved_clearance: keeps } =
        report.approach;
    say!("part: {} in {unit}", extent(part, unit));
    say!(
        "program: {} positions, tips in {} in {unit}",
        program.locations.len(),
        extent(tips, unit)
    );
    match (distance, keeps) {
        (0.0, _) => say!("nearest approach: it touches, line {line}"),
        (_, None) => say!("nearest approach: {} or less, line {line}", length(distance, unit)),
        (_, Some(keeps)) => say!(
            "nearest approach: {}, line {line}; at least {} on all motions, more than the tool's diameter of {}",
            length(distance, unit),
            length(keeps, unit),
            length(diameter, unit),
        ),
    }
    passed_over(program);
}

/// Prints the words that were ignored, and how often each occurs.
pub(crate) fn passed_over(program: &Program) {
    let mut words: BTreeMap<&str, usize> = BTreeMap::new();
    for (_, word) in &program.ignored {
        *words.entry(word).or_default() += 1;
    }
    let list: Vec<String> = words
        .into_iter()
        .map(|(word, count)| if count == 1 { word.to_owned() } else { format!("{word} ({count})") })
        .collect();
    if !list.is_empty() {
        say!("passed over, as they move nothing: {}", list.join(", "));
    }
}

/// Formats a box by its two corners.
fn extent([low, high]: [Point3<f64>; 2], unit: Unit) -> String {
    let corner = |p: Point3<f64>| {
        let [x, y, z] = [p.x, p.y, p.z].map(|part| figure(part, unit));
        format!("({x}, {y}, {z})")
    };
    format!("{} to {}", corner(low), corner(high))
}
