//! `touchoff map`: a summary of a posture map, and its other formats.

use super::picture;
use crate::arguments::postures::Map as Wanted;
use crate::failure::Failure;
use crate::files::ending;
use crate::output::{Output, refuse_inputs, unwritable};
use crate::part;
use serde::Serialize;
use std::io::Write;
use std::path::Path;
use touchoff::postures::{Directions, PartFingerprint, PostureMap, colormap};
use touchoff::{AtomicFile, Escaped, Mesh};

#[derive(Serialize)]
struct Summary<'a> {
    triangles: u32,
    unit: &'static str,
    tools: Vec<&'a str>,
    directions: usize,
    tolerance: f64,
    niceness: f64,
    covered: u32,
    swept: u32,
}

/// Prints a summary of a map, and writes it in other formats.
pub(crate) fn map(wanted: &Wanted, json: bool) -> Result<(), Failure> {
    let inputs = std::iter::once(&*wanted.map).chain(wanted.part.as_deref());
    refuse_inputs(wanted.to.iter().map(|to| &**to), inputs)?;
    let map = PostureMap::read(&wanted.map)?;
    let mesh = match &wanted.part {
        Some(part) => Some(belonging(&map, &wanted.map, part)?),
        None => None,
    };
    // Wrong names are reported before anything is written.
    let forms: Vec<Form> = wanted.to.iter().map(|file| Form::of(file)).collect::<Result<_, _>>()?;
    for (form, file) in forms.iter().zip(&wanted.to) {
        if mesh.is_none() && matches!(form, Form::Ply | Form::Png) {
            return Err(Failure::WantsPart { file: file.display().to_string() });
        }
    }
    for (form, file) in forms.iter().zip(&wanted.to) {
        let unwritable = |source| unwritable(file, source);
        let mut out = AtomicFile::create(file).map_err(unwritable)?;
        match (form, &mesh) {
            (Form::Csv, _) => map.write_csv(&mut out)?,
            (Form::Json, _) => map.write_json(&mut out)?,
            (Form::Ply, Some(mesh)) => {
                let nicest = nicest(&map)?;
                map.write_ply(&mut out, mesh, |niceness| colormap(niceness / nicest))?;
            }
            (Form::Png, Some(mesh)) => {
                let directions = Directions::from(map.identity().directions.clone());
                let picture = picture::of(&map, &directions, mesh, wanted.by)?;
                out.write_all(&picture).map_err(unwritable)?;
            }
            (Form::Ply | Form::Png, None) => (),
        }
        out.commit().map_err(unwritable)?;
        say!("{}", file.display());
    }
    told(&map, json)
}

/// Returns the greatest niceness of all postures; 1 if none is above 0.
fn nicest(map: &PostureMap) -> Result<f64, Failure> {
    let mut nicest: f64 = 0.0;
    for entry in map.rows()? {
        nicest = entry?.1.best.first().map_or(nicest, |best| nicest.max(best.niceness));
    }
    Ok(if nicest > 0.0 { nicest } else { 1.0 })
}

/// Reads the part of a map.
///
/// # Errors
/// If it cannot be read, or is not the map's.
pub(super) fn belonging(map: &PostureMap, file: &Path, part: &Path) -> Result<Mesh, Failure> {
    let mesh = part::mesh(part, map.identity().part.unit, "--part")?;
    check_part(map, file, (&mesh, part))?;
    Ok(mesh)
}

/// Checks that a map is of a part.
///
/// # Errors
/// [`Failure::OtherPart`] if it is not.
pub(crate) fn check_part(
    map: &PostureMap,
    file: &Path,
    (mesh, part): (&Mesh, &Path),
) -> Result<(), Failure> {
    if PartFingerprint::of(mesh) == map.identity().part {
        return Ok(());
    }
    let [map, part] = [file, part].map(|file| file.display().to_string());
    Err(Failure::OtherPart { map, part })
}

fn told(map: &PostureMap, json: bool) -> Result<(), Failure> {
    let (identity, coverage) = (map.identity(), map.coverage()?);
    let summary = Summary {
        triangles: coverage.triangles,
        unit: identity.part.unit.symbol(),
        tools: identity.tools.iter().map(|tool| &*tool.name).collect(),
        directions: identity.directions.len(),
        tolerance: identity.rules.tolerance,
        niceness: identity.rules.niceness,
        covered: coverage.covered,
        swept: coverage.swept,
    };
    let mut out = Output::lines();
    if json {
        serde_json::to_writer(&mut out, &summary)?;
        writeln!(out)?;
    } else {
        let tools: Vec<String> =
            summary.tools.iter().map(|name| Escaped(name).to_string()).collect();
        writeln!(out, "{}, in {}", tools.join(", "), summary.unit)?;
        writeln!(out, "{}; {} directions", identity.rules, summary.directions)?;
        writeln!(
            out,
            "{} of {} triangles have a posture; a sweep came to {}",
            summary.covered, summary.triangles, summary.swept
        )?;
    }
    out.flush()?;
    Ok(())
}

/// An output format, chosen by the file's extension.
enum Form {
    Csv,
    Json,
    Ply,
    Png,
}

impl Form {
    fn of(file: &Path) -> Result<Form, Failure> {
        match ending(file).as_deref() {
            Some("csv") => Ok(Form::Csv),
            Some("json") => Ok(Form::Json),
            Some("ply") => Ok(Form::Ply),
            Some("png") => Ok(Form::Png),
            _ => Err(Failure::MapForm { file: file.display().to_string() }),
        }
    }
}
