//! Programs: read and compared with tool and unit; where one is beside the part, and what of it was passed over.

use crate::failure::Failure;
use crate::files::{figure, length};
use nalgebra::Point3;
use std::collections::BTreeMap;
use std::path::Path;
use touchoff::tool::Card;
use touchoff::verify::{Approach, Report};
use touchoff::{Program, Unit};

/// Reads a program for a tool and a part in that unit.
pub(crate) fn read(path: &Path, card: &Card, unit: Unit) -> Result<Program, Failure> {
    let program = Program::read(path)?;
    program.check_unit(unit)?;
    program.check_poses(card)?;
    if let Some(line) = program.check_cutter(card, unit)? {
        say!(
            "{}:{line}: CUTTER is not compared: it cannot describe `{}`",
            path.display(),
            card.name
        );
    }
    Ok(program)
}

/// Prints the boxes of part and program, how near the tool comes, and what was passed over.
pub(crate) fn print(report: &Report, program: &Program, unit: Unit) {
    let Approach { part, program: tips, distance, line, diameter, keeps } = report.approach;
    say!("part: {} in {unit}", extent(part, unit));
    say!("program: {} positions, tips in {} in {unit}", program.stops.len(), extent(tips, unit));
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

/// Says which words were passed over, and how often.
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

/// A box from corner to corner.
fn extent([low, high]: [Point3<f64>; 2], unit: Unit) -> String {
    let corner = |p: Point3<f64>| {
        let [x, y, z] = [p.x, p.y, p.z].map(|part| figure(part, unit));
        format!("({x}, {y}, {z})")
    };
    format!("{} to {}", corner(low), corner(high))
}
