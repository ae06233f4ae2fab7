//! What a sweep is asked, and how deep a place is as it sees it.

use crate::certify::body::field::Scratch;
use crate::certify::body::owners::Owners;
use crate::certify::question::Question;
use crate::certify::space::Point;
use crate::certify::triangle::course::Best;
use crate::certify::work::Setting;
use crate::motion::Motion;

/// What a sweep is about.
pub(crate) struct Task<'a> {
    pub(crate) setting: &'a Setting<'a>,
    pub(crate) question: &'a Question,
    pub(crate) motion: &'a Motion,
    /// How deep the question's owners may be; below 0, how far they have to keep. That is the question's own
    /// limit, or, where it is not below 0, any that is larger.
    pub(crate) limit: f64,
    /// How far a place is known on this way.
    pub(crate) error: f64,
    /// How much deeper than its limit is not worth telling.
    pub(crate) tolerance: f64,
}

impl Task<'_> {
    /// What is no deeper need not be looked at.
    pub(super) fn wanted(&self) -> f64 {
        self.limit + self.tolerance
    }

    /// The same of what has grown by as much as is to be kept.
    pub(super) fn above(&self) -> f64 {
        self.wanted() + self.keep() - self.error
    }

    /// How far the owners have to keep at least.
    pub(super) fn keep(&self) -> f64 {
        (-self.wanted()).max(0.0)
    }

    /// How deep a place is, or how near, as depth less than 0.
    pub(super) fn depth(&self, scratch: &mut Scratch, point: Point) -> Place {
        let (body, owners) = (&self.setting.body, &self.question.owners);
        let inside = if self.limit < 0.0 {
            Some(body.distance(scratch, owners, point))
        } else {
            body.depth(scratch, owners, point).filter(|depth| depth.value >= 0.0)
        };
        let depth = inside.unwrap_or_else(|| body.distance(scratch, &Owners::default(), point));
        Place { point, depth: depth.value, feature: depth.feature }
    }

    /// Whether a place is deeper than is allowed, whatever was rounded.
    pub(super) fn too_deep(&self, found: &Place) -> bool {
        found.depth > self.limit + 2.0 * self.error
    }
}

/// A place in the tool's frame, and how deep it is.
#[derive(Clone, Copy)]
pub(super) struct Place {
    pub(super) point: Point,
    pub(super) depth: f64,
    pub(super) feature: usize,
}

impl Place {
    pub(super) fn best(&self, index: u32) -> Best {
        Best { point: self.point, feature: self.feature, index }
    }
}
