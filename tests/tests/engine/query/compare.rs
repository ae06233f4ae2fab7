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

use nalgebra::{Point3, Vector3};
use std::collections::BTreeMap;
use touchoff::TriangleId;
use touchoff::{Contact, Law, Part, Pose, Probe, Tool, Weights, Wrench, summary};
use touchoff_tests::library;
use touchoff_tests::oracle::brute::{self, Answer, Query};
use touchoff_tests::oracle::{Oracle, thesis};

/// Returns the thesis's tools, each with its oracle.
pub(crate) fn tools() -> Vec<(&'static dyn Tool, Box<dyn Oracle>)> {
    thesis().into_iter().map(|oracle| (library::tool(oracle.name()), oracle)).collect()
}

/// All laws with all weights.
pub(crate) const LAWS_AND_WEIGHTS: [(Law, Weights); 6] = [
    (Law::Thesis, Weights::Area),
    (Law::Gradient, Weights::Unit),
    (Law::Facing, Weights::Area),
    (Law::Thesis, Weights::Unit),
    (Law::Gradient, Weights::Area),
    (Law::Facing, Weights::Unit),
];

/// Statistics over several poses.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Statistics {
    pub(crate) poses: usize,
    pub(crate) touching: usize,
    pub(crate) contacts: usize,
    /// Number of points that may be assigned to either side.
    pub(crate) doubtful: usize,
    /// Number of points in contact for the probe or the oracle alone.
    pub(crate) disputed: usize,
    /// The largest errors: of depth in ulp(S), of force and torque relative to the sums of their terms' sizes.
    pub(crate) worst: [f64; 3],
}

/// A part and a tool.
pub(crate) struct Case<'a> {
    part: &'a Part,
    tool: &'a dyn Tool,
    oracle: &'a dyn Oracle,
    points: Vec<[f64; 3]>,
    normals: Vec<[f64; 3]>,
    weights: Vec<f64>,
    ones: Vec<f64>,
    /// Per id, the index of its point in the tree.
    indices: Vec<usize>,
    /// The largest coordinate.
    reach: f64,
    /// S, 1 ulp(S) and the Lipschitz constant.
    size: f64,
    ulp: f64,
    steep: f64,
    pub(crate) statistics: Statistics,
}

/// The results of both sides at one pose.
struct CheckedQuery<'a> {
    query: Query<'a>,
    answer: Answer,
    wrench: Wrench,
    contacts: Vec<Contact>,
    noise: f64,
    band: f64,
}

/// Bounds on the differences of sums.
#[derive(Default)]
struct Bounds {
    force: f64,
    torque: f64,
    integral: f64,
    energy: f64,
    /// True if the least niceness may be that of a point in doubt.
    nice: bool,
}

/// Bound on the difference of two directions, and on a law's force per weight and magnitude.
const MAX_FORCE_PER_MAGNITUDE: f64 = 2.3;

impl<'a> Case<'a> {
    pub(crate) fn new(part: &'a Part, tool: &'a dyn Tool, oracle: &'a dyn Oracle) -> Case<'a> {
        let tree = part.tree();
        let indices = 0..tree.len();
        let points: Vec<[f64; 3]> = indices.clone().map(|i| tree.point(i).into()).collect();
        let ids: BTreeMap<TriangleId, usize> =
            indices.clone().map(|i| (tree.triangle(i), i)).collect();
        assert!(
            ids.keys().copied().eq((0..tree.len() as u32).map(TriangleId)),
            "an id for every point"
        );
        let largest = oracle.extent().into_iter().fold(0.0, f64::max);
        let size = largest.log2().ceil().exp2();
        Case {
            part,
            tool,
            oracle,
            normals: indices.clone().map(|i| tree.normal(i)).collect(),
            weights: indices.map(|i| tree.weight(i)).collect(),
            ones: vec![1.0; points.len()],
            indices: ids.into_values().collect(),
            reach: points.iter().flatten().fold(0.0, |m, c| m.max(c.abs())),
            points,
            size,
            ulp: size * f64::EPSILON,
            steep: if oracle.name() == "Fig73" { 5f64.sqrt() } else { 1.0 },
            statistics: Statistics::default(),
        }
    }

    /// Queries both sides at a pose, with the `k`th combination of law and weights, and compares all results.
    /// Returns the number of points that touch.
    pub(crate) fn check(&mut self, pose: &Pose, k: usize) -> usize {
        // A compliance centre at the tip, up the tool, and beside it.
        let centre = [[0.0; 3], [0.0, 0.0, 1.5], [-2.0, 3.0, 0.7]][k / 6 % 3].into();
        let (law, weights) = LAWS_AND_WEIGHTS[k % 6];
        let mut probe = Probe::new(self.part, self.tool)
            .with_law(law)
            .with_weights(weights)
            .with_centre(centre);
        let wrench = probe.wrench(pose);
        assert_eq!((wrench.law, wrench.weights), (law, weights));
        assert_eq!(probe.detect(pose), wrench.colliding > 0, "detect at {pose:?}");
        let contacts = probe.contacts(pose).to_vec();
        let mut statistics = self.statistics;
        let checked_query = self.checked_query(pose, wrench, contacts, centre);
        self.compare_points(&checked_query, &mut statistics);
        let bounds = self.compare_sums(&checked_query, &mut statistics);
        assert_consistent(&checked_query, &bounds);
        statistics.poses += 1;
        statistics.touching += usize::from(wrench.colliding > 0);
        statistics.contacts += wrench.colliding;
        self.statistics = statistics;
        wrench.colliding
    }

    fn checked_query(
        &self,
        pose: &Pose,
        wrench: Wrench,
        contacts: Vec<Contact>,
        centre: Point3<f64>,
    ) -> CheckedQuery<'_> {
        let axes = [0, 1, 2].map(|k| pose.rotation().column(k).into_owned().into());
        let brute_pose = brute::Pose { tip: pose.tip().into(), axes };
        let weights = match wrench.weights {
            Weights::Area => &self.weights,
            Weights::Unit => &self.ones,
        };
        let mut query = Query::new(self.oracle, brute_pose, &self.points, &self.normals, weights);
        query.law = match wrench.law {
            Law::Thesis => brute::Law::Thesis,
            Law::Gradient => brute::Law::Gradient,
            Law::Facing => brute::Law::Facing,
        };
        query.centre = (pose.tip() + pose.rotation() * centre.coords).into();
        let world = pose.tip().coords.amax().max(self.reach);
        let noise = 8.0 * self.ulp + 4.0 * f64::EPSILON * world;
        let band = 1e-12 * self.size + 2.0 * noise;
        CheckedQuery { answer: query.answer(), query, wrench, contacts, noise, band }
    }

    /// Compares the points that touch, one by one; both sides list them in the tree's order.
    fn compare_points(&self, checked_query: &CheckedQuery<'_>, statistics: &mut Statistics) {
        let index = |contact: &Contact| self.indices[contact.triangle.index()];
        assert!(checked_query.contacts.is_sorted_by_key(index));
        let mut evaluation: BTreeMap<usize, &Contact> =
            checked_query.contacts.iter().map(|contact| (index(contact), contact)).collect();
        for &i in &checked_query.answer.contacts {
            let q = checked_query.query.to_tool_frame(self.points[i]);
            match evaluation.remove(&i) {
                Some(contact) => self.compare_point(checked_query, i, q, contact),
                None => self.check_doubtful_point(checked_query, q, "was not felt", statistics),
            }
        }
        for i in evaluation.into_keys() {
            self.check_doubtful_point(
                checked_query,
                checked_query.query.to_tool_frame(self.points[i]),
                "should not be felt",
                statistics,
            );
        }
    }

    /// Asserts that a point which touches for one side only is on the surface.
    fn check_doubtful_point(
        &self,
        checked_query: &CheckedQuery<'_>,
        q: [f64; 3],
        what: &str,
        statistics: &mut Statistics,
    ) {
        let distance = self.oracle.signed_distance(q);
        let (name, pose) = (self.oracle.name(), checked_query.query.pose);
        assert!(
            distance.abs() <= checked_query.band,
            "{name}: {q:?} {what}, {distance:e} outside; {pose:?}"
        );
        statistics.disputed += 1;
    }

    fn compare_point(
        &self,
        checked_query: &CheckedQuery<'_>,
        i: usize,
        q: [f64; 3],
        contact: &Contact,
    ) {
        let tree = self.part.tree();
        let expected = self.oracle.evaluate(q).expect("a contact");
        let (name, query) = (self.oracle.name(), &checked_query.query);
        let near = |got: f64, want: f64, bound: f64, what: &str| {
            assert!((got - want).abs() <= bound, "{name} {what} at {q:?}: {got}, not {want}");
        };
        let level = self.steep * checked_query.noise;
        near(contact.depth, expected.depth, level, "depth");
        near(contact.magnitude, expected.magnitude, level, "magnitude");
        assert!((contact.point - Point3::from(self.points[i])).norm() <= checked_query.noise);
        assert_eq!(contact.normal, Vector3::from(tree.normal(i)));
        assert_eq!(contact.weight, query.weights[i]);
        assert_eq!(contact.surface, self.tool.info().regions[contact.region].surface);
        let doubt = self.oracle.border_distance(q) <= checked_query.band;
        if doubt {
            return;
        }
        assert_eq!(contact.region, expected.owner, "{name} region at {q:?}");
        near(contact.niceness, expected.niceness, 16.0 * checked_query.noise, "niceness");
        let turn = self.turn(checked_query, q);
        let along = Vector3::from(query.pose.to_world_frame(expected.direction));
        near((contact.direction - along).norm(), 0.0, turn, "direction");
        let slope =
            Vector3::from(query.pose.to_world_frame(self.oracle.gradient(q).expect("inside")));
        near((contact.gradient - slope).norm(), 0.0, self.steep * turn, "gradient");
    }

    /// Returns the bound on the difference of directions at a point.
    fn turn(&self, checked_query: &CheckedQuery<'_>, q: [f64; 3]) -> f64 {
        (16.0 * f64::EPSILON + 2.0 * checked_query.noise / self.oracle.singularity_distance(q))
            .min(MAX_FORCE_PER_MAGNITUDE)
    }

    /// Compares the wrenches.
    fn compare_sums(
        &self,
        checked_query: &CheckedQuery<'_>,
        statistics: &mut Statistics,
    ) -> Bounds {
        let (answer, wrench) = (&checked_query.answer, &checked_query.wrench);
        let level = self.steep * checked_query.noise;
        let (bounds, sizes) = self.bounds(checked_query, statistics);
        let name = self.oracle.name();
        let near = |got: f64, want: f64, bound: f64, what: &str| {
            assert!(
                (got - want).abs() <= bound,
                "{name} {what}: {got}, not {want} to {bound:e}; {wrench:?}"
            );
            (got - want).abs()
        };
        let deepest = answer.deepest.map_or(0.0, |(depth, _)| depth);
        // A point that touches for one side only is no deeper than the band.
        let deeper = if checked_query.contacts.len() == answer.count {
            level
        } else {
            level + checked_query.band
        };
        let depth = near(wrench.depth(), deepest, self.steep * deeper, "depth");
        near(wrench.integral, answer.integral, bounds.integral, "integral");
        near(wrench.energy, answer.energy, bounds.energy, "energy");
        let force = (wrench.force - Vector3::from(answer.force)).norm();
        near(force, 0.0, bounds.force, "force");
        let torque = (wrench.torque - Vector3::from(answer.torque)).norm();
        near(torque, 0.0, bounds.torque, "torque");
        match (wrench.niceness, answer.niceness) {
            (Some(got), Some(want)) if !bounds.nice => {
                near(got, want, 16.0 * checked_query.noise, "niceness");
            }
            (got, want) => assert!(bounds.nice || got == want, "{got:?}, not {want:?}"),
        }
        let relative = |error: f64, size: f64| if size > 0.0 { error / size } else { 0.0 };
        let errors = [depth / self.ulp, relative(force, sizes[0]), relative(torque, sizes[1])];
        for (worst, error) in statistics.worst.iter_mut().zip(errors) {
            *worst = worst.max(error);
        }
        bounds
    }

    /// Returns the bounds on the differences of sums, and the sums of the terms' sizes.
    fn bounds(
        &self,
        checked_query: &CheckedQuery<'_>,
        statistics: &mut Statistics,
    ) -> (Bounds, [f64; 2]) {
        let (query, noise) = (&checked_query.query, checked_query.noise);
        let tip = Point3::from(query.pose.tip);
        let lever = (Point3::from(query.centre) - tip).norm();
        let level = self.steep * noise;
        let mut bounds = Bounds::default();
        let mut sizes = [0.0; 2];
        let rounding = f64::EPSILON * (16.0 + checked_query.answer.count as f64 / 4.0);
        for &i in &checked_query.answer.contacts {
            let p = self.points[i];
            let q = query.to_tool_frame(p);
            let s = self.oracle.evaluate(q).expect("a contact");
            let (w, m, turn) = (query.weights[i], s.magnitude, self.turn(checked_query, q));
            let doubt = self.oracle.border_distance(q) <= checked_query.band;
            let normal = Vector3::from(self.normals[i]);
            let across = Vector3::from(query.pose.to_world_frame(s.direction)).dot(&normal).abs();
            let dropped = query.law == brute::Law::Facing && across <= 1e-12 + turn;
            let swing = if doubt || dropped { 2.0 * MAX_FORCE_PER_MAGNITUDE } else { turn };
            let force = w * MAX_FORCE_PER_MAGNITUDE * (level + m * (swing + rounding));
            let arm = (Point3::from(p) - tip).norm() + lever;
            bounds.force += force;
            bounds.torque += arm * force + noise * w * m * MAX_FORCE_PER_MAGNITUDE;
            bounds.integral += w * (level + rounding * m);
            bounds.energy += w * (m + level) * (level + rounding * m);
            bounds.nice |= doubt;
            sizes[0] += w * m * MAX_FORCE_PER_MAGNITUDE;
            sizes[1] += arm * w * m * MAX_FORCE_PER_MAGNITUDE;
            statistics.doubtful += usize::from(doubt);
        }
        // Points that touch for the probe only are hardly inside, if at all.
        let total_weight = |contacts: &[Contact]| contacts.iter().map(|c| c.weight).sum::<f64>();
        if checked_query.contacts.len() != checked_query.answer.count {
            let slight = self.steep
                * checked_query.band
                * total_weight(&checked_query.contacts).max(1.0)
                * MAX_FORCE_PER_MAGNITUDE;
            bounds.force += slight;
            bounds.torque += slight * (4.0 * self.size + lever);
            bounds.integral += slight;
            bounds.energy += slight;
            bounds.nice = true;
        }
        (bounds, sizes)
    }
}

/// Asserts that wrench and contacts of one probe agree to the rounding of their sums, and exactly where nothing is
/// added.
fn assert_consistent(checked_query: &CheckedQuery<'_>, bounds: &Bounds) {
    let (wrench, contacts) = (&checked_query.wrench, &checked_query.contacts[..]);
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
    let summary_of_push = summary(contacts, |contact| contact.weight * contact.magnitude);
    let (sum, mean) = summary_of_push
        .map_or((0.0, 0.0), |summary_of_push| (summary_of_push.sum, summary_of_push.mean));
    assert!((sum - wrench.integral).abs() <= bounds.integral, "{sum} {}", wrench.integral);
    assert_eq!(mean, if contacts.is_empty() { 0.0 } else { sum / contacts.len() as f64 });
    let energy: f64 = contacts.iter().map(|c| 0.5 * c.weight * c.magnitude * c.magnitude).sum();
    assert!((energy - wrench.energy).abs() <= bounds.energy);
    let centre = Point3::from(checked_query.query.centre);
    let (mut force, mut torque) = (Vector3::zeros(), Vector3::zeros());
    for c in contacts {
        let direction = match wrench.law {
            Law::Facing if c.direction.dot(&c.normal) > 0.0 => continue,
            Law::Thesis | Law::Facing => c.normal - c.direction,
            Law::Gradient => c.gradient,
        };
        let f = c.weight * c.magnitude * direction;
        force += f;
        torque += (c.point - centre).cross(&f);
    }
    assert!((force - wrench.force).norm() <= bounds.force, "{force} {}", wrench.force);
    assert!((torque - wrench.torque).norm() <= bounds.torque, "{torque} {}", wrench.torque);
}
