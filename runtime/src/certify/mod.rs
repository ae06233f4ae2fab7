//! What lies between the points of a cloud: how deep a tool is in a part's triangles, proved.
//!
//! ```text
//! pose ──look──▶ nodes ──hull──▶ triangles ──batch──▶ eight at a time ──facet, course──▶ deepest
//!                 f32              f32                  f64                 f64
//! ```
//!
//! A [`Certifier`] searches a tree of triangles, [`Facets`], by branch and bound: what cannot be deeper
//! than what was found is left. Depth is that of the tool's profile, the distance to its surface; bounds
//! come from its pieces (`hull`), and where they leave a triangle open, from its edges and the one line
//! in it on which depth can be greatest (`facet`, `course`).
//!
//! **Rounding.** Every place is known to within a part in 2^46 of the tool's and the part's size, and
//! answers are widened by that. Thin triangles are known less well: their *skew* is added.

mod answer;
mod batch;
mod course;
mod descent;
mod facet;
mod facets;
mod feature;
mod flat;
mod hull;
mod nearest;
mod section;
mod shell;
mod winding;

pub use answer::{Clear, Clearance, Penetration, Uncertified, Witness};
pub use facets::Facets;

use crate::pose::Pose;
use crate::tool::Tool;
use crate::tree::{Sight, View};
use batch::Batch;
use course::Search;
use descent::Descent;
use facet::Facet;
use fearless_simd::Level;
use hull::Hull;
use nalgebra::Vector3;
use section::Section;
use shell::Shell;

/// A tool beside a part's triangles, ready to be asked what is proved at one pose after another.
///
/// Memory is kept between questions, and each begins at the triangle that the last one ended at. What
/// is asked about is the tool's surface as its profile draws it.
///
/// ```
/// use nalgebra::{Point3, Vector3};
/// use touchoff::certify::{Certifier, Facets};
/// use touchoff::{Pose, Unit, mesh::shapes};
///
/// touchoff::tool! {
///     tool Ball "a ball of 3 mm radius" {
///         units mm;
///         profile {
///             start (0, 0);
///             arc to (0, 6) center (0, 3) as ball cutting;
///         }
///         niceness cutting: 1;
///     }
/// }
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let low = Point3::new(-20.0, -20.0, -10.0);
/// let block = shapes::cuboid(low, Point3::new(20.0, 20.0, 0.0), Unit::Millimetre)?;
/// let facets = Facets::new(&block);
/// let mut certifier = Certifier::new(&facets, &Ball)?;
/// let pose = Pose::from_axis(Point3::new(0.3, 0.1, -0.5), Vector3::z())?;
/// let [low, high] = certifier.deepest(&pose, 1e-9).depth;
/// assert!(low <= 0.5 && 0.5 <= high && high - low < 2e-9);
/// # Ok(()) }
/// ```
pub struct Certifier<'a> {
    facets: &'a Facets,
    section: Section,
    hull: Hull<f32>,
    exact: Hull<f64>,
    shell: Shell,
    level: Level,
    sight: Sight,
    /// The tool's unit of length in the part's.
    length: f64,
    /// How far a place is known, in the tool's unit.
    error: f64,
    budget: u32,
    view: View,
    search: Search,
    descent: Descent,
    batch: Batch,
    best: Option<Best>,
    /// The most skew of a triangle that was looked at.
    skew: f64,
    /// Where the last question ended.
    last: u32,
}

/// The deepest place so far, in the tool's frame.
struct Best {
    point: [f64; 3],
    feature: usize,
    index: u32,
}

/// Where places are looked for: inside the tool, or outside while none is inside.
#[derive(Clone, Copy)]
enum Side {
    Inside,
    Outside,
}

impl<'a> Certifier<'a> {
    /// A certifier of a tool beside a part.
    ///
    /// # Errors
    /// Where the distance from the tool is not known; see [`Uncertified`].
    pub fn new(facets: &'a Facets, tool: &dyn Tool) -> Result<Certifier<'a>, Uncertified> {
        let card = tool.card();
        if card.outline.is_empty() {
            return Err(Uncertified::NoProfile { tool: card.name.to_string() });
        }
        let length = card.unit.to(facets.unit());
        let sight = Sight::new(&facets.frame, card, length);
        let part = f64::from(facets.frame.size) * facets.frame.scale / length;
        let error = 64.0 * f64::EPSILON * (card.size() + part);
        let section = Section::new(card, error)
            .ok_or_else(|| Uncertified::Overhang { tool: card.name.to_string() })?;
        Ok(Certifier {
            hull: Hull::new(&section, sight.margin),
            exact: Hull::new(&section, error),
            shell: Shell::new(&section),
            section,
            level: Level::new(),
            sight,
            length,
            error,
            budget: 1 << 20,
            view: View::default(),
            search: Search::default(),
            descent: Descent::default(),
            batch: Batch::default(),
            best: None,
            skew: 0.0,
            last: 0,
            facets,
        })
    }

    /// With a budget: how many nodes, triangles and intervals of edges a question may look at. When it
    /// is spent, the answer is what is known until then. The default is a million.
    #[must_use]
    pub fn budget(mut self, budget: u32) -> Certifier<'a> {
        self.budget = budget;
        self
    }

    /// With another SIMD level than the best of this machine.
    #[must_use]
    pub fn level(mut self, level: Level) -> Certifier<'a> {
        self.level = level;
        self
    }

    /// The deepest penetration of the part's triangles into the tool. The interval is no wider than the
    /// tolerance, in the part's unit, and what rounding adds; a tolerance below that, or 0, is taken as
    /// that. Where triangles are thinner than the tolerance, or the budget is spent, it is wider.
    pub fn deepest(&mut self, pose: &Pose, tolerance: f64) -> Penetration {
        // Written so that what is not a number is no tolerance.
        let tolerance = (4.0 * self.error).max(tolerance / self.length);
        self.inside(pose, self.error, tolerance, f64::INFINITY);
        let more = self.error + self.skew;
        let (low, high) = match &self.best {
            Some(_) => (self.search.best - more, self.search.best + tolerance),
            None => (0.0, self.error),
        };
        let high = if self.descent.looked() { high.max(self.search.most) + more } else { 0.0 };
        Penetration {
            depth: [low.max(0.0), high].map(|depth| depth * self.length),
            witness: self.witness(pose),
        }
    }

    /// Whether the tool is clear of the part. It stops at the first point that is inside.
    pub fn clear(&mut self, pose: &Pose) -> Clear {
        let touch = 2.0 * self.error;
        self.inside(pose, -touch, touch, touch);
        match self.witness(pose) {
            Some(witness) if self.search.best > touch + self.skew => Clear::Touching(witness),
            None if !self.search.open() => match self.within(pose) {
                Some(true) => Clear::Inside,
                Some(false) => Clear::Clear,
                None => Clear::Untouched,
            },
            _ => {
                let high = self.search.most.max(self.search.wanted()) + touch + self.skew;
                Clear::Undecided(high * self.length)
            }
        }
    }

    /// How far the part's triangles are from the tool: an interval no wider than the tolerance, in the
    /// part's unit, and what rounding adds; 0 where they touch. A tool wholly inside the material is as
    /// far from its surface.
    pub fn clearance(&mut self, pose: &Pose, tolerance: f64) -> Clearance {
        let touch = 2.0 * self.error;
        self.inside(pose, -touch, touch, touch);
        if let Some(witness) = self.witness(pose) {
            let high = if self.search.best > touch { 0.0 } else { 2.0 * touch + self.skew };
            return Clearance { distance: [0.0, high * self.length], witness: Some(witness) };
        }
        let unsure = self.search.open();
        // Rounding grows with the distance.
        let far =
            self.view.origin.iter().fold(0.0, |far: f64, part| far.max(f64::from(part.abs())));
        let error = self.error + 64.0 * f64::EPSILON * far;
        let margin = self.margin() + far / f64::from(1 << 20);
        let tolerance = (4.0 * error).max(tolerance / self.length);
        self.best = None;
        self.search.begin(f64::NEG_INFINITY, tolerance, self.budget);
        self.batch.begin(self.facets, pose, &[self.last]);
        self.beside();
        self.descend(pose, Side::Outside, margin, f64::INFINITY);
        let more = error + self.skew;
        let low = -self.search.wanted().max(self.search.most) - more;
        let low = if unsure { 0.0 } else { low.max(0.0) };
        let high = -self.search.best + more;
        Clearance {
            distance: [low, high].map(|distance| distance * self.length),
            witness: self.witness(pose),
        }
    }

    /// Searches for what is deeper than `least`, to a tolerance, and stops at what is deeper than
    /// `enough`.
    fn inside(&mut self, pose: &Pose, least: f64, tolerance: f64, enough: f64) {
        self.best = None;
        self.skew = 0.0;
        self.search.begin(least, tolerance, self.budget);
        self.descent.clear();
        if !self.sight.look(&self.facets.frame, pose, &mut self.view) {
            return;
        }
        // A triangle that was deepest is likely to be deep.
        self.batch.begin(self.facets, pose, &[self.last]);
        self.glance();
        self.descend(pose, Side::Inside, self.margin(), enough);
    }

    /// How far `f32` can take a bound, in the tool's unit: planes are as steep as 2, so that one errs by
    /// three times as much as a place, and a few roundings.
    fn margin(&self) -> f64 {
        if self.sight.fits { 4.0 * self.sight.margin } else { f64::INFINITY }
    }

    /// Searches the tree; what `f32` says errs by no more than a margin.
    fn descend(&mut self, pose: &Pose, side: Side, margin: f64, enough: f64) {
        self.descent.begin();
        let mut opened = 0;
        while let Some(node) = self.descent.pop() {
            if self.search.best > enough {
                break;
            }
            let bound = f64::from(node.bound) + margin;
            if bound <= self.search.wanted() || !self.search.spend(bound) {
                continue;
            }
            let wanted = (self.search.wanted() - margin) as f32;
            if node.is_triangle(self.facets) {
                let some = self.descent.triangles(self.facets, node, wanted);
                self.batch.begin(self.facets, pose, some);
                match side {
                    Side::Inside => self.triangles(),
                    Side::Outside => self.beside(),
                }
                continue;
            }
            let (level, facets, view) = (self.level, self.facets, &self.view);
            // Where `f32` cannot tell, or boxes do not, a plane may.
            opened += 1;
            if let Side::Inside = side
                && (bound - 2.0 * margin <= self.search.wanted() || opened > MANY)
                && let Some(ring) = node.ring(facets, view)
                && self.exact.of_ring(&ring) <= self.search.wanted()
            {
                continue;
            }
            let descent = &mut self.descent;
            match side {
                _ if margin > MARGIN => descent.open_all(facets, node),
                Side::Inside => descent.open(level, (facets, &self.hull, view), node, wanted),
                Side::Outside => descent.open(level, (facets, &self.shell, view), node, wanted),
            }
        }
        if let Some(best) = &self.best {
            self.last = best.index;
        }
    }

    /// Looks at the triangles of the batch where they may be deepest.
    fn glance(&mut self) {
        self.batch.turn(&self.view);
        self.batch.bound(self.level, &self.exact, self.search.wanted());
        self.places();
    }

    /// Looks at the triangles of the batch, which are outside.
    fn beside(&mut self) {
        self.batch.turn(&self.view);
        for lane in 0..self.batch.len() {
            if self.search.spend(0.0) {
                self.facet(lane, Side::Outside);
            }
        }
    }

    fn places(&mut self) {
        for lane in 0..self.batch.len() {
            if self.batch.bounds[lane] > self.search.wanted() {
                let (point, index) = (self.batch.place(lane), self.batch.index(lane));
                let place = [(point[0] * point[0] + point[1] * point[1]).sqrt(), point[2]];
                if let Some(depth) = self.section.depth_at(place)
                    && self.search.take(&depth)
                {
                    self.best = Some(Best { point, feature: depth.feature, index });
                }
            }
        }
    }

    /// Looks at the triangles of the batch until none may be deeper.
    fn triangles(&mut self) {
        self.glance();
        for _ in 0..LOOKS {
            if !self.batch.any_above(self.search.wanted()) {
                return;
            }
            self.batch.closer(self.level, &self.exact, self.search.wanted());
            self.places();
        }
        for lane in 0..self.batch.len() {
            let bound = self.batch.bounds[lane];
            if bound > self.search.wanted() && self.search.spend(bound) {
                self.facet(lane, Side::Inside);
            }
        }
    }

    /// Looks at the meridian and edges of a triangle of the batch.
    fn facet(&mut self, lane: usize, side: Side) {
        let (facet, index) = (Facet::new(self.batch.corners(lane)), self.batch.index(lane));
        self.skew = self.skew.max(facet.skew);
        let edges = facet.edges();
        let courses = facet.meridian().into_iter().chain(edges);
        for course in courses {
            let found = match side {
                Side::Inside => self.search.inside(&self.section, &course),
                Side::Outside => self.search.outside(&self.section, &course),
            };
            if let Some(found) = found {
                let point = course.point(found.t);
                self.best = Some(Best { point, feature: found.feature, index });
            }
        }
    }

    /// The best place as people are told it.
    fn witness(&self, pose: &Pose) -> Option<Witness> {
        self.best.as_ref().map(|best| Witness {
            point: pose.tip() + pose.rotation() * Vector3::from(best.point) * self.length,
            triangle: self.facets.ids[best.index as usize],
            surface: self.section.features[best.feature].surface,
        })
    }

    /// Whether the top of the tool's axis is inside the part, if it has an inside.
    fn within(&self, pose: &Pose) -> Option<bool> {
        let top = self.section.reach()[1] * self.length;
        self.facets.contains(pose.tip() + top * pose.axis())
    }
}

/// A query that opened more nodes than these has many that are as deep.
const MANY: usize = 24;

/// With a larger margin `f32` tells nothing, and its squares are too large for it.
const MARGIN: f64 = 1e9;

/// How often triangles are looked at more closely before their edges are.
const LOOKS: usize = 2;
