//! `touchoff path`: a program over all that a tool reaches.

use super::map::read_part;
use crate::arguments::postures::Path as Arguments;
use crate::failure::Failure;
use crate::loaded_tool::LoadedTool;
use crate::output::{Output, extension, refuse_inputs, unwritable, write_file};
use crate::part;
use crate::progress::Progress;
use serde::Serialize;
use std::io::Write;
use std::path::Path;
use touchoff::certify::TriangleBvh;
use touchoff::postures::path::{PathRequest, Pattern};
use touchoff::postures::{Directions, PostureMap, Rules};
use touchoff::program::{AptHeader, Cutter, apt_unit};
use touchoff::{Motion, Pose, Program};

#[derive(Serialize)]
struct Summary {
    unit: &'static str,
    locations: usize,
    contact_points: usize,
    points_left_out: usize,
    retracts: usize,
    /// The root mean square turn of the axis from point to point, in degrees, before and after smoothing.
    turn_before_smoothing_degrees: f64,
    turn_degrees: f64,
    /// The length of the tip's path in feed and in rapid traverse.
    feed_length: f64,
    rapid_length: f64,
    /// Number of cutter locations with the spindle below the tip, and the index of the first, from 0.
    upside_down_locations: usize,
    first_upside_down_location: Option<usize>,
}

/// Plans a path of a tool over a part, and writes the program.
pub(crate) fn path(arguments: &Arguments, json: bool) -> Result<(), Failure> {
    let apt = match extension(&arguments.output).as_deref() {
        Some("apt") => true,
        Some("csv") => false,
        _ => return Err(Failure::ProgramFormat { file: arguments.output.display().to_string() }),
    };
    refuse_inputs(
        [&*arguments.output],
        [&*arguments.map, &arguments.part, Path::new(&arguments.tool)],
    )?;
    let map = PostureMap::read(&arguments.map)?;
    let unit = map.identity().part.unit;
    if apt {
        apt_unit(unit)?;
    }
    let loaded = LoadedTool::load(&arguments.tool, &arguments.params)?;
    let (tool, identity) = (loaded.tool(), map.identity());
    let index = identity.tool(tool.info()).ok_or_else(|| Failure::OtherTool {
        map: arguments.map.display().to_string(),
        tool: tool.info().name.to_string(),
    })?;
    let mesh = read_part(&map, &arguments.map, &arguments.part)?;
    let mut access = vec![Vec::new(); mesh.triangles().len()];
    for entry in map.rows()? {
        let (triangle, row) = entry?;
        if let Some(reach) = row.access.into_iter().find(|access| access.tool == index) {
            access[triangle.index()] = reach.directions;
        }
    }
    let tolerance = arguments.tolerance.unwrap_or(identity.rules.tolerance);
    let rules = Rules { tolerance, ..identity.rules.clone() };
    let pattern = Pattern {
        normal: arguments.plane_normal.coords.into(),
        stepover: arguments.stepover,
        step: arguments.forward_step.unwrap_or(0.5 * arguments.stepover),
    };
    let bvh = TriangleBvh::new(&mesh);
    part::require_inside(&bvh, &arguments.part, arguments.surface_only)?;
    let directions = Directions::from(identity.directions.clone());
    let progress = Progress::spinner("planning", json);
    let request = PathRequest {
        mesh: &mesh,
        bvh: &bvh,
        tool,
        rules: &rules,
        directions: &directions,
        accessibility: &access,
        pattern: &pattern,
    };
    let path = request.plan()?;
    drop(progress);
    let below = |(pose, _): &(Pose, bool)| pose.axis().z < 0.0;
    let [before, after] = path.turns.map(f64::to_degrees);
    let [feed_length, rapid_length] = lengths(&path.locations);
    let summary = Summary {
        unit: unit.symbol(),
        locations: path.locations.len(),
        contact_points: path.contact_points,
        points_left_out: path.left_out,
        retracts: path.retracts,
        turn_before_smoothing_degrees: before,
        turn_degrees: after,
        feed_length,
        rapid_length,
        upside_down_locations: path.locations.iter().filter(|location| below(location)).count(),
        first_upside_down_location: path.locations.iter().position(below),
    };
    let name = arguments.output.display().to_string();
    let program = Program::new(&name, Some(unit), path.locations)?;
    let mut text = Vec::new();
    if apt {
        let part = arguments.part.file_stem().unwrap_or_default().to_string_lossy();
        let heading = AptHeader { part: &part, cutter: Cutter::of(tool.info(), unit) };
        program.write_apt(&mut text, &heading)?;
    } else {
        program.write_csv(&mut text).map_err(|source| unwritable(&arguments.output, source))?;
    }
    write_file(&arguments.output, text)?;
    let mut out = Output::lines();
    if json {
        serde_json::to_writer(&mut out, &summary)?;
        writeln!(out)?;
    } else {
        print_text(&mut out, &arguments.output, &summary)?;
    }
    Ok(out.flush()?)
}

fn print_text(out: &mut impl Write, output: &Path, summary: &Summary) -> std::io::Result<()> {
    let Summary { unit, locations, contact_points, retracts, .. } = summary;
    let [feed, rapid] = [summary.feed_length, summary.rapid_length];
    writeln!(
        out,
        "{}: {locations} cutter locations, {contact_points} of them on the surface",
        output.display()
    )?;
    writeln!(out, "{} points left out; {retracts} retracts", summary.points_left_out)?;
    writeln!(out, "{feed:.1} {unit} in feed, {rapid:.1} {unit} in rapid traverse")?;
    writeln!(
        out,
        "the axis turns by {:.2}° from point to point (root mean square; {:.2}° before smoothing)",
        summary.turn_degrees, summary.turn_before_smoothing_degrees
    )?;
    if let Some(first) = summary.first_upside_down_location {
        writeln!(
            out,
            "at {} cutter locations the spindle is below the tip, if z points up (the first is number {}): check \
             that the machine reaches them",
            summary.upside_down_locations,
            first + 1,
        )?;
    }
    Ok(())
}

/// Returns the length of the tip's path in feed and in rapid traverse.
fn lengths(locations: &[(Pose, bool)]) -> [f64; 2] {
    let mut lengths = [0.0; 2];
    for pair in locations.windows(2) {
        let [(from, _), (to, rapid)] = [pair[0], pair[1]];
        if let Ok(motion) = Motion::new(&from, &to) {
            lengths[usize::from(rapid)] += motion.displacement().norm();
        }
    }
    lengths
}
