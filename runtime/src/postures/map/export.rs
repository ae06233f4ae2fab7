//! Maps as others read them. Every number is written so that it reads back as the same double.

use super::{Identity, MapError, PartStamp, PostureMap};
use crate::mesh::Mesh;
use crate::postures::{Access, Record, Row, Rules};
use serde::Serialize;
use std::io::{self, Write};

/// The columns of a CSV.
const COLUMNS: &str = "triangle,tool,x,y,z,i,j,k,niceness,depth,clearance,directions,stickout";

/// What JSON has before the triangles.
#[derive(Serialize)]
struct Head<'a> {
    digest: String,
    triangles: u32,
    unit: &'static str,
    tools: Vec<Tool<'a>>,
    directions: usize,
    rules: &'a Rules,
}

#[derive(Serialize)]
struct Tool<'a> {
    name: &'a str,
    digest: String,
}

#[derive(Serialize)]
struct Triangle<'a> {
    triangle: u32,
    best: Vec<Best<'a>>,
    access: Vec<Reach<'a>>,
}

#[derive(Serialize)]
struct Best<'a> {
    tool: &'a str,
    tip: [f64; 3],
    axis: [f64; 3],
    niceness: f64,
    depth: f64,
    /// JSON has no infinity: `null` where nothing of the tool does not cut.
    clearance: f64,
}

#[derive(Serialize)]
struct Reach<'a> {
    tool: &'a str,
    directions: u32,
    stickout: Option<f64>,
}

impl PostureMap {
    /// Writes the map as CSV, with a header: a line for each posture on record, the best of a triangle first,
    /// and one for each tool that a sweep tried there and that has none, with these columns left empty. `x,y,z`
    /// is the tip, `i,j,k` the axis; `directions` is from how many the tool reaches the triangle and
    /// `stickout` how far it has to stick out for one of them, both empty where no sweep came by.
    /// `clearance` is `inf` where nothing of the tool does not cut. Lengths are in the part's unit.
    ///
    /// # Errors
    /// If it cannot be written, or the map not be read.
    pub fn write_csv(&self, out: &mut impl Write) -> Result<(), MapError> {
        let export = |source| self.export(source);
        writeln!(out, "{COLUMNS}").map_err(export)?;
        for entry in self.rows()? {
            let (triangle, row) = entry?;
            for (record, access) in lines(&row) {
                self.line(out, triangle, record, access).map_err(export)?;
            }
        }
        out.flush().map_err(export)
    }

    fn line(
        &self,
        out: &mut impl Write,
        triangle: u32,
        record: Option<&Record>,
        access: Option<&Access>,
    ) -> io::Result<()> {
        let tool = record.map(|record| record.tool).or(access.map(|access| access.tool));
        let name = tool.map_or("", |tool| self.name(tool));
        write!(out, "{triangle},{}", quoted(name))?;
        match record {
            Some(Record {
                tip: [x, y, z], axis: [i, j, k], niceness, depth, clearance, ..
            }) => {
                for number in [x, y, z, i, j, k, niceness, depth, clearance] {
                    write!(out, ",{number:?}")?;
                }
            }
            None => write!(out, ",,,,,,,,,")?,
        }
        match access {
            Some(access) => write!(out, ",{},", reached(access))?,
            None => write!(out, ",,")?,
        }
        match access.and_then(|access| access.stickout) {
            Some(stickout) => writeln!(out, "{stickout:?}"),
            None => writeln!(out),
        }
    }

    /// Writes the map as JSON: an object with what the map belongs to under `map`, and under `rows` an object
    /// for each triangle of which something is known, a line each. Numbers are as in
    /// [`PostureMap::write_csv`], but `null` stands for infinity.
    ///
    /// # Errors
    /// If it cannot be written, or the map not be read.
    pub fn write_json(&self, out: &mut impl Write) -> Result<(), MapError> {
        let export = |source| self.export(source);
        let json = |source: serde_json::Error| self.export(source.into());
        let Identity { part, tools, directions, rules, .. } = &self.identity;
        let tools = tools.iter();
        let head = Head {
            digest: format!("{:016x}", part.digest),
            triangles: part.triangles,
            unit: part.unit.word(),
            tools: tools
                .map(|tool| Tool { name: &tool.name, digest: format!("{:016x}", tool.digest) })
                .collect(),
            directions: directions.len(),
            rules,
        };
        write!(out, "{{\"map\": ").map_err(export)?;
        serde_json::to_writer(&mut *out, &head).map_err(json)?;
        write!(out, ",\n\"rows\": [").map_err(export)?;
        let mut between = "\n";
        for entry in self.rows()? {
            let (triangle, row) = entry?;
            write!(out, "{between}").map_err(export)?;
            between = ",\n";
            let best =
                row.best.iter().map(|&Record { tool, tip, axis, niceness, depth, clearance }| {
                    Best { tool: self.name(tool), tip, axis, niceness, depth, clearance }
                });
            let access = row.access.iter().map(|access| Reach {
                tool: self.name(access.tool),
                directions: reached(access),
                stickout: access.stickout,
            });
            let row = Triangle { triangle, best: best.collect(), access: access.collect() };
            serde_json::to_writer(&mut *out, &row).map_err(json)?;
        }
        writeln!(out, "\n]}}").and_then(|()| out.flush()).map_err(export)
    }

    /// Writes the map's part as binary PLY whose faces have a colour (`red`, `green`, `blue`) and the
    /// `niceness` of the best posture on record; where there is none they are grey, and the niceness is not a
    /// number. Faces are in the order of triangles. [`colour`](crate::postures::colour) is a ramp from 0 to 1.
    ///
    /// # Errors
    /// If the mesh is not the map's part; if it cannot be written, or the map not be read.
    pub fn write_ply(
        &self,
        out: &mut impl Write,
        mesh: &Mesh,
        colour: impl Fn(f64) -> [u8; 3],
    ) -> Result<(), MapError> {
        let (has, asked) = (self.identity.part, PartStamp::of(mesh));
        if has != asked {
            let difference = super::Difference::Part { has, asked };
            return Err(MapError::Differs { file: self.file.clone(), difference });
        }
        let mut niceness = vec![f64::NAN; mesh.triangles().len()];
        for entry in self.rows()? {
            let (triangle, row) = entry?;
            if let Some(best) = row.best.first() {
                niceness[triangle as usize] = best.niceness;
            }
        }
        ply(out, mesh, &niceness, colour).map_err(|source| self.export(source))
    }

    fn name(&self, tool: u16) -> &str {
        &self.identity.tools[usize::from(tool)].name
    }

    fn export(&self, source: io::Error) -> MapError {
        MapError::Export { file: self.file.clone(), source }
    }
}

/// The colour of a face of which no posture is known.
const GREY: [u8; 3] = [0x80; 3];

fn ply(
    out: &mut impl Write,
    mesh: &Mesh,
    niceness: &[f64],
    colour: impl Fn(f64) -> [u8; 3],
) -> io::Result<()> {
    let (vertices, triangles) = (mesh.vertices(), mesh.triangles());
    write!(
        out,
        "ply\nformat binary_little_endian 1.0\ncomment unit {}\nelement vertex {}\n\
         property double x\nproperty double y\nproperty double z\nelement face {}\n\
         property list uchar uint vertex_indices\nproperty uchar red\nproperty uchar green\n\
         property uchar blue\nproperty double niceness\nend_header\n",
        mesh.unit(),
        vertices.len(),
        triangles.len(),
    )?;
    for coordinate in vertices.iter().flat_map(|vertex| vertex.coords.iter()) {
        out.write_all(&coordinate.to_le_bytes())?;
    }
    for (corners, niceness) in triangles.iter().zip(niceness) {
        out.write_all(&[3])?;
        for corner in corners {
            out.write_all(&corner.to_le_bytes())?;
        }
        out.write_all(&if niceness.is_nan() { GREY } else { colour(*niceness) })?;
        out.write_all(&niceness.to_le_bytes())?;
    }
    out.flush()
}

/// The postures of a row, each beside what its tool reaches, and the tools that have none.
fn lines(row: &Row) -> impl Iterator<Item = (Option<&Record>, Option<&Access>)> {
    let of = |record: &Record| row.access.iter().find(|access| access.tool == record.tool);
    let records = row.best.iter().map(move |record| (Some(record), of(record)));
    let alone = |access: &&Access| row.best.iter().all(|record| record.tool != access.tool);
    records.chain(row.access.iter().filter(alone).map(|access| (None, Some(access))))
}

/// From how many directions a tool reaches a triangle.
fn reached(access: &Access) -> u32 {
    access.directions.iter().map(|word| word.count_ones()).sum()
}

/// A field of a CSV.
fn quoted(field: &str) -> String {
    if field.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", field.replace('"', "\"\""))
    } else {
        field.to_owned()
    }
}
