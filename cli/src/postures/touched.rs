//! `touchoff sweep --touched`: the postures that were touched in the page of `touchoff live`, proved and added to a map.

use crate::failure::Failure;
use crate::output::{Output, unreadable};
use serde::Serialize;
use std::io::Write;
use std::path::Path;
use touchoff::certify::TriangleBvh;
use touchoff::{FileKind, Mesh, Part, Pose, Probe, Sampling, Tool, TriangleId, read_text_file};
use touchoff_postures::sweep::SweepError;
use touchoff_postures::{PostureMap, PostureRecord, Validator};

/// The columns of the page's table.
const COLUMNS: &str = "triangle,niceness,tool,x,y,z,qx,qy,qz,qw";
/// Number of points of the part at which niceness is found.
const POINTS: usize = 100_000;

/// A posture of the table.
struct Touched {
    triangle: TriangleId,
    /// Index of the tool in the map's list.
    tool: u16,
    pose: Pose,
}

/// Summary of what was added.
#[derive(Default, Serialize)]
struct Summary {
    postures: usize,
    /// Number of postures that are proved acceptable.
    accepted: usize,
    /// Number of postures that touch their triangle at no point.
    without_contact: usize,
    /// Number of triangles that an accepted posture touches.
    triangles: usize,
}

/// Proves the postures of a table, and adds the acceptable ones to a map. Niceness is computed anew.
///
/// # Errors
/// If the table cannot be read or does not fit the part and the tools, or if the map cannot be written.
pub(super) fn record(
    file: &Path,
    map: &PostureMap,
    mesh: &Mesh,
    bvh: &TriangleBvh,
    tools: &[&dyn Tool],
    json: bool,
) -> Result<(), Failure> {
    let text =
        read_text_file(file, FileKind::Program).map_err(|source| unreadable(file, source))?;
    let touched = read(&text, mesh, tools).map_err(|(line, reason)| Failure::Touched {
        file: file.display().to_string(),
        line,
        reason,
    })?;
    let part = Part::from_mesh(mesh, Sampling::new(POINTS))?;
    let mut summary = Summary { postures: touched.len(), ..Summary::default() };
    let mut records: Vec<(TriangleId, PostureRecord)> = Vec::new();
    for (index, tool) in (0..).zip(tools) {
        let index: u16 = index;
        let mut probe = Probe::new(&part, *tool);
        let validator = Validator::new(bvh, *tool, &map.identity().rules);
        let mut validator = validator.map_err(SweepError::from)?;
        for posture in touched.iter().filter(|posture| posture.tool == index) {
            let contacts = probe.contacts(&posture.pose);
            let niceness = contacts.iter().map(|contact| contact.niceness);
            let niceness = niceness.fold(f64::INFINITY, f64::min);
            if !contacts.iter().any(|contact| contact.triangle == posture.triangle) {
                summary.without_contact += 1;
                continue;
            }
            if let Some(record) = validator.record(index, &posture.pose, niceness) {
                summary.accepted += 1;
                records.push((posture.triangle, record));
            }
        }
    }
    map.merge(&records)?;
    let mut triangles: Vec<TriangleId> = records.iter().map(|(triangle, _)| *triangle).collect();
    triangles.sort_unstable();
    triangles.dedup();
    summary.triangles = triangles.len();
    let mut out = Output::lines();
    if json {
        out.json(&summary)?;
    } else {
        let Summary { postures, accepted, without_contact, triangles } = summary;
        writeln!(
            out,
            "{postures} postures: {accepted} proved acceptable, at {triangles} triangles; {without_contact} touch their \
             triangle at none of {POINTS} points; {} too deep, not nice enough, or undecided",
            postures - accepted - without_contact
        )?;
    }
    Ok(out.flush()?)
}

/// Reads the table; an error is a line and the reason.
fn read(text: &str, mesh: &Mesh, tools: &[&dyn Tool]) -> Result<Vec<Touched>, (usize, String)> {
    let mut lines = (1..).zip(text.lines());
    if lines.next().is_none_or(|(_, head)| head.trim_end() != COLUMNS) {
        return Err((
            1,
            format!("the columns are not `{COLUMNS}`: export the table from the page"),
        ));
    }
    let rows = lines.filter(|(_, row)| !row.trim().is_empty());
    rows.map(|(line, row)| read_row(row, mesh, tools).map_err(|reason| (line, reason))).collect()
}

/// Reads a row of the table; an error is the reason.
fn read_row(row: &str, mesh: &Mesh, tools: &[&dyn Tool]) -> Result<Touched, String> {
    let cells: Vec<&str> = row.trim_end().split(',').collect();
    // Niceness is computed anew, so the page's is passed over.
    let [triangle, _, tool, pose @ ..] = &cells[..] else {
        return Err("the row is too short".to_owned());
    };
    let id = triangle.parse::<usize>().ok().filter(|id| mesh.triangles().get(*id).is_some());
    let id = id.ok_or_else(|| {
        format!("the part has no triangle `{triangle}`: name the part that was touched")
    })?;
    let position = tools.iter().position(|known| known.info().name == **tool);
    let position =
        position.ok_or_else(|| format!("the tool `{tool}` is none of `--tool`: name it, too"))?;
    let numbers: Result<Vec<f64>, _> = pose.iter().map(|cell| cell.parse::<f64>()).collect();
    let numbers = numbers.ok().and_then(|numbers| <[f64; 7]>::try_from(numbers).ok());
    let [x, y, z, rotation @ ..] = numbers.ok_or("the pose is not seven numbers")?;
    let pose = Pose::from_quaternion([x, y, z].into(), rotation);
    let pose = pose.map_err(|error| error.to_string())?;
    Ok(Touched { triangle: TriangleId(id as u32), tool: position as u16, pose })
}
