//! `touchoff path`: a program over all that a tool reaches.

use super::map::belonging;
use crate::arguments::ParamArguments;
use crate::arguments::postures::Path as Wanted;
use crate::failure::Failure;
use crate::files::{Found, ending};
use crate::output::{Output, refuse_inputs, unwritable, write_file};
use crate::part;
use serde::Serialize;
use std::io::Write;
use std::path::Path;
use touchoff::certify::TriangleBvh;
use touchoff::postures::path::{Pattern, plan_path as lead};
use touchoff::postures::{Directions, PostureMap, Rules};
use touchoff::program::{AptHeader, Cutter, apt_unit};
use touchoff::{Motion, Pose, Program};

#[derive(Serialize)]
struct Summary {
    stops: usize,
    places: usize,
    left_out: usize,
    lifts: usize,
    /// The root mean square turn of the axis from point to point, in degrees, before and after smoothing.
    turns: [f64; 2],
    /// The length of the tip's path in feed and in rapid traverse, in the part's unit.
    way: [f64; 2],
    /// Number of cutter locations with the spindle below the tip, and that of the first, counted from 1.
    upside_down: usize,
    first_upside_down: Option<usize>,
}

/// Plans a path of a tool over a part, and writes the program.
pub(crate) fn path(wanted: &Wanted, json: bool) -> Result<(), Failure> {
    let apt = match ending(&wanted.to).as_deref() {
        Some("apt") => true,
        Some("csv") => false,
        _ => return Err(Failure::ProgramForm { file: wanted.to.display().to_string() }),
    };
    refuse_inputs([&*wanted.to], [&*wanted.map, &wanted.part, Path::new(&wanted.tool)])?;
    let map = PostureMap::read(&wanted.map)?;
    let unit = map.identity().part.unit;
    if apt {
        apt_unit(unit)?;
    }
    let found = Found::find(&wanted.tool, &ParamArguments::default())?;
    let (tool, identity) = (found.tool(), map.identity());
    let index = identity.tool(tool.info()).ok_or_else(|| Failure::OtherTool {
        map: wanted.map.display().to_string(),
        tool: tool.info().name.to_string(),
    })?;
    let mesh = belonging(&map, &wanted.map, &wanted.part)?;
    let mut access = vec![Vec::new(); mesh.triangles().len()];
    for entry in map.rows()? {
        let (triangle, row) = entry?;
        if let Some(reach) = row.access.into_iter().find(|access| access.tool == index) {
            access[triangle as usize] = reach.directions;
        }
    }
    let tolerance = wanted.tolerance.unwrap_or(identity.rules.tolerance);
    let rules = Rules { tolerance, ..identity.rules.clone() };
    let pattern = Pattern {
        normal: wanted.planes.coords.into(),
        stepover: wanted.stepover,
        step: wanted.step.unwrap_or(0.5 * wanted.stepover),
    };
    let bvh = TriangleBvh::new(&mesh);
    part::has_inside(&bvh, &wanted.part, wanted.surface_only)?;
    let directions = Directions::from(identity.directions.clone());
    let led = lead((&mesh, &bvh), (tool, &rules), (&directions, &access), &pattern)?;
    let below = |(pose, _): &(Pose, bool)| pose.axis().z < 0.0;
    let summary = Summary {
        stops: led.locations.len(),
        places: led.contact_points,
        left_out: led.left_out,
        lifts: led.retracts,
        turns: led.turns.map(f64::to_degrees),
        way: ways(&led.locations),
        upside_down: led.locations.iter().filter(|stop| below(stop)).count(),
        first_upside_down: led.locations.iter().position(below).map(|stop| stop + 1),
    };
    let name = wanted.to.display().to_string();
    let program = Program::new(&name, Some(unit), led.locations)?;
    let mut text = Vec::new();
    if apt {
        let part = wanted.part.file_stem().unwrap_or_default().to_string_lossy();
        let heading = AptHeader { part: &part, cutter: Cutter::of(tool.info(), unit) };
        program.write_apt(&mut text, &heading)?;
    } else {
        program.write_csv(&mut text).map_err(|source| unwritable(&wanted.to, source))?;
    }
    write_file(&wanted.to, text)?;
    let mut out = Output::lines();
    if json {
        serde_json::to_writer(&mut out, &summary)?;
        writeln!(out)?;
    } else {
        let Summary { stops, places, left_out, lifts, turns: [before, after], way, .. } = summary;
        writeln!(out, "{}: {stops} stops, {places} of them on the surface", wanted.to.display())?;
        writeln!(out, "{left_out} places left out; leaves the surface {lifts} times")?;
        writeln!(out, "{:.1} {unit} in feed, {:.1} {unit} in rapid traverse", way[0], way[1])?;
        writeln!(
            out,
            "turns by {after:.2}° from place to place (root mean square; {before:.2}° unsmoothed)"
        )?;
        if let Some(first) = summary.first_upside_down {
            writeln!(
                out,
                "at {} stops the axis points below the table, z = 0 being level (the first is stop {first}): not \
                 every machine goes there",
                summary.upside_down,
            )?;
        }
    }
    out.flush()?;
    Ok(())
}

/// Returns the length of the tip's path in feed and in rapid traverse.
fn ways(stops: &[(Pose, bool)]) -> [f64; 2] {
    let mut ways = [0.0; 2];
    for pair in stops.windows(2) {
        let [(from, _), (to, rapid)] = [pair[0], pair[1]];
        if let Ok(motion) = Motion::new(&from, &to) {
            ways[usize::from(rapid)] += motion.displacement().norm();
        }
    }
    ways
}
