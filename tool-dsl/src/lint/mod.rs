//! A search for errors at many sample points of a tool's domain: regions that overlap, are never reached or
//! give invalid values. Each diagnostic names the point where it was found.

use crate::bound::{Extent, spread};
use crate::diagnostic::{CheckKind, Diagnostic, FormattedNumber, Subject, any_error};
use crate::domain::Domain;
use crate::expr::value::{EvaluationPoint, LazyEvaluator};
use crate::expr::{Id, Node};
use crate::formula::{Curve, CurveIndex, Formula};
use crate::model::{Model, Region};
use crate::regionalise::owners::Owners;
use crate::regionalise::pieces::SampledPiece;
use crate::resolve::{never_wins, off_tip, overlapping};
use crate::source::Span;
use laws::{Divisor, MagnitudeSlope};
use std::cell::RefCell;

mod laws;

/// The number of sample points.
const SAMPLES: usize = 12_000;
/// The number of segments from the inside to the outside along which the surface is sought.
const SURFACE_SEGMENTS: usize = 1_500;
/// The number of columns in which the tool's end is sought, and of steps in each.
const COLUMNS: i32 = 100;
/// The number of passes, each with columns ten times closer than the last.
const REFINEMENT_PASSES: usize = 4;
/// The height of the strip, relative to the tool's size, in which a tool's end is also sought just above its
/// bounding box's lower side.
const STRIP_FRACTION: f64 = 0.01;
/// The relative size below which lengths are rounding.
const ROUNDING: f64 = 1e-9;
/// The relative size up to which a depth on the surface, or the distance of a tool's end from its tip, is not reported: bisection
/// finds the surface to less.
const TOLERANCE: f64 = 1e-6;
/// A step from the surface that is so much shorter that the slope of a root grows a hundredfold.
const NEAR_SURFACE: f64 = 1e-10;

/// Returns diagnostics for curves that are undefined somewhere around the origin, for a tool whose extent is
/// not known yet.
pub(crate) fn undefined_curves(model: &Model) -> Vec<Diagnostic> {
    let mut diagnostics = Vec::new();
    for power in -20..=20 {
        let size = 2f64.powi(power);
        let extent = Extent::of(model.domain.bounding_cell(size), size);
        // Each size by itself, so that the nearest fault is reported.
        let mut linter = Linter::new(model, &extent);
        for point in spread(model.domain, &extent, 50, 0.0) {
            linter.set_point(point);
            linter.report_undefined_curves(point);
        }
        diagnostics = linter.found;
        if !diagnostics.is_empty() {
            break;
        }
    }
    diagnostics
}

/// Returns all diagnostics of a tool, at most one per location and severity.
pub(crate) fn lint(model: &Model, extent: &Extent, sampled: &[SampledPiece]) -> Vec<Diagnostic> {
    let mut linter = Linter::new(model, extent);
    if let Some(profile) = &model.profile {
        // A profile's regions are known to be correct; only the quantities written in the file need checks.
        linter.check_tip(extent.low, extent);
        let inside = sampled.iter().filter(|sampled| sampled.piece.owner.is_some());
        for ([d, z], _) in inside.flat_map(|sampled| &sampled.points) {
            let point = [*d, 0.0, *z];
            if let Some(owner) = linter.owner(point) {
                linter.check_evaluation(owner, point);
            }
        }
        for inside_directions in laws::inward_directions(&profile.outline) {
            let [at, direction] = inside_directions.map(|[d, z]| [d, 0.0, z]);
            linter.check_toward_surface(at, direction);
        }
        linter.on_axis(extent);
        linter.report_poles();
        linter.report_niceness_range();
        linter.report_slopes();
        return linter.found;
    }
    linter.measure_curves(extent);
    let mut inside = Vec::new();
    let mut outside = Vec::new();
    for point in spread(model.domain, extent, SAMPLES, 0.02) {
        match linter.point(point) {
            Some(_) => inside.push(point),
            None => outside.push(point),
        }
    }
    // Where conditions have no value, the tool's end is unknown.
    if model.domain == Domain::HalfPlane && !linter.undefined {
        let lowest = linter.lowest_inside(extent);
        let end = if linter.reaches_lower_side(extent, lowest) { extent.low } else { lowest };
        linter.check_tip(end, extent);
    }
    linter.report_idle_regions();
    if !any_error(&linter.found) {
        // Steps without a common factor pair points from all over.
        let pairs = inside.iter().cycle().step_by(7).zip(outside.iter().cycle().step_by(5));
        for (a, b) in pairs.take(if outside.is_empty() { 0 } else { SURFACE_SEGMENTS }) {
            linter.check_crossing(*a, *b);
        }
        if model.domain == Domain::HalfPlane {
            linter.on_axis(extent);
        }
        linter.report_poles();
        linter.report_niceness_range();
        linter.report_slopes();
    }
    linter.found
}

struct Linter<'m> {
    model: &'m Model,
    size: f64,
    /// Computes what is asked for at the current point; most points are asked for the signs of a few curves only.
    evaluator: RefCell<LazyEvaluator<'m>>,
    /// The owners of a profile's points; `None` for regions by hand.
    owners: Option<Owners<'m>>,
    /// The region that was last found by [`Linter::is_inside`].
    last_region: usize,
    found: Vec<Diagnostic>,
    owned_points: Vec<usize>,
    holds: Vec<usize>,
    /// The owners of points that satisfy this region's conditions too.
    owners_instead: Vec<Vec<usize>>,
    /// True if a curve is undefined somewhere.
    undefined: bool,
    /// The largest absolute value of each curve.
    scales: Vec<f64>,
    /// The largest absolute magnitude and niceness of each region at the sample points.
    largest: Vec<[f64; 2]>,
    /// The point of each region with the largest niceness, and that value.
    nicest: Vec<Option<([f64; 3], f64)>>,
    /// The divisors of magnitudes and nicenesses.
    divisors: Vec<Divisor>,
    /// The slopes of each region's own magnitude.
    slopes: Vec<MagnitudeSlope>,
}

impl<'m> Linter<'m> {
    fn new(model: &'m Model, extent: &Extent) -> Linter<'m> {
        Linter {
            model,
            size: extent.scale(),
            evaluator: RefCell::new(LazyEvaluator::new(
                &model.graph,
                model.roots().chain(model.regions.iter().flat_map(|r| r.outputs.gradient)),
            )),
            owners: model.profile.as_ref().map(Owners::new),
            last_region: 0,
            found: Vec::new(),
            owned_points: vec![0; model.regions.len()],
            holds: vec![0; model.regions.len()],
            owners_instead: vec![Vec::new(); model.regions.len()],
            undefined: false,
            scales: vec![0.0; model.curves.len()],
            largest: vec![[0.0; 2]; model.regions.len()],
            nicest: vec![None; model.regions.len()],
            divisors: laws::divisors(model),
            slopes: vec![MagnitudeSlope::default(); model.regions.len()],
        }
    }

    /// Measures the largest absolute values of the curves.
    fn measure_curves(&mut self, extent: &Extent) {
        for point in spread(self.model.domain, extent, 500, 0.02) {
            self.set_point(point);
            for curve in 0..self.scales.len() {
                let size = self.value(curve).abs();
                // An undefined value is reported elsewhere.
                if size.is_finite() {
                    self.scales[curve] = self.scales[curve].max(size);
                }
            }
        }
    }

    /// Selects a point.
    fn set_point(&mut self, [x, y, z]: [f64; 3]) {
        self.evaluator.get_mut().set(EvaluationPoint::new(x, y, z));
    }

    /// Returns the value of one of the model's roots at the current point.
    fn get(&self, id: Id) -> f64 {
        self.evaluator.borrow_mut().get(id)
    }

    fn format_point(&self, [x, y, z]: [f64; 3]) -> String {
        // A coordinate that is rounding relative to the tool's size is shown as 0.
        let point = [x, y, self.model.frame.to_file(z)]
            .map(|v| if v.abs() < ROUNDING * self.size { 0.0 } else { v });
        self.model.domain.format_point(point)
    }

    /// Reports at most one diagnostic per location and severity.
    fn report(&mut self, diagnostic: Diagnostic) {
        if !self
            .found
            .iter()
            .any(|r| r.span == diagnostic.span && r.severity == diagnostic.severity)
        {
            self.found.push(diagnostic);
        }
    }

    fn value(&self, curve: CurveIndex) -> f64 {
        self.get(self.model.curves[curve].value)
    }

    /// Returns whether the current point satisfies a region's conditions.
    fn is_in_region(&mut self, region: usize) -> bool {
        let (model, evaluator) = (self.model, self.evaluator.get_mut());
        let mut value = |curve: CurveIndex| evaluator.get(model.curves[curve].value);
        model.regions[region].condition.holds(&mut value)
    }

    fn owner(&mut self, point: [f64; 3]) -> Option<usize> {
        self.set_point(point);
        let Some(owners) = &self.owners else {
            return (0..self.model.regions.len()).find(|region| self.is_in_region(*region));
        };
        let [x, y, z] = point;
        let (model, evaluator) = (self.model, self.evaluator.get_mut());
        let mut value = |curve: CurveIndex| evaluator.get(model.curves[curve].value);
        owners.region_at([(x * x + y * y).sqrt(), z], &mut value)
    }

    /// Returns whether some region has a point.
    fn is_inside(&mut self, point: [f64; 3]) -> bool {
        self.set_point(point);
        // In a search for the surface, the last region that had a point mostly has the next one too.
        if self.is_in_region(self.last_region) {
            return true;
        }
        let region = (0..self.model.regions.len()).find(|region| self.is_in_region(*region));
        self.last_region = region.unwrap_or(self.last_region);
        region.is_some()
    }

    /// Returns the lowest z found inside.
    fn lowest_inside(&mut self, extent: &Extent) -> f64 {
        let mut lowest = (f64::INFINITY, 0.0);
        let steps = (extent.high - extent.low) / f64::from(COLUMNS);
        let at = |step: i32| extent.low + steps * f64::from(step);
        // The first pass covers all columns; the others refine around the one that extends farthest.
        let mut width = extent.radius / f64::from(COLUMNS);
        let mut columns = 0..=COLUMNS;
        let mut from = 0.0;
        for _ in 0..REFINEMENT_PASSES {
            for column in columns {
                let d: f64 = from + width * f64::from(column);
                let point = |z: f64| [d.max(0.0), 0.0, z];
                let inside = (0..=COLUMNS).find(|step| self.is_inside(point(at(*step))));
                let Some(step) = inside else { continue };
                // One step lower is outside, or below the box.
                let (mut inside_z, mut outside_z) = (at(step), at(step - 1));
                for _ in 0..50 {
                    let middle = inside_z / 2.0 + outside_z / 2.0;
                    if self.is_inside(point(middle)) {
                        inside_z = middle;
                    } else {
                        outside_z = middle;
                    }
                }
                if inside_z < lowest.0 {
                    lowest = (inside_z, d);
                }
            }
            from = lowest.1;
            width /= 10.0;
            columns = -10..=10;
        }
        lowest.0
    }

    /// Returns whether some part that is too small for the columns extends well below the lowest point found,
    /// near the lower side of the bounding box.
    fn reaches_lower_side(&mut self, extent: &Extent, found: f64) -> bool {
        let lowest = Extent { high: extent.low + STRIP_FRACTION * self.size, ..*extent };
        extent.low < found - STRIP_FRACTION * self.size
            && spread(self.model.domain, &lowest, SAMPLES, 0.0).any(|p| self.is_inside(p))
    }

    /// Reports a tool whose end is not its tip, at z = 0.
    fn check_tip(&mut self, end: f64, extent: &Extent) {
        if end.is_finite() && end.abs() > TOLERANCE * self.size {
            self.found.push(off_tip(&self.model.frame, [end, extent.high]));
        }
    }

    /// Checks one point, and returns its owner.
    fn point(&mut self, point: [f64; 3]) -> Option<usize> {
        self.set_point(point);
        self.report_undefined_curves(point);
        let claims: Vec<usize> =
            (0..self.model.regions.len()).filter(|region| self.is_in_region(*region)).collect();
        let owner = claims.first().copied();
        let value = |curve: CurveIndex| self.value(curve);
        // Neighbours share their border, so only points clearly in both count as an overlap.
        let is_well_inside =
            |r: usize| holds_with_margin(&self.model.regions[r].condition, &value, &self.scales);
        let overlap = match claims.as_slice() {
            [first, second, ..] if is_well_inside(*first) && is_well_inside(*second) => {
                Some((*first, *second))
            }
            _ => None,
        };
        for claim in &claims {
            self.holds[*claim] += 1;
            let by = owner
                .filter(|owner| owner != claim && !self.owners_instead[*claim].contains(owner));
            self.owners_instead[*claim].extend(by);
        }
        if let Some((first, second)) = overlap {
            let (a, b) = (&self.model.regions[first], &self.model.regions[second]);
            let diagnostic =
                overlapping(&a.name, &b.name, b.span, self.format_point(point), a.span);
            self.report(diagnostic);
        }
        let owner = owner?;
        self.owned_points[owner] += 1;
        self.check_evaluation(owner, point);
        Some(owner)
    }

    /// Reports invalid values at a point.
    fn check_evaluation(&mut self, owner: usize, point: [f64; 3]) {
        let region = &self.model.regions[owner];
        self.measure(owner, point);
        let name = &region.name;
        let location = || self.format_point(point);
        let get = |id: Id| self.get(id);
        let spans = region.law_spans;
        let laws = [
            ("depth", region.depth, spans.depth, self.size * ROUNDING),
            ("magnitude", region.magnitude, spans.magnitude, ROUNDING),
            ("niceness", region.niceness, spans.niceness, f64::INFINITY),
        ];
        for (quantity, id, span, slack) in laws {
            let value = get(id);
            let diagnostic = if !value.is_finite() {
                self.not_finite(owner, quantity, id, span, location())
            } else if value < -slack {
                let (region, value, location) = (name.clone(), FormattedNumber(value), location());
                Diagnostic::new(
                    span,
                    CheckKind::NegativeQuantity { quantity, region, value, location },
                )
            } else {
                continue;
            };
            return self.report(diagnostic);
        }
        let direction = region.raw_direction.0.map(get);
        if !direction.into_iter().all(f64::is_finite) || direction == [0.0; 3] {
            let kind =
                CheckKind::ZeroDirectionAtPoint { region: name.clone(), location: location() };
            return self.report(Diagnostic::new(region.raw_direction.1, kind));
        }
        let [x, y, z] = region.direction.map(get);
        let length_error = (x.hypot(y).hypot(z) - 1.0).abs();
        if length_error.is_nan() || length_error > ROUNDING {
            let kind = CheckKind::DirectionTooLong { region: name.clone(), location: location() };
            self.report(Diagnostic::new(region.raw_direction.1, kind));
        }
    }

    /// Reports curves that have no value, and therefore no side, at a point.
    fn report_undefined_curves(&mut self, point: [f64; 3]) {
        for curve in 0..self.model.curves.len() {
            if self.value(curve).is_finite() {
                continue;
            }
            self.undefined = true;
            let Curve { name, value } = &self.model.curves[curve];
            let subject = match name {
                Some(name) => Subject::Curve(name.clone()),
                None => Subject::Condition,
            };
            let kind = self.fault(*value).kind(self.format_point(point), subject, true);
            self.report(Diagnostic::new(self.reader_of(curve), kind));
        }
    }

    /// Returns the location of a region whose conditions mention a curve.
    fn reader_of(&self, curve: CurveIndex) -> Span {
        self.model
            .regions
            .iter()
            .find(|region| region.condition.curves().contains(&curve))
            .map_or(self.model.name_span, |region| region.span)
    }

    fn report_idle_regions(&mut self) {
        for (index, region) in self.model.regions.iter().enumerate() {
            if self.owned_points[index] > 0 {
                continue;
            }
            let winners: Vec<&Region> = self.owners_instead[index]
                .iter()
                .map(|other| &self.model.regions[*other])
                .collect();
            let diagnostic = match winners.as_slice() {
                [first, more @ ..] if self.holds[index] > 2 => {
                    // This error replaces the reports of its overlaps.
                    self.found.retain(|diagnostic| diagnostic.span != region.span);
                    never_wins(&region.name, region.span, &first.name, first.span, more.len())
                }
                _ => {
                    let kind =
                        CheckKind::NoSamplePoint { region: region.name.clone(), samples: SAMPLES };
                    Diagnostic::new(region.span, kind)
                }
            };
            self.found.push(diagnostic);
        }
    }

    /// Checks that depth is 0 where the segment from an inside point to an outside point meets the surface.
    fn check_crossing(&mut self, inside: [f64; 3], outside: [f64; 3]) {
        let (mut inside_fraction, mut outside_fraction) = (0.0, 1.0);
        let at = |t: f64| [0, 1, 2].map(|k| inside[k] + (outside[k] - inside[k]) * t);
        for _ in 0..50 {
            let middle = (inside_fraction + outside_fraction) / 2.0;
            if self.is_inside(at(middle)) {
                inside_fraction = middle;
            } else {
                outside_fraction = middle;
            }
        }
        let point = at(inside_fraction);
        let Some(owner) = self.owner(point) else { return };
        let region = &self.model.regions[owner];
        let depth = self.get(region.depth);
        if depth.abs() > TOLERANCE * self.size {
            let diagnostic = deep_on_surface(region, depth, self.format_point(point));
            self.report(diagnostic);
            return;
        }
        let outward = [0, 1, 2].map(|k| outside[k] - inside[k]);
        let relative_length = norm(outward) / self.size;
        let mut slope = |step: f64| {
            let inner_point = at((inside_fraction - step / relative_length).max(0.0));
            let is_same_owner = self.owner(inner_point) == Some(owner);
            is_same_owner.then(|| self.get(region.depth) / (step * self.size))
        };
        // The slope of a root grows a hundredfold here; a finite one does not.
        if let (Some(near), Some(far)) = (slope(NEAR_SURFACE), slope(TOLERANCE))
            && near > 10.0 * far.max(100.0)
        {
            let kind = CheckKind::SteepDepth {
                region: region.name.clone(),
                location: self.format_point(point),
            };
            self.report(Diagnostic::new(region.law_spans.depth, kind));
        }
        self.check_toward_surface(point, outward.map(|part| -part));
    }
}

fn norm([x, y, z]: [f64; 3]) -> f64 {
    x.hypot(y).hypot(z)
}

/// Returns the error for a nonzero depth on the surface.
pub(crate) fn deep_on_surface(region: &Region, depth: f64, location: String) -> Diagnostic {
    let (name, depth) = (region.name.clone(), FormattedNumber(depth));
    Diagnostic::new(
        region.law_spans.depth,
        CheckKind::NonzeroDepthOnSurface { region: name, depth, location },
    )
}

/// Returns whether a formula holds with a margin, relative to each curve's largest values.
fn holds_with_margin(
    formula: &Formula,
    value: &impl Fn(CurveIndex) -> f64,
    scales: &[f64],
) -> bool {
    formula.holds(&mut |curve| {
        let value = value(curve);
        // A value near 0 is on no side.
        if value.abs() < ROUNDING * scales[curve] { f64::NAN } else { value }
    })
}

/// The reason why a value is not a finite number.
enum Fault {
    Root,
    Quotient,
    Size,
}

impl Linter<'_> {
    /// Returns the reason why one of the model's roots is not finite at the current point: the first operation, from the
    /// operands up, whose result is not.
    fn fault(&self, mut id: Id) -> Fault {
        // The root's operands are computed with it.
        self.get(id);
        loop {
            let node = self.model.graph.node(id);
            let operands: Vec<Id> = match *node {
                Node::Select { low, high, then, other } => {
                    let [low, high] = [low, high].map(|id| self.get(id));
                    vec![if low <= high { then } else { other }]
                }
                _ => node.operands().collect(),
            };
            match operands.into_iter().find(|id| !self.get(*id).is_finite()) {
                Some(operand) => id = operand,
                None => {
                    return match *node {
                        Node::Sqrt(_) => Fault::Root,
                        Node::Div(_, by) if self.get(by) == 0.0 => Fault::Quotient,
                        _ => Fault::Size,
                    };
                }
            }
        }
    }
}

impl Fault {
    /// Returns the diagnostic for an expression that has no value at a point.
    fn kind(&self, location: String, subject: Subject, by_hand: bool) -> CheckKind {
        match self {
            Fault::Root => CheckKind::RootOfNegative { location, subject },
            Fault::Quotient => CheckKind::DivisionByZero { location, subject, by_hand },
            Fault::Size => CheckKind::NumericOverflow { location, subject },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::library;

    #[test]
    fn a_point_is_inside_if_it_has_an_owner() {
        for tool in library::tools_by_hand() {
            let mut linter = Linter::new(&tool.model, &tool.extent);
            for point in spread(tool.model.domain, &tool.extent, 3000, 0.1) {
                assert_eq!(linter.is_inside(point), linter.owner(point).is_some(), "{point:?}");
            }
        }
    }
}
