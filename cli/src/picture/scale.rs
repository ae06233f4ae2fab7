//! Scales of quantities: values, colours and round labels.

use super::NOTHING;
use super::render::Paint;
use touchoff_postures::colormap;

/// A quantity that colours stand for.
#[derive(Clone, Debug)]
pub(crate) struct Scale {
    /// The quantity with its unit.
    pub(crate) quantity: String,
    /// The values of the darkest and of the brightest colour.
    range: [f64; 2],
    /// Round values from one end to the other, as text.
    labels: Vec<String>,
    /// Both ends as text, with the unit.
    pub(crate) ends: [String; 2],
    /// Meaning of triangles without a value.
    pub(crate) nothing: &'static str,
    /// Set if there is any value.
    pub(crate) has_values: bool,
}

/// A quantity to be shown by colours.
pub(crate) struct Measure<'a> {
    /// The quantity with its unit.
    pub(crate) quantity: String,
    /// Symbol of the unit; empty for a number without one.
    pub(crate) unit: &'a str,
    /// Set if the scale is to begin at 0.
    pub(crate) from_zero: bool,
    /// Meaning of triangles without a value.
    pub(crate) nothing: &'static str,
}

/// Largest number of steps between labels.
const MAX_STEPS: f64 = 6.0;
/// Number of decimals above which numbers have an exponent.
const MAX_DECIMALS: i32 = 9;

impl Scale {
    /// Creates a scale that begins and ends at round numbers, around all values. Values of one number alone have that
    /// number as their only label.
    pub(crate) fn new(measure: Measure<'_>, values: impl Iterator<Item = f64>) -> Scale {
        let Measure { quantity, unit, from_zero, nothing } = measure;
        let given = values.fold(None, |known: Option<[f64; 2]>, value| {
            let [low, high] = known.unwrap_or([value; 2]);
            Some([low.min(value), high.max(value)])
        });
        let [low, high] = given.unwrap_or_default();
        let low = if from_zero { low.min(0.0) } else { low };
        let (range, labels) = round(low, high);
        let ends = [labels.first(), labels.last()].map(|label| {
            let label = label.map_or("", |label| label);
            if unit.is_empty() { label.to_owned() } else { format!("{label} {unit}") }
        });
        Scale { quantity, range, labels, ends, nothing, has_values: given.is_some() }
    }

    /// Returns the position of a value on the scale, from 0 to 1.
    pub(crate) fn share(&self, value: f64) -> f64 {
        let [low, high] = self.range;
        if high > low { ((value - low) / (high - low)).clamp(0.0, 1.0) } else { 1.0 }
    }

    /// Returns the labels with their positions from 0 to 1, evenly apart.
    pub(super) fn labels(&self) -> impl Iterator<Item = (f64, &str)> {
        let last = self.labels.len().saturating_sub(1);
        self.labels.iter().enumerate().map(move |(index, label)| {
            // A single label stands at the bright end, whose colour its values have.
            (if last == 0 { 1.0 } else { index as f64 / last as f64 }, &**label)
        })
    }

    /// Returns the look of a triangle.
    pub(crate) fn paint(&self, value: Option<f64>) -> Paint {
        value.map_or(Paint::Plain(NOTHING), |value| Paint::Value(colormap(self.share(value))))
    }
}

/// Returns a range around another one that begins and ends at multiples of a round step, and those multiples as text. The
/// step is 1, 2 or 5 times a power of ten.
fn round(low: f64, high: f64) -> ([f64; 2], Vec<String>) {
    /// Fraction of a step by which a value may exceed a multiple, for rounding.
    const SLACK: f64 = 1e-6;
    let width = high - low;
    // A range of rounding errors is one number.
    if width.is_nan() || width <= 1e-9 * low.abs().max(high.abs()) {
        let digits = 4 - high.abs().log10().floor().clamp(-300.0, 300.0) as i32;
        let text = number(high, if high == 0.0 { 0 } else { digits.max(0) });
        return ([high; 2], vec![text]);
    }
    let power = (width / MAX_STEPS).log10().floor() as i32;
    let steps = [1.0, 2.0, 5.0, 10.0].map(|factor| factor * 10f64.powi(power));
    let step = steps.into_iter().find(|step| width <= MAX_STEPS * *step).unwrap_or(steps[3]);
    let decimals = (-(step * (1.0 + SLACK)).log10().floor()).max(0.0) as i32;
    let [first, last] = [(low / step + SLACK).floor() as i64, (high / step - SLACK).ceil() as i64];
    let labels = (first..=last).map(|multiple| number(multiple as f64 * step, decimals));
    ([first as f64 * step, last as f64 * step], labels.collect())
}

/// Formats a number with some decimals; those of very small numbers are significant digits.
fn number(value: f64, decimals: i32) -> String {
    match decimals {
        _ if value == 0.0 => "0".to_owned(),
        0..=MAX_DECIMALS => format!("{value:.*}", decimals as usize),
        _ => format!("{value:.1e}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scale(values: &[f64], from_zero: bool, unit: &str) -> Scale {
        let quantity = "depth".to_owned();
        let measure = Measure { quantity, unit, from_zero, nothing: "none" };
        Scale::new(measure, values.iter().copied())
    }

    fn labels(values: &[f64], from_zero: bool) -> Vec<String> {
        let scale = scale(values, from_zero, "inch");
        scale.labels().map(|(_, label)| label.to_owned()).collect()
    }

    #[test]
    fn labels_are_round_and_have_the_digits_that_they_need() {
        // Hundredths of a millimetre in inch, and in m.
        assert_eq!(labels(&[0.0004], true), ["0", "0.0001", "0.0002", "0.0003", "0.0004"]);
        assert_eq!(
            labels(&[0.0098, 0.002], true),
            ["0", "0.002", "0.004", "0.006", "0.008", "0.010"]
        );
        assert_eq!(labels(&[1.1e-5], true).last().map(String::as_str), Some("0.000012"));
        assert_eq!(labels(&[0.71, 0.8661], false), ["0.70", "0.75", "0.80", "0.85", "0.90"]);
        assert_eq!(labels(&[18.0, 21.9], false), ["18", "19", "20", "21", "22"]);
        assert_eq!(labels(&[1.0], true), ["0", "0.2", "0.4", "0.6", "0.8", "1.0"]);
        assert_eq!(labels(&[12.2], true), ["0", "5", "10", "15"]);
        assert_eq!(labels(&[-0.3, 0.4], true), ["-0.4", "-0.2", "0", "0.2", "0.4"]);
        assert_eq!(labels(&[3e-13], true)[1], "5.0e-14");
    }

    #[test]
    fn one_value_is_its_own_label() {
        assert_eq!(labels(&[0.708_661, 0.708_661], false), ["0.70866"]);
        assert_eq!(labels(&[18.0], false), ["18.000"]);
        assert_eq!(labels(&[0.0], true), ["0"]);
        assert_eq!(labels(&[], true), ["0"]);
        assert!(!scale(&[], true, "").has_values);
        assert_eq!(scale(&[18.0], false, "mm").share(18.0), 1.0);
    }

    #[test]
    fn no_value_lies_beyond_its_scale() {
        for exponent in -12..6 {
            for lead in [1.0, 1.37, 2.0, 4.999_999, 5.0, 9.99] {
                let high = lead * 10f64.powi(exponent);
                let scale = scale(&[0.3 * high, high], true, "m");
                let [low, end] = scale.range;
                assert!(
                    low == 0.0 && end >= high * (1.0 - 1e-5) && end <= 1.7 * high,
                    "{high}: {end}"
                );
                let count = scale.labels.len();
                assert!((4..=7).contains(&count), "{high}: {:?}", scale.labels);
                for (share, label) in scale.labels() {
                    let value: f64 = label.parse().expect("a number");
                    assert!((value - share * end).abs() <= 1e-6 * end, "{high}: {label}");
                }
                assert_eq!(scale.ends[0], "0 m");
                assert!(scale.share(high) > 0.58 && scale.share(2.0 * high) == 1.0);
            }
        }
    }
}
