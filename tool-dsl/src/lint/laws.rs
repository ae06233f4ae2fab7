//! Checks of `magnitude` and `niceness` at points that samples of the inside do not reach: toward the
//! surface, at its corners and on the axis.

use super::{Linter, ROUNDING, norm};
use crate::bound::Extent;
use crate::diagnostic::{CheckKind, Diagnostic, FormattedNumber, Subject, any_error};
use crate::expr::{Id, Node};
use crate::geometry::outline::{Point, Segment, points_with_normals};
use crate::model::{DirectionSource, Model};
use crate::number::Number;
use crate::regionalise::overlay::Division;
use crate::source::Span;

/// The number of points along a segment of a profile.
const POINTS_PER_SEGMENT: usize = 8;
/// The number of steps between points on the axis.
const AXIS_STEPS: i32 = 200;
/// The distances inside the surface at which values are compared, in sizes of the tool.
const NEAR_SURFACE_FRACTION: f64 = 1e-10;
const INSIDE_FRACTION: f64 = 1e-5;
/// The least depth of the samples with which these values are compared, in sizes of the tool.
const SAMPLED_DEPTH_FRACTION: f64 = 1e-3;
/// The ratio of the values near the surface and farther in from which a value is reported to grow without
/// bound. For `1/sqrt(depth)` it is 316, and for a logarithm 2.
const MIN_GROWTH_RATIO: f64 = 100.0;
/// The ratio by which such a value must also exceed those at all samples, so that a value that passes through
/// 0 is not reported.
const MIN_RATIO_TO_SAMPLES: f64 = 1000.0;
/// The ratio of a divisor near the surface to that farther in below which it is 0 on the surface. For a root it is 1/316.
const MAX_FALL_RATIO: f64 = 0.01;
/// The number of points that are kept for each sign of a divisor. Any two of opposite signs may have a zero between
/// them, but not all are joined by a line in the region.
const MAX_POINTS_OF_SIGN: usize = 6;

/// The smallest difference of a magnitude's slope from 1, and the smallest angle between a direction and the steepest descent of the
/// magnitude, that are noted: more than the rounding of four decimals.
const SLOPE_TOLERANCE: f64 = 1e-4;
const ANGLE_TOLERANCE: f64 = 1e-4;

/// The slopes of a region's magnitude at the samples, if the file writes one: what the force law `gradient` makes of it.
#[derive(Clone, Copy, Default)]
pub(super) struct MagnitudeSlope {
    /// The slope that differs most from 1, and its point.
    farthest: Option<([f64; 3], f64)>,
    /// The largest slope.
    largest: f64,
    /// The largest angle of the direction with the steepest descent, rad, and its point.
    oblique: Option<([f64; 3], f64)>,
}

/// A divisor in a law of a region.
pub(super) struct Divisor {
    region: usize,
    quantity: &'static str,
    span: Span,
    law: Id,
    id: Id,
    /// Points of the region at which it is below 0, and above 0.
    points: [Vec<[f64; 3]>; 2],
}

/// Returns the divisors of all regions' laws.
pub(super) fn divisors(model: &Model) -> Vec<Divisor> {
    let mut divisors = Vec::new();
    for (index, region) in model.regions.iter().enumerate() {
        let spans = region.law_spans;
        for (quantity, law, span) in [
            ("magnitude", region.magnitude, spans.magnitude),
            ("niceness", region.niceness, spans.niceness),
        ] {
            for id in model.graph.dependencies([law]) {
                if let Node::Div(_, divisor) = *model.graph.node(id) {
                    let points = Default::default();
                    let (region, id) = (index, divisor);
                    divisors.push(Divisor { region, quantity, span, law, id, points });
                }
            }
        }
    }
    divisors
}

/// Returns points on an outline, in the half plane's coordinates, each with a vector into the material: along
/// its segments and at the corners between them.
pub(super) fn inward_directions(outline: &[Segment]) -> Vec<[Point; 2]> {
    let points_by_segment: Vec<Vec<[Point; 2]>> =
        outline.iter().map(|segment| points_with_normals(segment, POINTS_PER_SEGMENT)).collect();
    let corners = outline.iter().zip(points_by_segment.windows(2)).filter_map(
        |(segment, inward_directions)| {
            let [[_, one], [_, other]] =
                [inward_directions[0].last()?, inward_directions[1].first()?];
            Some([segment.geometry.ends[1], [one[0] + other[0], one[1] + other[1]]])
        },
    );
    let corners: Vec<[Point; 2]> = corners.collect();
    points_by_segment.into_iter().flatten().chain(corners).collect()
}

impl Linter<'_> {
    /// Returns the laws of a region: their names, values and locations in the text.
    fn laws(&self, owner: usize) -> [(&'static str, Id, Span); 2] {
        let region = &self.model.regions[owner];
        [
            ("magnitude", region.magnitude, region.law_spans.magnitude),
            ("niceness", region.niceness, region.law_spans.niceness),
        ]
    }

    /// Updates what is known of the laws' values and divisors by the current point.
    pub(super) fn measure(&mut self, owner: usize, point: [f64; 3]) {
        // Beside the surface a value is as great as the one that it is compared with.
        let depth = self.get(self.model.regions[owner].depth);
        for (law, (_, id, _)) in self.laws(owner).into_iter().enumerate() {
            let value = self.get(id).abs();
            if value.is_finite() && depth > SAMPLED_DEPTH_FRACTION * self.size {
                let largest = &mut self.largest[owner][law];
                *largest = largest.max(value);
            }
        }
        let niceness = self.get(self.model.regions[owner].niceness);
        if self.nicest[owner].is_none_or(|(_, largest)| niceness > largest) {
            self.nicest[owner] = Some((point, niceness));
        }
        self.measure_slope(owner, point);
        for index in 0..self.divisors.len() {
            let Divisor { region, id, .. } = self.divisors[index];
            let value = if region == owner { self.get(id) } else { 0.0 };
            let seen = &mut self.divisors[index].points[usize::from(value > 0.0)];
            if value != 0.0 && seen.len() < MAX_POINTS_OF_SIGN {
                seen.push(point);
            }
        }
    }

    /// Returns whether the file writes a magnitude for a region. Otherwise it is the depth in the part's unit.
    fn has_magnitude(&self, owner: usize) -> bool {
        let region = &self.model.regions[owner];
        region.outputs.magnitude == region.magnitude
    }

    /// Updates what is known of the slope of a region's magnitude and of its direction by the current point.
    fn measure_slope(&mut self, owner: usize, point: [f64; 3]) {
        let region = &self.model.regions[owner];
        let is_written = region.source != DirectionSource::Derived;
        if !self.has_magnitude(owner) && !is_written {
            return;
        }
        let gradient = region.outputs.gradient.map(|id| self.get(id));
        let slope = norm(gradient);
        if !slope.is_finite() {
            return;
        }
        let direction = region.direction.map(|id| self.get(id));
        let known = &mut self.slopes[owner];
        known.largest = known.largest.max(slope);
        if known.farthest.is_none_or(|(_, other)| (slope - 1.0).abs() > (other - 1.0).abs()) {
            known.farthest = Some((point, slope));
        }
        if is_written && slope > 0.0 {
            let cosine: f64 = (0..3).map(|k| -gradient[k] / slope * direction[k]).sum();
            let across = [0, 1, 2].map(|k| direction[k] + gradient[k] / slope * cosine);
            let angle = norm(across).atan2(cosine);
            if known.oblique.is_none_or(|(_, other)| angle > other) {
                known.oblique = Some((point, angle));
            }
        }
    }

    /// Reports what the force law `gradient` makes of magnitudes and directions that the file writes, if that is surprising.
    pub(super) fn report_slopes(&mut self) {
        // Of a tool that is refused, no force is asked.
        if any_error(&self.found) {
            return;
        }
        // Directions of `regions smooth` are no mistake.
        let over = self.model.profile.as_ref().and_then(|profile| profile.over.as_ref());
        let is_smooth = over.is_some_and(|over| matches!(over.division, Division::Rounded(_)));
        for (index, slopes) in std::mem::take(&mut self.slopes).into_iter().enumerate() {
            let MagnitudeSlope { farthest, largest, oblique } = slopes;
            let region = &self.model.regions[index];
            let (name, unit) = (region.name.clone(), self.model.unit.symbol());
            let (of_magnitude, of_direction) = (region.law_spans.magnitude, region.raw_direction.1);
            let Some((point, slope)) = farthest else { continue };
            if self.has_magnitude(index) && largest == 0.0 {
                // A magnitude of 0 says that contacts exert no force.
                if self.largest[index][0] > 0.0 {
                    let kind = CheckKind::ForcelessMagnitude { region: name };
                    self.report(Diagnostic::new(of_magnitude, kind));
                }
                continue;
            }
            if self.has_magnitude(index) && (slope - 1.0).abs() > SLOPE_TOLERANCE {
                let (region, slope) = (name.clone(), FormattedNumber(slope));
                let location = self.format_point(point);
                let kind = CheckKind::SlopeOfMagnitude { region, slope, unit, location };
                self.report(Diagnostic::new(of_magnitude, kind));
            }
            let oblique = oblique.filter(|(_, angle)| *angle > ANGLE_TOLERANCE && !is_smooth);
            if let Some((point, angle)) = oblique {
                let degrees = FormattedNumber(angle.to_degrees());
                let location = self.format_point(point);
                let kind = CheckKind::UnusedDirection { region: name, degrees, location };
                self.report(Diagnostic::new(of_direction, kind));
            }
        }
    }

    /// Reports divisors that are 0 inside a region: between points at which they have opposite signs.
    pub(super) fn report_poles(&mut self) {
        for divisor in std::mem::take(&mut self.divisors) {
            let [below, above] = &divisor.points;
            let pole = below.iter().find_map(|from| {
                above.iter().find_map(|to| self.zero_between(&divisor, *from, *to))
            });
            if let Some(point) = pole {
                let kind = self.division_by_zero(&divisor, point);
                self.report(Diagnostic::new(divisor.span, kind));
            }
        }
    }

    /// Returns a point at which a divisor changes its sign between two others, if the way there is in its region.
    fn zero_between(
        &mut self,
        divisor: &Divisor,
        mut below: [f64; 3],
        mut above: [f64; 3],
    ) -> Option<[f64; 3]> {
        for _ in 0..64 {
            let middle = [0, 1, 2].map(|k| (below[k] + above[k]) / 2.0);
            if self.owner(middle) != Some(divisor.region) {
                return None;
            }
            // A divisor is computed with its law.
            self.get(divisor.law);
            if self.get(divisor.id) > 0.0 { above = middle } else { below = middle }
        }
        Some(above)
    }

    fn division_by_zero(&self, divisor: &Divisor, point: [f64; 3]) -> CheckKind {
        let region = self.model.regions[divisor.region].name.clone();
        CheckKind::DivisionByZero {
            location: self.format_point(point),
            subject: Subject::Quantity(divisor.quantity, region),
            by_hand: !self.model.is_exact(),
        }
    }

    /// Reports nicenesses of cutting surfaces that are nowhere above 0, or somewhere above 1.
    pub(super) fn report_niceness_range(&mut self) {
        for (index, nicest) in std::mem::take(&mut self.nicest).into_iter().enumerate() {
            let region = &self.model.regions[index];
            let Some((point, value)) = nicest else { continue };
            // A constant 0 says that no contact is good.
            let is_zero = self.model.graph.constant(region.niceness).is_some_and(Number::is_zero);
            let (region_name, location) = (region.name.clone(), self.format_point(point));
            let kind = match FormattedNumber(value) {
                value if value.0 > 1.0 + ROUNDING => {
                    CheckKind::NicenessAboveOne { region: region_name, value, location }
                }
                value if value.0 <= 0.0 && !is_zero => {
                    CheckKind::NicenessNowherePositive { region: region_name, value, location }
                }
                _ => continue,
            };
            self.report(Diagnostic::new(region.law_spans.niceness, kind));
        }
    }

    /// Reports laws that have no value just inside a point of the surface, or that grow without bound toward
    /// it. `inward` points into the material and has any nonzero length.
    pub(super) fn check_toward_surface(&mut self, surface_point: [f64; 3], inward: [f64; 3]) {
        let length = norm(inward);
        let [near, far] = [NEAR_SURFACE_FRACTION, INSIDE_FRACTION].map(|fraction| {
            [0, 1, 2].map(|k| surface_point[k] + inward[k] / length * fraction * self.size)
        });
        let Some(owner) = self.owner(near) else { return };
        self.report_missing_values(owner, near);
        let values = self.laws(owner).map(|(_, id, _)| self.get(id).abs());
        let own = self.divisors.iter().enumerate().filter(|(_, divisor)| divisor.region == owner);
        let near_divisors: Vec<(usize, f64)> =
            own.map(|(index, divisor)| (index, self.get(divisor.id).abs())).collect();
        if self.owner(far) != Some(owner) {
            return;
        }
        for (law, (quantity, id, span)) in self.laws(owner).into_iter().enumerate() {
            let (near, far) = (values[law], self.get(id).abs());
            if near > MIN_GROWTH_RATIO * far
                && near > MIN_RATIO_TO_SAMPLES * self.largest[owner][law]
            {
                let kind = CheckKind::UnboundedQuantity {
                    quantity,
                    region: self.model.regions[owner].name.clone(),
                    value: FormattedNumber(near),
                    location: self.format_point(surface_point),
                };
                self.report(Diagnostic::new(span, kind));
                return;
            }
        }
        // The law has a limit at the surface, and yet no value there: 0 divided by 0.
        for (index, near) in near_divisors {
            let divisor = &self.divisors[index];
            if near < MAX_FALL_RATIO * self.get(divisor.id).abs() {
                let span = divisor.span;
                let kind = self.division_by_zero(divisor, surface_point);
                self.report(Diagnostic::new(span, kind));
            }
        }
    }

    /// Reports laws that have no value on the axis.
    pub(super) fn on_axis(&mut self, extent: &Extent) {
        for step in 0..=AXIS_STEPS {
            let fraction = f64::from(step) / f64::from(AXIS_STEPS);
            let point = [0.0, 0.0, extent.low + fraction * (extent.high - extent.low)];
            if let Some(owner) = self.owner(point) {
                self.report_missing_values(owner, point);
            }
        }
    }

    /// Reports laws that have no value at the current point.
    fn report_missing_values(&mut self, owner: usize, point: [f64; 3]) {
        for (quantity, id, span) in self.laws(owner) {
            if !self.get(id).is_finite() {
                let diagnostic =
                    self.not_finite(owner, quantity, id, span, self.format_point(point));
                self.report(diagnostic);
            }
        }
    }

    /// Returns the diagnostic of a law that is not a finite number at the current point.
    pub(super) fn not_finite(
        &self,
        owner: usize,
        quantity: &'static str,
        id: Id,
        span: Span,
        place: String,
    ) -> Diagnostic {
        let subject = Subject::Quantity(quantity, self.model.regions[owner].name.clone());
        Diagnostic::new(span, self.fault(id).kind(place, subject, !self.model.is_exact()))
    }
}

#[cfg(test)]
mod tests {
    use crate::compile;
    use crate::diagnostic::{Diagnostic, Severity};
    use crate::source::Source;

    /// Returns the messages for tools with a law: a profile with it as magnitude, one with it as niceness,
    /// and one of regions written by hand.
    fn messages(law: &str) -> [Vec<String>; 3] {
        let profile = "profile { start (0, 0); line to (2, 0) as face cutting; arc to (3, 1) center (2, 1) as corner
                       cutting; line to (3, 20) as flute cutting; line to (0, 20) as top; }";
        let by_hand = "d <= 3, 0 <= z <= 3 { depth: min(z, 3 - d, 3 - z)";
        [
            format!("{profile} magnitude: {law};"),
            format!("{profile} niceness cutting: {law};"),
            format!("region all where {by_hand}; magnitude: {law}; }}"),
        ]
        .map(|items| {
            let compiled =
                compile(&Source::new("a.tool", format!("tool A {{ units mm; {items} }}")));
            // Notes tell of nicenesses above 1.
            let found = compiled.diagnostics().iter();
            let found = found.filter(|diagnostic| diagnostic.severity != Severity::Note);
            found.map(Diagnostic::message).collect()
        })
    }

    #[test]
    fn laws_without_a_value_at_the_surface_are_reported() {
        let unbounded = "grows without bound toward the surface";
        for (law, expected) in [
            ("1/depth", unbounded),
            ("1/sqrt(depth)", unbounded),
            ("1/z", unbounded),
            ("sqrt(depth - 0.001)", "square root of a negative number"),
            ("1/d", "division by zero at (0, "),
        ] {
            for said in messages(law) {
                assert!(said.iter().any(|message| message.contains(expected)), "{law}: {said:?}");
            }
        }
    }

    #[test]
    fn laws_that_are_steep_or_vanish_at_the_surface_are_accepted() {
        for law in [
            "1/(depth + 0.001)",
            "5*sqrt(depth)",
            "depth^1.5",
            "(1 - depth/10)^2",
            "1/(1 + d)",
            "1000000*depth",
        ] {
            assert_eq!(messages(law).concat(), Vec::<String>::new(), "{law}");
        }
    }
}
