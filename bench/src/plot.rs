//! SVG plots of lines and points over linear or logarithmic axes, drawn by `plotters`.

use plotters::coord::Shift;
use plotters::coord::ranged1d::{AsRangedCoord, Ranged, ValueFormatter};
use plotters::prelude::*;

/// Width and height of the image, pixels.
const IMAGE_SIZE: (u32, u32) = (980, 540);
/// Width of the plot area, pixels. The legend is to its right, where it covers no point.
const PLOT_WIDTH: u32 = 770;

/// Okabe and Ito's palette, which colour-blind readers can tell apart, and some darker colours.
const COLOURS: [RGBColor; 10] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(230, 159, 0),
    RGBColor(86, 180, 233),
    RGBColor(0, 0, 0),
    RGBColor(140, 81, 10),
    RGBColor(106, 61, 154),
    RGBColor(127, 127, 127),
];

/// A plot: two axes and the series between them.
#[derive(Clone, Debug)]
pub struct Plot {
    title: String,
    axes: [Axis; 2],
    series: Vec<Series>,
}

/// An axis: its title, and whether it is logarithmic.
#[derive(Clone, Debug)]
pub struct Axis {
    title: String,
    log: bool,
}

/// A sequence of points and its drawing style.
#[derive(Clone, Debug)]
pub struct Series {
    name: String,
    points: Vec<[f64; 2]>,
    form: Form,
    colour_number: Option<usize>,
    bold: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Form {
    Line,
    Dashes,
    Points,
}

impl Axis {
    /// Returns a linear axis.
    pub fn linear(title: impl Into<String>) -> Axis {
        Axis { title: title.into(), log: false }
    }

    /// Returns a logarithmic axis.
    pub fn log(title: impl Into<String>) -> Axis {
        Axis { title: title.into(), log: true }
    }

    /// Returns whether the axis can show a value: it must be finite, and positive on a logarithmic axis.
    fn shows(&self, value: f64) -> bool {
        value.is_finite() && (!self.log || value > 0.0)
    }

    /// Returns a range that contains all values the axis can show, with a margin at both ends.
    fn span(&self, values: impl Iterator<Item = f64>) -> std::ops::Range<f64> {
        let ends = values.filter(|value| self.shows(*value)).fold(None, |ends, value| {
            let [low, high] = ends.unwrap_or([value; 2]);
            Some([value.min(low), value.max(high)])
        });
        let Some([low, high]) = ends else { return if self.log { 1.0..10.0 } else { 0.0..1.0 } };
        if self.log {
            return low / 1.3..high * 1.3;
        }
        let margin = if high > low { 0.04 * (high - low) } else { 0.5 * low.abs().max(1.0) };
        low - margin..high + margin
    }
}

impl Series {
    /// Returns a polyline with a marker at each point. A series without a name is not in the legend.
    pub fn line(name: impl Into<String>, points: Vec<[f64; 2]>) -> Series {
        Series { name: name.into(), points, form: Form::Line, colour_number: None, bold: false }
    }

    /// Returns a dashed line without markers.
    pub fn dashes(name: impl Into<String>, points: Vec<[f64; 2]>) -> Series {
        Series { form: Form::Dashes, ..Series::line(name, points) }
    }

    /// Returns separate points.
    pub fn points(name: impl Into<String>, points: Vec<[f64; 2]>) -> Series {
        Series { form: Form::Points, ..Series::line(name, points) }
    }

    /// Returns the series with this colour number instead of the colour of its index in the plot. A method can
    /// thus have the same colour in every plot.
    #[must_use]
    pub fn with_colour(self, colour_number: usize) -> Series {
        Series { colour_number: Some(colour_number), ..self }
    }

    /// Returns the series with a thicker line and larger markers.
    #[must_use]
    pub fn bold(self) -> Series {
        Series { bold: true, ..self }
    }
}

impl Plot {
    /// Returns an empty plot with a horizontal and a vertical axis.
    pub fn new(title: impl Into<String>, x: Axis, y: Axis) -> Plot {
        Plot { title: title.into(), axes: [x, y], series: Vec::new() }
    }

    /// Returns the plot with one more series, drawn over the existing ones.
    #[must_use]
    pub fn with_series(mut self, series: Series) -> Plot {
        self.series.push(series);
        self
    }

    /// Returns whether no series has a point.
    pub fn is_empty(&self) -> bool {
        self.series.iter().all(|series| series.points.is_empty())
    }

    /// Returns the plot as an SVG file; equal input gives equal bytes. Points that the axes cannot show, such as 0 on a
    /// logarithmic axis, are left out.
    ///
    /// # Panics
    /// Never: writing to a string in memory cannot fail.
    pub fn svg(&self) -> String {
        let mut svg = String::new();
        let area = SVGBackend::with_string(&mut svg, IMAGE_SIZE).into_drawing_area();
        let [x, y] = [0, 1].map(|axis| {
            let points = self.series.iter().flat_map(|series| &series.points);
            self.axes[axis].span(points.map(|point| point[axis]))
        });
        let result = match [self.axes[0].log, self.axes[1].log] {
            [true, true] => self.draw(&area, x.log_scale(), y.log_scale()),
            [true, false] => self.draw(&area, x.log_scale(), y),
            [false, true] => self.draw(&area, x, y.log_scale()),
            [false, false] => self.draw(&area, x, y),
        };
        result.expect("a text in memory");
        drop(area);
        svg
    }

    fn draw<'a, X, Y>(
        &self,
        area: &DrawingArea<SVGBackend<'a>, Shift>,
        x: X,
        y: Y,
    ) -> Result<(), DrawingAreaErrorKind<std::io::Error>>
    where
        X: AsRangedCoord<Value = f64>,
        Y: AsRangedCoord<Value = f64>,
        X::CoordDescType: Ranged<ValueType = f64> + ValueFormatter<f64>,
        Y::CoordDescType: Ranged<ValueType = f64> + ValueFormatter<f64>,
    {
        area.fill(&WHITE)?;
        let (plot, legend) = area.split_horizontally(PLOT_WIDTH);
        let mut chart = ChartBuilder::on(&plot)
            .caption(&self.title, ("sans-serif", 17))
            .margin(14)
            .x_label_area_size(42)
            .y_label_area_size(70)
            .build_cartesian_2d(x, y)?;
        chart
            .configure_mesh()
            .x_desc(&self.axes[0].title)
            .y_desc(&self.axes[1].title)
            .x_label_formatter(&|value| label(*value))
            .y_label_formatter(&|value| label(*value))
            .label_style(("sans-serif", 12))
            .axis_desc_style(("sans-serif", 13))
            .light_line_style(RGBColor(240, 240, 240))
            .bold_line_style(RGBColor(215, 215, 215))
            .draw()?;
        for (number, series) in self.series.iter().enumerate() {
            let colour = self.colour(number);
            let style = colour.stroke_width(if series.bold { 3 } else { 1 });
            let size = if series.bold { 4 } else { 3 };
            let can_show =
                |p: &&[f64; 2]| self.axes.iter().zip(*p).all(|(axis, value)| axis.shows(*value));
            let points: Vec<(f64, f64)> =
                series.points.iter().filter(can_show).map(|[x, y]| (*x, *y)).collect();
            let filled = series.form != Form::Points;
            let marker = colour.mix(if filled { 1.0 } else { 0.7 }).filled();
            match series.form {
                Form::Line => {
                    chart.draw_series(LineSeries::new(points.iter().copied(), style))?;
                }
                Form::Dashes => {
                    chart.draw_series(DashedLineSeries::new(
                        points.iter().copied(),
                        5,
                        4,
                        style,
                    ))?;
                }
                Form::Points => {
                    let marks = points.iter().map(|p| TriangleMarker::new(*p, size + 1, marker));
                    chart.draw_series(marks)?;
                }
            }
            if series.form == Form::Line {
                chart.draw_series(points.iter().map(|p| Circle::new(*p, size, marker)))?;
            }
        }
        self.legend(&legend)?;
        area.present()
    }

    /// Returns the colour of the series with this index.
    fn colour(&self, number: usize) -> RGBColor {
        COLOURS[self.series[number].colour_number.unwrap_or(number) % COLOURS.len()]
    }

    /// Draws the legend: the name of each named series beside its mark.
    fn legend(
        &self,
        area: &DrawingArea<SVGBackend<'_>, Shift>,
    ) -> Result<(), DrawingAreaErrorKind<std::io::Error>> {
        let named = self.series.iter().enumerate().filter(|(_, series)| !series.name.is_empty());
        for (row, (number, series)) in (0..).zip(named) {
            let colour = self.colour(number);
            let y = 56 + 19 * row;
            let dashes: &[[i32; 2]] = match series.form {
                Form::Line => &[[0, 20]],
                Form::Dashes => &[[0, 5], [8, 13], [16, 20]],
                Form::Points => &[],
            };
            for [from, to] in dashes {
                let width = if series.bold { 3 } else { 2 };
                area.draw(&PathElement::new([(*from, y), (*to, y)], colour.stroke_width(width)))?;
            }
            match series.form {
                Form::Line => area.draw(&Circle::new((10, y), 3, colour.filled()))?,
                Form::Dashes => {}
                Form::Points => area.draw(&TriangleMarker::new((10, y), 5, colour.filled()))?,
            }
            area.draw_text(&series.name, &("sans-serif", 12).into_text_style(area), (28, y - 6))?;
        }
        Ok(())
    }
}

/// Returns a short tick label for a number.
fn label(value: f64) -> String {
    match value.abs() {
        0.0 => "0".to_owned(),
        size if (0.001..100_000.0).contains(&size) => format!("{}", (value * 1e6).round() / 1e6),
        _ => format!("{value:.0e}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn svg_is_reproducible_and_leaves_out_points_outside_the_axes() {
        let points = vec![[1.0, 1.0], [2.0, 0.0], [0.0, 1.0], [3.0, f64::NAN], [4.0, 2.0]];
        for (x, y, circles) in [
            (Axis::log("x"), Axis::log("y"), 2),
            (Axis::log("x"), Axis::linear("y"), 3),
            (Axis::linear("x"), Axis::log("y"), 3),
            (Axis::linear("x"), Axis::linear("y"), 4),
        ] {
            let plot = Plot::new("a < b", x, y)
                .with_series(Series::line("line", points.clone()))
                .with_series(Series::dashes("", vec![[1.0, 1.0], [4.0, 1.0]]));
            let svg = plot.svg();
            assert_eq!(svg, plot.svg());
            // The legend has one more circle.
            assert_eq!(svg.matches("<circle").count(), circles + 1);
            assert!(svg.contains("a &lt; b") && svg.ends_with("</svg>\n") && !svg.contains("NaN"));
        }
    }

    #[test]
    fn draws_empty_plots_and_single_points() {
        for axis in [Axis::log, Axis::linear] {
            for points in [vec![], vec![[5.0, 5.0]]] {
                let plot =
                    Plot::new("", axis("x"), axis("y")).with_series(Series::points("p", points));
                assert!(plot.svg().ends_with("</svg>\n"));
            }
        }
    }
}
