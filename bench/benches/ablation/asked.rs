//! The runtime's questions as methods, and the same answers from the list of all contacts.

use crate::contender::{Answer, Contender};
use nalgebra::Vector3;
use touchoff::tool::Senses;
use touchoff::{Contact, Law, Pose, Probe, Wrench};

/// A question put by a closure.
pub(crate) struct Asked<F> {
    name: &'static str,
    ask: F,
}

impl<F: FnMut(&Pose) -> Answer> Contender for Asked<F> {
    fn name(&self) -> &'static str {
        self.name
    }

    fn query(&mut self, pose: &Pose) -> Answer {
        (self.ask)(pose)
    }
}

pub(crate) fn asked<F: FnMut(&Pose) -> Answer>(name: &'static str, ask: F) -> Asked<F> {
    Asked { name, ask }
}

/// Yes or no; yes counts as one point.
pub(crate) fn detect<T: Senses + ?Sized>(mut probe: Probe<'_, T>) -> impl Contender {
    asked("detect", move |pose| yes(probe.detect(pose)))
}

/// Yes or no of a question that does not stop at the first hit.
pub(crate) fn detect_deepest<T: Senses + ?Sized>(mut probe: Probe<'_, T>) -> impl Contender {
    asked("deepest", move |pose| yes(probe.deepest(pose).is_some()))
}

pub(crate) fn deepest<T: Senses + ?Sized>(mut probe: Probe<'_, T>) -> impl Contender {
    asked("deepest", move |pose| {
        let deepest = probe.deepest(pose);
        Answer { depth: deepest.map_or(0.0, |deepest| deepest.depth), ..yes(deepest.is_some()) }
    })
}

/// Niceness and the depth of what does not cut stand where others have a force.
pub(crate) fn posture<T: Senses + ?Sized>(mut probe: Probe<'_, T>) -> impl Contender {
    asked("posture", move |pose| {
        let posture = probe.posture(pose);
        let depth = posture.deepest.map_or(0.0, |deepest| deepest.depth);
        Answer {
            colliding: posture.colliding,
            depth,
            wrench: judged(posture.niceness, posture.body),
        }
    })
}

pub(crate) fn wrench<T: Senses + ?Sized>(mut probe: Probe<'_, T>) -> impl Contender {
    asked("wrench", move |pose| felt(&probe.wrench(pose)))
}

/// What a wrench says.
pub(crate) fn felt(felt: &Wrench) -> Answer {
    Answer {
        colliding: felt.colliding,
        depth: felt.depth(),
        wrench: Some([felt.force, felt.torque]),
    }
}

fn yes(yes: bool) -> Answer {
    Answer { colliding: usize::from(yes), ..Answer::default() }
}

fn judged(niceness: Option<f64>, body: Option<f64>) -> Option<[Vector3<f64>; 2]> {
    let none = -1.0;
    Some([Vector3::new(niceness.unwrap_or(none), body.unwrap_or(none), 0.0), Vector3::zeros()])
}

/// What is answered from the list.
pub(crate) fn listed<T: Senses + ?Sized>(
    mut probe: Probe<'_, T>,
    of: impl Fn(&Pose, &[Contact]) -> Answer,
) -> impl Contender {
    asked("contacts", move |pose| of(pose, probe.contacts(pose)))
}

pub(crate) fn detect_of(_: &Pose, contacts: &[Contact]) -> Answer {
    yes(!contacts.is_empty())
}

pub(crate) fn deepest_of(_: &Pose, contacts: &[Contact]) -> Answer {
    Answer { depth: depth(contacts), ..yes(!contacts.is_empty()) }
}

/// `cutting` says which surfaces cut.
pub(crate) fn posture_of(cutting: &[bool], contacts: &[Contact]) -> Answer {
    let niceness = contacts.iter().map(|contact| contact.niceness).reduce(f64::min);
    let body = contacts.iter().filter(|contact| !cutting[contact.surface]);
    let body = body.map(|contact| contact.depth).reduce(f64::max);
    Answer { colliding: contacts.len(), depth: depth(contacts), wrench: judged(niceness, body) }
}

/// Force and torque about the tip.
pub(crate) fn wrench_of(law: Law, pose: &Pose, contacts: &[Contact]) -> Answer {
    let (mut force, mut torque) = (Vector3::zeros(), Vector3::zeros());
    for contact in contacts {
        let way = match law {
            Law::Gradient => contact.gradient,
            Law::Thesis | Law::Facing => contact.normal - contact.direction,
        };
        let push = contact.weight * contact.magnitude * way;
        force += push;
        torque += (contact.point - pose.tip()).cross(&push);
    }
    Answer { colliding: contacts.len(), depth: depth(contacts), wrench: Some([force, torque]) }
}

fn depth(contacts: &[Contact]) -> f64 {
    contacts.iter().map(|contact| contact.depth).fold(0.0, f64::max)
}
