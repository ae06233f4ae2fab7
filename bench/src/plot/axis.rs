//! Axes: the stretch that is shown, where its ticks are, and what is written at them.

/// How many ticks with a label a linear axis has, about.
const LINEAR: f64 = 5.0;
/// How many decades of a logarithmic axis have a label at most.
const DECADES: f64 = 9.0;
/// So many decades have labels between the powers of ten, if they are numbers or powers.
const LABELLED: [f64; 2] = [3.05, 1.7];
/// So many have lines there.
const RULED: f64 = 6.0;
/// Beyond it differences are not finite any more.
const HUGE: f64 = 1e300;
/// Quotients of steps and powers that differ by less are equal.
const SLACK: f64 = 1e-9;

/// An axis: its title, its scale and what it reaches whatever is shown.
#[derive(Clone, Debug)]
pub struct Axis {
    pub(super) title: String,
    scale: Scale,
    reaching: Vec<f64>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Scale {
    Linear,
    Log,
}

impl Axis {
    /// An axis on which equal steps are equal differences.
    pub fn linear(title: impl Into<String>) -> Axis {
        Axis { title: title.into(), scale: Scale::Linear, reaching: Vec::new() }
    }

    /// An axis on which equal steps are equal quotients.
    pub fn log(title: impl Into<String>) -> Axis {
        Axis { title: title.into(), scale: Scale::Log, reaching: Vec::new() }
    }

    /// Reaching at least as far as a value, if it can be shown.
    #[must_use]
    pub fn reaching(mut self, value: f64) -> Axis {
        self.reaching.push(value);
        self
    }

    /// Whether a value has a place on the axis.
    pub(super) fn shows(&self, value: f64) -> bool {
        match self.scale {
            Scale::Linear => value.abs() < HUGE,
            Scale::Log => value.is_normal() && value > 0.0,
        }
    }

    /// What is shown so that these values are.
    pub(super) fn span(&self, values: impl IntoIterator<Item = f64>) -> Span {
        let all = values.into_iter().chain(self.reaching.iter().copied());
        let shown = all.filter(|value| self.shows(*value));
        let [low, high] = shown.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| {
            [low.min(value), high.max(value)]
        });
        match self.scale {
            Scale::Linear if low > high => linear(0.0, 1.0),
            Scale::Linear => linear(low, high),
            Scale::Log if low > high => log(1.0, 10.0),
            Scale::Log => log(low, high),
        }
    }
}

/// The stretch of an axis that is shown, from tick to tick.
#[derive(Clone, Copy, Debug)]
pub(super) struct Span {
    pub(super) low: f64,
    pub(super) high: f64,
    /// From tick to tick; `None` on a logarithmic axis.
    step: Option<Round>,
}

/// A tick. Those without a label are for the eye only.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Tick {
    pub(super) value: f64,
    pub(super) label: Option<String>,
}

/// One, two or five times a power of ten.
#[derive(Clone, Copy, Debug)]
struct Round {
    digit: i32,
    power: i32,
}

impl Round {
    fn value(self) -> f64 {
        f64::from(self.digit) * 10f64.powi(self.power)
    }

    /// Those of the decade of a value above 0, and the first of the next.
    fn around(value: f64) -> [Round; 4] {
        let power = value.log10().floor() as i32;
        [(1, power), (2, power), (5, power), (1, power + 1)]
            .map(|(digit, power)| Round { digit, power })
    }

    /// The least that is not below a value above 0.
    fn above(value: f64) -> Round {
        let all = Round::around(value);
        let fits = |round: &Round| round.value() >= value * (1.0 - SLACK);
        all.into_iter().find(fits).unwrap_or(all[3])
    }

    /// The greatest that is not above a value above 0.
    fn below(value: f64) -> Round {
        let all = Round::around(value);
        let fits = |round: &Round| round.value() <= value * (1.0 + SLACK);
        all.into_iter().rev().find(fits).unwrap_or(all[0])
    }
}

fn linear(low: f64, high: f64) -> Span {
    if high <= low {
        let about = if low == 0.0 { 1.0 } else { low.abs() / 2.0 };
        return linear(low - about, high + about);
    }
    let step = Round::above((high - low) / LINEAR);
    let low = (low / step.value() + SLACK).floor() * step.value();
    let high = (high / step.value() - SLACK).ceil() * step.value();
    Span { low, high, step: Some(step) }
}

fn log(low: f64, high: f64) -> Span {
    let [mut low, mut high] = [Round::below(low).value(), Round::above(high).value()];
    // Of a long axis part of a decade is no more than an unlabelled end.
    if (high / low).log10() > RULED {
        low = 10f64.powi((low.log10() + SLACK).floor() as i32);
        high = 10f64.powi((high.log10() - SLACK).ceil() as i32);
    }
    if high > low * (1.0 + SLACK) {
        return Span { low, high, step: None };
    }
    // A single value that is itself such a number: half of it and twice are further out than one step.
    let [low, high] = [Round::below(low / 2.0).value(), Round::above(high * 2.0).value()];
    Span { low, high, step: None }
}

impl Span {
    /// How far along the axis a value is: 0 at its low end, 1 at its high end.
    pub(super) fn share(&self, value: f64) -> f64 {
        match self.step {
            Some(_) => (value - self.low) / (self.high - self.low),
            None => (value / self.low).ln() / (self.high / self.low).ln(),
        }
    }

    /// All ticks, upward.
    pub(super) fn ticks(&self) -> Vec<Tick> {
        match self.step {
            Some(step) => self.linear_ticks(step),
            None => self.log_ticks(),
        }
    }

    fn linear_ticks(&self, step: Round) -> Vec<Tick> {
        let first = (self.low / step.value()).round() as i64;
        let count = ((self.high - self.low) / step.value()).round() as i64;
        let largest = self.low.abs().max(self.high.abs());
        (first..=first.saturating_add(count))
            .map(|n| Tick {
                value: n as f64 * step.value(),
                label: Some(linear_label(n, step, largest)),
            })
            .collect()
    }

    fn log_ticks(&self) -> Vec<Tick> {
        let decades = (self.high / self.low).log10();
        let every = (decades / DECADES).ceil().max(1.0) as i32;
        let plain = self.low > 0.000_99 && self.high < 100_001.0;
        let between = decades <= LABELLED[usize::from(!plain)];
        let mut ticks = Vec::new();
        for power in self.low.log10().floor() as i32..=self.high.log10().ceil() as i32 {
            for digit in 1..=if decades <= RULED { 9 } else { 1 } {
                let value = f64::from(digit) * 10f64.powi(power);
                let inside =
                    value >= self.low * (1.0 - SLACK) && value <= self.high * (1.0 + SLACK);
                let labelled = match digit {
                    1 => power.rem_euclid(every) == 0,
                    _ => between && matches!(digit, 2 | 5),
                };
                let label = labelled.then(|| log_label(digit, power, plain));
                ticks.extend(inside.then_some(Tick { value, label }));
            }
        }
        ticks
    }
}

/// `n` steps. The largest number of the axis decides how all of them are written.
fn linear_label(n: i64, step: Round, largest: f64) -> String {
    let whole = i64::from(step.digit).saturating_mul(n);
    if whole == 0 {
        "0".to_owned()
    } else if (-6..=0).contains(&step.power) || (step.power > 0 && largest < 1e6) {
        let decimals = usize::try_from(-step.power).unwrap_or(0);
        format!("{:.decimals$}", whole as f64 * 10f64.powi(step.power))
    } else {
        format!("{whole}·{}", power_of_ten(step.power))
    }
}

fn log_label(digit: i32, power: i32, plain: bool) -> String {
    if plain {
        let decimals = usize::try_from(-power).unwrap_or(0);
        format!("{:.decimals$}", f64::from(digit) * 10f64.powi(power))
    } else if digit == 1 {
        power_of_ten(power)
    } else {
        format!("{digit}·{}", power_of_ten(power))
    }
}

fn power_of_ten(power: i32) -> String {
    const RAISED: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    let raised = power
        .to_string()
        .chars()
        .map(|c| match c.to_digit(10) {
            Some(digit) => RAISED[digit as usize],
            None => '⁻',
        })
        .collect::<String>();
    format!("10{raised}")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(axis: &Axis, values: &[f64]) -> Vec<String> {
        let ticks = axis.span(values.iter().copied()).ticks();
        ticks.into_iter().filter_map(|tick| tick.label).collect()
    }

    fn of_linear(values: &[f64]) -> Vec<String> {
        labels(&Axis::linear(""), values)
    }

    fn of_log(values: &[f64]) -> Vec<String> {
        labels(&Axis::log(""), values)
    }

    #[test]
    fn linear_ticks_are_round_and_hold_what_is_shown() {
        assert_eq!(of_linear(&[0.03, 0.93]), ["0", "0.2", "0.4", "0.6", "0.8", "1.0"]);
        assert_eq!(of_linear(&[-3.0, 7.0]), ["-4", "-2", "0", "2", "4", "6", "8"]);
        assert_eq!(of_linear(&[0.0, 50_000.0]), ["0", "10000", "20000", "30000", "40000", "50000"]);
        assert_eq!(of_linear(&[0.0, 4e9])[1], "1·10⁹");
        assert_eq!(of_linear(&[0.0, 1e-8])[1], "2·10⁻⁹");
    }

    #[test]
    fn linear_axes_of_one_value_or_none_have_a_length() {
        assert_eq!(of_linear(&[]), ["0", "0.2", "0.4", "0.6", "0.8", "1.0"]);
        assert_eq!(of_linear(&[0.0]), ["-1.0", "-0.5", "0", "0.5", "1.0"]);
        assert_eq!(of_linear(&[8.0]), ["4", "6", "8", "10", "12"]);
        assert_eq!(of_linear(&[f64::NAN, f64::INFINITY, -1e308, 1e308]), of_linear(&[]));
    }

    #[test]
    fn log_ticks_are_powers_and_what_lies_between_where_there_is_room() {
        assert_eq!(of_log(&[0.28, 8.0]), ["0.2", "0.5", "1", "2", "5", "10"]);
        assert_eq!(of_log(&[0.28, 8000.0]), ["1", "10", "100", "1000", "10000"]);
        assert_eq!(of_log(&[1e3, 1e7]), ["10³", "10⁴", "10⁵", "10⁶", "10⁷"]);
        assert_eq!(of_log(&[3e5, 2e6]), ["2·10⁵", "5·10⁵", "10⁶", "2·10⁶"]);
        assert_eq!(of_log(&[3e-16, 0.2]).first().map(String::as_str), Some("10⁻¹⁶"));
        assert!(of_log(&[1e-300, 1e300]).len() <= 12);
    }

    #[test]
    fn log_ticks_without_labels_are_the_other_whole_multiples() {
        let span = Axis::log("").span([1e3, 1e6]);
        assert_eq!((span.low, span.high), (1e3, 1e6));
        assert_eq!(span.ticks().len(), 28);
        assert_eq!(Axis::log("").span([1e-16, 1.0]).ticks().len(), 17);
    }

    #[test]
    fn log_axes_of_one_value_or_none_have_a_length() {
        assert_eq!(of_log(&[]), ["1", "2", "5", "10"]);
        assert_eq!(of_log(&[0.0, -1.0, f64::NAN]), of_log(&[]));
        assert_eq!(of_log(&[100.0]), ["50", "100", "200"]);
        assert_eq!(of_log(&[0.003]), ["0.002", "0.005"]);
    }

    #[test]
    fn ends_of_an_axis_are_0_and_1() {
        for axis in [Axis::linear(""), Axis::log("")] {
            let span = axis.reaching(0.01).span([1.0, 100.0]);
            assert!(span.share(span.low).abs() < 1e-12, "{span:?}");
            assert!((span.share(span.high) - 1.0).abs() < 1e-12, "{span:?}");
        }
        assert_eq!(Axis::log("").span([1.0, 100.0]).share(10.0), 0.5);
    }
}
