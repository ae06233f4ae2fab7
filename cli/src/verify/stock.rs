//! The program against the material that is still there.

use super::job::{Job, Stock as StockEntry};
use super::source::CheckedProgram;
use super::tools::ProgramTool;
use crate::failure::Failure;
use crate::lengths::{format_length, format_point};
use crate::output::write_file;
use crate::part;
use nalgebra::Point3;
use serde::Serialize;
use std::path::Path;
use touchoff::Unit;
use touchoff::certify::TriangleBvh;
use touchoff_verify::stock::{DeviationPoint, MotionMode, Stock, StockContact};

/// Material that a surface touches on consecutive motions.
#[derive(Serialize)]
pub(crate) struct StockFinding {
    file: String,
    /// The line of the deepest contact, and of the first and the last motion.
    pub(super) line: usize,
    pub(super) first_line: usize,
    pub(super) last_line: usize,
    motions: usize,
    rapid: bool,
    unit: &'static str,
    body: &'static str,
    tool: String,
    pub(crate) tool_number: Option<u32>,
    kind: &'static str,
    surface: String,
    cutting: bool,
    /// Depth of a point of material in the tool.
    #[serde(rename = "stock_depth")]
    depth: f64,
    pub(crate) point: [f64; 3],
}

/// The result of cutting the stock.
pub(crate) struct CutStock {
    pub(crate) findings: Vec<StockFinding>,
    pub(crate) stock: Stock,
    /// Depth that surfaces may have that must not touch.
    tolerance: f64,
}

/// Runs a program through the stock of a job.
///
/// # Errors
/// If the stock cannot be made, or the program does not state tools in their order.
pub(super) fn cut(
    job: &Job,
    entry: &StockEntry,
    (program, reading): (&CheckedProgram, usize),
    tools: &[ProgramTool],
) -> Result<CutStock, Failure> {
    let mut stock = match (&entry.mesh, entry.corners) {
        (Some(mesh), None) => {
            Stock::from_mesh(&part::mesh(mesh, job.unit, "stock")?, entry.spacing)?
        }
        (None, Some(corners)) => {
            Stock::from_box(corners.map(Point3::from), entry.spacing, job.unit)?
        }
        _ => return Err(Failure::Usage("a stock has a `mesh` or a `box`, and not both")),
    };
    let tolerance = entry.tolerance.unwrap_or(stock.step());
    let file = job.program.display().to_string();
    let mut findings: Vec<StockFinding> = Vec::new();
    // The index in `findings` of the contact that each surface goes on with.
    let mut open: Vec<(usize, usize)> = Vec::new();
    for (tool, step) in program.moves_in_order(reading, tools, job.unit)? {
        let info = tool.tool().info();
        let max_speed = step.path.max_speed(info, job.unit);
        let mode = if step.rapid { MotionMode::Rapid } else { MotionMode::Feed };
        let contacts =
            stock.advance(tool.tool(), &|time| step.path.pose(time), max_speed, mode, tolerance)?;
        open.retain(|(surface, _)| contacts.iter().any(|contact| contact.surface.0 == *surface));
        for StockContact { surface, depth, point, continued, .. } in contacts {
            let known = open.iter().find(|(known, _)| *known == surface.0).filter(|_| continued);
            if let Some((_, index)) = known {
                let finding = &mut findings[*index];
                finding.motions += usize::from(finding.last_line != step.line);
                finding.last_line = step.line;
                if depth > finding.depth {
                    (finding.line, finding.depth, finding.point) = (step.line, depth, point.into());
                }
                continue;
            }
            open.retain(|(known, _)| *known != surface.0);
            open.push((surface.0, findings.len()));
            findings.push(StockFinding {
                file: file.clone(),
                line: step.line,
                first_line: step.line,
                last_line: step.line,
                motions: 1,
                rapid: step.rapid,
                unit: job.unit.symbol(),
                body: "the stock",
                tool: info.name.to_string(),
                tool_number: tool.number,
                kind: "stock",
                surface: info.surface(surface).name.to_string(),
                cutting: info.surface(surface).cutting,
                depth,
                point: point.into(),
            });
        }
    }
    findings.sort_by(|one, other| other.depth.total_cmp(&one.depth));
    Ok(CutStock { findings, stock, tolerance })
}

impl StockFinding {
    /// Describes the finding.
    pub(super) fn describe(&self, unit: Unit) -> String {
        let StockFinding { surface, depth, point, motions, first_line, last_line, .. } = self;
        let rapid = if self.rapid { " in rapid traverse" } else { "" };
        let tool = self.tool_number.map_or(String::new(), |number| format!("T{number} "));
        let lines = match motions {
            1 => String::new(),
            _ => format!(", on {motions} motions, lines {first_line} to {last_line}"),
        };
        format!(
            "{tool}{surface} touches the stock{rapid}, {} deep at {}{lines}",
            format_length(*depth, unit),
            format_point(&Point3::from(*point), unit)
        )
    }
}

impl CutStock {
    /// States what is found for certain.
    pub(crate) fn resolution(&self) -> String {
        format!(
            "a layer is found for certain from a thickness of {}",
            format_length(self.stock.found_layer(self.tolerance), self.stock.unit())
        )
    }

    /// Describes a deviation from the part at its farthest point, as far as points of the stock show it.
    pub(crate) fn farthest(&self, what: &str, point: Option<DeviationPoint>) -> String {
        let unit = self.stock.unit();
        match point {
            None => {
                let spacing = format_length(self.stock.spacing(), unit);
                format!("{what}: none at points that are {spacing} apart")
            }
            Some(point) => format!(
                "{what}: {} at {}",
                format_length(point.distance.abs(), unit),
                format_point(&point.point, unit)
            ),
        }
    }

    /// Prints what remains, and writes it as an STL file and its deviations from the part as CSV or PLY if asked to.
    ///
    /// # Errors
    /// If a file cannot be written.
    pub(super) fn report(&self, entry: &StockEntry, part: &TriangleBvh) -> Result<(), Failure> {
        let stock = &self.stock;
        let comparison = stock.compare(part)?;
        message!(
            "stock: {} of {} points remain; {}; {}; {}",
            stock.len(),
            stock.initial_len(),
            self.resolution(),
            self.farthest("most over the part", comparison.greatest_excess()),
            self.farthest("most cut from the part", comparison.deepest_gouge()),
        );
        if let Some(output) = &entry.output {
            let mut bytes = Vec::new();
            stock.remaining_mesh()?.write_stl(&mut bytes)?;
            write_file(output, bytes)?;
        }
        if let Some(map) = &entry.map {
            let mut bytes = Vec::new();
            match Path::new(map).extension().is_some_and(|extension| extension == "ply") {
                true => comparison.write_ply(&mut bytes)?,
                false => comparison.write_csv(&mut bytes)?,
            }
            write_file(map, bytes)?;
        }
        Ok(())
    }
}
