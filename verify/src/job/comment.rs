//! Tools of a job against those that the comments of the program describe.

use super::{Job, JobGap};
use crate::Gap;
use crate::gcode::{StatedEnd, StatedTool};
use crate::program::cutting_radii;
use std::collections::{BTreeMap, BTreeSet};
use touchoff::Unit;
use touchoff::tool::{ProfileSegment, ToolInfo};

/// Tolerance of lengths as a fraction of the diameter: comments have few digits.
const ROUNDED: f64 = 1e-3;
/// Tolerance of angles, which comments state in whole degrees.
const DEGREES: f64 = 0.51;

/// The first comment that describes another tool than the job has under a number.
struct Contradiction<'a> {
    stated: &'a StatedTool,
    /// Description of the job's tool.
    mounted: String,
    /// The number of further lines with such comments.
    others: usize,
}

impl Job<'_> {
    /// Returns the first comment of the program that describes another tool than the job has under a number, for each number.
    pub(super) fn contradicted_comments(&self) -> Vec<Gap> {
        let Some(program) = self.program.readings().first() else { return Vec::new() };
        let used: BTreeSet<u32> =
            self.program.tools().into_iter().filter_map(|tool| tool.number).collect();
        let mut found: BTreeMap<u32, Contradiction<'_>> = BTreeMap::new();
        for stated in &program.summary().stated_tools {
            let number = Some(stated.number).filter(|number| used.contains(number));
            let Some(tool) = number.and_then(|number| self.tool_of(Some(number))) else { continue };
            let Some(mounted) = contradiction(stated, tool.tool.info(), self.unit()) else {
                continue;
            };
            let first = Contradiction { stated, mounted, others: 0 };
            let first = found.entry(stated.number).or_insert(first);
            first.others += usize::from(first.stated.line != stated.line);
        }
        let gap = |(number, Contradiction { stated, mounted, others })| {
            let comment = stated.comment.clone();
            JobGap::OtherTool { comment, number, mounted, others }.open(stated.line)
        };
        found.into_iter().map(gap).collect()
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
    let points = || cutting.iter().flat_map(|segment| [segment.from, segment.to]);
    let diameters = || cutting_radii(info).map(|radius| 2.0 * scale * radius);
    let widest = diameters().fold(0.0, f64::max);
    let rounded = || {
        let circles = cutting.iter().filter_map(|segment| segment.circle);
        circles.filter(|circle| circle.convex).map(|circle| scale * circle.radius)
    };
    let has_corner = |corner: f64| rounded().any(|radius| is_near(radius, corner));
    let is_sharp = rounded().all(|radius| radius <= tolerance);
    let is_ball = has_corner(0.5 * widest);
    let cones: Vec<f64> = cutting.iter().filter_map(|segment| cone(segment)).collect();
    let has_cone = |angle: f64| cones.iter().any(|cone| (cone - angle).abs() <= DEGREES);
    // A flat end, with its corner, is as wide as the cutter near the tip.
    let lowest = points().map(|[_, z]| z).fold(f64::INFINITY, f64::min);
    let is_flat = points().any(|[radius, z]| {
        let height = scale * (z - lowest) - stated.corner.unwrap_or(0.0).max(0.0);
        2.0 * scale * radius >= stated.diameter - tolerance && height <= 0.1 * stated.diameter
    });
    let is_end = match (stated.end, stated.corner) {
        (StatedEnd::Ball, _) => has_corner(0.5 * stated.diameter),
        (StatedEnd::Cone, corner) => {
            let is_rounded = corner.is_none_or(|corner| corner <= tolerance || has_corner(corner));
            is_rounded && stated.taper.map_or(!cones.is_empty(), has_cone)
        }
        (StatedEnd::Other, Some(corner)) => corner > tolerance || !is_ball,
        (StatedEnd::Other, None) | (StatedEnd::Unnamed, None) => true,
        (end, Some(corner)) if corner > tolerance => {
            has_corner(corner) && (end == StatedEnd::Unnamed || is_flat)
        }
        (StatedEnd::Flat, _) => is_sharp && is_flat,
        (StatedEnd::Unnamed, _) => is_sharp,
        (StatedEnd::BullNose, _) => !is_sharp && !is_ball,
    };
    // The angle of a point is that between its sides, and a drill can be drawn flat.
    let is_pointed = match (stated.end, stated.taper) {
        (StatedEnd::Other | StatedEnd::Unnamed, Some(angle)) => {
            let needs_cone = stated.end == StatedEnd::Unnamed && angle < 60.0;
            has_cone(angle) || has_cone(0.5 * angle) || cones.is_empty() && !needs_cone
        }
        _ => true,
    };
    // The diameter of a cone is that of its tip or that of its end, by the type.
    let is_wide = match stated.end {
        StatedEnd::Flat | StatedEnd::Ball | StatedEnd::BullNose if stated.taper.is_none() => {
            is_near(widest, stated.diameter)
        }
        // A ball at the end of a cone is tangent to it, and a little wider.
        _ => {
            diameters().any(|diameter| is_near(diameter, stated.diameter))
                || has_corner(0.5 * stated.diameter)
        }
    };
    if is_wide && is_end && is_pointed {
        return None;
    }
    let to_unit = Unit::Millimetre.factor_to(unit);
    let end = match rounded().reduce(f64::max).filter(|_| !is_sharp) {
        Some(radius) => format!("an end of radius {}", unit.format(to_unit * radius)),
        None if !cones.is_empty() => format!("a cone at {:.1}° to the axis", cones[0]),
        None => "a sharp end".to_owned(),
    };
    Some(format!("`{}` of diameter {}, with {end}", info.name, unit.format(to_unit * widest)))
}

/// Returns the angle to the axis of a segment that is a cone, in degrees.
fn cone(segment: &ProfileSegment) -> Option<f64> {
    let [wide, high] = [0, 1].map(|axis| (segment.to[axis] - segment.from[axis]).abs());
    let angle = wide.atan2(high).to_degrees();
    Some(angle).filter(|angle| segment.circle.is_none() && (0.2..89.8).contains(angle))
}
