//! Looks for what is wrong with a tool at many points of its domain: regions that overlap, are
//! never reached or say nonsense. What is found comes with the point where it was found.

mod fault;
mod laws;

use crate::bound::Extent;
use crate::bound::spread;
use crate::diagnostic::{CheckKind, Diagnostic, Figure, Subject, any_error};
use crate::domain::Domain;
use crate::expr::Id;
use crate::expr::value::{At, Evaluator};
use crate::formula::{Curve, CurveIndex, Formula};
use crate::model::{Model, Region};
use crate::resolve::{never_wins, off_tip, overlapping};
use crate::source::Span;
use fault::Fault;

/// Points that are looked at.
const POINTS: usize = 12_000;
/// Ways from the inside to the outside along which the surface is sought.
const CROSSINGS: usize = 1_500;
/// Columns in which the tool's end is sought, and steps of each.
const COLUMNS: i32 = 100;
/// How often they are then drawn ten times closer.
const FINER: usize = 4;
/// Where a tool's end is looked for once more above the box about it, as a part of its size.
const STRIP: f64 = 0.01;
/// Lengths below this part of the tool's size are rounding.
const ROUNDING: f64 = 1e-9;

/// Curves that are undefined somewhere about the origin, for a tool of which nothing
/// else is known yet.
pub(crate) fn undefined(model: &Model) -> Vec<Diagnostic> {
    let mut diagnostics = Vec::new();
    for power in -20..=20 {
        let size = 2f64.powi(power);
        let around = Extent::of(model.domain.whole(size), size);
        let mut look = Look::new(model, &around);
        for point in spread(model.domain, &around, 50, 0.0) {
            look.go(point);
            look.undefined_curves(point);
        }
        diagnostics = look.found;
        if !diagnostics.is_empty() {
            break;
        }
    }
    diagnostics
}

/// Everything that is found, each kind once a region.
pub(crate) fn look(model: &Model, extent: &Extent) -> Vec<Diagnostic> {
    let mut look = Look::new(model, extent);
    if let Some(section) = &model.section {
        // The regions are known; only what is felt in them was written.
        look.tip(extent.low, extent);
        for cell in section.inner.cells(1) {
            for (p, _) in &cell.samples {
                let point = [p[0], 0.0, p[1]];
                if let Some(owner) = look.owner(point) {
                    look.felt(owner, point);
                }
            }
        }
        for beside in laws::beside(&section.outline) {
            let [at, way] = beside.map(|[d, z]| [d, 0.0, z]);
            look.toward_surface(at, way);
        }
        look.on_axis(extent);
        return look.found;
    }
    look.scale(extent);
    let mut inside = Vec::new();
    let mut outside = Vec::new();
    for point in spread(model.domain, extent, POINTS, 0.02) {
        match look.point(point) {
            Some(_) => inside.push(point),
            None => outside.push(point),
        }
    }
    // Where conditions have no value, nobody knows where the tool ends.
    if model.domain == Domain::HalfPlane && !look.undefined {
        let found = look.end(extent);
        let end = if look.reaches(extent, found) { extent.low } else { found };
        look.tip(end, extent);
    }
    look.idle_regions();
    if !any_error(&look.found) {
        let pairs = inside.iter().cycle().step_by(7).zip(outside.iter().cycle().step_by(5));
        for (a, b) in pairs.take(if outside.is_empty() { 0 } else { CROSSINGS }) {
            look.crossing(*a, *b);
        }
        if model.domain == Domain::HalfPlane {
            look.on_axis(extent);
        }
    }
    look.found
}

struct Look<'m> {
    model: &'m Model,
    size: f64,
    evaluator: Evaluator<'m>,
    found: Vec<Diagnostic>,
    wins: Vec<usize>,
    holds: Vec<usize>,
    /// Who own points that this region would have had.
    beaten: Vec<Vec<usize>>,
    /// Whether a curve has no value somewhere.
    undefined: bool,
    /// The largest value of each curve.
    scales: Vec<f64>,
    /// The largest magnitude and niceness of each region at the points looked at.
    largest: Vec<[f64; 2]>,
}

impl<'m> Look<'m> {
    fn new(model: &'m Model, extent: &Extent) -> Look<'m> {
        let roots = model
            .regions
            .iter()
            .flat_map(|r| {
                [r.depth, r.magnitude, r.niceness].into_iter().chain(r.course.0).chain(r.direction)
            })
            .chain(model.curves.iter().map(|curve| curve.value));
        Look {
            model,
            size: extent.scale(),
            evaluator: Evaluator::new(&model.graph, roots),
            found: Vec::new(),
            wins: vec![0; model.regions.len()],
            holds: vec![0; model.regions.len()],
            beaten: vec![Vec::new(); model.regions.len()],
            undefined: false,
            scales: vec![0.0; model.curves.len()],
            largest: vec![[0.0; 2]; model.regions.len()],
        }
    }

    /// Measures the curves.
    fn scale(&mut self, extent: &Extent) {
        for point in spread(self.model.domain, extent, 500, 0.02) {
            self.go(point);
            for curve in 0..self.scales.len() {
                let size = self.value(curve).abs();
                if size.is_finite() {
                    self.scales[curve] = self.scales[curve].max(size);
                }
            }
        }
    }

    /// Moves to a point.
    fn go(&mut self, [x, y, z]: [f64; 3]) {
        self.evaluator.set(At::point(x, y, z));
    }

    fn place(&self, [x, y, z]: [f64; 3]) -> String {
        // What is rounding beside the tool's size is 0.
        let tidy = |v: f64| if v.abs() < ROUNDING * self.size { 0.0 } else { v };
        self.model.domain.shown([x, y, self.model.frame.to_file(z)].map(tidy))
    }

    /// Reports something once a place of the text.
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
        self.evaluator.get(self.model.curves[curve].value)
    }

    fn owner(&mut self, point: [f64; 3]) -> Option<usize> {
        self.go(point);
        let value = |curve: CurveIndex| self.value(curve);
        self.model.regions.iter().position(|region| region.inside.holds(&value))
    }

    /// The lowest point found inside.
    fn end(&mut self, extent: &Extent) -> f64 {
        let mut end = (f64::INFINITY, 0.0);
        let steps = (extent.high - extent.low) / f64::from(COLUMNS);
        let at = |step: i32| extent.low + steps * f64::from(step);
        // Once about all columns, then finely about the one that reaches farthest.
        let mut width = extent.radius / f64::from(COLUMNS);
        let mut columns = 0..=COLUMNS;
        let mut from = 0.0;
        for _ in 0..FINER {
            for column in columns {
                let d: f64 = from + width * f64::from(column);
                let point = |z: f64| [d.max(0.0), 0.0, z];
                let inside = (0..=COLUMNS).find(|step| self.owner(point(at(*step))).is_some());
                let Some(step) = inside else { continue };
                let (mut good, mut bad) = (at(step), at(step - 1));
                for _ in 0..50 {
                    let middle = good / 2.0 + bad / 2.0;
                    if self.owner(point(middle)).is_some() { good = middle } else { bad = middle }
                }
                if good < end.0 {
                    end = (good, d);
                }
            }
            from = end.1;
            width /= 10.0;
            columns = -10..=10;
        }
        end.0
    }

    /// Whether something ends well below what was found to be the tool's end, where the box about it does: too small
    /// for columns to meet it.
    fn reaches(&mut self, extent: &Extent, found: f64) -> bool {
        let lowest = Extent { high: extent.low + STRIP * self.size, ..*extent };
        extent.low < found - STRIP * self.size
            && spread(self.model.domain, &lowest, POINTS, 0.0).any(|p| self.owner(p).is_some())
    }

    /// The tool's end is its tip, which is at 0.
    fn tip(&mut self, end: f64, extent: &Extent) {
        if end.is_finite() && end.abs() > 1e-6 * self.size {
            self.found.push(off_tip(&self.model.frame, [end, extent.high]));
        }
    }

    /// Looks at one point; its owner comes back.
    fn point(&mut self, point: [f64; 3]) -> Option<usize> {
        let owner = self.owner(point);
        self.undefined_curves(point);
        let value = |curve: CurveIndex| self.value(curve);
        let claims: Vec<usize> = (0..self.model.regions.len())
            .filter(|r| self.model.regions[*r].inside.holds(&value))
            .collect();
        let deep = |r: usize| inner(&self.model.regions[r].inside, &value, &self.scales);
        let overlap = match claims.as_slice() {
            [first, second, ..] if deep(*first) && deep(*second) => Some((*first, *second)),
            _ => None,
        };
        for claim in &claims {
            self.holds[*claim] += 1;
            let by = owner.filter(|owner| owner != claim && !self.beaten[*claim].contains(owner));
            self.beaten[*claim].extend(by);
        }
        if let Some((first, second)) = overlap {
            let (a, b) = (&self.model.regions[first], &self.model.regions[second]);
            let diagnostic = overlapping(&a.name, (&b.name, b.span), self.place(point), a.span);
            self.report(diagnostic);
        }
        let owner = owner?;
        self.wins[owner] += 1;
        self.felt(owner, point);
        Some(owner)
    }

    /// Values that make no sense.
    fn felt(&mut self, owner: usize, point: [f64; 3]) {
        let region = &self.model.regions[owner];
        self.measure(owner);
        let (name, place) = (&region.name, self.place(point));
        let get = |id: Id| self.evaluator.get(id);
        let said = region.said;
        let sayings = [
            ("depth", region.depth, said.depth, self.size * ROUNDING),
            ("magnitude", region.magnitude, said.magnitude, ROUNDING),
            ("niceness", region.niceness, said.niceness, f64::INFINITY),
        ];
        for (quantity, id, span, slack) in sayings {
            let value = get(id);
            let diagnostic = if !value.is_finite() {
                self.no_number(owner, (quantity, id, span), place)
            } else if value < -slack {
                let (region, value) = (name.clone(), Figure(value));
                Diagnostic::new(span, CheckKind::Negative { quantity, region, value, place })
            } else {
                continue;
            };
            return self.report(diagnostic);
        }
        let course = region.course.0.map(get);
        if !course.into_iter().all(f64::is_finite) || course == [0.0; 3] {
            let kind = CheckKind::DirectionVanishes { region: name.clone(), place };
            return self.report(Diagnostic::new(region.course.1, kind));
        }
        let [x, y, z] = region.direction.map(get);
        let off = (x.hypot(y).hypot(z) - 1.0).abs();
        if off.is_nan() || off > 1e-9 {
            let kind = CheckKind::DirectionTooLong { region: name.clone(), place };
            self.report(Diagnostic::new(region.course.1, kind));
        }
    }

    /// Curves that have no value somewhere have no side there.
    fn undefined_curves(&mut self, point: [f64; 3]) {
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
            let fault = Fault::of(&self.model.graph, &self.evaluator, *value);
            let kind = fault.kind(self.place(point), subject);
            self.report(Diagnostic::new(self.reader_of(curve), kind));
        }
    }

    /// A region whose conditions read a curve.
    fn reader_of(&self, curve: CurveIndex) -> Span {
        let reads = |region: &&Region| mentions(&region.inside, curve);
        self.model.regions.iter().find(reads).map_or(self.model.name_span, |region| region.span)
    }

    fn idle_regions(&mut self) {
        for (index, region) in self.model.regions.iter().enumerate() {
            if self.wins[index] > 0 {
                continue;
            }
            let by: Vec<&Region> =
                self.beaten[index].iter().map(|other| &self.model.regions[*other]).collect();
            let diagnostic = match by.as_slice() {
                [first, more @ ..] if self.holds[index] > 2 => {
                    // That it overlaps them was said of it.
                    self.found.retain(|diagnostic| diagnostic.span != region.span);
                    never_wins(&region.name, region.span, (&first.name, first.span), more.len())
                }
                _ => {
                    let kind =
                        CheckKind::NoPointSeen { region: region.name.clone(), points: POINTS };
                    Diagnostic::new(region.span, kind)
                }
            };
            self.found.push(diagnostic);
        }
    }

    /// The depth is 0 where the way from an inside to an outside point meets the surface.
    fn crossing(&mut self, inside: [f64; 3], outside: [f64; 3]) {
        let (mut good, mut bad) = (0.0, 1.0);
        let at = |t: f64| [0, 1, 2].map(|k| inside[k] + (outside[k] - inside[k]) * t);
        for _ in 0..50 {
            let middle = (good + bad) / 2.0;
            if self.owner(at(middle)).is_some() { good = middle } else { bad = middle }
        }
        let point = at(good);
        let Some(owner) = self.owner(point) else { return };
        let region = &self.model.regions[owner];
        let depth = self.evaluator.get(region.depth);
        if depth.abs() > 1e-6 * self.size {
            let diagnostic = deep_on_the_surface(region, depth, self.place(point));
            self.report(diagnostic);
            return;
        }
        let away = [0, 1, 2].map(|k| outside[k] - inside[k]);
        let way = norm(away) / self.size;
        let mut slope = |step: f64| {
            let behind = at((good - step / way).max(0.0));
            let same = self.owner(behind) == Some(owner);
            same.then(|| self.evaluator.get(region.depth) / (step * self.size))
        };
        // A root's slope grows a hundredfold here, a finite one stays.
        if let (Some(near), Some(far)) = (slope(1e-10), slope(1e-6))
            && near > 10.0 * far.max(100.0)
        {
            let kind =
                CheckKind::SteepDepth { region: region.name.clone(), place: self.place(point) };
            self.report(Diagnostic::new(region.said.depth, kind));
        }
        self.toward_surface(point, away.map(|part| -part));
    }
}

fn norm([x, y, z]: [f64; 3]) -> f64 {
    x.hypot(y).hypot(z)
}

/// A depth where the solid ends.
pub(crate) fn deep_on_the_surface(region: &Region, depth: f64, place: String) -> Diagnostic {
    let (name, depth) = (region.name.clone(), Figure(depth));
    Diagnostic::new(region.said.depth, CheckKind::DeepOnSurface { region: name, depth, place })
}

/// Whether a formula holds with room to spare, measured by each curve's largest values.
fn inner(formula: &Formula, value: &impl Fn(CurveIndex) -> f64, scales: &[f64]) -> bool {
    formula.holds(&|curve| {
        let value = value(curve);
        // What is nearly 0 is on no side.
        if value.abs() < ROUNDING * scales[curve] { f64::NAN } else { value }
    })
}

fn mentions(formula: &Formula, wanted: CurveIndex) -> bool {
    match formula {
        Formula::Const(_) => false,
        Formula::Atom { curve, .. } => *curve == wanted,
        Formula::All(parts) | Formula::Any(parts) => {
            parts.iter().any(|part| mentions(part, wanted))
        }
    }
}
