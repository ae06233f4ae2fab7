//! The search of a part's triangles, and what it keeps from question to question.

use crate::bvh::{PoseTransform, QuerySetup};
use crate::certify::answer::Witness;
use crate::certify::body::Body;
use crate::certify::body::field::Scratch;
use crate::certify::bounds::batch::Batch;
use crate::certify::bounds::descent::Descent;
use crate::certify::part::{Facets, flat};
use crate::certify::question::Question;
#[cfg(feature = "postures")]
use crate::certify::space::Point;
use crate::certify::triangle::course::{Best, Found, Goal, Search};
use crate::certify::triangle::facet::{Facet, nearest};
use crate::pose::Pose;
use crate::tool::LANES;
use fearless_simd::Level;
use nalgebra::Vector3;

/// A tool beside a part: what is the same for all questions. Lengths are in the tool's unit.
pub(crate) struct Setting<'a> {
    pub(crate) facets: &'a Facets,
    pub(crate) body: Body<'a>,
    /// How far it reaches from its tip.
    pub(crate) size: f64,
    /// Whether what is said of places outside is their distance.
    pub(crate) exact: bool,
    pub(crate) setup: QuerySetup,
    pub(crate) level: Level,
    /// The tool's unit of length in the part's.
    pub(crate) length: f64,
    /// How far a place is known.
    pub(crate) error: f64,
}

impl Setting<'_> {
    /// What some surfaces are asked, by their places in the card's list; of a tool by its field no less than
    /// 0 is a limit.
    pub(crate) fn question(&self, limit: f64, surfaces: impl Fn(usize) -> bool) -> Question {
        let margin = self.setup.margin;
        match &self.body {
            Body::Profile(section) => Question::new(section, margin, limit, surfaces),
            Body::Field(field) => Question::of_field(field, [margin, self.error], limit, surfaces),
        }
    }

    /// Looks at the part from a pose; whether the tool may reach it.
    pub(crate) fn look(&self, work: &mut Work, pose: &Pose) -> bool {
        self.setup.set_pose(&self.facets.frame, pose, &mut work.view)
    }

    /// A place as people are told it.
    pub(crate) fn witness(&self, best: &Best, pose: &Pose) -> Witness {
        Witness {
            point: pose.tip() + pose.rotation() * Vector3::from(best.point) * self.length,
            triangle: self.facets.ids[best.index as usize],
            surface: self.body.surface(best.feature),
        }
    }

    /// How far `f32` can take a bound: planes are as steep as 2, so that one errs by three times as much
    /// as a place, and a few roundings.
    pub(crate) fn margin(&self) -> f64 {
        if self.setup.fits { 4.0 * self.body.steep() * self.setup.margin } else { f64::INFINITY }
    }
}

/// What a search is at, or has found.
#[derive(Default)]
pub(crate) struct Work {
    pub(crate) view: PoseTransform,
    pub(crate) search: Search,
    pub(crate) descent: Descent,
    batch: Batch,
    faces: Faces,
    scratch: Scratch,
    pub(crate) best: Option<Best>,
    /// The most skew of a triangle that was looked at.
    pub(crate) skew: f64,
    /// Where the last question ended, if anywhere.
    last: Option<u32>,
}

/// How deep the flat faces of a part are at most, of those that were asked for.
#[derive(Default)]
struct Faces {
    batch: Batch,
    /// Which question this is, and of each face the last that asked for it, and the answer.
    question: u32,
    known: Vec<(u32, f64)>,
}

impl Faces {
    fn begin(&mut self, facets: &Facets) {
        self.question = self.question.wrapping_add(1);
        if self.question == 0 || self.known.len() != facets.flats.faces.len() {
            self.question = 1;
            self.known.clear();
            self.known.resize(facets.flats.faces.len(), (0, 0.0));
        }
    }

    /// How deep any of some faces is at most.
    fn depth(
        &mut self,
        of: &Setting<'_>,
        question: &Question,
        (pose, view): (&Pose, &PoseTransform),
        faces: &[u32],
    ) -> f64 {
        let more = of.body.steep() * flat(&of.facets.frame) / of.length;
        let mut most = f64::NEG_INFINITY;
        for some in faces.chunks(LANES / 2) {
            self.batch.clear();
            for face in some {
                let (asked, depth) = self.known[*face as usize];
                if asked == self.question {
                    most = most.max(depth);
                } else {
                    self.batch.rectangle(&of.facets.flats.faces[*face as usize], (pose, *face));
                }
            }
            if self.batch.len() == 0 {
                continue;
            }
            self.batch.turn(view);
            self.batch.bound(of.level, &question.exact, f64::NEG_INFINITY);
            for half in (0..self.batch.len()).step_by(2) {
                let depth = self.batch.bounds[half].max(self.batch.bounds[half + 1]) + more;
                self.known[self.batch.index(half) as usize] = (self.question, depth);
                most = most.max(depth);
            }
        }
        most
    }
}

/// Where places are looked for: inside the tool, or outside while none is inside.
#[derive(Clone, Copy)]
enum Side {
    Inside,
    Outside,
}

impl Work {
    /// Searches for the deepest place.
    pub(crate) fn inside(
        &mut self,
        of: &Setting<'_>,
        question: &Question,
        pose: &Pose,
        goal: Goal,
    ) {
        self.best = None;
        self.skew = 0.0;
        self.search.begin(goal);
        self.descent.clear();
        if !of.look(self, pose) {
            return;
        }
        // A triangle that was deepest is likely to be deep.
        if let Some(last) = self.last {
            self.batch.begin(of.facets, pose, &[last]);
            self.glance(of, question);
        }
        self.descend(of, question, pose, Side::Inside, of.margin());
    }

    /// Searches for the nearest place, if that is outside; the part was looked at.
    pub(crate) fn outside(
        &mut self,
        of: &Setting<'_>,
        question: &Question,
        pose: &Pose,
        goal: Goal,
    ) {
        let margin = of.margin() + self.far() / f64::from(1 << 20);
        self.best = None;
        self.search.begin(goal);
        if let Some(last) = self.last {
            self.batch.begin(of.facets, pose, &[last]);
            self.beside(of, question);
        }
        self.descend(of, question, pose, Side::Outside, margin);
    }

    /// Begins as if nothing had been asked yet.
    #[cfg(feature = "postures")]
    pub(crate) fn forget(&mut self) {
        self.last = None;
    }

    /// How deep owners are at a place of the tool's frame, or less than 0.
    #[cfg(feature = "postures")]
    pub(crate) fn depth(&mut self, of: &Setting<'_>, question: &Question, place: Point) -> f64 {
        let depth = of.body.depth(&mut self.scratch, &question.owners, place);
        depth.map_or(f64::NEG_INFINITY, |depth| depth.value)
    }

    /// How far the part's middle is at most.
    pub(crate) fn far(&self) -> f64 {
        self.view.origin.iter().fold(0.0, |far: f64, part| far.max(f64::from(part.abs())))
    }

    /// Searches the tree; what `f32` says errs by no more than a margin.
    fn descend(
        &mut self,
        of: &Setting<'_>,
        question: &Question,
        pose: &Pose,
        side: Side,
        margin: f64,
    ) {
        self.descent.begin();
        self.faces.begin(of.facets);
        self.scratch.clear();
        let mut opened = 0;
        while let Some(node) = self.descent.pop() {
            if self.search.enough() {
                break;
            }
            let bound = f64::from(node.bound) + margin;
            if bound <= self.search.wanted() || !self.search.spend(bound) {
                continue;
            }
            let wanted = (self.search.wanted() - margin) as f32;
            if node.is_triangle(of.facets) {
                let some = self.descent.triangles(of.facets, node, wanted);
                if let Side::Inside = side
                    && opened > TIED
                {
                    some.retain(|index| {
                        of.facets.flats.of_triangle(*index).is_none_or(|face| {
                            let view = (pose, &self.view);
                            self.faces.depth(of, question, view, &[face]) > self.search.wanted()
                        })
                    });
                }
                if some.is_empty() {
                    continue;
                }
                self.batch.begin(of.facets, pose, some);
                match side {
                    Side::Inside => self.triangles(of, question),
                    Side::Outside => self.beside(of, question),
                }
                continue;
            }
            let (level, facets, view) = (of.level, of.facets, &self.view);
            // Where `f32` cannot tell, or boxes do not, a plane may.
            opened += 1;
            if let Side::Inside = side
                && opened > TIED
                && let Some(faces) = node.faces(facets)
                && self.faces.depth(of, question, (pose, &self.view), faces) <= self.search.wanted()
            {
                continue;
            }
            if let Side::Inside = side
                && (bound - 2.0 * margin <= self.search.wanted() || opened > MANY)
                && let Some(ring) = node.ring(facets, view)
                && question.exact.of_ring(&ring) <= self.search.wanted()
            {
                continue;
            }
            let descent = &mut self.descent;
            match side {
                _ if margin > MARGIN => descent.open_all(facets, node),
                Side::Inside => descent.open(level, (facets, &question.hull, view), node, wanted),
                Side::Outside => descent.open(level, (facets, &question.shell, view), node, wanted),
            }
        }
        if let Body::Field(field) = &of.body {
            let outside = matches!(side, Side::Outside);
            let scratch = &mut self.scratch;
            let found = field.look(&mut self.search, scratch, &question.owners, outside);
            self.best = found.or(self.best);
        }
        self.last = self.best.map(|best| best.index);
    }

    /// Looks at the triangles of the batch where they may be deepest.
    fn glance(&mut self, of: &Setting<'_>, question: &Question) {
        self.batch.turn(&self.view);
        self.batch.bound(of.level, &question.exact, self.search.wanted());
        self.places(of, question);
    }

    /// Looks at the triangles of the batch, which are outside.
    fn beside(&mut self, of: &Setting<'_>, question: &Question) {
        self.batch.turn(&self.view);
        for lane in 0..self.batch.len() {
            if self.search.spend(0.0) {
                self.facet(of, question, (lane, Side::Outside));
            }
        }
    }

    fn places(&mut self, of: &Setting<'_>, question: &Question) {
        for lane in 0..self.batch.len() {
            if self.batch.bounds[lane] > self.search.wanted() {
                // Of a thin triangle the place may be beside it.
                let point = nearest(self.batch.place(lane), &self.batch.corners(lane));
                let index = self.batch.index(lane);
                if let Some(depth) = of.body.depth(&mut self.scratch, &question.owners, point)
                    && self.search.take(&depth)
                {
                    self.best = Some(Best { point, feature: depth.feature, index });
                }
            }
        }
    }

    /// Looks at the triangles of the batch until none may be deeper.
    fn triangles(&mut self, of: &Setting<'_>, question: &Question) {
        self.glance(of, question);
        for _ in 0..LOOKS {
            if !self.batch.any_above(self.search.wanted()) {
                return;
            }
            self.batch.closer(of.level, &question.exact, self.search.wanted());
            self.places(of, question);
        }
        for lane in 0..self.batch.len() {
            let bound = self.batch.bounds[lane];
            if bound > self.search.wanted() && self.search.spend(bound) {
                self.facet(of, question, (lane, Side::Inside));
            }
        }
    }

    /// Looks at a triangle of the batch by itself; in a field that is done for all triangles together.
    fn facet(&mut self, of: &Setting<'_>, question: &Question, (lane, side): (usize, Side)) {
        let (corners, index) = (self.batch.corners(lane), self.batch.index(lane));
        let section = match &of.body {
            Body::Profile(section) => section,
            Body::Field(_) => return self.scratch.hold(corners, index),
        };
        let facet = Facet::new(corners);
        self.skew = self.skew.max(facet.skew);
        let owners = &question.owners;
        let heights = section.circles.iter().chain(&owners.peaks);
        let levels = heights.filter_map(|height| facet.level(*height));
        // Beside the computed meridian it may be deeper by the skew than on it; searches begin lower by two errors.
        let best = self.best;
        let known = facet.skew <= of.error;
        let before = if known { None } else { self.search.lower(facet.skew) };
        for course in facet.courses().chain(levels) {
            let found = match side {
                Side::Inside => self.search.inside((section, owners, facet.skew), &course),
                Side::Outside => self.search.outside((section, owners), &course),
            };
            if let Some(Found { t, feature }) = found {
                self.best = Some(Best { point: course.point(t), feature, index });
            }
        }
        if before.is_some_and(|before| self.search.raise(before, facet.skew)) {
            self.best = best;
        }
    }
}

/// A query that opened more nodes than these has many that are as deep.
const MANY: usize = 24;

/// One that opened more nodes than these is likely to be as deep along faces.
const TIED: usize = 128;

/// With a larger margin `f32` tells nothing, and its squares are too large for it.
pub(crate) const MARGIN: f64 = 1e9;

/// How often triangles are looked at more closely before their edges are.
const LOOKS: usize = 2;
