//! SVG as text, with one decimal: a tenth of a pixel.

use super::series::Form;

/// Size of letters, pixels; titles are a little larger.
pub(super) const LETTER: f64 = 12.0;
/// What a letter is wide on average, in its size.
const WIDE: f64 = 0.56;

/// Okabe and Ito's colours, which those who see fewer colours tell apart too, and darker ones.
const COLOURS: [&str; 10] = [
    "#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000", "#8c510a",
    "#6a3d9a", "#7f7f7f",
];

/// How a series is told from others.
#[derive(Clone, Copy)]
pub(super) struct Look {
    pub(super) number: usize,
    pub(super) form: Form,
    pub(super) bold: bool,
}

impl Look {
    pub(super) fn colour(self) -> &'static str {
        COLOURS[self.number % COLOURS.len()]
    }

    fn stroke(self) -> String {
        let wide = if self.bold { 2.8 } else { 1.6 };
        let dashes = match self.form {
            Form::Dashes => " stroke-dasharray=\"6 4\"",
            Form::Steps => " stroke-dasharray=\"2 3\"",
            _ => "",
        };
        let colour = self.colour();
        format!("fill=\"none\" stroke=\"{colour}\" stroke-width=\"{wide}\"{dashes}")
    }
}

/// A file that is being written.
pub(super) struct Sheet(String);

/// Where text stands from its place.
#[derive(Clone, Copy)]
pub(super) enum Side {
    Right,
    Middle,
    Left,
}

impl Sheet {
    /// A white sheet, with a title for those who do not see it.
    pub(super) fn new([wide, tall]: [f64; 2], title: &str) -> Sheet {
        Sheet(format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {wide:.0} {tall:.0}\" \
             width=\"{wide:.0}\" height=\"{tall:.0}\" role=\"img\" \
             font-family=\"Helvetica, Arial, 'DejaVu Sans', sans-serif\" font-size=\"{LETTER}\">\n\
             <title>{}</title>\n\
             <rect width=\"{wide:.0}\" height=\"{tall:.0}\" fill=\"#fff\"/>\n",
            escape(title)
        ))
    }

    pub(super) fn finish(mut self) -> String {
        self.0 += "</svg>\n";
        self.0
    }

    /// A thin straight line; dashed for what is not measured.
    pub(super) fn rule(&mut self, from: [f64; 2], to: [f64; 2], colour: &str, dashed: bool) {
        let dashes = if dashed { " stroke-dasharray=\"6 4\"" } else { "" };
        self.0 += &format!("<path d=\"{}\" stroke=\"{colour}\"{dashes}/>\n", path(&[from, to]));
    }

    pub(super) fn line(&mut self, points: &[[f64; 2]], look: Look) {
        if points.len() > 1 {
            self.0 += &format!("<path d=\"{}\" {}/>\n", path(points), look.stroke());
        }
    }

    pub(super) fn rectangle(&mut self, [low, high]: [[f64; 2]; 2], look: Look) {
        self.0 += &format!(
            "<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" fill=\"{}\" fill-opacity=\"0.6\"/>\n",
            number(low[0]),
            number(high[1]),
            number(high[0] - low[0]),
            number(low[1] - high[1]),
            look.colour()
        );
    }

    /// A point, with a white edge so that those behind it are seen.
    pub(super) fn marker(&mut self, [x, y]: [f64; 2], look: Look) {
        let r = if look.bold { 5.0 } else { 4.0 };
        let paint = format!("fill=\"{}\" stroke=\"#fff\"", look.colour());
        let closed = |corners: &[[f64; 2]]| {
            let corners: Vec<_> = corners.iter().map(|[a, b]| [x + a * r, y + b * r]).collect();
            format!("<path d=\"{}Z\" {paint}/>\n", path(&corners))
        };
        self.0 += &match (look.number + look.number / COLOURS.len()) % 5 {
            0 => format!("<circle cx=\"{}\" cy=\"{}\" r=\"{r}\" {paint}/>\n", number(x), number(y)),
            1 => closed(&[[-0.9, -0.9], [0.9, -0.9], [0.9, 0.9], [-0.9, 0.9]]),
            2 => closed(&[[-1.1, 0.9], [0.0, -1.1], [1.1, 0.9]]),
            3 => closed(&[[-1.2, 0.0], [0.0, -1.2], [1.2, 0.0], [0.0, 1.2]]),
            _ => closed(&[[-1.1, -0.9], [1.1, -0.9], [0.0, 1.1]]),
        };
    }

    pub(super) fn text(&mut self, [x, y]: [f64; 2], side: Side, colour: &str, text: &str) {
        let at = format!("x=\"{}\" y=\"{}\" {}", number(x), number(y), anchor(side));
        self.0 += &format!("<text {at} fill=\"{colour}\">{}</text>\n", escape(text));
    }

    /// Text that runs upward.
    pub(super) fn upward(&mut self, [x, y]: [f64; 2], colour: &str, text: &str) {
        let [x, y] = [x, y].map(number);
        let turn = format!("transform=\"translate({x} {y}) rotate(-90)\" {}", anchor(Side::Middle));
        self.0 += &format!("<text {turn} fill=\"{colour}\">{}</text>\n", escape(text));
    }

    pub(super) fn title(&mut self, [x, y]: [f64; 2], colour: &str, text: &str) {
        let at = format!("x=\"{}\" y=\"{}\" fill=\"{colour}\"", number(x), number(y));
        let letters = "font-size=\"15\" font-weight=\"bold\"";
        self.0 += &format!("<text {at} {letters}>{}</text>\n", escape(text));
    }
}

/// About how wide a text is.
pub(super) fn width(text: &str) -> f64 {
    text.chars().count() as f64 * LETTER * WIDE
}

fn anchor(side: Side) -> &'static str {
    match side {
        Side::Right => "text-anchor=\"start\"",
        Side::Middle => "text-anchor=\"middle\"",
        Side::Left => "text-anchor=\"end\"",
    }
}

fn path(points: &[[f64; 2]]) -> String {
    let corners = points.iter().map(|[x, y]| format!("{} {}", number(*x), number(*y)));
    format!("M{}", corners.collect::<Vec<_>>().join("L"))
}

/// With one decimal; adding 0 makes a 0 of what rounds to -0.
fn number(value: f64) -> String {
    format!("{}", (value * 10.0).round() / 10.0 + 0.0)
}

/// As text of an XML file, which may not have control characters at all.
fn escape(text: &str) -> String {
    text.chars()
        .map(|c| match c {
            '&' => "&amp;".to_owned(),
            '<' => "&lt;".to_owned(),
            '>' => "&gt;".to_owned(),
            '"' => "&quot;".to_owned(),
            c if c.is_control() => '\u{fffd}'.to_string(),
            c => c.to_string(),
        })
        .collect()
}
