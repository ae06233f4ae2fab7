//! A straight line through what was measured.

/// `at_zero + slope · x`
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fit {
    /// Where it crosses x = 0.
    pub at_zero: f64,
    /// How much more it is for one more of x.
    pub slope: f64,
}

impl Fit {
    /// The line's height.
    pub fn at(&self, x: f64) -> f64 {
        self.at_zero + self.slope * x
    }
}

/// The line whose errors relative to what was measured are least, squared and summed: a time of a
/// microsecond counts as much as one of a millisecond. `None` of fewer than two places, or of a
/// height that is not above 0.
pub fn fit(points: &[[f64; 2]]) -> Option<Fit> {
    // Of (a + b x − y)/y, with weights 1/y²: the centre first, so that nothing large cancels.
    let weight = |[_, y]: &[f64; 2]| 1.0 / (y * y);
    let total: f64 = points.iter().map(weight).sum();
    let mean = |axis: usize| points.iter().map(|p| weight(p) * p[axis]).sum::<f64>() / total;
    let [x, y] = [mean(0), mean(1)];
    let along: f64 = points.iter().map(|p| weight(p) * (p[0] - x) * (p[1] - y)).sum();
    let across: f64 = points.iter().map(|p| weight(p) * (p[0] - x) * (p[0] - x)).sum();
    let slope = along / across;
    let positive = points.iter().all(|p| p[1] > 0.0);
    (positive && slope.is_finite()).then_some(Fit { at_zero: y - slope * x, slope })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_is_found_again() {
        let points = [1.0, 10.0, 100.0, 1e6].map(|x| [x, 300.0 + 11.0 * x]);
        let found = fit(&points).expect("a line");
        assert!((found.at_zero / 300.0 - 1.0).abs() < 1e-9, "{found:?}");
        assert!((found.slope / 11.0 - 1.0).abs() < 1e-12, "{found:?}");
        assert!((found.at(2.0) - 322.0).abs() < 1e-6);
    }

    #[test]
    fn small_values_count_as_much_as_large_ones() {
        // The last is a tenth too much: without weights the crossing would be far below 0.
        let found = fit(&[[0.0, 1.0], [1.0, 2.0], [2.0, 3.0], [1e6, 1.1e6]]).expect("a line");
        assert!((found.at_zero - 1.0).abs() < 0.1, "{found:?}");
    }

    #[test]
    fn no_line_is_no_line() {
        for points in [&[][..], &[[1.0, 1.0]], &[[1.0, 1.0], [1.0, 2.0]], &[[1.0, 0.0], [2.0, 1.0]]]
        {
            assert_eq!(fit(points), None, "{points:?}");
        }
    }
}
