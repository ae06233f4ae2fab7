//! A set of methods that are timed on the same poses and compared with the same true values.

use super::cutter::Cutter;
use super::methods::{CloudBound, CloudProbe};
use super::row::{LAW, Label, Row};
use super::sampling::{Pattern, equal};
use super::truth::{ErrorStats, Errors, Truth, check};
use crate::race::clock::{Times, race};
use crate::race::contender::Contender;
use touchoff::{Cloud, CloudError, Law, Mesh, Part, Pose, Probe, Sampling};

/// A cloud with its labels and its tree.
pub(super) struct LabelledCloud {
    /// The names of its sampling pattern and of its weights.
    pub(super) names: [&'static str; 2],
    /// The points.
    pub(super) cloud: Cloud,
    /// The same points in a tree.
    pub(super) part: Part,
}

impl LabelledCloud {
    /// Builds the tree of a cloud.
    pub(super) fn new(names: [&'static str; 2], cloud: Cloud) -> LabelledCloud {
        LabelledCloud { names, part: Part::from_cloud(&cloud), cloud }
    }

    /// Returns the label for the rows of a method on these points.
    pub(super) fn label(&self, method: &'static str) -> Label {
        Label {
            method,
            points: Some(self.cloud.len()),
            sampling: Some(self.names[0]),
            weights: Some(self.names[1]),
            ..Label::default()
        }
    }
}

/// Name of weights that are the total area over the number of points.
pub(super) const EQUAL: &str = "equal";
/// Name of weights that are the areas of the points' cells.
pub(super) const CELLS: &str = "cells";

/// Samples about `count` points on a mesh in both patterns, with both kinds of weights. `project` maps each cloud to
/// the true surface.
///
/// # Errors
/// If no cloud can have this number of points.
pub(super) fn labelled_clouds(
    mesh: &Mesh,
    count: usize,
    seed: u64,
    project: impl Fn(Cloud) -> Cloud,
) -> Result<Vec<LabelledCloud>, CloudError> {
    let mut clouds = Vec::new();
    for pattern in Pattern::ALL {
        let cells = match pattern {
            Pattern::Random => Cloud::sample(mesh, Sampling::monte_carlo(count).with_seed(seed))?
                .with_voronoi_weights(mesh),
            Pattern::Blue => Cloud::sample(mesh, Sampling::new(count).with_seed(seed))?,
        };
        let equal_weighted = equal(&cells, mesh);
        for (weight_name, cloud) in [(EQUAL, equal_weighted), (CELLS, cells)] {
            clouds.push(LabelledCloud::new([pattern.name(), weight_name], project(cloud)));
        }
    }
    Ok(clouds)
}

/// A competing method.
struct Entry {
    label: Label,
    /// True if its state depends on the previous pose, so that it must follow the path.
    follows_path: bool,
    /// True if it is compared with the thesis's magnitudes.
    thesis: bool,
}

/// Methods with their labels.
#[derive(Default)]
pub(super) struct Lineup<'a> {
    entries: Vec<Entry>,
    contenders: Vec<Box<dyn Contender + 'a>>,
}

/// True values at some of the poses.
#[derive(Clone, Copy)]
pub(super) struct Truths<'a> {
    /// True values of the tool.
    pub(super) true_depths: &'a [(usize, Truth)],
    /// True values with the thesis's magnitudes, for methods that know no others.
    pub(super) thesis: &'a [(usize, Truth)],
}

impl<'a> Lineup<'a> {
    /// Adds a method.
    pub(super) fn add(&mut self, label: Label, contender: Box<dyn Contender + 'a>) {
        self.entries.push(Entry { label, follows_path: false, thesis: false });
        self.contenders.push(contender);
    }

    /// Adds a method that must follow the path, since its state depends on the previous pose.
    pub(super) fn add_following_path(&mut self, label: Label, contender: Box<dyn Contender + 'a>) {
        self.add(label, contender);
        self.entries.last_mut().expect("it was just added").follows_path = true;
    }

    /// Adds a method that knows only the thesis's magnitudes.
    #[cfg_attr(not(feature = "peers"), expect(dead_code, reason = "only peers know no others"))]
    pub(super) fn add_with_thesis_magnitudes(
        &mut self,
        label: Label,
        contender: Box<dyn Contender + 'a>,
    ) {
        self.add(label, contender);
        self.entries.last_mut().expect("it was just added").thesis = true;
    }

    /// Adds a tool's wrench on each cloud, and for each sampling pattern the upper bound on the depth of the whole
    /// surface.
    pub(super) fn add_clouds(&mut self, clouds: &'a [LabelledCloud], cutter: Cutter<'a>) {
        for cloud in clouds {
            let probe = Probe::new(&cloud.part, cutter.tool()).with_law(Law::Thesis);
            let probe = CloudProbe(probe);
            self.add(cloud.label(probe.name()), Box::new(probe));
        }
        for cloud in clouds {
            if let Some(bound) = CloudBound::new(Probe::new(&cloud.part, cutter.tool())) {
                let mut label = cloud.label(bound.name());
                label.weights = None;
                self.add(label, Box::new(bound));
            }
        }
    }

    /// Returns the labels of all methods.
    pub(super) fn labels(&self) -> impl Iterator<Item = &Label> {
        self.entries.iter().map(|entry| &entry.label)
    }

    /// Returns for each method whether it is compared with the thesis's magnitudes.
    pub(super) fn uses_thesis_magnitudes(&self) -> impl Iterator<Item = bool> {
        self.entries.iter().map(|entry| entry.thesis)
    }

    /// Returns the errors of each method, in order.
    pub(super) fn check(&mut self, poses: &[Pose], truths: Truths<'_>) -> Vec<ErrorStats> {
        let pairs = self.entries.iter().zip(&mut self.contenders);
        pairs
            .map(|(entry, contender)| {
                let truths = if entry.thesis { truths.thesis } else { truths.true_depths };
                check(&mut **contender, entry.follows_path, poses, truths)
            })
            .collect()
    }

    /// Returns for each method the share of poses at which it reports contact.
    pub(super) fn contact_shares(&mut self, poses: &[Pose]) -> Vec<f64> {
        let share = |contender: &mut Box<dyn Contender + 'a>| {
            let contacts = poses.iter().filter(|pose| contender.query(pose).colliding > 0).count();
            contacts as f64 / poses.len().max(1) as f64
        };
        self.contenders.iter_mut().map(share).collect()
    }

    /// Times all methods, interleaved, for about `seconds` at most per method.
    pub(super) fn race(&mut self, poses: &[Pose], seconds: f64) -> Vec<Times> {
        race(&mut self.contenders, poses, seconds)
    }

    /// Returns the rows of a scene. `errors` has the errors where there is contact, else the share of false alarms.
    pub(super) fn rows(
        &self,
        scene: &str,
        times: &[Times],
        errors: impl Iterator<Item = Result<Errors, f64>>,
    ) -> Vec<Row> {
        let results = self.labels().zip(times).zip(errors);
        results.map(|((label, times), errors)| row(scene, label, times, errors)).collect()
    }
}

fn row(scene: &str, label: &Label, times: &Times, errors: Result<Errors, f64>) -> Row {
    let timed_colliding = times.colliding();
    let (missed, errors) = match errors {
        Ok(errors) => (errors.missed, Some(errors)),
        Err(share) => (share, None),
    };
    let relative = errors.as_ref().map_or([None; 3], |errors| errors.relative);
    Row {
        scene: scene.to_owned(),
        method: label.method,
        points: label.points,
        sampling: label.sampling,
        weights: label.weights,
        p50_ns: times.percentile(0.5),
        p99_ns: times.percentile(0.99),
        err_force: relative[0],
        err_torque: relative[1],
        err_depth: relative[2],
        missed,
        law: LAW,
        tolerance: label.tolerance,
        budget: label.budget,
        worst_depth: errors.as_ref().map(|errors| errors.worst_depth),
        floored: errors.as_ref().map_or(vec![], |errors| errors.floored.clone()),
        poses: times.poses(),
        checked: errors.as_ref().map_or(0, |errors| errors.checked),
        colliding: errors.as_ref().map_or(timed_colliding, |errors| errors.colliding),
        ns_avg: times.average(),
    }
}
