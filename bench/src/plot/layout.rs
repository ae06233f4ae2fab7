//! Where things are on the sheet.

use super::Plot;
use super::axis::{Span, Tick};
use super::series::{Form, Mark, Series};
use super::svg::{LETTER, Look, Sheet, Side, width};

/// The sheet, pixels.
const SIZE: [f64; 2] = [840.0, 470.0];
/// Above and below the frame: the title, and labels and a title of the axis.
const TOP: f64 = 54.0;
const BOTTOM: f64 = 62.0;
/// Between the sheet's edge and what is nearest to it.
const EDGE: f64 = 16.0;
/// A legend's sample of a line, and the height of its rows.
const SAMPLE: f64 = 26.0;
const ROW: f64 = 20.0;

const INK: &str = "#333";
const RULE: &str = "#ddd";
const FAINT: &str = "#f2f2f2";
const NOTE: &str = "#666";

/// The rectangle between the axes.
struct Frame {
    /// Left, right; bottom, top.
    ends: [[f64; 2]; 2],
    spans: [Span; 2],
}

impl Frame {
    /// Where a value of an axis is along it.
    fn along(&self, axis: usize, value: f64) -> f64 {
        let [from, to] = self.ends[axis];
        from + (to - from) * self.spans[axis].share(value)
    }

    fn place(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        [self.along(0, x), self.along(1, y)]
    }

    /// The ends of a line across the frame at a value of an axis.
    fn across(&self, axis: usize, value: f64) -> [[f64; 2]; 2] {
        let at = self.along(axis, value);
        match axis {
            0 => self.ends[1].map(|y| [at, y]),
            _ => self.ends[0].map(|x| [x, at]),
        }
    }
}

/// A series with what of it is shown.
struct Shown<'a> {
    series: &'a Series,
    points: Vec<[f64; 2]>,
    look: Look,
}

pub(super) fn draw(plot: &Plot) -> String {
    let shown: Vec<Shown<'_>> = plot.series.iter().enumerate().map(|at| show(plot, at)).collect();
    let marks: Vec<&Mark> =
        plot.marks.iter().filter(|mark| plot.axes[mark.axis].shows(mark.value)).collect();
    let frame = frame(plot, &shown, &marks);
    let mut sheet = Sheet::new(SIZE, &plot.title);
    grid(&mut sheet, plot, &frame);
    for mark in marks {
        refer(&mut sheet, &frame, mark);
    }
    for one in &shown {
        series(&mut sheet, &frame, one);
    }
    legend(&mut sheet, &frame, &shown);
    note(&mut sheet, plot.left_out());
    sheet.finish()
}

fn show<'a>(plot: &'a Plot, (place, series): (usize, &'a Series)) -> Shown<'a> {
    let number = series.look.unwrap_or(place);
    let look = Look { number, form: series.form, bold: series.bold };
    Shown { series, points: series.shown(&plot.axes), look }
}

fn frame(plot: &Plot, shown: &[Shown<'_>], marks: &[&Mark]) -> Frame {
    let spans = [0, 1].map(|axis| {
        let points = shown.iter().flat_map(|one| &one.points).map(|point| point[axis]);
        let marks = marks.iter().filter(|mark| mark.axis == axis).map(|mark| mark.value);
        plot.axes[axis].span(points.chain(marks).collect::<Vec<_>>())
    });
    let widest = |texts: &mut dyn Iterator<Item = &str>| texts.map(width).fold(0.0, f64::max);
    let ticks = spans[1].ticks();
    let labels = widest(&mut ticks.iter().filter_map(|tick| tick.label.as_deref()));
    let names = widest(&mut shown.iter().map(|one| one.series.name.as_str()));
    let legend = if names > 0.0 { SAMPLE + names + 2.0 * EDGE } else { EDGE };
    let left = EDGE + 2.0 * LETTER + labels;
    Frame { ends: [[left, SIZE[0] - EDGE - legend], [SIZE[1] - BOTTOM, TOP]], spans }
}

fn grid(sheet: &mut Sheet, plot: &Plot, frame: &Frame) {
    let [[left, right], [bottom, top]] = frame.ends;
    let ticks = [0, 1].map(|axis| frame.spans[axis].ticks());
    // Faint lines first, so that they do not cross the others.
    for labelled in [false, true] {
        for (axis, ticks) in ticks.iter().enumerate() {
            for tick in ticks.iter().filter(|tick| tick.label.is_some() == labelled) {
                let [from, to] = frame.across(axis, tick.value);
                sheet.rule(from, to, if labelled { RULE } else { FAINT }, false);
                label(sheet, frame, axis, tick);
            }
        }
    }
    sheet.rule([left, bottom], [right, bottom], INK, false);
    sheet.rule([left, bottom], [left, top], INK, false);
    sheet.title([EDGE, TOP - 26.0], INK, &plot.title);
    let middle = [(left + right) / 2.0, bottom + 40.0];
    sheet.text(middle, Side::Middle, INK, &plot.axes[0].title);
    sheet.upward([EDGE + 6.0, (bottom + top) / 2.0], INK, &plot.axes[1].title);
}

fn label(sheet: &mut Sheet, frame: &Frame, axis: usize, tick: &Tick) {
    let Some(label) = &tick.label else { return };
    let [[x, y], _] = frame.across(axis, tick.value);
    match axis {
        0 => sheet.text([x, y + 18.0], Side::Middle, INK, label),
        _ => sheet.text([x - 7.0, y + 4.0], Side::Left, INK, label),
    }
}

/// A line of reference; its word stands above its left end, where what grows is still below, or
/// beside its upper one.
fn refer(sheet: &mut Sheet, frame: &Frame, mark: &Mark) {
    let [from, to] = frame.across(mark.axis, mark.value);
    sheet.rule(from, to, NOTE, true);
    match mark.axis {
        0 => sheet.text([to[0] + 5.0, to[1] + LETTER], Side::Right, NOTE, &mark.name),
        _ => sheet.text([from[0] + 5.0, from[1] - 5.0], Side::Right, NOTE, &mark.name),
    }
}

fn series(sheet: &mut Sheet, frame: &Frame, shown: &Shown<'_>) {
    let places = || shown.points.iter().map(|point| frame.place(*point)).collect::<Vec<_>>();
    match shown.series.form {
        Form::Line | Form::Dashes => sheet.line(&places(), shown.look),
        Form::Steps => sheet.line(&steps(&places()), shown.look),
        Form::Bars => bars(sheet, frame, shown),
        Form::Points => {}
    }
    if shown.series.form.has_markers() {
        places().into_iter().for_each(|place| sheet.marker(place, shown.look));
    }
}

/// Each place, and below or above the next one at its height.
fn steps(places: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let corners = places.windows(2).flat_map(|pair| [pair[0], [pair[1][0], pair[0][1]]]);
    corners.chain(places.last().copied()).collect()
}

fn bars(sheet: &mut Sheet, frame: &Frame, shown: &Shown<'_>) {
    let span = &frame.spans[1];
    // Where the axis has no 0 bars stand on its end.
    let foot = 0f64.clamp(span.low, span.high);
    for pair in shown.points.windows(2).filter(|pair| pair[0][1] != 0.0) {
        let [[from, height], [to, _]] = [pair[0], pair[1]];
        let corners = [[from, foot.min(height)], [to, foot.max(height)]];
        sheet.rectangle(corners.map(|corner| frame.place(corner)), shown.look);
    }
}

fn legend(sheet: &mut Sheet, frame: &Frame, shown: &[Shown<'_>]) {
    let x = frame.ends[0][1] + EDGE;
    let named = shown.iter().filter(|one| !one.series.name.is_empty());
    for (row, one) in named.enumerate() {
        let y = TOP + ROW * row as f64 + 8.0;
        let [from, middle, to] = [[x, y], [x + SAMPLE / 2.0, y], [x + SAMPLE, y]];
        match one.series.form {
            Form::Bars => sheet.rectangle([[x, y + 5.0], [x + SAMPLE, y - 5.0]], one.look),
            Form::Points => {}
            _ => sheet.line(&[from, to], one.look),
        }
        if one.series.form.has_markers() {
            sheet.marker(middle, one.look);
        }
        sheet.text([x + SAMPLE + 8.0, y + 4.0], Side::Right, INK, &one.series.name);
    }
}

fn note(sheet: &mut Sheet, left_out: usize) {
    let text = match left_out {
        0 => return,
        1 => "1 point cannot be shown on these axes".to_owned(),
        some => format!("{some} points cannot be shown on these axes"),
    };
    sheet.text([SIZE[0] - EDGE, SIZE[1] - 10.0], Side::Left, NOTE, &text);
}
