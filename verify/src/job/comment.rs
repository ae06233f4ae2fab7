//! Tools of a job against those that the comments of the program describe.

use super::{Job, JobGap};
use crate::Gap;
use crate::gcode::{StatedEnd, StatedTool};
use touchoff::Unit;
use touchoff::tool::{ProfileSegment, ToolInfo};

/// Tolerance of lengths as a fraction of the diameter: comments have few digits.
const ROUNDED: f64 = 1e-3;

impl Job<'_> {
    /// Returns the comments of the program that describe another tool than the job has under their numbers.
    pub(super) fn contradicted_comments(&self) -> Vec<Gap> {
        let Some(program) = self.program.readings().first() else { return Vec::new() };
        let used = self.program.tools();
        let stated = program.summary().stated_tools.iter();
        let found = stated.filter_map(|stated| {
            let number = Some(stated.number);
            if !used.iter().any(|tool| tool.number == number) {
                return None;
            }
            let info = self.tool_of(number)?.tool.info();
            let mounted = contradiction(stated, info, self.unit())?;
            let (comment, number) = (stated.comment.clone(), stated.number);
            Some(JobGap::OtherTool { comment, number, mounted }.open(stated.line))
        });
        found.collect()
    }
}

/// Describes a tool in a unit, if it is not the one that a comment states. A tool without a profile is not compared.
fn contradiction(stated: &StatedTool, info: &ToolInfo, unit: Unit) -> Option<String> {
    let cutting: Vec<&ProfileSegment> =
        info.outline.iter().filter(|segment| info.surface(segment.surface).cutting).collect();
    if cutting.is_empty() {
        return None;
    }
    let scale = info.unit.millimetres();
    let tolerance = ROUNDED * stated.diameter;
    let is_near = |one: f64, other: f64| (one - other).abs() <= tolerance;
    // The diameter of a cone is that of its tip or that of its end, by the type.
    let diameters = || {
        let ends = cutting.iter().flat_map(|segment| [segment.from[0], segment.to[0]]);
        ends.map(|radius| 2.0 * scale * radius)
    };
    let rounded = || {
        let circles = cutting.iter().filter_map(|segment| segment.circle);
        circles.filter(|circle| circle.convex).map(|circle| scale * circle.radius)
    };
    let has_corner = |corner: f64| rounded().any(|radius| is_near(radius, corner));
    let is_sharp = rounded().all(|radius| radius <= tolerance);
    let is_end = match (stated.end, stated.corner) {
        (StatedEnd::Other, _) | (StatedEnd::Unnamed, None) => true,
        (StatedEnd::Ball, _) => has_corner(0.5 * stated.diameter),
        (_, Some(corner)) if corner > tolerance => has_corner(corner),
        (StatedEnd::Flat | StatedEnd::Unnamed, _) => is_sharp,
        (StatedEnd::BullNose, _) => !is_sharp,
    };
    if diameters().any(|diameter| is_near(diameter, stated.diameter)) && is_end {
        return None;
    }
    let to_unit = Unit::Millimetre.factor_to(unit);
    let widest = diameters().fold(0.0, f64::max);
    let end = match rounded().reduce(f64::max).filter(|_| !is_sharp) {
        Some(radius) => format!("an end of radius {}", unit.format(to_unit * radius)),
        None => "a sharp end".to_owned(),
    };
    Some(format!("`{}` of diameter {}, with {end}", info.name, unit.format(to_unit * widest)))
}
