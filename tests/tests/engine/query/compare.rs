//! One query against brute force, with bounds that follow from rounding alone.
//!
//! **Noise.** Probe and oracle see a point at most `noise` apart: 8 units in the last place of S, the power of two
//! above the tool's largest coordinate (`accuracy.md`, section 1), and 4 of the world's coordinates. Depths and
//! magnitudes may differ by that times their Lipschitz constant (1; √5 for fig. 7.3), directions by that over the
//! distance to where they do not exist. Sums may differ by as much for every point, and by their own rounding.
//!
//! **Doubt.** A point within 1e-12 S (and the noise) of the surface or a splitting curve may be assigned to either
//! side of it. Such points are counted, and widen the bounds by their possible effect; no other point may be
//! missing or belong elsewhere.

use super::brute::{Answer, Query};
use crate::prelude::*;
use std::collections::BTreeMap;
use touchoff::{Contact, TriangleId, Weights, Wrench, summary};
use touchoff_tests::oracle::thesis;

/// Returns the thesis's tools, each with its oracle.
pub(crate) fn tools() -> Vec<(&'static dyn Tool, Box<dyn Oracle>)> {
    thesis().into_iter().map(|oracle| (library::tool(oracle.name()), oracle)).collect()
}

/// Compares each of the [tools] with brute force at a part, with random numbers of its own.
pub(crate) fn check_tools(
    what: &str,
    part: &Part,
    seed: u64,
    mut check: impl FnMut(&mut Case<'_>, &mut Rng),
) {
    for (seed, (tool, oracle)) in (seed..).zip(tools()) {
        let mut case = Case::new(part, tool, &*oracle);
        check(&mut case, &mut Rng::new(seed));
        println!("{what} {}: {:?}", oracle.name(), case.statistics);
    }
}

pub(crate) const LAWS_AND_WEIGHTS: [(Law, Weights); 6] = [
    (Law::Thesis, Weights::Area),
    (Law::Gradient, Weights::Unit),
    (Law::Facing, Weights::Area),
    (Law::Thesis, Weights::Unit),
    (Law::Gradient, Weights::Area),
    (Law::Facing, Weights::Unit),
];

#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Statistics {
    pub(crate) touching: usize,
    pub(crate) contacts: usize,
    /// Number of points that may be assigned to either side.
    pub(crate) doubtful: usize,
    /// Number of points in contact for the probe or the oracle alone.
    pub(crate) disputed: usize,
}

/// A part and a tool. Lengths are in the part's unit.
pub(crate) struct Case<'a> {
    part: &'a Part,
    tool: &'a dyn Tool,
    pub(crate) oracle: &'a dyn Oracle,
    points: Vec<Point3<f64>>,
    normals: Vec<Vector3<f64>>,
    weights: Vec<f64>,
    ones: Vec<f64>,
    /// Per id, the index of its point in the tree.
    indices: Vec<usize>,
    reach: f64,
    /// The part's unit in the oracle's, which is a millimetre; and the units of a magnitude and of its gradient in the
    /// oracle's.
    scale: f64,
    magnitude_unit: f64,
    gradient_unit: f64,
    /// S, and the Lipschitz constant.
    size: f64,
    steep: f64,
    pub(crate) statistics: Statistics,
}

struct Compared<'a> {
    query: Query<'a>,
    answer: Answer,
    wrench: Wrench,
    contacts: Vec<Contact>,
    noise: f64,
    band: f64,
    /// Bound on the difference of magnitudes, and on a law's force per weight and magnitude.
    level: f64,
    push: f64,
}

#[derive(Default)]
struct Bounds {
    force: f64,
    torque: f64,
    integral: f64,
    energy: f64,
    /// True if the least niceness may be that of a point in doubt.
    nice: bool,
}

/// Bound on the difference of two directions, and on the length of a push or of a gradient in the oracle's unit.
const MAX_PUSH: f64 = 2.3;

impl<'a> Case<'a> {
    pub(crate) fn new(part: &'a Part, tool: &'a dyn Tool, oracle: &'a dyn Oracle) -> Case<'a> {
        let tree = part.tree();
        let indices = 0..tree.len();
        let points: Vec<Point3<f64>> = indices.clone().map(|i| tree.point(i)).collect();
        let ids: BTreeMap<TriangleId, usize> =
            indices.clone().map(|i| (tree.triangle(i), i)).collect();
        let expected = (0..tree.len() as u32).map(TriangleId);
        assert!(ids.keys().copied().eq(expected), "an id for every point");
        let scale = part.unit().factor_to(Unit::Millimetre);
        let magnitude_unit = if oracle.magnitude_is_depth() { 1.0 / scale } else { 1.0 };
        let largest = oracle.extent().into_iter().fold(0.0, f64::max);
        Case {
            part,
            tool,
            oracle,
            normals: indices.clone().map(|i| tree.normal(i).into()).collect(),
            weights: indices.map(|i| tree.weight(i)).collect(),
            ones: vec![1.0; points.len()],
            indices: ids.into_values().collect(),
            reach: points.iter().map(|p| p.coords.amax()).fold(0.0, f64::max),
            points,
            scale,
            magnitude_unit,
            gradient_unit: magnitude_unit * scale,
            size: largest.log2().ceil().exp2() / scale,
            steep: if oracle.name() == "Fig73" { 5f64.sqrt() } else { 1.0 },
            statistics: Statistics::default(),
        }
    }

    /// Queries both sides at a pose, with the `k`th combination of law and weights, and compares all results.
    /// Returns the number of points that touch.
    pub(crate) fn check(&mut self, pose: &Pose, k: usize) -> usize {
        // A compliance centre at the tip, up the tool, and beside it.
        let centre = [[0.0; 3], [0.0, 0.0, 1.5], [-2.0, 3.0, 0.7]][k / 6 % 3];
        let centre = Point3::from(centre.map(|c| c / self.scale));
        let (law, weights) = LAWS_AND_WEIGHTS[k % 6];
        let probe = Probe::new(self.part, self.tool).with_law(law).with_weights(weights);
        let mut probe = probe.with_centre(centre);
        let wrench = probe.wrench(pose);
        assert_eq!((wrench.law, wrench.weights), (law, weights));
        assert_eq!(probe.detect(pose), wrench.colliding > 0, "detect at {pose:?}");
        let contacts = probe.contacts(pose).to_vec();
        let mut statistics = self.statistics;
        let compared = self.compared(pose, wrench, contacts, centre);
        self.compare_points(&compared, &mut statistics);
        let bounds = self.bounds(&compared, &mut statistics);
        self.compare_sums(&compared, &bounds);
        assert_consistent(&compared, &bounds);
        statistics.touching += usize::from(wrench.colliding > 0);
        statistics.contacts += wrench.colliding;
        self.statistics = statistics;
        wrench.colliding
    }

    fn compared(
        &self,
        pose: &Pose,
        wrench: Wrench,
        contacts: Vec<Contact>,
        centre: Point3<f64>,
    ) -> Compared<'_> {
        let query = Query {
            oracle: self.oracle,
            pose: *pose,
            scale: self.scale,
            law: wrench.law,
            centre: pose.tip() + pose.rotation() * centre.coords,
            points: &self.points,
            normals: &self.normals,
            weights: match wrench.weights {
                Weights::Area => &self.weights,
                Weights::Unit => &self.ones,
            },
        };
        let world = pose.tip().coords.amax().max(self.reach);
        let noise = f64::EPSILON * (8.0 * self.size + 4.0 * world);
        Compared {
            answer: query.answer(),
            query,
            wrench,
            contacts,
            noise,
            band: 1e-12 * self.size + 2.0 * noise,
            level: self.steep * noise * self.gradient_unit,
            push: MAX_PUSH * if wrench.law == Law::Gradient { self.gradient_unit } else { 1.0 },
        }
    }

    /// Compares the points that touch, one by one; both sides list them in the tree's order.
    fn compare_points(&self, compared: &Compared<'_>, statistics: &mut Statistics) {
        let index = |contact: &Contact| self.indices[contact.triangle.index()];
        assert!(compared.contacts.is_sorted_by_key(index));
        let mut found: BTreeMap<usize, &Contact> =
            compared.contacts.iter().map(|contact| (index(contact), contact)).collect();
        // A point which touches for one side only is on the surface.
        let mut dispute = |i: usize, what: &str| {
            let q = compared.query.to_tool_frame(self.points[i]);
            let distance = self.oracle.signed_distance(q) / self.scale;
            let (name, pose) = (self.oracle.name(), compared.query.pose);
            let is_near = distance.abs() <= compared.band;
            assert!(is_near, "{name}: {q:?} {what}, {distance:e} outside; {pose:?}");
            statistics.disputed += 1;
        };
        for &i in &compared.answer.contacts {
            match found.remove(&i) {
                Some(contact) => self.compare_point(compared, i, contact),
                None => dispute(i, "was not felt"),
            }
        }
        found.into_keys().for_each(|i| dispute(i, "should not be felt"));
    }

    fn compare_point(&self, compared: &Compared<'_>, i: usize, contact: &Contact) {
        let q = compared.query.to_tool_frame(self.points[i]);
        let expected = self.oracle.evaluate(q).expect("a contact");
        let (name, query, noise) = (self.oracle.name(), &compared.query, compared.noise);
        let near = |got: f64, want: f64, bound: f64, what: &str| {
            assert!((got - want).abs() <= bound, "{name} {what} at {q:?}: {got}, not {want}");
        };
        near(contact.depth, expected.depth / self.scale, self.steep * noise, "depth");
        let magnitude = expected.magnitude * self.magnitude_unit;
        near(contact.magnitude, magnitude, compared.level, "magnitude");
        assert!((contact.point - self.points[i]).norm() <= noise);
        assert_eq!(contact.normal, self.normals[i]);
        assert_eq!(contact.weight, query.weights[i]);
        assert_eq!(contact.surface, self.tool.info().regions[contact.region].surface);
        if self.is_in_doubt(compared, q) {
            return;
        }
        assert_eq!(contact.region, expected.owner, "{name} region at {q:?}");
        near(contact.niceness, expected.niceness, 16.0 * noise * self.scale, "niceness");
        let turn = self.turn(compared, q);
        let along = query.to_world_frame(expected.direction);
        near((contact.direction - along).norm(), 0.0, turn, "direction");
        let slope = query.to_world_frame(self.oracle.gradient(q).expect("inside"));
        let slope = self.gradient_unit * slope;
        let bound = self.steep * self.gradient_unit * turn;
        near((contact.gradient - slope).norm(), 0.0, bound, "gradient");
    }

    fn is_in_doubt(&self, compared: &Compared<'_>, q: [f64; 3]) -> bool {
        self.oracle.border_distance(q) / self.scale <= compared.band
    }

    /// Returns the bound on the difference of directions at a point.
    fn turn(&self, compared: &Compared<'_>, q: [f64; 3]) -> f64 {
        let closeness = compared.noise * self.scale / self.oracle.singularity_distance(q);
        (16.0 * f64::EPSILON + 2.0 * closeness).min(MAX_PUSH)
    }

    fn compare_sums(&self, compared: &Compared<'_>, bounds: &Bounds) {
        let (answer, wrench) = (&compared.answer, &compared.wrench);
        let name = self.oracle.name();
        let near = |got: f64, want: f64, bound: f64, what: &str| {
            let is_near = (got - want).abs() <= bound;
            assert!(is_near, "{name} {what}: {got}, not {want} to {bound:e}; {wrench:?}");
        };
        // A point that touches for one side only is no deeper than the band.
        let is_disputed = compared.contacts.len() != answer.contacts.len();
        let slack = if is_disputed { compared.band } else { 0.0 };
        let deeper = self.steep * (self.steep * compared.noise + slack);
        near(wrench.depth(), answer.depth, deeper, "depth");
        near(wrench.integral, answer.integral, bounds.integral, "integral");
        near(wrench.energy, answer.energy, bounds.energy, "energy");
        let force = (wrench.force - answer.force).norm();
        near(force, 0.0, bounds.force, "force");
        let torque = (wrench.torque - answer.torque).norm();
        near(torque, 0.0, bounds.torque, "torque");
        match (wrench.niceness, answer.niceness) {
            (Some(got), Some(want)) if !bounds.nice => {
                near(got, want, 16.0 * compared.noise * self.scale, "niceness");
            }
            (got, want) => assert!(bounds.nice || got == want, "{got:?}, not {want:?}"),
        }
    }

    fn bounds(&self, compared: &Compared<'_>, statistics: &mut Statistics) -> Bounds {
        let Compared { query, noise, level, push, .. } = compared;
        let tip = query.pose.tip();
        let lever = (query.centre - tip).norm();
        let mut bounds = Bounds::default();
        let rounding = f64::EPSILON * (16.0 + compared.answer.contacts.len() as f64 / 4.0);
        for &i in &compared.answer.contacts {
            let p = self.points[i];
            let q = query.to_tool_frame(p);
            let s = self.oracle.evaluate(q).expect("a contact");
            let (w, m) = (query.weights[i], s.magnitude * self.magnitude_unit);
            let turn = self.turn(compared, q);
            let doubt = self.is_in_doubt(compared, q);
            let across = query.to_world_frame(s.direction).dot(&self.normals[i]).abs();
            let dropped = query.law == Law::Facing && across <= 1e-12 + turn;
            let swing = if doubt || dropped { 2.0 * MAX_PUSH } else { turn };
            let force = w * push * (level + m * (swing + rounding));
            let arm = (p - tip).norm() + lever;
            bounds.force += force;
            bounds.torque += arm * force + noise * w * m * push;
            bounds.integral += w * (level + rounding * m);
            bounds.energy += w * (m + level) * (level + rounding * m);
            bounds.nice |= doubt;
            statistics.doubtful += usize::from(doubt);
        }
        // Points that touch for the probe only are hardly inside, if at all.
        if compared.contacts.len() != compared.answer.contacts.len() {
            let weight: f64 = compared.contacts.iter().map(|contact| contact.weight).sum();
            let magnitude = self.steep * compared.band * self.gradient_unit;
            let slight = magnitude * weight.max(1.0) * MAX_PUSH.max(*push);
            bounds.force += slight;
            bounds.torque += slight * (4.0 * self.size + lever);
            bounds.integral += slight;
            bounds.energy += slight;
            bounds.nice = true;
        }
        bounds
    }
}

/// Asserts that wrench and contacts of one probe agree, exactly where nothing is added. `sums` compares forces and torques.
fn assert_consistent(compared: &Compared<'_>, bounds: &Bounds) {
    let (wrench, contacts) = (&compared.wrench, &compared.contacts[..]);
    assert_eq!(contacts.len(), wrench.colliding);
    let depths = summary(contacts, |contact| contact.depth);
    assert_eq!(depths.map(|depths| depths.max), wrench.deepest.map(|deepest| deepest.depth));
    let niceness = summary(contacts, |contact| contact.niceness);
    assert_eq!(niceness.map(|niceness| niceness.min), wrench.niceness);
    if let Some(deepest) = wrench.deepest {
        let first = contacts.iter().find(|contact| contact.depth == deepest.depth);
        let first = first.map(|contact| (contact.point, contact.triangle));
        assert_eq!(first, Some((deepest.point, deepest.triangle)), "the first of the deepest");
    }
    let push = summary(contacts, |contact| contact.weight * contact.magnitude);
    let (sum, mean) = push.map_or((0.0, 0.0), |push| (push.sum, push.mean));
    assert!((sum - wrench.integral).abs() <= bounds.integral, "{sum} {}", wrench.integral);
    assert_eq!(mean, if contacts.is_empty() { 0.0 } else { sum / contacts.len() as f64 });
}
