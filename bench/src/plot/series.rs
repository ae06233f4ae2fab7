//! What is drawn between the axes.

use super::axis::Axis;
use super::front::front;

/// Points that belong together, and how they are drawn.
#[derive(Clone, Debug)]
pub struct Series {
    pub(super) name: String,
    pub(super) points: Vec<[f64; 2]>,
    pub(super) form: Form,
    pub(super) look: Option<usize>,
    pub(super) bold: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Form {
    Line,
    Dashes,
    Points,
    Steps,
    Bars,
}

impl Form {
    /// Whether each point is drawn as one.
    pub(super) fn has_markers(self) -> bool {
        matches!(self, Form::Line | Form::Points)
    }
}

impl Series {
    /// Points, each joined to the next. Series without a name are not in the legend.
    pub fn line(name: impl Into<String>, points: Vec<[f64; 2]>) -> Series {
        Series::new(name.into(), points, Form::Line)
    }

    /// A dashed line: what is expected or fitted beside what was measured.
    pub fn dashes(name: impl Into<String>, points: Vec<[f64; 2]>) -> Series {
        Series::new(name.into(), points, Form::Dashes)
    }

    /// Points alone.
    pub fn points(name: impl Into<String>, points: Vec<[f64; 2]>) -> Series {
        Series::new(name.into(), points, Form::Points)
    }

    /// The [front] of some points as steps, up to the worst of them: what lies beyond is beaten.
    pub fn front(name: impl Into<String>, points: &[[f64; 2]]) -> Series {
        let worst = |axis: usize| points.iter().map(|p| p[axis]).fold(f64::NEG_INFINITY, f64::max);
        let mut corners = front(points);
        if let [Some(first), Some(last)] = [corners.first().copied(), corners.last().copied()] {
            corners.insert(0, [first[0], worst(1)]);
            corners.push([worst(0), last[1]]);
        }
        Series::new(name.into(), corners, Form::Steps)
    }

    /// A histogram: bars from each point to the next, as high as the first of the two. The last
    /// point is only where the last bar ends. A height of 0 is no bar, on every axis.
    pub fn bars(name: impl Into<String>, points: Vec<[f64; 2]>) -> Series {
        Series::new(name.into(), points, Form::Bars)
    }

    /// With the colour and the marker of that number, instead of those of its place in the plot: the
    /// same thing looks the same in every plot.
    #[must_use]
    pub fn look(mut self, look: usize) -> Series {
        self.look = Some(look);
        self
    }

    /// With a thicker line and larger markers.
    #[must_use]
    pub fn bold(mut self) -> Series {
        self.bold = true;
        self
    }

    fn new(name: String, points: Vec<[f64; 2]>, form: Form) -> Series {
        Series { name, points, form, look: None, bold: false }
    }

    /// Those of its points that have a place on both axes. Bars without a height need none upward:
    /// they are where the bar before them ends.
    pub(super) fn shown(&self, [x, y]: &[Axis; 2]) -> Vec<[f64; 2]> {
        let no_bar = |point: &[f64; 2]| self.form == Form::Bars && point[1] == 0.0;
        let has_place =
            |point: &[f64; 2]| x.shows(point[0]) && (y.shows(point[1]) || no_bar(point));
        self.points.iter().copied().filter(has_place).collect()
    }

    pub(super) fn left_out(&self, axes: &[Axis; 2]) -> usize {
        self.points.len() - self.shown(axes).len()
    }
}

/// A line of reference from end to end of the plot, with a word at it.
#[derive(Clone, Debug)]
pub struct Mark {
    /// Of which axis `value` is: 0 for x, 1 for y.
    pub(super) axis: usize,
    pub(super) value: f64,
    pub(super) name: String,
}

impl Mark {
    /// At a height.
    pub fn across(y: f64, name: impl Into<String>) -> Mark {
        Mark { axis: 1, value: y, name: name.into() }
    }

    /// At a place along the x axis.
    pub fn upright(x: f64, name: impl Into<String>) -> Mark {
        Mark { axis: 0, value: x, name: name.into() }
    }
}
