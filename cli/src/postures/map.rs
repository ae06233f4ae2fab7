//! `touchoff map`: a summary of a posture map, and its other formats.

use super::picture::{MapQuantity, of_map};
use crate::arguments::postures::{Map, Quantity};
use crate::failure::Failure;
use crate::output::{Output, extension, refuse_inputs, unwritable};
use crate::part;
use serde::Serialize;
use std::io::Write;
use std::path::Path;
use touchoff::{AtomicFile, Escaped, Mesh};
use touchoff_postures::{PartFingerprint, PostureMap, colormap};

#[derive(Serialize)]
struct Summary<'a> {
    triangles: u32,
    unit: &'static str,
    tools: Vec<&'a str>,
    directions: usize,
    tolerance: f64,
    min_niceness: f64,
    triangles_reached: u32,
    triangles_swept: u32,
    triangles_divided: u32,
    pieces: u32,
}

/// Prints a summary of a map, and writes it in other formats.
pub(crate) fn map(arguments: &Map, json: bool) -> Result<(), Failure> {
    let inputs = std::iter::once(&*arguments.map).chain(arguments.part.as_deref());
    refuse_inputs(arguments.output.iter().map(|file| &**file), inputs)?;
    let map = PostureMap::read(&arguments.map)?;
    let tool = arguments.tool.as_ref().map(|name| {
        let mut tools = map.identity().tools.iter();
        tools.position(|tool| tool.name == *name).map(|index| index as u16).ok_or_else(|| {
            let map = arguments.map.display().to_string();
            Failure::OtherTool { map, tool: name.clone() }
        })
    });
    let tool = tool.transpose()?;
    if tool.is_some() && arguments.color_by == Quantity::Niceness {
        return Err(Failure::Usage(
            "a map has the nicest posture of all tools, not of each: with `--tool`, give `--color-by accessibility` or \
             `--color-by stick-out`",
        ));
    }
    let part = match &arguments.part {
        Some(part) => Some((read_part(&map, &arguments.map, part)?, part)),
        None => None,
    };
    // Wrong names are reported before anything is written.
    let formats: Vec<MapFormat> =
        arguments.output.iter().map(|file| MapFormat::of(file)).collect::<Result<_, _>>()?;
    for (format, file) in formats.iter().zip(&arguments.output) {
        if part.is_none() && matches!(format, MapFormat::Parquet | MapFormat::Ply | MapFormat::Png)
        {
            return Err(Failure::PartMissing { file: file.display().to_string() });
        }
    }
    for (format, file) in formats.iter().zip(&arguments.output) {
        let unwritable = |source| unwritable(file, source);
        let mut out = AtomicFile::create(file).map_err(unwritable)?;
        match (format, &part) {
            (MapFormat::Csv, _) => map.write_csv(&mut out)?,
            (MapFormat::Json, _) => map.write_json(&mut out)?,
            (MapFormat::Parquet, Some((mesh, _))) => map.write_parquet(&mut out, mesh)?,
            (MapFormat::Ply, Some((mesh, _))) => {
                // Tools state niceness on any scale, so colours are relative to the best.
                let greatest = max_niceness(&map)?;
                map.write_ply(&mut out, mesh, |niceness| colormap(niceness / greatest))?;
            }
            (MapFormat::Png, Some((mesh, part))) => {
                let quantity = MapQuantity { by: arguments.color_by, tool };
                let picture = of_map(&map, mesh, part, quantity)?;
                out.write_all(&picture).map_err(unwritable)?;
            }
            // Refused above.
            (MapFormat::Parquet | MapFormat::Ply | MapFormat::Png, None) => (),
        }
        out.commit().map_err(unwritable)?;
        message!("{}", file.display());
    }
    print_summary(&map, json)
}

/// Returns the greatest niceness of all postures; 1 if none is above 0.
fn max_niceness(map: &PostureMap) -> Result<f64, Failure> {
    let mut greatest: f64 = 0.0;
    map.for_each_triangle(|_, pieces| {
        let best = pieces.iter().filter_map(|(_, row)| row.best.first());
        greatest = best.map(|best| best.niceness).fold(greatest, f64::max);
        Ok::<(), Failure>(())
    })?;
    Ok(if greatest > 0.0 { greatest } else { 1.0 })
}

/// Reads the part of a map.
///
/// # Errors
/// If it cannot be read, or is not the map's.
pub(crate) fn read_part(map: &PostureMap, file: &Path, part: &Path) -> Result<Mesh, Failure> {
    let mesh = part::mesh(part, map.identity().part.unit, "--part")?;
    check_part(map, file, &mesh, part)?;
    Ok(mesh)
}

/// Checks that a map is of a part.
///
/// # Errors
/// [`Failure::OtherPart`] if it is not.
pub(crate) fn check_part(
    map: &PostureMap,
    file: &Path,
    mesh: &Mesh,
    part: &Path,
) -> Result<(), Failure> {
    if PartFingerprint::of(mesh) == map.identity().part {
        return Ok(());
    }
    let [map, part] = [file, part].map(|file| file.display().to_string());
    Err(Failure::OtherPart { map, part })
}

fn print_summary(map: &PostureMap, json: bool) -> Result<(), Failure> {
    let (identity, coverage) = (map.identity(), map.coverage()?);
    let summary = Summary {
        triangles: coverage.triangles,
        unit: identity.part.unit.symbol(),
        tools: identity.tools.iter().map(|tool| &*tool.name).collect(),
        directions: identity.directions.len(),
        tolerance: identity.rules.tolerance,
        min_niceness: identity.rules.niceness,
        triangles_reached: coverage.covered,
        triangles_swept: coverage.swept,
        triangles_divided: coverage.divided,
        pieces: coverage.pieces,
    };
    let mut out = Output::lines();
    if json {
        out.json(&summary)?;
    } else {
        let tools: Vec<String> =
            summary.tools.iter().map(|name| Escaped(name).to_string()).collect();
        writeln!(out, "{}, in {}", tools.join(", "), summary.unit)?;
        writeln!(out, "{}; {} directions", identity.rules, summary.directions)?;
        writeln!(
            out,
            "{} of {} triangles have a posture; {} were swept",
            summary.triangles_reached, summary.triangles, summary.triangles_swept
        )?;
        if summary.triangles_divided > 0 {
            writeln!(
                out,
                "{} are divided into {} pieces",
                summary.triangles_divided, summary.pieces
            )?;
        }
    }
    Ok(out.flush()?)
}

/// An output format, chosen by the file's extension.
enum MapFormat {
    Csv,
    Json,
    Parquet,
    Ply,
    Png,
}

impl MapFormat {
    fn of(file: &Path) -> Result<MapFormat, Failure> {
        match extension(file).as_deref() {
            Some("csv") => Ok(MapFormat::Csv),
            Some("json") => Ok(MapFormat::Json),
            Some("parquet") => Ok(MapFormat::Parquet),
            Some("ply") => Ok(MapFormat::Ply),
            Some("png") => Ok(MapFormat::Png),
            _ => Err(Failure::Format {
                formats: "a map is written as `.csv`, `.json`, `.parquet`, `.ply` or `.png`",
                file: file.display().to_string(),
            }),
        }
    }
}
