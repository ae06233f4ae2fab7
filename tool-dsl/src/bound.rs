//! Where the solid can be, proved by interval branch and bound: how far it reaches, and its
//! largest radius over stretches of the axis. The runtime skips whatever these rule out.

use crate::expr::interval::{Cell, Encloser, Interval};
use crate::expr::polynomial::Polynomial;
use crate::formula::{ANY, NEGATIVE, POSITIVE, Signs, ZERO};
use crate::model::Model;
use crate::plan::empty::{Beyond, Void};
use crate::regionalise::outline;
use crate::report::Report;

/// The largest coordinate, 2^300.
const LIMIT: f64 = 2.037035976334486e90;
/// Boxes that one question may take: enough for a few percent where the expression mentions a
/// coordinate several times, for rounding where it does so once.
const BUDGET: usize = 100;
/// The most slabs of an envelope.
const SLABS: usize = 12;

/// A stretch of the axis with the largest radius that the solid has there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slab {
    /// The lower end, in the tool's frame.
    pub low: f64,
    /// The upper end.
    pub high: f64,
    /// No point of the solid with a z between the ends is farther from the axis.
    pub radius: f64,
}

impl Slab {
    /// Its area in the section: what the merging and halving of slabs weigh.
    fn area(&self) -> f64 {
        self.radius * (self.high - self.low)
    }

    /// One slab for two neighbours.
    fn merged(&self, above: &Slab) -> Slab {
        Slab { low: self.low, high: above.high, radius: self.radius.max(above.radius) }
    }
}

/// What a box is to the solid.
#[derive(Clone, Copy, PartialEq)]
enum Place {
    Inside,
    Outside,
    Unknown,
}

/// Asks of boxes whether the solid is there.
pub struct Prover<'m> {
    model: &'m Model,
    encloser: Encloser<'m>,
    signs: Vec<Signs>,
    /// Regions that are not asked about.
    passed_over: Vec<bool>,
}

impl<'m> Prover<'m> {
    /// A prover about a tool.
    pub fn new(model: &'m Model) -> Prover<'m> {
        let values = model.curves.iter().map(|curve| curve.value);
        let encloser = Encloser::new(&model.graph, values);
        Prover {
            model,
            encloser,
            signs: vec![ANY; model.curves.len()],
            passed_over: vec![false; model.regions.len()],
        }
    }

    /// The signs that the curves can have in a box.
    pub fn signs(&mut self, cell: Cell) -> &[Signs] {
        self.encloser.set(cell);
        for (sign, curve) in self.signs.iter_mut().zip(&self.model.curves) {
            *sign = possible(self.encloser.get(curve.value));
        }
        &self.signs
    }

    fn place(&mut self, cell: Cell) -> Place {
        self.signs(cell);
        let mut place = Place::Outside;
        for (region, passed_over) in self.model.regions.iter().zip(&self.passed_over) {
            if *passed_over {
                continue;
            }
            match region.inside.decided(&self.signs) {
                Some(true) => return Place::Inside,
                Some(false) => {}
                None => place = Place::Unknown,
            }
        }
        place
    }

    /// Whether the solid provably does not reach into a box.
    fn empty(&mut self, cell: Cell) -> bool {
        self.empty_within(cell, BUDGET)
    }

    fn empty_within(&mut self, cell: Cell, budget: usize) -> bool {
        let mut open = vec![cell];
        let mut left = budget;
        while let Some(cell) = open.pop() {
            match self.place(cell) {
                Place::Outside => {}
                Place::Inside => return false,
                Place::Unknown if left == 0 => return false,
                Place::Unknown => {
                    left -= 1;
                    open.extend(halves(cell));
                }
            }
        }
        true
    }
}

/// The signs of the numbers in an interval.
fn possible(value: Interval) -> Signs {
    let mut signs = 0;
    if value.low < 0.0 {
        signs |= NEGATIVE;
    }
    if value.low <= 0.0 && value.high >= 0.0 {
        signs |= ZERO;
    }
    if value.high > 0.0 {
        signs |= POSITIVE;
    }
    signs
}

/// A box cut in two across its longer side; a side that spans magnitudes is cut between them.
pub(crate) fn halves(cell: Cell) -> [Cell; 2] {
    let (d, z) = (cell.d, cell.z);
    if d.high - d.low > z.high - z.low {
        let middle = middle(d);
        [Cell { d: Interval::new(d.low, middle), z }, Cell { d: Interval::new(middle, d.high), z }]
    } else {
        let middle = middle(z);
        [Cell { d, z: Interval::new(z.low, middle) }, Cell { d, z: Interval::new(middle, z.high) }]
    }
}

fn middle(side: Interval) -> f64 {
    let (low, high) = (side.low, side.high);
    if low < 0.0 && high > 0.0 && (high > 1e6 || low < -1e6) {
        0.0
    } else if low >= 0.0 && high > 1e3 * (low + 1.0) {
        ((low + 1.0) * high).sqrt()
    } else if high <= 0.0 && low < 1e3 * (high - 1.0) {
        -((1.0 - high) * -low).sqrt()
    } else {
        low / 2.0 + high / 2.0
    }
}

/// How far the solid reaches.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extent {
    /// The lowest z.
    pub low: f64,
    /// The highest z.
    pub high: f64,
    /// The largest distance from the axis.
    pub radius: f64,
}

impl Extent {
    /// The next power of two above the largest coordinate: the S of the accuracy contract.
    pub fn scale(&self) -> f64 {
        let largest = self.radius.max(self.high.abs()).max(self.low.abs());
        let mut scale = 2f64.powi(largest.log2().floor() as i32);
        while scale <= largest {
            scale *= 2.0;
        }
        scale
    }
}

/// The reach of the solid, proved; an error if no bound is found.
pub fn extent(model: &Model) -> Result<Extent, Report> {
    if let Some(section) = &model.section {
        let [low, high] = outline::reach(&section.outline);
        return Ok(Extent { low: low[1], high: high[1], radius: high[0] });
    }
    let mut prover = Prover::new(model);
    let whole = |size: f64| Interval::new(-size, size);
    // Regions that linear curves bound need no boxes: their signs, and whether they are settled.
    let void = Void::new(model);
    let mut settled = vec![false; model.regions.len()];
    let demands: Vec<Vec<Signs>> = model
        .regions
        .iter()
        .map(|region| {
            let mut signs = vec![ANY; model.curves.len()];
            region.inside.demand(&mut signs);
            signs
        })
        .collect();
    let mut beyond = |size: f64| {
        let (far, all) = (Interval::new(size, LIMIT), Interval::new(0.0, LIMIT));
        let cells = [
            (Beyond::Radius(size), Cell { d: far, z: whole(LIMIT) }),
            (Beyond::Above(size), Cell { d: all, z: far }),
            (Beyond::Below(size), Cell { d: all, z: Interval::new(-LIMIT, -size) }),
        ];
        cells.into_iter().all(|(beyond, cell)| {
            for (settled, signs) in settled.iter_mut().zip(&demands) {
                *settled = void.never_beyond(signs, beyond);
            }
            prover.passed_over.clone_from(&settled);
            prover.empty_within(cell, 20 * BUDGET)
        })
    };
    let mut power = 280;
    if !beyond(2f64.powi(power)) {
        return Err(Report::error(
            model.name_span,
            "the regions reach to infinity, as far as can be proved",
        )
        .help("bound every region in d and in z, toward the axis's ends and away from it"));
    }
    for step in [64, 16, 4, 1] {
        while power - step > -280 && beyond(2f64.powi(power - step)) {
            power -= step;
        }
    }
    prover.passed_over.fill(false);
    let size = 2f64.powi(power);
    // From outside inward, as long as the rest stays provably empty.
    let radius =
        inward(size, 0.0, |r| prover.empty(Cell { d: Interval::new(r, size), z: whole(size) }));
    let all = Interval::new(0.0, radius);
    let high = inward(size, -size, |z| prover.empty(Cell { d: all, z: Interval::new(z, size) }));
    let low = inward(-size, size, |z| prover.empty(Cell { d: all, z: Interval::new(-size, z) }));
    // Between its ends the solid is easier to bound than along the whole axis.
    let between = Interval::new(low.min(high), high.max(low));
    let radius =
        inward(radius, 0.0, |r| prover.empty(Cell { d: Interval::new(r, radius), z: between }));
    if low >= high || radius <= 0.0 {
        return Err(Report::error(model.name_span, "no point belongs to this tool")
            .help("the conditions of each region contradict one another"));
    }
    Ok(Extent { low, high, radius })
}

/// The innermost place from `outer` toward `inner` for which `empty` still holds.
fn inward(outer: f64, inner: f64, mut empty: impl FnMut(f64) -> bool) -> f64 {
    let (mut good, mut bad) = (outer, inner);
    for _ in 0..52 {
        let middle = good / 2.0 + bad / 2.0;
        if empty(middle) { good = middle } else { bad = middle }
    }
    good
}

/// The largest radius over stretches of the axis, from the tip up.
pub fn envelope(model: &Model, extent: &Extent) -> Vec<Slab> {
    let mut prover = Prover::new(model);
    let mut slab = |low: f64, high: f64, widest: f64| {
        if let Some(section) = &model.section {
            let radius = outline::radius_between(&section.outline, low, high);
            return Slab { low, high, radius };
        }
        let z = Interval::new(low, high);
        let (mut good, mut bad) = (widest, 0.0);
        for _ in 0..12 {
            let middle = good / 2.0 + bad / 2.0;
            let cell = Cell { d: Interval::new(middle, widest), z };
            if prover.empty(cell) { good = middle } else { bad = middle }
        }
        Slab { low, high, radius: good }
    };
    let mut ends: Vec<f64> = (0..=8)
        .map(|k| extent.low + (extent.high - extent.low) * f64::from(k) / 8.0)
        .chain(levels(model))
        .filter(|z| (extent.low..=extent.high).contains(z))
        .collect();
    ends.sort_by(f64::total_cmp);
    ends.dedup_by(|a, b| *a - *b < 1e-6 * (extent.high - extent.low));
    // Of two ends that are nearly one the later is dropped, but never the last.
    if let Some(last) = ends.last_mut() {
        *last = extent.high;
    }
    let mut slabs: Vec<Slab> =
        ends.windows(2).map(|pair| slab(pair[0], pair[1], extent.radius)).collect();
    // Halve where the halves are slimmer, as long as it saves most.
    let mut halves: Vec<Option<[Slab; 2]>> = vec![None; slabs.len()];
    while slabs.len() < 2 * SLABS {
        for (own, half) in slabs.iter().zip(&mut halves) {
            half.get_or_insert_with(|| {
                let middle = own.low / 2.0 + own.high / 2.0;
                [slab(own.low, middle, own.radius), slab(middle, own.high, own.radius)]
            });
        }
        let saved =
            |i: usize| halves[i].map_or(0.0, |[a, b]| slabs[i].area() - a.area() - b.area());
        let best = (0..slabs.len()).max_by(|&i, &j| saved(i).total_cmp(&saved(j)));
        let Some(best) = best.filter(|&i| saved(i) > 0.01 * slabs[i].area()) else { break };
        let Some([a, b]) = halves[best].take() else { break };
        slabs[best] = a;
        slabs.insert(best + 1, b);
        halves.insert(best + 1, None);
    }
    // Merge the neighbours whose common slab adds least.
    while slabs.len() > 1 {
        let added = |i: usize| {
            slabs[i].merged(&slabs[i + 1]).area() - slabs[i].area() - slabs[i + 1].area()
        };
        let best = (0..slabs.len() - 1).min_by(|&i, &j| added(i).total_cmp(&added(j)));
        let Some(best) = best else { break };
        if slabs.len() <= SLABS && added(best) > 0.001 * slabs[best].area() {
            break;
        }
        slabs[best] = slabs[best].merged(&slabs[best + 1]);
        slabs.remove(best + 1);
    }
    let steps = 10f64.powf(5.0 - extent.scale().log10().floor());
    for slab in &mut slabs {
        slab.low = -above(-slab.low, steps);
        slab.high = above(slab.high, steps);
        slab.radius = above(slab.radius, steps);
    }
    slabs
}

/// A short decimal that is no smaller than a value, in units of which there are `steps` to 1.
fn above(value: f64, steps: f64) -> f64 {
    let count = (value * steps).ceil();
    let short = if steps >= 1.0 { count / steps } else { count * (1.0 / steps) };
    if short >= value { short } else { (count + 1.0) / steps }
}

/// Heights at which the radius may jump.
fn levels(model: &Model) -> Vec<f64> {
    match &model.section {
        Some(section) => section.outline.iter().flat_map(|s| s.ends()).map(|end| end[1]).collect(),
        None => model.curves.iter().filter_map(|curve| level(model, curve.value)).collect(),
    }
}

/// The z of a curve that is a plane across the axis.
fn level(model: &Model, value: crate::expr::Id) -> Option<f64> {
    let polynomial = Polynomial::of(&model.graph, value)?;
    let (mut slope, mut constant) = (None, 0.0);
    for (monomial, factor) in polynomial.terms() {
        match monomial {
            [0, 0, 0, 1] => slope = Some(factor.to_f64()),
            [0, 0, 0, 0] => constant = factor.to_f64(),
            _ => return None,
        }
    }
    slope.map(|slope| -constant / slope)
}
