//! What is drawn between the axes.

use super::axis::Axis;

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

    /// Each point's height as far as the next point: a [front](super::front) that nothing beats.
    pub fn steps(name: impl Into<String>, points: Vec<[f64; 2]>) -> Series {
        Series::new(name.into(), points, Form::Steps)
    }

    /// A histogram: bars from each point to the next, as high as the first of the two. The last
    /// point is only where the last bar ends.
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

    /// Those of its points that have a place on both axes.
    pub(super) fn shown(&self, axes: &[Axis; 2]) -> Vec<[f64; 2]> {
        let all = self.points.iter().copied();
        all.filter(|point| axes.iter().zip(point).all(|(axis, value)| axis.shows(*value))).collect()
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
