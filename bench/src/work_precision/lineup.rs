//! Methods side by side: raced on the same poses, checked against the same truths.

use super::cutter::Cutter;
use super::methods::{Bounded, Points};
use super::row::{LAW, Label, Row};
use super::sampling::{Pattern, equal};
use super::truth::{Errors, Tally, Truth, check};
use crate::race::clock::{Times, race};
use crate::race::contender::Contender;
use touchoff::{Cloud, CloudError, Mesh, Part, Pose, Probe};

/// A cloud with its words and its tree.
pub(super) struct Kind {
    /// How its points are spread, and what they count for.
    pub(super) words: [&'static str; 2],
    /// The points.
    pub(super) cloud: Cloud,
    /// The same in their tree.
    pub(super) part: Part,
}

impl Kind {
    /// Of a cloud.
    pub(super) fn new(words: [&'static str; 2], cloud: Cloud) -> Kind {
        Kind { words, part: Part::from_cloud(&cloud), cloud }
    }

    /// What rows say of a method that asks its points.
    pub(super) fn label(&self, method: &'static str) -> Label {
        Label {
            method,
            points: Some(self.cloud.len()),
            sampling: Some(self.words[0]),
            weights: Some(self.words[1]),
            ..Label::default()
        }
    }
}

/// The word for points that count for the area over their number.
pub(super) const EQUAL: &str = "equal";
/// The word for points that count for their cells.
pub(super) const CELLS: &str = "cells";

/// So many points of a mesh, spread in both ways and weighed in both, each carried to where it belongs.
///
/// # Errors
/// A count that no cloud has.
pub(super) fn kinds(
    mesh: &Mesh,
    count: usize,
    seed: u64,
    carry: impl Fn(Cloud) -> Cloud,
) -> Result<Vec<Kind>, CloudError> {
    let mut kinds = Vec::new();
    for pattern in Pattern::ALL {
        let cells = match pattern {
            Pattern::Random => Cloud::random(mesh, count, seed)?.weighed(mesh),
            Pattern::Blue => Cloud::blue(mesh, count, seed)?,
        };
        let alike = equal(&cells, mesh);
        for (word, cloud) in [(EQUAL, alike), (CELLS, cells)] {
            kinds.push(Kind::new([pattern.name(), word], carry(cloud)));
        }
    }
    Ok(kinds)
}

/// Who races.
struct Entry {
    label: Label,
    /// Whether it remembers where it was.
    walks: bool,
    /// Whether it is judged by the thesis's magnitudes.
    thesis: bool,
}

/// Methods, each with its words.
#[derive(Default)]
pub(super) struct Lineup<'a> {
    entries: Vec<Entry>,
    contenders: Vec<Box<dyn Contender + 'a>>,
}

/// What is true at some of the poses that methods are asked at.
#[derive(Clone, Copy)]
pub(super) struct Truths<'a> {
    /// Of the tool.
    pub(super) true_depths: &'a [(usize, Truth)],
    /// Of the same solid with the thesis's magnitudes, for those that know no others.
    pub(super) thesis: &'a [(usize, Truth)],
}

impl<'a> Lineup<'a> {
    /// One more method.
    pub(super) fn add(&mut self, label: Label, contender: Box<dyn Contender + 'a>) {
        self.entries.push(Entry { label, walks: false, thesis: false });
        self.contenders.push(contender);
    }

    /// One that remembers where it was.
    pub(super) fn add_walking(&mut self, label: Label, contender: Box<dyn Contender + 'a>) {
        self.add(label, contender);
        self.entries.last_mut().expect("it was just added").walks = true;
    }

    /// One that knows the thesis's magnitudes and no others.
    #[cfg_attr(not(feature = "peers"), expect(dead_code, reason = "only peers know no others"))]
    pub(super) fn add_of_the_thesis(&mut self, label: Label, contender: Box<dyn Contender + 'a>) {
        self.add(label, contender);
        self.entries.last_mut().expect("it was just added").thesis = true;
    }

    /// A tool beside clouds: the wrench, and of each way to spread points the bound of what no place is deeper than.
    pub(super) fn add_clouds(&mut self, kinds: &'a [Kind], cutter: Cutter<'a>) {
        for kind in kinds {
            let points = Points(Probe::new(&kind.part, cutter.tool()));
            self.add(kind.label(points.name()), Box::new(points));
        }
        for kind in kinds {
            if let Some(bounded) = Bounded::new(Probe::new(&kind.part, cutter.tool())) {
                let mut label = kind.label(bounded.name());
                label.weights = None;
                self.add(label, Box::new(bounded));
            }
        }
    }

    /// The words of all.
    pub(super) fn labels(&self) -> impl Iterator<Item = &Label> {
        self.entries.iter().map(|entry| &entry.label)
    }

    /// Which are judged by the thesis's magnitudes.
    pub(super) fn of_the_thesis(&self) -> impl Iterator<Item = bool> {
        self.entries.iter().map(|entry| entry.thesis)
    }

    /// Errors of each, in order.
    pub(super) fn check(&mut self, poses: &[Pose], truths: Truths<'_>) -> Vec<Tally> {
        let both = self.entries.iter().zip(&mut self.contenders);
        both.map(|(entry, contender)| {
            let truths = if entry.thesis { truths.thesis } else { truths.true_depths };
            check(&mut **contender, entry.walks, poses, truths)
        })
        .collect()
    }

    /// Which share of poses each says is in contact.
    pub(super) fn alarms(&mut self, poses: &[Pose]) -> Vec<f64> {
        let share = |contender: &mut Box<dyn Contender + 'a>| {
            let felt = poses.iter().filter(|pose| contender.query(pose).colliding > 0).count();
            felt as f64 / poses.len().max(1) as f64
        };
        self.contenders.iter_mut().map(share).collect()
    }

    /// Times of each, in turns.
    pub(super) fn race(&mut self, poses: &[Pose], seconds: f64) -> Vec<Times> {
        race(&mut self.contenders, poses, seconds)
    }

    /// The rows of a scene; `errors` where there is contact, else the share of false alarms.
    pub(super) fn rows(
        &self,
        scene: &str,
        times: &[Times],
        errors: impl Iterator<Item = Result<Errors, f64>>,
    ) -> Vec<Row> {
        let each = self.labels().zip(times).zip(errors);
        each.map(|((label, times), errors)| row(scene, label, times, errors)).collect()
    }
}

fn row(scene: &str, label: &Label, times: &Times, errors: Result<Errors, f64>) -> Row {
    let timed_colliding = times.colliding();
    let (missed, errors) = match errors {
        Ok(errors) => (errors.missed, Some(errors)),
        Err(alarms) => (alarms, None),
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
