//! `touchoff path`: a program over all that a tool reaches.

use super::map::read_part;
use super::picture;
use crate::arguments::postures::{MachineArguments, Path as Arguments};
use crate::failure::Failure;
use crate::loaded_tool::LoadedTool;
use crate::output::{Output, extension, refuse_inputs, unwritable, write_file};
use crate::part;
use crate::progress::Progress;
use serde::Serialize;
use std::io::Write;
use std::mem;
use std::path::Path;
use touchoff::certify::TriangleBvh;
use touchoff::{Motion, Unit};
use touchoff_postures::path::{LeftOutReason, PathRequest, Pattern, ToolAxisLimits, ToolPath};
use touchoff_postures::post::{Location, PathProver, Placed, Post, Words, planning_rules};
use touchoff_postures::{Directions, MapRow, PostureMap, Rules};
use touchoff_verify::ClData;
use touchoff_verify::job::read_machine;
use touchoff_verify::program::{AptHeader, Cutter, Decimals, apt_unit};

#[derive(Serialize)]
struct Summary {
    unit: &'static str,
    locations: usize,
    contact_points: usize,
    /// Number of intermediate cutter locations that a machine needs.
    inserted_locations: usize,
    /// The sum of the next two.
    points_left_out: usize,
    points_not_reached: usize,
    points_without_motion: usize,
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

/// The format of the program.
enum Format<'a> {
    Apt,
    Table,
    /// For a machine.
    Gcode(&'a Path, Words),
}

impl<'a> Format<'a> {
    /// Returns the format that the output's extension names, if the options fit it.
    fn of(arguments: &'a Arguments) -> Result<Format<'a>, Failure> {
        let Arguments { tool_number, feed, spindle, .. } = *arguments;
        let machine = arguments.machine.machine.as_deref();
        let extension = extension(&arguments.output);
        if machine.is_some() && extension.as_deref() != Some("nc") {
            return Err(Failure::Usage(
                "a machine is for G-code: write the program to a file that ends in `.nc`, or leave `--machine` out",
            ));
        }
        match (extension.as_deref(), machine) {
            (Some("apt"), _) => Ok(Format::Apt),
            (Some("csv"), _) if tool_number.is_some() || feed.is_some() || spindle.is_some() => {
                Err(Failure::Usage(
                    "a table has no place for `--tool-number`, `--feed` and `--spindle`: leave them out, or write `.apt`",
                ))
            }
            (Some("csv"), _) => Ok(Format::Table),
            (Some("nc"), None) => Err(Failure::Usage(
                "G-code is for a machine: name one with `--machine`, or write `.apt`",
            )),
            (Some("nc"), Some(machine)) => {
                let (Some(tool_number), Some(feed)) = (tool_number, feed) else {
                    return Err(Failure::Usage(
                        "G-code states the tool and the feed: give `--tool-number` and `--feed`",
                    ));
                };
                Ok(Format::Gcode(machine, Words { tool_number, feed, spindle }))
            }
            _ => Err(Failure::Format {
                formats: "a program is written as `.apt`, `.csv` or `.nc`",
                file: arguments.output.display().to_string(),
            }),
        }
    }
}

impl Format<'_> {
    /// Writes a program, and returns it as it is read again, with its text.
    ///
    /// G-code has no text yet: [`Post::program`] writes it, where each motion of the machine is proved again.
    fn write(
        &self,
        program: ClData,
        header: &AptHeader<'_>,
        output: &Path,
    ) -> Result<(ClData, Vec<u8>), Failure> {
        let mut text = Vec::new();
        match self {
            Format::Gcode(..) => return Ok((program, text)),
            Format::Apt => program.write_apt(&mut text, header)?,
            Format::Table => {
                program.write_csv(&mut text).map_err(|source| unwritable(output, source))?;
            }
        }
        Ok((ClData::parse(&text, &output.display().to_string())?, text))
    }
}

impl Summary {
    /// Summarises a path, with the cutter locations of its program.
    fn new(path: &ToolPath, locations: &[Location], unit: Unit) -> Summary {
        let [before, after] = path.turns.map(f64::to_degrees);
        let [feed_length, rapid_length] = lengths(locations);
        let upside_down = locations.iter().filter(|location| is_upside_down(location));
        Summary {
            unit: unit.symbol(),
            locations: locations.len(),
            contact_points: path.contact_points,
            inserted_locations: 0,
            points_left_out: path.left_out.len(),
            points_not_reached: path.count_left_out(LeftOutReason::NotReached),
            points_without_motion: path.count_left_out(LeftOutReason::NoMotion),
            retracts: path.retracts,
            turn_before_smoothing_degrees: before,
            turn_degrees: after,
            feed_length,
            rapid_length,
            upside_down_locations: upside_down.count(),
            first_upside_down_location: locations.iter().position(is_upside_down),
        }
    }
}

/// Returns per triangle the directions from which a sweep found that a tool of the map reaches it.
fn accessibility(map: &PostureMap, tool: u16) -> Result<Vec<Vec<u64>>, Failure> {
    let identity = map.identity();
    let mut access = vec![Vec::new(); identity.part.triangles as usize];
    map.for_each_triangle(|triangle, pieces| {
        // A point of a divided triangle may take the directions of all pieces: each posture is proved at its own point.
        let row = MapRow::joined(&pieces, identity.keep);
        if let Some(reach) = row.access.into_iter().find(|access| access.tool == tool) {
            access[triangle.index()] = reach.directions;
        }
        Ok::<(), Failure>(())
    })?;
    Ok(access)
}

/// Plans a path of a tool over a part, proves the program as it is written, and writes it.
pub(crate) fn path(arguments: &Arguments, json: bool) -> Result<(), Failure> {
    let format = Format::of(arguments)?;
    refuse_inputs(
        [&*arguments.output].into_iter().chain(arguments.picture.as_deref()),
        [&*arguments.map, &arguments.part, Path::new(&arguments.tool)]
            .into_iter()
            .chain(arguments.params.library.as_deref())
            .chain(arguments.stock.as_deref())
            .chain(arguments.machine.machine.as_deref()),
    )?;
    let map = PostureMap::read(&arguments.map)?;
    let unit = map.identity().part.unit;
    let post = match format {
        Format::Apt => apt_unit(unit).map(|_| None)?,
        Format::Table => None,
        Format::Gcode(machine, words) => {
            let MachineArguments { work_offset, tool_length, .. } = arguments.machine;
            let placed = work_offset
                .zip(tool_length)
                .map(|(work_offset, tool_length)| Placed { work_offset, tool_length });
            Some(Post::new(read_machine(machine)?, placed, words, unit)?)
        }
    };
    let loaded = LoadedTool::load(&arguments.tool, &arguments.params)?;
    let (tool, identity) = (loaded.tool(), map.identity());
    let index = identity.tool(tool.info()).ok_or_else(|| Failure::OtherTool {
        map: arguments.map.display().to_string(),
        tool: tool.info().name.to_string(),
    })?;
    let mesh = read_part(&map, &arguments.map, &arguments.part)?;
    let access = accessibility(&map, index)?;
    let tolerance = arguments.tolerance.unwrap_or(identity.rules.tolerance);
    let rules = Rules { tolerance, ..identity.rules.clone() };
    let pattern = Pattern {
        normal: arguments.plane_normal.coords.into(),
        stepover: arguments.stepover,
        step: arguments.forward_step.unwrap_or(0.5 * arguments.stepover),
    };
    let bvh = TriangleBvh::new(&mesh);
    part::require_inside(&bvh, &arguments.part, arguments.surface_only)?;
    let stock = arguments.stock.as_deref().map(|file| {
        let stock = TriangleBvh::new(&part::mesh(file, unit, "--stock")?);
        match stock.has_inside() {
            true => Ok(stock),
            false => Err(Failure::StockNoInside { file: file.display().to_string() }),
        }
    });
    let stock = stock.transpose()?;
    let directions = Directions::from(identity.directions.clone());
    let progress = Progress::spinner("planning", json);
    let name = arguments.output.display().to_string();
    // Created before the path is planned, so that a tool that cannot be proved is refused at once.
    let prover = PathProver::new(&bvh, stock.as_ref(), tool, &rules, &name)?;
    let request = PathRequest {
        mesh: &mesh,
        bvh: &bvh,
        stock: stock.as_ref(),
        tool,
        rules: &planning_rules(&rules),
        directions: &directions,
        accessibility: &access,
        pattern: &pattern,
        max_tilt: arguments.max_tilt.unwrap_or(180.0).to_radians(),
        axis_limits: post.as_ref().map(|post| post as &dyn ToolAxisLimits),
    };
    let mut path = request.plan()?;
    let planned = path.locations.len();
    let part = arguments.part.file_stem().unwrap_or_default().to_string_lossy();
    let header = AptHeader {
        part: &part,
        tool_number: arguments.tool_number,
        cutter: Cutter::of(tool.info(), unit),
        spindle: arguments.spindle,
        feed: arguments.feed,
        decimals: Some(Decimals::of(unit)),
    };
    let (locations, text) =
        prover.settle::<_, Failure>(mem::take(&mut path.locations), |locations| {
            let program = ClData::new(&name, Some(unit), locations.iter().copied())?;
            format.write(program, &header, &arguments.output)
        })?;
    let (text, locations) = match &post {
        Some(post) => {
            let (text, locations) = post.program(&prover, &locations, &name)?;
            (text.into_bytes(), locations)
        }
        None => (text, locations),
    };
    drop(progress);
    let summary = Summary {
        inserted_locations: locations.len() - planned,
        ..Summary::new(&path, &locations, unit)
    };
    write_file(&arguments.output, text)?;
    if let Some(file) = &arguments.picture {
        let picture = picture::of_left_out(&mesh, &arguments.part, &tool.info().name, &path)?;
        write_file(file, picture)?;
    }
    let mut out = Output::lines();
    if json {
        out.json(&summary)?;
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
    if summary.inserted_locations > 0 {
        writeln!(
            out,
            "{} cutter locations inserted where the joints of the machine would lead the tool too deep",
            summary.inserted_locations
        )?;
    }
    writeln!(
        out,
        "{} points left out ({} not reached, {} without a proved motion); {retracts} retracts",
        summary.points_left_out, summary.points_not_reached, summary.points_without_motion
    )?;
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

/// Returns whether the spindle is below the tip, if z points up.
fn is_upside_down(location: &Location) -> bool {
    location.0.axis().z < 0.0
}

/// Returns the length of the tip's path in feed and in rapid traverse.
fn lengths(locations: &[Location]) -> [f64; 2] {
    let mut lengths = [0.0; 2];
    for pair in locations.windows(2) {
        let [(from, _), (to, rapid)] = [pair[0], pair[1]];
        if let Ok(motion) = Motion::new(&from, &to) {
            lengths[usize::from(rapid)] += motion.displacement().norm();
        }
    }
    lengths
}
