//! Plots as plain SVG: lines, points, steps and bars over linear or logarithmic axes.
//!
//! [`Plot::svg`] writes the same bytes for the same numbers, so that a plot that is kept beside the
//! page it belongs to changes only with what was measured. The ground is white, since a page may be
//! dark. What an axis cannot show (0 on a logarithmic one) is left out and counted, never moved.
//!
//! `axis` knows where ticks are, `series` what is drawn, `layout` where on the sheet, `svg` how.

mod axis;
mod fit;
mod front;
mod layout;
mod series;
mod svg;

pub use axis::Axis;
pub use fit::{Fit, fit};
pub use front::front;
pub use series::{Mark, Series};

/// A plot: two axes and what is drawn between them.
#[derive(Clone, Debug)]
pub struct Plot {
    title: String,
    axes: [Axis; 2],
    series: Vec<Series>,
    marks: Vec<Mark>,
}

impl Plot {
    /// An empty plot over its axes, the one to the right and the one upward.
    pub fn new(title: impl Into<String>, x: Axis, y: Axis) -> Plot {
        Plot { title: title.into(), axes: [x, y], series: Vec::new(), marks: Vec::new() }
    }

    /// With one more series, over those that are there.
    #[must_use]
    pub fn with(mut self, series: Series) -> Plot {
        self.series.push(series);
        self
    }

    /// With one more line of reference, below all series.
    #[must_use]
    pub fn mark(mut self, mark: Mark) -> Plot {
        self.marks.push(mark);
        self
    }

    /// Whether there is no point in it.
    pub fn is_empty(&self) -> bool {
        self.series.iter().all(|series| series.points.is_empty())
    }

    /// How many points the axes cannot show: those that are not finite, and on a logarithmic axis
    /// those that are not above 0.
    pub fn left_out(&self) -> usize {
        self.series.iter().map(|series| series.left_out(&self.axes)).sum()
    }

    /// The plot as an SVG file.
    pub fn svg(&self) -> String {
        layout::draw(self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn log_log() -> Plot {
        Plot::new("time", Axis::log("points"), Axis::log("time, µs"))
    }

    #[test]
    fn a_plot_is_the_same_bytes_each_time() {
        let plot = log_log()
            .with(Series::line("a", vec![[1e3, 0.2], [1e6, 9.0]]))
            .with(Series::points("b", vec![[2e3, 3e-16]]))
            .with(Series::dashes("c", vec![[1e3, 1.0], [1e6, 1.0]]))
            .with(Series::front("d", &[[1e3, 5.0], [1e5, 1.0], [1e5, 9.0]]))
            .with(Series::bars("e", vec![[1e3, 5.0], [1e5, 1.0], [1e6, 0.0]]))
            .mark(Mark::across(1e3, "1 ms"))
            .mark(Mark::upright(2e4, "20,000"));
        assert_eq!(plot.svg(), plot.svg());
        for never in ["NaN", "inf", "-0.0\""] {
            assert!(!plot.svg().contains(never), "{never}");
        }
    }

    #[test]
    fn what_an_axis_cannot_show_is_left_out_and_counted() {
        let points = vec![[1.0, 1.0], [2.0, 0.0], [0.0, 1.0], [3.0, f64::NAN], [4.0, -1.0]];
        let plot = log_log().with(Series::points("a", points.clone()));
        assert_eq!(plot.left_out(), 4);
        assert!(plot.svg().contains("4 points cannot be shown on these axes"));
        assert_eq!(plot.svg().matches("<circle").count(), 2, "one point, one in the legend");

        let linear = Plot::new("", Axis::linear(""), Axis::linear(""));
        assert_eq!(linear.with(Series::points("a", points)).left_out(), 1);
    }

    #[test]
    fn nothing_and_one_point_are_plots_too() {
        for plot in [log_log(), Plot::new("", Axis::linear(""), Axis::linear(""))] {
            for points in [vec![], vec![[0.0, 0.0]], vec![[5.0, 5.0]]] {
                for series in [Series::line, Series::dashes, Series::bars, Series::points] {
                    let svg = plot.clone().with(series("a".to_owned(), points.clone())).svg();
                    assert!(svg.ends_with("</svg>\n") && !svg.contains("NaN"), "{svg}");
                }
            }
        }
    }

    #[test]
    fn a_bar_without_height_is_no_bar_and_does_not_make_the_one_before_it_wider() {
        let counts = vec![[0.0, 3.0], [10.0, 0.0], [20.0, 5.0], [30.0, 0.0]];
        let widths = |y: Axis| -> Vec<String> {
            let plot = Plot::new("", Axis::linear(""), y).with(Series::bars("", counts.clone()));
            assert_eq!(plot.left_out(), 0);
            let svg = plot.svg();
            let bars = svg.lines().filter(|line| line.contains("fill-opacity"));
            let width =
                |bar: &str| bar.split("width=\"").nth(1)?.split('"').next().map(str::to_owned);
            bars.filter_map(width).collect()
        };
        let [linear, log] = [widths(Axis::linear("")), widths(Axis::log(""))];
        assert!(linear.len() == 2 && linear[0] == linear[1], "{linear:?}");
        assert!(log.len() == 2 && log[0] == log[1], "{log:?}");
    }

    #[test]
    fn text_is_escaped() {
        let plot = Plot::new("a < b & \"c\"", Axis::linear("x > 0"), Axis::linear("y\u{1}"))
            .with(Series::line("<script>", vec![[0.0, 1.0]]));
        let svg = plot.svg();
        for text in ["a &lt; b &amp; &quot;c&quot;", "x &gt; 0", "y\u{fffd}", "&lt;script&gt;"] {
            assert!(svg.contains(text), "{text}: {svg}");
        }
        assert!(!svg.contains("<script>"));
    }
}
