//! Depth, clearance, force and niceness along a program, and their charts, drawn by `plotters`.

use crate::failure::Failure;
use crate::picture::pixels;
use crate::timing::nanoseconds;
use crate::verify::Inputs;
use plotters::coord::Shift;
use plotters::prelude::*;
use std::time::Instant;
use touchoff::certify::Certifier;
use touchoff::{Cloud, Law, Part, Probe, Sampling, SurfaceId, Unit};
use touchoff_verify::job::PairReport;
use touchoff_verify::{FindingKind, JobReport};

/// Number of positions per tool at which force and distances are computed.
const SAMPLES: usize = 2000;
/// Number of positions of all tools together.
const MAX_SAMPLES: usize = 20_000;
/// Number of points of the part from which forces are summed.
pub(super) const POINTS: usize = 100_000;
/// Tolerance of clearances, as a fraction of the tool's size.
const CLEARANCE_TOLERANCE: f64 = 1.0 / 256.0;

/// The state at one position.
pub(super) struct Sample {
    /// Index of the position among those of the tool, from 0.
    location: usize,
    /// Proved upper bound on the depth of the part's triangles.
    depth: f64,
    /// Upper bound on the distance of the surfaces that do not cut from the part; `None` if all cut, or if it is unknown.
    clearance: Option<f64>,
    /// Force of the gradient law and least niceness, if a surface that cuts touches.
    contact: Option<(f64, f64)>,
    /// Time of the query for force and torque, in nanoseconds.
    pub(super) query_ns: u64,
    /// Time of the proof of depth, in nanoseconds.
    pub(super) proof_ns: u64,
}

/// The positions of a tool.
pub(super) struct Along {
    /// The index of the tool.
    pub(super) tool: usize,
    /// Line of each position.
    lines: Vec<u32>,
    /// Each of so many positions has a sample.
    stride: usize,
    pub(super) samples: Vec<Sample>,
    /// The positions at which motions with a deep finding end, with the depth found on them.
    findings: Vec<(usize, f64)>,
}

/// Returns the points of the part from which forces are summed.
///
/// # Errors
/// If the part cannot be sampled.
pub(super) fn points(inputs: &Inputs) -> Result<Part, Failure> {
    let mesh = &inputs.bodies[0].mesh;
    Ok(Part::new(&Cloud::sample(mesh, Sampling::new(POINTS))?, mesh.diagnostics()))
}

/// Follows the tool of a pair along the program; `None` if it is a body of the machine. `count` is the number of pairs that are followed.
///
/// # Errors
/// If the tool cannot be certified.
pub(super) fn follow(
    checked: &JobReport<'_>,
    part: &Part,
    pair: &PairReport,
    count: usize,
) -> Result<Option<Along>, Failure> {
    let (Some(index), Some(tool)) = (pair.moving.tool(), checked.tool(pair)) else {
        return Ok(None);
    };
    let (unit, info) = (checked.job.unit(), tool.tool.info());
    let mut certifier = Certifier::new(checked.body(pair).bvh, tool.tool)?;
    let mut probe = Probe::new(part, tool.tool).with_law(Law::Gradient);
    let others = info.surfaces.iter().enumerate().filter(|(_, surface)| !surface.cutting);
    let others: Vec<SurfaceId> = others.map(|(id, _)| SurfaceId(id)).collect();
    let reach = info.reach();
    let size = reach.high.max(-reach.low).max(info.radius()) * info.unit.factor_to(unit);
    let tolerance = size * 1e-6;
    let samples = SAMPLES.min(MAX_SAMPLES / count).max(1);
    let stride = pair.report.moves.div_ceil(samples).max(1);
    let mut along =
        Along { tool: index, lines: Vec::new(), stride, samples: Vec::new(), findings: Vec::new() };
    let program = checked.job.program;
    let moves = program.moves(pair.reading, tool.motions, info.symmetry, None, unit)?;
    for (location, step) in moves.enumerate() {
        along.lines.push(u32::try_from(step.line).unwrap_or(u32::MAX));
        if location % stride != 0 {
            continue;
        }
        let pose = step.path.pose(1.0);
        let start = Instant::now();
        let wrench = probe.wrench(&pose);
        let query_ns = nanoseconds(start.elapsed());
        let start = Instant::now();
        let depth = certifier.deepest(&pose, tolerance).depth.high;
        let proof_ns = nanoseconds(start.elapsed());
        let clearance = certifier.clearance_of(&others, &pose, size * CLEARANCE_TOLERANCE);
        let clearance = clearance.ok().map(|clearance| clearance.distance.high);
        let touches = wrench.colliding > 0
            && probe.contacts(&pose).iter().any(|contact| info.surface(contact.surface).cutting);
        along.samples.push(Sample {
            location,
            // A bound within the tolerance does not tell contact from none.
            depth: if depth > tolerance { depth } else { 0.0 },
            clearance: clearance.filter(|distance| distance.is_finite()),
            contact: touches.then(|| (wrench.force.norm(), wrench.niceness.unwrap_or_default())),
            query_ns,
            proof_ns,
        });
    }
    along.findings = pair
        .report
        .findings
        .iter()
        .filter_map(|finding| match finding.kind {
            FindingKind::Deep { depth, .. } => Some((finding.location, depth.high)),
            _ => None,
        })
        .collect();
    Ok(Some(along))
}

/// Width and height of a chart, in pixels.
const SIZE: [u32; 2] = [980, 230];
/// Colours that colour-blind readers can tell apart (Okabe and Ito).
const BLUE: RGBColor = RGBColor(0, 114, 178);
const RED: RGBColor = RGBColor(213, 94, 0);
const GREEN: RGBColor = RGBColor(0, 128, 96);

/// A chart with its description.
pub(super) struct Chart {
    pub(super) title: String,
    pub(super) caption: String,
    pub(super) svg: String,
}

/// A series of points: `None` interrupts a line.
enum Series {
    Line(RGBColor, Vec<(f64, Option<f64>)>),
    Dots(RGBColor, Vec<(f64, f64)>),
}

impl Along {
    /// Returns a value at each sample, over its position.
    fn line(&self, value: impl Fn(&Sample) -> Option<f64>) -> Vec<(f64, Option<f64>)> {
        self.samples.iter().map(|sample| (sample.location as f64, value(sample))).collect()
    }
}

/// Returns the charts of a tool along the program. Those without any value are left out.
///
/// # Errors
/// If a chart cannot be drawn.
pub(super) fn charts(along: &Along, unit: Unit, limit: f64) -> Result<Vec<Chart>, Failure> {
    let steps = match along.stride {
        1 => "at every position".to_owned(),
        stride => format!("at one of {stride} positions"),
    };
    let mut charts = Vec::new();
    let depths = along.line(|sample| Some(sample.depth));
    let deepest: Vec<(f64, f64)> =
        along.findings.iter().map(|(location, depth)| (*location as f64, *depth)).collect();
    if !deepest.is_empty() || depths.iter().any(|(_, depth)| *depth > Some(0.0)) {
        let ends = [(0.0, Some(limit)), (along.lines.len() as f64, Some(limit))];
        let series = [
            Series::Line(BLUE, depths),
            Series::Dots(RED, deepest),
            Series::Line(GREEN, ends.into()),
        ];
        charts.push(Chart {
            title: format!("Depth of the part in the tool, {unit}"),
            caption: format!(
                "Blue: proved upper bound {steps}. Red: greatest depth found on each motion with a finding. Green: the \
                 tolerance."
            ),
            svg: draw(&along.lines, &format!("depth, {unit}"), &series)?,
        });
    }
    let clearances = along.line(|sample| sample.clearance);
    if clearances.iter().any(|(_, clearance)| clearance.is_some()) {
        charts.push(Chart {
            title: format!("Clearance of the surfaces that do not cut, {unit}"),
            caption: format!("Distance from the finished part {steps}; 0 is contact."),
            svg: draw(
                &along.lines,
                &format!("clearance, {unit}"),
                &[Series::Line(BLUE, clearances)],
            )?,
        });
    }
    if along.samples.iter().any(|sample| sample.contact.is_some()) {
        let forces = along.line(|sample| sample.contact.map(|(force, _)| force));
        let nice = along.samples.iter();
        let nice = nice.filter_map(|sample| Some((sample.location as f64, sample.contact?.1)));
        charts.push(Chart {
            title: format!("Force where a cutting surface touches, {unit}³"),
            caption: format!(
                "Length of the force of the gradient law {steps}, from {POINTS} points of the part: depth times area. Times a \
                 stiffness in N/{unit}³ it is a force in N."
            ),
            svg: draw(&along.lines, &format!("force, {unit}³"), &[Series::Line(BLUE, forces)])?,
        });
        charts.push(Chart {
            title: "Niceness where a cutting surface touches".to_owned(),
            caption: format!("The least niceness of all points in contact, {steps}; 0 to 1."),
            svg: draw(&along.lines, "niceness", &[Series::Dots(GREEN, nice.collect())])?,
        });
    }
    Ok(charts)
}

type Fault = DrawingAreaErrorKind<std::io::Error>;
type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;

/// Returns what is drawn on a white area as SVG.
fn svg(
    size: [u32; 2],
    draw: impl FnOnce(&Area<'_>) -> Result<(), Fault>,
) -> Result<String, Failure> {
    let mut svg = String::new();
    let area = SVGBackend::with_string(&mut svg, size.into()).into_drawing_area();
    let drawn = area.fill(&WHITE).and_then(|()| draw(&area)).and_then(|()| area.present());
    drawn.map_err(pixels)?;
    drop(area);
    Ok(svg)
}

/// Draws series over the positions of a program. The axis shows the lines of the positions.
fn draw(lines: &[u32], title: &str, series: &[Series]) -> Result<String, Failure> {
    let highest = series.iter().flat_map(|series| match series {
        Series::Line(_, points) => points.iter().filter_map(|point| point.1).collect::<Vec<_>>(),
        Series::Dots(_, points) => points.iter().map(|point| point.1).collect(),
    });
    let highest = highest.fold(0.0, f64::max);
    let highest = if highest > 0.0 { 1.06 * highest } else { 1.0 };
    svg(SIZE, |area| {
        let mut chart = ChartBuilder::on(area)
            .margin(10)
            .x_label_area_size(42)
            .y_label_area_size(74)
            .build_cartesian_2d(0.0..lines.len().max(2) as f64 - 1.0, 0.0..highest)?;
        chart
            .configure_mesh()
            .x_desc("line of the program (positions are evenly spaced)")
            .y_desc(title)
            .x_label_formatter(&|position: &f64| {
                let line = lines.get(position.round() as usize);
                line.map_or(String::new(), |line| format!("{line}"))
            })
            .y_label_formatter(&|value| short(*value))
            .x_labels(12)
            .y_labels(6)
            .label_style(("sans-serif", 12))
            .axis_desc_style(("sans-serif", 13))
            .light_line_style(TRANSPARENT)
            .bold_line_style(RGBColor(222, 222, 222))
            .draw()?;
        for series in series {
            match series {
                Series::Dots(colour, points) => {
                    let dots = points.iter().map(|at| Circle::new(*at, 2, colour.filled()));
                    chart.draw_series(dots)?;
                }
                Series::Line(colour, points) => {
                    for run in points.split(|point| point.1.is_none()) {
                        let run: Vec<(f64, f64)> =
                            run.iter().filter_map(|(x, y)| Some((*x, (*y)?))).collect();
                        match run.as_slice() {
                            [] => (),
                            // A line of one point would not show.
                            [at] => {
                                let dot = Circle::new(*at, 2, colour.filled());
                                chart.draw_series(std::iter::once(dot))?;
                            }
                            _ => {
                                let line = LineSeries::new(run, colour.stroke_width(1));
                                chart.draw_series(line)?;
                            }
                        }
                    }
                }
            }
        }
        Ok(())
    })
}

/// Returns a short label for a tick.
fn short(value: f64) -> String {
    let decimals = match value.abs() {
        0.0 => 0,
        magnitude if magnitude < 0.001 => return format!("{value:.1e}"),
        magnitude if magnitude < 0.1 => 3,
        magnitude if magnitude < 10.0 => 2,
        _ => 0,
    };
    format!("{value:.decimals$}")
}

/// Returns a histogram of times in nanoseconds, over bins of equal ratio.
///
/// # Errors
/// If it cannot be drawn.
pub(super) fn histogram(times: &[u64], what: &str) -> Result<String, Failure> {
    const BINS_PER_DECADE: f64 = 10.0;
    let bins: Vec<i32> = times
        .iter()
        .map(|ns| (((*ns).max(1) as f64).log10() * BINS_PER_DECADE).floor() as i32)
        .collect();
    let (low, high) = (bins.iter().copied().min(), bins.iter().copied().max());
    let (Some(low), Some(high)) = (low, high) else { return Ok(String::new()) };
    let mut counts = vec![0u32; (high - low) as usize + 1];
    bins.iter().for_each(|bin| counts[(bin - low) as usize] += 1);
    let highest = counts.iter().copied().max().unwrap_or(1);
    svg([480, 210], |area| {
        let mut chart = ChartBuilder::on(area)
            .margin(10)
            .x_label_area_size(42)
            .y_label_area_size(56)
            .build_cartesian_2d(
                f64::from(low) - 0.5..f64::from(high) + 1.5,
                0.0..1.08 * f64::from(highest),
            )?;
        chart
            .configure_mesh()
            .x_desc(format!("{what}, µs (logarithmic)"))
            .y_desc("positions")
            .x_label_formatter(&|bin| short(10f64.powf(*bin / BINS_PER_DECADE) / 1e3))
            .y_label_formatter(&|count| format!("{count:.0}"))
            .x_labels(8)
            .y_labels(5)
            .label_style(("sans-serif", 12))
            .axis_desc_style(("sans-serif", 13))
            .light_line_style(TRANSPARENT)
            .bold_line_style(RGBColor(222, 222, 222))
            .draw()?;
        chart.draw_series((low..=high).zip(&counts).map(|(bin, count)| {
            let from = f64::from(bin);
            Rectangle::new([(from, 0.0), (from + 0.92, f64::from(*count))], BLUE.filled())
        }))?;
        Ok(())
    })
}
