//! Charts, drawn by `plotters`.

use super::along::{Along, POINTS, Sample};
use crate::failure::Failure;
use plotters::prelude::*;
use touchoff::Unit;

/// Width and height of a chart, in pixels.
const SIZE: (u32, u32) = (980, 230);
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

/// Returns the charts of a tool along the program. Those without any value are left out.
///
/// # Errors
/// If a chart cannot be drawn.
pub(super) fn along(along: &Along, unit: Unit, limit: f64) -> Result<Vec<Chart>, Failure> {
    let at = |sample: &Sample, value: Option<f64>| (sample.location as f64, value);
    let line = |value: &dyn Fn(&Sample) -> Option<f64>| -> Vec<(f64, Option<f64>)> {
        along.samples.iter().map(|sample| at(sample, value(sample))).collect()
    };
    let steps = match along.stride {
        1 => "at every position".to_owned(),
        stride => format!("at one of {stride} positions"),
    };
    let mut charts = Vec::new();
    let depths = line(&|sample| Some(sample.depth));
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
    let clearances = line(&|sample| sample.clearance);
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
        let forces = line(&|sample| sample.contact.map(|(force, _)| force));
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

/// Draws series over the positions of a program. The axis shows the lines of the positions.
fn draw(lines: &[u32], title: &str, series: &[Series]) -> Result<String, Failure> {
    let mut svg = String::new();
    let area = SVGBackend::with_string(&mut svg, SIZE).into_drawing_area();
    let highest = series.iter().flat_map(|series| match series {
        Series::Line(_, points) => points.iter().filter_map(|point| point.1).collect::<Vec<_>>(),
        Series::Dots(_, points) => points.iter().map(|point| point.1).collect(),
    });
    let highest = highest.fold(0.0, f64::max);
    let highest = if highest > 0.0 { 1.06 * highest } else { 1.0 };
    let drawn = || -> Result<(), Fault> {
        area.fill(&WHITE)?;
        let mut chart = ChartBuilder::on(&area)
            .margin(10)
            .x_label_area_size(42)
            .y_label_area_size(74)
            .build_cartesian_2d(0.0..lines.len().max(2) as f64 - 1.0, 0.0..highest)?;
        let line_at = |position: &f64| {
            let line = lines.get(position.round() as usize);
            line.map_or(String::new(), |line| format!("{line}"))
        };
        chart
            .configure_mesh()
            .x_desc("line of the program (positions are evenly spaced)")
            .y_desc(title)
            .x_label_formatter(&line_at)
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
        area.present()
    };
    drawn().map_err(|error| Failure::Pixels(error.to_string()))?;
    drop(area);
    Ok(svg)
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
    let bin = |ns: u64| ((ns.max(1) as f64).log10() * BINS_PER_DECADE).floor() as i32;
    let bins: Vec<i32> = times.iter().map(|ns| bin(*ns)).collect();
    let (low, high) = (bins.iter().copied().min(), bins.iter().copied().max());
    let (Some(low), Some(high)) = (low, high) else { return Ok(String::new()) };
    let count = |wanted: i32| bins.iter().filter(|bin| **bin == wanted).count();
    let highest = (low..=high).map(count).max().unwrap_or(1);
    let micros = |bin: f64| 10f64.powf(bin / BINS_PER_DECADE) / 1e3;
    let mut svg = String::new();
    let area = SVGBackend::with_string(&mut svg, (480, 210)).into_drawing_area();
    let drawn = || -> Result<(), Fault> {
        area.fill(&WHITE)?;
        let mut chart = ChartBuilder::on(&area)
            .margin(10)
            .x_label_area_size(42)
            .y_label_area_size(56)
            .build_cartesian_2d(
                f64::from(low) - 0.5..f64::from(high) + 1.5,
                0.0..1.08 * highest as f64,
            )?;
        chart
            .configure_mesh()
            .x_desc(format!("{what}, µs (logarithmic)"))
            .y_desc("positions")
            .x_label_formatter(&|bin| short(micros(*bin)))
            .y_label_formatter(&|count| format!("{count:.0}"))
            .x_labels(8)
            .y_labels(5)
            .label_style(("sans-serif", 12))
            .axis_desc_style(("sans-serif", 13))
            .light_line_style(TRANSPARENT)
            .bold_line_style(RGBColor(222, 222, 222))
            .draw()?;
        chart.draw_series((low..=high).map(|bin| {
            let from = f64::from(bin);
            Rectangle::new([(from, 0.0), (from + 0.92, count(bin) as f64)], BLUE.filled())
        }))?;
        area.present()
    };
    drawn().map_err(|error| Failure::Pixels(error.to_string()))?;
    drop(area);
    Ok(svg)
}
