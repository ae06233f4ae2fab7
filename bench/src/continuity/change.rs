//! What a step of the force is made of, point by point.

use nalgebra::Vector3;
use std::collections::BTreeMap;
use touchoff::tool::Card;
use touchoff::{Contact, Law};

/// The force of one contact.
pub fn push(contact: &Contact, law: Law) -> Vector3<f64> {
    let Contact { weight, magnitude, normal, direction, gradient, .. } = contact;
    let size = weight * magnitude;
    match law {
        Law::Gradient => size * gradient,
        Law::Facing if normal.dot(direction) > 0.0 => Vector3::zeros(),
        Law::Thesis | Law::Facing => size * (normal - direction),
    }
}

/// The angle, in radians, by which directions turn that go on smoothly at most.
pub(super) const SWING: f64 = 0.02;

/// A step of the force by what its points do. Points are told by their triangles, so each has to have its own.
#[derive(Clone, Debug, Default)]
pub struct Change {
    /// Points that came or went, and what that does to the force.
    pub entering: (usize, Vector3<f64>),
    /// Points that changed their region.
    pub crossing: (usize, Vector3<f64>),
    /// Points whose normal faces away only on one side: the law of facing leaves them out there.
    pub turning: (usize, Vector3<f64>),
    /// Points that keep their region, but whose direction turns by more than 0.02 rad: close to the axis, or to a centre.
    pub swinging: (usize, Vector3<f64>),
    /// All others: stiffness.
    pub staying: (usize, Vector3<f64>),
    /// Which borders were crossed, by how many points.
    pub borders: BTreeMap<String, usize>,
}

impl Change {
    /// Of the contacts at two poses.
    pub fn between(before: &[Contact], after: &[Contact], law: Law, card: &Card) -> Change {
        let mut change = Change::default();
        let old: BTreeMap<u32, &Contact> = before.iter().map(|c| (c.triangle, c)).collect();
        let new: BTreeMap<u32, &Contact> = after.iter().map(|c| (c.triangle, c)).collect();
        let add = |to: &mut (usize, Vector3<f64>), step| {
            to.0 += 1;
            to.1 += step;
        };
        for (id, contact) in &old {
            if !new.contains_key(id) {
                add(&mut change.entering, -push(contact, law));
            }
        }
        for (id, contact) in &new {
            let Some(known) = old.get(id) else {
                add(&mut change.entering, push(contact, law));
                continue;
            };
            let step = push(contact, law) - push(known, law);
            let away = |c: &Contact| law == Law::Facing && c.normal.dot(&c.direction) > 0.0;
            if known.region != contact.region {
                let [a, b] = [known.region, contact.region].map(|k| &card.regions[k].name);
                let name = if a < b { format!("{a} | {b}") } else { format!("{b} | {a}") };
                *change.borders.entry(name).or_default() += 1;
                add(&mut change.crossing, step);
            } else if away(known) != away(contact) {
                add(&mut change.turning, step);
            } else if (known.direction - contact.direction).norm() > SWING {
                add(&mut change.swinging, step);
            } else {
                add(&mut change.staying, step);
            }
        }
        change
    }

    /// All of it.
    pub fn total(&self) -> Vector3<f64> {
        self.entering.1 + self.crossing.1 + self.turning.1 + self.swinging.1 + self.staying.1
    }

    /// What most of it is by, in words.
    pub fn cause(&self) -> String {
        let kinds = [
            (&self.entering, "entering or leaving"),
            (&self.turning, "turning away"),
            (&self.swinging, "at the axis or a centre"),
            (&self.staying, "going on smoothly"),
            (&self.crossing, "crossing"),
        ];
        let most = kinds.into_iter().max_by(|a, b| a.0.1.norm().total_cmp(&b.0.1.norm()));
        let Some(((count, _), what)) = most else { return String::new() };
        let borders: Vec<String> =
            self.borders.iter().map(|(name, count)| format!("{name}: {count}")).collect();
        let points = if *count == 1 { "point" } else { "points" };
        match what {
            "crossing" => format!("{count} {points} crossing {}", borders.join(", ")),
            _ => format!("{count} {points} {what}"),
        }
    }
}
