//! The program against the material that is still there.

use super::{Job, JobError, JobGap, JobStock, JobTool, STOCK};
use crate::gcode::BlockLine;
use crate::stock::{self, DeviationPoint, MotionMode, Stock, StockContact};
use crate::{Move, MovePath};
use nalgebra::Point3;
use serde::Serialize;
use touchoff::Unit;

/// Material that a surface touches on consecutive motions. Lengths are in the part's unit.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct StockFinding {
    /// The block of the deepest contact.
    pub block: BlockLine,
    /// The block of the first motion.
    pub first: BlockLine,
    /// The block of the last motion.
    pub last: BlockLine,
    /// Number of blocks.
    pub motions: usize,
    /// Set in rapid traverse.
    pub rapid: bool,
    /// Name of the tool.
    pub tool: String,
    /// Its number in the program.
    pub tool_number: Option<u32>,
    /// The surface.
    pub surface: String,
    /// Set if the surface cuts.
    pub cutting: bool,
    /// Depth of a point of material in the tool.
    pub depth: f64,
    /// The point.
    pub point: Point3<f64>,
}

/// The result of cutting the stock.
#[derive(Debug)]
#[non_exhaustive]
pub struct CutStock {
    /// The findings, the deepest first.
    pub findings: Vec<StockFinding>,
    /// The material that remains.
    pub stock: Stock,
    /// Depth that surfaces may have that must not touch.
    pub tolerance: f64,
    /// The thickness from which a layer is found for certain by every tool that has moved in it, in the part's unit; infinite if
    /// none is.
    pub found_layer: f64,
    /// What is left open, each with its block: tools that can pass through material between its points, and rapid traverse of several axes
    /// that may pass through the stock.
    pub(super) open: Vec<(BlockLine, JobGap)>,
}

/// A finding as a JSON object.
#[derive(Serialize)]
pub(super) struct StockRow<'a> {
    file: &'a str,
    line: usize,
    first_line: usize,
    last_line: usize,
    motions: usize,
    rapid: bool,
    unit: &'static str,
    body: &'static str,
    tool: &'a str,
    tool_number: Option<u32>,
    kind: &'static str,
    surface: &'a str,
    cutting: bool,
    stock_depth: f64,
    point: [f64; 3],
}

/// A stock that a program cuts, motion by motion.
pub(super) struct StockCut {
    cut: CutStock,
    unit: Unit,
    /// The box of the stock before the program.
    bounds: [Point3<f64>; 2],
    /// The index of the finding that each surface goes on with.
    open: Vec<(usize, usize)>,
    /// The tools that have moved, by their numbers.
    seen: Vec<Option<u32>>,
}

impl StockCut {
    /// Makes the stock of a job.
    ///
    /// # Errors
    /// If it cannot be made.
    pub(super) fn new(entry: &JobStock, job: &Job<'_>) -> Result<StockCut, JobError> {
        let stock = entry.build(job.unit())?;
        // The report keeps the stock of each reading.
        stock::check_count(stock.len() * job.program.reading_count(), stock.spacing())?;
        let tolerance = entry.tolerance.unwrap_or(stock.step());
        let found_layer = stock.found_layer(tolerance);
        let cut =
            CutStock { findings: Vec::new(), stock, tolerance, found_layer, open: Vec::new() };
        let bounds = entry.bounds();
        Ok(StockCut { cut, unit: job.unit(), bounds, open: Vec::new(), seen: Vec::new() })
    }

    /// Notes the layer that a tool finds for certain, and that it is more than twice as thick as that of a wide tool.
    fn see(&mut self, tool: &JobTool<'_>, block: BlockLine) {
        if self.seen.contains(&tool.number()) {
            return;
        }
        self.seen.push(tool.number());
        let CutStock { stock, tolerance, found_layer, open, .. } = &mut self.cut;
        let info = tool.tool.info();
        let layer = stock.found_layer_of(tool.tool, *tolerance);
        *found_layer = found_layer.max(layer.unwrap_or(f64::INFINITY));
        // A wide tool finds the thinnest layer that the spacing allows.
        if layer.is_none_or(|layer| layer > 2.0 * stock.found_layer(*tolerance)) {
            let name = tool.number().map_or(info.name.to_string(), |number| format!("T{number}"));
            let unit = self.unit;
            let found = match layer {
                Some(layer) => format!("up to a thickness of {}", unit.format(layer)),
                None => "of any thickness".to_owned(),
            };
            let spacing = unit.format(stock.spacing());
            open.push((block, JobGap::ThinTool { name, spacing, found }));
        }
    }

    /// Runs a motion through the stock.
    ///
    /// # Errors
    /// If it cannot be cut.
    pub(super) fn advance(&mut self, tool: &JobTool<'_>, step: &Move) -> Result<(), JobError> {
        self.see(tool, step.block());
        if step.alternative {
            return Ok(());
        }
        let CutStock { findings, stock, tolerance, open, .. } = &mut self.cut;
        let info = tool.tool.info();
        // Only the straight path is run through the stock. At other rates the tool is anywhere in the box.
        if let MovePath::Box(path) = &step.path
            && open.iter().all(|(_, gap)| !matches!(gap, JobGap::StockRapid))
        {
            let [low, high] = path.tool_bounds(info, self.unit);
            let [from, to] = self.bounds;
            if (0..3).all(|k| low[k] <= to[k] && from[k] <= high[k]) {
                open.push((step.block(), JobGap::StockRapid));
            }
        }
        let max_speed = step.path.max_speed(info, self.unit);
        // Nothing led to the first position, so it cuts nothing there.
        let is_rapid = step.rapid || step.from.is_none();
        let mode = if is_rapid { MotionMode::Rapid } else { MotionMode::Feed };
        let contacts =
            stock.advance(tool.tool, &|time| step.path.pose(time), max_speed, mode, *tolerance)?;
        // A surface that touches nothing on this motion begins another finding when it touches again.
        self.open
            .retain(|(surface, _)| contacts.iter().any(|contact| contact.surface.0 == *surface));
        for StockContact { surface, depth, point, continued, .. } in contacts {
            let known = self.open.iter().find(|(known, _)| *known == surface.0);
            if let Some((_, index)) = known.filter(|_| continued) {
                let finding = &mut findings[*index];
                // A block may have several moves.
                finding.motions += usize::from(finding.last != step.block());
                finding.last = step.block();
                if depth > finding.depth {
                    (finding.block, finding.depth, finding.point) = (step.block(), depth, point);
                }
                continue;
            }
            self.open.retain(|(known, _)| *known != surface.0);
            self.open.push((surface.0, findings.len()));
            findings.push(StockFinding {
                block: step.block(),
                first: step.block(),
                last: step.block(),
                motions: 1,
                rapid: step.rapid,
                tool: info.name.to_string(),
                tool_number: tool.number(),
                surface: info.surface(surface).name.to_string(),
                cutting: info.surface(surface).cutting,
                depth,
                point,
            });
        }
        Ok(())
    }

    /// Returns the stock after the program.
    pub(super) fn finish(mut self) -> CutStock {
        self.cut.findings.sort_by(|one, other| other.depth.total_cmp(&one.depth));
        self.cut
    }
}

impl StockFinding {
    /// Describes the finding.
    pub(super) fn describe(&self, unit: Unit) -> String {
        let StockFinding { surface, depth, point, motions, first, last, .. } = self;
        let rapid = if self.rapid { " in rapid traverse" } else { "" };
        let tool = self.tool_number.map_or(String::new(), |number| format!("T{number} "));
        let lines = match motions {
            1 => String::new(),
            _ if first.line == last.line => format!(", on {motions} motions, line {}", first.line),
            _ => format!(", on {motions} motions, lines {} to {}", first.line, last.line),
        };
        format!(
            "{tool}{surface} touches the stock{rapid}, {} deep at {}{lines}",
            unit.format(*depth),
            unit.format_point(point)
        )
    }

    pub(super) fn row<'a>(&'a self, file: &'a str, unit: Unit) -> StockRow<'a> {
        StockRow {
            file,
            line: self.block.line,
            first_line: self.first.line,
            last_line: self.last.line,
            motions: self.motions,
            rapid: self.rapid,
            unit: unit.symbol(),
            body: STOCK,
            tool: &self.tool,
            tool_number: self.tool_number,
            kind: "stock",
            surface: &self.surface,
            cutting: self.cutting,
            stock_depth: self.depth,
            point: self.point.into(),
        }
    }
}

impl CutStock {
    /// States what is found for certain.
    pub fn resolution(&self) -> String {
        match self.found_layer.is_finite() {
            true => format!(
                "a layer is found for certain from a thickness of {}",
                self.stock.unit().format(self.found_layer)
            ),
            false => "no layer is found for certain".to_owned(),
        }
    }

    /// Describes a deviation from the part at its farthest point, as far as points of the stock show it.
    pub fn farthest(&self, what: &str, point: Option<DeviationPoint>) -> String {
        let unit = self.stock.unit();
        match point {
            None => {
                format!(
                    "{what}: none at points that are {} apart",
                    unit.format(self.stock.spacing())
                )
            }
            Some(point) => format!(
                "{what}: {} at {}",
                unit.format(point.distance.abs()),
                unit.format_point(&point.point)
            ),
        }
    }
}
