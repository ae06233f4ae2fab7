//! Export of maps. Every number is written so that it reads back as the same double.

use super::{MapError, MapIdentity, PartFingerprint, PostureMap};
use crate::record::{area_reached, direction_count};
use crate::shard::{TableRow, encoded};
use crate::{Accessibility, MapRow, Piece, PostureRecord, Rules};
use serde::Serialize;
use std::collections::HashMap;
use std::io::{self, Write};
use touchoff::{Mesh, TriangleId};

/// The columns of the CSV export.
const COLUMNS: &str =
    "triangle,tool,x,y,z,i,j,k,niceness,depth,clearance,directions,stickout,area_reached";

/// The JSON export's object before the rows.
#[derive(Serialize)]
struct ExportHeader<'a> {
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
    triangle: TriangleId,
    pieces: usize,
    best: Vec<ExportPosture<'a>>,
    access: Vec<ExportAccess<'a>>,
}

#[derive(Serialize)]
struct ExportPosture<'a> {
    tool: &'a str,
    tip: [f64; 3],
    axis: [f64; 3],
    niceness: f64,
    depth: f64,
    /// JSON has no infinity: `null` for a tool with nothing but cutting surfaces.
    clearance: f64,
}

#[derive(Serialize)]
struct ExportAccess<'a> {
    tool: &'a str,
    directions: u32,
    stickout: Option<f64>,
    area_reached: Option<f64>,
}

impl PostureMap {
    /// Writes the map as CSV, with a header. There is one line per posture on record, the best of a triangle
    /// first. A tool that a sweep tried at a triangle without a posture on record gets a line with the columns
    /// of postures empty. `x,y,z` is the tip and `i,j,k` the axis. `directions` is the number of directions
    /// from which the tool reaches the triangle, and `stickout` the least stick-out for one of them; both are
    /// empty if no sweep has processed the triangle. `area_reached` is the fraction of the triangle's area that the
    /// tool reaches, by pieces: 0 or 1 for an undivided triangle. Of a divided one the line has the best postures, the
    /// directions and the least stick-out of all pieces ([`MapRow::joined`]). `clearance` is `inf` for a tool with
    /// nothing but cutting surfaces. Lengths are in the part's unit.
    ///
    /// # Errors
    /// If the output cannot be written, or the map cannot be read.
    pub fn write_csv(&self, out: &mut impl Write) -> Result<(), MapError> {
        let export = |source| self.export(source);
        writeln!(out, "{COLUMNS}").map_err(export)?;
        self.for_each_triangle(|triangle, pieces| {
            let row = MapRow::joined(&pieces, self.identity.keep);
            row.lines().try_for_each(|(record, access)| {
                let reached = access.and_then(|access| area_reached(&pieces, access.tool));
                self.line(out, triangle, record, access, reached).map_err(export)
            })
        })?;
        out.flush().map_err(export)
    }

    fn line(
        &self,
        out: &mut impl Write,
        triangle: TriangleId,
        record: Option<&PostureRecord>,
        access: Option<&Accessibility>,
        area_reached: Option<f64>,
    ) -> io::Result<()> {
        let tool = record.map(|record| record.tool).or(access.map(|access| access.tool));
        let name = tool.map_or("", |tool| self.name(tool));
        write!(out, "{triangle},{}", quoted(name))?;
        match record {
            Some(PostureRecord {
                tip: [x, y, z],
                axis: [i, j, k],
                niceness,
                depth,
                clearance,
                ..
            }) => {
                for number in [x, y, z, i, j, k, niceness, depth, clearance] {
                    write!(out, ",{number:?}")?;
                }
            }
            None => write!(out, ",,,,,,,,,")?,
        }
        match access {
            Some(access) => write!(out, ",{},", direction_count(access))?,
            None => write!(out, ",,")?,
        }
        let [stickout, area_reached] = [access.and_then(|access| access.stickout), area_reached]
            .map(|number| number.map_or(String::new(), |number| format!("{number:?}")));
        writeln!(out, "{stickout},{area_reached}")
    }

    /// Writes the map as JSON: an object with the map's identity under `map`, and an array of one object per
    /// row under `rows`, one line each. Numbers are as in [`PostureMap::write_csv`], but `null` stands for
    /// infinity; `pieces` is the number of pieces of the triangle.
    ///
    /// # Errors
    /// If the output cannot be written, or the map cannot be read.
    pub fn write_json(&self, out: &mut impl Write) -> Result<(), MapError> {
        let export = |source| self.export(source);
        let json = |source: serde_json::Error| self.export(source.into());
        let MapIdentity { part, tools, directions, rules, .. } = &self.identity;
        let tools = tools.iter();
        let head = ExportHeader {
            digest: format!("{:016x}", part.digest),
            triangles: part.triangles,
            unit: part.unit.symbol(),
            tools: tools
                .map(|tool| Tool { name: &tool.name, digest: format!("{:016x}", tool.digest) })
                .collect(),
            directions: directions.len(),
            rules,
        };
        write!(out, "{{\"map\": ").map_err(export)?;
        serde_json::to_writer(&mut *out, &head).map_err(json)?;
        write!(out, ",\n\"rows\": [").map_err(export)?;
        let mut separator = "\n";
        self.for_each_triangle(|triangle, pieces| {
            write!(out, "{separator}").map_err(export)?;
            separator = ",\n";
            let row = MapRow::joined(&pieces, self.identity.keep);
            let best = row.best.iter().map(
                |&PostureRecord { tool, tip, axis, niceness, depth, clearance }| ExportPosture {
                    tool: self.name(tool),
                    tip,
                    axis,
                    niceness,
                    depth,
                    clearance,
                },
            );
            let access = row.access.iter().map(|access| ExportAccess {
                tool: self.name(access.tool),
                directions: direction_count(access),
                stickout: access.stickout,
                area_reached: area_reached(&pieces, access.tool),
            });
            let (best, access) = (best.collect(), access.collect());
            let row = Triangle { triangle, pieces: pieces.len(), best, access };
            serde_json::to_writer(&mut *out, &row).map_err(json)
        })?;
        writeln!(out, "\n]}}").and_then(|()| out.flush()).map_err(export)
    }

    /// Writes the map as a table in Apache Parquet, for DuckDB, Polars and other engines: the lines of [`PostureMap::write_csv`], with
    /// the area of the triangle, the place of the posture among those of its triangle (`rank`, from 0), and the set of directions from
    /// which the tool reaches the triangle (`direction_set`, of which the most significant bit of the first byte is direction 0). The
    /// map's identity is the metadata `touchoff.map`, as JSON.
    ///
    /// # Errors
    /// If the mesh is not the map's part, if the output cannot be written, or if the map cannot be read.
    pub fn write_parquet(&self, out: &mut impl Write, mesh: &Mesh) -> Result<(), MapError> {
        self.check_mesh(mesh)?;
        let mut rows = Vec::new();
        self.for_each_triangle(|triangle, pieces| {
            let row = MapRow::joined(&pieces, self.identity.keep);
            let reached = row.access.iter().map(|access| area_reached(&pieces, access.tool));
            let (area, reached) = (mesh.area(triangle), reached.collect());
            rows.push(TableRow { triangle, area, row, reached });
            Ok::<(), MapError>(())
        })?;
        let bytes = encoded(&self.identity, None, &rows);
        out.write_all(&bytes).and_then(|()| out.flush()).map_err(|error| self.export(error))
    }

    /// Writes the map's part as binary PLY. Each face has a colour (`red`, `green`, `blue`) and the `niceness`
    /// of its best posture on record; a face without one is grey, and its niceness is NaN. Faces are in the
    /// order of triangles, and each names its `triangle`. A divided triangle has one face per piece, whose corners may
    /// lie on the edges of other faces. [`colormap`](fn@crate::colormap) gives colours for values from 0 to 1.
    ///
    /// # Errors
    /// If the mesh is not the map's part, if the output cannot be written, or if the map cannot be read.
    pub fn write_ply(
        &self,
        out: &mut impl Write,
        mesh: &Mesh,
        colour: impl Fn(f64) -> [u8; 3],
    ) -> Result<(), MapError> {
        self.check_mesh(mesh)?;
        let mut faces = Vec::new();
        self.for_each_triangle(|triangle, pieces| {
            // Triangles without a row are missing here, and are faces too.
            while faces.len() < triangle.index() {
                faces.push(vec![]);
            }
            let pieces = pieces.iter().map(|(piece, row)| {
                (*piece, row.best.first().map_or(f64::NAN, |best| best.niceness))
            });
            faces.push(pieces.collect());
            Ok::<(), MapError>(())
        })?;
        faces.resize(mesh.triangles().len(), Vec::new());
        write_ply_body(out, mesh, &faces, colour).map_err(|source| self.export(source))
    }

    fn check_mesh(&self, mesh: &Mesh) -> Result<(), MapError> {
        let (stored, requested) = (self.identity.part, PartFingerprint::of(mesh));
        if stored == requested {
            return Ok(());
        }
        let difference = super::Difference::Part { stored, requested };
        Err(MapError::Differs { file: self.file.clone(), difference })
    }

    fn name(&self, tool: u16) -> &str {
        &self.identity.tools[usize::from(tool)].name
    }

    fn export(&self, source: io::Error) -> MapError {
        MapError::Export { file: self.file.clone(), source }
    }
}

/// Colour of a face without a posture.
const GREY: [u8; 3] = [0x80; 3];

/// Writes the faces of the pieces of each triangle, with their niceness. A triangle without pieces is one face.
fn write_ply_body(
    out: &mut impl Write,
    mesh: &Mesh,
    pieces: &[Vec<(Piece, f64)>],
    colour: impl Fn(f64) -> [u8; 3],
) -> io::Result<()> {
    let mut vertices = mesh.vertices().to_vec();
    // Corners that are not those of the mesh.
    let mut added: HashMap<[u64; 3], u32> = HashMap::new();
    let mut faces = Vec::new();
    for (id, pieces) in mesh.ids().zip(pieces) {
        let triangle = mesh.triangles()[id.index()];
        if pieces.is_empty() {
            faces.push((id, triangle, f64::NAN));
        }
        for (piece, niceness) in pieces {
            let corners = piece.corners(mesh).map(|corner| {
                let known = triangle.iter().find(|v| vertices[**v as usize] == corner);
                known.copied().unwrap_or_else(|| {
                    *added.entry(corner.coords.map(f64::to_bits).into()).or_insert_with(|| {
                        vertices.push(corner);
                        vertices.len() as u32 - 1
                    })
                })
            });
            // Two vertices of the mesh may be at one point, and an undivided triangle keeps its own.
            let corners = if piece.cuts() == 0 { triangle } else { corners };
            faces.push((id, corners, *niceness));
        }
    }
    write!(
        out,
        "ply\nformat binary_little_endian 1.0\ncomment unit {}\nelement vertex {}\n\
         property double x\nproperty double y\nproperty double z\nelement face {}\n\
         property list uchar uint vertex_indices\nproperty uchar red\nproperty uchar green\n\
         property uchar blue\nproperty double niceness\nproperty uint triangle\nend_header\n",
        mesh.unit(),
        vertices.len(),
        faces.len(),
    )?;
    for coordinate in vertices.iter().flat_map(|vertex| vertex.coords.iter()) {
        out.write_all(&coordinate.to_le_bytes())?;
    }
    for (id, corners, niceness) in faces {
        out.write_all(&[3])?;
        for corner in corners {
            out.write_all(&corner.to_le_bytes())?;
        }
        out.write_all(&if niceness.is_nan() { GREY } else { colour(niceness) })?;
        out.write_all(&niceness.to_le_bytes())?;
        out.write_all(&id.0.to_le_bytes())?;
    }
    out.flush()
}

/// Returns a CSV field, in quotes if needed.
fn quoted(field: &str) -> String {
    if field.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", field.replace('"', "\"\""))
    } else {
        field.to_owned()
    }
}
