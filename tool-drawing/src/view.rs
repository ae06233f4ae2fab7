//! The map from a section to the sheet. On the sheet the axis is x = 0, the lowest point is at y = 0, and the spindle
//! is above. Long plain cylinders are shortened, as in technical drawings, so that thin tools stay readable.

use super::ROUNDING_FRACTION;
use super::section::{Section, Split};
use super::stroke::Stroke;
use touchoff_plane::Point;

/// The height of a shortened section, as a multiple of its width.
const MAX_ASPECT_RATIO: f64 = 4.8;
/// The minimum length of a shortened cylinder, as a multiple of the section's width.
const MIN_SHORTENED_LENGTH: f64 = 0.7;

/// An interval of the axis that is left out.
#[derive(Clone, Copy, Debug)]
struct Cut {
    low: f64,
    high: f64,
}

/// The section's placement on the sheet.
#[derive(Clone, Debug)]
pub(super) struct View {
    /// Sheet units per unit of length of the tool.
    pub(super) scale: f64,
    /// The point of the section at the sheet's origin.
    origin: Point,
    cuts: Vec<Cut>,
    /// Half the section's width on the sheet; `height` is its height there.
    pub(super) half: f64,
    pub(super) height: f64,
}

impl View {
    /// Returns the view of a tool's section, as large as fits in a width and a height of the sheet.
    pub(super) fn new(section: &Section, [wide, tall]: [f64; 2]) -> View {
        let radius = section.surface().map(Stroke::widest).fold(0.0, f64::max);
        let mut lines: Vec<Stroke> = section.surface().copied().collect();
        for Split { line, .. } in &section.splits {
            lines.extend(line.windows(2).map(|pair| Stroke::line(pair[0], pair[1])));
        }
        let mut levels: Vec<f64> = lines.iter().flat_map(Stroke::span).collect();
        levels.sort_by(f64::total_cmp);
        let low = levels.first().copied().unwrap_or(0.0);
        let length = levels.last().copied().unwrap_or(0.0) - low;
        levels.dedup_by(|a, b| *a - *b < ROUNDING_FRACTION * length);
        lines.retain(|line| line.breadth()[1] - line.breadth()[0] >= ROUNDING_FRACTION * radius);
        let mut plain = Vec::new();
        for pair in levels.windows(2) {
            let middle = f64::midpoint(pair[0], pair[1]);
            let is_passed = |line: &Stroke| line.span()[0] <= middle && middle < line.span()[1];
            if !lines.iter().any(is_passed) {
                plain.push([pair[0], pair[1]]);
            }
        }
        let cuts = cuts(&plain, length, 2.0 * radius);
        let remaining = length - cuts.iter().map(|cut| cut.high - cut.low).sum::<f64>();
        let scale = (wide / (2.0 * radius)).min(tall / remaining);
        View { scale, origin: [0.0, low], cuts, half: radius * scale, height: remaining * scale }
    }

    /// Returns the view of a box of a plane, symmetric on the sheet.
    pub(super) fn framed([low, high]: [Point; 2], scale: f64) -> View {
        let [wide, tall] = [0, 1].map(|k| (high[k] - low[k]) * scale);
        let origin = [low[0] / 2.0 + high[0] / 2.0, low[1]];
        View { scale, origin, cuts: Vec::new(), half: wide / 2.0, height: tall }
    }

    /// Returns the view at another scale.
    pub(super) fn rescaled(self, scale: f64) -> View {
        let factor = scale / self.scale;
        View { scale, half: self.half * factor, height: self.height * factor, ..self }
    }

    /// Maps a point of the section to the right half of the sheet.
    pub(super) fn to_sheet(&self, [d, z]: Point) -> Point {
        let gone: f64 = self.cuts.iter().map(|cut| (z.min(cut.high) - cut.low).max(0.0)).sum();
        [(d - self.origin[0]) * self.scale, -(z - self.origin[1] - gone) * self.scale]
    }

    /// Maps a point of the sheet back to the section.
    pub(super) fn point(&self, [x, y]: Point) -> Point {
        let mut z = self.origin[1] - y / self.scale;
        for cut in &self.cuts {
            if z > cut.low {
                z += cut.high - cut.low;
            }
        }
        [self.origin[0] + x / self.scale, z]
    }

    /// Maps a stroke to the sheet.
    pub(super) fn stroke(&self, stroke: &Stroke) -> Stroke {
        let (from, to) = (self.to_sheet(stroke.from), self.to_sheet(stroke.to));
        let circle = stroke.circle.map(|(centre, radius)| {
            let [d, z] = [0, 1].map(|k| centre[k] - stroke.from[k]);
            ([from[0] + d * self.scale, from[1] - z * self.scale], radius * self.scale)
        });
        Stroke { from, to, circle }
    }

    /// Returns the heights on the sheet at which a part of the axis is left out.
    pub(super) fn seams(&self) -> Vec<f64> {
        self.cuts.iter().map(|cut| self.to_sheet([0.0, cut.low])[1]).collect()
    }
}

/// Returns the intervals to leave out of the plain cylinders, so that the whole is about `MAX_ASPECT_RATIO` widths long.
fn cuts(plain: &[[f64; 2]], length: f64, width: f64) -> Vec<Cut> {
    let target_length = MAX_ASPECT_RATIO * width;
    if length <= 1.15 * target_length {
        return Vec::new();
    }
    // The length kept of each cylinder is found by bisection.
    let (mut least, mut most) = (MIN_SHORTENED_LENGTH * width, length);
    let remaining =
        |keep: f64| length - plain.iter().map(|[a, b]| (b - a - keep).max(0.0)).sum::<f64>();
    for _ in 0..40 {
        let keep = least / 2.0 + most / 2.0;
        if remaining(keep) > target_length { most = keep } else { least = keep }
    }
    plain
        .iter()
        .filter(|[a, b]| b - a > 1.5 * least)
        .map(|[a, b]| Cut { low: a + least / 2.0, high: b - least / 2.0 })
        .collect()
}
